//! Random loops in space: one loop of any joints with one degree of freedom, or two, assembled around a pose; each is solved with all
//! truths of the dense equations, or refused as their singular values confirm.
//!
//! `DWELL_SEED` and `DWELL_LOOPS` choose others than the usual ones.

use dwell_geometry::space::{
    Actuator, Assembly, Joint, JointKind, Mechanism, Placement, Plan, Rotation, Side, Vec3, vec3,
};
use dwell_geometry::{AssemblyError, Body};
use dwell_kinetostatics::InverseDynamics;
use dwell_kinetostatics::space::{Axes, Component, LoadKind, Mass, Model, ModelError, Reaction};
use dwell_verify::space::{DenseSpace, closure_error};

/// Pseudorandom numbers by the generator of Steele, Lea and Flood (SplitMix64).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From −1 to 1.
    fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    fn vector(&mut self) -> Vec3 {
        vec3(self.number(), self.number(), self.number())
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector();
            if v.norm() > 0.1 && v.norm() < 1.0 {
                return v.unit().unwrap_or(v);
            }
        }
    }

    fn placement(&mut self) -> Placement {
        Placement {
            position: self.vector(),
            rotation: Rotation::IDENTITY.turned_by(self.direction().scaled(3.0 * self.number())),
        }
    }

    fn mass(&mut self) -> Mass {
        // The tensor of six point masses.
        let points: Vec<Vec3> = (0..6).map(|_| self.vector().scaled(0.3)).collect();
        let center = points
            .iter()
            .fold(Vec3::ZERO, |a, b| a + *b)
            .scaled(1.0 / 6.0);
        let mut inertia = [0.0; 6];
        for r in points.iter().map(|p| *p - center) {
            let square = r.dot(r);
            let part = [
                square - r.x * r.x,
                square - r.y * r.y,
                square - r.z * r.z,
                -r.x * r.y,
                -r.x * r.z,
                -r.y * r.z,
            ];
            for (sum, part) in inertia.iter_mut().zip(part) {
                *sum += part / 6.0;
            }
        }
        let mass = 1.5 + self.number();
        Mass {
            mass,
            center,
            inertia: inertia.map(|i| i * mass),
        }
    }

    /// Kinds of joints with so many freedoms in sum; one screw at most.
    fn kinds(&mut self, freedoms: usize) -> Vec<JointKind> {
        let all = [
            JointKind::Revolute,
            JointKind::Prismatic,
            JointKind::Cylindrical,
            JointKind::Universal,
            JointKind::Spherical,
            JointKind::Planar,
            JointKind::Helical { pitch: 0.2 },
        ];
        let mut found: Vec<JointKind> = Vec::new();
        let mut left = freedoms;
        while left > 0 {
            let kind = all[self.below(all.len())];
            let is_second_screw =
                matches!(kind, JointKind::Helical { .. }) && found.contains(&kind);
            if kind.freedoms() <= left && !is_second_screw {
                left -= kind.freedoms();
                found.push(kind);
            }
        }
        found
    }
}

/// A mechanism assembled at a pose.
struct Assembled {
    mechanism: Mechanism,
    placements: Vec<Placement>,
    masses: Vec<Mass>,
    q: f64,
}

impl Assembled {
    fn new(random: &mut Random, loops: usize) -> Self {
        let mut made = Self {
            mechanism: Mechanism {
                bodies: vec![Body::named("ground")],
                ground: 0,
                joints: Vec::new(),
                actuators: Vec::new(),
            },
            placements: vec![Placement::default()],
            masses: vec![Mass::default()],
            q: 0.0,
        };
        // One of the joints with an angle or a travel is driven; the loop has one freedom in all.
        let driven = [
            JointKind::Revolute,
            JointKind::Prismatic,
            JointKind::Cylindrical,
        ][random.below(3)];
        let mut kinds = vec![driven];
        kinds.extend(random.kinds(7 - driven.freedoms()));
        made.chain(random, &kinds, [0, 0]);
        let travel = driven == JointKind::Prismatic;
        made.mechanism.actuators = vec![if travel {
            Actuator::travel("q", 0)
        } else {
            Actuator::angle("q", 0)
        }];
        for _ in 1..loops {
            let kinds = random.kinds(6);
            let from = 1 + random.below(made.mechanism.bodies.len() - 1);
            let to = (from + 1 + random.below(made.mechanism.bodies.len() - 1))
                % made.mechanism.bodies.len();
            made.chain(random, &kinds, [from, to]);
        }
        made
    }

