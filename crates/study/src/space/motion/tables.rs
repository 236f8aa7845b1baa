//! The samples and the events of a motion as tables.

use super::between_rows::MotionSampler;
use super::charts::Motion;
use super::problem::SpaceMotionProblem;
use super::run::Run;
#[cfg(feature = "output")]
use crate::free_motion::compute::event_table;
use crate::free_motion::compute::{MotionProblem as _, sample_of, since_start};
use crate::trajectory::compute::{SamplePrecision, TrajectorySample};
use dwell_dynamics::{
    DenseOutput, DynamicsError, EventSide, MachineOde, MachineWorkspace, MotionModes, OdeState,
    Options, Solution, StepControl, integrate,
};
#[cfg(feature = "output")]
use dwell_findings::Table;
use dwell_kinetostatics::space::Model;

impl SpaceMotionProblem<'_> {
    /// Every sample with its accelerations, drive magnitudes and energies.
    pub(super) fn samples(&self, motion: &Motion) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let after = |solution: &Solution, k: usize| vec![(solution.samples[k].t, EventSide::After)];
        let all = self.evaluated(motion, |solution| &solution.samples, after)?;
        let all: Vec<_> = all.into_iter().map(|(_, sample)| sample).collect();
        let index = self.balance_index();
        let initial = all.first().map_or(0.0, |s| s.extra_values[index]);
        Ok(since_start(all, index, initial))
    }

    /// Some states of each part of a motion on the sides of events that are wanted, each under a time (s), as samples.
    pub(super) fn evaluated(
        &self,
        motion: &Motion,
        picked: fn(&Solution) -> &[OdeState],
        wanted: fn(&Solution, usize) -> Vec<(f64, EventSide)>,
    ) -> Result<Vec<(f64, TrajectorySample)>, DynamicsError> {
        let mut all = Vec::new();
        for (problem, solution) in motion.parts(self) {
            let mut workspace = problem.machine.workspace();
            // Within the window of a change point no reaction has a value.
            let states = picked(solution).iter().enumerate();
            for (k, state) in states.filter(|(_, s)| !problem.machine.is_in_fit_window(&s.y)) {
                for (t, side) in wanted(solution, k) {
                    let along = (&solution.modes, side);
                    all.push((t, problem.sample(state, along, &mut workspace)?));
                }
            }
        }
        Ok(all)
    }

    /// The samples of a motion at wanted times (s, ascending) up to its end, and at its end.
    pub(super) fn samples_at(
        &self,
        run: &Run,
        times: &[f64],
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let end = run.motion.end();
        let wanted = times.iter().copied().filter(|&t| t < end).chain([end]);
        let mut workspace = self.machine.workspace();
        let samples = match &run.motion.parts[..] {
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
        let end = run.motion.end();
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
            None if self.crosses_at(run, t) => None,
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
            let at = [&sample.q[..], &sample.q_dot, &sample.q_ddot];
            sample.actuator_coordinate = self.own_coordinate(chart, at);
        }
        Ok(sample)
    }

    /// The events of a motion as a table.
    #[cfg(feature = "output")]
    pub(in crate::space) fn event_table(&self, motion: &Motion) -> Table {
        event_table(self, &motion.parts, |event| {
            let problem = motion.problem(self, event.chart);
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
