//! The joints: the points that they connect, and their axes.

use super::values::{direction, two_directions};
use crate::bodies::{Bodies, TWO_POINTS};
use crate::coordinates::ParsedCoordinates;
use crate::diagnostics::{Diagnostics, Span};
use crate::dimensions::Space;
use crate::joints::coupling;
use crate::keys::kinds;
use crate::kind::{kind_among, reject_unread_kind};
use crate::names::check;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;
use dwell_geometry::space::{Condition, Coordinate, CouplingAction, Joint, JointKind, Side, Vec3};
use dwell_geometry::{Coupling, JointId};
use std::f64::consts::TAU;

/// A joint as read; its contents are `None` if it is invalid, but its name counts as known.
#[derive(Debug)]
pub(super) struct ParsedJoint<'a> {
    pub(super) name: &'a str,
    pub(super) key: Span,
    pub(super) joint: Option<Joint>,
    /// Whether the zero of its angle is stated: by normals, or by frames with one axis.
    pub(super) has_zero: bool,
    pub(super) log: &'a Diagnostics,
}

/// All the joints as read.
#[derive(Debug)]
pub(crate) struct Joints<'a> {
    pub(super) list: Vec<ParsedJoint<'a>>,
    pub(super) couplings: Vec<Coupling<Coordinate>>,
    /// Couplings, which are read after the coordinates.
    pending_couplings: Vec<(usize, TableReader<'a>)>,
    pub(super) log: &'a Diagnostics,
}

impl<'a> Joints<'a> {
    pub(super) fn read(
        fields: Option<&TableReader<'a>>,
        bodies: &Bodies<'_, Space>,
        log: &'a Diagnostics,
    ) -> Self {
        let mut list = Vec::new();
        let mut pending_couplings = Vec::new();
        for (j, entry) in fields.iter().flat_map(|f| &f.entries).enumerate() {
            check("a joint", entry);
            entry.place(SceneLocation::Joint(JointId(j)));
            let count = log.count();
            let (joint, has_zero) = match read_joint(entry, JointId(j), bodies) {
                Some(ReadJoint::Coupling(fields)) => {
                    pending_couplings.push((j, fields));
                    (None, None)
                }
                Some(ReadJoint::Whole(joint, has_zero)) if log.count() == count => {
                    (Some(joint), Some(has_zero))
                }
                _ => (None, None),
            };
            list.push(ParsedJoint {
                name: entry.name,
                key: entry.key.clone(),
                joint,
                has_zero: has_zero.unwrap_or(true),
                log,
            });
        }
        Self {
            list,
            couplings: Vec::new(),
            pending_couplings,
            log,
        }
    }

    /// Reads the couplings, once the coordinates are known.
    pub(super) fn read_couplings(&mut self, named: &ParsedCoordinates<'_, Coordinate>) {
        for (k, fields) in std::mem::take(&mut self.pending_couplings) {
            let coupling = coupling(JointId(k), &fields, named);
            self.list[k].joint = coupling.and_then(|coupling| self.coupling_joint(k, coupling));
        }
    }

    /// The joint of a coupling, with bodies and sides of the dependent coordinate.
    fn coupling_joint(&mut self, k: usize, coupling: Coupling<Coordinate>) -> Option<Joint> {
        let (bodies, sides, action) = match coupling.dependent {
            Coordinate::Angle(joint) | Coordinate::Travel(joint) => {
                let joint = self.list.get(joint.0)?.joint.as_ref()?;
                let action = if coupling.dependent.is_angle() {
                    CouplingAction::Couple
                } else {
                    CouplingAction::Force
                };
                (joint.bodies, joint.sides, action)
            }
            Coordinate::Distance { bodies, points } => {
                let sides = points.map(|point| Side {
                    point,
                    ..Side::default()
                });
                (bodies, sides, CouplingAction::Line)
            }
        };
        let index = self.couplings.len();
        self.couplings.push(coupling);
        let kind = JointKind::Coupling { index, action };
        Some(Joint::new(self.list[k].name, bodies, kind, sides))
    }

    /// The joint of that name; `at` is where the text names it.
    pub(super) fn find(&self, name: &str, at: &Span) -> Option<usize> {
        let found = self.list.iter().position(|j| j.name == name);
        // Without any joint the scene has a greater problem, reported by now.
        if found.is_none() && !self.list.is_empty() {
            let help = self
                .log
                .choices(name, "joints", self.list.iter().map(|j| j.name));
            let message = format!("there is no joint `{}`", shorten(name));
            self.log.report(message, &[(at, "unknown joint")], help);
        }
        found
    }
}

/// The kinds of joints that exist only in the plane, and their counterparts in space.
const PLANAR_KINDS: [(&str, &str); 3] = [
    (
        "slot",
        "`point-on-line` keeps a point of the second body on a line of the first, as a slot does in the plane",
    ),
    (
        "rack",
        "a `gear` pair in which one of the bodies slides is a rack and a pinion",
    ),
    (
        "rolling",
        "a `gear` pair in which one of the bodies slides moves alike",
    ),
];

