//! The bodies: their points, their masses, and which of them is the ground.

use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::{Dimensions, Notation, Plane, mass_or_inertia};
use crate::names::check;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::varying_inertia::varying_inertia;
use crate::wording::shorten;
use dwell_geometry::BodyId;
use dwell_kinetostatics::VaryingInertia;
use std::collections::HashMap;
use std::fmt::Display;
use toml::de::DeValue;

/// A body as read. Values that could not be read are zero: the scene is rejected anyway, and the names serve to check
/// the rest of the file.
#[derive(Debug)]
pub(crate) struct ParsedBody<'a, D: Dimensions = Plane> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    /// In m.
    pub(crate) points: Vec<(&'a str, D::Point)>,
    by_name: HashMap<&'a str, usize>,
    /// Whether its points were read, so that a name that is not among them does not exist.
    points_known: bool,
    pub(crate) mass: D::Mass,
    pub(crate) varying_inertia: Option<VaryingInertia>,
}

/// A point that a text names: its body, its index there, and the place of the name.
pub(crate) type NamedPoint = (BodyId, usize, Span);

/// How two points are written.
pub(crate) const TWO_POINTS: &str = "two points [\"body.point\", \"body.point\"]";

/// All the bodies as read.
#[derive(Debug)]
pub(crate) struct Bodies<'a, D: Dimensions = Plane> {
    pub(crate) list: Vec<ParsedBody<'a, D>>,
    by_name: HashMap<&'a str, usize>,
    pub(crate) ground: Option<usize>,
    pub(crate) log: &'a Diagnostics,
}

impl<'a, D: Notation> Bodies<'a, D> {
    pub(crate) fn read(fields: &TableReader<'a>) -> Self {
        let open = |e| TableReader::open(e, format!("body `{}`", shorten(e.name)));
        let tables: Vec<_> = fields.entries.iter().map(open).collect();
        let mut bodies = Self {
            list: Vec::new(),
            by_name: HashMap::new(),
            ground: ground(fields, &tables),
            log: fields.log(),
        };
        for (k, (entry, table)) in fields.entries.iter().zip(&tables).enumerate() {
            check("a body", entry);
            bodies.by_name.insert(entry.name, k);
            let is_ground = bodies.ground == Some(k);
            let body = read_body(entry, table.as_ref(), BodyId(k), is_ground);
            bodies.list.push(body);
        }
        let mut inertias = tables
            .iter()
            .flatten()
            .filter_map(|t| t.get("inertia").or_else(|| t.get("varying-inertia")));
        if let Some(entry) = inertias.next() {
            let at = &entry.value.span();
            fields.units().require_inertia_unit(at, fields.log());
        }
        bodies
    }

    /// The named points of each, in its frame, m.
    pub(crate) fn named_points(&self) -> Vec<Vec<(String, D::Point)>> {
        let of_body = |body: &ParsedBody<'_, D>| {
            let points = body.points.iter();
            let named = points.map(|(name, at)| (str::to_owned(name), *at));
            named.collect()
        };
        self.list.iter().map(of_body).collect()
    }

    /// The moments of inertia that are functions of angles.
    pub(crate) fn varying_inertias(&self) -> Vec<VaryingInertia> {
        let varying = self.list.iter().filter_map(|b| b.varying_inertia.clone());
        varying.collect()
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
        let message = format!("there is no body `{}`", shorten(name));
        self.log.reject(message, &[(at, "unknown body")], help)
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
            let (body, point) = example.map_or(("body", "point"), |(point, _)| (text, *point));
            let message = format!("`{}` does not name a point of a body", shorten(text));
            let help = format!("write it as `{body}.{point}`");
            return (self.log).reject(message, &[(at, "expected `body.point`")], help);
        };
        let id = self.find(body, at)?;
        Some((id, self.point_of(id, point, at)?))
    }

    /// The two points that a value names; `expected` describes the notation.
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
    pub(crate) fn at(&self, point: &NamedPoint) -> D::Point {
        self.list[point.0.0].points[point.1].1
    }

    /// Index of the point of that name of a body.
    pub(crate) fn point_of(&self, id: BodyId, point: &str, at: &Span) -> Option<usize> {
        let owner = &self.list[id.0];
        let found = owner.by_name.get(point).copied();
        if found.is_none() && owner.points_known {
            self.list[id.0].report_unknown_point(point, point, at, "unknown point", self.log);
        }
        found
    }

    /// The two bodies, or an error if they are the same. `message` is given the body's name.
    pub(crate) fn require_different(
        &self,
        [a, b]: [(BodyId, &Span); 2],
        message: impl Fn(&str) -> String,
        help: &str,
    ) -> Option<[BodyId; 2]> {
        if a.0 != b.0 {
            return Some([a.0, b.0]);
        }
        let labels = [(a.1, "this body"), (b.1, "and the same again")];
        (self.log).reject(message(self.list[a.0.0].name), &labels, help)
    }
}

