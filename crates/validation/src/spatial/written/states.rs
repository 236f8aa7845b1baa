//! Rows of a file as states, which the dense equations judge as they judge those of the model: closure, velocities, accelerations,
//! reactions, actions, power, momenta.

use super::super::claims::{NAMES, SpaceClaims};
use super::finding;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::Rows;
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{BodyMotion, Placement, Rotation, Vec3, vec3};
use dwell_kinetostatics::space::Axes;
use dwell_scene::SpaceScene;
use dwell_verify::FindingSpec;
use dwell_verify::space::{SpaceState, check_states_in_space};

/// Tolerance of forces on each body of a row.
const SPRINGS: f64 = 5e-11;
/// Tolerance of the reactions of a row.
const SPRINGS_ON_REACTIONS: f64 = 2e-11;
/// So many rows of a file are judged.
const STATES: usize = 6;
/// So many of them by kinetic energy alone, which takes some twenty closings a row of the constraints.
const BY_ENERGIES: usize = 1;

const POINTS: FindingSpec<'_> = FindingSpec {
    key: "written-points",
    check: Check::WrittenPositions,
    comparison: "positions, velocities and accelerations of all points of a body with one placement and motion of it",
    scale: "the size, or the largest velocity or acceleration of its kind",
    // The largest seen in a case is 2.5e-15.
    tolerance: 2e-13,
    tolerance_reason: "a sum of rounded terms",
};

/// The command by which actions are given or not.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Forced,
    Free,
}

impl Kind {
    fn file(self) -> &'static str {
        match self {
            Self::Forced => "kinetostatics",
            Self::Free => "motion",
        }
    }
}

/// The findings of rows of a file.
pub(super) fn findings(
    claims: &SpaceClaims<'_>,
    scene: &SpaceScene,
    rows: &Rows,
    kind: Kind,
) -> Result<Vec<Finding>, String> {
    let mut points = Differences::default();
    let mut states = Vec::new();
    for k in 0..STATES.min(rows.count) {
        // Not at its ends: there a coordinate may be at the end of its range, or of a turn, where an idle body may stand in another way.
        let row = (k * rows.count + rows.count / 3) / STATES;
        let state = state(claims, scene, (rows, row), kind)?;
        compare_points(&mut points, claims, scene, (rows, row), &state);
        states.push(state);
    }
    let mut found = check_states_in_space(&claims.case(), &states, BY_ENERGIES);
    for of in &mut found {
        let what = of.key.trim_start_matches("state-");
        of.check = written_check(what);
        let springs = match what {
            // The largest seen in a case is 5.7e-13: stiff springs feel the rounding of rotation vectors.
            "newton-euler" => Some(SPRINGS),
            // 1.3e-12 is seen.
            "reactions" => Some(SPRINGS_ON_REACTIONS),
            _ => None,
        };
        if let Some(springs) = springs {
            of.tolerance = of.tolerance.max(springs);
            of.tolerance_reason = "springs feel the rounding of rotation vectors".to_owned();
            of.pass = of.relative_difference <= of.tolerance;
        }
        of.key = format!("written-{}-{what}", kind.file());
        of.domain = format!("{} rows of {}", states.len(), kind.file());
    }
    let of_points = finding(points, &POINTS, rows, kind.file()).map(|f| Finding {
        key: format!("written-{}-points", kind.file()),
        ..f
    });
    found.extend(of_points);
    Ok(found)
}

/// The number of the check of written rows that a check of states belongs to.
fn written_check(what: &str) -> Check {
    match what {
        "poses" | "branch" | "mesh" => Check::WrittenPositions,
        "velocities" | "accelerations" => Check::WrittenRates,
        "power" | "joint-power" | "released" | "kinetic-energy" | "mass-matrix" | "lagrange" => {
            Check::WrittenTotals
        }
        _ => Check::WrittenForces,
    }
}

