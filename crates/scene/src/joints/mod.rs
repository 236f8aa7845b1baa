//! The joints: which points of which bodies they connect, and their kinds.

mod coupling;
mod gears;
mod pairs;

use crate::bodies::{Bodies, NamedPoint, TWO_POINTS};
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::kind::kind;
use crate::loads::ParsedLoad;
use crate::names::check;
use crate::table_reader::{Entry, TableReader, array, string};
use crate::units::Units;
use crate::wording::shorten;
use dwell_geometry::{Coupling, Joint, JointId, JointKind};
use dwell_kinetostatics::{Guide, Load};
use std::collections::HashMap;
use std::ops::Range;

/// A joint as read; nothing in it if it was wrong, while its name still counts as known.
#[derive(Debug)]
pub(crate) struct ParsedJoint {
    pub(crate) name: String,
    pub(crate) key: Span,
    /// Where its two points are named; of a coupling, its coordinates.
    pub(crate) points: [Span; 2],
    /// Its axis or axes.
    pub(crate) axis: Option<Span>,
    /// The law of a coupling.
    pub(crate) law: Option<Span>,
    /// The pressure angle of teeth, rad.
    pub(crate) pressure_angle: Option<(f64, Span)>,
    pub(crate) joint: Option<Joint>,
}

/// All the joints as read.
#[derive(Debug, Default)]
pub(crate) struct Joints<'a> {
    pub(crate) list: Vec<ParsedJoint>,
    /// Which joints a name stands for: several only if it is that of a pin of several bodies.
    by_name: HashMap<String, Range<usize>>,
    pub(crate) couplings: Vec<Coupling>,
    /// Couplings, which are read after the coordinates.
    pending_couplings: Vec<(usize, TableReader<'a>)>,
}

impl<'a> Joints<'a> {
    /// Every joint, the couplings by their names alone: [`Self::read_couplings`] reads them.
    pub(crate) fn read(
        fields: &TableReader<'a>,
        bodies: &Bodies<'_>,
        units: &Units,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let mut joints = Self::default();
        for entry in &fields.entries {
            check("a joint", entry.name, &entry.key, diagnostics);
            let (first, count) = (joints.list.len(), diagnostics.count());
            joints.joint(entry, bodies, units, diagnostics);
            if diagnostics.count() > count {
                // What is wrong with it is said: nothing follows from the rest of it.
                for joint in &mut joints.list[first..] {
                    joint.joint = None;
                }
            }
            let all = first..joints.list.len();
            joints.by_name.insert(entry.name.to_owned(), all);
        }
        joints.name_pins(diagnostics);
        joints
    }

