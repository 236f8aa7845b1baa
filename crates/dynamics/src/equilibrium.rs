//! Equilibria of a loaded machine: states with the coordinates at rest and constant drive states. Coulomb friction is
//! regularised here and vanishes at rest, so it keeps nothing in place.

use crate::error::{DynamicsError, Result};
use crate::machine::Machine;
use crate::machine_ode::MachineOde;
use crate::ode::OdeSystem;
use crate::state_space::{StateSpace, linearise};
use dwell_numerics::lu;
use dwell_numerics::root;
use std::f64::consts::TAU;

/// Steps over the interval that is searched.
const SEARCH_STEPS: usize = 512;
/// Steps of Newton's method, and halvings of one.
const MAX_NEWTON_STEPS: usize = 100;
const MAX_HALVINGS: usize = 40;
/// Largest change of a coordinate in a step, rad or m.
const MAX_COORDINATE_STEP: f64 = 0.5;
/// A step that does not reduce the residual and is smaller than this, relatively, is rounding.
const STEP_TOLERANCE: f64 = 1e-9;
/// A force below this part of the largest is zero.
const FORCE_TOLERANCE: f64 = 64.0 * f64::EPSILON;
/// A real part below this part of the largest eigenvalue is zero.
const DAMPING_TOLERANCE: f64 = 1e-9;
/// With pivots below this part of the largest a matrix is singular.
const PIVOT_TOLERANCE: f64 = 1e-14;

/// The stability of an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// A small disturbance decays.
    Asymptotic,
    /// A small disturbance oscillates undamped.
    Centre,
    /// A small disturbance grows.
    Unstable,
    /// The linearised motion does not decide.
    Undecided,
}

/// A vibration mode of the linearised motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Natural angular frequency |λ|, rad/s.
    pub angular_frequency: f64,
    /// Damping ratio −Re λ / |λ|.
    pub damping_ratio: f64,
}

/// An equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The state.
    pub y: Vec<f64>,
    /// The motion linearised there.
    pub state_space: StateSpace,
    /// Its eigenvalues, 1/s, as real and imaginary parts.
    pub eigenvalues: Vec<[f64; 2]>,
    /// Its stability.
    pub stability: Stability,
}

impl Equilibrium {
    fn new(machine: &Machine, y: Vec<f64>) -> Result<Self> {
        let state_space = linearise(machine, 0.0, &y)?;
        let eigenvalues = state_space.eigenvalues()?;
        let stability = stability(&eigenvalues);
        Ok(Self {
            y,
            state_space,
            eigenvalues,
            stability,
        })
    }

    /// Its vibration modes, the lowest frequency first.
    pub fn modes(&self) -> Vec<Mode> {
        let mode = |&[re, im]: &[f64; 2]| {
            let angular_frequency = re.hypot(im);
            let damping_ratio = -re / angular_frequency;
            (im > 0.0).then_some(Mode {
                angular_frequency,
                damping_ratio,
            })
        };
        let mut modes: Vec<Mode> = self.eigenvalues.iter().filter_map(mode).collect();
        modes.sort_by(|x, y| x.angular_frequency.total_cmp(&y.angular_frequency));
        modes
    }
}

