//! The description of an export and of its errors, in words.

use crate::export::{Export, STATED_STEP};

/// The description of the export of a machine and of its errors, line by line, for every target.
pub(crate) fn describe(export: &Export) -> Vec<String> {
    let (machine, measured) = (&export.machine, &export.measured);
    let domain = machine.domain;
    let unit = machine.unit();
    let mut lines = vec![
        machine.title.clone(),
        String::new(),
        format!(
            "Reduced model of one degree of freedom, written by dwell {} from the scene with the hash {}.",
            machine.version, machine.scene_hash
        ),
        "All quantities are in SI units.".to_owned(),
        match domain.revolutions {
            0 => format!(
                "coordinate: {} from {:e} to {:e} {unit}; beyond there is no value",
                machine.coordinate, domain.from, domain.to
            ),
            1 => format!(
                "coordinate: {}, {unit}, with the period of one revolution",
                machine.coordinate
            ),
            n => format!(
                "coordinate: {}, {unit}, with the period of {n} revolutions",
                machine.coordinate
            ),
        },
    ];
    lines.extend(accuracy(export));
    let [from, speed] = measured.motion.from;
    lines.push(match measured.step_error {
        Some([q, q_dot]) => format!(
            "step: after 1 s of steps of {STATED_STEP:e} s from q = {from}, q' = {speed} with the inputs of the scene, q is off by {q:.1e} {unit} and q' by {q_dot:.1e} {unit}/s (in exact numbers; it falls with the fourth power of the step)"
        ),
        None => format!("step: no error is stated, since the motion from q = {from}, q' = {speed} ends before 1 s"),
    });
    lines.extend(
        machine
            .left_out
            .iter()
            .map(|words| format!("left out: {words}")),
    );
    lines
}

/// The required accuracy, and the largest errors.
fn accuracy(export: &Export) -> [String; 2] {
    let (machine, measured) = (&export.machine, &export.measured);
    let errors = measured.errors;
    let accuracy = export.request.accuracy;
    let origin = match export.code {
        None => format!("accuracy: asked for {accuracy:e}"),
        Some(_) => "accuracy: the operations of the model itself".to_owned(),
    };
    let asked = format!(
        "{origin}; largest errors measured at 4096 positions in {}, relative to the largest value of each function:",
        export.request.precision.measured_in()
    );
    let mut all = vec![("m", errors.m), ("half_dm", errors.half_dm)];
    if !machine.loads.is_empty() {
        all.push(("w", errors.loads));
    }
    if !machine.reactions.is_empty() {
        all.push(("a and b", errors.reactions));
        if !machine.loads.is_empty() {
            all.push(("c", errors.load_reactions));
        }
    }
    if !machine.points.is_empty() {
        all.push(("positions", errors.positions));
    }
    let all: Vec<String> = all
        .iter()
        .map(|(of, error)| format!("{of} {error:.1e}"))
        .collect();
    [asked, format!("  {}", all.join(", "))]
}