    /// The joints of that name.
    pub(crate) fn find(
        &self,
        name: &str,
        at: &Span,
        diagnostics: &mut Diagnostics,
    ) -> Option<Range<usize>> {
        if let Some(range) = self.by_name.get(name) {
            return Some(range.clone());
        }
        // Without any joint the scene has a greater problem, reported by now.
        if !self.list.is_empty() {
            let help = diagnostics.choices(name, "joints", self.names());
            diagnostics.push(
                Diagnostic::new(format!("there is no joint `{}`", shorten(name)))
                    .label(at.clone(), "unknown joint")
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
        diagnostics: &mut Diagnostics,
    ) -> Option<JointId> {
        let first = self.find(name, at, diagnostics)?.start;
        let kind = self.list[first].joint.as_ref()?.kind;
        if has_travel(kind) {
            return Some(JointId(first));
        }
        let sliding = self.list.iter().filter(|j| match &j.joint {
            Some(joint) => has_travel(joint.kind),
            None => false,
        });
        let help = diagnostics.choices(
            "",
            "prismatic joints and slots",
            sliding.map(|j| j.name.as_str()),
        );
        let name = shorten(name);
        diagnostics.push(
            Diagnostic::new(format!("joint `{name}` has no travel"))
                .label(at.clone(), format!("its kind is {}", kind_name(kind)))
                .help(help),
        );
        None
    }

    /// The line along which a joint slides.
    pub(crate) fn guide(&self, joint: JointId) -> Option<Guide> {
        let joint = self.list.get(joint.0)?.joint.as_ref()?;
        let axis = match joint.kind {
            JointKind::Prismatic { axes: [axis, _] } | JointKind::Slot { axis } => axis,
            _ => return None,
        };
        Some(Guide {
            bodies: joint.bodies,
            points: joint.points,
            axis,
        })
    }

    /// The separating forces of the teeth that have a pressure angle, in the order of the file.
    pub(crate) fn separating_forces(&self) -> Vec<ParsedLoad> {
        let separating = |(k, parsed): (usize, &ParsedJoint)| {
            let (angle, at) = parsed.pressure_angle.as_ref()?;
            let load = Load::separating(parsed.joint.as_ref()?, JointId(k), *angle)?;
            Some(ParsedLoad {
                key: parsed.key.clone(),
                magnitude: Some(at.clone()),
                load: Some(load),
            })
        };
        let joints = self.list.iter().enumerate();
        joints.filter_map(separating).collect()
    }

    fn names(&self) -> impl Iterator<Item = &str> + Clone {
        self.list.iter().map(|j| j.name.as_str())
    }

    /// A joint between two bodies stands in the list under its own name; the joints of a pin of
    /// several bodies have names of their own, which no other joint may have.
    fn name_pins(&mut self, diagnostics: &mut Diagnostics) {
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
            diagnostics.push(
                Diagnostic::new(format!("two joints are named `{name}`"))
                    .label(joint.key.clone(), "one is made from this pin")
                    .label(self.list[other.start].key.clone(), "the other is here")
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
        diagnostics: &mut Diagnostics,
    ) {
        let key = entry.key.clone();
        let mut parsed = ParsedJoint {
            name: entry.name.to_owned(),
            points: [key.clone(), key.clone()],
            key,
            axis: None,
            law: None,
            pressure_angle: None,
            joint: None,
        };
        let what = format!("joint `{}`", shorten(entry.name));
        let Some(fields) = TableReader::open(entry, what, diagnostics) else {
            self.list.push(parsed);
            return;
        };
        let Some((kind, kind_entry)) = kind(&fields, &entry.key, "joint", diagnostics) else {
            self.list.push(parsed);
            return;
        };
        let axis = fields.get("axis").or(fields.get("axes"));
        parsed.axis = axis.map(|e| e.value.span());
        if kind == "revolute" {
            self.pin(parsed, kind_entry, &fields, bodies, diagnostics);
            return;
        }
        if kind == "coupling" {
            self.pending_couplings.push((self.list.len(), fields));
            self.list.push(parsed);
            return;
        }
        let points = two_points(kind_entry, TWO_POINTS, &fields, bodies, diagnostics);
        if matches!(kind, "gear" | "rack") {
            parsed.pressure_angle = gears::pressure_angle(&fields, units, diagnostics);
        }
        let kind =
            match kind {
                "prismatic" => pairs::prismatic(entry, &fields, diagnostics),
                "slot" => pairs::slot(entry, &fields, diagnostics),
                "weld" => pairs::weld(&fields, units, diagnostics),
                "distance" => pairs::distance(entry, &fields, units, diagnostics),
                "gear" => gears::gear(entry, &fields, units, diagnostics),
                _ => gears::on_a_line(entry, &fields, units, diagnostics).map(|(axis, radius)| {
                    match kind {
                        "rack" => JointKind::Rack { axis, radius },
                        _ => JointKind::Rolling { axis, radius },
                    }
                }),
            };
        if let Some(points) = points {
            parsed.points = points.clone().map(|(_, _, at)| at);
            let [a, b] = &points;
            parsed.joint = kind.map(|kind| between(&parsed.name, a, b, kind, bodies));
        }
        self.list.push(parsed);
    }

    /// A pin: the first body holds every other.
    fn pin(
        &mut self,
        mut parsed: ParsedJoint,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        bodies: &Bodies<'_>,
        diagnostics: &mut Diagnostics,
    ) {
        let Some(points) = pin_points(kind_entry, fields, bodies, diagnostics) else {
            self.list.push(parsed);
            return;
        };
        let [first, others @ ..] = points.as_slice() else {
            self.list.push(parsed);
            return;
        };
        for other in others {
            let name = match others.len() {
                1 => parsed.name.clone(),
                _ => format!("{}-{}", parsed.name, bodies.list[other.0.0].name),
            };
            parsed.points = [first.2.clone(), other.2.clone()];
            self.list.push(ParsedJoint {
                joint: Some(between(&name, first, other, JointKind::Revolute, bodies)),
                name,
                key: parsed.key.clone(),
                points: parsed.points.clone(),
                axis: None,
                law: None,
                pressure_angle: None,
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
        points: [a, b].map(|point| bodies.at(point)),
        kind,
    }
}

/// Whether a joint of that kind has a travel.
fn has_travel(kind: JointKind) -> bool {
    matches!(kind, JointKind::Prismatic { .. } | JointKind::Slot { .. })
}

/// What a scene calls the kind.
pub(crate) fn kind_name(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic { .. } => "prismatic",
        JointKind::Slot { .. } => "slot",
        JointKind::Weld { .. } => "weld",
        JointKind::Gear { .. } => "gear",
        JointKind::Rack { .. } => "rack",
        JointKind::Rolling { .. } => "rolling",
        JointKind::Distance { .. } => "distance",
        JointKind::Coupling(_) => "coupling",
    }
}

/// The two points that the joint's first key names.
fn two_points(
    kind_entry: &Entry<'_>,
    expected: &str,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<[NamedPoint; 2]> {
    let what = format_args!("{} of {}", kind_entry.name, fields.what);
    let points = bodies.find_two_points(kind_entry.value, expected, what, diagnostics)?;
    let [a, b] = &points;
    require_different_bodies(a, b, fields, bodies, diagnostics)?;
    Some(points)
}

/// The points of a pin, two or more, each of another body.
fn pin_points(
    kind_entry: &Entry<'_>,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<NamedPoint>> {
    let what = format!("{} of {}", kind_entry.name, fields.what);
    let expected = "two or more points [\"body.point\", \"body.point\"]";
    let values = array(
        kind_entry.value,
        expected,
        format_args!("{what}"),
        diagnostics,
    )?;
    if values.len() < 3 {
        return two_points(kind_entry, expected, fields, bodies, diagnostics).map(Vec::from);
    }
    let count = diagnostics.count();
    let mut points: Vec<NamedPoint> = Vec::new();
    for value in values {
        let Some(name) = string(value, format_args!("{what}"), diagnostics) else {
            continue;
        };
        let at = value.span();
        let Some((body, point)) = bodies.find_point(name, &at, diagnostics) else {
            continue;
        };
        let named_point = (body, point, at);
        match points.iter().find(|e| e.0 == body) {
            Some(other) => {
                require_different_bodies(other, &named_point, fields, bodies, diagnostics);
            }
            None => points.push(named_point),
        }
    }
    (diagnostics.count() == count).then_some(points)
}

/// A joint is between two bodies: says so if it is not.
fn require_different_bodies(
    a: &NamedPoint,
    b: &NamedPoint,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<()> {
    if a.0 != b.0 {
        return Some(());
    }
    diagnostics.push(
        Diagnostic::new(format!(
            "{} joins body `{}` to itself",
            fields.what, bodies.list[a.0.0].name
        ))
        .label(a.2.clone(), "this body")
        .label(b.2.clone(), "and the same again")
        .help("a joint holds two different bodies together"),
    );
    None
}
