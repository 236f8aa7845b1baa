//! Machines of the reduced equations, checked by the full ones; and faults detected.

use crate::plant::{DOWN, GROUND, Plant, close};
use dwell_findings::{Finding, all_pass};
use dwell_geometry::{ActuatorKind, BodyId, Coordinate, JointKind, vec2};
use dwell_kinetostatics::{
    Direction, DriveKind, Friction, FrictionContact, Guide, LoadKind, Magnitude, Motor, Signal,
    SpeedController,
};
use dwell_laws::{Expression, Law, Sinusoid};
use dwell_verify::{MotionSample, check_motion};

const G: f64 = 9.81;

pub(crate) fn describe(findings: &[Finding]) -> String {
    let line = |f: &Finding| {
        format!(
            "{} {} {:.1e} of {:.1e} at {}\n",
            if f.pass { "pass" } else { "FAIL" },
            f.key,
            f.relative_difference,
            f.tolerance,
            f.worst_at
        )
    };
    findings.iter().map(line).collect()
}

pub(crate) fn findings_for(plant: &Plant, claimed_motion: &[MotionSample]) -> Vec<Finding> {
    check_motion(&plant.multibody(), claimed_motion).unwrap()
}

#[track_caller]
fn passes(plant: &Plant, until: f64, count: usize) -> Vec<MotionSample> {
    let claimed_motion = plant.model_motion(until, count);
    let findings = findings_for(plant, &claimed_motion);
    assert!(all_pass(&findings), "{}", describe(&findings));
    println!("{}", describe(&findings));
    claimed_motion
}

/// Each change of the machine must be found.
fn finds(plant: &Plant, until: f64, change: impl Fn(&mut Plant)) {
    let mut wrong = plant.clone();
    change(&mut wrong);
    let findings = findings_for(plant, &wrong.model_motion(until, 6));
    assert!(!all_pass(&findings), "{}", describe(&findings));
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
    plant.constant("spring", LoadKind::spring(bodies, points, 0.3), 60.0);
    plant.constant("damper", LoadKind::damper(bodies, points), 0.8);
    let bodies = [coupler, rocker];
    plant.constant("turning", LoadKind::rotational_damper(bodies), 0.05);
    plant.constant("spiral", LoadKind::torsion_spring(bodies, 0.2), 0.7);
    let push = Expression::parse("3*sin(5*t) - 0.4*w", &["t", "w"]).unwrap();
    plant.load(
        "push",
        LoadKind::Force {
            body: coupler,
            point: vec2(0.4, 0.2),
            direction: Direction::Body(vec2(0.6, 0.8)),
        },
        Magnitude::Expression(
            push,
            vec![
                Signal::Time,
                Signal::Velocity(Coordinate::Angle([GROUND, crank])),
            ],
        ),
    );
    plant.free([GROUND, crank], ActuatorKind::Angle, [0.4, 14.0]);
    plant
}

#[test]
fn val_four_bar_under_loads() {
    let plant = four_bar();
    let claimed_motion = passes(&plant, 1.4, 14);
    // It makes more than one revolution.
    assert!(
        claimed_motion[14].poses[1][2] > 7.0,
        "{}",
        claimed_motion[14].poses[1][2]
    );
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
    let pin = FrictionContact::Pin { radius: 0.02 };
    let friction = |joint, contact, regularization_speed| {
        Magnitude::Friction(Friction {
            joint,
            coefficient: 0.12,
            static_coefficient: 0.12,
            contact,
            regularization_speed: Some(regularization_speed),
        })
    };
    let bodies = [crank, rod];
    plant.load("B rubs", LoadKind::couple(bodies), friction(b, pin, 1.5));
    let bodies = [rod, slider];
    plant.load("C rubs", LoadKind::couple(bodies), friction(c, pin, 1.5));
    let along = Guide {
        bodies: [GROUND, slider],
        points,
        axis,
    };
    plant.load(
        "guide rubs",
        LoadKind::slide_force(along),
        friction(guide, FrictionContact::Guide { length: 0.08 }, 0.3),
    );
    plant.constant("oil", LoadKind::slide_damper(along), 0.5);
    let phi = plant.free([GROUND, crank], ActuatorKind::Angle, [0.5, 6.0]);
    let motor = Motor {
        voltage: Magnitude::Constant(9.0),
        torque_constant: 0.08,
        resistance: 0.9,
        inductance: 0.0,
        gear_ratio: 6.0,
        rotor_inertia: 1e-4,
        is_torque_speed_line: false,
    };
    plant.drive(phi, DriveKind::Motor(motor));
    plant
}

