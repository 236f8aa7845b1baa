//! Joints that hold twice: consistent ones are solved, and what they leave undetermined is said;
//! what counting does not see is found by rank.

use dwell_geometry::mobility::mobility;
use dwell_geometry::{AssemblyError, BodyId, Plan, StructureError, Vec2, vec2};
use dwell_kinetostatics::{Mass, Model};
use dwell_tests::changes::Setup;
use dwell_tests::sketch::{FourBar, Sketch};

const GROUND: BodyId = Sketch::GROUND;

/// A parallelogram whose coupler a third bar holds too, `off` m longer than the others.
fn three_bars(offset: f64) -> Setup {
    let mut bars = FourBar::new([1.0, 3.0, 1.0, 3.0]);
    let s = &mut bars.sketch;
    let third = s.body("third");
    s.revolute("E", (GROUND, [1.2, 0.0]), (third, [0.0, 0.0]));
    s.revolute(
        "F",
        (third, [1.0 + offset, 0.0]),
        (bars.coupler, [1.2, 0.0]),
    );
    s.actuate("phi", [GROUND, bars.crank]);
    let mut setup = s.setup(&[1.0]);
    setup.assembly.initial_guess[bars.coupler.0] = Some(0.0);
    setup.assembly.initial_guess[bars.rocker.0] = Some(1.0);
    setup.assembly.initial_guess[third.0] = Some(1.0);
    let bar = Mass {
        mass: 2.0,
        center: vec2(0.5, 0.0),
        inertia: 0.2,
    };
    setup.masses = vec![Mass::default(), bar, bar, bar, bar];
    setup
}

#[test]
fn a_parallelogram_with_a_third_bar_is_solved_and_says_what_is_not_unique() {
    let setup = three_bars(0.0);
    let reactions = setup.mechanism.reactions();
    let model = Model::new(&setup.mechanism, &setup.masses, &setup.assembly, &reactions).unwrap();
    let found = mobility(&setup.mechanism, &setup.assembly).unwrap();
    assert_eq!(
        (
            found.grubler_count(),
            found.degrees_of_freedom(),
            found.redundant_count
        ),
        (0, 1, 1)
    );
    let mut workspace = model.workspace::<f64>();
    let mut result = model.result_buffer();
    for q in [1.0, 0.4, 1.9, 2.7] {
        model
            .inverse_dynamics(&[q], &[1.2], &[-0.3], &mut workspace, &mut result)
            .unwrap();
        let state = model.kinematic_state(&[q], &[1.2], &mut workspace).unwrap();
        let poses = model.plan().body_frames(&setup.mechanism, state.pose());
        for body in [1, 3, 4] {
            assert!((poses[body][2] - q).abs() < 1e-12);
        }
        // All bars turn with the crank, the coupler moves along a circle: m = 3 I_A + m_c L².
        let about_pivot = 0.2 + 2.0 * 0.25;
        let m = 3.0 * about_pivot + 2.0;
        assert!(
            (result.tau[0] - m * -0.3).abs() < 1e-12,
            "{}",
            result.tau[0]
        );
    }
    // The self-stress runs along the bars through every pin, which is never along an axis here.
    assert!((0..reactions.len()).all(|k| !model.plan().is_determinate(k)));
}

#[test]
fn what_lies_outside_the_redundant_part_stays_unique() {
    let mut bars = FourBar::new([1.0, 3.0, 1.0, 3.0]);
    let s = &mut bars.sketch;
    let third = s.body("third");
    s.revolute("E", (GROUND, [1.2, 0.0]), (third, [0.0, 0.0]));
    s.revolute("F", (third, [1.0, 0.0]), (bars.coupler, [1.2, 0.0]));
    let rider = s.body("rider");
    let slide = s.prismatic(
        "s",
        (bars.coupler, [0.0, 0.5]),
        (rider, [0.0, 0.0]),
        vec2(1.0, 0.0),
    );
    s.actuate("phi", [GROUND, bars.crank]);
    s.actuate_travel("x", [bars.coupler, rider], slide);
    let mut setup = s.setup(&[1.0, 0.3]);
    setup.assembly.initial_guess[bars.coupler.0] = Some(0.0);
    let plan = Plan::compile(&setup.mechanism, &setup.assembly).unwrap();
    for (k, reaction) in setup.mechanism.reactions().iter().enumerate() {
        assert_eq!(
            plan.is_determinate(k),
            reaction.joint == slide,
            "{reaction:?}"
        );
    }
}

