//! End stops: limits of free coordinates.

use crate::coordinates::ParsedActuator;
use crate::keys::table;
use crate::motion::ParsedMotion;
use crate::names::check;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;
use dwell_geometry::ActuatorId;

/// An end stop of an actuator's coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedStop {
    /// Its name.
    pub name: String,
    /// The actuator.
    pub actuator: ActuatorId,
    /// Lower limit, rad or m, if there is one.
    pub min: Option<f64>,
    /// Upper limit, rad or m, if there is one.
    pub max: Option<f64>,
    /// Coefficient of restitution, from 0 to 1.
    pub restitution: f64,
}

/// The end stops of the section.
pub(crate) fn stops(
    fields: &TableReader<'_>,
    actuators: &[ParsedActuator<'_>],
    motion: Option<&ParsedMotion<'_>>,
) -> Vec<NamedStop> {
    let one = |(k, entry): (usize, &Entry<'_>)| {
        check("an end stop", entry);
        entry.log().place(SceneLocation::Stop(k), &entry.key);
        stop(entry, actuators, motion)
    };
    fields.entries.iter().enumerate().filter_map(one).collect()
}

fn stop(
    entry: &Entry<'_>,
    actuators: &[ParsedActuator<'_>],
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
            &fields.log().choices(name, "actuators", names),
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
    let limit = |key: &str| {
        let entry = fields.get(key)?;
        let rule = NumberRule::new(unit, SignRule::Any);
        Some(entry.value.quantity_with_sign(&rule, fields.name_of(entry)))
    };
    let (min, max) = (limit("min"), limit("max"));
    let restitution = fields.number_or(
        0.0,
        "restitution",
        &NumberRule::new(&SI, SignRule::NotNegative),
    )?;
    if restitution > 1.0 {
        let at = fields.get("restitution")?;
        return at.reject(
            format!("the restitution of {} is above 1", fields.what),
            "from 0 to 1",
            "1 is a rebound without loss, 0 one without rebound",
        );
    }
    // What could not be read is an error already.
    let (min, max) = (
        min.map_or(Some(None), |m| m.map(Some))?,
        max.map_or(Some(None), |m| m.map(Some))?,
    );
    if min.is_none() && max.is_none() {
        return entry.reject(
            format!("{} has neither `min` nor `max`", fields.what),
            "no limit is given",
            "add the lower limit `min`, the upper limit `max`, or both",
        );
    }
    if let (Some(low), Some(high)) = (min, max)
        && low >= high
    {
        return entry.reject(
            format!("the `min` of {} is not below its `max`", fields.what),
            "no room between them",
            "exchange the two",
        );
    }
    Some(NamedStop {
        name: entry.name.to_owned(),
        actuator: ActuatorId(k),
        min,
        max,
        restitution,
    })
}
