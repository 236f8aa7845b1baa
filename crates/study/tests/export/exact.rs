//! Exact exports: the model's own operations, compiled, held against the model.

use super::cases::REFUSED;
use super::toolchain::{Scratch, c_compiler, case, cases, compile, request, run};
use dwell_export::{Precision, c_files};
use dwell_numerics::OperationKind;
use dwell_scene::PlaneScene;
use dwell_study::{ExportRequest, compute_export};

/// The cases without operations that hold everywhere, with words of the reason.
const WITHOUT_OPERATIONS: [(&str, &str); 5] = [
    ("cam", "a law of a cam"),
    ("class-three-six-bar", "Newton's method"),
    ("exported-model", "a law of a cam"),
    ("parallelogram-three-cranks", "Newton's method"),
    ("stephenson-six-bar", "Newton's method"),
];

/// Of the largest value of each function: 1.2e-13 is measured.
const LARGEST_ERROR: f64 = 1e-12;
/// Next to the flat positions at both ends of this range, the rounding of a sine is enlarged: 3.9e-10.
const NEXT_TO_FLAT: (&str, f64) = ("n-four-bar-a02", 2e-9);

fn exact() -> ExportRequest {
    ExportRequest {
        exact: true,
        ..request(1e-9, Precision::Double)
    }
}

#[test]
fn every_case_has_its_operations_or_says_why_not() {
    let compiler = c_compiler();
    let names = std::fs::read_dir(cases()).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names
        .filter(|name| cases().join(name).join("scene.toml").exists())
        .filter(|name| REFUSED.iter().all(|(refused, _)| refused != name))
        .collect();
    names.sort();
    let mut wrong = Vec::new();
    for name in &names {
        let refused = WITHOUT_OPERATIONS
            .iter()
            .find(|(refused, _)| refused == name);
        let export = match (compute_export(&case(name), &exact()), refused) {
            (Ok(export), None) => export,
            (Ok(_), Some((_, reason))) => {
                wrong.push(format!("{name} has operations, though {reason}"));
                continue;
            }
            (Err(error), Some((_, reason))) if error.to_string().contains(reason) => continue,
            (Err(error), _) => {
                wrong.push(format!("{name}: {error}"));
                continue;
            }
        };
        let error = export.measured.errors.max();
        let allowed = if name == NEXT_TO_FLAT.0 {
            NEXT_TO_FLAT.1
        } else {
            LARGEST_ERROR
        };
        if error > allowed {
            wrong.push(format!("{name}: an error of {error:.1e}"));
        }
        let Some(compiler) = compiler else { continue };
        let scratch = Scratch::new();
        let files = c_files(&export);
        scratch.write(&files);
        let stem = files[0].0.trim_end_matches(".h").to_uppercase();
        let define = format!("-D{stem}_SELF_TEST");
        let arguments = [&define, &files[1].0, "-lm", "-o", "program"];
        compile(&scratch.0, compiler, &arguments);
        run(&scratch.0, "./program", &[]);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_single_dwell_takes_few_operations() {
    let export = compute_export(&case("single-dwell"), &exact()).unwrap();
    let code = export.code.unwrap();
    let counts = code.each_ref().map(|part| part.operations.len());
    // A trial by hand needed 246 with one pair of coefficients.
    assert!(counts[0] < 250 && counts[1] < 250, "{counts:?}");
    // An operation that is wrong is found.
    let mut wrong = code;
    let mut products = wrong[0].operations.iter_mut();
    let product = products.rfind(|operation| operation.kind == OperationKind::Multiply);
    product.unwrap().kind = OperationKind::Divide;
    let again = compute_export(&case("single-dwell"), &exact()).unwrap();
    let twin = dwell_export::Evaluator::<f64>::exact(&again.machine, &wrong, Precision::Double);
    let [found, right] = [&twin, &again.evaluator()].map(|e| e.motion_terms(1.0).unwrap());
    assert_ne!(found, right);
}

#[test]
fn single_precision_has_operations_too() {
    let Some(compiler) = c_compiler() else { return };
    let asked = ExportRequest {
        exact: true,
        ..request(1e-6, Precision::Float)
    };
    let export = compute_export(&case("single-dwell"), &asked).unwrap();
    assert!(
        export.measured.errors.max() < 1e-5,
        "{:?}",
        export.measured.errors
    );
    let scratch = Scratch::new();
    let files = c_files(&export);
    assert!(files[1].1.contains("sqrtf("));
    scratch.write(&files);
    let arguments = [
        "-DSINGLE_DWELL_SELF_TEST",
        &files[1].0,
        "-lm",
        "-o",
        "program",
    ];
    compile(&scratch.0, compiler, &arguments);
    run(&scratch.0, "./program", &[]);
}

#[test]
fn what_is_searched_has_no_operations() {
    let text = std::fs::read_to_string(cases().join("class-three-six-bar/scene.toml")).unwrap();
    let scene = PlaneScene::parse("class-three.toml", &text).unwrap();
    let error = compute_export(&scene, &exact()).unwrap_err().to_string();
    assert!(error.contains("no exact export"), "{error}");
    assert!(error.contains("Newton"), "{error}");
}
