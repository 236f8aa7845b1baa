//! A computed motion between its samples: at its steps, and at any time within a step.

use crate::free_motion::compute::{
    ChartedProblem as _, FreeMotionProblem, MotionSolver, PlaceInMotion, SegmentedMotion,
    StatesWithinSteps, exact_state,
};
use crate::trajectory::compute::{SamplePrecision, TrajectorySample};
use dwell_dynamics::{EventSide, Machine, MachineOde, MachineWorkspace, Method, OdeState};
use dwell_geometry::body_states::CoordinateFunction;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::TAU;
impl FreeMotionProblem<'_> {
    /// A motion at any of its times.
    pub(crate) fn sampler<'m>(&'m self, motion: &'m SegmentedMotion) -> MotionSampler<'m> {
        MotionSampler {
            problem: self,
            motion,
            machines: BTreeMap::new(),
            within_steps: StatesWithinSteps::default(),
        }
    }
}

/// Steps are thinned as if this had been the tolerance: their accuracy is finer than what the search for extrema needs.
const SEARCH_TOLERANCE: f64 = 1e-6;
/// Most steps of which one is kept.
const MAX_THINNING: f64 = 3.0;
/// Steps whose lengths differ by more than this factor are kept: something begins or ends there.
const ALIKE: f64 = 2.0;

/// How many steps may be left out between two that are kept, in the search for extrema between rows. What is interpolated over n
/// steps of a method of order p has n^(p+1) times the error of a step. Steps of DOP853 are long.
pub(super) fn max_skipped(solver: &MotionSolver) -> usize {
    let MotionSolver::Settings(settings) = solver else {
        return 0;
    };
    let order = match settings.method {
        Method::Bdf | Method::Tsit45 => 5,
        Method::Esdirk34 => 3,
        Method::TrBdf2 => 2,
        Method::Dop853 => return 0,
    };
    let steps = (SEARCH_TOLERANCE / settings.rtol).powf(1.0 / f64::from(order + 1));
    steps.clamp(1.0, MAX_THINNING) as usize - 1
}

/// Steps of which at most so many are left out between two, where their lengths are alike.
pub(super) struct Thinning {
    max_skipped: usize,
    /// Those that have been left out since the last one.
    skipped: usize,
}

impl Thinning {
    pub(super) fn new(max_skipped: usize) -> Self {
        let skipped = 0;
        Self {
            max_skipped,
            skipped,
        }
    }

    /// Whether the `k`th step is kept, after those before it.
    pub(super) fn keeps(&mut self, steps: &[OdeState], k: usize) -> bool {
        let around = k.checked_sub(1).and_then(|before| steps.get(before..k + 2));
        let is_alike = around.is_some_and(|around| {
            let [before, after] = [around[1].t - around[0].t, around[2].t - around[1].t];
            before < ALIKE * after && after < ALIKE * before
        });
        self.skipped = match is_alike && self.skipped < self.max_skipped {
            true => self.skipped + 1,
            false => 0,
        };
        self.skipped == 0
    }
}

/// A motion at any of its times, with the working memory to compute it, by chart.
pub(crate) struct MotionSampler<'m> {
    problem: &'m FreeMotionProblem<'m>,
    motion: &'m SegmentedMotion,
    machines: BTreeMap<usize, (MachineOde<'m>, MachineWorkspace)>,
    /// By segment and number of the step.
    within_steps: StatesWithinSteps<(usize, usize)>,
}

impl<'m> MotionSampler<'m> {
    /// The motion at a time (s): from its orbit, or from the step before, which is integrated once more up to there; or by interpolation
    /// within the step, at a fraction of the cost where many times are in one step. None where that is not possible.
    pub(crate) fn sample_at(
        &mut self,
        t: f64,
        precision: SamplePrecision,
    ) -> Option<TrajectorySample> {
        let place = self.motion.place_of(t)?;
        let (key, steps) = ((place.segment, place.step), place.steps());
        let (modes, next) = (&place.solution.modes, steps.get(place.step + 1));
        let begin = &*modes.state_at(&steps[place.step], EventSide::After);
        let point = match (precision, next, &self.motion.orbit) {
            (SamplePrecision::Interpolated, Some(next), None) if begin.t < t => {
                let mut states = std::mem::take(&mut self.within_steps);
                let ode = &mut self.machine_of(&place)?.0;
                let point = states.interpolated(ode, key, [begin, next], t);
                self.within_steps = states;
                point?
            }
            (_, _, orbit) => {
                let resolved = self.within_steps.resolved(&key, t);
                let before = self.within_steps.before(&key, t);
                let before = before.unwrap_or_else(|| begin.clone());
                match (resolved, orbit) {
                    (Some(resolved), None) => resolved,
                    _ if before.t == t => before,
                    (_, Some(orbit)) => OdeState::from(orbit.state_at(t)),
                    (None, None) => exact_state(&mut self.machine_of(&place)?.0, &before, t)?,
                }
            }
        };
        self.sample_of(&place, &point)
    }

    /// The equation of motion and the working memory at a place.
    fn machine_of(
        &mut self,
        place: &PlaceInMotion<'m>,
    ) -> Option<&mut (MachineOde<'m>, MachineWorkspace)> {
        Some(match self.machines.entry(place.chart) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let machine: &Machine = self.problem.machine_in(self.motion, place.chart);
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
        let machine = problem.machine_in(motion, place.chart);
        if machine.is_in_fit_window(&point.y) {
            return None;
        }
        let along = (&place.solution.modes, EventSide::After);
        let workspace = &mut self.machine_of(place)?.1;
        let mut sample = problem
            .sample((place.chart, machine, &mut *workspace), point, along)
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
