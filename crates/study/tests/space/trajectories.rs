//! Kinematics, statics and kinetostatics of the scenes of `validation/spatial`: every row of the written tables against the dense
//! equations of all bodies, which share neither tree nor closures with what wrote them.

use super::{SCENES, scene};
use dwell_findings::Table;
use dwell_geometry::JointId;
use dwell_geometry::space::{ActuatorKind, BodyMotion, Placement, Rotation, Vec3, vec3};
use dwell_kinetostatics::Magnitude;
use dwell_kinetostatics::space::{Axes, Component, Load};
use dwell_scene::SpaceScene;
use dwell_study::{
    Analysis, MotionSolver, PictureSpan, SolverSettings, TrajectoryOutcome,
    analyse_trajectory_within, compute_free_motion, no_progress,
};
use dwell_verify::space::DenseSpace;

/// Relative to the largest of the unit: a hundred times what rounding and the digits of a rotation as a vector leave.
const ALLOWED: f64 = 2e-11;

/// An accelerated motion of all actuators from the assembly.
fn accelerated(name: &str) -> SpaceScene {
    let actuators = scene(name, "");
    let mut motion = "\n[prescribed]\nduration = 0.5\npoints = 7\n".to_owned();
    let starts = actuators
        .mechanism
        .actuators
        .iter()
        .zip(&actuators.assembly.q);
    for (actuator, start) in starts {
        motion += &format!(
            "{} = {{ expression = \"{start} + 1.2*t + 0.9*t^2\" }}\n",
            actuator.name
        );
    }
    scene(name, &motion)
}

/// The table that an analysis writes, as a reader of the file gets it.
pub(super) fn written(done: &TrajectoryOutcome) -> Table {
    let mut files = done.outcome.files.iter();
    let table = files.find(|(path, _)| {
        let name = path.to_string_lossy();
        name.ends_with(".csv") && !name.ends_with("-extrema.csv") && !name.ends_with("-events.csv")
    });
    let (_, bytes) = table.expect("a table");
    let text = std::str::from_utf8(bytes).expect("text");
    let mut lines = text.lines();
    let heads = lines.next().expect("a header").split(',');
    let columns = heads.map(|head| {
        let (name, unit) = head.split_once(" [").unwrap_or((head, ""));
        dwell_findings::Column::new(name, unit.trim_end_matches(']'))
    });
    Table {
        columns: columns.collect(),
        rows: lines
            .map(|line| {
                line.split(',')
                    .map(|v| v.parse().expect("a number"))
                    .collect()
            })
            .collect(),
    }
}

/// A row by the names of its columns.
struct Row<'a> {
    table: &'a Table,
    values: &'a [f64],
}

impl Row<'_> {
    fn get(&self, name: &str) -> Option<f64> {
        let column = self.table.columns.iter().position(|c| c.name == name)?;
        Some(self.values[column])
    }

    fn number(&self, name: &str) -> f64 {
        self.get(name)
            .unwrap_or_else(|| panic!("no column `{name}`"))
    }

    fn vector(&self, names: [String; 3]) -> Vec3 {
        let [x, y, z] = names.map(|name| self.number(&name));
        vec3(x, y, z)
    }

    /// The placements of all bodies, by their rotations and one point of each.
    fn placements(&self, scene: &SpaceScene) -> Vec<Placement> {
        let bodies = scene.mechanism.bodies.iter().enumerate();
        let placement = |(b, body): (usize, &dwell_geometry::Body)| {
            if b == scene.mechanism.ground {
                return Placement::default();
            }
            let name = &body.name;
            let rotation = self.vector(["x", "y", "z"].map(|a| format!("{name}.rotation.{a}")));
            let rotation = Rotation::of_vector(rotation);
            let (point, at) = &scene.points[b][0];
            let place = self.vector(["x", "y", "z"].map(|a| format!("{name}.{point}.{a}")));
            Placement {
                position: place - rotation.apply(*at),
                rotation,
            }
        };
        bodies.map(placement).collect()
    }
}

/// The largest differences, each with the largest value of its unit.
#[derive(Default)]
struct Compared {
    /// By unit: difference and size.
    units: Vec<(String, f64, f64)>,
    count: usize,
}

