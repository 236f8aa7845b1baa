//! Sweeps: a run that is killed goes on and doubles nothing, shards make the whole, and tables have the rows of the files.

use crate::test_dir::{FOUR_BAR, TestDir};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;
use std::time::{Duration, Instant};

/// A grid and two tolerances, whose number of samples follows.
const STUDY: [&str; 11] = [
    "sweep",
    "four-bar.toml",
    "--vary",
    "coupler.points.C[0]=0.33:0.36:20",
    "--vary",
    "coupler.mass±5%",
    "--vary",
    "rocker.mass~normal(0.6,0.01)",
    "--seed",
    "12",
    "--samples",
];
/// The file of a study of 200 points.
pub(crate) const SMALL_PART: &str = "four-bar-sweep/part-0000000000-0000000199.parquet";

pub(crate) fn arguments<'a>(samples: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&STUDY[..], &[samples], more].concat()
}

pub(crate) fn test_dir() -> TestDir {
    let dir = TestDir::new();
    dir.put("four-bar.toml", FOUR_BAR);
    dir
}

/// Runs a command that must succeed without a warning; what it printed.
pub(crate) fn succeed(dir: &TestDir, arguments: &[&str]) -> String {
    let run = dir.run(arguments);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""), "{}", run.out);
    run.out
}

/// The Parquet files in a folder, by name.
fn parts(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_part = |path: &PathBuf| path.extension().unwrap() == "parquet";
    let mut parts: Vec<PathBuf> = paths.filter(is_part).collect();
    parts.sort();
    parts
}

/// Every row of a file: its cells as text with all digits.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let reader = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    let text = |field: &Field| match field {
        Field::Double(value) => format!("{value:?}"),
        other => other.to_string(),
    };
    let rows = reader.get_row_iter(None).unwrap();
    let cells = rows.map(|row| {
        let row = row.unwrap();
        let cells = row.get_column_iter().map(|(_, field)| text(field));
        cells.collect()
    });
    cells.collect()
}

/// Every row in a folder, by index.
fn stored(folder: &Path) -> Vec<Vec<String>> {
    let mut all: Vec<_> = parts(folder).iter().flat_map(|part| rows(part)).collect();
    all.sort_by_key(|row| row[0].parse::<usize>().unwrap());
    all
}

/// A run on one thread, so that a large machine is not done before it is killed.
fn start(dir: &TestDir, arguments: &[&str]) -> Child {
    let mut command = dir.command(arguments);
    let command = command.env("RAYON_NUM_THREADS", "1");
    command.stdout(std::process::Stdio::null()).spawn().unwrap()
}

/// Starts a run, and kills it (SIGKILL) some time after it has stored more rows. Whether it came to its end before.
fn kill_while_storing(dir: &TestDir, arguments: &[&str], folder: &Path, later: u64) -> bool {
    // Files may vanish while they are listed.
    let size = || {
        let sizes = parts(folder)
            .into_iter()
            .map(|part| fs::metadata(part).map_or(0, |m| m.len()));
        sizes.sum::<u64>()
    };
    let before = size();
    let mut run = start(dir, arguments);
    let begun = Instant::now();
    while size() <= before {
        if run.try_wait().unwrap().is_some() {
            return true;
        }
        let waited = begun.elapsed();
        assert!(waited < Duration::from_secs(120), "no row in two minutes");
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(later));
    run.kill().unwrap();
    run.wait().unwrap().success()
}

