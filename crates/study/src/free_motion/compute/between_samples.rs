//! A computed motion between its samples: at its steps, and at any time within a step.

use crate::free_motion::compute::{
    ChartedProblem, Instant, ModelOf, MotionOf, MotionSolver, PlaceInMotion, StatesWithinSteps,
    exact_state, sample_of,
};
use crate::machines::MachineScene as _;
use crate::trajectory::compute::{SamplePrecision, TrajectorySample};
use dwell_dynamics::{EventSide, MachineOde, MachineWorkspace, Method, OdeState};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

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
pub(crate) struct MotionSampler<'m, P: ChartedProblem> {
    problem: &'m P,
    motion: &'m MotionOf<P>,
    machines: BTreeMap<usize, Evaluated<'m, ModelOf<P::Scene>>>,
    /// By segment and number of the step.
    within_steps: StatesWithinSteps<(usize, usize)>,
}

/// The equation of motion of a machine and its working memory.
type Evaluated<'m, M> = (MachineOde<'m, M>, MachineWorkspace<f64, M>);

impl<'m, P: ChartedProblem> MotionSampler<'m, P> {
    pub(crate) fn new(problem: &'m P, motion: &'m MotionOf<P>) -> Self {
        Self {
            problem,
            motion,
            machines: BTreeMap::new(),
            within_steps: StatesWithinSteps::default(),
        }
    }

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
    ) -> Option<&mut Evaluated<'m, ModelOf<P::Scene>>> {
        Some(match self.machines.entry(place.chart) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let machine = self.problem.machine_in(self.motion, place.chart);
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
        let of = (machine, problem.scene().drives());
        let workspace = &mut self.machine_of(place)?.1;
        let mut sample = sample_of(of, point, along, workspace).ok()?;
        sample.chart = place.chart;
        let within = Instant::Within(place.segment, place.step, point);
        sample.actuator_coordinate = problem.own_coordinate(motion, &within, &sample);
        Some(sample)
    }
}
