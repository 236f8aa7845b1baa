//! Friction in joints: loads that the joints' own reactions and speeds make.

use crate::fields::{Entry, Fields, Sign, signed};
use crate::joints::{Joints, word};
use crate::keys::{RUBBING_PIN, RUBBING_SLIDE};
use crate::loads::LoadText;
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use crate::units::{Unit, Units};
use dwell_geometry::{Joint, JointId, JointKind};
use dwell_kinetostatics::{Friction, Load, LoadKind, Magnitude};

/// Speed at which dry friction fades where the scene gives none, rad/s and m/s: small beside the speed
/// of a machine, and still no stiff equation for an explicit method.
const FADE: [f64; 2] = [0.01, 0.001];

/// The friction of every joint of the section: loads, in the order of the file.
pub(crate) fn friction(
    fields: &Fields<'_>,
    joints: &Joints<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Vec<LoadText> {
    let mut loads = Vec::new();
    let mut rubbed: Vec<(usize, Span)> = Vec::new();
    for entry in &fields.entries {
        let Some(range) = joints.find(entry.name, &entry.key, problems) else {
            continue;
        };
        if let Some((k, other)) = rubbed.iter().find(|(k, _)| range.contains(k)) {
            let name = shorten(&joints.list[*k].name);
            problems.push(
                Problem::new(format!("joint `{name}` rubs twice"))
                    .at(other.clone(), "here")
                    .at(entry.key.clone(), "and here again")
                    .help("keep one of them: the name of a pin of several bodies is that of all its joints"),
            );
            continue;
        }
        rubbed.extend(range.clone().map(|k| (k, entry.key.clone())));
        // The joints of a pin rub alike: what is wrong is said once, of the first.
        let Some(first) = &joints.list[range.start].joint else {
            continue;
        };
        let Some(rub) = Rub::read(entry, first.kind, units, problems) else {
            continue;
        };
        for k in range {
            if let Some(joint) = &joints.list[k].joint {
                loads.extend(rub.loads(entry, JointId(k), joint, joints));
            }
        }
    }
    loads
}

/// How a joint rubs: each with where it is written.
struct Rub {
    /// Coefficient, radius or guide, and fading speed.
    dry: Option<([f64; 3], Span)>,
    viscous: Option<(f64, Span)>,
}

impl Rub {
    fn read(
        entry: &Entry<'_>,
        kind: JointKind,
        units: &Units,
        problems: &mut Problems,
    ) -> Option<Self> {
        let name = shorten(entry.name);
        let fields = Fields::open(entry, format!("friction of `{name}`"), problems)?;
        let turns = match kind {
            JointKind::Revolute => true,
            JointKind::Prismatic { .. } | JointKind::Slot { .. } => false,
            _ => {
                problems.push(
                    Problem::new(format!("joint `{name}` does not rub"))
                        .at(entry.key.clone(), format!("its kind is {}", word(kind)))
                        .help("revolute joints, prismatic joints and slots rub"),
                );
                return None;
            }
        };
        let before = problems.count();
        keys_of(&fields, kind, problems);
        let number = |key: &str, unit: &Unit, sign: Sign, problems: &mut Problems| {
            let entry = fields.get(key)?;
            let what = format_args!("{key} of {}", fields.what);
            let si = signed(entry.value, unit, sign, what, "", problems)?;
            Some((si, entry.value.span()))
        };
        let si = Unit::of_si();
        let coefficient = number("coefficient", &si, Sign::NotNegative, problems);
        let radius = number("radius", &units.length, Sign::Positive, problems);
        let guide = number("guide", &units.length, Sign::NotNegative, problems);
        let fade = number("fade", units.of(turns), Sign::Positive, problems);
        let viscous = number("viscous", &si, Sign::NotNegative, problems);
        // A guide in its place is one slip, not two.
        if turns && fields.get("coefficient").is_some() && fields.get("guide").is_none() {
            let help = format!("add `radius`: that of the pin, in {}", units.length.name);
            fields.need("radius", &entry.key, &help, problems);
        }
        if problems.count() != before {
            return None;
        }
        let [fade_of_pins, fade_of_slides] = FADE;
        let (size, default) = match turns {
            true => (radius, fade_of_pins),
            false => (guide, fade_of_slides),
        };
        let (size, fade) = (size.map_or(0.0, |s| s.0), fade.map_or(default, |f| f.0));
        Some(Self {
            dry: coefficient.map(|(coefficient, at)| ([coefficient, size, fade], at)),
            viscous,
        })
    }

    fn loads(
        &self,
        entry: &Entry<'_>,
        id: JointId,
        joint: &Joint,
        joints: &Joints<'_>,
    ) -> Vec<LoadText> {
        let bodies = joint.bodies;
        let [force, damper] = match joints.guide(id) {
            Some(guide) => [LoadKind::Slide(guide), LoadKind::SlideDamper(guide)],
            None => [
                LoadKind::Torque { bodies },
                LoadKind::TorsionDamper { bodies },
            ],
        };
        let dry = self.dry.as_ref().map(|([coefficient, size, fade], at)| {
            let friction = Friction {
                joint: id,
                coefficient: *coefficient,
                size: *size,
                fade: *fade,
            };
            ("friction", force, Magnitude::Friction(friction), at)
        });
        let viscous = self.viscous.as_ref();
        let viscous =
            viscous.map(|(constant, at)| ("viscous", damper, Magnitude::Constant(*constant), at));
        let both = dry.into_iter().chain(viscous);
        let text = |(word, kind, magnitude, at): (&str, _, _, &Span)| LoadText {
            key: entry.key.clone(),
            magnitude: Some(at.clone()),
            load: Some(Load {
                name: format!("{}.{word}", joint.name),
                kind,
                magnitude,
            }),
        };
        both.map(text).collect()
    }
}

/// Says which keys are none of this kind of joint's, and what dry friction lacks.
fn keys_of(fields: &Fields<'_>, kind: JointKind, problems: &mut Problems) {
    let table = match kind {
        JointKind::Revolute => &RUBBING_PIN,
        _ => &RUBBING_SLIDE,
    };
    let is_slot = matches!(kind, JointKind::Slot { .. });
    let dry = fields.get("coefficient");
    // What seems to be missing may be a key that is misspelt.
    let misspelt = fields.has_others_than(table);
    if dry.is_none() && fields.get("viscous").is_none() && !misspelt {
        problems.push(
            Problem::new(format!(
                "{} has neither `coefficient` nor `viscous`",
                fields.what
            ))
            .at(fields.span.clone(), "how does it rub?")
            .help("add a `coefficient` of dry friction, or `viscous`"),
        );
        return;
    }
    for entry in &fields.entries {
        let (name, what) = (entry.name, &fields.what);
        let other = |help| (format!("{what} has no `{name}`"), help);
        let (message, help) = match name {
            "radius" if !table.knows(name) => other("`guide` is the length of a slide"),
            "guide" if !table.knows(name) => other("`radius` is that of a pin"),
            "guide" if is_slot => other("the pin of a slot presses at one point: leave it out"),
            "radius" | "guide" | "fade" if dry.is_none() && !misspelt => (
                format!("{what} has a `{name}` but no `coefficient`"),
                "it is a number of dry friction: add its coefficient, or leave it out",
            ),
            _ if table.knows(name) => continue,
            _ => {
                fields.unknown(entry, "keys here", table.names(), problems);
                continue;
            }
        };
        let label = format!("its kind is {}", word(kind));
        problems.push(
            Problem::new(message)
                .at(entry.key.clone(), label)
                .help(help),
        );
    }
}
