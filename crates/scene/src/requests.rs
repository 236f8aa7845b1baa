//! The requested results.

use crate::bodies::Bodies;
use crate::coordinates::{CoordinateNotation, Parts};
use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::Notation;
use crate::keys::table;
use crate::scene_data::{DwellRequest, PathPoint, Requests, SectionRequest};
use crate::sections::reject_other_keys;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::wording::{list, shorten};
use dwell_geometry::BodyId;
use std::collections::HashSet;

/// How reactions are written in the plane or in space.
pub(crate) trait ReactionNotation: CoordinateNotation {
    /// A list of reactions in messages.
    const REACTIONS: &'static str;

    /// The reactions that a text at a place names; an unknown name is reported.
    fn reactions_named(text: &str, at: &Span, parts: &Parts<'_, '_, Self>) -> Vec<Self::Reaction>;

    /// The name of a reaction of these joints.
    fn name_of_reaction(reaction: Self::Reaction, joints: &Self::Joints<'_>) -> String;
}

/// Reads `[requests]`, without reactions if it does not have this key.
pub(crate) fn requests<D: ReactionNotation>(
    fields: &TableReader<'_>,
    parts: &Parts<'_, '_, D>,
) -> Requests<D::Point, D::Reaction> {
    reject_other_keys::<D>(fields, "requests", |key| {
        let help = "leave it out: a dwell is that of an angle, and internal forces are computed in the plane only";
        (format!("`{key}` in [requests]"), help)
    });
    fields.place("dwell", SceneLocation::Dwell);
    let known = D::table("requests");
    let get = |key: &str| fields.get(key).filter(|_| known.contains_key(key));
    let reactions = get("reactions").map(|e| reactions_of(e, parts));
    let paths = get("paths").map(|e| path_points(e, parts.bodies));
    let dwell = get("dwell").and_then(|e| dwell_of(e, parts.bodies));
    let variables = get("variables").map(variables_of);
    let sections = get("sections").map(|e| sections_of(e.value, parts.bodies));
    Requests {
        lists_reactions: reactions.is_some(),
        reactions: reactions.unwrap_or_default(),
        paths: paths.unwrap_or_default(),
        dwell,
        variables,
        sections: sections.unwrap_or_default(),
    }
}

/// The strings of an array; other values are reported.
fn strings<'a>(entry: &Entry<'a>, expected: &str) -> Vec<(&'a str, Span)> {
    let what = format!("{} in [requests]", entry.name);
    let values = entry.value.array(expected, &what).into_iter().flatten();
    let one = |value: Value<'a>| {
        let text = value.string(format_args!("an entry of {what}"))?;
        Some((text, value.span()))
    };
    values.filter_map(one).collect()
}

fn reactions_of<D: ReactionNotation>(
    entry: &Entry<'_>,
    parts: &Parts<'_, '_, D>,
) -> Vec<D::Reaction> {
    let (mut requested, mut reactions) = (HashSet::new(), Vec::new());
    for (text, at) in strings(entry, D::REACTIONS) {
        for reaction in D::reactions_named(text, &at, parts) {
            // Asked for twice, as `slide` and `slide.normal`, it is still one reaction.
            if requested.insert(reaction) {
                let location = SceneLocation::Reaction(reactions.len());
                entry.log().place(location, &at);
                reactions.push(reaction);
            }
        }
    }
    reactions
}

/// The one reaction that a text at a place in a table names.
pub(crate) fn one_reaction<D: ReactionNotation>(
    text: &str,
    at: &Span,
    fields: &TableReader<'_>,
    parts: &Parts<'_, '_, D>,
) -> Option<D::Reaction> {
    let all = D::reactions_named(text, at, parts);
    if let [] | [_] = all[..] {
        return all.first().copied();
    }
    let message = format!("{} names {} reactions", fields.what, all.len());
    let names: Vec<_> = all
        .iter()
        .map(|r| D::name_of_reaction(*r, parts.joints))
        .collect();
    let choices = list(names.iter().map(String::as_str)).unwrap_or_default();
    let help = format!("name one of {choices}");
    fields
        .log()
        .reject(message, &[(at, "which of them?")], help)
}

/// The parts of `joint.component`, of which the second may be absent.
pub(crate) fn joint_and_component(text: &str) -> (&str, Option<&str>) {
    match text.split_once('.') {
        Some((joint, component)) => (joint, Some(component)),
        None => (text, None),
    }
}

/// The component of that name of a joint's reaction, of those that it has.
pub(crate) fn component_named<C: Copy>(
    name: &str,
    joint: &str,
    all: &[(&str, C)],
    at: &Span,
    log: &Diagnostics,
) -> Option<C> {
    let found = all.iter().find(|(known, _)| *known == name);
    if found.is_none() {
        let names = all.iter().map(|(known, _)| *known);
        let help = log.choices(name, "components of its reaction", names);
        let name = shorten(name);
        let message = format!("the reaction of joint `{joint}` has no component `{name}`");
        log.report(message, &[(at, "unknown component")], help);
    }
    found.map(|(_, component)| *component)
}

