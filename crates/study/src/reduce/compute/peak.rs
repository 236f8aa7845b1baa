//! Where m is largest between the positions of the rows: near a limit position or a change point it rises and falls within a step.

use crate::models::PreparedScene;
use crate::reduce::compute::{InertiaAt, ReducedCurves, ReducedScene};
use dwell_geometry::{BodyId, Vec2};
use dwell_kinetostatics::{ExactWorkspace, ReducedModel as _, Workspace};

/// Part of m that the rows may miss without a word.
const MIN_EXCESS: f64 = 1e-3;
/// Halvings of a step between rows: down to rounding.
const HALVINGS: usize = 60;
/// A body that turns by so much more between two rows than its angular velocities there explain (rad) turns fast between them.
const UNEXPLAINED_TURN: f64 = 0.05;

/// A position with a larger unexplained turn (rad) on both sides is near the peak of a fast turn.
const FAST_TURN: f64 = 0.5;

/// The largest m between two rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    /// The coordinate there, rad or m.
    pub(crate) q: f64,
    /// m there.
    pub(crate) m: f64,
    /// Its estimated rounding error.
    pub(crate) error: f64,
}

/// The coordinate at which m is largest between two rows; `None` if a row has this value to a thousandth.
pub(crate) fn peak_between_rows(
    prepared: &dyn ReducedScene,
    curves: &ReducedCurves,
) -> Option<Peak> {
    let all = &curves.coefficients;
    let largest = (0..all.len()).max_by(|&i, &j| all[i].m.total_cmp(&all[j].m))?;
    // m rises where ½m′ is above zero: towards one of the neighbours.
    let first = if all[largest].half_dm > 0.0 {
        Some(largest)
    } else {
        largest.checked_sub(1)
    };
    let beside = first.and_then(|first| Some([curves.q[first], *curves.q.get(first + 1)?]));
    let mut inertia = prepared.inertia();
    let fast = prepared.fast_turns(&curves.q);
    let highest = (beside.into_iter().chain(fast))
        .filter_map(|bracket| highest(&mut inertia, bracket))
        .max_by(|one, other| one[1].total_cmp(&other[1]));
    let [q, _] = highest.filter(|[_, m]| *m > all[largest].m * (1.0 + MIN_EXCESS))?;
    let at_peak = prepared.coefficients(&[q]).ok()?.pop()?;
    // Next to a limit position there may be no pose in 32 digits.
    let errors = prepared.rounding_errors(q, &at_peak);
    let error = errors.map_or(at_peak.m, |errors| errors.m);
    let m = at_peak.m;
    Some(Peak { q, m, error })
}

/// The largest m between a position where it rises and one where it falls, and its coordinate.
fn highest(inertia: &mut InertiaAt<'_>, [mut low, mut high]: [f64; 2]) -> Option<[f64; 2]> {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let (_, half_dm) = inertia(middle)?;
        if half_dm > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (m, _) = inertia(low)?;
    Some([low, m])
}

/// The steps between rows in which a body turns fast, each from where m rises to where it falls: m may be largest there.
pub(crate) fn fast_turns(prepared: &PreparedScene<'_>, rows: &[f64]) -> Vec<[f64; 2]> {
    let mut search = PeakSearch::new(prepared);
    let steps = search.fast_turns(rows).into_iter();
    steps
        .filter_map(|step| search.around_fast_turn(step))
        .collect()
}

/// The orientation of a body, and its angular velocity over that of the coordinate.
type Turning = (Vec2, f64);

/// A model with the memory of its evaluations.
struct PeakSearch<'a> {
    prepared: &'a PreparedScene<'a>,
    inertia: ExactWorkspace,
    workspace: Workspace<f64>,
}

impl<'a> PeakSearch<'a> {
    fn new(prepared: &'a PreparedScene<'a>) -> Self {
        Self {
            prepared,
            inertia: prepared.model.workspace(),
            workspace: prepared.model.model().workspace(),
        }
    }

    /// All bodies at a coordinate; none without a pose.
    fn turning(&mut self, q: f64) -> Option<Vec<Turning>> {
        let model = self.prepared.model.model();
        let mut state = model
            .kinematic_state(&[q], &[1.0], &mut self.workspace)
            .ok()?;
        let states = state.bodies_at(&[0.0]);
        let body = |b| {
            let body = states.body(BodyId(b));
            (body.rotation, body.angular_velocity)
        };
        Some((0..model.masses().len()).map(body).collect())
    }

    /// The steps between rows in which a body turns by more than its angular velocities at both ends explain.
    fn fast_turns(&mut self, rows: &[f64]) -> Vec<[f64; 2]> {
        let states: Vec<_> = rows.iter().map(|&q| self.turning(q)).collect();
        let pairs = rows.windows(2).zip(states.windows(2));
        let fast = pairs.filter(|(q, states)| match states {
            [Some(from), Some(to)] => unexplained_turn(q[1] - q[0], from, to) > UNEXPLAINED_TURN,
            _ => false,
        });
        fast.map(|(q, _)| [q[0], q[1]]).collect()
    }

    /// The part of a step in which a body turns fast: from where m rises to where it falls.
    fn around_fast_turn(&mut self, [mut low, mut high]: [f64; 2]) -> Option<[f64; 2]> {
        let mut middle = 0.5 * (low + high);
        // To the half in which a body turns fast, until it does in both: then the middle is near the peak.
        for _ in 0..HALVINGS {
            middle = 0.5 * (low + high);
            let (from, at, to) = (
                self.turning(low)?,
                self.turning(middle)?,
                self.turning(high)?,
            );
            let halves = [(&from, &at), (&at, &to)].map(|(from, to)| largest_turn(from, to));
            let [smaller, larger] = [halves[0].min(halves[1]), halves[0].max(halves[1])];
            if larger < UNEXPLAINED_TURN || smaller > FAST_TURN {
                break;
            }
            if halves[0] > halves[1] {
                high = middle;
            } else {
                low = middle;
            }
        }
        // Far from the peak, m may rise and fall otherwise.
        for _ in 0..HALVINGS {
            if self.rises(low)? {
                break;
            }
            low = 0.5 * (low + middle);
        }
        for _ in 0..HALVINGS {
            if !self.rises(high)? {
                break;
            }
            high = 0.5 * (high + middle);
        }
        Some([low, high])
    }

