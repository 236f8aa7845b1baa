//! Check 6: the full multibody equations, not reduced.
//!
//! Every body has its centre of mass and its angle, x = [x_G, y_G, θ], whatever joins it to others,
//! and every joint has its multipliers. A free actuator has no row, and a drive is its force; the row of a prescribed one is
//! imposed by its law of time. At each instant
//!
//! ```text
//! ⎡ M  Jᵀ ⎤ ⎡  ẍ ⎤   ⎡ f(t, x, ẋ, λ) ⎤
//! ⎢       ⎥ ⎢    ⎥ = ⎢               ⎥                                        (1)
//! ⎣ J  0  ⎦ ⎣ −λ ⎦   ⎣ v̈ − Φ̇ₓ ẋ      ⎦
//! ```
//!
//! in dense numbers: M is singular where bodies are massless, the whole matrix is not. λ of a row is
//! the force or moment of its first body on its second. Friction and the separating forces of teeth make f depend on λ;
//! the response of (1) to each is a column more, and Newton's method finds how much of each there is.
//!
//! ẋ = v, v̇ = ẍ of (1) are integrated by extrapolation, to the order that the step needs; after each
//! step positions and velocities are moved by the least that closes the rows again. Nothing here
//! uses a plan, a tree, a reduced coordinate or another integrator of the project.

mod drives;
mod equations;
mod extrapolation;
mod friction;
mod motion_check;
mod rows;
mod state;

use crate::dense::DenseMechanism;
use crate::error::DenseError;
use crate::inertias::Inertias;
use dwell_dynamics::CoordinateMode;
use dwell_geometry::Mechanism;
use dwell_kinetostatics::{Drive, Load, Mass};
use extrapolation::ExtrapolationSolver;
pub use motion_check::check_motion;
use rows::centroidal_frames;

/// A result of the multibody equations.
pub(crate) type Result<T, E = MultibodyError> = std::result::Result<T, E>;

/// Why the multibody equations cannot be written or solved.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MultibodyError {
    /// The mechanism or its start is not sound.
    #[error(transparent)]
    Dense(#[from] DenseError),
    /// The number of coordinate modes is not that of the actuators.
    #[error("the number of coordinate modes is not that of the actuators")]
    CoordinateModes,
    /// A load that cannot act.
    #[error("load {load}: {what}")]
    Load {
        /// Its index.
        load: usize,
        /// The fault.
        what: &'static str,
    },
    /// A drive that cannot act.
    #[error("drive {drive}: {what}")]
    Drive {
        /// Its index.
        drive: usize,
        /// The fault.
        what: &'static str,
    },
    /// The poses, velocities or times are missing, not finite or not in order.
    #[error("the initial state or the times are incomplete, not finite or not increasing")]
    InvalidStart,
    /// Positions that do not close, at a time, s.
    #[error("at t = {0} s the constraint equations do not close")]
    NotClosed(f64),
    /// The equations have no single solution.
    #[error("at t = {t} s the equations of motion are singular: smallest pivot {pivot:.1e}")]
    Singular {
        /// Time, s.
        t: f64,
        /// Smallest pivot relative to the largest.
        pivot: f64,
    },
    /// At a time, s, no friction is consistent with the reactions that it causes.
    #[error(
        "at t = {0} s no friction force satisfies the friction law: the mechanism is self-locking"
    )]
    SelfLocking(f64),
    /// A load, drive or law that is not finite at a time, s.
    #[error("at t = {0} s a load, drive or law is not a finite number")]
    NotFinite(f64),
    /// The accuracy is out of reach from a time on, s.
    #[error("at t = {0} s the accuracy needs too many or too short steps")]
    AccuracyNotReached(f64),
}

/// A motion at one instant: of the multibody equations, or a claimed one. Values by body are in the order of
/// [`Mechanism::bodies`], including the ground.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionSample {
    /// Time, s.
    pub t: f64,
    /// The frame [x, y, θ] of every body, m and rad; θ counted from the start on.
    pub poses: Vec<[f64; 3]>,
    /// Its rates, m/s and rad/s.
    pub velocities: Vec<[f64; 3]>,
    /// The reactions in the order of [`Mechanism::reactions`], N or N·m.
    pub reactions: Vec<f64>,
    /// By actuator: the force of its prescribed motion, N·m or N; zero for a free one.
    pub tau: Vec<f64>,
    /// By drive: its force on the coordinate, N·m or N, without the part that accelerates its rotor.
    pub drive_forces: Vec<f64>,
    /// Kinetic energy, with the rotors', J.
    pub kinetic: f64,
    /// Potential energy of the loads that have one, J.
    pub potential: f64,
    /// Work since the start of all that has no potential: other loads, drives, prescribed motions, J.
    pub work: f64,
}

/// A mechanism in motion by its full equations.
#[derive(Debug, Clone)]
pub struct MultibodySystem {
    /// The given mechanism.
    mechanism: Mechanism,
    masses: Vec<Mass>,
    loads: Vec<Load>,
    modes: Vec<CoordinateMode>,
    drives: Vec<Drive>,
    /// The mechanism with an additional actuator for each drive, and with its frames at the centres of mass.
    frames: DenseMechanism,
}

impl MultibodySystem {
    /// The equations of a mechanism with one mass for each body, loads, one coordinate mode for each
    /// actuator, and drives along any coordinates.
    ///
    /// # Errors
    /// [`MultibodyError`] where they do not fit each other.
    pub fn new<'m>(
        mechanism: &Mechanism,
        inertias: impl Into<Inertias<'m>>,
        loads: &[Load],
        modes: &[CoordinateMode],
        drives: &[Drive],
    ) -> Result<Self> {
        let inertias = inertias.into();
        let frames = centroidal_frames(&drives::with_drives(mechanism, drives)?, inertias)?;
        if modes.len() != mechanism.actuators.len() {
            return Err(MultibodyError::CoordinateModes);
        }
        let mut masses = inertias.masses.to_vec();
        if let Some(ground) = masses.get_mut(mechanism.ground) {
            *ground = Mass::default();
        }
        let system = Self {
            mechanism: mechanism.clone(),
            masses,
            loads: loads.to_vec(),
            modes: modes.to_vec(),
            drives: drives.to_vec(),
            frames,
        };
        system.check_loads()?;
        system.check_drives()?;
        Ok(system)
    }

    /// Follows the motion from the poses and velocities of `start` (nothing else of it is read but its time), with the
    /// states of the drives at zero, and yields it at its time and at the `times` after it, s. The start is first moved
    /// by the smallest change that closes all rows; gears mesh in this position.
    ///
    /// # Errors
    /// [`MultibodyError`] if the start does not close, or the motion cannot be followed.
    pub fn integrate(&self, start: &MotionSample, times: &[f64]) -> Result<Vec<MotionSample>> {
        let rising = std::iter::once(&start.t).chain(times);
        let in_order = rising.clone().all(|t| t.is_finite())
            && rising.clone().zip(times).all(|(one, next)| one < next);
        let bodies = self.masses.len();
        let complete = start.poses.len() == bodies && start.velocities.len() == bodies;
        let numbers = start.poses.iter().chain(&start.velocities).flatten();
        if !in_order || !complete || numbers.into_iter().any(|v| !v.is_finite()) {
            return Err(MultibodyError::InvalidStart);
        }
        let ode = self.ode_at(start)?;
        let mut solver = ExtrapolationSolver::new(&ode, start, times.last().copied())?;
        let mut samples = vec![solver.sample()?];
        for &t in times {
            solver.advance_to(t)?;
            samples.push(solver.sample()?);
        }
        Ok(samples)
    }
}
