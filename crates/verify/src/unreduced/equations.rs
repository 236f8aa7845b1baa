//! Equation (1) at one instant.

use super::drives::rotor;
use super::friction::Response;
use super::instant::Instant;
use super::rows::Frames;
use super::{MotionSample, Unreduced, UnreducedError};
use crate::solve::Lu;
use crate::state::BodyAct;
use dwell_geometry::vec2;
use dwell_kinetostatics::Magnitude;
use faer::Mat;

/// The equations from a start on: gears meshed, rows chosen.
pub(super) struct Meshed<'a> {
    pub(super) of: &'a Unreduced,
    pub(super) frames: Frames,
    /// The rows that are solved.
    pub(super) held: Vec<usize>,
    /// The rows that must close.
    pub(super) at_hand: Vec<usize>,
}

/// The equations solved.
pub(super) struct Solved {
    /// ẏ of the state [x, v, states of the drives, work].
    pub(super) rates: Vec<f64>,
    /// By row, actuators after reactions, the drives' (zero) after these.
    multipliers: Vec<f64>,
    drives: Vec<f64>,
    at: Instant,
}

/// What acts, but for friction, and the inertia that answers.
struct Applied {
    mass: Mat<f64>,
    force: Vec<f64>,
    /// Of what has no potential, W.
    power: f64,
    /// By drive: its action, and the rate of its state.
    drives: Vec<f64>,
    memory: Vec<f64>,
}

/// The rows at a state.
struct Local<'a> {
    x: &'a [f64],
    v: &'a [f64],
    memory: &'a [f64],
    jacobian: Vec<f64>,
    curvature: Vec<f64>,
}

/// Accelerations, and multipliers by row.
type Answer = (Vec<f64>, Vec<f64>);

fn add(to: &mut [f64], factor: f64, more: &[f64]) {
    to.iter_mut()
        .zip(more)
        .for_each(|(to, more)| *to += factor * more);
}

