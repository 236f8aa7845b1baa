//! Writes a model as a scene, drawn in one frame: that of the ground, in the pose as drawn.

mod forces;
mod text;

use crate::error::DoorError;
use crate::finding::Effect;
use crate::model::{Drive, GROUND, Joint, Kind, Model, Motion};
use crate::names::{Names, allowed, free_name};
use crate::plane::{Plane, size};
use crate::pose::{Matrix, Pose, Vector, add, cross, dot, length, scaled, sub, unit};
use std::collections::HashSet;
use std::f64::consts::TAU;
pub(crate) use text::comment;
use text::{Text, key, list, number, quoted};

/// Ends closer than this, relative to the size, are one point; axes closer are one axis.
const ONE: f64 = 1e-12;

pub(crate) struct Writer<'m> {
    model: &'m Model,
    plane: Option<Plane>,
    names: Names,
    size: f64,
    /// The names of loads and drives.
    load_names: HashSet<String>,
    text: Text,
}

/// The scene of a model.
pub(crate) fn write(model: &Model, plane: Option<Plane>) -> Result<String, DoorError> {
    let mut writer = Writer {
        model,
        plane,
        size: size(model),
        names: Names::new(model),
        load_names: HashSet::new(),
        text: Text::default(),
    };
    writer.text.pair("title", quoted(&model.title));
    (0..model.bodies.len()).for_each(|body| writer.body(body));
    writer.joints();
    writer.coordinates();
    writer.assembly();
    writer.loads();
    writer.motion();
    writer.text.finish()
}

