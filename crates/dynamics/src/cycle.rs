//! The steady cycle of a rotating machine: after a cycle (one or more revolutions) the speed and the drive states
//! return to their values,
//!
//! ```text
//! φ(z) = z,    z = (q̇, states of the drives) at one position                    (1)
//! dz/dq = ż/q̇,    dS/dq = A S,    A = ∂(ż/q̇)/∂z,    S = ∂φ/∂z after a cycle      (2)
//! (S − I) δz = z − φ(z)                                                        (3)
//! ```
//!
//! The coordinate is the independent variable, so that a cycle ends at a known value of it, without a search for
//! events; the sensitivity S is integrated with the state, and Newton's method (3) converges quadratically. The
//! eigenvalues of S are the Floquet multipliers: the factors of a small disturbance after a cycle.

mod initial_transient;
mod variational;

pub use initial_transient::initial_transient;

use crate::eigenvalues::eigenvalues;
use crate::error::{DynamicsError, Result};
use crate::integrate::integrate;
use crate::machine::{Machine, MovingModel};
use crate::machine_ode::MachineOde;
use crate::ode::{DenseOutput, OdeState, OdeSystem, Step, StepControl};
use crate::options::Options;
use crate::repetition::{PERIODICITY_TOLERANCE, repetition_angle};
use dwell_numerics::lu;
use dwell_numerics::root;
use variational::VariationalSystem;

/// Why friction that holds has no steady cycle here.
const NO_CYCLE: &str = "a return map of a motion that holds and lets go is not smooth";

/// Highest number of steps of Newton's method, and of halvings of a step.
const MAX_NEWTON_STEPS: usize = 30;
const MAX_HALVINGS: usize = 8;
/// Newton's method ends with a step below this multiple of the tolerance.
const NEWTON_TOLERANCE_FACTOR: f64 = 10.0;
/// Phases, as parts of a revolution, at which a machine is compared with itself.
const PHASE_FRACTIONS: [f64; 5] = [0.0, 0.192, 0.417, 0.583, 0.877];
/// An integration that fails below this part of the initial speed has come to rest.
const STALL_FRACTION: f64 = 0.1;
/// A cycle is closed if its works add up to less than this part of the sum of their magnitudes, and if one more step of
/// Newton's method would change the speed by less than this part of it.
const CLOSURE_TOLERANCE: f64 = 1e-3;
/// Error of a return map in tolerances: BDF errs by hundreds.
const MAP_ERROR_RATIO: f64 = 100.0;
/// Samples of a cycle.
const SAMPLES: usize = 360;

/// A steady cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// The state at its start, with zero works.
    pub initial_state: Vec<f64>,
    /// The angle of a cycle, rad: one revolution or several.
    pub cycle_angle: f64,
    /// Its duration, s.
    pub period: f64,
    /// Mean speed over time, cycle angle / period, rad/s.
    pub mean_speed: f64,
    /// Coordinate (rad) and speed (rad/s) where the speed is least.
    pub slowest: [f64; 2],
    /// The coordinate and the speed at which the speed is greatest.
    pub fastest: [f64; 2],
    /// Coefficient of fluctuation: the difference of these speeds over the mean speed.
    pub fluctuation: f64,
    /// By nonconservative source of the machine: its work in a cycle, J. Their sum is zero.
    pub works: Vec<f64>,
    /// Floquet multipliers, as real and imaginary parts.
    pub floquet_multipliers: Vec<[f64; 2]>,
    /// By step of Newton's method: how far the speed was moved, relative to it.
    pub newton_steps: Vec<f64>,
    /// The cycle at equal distances of the coordinate, its end included.
    pub samples: Vec<OdeState>,
}

impl Cycle {
    /// Whether a small disturbance decays: every multiplier is less than 1 in magnitude.
    pub fn is_stable(&self) -> bool {
        self.floquet_multipliers
            .iter()
            .all(|[re, im]| re.hypot(*im) < 1.0)
    }
}