impl Compared {
    fn add(&mut self, unit: &str, found: f64, wanted: f64) {
        if !self.units.iter().any(|(u, ..)| u == unit) {
            self.units.push((unit.to_owned(), 0.0, 0.0));
        }
        let (_, off, size) = self.units.iter_mut().find(|(u, ..)| u == unit).expect("it");
        *off = off.max((found - wanted).abs());
        *size = size.max(wanted.abs());
        self.count += 1;
    }

    fn vector(&mut self, unit: &str, found: Vec3, wanted: Vec3) {
        self.add(unit, found.x, wanted.x);
        self.add(unit, found.y, wanted.y);
        self.add(unit, found.z, wanted.z);
    }

    fn assert(&self, what: &str, size: f64) {
        let of = |unit: &str| {
            let found = self.units.iter().find(|(u, ..)| u == unit);
            found.map_or(0.0, |(_, _, size)| *size)
        };
        let (force, moment) = (of("N"), of("N m"));
        for (unit, off, largest) in &self.units {
            let scale = match unit.as_str() {
                "N" => force.max(moment / size),
                "N m" => moment.max(force * size),
                // Points may stay where they are while the bodies turn.
                "m/s" => largest.max(size * of("rad/s")),
                "m/s2" => largest.max(size * of("rad/s2")),
                _ => *largest,
            };
            assert!(
                *off <= ALLOWED * scale.max(1e-12),
                "{what}: {off:.1e} {unit} of {scale:.1e}"
            );
        }
    }
}

/// Velocities and accelerations of a row.
fn compare_motion(scene: &SpaceScene, row: &Row<'_>, dense: &DenseSpace, found: &mut Compared) {
    let placements = row.placements(scene);
    for (b, body) in scene.mechanism.bodies.iter().enumerate() {
        if b == scene.mechanism.ground {
            continue;
        }
        let motion: &BodyMotion = &dense.motions[b];
        let of = |word: &str| ["x", "y", "z"].map(|a| format!("{}.{word}.{a}", body.name));
        found.vector(
            "rad/s",
            row.vector(of("angular_velocity")),
            motion.angular_velocity,
        );
        found.vector(
            "rad/s2",
            row.vector(of("angular_acceleration")),
            motion.angular_acceleration,
        );
        for (point, at) in &scene.points[b] {
            let arm = placements[b].rotation.apply(*at);
            let of = |letter: &str| {
                ["x", "y", "z"].map(|a| format!("{}.{point}.{letter}{a}", body.name))
            };
            found.vector("m", row.vector(of("")), placements[b].position + arm);
            found.vector("m/s", row.vector(of("v")), motion.point_velocity(arm));
            found.vector("m/s2", row.vector(of("a")), motion.point_acceleration(arm));
        }
    }
}

/// Actuator forces, reactions, magnitudes; the forces on the ground by those of its joints and actuators.
fn compare_forces(scene: &SpaceScene, row: &Row<'_>, dense: &DenseSpace, found: &mut Compared) {
    let (mechanism, placements) = (&scene.mechanism, row.placements(scene));
    let [mut force, mut moment] = [Vec3::ZERO; 2];
    let on_ground = |j: JointId| {
        mechanism.joints[j.0]
            .bodies
            .iter()
            .position(|b| b.0 == mechanism.ground)
    };
    let joint_place = |j: JointId| {
        let joint = &mechanism.joints[j.0];
        let placement = &placements[joint.bodies[1].0];
        placement.position + placement.rotation.apply(joint.sides[1].point)
    };
    for (j, joint) in mechanism.joints.iter().enumerate() {
        let wrench = &dense.reactions[j];
        let id = JointId(j);
        if let Some(side) = on_ground(id) {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let acting = wrench.force.scaled(sign);
            force += acting;
            moment += joint_place(id).cross(acting) + wrench.moment.scaled(sign);
        }
        if let Some(magnitude) = row.get(&format!("{}.magnitude", joint.name)) {
            found.add("N", magnitude, wrench.force.norm());
        }
        if let Some(magnitude) = row.get(&format!("{}.moment-magnitude", joint.name)) {
            found.add("N m", magnitude, wrench.moment.norm());
        }
    }
    for (i, actuator) in mechanism.actuators.iter().enumerate() {
        let (id, tau) = (actuator.kind.joint(), dense.actuator_actions[i]);
        let unit = match actuator.kind {
            ActuatorKind::Angle(_) => "N m",
            ActuatorKind::Travel(_) | ActuatorKind::Length(_) => "N",
        };
        found.add(
            unit,
            row.number(&format!("{}.actuator_force", actuator.name)),
            tau,
        );
        let joint = &mechanism.joints[id.0];
        if let Some(side) = on_ground(id) {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let first = &placements[joint.bodies[0].0];
            let axis = match actuator.kind {
                ActuatorKind::Angle(_) | ActuatorKind::Travel(_) => {
                    first.rotation.apply(joint.sides[0].axis)
                }
                ActuatorKind::Length(_) => {
                    let from = first.position + first.rotation.apply(joint.sides[0].point);
                    let along = joint_place(id) - from;
                    along.scaled(1.0 / along.norm())
                }
            };
            let acting = axis.scaled(sign * tau);
            match unit {
                "N" => {
                    force += acting;
                    moment += joint_place(id).cross(acting);
                }
                _ => moment += acting,
            }
        }
    }
    for reaction in &scene.requests.reactions {
        let Some(value) = row.get(&scene.reaction_name(*reaction)) else {
            continue;
        };
        let wrench = &dense.reactions[reaction.joint.0];
        let part = |v: Vec3, k: usize| [v.x, v.y, v.z][k];
        match reaction.component {
            Component::Force(Axes::Ground, k) => found.add("N", value, part(wrench.force, k)),
            Component::Moment(Axes::Ground, k) => found.add("N m", value, part(wrench.moment, k)),
            Component::Force(Axes::Joint | Axes::Line, _)
            | Component::Moment(Axes::Joint | Axes::Line, _) => {
                panic!("not requested here")
            }
        }
    }
    let shaking = |names: [&str; 3]| row.vector(names.map(|n| format!("shaking.{n}")));
    found.vector("N", shaking(["fx", "fy", "fz"]), force);
    found.vector("N m", shaking(["mx", "my", "mz"]), moment);
}