impl Writer<'_> {
    /// A point in the axes of the scene; below the rounding of the drawing is zero.
    fn point(&self, point: Vector) -> String {
        self.vector(clean(point, 1e-16 * self.size))
    }

    fn vector(&self, vector: Vector) -> String {
        match self.plane {
            Some(plane) => list(&plane.point(vector)),
            None => list(&vector),
        }
    }

    /// A direction of a joint.
    fn direction(&self, axis: Vector) -> String {
        self.vector(clean(axis, 1e-15))
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
        let turned = apart(0) && matches!(joint.kind, Slide | Fixed);
        if joint.kind != Universal && !apart(2) && !turned {
            first.turn = second.turn;
        } else if matches!(joint.kind, Hinge | Cylinder | Screw(_)) {
            // The angle counts from the normals as drawn.
            let x = second.turn.column(0);
            let x = unit(sub(x, scaled(axis, dot(axis, x)))).unwrap_or(first.turn.column(0));
            first.turn = Matrix([x, cross(axis, x), axis]).transposed();
        }
        [first, second]
    }

    /// Whether a body is in the scene.
    fn has(&self, body: usize) -> bool {
        body == GROUND || self.model.joints.iter().any(|joint| joint.touches(body))
    }

    fn body(&mut self, of: usize) {
        if !self.has(of) {
            return;
        }
        let body = &self.model.bodies[of];
        let mut points: Vec<(String, Vector)> = Vec::new();
        for (joint, name) in self.model.joints.iter().zip(&self.names.joints) {
            let ends = joint.ends().into_iter().zip(self.ends(joint));
            let here = ends.filter(|(end, _)| end.body == of);
            points.extend(here.map(|(_, drawn)| (name.clone(), drawn.origin)));
        }
        points.extend(self.load_points(of));
        let mut taken: HashSet<String> = points.iter().map(|(name, _)| name.clone()).collect();
        for (name, point) in &body.points {
            let name = allowed(name);
            if !taken.contains(&name) {
                points.push((free_name(&name, &mut taken), body.pose.point(*point)));
            }
        }
        if points.is_empty() {
            points.push(("origin".to_owned(), body.pose.origin));
        }
        let entries = points
            .iter()
            .map(|(name, at)| format!("{} = {}", key(name), self.point(*at)));
        let entries: Vec<String> = entries.collect();
        self.text.table(&["bodies", &self.names.bodies[of]]);
        self.text.entry("points", &entries.join(", "));
        if of != GROUND {
            self.masses(of);
        }
    }

    fn masses(&mut self, of: usize) {
        let body = &self.model.bodies[of];
        if body.mass != 0.0 {
            self.text.pair("mass", number(body.mass));
            self.text
                .pair("center", self.point(body.pose.point(body.center)));
        }
        let inertia = body.inertia.turned(body.pose.turn);
        if let Some(Plane { normal, .. }) = self.plane {
            let about = dot(normal, inertia.apply(normal));
            if about != 0.0 {
                self.text.pair("inertia", number(about));
            }
            return;
        }
        let least = 1e-16 * (0..3).map(|k| inertia.0[k][k].abs()).fold(0.0, f64::max);
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = inertia.0.map(|row| clean(row, least));
        let all = [xx, yy, zz, xy, xz, yz];
        if all != [0.0; 6] {
            let count = if [xy, xz, yz] == [0.0; 3] { 3 } else { 6 };
            self.text.pair("inertia", list(&all[..count]));
        }
    }

    fn joints(&mut self) {
        self.text.table(&["joints"]);
        for (joint, name) in self.model.joints.iter().zip(&self.names.joints) {
            let bodies = joint.ends().map(|end| &self.names.bodies[end.body]);
            let ends = bodies
                .map(|body| quoted(&format!("{body}.{name}")))
                .join(", ");
            let places = self.ends(joint);
            let rest = match &self.plane {
                Some(plane) => self.planar_keys(joint, plane, places),
                None => self.spatial_keys(joint, places),
            };
            let kind = kind_key(joint, self.plane.is_some());
            self.text.entry(name, &format!("{kind} = [{ends}]{rest}"));
        }
        for coupling in &self.model.couplings {
            self.coupling(coupling);
        }
    }

    fn planar_keys(&self, joint: &Joint, plane: &Plane, ends: [Pose; 2]) -> String {
        let same = ends[0].turn == ends[1].turn;
        let axes = ends.map(|end| self.direction(end.turn.column(2)));
        match joint.kind {
            Kind::Slide if same => format!(", axis = {}", axes[0]),
            Kind::Slide => format!(", axes = [{}]", axes.join(", ")),
            Kind::Fixed if !same => {
                // A direction that is not along the normal shows the angle between the frames.
                let along = dot(ends[0].turn.column(0), plane.normal).abs();
                let k = usize::from(along > 0.8);
                let [[a, b], [c, d]] = ends.map(|end| plane.point(end.turn.column(k)));
                format!(", angle = {}", number(b.atan2(a) - d.atan2(c)))
            }
            Kind::Distance(length) => format!(", length = {}", number(length)),
            _ => String::new(),
        }
    }

    fn spatial_keys(&self, joint: &Joint, ends: [Pose; 2]) -> String {
        let both = |k: usize| {
            ends.map(|end| self.direction(end.turn.column(k)))
                .join(", ")
        };
        let same = ends[0].turn == ends[1].turn;
        let directed = match joint.kind {
            Kind::Ball | Kind::Distance(_) => String::new(),
            Kind::Fixed if same => String::new(),
            Kind::Universal => format!(", axes = [{}]", both(2)),
            _ if same => format!(", axis = {}", self.direction(ends[1].turn.column(2))),
            Kind::Planar => format!(", axes = [{}]", both(2)),
            _ => format!(", axes = [{}], normals = [{}]", both(2), both(0)),
        };
        match joint.kind {
            Kind::Screw(pitch) => format!("{directed}, pitch = {}", number(pitch)),
            Kind::Distance(length) => format!("{directed}, length = {}", number(length)),
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
            (true, Some(plane)) => format!("angle = {}", self.turning_pair(joint, plane)),
            (true, None) => format!("angle = {name}"),
            (false, _) => format!("{travel} = {name}"),
        }
    }

    fn coordinates(&mut self) {
        self.text.table(&["actuators"]);
        let driven: Vec<usize> = self.model.drives.iter().map(|drive| drive.joint).collect();
        let travel = if self.plane.is_some() {
            "length"
        } else {
            "travel"
        };
        for joint in &driven {
            let measure = self.measure(*joint, travel);
            self.text.entry(&self.names.coordinates[*joint], &measure);
        }
        let others = (0..self.model.joints.len()).filter(|joint| !driven.contains(joint));
        let named: Vec<usize> = others
            .filter(|joint| self.needs_coordinate(*joint))
            .collect();
        if !named.is_empty() {
            self.text.table(&["coordinates"]);
        }
        for joint in named {
            let measure = self.measure(joint, "travel");
            self.text.entry(&self.names.coordinates[joint], &measure);
        }
    }

    fn assembly(&mut self) {
        self.text.table(&["assembly"]);
        for drive in &self.model.drives {
            let drawn = self.model.joints[drive.joint].drawn;
            let name = &self.names.coordinates[drive.joint];
            if drawn != 0.0 {
                let text = format!("{name} is the file's coordinate minus {drawn}.");
                self.text.line(&comment(&text));
            }
            self.text.pair(name, 0);
        }
        // Bodies and slides of a planar scene need guesses, also where they are drawn.
        let bodies = (1..self.model.bodies.len()).filter(|body| self.has(*body));
        let bodies = bodies.map(|body| &self.names.bodies[body]);
        let joints = self.model.joints.iter().zip(&self.names.joints);
        let slides = joints
            .filter(|(joint, _)| joint.kind == Kind::Slide)
            .map(|(_, name)| name);
        let slides = slides.filter(|name| !self.names.bodies.contains(name));
        let guesses = bodies.chain(slides).filter(|_| self.plane.is_some());
        let guesses: Vec<&String> = guesses.collect();
        guesses.iter().for_each(|name| self.text.pair(name, 0));
    }

    fn motion(&mut self) {
        let law = |drive: &Drive| match &drive.motion {
            Motion::Unknown => None,
            Motion::Speed(0.0) => Some(("expression = \"0\"".to_owned(), 1.0)),
            Motion::Speed(speed) => {
                Some((format!("speed = {}", number(*speed)), TAU / speed.abs()))
            }
            Motion::Expression(law, duration) => {
                let law = format!("({law}) - ({})", self.model.joints[drive.joint].drawn);
                Some((format!("expression = {}", quoted(&law)), *duration))
            }
        };
        let drives = self.model.drives.iter();
        let laws: Option<Vec<(String, f64)>> = drives.clone().map(law).collect();
        let names = drives.map(|drive| self.names.coordinates[drive.joint].as_str());
        let names: Vec<&str> = names.collect();
        if let Some(laws) = laws {
            let shortest = laws
                .iter()
                .map(|(_, duration)| *duration)
                .fold(f64::MAX, f64::min);
            self.text.table(&["prescribed"]);
            self.text.pair("duration", number(shortest));
            for (name, (law, _)) in names.iter().zip(laws) {
                self.text.entry(name, &law);
            }
        } else if names.len() == 1 {
            self.text.table(&["coordinate-sweep"]);
            self.text.pair("speed", 1);
        } else {
            let names = names.join(", ");
            let text = format!("kinetostatics needs [prescribed]: a duration and laws of {names}");
            self.text.line(&comment(&text));
        }
    }

    fn note(&self, joint: usize, effect: Effect, text: &str) {
        let of = &self.model.joints[joint];
        self.model
            .note(&of.place, effect, format!("joint {} {text}", of.name));
    }
}

fn kind_key(joint: &Joint, in_plane: bool) -> &'static str {
    match joint.kind {
        Kind::Ball | Kind::Cylinder if in_plane => "revolute",
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

/// Zero in place of what is below `least`.
fn clean(vector: Vector, least: f64) -> Vector {
    vector.map(|x| if x.abs() < least { 0.0 } else { x })
}
