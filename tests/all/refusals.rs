//! What cannot work is refused, with an error that names the right things and the right numbers.

use dwell_geometry::{
    ActuatorId, AssemblyError, BodyId, PositionError, StructureError, Vec2, vec2,
};
use dwell_kinetostatics::{ModelError, ReducedModel};
use dwell_tests::cases::CASES;
use dwell_tests::changes::Setup;
use dwell_tests::fixtures::scene;
use dwell_tests::sketch::{FourBar, Sketch, slider_crank};

const GROUND: BodyId = Sketch::GROUND;

/// Why a setup does not assemble.
pub(crate) fn refusal(setup: &Setup) -> AssemblyError {
    match setup.model() {
        Err(ModelError::Assembly(error)) => error,
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("not refused"),
    }
}

#[test]
fn detached_bodies_are_named() {
    let mut bars = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let stray = bars.sketch.body("stray");
    let [one, two] = ["one", "two"].map(|name| bars.sketch.body(name));
    bars.sketch
        .revolute("S", (one, [1.0, 0.0]), (two, [0.0, 0.0]));
    let bodies = vec![stray, one, two];
    let want = AssemblyError::Structure(StructureError::NotConnected { bodies });
    assert_eq!(refusal(&bars.setup(1.0, 0.6)), want);
}

/// A five-bar has two degrees of freedom; so has a four-bar with a pendulum on its coupler.
#[test]
fn two_degrees_of_freedom_need_two_actuators() {
    let mut sketch = Sketch::new();
    let [one, two, three, four] = ["one", "two", "three", "four"].map(|name| sketch.body(name));
    sketch.revolute("A", (GROUND, [0.0, 0.0]), (one, [0.0, 0.0]));
    sketch.revolute("B", (one, [1.0, 0.0]), (two, [0.0, 0.0]));
    sketch.revolute("C", (two, [1.0, 0.0]), (three, [1.0, 0.0]));
    sketch.revolute("D", (three, [0.0, 0.0]), (four, [1.0, 0.0]));
    sketch.revolute("E", (GROUND, [1.0, 0.0]), (four, [0.0, 0.0]));
    sketch.actuate("phi", [GROUND, one]);
    let error = refusal(&sketch.setup(&[1.0]));
    let AssemblyError::Structure(StructureError::UnderActuated {
        degrees_of_freedom: dof,
        actuators,
        bodies,
        redundant_joints: twice,
    }) = error
    else {
        panic!("{error:?}");
    };
    assert_eq!((dof, actuators), (2, 1));
    assert_eq!(twice, vec![]);
    assert!(!bodies.is_empty() && bodies.iter().all(|b| [two, three, four].contains(b)));

    let mut bars = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let pendulum = bars.sketch.body("pendulum");
    bars.sketch
        .revolute("P", (bars.coupler, [1.0, 0.5]), (pendulum, [0.0, 0.0]));
    let want = StructureError::UnderActuated {
        degrees_of_freedom: 2,
        actuators: 1,
        bodies: vec![pendulum],
        redundant_joints: Vec::new(),
    };
    assert_eq!(refusal(&bars.setup(1.0, 0.6)), want.into());
}

/// A second bar between coupler and ground leaves nothing to move, and a second actuator nothing
/// to drive.
#[test]
fn no_degree_of_freedom_is_left_to_drive() {
    let mut barred = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let bar = barred.sketch.body("bar");
    let e = (barred.coupler, [1.0, 0.5]);
    barred.sketch.revolute("E", e, (bar, [0.0, 0.0]));
    barred
        .sketch
        .revolute("F", (bar, [1.0, 0.0]), (GROUND, [1.0, -2.0]));
    let mut pinned = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    pinned.sketch.revolute("E", e, (GROUND, [1.0, 2.0]));
    let mut twice = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    twice.sketch.actuate("psi", [GROUND, twice.rocker]);
    let mut held = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let pin = (GROUND, [0.5, 0.5]);
    held.sketch.revolute("E", (held.crank, [0.5, 0.0]), pin);
    for (bars, want) in [(barred, 1), (pinned, 2), (twice, 1), (held, 2)] {
        let mut setup = bars.setup(1.0, 0.6);
        setup
            .assembly
            .q
            .resize(bars.sketch.mechanism.actuators.len(), 1.8);
        let error = refusal(&setup);
        let AssemblyError::Structure(StructureError::OverConstrained {
            redundant_count: excess,
            joints,
            ..
        }) = error
        else {
            panic!("{error:?}");
        };
        assert_eq!(excess, want);
        assert!(!joints.is_empty());
    }
    let mut same = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    same.sketch.actuate("phi again", [GROUND, same.crank]);
    let error = refusal(&same.sketch.setup(&[1.0, 1.0]));
    let want = StructureError::OverConstrained {
        redundant_count: 1,
        joints: Vec::new(),
        actuators: vec![ActuatorId(0), ActuatorId(1)],
    };
    assert_eq!(error, want.into());
}

/// A bar whose two pins coincide, but for the rounding of their coordinates, holds nothing at a
/// distance.
#[test]
fn a_bar_without_length_is_refused() {
    let mut bars = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let joints = &mut bars.sketch.mechanism.joints;
    joints[1].points[1] = vec2(0.1 + 0.2, 0.1);
    joints[2].points[0] = vec2(0.3, 0.1);
    let error = refusal(&bars.setup(1.0, 0.6));
    let AssemblyError::Structure(StructureError::OverConstrained { joints, .. }) = error else {
        panic!("{error:?}");
    };
    assert_eq!(joints, [bars.c]);
}

