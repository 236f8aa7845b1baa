//! Reads the sections of the file, each after those to which it refers.

use crate::assembly::{AssemblyNotation, ParsedAssembly};
use crate::bodies::Bodies;
use crate::coordinates::{NamedActuator, ParsedActuator, ParsedCoordinates, Parts, actuators};
use crate::diagnostics::Diagnostics;
use crate::drives::{DriveReader, reject_drives_of_prescribed, reject_shared_names};
use crate::error::{SceneError, Source};
use crate::events::EventReader;
use crate::file::{SceneFile, Searches};
use crate::magnitude::Magnitudes;
use crate::motion::{ParsedMotion, calibration};
use crate::number_paths::{body_numbers, section_numbers};
use crate::optimise::optimise_section;
use crate::points::{planar_only, three_numbers};
use crate::prescribed::{coordinate_sweep, prescribed_motion};
use crate::read::{named_text, syntax, text_of_file};
use crate::requests::{ReactionNotation, one_reaction, requests};
use crate::scene_data::SceneIn;
use crate::sections::{
    needed_section, one_line, place_sections, printable, read_root, reject_other_keys,
    report_unjoined_bodies, section, text_of, title,
};
use crate::stops::stops as stops_of;
use crate::suspicious_numbers::Doubtful;
use crate::swept::sweep_section;
use crate::table_reader::TableReader;
use dwell_geometry::{Body, BodyId};
use dwell_kinetostatics::Load;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// How the sections of a scene are read in the plane or in space.
pub(crate) trait Sections: AssemblyNotation + ReactionNotation + Doubtful {
    /// The joints of a section; those that refer to coordinates by their names alone.
    fn joints<'a>(
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_, Self>,
        log: &'a Diagnostics,
    ) -> Self::Joints<'a>;

    /// Reads and checks the parts of joints that refer to coordinates or actuators. Returns the bodies of each joint; `None` for a
    /// joint that could not be read.
    fn complete_joints(
        joints: &mut Self::Joints<'_>,
        actuators: &[ParsedActuator<'_, Self>],
        coordinates: &ParsedCoordinates<'_, Self::Coordinate>,
    ) -> Vec<Option<[BodyId; 2]>>;

    /// Checks bodies by the joints that hold them.
    fn check_bodies(_: &Parts<'_, '_, Self>) {}

    /// The loads of a section, then those of another that has the friction in joints, then those that follow from joints.
    fn loads(
        loads: Option<&TableReader<'_>>,
        friction: Option<&TableReader<'_>>,
        parts: &Parts<'_, '_, Self>,
        magnitudes: &Magnitudes<Self::Coordinate>,
    ) -> Vec<Load<Self::LoadKind, Self::Coordinate>>;

    /// The assembly, with its coordinates.
    fn assembly(
        parsed: ParsedAssembly<Self>,
        start: &[f64],
        joints: &Self::Joints<'_>,
    ) -> Self::Assembly;

    /// The mechanism; `bodies` are named.
    fn mechanism(
        bodies: Vec<Body>,
        ground: usize,
        joints: Self::Joints<'_>,
        actuators: Vec<Self::Actuator>,
        assembly: &Self::Assembly,
    ) -> Self::Mechanism;

    /// The default reactions: all of them.
    fn all_reactions(mechanism: &Self::Mechanism) -> Vec<Self::Reaction>;

    /// The actuators with their coordinates.
    fn driven_coordinates(
        mechanism: &Self::Mechanism,
    ) -> impl Iterator<Item = (&str, Self::Coordinate)> + Clone;
}

