//! Loads, couplings, drives of free motions, and stops.

use super::Writer;
use super::text::{key, quoted};
use crate::finding::Effect;
use crate::model::{Coupling, Drive, Kind, Load};
use crate::names::{allowed, free_name};
use crate::pose::{Vector, length};
use std::collections::HashSet;

impl Writer<'_> {
    /// Points of a body at which loads act.
    pub(super) fn load_points(&self, number: usize) -> Vec<(String, Vector)> {
        let pose = self.model.bodies[number].pose;
        let mut points = Vec::new();
        for load in &self.model.loads {
            let of = match load {
                Load::Spring { name, ends, .. } => vec![
                    (format!("{name}_1"), ends[0]),
                    (format!("{name}_2"), ends[1]),
                ],
                Load::Force { name, at, .. } => vec![(name.clone(), *at)],
            };
            let here = of.into_iter().filter(|(_, (body, _))| *body == number);
            points.extend(
                here.map(|(name, (_, point))| {
                    (format!("at_{}", allowed(&name)), pose.point(point))
                }),
            );
        }
        points
    }

    /// Whether a load or a coupling depends on the coordinate of a joint.
    pub(super) fn needs_coordinate(&self, joint: usize) -> bool {
        let of = &self.model.joints[joint];
        let along = &of.along;
        let slides = !of.is_angle();
        let damped_in_plane = slides && self.plane.is_some() && along.damping != 0.0;
        let coupled = |one: &Coupling| {
            self.plane.is_some() && [one.dependent, one.independent].contains(&joint)
        };
        let forced = along.friction != 0.0 || damped_in_plane || slides && along.stiffness != 0.0;
        of.is_driveable() && forced || self.model.couplings.iter().any(coupled)
    }

    /// A coupling of joint coordinates, which scenes in the plane have.
    pub(super) fn coupling(&mut self, coupling: &Coupling) {
        let degree = coupling
            .polynomial
            .iter()
            .rposition(|c| *c != 0.0)
            .unwrap_or(0);
        let joints = [coupling.dependent, coupling.independent].map(|k| &self.model.joints[k]);
        let what = format!("equality {}, polynomial of degree {degree}", coupling.name);
        let findings = &self.model.findings;
        if self.plane.is_none()
            || joints
                .iter()
                .any(|joint| !matches!(joint.kind, Kind::Hinge | Kind::Slide))
        {
            findings.add(
                &coupling.place,
                Effect::Changes,
                format!("{what}: coupling in space: left out (changes the motion)"),
            );
            return;
        }
        findings.add(
            &coupling.place,
            Effect::Kept,
            format!("{what}: coupling in the plane"),
        );
        let [dependent, independent] = joints.map(|joint| joint.drawn);
        let shift = independent - coupling.references[1];
        let x = if shift == 0.0 {
            "x".to_owned()
        } else {
            format!("(x + ({shift}))")
        };
        let terms = coupling
            .polynomial
            .iter()
            .enumerate()
            .filter(|(_, c)| **c != 0.0);
        let mut terms: Vec<String> = terms
            .map(|(power, c)| match power {
                0 => format!("({c})"),
                1 => format!("({c})*{x}"),
                _ => format!("({c})*{x}^{power}"),
            })
            .collect();
        let offset = coupling.references[0] - dependent;
        if offset != 0.0 || terms.is_empty() {
            terms.push(format!("({offset})"));
        }
        let names =
            [coupling.dependent, coupling.independent].map(|k| quoted(&self.names.coordinates[k]));
        let mut taken: HashSet<String> = self.names.joints.iter().cloned().collect();
        let name = key(&free_name(&allowed(&coupling.name), &mut taken));
        let law = quoted(&terms.join(" + "));
        self.text.line(&format!(
            "{name} = {{ coupling = [{}], expression = {law} }}",
            names.join(", ")
        ));
    }

    pub(super) fn loads(&mut self) {
        self.text.table(&["loads"]);
        let gravity = self.model.gravity;
        let weight = self.vector(gravity);
        if length(gravity) > 0.0 {
            self.text
                .line(&format!("weight = {{ gravity = {weight} }}"));
        }
        for joint in 0..self.model.joints.len() {
            self.along(joint);
        }
        for load in &self.model.loads {
            self.load(load);
        }
        self.servos();
        self.stops();
    }

    /// Damping, friction and stiffness along the coordinate of a joint.
    fn along(&mut self, joint: usize) {
        let of = &self.model.joints[joint];
        let along = of.along;
        if ![along.damping, along.friction, along.stiffness]
            .iter()
            .any(|x| *x != 0.0)
        {
            return;
        }
        if !matches!(of.kind, Kind::Hinge | Kind::Slide) {
            self.note(
                joint,
                Effect::Changes,
                "damping, friction or stiffness: left out (changes the motion)",
            );
            return;
        }
        let name = quoted(&self.names.joints[joint]);
        let (plane, q) = (self.plane, self.names.coordinates[joint].clone());
        // Of pairs of bodies in the plane, of joints in space.
        let acts_on = match (&plane, of.is_angle()) {
            (Some(plane), true) => self.turning_pair(joint, plane),
            _ => name.clone(),
        };
        let force = match (&plane, of.is_angle()) {
            (Some(_), true) => "torque",
            (None, true) => "joint-torque",
            (_, false) => "slide-force",
        };
        let mut lines = Vec::new();
        if along.damping != 0.0 {
            let damping = self.text.number(along.damping);
            lines.push((
                "damping",
                match (of.is_angle(), plane.is_some()) {
                    (true, _) => format!("rotational-damper = {acts_on}, damping = {damping}"),
                    (false, false) => format!("slide-damper = {acts_on}, damping = {damping}"),
                    (false, true) => {
                        format!("{force} = {acts_on}, magnitude = \"-({damping})*{q}.velocity\"")
                    }
                },
            ));
        }
        if along.friction != 0.0 {
            let friction = self.text.number(along.friction);
            let text = format!(
                "{} {friction}: kept as a load -{friction}*sign(rate)",
                self.model.terms[0]
            );
            self.note(joint, Effect::Kept, &text);
            lines.push((
                "friction",
                format!("{force} = {acts_on}, magnitude = \"-({friction})*sign({q}.velocity)\""),
            ));
        }
        if along.stiffness != 0.0 {
            let stiffness = self.text.number(along.stiffness);
            let free = self.text.number(along.spring_reference - of.drawn);
            lines.push((
                "spring",
                match of.is_angle() {
                    true => format!(
                        "torsion-spring = {acts_on}, stiffness = {stiffness}, free-angle = {free}"
                    ),
                    false => format!(
                        "{force} = {acts_on}, magnitude = \"-({stiffness})*({q} - ({free}))\""
                    ),
                },
            ));
        }
        for (what, keys) in lines {
            let name = key(&format!("{what}_{}", self.names.joints[joint]));
            self.text.line(&format!("{name} = {{ {keys} }}"));
        }
    }

    fn load(&mut self, load: &Load) {
        let body = |body: usize| self.names.bodies[body].clone();
        match load {
            Load::Spring {
                name,
                ends,
                stiffness,
                damping,
                free_length,
                ..
            } => {
                let name = allowed(name);
                let ends: Vec<String> = [1, 2]
                    .iter()
                    .zip(ends)
                    .map(|(k, (at, _))| quoted(&format!("{}.at_{name}_{k}", body(*at))))
                    .collect();
                let ends = ends.join(", ");
                if *stiffness != 0.0 {
                    let (stiffness, free) =
                        (self.text.number(*stiffness), self.text.number(*free_length));
                    self.text.line(&format!("{} = {{ spring = [{ends}], stiffness = {stiffness}, free-length = {free} }}", key(&name)));
                }
                if *damping != 0.0 {
                    let damping = self.text.number(*damping);
                    self.text.line(&format!(
                        "{} = {{ damper = [{ends}], damping = {damping} }}",
                        key(&format!("{name}_damper"))
                    ));
                }
            }
            Load::Force {
                name,
                at,
                force,
                turns,
                ..
            } => {
                let name = allowed(name);
                let pose = self.model.bodies[at.0].pose;
                let point = quoted(&format!("{}.at_{name}", body(at.0)));
                let direction = if *turns {
                    pose.turn.apply(*force)
                } else {
                    *force
                };
                let size = length(match &self.plane {
                    Some(plane) => {
                        let [x, y] = plane.point(direction);
                        [x, y, 0.0]
                    }
                    None => direction,
                });
                if size == 0.0 {
                    return;
                }
                let (direction, size) = (self.vector(direction), self.text.number(size));
                let frame = if *turns { ", frame = \"body\"" } else { "" };
                let name = key(&name);
                self.text.line(&format!("{name} = {{ force = {point}, direction = {direction}, magnitude = {size}{frame} }}"));
            }
        }
    }

    /// Servos act in free motions.
    fn servos(&mut self) {
        let servos: Vec<&Drive> = self
            .model
            .drives
            .iter()
            .filter(|drive| drive.servo.is_some())
            .collect();
        if !servos.is_empty() {
            self.text.table(&["drives"]);
        }
        for drive in servos {
            let Some([proportional, derivative]) = drive.servo else {
                continue;
            };
            let (q, drawn) = (
                &self.names.coordinates[drive.joint],
                self.model.joints[drive.joint].drawn,
            );
            let law = format!("-({proportional})*({q} + ({drawn})) - ({derivative})*{q}.velocity");
            self.text.line(&format!(
                "\"servo_{q}\" = {{ applied-force = \"{q}\", magnitude = \"{law}\" }}"
            ));
        }
    }

    /// Limits of drives are end stops.
    fn stops(&mut self) {
        let term = self.model.terms[1];
        let mut stops = Vec::new();
        for (number, joint) in self.model.joints.iter().enumerate() {
            let Some(limits) = joint.along.limits else {
                continue;
            };
            let [low, high] = limits.map(|limit| limit - joint.drawn);
            let driven = self.model.drives.iter().any(|drive| drive.joint == number);
            if driven && low <= 0.0 && high >= 0.0 && low < high {
                self.note(
                    number,
                    Effect::Kept,
                    &format!("{term}: kept as a stop where free"),
                );
                stops.push((number, [low, high]));
            } else {
                self.note(
                    number,
                    Effect::AtLimits,
                    &format!("{term}: left out (acts only at a limit)"),
                );
            }
        }
        if !stops.is_empty() {
            self.text.table(&["stops"]);
        }
        for (joint, limits) in stops {
            let q = self.names.coordinates[joint].clone();
            let [low, high] = limits.map(|limit| self.text.number(limit));
            self.text.line(&format!(
                "\"limits_{q}\" = {{ coordinate = \"{q}\", min = {low}, max = {high} }}"
            ));
        }
    }
}
