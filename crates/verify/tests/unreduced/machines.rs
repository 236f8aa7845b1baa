//! Machines of the reduced equations, judged by the full ones; and faults found.

use crate::plant::{DOWN, GROUND, Plant, close};
use dwell_dynamics::{DriveKind, Motor, Regulator};
use dwell_findings::{Finding, all_pass};
use dwell_geometry::{BodyId, Coordinate, Drive, JointKind, vec2};
use dwell_kinetostatics::{Friction, Guide, LoadKind, Magnitude, Signal};
use dwell_laws::{Expression, Law, Sinusoid};
use dwell_verify::{MotionSample, judge_motion};

const G: f64 = 9.81;

pub(crate) fn told(findings: &[Finding]) -> String {
    let line = |f: &Finding| {
        format!(
            "{} {} {:.1e} of {:.1e} at {}\n",
            if f.pass { "pass" } else { "FAIL" },
            f.key,
            f.relative,
            f.tolerance,
            f.worst
        )
    };
    findings.iter().map(line).collect()
}

pub(crate) fn judged(plant: &Plant, claims: &[MotionSample]) -> Vec<Finding> {
    judge_motion(&plant.truth(), claims).unwrap()
}

#[track_caller]
fn passes(plant: &Plant, until: f64, count: usize) -> Vec<MotionSample> {
    let claims = plant.claims(until, count);
    let findings = judged(plant, &claims);
    assert!(all_pass(&findings), "{}", told(&findings));
    println!("{}", told(&findings));
    claims
}

/// Each change of the machine must be found.
fn finds(plant: &Plant, until: f64, change: impl Fn(&mut Plant)) {
    let mut wrong = plant.clone();
    change(&mut wrong);
    let findings = judged(plant, &wrong.claims(until, 6));
    assert!(!all_pass(&findings), "{}", told(&findings));
}

