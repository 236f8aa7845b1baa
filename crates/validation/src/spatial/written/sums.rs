//! Sums over bodies and loads of a row: power, energies, the force and moment on the ground, and magnitudes of vectors.

use super::super::claims::{NAMES, SpaceClaims, constant};
use super::finding;
use super::states::{Kind, state, vector};
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::{Rows, largest};
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{ActuatorKind, Vec3};
use dwell_kinetostatics::space::LoadKind;
use dwell_scene::SpaceScene;
use dwell_verify::FindingSpec;
use dwell_verify::space::{SpaceState, potential_energy};

const SUMS: FindingSpec<'_> = FindingSpec {
    key: "written-sums",
    check: Check::WrittenTotals,
    comparison: "powers, energies, the force and moment on the ground and magnitudes with sums over the bodies and loads of the row",
    scale: "the largest of each kind in the file, or the largest sum of its absolute terms",
    // The largest seen in a case is 9.8e-15.
    tolerance: 9e-13,
    tolerance_reason: "a sum of rounded terms",
};

/// Sums of a row, by the name of their column, each with the sum of its absolute terms.
type Sums = Vec<(String, f64, f64)>;

/// The findings of a file's rows.
pub(super) fn findings(
    claims: &SpaceClaims<'_>,
    scene: &SpaceScene,
    rows: &Rows,
    file: &str,
) -> Option<Finding> {
    let kind = match file {
        "kinetostatics" => Kind::Forced,
        _ => Kind::Free,
    };
    let mut worst = Differences::default();
    let mut start: Option<f64> = None;
    let step = (rows.count / 8).max(1);
    for row in (0..rows.count).step_by(step) {
        let Ok(state) = state(claims, scene, (rows, row), kind) else {
            continue;
        };
        let mut sums = of_bodies(scene, &state, claims.case().size);
        sums.extend(magnitudes(scene, (rows, row)));
        if let Some(potential) = potential(claims, scene, &state) {
            let kinetic = sums.iter().find(|s| s.0 == "energy.kinetic_bodies");
            let kinetic = kinetic.map_or(0.0, |s| s.1);
            let total = kinetic + potential;
            let from = *start.get_or_insert(total);
            let size = kinetic + potential.abs() + from.abs();
            if kind == Kind::Free && scene.drives.is_empty() {
                sums.push(("energy.balance_error".to_owned(), total - from, size));
                sums.push(("energy.kinetic".to_owned(), kinetic, size));
            }
        }
        for (name, wanted, size) in sums {
            let Some(found) = rows.get(row, &name) else {
                continue;
            };
            let largest = size.max(largest(rows.column(&name)));
            worst.compare([found, wanted, largest], "", || {
                format!("row {row}, {name}")
            });
        }
    }
    let found = finding(worst, &SUMS, rows, file)?;
    Some(Finding {
        key: format!("written-{file}-sums"),
        ..found
    })
}

