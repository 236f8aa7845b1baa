//! Loads that depend on the reactions of a joint: Coulomb friction, and the separating force of teeth. The friction of a
//! joint depends on its reaction, and the reaction on the friction:
//!
//! ```text
//! F_j = −φ_j g_j(R_j),    R = R⁰ + C F                                        (1)
//! φ = µ sign(v) or µ tanh(v/v₀) of a friction,    φ = −tan α of a separating force
//! ```
//!
//! with g the force times the radius in a pin, the sum of the forces on the ends of a guide, or the absolute tooth force (in space g and φ
//! are those of `space/friction.rs`); R⁰ the reactions without these loads, and C the contributions of a unit of each load to them. A
//! separating force adds nothing to tooth forces, but to the reactions on which friction depends. Where coordinates are free, R⁰ and C
//! include the effect of their accelerations. Newton's method solves (1) from F = 0. The determinant of its Jacobian is 1 without friction;
//! if it is not positive, the mechanism jams: the same state has two accelerations, or none.

use crate::error::{KinetostaticsError, Result};
use crate::load::{Friction, FrictionContact, Load};
use crate::pass::InverseDynamics;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{Mechanism, Reaction};
use dwell_numerics::{Scalar, lu, map_array};

/// Newton's steps after which a state counts as jammed.
const MAX_ITERATIONS: usize = 60;
/// Newton's method has converged when the forces change by less than this part of them,
const STEP_TOLERANCE: f64 = 4.0 * f64::EPSILON;
/// or by less than this part if the change no longer falls: next to a jam, rounding is amplified.
const STAGNATION_TOLERANCE: f64 = 1e-6;

/// How a load depends on `N` components of the reaction of its joint.
pub(crate) trait ContactLaw<const N: usize>: Copy {
    /// g(R), N·m or N, and its derivatives by the components.
    fn force<T: Scalar>(self, reaction: [T; N]) -> (T, [T; N]);
}

/// A load that depends on the reactions of a joint, compiled for a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DependentLoad<L = ReactionLaw, const N: usize = 2> {
    /// Index of its load.
    pub(crate) load: usize,
    /// Indices of the reactions it depends on; none for a component that it does not need.
    pub(crate) reactions: [Option<usize>; N],
    pub(crate) law: L,
}

/// The state of a load that depends on reactions: the quantity that is given in addition to its law.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum FrictionState<T> {
    /// Its factor φ follows from the speed of its surfaces; at rest a friction without regularisation is zero.
    #[default]
    BySpeed,
    /// Its factor φ, for surfaces that slide in one direction or are about to.
    Factor(f64),
    /// Its force, N·m or N, for surfaces that stick.
    Force(T),
}

/// How a load in the plane depends on the reactions of its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ReactionLaw {
    /// A friction, with the coordinate whose speed is that of the surfaces.
    Friction(Friction, CoordinateFunction),
    /// A separating force, by tan α.
    Separating { tangent: f64 },
}

impl ContactLaw<2> for ReactionLaw {
    fn force<T: Scalar>(self, reaction: [T; 2]) -> (T, [T; 2]) {
        match self {
            Self::Friction(friction, _) => friction.contact.force(reaction),
            Self::Separating { .. } => {
                let [tooth, _] = reaction;
                let sign = T::from_f64(if tooth.value() < 0.0 { -1.0 } else { 1.0 });
                (tooth * sign, [sign, T::from_f64(0.0)])
            }
        }
    }
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
            // Of a joint in space, which has more components: see there.
            Self::Bearing { .. } => return (zero, [zero; 2]),
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
        let slopes = [half * (signs[0] + signs[1]), lever * (signs[0] - signs[1])];
        (sum, slopes)
    }
}