/// A crank-rocker whose coupler has no mass, under every kind of load of a link.
fn four_bar() -> Plant {
    let mut plant = Plant::new();
    let crank = plant.bar("crank", 6.0, 0.2, None);
    let coupler = plant.body("coupler", 0.0, [0.0, 0.0], 0.0, Some(0.6));
    let rocker = plant.bar("rocker", 1.2, 0.6, Some(1.4));
    plant.pin("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    plant.pin("B", (crank, [0.2, 0.0]), (coupler, [0.0, 0.0]));
    plant.pin("C", (coupler, [0.7, 0.0]), (rocker, [0.6, 0.0]));
    plant.pin("D", (GROUND, [0.65, -0.05]), (rocker, [0.0, 0.0]));
    plant.constant("weight", DOWN, G);
    let points = [vec2(0.2, 0.9), vec2(0.3, 0.1)];
    let bodies = [GROUND, rocker];
    plant.constant(
        "spring",
        LoadKind::Spring {
            bodies,
            points,
            free: 0.3,
        },
        60.0,
    );
    plant.constant("damper", LoadKind::Damper { bodies, points }, 0.8);
    let bodies = [coupler, rocker];
    plant.constant("turning", LoadKind::TorsionDamper { bodies }, 0.05);
    plant.constant("spiral", LoadKind::TorsionSpring { bodies, free: 0.2 }, 0.7);
    let push = Expression::parse("3*sin(5*t) - 0.4*w", &["t", "w"]).unwrap();
    plant.load(
        "push",
        LoadKind::Force {
            body: coupler,
            point: vec2(0.4, 0.2),
            direction: vec2(0.6, 0.8),
            follows: true,
        },
        Magnitude::Expression(
            push,
            vec![
                Signal::Time,
                Signal::Speed(Coordinate::Angle([GROUND, crank])),
            ],
        ),
    );
    plant.free([GROUND, crank], Drive::Angle, [0.4, 14.0]);
    plant
}

#[test]
fn val_four_bar_under_loads() {
    let plant = four_bar();
    let claims = passes(&plant, 1.4, 14);
    // It turns more than once.
    assert!(claims[14].bodies[1][2] > 7.0, "{}", claims[14].bodies[1][2]);
    for load in 0..plant.loads.len() {
        finds(&plant, 0.6, |wrong| {
            let load = &mut wrong.loads[load];
            match &mut load.magnitude {
                Magnitude::Constant(size) => *size = -*size,
                other => *other = Magnitude::Constant(1.0),
            }
        });
    }
    finds(&plant, 0.6, |wrong| wrong.masses[3].inertia *= 1.0 + 1e-6);
}

/// A crank with a motor, and friction in its pins and in the guide, whose slider is tilted.
fn slider_crank() -> Plant {
    let mut plant = Plant::new();
    let crank = plant.bar("crank", 2.0, 0.15, None);
    let rod = plant.bar("rod", 0.6, 0.5, Some(-0.2));
    let slider = plant.body("slider", 0.9, [0.02, 0.06], 0.002, None);
    plant.pin("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    let b = plant.pin("B", (crank, [0.15, 0.0]), (rod, [0.0, 0.0]));
    let c = plant.pin("C", (rod, [0.5, 0.0]), (slider, [0.0, 0.0]));
    let axis = vec2(1.0, 0.0);
    let points = [vec2(0.0, 0.03), vec2(0.01, -0.02)];
    let guide = plant.joint(
        "guide",
        (GROUND, [0.0, 0.03]),
        (slider, [0.01, -0.02]),
        JointKind::Prismatic { axes: [axis; 2] },
    );
    plant.constant("weight", DOWN, G);
    let friction = |joint, size, fade| {
        Magnitude::Friction(Friction {
            joint,
            coefficient: 0.12,
            size,
            fade,
        })
    };
    let bodies = [crank, rod];
    plant.load(
        "B rubs",
        LoadKind::Torque { bodies },
        friction(b, 0.02, 1.5),
    );
    let bodies = [rod, slider];
    plant.load(
        "C rubs",
        LoadKind::Torque { bodies },
        friction(c, 0.02, 1.5),
    );
    let along = Guide {
        bodies: [GROUND, slider],
        points,
        axis,
    };
    plant.load(
        "guide rubs",
        LoadKind::Slide(along),
        friction(guide, 0.08, 0.3),
    );
    plant.constant("oil", LoadKind::SlideDamper(along), 0.5);
    let phi = plant.free([GROUND, crank], Drive::Angle, [0.5, 6.0]);
    let motor = Motor {
        voltage: Magnitude::Constant(9.0),
        constant: 0.08,
        resistance: 0.9,
        inductance: 0.0,
        ratio: 6.0,
        inertia: 1e-4,
    };
    plant.drive(phi, DriveKind::Motor(motor));
    plant
}

#[test]
fn val_slider_crank_with_friction() {
    let plant = slider_crank();
    let claims = passes(&plant, 0.8, 8);
    assert!(claims[8].bodies[1][2] > 6.0, "{}", claims[8].bodies[1][2]);
    for load in 1..4 {
        finds(&plant, 0.3, |wrong| {
            if let Magnitude::Friction(friction) = &mut wrong.loads[load].magnitude {
                friction.coefficient *= 1.0 + 1e-5;
            }
        });
    }
    finds(&plant, 0.3, |wrong| {
        if let DriveKind::Motor(motor) = &mut wrong.drives[0].kind {
            motor.inertia = 0.0;
        }
    });
}

/// Two cranks and two couplers that meet: both cranks are coordinates.
fn five_bar() -> (Plant, BodyId, BodyId) {
    let mut plant = Plant::new();
    let left = plant.bar("left", 0.8, 0.3, None);
    let right = plant.bar("right", 0.7, 0.3, None);
    let near = plant.bar("near", 0.5, 0.5, Some(0.8));
    let far = plant.bar("far", 0.5, 0.5, Some(2.2));
    plant.pin("A", (GROUND, [0.0, 0.0]), (left, [0.0, 0.0]));
    plant.pin("B", (left, [0.3, 0.0]), (near, [0.0, 0.0]));
    plant.pin("C", (near, [0.5, 0.0]), (far, [0.5, 0.0]));
    plant.pin("D", (right, [0.3, 0.0]), (far, [0.0, 0.0]));
    plant.pin("E", (GROUND, [0.4, 0.0]), (right, [0.0, 0.0]));
    plant.constant("weight", DOWN, G);
    let bodies = [GROUND, near];
    let points = [vec2(0.2, 1.0), vec2(0.5, 0.0)];
    plant.constant(
        "spring",
        LoadKind::Spring {
            bodies,
            points,
            free: 0.2,
        },
        25.0,
    );
    (plant, left, right)
}

fn motor(inductance: f64) -> DriveKind {
    DriveKind::Motor(Motor {
        voltage: Magnitude::Law(
            Signal::Time,
            Law::Sinusoid(Sinusoid::starting_at(4.0, 2.0, 9.0, 0.3).unwrap()),
        ),
        constant: 0.06,
        resistance: 1.1,
        inductance,
        ratio: 4.0,
        inertia: 3e-4,
    })
}

#[test]
fn val_five_bar_with_two_free_actuators() {
    let (mut plant, left, right) = five_bar();
    let one = plant.free([GROUND, left], Drive::Angle, [2.0, 0.3]);
    let two = plant.free([GROUND, right], Drive::Angle, [1.0, -0.2]);
    plant.drive(one, motor(0.02));
    let regulator = Regulator {
        speed: Magnitude::Constant(-0.5),
        proportional: 2.0,
        integral: 6.0,
        limit: 40.0,
    };
    plant.drive(two, DriveKind::Regulator(regulator));
    passes(&plant, 0.8, 8);
    finds(&plant, 0.3, |wrong| {
        wrong.loads[1].magnitude = Magnitude::Constant(-25.0);
    });
    finds(&plant, 0.3, |wrong| {
        if let DriveKind::Regulator(regulator) = &mut wrong.drives[1].kind {
            regulator.integral *= 1.001;
        }
    });
}

#[test]
fn val_five_bar_with_one_led_actuator() {
    let (mut plant, left, right) = five_bar();
    let law = Sinusoid::starting_at(2.0, 0.4, 7.0, 0.2).unwrap();
    plant.led([GROUND, left], Law::Sinusoid(law));
    let free = plant.free([GROUND, right], Drive::Angle, [1.0, 0.0]);
    plant.drive(free, motor(0.0));
    passes(&plant, 0.8, 8);
    finds(&plant, 0.3, |wrong| wrong.drives[0].kind = motor(0.02));
}

/// Each finding sees what is its own.
#[test]
fn val_changed_claims_are_found_where_they_are_wrong() {
    let plant = four_bar();
    let claims = plant.claims(0.3, 3);
    let failed = |change: &dyn Fn(&mut MotionSample)| -> Vec<String> {
        let mut wrong = claims.clone();
        change(&mut wrong[2]);
        let findings = judged(&plant, &wrong);
        let failed = findings.into_iter().filter(|f| !f.pass);
        failed.map(|f| f.key).collect()
    };
    assert!(failed(&|_| ()).is_empty());
    let poses = failed(&|claim| claim.bodies[2][0] += 1e-7);
    assert_eq!(poses, ["motion-poses"]);
    // The rocker's angle is in its weight's height too.
    let poses = failed(&|claim| claim.bodies[3][2] += 1e-6);
    assert_eq!(poses, ["motion-poses", "motion-energy"]);
    let velocities = failed(&|claim| claim.velocity[2][2] += 1e-6);
    assert_eq!(velocities, ["motion-velocities"]);
    let reactions = failed(&|claim| claim.reactions[4] *= 1.0 + 1e-5);
    assert_eq!(reactions, ["motion-reactions"]);
    let work = failed(&|claim| claim.work *= 1.0 + 1e-5);
    assert_eq!(work, ["motion-actions", "motion-energy"]);
    let energy = failed(&|claim| claim.kinetic *= 1.0 + 1e-6);
    assert_eq!(energy, ["motion-energy"]);
    let nan = failed(&|claim| claim.reactions[0] = f64::NAN);
    assert_eq!(nan, ["motion-reactions"]);
}

/// Angles beta, Theta, gamma, Phi, delta, Omega, epsilon at t = 0 of andrews.f.
const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_36,
    0.222_668_390_165_885_87,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_87,
    1.230_547_444_549_821,
];

/// Andrews' squeezer: data of the Test Set for IVP Solvers (andrews.f), as in `validation/andrews`.
fn andrews() -> Plant {
    let mut plant = Plant::new();
    let [beta, theta, gamma, phi, delta, omega, epsilon] = START;
    let k1 = plant.body("k1", 0.04325, [0.00092, 0.0], 2.194e-6, Some(beta));
    let k2 = plant.body("k2", 0.00365, [-0.0115, 0.0], 4.41e-7, Some(theta + beta));
    let k3 = plant.body("k3", 0.02373, [0.01043, -0.01874], 5.255e-6, Some(gamma));
    let k4 = plant.body("k4", 0.00706, [0.0, -0.00579], 5.667e-7, Some(phi + delta));
    let k5 = plant.body("k5", 0.0705, [0.02308, 0.00916], 1.169e-5, Some(delta));
    let k6 = plant.body(
        "k6",
        0.00706,
        [0.00579, 0.0],
        5.667e-7,
        Some(omega + epsilon),
    );
    let k7 = plant.body("k7", 0.05498, [-0.00449, -0.01228], 1.912e-5, Some(epsilon));
    let a = (GROUND, [-0.06934, -0.00227]);
    plant.pin("O", (GROUND, [0.0, 0.0]), (k1, [0.0, 0.0]));
    plant.pin("F", (k1, [0.007, 0.0]), (k2, [0.0, 0.0]));
    plant.pin("B", (GROUND, [-0.03635, 0.03273]), (k3, [0.0, 0.0]));
    plant.pin("A-k5", a, (k5, [0.0, 0.0]));
    plant.pin("A-k7", a, (k7, [0.0, 0.0]));
    plant.pin("G", (k5, [0.04, 0.0]), (k4, [0.0, 0.0]));
    plant.pin("H", (k7, [0.0, -0.04]), (k6, [0.0, 0.0]));
    let e = (k2, [-0.028, 0.0]);
    plant.pin("E-k3", e, (k3, [0.0, -0.035]));
    plant.pin("E-k4", e, (k4, [0.0, -0.02]));
    plant.pin("E-k6", e, (k6, [0.02, 0.0]));
    let phi = plant.free([GROUND, k1], Drive::Angle, [beta, 0.0]);
    plant.drive(phi, DriveKind::Action(Magnitude::Constant(0.033)));
    plant.constant(
        "spring",
        LoadKind::Spring {
            bodies: [GROUND, k3],
            points: [vec2(0.014, 0.072), vec2(0.02, -0.018)],
            free: 0.07785,
        },
        4530.0,
    );
    plant
}

/// At t = 0.03 s, at 25 digits (`validation/andrews/case.toml`): the angles, their speeds, and the
/// multipliers, which are the forces of k2 on k3, k4 and k6 at E.
const ANGLES: [f64; 7] = [
    15.810_771_195_153_707,
    -15.756_371_058_411_84,
    0.040_822_240_119_645_8,
    -0.534_730_116_342_079_6,
    0.524_409_965_879_954_1,
    0.534_730_116_342_079_6,
    1.048_080_741_041_938,
];
const SPEEDS: [f64; 7] = [
    1_139.920_302_259_106,
    -1_424.379_295_177_54,
    11.032_911_910_618_594,
    19.293_374_105_032_04,
    0.573_569_914_829_502_5,
    -19.293_374_105_032_04,
    0.323_179_149_249_130_9,
];
const FORCES: [f64; 6] = [
    199.175_348_104_538_63,
    -29.755_309_974_971_763,
    23.066_543_611_622_15,
    31.452_725_275_771_137,
    22.642_494_786_394_38,
    11.617_392_352_611_257,
];

#[test]
fn val_andrews_at_25_digits() {
    let plant = andrews();
    // The poses at the start are the reduced ones, closed again; only the angles matter.
    let start = plant.claims(1e-6, 1).swap_remove(0);
    let samples = plant.truth().run(&start, &[0.03]).unwrap();
    let relative = |all: &[[f64; 3]]| {
        let of = |b: usize| all[b][2];
        [
            of(1),
            of(2) - of(1),
            of(3),
            of(4) - of(5),
            of(5),
            of(6) - of(7),
            of(7),
        ]
    };
    // The motion magnifies a difference in its start by some hundreds.
    let last = &samples[1];
    for (found, wanted) in relative(&last.bodies).into_iter().zip(ANGLES) {
        close(found, wanted, 16.0, 1e-10);
    }
    for (found, wanted) in relative(&last.velocity).into_iter().zip(SPEEDS) {
        close(found, wanted, 1140.0, 1e-10);
    }
    for (found, wanted) in last.reactions[14..].iter().zip(FORCES) {
        close(*found, wanted, 200.0, 1e-9);
    }
}

#[test]
fn val_andrews_by_the_machine() {
    let plant = andrews();
    passes(&plant, 0.03, 10);
    finds(&plant, 0.01, |wrong| {
        wrong.loads[0].magnitude = Magnitude::Constant(-4530.0);
    });
}
