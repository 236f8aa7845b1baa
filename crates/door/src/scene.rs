//! Writes a model as a scene, drawn in one frame: that of the ground, in the pose as drawn.

mod forces;
mod text;

use crate::error::DoorError;
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
/// Lengths below this, relative to the size, and parts of directions are rounding.
const ROUNDING: f64 = 1e-16;

struct Writer<'m> {
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
    let bodies = (0..model.bodies.len()).filter(|body| model.has(*body));
    bodies.for_each(|body| writer.body(body));
    writer.joints();
    writer.coordinates();
    writer.assembly();
    writer.loads();
    writer.motion();
    writer.text.finish()
}

impl Writer<'_> {
    /// A vector in the axes of the scene; below `least` is zero.
    fn vector(&self, vector: Vector, least: f64) -> String {
        let clean = clean(vector, least);
        match self.plane {
            Some(plane) => list(&plane.point(clean)),
            None => list(&clean),
        }
    }

    fn point(&self, point: Vector) -> String {
        self.vector(point, ROUNDING * self.size)
    }

    /// The directions of two frames.
    fn directions(&self, ends: [Pose; 2], column: usize) -> [String; 2] {
        ends.map(|end| self.vector(end.turn.column(column), 10.0 * ROUNDING))
    }

    /// Where the ends of a joint are drawn: in one place, unless the loop is open there. The coordinate is zero as drawn.
    fn ends(&self, joint: &Joint) -> [Pose; 2] {
        use Kind::{Cylinder, Fixed, Hinge, Screw, Slide, Universal};
        let [mut first, second] = joint.ends.map(|end| end.frame);
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

    fn body(&mut self, of: usize) {
        let body = &self.model.bodies[of];
        let mut points: Vec<(String, Vector)> = Vec::new();
        for (joint, name) in self.model.joints.iter().zip(&self.names.joints) {
            let ends = joint.bodies().into_iter().zip(self.ends(joint));
            let here = ends.filter(|(body, _)| *body == of);
            points.extend(here.map(|(_, end)| (name.clone(), end.origin)));
        }
        points.extend(self.load_points(of));
        let mut taken: HashSet<String> = points.iter().map(|(name, _)| name.clone()).collect();
        for (name, point) in &body.points {
            let name = allowed(name);
            if !taken.contains(&name) {
                points.push((free_name(&name, &mut taken), *point));
            }
        }
        let points = points
            .iter()
            .map(|(name, at)| format!("{} = {}", key(name), self.point(*at)));
        let points = points.collect::<Vec<_>>().join(", ");
        self.text
            .table(&format!("bodies.{}", key(&self.names.bodies[of])));
        self.text.entry("points", &points);
        if of != GROUND {
            self.masses(of);
        }
    }

    fn masses(&mut self, of: usize) {
        let body = &self.model.bodies[of];
        if body.mass != 0.0 {
            self.text.pair("mass", number(body.mass));
            self.text.pair("center", self.point(body.center));
        }
        let inertia = body.inertia;
        let all = match self.plane {
            Some(Plane { normal, .. }) => vec![dot(normal, inertia.apply(normal))],
            None => {
                let most = (0..3).map(|k| inertia.0[k][k].abs()).fold(0.0, f64::max);
                let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] =
                    inertia.0.map(|row| clean(row, ROUNDING * most));
                let off = [xy, xz, yz];
                [&[xx, yy, zz][..], if off == [0.0; 3] { &[] } else { &off }].concat()
            }
        };
        match all[..] {
            [about] if about != 0.0 => self.text.pair("inertia", number(about)),
            [_, _, ..] if all.iter().any(|x| *x != 0.0) => self.text.pair("inertia", list(&all)),
            _ => {}
        }
    }

    fn joints(&mut self) {
        self.text.table("joints");
        for (joint, name) in self.model.joints.iter().zip(&self.names.joints) {
            let ends = joint
                .bodies()
                .map(|body| quoted(&format!("{}.{name}", self.names.bodies[body])));
            let places = self.ends(joint);
            let (kind, rest) = match &self.plane {
                Some(plane) => self.planar_keys(joint, plane, places),
                None => self.spatial_keys(joint, places),
            };
            let keys = format!("{kind} = [{}]{rest}", ends.join(", "));
            self.text.entry(name, &keys);
        }
        for coupling in &self.model.couplings {
            self.coupling(coupling);
        }
    }

    /// The key of the kind of a joint in the plane, and further keys.
    fn planar_keys(&self, joint: &Joint, plane: &Plane, ends: [Pose; 2]) -> (&'static str, String) {
        let same = ends[0].turn == ends[1].turn;
        let axes = self.directions(ends, 2);
        match joint.kind {
            Kind::Slide if same => ("prismatic", format!(", axis = {}", axes[0])),
            Kind::Slide => ("prismatic", format!(", axes = [{}]", axes.join(", "))),
            Kind::Fixed if !same => {
                // A direction that is not along the normal shows the angle between the frames.
                let along = dot(ends[0].turn.column(0), plane.normal).abs();
                let k = usize::from(along > 0.8);
                let [[a, b], [c, d]] = ends.map(|end| plane.point(end.turn.column(k)));
                (
                    "weld",
                    format!(", angle = {}", number(b.atan2(a) - d.atan2(c))),
                )
            }
            Kind::Fixed => ("weld", String::new()),
            Kind::Distance(length) => ("distance", format!(", length = {}", number(length))),
            _ => ("revolute", String::new()),
        }
    }

    /// The key of the kind of a joint in space, and further keys.
    fn spatial_keys(&self, joint: &Joint, ends: [Pose; 2]) -> (&'static str, String) {
        let same = ends[0].turn == ends[1].turn;
        let both = |column: usize| self.directions(ends, column).join(", ");
        let directed = || match same {
            true => format!(", axis = {}", self.directions(ends, 2)[1]),
            false => format!(", axes = [{}], normals = [{}]", both(2), both(0)),
        };
        match joint.kind {
            Kind::Ball => ("spherical", String::new()),
            Kind::Distance(length) => ("distance", format!(", length = {}", number(length))),
            Kind::Fixed if same => ("weld", String::new()),
            Kind::Fixed => ("weld", directed()),
            Kind::Hinge => ("revolute", directed()),
            Kind::Slide => ("prismatic", directed()),
            Kind::Cylinder => ("cylindrical", directed()),
            Kind::Screw(pitch) => (
                "helical",
                format!("{}, pitch = {}", directed(), number(pitch)),
            ),
            Kind::Planar if same => ("planar", directed()),
            Kind::Planar => ("planar", format!(", axes = [{}]", both(2))),
            Kind::Universal => ("universal", format!(", axes = [{}]", both(2))),
        }
    }

    /// The bodies of an angle in the plane, in the order in which it is positive.
    fn turning_pair(&self, joint: &Joint, plane: &Plane) -> String {
        let mut bodies = joint.bodies().map(|body| quoted(&self.names.bodies[body]));
        if dot(joint.axis(), plane.normal) < 0.0 {
            bodies.reverse();
        }
        format!("[{}]", bodies.join(", "))
    }

    fn coordinates(&mut self) {
        let is_driven = |k: &usize| self.model.drives.iter().any(|drive| drive.joint == *k);
        let driven = self.model.drives.iter().map(|drive| drive.joint).collect();
        let others =
            (0..self.model.joints.len()).filter(|k| !is_driven(k) && self.needs_coordinate(*k));
        let in_plane = if self.plane.is_some() {
            "length"
        } else {
            "travel"
        };
        for (table, joints, travel) in [
            ("actuators", driven, in_plane),
            ("coordinates", others.collect::<Vec<usize>>(), "travel"),
        ] {
            if !joints.is_empty() {
                self.text.table(table);
            }
            for k in joints {
                let (joint, name) = (&self.model.joints[k], quoted(&self.names.joints[k]));
                let keys = match (joint.is_angle(), &self.plane) {
                    (true, Some(plane)) => format!("angle = {}", self.turning_pair(joint, plane)),
                    (true, None) => format!("angle = {name}"),
                    (false, _) => format!("{travel} = {name}"),
                };
                self.text.entry(&self.names.coordinates[k], &keys);
            }
        }
    }

    fn assembly(&mut self) {
        self.text.table("assembly");
        for drive in &self.model.drives {
            let drawn = self.model.joints[drive.joint].drawn;
            let name = &self.names.coordinates[drive.joint];
            if drawn != 0.0 {
                let text = format!("{name} is the file's coordinate minus {}.", number(drawn));
                self.text.line(&comment(&text));
            }
            self.text.pair(name, 0);
        }
        if self.plane.is_none() {
            return;
        }
        // Bodies and slides of a planar scene need guesses, also where they are drawn.
        let bodies = (1..self.model.bodies.len()).filter(|body| self.model.has(*body));
        let bodies = bodies.map(|body| &self.names.bodies[body]);
        let joints = self.model.joints.iter().zip(&self.names.joints);
        let slides = joints.filter(|(joint, _)| joint.kind == Kind::Slide);
        let slides = slides.map(|(_, name)| name);
        let slides = slides.filter(|name| !self.names.bodies.contains(name));
        bodies
            .chain(slides)
            .for_each(|name| self.text.pair(name, 0));
    }

    fn motion(&mut self) {
        let law = |drive: &Drive| {
            let drawn = self.model.joints[drive.joint].drawn;
            match &drive.motion {
                Motion::Unknown => None,
                Motion::Speed(0.0) => Some(("expression = \"0\"".to_owned(), 1.0)),
                Motion::Speed(speed) => {
                    Some((format!("speed = {}", number(*speed)), TAU / speed.abs()))
                }
                Motion::Expression(law, duration) => {
                    let law = match drawn {
                        0.0 => law.clone(),
                        _ => format!("{law} - ({})", number(drawn)),
                    };
                    Some((format!("expression = {}", quoted(&law)), *duration))
                }
            }
        };
        let drives = self.model.drives.iter();
        let laws: Option<Vec<(String, f64)>> = drives.clone().map(law).collect();
        let names = drives.map(|drive| &self.names.coordinates[drive.joint]);
        let names: Vec<&String> = names.collect();
        let Some(laws) = laws else {
            let what = match names.len() {
                1 => "a sweep takes its place",
                _ => "kinetostatics needs [prescribed]: a duration and laws of the actuators",
            };
            let text = format!("The file has no law of motion: {what}.");
            self.text.line(&format!("\n{}", comment(&text)));
            if names.len() == 1 {
                self.text.line("[coordinate-sweep]\nspeed = 1");
            }
            return;
        };
        let durations = laws.iter().map(|(_, duration)| *duration);
        self.text.table("prescribed");
        self.text
            .pair("duration", number(durations.fold(f64::MAX, f64::min)));
        for (name, (law, _)) in names.into_iter().zip(laws) {
            self.text.entry(name, &law);
        }
    }
}

/// Zero in place of what is below `least`.
fn clean(vector: Vector, least: f64) -> Vector {
    vector.map(|x| if x.abs() < least { 0.0 } else { x })
}