/// Powers, kinetic energy, force and moment on the ground.
// Long because all sums are over the same bodies.
fn of_bodies(scene: &SpaceScene, state: &SpaceState, mechanism_size: f64) -> Sums {
    let weight = gravity(state);
    let (mut force, mut moment, mut energy) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    let [mut rate, mut size, mut by_weight] = [[0.0; 2]; 3];
    for (b, mass) in scene.masses.iter().enumerate() {
        if b == scene.mechanism.ground {
            continue;
        }
        let (placement, motion) = (&state.placements[b], &state.motions[b]);
        let arm = placement.rotation.apply(mass.center);
        let center = placement.position + arm;
        let tensor = |v: Vec3| {
            let turned = placement.rotation.apply_inverse(v);
            placement.rotation.apply(mass.angular_momentum(turned))
        };
        let (w, v) = (motion.angular_velocity, motion.point_velocity(arm));
        let rates = [
            motion.point_acceleration(arm).scaled(mass.mass),
            tensor(motion.angular_acceleration) + w.cross(tensor(w)),
        ];
        let left = weight.scaled(mass.mass) - rates[0];
        force += left;
        moment += center.cross(left) - rates[1];
        let absolute = weight.norm() * mass.mass + rates[0].norm();
        size[0] += absolute;
        size[1] += center.norm() * absolute + rates[1].norm();
        let parts = [v.dot(rates[0]), w.dot(rates[1])];
        rate[0] += parts[0] + parts[1];
        rate[1] += parts[0].abs() + parts[1].abs();
        energy += 0.5 * (v.dot(v) * mass.mass + w.dot(tensor(w)));
        by_weight[0] += weight.scaled(mass.mass).dot(v);
        by_weight[1] += weight.norm() * mass.mass * v.norm();
    }
    let actuators = state.tau.iter().zip(&state.q_dot).map(|(f, v)| f * v);
    let driven: f64 = actuators.clone().sum();
    let driven_size: f64 = actuators.map(f64::abs).sum();
    // Where nothing changes, the kinetic energy in the time of a radian.
    let speeds = scene.mechanism.actuators.iter().zip(&state.q_dot);
    let fastest = speeds.fold(0.0_f64, |max, (actuator, v)| match actuator.kind {
        ActuatorKind::Angle(_) => max.max(v.abs()),
        ActuatorKind::Travel(_) | ActuatorKind::Length(_) => max.max(v.abs() / mechanism_size),
    });
    let all = rate[1] + driven_size + state.load_power.abs() + energy * fastest;
    let mut sums = vec![
        ("power.actuators".to_owned(), driven, all),
        ("power.kinetic".to_owned(), rate[0], all),
        ("power.residual".to_owned(), 0.0, all),
        ("energy.kinetic_bodies".to_owned(), energy, energy),
    ];
    let only_weights =
        |kind: &LoadKind| !matches!(kind, LoadKind::Force { .. } | LoadKind::Torque { .. });
    if scene.loads.iter().all(|load| only_weights(&load.kind)) && scene.drives.is_empty() {
        let parts = |v: Vec3| [v.x, v.y, v.z];
        let ends = ["x", "y", "z"]
            .into_iter()
            .zip(parts(force))
            .zip(parts(moment));
        for ((end, f), m) in ends {
            sums.push((format!("shaking.f{end}"), f, size[0]));
            sums.push((format!("shaking.m{end}"), m, size[1]));
        }
    }
    let mut gravities = scene
        .loads
        .iter()
        .filter(|load| matches!(load.kind, LoadKind::Gravity(_)));
    if let (Some(load), None) = (gravities.next(), gravities.next()) {
        sums.push((format!("{}.power", load.name), by_weight[0], by_weight[1]));
    }
    sums
}

/// The weight of a unit of mass, N/kg.
fn gravity(state: &SpaceState) -> Vec3 {
    let weights = state
        .loads
        .iter()
        .filter_map(|(kind, magnitude)| match kind {
            LoadKind::Gravity(g) => Some(g.scaled(*magnitude)),
            _ => None,
        });
    weights.fold(Vec3::ZERO, |sum, weight| sum + weight)
}

/// Magnitudes of forces and moments whose three components are columns.
fn magnitudes(scene: &SpaceScene, at: (&Rows, usize)) -> Sums {
    let mut sums = Vec::new();
    for joint in &scene.mechanism.joints {
        let (parts, _) = NAMES.as_chunks::<3>();
        for (end, parts) in ["magnitude", "moment-magnitude"].into_iter().zip(parts) {
            if let Some(v) = vector(at, &joint.name, *parts) {
                sums.push((format!("{}.{end}", joint.name), v.norm(), v.norm()));
            }
        }
    }
    sums
}

/// The potential energy of all loads, J; none if one of them has none.
fn potential(claims: &SpaceClaims<'_>, scene: &SpaceScene, state: &SpaceState) -> Option<f64> {
    let loads = scene.loads.iter();
    loads
        .map(|load| potential_energy(&claims.case(), &state.placements, constant(load)?))
        .sum()
}
