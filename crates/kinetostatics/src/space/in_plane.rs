//! The generalised inertia of a mechanism whose bodies all move parallel to one plane, from the planar mechanism that moves as it does:
//! what lies at the height z above the plane, and the products of inertia with z, do no work there.

use super::model::{Model, Workspace};
use crate::mass::Mass;
use crate::model::{Model as PlanarModel, Workspace as PlanarWorkspace};
use crate::reduced::Coefficients;
use dwell_geometry::Range;
use dwell_numerics::Scalar;
use std::f64::consts::TAU;

/// Positions at which both mechanisms are compared.
const COMPARED: u32 = 32;
/// They have the same generalised inertia to this part.
const SAME: f64 = 1e-9;

/// The equivalent planar model.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InPlane {
    model: PlanarModel,
    /// Of the mechanism in space, which decides where the range ends.
    limits: Option<(f64, f64)>,
}

impl InPlane {
    /// That of a model; none where it has none, or where the planar branch is not that of the mechanism in space over its whole range.
    pub(super) fn new(of: &Model) -> Option<Self> {
        let equivalent = of.plan().planar_equivalent(of.mechanism())?;
        let masses = of.inner_masses().iter().zip(&equivalent.frames);
        let masses = masses.map(|(mass, frame)| {
            let mass = mass.in_frame(frame);
            Mass {
                mass: mass.mass,
                center: dwell_geometry::vec2(mass.center.x, mass.center.y),
                inertia: mass.inertia[2],
            }
        });
        let masses: Vec<Mass> = masses.collect();
        let model = PlanarModel::new(&equivalent.mechanism, &masses, &equivalent.assembly, &[]);
        let model = model.ok()?.inertia_only();
        let limits = match (of.plan().range(), model.plan().range()) {
            (Range::Full, Range::Full) => None,
            (own, other) => {
                other.limits()?;
                Some(own.limits()?)
            }
        };
        let found = Self { model, limits };
        found.agrees(of).then_some(found)
    }

    /// Whether m and ½m′ are those of the mechanism in space.
    fn agrees(&self, of: &Model) -> bool {
        let (from, width) = self
            .limits
            .map_or((0.0, TAU), |(from, to)| (from, to - from));
        let (mut one, mut other) = (self.model.workspace::<f64>(), of.workspace::<f64>());
        let [mut found, mut wanted] = [(); 2].map(|()| Coefficients::<f64>::buffer(0));
        let mut agrees_at = |k: u32| {
            let q = from + width * (f64::from(k) + 0.5) / f64::from(COMPARED);
            let evaluated = self.model.reduce(q, &mut one, &mut found).is_ok()
                && of.reduce(q, &mut other, &mut wanted).is_ok();
            let scale = SAME * (wanted.m.abs() + wanted.half_dm.abs());
            evaluated
                && (found.m - wanted.m).abs() <= scale
                && (found.half_dm - wanted.half_dm).abs() <= scale
        };
        (0..COMPARED).all(&mut agrees_at)
    }

    /// Memory for one thread.
    pub(super) fn workspace<T: Scalar>(&self) -> PlanarWorkspace<T> {
        self.model.workspace()
    }

    /// m and ½m′ at `q`; false where the mechanism in space has to say what is wrong there.
    #[inline(always)]
    pub(super) fn reduce<T: Scalar>(
        &self,
        q: T,
        workspace: &mut PlanarWorkspace<T>,
        out: &mut Coefficients<T>,
    ) -> bool {
        let value = q.value();
        let inside = self
            .limits
            .is_none_or(|(from, to)| value >= from && value <= to);
        inside && self.model.reduce(q, workspace, out).is_ok()
    }
}

impl Model {
    /// Whether m and ½m′ come from a planar equivalent: of a model [for inertia alone](crate::ReducibleModel::for_inertia).
    pub fn is_in_plane(&self) -> bool {
        self.in_plane.is_some()
    }

    /// m and ½m′ from the planar equivalent; false where there is none, or no pose.
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
