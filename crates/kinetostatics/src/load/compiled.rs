//! The loads of a model: checked, and evaluated at a state of motion.

use super::signal::{SignalWorkspace, compile_signals};
use super::{
    AppliedWrench, CompiledSignal, Direction, ForceSource, Load, LoadKind, LoadPlaces, Magnitude,
    find_couple_points,
};
use crate::error::{KinetostaticsError, LoadError, Result};
use crate::mass::Mass;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{BodyId, JointId, Mechanism, Plan, PositionError, Vec2};
use dwell_numerics::Scalar;

/// The loads of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct CompiledLoads {
    pub(crate) loads: Vec<Load>,
    /// By load: the signals of its magnitude.
    pub(crate) compiled_signals: Vec<Vec<CompiledSignal>>,
    /// By load: where a couple between two bodies acts on each.
    pub(super) couple_points: Vec<[Vec2; 2]>,
    /// The bodies that have weight, with mass and centre.
    pub(crate) weighted_bodies: Vec<(BodyId, Mass)>,
}

/// The loads at one state of motion: working memory, and the results.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadState<T = f64> {
    /// By load: its magnitude F, in the unit of its kind.
    pub magnitude: Vec<T>,
    /// The wrenches of the loads on the bodies, in the order of the loads.
    pub wrenches: Vec<AppliedWrench<T>>,
    /// The acceleration of gravity of all such loads together, m/s².
    pub gravity: Vec2<T>,
    /// By body: the sum of the forces on it, N, and their moment about its origin, N·m.
    pub(crate) force: Vec<Vec2<T>>,
    pub(crate) moment: Vec<T>,
    /// By moving body: the forces on it and on all that it carries, N.
    pub(crate) subtree_force: Vec<Vec2<T>>,
    pub(crate) signal_workspace: SignalWorkspace<T>,
}

impl<T: Scalar> LoadState<T> {
    /// Sums the wrenches on each body.
    #[inline]
    pub(crate) fn sum_by_body(&mut self) {
        self.force.fill(Vec2::zero());
        self.moment.fill(T::from_f64(0.0));
        for wrench in &self.wrenches {
            self.force[wrench.body.0] += wrench.force;
            self.moment[wrench.body.0] += wrench.moment();
        }
    }
}

impl CompiledLoads {
    pub(crate) fn compile(
        mechanism: &Mechanism,
        plan: &Plan,
        masses: &[Mass],
        loads: Vec<Load>,
    ) -> Result<Self, LoadError> {
        let mut signals = Vec::with_capacity(loads.len());
        for (i, load) in loads.iter().enumerate() {
            let wrong = |what| LoadError { load: i, what };
            validate_load(mechanism, load).map_err(wrong)?;
            signals.push(compile_signals(mechanism, &load.magnitude).map_err(wrong)?);
        }
        let couple_points = loads.iter().map(|load| match *load.kind.bodies() {
            [one, two] => find_couple_points(mechanism, plan, [one, two]),
            _ => [Vec2::ZERO; 2],
        });
        let couple_points = couple_points.collect();
        let weight = |body: BodyId| {
            let mass = masses.get(body.0).copied()?;
            (mass.mass > 0.0).then_some((body, mass))
        };
        let bodies = plan.moving_bodies().iter();
        let weighted_bodies = bodies.filter_map(|c| weight(BodyId(c.body)));
        Ok(Self {
            loads,
            compiled_signals: signals,
            couple_points,
            weighted_bodies: weighted_bodies.collect(),
        })
    }

    pub(crate) fn state<T: Scalar>(&self, plan: &Plan) -> LoadState<T> {
        let bodies = plan.frames().orientations.len();
        let wrench_counts = self.loads.iter().map(|load| match load.kind {
            LoadKind::Gravity { .. } => self.weighted_bodies.len(),
            kind => kind.bodies().len(),
        });
        let signal_counts = self.compiled_signals.iter().map(Vec::len);
        LoadState {
            magnitude: vec![T::from_f64(0.0); self.loads.len()],
            wrenches: Vec::with_capacity(wrench_counts.sum()),
            gravity: Vec2::zero(),
            force: vec![Vec2::zero(); bodies],
            moment: vec![T::from_f64(0.0); bodies],
            subtree_force: vec![Vec2::zero(); plan.moving_bodies().len()],
            signal_workspace: SignalWorkspace::new(signal_counts.max().unwrap_or(0)),
        }
    }

    /// The magnitudes at time `t` (s). Friction and separating forces are zero until their reactions are known, an
    /// external magnitude until it is set.
    pub(crate) fn update_magnitudes<T: Scalar>(
        &self,
        t: f64,
        states: &BodyStates<T>,
        out: &mut LoadState<T>,
    ) -> Result<()> {
        let is_constant = |load: &Load| matches!(load.magnitude, Magnitude::Constant(_));
        if T::LANES > 1 && !self.loads.iter().all(is_constant) {
            // Laws and dry friction decide by one value.
            return Err(PositionError::LanesDiverge { q: f64::NAN }.into());
        }
        for (i, load) in self.loads.iter().enumerate() {
            if matches!(load.magnitude, Magnitude::External(_)) {
                out.magnitude[i] = T::from_f64(0.0);
                continue;
            }
            let workspace = &mut out.signal_workspace;
            out.magnitude[i] = self.eval_magnitude(i, &load.magnitude, t, states, workspace)?;
        }
        Ok(())
    }

