//! `dwell check`: what the scene is, before anything moves.

use crate::error::StudyError;
use crate::outcome::Outcome;
use crate::prepare::Prepared;
use crate::words::{count, number};
use dwell_geometry::BodyId;
use dwell_scene::Scene;
use std::fmt::Write as _;

/// Describes a scene: degrees of freedom, groups, branch, range and requests. It writes no file.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be put together.
pub fn check(scene: &Scene) -> Result<Outcome, StudyError> {
    let prepared = Prepared::new(scene)?;
    let plan = prepared.model.model().plan();
    let mechanism = &scene.mechanism;
    let coordinate = prepared.coordinate();
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", scene.title);
    let _ = writeln!(
        text,
        "  {}, {}, 1 degree of freedom, driven by {coordinate}",
        count(mechanism.bodies.len() - 1, "moving body"),
        count(mechanism.joints.len(), "joint"),
    );
    let _ = match plan.range().limits() {
        None => writeln!(text, "  {coordinate} turns fully"),
        Some((from, to)) => writeln!(
            text,
            "  {coordinate} turns from {from:.6} to {to:.6} rad ({:.2}° to {:.2}°), limit positions or change points",
            from.to_degrees(),
            to.to_degrees()
        ),
    };
    let groups = plan.group_kinds();
    if !groups.is_empty() {
        let _ = writeln!(text, "  groups, in the order of solution:");
    }
    for (g, (size, kind)) in groups.into_iter().enumerate() {
        let bodies = plan.group_bodies(g);
        let joints = plan.group_joints(g);
        let bodies: Vec<_> = bodies.iter().map(|&b| mechanism.body_name(b)).collect();
        let joints: Vec<_> = joints
            .iter()
            .map(|j| mechanism.joints[j.0].name.as_str())
            .collect();
        let _ = writeln!(
            text,
            "    {}. {} closed by {}: {}, {kind}",
            g + 1,
            bodies.join(", "),
            joints.join(", "),
            count(size, "unknown"),
        );
    }
    let mut pose = plan.pose();
    if plan.place(plan.start(), &mut pose).is_ok() {
        let _ = writeln!(
            text,
            "  branch, as body angles at {coordinate} = {} rad:",
            number(plan.start()[0])
        );
        let named = || {
            let carried = plan.carried().iter();
            carried.filter(|c| c.body < mechanism.bodies.len())
        };
        let names = named().map(|c| mechanism.body_name(BodyId(c.body)));
        let width = names.map(|n| n.chars().count()).max().unwrap_or(0);
        for carried in named() {
            let angle = plan.body_turn(BodyId(carried.body), &pose).angle();
            // Rounded first, so that no zero keeps a minus sign.
            let [radians, degrees] = [(angle, 1e6), (angle.to_degrees(), 1e3)]
                .map(|(value, parts)| (value * parts).round() / parts + 0.0);
            let _ = writeln!(
                text,
                "    {:<width$}  {radians:9.6} rad  {degrees:8.3}°",
                mechanism.body_name(BodyId(carried.body)),
            );
        }
    }
    let massless: Vec<_> = plan
        .carried()
        .iter()
        .filter(|c| c.body < mechanism.bodies.len())
        .filter(|c| {
            let mass = &scene.masses[c.body];
            mass.mass == 0.0 && mass.inertia == 0.0
        })
        .map(|c| mechanism.body_name(BodyId(c.body)))
        .collect();
    if !massless.is_empty() {
        let _ = writeln!(
            text,
            "  without inertia, so no force of theirs is computed: {}",
            massless.join(", ")
        );
    }
    let names: Vec<_> = prepared.reactions().into_iter().map(|(n, _)| n).collect();
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
    if let Some(note) = &scene.note {
        let _ = writeln!(text, "  note: {note}");
    }
    Ok(Outcome {
        summary: text,
        ..Outcome::default()
    })
}
