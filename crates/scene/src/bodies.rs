//! The bodies: their points, their masses, and which of them is the ground.

use crate::diagnostics::{Diagnostics, Span};
use crate::keys::table;
use crate::names::check;
use crate::number_paths::{BodyField, BodyNumber, no_number};
use crate::table_reader::{Entry, TableReader};
use crate::units::Unit;
use crate::value::{POINT, Value};
use crate::wording::shorten;
use dwell_geometry::{BodyId, Vec2, vec2};
use dwell_kinetostatics::Mass;
use std::collections::HashMap;
use std::fmt::Display;
use toml::de::DeValue;

/// A body as read. What could not be read is zero: the scene fails anyway, and the names still
/// serve to check the rest of the file.
#[derive(Debug)]
pub(crate) struct ParsedBody<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) points: Vec<ParsedPoint<'a>>,
    by_name: HashMap<&'a str, usize>,
    /// Its points were read: a name that is not among them does not exist.
    points_known: bool,
    pub(crate) mass: Mass,
    pub(crate) mass_at: Option<Span>,
    pub(crate) inertia_at: Option<Span>,
    pub(crate) center_at: Option<Span>,
}

/// A point of a body, in m.
#[derive(Debug)]
pub(crate) struct ParsedPoint<'a> {
    pub(crate) name: &'a str,
    pub(crate) at: Vec2,
    pub(crate) span: Span,
}

/// A point that a text names: its body, its index there, and where it is named.
pub(crate) type NamedPoint = (BodyId, usize, Span);

/// How two points are written.
pub(crate) const TWO_POINTS: &str = "two points [\"body.point\", \"body.point\"]";

/// All the bodies as read.
#[derive(Debug)]
pub(crate) struct Bodies<'a> {
    pub(crate) list: Vec<ParsedBody<'a>>,
    by_name: HashMap<&'a str, usize>,
    pub(crate) ground: Option<usize>,
    /// The numbers a calibration or a study may change.
    pub(crate) numbers: Vec<BodyNumber>,
    log: &'a Diagnostics,
}

impl<'a> Bodies<'a> {
    pub(crate) fn read(fields: &TableReader<'a>) -> Self {
        let open = |e| TableReader::open(e, format!("body `{}`", shorten(e.name)));
        let tables: Vec<_> = fields.entries.iter().map(open).collect();
        let mut bodies = Self {
            list: Vec::new(),
            by_name: HashMap::new(),
            ground: ground(fields, &tables),
            numbers: Vec::new(),
            log: fields.log(),
        };
        for (k, (entry, table)) in fields.entries.iter().zip(&tables).enumerate() {
            check("a body", entry);
            bodies.by_name.insert(entry.name, k);
            let is_ground = bodies.ground == Some(k);
            let numbers = &mut bodies.numbers;
            let mut reader = BodyReader {
                id: k,
                is_ground,
                numbers,
            };
            bodies.list.push(reader.body(entry, table.as_ref()));
        }
        let with_inertia = bodies.list.iter().find_map(|b| b.inertia_at.as_ref());
        if let Some(at) = with_inertia {
            fields.units().require_inertia_unit(at, fields.log());
        }
        bodies
    }

