//! Named coordinates: those of the actuators, and those of `[coordinates]`.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::Notation;
use crate::names::check;
use crate::scene_data::NamedCoordinate;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::{Unit, Units};
use crate::value::Value;
use crate::wording::shorten;
use dwell_geometry::{ActuatorId, BodyId, Coordinate, space};
use std::collections::HashMap;
use std::fmt::{Debug, Display};

/// A coordinate of a mechanism, in the plane or in space.
pub(crate) trait AnyCoordinate: Copy {
    /// Whether it is an angle.
    fn is_angle(self) -> bool;

    /// Whether an actuator drives it as the distance of two points, which is never zero.
    fn is_driven_distance(self) -> bool;

    /// Whether another is the same, maybe with the bodies in the other order.
    fn is_same(self, other: Self) -> bool;
}

impl AnyCoordinate for Coordinate {
    fn is_angle(self) -> bool {
        self.is_angle()
    }

    fn is_driven_distance(self) -> bool {
        matches!(self, Self::Length { .. })
    }

    fn is_same(self, other: Self) -> bool {
        is_same(self, other)
    }
}

impl AnyCoordinate for space::Coordinate {
    fn is_angle(self) -> bool {
        self.is_angle()
    }

    fn is_driven_distance(self) -> bool {
        false
    }

    fn is_same(self, other: Self) -> bool {
        self == other
    }
}

/// How actuators and coordinates are written in the plane or in space.
pub(crate) trait CoordinateNotation: Notation<Coordinate: AnyCoordinate> {
    /// The joints as read.
    type Joints<'a>;
    /// The type of an actuator of a mechanism.
    type Actuator: Clone + Debug;
    /// How a coordinate of `[coordinates]` is written.
    const COORDINATE: &'static str;

    /// The actuator of an entry, and the coordinate that it drives.
    fn actuator(
        entry: &Entry<'_>,
        parts: &Parts<'_, '_, Self>,
    ) -> Option<(Self::Actuator, Self::Coordinate)>;

    /// The angle or the travel that an entry of a coordinate names.
    fn angle_or_travel(
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        parts: &Parts<'_, '_, Self>,
    ) -> Option<Self::Coordinate>;

    /// The distance of two points.
    fn distance(bodies: [BodyId; 2], points: [Self::Point; 2]) -> Self::Coordinate;
}

/// Bodies and joints as read.
pub(crate) struct Parts<'r, 'a, D: CoordinateNotation> {
    pub(crate) bodies: &'r Bodies<'a, D>,
    pub(crate) joints: &'r D::Joints<'a>,
}

/// An actuator as read; its contents are `None` if it is invalid.
#[derive(Debug)]
pub(crate) struct ParsedActuator<'a, D: CoordinateNotation> {
    pub(crate) actuator: Option<D::Actuator>,
    pub(crate) coordinate: Option<D::Coordinate>,
    pub(crate) named: NamedActuator<'a>,
}

impl<'a, D: CoordinateNotation> std::ops::Deref for ParsedActuator<'a, D> {
    type Target = NamedActuator<'a>;

    fn deref(&self) -> &NamedActuator<'a> {
        &self.named
    }
}

/// The data of an actuator that its motion needs.
#[derive(Debug, Clone)]
pub(crate) struct NamedActuator<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    is_angle: bool,
    is_distance: bool,
}

