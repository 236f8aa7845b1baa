//! ASMT, the format of OndselSolver and FreeCAD: a tree of lines, indented by tabs.

use crate::error::Result;
use crate::model::{End, GROUND, Joint, Kind, Model};
use crate::options::ImportOptions;
use crate::pose::{Matrix, Pose, Vector, cross, dot, length, sub};
use crate::xml::{Coverage, Element, Rules, Xml};
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
    let is_blank = |line: &&str| line.trim().is_empty();
    let is_above = |k: usize| {
        let below = lines[k + 1..].iter().find(|line| !is_blank(line));
        below.is_some_and(|below| depth(below) > depth(lines[k]))
    };
    let mut xml = "<asmt>".to_owned();
    // The open elements: depth, name, and whether it holds elements.
    let mut open: Vec<(usize, &str, bool)> = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        let (here, word) = (depth(line), line.trim());
        let ends = |above: &mut (usize, &str, bool)| !word.is_empty() && above.0 >= here;
        while let Some((_, name, _)) = open.pop_if(ends) {
            xml += &format!("</{name}>");
        }
        let is_name = word.starts_with(|c: char| c.is_ascii_alphabetic())
            && word.chars().all(|c| c.is_ascii_alphanumeric());
        if is_name && (is_above(k) || open.last().is_none_or(|(.., elements)| *elements)) {
            let inside = |k: &usize| is_blank(&lines[*k]) || depth(lines[*k]) > here;
            let mut below = (k + 1..lines.len()).take_while(inside);
            let elements = below.any(|k| depth(lines[k]) == here + 1 && is_above(k));
            xml += &format!("<{word}>");
            open.push((here, word, elements));
        } else {
            let words = word.split_whitespace().map(without_d);
            let plain = words.collect::<Vec<_>>().join(" ");
            let plain = plain.replace('&', "&amp;").replace('<', "&lt;");
            xml += &plain.replace('>', "&gt;");
        }
        xml.push('\n');
    }
    while let Some((_, name, _)) = open.pop() {
        xml += &format!("</{name}>");
    }
    xml + "</asmt>"
}

/// Floats may end with `d`.
fn without_d(word: &str) -> &str {
    match word.strip_suffix('d') {
        Some(float) if float.parse::<f64>().is_ok() => float,
        _ => word,
    }
}

struct Reader {
    model: Model,
    /// Markers by paths such as `/assembly/part/marker`.
    markers: HashMap<String, End>,
}

pub(crate) fn read(xml: &Xml<'_>, _: &ImportOptions) -> Result<(Model, Coverage)> {
    let root = xml.root().read();
    let assembly = root.child("Assembly");
    let assembly = assembly.ok_or_else(|| root.error("the file has no assembly"))?;
    let name = name(assembly);
    let mut reader = Reader {
        model: Model::new(name, root.place()),
        markers: HashMap::new(),
    };
    let gravity = assembly.vector("ConstantGravity")?;
    reader.model.gravity = gravity.unwrap_or_default();
    // The ground of the scene is the world, in which the assembly lies.
    let outer = pose(assembly)?;
    reader.markers(assembly, GROUND, outer, &format!("/{name}"))?;
    for part in assembly.inner("Parts") {
        reader.part(part, outer, name)?;
    }
    let parameters = assembly.child("SimulationParameters");
    let time = |key, default| parameters.map_or(Ok(default), |one| one.value(key, default));
    let duration = match time("tend", 1.0)? - time("tstart", 0.0)? {
        positive if positive > 0.0 => positive,
        _ => 1.0,
    };
    if let Some(sets) = assembly.child("ConstraintSets") {
        for joint in sets.inner("Joints") {
            reader.joint(joint.read())?;
        }
        for motion in sets.inner("Motions") {
            reader.motion(motion.read(), duration)?;
        }
        let _ = sets.child("GeneralConstraintSets");
    }
    let _ = assembly.child("ForceTorques");
    Ok((reader.model, xml.name_the_rest(&RULES)))
}

fn name<'d>(element: Element<'d>) -> &'d str {
    element.given("Name").unwrap_or_default()
}

/// Position and rotation.
fn pose(element: Element<'_>) -> Result<Pose> {
    let origin = element.vector("Position3D")?.unwrap_or_default();
    let rows = element.vector("RotationMatrix")?;
    let [a, b, c, d, e, f, g, h, i] = rows.unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let rows = [[a, b, c], [d, e, f], [g, h, i]];
    let [x, y, z] = rows;
    let is_unit = |row: &Vector| (length(*row) - 1.0).abs() < 1e-6;
    if !(rows.iter().all(is_unit) && length(sub(cross(x, y), z)) < 1e-6) {
        return Err(element.error("the matrix is no rotation"));
    }
    Ok(Pose::new(origin, Matrix(rows)))
}

