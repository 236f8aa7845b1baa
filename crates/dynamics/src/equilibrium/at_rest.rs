//! A machine at rest: the equations of an equilibrium, and their rounding errors.
//!
//! The unknowns are the free coordinates and the states of the drives, the equations the accelerations q̈ and the rates
//! of those states. Newton's method solves them by the pseudo-inverse of their Jacobian, in coordinates and forces that
//! are scaled to the size of the mechanism, so that neutral directions do no harm.

use crate::error::{DynamicsError, Result};
use crate::machine::{Machine, MachineWorkspace, MovingModel};
use crate::machine_ode::MachineOde;
use crate::ode::OdeSystem;
use dwell_numerics::dense::Matrix;
use dwell_numerics::{DoubleDouble, Scalar, lu};

/// Largest number of steps of Newton's method, and of halvings of a step.
const MAX_NEWTON_STEPS: usize = 100;
const MAX_HALVINGS: usize = 40;
/// Largest change of a coordinate in a step, rad or m.
const MAX_COORDINATE_STEP: f64 = 0.5;
/// A step that does not reduce the residual and is smaller than this, relatively, is rounding.
const STEP_TOLERANCE: f64 = 1e-9;
/// A force below this fraction of the largest force, and of the size of the loads, counts as zero.
const FORCE_TOLERANCE: f64 = 64.0 * f64::EPSILON;
/// A coordinate is known to this part of itself, or of 1 rad or the size of the mechanism, where a rate is compared with zero.
const COORDINATE_TOLERANCE: f64 = 8.0 * f64::EPSILON;
/// Rounding of a force, and of a coordinate, in an error estimate.
const FORCE_ROUNDING: f64 = 2.0 * f64::EPSILON;
const COORDINATE_ROUNDING: f64 = 2.0 * f64::EPSILON;
/// If a force exceeds this fraction of the largest, Newton's method has found not an equilibrium, but a position of unbounded
/// inertia, in which the acceleration is zero.
const REMAINING_FORCE: f64 = 1e-7;
/// A singular value below this part of the largest is zero to Newton's method.
const SINGULAR: f64 = 1e-10;
/// Size of a Jacobian below which all its entries may be rounding.
const SMALL: f64 = 1e-4;
/// A component of a direction below this part of its largest is zero.
const NO_COMPONENT: f64 = 1e-6;

/// A machine at rest, with the working memory to find its equilibria.
pub(super) struct AtRest<'m, M: MovingModel> {
    pub(super) machine: &'m Machine<M>,
    ode: MachineOde<'m, M>,
    workspace: MachineWorkspace<f64, M>,
    pub(super) y: Vec<f64>,
    rates: Vec<f64>,
    jacobian: Vec<f64>,
    /// By free coordinate: 1 rad, or the size of the mechanism, m.
    arms: Vec<f64>,
    /// The work of the loads over this distance, J.
    work: f64,
}

/// The Jacobian of some rates by some states as U Σ Vᵀ, scaled by rows and columns.
pub(super) struct Factored {
    u: Matrix,
    sizes: Vec<f64>,
    v: Matrix,
    rows: Vec<f64>,
    columns: Vec<f64>,
}

impl Factored {
    /// The singular values that count as zero are those from here on: below a part of the largest, or of `size`, where a
    /// Jacobian of forces that change over an arm by all the loads can do has the size 1.
    pub(super) fn rank(&self, smallest: f64, size: f64) -> usize {
        let largest = self.sizes.first().copied().unwrap_or(0.0).max(size);
        let is_regular = |size: &&f64| **size > smallest * largest;
        self.sizes.iter().take_while(is_regular).count()
    }

    /// The smallest change of the states that changes the rates by `rates`, by the first `rank` singular values.
    fn solve(&self, rates: &[f64], rank: usize) -> Vec<f64> {
        self.sum_of_terms(rates, rank, |term| term)
    }

    /// The largest change of each state by changes of the rates up to `rates`.
    pub(super) fn largest_change(&self, rates: &[f64], rank: usize) -> Vec<f64> {
        self.sum_of_terms(rates, rank, f64::abs)
    }

