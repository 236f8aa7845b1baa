//! Mechanisms in space: the thirteen references of `validation/spatial`, made by an independent program with 40 digits, and what
//! must be refused.

mod cases;
mod change_points;
mod couplings;
mod extremes;
mod flyball;
mod friction;
mod friction_in_motion;
mod holding_tubes;
mod hooke_joint;
mod leaving_stops;
mod loads;
mod motions;
mod mutations;
mod oblique;
mod operating_points;
mod planes;
mod points;
mod random_loops;
mod reference;
mod scenes;
mod simulate;
mod stops;
mod sweeps;
mod tilted;
mod unit_runs;

use dwell_geometry::space::{
    Actuator, ActuatorKind, Assembly, Joint, JointKind, Mechanism, Plan, Side, Vec3,
};
use dwell_geometry::{AssemblyError, Body, BodyId, JointId, PositionError, Range, StructureError};
use dwell_kinetostatics::space::{LoadKind, Mass, Model, ModelError};
use dwell_kinetostatics::{ExactModel, InverseDynamics, ReducedModel};
use reference::{Reference, number};
use std::f64::consts::TAU;

const ONE_COORDINATE: [&str; 12] = [
    "bennett",
    "bricard-a04",
    "double-hooke",
    "planar-oblique-4r",
    "planar-oblique-rcsr",
    "rssr-haug",
    "rssr",
    "rsur-haug",
    "rsur",
    "schatz",
    "slider-crank-haug",
    "wobble-plate",
];

/// The largest differences of one mechanism, relative to the largest of its kind.
#[derive(Default)]
struct Differences {
    position: f64,
    velocity: f64,
    acceleration: f64,
    m: f64,
    half_dm: f64,
    w: f64,
    reactions: f64,
    compared: usize,
}

/// Of positions, velocities, accelerations, m, ½m′, w, reactions. What was measured: 8e-15, 2e-15, 4e-15, 5e-15, 6e-15, 2e-13
/// and 7e-14; the last two add large parts of opposite sign.
const ALLOWED: [f64; 7] = [1e-13, 1e-13, 1e-13, 1e-13, 1e-13, 1e-12, 1e-12];

#[test]
fn agrees_with_the_references() {
    for name in ONE_COORDINATE {
        let reference = Reference::read(name);
        let found = differences(&reference);
        let all = [
            found.position,
            found.velocity,
            found.acceleration,
            found.m,
            found.half_dm,
            found.w,
            found.reactions,
        ];
        let compared = found.compared;
        println!(
            "{name}: {} ({compared} reactions)",
            all.map(|d| format!("{d:.0e}")).join(" ")
        );
        // A hundred times what rounding leaves here.
        for (found, allowed) in all.into_iter().zip(ALLOWED) {
            assert!(found < allowed, "{name}: {found:.1e}");
        }
    }
}

fn differences(reference: &Reference) -> Differences {
    let (model, names) = reference.model();
    let mut found = Differences::default();
    let mut work = model.workspace::<f64>();
    let mut pose = model.plan().pose::<f64>();
    let mut out = model.coefficient_buffer::<f64>();
    let gravity = reference
        .gravity()
        .map(|direction| LoadKind::Gravity { direction });
    let mut scale = [0.0_f64; 3];
    let mut wrong = [0.0_f64; 3];
    let samples = reference.samples();
    for sample in samples {
        let q = number(&sample["q"]);
        model
            .reduce(q, &mut work, &mut out)
            .unwrap_or_else(|e| panic!("{} at {q}: {e}", reference.name));
        let mut response = model.result_buffer();
        if let Some(gravity) = &gravity {
            model
                .unit_load_response(&[q], gravity, &mut work, &mut response)
                .expect("a pose");
            let want = number(&sample["w"]["gravity"]);
            found.w = found
                .w
                .max((response.tau[0] + want).abs() / reference.scale_of("w"));
        }
        found.m = found.m.max((out.m / number(&sample["m"]) - 1.0).abs());
        let half_dm = number(&sample["half_dm"]);
        found.half_dm = found
            .half_dm
            .max((out.half_dm - half_dm).abs() / number(&sample["m"]));
        for (k, (name, _)) in names.iter().enumerate() {
            let Some(reaction) = sample["reactions"].get(name) else {
                continue;
            };
            let got = [out.a[k], out.b[k], response.reactions[k]];
            let want = [&reaction["a"], &reaction["b"], &reaction["c"]["gravity"]];
            for i in 0..3 {
                if want[i].is_null() {
                    continue;
                }
                let want = number(want[i]);
                scale[i] = scale[i].max(want.abs());
                if (got[i] - want).abs() > wrong[i] {
                    wrong[i] = (got[i] - want).abs();
                    if wrong[i] > 1e-9 {
                        println!("  {name} {i} at q = {q}: {} for {want}", got[i]);
                    }
                }
                found.compared += 1;
            }
        }
        model.plan().positions(&[q], &mut pose).expect("a pose");
        model.plan().velocities(&[1.0], &mut pose);
        model.plan().accelerations(&[0.0], &mut pose);
        let [p, v, a] = reference.motion_differences(model.plan(), &pose, sample);
        found.position = found.position.max(p);
        found.velocity = found.velocity.max(v);
        found.acceleration = found.acceleration.max(a);
    }
    for i in 0..3 {
        found.reactions = found
            .reactions
            .max(wrong[i] / scale[i].max(f64::MIN_POSITIVE));
    }
    let determined = model
        .determined(&[number(&samples[0]["q"])], &mut work)
        .expect("a pose");
    for (k, (name, _)) in names.iter().enumerate() {
        let open = samples[0]["undetermined"]
            .as_array()
            .expect("a list")
            .iter()
            .any(|u| u == name.as_str());
        assert_eq!(determined[k], !open, "{}: {name}", reference.name);
    }
    found
}

