//! Loads, couplings, drives of free motions, and stops.

use super::Writer;
use super::text::{number, quoted};
use crate::finding::{AT_LIMITS, Effect, LOST};
use crate::model::{Action, Coupling, Joint, Kind, Load};
use crate::names::free_name;
use crate::pose::{Vector, dot, length, scaled, sub};

/// The names of the points at which a load acts.
fn point_names(load: &Load) -> Vec<String> {
    let name = &load.name;
    match load.at.len() {
        1 => vec![format!("at_{name}")],
        count => (1..=count).map(|k| format!("at_{name}_{k}")).collect(),
    }
}

impl Writer<'_> {
    /// Points of a body at which loads act.
    pub(super) fn load_points(&self, of: usize) -> Vec<(String, Vector)> {
        let loads = self.model.loads.iter();
        let points = loads.flat_map(|load| point_names(load).into_iter().zip(&load.at));
        let here = points.filter(|(_, (body, _))| *body == of);
        here.map(|(name, (_, point))| (name, *point)).collect()
    }

    /// Whether a load or a coupling depends on the coordinate of a joint.
    pub(super) fn needs_coordinate(&self, joint: usize) -> bool {
        let (of, flat) = (&self.model.joints[joint], self.plane.is_some());
        let along = of.along;
        let slides = along.stiffness != 0.0 || flat && along.damping != 0.0;
        let forced = along.friction != 0.0 || !of.is_angle() && slides;
        let coupled = |one: &Coupling| [one.dependent, one.independent].contains(&joint);
        of.is_driveable() && forced || self.model.couplings.iter().any(coupled)
    }

    /// A coupling of the angles or travels of two joints.
    pub(super) fn coupling(&mut self, coupling: &Coupling) {
        let degree = coupling.polynomial.iter().rposition(|c| *c != 0.0);
        let degree = degree.unwrap_or(0);
        let numbers = [coupling.dependent, coupling.independent];
        let [dependent, independent] = numbers.map(|k| &self.model.joints[k]);
        let simple = |kind| matches!(kind, Kind::Hinge | Kind::Slide);
        let what = format!("equality {}, polynomial of degree {degree}", coupling.name);
        if !simple(dependent.kind) || !simple(independent.kind) {
            return coupling
                .place
                .lost(format!("{what}: of joints with several coordinates"));
        }
        let place = ["in space", "in the plane"][usize::from(self.plane.is_some())];
        coupling.place.kept(format!("{what}: coupling {place}"));
        let x = match independent.drawn - coupling.references[1] {
            0.0 => "x".to_owned(),
            shift => format!("(x + ({}))", number(shift)),
        };
        let mut polynomial = coupling.polynomial.clone();
        if let Some(constant) = polynomial.first_mut() {
            *constant += coupling.references[0] - dependent.drawn;
        }
        let terms = polynomial.iter().enumerate().filter(|(_, c)| **c != 0.0);
        let mut law: Vec<String> = terms
            .map(|(power, c)| match (power, number(*c)) {
                (0, c) => c,
                (1, c) => format!("({c})*{x}"),
                (_, c) => format!("({c})*{x}^{power}"),
            })
            .collect();
        if law.is_empty() {
            law.push("0".to_owned());
        }
        let names = [dependent, independent].map(|joint| quoted(&joint.coordinate));
        let law = quoted(&law.join(" + "));
        let keys = format!("coupling = [{}], expression = {law}", names.join(", "));
        self.text.entry(&coupling.name, &keys);
    }

    pub(super) fn loads(&mut self) {
        self.text.table("loads");
        let size = length(self.model.gravity);
        let gravity = self.in_plane(self.model.gravity);
        // What is left of gravity along the normal is rounding.
        if length(gravity) > 1e-14 * size {
            let keys = format!("gravity = {}", self.vector(gravity, 1e-15 * size));
            self.load("weight", &keys);
        }
        for joint in 0..self.model.joints.len() {
            self.along(joint);
        }
        for load in &self.model.loads {
            self.action(load);
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

    fn note(&self, joint: usize, effect: Effect, text: &str) {
        let of = &self.model.joints[joint];
        of.place.note(effect, format!("joint {} {text}", of.name));
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
        let (name, q) = (&of.name, &of.coordinate);
        // Of pairs of bodies in the plane, of joints in space.
        let (force, on) = match (&self.plane, of.is_angle()) {
            (Some(plane), true) => ("torque", self.turning_pair(of, plane)),
            (None, true) => ("joint-torque", quoted(name)),
            (_, false) => ("slide-force", quoted(name)),
        };
        let law = |law: String| format!("{force} = {on}, magnitude = {}", quoted(&law));
        let [damping, friction, stiffness] =
            [along.damping, along.friction, along.stiffness].map(number);
        let free = number(along.spring_reference - of.drawn);
        let damper = match (of.is_angle(), self.plane.is_some()) {
            (true, _) => format!("rotational-damper = {on}, damping = {damping}"),
            (false, false) => format!("slide-damper = {on}, damping = {damping}"),
            (false, true) => law(format!("-({damping})*{q}.velocity")),
        };
        let rubs = law(format!("-({friction})*sign({q}.velocity)"));
        let spring = match of.is_angle() {
            true => format!("torsion-spring = {on}, stiffness = {stiffness}, free-angle = {free}"),
            false => law(format!("-({stiffness})*({q} - ({free}))")),
        };
        if along.friction != 0.0 {
            let word = self.model.terms[0];
            let text = format!("{word} {friction}: kept as a load -{friction}*sign(rate)");
            self.note(joint, Effect::Kept, &text);
        }
        for (value, what, keys) in [
            (along.damping, "damping", damper),
            (along.friction, "friction", rubs),
            (along.stiffness, "spring", spring),
        ] {
            if value != 0.0 {
                self.load(&format!("{what}_{name}"), &keys);
            }
        }
    }

    fn action(&mut self, load: &Load) {
        let name = &load.name;
        let bodies = load.at.iter().map(|(body, _)| &self.model.bodies[*body]);
        let ends = bodies.map(|body| &body.name).zip(point_names(load));
        let ends = ends.map(|(body, point)| format!("\"{body}.{point}\""));
        let ends: Vec<String> = ends.collect();
        let ends = ends.join(", ");
        match &load.action {
            Action::Spring {
                stiffness,
                damping,
                free_length,
            } => {
                let [k, c, free] = [*stiffness, *damping, *free_length].map(number);
                if *stiffness != 0.0 {
                    let keys = format!("spring = [{ends}], stiffness = {k}, free-length = {free}");
                    self.text.entry(name, &keys);
                }
                if *damping != 0.0 {
                    let keys = format!("damper = [{ends}], damping = {c}");
                    self.load(&format!("{name}_damper"), &keys);
                }
            }
            Action::Force { force, turns } => {
                let size = length(self.in_plane(*force));
                let frame = if *turns { ", frame = \"body\"" } else { "" };
                let (direction, magnitude) = (self.vector(*force, 0.0), number(size));
                if size > 0.0 {
                    let keys = format!(
                        "force = {ends}, direction = {direction}, magnitude = {magnitude}{frame}"
                    );
                    self.text.entry(name, &keys);
                }
            }
        }
    }

    /// Servos act in free motions.
    fn servos(&mut self) {
        let servos = self.model.drives.iter();
        let servos = servos.filter_map(|drive| Some((drive.joint, drive.servo?)));
        let servos: Vec<_> = servos.collect();
        if !servos.is_empty() {
            self.text.table("drives");
        }
        for (joint, gains) in servos {
            let Joint {
                coordinate: q,
                drawn,
                ..
            } = &self.model.joints[joint];
            let drawn = number(*drawn);
            let [proportional, derivative] = gains.map(number);
            let law = format!("-({proportional})*({q} + ({drawn})) - ({derivative})*{q}.velocity");
            let keys = format!(
                "applied-force = {}, magnitude = {}",
                quoted(q),
                quoted(&law)
            );
            self.load(&format!("servo_{q}"), &keys);
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
            if !(driven && low <= 0.0 && high >= 0.0 && low < high) {
                self.note(k, Effect::AtLimits, &format!("{word}: {AT_LIMITS}"));
                continue;
            }
            self.note(
                k,
                Effect::Kept,
                &format!("{word}: kept as a stop where free"),
            );
            let q = &joint.coordinate;
            let mut keys = format!("coordinate = {}", quoted(q));
            for (key, bound) in [("min", low), ("max", high)] {
                if bound.is_finite() {
                    keys += &format!(", {key} = {}", number(bound));
                }
            }
            stops.push((format!("limits_{q}"), keys));
        }
        if !stops.is_empty() {
            self.text.table("stops");
        }
        for (name, keys) in stops {
            self.text.entry(&name, &keys);
        }
    }
}
