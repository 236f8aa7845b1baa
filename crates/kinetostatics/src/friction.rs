//! Coulomb friction in joints. What a joint rubs with depends on its reaction, and that on what rubs:
//!
//! ```text
//! F_j = −µ_j g_j(R_j) tanh(v_j/v₀_j),    R = R⁰ + C F                         (1)
//! ```
//!
//! with g the force times the radius in a pin, or the sum of what presses on the ends of a guide; R⁰ the
//! reactions without friction and C what a unit of each friction adds to them. Where coordinates are
//! free, R⁰ and C hold what their accelerations answer. Newton's method solves (1) from F = 0. The
//! determinant of its Jacobian is 1 without friction; where it is no longer positive the mechanism jams:
//! the same state has two accelerations, or none.

use crate::kinetostatics::KinetostaticsError;
use crate::load::{Friction, LoadKind, Magnitude};
use crate::model::{Actions, Model, Workspace};
use dwell_geometry::measure::Measured;
use dwell_geometry::{Component, JointKind, Mechanism, Reaction, Scalar, small};

/// Newton's steps before a state is said to jam.
const MOST_STEPS: usize = 60;
/// A change of the frictions below this part of them is none.
const SETTLED: f64 = 4.0 * f64::EPSILON;
/// Below this part it is none if it falls no further: next to where it jams, rounding is amplified.
const STUCK: f64 = 1e-6;

/// A friction with what it needs of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rub {
    /// Its load.
    pub(crate) load: usize,
    /// The reactions it depends on, by their place in the model's.
    pub(crate) reactions: [Option<usize>; 2],
    friction: Friction,
    turns: bool,
    /// Its speed is that of this coordinate.
    travel: Measured,
}

impl Friction {
    /// What is wrong with it, if anything.
    pub(crate) fn check(&self, mechanism: &Mechanism, kind: LoadKind) -> Result<(), &'static str> {
        let Some(joint) = mechanism.joints.get(self.joint.0) else {
            return Err("it rubs in a joint that is not there");
        };
        let numbers = [self.coefficient, self.size];
        let fades = self.fade > 0.0;
        if !(fades && numbers.iter().all(|n| n.is_finite() && *n >= 0.0)) {
            return Err("a coefficient, size or speed of friction that makes no sense");
        }
        let fits = match (joint.kind, kind) {
            (JointKind::Revolute, LoadKind::Torque { bodies }) => bodies == joint.bodies,
            (JointKind::Prismatic { .. } | JointKind::Slot { .. }, LoadKind::Slide(guide)) => {
                guide.bodies == joint.bodies
            }
            _ => false,
        };
        if fits {
            Ok(())
        } else {
            Err("its joint is no revolute joint, prismatic joint or slot between its bodies")
        }
    }

    /// The reactions it depends on.
    pub fn reactions(&self, mechanism: &Mechanism) -> Vec<Reaction> {
        let joint = self.joint;
        let components = mechanism.components(joint).iter();
        let wanted = components.filter(|c| **c != Component::Moment || self.size > 0.0);
        wanted
            .map(|&component| Reaction { joint, component })
            .collect()
    }

    /// g(R), N·m or N, and its derivatives by both components.
    fn pressure<T: Scalar>(&self, turns: bool, [x, y]: [T; 2]) -> (T, [T; 2]) {
        let (zero, size) = (T::lift(0.0), T::lift(self.size));
        if turns {
            let square = x * x + y * y;
            if square.value() == 0.0 {
                return (zero, [zero; 2]);
            }
            let force = square.sqrt();
            return (size * force, [size * x / force, size * y / force]);
        }
        // The force x at the middle of the guide and the moment y press on its ends.
        let half = T::lift(0.5);
        let (lever, ends) = if self.size > 0.0 {
            let lever = T::lift(1.0 / self.size);
            (lever, [half * x + lever * y, half * x - lever * y])
        } else {
            (zero, [half * x; 2])
        };
        let signs = ends.map(|end| T::lift(if end.value() < 0.0 { -1.0 } else { 1.0 }));
        let sum = ends[0] * signs[0] + ends[1] * signs[1];
        (
            sum,
            [half * (signs[0] + signs[1]), lever * (signs[0] - signs[1])],
        )
    }
}

/// Working memory of a solution for the frictions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Rubbing<T> {
    /// By friction: µ tanh(v/v₀).
    grip: Vec<T>,
    /// By friction: F.
    force: Vec<T>,
    matrix: Vec<T>,
    step: Vec<T>,
    pivots: Vec<usize>,
}

impl<T: Scalar> Rubbing<T> {
    pub(crate) fn new(count: usize) -> Self {
        let zero = T::lift(0.0);
        Self {
            grip: vec![zero; count],
            force: vec![zero; count],
            matrix: vec![zero; count * count],
            step: vec![zero; count],
            pivots: vec![0; count],
        }
    }
}

