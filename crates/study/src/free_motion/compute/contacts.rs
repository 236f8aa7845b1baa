//! Where surfaces with dry friction come to rest and let go, and where coordinates meet their end stops: lines of the
//! summary, and events beside those of the scene.

use crate::explain::NamedScene as _;
use crate::free_motion::compute::MotionProblem;
use crate::free_motion::compute::events::NumberedEvent;
use crate::free_motion::compute::summary_lines::first_time;
use crate::number_format::how_often;
use dwell_dynamics::{ContactEvent, ContactMode, OdeState, Solution, StopChange};
use dwell_findings::Record;

/// What a friction does from an event on.
const OF_FRICTION: [&str; 2] = ["sticks", "breaks away"];
/// What a load does that drives the motion back to its switch from both sides.
const OF_SWITCH: [&str; 2] = ["holds at its switch", "leaves its switch"];
/// What a coordinate does at its end stop.
const OF_STOP: [&str; 4] = ["is struck", "is rested on", "is left", "is touched"];

/// The contacts of a machine in the plane or in space, whose events are numbered behind those of the scene.
pub(crate) struct NamedContacts {
    /// The frictions that hold: their loads and the names of their joints.
    frictions: Vec<(usize, String)>,
    stops: Vec<String>,
    /// The loads that switch.
    switches: Vec<(usize, String)>,
    /// Number of the scene's events.
    before: usize,
}

impl NamedContacts {
    pub(crate) fn new(problem: &impl MotionProblem) -> Self {
        let (scene, machine) = (problem.scene(), problem.machine());
        let name = |load: usize| scene.load_name(load).unwrap_or_default();
        let joint = |load: usize| {
            let name = name(load);
            (
                load,
                name.strip_suffix(".friction").unwrap_or(name).to_owned(),
            )
        };
        let stops = (0..).map_while(|k| scene.stop(k));
        let switching = machine.switching_loads().into_iter();
        Self {
            frictions: machine.contact_loads().map(joint).collect(),
            stops: stops.map(|(name, _)| name.to_owned()).collect(),
            switches: switching
                .map(|load| (load, name(load).to_owned()))
                .collect(),
            before: problem.spec().events.len(),
        }
    }

    /// By kind of event: its name.
    fn names(&self) -> Vec<String> {
        let frictions = self
            .frictions
            .iter()
            .map(|(_, name)| (name, &OF_FRICTION[..]));
        let stops = self.stops.iter().map(|name| (name, &OF_STOP[..]));
        let switches = self.switches.iter().map(|(_, name)| (name, &OF_SWITCH[..]));
        let all = frictions.chain(stops).chain(switches);
        all.flat_map(|(name, verbs)| verbs.iter().map(move |verb| format!("{name} {verb}")))
            .collect()
    }

    /// The name of an event, by its number.
    pub(crate) fn name(&self, number: usize) -> String {
        let index = number - self.before - 1;
        self.names().get(index).cloned().unwrap_or_default()
    }

    /// The kind of an event; none where surfaces at their limit are held by others, or turn back.
    fn kind_of(&self, event: &ContactEvent) -> Option<usize> {
        let frictions = OF_FRICTION.len() * self.frictions.len();
        match event {
            ContactEvent::Friction { load, from, to, .. } => {
                let moved = matches!(from, ContactMode::Slides { .. });
                let kind = match to {
                    // One that turns back without a rest slides on.
                    ContactMode::Slides { .. } if !moved => 1,
                    ContactMode::Holds | ContactMode::AtLimit { .. } if moved => 0,
                    _ => return None,
                };
                let contact = self.frictions.iter().position(|(l, _)| l == load)?;
                Some(OF_FRICTION.len() * contact + kind)
            }
            ContactEvent::Switch { load, sliding, .. } => {
                let load = self.switches.iter().position(|(l, _)| l == load)?;
                let stops = OF_STOP.len() * self.stops.len();
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
                Some(frictions + OF_STOP.len() * stop + kind)
            }
        }
    }

    /// The changes of all contacts in a motion, by part its chart and its solution.
    pub(crate) fn changes(&self, parts: &[(usize, Solution)]) -> Vec<NumberedEvent> {
        let one = |(chart, event): (usize, &ContactEvent)| {
            let kind = self.kind_of(event)?;
            let speed_changes = match event {
                ContactEvent::Stop {
                    change: StopChange::Impact { changes, .. },
                    ..
                } => changes.clone(),
                _ => Vec::new(),
            };
            Some(NumberedEvent {
                number: self.before + kind + 1,
                chart,
                state: OdeState {
                    t: event.t(),
                    y: event.y().to_vec(),
                },
                speed_changes,
            })
        };
        let all = parts.iter().flat_map(|(chart, solution)| {
            let events = solution.contact_events.iter();
            events.map(move |event| (*chart, event))
        });
        all.filter_map(one).collect()
    }

    /// Lines of the summary: how often each contact changes in a motion, and when first, with what a second run says.
    pub(crate) fn describe(
        &self,
        own: &[(usize, Solution)],
        second: Option<&[(usize, Solution)]>,
        record: &mut Record,
    ) -> String {
        let own = self.changes(own);
        let second = second.map(|parts| self.changes(parts));
        let mut text = String::new();
        for (k, name) in self.names().iter().enumerate() {
            let number = self.before + k + 1;
            let times = |all: &Vec<NumberedEvent>| -> Vec<f64> {
                let of_kind = all.iter().filter(|o| o.number == number);
                of_kind.map(|o| o.state.t).collect()
            };
            let own = times(&own);
            let Some(&first) = own.first() else { continue };
            let count = own.len();
            record.add_count(format!("event.{name}.number"), number);
            record.add_count(format!("event.{name}.count"), count);
            let others = second.as_ref().map(times);
            let other = others.as_ref().and_then(|others| others.first());
            let at = first_time(name, first, other.copied(), 0.0, record);
            text += &format!("  {name} (event {number}): {}{at}", how_often(count));
            if let Some(others) = others.filter(|others| others.len() != count) {
                let other = others.len();
                record.add_count(format!("event.{name}.count_in_second_run"), other);
                let other = how_often(other);
                text += &format!("; {other} in a second run, so this number is not certain");
            }
            text += "\n";
        }
        text
    }
}
