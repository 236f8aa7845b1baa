//! The length of an actuator that follows from the approximate angles of the bodies.

use super::{ActuatorId, ActuatorKind, Condition, Coordinate, JointId, JointKind, Mechanism};
use crate::plan::AssemblyConfiguration;
use crate::plane::Vec2;

/// Origin and orientation (cos, sin) of a body's frame.
type Frame = (Vec2, Vec2);

impl Mechanism {
    /// The distance, m, of the two points between which an actuator of a length acts, with the bodies at their
    /// approximate angles: from the ground on, each is placed by a joint to one that is placed already. `None` if the
    /// angles do not place both bodies, where the points coincide, and for any other actuator.
    ///
    /// The coordinates of the other actuators in `assembly` are exact and are used; that of the actuator itself is not.
    ///
    /// ```
    /// use dwell_geometry::{Actuator, ActuatorId, ActuatorKind, AssemblyConfiguration, Body, Joint, Mechanism, Vec2, vec2};
    ///
    /// // A boom on a pivot, and a cylinder from 3 m below the pivot to 4 m along the boom.
    /// let ends = [vec2(0.0, -3.0), vec2(4.0, 0.0)];
    /// let crane = Mechanism {
    ///     bodies: ["ground", "boom"].map(Body::named).into(),
    ///     joints: vec![Joint::revolute("O", [0, 1], [Vec2::ZERO; 2])],
    ///     actuators: vec![Actuator::new("lift", [0, 1], ActuatorKind::Length(ends))],
    ///     ..Mechanism::default()
    /// };
    /// let level = AssemblyConfiguration { initial_guess: vec![None, Some(0.0)], ..Default::default() };
    /// assert_eq!(crane.guessed_length(&level, ActuatorId(0)), Some(5.0));
    /// ```
    pub fn guessed_length(
        &self,
        assembly: &AssemblyConfiguration,
        actuator: ActuatorId,
    ) -> Option<f64> {
        let Coordinate::Length { bodies, points } = self.actuators.get(actuator.0)?.coordinate()
        else {
            return None;
        };
        let frames = self.guessed_frames(assembly);
        let mut ends = [Vec2::ZERO; 2];
        for (end, (body, point)) in ends.iter_mut().zip(bodies.into_iter().zip(points)) {
            let (origin, rotation) = frames.get(body.0).copied().flatten()?;
            *end = origin + point.rotate(rotation);
        }
        let length = (ends[1] - ends[0]).norm();
        (length > 0.0 && length.is_finite()).then_some(length)
    }

    /// Meshes racks and rolling discs in the assembly. If the assembly states the travel of the disc, the point P₁ moves along the pitch
    /// line or track, so that the disc is there at its angle. Without a travel P₁ is not moved, and angle 0 meets it.
    pub fn mesh_as_given(&mut self, assembly: &AssemblyConfiguration) {
        // A travel that the phase does not depend on says nothing about it.
        let mut other = assembly.clone();
        for (hint, joint) in other.branch_hints.iter_mut().zip(&self.joints) {
            let is_travel = joint.kind.travel_axis().is_some();
            *hint = hint.map(|value| value + if is_travel { 1.0 } else { 0.0 });
        }
        for j in 0..self.joints.len() {
            let Some((axis, _)) = self.joints[j].kind.rolled() else {
                continue;
            };
            let [given, elsewhere] = [assembly, &other].map(|at| self.unrolled(JointId(j), at));
            if let (Some(given), Some(elsewhere)) = (given, elsewhere)
                && given != elsewhere
            {
                self.joints[j].points[0] += axis * given;
            }
        }
    }

    /// t·(P₂ − P₁) + r (θ₂ − θ₁) of a rack or rolling disc, m, where the assembly places both bodies: zero where they mesh.
    fn unrolled(&self, JointId(j): JointId, assembly: &AssemblyConfiguration) -> Option<f64> {
        let joint = self.joints.get(j)?;
        let (axis, radius) = joint.kind.rolled()?;
        let (frames, angles) = (self.guessed_frames(assembly), self.guessed_angles(assembly));
        let [first, second] = joint
            .bodies
            .map(|b| Some((frames.get(b.0).copied()??, angles.get(b.0).copied()??)));
        let ((from, first_angle), (to, second_angle)) = (first?, second?);
        let point = |(origin, rotation): Frame, k: usize| origin + joint.points[k].rotate(rotation);
        let along = axis.rotate(from.1).dot(point(to, 1) - point(from, 0));
        Some(along + radius * (second_angle - first_angle))
    }

