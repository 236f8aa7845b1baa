//! A scene as plain data for export, and what of it cannot be exported.

use super::sampler::SceneSampler;
use crate::explain::{NamedScene, StudyError, explain_machine, not_one_actuator, scene_error};
use crate::models::{build_machine, determinate_model, initial_reduced_state, with_drive_loads};
use dwell_dynamics::{TabulatedMachine, TabulationError};
use dwell_export::{
    Domain, LoadDescription, LoadEffect, MachineDescription, Motor, ReferenceSizes,
};
use dwell_geometry::{ActuatorId, Range};
use dwell_kinetostatics::{
    Coefficients, DriveKind, Load, LoadKind, Magnitude, Model, Signal, TableDomain,
};
use dwell_scene::{Scene, SceneFile, SceneLocation};
use std::f64::consts::TAU;

/// Part of a limited range that is left out at each end, where everything grows.
const END_MARGIN: f64 = 0.02;

/// A scene whose machine can be exported.
pub(crate) struct ExportedScene<'a> {
    pub(crate) scene: &'a Scene,
    /// The scene with the loads of its drives.
    pub(crate) loaded: Scene,
    /// Its model with the requested reactions; every constant magnitude is one.
    pub(crate) model: Model,
    pub(crate) description: MachineDescription,
}

impl<'a> ExportedScene<'a> {
    /// Compiles what a scene requests, over an interval in its unit if one is given.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where the scene has several freedoms, dry friction, end stops or change points.
    pub(crate) fn new(scene: &'a Scene, interval: Option<(f64, f64)>) -> Result<Self, StudyError> {
        if scene.mechanism.actuators.len() != 1 {
            return Err(not_one_actuator(scene));
        }
        let (loaded, model) = with_unit_loads(scene)?;
        let plan = model.plan();
        let domain = domain(scene, plan.range(), plan.is_angle(0), interval)?;
        reject_change_points(scene, domain)?;
        let description = describe(scene, &loaded, &model, domain);
        Ok(Self {
            scene,
            loaded,
            model,
            description,
        })
    }

    /// The exact functions.
    pub(crate) fn sampler(&self) -> SceneSampler<'_> {
        SceneSampler::new(self)
    }
}

/// A scene with the loads of its drives, and its model with the requested reactions, in which every constant magnitude is one.
///
/// # Errors
/// [`StudyError::Scene`] where the scene has dry friction, separating forces or end stops.
pub(super) fn with_unit_loads(scene: &Scene) -> Result<(Scene, Model), StudyError> {
    reject_contacts(scene)?;
    let loaded = with_drive_loads(scene)?;
    let mut unit_loads = loaded.loads.clone();
    for load in &mut unit_loads {
        if matches!(load.magnitude, Magnitude::Constant(_)) {
            load.magnitude = Magnitude::Constant(1.0);
        }
    }
    let model = determinate_model(scene)?
        .with_loads(unit_loads)
        .map_err(|e| explain_machine(scene, e.into()))?;
    Ok((loaded, model))
}

/// Rejects dry friction, in the plane or in space, by the index of its load.
pub(crate) fn reject_friction(
    scene: &impl NamedScene,
    load: Option<usize>,
) -> Result<(), StudyError> {
    let Some(load) = load else {
        return Ok(());
    };
    let name = scene.load_name(load).unwrap_or_default();
    Err(scene_error(
        scene,
        format!(
            "no export: {name} is dry friction, which depends on the reactions and holds at rest"
        ),
        "leave the friction out, or put a damper in its place; `dwell simulate` computes it",
        [(SceneLocation::Load(load), "dry friction")],
    ))
}

/// Rejects what has no function of the coordinate alone.
fn reject_contacts(scene: &Scene) -> Result<(), StudyError> {
    let friction = scene.loads.iter().position(|l| l.friction().is_some());
    reject_friction(scene, friction)?;
    if let Some(load) = scene
        .loads
        .iter()
        .position(|l| l.pressure_angle().is_some())
    {
        return Err(scene_error(
            scene,
            "no export: the separating force of teeth depends on a reaction",
            "leave `pressure-angle` out: the motion does not depend on it",
            [(SceneLocation::Load(load), "separating force")],
        ));
    }
    reject_stops(scene)
}

