//! The samples of a motion as a trajectory.

use crate::free_motion::compute::between_samples::MotionSampler;
use crate::free_motion::compute::motors::motor_values;
use crate::free_motion::compute::{ChartedProblem, MotionOf};
use crate::trajectory::compute::{
    FreeTrajectory, SamplePrecision, Trajectory, TrajectorySample, extra_columns,
};
use dwell_dynamics::{
    DynamicsError, EventSide, Machine, MachineWorkspace, MotionModes, MovingModel, OdeState,
    Solution,
};
use dwell_kinetostatics::{Drive, ReducibleModel as _};

/// A computed motion as a trajectory, with its samples, which may have been `evaluated` already, or else with wanted times (s) as rows.
pub(crate) fn trajectory<P: ChartedProblem>(
    problem: &P,
    (motion, evaluated): (&MotionOf<P>, Option<Vec<TrajectorySample>>),
    method_text: &str,
    times: Option<&[f64]>,
) -> Result<Trajectory<'static>, DynamicsError> {
    let free = FreeTrajectory {
        samples: match (times, evaluated) {
            (None, Some(samples)) => samples,
            (None, None) => problem.samples(motion)?,
            (Some(times), _) => samples_at(problem, motion, times)?,
        },
        extra_columns: extra_columns(problem.scene(), problem.machine()),
        prescribed: problem.spec().laws.iter().map(Option::is_some).collect(),
        in_charts: !motion.charts.is_empty(),
    };
    let period = problem.machine().model().range().period();
    let mut trajectory = Trajectory::of_free_motion(period, free, motion.end_time());
    method_text.clone_into(&mut trajectory.method_text);
    Ok(trajectory)
}

/// The motion at wanted times (s) up to its end, and at its end.
fn samples_at<P: ChartedProblem>(
    problem: &P,
    motion: &MotionOf<P>,
    times: &[f64],
) -> Result<Vec<TrajectorySample>, DynamicsError> {
    let end = motion.end_time();
    // Where no wanted time is before the end, the start comes first: a trajectory needs two samples.
    let start = times.first().filter(|&&t| t >= end && end > 0.0);
    let reached = times.iter().copied().filter(|&t| t < end);
    let wanted = start.map(|_| 0.0).into_iter().chain(reached).chain([end]);
    let index = problem.balance_index();
    let mut sampler = MotionSampler::new(problem, motion);
    let mut sample_at = |t: f64| sampler.sample_at(t, SamplePrecision::Exact);
    let initial = sample_at(0.0).map_or(0.0, |s| s.extra_values[index]);
    let mut samples = Vec::new();
    for t in wanted {
        let Some(mut sample) = sample_at(t) else {
            if problem.is_in_fit_window(motion, t) {
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
