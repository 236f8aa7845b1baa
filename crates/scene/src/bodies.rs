//! The bodies: their points, their masses, and which of them is the ground.

use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::keys;
use crate::names::check;
use crate::number_paths::{BodyField, BodyNumber, no_number};
use crate::table_reader::{Entry, POINT, TableReader, Value, boolean, pair, quantity, two_strings};
use crate::units::{Unit, Units};
use crate::wording::shorten;
use dwell_geometry::{BodyId, Vec2, vec2};
use dwell_kinetostatics::Mass;
use std::collections::HashMap;
use std::fmt::Arguments;
use toml::de::DeValue;

/// A body as read. What could not be read is zero: the scene fails anyway, and the names still
/// serve to judge the rest of the file.
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
#[derive(Debug, Default)]
pub(crate) struct Bodies<'a> {
    pub(crate) list: Vec<ParsedBody<'a>>,
    by_name: HashMap<&'a str, usize>,
    pub(crate) ground: Option<usize>,
    /// The numbers a calibration or a study may change.
    pub(crate) numbers: Vec<BodyNumber>,
}

impl<'a> Bodies<'a> {
    pub(crate) fn read(
        fields: &TableReader<'a>,
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let tables: Vec<_> = fields
            .entries
            .iter()
            .map(|e| TableReader::open(e, format!("body `{}`", shorten(e.name)), diagnostics))
            .collect();
        let ground = ground(fields, &tables, diagnostics);
        let mut bodies = Self {
            ground,
            ..Self::default()
        };
        for (k, (entry, table)) in fields.entries.iter().zip(&tables).enumerate() {
            check("a body", entry.name, &entry.key, diagnostics);
            bodies.by_name.insert(entry.name, k);
            let mut reader = BodyReader {
                id: k,
                is_ground: ground == Some(k),
                units,
                numbers: &mut bodies.numbers,
                diagnostics,
            };
            bodies.list.push(reader.body(entry, table.as_ref()));
        }
        let with_inertia = bodies.list.iter().find_map(|b| b.inertia_at.as_ref());
        if let Some(at) = with_inertia {
            units.require_inertia_unit(at, diagnostics);
        }
        bodies
    }

