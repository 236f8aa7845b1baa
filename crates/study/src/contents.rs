//! The contents of a scene, for `dwell check`: its size and masses at the start, loads, drives, stops and motions.

use crate::explain::NamedScene;
use crate::machines::{CoordinateOf, MachineScene};
use crate::number_format::{coordinate_unit, count, digits, force_unit, number};
use crate::ranges::extent;
use dwell_findings::Record;
use dwell_geometry::{BodyId, Plan, Vec2};
use dwell_kinetostatics::{
    LoadNames, LoadShape as _, Magnitude, ModelLoad, Signal, VaryingInertia,
};
use dwell_scene::{
    CoordinateSweep, FreeMotionSpec, MotionDuration, PlaneScene, PrescribedMotion, SceneFile,
};

/// Its size, masses, loads, drives, stops and motions as lines of text; the numbers go into the record.
pub(crate) fn describe_contents(scene: &PlaneScene, plan: &Plan, record: &mut Record) -> String {
    let frames = start_frames(scene, plan);
    let motions = ScheduledMotions {
        prescribed: scene.prescribed.as_ref(),
        sweep: scene.sweep.as_ref(),
        motion: scene.motion.as_ref(),
    };
    let names = LoadNames {
        bodies: scene.mechanism.bodies.iter().map(|b| &b.name[..]).collect(),
        joints: scene.mechanism.joints.iter().map(|j| &j.name[..]).collect(),
    };
    let mut text = String::new();
    if let Some(frames) = &frames {
        let joints = scene.mechanism.joints.iter();
        let points = joints.flat_map(|joint| joint.bodies.into_iter().zip(joint.points));
        let points = points.map(|(body, point)| in_frame(frames[body.0], point));
        text += &describe_size(scene, ["width", "height"], points, record);
    }
    text + &describe_masses(scene, frames.as_deref(), record)
        + &describe_varying_inertias(scene, record)
        + &describe_actions(scene, &scene.loads, &names, &motions, record)
}

/// The motions of a scene in the plane or in space.
pub(crate) struct ScheduledMotions<'a, C, R> {
    pub(crate) prescribed: Option<&'a PrescribedMotion>,
    pub(crate) sweep: Option<&'a CoordinateSweep>,
    pub(crate) motion: Option<&'a FreeMotionSpec<C, R>>,
}

/// The frames of all bodies at the start: origin, m, and angle, rad.
fn start_frames(scene: &PlaneScene, plan: &Plan) -> Option<Vec<[f64; 3]>> {
    let mut pose = plan.pose();
    plan.positions(plan.assembly_coordinates(), &mut pose)
        .ok()?;
    Some(plan.body_frames(&scene.mechanism, &pose))
}

fn in_frame([x, y, angle]: [f64; 3], point: Vec2) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [
        x + cos * point.x - sin * point.y,
        y + sin * point.x + cos * point.y,
    ]
}

/// A value in the scene's unit of angles or lengths, with that unit.
fn in_scene_unit(scene: &SceneFile, value: f64, is_angle: bool) -> String {
    let (value, unit) = scene.to_scene_unit(value, is_angle);
    format!("{} {unit}", number(value))
}

/// Lengths in the scene's unit, and that unit.
fn lengths<const N: usize>(scene: &SceneFile, all: [f64; N]) -> ([String; N], &str) {
    let in_unit = |length| number(scene.to_scene_unit(length, false).0);
    (all.map(in_unit), scene.to_scene_unit(0.0, false).1)
}

/// The extents, by their names, of the rectangle or the box around all points at which joints act, at the start.
pub(crate) fn describe_size<const N: usize>(
    scene: &SceneFile,
    names: [&str; N],
    points: impl Iterator<Item = [f64; N]>,
    record: &mut Record,
) -> String {
    let points: Vec<[f64; N]> = points.collect();
    let sides: [f64; N] = std::array::from_fn(|k| {
        let [low, high] = extent(points.iter().map(|point| point[k]));
        high - low
    });
    if !sides.iter().all(|side| side.is_finite()) {
        return String::new();
    }
    for (name, side) in names.into_iter().zip(sides) {
        record.add(format!("size.{name}"), "m", side);
    }
    let (sides, unit) = lengths(scene, sides);
    let sides = sides.join(" by ");
    format!("  overall size at the start: {sides} {unit}, around the points of all joints\n")
}

