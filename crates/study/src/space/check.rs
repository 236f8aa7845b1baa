//! `dwell check` of a scene in space: degrees of freedom, range, groups, placements and reactions, before anything moves.

use super::contents::describe_contents;
use super::explain::with_loads;
use super::prepared::{compile, is_angle, sort_reactions};
use crate::check::{
    describe_parts, describe_redundant, describe_start, list, list_or, range_text, rounded,
};
use crate::explain::{StudyError, describe_coordinate};
use crate::machines::MachineScene as _;
use crate::number_format::{coordinate_unit, count};
use dwell_findings::Record;
use dwell_geometry::space::{ChangePoint, CouplingEnd, Plan};
use dwell_geometry::{JointId, Range};
use dwell_kinetostatics::space::{Model, Reaction};
use dwell_scene::SpaceScene;

/// Describes a scene in space; the numbers are recorded.
pub(super) fn description(scene: &SpaceScene, record: &mut Record) -> Result<String, StudyError> {
    let mechanism = &scene.mechanism;
    let model = compile(scene, &scene.requests.reactions)?;
    // What forces refuse is said before anything moves.
    with_loads(scene, model.clone())?;
    let sorted = sort_reactions(scene, &model)?;
    let plan = model.plan();
    scene.reject_unknown_columns()?;
    let parts = [mechanism.bodies.len() - 1, mechanism.joints.len()];
    let actuators = mechanism.actuators.iter().map(|a| a.name.as_str());
    let mut text = describe_parts(scene, "in space: ", parts, actuators, record);
    text += &describe_freedom(scene, plan, record);
    text += &describe_range(scene, plan, record);
    text += &describe_groups(scene, plan, record);
    text += &describe_placements(scene, &model, record);
    text += &describe_reactions(scene, &sorted, record);
    text += &describe_contents(scene, plan, record);
    if let Some(note) = &scene.note {
        text += &format!("  note: {note}\n");
    }
    Ok(text)
}

/// Redundant constraints and idle rotations, which counting does not show.
fn describe_freedom(scene: &SpaceScene, plan: &Plan, record: &mut Record) -> String {
    let mobility = plan.mobility();
    let by_rank = mobility.degrees_of_freedom;
    // Each body has six freedoms, and each joint takes away what it does not allow; an idle rotation is a freedom, too.
    let counted = (by_rank + mobility.idle.len()) as f64 - mobility.redundant_count as f64;
    let mut text = String::new();
    if mobility.redundant_count > 0 {
        text += &describe_redundant(counted, by_rank, mobility.redundant_count, record);
    }
    for idle in &mobility.idle {
        let name = &scene.mechanism.bodies[idle.body.0].name;
        text += &format!(
            "  {name} has an idle rotation about the line through its spherical joints, which moves no other body; it is held at zero\n"
        );
    }
    if !mobility.idle.is_empty() {
        record.add_count("idle_rotations", mobility.idle.len());
    }
    text
}

/// The range of the actuator.
fn describe_range(scene: &SpaceScene, plan: &Plan, record: &mut Record) -> String {
    let actuator = match scene.mechanism.actuators.as_slice() {
        [] => return String::new(),
        [actuator] => actuator,
        _ => {
            return "  several actuators: limit positions are found along a motion only\n"
                .to_owned();
        }
    };
    let range = plan.range();
    let note = match (range, plan.range_ends()) {
        (Range::Unresolved(..), [true, _]) => {
            "; a limit position at the lower end; no upper limit was found up to there"
        }
        (Range::Unresolved(..), [_, true]) => {
            "; a limit position at the upper end; no lower limit was found down to there"
        }
        (Range::Unresolved(..), _) => "; how it goes on from there is not known",
        _ => ": limit positions at both ends",
    };
    let note = &coupling_note(scene, plan).unwrap_or_else(|| note.to_owned());
    let text = range_text(scene, &actuator.name, is_angle(scene), range, note, record);
    text + &describe_change_points(scene, plan, record)
}

/// What ends the range, if couplings do.
fn coupling_note(scene: &SpaceScene, plan: &Plan) -> Option<String> {
    let ends = plan.coupling_ends();
    if ends == [None; 2] {
        return None;
    }
    let found = plan.range_ends();
    let notes = ["lower", "upper"].into_iter().enumerate().map(|(k, end)| {
        let name = |joint: JointId| &scene.mechanism.joints[joint.0].name;
        match ends[k] {
            Some((joint, CouplingEnd::Table)) => {
                format!("the {end} end is that of the table of `{}`", name(joint))
            }
            Some((joint, CouplingEnd::Jump)) => {
                format!("at the {end} end the function of `{}` jumps", name(joint))
            }
            None if found[k] => format!("a limit position at the {end} end"),
            None => format!("no {end} limit was found up to there"),
        }
    });
    Some(format!("; {}", notes.collect::<Vec<_>>().join("; ")))
}

