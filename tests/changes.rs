//! Ways to describe one and the same mechanism, and what each makes of its coefficients.
//!
//! A change keeps the mechanism and changes its description: order, names, frames, where it
//! stands, from which side it is looked at, which body of a pair is named first. The coordinate
//! becomes q′ = s q + c with s = ±1, so q̇′ = s q̇ and q̈′ = s q̈, and the two components F of a
//! joint's reaction become A F. From R = a q̈ + b q̇² then follows
//!
//! ```text
//! m′ = m,  (½ dm/dq)′ = s ½ dm/dq,  a′ = s A a,  b′ = A b                            (1)
//! ```
//!
//! For a revolute joint, A acts on (X, Y): a rotation by α turns it, the mirror y → −y changes
//! the sign of Y, swapping the bodies changes both signs. For a prismatic joint, A acts on (N, M):
//! the force N n and the couple M about P₂, both of body 1 on body 2, where n is the axis t turned
//! by +90° and u = (P₂ − P₁)·t is the travel.
//!
//! - Rotation: nothing changes, since n turns too.
//! - Mirror: the mirrored axis turned by +90° is −1 times the mirrored n, so N′ = −N; a couple
//!   changes its sense, M′ = −M. The travel is the same.
//! - Swap: body 2 acts on body 1 with the force −N n at P₂ and the couple −M, and the reaction is
//!   now to be stated about P₁. With (P₂ − P₁) × n = u,
//!
//! ```text
//! N′ = −N,  M′ = −M − u N,  u′ = −u                                                  (2)
//! ```

use dwell_geometry::{
    AssemblyConfiguration, BodyId, Joint, JointKind, Mechanism, Plan, Pose, Range, Vec2, vec2,
};
use dwell_kinetostatics::{Coefficients, ExactModel, Mass, Model, ModelError};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// A mechanism with all a model is made from, and how it answers to the one it was made from.
#[derive(Debug, Clone)]
pub struct Setup {
    pub mechanism: Mechanism,
    pub masses: Vec<Mass>,
    pub assembly: AssemblyConfiguration,
    /// s and c of q′ = s q + c.
    sign: f64,
    shift: f64,
    /// By joint of the original.
    joints: Vec<JointTransform>,
}

/// What has become of a joint of the original.
#[derive(Debug, Clone, Copy)]
struct JointTransform {
    /// Its index now.
    index: usize,
    /// A of equation (1); for a prismatic joint the entry at [1][0] multiplies the travel u of
    /// the original.
    map: [[f64; 2]; 2],
    /// u′ = `travel` u.
    travel: f64,
}

/// The coefficients at one position, with the travel of every joint (0 for a revolute one).
#[derive(Debug, Clone)]
pub struct Sample {
    pub coefficients: Coefficients,
    pub travel: Vec<f64>,
}

impl Setup {
    /// A scene's mechanism as it is.
    pub fn of(scene: &PlaneScene) -> Self {
        let start = scene.assembly.to_configuration();
        Self::new(scene.mechanism.clone(), scene.masses.clone(), start)
    }

    /// A mechanism as it is, with one actuator.
    pub fn new(mechanism: Mechanism, masses: Vec<Mass>, start: AssemblyConfiguration) -> Self {
        let unchanged = |joint| JointTransform {
            index: joint,
            map: [[1.0, 0.0], [0.0, 1.0]],
            travel: 1.0,
        };
        Self {
            joints: (0..mechanism.joints.len()).map(unchanged).collect(),
            mechanism,
            masses,
            assembly: start,
            sign: 1.0,
            shift: 0.0,
        }
    }

    /// The same with the joints found by their names, for a mechanism that was read anew.
    pub fn matched_by_name(mut self, original: &Mechanism) -> Self {
        for (transform, joint) in self.joints.iter_mut().zip(&original.joints) {
            let found = self
                .mechanism
                .joints
                .iter()
                .position(|j| j.name == joint.name);
            transform.index = found.expect("the same joints");
        }
        self
    }

    /// Its reduced model with every reaction.
    pub fn model(&self) -> Result<ExactModel, ModelError> {
        let reactions = self.mechanism.reactions();
        let model = Model::new(&self.mechanism, &self.masses, &self.assembly, &reactions)?;
        Ok(ExactModel::new(model).expect("one actuator"))
    }

    /// The coordinate for a coordinate of the original.
    pub fn q(&self, original: f64) -> f64 {
        self.sign * original + self.shift
    }

    /// The range for a range of the original.
    pub fn range(&self, original: Range) -> Range {
        match original {
            Range::Limited(from, to) => {
                let (a, b) = (self.q(from), self.q(to));
                Range::Limited(a.min(b), a.max(b))
            }
            other => other,
        }
    }

