//! What can be measured on the mechanism, under names: the actuators' coordinates, and those of
//! `[coordinates]`.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::fields::{Entry, Fields, Value, coordinate};
use crate::joints::Joints;
use crate::keys;
use crate::names::{check, shorten};
use crate::problem::{Problem, Problems, Span};
use crate::units::{Unit, Units};
use dwell_geometry::{Actuator, BodyId, Coordinate, Drive, JointId};
use std::collections::HashMap;
use std::fmt::Arguments;
use toml::de::DeValue;

/// An actuator as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct ActuatorText<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) actuator: Option<Actuator>,
}

impl ActuatorText<'_> {
    /// Whether its coordinate is an angle; one that could not be read counts as one.
    pub(crate) fn is_angle(&self) -> bool {
        match &self.actuator {
            Some(actuator) => actuator.coordinate().is_angle(),
            None => true,
        }
    }

    /// Whether it drives the distance of two points, which is never zero.
    pub(crate) fn is_distance(&self) -> bool {
        let drive = self.actuator.as_ref().map(|a| a.drive);
        matches!(drive, Some(Drive::Length(_)))
    }

    /// A value of its coordinate, SI.
    pub(crate) fn position(
        &self,
        value: &Value<'_>,
        units: &Units,
        what: Arguments<'_>,
        problems: &mut Problems,
    ) -> Option<f64> {
        let si = coordinate(value, self.is_angle(), units, what, problems)?;
        if self.is_distance() && si <= 0.0 {
            problems.push(
                Problem::new(format!("{what} is a length that is not above zero"))
                    .at(value.span(), "expected a number above 0")
                    .help("two points that coincide have no line along which to drive them"),
            );
            return None;
        }
        Some(si)
    }

    pub(crate) fn unit<'u>(&self, units: &'u Units) -> &'u Unit {
        units.of(self.is_angle())
    }
}

/// A named coordinate as read; nothing in it if it was wrong.
#[derive(Debug, Clone)]
pub(crate) struct Measure<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) coordinate: Option<Coordinate>,
}

/// All the coordinates that have a name: the actuators', then those of `[coordinates]`.
#[derive(Debug, Default)]
pub(crate) struct Measures<'a> {
    pub(crate) list: Vec<Measure<'a>>,
    /// How many of them are actuators.
    pub(crate) actuators: usize,
    by_name: HashMap<&'a str, usize>,
}

impl<'a> Measures<'a> {
    pub(crate) fn read(
        actuators: &[ActuatorText<'a>],
        fields: Option<&Fields<'a>>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        problems: &mut Problems,
    ) -> Self {
        let mut measures = Self::default();
        for a in actuators {
            measures.push(Measure {
                name: a.name,
                key: a.key.clone(),
                coordinate: a.actuator.as_ref().map(Actuator::coordinate),
            });
        }
        measures.actuators = actuators.len();
        for entry in fields.iter().flat_map(|f| &f.entries) {
            check("a coordinate", entry.name, &entry.key, problems);
            not_time(entry, "a coordinate", problems);
            if let Some(k) = bodies.position(entry.name) {
                let other = (&bodies.list[k].key, "body");
                twice(entry, other, "coordinate", "a request", problems);
            }
            if let Some(k) = measures.by_name.get(entry.name) {
                let other = (&measures.list[*k].key, "actuator");
                twice(entry, other, "coordinate", "an expression", problems);
            }
            measures.push(Measure {
                name: entry.name,
                key: entry.key.clone(),
                coordinate: measured(entry, bodies, joints, problems),
            });
        }
        measures
    }

    fn push(&mut self, measure: Measure<'a>) {
        self.by_name.insert(measure.name, self.list.len());
        self.list.push(measure);
    }

    /// The coordinate of that name; one that could not be read has been reported already.
    pub(crate) fn find(
        &self,
        name: &str,
        at: &Span,
        problems: &mut Problems,
    ) -> Option<Coordinate> {
        if let Some(&k) = self.by_name.get(name) {
            return self.list[k].coordinate;
        }
        let help = problems.choices(name, "coordinates", self.names());
        problems.push(
            Problem::new(format!("there is no coordinate `{}`", shorten(name)))
                .at(at.clone(), "neither an actuator nor in [coordinates]")
                .help(help),
        );
        None
    }

    pub(crate) fn names(&self) -> impl Iterator<Item = &'a str> + Clone {
        self.list.iter().map(|m| m.name)
    }
}

