//! A motion whose crank angles are known, and how its runs are timed.

use super::{ANGLE_ROUNDING, Run};
use dwell_dynamics::{Method, Options, Orbit, ReducedState};
use std::time::{Duration, Instant};

/// The names of the ways.
pub(crate) const EXACT: &str = "Dwell, exact";
pub(crate) const TABLE: &str = "Dwell, table built anew";
pub(crate) const QUADRATURE: &str = "Dwell, quadrature";
pub(crate) const FROM_TEXT: &str = "from the scene's text: quadrature";

/// A time is the least of as many runs as fit into this, but of no fewer and no more than these.
const TIME_BUDGET: Duration = Duration::from_millis(250);
const MIN_REPETITIONS: usize = 5;
const MAX_REPETITIONS: usize = 2000;
/// What the rules of a quadrature leave, as a part of the mean.
pub(crate) const QUADRATURE_ACCURACIES: [f64; 6] = [1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 0.0];
/// Times at which a rule is compared with that of all digits.
const COMPARED_TIMES: u32 = 23;
/// A method that takes longer than this is not asked for more digits, s.
const MAX_RUN_TIME: f64 = 0.2;

/// What stands before the motion, s: reading a scene, building its model; and in the plane a table to 1e-11.
pub(crate) struct Stages {
    pub(crate) case: String,
    pub(crate) read: f64,
    pub(crate) build: f64,
    pub(crate) table: Option<f64>,
}

/// The motion of a case.
pub(crate) struct Motion {
    pub(crate) case: String,
    pub(crate) start: ReducedState,
    /// Times (s) with the crank's angle there, rad; the last is the end.
    pub(crate) known: Vec<[f64; 2]>,
}

impl Motion {
    /// When it ends, s.
    pub(crate) fn end(&self) -> f64 {
        self.known.last().map_or(0.0, |[t, _]| *t)
    }

    /// A run that took so long and found these angles at the known times.
    pub(crate) fn run(&self, tool: &str, setting: String, wall: f64, angles: &[f64]) -> Run {
        let pairs = angles.iter().zip(&self.known);
        let largest = pairs.map(|(q, [_, known])| (q - known).abs());
        Run {
            case: self.case.clone(),
            tool: tool.to_owned(),
            setting,
            wall_time: wall,
            error: largest.fold(ANGLE_ROUNDING, f64::max),
        }
    }

    /// The angles at the known times.
    pub(crate) fn angles(&self, orbit: &Orbit) -> Vec<f64> {
        let at = |[t, _]: &[f64; 2]| orbit.state_at(*t).q;
        self.known.iter().map(at).collect()
    }

    /// A run by quadrature. At a whole number of periods a rule is at its best, so it counts with what it is
    /// off in between, too, beside the rule with all digits.
    pub(crate) fn quadrature_run(
        &self,
        tool: &str,
        (wall, (angles, orbit)): (f64, (Vec<f64>, Orbit)),
        exact_orbit: &Orbit,
    ) -> Run {
        let mut run = self.run(tool, format!("{} points", orbit.points), wall, &angles);
        for k in 0..COMPARED_TIMES {
            let t = self.end() * (f64::from(k) + 0.37) / f64::from(COMPARED_TIMES);
            run.error = run
                .error
                .max((orbit.state_at(t).q - exact_orbit.state_at(t).q).abs());
        }
        run
    }

    /// A method from tolerance to tolerance; a run gives the angles.
    pub(crate) fn tolerance_runs(
        &self,
        tool: &str,
        method: Method,
        run: &dyn Fn(&Options) -> Option<Vec<f64>>,
    ) -> Vec<Run> {
        let mut runs = Vec::new();
        for digits in 4..=13 {
            let options = Options::new(method, 10_f64.powi(-digits));
            // A tolerance that cannot be kept ends a method's row.
            let Ok((wall, angles)) = min_time(|| run(&options).ok_or("refused")) else {
                break;
            };
            runs.push(self.run(
                tool,
                format!("{}, 1e-{digits}", method.name()),
                wall,
                &angles,
            ));
            if wall > MAX_RUN_TIME {
                break;
            }
        }
        runs
    }
}

/// The least time of several runs, s, and what the last gave.
pub(crate) fn min_time<T, E>(mut run: impl FnMut() -> Result<T, E>) -> Result<(f64, T), E> {
    let (mut best, mut times, first) = (f64::INFINITY, 0, Instant::now());
    loop {
        let start = Instant::now();
        let value = run()?;
        best = best.min(start.elapsed().as_secs_f64());
        times += 1;
        if times >= MAX_REPETITIONS || (times >= MIN_REPETITIONS && first.elapsed() > TIME_BUDGET) {
            return Ok((best, value));
        }
    }
}