fn stability(eigenvalues: &[[f64; 2]]) -> Stability {
    let sizes = eigenvalues.iter().map(|[re, im]| re.hypot(*im));
    let none = DAMPING_TOLERANCE * sizes.fold(0.0, f64::max);
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

/// That there is no equilibrium, and why.
fn none<T>(what: &'static str) -> Result<T> {
    Err(DynamicsError::NoEquilibrium { what })
}

/// All equilibria of a machine of one free coordinate between two values of it, in their order.
///
/// Of a whole revolution only one end counts.
///
/// # Errors
/// [`DynamicsError::NoEquilibrium`] where every position is one, or a drive never settles; and what stands
/// in the way of an evaluation.
pub fn equilibria(machine: &Machine, [from, to]: [f64; 2]) -> Result<Vec<Equilibrium>> {
    let mut problem = EquilibriumProblem::new(machine)?;
    if machine.free().len() != 1 {
        return none("equilibria over an interval can be found for one degree of freedom only");
    }
    let mut samples = Vec::with_capacity(SEARCH_STEPS + 1);
    for k in 0..=SEARCH_STEPS {
        let q = from + (to - from) * k as f64 / SEARCH_STEPS as f64;
        samples.push((q, problem.acceleration(q)?, problem.acceleration_slope()?));
    }
    let size = samples.iter().fold(0.0_f64, |size, s| size.max(s.1.abs()));
    if size == 0.0 {
        return none("every position is one");
    }
    let mut zeros = problem.zeros(&samples, size)?;
    let revolutions = (to - from) / TAU;
    let at_both_ends = [zeros.first(), zeros.last()] == [Some(&from), Some(&to)];
    let periodic = machine.model().plan().range().period().is_some();
    if at_both_ends && revolutions == revolutions.round() && periodic {
        zeros.pop();
    }
    let mut found = Vec::with_capacity(zeros.len());
    for q in zeros {
        problem.acceleration(q)?;
        found.push(Equilibrium::new(machine, problem.y.clone())?);
    }
    Ok(found)
}

/// The generalised force (N·m or N) and the potential (J) of a machine of one free coordinate at rest, at each of some
/// coordinates, with the drives settled.
///
/// # Errors
/// As of [`equilibria`].
pub fn static_force_and_potential(machine: &Machine, coordinates: &[f64]) -> Result<Vec<[f64; 2]>> {
    let mut problem = EquilibriumProblem::new(machine)?;
    if machine.free().len() != 1 {
        return none("a single force over the coordinate exists for one degree of freedom only");
    }
    let mut workspace = machine.workspace();
    let mut found = Vec::with_capacity(coordinates.len());
    for &q in coordinates {
        let acceleration = problem.acceleration(q)?;
        let mut state = problem.y.clone();
        let at_rest = machine.evaluate(0.0, &state, &mut workspace)?;
        let [kinetic_at_rest, potential] = at_rest.energy();
        state[1] = 1.0;
        let moving = machine.evaluate(0.0, &state, &mut workspace)?;
        // Prescribed coordinates stand still here, so that all kinetic energy is that of the free one.
        let inertia = 2.0 * (moving.energy()[0] - kinetic_at_rest);
        found.push([inertia * acceleration, potential]);
    }
    Ok(found)
}

/// The equilibrium that Newton's method finds from a state, whatever the number of free coordinates.
///
/// # Errors
/// [`DynamicsError::NoEquilibrium`] where it finds none; and what stands in the way of an evaluation.
pub fn equilibrium_near(machine: &Machine, y: &[f64]) -> Result<Equilibrium> {
    let mut problem = EquilibriumProblem::new(machine)?;
    problem.y.copy_from_slice(y);
    problem.set_at_rest();
    let n = machine.free().len();
    // Coordinates and drives' states, against the rates of speeds and of drives' states.
    let columns: Vec<usize> = (0..n).chain(2 * n..machine.work_offset()).collect();
    let rows: Vec<usize> = (n..machine.work_offset()).collect();
    problem.solve(&rows, &columns)?;
    Equilibrium::new(machine, problem.y)
}

/// A machine at rest.
struct EquilibriumProblem<'m> {
    machine: &'m Machine,
    ode: MachineOde<'m>,
    y: Vec<f64>,
    rhs: Vec<f64>,
    jacobian: Vec<f64>,
}

impl<'m> EquilibriumProblem<'m> {
    fn new(machine: &'m Machine) -> Result<Self> {
        if machine.depends_on_time() {
            return none("a load, drive or prescribed motion changes with time");
        }
        let n = machine.state_count();
        Ok(Self {
            machine,
            ode: MachineOde::unscaled(machine),
            y: vec![0.0; n],
            rhs: vec![0.0; n],
            jacobian: vec![0.0; n * n],
        })
    }

    fn set_at_rest(&mut self) {
        let n = self.machine.free().len();
        self.y[n..2 * n].fill(0.0);
        self.y[self.machine.work_offset()..].fill(0.0);
    }

    fn rhs(&mut self) -> Result<()> {
        self.ode.rhs(0.0, &self.y, &mut self.rhs)
    }

    /// q̈ at `q`, with the drives settled there.
    fn acceleration(&mut self, q: f64) -> Result<f64> {
        self.y[0] = q;
        let drive_states: Vec<usize> = (2..self.machine.work_offset()).collect();
        if drive_states.is_empty() {
            self.rhs()?;
        } else {
            self.solve(&drive_states, &drive_states)?;
        }
        Ok(self.rhs[1])
    }

    /// dq̈/dq at the last position, where the drives stay settled.
    fn acceleration_slope(&mut self) -> Result<f64> {
        self.ode.jacobian(0.0, &self.y, &mut self.jacobian)?;
        let n = self.machine.state_count();
        let drive_states: Vec<usize> = (2..self.machine.work_offset()).collect();
        let entries = drive_states.iter().map(|&i| -self.jacobian[i * n]);
        let mut response: Vec<f64> = entries.collect();
        self.solve_block(&drive_states, &drive_states, &mut response)?;
        let through = drive_states.iter().zip(&response);
        let more: f64 = through.map(|(&j, dm)| self.jacobian[n + j] * dm).sum();
        Ok(self.jacobian[n] + more)
    }