/// Kills a study several times, lets it finish, and compares its files with those of a run that was not killed.
///
/// How long a study takes depends on the machine: one that comes to its end before two kills is tried again with
/// four times the samples.
fn kill_and_compare(samples: usize, more: &[&str], later: &[u64]) {
    let dir = test_dir();
    let samples_text = samples.to_string();
    let study = |out| {
        arguments(
            &samples_text,
            &[more, &["--export", "csv", "--out", out]].concat(),
        )
    };
    let folder = dir.0.join("broken/four-bar-sweep");
    let points = 20 * samples;
    let mut kept: Vec<Vec<String>> = Vec::new();
    let mut kills = 0;
    for later in later {
        if kill_while_storing(&dir, &study("broken"), &folder, *later) {
            break;
        }
        kills += 1;
        let now = stored(&folder);
        assert!(now.is_sorted_by(|a, b| a[0] != b[0]), "no row twice");
        // Both are in the order of their indices.
        let mut all = now.iter();
        let lost = kept.iter().find(|row| !all.any(|of| of == *row));
        assert_eq!(lost, None, "what was there stays");
        kept = now;
    }
    if kills < 2 {
        return kill_and_compare(4 * samples, more, later);
    }
    let ended = dir.0.join("broken/four-bar-sweep.csv").exists();
    assert!(!kept.is_empty() && ended == (kills < later.len()));
    let printed = succeed(&dir, &study("broken"));
    if !ended && kept.len() < points {
        let (kept, rest) = (kept.len(), points - kept.len());
        let counts = format!("({kept} already stored, {rest} computed)");
        assert!(printed.contains(&counts), "{counts} not in {printed}");
    }
    succeed(&dir, &study("whole"));
    let whole = dir.files("whole");
    // Nothing is left of the killed runs, either.
    assert_eq!(dir.files("broken"), whole);
    for name in whole.iter().filter(|name| !name.ends_with(".json")) {
        let read = |folder: &str| fs::read(dir.0.join(folder).join(name)).unwrap();
        assert!(read("broken") == read("whole"), "{name}");
    }
    let indices = stored(&folder)
        .into_iter()
        .map(|row| row[0].parse::<usize>());
    assert!(indices.map(Result::unwrap).eq(0..points), "every row once");
}

#[test]
fn a_killed_small_study_goes_on_and_its_files_are_those_of_an_unbroken_one() {
    // Motions take their time: rows are stored once a second.
    kill_and_compare(15, &["--result", "motion,m"], &[0, 300, 3, 900, 1700]);
}

#[test]
fn a_killed_large_study_goes_on_and_its_files_are_those_of_an_unbroken_one() {
    kill_and_compare(10_000, &[], &[20, 0, 100]);
}

#[test]
fn a_large_study_is_a_file_for_each_65_536_points_and_shards_fill_one_folder() {
    let dir = test_dir();
    // Four parts, of which the first shard has two.
    for (shard, points) in [("1/3", 65_536 + 3392), ("2/3", 65_536), ("3/3", 65_536)] {
        let printed = succeed(&dir, &arguments("10000", &["--out", "o", "--shard", shard]));
        let said = format!("of which shard {shard} has {points}\n");
        assert!(printed.contains(&said), "{printed}");
        assert!(!dir.0.join("o/four-bar-sweep.png").exists());
    }
    let study = arguments("10000", &["--out", "o"]);
    let printed = succeed(&dir, &study);
    assert!(printed.contains("(200000 already stored)"), "{printed}");
    let parts = parts(&dir.0.join("o/four-bar-sweep"));
    let names = parts
        .iter()
        .map(|part| part.file_name().unwrap().to_str().unwrap());
    let expected = [
        "part-0000000000-0000065535.parquet",
        "part-0000065536-0000131071.parquet",
        "part-0000131072-0000196607.parquet",
        "part-0000196608-0000199999.parquet",
    ];
    assert!(names.eq(expected));
    // A part in the place of another one.
    fs::copy(&parts[0], &parts[1]).unwrap();
    let run = dir.run(&study);
    assert_eq!(run.status, Some(2), "{}", run.out);
    let said = run.err.contains("it holds other points") && run.err.contains("part-0000065536");
    assert!(said, "{}", run.err);
}

#[test]
fn shards_of_a_small_study_make_the_whole() {
    let dir = test_dir();
    succeed(
        &dir,
        &arguments("10", &["--out", "whole", "--export", "csv"]),
    );
    let complete = rows(&dir.0.join("whole").join(SMALL_PART));
    assert_eq!(complete.len(), 200);
    for part in 1..=3 {
        let shard = format!("{part}/3");
        let study = arguments("10", &["--out", "o", "--shard", &shard]);
        let printed = succeed(&dir, &study);
        assert!(
            printed.contains(&format!("of which shard {shard} has 6")),
            "{printed}"
        );
        let again = succeed(&dir, &study);
        assert!(again.contains(" already stored)"), "{again}");
        assert_eq!(printed.lines().nth(2), again.lines().nth(2));
    }
    let folder = dir.0.join("o/four-bar-sweep");
    assert_eq!(parts(&folder).len(), 3);
    assert!(
        stored(&folder) == complete,
        "each point in one shard, with the same values"
    );
    // Other shards find what these have computed.
    let half = succeed(&dir, &arguments("10", &["--out", "o", "--shard", "2/2"]));
    assert!(half.contains(" already stored)"), "{half}");
    let printed = succeed(&dir, &arguments("10", &["--out", "o", "--export", "csv"]));
    assert!(printed.contains("(200 already stored)"), "{printed}");
    for name in [SMALL_PART, "four-bar-sweep.csv", "four-bar-sweep.png"] {
        let read = |folder: &str| fs::read(dir.0.join(folder).join(name)).unwrap();
        assert!(read("o") == read("whole"), "{name}");
    }
    assert_eq!(parts(&folder).len(), 1);
}

