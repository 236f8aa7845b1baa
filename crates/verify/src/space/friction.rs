//! Dry friction in the joints of a state: its forces from reactions of the dense equations, and from speeds of theirs.

use super::DensePose;
use crate::error::Result;
use crate::friction::{Contact, bearings, coefficient_at, contact_forces};
use dwell_geometry::space::{BodyMotion, Joint, JointKind, Placement, Vec3, Wrench};
use dwell_kinetostatics::LoadShape as _;
use dwell_kinetostatics::space::{LoadKind, Mass};
use dwell_kinetostatics::{Friction, FrictionContact};

impl DensePose<'_> {
    /// The loads, with the forces of frictions at speeds and accelerations of the actuators, by load. NaN if friction locks itself.
    ///
    /// # Errors
    /// [`DenseError`](crate::DenseError) where the equations have no singular values.
    pub fn with_friction(
        &self,
        rates: [&[f64]; 2],
        (loads, frictions): (&[(LoadKind, f64)], &[Option<Friction>]),
    ) -> Result<Vec<(LoadKind, f64)>> {
        let rest = vec![0.0; rates[0].len()];
        let own = self.solve(rates, loads);
        let given = frictions.iter().enumerate();
        let given = given.filter_map(|(load, friction)| Some((load, friction.as_ref()?)));
        let given: Vec<(usize, &Friction)> = given.collect();
        let mass_free = vec![Mass::default(); self.masses.len()];
        let unloaded = DensePose::new(self.mechanism, &mass_free, self.placements)?;
        let units = given.iter().map(|(load, _)| {
            let unit = [(loads[*load].0, 1.0)];
            unloaded.solve([&rest, &rest], &unit).reactions
        });
        let units: Vec<Vec<Wrench>> = units.collect();
        let contacts = given.iter().map(|(load, friction)| {
            let law = self.law(friction, &own.motions);
            let of = |reactions: &Vec<Wrench>| {
                bearings(friction, law.axis(), &reactions[friction.joint.0])
            };
            Contact {
                factor: law.factor(loads[*load].0),
                own: of(&own.reactions),
                units: units.iter().map(of).collect(),
            }
        });
        let forces = contact_forces(&contacts.collect::<Vec<_>>())
            .unwrap_or_else(|| vec![f64::NAN; given.len()]);
        let mut all = loads.to_vec();
        for ((load, _), force) in given.into_iter().zip(forces) {
            all[load].1 = force;
        }
        Ok(all)
    }

    /// The rates of the travel along the axis of a friction's joint and of the angle about it, in m/s and rad/s, at speeds of the actuators.
    pub fn sliding(&self, q_dot: &[f64], friction: &Friction) -> [f64; 2] {
        self.law(friction, &self.velocities(q_dot)).speeds()
    }

    fn law<'a>(&'a self, friction: &'a Friction, motions: &'a [BodyMotion]) -> Law<'a> {
        Law {
            joint: &self.mechanism.joints[friction.joint.0],
            friction,
            placements: self.placements,
            motions,
        }
    }
}

/// The law of the friction of a joint in a state.
struct Law<'a> {
    joint: &'a Joint,
    friction: &'a Friction,
    placements: &'a [Placement],
    motions: &'a [BodyMotion],
}

impl Law<'_> {
    fn axis(&self) -> Vec3 {
        let body = self.joint.side_body(0).0;
        let axis = self.placements[body]
            .rotation
            .apply(self.joint.sides[0].axis);
        axis.unit().unwrap_or(axis)
    }

    /// The rates of the travel along the axis and of the angle about it.
    fn speeds(&self) -> [f64; 2] {
        let of = |k: usize| {
            let body = self.joint.side_body(k).0;
            let arm = self.placements[body]
                .rotation
                .apply(self.joint.sides[k].point);
            let motion = &self.motions[body];
            (motion.point_velocity(arm), motion.angular_velocity)
        };
        let ((v_a, w_a), (v_b, w_b)) = (of(0), of(1));
        let u = self.axis();
        // Along the axis the points differ by a multiple of it, which the rotation of the first body does not lengthen.
        [u.dot(v_b - v_a), u.dot(w_b - w_a)]
    }

    /// φ: the factor of the bearing forces, against the velocity along the load.
    fn factor(&self, kind: LoadKind) -> f64 {
        let [travel, turn] = self.speeds();
        let radius = match self.friction.contact {
            FrictionContact::Bearing { radius, .. } => radius,
            FrictionContact::Guide { .. } | FrictionContact::Pin { .. } => 1.0,
        };
        let is_couple = kind.is_couple();
        let coefficient = |speed| coefficient_at(self.friction, speed);
        if self.joint.kind == JointKind::Cylindrical {
            let surface = [travel, radius * turn];
            let speed = surface[0].hypot(surface[1]);
            let part = if speed == 0.0 {
                0.0
            } else {
                surface[usize::from(is_couple)] / speed
            };
            let lever = if is_couple { radius } else { 1.0 };
            return coefficient(speed) * part * lever;
        }
        if is_couple {
            coefficient(turn) * radius
        } else {
            coefficient(travel)
        }
    }
}