/// Rejects end stops, in the plane or in space.
pub(crate) fn reject_stops(scene: &impl NamedScene) -> Result<(), StudyError> {
    if scene.stops().is_empty() {
        return Ok(());
    }
    Err(scene_error(
        scene,
        "no export: the scene has end stops, at which the motion jumps",
        "leave [stops] out, and watch the coordinate in the program that uses the export",
        [(SceneLocation::Stop(0), "an end stop")],
    ))
}

/// Rejects a machine that crosses change points, beyond which another branch follows.
fn reject_change_points(scene: &Scene, domain: Domain) -> Result<(), StudyError> {
    let Some(spec) = scene.motion.as_ref() else {
        return Ok(());
    };
    let machine = build_machine(scene, spec, &[])?;
    if machine.free().len() != 1 {
        return Ok(());
    }
    // The coarsest table is enough to know.
    let inner = TableDomain::Between(domain.from, domain.to);
    match TabulatedMachine::new(&machine, 1e-2, inner) {
        Err(TabulationError::ChangePoints) => Err(scene_error(
            scene,
            "no export: the machine crosses change points, beyond which another branch follows",
            "give an interval between two change points with --from and --until, or change a length",
            [(
                SceneLocation::Actuator(ActuatorId(0)),
                "over this coordinate",
            )],
        )),
        _ => Ok(()),
    }
}

/// The interval of the coordinate: what is given in the scene's unit, a period, or the range without its ends.
///
/// # Errors
/// [`StudyError::Scene`] for an interval outside the range, and for a coordinate without ends.
pub(crate) fn domain(
    scene: &SceneFile,
    range: Range,
    is_angle: bool,
    interval: Option<(f64, f64)>,
) -> Result<Domain, StudyError> {
    let limited = |from, to| Domain {
        from,
        to,
        revolutions: 0,
    };
    if let Some((from, to)) = interval {
        let [from, to] = [from, to].map(|written| scene.to_si(written, is_angle));
        let inside = |(lower, upper)| lower <= from && to <= upper;
        if from < to && range.limits().is_none_or(inside) {
            return Ok(limited(from, to));
        }
        let message = match range.limits() {
            Some((lower, upper)) if from < to => {
                let [(lower, unit), (upper, _)] =
                    [lower, upper].map(|q| scene.to_scene_unit(q, is_angle));
                format!("the range is from {lower} to {upper} {unit} only")
            }
            _ => "the interval must end beyond its beginning".to_owned(),
        };
        return Err(scene_error(
            scene,
            message,
            "give --from and --until within the range, in the scene's unit",
            [(
                SceneLocation::Actuator(ActuatorId(0)),
                "over this coordinate",
            )],
        ));
    }
    Ok(match (range, range.period()) {
        (_, Some(period)) => Domain {
            from: 0.0,
            to: period,
            revolutions: (period / TAU).round() as u32,
        },
        (Range::Unbounded, None) if is_angle => limited(0.0, TAU),
        (range, None) => match range.limits() {
            Some((from, to)) => {
                let margin = END_MARGIN * (to - from);
                limited(from + margin, to - margin)
            }
            None => {
                return Err(scene_error(
                    scene,
                    "no export: the coordinate has no ends",
                    "give the interval with --from and --until",
                    [(SceneLocation::Actuator(ActuatorId(0)), "this coordinate")],
                ));
            }
        },
    })
}