#[test]
fn val_slider_crank_with_friction() {
    let plant = slider_crank();
    let claimed_motion = passes(&plant, 0.8, 8);
    assert!(
        claimed_motion[8].poses[1][2] > 6.0,
        "{}",
        claimed_motion[8].poses[1][2]
    );
    for load in 1..4 {
        finds(&plant, 0.3, |wrong| {
            if let Magnitude::Friction(friction) = &mut wrong.loads[load].magnitude {
                friction.coefficient *= 1.0 + 1e-5;
                friction.static_coefficient = friction.coefficient;
            }
        });
    }
    finds(&plant, 0.3, |wrong| {
        if let DriveKind::Motor(motor) = &mut wrong.drives[0].kind {
            motor.rotor_inertia = 0.0;
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
    plant.constant("spring", LoadKind::spring(bodies, points, 0.2), 25.0);
    (plant, left, right)
}

fn motor(inductance: f64) -> DriveKind {
    DriveKind::Motor(Motor {
        voltage: Magnitude::Law(
            Signal::Time,
            Law::Sinusoid(Sinusoid::starting_at(4.0, 2.0, 9.0, 0.3).unwrap()),
        ),
        torque_constant: 0.06,
        resistance: 1.1,
        inductance,
        gear_ratio: 4.0,
        rotor_inertia: 3e-4,
        is_torque_speed_line: false,
    })
}

#[test]
fn val_five_bar_with_two_free_actuators() {
    let (mut plant, left, right) = five_bar();
    let one = plant.free([GROUND, left], ActuatorKind::Angle, [2.0, 0.3]);
    let two = plant.free([GROUND, right], ActuatorKind::Angle, [1.0, -0.2]);
    plant.drive(one, motor(0.02));
    let regulator = SpeedController {
        reference_speed: Magnitude::Constant(-0.5),
        proportional_gain: 2.0,
        integral_gain: 6.0,
        limit: 40.0,
    };
    plant.drive(two, DriveKind::SpeedController(regulator));
    passes(&plant, 0.8, 8);
    finds(&plant, 0.3, |wrong| {
        wrong.loads[1].magnitude = Magnitude::Constant(-25.0);
    });
    finds(&plant, 0.3, |wrong| {
        if let DriveKind::SpeedController(regulator) = &mut wrong.drives[1].kind {
            regulator.integral_gain *= 1.001;
        }
    });
}

#[test]
fn val_five_bar_with_one_led_actuator() {
    let (mut plant, left, right) = five_bar();
    let law = Sinusoid::starting_at(2.0, 0.4, 7.0, 0.2).unwrap();
    plant.prescribed([GROUND, left], Law::Sinusoid(law));
    let free = plant.free([GROUND, right], ActuatorKind::Angle, [1.0, 0.0]);
    plant.drive(free, motor(0.0));
    passes(&plant, 0.8, 8);
    finds(&plant, 0.3, |wrong| wrong.drives[0].kind = motor(0.02));
}

/// Each finding sees what is its own.
#[test]
fn val_changed_claims_are_found_where_they_are_wrong() {
    let plant = four_bar();
    let claimed_motion = plant.model_motion(0.3, 3);
    let failed = |change: &dyn Fn(&mut MotionSample)| -> Vec<String> {
        let mut wrong = claimed_motion.clone();
        change(&mut wrong[2]);
        let findings = findings_for(&plant, &wrong);
        let failed = findings.into_iter().filter(|f| !f.pass);
        failed.map(|f| f.key).collect()
    };
    assert!(failed(&|_| ()).is_empty());
    let poses = failed(&|claim| claim.poses[2][0] += 1e-7);
    assert_eq!(poses, ["motion-poses"]);
    // The rocker's angle is in its weight's height too.
    let poses = failed(&|claim| claim.poses[3][2] += 1e-6);
    assert_eq!(poses, ["motion-poses", "motion-energy"]);
    let velocities = failed(&|claim| claim.velocities[2][2] += 1e-6);
    assert_eq!(velocities, ["motion-velocities"]);
    let reactions = failed(&|claim| claim.reactions[4] *= 1.0 + 1e-5);
    assert_eq!(reactions, ["motion-reactions"]);
    let work = failed(&|claim| claim.work *= 1.0 + 1e-5);
    assert_eq!(work, ["motion-actuator-forces", "motion-energy"]);
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
    let phi = plant.free([GROUND, k1], ActuatorKind::Angle, [beta, 0.0]);
    plant.drive(phi, DriveKind::AppliedForce(Magnitude::Constant(0.033)));
    plant.constant(
        "spring",
        LoadKind::spring(
            [GROUND, k3],
            [vec2(0.014, 0.072), vec2(0.02, -0.018)],
            0.07785,
        ),
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
    let start = plant.model_motion(1e-6, 1).swap_remove(0);
    let samples = plant.multibody().integrate(&start, &[0.03]).unwrap();
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
    for (found, wanted) in relative(&last.poses).into_iter().zip(ANGLES) {
        close(found, wanted, 16.0, 1e-10);
    }
    for (found, wanted) in relative(&last.velocities).into_iter().zip(SPEEDS) {
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
