//! The sections of the file, read in an order in which each finds what it refers to.

mod into_scene;

use crate::assembly::ParsedAssembly;
use crate::bodies::Bodies;
use crate::coordinates::{ParsedActuator, ParsedCoordinates, actuators};
use crate::diagnostics::{Diagnostics, Span};
use crate::drives::{DriveReader, ParsedDrive, reject_drives_of_prescribed};
use crate::error::{SceneError, Source};
use crate::events::EventReader;
use crate::former_keys::rename_former_keys;
use crate::friction::friction;
use crate::joints::Joints;
use crate::keys::table;
use crate::loads::{LoadReader, ParsedLoad, separating_forces};
use crate::magnitude::Magnitudes;
use crate::motion::{ParsedMotion, calibration};
use crate::prescribed::{ParsedPrescribedMotion, ParsedSweep};
use crate::requests::ParsedRequests;
use crate::scene::{Calibration, Scene};
use crate::section_numbers::section_numbers;
use crate::table_reader::TableReader;
use crate::units::Units;
use crate::value::Context;
use crate::wording::shorten;
use toml::de::DeValue;

impl Scene {
    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let text = source.inner();
        let mut root = crate::read::syntax(source)?;
        let log = &Diagnostics::new(source);
        rename_former_keys(root.get_mut(), table("scene"), log);
        let fields = |units| {
            let context = Context { units, log };
            TableReader::new("the scene", (0..0, 0..0), root.get_ref(), context)
        };
        let si = Units::default();
        let units = Units::read(fields(&si).get("units"));
        let fields = fields(&units);
        let parsed = ParsedScene::read(text, &fields);
        if let Some(error) = log.to_error() {
            return Err(error);
        }
        // Parts are missing only where something was found wrong.
        let incomplete = || SceneError::without_labels("the scene is incomplete".to_owned(), None);
        let mut scene = parsed
            .ok_or_else(incomplete)?
            .into_scene(name, Source::clone(source));
        scene.warnings = log.warnings();
        scene.section_numbers = section_numbers(text, root.get_ref());
        Ok(scene)
    }
}

/// The sections of a file as read.
struct ParsedScene<'f, 'a> {
    fields: &'f TableReader<'a>,
    title: Option<&'a str>,
    note: Option<&'a str>,
    bodies: Bodies<'a>,
    joints: Joints<'a>,
    actuators: Vec<ParsedActuator<'a>>,
    named_coordinates: ParsedCoordinates<'a>,
    assembly: ParsedAssembly,
    /// Coordinate of each actuator at assembly, SI.
    assembly_coordinates: Vec<f64>,
    prescribed: Option<ParsedPrescribedMotion>,
    sweep: Option<ParsedSweep>,
    loads: Vec<ParsedLoad>,
    drives: Vec<ParsedDrive>,
    requests: ParsedRequests,
    motion: Option<ParsedMotion<'a>>,
    calibration: Option<(Calibration, Span)>,
}

/// Longest title, in characters: it heads a page and a picture.
const MAX_TITLE_LENGTH: usize = 200;

/// What some editors put before the first character of a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