/// The centre of mass at the start of a mechanism of this size, m.
pub(crate) fn describe_center<const N: usize>(
    scene: &SceneFile,
    center: [f64; N],
    size: f64,
    record: &mut Record,
) -> String {
    // A coordinate that is but rounding beside the other has no digits.
    let rounding = 1e-12 * size;
    let center = center.map(|c| if c.abs() < rounding { 0.0 } else { c });
    for (axis, part) in ["x", "y", "z"].into_iter().zip(center) {
        record.add(format!("mass.center.{axis}"), "m", part);
    }
    let (center, unit) = lengths(scene, center);
    let center = center.join(", ");
    format!(", with its centre of mass at ({center}) {unit} at the start")
}

/// The total mass, the centre of mass at the start, and the mass of each body.
fn describe_masses(scene: &PlaneScene, frames: Option<&[[f64; 3]]>, record: &mut Record) -> String {
    let ground = scene.mechanism.ground;
    let massive = scene.masses.iter().enumerate();
    let massive = massive.filter(|(b, m)| *b != ground && (m.mass != 0.0 || m.inertia != 0.0));
    let massive: Vec<_> = massive.collect();
    let total: f64 = massive.iter().map(|(_, m)| m.mass).sum();
    record.add("mass", "kg", total);
    if massive.is_empty() && !scene.varying_inertias.is_empty() {
        return String::new();
    }
    if massive.is_empty() {
        return "  no body has a mass\n".to_owned();
    }
    let mut text = format!("  moving mass {} kg", number(total));
    if let Some(frames) = frames.filter(|_| total > 0.0) {
        let moments = massive.iter().map(|(b, m)| {
            let center = in_frame(frames[*b], m.center);
            center.map(|part| m.mass * part)
        });
        let sum = moments.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let center = sum.map(|moment| moment / total);
        text += &describe_center(scene, center, scene.mechanism.size(), record);
    }
    text += ":\n";
    for (b, mass) in massive {
        let name = scene.mechanism.body_name(BodyId(b));
        record.add(format!("mass.{name}"), "kg", mass.mass);
        record.add(format!("inertia.{name}"), "kg m2", mass.inertia);
        let [mass, inertia] = [mass.mass, mass.inertia].map(number);
        text += &format!("    {name}: {mass} kg, {inertia} kg m² about its centre of mass\n");
    }
    text
}

/// The bodies whose moment of inertia is a function of their angle.
fn describe_varying_inertias(scene: &PlaneScene, record: &mut Record) -> String {
    let one = |varying: &VaryingInertia| {
        let name = scene.mechanism.body_name(varying.body);
        let ends = varying.inertia.extent();
        for (end, value) in ["min", "max"].into_iter().zip(ends) {
            record.add(format!("inertia.{name}.{end}"), "kg m2", value);
        }
        let [low, high] = ends.map(number);
        let angles = match varying.inertia.ends() {
            Some(ends) => {
                let [from, to] = ends.map(|angle| number(angle.to_degrees()));
                format!("its angle from {from}° to {to}°")
            }
            None => "its angle, over a whole revolution".to_owned(),
        };
        format!(
            "  {name}: a moment of inertia from {low} to {high} kg m² that varies with {angles}\n"
        )
    };
    scene.varying_inertias.iter().map(one).collect()
}

