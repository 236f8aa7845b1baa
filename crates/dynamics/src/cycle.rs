//! The steady cycle of a machine that turns: the speed and the drives' states are after a turn what they
//! were before,
//!
//! ```text
//! φ(z) = z,    z = (q̇, states of the drives) at one position                    (1)
//! dz/dq = ż/q̇,    dS/dq = A S,    A = ∂(ż/q̇)/∂z,    S = ∂φ/∂z after a turn       (2)
//! (S − I) δz = z − φ(z)                                                        (3)
//! ```
//!
//! The coordinate is the independent variable, so that a turn ends where it ends and no event is looked
//! for; its sensitivity is integrated with it, and Newton's method (3) converges quadratically. The
//! eigenvalues of S are the Floquet multipliers: what is left of a disturbance after a turn.

use crate::along::Along;
use crate::driver::{Dense, Next, integrate};
use crate::error::DynamicsError;
use crate::linear::eigenvalues;
use crate::machine::Machine;
use crate::moving::Moving;
use crate::options::Options;
use crate::root;
use crate::system::{Point, System};
use dwell_geometry::small;
use std::f64::consts::TAU;

/// Steps of Newton's method, and times a step is halved.
const MOST_STEPS: usize = 30;
const MOST_HALVINGS: usize = 8;
/// A step ends Newton's method below so many tolerances.
const SETTLED: f64 = 10.0;
/// Turns after which a machine that has not come back never does.
const MOST_TURNS: u32 = 8;
/// Where it is compared with itself, in parts of a turn, and how nearly it must be the same.
const COMPARED: [f64; 5] = [0.0, 0.192, 0.417, 0.583, 0.877];
const SAME: f64 = 1e-9;
/// An integration that fails below this part of the first speed has come to rest.
const STALLED: f64 = 0.1;
/// Points of a step between which a sign is looked at.
const LOOKS: usize = 4;
/// Samples of a cycle.
const SAMPLES: usize = 360;

/// A steady cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Cycle {
    /// The state where it begins, with no work done yet.
    pub start: Vec<f64>,
    /// What the coordinate gains in a cycle, rad: a whole turn or several.
    pub turn: f64,
    /// Its time, s.
    pub period: f64,
    /// Mean speed over time, turn / period, rad/s.
    pub mean_speed: f64,
    /// Coordinate (rad) and speed (rad/s) where it is slowest.
    pub slowest: [f64; 2],
    /// Where it is fastest.
    pub fastest: [f64; 2],
    /// Coefficient of fluctuation: the difference of these speeds over the mean speed.
    pub fluctuation: f64,
    /// By worker of the machine: its work in a cycle, J. Their sum is zero.
    pub works: Vec<f64>,
    /// Floquet multipliers, as real and imaginary parts.
    pub multipliers: Vec<[f64; 2]>,
    /// By step of Newton's method: how far the speed was moved, relative to it.
    pub steps: Vec<f64>,
    /// The cycle at equal distances of the coordinate, its end included.
    pub samples: Vec<Point>,
}

impl Cycle {
    /// Whether a small disturbance dies out: every multiplier is less than one in size.
    pub fn stable(&self) -> bool {
        self.multipliers.iter().all(|[re, im]| re.hypot(*im) < 1.0)
    }
}

/// The steady cycle of a machine of one free angle, from a state near it: its coordinate is where the
/// cycle begins, its speed gives the direction.
///
/// # Errors
/// [`DynamicsError::NoCycle`], [`DynamicsError::Stalls`] where the guess does not get round, and as of
/// [`Machine::evaluate`] and [`integrate`].
pub fn steady_cycle(
    machine: &Machine,
    guess: &[f64],
    options: &Options,
) -> Result<Cycle, DynamicsError> {
    let turning = Turning::new(machine, guess, options)?;
    let mut z: Vec<f64> = guess[1..machine.first_work()].to_vec();
    let mut lap = turning.lap(&z)?;
    let mut steps: Vec<f64> = Vec::new();
    for _ in 0..MOST_STEPS {
        let mut step = turning.newton(&z, &lap)?;
        let size = |i: usize| options.relative * z[i].abs() + options.absolute;
        let settled = (0..z.len()).all(|i| step[i].abs() <= SETTLED * size(i));
        let relative = (step[0] / z[0]).abs();
        // Near the end only the integration's own error is left.
        let stuck = relative < 1e-6 && steps.last().is_some_and(|last| relative > 0.5 * last);
        steps.push(relative);
        // The speed keeps its direction.
        let most = (0.5 / relative).min(1.0);
        step.iter_mut().for_each(|s| *s *= most);
        let from = z.clone();
        let mut halvings = 0;
        lap = loop {
            for ((z, from), step) in z.iter_mut().zip(&from).zip(&step) {
                *z = from + step;
            }
            match turning.lap(&z) {
                Ok(lap) => break lap,
                Err(error) if halvings == MOST_HALVINGS => return Err(error),
                Err(_) => {
                    halvings += 1;
                    step.iter_mut().for_each(|s| *s *= 0.5);
                }
            }
        };
        if settled || stuck {
            return turning.cycle(&z, &lap, steps);
        }
    }
    Err(DynamicsError::NoCycle {
        what: "Newton's method does not settle from this speed",
    })
}

