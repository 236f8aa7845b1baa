//! The operating point, and names and units of states, inputs and outputs.

use crate::equilibria::compute::{SearchedRange, find_equilibria, force_extent};
use crate::explain::StudyError;
use crate::machines::{CoordinateOf, MachineScene, SceneMachine};
use crate::number_format::force_unit;
use dwell_dynamics::{
    DynamicsError, Equilibrium, Machine, StateSpace, eigenvalues_about, is_equilibrium,
    linearise as linearise_about,
};
use dwell_findings::Column;
use dwell_kinetostatics::Drive;
use dwell_scene::PlaneScene;

/// The operating point of a linearisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OperatingPoint {
    /// The equilibrium nearest to the start.
    Equilibrium,
    /// The initial state of the motion.
    InitialState,
}

/// The equilibrium nearest to the start.
fn nearest_equilibrium(
    prepared: &SceneMachine<'_, impl MachineScene>,
) -> Result<Equilibrium, StudyError> {
    let (found, searched) = find_equilibria(prepared)?;
    let (start, n) = (prepared.initial_state(), prepared.machine.free().len());
    let distance = |e: &Equilibrium| -> f64 {
        let differences = e.y[..n].iter().zip(&start).map(|(a, b)| (a - b).powi(2));
        differences.sum()
    };
    let found = found.into_iter();
    let nearest = found.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    match (nearest, searched) {
        (Some(nearest), _) => Ok(nearest),
        (None, SearchedRange::Interval(interval)) => {
            let force = force_extent(prepared, interval)?;
            let (actuator, _) = prepared.first_free_coordinate();
            Err(prepared.explain(&DynamicsError::Unbalanced { actuator, force }))
        }
        (None, SearchedRange::Starts { .. }) => {
            let what = "no start leads to one";
            Err(prepared.explain(&DynamicsError::NoEquilibrium { what }))
        }
    }
}

/// Names and units of states, inputs and outputs.
pub struct StateSpaceNames {
    /// Names and units of the states.
    pub states: Vec<Column>,
    /// Columns of the inputs.
    pub inputs: Vec<Column>,
    /// Columns of the outputs.
    pub outputs: Vec<Column>,
}

impl StateSpaceNames {
    pub(crate) fn new<S: MachineScene>(
        prepared: &SceneMachine<'_, S>,
        machine: &Machine<S::Model>,
    ) -> Self {
        let scene = prepared.scene;
        let states = prepared.state_columns();
        let input = |drive: &Drive<CoordinateOf<S>>| {
            let words = drive.kind.words(S::is_angle(drive.coordinate));
            Column::new(format!("{}.{}", drive.name, words.input), words.input_unit)
        };
        let mut outputs = states[..2 * machine.free().len()].to_vec();
        outputs.extend(scene.reaction_columns(machine.model()));
        outputs.extend(scene.drives().iter().map(|drive| {
            let unit = force_unit(S::is_angle(drive.coordinate));
            Column::new(format!("{}.actuator_force", drive.name), unit)
        }));
        Self {
            inputs: scene.drives().iter().map(input).collect(),
            states,
            outputs,
        }
    }
}

/// The linearised motion of a scene.
pub struct LinearisedMotion<'a, S: MachineScene = PlaneScene> {
    /// The scene with its machine.
    pub prepared: SceneMachine<'a, S>,
    /// The state about which it is linearised.
    pub state: Vec<f64>,
    /// The equilibrium there, if it was requested.
    pub equilibrium: Option<Equilibrium>,
    /// Whether the state is an equilibrium within rounding.
    pub is_equilibrium: bool,
    /// The matrices.
    pub linear: StateSpace,
    /// The eigenvalues of A, 1/s.
    pub eigenvalues: Vec<[f64; 2]>,
    /// The estimated error of each.
    pub eigenvalue_errors: Vec<f64>,
    /// Names and units of states, inputs and outputs.
    pub names: StateSpaceNames,
    /// Requested reactions that are statically indeterminate, and so no outputs.
    pub omitted: Vec<S::Reaction>,
}

/// Linearises the motion of a scene about a state.
///
/// # Errors
/// As [`linearise`](crate::linearise()).
pub fn compute_linearisation<S: MachineScene>(
    scene: &S,
    point: OperatingPoint,
) -> Result<LinearisedMotion<'_, S>, StudyError> {
    scene.reject_unknown_columns()?;
    let prepared = SceneMachine::new(scene)?;
    let [reactions, omitted] = scene.sorted_reactions(prepared.machine.model())?;
    let machine = scene.machine(&reactions)?;
    let (state, equilibrium) = match point {
        OperatingPoint::InitialState => (prepared.initial_state(), None),
        OperatingPoint::Equilibrium => {
            let equilibrium = nearest_equilibrium(&prepared)?;
            (equilibrium.y.clone(), Some(equilibrium))
        }
    };
    prepared.require_covered(&state, "there")?;
    let explain = |e: DynamicsError| prepared.explain(&e);
    let linear = linearise_about(&machine, 0.0, &state).map_err(explain)?;
    let is_equilibrium =
        equilibrium.is_some() || is_equilibrium(&machine, 0.0, &state, &linear).map_err(explain)?;
    let state_errors = equilibrium.as_ref().map_or(&[][..], |e| &e.errors);
    let found = eigenvalues_about(&machine, 0.0, &state, state_errors, &linear);
    let (eigenvalues, eigenvalue_errors) = found.map_err(explain)?;
    let names = StateSpaceNames::new(&prepared, &machine);
    Ok(LinearisedMotion {
        prepared,
        state,
        equilibrium,
        is_equilibrium,
        linear,
        eigenvalues,
        eigenvalue_errors,
        names,
        omitted,
    })
}
