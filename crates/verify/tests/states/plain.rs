//! A plain kinetostatic solution in dense rows with any number of actuators, in the frames as they
//! are described and by its own elimination.

use crate::gauss::gauss;
use dwell_geometry::constraint_rows::ConstraintRows;
use dwell_geometry::space::vec3;
use dwell_geometry::{BodyId, Mechanism, Vec2};
use dwell_kinetostatics::{LoadKind, Mass};
use dwell_verify::{ClaimedState, Pose, Twist, load_wrenches};

/// The state at the coordinates, closed from `start`, with loads of given magnitudes.
// Long: the equations of a state in one piece, as in a textbook.
pub(crate) fn state(
    mechanism: &Mechanism,
    masses: &[Mass],
    assembly_poses: &[[f64; 3]],
    loads: &[(LoadKind, f64)],
    [q, q_dot, q_ddot]: [Vec<f64>; 3],
) -> ClaimedState {
    let mut rows = ConstraintRows::new(mechanism).unwrap();
    let n = rows.len();
    assert_eq!(n, rows.columns());
    let x: Vec<f64> = (0..assembly_poses.len())
        .filter(|&b| b != mechanism.ground)
        .flat_map(|b| assembly_poses[b])
        .collect();
    rows.mesh(&x);
    let actuator_row = n - mechanism.actuators.len();
    let first = actuator_coordinates(&rows, &x, actuator_row);
    let mut x = x;
    // In steps, so that Newton's method stays on the branch.
    for i in 1..=STEPS {
        let fraction = f64::from(i) / f64::from(STEPS);
        let part = q.iter().zip(&first).map(|(q, f)| f + (q - f) * fraction);
        x = close(&rows, x, &part.collect::<Vec<_>>());
    }
    let jacobian = jacobian(&rows, &x);
    let mut right = vec![0.0; n];
    right[actuator_row..].copy_from_slice(&q_dot);
    let x_dot = gauss(jacobian.clone(), &right, n);
    rows.velocity_product(&x, &x_dot, &mut right);
    for r in &mut right {
        *r = -*r;
    }
    for (r, a) in right[actuator_row..].iter_mut().zip(&q_ddot) {
        *r += a;
    }
    let x_ddot = gauss(jacobian.clone(), &right, n);
    let by_body = |x: &[f64]| -> Vec<[f64; 3]> {
        let of = |b| {
            let column = rows.column(BodyId(b));
            column.map_or([0.0; 3], |c| [x[c], x[c + 1], x[c + 2]])
        };
        (0..assembly_poses.len()).map(of).collect()
    };
    let (bodies, velocity) = (by_body(&x), by_body(&x_dot));
    let wrenches: Vec<_> = loads
        .iter()
        .flat_map(|(kind, magnitude)| {
            load_wrenches(
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
    for wrench in &wrenches {
        if let Some(c) = rows.column(wrench.body) {
            force[c] -= wrench.force.x;
            force[c + 1] -= wrench.force.y;
            force[c + 2] -=
                (wrench.couple + (wrench.point - vec3(x[c], x[c + 1], 0.0)).cross(wrench.force)).z;
        }
    }
    let transposed = (0..n * n).map(|i| jacobian[(i % n) * n + i / n]).collect();
    let mut reactions = gauss(transposed, &force, n);
    let tau = reactions.split_off(actuator_row);
    ClaimedState {
        name: format!("q = {q:?}"),
        q,
        q_dot,
        q_ddot,
        accelerations: Twist::all_in_plane(&by_body(&x_ddot)),
        poses: Pose::all_in_plane(&bodies),
        velocities: Twist::all_in_plane(&velocity),
        reactions,
        tau,
        load_wrenches: wrenches,
        ..ClaimedState::default()
    }
}

const STEPS: u32 = 40;

/// The coordinates of the actuators.
fn actuator_coordinates(rows: &ConstraintRows, x: &[f64], actuator_row: usize) -> Vec<f64> {
    let mut residual = vec![0.0; rows.len()];
    rows.residual(x, &vec![0.0; rows.len()], &mut residual);
    residual.split_off(actuator_row)
}

fn close(rows: &ConstraintRows, mut x: Vec<f64>, q: &[f64]) -> Vec<f64> {
    let n = rows.len();
    let mut row_values = vec![0.0; n];
    row_values[n - q.len()..].copy_from_slice(q);
    let mut residual = vec![0.0; n];
    let mut last = f64::INFINITY;
    for _ in 0..30 {
        rows.residual(&x, &row_values, &mut residual);
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

fn jacobian(rows: &ConstraintRows, x: &[f64]) -> Vec<f64> {
    let mut jacobian = vec![0.0; x.len() * rows.len()];
    rows.jacobian(x, &mut jacobian);
    jacobian
}

fn inertia(
    rows: &ConstraintRows,
    masses: &[Mass],
    x: &[f64],
    x_dot: &[f64],
    x_ddot: &[f64],
) -> Vec<f64> {
    let mut force = vec![0.0; x.len()];
    for (b, mass) in masses.iter().enumerate() {
        if let Some(c) = rows.column(BodyId(b)) {
            let arm = mass.center.rotate(Vec2::from_angle(x[c + 2]));
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