    /// V Σ⁻¹ Uᵀ times some rates, of all whose terms something is taken.
    fn sum_of_terms(&self, rates: &[f64], rank: usize, of: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut states = vec![0.0; self.columns.len()];
        for k in 0..rank {
            let scaled = rates.iter().zip(&self.rows).enumerate();
            let terms = scaled.map(|(i, (r, scale))| of(self.u[(i, k)] * r * scale));
            let part: f64 = terms.sum();
            for (j, state) in states.iter_mut().enumerate() {
                *state += of(self.columns[j] * self.v[(j, k)] * part / self.sizes[k]);
            }
        }
        states
    }

    /// Directions that span the singular vectors from `rank` on, with as few states in each as possible.
    pub(super) fn null_directions(&self, rank: usize) -> Vec<Vec<f64>> {
        let n = self.columns.len();
        let mut basis: Vec<Vec<f64>> = (rank..n)
            .map(|k| (0..n).map(|j| self.v[(j, k)]).collect())
            .collect();
        for k in 0..basis.len() {
            // The largest component of those left becomes the only one of its state.
            let entries = (k..basis.len()).flat_map(|row| (0..n).map(move |j| (row, j)));
            let size = |&(row, j): &(usize, usize)| basis[row][j].abs();
            let Some((row, j)) = entries.max_by(|a, b| size(a).total_cmp(&size(b))) else {
                break;
            };
            basis.swap(k, row);
            let pivot = basis[k].clone();
            for (_, other) in basis.iter_mut().enumerate().filter(|(i, _)| *i != k) {
                let factor = other[j] / pivot[j];
                let parts = other.iter_mut().zip(&pivot);
                parts.for_each(|(part, of_pivot)| *part -= factor * of_pivot);
            }
        }
        for direction in &mut basis {
            let largest = direction.iter().fold(0.0_f64, |max, d| max.max(d.abs()));
            let sign = direction.iter().find(|d| d.abs() == largest);
            let scale = sign.map_or(1.0, |d| d.signum()) / largest;
            for (part, column) in direction.iter_mut().zip(&self.columns) {
                let scaled = *part * scale;
                *part = if scaled.abs() < NO_COMPONENT {
                    0.0
                } else {
                    scaled * column
                };
            }
        }
        basis
    }
}

impl<'m, M: MovingModel> AtRest<'m, M> {
    pub(super) fn new(machine: &'m Machine<M>) -> Result<Self> {
        machine.require_intervals()?;
        if machine.depends_on_time() {
            return none("a load, drive or prescribed motion changes with time");
        }
        let n = machine.state_count();
        let model = machine.model();
        let size = model.size();
        let arm = |&i: &usize| if model.is_angle(i) { 1.0 } else { size };
        Ok(Self {
            machine,
            ode: MachineOde::unscaled(machine),
            workspace: machine.workspace(),
            y: vec![0.0; n],
            rates: vec![0.0; n],
            jacobian: vec![0.0; n * n],
            arms: machine.free().iter().map(arm).collect(),
            work: machine.largest_work(0.0, 1.0),
        })
    }

    pub(super) fn free(&self) -> usize {
        self.machine.free().len()
    }

    /// Free coordinates and states of drives.
    pub(super) fn unknowns(&self) -> Vec<usize> {
        let n = self.free();
        (0..n).chain(self.machine.drive_states()).collect()
    }

    /// By unknown: the index of its equation; for a coordinate, that of the rate of its speed.
    fn equations(&self) -> Vec<usize> {
        (self.free()..self.machine.drive_states().end).collect()
    }

    /// Starts at a state, with all speeds zero.
    pub(super) fn begin_at(&mut self, y: &[f64]) {
        let n = self.free();
        self.y.copy_from_slice(y);
        self.y[n..2 * n].fill(0.0);
        self.y[self.machine.work_offset()..].fill(0.0);
    }

    fn evaluate(&mut self) -> Result<()> {
        self.ode.rhs(0.0, &self.y, &mut self.rates)
    }

