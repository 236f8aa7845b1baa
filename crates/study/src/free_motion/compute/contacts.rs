//! Where surfaces with dry friction come to rest and let go: lines of the summary, and events beside those of the scene.

use crate::estimate;
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem, SegmentedMotion};
use crate::number_format::{digits, digits_within};
use dwell_dynamics::{ContactEvent, ContactMode, OdeState};

/// What surfaces do from an event on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Change {
    Holds,
    Slides,
}

impl Change {
    const ALL: [Self; 2] = [Self::Holds, Self::Slides];

    /// The change of an event; none where surfaces at their limit are held by others.
    fn of(event: &ContactEvent) -> Option<Self> {
        let moved = matches!(event.from, ContactMode::Slides { .. });
        match event.to {
            ContactMode::Slides { .. } => Some(Self::Slides),
            ContactMode::Holds | ContactMode::AtLimit { .. } => moved.then_some(Self::Holds),
            ContactMode::AtRest { .. } | ContactMode::Undecided => None,
        }
    }

    fn verb(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Slides => "slides",
        }
    }
}

/// A change of a contact, as an event.
pub(super) struct ContactOccurrence {
    /// Its number, behind those of the scene's events.
    pub(super) number: usize,
    /// Its name.
    pub(super) name: String,
    /// The chart of its segment.
    pub(super) chart: usize,
    /// Its time and the state behind it.
    pub(super) state: OdeState,
}

impl FreeMotionProblem<'_> {
    /// The changes of all contacts, in order of time.
    pub(super) fn contact_occurrences(&self, motion: &SegmentedMotion) -> Vec<ContactOccurrence> {
        let mut all = Vec::new();
        for (chart, solution) in &motion.segments {
            for event in &solution.contact_events {
                let Some(change) = Change::of(event) else {
                    continue;
                };
                let kinds = Change::ALL.len();
                let contact = self
                    .machine
                    .contact_loads()
                    .position(|load| load == event.load);
                let number = self.spec.events.len() + kinds * contact.unwrap_or(0) + 1;
                all.push(ContactOccurrence {
                    number: number + usize::from(change == Change::Slides),
                    name: format!("{} {}", self.joint_name(event.load), change.verb()),
                    chart: *chart,
                    state: OdeState {
                        t: event.t,
                        y: event.y.clone(),
                    },
                });
            }
        }
        all
    }

    /// The joint of a friction.
    fn joint_name(&self, load: usize) -> &str {
        let name = self.loaded_scene.loads[load].name.as_str();
        name.strip_suffix(".friction").unwrap_or(name)
    }

    /// Lines of the summary: how often each contact holds and slides, and when first.
    pub(super) fn describe_contacts(&self, computed: &ComputedMotion) -> String {
        let mut text = String::new();
        let first_number = self.spec.events.len() + 1;
        for (c, load) in self.machine.contact_loads().enumerate() {
            for (k, change) in Change::ALL.into_iter().enumerate() {
                let number = first_number + Change::ALL.len() * c + k;
                let times = |motion: &SegmentedMotion| -> Vec<f64> {
                    let all = self.contact_occurrences(motion).into_iter();
                    all.filter(|o| o.number == number)
                        .map(|o| o.state.t)
                        .collect()
                };
                let own = times(&computed.motion);
                let Some(&first) = own.first() else { continue };
                let name = self.joint_name(load);
                let verb = change.verb();
                let count = own.len();
                text += &format!("  {name} {verb} (event {number}): {count} times, first at t = ");
                let others = computed.comparison.as_ref().map(times);
                text += &match others.as_ref().and_then(|others| others.first()) {
                    Some(other) => {
                        let error = estimate::of_number(first, *other);
                        let first = digits_within(first, error, 13);
                        format!("{first} s (estimated error {error:.1e} s)")
                    }
                    None => format!("{} s", digits(first, 3)),
                };
                if let Some(others) = others.filter(|others| others.len() != count) {
                    let other = others.len();
                    text += &format!(
                        "; {other} times in a second run: within its error it is not certain"
                    );
                }
                text += "\n";
            }
        }
        text
    }
}
