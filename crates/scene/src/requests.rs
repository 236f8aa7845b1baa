//! The requested results.

use crate::bodies::Bodies;
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::joints::Joints;
use crate::keys::table;
use crate::scene::{DwellRequest, PathPoint, SectionRequest};
use crate::table_reader::{Entry, TableReader, Value, array, mismatch, number, string};
use crate::wording::shorten;
use dwell_geometry::{Component, Coupling, Joint, JointId, Reaction};
use std::collections::HashSet;
use toml::de::DeValue;

/// `[requests]` as read, each with where it is asked for. No reactions: all of them.
#[derive(Debug, Default)]
pub(crate) struct ParsedRequests {
    pub(crate) reactions: Option<Vec<(Reaction, Span)>>,
    pub(crate) paths: Vec<(PathPoint, Span)>,
    pub(crate) dwell: Option<(DwellRequest, Span)>,
    pub(crate) variables: Option<Vec<(String, Span)>>,
    pub(crate) sections: Vec<(SectionRequest, Span)>,
}

impl ParsedRequests {
    pub(crate) fn read(
        fields: &TableReader<'_>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        fields.reject_unknown_keys(table("requests"), diagnostics);
        let reactions = fields.get("reactions");
        let paths = fields.get("paths");
        let dwell = fields.get("dwell");
        let variables = fields.get("variables");
        let sections = fields.get("sections");
        Self {
            reactions: reactions.map(|e| reactions_of(e, joints, diagnostics)),
            paths: paths.map_or_else(Vec::new, |e| paths_of(e, bodies, diagnostics)),
            dwell: dwell.and_then(|e| Some((dwell_of(e, bodies, diagnostics)?, e.value.span()))),
            variables: variables.map(|e| variables_of(e, diagnostics)),
            sections: sections.map_or_else(Vec::new, |e| sections_of(e, bodies, diagnostics)),
        }
    }
}

/// The strings of an array, those that are none being reported.
fn strings<'a>(
    entry: &Entry<'a>,
    expected: &str,
    diagnostics: &mut Diagnostics,
) -> Vec<(&'a str, Span)> {
    let what = format!("{} in [requests]", entry.name);
    let values = array(entry.value, expected, format_args!("{what}"), diagnostics);
    let values = values.into_iter().flatten();
    let one = |value| {
        Some((
            string(value, format_args!("an entry of {what}"), diagnostics)?,
            value.span(),
        ))
    };
    values.filter_map(one).collect()
}

fn reactions_of(
    entry: &Entry<'_>,
    joints: &Joints<'_>,
    diagnostics: &mut Diagnostics,
) -> Vec<(Reaction, Span)> {
    let mut requested = HashSet::new();
    let mut reactions = Vec::new();
    for (text, at) in strings(entry, "an array such as [\"slide.normal\"]", diagnostics) {
        let (name, component) = match text.split_once('.') {
            Some((name, component)) => (name, Some(component)),
            None => (text, None),
        };
        let Some(range) = joints.find(name, &at, diagnostics) else {
            continue;
        };
        for k in range {
            // A joint that could not be read has been reported already.
            let Some(joint) = &joints.list[k].joint else {
                continue;
            };
            let found = components(joint, component, &joints.couplings, &at, diagnostics);
            if found.is_empty() {
                break;
            }
            for component in found {
                let joint = JointId(k);
                let reaction = Reaction { joint, component };
                // Asked for twice, as `slide` and `slide.normal`, it is still one reaction.
                if requested.insert(reaction) {
                    reactions.push((reaction, at.clone()));
                }
            }
        }
    }
    reactions
}

/// The named component of the joint's reaction, or all of them.
pub(crate) fn components(
    joint: &Joint,
    name: Option<&str>,
    relations: &[Coupling],
    at: &Span,
    diagnostics: &mut Diagnostics,
) -> Vec<Component> {
    let all = joint.kind.components(relations);
    let Some(name) = name else {
        return all.to_vec();
    };
    if let Some(component) = all.iter().copied().find(|c| c.name() == name) {
        return vec![component];
    }
    let help = diagnostics.choices(
        name,
        "components of its reaction",
        all.iter().map(|c| c.name()),
    );
    let joint = &joint.name;
    diagnostics.push(
        Diagnostic::new(format!(
            "the reaction of joint `{joint}` has no component `{}`",
            shorten(name)
        ))
        .label(at.clone(), "unknown component")
        .help(help),
    );
    Vec::new()
}