impl<D: Notation> ParsedBody<'_, D> {
    /// Reports a point that the body does not have; `name` selects the suggestion.
    fn report_unknown_point(
        &self,
        point: &str,
        name: &str,
        at: &Span,
        label: &str,
        log: &Diagnostics,
    ) {
        let body = shorten(self.name);
        let names = self.points.iter().map(|(name, _)| *name);
        let help = log.choices(name, &format!("points of `{body}`"), names);
        let message = format!("body `{body}` has no point `{}`", shorten(point));
        log.report(message, &[(at, label)], help);
    }
}

/// The index of the ground: the body with `fixed = true`, or else the body named `ground`. If both exist, the scene is
/// ambiguous, unless `ground` has `fixed = false`.
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
        let labels = [(&fields.span, "one of these has to be the ground")];
        let help = "name the fixed body `ground`, or write `fixed = true` in it";
        fields.log().report("no body is fixed", &labels, help);
    }
    if fixed.len() > 1 {
        let message = format!("{} bodies are fixed", fixed.len());
        let labels = fixed.iter().take(4).map(|(_, at, label)| (at, *label));
        let help = "a mechanism has one ground: put all its points into one body, \
                    or write `fixed = false` in a body that moves";
        fields
            .log()
            .report(message, &labels.collect::<Vec<_>>(), help);
    }
    fixed.first().map(|(k, ..)| *k)
}

fn read_body<'a, D: Notation>(
    entry: &Entry<'a>,
    fields: Option<&TableReader<'a>>,
    id: BodyId,
    is_ground: bool,
) -> ParsedBody<'a, D> {
    let mut body = ParsedBody {
        name: entry.name,
        key: entry.key.clone(),
        points: Vec::new(),
        by_name: HashMap::new(),
        points_known: false,
        mass: D::Mass::default(),
        varying_inertia: None,
    };
    entry.place(SceneLocation::Body(id));
    let Some(fields) = fields else { return body };
    fields.reject_unknown_keys(D::table("body"));
    body.read_points(id, fields);
    fields.place("mass", SceneLocation::Mass(id));
    fields.place("inertia", SceneLocation::Inertia(id));
    fields.place("center", SceneLocation::Center(id));
    let mass = body.read_mass(fields, is_ground);
    let varying = if D::table("body").contains_key("varying-inertia") {
        varying_inertia(fields, id, body.name)
    } else {
        None
    };
    // The ground never moves: what it weighs has no effect, and must not appear in any balance.
    if !is_ground {
        body.mass = mass;
        body.varying_inertia = varying;
    }
    body
}

impl<'a, D: Notation> ParsedBody<'a, D> {
    fn read_points(&mut self, id: BodyId, fields: &TableReader<'a>) {
        let name = shorten(self.name);
        let entry = fields.get("points");
        let points = entry.map(|e| TableReader::open(e, format!("the points of `{name}`")));
        let Some(points) = points.map_or(Some(Vec::new()), |p| Some(p?.entries)) else {
            return;
        };
        if points.is_empty() {
            let at = entry.map_or(&self.key, |e| &e.key);
            let message = format!("body `{name}` has no points");
            let help = format!(
                "a body is joined at its points: `points = {{ A = {} }}`",
                D::ORIGIN
            );
            return fields.log().report(message, &[(at, "no points")], help);
        }
        self.points_known = true;
        for (k, point) in points.iter().enumerate() {
            check("a point", point);
            let what = format!("point `{}` of `{name}`", shorten(point.name));
            let at = D::point(point.value, &what).unwrap_or_default();
            self.by_name.insert(point.name, k);
            self.points.push((point.name, at));
            point.place(SceneLocation::Point(id, k));
        }
    }

    fn read_mass(&self, fields: &TableReader<'a>, is_ground: bool) -> D::Mass {
        let mass = mass_or_inertia(fields, "mass", &fields.units().mass);
        let given = fields.get("center");
        let center = given.and_then(|entry| self.read_center(entry.value));
        if let (false, Some(entry), None) = (is_ground, fields.get("mass"), given)
            && mass.is_some_and(|mass| mass > 0.0)
        {
            let message = format!(
                "body `{}` has a mass but no centre of mass",
                shorten(self.name)
            );
            let labels = [(&entry.value.span(), "no centre of mass")];
            let help = format!(
                "add `center`: the name of one of its points, or {}",
                D::POINT
            );
            fields.log().report(message, &labels, help);
        }
        D::mass(mass.unwrap_or(0.0), center.unwrap_or_default(), fields)
    }

    fn read_center(&self, value: Value<'_>) -> Option<D::Point> {
        let DeValue::String(text) = value.get() else {
            return D::point(value, &format!("the center of `{}`", shorten(self.name)));
        };
        let point = self.by_name.get(text.as_ref());
        if point.is_none() && self.points_known {
            // `crank.A` is understood, but written as everywhere else it would be one more rule.
            let behind_name = text.strip_prefix(self.name);
            let meant = behind_name
                .and_then(|t| t.strip_prefix('.'))
                .unwrap_or(text);
            let label = "unknown point of this body";
            self.report_unknown_point(text, meant, &value.span(), label, value.log());
        }
        point.map(|&k| self.points[k].1)
    }
}
