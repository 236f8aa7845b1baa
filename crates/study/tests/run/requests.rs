//! Columns that are not requested are neither written nor drawn, and the others are the same to the last bit.

use crate::table::{Table, WEIGHTS, analyse, case, file, scene};
use dwell_scene::PlaneScene;
use dwell_study::{Analysis, PictureFormat, Pictures, analyse_trajectory, no_progress};
use std::collections::BTreeMap;

/// The crank-rocker with these requests.
fn with_requests(requests: &str) -> PlaneScene {
    scene(&WEIGHTS.replace("[requests]", &format!("[requests]\n{requests}")))
}

/// By name, the lines of the extrema of a run.
fn extrema(scene: &PlaneScene, analysis: Analysis) -> BTreeMap<String, String> {
    let result = analyse(scene, analysis, 181);
    let text = file(&result, &format!("-{}-extrema.csv", analysis.name()));
    let name = |line: &str| (line.split(',').next().unwrap().to_owned(), line.to_owned());
    text.lines().skip(1).map(name).collect()
}

const WITH_FORCES: [Analysis; 2] = [Analysis::Statics, Analysis::Kinetostatics];

#[test]
fn listed_reactions_are_all_that_is_written_beside_the_actuator() {
    let few = with_requests("reactions = [\"A\", \"C.x\"]\npaths = [\"coupler.C\"]\n");
    let all = with_requests("paths = [\"coupler.C\"]\n");
    for analysis in WITH_FORCES {
        let table = |scene: &PlaneScene| {
            let result = analyse(scene, analysis, 181);
            Table::parse(&file(&result, &format!("-{}.csv", analysis.name())))
        };
        let [few, all] = [&few, &all].map(table);
        let forces = [
            "A.x",
            "A.y",
            "A.x@crank",
            "A.y@crank",
            "A.magnitude",
            "A.direction",
            "C.x",
        ];
        let is_kinematic = |name: &String| {
            *name == "t" || name.starts_with("phi") || name.starts_with("coupler.C.")
        };
        let (rest, of_forces): (Vec<&String>, Vec<&String>) =
            few.names.iter().partition(|name| is_kinematic(name));
        assert_eq!(of_forces, forces, "{analysis:?}");
        assert!(rest.iter().any(|name| *name == "phi.actuator_force"));
        for name in &few.names {
            let bits = |table: &Table| -> Vec<u64> {
                table.column(name).into_iter().map(f64::to_bits).collect()
            };
            assert_eq!(bits(&few), bits(&all), "{analysis:?} {name}");
        }
        assert!(all.names.len() > 3 * few.names.len());
    }
    // Kinematics has no reactions to list.
    let table =
        |scene: &PlaneScene| file(&analyse(scene, Analysis::Kinematics, 61), "-kinematics.csv");
    assert_eq!(table(&few), table(&all));
}

/// Alone, a reaction that is zero but for rounding has nothing beside it that is not.
#[test]
fn the_peaks_of_what_is_requested_do_not_depend_on_what_else_is() {
    let (mut zeros, mut compared) = (0, 0);
    for name in [
        "slider-crank",
        "scotch-yoke",
        "peaucellier",
        "jansen",
        "rack-pinion",
    ] {
        let all = case(name);
        for analysis in WITH_FORCES {
            let full = extrema(&all, analysis);
            for reaction in all.mechanism.reactions().into_iter().take(6) {
                let mut one = all.clone();
                one.requests.lists_reactions = true;
                one.requests.reactions = vec![reaction];
                let found = extrema(&one, analysis);
                assert!(found.len() < full.len());
                for (quantity, line) in found {
                    assert_eq!(Some(&line), full.get(&quantity), "{name} {analysis:?}");
                    zeros += usize::from(line.contains(",0.0,"));
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 100 && zeros > 0, "{zeros} of {compared}");
}

#[test]
fn no_picture_shows_what_is_not_requested() {
    let drawn = |requests: &str| {
        let scene = with_requests(requests);
        let result =
            analyse_trajectory(&scene, Analysis::Kinetostatics, Some(41), &no_progress).unwrap();
        let drawn = result
            .outcome
            .draw((Pictures::All, PictureFormat::Png), &no_progress)
            .unwrap();
        let paths = drawn
            .files
            .iter()
            .map(|(path, _)| path.display().to_string());
        let pictures = paths.filter(|path| path.ends_with(".png"));
        let name = |path: String| {
            path.trim_end_matches(".png")
                .replace("test-kinetostatics-", "")
        };
        pictures.map(name).collect::<Vec<_>>()
    };
    let few = drawn("reactions = [\"A\"]\npaths = [\"coupler.C\"]\n");
    let expected = [
        "actuator-forces",
        "internal-forces-coupler.B.C",
        "mechanism",
        "path-coupler.C",
        "reactions",
    ];
    assert_eq!(few, expected);
    let few = drawn("variables = [\"crank.angular_velocity\"]\npaths = [\"coupler.C\"]\n");
    let expected = [
        "angles",
        "internal-forces-coupler.B.C",
        "mechanism",
        "path-coupler.C",
    ];
    assert_eq!(few, expected);
    let all = drawn("");
    for name in ["angles", "power-balance", "shaking-force"] {
        assert!(
            all.iter().any(|picture| picture == name),
            "{name} of {all:?}"
        );
    }
}

#[test]
fn a_large_table_of_everything_says_how_to_ask_for_less() {
    let note = |requests: &str, points: usize| {
        let summary = analyse(&with_requests(requests), Analysis::Kinetostatics, points)
            .outcome
            .summary;
        summary
            .matches("`reactions` or `variables` in [requests]")
            .count()
    };
    assert_eq!(note("", 1001), 1);
    assert_eq!(note("", 61), 0, "it is no matter");
    assert_eq!(note("reactions = [\"A\"]\n", 1001), 0);
    assert_eq!(note("variables = [\"A\"]\n", 1001), 0);
}
