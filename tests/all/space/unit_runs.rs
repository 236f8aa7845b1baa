//! The two kinetostatic runs of the paper in space: what their rows give together is the reduced model.

use dwell_scene::SpaceScene;
use dwell_study::no_progress;
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_study::unit_runs::compute::compute_unit_runs;

#[test]
fn both_runs_give_the_reduced_model() {
    // A small couple of the RSUR stands in run ii beside a large one of q̇²; the range of the Bricard linkage ends at dead points.
    let cases = [
        ("rssr", 1e-12),
        ("slider-crank-haug", 1e-12),
        ("double-hooke", 1e-12),
        ("rsur", 1e-11),
        ("bricard-a04", 1e-9),
    ];
    for (name, largest) in cases {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../validation/spatial");
        let scene = SpaceScene::read(format!("{folder}/{name}.toml")).expect("a scene");
        let runs = compute_unit_runs(&scene, Some(73), &no_progress);
        let runs = runs.unwrap_or_else(|e| panic!("{name}: {e}"));
        // Run ii passes the positions of run i at √(2 q): its last row is later or earlier, never at the same time.
        let [one, two] = runs.runs.each_ref().map(|table| &table.rows[72]);
        assert!(
            (two[0] * two[0] / 2.0 - one[0]).abs() < 1e-12 * one[0],
            "{name}"
        );
        let comparison = runs.comparison();
        assert_eq!(
            comparison.len(),
            2 + 2 * runs.prepared.reaction_units().len()
        );
        for of in comparison {
            assert!(
                of.relative_difference <= of.tolerance.min(largest),
                "{name}: {} differs by {:.1e}, {:.1e} allowed",
                of.symbol,
                of.relative_difference,
                of.tolerance
            );
        }
    }
}