fn paths_of(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    diagnostics: &mut Diagnostics,
) -> Vec<(PathPoint, Span)> {
    let mut requested = HashSet::new();
    let mut paths = Vec::new();
    for (text, at) in strings(entry, "an array such as [\"coupler.P\"]", diagnostics) {
        let Some((body, k)) = bodies.find_point(text, &at, diagnostics) else {
            continue;
        };
        if bodies.ground == Some(body.0) {
            diagnostics.push(
                Diagnostic::new(format!("`{}` is a point of the ground", shorten(text)))
                    .label(at, "it has no path")
                    .help("ask for a point of a moving body"),
            );
            continue;
        }
        if requested.insert((body, k)) {
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
    diagnostics: &mut Diagnostics,
) -> Option<DwellRequest> {
    let fields = TableReader::open(entry, "dwell in [requests]", diagnostics)?;
    fields.reject_unknown_keys(table("dwell"), diagnostics);
    let (Some(body), Some(band)) = (fields.get("body"), fields.get("relative-band")) else {
        diagnostics.push(
            Diagnostic::new("dwell in [requests] needs a body and a band")
                .label(entry.value.span(), "incomplete")
                .help("write `dwell = { body = \"guide\", relative-band = 0.02 }`"),
        );
        return None;
    };
    let name = string(body.value, format_args!("the body of dwell"), diagnostics);
    let id = name.and_then(|name| bodies.find(name, &body.value.span(), diagnostics));
    if let (Some(name), Some(id)) = (name, id)
        && bodies.ground == Some(id.0)
    {
        diagnostics.push(
            Diagnostic::new(format!(
                "`{}` is the ground, which does not move",
                shorten(name)
            ))
            .label(body.value.span(), "not a moving body"),
        );
        return None;
    }
    let width = number(band.value, format_args!("the band of dwell"), diagnostics)?;
    if !(width > 0.0 && width < 1.0) {
        diagnostics.push(
            Diagnostic::new("the band of a dwell is a fraction of the body's angular range")
                .label(band.value.span(), "expected a number between 0 and 1"),
        );
        return None;
    }
    Some(DwellRequest {
        body: id?,
        relative_band: width,
    })
}

/// The names of columns, each once.
fn variables_of(entry: &Entry<'_>, diagnostics: &mut Diagnostics) -> Vec<(String, Span)> {
    let mut requested = HashSet::new();
    strings(entry, "an array such as [\"crank.angle\"]", diagnostics)
        .into_iter()
        .filter(|(name, _)| requested.insert(*name))
        .map(|(name, at)| (name.to_owned(), at))
        .collect()
}

/// The links, each once.
fn sections_of(
    entry: &Entry<'_>,
    bodies: &Bodies<'_>,
    diagnostics: &mut Diagnostics,
) -> Vec<(SectionRequest, Span)> {
    let expected = "an array such as [{ body = \"rod\", from = \"B\", to = \"P\" }]";
    let what = format_args!("sections in [requests]");
    let values = array(entry.value, expected, what, diagnostics);
    let mut sections: Vec<(SectionRequest, Span)> = Vec::new();
    for value in values.into_iter().flatten() {
        let Some(section) = section_of(value, bodies, diagnostics) else {
            continue;
        };
        if sections.iter().all(|(known, _)| *known != section) {
            sections.push((section, value.span()));
        }
    }
    sections
}

fn section_of(
    value: &Value<'_>,
    bodies: &Bodies<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<SectionRequest> {
    let what = "a section in [requests]";
    let DeValue::Table(entries) = value.get_ref() else {
        mismatch(value, "a table", format_args!("{what}"), diagnostics);
        return None;
    };
    let fields = TableReader::new(what, value.span(), entries);
    fields.reject_unknown_keys(table("section"), diagnostics);
    let help = "write it as `{ body = \"rod\", from = \"B\", to = \"P\" }`";
    let [body, from, to] = ["body", "from", "to"].map(|key| {
        let entry = fields.require(key, &fields.span, help, diagnostics)?;
        let what = format_args!("{key} of {what}");
        Some((string(entry.value, what, diagnostics)?, entry.value.span()))
    });
    let (name, at) = body?;
    let body = bodies.find(name, &at, diagnostics)?;
    if bodies.ground == Some(body.0) {
        diagnostics.push(
            Diagnostic::new(format!(
                "`{}` is the ground, which has no sections",
                shorten(name)
            ))
            .label(at, "not a moving body")
            .help("ask for the sections of a moving body"),
        );
        return None;
    }
    let from =
        from.and_then(|(name, at)| bodies.point_of(body, name, &at, diagnostics).zip(Some(at)));
    let to = to.and_then(|(name, at)| bodies.point_of(body, name, &at, diagnostics).zip(Some(at)));
    let ((from, at_from), (to, at_to)) = (from?, to?);
    let points = &bodies.list[body.0].points;
    let ends = [&points[from], &points[to]];
    if ends[0].at == ends[1].at {
        diagnostics.push(
            Diagnostic::new(format!("{what} of `{}` has no length", shorten(name)))
                .label(at_from, "from here")
                .label(at_to, "to the same place")
                .help("give two points that are apart"),
        );
        return None;
    }
    Some(SectionRequest {
        body,
        names: ends.map(|p| p.name.to_owned()),
        points: ends.map(|p| p.at),
    })
}