    fn differentiate(&mut self) -> Result<()> {
        self.ode.jacobian(0.0, &self.y, &mut self.jacobian)
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.jacobian[i * self.machine.state_count() + j]
    }

    /// q̈ of the only coordinate at `q`, with the drives settled there.
    pub(super) fn acceleration(&mut self, q: f64) -> Result<f64> {
        self.y[0] = q;
        let drive_states: Vec<usize> = self.machine.drive_states().collect();
        if drive_states.is_empty() {
            self.evaluate()?;
        } else {
            self.solve(&drive_states, &drive_states)?;
        }
        Ok(self.rates[1])
    }

    /// dq̈/dq at the last position, where the drives stay settled.
    pub(super) fn acceleration_slope(&mut self) -> Result<f64> {
        self.differentiate()?;
        let drive_states: Vec<usize> = self.machine.drive_states().collect();
        if drive_states.is_empty() {
            return Ok(self.entry(1, 0));
        }
        let entries = drive_states.iter().map(|&i| -self.entry(i, 0));
        let rates: Vec<f64> = entries.collect();
        let factored = self.factor(&drive_states, &drive_states)?;
        let response = factored.solve(&rates, factored.rank(SINGULAR, SMALL));
        let through = drive_states.iter().zip(&response);
        let more: f64 = through.map(|(&j, change)| self.entry(1, j) * change).sum();
        Ok(self.entry(1, 0) + more)
    }

    /// The mass matrix at the present position, from the kinetic energies of unit speeds.
    fn mass_matrix(&mut self) -> Result<Vec<f64>> {
        let n = self.free();
        let mut state = self.y.clone();
        let mut energy = |speeds: &[usize]| -> Result<f64> {
            state[n..2 * n].fill(0.0);
            speeds.iter().for_each(|k| state[n + k] = 1.0);
            let evaluated = self.machine.evaluate(0.0, &state, &mut self.workspace)?;
            Ok(evaluated.energy()[0])
        };
        // Prescribed coordinates stand still, so that all kinetic energy is that of the free ones.
        let at_rest = energy(&[])?;
        let mut matrix = vec![0.0; n * n];
        for i in 0..n {
            matrix[i * n + i] = 2.0 * (energy(&[i])? - at_rest);
        }
        for i in 0..n {
            for j in 0..i {
                let both = 2.0 * (energy(&[i, j])? - at_rest);
                let mixed = 0.5 * (both - matrix[i * n + i] - matrix[j * n + j]);
                (matrix[i * n + j], matrix[j * n + i]) = (mixed, mixed);
            }
        }
        Ok(matrix)
    }

    /// By free coordinate: the static force along it (N·m or N), at the last rates.
    pub(super) fn forces(&mut self) -> Result<Vec<f64>> {
        let n = self.free();
        let matrix = self.mass_matrix()?;
        let accelerations = &self.rates[n..2 * n];
        let force = |i: usize| (0..n).map(|j| matrix[i * n + j] * accelerations[j]).sum();
        Ok((0..n).map(force).collect())
    }

    /// The largest work of static forces over 1 rad or the size of the mechanism, J.
    fn largest_work(&self, forces: &[f64]) -> f64 {
        let works = forces.iter().zip(&self.arms);
        works.fold(0.0, |max, (force, arm)| max.max(force.abs() * arm))
    }

    /// Includes the forces here in the scale of the forces.
    pub(super) fn count_forces(&mut self) -> Result<Vec<f64>> {
        let forces = self.forces()?;
        self.work = self.work.max(self.largest_work(&forces));
        Ok(forces)
    }

    /// Whether forces remain at the current position although its acceleration is zero.
    pub(super) fn has_forces(&mut self) -> Result<bool> {
        self.evaluate()?;
        let forces = self.forces()?;
        Ok(self.largest_work(&forces) > REMAINING_FORCE * self.work)
    }

