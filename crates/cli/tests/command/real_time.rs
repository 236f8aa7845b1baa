//! Every command and program of docs/real-time.md, and what `dwell export` refuses.

use crate::test_dir::{TestDir, home};
use std::fs;
use std::process::Command;

/// The fenced blocks of a page: language and text.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut parts = page.split("\n```");
    // Text and blocks alternate.
    parts.next();
    while let Some(block) = parts.next() {
        let (language, text) = block.split_once('\n').unwrap();
        found.push((language.to_owned(), format!("{text}\n")));
        parts.next();
    }
    found
}

#[test]
fn every_command_of_the_page_works() {
    let dir = TestDir::new();
    for name in ["single-dwell", "five-bar"] {
        let scene = home().join(format!("validation/{name}/scene.toml"));
        dir.put(&format!("{name}.toml"), fs::read(scene).unwrap());
    }
    let page = fs::read_to_string(home().join("docs/real-time.md")).unwrap();
    let has_compiler = Command::new("cc").arg("--version").output().is_ok();
    if !has_compiler {
        eprintln!("skipped: the commands of a C compiler, which is not installed");
    }
    let mut commands = 0;
    for (language, text) in blocks(&page) {
        match language.as_str() {
            "c" => {
                let path = text.lines().next().unwrap();
                let path = path.trim_start_matches("/* ").trim_end_matches(" */");
                dir.put(path, &text);
            }
            "sh" => {
                let mut compiled = has_compiler;
                for line in text.lines() {
                    commands += 1;
                    let words: Vec<&str> = line.split_whitespace().collect();
                    if words[0] == "dwell" {
                        let run = dir.run(&words[1..]);
                        assert_eq!((run.status, run.err.as_str()), (Some(0), ""), "{line}");
                        continue;
                    }
                    compiled |= words[0] == "rustc";
                    if compiled {
                        let mut command = Command::new("sh");
                        let output = command.args(["-c", line]).current_dir(&dir.0).output();
                        let output = output.unwrap();
                        let said = String::from_utf8_lossy(&output.stderr);
                        assert!(output.status.success(), "{line}: {said}");
                    }
                }
            }
            _ => {}
        }
    }
    assert!(commands >= 12, "{commands}");
}

/// The same command writes the same bytes.
#[test]
fn an_export_repeats() {
    let dir = TestDir::new();
    let scene = home().join("validation/single-dwell/scene.toml");
    dir.put("single-dwell.toml", fs::read(scene).unwrap());
    for target in ["c", "rust", "fmu", "fmu2", "matlab", "csv", "npz", "json"] {
        let run = |out: &str| {
            let run = dir.run(&["export", "single-dwell.toml", "--to", target, "--out", out]);
            assert_eq!((run.status, run.err.as_str()), (Some(0), ""), "{target}");
        };
        let [one, two] = ["one", "two"].map(|out| format!("{target}-{out}"));
        run(&one);
        run(&two);
        let files = |folder: &str| {
            let mut found: Vec<_> = fs::read_dir(dir.0.join(folder))
                .unwrap()
                .map(|entry| entry.unwrap())
                .filter(|entry| entry.file_type().unwrap().is_file())
                .map(|entry| (entry.file_name(), fs::read(entry.path()).unwrap()))
                .collect();
            found.sort();
            found
        };
        assert_eq!(files(&one), files(&two), "{target}");
    }
}

/// What cannot be exported points into the scene and writes nothing.
#[test]
fn a_refusal_names_the_load() {
    let dir = TestDir::new();
    let scene = home().join("validation/slider-crank-friction/scene.toml");
    dir.put("pump.toml", fs::read(scene).unwrap());
    let run = dir.run(&["export", "pump.toml", "--to", "c"]);
    assert_eq!(run.status, Some(2), "{run:?}");
    assert!(
        run.err.contains("dry friction") && run.err.contains("pump.toml:"),
        "{}",
        run.err
    );
    let run = dir.run(&["export", "pump.toml", "--to", "fmu", "--float"]);
    assert!(
        run.status == Some(2) && run.err.contains("double precision"),
        "{run:?}"
    );
    assert!(!dir.0.join("reports").exists());
}
