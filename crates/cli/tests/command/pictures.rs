//! What pictures a command draws: their format, the part of a motion they show, and titles that are markup elsewhere.

use crate::test_dir::TestDir;
use std::fs;

fn single_dwell() -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
    format!("{root}/single-dwell/scene.toml")
}

#[test]
fn figures_are_png_or_svg_or_both_and_the_page_shows_what_there_is() {
    let dir = TestDir::new();
    let scene = single_dwell();
    for (format, png, svg) in [("png", 4, 0), ("svg", 0, 4), ("both", 4, 4)] {
        let arguments = [
            "simulate",
            &scene,
            "--out",
            format,
            "--picture-format",
            format,
        ];
        let run = dir.run(&arguments);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let files = dir.files(format);
        let count = |end: &str| files.iter().filter(|file| file.ends_with(end)).count();
        assert_eq!((count(".png"), count(".svg")), (png, svg), "{files:?}");
        let page = fs::read_to_string(dir.0.join(format).join("single-dwell-motion.md")).unwrap();
        let shown = if png > 0 { ".png)" } else { ".svg)" };
        assert_eq!(
            (page.matches("![").count(), page.matches(shown).count()),
            (4, 4)
        );
    }
    let figure = dir.0.join("svg").join("single-dwell-motion-energies.svg");
    let svg = fs::read_to_string(figure).unwrap();
    assert!(svg.contains(">Energies</text>"), "{}", &svg[..400]);
    let refused = dir.run(&["simulate", &scene, "--picture-format", "pdf"]);
    assert_eq!(refused.status, Some(2));
}

#[test]
fn curves_show_the_part_that_is_wanted_and_files_keep_all_rows() {
    let dir = TestDir::new();
    let scene = single_dwell();
    let all = dir.run(&["simulate", &scene, "--out", "all", "--pictures", "none"]);
    assert_eq!(all.status, Some(0));
    let arguments = ["simulate", &scene, "--out", "o", "--picture-format", "svg"];
    let part = dir.run(&[&arguments[..], &["--from", "2", "--to", "6.5"]].concat());
    assert_eq!((part.status, part.err.as_str()), (Some(0), ""));
    let read = |folder: &str, file: &str| fs::read(dir.0.join(folder).join(file)).unwrap();
    let table = "single-dwell-motion.csv";
    assert_eq!(read("all", table), read("o", table));
    let svg = String::from_utf8(read("o", "single-dwell-motion-energies.svg")).unwrap();
    assert!(svg.contains("time from 2 to 6.5 s"));
    // The axis of the curves: 0 is before its beginning, and the motion takes longer than 7 s.
    let labels = |text: &str| svg.contains(&format!(">{text}</text>"));
    assert!(labels("4") && labels("6") && !labels("8") && !labels("50"));
    for (from, to, message) in [
        ("6", "2", "cannot go from 6 s to 2 s"),
        ("2", "2", "cannot go from 2 s to 2 s"),
        ("2", "1e6", "not within the motion"),
        ("-1", "3", "not within the motion"),
    ] {
        let run = dir.run(&[
            "simulate", &scene, "--out", "bad", "--from", from, "--to", to,
        ]);
        assert_eq!(run.status, Some(2), "{}", run.out);
        assert!(run.err.contains(message), "{}", run.err);
    }
    let run = dir.run(&["simulate", &scene, "--from", "NaN"]);
    assert_eq!(run.status, Some(2));
    assert!(run.err.contains("not a finite number"), "{}", run.err);
    let run = dir.run(&[
        "kinematics",
        &scene,
        "--out",
        "k",
        "--from",
        "1",
        "--to",
        "2",
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
}

#[test]
fn titles_that_are_markup_elsewhere_stay_words() {
    let dir = TestDir::new();
    let scene = fs::read_to_string(single_dwell()).unwrap();
    let line = scene
        .lines()
        .find(|line| line.starts_with("title"))
        .unwrap();
    let title = r"title = 'a <b> & `c` | *d* [e] 漢 🚀 \'";
    dir.put("words.toml", scene.replace(line, title));
    let arguments = [
        "kinematics",
        "words.toml",
        "--out",
        "o",
        "--picture-format",
        "both",
    ];
    let run = dir.run(&arguments);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let read = |file: &str| fs::read_to_string(dir.0.join("o").join(file)).unwrap();
    let page = read("words-kinematics.md");
    assert!(
        page.contains(r"a &lt;b> &amp; \`c\` | \*d\* \[e\] 漢 🚀 \\"),
        "{page}"
    );
    assert!(!page.contains("<b>"));
    // What the font lacks is a box.
    let svg = read("words-kinematics-mechanism.svg");
    assert!(svg.contains("a &lt;b&gt; &amp; `c` | *d* [e] □ □ \\</text>"));
}