/// The steady cycle of a machine of one free angle, from a state near it. The coordinate of this state is the start of
/// the cycle, its speed gives the direction.
///
/// # Errors
/// [`DynamicsError::NoCycle`], [`DynamicsError::ComesToRest`] where the guess does not complete a cycle, and as of
/// [`Machine::evaluate`] and [`integrate`].
pub fn steady_cycle<M: MovingModel>(
    machine: &Machine<M>,
    guess: &[f64],
    options: &Options,
) -> Result<Cycle> {
    machine.require_smooth(NO_CYCLE)?;
    let problem = CycleProblem::new(machine, guess, options)?;
    let mut z: Vec<f64> = guess[1..machine.work_offset()].to_vec();
    let mut return_map = problem.return_map(&z)?;
    let mut tried = vec![Trial::new(&z, &return_map)];
    let mut steps: Vec<f64> = Vec::new();
    for _ in 0..MAX_NEWTON_STEPS {
        let step = problem.newton_step(&z, &return_map);
        let mut step = step.map_err(|error| never_balances(&tried).unwrap_or(error))?;
        let size = |i: usize| options.rtol * z[i].abs() + options.atol;
        let settled = (0..z.len()).all(|i| step[i].abs() <= NEWTON_TOLERANCE_FACTOR * size(i));
        let relative_step = (step[0] / z[0]).abs();
        // Near convergence only the error of the integration is left.
        let stuck =
            relative_step < 1e-6 && steps.last().is_some_and(|last| relative_step > 0.5 * last);
        steps.push(relative_step);
        // The speed keeps its direction.
        let max_factor = (0.5 / relative_step).min(1.0);
        step.iter_mut().for_each(|s| *s *= max_factor);
        let from = z.clone();
        let mut halvings = 0;
        return_map = loop {
            for ((z, from), step) in z.iter_mut().zip(&from).zip(&step) {
                *z = from + step;
            }
            match problem.return_map(&z) {
                Ok(return_map) => break return_map,
                Err(error) if halvings == MAX_HALVINGS => {
                    return Err(never_balances(&tried).unwrap_or(error));
                }
                Err(_) => {
                    halvings += 1;
                    step.iter_mut().for_each(|s| *s *= 0.5);
                }
            }
        };
        tried.push(Trial::new(&z, &return_map));
        if settled || stuck {
            let cycle = problem.resolve_cycle(&z, &return_map, steps)?;
            if problem.is_closed(&cycle, &return_map)? {
                return Ok(cycle);
            }
            return Err(never_balances(&tried).unwrap_or(DynamicsError::NoCycle {
                what: "the state after a cycle does not determine the speed within the error of the integration",
            }));
        }
    }
    Err(never_balances(&tried).unwrap_or(DynamicsError::NoCycle {
        what: "Newton's method does not settle from this speed",
    }))
}

/// A speed that was tried, rad/s, and the work that all sources do in a cycle from it, J.
struct Trial {
    q_dot: f64,
    work: f64,
}

impl Trial {
    fn new(z: &[f64], return_map: &ReturnMap) -> Self {
        Self {
            q_dot: z[0],
            work: return_map.works.iter().sum(),
        }
    }
}

/// Where a machine gains energy in a cycle from every speed tried, or loses it from every one: no cycle lies between them.
fn never_balances(tried: &[Trial]) -> Option<DynamicsError> {
    let is_one_sided = |sign: f64| tried.iter().all(|trial| trial.work * sign > 0.0);
    if !(is_one_sided(1.0) || is_one_sided(-1.0)) {
        return None;
    }
    let by_speed = |a: &&Trial, b: &&Trial| a.q_dot.abs().total_cmp(&b.q_dot.abs());
    let slowest = tried.iter().min_by(by_speed)?;
    let fastest = tried.iter().max_by(by_speed)?;
    Some(DynamicsError::NeverBalances {
        work: tried.first()?.work,
        q_dot: tried.first()?.q_dot,
        tried: [slowest.q_dot, fastest.q_dot],
    })
}

/// One cycle from z.
struct ReturnMap {
    /// φ(z).
    z: Vec<f64>,
    /// S, row by row.
    sensitivity: Vec<f64>,
    /// By nonconservative source: its work, J.
    works: Vec<f64>,
}

/// A rotating machine whose steady cycle is sought.
struct CycleProblem<'m, M: MovingModel> {
    machine: &'m Machine<M>,
    options: Options,
    /// Where a cycle begins, rad.
    start_angle: f64,
    /// +1 or −1.
    direction: f64,
    /// A cycle, rad.
    cycle_angle: f64,
}

impl<'m, M: MovingModel> CycleProblem<'m, M> {
    fn new(machine: &'m Machine<M>, guess: &[f64], options: &Options) -> Result<Self> {
        let none = |what| Err(DynamicsError::NoCycle { what });
        let [free] = *machine.free() else {
            return none("there is not just one free coordinate");
        };
        if !machine.model().is_angle(free) {
            return none("the free coordinate is a length, which makes no revolutions");
        }
        if machine.depends_on_time() {
            return none("a load, drive or prescribed motion changes with time");
        }
        if guess[1] == 0.0 {
            return none("the guess is at rest");
        }
        let Some(cycle_angle) = cycle_angle(machine, guess)? else {
            return none("the machine does not repeat itself after any number of revolutions");
        };
        Ok(Self {
            machine,
            options: *options,
            start_angle: guess[0],
            direction: guess[1].signum(),
            cycle_angle,
        })
    }

