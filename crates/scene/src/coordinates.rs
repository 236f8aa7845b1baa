//! Named coordinates: those of the actuators, and those of `[coordinates]`.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::Dimensions;
use crate::joints::Joints;
use crate::keys::table;
use crate::names::check;
use crate::plane_scene::NamedCoordinate;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::{Unit, Units};
use crate::value::Value;
use crate::wording::shorten;
use dwell_geometry::{Actuator, ActuatorId, ActuatorKind, BodyId, Coordinate, Vec2};
use std::collections::HashMap;
use std::fmt::Display;
use toml::de::DeValue;

/// A coordinate of a mechanism, in the plane or in space.
pub(crate) trait AnyCoordinate: Copy {
    /// Whether it is an angle.
    fn is_angle(self) -> bool;
}

impl AnyCoordinate for Coordinate {
    fn is_angle(self) -> bool {
        self.is_angle()
    }
}

impl AnyCoordinate for dwell_geometry::space::Coordinate {
    fn is_angle(self) -> bool {
        self.is_angle()
    }
}

/// An actuator as read, in the plane or in space; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct ParsedActuator<'a, A = Actuator> {
    pub(crate) actuator: Option<A>,
    pub(crate) named: NamedActuator<'a>,
}

impl<'a, A> std::ops::Deref for ParsedActuator<'a, A> {
    type Target = NamedActuator<'a>;

    fn deref(&self) -> &NamedActuator<'a> {
        &self.named
    }
}

impl ParsedActuator<'_> {
    fn coordinate(&self) -> Option<Coordinate> {
        self.actuator.as_ref().map(Actuator::coordinate)
    }
}

/// What the motion of an actuator needs to know of it.
#[derive(Debug, Clone)]
pub(crate) struct NamedActuator<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    is_angle: bool,
    is_distance: bool,
}

impl<'a> NamedActuator<'a> {
    /// Of an entry; `is_angle` where its coordinate is an angle or could not be read.
    pub(crate) fn new(entry: &Entry<'a>, is_angle: bool, is_distance: bool) -> Self {
        Self {
            name: entry.name,
            key: entry.key.clone(),
            is_angle,
            is_distance,
        }
    }

    /// Whether its coordinate is an angle; one that could not be read counts as one.
    pub(crate) fn is_angle(&self) -> bool {
        self.is_angle
    }

    /// Whether it drives the distance of two points, which is never zero.
    pub(crate) fn is_distance(&self) -> bool {
        self.is_distance
    }

    /// A value of its coordinate, SI.
    pub(crate) fn coordinate_value(&self, value: Value<'_>, what: impl Display) -> Option<f64> {
        let si = value.coordinate(self.is_angle(), &what)?;
        if self.is_distance() && si <= 0.0 {
            let message = format!("{what} is a length and must be greater than zero");
            let help = "two points that coincide have no line along which to drive them";
            return value.reject(message, "expected a number greater than 0", help);
        }
        Some(si)
    }

    pub(crate) fn unit<'u>(&self, units: &'u Units) -> &'u Unit {
        units.coordinate_unit(self.is_angle())
    }
}

/// A named coordinate as read; nothing in it if it was wrong.
#[derive(Debug, Clone)]
pub(crate) struct ParsedCoordinate<'a, C = Coordinate> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) coordinate: Option<C>,
}

/// All the coordinates that have a name: the actuators', then those of `[coordinates]`.
#[derive(Debug)]
pub(crate) struct ParsedCoordinates<'a, C = Coordinate> {
    pub(crate) list: Vec<ParsedCoordinate<'a, C>>,
    /// How many of them are actuators.
    pub(crate) actuators: usize,
    by_name: HashMap<&'a str, usize>,
    log: &'a Diagnostics,
}

impl<'a> ParsedCoordinates<'a> {
    /// Those of a scene in the plane.
    pub(crate) fn read(
        actuators: &[ParsedActuator<'a>],
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_>,
        joints: &Joints<'a>,
    ) -> Self {
        let named = actuators.iter().map(|a| (&a.named, a.coordinate()));
        let read = |entry: &Entry<'a>| read_coordinate(entry, bodies, joints);
        Self::read_by(named, fields, bodies, (joints.log, &read))
    }
}

/// Reads a coordinate of a section.
type ReadCoordinate<'r, 'a, C> = &'r dyn Fn(&Entry<'a>) -> Option<C>;

