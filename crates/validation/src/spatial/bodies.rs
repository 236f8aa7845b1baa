//! Newton's and Euler's equations of each body, with its momenta differenced from positions alone:
//!
//! ```text
//! F = m c̈,     M + Σ (p − c) × F = dL/dt,     L = R I Rᵀ ω,     ω̂ = Ṙ Rᵀ          at q̇ = 1, q̈ = 0
//! ```

use super::samples::{PASSES, Samples};
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Placement, Vec3, Wrench, vec3};
use dwell_kinetostatics::InverseDynamics;
use dwell_verify::space::joint_actions;

/// The step of the differences, in parts of the range of an angle of one radian or of the mechanism's size.
const STEP: f64 = 2e-3;
/// Steps on each side: two of the second differences beyond two of the first.
const REACH: usize = 4;

/// The first derivative at the middle of five equally spaced values, of the fourth order in their distance.
fn derivative(of: impl Fn(usize) -> Vec3, middle: usize, step: f64) -> Vec3 {
    let near = of(middle + 1) - of(middle - 1);
    let far = of(middle + 2) - of(middle - 2);
    (near.scaled(8.0) - far).scaled(1.0 / (12.0 * step))
}

/// Momentum and angular momentum about the centre, which the placements at successive positions show at unit speed.
fn momenta(
    samples: &Samples<'_>,
    body: usize,
    poses: &[Vec<Placement>],
    (at, step): (usize, f64),
) -> [Vec3; 2] {
    let mass = &samples.scene.masses[body];
    let center = |k: usize| {
        let Placement { position, rotation } = poses[k][body];
        position + rotation.apply(mass.center)
    };
    let velocity = derivative(center, at, step);
    let rotation = poses[at][body].rotation;
    // ω = ½ Σ u × u̇ over the body's axes.
    let mut omega = Vec3::ZERO;
    for (axis, along) in Vec3::AXES.iter().zip(rotation.columns) {
        let rate = derivative(|k| poses[k][body].rotation.apply(*axis), at, step);
        omega += along.cross(rate).scaled(0.5);
    }
    // How a body stands about the line of its two balls is nobody's: there its rotation is none.
    let idle = samples.model.plan().mobility().idle.iter();
    for idle in idle.filter(|idle| idle.body == BodyId(body)) {
        let line = rotation.apply(idle.axis);
        omega -= line.scaled(line.dot(omega));
    }
    let angular = rotation.apply(mass.angular_momentum(rotation.apply_inverse(omega)));
    [velocity.scaled(mass.mass), angular]
}

/// Force and moment about its centre that the joints and the actuator give each body.
fn given(
    samples: &Samples<'_>,
    placements: &[Placement],
    found: &InverseDynamics<f64>,
) -> Vec<[Vec3; 2]> {
    let mechanism = &samples.scene.mechanism;
    let centre = |b: usize| {
        placements[b].position + placements[b].rotation.apply(samples.scene.masses[b].center)
    };
    let mut all = vec![[Vec3::ZERO; 2]; placements.len()];
    let mut give = |body: usize, at: Vec3, force: Vec3, moment: Vec3| {
        all[body][0] += force;
        all[body][1] += moment + (at - centre(body)).cross(force);
    };
    let wrench = |all: &[f64]| Wrench {
        force: vec3(all[0], all[1], all[2]),
        moment: vec3(all[3], all[4], all[5]),
    };
    let reactions: Vec<Wrench> = found.reactions.chunks(6).map(wrench).collect();
    let actions = joint_actions(mechanism, placements, &reactions, &found.tau);
    for (joint, (at, Wrench { force, moment })) in mechanism.joints.iter().zip(actions) {
        let [first, second] = joint.bodies.map(|b| b.0);
        give(second, at, force, moment);
        give(first, at, -force, -moment);
    }
    all
}

/// The largest differences of forces and of moments over all positions, relative to the largest of their kind there.
pub(super) fn body_by_body(samples: &mut Samples<'_>) -> Result<[Differences; 2], ValidationError> {
    let mut worst = <[Differences; 2]>::default();
    let is_angle = samples.model.plan().is_angle(0);
    let step = STEP
        * if is_angle {
            1.0
        } else {
            samples.model.plan().size()
        };
    for q in samples.q.clone() {
        let around = (0..=2 * REACH).map(|k| q + step * (k as f64 - REACH as f64));
        let poses: Result<Vec<_>, _> = around.map(|q| samples.placements(q)).collect();
        let Ok(poses) = poses else {
            // A limit position is nearer than the differences reach.
            continue;
        };
        let found = samples.found(q, PASSES[0])?;
        let given = given(samples, &poses[REACH], &found);
        let largest = |k: usize| given.iter().map(|g| g[k].norm()).fold(0.0, f64::max);
        let floor = samples.floor(PASSES[0]);
        let size = samples.model.plan().size();
        let scales = [largest(0).max(floor), largest(1).max(floor * size)];
        for (body, given) in given.iter().enumerate() {
            if body == samples.scene.mechanism.ground {
                continue;
            }
            let of = |at: usize| momenta(samples, body, &poses, (at, step));
            let all: Vec<[Vec3; 2]> = (REACH - 2..=REACH + 2).map(of).collect();
            let name = &samples.scene.mechanism.bodies[body].name;
            for (k, unit) in ["kg m", "kg m2"].into_iter().enumerate() {
                let rate = derivative(|i| all[i][k], 2, step);
                let error = (given[k] - rate).norm();
                worst[k].compare([error, 0.0, scales[k]], unit, || {
                    format!("q = {q:.4}, {name}")
                });
            }
        }
    }
    Ok(worst)
}
