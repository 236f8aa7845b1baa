//! Change points crossed on one assembly branch, such as a parallelogram passing its flat position.
//!
//! Evaluated dyad by dyad, ½m′/m has an error of N·eps/|sin θ|³ there (N dyads, θ from the flat position), though the
//! branch itself is smooth. So poses from both sides of a window, where that exceeds the tolerance, are fitted by
//! polynomials orthogonal on their nodes, and within the window
//!
//! ```text
//! m = Σ m v² + I ω²,  ½m′ = Σ m v·a + I ω α,  Q = Σ F·v     at q̇ = 1, q̈ = 0             (1)
//! ```
//!
//! There is no multiplier in (1). Reactions that the flat position determines are fitted across it too,
//! at the state's own speed and acceleration; of the others, which grow beyond all bounds, there is none.

use dwell_geometry::body_states::BodyStates;
use dwell_geometry::mobility::mobility_at;
use dwell_geometry::{Mechanism, Motion, Plan, Pose, PositionError, Reaction};
use dwell_kinetostatics::Model;
use dwell_numerics::Scalar;
use dwell_numerics::polynomial_fit::{PolynomialFit, chebyshev_nodes};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Nodes of a fit on each side of the window, and its highest degree.
const NODES: usize = 24;
const MAX_DEGREE: usize = 20;
/// Degree of the fit from one side that is extrapolated to the other: it must only distinguish the branches.
const EXTRAPOLATION_DEGREE: usize = 5;
/// Half the widest window, rad, and the tightest tolerance that one is made for.
const MAX_HALF_WIDTH: f64 = 0.2;
const MIN_TOLERANCE: f64 = 1e-12;
/// A looser tolerance does not make the window smaller.
const MAX_TOLERANCE: f64 = 1e-9;
/// How far from the change point poses are fitted, rad, or parts of the size: the farthest of the good ones is taken.
const FIT_RADII: [f64; 5] = [0.15, 0.3, 0.5, 0.8, 1.2];
/// Largest gap between a fit and the plan at the window's ends, in first and second derivatives.
const MAX_GAP: f64 = 1e-6;
/// A gap below this is as good as any.
const GAP_ROUNDING: f64 = 1e-11;

/// A result that fails with a [`ChangePointFitError`] unless another error is named.
pub(crate) type Result<T, E = ChangePointFitError> = std::result::Result<T, E>;

/// Why a change point cannot be crossed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChangePointFitError {
    /// Friction depends on reactions that grow beyond all bounds there.
    #[error("friction depends on reactions that are not determined at the change point")]
    Friction,
    /// The mechanism has couplings, which count whole revolutions.
    #[error("a motion with gears or couplings cannot pass a change point")]
    Couplings,
    /// The branches come close there, but do not meet.
    #[error(
        "the assembly branches come within {half_width:.1e} of each other there without meeting"
    )]
    Separate {
        /// The part of the coordinate, rad or m.
        half_width: f64,
    },
    /// There is no pose next to it.
    #[error(transparent)]
    Position(#[from] PositionError),
    /// The branch cannot be assembled on the other side.
    #[error("the branch cannot be assembled on the other side of the change point")]
    NoContinuation,
    /// The branch is not smooth.
    #[error("the branch is not smooth there: its fit is {gap:.1e} off the plan")]
    NotSmooth {
        /// Largest gap in the derivatives of the angles.
        gap: f64,
    },
}

/// The fit across one change point.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangePointFit {
    /// The change point, rad or m.
    pub center: f64,
    /// Half the window in which the fit replaces the plan, rad or m.
    pub half_width: f64,
    /// How far the fit is good to either side, rad or m.
    pub fit_radius: f64,
    /// How far it is off the plan at the window's ends, in the first two derivatives of the angles (and
    /// travels over the mechanism's size) by the coordinate.
    pub gap: f64,
    /// Degrees of freedom at the change point; elsewhere there is one.
    pub mobility: usize,
    /// The reactions that the loads do not determine there.
    pub indeterminate: Vec<Reaction>,
    /// The models of the branches below and above in the coordinate, with all requested reactions.
    pub(crate) branches: [Model; 2],
    pub(crate) polynomials: PolynomialFit,
}

