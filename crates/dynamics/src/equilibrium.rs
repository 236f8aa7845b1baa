//! Equilibria of a loaded machine: states that stay, with the coordinates at rest and the drives' states
//! settled. Coulomb friction, which fades with the speed here, holds nothing.

use crate::error::DynamicsError;
use crate::linear::{Linear, linearise};
use crate::machine::Machine;
use crate::moving::Moving;
use crate::root;
use crate::system::System;
use dwell_geometry::small;
use std::f64::consts::TAU;

/// Steps over the interval that is searched.
const STEPS: usize = 512;
/// Steps of Newton's method, and halvings of one.
const MOST_STEPS: usize = 100;
const MOST_HALVINGS: usize = 40;
/// Most that a coordinate is moved in a step, rad (or m): an angle further on is another place.
const MOST_MOVED: f64 = 0.5;
/// A step this small, relatively, that comes no nearer is rounding.
const NEAR: f64 = 1e-9;
/// A force below this part of the largest is none.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// A real part below this part of the largest eigenvalue is none.
const UNDAMPED: f64 = 1e-9;
/// Pivots below this part of the largest leave a matrix without a solution.
const SINGULAR: f64 = 1e-14;

/// What a small disturbance of an equilibrium does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// It dies out.
    Asymptotic,
    /// It swings on, as without damping.
    Centre,
    /// It grows.
    Unstable,
    /// The linearised motion does not tell.
    Undecided,
}

/// A swing of the linearised motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Natural circular frequency |λ|, rad/s.
    pub frequency: f64,
    /// Damping ratio −Re λ / |λ|.
    pub damping: f64,
}

/// An equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The state.
    pub y: Vec<f64>,
    /// The motion linearised there.
    pub linear: Linear,
    /// Its eigenvalues, 1/s, as real and imaginary parts.
    pub eigenvalues: Vec<[f64; 2]>,
    /// What a disturbance does.
    pub stability: Stability,
}

impl Equilibrium {
    fn new(machine: &Machine, y: Vec<f64>) -> Result<Self, DynamicsError> {
        let linear = linearise(machine, 0.0, &y)?;
        let eigenvalues = linear.eigenvalues()?;
        let stability = stability(&eigenvalues);
        Ok(Self {
            y,
            linear,
            eigenvalues,
            stability,
        })
    }

    /// Its swings, the slowest first.
    pub fn modes(&self) -> Vec<Mode> {
        let mode = |&[re, im]: &[f64; 2]| {
            let frequency = re.hypot(im);
            let damping = -re / frequency;
            (im > 0.0).then_some(Mode { frequency, damping })
        };
        let mut modes: Vec<Mode> = self.eigenvalues.iter().filter_map(mode).collect();
        modes.sort_by(|x, y| x.frequency.total_cmp(&y.frequency));
        modes
    }
}

fn stability(eigenvalues: &[[f64; 2]]) -> Stability {
    let sizes = eigenvalues.iter().map(|[re, im]| re.hypot(*im));
    let none = UNDAMPED * sizes.fold(0.0, f64::max);
    if eigenvalues.iter().any(|[re, _]| *re > none) {
        Stability::Unstable
    } else if eigenvalues.iter().all(|[re, _]| *re < -none) {
        Stability::Asymptotic
    } else if eigenvalues.iter().all(|[_, im]| im.abs() > none) {
        Stability::Centre
    } else {
        Stability::Undecided
    }
}

/// All equilibria of a machine of one free coordinate between two values of it, in their order.
///
/// Of a whole turn, from and to, only one end counts.
///
/// # Errors
/// [`DynamicsError::NoEquilibrium`] where every position is one, or a drive never settles; and what stands
/// in the way of an evaluation.
pub fn equilibria(
    machine: &Machine,
    [from, to]: [f64; 2],
) -> Result<Vec<Equilibrium>, DynamicsError> {
    let mut rest = Rest::new(machine)?;
    if machine.free().len() != 1 {
        return Err(DynamicsError::NoEquilibrium {
            what: "only the equilibria of one freedom can be found over an interval",
        });
    }
    let mut seen = Vec::with_capacity(STEPS + 1);
    for k in 0..=STEPS {
        let q = from + (to - from) * k as f64 / STEPS as f64;
        seen.push((q, rest.acceleration(q)?, rest.slope()?));
    }
    let size = seen.iter().fold(0.0_f64, |size, s| size.max(s.1.abs()));
    if size == 0.0 {
        return Err(DynamicsError::NoEquilibrium {
            what: "every position is one",
        });
    }
    let mut zeros = rest.zeros(&seen, size)?;
    let turns = (to - from) / TAU;
    let ends = [zeros.first(), zeros.last()] == [Some(&from), Some(&to)];
    if ends && turns == turns.round() && machine.model().plan().range().period().is_some() {
        zeros.pop();
    }
    let mut found = Vec::with_capacity(zeros.len());
    for q in zeros {
        rest.acceleration(q)?;
        found.push(Equilibrium::new(machine, rest.y.clone())?);
    }
    Ok(found)
}