    fn rises(&mut self, q: f64) -> Option<bool> {
        let (_, half_dm) = self.prepared.model.inertia(q, &mut self.inertia).ok()?;
        Some(half_dm > 0.0)
    }
}

/// How far the body turns that turns furthest, rad.
fn largest_turn(from: &[Turning], to: &[Turning]) -> f64 {
    let pairs = from.iter().zip(to);
    let turns = pairs.map(|((start, _), (end, _))| start.cross(*end).atan2(start.dot(*end)));
    turns.fold(0.0, |largest, turn| largest.max(turn.abs()))
}

/// By how much more some body turns in a step than by the mean of its angular velocities, rad.
fn unexplained_turn(step: f64, from: &[Turning], to: &[Turning]) -> f64 {
    let pairs = from.iter().zip(to);
    let turns = pairs.map(|((start, first), (end, last))| {
        let turn = start.cross(*end).atan2(start.dot(*end));
        let explained = 0.5 * (first + last) * step;
        let whole = std::f64::consts::TAU;
        ((turn - explained) / whole - ((turn - explained) / whole).round()).abs() * whole
    });
    turns.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use dwell_scene::PlaneScene;

    /// A crank's pin in the slot of a rocker, whose pivot is outside the pin's circle by a part `gap` of the crank: where they
    /// are nearest, the rocker turns 1/gap times as fast as the crank.
    fn slotted_rocker(gap: f64) -> String {
        let (y, x) = 0.3137_f64.sin_cos();
        let pivot = [x, y].map(|v| v * (1.0 + gap));
        format!(
            "[bodies.ground]\npoints = {{ A = [0, 0], D = {pivot:?} }}\n[bodies.crank]\npoints = {{ A = [0, 0], B = [1, 0] }}\nmass = 1\ncenter = [0.5, 0]\ninertia = 0.1\n\
             [bodies.rocker]\npoints = {{ D = [0, 0] }}\nmass = 1\ncenter = [0.2, 0]\ninertia = 0.1\n\
             [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nD = {{ revolute = [\"ground.D\", \"rocker.D\"] }}\nB = {{ slot = [\"rocker.D\", \"crank.B\"], axis = [1, 0] }}\n\
             [actuators.phi]\nangle = [\"ground\", \"crank\"]\n[assembly]\nphi = 1.0\nrocker = 2.2\n"
        )
    }

    /// Only the rotation of the rocker between two rows reveals the peak.
    #[test]
    fn a_peak_that_no_row_shows_is_found() {
        let gap = 1e-5;
        let scene = PlaneScene::parse("near.toml", &slotted_rocker(gap)).unwrap();
        let prepared = PreparedScene::without_loads(&scene).unwrap();
        let curves = ReducedCurves::new(&prepared, None).unwrap();
        let Peak { q, m, error } = peak_between_rows(&prepared, &curves).unwrap();
        let rows = curves.coefficients.iter().map(|at| at.m);
        let rows = rows.fold(0.0, f64::max);
        assert!(rows < 1e-5 * m, "{rows}");
        let exact = 0.35 + 0.14 / (gap * gap);
        assert!((q - 0.3137).abs() < 1e-12, "{q}");
        // The gap is known to a rounding of 1 m.
        assert!((m / exact - 1.0).abs() < 1e-10, "{m} against {exact}");
        assert!(error < 1e-8 * m, "{error}");
    }

    #[test]
    fn a_peak_narrower_than_a_step_is_found() {
        let text = slotted_rocker(1e-3);
        let scene = PlaneScene::parse("near.toml", &text).unwrap();
        let prepared = PreparedScene::without_loads(&scene).unwrap();
        let curves = ReducedCurves::new(&prepared, None).unwrap();
        let Peak { q, m, error } = peak_between_rows(&prepared, &curves).unwrap();
        assert!(error < 1e-9 * m, "{error}");
        let rows = curves
            .coefficients
            .iter()
            .fold(0.0_f64, |max, at| max.max(at.m));
        assert!(m > 1.4 * rows, "{m} against {rows}");
        // In closed form: 0.35 + 0.14 / gap².
        assert!(
            (q - 0.3137).abs() < 1e-9 && (m / 140_000.35 - 1.0).abs() < 1e-9,
            "{q} {m}"
        );
        // Evaluated at many positions around it, m is nowhere larger.
        let near = (-2000..=2000).map(|k| q + 1e-6 * f64::from(k));
        let dense = ReducedCurves::at(&prepared, near.collect()).unwrap();
        let largest = dense
            .coefficients
            .iter()
            .fold(0.0_f64, |max, at| max.max(at.m));
        assert!(
            largest <= m * (1.0 + 1e-9) && largest > 0.999 * m,
            "{largest} {m}"
        );
    }

    #[test]
    fn a_peak_that_rows_show_is_not_mentioned() {
        let text = slotted_rocker(0.5);
        let scene = PlaneScene::parse("far.toml", &text).unwrap();
        let prepared = PreparedScene::without_loads(&scene).unwrap();
        let curves = ReducedCurves::new(&prepared, None).unwrap();
        assert_eq!(peak_between_rows(&prepared, &curves), None);
    }
}
