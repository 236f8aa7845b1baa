//! `dwell check`: mobility, range, groups and assembly modes of a scene, before anything moves.

use crate::branch_note::branch_note;
use crate::contents::describe_contents;
use crate::explain::{NamedScene, StudyError, describe_ends, describe_limit, own_coordinate};
use crate::models::{loaded_model, requested_reaction_bodies};
use crate::number_format::{coordinate_unit, count, digits, number};
use crate::trajectory::compute::{check_variables, requested_bodies};
use dwell_findings::Record;
use dwell_geometry::mobility::mobility;
use dwell_geometry::plan::GroupModes;
use dwell_geometry::{BodyId, BranchHint, JointId, Mechanism, Plan, Range};
use dwell_kinetostatics::{Load, Mesh, Model};
use dwell_scene::{PlaneScene, SceneFile};

/// Describes a scene in the plane; the numbers are recorded.
pub(crate) fn description(scene: &PlaneScene, record: &mut Record) -> Result<String, StudyError> {
    let mechanism = &scene.mechanism;
    let model = loaded_model(scene)?;
    check_variables(scene, &model)?;
    let plan = model.plan();
    let parts = [mechanism.bodies.len() - 1, mechanism.joints.len()];
    let actuators = mechanism.actuators.iter().map(|a| a.name.as_str());
    let mut text = describe_parts(scene, "", parts, actuators, record);
    text += &describe_freedom(scene, plan, record);
    text += &describe_range(scene, mechanism, plan, record);
    text += &describe_groups(mechanism, plan, record);
    text += &(describe_branch(scene, plan, record) + &branch_note(scene, plan));
    text += &describe_contents(scene, plan, record);
    text += &describe_pruning(scene, &model);
    text += &describe_teeth(scene);
    text += &describe_requests(scene);
    if let Some(note) = &scene.note {
        text += &format!("  note: {note}\n");
    }
    Ok(text)
}

/// The title, the numbers of moving bodies and of joints, and the degrees of freedom with their actuators.
pub(crate) fn describe_parts<'a>(
    scene: &SceneFile,
    place: &str,
    [bodies, joints]: [usize; 2],
    actuators: impl ExactSizeIterator<Item = &'a str>,
    record: &mut Record,
) -> String {
    let freedoms = actuators.len();
    record.add_count("moving_bodies", bodies);
    record.add_count("joints", joints);
    record.add_count("degrees_of_freedom", freedoms);
    let bodies = count(bodies, "moving body");
    let joints = count(joints, "joint");
    let freedom = count(freedoms, "degree of freedom");
    let driven = match list(actuators).as_str() {
        "" => ": a structure, in which nothing moves".to_owned(),
        names => format!(", driven by {names}"),
    };
    format!(
        "{}\n  {place}{bodies}, {joints}, {freedom}{driven}\n",
        scene.title
    )
}

/// Names separated by commas; `none` if there are none.
pub(crate) fn list_or<'a>(names: impl IntoIterator<Item = &'a str>, none: &'a str) -> String {
    match names.into_iter().collect::<Vec<_>>().as_slice() {
        [] => none.to_owned(),
        names => names.join(", "),
    }
}

/// Names separated by commas.
pub(crate) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    list_or(names, "")
}

/// The bodies that a group places.
fn group_bodies(mechanism: &Mechanism, plan: &Plan, g: usize) -> String {
    let bodies = plan.group_bodies(g);
    if plan.group_methods()[g].0 == 0 {
        let joints = plan.group_joints(g);
        return list(joints.iter().map(|j| mechanism.joints[j.0].name.as_str()));
    }
    list_or(bodies.iter().map(|&b| mechanism.body_name(b)), "a line")
}

/// Redundant constraints, which counting does not show.
fn describe_freedom(scene: &PlaneScene, plan: &Plan, record: &mut Record) -> String {
    let mechanism = &scene.mechanism;
    let reactions = mechanism.reactions().into_iter().enumerate();
    let indeterminate = reactions.filter(|&(k, _)| !plan.is_determinate(k));
    let names = indeterminate.map(|(_, r)| mechanism.reaction_name(r));
    let names: Vec<String> = names.collect();
    if names.is_empty() {
        return String::new();
    }
    let mut text = String::new();
    if let Some(found) = mobility(mechanism, &scene.assembly.to_configuration()) {
        let counted = found.grubler_count() as f64;
        let freedoms = found.degrees_of_freedom();
        text = describe_redundant(counted, freedoms, found.redundant_count, record);
    }
    let names = names.join(", ");
    text + &format!(
        "  statically indeterminate, because redundant constraints share the load: {names}\n"
    )
}

