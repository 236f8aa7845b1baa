//! What a motion in space says of the change points of its branch.

use super::problem::SpaceMotionProblem;
use super::run::Run;
use crate::number_format::digits;
use dwell_dynamics::{DynamicsError, Event, EventKind, OdeState, Solution, SpaceFitWindow};
use dwell_geometry::PositionError;
use dwell_kinetostatics::MachineModel as _;
use dwell_kinetostatics::space::CoordinateFunction;
use std::num::NonZeroUsize;

/// Passages that a summary lists.
const MAX_LISTED: usize = 6;
/// How far in front of a change point that it cannot cross a motion ends, in half windows: at their edge nothing is evaluated any more.
const IN_FRONT: f64 = 1.02;

/// How many change points of a window are at or below a coordinate.
fn count_below(window: &SpaceFitWindow, q: f64) -> f64 {
    let x = q - window.at.q;
    match window.period() {
        Some(period) => (x / period).floor(),
        None => f64::from(u8::from(x >= 0.0)),
    }
}

impl SpaceMotionProblem<'_> {
    /// Whether a time (s) is in a step that begins or ends within the window of a change point.
    pub(super) fn crosses_at(&self, run: &Run, t: f64) -> bool {
        let steps = &run.solution.steps;
        let next = steps.partition_point(|step| step.t <= t);
        let ends = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let mut ends = ends.filter_map(|k| steps.get(k));
        ends.any(|step| self.machine.is_in_fit_window(&step.y))
    }

    /// Lines of the summary: where the motion passes change points, and how.
    pub(super) fn describe_change_points(&self, run: &Run) -> String {
        let windows = self.machine.change_point_windows();
        let steps = &run.solution.steps;
        let passages: Vec<f64> = steps
            .windows(2)
            .flat_map(|pair| {
                windows
                    .iter()
                    .filter_map(move |window| passage(window, pair))
            })
            .collect();
        let listed = passages.iter().take(MAX_LISTED);
        let listed = listed.map(|t| format!("  t = {} s: change point crossed\n", digits(*t, 6)));
        let mut text: String = listed.collect();
        if let more @ 1.. = passages.len().saturating_sub(MAX_LISTED) {
            text += &format!("  and {more} more changes\n");
        }
        // Those that the motion came to.
        let is_met = |window: &&SpaceFitWindow| {
            let crossed = steps.windows(2).any(|pair| passage(window, pair).is_some());
            crossed || steps.iter().any(|step| window.contains(step.y[0]))
        };
        for window in windows.iter().filter(is_met) {
            let at = digits(window.at.q, 6);
            text += &match &window.fit {
                Ok(_) => format!(
                    "  change point at {at}: crossed by a polynomial fit within ±{}, where the tables have no rows\n",
                    digits(window.half_width, 3)
                ),
                Err(error) => format!("  the change point at {at} cannot be crossed: {error}\n"),
            };
        }
        text
    }
}

/// Where a motion ends, and why.
pub(super) type Barrier = (Event<CoordinateFunction>, DynamicsError);

impl SpaceMotionProblem<'_> {
    /// The ends of the part of its coordinate that it cannot leave: in front of the windows of change points that it cannot cross.
    pub(super) fn barriers(&self) -> Vec<Barrier> {
        let windows = self.machine.change_point_windows().iter();
        let windows = windows.filter(|window| window.fit.is_err());
        let (Some(actuator), Some(&start)) = (
            self.scene.mechanism.actuators.first(),
            self.spec.initial_coordinates.first(),
        ) else {
            return Vec::new();
        };
        let joint = &self.scene.mechanism.joints[actuator.kind.joint().0];
        let coordinate = self
            .event_model
            .coordinate_function(actuator.kind.coordinate(joint));
        let Ok(coordinate) = coordinate else {
            return Vec::new();
        };
        let ends = windows.flat_map(|window| {
            let aside = IN_FRONT * window.half_width;
            let [up, down] = [-aside, aside].map(|aside| window.at.q + aside - start);
            // The next ones of all periods.
            let next = match window.period() {
                Some(period) => [
                    Some(up.rem_euclid(period)),
                    Some(-(-down).rem_euclid(period)),
                ],
                None => [
                    Some(up).filter(|up| *up >= 0.0),
                    Some(down).filter(|down| *down <= 0.0),
                ],
            };
            let event = move |to: f64| {
                let singular = PositionError::Singular {
                    group: window.at.group,
                    q: start + to + aside.copysign(to),
                    relative_determinant: 0.0,
                };
                let event = Event {
                    kind: EventKind::Reaches(coordinate, start + to),
                    terminal: Some(NonZeroUsize::MIN),
                };
                (event, DynamicsError::from(singular))
            };
            next.into_iter().flatten().map(event)
        });
        ends.collect()
    }

    /// A motion that came to one of them ends there with its error.
    pub(super) fn end_at_barrier(&self, solution: &mut Solution, barriers: &[Barrier]) {
        let own = self.events.len();
        let reached = solution.event_occurrences.iter().map(|o| o.event);
        let reached = reached.filter(|event| *event >= own).min();
        let Some((_, error)) = reached.and_then(|event| barriers.get(event - own)) else {
            return;
        };
        solution.event_occurrences.retain(|o| o.event < own);
        solution.terminated_by_event = false;
        solution.error = Some(error.clone());
    }
}

/// When a step passes the change point of a window, s, by a straight line.
fn passage(window: &SpaceFitWindow, pair: &[OdeState]) -> Option<f64> {
    let [one, other] = pair else { return None };
    let [below, after] = [one, other].map(|step| count_below(window, step.y[0]));
    if below == after {
        return None;
    }
    let turn = window
        .period()
        .map_or(0.0, |period| period * below.max(after));
    let at = window.at.q + turn;
    let part = (at - one.y[0]) / (other.y[0] - one.y[0]);
    Some(one.t + part * (other.t - one.t))
}
