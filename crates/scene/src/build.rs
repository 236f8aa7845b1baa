//! The scene put together from the sections of the file.

use crate::assembly::AssemblyText;
use crate::bodies::{Bodies, BodyText};
use crate::coordinates::{ActuatorText, Measures, actuators};
use crate::error::{SceneError, Source};
use crate::fields::{Entry, Fields, string};
use crate::joints::{JointText, Joints};
use crate::keys;
use crate::loads::{LoadReader, LoadText};
use crate::motion::{MotionText, calibration};
use crate::names::shorten;
use crate::place::{BodyPlaces, JointPlaces, LoadPlaces, Places};
use crate::prescribed::{PrescribedText, SweepText};
use crate::problem::{Problem, Problems, Span};
use crate::requests::RequestsText;
use crate::scene::{Assembly, Calibration, Motion, NamedCoordinate, Requests, Scene};
use crate::units::Units;
use dwell_geometry::{Body, Mechanism, Vec2};
use toml::de::DeTable;

impl Scene {
    pub(crate) fn build(name: String, source: &Source) -> Result<Self, SceneError> {
        let text = source.inner();
        let root = crate::read::syntax(source)?;
        let mut problems = Problems::of(source);
        let parts = Parts::read(text, root.get_ref(), &mut problems);
        match (parts, problems.into_error()) {
            (_, Some(error)) => Err(error),
            (Some(parts), None) => Ok(parts.finish(name, Source::clone(source))),
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
    requests: RequestsText,
    motion: Option<MotionText>,
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
        let motion_text = motion
            .as_ref()
            .map(|f| MotionText::read(f, &actuators, &units, problems));
        let section_of = assembly.as_ref().map(|f| &f.span);
        let start = starts(
            &assembly_text,
            motion_text.as_ref(),
            &actuators,
            section_of,
            problems,
        );
        let prescribed = section(&fields, "prescribed", false, problems);
        let prescribed_text = prescribed
            .as_ref()
            .map(|f| PrescribedText::read(f, &actuators, &start, &units, problems));
        let sweep = section(&fields, "sweep", false, problems);
        let sweep_text = sweep
            .as_ref()
            .map(|f| SweepText::read(f, &actuators, &start, &units, problems));
        let loads = section(&fields, "loads", false, problems).map_or_else(Vec::new, |f| {
            LoadReader::new(&bodies, &measures, &units).read(&f, problems)
        });
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
            requests: requests_text,
            motion: motion_text,
            calibration,
        })
    }

    /// The scene of parts in which nothing was found wrong.
    fn finish(self, name: String, source: Source) -> Scene {
        let places = self.places();
        let mechanism = Mechanism {
            bodies: self.bodies.list.iter().map(body).collect(),
            ground: self.bodies.ground.unwrap_or(0),
            joints: self
                .joints
                .list
                .iter()
                .filter_map(|j| j.joint.clone())
                .collect(),
            actuators: self
                .actuators
                .iter()
                .filter_map(|a| a.actuator.clone())
                .collect(),
            relations: self.joints.relations,
        };
        let actuators = 0..self.actuators.len();
        let named = self.measures.list.iter().skip(self.measures.actuators);
        let coordinates = named.filter_map(|m| {
            Some(NamedCoordinate {
                name: m.name.to_owned(),
                coordinate: m.coordinate?,
            })
        });
        let coordinates = coordinates.collect();
        let assembly = Assembly {
            start: self.start,
            rough: values(&self.assembly.rough),
            joints: values(&self.assembly.joints),
        };
        let motion = self.motion.as_ref().and_then(|m| {
            Some(Motion {
                start: actuators
                    .clone()
                    .map(|k| said(&m.start, k).unwrap_or(assembly.start[k]))
                    .collect(),
                speed: actuators
                    .clone()
                    .map(|k| said(&m.speed, k).unwrap_or(0.0))
                    .collect(),
                laws: actuators.map(|_| None).collect(),
                length: m.length.as_ref()?.0,
                events: Vec::new(),
            })
        });
        let requests = Requests {
            reactions: match self.requests.reactions {
                Some(asked) => asked.into_iter().map(|(r, _)| r).collect(),
                None => mechanism.reactions(),
            },
            paths: self.requests.paths.into_iter().map(|(p, _)| p).collect(),
            dwell: self.requests.dwell.map(|(d, _)| d),
            variables: self
                .requests
                .variables
                .map(|all| all.into_iter().map(|(name, _)| name).collect()),
            sections: self.requests.sections.into_iter().map(|(s, _)| s).collect(),
        };
        Scene {
            title: self.title.map_or_else(|| name.clone(), one_line),
            name,
            note: self.note.map(printable),
            mechanism,
            masses: self.bodies.list.iter().map(|b| b.mass).collect(),
            points: self.bodies.list.iter().map(points).collect(),
            coordinates,
            assembly,
            prescribed: self.prescribed.and_then(|p| p.prescribed),
            sweep: self.sweep.and_then(|s| s.sweep),
            loads: self.loads.into_iter().filter_map(|l| l.load).collect(),
            drives: Vec::new(),
            requests,
            motion,
            calibration: self.calibration.map(|(c, _)| c),
            source,
            units: self.units,
            places,
            numbers: self.bodies.numbers,
        }
    }

    fn places(&self) -> Places {
        let spans = |said: &[Option<(f64, Span)>]| -> Vec<Option<Span>> {
            said.iter()
                .map(|s| s.as_ref().map(|s| s.1.clone()))
                .collect()
        };
        let body = |b: &BodyText<'_>| BodyPlaces {
            key: b.key.clone(),
            points: b.points.iter().map(|p| p.span.clone()).collect(),
            mass: b.mass_at.clone(),
            inertia: b.inertia_at.clone(),
            center: b.center_at.clone(),
        };
        let joint = |j: &JointText| JointPlaces {
            key: j.key.clone(),
            ends: j.ends.clone(),
            axis: j.axis.clone(),
            law: j.law.clone(),
        };
        let load = |l: &LoadText| LoadPlaces {
            key: l.key.clone(),
            magnitude: l.magnitude.clone(),
        };
        let named = self.measures.list.iter().skip(self.measures.actuators);
        let prescribed = self.prescribed.as_ref();
        let swept = self.sweep.as_ref();
        let variables = self.requests.variables.as_deref().unwrap_or(&[]);
        let motion = self.motion.as_ref();
        let reactions = self.requests.reactions.as_deref().unwrap_or(&[]);
        Places {
            units: self.sections.units.clone(),
            bodies: self.bodies.list.iter().map(body).collect(),
            joints: self.joints.list.iter().map(joint).collect(),
            actuators: self.actuators.iter().map(|a| a.key.clone()).collect(),
            coordinates: named.map(|m| m.key.clone()).collect(),
            assembly: self.sections.assembly.clone(),
            start: spans(&self.assembly.start),
            rough: spans(&self.assembly.rough),
            prescribed: self.sections.prescribed.clone(),
            laws: prescribed.map_or_else(Vec::new, |p| p.laws.clone()),
            sweep: self.sections.sweep.clone(),
            swept: swept.map_or_else(Vec::new, |s| s.actuators.clone()),
            loads: self.loads.iter().map(load).collect(),
            requests: self.sections.requests.clone(),
            reactions: reactions.iter().map(|r| Some(r.1.clone())).collect(),
            paths: self.requests.paths.iter().map(|p| p.1.clone()).collect(),
            dwell: self.requests.dwell.as_ref().map(|d| d.1.clone()),
            variables: variables.iter().map(|v| v.1.clone()).collect(),
            sections: self.requests.sections.iter().map(|s| s.1.clone()).collect(),
            motion: self.sections.motion.clone(),
            motion_start: motion.map_or_else(Vec::new, |m| spans(&m.start)),
            speed: motion.map_or_else(Vec::new, |m| spans(&m.speed)),
            length: motion.and_then(|m| m.length.as_ref()).map(|l| l.1.clone()),
            calibration: self.calibration.as_ref().map(|c| c.1.clone()),
        }
    }
}