/// The degrees of freedom by counting and by rank, which redundant constraints tell apart.
pub(crate) fn describe_redundant(
    counted: f64,
    by_rank: usize,
    redundant_count: usize,
    record: &mut Record,
) -> String {
    let redundant = match redundant_count {
        1 => "one constraint is redundant".to_owned(),
        n => format!("{n} constraints are redundant"),
    };
    record.add("degrees_of_freedom.counted", "", counted);
    record.add_count("redundant_constraints", redundant_count);
    format!(
        "  {counted} degrees of freedom by counting (Grübler), {by_rank} by rank: {redundant}, and consistent\n"
    )
}

/// The range of an actuator; `note` describes its ends.
pub(crate) fn range_text(
    file: &SceneFile,
    name: &str,
    is_angle: bool,
    range: Range,
    note: &str,
    record: &mut Record,
) -> String {
    if let Some((from, to)) = range.limits() {
        record.add("range.lower", coordinate_unit(is_angle), from);
        record.add("range.upper", coordinate_unit(is_angle), to);
    }
    match range {
        Range::Full => format!("  {name} rotates fully\n"),
        Range::Revolutions(revolutions) => {
            record.add("period.revolutions", "", f64::from(revolutions));
            format!(
                "  {name} rotates fully; the mechanism is periodic after {revolutions} revolutions\n"
            )
        }
        Range::Unbounded => format!("  no limit of {name} was found\n"),
        Range::Limited(from, to) | Range::Stroke(from, to) | Range::Unresolved(from, to) => {
            let ends = describe_ends(file, from, to, is_angle);
            format!("  {name} ranges from {ends}{note}\n")
        }
    }
}

/// The range of the actuator.
fn describe_range(
    file: &SceneFile,
    mechanism: &Mechanism,
    plan: &Plan,
    record: &mut Record,
) -> String {
    let actuator = match mechanism.actuators.as_slice() {
        [] => return String::new(),
        [actuator] => actuator,
        _ => {
            return "  several actuators: limit positions are found along a motion or a sweep only\n"
                .to_owned();
        }
    };
    let (name, is_angle) = (actuator.name.as_str(), plan.is_angle(0));
    let note = match plan.range_limits() {
        [Some(_), Some(_)] => "",
        [Some(_), None] => "; no upper limit was found up to there",
        [None, Some(_)] => "; no lower limit was found down to there",
        [None, None] => "; no limit was found up to there",
    };
    let text = match plan.range() {
        Range::Unbounded if is_angle => {
            format!("  {name} is unlimited; the mechanism is not periodic within 8 revolutions\n")
        }
        range => range_text(file, name, is_angle, range, note, record),
    };
    let limits = plan.range_limits().into_iter().flatten().map(|limit| {
        let beyond = match (limit.change_point, limit.separation) {
            (true, Some(half_width)) => {
                let width = own_coordinate(file, half_width, is_angle);
                format!(": they are {width} apart, too little for positions beyond it")
            }
            (true, None) => ", where another assembly mode begins".to_owned(),
            (false, _) => String::new(),
        };
        format!(
            "    {}{beyond}\n",
            describe_limit(file, mechanism, plan, limit, 0.0)
        )
    });
    text + &limits.collect::<String>()
}