    /// The coefficients by equation (1) for those of the original.
    pub fn coefficients(&self, original: &Sample) -> Coefficients {
        let from = &original.coefficients;
        let mut to = Coefficients {
            m: from.m,
            half_dm: self.sign * from.half_dm,
            a: vec![0.0; from.a.len()],
            b: vec![0.0; from.b.len()],
        };
        for (j, transform) in self.joints.iter().enumerate() {
            let lower = match self.mechanism.joints[transform.index].kind {
                JointKind::Prismatic { .. } => transform.map[1][0] * original.travel[j],
                _ => transform.map[1][0],
            };
            for (row, [one, two]) in [transform.map[0], [lower, transform.map[1][1]]]
                .into_iter()
                .enumerate()
            {
                let (k, at) = (2 * j, 2 * transform.index + row);
                to.a[at] = self.sign * (one * from.a[k] + two * from.a[k + 1]);
                to.b[at] = one * from.b[k] + two * from.b[k + 1];
            }
        }
        to
    }

    /// The bodies and the joints in another order.
    pub fn shuffled(mut self, rng: &mut Rng) -> Self {
        let bodies = rng.order(self.mechanism.bodies.len());
        let joints = rng.order(self.mechanism.joints.len());
        let mechanism = &mut self.mechanism;
        mechanism.bodies = permuted(&mechanism.bodies, &bodies);
        mechanism.joints = permuted(&mechanism.joints, &joints);
        self.masses = permuted(&self.masses, &bodies);
        self.assembly.initial_guess = permuted(&self.assembly.initial_guess, &bodies);
        self.assembly.branch_hints = permuted(&self.assembly.branch_hints, &joints);
        mechanism.ground = bodies[mechanism.ground];
        let pairs = mechanism.joints.iter_mut().map(|j| &mut j.bodies);
        for pair in pairs.chain(mechanism.actuators.iter_mut().map(|a| &mut a.bodies)) {
            *pair = pair.map(|b| BodyId(bodies[b.0]));
        }
        for answer in &mut self.joints {
            answer.index = joints[answer.index];
        }
        self
    }

    /// Other names, whose alphabetical order is another one too.
    pub fn renamed(mut self, rng: &mut Rng) -> Self {
        let bodies = self.mechanism.bodies.iter_mut().map(|b| &mut b.name);
        let joints = self.mechanism.joints.iter_mut().map(|j| &mut j.name);
        let actuators = self.mechanism.actuators.iter_mut().map(|a| &mut a.name);
        for name in bodies.chain(joints).chain(actuators) {
            *name = format!("{:x}", rng.next());
        }
        self
    }

    /// Every moving body measured in another frame: its origin moved and its axes turned by β, so
    /// that the body's angle becomes θ + β.
    pub fn reframed(mut self, rng: &mut Rng) -> Self {
        for body in 0..self.mechanism.bodies.len() {
            if body == self.mechanism.ground {
                continue;
            }
            let origin = vec2(rng.between(-1.0, 1.0), rng.between(-1.0, 1.0));
            let beta = rng.between(-3.0, 3.0);
            let rotation = Vec2::from_angle(beta);
            self.map_body(
                body,
                |p| (p - origin).rotate_inverse(rotation),
                |t| t.rotate_inverse(rotation),
            );
            self.rotate_body(body, beta);
        }
        self
    }

    /// The whole mechanism turned by an angle about the origin.
    pub fn rotated(mut self, angle: f64) -> Self {
        let rotation = Vec2::from_angle(angle);
        let ground = self.mechanism.ground;
        self.map_body(ground, |p| p.rotate(rotation), |t| t.rotate(rotation));
        for body in (0..self.mechanism.bodies.len()).filter(|&b| b != ground) {
            self.rotate_body(body, angle);
        }
        self.map_reactions(|joint, answer| {
            if joint.kind == JointKind::Revolute {
                let [x, y] = answer.map;
                let mix = |p: f64, q: f64| [p * x[0] + q * y[0], p * x[1] + q * y[1]];
                answer.map = [mix(rotation.x, -rotation.y), mix(rotation.y, rotation.x)];
            }
        });
        self
    }

    /// The mechanism seen from behind: y → −y in the plane and in every frame.
    pub fn mirrored(mut self) -> Self {
        let flip = |v: Vec2| vec2(v.x, -v.y);
        for body in 0..self.mechanism.bodies.len() {
            self.map_body(body, flip, flip);
        }
        for angle in self.assembly.initial_guess.iter_mut().flatten() {
            *angle = -*angle;
        }
        self.reverse_coordinate();
        self.map_reactions(|joint, answer| {
            let signs = match joint.kind {
                JointKind::Revolute => [1.0, -1.0],
                _ => [-1.0, -1.0],
            };
            for (row, sign) in answer.map.iter_mut().zip(signs) {
                *row = row.map(|entry| sign * entry);
            }
        });
        self
    }