#[test]
fn two_runs_of_one_study_at_a_time_have_the_rows_of_one() {
    let dir = test_dir();
    let study = |out| arguments("1000", &["--out", out]);
    let mut runs = [0, 1].map(|_| start(&dir, &study("o")));
    for run in &mut runs {
        assert_eq!(run.wait().unwrap().code(), Some(0));
    }
    succeed(&dir, &study("o"));
    succeed(&dir, &study("whole"));
    assert_eq!(dir.files("o"), dir.files("whole"));
    let part = "four-bar-sweep/part-0000000000-0000019999.parquet";
    let read = |folder: &str| fs::read(dir.0.join(folder).join(part)).unwrap();
    assert!(read("o") == read("whole"));
}

#[test]
fn a_point_that_comes_apart_has_a_message_and_no_numbers() {
    let dir = test_dir();
    // A coupler of 50 mm cannot reach from the crank to the rocker.
    let vary = ["--vary", "coupler.points.C[0]=0.35,0.05,0.36"];
    let start = ["sweep", "four-bar.toml", "--out", "o", "--export", "csv"];
    let printed = succeed(&dir, &[&start[..], &vary[..]].concat());
    let said = "1 of 3 could not be computed completely";
    assert!(printed.contains(said), "{printed}");
    let rows = stored(&dir.0.join("o/four-bar-sweep"));
    let failed = rows.iter().map(|row| row.last().unwrap() != "null");
    assert!(failed.eq([false, true, false]));
    let numbers = &rows[1][2..rows[1].len() - 1];
    assert!(numbers.iter().all(|cell| cell == "null"), "{numbers:?}");
    let csv = fs::read_to_string(dir.0.join("o/four-bar-sweep.csv")).unwrap();
    assert_eq!(csv.lines().filter(|line| line.ends_with('"')).count(), 1);
}

#[test]
fn a_table_has_the_rows_of_the_files_and_is_written_on_request() {
    let dir = test_dir();
    succeed(&dir, &arguments("10", &["--out", "o"]));
    assert_eq!(
        dir.files("o"),
        [
            "four-bar-sweep.json",
            "four-bar-sweep.png",
            "four-bar-sweep/_study.toml",
            SMALL_PART,
        ]
    );
    for format in ["csv", "npz"] {
        let printed = succeed(&dir, &arguments("10", &["--out", "o", "--export", format]));
        assert!(printed.contains("(200 already stored)"), "{printed}");
        assert!(dir.0.join(format!("o/four-bar-sweep.{format}")).exists());
    }
    let csv = fs::read_to_string(dir.0.join("o/four-bar-sweep.csv")).unwrap();
    // As other programs read it: the numbers of the table, null where it has none.
    let number = |text: &str| text.parse::<f64>().ok().filter(|v| !v.is_nan());
    let rows = rows(&dir.0.join("o").join(SMALL_PART));
    assert_eq!(csv.lines().count(), 1 + rows.len());
    for (line, row) in csv.lines().skip(1).zip(rows) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), row.len());
        for (cell, stored) in cells.iter().zip(&row) {
            assert_eq!(number(cell), number(stored), "{line} {row:?}");
        }
    }
}

#[test]
fn the_folder_says_what_study_it_holds() {
    let dir = test_dir();
    let vary = ["--vary", "crank.inertia=0.01,0.02", "--result", "period"];
    succeed(
        &dir,
        &[&["sweep", "four-bar.toml", "--out", "o"], &vary[..]].concat(),
    );
    let text = fs::read_to_string(dir.0.join("o/four-bar-sweep/_study.toml")).unwrap();
    for entry in [
        "axes = \"crank.inertia=0.01,0.02\"\n",
        "results = \"period [s]\"\n",
        "points = \"2\"\n",
    ] {
        assert!(text.contains(entry), "{entry} not in {text}");
    }
    assert!(
        text.replace("\r\n", "\n").contains(FOUR_BAR.trim()),
        "{text}"
    );
}
