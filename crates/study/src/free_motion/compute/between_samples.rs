//! A computed motion between its samples: at its steps, and at any time within a step.
//!
//! Within a step the motion is integrated once more from its beginning. A search for extrema asks for many times of the
//! same step, and many columns have one in it: that integration is kept, as polynomials of at most degree 7 through its dense
//! output. An exact state within it is integrated from the last of its own steps.

use crate::free_motion::compute::tables::sliding_at;
use crate::free_motion::compute::{FreeMotionProblem, PlaceInMotion, SegmentedMotion};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{
    DenseOutput, Machine, MachineOde, MachineWorkspace, Method, OdeState, Options, StepControl,
    StepObserver, integrate,
};
use dwell_geometry::body_states::CoordinateFunction;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::{PI, TAU};

/// Highest number of steps that are evaluated like samples.
const MAX_STEPS: usize = 50_000;
/// Points of a polynomial through a dense output.
const NODES: usize = 8;
/// Numbers that the polynomials of all steps may have, 32 MB; then they are forgotten.
const MAX_STORED: usize = 1 << 22;
/// Method, tolerance and highest number of steps from the beginning of a step to a time within it; the second where a
/// stiff motion needs too many of the first.
const METHODS: [(Method, f64, usize); 2] =
    [(Method::Dop853, 1e-12, 200), (Method::Bdf, 1e-10, 20_000)];

impl FreeMotionProblem<'_> {
    /// The motion at its steps; none if there are too many of them.
    pub(crate) fn steps_as_samples(
        &self,
        motion: &SegmentedMotion,
    ) -> Option<Vec<(f64, TrajectorySample)>> {
        if motion.steps().count() > MAX_STEPS {
            return None;
        }
        let coordinates = &motion.actuator_coordinates.steps;
        self.evaluated(motion, |solution| &solution.steps, coordinates)
            .ok()
    }

    /// Whether a time (s) is in a step that begins or ends within the window of a change point's fit.
    pub(crate) fn is_in_fit_window(&self, motion: &SegmentedMotion, t: f64) -> bool {
        let is_fit = |(chart, step): (usize, &OdeState)| {
            self.machine(motion, chart).is_in_fit_window(&step.y)
        };
        let before = motion.steps().filter(|(_, step)| step.t <= t).last();
        let after = motion.steps().find(|(_, step)| step.t >= t);
        before.is_some_and(is_fit) || after.is_some_and(is_fit)
    }

    /// A motion at any of its times.
    pub(crate) fn sampler<'m>(&'m self, motion: &'m SegmentedMotion) -> MotionSampler<'m> {
        MotionSampler {
            problem: self,
            motion,
            machines: BTreeMap::new(),
            interpolated: BTreeMap::new(),
            stored: 0,
        }
    }
}

/// A motion at any of its times, with the working memory to compute it, by chart.
pub(crate) struct MotionSampler<'m> {
    problem: &'m FreeMotionProblem<'m>,
    motion: &'m SegmentedMotion,
    machines: BTreeMap<usize, (MachineOde<'m>, MachineWorkspace)>,
    /// The steps that were interpolated in, by segment and number.
    interpolated: BTreeMap<(usize, usize), Vec<Polynomials>>,
    /// How many numbers their polynomials have.
    stored: usize,
}

impl<'m> MotionSampler<'m> {
    /// The motion at a time (s): from its orbit, or from the step before, which is integrated once more up to there.
    /// None where that is not possible.
    pub(crate) fn sample_at(&mut self, t: f64) -> Option<TrajectorySample> {
        let place = self.motion.place_of(t)?;
        let known = self.interpolated.get(&(place.segment, place.step));
        let parts = known.map_or(&[][..], Vec::as_slice).iter();
        let part = parts.rev().find(|part| part.start.t <= t);
        let nearest = part.map(|part| part.start.clone());
        let before = nearest.as_ref().unwrap_or(&place.steps()[place.step]);
        let point = match (before.t == t, &self.motion.orbit) {
            (true, _) => before.clone(),
            (false, Some(orbit)) => OdeState::from(orbit.state_at(t)),
            (false, None) => {
                let ode = &mut self.machine_of(&place)?.0;
                let mut observer =
                    |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
                let mut by_each = METHODS.iter();
                by_each.find_map(|options| state_after(ode, before, t, options, &mut observer))?
            }
        };
        self.sample_of(&place, &point)
    }

    /// The same but for the error of interpolation, at a fraction of the cost where many times are in one step.
    pub(crate) fn interpolated_at(&mut self, t: f64) -> Option<TrajectorySample> {
        let place = self.motion.place_of(t)?;
        let (before, after) = (
            &place.steps()[place.step],
            place.steps().get(place.step + 1),
        );
        let Some(after) = after.filter(|_| before.t < t && self.motion.orbit.is_none()) else {
            return self.sample_at(t);
        };
        let key = (place.segment, place.step);
        if !self.interpolated.contains_key(&key) {
            let ode = &mut self.machine_of(&place)?.0;
            let mut by_each = METHODS.iter();
            let polynomials =
                by_each.find_map(|options| polynomials_of(ode, before, after.t, options))?;
            if self.stored > MAX_STORED {
                self.interpolated.clear();
                self.stored = 0;
            }
            self.stored += polynomials.len() * (NODES + 1) * before.y.len();
            self.interpolated.insert(key, polynomials);
        }
        let polynomials = self.interpolated.get(&key)?;
        let polynomials = polynomials.iter().find(|part| t <= part.end)?;
        let y = polynomials.at(t);
        self.sample_of(&place, &OdeState { t, y })
    }

