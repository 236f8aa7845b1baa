//! The states of a machine as recorded operations, and the derivatives of weighted sums of their outputs.

use super::machine_numbers::{GradientScene, WantedOf, machine_numbers};
use crate::machines::MachineScene;
use crate::trajectory::compute::{Quantity, RowScene, Signal};
use dwell_geometry::JointId;
use dwell_kinetostatics::{
    InverseDynamics, MachineModel, Magnitude, RecordableModel as _, RecordedState,
    ReducibleModel as _, Signal as LoadSignal, StateLayout, WantedMotion,
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
pub(super) struct StateOfMotion<'a> {
    /// The time of the loads, s; `None` without loads.
    pub(super) load_time: Option<f64>,
    /// By actuator: coordinate (rad or m), velocity and acceleration.
    pub(super) q: &'a [f64],
    pub(super) q_dot: &'a [f64],
    pub(super) q_ddot: &'a [f64],
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
pub(super) struct RecordedMachine<'a, S: GradientScene> {
    scene: &'a S,
    /// The model under its loads.
    model: &'a S::Model,
    workspace: WorkspaceOf<S>,
    forces: InverseDynamics<f64>,
    /// The model of the recordings.
    structure: S::Model,
    structure_workspace: WorkspaceOf<S>,
    wanted: WantedOf<S>,
    /// By wanted coordinate: its number among the measured ones.
    measured: Vec<usize>,
    /// By wanted point: its body, and its place there.
    points: Vec<(usize, [f64; 3])>,
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
    pub(super) fn new(scene: &'a S, model: &'a S::Model, signals: &[Signal]) -> Option<Self> {
        let is_fixed = |m: &Magnitude<_>| !matches!(m, Magnitude::External(_));
        let is_recordable = model.frictions().len() == 0
            && model.loads().len() == scene.loads().len()
            && model.loads().iter().all(|load| is_fixed(&load.magnitude));
        if !is_recordable {
            return None;
        }
        let quantities = signals.iter().flat_map(Signal::quantities);
        let (mut measured, mut points) = (Vec::new(), Vec::new());
        for quantity in quantities {
            match quantity {
                Quantity::Measured(k, _) if !measured.contains(&k) => measured.push(k),
                Quantity::Point(body, at, ..) if !points.contains(&(body.0, at)) => {
                    points.push((body.0, at));
                }
                _ => {}
            }
        }
        let coordinates = measured.iter().map(|&k| coordinate(scene, k));
        let wanted = WantedMotion {
            coordinates: coordinates.collect::<Option<_>>()?,
            points: points
                .iter()
                .map(|&(b, at)| (b.into(), S::point(at)))
                .collect(),
        };
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
            wanted,
            measured,
            points,
            recordings: Vec::new(),
            limited: None,
            sweep: ReverseSweep::default(),
            block_sweep: ReverseSweep::default(),
            largest: 0.0,
        })
    }

    /// The model of the recordings.
    pub(super) fn structure(&self) -> &S::Model {
        &self.structure
    }

    /// Whether the mechanism may not allow other numbers.
    pub(super) fn may_refuse_numbers(&self) -> bool {
        S::may_refuse_numbers(&self.structure)
    }

    /// What is wanted of the states.
    pub(super) fn wanted(&self) -> &WantedOf<S> {
        &self.wanted
    }

    /// The numbers by which derivatives are taken.
    pub(super) fn numbers(&self) -> &[f64] {
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
                let quantities = signal.quantities();
                let places: Vec<usize> = quantities.iter().filter_map(|q| self.place(*q)).collect();
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
            for (output, slope) in self.slopes(signal, &outputs, at.q_dot) {
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
        for (output, slope) in self.slopes(signal, outputs, at.q_dot) {
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

    /// The outputs on which a signal depends, with its derivatives by them, where the outputs and velocities have these values.
    fn slopes(&self, signal: &Signal, outputs: &[f64], q_dot: &[f64]) -> Vec<(usize, f64)> {
        let place = |quantity: Quantity| self.place(quantity);
        match signal {
            Signal::Column(column) => place(column.quantity)
                .map(|k| (k, 1.0))
                .into_iter()
                .collect(),
            Signal::Norm(components) => {
                let places: Vec<usize> = components.iter().filter_map(|c| place(*c)).collect();
                let squares = places.iter().map(|k| outputs[*k] * outputs[*k]);
                let norm = squares.sum::<f64>().sqrt();
                places.into_iter().map(|k| (k, outputs[k] / norm)).collect()
            }
            Signal::Power(i) => vec![(*i, q_dot[*i])],
            Signal::Distance(_) => Vec::new(),
        }
    }

    /// The output that a quantity is; none of a coordinate of an actuator, which no number changes.
    fn place(&self, quantity: Quantity) -> Option<usize> {
        let (actuators, reactions) = (self.model.actuators(), self.model.reaction_count());
        let coordinates = actuators + reactions;
        let points = coordinates + 3 * self.measured.len();
        match quantity {
            Quantity::ActuatorForce(i) => Some(i),
            Quantity::Reaction(k) => Some(actuators + k),
            Quantity::Measured(k, order) => {
                let at = self.measured.iter().position(|m| *m == k)?;
                Some(coordinates + 3 * at + order)
            }
            Quantity::Point(body, at, order, axis) => {
                let k = self.points.iter().position(|p| *p == (body.0, at))?;
                Some(points + S::DIMENSION * (3 * k + order) + axis)
            }
            _ => None,
        }
    }
}

/// Whether the first outputs of a recording are these actuator forces, in parts of the largest force.
fn agree(outputs: &[f64], tau: &[f64], largest: f64) -> bool {
    let mut pairs = outputs.iter().zip(tau);
    pairs.all(|(a, b)| (a - b).abs() <= SAME * largest)
}

/// Whether a quantity is an output of a recording, or depends on no number.
pub(super) fn is_recorded(quantity: Quantity) -> bool {
    matches!(
        quantity,
        Quantity::Time
            | Quantity::ActuatorCoordinate(..)
            | Quantity::ActuatorForce(_)
            | Quantity::Reaction(_)
            | Quantity::Measured(..)
            | Quantity::Point(..)
    )
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

/// A measured coordinate by its number, as of [`RowScene::measured`].
fn coordinate<S: RowScene>(scene: &S, k: usize) -> Option<crate::machines::CoordinateOf<S>> {
    let named = scene.named_coordinates();
    match k.checked_sub(named.len()) {
        None => Some(named[k].coordinate),
        Some(joint) => (joint < scene.joint_names().len()).then(|| S::travel(JointId(joint))),
    }
}
