//! The equations of motion of a scene with several degrees of freedom, as the model's own operations.

use super::description::{
    describe_loads, left_out, load_units, named_reactions, point_names, with_unit_loads,
};
use super::{ExportRequest, SEARCHED};
use crate::explain::{StudyError, actuator_labels, explain_motion, scene_error};
use crate::machines::MachineScene as _;
use crate::number_format::count;
use dwell_dynamics::DynamicsError;
use dwell_export::{FreeCoordinate, Precision, SeveralFreedomsDescription, SeveralFreedomsExport};
use dwell_geometry::ActuatorId;
use dwell_kinetostatics::{
    InverseDynamics, Load, LoadShape as _, MachineModel as _, Model, Strength,
};
use dwell_numerics::{RecordedNumber, RecordingError, Scalar, StraightLine, record_at};
use dwell_scene::{PlaneScene, SceneLocation};

/// Positions at which the operations are compared with the model, and how many of them record the operations.
const MEASURED: usize = 64;
const RECORDED: usize = 4;
/// How far from the initial position they are: rad, and parts of the mechanism's size.
const AROUND: [f64; 2] = [0.5, 0.15];
/// The largest difference that is rounding. Operations of another assembly mode are off by much more.
const ROUNDING: f64 = 1e-7;

/// The operations of the equations of motion of a scene in the plane.
pub(crate) fn several_freedoms_in_plane(
    scene: &PlaneScene,
    asked: &ExportRequest,
) -> Result<SeveralFreedomsExport, StudyError> {
    if asked.interval.is_some() {
        return Err(scene_error(
            scene,
            "an interval is of one coordinate, and this scene has several",
            "leave --from and --until out: the equations of motion hold wherever the mechanism can be assembled",
            [(SceneLocation::Actuator(ActuatorId(0)), "one of them")],
        ));
    }
    reject_drags(scene)?;
    let (loaded, model) = with_unit_loads(scene)?;
    let machine = describe(scene, &loaded, &model);
    let explain = |error| explain_motion(&loaded, model.plan(), &error);
    let positions = positions(&machine, &model, scene.mechanism.size());
    if positions.is_empty() {
        return Err(without_operations(
            scene,
            "the mechanism cannot move from its initial position",
        ));
    }
    let sampled = |q: &[f64]| functions::<f64>(scene, &model, q);
    let code = recorded(scene, &model, &positions).map_err(|error| match error {
        RecordingError::Evaluation(error) => explain(error),
        RecordingError::Function => without_operations(
            scene,
            "a law of a cam, a joint or an inertia is given by its values only",
        ),
        RecordingError::Differs { .. } => without_operations(scene, SEARCHED),
    })?;
    if let Some(load) = SeveralFreedomsExport::unsupported_rotor(&machine, &code[0]) {
        let drive = load - scene.loads.len();
        return Err(scene_error(
            scene,
            format!(
                "no export: the rotor of {} turns with a coordinate that is no actuator's",
                machine.loads[load].name
            ),
            "leave the inertia of its rotor out, or drive an actuator",
            [(SceneLocation::Drive(drive), "this motor")],
        ));
    }
    let measured = |precision, code: [StraightLine; 3]| {
        let machine = machine.clone();
        SeveralFreedomsExport::new(machine, precision, code, &positions, sampled).map_err(explain)
    };
    let export = measured(Precision::Double, code)?;
    let error = export.errors.max();
    if error.is_nan() || error > ROUNDING {
        return Err(without_operations(scene, SEARCHED));
    }
    match asked.request.precision {
        Precision::Double => Ok(export),
        Precision::Float => measured(Precision::Float, export.code),
    }
}

/// Rejects drags: if several coordinates move the point, c |v| v is not a product of a number and a function of the
/// coordinates.
fn reject_drags(scene: &PlaneScene) -> Result<(), StudyError> {
    let is_drag = |load: &Load| load.kind.strength() == Strength::Quadratic;
    let Some(load) = scene.loads.iter().position(is_drag) else {
        return Ok(());
    };
    let name = &scene.loads[load].name;
    Err(scene_error(
        scene,
        format!("no export: the force of the drag {name} depends on all velocities together"),
        "leave the drag out, or put a damper in its place; machines with one degree of freedom are exported with it",
        [(SceneLocation::Load(load), "a drag")],
    ))
}

/// Refuses another target than C.
pub(crate) fn only_as_c(scene: &PlaneScene) -> StudyError {
    let given = count(scene.mechanism.actuators.len(), "actuator");
    scene_error(
        scene,
        format!("the scene has {given}: several degrees of freedom are exported as C alone"),
        "export to `c`; or give exactly one actuator in [actuators]",
        actuator_labels(scene, "drives it"),
    )
}

/// Refuses a machine whose functions have no operations that hold everywhere, with the reason.
fn without_operations(scene: &PlaneScene, reason: &str) -> StudyError {
    scene_error(
        scene,
        format!("no export: {reason}"),
        "several degrees of freedom are exported as the model's own operations, which mechanisms made of dyads have; give exactly one actuator for a table",
        actuator_labels(scene, "drives it"),
    )
}