/// What a machine of one free coordinate has at rest at each of some coordinates, the drives settled: the
/// generalised force, N·m or N, and the potential, J.
///
/// # Errors
/// As of [`equilibria`].
pub fn at_rest(machine: &Machine, coordinates: &[f64]) -> Result<Vec<[f64; 2]>, DynamicsError> {
    let mut rest = Rest::new(machine)?;
    if machine.free().len() != 1 {
        return Err(DynamicsError::NoEquilibrium {
            what: "only one freedom has a single force over its coordinate",
        });
    }
    let mut work = machine.work();
    let mut found = Vec::with_capacity(coordinates.len());
    for &q in coordinates {
        let acceleration = rest.acceleration(q)?;
        let mut moving = rest.y.clone();
        machine.evaluate(0.0, &moving, &mut work)?;
        let [still, potential] = machine.energy(&work);
        moving[1] = 1.0;
        machine.evaluate(0.0, &moving, &mut work)?;
        // Led coordinates stand still here, so that all kinetic energy is that of the free one.
        let inertia = 2.0 * (machine.energy(&work)[0] - still);
        found.push([inertia * acceleration, potential]);
    }
    Ok(found)
}

/// The equilibrium that Newton's method finds from a state, whatever the number of free coordinates.
///
/// # Errors
/// [`DynamicsError::NoEquilibrium`] where it finds none; and what stands in the way of an evaluation.
pub fn equilibrium_near(machine: &Machine, y: &[f64]) -> Result<Equilibrium, DynamicsError> {
    let mut rest = Rest::new(machine)?;
    rest.y.copy_from_slice(y);
    rest.still();
    let n = machine.free().len();
    // Coordinates and drives' states, against the rates of speeds and of drives' states.
    let columns: Vec<usize> = (0..n).chain(2 * n..machine.first_work()).collect();
    let rows: Vec<usize> = (n..machine.first_work()).collect();
    rest.solve(&rows, &columns)?;
    Equilibrium::new(machine, rest.y)
}

/// A machine at rest.
struct Rest<'m> {
    machine: &'m Machine,
    moving: Option<Moving<'m>>,
    y: Vec<f64>,
    rates: Vec<f64>,
    jacobian: Vec<f64>,
}

impl<'m> Rest<'m> {
    fn new(machine: &'m Machine) -> Result<Self, DynamicsError> {
        if machine.follows_time() {
            return Err(DynamicsError::NoEquilibrium {
                what: "a load, drive or prescribed motion changes with time",
            });
        }
        let n = machine.states();
        Ok(Self {
            machine,
            moving: None,
            y: vec![0.0; n],
            rates: vec![0.0; n],
            jacobian: vec![0.0; n * n],
        })
    }

    fn still(&mut self) {
        let n = self.machine.free().len();
        self.y[n..2 * n].fill(0.0);
        self.y[self.machine.first_work()..].fill(0.0);
    }

    fn moving(&mut self) -> Result<(), DynamicsError> {
        if self.moving.is_none() {
            self.moving = Some(Moving::new(self.machine, 0.0, &self.y)?);
        }
        Ok(())
    }

    fn rates(&mut self) -> Result<(), DynamicsError> {
        self.moving()?;
        match &mut self.moving {
            Some(moving) => moving.rates(0.0, &self.y, &mut self.rates),
            None => Ok(()),
        }
    }

    fn differentiate(&mut self) -> Result<(), DynamicsError> {
        self.moving()?;
        match &mut self.moving {
            Some(moving) => moving.jacobian(0.0, &self.y, &mut self.jacobian),
            None => Ok(()),
        }
    }

    /// q̈ at `q`, with the drives settled there.
    fn acceleration(&mut self, q: f64) -> Result<f64, DynamicsError> {
        self.y[0] = q;
        let memory: Vec<usize> = (2..self.machine.first_work()).collect();
        if memory.is_empty() {
            self.rates()?;
        } else {
            self.solve(&memory, &memory)?;
        }
        Ok(self.rates[1])
    }

