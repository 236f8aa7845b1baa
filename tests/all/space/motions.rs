//! Motions of the references: by quadrature and by integration.

use super::ONE_COORDINATE;
use super::reference::{Reference, number, vector};
use dwell_dynamics::{
    CoordinateMode, Machine, MachineOde, Method, OdeState, OdeSystem, Options, Orbit, ReducedState,
    StepControl, integrate,
};
use dwell_geometry::space::Vec3;
use dwell_kinetostatics::Magnitude;
use dwell_kinetostatics::space::{Load, LoadKind, Model};
use serde_json::Value;

fn machine(reference: &Reference, model: &Model, loads: &Value) -> Machine<Model> {
    let gravity = reference.gravity().filter(|_| loads != "none");
    let load = |g| Load {
        name: "gravity".to_owned(),
        kind: LoadKind::Gravity { direction: g },
        magnitude: Magnitude::Constant(1.0),
    };
    let loads: Vec<Load> = gravity.map(load).into_iter().collect();
    let modes = vec![CoordinateMode::Free; model.plan().actuators()];
    Machine::new(model.without_reactions(), &loads, modes, &[]).expect("a machine")
}

fn energy(machine: &Machine<Model>, y: &[f64]) -> [f64; 2] {
    let mut workspace = machine.workspace();
    let state = machine.evaluate(0.0, y, &mut workspace).expect("a pose");
    state.energy()
}

/// The states at these times, by the method of Dormand and Prince of order 8.
fn integrated(machine: &Machine<Model>, start: &[f64], times: &[f64]) -> Vec<Vec<f64>> {
    let mut ode = MachineOde::new(machine, 0.0, start).expect("a start");
    let mut state = OdeState {
        t: 0.0,
        y: start.to_vec(),
    };
    let options = Options::new(Method::Dop853, 1e-13);
    let at = |&t: &f64| {
        if t > state.t {
            let mut every = |_: &OdeState, _: &OdeState, _: dwell_dynamics::DenseOutput<'_>| {
                Ok(StepControl::Continue)
            };
            let end = integrate(&mut ode, &state, Some(t), &options, &mut every).expect("a motion");
            assert!(end.error.is_none(), "{:?}", end.error);
            state = end.state;
        }
        state.y.clone()
    };
    times.iter().map(at).collect()
}

/// Periods within 1e-12 and states within 1e-9 rad, m and per s by quadrature and by integration, and constant energy.
#[test]
fn motions_of_one_coordinate_agree_with_the_references() {
    let (mut motions, mut largest) = (0, [0.0_f64; 4]);
    for name in ONE_COORDINATE {
        let reference = Reference::read(name);
        let (model, _) = reference.model();
        for motion in reference.data["free_motion"].as_array().expect("motions") {
            let machine = machine(&reference, &model, &motion["loads"]);
            // Without the key: at rest at zero.
            let given = |key: &str| motion.get(key).map_or(0.0, number);
            let start = [given("q0"), given("qdot0")];
            let from = ReducedState {
                t: 0.0,
                q: start[0],
                q_dot: start[1],
            };
            let orbit = Orbit::loaded(&machine, from).unwrap_or_else(|e| panic!("{name}: {e}"));
            let period = number(&motion["period_s"]);
            largest[0] = largest[0].max((orbit.period / period - 1.0).abs());
            let states = motion["states"].as_array().expect("states");
            let times: Vec<f64> = states.iter().map(|s| number(&s["t"])).collect();
            let integrated = integrated(&machine, &start, &times);
            for (state, y) in states.iter().zip(&integrated) {
                let at = orbit.state_at(number(&state["t"]));
                for (k, found) in [(1, [at.q, at.q_dot]), (2, [y[0], y[1]])] {
                    for (found, key) in found.into_iter().zip(["q", "qdot"]) {
                        let wanted = number(&state[key]);
                        largest[k] = largest[k].max((found - wanted).abs() / (1.0 + wanted.abs()));
                    }
                    let apart = points_differ(&reference, &machine, found[0], (state, motion));
                    assert!(apart < 1e-9, "{name}: a point is {apart:.1e} m off");
                }
            }
            let energies = [&start[..], &integrated[integrated.len() - 1]];
            let [first, last] = energies.map(|y| energy(&machine, y));
            let scale = last[0].abs() + last[1].abs();
            let drift = (first[0] + first[1] - last[0] - last[1]).abs() / scale;
            println!("{name}: energy {drift:.0e}");
            if name == "bricard-a04" {
                assert!(drift < 1e-12, "A04: energy {drift:.1e}");
            }
            largest[3] = largest[3].max(drift);
            motions += 1;
        }
    }
    println!("{motions} motions: {largest:?}");
    assert_eq!(motions, 17);
    // Measured: 2e-15, 3e-14, 1e-10 and 2e-10, the last two by steps of tolerance 1e-13: those of the wobble plate are long.
    for (found, allowed) in largest.into_iter().zip([1e-13, 1e-12, 1e-9, 1e-9]) {
        assert!(found < allowed, "{largest:?}");
    }
}

