//! How several programs close loops in URDF.

use super::{Reader, axis, kind, origin};
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Along, End, Joint, Kind};
use crate::pose::{Matrix, Pose, length, sub};
use crate::settle::frame;
use crate::xml::Element;

impl<'d> Reader<'d> {
    fn close(
        &mut self,
        name: String,
        element: Element<'d>,
        kind: Kind,
        [first, second]: [End; 2],
        dialect: &str,
    ) -> Result<(), DoorError> {
        if first.body == second.body {
            return Err(element.error("the loop connects a link with itself", ""));
        }
        let gap = length(sub(
            self.model.drawn(&first).origin,
            self.model.drawn(&second).origin,
        ));
        let apart = if gap > 1e-9 {
            format!(", {gap:.3} m apart at zero")
        } else {
            String::new()
        };
        element.note(
            Effect::Kept,
            format!("{name}: closes a loop ({dialect}){apart}"),
        );
        self.model.joints.push(Joint {
            name,
            place: element.place(),
            kind,
            first,
            second,
            in_tree: false,
            drawn: 0.0,
            along: Along::default(),
        });
        Ok(())
    }

    fn loop_name(&self, element: &Element<'d>) -> String {
        let count = self
            .model
            .joints
            .iter()
            .filter(|joint| !joint.in_tree)
            .count();
        element
            .attribute("name")
            .map_or(format!("loop{}", count + 1), str::to_owned)
    }

    /// A joint of SDF in a `gazebo` element; its pose is in the child.
    pub(super) fn gazebo(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let _ = element.attribute("reference");
        for joint in element
            .children()
            .into_iter()
            .filter(|one| one.tag() == "joint")
        {
            let name = self.loop_name(&joint);
            let kind = kind(&joint)?;
            let link = |tag| self.body(&joint, joint.child_text(tag));
            let [parent, child] = [link("parent")?, link("child")?];
            let numbers = joint
                .child_text("pose")
                .map(|text| joint.exactly("pose", text))
                .transpose()?;
            let [x, y, z, roll, pitch, yaw] = numbers.unwrap_or_default();
            let pose = Pose {
                origin: [x, y, z],
                turn: Matrix::roll_pitch_yaw([roll, pitch, yaw]),
            };
            let along_axis = Pose {
                turn: Matrix::z_along(axis(joint)?),
                ..Pose::IDENTITY
            };
            let second = End {
                body: child,
                frame: pose.then(along_axis),
            };
            let first = self.model.seen_from(parent, &second);
            self.close(name, joint, kind, [first, second], "a Gazebo joint")?;
        }
        Ok(())
    }

    /// `loop_joint` of Isaac Sim and Drake: each link has its own frame.
    pub(super) fn loop_joint(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let name = self.loop_name(&element);
        let kind = kind(&element)?;
        let turned = Pose {
            turn: Matrix::z_along(axis(element)?),
            ..Pose::IDENTITY
        };
        let end = |tag| {
            let link = element.child(tag);
            let body = self.body(&element, link.and_then(|link| link.attribute("link")))?;
            Ok::<End, DoorError>(End {
                body,
                frame: origin(link)?.then(turned),
            })
        };
        let ends = [end("link1")?, end("link2")?];
        self.close(name, element, kind, ends, "loop_joint")
    }

    /// `loop` and `loop_constraint` of URDF+.
    pub(super) fn constraint(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let name = self.loop_name(&element);
        let kind = kind(&element)?;
        let turned = Pose {
            turn: Matrix::z_along(axis(element)?),
            ..Pose::IDENTITY
        };
        // An exporter writes `sucessor`, and the name of the link in `name`.
        let end = |tags: [&str; 3], place: &str| {
            let side = tags.iter().find_map(|tag| element.child(tag));
            let link =
                side.and_then(|side| side.attribute("link").or_else(|| side.attribute("name")));
            let inner = side.and_then(|side| side.child("origin"));
            let frame = origin(inner.or_else(|| element.child(place)))?.then(turned);
            let body = self.body(&element, link)?;
            Ok::<End, DoorError>(End { body, frame })
        };
        let first = end(["predecessor", "parent", "predecessor"], "parent_origin")?;
        let second = end(["successor", "sucessor", "child"], "child_origin")?;
        self.close(name, element, kind, [first, second], "URDF+")
    }

    /// The YAML file of an extended URDF: `closed_loop`, `type`, `name_mot`.
    pub(super) fn extended(&mut self, text: &str) -> Result<(), DoorError> {
        let lists = |key: &str| {
            let line = text.lines().find_map(|line| {
                line.trim()
                    .strip_prefix(key)?
                    .trim_start()
                    .strip_prefix(':')
            });
            let words = line.unwrap_or_default().split(['[', ']', ',']);
            let words = words.map(|word| word.trim().trim_matches(['\'', '"']).to_owned());
            words
                .filter(|word| !word.is_empty())
                .collect::<Vec<String>>()
        };
        let kinds = [lists("type"), lists("joint_type")].concat();
        let names = lists("joint_name");
        for (k, pair) in lists("closed_loop").chunks_exact(2).enumerate() {
            let [first, second] = [frame(&self.model, &pair[0])?, frame(&self.model, &pair[1])?];
            let kind = match kinds
                .get(k)
                .map(|kind| kind.to_ascii_lowercase())
                .as_deref()
            {
                Some("6d" | "fixed") => Kind::Fixed,
                _ => Kind::Ball,
            };
            let count = self
                .model
                .joints
                .iter()
                .filter(|joint| !joint.in_tree)
                .count();
            let place = self.model.bodies[second.body].place.clone();
            let name = names
                .get(k)
                .cloned()
                .unwrap_or(format!("loop{}", count + 1));
            let text = format!(
                "{name}: closes a loop between {} and {} (YAML)",
                pair[0], pair[1]
            );
            self.model.findings.add(&place, Effect::Kept, text);
            self.model.joints.push(Joint {
                name,
                place,
                kind,
                first,
                second,
                in_tree: false,
                drawn: 0.0,
                along: Along::default(),
            });
        }
        for motor in lists("name_mot") {
            if let Some(joint) = self.model.joint_named(&motor) {
                self.model.drive(joint);
            }
        }
        Ok(())
    }
}
