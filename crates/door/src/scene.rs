//! Writes a model as a scene, drawn in one frame: that of the ground, in the pose as drawn.

mod forces;
mod text;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{GROUND, Joint, Kind, Model, Motion};
use crate::names::{Names, allowed, free_name};
use crate::plane::{Plane, size};
use crate::pose::{Matrix, Pose, Vector, add, cross, dot, length, scaled, sub, unit};
use std::collections::HashSet;
use std::f64::consts::TAU;
pub(crate) use text::comment;
use text::{Text, key, quoted};

/// Ends closer than this, relative to the size, are one point; axes closer are one axis.
const ONE: f64 = 1e-12;

pub(crate) struct Writer<'m> {
    model: &'m Model,
    plane: Option<Plane>,
    names: Names,
    size: f64,
    text: Text,
}

/// The scene of a model.
pub(crate) fn write(model: &Model, plane: Option<Plane>) -> Result<String, DoorError> {
    let mut writer = Writer {
        model,
        plane,
        size: size(model),
        text: Text::default(),
        names: Names::new(model),
    };
    writer
        .text
        .line(&format!("title = {}", quoted(&model.title)));
    writer.bodies();
    writer.joints();
    writer.coordinates();
    writer.assembly();
    writer.loads();
    writer.motion();
    writer.text.finish()
}

