//! A coupling of two coordinates by a law, such as a cam or a table. With y and x the dependent and the independent coordinate, each a
//! freedom of the tree over a factor,
//!
//! ```text
//! Φ = y − f(x),     ∂Φ/∂y = 1,     ∂Φ/∂x = −f′,     Φ̈ = ÿ − f′ ẍ − f″ ẋ²                         (1)
//! ```
//!
//! Its multiplier λ acts along y, and −λ f′ along x, each within the joint whose coordinate it is.

use super::coordinate::Coordinate;
use super::joint_kinds::JointKind;
use super::mechanism::{ActuatorKind, Mechanism};
use super::plan::{Plan, Pose};
use super::tree::{Driver, Tree};
use crate::error::{AssemblyError, PositionError};
use crate::mechanism::JointId;
use dwell_laws::Law;
use dwell_numerics::{Constant, Lift};

/// A coupling in terms of the freedoms of the tree.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Coupled<C = f64> {
    law: Law,
    /// y and x.
    pub(super) coordinates: [Driver<C>; 2],
}

impl Coordinate {
    /// The same coordinate as one that an actuator could drive; `measured` is the joint that measures a distance.
    pub(super) fn driven_kind(self, measured: Option<JointId>) -> Option<ActuatorKind> {
        match self {
            Self::Angle(joint) => Some(ActuatorKind::Angle(joint)),
            Self::Travel(joint) => Some(ActuatorKind::Travel(joint)),
            Self::Distance { .. } => measured.map(ActuatorKind::Length),
        }
    }
}

impl Mechanism {
    /// The coordinates of the couplings, in order, each with the joint that has the coupling.
    pub(super) fn coupled(&self) -> impl Iterator<Item = (JointId, Coordinate)> {
        self.joints.iter().enumerate().flat_map(|(j, joint)| {
            let coupling = match joint.kind {
                JointKind::Coupling { index, .. } => self.couplings.get(index),
                _ => None,
            };
            let both = coupling.map(|of| [of.dependent, of.independent]);
            both.into_iter().flatten().map(move |of| (JointId(j), of))
        })
    }

    /// Whether the coordinates of a joint are needed: it is driven or coupled.
    pub(super) fn needs_coordinate(&self, joint: JointId) -> bool {
        let names = |of: Coordinate| matches!(of, Coordinate::Angle(j) | Coordinate::Travel(j) if j == joint);
        self.is_driven(joint) || self.coupled().any(|(_, of)| names(of))
    }

    /// Whether the law of a coupling is a table.
    pub(super) fn has_tables(&self) -> bool {
        self.couplings
            .iter()
            .any(|coupling| matches!(coupling.law, Law::Spline(_)))
    }

    /// The inconsistency of a coupling, if there is any.
    pub(super) fn coupling_fault(&self, r: usize) -> Option<&'static str> {
        let Some(coupling) = self.couplings.get(r) else {
            return Some("a joint refers to a coupling that does not exist");
        };
        let both = [coupling.dependent, coupling.independent];
        let exists = |of: &Coordinate| match *of {
            Coordinate::Angle(joint) => {
                self.joints.get(joint.0).is_some_and(|j| j.kind.has_angle())
            }
            Coordinate::Travel(joint) => self
                .joints
                .get(joint.0)
                .is_some_and(|j| j.kind.has_travel()),
            Coordinate::Distance { bodies, points } => {
                let known = bodies.iter().all(|b| b.0 < self.bodies.len());
                known && bodies[0] != bodies[1] && points.iter().all(|p| p.is_finite())
            }
        };
        if !both.iter().all(exists) {
            return Some("a coupling names a coordinate that does not exist");
        }
        (both[0] == both[1]).then_some("a coupling couples a coordinate to itself")
    }
}

impl Coupled {
    /// The coupling of these coordinates; none if one of them is no freedom of the tree.
    pub(super) fn new(tree: &Tree, law: &Law, kinds: [ActuatorKind; 2]) -> Option<Self> {
        let [dependent, independent] = kinds.map(|kind| tree.driven(kind));
        Some(Self {
            law: law.clone(),
            coordinates: [dependent?, independent?],
        })
    }

    /// With the factors of a tree whose numbers have another type.
    pub(super) fn with_numbers<C: Constant>(&self, tree: &Tree<C>) -> Coupled<C> {
        let driver = |of: Driver| Driver {
            freedom: of.freedom,
            factor: tree.factor(of),
            is_force: of.is_force,
        };
        Coupled {
            law: self.law.clone(),
            coordinates: self.coordinates.map(driver),
        }
    }
}