/// Working memory of [`solve`].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrictionWorkspace<T> {
    /// The state of each load.
    pub(crate) known: Vec<FrictionState<T>>,
    /// All φ are multiplied by it: 1, but where the effect of their rounding is estimated.
    pub(crate) factor_scale: f64,
    /// By load: φ.
    friction_factor: Vec<T>,
    /// By load: F.
    pub(crate) force: Vec<T>,
    jacobian: Vec<T>,
    step: Vec<T>,
    pivots: Vec<usize>,
}

impl<T: Scalar> FrictionWorkspace<T> {
    pub(crate) fn new(count: usize) -> Self {
        let zero = T::from_f64(0.0);
        Self {
            known: vec![FrictionState::BySpeed; count],
            factor_scale: 1.0,
            friction_factor: vec![zero; count],
            force: vec![zero; count],
            jacobian: vec![zero; count * count],
            step: vec![zero; count],
            pivots: vec![0; count],
        }
    }
}

impl DependentLoad {
    /// The frictions and separating forces among a model's loads whose reactions the model computes.
    pub(crate) fn compile(
        mechanism: &Mechanism,
        loads: &[Load],
        reactions: &[Reaction],
    ) -> Vec<Self> {
        let compile = |(load, one): (usize, &Load)| {
            let mut indices = [None; 2];
            for (index, required) in indices.iter_mut().zip(required_reactions(mechanism, one)) {
                *index = reactions.iter().position(|r| *r == required);
            }
            let law = if let Some(friction) = one.friction() {
                // The surfaces slide along the coordinate of the load.
                ReactionLaw::Friction(friction, one.kind.sliding_coordinate()?)
            } else {
                let tangent = one.pressure_angle()?.angle.tan();
                // Without its tooth force it is in a model that computes nothing on which it could act.
                indices[0]?;
                ReactionLaw::Separating { tangent }
            };
            Some(Self {
                load,
                reactions: indices,
                law,
            })
        };
        loads.iter().enumerate().filter_map(compile).collect()
    }

    /// φ.
    pub(crate) fn factor<T: Scalar>(&self, states: &BodyStates<T>) -> T {
        match self.law {
            ReactionLaw::Friction(friction, coordinate) => {
                let [_, velocity, _] = states.coordinate(coordinate);
                friction.factor(velocity)
            }
            ReactionLaw::Separating { tangent } => T::from_f64(-tangent),
        }
    }

    /// A friction that holds its surfaces at rest, with the coordinate along which they slide.
    pub(crate) fn sticking(&self) -> Option<(Friction, CoordinateFunction)> {
        match self.law {
            ReactionLaw::Friction(friction, coordinate) => {
                Some((friction, coordinate)).filter(|_| friction.regularization_speed.is_none())
            }
            ReactionLaw::Separating { .. } => None,
        }
    }
}

impl<L: ContactLaw<N>, const N: usize> DependentLoad<L, N> {
    /// g of these reactions, N·m or N: the force of a unit of φ.
    pub(crate) fn contact_force<T: Scalar>(&self, reactions: &[T]) -> T {
        self.law.force(self.components(reactions)).0
    }

    fn components<T: Scalar>(&self, reactions: &[T]) -> [T; N] {
        map_array(self.reactions, |index| {
            index.map_or(T::from_f64(0.0), |k| reactions[k])
        })
    }
}

impl Friction {
    /// φ of surfaces that slide at this speed.
    pub(crate) fn factor<T: Scalar>(&self, velocity: T) -> T {
        let Some(speed) = self.regularization_speed else {
            let speed = velocity.value();
            let sign = if speed == 0.0 { 0.0 } else { speed.signum() };
            return T::from_f64(self.coefficient * sign);
        };
        let tanh = (velocity.value() / speed).tanh();
        let slope = (1.0 - tanh * tanh) / speed;
        velocity.compose(&[tanh, slope, 0.0, 0.0]) * T::from_f64(self.coefficient)
    }
}

