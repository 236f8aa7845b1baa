//! Joints of URDF and SDF.

use super::Reader;
use crate::error::{DoorError, Result};
use crate::model::{Along, Coupling, End, Joint, Kind};
use crate::pose::{Pose, Vector};
use crate::xml::{Element, TRUE};
use std::f64::consts::TAU;

/// The link that a joint names on one side: in the text of a child, or in an attribute of it.
pub(super) fn side<'d>(joint: Element<'d>, tags: &[&str]) -> &'d str {
    let side = tags.iter().find_map(|tag| joint.child(tag));
    let named = |side: Element<'d>| side.attribute("link").or(side.attribute("name"));
    side.map_or("", |side| named(side).unwrap_or(side.text()))
}

impl<'d> Reader<'d> {
    /// A joint at a frame of the world.
    pub(super) fn joint(&mut self, name: &str, element: Element<'d>, world: Pose) -> Result<()> {
        let body = |tag| self.body_of(side(element, &[tag]), &element);
        let bodies = [body("parent")?, body("child")?];
        if bodies[0] == bodies[1] {
            return Err(element.error("the joint connects a link with itself"));
        }
        let kind = kind(element)?;
        let first = self.axis(element, "axis", kind, &world)?;
        let second = match kind {
            Kind::Universal => self.axis(element, "axis2", kind, &world)?,
            _ => first,
        };
        let end = |body, axis| End::new(body, Pose::along(world.origin, axis));
        let ends = [end(bodies[0], first), end(bodies[1], second)];
        let mut joint = Joint::new(name, element.place(), kind, ends);
        joint.along = match element.child("axis") {
            Some(axis) if axis.attribute("xyz").is_none() => along(axis)?,
            _ => along(element)?,
        };
        self.model.joints.push(joint);
        let frame = (name.to_owned(), End::new(bodies[1], world));
        self.model.frames.push(frame);
        Ok(())
    }

    /// An axis in the world.
    pub(super) fn axis(
        &self,
        element: Element<'d>,
        tag: &str,
        kind: Kind,
        joint: &Pose,
    ) -> Result<Vector> {
        let default = match self.is_sdf {
            true => [0.0, 0.0, 1.0],
            false => [1.0, 0.0, 0.0],
        };
        let Some(axis) = element.child(tag) else {
            return Ok(joint.turn.apply(default));
        };
        let vector = axis.vector("xyz")?.unwrap_or(default);
        // Fixed joints and balls often have an axis of zeros.
        let vector = match kind {
            Kind::Fixed | Kind::Ball if vector == [0.0; 3] => default,
            _ => axis.unit(vector)?,
        };
        let xyz = axis.child("xyz");
        let expressed_in = xyz.and_then(|xyz| xyz.attribute("expressed_in"));
        let turn = match expressed_in.filter(|frame| !frame.is_empty()) {
            Some(frame) => self.in_world(frame, &axis)?.turn,
            None if axis.says("use_parent_model_frame", TRUE) => self.model_pose.turn,
            None => joint.turn,
        };
        Ok(turn.apply(vector))
    }

    /// The coupling of a joint, once all joints are known.
    pub(super) fn mimic(&mut self, element: Element<'d>) -> Result<()> {
        let in_axis = || element.child("axis")?.child("mimic");
        let Some(mimic) = element.child("mimic").or_else(in_axis) else {
            return Ok(());
        };
        let name = element.attribute("name").unwrap_or_default();
        let other = mimic.attribute("joint").unwrap_or_default();
        let joint = |name| mimic.known(self.model.joint_named(name), "joint", name);
        let (dependent, independent) = (joint(name)?, joint(other)?);
        if mimic.attribute("axis").is_some_and(|axis| axis != "axis") {
            mimic.lost(format!("mimic of {name}, of the second axis of {other}"));
        }
        self.model.couplings.push(Coupling {
            name: format!("{name}_mimic"),
            place: mimic.place(),
            dependent,
            independent,
            references: [0.0, mimic.value("reference", 0.0)?],
            polynomial: vec![mimic.value("offset", 0.0)?, mimic.value("multiplier", 1.0)?],
        });
        Ok(())
    }

    pub(super) fn transmission(&mut self, element: Element<'d>) {
        let _ = element.attribute("type");
        for part in element.children() {
            let name = part.attribute("name").filter(|_| part.tag() == "joint");
            let joint = name.and_then(|name| self.model.joint_named(name));
            if let Some((name, joint)) = name.zip(joint) {
                part.kept(format!("transmission: drives {name}"));
                self.model.drive(joint);
            }
        }
    }
}

/// The kind of a joint, by the names of all dialects.
pub(super) fn kind(element: Element<'_>) -> Result<Kind> {
    let name = element.attribute("type").unwrap_or("revolute");
    match name.to_ascii_lowercase().as_str() {
        "revolute" | "continuous" => Ok(Kind::Hinge),
        "prismatic" => Ok(Kind::Slide),
        "fixed" | "6d" | "weld" => Ok(Kind::Fixed),
        "spherical" | "ball" | "3d" | "position" => Ok(Kind::Ball),
        "universal" => Ok(Kind::Universal),
        "screw" => Ok(Kind::Screw(pitch(element)?)),
        _ => {
            let help = "known are revolute, continuous, prismatic, fixed, spherical, ball, universal and screw";
            Err(element.error_with(format!("a joint of type `{name}` is not read"), help))
        }
    }
}

/// The travel for one revolution, m.
fn pitch(element: Element<'_>) -> Result<f64> {
    let pitch = element.value("screw_thread_pitch", 0.0)?;
    // The former number is in rad/m, and positive for a left-hand thread.
    let former = element.value("thread_pitch", 0.0)?;
    match (pitch, former) {
        (0.0, 0.0) => Err(element.error("a screw needs its `screw_thread_pitch`")),
        (0.0, former) => Ok(-TAU / former),
        (pitch, _) => Ok(pitch),
    }
}

/// What acts along the coordinate, of a joint of URDF or an axis of SDF.
fn along(of: Element<'_>) -> Result<Along> {
    let mut along = Along::default();
    let dynamics = of.child("dynamics").or(of.child("joint_properties"));
    if let Some(dynamics) = dynamics {
        along.damping = dynamics.value("damping", along.damping)?;
        along.friction = dynamics.value("friction", along.friction)?;
        along.spring_reference = dynamics.value("spring_reference", 0.0)?;
        along.stiffness = dynamics.value("spring_stiffness", 0.0)?;
    }
    if let Some(limit) = of.child("limit") {
        let bound = |name, none: f64| {
            let text = limit.given(name);
            let text = text.filter(|text| !text.trim_start_matches(['-', '+']).starts_with("inf"));
            let value = text.map_or(Ok(none), |text| limit.exactly(name, text).map(|[x]| x))?;
            // From 1e16 on SDF means no limit.
            Ok::<_, DoorError>(if value.abs() < 1e15 { value } else { none })
        };
        let limits = [
            bound("lower", f64::NEG_INFINITY)?,
            bound("upper", f64::INFINITY)?,
        ];
        let limited = limits.iter().any(|limit| limit.is_finite());
        along.limits = (limited && !of.is("type", "continuous")).then_some(limits);
    }
    Ok(along)
}
