//! The free motion, and the calibration of one number to a period.

use crate::coordinates::NamedActuator;
use crate::keys::table;
use crate::number_paths::{SceneNumber, no_number};
use crate::prescribed::{actuator_named, law_of, positive, require_actuators};
use crate::scene_data::{Calibration, FreeMotionSpec, MotionDuration, NamedEvent};
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::wording::{list, shorten};
use dwell_geometry::ActuatorId;
use dwell_laws::Law;
use std::fmt::Display;

/// `[motion]` as read: the values of each actuator, in rad and rad/s or m and m/s.
#[derive(Debug)]
pub(crate) struct ParsedMotion<'a> {
    pub(crate) initial_coordinates: Vec<Option<f64>>,
    pub(crate) initial_velocities: Vec<Option<f64>>,
    pub(crate) duration: Option<MotionDuration>,
    /// The entry of each prescribed actuator's motion law.
    pub(crate) prescribed: Vec<Option<Entry<'a>>>,
    /// The laws of these, which [`Self::read_laws`] reads.
    pub(crate) laws: Vec<Option<Law>>,
}

impl<'a> ParsedMotion<'a> {
    /// `can_start_at_rest`: loads or drives can move the mechanism.
    pub(crate) fn read(
        fields: &TableReader<'a>,
        actuators: &[NamedActuator<'_>],
        can_start_at_rest: bool,
    ) -> Self {
        fields.reject_unknown_keys(table("motion"));
        let mut parsed = Self {
            initial_coordinates: vec![None; actuators.len()],
            initial_velocities: vec![None; actuators.len()],
            duration: duration(fields),
            prescribed: vec![None; actuators.len()],
            laws: vec![None; actuators.len()],
        };
        if require_actuators(fields, actuators).is_none() {
            return parsed;
        }
        let all_known = parsed.find_prescribed(fields, actuators);
        let prescribed = &parsed.prescribed;
        let each = |key, location| {
            let per_actuator = PerActuator {
                key,
                location,
                actuators,
                prescribed,
            };
            per_actuator.read(fields.get(key))
        };
        let initial_coordinates = each("initial-coordinate", SceneLocation::InitialCoordinate);
        let initial_velocities = each("initial-velocity", SceneLocation::InitialVelocity);
        if let Some(initial_velocities) = &initial_velocities
            && all_known
            && !can_start_at_rest
            && parsed.prescribed.iter().all(Option::is_none)
        {
            report_missing_velocities(fields, actuators, initial_velocities);
        }
        if all_known {
            parsed.count_free(fields, actuators);
        }
        parsed.initial_coordinates = initial_coordinates.unwrap_or(parsed.initial_coordinates);
        parsed.initial_velocities = initial_velocities.unwrap_or(parsed.initial_velocities);
        parsed
    }

    /// Finds the prescribed actuators; returns false if a name is unknown.
    fn find_prescribed(
        &mut self,
        fields: &TableReader<'a>,
        actuators: &[NamedActuator<'_>],
    ) -> bool {
        let count = fields.log().count();
        let laws = fields.get("prescribed");
        let laws = laws.and_then(|e| TableReader::open(e, "prescribed of [motion]"));
        for entry in laws.iter().flat_map(|f| &f.entries) {
            if let Some(k) = actuator_named(entry, actuators) {
                let location = SceneLocation::MotionLaw(ActuatorId(k));
                entry.place(location);
                self.prescribed[k] = Some(entry.clone());
            }
        }
        fields.log().count() == count
    }

    /// Checks that at least one actuator is free, and exactly one if the duration is in periods.
    fn count_free(&self, fields: &TableReader<'_>, actuators: &[NamedActuator<'_>]) {
        let free = (0..actuators.len()).filter(|&k| self.prescribed[k].is_none());
        let free: Vec<_> = free.map(|k| actuators[k].name).collect();
        let names = list(free.iter().copied());
        if let (None, Some(laws)) = (&names, fields.get("prescribed")) {
            let message = "[motion] prescribes every actuator: none is free";
            let help = "a motion in which all actuators are prescribed belongs in [prescribed]";
            laws.reject::<()>(message, "all of them", help);
        }
        if let (Some(names), Some(periods)) = (names, fields.get("periods"))
            && free.len() > 1
        {
            let message = format!("`periods` with {} free actuators", free.len());
            let label = "ambiguous: several actuators are free";
            let help = format!("{names} are free: give the duration in s, as in `duration = 5.0`");
            periods.reject::<()>(message, label, help);
        }
    }

    /// Reads the laws of the prescribed actuators, which start at `assembly_coordinates` (SI, by actuator).
    pub(crate) fn read_laws(
        &mut self,
        actuators: &[NamedActuator<'_>],
        assembly_coordinates: &[f64],
    ) {
        let end = match self.duration {
            Some(MotionDuration::Seconds(end)) => end,
            // How long periods take is not known yet, and no length has been reported.
            _ => 0.0,
        };
        for (k, actuator) in actuators.iter().enumerate() {
            if let Some(entry) = &self.prescribed[k] {
                let start = assembly_coordinates[k];
                self.laws[k] = law_of(entry, "[motion.prescribed]", actuator, start, end);
            }
        }
    }

    /// The free motion; coordinates without an initial value are at `start`.
    pub(crate) fn into_spec<C, R>(
        self,
        start: &[f64],
        events: Vec<NamedEvent<C, R>>,
    ) -> Option<FreeMotionSpec<C, R>> {
        let (mut initial_coordinates, mut initial_velocities) = (Vec::new(), Vec::new());
        for (k, &at) in start.iter().enumerate() {
            let prescribed = self.laws[k].as_ref().map(|law| law.eval(0.0));
            // A law that has no value at 0 is reported by the analysis that follows it.
            let prescribed = prescribed.filter(|values| values[..2].iter().all(|v| v.is_finite()));
            let [q, v] = prescribed.map_or([None; 2], |[q, v, ..]| [Some(q), Some(v)]);
            initial_coordinates.push(q.or(self.initial_coordinates[k]).unwrap_or(at));
            initial_velocities.push(v.or(self.initial_velocities[k]).unwrap_or(0.0));
        }
        Some(FreeMotionSpec {
            initial_coordinates,
            initial_velocities,
            laws: self.laws,
            duration: self.duration?,
            events,
        })
    }
}

/// Reports missing initial velocities of a motion without loads, drives and motion laws.
fn report_missing_velocities(
    fields: &TableReader<'_>,
    actuators: &[NamedActuator<'_>],
    initial_velocities: &[Option<f64>],
) {
    let missing = (0..actuators.len()).filter(|&k| initial_velocities[k].is_none());
    let missing: Vec<_> = missing.map(|k| &actuators[k]).collect();
    let Some(names) = list(missing.iter().map(|a| a.name)) else {
        return;
    };
    let given = fields.get("initial-velocity");
    let at = given.map_or(&fields.span, |e| &e.key);
    let (first, unit) = (missing[0].name, &missing[0].unit(fields.units()).name);
    let help = format!(
        "in {unit}/s: `initial-velocity = {{ {first} = 1.0 }}`; without loads and drives the mechanism would not move"
    );
    let message = format!("the initial velocity of {names} is not given");
    fields
        .log()
        .report(message, &[(at, "no initial velocity")], help);
}

/// `initial-coordinate` or `initial-velocity`: one value for each free actuator, or a number for the only one.
struct PerActuator<'p, 'a> {
    key: &'static str,
    location: fn(ActuatorId) -> SceneLocation,
    actuators: &'p [NamedActuator<'p>],
    prescribed: &'p [Option<Entry<'a>>],
}

impl PerActuator<'_, '_> {
    /// The values of each actuator; `None` if they are invalid.
    fn read(&self, entry: Option<&Entry<'_>>) -> Option<Vec<Option<f64>>> {
        let mut values = vec![None; self.actuators.len()];
        let Some(entry) = entry else {
            return Some(values);
        };
        let key = entry.written();
        let what = format!("{key} of [motion]");
        if entry.value.is_number() {
            let k = self.only_free(entry, &what)?;
            values[k] = Some(self.value(k, entry.value, what)?);
            return Some(values);
        }
        let count = entry.log().count();
        let fields = TableReader::open(entry, what)?;
        for value in &fields.entries {
            let Some(k) = actuator_named(value, self.actuators) else {
                continue;
            };
            let name = shorten(value.name);
            if let Some(law) = &self.prescribed[k] {
                let (key, given) = (self.key, format!("{key} given here"));
                let message = format!("`{name}` in [motion] has both a motion law and an {key}");
                let labels = [(&law.key, "prescribed here"), (&value.key, &given)];
                let help = "keep one of them: the law determines the whole motion of the actuator";
                fields.log().report(message, &labels, help);
                continue;
            }
            let what = format_args!("{key} of `{name}` in [motion]");
            values[k] = self.value(k, value.value, what);
        }
        (fields.log().count() == count).then_some(values)
    }

