//! The states of a machine as recorded operations, and the derivatives of weighted sums of their outputs.

use super::machine_numbers::{GradientScene, WantedOf, machine_numbers};
use super::outputs::RecordedOutputs;
use crate::machines::MachineScene;
use crate::trajectory::compute::Signal;
use dwell_kinetostatics::{
    InverseDynamics, MachineModel, Magnitude, RecordableModel as _, RecordedState,
    ReducibleModel as _, Signal as LoadSignal, StateLayout,
};
use dwell_laws::HeldPieces;
use dwell_numerics::{Lanes, ReverseSweep};
use std::array;

/// Actuator forces of a recording and of the model agree to this part of the largest; otherwise the operations differ at a pose, and are
/// recorded anew.
const SAME: f64 = 1e-9;
/// States that are evaluated side by side.
const LANES: usize = 8;

/// The memory of the model of a scene for one pose.
type WorkspaceOf<S> =
    <<S as MachineScene>::Model as dwell_kinetostatics::ReducibleModel>::Workspace<f64>;

/// A state of motion under loads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StateOfMotion<'a> {
    /// The time of the loads, s; `None` without loads.
    pub(crate) load_time: Option<f64>,
    /// By actuator: coordinate (rad or m), velocity and acceleration.
    pub(crate) q: &'a [f64],
    pub(crate) q_dot: &'a [f64],
    pub(crate) q_ddot: &'a [f64],
}

/// A state that can be evaluated.
struct Prepared {
    /// The inputs of a recording, the solution of the closures last.
    inputs: Vec<f64>,
    /// How many of them precede the solution.
    known: usize,
    /// The forces of the actuators.
    tau: Vec<f64>,
}

/// A machine whose states are recorded.
pub(crate) struct RecordedMachine<'a, S: GradientScene> {
    scene: &'a S,
    /// The model under its loads.
    model: &'a S::Model,
    workspace: WorkspaceOf<S>,
    forces: InverseDynamics<f64>,
    /// The model of the recordings.
    structure: S::Model,
    structure_workspace: WorkspaceOf<S>,
    outputs: RecordedOutputs,
    wanted: WantedOf<S>,
    /// The numbers of the machine, with the constant magnitudes of its loads.
    numbers: Vec<f64>,
    /// Recordings: where one's operations are not those of a pose, there is another.
    recordings: Vec<RecordedState>,
    /// The first of them without the outputs that the signal of the last block does not need.
    limited: Option<RecordedState>,
    sweep: ReverseSweep<f64>,
    block_sweep: ReverseSweep<Lanes<LANES>>,
    /// The largest force so far, N or N·m.
    largest: f64,
}

impl<'a, S: GradientScene> RecordedMachine<'a, S> {
    /// The machine of a scene whose rows have this model, for these signals of recorded quantities. `None` if it cannot be recorded.
    pub(crate) fn new(scene: &'a S, model: &'a S::Model, signals: &[Signal]) -> Option<Self> {
        let is_fixed = |m: &Magnitude<_>| !matches!(m, Magnitude::External(_));
        let is_recordable = model.frictions().len() == 0
            && model.loads().len() == scene.loads().len()
            && model.loads().iter().all(|load| is_fixed(&load.magnitude));
        if !is_recordable {
            return None;
        }
        let counts = [model.actuators(), model.reaction_count()];
        let outputs = RecordedOutputs::new(scene, model, counts, signals)?;
        let wanted = outputs.wanted_in(scene, model)?;
        let structure = scene.with_all_places(model);
        Some(Self {
            numbers: machine_numbers(scene, &structure, &wanted)?,
            workspace: model.pass_workspace(),
            forces: InverseDynamics {
                tau: vec![0.0; model.actuators()],
                reactions: vec![0.0; model.reaction_count()],
            },
            structure_workspace: structure.pass_workspace(),
            structure,
            scene,
            model,
            outputs,
            wanted,
            recordings: Vec::new(),
            limited: None,
            sweep: ReverseSweep::default(),
            block_sweep: ReverseSweep::default(),
            largest: 0.0,
        })
    }

    /// The model of the recordings.
    pub(crate) fn structure(&self) -> &S::Model {
        &self.structure
    }

    /// Whether the mechanism may not allow other numbers.
    pub(super) fn may_refuse_numbers(&self) -> bool {
        S::may_refuse_numbers(&self.structure)
    }

    /// The outputs of its recordings.
    pub(crate) fn outputs(&self) -> &RecordedOutputs {
        &self.outputs
    }

    /// The numbers of the machine of a variant, in the order of [`numbers`](Self::numbers); `None` if it has another structure.
    pub(crate) fn numbers_of(&self, variant: &S) -> Option<Vec<f64>> {
        let wanted = self.outputs.wanted_in(variant, &self.structure)?;
        machine_numbers(variant, &self.structure, &wanted)
    }