    /// Index of the body of that name.
    pub(crate) fn position(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The body of that name; `at` is where the text names it.
    pub(crate) fn find(&self, name: &str, at: &Span) -> Option<BodyId> {
        if let Some(&k) = self.by_name.get(name) {
            return Some(BodyId(k));
        }
        let prefix = name.split_once('.').map_or("", |(body, _)| body);
        let help = if self.by_name.contains_key(prefix) {
            format!("a body is expected here, not one of its points: `{prefix}`")
        } else {
            self.log
                .choices(name, "bodies", self.list.iter().map(|b| b.name))
        };
        let diagnostic = self
            .log
            .error(format!("there is no body `{}`", shorten(name)));
        diagnostic.label(at, "unknown body").help(help).reject()
    }

    /// The two bodies that a value names, each with where.
    pub(crate) fn find_two(
        &self,
        value: Value<'_>,
        what: impl Display,
    ) -> Option<[(BodyId, Span); 2]> {
        let [(a, at_a), (b, at_b)] = value.two_strings("two bodies [\"body\", \"body\"]", what)?;
        let (first, second) = (self.find(a, &at_a), self.find(b, &at_b));
        Some([(first?, at_a), (second?, at_b)])
    }

    /// The point of a body named by `body.point`: (body, index of its point). Names hold no dot,
    /// so it is unambiguous.
    pub(crate) fn find_point(&self, text: &str, at: &Span) -> Option<(BodyId, usize)> {
        let Some((body, point)) = text.split_once('.') else {
            let named = self.by_name.get(text).map(|&k| &self.list[k]);
            let example = named.and_then(|body| body.points.first());
            let (body, point) = example.map_or(("body", "point"), |p| (text, p.name));
            let message = format!("`{}` does not name a point of a body", shorten(text));
            let diagnostic = self.log.error(message).label(at, "expected `body.point`");
            return diagnostic
                .help(format!("write it as `{body}.{point}`"))
                .reject();
        };
        let id = self.find(body, at)?;
        Some((id, self.point_of(id, point, at)?))
    }

    /// The two points that a value names; `expected` says how they are written.
    pub(crate) fn find_two_points(
        &self,
        value: Value<'_>,
        expected: &str,
        what: impl Display,
    ) -> Option<[NamedPoint; 2]> {
        let [(a, at_a), (b, at_b)] = value.two_strings(expected, what)?;
        let (first, second) = (self.find_point(a, &at_a), self.find_point(b, &at_b));
        let (first, second) = (first?, second?);
        Some([(first.0, first.1, at_a), (second.0, second.1, at_b)])
    }

    /// Where a point is in its body's frame, m.
    pub(crate) fn at(&self, point: &NamedPoint) -> Vec2 {
        self.list[point.0.0].points[point.1].at
    }

    /// Index of the point of that name of a body.
    pub(crate) fn point_of(&self, id: BodyId, point: &str, at: &Span) -> Option<usize> {
        let owner = &self.list[id.0];
        let found = owner.by_name.get(point).copied();
        if found.is_none() && owner.points_known {
            self.list[id.0].report_unknown_point(point, point, (at, "unknown point"), self.log);
        }
        found
    }

    /// Reports a `path` without a number, which the text names at `at`.
    pub(crate) fn check_number(&self, path: &str, at: &Span) {
        let path_of = |n: &BodyNumber| {
            let body = &self.list[n.body.0];
            n.path(body.name, |k| body.points[k].name)
        };
        let all: Vec<_> = self.numbers.iter().map(path_of).collect();
        if !all.iter().any(|p| p == path) {
            let (message, help) = no_number(path, &all);
            self.log
                .error(message)
                .label(at, "unknown number")
                .help(help)
                .report();
        }
    }

    /// Reports two places that name the same body where two bodies are needed. `message` is given the body's name.
    pub(crate) fn reject_same_body<T>(
        &self,
        body: BodyId,
        message: impl Fn(&str) -> String,
        labels: [(&Span, &str); 2],
        help: &str,
    ) -> Option<T> {
        let diagnostic = self.log.error(message(self.list[body.0].name));
        let [(a, first), (b, second)] = labels;
        diagnostic
            .label(a, first)
            .label(b, second)
            .help(help)
            .reject()
    }
}

impl ParsedBody<'_> {
    /// Reports a point that it does not have; `name` is what it may have been meant to be.
    fn report_unknown_point(
        &self,
        point: &str,
        name: &str,
        (at, label): (&Span, &str),
        log: &Diagnostics,
    ) {
        let body = shorten(self.name);
        let names = self.points.iter().map(|p| p.name);
        let help = log.choices(name, &format!("points of `{body}`"), names);
        let message = format!("body `{body}` has no point `{}`", shorten(point));
        log.error(message).label(at, label).help(help).report();
    }
}

/// Which body is the ground: the one that says `fixed = true`, or else the one named `ground`. If
/// both are there the scene is ambiguous, unless `ground` itself says that it moves.
fn ground(fields: &TableReader<'_>, tables: &[Option<TableReader<'_>>]) -> Option<usize> {
    let mut fixed = Vec::new();
    let mut named = None;
    for (k, (entry, table)) in fields.entries.iter().zip(tables).enumerate() {
        let given = table.as_ref().and_then(|t| t.get("fixed"));
        let value = given.and_then(|e| {
            let body = shorten(entry.name);
            e.value.boolean(format_args!("`fixed` of body `{body}`"))
        });
        match (given, value) {
            (Some(e), Some(true)) => fixed.push((k, e.span(), "fixed here")),
            (Some(_), Some(false)) => {}
            _ if entry.name == "ground" => {
                named = Some((k, entry.key.clone(), "fixed by its name"));
            }
            _ => {}
        }
    }
    fixed.extend(named);
    if fixed.is_empty() {
        fields
            .error("no body is fixed")
            .label(&fields.span, "one of these has to be the ground")
            .help("name the fixed body `ground`, or write `fixed = true` in it")
            .report();
    }
    if fixed.len() > 1 {
        let help = "a mechanism has one ground: put all its points into one body, \
                    or write `fixed = false` in a body that moves";
        let mut diagnostic = fields
            .error(format!("{} bodies are fixed", fixed.len()))
            .help(help);
        for (_, span, label) in fixed.iter().take(4) {
            diagnostic = diagnostic.label(span, *label);
        }
        diagnostic.report();
    }
    fixed.first().map(|(k, ..)| *k)
}

struct BodyReader<'r> {
    id: usize,
    is_ground: bool,
    numbers: &'r mut Vec<BodyNumber>,
}

