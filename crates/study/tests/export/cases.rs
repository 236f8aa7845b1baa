//! Every planar case of one freedom exports and passes its self-test, or says why it cannot.

use super::toolchain::{Scratch, c_compiler, cases, compile, request, run};
use dwell_export::{Precision, c_files};
use dwell_scene::Scene;
use dwell_study::compute_export;

/// The cases that cannot be exported as they are, with words of the reason.
const REFUSED: [(&str, &str); 0] = [];

#[test]
fn every_case_exports_or_says_why_not() {
    let compiler = c_compiler();
    let mut names: Vec<String> = std::fs::read_dir(cases())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| cases().join(name).join("scene.toml").exists())
        .collect();
    names.sort();
    let mut exported = 0;
    for name in &names {
        let text = std::fs::read_to_string(cases().join(name).join("scene.toml")).unwrap();
        let scene = Scene::parse(&format!("{name}.toml"), &text).unwrap();
        let refused = REFUSED.iter().find(|(refused, _)| refused == name);
        let export = match (
            compute_export(&scene, &request(1e-7, Precision::Double)),
            refused,
        ) {
            (Ok(export), None) => export,
            (Ok(_), Some((_, reason))) => panic!("{name} exports, though {reason}"),
            (Err(error), Some((_, reason))) => {
                assert!(error.to_string().contains(reason), "{name}: {error}");
                continue;
            }
            (Err(error), None) => {
                eprintln!("NOT EXPORTED {name}: {error}");
                continue;
            }
        };
        exported += 1;
        let errors = export.measured.errors;
        assert!(errors.max() <= 1e-7, "{name}: {errors:?}");
        let Some(compiler) = compiler else { continue };
        let scratch = Scratch::new();
        let files = c_files(&export);
        scratch.write(&files);
        let define = format!(
            "-D{}_SELF_TEST",
            files[0].0.trim_end_matches(".h").to_uppercase()
        );
        compile(
            &scratch.0,
            compiler,
            &[&define, &files[1].0, "-o", "program"],
        );
        run(&scratch.0, "./program", &[]);
    }
    assert!(exported >= 10, "{exported}");
}
