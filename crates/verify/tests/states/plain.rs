//! A plain kinetostatic solution in dense rows with any number of actuators, in the frames as they
//! are described and by its own elimination.

use crate::gauss::gauss;
use dwell_geometry::rows::Rows;
use dwell_geometry::{BodyId, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{LoadKind, Mass};
use dwell_verify::{State, load_acts};

/// The state at the coordinates, closed from `start`, with loads of given magnitudes.
pub(crate) fn state(
    mechanism: &Mechanism,
    masses: &[Mass],
    start: &[[f64; 3]],
    loads: &[(LoadKind, f64)],
    [q, q_dot, q_ddot]: [Vec<f64>; 3],
) -> State {
    let mut rows = Rows::new(mechanism).unwrap();
    let n = rows.len();
    assert_eq!(n, rows.columns());
    let x: Vec<f64> = (0..start.len())
        .filter(|&b| b != mechanism.ground)
        .flat_map(|b| start[b])
        .collect();
    rows.mesh(&x);
    let driven = n - mechanism.actuators.len();
    let first = measured(&rows, &x, driven);
    let mut x = x;
    // In steps, so that Newton's method stays on the branch.
    for i in 1..=STEPS {
        let share = f64::from(i) / f64::from(STEPS);
        let part = q.iter().zip(&first).map(|(q, f)| f + (q - f) * share);
        x = close(&rows, x, &part.collect::<Vec<_>>());
    }
    let jacobian = jacobian(&rows, &x);
    let mut right = vec![0.0; n];
    right[driven..].copy_from_slice(&q_dot);
    let x_dot = gauss(jacobian.clone(), &right, n);
    rows.curvature(&x, &x_dot, &mut right);
    for r in &mut right {
        *r = -*r;
    }
    for (r, a) in right[driven..].iter_mut().zip(&q_ddot) {
        *r += a;
    }
    let x_ddot = gauss(jacobian.clone(), &right, n);
    let by_body = |x: &[f64]| -> Vec<[f64; 3]> {
        let of = |b| {
            let column = rows.column(BodyId(b));
            column.map_or([0.0; 3], |c| [x[c], x[c + 1], x[c + 2]])
        };
        (0..start.len()).map(of).collect()
    };
    let (bodies, velocity) = (by_body(&x), by_body(&x_dot));
    let acts: Vec<_> = loads
        .iter()
        .flat_map(|(kind, magnitude)| {
            load_acts(
                kind,
                *magnitude,
                mechanism.ground,
                masses,
                &bodies,
                &velocity,
            )
            .unwrap()
        })
        .collect();
    let mut force = inertia(&rows, masses, &x, &x_dot, &x_ddot);
    for act in &acts {
        if let Some(c) = rows.column(act.body) {
            force[c] -= act.force.x;
            force[c + 1] -= act.force.y;
            force[c + 2] -= act.couple + (act.at - vec2(x[c], x[c + 1])).cross(act.force);
        }
    }
    let transposed = (0..n * n).map(|i| jacobian[(i % n) * n + i / n]).collect();
    let mut reactions = gauss(transposed, &force, n);
    let tau = reactions.split_off(driven);
    State {
        t: q[0],
        q,
        q_dot,
        q_ddot,
        acceleration: by_body(&x_ddot),
        bodies,
        velocity,
        reactions,
        tau,
        loads: acts,
    }
}

const STEPS: u32 = 40;

/// The coordinates of the actuators.
fn measured(rows: &Rows, x: &[f64], driven: usize) -> Vec<f64> {
    let mut residual = vec![0.0; rows.len()];
    rows.residual(x, &vec![0.0; rows.len()], &mut residual);
    residual.split_off(driven)
}

fn close(rows: &Rows, mut x: Vec<f64>, q: &[f64]) -> Vec<f64> {
    let n = rows.len();
    let mut imposed = vec![0.0; n];
    imposed[n - q.len()..].copy_from_slice(q);
    let mut residual = vec![0.0; n];
    let mut last = f64::INFINITY;
    for _ in 0..30 {
        rows.residual(&x, &imposed, &mut residual);
        let step = gauss(jacobian(rows, &x), &residual, n);
        for (x, s) in x.iter_mut().zip(&step) {
            *x -= s;
        }
        let size = step.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
        // One step after it cannot get better.
        if last < 1e-8 {
            return x;
        }
        last = size;
    }
    panic!("does not close at {q:?}");
}

fn jacobian(rows: &Rows, x: &[f64]) -> Vec<f64> {
    let mut jacobian = vec![0.0; x.len() * rows.len()];
    rows.jacobian(x, &mut jacobian);
    jacobian
}

fn inertia(rows: &Rows, masses: &[Mass], x: &[f64], x_dot: &[f64], x_ddot: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    for (b, mass) in masses.iter().enumerate() {
        if let Some(c) = rows.column(BodyId(b)) {
            let arm = mass.center.turn(Vec2::from_angle(x[c + 2]));
            let (m, omega) = (mass.mass, x_dot[c + 2]);
            let [ax, ay, alpha] = [x_ddot[c], x_ddot[c + 1], x_ddot[c + 2]];
            force[c] = m * (ax - arm.y * alpha - arm.x * omega * omega);
            force[c + 1] = m * (ay + arm.x * alpha - arm.y * omega * omega);
            force[c + 2] =
                mass.inertia * alpha + m * (arm.x * ay - arm.y * ax + arm.dot(arm) * alpha);
        }
    }
    force
}