    /// Index of the body of that name.
    pub(crate) fn position(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The body of that name; `at` is where the text names it.
    pub(crate) fn find(
        &self,
        name: &str,
        at: &Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<BodyId> {
        if let Some(&k) = self.by_name.get(name) {
            return Some(BodyId(k));
        }
        let prefix = name.split_once('.').map_or("", |(body, _)| body);
        let help = if self.by_name.contains_key(prefix) {
            format!("a body is expected here, not one of its points: `{prefix}`")
        } else {
            diagnostics.choices(name, "bodies", self.list.iter().map(|b| b.name))
        };
        diagnostics.push(
            Diagnostic::new(format!("there is no body `{}`", shorten(name)))
                .label(at.clone(), "unknown body")
                .help(help),
        );
        None
    }

    /// The two bodies that a value names, each with where.
    pub(crate) fn find_two(
        &self,
        value: &Value<'_>,
        what: Arguments<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<[(BodyId, Span); 2]> {
        let expected = "two bodies [\"body\", \"body\"]";
        let [(a, at_a), (b, at_b)] = two_strings(value, expected, what, diagnostics)?;
        let first = self.find(a, &at_a, diagnostics);
        let second = self.find(b, &at_b, diagnostics);
        Some([(first?, at_a), (second?, at_b)])
    }

    /// The point of a body named by `body.point`: (body, index of its point). Names hold no dot,
    /// so there is one way to read it.
    pub(crate) fn find_point(
        &self,
        text: &str,
        at: &Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<(BodyId, usize)> {
        let Some((body, point)) = text.split_once('.') else {
            let example = match self.by_name.get(text).map(|&k| &self.list[k]) {
                Some(body) => body.points.first().map(|p| (text, p.name)),
                None => None,
            };
            let (body, point) = example.unwrap_or(("body", "point"));
            diagnostics.push(
                Diagnostic::new(format!(
                    "`{}` does not name a point of a body",
                    shorten(text)
                ))
                .label(at.clone(), "expected `body.point`")
                .help(format!("write it as `{body}.{point}`")),
            );
            return None;
        };
        let id = self.find(body, at, diagnostics)?;
        Some((id, self.point_of(id, point, at, diagnostics)?))
    }

    /// The two points that a value names; `expected` says how they are written.
    pub(crate) fn find_two_points(
        &self,
        value: &Value<'_>,
        expected: &str,
        what: Arguments<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<[NamedPoint; 2]> {
        let [(a, at_a), (b, at_b)] = two_strings(value, expected, what, diagnostics)?;
        let first = self.find_point(a, &at_a, diagnostics);
        let second = self.find_point(b, &at_b, diagnostics);
        let (first, second) = (first?, second?);
        Some([(first.0, first.1, at_a), (second.0, second.1, at_b)])
    }

    /// Where a point is in its body's frame, m.
    pub(crate) fn at(&self, point: &NamedPoint) -> Vec2 {
        self.list[point.0.0].points[point.1].at
    }

    /// Index of the point of that name of a body.
    pub(crate) fn point_of(
        &self,
        id: BodyId,
        point: &str,
        at: &Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<usize> {
        let owner = &self.list[id.0];
        if let Some(&k) = owner.by_name.get(point) {
            return Some(k);
        }
        if owner.points_known {
            let body = shorten(owner.name);
            let kind = format!("points of `{body}`");
            let help = diagnostics.choices(point, &kind, owner.points.iter().map(|p| p.name));
            diagnostics.push(
                Diagnostic::new(format!("body `{body}` has no point `{}`", shorten(point)))
                    .label(at.clone(), "unknown point")
                    .help(help),
            );
        }
        None
    }

    /// Says so if there is no number at `path`, which the text names at `at`.
    pub(crate) fn check_number(&self, path: &str, at: &Span, diagnostics: &mut Diagnostics) {
        let path_of = |n: &BodyNumber| {
            let body = &self.list[n.body.0];
            n.path(body.name, |k| body.points[k].name)
        };
        let all: Vec<_> = self.numbers.iter().map(path_of).collect();
        if !all.iter().any(|p| p == path) {
            let (message, help) = no_number(path, &all);
            diagnostics.push(
                Diagnostic::new(message)
                    .label(at.clone(), "unknown number")
                    .help(help),
            );
        }
    }
}

/// Which body is the ground: the one that says `fixed = true`, or else the one named `ground`. If
/// both are there the scene is ambiguous, unless `ground` itself says that it moves.
fn ground(
    fields: &TableReader<'_>,
    tables: &[Option<TableReader<'_>>],
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let mut fixed = Vec::new();
    let mut named = None;
    for (k, (entry, table)) in fields.entries.iter().zip(tables).enumerate() {
        let fixed_entry = table.as_ref().and_then(|t| t.get("fixed"));
        let value = fixed_entry.map(|e| {
            let what = format_args!("`fixed` of body `{}`", shorten(entry.name));
            boolean(e.value, what, diagnostics)
        });
        match (fixed_entry, value.flatten()) {
            (Some(e), Some(true)) => {
                fixed.push((k, e.key.start..e.value.span().end, "fixed here"));
            }
            (Some(_), Some(false)) => {}
            _ if entry.name == "ground" => {
                named = Some((k, entry.key.clone(), "fixed by its name"));
            }
            _ => {}
        }
    }
    fixed.extend(named);
    if fixed.is_empty() {
        diagnostics.push(
            Diagnostic::new("no body is fixed")
                .label(fields.span.clone(), "one of these has to be the ground")
                .help("name the fixed body `ground`, or write `fixed = true` in it"),
        );
    }
    if fixed.len() > 1 {
        let mut diagnostic = Diagnostic::new(format!("{} bodies are fixed", fixed.len())).help(
            "a mechanism has one ground: put all its points into one body, \
             or write `fixed = false` in a body that moves",
        );
        for (_, span, label) in fixed.iter().take(4) {
            diagnostic = diagnostic.label(span.clone(), *label);
        }
        diagnostics.push(diagnostic);
    }
    fixed.first().map(|(k, ..)| *k)
}

struct BodyReader<'r> {
    id: usize,
    is_ground: bool,
    units: &'r Units,
    numbers: &'r mut Vec<BodyNumber>,
    diagnostics: &'r mut Diagnostics,
}

impl BodyReader<'_> {
    fn body<'a>(&mut self, entry: &Entry<'a>, table: Option<&TableReader<'a>>) -> ParsedBody<'a> {
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
        let Some(table) = table else { return body };
        table.reject_unknown_keys(keys::table("body"), self.diagnostics);
        self.points(&mut body, table);
        self.inertia(&mut body, table);
        body
    }

    fn points<'a>(&mut self, body: &mut ParsedBody<'a>, table: &TableReader<'a>) {
        let name = shorten(body.name);
        let entry = table.get("points");
        let points = match entry {
            Some(e) => {
                match TableReader::open(e, format!("the points of `{name}`"), self.diagnostics) {
                    Some(points) => points.entries,
                    None => return,
                }
            }
            None => Vec::new(),
        };
        if points.is_empty() {
            let at = entry.map_or(&body.key, |e| &e.key).clone();
            self.diagnostics.push(
                Diagnostic::new(format!("body `{name}` has no points"))
                    .label(at, "no points")
                    .help("a body is joined at its points: `points = { A = [0, 0] }`"),
            );
            return;
        }
        body.points_known = true;
        for (k, point) in points.iter().enumerate() {
            check("a point", point.name, &point.key, self.diagnostics);
            let what = format!("point `{}` of `{name}`", shorten(point.name));
            let at = self.vector(point, &what, |axis| BodyField::Point(k, axis));
            body.by_name.insert(point.name, k);
            body.points.push(ParsedPoint {
                name: point.name,
                at: at.unwrap_or(Vec2::ZERO),
                span: point.key.clone(),
            });
        }
    }

    fn inertia<'a>(&mut self, body: &mut ParsedBody<'a>, table: &TableReader<'a>) {
        let mass = self.mass_or_inertia(table, "mass", BodyField::Mass, &self.units.mass);
        let inertia =
            self.mass_or_inertia(table, "inertia", BodyField::Inertia, &self.units.inertia);
        let center = table.get("center");
        body.mass_at = table.get("mass").map(|e| e.value.span());
        body.inertia_at = table.get("inertia").map(|e| e.value.span());
        body.center_at = center.map(|e| e.value.span());
        let at = center.and_then(|entry| self.center(body, entry));
        if self.is_ground {
            // It never moves: what it weighs has no effect, and must not appear in any balance.
            return;
        }
        if let (Some(mass), Some(span), None) = (mass, &body.mass_at, center)
            && mass > 0.0
        {
            self.diagnostics.push(
                Diagnostic::new(format!(
                    "body `{}` has a mass but no centre of mass",
                    shorten(body.name)
                ))
                .label(span.clone(), "no centre of mass")
                .help("add `center`: the name of one of its points, or [x, y]"),
            );
        }
        body.mass = Mass {
            mass: mass.unwrap_or(0.0),
            center: at.unwrap_or(Vec2::ZERO),
            inertia: inertia.unwrap_or(0.0),
        };
    }

    /// A mass or an inertia, in SI: not negative.
    fn mass_or_inertia(
        &mut self,
        table: &TableReader<'_>,
        key: &str,
        field: BodyField,
        unit: &Unit,
    ) -> Option<f64> {
        let entry = table.get(key)?;
        let what = format_args!("{key} of {}", table.what);
        let (written, si) = quantity(entry.value, unit, what, self.diagnostics)?;
        if written < 0.0 {
            self.diagnostics.push(
                Diagnostic::new(format!("the {key} of {} is negative", table.what))
                    .label(entry.value.span(), "expected 0 or more"),
            );
            return None;
        }
        self.record(field, written, entry.value.span());
        Some(si)
    }

    fn center<'a>(&mut self, body: &ParsedBody<'a>, entry: &Entry<'a>) -> Option<Vec2> {
        let name = shorten(body.name);
        let DeValue::String(text) = entry.value.get_ref() else {
            return self.vector(entry, &format!("the center of `{name}`"), BodyField::Center);
        };
        let point = body.by_name.get(text.as_ref());
        if point.is_none() && body.points_known {
            // `crank.A` is understood, but written as everywhere else it would be one more rule.
            let point_name = text
                .strip_prefix(body.name)
                .and_then(|t| t.strip_prefix('.'));
            let kind = format!("points of `{name}`");
            let names = body.points.iter().map(|p| p.name);
            let help = self
                .diagnostics
                .choices(point_name.unwrap_or(text), &kind, names);
            self.diagnostics.push(
                Diagnostic::new(format!("body `{name}` has no point `{}`", shorten(text)))
                    .label(entry.value.span(), "unknown point of this body")
                    .help(help),
            );
        }
        point.map(|&k| body.points[k].at)
    }

    fn vector(
        &mut self,
        entry: &Entry<'_>,
        what: &str,
        field: impl Fn(usize) -> BodyField,
    ) -> Option<Vec2> {
        let values = pair(entry.value, POINT, format_args!("{what}"), self.diagnostics)?;
        let mut component = |axis: usize| {
            let value = values[axis];
            let letter = ["x", "y"][axis];
            let what = format_args!("{letter} of {what}");
            let (written, si) = quantity(value, &self.units.length, what, self.diagnostics)?;
            self.record(field(axis), written, value.span());
            Some(si)
        };
        let (x, y) = (component(0), component(1));
        Some(vec2(x?, y?))
    }

    fn record(&mut self, field: BodyField, value: f64, span: Span) {
        let has_effect = !self.is_ground || matches!(field, BodyField::Point(..));
        if has_effect {
            self.numbers.push(BodyNumber {
                body: BodyId(self.id),
                field,
                value,
                span,
            });
        }
    }
}
