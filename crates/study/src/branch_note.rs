//! Says where the assembly mode in use lies far from the approximate angles that selected it.

use crate::number_format::digits;
use dwell_geometry::{BodyId, Plan};
use dwell_scene::PlaneScene;
use std::f64::consts::{PI, TAU};

/// Deviation, rad, from which an approximate angle is no longer taken for the one in use: 20°.
const FAR: f64 = 20.0 * PI / 180.0;

/// A line for each body whose angle at the start is far from the approximate angle that the scene gives.
pub(crate) fn branch_note(scene: &PlaneScene, plan: &Plan) -> String {
    let mut pose = plan.pose();
    if plan
        .positions(plan.assembly_coordinates(), &mut pose)
        .is_err()
    {
        return String::new();
    }
    let pruned = plan.pruned_groups().into_iter().enumerate();
    let pruned = pruned.filter(|(_, is_pruned)| *is_pruned);
    let pruned: Vec<BodyId> = pruned.flat_map(|(g, _)| plan.group_bodies(g)).collect();
    let guesses = scene.assembly.to_configuration().initial_guess;
    let guesses = guesses.into_iter().enumerate();
    let guesses = guesses.filter_map(|(b, guess)| Some((b, guess?)));
    let mut text = String::new();
    for (body, guess) in guesses.filter(|(b, _)| !pruned.contains(&BodyId(*b))) {
        let angle = plan.body_rotation(BodyId(body), &pose).angle();
        let deviation = (angle - guess + PI).rem_euclid(TAU) - PI;
        if deviation.abs() > FAR {
            let name = scene.mechanism.body_name(BodyId(body));
            let [given, found] = [guess, guess + deviation].map(|v| digits(v.to_degrees(), 3));
            text += &format!(
                "  {name} is at {found}°, far from the approximate {given}° of [assembly]; `dwell check` lists the assembly modes\n"
            );
        }
    }
    text
}
