//! End stops: limits of free coordinates.

use crate::coordinates::NamedActuator;
use crate::keys::table;
use crate::motion::ParsedMotion;
use crate::names::read_each;
use crate::scene_data::NamedStop;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::{SI, Unit};
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;
use dwell_geometry::ActuatorId;

/// The end stops of the section.
pub(crate) fn stops(
    fields: &TableReader<'_>,
    actuators: &[NamedActuator<'_>],
    motion: Option<&ParsedMotion<'_>>,
) -> Vec<NamedStop> {
    read_each(fields, "an end stop", SceneLocation::Stop, |_, entry| {
        stop(entry, actuators, motion)
    })
}

fn stop(
    entry: &Entry<'_>,
    actuators: &[NamedActuator<'_>],
    motion: Option<&ParsedMotion<'_>>,
) -> Option<NamedStop> {
    let fields = TableReader::open(entry, format!("end stop `{}`", shorten(entry.name)))?;
    fields.reject_unknown_keys(table("stop"));
    let named = fields.require("coordinate", "add the actuator whose coordinate it limits")?;
    let name = named.value.string(fields.name_of(named))?;
    let Some(k) = actuators.iter().position(|a| a.name == name) else {
        let names = actuators.iter().map(|a| a.name);
        return named.reject(
            format!("there is no actuator `{}`", shorten(name)),
            "unknown actuator",
            fields.log().choices(name, "actuators", names),
        );
    };
    let prescribed = motion.and_then(|motion| motion.prescribed.get(k)?.as_ref());
    if prescribed.is_some() {
        return named.reject(
            format!(
                "end stop `{}` limits `{}`, which is prescribed",
                shorten(entry.name),
                shorten(name)
            ),
            "prescribed in [motion]",
            "an end stop limits a free coordinate: leave out the stop, or the motion law",
        );
    }
    let unit = fields.units().coordinate_unit(actuators[k].is_angle());
    let restitution = restitution(&fields)?;
    let yielding = yielding(&fields)?;
    let [min, max] = limits(entry, &fields, unit)?;
    Some(NamedStop {
        name: entry.name.to_owned(),
        actuator: ActuatorId(k),
        min,
        max,
        restitution,
        yielding,
    })
}

/// Stiffness and damping of a compliant stop; the outer `None` if they are invalid.
fn yielding(fields: &TableReader<'_>) -> Option<Option<[f64; 2]>> {
    let damping = fields.get("damping");
    let Some(stiffness) = fields.get("stiffness") else {
        return match damping {
            None => Some(None),
            Some(damping) => damping.reject(
                format!("{} has a `damping` without `stiffness`", fields.what),
                "the damper of a spring",
                "add the `stiffness` of the stop; a rigid one loses energy by its `restitution`",
            ),
        };
    };
    if let Some(restitution) = fields.get("restitution") {
        return restitution.reject(
            format!("{} has both `restitution` and `stiffness`", fields.what),
            "of a rigid stop",
            "keep `restitution` for a rigid stop, or `stiffness` and `damping` for one that yields",
        );
    }
    let rule = NumberRule::new(&SI, SignRule::Positive);
    let value = stiffness.value;
    let stiffness = value.quantity_with_sign(&rule, fields.name_of(stiffness))?;
    let rule = NumberRule::new(&SI, SignRule::NotNegative);
    let damping = fields.number_or(0.0, "damping", &rule)?;
    Some(Some([stiffness, damping]))
}

/// The coefficient of restitution, from 0 to 1.
fn restitution(fields: &TableReader<'_>) -> Option<f64> {
    let rule = NumberRule::new(&SI, SignRule::NotNegative);
    let restitution = fields.number_or(0.0, "restitution", &rule)?;
    if restitution > 1.0 {
        return fields.get("restitution")?.reject(
            format!("the restitution of {} is above 1", fields.what),
            "from 0 to 1",
            "1 is a rebound without loss, 0 one without rebound",
        );
    }
    Some(restitution)
}

/// The limits, of which one at least is given, in ascending order.
fn limits(entry: &Entry<'_>, fields: &TableReader<'_>, unit: &Unit) -> Option<[Option<f64>; 2]> {
    let mut limits = [None; 2];
    for (limit, key) in limits.iter_mut().zip(["min", "max"]) {
        if let Some(given) = fields.get(key) {
            let rule = NumberRule::new(unit, SignRule::Any);
            let value = given.value.quantity_with_sign(&rule, fields.name_of(given));
            *limit = Some(value?);
        }
    }
    match limits {
        [None, None] => entry.reject(
            format!("{} has neither `min` nor `max`", fields.what),
            "no limit is given",
            "add the lower limit `min`, the upper limit `max`, or both",
        ),
        [Some(low), Some(high)] if low >= high => entry.reject(
            format!("the `min` of {} is not below its `max`", fields.what),
            "no room between them",
            "exchange the two",
        ),
        _ => Some(limits),
    }
}
