//! What a motion in space says of the change points of its branch.

use super::problem::SpaceMotionProblem;
use super::run::Run;
use crate::number_format::digits;
use dwell_dynamics::{OdeState, SpaceFitWindow};

/// Passages that a summary lists.
const MAX_LISTED: usize = 6;

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