    /// dq̈/dq at the last position, where the drives stay settled.
    fn slope(&mut self) -> Result<f64, DynamicsError> {
        self.differentiate()?;
        let n = self.machine.states();
        let memory: Vec<usize> = (2..self.machine.first_work()).collect();
        let mut answer: Vec<f64> = memory.iter().map(|&i| -self.jacobian[i * n]).collect();
        self.divide(&memory, &memory, &mut answer)?;
        let through = memory.iter().zip(&answer);
        let more: f64 = through.map(|(&j, dm)| self.jacobian[n + j] * dm).sum();
        Ok(self.jacobian[n] + more)
    }

    /// The zeros of q̈ between (q, q̈, dq̈/dq) at many q; `size` is the largest q̈.
    fn zeros(&mut self, seen: &[(f64, f64, f64)], size: f64) -> Result<Vec<f64>, DynamicsError> {
        let mut zeros = Vec::new();
        zeros.extend((seen[0].1 == 0.0).then_some(seen[0].0));
        for pair in seen.windows(2) {
            let [before, now] = [pair[0], pair[1]];
            if now.1 == 0.0 {
                zeros.push(now.0);
            } else if before.1 * now.1 < 0.0 {
                zeros.extend(root::zero(|q| self.acceleration(q), before.0, now.0)?);
            } else if before.1 * before.2 < 0.0 && now.1 * now.2 > 0.0 {
                // It comes nearer to zero, and goes away from it again.
                let slope = |q: f64| self.acceleration(q).and_then(|_| self.slope());
                let Some(nearest) = root::zero(slope, before.0, now.0)? else {
                    continue;
                };
                let least = self.acceleration(nearest)?;
                if least.abs() <= ROUNDING * size {
                    zeros.push(nearest);
                } else if least * now.1 < 0.0 {
                    zeros.extend(root::zero(|q| self.acceleration(q), before.0, nearest)?);
                    zeros.extend(root::zero(|q| self.acceleration(q), nearest, now.0)?);
                }
            }
        }
        Ok(zeros)
    }

    /// Solves with a block of the Jacobian in place.
    fn divide(
        &self,
        rows: &[usize],
        columns: &[usize],
        b: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let n = self.machine.states();
        let entry = |&i: &usize| columns.iter().map(move |&j| self.jacobian[i * n + j]);
        let mut block: Vec<f64> = rows.iter().flat_map(entry).collect();
        let mut pivots = vec![0; rows.len()];
        let factored = small::factor(&mut block, &mut pivots);
        let regular = factored.sign != 0.0 && factored.measure > SINGULAR;
        if !(rows.is_empty() || regular) {
            return Err(DynamicsError::NoEquilibrium {
                what: "the linear equations for it have no single solution, as with a drive that integrates",
            });
        }
        small::solve(&block, &pivots, b);
        Ok(())
    }

    /// Newton's method: some rates to zero, by some states.
    fn solve(&mut self, rows: &[usize], columns: &[usize]) -> Result<(), DynamicsError> {
        let size = |rates: &[f64]| {
            let squares = rows.iter().map(|&i| rates[i] * rates[i]);
            squares.sum::<f64>().sqrt()
        };
        let n = self.machine.free().len();
        self.rates()?;
        let mut left = size(&self.rates);
        for _ in 0..MOST_STEPS {
            self.differentiate()?;
            let mut step: Vec<f64> = rows.iter().map(|&i| -self.rates[i]).collect();
            self.divide(rows, columns, &mut step)?;
            let from = self.y.clone();
            let largest = |of: &dyn Fn(usize, f64) -> f64| {
                let both = columns.iter().zip(&step);
                both.fold(0.0_f64, |most, (&j, &step)| most.max(of(j, step)))
            };
            let relative = largest(&|j, step| step.abs() / from[j].abs().max(1.0));
            let moved = largest(&|j, step| if j < n { step.abs() } else { 0.0 });
            let mut factor = (MOST_MOVED / moved).min(1.0);
            let mut nearer = false;
            for _ in 0..MOST_HALVINGS {
                for (&j, step) in columns.iter().zip(&step) {
                    self.y[j] = from[j] + factor * step;
                }
                nearer = self.rates().is_ok() && size(&self.rates) < left;
                if nearer {
                    break;
                }
                factor *= 0.5;
            }
            if !nearer {
                // Rounding if the whole step was small, else a dead end.
                self.y = from;
                self.rates()?;
                if relative <= NEAR {
                    return Ok(());
                }
                break;
            }
            left = size(&self.rates);
            if relative <= 4.0 * f64::EPSILON {
                return Ok(());
            }
        }
        Err(DynamicsError::NoEquilibrium {
            what: "Newton's method finds none from there",
        })
    }
}
