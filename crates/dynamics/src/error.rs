//! What can go wrong when a mechanism moves.

use dwell_geometry::PlaceError;
use dwell_kinetostatics::KinetostaticsError;
use thiserror::Error;

impl From<KinetostaticsError> for DynamicsError {
    fn from(error: KinetostaticsError) -> Self {
        match error {
            KinetostaticsError::Place(place) => Self::Place(place),
            other => Self::Load(other),
        }
    }
}

/// A motion that cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DynamicsError {
    /// A position on the way cannot be reached.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// A load has no direction or magnitude on the way, or friction jams the mechanism.
    #[error(transparent)]
    Load(KinetostaticsError),
    /// The generalised inertia is zero (or no number): no finite acceleration answers a force.
    #[error("the generalised inertia m is {m} kg m² at q = {q} rad: nothing resists there")]
    NoInertia {
        /// The coordinate, rad.
        q: f64,
        /// The inertia there, kg m².
        m: f64,
    },
    /// The motion reaches a limit position of its actuator, where it passes to another branch.
    #[error(
        "the motion reaches a limit position near q = {q} rad at t = {t} s, and passes to another assembly branch there"
    )]
    Limit {
        /// The time of the last state on this branch, s.
        t: f64,
        /// Its coordinate, rad.
        q: f64,
    },
    /// A tolerance, time or speed that is not usable.
    #[error("{what} must be a {must}, not {value}")]
    BadOption {
        /// Which option.
        what: &'static str,
        /// What it must be.
        must: &'static str,
        /// What it is.
        value: f64,
    },
    /// The integrator produced a state that is not finite.
    #[error("the state is no longer finite after t = {t} s")]
    NotFinite {
        /// The last finite time, s.
        t: f64,
    },
    /// The step budget is used up.
    #[error("the budget of {steps} steps is used up at t = {t} s")]
    Budget {
        /// The time reached, s.
        t: f64,
        /// The budget.
        steps: usize,
    },
    /// The integrator's steps became too small to go on.
    #[error("the integrator's steps become too small at t = {t:e} s")]
    SmallStep {
        /// The time reached, s.
        t: f64,
    },
    /// The motion is shorter than what the integrator can tell from nothing.
    #[error("the motion is too short to compute: its end is its start, to rounding")]
    TooShort,
    /// The kinetic energy underflows or overflows.
    #[error(
        "the kinetic energy is {energy:e} J at {q_dot:e} rad/s: too far from 1 to compute with"
    )]
    BadEnergy {
        /// The speed at the start, rad/s.
        q_dot: f64,
        /// The energy there, J.
        energy: f64,
    },
    /// The integrator gave up.
    #[error("the integrator stopped at t = {t:e} s: {reason}")]
    Solver {
        /// The time reached, s.
        t: f64,
        /// Its own words.
        reason: String,
    },
    /// A free motion that starts at rest has no period of turning.
    #[error("the mechanism starts at rest, and nothing moves it")]
    AtRest,
    /// The coordinate does not turn fully, so there is no period of turning.
    #[error("the coordinate turns only from {from} to {to} rad")]
    NoFullTurn {
        /// Lower limit, rad.
        from: f64,
        /// Upper limit, rad.
        to: f64,
    },
    /// Something takes or gives energy, or there is not one freedom: energy alone does not tell the motion.
    #[error("the motion does not follow from its energy: {what}")]
    NotConservative {
        /// What it is.
        what: &'static str,
    },
    /// The motion has just the energy of an unstable equilibrium, which it nears for ever.
    #[error(
        "the motion has just the energy to creep up to the unstable equilibrium at q = {q}: it has no period"
    )]
    Creeps {
        /// The equilibrium, rad or m.
        q: f64,
    },
    /// The motion neither turns back nor repeats itself.
    #[error("the motion goes on past q = {q} and neither turns back nor repeats itself")]
    GoesOn {
        /// How far it was followed, rad or m.
        q: f64,
    },
    /// There is no equilibrium, or no single one, where it was looked for.
    #[error("no equilibrium: {what}")]
    NoEquilibrium {
        /// Why not.
        what: &'static str,
    },
    /// There is no steady cycle, or none was found.
    #[error("no steady cycle: {what}")]
    NoCycle {
        /// Why not.
        what: &'static str,
    },
    /// The eigenvalues of a linearisation could not be found.
    #[error("the eigenvalues of the linearised motion cannot be found")]
    NoEigenvalues,
    /// A motion that should turn comes to rest.
    #[error("the mechanism comes to rest at q = {q} rad and does not complete the turn")]
    Stalls {
        /// Where, rad.
        q: f64,
    },
    /// The quadrature over a period did not converge.
    #[error(
        "{points} points do not resolve the motion over a period (left: {left:.1e} of the period)"
    )]
    NotResolved {
        /// Number of points tried last.
        points: usize,
        /// Relative change of the last doubling.
        left: f64,
    },
}
