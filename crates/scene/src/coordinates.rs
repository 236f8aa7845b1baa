//! Named coordinates: those of the actuators, and those of `[coordinates]`.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::joints::Joints;
use crate::keys::table;
use crate::names::check;
use crate::table_reader::{Entry, TableReader, Value, coordinate};
use crate::units::{Unit, Units};
use crate::wording::shorten;
use dwell_geometry::{Actuator, ActuatorKind, BodyId, Coordinate, JointId};
use std::collections::HashMap;
use std::fmt::Arguments;
use toml::de::DeValue;

/// An actuator as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct ParsedActuator<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) actuator: Option<Actuator>,
}

impl ParsedActuator<'_> {
    /// Whether its coordinate is an angle; one that could not be read counts as one.
    pub(crate) fn is_angle(&self) -> bool {
        match &self.actuator {
            Some(actuator) => actuator.coordinate().is_angle(),
            None => true,
        }
    }

    /// Whether it drives the distance of two points, which is never zero.
    pub(crate) fn is_distance(&self) -> bool {
        let kind = self.actuator.as_ref().map(|a| a.kind);
        matches!(kind, Some(ActuatorKind::Length(_)))
    }

    /// A value of its coordinate, SI.
    pub(crate) fn coordinate_value(
        &self,
        value: &Value<'_>,
        units: &Units,
        what: Arguments<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let si = coordinate(value, self.is_angle(), units, what, diagnostics)?;
        if self.is_distance() && si <= 0.0 {
            diagnostics.push(
                Diagnostic::new(format!("{what} is a length that is not above zero"))
                    .label(value.span(), "expected a number above 0")
                    .help("two points that coincide have no line along which to drive them"),
            );
            return None;
        }
        Some(si)
    }

    pub(crate) fn unit<'u>(&self, units: &'u Units) -> &'u Unit {
        units.coordinate_unit(self.is_angle())
    }
}

/// A named coordinate as read; nothing in it if it was wrong.
#[derive(Debug, Clone)]
pub(crate) struct ParsedCoordinate<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) coordinate: Option<Coordinate>,
}

/// All the coordinates that have a name: the actuators', then those of `[coordinates]`.
#[derive(Debug, Default)]
pub(crate) struct ParsedCoordinates<'a> {
    pub(crate) list: Vec<ParsedCoordinate<'a>>,
    /// How many of them are actuators.
    pub(crate) actuators: usize,
    by_name: HashMap<&'a str, usize>,
}

