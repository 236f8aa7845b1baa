//! What the reader of the results wants to know.

use crate::bodies::Bodies;
use crate::fields::{Entry, Fields, Value, array, mismatch, number, string};
use crate::joints::Joints;
use crate::keys;
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::scene::{DwellRequest, PathPoint, Section};
use dwell_geometry::{Component, Joint, JointId, Reaction, Relation};
use std::collections::HashSet;
use toml::de::DeValue;

/// `[requests]` as read, each with where it is asked for. No reactions: all of them.
#[derive(Debug, Default)]
pub(crate) struct RequestsText {
    pub(crate) reactions: Option<Vec<(Reaction, Span)>>,
    pub(crate) paths: Vec<(PathPoint, Span)>,
    pub(crate) dwell: Option<(DwellRequest, Span)>,
    pub(crate) variables: Option<Vec<(String, Span)>>,
    pub(crate) sections: Vec<(Section, Span)>,
}

impl RequestsText {
    pub(crate) fn read(
        fields: &Fields<'_>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        problems: &mut Problems,
    ) -> Self {
        fields.allow(&keys::REQUESTS, problems);
        let reactions = fields.get("reactions");
        let paths = fields.get("paths");
        let dwell = fields.get("dwell");
        let variables = fields.get("variables");
        let sections = fields.get("sections");
        Self {
            reactions: reactions.map(|e| reactions_of(e, joints, problems)),
            paths: paths.map_or_else(Vec::new, |e| paths_of(e, bodies, problems)),
            dwell: dwell.and_then(|e| Some((dwell_of(e, bodies, problems)?, e.value.span()))),
            variables: variables.map(|e| variables_of(e, problems)),
            sections: sections.map_or_else(Vec::new, |e| sections_of(e, bodies, problems)),
        }
    }
}

/// The strings of an array, those that are none being reported.
fn strings<'a>(entry: &Entry<'a>, expected: &str, problems: &mut Problems) -> Vec<(&'a str, Span)> {
    let what = format!("{} in [requests]", entry.name);
    let values = array(entry.value, expected, format_args!("{what}"), problems);
    let values = values.into_iter().flatten();
    let one = |value| {
        Some((
            string(value, format_args!("an entry of {what}"), problems)?,
            value.span(),
        ))
    };
    values.filter_map(one).collect()
}

fn reactions_of(
    entry: &Entry<'_>,
    joints: &Joints<'_>,
    problems: &mut Problems,
) -> Vec<(Reaction, Span)> {
    let mut asked = HashSet::new();
    let mut reactions = Vec::new();
    for (text, at) in strings(entry, "an array such as [\"slide.normal\"]", problems) {
        let (name, component) = match text.split_once('.') {
            Some((name, component)) => (name, Some(component)),
            None => (text, None),
        };
        let Some(range) = joints.find(name, &at, problems) else {
            continue;
        };
        for k in range {
            // A joint that could not be read has been reported already.
            let Some(joint) = &joints.list[k].joint else {
                continue;
            };
            let found = components(joint, component, &joints.relations, &at, problems);
            if found.is_empty() {
                break;
            }
            for component in found {
                let joint = JointId(k);
                let reaction = Reaction { joint, component };
                // Asked for twice, as `slide` and `slide.normal`, it is still one reaction.
                if asked.insert(reaction) {
                    reactions.push((reaction, at.clone()));
                }
            }
        }
    }
    reactions
}

/// The named component of the joint's reaction, or all of them.
fn components(
    joint: &Joint,
    name: Option<&str>,
    relations: &[Relation],
    at: &Span,
    problems: &mut Problems,
) -> Vec<Component> {
    let all = joint.kind.components(relations);
    let Some(name) = name else {
        return all.to_vec();
    };
    if let Some(component) = all.iter().copied().find(|c| c.name() == name) {
        return vec![component];
    }
    let help = problems.choices(
        name,
        "components of its reaction",
        all.iter().map(|c| c.name()),
    );
    let joint = &joint.name;
    problems.push(
        Problem::new(format!(
            "the reaction of joint `{joint}` has no component `{}`",
            shorten(name)
        ))
        .at(at.clone(), "unknown component")
        .help(help),
    );
    Vec::new()
}