impl<'a> NamedActuator<'a> {
    fn new<C: AnyCoordinate>(entry: &Entry<'a>, coordinate: Option<C>) -> Self {
        Self {
            name: entry.name,
            key: entry.key.clone(),
            is_angle: coordinate.is_none_or(C::is_angle),
            is_distance: coordinate.is_some_and(C::is_driven_distance),
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

/// A named coordinate as read; its contents are `None` if it is invalid.
#[derive(Debug, Clone)]
pub(crate) struct ParsedCoordinate<'a, C = Coordinate> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) coordinate: Option<C>,
}

/// All named coordinates: those of the actuators, then those of `[coordinates]`.
#[derive(Debug)]
pub(crate) struct ParsedCoordinates<'a, C = Coordinate> {
    pub(crate) list: Vec<ParsedCoordinate<'a, C>>,
    /// How many of them are actuators.
    pub(crate) actuators: usize,
    by_name: HashMap<&'a str, usize>,
    log: &'a Diagnostics,
}

impl<'a, C: AnyCoordinate> ParsedCoordinates<'a, C> {
    /// Reads the coordinates of actuators and of a section.
    pub(crate) fn read<D: CoordinateNotation<Coordinate = C>>(
        actuators: &[ParsedActuator<'a, D>],
        fields: Option<&TableReader<'a>>,
        parts: &Parts<'_, '_, D>,
        log: &'a Diagnostics,
    ) -> Self {
        let count = actuators.len();
        let mut all = Self {
            list: Vec::new(),
            actuators: count,
            by_name: HashMap::new(),
            log,
        };
        for actuator in actuators {
            all.push(actuator.name, &actuator.key, actuator.coordinate);
        }
        for entry in fields.iter().flat_map(|f| &f.entries) {
            check_coordinate_name(entry, "a coordinate");
            if let Some(k) = parts.bodies.position(entry.name) {
                let key = &parts.bodies.list[k].key;
                report_ambiguous_name(entry, key, "a body", "a coordinate", "a request");
            }
            if let Some(k) = all.by_name.get(entry.name) {
                let (key, context) = (&all.list[*k].key, "an expression");
                report_ambiguous_name(entry, key, "an actuator", "a coordinate", context);
            }
            let location = SceneLocation::Coordinate(all.list.len() - count);
            all.log.place(location, &entry.key);
            let coordinate = read_coordinate(entry, parts);
            all.push(entry.name, &entry.key, coordinate);
        }
        all
    }

    /// The valid coordinates of `[coordinates]`.
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

/// The name stands first at `key`, where it is of the kind `other`.
pub(crate) fn report_ambiguous_name(
    entry: &Entry<'_>,
    key: &Span,
    other: &str,
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
pub(crate) fn actuators<'a, D: CoordinateNotation>(
    fields: &TableReader<'a>,
    parts: &Parts<'_, '_, D>,
) -> Vec<ParsedActuator<'a, D>> {
    let mut list: Vec<ParsedActuator<'a, D>> = Vec::new();
    for entry in &fields.entries {
        check_coordinate_name(entry, "an actuator");
        if let Some(k) = parts.bodies.position(entry.name) {
            let key = &parts.bodies.list[k].key;
            report_ambiguous_name(entry, key, "a body", "an actuator", "[assembly]");
        }
        let location = SceneLocation::Actuator(ActuatorId(list.len()));
        entry.place(location);
        let (actuator, coordinate) = D::actuator(entry, parts).unzip();
        let same = |other: &&ParsedActuator<'_, D>| {
            let both = other.coordinate.zip(coordinate);
            both.is_some_and(|(a, b)| a.is_same(b))
        };
        if let Some(other) = list.iter().find(same) {
            let (a, b) = (shorten(other.name), shorten(entry.name));
            let message = format!("actuators `{a}` and `{b}` drive the same coordinate");
            let labels = [(&other.key, "one of them"), (&entry.key, "and the other")];
            let help = "leave one out: each actuator has a coordinate of its own";
            fields.log().report(message, &labels, help);
        }
        list.push(ParsedActuator {
            named: NamedActuator::new(entry, coordinate),
            actuator,
            coordinate,
        });
    }
    list
}

/// Reads the quantity that a coordinate of `[coordinates]` measures.
fn read_coordinate<D: CoordinateNotation>(
    entry: &Entry<'_>,
    parts: &Parts<'_, '_, D>,
) -> Option<D::Coordinate> {
    let fields = TableReader::open(entry, format!("coordinate `{}`", shorten(entry.name)))?;
    let (table, label) = (D::table("coordinate"), "which angle, travel or length?");
    fields.reject_unknown_keys(table);
    let chosen = fields.alternative(table, "measures nothing", label, D::COORDINATE)?;
    if chosen.name != "length" {
        return D::angle_or_travel(chosen, &fields, parts);
    }
    let (bodies, points) = length(chosen, &fields, "measures", TWO_POINTS, parts.bodies)?;
    Some(D::distance(bodies, points))
}

/// Two points of different bodies, of which `fields` drives or measures the distance.
pub(crate) fn length<D: Notation>(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    verb: &str,
    expected: &str,
    bodies: &Bodies<'_, D>,
) -> Option<([BodyId; 2], [D::Point; 2])> {
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
