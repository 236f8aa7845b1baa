//! What a scene has, for `dwell check`: its size and masses at the start, loads, drives, stops and motions.

use crate::explain::NamedScene;
use crate::number_format::{coordinate_unit, count, digits, force_unit, number};
use dwell_findings::Record;
use dwell_geometry::{BodyId, Coordinate, Plan, Vec2, vec2};
use dwell_kinetostatics::{Drive, DriveKind, LoadKind, Magnitude, Signal, VaryingInertia};
use dwell_scene::{CoordinateSweep, FreeMotionSpec, MotionDuration, PrescribedMotion, Scene};

/// Its size, masses, loads, drives, stops and motions as lines of text; the numbers go into the record.
pub(crate) fn describe_contents(scene: &Scene, plan: &Plan, record: &mut Record) -> String {
    let coordinates = Coordinates {
        name: &|coordinate: Coordinate| scene.name_of(coordinate),
        is_angle: Coordinate::is_angle,
    };
    let motions = ScheduledMotions {
        prescribed: scene.prescribed.as_ref(),
        sweep: scene.sweep.as_ref(),
        motion: scene.motion.as_ref(),
    };
    describe_size(scene, plan, record)
        + &describe_masses(scene, plan, record)
        + &describe_varying_inertias(scene, record)
        + &describe_loads(scene, record)
        + &describe_drives(&scene.drives, &coordinates, record)
        + &describe_stops(scene, record)
        + &describe_motions(scene, &motions, record)
}

/// How coordinates are called, and whether they are angles.
pub(crate) struct Coordinates<'a, C> {
    pub(crate) name: &'a dyn Fn(C) -> String,
    pub(crate) is_angle: fn(C) -> bool,
}

/// The motions of a scene in the plane or in space.
pub(crate) struct ScheduledMotions<'a, C, R> {
    pub(crate) prescribed: Option<&'a PrescribedMotion>,
    pub(crate) sweep: Option<&'a CoordinateSweep>,
    pub(crate) motion: Option<&'a FreeMotionSpec<C, R>>,
}

/// The frames of all bodies at the start: origin, m, and angle, rad.
fn start_frames(scene: &Scene, plan: &Plan) -> Option<Vec<[f64; 3]>> {
    let mut pose = plan.pose();
    plan.positions(plan.assembly_coordinates(), &mut pose)
        .ok()?;
    Some(plan.body_frames(&scene.mechanism, &pose))
}

fn in_frame([x, y, angle]: [f64; 3], point: Vec2) -> Vec2 {
    let (sin, cos) = angle.sin_cos();
    vec2(
        x + cos * point.x - sin * point.y,
        y + sin * point.x + cos * point.y,
    )
}

/// Width and height of the rectangle around all points at which joints act, at the start.
fn describe_size(scene: &Scene, plan: &Plan, record: &mut Record) -> String {
    let Some(frames) = start_frames(scene, plan) else {
        return String::new();
    };
    let joints = scene.mechanism.joints.iter();
    let points = joints.flat_map(|joint| joint.bodies.into_iter().zip(joint.points));
    let points: Vec<Vec2> = points
        .map(|(body, point)| in_frame(frames[body.0], point))
        .collect();
    let extent = |of: fn(&Vec2) -> f64| {
        let [low, high] = crate::ranges::extent(points.iter().map(of));
        high - low
    };
    let [width, height] = [extent(|p| p.x), extent(|p| p.y)];
    if !(width.is_finite() && height.is_finite()) {
        return String::new();
    }
    record.add("size.width", "m", width);
    record.add("size.height", "m", height);
    let [(width, unit), (height, _)] = [width, height].map(|s| scene.to_scene_unit(s, false));
    let [width, height] = [width, height].map(number);
    format!(
        "  overall size at the start: {width} by {height} {unit}, around the points of all joints\n"
    )
}

