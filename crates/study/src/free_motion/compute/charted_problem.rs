//! A motion that may go on in other coordinates than the scene's, in charts: its states as samples.

use crate::free_motion::compute::between_samples::Thinning;
use crate::free_motion::compute::{
    MAX_STEPS, MotionProblem, SegmentedMotion, sample_of, sides_of_step, since_start,
};
use crate::machines::MachineScene;
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{DynamicsError, EventSide, Machine, OdeState, Solution};

/// Which states of a segment are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Picked {
    Steps,
    Samples,
}

impl Picked {
    fn of(self, solution: &Solution) -> &[OdeState] {
        match self {
            Self::Steps => &solution.steps,
            Self::Samples => &solution.samples,
        }
    }
}

/// The times (s) under which a picked state of a solution is kept, each with the side of an event that it is evaluated on.
type WantedTimes<'a> = dyn FnMut(&Solution, usize) -> Vec<(f64, EventSide)> + 'a;

/// An initial value problem whose motion may go on in charts.
pub(crate) trait ChartedProblem: MotionProblem {
    /// A chart.
    type Chart;

    /// The machine of a chart.
    fn machine_in<'m>(
        &'m self,
        motion: &'m SegmentedMotion<Self::Chart>,
        chart: usize,
    ) -> &'m Machine<<Self::Scene as MachineScene>::Model>;

    /// In a chart of another coordinate, that of the scene with its rate and acceleration: by segment, at the `k`th picked state, which is
    /// `sample`.
    fn own_coordinate(
        &self,
        motion: &SegmentedMotion<Self::Chart>,
        at: (usize, Picked, usize),
        sample: &TrajectorySample,
    ) -> Option<[f64; 3]>;

    /// A motion's picked states on the sides of events that are wanted, each under a time (s), evaluated: without those within the window of a
    /// change point's fit.
    fn evaluated(
        &self,
        motion: &SegmentedMotion<Self::Chart>,
        picked: Picked,
        wanted: &mut WantedTimes<'_>,
    ) -> Result<Vec<(f64, TrajectorySample)>, DynamicsError> {
        let mut all = Vec::new();
        for (segment, (chart, solution)) in motion.segments.iter().enumerate() {
            let machine = self.machine_in(motion, *chart);
            let mut workspace = machine.workspace();
            let states = picked.of(solution).iter().enumerate();
            for (k, point) in states.filter(|(_, s)| !machine.is_in_fit_window(&s.y)) {
                for (t, side) in wanted(solution, k) {
                    let (of, along) = ((machine, self.scene().drives()), (&solution.modes, side));
                    let mut sample = sample_of(of, point, along, &mut workspace)?;
                    sample.chart = *chart;
                    let at = (segment, picked, k);
                    sample.actuator_coordinate = self.own_coordinate(motion, at, &sample);
                    all.push((t, sample));
                }
            }
        }
        Ok(all)
    }

    /// Every sample with its accelerations, drive magnitudes and energies. Within the window of a change
    /// point's fit there are no reactions, and no row.
    fn samples(
        &self,
        motion: &SegmentedMotion<Self::Chart>,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let mut after =
            |solution: &Solution, k: usize| vec![(solution.samples[k].t, EventSide::After)];
        let all = self.evaluated(motion, Picked::Samples, &mut after)?;
        let samples: Vec<_> = all.into_iter().map(|(_, sample)| sample).collect();
        let index = self.balance_index();
        let initial = samples.first().map_or(0.0, |s| s.extra_values[index]);
        Ok(since_start(samples, index, initial))
    }

    /// The motion at its steps, of which so many may be left out between two; none if there are too many of them.
    fn steps_as_samples(
        &self,
        motion: &SegmentedMotion<Self::Chart>,
        max_skipped: usize,
    ) -> Option<Vec<(f64, TrajectorySample)>> {
        if motion.steps().count() > MAX_STEPS {
            return None;
        }
        let mut thinning = Thinning::new(max_skipped);
        let mut wanted = |solution: &Solution, k: usize| {
            let is_kept = thinning.keeps(&solution.steps, k);
            let sides = sides_of_step(solution, k);
            match is_kept || sides.len() > 1 {
                true => sides,
                false => Vec::new(),
            }
        };
        self.evaluated(motion, Picked::Steps, &mut wanted).ok()
    }

    /// Whether a time (s) is in a step that begins or ends within the window of a change point's fit.
    fn is_in_fit_window(&self, motion: &SegmentedMotion<Self::Chart>, t: f64) -> bool {
        let is_fit = |(chart, step): (usize, &OdeState)| {
            self.machine_in(motion, chart).is_in_fit_window(&step.y)
        };
        let before = motion.steps().filter(|(_, step)| step.t <= t).last();
        let after = motion.steps().find(|(_, step)| step.t >= t);
        before.is_some_and(is_fit) || after.is_some_and(is_fit)
    }
}