#[test]
fn a_third_bar_of_another_length_is_refused_with_what_stays_open() {
    let setup = three_bars(1e-3);
    let error = Plan::compile(&setup.mechanism, &setup.assembly).unwrap_err();
    let AssemblyError::Inconsistent {
        redundant_count: 1,
        gap,
        ..
    } = error
    else {
        panic!("{error:?}");
    };
    assert!(gap > 1e-5 && gap < 1e-3, "{gap}");
}

/// A block in a closed loop of three slides: one angle is held twice, in the same way.
#[test]
fn a_wedge_of_three_slides_is_solved() {
    let mut s = Sketch::new();
    let mass = Mass {
        mass: 2.0,
        center: Vec2::ZERO,
        inertia: 0.1,
    };
    let wedge = s.mass("wedge", mass, None);
    let lift = s.mass("lift", mass, None);
    let slope = Vec2::from_angle(0.5);
    let floor = s.prismatic(
        "floor",
        (GROUND, [0.0, 0.0]),
        (wedge, [0.0, 0.0]),
        vec2(1.0, 0.0),
    );
    s.prismatic("face", (wedge, [0.0, 0.0]), (lift, [0.0, 0.0]), slope);
    s.prismatic(
        "guide",
        (GROUND, [2.0, 0.0]),
        (lift, [0.0, 0.0]),
        vec2(0.0, 1.0),
    );
    s.actuate_travel("x", [GROUND, wedge], floor);
    let setup = s.setup(&[0.4]);
    let reactions = setup.mechanism.reactions();
    let model = Model::new(&setup.mechanism, &setup.masses, &setup.assembly, &reactions).unwrap();
    let mut workspace = model.workspace::<f64>();
    let mut result = model.result_buffer();
    model
        .inverse_dynamics(&[0.7], &[1.0], &[2.0], &mut workspace, &mut result)
        .unwrap();
    // The lift rises as the wedge comes nearer: ẏ = −tan 0.5 ẋ.
    let m = 2.0 * (1.0 + 0.5_f64.tan().powi(2));
    assert!((result.tau[0] - m * 2.0).abs() < 1e-12);
    for (k, reaction) in reactions.iter().enumerate() {
        let force = reaction.component == dwell_geometry::Component::Normal;
        assert_eq!(model.plan().is_determinate(k), force, "{reaction:?}");
    }
}

