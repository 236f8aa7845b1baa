//! The joints: the points that they connect, and their kinds.

mod coupling;
mod gears;
mod pairs;

pub(crate) use coupling::coupling;

use crate::bodies::{Bodies, NamedPoint, TWO_POINTS};
use crate::diagnostics::{Diagnostics, Span};
use crate::kind::{kind, reject_unread_kind};
use crate::names::check;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::{BodyId, Coupling, Joint, JointId, JointKind};
use dwell_kinetostatics::Guide;
use std::collections::HashMap;
use std::ops::Range;

/// A joint as read; its contents are `None` if it is invalid, but its name counts as known.
#[derive(Debug, Clone)]
pub(crate) struct ParsedJoint {
    pub(crate) name: String,
    pub(crate) key: Span,
    /// The pressure angle of teeth, rad.
    pub(crate) pressure_angle: Option<(f64, Span)>,
    pub(crate) joint: Option<Joint>,
}

/// All the joints as read.
#[derive(Debug)]
pub(crate) struct Joints<'a> {
    pub(crate) list: Vec<ParsedJoint>,
    /// The joints of a name; several only if it is that of a pin of several bodies.
    by_name: HashMap<String, Range<usize>>,
    pub(crate) couplings: Vec<Coupling>,
    /// Couplings, which are read after the coordinates.
    pending_couplings: Vec<(usize, TableReader<'a>)>,
    pub(crate) log: &'a Diagnostics,
}

impl<'a> Joints<'a> {
    /// No joints, as long as none is read.
    pub(crate) fn new(log: &'a Diagnostics) -> Self {
        Self {
            list: Vec::new(),
            by_name: HashMap::new(),
            couplings: Vec::new(),
            pending_couplings: Vec::new(),
            log,
        }
    }

    /// Every joint, the couplings by their names alone: [`Self::read_couplings`] reads them.
    pub(crate) fn read(mut self, fields: &TableReader<'a>, bodies: &Bodies<'_>) -> Self {
        for entry in &fields.entries {
            check("a joint", entry);
            let (first, count) = (self.list.len(), self.log.count());
            self.joint(entry, bodies);
            if self.log.count() > count {
                // What is wrong with it is reported: nothing follows from the rest of it.
                for joint in &mut self.list[first..] {
                    joint.joint = None;
                }
            }
            let all = first..self.list.len();
            self.by_name.insert(entry.name.to_owned(), all);
        }
        self.name_pins();
        self
    }

    /// The joints of that name.
    pub(crate) fn find(&self, name: &str, at: &Span) -> Option<Range<usize>> {
        let found = self.by_name.get(name);
        // Without any joint the scene has a greater problem, reported by now.
        if found.is_none() && !self.list.is_empty() {
            let names = self.list.iter().map(|j| j.name.as_str());
            let help = self.log.choices(name, "joints", names);
            let message = format!("there is no joint `{}`", shorten(name));
            self.log.report(message, &[(at, "unknown joint")], help);
        }
        found.cloned()
    }

    /// The prismatic joint or slot of that name, which has a travel.
    pub(crate) fn sliding(&self, name: &str, at: &Span) -> Option<JointId> {
        let first = self.find(name, at)?.start;
        let has_travel = |kind: JointKind| kind.travel_axis().is_some();
        let kind = self.list[first].joint.as_ref()?.kind;
        if has_travel(kind) {
            return Some(JointId(first));
        }
        let slides = |j: &&ParsedJoint| j.joint.as_ref().is_some_and(|j| has_travel(j.kind));
        let sliding = self.list.iter().filter(slides).map(|j| j.name.as_str());
        let help = self.log.choices("", "prismatic joints and slots", sliding);
        let message = format!("joint `{}` has no travel", shorten(name));
        let label = format!("its kind is {}", kind.name());
        self.log.reject(message, &[(at, &label)], help)
    }

    /// The line along which a joint slides.
    pub(crate) fn guide(&self, joint: JointId) -> Option<Guide> {
        self.list.get(joint.0)?.joint.as_ref()?.guide()
    }

    /// Names the joints: a joint between two bodies has its own name in the list; each joint of a pin of several bodies
    /// has its own name, which no other joint may have.
    fn name_pins(&mut self) {
        for (k, joint) in self.list.iter().enumerate() {
            let named = self.by_name.get(&joint.name);
            if named.is_some_and(|r| r.contains(&k)) {
                continue;
            }
            if let Some(other) = self.by_name.insert(joint.name.clone(), k..k + 1) {
                let message = format!("two joints are named `{}`", shorten(&joint.name));
                let pin = (&joint.key, "one is made from this pin");
                let other = (&self.list[other.start].key, "the other is here");
                let help =
                    "rename this joint: a pin of several bodies makes joints named `pin-body`";
                self.log.report(message, &[pin, other], help);
            }
        }
    }

