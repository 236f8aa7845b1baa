//! Whole turns of the angles that loads depend on, whatever coordinate carries the motion.

use super::{Atlas, Site};
use crate::drive::DriveKind;
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{Body, BodyId, Coordinate, Joint, JointKind, Mechanism, Relation, Vec2};
use dwell_kinetostatics::{LoadKind, Magnitude, Signal};
use dwell_laws::{Law, Polynomial};

impl Atlas<'_> {
    /// A mechanism in which the turns of all angles are counted whose values loads depend on, and the
    /// angles of its bodies. Each such angle turns a massless witness.
    pub(super) fn counting(
        &self,
        mut mechanism: Mechanism,
        states: &BodyStates,
    ) -> (Mechanism, Vec<Option<f64>>) {
        let angle = |b: usize| {
            let state = states.body(BodyId(b));
            Some(state.angle.unwrap_or_else(|| state.turn.angle()))
        };
        let mut rough: Vec<Option<f64>> = (0..mechanism.bodies.len()).map(angle).collect();
        let ground = BodyId(mechanism.ground);
        for bodies in angles_used(&self.site) {
            let by = Coordinate::Angle(bodies);
            if mechanism.actuators.iter().any(|a| a.coordinate() == by) {
                continue;
            }
            let witness = BodyId(mechanism.bodies.len());
            let name = format!("turns of {}", mechanism.body_name(bodies[1]));
            mechanism.bodies.push(Body { name: name.clone() });
            rough.push(Some(states.angle(bodies)[0]));
            let joint = |kind| Joint {
                name: name.clone(),
                bodies: [ground, witness],
                points: [Vec2::ZERO; 2],
                kind,
            };
            let relation = JointKind::Relation(mechanism.relations.len());
            mechanism
                .joints
                .extend([joint(JointKind::Revolute), joint(relation)]);
            mechanism.relations.push(Relation {
                of: Coordinate::Angle([ground, witness]),
                by,
                law: Law::Polynomial(Polynomial {
                    coefficients: vec![0.0, 1.0],
                }),
            });
        }
        (mechanism, rough)
    }
}

/// The angles whose values, not only speeds, a load or drive depends on.
pub(super) fn angles_used(site: &Site<'_>) -> Vec<[BodyId; 2]> {
    let mut used = Vec::new();
    let mut of = |magnitude: &Magnitude| {
        let signals = match magnitude {
            Magnitude::Law(signal, _) => std::slice::from_ref(signal),
            Magnitude::Expression(_, signals) => signals.as_slice(),
            _ => &[],
        };
        for signal in signals {
            if let Signal::Value(Coordinate::Angle(bodies)) = signal {
                used.push(*bodies);
            }
        }
    };
    for load in site.loads {
        of(&load.magnitude);
    }
    for drive in site.drives {
        match &drive.kind {
            DriveKind::Action(magnitude) => of(magnitude),
            DriveKind::Motor(motor) => of(&motor.voltage),
            DriveKind::Regulator(regulator) => of(&regulator.speed),
        }
    }
    used.extend(site.loads.iter().filter_map(|load| match load.kind {
        LoadKind::TorsionSpring { bodies, .. } => Some(bodies),
        _ => None,
    }));
    used
}
