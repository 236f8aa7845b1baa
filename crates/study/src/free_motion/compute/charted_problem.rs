//! A motion that may go on in other coordinates than the scene's, in charts: its states as samples.

use crate::explain::StudyError;
use crate::free_motion::compute::between_samples::Thinning;
use crate::free_motion::compute::events::NumberedEvent;
use crate::free_motion::compute::{
    MAX_STEPS, ModelOf, MotionProblem, SegmentedMotion, sample_of, sides_of_step, since_start,
};
use crate::machines::MachineScene as _;
use crate::trajectory::compute::{RowScene, RowSource, TrajectorySample};
use dwell_dynamics::{
    DynamicsError, Event, EventSide, Machine, OdeState, Options, Orbit, Solution,
};
use dwell_kinetostatics::MachineModel;

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

/// Where in a motion a state is.
pub(crate) enum Instant<'m> {
    /// By segment, the so many picked one.
    Picked(usize, Picked, usize),
    /// Within a step: its segment, its number there, and the state.
    Within(usize, usize, &'m OdeState),
}

/// The times (s) under which a picked state of a solution is kept, each with the side of an event that it is evaluated on.
type WantedTimes<'a> = dyn FnMut(&Solution, usize) -> Vec<(f64, EventSide)> + 'a;

/// How an event of a scene knows a coordinate.
type EventCoordinate<P> =
    <ModelOf<<P as MotionProblem>::Scene> as MachineModel>::CoordinateFunction;

/// What the rows of a problem's scene are evaluated of.
type RowsOf<P> = <<P as MotionProblem>::Scene as RowScene>::Rows;

/// A motion of a problem.
pub(crate) type MotionOf<P> = SegmentedMotion<<P as ChartedProblem>::Chart>;

/// An initial value problem whose motion may go on in charts.
pub(crate) trait ChartedProblem: MotionProblem<Scene: RowScene> + Sync {
    /// A chart.
    type Chart: Send + Sync;

    /// The motion over a duration, s.
    ///
    /// # Errors
    /// [`StudyError`] where not even its start can be evaluated.
    fn by_method(&self, duration: f64, options: &Options) -> Result<MotionOf<Self>, StudyError>;

    /// The interval of the only coordinate that a coarse run visits, where a table of the machine may serve.
    fn range_for_table(&self, _coarse: &MotionOf<Self>) -> Option<[f64; 2]> {
        None
    }

    /// The motion on a table of this interval whose accuracy follows the tolerance. `None` if there is no such table, or the motion
    /// leaves it.
    ///
    /// # Errors
    /// As of [`by_method`](Self::by_method).
    fn on_table(
        &self,
        _visited: [f64; 2],
        _duration: f64,
        _options: &Options,
    ) -> Result<Option<MotionOf<Self>>, StudyError> {
        Ok(None)
    }

    /// Whether an orbit passes a place where another assembly branch is so close that rounding does not show which of the two it follows.
    fn passes_close_branches(&self, _: &Orbit) -> bool {
        false
    }

    /// The scene's events, in their order, and the model whose reactions they are about.
    fn events(&self) -> (Vec<Event<EventCoordinate<Self>>>, &ModelOf<Self::Scene>);

    /// What rows are evaluated of.
    fn rows(&self) -> &RowsOf<Self>;

    /// The same by chart of a motion, with the scene there; empty where the scene's own coordinates are used throughout.
    fn charts<'p>(&'p self, motion: &'p MotionOf<Self>)
    -> Vec<(&'p Self::Scene, &'p RowsOf<Self>)>;

    /// How many reactions of the rows' model are results.
    fn result_reactions(&self) -> usize;

    /// The machine of a chart.
    fn machine_in<'m>(
        &'m self,
        motion: &'m MotionOf<Self>,
        chart: usize,
    ) -> &'m Machine<ModelOf<Self::Scene>>;

    /// In a chart of another coordinate, that of the scene with its rate and acceleration at a state of the motion, which is `sample`.
    fn own_coordinate(
        &self,
        motion: &MotionOf<Self>,
        at: &Instant<'_>,
        sample: &TrajectorySample,
    ) -> Option<[f64; 3]>;

    /// Lines of the summary about chart changes and change points.
    fn describe_changes(&self, motion: &MotionOf<Self>) -> Vec<String>;

    /// The coordinates and speeds of all actuators at an event.
    fn coordinates_at(&self, motion: &MotionOf<Self>, event: &NumberedEvent) -> Option<Vec<f64>>;

    /// The error that ended a motion, in the coordinate in which it was followed last.
    fn explain_end(&self, motion: &MotionOf<Self>, error: &DynamicsError) -> StudyError;

    /// What the rows of a motion are evaluated of.
    fn row_source<'p>(&'p self, motion: &'p MotionOf<Self>) -> RowSource<'p, 'p, Self::Scene> {
        RowSource {
            charts: self.charts(motion),
            ..RowSource::new(self.scene(), self.rows())
        }
    }

    /// A motion's picked states on the sides of events that are wanted, each under a time (s), evaluated: without those within the window of a
    /// change point's fit.
    fn evaluated(
        &self,
        motion: &MotionOf<Self>,
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
                    let at = Instant::Picked(segment, picked, k);
                    sample.actuator_coordinate = self.own_coordinate(motion, &at, &sample);
                    all.push((t, sample));
                }
            }
        }
        Ok(all)
    }

    /// Every sample with its accelerations, drive magnitudes and energies. Within the window of a change
    /// point's fit there are no reactions, and no row.
    fn samples(&self, motion: &MotionOf<Self>) -> Result<Vec<TrajectorySample>, DynamicsError> {
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
        motion: &MotionOf<Self>,
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
    fn is_in_fit_window(&self, motion: &MotionOf<Self>, t: f64) -> bool {
        let is_fit = |(chart, step): (usize, &OdeState)| {
            self.machine_in(motion, chart).is_in_fit_window(&step.y)
        };
        let before = motion.steps().filter(|(_, step)| step.t <= t).last();
        let after = motion.steps().find(|(_, step)| step.t >= t);
        before.is_some_and(is_fit) || after.is_some_and(is_fit)
    }

    /// The error of the energy balance at a sample, J.
    fn energy_balance(&self, sample: &TrajectorySample) -> f64 {
        sample.extra_values[self.balance_index()]
    }
}
