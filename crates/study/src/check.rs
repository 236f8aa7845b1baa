//! `dwell check`: mobility, range, groups and assembly modes of a scene, before anything moves.

use crate::explain::StudyError;
use crate::number_format::{count, digits, number};
#[cfg(feature = "output")]
use crate::output::Outcome;
use dwell_geometry::mobility::mobility;
use dwell_geometry::plan::GroupModes;
use dwell_geometry::{
    AssemblyConfiguration, BodyId, BranchHint, JointId, Mechanism, Plan, Range, RangeLimit,
};
use dwell_kinetostatics::{Load, Mesh, Model};
use dwell_scene::Scene;
use std::fmt::Write as _;

/// Describes a scene: degrees of freedom, groups, assembly modes, range, pruning and requests. It writes
/// no file.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, or a requested column does not exist.
#[cfg(feature = "output")]
pub fn check(scene: &Scene) -> Result<Outcome, StudyError> {
    Ok(Outcome {
        summary: describe_scene(scene)?,
        ..Outcome::default()
    })
}

/// The text of [`check`].
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, or a requested column does not exist.
pub fn describe_scene(scene: &Scene) -> Result<String, StudyError> {
    let mechanism = &scene.mechanism;
    let configuration = scene.assembly.to_configuration();
    let model = crate::models::loaded_model(scene)?;
    let notes = crate::trajectory::compute::check_variables(scene, &model)?;
    let plan = model.plan();
    let mut text = format!("{}\n", scene.title);
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "  {}, {}, {}, driven by {}",
        count(mechanism.bodies.len() - 1, "moving body"),
        count(mechanism.joints.len(), "joint"),
        count(plan.actuators(), "degree of freedom"),
        list(mechanism.actuators.iter().map(|a| a.name.as_str())),
    );
    describe_freedom(mechanism, &configuration, plan, &mut text);
    describe_range(mechanism, plan, &mut text);
    describe_groups(mechanism, plan, &mut text);
    describe_branch(mechanism, plan, &mut text);
    describe_pruning(scene, &model, &mut text);
    describe_teeth(scene, &mut text);
    describe_requests(scene, &mut text);
    if let Some(note) = &scene.note {
        let _ = writeln!(text, "  note: {note}");
    }
    text += &notes;
    Ok(text)
}

/// Names separated by commas.
fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

pub(crate) fn body_names(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    list(bodies.iter().map(|&b| mechanism.body_name(b)))
}

/// Redundant constraints, which counting does not show.
fn describe_freedom(
    mechanism: &Mechanism,
    configuration: &AssemblyConfiguration,
    plan: &Plan,
    text: &mut String,
) {
    let reactions = mechanism.reactions();
    let indeterminate: Vec<String> = (0..reactions.len())
        .filter(|&k| !plan.is_determinate(k))
        .map(|k| mechanism.reaction_name(reactions[k]))
        .collect();
    if indeterminate.is_empty() {
        return;
    }
    if let Some(found) = mobility(mechanism, configuration) {
        let _ = writeln!(
            text,
            "  {} degrees of freedom by counting (Grübler), {} by rank: {}, consistently",
            found.grubler_count(),
            found.degrees_of_freedom(),
            if found.redundant_count == 1 {
                "one constraint is redundant".to_owned()
            } else {
                format!("{} constraints are redundant", found.redundant_count)
            },
        );
    }
    let _ = writeln!(
        text,
        "  statically indeterminate, because redundant constraints share the load: {}",
        indeterminate.join(", ")
    );
}

/// The range of the actuator.
fn describe_range(mechanism: &Mechanism, plan: &Plan, text: &mut String) {
    let [actuator] = mechanism.actuators.as_slice() else {
        let _ = writeln!(
            text,
            "  several actuators: limit positions are found along a motion or a sweep only"
        );
        return;
    };
    let name = &actuator.name;
    let angle = plan.is_angle(0);
    let interval_text = |from: f64, to: f64| {
        if angle {
            format!(
                "from {from:.6} to {to:.6} rad ({:.2}° to {:.2}°)",
                from.to_degrees(),
                to.to_degrees()
            )
        } else {
            format!("from {from:.6} to {to:.6} m")
        }
    };
    let _ = match plan.range() {
        Range::Full => writeln!(text, "  {name} rotates fully"),
        Range::Revolutions(turns) => writeln!(
            text,
            "  {name} rotates fully; the mechanism is periodic after {turns} revolutions"
        ),
        Range::Unbounded if angle => writeln!(
            text,
            "  {name} is unlimited; the mechanism is not periodic within 8 revolutions"
        ),
        Range::Unbounded => writeln!(text, "  no limit of {name} was found"),
        Range::Limited(from, to) | Range::Stroke(from, to) | Range::Unresolved(from, to) => {
            let note = match plan.range_limits() {
                [Some(_), Some(_)] => "",
                [Some(_), None] => "; no upper limit was found up to there",
                [None, Some(_)] => "; no lower limit was found down to there",
                [None, None] => "; no limit was found up to there",
            };
            writeln!(text, "  {name} ranges {}{note}", interval_text(from, to))
        }
    };
    for end in plan.range_limits().into_iter().flatten() {
        let _ = writeln!(text, "    {}", describe_limit(mechanism, plan, end));
    }
}

