//! Loads, couplings, drives of free motions, and stops.

use super::Writer;
use super::text::{number, quoted};
use crate::finding::Effect;
use crate::model::{Coupling, Joint, Kind, Load};
use crate::names::{allowed, free_name};
use crate::pose::{Vector, dot, length, scaled, sub};
use crate::xml::{AT_LIMITS, LOST};
use std::collections::HashSet;

impl Writer<'_> {
    /// Points of a body at which loads act.
    pub(super) fn load_points(&self, number: usize) -> Vec<(String, Vector)> {
        let pose = self.model.bodies[number].pose;
        let points = self.model.loads.iter().flat_map(|load| match load {
            Load::Spring { name, ends, .. } => {
                vec![
                    (format!("{name}_1"), ends[0]),
                    (format!("{name}_2"), ends[1]),
                ]
            }
            Load::Force { name, at, .. } => vec![(name.clone(), *at)],
        });
        let here = points.filter(|(_, (body, _))| *body == number);
        here.map(|(name, (_, point))| (format!("at_{}", allowed(&name)), pose.point(point)))
            .collect()
    }

    /// Whether a load or a coupling depends on the coordinate of a joint.
    pub(super) fn needs_coordinate(&self, joint: usize) -> bool {
        let Joint { along, .. } = &self.model.joints[joint];
        let slides = !self.model.joints[joint].is_angle();
        let flat = self.plane.is_some();
        let coupled = |one: &Coupling| flat && [one.dependent, one.independent].contains(&joint);
        let forced = along.friction != 0.0
            || slides && (along.stiffness != 0.0 || flat && along.damping != 0.0);
        self.model.joints[joint].is_driveable() && forced
            || self.model.couplings.iter().any(coupled)
    }

    /// A coupling of joint coordinates, which scenes in the plane have.
    pub(super) fn coupling(&mut self, coupling: &Coupling) {
        let degree = coupling
            .polynomial
            .iter()
            .rposition(|c| *c != 0.0)
            .unwrap_or(0);
        let numbers = [coupling.dependent, coupling.independent];
        let joints = numbers.map(|k| &self.model.joints[k]);
        let what = format!("equality {}, polynomial of degree {degree}", coupling.name);
        let simple = joints
            .iter()
            .all(|joint| matches!(joint.kind, Kind::Hinge | Kind::Slide));
        if self.plane.is_none() || !simple {
            let text = format!("{what}: coupling in space: {LOST}");
            return self.model.note(&coupling.place, Effect::Changes, text);
        }
        self.model.note(
            &coupling.place,
            Effect::Kept,
            format!("{what}: coupling in the plane"),
        );
        let [dependent, independent] = joints.map(|joint| joint.drawn);
        let x = match independent - coupling.references[1] {
            0.0 => "x".to_owned(),
            shift => format!("(x + ({shift}))"),
        };
        let terms = coupling
            .polynomial
            .iter()
            .zip(0..)
            .filter(|(c, _)| **c != 0.0);
        let mut terms: Vec<String> = terms
            .map(|(c, power)| match power {
                0 => format!("({c})"),
                1 => format!("({c})*{x}"),
                _ => format!("({c})*{x}^{power}"),
            })
            .collect();
        let offset = coupling.references[0] - dependent;
        if offset != 0.0 || terms.is_empty() {
            terms.push(format!("({offset})"));
        }
        let names = numbers
            .map(|k| quoted(&self.names.coordinates[k]))
            .join(", ");
        let mut taken: HashSet<String> = self.names.joints.iter().cloned().collect();
        let name = free_name(&allowed(&coupling.name), &mut taken);
        let law = quoted(&terms.join(" + "));
        self.text
            .entry(&name, &format!("coupling = [{names}], expression = {law}"));
    }

    pub(super) fn loads(&mut self) {
        self.text.table(&["loads"]);
        let gravity = self.in_plane(self.model.gravity);
        // What is left of gravity along the normal is rounding.
        if length(gravity) > 1e-14 * length(self.model.gravity) {
            self.load("weight", &format!("gravity = {}", self.vector(gravity)));
        }
        for joint in 0..self.model.joints.len() {
            self.along(joint);
        }
        for load in &self.model.loads {
            match load {
                Load::Spring { name, ends, .. } => {
                    self.spring(load, &allowed(name), ends.map(|(body, _)| body));
                }
                Load::Force {
                    name,
                    at,
                    force,
                    turns,
                } => {
                    self.force(&allowed(name), at.0, *force, *turns);
                }
            }
        }
        self.servos();
        self.stops();
    }

    /// The part of a vector in the plane of a planar scene.
    fn in_plane(&self, vector: Vector) -> Vector {
        let normal = self.plane.map_or([0.0; 3], |plane| plane.normal);
        sub(vector, scaled(normal, dot(vector, normal)))
    }

    /// A load with a name that no other has.
    fn load(&mut self, name: &str, keys: &str) {
        let name = free_name(name, &mut self.load_names);
        self.text.entry(&name, keys);
    }

    /// Damping, friction and stiffness along the coordinate of a joint.
    fn along(&mut self, joint: usize) {
        let of = &self.model.joints[joint];
        let along = of.along;
        if [along.damping, along.friction, along.stiffness] == [0.0; 3] {
            return;
        }
        if !matches!(of.kind, Kind::Hinge | Kind::Slide) {
            let text = format!("damping, friction or stiffness: {LOST}");
            return self.note(joint, Effect::Changes, &text);
        }
        let name = self.names.joints[joint].clone();
        let q = self.names.coordinates[joint].clone();
        // Of pairs of bodies in the plane, of joints in space.
        let (force, on) = match (&self.plane, of.is_angle()) {
            (Some(plane), true) => ("torque", self.turning_pair(joint, plane)),
            (None, true) => ("joint-torque", quoted(&name)),
            (_, false) => ("slide-force", quoted(&name)),
        };
        let law = |law: String| format!("{force} = {on}, magnitude = {}", quoted(&law));
        let [damping, friction, stiffness] =
            [along.damping, along.friction, along.stiffness].map(number);
        let free = number(along.spring_reference - of.drawn);
        if along.damping != 0.0 {
            let keys = match (of.is_angle(), self.plane.is_some()) {
                (true, _) => format!("rotational-damper = {on}, damping = {damping}"),
                (false, false) => format!("slide-damper = {on}, damping = {damping}"),
                (false, true) => law(format!("-({damping})*{q}.velocity")),
            };
            self.load(&format!("damping_{name}"), &keys);
        }
        if along.friction != 0.0 {
            let word = self.model.terms[0];
            let text = format!("{word} {friction}: kept as a load -{friction}*sign(rate)");
            self.note(joint, Effect::Kept, &text);
            let keys = law(format!("-({friction})*sign({q}.velocity)"));
            self.load(&format!("friction_{name}"), &keys);
        }
        if along.stiffness != 0.0 {
            let keys = match of.is_angle() {
                true => {
                    format!("torsion-spring = {on}, stiffness = {stiffness}, free-angle = {free}")
                }
                false => law(format!("-({stiffness})*({q} - ({free}))")),
            };
            self.load(&format!("spring_{name}"), &keys);
        }
    }

    fn spring(&mut self, load: &Load, name: &str, bodies: [usize; 2]) {
        let Load::Spring {
            stiffness,
            damping,
            free_length,
            ..
        } = load
        else {
            return;
        };
        let bodies = bodies.map(|body| &self.names.bodies[body]);
        let ends = [1, 2]
            .map(|k| quoted(&format!("{}.at_{name}_{k}", bodies[k - 1])))
            .join(", ");
        let [k, c, free] = [*stiffness, *damping, *free_length].map(number);
        if *stiffness != 0.0 {
            let keys = format!("spring = [{ends}], stiffness = {k}, free-length = {free}");
            self.load(name, &keys);
        }
        if *damping != 0.0 {
            self.load(
                &format!("{name}_damper"),
                &format!("damper = [{ends}], damping = {c}"),
            );
        }
    }

    fn force(&mut self, name: &str, body: usize, force: Vector, turns: bool) {
        let turned = self.model.bodies[body].pose.turn.apply(force);
        let force = if turns { turned } else { force };
        let size = length(self.in_plane(force));
        let point = quoted(&format!("{}.at_{name}", self.names.bodies[body]));
        let frame = if turns { ", frame = \"body\"" } else { "" };
        let (direction, size_text) = (self.vector(force), number(size));
        if size > 0.0 {
            let keys =
                format!("force = {point}, direction = {direction}, magnitude = {size_text}{frame}");
            self.load(name, &keys);
        }
    }

    /// Servos act in free motions.
    fn servos(&mut self) {
        let drives = &self.model.drives;
        let servos = drives
            .iter()
            .filter_map(|drive| Some((drive.joint, drive.servo?)));
        let servos: Vec<_> = servos.collect();
        if !servos.is_empty() {
            self.text.table(&["drives"]);
        }
        for (joint, [proportional, derivative]) in servos {
            let (q, drawn) = (
                &self.names.coordinates[joint],
                self.model.joints[joint].drawn,
            );
            let law = format!("-({proportional})*({q} + ({drawn})) - ({derivative})*{q}.velocity");
            let name = free_name(&format!("servo_{q}"), &mut self.load_names);
            let keys = format!(
                "applied-force = {}, magnitude = {}",
                quoted(q),
                quoted(&law)
            );
            self.text.entry(&name, &keys);
        }
    }

    /// Limits of drives are end stops.
    fn stops(&mut self) {
        let word = self.model.terms[1];
        let mut stops = Vec::new();
        for (k, joint) in self.model.joints.iter().enumerate() {
            let Some(limits) = joint.along.limits else {
                continue;
            };
            let [low, high] = limits.map(|limit| limit - joint.drawn);
            let driven = self.model.drives.iter().any(|drive| drive.joint == k);
            if driven && low <= 0.0 && high >= 0.0 && low < high {
                self.note(
                    k,
                    Effect::Kept,
                    &format!("{word}: kept as a stop where free"),
                );
                stops.push((k, [low, high].map(number)));
            } else {
                self.note(k, Effect::AtLimits, &format!("{word}: {AT_LIMITS}"));
            }
        }
        if !stops.is_empty() {
            self.text.table(&["stops"]);
        }
        for (joint, [low, high]) in stops {
            let q = &self.names.coordinates[joint];
            let keys = format!("coordinate = {}, min = {low}, max = {high}", quoted(q));
            self.text.entry(&format!("limits_{q}"), &keys);
        }
    }
}