/// The part of the coordinate on which a machine uses a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitWindow {
    pub(crate) fit: Arc<ChangePointFit>,
    /// Index of its crossing, and whether the machine is that of the branch above.
    pub(crate) crossing: usize,
    pub(crate) above: bool,
    /// Bounds of the window, as distances from the change point, rad or m.
    pub(crate) bounds: [f64; 2],
    /// The period after which the branches below and above repeat, rad.
    pub(crate) period: Option<f64>,
}

impl FitWindow {
    /// The distance of a coordinate from the change point, if it is within the window.
    pub fn offset_within(&self, q: f64) -> Option<f64> {
        let x = q - self.fit.center;
        let periods = |period: f64| period * (x / period).round();
        let x = x - self.period.map_or(0.0, periods);
        (self.bounds[0]..=self.bounds[1]).contains(&x).then_some(x)
    }

    /// Whether a step from one coordinate to another passes the change point, or begins or ends within the window.
    pub(crate) fn is_reached(&self, ends: [f64; 2]) -> bool {
        let passed = |q: f64| {
            let x = q - self.fit.center;
            self.period
                .map_or(x.signum(), |period| (x / period).floor())
        };
        passed(ends[0]) != passed(ends[1]) || ends.iter().any(|q| self.offset_within(*q).is_some())
    }

    /// Whether a coordinate is so far beyond the window that the motion continues on the machine of the branch there.
    pub(crate) fn has_passed(&self, q: f64) -> bool {
        let direction = if self.above { -1.0 } else { 1.0 };
        let offset = self.offset_within(q);
        offset.is_some_and(|x| direction * x > self.fit.half_width)
    }
}

/// The farthest of the good fits about half a window, in the `unit` of the coordinate, where so much is free: its gap, how far it is
/// good to either side, and the fit that is made with such a radius.
pub(crate) fn farthest_good_fit<F>(
    [half_width, unit]: [f64; 2],
    free: f64,
    mut fit_within: impl FnMut(f64) -> Result<(f64, F)>,
) -> Result<(f64, f64, F)> {
    let mut fits = Vec::with_capacity(FIT_RADII.len());
    for radius in FIT_RADII {
        let radius = (radius * unit).max(1.5 * half_width).min(free);
        let (gap, fit) = fit_within(radius)?;
        fits.push((gap, radius, fit));
    }
    let least = fits.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
    // A large radius catches steps that lead over the window.
    let good = |gap: f64| gap <= (10.0 * least).max(GAP_ROUNDING) && gap <= MAX_GAP;
    let best = fits.into_iter().rev().find(|f| good(f.0));
    best.ok_or(ChangePointFitError::NotSmooth { gap: least })
}

/// Half the window for a tolerance, rad: where N·eps/|sin θ|³ exceeds it.
pub(crate) fn half_width_for(plan: &Plan, tolerance: f64) -> f64 {
    half_width_of_groups(plan.group_methods().len(), tolerance)
}

/// The half-width for a number of groups.
pub(crate) fn half_width_of_groups(groups: usize, tolerance: f64) -> f64 {
    let groups = groups as f64;
    let tolerance = tolerance.clamp(MIN_TOLERANCE, MAX_TOLERANCE);
    (groups * f64::EPSILON / tolerance)
        .cbrt()
        .min(MAX_HALF_WIDTH)
}

/// Angles of the frames, each next to the one before, and travels of the slides.
fn sample_pose(
    plan: &Plan,
    q: f64,
    pose: &mut Pose<f64>,
    last: Option<&Vec<f64>>,
) -> Result<Vec<f64>, PositionError> {
    plan.positions(&[q], pose)?;
    let angle = |(f, rotation): (usize, &dwell_geometry::Vec2)| {
        let angle = rotation.angle();
        let near = last.map_or(angle, |last| last[f]);
        angle + TAU * ((near - angle) / TAU).round()
    };
    let mut found: Vec<f64> = pose.rotation.iter().enumerate().map(angle).collect();
    found.extend_from_slice(&pose.slide_travel);
    Ok(found)
}