/// The cause of a limit.
fn describe_limit(mechanism: &Mechanism, plan: &Plan, end: RangeLimit) -> String {
    let unit = if plan.is_angle(0) { "rad" } else { "m" };
    let bodies_text = if plan.group_methods().is_empty() {
        String::new()
    } else {
        format!(
            " of {}",
            body_names(mechanism, &plan.group_bodies(end.group))
        )
    };
    let what = if end.change_point {
        "change point (another assembly mode begins)"
    } else {
        "limit position"
    };
    format!("{:.12} {unit}: {what}{bodies_text}", end.q)
}

fn describe_groups(mechanism: &Mechanism, plan: &Plan, text: &mut String) {
    let groups = plan.group_methods();
    if !groups.is_empty() {
        let _ = writeln!(text, "  groups, in the order of solution:");
    }
    for (g, (size, kind)) in groups.into_iter().enumerate() {
        let joints = plan.group_joints(g);
        let joints = joints.iter().map(|j| mechanism.joints[j.0].name.as_str());
        let placed_bodies = body_names(mechanism, &plan.group_bodies(g));
        let placed_bodies = if placed_bodies.is_empty() {
            "a line".to_owned()
        } else {
            placed_bodies
        };
        let joints = list(joints);
        let closed_by = if joints.is_empty() {
            "its actuator".to_owned()
        } else {
            joints
        };
        let _ = writeln!(
            text,
            "    {}. {placed_bodies} closed by {closed_by}: {}, {kind}",
            g + 1,
            count(size, "unknown"),
        );
        let branches = &plan.group_modes()[g];
        if branches.modes.len() > 1 {
            for (k, mode) in branches.modes.iter().enumerate() {
                let label = if k == 0 {
                    "assembly mode in use:"
                } else {
                    "other assembly mode:"
                };
                let _ = writeln!(
                    text,
                    "       {label} {}",
                    describe_mode(mechanism, branches, mode)
                );
            }
        }
    }
}

/// The angles and travels that distinguish an assembly mode of a group.
fn describe_mode(mechanism: &Mechanism, branches: &GroupModes, mode: &[f64]) -> String {
    let angles = branches.bodies.iter().zip(mode);
    let angles: Vec<_> = angles
        .map(|(b, angle)| format!("{} = {:.4}", mechanism.body_name(*b), angle + 0.0))
        .collect();
    let mut texts = Vec::new();
    if !angles.is_empty() {
        texts.push(format!("{} rad", angles.join(", ")));
    }
    let values = mode.iter().skip(branches.bodies.len());
    for (joint, value) in branches.joints.iter().zip(values) {
        let joint = &mechanism.joints[joint.0];
        let unit = match joint.kind.branch_hint() {
            Some(BranchHint::Direction) => "rad",
            _ => "m",
        };
        texts.push(format!("{} = {:.4} {unit}", joint.name, value + 0.0));
    }
    texts.join(", ")
}

/// The angles of all bodies at the start.
fn describe_branch(mechanism: &Mechanism, plan: &Plan, text: &mut String) {
    let mut pose = plan.pose();
    if plan
        .positions(plan.assembly_coordinates(), &mut pose)
        .is_err()
    {
        return;
    }
    let at: Vec<_> = mechanism
        .actuators
        .iter()
        .enumerate()
        .map(|(i, a)| {
            let unit = if plan.is_angle(i) { "rad" } else { "m" };
            format!(
                "{} = {} {unit}",
                a.name,
                number(plan.assembly_coordinates()[i])
            )
        })
        .collect();
    let _ = writeln!(text, "  body angles at {}:", at.join(", "));
    let named = || {
        let carried = plan.moving_bodies().iter().map(|c| c.body);
        carried.filter(|&b| b < mechanism.bodies.len()).map(BodyId)
    };
    let widths = named().map(|b| mechanism.body_name(b).chars().count());
    let width = widths.max().unwrap_or(0);
    for body in named() {
        let angle = plan.body_rotation(body, &pose).angle();
        // Rounded first, so that no zero keeps a minus sign.
        let [radians, degrees] = [(angle, 1e6), (angle.to_degrees(), 1e3)]
            .map(|(value, parts)| (value * parts).round() / parts + 0.0);
        let _ = writeln!(
            text,
            "    {:<width$}  {radians:9.6} rad  {degrees:8.3}°",
            mechanism.body_name(body),
        );
    }
}

