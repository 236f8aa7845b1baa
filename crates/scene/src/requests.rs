//! What the reader of the results wants to know.

use crate::bodies::Bodies;
use crate::fields::{Entry, Fields, array, number, string};
use crate::joints::Joints;
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::scene::{DwellRequest, PathPoint};
use dwell_geometry::{Component, Joint, JointId, Reaction};
use std::collections::HashSet;

/// `[requests]` as read, each with where it is asked for. No reactions: all of them.
#[derive(Debug, Default)]
pub(crate) struct RequestsText {
    pub(crate) reactions: Option<Vec<(Reaction, Span)>>,
    pub(crate) paths: Vec<(PathPoint, Span)>,
    pub(crate) dwell: Option<(DwellRequest, Span)>,
}

impl RequestsText {
    pub(crate) fn read(
        fields: &Fields<'_>,
        bodies: &Bodies<'_>,
        joints: &Joints<'_>,
        problems: &mut Problems,
    ) -> Self {
        fields.allow(&["reactions", "paths", "dwell"], problems);
        let reactions = fields.get("reactions");
        let paths = fields.get("paths");
        let dwell = fields.get("dwell");
        Self {
            reactions: reactions.map(|e| reactions_of(e, joints, problems)),
            paths: paths.map_or_else(Vec::new, |e| paths_of(e, bodies, problems)),
            dwell: dwell.and_then(|e| Some((dwell_of(e, bodies, problems)?, e.value.span()))),
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
        // Without any joint the scene has a greater problem, reported by now.
        let Some(&k) = joints.by_name.get(name) else {
            if joints.list.is_empty() {
                continue;
            }
            let help = problems.choices(name, "joints", joints.list.iter().map(|j| j.name));
            problems.push(
                Problem::new(format!("there is no joint `{}`", shorten(name)))
                    .at(at, "unknown joint")
                    .help(help),
            );
            continue;
        };
        // A joint that could not be read has been reported already.
        let Some(joint) = &joints.list[k].joint else {
            continue;
        };
        for component in components(joint, component, &at, problems) {
            let joint = JointId(k);
            let reaction = Reaction { joint, component };
            // Asked for twice, as `slide` and `slide.normal`, it is still one reaction.
            if asked.insert(reaction) {
                reactions.push((reaction, at.clone()));
            }
        }
    }
    reactions
}

/// The named component of the joint's reaction, or both.
fn components(
    joint: &Joint,
    name: Option<&str>,
    at: &Span,
    problems: &mut Problems,
) -> Vec<Component> {
    let all = joint.kind.components(&[]);
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
    fields.allow(&["body", "band"], problems);
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
