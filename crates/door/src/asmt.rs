//! ASMT, the format of OndselSolver and FreeCAD: a tree of lines, indented by tabs.

use crate::error::DoorError;
use crate::model::{End, GROUND, Joint, Kind, Model, Motion};
use crate::pose::{Matrix, Pose, Vector, dot, sub};
use crate::settle::{Read, span};
use crate::xml::{Element, Rules, Xml};
use std::collections::HashMap;

const RULES: Rules = Rules {
    idle: "Notes Velocity3D Omega3D RefCurves RefSurfaces FeatureOrder Density KinematicIJs SimulationParameters AnimationParameters Name \
        TimeSeries Times AssemblySeries PartSeries JointSeries MotionSeries OndselSolver Variables hmin hmax hout errorTol \
        errorTolPosKine errorTolAccKine iterMaxPosKine iterMaxAccKine",
    limits: "",
};

/// The lines as XML, each where it was: a line above deeper ones is an element, and so is one beside such a line; others are text.
pub(crate) fn as_xml(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let depth = |line: &str| line.len() - line.trim_start_matches('\t').len();
    let is_above = |k: usize| {
        let below = lines[k + 1..].iter().find(|line| !line.trim().is_empty());
        below.is_some_and(|below| depth(below) > depth(lines[k]))
    };
    let mut xml = "<asmt>".to_owned();
    // The open elements: depth, name, and whether it holds elements.
    let mut open: Vec<(usize, String, bool)> = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        let (here, word) = (depth(line), line.trim());
        while !word.is_empty() && open.last().is_some_and(|(above, ..)| *above >= here) {
            let name = open.pop().map(|(_, name, _)| name);
            xml += &format!("</{}>", name.unwrap_or_default());
        }
        let is_name = word.starts_with(|c: char| c.is_ascii_alphabetic())
            && word.chars().all(|c| c.is_ascii_alphanumeric());
        if is_name && (is_above(k) || open.last().is_none_or(|(.., elements)| *elements)) {
            let end = lines[k + 1..]
                .iter()
                .position(|line| !line.trim().is_empty() && depth(line) <= here);
            let end = end.map_or(lines.len(), |end| k + 1 + end);
            let elements =
                (k + 1..end).any(|below| depth(lines[below]) == here + 1 && is_above(below));
            xml += &format!("<{word}>");
            open.push((here, word.to_owned(), elements));
        } else {
            let plain = word
                .replace('&', "&amp;")
                .replace('<', "&lt;")
                .replace('>', "&gt;");
            // Floats may end with `d`.
            let float = |word: &str| {
                word.trim_end_matches('d')
                    .parse::<f64>()
                    .map(|_| word.trim_end_matches('d').to_owned())
            };
            let floats: Result<Vec<String>, _> = plain.split_whitespace().map(float).collect();
            xml += &floats.map_or(plain, |floats| floats.join(" "));
        }
        xml.push('\n');
    }
    while let Some((_, name, _)) = open.pop() {
        xml += &format!("</{name}>");
    }
    xml + "</asmt>"
}

struct Reader {
    model: Model,
    /// The body, and the place in it, of markers by paths such as `/assembly/part/marker`.
    markers: HashMap<String, (usize, Pose)>,
}

pub(crate) fn read(xml: &Xml<'_>) -> Result<Read, DoorError> {
    let root = xml.root(0).read();
    let assembly = root
        .child("Assembly")
        .ok_or_else(|| root.error("the file has no assembly"))?;
    let name = assembly.child_text("Name").unwrap_or_default();
    let mut reader = Reader {
        model: Model::new(name, &root.place(), xml.findings.clone()),
        markers: HashMap::new(),
    };
    reader.model.gravity = assembly
        .child_vector("ConstantGravity")?
        .unwrap_or_default();
    // The ground of the scene is the world, in which the assembly lies.
    let outer = pose(assembly)?;
    reader.markers(assembly, GROUND, outer, &format!("/{name}"))?;
    for part in assembly.inner("Parts") {
        reader.part(part, outer, name)?;
    }
    let parameters = assembly.child("SimulationParameters");
    let time = |key, default| parameters.map_or(Ok(default), |one| one.child_value(key, default));
    let duration = time("tend", 1.0)? - time("tstart", 0.0)?;
    if let Some(sets) = assembly.child("ConstraintSets") {
        for joint in sets.inner("Joints") {
            reader.joint(joint.read())?;
        }
        for motion in sets.inner("Motions") {
            reader.motion(motion.read(), if duration > 0.0 { duration } else { 1.0 })?;
        }
        let _ = sets.child("GeneralConstraintSets");
    }
    let _ = assembly.child("ForceTorques");
    span(&mut reader.model);
    Ok(Read {
        coverage: xml.name_the_rest(&RULES),
        model: reader.model,
        moves: Vec::new(),
    })
}

/// Position and rotation.
fn pose(element: Element<'_>) -> Result<Pose, DoorError> {
    let origin = element.child_vector("Position3D")?.unwrap_or_default();
    let Some([a, b, c, d, e, f, g, h, i]) = element.child_vector("RotationMatrix")? else {
        return Ok(Pose::at(origin));
    };
    let turn = Matrix([[a, b, c], [d, e, f], [g, h, i]]);
    let valid = (turn.rotation_error() < 1e-6).then_some(Pose::new(origin, turn));
    valid.ok_or_else(|| element.error("the matrix is no rotation"))
}

impl Reader {
    /// The markers of a part, or of the assembly.
    fn markers(
        &mut self,
        of: Element<'_>,
        body: usize,
        in_body: Pose,
        path: &str,
    ) -> Result<(), DoorError> {
        for point in of.inner("RefPoints") {
            let outer = in_body.then(pose(point)?);
            for marker in point.inner("Markers") {
                let name = marker.child_text("Name").unwrap_or_default();
                let place = (body, outer.then(pose(marker)?));
                self.markers.insert(format!("{path}/{name}"), place);
                let _ = marker.read();
            }
            let _ = point.read();
        }
        Ok(())
    }