impl<'a, C: AnyCoordinate> ParsedCoordinates<'a, C> {
    /// Those of actuators, and of a section whose entries `read` reads.
    pub(crate) fn read_by<'n, D: Dimensions>(
        actuators: impl ExactSizeIterator<Item = (&'n NamedActuator<'a>, Option<C>)>,
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_, D>,
        (log, read): (&'a Diagnostics, ReadCoordinate<'_, 'a, C>),
    ) -> Self
    where
        'a: 'n,
    {
        let count = actuators.len();
        let mut all = Self {
            list: Vec::new(),
            actuators: count,
            by_name: HashMap::new(),
            log,
        };
        for (actuator, coordinate) in actuators {
            all.push(actuator.name, &actuator.key, coordinate);
        }
        for entry in fields.iter().flat_map(|f| &f.entries) {
            check_coordinate_name(entry, "a coordinate");
            if let Some(k) = bodies.position(entry.name) {
                let other = (&bodies.list[k].key, "a body");
                report_ambiguous_name(entry, other, "a coordinate", "a request");
            }
            if let Some(k) = all.by_name.get(entry.name) {
                let other = (&all.list[*k].key, "an actuator");
                report_ambiguous_name(entry, other, "a coordinate", "an expression");
            }
            let location = SceneLocation::Coordinate(all.list.len() - count);
            all.log.place(location, &entry.key);
            let coordinate = read(entry);
            all.push(entry.name, &entry.key, coordinate);
        }
        all
    }

    /// Those of `[coordinates]` that were read well.
    pub(crate) fn of_section(&self) -> Vec<NamedCoordinate<C>> {
        let of_one = |c: &ParsedCoordinate<'_, C>| {
            let (name, coordinate) = (c.name.to_owned(), c.coordinate?);
            Some(NamedCoordinate { name, coordinate })
        };
        let named = self.list[self.actuators..].iter();
        named.filter_map(of_one).collect()
    }

    fn push(&mut self, name: &'a str, key: &Span, coordinate: Option<C>) {
        self.by_name.insert(name, self.list.len());
        let key = key.clone();
        self.list.push(ParsedCoordinate {
            name,
            key,
            coordinate,
        });
    }

    /// The coordinate of that name; one that could not be read has been reported already.
    pub(crate) fn find(&self, name: &str, at: &Span) -> Option<C> {
        if let Some(&k) = self.by_name.get(name) {
            return self.list[k].coordinate;
        }
        let names = self.list.iter().map(|m| m.name);
        let help = self.log.choices(name, "coordinates", names);
        let message = format!("there is no coordinate `{}`", shorten(name));
        let labels = [(at, "neither an actuator nor in [coordinates]")];
        self.log.reject(message, &labels, help)
    }

    /// The coordinate that the value of an entry of `fields` names.
    pub(crate) fn named_by(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<C> {
        let name = entry.value.string(fields.name_of(entry))?;
        self.find(name, &entry.value.span())
    }
}

/// Whether two coordinates are the same, or one the other with the bodies in the other order.
pub(crate) fn is_same(a: Coordinate, b: Coordinate) -> bool {
    let swapped = match b {
        Coordinate::Angle([first, second]) => Coordinate::Angle([second, first]),
        Coordinate::Length {
            bodies: [a, b],
            points: [p, q],
        } => Coordinate::Length {
            bodies: [b, a],
            points: [q, p],
        },
        Coordinate::Travel(_) => b,
    };
    a == b || a == swapped
}

/// A name as [`check`] allows it; `t` is the time in every expression.
pub(crate) fn check_coordinate_name(entry: &Entry<'_>, kind: &str) {
    check(kind, entry);
    if entry.name == "t" {
        let message = format!("`t` cannot be the name of {kind}");
        let help = "`t` is the time in expressions: take another name";
        entry.reject::<()>(message, "this name", help);
    }
}

/// `other` is where the name stands first, and of what kind it is there.
pub(crate) fn report_ambiguous_name(
    entry: &Entry<'_>,
    (key, other): (&Span, &str),
    kind: &str,
    context: &str,
) {
    let [first, second] = [other, kind].map(|kind| {
        let thing = kind.trim_start_matches("an ").trim_start_matches("a ");
        format!("the {thing}")
    });
    let message = format!("`{}` names both {other} and {kind}", shorten(entry.name));
    let help = format!("rename one: in {context} the name would be ambiguous");
    let labels = [(key, first.as_str()), (&entry.key, &second)];
    entry.log().report(message, &labels, help);
}

