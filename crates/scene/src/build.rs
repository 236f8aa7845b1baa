//! The sections of the file, read in an order in which each finds what it refers to.

use crate::assembly::ParsedAssembly;
use crate::bodies::Bodies;
use crate::coordinates::{NamedActuator, ParsedCoordinates, actuators, is_same};
use crate::diagnostics::Diagnostics;
use crate::drives::{DriveReader, reject_drives_of_prescribed, reject_shared_names};
use crate::error::{SceneError, Source};
use crate::events::EventReader;
use crate::file::SceneFile;
use crate::friction::add_friction;
use crate::joints::Joints;
use crate::keys::table;
use crate::loads::add_separating_forces;
use crate::magnitude::{Magnitudes, Names};
use crate::motion::{ParsedMotion, calibration};
use crate::number_paths::body_numbers;
use crate::plane_scene::{Assembly, PlaneScene};
use crate::prescribed::{coordinate_sweep, prescribed_motion};
use crate::requests::requests;
use crate::sections::{
    needed_section, one_line, place_sections, printable, read_root, report_unjoined_bodies,
    section, text_of, title,
};
use crate::space::{planar_only, three_numbers};
use crate::stops::stops as stops_of;
use crate::table_reader::TableReader;
use crate::wording::shorten;
use dwell_geometry::{Body, Joint, JointKind, Mechanism};
use dwell_kinetostatics::VaryingInertia;
use toml::de::DeValue;

impl PlaneScene {
    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let root = crate::read::syntax(source)?;
        let log = &Diagnostics::new(source);
        if let Some(point) = three_numbers(root.get_ref()) {
            return Err(planar_only(source, point));
        }
        read_root(root.get_ref(), log, |fields| read(name, source, fields)).map(Self::with_doubts)
    }
}

