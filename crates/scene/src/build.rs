//! The sections of the file, read in an order in which each finds what it refers to.

mod into_scene;

use crate::assembly::ParsedAssembly;
use crate::bodies::Bodies;
use crate::coordinates::{ParsedActuator, ParsedCoordinates, actuators};
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::drives::{DriveReader, ParsedDrive, reject_drives_of_prescribed};
use crate::error::{SceneError, Source};
use crate::events::EventReader;
use crate::former_keys::rename_former_keys;
use crate::friction::friction;
use crate::joints::Joints;
use crate::keys::table;
use crate::loads::{LoadReader, ParsedLoad};
use crate::magnitude::Magnitudes;
use crate::motion::{ParsedMotion, calibration};
use crate::prescribed::{ParsedPrescribedMotion, ParsedSweep};
use crate::requests::ParsedRequests;
use crate::scene::{Calibration, Scene};
use crate::section_numbers::section_numbers;
use crate::table_reader::{Entry, TableReader, string};
use crate::units::Units;
use crate::wording::shorten;
use toml::de::{DeTable, DeValue};

impl Scene {
    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let text = source.inner();
        let mut root = crate::read::syntax(source)?;
        let mut diagnostics = Diagnostics::new(source);
        rename_former_keys(root.get_mut(), table("scene"), &mut diagnostics);
        let parsed = ParsedScene::read(text, root.get_ref(), &mut diagnostics);
        let warnings = diagnostics.warnings();
        match (parsed, diagnostics.into_error()) {
            (_, Some(error)) => Err(error),
            (Some(parsed), None) => {
                let mut scene = parsed.into_scene(name, Source::clone(source));
                scene.warnings = warnings;
                scene.section_numbers = section_numbers(text, root.get_ref());
                Ok(scene)
            }
            // Parts are missing only where something was found wrong.
            (None, None) => Err(SceneError::without_labels(
                "the scene is incomplete".to_owned(),
                None,
            )),
        }
    }
}

/// The sections of a file as read.
struct ParsedScene<'a> {
    title: Option<&'a str>,
    note: Option<&'a str>,
    units: Units,
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
    sections: SectionSpans,
}

/// Where the sections begin.
struct SectionSpans {
    units: Option<Span>,
    assembly: Option<Span>,
    prescribed: Option<Span>,
    sweep: Option<Span>,
    requests: Option<Span>,
    motion: Option<Span>,
}

/// Longest title, in characters: it heads a page and a picture.
const MAX_TITLE_LENGTH: usize = 200;

/// What some editors put before the first character of a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

