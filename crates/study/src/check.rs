//! `dwell check`: what the scene is, before anything moves.

use crate::error::StudyError;
use crate::outcome::Outcome;
use crate::words::{count, number};
use dwell_geometry::mobility::mobility;
use dwell_geometry::plan::Branches;
use dwell_geometry::{BodyId, End, Mechanism, Plan, Range, Start, Told};
use dwell_kinetostatics::Model;
use dwell_scene::Scene;
use std::fmt::Write as _;

/// Describes a scene: degrees of freedom, groups, branches, range, what is modelled and why, and
/// the requests. It writes no file.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be put together, or a requested column does not exist.
pub fn check(scene: &Scene) -> Result<Outcome, StudyError> {
    let mechanism = &scene.mechanism;
    let start = scene.assembly.to_start();
    let model = crate::run::model(scene)?;
    crate::run::check_variables(scene, &model)?;
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
    freedom(mechanism, &start, plan, &mut text);
    range(mechanism, plan, &mut text);
    groups(mechanism, plan, &mut text);
    branch(mechanism, plan, &mut text);
    modelled(scene, &model, &mut text);
    requests(scene, &mut text);
    if let Some(note) = &scene.note {
        let _ = writeln!(text, "  note: {note}");
    }
    Ok(Outcome {
        summary: text,
        ..Outcome::default()
    })
}

/// Words in a row.
fn list<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().collect::<Vec<_>>().join(", ")
}

fn bodies(mechanism: &Mechanism, bodies: &[BodyId]) -> String {
    list(bodies.iter().map(|&b| mechanism.body_name(b)))
}

/// Where counting is not enough: constraints that repeat others.
fn freedom(mechanism: &Mechanism, start: &Start, plan: &Plan, text: &mut String) {
    let reactions = mechanism.reactions();
    let shared: Vec<String> = (0..reactions.len())
        .filter(|&k| !plan.is_unique(k))
        .map(|k| mechanism.reaction_name(reactions[k]))
        .collect();
    if shared.is_empty() {
        return;
    }
    if let Some(found) = mobility(mechanism, start) {
        let _ = writeln!(
            text,
            "  by counting {} degrees of freedom, by rank {}: {} others, consistently",
            found.counted(),
            found.freedom(),
            if found.excess == 1 {
                "one constraint repeats".to_owned()
            } else {
                format!("{} constraints repeat", found.excess)
            },
        );
    }
    let _ = writeln!(
        text,
        "  not unique, because repeated constraints share them: {}",
        shared.join(", ")
    );
}

/// How far the actuators go.
fn range(mechanism: &Mechanism, plan: &Plan, text: &mut String) {
    let [actuator] = mechanism.actuators.as_slice() else {
        let _ = writeln!(
            text,
            "  several actuators: limit positions are found along a motion or a sweep"
        );
        return;
    };
    let name = &actuator.name;
    let angle = plan.is_angle(0);
    let verb = if angle { "turns" } else { "goes" };
    let both = |from: f64, to: f64| {
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
        Range::Full => writeln!(text, "  {name} turns fully"),
        Range::Turns(turns) => writeln!(
            text,
            "  {name} turns fully; the mechanism comes back after {turns} turns"
        ),
        Range::Endless if angle => writeln!(
            text,
            "  {name} turns on and on; the mechanism does not come back after a few turns"
        ),
        Range::Endless => writeln!(text, "  no end of {name} was found"),
        Range::Between(from, to) | Range::Stroke(from, to) | Range::Followed(from, to) => {
            let open = match plan.ends() {
                [Some(_), Some(_)] => "",
                [Some(_), None] => "; no upper end was met, it is followed no farther",
                [None, Some(_)] => "; no lower end was met, it is followed no farther",
                [None, None] => "; no end was met, it is followed no farther",
            };
            writeln!(text, "  {name} {verb} {}{open}", both(from, to))
        }
    };
    for end in plan.ends().into_iter().flatten() {
        let _ = writeln!(text, "    {}", why(mechanism, plan, end));
    }
}

/// Why a range ends.
fn why(mechanism: &Mechanism, plan: &Plan, end: End) -> String {
    let unit = if plan.is_angle(0) { "rad" } else { "m" };
    let who = if plan.group_kinds().is_empty() {
        String::new()
    } else {
        format!(" of {}", bodies(mechanism, &plan.group_bodies(end.group)))
    };
    let what = if end.change_point {
        "a change point, where another branch begins,"
    } else {
        "a limit position"
    };
    format!("{:.12} {unit}: {what}{who}", end.q)
}

fn groups(mechanism: &Mechanism, plan: &Plan, text: &mut String) {
    let groups = plan.group_kinds();
    if !groups.is_empty() {
        let _ = writeln!(text, "  groups, in the order of solution:");
    }
    for (g, (size, kind)) in groups.into_iter().enumerate() {
        let joints = plan.group_joints(g);
        let joints = joints.iter().map(|j| mechanism.joints[j.0].name.as_str());
        let placed = bodies(mechanism, &plan.group_bodies(g));
        let placed = if placed.is_empty() {
            "a line".to_owned()
        } else {
            placed
        };
        let joints = list(joints);
        let closed = if joints.is_empty() {
            "its actuator".to_owned()
        } else {
            joints
        };
        let _ = writeln!(
            text,
            "    {}. {placed} closed by {closed}: {}, {kind}",
            g + 1,
            count(size, "unknown"),
        );
        let branches = &plan.branches()[g];
        if branches.ways.len() > 1 {
            for (k, way) in branches.ways.iter().enumerate() {
                let which = if k == 0 {
                    "on the branch"
                } else {
                    "it could close at"
                };
                let _ = writeln!(text, "       {which} {}", told(mechanism, branches, way));
            }
        }
    }
}