impl Rub {
    /// The frictions among a model's loads.
    ///
    /// # Errors
    /// The load whose joint's reactions the model does not compute.
    pub(crate) fn find(mechanism: &Mechanism, model: &Model) -> Result<Vec<Self>, usize> {
        let mut found = Vec::new();
        for (load, one) in model.loads().iter().enumerate() {
            let Magnitude::Friction(friction) = one.magnitude else {
                continue;
            };
            let mut reactions = [None; 2];
            for (place, wanted) in reactions.iter_mut().zip(friction.reactions(mechanism)) {
                let computed = model.reactions().iter().position(|r| *r == wanted);
                *place = Some(computed.ok_or(load)?);
            }
            let travel = match one.kind {
                LoadKind::Slide(guide) => guide.travel(),
                _ => Measured::Angle(mechanism.joints[friction.joint.0].bodies),
            };
            found.push(Self {
                load,
                reactions,
                friction,
                turns: matches!(one.kind, LoadKind::Torque { .. }),
                travel,
            });
        }
        Ok(found)
    }

    fn of<T: Scalar>(&self, reactions: &[T]) -> [T; 2] {
        self.reactions
            .map(|place| place.map_or(T::lift(0.0), |k| reactions[k]))
    }
}

impl Model {
    /// The loads that are frictions, by their place in [`Model::loads`].
    pub fn frictions(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.rubs.iter().map(|rub| rub.load)
    }

    /// Solves (1) at the state last entered: `without` are the reactions at zero friction, and
    /// `by_unit[j]` what a unit of friction j adds to each (its [channel](Model::channel), and what free
    /// coordinates answer it with). The frictions become the magnitudes of their
    /// loads; what the loads do to the bodies is brought up to date.
    ///
    /// # Errors
    /// [`KinetostaticsError::Jams`] where there is no single solution.
    pub fn rub<T: Scalar>(
        &self,
        without: &[T],
        by_unit: &[Actions<T>],
        work: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        let loaded = &mut work.loaded;
        let rubbing = &mut loaded.rubbing;
        let n = self.rubs.len();
        for (rub, grip) in self.rubs.iter().zip(&mut rubbing.grip) {
            let [_, speed, _] = loaded.states.measure(rub.travel);
            let tanh = (speed.value() / rub.friction.fade).tanh();
            let slope = (1.0 - tanh * tanh) / rub.friction.fade;
            *grip = speed.through(&[tanh, slope, 0.0, 0.0]) * T::lift(rub.friction.coefficient);
        }
        rubbing.force.fill(T::lift(0.0));
        let (mut settled, mut last) = (0, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let mut size = 0.0_f64;
            for (j, rub) in self.rubs.iter().enumerate() {
                let mut reaction = rub.of(without);
                for (force, unit) in rubbing.force.iter().zip(by_unit) {
                    let [x, y] = rub.of(&unit.reactions);
                    reaction[0] += x * *force;
                    reaction[1] += y * *force;
                }
                let (pressure, [by_x, by_y]) = rub.friction.pressure(rub.turns, reaction);
                let grip = rubbing.grip[j];
                rubbing.step[j] = -(rubbing.force[j] + grip * pressure);
                for (k, unit) in by_unit.iter().enumerate() {
                    let [x, y] = rub.of(&unit.reactions);
                    let own = if j == k { 1.0 } else { 0.0 };
                    rubbing.matrix[j * n + k] = T::lift(own) + grip * (by_x * x + by_y * y);
                }
                size = size.max((grip * pressure).value().abs());
            }
            let factored = small::factor(&mut rubbing.matrix, &mut rubbing.pivots);
            let jams = KinetostaticsError::Jams {
                load: self.rubs.first().map_or(0, |rub| rub.load),
            };
            if factored.sign <= 0.0 || factored.measure < f64::EPSILON {
                return Err(jams);
            }
            small::solve(&rubbing.matrix, &rubbing.pivots, &mut rubbing.step);
            let mut change = 0.0_f64;
            for (force, step) in rubbing.force.iter_mut().zip(&rubbing.step) {
                *force += *step;
                change = change.max(step.value().abs());
            }
            // One step past convergence: it makes the derivative of a dual number exact.
            let stuck = change <= STUCK * size && change > 0.5 * last;
            settled += usize::from(change <= SETTLED * size || stuck);
            last = change;
            if settled == 2 {
                for (rub, force) in self.rubs.iter().zip(&rubbing.force) {
                    loaded.loads.magnitude[rub.load] = *force;
                }
                return self.loads.act(&loaded.states, &mut loaded.loads);
            }
            if !change.is_finite() {
                return Err(jams);
            }
        }
        Err(KinetostaticsError::Jams {
            load: self.rubs.first().map_or(0, |rub| rub.load),
        })
    }
}
