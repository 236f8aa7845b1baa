//! How far the findings of a case agree.

use super::foot;
use crate::words::count;
use dwell_findings::Finding;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};
use dwell_scene::Scene;

/// Where an exact agreement is drawn.
const EXACT: f64 = 1e-18;
/// Most findings in a panel.
const TOGETHER: usize = 7;

/// The relative difference of every finding beside its tolerance, in the order of the table.
pub(crate) fn digits(scene: &Scene, findings: &[Finding]) -> Figure {
    let parts = findings.len().div_ceil(TOGETHER).max(1);
    let panel = |some: &[Finding]| {
        let row = |k: usize| (some.len() - k) as f64;
        let points = |of: &dyn Fn(&Finding) -> f64| -> Vec<[f64; 2]> {
            let at = |(k, f): (usize, &Finding)| [of(f), row(k)];
            some.iter().enumerate().map(at).collect()
        };
        let labels = some.iter().enumerate().map(|(k, f)| Mark::Horizontal {
            at: row(k),
            label: f.key.clone(),
        });
        Panel::from(Chart {
            x: Axis::log("relative difference", "").within(EXACT, 1.0),
            y: Axis::new("finding", "").within(0.0, some.len() as f64 + 1.0),
            series: vec![
                Series::line("difference", points(&|f| f.relative.max(EXACT)))
                    .stroke(Stroke::Points),
                Series::line("tolerance", points(&|f| f.tolerance.max(EXACT)))
                    .stroke(Stroke::Points)
                    .color(Paint::Grey),
            ],
            marks: labels.collect(),
            ..Chart::default()
        })
    };
    Figure {
        name: "h-digits".to_owned(),
        title: "Digits of agreement".to_owned(),
        caption: foot(
            scene,
            "The largest relative difference of every finding and its tolerance; what agrees exactly stands at the left edge.",
        ),
        columns: parts.min(2),
        panels: findings
            .chunks(findings.len().div_ceil(parts).max(1))
            .map(panel)
            .collect(),
        provenance: format!(
            "{}, each with its own truth and tolerance",
            count(findings.len(), "finding")
        ),
    }
}