    /// Adds a chain of joints, with bodies between them, from one body to another.
    fn chain(&mut self, random: &mut Random, kinds: &[JointKind], [from, to]: [usize; 2]) {
        let mut last = from;
        for (k, kind) in kinds.iter().enumerate() {
            let next = if k + 1 == kinds.len() {
                to
            } else {
                self.mechanism
                    .bodies
                    .push(Body::named(format!("body-{}", self.placements.len())));
                self.placements.push(random.placement());
                self.masses.push(random.mass());
                self.placements.len() - 1
            };
            self.join(random, *kind, [last, next]);
            last = next;
        }
    }

    /// A joint between two bodies where they are.
    fn join(&mut self, random: &mut Random, kind: JointKind, bodies: [usize; 2]) {
        let (point, axis) = (random.vector(), random.direction());
        let normal = axis
            .cross(random.direction())
            .unit()
            .unwrap_or_else(|| axis.any_normal());
        let (mut angle, mut along) = (2.0 * random.number(), 0.5 * random.number());
        match kind {
            JointKind::Prismatic | JointKind::Weld => angle = 0.0,
            JointKind::Helical { pitch } => along = pitch * angle,
            _ => {}
        }
        let slides = matches!(
            kind,
            JointKind::Prismatic | JointKind::Cylindrical | JointKind::Helical { .. }
        );
        let across = axis.cross(normal);
        let moved = match kind {
            JointKind::Planar => normal.scaled(along) + across.scaled(0.3 * random.number()),
            _ if slides => axis.scaled(along),
            _ => Vec3::ZERO,
        };
        let turned = normal.scaled(angle.cos()) + across.scaled(angle.sin());
        let (second_axis, second_normal) = match kind {
            JointKind::Universal => (turned, axis),
            _ => (axis, turned),
        };
        if self.mechanism.joints.is_empty() {
            self.q = if kind == JointKind::Prismatic {
                along
            } else {
                angle
            };
        }
        let side = |body: usize, point: Vec3, axis: Vec3, normal: Vec3| {
            let Placement { position, rotation } = self.placements[body];
            Side {
                point: rotation.apply_inverse(point - position),
                axis: rotation.apply_inverse(axis),
                normal: rotation.apply_inverse(normal),
            }
        };
        let sides = [
            side(bodies[0], point, axis, normal),
            side(bodies[1], point + moved, second_axis, second_normal),
        ];
        let name = format!("joint-{}", self.mechanism.joints.len());
        self.mechanism
            .joints
            .push(Joint::new(name, bodies, kind, sides));
    }

    /// Every component of every joint in the axes of the ground.
    fn reactions(&self) -> Vec<Reaction> {
        let joints = 0..self.mechanism.joints.len();
        let components = |j: usize| {
            (0..6).map(move |k| Reaction {
                joint: dwell_geometry::JointId(j),
                component: match k {
                    0..3 => Component::Force(Axes::Ground, k),
                    _ => Component::Moment(Axes::Ground, k - 3),
                },
            })
        };
        joints.flat_map(components).collect()
    }
}

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
        let open = made
            .mechanism
            .joints
            .iter()
            .map(|j| closure_error(j, &placements))
            .fold(0.0, f64::max);
        if open > 1e-9 {
            return Verdict::Unconfirmed(format!("open by {open:.1e}"));
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
        let made = Assembled::new(&mut random, loops);
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
                others.push(format!("{number}: {why}: {}", kinds.join(" ")));
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