/// T = ∮ √(m/2E) dq of the motions without loads over a whole revolution: the trapezoid rule is exact there to rounding.
#[test]
fn free_motions_have_the_periods_of_the_references() {
    let mut compared = 0;
    for name in ONE_COORDINATE {
        let reference = Reference::read(name);
        let (model, _) = reference.model();
        let free = reference.data["free_motion"].as_array().expect("motions");
        for motion in free.iter().filter(|m| m["loads"] == "none") {
            let reduced = ExactModel::new(model.without_reactions()).expect("one actuator");
            assert_eq!(reduced.range(), Range::Full, "{name}");
            let mut work = reduced.workspace();
            let count = 720;
            let energy = number(&motion["energy_J"]);
            let density = |k: u32| {
                let q = TAU * f64::from(k) / f64::from(count);
                let (m, _) = reduced.inertia(q, &mut work).expect("a pose");
                (m / (2.0 * energy)).sqrt()
            };
            let period = TAU / f64::from(count) * (0..count).map(density).sum::<f64>();
            let wanted = number(&motion["period_s"]);
            assert!(
                (period / wanted - 1.0).abs() < 1e-12,
                "{name}: {period} s for {wanted} s"
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 11);
}

/// ½m″ by dual numbers is the slope of ½m′.
#[test]
fn derivatives_are_exact() {
    for name in ONE_COORDINATE {
        let (model, _) = Reference::read(name).model();
        let reduced = ExactModel::new(model).expect("one actuator");
        let mut work = reduced.workspace();
        let (q, h) = (1.3, 1e-3);
        let mut slope = |q: f64| reduced.inertia(q, &mut work).expect("a pose").1;
        let difference = (8.0 * (slope(q + h) - slope(q - h))
            - (slope(q + 2.0 * h) - slope(q - 2.0 * h)))
            / (12.0 * h);
        let found = reduced.inertia_derivatives(q, &mut work).expect("a pose");
        let scale = found.m + difference.abs();
        assert!(
            (found.half_ddm - difference).abs() < 1e-9 * scale,
            "{name}: {} for {difference}",
            found.half_ddm
        );
    }
}

/// The governor in two coordinates: mass matrix, velocity products, generalised forces of gravity, and all reactions.
#[test]
fn the_governor_agrees_in_two_coordinates() {
    let reference = Reference::read("governor");
    let start = [number(&reference.samples()[0]["beta"]), 0.3];
    let (model, names) = reference.model_at(&start);
    let mut work = model.workspace::<f64>();
    let (mut found, mut second) = (model.result_buffer(), model.result_buffer());
    let gravity = LoadKind::Gravity {
        direction: reference.gravity().expect("gravity"),
    };
    let mut compared = 0;
    for sample in reference.samples() {
        let q = [number(&sample["beta"]), number(&sample["sigma"])];
        let mut check = |key: &str, found: &InverseDynamics<f64>| {
            let forces = &sample["generalised_inertia_forces"];
            let wanted = if key == "gravity" {
                ["beta", "sigma"].map(|k| -number(&sample["w_gravity"][k]))
            } else {
                ["tau_beta", "tau_sigma"].map(|k| number(&forces[k][key]))
            };
            let mut agree = |name: &str, found: f64, wanted: f64| {
                // Measured: 3e-14 of the largest, 136 N.
                let differ = (found - wanted).abs() / (100.0 + wanted.abs());
                assert!(
                    differ < 1e-13,
                    "{q:?} {name} of {key}: {found} for {wanted}"
                );
                compared += 1;
            };
            for (found, wanted) in found.tau.iter().zip(wanted) {
                agree("actuator", *found, wanted);
            }
            for (k, (name, _)) in names.iter().enumerate() {
                if let Some(wanted) = sample["reactions"].get(name) {
                    agree(name, found.reactions[k], number(&wanted[key]));
                }
            }
        };
        let zero = [0.0; 2];
        for (key, speeds, accelerations) in [
            ("b''", zero, [1.0, 0.0]),
            ("s''", zero, [0.0, 1.0]),
            ("b'b'", [1.0, 0.0], zero),
            ("s's'", [0.0, 1.0], zero),
        ] {
            model
                .inverse_dynamics(&q, &speeds, &accelerations, &mut work, &mut found)
                .expect("a pose");
            check(key, &found);
        }
        // What both speeds make together more than each alone: (1, 1) less (1, −1) has it four times, one for each sign twice.
        for (sign, result) in [(1.0, &mut found), (-1.0, &mut second)] {
            model
                .inverse_dynamics(&q, &[1.0, sign], &zero, &mut work, result)
                .expect("a pose");
        }
        let products = found.tau.iter_mut().chain(&mut found.reactions);
        for (value, other) in products.zip(second.tau.iter().chain(&second.reactions)) {
            *value = (*value - other) / 2.0;
        }
        check("b's'", &found);
        model
            .unit_load_response(&q, &gravity, &mut work, &mut found)
            .expect("a pose");
        check("gravity", &found);
    }
    assert_eq!(compared, 900);
}

/// A Bennett linkage with one length wrong by 1e-4 m: least squares converge, but what stays open is seen.
#[test]
fn contradicting_dimensions_are_refused_with_their_gap() {
    let reference = Reference::read("bennett");
    let mut mechanism = reference.mechanism();
    mechanism.joints[2].sides[0].point.x += 1e-4;
    let error = Plan::compile(&mechanism, &reference.assembly(&[1.0]))
        .map(|_| ())
        .expect_err("it does not close");
    let AssemblyError::Inconsistent {
        gap,
        redundant_count,
        ..
    } = error
    else {
        panic!("{error:?}")
    };
    assert!(gap > 1e-6 && gap < 1e-3 && redundant_count > 0, "{gap}");
}

/// The rod between two balls with its centre off their line, or unequal moments of inertia across it: its turn is a second
/// degree of freedom.
#[test]
fn a_rod_whose_mass_couples_its_turn_is_refused() {
    let reference = Reference::read("rssr");
    let mechanism = reference.mechanism();
    let coupler = mechanism
        .bodies
        .iter()
        .position(|b| b.name == "coupler")
        .expect("the coupler");
    let assembly = reference.assembly(&[0.0]);
    let with = |change: fn(&mut Mass)| {
        let mut masses = reference.masses();
        change(&mut masses[coupler]);
        Model::new(&mechanism, &masses, &assembly, &[])
    };
    let idle = with(|_| ())
        .expect("a model")
        .plan()
        .mobility()
        .idle
        .clone();
    assert_eq!(idle.len(), 1);
    assert_eq!(idle[0].body.0, coupler);
    for change in [
        |m: &mut Mass| m.center.y = 1e-3,
        |m: &mut Mass| m.inertia[1] *= 1.001,
    ] {
        let error = with(change).expect_err("its turn is coupled");
        assert_eq!(
            error,
            ModelError::UnbalancedRod {
                body: BodyId(coupler)
            }
        );
    }
}

#[test]
fn wrong_descriptions_are_refused() {
    let reference = Reference::read("slider-crank-haug");
    let compile_at = |change: fn(&mut Mechanism), q: &[f64]| {
        let mut mechanism = reference.mechanism();
        change(&mut mechanism);
        Plan::compile(&mechanism, &reference.assembly(q))
    };
    let compile = |change| compile_at(change, &[0.0]);
    let plan = compile(|_| ()).expect("a plan");
    // Without the slide's joint the slider is free in five ways more.
    let free = compile(|m| drop(m.joints.pop()))
        .map(|_| ())
        .expect_err("free");
    assert!(
        matches!(
            free,
            AssemblyError::Structure(StructureError::UnderActuated { .. })
        ),
        "{free:?}"
    );
    let lost = compile(|m| m.joints.truncate(1))
        .map(|_| ())
        .expect_err("lost");
    assert!(
        matches!(
            lost,
            AssemblyError::Structure(StructureError::NotConnected { .. })
        ),
        "{lost:?}"
    );
    let open = compile(|m| m.joints[1].sides[1].point.x = 0.149)
        .map(|_| ())
        .expect_err("open");
    assert!(
        matches!(open, AssemblyError::NoAssembly { gap, .. } if gap > 0.1),
        "{open:?}"
    );
    // Where the slider is with the crank at zero, along its line through the ground's origin.
    let (mut pose, mechanism) = (plan.pose(), reference.mechanism());
    plan.positions(&[0.0], &mut pose).expect("a pose");
    let [ground, slider] = &mechanism.joints[3].sides;
    let travel = (plan.point(&pose, 3, slider.point) - ground.point).dot(ground.axis);
    let two_drives = compile_at(
        |m| m.actuators.push(Actuator::travel("s", 3)),
        &[0.0, travel],
    )
    .map(|_| ())
    .expect_err("the crank drives it");
    assert!(
        matches!(
            two_drives,
            AssemblyError::Structure(StructureError::OverConstrained {
                redundant_count: 1,
                ..
            })
        ),
        "{two_drives:?}"
    );
    let no_axis = compile(|m| m.joints[0].sides[1].axis = Vec3::ZERO)
        .map(|_| ())
        .expect_err("no axis");
    let odd = compile(|m| m.actuators[0].kind = ActuatorKind::Travel(JointId(0)))
        .map(|_| ())
        .expect_err("no such coordinate");
    for error in [no_axis, odd] {
        assert!(
            matches!(
                error,
                AssemblyError::Structure(StructureError::Malformed { .. })
            ),
            "{error:?}"
        );
    }
}

/// A pendulum that nobody drives, hanging from a crank by a revolute joint: not an idle rotation, but a freedom without an actuator.
#[test]
fn a_pendulum_without_an_actuator_is_refused() {
    let side = Side::default();
    let joint = |name: &str, bodies: [usize; 2]| {
        Joint::new(name, bodies, JointKind::Revolute, [side, side])
    };
    let mechanism = Mechanism {
        bodies: ["ground", "crank", "pendulum"].map(Body::named).into(),
        ground: 0,
        joints: vec![joint("A", [0, 1]), joint("B", [1, 2])],
        actuators: vec![Actuator::angle("q", 0)],
        couplings: Vec::new(),
    };
    let error = Plan::compile(&mechanism, &Assembly::at(&[0.0]))
        .map(|_| ())
        .expect_err("two freedoms");
    assert!(
        matches!(
            error,
            AssemblyError::Structure(StructureError::UnderActuated { .. })
        ),
        "{error:?}"
    );
}

/// A mechanism with a limited range ends at its limit position, and says so beyond: a crank longer than the rod can follow.
#[test]
fn a_range_ends_at_the_limit_position() {
    let reference = Reference::read("slider-crank-haug");
    let mut mechanism = reference.mechanism();
    // The crank of 0.08 m about (0, 0.1, 0.12) and a rod of 0.15 m: it reaches the slider's line only below.
    mechanism.joints[2].sides[0].point.x = 0.0;
    let mut assembly = reference.assembly(&[3.0]);
    assembly.placements[2].position.x = 0.08;
    let plan = Plan::compile(&mechanism, &assembly).expect("a plan");
    let Range::Limited(from, to) = plan.range() else {
        panic!("{:?}", plan.range())
    };
    // The crank pin is 0.15 m from the line: (0.1 − 0.08 sin q)² + (0.12 + 0.08 cos q)² = 0.15².
    let open =
        |q: f64| (0.1 - 0.08 * q.sin()).powi(2) + (0.12 + 0.08 * q.cos()).powi(2) - 0.15 * 0.15;
    for q in [from, to] {
        assert!(open(q).abs() < 1e-8, "{q}: {}", open(q));
    }
    let mut pose = plan.pose::<f64>();
    assert!(plan.positions(&[to - 1e-6], &mut pose).is_ok());
    let error = plan
        .positions(&[to + 1e-3], &mut pose)
        .expect_err("beyond the range");
    assert!(
        matches!(error, PositionError::OutOfRange { .. }),
        "{error:?}"
    );
    assert!(matches!(
        plan.positions(&[f64::NAN], &mut pose),
        Err(PositionError::NotFinite)
    ));
}