fn compare(name: &str, analysis: Analysis) -> usize {
    let scene = accelerated(name);
    let done =
        analyse_trajectory_within(&scene, analysis, None, PictureSpan::default(), &no_progress)
            .unwrap_or_else(|e| panic!("{name}: {e:?}"));
    assert!(done.early_stop.is_none(), "{name}");
    let kinematics = analyse_trajectory_within(
        &scene,
        Analysis::Kinematics,
        None,
        PictureSpan::default(),
        &no_progress,
    );
    let (table, positions) = (written(&done), written(&kinematics.expect("positions")));
    assert_eq!(table.rows.len(), 7, "{name}");
    let constant = |load: &Load| match load.magnitude {
        Magnitude::Constant(magnitude) => (load.kind, magnitude),
        _ => panic!("a load of these scenes has a law"),
    };
    let loads: Vec<_> = scene.loads.iter().map(constant).collect();
    let (mut found, mut motion) = (Compared::default(), Compared::default());
    for (values, moving) in table.rows.iter().zip(&positions.rows) {
        let row = Row {
            table: &table,
            values,
        };
        let moving = Row {
            table: &positions,
            values: moving,
        };
        let rates = |suffix: &str| -> Vec<f64> {
            let actuators = scene.mechanism.actuators.iter();
            let rate = |a: &dwell_geometry::space::Actuator| {
                moving.number(&format!("{}.{suffix}", a.name))
            };
            actuators.map(rate).collect()
        };
        let (mut q_dot, mut q_ddot) = (rates("velocity"), rates("acceleration"));
        if analysis == Analysis::Statics {
            q_dot.fill(0.0);
            q_ddot.fill(0.0);
        }
        let placements = moving.placements(&scene);
        let dense = DenseSpace::new(
            &scene.mechanism,
            &scene.masses,
            &placements,
            [&q_dot, &q_ddot],
            &loads,
        )
        .expect("singular values");
        if analysis == Analysis::Kinematics {
            compare_motion(&scene, &row, &dense, &mut motion);
            continue;
        }
        compare_forces(&scene, &row, &dense, &mut found);
        if analysis == Analysis::Kinetostatics {
            let power = |what: &str| row.number(&format!("power.{what}"));
            let residual = power("actuators") + power("loads") - power("kinetic");
            let scale = power("actuators").abs() + power("loads").abs() + power("kinetic").abs();
            assert!(
                residual.abs() < 1e-12 * scale,
                "{name}: {residual:.1e} W of {scale:.1e}"
            );
        }
    }
    let size = scene.mechanism.size();
    motion.assert(&format!("{name}, motion"), size);
    found.assert(&format!("{name}, {}", analysis.name()), size);
    found.count + motion.count
}

