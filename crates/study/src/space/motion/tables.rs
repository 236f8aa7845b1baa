//! The samples and the events of a motion as tables.

use super::between_rows::MotionSampler;
use super::charts::Motion;
use super::problem::SpaceMotionProblem;
use super::run::Run;
use crate::free_motion::compute::{
    ChartedProblem as _, MotionProblem as _, event_table, sample_of, since_start,
};
use crate::trajectory::compute::{SamplePrecision, TrajectorySample};
use dwell_dynamics::{
    DenseOutput, DynamicsError, EventSide, MachineOde, MachineWorkspace, MotionModes, OdeState,
    Options, StepControl, integrate,
};
use dwell_findings::Table;
use dwell_kinetostatics::space::Model;

impl SpaceMotionProblem<'_> {
    /// The samples of a motion at wanted times (s, ascending) up to its end, and at its end.
    pub(super) fn samples_at(
        &self,
        run: &Run,
        times: &[f64],
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let end = run.motion.end_time();
        let wanted = times.iter().copied().filter(|&t| t < end).chain([end]);
        let mut workspace = self.machine.workspace();
        let samples = match &run.motion.segments[..] {
            [(_, solution)] if solution.modes.is_empty() => {
                self.samples_from_start(run, wanted, &mut workspace)?
            }
            _ => self.samples_within_steps(run, wanted)?,
        };
        let at_start = (&MotionModes::default(), EventSide::After);
        let initial = self.sample(&self.initial_state(), at_start, &mut workspace)?;
        let index = self.balance_index();
        Ok(since_start(samples, index, initial.extra_values[index]))
    }

    /// Those of a motion without change of its coordinate or of its mode: integrated from one to the next.
    fn samples_from_start(
        &self,
        run: &Run,
        wanted: impl Iterator<Item = f64>,
        workspace: &mut MachineWorkspace<f64, Model>,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let end = run.motion.end_time();
        let mut states = Vec::new();
        let mut state = self.initial_state();
        let options = Options {
            sample_interval: None,
            ..run.options
        };
        for t in wanted {
            if let Some((orbit, _)) = &run.orbit {
                states.push(OdeState::from(orbit.state_at(t)));
                continue;
            }
            if t > state.t {
                let mut ode = MachineOde::until(&self.machine, state.t, &state.y, Some(end))?;
                let mut every =
                    |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
                let until = integrate(&mut ode, &state, Some(t), &options, &mut every)?;
                if let Some(error) = until.error {
                    return Err(error);
                }
                state = until.state;
            }
            states.push(state.clone());
        }
        states.retain(|state| !self.machine.is_in_fit_window(&state.y));
        let along = (&MotionModes::default(), EventSide::After);
        let all = states.iter();
        all.map(|state| self.sample(state, along, workspace))
            .collect()
    }

    /// Those of a motion with modes or several coordinates: from the step before each time.
    fn samples_within_steps(
        &self,
        run: &Run,
        wanted: impl Iterator<Item = f64>,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let mut sampler = MotionSampler::new(self, run);
        let sample = |t: f64| match sampler.sample_at(t, SamplePrecision::Exact) {
            None if self.is_in_fit_window(&run.motion, t) => None,
            found => Some(found.ok_or(DynamicsError::StepTooSmall { t })),
        };
        wanted.filter_map(sample).collect()
    }

    /// A state of the machine with its accelerations, drive magnitudes and energies; with the balance of energies and works in
    /// place of its error.
    pub(super) fn sample(
        &self,
        point: &OdeState,
        along: (&MotionModes, EventSide),
        workspace: &mut MachineWorkspace<f64, Model>,
    ) -> Result<TrajectorySample, DynamicsError> {
        let scene = self.scene();
        let machine = (&self.machine, &scene.drives[..]);
        let mut sample = sample_of(machine, point, along, workspace)?;
        if let Some(chart) = self.chart {
            sample.chart = chart.number;
            sample.actuator_coordinate = self.scene_coordinate(&sample);
        }
        Ok(sample)
    }

    /// The events of a motion as a table.
    pub(in crate::space) fn event_table(&self, motion: &Motion) -> Table {
        event_table(self, &motion.segments, |event| {
            let problem = self.in_chart(motion, event.chart);
            let mut workspace = problem.machine.workspace();
            let along = (&MotionModes::default(), EventSide::After);
            let sample = problem.sample(&event.state, along, &mut workspace).ok()?;
            Some(match sample.actuator_coordinate {
                Some([q, speed, _]) => vec![q, speed],
                None => {
                    let both = sample.q.iter().zip(&sample.q_dot);
                    both.flat_map(|(q, speed)| [*q, *speed]).collect()
                }
            })
        })
    }
}
