//! The errors of motions.

use dwell_geometry::PositionError;
use dwell_kinetostatics::KinetostaticsError;
use dwell_numerics::panels::NotResolved;
use thiserror::Error;

/// A result that fails with a [`DynamicsError`] unless another error is named.
pub type Result<T, E = DynamicsError> = std::result::Result<T, E>;

/// Occurrences of events that are kept.
pub(crate) const MAX_OCCURRENCES: usize = 100_000;

/// The error of a motion in which more events happen than are kept; they are known up to a time, s.
pub(crate) fn too_many_events(t: f64) -> DynamicsError {
    DynamicsError::TooManyEvents {
        t,
        max_occurrences: MAX_OCCURRENCES,
    }
}

impl From<KinetostaticsError> for DynamicsError {
    fn from(error: KinetostaticsError) -> Self {
        match error {
            KinetostaticsError::Position(position) => Self::Position(position),
            other => Self::Load(other),
        }
    }
}

impl From<NotResolved> for DynamicsError {
    fn from(NotResolved { points, tail }: NotResolved) -> Self {
        Self::NotResolved { points, tail }
    }
}

/// A motion that cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DynamicsError {
    /// A position of the motion cannot be reached.
    #[error(transparent)]
    Position(#[from] PositionError),
    /// A load has no direction or magnitude at some position, or friction jams the mechanism.
    #[error(transparent)]
    Load(KinetostaticsError),
    /// The generalised inertia is not positive: a force has no finite acceleration.
    #[error("the generalised inertia m is {m} kg m² at q = {q} rad: no body with mass moves there")]
    NoInertia {
        /// The coordinate, rad.
        q: f64,
        /// The inertia there, kg m².
        m: f64,
    },
    /// The motion reaches a limit position of its actuator, where it passes to another assembly branch.
    #[error(
        "the motion reaches a limit position near q = {q} rad at t = {t} s, and passes to another assembly branch there"
    )]
    LimitPosition {
        /// The time of the last state on this branch, s.
        t: f64,
        /// Its coordinate, rad.
        q: f64,
    },
    /// Two assembly branches come so close that rounding does not show which of them the motion follows.
    #[error(
        "two assembly branches come close at q = {q}, within {half_width:.1e} of the coordinate, which the motion reaches soon after t = {t} s"
    )]
    NearBranches {
        /// The time of the last state before, s.
        t: f64,
        /// The coordinate at which they are nearest, rad or m.
        q: f64,
        /// The half-width of the coordinate within which they differ from those of a change point, rad or m.
        half_width: f64,
    },
    /// An option, such as a tolerance, that cannot be used.
    #[error("{what} must be a {must}, not {value}")]
    BadOption {
        /// Which option.
        what: &'static str,
        /// The condition on its value.
        must: &'static str,
        /// Its value.
        value: f64,
    },
    /// The user interrupted the computation: see [`interruption`](crate::interruption).
    #[error("the computation was interrupted")]
    Interrupted,
    /// The integrator produced a state that is not finite.
    #[error("the state is no longer finite after t = {t} s")]
    NotFinite {
        /// The last finite time, s.
        t: f64,
    },
    /// The number of steps allowed is used up.
    #[error("the {max_steps} steps allowed are used up at t = {t} s")]
    MaxStepsReached {
        /// The time reached, s.
        t: f64,
        /// The number of steps allowed.
        max_steps: usize,
    },
    /// The number of steps allowed is far too small for the pace of the last ones.
    #[error(
        "after {steps} steps the motion is at t = {t} s: at this pace its end would take {needed:.0e} more, and {max_steps} are allowed"
    )]
    TooSlow {
        /// The time reached, s.
        t: f64,
        /// The steps taken.
        steps: usize,
        /// How many more its end would take.
        needed: f64,
        /// The number of steps allowed.
        max_steps: usize,
        /// If switches are counted: the index of the load of the last switch (those of the drives last).
        switching: Option<usize>,
    },
    /// There are more events than can be stored.
    #[error("more than {max_occurrences} events happen: up to t = {t} s these are all")]
    TooManyEvents {
        /// The time of the last one kept, s.
        t: f64,
        /// The number of occurrences that are kept.
        max_occurrences: usize,
    },
    /// A step covers so many revolutions that events within it are not searched for.
    #[error("events cannot be found in a step from t = {t} s through {angle} rad")]
    StepTooLongForEvents {
        /// Start of the step, s.
        t: f64,
        /// Change of the angle in the step, rad.
        angle: f64,
    },
    /// Something varies so fast in time that more steps are needed than allowed.
    #[error(
        "a function of time varies within {width:.1e} s near t = {t} s, for which more steps are needed than the {max_steps} allowed"
    )]
    VariesTooFast {
        /// Its index: that of a load (those of the drives last), or, after all loads, of a prescribed actuator.
        source_index: usize,
        /// The time over which it varies, s.
        width: f64,
        /// Where, s.
        t: f64,
        /// The number of steps allowed.
        max_steps: usize,
    },
    /// A load or drive switches forth and back without end: on both sides it drives the motion back to the switch, as
    /// a brake at rest does.
    #[error("the load of index {source_index} switches back and forth without end at t = {t} s")]
    Chatters {
        /// The index of the load (those of the drives last).
        source_index: usize,
        /// The time reached, s.
        t: f64,
    },
    /// The motion slides along the switch of a load that drives it back from both sides, and another switch or contact
    /// changes or holds it there.
    #[error(
        "the load of index {source_index} holds the motion at its switch together with others at t = {t} s"
    )]
    SlidesOnSeveral {
        /// The index of the load (those of the drives last).
        source_index: usize,
        /// The time reached, s.
        t: f64,
    },
    /// Surfaces with dry friction can neither hold nor slide: no mode of them agrees with the forces, or they change it
    /// without end.
    #[error("the surfaces of friction {source_index} can neither stick nor slide")]
    NoContactMode {
        /// Which: the index of a load.
        source_index: usize,
    },
    /// A coordinate meets its end stop and leaves it without end at one instant.
    #[error(
        "at end stop {stop}, impacts or changes between rest and motion follow each other without end"
    )]
    StopsWithoutEnd {
        /// Which end stop.
        stop: usize,
    },
    /// A motion starts beyond an end stop.
    #[error("the motion starts at {q}, beyond end stop {stop}")]
    BeyondStop {
        /// Which end stop.
        stop: usize,
        /// The coordinate, rad or m.
        q: f64,
    },
    /// An analysis of smooth motions was requested, and there is an end stop.
    #[error("end stop {stop}: {what}")]
    Stops {
        /// Which end stop.
        stop: usize,
        /// Why that is no subject of the analysis.
        what: &'static str,
    },
    /// An analysis of smooth motions was requested, and dry friction sticks.
    #[error("friction {source_index} holds at rest: {what}")]
    Sticks {
        /// Which: the index of a load.
        source_index: usize,
        /// Why that is no subject of the analysis.
        what: &'static str,
    },
    /// The integrator's steps became too small to continue.
    #[error("the integrator's steps become too small at t = {t:e} s")]
    StepTooSmall {
        /// The time reached, s.
        t: f64,
    },
    /// The integrator's steps are so short, and stay so, that the motion makes no progress.
    #[error("the motion makes no progress at t = {t} s, in steps of {step:.1e} s")]
    NoProgress {
        /// The first load that a program computes, which may jump there: by its index, if there is one.
        function: Option<usize>,
        /// The time reached, s.
        t: f64,
        /// The length of the last steps, s.
        step: f64,
    },
    /// The computed energies do not match the work of the loads: the steps have left the mechanism.
    #[error("near t = {t} s the computed energies stop matching the work of the loads")]
    LostBalance {
        /// The time reached, s.
        t: f64,
    },
    /// The motion is too short: its end equals its start to rounding.
    #[error("the motion is too short to compute: its end equals its start to rounding")]
    DurationTooShort,
    /// The kinetic energy underflows or overflows.
    #[error(
        "the kinetic energy is {energy:e} J at {q_dot:e} rad/s: too small or too large to compute with"
    )]
    EnergyOutOfRange {
        /// The speed at the start, rad/s.
        q_dot: f64,
        /// The energy there, J.
        energy: f64,
    },
    /// The integrator failed for another reason.
    #[error("the integrator stopped at t = {t:e} s: {reason}")]
    Solver {
        /// The time reached, s.
        t: f64,
        /// Its own message.
        reason: String,
    },
    /// A free motion that starts at rest stays at rest.
    #[error("the mechanism starts at rest, and nothing moves it")]
    AtRest,
    /// The range of the coordinate is limited, so that the motion has no period of rotation.
    #[error("the coordinate is limited to the range from {from} to {to} rad")]
    NoFullRevolution {
        /// Lower limit, rad.
        from: f64,
        /// Upper limit, rad.
        to: f64,
    },
    /// The motion does not follow from energy alone: something does work that no potential accounts for, or there is
    /// not one degree of freedom.
    #[error("the motion is not determined by its energy: {what}")]
    NotConservative {
        /// What it is.
        what: &'static str,
    },
    /// The motion has exactly the energy of an unstable equilibrium, which it approaches for ever.
    #[error(
        "the motion approaches the unstable equilibrium at q = {q} asymptotically, with exactly its energy: it has no period"
    )]
    AsymptoticMotion {
        /// The equilibrium, rad or m.
        q: f64,
    },
    /// The motion has neither a turning point nor a period in the part that was followed.
    #[error(
        "the motion continues beyond q = {q} and has neither a turning point nor a period up to there"
    )]
    Undecided {
        /// How far it was followed, rad or m.
        q: f64,
    },
    /// The search found no isolated equilibrium.
    #[error("no equilibrium: {what}")]
    NoEquilibrium {
        /// Why not.
        what: &'static str,
    },
    /// There is no equilibrium: the static force along a coordinate keeps its sign.
    #[error(
        "no equilibrium: the static force along coordinate {actuator} stays between {} and {}",
        force[0], force[1]
    )]
    Unbalanced {
        /// The actuator of the coordinate.
        actuator: usize,
        /// The smallest and the largest force found, N·m or N.
        force: [f64; 2],
    },
    /// There is no steady cycle, or none was found.
    #[error("no steady cycle: {what}")]
    NoCycle {
        /// Why not.
        what: &'static str,
    },
    /// A machine gains energy in a cycle from every speed that was tried, or loses it from every one.
    #[error(
        "no steady cycle: {work} J remain in a cycle at {q_dot} rad/s, and none of the speeds tried, from {} to {} rad/s, \
         balances them",
        tried[0], tried[1]
    )]
    NeverBalances {
        /// The work of all sources in the first cycle, J: positive if the machine gains energy.
        work: f64,
        /// Its speed at the start, rad/s.
        q_dot: f64,
        /// The slowest and the fastest speed tried, rad/s.
        tried: [f64; 2],
    },
    /// The eigenvalues of a linearisation could not be found.
    #[error("the eigenvalues of the linearised motion cannot be found")]
    NoEigenvalues,
    /// A motion that should complete a revolution comes to rest.
    #[error("the mechanism comes to rest at q = {q} rad and does not complete the revolution")]
    ComesToRest {
        /// Where, rad.
        q: f64,
    },
    /// The quadrature over a period does not converge.
    #[error(
        "{points} points do not resolve the motion over a period (left: {tail:.1e} of the period)"
    )]
    NotResolved {
        /// Number of points tried last.
        points: usize,
        /// Relative change of the last doubling.
        tail: f64,
    },
}

/// The error for an invalid option.
pub(crate) fn bad_option<T>(what: &'static str, must: &'static str, value: f64) -> Result<T> {
    Err(DynamicsError::BadOption { what, must, value })
}

/// The inertia `m` (kg m² or kg) at `q`, if it is positive and finite.
pub(crate) fn positive_inertia(m: f64, q: f64) -> Result<f64> {
    if m > 0.0 && m.is_finite() {
        Ok(m)
    } else {
        Err(DynamicsError::NoInertia { q, m })
    }
}