    /// The two bodies of each joint and of the actuator swapped, equation (2).
    pub fn swapped(mut self) -> Self {
        for joint in &mut self.mechanism.joints {
            joint.bodies.reverse();
            joint.points.reverse();
            if let JointKind::Prismatic { axes } = &mut joint.kind {
                axes.reverse();
            }
        }
        for actuator in &mut self.mechanism.actuators {
            actuator.bodies.reverse();
        }
        self.reverse_coordinate();
        self.map_reactions(|joint, answer| {
            let [first, second] = answer.map;
            let mut second = second.map(|entry| -entry);
            if joint.kind != JointKind::Revolute {
                second[0] -= answer.travel * first[0];
                answer.travel = -answer.travel;
            }
            answer.map = [first.map(|entry| -entry), second];
        });
        self
    }

    /// The whole mechanism moved.
    pub fn translated(mut self, offset: Vec2) -> Self {
        self.map_body(self.mechanism.ground, |p| p + offset, |t| t);
        self
    }

    /// The points and the axes of one body changed.
    fn map_body(&mut self, body: usize, point: impl Fn(Vec2) -> Vec2, axis: impl Fn(Vec2) -> Vec2) {
        for joint in &mut self.mechanism.joints {
            for i in 0..2 {
                if joint.bodies[i].0 == body {
                    joint.points[i] = point(joint.points[i]);
                    if let JointKind::Prismatic { axes } = &mut joint.kind {
                        axes[i] = axis(axes[i]);
                    }
                }
            }
        }
        self.masses[body].center = point(self.masses[body].center);
    }

    /// A body's angle larger by `angle`, with its rough value and what the actuator measures.
    fn rotate_body(&mut self, body: usize, angle: f64) {
        if let Some(guess) = &mut self.assembly.initial_guess[body] {
            *guess += angle;
        }
        let [first, second] = self.mechanism.actuators[0].bodies;
        for (end, sign) in [(first, -1.0), (second, 1.0)] {
            if end.0 == body {
                self.shift += sign * angle;
                self.assembly.q[0] += sign * angle;
            }
        }
    }

    fn reverse_coordinate(&mut self) {
        self.sign = -self.sign;
        self.shift = -self.shift;
        self.assembly.q[0] = -self.assembly.q[0];
    }

    fn map_reactions(&mut self, change: impl Fn(&Joint, &mut JointTransform)) {
        for answer in &mut self.joints {
            change(&self.mechanism.joints[answer.index], answer);
        }
    }
}

/// The direction (cos, sin) of a body's x axis in a pose.
pub fn direction(plan: &Plan, pose: &Pose<f64>, body: BodyId) -> Vec2 {
    let attitude = plan.frames().orientations[body.0];
    attitude.offset.rotate(pose.rotation[attitude.frame])
}

/// The travel u of every joint, from where the pose puts the bodies.
pub fn travels(mechanism: &Mechanism, plan: &Plan, pose: &Pose<f64>) -> Vec<f64> {
    let mut roots = Vec::new();
    plan.joint_origins(pose, &mut roots);
    let tree = plan.tree();
    let rotation = |body: usize| direction(plan, pose, BodyId(body));
    let position = |body: usize, point: Vec2| {
        let root =
            tree.joint_of_body[body].map_or(tree.joint_origins[mechanism.ground], |at| roots[at]);
        root + (point - tree.joint_origins[body]).rotate(rotation(body))
    };
    let travel = |joint: &Joint| match joint.kind {
        JointKind::Prismatic { axes } => {
            let [one, two] = [0, 1].map(|i| position(joint.bodies[i].0, joint.points[i]));
            (two - one).dot(axes[0].rotate(rotation(joint.bodies[0].0)))
        }
        _ => 0.0,
    };
    mechanism.joints.iter().map(travel).collect()
}

/// `count` positions that are no simple fraction of anything: over two turns either way, or
/// inside a range but for 5 % at either end.
pub fn positions(range: Range, count: u32) -> Vec<f64> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    (0..count)
        .map(|k| {
            let part = (f64::from(k) * golden + 0.123).fract();
            match range.limits() {
                None => (2.0 * part - 1.0) * TAU,
                Some((from, to)) => from + (0.05 + 0.9 * part) * (to - from),
            }
        })
        .collect()
}

/// Item i of the list at place `order[i]`.
fn permuted<T: Clone>(list: &[T], order: &[usize]) -> Vec<T> {
    let mut out = list.to_vec();
    for (item, &at) in list.iter().zip(order) {
        out[at] = item.clone();
    }
    out
}

/// Numbers that look random and are always the same (Steele, Lea and Flood 2014, SplitMix64).
pub struct Rng(pub u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [from, to).
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// The numbers below `n` in some order.
    pub fn order(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i, (self.next() % (i as u64 + 1)) as usize);
        }
        order
    }
}
