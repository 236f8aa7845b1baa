//! Closed forms of mechanisms made of dyads, held against the numbers; and what is printed of them,
//! compiled and run.

use dwell_kinetostatics::ReducedModel;
use dwell_scene::PlaneScene;
use dwell_study::{FormulaFormat, Language, StudyError, symbolic, symbolic_findings};
use dwell_symbolic::{ClosedForm, Symbolic};
use dwell_tests::cases::CASES;
use dwell_tests::fixtures::{case_names, model, repository_root, scene};
use dwell_verify::spread;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The cases of one actuator that are made of dyads.
const DYADS: [&str; 20] = [
    "andrews",
    "crank-rocker",
    "double-slider",
    "ellipse-trammel",
    "four-bar",
    "jansen",
    "massless-coupler",
    "n-four-bar-a02",
    "peaucellier",
    "pendulum-a01",
    "press",
    "rack-pinion",
    "rolling-wheel",
    "scotch-yoke",
    "single-dwell",
    "slider-crank",
    "slider-crank-friction",
    "slotted-rocker",
    "watt-six-bar",
    "whitworth",
];

/// Their m, ½m′ and every a and b agree to 1e-12 of the largest: thousands of roundings.
#[test]
fn every_reaction_of_every_dyad_case_agrees() {
    let mut found = Vec::new();
    for name in case_names() {
        if check_scene(&scene(&name)) {
            found.push(name);
        }
    }
    found.sort_unstable();
    assert_eq!(found, DYADS);
}

/// Slides in the tree, skew axes, a driven slot.
#[test]
fn prismatic_joints_agree() {
    for case in CASES {
        let is_dyads = check_scene(&case.scene());
        assert_eq!(is_dyads, case.largest <= 2, "{}", case.name);
    }
}

/// Holds a scene to 1e-12; whether it has closed forms.
fn check_scene(scene: &PlaneScene) -> bool {
    let findings = symbolic_findings(scene).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    for f in &findings {
        // Next to its change points a chain of parallelograms is not better known than this.
        let tolerance = if scene.name.starts_with("n-four-bar") {
            1e-10
        } else {
            1e-12
        };
        assert!(
            f.pass && f.relative_difference <= tolerance,
            "{}: {f:?}",
            scene.name
        );
    }
    !findings.is_empty()
}

/// A mass that is off by a millionth shows in m, and a joint's a and b are not another's.
#[test]
fn what_is_wrong_is_seen() {
    let scene = scene("four-bar");
    let exact = model(&scene);
    let plan = exact.model().plan();
    let mut masses = scene.masses.clone();
    masses[2].mass *= 1.0 + 1e-6;
    let reactions = scene.mechanism.reactions();
    let q = 0.7;
    let mut out = exact.model().coefficient_buffer();
    exact
        .coefficients(q, &mut exact.workspace(), &mut out)
        .expect("a pose");
    let last = |masses: &[_], k: usize| {
        let symbolic = Symbolic::new(&scene.mechanism, masses, plan).expect("dyads");
        let values = symbolic
            .closed_form(Some(reactions[k]))
            .expect("a")
            .evaluate(q);
        values[values.len() - 4..].to_vec()
    };
    let right = last(&scene.masses, 0);
    let wrong = last(&masses, 0);
    assert!((right[0] / out.m - 1.0).abs() < 1e-14);
    assert!((wrong[0] / out.m - 1.0).abs() > 1e-8);
    assert!((wrong[1] - out.half_dm).abs() > 1e-8 * out.m);
    assert!((last(&scene.masses, 1)[2] - out.a[0]).abs() > 1e-3 * out.a[0].abs());
    assert!((last(&scene.masses, 1)[3] - out.b[0]).abs() > 1e-3 * out.b[0].abs());
}

fn printed(name: &str) -> String {
    let outcome =
        symbolic(&scene(name), FormulaFormat::Latex, None).unwrap_or_else(|e| panic!("{e}"));
    let (path, bytes) = outcome.files.iter().next().expect("a file");
    assert_eq!(path, Path::new(&format!("{name}-symbolic.md")));
    String::from_utf8(bytes.to_vec()).expect("text")
}

/// The example in the handbook is what is printed.
#[test]
fn the_page_shows_what_is_printed() {
    let page = repository_root().join("docs").join("symbolic.md");
    let page = std::fs::read_to_string(page).expect("a page");
    let printed = printed("four-bar");
    let formulas = page.lines().filter(|line| line.contains("&="));
    for line in formulas.clone() {
        let line = line.trim_end_matches(" \\\\");
        assert!(printed.contains(line), "{line}");
    }
    assert!(formulas.count() > 20);
}

fn snapshot(name: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.bind(|| insta::assert_snapshot!(format!("symbolic-{name}"), printed(name)));
}

#[test]
fn the_four_bar_in_latex() {
    snapshot("four-bar");
}

#[test]
fn the_slider_crank_in_latex() {
    snapshot("slider-crank");
}

/// The same text each time: names and order do not hang on addresses.
#[test]
fn what_is_printed_is_repeatable() {
    for printed in [
        FormulaFormat::Latex,
        FormulaFormat::Code(Language::C),
        FormulaFormat::Code(Language::Rust),
    ] {
        let once = || symbolic(&scene("whitworth"), printed, Some("slot.normal")).expect("forms");
        assert_eq!(once().files, once().files);
    }
}

