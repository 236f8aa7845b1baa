//! Joints and motions of ASMT.

use super::Reader;
use super::tree::Node;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Along, End, Joint, Kind, Motion};
use crate::pose::{Matrix, Pose, dot, sub};

impl<'t> Reader<'t> {
    fn end(&self, joint: Node<'t>, key: &str) -> Result<End, DoorError> {
        let path = joint.value(key);
        let marker = self.markers.get(&path);
        let end = marker.map(|(body, frame)| End {
            body: *body,
            frame: *frame,
        });
        end.ok_or_else(|| joint.error(&format!("there is no marker `{path}`")))
    }

    pub(super) fn joint(&mut self, node: Node<'t>) -> Result<(), DoorError> {
        let place = node.place();
        let name = node.value("Name");
        let [mut first, second] = [self.end(node, "MarkerI")?, self.end(node, "MarkerJ")?];
        let distance = || match node.child("distanceIJ") {
            Some(distance) => distance.numbers::<1>().map(|[distance]| distance),
            None => Err(node.error("the joint has no distance")),
        };
        let kind = match node.text() {
            "RevoluteJoint" => Kind::Hinge,
            "CylindricalJoint" => Kind::Cylinder,
            "FixedJoint" => Kind::Fixed,
            "TranslationalJoint" => Kind::Slide,
            "SphericalJoint" => Kind::Ball,
            "PlanarJoint" => Kind::Planar,
            "SphSphJoint" => Kind::Distance(distance()?),
            other => {
                let text = format!("{other} {name}: left out (changes the motion)");
                self.model.findings.add(&place, Effect::Changes, text);
                return Ok(());
            }
        };
        if first.body == second.body {
            return Err(node.error("the joint connects a part with itself"));
        }
        // The coordinate as drawn: the angle from x to x about z, or the travel along z.
        let [here, there] = [self.model.drawn(&first), self.model.drawn(&second)];
        let [x, y, z] = [0, 1, 2].map(|k| here.turn.column(k));
        let travel = dot(z, sub(there.origin, here.origin));
        let mut drawn = 0.0;
        if kind == Kind::Slide || kind == Kind::Cylinder {
            // A scene draws the points of a slide where its travel is zero.
            first.frame = first.frame.then(Pose::at([0.0, 0.0, travel]));
            drawn = travel;
        }
        if kind == Kind::Hinge || kind == Kind::Cylinder {
            let other = there.turn.column(0);
            drawn = dot(y, other).atan2(dot(x, other));
            // The frames agree as drawn: the angle counts from there.
            let turn = Matrix::about([0.0, 0.0, 1.0], drawn);
            first.frame.turn = first.frame.turn.times(turn);
        }
        self.model.joints.push(Joint {
            name,
            place,
            kind,
            first,
            second,
            in_tree: false,
            drawn,
            along: Along::default(),
        });
        Ok(())
    }

    pub(super) fn motion(&mut self, node: Node<'t>, duration: f64) -> Result<(), DoorError> {
        let path = node.value("MotionJoint");
        let name = path.rsplit('/').next().unwrap_or_default();
        let joint = self.model.joint_named(name);
        let Some(joint) = joint.filter(|joint| self.model.joints[*joint].is_driveable()) else {
            let text = format!("{} of {path}: left out (changes the motion)", node.text());
            self.model
                .findings
                .add(&node.place(), Effect::Changes, text);
            return Ok(());
        };
        let key = if self.model.joints[joint].is_angle() {
            "RotationZ"
        } else {
            "TranslationZ"
        };
        let law = node.value(key);
        let expression =
            expression(&law).ok_or_else(|| node.error(&format!("the law `{law}` is not read")))?;
        let _ = node.value("Name");
        let text = format!("motion of {name}: {key} = {law}, drives it");
        self.model.findings.add(&node.place(), Effect::Kept, text);
        if let Some(drive) = self.model.drive(joint) {
            drive.motion = Motion::Expression(expression, duration);
        }
        Ok(())
    }
}

/// A law in `time` as an expression of a scene in t.
fn expression(law: &str) -> Option<String> {
    let functions = ["sin", "cos", "tan", "sqrt", "exp", "abs", "pi"];
    let mut text = String::new();
    let mut rest = law.trim();
    while let Some(first) = rest.chars().next() {
        let is_number = first.is_ascii_digit() || first == '.';
        let belongs = |c: &char| {
            if is_number {
                c.is_ascii_digit() || *c == '.'
            } else {
                c.is_ascii_alphanumeric() || *c == '_'
            }
        };
        let mut length: usize = rest.chars().take_while(belongs).map(char::len_utf8).sum();
        if is_number {
            // An exponent, and the `d` of a float.
            let after = rest[length..].strip_prefix(['e', 'E']);
            let digits = after.map(|after| after.trim_start_matches(['+', '-']));
            if digits.is_some_and(|digits| digits.starts_with(|c: char| c.is_ascii_digit())) {
                let exponent = digits
                    .unwrap_or_default()
                    .chars()
                    .take_while(char::is_ascii_digit)
                    .count();
                length = rest.len() - digits.map_or(0, str::len) + exponent;
            }
            text += &rest[..length];
            rest = rest[length..].strip_prefix('d').unwrap_or(&rest[length..]);
        } else if length > 0 {
            match &rest[..length] {
                "time" => text.push('t'),
                word if functions.contains(&word) => text += word,
                _ => return None,
            }
            rest = &rest[length..];
        } else if "+-*/^() ,".contains(first) {
            text.push(first);
            rest = &rest[1..];
        } else {
            return None;
        }
    }
    (!text.is_empty()).then_some(text)
}

#[test]
fn floats_with_a_letter_and_the_time_become_an_expression_of_a_scene() {
    assert_eq!(
        expression("1.0 + 2.0d*pi*time").as_deref(),
        Some("1.0 + 2.0*pi*t")
    );
    assert_eq!(
        expression("1.5e-3d*sin(time)").as_deref(),
        Some("1.5e-3*sin(t)")
    );
    assert_eq!(expression("system(1)"), None);
}