    /// What a load acts on beside its own bodies.
    #[inline]
    fn places(&self, load: usize) -> LoadPlaces<'_> {
        LoadPlaces {
            weighted_bodies: &self.weighted_bodies,
            couple_points: self.couple_points[load],
        }
    }

    /// The wrenches of all loads at the magnitudes in `out`.
    pub(crate) fn update_wrenches<T: Scalar>(
        &self,
        states: &BodyStates<T>,
        out: &mut LoadState<T>,
    ) -> Result<()> {
        out.wrenches.clear();
        out.gravity = Vec2::zero();
        for (i, load) in self.loads.iter().enumerate() {
            let magnitude = out.magnitude[i];
            let (source, places) = (ForceSource::Load(i), self.places(i));
            (load
                .kind
                .add_wrenches(magnitude, source, &places, states, out))
            .ok_or(KinetostaticsError::NoDirection { load: i })?;
        }
        out.sum_by_body();
        Ok(())
    }

    /// The wrenches of a unit of one load alone: see [`Strength::unit`](super::Strength::unit).
    #[inline]
    pub(crate) fn unit_wrenches<T: Scalar>(
        &self,
        load: usize,
        states: &BodyStates<T>,
        out: &mut LoadState<T>,
    ) -> Result<()> {
        out.wrenches.clear();
        out.gravity = Vec2::zero();
        let (kind, sign) = self.loads[load].kind.unit_load();
        let (source, places) = (ForceSource::Load(load), self.places(load));
        (kind.add_wrenches(T::from_f64(sign), source, &places, states, out))
            .ok_or(KinetostaticsError::NoDirection { load })?;
        out.sum_by_body();
        Ok(())
    }

    /// The potential energy of a load, J, if it has one.
    pub(crate) fn potential_energy<T: Scalar>(
        &self,
        load: usize,
        states: &BodyStates<T>,
    ) -> Option<T> {
        let load = self.loads.get(load)?;
        if !load.does_work() {
            return Some(T::from_f64(0.0));
        }
        let along =
            |body, point, direction: Vec2| states.point(body, point).position.dot(direction.cast());
        let Magnitude::Constant(f) = load.magnitude else {
            return None;
        };
        match load.kind {
            LoadKind::Gravity { direction } => {
                let heights = self.weighted_bodies.iter().map(|&(body, mass)| {
                    T::from_f64(mass.mass) * along(body, mass.center, direction)
                });
                Some(T::from_f64(-f) * heights.fold(T::from_f64(0.0), |sum, one| sum + one))
            }
            LoadKind::Force {
                body,
                point,
                direction: Direction::Ground(direction),
            } => Some(T::from_f64(-f) * along(body, point, direction)),
            LoadKind::Along(coordinate, strength) => {
                let free = T::from_f64(strength.free()?);
                let stretch = states.coordinate(coordinate)[0] - free;
                Some(T::from_f64(0.5 * f) * stretch * stretch)
            }
            LoadKind::Force { .. } | LoadKind::Drag { .. } | LoadKind::Special(_) => None,
        }
    }
}

/// Refuses a load that does not fit the mechanism.
fn validate_load(mechanism: &Mechanism, load: &Load) -> Result<(), &'static str> {
    let there = |body: &BodyId| body.0 < mechanism.bodies.len();
    // A unit vector to rounding, from any way of normalising it.
    let unit = |v: Vec2| (v.norm() - 1.0).abs() < 1e-9;
    let finite = |points: &[Vec2]| points.iter().all(|p| p.is_finite());
    let is_sound = match &load.kind {
        LoadKind::Gravity { direction } => unit(*direction),
        LoadKind::Force {
            point, direction, ..
        } => unit(direction.vector()) && point.is_finite(),
        LoadKind::Drag { point, .. } => point.is_finite(),
        LoadKind::Along(CoordinateFunction::Angle(_), strength) => strength.is_sound(false),
        LoadKind::Along(CoordinateFunction::Travel(guide), strength) => {
            finite(&guide.points) && unit(guide.axis) && strength.is_sound(false)
        }
        LoadKind::Along(CoordinateFunction::Length { points, .. }, strength) => {
            finite(points) && strength.is_sound(true)
        }
        LoadKind::Special(mesh) => mesh.is_valid(),
    };
    if !load.kind.bodies().iter().all(there) {
        return Err("it acts on a body that does not exist");
    }
    if !is_sound {
        return Err(
            "its points and free value must be finite, its direction a unit vector, its free length not negative",
        );
    }
    let joint = |id: JointId| {
        let found = mechanism.joints.get(id.0);
        found.ok_or("its joint does not exist")
    };
    match load.magnitude {
        Magnitude::Constant(value) if !value.is_finite() => {
            Err("its magnitude is not a finite number")
        }
        Magnitude::Friction(friction) => friction.validate(joint(friction.joint)?, load.kind),
        Magnitude::Separating(teeth) => teeth.validate(joint(teeth.joint)?, load.kind),
        Magnitude::Constant(_)
        | Magnitude::Law(..)
        | Magnitude::Expression(..)
        | Magnitude::Function(..)
        | Magnitude::External(_) => Ok(()),
    }
}