#[test]
fn what_has_no_closed_form_is_told_with_its_bodies() {
    for (name, text) in [
        ("class-three-six-bar", "they are no dyad"),
        ("stephenson-six-bar", "they are no dyad"),
        ("cam", "a coupling is given by a law"),
        ("parallelogram-three-cranks", "repeat each other"),
        ("planetary", "loops and couplings"),
        ("five-bar", "2 actuators"),
    ] {
        let scene = scene(name);
        let refused = symbolic(&scene, FormulaFormat::Latex, None);
        let Err(StudyError::Scene(error)) = refused else {
            panic!("{name}: {refused:?}");
        };
        assert!(error.message.contains(text), "{name}: {}", error.message);
        assert!(!error.labels.is_empty(), "{name}");
        assert!(error.help.is_some(), "{name}");
        assert_eq!(symbolic_findings(&scene).expect("none"), []);
    }
    let refused = symbolic(&scene("four-bar"), FormulaFormat::Latex, Some("A.z"));
    let Err(StudyError::Scene(error)) = refused else {
        panic!("{refused:?}");
    };
    assert!(
        error
            .help
            .as_deref()
            .is_some_and(|h| h.contains("A.x, A.y"))
    );
}

/// What is printed is compiled and run, where there is a tool for it.
#[test]
fn what_is_printed_computes_the_same() {
    let folder = std::env::temp_dir().join(format!("dwell-symbolic-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for name in ["four-bar", "ellipse-trammel", "rolling-wheel", "whitworth"] {
        let scene = scene(name);
        let exact = model(&scene);
        let symbolic = Symbolic::new(&scene.mechanism, &scene.masses, exact.model().plan());
        let reaction = *scene.mechanism.reactions().last().expect("a reaction");
        let form = symbolic
            .expect("dyads")
            .closed_form(Some(reaction))
            .expect("a form");
        let at = spread(exact.range(), 5);
        for language in [Language::Rust, Language::C, Language::Python] {
            let Some(rows) = run_generated_code(&folder, &form, language, &at) else {
                eprintln!("{language:?}: no tool here, nothing was run");
                continue;
            };
            assert_eq!(rows.len(), at.len());
            for (row, &q) in rows.iter().zip(&at) {
                let expected = form.evaluate(q);
                assert_eq!(row.len(), expected.len());
                let scale = expected.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
                for ((one, other), quantity) in row.iter().zip(&expected).zip(&form.quantities) {
                    // Shared parts round differently, and powers are by another library.
                    let difference = (one - other).abs();
                    assert!(
                        difference <= 1e-13 * scale,
                        "{name} {language:?} {}: {one} {other}",
                        quantity.code
                    );
                }
            }
        }
    }
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// The quantities at some coordinates, by a program of this language; none where there is no tool.
// Long: the generated program as text.
fn run_generated_code(
    folder: &Path,
    form: &ClosedForm,
    language: Language,
    at: &[f64],
) -> Option<Vec<Vec<f64>>> {
    let mut text = form.code(language, "reduced", "a test");
    let codes: Vec<&str> = form.quantities.iter().map(|q| q.code.as_str()).collect();
    let list: Vec<String> = at.iter().map(|q| format!("{q:?}")).collect();
    let list = list.join(", ");
    let program = folder.join("program");
    let source = |rest: &str| folder.join(format!("source.{rest}"));
    let compile = |tool: &str, source: &PathBuf, more: &[&str]| -> Option<()> {
        let done = Command::new(tool)
            .arg(source)
            .arg("-o")
            .arg(&program)
            .args(more)
            .output()
            .ok()?;
        let stderr = String::from_utf8_lossy(&done.stderr);
        assert!(
            done.status.success() && stderr.is_empty(),
            "{tool}: {stderr}"
        );
        Some(())
    };
    let mut run = match language {
        Language::Rust => {
            let each: Vec<String> = codes.iter().map(|c| format!("r.{c}")).collect();
            let _ = write!(
                text,
                "fn main() {{ for q in [{list}] {{ let r = reduced(q); println!(\"{{:?}}\", [{}]); }} }}",
                each.join(", ")
            );
            std::fs::write(source("rs"), text).expect("written");
            compile("rustc", &source("rs"), &["--edition=2024"])?;
            Command::new(&program)
        }
        Language::C => {
            let _ = write!(
                text,
                "#include <stdio.h>\nint main(void) {{ double at[] = {{{list}}}; \
                 for (int i = 0; i < {}; i++) {{ reduced_result r = reduced(at[i]); printf(\"[\");",
                at.len()
            );
            for (k, code) in codes.iter().enumerate() {
                let comma = if k == 0 { "" } else { ", " };
                let _ = write!(text, "printf(\"{comma}%.17g\", r.{code});");
            }
            text.push_str("printf(\"]\\n\"); } return 0; }\n");
            std::fs::write(source("c"), text).expect("written");
            compile("cc", &source("c"), &["-std=c99", "-Wall", "-Wextra", "-lm"])?;
            Command::new(&program)
        }
        Language::Python => {
            let _ = write!(
                text,
                "\n\nfor q in [{list}]:\n    print(list(reduced(q).values()))\n"
            );
            std::fs::write(source("py"), text).expect("written");
            let mut python = Command::new("python3");
            python.arg(source("py"));
            python
        }
    };
    let done = run.output().ok()?;
    let stderr = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{language:?}: {stderr}");
    let stderr = String::from_utf8(done.stdout).expect("text");
    let row = |line: &str| serde_json::from_str(line).expect("a list of numbers");
    Some(stderr.lines().map(row).collect())
}
