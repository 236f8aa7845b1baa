//! What a motion in space says of the change points of its branch.

use super::problem::SpaceMotionProblem;
use crate::free_motion::compute::{MotionProblem as _, first_changes};
use crate::number_format::digits;
use dwell_dynamics::{DynamicsError, Event, EventKind, OdeState, Solution, SpaceFitWindow};
use dwell_geometry::PositionError;
use dwell_kinetostatics::MachineModel as _;
use dwell_kinetostatics::space::CoordinateFunction;
use std::num::NonZeroUsize;

/// How near to a limit position a motion changes its coordinate, as a part of the range, of an angle of more than 1 rad of that: there
/// the coordinate moves by a fifth of what it does elsewhere.
const NEAR_LIMIT: f64 = 0.02;
/// The same where it ends because no other coordinate takes over.
const AT_LIMIT: f64 = 1e-4;
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
    /// Lines of the summary: which change points of its coordinate a part of the motion passes, and how.
    pub(super) fn describe_change_points(&self, solution: &Solution) -> Vec<String> {
        let windows = self.machine.change_point_windows();
        let steps = &solution.steps;
        let passages = steps.windows(2).flat_map(|pair| {
            let passed = windows.iter();
            passed.filter_map(move |window| passage(window, pair))
        });
        let passages = passages.map(|t| format!("t = {} s: change point crossed", digits(t, 6)));
        let mut lines = first_changes(passages.collect());
        // Those that the motion came to.
        let is_met = |window: &&SpaceFitWindow| {
            let crossed = steps.windows(2).any(|pair| passage(window, pair).is_some());
            crossed || steps.iter().any(|step| window.contains(step.y[0]))
        };
        lines.extend(windows.iter().filter(is_met).map(|window| {
            let at = digits(window.at.q, 6);
            match &window.fit {
                Ok(_) => format!(
                    "change point at {at}: crossed by a polynomial fit within ±{}, where the tables have no rows",
                    digits(window.half_width, 3)
                ),
                Err(error) => format!("the change point at {at} cannot be crossed: {error}"),
            }
        }));
        lines
    }
}

/// A coordinate beyond which a motion does not go on in it.
pub(super) struct Barrier {
    pub(super) event: Event<CoordinateFunction>,
    /// Why a motion ends there.
    pub(super) error: DynamicsError,
    /// Whether the coordinate turns back a little beyond it: in another coordinate the motion goes on.
    pub(super) turns_back: bool,
    /// The coordinate that it is in front of.
    at: f64,
    /// Whether the motion starts beyond it.
    pub(super) is_beyond: bool,
}

impl SpaceMotionProblem<'_> {
    /// The ends of the part of its coordinate that a motion from a state cannot leave: in front of the windows of change points that
    /// it cannot cross, and of limit positions, where it changes its coordinate if it may.
    pub(super) fn barriers(&self, from: &OdeState, may_change: bool) -> Vec<Barrier> {
        let (Some(actuator), [0]) = (
            self.scene().mechanism.actuators.first(),
            self.machine.free(),
        ) else {
            return Vec::new();
        };
        let joint = &self.scene().mechanism.joints[actuator.kind.joint().0];
        let coordinate = self
            .event_model
            .coordinate_function(actuator.kind.coordinate(joint));
        let Ok(coordinate) = coordinate else {
            return Vec::new();
        };
        let at = |q: f64, group: usize, singular: f64| {
            let error = PositionError::Singular {
                group,
                q: singular,
                relative_determinant: 0.0,
            };
            Barrier {
                event: Event {
                    kind: EventKind::Reaches(coordinate, q),
                    terminal: Some(NonZeroUsize::MIN),
                },
                error: DynamicsError::from(error),
                turns_back: false,
                at: singular,
                is_beyond: false,
            }
        };
        let start = from.y[0];
        let uncrossed = self.uncrossed(start).into_iter();
        let uncrossed = uncrossed.map(|(group, [q, singular])| at(q, group, singular));
        let limits = self
            .limits(may_change)
            .into_iter()
            .map(|[q, limit]| Barrier {
                turns_back: true,
                is_beyond: (start - q) * (limit - q) >= 0.0,
                ..at(q, 0, limit)
            });
        uncrossed.chain(limits).collect()
    }

    /// The next change points that a motion from a coordinate cannot cross: the group of each, and where the motion ends in front of it.
    fn uncrossed(&self, start: f64) -> Vec<(usize, [f64; 2])> {
        let windows = self.machine.change_point_windows().iter();
        let windows = windows.filter(|window| window.fit.is_err());
        let next = windows.flat_map(|window| {
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
            let group = window.at.group;
            let one = move |to: f64| (group, [start + to, start + to + aside.copysign(to)]);
            next.into_iter().flatten().map(one)
        });
        next.collect()
    }

    /// The limit positions of the only coordinate, each behind the place in front of it where a motion leaves it.
    fn limits(&self, may_change: bool) -> Vec<[f64; 2]> {
        let plan = self.machine.model().plan();
        let Some((from, to)) = plan.range().limits() else {
            return Vec::new();
        };
        let unit = if plan.is_angle(0) { 1.0 } else { plan.size() };
        let part = if may_change { NEAR_LIMIT } else { AT_LIMIT };
        let margin = part * (to - from).min(unit);
        let ends = [[from + margin, from], [to - margin, to]];
        let found = ends.into_iter().zip(plan.range_ends());
        found
            .filter(|(_, found)| *found)
            .map(|(end, _)| end)
            .collect()
    }

    /// The barrier that a motion came to: it ends there. Where a step next to a limit position would lead beyond it, that is the barrier.
    pub(super) fn barrier_of(
        &self,
        solution: &mut Solution,
        mut barriers: Vec<Barrier>,
    ) -> Option<Barrier> {
        let own = self.events.len();
        let reached = solution.event_occurrences.iter().map(|o| o.event);
        if let Some(reached) = reached.filter(|event| *event >= own).min() {
            solution.event_occurrences.retain(|o| o.event < own);
            solution.terminated_by_event = false;
            return Some(barriers.swap_remove(reached - own));
        }
        let failed = matches!(solution.error, Some(DynamicsError::Position(_)));
        let last = solution.steps.last().filter(|_| failed)?.y[0];
        let near = self.limits(true).into_iter();
        let mut near = near.filter(|[from, limit]| (last - from) * (limit - from) > 0.0);
        let [_, limit] = near.next()?;
        let is_it = |barrier: &Barrier| barrier.turns_back && barrier.at == limit;
        let reached = barriers.iter().position(is_it)?;
        solution.error = None;
        Some(barriers.swap_remove(reached))
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