impl Meshed<'_> {
    /// Number of states.
    pub(super) fn states(&self) -> usize {
        2 * self.frames.count() + self.of.drives.len() + 1
    }

    pub(super) fn instant(&self, t: f64, y: &[f64]) -> Instant {
        let n = self.frames.count();
        let [bodies, velocity] = self.frames.leave(&y[..n], &y[n..2 * n]);
        Instant {
            t,
            bodies,
            velocity,
        }
    }

    /// The forces on the coordinates that acts make: forces, and moments about the centres.
    fn push(&self, acts: &[BodyAct], x: &[f64], force: &mut [f64]) {
        for act in acts {
            let Some(c) = self.frames.columns[act.body.0] else {
                continue;
            };
            let arm = act.at - self.frames.ground - vec2(x[c], x[c + 1]);
            force[c] += act.force.x;
            force[c + 1] += act.force.y;
            let moment = if act.force == dwell_geometry::Vec2::ZERO {
                0.0
            } else {
                arm.cross(act.force)
            };
            force[c + 2] += moment + act.couple;
        }
    }

    /// The masses, and nothing that acts.
    fn masses(&self) -> Applied {
        let n = self.frames.count();
        let mut mass = Mat::zeros(n, n);
        for (of, column) in self.of.masses.iter().zip(&self.frames.columns) {
            if let Some(c) = *column {
                mass[(c, c)] = of.mass;
                mass[(c + 1, c + 1)] = of.mass;
                mass[(c + 2, c + 2)] = of.inertia;
            }
        }
        Applied {
            mass,
            force: vec![0.0; n],
            power: 0.0,
            drives: vec![],
            memory: vec![],
        }
    }

    /// All loads but frictions; none if a magnitude cannot be told.
    fn load(&self, at: &Instant, local: &Local<'_>, to: &mut Applied) -> Option<()> {
        for (i, load) in self.of.loads.iter().enumerate() {
            if matches!(load.magnitude, Magnitude::Friction(_)) {
                continue;
            }
            let magnitude = self.of.magnitude(&load.magnitude, at)?;
            let acts = self.of.acts(i, magnitude, at);
            self.push(&acts, local.x, &mut to.force);
            if !load.conservative() {
                to.power += acts.iter().map(|act| at.power(act)).sum::<f64>();
            }
        }
        Some(())
    }

    /// All drives: the rotors' inertia I on s̈ = J ẍ + Φ̇ₓ ẋ joins the masses as Jᵀ I J.
    fn drive(&self, at: &Instant, local: &Local<'_>, to: &mut Applied) -> Option<()> {
        let n = self.frames.count();
        for (d, drive) in self.of.drives.iter().enumerate() {
            let row = self.frames.driven + self.of.guidance.len() + d;
            let speed = self.frames.rate(&local.jacobian, row, local.v);
            let driving = self.of.drive(d, speed, local.memory[d], at)?;
            let inertia = rotor(&drive.kind);
            let line = &local.jacobian[row * n..][..n];
            add(
                &mut to.force,
                driving.action - inertia * local.curvature[row],
                line,
            );
            for (i, a) in line.iter().enumerate() {
                for (j, b) in line.iter().enumerate() {
                    to.mass[(i, j)] += inertia * a * b;
                }
            }
            to.power += driving.action * speed;
            to.drives.push(driving.action);
            to.memory.push(driving.rate);
        }
        Some(())
    }

    /// Solves (1) at a state [x, v, states of the drives, work].
    pub(super) fn solve(&self, t: f64, y: &[f64]) -> Result<Solved, UnreducedError> {
        let frames = &self.frames;
        let n = frames.count();
        let not_finite = UnreducedError::NotFinite { t };
        if y.iter().any(|y| !y.is_finite()) {
            return Err(not_finite);
        }
        let at = self.instant(t, y);
        let (x, v) = (&y[..n], &y[n..2 * n]);
        let mut curvature = vec![0.0; frames.rows.len()];
        frames.rows.curvature(x, v, &mut curvature);
        let local = Local {
            x,
            v,
            memory: &y[2 * n..],
            jacobian: frames.jacobian(x),
            curvature,
        };
        let mut applied = self.masses();
        self.load(&at, &local, &mut applied).ok_or(not_finite)?;
        self.drive(&at, &local, &mut applied).ok_or(not_finite)?;
        let (a, multipliers) = self.answer(&at, &local, &mut applied)?;
        let speeds = &self.imposed(t)[1];
        for (tau, speed) in multipliers.iter().zip(speeds).skip(frames.driven) {
            applied.power += tau * speed;
        }
        let rates = [v, &a, &applied.memory, &[applied.power]].concat();
        if rates.iter().any(|r| !r.is_finite()) {
            return Err(not_finite);
        }
        Ok(Solved {
            rates,
            multipliers,
            drives: applied.drives,
            at,
        })
    }

    /// What answers to all that acts, with the frictions.
    fn answer(
        &self,
        at: &Instant,
        local: &Local<'_>,
        applied: &mut Applied,
    ) -> Result<Answer, UnreducedError> {
        let not_finite = UnreducedError::NotFinite { t: at.t };
        let frictions = self.of.frictions();
        let mut forces = vec![std::mem::take(&mut applied.force)];
        for (load, _) in &frictions {
            let mut unit = vec![0.0; self.frames.count()];
            self.push(&self.of.acts(*load, 1.0, at), local.x, &mut unit);
            forces.push(unit);
        }
        let mut found = self
            .augmented(&applied.mass, local, &forces, at.t)?
            .into_iter();
        let (mut a, mut multipliers) = found.next().ok_or(not_finite)?;
        let (pushes, units): (Vec<_>, Vec<_>) = found.unzip();
        let response = Response {
            without: multipliers.clone(),
            units,
        };
        let rubbing = self.rub(&frictions, &response, at)?;
        for (k, &force) in rubbing.iter().enumerate() {
            add(&mut a, force, &pushes[k]);
            add(&mut multipliers, force, &response.units[k]);
            let acts = self.of.acts(frictions[k].0, force, at);
            applied.power += acts.iter().map(|act| at.power(act)).sum::<f64>();
        }
        Ok((a, multipliers))
    }

    /// Accelerations and multipliers for several forces, the first with the accelerations that the
    /// rows want, the others with none.
    fn augmented(
        &self,
        mass: &Mat<f64>,
        local: &Local<'_>,
        forces: &[Vec<f64>],
        t: f64,
    ) -> Result<Vec<Answer>, UnreducedError> {
        let frames = &self.frames;
        let (n, m) = (frames.count(), self.held.len());
        let scale = |c| frames.column_scale(c);
        let scaled = |i: usize, j: usize| mass[(i, j)] * scale(i) * scale(j);
        // Kilograms of the size of one, as the rows are.
        let most = (0..n).map(|i| scaled(i, i)).fold(0.0, f64::max);
        let unit = if most > 0.0 { most } else { 1.0 };
        let mut matrix = Mat::zeros(n + m, n + m);
        for j in 0..n {
            for i in 0..n {
                matrix[(i, j)] = scaled(i, j) / unit;
            }
        }
        self.border(&local.jacobian, &mut matrix);
        let mut right = Mat::zeros(n + m, forces.len());
        for (k, force) in forces.iter().enumerate() {
            for (c, force) in force.iter().enumerate() {
                right[(c, k)] = force * scale(c) / unit;
            }
        }
        let imposed = &self.imposed(t)[2];
        for (k, &row) in self.held.iter().enumerate() {
            right[(n + k, 0)] = (imposed[row] - local.curvature[row]) * frames.row_scale[row];
        }
        let lu = Lu::new(matrix).map_err(|pivot| UnreducedError::Singular { t, pivot })?;
        lu.solve(&mut right);
        let solution = |k: usize| {
            let a = (0..n).map(|c| right[(c, k)] * scale(c)).collect();
            let mut multipliers = vec![0.0; frames.rows.len()];
            for (i, &row) in self.held.iter().enumerate() {
                multipliers[row] = -right[(n + i, k)] * frames.row_scale[row] * unit;
            }
            (a, multipliers)
        };
        Ok((0..forces.len()).map(solution).collect())
    }

    /// What is told of a state.
    pub(super) fn sample(&self, t: f64, y: &[f64]) -> Result<MotionSample, UnreducedError> {
        let Solved {
            mut multipliers,
            drives,
            at,
            ..
        } = self.solve(t, y)?;
        let [kinetic, potential] = self.of.energies(&at);
        let mut tau = multipliers.split_off(self.frames.driven);
        tau.truncate(self.of.guidance.len());
        Ok(MotionSample {
            t,
            bodies: at.bodies,
            velocity: at.velocity,
            reactions: multipliers,
            tau,
            drives,
            kinetic,
            potential,
            work: y.last().copied().unwrap_or(0.0),
        })
    }
}