/// The whole mass and its centre at the start, and the mass of each body.
fn describe_masses(scene: &Scene, plan: &Plan, record: &mut Record) -> String {
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
    if let Some(frames) = start_frames(scene, plan).filter(|_| total > 0.0) {
        let moments = massive.iter().map(|(b, m)| {
            let center = in_frame(frames[*b], m.center);
            [m.mass * center.x, m.mass * center.y]
        });
        let sum = moments.fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let center = sum.map(|moment| moment / total);
        // A coordinate that is but rounding beside the other has no digits.
        let rounding = 1e-12 * scene.mechanism.size();
        let center = center.map(|c| if c.abs() < rounding { 0.0 } else { c });
        record.add("mass.center.x", "m", center[0]);
        record.add("mass.center.y", "m", center[1]);
        let [(x, unit), (y, _)] = center.map(|c| scene.to_scene_unit(c, false));
        let [x, y] = [x, y].map(number);
        text += &format!(", its centre at the start at ({x}, {y}) {unit}");
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
fn describe_varying_inertias(scene: &Scene, record: &mut Record) -> String {
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

/// What a load is.
fn load_kind(scene: &Scene, kind: &LoadKind) -> String {
    let name = |body: BodyId| scene.mechanism.body_name(body);
    let between = |[a, b]: [BodyId; 2]| format!("between {} and {}", name(a), name(b));
    match kind {
        LoadKind::Gravity { .. } => "gravity".to_owned(),
        LoadKind::Force { body, .. } => format!("force on {}", name(*body)),
        LoadKind::Torque { bodies: [a, b] } => {
            format!("couple of {} on {}", name(*a), name(*b))
        }
        LoadKind::Spring { bodies, .. } => format!("spring {}", between(*bodies)),
        LoadKind::TorsionSpring { bodies, .. } => format!("torsion spring {}", between(*bodies)),
        LoadKind::Damper { bodies, .. } => format!("damper {}", between(*bodies)),
        LoadKind::RotationalDamper { bodies } => format!("rotational damper {}", between(*bodies)),
        LoadKind::PointToPointForce { bodies, .. } => format!("force {}", between(*bodies)),
        LoadKind::SlideForce(_) => "force along a slide".to_owned(),
        LoadKind::SlideDamper(_) => "damper along a slide".to_owned(),
        LoadKind::SeparatingForce(_) => "separating force of teeth".to_owned(),
    }
}

/// The unit of the number of a load.
fn load_unit(kind: &LoadKind) -> &'static str {
    match kind {
        LoadKind::Gravity { .. } => "m/s²",
        LoadKind::Force { .. }
        | LoadKind::PointToPointForce { .. }
        | LoadKind::SlideForce(_)
        | LoadKind::SeparatingForce(_) => "N",
        LoadKind::Torque { .. } => "N m",
        LoadKind::Spring { .. } => "N/m",
        LoadKind::TorsionSpring { .. } => "N m/rad",
        LoadKind::Damper { .. } | LoadKind::SlideDamper(_) => "N s/m",
        LoadKind::RotationalDamper { .. } => "N m s/rad",
    }
}

/// A constant, or what a magnitude depends on.
pub(crate) fn magnitude<C: Copy>(
    name_of: &dyn Fn(C) -> String,
    of: &Magnitude<C>,
    (name, unit): (&str, &str),
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
            let signals = other.signals().iter();
            let mut names: Vec<String> = signals.map(|s| signal_name(name_of, s)).collect();
            names.dedup();
            match names.is_empty() {
                true => format!("in {unit}"),
                false => format!("a function of {}, in {unit}", names.join(", ")),
            }
        }
    }
}

fn signal_name<C: Copy>(name_of: &dyn Fn(C) -> String, signal: &Signal<C>) -> String {
    match signal {
        Signal::Time => "t".to_owned(),
        Signal::Value(coordinate) => name_of(*coordinate),
        Signal::Velocity(coordinate) => format!("{}.velocity", name_of(*coordinate)),
    }
}

fn describe_loads(scene: &Scene, record: &mut Record) -> String {
    if scene.loads.is_empty() {
        return "  no loads\n".to_owned();
    }
    let lines = scene.loads.iter().map(|load| {
        let (kind, unit) = (load_kind(scene, &load.kind), load_unit(&load.kind));
        let name = format!("load.{}", load.name);
        let name_of = |coordinate| scene.name_of(coordinate);
        let magnitude = magnitude(&name_of, &load.magnitude, (&name, unit), record);
        format!("    {}: {kind}, {magnitude}\n", load.name)
    });
    "  loads:\n".to_owned() + &lines.collect::<String>()
}

/// The drives of a scene in the plane or in space.
pub(crate) fn describe_drives<C: Copy>(
    drives: &[Drive<C>],
    coordinates: &Coordinates<'_, C>,
    record: &mut Record,
) -> String {
    if drives.is_empty() {
        return "  no drives\n".to_owned();
    }
    let lines = drives.iter().map(|drive| {
        let is_angle = (coordinates.is_angle)(drive.coordinate);
        let speed_unit = format!("{}/s", coordinate_unit(is_angle));
        let (kind, unit) = match &drive.kind {
            DriveKind::AppliedForce(_) => ("applied force", force_unit(is_angle)),
            DriveKind::Motor(_) => ("direct-current motor", "V"),
            DriveKind::SpeedController(_) => ("speed controller", speed_unit.as_str()),
        };
        let name = format!("drive.{}", drive.name);
        let input = magnitude(coordinates.name, drive.kind.input(), (&name, unit), record);
        let on = (coordinates.name)(drive.coordinate);
        format!("    {}: {kind} on {on}, {input}\n", drive.name)
    });
    "  drives:\n".to_owned() + &lines.collect::<String>()
}