impl Reader {
    /// The markers of a part, or of the assembly.
    fn markers(&mut self, of: Element<'_>, body: usize, outer: Pose, path: &str) -> Result<()> {
        for point in of.inner("RefPoints") {
            let outer = outer.then(pose(point.read())?);
            for marker in point.inner("Markers") {
                let frame = outer.then(pose(marker.read())?);
                let path = format!("{path}/{}", name(marker));
                self.markers.insert(path, End::new(body, frame));
            }
        }
        Ok(())
    }

    fn part(&mut self, part: Element<'_>, outer: Pose, assembly: &str) -> Result<()> {
        let name = name(part.read());
        let world = outer.then(pose(part)?);
        let body = self.model.push_body(name, part.place(), world);
        if let Some(marker) = part.child("PrincipalMassMarker") {
            let frame = world.then(pose(marker)?);
            let mass = marker.mass(marker.value("Mass", 0.0)?)?;
            let moments: Vector = marker.vector("MomentOfInertias")?.unwrap_or_default();
            if mass == 1.0 && moments == [1.0; 3] {
                let what = "1 kg and 1 kg m2, the default of programs without masses";
                part.kept(format!("part {name}: {what}"));
            }
            let _ = marker.given("Name");
            self.model.bodies[body].add_mass(mass, frame, Matrix::diagonal(moments));
        }
        self.markers(part, body, world, &format!("/{assembly}/{name}"))
    }

    fn end(&self, joint: Element<'_>, key: &str) -> Result<End> {
        let path = joint.given(key).unwrap_or_default();
        joint.known(self.markers.get(path).copied(), "marker", path)
    }

    fn joint(&mut self, element: Element<'_>) -> Result<()> {
        let name = name(element);
        let kind = match element.tag() {
            "RevoluteJoint" => Kind::Hinge,
            "CylindricalJoint" => Kind::Cylinder,
            "FixedJoint" => Kind::Fixed,
            "TranslationalJoint" => Kind::Slide,
            "SphericalJoint" => Kind::Ball,
            "PlanarJoint" => Kind::Planar,
            "SphSphJoint" => Kind::Distance(element.value("distanceIJ", 0.0)?),
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
        let [here, there] = ends.map(|end| end.frame);
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

    fn motion(&mut self, element: Element<'_>, duration: f64) -> Result<()> {
        let path = element.given("MotionJoint").unwrap_or_default();
        let name = path.rsplit('/').next().unwrap_or_default();
        let joint = self.model.driveable(name);
        let joint = element.known(joint, "joint with one coordinate", path)?;
        let key = match self.model.joints[joint].is_angle() {
            true => "RotationZ",
            false => "TranslationZ",
        };
        let law = element.given(key).unwrap_or_default();
        let expression = element.known(expression(law), "law that is read as", law)?;
        let _ = element.given("Name");
        element.kept(format!("motion of {name}: {key} = {law}, drives it"));
        self.model.drive(joint).law = Some((expression, duration));
        Ok(())
    }
}

/// A law in `time` as an expression of a scene in t.
fn expression(law: &str) -> Option<String> {
    let mut text = String::new();
    for (k, c) in law.char_indices() {
        let after_digit = text.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        // Floats may end with `d`.
        if !(c == 'd' && after_digit && !law[k + 1..].starts_with(char::is_alphanumeric)) {
            text.push(c);
        }
    }
    let mut words = text.split(|c: char| c.is_ascii() && !c.is_ascii_alphabetic());
    let known = "time sin cos tan sqrt exp abs pi e E"
        .split(' ')
        .chain([""]);
    let known: Vec<&str> = known.collect();
    let is_known = words.all(|word| known.contains(&word)) && !text.is_empty();
    is_known.then(|| text.replace("time", "t"))
}

#[test]
fn floats_with_a_letter_and_the_time_become_an_expression_of_a_scene() {
    let law = |law| expression(law).unwrap_or_default();
    assert_eq!(law("1.0 + 2.0d*pi*time"), "1.0 + 2.0*pi*t");
    assert_eq!(law("1.5e-3d*sin(time)"), "1.5e-3*sin(t)");
    assert_eq!(expression("system(1)"), None);
}
