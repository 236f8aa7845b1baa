//! The named coordinates: those of the actuators, and those of `[coordinates]`.

use super::actuators::{ParsedActuator, joint_with_freedom};
use super::bodies::Space;
use super::joints::Joints;
use crate::bodies::{Bodies, TWO_POINTS};
use crate::coordinates::ParsedCoordinates;
use crate::keys::table;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::space::Coordinate;

/// All the coordinates that have a name.
pub(super) fn coordinates<'a>(
    actuators: &[ParsedActuator<'a>],
    fields: Option<&TableReader<'a>>,
    bodies: &Bodies<'_, Space>,
    joints: &Joints<'a>,
) -> ParsedCoordinates<'a, Coordinate> {
    let named = actuators.iter().map(|a| {
        let coordinate = a.actuator.as_ref().and_then(|a| {
            let joint = joints.list[a.kind.joint().0].joint.as_ref()?;
            Some(a.kind.coordinate(joint))
        });
        (&a.named, coordinate)
    });
    let read = |entry: &Entry<'a>| read_coordinate(entry, bodies, joints);
    ParsedCoordinates::read_by(named, fields, bodies, (joints.log, &read))
}

/// What a coordinate measures.
fn read_coordinate(
    entry: &Entry<'_>,
    bodies: &Bodies<'_, Space>,
    joints: &Joints<'_>,
) -> Option<Coordinate> {
    let fields = TableReader::open(entry, format!("coordinate `{}`", shorten(entry.name)))?;
    fields.reject_unknown_keys(table("coordinate-in-space"));
    let help =
        "add `angle = \"A\"` or `travel = \"slide\"` of a joint, or `length` with two points";
    let lacks = ("measures nothing", "which angle, travel or length?");
    let chosen = fields.alternative(table("coordinate-in-space"), lacks, help)?;
    match chosen.name {
        "angle" => joint_with_freedom(true, chosen, &fields, joints).map(Coordinate::Angle),
        "travel" => joint_with_freedom(false, chosen, &fields, joints).map(Coordinate::Travel),
        _ => {
            let what = fields.name_of(chosen);
            let [a, b] = bodies.find_two_points(chosen.value, TWO_POINTS, what)?;
            let message =
                |name: &str| format!("{} measures a length within body `{name}`", fields.what);
            let help = "a length that can change is between two different bodies";
            let points = [bodies.at(&a), bodies.at(&b)];
            let bodies = bodies.require_different([(a.0, &a.2), (b.0, &b.2)], message, help)?;
            Some(Coordinate::Distance { bodies, points })
        }
    }
}