    /// The only free actuator.
    fn only_free(&self, entry: &Entry<'_>, what: &str) -> Option<usize> {
        let all = self.prescribed.len();
        let free: Vec<_> = (0..all).filter(|&k| self.prescribed[k].is_none()).collect();
        // Where none is free, that is reported elsewhere.
        if let [] | [_] = free.as_slice() {
            return free.first().copied();
        }
        let each = free.iter().map(|&k| self.actuators[k].name);
        let each: Vec<_> = each.map(|name| format!("{name} = 0.0")).collect();
        let example = shorten(&each.join(", "));
        let kind = if free.len() == all {
            "actuators"
        } else {
            "free actuators"
        };
        let message = format!("{what} is one number for {} {kind}", free.len());
        let help = format!("write `{} = {{ {example} }}`", self.key);
        entry.value.reject(message, "ambiguous", help)
    }

    fn value(&self, k: usize, value: Value<'_>, what: impl Display) -> Option<f64> {
        let actuator = &self.actuators[k];
        let location = (self.location)(ActuatorId(k));
        value.log().place(location, &value.span());
        match self.key {
            "initial-coordinate" => actuator.coordinate_value(value, what),
            _ => value.quantity(actuator.unit(value.units()), what),
        }
    }
}

fn duration(fields: &TableReader<'_>) -> Option<MotionDuration> {
    let (periods, duration) = (fields.get("periods"), fields.get("duration"));
    if let (Some(a), Some(b)) = (periods, duration) {
        fields.reject_both(a, b, ["duration in periods", "duration in seconds"]);
        return None;
    }
    let Some(entry) = periods.or(duration) else {
        let labels = [(&fields.span, "no duration")];
        let help = "add `periods = 10`, or `duration = 5.0` in s";
        return fields
            .log()
            .reject("[motion] has no duration", &labels, help);
    };
    entry.log().place(SceneLocation::Duration, &entry.span());
    let value = positive(entry, "[motion]")?;
    Some(match periods {
        Some(_) => MotionDuration::Periods(value),
        None => MotionDuration::Seconds(value),
    })
}

/// Reads `[calibration]`; `numbers` are those of the bodies, if all of them were read.
pub(crate) fn calibration(
    fields: &TableReader<'_>,
    numbers: Option<&[SceneNumber]>,
) -> Option<Calibration> {
    fields.reject_unknown_keys(table("calibration"));
    let help = "name the number to be fitted: `parameter = \"crank.inertia\"`";
    let path = fields.require("parameter", help).and_then(|e| {
        let path = e
            .value
            .string(format_args!("{} in [calibration]", e.written()))?;
        Some((path.to_owned(), e.value.span()))
    });
    let help = "give the period to be reached, in s: `period = 5.42`";
    let period = fields
        .require("period", help)
        .and_then(|e| positive(e, "[calibration]"));
    let (path, at) = path?;
    let period = period?;
    fields.log().place(SceneLocation::Calibration, &at);
    if let Some(numbers) = numbers
        && numbers.iter().all(|n| n.path != path)
    {
        let (message, help) = no_number(&path, numbers.iter());
        fields
            .log()
            .report(message, &[(&at, "unknown number")], help);
    }
    Some(Calibration { path, period })
}