    /// The equation of motion and the working memory at a place.
    fn machine_of(
        &mut self,
        place: &PlaceInMotion<'m>,
    ) -> Option<&mut (MachineOde<'m>, MachineWorkspace)> {
        Some(match self.machines.entry(place.chart) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let machine: &Machine = self.problem.machine(self.motion, place.chart);
                let before = &place.steps()[place.step];
                // At rest the energies show nothing of the works that come: steps would follow their rounding.
                let end = Some(self.motion.end_time());
                let ode = MachineOde::until(machine, before.t, &before.y, end).ok()?;
                new.insert((ode, machine.workspace()))
            }
        })
    }

    /// What is evaluated at a state within a step.
    fn sample_of(
        &mut self,
        place: &PlaceInMotion<'m>,
        point: &OdeState,
    ) -> Option<TrajectorySample> {
        let (problem, motion) = (self.problem, self.motion);
        let machine = problem.machine(motion, place.chart);
        if machine.is_in_fit_window(&point.y) {
            return None;
        }
        let sliding = sliding_at(place.solution, point.t);
        let workspace = &mut self.machine_of(place)?.1;
        let mut sample = problem
            .sample((place.chart, machine, &mut *workspace), point, sliding)
            .ok()?;
        if let Some(steps) = motion.actuator_coordinates.steps.get(place.segment) {
            let mechanism = &problem.loaded_scene.mechanism;
            let measured =
                CoordinateFunction::find(mechanism, mechanism.actuators[0].coordinate())?;
            let mut state = machine.evaluate(point.t, &point.y, workspace).ok()?;
            let mut now = state.bodies().coordinate(measured);
            if let CoordinateFunction::Angle(_) = measured {
                let [q, q_dot, _] = *steps.get(place.step)?;
                let before = &place.steps()[place.step];
                let near = q + 0.5 * (q_dot + now[1]) * (point.t - before.t);
                now[0] += TAU * ((near - now[0]) / TAU).round();
            }
            sample.actuator_coordinate = Some(now);
        }
        Some(sample)
    }
}

/// The state at a time (s), integrated from an earlier state.
fn state_after(
    ode: &mut MachineOde<'_>,
    before: &OdeState,
    t: f64,
    &(method, tolerance, max_steps): &(Method, f64, usize),
    observer: StepObserver<'_>,
) -> Option<OdeState> {
    // Within a step nothing switches, and nothing varies faster than it: it need not be searched again, which would take
    // most of the time.
    let options = Options {
        max_steps,
        max_step: Some(t - before.t),
        ..Options::new(method, tolerance)
    };
    let part = integrate(ode, before, Some(t), &options, observer).ok()?;
    part.error.is_none().then_some(part.state)
}

/// A motion within a part of a step: a polynomial of each state through values at Chebyshev points.
struct Polynomials {
    /// The state at its beginning, and its end, s.
    start: OdeState,
    end: f64,
    /// The points, s, each with the states there.
    nodes: Vec<(f64, Vec<f64>)>,
}

/// The motion from a state until a time (s), integrated once more.
fn polynomials_of(
    ode: &mut MachineOde<'_>,
    before: &OdeState,
    end: f64,
    options: &(Method, f64, usize),
) -> Option<Vec<Polynomials>> {
    let mut parts = Vec::new();
    let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        let mut node = |k: usize| {
            let angle = PI * (k as f64 + 0.5) / NODES as f64;
            let t = 0.5 * (before.t + now.t) - 0.5 * (now.t - before.t) * angle.cos();
            let mut y = now.y.clone();
            dense(t, &mut y).map(|()| (t, y))
        };
        parts.push(Polynomials {
            start: before.clone(),
            end: now.t,
            nodes: (0..NODES).map(&mut node).collect::<Result<_, _>>()?,
        });
        Ok(StepControl::Continue)
    };
    state_after(ode, before, end, options, &mut observer)?;
    Some(parts)
}

impl Polynomials {
    /// The states at a time (s), by the barycentric formula at Chebyshev points of the first kind.
    fn at(&self, t: f64) -> Vec<f64> {
        let weight = |k: usize| {
            let angle = PI * (k as f64 + 0.5) / NODES as f64;
            if k.is_multiple_of(2) {
                angle.sin()
            } else {
                -angle.sin()
            }
        };
        if let Some((_, y)) = self.nodes.iter().find(|(node, _)| *node == t) {
            return y.clone();
        }
        let weights = self.nodes.iter().enumerate();
        let weights: Vec<f64> = weights
            .map(|(k, (node, _))| weight(k) / (t - node))
            .collect();
        let sum: f64 = weights.iter().sum();
        let state = |i: usize| {
            let terms = weights.iter().zip(&self.nodes).map(|(w, (_, y))| w * y[i]);
            terms.sum::<f64>() / sum
        };
        let states = self.nodes.first().map_or(0, |(_, y)| y.len());
        (0..states).map(state).collect()
    }
}