/// Whether two coordinates are the same, or one the other with the bodies the other way round.
pub(crate) fn is_same(a: Coordinate, b: Coordinate) -> bool {
    match (a, b) {
        (Coordinate::Angle([a, b]), Coordinate::Angle(other)) => other == [a, b] || other == [b, a],
        (
            Coordinate::Length { bodies, points },
            Coordinate::Length {
                bodies: others,
                points: other_points,
            },
        ) => {
            let [a, b] = bodies;
            let [p, q] = points;
            (others, other_points) == (bodies, points) || (others, other_points) == ([b, a], [q, p])
        }
        _ => a == b,
    }
}

/// `t` is the time in every expression.
fn not_time(entry: &Entry<'_>, kind: &str, problems: &mut Problems) {
    if entry.name == "t" {
        problems.push(
            Problem::new(format!("`t` cannot be the name of {kind}"))
                .at(entry.key.clone(), "this name")
                .help("`t` is the time in expressions: take another name"),
        );
    }
}

fn twice(
    entry: &Entry<'_>,
    (key, other): (&Span, &str),
    kind: &str,
    place: &str,
    problems: &mut Problems,
) {
    let article = |word: &str| match word.starts_with('a') {
        true => format!("an {word}"),
        false => format!("a {word}"),
    };
    let name = shorten(entry.name);
    problems.push(
        Problem::new(format!(
            "`{name}` names both {} and {}",
            article(other),
            article(kind)
        ))
        .at(key.clone(), format!("the {other}"))
        .at(entry.key.clone(), format!("the {kind}"))
        .help(format!(
            "rename one: in {place} it could not be told which is meant"
        )),
    );
}

/// All the actuators. A body of the same name is an error: both are keys of `[assembly]`.
pub(crate) fn actuators<'a>(
    fields: &Fields<'a>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
    problems: &mut Problems,
) -> Vec<ActuatorText<'a>> {
    let mut list: Vec<ActuatorText<'a>> = Vec::new();
    for entry in &fields.entries {
        check("an actuator", entry.name, &entry.key, problems);
        not_time(entry, "an actuator", problems);
        if let Some(k) = bodies.position(entry.name) {
            let other = (&bodies.list[k].key, "body");
            twice(entry, other, "actuator", "[assembly]", problems);
        }
        let text = ActuatorText {
            name: entry.name,
            key: entry.key.clone(),
            actuator: driven(entry, bodies, joints, problems),
        };
        let drives = |a: &ActuatorText<'_>| a.actuator.as_ref().map(Actuator::coordinate);
        let same = |other: &&ActuatorText<'_>| match (drives(other), drives(&text)) {
            (Some(a), Some(b)) => is_same(a, b),
            _ => false,
        };
        if let Some(other) = list.iter().find(same) {
            let (a, b) = (shorten(other.name), shorten(entry.name));
            problems.push(
                Problem::new(format!(
                    "actuators `{a}` and `{b}` drive the same coordinate"
                ))
                .at(other.key.clone(), "one of them")
                .at(entry.key.clone(), "and the other")
                .help("leave one out: each actuator has a coordinate of its own"),
            );
        }
        list.push(text);
    }
    list
}

