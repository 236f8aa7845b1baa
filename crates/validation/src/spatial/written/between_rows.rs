//! Along the rows of a file: prescribed coordinates with their law, and free ones with the integrals of their speeds.

use super::finding;
use super::scenes::{ROWS, Scenes, sinusoid};
use crate::written::motions::{simpson, summary_of_rows};
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::{Rows, largest};
use dwell_findings::{Check, Finding};
use dwell_scene::SpaceScene;
use dwell_verify::FindingSpec;
use serde_json::Value;

const LAWS: FindingSpec<'_> = FindingSpec {
    key: "written-kinetostatics-laws",
    check: Check::WrittenLaws,
    comparison: "prescribed coordinates, speeds and accelerations with sinusoids from the assembly",
    scale: "the amplitude, times the angular frequency for each derivative",
    // The largest seen in a case is 0.
    tolerance: 1e-15,
    tolerance_reason: "rounding of the law",
};
const AGAIN: FindingSpec<'_> = FindingSpec {
    key: "written-motion-again",
    check: Check::WrittenTwice,
    comparison: "coordinates and speeds by the default method and to an accuracy of 1e-8",
    scale: "the largest coordinate, or the largest speed",
    // The largest seen in a case is 6.2e-9.
    tolerance: 5e-7,
    tolerance_reason: "the errors of both motions",
};
const SUMMARY: FindingSpec<'_> = FindingSpec {
    key: "written-motion-summary",
    check: Check::WrittenTotals,
    comparison: "energies and events of the summary of `simulate` with rows and events",
    scale: "the largest energy, or the time",
    // The largest seen in a case is 4.8e-10.
    tolerance: 4e-8,
    tolerance_reason: "the tolerance of the integration",
};
const DEFAULT_ROWS: FindingSpec<'_> = FindingSpec {
    key: "written-motion-rows",
    check: Check::WrittenPositions,
    comparison: "the number of rows without an interval with 1001, and their end with that of other rows",
    scale: "the number, or the end",
    // The largest seen in a case is 0.
    tolerance: 1e-14,
    tolerance_reason: "rounding of times",
};
const STOPS: FindingSpec<'_> = FindingSpec {
    key: "written-motion-stops",
    check: Check::WrittenPositions,
    comparison: "coordinates with the ends that their stops of no compliance allow",
    scale: "one radian or metre",
    // The largest seen in a case is 0.
    tolerance: 1e-14,
    tolerance_reason: "an impact is located to the tolerance of the integration",
};
const SPEEDS: FindingSpec<'_> = FindingSpec {
    key: "written-motion-speeds",
    check: Check::WrittenRates,
    comparison: "what coordinates and speeds change by between rows with the integrals of speeds and accelerations, by Simpson's rule",
    scale: "the largest coordinate, or the largest speed",
    // The largest seen in a case is 4.5e-10.
    tolerance: 4e-8,
    tolerance_reason: "the tolerance of the integration, and what the rule's estimated error leaves",
};

/// Prescribed coordinates with their sinusoids.
pub(super) fn laws(scenes: &Scenes, scene: &SpaceScene, rows: &Rows) -> Option<Finding> {
    let mut worst = Differences::default();
    for (k, amplitude) in scenes.amplitudes.as_ref()?.iter().enumerate() {
        let actuator = &scene.mechanism.actuators[k].name;
        let start = scene.assembly.q[k];
        for row in 0..rows.count {
            let mut wanted = sinusoid(*amplitude, rows.time(row));
            wanted[0] += start;
            let largest = sinusoid(*amplitude, 0.0)[1].abs() / amplitude.abs();
            let scales = [
                amplitude.abs().max(start.abs()),
                amplitude.abs() * largest,
                amplitude.abs() * largest * largest,
            ];
            for ((end, wanted), scale) in ["", ".velocity", ".acceleration"]
                .into_iter()
                .zip(wanted)
                .zip(scales)
            {
                let name = format!("{actuator}{end}");
                let found = rows.get(row, &name).unwrap_or(f64::NAN);
                worst.compare([found, wanted, scale], "", || format!("row {row}, {name}"));
            }
        }
    }
    finding(worst, &LAWS, rows, "kinetostatics")
}

