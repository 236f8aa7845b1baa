//! Every planar case of one freedom exports and passes its self-test, or is rejected with a reason.

use super::toolchain::{Scratch, c_compiler, cases, compile, request, run};
use dwell_export::{Precision, c_files};
use dwell_scene::{PlaneScene, Scene};
use dwell_study::{ExportTarget, compute_export, export};

/// The cases that cannot be exported as they are, with words of the reason.
pub(crate) const REFUSED: [(&str, &str); 7] = [
    ("boom", "2 actuators"),
    ("double-pendulum", "2 actuators"),
    ("expressions", "2 actuators"),
    ("five-bar", "2 actuators"),
    ("laws", "6 actuators"),
    ("press", "slide.friction is dry friction"),
    ("slider-crank-friction", "A.friction is dry friction"),
];

#[test]
fn every_case_exports_or_says_why_not() {
    let compiler = c_compiler();
    let mut names: Vec<String> = std::fs::read_dir(cases())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| cases().join(name).join("scene.toml").exists())
        .collect();
    names.sort();
    for name in &names {
        let text = std::fs::read_to_string(cases().join(name).join("scene.toml")).unwrap();
        let scene = PlaneScene::parse(&format!("{name}.toml"), &text).unwrap();
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
            (Err(error), None) => panic!("{name} is not exported: {error}"),
        };
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
}

/// Linkages in space export by the same lines: their self-tests hold exact values of the models in space.
#[test]
fn linkages_in_space_export() {
    let Some(compiler) = c_compiler() else { return };
    for entry in std::fs::read_dir(cases().join("spatial")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let Scene::Space(scene) = Scene::parse(name, &text).unwrap() else {
            panic!("{name} is in space");
        };
        let asked = request(1e-7, Precision::Double);
        let outcome = match export(&*scene, ExportTarget::C, &asked) {
            Ok(outcome) => outcome,
            Err(error) if scene.assembly.q.len() > 1 => {
                let actuators = format!("{} actuators", scene.assembly.q.len());
                assert!(error.to_string().contains(&actuators), "{name}: {error}");
                continue;
            }
            Err(error) if !scene.stops.is_empty() => {
                assert!(error.to_string().contains("end stops"), "{name}: {error}");
                continue;
            }
            Err(error) => panic!("{name} is not exported: {error}"),
        };
        let scratch = Scratch::new();
        let files = outcome.files.iter().map(|(path, bytes)| {
            let path = path.to_str().unwrap().to_owned();
            (path, String::from_utf8(bytes.to_vec()).unwrap())
        });
        let files: Vec<_> = files.collect();
        scratch.write(&files);
        let source = files.iter().find(|(path, _)| path.ends_with(".c")).unwrap();
        let stem = source.0.trim_end_matches(".c").to_uppercase();
        let define = format!("-D{stem}_SELF_TEST");
        compile(&scratch.0, compiler, &[&define, &source.0, "-o", "program"]);
        run(&scratch.0, "./program", &[]);
    }
}
