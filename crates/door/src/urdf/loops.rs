//! How several programs close loops in URDF.

use super::{Reader, axis, kind, origin};
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{End, Joint, Kind};
use crate::pose::{Matrix, Pose, length, sub};
use crate::settle::frame;
use crate::xml::Element;

impl<'d> Reader<'d> {
    fn close(&mut self, element: Element<'d>, ends: [End; 2]) -> Result<(), DoorError> {
        if ends[0].body == ends[1].body {
            return Err(element.error("the loop connects a link with itself"));
        }
        let name = self.model.loop_name(element.attribute("name"));
        let places = ends.map(|end| self.model.drawn(&end).origin);
        let gap = length(sub(places[0], places[1]));
        let apart = if gap > 1e-9 {
            format!(", {gap:.3} m apart at zero")
        } else {
            String::new()
        };
        element.kept(format!("{name}: {} closes a loop{apart}", element.tag()));
        let joint = Joint::new(name, element.place(), kind(&element)?, ends);
        self.model.joints.push(joint);
        Ok(())
    }

    /// A joint of SDF in a `gazebo` element; its pose is in the child.
    pub(super) fn gazebo(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let _ = element.attribute("reference");
        for joint in element.called("joint") {
            let link = |tag| self.body(&joint, joint.child_text(tag));
            let [parent, child] = [link("parent")?, link("child")?];
            let [x, y, z, turns @ ..] = joint.child_vector::<6>("pose")?.unwrap_or_default();
            let pose = Pose::new([x, y, z], Matrix::roll_pitch_yaw(turns));
            let second = End::new(child, pose.then(Pose::along([0.0; 3], axis(joint)?)));
            let first = self.model.seen_from(parent, &second);
            self.close(joint, [first, second])?;
        }
        Ok(())
    }

    /// `loop_joint` of Isaac Sim, `loop` and `loop_constraint` of URDF+: each link has its own frame.
    pub(super) fn loop_element(&mut self, element: Element<'d>) -> Result<(), DoorError> {
        let turned = Pose::along([0.0; 3], axis(element)?);
        let end = |tags: [&str; 3], place: &str| {
            let side = tags.iter().find_map(|tag| element.child(tag));
            // The link, or its name in `name`; the frame there, in an `origin` inside, or beside.
            let link =
                side.and_then(|side| side.attribute("link").or_else(|| side.attribute("name")));
            let inner = side
                .and_then(|side| side.child("origin"))
                .or_else(|| element.child(place));
            let frame = origin(inner.or(side))?.then(turned);
            Ok(End::new(self.body(&element, link)?, frame))
        };
        let first = end(["link1", "predecessor", "parent"], "parent_origin")?;
        // One exporter writes `sucessor`.
        let successor = if element.child("sucessor").is_some() {
            "sucessor"
        } else {
            "successor"
        };
        let second = end(["link2", successor, "child"], "child_origin")?;
        self.close(element, [first, second])
    }

    /// The YAML file of an extended URDF: `closed_loop`, `type`, `name_mot`.
    pub(super) fn extended(&mut self, text: &str) -> Result<(), DoorError> {
        let list = |key: &str| {
            let value = |line: &'_ str| {
                Some(
                    line.trim()
                        .strip_prefix(key)?
                        .trim()
                        .strip_prefix(':')?
                        .to_owned(),
                )
            };
            let line = text.lines().find_map(value).unwrap_or_default();
            let words = line
                .split(['[', ']', ','])
                .map(|word| word.trim().trim_matches(['\'', '"']));
            words
                .filter(|word| !word.is_empty())
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        let kinds = [list("type"), list("joint_type")].concat();
        let names = list("joint_name");
        for (k, pair) in list("closed_loop").chunks_exact(2).enumerate() {
            let ends = [frame(&self.model, &pair[0])?, frame(&self.model, &pair[1])?];
            let kind = match kinds
                .get(k)
                .map(|kind| kind.to_ascii_lowercase())
                .as_deref()
            {
                Some("6d" | "fixed") => Kind::Fixed,
                _ => Kind::Ball,
            };
            let place = self.model.bodies[ends[1].body].place.clone();
            let name = self.model.loop_name(names.get(k).map(String::as_str));
            let text = format!(
                "{name}: closes a loop between {} and {} (YAML)",
                pair[0], pair[1]
            );
            self.model.note(&place, Effect::Kept, text);
            self.model.joints.push(Joint::new(name, place, kind, ends));
        }
        for motor in list("name_mot") {
            if let Some(joint) = self.model.joint_named(&motor) {
                self.model.drive(joint);
            }
        }
        Ok(())
    }
}