/// What is said, without where.
fn values(said: &[Option<(f64, Span)>]) -> Vec<Option<f64>> {
    said.iter().map(|s| s.as_ref().map(|s| s.0)).collect()
}

/// What is said of the k-th actuator.
fn said(values: &[Option<(f64, Span)>], k: usize) -> Option<f64> {
    values.get(k)?.as_ref().map(|s| s.0)
}

/// Coordinate of each actuator at assembly: as it says, or where the motion starts, or 0. No two
/// points are at 0 from each other by default: says which distances are missing.
fn starts(
    assembly: &AssemblyText,
    motion: Option<&MotionText>,
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

fn body(b: &BodyText<'_>) -> Body {
    Body {
        name: b.name.to_owned(),
    }
}

fn points(b: &BodyText<'_>) -> Vec<(String, Vec2)> {
    b.points.iter().map(|p| (p.name.to_owned(), p.at)).collect()
}

/// A title heads a page: whatever white space it is written with becomes single spaces.
fn one_line(text: &str) -> String {
    let text = printable(text);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Control characters other than line breaks would reach the reader's terminal: they become spaces.
fn printable(text: &str) -> String {
    let shown = |c: char| if c.is_control() && c != '\n' { ' ' } else { c };
    text.chars().map(shown).collect()
}
