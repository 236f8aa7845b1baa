//! The sections of a scene in space, read in an order in which each finds what it refers to.

use super::actuators::{ParsedActuator, actuators, require_lengths};
use super::assembly::assembly;
use super::bodies::Space;
use super::coordinates::coordinates;
use super::friction::add_friction;
use super::joints::Joints;
use super::loads::SpaceLoads;
use super::requests::{SpaceRequests, in_ground_axes, one_reaction, requests};
use super::scene::SpaceScene;
use crate::bodies::Bodies;
use crate::build::is_filled;
use crate::coordinates::NamedActuator;
use crate::diagnostics::Diagnostics;
use crate::drives::{DriveReader, reject_drives_of_prescribed, reject_shared_names};
use crate::error::{SceneError, Source};
use crate::events::EventReader;
use crate::file::SceneFile;
use crate::keys::table;
use crate::magnitude::Magnitudes;
use crate::motion::ParsedMotion;
use crate::number_paths::body_numbers;
use crate::prescribed::{coordinate_sweep, prescribed_motion};
use crate::sections::{
    needed_section, one_line, place_sections, printable, read_root, report_unjoined_bodies,
    section, text_of, title,
};
use crate::stops::stops as stops_of;
use crate::table_reader::TableReader;
use dwell_geometry::space::{Joint, Mechanism};
use dwell_geometry::{Body, JointId};
use dwell_kinetostatics::space::Reaction;

impl SpaceScene {
    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let root = crate::read::syntax(source)?;
        let log = &Diagnostics::new(source);
        read_root(root.get_ref(), log, |fields| read(name, source, fields)).map(Self::with_doubts)
    }
}

