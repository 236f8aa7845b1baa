//! The forms of the extremes detect their faults, and narrow peaks are not lost in exports.

#![allow(clippy::expect_used, reason = "a test")]

use dwell_export::{Precision, Request};
use dwell_findings::Finding;
use dwell_scene::PlaneScene;
use dwell_study::{ExportRequest, compute_export};
use dwell_validation::extremes::forms::{Evaluated, Form, check, series};
use dwell_validation::extremes::{ResultCell, SeriesResult, evaluate};
use std::sync::LazyLock;

/// Series that take little time.
const QUICK: [&str; 4] = [
    "limit-four-bar",
    "flat-parallelogram",
    "mass-ratio",
    "speed",
];

fn quick(form: Form) -> Vec<dwell_validation::extremes::ParameterSeries> {
    let mut all = series(form);
    all.retain(|series| QUICK.contains(&series.key.as_str()));
    all
}

static CELLS: LazyLock<Vec<(Form, Vec<Vec<ResultCell>>)>> = LazyLock::new(|| {
    let cells = |form| evaluate(quick(form)).into_iter().map(|series| series.cells);
    let forms = Form::OTHERS.into_iter();
    forms.map(|form| (form, cells(form).collect())).collect()
});

/// The keys of the findings that fail when the cells of a form are changed.
fn failing(chosen: impl Fn(Form) -> bool, change: impl Fn(&mut ResultCell)) -> Vec<String> {
    let of_form = |(form, cells): &(Form, Vec<Vec<ResultCell>>)| {
        let results = quick(*form).into_iter().zip(cells.clone());
        let mut results: Vec<SeriesResult> = results
            .map(|(series, cells)| SeriesResult { series, cells })
            .collect();
        let changed = results.iter_mut().flat_map(|series| &mut series.cells);
        changed.for_each(&change);
        (*form, results)
    };
    let chosen = CELLS.iter().filter(|(form, _)| chosen(*form));
    let findings: Vec<Finding> = check(&chosen.map(of_form).collect::<Vec<_>>());
    let failing = findings.into_iter().filter(|finding| !finding.pass);
    failing
        .map(|finding| format!("{} ({})", finding.key, finding.worst_at))
        .collect()
}

#[test]
fn every_form_keeps_its_floors_and_states_its_errors() {
    assert_eq!(failing(|_| true, |_| ()), Vec::<String>::new());
}

/// Seven digits where sixteen are promised.
#[test]
fn a_form_that_computes_in_shorter_numbers_is_seen() {
    let double = |form: Form| {
        form.precision == Precision::Double
            && matches!(
                form.evaluated,
                Evaluated::Space | Evaluated::Loops | Evaluated::Operations
            )
    };
    let failing = failing(double, |cell| {
        if let Ok(value) = &mut cell.result {
            value.value = f64::from(value.value as f32 * (1.0 + f32::EPSILON));
        }
    });
    for key in [
        "space-digits",
        "space-loops-digits",
        "exported-operations-digits",
        "space-error-estimate",
    ] {
        assert!(
            failing.iter().any(|found| found.starts_with(key)),
            "{key}: {failing:?}"
        );
    }
}

/// A factor in one quantity: a unit, a sign, another branch.
#[test]
fn a_wrong_quantity_is_seen_in_every_form() {
    let failing = failing(
        |_| true,
        |cell| {
            if let (0, Ok(value)) = (cell.quantity, &mut cell.result) {
                value.value *= 1.5;
            }
        },
    );
    for form in Form::OTHERS {
        let key = form.name().replace(", ", "-").replace(' ', "-");
        for what in ["digits", "error-estimate"] {
            let key = format!("{key}-{what} (");
            assert!(
                failing.iter().any(|found| found.starts_with(&key)),
                "{key}: {failing:?}"
            );
        }
    }
}

#[test]
fn a_refusal_without_need_and_what_is_no_number_are_seen_in_every_form() {
    let refused = failing(|_| true, |cell| cell.result = Err("too hard".to_owned()));
    let no_number = failing(
        |_| true,
        |cell| {
            if let Ok(value) = &mut cell.result {
                value.value = f64::NAN;
            }
        },
    );
    for failing in [refused, no_number] {
        let digits = failing.iter().filter(|found| found.contains("-digits ("));
        assert_eq!(digits.count(), Form::OTHERS.len(), "{failing:?}");
    }
}

/// A follower that rises by 20 mm within some angle of the cam.
fn cam(angle: f64) -> PlaneScene {
    let text = format!(
        "[bodies]\nground = {{ points = {{ O = [0, 0] }} }}\n\
         cam = {{ points = {{ O = [0, 0] }}, mass = 1.5, center = \"O\", inertia = 0.001 }}\n\
         follower = {{ points = {{ F = [0, 0] }}, mass = 0.4, center = \"F\" }}\n\
         [joints]\nO = {{ revolute = [\"ground.O\", \"cam.O\"] }}\n\
         guide = {{ prismatic = [\"ground.O\", \"follower.F\"], axis = [0, 1] }}\n\
         contact = {{ coupling = [\"rise\", \"phi\"], expression = \"0.01*tanh((x - 1.7)/{angle})\" }}\n\
         [coordinates]\nrise = {{ travel = \"guide\" }}\n\
         [actuators]\nphi = {{ angle = [\"ground\", \"cam\"] }}\n[assembly]\nphi = 0\nfollower = 0\n"
    );
    PlaneScene::parse("cam.toml", &text).expect("a scene")
}

/// Before, a single cell without any rise was written, 1.9 times the largest value off, or 1.3e8 times.
#[test]
fn a_steep_cam_is_exported_with_its_peak_or_refused() {
    let asked = ExportRequest {
        request: Request {
            accuracy: 1e-9,
            precision: Precision::Double,
        },
        exact: false,
        interval: None,
    };
    for angle in [1e-1, 1e-2] {
        let export = compute_export(&cam(angle), &asked).expect("an export");
        assert!(export.measured.errors.max() <= 1e-9, "{angle}");
        let at_peak = export
            .evaluator::<f64>()
            .motion_terms(1.7)
            .expect("inside")
            .m;
        let exact = 0.001 + 0.4 * (0.01 / angle).powi(2);
        assert!(
            (at_peak / exact - 1.0).abs() < 1e-8,
            "{angle}: {at_peak}, {exact}"
        );
    }
    for angle in [1e-3, 1e-4] {
        let refused = compute_export(&cam(angle), &asked)
            .expect_err("too narrow")
            .to_string();
        assert!(refused.starts_with("no export"), "{refused}");
    }
}