#[expect(private_bounds, reason = "there are two kinds of scene")]
impl<D: Sections> SceneIn<D> {
    /// Reads a scene from a file.
    ///
    /// # Errors
    /// [`SceneError`] when the file cannot be read, or is not a scene of this kind.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let (name, source) = text_of_file(path.as_ref())?;
        Self::build(name, &source)
    }

    /// Reads the text of a scene. `source_name` is the file's name in messages.
    ///
    /// # Errors
    /// [`SceneError`] when it is not a scene of this kind.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, SceneError> {
        let (name, source) = named_text(source_name, text);
        Self::build(name, &source)
    }

    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let root = syntax(source)?;
        if let (true, Some(point)) = (D::SUFFIX.is_empty(), three_numbers(root.get_ref())) {
            return Err(planar_only(source, point));
        }
        Self::of_root(name, source, root.get_ref())
    }

    /// The scene of a text that is parsed.
    pub(crate) fn of_root(
        name: String,
        source: &Source,
        root: &DeTable<'_>,
    ) -> Result<Self, SceneError> {
        let log = &Diagnostics::new(source);
        read_root(root, log, |fields| read(name, source, fields)).map(D::with_doubts)
    }

    /// The coordinate of that name: an actuator's, or one of `[coordinates]`.
    pub fn coordinate(&self, name: &str) -> Option<D::Coordinate> {
        let mut named = self.all_coordinates();
        named.find(|(n, _)| *n == name).map(|(_, c)| c)
    }

    /// The name of a coordinate: an actuator's, or one of `[coordinates]`; empty if it has none.
    pub fn name_of(&self, coordinate: D::Coordinate) -> String {
        let mut named = self.all_coordinates();
        let found = named.find(|(_, c)| *c == coordinate);
        found.map_or_else(String::new, |(name, _)| name.to_owned())
    }

    /// Every coordinate that has a name, those of the actuators first.
    pub fn all_coordinates(&self) -> impl Iterator<Item = (&str, D::Coordinate)> + Clone {
        let named = self.coordinates.iter();
        let named = named.map(|c| (c.name.as_str(), c.coordinate));
        D::driven_coordinates(&self.mechanism).chain(named)
    }
}

/// The byte order mark that some editors write before the first character of a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Reports a file without anything in it.
fn reject_empty(source: &Source, fields: &TableReader<'_>) -> Option<()> {
    if !fields.entries.is_empty() {
        return Some(());
    }
    let blank = |c: char| c.is_whitespace() || c == BYTE_ORDER_MARK;
    let message = if source.inner().trim_matches(blank).is_empty() {
        "the scene is empty"
    } else {
        "the scene has nothing but comments"
    };
    let help = "a scene has at least [bodies] and [joints]";
    let labels = [(&(0..0), "no bodies, no joints")];
    fields.log().reject(message, &labels, help)
}

