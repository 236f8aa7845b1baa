//! The HTML page of a command.

use crate::test_dir::TestDir;
use std::fs;

fn scene(name: &str) -> String {
    format!(
        "{}/../../validation/{name}/scene.toml",
        env!("CARGO_MANIFEST_DIR")
    )
}

/// The description of a page.
fn description(html: &str) -> serde_json::Value {
    let (_, rest) = html
        .split_once("<script id=\"page-description\" type=\"application/json\">")
        .unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

#[test]
fn a_page_is_written_only_where_it_is_wanted_and_always_the_same() {
    let dir = TestDir::new();
    let scene = scene("slider-crank");
    let arguments = ["kinetostatics", &scene, "--pictures", "none", "--out"];
    let without = dir.run(&[&arguments[..], &["a"]].concat());
    assert_eq!(without.status, Some(0));
    let is_page = |file: &&String| file.ends_with(".html");
    assert_eq!(dir.files("a").iter().filter(is_page).count(), 0);
    for folder in ["b", "c"] {
        let run = dir.run(&[&arguments[..], &[folder, "--html"]].concat());
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    }
    let name = "slider-crank-kinetostatics.html";
    let read = |folder: &str| fs::read_to_string(dir.0.join(folder).join(name)).unwrap();
    assert_eq!(read("b"), read("c"));
    let page = description(&read("b"));
    // What is printed, the summary for programs and the page say the same.
    let summary = dir.0.join("b/slider-crank-kinetostatics.json");
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(summary).unwrap()).unwrap();
    let listed = summary["files"].as_array().unwrap();
    assert!(listed.iter().any(|file| file == name));
    assert_eq!(page["scene"]["sha256"], summary["scene"]["sha256"]);
    let printed = page["printed"].as_str().unwrap();
    let lines: Vec<&str> = summary["printed"]
        .as_array()
        .unwrap()
        .iter()
        .map(|line| line.as_str().unwrap())
        .collect();
    assert_eq!(printed.lines().collect::<Vec<_>>(), lines);
    let header = fs::read_to_string(dir.0.join("b/slider-crank-kinetostatics.csv")).unwrap();
    let header = header.lines().next().unwrap();
    let columns = page["columns"].as_array().unwrap().iter();
    let names = columns.map(|c| match c["unit"].as_str().unwrap() {
        "" => c["key"].as_str().unwrap().to_owned(),
        unit => format!("{} [{unit}]", c["key"].as_str().unwrap()),
    });
    assert_eq!(names.collect::<Vec<_>>().join(","), header);
}

#[test]
fn a_command_without_rows_has_a_page_of_its_numbers() {
    let dir = TestDir::new();
    let run = dir.run(&["check", &scene("single-dwell"), "--html", "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let html = fs::read_to_string(dir.0.join("o/single-dwell-check.html")).unwrap();
    let page = description(&html);
    assert_eq!(page["rows"], 0);
    assert!(page["numbers"].as_array().unwrap().len() > 10);
}

#[test]
fn why_a_command_stops_early_is_on_its_page_and_refused_input_has_none() {
    let dir = TestDir::new();
    let run = dir.run(&["cycle", &scene("press"), "--html", "--out", "o"]);
    assert_eq!(run.status, Some(1), "{}", run.err);
    let html = fs::read_to_string(dir.0.join("o/press-cycle.html")).unwrap();
    let messages = &description(&html)["messages"];
    assert_eq!(messages[0]["severity"], "error");
    // The help says what to try, as on the screen.
    let text = messages[0]["text"].as_str().unwrap();
    assert!(
        run.err
            .replace(['\n', ' '], "")
            .contains(&text.replace(' ', "")[..20]),
        "{text}\n{}",
        run.err
    );
    let run = dir.run(&["linearise", &scene("boom"), "--html", "--out", "p"]);
    assert_eq!(run.status, Some(2));
    assert!(!dir.0.join("p").exists());
}
