//! The requested results.

use crate::bodies::Bodies;
use crate::diagnostics::Span;
use crate::dimensions::Dimensions;
use crate::joints::Joints;
use crate::keys::table;
use crate::plane_scene::{DwellRequest, PathPoint, Requests, SectionRequest};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::wording::shorten;
use dwell_geometry::{BodyId, Component, Joint, JointId, Reaction};
use std::collections::HashSet;

/// `[requests]`, without reactions where it does not have that key.
pub(crate) fn requests(
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
    joints: &Joints<'_>,
) -> Requests {
    fields.reject_unknown_keys(table("requests"));
    fields.place("dwell", SceneLocation::Dwell);
    let reactions = fields.get("reactions").map(|e| reactions_of(e, joints));
    let paths = fields.get("paths").map(|e| path_points(e, bodies));
    let dwell = fields.get("dwell").and_then(|e| dwell_of(e, bodies));
    let variables = fields.get("variables").map(variables_of);
    let sections = fields.get("sections");
    let sections = sections.map(|e| sections_of(e.value, bodies));
    Requests {
        lists_reactions: reactions.is_some(),
        reactions: reactions.unwrap_or_default(),
        paths: paths.unwrap_or_default(),
        dwell,
        variables,
        sections: sections.unwrap_or_default(),
    }
}

/// The strings of an array, those that are none being reported.
pub(crate) fn strings<'a>(entry: &Entry<'a>, expected: &str) -> Vec<(&'a str, Span)> {
    let what = format!("{} in [requests]", entry.name);
    let values = entry.value.array(expected, &what).into_iter().flatten();
    let one = |value: Value<'a>| {
        let text = value.string(format_args!("an entry of {what}"))?;
        Some((text, value.span()))
    };
    values.filter_map(one).collect()
}

fn reactions_of(entry: &Entry<'_>, joints: &Joints<'_>) -> Vec<Reaction> {
    let (mut requested, mut reactions) = (HashSet::new(), Vec::new());
    for (text, at) in strings(entry, "an array such as [\"slide.normal\"]") {
        let (name, component) = joint_and_component(text);
        for k in joints.find(name, &at).into_iter().flatten() {
            // A joint that could not be read has been reported already.
            let Some(joint) = &joints.list[k].joint else {
                continue;
            };
            let found = components(joint, component, joints, &at);
            if found.is_empty() {
                break;
            }
            for component in found {
                let reaction = Reaction {
                    joint: JointId(k),
                    component,
                };
                // Asked for twice, as `slide` and `slide.normal`, it is still one reaction.
                if requested.insert(reaction) {
                    let location = SceneLocation::Reaction(reactions.len());
                    entry.log().place(location, &at);
                    reactions.push(reaction);
                }
            }
        }
    }
    reactions
}

/// The parts of `joint.component`, of which the second may be absent.
pub(crate) fn joint_and_component(text: &str) -> (&str, Option<&str>) {
    match text.split_once('.') {
        Some((joint, component)) => (joint, Some(component)),
        None => (text, None),
    }
}

/// The named component of the joint's reaction, or all of them.
pub(crate) fn components(
    joint: &Joint,
    name: Option<&str>,
    joints: &Joints<'_>,
    at: &Span,
) -> Vec<Component> {
    let mut all = joint.kind.components(&joints.couplings).to_vec();
    if let Some(name) = name {
        let names = all.iter().map(|c| c.name());
        let kind = "components of its reaction";
        let help = joints.log.choices(name, kind, names);
        all.retain(|c| c.name() == name);
        if all.is_empty() {
            let (joint, name) = (&joint.name, shorten(name));
            let message = format!("the reaction of joint `{joint}` has no component `{name}`");
            let labels = [(at, "unknown component")];
            joints.log.report(message, &labels, help);
        }
    }
    all
}

/// The points of moving bodies in a list, each once.
pub(crate) fn path_points<D: Dimensions>(
    entry: &Entry<'_>,
    bodies: &Bodies<'_, D>,
) -> Vec<PathPoint<D::Point>> {
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

/// The moving body that a value names; of the ground, the message says `lacks`.
fn moving_body(
    value: Value<'_>,
    what: &str,
    lacks: &str,
    help: &str,
    bodies: &Bodies<'_>,
) -> Option<BodyId> {
    let name = value.string(what)?;
    let body = bodies.find(name, &value.span())?;
    if bodies.ground == Some(body.0) {
        let message = format!("`{}` is the ground, which {lacks}", shorten(name));
        return value.reject(message, "not a moving body", help);
    }
    Some(body)
}

fn dwell_of(entry: &Entry<'_>, bodies: &Bodies<'_>) -> Option<DwellRequest> {
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
pub(crate) fn variables_of(entry: &Entry<'_>) -> Vec<String> {
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
fn sections_of(value: Value<'_>, bodies: &Bodies<'_>) -> Vec<SectionRequest> {
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

fn section_of(value: Value<'_>, bodies: &Bodies<'_>) -> Option<SectionRequest> {
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