fn paths_of(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Vec<(PathPoint, Span)> {
    let mut asked = HashSet::new();
    let mut paths = Vec::new();
    for (text, at) in strings(entry, "an array such as [\"coupler.P\"]", problems) {
        let Some((body, k)) = bodies.find_point(text, &at, problems) else {
            continue;
        };
        if bodies.ground == Some(body.0) {
            problems.push(
                Problem::new(format!("`{}` is a point of the ground", shorten(text)))
                    .at(at, "it has no path")
                    .help("ask for a point of a moving body"),
            );
            continue;
        }
        if asked.insert((body, k)) {
            let point = &bodies.list[body.0].points[k];
            let (name, at_body) = (point.name.to_owned(), point.at);
            paths.push((
                PathPoint {
                    body,
                    name,
                    at: at_body,
                },
                at,
            ));
        }
    }
    paths
}

fn dwell_of(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Option<DwellRequest> {
    let fields = Fields::open(entry, "dwell in [requests]", problems)?;
    fields.allow(&keys::DWELL, problems);
    let (Some(body), Some(band)) = (fields.get("body"), fields.get("band")) else {
        problems.push(
            Problem::new("dwell in [requests] needs a body and a band")
                .at(entry.value.span(), "incomplete")
                .help("write `dwell = { body = \"guide\", band = 0.02 }`"),
        );
        return None;
    };
    let name = string(body.value, format_args!("the body of dwell"), problems);
    let id = name.and_then(|name| bodies.find(name, &body.value.span(), problems));
    if let (Some(name), Some(id)) = (name, id)
        && bodies.ground == Some(id.0)
    {
        problems.push(
            Problem::new(format!(
                "`{}` is the ground: it always dwells",
                shorten(name)
            ))
            .at(body.value.span(), "not a moving body"),
        );
        return None;
    }
    let width = number(band.value, format_args!("the band of dwell"), problems)?;
    if !(width > 0.0 && width < 1.0) {
        problems.push(
            Problem::new("the band of dwell is a fraction of the swing")
                .at(band.value.span(), "expected a number between 0 and 1"),
        );
        return None;
    }
    Some(DwellRequest {
        body: id?,
        band: width,
    })
}

/// The names of columns, each once.
fn variables_of(entry: &Entry<'_>, problems: &mut Problems) -> Vec<(String, Span)> {
    let mut asked = HashSet::new();
    strings(entry, "an array such as [\"crank.angle\"]", problems)
        .into_iter()
        .filter(|(name, _)| asked.insert(*name))
        .map(|(name, at)| (name.to_owned(), at))
        .collect()
}

/// The links, each once.
fn sections_of(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Vec<(Section, Span)> {
    let expected = "an array such as [{ body = \"rod\", from = \"B\", to = \"P\" }]";
    let what = format_args!("sections in [requests]");
    let values = array(entry.value, expected, what, problems);
    let mut sections: Vec<(Section, Span)> = Vec::new();
    for value in values.into_iter().flatten() {
        let Some(section) = section_of(value, bodies, problems) else {
            continue;
        };
        if sections.iter().all(|(known, _)| *known != section) {
            sections.push((section, value.span()));
        }
    }
    sections
}

fn section_of(value: &Value<'_>, bodies: &Bodies<'_>, problems: &mut Problems) -> Option<Section> {
    let what = "a section in [requests]";
    let DeValue::Table(table) = value.get_ref() else {
        mismatch(value, "a table", format_args!("{what}"), problems);
        return None;
    };
    let fields = Fields::of(what, value.span(), table);
    fields.allow(&keys::SECTION, problems);
    let help = "write it as `{ body = \"rod\", from = \"B\", to = \"P\" }`";
    let [body, from, to] = ["body", "from", "to"].map(|key| {
        let entry = fields.need(key, &fields.span, help, problems)?;
        let what = format_args!("{key} of {what}");
        Some((string(entry.value, what, problems)?, entry.value.span()))
    });
    let (name, at) = body?;
    let body = bodies.find(name, &at, problems)?;
    if bodies.ground == Some(body.0) {
        problems.push(
            Problem::new(format!("`{}` is the ground: it is not cut", shorten(name)))
                .at(at, "not a moving body")
                .help("ask for the sections of a moving body"),
        );
        return None;
    }
    let from = from.and_then(|(name, at)| bodies.point_of(body, name, &at, problems).zip(Some(at)));
    let to = to.and_then(|(name, at)| bodies.point_of(body, name, &at, problems).zip(Some(at)));
    let ((from, at_from), (to, at_to)) = (from?, to?);
    let points = &bodies.list[body.0].points;
    let ends = [&points[from], &points[to]];
    if ends[0].at == ends[1].at {
        problems.push(
            Problem::new(format!("{what} of `{}` has no length", shorten(name)))
                .at(at_from, "from here")
                .at(at_to, "to the same place")
                .help("give two points that are apart"),
        );
        return None;
    }
    Some(Section {
        body,
        names: ends.map(|p| p.name.to_owned()),
        points: ends.map(|p| p.at),
    })
}