/// The change points in the range.
fn describe_change_points(scene: &SpaceScene, plan: &Plan, record: &mut Record) -> String {
    let (name, is_angle) = (&scene.mechanism.actuators[0].name, is_angle(scene));
    let groups = plan.described_groups();
    let one = |(k, point): (usize, &ChangePoint)| {
        let key = format!("change_point.{}", k + 1);
        record.add(key, coordinate_unit(is_angle), point.q);
        let group = groups.get(point.group).into_iter();
        let closing = group.flat_map(|group| &group.joints);
        let joints = list(closing.map(|j| scene.mechanism.joints[j.0].name.as_str()));
        let at = describe_coordinate(scene, name, point.q, is_angle);
        format!(
            "    change point of the group closed by {joints} at {at}, where another assembly mode meets this one\n"
        )
    };
    plan.change_points().iter().enumerate().map(one).collect()
}

/// The groups of unknowns that are solved together.
fn describe_groups(scene: &SpaceScene, plan: &Plan, record: &mut Record) -> String {
    let groups = plan.described_groups();
    if groups.is_empty() {
        return String::new();
    }
    let mut text = "  groups, in the order of solution:\n".to_owned();
    for (g, group) in groups.iter().enumerate() {
        let number = g + 1;
        let joints = group.joints.iter();
        let joints = list(joints.map(|j| scene.mechanism.joints[j.0].name.as_str()));
        record.add_count(format!("group.{number}.unknowns"), group.unknowns);
        record.add_count(format!("group.{number}.equations"), group.equations);
        let method = if group.equations > group.unknowns {
            "least squares"
        } else {
            "Newton's method"
        };
        text += &format!(
            "    {number}. closed by {joints}: {} from {}, {method}\n",
            count(group.unknowns, "unknown"),
            count(group.equations, "equation"),
        );
    }
    text
}

/// The positions of the bodies at the start.
fn describe_placements(scene: &SpaceScene, model: &Model, record: &mut Record) -> String {
    let (mechanism, plan) = (&scene.mechanism, model.plan());
    let mut pose = plan.pose();
    let start = &scene.assembly.q;
    if plan.positions(start, &mut pose).is_err() {
        return String::new();
    }
    let (factor, unit) = scene.to_scene_unit(1.0, false);
    // To a micrometre, as the sizes of a mechanism of metres.
    let decimals = (6.0 - factor.log10().round()).clamp(0.0, 6.0) as usize;
    let mut text = format!(
        "  at {}: origin of each body's frame in {unit}, and its rotation as a vector in degrees\n",
        describe_start(scene, start, record)
    );
    let moving = (0..mechanism.bodies.len()).filter(|&b| b != mechanism.ground);
    let widths = mechanism.bodies.iter().map(|b| b.name.chars().count());
    let width = widths.max().unwrap_or(0);
    for b in moving {
        let (name, placement) = (&mechanism.bodies[b].name, plan.placement(&pose, b));
        let (at, turn) = (placement.position, placement.rotation.vector());
        let vectors = [("position", "m", at), ("rotation", "rad", turn)];
        for (what, unit, vector) in vectors {
            for (axis, value) in ["x", "y", "z"]
                .into_iter()
                .zip([vector.x, vector.y, vector.z])
            {
                record.add(format!("start.{name}.{what}.{axis}"), unit, value);
            }
        }
        let [x, y, z] = [at.x, at.y, at.z].map(|v| rounded(v, 1e6) * factor);
        let [a, b, c] = [turn.x, turn.y, turn.z].map(|v| rounded(v.to_degrees(), 1e3));
        text += &format!(
            "    {name:<width$}  ({x:9.decimals$}, {y:9.decimals$}, {z:9.decimals$})  ({a:8.3}°, {b:8.3}°, {c:8.3}°)\n"
        );
    }
    text
}

/// The requested reactions: which the loads determine, and which redundant constraints leave open.
fn describe_reactions(
    scene: &SpaceScene,
    [determined, others]: &[Vec<Reaction>; 2],
    record: &mut Record,
) -> String {
    let names = |some: &[Reaction]| {
        let names: Vec<_> = some.iter().map(|&r| scene.reaction_name(r)).collect();
        list_or(names.iter().map(String::as_str), "none")
    };
    record.add_count("reactions.determined", determined.len());
    record.add_count("reactions.indeterminate", others.len());
    let requested = if scene.requests.lists_reactions {
        "requested"
    } else {
        "in the axes of the ground, all of them requested"
    };
    let all = count(determined.len() + others.len(), "component");
    let mut text = format!(
        "  reactions: {all} {requested}\n    statically determinate: {}\n",
        names(determined)
    );
    if !others.is_empty() {
        text += &format!(
            "    statically indeterminate, because redundant constraints share the load: {}\n",
            names(others)
        );
    }
    text
}
