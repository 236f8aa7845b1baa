//! A run's table, read back from its file.

use dwell_scene::PlaneScene;
use dwell_study::{
    Analysis, PictureFormat, Pictures, TrajectoryOutcome, analyse_trajectory, no_progress,
};
use std::path::Path;

/// A crank-rocker whose bodies' centres are named points, under weight alone.
pub(crate) const WEIGHTS: &str = include_str!("weights.toml");
/// A pendulum with its weight, without motion.
pub(crate) const PENDULUM: &str = include_str!("pendulum.toml");
/// The masses of the crank-rocker, kg.
pub(crate) const MASSES: [(&str, f64); 3] = [("crank", 1.0), ("coupler", 2.0), ("rocker", 1.5)];

pub(crate) struct Table {
    pub(crate) names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn parse(text: &str) -> Self {
        let mut lines = text.lines();
        let name = |cell: &str| cell.split(" [").next().unwrap().to_owned();
        let cell = |v: &str| match v {
            "" => f64::NAN,
            v => v.parse().unwrap(),
        };
        let row = |line: &str| line.split(',').map(cell).collect();
        Self {
            names: lines.next().unwrap().split(',').map(name).collect(),
            rows: lines.map(row).collect(),
        }
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }

    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let k = self.names.iter().position(|n| n == name);
        let k = k.unwrap_or_else(|| panic!("no column {name} in {:?}", self.names));
        self.rows.iter().map(|row| row[k]).collect()
    }
}

pub(crate) fn case(name: &str) -> PlaneScene {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(home.join(name).join("scene.toml")).unwrap()
}

pub(crate) fn scene(text: &str) -> PlaneScene {
    PlaneScene::parse("test.toml", text).unwrap()
}

pub(crate) fn analyse(scene: &PlaneScene, command: Analysis, points: usize) -> TrajectoryOutcome {
    let mut result = analyse_trajectory(scene, command, Some(points), &no_progress).unwrap();
    result.outcome = result
        .outcome
        .draw((Pictures::None, PictureFormat::Png), &no_progress)
        .unwrap();
    result
}

/// The file of a run whose name ends so, as text.
pub(crate) fn file(result: &TrajectoryOutcome, end: &str) -> String {
    let mut files = result.outcome.files.iter();
    let (_, bytes) = files
        .find(|(path, _)| path.to_str().unwrap().ends_with(end))
        .unwrap();
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The table of a run that reaches its end.
pub(crate) fn table(scene: &PlaneScene, command: Analysis, points: usize) -> Table {
    let result = analyse(scene, command, points);
    assert!(result.early_stop.is_none(), "{}", scene.name);
    Table::parse(&file(&result, &format!("-{}.csv", command.name())))
}

/// The largest magnitude.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// The derivative of equally spaced values by central differences of eighth order; the first and
/// last four have none.
pub(crate) fn differences(values: &[f64], step: f64) -> Vec<Option<f64>> {
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let at = |i: usize| {
        (i >= 4 && i + 4 < values.len()).then(|| {
            let pairs = weights.iter().enumerate();
            let sum: f64 = pairs
                .map(|(k, w)| w * (values[i + k + 1] - values[i - k - 1]))
                .sum();
            sum / step
        })
    };
    (0..values.len()).map(at).collect()
}

/// The largest difference of a column from the derivative of another.
pub(crate) fn derivative_error(of: &[f64], derivative: &[f64], step: f64) -> f64 {
    let both = differences(of, step).into_iter().zip(derivative);
    let gaps = both.filter_map(|(d, v)| Some((d? - v).abs()));
    gaps.fold(0.0, f64::max)
}
