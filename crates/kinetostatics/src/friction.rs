//! Coulomb friction in joints. The friction of a joint depends on its reaction, and the reaction on the friction:
//!
//! ```text
//! F_j = −µ_j g_j(R_j) tanh(v_j/v₀_j),    R = R⁰ + C F                         (1)
//! ```
//!
//! with g the force times the radius in a pin, or the sum of the forces on the ends of a guide; R⁰ the
//! reactions without friction and C what a unit of each friction adds to them. Where coordinates are
//! free, R⁰ and C include the effect of their accelerations. Newton's method solves (1) from F = 0. The
//! determinant of its Jacobian is 1 without friction; where it is no longer positive the mechanism jams:
//! the same state has two accelerations, or none.

use crate::error::{KinetostaticsError, Result};
use crate::load::{Friction, FrictionContact, Load, LoadKind};
use crate::pass::InverseDynamics;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{Mechanism, Reaction};
use dwell_numerics::{Scalar, lu};

/// Newton's steps after which a state counts as jammed.
const MAX_ITERATIONS: usize = 60;
/// Newton's method has converged when the forces change by less than this part of them,
const STEP_TOLERANCE: f64 = 4.0 * f64::EPSILON;
/// or by less than this part if the change no longer falls: next to a jam, rounding is amplified.
const STAGNATION_TOLERANCE: f64 = 1e-6;

/// A friction, compiled for a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointFriction {
    /// Index of its load.
    pub(crate) load: usize,
    /// Indices of the reactions it depends on; none for a component that it does not need.
    reactions: [Option<usize>; 2],
    friction: Friction,
    /// The coordinate whose speed is that of the surfaces.
    coordinate: CoordinateFunction,
}

impl FrictionContact {
    /// g(R), N·m or N, and its derivatives by both components.
    fn force<T: Scalar>(self, [x, y]: [T; 2]) -> (T, [T; 2]) {
        let zero = T::from_f64(0.0);
        let length = match self {
            Self::Pin { radius } => {
                let radius = T::from_f64(radius);
                let square = x * x + y * y;
                if square.value() == 0.0 {
                    return (zero, [zero; 2]);
                }
                let force = square.sqrt();
                return (radius * force, [radius * x / force, radius * y / force]);
            }
            Self::Guide { length } => length,
        };
        // The force x at the middle of the guide and the moment y press on its ends.
        let half = T::from_f64(0.5);
        let (lever, ends) = if length > 0.0 {
            let lever = T::from_f64(1.0 / length);
            (lever, [half * x + lever * y, half * x - lever * y])
        } else {
            (zero, [half * x; 2])
        };
        let signs = ends.map(|end| T::from_f64(if end.value() < 0.0 { -1.0 } else { 1.0 }));
        let sum = ends[0] * signs[0] + ends[1] * signs[1];
        (
            sum,
            [half * (signs[0] + signs[1]), lever * (signs[0] - signs[1])],
        )
    }
}

/// Working memory of [`solve`].
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct FrictionWorkspace<T> {
    /// By friction: µ tanh(v/v₀).
    friction_factor: Vec<T>,
    /// By friction: F.
    pub(crate) force: Vec<T>,
    jacobian: Vec<T>,
    step: Vec<T>,
    pivots: Vec<usize>,
}

impl<T: Scalar> FrictionWorkspace<T> {
    pub(crate) fn new(count: usize) -> Self {
        let zero = T::from_f64(0.0);
        Self {
            friction_factor: vec![zero; count],
            force: vec![zero; count],
            jacobian: vec![zero; count * count],
            step: vec![zero; count],
            pivots: vec![0; count],
        }
    }
}

impl JointFriction {
    /// The frictions among a model's loads, which depend on reactions that the model computes.
    pub(crate) fn compile(
        mechanism: &Mechanism,
        loads: &[Load],
        reactions: &[Reaction],
    ) -> Vec<Self> {
        let compile = |(load, one): (usize, &Load)| {
            let friction = one.friction()?;
            let mut indices = [None; 2];
            let required = friction.required_reactions(mechanism);
            for (index, required) in indices.iter_mut().zip(required) {
                *index = reactions.iter().position(|r| *r == required);
            }
            // The check of the loads leaves no other kinds.
            let coordinate = match one.kind {
                LoadKind::SlideForce(guide) => guide.travel(),
                _ => CoordinateFunction::Angle(mechanism.joints[friction.joint.0].bodies),
            };
            Some(Self {
                load,
                reactions: indices,
                friction,
                coordinate,
            })
        };
        loads.iter().enumerate().filter_map(compile).collect()
    }