/// The reactions on which the magnitude of a load depends.
pub(crate) fn required_reactions(mechanism: &Mechanism, load: &Load) -> Vec<Reaction> {
    let friction = load.friction().into_iter();
    let tooth_force = load.pressure_angle().map(|teeth| teeth.tooth_force());
    let of_friction = friction.flat_map(|friction| friction.required_reactions(mechanism));
    of_friction.chain(tooth_force).collect()
}

/// Solves (1): `by_speed` yields φ of a load from the speed of its surfaces, `frictionless` are the reactions without these
/// loads, `responses[j]` the contribution of a unit of load j to each. The forces are then in `workspace.force`.
///
/// # Errors
/// [`KinetostaticsError::SelfLocking`] where there is no unique solution.
pub(crate) fn solve<T: Scalar, L: ContactLaw<N>, const N: usize>(
    dependent_loads: &[DependentLoad<L, N>],
    by_speed: impl Fn(&DependentLoad<L, N>) -> T,
    frictionless: &[T],
    responses: &[InverseDynamics<T>],
    workspace: &mut FrictionWorkspace<T>,
) -> Result<()> {
    let load = dependent_loads.first().map_or(0, |first| first.load);
    let self_locking = KinetostaticsError::SelfLocking { load };
    let factors = workspace.friction_factor.iter_mut().zip(&workspace.known);
    for (dependent, (factor, known)) in dependent_loads.iter().zip(factors) {
        *factor = match *known {
            FrictionState::BySpeed => by_speed(dependent),
            FrictionState::Factor(factor) => T::from_f64(factor),
            FrictionState::Force(_) => T::from_f64(0.0),
        } * T::from_f64(workspace.factor_scale);
    }
    for (force, known) in workspace.force.iter_mut().zip(&workspace.known) {
        *force = match *known {
            FrictionState::Force(force) => force,
            FrictionState::BySpeed | FrictionState::Factor(_) => T::from_f64(0.0),
        };
    }
    let (mut converged, mut last) = (0, f64::INFINITY);
    for _ in 0..MAX_ITERATIONS {
        let largest = workspace.linearise(dependent_loads, frictionless, responses);
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
    /// Residual and Jacobian of (1) at the current forces, and the largest |φ g|.
    fn linearise<L: ContactLaw<N>, const N: usize>(
        &mut self,
        dependent_loads: &[DependentLoad<L, N>],
        frictionless: &[T],
        responses: &[InverseDynamics<T>],
    ) -> f64 {
        let n = dependent_loads.len();
        let mut largest = 0.0_f64;
        for (j, dependent) in dependent_loads.iter().enumerate() {
            let mut reaction = dependent.components(frictionless);
            for (force, response) in self.force.iter().zip(responses) {
                let unit = dependent.components(&response.reactions);
                for (sum, one) in reaction.iter_mut().zip(unit) {
                    *sum += one * *force;
                }
            }
            let (contact_force, slopes) = dependent.law.force(reaction);
            let factor = self.friction_factor[j];
            let given = match self.known[j] {
                FrictionState::Force(force) => force,
                FrictionState::BySpeed | FrictionState::Factor(_) => T::from_f64(0.0),
            };
            self.step[j] = given - (self.force[j] + factor * contact_force);
            for (k, response) in responses.iter().enumerate() {
                let unit = dependent.components(&response.reactions);
                let diagonal = if j == k { 1.0 } else { 0.0 };
                let slope = along(slopes, unit);
                self.jacobian[j * n + k] = T::from_f64(diagonal) + factor * slope;
            }
            largest = largest.max((factor * contact_force).value().abs());
        }
        largest
    }
}

/// The sum of the products of two lists, from the first on.
#[inline(always)]
fn along<T: Scalar, const N: usize>(slopes: [T; N], unit: [T; N]) -> T {
    let mut products = slopes.into_iter().zip(unit).map(|(slope, one)| slope * one);
    // Not from zero: the sum of two products stays what it is to the last bit.
    let first = products.next().unwrap_or(T::from_f64(0.0));
    products.fold(first, |sum, product| sum + product)
}
