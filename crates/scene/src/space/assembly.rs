//! The coordinates at assembly, and approximately where the bodies are then.

use super::actuators::ParsedActuator;
use super::bodies::Space;
use super::values::{angles, point};
use crate::bodies::Bodies;
use crate::keys::table;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::space::{Assembly, Placement, Rotation, Vec3};
use dwell_geometry::{ActuatorId, BodyId};

pub(super) fn assembly(
    fields: Option<&TableReader<'_>>,
    bodies: &Bodies<'_, Space>,
    actuators: &[ParsedActuator<'_>],
) -> Assembly {
    let mut found = Assembly {
        q: vec![0.0; actuators.len()],
        placements: vec![Placement::default(); bodies.list.len()],
    };
    for entry in fields.iter().flat_map(|f| &f.entries) {
        let name = entry.name;
        let what = format!("`{}` in [assembly]", shorten(name));
        let place = |location| entry.log().place(location, &entry.span());
        if let Some(k) = actuators.iter().position(|a| a.name == name) {
            let value = entry.value.coordinate(actuators[k].is_angle(), what);
            found.q[k] = value.unwrap_or_default();
            place(SceneLocation::AssemblyCoordinate(ActuatorId(k)));
        } else if let Some(k) = bodies.position(name) {
            place(SceneLocation::InitialGuess(BodyId(k)));
            found.placements[k] = placement(entry, what).unwrap_or_default();
            if bodies.ground == Some(k) {
                let message = format!("the ground `{}` cannot be placed", shorten(name));
                let help = "leave it out: its frame is the frame of the scene";
                entry
                    .value
                    .reject::<()>(message, "it stays where it is", help);
            }
        } else {
            let names = actuators.iter().map(|a| a.name);
            let names = names.chain(bodies.list.iter().map(|b| b.name));
            let help = entry.log().choices(name, "actuators and bodies", names);
            let message = format!("{what} is neither an actuator nor a body");
            entry.reject::<()>(message, "unknown name", help);
        }
    }
    found
}

fn placement(entry: &Entry<'_>, what: String) -> Option<Placement> {
    if entry.value.is_number() {
        let message = format!("{what}: a number does not place a body in space");
        let help = "write where it is, as in `{ at = [100, 0, 0], turn = [0, 0, 90] }`";
        return entry.value.reject(message, "expected a table", help);
    }
    let fields = TableReader::open(entry, what)?;
    fields.reject_unknown_keys(table("placement"));
    let position = fields.get("at").map(|e| point(e.value, &fields.name_of(e)));
    let turn = fields.get("turn");
    let turn = turn.map(|e| angles(e.value, &fields.name_of(e)));
    let [position, turn] = [position, turn].map(|given| given.unwrap_or(Some(Vec3::ZERO)));
    Some(Placement {
        position: position?,
        rotation: Rotation::of_vector(turn?),
    })
}