    fn part(&mut self, part: Element<'_>, outer: Pose, assembly: &str) -> Result<(), DoorError> {
        let name = part.read().child_text("Name").unwrap_or_default();
        let number = self
            .model
            .push_body(name, part.place(), outer.then(pose(part)?));
        if let Some(marker) = part.child("PrincipalMassMarker") {
            let frame = pose(marker)?;
            let mass = marker.mass(marker.child_value("Mass", 0.0)?)?;
            let moments: Vector = marker.child_vector("MomentOfInertias")?.unwrap_or_default();
            if mass == 1.0 && moments == [1.0; 3] {
                part.kept(format!(
                    "part {name}: 1 kg and 1 kg m2, the default of programs without masses"
                ));
            }
            let _ = marker.child_text("Name");
            self.model.bodies[number].add_mass(
                mass,
                frame.origin,
                Matrix::diagonal(moments).turned(frame.turn),
            );
        }
        self.model.push_frame(name, number, Pose::IDENTITY);
        self.markers(part, number, Pose::IDENTITY, &format!("/{assembly}/{name}"))
    }

    fn end(&self, joint: Element<'_>, key: &str) -> Result<End, DoorError> {
        let path = joint.child_text(key).unwrap_or_default();
        let marker = self
            .markers
            .get(path)
            .map(|(body, frame)| End::new(*body, *frame));
        joint.known(marker, "marker", path)
    }

    fn joint(&mut self, element: Element<'_>) -> Result<(), DoorError> {
        let name = element.child_text("Name").unwrap_or_default();
        let kind = match element.tag() {
            "RevoluteJoint" => Kind::Hinge,
            "CylindricalJoint" => Kind::Cylinder,
            "FixedJoint" => Kind::Fixed,
            "TranslationalJoint" => Kind::Slide,
            "SphericalJoint" => Kind::Ball,
            "PlanarJoint" => Kind::Planar,
            "SphSphJoint" => Kind::Distance(element.child_value("distanceIJ", 0.0)?),
            other => {
                element.lost(format!("{other} {name}"));
                return Ok(());
            }
        };
        let ends = [self.end(element, "MarkerI")?, self.end(element, "MarkerJ")?];
        if ends[0].body == ends[1].body {
            return Err(element.error("the joint connects a part with itself"));
        }
        // The coordinate as drawn: the angle from x to x about z, or the travel along z.
        let [here, there] = ends.map(|end| self.model.drawn(&end));
        let [x, y, z] = here.turn.transposed().0;
        let other = there.turn.column(0);
        let mut joint = Joint::new(name, element.place(), kind, ends);
        joint.drawn = match kind {
            Kind::Slide => dot(z, sub(there.origin, here.origin)),
            Kind::Hinge | Kind::Cylinder => dot(y, other).atan2(dot(x, other)),
            _ => 0.0,
        };
        self.model.joints.push(joint);
        Ok(())
    }

    fn motion(&mut self, element: Element<'_>, duration: f64) -> Result<(), DoorError> {
        let path = element.child_text("MotionJoint").unwrap_or_default();
        let name = path.rsplit('/').next().unwrap_or_default();
        let joint = element.known(
            self.model.driveable(name),
            "joint with one coordinate",
            path,
        )?;
        let key = if self.model.joints[joint].is_angle() {
            "RotationZ"
        } else {
            "TranslationZ"
        };
        let law = element.child_text(key).unwrap_or_default();
        let expression = element.known(expression(law), "law that is read as", law)?;
        let _ = element.child_text("Name");
        element.kept(format!("motion of {name}: {key} = {law}, drives it"));
        self.model.drive(joint).motion = Motion::Expression(expression, duration);
        Ok(())
    }
}

/// A law in `time` as an expression of a scene in t.
fn expression(law: &str) -> Option<String> {
    let mut text = String::new();
    let mut rest = law.trim();
    while let Some(first) = rest.chars().next() {
        let is_word = first.is_ascii_alphabetic();
        let ends_number = |(k, c): &(usize, char)| {
            let signed = "+-".contains(*c) && rest[..*k].ends_with(['e', 'E']);
            !(c.is_ascii_digit() || ".eE".contains(*c) || signed)
        };
        let end = match first {
            _ if is_word => rest.find(|c: char| !c.is_ascii_alphanumeric()),
            '0'..='9' | '.' => rest.char_indices().find(ends_number).map(|(k, _)| k),
            _ => Some(first.len_utf8()),
        };
        let (token, after) = rest.split_at(end.unwrap_or(rest.len()));
        rest = after;
        match token {
            "time" => text.push('t'),
            "sin" | "cos" | "tan" | "sqrt" | "exp" | "abs" | "pi" => text += token,
            // A float may end with `d`.
            token if token.parse::<f64>().is_ok() && !is_word => {
                text += token;
                rest = rest.strip_prefix('d').unwrap_or(rest);
            }
            "+" | "-" | "*" | "/" | "^" | "(" | ")" | " " => text += token,
            _ => return None,
        }
    }
    (!text.is_empty()).then_some(text)
}

#[test]
fn floats_with_a_letter_and_the_time_become_an_expression_of_a_scene() {
    let law = |law| expression(law).unwrap_or_default();
    assert_eq!(law("1.0 + 2.0d*pi*time"), "1.0 + 2.0*pi*t");
    assert_eq!(law("1.5e-3d*sin(time)"), "1.5e-3*sin(t)");
    assert_eq!(expression("system(1)"), None);
}