    /// µ tanh(v/v₀).
    fn factor<T: Scalar>(&self, states: &BodyStates<T>) -> T {
        let [_, velocity, _] = states.coordinate(self.coordinate);
        let speed = self.friction.regularization_speed;
        let tanh = (velocity.value() / speed).tanh();
        let slope = (1.0 - tanh * tanh) / speed;
        velocity.compose(&[tanh, slope, 0.0, 0.0]) * T::from_f64(self.friction.coefficient)
    }

    fn components<T: Scalar>(&self, reactions: &[T]) -> [T; 2] {
        self.reactions
            .map(|index| index.map_or(T::from_f64(0.0), |k| reactions[k]))
    }
}

/// Solves (1): `frictionless` are the reactions without friction, `responses[j]` what a unit of friction j adds to
/// each. The frictions are then in `workspace.force`.
///
/// # Errors
/// [`KinetostaticsError::SelfLocking`] where there is no unique solution.
pub(crate) fn solve<T: Scalar>(
    frictions: &[JointFriction],
    states: &BodyStates<T>,
    frictionless: &[T],
    responses: &[InverseDynamics<T>],
    workspace: &mut FrictionWorkspace<T>,
) -> Result<()> {
    let load = frictions.first().map_or(0, |friction| friction.load);
    let self_locking = KinetostaticsError::SelfLocking { load };
    for (joint_friction, factor) in frictions.iter().zip(&mut workspace.friction_factor) {
        *factor = joint_friction.factor(states);
    }
    workspace.force.fill(T::from_f64(0.0));
    let (mut converged, mut last) = (0, f64::INFINITY);
    for _ in 0..MAX_ITERATIONS {
        let largest = workspace.linearise(frictions, frictionless, responses);
        let factored = lu::factor(&mut workspace.jacobian, &mut workspace.pivots);
        if factored.determinant_sign <= 0.0 || factored.pivot_ratio < f64::EPSILON {
            return Err(self_locking);
        }
        lu::solve(&workspace.jacobian, &workspace.pivots, &mut workspace.step);
        let mut change = 0.0_f64;
        for (force, step) in workspace.force.iter_mut().zip(&workspace.step) {
            *force += *step;
            change = change.max(step.value().abs());
        }
        // One step past convergence: it makes the derivative of a dual number exact.
        let stagnated = change <= STAGNATION_TOLERANCE * largest && change > 0.5 * last;
        converged += usize::from(change <= STEP_TOLERANCE * largest || stagnated);
        last = change;
        if converged == 2 {
            return Ok(());
        }
        if !change.is_finite() {
            return Err(self_locking);
        }
    }
    Err(self_locking)
}

impl<T: Scalar> FrictionWorkspace<T> {
    /// Residual and Jacobian of (1) at the current forces, and the largest |µ g tanh|.
    fn linearise(
        &mut self,
        frictions: &[JointFriction],
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
    ) -> f64 {
        let n = frictions.len();
        let mut largest = 0.0_f64;
        for (j, joint_friction) in frictions.iter().enumerate() {
            let mut reaction = joint_friction.components(frictionless);
            for (force, response) in self.force.iter().zip(responses) {
                let [x, y] = joint_friction.components(&response.reactions);
                reaction[0] += x * *force;
                reaction[1] += y * *force;
            }
            let (contact_force, [by_x, by_y]) = joint_friction.friction.contact.force(reaction);
            let factor = self.friction_factor[j];
            self.step[j] = -(self.force[j] + factor * contact_force);
            for (k, response) in responses.iter().enumerate() {
                let [x, y] = joint_friction.components(&response.reactions);
                let diagonal = if j == k { 1.0 } else { 0.0 };
                self.jacobian[j * n + k] = T::from_f64(diagonal) + factor * (by_x * x + by_y * y);
            }
            largest = largest.max((factor * contact_force).value().abs());
        }
        largest
    }
}