/// The angles of all bodies at a distance `x` beyond a change point at `center`, from the poses between
/// the distances `from` and `to` before it; `upwards` if it lies above them.
pub(crate) fn extrapolate(
    model: &Model,
    center: f64,
    upwards: bool,
    [from, to]: [f64; 2],
    x: f64,
) -> Result<Vec<f64>> {
    let plan = model.plan();
    let direction = if upwards { 1.0 } else { -1.0 };
    let mut pose = plan.pose();
    let nodes: Vec<f64> = chebyshev_nodes(from, to, NODES)
        .map(|d| -direction * d)
        .collect();
    let mut samples: Vec<Vec<f64>> = Vec::new();
    for &node in &nodes {
        samples.push(sample_pose(plan, center + node, &mut pose, samples.last())?);
    }
    let fit = PolynomialFit::new(&nodes, &samples, to, EXTRAPOLATION_DEGREE);
    let mut values = fit.workspace();
    fit.eval(direction * x, &mut Vec::new(), &mut values);
    let mut workspace = FitWorkspace::new(model);
    workspace.values = values;
    workspace.set_pose(plan, &[center + direction * x], &mut pose);
    workspace
        .unit_states
        .fill(plan, &pose, &workspace.unit_motion);
    let bodies = (0..workspace.unit_states.len()).map(dwell_geometry::BodyId);
    Ok(bodies
        .map(|b| workspace.unit_states.body(b).rotation.angle())
        .collect())
}

impl ChangePointFit {
    /// The fit between the branch below and the one above a change point, with half its window;
    /// `coordinate_scale` is 1 for an angle and the mechanism's size for a length.
    ///
    /// # Errors
    /// [`ChangePointFitError`] where the branch is not smooth enough.
    pub(crate) fn new(
        mechanism: &Mechanism,
        branches: [&Model; 2],
        center: f64,
        [half_width, coordinate_scale]: [f64; 2],
    ) -> Result<Self> {
        let available_radius = |model: &Model| match model.plan().range().limits() {
            Some((from, to)) => 0.45 * (to - from),
            None => f64::INFINITY,
        };
        let max_radius = available_radius(branches[0]).min(available_radius(branches[1]));
        let scales = [half_width, coordinate_scale];
        let (gap, fit_radius, polynomials) = farthest_good_fit(scales, max_radius, |radius| {
            let fit = Self::polynomials(branches, center, half_width, radius)?;
            Ok((derivative_gap(&fit, branches, center, scales)?, fit))
        })?;
        let mut built = Self {
            center,
            half_width,
            fit_radius,
            gap,
            mobility: 1,
            indeterminate: Vec::new(),
            branches: branches.map(Clone::clone),
            polynomials,
        };
        built.analyse_center(mechanism);
        Ok(built)
    }

    fn polynomials(
        branches: [&Model; 2],
        center: f64,
        half_width: f64,
        fit_radius: f64,
    ) -> Result<PolynomialFit> {
        let above: Vec<f64> = chebyshev_nodes(half_width, fit_radius, NODES).collect();
        let below: Vec<f64> = above.iter().rev().map(|d| -d).collect();
        let mut samples: Vec<Vec<f64>> = Vec::with_capacity(2 * NODES);
        for (model, nodes) in branches.iter().zip([&below, &above]) {
            let mut pose = model.plan().pose();
            for &node in nodes {
                let found = sample_pose(model.plan(), center + node, &mut pose, samples.last())?;
                samples.push(found);
            }
        }
        let nodes = [below, above].concat();
        Ok(PolynomialFit::new(&nodes, &samples, fit_radius, MAX_DEGREE))
    }

    /// Finds the motions at the change point, and the reactions that are determined there.
    fn analyse_center(&mut self, mechanism: &Mechanism) {
        let plan = self.branches[0].plan();
        let mut workspace = FitWorkspace::new(&self.branches[0]);
        let mut pose = plan.pose();
        let polynomials = &self.polynomials;
        polynomials.eval(0.0, &mut workspace.basis_values, &mut workspace.values);
        workspace.set_pose(plan, &[self.center], &mut pose);
        let states = &mut workspace.unit_states;
        states.fill(plan, &pose, &workspace.unit_motion);
        if let Some(here) = mobility_at(mechanism, states) {
            self.mobility = here.degrees_of_freedom();
            let all = mechanism.reactions().into_iter().zip(&here.determinate);
            let indeterminate = all.filter(|(_, determinate)| !**determinate);
            self.indeterminate = indeterminate.map(|(r, _)| r).collect();
        }
    }
}