/// The loads of a scene in the plane or in space, by the names of what they act on, its drives, its stops and its motions.
pub(crate) fn describe_actions<S: MachineScene, R>(
    scene: &S,
    loads: &[ModelLoad<S::Model>],
    names: &LoadNames<'_>,
    motions: &ScheduledMotions<'_, CoordinateOf<S>, R>,
    record: &mut Record,
) -> String {
    describe_loads(scene, loads, names, record)
        + &describe_drives(scene, record)
        + &describe_stops(scene, record)
        + &describe_motions(scene, motions, record)
}

/// A constant, or what a magnitude depends on.
fn magnitude<S: MachineScene>(
    scene: &S,
    of: &Magnitude<CoordinateOf<S>>,
    name: &str,
    unit: &str,
    record: &mut Record,
) -> String {
    match of {
        Magnitude::Constant(value) => {
            record.add(name, unit, *value);
            format!("{} {unit}", number(*value))
        }
        Magnitude::Friction(_) => "dry friction".to_owned(),
        Magnitude::Separating(_) => "from the tooth force".to_owned(),
        other => {
            let name_of = |signal: &Signal<CoordinateOf<S>>| match *signal {
                Signal::Time => "t".to_owned(),
                Signal::Value(of) => scene.name_of_coordinate(of),
                Signal::Velocity(of) => format!("{}.velocity", scene.name_of_coordinate(of)),
            };
            let mut names: Vec<String> = other.signals().iter().map(name_of).collect();
            names.dedup();
            if names.is_empty() {
                format!("in {unit}")
            } else {
                format!("a function of {}, in {unit}", names.join(", "))
            }
        }
    }
}

fn describe_loads<S: MachineScene>(
    scene: &S,
    loads: &[ModelLoad<S::Model>],
    names: &LoadNames<'_>,
    record: &mut Record,
) -> String {
    if loads.is_empty() {
        return "  no loads\n".to_owned();
    }
    let lines = loads.iter().map(|load| {
        let (kind, unit) = (load.kind.label(names), load.kind.unit().replace('2', "²"));
        let name = format!("load.{}", load.name);
        let magnitude = magnitude(scene, &load.magnitude, &name, &unit, record);
        format!("    {}: {kind}, {magnitude}\n", load.name)
    });
    "  loads:\n".to_owned() + &lines.collect::<String>()
}

fn describe_drives<S: MachineScene>(scene: &S, record: &mut Record) -> String {
    if scene.drives().is_empty() {
        return "  no drives\n".to_owned();
    }
    let lines = scene.drives().iter().map(|drive| {
        let is_angle = S::is_angle(drive.coordinate);
        let words = drive.kind.words(is_angle);
        let name = format!("drive.{}", drive.name);
        let input = magnitude(scene, drive.kind.input(), &name, words.input_unit, record);
        let on = scene.name_of_coordinate(drive.coordinate);
        format!("    {}: {} on {on}, {input}\n", drive.name, words.kind)
    });
    "  drives:\n".to_owned() + &lines.collect::<String>()
}

fn describe_stops(scene: &impl NamedScene, record: &mut Record) -> String {
    let lines = scene.stops().iter().map(|stop| {
        let (on, is_angle) = scene.actuator(stop.actuator.0).unwrap_or(("", true));
        let unit = coordinate_unit(is_angle);
        let of = |what: &str| format!("stop.{}.{what}", stop.name);
        let mut limits = String::new();
        for (word, what, limit) in [("from", "min", stop.min), ("to", "max", stop.max)] {
            if let Some(limit) = limit {
                limits += &format!(" {word} {}", in_scene_unit(scene, limit, is_angle));
                record.add(of(what), unit, limit);
            }
        }
        let force = force_unit(is_angle);
        let pushes = match stop.yielding {
            None => {
                record.add(of("restitution"), "", stop.restitution);
                format!("coefficient of restitution {}", number(stop.restitution))
            }
            Some([stiffness, damping]) => {
                let [by_depth, by_rate] = [format!("{force}/{unit}"), format!("{force} s/{unit}")];
                record.add(of("stiffness"), &by_depth, stiffness);
                record.add(of("damping"), &by_rate, damping);
                let [stiffness, damping] = [stiffness, damping].map(number);
                format!("it yields with {stiffness} {by_depth} and {damping} {by_rate}")
            }
        };
        format!("  end stop {}: {on}{limits}, {pushes}\n", stop.name)
    });
    lines.collect()
}

