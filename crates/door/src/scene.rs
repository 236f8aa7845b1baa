//! Writes a model as a scene, drawn in one frame: that of the ground, in the pose as drawn.

mod forces;
mod text;

use crate::error::Result;
use crate::model::{Drive, GROUND, Joint, Kind, Model};
use crate::names::allowed;
use crate::plane::{Plane, size};
use crate::pose::{Matrix, Pose, Vector, add, cross, dot, length, scaled, sub, unit};
use std::collections::HashSet;
pub(crate) use text::comment;
use text::{Text, key, list, number, quoted};

/// Ends closer than this, relative to the size, are one point; axes closer are one axis.
const ONE: f64 = 1e-12;
/// Lengths below this, relative to the size, and parts of directions are rounding.
const ROUNDING: f64 = 1e-16;

struct Writer<'m> {
    model: &'m Model,
    plane: Option<Plane>,
    size: f64,
    /// The names of loads and drives.
    load_names: HashSet<String>,
    text: Text,
}

/// The scene of a model.
pub(crate) fn write(model: &Model, plane: Option<Plane>) -> Result<String> {
    let mut writer = Writer {
        model,
        plane,
        size: size(model),
        load_names: model.loads.iter().map(|load| load.name.clone()).collect(),
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
        for joint in &self.model.joints {
            let ends = joint.bodies().into_iter().zip(self.ends(joint));
            let here = ends.filter(|(body, _)| *body == of);
            points.extend(here.map(|(_, end)| (joint.name.clone(), end.origin)));
        }
        points.extend(self.load_points(of));
        for (name, point) in &body.points {
            let name = allowed(name);
            if points.iter().all(|(one, _)| *one != name) {
                points.push((name, *point));
            }
        }
        let point = |(name, at): &(String, Vector)| format!("{} = {}", key(name), self.point(*at));
        let points: Vec<String> = points.iter().map(point).collect();
        self.text.table(&format!("bodies.{}", key(&body.name)));
        self.text.entry("points", &points.join(", "));
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
        for joint in &self.model.joints {
            let end = |body: usize| format!("\"{}.{}\"", self.model.bodies[body].name, joint.name);
            let ends = joint.bodies().map(end);
            let places = self.ends(joint);
            let (kind, rest) = match &self.plane {
                Some(plane) => self.planar_keys(joint, plane, places),
                None => self.spatial_keys(joint, places),
            };
            let keys = format!("{kind} = [{}]{rest}", ends.join(", "));
            self.text.entry(&joint.name, &keys);
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
        let name = |body: usize| quoted(&self.model.bodies[body].name);
        let mut bodies = joint.bodies().map(name);
        if dot(joint.axis(), plane.normal) < 0.0 {
            bodies.reverse();
        }
        format!("[{}]", bodies.join(", "))
    }

    fn coordinates(&mut self) {
        let joints = &self.model.joints;
        let driven: Vec<usize> = self.model.drives.iter().map(|drive| drive.joint).collect();
        let others = (0..joints.len()).filter(|joint| !driven.contains(joint));
        let others = others.filter(|joint| self.needs_coordinate(*joint));
        let others = others.collect();
        let in_plane = ["travel", "length"][usize::from(self.plane.is_some())];
        for (table, numbers, travel) in [
            ("actuators", driven, in_plane),
            ("coordinates", others, "travel"),
        ] {
            if !numbers.is_empty() {
                self.text.table(table);
            }
            for joint in numbers.into_iter().map(|joint| &joints[joint]) {
                let name = quoted(&joint.name);
                let keys = match (joint.is_angle(), &self.plane) {
                    (true, Some(plane)) => format!("angle = {}", self.turning_pair(joint, plane)),
                    (true, None) => format!("angle = {name}"),
                    (false, _) => format!("{travel} = {name}"),
                };
                self.text.entry(&joint.coordinate, &keys);
            }
        }
    }

    fn assembly(&mut self) {
        self.text.table("assembly");
        for drive in &self.model.drives {
            let Joint {
                coordinate, drawn, ..
            } = &self.model.joints[drive.joint];
            if *drawn != 0.0 {
                let text = format!(
                    "{coordinate} is the file's coordinate minus {}.",
                    number(*drawn)
                );
                self.text.line(&comment(&text));
            }
            self.text.pair(coordinate, 0);
        }
        if self.plane.is_none() {
            return;
        }
        // Bodies and slides of a planar scene need guesses, also where they are drawn.
        let bodies = self.model.bodies.iter().enumerate().skip(1);
        let bodies = bodies.filter(|(body, _)| self.model.has(*body));
        let mut names: Vec<&String> = bodies.map(|(_, body)| &body.name).collect();
        for joint in &self.model.joints {
            if joint.kind == Kind::Slide && !names.contains(&&joint.name) {
                names.push(&joint.name);
            }
        }
        names.into_iter().for_each(|name| self.text.pair(name, 0));
    }

    fn motion(&mut self) {
        let drives = &self.model.drives;
        let law = |drive: &Drive| drive.law.clone();
        let laws: Option<Vec<(String, f64)>> = drives.iter().map(law).collect();
        let Some(laws) = laws else {
            let what = match drives.len() {
                1 => "a sweep takes its place",
                _ => "kinetostatics needs [prescribed]: a duration and laws of the actuators",
            };
            let text = format!("The file has no law of motion: {what}.");
            self.text.line(&format!("\n{}", comment(&text)));
            if drives.len() == 1 {
                self.text.line("[coordinate-sweep]\nspeed = 1");
            }
            return;
        };
        let durations = laws.iter().map(|(_, duration)| *duration);
        let duration = durations.fold(f64::MAX, f64::min);
        self.text.table("prescribed");
        self.text.pair("duration", number(duration));
        for (drive, (law, _)) in drives.iter().zip(laws) {
            let Joint {
                coordinate, drawn, ..
            } = &self.model.joints[drive.joint];
            let law = match drawn {
                0.0 => law,
                _ => format!("{law} - ({})", number(*drawn)),
            };
            let keys = format!("expression = {}", quoted(&law));
            self.text.entry(coordinate, &keys);
        }
    }
}

/// Zero in place of what is below `least`.
fn clean(vector: Vector, least: f64) -> Vector {
    vector.map(|x| if x.abs() < least { 0.0 } else { x })
}
