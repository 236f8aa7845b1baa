//! Counted revolutions of the angles that loads depend on, in every chart.

use super::{Atlas, MachineDescription};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{Body, BodyId, Coordinate, Coupling, Joint, JointKind, Mechanism, Vec2};
use dwell_kinetostatics::Magnitude;
use dwell_laws::{Law, Polynomial};

impl Atlas<'_> {
    /// A mechanism in which the revolutions of all angles are counted whose values loads depend on, and the
    /// angles of its bodies. Each such angle turns an auxiliary body without mass.
    pub(super) fn with_counted_revolutions(
        &self,
        mut mechanism: Mechanism,
        states: &BodyStates,
    ) -> (Mechanism, Vec<Option<f64>>) {
        let angle = |b: usize| {
            let state = states.body(BodyId(b));
            Some(state.angle.unwrap_or_else(|| state.rotation.angle()))
        };
        let mut initial_guess: Vec<Option<f64>> = (0..mechanism.bodies.len()).map(angle).collect();
        let ground = BodyId(mechanism.ground);
        for bodies in load_angles(&self.description) {
            let by = Coordinate::Angle(bodies);
            if mechanism.actuators.iter().any(|a| a.coordinate() == by) {
                continue;
            }
            let auxiliary = BodyId(mechanism.bodies.len());
            let name = format!("revolutions of {}", mechanism.body_name(bodies[1]));
            mechanism.bodies.push(Body::named(&name));
            initial_guess.push(Some(states.angle(bodies)[0]));
            let joint = |kind| Joint::new(&name, [ground, auxiliary], [Vec2::ZERO; 2], kind);
            let relation = JointKind::Coupling(mechanism.couplings.len());
            mechanism
                .joints
                .extend([joint(JointKind::Revolute), joint(relation)]);
            mechanism.couplings.push(Coupling {
                dependent: Coordinate::Angle([ground, auxiliary]),
                independent: by,
                law: Law::Polynomial(Polynomial {
                    coefficients: vec![0.0, 1.0],
                }),
            });
        }
        (mechanism, initial_guess)
    }
}

/// The angles whose values, not only speeds, a load or drive depends on.
pub(super) fn load_angles(description: &MachineDescription<'_>) -> Vec<[BodyId; 2]> {
    let loads = description.loads.iter().map(|load| &load.magnitude);
    let drives = description.drives.iter().map(|drive| drive.kind.input());
    let by_signals = loads.chain(drives).flat_map(Magnitude::angle_pairs);
    let by_kinds = description.loads.iter();
    by_signals
        .chain(by_kinds.filter_map(|load| load.kind.angle_pair()))
        .collect()
}