/// Rejects a kind of joint of scenes in the plane by its name.
fn reject_planar_kind(fields: &TableReader<'_>) -> Option<()> {
    let found = PLANAR_KINDS.iter().find_map(|(kind, help)| {
        let entry = fields.get(kind)?;
        Some((entry, kind, help))
    });
    match found {
        None => Some(()),
        Some((entry, kind, help)) => {
            let message = format!(
                "{}: a scene in space has no joint of kind `{kind}`",
                fields.what
            );
            entry.reject(message, "for scenes in the plane", *help)
        }
    }
}

/// A joint as far as it can be read before the coordinates.
enum ReadJoint<'a> {
    /// The joint, and whether the zero of its angle is stated.
    Whole(Joint, bool),
    /// A coupling, which names coordinates.
    Coupling(TableReader<'a>),
}

fn read_joint<'a>(
    entry: &Entry<'a>,
    id: JointId,
    bodies: &Bodies<'_, Space>,
) -> Option<ReadJoint<'a>> {
    let fields = TableReader::open(entry, format!("joint `{}`", shorten(entry.name)))?;
    reject_planar_kind(&fields)?;
    let (kind, kind_entry) = kind_among(&fields, "joint", &kinds("joints-in-space"))?;
    for key in ["axis", "axes"] {
        fields.place(key, SceneLocation::Axis(id));
    }
    let Some(kind) = JointKind::named(kind) else {
        return reject_unread_kind(kind_entry);
    };
    if kind.is_coupling() {
        return Some(ReadJoint::Coupling(fields));
    }
    if kind.holds(Condition::Teeth) {
        let joint = gear(entry.name, id, kind_entry, &fields, bodies)?;
        return Some(ReadJoint::Whole(joint, true));
    }
    let what = fields.name_of(kind_entry);
    let points = bodies.find_two_points(kind_entry.value, TWO_POINTS, what);
    let joint_kind = with_numbers(kind, &fields);
    let directions = directions(kind, &fields);
    let [a, b] = points?;
    let message = |name: &str| format!("{} joins body `{name}` to itself", fields.what);
    let help = "a joint holds two different bodies together";
    bodies.require_different([(a.0, &a.2), (b.0, &b.2)], message, help)?;
    for (k, point) in [&a, &b].into_iter().enumerate() {
        entry
            .log()
            .place(SceneLocation::JointPoint(id, k), &point.2);
    }
    let Directions {
        axes,
        normals,
        has_zero,
    } = directions?;
    let side = |k: usize, point| Side {
        point: bodies.at(point),
        axis: axes[k],
        normal: normals[k],
    };
    let sides = [side(0, &a), side(1, &b)];
    let joint = Joint::new(entry.name, [a.0, b.0], joint_kind?, sides);
    Some(ReadJoint::Whole(joint, has_zero))
}

/// A kind with its numbers.
fn with_numbers(kind: JointKind, fields: &TableReader<'_>) -> Option<JointKind> {
    Some(match kind {
        JointKind::Helical { .. } => {
            let help = "add `pitch = 5`: the travel for one revolution";
            let rule = NumberRule::new(&fields.units().length, SignRule::NotZero)
                .because("without travel it is a revolute joint");
            let pitch = fields.number("pitch", help, &rule)? / TAU;
            JointKind::Helical { pitch }
        }
        // Whether an actuator drives it is seen when all are read.
        JointKind::Distance { .. } if fields.get("length").is_none() => kind,
        JointKind::Distance { .. } => {
            let help = "add `length = 200`: the distance the two points keep";
            let rule = NumberRule::new(&fields.units().length, SignRule::Positive)
                .because("two coinciding points are a spherical joint");
            let length = fields.number("length", help, &rule)?;
            JointKind::Distance { length }
        }
        _ => kind,
    })
}

