//! A scene as plain data for export, and the parts that cannot be exported.

use super::OVER_COORDINATE;
use crate::explain::{NamedScene, StudyError, explain_machine, not_one_actuator, scene_error};
use crate::machines::{CoordinateOf, MachineScene};
use crate::models::{build_machine, determinate_model, with_drive_loads};
use dwell_dynamics::{TabulatedMachine, TabulationError};
use dwell_export::{
    Domain, LoadDescription, LoadEffect, MachineDescription, Motor, ReferenceSizes, Resistance,
};
use dwell_geometry::{ActuatorId, Range};
use dwell_kinetostatics::{
    Coefficients, DriveKind, Load, LoadShape, Magnitude, Model, Signal, Strength, TableDomain,
};
use dwell_scene::{FreeMotionSpec, PlaneScene, SceneFile, SceneLocation};
use std::f64::consts::TAU;

/// Part of a limited range that is left out at each end, where everything grows.
const END_MARGIN: f64 = 0.02;

/// A scene whose machine can be exported.
pub(crate) struct ExportedScene<'a> {
    pub(crate) scene: &'a PlaneScene,
    /// The scene with the loads of its drives.
    pub(crate) loaded: PlaneScene,
    /// Its model with the requested reactions; every constant magnitude is 1.
    pub(crate) model: Model,
    pub(crate) description: MachineDescription,
}

impl<'a> ExportedScene<'a> {
    /// Compiles the requests of a scene, over an interval in its unit if one is given.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the scene has several freedoms, dry friction, end stops or change points.
    pub(crate) fn new(
        scene: &'a PlaneScene,
        interval: Option<(f64, f64)>,
    ) -> Result<Self, StudyError> {
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
}

/// A scene with the loads of its drives, and its model with the requested reactions, in which every constant magnitude is one.
///
/// # Errors
/// [`StudyError::Scene`] where the scene has dry friction, separating forces or end stops.
pub(super) fn with_unit_loads(scene: &PlaneScene) -> Result<(PlaneScene, Model), StudyError> {
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
        format!("no export: {name} is dry friction, which depends on the reactions"),
        "leave the friction out, or put a damper in its place; `dwell simulate` computes it",
        [(SceneLocation::Load(load), "dry friction")],
    ))
}

/// Rejects contacts, because their forces are not functions of the coordinate alone.
fn reject_contacts(scene: &PlaneScene) -> Result<(), StudyError> {
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
fn reject_change_points(scene: &PlaneScene, domain: Domain) -> Result<(), StudyError> {
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
            [OVER_COORDINATE],
        )),
        _ => Ok(()),
    }
}

/// The interval of the coordinate: the given one in the scene's unit, a period, or the range without its ends.
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
            _ => "the end of the interval must be greater than its beginning".to_owned(),
        };
        return Err(scene_error(
            scene,
            message,
            "give --from and --until within the range, in the scene's unit",
            [OVER_COORDINATE],
        ));
    }
    if let Some(period) = range.period() {
        return Ok(Domain {
            from: 0.0,
            to: period,
            revolutions: (period / TAU).round() as u32,
        });
    }
    match range.limits() {
        Some((from, to)) => {
            let margin = END_MARGIN * (to - from);
            Ok(limited(from + margin, to - margin))
        }
        None if is_angle && range == Range::Unbounded => Ok(limited(0.0, TAU)),
        None => Err(scene_error(
            scene,
            "no export: the coordinate has no ends",
            "give the interval with --from and --until",
            [(SceneLocation::Actuator(ActuatorId(0)), "this coordinate")],
        )),
    }
}

fn describe(
    scene: &PlaneScene,
    loaded: &PlaneScene,
    model: &Model,
    domain: Domain,
) -> MachineDescription {
    let mut left_out = left_out(scene, model);
    let units = load_units(loaded.loads.iter().map(|load| load.kind));
    let loads = describe_loads(scene, &units, &scene.loads, &mut left_out);
    let mut workspace = model.workspace::<f64>();
    let mut found: Coefficients = model.coefficient_buffer();
    // A position that cannot be reached is reported when it is sampled.
    let inertias = parts_of(domain).into_iter().filter_map(|q| {
        model.reduce(q, &mut workspace, &mut found).ok()?;
        Some(found.m)
    });
    let mass = scene.masses.iter().map(|mass| mass.mass).sum();
    let sizes = reference_sizes(inertias, mass, scene.mechanism.size(), &units);
    MachineDescription {
        points: point_names(scene),
        reactions: named_reactions(scene, model),
        loads,
        left_out,
        ..machine_of(scene, domain, sizes)
    }
}