fn describe(scene: &PlaneScene, loaded: &PlaneScene, model: &Model) -> SeveralFreedomsDescription {
    let mut left_out = left_out(scene, model);
    let units = load_units(loaded.loads.iter().map(|load| load.kind));
    let loads = describe_loads(scene, &units, &scene.loads, &mut left_out);
    let start = scene.motion_start();
    let coordinates = scene.mechanism.actuators.iter().enumerate();
    let coordinates = coordinates.map(|(k, actuator)| {
        if start.laws[k].is_some() {
            let name = &actuator.name;
            left_out.push(format!("the law of {name}: it is a free coordinate here"));
        }
        FreeCoordinate {
            name: actuator.name.clone(),
            is_angle: model.plan().is_angle(k),
            initial: [start.coordinates[k], start.velocities[k]],
        }
    });
    SeveralFreedomsDescription {
        coordinates: coordinates.collect(),
        name: scene.name.clone(),
        title: scene.title.clone(),
        scene_hash: scene.hash(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        loads,
        reactions: named_reactions(scene, model),
        points: point_names(scene),
        left_out,
    }
}

/// Positions around the initial one that the mechanism can reach.
fn positions(machine: &SeveralFreedomsDescription, model: &Model, size: f64) -> Vec<Vec<f64>> {
    // A sequence that fills the square evenly, each coordinate by its own irrational step.
    let spread = |k: usize, i: usize| {
        let step = f64::from(2 + 3 * i as u32 + (i * i) as u32).sqrt();
        2.0 * (0.37 + step * k as f64).fract() - 1.0
    };
    let mut pose = model.plan().pose();
    let mut around = |k: usize, part: f64| -> Option<Vec<f64>> {
        let coordinates = machine.coordinates.iter().enumerate();
        let one = |(i, c): (usize, &FreeCoordinate)| {
            let width = if c.is_angle {
                AROUND[0]
            } else {
                AROUND[1] * size
            };
            c.initial[0] + part * width * spread(k, i)
        };
        let q: Vec<f64> = coordinates.map(one).collect();
        let is_reached = model.plan().positions(&q, &mut pose).is_ok();
        is_reached.then_some(q)
    };
    let mut all: Vec<Vec<f64>> = Vec::with_capacity(MEASURED);
    for k in 0..RECORDED {
        // Next to a limit position only the nearest are reached.
        let near = [0.1, 1e-2, 1e-3].into_iter();
        all.extend(near.filter_map(|part| around(k, part)).take(1));
    }
    all.extend((RECORDED..MEASURED).filter_map(|k| around(k, 1.0)));
    all
}

/// The functions of motion, reactions and positions, in the order of [`SeveralFreedomsExport::code`].
fn functions<T: Scalar>(
    scene: &PlaneScene,
    model: &Model,
    q: &[T],
) -> Result<[Vec<T>; 3], DynamicsError> {
    let n = q.len();
    let rest = vec![T::from_f64(0.0); n];
    let mut workspace = model.workspace();
    let mut state = model.kinematic_state(q, &rest, &mut workspace)?;
    let mut result: InverseDynamics<T> = model.result_buffer();
    let mut reactions = Vec::new();
    let mut m = Vec::new();
    for i in 0..n {
        state.mass_matrix_column(i, &mut result);
        m.extend_from_slice(&result.tau[i..]);
        reactions.extend_from_slice(&result.reactions);
    }
    let mut motion = m;
    for i in 0..n {
        for j in i..n {
            state.christoffel_terms([i, j], &mut result);
            motion.extend_from_slice(&result.tau);
            reactions.extend_from_slice(&result.reactions);
        }
    }
    let mut potentials = Vec::new();
    for load in 0..model.loads().len() {
        state.unit_load_response(load, &mut result)?;
        motion.extend(result.tau.iter().map(|&tau| -tau));
        reactions.extend_from_slice(&result.reactions);
        let potential = state
            .potential(load)
            .filter(|_| model.is_conservative(load));
        potentials.push(potential.unwrap_or(T::from_f64(0.0)));
    }
    motion.extend(potentials);
    let bodies = state.bodies_at(&rest);
    let points = scene.requests.paths.iter().flat_map(|point| {
        let at = bodies.point(point.body, point.at).position;
        [at.x, at.y]
    });
    let positions = points.collect();
    Ok([motion, reactions, positions])
}

/// The operations of all functions, by part.
fn recorded(
    scene: &PlaneScene,
    model: &Model,
    positions: &[Vec<f64>],
) -> Result<[StraightLine; 3], RecordingError<DynamicsError>> {
    let one = |part: usize| {
        record_at(&positions[..RECORDED.min(positions.len())], |q| {
            let mut parts = functions::<RecordedNumber>(scene, model, q)?;
            Ok(std::mem::take(&mut parts[part]))
        })
    };
    Ok([one(0)?, one(1)?, one(2)?])
}