impl<'a> ParsedScene<'a> {
    fn read(text: &str, root: &'a DeTable<'a>, diagnostics: &mut Diagnostics) -> Option<Self> {
        let fields = TableReader::new("the scene", 0..0, root);
        let blank = |c: char| c.is_whitespace() || c == BYTE_ORDER_MARK;
        if fields.entries.is_empty() {
            let message = match text.trim_matches(blank).is_empty() {
                true => "the scene is empty",
                false => "the scene has nothing but comments",
            };
            diagnostics.push(
                Diagnostic::new(message)
                    .label(0..0, "no bodies, no joints")
                    .help("a scene has at least [bodies] and [joints]"),
            );
            return None;
        }
        fields.reject_unknown_keys(table("scene"), diagnostics);
        let title = text_of(&fields, "title", diagnostics);
        if let (Some(text), Some(entry)) = (title, fields.get("title"))
            && text.chars().count() > MAX_TITLE_LENGTH
        {
            diagnostics.push(
                Diagnostic::new(format!(
                    "the title is longer than {MAX_TITLE_LENGTH} characters"
                ))
                .label(entry.key.clone(), "this text")
                .help("a title is a line at the head of a page; the rest can go into `note`"),
            );
        }
        let note = text_of(&fields, "note", diagnostics);
        let units = Units::read(fields.get("units"), diagnostics);
        // Without bodies every other name would be unknown: one message is enough.
        let bodies = section(&fields, "bodies", true, diagnostics)?;
        let count = diagnostics.count();
        let bodies = Bodies::read(&bodies, &units, diagnostics);
        let all_bodies_read = diagnostics.count() == count;
        let mut joints = section(&fields, "joints", true, diagnostics)
            .map(|f| Joints::read(&f, &bodies, &units, diagnostics))
            .unwrap_or_default();
        let actuators = section(&fields, "actuators", false, diagnostics)
            .map(|f| actuators(&f, &bodies, &joints, diagnostics))
            .unwrap_or_default();
        let coordinates = section(&fields, "coordinates", false, diagnostics);
        let named_coordinates = ParsedCoordinates::read(
            &actuators,
            coordinates.as_ref(),
            &bodies,
            &joints,
            diagnostics,
        );
        joints.read_couplings(&named_coordinates, &units, diagnostics);
        // A joint that could not be read may be the one that holds a body.
        if !joints.list.is_empty() && joints.list.iter().all(|j| j.joint.is_some()) {
            report_unjoined_bodies(&bodies, &joints, diagnostics);
        }
        let assembly = section(&fields, "assembly", false, diagnostics);
        let parsed_assembly = ParsedAssembly::read(
            assembly.as_ref(),
            &bodies,
            &joints,
            &actuators,
            &units,
            diagnostics,
        );
        let motion = section(&fields, "motion", false, diagnostics);
        let can_start_at_rest = ["loads", "drives"]
            .iter()
            .any(|key| is_filled(&fields, key));
        let mut parsed_motion = motion
            .as_ref()
            .map(|f| ParsedMotion::read(f, &actuators, can_start_at_rest, &units, diagnostics));
        let section_of = assembly.as_ref().map(|f| &f.span);
        let assembly_coordinates = assembly_coordinates(
            &parsed_assembly,
            parsed_motion.as_ref(),
            &actuators,
            section_of,
            diagnostics,
        );
        if let (Some(text), Some(f)) = (&mut parsed_motion, &motion) {
            text.read_laws(&actuators, &assembly_coordinates, &units, diagnostics);
            let events = f.get("events");
            let events =
                events.and_then(|e| TableReader::open(e, "events of [motion]", diagnostics));
            let reader = EventReader {
                named_coordinates: &named_coordinates,
                joints: &joints,
                units: &units,
            };
            text.events = events.map_or_else(Vec::new, |f| reader.read(&f, diagnostics));
        }
        let prescribed = section(&fields, "prescribed", false, diagnostics);
        let parsed_prescribed = prescribed.as_ref().map(|f| {
            ParsedPrescribedMotion::read(f, &actuators, &assembly_coordinates, &units, diagnostics)
        });
        let sweep = section(&fields, "coordinate-sweep", false, diagnostics);
        let parsed_sweep = sweep
            .as_ref()
            .map(|f| ParsedSweep::read(f, &actuators, &assembly_coordinates, &units, diagnostics));
        let magnitudes = Magnitudes::new(&named_coordinates, &units);
        let mut loads = section(&fields, "loads", false, diagnostics).map_or_else(Vec::new, |f| {
            LoadReader::new(&bodies, &joints, &units, &magnitudes).read(&f, diagnostics)
        });
        if let Some(f) = section(&fields, "friction", false, diagnostics) {
            loads.extend(friction(&f, &joints, &units, diagnostics));
        }
        loads.extend(joints.separating_forces());
        let drives = section(&fields, "drives", false, diagnostics).map_or_else(Vec::new, |f| {
            let reader = DriveReader {
                named_coordinates: &named_coordinates,
                units: &units,
                magnitudes: &magnitudes,
            };
            reader.read(&f, diagnostics)
        });
        if let Some(motion) = &parsed_motion {
            reject_drives_of_prescribed(&drives, motion, &actuators, diagnostics);
        }
        let requests = section(&fields, "requests", false, diagnostics);
        let parsed_requests = match &requests {
            Some(f) => ParsedRequests::read(f, &bodies, &joints, diagnostics),
            None => ParsedRequests::default(),
        };
        let calibration = section(&fields, "calibration", false, diagnostics).and_then(|f| {
            if fields.get("motion").is_none() {
                diagnostics.push(
                    Diagnostic::new("a calibration needs a motion")
                        .label(f.span.clone(), "no free motion has a period")
                        .help("add [motion], to whose period the number is fitted"),
                );
            }
            let (calibration, at) = calibration(&f, diagnostics)?;
            if all_bodies_read {
                bodies.check_number(&calibration.path, &at, diagnostics);
            }
            Some((calibration, at))
        });
        let span = |f: &Option<TableReader<'_>>| f.as_ref().map(|f| f.span.clone());
        Some(Self {
            title,
            note,
            sections: SectionSpans {
                units: fields.get("units").map(|e| e.value.span()),
                assembly: span(&assembly),
                prescribed: span(&prescribed),
                sweep: span(&sweep),
                requests: span(&requests),
                motion: span(&motion),
            },
            units,
            bodies,
            joints,
            actuators,
            named_coordinates,
            assembly: parsed_assembly,
            assembly_coordinates,
            prescribed: parsed_prescribed,
            sweep: parsed_sweep,
            loads,
            drives,
            requests: parsed_requests,
            motion: parsed_motion,
            calibration,
        })
    }
}

