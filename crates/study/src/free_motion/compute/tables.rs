//! The samples and the events of a motion as tables.

use crate::free_motion::compute::motors::motor_values;
use crate::free_motion::compute::{
    ChartedProblem as _, FreeMotionProblem, MotionProblem, SegmentedMotion, event_table,
};
use crate::trajectory::compute::{
    FreeTrajectory, SamplePrecision, Trajectory, TrajectorySample, extra_columns,
};
use dwell_dynamics::{
    DynamicsError, EventSide, Machine, MachineWorkspace, MotionModes, MovingModel, OdeState,
    Solution,
};
use dwell_findings::Table;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::Drive;

impl FreeMotionProblem<'_> {
    /// A computed motion as a trajectory, with its samples, which may have been `evaluated` already, or else with wanted times
    /// (s) as rows.
    pub(crate) fn trajectory(
        &self,
        motion: &SegmentedMotion,
        evaluated: Option<Vec<TrajectorySample>>,
        method_text: &str,
        times: Option<&[f64]>,
    ) -> Result<Trajectory<'static>, DynamicsError> {
        let end = motion.end_time();
        let samples = match (times, evaluated) {
            (None, Some(samples)) => samples,
            (None, None) => self.samples(motion)?,
            (Some(times), _) => self.samples_at(motion, times)?,
        };
        let period = self.output_model.plan().range().period();
        let computed = (samples, !motion.charts.is_empty(), method_text);
        Ok(free_trajectory(self, computed, (end, period)))
    }

    /// The motion at wanted times (s) up to its end, and at its end.
    fn samples_at(
        &self,
        motion: &SegmentedMotion,
        times: &[f64],
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let end = motion.end_time();
        // Where no wanted time is before the end, the start comes first: a trajectory needs two samples.
        let start = times.first().filter(|&&t| t >= end && end > 0.0);
        let reached = times.iter().copied().filter(|&t| t < end);
        let wanted = start.map(|_| 0.0).into_iter().chain(reached).chain([end]);
        let index = self.balance_index();
        let mut sampler = self.sampler(motion);
        let mut sample_at = |t: f64| sampler.sample_at(t, SamplePrecision::Exact);
        let initial = sample_at(0.0).map_or(0.0, |s| s.extra_values[index]);
        let mut samples = Vec::new();
        for t in wanted {
            let Some(mut sample) = sample_at(t) else {
                if self.is_in_fit_window(motion, t) {
                    continue;
                }
                return Err(DynamicsError::StepTooSmall { t });
            };
            sample.extra_values[index] -= initial;
            samples.push(sample);
        }
        if let [only] = samples.as_slice() {
            // The end has no row within the window of a change point's fit.
            let start = Some(0.0).filter(|&start| start < only.t);
            match start.and_then(&mut sample_at) {
                Some(mut start) => {
                    start.extra_values[index] = 0.0;
                    samples.insert(0, start);
                }
                None => samples.push(only.clone()),
            }
        }
        Ok(samples)
    }

    /// A state of the machine of a chart as a sample, without the actuator's coordinate.
    pub(crate) fn sample(
        &self,
        (chart, machine, workspace): (usize, &Machine, &mut MachineWorkspace),
        point: &OdeState,
        along: (&MotionModes, EventSide),
    ) -> Result<TrajectorySample, DynamicsError> {
        let machine = (machine, &self.loaded_scene.drives[..]);
        let sample = sample_of(machine, point, along, workspace)?;
        Ok(TrajectorySample { chart, ..sample })
    }

    /// The error of the energy balance at a sample, J.
    pub(crate) fn energy_balance(&self, sample: &TrajectorySample) -> f64 {
        sample.extra_values[self.balance_index()]
    }

    /// The events of a motion as a table.
    pub(crate) fn event_table(&self, motion: &SegmentedMotion) -> Table {
        let mechanism = &self.loaded_scene.mechanism;
        event_table(self, &motion.segments, |event| {
            let machine = self.machine_in(motion, event.chart);
            let (at, mut workspace) = (&event.state, machine.workspace());
            let state = machine.evaluate(at.t, &at.y, &mut workspace).ok()?;
            let coordinates = mechanism.actuators.iter().flat_map(|actuator| {
                let measured = CoordinateFunction::find(mechanism, actuator.coordinate());
                measured.map_or([f64::NAN; 2], |measured| state.coordinate(measured))
            });
            Some(coordinates.collect())
        })
    }
}

/// A motion that ended at a time (s) as a trajectory: its samples, the models of its charts in the plane, and its method. `period` is
/// that of the only coordinate.
pub(crate) fn free_trajectory(
    problem: &impl MotionProblem,
    (samples, in_charts, method_text): (Vec<TrajectorySample>, bool, &str),
    (end, period): (f64, Option<f64>),
) -> Trajectory<'static> {
    let motion = FreeTrajectory {
        samples,
        extra_columns: extra_columns(problem.scene(), problem.machine()),
        prescribed: problem.spec().laws.iter().map(Option::is_some).collect(),
        in_charts,
    };
    let mut trajectory = Trajectory::of_free_motion(period, motion, end);
    method_text.clone_into(&mut trajectory.method_text);
    trajectory
}

/// A state of a machine with its accelerations, drive magnitudes and energies, and with the balance of energies and works in place of
/// its error: of a motion in its modes, on a side of an event.
pub(crate) fn sample_of<M: MovingModel>(
    (machine, drives): (&Machine<M>, &[Drive<M::Coordinate>]),
    point: &OdeState,
    (modes, side): (&MotionModes, EventSide),
    workspace: &mut MachineWorkspace<f64, M>,
) -> Result<TrajectorySample, DynamicsError> {
    let point = &*modes.state_at(point, side);
    let state = machine.evaluate_along((modes, side), point, workspace)?;
    let [kinetic, potential] = state.energy();
    let works = &point.y[machine.work_offset()..];
    let mut extra_values = vec![kinetic, potential];
    extra_values.extend(works);
    extra_values.push(kinetic + potential - works.iter().sum::<f64>());
    extra_values.extend(&point.y[machine.drive_states()]);
    extra_values.extend(motor_values((machine, drives), &state, &point.y));
    let given = machine.given_loads();
    let given = given.map(|load| (load, state.magnitudes()[load]));
    Ok(TrajectorySample {
        t: point.t,
        q: state.q().to_vec(),
        q_dot: state.q_dot().to_vec(),
        q_ddot: state.q_ddot().to_vec(),
        drive_magnitudes: given.collect(),
        extra_values,
        ..TrajectorySample::default()
    })
}

/// Samples whose balance of energies and works is that since the start, where it was `initial`, J.
pub(crate) fn since_start(
    mut samples: Vec<TrajectorySample>,
    balance_index: usize,
    initial: f64,
) -> Vec<TrajectorySample> {
    for sample in &mut samples {
        sample.extra_values[balance_index] -= initial;
    }
    if let [only] = samples.as_slice() {
        // A trajectory needs two samples, even if the motion ends at its start.
        samples.push(only.clone());
    }
    samples
}

/// As what a step's end is evaluated, each with the time (s) under which it is kept: where a mode of the motion begins, as the end of what leads up
/// to it, a rounding earlier, and as the beginning of what follows.
pub(crate) fn sides_of_step(solution: &Solution, k: usize) -> Vec<(f64, EventSide)> {
    let t = solution.steps[k].t;
    match k > 0 && solution.modes.begin_at(t) {
        true => vec![(t.next_down(), EventSide::Before), (t, EventSide::After)],
        false => vec![(t, EventSide::Before)],
    }
}