    /// Appends the joints that an entry describes, several if it is a pin of several bodies.
    fn joint(&mut self, entry: &Entry<'a>, bodies: &Bodies<'_>) {
        let mut parsed = ParsedJoint {
            name: entry.name.to_owned(),
            key: entry.key.clone(),
            pressure_angle: None,
            joint: None,
        };
        let fields = TableReader::open(entry, format!("joint `{}`", shorten(entry.name)));
        let kind = fields.as_ref().and_then(|fields| kind(fields, "joint"));
        let (Some(fields), Some((kind, kind_entry))) = (&fields, kind) else {
            return self.push(parsed);
        };
        match kind {
            "revolute" => match pin_points(kind_entry, fields, bodies).as_deref() {
                Some([first, others @ ..]) => self.pin(&parsed, first, others, bodies),
                _ => self.push(parsed),
            },
            "coupling" => {
                let pending = (self.list.len(), fields.clone());
                self.pending_couplings.push(pending);
                self.push(parsed);
            }
            _ => {
                let location = SceneLocation::Axis(JointId(self.list.len()));
                fields.place("axis", location);
                fields.place("axes", location);
                let points = two_points(kind_entry, TWO_POINTS, fields, bodies);
                if matches!(kind, "gear" | "rack") {
                    parsed.pressure_angle = gears::pressure_angle(fields);
                }
                let kind = joint_kind(kind_entry, fields);
                if let (Some([a, b]), Some(kind)) = (points, kind) {
                    parsed.joint = Some(self.between(&parsed.name, &a, &b, kind, bodies));
                }
                self.push(parsed);
            }
        }
    }

    fn push(&mut self, joint: ParsedJoint) {
        let id = JointId(self.list.len());
        self.log.place(SceneLocation::Joint(id), &joint.key);
        self.list.push(joint);
    }

    /// A pin: the first body holds every other.
    fn pin(
        &mut self,
        parsed: &ParsedJoint,
        first: &NamedPoint,
        others: &[NamedPoint],
        bodies: &Bodies<'_>,
    ) {
        for other in others {
            let name = match others.len() {
                1 => parsed.name.clone(),
                _ => format!("{}-{}", parsed.name, bodies.list[other.0.0].name),
            };
            let joint = self.between(&name, first, other, JointKind::Revolute, bodies);
            self.push(ParsedJoint {
                joint: Some(joint),
                name,
                ..parsed.clone()
            });
        }
    }

    /// The joint that is appended next.
    fn between(
        &self,
        name: &str,
        a: &NamedPoint,
        b: &NamedPoint,
        kind: JointKind,
        bodies: &Bodies<'_>,
    ) -> Joint {
        let id = JointId(self.list.len());
        self.log.place(SceneLocation::JointPoint(id, 0), &a.2);
        self.log.place(SceneLocation::JointPoint(id, 1), &b.2);
        Joint::new(name, [a.0, b.0], [a, b].map(|point| bodies.at(point)), kind)
    }
}

/// The kind of a joint of two points, with its numbers.
fn joint_kind(kind: &Entry<'_>, fields: &TableReader<'_>) -> Option<JointKind> {
    match kind.name {
        "prismatic" => pairs::prismatic(fields),
        "slot" => pairs::axis(fields).map(|axis| JointKind::Slot { axis }),
        "weld" => pairs::weld(fields),
        "distance" => pairs::distance(fields),
        "gear" => gears::gear(fields),
        "rack" => gears::on_a_line(fields).map(|(axis, radius)| JointKind::Rack { axis, radius }),
        "rolling" => {
            let (axis, radius) = gears::on_a_line(fields)?;
            Some(JointKind::Rolling { axis, radius })
        }
        _ => reject_unread_kind(kind),
    }
}

/// The two points that the joint's first key names.
fn two_points(
    kind_entry: &Entry<'_>,
    expected: &str,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
) -> Option<[NamedPoint; 2]> {
    let what = fields.name_of(kind_entry);
    let [a, b] = bodies.find_two_points(kind_entry.value, expected, what)?;
    require_different_bodies(&a, &b, fields, bodies)?;
    Some([a, b])
}

/// The points of a pin, two or more, each of another body.
fn pin_points(
    kind_entry: &Entry<'_>,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
) -> Option<Vec<NamedPoint>> {
    let what = fields.name_of(kind_entry);
    let expected = "two or more points [\"body.point\", \"body.point\"]";
    let values = kind_entry.value.array(expected, &what)?;
    if values.len() < 3 {
        return two_points(kind_entry, expected, fields, bodies).map(Vec::from);
    }
    let count = fields.log().count();
    let mut points: Vec<NamedPoint> = Vec::new();
    for value in values {
        let at = value.span();
        let name = value.string(&what);
        let found = name.and_then(|name| bodies.find_point(name, &at));
        let Some((body, point)) = found else {
            continue;
        };
        let named_point = (body, point, at);
        match points.iter().find(|e| e.0 == body) {
            Some(other) => {
                require_different_bodies(other, &named_point, fields, bodies);
            }
            None => points.push(named_point),
        }
    }
    (fields.log().count() == count).then_some(points)
}

/// A joint is between two bodies: reports one that is not.
fn require_different_bodies(
    a: &NamedPoint,
    b: &NamedPoint,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_>,
) -> Option<[BodyId; 2]> {
    let message = |name: &str| format!("{} joins body `{name}` to itself", fields.what);
    let help = "a joint holds two different bodies together";
    bodies.require_different([(a.0, &a.2), (b.0, &b.2)], message, help)
}