impl Writer<'_> {
    fn point(&mut self, point: Vector) -> String {
        // Below the rounding of the drawing is zero.
        let least = 1e-16 * self.size;
        let point = point.map(|x| if x.abs() < least { 0.0 } else { x });
        self.vector(point)
    }

    /// A point or direction in the axes of the scene.
    fn vector(&mut self, vector: Vector) -> String {
        match self.plane {
            Some(plane) => self.text.list(&plane.point(vector)),
            None => self.text.list(&vector),
        }
    }

    /// A direction of a joint.
    fn direction(&mut self, axis: Vector) -> String {
        let axis = axis.map(|x| if x.abs() < 1e-16 { 0.0 } else { x });
        self.vector(axis)
    }

    /// Where the ends of a joint are drawn: in one place, unless the loop is open there. The coordinate is zero as drawn.
    fn ends(&self, joint: &Joint) -> [Pose; 2] {
        use Kind::{Cylinder, Fixed, Hinge, Screw, Slide, Universal};
        let [mut first, second] = joint.ends().map(|end| self.model.drawn(end));
        let axis = first.turn.column(2);
        if matches!(joint.kind, Slide | Cylinder | Screw(_)) {
            let travel = dot(axis, sub(second.origin, first.origin));
            first.origin = add(first.origin, scaled(axis, travel));
        }
        if length(sub(first.origin, second.origin)) <= ONE * self.size {
            first.origin = second.origin;
        }
        let apart = |k: usize| length(sub(first.turn.column(k), second.turn.column(k))) > ONE;
        let turns = apart(0) && matches!(joint.kind, Slide | Fixed);
        if joint.kind != Universal && !apart(2) && !turns {
            first.turn = second.turn;
        } else if matches!(joint.kind, Hinge | Cylinder | Screw(_)) {
            // The angle counts from the normals as drawn.
            let x = sub(
                second.turn.column(0),
                scaled(axis, dot(axis, second.turn.column(0))),
            );
            first.turn = unit(x).map_or(first.turn, |x| {
                Matrix([x, cross(axis, x), axis]).transposed()
            });
        }
        [first, second]
    }

    /// Whether a body is in the scene.
    fn has(&self, body: usize) -> bool {
        body == GROUND || self.model.joints.iter().any(|joint| joint.touches(body))
    }

    fn bodies(&mut self) {
        for body in 0..self.model.bodies.len() {
            if self.has(body) {
                self.body(body);
            }
        }
    }

    fn body(&mut self, number: usize) {
        let body = &self.model.bodies[number];
        self.text.table(&["bodies", &self.names.bodies[number]]);
        let mut points: Vec<(String, Vector)> = Vec::new();
        for (k, joint) in self.model.joints.iter().enumerate() {
            let ends = self.ends(joint);
            for (end, drawn) in joint.ends().into_iter().zip(ends) {
                if end.body == number {
                    points.push((self.names.joints[k].clone(), drawn.origin));
                }
            }
        }
        let mut taken: HashSet<String> = points.iter().map(|(name, _)| name.clone()).collect();
        points.extend(self.load_points(number));
        taken.extend(points.iter().map(|(name, _)| name.clone()));
        for (name, point) in &body.points {
            let name = allowed(name);
            if !taken.contains(&name) {
                points.push((free_name(&name, &mut taken), body.pose.point(*point)));
            }
        }
        if points.is_empty() {
            points.push(("origin".to_owned(), body.pose.origin));
        }
        let entry =
            |(name, point): (String, Vector)| format!("{} = {}", key(&name), self.point(point));
        let points: Vec<String> = points.into_iter().map(entry).collect();
        self.text
            .line(&format!("points = {{ {} }}", points.join(", ")));
        if number == GROUND {
            return;
        }
        if body.mass != 0.0 {
            let center = self.point(body.pose.point(body.center));
            self.text.pair("mass", body.mass);
            self.text.line(&format!("center = {center}"));
        }
        let inertia = body.inertia.turned(body.pose.turn);
        if let Some(plane) = &self.plane {
            let about = dot(plane.normal, inertia.apply(plane.normal));
            if about != 0.0 {
                self.text.pair("inertia", about);
            }
            return;
        }
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = inertia.0;
        let least = 1e-16
            * [xx, yy, zz]
                .iter()
                .fold(0.0f64, |most, x| most.max(x.abs()));
        let all = [xx, yy, zz, xy, xz, yz].map(|x| if x.abs() <= least { 0.0 } else { x });
        if all.iter().any(|x| *x != 0.0) {
            let count = if all[3..].iter().all(|x| *x == 0.0) {
                3
            } else {
                6
            };
            let list = self.text.list(&all[..count]);
            self.text.line(&format!("inertia = {list}"));
        }
    }

    fn joints(&mut self) {
        self.text.table(&["joints"]);
        for (number, joint) in self.model.joints.iter().enumerate() {
            let bodies = joint.ends().map(|end| self.names.bodies[end.body].clone());
            let name = self.names.joints[number].clone();
            let ends = bodies
                .map(|body| quoted(&format!("{body}.{name}")))
                .join(", ");
            let [first, second] = self.ends(joint);
            let kind = self.kind_key(joint);
            let rest = match self.plane {
                Some(plane) => self.planar_keys(joint, &plane, [first, second]),
                None => self.spatial_keys(joint, [first, second]),
            };
            let name = key(&name);
            self.text
                .line(&format!("{name} = {{ {kind} = [{ends}]{rest} }}"));
        }
        for coupling in &self.model.couplings {
            self.coupling(coupling);
        }
    }

    fn kind_key(&self, joint: &Joint) -> &'static str {
        match joint.kind {
            Kind::Ball | Kind::Cylinder if self.plane.is_some() => "revolute",
            Kind::Fixed => "weld",
            Kind::Hinge => "revolute",
            Kind::Slide => "prismatic",
            Kind::Cylinder => "cylindrical",
            Kind::Screw(_) => "helical",
            Kind::Universal => "universal",
            Kind::Ball => "spherical",
            Kind::Planar => "planar",
            Kind::Distance(_) => "distance",
        }
    }

    fn planar_keys(&mut self, joint: &Joint, plane: &Plane, [first, second]: [Pose; 2]) -> String {
        let axes = [first, second].map(|end| end.turn.column(2));
        match joint.kind {
            Kind::Slide if first.turn == second.turn => {
                format!(", axis = {}", self.direction(axes[0]))
            }
            Kind::Slide => format!(
                ", axes = [{}, {}]",
                self.direction(axes[0]),
                self.direction(axes[1])
            ),
            Kind::Fixed if first.turn != second.turn => {
                // The direction that lies most in the plane shows the angle between the frames.
                let flat = |k: usize| dot(first.turn.column(k), plane.normal).abs();
                let k = if flat(0) < 0.8 { 0 } else { 1 };
                let angle = |end: Pose| {
                    let [x, y] = plane.point(end.turn.column(k));
                    y.atan2(x)
                };
                let number = self.text.number(angle(first) - angle(second));
                format!(", angle = {number}")
            }
            Kind::Distance(length) => format!(", length = {}", self.text.number(length)),
            _ => String::new(),
        }
    }

    fn spatial_keys(&mut self, joint: &Joint, [first, second]: [Pose; 2]) -> String {
        let both = |writer: &mut Self, k: usize| {
            let [a, b] = [first, second].map(|end| writer.direction(end.turn.column(k)));
            format!("[{a}, {b}]")
        };
        let aligned = first.turn == second.turn;
        let directed = match joint.kind {
            Kind::Ball | Kind::Distance(_) => String::new(),
            Kind::Fixed if aligned => String::new(),
            Kind::Universal => format!(", axes = {}", both(self, 2)),
            _ if aligned => format!(", axis = {}", self.direction(second.turn.column(2))),
            Kind::Planar => format!(", axes = {}", both(self, 2)),
            _ => format!(", axes = {}, normals = {}", both(self, 2), both(self, 0)),
        };
        match joint.kind {
            Kind::Screw(pitch) => format!("{directed}, pitch = {}", self.text.number(pitch)),
            Kind::Distance(length) => format!("{directed}, length = {}", self.text.number(length)),
            _ => directed,
        }
    }

    /// The bodies of an angle in the plane, in the order in which it is positive.
    fn turning_pair(&self, joint: usize, plane: &Plane) -> String {
        let joint = &self.model.joints[joint];
        let mut bodies = joint.ends().map(|end| quoted(&self.names.bodies[end.body]));
        if dot(self.model.drawn(&joint.second).turn.column(2), plane.normal) < 0.0 {
            bodies.reverse();
        }
        format!("[{}]", bodies.join(", "))
    }

    /// What a coordinate measures.
    fn measure(&self, joint: usize, travel: &str) -> String {
        let name = quoted(&self.names.joints[joint]);
        match (self.model.joints[joint].is_angle(), &self.plane) {
            (true, Some(plane)) => format!("{{ angle = {} }}", self.turning_pair(joint, plane)),
            (true, None) => format!("{{ angle = {name} }}"),
            (false, _) => format!("{{ {travel} = {name} }}"),
        }
    }

    fn coordinates(&mut self) {
        self.text.table(&["actuators"]);
        let driven: Vec<usize> = self.model.drives.iter().map(|drive| drive.joint).collect();
        for joint in &driven {
            let travel = if self.plane.is_some() {
                "length"
            } else {
                "travel"
            };
            let measure = self.measure(*joint, travel);
            self.text
                .line(&format!("{} = {measure}", self.names.coordinates[*joint]));
        }
        let named = (0..self.model.joints.len())
            .filter(|joint| !driven.contains(joint) && self.needs_coordinate(*joint));
        let named: Vec<usize> = named.collect();
        if !named.is_empty() {
            self.text.table(&["coordinates"]);
        }
        for joint in named {
            let measure = self.measure(joint, "travel");
            self.text
                .line(&format!("{} = {measure}", self.names.coordinates[joint]));
        }
    }

    fn assembly(&mut self) {
        self.text.table(&["assembly"]);
        let mut zero: Vec<String> = Vec::new();
        for drive in &self.model.drives {
            let drawn = self.model.joints[drive.joint].drawn;
            let name = &self.names.coordinates[drive.joint];
            if drawn != 0.0 {
                self.text.line(&comment(&format!(
                    "{name} is the file's coordinate minus {drawn}."
                )));
            }
            zero.push(name.clone());
        }
        if self.plane.is_some() {
            let bodies = (1..self.model.bodies.len()).filter(|body| self.has(*body));
            zero.extend(bodies.map(|body| key(&self.names.bodies[body])));
            let joints = self.model.joints.iter().zip(&self.names.joints);
            let slides = joints.filter(|(joint, name)| {
                joint.kind == Kind::Slide && !self.names.bodies.contains(name)
            });
            zero.extend(slides.map(|(_, name)| key(name)));
        }
        for name in zero {
            self.text.line(&format!("{name} = 0"));
        }
    }

    fn motion(&mut self) {
        let drives = &self.model.drives;
        let laws: Option<Vec<(String, f64)>> = drives
            .iter()
            .map(|drive| {
                let of = &self.model.joints[drive.joint];
                match &drive.motion {
                    Motion::Unknown => None,
                    Motion::Speed(speed) if *speed != 0.0 => {
                        Some((format!("speed = {speed}"), TAU / speed.abs()))
                    }
                    Motion::Speed(_) => Some(("expression = \"0\"".to_owned(), 1.0)),
                    Motion::Expression(law, duration) => Some((
                        format!(
                            "expression = {}",
                            quoted(&format!("({law}) - ({})", of.drawn))
                        ),
                        *duration,
                    )),
                }
            })
            .collect();
        if let Some(laws) = laws {
            let duration = laws
                .iter()
                .map(|(_, duration)| *duration)
                .fold(f64::MAX, f64::min);
            self.text.table(&["prescribed"]);
            self.text.pair("duration", duration);
            for (drive, (law, _)) in drives.iter().zip(laws) {
                self.text.line(&format!(
                    "{} = {{ {law} }}",
                    self.names.coordinates[drive.joint]
                ));
            }
        } else if let [_] = drives[..] {
            self.text.table(&["coordinate-sweep"]);
            self.text.line("speed = 1");
        } else {
            let names: Vec<_> = drives
                .iter()
                .map(|drive| self.names.coordinates[drive.joint].as_str())
                .collect();
            let text = format!(
                "kinetostatics needs [prescribed] with the duration and a law of each of {}",
                names.join(", ")
            );
            self.text.line(&comment(&text));
        }
    }

    fn note(&self, joint: usize, effect: Effect, text: &str) {
        let of = &self.model.joints[joint];
        self.model
            .findings
            .add(&of.place, effect, format!("joint {} {text}", of.name));
    }
}