/// The largest gap between a fit and the plans at the window's ends, in first and second derivatives.
fn derivative_gap(
    fit: &PolynomialFit,
    branches: [&Model; 2],
    center: f64,
    [half_width, coordinate_scale]: [f64; 2],
) -> Result<f64> {
    let mut values = fit.workspace();
    let mut largest = 0.0_f64;
    for (model, direction) in branches.iter().zip([-1.0, 1.0]) {
        let plan = model.plan();
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        plan.positions(&[center + direction * half_width], &mut pose)?;
        plan.velocities(&pose, &[1.0], &mut motion);
        plan.accelerations(&pose, &[0.0], &mut motion);
        fit.eval(direction * half_width, &mut Vec::new(), &mut values);
        let scaled = |rates, factor: f64| (rates, [factor, coordinate_scale]);
        let (velocity, acceleration) = (&motion.velocity, &motion.acceleration);
        let frames = velocity.angular.iter().zip(&acceleration.angular);
        let slides = velocity.slide.iter().zip(&acceleration.slide);
        let frames = frames.map(|rates| scaled(rates, coordinate_scale));
        let rates = frames.chain(slides.map(|rates| scaled(rates, 1.0)));
        for ([_, first, second], ((velocity, acceleration), [one, two])) in values.iter().zip(rates)
        {
            let differences = [
                (first - velocity) * one,
                (second - acceleration) * one * two,
            ];
            largest = differences.iter().fold(largest, |max, d| max.max(d.abs()));
        }
    }
    Ok(largest)
}

/// Working memory for the evaluation of a fit.
#[derive(Debug, Clone)]
pub(crate) struct FitWorkspace<T> {
    pub(crate) basis_values: Vec<[T; 3]>,
    /// By frame and then by slide: value and derivatives by the coordinate.
    pub(crate) values: Vec<[T; 3]>,
    angles: Vec<T>,
    slides: Vec<T>,
    /// The motion at unit speed, and the bodies in it.
    pub(crate) unit_motion: Motion<T>,
    pub(crate) unit_states: BodyStates<T>,
}

impl<T: Scalar> FitWorkspace<T> {
    pub(crate) fn new(model: &Model) -> Self {
        let plan = model.plan();
        let unit_motion = plan.motion();
        let frames = unit_motion.velocity.angular.len();
        let slides = unit_motion.velocity.slide.len();
        Self {
            basis_values: Vec::with_capacity(MAX_DEGREE + 1),
            values: vec![[T::from_f64(0.0); 3]; frames + slides],
            angles: vec![T::from_f64(0.0); frames],
            slides: vec![T::from_f64(0.0); slides],
            unit_motion,
            unit_states: BodyStates::new(plan),
        }
    }

    /// Sets a pose to the values.
    pub(crate) fn set_pose(&mut self, plan: &Plan, q: &[T], pose: &mut Pose<T>) {
        let places = self.angles.iter_mut().chain(&mut self.slides);
        for (place, value) in places.zip(&self.values) {
            *place = value[0];
        }
        plan.set_coordinates(q, &self.angles, &self.slides, pose);
    }
}

/// Sets a motion to some derivatives by the coordinate at its speed and acceleration.
pub(crate) fn set_motion<T: Scalar>(
    values: &[[T; 3]],
    [q_dot, q_ddot]: [T; 2],
    motion: &mut Motion<T>,
) {
    let velocities = motion.velocity.angular.iter_mut();
    let velocities = velocities.chain(&mut motion.velocity.slide);
    let rates = motion.acceleration.angular.iter_mut();
    let rates = velocities.zip(rates.chain(&mut motion.acceleration.slide));
    for ((velocity, acceleration), [_, first, second]) in rates.zip(values) {
        *velocity = *first * q_dot;
        *acceleration = *first * q_ddot + *second * q_dot * q_dot;
    }
}