/// All the actuators. A body of the same name is an error: both are keys of `[assembly]`.
pub(crate) fn actuators<'a>(
    fields: &TableReader<'a>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
) -> Vec<ParsedActuator<'a>> {
    let mut list: Vec<ParsedActuator<'a>> = Vec::new();
    for entry in &fields.entries {
        check_coordinate_name(entry, "an actuator");
        if let Some(k) = bodies.position(entry.name) {
            let other = (&bodies.list[k].key, "a body");
            report_ambiguous_name(entry, other, "an actuator", "[assembly]");
        }
        let location = SceneLocation::Actuator(ActuatorId(list.len()));
        entry.place(location);
        let actuator = read_actuator(entry, bodies, joints);
        let kind = actuator.as_ref().map(|a| a.kind);
        let is_angle = matches!(kind, None | Some(ActuatorKind::Angle));
        let is_distance = matches!(kind, Some(ActuatorKind::Length(_)));
        let parsed = ParsedActuator {
            named: NamedActuator::new(entry, is_angle, is_distance),
            actuator,
        };
        let same = |other: &&ParsedActuator<'_>| {
            let both = other.coordinate().zip(parsed.coordinate());
            both.is_some_and(|(a, b)| is_same(a, b))
        };
        if let Some(other) = list.iter().find(same) {
            let (a, b) = (shorten(other.name), shorten(entry.name));
            let message = format!("actuators `{a}` and `{b}` drive the same coordinate");
            let labels = [(&other.key, "one of them"), (&entry.key, "and the other")];
            let help = "leave one out: each actuator has a coordinate of its own";
            fields.log().report(message, &labels, help);
        }
        list.push(parsed);
    }
    list
}

/// What the actuator drives.
fn read_actuator(entry: &Entry<'_>, bodies: &Bodies<'_>, joints: &Joints<'_>) -> Option<Actuator> {
    let what = format!("actuator `{}`", shorten(entry.name));
    let fields = TableReader::open(entry, what)?;
    fields.reject_unknown_keys(table("actuator"));
    let help = "add `angle = [\"ground\", \"crank\"]`: the angle of the second body from the first; or `length` with the name of a sliding joint or with two points";
    let lacks = ("has no coordinate", "which angle or length?");
    let chosen = fields.alternative(table("actuator"), lacks, help)?;
    let (bodies, kind) = match (chosen.name, chosen.value.get()) {
        ("angle", _) => {
            let bodies = angle(chosen, &fields, "drives", bodies)?;
            (bodies, ActuatorKind::Angle)
        }
        (_, DeValue::String(name)) => {
            let joint = joints.sliding(name, &chosen.value.span())?;
            let bodies = joints.list.get(joint.0)?.joint.as_ref()?.bodies;
            (bodies, ActuatorKind::Travel(joint))
        }
        _ => {
            let expected = "a sliding joint, or two points [\"body.point\", \"body.point\"]";
            let (bodies, points) = length(chosen, &fields, ("drives", expected), bodies)?;
            (bodies, ActuatorKind::Length(points))
        }
    };
    Some(Actuator::new(entry.name, bodies, kind))
}

/// What a coordinate of `[coordinates]` measures.
fn read_coordinate(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
) -> Option<Coordinate> {
    let what = format!("coordinate `{}`", shorten(entry.name));
    let fields = TableReader::open(entry, what)?;
    fields.reject_unknown_keys(table("coordinate"));
    let help =
        "add `angle = [\"ground\", \"rod\"]`, `travel = \"slide\"`, or `length` with two points";
    let lacks = ("measures nothing", "which angle, travel or length?");
    let chosen = fields.alternative(table("coordinate"), lacks, help)?;
    match chosen.name {
        "angle" => angle(chosen, &fields, "measures", bodies).map(Coordinate::Angle),
        "travel" => {
            let name = chosen.value.string(fields.name_of(chosen))?;
            let joint = joints.sliding(name, &chosen.value.span())?;
            Some(Coordinate::Travel(joint))
        }
        _ => {
            let (bodies, points) = length(chosen, &fields, ("measures", TWO_POINTS), bodies)?;
            Some(Coordinate::Length { bodies, points })
        }
    }
}

/// Two different bodies, of which `fields` drives or measures the angle.
fn angle(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    verb: &str,
    bodies: &Bodies<'_>,
) -> Option<[BodyId; 2]> {
    let [a, b] = &bodies.find_two(entry.value, fields.name_of(entry))?;
    let message = |name: &str| format!("{} {verb} body `{name}` against itself", fields.what);
    let help = "an angle is between two different bodies";
    bodies.require_different([(a.0, &a.1), (b.0, &b.1)], message, help)
}

/// Two points of different bodies, of which `fields` drives or measures the distance.
fn length(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    (verb, expected): (&str, &str),
    bodies: &Bodies<'_>,
) -> Option<([BodyId; 2], [Vec2; 2])> {
    let [a, b] = bodies.find_two_points(entry.value, expected, fields.name_of(entry))?;
    if a.0 != b.0 {
        return Some(([a.0, b.0], [bodies.at(&a), bodies.at(&b)]));
    }
    let name = bodies.list[a.0.0].name;
    let message = format!("{} {verb} a length within body `{name}`", fields.what);
    let first = (&a.2, "a point of this body");
    let labels = [first, (&b.2, "and another of the same")];
    let help = "a length that can change is between two different bodies";
    fields.log().reject(message, &labels, help)
}