impl<C: Constant> Coupled<C> {
    fn x<T: Lift<C>>(&self, coordinates: &[T]) -> T {
        self.coordinates[1].coordinate(coordinates)
    }

    /// Φ.
    pub(super) fn residual<T: Lift<C>>(&self, coordinates: &[T]) -> T {
        let x = self.x(coordinates);
        self.coordinates[0].coordinate(coordinates) - x.compose(&self.law.eval(x.value()))
    }

    /// The derivatives of Φ by the two freedoms.
    pub(super) fn derivatives<T: Lift<C>>(&self, coordinates: &[T]) -> [T; 2] {
        let x = self.x(coordinates);
        let [_, slope, bend, third] = self.law.eval(x.value());
        let [y_factor, x_factor] = [0, 1].map(|k| T::lift(self.coordinates[k].factor));
        let slope = x.compose(&[slope, bend, third, 0.0]);
        [T::from_f64(1.0) / y_factor, -slope / x_factor]
    }

    /// Φ̈ without accelerations of the freedoms.
    pub(super) fn acceleration<T: Lift<C>>(&self, coordinates: &[T], rates: &[T]) -> T {
        let (x, rate) = (self.x(coordinates), self.x(rates));
        let [_, _, bend, third] = self.law.eval(x.value());
        -x.compose(&[bend, third, 0.0, 0.0]) * rate * rate
    }

    /// x, and the end of the law's table that it exceeds, if it does.
    fn off_table<T: Lift<C>>(&self, coordinates: &[T]) -> Option<[f64; 2]> {
        let x = self.x(coordinates).value();
        Some([x, self.law.end_passed(x)?])
    }
}

impl Coupled {
    /// Whether its function ends or jumps soon beyond a pose that moves.
    fn end(&self, pose: &Pose) -> Option<CouplingEnd> {
        let (x, rate) = (self.x(&pose.coordinates), self.x(&pose.motion.rates));
        let step = BEYOND * (1.0 + x.abs()) * rate.signum();
        if self.law.end_passed(x + step).is_some() {
            return Some(CouplingEnd::Table);
        }
        let jump = self.law.discontinuity(x - step, x + step);
        jump.map(|_| CouplingEnd::Jump)
    }
}

impl<C: Constant> Plan<C> {
    /// The coupling whose table has no value at the coordinates in a pose, its variable, and the end of the table, rad or m.
    pub(super) fn off_table<T: Lift<C>>(&self, pose: &Pose<T>) -> Option<(JointId, [f64; 2])> {
        self.closures.iter().find_map(|closure| {
            let coupled = closure.coupled.as_ref()?;
            Some((closure.joint?, coupled.off_table(&pose.coordinates)?))
        })
    }

    /// Requires that the tables of the couplings have values. Few mechanisms have any.
    #[cold]
    pub(super) fn check_tables<T: Lift<C>>(
        &self,
        q: f64,
        pose: &Pose<T>,
    ) -> Result<(), PositionError> {
        match self.off_table(pose) {
            None => Ok(()),
            Some((coupling, [x, end])) => Err(PositionError::OffTable {
                coupling,
                q,
                x,
                end,
            }),
        }
    }
}

/// Why a coupling ends the range of the coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CouplingEnd {
    /// Its table has no value beyond.
    Table,
    /// Its function jumps there.
    Jump,
}

/// How far beyond the end of a range the function of a coupling is examined, relative to one more than its variable (rad or m).
const BEYOND: f64 = 1e-6;

impl Plan {
    /// By end of the range of the only coordinate: the coupling that ends it, if one does.
    pub fn coupling_ends(&self) -> [Option<(JointId, CouplingEnd)>; 2] {
        let mut pose = self.pose::<f64>();
        let limits = self.range.limits();
        let end = |upper: bool| {
            let (from, to) = limits.filter(|_| self.range_ends[usize::from(upper)])?;
            let (q, direction) = if upper { (to, 1.0) } else { (from, -1.0) };
            self.positions(&[q], &mut pose).ok()?;
            self.velocities(&[direction], &mut pose);
            self.closures.iter().find_map(|closure| {
                let coupled = closure.coupled.as_ref()?;
                Some((closure.joint?, coupled.end(&pose)?))
            })
        };
        [false, true].map(end)
    }

    /// As [`Plan::check_tables`], at the assembly.
    pub(super) fn check_tables_at_start(&self, pose: &Pose) -> Result<(), AssemblyError> {
        match self.off_table(pose) {
            None => Ok(()),
            Some((coupling, [x, end])) => Err(AssemblyError::OffTable { coupling, x, end }),
        }
    }
}