/// The state after some whole turns from a start, at rest or not: a guess for [`steady_cycle`].
///
/// # Errors
/// As of [`Machine::evaluate`] and [`integrate`]: a budget of steps among them, where it never gets round.
pub fn run_up(
    machine: &Machine,
    start: &[f64],
    turns: u32,
    options: &Options,
) -> Result<Vec<f64>, DynamicsError> {
    let mut moving = Moving::new(machine, 0.0, start)?;
    let from = start[0];
    let way = TAU * f64::from(turns);
    let mut reached = start.to_vec();
    let mut watch = |before: &Point, now: &Point, dense: Dense<'_>| {
        if (now.y[0] - from).abs() < way {
            return Ok(Next::GoOn);
        }
        reached.clone_from(&now.y);
        let off = |t: f64| -> Result<f64, DynamicsError> {
            if t < now.t {
                dense(t, &mut reached)?;
            } else {
                reached.clone_from(&now.y);
            }
            Ok((reached[0] - from).abs() - way)
        };
        if let Some(t) = root::zero(off, before.t, now.t)?
            && t < now.t
        {
            dense(t, &mut reached)?;
        }
        Ok(Next::Stop)
    };
    let start = Point {
        t: 0.0,
        y: start.to_vec(),
    };
    let ended = integrate(&mut moving, &start, None, options, &mut watch)?;
    if let Some(error) = ended.failed {
        return Err(error);
    }
    // The works are those of a cycle to come.
    reached[machine.first_work()..].fill(0.0);
    Ok(reached)
}

/// One cycle from z.
struct Lap {
    /// φ(z).
    z: Vec<f64>,
    /// S, row by row.
    sensitivity: Vec<f64>,
}

/// A machine that turns.
pub(crate) struct Turning<'m> {
    pub(crate) machine: &'m Machine,
    options: Options,
    /// Where a cycle begins, rad.
    pub(crate) from: f64,
    /// +1 or −1.
    pub(crate) way: f64,
    /// A cycle, rad.
    pub(crate) turn: f64,
}

impl<'m> Turning<'m> {
    fn new(machine: &'m Machine, guess: &[f64], options: &Options) -> Result<Self, DynamicsError> {
        let none = |what| Err(DynamicsError::NoCycle { what });
        let [free] = *machine.free() else {
            return none("there is not just one free coordinate");
        };
        if !machine.model().plan().is_angle(free) {
            return none("the free coordinate is a length and cannot turn");
        }
        if machine.follows_time() {
            return none("a load, drive or prescribed motion changes with time");
        }
        if guess[1] == 0.0 {
            return none("the guess is at rest");
        }
        let Some(turn) = repeats(machine, guess)? else {
            return none("the machine is not the same after any number of turns");
        };
        Ok(Self {
            machine,
            options: *options,
            from: guess[0],
            way: guess[1].signum(),
            turn,
        })
    }

    /// Number of unknowns.
    pub(crate) fn unknowns(&self) -> usize {
        self.machine.first_work() - 1
    }

