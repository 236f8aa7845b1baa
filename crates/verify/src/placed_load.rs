//! Loads at given positions of the bodies: their forces and potentials by the definitions of their kinds and laws, for the plane and for
//! space, independent of the crate `kinetostatics`.

use crate::wrenches::BodyWrench;
use dwell_geometry::BodyId;
use dwell_geometry::space::Vec3;
use dwell_kinetostatics::Strength;
use std::f64::consts::TAU;

/// A load at a position and velocity of the bodies, in the axes of the ground.
pub(crate) enum PlacedLoad {
    /// In this direction on bodies with this mass and centre.
    Weight(Vec3, Vec<(BodyId, f64, Vec3)>),
    /// A force at a point, in a direction that may turn with a body.
    Force {
        body: BodyId,
        point: Vec3,
        direction: Vec3,
        turns: bool,
    },
    /// Against the velocity of a point.
    Drag {
        body: BodyId,
        point: Vec3,
        velocity: Vec3,
    },
    Along(Line, Strength),
    /// These forces times the magnitude.
    Given(Vec<BodyWrench>),
}

/// The line of action of a load along a coordinate of two bodies.
pub(crate) struct Line {
    pub(crate) bodies: [BodyId; 2],
    /// The points on both bodies.
    pub(crate) points: [Vec3; 2],
    /// The axis of the couple or the direction of the force on the second body; NaN if two points coincide.
    pub(crate) along: Vec3,
    pub(crate) kind: LineKind,
    /// The coordinate and its rate.
    pub(crate) value: f64,
    pub(crate) rate: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LineKind {
    Angle { counts_turns: bool },
    Travel,
    Distance,
}

impl PlacedLoad {
    pub(crate) fn wrenches(&self, magnitude: f64) -> Vec<BodyWrench> {
        match self {
            Self::Weight(direction, bodies) => {
                let weight = |&(body, mass, center): &(BodyId, f64, Vec3)| {
                    force_on(body, center, direction.scaled(mass * magnitude))
                };
                bodies.iter().map(weight).collect()
            }
            &Self::Force {
                body,
                point,
                direction,
                ..
            } => vec![force_on(body, point, direction.scaled(magnitude))],
            &Self::Drag {
                body,
                point,
                velocity,
            } => {
                let force = velocity.scaled(-magnitude * velocity.norm());
                vec![force_on(body, point, force)]
            }
            Self::Along(line, law) => line.wrenches(*law, magnitude),
            Self::Given(wrenches) => {
                let times = |wrench: &BodyWrench| BodyWrench {
                    force: wrench.force.scaled(magnitude),
                    couple: wrench.couple.scaled(magnitude),
                    ..*wrench
                };
                wrenches.iter().map(times).collect()
            }
        }
    }

    /// ½ F s² of a spring, −F · displacement of weight and of a force that keeps its direction, J; none of other loads.
    pub(crate) fn potential(&self, magnitude: f64) -> Option<f64> {
        match self {
            Self::Weight(direction, bodies) => {
                let heights = bodies
                    .iter()
                    .map(|(_, mass, center)| mass * center.dot(*direction));
                Some(-magnitude * heights.sum::<f64>())
            }
            Self::Force {
                point,
                direction,
                turns: false,
                ..
            } => Some(-magnitude * point.dot(*direction)),
            Self::Along(line, Strength::Elastic { free }) => {
                let stretch = line.stretch(*free);
                Some(0.5 * magnitude * stretch * stretch)
            }
            Self::Force { .. }
            | Self::Along(_, Strength::Direct | Strength::Viscous | Strength::Quadratic)
            | Self::Drag { .. }
            | Self::Given(_) => None,
        }
    }
}

impl Line {
    /// A spring pulls back, a damper is against the rate, the drag of a fluid grows with its square.
    fn wrenches(&self, law: Strength, magnitude: f64) -> Vec<BodyWrench> {
        let force = match law {
            Strength::Direct => magnitude,
            Strength::Elastic { free } => magnitude * (free - self.value),
            Strength::Viscous => -magnitude * self.rate,
            Strength::Quadratic => -magnitude * self.rate.powi(2).copysign(self.rate),
        };
        let ([first, second], [from, to]) = (self.bodies, self.points);
        let force = match (law, self.kind) {
            // It needs no direction.
            (Strength::Elastic { free: 0.0 }, LineKind::Distance) => (from - to).scaled(magnitude),
            _ => self.along.scaled(force),
        };
        if let LineKind::Angle { .. } = self.kind {
            return BodyWrench::pair(self.bodies, Vec3::ZERO, Vec3::ZERO, force).into();
        }
        vec![force_on(first, from, -force), force_on(second, to, force)]
    }

    /// How far it is from where a spring has no force; of an angle without counted turns, on the shorter way.
    fn stretch(&self, free: f64) -> f64 {
        let stretch = self.value - free;
        match self.kind {
            LineKind::Angle {
                counts_turns: false,
            } => stretch - TAU * (stretch / TAU).round(),
            _ => stretch,
        }
    }
}

fn force_on(body: BodyId, point: Vec3, force: Vec3) -> BodyWrench {
    BodyWrench {
        body,
        force,
        point,
        couple: Vec3::ZERO,
    }
}