fn describe_groups(mechanism: &Mechanism, plan: &Plan, record: &mut Record) -> String {
    let groups = plan.group_methods();
    if groups.is_empty() {
        return String::new();
    }
    let mut text = "  groups, in the order of solution:\n".to_owned();
    for (g, (size, kind)) in groups.into_iter().enumerate() {
        let joints = plan.group_joints(g);
        let joints = joints.iter().map(|j| mechanism.joints[j.0].name.as_str());
        let (joints, unknowns) = (list_or(joints, "its actuator"), count(size, "unknown"));
        let (number, bodies) = (g + 1, group_bodies(mechanism, plan, g));
        record.add_count(format!("group.{number}.unknowns"), size);
        text += &match size {
            0 => format!("    {number}. {joints}: redundant, closes no group of its own\n"),
            _ => format!("    {number}. {bodies} closed by {joints}: {unknowns}, {kind}\n"),
        };
        let found = &plan.group_modes[g];
        let is_ambiguous = found.modes.len() > 1;
        for (k, mode) in found.modes.iter().enumerate().filter(|_| is_ambiguous) {
            let label = match k {
                0 => "assembly mode in use:",
                _ => "other assembly mode:",
            };
            let mode_name = format!("group.{}.mode.{}", g + 1, k + 1);
            let mode = describe_mode(mechanism, found, mode, &mode_name, record);
            text += &format!("       {label} {mode}\n");
        }
    }
    text
}

/// The angles and travels that distinguish an assembly mode of a group.
fn describe_mode(
    mechanism: &Mechanism,
    found: &GroupModes,
    mode: &[f64],
    mode_name: &str,
    record: &mut Record,
) -> String {
    let (angles, values) = mode.split_at(found.bodies.len().min(mode.len()));
    let angles = found.bodies.iter().zip(angles).map(|(body, angle)| {
        let body = mechanism.body_name(*body);
        record.add(format!("{mode_name}.{body}"), "rad", *angle);
        format!("{body} = {:.4}", angle + 0.0)
    });
    let angles = angles.collect::<Vec<_>>().join(", ");
    let values = found.joints.iter().zip(values).map(|(joint, value)| {
        let joint = &mechanism.joints[joint.0];
        let unit = coordinate_unit(joint.kind.branch_hint() == Some(BranchHint::Direction));
        record.add(format!("{mode_name}.{}", joint.name), unit, *value);
        format!("{} = {:.4} {unit}", joint.name, value + 0.0)
    });
    let angles = (!angles.is_empty()).then(|| format!("{angles} rad"));
    let all: Vec<String> = angles.into_iter().chain(values).collect();
    all.join(", ")
}

/// The coordinates of the actuators at the start, such as `phi = 0.5 rad`.
pub(crate) fn describe_start(
    scene: &impl NamedScene,
    start: &[f64],
    record: &mut Record,
) -> String {
    let at = start.iter().enumerate().map(|(i, &q)| {
        let (name, is_angle) = scene.actuator(i).unwrap_or_default();
        let unit = coordinate_unit(is_angle);
        record.add(format!("start.{name}"), unit, q);
        format!("{name} = {} {unit}", number(q))
    });
    at.collect::<Vec<_>>().join(", ")
}

/// A number rounded to a multiple of 1/`parts`, without a minus sign for zero.
pub(crate) fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts + 0.0
}

/// The angles of all bodies at the start.
fn describe_branch(scene: &PlaneScene, plan: &Plan, record: &mut Record) -> String {
    let mechanism = &scene.mechanism;
    let mut pose = plan.pose();
    let start = plan.assembly_coordinates();
    if plan.positions(start, &mut pose).is_err() {
        return String::new();
    }
    let mut text = match describe_start(scene, start, record).as_str() {
        "" => "  body angles:\n".to_owned(),
        at => format!("  body angles at {at}:\n"),
    };
    let bodies = plan.moving_bodies().iter().map(|c| c.body);
    let bodies = bodies.filter(|&b| b < mechanism.bodies.len()).map(BodyId);
    let widths = bodies.clone().map(|b| mechanism.body_name(b).chars());
    let width = widths.map(Iterator::count).max().unwrap_or(0);
    for body in bodies {
        let name = mechanism.body_name(body);
        let angle = plan.body_rotation(body, &pose).angle();
        record.add(format!("start.{name}.angle"), "rad", angle);
        let (radians, degrees) = (rounded(angle, 1e6), rounded(angle.to_degrees(), 1e3));
        text += &format!("    {name:<width$}  {radians:9.6} rad  {degrees:8.3}°\n");
    }
    text
}