/// The scene; none if anything was found wrong.
//
// Long: one section after another, in an order in which each finds the names it refers to.
fn read<D: Sections>(
    name: String,
    source: &Source,
    fields: &TableReader<'_>,
) -> Option<SceneIn<D>> {
    let log = fields.log();
    reject_empty(source, fields)?;
    reject_other_keys::<D>(fields, "scene", |key| {
        let help = match key {
            "calibration" => {
                "leave it out: `dwell calibrate --parameter rod.mass --period 5.42` does it"
            }
            _ => "its points have three numbers; leave this section out",
        };
        (format!("`[{key}]` yet"), help)
    });
    place_sections(fields);
    let section = |key| section(fields, key);
    let (title, note) = (title(fields), text_of(fields, "note"));
    // Without bodies every other name would be unknown: one message is enough.
    let bodies_section = needed_section(fields, "bodies")?;
    let count = log.count();
    let bodies: Bodies<'_, D> = Bodies::read(&bodies_section);
    let body_numbers = body_numbers(&bodies, &bodies_section);
    let known_numbers = (log.count() == count).then_some(body_numbers.as_slice());
    let joints_section = needed_section(fields, "joints");
    let mut joints = D::joints(joints_section.as_ref(), &bodies, log);
    let parts = &Parts {
        bodies: &bodies,
        joints: &joints,
    };
    let actuators = section("actuators").map_or_else(Vec::new, |f| actuators(&f, parts));
    let by_name: Vec<NamedActuator<'_>> = actuators.iter().map(|a| a.named.clone()).collect();
    let named_section = section("coordinates");
    let named = ParsedCoordinates::read(&actuators, named_section.as_ref(), parts, log);
    let joined = D::complete_joints(&mut joints, &actuators, &named);
    let parts = &Parts {
        bodies: &bodies,
        joints: &joints,
    };
    // A joint that could not be read may be the one that holds a body.
    let joined: Option<Vec<_>> = joined.into_iter().collect();
    if let Some(joined) = joined.filter(|joined| !joined.is_empty()) {
        report_unjoined_bodies(&bodies, joined.into_iter().flatten(), log);
    }
    D::check_bodies(parts);
    let magnitudes = Magnitudes::new(&named);
    let assembly_section = section("assembly");
    let assembly = ParsedAssembly::read(assembly_section.as_ref(), parts, &actuators);
    let motion_section = section("motion");
    let can_start_at_rest = is_filled(fields, "loads") || is_filled(fields, "drives");
    let motion = motion_section.as_ref();
    let mut motion = motion.map(|f| ParsedMotion::read(f, &by_name, can_start_at_rest));
    let initial = motion.as_ref().map_or(&[][..], |m| &m.initial_coordinates);
    let at = assembly_section.as_ref();
    let start = assembly.coordinates_or(initial, parts, &actuators, at);
    let mut events = Vec::new();
    if let (Some(motion), Some(f)) = (&mut motion, &motion_section) {
        motion.read_laws(&by_name, &start);
        let section = f.get("events");
        let section = section.and_then(|e| TableReader::open(e, "events of [motion]"));
        let reader = EventReader {
            coordinates: &named,
            reaction: &|text, at, fields| one_reaction(text, at, fields, parts),
        };
        events = section.map_or_else(Vec::new, |f| reader.events(&f));
    }
    let prescribed = section("prescribed").and_then(|f| prescribed_motion(&f, &by_name, &start));
    let sweep = section("coordinate-sweep").and_then(|f| coordinate_sweep(&f, &by_name, &start));
    let load_section = section("loads");
    let friction = section("friction");
    let loads = D::loads(load_section.as_ref(), friction.as_ref(), parts, &magnitudes);
    let reader = DriveReader {
        coordinates: &named,
        magnitudes: &magnitudes,
    };
    let drive_section = section("drives");
    reject_shared_names(&drive_section, &load_section);
    let drives = drive_section.map_or_else(Vec::new, |f| reader.drives(&f, loads.len()));
    if let Some(motion) = &motion {
        let coordinates = actuators.iter().map(|a| a.coordinate);
        reject_drives_of_prescribed(&drives, motion, by_name.iter().zip(coordinates));
    }
    let stops = section("stops").map_or_else(Vec::new, |f| stops_of(&f, &by_name, motion.as_ref()));
    let requested = section("requests").map(|f| requests(&f, parts));
    let is_calibrated = D::table("scene").contains_key("calibration");
    let calibration_section = is_calibrated.then(|| section("calibration")).flatten();
    let calibration = calibration_section.and_then(|f| {
        if fields.get("motion").is_none() {
            let labels = [(&f.span, "no free motion has a period")];
            let help = "add [motion], to whose period the number is fitted";
            log.report("a calibration needs a motion", &labels, help);
        }
        calibration(&f, known_numbers)
    });
    let section_numbers = section_numbers(fields);
    let numbers: Vec<_> = body_numbers.iter().chain(&section_numbers).collect();
    let swept = section("sweep").map(|f| sweep_section(&f, &numbers));
    let jobs = section("optimise").map(|f| optimise_section(&f, &numbers));
    if log.count() > 0 {
        return None;
    }
    let assembly = D::assembly(assembly, &start, &joints);
    let mechanism = D::mechanism(
        bodies.list.iter().map(|b| Body::named(b.name)).collect(),
        bodies.ground?,
        joints,
        actuators.into_iter().filter_map(|a| a.actuator).collect(),
        &assembly,
    );
    let mut requests = requested.unwrap_or_default();
    if !requests.lists_reactions {
        requests.reactions = D::all_reactions(&mechanism);
    }
    Some(SceneIn {
        file: SceneFile::new(
            name,
            source,
            title.map(one_line),
            note.map(printable),
            fields,
            [body_numbers, section_numbers],
            Searches {
                sweep: swept.unwrap_or_default(),
                jobs: jobs.unwrap_or_default(),
            },
        ),
        masses: bodies.list.iter().map(|b| b.mass).collect(),
        points: bodies.named_points(),
        varying_inertias: bodies.varying_inertias(),
        coordinates: named.of_section(),
        motion: motion.and_then(|m| m.into_spec(&start, events)),
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

/// Whether a section has entries. Its errors are reported when it is read.
fn is_filled(fields: &TableReader<'_>, key: &str) -> bool {
    let value = fields.get(key).map(|e| e.value.get());
    matches!(value, Some(DeValue::Table(table)) if !table.is_empty())
}