/// A machine over an interval, without reactions, loads and points.
pub(crate) fn machine_of(
    scene: &impl MachineScene,
    domain: Domain,
    sizes: ReferenceSizes,
) -> MachineDescription {
    let (coordinate, is_angle) = scene.actuator(0).unwrap_or_default();
    let start = scene.motion_start();
    let [q, q_dot] =
        [start.coordinates, start.velocities].map(|of| of.first().copied().unwrap_or(0.0));
    let q = match domain.revolutions {
        0 => q.clamp(domain.from, domain.to),
        _ => q.rem_euclid(domain.to),
    };
    MachineDescription {
        name: scene.name.clone(),
        title: scene.title.clone(),
        scene_hash: scene.hash(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        coordinate: coordinate.to_owned(),
        is_angle,
        domain,
        initial: [q, q_dot],
        loads: Vec::new(),
        reactions: Vec::new(),
        points: Vec::new(),
        sizes,
        left_out: Vec::new(),
    }
}

/// Names and units of the reactions of a model.
pub(super) fn named_reactions(scene: &PlaneScene, model: &Model) -> Vec<(String, &'static str)> {
    let reactions = model.reactions().iter();
    let named = reactions.map(|&r| (scene.mechanism.reaction_name(r), r.component.unit()));
    named.collect()
}

/// The names of the points whose positions are exported.
pub(super) fn point_names(scene: &PlaneScene) -> Vec<String> {
    let points = scene.requests.paths.iter();
    let named = points.map(|p| format!("{}.{}", scene.mechanism.body_name(p.body), p.name));
    named.collect()
}

/// The loads, followed by the drives, with the units of all of them.
pub(crate) fn describe_loads<S: MachineScene, K: LoadShape>(
    scene: &S,
    units: &[LoadUnit],
    loads: &[Load<K, CoordinateOf<S>>],
    left_out: &mut Vec<String>,
) -> Vec<LoadDescription> {
    let mut all = Vec::new();
    for (load, &(unit, law)) in loads.iter().zip(units) {
        left_out.extend(varying_input("the load", &load.name, &load.magnitude));
        all.push(LoadDescription {
            name: load.name.clone(),
            effect: magnitude_effect(load, law),
            unit,
        });
    }
    for (drive, &(force, _)) in scene.drives().iter().zip(&units[loads.len()..]) {
        let (effect, unit) = drive_effect(&drive.name, force, &drive.kind, left_out);
        let name = drive.name.clone();
        all.push(LoadDescription { name, effect, unit });
    }
    all
}

/// Sentences about the parts that are not exported.
pub(super) fn left_out(scene: &PlaneScene, model: &Model) -> Vec<String> {
    let known = model.reactions();
    let requested = scene.requests.reactions.iter();
    let missing = requested.filter(|r| !known.contains(r));
    let missing = missing.map(|&r| scene.mechanism.reaction_name(r));
    missing_parts(missing, scene.motion.as_ref())
}

/// Sentences about reactions, and about the events of a motion.
pub(crate) fn missing_parts<C, R>(
    reactions: impl Iterator<Item = String>,
    motion: Option<&FreeMotionSpec<C, R>>,
) -> Vec<String> {
    let reactions: Vec<String> = reactions.collect();
    let mut all = Vec::new();
    if !reactions.is_empty() {
        all.push(format!(
            "the statically indeterminate reactions {}",
            reactions.join(", ")
        ));
    }
    if motion.is_some_and(|spec| !spec.events.is_empty()) {
        all.push("the events of [motion]".to_owned());
    }
    all
}

/// Positions at which the size of the inertia is evaluated.
pub(crate) fn parts_of(domain: Domain) -> [f64; 5] {
    [0.1, 0.3, 0.5, 0.7, 0.9].map(|part| domain.from + part * domain.length())
}

/// What m, the forces and lengths come to, from inertias, the mass (kg) and the size (`length`, m) of a mechanism, and the units of loads.
pub(crate) fn reference_sizes(
    inertias: impl Iterator<Item = f64>,
    mass: f64,
    length: f64,
    units: &[LoadUnit],
) -> ReferenceSizes {
    let positive = |value: f64| {
        let usable = value.is_finite() && value > 0.0;
        if usable { value } else { 1.0 }
    };
    let force = |(unit, _): &LoadUnit| match *unit {
        "m/s2" => mass,
        "N m" | "N m/rad" | "N m s/rad" | "N m s2/rad2" => 1.0 / length,
        "N/m" => length,
        // At unit speed.
        "N s2/m2" => length * length,
        _ => 1.0,
    };
    ReferenceSizes {
        inertia: positive(inertias.fold(0.0_f64, |max, m| max.max(m.abs()))),
        length: positive(length),
        unit_loads: units.iter().map(|unit| positive(force(unit))).collect(),
    }
}

/// The unit of a load's magnitude, and its law.
pub(crate) type LoadUnit = (&'static str, Strength);

/// The units of loads, including drives.
pub(crate) fn load_units<K: LoadShape>(kinds: impl Iterator<Item = K>) -> Vec<LoadUnit> {
    kinds.map(|kind| (kind.unit(), kind.strength())).collect()
}

/// The effect of a load: by a parameter if its magnitude is a constant, otherwise by an input.
fn magnitude_effect<K: LoadShape, C>(load: &Load<K, C>, law: Strength) -> LoadEffect {
    let resistance = match law {
        Strength::Direct | Strength::Elastic { .. } => None,
        Strength::Viscous => Some(Resistance::Linear),
        Strength::Quadratic => Some(Resistance::Quadratic),
    };
    let initial = value_at_start(&load.magnitude);
    match (&load.magnitude, resistance) {
        (&Magnitude::Constant(damping), Some(law)) => LoadEffect::Damper { damping, law },
        (&Magnitude::Constant(magnitude), None) if load.is_conservative() => {
            LoadEffect::Conservative { magnitude }
        }
        (&Magnitude::Constant(magnitude), None) => LoadEffect::Constant { magnitude },
        (_, Some(law)) => LoadEffect::VariableDamper { initial, law },
        (_, None) => LoadEffect::Input { initial },
    }
}

/// A sentence on the variation of a magnitude, which the export omits.
fn varying_input<C>(kind: &str, name: &str, magnitude: &Magnitude<C>) -> Option<String> {
    let constant = matches!(magnitude, Magnitude::Constant(_));
    (!constant).then(|| format!("how {kind} {name} varies: its magnitude is an input"))
}

/// How a drive acts on a coordinate with this unit of force, and the unit of its input.
fn drive_effect<C>(
    name: &str,
    force: &'static str,
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

/// The value of a constant magnitude, or of a law of time at t = 0; otherwise zero.
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