/// What is said of the k-th actuator.
fn given_value(values: &[Option<(f64, Span)>], k: usize) -> Option<f64> {
    values.get(k)?.as_ref().map(|s| s.0)
}

/// Coordinate of each actuator at assembly: as it says, or where the motion starts, or 0. No two
/// points are at 0 from each other by default: says which distances are missing.
fn assembly_coordinates(
    assembly: &ParsedAssembly,
    motion: Option<&ParsedMotion<'_>>,
    actuators: &[ParsedActuator<'_>],
    section: Option<&Span>,
    diagnostics: &mut Diagnostics,
) -> Vec<f64> {
    let initial = motion.map_or(&[][..], |m| &m.initial_coordinates);
    let mut coordinates = Vec::with_capacity(actuators.len());
    for (k, a) in actuators.iter().enumerate() {
        let coordinate = given_value(&assembly.coordinates, k).or(given_value(initial, k));
        if a.is_distance() && coordinate.is_none() && !assembly.mentioned.contains(&k) {
            let name = shorten(a.name);
            diagnostics.push(
                Diagnostic::new(format!("the length of `{name}` at the start is not given"))
                    .label(section.unwrap_or(&a.key).clone(), "no length at assembly")
                    .help(format!("add it to [assembly], such as `{name} = 0.5`")),
            );
        }
        coordinates.push(coordinate.unwrap_or(0.0));
    }
    coordinates
}

/// The table of a section. Absent it is an error where it is needed, empty as well.
fn section<'a>(
    fields: &TableReader<'a>,
    key: &str,
    needed: bool,
    diagnostics: &mut Diagnostics,
) -> Option<TableReader<'a>> {
    let missing = |span: Span, label: &str| {
        let help = match key {
            "bodies" => "describe the bodies: `[bodies.crank]` with `points = { A = [0, 0] }`",
            _ => "connect the bodies: `A = { revolute = [\"ground.A\", \"crank.A\"] }`",
        };
        Diagnostic::new(format!("the scene has no {key}"))
            .label(span, label)
            .help(help)
    };
    let Some(entry) = fields.get(key) else {
        if needed {
            diagnostics.push(missing(0..0, &format!("there is no [{key}] in this file")));
        }
        return None;
    };
    let table = TableReader::open(entry, format!("[{key}]"), diagnostics)?;
    if needed && table.entries.is_empty() {
        diagnostics.push(missing(entry.key.clone(), "nothing in it"));
        return None;
    }
    Some(table)
}

/// Whether there is something in a section; what is wrong with it is said where it is read.
fn is_filled(fields: &TableReader<'_>, key: &str) -> bool {
    let value = fields.get(key).map(|e| e.value.get_ref());
    matches!(value, Some(DeValue::Table(table)) if !table.is_empty())
}

/// A text shown to people; blank it is as good as absent.
fn text_of<'a>(
    fields: &TableReader<'a>,
    key: &str,
    diagnostics: &mut Diagnostics,
) -> Option<&'a str> {
    let entry: &Entry<'a> = fields.get(key)?;
    let text = string(entry.value, format_args!("the {key}"), diagnostics)?.trim();
    (!text.is_empty()).then_some(text)
}

/// Says which bodies no joint holds.
fn report_unjoined_bodies(bodies: &Bodies<'_>, joints: &Joints<'_>, diagnostics: &mut Diagnostics) {
    let mut joined = vec![false; bodies.list.len()];
    for joint in joints.list.iter().filter_map(|j| j.joint.as_ref()) {
        for body in joint.bodies {
            joined[body.0] = true;
        }
    }
    for (body, _) in bodies.list.iter().zip(joined).filter(|(_, joined)| !joined) {
        let name = shorten(body.name);
        diagnostics.push(
            Diagnostic::new(format!("body `{name}` is in no joint"))
                .label(body.key.clone(), "not connected")
                .help("join it to another body in [joints], or leave it out"),
        );
    }
}