/// Four-bars and slider-cranks that do not close at q = 0, with the length that is missing.
fn too_short() -> Vec<(Setup, Vec<BodyId>, f64)> {
    let mut all = Vec::new();
    // B is 3 m from D: 1 m, 0.5 m and 1 µm too far; then inside the difference of the lengths.
    for (coupler, rocker, missing) in [
        (1.0, 1.0, 1.0),
        (1.5, 1.0, 0.5),
        (2.0 - 1e-6, 1.0, 1e-6),
        (9.0, 1.0, 5.0),
        (1.0, 4.5, 0.5),
    ] {
        let bars = FourBar::actuated([1.0, coupler, rocker, 4.0]);
        let bodies = vec![bars.coupler, bars.rocker];
        all.push((bars.setup(0.0, 0.6), bodies, missing));
    }
    for (height, missing) in [(1.5, 0.5), (-3.0, 2.0)] {
        let (sketch, rod) = slider_crank(1.0, height);
        all.push((sketch.setup(&[0.0]), vec![rod], missing));
    }
    all
}

#[test]
fn bodies_that_do_not_reach_each_other_are_named() {
    for (setup, want, missing) in too_short() {
        let error = refusal(&setup);
        let AssemblyError::NoAssembly {
            bodies,
            joints,
            gap,
        } = error
        else {
            panic!("{error:?}");
        };
        assert_eq!(bodies, want);
        assert_eq!(joints.len(), 1);
        assert!(gap.is_finite() && gap > 0.0, "{gap} for {missing}");
    }
}

#[test]
fn the_gap_is_the_length_that_is_missing() {
    for (setup, _, missing) in too_short() {
        let AssemblyError::NoAssembly { gap, .. } = refusal(&setup) else {
            panic!("closed");
        };
        assert!((gap - missing).abs() < 1e-9, "{gap} for {missing}");
    }
}

/// What no scene can say, but a caller can.
#[test]
fn broken_descriptions_are_refused() {
    let good = FourBar::actuated([1.0, 3.5, 3.0, 4.0]).setup(1.0, 0.6);
    let (mut none, mut two) = (good.clone(), good.clone());
    none.assembly.q.clear();
    two.assembly.q.push(2.0);
    let (mut joint, mut ground) = (good.clone(), good);
    joint.mechanism.joints[2].bodies[1] = BodyId(9);
    ground.mechanism.ground = 9;
    for (what, setup) in [
        ("none", none),
        ("two", two),
        ("joint", joint),
        ("ground", ground),
    ] {
        let refused = std::panic::catch_unwind(|| setup.model().is_err());
        assert!(refused.is_ok_and(|refused| refused), "{what}");
    }
}

/// No angle tells the branches apart, nor does one that is not a number.
#[test]
fn a_rough_angle_must_be_a_number() {
    let setup = FourBar::actuated([1.0, 3.5, 3.0, 4.0]).setup(1.0, f64::NAN);
    refusal(&setup);
}

#[test]
fn an_ambiguous_assembly_lists_its_choices() {
    let bars = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let setup = bars.sketch.setup(&[1.0]);
    let error = refusal(&setup);
    let AssemblyError::Ambiguous {
        bodies,
        modes: choices,
        ..
    } = error
    else {
        panic!("{error:?}");
    };
    assert_eq!(bodies, [bars.coupler, bars.rocker]);
    assert_eq!(choices.len(), 2);
    assert!((choices[0][0] - choices[1][0]).abs() > 1.0);
    for choice in &choices {
        let end_point = Vec2::from_angle(1.0) + Vec2::from_angle(choice[0]) * 3.5;
        let gap = vec2(4.0, 0.0) + Vec2::from_angle(choice[1]) * 3.0 - end_point;
        assert!(gap.norm() < 1e-14, "{gap:?}");
    }
}

/// Newton's method finds both assemblies of the class III mechanism from nothing, and each of them
/// assembles when it is asked for.
#[test]
fn an_ambiguous_class_three_group_lists_its_choices() {
    let mut setup = Setup::of(&scene("class-three-six-bar"));
    setup.assembly.initial_guess.fill(None);
    let error = refusal(&setup);
    let AssemblyError::Ambiguous {
        bodies,
        modes: choices,
        ..
    } = error
    else {
        panic!("{error:?}");
    };
    assert_eq!((bodies.len(), choices.len()), (4, 2));
    let inertias = choices.iter().map(|choice| {
        for (body, angle) in bodies.iter().zip(choice) {
            setup.assembly.initial_guess[body.0] = Some(*angle);
        }
        let model = setup.model().expect("a model");
        model
            .inertia(-0.6, &mut model.workspace())
            .expect("a pose")
            .0
    });
    let inertias: Vec<f64> = inertias.collect();
    assert!((inertias[0] - inertias[1]).abs() > 1e-3, "{inertias:?}");
}

/// With G ten times too far away no start of Newton's method leads to a pose, whichever of them
/// happens to be singular.
#[test]
fn a_class_three_group_that_does_not_reach_is_not_called_singular() {
    let mut setup = Setup::of(&scene("class-three-six-bar"));
    setup.mechanism.joints[6].points[0] = vec2(5.0, 5.0);
    let error = refusal(&setup);
    let AssemblyError::NoAssembly { bodies, gap, .. } = error else {
        panic!("{error:?}");
    };
    assert_eq!(bodies.len(), 4);
    assert!(gap > 0.1, "{gap}");
}

#[test]
fn a_coordinate_must_be_a_number() {
    for case in CASES {
        let model = Setup::of(&case.scene()).model().expect("a model");
        for q in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = model.inertia(q, &mut model.workspace()).unwrap_err();
            assert_eq!(error, PositionError::NotFinite, "{}", case.name);
        }
    }
}