/// What some editors put before the first character of a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The scene; none if anything was found wrong.
//
// Long: one section after another, in an order in which each finds the names it refers to.
fn read(name: String, source: &Source, fields: &TableReader<'_>) -> Option<PlaneScene> {
    let log = fields.log();
    if fields.entries.is_empty() {
        let blank = |c: char| c.is_whitespace() || c == BYTE_ORDER_MARK;
        let message = match source.inner().trim_matches(blank).is_empty() {
            true => "the scene is empty",
            false => "the scene has nothing but comments",
        };
        let help = "a scene has at least [bodies] and [joints]";
        return log.reject(message, &[(&(0..0), "no bodies, no joints")], help);
    }
    fields.reject_unknown_keys(table("scene"));
    place_sections(fields);
    let section = |key| section(fields, key);
    let (title, note) = (title(fields), text_of(fields, "note"));
    // Without bodies every other name would be unknown: one message is enough.
    let bodies_section = needed_section(fields, "bodies")?;
    let count = log.count();
    let bodies = Bodies::read(&bodies_section);
    let body_numbers = body_numbers(&bodies, &bodies_section);
    let known_numbers = (log.count() == count).then_some(body_numbers.as_slice());
    let mut joints = Joints::new(log);
    if let Some(f) = needed_section(fields, "joints") {
        joints = joints.read(&f, &bodies);
    }
    let actuators = section("actuators").map_or_else(Vec::new, |f| actuators(&f, &bodies, &joints));
    let by_name: Vec<NamedActuator<'_>> = actuators.iter().map(|a| a.named.clone()).collect();
    let named_section = section("coordinates");
    let named = ParsedCoordinates::read(&actuators, named_section.as_ref(), &bodies, &joints);
    joints.read_couplings(&named);
    // A joint that could not be read may be the one that holds a body.
    if !joints.list.is_empty() && joints.list.iter().all(|j| j.joint.is_some()) {
        let joined = joints.list.iter().filter_map(|j| j.joint.as_ref());
        report_unjoined_bodies(&bodies, joined.flat_map(|j| j.bodies), log);
    }
    let varying_inertias = bodies.list.iter().filter_map(|b| b.varying_inertia.clone());
    let varying_inertias: Vec<_> = varying_inertias.collect();
    check_varying_inertias(&varying_inertias, &bodies, &joints);
    let names = Names {
        bodies: &bodies,
        joints: &joints,
        magnitudes: Magnitudes::new(&named),
    };
    let assembly_section = section("assembly");
    let assembly = ParsedAssembly::read(assembly_section.as_ref(), &bodies, &joints, &actuators);
    let motion_section = section("motion");
    let can_start_at_rest = is_filled(fields, "loads") || is_filled(fields, "drives");
    let motion = motion_section.as_ref();
    let mut motion = motion.map(|f| ParsedMotion::read(f, &by_name, can_start_at_rest));
    let initial = motion.as_ref().map_or(&[][..], |m| &m.initial_coordinates);
    let at = assembly_section.as_ref().map(|f| &f.span);
    let start = assembly.coordinates_or(initial, (&bodies, &joints), &actuators, at);
    let mut events = Vec::new();
    if let (Some(motion), Some(f)) = (&mut motion, &motion_section) {
        motion.read_laws(&by_name, &start);
        let section = f.get("events");
        let section = section.and_then(|e| TableReader::open(e, "events of [motion]"));
        let reader = EventReader {
            coordinates: &named,
            reaction: &|text, at, fields| names.one_reaction(text, at, fields),
        };
        events = section.map_or_else(Vec::new, |f| reader.events(&f));
    }
    let prescribed = section("prescribed");
    let prescribed = prescribed.and_then(|f| prescribed_motion(&f, &by_name, &start));
    let sweep = section("coordinate-sweep");
    let sweep = sweep.and_then(|f| coordinate_sweep(&f, &by_name, &start));
    let load_fields = section("loads");
    let mut loads = load_fields
        .as_ref()
        .map_or_else(Vec::new, |f| names.loads(f));
    if let Some(f) = section("friction") {
        add_friction(&f, &joints, &mut loads);
    }
    add_separating_forces(&joints, &mut loads);
    let reader = DriveReader {
        coordinates: &named,
        magnitudes: &names.magnitudes,
    };
    let drive_fields = section("drives");
    reject_shared_names(&drive_fields, &load_fields);
    let drives = drive_fields.map_or_else(Vec::new, |f| reader.drives(&f, loads.len()));
    if let Some(motion) = &motion {
        let coordinates = named.list[..named.actuators].iter().map(|c| c.coordinate);
        reject_drives_of_prescribed(&drives, motion, by_name.iter().zip(coordinates), is_same);
    }
    let stops = section("stops");
    let stops = stops.map_or_else(Vec::new, |f| stops_of(&f, &by_name, motion.as_ref()));
    let requests_section = section("requests");
    let requested = requests_section.as_ref();
    let requested = requested.map(|f| requests(f, &bodies, &joints));
    let calibration = section("calibration").and_then(|f| {
        if fields.get("motion").is_none() {
            let labels = [(&f.span, "no free motion has a period")];
            let help = "add [motion], to whose period the number is fitted";
            log.report("a calibration needs a motion", &labels, help);
        }
        calibration(&f, known_numbers)
    });
    if log.count() > 0 {
        return None;
    }
    let mut mechanism = Mechanism {
        bodies: bodies.list.iter().map(|b| Body::named(b.name)).collect(),
        ground: bodies.ground?,
        joints: joints.list.into_iter().filter_map(|j| j.joint).collect(),
        actuators: actuators.into_iter().filter_map(|a| a.actuator).collect(),
        couplings: joints.couplings,
    };
    let assembly = Assembly {
        coordinates: start,
        initial_guess: assembly.initial_guess,
        branch_hints: assembly.branch_hints,
    };
    mechanism.mesh_as_given(&assembly.to_configuration());
    let mut requests = requested.unwrap_or_default();
    if !requests.lists_reactions {
        requests.reactions = mechanism.reactions();
    }
    Some(PlaneScene {
        file: SceneFile::new(
            (name, source),
            (title.map(one_line), note.map(printable)),
            fields,
            body_numbers,
        ),
        masses: bodies.list.iter().map(|b| b.mass).collect(),
        varying_inertias,
        points: bodies.named_points(),
        coordinates: named.of_section(),
        motion: motion.and_then(|m| m.into_spec(&assembly.coordinates, events)),
        mechanism,
        assembly,
        prescribed,
        sweep,
        loads,
        drives: drives.into_iter().map(|(drive, _)| drive).collect(),
        stops,
        requests,
        calibration,
    })
}

/// Whether there is something in a section; what is wrong with it is reported where it is read.
pub(crate) fn is_filled(fields: &TableReader<'_>, key: &str) -> bool {
    let value = fields.get(key).map(|e| e.value.get());
    matches!(value, Some(DeValue::Table(table)) if !table.is_empty())
}

/// Reports bodies that no revolute joint holds on the ground, and reactions whose names are those of joints.
fn check_varying_inertias(varying: &[VaryingInertia], bodies: &Bodies<'_>, joints: &Joints<'_>) {
    for one in varying {
        let (body, ground) = (&bodies.list[one.body.0], bodies.ground);
        let is_pivot = |joint: &Joint| {
            matches!(joint.kind, JointKind::Revolute)
                && joint.bodies.contains(&one.body)
                && joint.bodies.iter().any(|b| Some(b.0) == ground)
        };
        let mut read = joints.list.iter().filter_map(|j| j.joint.as_ref());
        if !read.any(is_pivot) {
            let message = format!(
                "no revolute joint holds body `{}`, whose inertia varies, on the ground",
                shorten(body.name)
            );
            let help = "its inertia is a function of its angle from the ground: add `A = { revolute = [\"ground.A\", \"…\"] }`";
            joints
                .log
                .report(message, &[(&body.key, "turns about no fixed point")], help);
        }
        for reaction in &one.reactions {
            let first = reaction.name.split('.').next().unwrap_or_default();
            if joints.list.iter().any(|joint| joint.name == first) {
                let message = format!(
                    "reaction `{}` of a varying inertia has the name of a joint",
                    shorten(&reaction.name)
                );
                let help = "rename the reaction, or the joint";
                joints
                    .log
                    .report(message, &[(&body.key, "in this body")], help);
            }
        }
    }
}