/// The end stops of a scene in the plane or in space.
pub(crate) fn describe_stops(scene: &impl NamedScene, record: &mut Record) -> String {
    let lines = scene.stops().iter().map(|stop| {
        let (on, is_angle) = scene.actuator(stop.actuator.0).unwrap_or(("", true));
        let limit = |words: &str, value: f64| {
            let (value, unit) = scene.to_scene_unit(value, is_angle);
            format!(" {words} {} {unit}", number(value))
        };
        let limits = [("from", stop.min), ("to", stop.max)];
        let limits = limits.map(|(words, value)| value.map(|v| limit(words, v)));
        let limits: String = limits.into_iter().flatten().collect();
        let of = |what: &str| format!("stop.{}.{what}", stop.name);
        for (what, value) in [("min", stop.min), ("max", stop.max)] {
            if let Some(value) = value {
                record.add(of(what), coordinate_unit(is_angle), value);
            }
        }
        let force = force_unit(is_angle);
        let pushes = match stop.yielding {
            None => {
                record.add(of("restitution"), "", stop.restitution);
                format!("coefficient of restitution {}", number(stop.restitution))
            }
            Some([stiffness, damping]) => {
                let per = coordinate_unit(is_angle);
                let units = [format!("{force}/{per}"), format!("{force} s/{per}")];
                record.add(of("stiffness"), &units[0], stiffness);
                record.add(of("damping"), &units[1], damping);
                let [stiffness, damping] = [stiffness, damping].map(number);
                let [by_depth, by_rate] = units;
                format!("it yields with {stiffness} {by_depth} and {damping} {by_rate}")
            }
        };
        format!("  end stop {}: {on}{limits}, {pushes}\n", stop.name)
    });
    lines.collect()
}

/// The prescribed motion or sweep, and the free motion, of a scene in the plane or in space.
pub(crate) fn describe_motions<C, R>(
    scene: &impl NamedScene,
    motions: &ScheduledMotions<'_, C, R>,
    record: &mut Record,
) -> String {
    let coordinate = |i: usize, value: f64| {
        let is_angle = scene.actuator(i).is_none_or(|(_, is_angle)| is_angle);
        let (value, unit) = scene.to_scene_unit(value, is_angle);
        format!("{} {unit}", number(value))
    };
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
        record_motion(scene, motion, record);
        let starts = (0..motion.laws.len()).map(|i| {
            let name = scene.actuator(i).map_or("", |(name, _)| name);
            let [q, speed] = [
                coordinate(i, motion.initial_coordinates[i]),
                coordinate(i, motion.initial_velocities[i]),
            ];
            match motion.laws[i] {
                Some(_) => format!("{name} prescribed"),
                None => format!("{name} from {q} at {speed}/s"),
            }
        });
        let starts: Vec<String> = starts.collect();
        let duration = match motion.duration {
            MotionDuration::Seconds(seconds) => format!("{} s", number(seconds)),
            MotionDuration::Periods(1.0) => "1 period".to_owned(),
            MotionDuration::Periods(periods) => format!("{} periods", number(periods)),
        };
        let events = match motion.events.len() {
            0 => String::new(),
            events => format!(", {}", count(events, "event")),
        };
        text += &format!(
            "  free motion: {}, for {duration}{events}\n",
            starts.join(", ")
        );
    }
    match text.is_empty() {
        true => "  no motion: add [prescribed], [coordinate-sweep] or [motion]\n".to_owned(),
        false => text,
    }
}

/// The coordinate sweep.
fn describe_sweep(scene: &impl NamedScene, sweep: &CoordinateSweep, record: &mut Record) -> String {
    let (name, is_angle) = scene.actuator(sweep.actuator.0).unwrap_or(("", true));
    let unit = coordinate_unit(is_angle);
    let coordinate = |value: f64| {
        let (value, unit) = scene.to_scene_unit(value, is_angle);
        format!("{} {unit}", number(value))
    };
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

/// The numbers of a free motion.
fn record_motion<C, R>(
    scene: &impl NamedScene,
    motion: &FreeMotionSpec<C, R>,
    record: &mut Record,
) {
    let free = (0..motion.laws.len()).filter(|i| motion.laws[*i].is_none());
    for (i, (name, is_angle)) in free.filter_map(|i| Some((i, scene.actuator(i)?))) {
        let unit = coordinate_unit(is_angle);
        let name = format!("free_motion.{name}");
        let [q, speed] = [&motion.initial_coordinates, &motion.initial_velocities].map(|of| of[i]);
        record.add(&name, unit, q);
        record.add(format!("{name}.velocity"), &format!("{unit}/s"), speed);
    }
    match motion.duration {
        MotionDuration::Seconds(seconds) => record.add("free_motion.duration", "s", seconds),
        MotionDuration::Periods(periods) => record.add("free_motion.periods", "", periods),
    }
    record.add_count("free_motion.events", motion.events.len());
}