/// A row as a state. What no column says is the model's.
pub(super) fn state(
    claims: &SpaceClaims<'_>,
    scene: &SpaceScene,
    (rows, row): (&Rows, usize),
    kind: Kind,
) -> Result<SpaceState, String> {
    let actuators = &scene.mechanism.actuators;
    let column = |end: &str| -> Result<Vec<f64>, String> {
        let of = actuators.iter().map(|a| {
            let name = format!("{}{end}", a.name);
            rows.get(row, &name).ok_or(format!("no column {name}"))
        });
        of.collect()
    };
    let [q, q_dot, q_ddot] = [column("")?, column(".velocity")?, column(".acceleration")?];
    let t = rows.get(row, "t").unwrap_or(0.0);
    let rates = [&q[..], &q_dot[..], &q_ddot[..]];
    let claimed = claims.state::<f64>(t, rates, Axes::Ground);
    let mut state = claimed.map_err(|e| e.to_string())?;
    for (b, body) in scene.mechanism.bodies.iter().enumerate() {
        let written = placement(scene, (rows, row), b);
        if let Some((placement, motion)) = written {
            (state.placements[b], state.motions[b]) = (placement, motion);
        } else if b != scene.mechanism.ground {
            return Err(format!("no columns of {}", body.name));
        }
    }
    state.tau = match kind {
        Kind::Forced => column(".actuator_force")?,
        Kind::Free => vec![0.0; q.len()],
    };
    let vectors = scene.mechanism.joints.iter().zip(&mut state.reactions);
    for (joint, reaction) in vectors {
        let (f, m) = (&mut reaction.force, &mut reaction.moment);
        let parts = [&mut f.x, &mut f.y, &mut f.z, &mut m.x, &mut m.y, &mut m.z];
        for (end, part) in NAMES.into_iter().zip(parts) {
            if let Some(value) = rows.get(row, &format!("{}.{end}", joint.name)) {
                *part = value;
            }
        }
    }
    if let Some(power) = rows.get(row, "power.loads") {
        state.load_power = power;
    }
    Ok(state)
}

/// Three columns.
pub(super) fn vector((rows, row): (&Rows, usize), name: &str, ends: [&str; 3]) -> Option<Vec3> {
    let part = |end: &str| rows.get(row, &format!("{name}.{end}"));
    Some(vec3(part(ends[0])?, part(ends[1])?, part(ends[2])?))
}

const POSITION: [&str; 3] = ["x", "y", "z"];
const VELOCITY: [&str; 3] = ["vx", "vy", "vz"];
const ACCELERATION: [&str; 3] = ["ax", "ay", "az"];

/// Placement and motion of a body, from its rotation and its first point.
fn placement(
    scene: &SpaceScene,
    at: (&Rows, usize),
    body: usize,
) -> Option<(Placement, BodyMotion)> {
    let name = &scene.mechanism.bodies[body].name;
    let of = |what: &str| vector(at, &format!("{name}.{what}"), POSITION);
    let rotation = Rotation::of_vector(of("rotation")?);
    let (w, e) = (of("angular_velocity")?, of("angular_acceleration")?);
    let (point, local) = scene.points[body].first()?;
    let point = format!("{name}.{point}");
    let arm = rotation.apply(*local);
    let placement = Placement {
        position: vector(at, &point, POSITION)? - arm,
        rotation,
    };
    let motion = BodyMotion {
        velocity: vector(at, &point, VELOCITY)? - w.cross(arm),
        angular_velocity: w,
        acceleration: vector(at, &point, ACCELERATION)? - e.cross(arm) - w.cross(w.cross(arm)),
        angular_acceleration: e,
    };
    Some((placement, motion))
}

/// The other points of each body.
fn compare_points(
    worst: &mut Differences,
    claims: &SpaceClaims<'_>,
    scene: &SpaceScene,
    at: (&Rows, usize),
    state: &SpaceState,
) {
    let size = claims.case().size;
    let motions = state.motions.iter();
    let speed = motions.fold(0.0_f64, |max, m| {
        max.max(m.velocity.norm())
            .max(size * m.angular_velocity.norm())
    });
    let motions = state.motions.iter();
    let rate = motions.fold(speed * speed / size, |max, m| {
        max.max(m.acceleration.norm())
            .max(size * m.angular_acceleration.norm())
    });
    for (b, body) in scene.mechanism.bodies.iter().enumerate() {
        let (placement, motion) = (&state.placements[b], &state.motions[b]);
        for (point, local) in scene.points[b].iter().skip(1) {
            let name = format!("{}.{point}", body.name);
            let arm = placement.rotation.apply(*local);
            let wanted = [
                (POSITION, placement.position + arm, size, "m"),
                (VELOCITY, motion.point_velocity(arm), speed, "m/s"),
                (ACCELERATION, motion.point_acceleration(arm), rate, "m/s2"),
            ];
            for (ends, wanted, scale, unit) in wanted {
                if let Some(found) = vector(at, &name, ends) {
                    let difference = (found - wanted).norm();
                    worst.compare([difference, 0.0, scale], unit, || {
                        format!("row {}, {name}.{}", at.1, ends[0])
                    });
                }
            }
        }
    }
}