/// A gear pair: two wheels, the point of the carrier where their teeth meet, and the normal of the teeth there.
fn gear(
    name: &str,
    id: JointId,
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_, Space>,
) -> Option<Joint> {
    let wheels = bodies.find_two(entry.value, fields.name_of(entry));
    let help = "add `pitch-point = \"ground.P\"`: the point of the carrier where the teeth meet";
    let pitch = fields.require("pitch-point", help);
    let help =
        "add `normal = [0, 1, 0]`: the direction along which the teeth push each other there";
    let normal = fields.require("normal", help);
    let normal = normal.and_then(|n| direction(n.value, fields.name_of(n)));
    fields.place("normal", SceneLocation::Axis(id));
    let pitch = pitch?;
    let at = pitch.value.span();
    let point = bodies.find_point(pitch.value.string(fields.name_of(pitch))?, &at);
    let [a, b] = wheels?;
    let message = |name: &str| format!("{} joins body `{name}` to itself", fields.what);
    let ends = [(a.0, &a.1), (b.0, &b.1)];
    let wheels = bodies.require_different(ends, message, "a gear pair has two wheels")?;
    let (carrier, index) = point?;
    for (k, wheel) in [&a, &b].into_iter().enumerate() {
        fields
            .log()
            .place(SceneLocation::JointPoint(id, k), &wheel.1);
        if wheel.0 == carrier {
            let message = format!(
                "the pitch point of {} is a point of one of its wheels",
                fields.what
            );
            let help = "name a point of the body that carries both wheels: where the teeth meet does not turn with a wheel";
            let labels = [(&at, "this body"), (&wheel.1, "is a wheel here")];
            return fields.log().reject(message, &labels, help);
        }
    }
    let side = Side {
        point: bodies.at(&(carrier, index, at)),
        axis: normal?,
        normal: Vec3::ZERO,
    };
    let kind = JointKind::Gear { carrier };
    Some(Joint::new(name, wheels, kind, [side; 2]))
}

/// The axes of a joint and the normals from which its angle counts, in the frame of each body.
struct Directions {
    axes: [Vec3; 2],
    normals: [Vec3; 2],
    has_zero: bool,
}

fn directions(kind: JointKind, fields: &TableReader<'_>) -> Option<Directions> {
    let axes = axes(kind, fields)?;
    let given = two(fields, "normals");
    let is_common = axes[0] == axes[1];
    let has_zero = is_common || given.is_some();
    let needs_zero = kind.holds(Condition::Normals) || kind.holds(Condition::Thread);
    if !has_zero && needs_zero {
        let why = "with two axes nothing says how the bodies stand to each other";
        return missing_normals(fields, fields.get("axes"), why);
    }
    let normals = match given {
        Some(normals) => normals?,
        // Whatever the axis, the frames of both bodies are parallel at zero.
        None => axes.map(Vec3::any_normal),
    };
    for (k, name) in ["first", "second"].into_iter().enumerate() {
        let across = normals[k] - axes[k].scaled(axes[k].dot(normals[k]));
        if across.norm() < 1e-6 {
            let message = format!(
                "the {name} of the normals of {} lies along the axis",
                fields.what
            );
            let help = "give a direction across the axis";
            let entry = fields.get("normals")?;
            return entry.value.reject(message, "along the axis", help);
        }
    }
    Some(Directions {
        axes,
        normals,
        has_zero,
    })
}

/// Two directions under a key, if it is there.
fn two(fields: &TableReader<'_>, key: &str) -> Option<Option<[Vec3; 2]>> {
    let entry = fields.get(key)?;
    Some(two_directions(entry.value, &fields.name_of(entry)))
}

/// The axis of a joint in the frame of each body.
fn axes(kind: JointKind, fields: &TableReader<'_>) -> Option<[Vec3; 2]> {
    let is_needed = kind.has_axis() && kind != JointKind::Weld;
    match (is_needed, fields.get("axis"), two(fields, "axes")) {
        (false, None, None) => Some([Side::default().axis; 2]),
        (_, Some(axis), None) => {
            let axis = direction(axis.value, format_args!("the axis of {}", fields.what))?;
            Some([axis; 2])
        }
        (_, None, Some(axes)) => axes,
        (_, Some(a), Some(_)) => {
            let labels = ["the same axis in both bodies", "one axis for each body"];
            fields.reject_both(a, fields.get("axes")?, labels);
            None
        }
        (_, None, None) => {
            let (missing, help) = match kind.is_point_on(1) {
                _ if kind == JointKind::Universal => (
                    "`axes` is missing",
                    "add `axes = [[0, 1, 0], [1, 0, 0]]`: the axis of the cross on each body",
                ),
                true => (
                    "`axis` is missing",
                    "add `axis = [0, 0, 1]`, in the frame of the first body",
                ),
                false => (
                    "`axis` is missing",
                    "add `axis = [0, 0, 1]`, in the frames of both bodies, or `axes` with one for each",
                ),
            };
            let message = format!("{} has no axis", fields.what);
            fields
                .log()
                .reject(message, &[(&fields.key, missing)], help)
        }
    }
}

/// Reports normals that are needed.
pub(super) fn missing_normals<T>(
    fields: &TableReader<'_>,
    at: Option<&Entry<'_>>,
    why: &str,
) -> Option<T> {
    let help = "add `normals = [[1, 0, 0], [0, 1, 0]]`: a direction across the axis in the frame of each body, parallel at zero";
    let span = at.map_or_else(|| fields.key.clone(), |e| e.key.clone());
    fields.log().reject(
        format!("{} needs normals", fields.what),
        &[(&span, why)],
        help,
    )
}