/// How far the points of a reference's state are from those at a coordinate, m.
fn points_differ(
    reference: &Reference,
    machine: &Machine<Model>,
    q: f64,
    (state, motion): (&Value, &Value),
) -> f64 {
    let plan = machine.model().plan();
    let mut pose = plan.pose();
    plan.positions(&[q], &mut pose).expect("a pose");
    let mechanism = reference.mechanism();
    let mut apart = 0.0_f64;
    for joint in &mechanism.joints {
        if let Some(wanted) = state.get(&joint.name) {
            let found = plan.point(&pose, joint.bodies[0].0, joint.sides[0].point);
            apart = apart.max((found - vector(wanted)).norm());
        }
    }
    if let (Some(wanted), Some(track)) = (state.get("point"), motion["track"].as_array()) {
        let body = mechanism
            .bodies
            .iter()
            .position(|b| track[0] == b.name.as_str());
        let at: Vec3 = vector(&track[1]);
        let found = plan.point(&pose, body.expect("a body"), at);
        apart = apart.max((found - vector(wanted)).norm());
    }
    apart
}

/// The governor, free in both coordinates.
#[test]
fn the_governor_moves_as_its_reference() {
    let reference = Reference::read("governor");
    let beta = number(&reference.samples()[0]["beta"]);
    let (model, _) = reference.model_at(&[beta, 0.3]);
    let machine = machine(&reference, &model, &Value::Null);
    let mut compared = 0;
    for motion in reference.data["free_motion"].as_array().expect("motions") {
        if !motion["case"]
            .as_str()
            .expect("a case")
            .starts_with("free spin")
        {
            continue;
        }
        let start = [beta, 0.3, 0.0, number(&motion["omega0"])];
        let states = motion["states"].as_array().expect("states");
        let times: Vec<f64> = states.iter().map(|s| number(&s["t"])).collect();
        for (state, y) in states.iter().zip(integrated(&machine, &start, &times)) {
            for (found, key) in [(y[0], "beta"), (y[2], "betadot"), (y[3], "spin")] {
                let wanted = number(&state[key]);
                assert!(
                    (found - wanted).abs() < 1e-9 * (1.0 + wanted.abs()),
                    "{key} at {} s: {found} for {wanted}",
                    state["t"]
                );
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 30);
}

/// The Jacobian by dual numbers is the slope of the right-hand side.
#[test]
fn the_jacobian_is_that_of_the_equation_of_motion() {
    let reference = Reference::read("bricard-a04");
    let (model, _) = reference.model();
    let machine = machine(&reference, &model, &Value::Null);
    let mut ode = MachineOde::new(&machine, 0.0, &[0.8, 1.7]).expect("a start");
    let (y, h) = ([0.8, 1.7], 1e-4);
    let (mut jacobian, mut rates) = ([0.0; 4], [[0.0; 2]; 4]);
    ode.jacobian(0.0, &y, &mut jacobian).expect("a pose");
    for column in 0..2 {
        for (rates, steps) in rates.iter_mut().zip([-2.0, -1.0, 1.0, 2.0]) {
            let mut moved = y;
            moved[column] += steps * h;
            ode.rhs(0.0, &moved, rates).expect("a pose");
        }
        for row in 0..2 {
            let slope = (rates[0][row] - 8.0 * rates[1][row] + 8.0 * rates[2][row] - rates[3][row])
                / (12.0 * h);
            let exact = jacobian[2 * row + column];
            assert!(
                (slope - exact).abs() < 1e-9 * (1.0 + exact.abs()),
                "{slope} for {exact}"
            );
        }
    }
}
