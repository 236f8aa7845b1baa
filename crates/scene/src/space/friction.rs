//! Friction in joints: loads that depend on the joints' own reactions and velocities.

use super::joints::Joints;
use crate::friction::{FrictionForm, push_loads};
use crate::keys::table;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::JointId;
use dwell_geometry::space::JointKind;
use dwell_kinetostatics::space::{Load, LoadKind};
use dwell_kinetostatics::{FrictionContact, Magnitude};

/// Appends the friction of every joint of the section, in the order of the file.
pub(super) fn add_friction(fields: &TableReader<'_>, joints: &Joints<'_>, loads: &mut Vec<Load>) {
    for entry in &fields.entries {
        let Some(j) = joints.find(entry.name, &entry.key) else {
            continue;
        };
        if let Some(joint) = &joints.list[j].joint {
            // What is wrong is reported; then there is no scene.
            let _ = add_loads(entry, JointId(j), joint.kind, loads);
        }
    }
}

/// Appends the loads of the friction of one joint; none if something in it is wrong.
fn add_loads(entry: &Entry<'_>, id: JointId, kind: JointKind, loads: &mut Vec<Load>) -> Option<()> {
    let name = shorten(entry.name);
    let fields = TableReader::open(entry, format!("friction of `{name}`"))?;
    let (friction, viscous) = form(entry, kind)?.read(id, &fields)?;
    let dry = friction.map(Magnitude::Friction);
    let viscous = viscous.map(Magnitude::Constant);
    let (force, couple) = (LoadKind::slide_force(id), LoadKind::couple(id));
    let [slide_damper, damper] = [LoadKind::slide_damper(id), LoadKind::rotational_damper(id)];
    let all = match kind {
        JointKind::Prismatic => vec![
            ("coefficient", "friction", force, dry),
            ("viscous", "viscous", slide_damper, viscous),
        ],
        // What holds at rest is one force, along the velocity of the surface.
        JointKind::Cylindrical if friction.is_some_and(|f| f.regularization_speed.is_none()) => {
            vec![("coefficient", "friction", force, dry)]
        }
        JointKind::Cylindrical => vec![
            ("coefficient", "friction", force, dry.clone()),
            ("coefficient", "friction-moment", couple, dry),
        ],
        _ => vec![
            ("coefficient", "friction", couple, dry),
            ("viscous", "viscous", damper, viscous),
        ],
    };
    push_loads(&fields, entry.name, all, loads);
    Some(())
}

/// How the friction of a joint is written; an error for a joint that cannot have friction.
fn form(entry: &Entry<'_>, kind: JointKind) -> Option<FrictionForm<'static>> {
    let (table_id, is_angular) = match kind {
        JointKind::Revolute => ("revolute-friction-in-space", true),
        JointKind::Prismatic => ("prismatic-friction-in-space", false),
        JointKind::Cylindrical => ("cylindrical-friction", false),
        _ => {
            let message = format!("joint `{}` cannot have friction", shorten(entry.name));
            let label = format!("its kind is {}", kind.name());
            let help = "revolute, prismatic and cylindrical joints can have friction; a `joint-torque` or a damper in [loads] \
                        can stand for that of another";
            return entry.reject(message, &label, help);
        }
    };
    Some(FrictionForm {
        table: table(table_id),
        joint_kind: kind.name(),
        is_angular,
        pin: (kind != JointKind::Prismatic)
            .then_some(|radius, distance| FrictionContact::Bearing { radius, distance }),
        is_slot: false,
    })
}