impl<'f, 'a> ParsedScene<'f, 'a> {
    // Long: one section after another, in an order in which each finds the names it refers to.
    fn read(text: &str, fields: &'f TableReader<'a>) -> Option<Self> {
        if fields.entries.is_empty() {
            let blank = |c: char| c.is_whitespace() || c == BYTE_ORDER_MARK;
            let message = match text.trim_matches(blank).is_empty() {
                true => "the scene is empty",
                false => "the scene has nothing but comments",
            };
            let diagnostic = fields.error(message).label(&(0..0), "no bodies, no joints");
            return diagnostic
                .help("a scene has at least [bodies] and [joints]")
                .reject();
        }
        fields.reject_unknown_keys(table("scene"));
        let section = |key| section(fields, key);
        let log = fields.log();
        let (title, note) = (title(fields), text_of(fields, "note"));
        // Without bodies every other name would be unknown: one message is enough.
        let bodies = needed_section(fields, "bodies")?;
        let count = log.count();
        let bodies = Bodies::read(&bodies);
        let all_bodies_read = log.count() == count;
        let mut joints = Joints::new(log);
        if let Some(f) = needed_section(fields, "joints") {
            joints = joints.read(&f, &bodies);
        }
        let actuators =
            section("actuators").map_or_else(Vec::new, |f| actuators(&f, &bodies, &joints));
        let coordinates = section("coordinates");
        let named_coordinates =
            ParsedCoordinates::read(&actuators, coordinates.as_ref(), &bodies, &joints);
        joints.read_couplings(&named_coordinates);
        // A joint that could not be read may be the one that holds a body.
        if !joints.list.is_empty() && joints.list.iter().all(|j| j.joint.is_some()) {
            report_unjoined_bodies(&bodies, &joints);
        }
        let assembly_section = section("assembly");
        let assembly =
            ParsedAssembly::read(assembly_section.as_ref(), &bodies, &joints, &actuators);
        let motion_section = section("motion");
        let can_start_at_rest = is_filled(fields, "loads") || is_filled(fields, "drives");
        let mut motion = motion_section
            .as_ref()
            .map(|f| ParsedMotion::read(f, &actuators, can_start_at_rest));
        let initial = motion.as_ref().map_or(&[][..], |m| &m.initial_coordinates);
        let at = assembly_section.as_ref().map(|f| &f.span);
        let assembly_coordinates = assembly.coordinates_or(initial, &actuators, at, log);
        if let (Some(motion), Some(f)) = (&mut motion, &motion_section) {
            motion.read_laws(&actuators, &assembly_coordinates);
            let events = f
                .get("events")
                .and_then(|e| TableReader::open(e, "events of [motion]"));
            let (joints, named_coordinates) = (&joints, &named_coordinates);
            let reader = EventReader {
                named_coordinates,
                joints,
            };
            motion.events = events.map_or_else(Vec::new, |f| reader.read(&f));
        }
        let prescribed = section("prescribed")
            .map(|f| ParsedPrescribedMotion::read(&f, &actuators, &assembly_coordinates));
        let sweep = section("coordinate-sweep")
            .map(|f| ParsedSweep::read(&f, &actuators, &assembly_coordinates));
        let magnitudes = &Magnitudes::new(&named_coordinates);
        let reader = LoadReader {
            bodies: &bodies,
            joints: &joints,
            magnitudes,
        };
        let mut loads = section("loads").map_or_else(Vec::new, |f| reader.read(&f));
        loads.extend(section("friction").map_or_else(Vec::new, |f| friction(&f, &joints)));
        loads.extend(separating_forces(&joints));
        let reader = DriveReader {
            named_coordinates: &named_coordinates,
            magnitudes,
        };
        let drives = section("drives").map_or_else(Vec::new, |f| reader.read(&f));
        if let Some(motion) = &motion {
            reject_drives_of_prescribed(&drives, motion, &actuators);
        }
        let requests = section("requests").map(|f| ParsedRequests::read(&f, &bodies, &joints));
        let calibration = section("calibration").and_then(|f| {
            if fields.get("motion").is_none() {
                f.error("a calibration needs a motion")
                    .label(&f.span, "no free motion has a period")
                    .help("add [motion], to whose period the number is fitted")
                    .report();
            }
            calibration(&f, all_bodies_read.then_some(&bodies))
        });
        Some(Self {
            fields,
            title,
            note,
            bodies,
            joints,
            actuators,
            named_coordinates,
            assembly,
            assembly_coordinates,
            prescribed,
            sweep,
            loads,
            drives,
            requests: requests.unwrap_or_default(),
            motion,
            calibration,
        })
    }
}

/// The table of a section.
fn section<'a>(fields: &TableReader<'a>, key: &str) -> Option<TableReader<'a>> {
    TableReader::open(fields.get(key)?, format!("[{key}]"))
}

/// The table of a section that has to be there, and not empty.
fn needed_section<'a>(fields: &TableReader<'a>, key: &str) -> Option<TableReader<'a>> {
    let missing = |span: &Span, label: String| {
        let help = match key {
            "bodies" => "describe the bodies: `[bodies.crank]` with `points = { A = [0, 0] }`",
            _ => "connect the bodies: `A = { revolute = [\"ground.A\", \"crank.A\"] }`",
        };
        let diagnostic = fields.error(format!("the scene has no {key}"));
        diagnostic.label(span, label).help(help).reject()
    };
    match fields.get(key) {
        None => missing(&(0..0), format!("there is no [{key}] in this file")),
        Some(entry) => match section(fields, key)? {
            table if table.entries.is_empty() => missing(&entry.key, "nothing in it".to_owned()),
            table => Some(table),
        },
    }
}

/// Whether there is something in a section; what is wrong with it is reported where it is read.
fn is_filled(fields: &TableReader<'_>, key: &str) -> bool {
    let value = fields.get(key).map(|e| e.value.get());
    matches!(value, Some(DeValue::Table(table)) if !table.is_empty())
}

fn title<'a>(fields: &TableReader<'a>) -> Option<&'a str> {
    let (title, entry) = (text_of(fields, "title")?, fields.get("title")?);
    if title.chars().count() > MAX_TITLE_LENGTH {
        entry
            .error(format!(
                "the title is longer than {MAX_TITLE_LENGTH} characters"
            ))
            .label(&entry.key, "this text")
            .help("a title is a line at the head of a page; the rest can go into `note`")
            .report();
    }
    Some(title)
}

/// A text shown to people; blank it is as good as absent.
fn text_of<'a>(fields: &TableReader<'a>, key: &str) -> Option<&'a str> {
    let text = fields
        .get(key)?
        .value
        .string(format_args!("the {key}"))?
        .trim();
    (!text.is_empty()).then_some(text)
}

/// Reports the bodies that no joint holds.
fn report_unjoined_bodies(bodies: &Bodies<'_>, joints: &Joints<'_>) {
    let mut joined = vec![false; bodies.list.len()];
    for joint in joints.list.iter().filter_map(|j| j.joint.as_ref()) {
        for body in joint.bodies {
            joined[body.0] = true;
        }
    }
    for (body, _) in bodies.list.iter().zip(joined).filter(|(_, joined)| !joined) {
        joints
            .log
            .error(format!("body `{}` is in no joint", shorten(body.name)))
            .label(&body.key, "not connected")
            .help("join it to another body in [joints], or leave it out")
            .report();
    }
}