    /// By free coordinate: the accelerations by forces of `part` of the largest works.
    fn accelerations_of(&mut self, part: f64) -> Result<Vec<f64>> {
        let n = self.free();
        let mut matrix = self.mass_matrix()?;
        let mut pivots = vec![0; n];
        lu::factor(&mut matrix, &mut pivots);
        let mut accelerations = vec![0.0; n];
        for k in 0..n {
            let mut response = vec![0.0; n];
            response[k] = part * self.work / self.arms[k];
            lu::solve(&matrix, &pivots, &mut response);
            let sums = accelerations.iter_mut().zip(&response);
            sums.for_each(|(sum, r)| *sum += r.abs());
        }
        Ok(accelerations)
    }

    /// The size below which the acceleration of the only coordinate counts as zero here.
    pub(super) fn zero_acceleration(&mut self) -> Result<f64> {
        Ok(self.accelerations_of(FORCE_TOLERANCE)?[0])
    }

    /// By equation: the size below which its rate counts as zero, at the last Jacobian.
    fn zero_rates(&mut self) -> Result<Vec<f64>> {
        self.rounding_of_rates(FORCE_TOLERANCE, COORDINATE_TOLERANCE)
    }

    /// By equation: the estimated rounding error of its rate, at the last Jacobian. The difference from double-double
    /// numbers includes the error of closing the loops.
    pub(super) fn rounding(&mut self) -> Result<Vec<f64>> {
        let mut rounding = self.rounding_of_rates(FORCE_ROUNDING, COORDINATE_ROUNDING)?;
        let mut workspace: MachineWorkspace<DoubleDouble, M> = self.machine.workspace();
        let at: Vec<DoubleDouble> = self.y.iter().map(|&y| DoubleDouble::from_f64(y)).collect();
        let mut finer = vec![DoubleDouble::from_f64(0.0); at.len()];
        let state = self.machine.evaluate(0.0, &at, &mut workspace)?;
        state.derivative(&mut finer);
        for (row, i) in rounding.iter_mut().zip(self.equations()) {
            *row += 2.0 * (DoubleDouble::from_f64(self.rates[i]) - finer[i]).hi.abs();
        }
        Ok(rounding)
    }

    fn rounding_of_rates(&mut self, force: f64, coordinate: f64) -> Result<Vec<f64>> {
        let n = self.free();
        let mut rounding = self.accelerations_of(force)?;
        rounding.resize(self.machine.drive_states().end - n, 0.0);
        for (row, i) in rounding.iter_mut().zip(self.equations()) {
            for &j in &self.unknowns() {
                let size = if j < n {
                    self.y[j].abs().max(self.arms[j])
                } else {
                    self.y[j].abs()
                };
                *row += coordinate * self.entry(i, j).abs() * size;
            }
        }
        Ok(rounding)
    }

    /// Whether every rate is zero here within rounding.
    pub(super) fn is_balanced(&mut self) -> Result<bool> {
        self.evaluate()?;
        let equations = self.equations();
        self.are_zero(&equations)
    }

    /// The Jacobian of all rates by all unknowns here.
    pub(super) fn factor_here(&mut self) -> Result<Factored> {
        self.evaluate()?;
        self.differentiate()?;
        let (equations, unknowns) = (self.equations(), self.unknowns());
        self.factor(&equations, &unknowns)
    }

    /// The change of the unknowns that brings the rates to zero, by the first `rank` singular values of the Jacobian.
    pub(super) fn correction(&self, factored: &Factored, rank: usize) -> Vec<f64> {
        let wanted: Vec<f64> = self.equations().iter().map(|&i| -self.rates[i]).collect();
        factored.solve(&wanted, rank)
    }

