//! ASMT, the format of OndselSolver and FreeCAD: a tree of lines, indented by tabs.

mod joints;
mod tree;

use crate::error::DoorError;
use crate::finding::{Effect, Findings};
use crate::model::{Body, GROUND, Model};
use crate::pose::{Matrix, Pose};
use crate::settle::{Read, span};
use crate::xml::TextFile;
use std::collections::HashMap;
use tree::{Node, Tree};

/// Parts that no motion depends on.
const IDLE: &[&str] = &[
    "Notes",
    "Velocity3D",
    "Omega3D",
    "RefCurves",
    "RefSurfaces",
    "FeatureOrder",
    "Density",
    "KinematicIJs",
    "SimulationParameters",
    "AnimationParameters",
    "Name",
    "TimeSeries",
    "Times",
    "AssemblySeries",
    "PartSeries",
    "JointSeries",
    "MotionSeries",
    "OndselSolver",
    "Variables",
    "hmin",
    "hmax",
    "hout",
    "errorTol",
    "errorTolPosKine",
    "errorTolAccKine",
    "iterMaxPosKine",
    "iterMaxAccKine",
];

/// A marker: the body, and where it is in that body.
type Marker = (usize, Pose);

pub(crate) struct Reader<'t> {
    pub(crate) model: Model,
    tree: &'t Tree<'t>,
    /// By their paths, such as `/assembly/part/marker`.
    markers: HashMap<String, Marker>,
}

pub(crate) fn read(file: &TextFile, findings: Findings) -> Result<Read, DoorError> {
    let tree = Tree::new(file, findings.clone())?;
    let assembly = tree
        .roots()
        .into_iter()
        .find(|root| root.text() == "Assembly");
    let assembly =
        assembly.ok_or_else(|| file.error((0, 1), "the file has no assembly".to_owned(), ""))?;
    let name = assembly.value("Name");
    let mut reader = Reader {
        model: Model::new(&name, &file.place(1), findings),
        tree: &tree,
        markers: HashMap::new(),
    };
    reader.model.gravity = match assembly.child("ConstantGravity") {
        Some(gravity) => gravity.vector()?,
        None => [0.0; 3],
    };
    // The ground of the scene is the world, in which the assembly lies.
    let outer = assembly.pose()?;
    reader.markers(assembly, GROUND, outer, &format!("/{name}"))?;
    for part in assembly
        .child("Parts")
        .map(Node::children)
        .unwrap_or_default()
    {
        reader.part(part, outer, &name)?;
    }
    let duration = reader.duration(assembly)?;
    if let Some(sets) = assembly.child("ConstraintSets") {
        for joint in sets.child("Joints").map(Node::children).unwrap_or_default() {
            reader.joint(joint)?;
        }
        for motion in sets
            .child("Motions")
            .map(Node::children)
            .unwrap_or_default()
        {
            reader.motion(motion, duration)?;
        }
        let _ = sets.child("GeneralConstraintSets").map(Node::read);
    }
    let _ = assembly.child("ForceTorques").map(Node::read);
    span(&mut reader.model);
    let coverage = tree.name_the_rest(IDLE);
    Ok(Read {
        model: reader.model,
        moves: Vec::new(),
        coverage,
    })
}

impl<'t> Reader<'t> {
    /// The markers of a part, or of the assembly.
    fn markers(
        &mut self,
        of: Node<'t>,
        body: usize,
        in_body: Pose,
        path: &str,
    ) -> Result<(), DoorError> {
        for point in of
            .child("RefPoints")
            .map(Node::children)
            .unwrap_or_default()
        {
            let outer = in_body.then(point.read().pose()?);
            for marker in point
                .child("Markers")
                .map(Node::children)
                .unwrap_or_default()
            {
                let name = marker.read().value("Name");
                let pose = outer.then(marker.pose()?);
                self.markers.insert(format!("{path}/{name}"), (body, pose));
                self.model.frames.push((name, body, pose));
            }
        }
        Ok(())
    }

    fn part(&mut self, part: Node<'t>, outer: Pose, assembly: &str) -> Result<(), DoorError> {
        let name = part.read().value("Name");
        let pose = outer.then(part.pose()?);
        let number = self.model.bodies.len();
        let mut body = Body::new(&name, part.place(), pose);
        if let Some(marker) = part.child("PrincipalMassMarker") {
            let frame = marker.pose()?;
            let mass = marker
                .child("Mass")
                .map(|mass| mass.numbers::<1>())
                .transpose()?
                .map_or(0.0, |[mass]| mass);
            if mass < 0.0 {
                return Err(marker.error("the mass has to be 0 or more"));
            }
            let moments = marker
                .child("MomentOfInertias")
                .map(Node::vector)
                .transpose()?
                .unwrap_or_default();
            if mass == 1.0 && moments == [1.0; 3] {
                let text = format!(
                    "part {name}: 1 kg and 1 kg m2, the default of programs without masses"
                );
                self.model.findings.add(&part.place(), Effect::Kept, text);
            }
            let _ = marker.value("Name");
            body.add_mass(
                mass,
                frame.origin,
                Matrix::diagonal(moments).turned(frame.turn),
            );
        }
        self.model.bodies.push(body);
        self.markers(part, number, Pose::IDENTITY, &format!("/{assembly}/{name}"))
    }

    fn duration(&self, assembly: Node<'t>) -> Result<f64, DoorError> {
        let Some(parameters) = assembly.child("SimulationParameters") else {
            return Ok(1.0);
        };
        let time = |key: &str| {
            parameters
                .child(key)
                .map(|time| time.numbers::<1>())
                .transpose()
        };
        let [start] = time("tstart")?.unwrap_or([0.0]);
        let [end] = time("tend")?.unwrap_or([1.0]);
        Ok(if end > start { end - start } else { 1.0 })
    }
}