/// What the actuator drives.
fn driven(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
    problems: &mut Problems,
) -> Option<Actuator> {
    let what = format!("actuator `{}`", shorten(entry.name));
    let fields = Fields::open(entry, what, problems)?;
    let what = &fields.what;
    fields.allow(&keys::ACTUATOR, problems);
    let Some(measure) = fields.one_of(|n| keys::ACTUATOR.knows(n), problems).ok()? else {
        if fields.has_others_than(&keys::ACTUATOR) {
            return None;
        }
        problems.push(
            Problem::new(format!("{what} drives nothing"))
                .at(entry.key.clone(), "which angle or length?")
                .help("add `angle = [\"ground\", \"crank\"]`: the angle of the second body from the first; or `length` with the name of a sliding joint or with two points"),
        );
        return None;
    };
    let (bodies, drive) = if measure.name == "angle" {
        let bodies = angle(measure, what, "drives", bodies, problems)?;
        (bodies, Drive::Angle)
    } else if let DeValue::String(name) = measure.value.get_ref() {
        let joint = joints.sliding(name, &measure.value.span(), problems)?;
        (bodies_of(joint, joints)?, Drive::Travel(joint))
    } else {
        let (bodies, points) = length(measure, what, "drives", bodies, problems)?;
        (bodies, Drive::Length(points))
    };
    Some(Actuator {
        name: entry.name.to_owned(),
        bodies,
        drive,
    })
}

/// What a coordinate of `[coordinates]` measures.
fn measured(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
    problems: &mut Problems,
) -> Option<Coordinate> {
    let what = format!("coordinate `{}`", shorten(entry.name));
    let fields = Fields::open(entry, what, problems)?;
    let what = &fields.what;
    fields.allow(&keys::COORDINATE, problems);
    let Some(measure) = fields
        .one_of(|n| keys::COORDINATE.knows(n), problems)
        .ok()?
    else {
        if fields.has_others_than(&keys::COORDINATE) {
            return None;
        }
        problems.push(
            Problem::new(format!("{what} measures nothing"))
                .at(entry.key.clone(), "which angle, travel or length?")
                .help("add `angle = [\"ground\", \"rod\"]`, `travel = \"slide\"`, or `length` with two points"),
        );
        return None;
    };
    match measure.name {
        "angle" => {
            let bodies = angle(measure, what, "measures", bodies, problems)?;
            Some(Coordinate::Angle(bodies))
        }
        "travel" => {
            let what = format_args!("travel of {what}");
            let name = crate::fields::string(measure.value, what, problems)?;
            let joint = joints.sliding(name, &measure.value.span(), problems)?;
            Some(Coordinate::Travel(joint))
        }
        _ => {
            let (bodies, points) = length(measure, what, "measures", bodies, problems)?;
            Some(Coordinate::Length { bodies, points })
        }
    }
}

fn bodies_of(joint: JointId, joints: &Joints<'_>) -> Option<[BodyId; 2]> {
    Some(joints.list.get(joint.0)?.joint.as_ref()?.bodies)
}

/// Two different bodies, of which `what` drives or measures the angle.
fn angle(
    entry: &Entry<'_>,
    what: &str,
    verb: &str,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Option<[BodyId; 2]> {
    let what_angle = format_args!("angle of {what}");
    let [first, second] = bodies.find_two(entry.value, what_angle, problems)?;
    if first.0 == second.0 {
        let name = &bodies.list[first.0.0].name;
        problems.push(
            Problem::new(format!("{what} {verb} body `{name}` against itself"))
                .at(first.1, "this body")
                .at(second.1, "and the same again")
                .help("an angle is between two different bodies"),
        );
        return None;
    }
    Some([first.0, second.0])
}

/// Two points of different bodies, of which `what` drives or measures the distance.
fn length(
    entry: &Entry<'_>,
    what: &str,
    verb: &str,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Option<([BodyId; 2], [dwell_geometry::Vec2; 2])> {
    let expected = match verb {
        "drives" => "a sliding joint, or two points [\"body.point\", \"body.point\"]",
        _ => TWO_POINTS,
    };
    let what_length = format_args!("length of {what}");
    let [first, second] = bodies.find_two_points(entry.value, expected, what_length, problems)?;
    if first.0 == second.0 {
        let name = &bodies.list[first.0.0].name;
        problems.push(
            Problem::new(format!("{what} {verb} a length within body `{name}`"))
                .at(first.2, "a point of this body")
                .at(second.2, "and another of the same")
                .help("a length that can change is between two different bodies"),
        );
        return None;
    }
    Some(([first.0, second.0], [bodies.at(&first), bodies.at(&second)]))
}