/// The groups that trajectory analyses model, and why; and those that they and the reduced model skip.
fn describe_pruning(scene: &Scene, model: &Model, text: &mut String) {
    let mechanism = &scene.mechanism;
    let plan = model.plan();
    let group = |g: usize| match body_names(mechanism, &plan.group_bodies(g)) {
        none if none.is_empty() => format!("{}. a line", g + 1),
        named => format!("{}. {named}", g + 1),
    };
    let count = plan.group_methods().len();
    match crate::trajectory::compute::requested_bodies(scene, model) {
        _ if count == 0 => {}
        None => {
            let _ = writeln!(
                text,
                "  modelled along a trajectory: every group, since no `variables` are requested"
            );
        }
        Some(requested) => {
            let massive = scene.masses.iter().enumerate();
            let massive = massive.filter(|(_, m)| m.mass > 0.0 || m.inertia > 0.0);
            let loaded = scene.loads.iter().flat_map(|load| load.bodies(mechanism));
            let needs = [
                ("inertia", plan.groups_needed_by(massive.map(|(b, _)| b))),
                ("loads", plan.groups_needed_by(loaded.map(|b| b.0))),
                (
                    "requests",
                    plan.groups_needed_by(requested.iter().map(|b| b.0)),
                ),
            ];
            let _ = writeln!(text, "  modelled along a trajectory, because of:");
            for g in 0..count {
                let needs = needs.iter().filter(|(_, needed)| needed[g]);
                let needs = list(needs.map(|(what, _)| *what));
                let why = match needs.is_empty() {
                    true => "skipped, it affects no inertia, load or requested result",
                    false => &needs,
                };
                let _ = writeln!(text, "    {}: {why}", group(g));
            }
        }
    }
    if plan.actuators() == 1 {
        let requested_bodies = crate::models::requested_reaction_bodies(scene);
        let unloaded = Model::clone(model).with_loads(Vec::new());
        let pruned = unloaded.map(|unloaded| {
            unloaded
                .pruned_for(&requested_bodies)
                .plan()
                .pruned_groups()
        });
        let pruned = pruned.unwrap_or_default().into_iter().enumerate();
        let pruned: Vec<String> = pruned.filter(|s| s.1).map(|(g, _)| group(g)).collect();
        if !pruned.is_empty() {
            let _ = writeln!(
                text,
                "  skipped by `reduce` and `simulate`, as they affect no inertia or requested reaction: {}",
                pruned.join("; ")
            );
        }
    }
    let massless: Vec<_> = plan
        .moving_bodies()
        .iter()
        .filter_map(|c| scene.masses.get(c.body).map(|mass| (c.body, mass)))
        .filter(|(_, mass)| mass.mass == 0.0 && mass.inertia == 0.0)
        .map(|(b, _)| mechanism.body_name(BodyId(b)))
        .collect();
    if !massless.is_empty() {
        let _ = writeln!(
            text,
            "  massless, so without inertia forces: {}",
            massless.join(", ")
        );
    }
}

/// The teeth that have a separating force, and those that have none.
fn describe_teeth(scene: &Scene, text: &mut String) {
    let joints = scene.mechanism.joints.iter().enumerate();
    let toothed = joints.filter(|(_, joint)| Mesh::of(joint).is_some());
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for (j, joint) in toothed {
        let mut teeth = scene.loads.iter().filter_map(Load::pressure_angle);
        match teeth.find(|teeth| teeth.joint == JointId(j)) {
            Some(teeth) => with.push(format!(
                "{} (pressure angle {}°)",
                joint.name,
                digits(teeth.angle.to_degrees(), 6)
            )),
            None => without.push(joint.name.as_str()),
        }
    }
    if !with.is_empty() {
        let _ = writeln!(text, "  separating forces: {}", with.join(", "));
    }
    if !without.is_empty() {
        let _ = writeln!(
            text,
            "  no separating force is modelled, as no `pressure-angle` is given: {}",
            list(without)
        );
    }
}

fn describe_requests(scene: &Scene, text: &mut String) {
    let mechanism = &scene.mechanism;
    let requested = &scene.requests.reactions;
    let names: Vec<_> = requested
        .iter()
        .map(|&r| mechanism.reaction_name(r))
        .collect();
    let others = mechanism.reactions().len() - names.len();
    let _ = writeln!(
        text,
        "  reactions requested: {}{}",
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        },
        if others > 0 {
            format!(" ({others} others are not computed: not requested)")
        } else {
            String::new()
        }
    );
    if !scene.loads.is_empty() {
        let loads = list(scene.loads.iter().map(|l| l.name.as_str()));
        let _ = writeln!(text, "  loads: {loads}");
    }
}