    /// The zeros of q̈ between (q, q̈, dq̈/dq) at many q; `size` is the largest q̈.
    fn zeros(&mut self, samples: &[(f64, f64, f64)], size: f64) -> Result<Vec<f64>> {
        let mut zeros = Vec::new();
        zeros.extend((samples[0].1 == 0.0).then_some(samples[0].0));
        for pair in samples.windows(2) {
            let [before, now] = [pair[0], pair[1]];
            if now.1 == 0.0 {
                zeros.push(now.0);
            } else if before.1 * now.1 < 0.0 {
                zeros.extend(root::find(|q| self.acceleration(q), before.0, now.0)?);
            } else if before.1 * before.2 < 0.0 && now.1 * now.2 > 0.0 {
                // It approaches zero and leaves it again.
                let slope = |q: f64| self.acceleration(q).and_then(|_| self.acceleration_slope());
                let Some(nearest) = root::find(slope, before.0, now.0)? else {
                    continue;
                };
                let extremum = self.acceleration(nearest)?;
                if extremum.abs() <= FORCE_TOLERANCE * size {
                    zeros.push(nearest);
                } else if extremum * now.1 < 0.0 {
                    zeros.extend(root::find(|q| self.acceleration(q), before.0, nearest)?);
                    zeros.extend(root::find(|q| self.acceleration(q), nearest, now.0)?);
                }
            }
        }
        Ok(zeros)
    }

    /// Solves with a block of the Jacobian in place.
    fn solve_block(&self, rows: &[usize], columns: &[usize], b: &mut [f64]) -> Result<()> {
        let n = self.machine.state_count();
        let entry = |&i: &usize| columns.iter().map(move |&j| self.jacobian[i * n + j]);
        let mut block: Vec<f64> = rows.iter().flat_map(entry).collect();
        let mut pivots = vec![0; rows.len()];
        let factored = lu::factor(&mut block, &mut pivots);
        let regular = factored.determinant_sign != 0.0 && factored.pivot_ratio > PIVOT_TOLERANCE;
        if !(rows.is_empty() || regular) {
            return none(
                "the linear equations for it have no single solution, as with a drive that integrates",
            );
        }
        lu::solve(&block, &pivots, b);
        Ok(())
    }

    /// Newton's method: some rates to zero, by some states.
    fn solve(&mut self, rows: &[usize], columns: &[usize]) -> Result<()> {
        let size = |rates: &[f64]| {
            let squares = rows.iter().map(|&i| rates[i] * rates[i]);
            squares.sum::<f64>().sqrt()
        };
        let n = self.machine.free().len();
        self.rhs()?;
        let mut residual = size(&self.rhs);
        for _ in 0..MAX_NEWTON_STEPS {
            self.ode.jacobian(0.0, &self.y, &mut self.jacobian)?;
            let mut step: Vec<f64> = rows.iter().map(|&i| -self.rhs[i]).collect();
            self.solve_block(rows, columns, &mut step)?;
            let from = self.y.clone();
            let largest = |of: &dyn Fn(usize, f64) -> f64| {
                let both = columns.iter().zip(&step);
                both.fold(0.0_f64, |max, (&j, &step)| max.max(of(j, step)))
            };
            let relative_step = largest(&|j, step| step.abs() / from[j].abs().max(1.0));
            let moved = largest(&|j, step| if j < n { step.abs() } else { 0.0 });
            let mut factor = (MAX_COORDINATE_STEP / moved).min(1.0);
            let mut nearer = false;
            for _ in 0..MAX_HALVINGS {
                for (&j, step) in columns.iter().zip(&step) {
                    self.y[j] = from[j] + factor * step;
                }
                nearer = self.rhs().is_ok() && size(&self.rhs) < residual;
                if nearer {
                    break;
                }
                factor *= 0.5;
            }
            if !nearer {
                // Rounding if the whole step was small, else Newton's method fails.
                self.y = from;
                self.rhs()?;
                if relative_step <= STEP_TOLERANCE {
                    return Ok(());
                }
                break;
            }
            residual = size(&self.rhs);
            if relative_step <= 4.0 * f64::EPSILON {
                return Ok(());
            }
        }
        none("Newton's method finds none from there")
    }
}