fn describe(scene: &Scene, loaded: &Scene, model: &Model, domain: Domain) -> MachineDescription {
    let is_angle = model.plan().is_angle(0);
    let mechanism = &scene.mechanism;
    let reactions = model.reactions().iter();
    let reactions = reactions.map(|&r| (mechanism.reaction_name(r), r.component.unit()));
    let mut left_out = left_out(scene, model);
    let loads = describe_loads(scene, loaded, &mut left_out);
    let points = scene.requests.paths.iter();
    let points = points.map(|p| format!("{}.{}", mechanism.body_name(p.body), p.name));
    MachineDescription {
        name: scene.name.clone(),
        title: scene.title.clone(),
        scene_hash: scene.hash(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        coordinate: mechanism.actuators[0].name.clone(),
        is_angle,
        domain,
        initial: initial(scene, domain),
        points: points.collect(),
        sizes: reference_sizes(scene, loaded, model, domain),
        reactions: reactions.collect(),
        loads,
        left_out,
    }
}

/// The loads, and the drives behind them.
pub(super) fn describe_loads(
    scene: &Scene,
    loaded: &Scene,
    left_out: &mut Vec<String>,
) -> Vec<LoadDescription> {
    let drives = scene.drives.iter().map(|drive| &drive.kind);
    let kinds = std::iter::repeat_n(None, scene.loads.len()).chain(drives.map(Some));
    let loads = loaded.loads.iter().zip(kinds).map(|(load, drive)| {
        let (effect, unit) = match drive {
            Some(drive) => {
                let is_couple = matches!(load.kind, LoadKind::Torque { .. });
                let force = if is_couple { "N m" } else { "N" };
                drive_effect((&load.name, force), drive, left_out)
            }
            None => {
                left_out.extend(varying_input("the load", &load.name, &load.magnitude));
                load_effect(load)
            }
        };
        LoadDescription {
            name: load.name.clone(),
            effect,
            unit,
        }
    });
    loads.collect()
}

/// Sentences about what is not exported.
pub(super) fn left_out(scene: &Scene, model: &Model) -> Vec<String> {
    let mut all = Vec::new();
    let known = model.reactions();
    let missing = scene
        .requests
        .reactions
        .iter()
        .filter(|r| !known.contains(r));
    let missing: Vec<_> = missing.map(|&r| scene.mechanism.reaction_name(r)).collect();
    if !missing.is_empty() {
        all.push(format!(
            "the statically indeterminate reactions {}",
            missing.join(", ")
        ));
    }
    let spec = scene.motion.as_ref();
    if spec.is_some_and(|spec| !spec.events.is_empty()) {
        all.push("the events of [motion]".to_owned());
    }
    all
}

/// q and q̇ at the start, within the interval.
fn initial(scene: &Scene, domain: Domain) -> [f64; 2] {
    let assembly = scene.assembly.coordinates.first().copied().unwrap_or(0.0);
    let [q, q_dot] = match initial_reduced_state(scene) {
        Some(state) => [state.q, state.q_dot],
        None => [assembly, 0.0],
    };
    let q = match domain.revolutions {
        0 => q.clamp(domain.from, domain.to),
        _ => q.rem_euclid(domain.to),
    };
    [q, q_dot]
}

/// What m, the forces and lengths come to.
fn reference_sizes(scene: &Scene, loaded: &Scene, model: &Model, domain: Domain) -> ReferenceSizes {
    let length = scene.mechanism.size();
    let mut workspace = model.workspace::<f64>();
    let mut found: Coefficients = model.coefficient_buffer();
    let mut inertia = 0.0_f64;
    for part in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let q = domain.from + part * domain.length();
        // A position that cannot be reached is reported when it is sampled.
        if model.reduce(q, &mut workspace, &mut found).is_ok() {
            inertia = inertia.max(found.m.abs());
        }
    }
    let mass: f64 = scene.masses.iter().map(|mass| mass.mass).sum();
    let force = |load: &Load| match load.kind {
        LoadKind::Gravity { .. } => mass,
        LoadKind::Force { .. }
        | LoadKind::PointToPointForce { .. }
        | LoadKind::SlideForce(_)
        | LoadKind::Damper { .. }
        | LoadKind::SlideDamper(_)
        | LoadKind::SeparatingForce(_) => 1.0,
        LoadKind::Torque { .. }
        | LoadKind::TorsionSpring { .. }
        | LoadKind::RotationalDamper { .. } => 1.0 / length,
        LoadKind::Spring { .. } => length,
    };
    let positive = |value: f64| {
        let usable = value.is_finite() && value > 0.0;
        if usable { value } else { 1.0 }
    };
    ReferenceSizes {
        inertia: positive(inertia),
        length: positive(length),
        unit_loads: loaded.loads.iter().map(|l| positive(force(l))).collect(),
    }
}

