//! The joints: which points of which bodies they hold together, and what they let move.

mod gears;
mod pairs;
mod relation;

use crate::bodies::{Bodies, NamedPoint, TWO_POINTS};
use crate::fields::{Entry, Fields, array, string};
use crate::keys::JOINTS;
use crate::kind::kind;
use crate::names::{check, shorten};
use crate::problem::{Problem, Problems, Span};
use crate::units::Units;
use dwell_geometry::{Joint, JointId, JointKind, Relation};
use std::collections::HashMap;
use std::ops::Range;

/// A joint as read; nothing in it if it was wrong, while its name still counts as known.
#[derive(Debug)]
pub(crate) struct JointText {
    pub(crate) name: String,
    pub(crate) key: Span,
    /// Where its two points are named; of a relation its coordinates.
    pub(crate) ends: [Span; 2],
    /// Its axis or axes.
    pub(crate) axis: Option<Span>,
    /// The law of a relation.
    pub(crate) law: Option<Span>,
    pub(crate) joint: Option<Joint>,
}

/// All the joints as read.
#[derive(Debug, Default)]
pub(crate) struct Joints<'a> {
    pub(crate) list: Vec<JointText>,
    /// Which joints a name stands for: several only if it is that of a pin of several bodies.
    by_name: HashMap<String, Range<usize>>,
    pub(crate) relations: Vec<Relation>,
    /// Relations that wait for the coordinates to be read.
    waiting: Vec<(usize, Fields<'a>)>,
}

impl<'a> Joints<'a> {
    /// Every joint, the relations by their names alone: [`Self::relate`] reads them.
    pub(crate) fn read(
        fields: &Fields<'a>,
        bodies: &Bodies<'_>,
        units: &Units,
        problems: &mut Problems,
    ) -> Self {
        let mut joints = Self::default();
        for entry in &fields.entries {
            check("a joint", entry.name, &entry.key, problems);
            let (first, count) = (joints.list.len(), problems.count());
            joints.joint(entry, bodies, units, problems);
            if problems.count() > count {
                // What is wrong with it is said: nothing follows from the rest of it.
                for joint in &mut joints.list[first..] {
                    joint.joint = None;
                }
            }
            let all = first..joints.list.len();
            joints.by_name.insert(entry.name.to_owned(), all);
        }
        joints.name_pins(problems);
        joints
    }

    /// The joints of that name.
    pub(crate) fn find(
        &self,
        name: &str,
        at: &Span,
        problems: &mut Problems,
    ) -> Option<Range<usize>> {
        if let Some(range) = self.by_name.get(name) {
            return Some(range.clone());
        }
        // Without any joint the scene has a greater problem, reported by now.
        if !self.list.is_empty() {
            let help = problems.choices(name, "joints", self.names());
            problems.push(
                Problem::new(format!("there is no joint `{}`", shorten(name)))
                    .at(at.clone(), "unknown joint")
                    .help(help),
            );
        }
        None
    }

    /// The prismatic joint or slot of that name, which has a travel.
    pub(crate) fn sliding(
        &self,
        name: &str,
        at: &Span,
        problems: &mut Problems,
    ) -> Option<JointId> {
        let first = self.find(name, at, problems)?.start;
        let kind = self.list[first].joint.as_ref()?.kind;
        if slides(kind) {
            return Some(JointId(first));
        }
        let sliding = self.list.iter().filter(|j| match &j.joint {
            Some(joint) => slides(joint.kind),
            None => false,
        });
        let help = problems.choices(
            "",
            "prismatic joints and slots",
            sliding.map(|j| j.name.as_str()),
        );
        let name = shorten(name);
        problems.push(
            Problem::new(format!("joint `{name}` has no travel"))
                .at(at.clone(), format!("its kind is {}", word(kind)))
                .help(help),
        );
        None
    }

    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        self.list.iter().map(|j| j.name.as_str())
    }

    /// A joint between two bodies stands in the list under its own name; the joints of a pin of
    /// several bodies have names of their own, which no other joint may have.
    fn name_pins(&mut self, problems: &mut Problems) {
        for (k, joint) in self.list.iter().enumerate() {
            if self
                .by_name
                .get(&joint.name)
                .is_some_and(|r| r.contains(&k))
            {
                continue;
            }
            let Some(other) = self.by_name.insert(joint.name.clone(), k..k + 1) else {
                continue;
            };
            let name = shorten(&joint.name);
            problems.push(
                Problem::new(format!("two joints are named `{name}`"))
                    .at(joint.key.clone(), "one is made from this pin")
                    .at(self.list[other.start].key.clone(), "the other is here")
                    .help(
                        "rename this joint: a pin of several bodies makes joints named `pin-body`",
                    ),
            );
        }
    }

    fn joint(
        &mut self,
        entry: &Entry<'a>,
        bodies: &Bodies<'_>,
        units: &Units,
        problems: &mut Problems,
    ) {
        let key = entry.key.clone();
        let mut text = JointText {
            name: entry.name.to_owned(),
            ends: [key.clone(), key.clone()],
            key,
            axis: None,
            law: None,
            joint: None,
        };
        let what = format!("joint `{}`", shorten(entry.name));
        let Some(fields) = Fields::open(entry, what, problems) else {
            self.list.push(text);
            return;
        };
        let Some((kind, held)) = kind(&fields, &entry.key, "joint", &JOINTS, problems) else {
            self.list.push(text);
            return;
        };
        let axis = fields.get("axis").or(fields.get("axes"));
        text.axis = axis.map(|e| e.value.span());
        if kind == "revolute" {
            self.pin(text, held, &fields, bodies, problems);
            return;
        }
        if kind == "relation" {
            self.waiting.push((self.list.len(), fields));
            self.list.push(text);
            return;
        }
        let ends = two_ends(held, TWO_POINTS, &fields, bodies, problems);
        let kind = match kind {
            "prismatic" => pairs::prismatic(entry, &fields, problems),
            "slot" => pairs::slot(entry, &fields, problems),
            "weld" => pairs::weld(&fields, units, problems),
            "distance" => pairs::distance(entry, &fields, units, problems),
            "gear" => gears::gear(entry, &fields, units, problems),
            _ => {
                gears::on_a_line(entry, &fields, units, problems).map(|(axis, radius)| match kind {
                    "rack" => JointKind::Rack { axis, radius },
                    _ => JointKind::Rolling { axis, radius },
                })
            }
        };
        if let Some(ends) = ends {
            text.ends = ends.clone().map(|(_, _, at)| at);
            let [a, b] = &ends;
            text.joint = kind.map(|kind| between(&text.name, a, b, kind, bodies));
        }
        self.list.push(text);
    }

    /// A pin: the first body holds every other.
    fn pin(
        &mut self,
        mut text: JointText,
        held: &Entry<'_>,
        fields: &Fields<'_>,
        bodies: &Bodies<'_>,
        problems: &mut Problems,
    ) {
        let Some(ends) = pin_ends(held, fields, bodies, problems) else {
            self.list.push(text);
            return;
        };
        let [first, others @ ..] = ends.as_slice() else {
            self.list.push(text);
            return;
        };
        for end in others {
            let name = match others.len() {
                1 => text.name.clone(),
                _ => format!("{}-{}", text.name, bodies.list[end.0.0].name),
            };
            text.ends = [first.2.clone(), end.2.clone()];
            self.list.push(JointText {
                joint: Some(between(&name, first, end, JointKind::Revolute, bodies)),
                name,
                key: text.key.clone(),
                ends: text.ends.clone(),
                axis: None,
                law: None,
            });
        }
    }
}

