//! Where surfaces with dry friction come to rest and let go, and where coordinates meet their end stops: lines of the
//! summary, and events beside those of the scene.

use crate::estimate;
use crate::explain::NamedScene;
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem, SegmentedMotion};
use crate::number_format::{digits, digits_within, how_often};
use dwell_dynamics::{
    ContactEvent, ContactMode, Machine, MovingModel, OdeState, Solution, StopChange,
};
use dwell_findings::Record;

/// What a friction does from an event on.
const OF_FRICTION: [&str; 2] = ["sticks", "breaks away"];
/// What a load does that drives the motion back to its switch from both sides.
const OF_SWITCH: [&str; 2] = ["holds at its switch", "leaves its switch"];
/// What a coordinate does at its end stop.
const OF_STOP: [&str; 4] = ["is struck", "is rested on", "is left", "is touched"];

/// A change of a contact, as an event.
pub(crate) struct ContactOccurrence {
    /// Its number, behind those of the scene's events.
    pub(crate) number: usize,
    /// The chart of its segment.
    pub(crate) chart: usize,
    /// Its time and the state behind it.
    pub(crate) state: OdeState,
    /// Of an impact: by free coordinate, the change of its speed.
    pub(crate) speed_changes: Vec<f64>,
}

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
    /// Those of a machine of a scene with so many events.
    pub(crate) fn new<M: MovingModel>(
        scene: &impl NamedScene,
        machine: &Machine<M>,
        before: usize,
    ) -> Self {
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
            before,
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

    /// The changes of all contacts in a solution of a chart, in order of time.
    pub(crate) fn occurrences(&self, chart: usize, solution: &Solution) -> Vec<ContactOccurrence> {
        let one = |event: &ContactEvent| {
            let kind = self.kind_of(event)?;
            let speed_changes = match event {
                ContactEvent::Stop {
                    change: StopChange::Impact { changes, .. },
                    ..
                } => changes.clone(),
                _ => Vec::new(),
            };
            Some(ContactOccurrence {
                number: self.before + kind + 1,
                chart,
                state: OdeState {
                    t: event.t(),
                    y: event.y().to_vec(),
                },
                speed_changes,
            })
        };
        solution.contact_events.iter().filter_map(one).collect()
    }

    /// Lines of the summary: how often each contact changes in a motion, and when first, with what a second run says.
    pub(crate) fn describe(
        &self,
        own: &[ContactOccurrence],
        second: Option<&[ContactOccurrence]>,
        record: &mut Record,
    ) -> String {
        let mut text = String::new();
        for (k, name) in self.names().iter().enumerate() {
            let number = self.before + k + 1;
            let times = |all: &[ContactOccurrence]| -> Vec<f64> {
                let of_kind = all.iter().filter(|o| o.number == number);
                of_kind.map(|o| o.state.t).collect()
            };
            let own = times(own);
            let Some(&first) = own.first() else { continue };
            let count = own.len();
            record.add_count(format!("event.{name}.number"), number);
            record.add_count(format!("event.{name}.count"), count);
            let first_name = format!("event.{name}.first");
            text += &format!(
                "  {name} (event {number}): {}, first at t = ",
                how_often(count)
            );
            let others = second.map(times);
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

/// The impulses of the first so many reactions of a machine's model, at an impact that changes the free speeds; zero where none is.
pub(crate) fn first_impulses<M: MovingModel>(
    machine: &Machine<M>,
    at: &OdeState,
    (changes, count): (&[f64], usize),
) -> Vec<f64> {
    let mut workspace = machine.workspace();
    match machine.evaluate(at.t, &at.y, &mut workspace) {
        Ok(state) => state.impulses(changes).reactions[..count].to_vec(),
        Err(_) => vec![f64::NAN; count],
    }
}

impl FreeMotionProblem<'_> {
    /// Its contacts.
    fn contacts(&self) -> NamedContacts {
        NamedContacts::new(self.loaded_scene, &self.machine, self.spec.events.len())
    }

    /// The name of an event of contacts, by its number.
    pub(super) fn contact_event_name(&self, number: usize) -> String {
        self.contacts().name(number)
    }

    /// The changes of all contacts, in order of time.
    pub(super) fn contact_occurrences(&self, motion: &SegmentedMotion) -> Vec<ContactOccurrence> {
        let contacts = self.contacts();
        let segments = motion.segments.iter();
        let all = segments.flat_map(|(chart, solution)| contacts.occurrences(*chart, solution));
        all.collect()
    }

    /// Lines of the summary: how often each contact changes, and when first.
    pub(super) fn describe_contacts(
        &self,
        computed: &ComputedMotion,
        record: &mut Record,
    ) -> String {
        let own = self.contact_occurrences(&computed.motion);
        let second = computed.comparison.as_ref();
        let second = second.map(|motion| self.contact_occurrences(motion));
        self.contacts().describe(&own, second.as_deref(), record)
    }
}
