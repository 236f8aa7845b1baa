//! Mechanisms in space: the thirteen references of `validation/spatial`, made by an independent program with 40 digits, and what
//! must be refused.

mod reference;

use dwell_geometry::space::{ActuatorKind, Mechanism, Plan};
use dwell_geometry::{AssemblyError, BodyId, JointId, PositionError, Range, StructureError};
use dwell_kinetostatics::ReducedModel;
use dwell_kinetostatics::space::{ExactModel, LoadKind, Mass, Model, ModelError};
use reference::{Reference, number};
use serde_json::Value;
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
        let largest = all.into_iter().fold(0.0, f64::max);
        let compared = found.compared;
        println!(
            "{name}: {} ({compared} reactions)",
            all.map(|d| format!("{d:.0e}")).join(" ")
        );
        assert!(largest < 1e-12, "{name}: {largest:.1e}");
    }
}

fn differences(reference: &Reference) -> Differences {
    let (model, names) = reference.model();
    let mut found = Differences::default();
    let mut work = model.workspace::<f64>();
    let mut pose = model.plan().pose::<f64>();
    let mut out = model.coefficient_buffer::<f64>();
    let gravity = reference.gravity().map(LoadKind::Gravity);
    let mut scale = [0.0_f64; 3];
    let mut wrong = [0.0_f64; 3];
    let samples = reference.samples();
    for sample in samples {
        let q = number(&sample["q"]);
        model
            .reduce(q, &mut work, &mut out)
            .unwrap_or_else(|e| panic!("{} at {q}: {e}", reference.name));
        let (mut w, mut c) = ([0.0], vec![0.0; names.len()]);
        if let Some(gravity) = &gravity {
            model
                .unit_load_response(&[q], gravity, &mut work, &mut w, &mut c)
                .expect("a pose");
            let want = number(&sample["w"]["gravity"]);
            found.w = found.w.max((w[0] - want).abs() / reference.scale_of("w"));
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
            let got = [out.a[k], out.b[k], c[k]];
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

/// The governor's mass matrix and the forces of its Christoffel terms, in two coordinates.
#[test]
fn the_governor_has_the_inertia_of_its_two_coordinates() {
    let reference = Reference::read("governor");
    let start = [number(&reference.samples()[0]["beta"]), 0.3];
    let model = Model::new(
        &reference.mechanism(),
        &reference.masses(),
        &reference.assembly(&start),
        &[],
    );
    let model = model.expect("a model");
    let mut work = model.workspace::<f64>();
    let mut tau = [0.0; 2];
    for sample in reference.samples() {
        let q = [number(&sample["beta"]), number(&sample["sigma"])];
        let mut check = |speeds: [f64; 2], accelerations: [f64; 2], wanted: [&Value; 2]| {
            model
                .inverse_dynamics(&q, &speeds, &accelerations, &mut work, &mut tau)
                .expect("a pose");
            for (tau, wanted) in tau.iter().zip(wanted) {
                let wanted = number(wanted);
                assert!(
                    (tau - wanted).abs() < 1e-12 * (10.0 + wanted.abs()),
                    "{q:?}: {tau} for {wanted}"
                );
            }
        };
        let of = |key: &str| {
            let forces = &sample["generalised_inertia_forces"];
            [&forces["tau_beta"][key], &forces["tau_sigma"][key]]
        };
        check([0.0; 2], [1.0, 0.0], of("b''"));
        check([0.0; 2], [0.0, 1.0], of("s''"));
        check([1.0, 0.0], [0.0; 2], of("b'b'"));
        check([0.0, 1.0], [0.0; 2], of("s's'"));
    }
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
    let compile = |change: fn(&mut Mechanism)| {
        let mut mechanism = reference.mechanism();
        change(&mut mechanism);
        Plan::compile(&mechanism, &reference.assembly(&[0.0]))
    };
    assert!(compile(|_| ()).is_ok());
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
    let odd = compile(|m| m.actuators[0].kind = ActuatorKind::Travel(JointId(0)))
        .expect_err("no such coordinate");
    assert!(
        matches!(
            odd,
            AssemblyError::Structure(StructureError::Malformed { .. })
        ),
        "{odd:?}"
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
        Err(PositionError::NotFinite { .. })
    ));
}