    /// The frames of the bodies that the approximate angles place.
    fn guessed_frames(&self, assembly: &AssemblyConfiguration) -> Vec<Option<Frame>> {
        let angles = self.guessed_angles(assembly);
        let mut frames = vec![None; self.bodies.len()];
        if let Some(ground) = frames.get_mut(self.ground) {
            *ground = Some((Vec2::ZERO, Vec2::IDENTITY));
        }
        let mut placed = true;
        while std::mem::take(&mut placed) {
            for (j, joint) in self.joints.iter().enumerate() {
                let known = joint.bodies.map(|b| frames.get(b.0).copied().flatten());
                let (from, to, sign) = match known {
                    [Some(first), None] => (first, 1, 1.0),
                    [None, Some(second)] => (second, 0, -1.0),
                    [Some(_), Some(_)] | [None, None] => continue,
                };
                let other = joint.bodies[to];
                let Some(angle) = angles.get(other.0).copied().flatten() else {
                    continue;
                };
                let rotation = Vec2::from_angle(angle);
                let first_rotation = if to == 1 { from.1 } else { rotation };
                let Some(gap) = self.guessed_gap(JointId(j), first_rotation, assembly) else {
                    continue;
                };
                let point = from.0 + joint.points[1 - to].rotate(from.1) + gap * sign;
                frames[other.0] = Some((point - joint.points[to].rotate(rotation), rotation));
                placed = true;
            }
        }
        frames
    }

    /// The angles of the bodies: those given, and those that a weld, a prismatic joint or an actuator adds to one known.
    fn guessed_angles(&self, assembly: &AssemblyConfiguration) -> Vec<Option<f64>> {
        let mut angles = assembly.initial_guess.clone();
        angles.resize(self.bodies.len(), None);
        if let Some(ground) = angles.get_mut(self.ground) {
            *ground = Some(0.0);
        }
        let by_joints = self.joints.iter().filter_map(|joint| {
            joint
                .kind
                .conditions()
                .find_map(|condition| match condition {
                    Condition::Turned { angle } => Some((joint.bodies, angle)),
                    _ => None,
                })
        });
        let by_actuators = self.actuators.iter().zip(&assembly.q);
        let by_actuators = by_actuators.filter_map(|(actuator, &q)| {
            (actuator.kind == ActuatorKind::Angle).then_some((actuator.bodies, q))
        });
        let steps: Vec<_> = by_joints.chain(by_actuators).collect();
        let mut found = true;
        while std::mem::take(&mut found) {
            for &([first, second], angle) in &steps {
                let known = [first, second].map(|b| angles.get(b.0).copied().flatten());
                let (body, value) = match known {
                    [Some(first), None] => (second, first + angle),
                    [None, Some(second)] => (first, second - angle),
                    [Some(_), Some(_)] | [None, None] => continue,
                };
                if let Some(unknown) = angles.get_mut(body.0) {
                    *unknown = Some(value);
                    found = true;
                }
            }
        }
        angles
    }

    /// The vector from a joint's first point to its second, m, if the first body has this orientation; `None` if the
    /// assembly does not determine it.
    fn guessed_gap(
        &self,
        joint: JointId,
        rotation: Vec2,
        assembly: &AssemblyConfiguration,
    ) -> Option<Vec2> {
        let kind = self.joints[joint.0].kind;
        if kind.holds_points_together() {
            return Some(Vec2::ZERO);
        }
        let hint = || assembly.branch_hints.get(joint.0).copied().flatten();
        if let JointKind::Distance { length } = kind {
            return Some(Vec2::from_angle(hint()?) * length);
        }
        let axis = kind.travel_axis()?.rotate(rotation);
        let mut actuators = self.actuators.iter().zip(&assembly.q);
        let actuated = actuators.find(|(a, _)| a.kind == ActuatorKind::Travel(joint));
        Some(axis * actuated.map(|(_, q)| *q).or_else(hint)?)
    }
}
