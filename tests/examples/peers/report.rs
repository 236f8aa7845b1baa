//! The figure and the page.

use super::motion::{EXACT, FROM_TEXT, QUADRATURE, Stages, TABLE};
use super::speedups::seconds;
use super::{ANGLE_ROUNDING, Run, all_cases, fastest_runs};
use dwell_report::{Axis, Block, Chart, Document, Figure, Mark, Paint, Panel, Series, Stroke};

/// The curves: tool, name in the legend, colour; the others first.
const CURVES: [(&str, &str, Paint); 7] = [
    ("Exudyn", "Exudyn", Paint::Palette(0)),
    ("Pinocchio", "Pinocchio", Paint::Palette(2)),
    ("MuJoCo", "MuJoCo", Paint::Palette(5)),
    (EXACT, "Dwell, exact", Paint::Palette(3)),
    (QUADRATURE, "Dwell, quadrature", Paint::Ink),
    (FROM_TEXT, "Dwell, from text", Paint::Grey),
    (TABLE, "Dwell, table", Paint::Palette(1)),
];

/// Error against wall time, all mechanisms.
pub(crate) fn figure(runs: &[Run]) -> Figure {
    Figure {
        name: "peers".into(),
        title: "Free motions: error against time".into(),
        caption: "Ten turns of each crank; the Bricard linkage swings for ten seconds. Least times of one run on one machine. Exudyn, Pinocchio (a Python loop) and MuJoCo: the integration alone. Dwell: \
                  integrators on exact evaluation; integrators on a table, with its building; the quadrature; and the quadrature from \
                  the scene's text on, with reading and building. A curve has its tool's best: what a quicker run surpasses is left out, and what is accurate by chance."
            .into(),
        columns: 2,
        panels: all_cases().map(|case| panel(runs, case)).collect(),
        ..Figure::default()
    }
}

fn panel(runs: &[Run], case: &str) -> Panel {
    let series = CURVES.into_iter().filter_map(|(tool, name, color)| {
        let fastest = fastest_runs(runs, case, tool);
        let points: Vec<_> = fastest.iter().map(|r| [r.wall_time, r.error]).collect();
        let line = || Series::line(name, points.clone()).color(color);
        (!points.is_empty()).then(|| line().stroke(Stroke::LineAndPoints))
    });
    let series = series.collect();
    Panel::from(Chart {
        title: case.into(),
        x: Axis::log("wall time", "s").with_range(3e-6, 60.0),
        y: Axis::log("error of the crank angle", "rad").with_range(1e-15, 10.0),
        series,
        marks: vec![Mark::Horizontal {
            at: ANGLE_ROUNDING,
            label: "one rounding of 63 rad".into(),
        }],
        ..Chart::default()
    })
}

/// Everything that was measured.
pub(crate) fn document(runs: &[Run], stages_by_case: &[Stages], speedups: &[String]) -> Document {
    let mut blocks = vec![
        Block::Figure {
            file: "peers.png".into(),
            alt: "Error of the crank angle against wall time, all mechanisms, all tools".into(),
            caption: String::new(),
        },
        Block::Heading("At equal error".into()),
        Block::Text(speedups.iter().map(|line| format!("- {line}\n")).collect()),
        Block::Heading("Before the motion".into()),
        stages(stages_by_case),
    ];
    for case in all_cases() {
        blocks.push(Block::Heading(format!("All runs of the {case}")));
        let of = runs.iter().filter(|run| run.case == case);
        blocks.push(Block::Table {
            header: ["tool", "setting", "wall time", "error (rad)"]
                .map(str::to_owned)
                .into(),
            rows: of
                .map(|r| {
                    vec![
                        r.tool.clone(),
                        r.setting.clone(),
                        seconds(r.wall_time),
                        error(r),
                    ]
                })
                .collect(),
        });
    }
    Document {
        title: "Dwell beside full multibody codes".into(),
        blocks,
    }
}

fn error(run: &Run) -> String {
    match run.error > ANGLE_ROUNDING {
        true => format!("{:.1e}", run.error),
        false => "at the floor".into(),
    }
}

fn stages(stages_by_case: &[Stages]) -> Block {
    Block::Table {
        header: [
            "mechanism",
            "reading the scene",
            "building the model",
            "a table to 1e-11",
        ]
        .map(str::to_owned)
        .into(),
        rows: stages_by_case
            .iter()
            .map(|s| {
                vec![
                    s.case.clone(),
                    seconds(s.read),
                    seconds(s.build),
                    s.table.map_or("-".into(), seconds),
                ]
            })
            .collect(),
    }
}
