//! The separating forces of teeth, in tables, in the reduced model and in the text of `check`.

use crate::table::{Table, analyse, case, file, largest, scene};
use dwell_study::{Analysis, check, reduce};
use std::path::Path;

/// A validation case with a pressure angle of 20° at the teeth described so.
fn with_angle(name: &str, teeth: &str) -> dwell_scene::PlaneScene {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let text = std::fs::read_to_string(home.join(name).join("scene.toml")).unwrap();
    assert_eq!(text.matches(teeth).count(), 1);
    scene(&text.replace(
        teeth,
        &format!("{teeth}, pressure-angle = 0.3490658503988659"),
    ))
}

fn table(of: &dwell_scene::PlaneScene, analysis: Analysis) -> Table {
    let end = match analysis {
        Analysis::Statics => "-statics.csv",
        _ => "-kinetostatics.csv",
    };
    Table::parse(&file(&analyse(of, analysis, 181), end))
}

/// Its column stands beside the tooth force; only the bearings' columns change.
#[test]
fn the_separating_force_has_a_column_beside_the_tooth_force() {
    let rack = "radius = 20";
    for analysis in [Analysis::Statics, Analysis::Kinetostatics] {
        let with = table(&with_angle("rack-pinion", rack), analysis);
        let without = table(&case("rack-pinion"), analysis);
        let place = with.names.iter().position(|n| n == "mesh.tooth").unwrap();
        assert_eq!(with.names[place + 1], "mesh.separating");
        let mut names = with.names.clone();
        names.remove(place + 1);
        assert_eq!(names, without.names);
        let [tooth, force] = ["mesh.tooth", "mesh.separating"].map(|name| with.column(name));
        let tangent = 20.0_f64.to_radians().tan();
        assert!(largest(&force) > 1.0);
        for (tooth, force) in tooth.iter().zip(&force) {
            // Rounding of forces of some hundred newtons.
            assert!((force - tooth.abs() * tangent).abs() <= 1e-12);
        }
        for name in &without.names {
            let [a, b] = [&with, &without].map(|table| table.column(name));
            let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
            let carries = [
                "C.y",
                "C.magnitude",
                "C.direction",
                "guide.normal",
                "guide.moment",
            ];
            let turned = name.starts_with("C.") && name.contains('@');
            let may_change = turned
                || carries.contains(&name.as_str())
                || name.starts_with("guide.")
                || name.starts_with("power.");
            if !may_change {
                // Rounding of forces of some hundred newtons.
                assert!(
                    largest(&difference) < 1e-12 * largest(&b).max(100.0),
                    "{name}"
                );
            }
        }
        let moved: Vec<f64> = with
            .column("C.y")
            .iter()
            .zip(without.column("C.y"))
            .map(|(a, b)| a - b)
            .collect();
        // The rack lies below the pinion and pushes it up; the ground holds it down.
        for (moved, force) in moved.iter().zip(&force) {
            assert!((moved + force).abs() < 1e-11, "{moved} {force}");
        }
        // What the two bodies do to the ground adds up to nothing.
        let [with, without] = [&with, &without].map(|table| table.column("shaking.fy"));
        assert!(
            with.iter()
                .zip(&without)
                .all(|(a, b)| (a - b).abs() < 1e-11)
        );
    }
}

#[test]
fn check_says_which_teeth_have_a_separating_force() {
    let summary = |scene: &dwell_scene::PlaneScene| check(scene).unwrap().summary;
    let none = summary(&case("planetary"));
    let expected =
        "  no separating force is modelled, as no `pressure-angle` is given: inner, outer\n";
    assert!(none.contains(expected), "{none}");
    let one = summary(&with_angle("planetary", "radii = [30, 20]"));
    assert!(
        one.contains("  separating forces: inner (pressure angle 20°)\n"),
        "{one}"
    );
    assert!(one.contains("is given: outer\n"), "{one}");
    assert!(!summary(&case("crank-rocker")).contains("separating"));
}

/// a and b are without it; its response to one newton is a column of its own, and it has no w.
#[test]
fn the_reduced_model_has_its_unit_response() {
    let with = with_angle("planetary", "radii = [30, 20]");
    let outcome = reduce(&with, None, None).unwrap();
    let line = "  a and b are without the separating forces inner.separating: each is |tooth force| × tan(pressure angle) at one state, and adds c times itself to a reaction\n";
    assert!(outcome.summary.contains(line), "{}", outcome.summary);
    let csv = |outcome: &dwell_study::Outcome| {
        let mut files = outcome.files.iter();
        let (_, bytes) = files
            .find(|(path, _)| path.to_str().unwrap().ends_with("-reduced.csv"))
            .unwrap();
        Table::parse(std::str::from_utf8(bytes).unwrap())
    };
    let without = csv(&reduce(&case("planetary"), None, None).unwrap());
    let with = csv(&outcome);
    for name in &without.names {
        assert_eq!(with.column(name), without.column(name), "{name}");
    }
    let added: Vec<_> = with.names.iter().filter(|n| !without.has(n)).collect();
    assert!(
        added.iter().all(|n| n.ends_with(".c.inner.separating")),
        "{added:?}"
    );
    // The sun is pushed inwards, from the planet to the centre, and its bearing holds it.
    let [x, y] = ["x", "y"].map(|axis| with.column(&format!("O.{axis}.c.inner.separating")));
    let q = with.column(&with.names[0]);
    for ((x, y), q) in x.iter().zip(&y).zip(&q) {
        let arm = 0.3 * q;
        assert!(
            (x - arm.cos()).abs() < 1e-12 && (y - arm.sin()).abs() < 1e-12,
            "{q}: {x} {y}"
        );
    }
}