impl BodyReader<'_> {
    fn body<'a>(&mut self, entry: &Entry<'a>, fields: Option<&TableReader<'a>>) -> ParsedBody<'a> {
        let mut body = ParsedBody {
            name: entry.name,
            key: entry.key.clone(),
            points: Vec::new(),
            by_name: HashMap::new(),
            points_known: false,
            mass: Mass::default(),
            mass_at: None,
            inertia_at: None,
            center_at: None,
        };
        let Some(fields) = fields else { return body };
        fields.reject_unknown_keys(table("body"));
        self.points(&mut body, fields);
        self.inertia(&mut body, fields);
        body
    }

    fn points<'a>(&mut self, body: &mut ParsedBody<'a>, fields: &TableReader<'a>) {
        let name = shorten(body.name);
        let entry = fields.get("points");
        let points = entry.map(|e| TableReader::open(e, format!("the points of `{name}`")));
        let Some(points) = points.map_or(Some(Vec::new()), |p| Some(p?.entries)) else {
            return;
        };
        if points.is_empty() {
            let at = entry.map_or(&body.key, |e| &e.key);
            let diagnostic = fields.error(format!("body `{name}` has no points"));
            let help = "a body is joined at its points: `points = { A = [0, 0] }`";
            return diagnostic.label(at, "no points").help(help).report();
        }
        body.points_known = true;
        for (k, point) in points.iter().enumerate() {
            check("a point", point);
            let what = format!("point `{}` of `{name}`", shorten(point.name));
            let at = self.vector(point.value, &what, |axis| BodyField::Point(k, axis));
            body.by_name.insert(point.name, k);
            body.points.push(ParsedPoint {
                name: point.name,
                at: at.unwrap_or(Vec2::ZERO),
                span: point.key.clone(),
            });
        }
    }

    fn inertia<'a>(&mut self, body: &mut ParsedBody<'a>, fields: &TableReader<'a>) {
        let units = fields.units();
        let mass = self.mass_or_inertia(fields, "mass", BodyField::Mass, &units.mass);
        let inertia = self.mass_or_inertia(fields, "inertia", BodyField::Inertia, &units.inertia);
        let [mass_at, inertia_at, center_at] =
            ["mass", "inertia", "center"].map(|key| fields.get(key).map(|e| e.value.span()));
        body.mass_at = mass_at;
        body.inertia_at = inertia_at;
        body.center_at = center_at;
        let center = fields
            .get("center")
            .and_then(|entry| self.center(body, entry.value));
        if self.is_ground {
            // It never moves: what it weighs has no effect, and must not appear in any balance.
            return;
        }
        if let (Some(mass), Some(span), None) = (mass, &body.mass_at, &body.center_at)
            && mass > 0.0
        {
            let name = shorten(body.name);
            fields
                .error(format!("body `{name}` has a mass but no centre of mass"))
                .label(span, "no centre of mass")
                .help("add `center`: the name of one of its points, or [x, y]")
                .report();
        }
        body.mass = Mass {
            mass: mass.unwrap_or(0.0),
            center: center.unwrap_or(Vec2::ZERO),
            inertia: inertia.unwrap_or(0.0),
        };
    }

    /// A mass or an inertia, in SI: not negative.
    fn mass_or_inertia(
        &mut self,
        fields: &TableReader<'_>,
        key: &str,
        field: BodyField,
        unit: &Unit,
    ) -> Option<f64> {
        let value = fields.get(key)?.value;
        let what = format!("{key} of {}", fields.what);
        let (written, si) = value.written_and_si(unit, &what)?;
        if written < 0.0 {
            let message = format!("the {what} is negative");
            return value.wrong(message, "expected 0 or more").reject();
        }
        self.record(field, written, value.span());
        Some(si)
    }

    fn center(&mut self, body: &ParsedBody<'_>, value: Value<'_>) -> Option<Vec2> {
        let DeValue::String(text) = value.get() else {
            let what = format!("the center of `{}`", shorten(body.name));
            return self.vector(value, &what, BodyField::Center);
        };
        let point = body.by_name.get(text.as_ref());
        if point.is_none() && body.points_known {
            // `crank.A` is understood, but written as everywhere else it would be one more rule.
            let without_body = text
                .strip_prefix(body.name)
                .and_then(|t| t.strip_prefix('.'));
            let name = without_body.unwrap_or(text);
            let at = (&value.span(), "unknown point of this body");
            body.report_unknown_point(text, name, at, value.log());
        }
        point.map(|&k| body.points[k].at)
    }

    fn vector(
        &mut self,
        value: Value<'_>,
        what: &str,
        field: impl Fn(usize) -> BodyField,
    ) -> Option<Vec2> {
        let values = value.pair(POINT, what)?;
        let mut component = |axis: usize| {
            let value = values[axis];
            let what = format_args!("{} of {what}", ["x", "y"][axis]);
            let (written, si) = value.written_and_si(&value.units().length, what)?;
            self.record(field(axis), written, value.span());
            Some(si)
        };
        let (x, y) = (component(0), component(1));
        Some(vec2(x?, y?))
    }

    fn record(&mut self, field: BodyField, value: f64, span: Span) {
        let has_effect = !self.is_ground || matches!(field, BodyField::Point(..));
        if has_effect {
            let body = BodyId(self.id);
            self.numbers.push(BodyNumber {
                body,
                field,
                value,
                span,
            });
        }
    }
}
