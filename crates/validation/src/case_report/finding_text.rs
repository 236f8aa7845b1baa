//! Findings as text.

use dwell_findings::Finding;
use dwell_report::Block;
use dwell_scene::Scene;
use dwell_study::number_format::count;

/// A failed finding as text: the check, where it fails, and by how much.
pub(crate) fn describe_failure(finding: &Finding) -> [String; 3] {
    let location = match finding.domain.is_empty() {
        true => finding.worst_at.clone(),
        false => format!("{}, of {}", finding.worst_at, finding.domain),
    };
    let difference = if finding.relative_difference.is_nan() {
        "none could be taken".to_owned()
    } else {
        let unit = if finding.unit.is_empty() { "" } else { " " };
        format!(
            "{:.2e}{unit}{}, {:.1e} of {}; tolerance {:.1e}",
            finding.absolute_difference,
            finding.unit,
            finding.relative_difference,
            finding.scale,
            finding.tolerance
        )
    };
    [
        format!("check {}, {}", finding.check, finding.comparison),
        format!("at {location}"),
        format!("difference {difference}"),
    ]
}

/// How many findings pass, and those that fail.
pub(crate) fn findings_summary(scene: &Scene, findings: &[Finding]) -> String {
    let failed: Vec<&Finding> = findings.iter().filter(|f| !f.pass).collect();
    let mut text = format!(
        "{}: {} of {} findings pass\n",
        scene.name,
        findings.len() - failed.len(),
        findings.len()
    );
    for f in failed {
        text += &format!("  FAIL {} {}\n", f.key, describe_failure(f).join("\n    "));
    }
    text
}

/// The paragraph on the tolerances of a case.
pub(crate) fn tolerances_block(findings: &[Finding]) -> Block {
    let loose: Vec<String> = (findings.iter().filter(|f| f.is_loose()))
        .map(|f| format!("`{}` (at most {:.0e})", f.key, f.max_tolerance()))
        .collect();
    let integrated = findings.iter().filter(|f| f.integrated).count();
    let mut text = match loose.is_empty() {
        true => "No tolerance is above 100 times the largest difference plus 50 rounding errors times the condition number.".to_owned(),
        false => format!(
            "Tolerances above 100 times the largest difference plus 50 rounding errors times the condition number: {}.",
            loose.join(", ")
        ),
    };
    if integrated > 0 {
        text += &format!(
            " That rule does not apply to {}, which are checked by convergence orders and by multiples of the integrator's tolerance.",
            count(integrated, "integrated result")
        );
    }
    Block::Text(text)
}