/// The scene; none if anything was found wrong.
//
// Long: one section after another, in an order in which each finds the names it refers to.
fn read(name: String, source: &Source, fields: &TableReader<'_>) -> Option<SpaceScene> {
    let log = fields.log();
    reject_unknown_sections(fields);
    place_sections(fields);
    let section = |key| section(fields, key);
    let (title, note) = (title(fields), text_of(fields, "note"));
    // Without bodies every other name would be unknown: one message is enough.
    let bodies_section = needed_section(fields, "bodies")?;
    let bodies: Bodies<'_, Space> = Bodies::read(&bodies_section);
    let body_numbers = body_numbers(&bodies, &bodies_section);
    let joints = Joints::read(needed_section(fields, "joints").as_ref(), &bodies, log);
    let actuators = section("actuators").map_or_else(Vec::new, |f| actuators(&f, &bodies, &joints));
    require_lengths(&joints, &actuators);
    let by_name: Vec<NamedActuator<'_>> = actuators.iter().map(|a| a.named.clone()).collect();
    let named_section = section("coordinates");
    let named = coordinates(&actuators, named_section.as_ref(), &bodies, &joints);
    let magnitudes = Magnitudes::new(&named);
    let assembly_section = section("assembly");
    let mut assembly = assembly(assembly_section.as_ref(), &bodies, &actuators);
    let ground = bodies.ground.unwrap_or_default();
    let can_start_at_rest = is_filled(fields, "loads") || is_filled(fields, "drives");
    let motion_section = section("motion");
    let mut motion =
        (motion_section.as_ref()).map(|f| ParsedMotion::read(f, &by_name, can_start_at_rest));
    let initial = motion.as_ref().map_or(&[][..], |m| &m.initial_coordinates);
    let start = starting_coordinates(
        &mut assembly.q,
        initial,
        &by_name,
        assembly_section.as_ref(),
    );
    let mut events = Vec::new();
    if let (Some(motion), Some(f)) = (&mut motion, &motion_section) {
        motion.read_laws(&by_name, &start);
        let section = f.get("events");
        let section = section.and_then(|e| TableReader::open(e, "events of [motion]"));
        let reader = EventReader {
            coordinates: &named,
            reaction: &|text, at, fields| one_reaction(text, at, fields, &joints, ground),
        };
        events = section.map_or_else(Vec::new, |f| reader.events(&f));
    }
    let prescribed = section("prescribed");
    let prescribed = prescribed.and_then(|f| prescribed_motion(&f, &by_name, &start));
    let sweep = section("coordinate-sweep");
    let sweep = sweep.and_then(|f| coordinate_sweep(&f, &by_name, &start));
    let reader = SpaceLoads {
        bodies: &bodies,
        joints: &joints,
        magnitudes: &magnitudes,
    };
    let load_fields = section("loads");
    let mut loads = load_fields
        .as_ref()
        .map_or_else(Vec::new, |f| reader.loads(f));
    if let Some(f) = section("friction") {
        add_friction(&f, &joints, &mut loads);
    }
    let reader = DriveReader {
        coordinates: &named,
        magnitudes: &magnitudes,
    };
    let drive_fields = section("drives");
    reject_shared_names(&drive_fields, &load_fields);
    let drives = drive_fields.map_or_else(Vec::new, |f| reader.drives(&f, loads.len()));
    if let Some(motion) = &motion {
        let coordinates = named.list[..named.actuators].iter().map(|c| c.coordinate);
        let actuators = by_name.iter().zip(coordinates);
        reject_drives_of_prescribed(&drives, motion, actuators, |a, b| a == b);
    }
    let stops = section("stops");
    let stops = stops.map_or_else(Vec::new, |f| stops_of(&f, &by_name, motion.as_ref()));
    let requested = section("requests");
    let requested = requested.map(|f| requests(&f, &bodies, &joints, ground));
    let SpaceRequests {
        reactions: listed,
        paths,
        variables,
    } = requested.unwrap_or_default();
    let joined = || joints.list.iter().filter_map(|j| j.joint.as_ref());
    // A joint that could not be read may be the one that holds a body.
    if !joints.list.is_empty() && joined().count() == joints.list.len() {
        report_unjoined_bodies(&bodies, joined().flat_map(|j| j.bodies), log);
    }
    if log.count() > 0 {
        return None;
    }
    let ground = bodies.ground?;
    let joints: Vec<Joint> = joints.list.into_iter().filter_map(|j| j.joint).collect();
    let all = joints.iter().enumerate().flat_map(|(j, joint)| {
        let reaction = move |component| Reaction {
            joint: JointId(j),
            component,
        };
        in_ground_axes(joint, ground).into_iter().map(reaction)
    });
    Some(SpaceScene {
        lists_reactions: listed.is_some(),
        paths,
        variables,
        reactions: listed.unwrap_or_else(|| all.collect()),
        masses: bodies.list.iter().map(|b| b.mass).collect(),
        points: bodies.named_points(),
        mechanism: Mechanism {
            bodies: bodies.list.iter().map(|b| Body::named(b.name)).collect(),
            ground,
            actuators: actuators
                .into_iter()
                .filter_map(|a: ParsedActuator<'_>| a.actuator)
                .collect(),
            joints,
        },
        coordinates: named.of_section(),
        prescribed,
        sweep,
        motion: motion.and_then(|m| m.into_spec(&start, events)),
        drives: drives.into_iter().map(|(drive, _)| drive).collect(),
        stops,
        assembly,
        loads,
        file: SceneFile::new(
            (name, source),
            (title.map(one_line), note.map(printable)),
            fields,
            body_numbers,
        ),
    })
}

/// The coordinates where a motion starts: those of `[assembly]`, or of `[motion]` for an actuator that is not there. Then the mechanism
/// is assembled there, too.
fn starting_coordinates(
    assembly: &mut [f64],
    initial: &[Option<f64>],
    actuators: &[NamedActuator<'_>],
    fields: Option<&TableReader<'_>>,
) -> Vec<f64> {
    for ((at, initial), actuator) in assembly.iter_mut().zip(initial).zip(actuators) {
        let mut given = fields.iter().flat_map(|f| &f.entries);
        let is_given = given.any(|entry| entry.name == actuator.name);
        if let (false, Some(initial)) = (is_given, initial) {
            *at = *initial;
        }
    }
    assembly.to_vec()
}

/// Sections of scenes in the plane that those in space do not have yet are named as such.
fn reject_unknown_sections(fields: &TableReader<'_>) {
    let planar = table("scene");
    for entry in fields.unknown_entries(table("scene-in-space")) {
        if planar.contains_key(entry.name) {
            let message = format!("a scene in space has no `[{}]` yet", entry.name);
            let help = match entry.name {
                "calibration" => {
                    "leave it out: `dwell calibrate --parameter rod.mass --period 5.42` does it"
                }
                _ => "its points have three numbers; leave this section out",
            };
            entry.reject::<()>(message, "for scenes in the plane", help);
        } else {
            fields.report_unknown_key(entry, "keys here", table("scene-in-space").names());
        }
    }
}