    /// Number of unknowns.
    fn unknowns(&self) -> usize {
        self.machine.work_offset() - 1
    }

    /// Time, z and works at the start of a cycle.
    fn initial_values(&self, z: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.machine.state_count()];
        x[1..=z.len()].copy_from_slice(z);
        x
    }

    fn return_map(&self, z: &[f64]) -> Result<ReturnMap> {
        let n = self.unknowns();
        let mut x = self.initial_values(z);
        let plain = x.len();
        for i in 0..n * n {
            x.push(if i % (n + 1) == 0 { 1.0 } else { 0.0 });
        }
        let mut system = VariationalSystem::new(self, &x, n)?;
        let start = OdeState { t: 0.0, y: x };
        let mut observer =
            |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
        let (end, options) = (Some(self.cycle_angle), &self.options);
        let termination = integrate(&mut system, &start, end, options, &mut observer)?;
        let stalled = (termination.state.y[1] / z[0]).abs() < STALL_FRACTION;
        match termination.error {
            // Rates by the coordinate are infinite where the speed falls to zero.
            Some(
                DynamicsError::NotFinite { .. }
                | DynamicsError::StepTooSmall { .. }
                | DynamicsError::TooSlow { .. },
            ) if stalled => {
                let q = self.start_angle + self.direction * termination.state.t;
                Err(DynamicsError::ComesToRest { q })
            }
            Some(error) => Err(error),
            None => Ok(ReturnMap {
                z: termination.state.y[1..=n].to_vec(),
                works: termination.state.y[self.machine.work_offset()..plain].to_vec(),
                sensitivity: termination.state.y[plain..].to_vec(),
            }),
        }
    }

    /// δz of (3).
    fn newton_step(&self, z: &[f64], return_map: &ReturnMap) -> Result<Vec<f64>> {
        let n = z.len();
        let mut matrix = return_map.sensitivity.clone();
        for i in 0..n {
            matrix[i * n + i] -= 1.0;
        }
        let mut step: Vec<f64> = z
            .iter()
            .zip(&return_map.z)
            .map(|(z, after)| z - after)
            .collect();
        let mut pivots = vec![0; n];
        let factored = lu::factor(&mut matrix, &mut pivots);
        if factored.determinant_sign == 0.0 || factored.pivot_ratio == 0.0 {
            return Err(DynamicsError::NoCycle {
                what: "nothing brings the machine back to any one speed",
            });
        }
        lu::solve(&matrix, &pivots, &mut step);
        Ok(step)
    }

    /// Whether a cycle repeats itself: its works add up to zero, and φ determines its start.
    ///
    /// Where a machine gains energy at every speed, the speed that a cycle changes least is infinite: φ(z) − z and S − I
    /// both fall below the error of the integration as z grows, and Newton's method settles anywhere.
    fn is_closed(&self, cycle: &Cycle, return_map: &ReturnMap) -> Result<bool> {
        let step = self.newton_step(&cycle.initial_state[1..=return_map.z.len()], return_map)?;
        if (step[0] / cycle.initial_state[1]).abs() > CLOSURE_TOLERANCE {
            return Ok(false);
        }
        let mut workspace = self.machine.workspace();
        let state = self
            .machine
            .evaluate(0.0, &cycle.initial_state, &mut workspace)?;
        let [kinetic, _] = state.energy();
        let map_error = MAP_ERROR_RATIO * self.options.rtol;
        let sum: f64 = cycle.works.iter().sum();
        let size = self.work_done_and_undone(cycle)?;
        if size > map_error * kinetic {
            return Ok(sum.abs() <= CLOSURE_TOLERANCE * size + map_error * kinetic);
        }
        // The works are lost in the error: only that a disturbance decays or grows shows a cycle.
        let mut multipliers = cycle.floquet_multipliers.iter();
        Ok(multipliers.all(|[re, im]| (re - 1.0).hypot(*im) > map_error))
    }

    /// The sum of the magnitudes of the works of all sources in a cycle, J. For a single source, whose work is zero in a steady
    /// cycle, it is the sum of its positive and negative parts.
    fn work_done_and_undone(&self, cycle: &Cycle) -> Result<f64> {
        let mut ode = MachineOde::new(self.machine, 0.0, &cycle.initial_state)?;
        let mut rates = vec![0.0; self.machine.state_count()];
        let mut sum = 0.0;
        for sample in &cycle.samples {
            ode.rhs(sample.t, &sample.y, &mut rates)?;
            let powers = rates[self.machine.work_offset()..].iter();
            sum += powers.map(|power| power.abs()).sum::<f64>();
        }
        let magnitudes: f64 = cycle.works.iter().map(|work| work.abs()).sum();
        Ok(magnitudes.max(cycle.period * sum / cycle.samples.len().max(1) as f64))
    }

    /// The state of the machine at a displacement from the start.
    fn machine_state(&self, displacement: f64, x: &[f64]) -> OdeState {
        let mut y = x[..self.machine.state_count()].to_vec();
        let t = y[0];
        y[0] = self.start_angle + self.direction * displacement;
        OdeState { t, y }
    }

    /// The cycle in full, once its start is known.
    fn resolve_cycle(&self, z: &[f64], return_map: &ReturnMap, steps: Vec<f64>) -> Result<Cycle> {
        let x = self.initial_values(z);
        let mut system = VariationalSystem::new(self, &x, 0)?;
        let mut ode = MachineOde::new(self.machine, 0.0, &self.machine_state(0.0, &x).y)?;
        let mut rates = vec![0.0; self.machine.state_count()];
        let mut rise = |point: &OdeState| -> Result<f64> {
            ode.rhs(point.t, &point.y, &mut rates)?;
            Ok(self.direction * rates[1])
        };
        let start = OdeState { t: 0.0, y: x };
        let first = self.machine_state(0.0, &start.y);
        let mut last = rise(&first)?;
        let mut extremes = vec![[first.y[0], first.y[1]]];
        let mut samples = vec![first.clone()];
        let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
            let mut step = Step { before, now, dense };
            let (ends, mut from) = (step.root_subintervals(), before.t);
            let mut state_inside =
                |at: f64| -> Result<OdeState> { Ok(self.machine_state(at, &step.state_at(at)?.y)) };
            for to in ends {
                let rises = rise(&state_inside(to)?)?;
                if last * rises < 0.0
                    && let Some(at) = root::find(|at| rise(&state_inside(at)?), from, to)?
                {
                    let state = state_inside(at)?;
                    extremes.push([state.y[0], state.y[1]]);
                }
                (from, last) = (to, rises);
            }
            while samples.len() <= SAMPLES
                && let at = self.cycle_angle * samples.len() as f64 / SAMPLES as f64
                && at <= now.t
            {
                samples.push(state_inside(at)?);
            }
            Ok(StepControl::Continue)
        };
        let (to, options) = (Some(self.cycle_angle), &self.options);
        let last = integrate(&mut system, &start, to, options, &mut observer)?.completed()?;
        let end = self.machine_state(self.cycle_angle, &last.y);
        let by_speed = |x: &&[f64; 2], y: &&[f64; 2]| x[1].abs().total_cmp(&y[1].abs());
        let slowest = *extremes.iter().min_by(by_speed).unwrap_or(&extremes[0]);
        let fastest = *extremes.iter().max_by(by_speed).unwrap_or(&extremes[0]);
        let mean_speed = self.direction * self.cycle_angle / end.t;
        Ok(Cycle {
            initial_state: first.y,
            cycle_angle: self.cycle_angle,
            period: end.t,
            mean_speed,
            slowest,
            fastest,
            fluctuation: (fastest[1] - slowest[1]) / mean_speed,
            works: end.y[self.machine.work_offset()..].to_vec(),
            floquet_multipliers: eigenvalues(&return_map.sensitivity, z.len())?,
            newton_steps: steps,
            samples,
        })
    }
}

/// The angle after which the machine moves as before, rad; none if that never happens.
fn cycle_angle<M: MovingModel>(machine: &Machine<M>, y: &[f64]) -> Result<Option<f64>> {
    let mut ode = MachineOde::new(machine, 0.0, y)?;
    let rates = |q: f64| -> Result<Vec<f64>> {
        let mut there = y.to_vec();
        there[0] = q;
        let mut rates = vec![0.0; y.len()];
        ode.rhs(0.0, &there, &mut rates)?;
        Ok(rates)
    };
    let same = |all: &[Vec<f64>], here: &Vec<f64>, there: &Vec<f64>| {
        here.iter().zip(there).enumerate().all(|(i, (a, b))| {
            let size = all.iter().fold(0.0_f64, |max, r| max.max(r[i].abs()));
            (a - b).abs() <= PERIODICITY_TOLERANCE * size
        })
    };
    repetition_angle(y[0], &PHASE_FRACTIONS, rates, same)
}