    /// The recording of a state, and its inputs; `None` if it has no recording or needs the solution of closures without closed form.
    pub(crate) fn recorded(&mut self, at: StateOfMotion<'_>) -> Option<(RecordedState, Vec<f64>)> {
        let prepared = self.prepare(at)?;
        let k = self.recording(&prepared)?;
        let is_closed = prepared.inputs.len() == prepared.known;
        is_closed.then(|| (self.recordings[k].clone(), prepared.inputs))
    }

    /// The numbers by which derivatives are taken.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    /// Adds the derivatives of a signal at some states by all numbers, each times a weight, to `gradient`; `None` if a state cannot be
    /// recorded. Blocks of states of the same operations are evaluated side by side.
    pub(super) fn add_gradients(
        &mut self,
        states: &[(StateOfMotion<'_>, f64)],
        signal: &Signal,
        gradient: &mut [f64],
    ) -> Option<()> {
        self.limited = None;
        for block in states.chunks(LANES) {
            let prepared = block.iter().map(|(at, _)| self.prepare(*at));
            let prepared: Vec<Prepared> = prepared.collect::<Option<_>>()?;
            if self.add_block(block, &prepared, signal, gradient).is_some() {
                continue;
            }
            for ((at, weight), prepared) in block.iter().zip(prepared) {
                self.add_single(*at, prepared, signal, *weight, gradient)?;
            }
        }
        Some(())
    }

    /// The inputs of a state and the forces of the model there.
    fn prepare(&mut self, at: StateOfMotion<'_>) -> Option<Prepared> {
        let mut inputs = self.inputs(at)?;
        self.evaluate(at)?;
        let forces = self.forces.tau.iter().chain(&self.forces.reactions);
        self.largest = forces.fold(self.largest, |max, v| max.max(v.abs()));
        let known = inputs.len();
        // The model follows its own branch; its structure may have other unknowns.
        inputs.extend(self.model.solution(at.q, &mut self.workspace).ok()?);
        Some(Prepared {
            inputs,
            known,
            tau: self.forces.tau.clone(),
        })
    }

    /// Adds the derivatives at a whole block of states; `None` if the operations of the first recording are not those of all.
    fn add_block(
        &mut self,
        block: &[(StateOfMotion<'_>, f64)],
        prepared: &[Prepared],
        signal: &Signal,
        gradient: &mut [f64],
    ) -> Option<()> {
        let whole = self.recordings.first()?;
        let fits = |p: &Prepared| p.inputs.len() == whole.layout.inputs;
        if prepared.len() < LANES || !prepared.iter().all(fits) {
            return None;
        }
        let recorded = match self.limited.take() {
            Some(known) => known,
            None => {
                let places = self.outputs.places(signal);
                whole.limited_to(|k| k < self.model.actuators() || places.contains(&k))
            }
        };
        let lanes = |k: usize| Lanes::<LANES>(array::from_fn(|lane| prepared[lane].inputs[k]));
        let inputs: Vec<Lanes<LANES>> = (0..recorded.layout.inputs).map(lanes).collect();
        let mut sweep = std::mem::take(&mut self.block_sweep);
        let outputs = sweep.evaluate(&recorded.code, &inputs);
        let mut weights = vec![Lanes([0.0; LANES]); outputs.len()];
        for (lane, (prepared, (at, weight))) in prepared.iter().zip(block).enumerate() {
            let outputs: Vec<f64> = outputs.iter().map(|output| output.0[lane]).collect();
            if !agree(&outputs, &prepared.tau, self.largest) {
                return None;
            }
            for (output, slope) in self.outputs.slopes(signal, &|k| outputs[k], at.q_dot) {
                weights[output].0[lane] += weight * slope;
            }
        }
        let slopes = sweep.gradient(&recorded.code, &inputs, &weights);
        let is_loaded = |lane: usize| block[lane].0.load_time.is_some();
        let sums = slopes.iter().map(|slope| slope.0.iter().sum());
        let sums: Vec<f64> = sums.collect();
        self.add_slopes(recorded.layout, &sums, is_loaded(0), gradient);
        (self.block_sweep, self.limited) = (sweep, Some(recorded));
        Some(())
    }

    /// Adds the derivatives at a single state.
    fn add_single(
        &mut self,
        at: StateOfMotion<'_>,
        mut prepared: Prepared,
        signal: &Signal,
        weight: f64,
        gradient: &mut [f64],
    ) -> Option<()> {
        let k = self.recording(&prepared).or_else(|| {
            let other = self.structure.solution(at.q, &mut self.structure_workspace);
            prepared.inputs.truncate(prepared.known);
            prepared.inputs.extend(other.ok()?);
            self.recording(&prepared)
        })?;
        let recorded = &self.recordings[k];
        let outputs = self.sweep.outputs();
        let mut weights = vec![0.0; outputs.len()];
        for (output, slope) in self.outputs.slopes(signal, &|k| outputs[k], at.q_dot) {
            weights[output] += weight * slope;
        }
        let layout = recorded.layout;
        let mut sweep = std::mem::take(&mut self.sweep);
        let slopes = sweep.gradient(&self.recordings[k].code, &prepared.inputs, &weights);
        self.add_slopes(layout, slopes, at.load_time.is_some(), gradient);
        self.sweep = sweep;
        Some(())
    }

    /// Adds derivatives by all inputs to those by the numbers of the machine.
    fn add_slopes(
        &self,
        layout: StateLayout,
        slopes: &[f64],
        is_loaded: bool,
        gradient: &mut [f64],
    ) {
        let (of_machine, of_loads) = gradient.split_at_mut(layout.numbers);
        let own = &slopes[layout.first_number()..layout.solution()];
        let pairs = of_machine.iter_mut().zip(own);
        pairs.for_each(|(sum, slope)| *sum += slope);
        if is_loaded {
            let first = layout.first_magnitude();
            let places = magnitude_places(self.scene.loads());
            for (sum, place) in of_loads.iter_mut().zip(places) {
                *sum += slopes[first + place];
            }
        }
    }

    /// The inputs of a recording at a state, without the solution of the closures.
    fn inputs(&mut self, at: StateOfMotion<'_>) -> Option<Vec<f64>> {
        let of_machine = self.numbers.len() - self.scene.loads().len();
        let mut inputs = [at.q, at.q_dot, at.q_ddot].concat();
        self.model
            .update_kinematics(at.q, at.q_dot, &mut self.workspace)
            .ok()?;
        if let Some(t) = at.load_time {
            self.model.update_magnitudes(t, &mut self.workspace).ok()?;
        }
        for (k, load) in self.model.loads().iter().enumerate() {
            let values: Vec<f64> = (self.model.compiled_signals(k).iter())
                .map(|signal| match *signal {
                    LoadSignal::Time => at.load_time.unwrap_or(0.0),
                    LoadSignal::Value(of) => self.model.coordinate_motion(of, &self.workspace)[0],
                    LoadSignal::Velocity(of) => {
                        self.model.coordinate_motion(of, &self.workspace)[1]
                    }
                })
                .collect();
            let is_loaded = at.load_time.is_some();
            let magnitude = S::Model::magnitudes(&self.workspace)[k];
            inputs.push(if is_loaded { magnitude } else { 0.0 });
            for (i, signal) in load.magnitude.signals().iter().enumerate() {
                if matches!(signal, LoadSignal::Time) {
                    continue;
                }
                let rates = values.iter().enumerate();
                let rates: Vec<[f64; 2]> = rates.map(|(j, v)| [*v, f64::from(i == j)]).collect();
                let slope = load.magnitude.rate(&rates, &HeldPieces::default());
                inputs.extend([if is_loaded { slope } else { 0.0 }, values[i]]);
            }
        }
        inputs.extend(&self.numbers[..of_machine]);
        Some(inputs)
    }

    /// Evaluates the recording whose operations are those of a state, and gives its number: that is, whose actuator forces are those of
    /// the model. If there is none, the state is recorded. `None` if it cannot be.
    fn recording(&mut self, of: &Prepared) -> Option<usize> {
        let (sweep, largest) = (&mut self.sweep, self.largest);
        let mut agrees = |recorded: &RecordedState| {
            let outputs = sweep.evaluate(&recorded.code, &of.inputs);
            agree(outputs, &of.tau, largest)
        };
        let mut recordings = self.recordings.iter();
        let fits = |r: &RecordedState| r.layout.inputs == of.inputs.len();
        if let Some(known) = recordings.position(|r| fits(r) && agrees(r)) {
            return Some(known);
        }
        let described = self.scene.described(&self.wanted);
        let one = std::slice::from_ref(&of.inputs);
        let recorded = RecordedState::record(&self.structure, described, one);
        let recorded = recorded.ok().filter(|recorded| agrees(recorded))?;
        self.recordings.push(recorded);
        Some(self.recordings.len() - 1)
    }

    /// The forces of the model at a state whose velocities and magnitudes are known.
    fn evaluate(&mut self, at: StateOfMotion<'_>) -> Option<()> {
        let Self {
            model,
            workspace,
            forces,
            ..
        } = self;
        model.update_accelerations(at.q_ddot, workspace);
        if at.load_time.is_none() {
            S::Model::magnitudes_mut(workspace).fill(0.0);
        }
        model.update_wrenches(workspace).ok()?;
        model.loaded_balance(workspace, forces);
        Some(())
    }
}

/// Whether the first outputs of a recording are these actuator forces, in parts of the largest force.
fn agree(outputs: &[f64], tau: &[f64], largest: f64) -> bool {
    let mut pairs = outputs.iter().zip(tau);
    pairs.all(|(a, b)| (a - b).abs() <= SAME * largest)
}

/// By load: the place of its magnitude among the inputs of all.
fn magnitude_places<K, C: Copy>(loads: &[dwell_kinetostatics::Load<K, C>]) -> Vec<usize> {
    let mut next = 0;
    let place = |load: &dwell_kinetostatics::Load<K, C>| {
        let signals = dwell_kinetostatics::signal_coordinates(&load.magnitude).count();
        let at = next;
        next += 1 + 2 * signals;
        at
    };
    loads.iter().map(place).collect()
}