    /// Time, z and works at the start of a cycle.
    fn first(&self, z: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.machine.states()];
        x[1..=z.len()].copy_from_slice(z);
        x
    }

    fn lap(&self, z: &[f64]) -> Result<Lap, DynamicsError> {
        let n = self.unknowns();
        let mut x = self.first(z);
        let plain = x.len();
        for i in 0..n * n {
            x.push(if i % (n + 1) == 0 { 1.0 } else { 0.0 });
        }
        let mut along = Along::new(self, &x, n)?;
        let start = Point { t: 0.0, y: x };
        let mut watch = |_: &Point, _: &Point, _: Dense<'_>| Ok(Next::GoOn);
        let ended = integrate(
            &mut along,
            &start,
            Some(self.turn),
            &self.options,
            &mut watch,
        )?;
        let slow = (ended.at.y[1] / z[0]).abs() < STALLED;
        match ended.failed {
            // Rates over the way are infinite where the speed falls to zero.
            Some(DynamicsError::NotFinite { .. } | DynamicsError::SmallStep { .. }) if slow => {
                let q = self.from + self.way * ended.at.t;
                Err(DynamicsError::Stalls { q })
            }
            Some(error) => Err(error),
            None => Ok(Lap {
                z: ended.at.y[1..=n].to_vec(),
                sensitivity: ended.at.y[plain..].to_vec(),
            }),
        }
    }

    /// δz of (3).
    fn newton(&self, z: &[f64], lap: &Lap) -> Result<Vec<f64>, DynamicsError> {
        let n = z.len();
        let mut matrix = lap.sensitivity.clone();
        for i in 0..n {
            matrix[i * n + i] -= 1.0;
        }
        let mut step: Vec<f64> = z.iter().zip(&lap.z).map(|(z, after)| z - after).collect();
        let mut pivots = vec![0; n];
        let factored = small::factor(&mut matrix, &mut pivots);
        if factored.sign == 0.0 || factored.measure == 0.0 {
            return Err(DynamicsError::NoCycle {
                what: "nothing brings the machine back to any one speed",
            });
        }
        small::solve(&matrix, &pivots, &mut step);
        Ok(step)
    }

    /// The state of the machine at a way from the start.
    pub(crate) fn state(&self, along: f64, x: &[f64]) -> Point {
        let mut y = x[..self.machine.states()].to_vec();
        let t = y[0];
        y[0] = self.from + self.way * along;
        Point { t, y }
    }

    /// The cycle in full, once its start is known.
    fn cycle(&self, z: &[f64], lap: &Lap, steps: Vec<f64>) -> Result<Cycle, DynamicsError> {
        let x = self.first(z);
        let mut along = Along::new(self, &x, 0)?;
        let mut eye = Moving::new(self.machine, 0.0, &self.state(0.0, &x).y)?;
        let mut rates = vec![0.0; self.machine.states()];
        let mut rise = |point: &Point| -> Result<f64, DynamicsError> {
            eye.rates(point.t, &point.y, &mut rates)?;
            Ok(self.way * rates[1])
        };
        let start = Point { t: 0.0, y: x };
        let first = self.state(0.0, &start.y);
        let mut last = rise(&first)?;
        let mut extremes = vec![[first.y[0], first.y[1]]];
        let mut samples = vec![first.clone()];
        let mut watch = |before: &Point, now: &Point, dense: Dense<'_>| {
            let mut inside = |at: f64| -> Result<Point, DynamicsError> {
                let mut x = now.y.clone();
                if at < now.t {
                    dense(at, &mut x)?;
                }
                Ok(self.state(at, &x))
            };
            let mut from = before.t;
            for k in 1..=LOOKS {
                let to = before.t + (now.t - before.t) * k as f64 / LOOKS as f64;
                let rises = rise(&inside(to)?)?;
                if last * rises < 0.0
                    && let Some(at) = root::zero(|at| rise(&inside(at)?), from, to)?
                {
                    let state = inside(at)?;
                    extremes.push([state.y[0], state.y[1]]);
                }
                (from, last) = (to, rises);
            }
            while samples.len() <= SAMPLES
                && let at = self.turn * samples.len() as f64 / SAMPLES as f64
                && at <= now.t
            {
                samples.push(inside(at)?);
            }
            Ok(Next::GoOn)
        };
        let ended = integrate(
            &mut along,
            &start,
            Some(self.turn),
            &self.options,
            &mut watch,
        )?;
        if let Some(error) = ended.failed {
            return Err(error);
        }
        let end = self.state(self.turn, &ended.at.y);
        let by_speed = |x: &&[f64; 2], y: &&[f64; 2]| x[1].abs().total_cmp(&y[1].abs());
        let slowest = *extremes.iter().min_by(by_speed).unwrap_or(&extremes[0]);
        let fastest = *extremes.iter().max_by(by_speed).unwrap_or(&extremes[0]);
        let mean_speed = self.way * self.turn / end.t;
        Ok(Cycle {
            start: first.y,
            turn: self.turn,
            period: end.t,
            mean_speed,
            slowest,
            fastest,
            fluctuation: (fastest[1] - slowest[1]) / mean_speed,
            works: end.y[self.machine.first_work()..].to_vec(),
            multipliers: eigenvalues(&lap.sensitivity, z.len())?,
            steps,
            samples,
        })
    }
}

/// After how many radians the machine moves as before; none if that never happens.
fn repeats(machine: &Machine, y: &[f64]) -> Result<Option<f64>, DynamicsError> {
    let mut moving = Moving::new(machine, 0.0, y)?;
    let mut rates = |q: f64| -> Result<Vec<f64>, DynamicsError> {
        let mut there = y.to_vec();
        there[0] = q;
        let mut rates = vec![0.0; y.len()];
        moving.rates(0.0, &there, &mut rates)?;
        Ok(rates)
    };
    let mut here = Vec::with_capacity(COMPARED.len());
    for part in COMPARED {
        here.push(rates(y[0] + TAU * part)?);
    }
    let largest = |i: usize| here.iter().fold(0.0_f64, |most, r| most.max(r[i].abs()));
    let sizes: Vec<f64> = (0..y.len()).map(largest).collect();
    for turns in 1..=MOST_TURNS {
        let turn = TAU * f64::from(turns);
        let mut same = true;
        for (part, here) in COMPARED.iter().zip(&here) {
            let Ok(there) = rates(y[0] + TAU * part + turn) else {
                return Ok(None);
            };
            let mut both = here.iter().zip(&there).zip(&sizes);
            same &= both.all(|((a, b), size)| (a - b).abs() <= SAME * size);
        }
        if same {
            return Ok(Some(turn));
        }
    }
    Ok(None)
}
