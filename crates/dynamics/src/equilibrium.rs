//! Equilibria of a loaded machine: states with the coordinates at rest and constant drive states. Coulomb friction is
//! regularised here and vanishes at rest, so it cannot hold the machine.

mod around;
mod at_rest;
mod one_freedom;
mod several_freedoms;

use crate::state_space::StateSpace;
pub use one_freedom::{equilibria, static_force_and_potential};
pub use several_freedoms::{equilibria_from_starts, equilibrium_near};

/// The stability of an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stability {
    /// A small disturbance decays.
    Asymptotic,
    /// A small disturbance oscillates undamped.
    Centre,
    /// A small disturbance grows.
    Unstable,
    /// There is no restoring force along some directions, in which equilibria continue; no other disturbance grows.
    Neutral,
    /// The linearised motion does not decide, within its error.
    Undecided,
}

impl Stability {
    /// By the eigenvalues of the linearised motion with their errors, and the number of neutral directions.
    fn of(eigenvalues: &[[f64; 2]], errors: &[f64], neutral: usize) -> Self {
        let with_errors = || eigenvalues.iter().zip(errors);
        if with_errors().any(|([re, _], error)| re > error) {
            Self::Unstable
        } else if neutral > 0 {
            Self::Neutral
        } else if with_errors().all(|([re, _], error)| *re < -error) {
            Self::Asymptotic
        } else if with_errors().all(|([_, im], error)| im.abs() > *error) {
            Self::Centre
        } else {
            Self::Undecided
        }
    }
}

/// A vibration mode of the linearised motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Natural angular frequency |λ|, rad/s.
    pub angular_frequency: f64,
    /// Damping ratio −Re λ / |λ|.
    pub damping_ratio: f64,
}

/// A direction in which equilibria go on.
#[derive(Debug, Clone, PartialEq)]
pub struct NeutralDirection {
    /// By free coordinate: its part of the direction, rad or m.
    pub direction: Vec<f64>,
    /// For a single coordinate: the interval in which every position is an equilibrium, rad or m.
    pub extent: Option<[f64; 2]>,
}

/// An equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The state.
    pub y: Vec<f64>,
    /// By free coordinate, speed and drive state: the estimated error of it, across the neutral directions.
    pub errors: Vec<f64>,
    /// The motion linearised there.
    pub state_space: StateSpace,
    /// Its eigenvalues, 1/s, as real and imaginary parts.
    pub eigenvalues: Vec<[f64; 2]>,
    /// By eigenvalue: its estimated error, 1/s.
    pub eigenvalue_errors: Vec<f64>,
    /// Its stability.
    pub stability: Stability,
    /// The directions in which equilibria go on.
    pub neutral: Vec<NeutralDirection>,
}

impl Equilibrium {
    /// Its vibration modes, the lowest frequency first. An imaginary part within its error counts as zero.
    pub fn modes(&self) -> Vec<Mode> {
        let mode = |(&[re, im], &error): (&[f64; 2], &f64)| {
            let angular_frequency = re.hypot(im);
            let damping_ratio = -re / angular_frequency;
            (im > error).then_some(Mode {
                angular_frequency,
                damping_ratio,
            })
        };
        let with_errors = self.eigenvalues.iter().zip(&self.eigenvalue_errors);
        let mut modes: Vec<Mode> = with_errors.filter_map(mode).collect();
        modes.sort_by(|x, y| x.angular_frequency.total_cmp(&y.angular_frequency));
        modes
    }
}
