//! Random loops in space: one loop of any joints with one degree of freedom, or two, driven at a joint, by a length or through gears, assembled around a pose; each is solved with all
//! truths of the dense equations, or refused as their singular values confirm.
//!
//! `DWELL_SEED` and `DWELL_LOOPS` choose others than the usual ones.

mod assembled;

use assembled::{Assembled, DrivenBy, Random};
use dwell_geometry::space::{
    ActuatorKind, Assembly, Joint, JointKind, Mechanism, Placement, Plan, vec3,
};
use dwell_geometry::{AssemblyError, JointId};
use dwell_kinetostatics::InverseDynamics;
use dwell_kinetostatics::space::{LoadKind, Model, ModelError};
use dwell_verify::space::{DenseSpace, closure_error, mesh_error};

/// What became of a mechanism.
enum Verdict {
    Solved,
    Refused,
    Unconfirmed(String),
}

/// Solves a mechanism and holds it to the dense equations, or holds its refusal to their rank.
fn judge(made: &Assembled, random: &mut Random) -> Verdict {
    let nearly = made.placements.iter().map(|at| Placement {
        position: at.position + random.vector().scaled(1e-3),
        rotation: at.rotation.turned_by(random.vector().scaled(1e-3)),
    });
    let assembly = Assembly {
        q: vec![made.q],
        placements: nearly.collect(),
    };
    let gravity = (LoadKind::Gravity(vec3(0.0, 0.0, -1.0)), 9.81);
    let dense = |mechanism: &Mechanism,
                 placements: &[Placement],
                 rates: [&[f64]; 2],
                 loads: &[(LoadKind, f64)]| {
        DenseSpace::new(mechanism, &made.masses, placements, rates, loads).expect("singular values")
    };
    let model = match Model::new(&made.mechanism, &made.masses, &assembly, &made.reactions()) {
        Ok(model) => model,
        Err(error) => {
            // Something is free with the actuator held, or the actuator cannot move anything.
            let driven = dense(&made.mechanism, &made.placements, [&[1.0], &[0.0]], &[]);
            let mut undriven = made.mechanism.clone();
            undriven.actuators.clear();
            // Without its actuator a driven distance holds nothing.
            let is_open = JointKind::Distance { length: 0.0 };
            undriven.joints.retain(|j| j.kind != is_open);
            let undriven = dense(&undriven, &made.placements, [&[], &[]], &[]);
            let is_blocked = driven.redundant_count > undriven.redundant_count;
            let singular = driven.idle_freedoms > 0 || is_blocked;
            let is_of_rank = matches!(
                error,
                ModelError::UnbalancedRod { .. }
                    | ModelError::Assembly(
                        AssemblyError::Structure(_)
                            | AssemblyError::SingularAssembly { .. }
                            | AssemblyError::Inconsistent { .. }
                    )
            );
            return match is_of_rank && singular {
                true => Verdict::Refused,
                false => Verdict::Unconfirmed(error.to_string()),
            };
        }
    };
    let plan = model.plan();
    let (mut work, mut pose) = (model.workspace::<f64>(), plan.pose::<f64>());
    let mut solved = 0;
    for ahead in [0.0, -0.03, 0.02] {
        let q = made.q + ahead;
        if plan.positions(&[q], &mut pose).is_err() {
            // A limit position is near.
            continue;
        }
        plan.velocities(&[1.0], &mut pose);
        plan.accelerations(&[0.0], &mut pose);
        let placements: Vec<Placement> = (0..made.placements.len())
            .map(|b| plan.placement(&pose, b))
            .collect();
        let open = joints_at(&made.mechanism, q)
            .map(|j| closure_error(&j, &placements))
            .fold(0.0, f64::max);
        if open > 1e-9 {
            return Verdict::Unconfirmed(format!("open by {open:.1e}"));
        }
        let slip = made.mechanism.joints.iter();
        let slip = slip.filter_map(|j| mesh_error(j, [&made.placements, &placements]));
        if slip.fold(0.0, |a: f64, b| a.max(b.abs())) > 1e-9 {
            return Verdict::Unconfirmed("its teeth do not mesh".to_owned());
        }
        let determined = model.determined(&[q], &mut work).expect("a pose");
        for (rates, loads) in [
            ([1.0, 0.0], None),
            ([0.0, 1.0], None),
            ([0.0, 0.0], Some(gravity)),
        ] {
            let [q_dot, q_ddot] = rates;
            let loads: Vec<_> = loads.into_iter().collect();
            let truth = dense(&made.mechanism, &placements, [&[q_dot], &[q_ddot]], &loads);
            let mut found = model.result_buffer();
            match loads.first() {
                Some((kind, f)) => {
                    model
                        .unit_load_response(&[q], kind, &mut work, &mut found)
                        .expect("a pose");
                    for value in found.tau.iter_mut().chain(&mut found.reactions) {
                        *value *= f;
                    }
                }
                None => model
                    .inverse_dynamics(&[q], &[q_dot], &[q_ddot], &mut work, &mut found)
                    .expect("a pose"),
            }
            if let Some(wrong) = differ(plan, &pose, (&truth, &found), &determined, q_dot > 0.0) {
                return Verdict::Unconfirmed(format!("{wrong} at {q}, {rates:?}"));
            }
        }
        solved += 1;
    }
    if solved > 0 {
        Verdict::Solved
    } else {
        Verdict::Unconfirmed("no pose".to_owned())
    }
}