/// Free coordinates and their speeds with the integrals of speeds and accelerations.
pub(super) fn motion(scene: &SpaceScene, rows: &Rows) -> Option<Finding> {
    let mut found = Differences::default();
    let Some(times) = rows.columns.get("t") else {
        found.fail("the file has no time");
        return found.counted_finding(&SPEEDS, "motion");
    };
    let actuators = &scene.mechanism.actuators;
    let column = |k: usize, end: &str| rows.columns.get(&format!("{}{end}", actuators[k].name));
    let largest = |end: &str| {
        let all = (0..actuators.len()).filter_map(|k| column(k, end));
        largest(all.flatten())
    };
    for (k, actuator) in actuators.iter().enumerate() {
        for [of, rate] in [["", ".velocity"], [".velocity", ".acceleration"]] {
            let name = format!("{}{of}", actuator.name);
            match (column(k, of), column(k, rate)) {
                (Some(values), Some(rates)) => {
                    simpson(&mut found, times, [values, rates], largest(of), &name);
                }
                _ => found.fail(format!("no column {name}, or none of its rate")),
            }
        }
    }
    found.counted_finding(&SPEEDS, "motion")
}

/// The same motion in two files.
pub(super) fn again(scene: &SpaceScene, both: [&Rows; 2]) -> Option<Finding> {
    let mut found = Differences::default();
    let ends = ["", ".velocity"];
    let all = both.map(|rows| {
        ends.map(|end| {
            let actuators = scene.mechanism.actuators.iter();
            let columns = actuators.filter_map(|a| rows.columns.get(&format!("{}{end}", a.name)));
            columns.flatten().copied().collect::<Vec<f64>>()
        })
    });
    for (k, end) in ends.into_iter().enumerate() {
        let [one, other] = [&all[0][k], &all[1][k]];
        if one.len() != other.len() {
            found.fail(format!("{} and {} numbers", one.len(), other.len()));
            continue;
        }
        let differences = one.iter().zip(other).map(|(a, b)| a - b);
        found.add_rows(differences, largest(one), "", |i| {
            format!("number {i} of coordinates{end}")
        });
    }
    found.counted_finding(&AGAIN, "motion")
}

/// No row is beyond a rigid stop.
pub(super) fn stops(scene: &SpaceScene, both: [&Rows; 2]) -> Option<Finding> {
    let mut found = Differences::default();
    for stop in scene.stops.iter().filter(|stop| stop.yielding.is_none()) {
        let coordinate = &scene.mechanism.actuators[stop.actuator.0].name;
        for rows in both {
            let beyond = rows.column(coordinate).iter().map(|value| {
                let above = stop.max.map_or(0.0, |max| value - max);
                let below = stop.min.map_or(0.0, |min| min - value);
                above.max(below).max(0.0)
            });
            found.add_rows(beyond, 1.0, "", |row| format!("row {row}, {coordinate}"));
        }
    }
    found.counted_finding(&STOPS, "motion")
}

/// The summary of a motion with its rows and events.
pub(super) fn summary(summary: &Value, rows: &Rows, events: Option<&Rows>) -> Option<Finding> {
    summary_of_rows(summary, rows, events).counted_finding(&SUMMARY, "simulate")
}

/// Rows without an interval of their own: a thousand equal ones, to the same end.
pub(super) fn default_rows(all: &Rows, others: &Rows) -> Option<Finding> {
    let mut found = Differences::default();
    // A motion that ends early has fewer, and one that strikes a stop has those of its impacts besides.
    if others.count == ROWS + 1 {
        let count = all.count as f64;
        found.add(count - 1001.0, 1001.0, "", || "the number of rows");
    }
    let end = |rows: &Rows| rows.end();
    found.add(end(all) - end(others), end(others), "s", || "the end");
    found.counted_finding(&DEFAULT_ROWS, "simulate")
}
