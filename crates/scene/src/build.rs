//! The sections of the file, read in an order in which each finds what it refers to.

mod finish;

use crate::assembly::AssemblyText;
use crate::bodies::Bodies;
use crate::coordinates::{ActuatorText, Measures, actuators};
use crate::drives::{DriveReader, DriveText, held};
use crate::elsewhere::elsewhere;
use crate::error::{SceneError, Source};
use crate::events::EventReader;
use crate::fields::{Entry, Fields, string};
use crate::friction::friction;
use crate::joints::Joints;
use crate::keys;
use crate::loads::{LoadReader, LoadText};
use crate::magnitude::Magnitudes;
use crate::motion::{MotionText, calibration};
use crate::names::shorten;
use crate::prescribed::{PrescribedText, SweepText};
use crate::problem::{Problem, Problems, Span};
use crate::requests::RequestsText;
use crate::scene::{Calibration, Scene};
use crate::units::Units;
use toml::de::{DeTable, DeValue};

impl Scene {
    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let text = source.inner();
        let root = crate::read::syntax(source)?;
        let mut problems = Problems::of(source);
        let parts = Parts::read(text, root.get_ref(), &mut problems);
        match (parts, problems.into_error()) {
            (_, Some(error)) => Err(error),
            (Some(parts), None) => {
                let mut scene = parts.finish(name, Source::clone(source));
                scene.elsewhere = elsewhere(text, root.get_ref());
                Ok(scene)
            }
            // Parts are missing only where something was found wrong.
            (None, None) => Err(SceneError::bare("the scene is incomplete".to_owned(), None)),
        }
    }
}

/// The sections of a file as read.
struct Parts<'a> {
    title: Option<&'a str>,
    note: Option<&'a str>,
    units: Units,
    bodies: Bodies<'a>,
    joints: Joints<'a>,
    actuators: Vec<ActuatorText<'a>>,
    measures: Measures<'a>,
    assembly: AssemblyText,
    /// Coordinate of each actuator at assembly, SI.
    start: Vec<f64>,
    prescribed: Option<PrescribedText>,
    sweep: Option<SweepText>,
    loads: Vec<LoadText>,
    drives: Vec<DriveText>,
    requests: RequestsText,
    motion: Option<MotionText<'a>>,
    calibration: Option<(Calibration, Span)>,
    sections: Sections,
}

/// Where the sections begin.
struct Sections {
    units: Option<Span>,
    assembly: Option<Span>,
    prescribed: Option<Span>,
    sweep: Option<Span>,
    requests: Option<Span>,
    motion: Option<Span>,
}

/// Longest title, in characters: it heads a page and a picture.
const LONGEST_TITLE: usize = 200;

/// What some editors put before the first character of a file.
const BYTE_ORDER_MARK: char = '\u{feff}';

