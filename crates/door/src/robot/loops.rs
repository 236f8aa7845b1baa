//! How several programs close loops in URDF.

use super::joints::{kind, side};
use super::{Reader, pose, xyz_rpy};
use crate::error::Result;
use crate::model::{End, Joint, Kind};
use crate::pose::{Pose, length, sub};
use crate::settle::{driveable, frame};
use crate::xml::Element;

impl<'d> Reader<'d> {
    /// Loops that elements close, and the YAML file beside.
    pub(super) fn loops(&mut self, parts: &[Element<'d>], beside: Option<&str>) -> Result<()> {
        for part in parts {
            match part.tag() {
                "gazebo" => self.gazebo(*part)?,
                "loop_joint" | "loop" | "loop_constraint" => self.loop_element(*part)?,
                _ => {}
            }
        }
        beside.map_or(Ok(()), |text| self.extended(text))
    }

    /// Names a joint that closes a loop.
    fn name_loop(&self, joint: &Joint, how: &str) {
        let [first, second] = joint.ends.map(|end| end.frame.origin);
        let apart = match length(sub(first, second)) {
            gap if gap > 1e-9 => format!(", {gap:.6} m apart at zero"),
            _ => String::new(),
        };
        let text = format!("{}: {how} closes a loop{apart}", joint.name);
        joint.place.kept(text);
    }

    /// A joint of SDF in a `gazebo` element; its pose is in the child.
    fn gazebo(&mut self, element: Element<'d>) -> Result<()> {
        let _ = element.attribute("reference");
        for joint in element.called("joint") {
            let child = self.in_world(side(joint, &["child"]), &joint)?;
            let name = self.model.loop_name(joint.attribute("name"));
            self.joint(&name, joint, child.then(pose(joint)?.0))?;
            if let Some(joint) = self.model.joints.last() {
                self.name_loop(joint, "joint");
            }
        }
        Ok(())
    }

    /// `loop_joint` of Isaac Sim, `loop` and `loop_constraint` of URDF+: each link has its own frame.
    fn loop_element(&mut self, element: Element<'d>) -> Result<()> {
        let kind = kind(element)?;
        let axis = self.axis(element, "axis", kind, &Pose::IDENTITY)?;
        let end = |tags: &[&str], beside: &str| {
            let link = side(element, tags);
            let body = self.body_of(link, &element)?;
            // The frame is in an `origin` inside, beside, or in the attributes.
            let inner = tags.iter().find_map(|tag| element.child(tag));
            let origin = inner.and_then(|inner| inner.child("origin"));
            let origin = origin.or(element.child(beside)).or(inner);
            let frame = origin.map_or(Ok(Pose::IDENTITY), xyz_rpy)?;
            let frame = frame.then(Pose::along([0.0; 3], axis));
            let frame = self.model.bodies[body].pose.then(frame);
            Ok(End::new(body, frame))
        };
        // One exporter writes `sucessor`.
        let ends = [
            end(&["link1", "predecessor", "parent"], "parent_origin")?,
            end(&["link2", "successor", "sucessor", "child"], "child_origin")?,
        ];
        if ends[0].body == ends[1].body {
            return Err(element.error("the loop connects a link with itself"));
        }
        let name = self.model.loop_name(element.attribute("name"));
        let joint = Joint::new(name, element.place(), kind, ends);
        self.name_loop(&joint, element.tag());
        self.model.joints.push(joint);
        Ok(())
    }

    /// The YAML file of an extended URDF: `closed_loop`, `type`, `name_mot`.
    fn extended(&mut self, text: &str) -> Result<()> {
        let list = |key: &str| {
            let value = |line: &str| {
                let (name, value) = line.split_once(':')?;
                (name.trim() == key).then(|| value.to_owned())
            };
            let line = text.lines().find_map(value).unwrap_or_default();
            let words = line.split(['[', ']', ',']);
            let words = words.map(|word| word.trim().trim_matches(['\'', '"']).to_owned());
            words.filter(|word| !word.is_empty()).collect::<Vec<_>>()
        };
        let kinds = [list("type"), list("joint_type")].concat();
        let names = list("joint_name");
        for (k, pair) in list("closed_loop").chunks_exact(2).enumerate() {
            let ends = [frame(&self.model, &pair[0])?, frame(&self.model, &pair[1])?];
            let kind = kinds.get(k).map(|kind| kind.to_ascii_lowercase());
            let kind = match kind.as_deref() {
                Some("6d" | "fixed") => Kind::Fixed,
                _ => Kind::Ball,
            };
            let place = self.model.bodies[ends[1].body].place.clone();
            let name = self.model.loop_name(names.get(k).map(String::as_str));
            let joint = Joint::new(name, place, kind, ends);
            self.name_loop(&joint, &format!("{} = {} (YAML)", pair[0], pair[1]));
            self.model.joints.push(joint);
        }
        for motor in list("name_mot") {
            let joint = driveable(&self.model, &motor)?;
            self.model.drive(joint);
        }
        Ok(())
    }
}