/// How a load acts, and the unit of its magnitude.
fn load_effect(load: &Load) -> (LoadEffect, &'static str) {
    let unit = match load.kind {
        LoadKind::Gravity { .. } => "m/s2",
        LoadKind::Force { .. }
        | LoadKind::PointToPointForce { .. }
        | LoadKind::SlideForce(_)
        | LoadKind::SeparatingForce(_) => "N",
        LoadKind::Torque { .. } => "N m",
        LoadKind::Spring { .. } => "N/m",
        LoadKind::TorsionSpring { .. } => "N m/rad",
        LoadKind::Damper { .. } | LoadKind::SlideDamper(_) => "N s/m",
        LoadKind::RotationalDamper { .. } => "N m s/rad",
    };
    let is_damper = matches!(
        load.kind,
        LoadKind::Damper { .. } | LoadKind::SlideDamper(_) | LoadKind::RotationalDamper { .. }
    );
    let effect = magnitude_effect(&load.magnitude, is_damper, load.is_conservative());
    (effect, unit)
}

/// How a magnitude acts: as a parameter if it is a constant, else as an input.
pub(crate) fn magnitude_effect<C>(
    magnitude: &Magnitude<C>,
    is_damper: bool,
    is_conservative: bool,
) -> LoadEffect {
    let initial = value_at_start(magnitude);
    match (magnitude, is_damper) {
        (Magnitude::Constant(damping), true) => LoadEffect::Damper { damping: *damping },
        (Magnitude::Constant(magnitude), false) if is_conservative => LoadEffect::Conservative {
            magnitude: *magnitude,
        },
        (Magnitude::Constant(magnitude), false) => LoadEffect::Constant {
            magnitude: *magnitude,
        },
        (_, true) => LoadEffect::VariableDamper { initial },
        (_, false) => LoadEffect::Input { initial },
    }
}

/// What an export leaves out of a magnitude that is no constant.
pub(crate) fn varying_input<C>(kind: &str, name: &str, magnitude: &Magnitude<C>) -> Option<String> {
    let constant = matches!(magnitude, Magnitude::Constant(_));
    (!constant).then(|| format!("how {kind} {name} varies: its magnitude is an input"))
}

/// How a drive acts on a coordinate with this unit of force, and the unit of its input.
pub(crate) fn drive_effect<C>(
    (name, force): (&str, &'static str),
    drive: &DriveKind<C>,
    left_out: &mut Vec<String>,
) -> (LoadEffect, &'static str) {
    let initial = value_at_start(drive.input());
    if !matches!(drive, DriveKind::SpeedController(_)) {
        left_out.extend(varying_input("the drive", name, drive.input()));
    }
    match drive {
        DriveKind::AppliedForce(_) => (LoadEffect::Input { initial }, force),
        DriveKind::Motor(motor) => {
            let motor = Motor {
                torque_constant: motor.torque_constant,
                resistance: motor.resistance,
                inductance: motor.inductance,
                gear_ratio: motor.gear_ratio,
                rotor_inertia: motor.rotor_inertia,
                initial_voltage: initial,
            };
            (LoadEffect::Motor(motor), "V")
        }
        DriveKind::SpeedController(_) => {
            left_out.push(format!(
                "the speed controller {name}: what it applies is an input"
            ));
            (LoadEffect::Input { initial: 0.0 }, force)
        }
    }
}

/// The value of a magnitude at t = 0, where it depends on nothing else; else zero.
fn value_at_start<C>(magnitude: &Magnitude<C>) -> f64 {
    match magnitude {
        Magnitude::Constant(value) => *value,
        Magnitude::Law(Signal::Time, law) => {
            let [value, ..] = law.eval(0.0);
            if value.is_finite() { value } else { 0.0 }
        }
        Magnitude::Law(Signal::Value(_) | Signal::Velocity(_), _)
        | Magnitude::Expression(..)
        | Magnitude::Function(..)
        | Magnitude::Friction(_)
        | Magnitude::Separating(_)
        | Magnitude::External(_) => 0.0,
    }
}