    /// The Jacobian of some rates by some states, from its last evaluation.
    fn factor(&mut self, rows: &[usize], columns: &[usize]) -> Result<Factored> {
        let n = self.free();
        let accelerations = self.accelerations_of(1.0)?;
        let largest = |entries: &mut dyn Iterator<Item = f64>| {
            let largest = entries.fold(0.0_f64, |max, a| max.max(a.abs()));
            if largest > 0.0 { largest } else { 1.0 }
        };
        let arm = |j: usize| self.arms.get(j).copied();
        let row_scale = |&i: &usize| match accelerations.get(i.wrapping_sub(n)) {
            Some(&acceleration) if acceleration > 0.0 => 1.0 / acceleration,
            Some(_) => 1.0,
            None => {
                let entries = columns.iter();
                let mut entries = entries.map(|&j| self.entry(i, j) * arm(j).unwrap_or(1.0));
                1.0 / largest(&mut entries)
            }
        };
        let row_scales: Vec<f64> = rows.iter().map(row_scale).collect();
        let column_scale = |&j: &usize| {
            let entries = rows.iter().zip(&row_scales);
            let mut entries = entries.map(|(&i, scale)| self.entry(i, j) * scale);
            arm(j).unwrap_or_else(|| 1.0 / largest(&mut entries))
        };
        let column_scales: Vec<f64> = columns.iter().map(column_scale).collect();
        let matrix = Matrix::from_fn(rows.len(), columns.len(), |i, j| {
            self.entry(rows[i], columns[j]) * row_scales[i] * column_scales[j]
        });
        let found = matrix.svd().ok_or(DynamicsError::NoEigenvalues)?;
        Ok(Factored {
            u: found.u,
            sizes: (0..columns.len()).map(|k| found.values[k]).collect(),
            v: found.v,
            rows: row_scales,
            columns: column_scales,
        })
    }

    /// Newton's method for all rates, from the present state.
    pub(super) fn solve_all(&mut self) -> Result<()> {
        let (equations, unknowns) = (self.equations(), self.unknowns());
        self.solve(&equations, &unknowns)
    }

    /// Refuses a drive whose state no state changes: it integrates.
    fn require_settling(&self, rows: &[usize], columns: &[usize]) -> Result<()> {
        let first = 2 * self.free();
        for &i in rows.iter().filter(|i| **i >= first) {
            if columns.iter().all(|&j| self.entry(i, j) == 0.0) {
                return none(if self.rates[i] == 0.0 {
                    "a speed controller that integrates can hold every position, each with another force"
                } else {
                    "a speed controller integrates towards a speed, so that it never settles at rest"
                });
            }
        }
        Ok(())
    }

    /// Newton's method: some rates to zero, by some states.
    fn solve(&mut self, rows: &[usize], columns: &[usize]) -> Result<()> {
        let n = self.free();
        self.evaluate()?;
        for _ in 0..MAX_NEWTON_STEPS {
            self.differentiate()?;
            self.require_settling(rows, columns)?;
            let factored = self.factor(rows, columns)?;
            let size = |rates: &[f64]| {
                let scaled = rows.iter().zip(&factored.rows);
                let squares = scaled.map(|(&i, scale)| (rates[i] * scale).powi(2));
                squares.sum::<f64>().sqrt()
            };
            let residual = size(&self.rates);
            if residual == 0.0 {
                return Ok(());
            }
            let wanted: Vec<f64> = rows.iter().map(|&i| -self.rates[i]).collect();
            let step = factored.solve(&wanted, factored.rank(SINGULAR, SMALL));
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
                nearer = self.evaluate().is_ok() && size(&self.rates) < residual;
                if nearer {
                    break;
                }
                factor *= 0.5;
            }
            if !nearer {
                // Rounding if the whole step was small, else Newton's method fails.
                self.y = from;
                self.evaluate()?;
                if relative_step <= STEP_TOLERANCE || self.are_zero(rows)? {
                    return Ok(());
                }
                return none(NOT_FROM_THERE);
            }
            if relative_step <= 4.0 * f64::EPSILON {
                return Ok(());
            }
        }
        if self.are_zero(rows)? {
            return Ok(());
        }
        none(NOT_FROM_THERE)
    }

    /// Whether these rates are zero within rounding at the last evaluation.
    fn are_zero(&mut self, rows: &[usize]) -> Result<bool> {
        self.differentiate()?;
        let zero = self.zero_rates()?;
        let n = self.free();
        Ok(rows.iter().all(|&i| self.rates[i].abs() <= zero[i - n]))
    }
}

/// Why Newton's method fails.
const NOT_FROM_THERE: &str = "Newton's method finds none from there";

/// The error that there is no equilibrium, with the reason.
pub(super) fn none<T>(what: &'static str) -> Result<T> {
    Err(DynamicsError::NoEquilibrium { what })
}
