//! Approximately where the bodies are at assembly.

use super::values::{angles, point};
use crate::assembly::AssemblyNotation;
use crate::dimensions::Space;
use crate::keys::table;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::space::{Placement, Rotation, Vec3};

impl AssemblyNotation for Space {
    type Guess = Placement;
    const NAMED: [&'static str; 2] = ["neither an actuator nor a body", "actuators and bodies"];

    fn guess(entry: &Entry<'_>, what: String, is_ground: bool) -> Option<Placement> {
        if is_ground {
            let message = format!("the ground `{}` cannot be placed", shorten(entry.name));
            let help = "leave it out: its frame is the frame of the scene";
            let value = entry.value;
            value.reject::<()>(message, "it stays where it is", help);
        }
        placement(entry, what)
    }
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