/// The groups that trajectory analyses model, and why; and those that they and the reduced model skip.
fn describe_pruning(scene: &PlaneScene, model: &Model) -> String {
    let (mechanism, plan) = (&scene.mechanism, model.plan());
    let group = |g: usize| format!("{}. {}", g + 1, group_bodies(mechanism, plan, g));
    let mut text = describe_needs(scene, model, &group);
    if plan.actuators() == 1 {
        let requested = requested_reaction_bodies(scene);
        let unloaded = Model::clone(model).with_loads(Vec::new());
        let pruned = unloaded.map(|model| model.pruned_for(&requested).plan().pruned_groups());
        let groups = pruned.unwrap_or_default().into_iter().enumerate();
        let skipped: Vec<String> = groups.filter(|s| s.1).map(|(g, _)| group(g)).collect();
        if !skipped.is_empty() {
            text += &format!(
                "  skipped by `reduce` and `simulate`, as they affect no inertia or requested reaction: {}\n",
                skipped.join("; ")
            );
        }
    }
    let is_massless = |&b: &usize| {
        let mass = scene.masses.get(b);
        let varies = scene.varying_inertias.iter().any(|v| v.body.0 == b);
        !varies && mass.is_some_and(|mass| mass.mass == 0.0 && mass.inertia == 0.0)
    };
    let moving = plan.moving_bodies().iter().map(|c| c.body);
    let bodies = moving.filter(is_massless).map(BodyId);
    let massless = list(bodies.map(|b| mechanism.body_name(b)));
    if !massless.is_empty() {
        text += &format!("  massless, so without inertia forces: {massless}\n");
    }
    text
}

/// Why each group is modelled along a trajectory.
fn describe_needs(scene: &PlaneScene, model: &Model, group: &dyn Fn(usize) -> String) -> String {
    let plan = model.plan();
    let groups = plan.group_methods().len();
    let Some(requested) = requested_bodies(scene, model).filter(|_| groups > 0) else {
        return match groups {
            0 => String::new(),
            _ => "  modelled along a trajectory: every group, since no `variables` are requested\n"
                .to_owned(),
        };
    };
    let massive = scene.masses.iter().enumerate();
    let massive = massive.filter(|(_, m)| m.mass > 0.0 || m.inertia > 0.0);
    let varying = scene.varying_inertias.iter().map(|v| v.body.0);
    let loaded = scene.loads.iter();
    let loaded = loaded.flat_map(|load| load.bodies(&scene.mechanism));
    let requested = requested.iter().map(|b| b.0);
    let needs = [
        (
            "inertia",
            plan.groups_needed_by(massive.map(|(b, _)| b).chain(varying)),
        ),
        ("loads", plan.groups_needed_by(loaded.map(|b| b.0))),
        ("requests", plan.groups_needed_by(requested)),
    ];
    let mut text = "  modelled along a trajectory, because of:\n".to_owned();
    for g in 0..groups {
        let needs = needs.iter().filter(|(_, needed)| needed[g]);
        let skipped = "skipped, it affects no inertia, load or requested result";
        let why = list_or(needs.map(|(what, _)| *what), skipped);
        text += &format!("    {}: {why}\n", group(g));
    }
    text
}

/// The teeth that have a separating force, and those that have none.
fn describe_teeth(scene: &PlaneScene) -> String {
    let joints = scene.mechanism.joints.iter().enumerate();
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for (j, joint) in joints.filter(|(_, joint)| Mesh::of(joint).is_some()) {
        let mut teeth = scene.loads.iter().filter_map(Load::pressure_angle);
        match teeth.find(|teeth| teeth.joint == JointId(j)) {
            Some(teeth) => {
                let angle = digits(teeth.angle.to_degrees(), 6);
                with.push(format!("{} (pressure angle {angle}°)", joint.name));
            }
            None => without.push(joint.name.as_str()),
        }
    }
    let mut text = String::new();
    if !with.is_empty() {
        text += &format!("  separating forces: {}\n", with.join(", "));
    }
    if !without.is_empty() {
        let without = list(without);
        text += &format!(
            "  no separating force is modelled, as no `pressure-angle` is given: {without}\n"
        );
    }
    text
}

fn describe_requests(scene: &PlaneScene) -> String {
    let mechanism = &scene.mechanism;
    let requested = scene.requests.reactions.iter();
    let names: Vec<_> = requested.map(|&r| mechanism.reaction_name(r)).collect();
    let others = match mechanism.reactions().len() - names.len() {
        0 => String::new(),
        others => format!(" ({others} others are neither requested nor computed)"),
    };
    let names = list_or(names.iter().map(String::as_str), "none");
    format!("  reactions requested: {names}{others}\n")
}
