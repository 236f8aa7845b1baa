//! Where surfaces with dry friction come to rest and let go, and where coordinates meet their end stops: lines of the
//! summary, and events beside those of the scene.

use crate::estimate;
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem, SegmentedMotion};
use crate::number_format::{digits, digits_within, how_often};
use dwell_dynamics::{ContactEvent, ContactMode, OdeState, StopChange};
use dwell_findings::Record;

/// What a friction does from an event on.
const OF_FRICTION: [&str; 2] = ["sticks", "breaks away"];
/// What a load does that drives the motion back to its switch from both sides.
const OF_SWITCH: [&str; 2] = ["holds at its switch", "leaves its switch"];
/// What a coordinate does at its end stop.
const OF_STOP: [&str; 4] = ["is struck", "is rested on", "is left", "is touched"];

/// A change of a contact, as an event.
pub(super) struct ContactOccurrence {
    /// Its number, behind those of the scene's events.
    pub(super) number: usize,
    /// The chart of its segment.
    pub(super) chart: usize,
    /// Its time and the state behind it.
    pub(super) state: OdeState,
    /// Of an impact: by free coordinate, the change of its speed.
    pub(super) speed_changes: Vec<f64>,
}

impl FreeMotionProblem<'_> {
    /// By kind of event of contacts: its name; they are numbered behind the scene's events.
    fn contact_event_names(&self) -> Vec<String> {
        let frictions = self.machine.contact_loads().map(|load| {
            let name = self.loaded_scene.loads[load].name.as_str();
            (
                name.strip_suffix(".friction").unwrap_or(name),
                &OF_FRICTION[..],
            )
        });
        let stops = self.loaded_scene.stops.iter();
        let stops = stops.map(|stop| (stop.name.as_str(), &OF_STOP[..]));
        let switching = self.machine.switching_loads();
        let switching = switching
            .iter()
            .map(|&load| (self.loaded_scene.loads[load].name.as_str(), &OF_SWITCH[..]));
        let all = frictions.chain(stops).chain(switching);
        all.flat_map(|(name, verbs)| verbs.iter().map(move |verb| format!("{name} {verb}")))
            .collect()
    }

    /// The name of an event of contacts, by its number.
    pub(super) fn contact_event_name(&self, number: usize) -> String {
        let index = number - self.spec.events.len() - 1;
        self.contact_event_names()
            .get(index)
            .cloned()
            .unwrap_or_default()
    }

    /// The kind of an event of contacts; none where surfaces at their limit are held by others, or turn back.
    fn kind_of(&self, event: &ContactEvent) -> Option<usize> {
        match event {
            ContactEvent::Friction { load, from, to, .. } => {
                let moved = matches!(from, ContactMode::Slides { .. });
                let kind = match to {
                    // One that turns back without a rest slides on.
                    ContactMode::Slides { .. } if !moved => 1,
                    ContactMode::Holds | ContactMode::AtLimit { .. } if moved => 0,
                    _ => return None,
                };
                let contact = self.machine.contact_loads().position(|l| l == *load)?;
                Some(OF_FRICTION.len() * contact + kind)
            }
            ContactEvent::Switch { load, sliding, .. } => {
                let loads = self.machine.switching_loads();
                let load = loads.iter().position(|l| l == load)?;
                let frictions = OF_FRICTION.len() * self.machine.contact_loads().count();
                let stops = OF_STOP.len() * self.loaded_scene.stops.len();
                let kind = usize::from(sliding.is_none());
                Some(frictions + stops + OF_SWITCH.len() * load + kind)
            }
            ContactEvent::Stop { stop, change, .. } => {
                let kind = match change {
                    StopChange::Impact { .. } => 0,
                    StopChange::Rests => 1,
                    StopChange::Leaves => 2,
                    StopChange::Touches => 3,
                };
                let frictions = OF_FRICTION.len() * self.machine.contact_loads().count();
                Some(frictions + OF_STOP.len() * stop + kind)
            }
        }
    }

    /// The changes of all contacts, in order of time.
    pub(super) fn contact_occurrences(&self, motion: &SegmentedMotion) -> Vec<ContactOccurrence> {
        let mut all = Vec::new();
        for (chart, solution) in &motion.segments {
            for event in &solution.contact_events {
                let Some(kind) = self.kind_of(event) else {
                    continue;
                };
                let speed_changes = match event {
                    ContactEvent::Stop {
                        change: StopChange::Impact { changes, .. },
                        ..
                    } => changes.clone(),
                    _ => Vec::new(),
                };
                all.push(ContactOccurrence {
                    number: self.spec.events.len() + kind + 1,
                    chart: *chart,
                    state: OdeState {
                        t: event.t(),
                        y: event.y().to_vec(),
                    },
                    speed_changes,
                });
            }
        }
        all
    }

    /// Lines of the summary: how often each contact changes, and when first.
    pub(super) fn describe_contacts(
        &self,
        computed: &ComputedMotion,
        record: &mut Record,
    ) -> String {
        let mut text = String::new();
        let names = self.contact_event_names();
        if names.is_empty() {
            return text;
        }
        let own = self.contact_occurrences(&computed.motion);
        let second = computed.comparison.as_ref();
        let second = second.map(|motion| self.contact_occurrences(motion));
        for (k, name) in names.iter().enumerate() {
            let number = self.spec.events.len() + k + 1;
            let times = |all: &[ContactOccurrence]| -> Vec<f64> {
                let of_kind = all.iter().filter(|o| o.number == number);
                of_kind.map(|o| o.state.t).collect()
            };
            let own = times(&own);
            let Some(&first) = own.first() else { continue };
            let count = own.len();
            record.add_count(format!("event.{name}.number"), number);
            record.add_count(format!("event.{name}.count"), count);
            let first_name = format!("event.{name}.first");
            text += &format!(
                "  {name} (event {number}): {}, first at t = ",
                how_often(count)
            );
            let others = second.as_deref().map(times);
            text += &match others.as_ref().and_then(|others| others.first()) {
                Some(other) => {
                    let error = estimate::of_number(first, *other);
                    record.add_within(first_name, "s", first, error);
                    let first = digits_within(first, error, 13);
                    format!("{first} s (estimated error {error:.1e} s)")
                }
                None => {
                    record.add(first_name, "s", first);
                    format!("{} s", digits(first, 6))
                }
            };
            if let Some(others) = others.filter(|others| others.len() != count) {
                let other = others.len();
                record.add_count(format!("event.{name}.count_in_second_run"), other);
                let other = how_often(other);
                text += &format!("; {other} in a second run: within its error it is not certain");
            }
            text += "\n";
        }
        text
    }
}
