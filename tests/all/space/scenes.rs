//! The scenes of the references, as a user has them reduced.

use super::ONE_COORDINATE;
use super::reference::{Reference, number};
use dwell_kinetostatics::Magnitude;
use dwell_scene::SpaceScene;
use dwell_study::PreparedSpaceScene;
use dwell_study::reduce::compute::ReducedScene;
use std::collections::BTreeSet;

/// The scenes of `validation/spatial`, as a user has them reduced: coefficients, unit-load responses and names of what is open.
#[test]
fn scenes_agree_with_the_references() {
    for name in ONE_COORDINATE {
        let reference = Reference::read(name);
        let path = format!(
            "{}/../validation/spatial/{name}.toml",
            env!("CARGO_MANIFEST_DIR")
        );
        let scene = SpaceScene::read(path).unwrap_or_else(|e| panic!("{name}: {e}"));
        let prepared = PreparedSpaceScene::new(&scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let samples = reference.samples();
        let q: Vec<f64> = samples.iter().map(|s| number(&s["q"])).collect();
        let coefficients = prepared.coefficients(&q).expect("poses");
        let names = prepared.reaction_units();
        let loads = prepared.unit_loads(&q).expect("poses");
        let columns = loads.map_or_else(Vec::new, |loads| loads.columns(&prepared));
        // In the references a unit of gravity is the whole of it.
        let gravity = scene
            .loads
            .first()
            .map_or(0.0, |load| match load.magnitude {
                Magnitude::Constant(value) => value,
                ref other => panic!("{other:?}"),
            });
        let column = |name: &str| columns.iter().find(|(c, _)| c.name == name).map(|(_, v)| v);
        let largest = |part: &str| {
            let all = samples
                .iter()
                .flat_map(|s| s["reactions"].as_object().expect("reactions").values());
            let of = all.map(|r| {
                if part == "c" {
                    &r["c"]["gravity"]
                } else {
                    &r[part]
                }
            });
            of.filter(|v| !v.is_null())
                .map(|v| number(v).abs())
                .fold(0.0, f64::max)
        };
        let scales = ["a", "b", "c"].map(largest);
        let mut compared = 0;
        for (i, (sample, at)) in samples.iter().zip(&coefficients).enumerate() {
            let m = number(&sample["m"]);
            assert!((at.m / m - 1.0).abs() < 1e-13, "{name}: m");
            assert!(
                (at.half_dm - number(&sample["half_dm"])).abs() < 1e-13 * m,
                "{name}: ½m′"
            );
            if let Some(w) = column("weight.w") {
                let wanted = number(&sample["w"]["gravity"]);
                assert!(
                    (gravity * w[i] - wanted).abs() < 1e-12 * reference.scale_of("w"),
                    "{name}: w"
                );
            }
            for (k, (column_name, _)) in names.iter().enumerate() {
                let wanted = &sample["reactions"][reference_name(column_name)];
                let c = column(&format!("{column_name}.c.weight")).map_or(0.0, |c| gravity * c[i]);
                let found = [at.a[k], at.b[k], c];
                let wanted = [&wanted["a"], &wanted["b"], &wanted["c"]["gravity"]];
                for j in 0..3 {
                    // What the joint cannot transmit at this pose is not in the reference: it is zero.
                    let wanted = if wanted[j].is_null() {
                        0.0
                    } else {
                        number(wanted[j])
                    };
                    let differ = (found[j] - wanted).abs() / scales[j].max(f64::MIN_POSITIVE);
                    assert!(
                        found[j] == wanted || differ < 1e-12,
                        "{name}: {column_name} {j}: {} for {wanted}",
                        found[j]
                    );
                    compared += 1;
                }
            }
        }
        let open = samples
            .iter()
            .flat_map(|s| s["undetermined"].as_array().expect("a list"));
        let open: BTreeSet<_> = open
            .map(|name| name.as_str().expect("a name").to_owned())
            .collect();
        let found = prepared.indeterminate.iter();
        let found: BTreeSet<_> = found
            .map(|&r| reference_name(&scene.reaction_name(r)))
            .collect();
        assert_eq!(found, open, "{name}");
        println!("{name}: {compared} values");
    }
}

/// The reference's name of a component: `P0.Mx` of `P0.moment-x`.
fn reference_name(column: &str) -> String {
    let (joint, component) = column.split_once('.').expect("a component");
    let axis = &component[component.len() - 1..];
    let letter = if component.starts_with("moment") {
        "M"
    } else {
        "F"
    };
    format!("{joint}.{letter}{axis}")
}