fn between(
    name: &str,
    a: &NamedPoint,
    b: &NamedPoint,
    kind: JointKind,
    bodies: &Bodies<'_>,
) -> Joint {
    Joint {
        name: name.to_owned(),
        bodies: [a.0, b.0],
        points: [a, b].map(|end| bodies.at(end)),
        kind,
    }
}

/// Whether a joint of that kind has a travel.
fn slides(kind: JointKind) -> bool {
    matches!(kind, JointKind::Prismatic { .. } | JointKind::Slot { .. })
}

/// What a scene calls the kind.
pub(crate) fn word(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic { .. } => "prismatic",
        JointKind::Slot { .. } => "slot",
        JointKind::Weld { .. } => "weld",
        JointKind::Gear { .. } => "gear",
        JointKind::Rack { .. } => "rack",
        JointKind::Rolling { .. } => "rolling",
        JointKind::Distance { .. } => "distance",
        JointKind::Relation(_) => "relation",
    }
}

/// The two points that the joint's first key names.
fn two_ends(
    held: &Entry<'_>,
    expected: &str,
    fields: &Fields<'_>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Option<[NamedPoint; 2]> {
    let what = format_args!("{} of {}", held.name, fields.what);
    let ends = bodies.find_two_points(held.value, expected, what, problems)?;
    let [a, b] = &ends;
    different(a, b, fields, bodies, problems)?;
    Some(ends)
}

/// The points of a pin, two or more, each of another body.
fn pin_ends(
    held: &Entry<'_>,
    fields: &Fields<'_>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Option<Vec<NamedPoint>> {
    let what = format!("{} of {}", held.name, fields.what);
    let expected = "two or more points [\"body.point\", \"body.point\"]";
    let values = array(held.value, expected, format_args!("{what}"), problems)?;
    if values.len() < 3 {
        return two_ends(held, expected, fields, bodies, problems).map(Vec::from);
    }
    let count = problems.count();
    let mut ends: Vec<NamedPoint> = Vec::new();
    for value in values {
        let Some(name) = string(value, format_args!("{what}"), problems) else {
            continue;
        };
        let at = value.span();
        let Some((body, point)) = bodies.find_point(name, &at, problems) else {
            continue;
        };
        let end = (body, point, at);
        match ends.iter().find(|e| e.0 == body) {
            Some(other) => {
                different(other, &end, fields, bodies, problems);
            }
            None => ends.push(end),
        }
    }
    (problems.count() == count).then_some(ends)
}

/// A joint is between two bodies: says so if it is not.
fn different(
    a: &NamedPoint,
    b: &NamedPoint,
    fields: &Fields<'_>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Option<()> {
    if a.0 != b.0 {
        return Some(());
    }
    problems.push(
        Problem::new(format!(
            "{} joins body `{}` to itself",
            fields.what, bodies.list[a.0.0].name
        ))
        .at(a.2.clone(), "this body")
        .at(b.2.clone(), "and the same again")
        .help("a joint holds two different bodies together"),
    );
    None
}