/// The joints, the driven distance with its length.
fn joints_at(mechanism: &Mechanism, q: f64) -> impl Iterator<Item = Joint> {
    let driven = mechanism.actuators[0].kind;
    let joints = mechanism.joints.iter().cloned().enumerate();
    joints.map(move |(j, mut joint)| {
        if driven == ActuatorKind::Length(JointId(j)) {
            joint.kind = JointKind::Distance { length: q };
        }
        joint
    })
}

/// What differs from the dense equations; amplified rounding near singular positions is allowed for.
fn differ(
    plan: &Plan,
    pose: &dwell_geometry::space::Pose,
    (truth, found): (&DenseSpace, &InverseDynamics<f64>),
    determined: &[bool],
    moving: bool,
) -> Option<String> {
    let speeds = truth
        .motions
        .iter()
        .map(|m| m.velocity.norm() + m.angular_velocity.norm());
    let steep = speeds.fold(1.0, f64::max);
    let far = |a: f64, b: f64, scale: f64| (a - b).abs() > 1e-8 * steep * steep * (1.0 + scale);
    if moving {
        for (b, wanted) in truth.motions.iter().enumerate() {
            let got = plan.body_motion(pose, b);
            let pairs = [
                ("velocity", got.velocity, wanted.velocity),
                (
                    "angular velocity",
                    got.angular_velocity,
                    wanted.angular_velocity,
                ),
                ("acceleration", got.acceleration, wanted.acceleration),
                (
                    "angular acceleration",
                    got.angular_acceleration,
                    wanted.angular_acceleration,
                ),
            ];
            if let Some((what, ..)) = pairs
                .into_iter()
                .find(|(_, got, wanted)| far((*got - *wanted).norm(), 0.0, wanted.norm()))
            {
                return Some(format!("{what} of body {b}"));
            }
        }
    }
    if far(
        found.tau[0],
        truth.actuator_actions[0],
        truth.actuator_actions[0].abs(),
    ) {
        return Some(format!(
            "actuator {} for {}",
            found.tau[0], truth.actuator_actions[0]
        ));
    }
    let wrenches = truth.reactions.iter().map(|w| {
        [
            w.force.x, w.force.y, w.force.z, w.moment.x, w.moment.y, w.moment.z,
        ]
    });
    let wanted: Vec<f64> = wrenches.flatten().collect();
    let scale = wanted.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (k, wanted) in wanted.iter().enumerate() {
        if determined[k] != truth.determined[k / 6][k % 6] {
            return Some(format!("whether component {k} is determined"));
        }
        if determined[k] && far(found.reactions[k], *wanted, scale) {
            return Some(format!(
                "component {k}: {} for {wanted}",
                found.reactions[k]
            ));
        }
    }
    None
}

#[test]
fn random_loops_are_solved_or_refused_rightly() {
    let chosen = |name: &str, usual: u64| {
        std::env::var(name)
            .ok()
            .and_then(|v| v.parse().ok())
            .unwrap_or(usual)
    };
    let (seed, count) = (chosen("DWELL_SEED", 1), chosen("DWELL_LOOPS", 200));
    let (mut solved, mut refused, mut others) = (0, 0, Vec::new());
    for number in 0..count {
        let mut random = Random(seed.wrapping_mul(1_000_003).wrapping_add(number));
        let loops = if number % 5 == 4 { 2 } else { 1 };
        let driven_by = match number % 10 {
            1 => DrivenBy::Length,
            2 | 4 => DrivenBy::Gear,
            7 => DrivenBy::ScrewOfScrews,
            _ => DrivenBy::Joint,
        };
        let made = Assembled::new(&mut random, loops, driven_by);
        match judge(&made, &mut random) {
            Verdict::Solved => solved += 1,
            Verdict::Refused => refused += 1,
            Verdict::Unconfirmed(why) => {
                let kinds: Vec<_> = made
                    .mechanism
                    .joints
                    .iter()
                    .map(|j| format!("{:?}", j.kind))
                    .collect();
                others.push(format!(
                    "{number} {driven_by:?}: {why}: {}",
                    kinds.join(" ")
                ));
            }
        }
    }
    println!(
        "{solved} solved, {refused} refused as their rank says, {} others\n{}",
        others.len(),
        others.join("\n")
    );
    assert!(
        20 * others.len() as u64 <= count,
        "{} of {count} are neither solved nor refused rightly",
        others.len()
    );
}
