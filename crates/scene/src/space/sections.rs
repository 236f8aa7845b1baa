//! The sections of a scene in space.

use super::actuators::require_lengths;
use super::friction::add_friction;
use super::joints::Joints;
use super::loads::SpaceLoads;
use super::reactions::in_ground_axes;
use crate::assembly::ParsedAssembly;
use crate::bodies::Bodies;
use crate::build::Sections;
use crate::coordinates::{ParsedActuator, ParsedCoordinates, Parts};
use crate::diagnostics::Diagnostics;
use crate::dimensions::Space;
use crate::magnitude::Magnitudes;
use crate::table_reader::TableReader;
use dwell_geometry::space::{Actuator, Assembly, Coordinate, Mechanism};
use dwell_geometry::{Body, BodyId, JointId};
use dwell_kinetostatics::space::{Load, Reaction};

impl Sections for Space {
    fn joints<'a>(
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_, Self>,
        log: &'a Diagnostics,
    ) -> Joints<'a> {
        Joints::read(fields, bodies, log)
    }

    fn complete_joints(
        joints: &mut Joints<'_>,
        actuators: &[ParsedActuator<'_, Self>],
        coordinates: &ParsedCoordinates<'_, Coordinate>,
    ) -> Vec<Option<[BodyId; 2]>> {
        joints.read_couplings(coordinates);
        require_lengths(joints, actuators);
        let joints = joints.list.iter();
        joints.map(|j| Some(j.joint.as_ref()?.bodies)).collect()
    }

    fn loads(
        loads: Option<&TableReader<'_>>,
        friction: Option<&TableReader<'_>>,
        parts: &Parts<'_, '_, Self>,
        magnitudes: &Magnitudes<Coordinate>,
    ) -> Vec<Load> {
        let Parts { bodies, joints } = *parts;
        let reader = SpaceLoads {
            bodies,
            joints,
            magnitudes,
        };
        let mut all = loads.map_or_else(Vec::new, |fields| reader.loads(fields));
        if let Some(fields) = friction {
            add_friction(fields, joints, &mut all);
        }
        all
    }

    fn assembly(parsed: ParsedAssembly<Self>, start: &[f64], _: &Joints<'_>) -> Assembly {
        let guesses = parsed.guesses.into_iter();
        Assembly {
            q: start.to_vec(),
            placements: guesses.map(Option::unwrap_or_default).collect(),
        }
    }

    fn mechanism(
        bodies: Vec<Body>,
        ground: usize,
        joints: Joints<'_>,
        actuators: Vec<Actuator>,
        _: &Assembly,
    ) -> Mechanism {
        Mechanism {
            bodies,
            ground,
            joints: joints.list.into_iter().filter_map(|j| j.joint).collect(),
            actuators,
            couplings: joints.couplings,
        }
    }

    fn all_reactions(mechanism: &Mechanism) -> Vec<Reaction> {
        let joints = mechanism.joints.iter().enumerate();
        let reactions = joints.flat_map(|(j, joint)| {
            let reaction = move |component| Reaction {
                joint: JointId(j),
                component,
            };
            let components = in_ground_axes(joint, mechanism.ground);
            components.into_iter().map(reaction)
        });
        reactions.collect()
    }

    fn driven_coordinates(
        mechanism: &Mechanism,
    ) -> impl Iterator<Item = (&str, Coordinate)> + Clone {
        mechanism.actuators.iter().map(|a| {
            let joint = &mechanism.joints[a.kind.joint().0];
            (a.name.as_str(), a.kind.coordinate(joint))
        })
    }
}