#[test]
fn motions_are_those_of_the_dense_equations() {
    let compared: usize = SCENES
        .map(|name| compare(name, Analysis::Kinematics))
        .iter()
        .sum();
    assert!(compared > 7000, "{compared}");
}

#[test]
fn forces_at_rest_and_in_motion_are_those_of_the_dense_equations() {
    for analysis in [Analysis::Statics, Analysis::Kinetostatics] {
        let compared: usize = SCENES.map(|name| compare(name, analysis)).iter().sum();
        assert!(compared > 1000, "{compared}");
    }
}

/// Redundant constraints share the load of the Bennett linkage: no row has a component of its joints, nor a magnitude.
#[test]
fn what_redundant_constraints_share_is_not_written() {
    let scene = accelerated("bennett");
    let done = analyse_trajectory_within(
        &scene,
        Analysis::Kinetostatics,
        None,
        PictureSpan::default(),
        &no_progress,
    );
    let table = written(&done.expect("a table"));
    let of_joints = table.columns.iter().filter(|c| {
        scene
            .mechanism
            .joints
            .iter()
            .any(|j| c.name.starts_with(&format!("{}.", j.name)))
    });
    let names: Vec<_> = of_joints.map(|c| c.name.as_str()).collect();
    assert!(names.is_empty(), "{names:?}");
}

#[test]
fn gears_are_reduced_over_their_whole_period() {
    // Both ends of six revolutions are one position; its rounding is found in 32 digits.
    let scene = scene("bevel-differential-held", "");
    let reduction = dwell_study::compute_reduction(&scene, Some(7)).unwrap();
    let all = &reduction.curves.coefficients;
    assert!((all[0].m - all[6].m).abs() < 1e-14 * all[0].m);
}

/// Nothing is known of a load beyond its table: the rows end there, as in the plane.
#[test]
fn rows_end_where_a_load_leaves_its_table() {
    let driven = "push = { torque = \"crank\", axis = [0, 0, 1], magnitude = { table = [[0, 2], [1, 3]], of = \"q\" } }\n\
                  [coordinate-sweep]\nq = [0.5, 1.5]\n";
    let scene = scene("rssr", driven);
    let done = analyse_trajectory_within(
        &scene,
        Analysis::Statics,
        Some(11),
        PictureSpan::default(),
        &no_progress,
    )
    .unwrap_or_else(|e| panic!("{e}"));
    // 0.5 to 1 rad by tenths.
    assert_eq!(written(&done).rows.len(), 6);
    let message = done.early_stop.map(|error| error.to_string());
    let expected = "the table of load `push` covers q from 0 rad (0°) to 1 rad (57.2958°), but q is 1.1 rad (63.0254°) \
                    soon after q = 1 rad (57.2958°)";
    assert_eq!(message.as_deref(), Some(expected));
}

/// So does a motion, whose events behind that are none.
#[test]
fn a_motion_ends_where_a_load_leaves_its_table() {
    let text = r#"
bodies.ground.points = { O = [0, 0, 0] }
bodies.cart = { points = { P = [0, 0, 0] }, mass = 2, center = "P" }
joints.way = { prismatic = ["ground.O", "cart.P"], axis = [1, 2, 2] }
actuators.x = { travel = "way" }
assembly.x = 0
loads.push = { force = "cart.P", direction = [1, 2, 2], magnitude = { table = [[-1, 0], [0.55, 0]], of = "x" } }
[motion]
duration = 1
initial-velocity = { x = 1 }
events = { early = { reaches = "x", value = 0.2 }, late = { reaches = "x", value = 0.8, stop = true } }
"#;
    let scene = SpaceScene::parse("cart", text).unwrap_or_else(|e| panic!("{e}"));
    let settings = SolverSettings {
        sample_interval: Some(0.1),
        ..SolverSettings::default()
    };
    let solver = MotionSolver::Settings(settings);
    let motion = compute_free_motion(&scene, &solver, &no_progress).unwrap();
    let rows = &motion.computed.table.rows;
    let names: Vec<&str> = motion.events.iter().map(|(_, name)| &name[..]).collect();
    assert!(
        rows.len() == 6 && names == ["early"],
        "{} rows, {names:?}",
        rows.len()
    );
    let stop = motion.computed.early_stop.unwrap().to_string();
    assert!(
        stop.contains("the table of load `push` covers x from -1 m to 0.55 m"),
        "{stop}"
    );
}