/// What tells a way of a group from the others.
fn told(mechanism: &Mechanism, branches: &Branches, way: &[f64]) -> String {
    let angles = branches.bodies.iter().zip(way);
    let angles: Vec<_> = angles
        .map(|(b, angle)| format!("{} = {:.4}", mechanism.body_name(*b), angle + 0.0))
        .collect();
    let mut told = Vec::new();
    if !angles.is_empty() {
        told.push(format!("{} rad", angles.join(", ")));
    }
    let values = way.iter().skip(branches.bodies.len());
    for (joint, value) in branches.joints.iter().zip(values) {
        let joint = &mechanism.joints[joint.0];
        let unit = match joint.kind.told() {
            Some(Told::Direction) => "rad",
            _ => "m",
        };
        told.push(format!("{} = {:.4} {unit}", joint.name, value + 0.0));
    }
    told.join(", ")
}

/// The angles of all bodies at the start.
fn branch(mechanism: &Mechanism, plan: &Plan, text: &mut String) {
    let mut pose = plan.pose();
    if plan.place(plan.start(), &mut pose).is_err() {
        return;
    }
    let at: Vec<_> = mechanism
        .actuators
        .iter()
        .enumerate()
        .map(|(i, a)| {
            let unit = if plan.is_angle(i) { "rad" } else { "m" };
            format!("{} = {} {unit}", a.name, number(plan.start()[i]))
        })
        .collect();
    let _ = writeln!(text, "  branch, as body angles at {}:", at.join(", "));
    let named = || {
        let carried = plan.carried().iter().map(|c| c.body);
        carried.filter(|&b| b < mechanism.bodies.len()).map(BodyId)
    };
    let widths = named().map(|b| mechanism.body_name(b).chars().count());
    let width = widths.max().unwrap_or(0);
    for body in named() {
        let angle = plan.body_turn(body, &pose).angle();
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

/// Which groups the runs along a way model and for what, and which they and the reduced model skip.
fn modelled(scene: &Scene, model: &Model, text: &mut String) {
    let mechanism = &scene.mechanism;
    let plan = model.plan();
    let group = |g: usize| match bodies(mechanism, &plan.group_bodies(g)) {
        none if none.is_empty() => format!("{}. a line", g + 1),
        named => format!("{}. {named}", g + 1),
    };
    let count = plan.group_kinds().len();
    match crate::run::wanted(scene, model) {
        _ if count == 0 => {}
        None => {
            let _ = writeln!(
                text,
                "  modelled along a way: every group, since no `variables` are requested"
            );
        }
        Some(requested) => {
            let massive = scene.masses.iter().enumerate();
            let massive = massive.filter(|(_, m)| m.mass > 0.0 || m.inertia > 0.0);
            let loaded = scene.loads.iter().flat_map(|load| load.bodies(mechanism));
            let needs = [
                ("inertia", plan.needed_for(massive.map(|(b, _)| b))),
                ("loads", plan.needed_for(loaded.map(|b| b.0))),
                ("requests", plan.needed_for(requested.iter().map(|b| b.0))),
            ];
            let _ = writeln!(text, "  modelled along a way, and for what:");
            for g in 0..count {
                let needs = needs.iter().filter(|(_, needed)| needed[g]);
                let needs = list(needs.map(|(what, _)| *what));
                let why = match needs.is_empty() {
                    true => "skipped, no inertia, load or request needs it",
                    false => &needs,
                };
                let _ = writeln!(text, "    {}: {why}", group(g));
            }
        }
    }
    if plan.actuators() == 1 {
        let reacting = crate::prepare::reacting(scene);
        let bare = Model::clone(model).with_loads(mechanism, Vec::new());
        let skipped = bare.map(|bare| bare.only_for(mechanism, &reacting).plan().skipped());
        let skipped = skipped.unwrap_or_default().into_iter().enumerate();
        let skipped: Vec<String> = skipped.filter(|s| s.1).map(|(g, _)| group(g)).collect();
        if !skipped.is_empty() {
            let _ = writeln!(
                text,
                "  skipped by `reduce` and `simulate`, which no inertia or requested reaction needs: {}",
                skipped.join("; ")
            );
        }
    }
    let massless: Vec<_> = plan
        .carried()
        .iter()
        .filter_map(|c| scene.masses.get(c.body).map(|mass| (c.body, mass)))
        .filter(|(_, mass)| mass.mass == 0.0 && mass.inertia == 0.0)
        .map(|(b, _)| mechanism.body_name(BodyId(b)))
        .collect();
    if !massless.is_empty() {
        let _ = writeln!(
            text,
            "  without inertia, so no force of theirs is computed: {}",
            massless.join(", ")
        );
    }
}

fn requests(scene: &Scene, text: &mut String) {
    let mechanism = &scene.mechanism;
    let asked = &scene.requests.reactions;
    let names: Vec<_> = asked.iter().map(|&r| mechanism.reaction_name(r)).collect();
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
