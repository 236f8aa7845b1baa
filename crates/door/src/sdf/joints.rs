//! Joints of SDF.

use super::Reader;
use crate::error::DoorError;
use crate::model::{Along, Coupling, Joint, Kind};
use crate::pose::{Pose, Vector};
use crate::xml::Element;
use std::f64::consts::TAU;

impl<'d> Reader<'d> {
    pub(super) fn joint(
        &mut self,
        name: &str,
        element: Element<'d>,
        world: Pose,
    ) -> Result<(), DoorError> {
        let side = |tag| self.body_of(element.child_text(tag).unwrap_or_default(), &element);
        let [parent, child] = [side("parent")?, side("child")?];
        if parent == child {
            return Err(element.error("the joint connects a link with itself"));
        }
        let kind = match element.attribute("type").unwrap_or_default() {
            "revolute" | "continuous" => Kind::Hinge,
            "prismatic" => Kind::Slide,
            "fixed" => Kind::Fixed,
            "ball" => Kind::Ball,
            "universal" => Kind::Universal,
            "screw" => Kind::Screw(pitch(element)?),
            other => return Err(element.error(format!("a joint of type `{other}` is not read"))),
        };
        let first = self.axis(&element, "axis", &world)?;
        let second = self
            .axis(&element, "axis2", &world)?
            .filter(|_| kind == Kind::Universal);
        let place =
            |axis: Option<Vector>| axis.map_or(world, |axis| Pose::along(world.origin, axis));
        let ends = [
            self.model.end_at(parent, place(first)),
            self.model.end_at(child, place(second.or(first))),
        ];
        let mut joint = Joint::new(name, element.place(), kind, ends);
        joint.along = element
            .child("axis")
            .map(along)
            .transpose()?
            .unwrap_or_default();
        self.model.joints.push(joint);
        Ok(())
    }

    /// An axis in the world, if the joint has it.
    fn axis(
        &self,
        element: &Element<'d>,
        tag: &str,
        joint: &Pose,
    ) -> Result<Option<Vector>, DoorError> {
        let Some(axis) = element.child(tag) else {
            return Ok(None);
        };
        let vector = axis.unit(axis.child_vector("xyz")?.unwrap_or([0.0, 0.0, 1.0]))?;
        let expressed_in = axis
            .child("xyz")
            .and_then(|xyz| xyz.attribute("expressed_in"));
        let turn = match expressed_in.filter(|frame| !frame.is_empty()) {
            Some(frame) => self.in_world(frame, &axis)?.turn,
            None if axis.says("use_parent_model_frame") => self.model_pose.turn,
            None => joint.turn,
        };
        Ok(Some(turn.apply(vector)))
    }

    /// Couplings, once all joints are known.
    pub(super) fn mimics(&mut self) -> Result<(), DoorError> {
        for name in self.names.clone() {
            let axis = self.frames[name].element.child("axis");
            let Some(mimic) = axis.and_then(|axis| axis.child("mimic")) else {
                continue;
            };
            let other = mimic.attribute("joint").unwrap_or_default();
            let independent = mimic.known(self.model.joint_named(other), "joint", other)?;
            let dependent = mimic.known(self.model.joint_named(name), "joint", name)?;
            if mimic.attribute("axis").is_some_and(|axis| axis != "axis") {
                mimic.lost(format!("mimic of {name}, of the second axis of {other}"));
            }
            self.model.couplings.push(Coupling {
                name: format!("{name}_mimic"),
                place: mimic.place(),
                dependent,
                independent,
                references: [0.0, mimic.child_value("reference", 0.0)?],
                polynomial: vec![
                    mimic.child_value("offset", 0.0)?,
                    mimic.child_value("multiplier", 1.0)?,
                ],
            });
        }
        Ok(())
    }
}

/// The travel for one revolution, m.
fn pitch(element: Element<'_>) -> Result<f64, DoorError> {
    let pitch = element.child_value("screw_thread_pitch", 0.0)?;
    // The former number is in rad/m, and positive for a left-hand thread.
    let former = element.child_value("thread_pitch", 0.0)?;
    match (pitch, former) {
        (0.0, 0.0) => Err(element.error("a screw needs its `screw_thread_pitch`")),
        (0.0, former) => Ok(-TAU / former),
        (pitch, _) => Ok(pitch),
    }
}

fn along(axis: Element<'_>) -> Result<Along, DoorError> {
    let mut along = Along::default();
    if let Some(dynamics) = axis.child("dynamics") {
        along.damping = dynamics.child_value("damping", 0.0)?;
        along.friction = dynamics.child_value("friction", 0.0)?;
        along.spring_reference = dynamics.child_value("spring_reference", 0.0)?;
        along.stiffness = dynamics.child_value("spring_stiffness", 0.0)?;
    }
    if let Some(limit) = axis.child("limit") {
        let bound = |tag| {
            let text = limit
                .child_text(tag)
                .filter(|text| !text.trim_start_matches(['-', '+']).starts_with("inf"));
            let value = text.map(|text| limit.exactly::<1>(tag, text)).transpose()?;
            Ok::<_, DoorError>(value.map(|[x]| x).filter(|x| x.abs() < 1e15))
        };
        along.limits = bound("lower")?
            .zip(bound("upper")?)
            .map(|(low, high)| [low, high]);
    }
    Ok(along)
}