impl<'a> Parts<'a> {
    fn read(text: &str, root: &'a DeTable<'a>, problems: &mut Problems) -> Option<Self> {
        let fields = Fields::of("the scene", 0..0, root);
        let blank = |c: char| c.is_whitespace() || c == BYTE_ORDER_MARK;
        if fields.entries.is_empty() {
            let message = match text.trim_matches(blank).is_empty() {
                true => "the scene is empty",
                false => "the scene has nothing but comments",
            };
            problems.push(
                Problem::new(message)
                    .at(0..0, "no bodies, no joints")
                    .help("a scene has at least [bodies] and [joints]"),
            );
            return None;
        }
        fields.allow(&keys::SCENE, problems);
        let title = text_of(&fields, "title", problems);
        if let (Some(text), Some(entry)) = (title, fields.get("title"))
            && text.chars().count() > LONGEST_TITLE
        {
            problems.push(
                Problem::new(format!(
                    "the title is longer than {LONGEST_TITLE} characters"
                ))
                .at(entry.key.clone(), "this text")
                .help("a title is a line at the head of a page; the rest can go into `note`"),
            );
        }
        let note = text_of(&fields, "note", problems);
        let units = Units::read(fields.get("units"), problems);
        // Without bodies every other name would be unknown: one message is enough.
        let bodies = section(&fields, "bodies", true, problems)?;
        let count = problems.count();
        let bodies = Bodies::read(&bodies, &units, problems);
        let all_bodies_read = problems.count() == count;
        let mut joints = section(&fields, "joints", true, problems)
            .map(|f| Joints::read(&f, &bodies, &units, problems))
            .unwrap_or_default();
        let actuators = section(&fields, "actuators", false, problems)
            .map(|f| actuators(&f, &bodies, &joints, problems))
            .unwrap_or_default();
        let coordinates = section(&fields, "coordinates", false, problems);
        let measures = Measures::read(&actuators, coordinates.as_ref(), &bodies, &joints, problems);
        joints.relate(&measures, &units, problems);
        // A joint that could not be read may be the one that holds a body.
        if !joints.list.is_empty() && joints.list.iter().all(|j| j.joint.is_some()) {
            unjoined(&bodies, &joints, problems);
        }
        let assembly = section(&fields, "assembly", false, problems);
        let assembly_text = AssemblyText::read(
            assembly.as_ref(),
            &bodies,
            &joints,
            &actuators,
            &units,
            problems,
        );
        let motion = section(&fields, "motion", false, problems);
        let moved = ["loads", "drives"]
            .iter()
            .any(|key| is_filled(&fields, key));
        let mut motion_text = motion
            .as_ref()
            .map(|f| MotionText::read(f, &actuators, moved, &units, problems));
        let section_of = assembly.as_ref().map(|f| &f.span);
        let start = starts(
            &assembly_text,
            motion_text.as_ref(),
            &actuators,
            section_of,
            problems,
        );
        if let (Some(text), Some(f)) = (&mut motion_text, &motion) {
            text.lead(&actuators, &start, &units, problems);
            let events = f.get("events");
            let events = events.and_then(|e| Fields::open(e, "events of [motion]", problems));
            let reader = EventReader {
                measures: &measures,
                joints: &joints,
                units: &units,
            };
            text.events = events.map_or_else(Vec::new, |f| reader.read(&f, problems));
        }
        let prescribed = section(&fields, "prescribed", false, problems);
        let prescribed_text = prescribed
            .as_ref()
            .map(|f| PrescribedText::read(f, &actuators, &start, &units, problems));
        let sweep = section(&fields, "sweep", false, problems);
        let sweep_text = sweep
            .as_ref()
            .map(|f| SweepText::read(f, &actuators, &start, &units, problems));
        let magnitudes = Magnitudes::new(&measures, &units);
        let mut loads = section(&fields, "loads", false, problems).map_or_else(Vec::new, |f| {
            LoadReader::new(&bodies, &joints, &units, &magnitudes).read(&f, problems)
        });
        if let Some(f) = section(&fields, "friction", false, problems) {
            loads.extend(friction(&f, &joints, &units, problems));
        }
        let drives = section(&fields, "drives", false, problems).map_or_else(Vec::new, |f| {
            let reader = DriveReader {
                measures: &measures,
                units: &units,
                magnitudes: &magnitudes,
            };
            reader.read(&f, problems)
        });
        if let Some(motion) = &motion_text {
            held(&drives, motion, &actuators, problems);
        }
        let requests = section(&fields, "requests", false, problems);
        let requests_text = match &requests {
            Some(f) => RequestsText::read(f, &bodies, &joints, problems),
            None => RequestsText::default(),
        };
        let calibration = section(&fields, "calibration", false, problems).and_then(|f| {
            if fields.get("motion").is_none() {
                problems.push(
                    Problem::new("a calibration needs a motion")
                        .at(f.span.clone(), "the period of which motion?")
                        .help("add [motion]: its period is what the number is fitted to"),
                );
            }
            let (calibration, at) = calibration(&f, problems)?;
            if all_bodies_read {
                bodies.check_number(&calibration.path, &at, problems);
            }
            Some((calibration, at))
        });
        let span = |f: &Option<Fields<'_>>| f.as_ref().map(|f| f.span.clone());
        Some(Self {
            title,
            note,
            sections: Sections {
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
            measures,
            assembly: assembly_text,
            start,
            prescribed: prescribed_text,
            sweep: sweep_text,
            loads,
            drives,
            requests: requests_text,
            motion: motion_text,
            calibration,
        })
    }
}

/// What is said of the k-th actuator.
fn said(values: &[Option<(f64, Span)>], k: usize) -> Option<f64> {
    values.get(k)?.as_ref().map(|s| s.0)
}

/// Coordinate of each actuator at assembly: as it says, or where the motion starts, or 0. No two
/// points are at 0 from each other by default: says which distances are missing.
fn starts(
    assembly: &AssemblyText,
    motion: Option<&MotionText<'_>>,
    actuators: &[ActuatorText<'_>],
    section: Option<&Span>,
    problems: &mut Problems,
) -> Vec<f64> {
    let moving = motion.map_or(&[][..], |m| &m.start);
    let mut starts = Vec::with_capacity(actuators.len());
    for (k, a) in actuators.iter().enumerate() {
        let start = said(&assembly.start, k).or(said(moving, k));
        if a.is_distance() && start.is_none() && !assembly.spoken.contains(&k) {
            let name = shorten(a.name);
            problems.push(
                Problem::new(format!("the length of `{name}` at the start is not given"))
                    .at(section.unwrap_or(&a.key).clone(), "how long?")
                    .help(format!("add it to [assembly], such as `{name} = 0.5`")),
            );
        }
        starts.push(start.unwrap_or(0.0));
    }
    starts
}

/// The table of a section. Absent it is an error where it is needed, empty as well.
fn section<'a>(
    fields: &Fields<'a>,
    key: &str,
    needed: bool,
    problems: &mut Problems,
) -> Option<Fields<'a>> {
    let missing = |span: Span, label: &str| {
        let help = match key {
            "bodies" => "describe the bodies: `[bodies.crank]` with `points = { A = [0, 0] }`",
            _ => "join the bodies: `A = { revolute = [\"ground.A\", \"crank.A\"] }`",
        };
        Problem::new(format!("the scene has no {key}"))
            .at(span, label)
            .help(help)
    };
    let Some(entry) = fields.get(key) else {
        if needed {
            problems.push(missing(0..0, &format!("there is no [{key}] in this file")));
        }
        return None;
    };
    let table = Fields::open(entry, format!("[{key}]"), problems)?;
    if needed && table.entries.is_empty() {
        problems.push(missing(entry.key.clone(), "nothing in it"));
        return None;
    }
    Some(table)
}

