//! Friction in joints: loads that depend on the joints' own reactions and velocities.

use crate::diagnostics::Span;
use crate::joints::Joints;
use crate::keys::{TableSchema, table};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::{SI, Unit};
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;
use dwell_geometry::{JointId, JointKind};
use dwell_kinetostatics::{Friction, FrictionContact, Load, LoadKind, Magnitude};

/// Appends the friction of every joint of the section, in the order of the file.
pub(crate) fn add_friction(fields: &TableReader<'_>, joints: &Joints<'_>, loads: &mut Vec<Load>) {
    let mut assigned: Vec<(usize, Span)> = Vec::new();
    for entry in &fields.entries {
        let Some(range) = joints.find(entry.name, &entry.key) else {
            continue;
        };
        if let Some((k, other)) = assigned.iter().find(|(k, _)| range.contains(k)) {
            let name = shorten(&joints.list[*k].name);
            let message = format!("joint `{name}` has two friction tables");
            let labels = [(other, "here"), (&entry.key, "and here again")];
            let help =
                "keep one of them: the name of a pin of several bodies stands for all its joints";
            entry.log().report(message, &labels, help);
            continue;
        }
        assigned.extend(range.clone().map(|k| (k, entry.key.clone())));
        // The joints of a pin have the same friction: an error is reported once, for the first.
        let first = joints.list[range.start].joint.as_ref();
        let id = JointId(range.start);
        let parsed = first.and_then(|joint| read_friction(entry, id, joint.kind));
        if let Some((fields, friction, viscous)) = parsed {
            for k in range {
                add_loads(JointId(k), &fields, friction, viscous, joints, loads);
            }
        }
    }
}

/// Appends the friction of one joint, described by `fields`.
fn add_loads(
    id: JointId,
    fields: &TableReader<'_>,
    friction: Option<Friction>,
    viscous: Option<f64>,
    joints: &Joints<'_>,
    loads: &mut Vec<Load>,
) {
    let Some(joint) = &joints.list[id.0].joint else {
        return;
    };
    let bodies = joint.bodies;
    let [force, damper] = match joints.guide(id) {
        Some(guide) => [LoadKind::slide_force(guide), LoadKind::slide_damper(guide)],
        None => [
            LoadKind::couple(bodies),
            LoadKind::rotational_damper(bodies),
        ],
    };
    let in_joint = |friction| Friction {
        joint: id,
        ..friction
    };
    let dry = friction.map(in_joint).map(Magnitude::Friction);
    let viscous = viscous.map(Magnitude::Constant);
    let both = [
        ("coefficient", "friction", force, dry),
        ("viscous", "viscous", damper, viscous),
    ];
    push_loads(fields, &joint.name, both, loads);
}

/// Appends the loads of a joint that have a magnitude, each with the key of that and the end of its name.
pub(crate) fn push_loads<K, C>(
    fields: &TableReader<'_>,
    joint: &str,
    all: impl IntoIterator<Item = (&'static str, &'static str, K, Option<Magnitude<C>>)>,
    loads: &mut Vec<Load<K, C>>,
) {
    for (key, suffix, kind, magnitude) in all {
        let Some(magnitude) = magnitude else { continue };
        let location = SceneLocation::Load(loads.len());
        fields.log().place(location, &fields.key);
        fields.place(key, SceneLocation::Magnitude(loads.len()));
        let name = format!("{joint}.{suffix}");
        loads.push(Load {
            name,
            kind,
            magnitude,
        });
    }
}

/// The friction of a joint: its table, and its dry and viscous friction.
fn read_friction<'a>(
    entry: &Entry<'a>,
    joint: JointId,
    kind: JointKind,
) -> Option<(TableReader<'a>, Option<Friction>, Option<f64>)> {
    let name = shorten(entry.name);
    let fields = TableReader::open(entry, format!("friction of `{name}`"))?;
    let is_revolute = has_pin(entry, kind)?;
    let form = FrictionForm {
        table: if is_revolute {
            table("revolute-friction")
        } else {
            table("prismatic-friction")
        },
        joint_kind: kind.name(),
        is_angular: is_revolute,
        pin: is_revolute.then_some(|radius, _| FrictionContact::Pin { radius }),
        is_slot: matches!(kind, JointKind::Slot { .. }),
    };
    let (friction, viscous) = form.read(joint, &fields)?;
    Some((fields, friction, viscous))
}

/// How the friction of a joint is written.
pub(crate) struct FrictionForm<'k> {
    /// Its keys.
    pub(crate) table: &'static TableSchema,
    /// The kind of its joint.
    pub(crate) joint_kind: &'k str,
    /// Whether the speed of its surfaces is an angular velocity.
    pub(crate) is_angular: bool,
    /// For a pin: the contact from its radius and the distance of its bearings, m; `None` for a guide.
    pub(crate) pin: Option<fn(f64, f64) -> FrictionContact>,
    /// Whether its pin touches at one point.
    pub(crate) is_slot: bool,
}