/// Two bodies pinned to each other twice float together, held by a slot elsewhere: as many rows as
/// coordinates, one of them wasted.
#[test]
fn a_part_held_twice_does_not_make_up_for_one_that_is_free() {
    let mut s = Sketch::new();
    let crank = s.body("crank");
    let [one, two] = ["one", "two"].map(|name| s.body(name));
    s.revolute("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    s.revolute("B", (crank, [1.0, 0.0]), (one, [0.0, 0.0]));
    let twice = [
        s.revolute("C", (one, [1.0, 0.0]), (two, [0.0, 0.0])),
        s.revolute("D", (one, [2.0, 0.0]), (two, [1.0, 0.0])),
    ];
    s.actuate("phi", [GROUND, crank]);
    let setup = s.setup(&[1.0]);
    let error = Plan::compile(&setup.mechanism, &setup.assembly).unwrap_err();
    let AssemblyError::Structure(StructureError::UnderActuated {
        degrees_of_freedom: dof,
        bodies,
        redundant_joints: found,
        ..
    }) = error
    else {
        panic!("{error:?}");
    };
    assert_eq!((dof, bodies), (2, vec![one, two]));
    assert_eq!(found, twice);
}

#[test]
fn two_actuators_for_one_freedom_are_named() {
    let mut bars = FourBar::new([1.0, 3.5, 3.0, 4.0]);
    bars.sketch.actuate("phi", [GROUND, bars.crank]);
    bars.sketch.actuate("psi", [GROUND, bars.rocker]);
    let mut setup = bars.setup(1.0, 0.6);
    setup.assembly.q = vec![1.0, 1.9];
    let error = Plan::compile(&setup.mechanism, &setup.assembly).unwrap_err();
    assert!(
        matches!(
            error,
            AssemblyError::Structure(StructureError::OverConstrained { .. })
                | AssemblyError::Inconsistent { .. }
        ),
        "{error:?}"
    );
}

/// A crank-rocker that carries a massless six-bar extension: without a request for it, it is left
/// out, and every number that remains is the same to the last bit.
#[test]
fn what_nothing_needs_is_left_out() {
    let mut bars = FourBar::actuated([1.0, 3.5, 3.0, 4.0]);
    let s = &mut bars.sketch;
    let arm = s.body("arm");
    let tip = s.body("tip");
    s.revolute("E", (bars.coupler, [1.5, 0.7]), (arm, [0.0, 0.0]));
    s.revolute("F", (arm, [4.0, 0.0]), (tip, [0.0, 0.0]));
    s.revolute("G", (GROUND, [5.0, 3.0]), (tip, [3.5, 0.0]));
    let mut setup = bars.setup(1.0, 0.6);
    setup.assembly.initial_guess[arm.0] = Some(0.5);
    let bar = Mass {
        mass: 2.0,
        center: vec2(0.5, 0.1),
        inertia: 0.2,
    };
    for body in [bars.crank, bars.coupler, bars.rocker] {
        setup.masses[body.0] = bar;
    }
    let reactions = setup.mechanism.reactions();
    let full = Model::new(&setup.mechanism, &setup.masses, &setup.assembly, &reactions).unwrap();
    let pruned = full.clone().pruned_for(&[]);
    assert_eq!(pruned.plan().pruned_groups(), [false, true]);
    let requested = full.clone().pruned_for(&[tip]);
    assert_eq!(requested.plan().pruned_groups(), [false, false]);
    let (mut one, mut two) = (full.workspace::<f64>(), pruned.workspace::<f64>());
    let (mut with, mut without) = (full.result_buffer(), pruned.result_buffer());
    for q in [1.0, 2.0, 3.0, 4.4, 6.0] {
        full.inverse_dynamics(&[q], &[1.2], &[-0.3], &mut one, &mut with)
            .unwrap();
        pruned
            .inverse_dynamics(&[q], &[1.2], &[-0.3], &mut two, &mut without)
            .unwrap();
        let bits = |a: &dwell_kinetostatics::InverseDynamics<f64>| -> Vec<u64> {
            // A zero may have either sign.
            let all = a.tau.iter().chain(&a.reactions);
            all.map(|v| (v + 0.0).to_bits()).collect()
        };
        assert_eq!(bits(&with), bits(&without));
    }
}

/// A joint that is written twice, either way round, is solved: the motion and the drive are those without it, and the two
/// share the reaction of the one.
#[test]
fn a_joint_written_twice_changes_nothing_but_its_own_reactions() {
    let bar = |center: f64| Mass {
        mass: 2.0,
        center: vec2(center, 0.1),
        inertia: 0.2,
    };
    let results = |twice: Option<(usize, bool)>| {
        let mut bars = FourBar::new([1.0, 3.0, 2.5, 3.5]);
        bars.sketch.actuate("phi", [GROUND, bars.crank]);
        if let Some((joint, swapped)) = twice {
            let mut again = bars.sketch.mechanism.joints[joint].clone();
            again.name = "again".into();
            if swapped {
                again.bodies.reverse();
                again.points.reverse();
            }
            bars.sketch.mechanism.joints.push(again);
        }
        let mut setup = bars.sketch.setup(&[1.0]);
        setup.assembly.initial_guess[bars.coupler.0] = Some(0.3);
        setup.assembly.initial_guess[bars.rocker.0] = Some(1.5);
        setup.masses = vec![Mass::default(), bar(0.5), bar(1.5), bar(1.2)];
        let reactions = setup.mechanism.reactions();
        let model = Model::new(&setup.mechanism, &setup.masses, &setup.assembly, &reactions)
            .expect("a model");
        let (mut workspace, mut result) = (model.workspace::<f64>(), model.result_buffer());
        model
            .inverse_dynamics(&[1.7], &[1.2], &[-0.3], &mut workspace, &mut result)
            .expect("forces");
        let unique = (0..reactions.len()).map(|k| model.plan().is_determinate(k));
        (
            result.tau[0],
            result.reactions.clone(),
            unique.collect::<Vec<_>>(),
        )
    };
    let (tau, once, _) = results(None);
    for joint in 0..4 {
        for swapped in [false, true] {
            let (again, twice, unique) = results(Some((joint, swapped)));
            assert!(
                (again - tau).abs() < 1e-12 * tau.abs(),
                "{joint}: {again} {tau}"
            );
            for k in 0..8 {
                assert_eq!(unique[k], k / 2 != joint, "{joint} {k}");
                if unique[k] {
                    assert!((twice[k] - once[k]).abs() < 1e-10, "{joint} {k}");
                }
            }
            assert!(!unique[8] && !unique[9]);
        }
    }
}