/// Whether there is something in a section; what is wrong with it is said where it is read.
fn is_filled(fields: &Fields<'_>, key: &str) -> bool {
    let value = fields.get(key).map(|e| e.value.get_ref());
    matches!(value, Some(DeValue::Table(table)) if !table.is_empty())
}

/// A text shown to people; blank it is as good as absent.
fn text_of<'a>(fields: &Fields<'a>, key: &str, problems: &mut Problems) -> Option<&'a str> {
    let entry: &Entry<'a> = fields.get(key)?;
    let text = string(entry.value, format_args!("the {key}"), problems)?.trim();
    (!text.is_empty()).then_some(text)
}

/// Says which bodies no joint holds.
fn unjoined(bodies: &Bodies<'_>, joints: &Joints<'_>, problems: &mut Problems) {
    let mut joined = vec![false; bodies.list.len()];
    for joint in joints.list.iter().filter_map(|j| j.joint.as_ref()) {
        for body in joint.bodies {
            joined[body.0] = true;
        }
    }
    for (body, _) in bodies.list.iter().zip(joined).filter(|(_, joined)| !joined) {
        let name = shorten(body.name);
        problems.push(
            Problem::new(format!("body `{name}` is in no joint"))
                .at(body.key.clone(), "held by nothing")
                .help("join it to another body in [joints], or leave it out"),
        );
    }
}
