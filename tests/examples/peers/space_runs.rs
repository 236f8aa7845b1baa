//! The motions in space by Dwell: by each integrator on exact evaluation, and by quadrature.

use super::motion::{
    EXACT, FROM_TEXT, Motion, QUADRATURE, QUADRATURE_ACCURACIES, Stages, min_time,
};
use super::{PERIODS, Run};
use dwell_dynamics::{
    CoordinateMode, DenseOutput, DynamicsError, Machine, MachineOde, Method, OdeState, Options,
    Orbit, OrbitSequence, ReducedState, StepControl, integrate,
};
use dwell_kinetostatics::space::{Load, Model};
use dwell_scene::{Scene, SpaceScene};
use serde_json::Value;
use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

/// A motion as its reference of 25 digits has it, and whether loads act.
fn read_motion(
    (case, loads, turns): (&str, &str, bool),
    folder: &Path,
) -> Result<(Motion, bool), Box<dyn Error>> {
    let reference = std::fs::read_to_string(folder.join(format!("{case}.json")))?;
    let reference: Value = serde_json::from_str(&reference)?;
    let motions = reference["free_motion"].as_array();
    let mut motions = motions.into_iter().flatten();
    let motion = motions.find(|m| m["loads"] == loads).ok_or("no motion")?;
    let number = |of: &Value, key: &str| of[key].as_str().map_or(Ok(0.0), str::parse::<f64>);
    let start = ReducedState {
        t: 0.0,
        q: number(motion, "q0")?,
        q_dot: number(motion, "qdot0")?,
    };
    let known = if turns {
        vec![[
            PERIODS * number(motion, "period_s")?,
            start.q + 2.0 * PI * PERIODS,
        ]]
    } else {
        let states = motion["states"].as_array().ok_or("no states")?;
        let state = |s: &Value| Ok([number(s, "t")?, number(s, "q")?]);
        states
            .iter()
            .map(state)
            .collect::<Result<_, Box<dyn Error>>>()?
    };
    let case = case.to_owned();
    Ok((Motion { case, start, known }, loads != "none"))
}

/// Where the crank is at the known times, from the interpolants of the steps.
fn integrated(
    motion: &Motion,
    machine: &Machine<Model>,
    options: &Options,
) -> Result<Vec<f64>, DynamicsError> {
    let start = OdeState {
        t: 0.0,
        y: vec![motion.start.q, motion.start.q_dot],
    };
    let mut ode = MachineOde::new(machine, 0.0, &start.y)?;
    let (mut angles, mut y) = (Vec::new(), start.y.clone());
    let mut observe = |_: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        while let Some(&[t, _]) = motion.known.get(angles.len()).filter(|[t, _]| *t <= now.t) {
            if t < now.t {
                dense(t, &mut y)?;
            } else {
                y.copy_from_slice(&now.y);
            }
            angles.push(y[0]);
        }
        Ok(StepControl::Continue)
    };
    let end = integrate(&mut ode, &start, Some(motion.end()), options, &mut observe)?;
    end.error.map_or(Ok(angles), Err)
}

/// The same by quadrature, with its rule.
fn quadrature(
    motion: &Motion,
    machine: &Machine<Model>,
    accuracy: f64,
) -> Result<(Vec<f64>, Orbit), DynamicsError> {
    let mut sequence = OrbitSequence::loaded(machine, motion.start)?;
    loop {
        let orbit = sequence.next_orbit(accuracy)?;
        if orbit.is_resolved || orbit.tail < accuracy {
            return Ok((motion.angles(&orbit), orbit));
        }
    }
}

/// The machine without reactions: the motion needs none.
fn compile(scene: &SpaceScene, is_loaded: bool) -> Result<Machine<Model>, Box<dyn Error>> {
    let model = Model::new(&scene.mechanism, &scene.masses, &scene.assembly, &[])?;
    let loads: &[Load] = if is_loaded { &scene.loads } else { &[] };
    Ok(Machine::new(model, loads, vec![CoordinateMode::Free], &[])?)
}

/// All runs of a case.
pub(crate) fn measure(
    case: (&str, &str, bool),
    folder: &Path,
) -> Result<(Vec<Run>, Stages), Box<dyn Error>> {
    let (motion, is_loaded) = read_motion(case, folder)?;
    let file = folder.join(format!("{}.toml", motion.case));
    let text = std::fs::read_to_string(&file)?;
    let name = file.display().to_string();
    let read = || -> Result<_, Box<dyn Error>> {
        match Scene::parse(&name, &text)? {
            Scene::Space(scene) => Ok(scene),
            Scene::Plane(_) => Err("a scene in the plane".into()),
        }
    };
    let scene = read()?;
    let machine = compile(&scene, is_loaded)?;

    let mut runs = Vec::new();
    for method in Method::ALL {
        let run = |options: &Options| integrated(&motion, &machine, options).ok();
        runs.extend(motion.tolerance_runs(EXACT, method, &run));
    }
    let exact_orbit = Orbit::loaded(&machine, motion.start)?;
    let mut points = 0;
    for accuracy in QUADRATURE_ACCURACIES {
        let timed_run = min_time(|| quadrature(&motion, &machine, accuracy))?;
        if timed_run.1.1.points == points {
            continue;
        }
        points = timed_run.1.1.points;
        runs.push(motion.quadrature_run(QUADRATURE, timed_run, &exact_orbit));
        let from_text = || -> Result<_, Box<dyn Error>> {
            Ok(quadrature(
                &motion,
                &compile(&*read()?, is_loaded)?,
                accuracy,
            )?)
        };
        runs.push(motion.quadrature_run(FROM_TEXT, min_time(from_text)?, &exact_orbit));
    }
    let stages = Stages {
        read: min_time(read)?.0,
        build: min_time(|| compile(&scene, is_loaded))?.0,
        table: None,
        case: motion.case,
    };
    Ok((runs, stages))
}