/// The prescribed motion or sweep, and the free motion.
fn describe_motions<C, R>(
    scene: &impl NamedScene,
    motions: &ScheduledMotions<'_, C, R>,
    record: &mut Record,
) -> String {
    let mut text = String::new();
    if let Some(prescribed) = motions.prescribed {
        record.add("prescribed.duration", "s", prescribed.duration);
        record.add_count("prescribed.positions", prescribed.points);
        let (duration, points) = (digits(prescribed.duration, 6), prescribed.points);
        let points = count(points, "position");
        text += &format!("  prescribed motion: {duration} s, {points}\n");
    }
    if let Some(sweep) = motions.sweep {
        text += &describe_sweep(scene, sweep, record);
    }
    if let Some(motion) = motions.motion {
        text += &describe_free_motion(scene, motion, record);
    }
    if text.is_empty() {
        "  no motion: add [prescribed], [coordinate-sweep] or [motion]\n".to_owned()
    } else {
        text
    }
}

/// The coordinate sweep.
fn describe_sweep(scene: &impl NamedScene, sweep: &CoordinateSweep, record: &mut Record) -> String {
    let (name, is_angle) = scene.actuator(sweep.actuator.0).unwrap_or(("", true));
    let unit = coordinate_unit(is_angle);
    let coordinate = |value: f64| in_scene_unit(scene, value, is_angle);
    let over = match sweep.range {
        Some([from, to]) => {
            record.add("coordinate_sweep.from", unit, from);
            record.add("coordinate_sweep.to", unit, to);
            format!("from {} to {}", coordinate(from), coordinate(to))
        }
        None => "over its range".to_owned(),
    };
    record.add_count("coordinate_sweep.positions", sweep.points);
    record.add("coordinate_sweep.speed", &format!("{unit}/s"), sweep.speed);
    let points = count(sweep.points, "position");
    let speed = coordinate(sweep.speed);
    format!("  coordinate sweep: {name} {over}, {points}, at {speed}/s\n")
}

/// The free motion.
fn describe_free_motion<C, R>(
    scene: &impl NamedScene,
    motion: &FreeMotionSpec<C, R>,
    record: &mut Record,
) -> String {
    let starts = motion.laws.iter().enumerate().map(|(i, law)| {
        let (name, is_angle) = scene.actuator(i).unwrap_or(("", true));
        if law.is_some() {
            return format!("{name} prescribed");
        }
        let unit = coordinate_unit(is_angle);
        let [q, speed] = [&motion.initial_coordinates, &motion.initial_velocities].map(|of| of[i]);
        record.add(format!("free_motion.{name}"), unit, q);
        let of_speed = format!("free_motion.{name}.velocity");
        record.add(of_speed, &format!("{unit}/s"), speed);
        let [q, speed] = [q, speed].map(|value| in_scene_unit(scene, value, is_angle));
        format!("{name} from {q} at {speed}/s")
    });
    let starts = starts.collect::<Vec<String>>().join(", ");
    let duration = match motion.duration {
        MotionDuration::Seconds(seconds) => {
            record.add("free_motion.duration", "s", seconds);
            format!("{} s", number(seconds))
        }
        MotionDuration::Periods(periods) => {
            record.add("free_motion.periods", "", periods);
            let noun = if periods == 1.0 { "period" } else { "periods" };
            format!("{} {noun}", number(periods))
        }
    };
    record.add_count("free_motion.events", motion.events.len());
    let events = match motion.events.len() {
        0 => String::new(),
        events => format!(", {}", count(events, "event")),
    };
    format!("  free motion: {starts}, for {duration}{events}\n")
}
