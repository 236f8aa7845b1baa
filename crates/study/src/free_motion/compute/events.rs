//! The events of a motion, those of the scene and the changes of contacts, in one order: their names and their table.

use crate::explain::NamedScene as _;
use crate::free_motion::compute::{ChartedProblem, MotionOf, MotionProblem, NamedContacts};
use crate::machines::MachineScene as _;
use crate::number_format::coordinate_unit;
use dwell_dynamics::{EventOccurrence, Machine, MovingModel, OdeState, Solution};
use dwell_findings::{Column, Table};

/// An event of the scene or a change of a contact.
pub(crate) struct NumberedEvent {
    /// Its number: behind those of the scene's events are those of contacts.
    pub(crate) number: usize,
    /// The chart of its part of the motion.
    pub(crate) chart: usize,
    /// Its time and the state behind it.
    pub(crate) state: OdeState,
    /// Of an impact: by free coordinate, the change of its speed.
    pub(crate) speed_changes: Vec<f64>,
}

/// All events of a motion, by part its chart and its solution, in order of time.
fn numbered_events(
    problem: &impl MotionProblem,
    parts: &[(usize, Solution)],
) -> Vec<NumberedEvent> {
    let of_part = |(chart, solution): &(usize, Solution)| {
        let chart = *chart;
        let one = move |o: &EventOccurrence| NumberedEvent {
            number: o.event + 1,
            chart,
            state: o.state.clone(),
            speed_changes: Vec::new(),
        };
        solution
            .event_occurrences
            .iter()
            .map(one)
            .collect::<Vec<_>>()
    };
    let of_contacts = NamedContacts::new(problem).changes(parts);
    let own = parts.iter().flat_map(of_part);
    let mut all: Vec<NumberedEvent> = own.chain(of_contacts).collect();
    all.sort_by(|one, other| one.state.t.total_cmp(&other.state.t));
    all
}

/// The time (s) and the name of each event, in order of time.
pub(crate) fn named_events(
    problem: &impl MotionProblem,
    parts: &[(usize, Solution)],
) -> Vec<(f64, String)> {
    let contacts = NamedContacts::new(problem);
    let named = |event: NumberedEvent| {
        let own = problem.spec().events.get(event.number - 1);
        let name = own.map_or_else(|| contacts.name(event.number), |own| own.name.clone());
        (event.state.t, name)
    };
    let all = numbered_events(problem, parts).into_iter();
    all.map(named).collect()
}

/// The time of each event, the actuator coordinates and speeds then, as far as they are found, and where there are end stops the
/// impulses of the requested reactions; zero where no impact is.
pub(crate) fn event_table<P: ChartedProblem>(problem: &P, motion: &MotionOf<P>) -> Table {
    let scene = problem.scene();
    let mut columns = vec![Column::new("t", "s"), Column::new("event", "")];
    for (name, is_angle) in (0..).map_while(|k| scene.actuator(k)) {
        let unit = coordinate_unit(is_angle);
        columns.push(Column::new(name, unit));
        columns.push(Column::new(format!("{name}.velocity"), format!("{unit}/s")));
    }
    let before_impulses = columns.len();
    let impacts = problem.impact_machine();
    if let Some((machine, requested)) = impacts {
        // Behind the requested ones are those that friction needs.
        let reactions = scene.reaction_columns(machine.model()).into_iter();
        columns.extend(reactions.take(requested).map(|reaction| {
            let (name, unit) = (reaction.name, reaction.unit);
            Column::new(format!("{name}.impulse"), format!("{unit} s"))
        }));
    }
    let row = |event: NumberedEvent| {
        let mut row = vec![event.state.t, event.number as f64];
        row.extend(problem.coordinates_at(motion, &event).into_iter().flatten());
        row.resize(before_impulses, f64::NAN);
        if let Some((machine, requested)) = impacts {
            row.extend(first_impulses(machine, &event, requested));
        }
        row
    };
    let all = numbered_events(problem, &motion.segments).into_iter();
    let rows = all.map(row).collect();
    Table { columns, rows }
}

/// The impulses of the first so many reactions of a machine's model at an event; zero where it is no impact.
fn first_impulses<M: MovingModel>(
    machine: &Machine<M>,
    event: &NumberedEvent,
    count: usize,
) -> Vec<f64> {
    let (at, mut workspace) = (&event.state, machine.workspace());
    match machine.evaluate(at.t, &at.y, &mut workspace) {
        Ok(state) => state.impulses(&event.speed_changes).reactions[..count].to_vec(),
        Err(_) => vec![f64::NAN; count],
    }
}