impl<'a> ParsedCoordinates<'a> {
    pub(crate) fn read(
        actuators: &[ParsedActuator<'a>],
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut named_coordinates = Self::default();
        for a in actuators {
            named_coordinates.push(ParsedCoordinate {
                name: a.name,
                key: a.key.clone(),
                coordinate: a.actuator.as_ref().map(Actuator::coordinate),
            });
        }
        named_coordinates.actuators = actuators.len();
        for entry in fields.iter().flat_map(|f| &f.entries) {
            check("a coordinate", entry.name, &entry.key, diagnostics);
            not_time(entry, "a coordinate", diagnostics);
            if let Some(k) = bodies.position(entry.name) {
                let other = (&bodies.list[k].key, "body");
                report_ambiguous_name(entry, other, "coordinate", "a request", diagnostics);
            }
            if let Some(k) = named_coordinates.by_name.get(entry.name) {
                let other = (&named_coordinates.list[*k].key, "actuator");
                report_ambiguous_name(entry, other, "coordinate", "an expression", diagnostics);
            }
            named_coordinates.push(ParsedCoordinate {
                name: entry.name,
                key: entry.key.clone(),
                coordinate: read_coordinate(entry, bodies, joints, diagnostics),
            });
        }
        named_coordinates
    }

    fn push(&mut self, parsed: ParsedCoordinate<'a>) {
        self.by_name.insert(parsed.name, self.list.len());
        self.list.push(parsed);
    }

    /// The coordinate of that name; one that could not be read has been reported already.
    pub(crate) fn find(
        &self,
        name: &str,
        at: &Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<Coordinate> {
        if let Some(&k) = self.by_name.get(name) {
            return self.list[k].coordinate;
        }
        let help = diagnostics.choices(name, "coordinates", self.names());
        diagnostics.push(
            Diagnostic::new(format!("there is no coordinate `{}`", shorten(name)))
                .label(at.clone(), "neither an actuator nor in [coordinates]")
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
fn not_time(entry: &Entry<'_>, kind: &str, diagnostics: &mut Diagnostics) {
    if entry.name == "t" {
        diagnostics.push(
            Diagnostic::new(format!("`t` cannot be the name of {kind}"))
                .label(entry.key.clone(), "this name")
                .help("`t` is the time in expressions: take another name"),
        );
    }
}

fn report_ambiguous_name(
    entry: &Entry<'_>,
    (key, other): (&Span, &str),
    kind: &str,
    context: &str,
    diagnostics: &mut Diagnostics,
) {
    let article = |word: &str| match word.starts_with('a') {
        true => format!("an {word}"),
        false => format!("a {word}"),
    };
    let name = shorten(entry.name);
    diagnostics.push(
        Diagnostic::new(format!(
            "`{name}` names both {} and {}",
            article(other),
            article(kind)
        ))
        .label(key.clone(), format!("the {other}"))
        .label(entry.key.clone(), format!("the {kind}"))
        .help(format!(
            "rename one: in {context} the name would be ambiguous"
        )),
    );
}

/// All the actuators. A body of the same name is an error: both are keys of `[assembly]`.
pub(crate) fn actuators<'a>(
    fields: &TableReader<'a>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
    diagnostics: &mut Diagnostics,
) -> Vec<ParsedActuator<'a>> {
    let mut list: Vec<ParsedActuator<'a>> = Vec::new();
    for entry in &fields.entries {
        check("an actuator", entry.name, &entry.key, diagnostics);
        not_time(entry, "an actuator", diagnostics);
        if let Some(k) = bodies.position(entry.name) {
            let other = (&bodies.list[k].key, "body");
            report_ambiguous_name(entry, other, "actuator", "[assembly]", diagnostics);
        }
        let parsed = ParsedActuator {
            name: entry.name,
            key: entry.key.clone(),
            actuator: read_actuator(entry, bodies, joints, diagnostics),
        };
        let coordinate_of = |a: &ParsedActuator<'_>| a.actuator.as_ref().map(Actuator::coordinate);
        let same =
            |other: &&ParsedActuator<'_>| match (coordinate_of(other), coordinate_of(&parsed)) {
                (Some(a), Some(b)) => is_same(a, b),
                _ => false,
            };
        if let Some(other) = list.iter().find(same) {
            let (a, b) = (shorten(other.name), shorten(entry.name));
            diagnostics.push(
                Diagnostic::new(format!(
                    "actuators `{a}` and `{b}` drive the same coordinate"
                ))
                .label(other.key.clone(), "one of them")
                .label(entry.key.clone(), "and the other")
                .help("leave one out: each actuator has a coordinate of its own"),
            );
        }
        list.push(parsed);
    }
    list
}

/// What the actuator drives.
fn read_actuator(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Actuator> {
    let what = format!("actuator `{}`", shorten(entry.name));
    let fields = TableReader::open(entry, what, diagnostics)?;
    let what = &fields.what;
    fields.reject_unknown_keys(table("actuator"), diagnostics);
    let Some(chosen) = fields
        .one_of(|n| table("actuator").contains_key(n), diagnostics)
        .ok()?
    else {
        if fields.has_unknown_keys(table("actuator")) {
            return None;
        }
        diagnostics.push(
            Diagnostic::new(format!("{what} has no coordinate"))
                .label(entry.key.clone(), "which angle or length?")
                .help("add `angle = [\"ground\", \"crank\"]`: the angle of the second body from the first; or `length` with the name of a sliding joint or with two points"),
        );
        return None;
    };
    let (bodies, kind) = if chosen.name == "angle" {
        let bodies = angle(chosen, what, "drives", bodies, diagnostics)?;
        (bodies, ActuatorKind::Angle)
    } else if let DeValue::String(name) = chosen.value.get_ref() {
        let joint = joints.sliding(name, &chosen.value.span(), diagnostics)?;
        (bodies_of(joint, joints)?, ActuatorKind::Travel(joint))
    } else {
        let (bodies, points) = length(chosen, what, "drives", bodies, diagnostics)?;
        (bodies, ActuatorKind::Length(points))
    };
    Some(Actuator {
        name: entry.name.to_owned(),
        bodies,
        kind,
    })
}

/// What a coordinate of `[coordinates]` measures.
fn read_coordinate(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Coordinate> {
    let what = format!("coordinate `{}`", shorten(entry.name));
    let fields = TableReader::open(entry, what, diagnostics)?;
    let what = &fields.what;
    fields.reject_unknown_keys(table("coordinate"), diagnostics);
    let Some(chosen) = fields
        .one_of(|n| table("coordinate").contains_key(n), diagnostics)
        .ok()?
    else {
        if fields.has_unknown_keys(table("coordinate")) {
            return None;
        }
        diagnostics.push(
            Diagnostic::new(format!("{what} measures nothing"))
                .label(entry.key.clone(), "which angle, travel or length?")
                .help("add `angle = [\"ground\", \"rod\"]`, `travel = \"slide\"`, or `length` with two points"),
        );
        return None;
    };
    match chosen.name {
        "angle" => {
            let bodies = angle(chosen, what, "measures", bodies, diagnostics)?;
            Some(Coordinate::Angle(bodies))
        }
        "travel" => {
            let what = format_args!("travel of {what}");
            let name = crate::table_reader::string(chosen.value, what, diagnostics)?;
            let joint = joints.sliding(name, &chosen.value.span(), diagnostics)?;
            Some(Coordinate::Travel(joint))
        }
        _ => {
            let (bodies, points) = length(chosen, what, "measures", bodies, diagnostics)?;
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
    diagnostics: &mut Diagnostics,
) -> Option<[BodyId; 2]> {
    let what_angle = format_args!("angle of {what}");
    let [first, second] = bodies.find_two(entry.value, what_angle, diagnostics)?;
    if first.0 == second.0 {
        let name = &bodies.list[first.0.0].name;
        diagnostics.push(
            Diagnostic::new(format!("{what} {verb} body `{name}` against itself"))
                .label(first.1, "this body")
                .label(second.1, "and the same again")
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
    diagnostics: &mut Diagnostics,
) -> Option<([BodyId; 2], [dwell_geometry::Vec2; 2])> {
    let expected = match verb {
        "drives" => "a sliding joint, or two points [\"body.point\", \"body.point\"]",
        _ => TWO_POINTS,
    };
    let what_length = format_args!("length of {what}");
    let [first, second] =
        bodies.find_two_points(entry.value, expected, what_length, diagnostics)?;
    if first.0 == second.0 {
        let name = &bodies.list[first.0.0].name;
        diagnostics.push(
            Diagnostic::new(format!("{what} {verb} a length within body `{name}`"))
                .label(first.2, "a point of this body")
                .label(second.2, "and another of the same")
                .help("a length that can change is between two different bodies"),
        );
        return None;
    }
    Some(([first.0, second.0], [bodies.at(&first), bodies.at(&second)]))
}
