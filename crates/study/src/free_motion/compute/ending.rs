//! The end of a motion of several coordinates that cannot continue.
//!
//! In front of a singular position the speeds of some bodies are quotients of two small numbers. A step that leads to it, or beyond to
//! where the bodies would have to pass to another assembly mode, breaks the balance of energies and works: by 0.3 to 10 times the
//! kinetic energy in all that were seen, where the rows before it close to 1e-6.

use super::LARGE_ERROR;
use dwell_dynamics::{DynamicsError, Machine, MachineWorkspace, MovingModel, OdeState, Solution};

/// A step behind the last good sample keeps its balance within this part of the largest kinetic energy: where speeds err by it,
/// accelerations err by a hundredth at a tolerance of 1e-10.
const KEPT: f64 = 1e-5;
/// How far around a state a position that does not exist is looked for, as parts of its coordinates or of a unit.
const NEAR: [f64; 2] = [1e-7, 1e-5];

/// Ends a motion before its first sample that the mechanism cannot take, be it by rounding, for an implicit method may stay at the end
/// of the range of several coordinates; or that lies at or beyond a singular position.
pub(crate) fn end_where_impossible<M: MovingModel>(machine: &Machine<M>, solution: &mut Solution) {
    let mut watch = Watch {
        machine,
        workspace: machine.workspace(),
        good: None,
    };
    let mut samples = solution.samples.iter();
    let fault = samples.find_map(|at| Some((at.t, watch.fault(at, solution)?)));
    let is_found = fault.is_some();
    if let Some((t, error)) = fault {
        solution.samples.retain(|s| s.t < t);
        solution.steps.retain(|s| s.t < t);
        solution.error = Some(error);
    }
    watch.name_cause(solution);
    if !is_found && !matches!(solution.error, Some(DynamicsError::Position(_))) {
        return;
    }
    // Behind the last good sample, up to the first step that is none.
    let good = watch.good.map_or(f64::NEG_INFINITY, |(t, _)| t);
    let begun = solution.steps.partition_point(|step| step.t <= good);
    let further = solution.steps[begun..].iter();
    let true_ones = further.take_while(|step| watch.is_true(step)).count();
    solution.steps.truncate(begun + true_ones);
    // The last sample may be in a step whose end is impossible: the motion ends with it.
    let last_step = solution.steps.last().map_or(f64::NEG_INFINITY, |s| s.t);
    let sample = solution.samples.last().filter(|last| last.t > last_step);
    solution.steps.extend(sample.cloned());
    let end = solution.steps.last().map_or(f64::NEG_INFINITY, |s| s.t);
    solution.event_occurrences.retain(|o| o.state.t <= end);
}

/// What is known of the states so far.
struct Watch<'m, M: MovingModel> {
    machine: &'m Machine<M>,
    workspace: MachineWorkspace<f64, M>,
    /// The last good one: its time, s, the largest kinetic energy up to it, and its balance of energies and works, J.
    good: Option<(f64, [f64; 2])>,
}

impl<M: MovingModel> Watch<'_, M> {
    /// The kinetic energy of a state, and its balance of energies and works, J.
    fn energies(&mut self, at: &OdeState) -> Result<[f64; 2], DynamicsError> {
        let state = self.machine.evaluate(at.t, &at.y, &mut self.workspace)?;
        let [kinetic, potential] = state.energy();
        let works: f64 = at.y[self.machine.work_offset()..].iter().sum();
        Ok([kinetic, kinetic + potential - works])
    }

    /// Whether a balance differs from that of the last good state by more than this, J.
    fn is_broken(&self, balance: f64, allowed: f64) -> bool {
        // Impacts lose energy that is no work.
        let differs = |(_, [_, before]): (f64, [f64; 2])| (balance - before).abs() > allowed;
        !self.machine.has_contacts() && self.good.is_some_and(differs)
    }

    /// Whether a state can be evaluated, and keeps its balance.
    fn is_true(&mut self, at: &OdeState) -> bool {
        let largest = self.good.map_or(0.0, |(_, [largest, _])| largest);
        let found = self.energies(at);
        found.is_ok_and(|[_, balance]| !self.is_broken(balance, KEPT * largest))
    }

    /// Why a state cannot be one of the motion: there is no position next to it, or the motion ends where its balance breaks.
    fn fault(&mut self, at: &OdeState, solution: &Solution) -> Option<DynamicsError> {
        let [kinetic, balance] = match self.energies(at) {
            Ok(energies) => energies,
            Err(error) => return Some(error),
        };
        let (from, largest) = self
            .good
            .map_or((at.t, 0.0), |(t, [largest, _])| (t, largest));
        let largest = largest.max(kinetic);
        if self.is_broken(balance, LARGE_ERROR * largest) {
            let begun = solution.steps.partition_point(|step| step.t < from);
            let between = solution.steps[begun..].iter();
            let mut between = between.take_while(|step| step.t <= at.t).chain([at]);
            let missing = between.find_map(|step| self.missing_near(step));
            if let Some(error) = missing.or_else(|| solution.error.clone()) {
                return Some(error);
            }
        }
        self.good = Some((at.t, [largest, balance]));
        None
    }

    /// Why there is no position next to a state, if so.
    fn missing_near(&mut self, at: &OdeState) -> Option<DynamicsError> {
        let mut moved = at.y.clone();
        for near in NEAR {
            for k in 0..self.machine.free().len() {
                for side in [-near, near] {
                    moved[k] = at.y[k] + side * at.y[k].abs().max(1.0);
                    let found = self.machine.energy(at.t, &moved, &mut self.workspace);
                    if let Err(error @ DynamicsError::Position(_)) = found {
                        return Some(error);
                    }
                    moved[k] = at.y[k];
                }
            }
        }
        None
    }

    /// A motion that became slow without end next to a position that does not exist ends because of that.
    fn name_cause(&mut self, solution: &mut Solution) {
        use DynamicsError::{
            LostBalance, MaxStepsReached, NoInertia, NoProgress, NotFinite, StepTooSmall, TooSlow,
        };
        let unnamed = matches!(
            solution.error,
            Some(
                MaxStepsReached { .. }
                    | StepTooSmall { .. }
                    | TooSlow { .. }
                    | NoProgress { function: None, .. }
                    | LostBalance { .. }
                    // The inertia of several coordinates has no rank there.
                    | NoInertia { .. }
                    | NotFinite { .. }
            )
        );
        let last = solution.steps.last().cloned().filter(|_| unnamed);
        if let Some(error) = last.and_then(|last| self.missing_near(&last)) {
            solution.error = Some(error);
        }
    }
}