/// The points of moving bodies in a list, each once.
fn path_points<D: Notation>(entry: &Entry<'_>, bodies: &Bodies<'_, D>) -> Vec<PathPoint<D::Point>> {
    let (mut requested, mut paths) = (HashSet::new(), Vec::new());
    for (text, span) in strings(entry, "an array such as [\"coupler.P\"]") {
        let Some((body, k)) = bodies.find_point(text, &span) else {
            continue;
        };
        if bodies.ground == Some(body.0) {
            let message = format!("`{}` is a point of the ground", shorten(text));
            let help = "ask for a point of a moving body";
            entry
                .log()
                .report(message, &[(&span, "it has no path")], help);
        } else if requested.insert((body, k)) {
            let location = SceneLocation::Path(paths.len());
            entry.log().place(location, &span);
            let (name, at) = bodies.list[body.0].points[k];
            let name = name.to_owned();
            paths.push(PathPoint { body, name, at });
        }
    }
    paths
}

/// The moving body that a value names; for the ground, `lacks` is part of the error message.
fn moving_body<D: Notation>(
    value: Value<'_>,
    what: &str,
    lacks: &str,
    help: &str,
    bodies: &Bodies<'_, D>,
) -> Option<BodyId> {
    let name = value.string(what)?;
    let body = bodies.find(name, &value.span())?;
    if bodies.ground == Some(body.0) {
        let message = format!("`{}` is the ground, which {lacks}", shorten(name));
        return value.reject(message, "not a moving body", help);
    }
    Some(body)
}

fn dwell_of<D: Notation>(entry: &Entry<'_>, bodies: &Bodies<'_, D>) -> Option<DwellRequest> {
    let fields = TableReader::open(entry, "dwell in [requests]")?;
    fields.reject_unknown_keys(table("dwell"));
    let (Some(body), Some(band)) = (fields.get("body"), fields.get("relative-band")) else {
        let message = "dwell in [requests] needs a body and a band";
        let help = "write `dwell = { body = \"guide\", relative-band = 0.02 }`";
        return entry.value.reject(message, "incomplete", help);
    };
    let body = moving_body(body.value, "the body of dwell", "does not move", "", bodies);
    let relative_band = band.value.number("the band of dwell")?;
    if !(relative_band > 0.0 && relative_band < 1.0) {
        let message = "the band of a dwell is a fraction of the body's angular range";
        let label = "expected a number between 0 and 1";
        return band.value.reject(message, label, "");
    }
    Some(DwellRequest {
        body: body?,
        relative_band,
    })
}

/// The names of columns, each once.
fn variables_of(entry: &Entry<'_>) -> Vec<String> {
    let mut requested = HashSet::new();
    let mut names = strings(entry, "an array such as [\"crank.angle\"]");
    names.retain(|(name, _)| requested.insert(*name));
    for (k, (_, at)) in names.iter().enumerate() {
        entry.log().place(SceneLocation::Variable(k), at);
    }
    let names = names.into_iter();
    names.map(|(name, _)| name.to_owned()).collect()
}

/// The links, each once.
fn sections_of<D: Notation>(
    value: Value<'_>,
    bodies: &Bodies<'_, D>,
) -> Vec<SectionRequest<D::Point>> {
    let expected = "an array such as [{ body = \"rod\", from = \"B\", to = \"P\" }]";
    let values = value.array(expected, "sections in [requests]");
    let mut sections = Vec::new();
    for value in values.into_iter().flatten() {
        if let Some(section) = section_of(value, bodies)
            && !sections.contains(&section)
        {
            let location = SceneLocation::Section(sections.len());
            value.log().place(location, &value.span());
            sections.push(section);
        }
    }
    sections
}

fn section_of<D: Notation>(
    value: Value<'_>,
    bodies: &Bodies<'_, D>,
) -> Option<SectionRequest<D::Point>> {
    let what = "a section in [requests]";
    let fields = TableReader::of_value(value, value.span(), what)?;
    fields.reject_unknown_keys(table("section"));
    let help = "write it as `{ body = \"rod\", from = \"B\", to = \"P\" }`";
    let [body, from, to] = ["body", "from", "to"].map(|key| fields.require(key, help));
    let help = "ask for the sections of a moving body";
    let (value, named) = (body?.value, fields.name_of(body?));
    let id = moving_body(value, &named, "has no sections", help, bodies)?;
    let body = &bodies.list[id.0];
    let end = |entry: Option<&Entry<'_>>| {
        let (entry, at) = (entry?, entry?.value.span());
        let name = entry.value.string(fields.name_of(entry))?;
        Some((&body.points[bodies.point_of(id, name, &at)?], at))
    };
    let (from, to) = (end(from), end(to));
    let ((from, at_from), (to, at_to)) = (from?, to?);
    if from.1 == to.1 {
        let message = format!("{what} of `{}` has no length", shorten(body.name));
        let labels = [(&at_from, "from here"), (&at_to, "to the same place")];
        let help = "give two points that are apart";
        return fields.log().reject(message, &labels, help);
    }
    Some(SectionRequest {
        body: id,
        names: [from, to].map(|(name, _)| (*name).to_owned()),
        points: [from.1, to.1],
    })
}