impl FrictionForm<'_> {
    /// The dry friction of a joint that a table gives, and its viscous friction; `None` if something is wrong.
    pub(crate) fn read(
        &self,
        joint: JointId,
        fields: &TableReader<'_>,
    ) -> Option<(Option<Friction>, Option<f64>)> {
        let before = fields.log().count();
        self.check_keys(fields);
        let number = |key: &str, unit: &Unit, sign: SignRule| {
            let entry = fields.get(key)?;
            let rule = NumberRule::new(unit, sign);
            entry.value.quantity_with_sign(&rule, fields.name_of(entry))
        };
        let units = fields.units();
        let coefficient = number("coefficient", &SI, SignRule::NotNegative);
        let static_coefficient = number("static-coefficient", &SI, SignRule::NotNegative);
        let radius = number("radius", &units.length, SignRule::Positive);
        let guide = number("guide-length", &units.length, SignRule::NotNegative);
        let bearings = number("bearing-distance", &units.length, SignRule::NotNegative);
        let speed_unit = units.coordinate_unit(self.is_angular);
        let speed = number("regularization-speed", speed_unit, SignRule::Positive);
        let viscous = number("viscous", &SI, SignRule::NotNegative);
        // A guide in its place is one slip, not two.
        let has_guide = fields.get("guide-length").is_some();
        if self.pin.is_some() && fields.get("coefficient").is_some() && !has_guide {
            let unit = &units.length.name;
            let help = format!("add `radius`, the radius of the pin, in {unit}");
            fields.require("radius", &help);
        }
        if fields.log().count() > before {
            return None;
        }
        let length = guide.or(bearings).unwrap_or(0.0);
        let contact = match self.pin {
            Some(pin) => pin(radius.unwrap_or(0.0), length),
            None => FrictionContact::Guide { length },
        };
        let friction = coefficient.map(|coefficient| Friction {
            joint,
            coefficient,
            static_coefficient: static_coefficient.unwrap_or(coefficient),
            contact,
            regularization_speed: speed,
        });
        if let Some(friction) = &friction {
            check_static_coefficient(fields, friction)?;
        }
        Some((friction, viscous))
    }
}

/// Rejects a static coefficient below the coefficient. With a regularisation speed it has no effect, because nothing
/// sticks.
fn check_static_coefficient(fields: &TableReader<'_>, friction: &Friction) -> Option<()> {
    let Some(entry) = fields.get("static-coefficient") else {
        return Some(());
    };
    if friction.regularization_speed.is_some() {
        let message = format!(
            "{} has a `regularization-speed`, so that it does not hold at rest",
            fields.what
        );
        let label = "without effect";
        fields.log().warn(message, label, entry.value.span());
    }
    if friction.static_coefficient >= friction.coefficient {
        return Some(());
    }
    entry.reject(
        format!(
            "the `static-coefficient` of {} is below its `coefficient` {}",
            fields.what, friction.coefficient
        ),
        "surfaces at rest hold at least as much as they do when they slide",
        "exchange the two, or leave this out: it is then the same as `coefficient`",
    )
}

/// Whether the friction of a joint is that of a pin, not of a guide; an error for a joint that cannot have friction.
fn has_pin(entry: &Entry<'_>, kind: JointKind) -> Option<bool> {
    if kind.is_pin() || kind.travel_axis().is_some() {
        return Some(kind.is_pin());
    }
    let message = format!("joint `{}` cannot have friction", shorten(entry.name));
    let label = format!("its kind is {}", kind.name());
    let help = "revolute joints, prismatic joints and slots can have friction";
    entry.reject(message, &label, help)
}

impl FrictionForm<'_> {
    /// Reports keys that do not belong to this kind of joint, and missing ones of dry friction.
    fn check_keys(&self, fields: &TableReader<'_>) {
        let table = self.table;
        let dry = fields.get("coefficient");
        // What seems to be missing may be a key that is misspelt.
        let misspelt = fields.unknown_entries(table).next().is_some();
        if dry.is_none() && fields.get("viscous").is_none() && !misspelt {
            let (missing, help) = if table.contains_key("viscous") {
                (
                    "neither `coefficient` nor `viscous`",
                    "add a `coefficient` of dry friction, or `viscous`",
                )
            } else {
                ("no `coefficient`", "add a `coefficient` of dry friction")
            };
            let message = format!("{} has {missing}", fields.what);
            let labels = [(&fields.span, "no friction is given")];
            return fields.log().report(message, &labels, help);
        }
        for entry in &fields.entries {
            let (name, what) = (entry.written(), &fields.what);
            let other = |help| (format!("{what} has no `{name}`"), help);
            let known = table.contains_key(entry.name);
            let (message, help) = match entry.name {
                "radius" if !known => other("`guide-length` is the length of a slide"),
                "guide-length" if !known => other("`radius` is that of a pin"),
                "guide-length" if self.is_slot => {
                    other("the pin of a slot touches it at one point: leave it out")
                }
                "radius"
                | "guide-length"
                | "bearing-distance"
                | "static-coefficient"
                | "regularization-speed"
                    if known && dry.is_none() && !misspelt =>
                {
                    (
                        format!("{what} has a `{name}` but no `coefficient`"),
                        "it belongs to dry friction: add `coefficient`, or leave it out",
                    )
                }
                _ if known => continue,
                _ => {
                    fields.report_unknown_key(entry, "keys here", table.names());
                    continue;
                }
            };
            let label = format!("its kind is {}", self.joint_kind);
            entry.reject::<()>(message, &label, help);
        }
    }
}
