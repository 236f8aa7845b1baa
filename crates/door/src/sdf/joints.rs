//! Joints of SDF.

use super::Reader;
use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Along, Coupling, Joint, Kind};
use crate::pose::{Matrix, Pose, Vector, unit};
use crate::xml::Element;
use std::f64::consts::TAU;

impl<'d> Reader<'d> {
    pub(super) fn joint(
        &mut self,
        name: &str,
        element: Element<'d>,
        world: Pose,
    ) -> Result<(), DoorError> {
        let side = |tag| {
            let of = element.child_text(tag).unwrap_or_default();
            self.body_of(of, &element)
        };
        let [parent, child] = [side("parent")?, side("child")?];
        if parent == child {
            return Err(element.error("the joint connects a link with itself", ""));
        }
        let [first_axis, second_axis] = [
            self.axis(&element, "axis", &world)?,
            self.axis(&element, "axis2", &world)?,
        ];
        let kind = match element.attribute("type").unwrap_or_default() {
            "revolute" | "continuous" => Kind::Hinge,
            "prismatic" => Kind::Slide,
            "fixed" => Kind::Fixed,
            "ball" => Kind::Ball,
            "universal" => Kind::Universal,
            "screw" => Kind::Screw(pitch(element)?),
            other => {
                return Err(element.error(format!("a joint of type `{other}` is not read"), ""));
            }
        };
        let along_axis = |axis: Option<Vector>| Pose {
            origin: world.origin,
            turn: axis.map_or(world.turn, Matrix::z_along),
        };
        let first = along_axis(first_axis);
        let second = if kind == Kind::Universal {
            along_axis(second_axis)
        } else {
            first
        };
        self.model.joints.push(Joint {
            name: name.to_owned(),
            place: element.place(),
            kind,
            first: self.end(parent, first),
            second: self.end(child, second),
            in_tree: false,
            drawn: 0.0,
            along: element
                .child("axis")
                .map(along)
                .transpose()?
                .unwrap_or_default(),
        });
        Ok(())
    }

    /// An axis in the world; by default z of the joint.
    fn axis(
        &self,
        element: &Element<'d>,
        tag: &str,
        joint: &Pose,
    ) -> Result<Option<Vector>, DoorError> {
        let Some(axis) = element.child(tag) else {
            return Ok(None);
        };
        let mut turn = joint.turn;
        let mut vector = [0.0, 0.0, 1.0];
        if axis
            .child_text("use_parent_model_frame")
            .is_some_and(|word| word == "1" || word == "true")
        {
            turn = self.model_pose.turn;
        }
        if let Some(xyz) = axis.child("xyz") {
            vector = xyz.exactly("xyz", xyz.text())?;
            if let Some(frame) = xyz
                .attribute("expressed_in")
                .filter(|frame| !frame.is_empty())
            {
                turn = self
                    .model_pose
                    .turn
                    .times(self.in_model(frame, &xyz, 0)?.turn);
            }
        }
        let vector = unit(vector).ok_or_else(|| axis.error("the axis is zero", ""))?;
        Ok(Some(turn.apply(vector)))
    }

    /// Couplings, once all joints are known.
    pub(super) fn mimics(&mut self) -> Result<(), DoorError> {
        for name in self.names.clone() {
            let element = self.frames[name].element;
            let axis = if element.tag() == "joint" {
                element.child("axis")
            } else {
                None
            };
            let Some(mimic) = axis.and_then(|axis| axis.child("mimic")) else {
                continue;
            };
            let other = mimic.attribute("joint").unwrap_or_default();
            let independent = self.model.joint_named(other);
            let independent = independent
                .ok_or_else(|| mimic.error(format!("there is no joint `{other}`"), ""))?;
            let dependent = self.model.joint_named(name).unwrap_or_default();
            if mimic.attribute("axis").is_some_and(|axis| axis != "axis") {
                mimic.note(
                    Effect::Changes,
                    format!("mimic of {name}: taken of the first axis of {other}"),
                );
            }
            let value =
                |tag, default| Ok::<f64, DoorError>(mimic.child_number(tag)?.unwrap_or(default));
            self.model.couplings.push(Coupling {
                name: format!("{name}_mimic"),
                place: mimic.place(),
                dependent,
                independent,
                references: [0.0, value("reference", 0.0)?],
                polynomial: vec![value("offset", 0.0)?, value("multiplier", 1.0)?],
            });
        }
        Ok(())
    }
}

/// The travel for one revolution, m.
fn pitch(element: Element<'_>) -> Result<f64, DoorError> {
    if let Some(pitch) = element.child_number("screw_thread_pitch")? {
        return Ok(pitch);
    }
    // The former number is in rad/m, and positive for a left-hand thread.
    let former = element
        .child_number("thread_pitch")?
        .filter(|pitch| *pitch != 0.0);
    let former =
        former.ok_or_else(|| element.error("a screw needs its `screw_thread_pitch`", ""))?;
    Ok(-TAU / former)
}

fn along(axis: Element<'_>) -> Result<Along, DoorError> {
    let mut along = Along::default();
    if let Some(dynamics) = axis.child("dynamics") {
        let value = |tag| Ok::<f64, DoorError>(dynamics.child_number(tag)?.unwrap_or_default());
        along.damping = value("damping")?;
        along.friction = value("friction")?;
        along.spring_reference = value("spring_reference")?;
        along.stiffness = value("spring_stiffness")?;
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
