//! The reduced coefficients of a mechanism whose bodies all move parallel to one plane, from its planar equivalent. Heights z above the
//! plane and products of inertia with z do no work, and their effect on the joints follows from the [forces in the
//! plane](super::lifted_reactions).

use super::lifted_reactions::{LiftedReactions, LiftedWorkspace};
use super::model::{Model, Workspace};
use crate::mass::Mass;
use crate::model::{Model as PlanarModel, Workspace as PlanarWorkspace};
use crate::reduced::{Coefficients, ReducibleModel as _};
use dwell_geometry::Range;
use dwell_numerics::Scalar;
use std::f64::consts::TAU;

/// Positions at which both mechanisms are compared.
const COMPARED: u32 = 32;
/// They have the same generalised inertia and the same reactions to this part.
const SAME: f64 = 1e-9;

/// The equivalent planar model.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InPlane {
    model: PlanarModel,
    lifted: LiftedReactions,
    /// The limits of the mechanism in space, which decides the range.
    limits: Option<(f64, f64)>,
}

/// Memory for one thread.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InPlaneWorkspace<T> {
    planar: PlanarWorkspace<T>,
    /// The coefficients of the planar model.
    found: Coefficients<T>,
    lifted: LiftedWorkspace<T>,
}

impl InPlane {
    /// The planar equivalent of a model with its reactions; `None` if there is none, or if the planar branch is not that of the mechanism
    /// in space over its whole range.
    pub(super) fn new(of: &Model) -> Option<Self> {
        let equivalent = of.plan().planar_equivalent(of.mechanism())?;
        let masses = of.inner_masses().iter().zip(&equivalent.frames);
        let in_space: Vec<_> = masses.map(|(mass, frame)| mass.in_frame(frame)).collect();
        let masses = in_space.iter().map(|mass| Mass {
            mass: mass.mass,
            center: dwell_geometry::vec2(mass.center.x, mass.center.y),
            inertia: mass.inertia[2],
        });
        let masses: Vec<Mass> = masses.collect();
        let model =
            PlanarModel::new(&equivalent.mechanism, &masses, &equivalent.assembly, &[]).ok()?;
        let lifted = LiftedReactions::new(of, &equivalent, &in_space, model.plan())?;
        let model = model.with_reactions(lifted.planar_reactions()).ok()?;
        let model = model.pruned_for(lifted.bodies());
        let limits = match (of.plan().range(), model.plan().range()) {
            (Range::Full, Range::Full) | (Range::Unbounded, Range::Unbounded) => None,
            (own, other) => {
                other.limits()?;
                Some(own.limits()?)
            }
        };
        let found = Self {
            model,
            lifted,
            limits,
        };
        found.agrees(of).then_some(found)
    }

    /// Whether the coefficients are those of the mechanism in space. Reactions that redundant constraints of the plane leave undetermined
    /// are not; a model that requests one of them is evaluated in space.
    fn agrees(&self, of: &Model) -> bool {
        let (from, width) = self
            .limits
            .map_or((0.0, TAU), |(from, to)| (from, to - from));
        let (mut one, mut other) = (self.workspace::<f64>(), of.workspace::<f64>());
        let [mut found, mut wanted] = [(); 2].map(|()| of.coefficient_buffer::<f64>());
        let size = of.plan().size();
        let mut agrees_at = |k: u32| {
            let q = from + width * (f64::from(k) + 0.5) / f64::from(COMPARED);
            let evaluated = self.reduce(q, &mut one, &mut found)
                && of.reduce(q, &mut other, &mut wanted).is_ok();
            let inertia = wanted.m.abs() + wanted.half_dm.abs();
            let same = |a: f64, b: f64, scale: f64| (a - b).abs() <= SAME * scale;
            let both = |of: &Coefficients| [&of.a[..], &of.b[..]].concat();
            let (reactions, expected) = (both(&found), both(&wanted));
            let largest = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            // What inertia has in the units of a force or a moment, whether the coordinate is an angle or a length: all reactions may be zero.
            let scale = largest + inertia * (1.0 + size + 1.0 / size);
            let mut pairs = reactions.iter().zip(&expected);
            evaluated
                && same(found.m, wanted.m, inertia)
                && same(found.half_dm, wanted.half_dm, inertia)
                && pairs.all(|(a, b)| same(*a, *b, scale))
        };
        (0..COMPARED).all(&mut agrees_at)
    }

    /// Memory for one thread.
    pub(super) fn workspace<T: Scalar>(&self) -> InPlaneWorkspace<T> {
        InPlaneWorkspace {
            planar: self.model.workspace(),
            found: self.model.coefficient_buffer(),
            lifted: self.lifted.workspace(),
        }
    }

    /// The coefficients at `q`; returns false if the mechanism in space must be evaluated to report the error.
    #[inline(always)]
    pub(super) fn reduce<T: Scalar>(
        &self,
        q: T,
        workspace: &mut InPlaneWorkspace<T>,
        out: &mut Coefficients<T>,
    ) -> bool {
        let value = q.value();
        let inside = self
            .limits
            .is_none_or(|(from, to)| value >= from && value <= to);
        let InPlaneWorkspace {
            planar,
            found,
            lifted,
        } = workspace;
        if !(inside && self.model.reduce(q, planar, found).is_ok()) {
            return false;
        }
        (out.m, out.half_dm) = (found.m, found.half_dm);
        self.lifted.lift(planar, found, lifted, out);
        true
    }
}

impl Model {
    /// Whether the reduced coefficients come from a planar equivalent: of a model that was prepared
    /// [for them](crate::ReducibleModel::for_coefficients) or [for inertia alone](crate::ReducibleModel::for_inertia).
    pub fn is_in_plane(&self) -> bool {
        self.in_plane.is_some()
    }

    /// The turns of the planar equivalent, if there is one.
    pub(super) fn in_plane_turns(&self, workspace: &Workspace<f64>) -> Option<Vec<[f64; 2]>> {
        let (in_plane, of) = self.in_plane.as_ref().zip(workspace.in_plane.as_ref())?;
        Some(in_plane.model.unit_turns(&of.planar))
    }

    /// The reduced coefficients from the planar equivalent; returns false if there is none, or no pose.
    #[inline(always)]
    pub(super) fn reduce_in_plane<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> bool {
        match (&self.in_plane, &mut workspace.in_plane) {
            (Some(in_plane), Some(workspace)) => in_plane.reduce(q, workspace, out),
            _ => false,
        }
    }
}
