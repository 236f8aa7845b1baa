//! Large sweeps: parts in a folder, which a killed run leaves whole, shards share, and no damage changes unnoticed.

use crate::test_dir::{FOUR_BAR, TestDir};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use std::fs;
use std::path::{Path, PathBuf};
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

fn arguments<'a>(samples: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&STUDY[..], &[samples], more].concat()
}

fn test_dir() -> TestDir {
    let dir = TestDir::new();
    dir.put("four-bar.toml", FOUR_BAR);
    dir
}

/// The parts in a folder, by name.
fn parts(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut parts: Vec<PathBuf> = paths
        .filter(|p| p.extension().unwrap() == "parquet")
        .collect();
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
        row.get_column_iter()
            .map(|(_, field)| text(field))
            .collect()
    });
    cells.collect()
}

/// Starts a run, and kills it (SIGKILL) when it has written another part. Whether it came to its end before.
fn kill_after_a_part(dir: &TestDir, arguments: &[&str], folder: &Path) -> bool {
    let before = parts(folder).len();
    // One thread, so that a large machine is not done before it is killed.
    let mut command = dir.command(arguments);
    let mut run = command.env("RAYON_NUM_THREADS", "1").spawn().unwrap();
    let begun = Instant::now();
    while parts(folder).len() == before {
        if run.try_wait().unwrap().is_some() {
            return true;
        }
        let waited = begun.elapsed();
        assert!(waited < Duration::from_secs(300), "no part in five minutes");
        std::thread::sleep(Duration::from_millis(2));
    }
    // In the midst of the next one.
    std::thread::sleep(Duration::from_millis(20));
    run.kill().unwrap();
    run.wait().unwrap();
    false
}

#[test]
fn a_killed_run_goes_on_and_its_parts_are_those_of_an_unbroken_one() {
    let dir = test_dir();
    let broken = arguments("10000", &["--out", "broken"]);
    let folder = dir.0.join("broken/four-bar-sweep");
    for _ in 0..2 {
        let stored: Vec<_> = parts(&folder)
            .iter()
            .map(|p| fs::read(p).unwrap())
            .collect();
        assert!(!kill_after_a_part(&dir, &broken, &folder), "too few points");
        let now: Vec<_> = parts(&folder)
            .iter()
            .map(|p| fs::read(p).unwrap())
            .collect();
        assert!(now.starts_with(&stored), "what was there stays");
    }
    let stored = parts(&folder).len() * 65_536;
    assert!(stored < 200_000);
    let run = dir.run(&broken);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let counts = format!("({stored} already stored, {} computed)", 200_000 - stored);
    assert!(run.out.contains(&counts), "{counts} not in {}", run.out);

    let run = dir.run(&arguments("10000", &["--out", "whole"]));
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let whole = dir.files("whole");
    assert_eq!(
        whole,
        [
            "four-bar-sweep.json",
            "four-bar-sweep.png",
            "four-bar-sweep/_study.toml",
            "four-bar-sweep/part-0000000000-0000065535.parquet",
            "four-bar-sweep/part-0000065536-0000131071.parquet",
            "four-bar-sweep/part-0000131072-0000196607.parquet",
            "four-bar-sweep/part-0000196608-0000199999.parquet",
        ]
    );
    // Nothing is left of the killed runs, either.
    assert_eq!(dir.files("broken"), whole);
    for name in whole.iter().filter(|name| !name.ends_with(".json")) {
        let read = |folder: &str| fs::read(dir.0.join(folder).join(name)).unwrap();
        assert!(read("broken") == read("whole"), "{name}");
    }
    let all: Vec<_> = parts(&folder).iter().flat_map(|part| rows(part)).collect();
    let indices = all.iter().map(|row| row[0].parse::<usize>().unwrap());
    assert!(indices.eq(0..200_000), "every row once");
}

#[test]
fn rows_are_those_of_the_sqlite_file() {
    let dir = test_dir();
    let tables = ["sqlite", "parquet"].map(|kind| {
        let run = dir.run(&arguments("10", &["--out", kind, "--store", kind]));
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let run = dir.run(&arguments(
            "10",
            &["--out", kind, "--store", kind, "--export", "csv"],
        ));
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let read = |name: &str| fs::read(dir.0.join(kind).join(name)).unwrap();
        (read("four-bar-sweep.csv"), read("four-bar-sweep.png"))
    });
    assert!(tables[0] == tables[1], "the same table and picture");
    let csv = String::from_utf8(tables[0].0.clone()).unwrap();
    let part = dir
        .0
        .join("parquet/four-bar-sweep/part-0000000000-0000000199.parquet");
    // As other programs read it: the numbers of the table, null where it has none.
    let number = |text: &str| text.parse::<f64>().ok().filter(|v| !v.is_nan());
    for (line, row) in csv.lines().skip(1).zip(rows(&part)) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), row.len());
        for (cell, stored) in cells.iter().zip(&row) {
            assert_eq!(number(cell), number(stored), "{line} {row:?}");
        }
    }
}

#[test]
fn shards_fill_one_folder() {
    let dir = test_dir();
    // Four parts, of which the first shard has two.
    for (shard, points) in [("1/3", 65_536 + 3392), ("2/3", 65_536), ("3/3", 65_536)] {
        let run = dir.run(&arguments("10000", &["--out", "o", "--shard", shard]));
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let said = format!("of which shard {shard} has {points}\n");
        assert!(run.out.contains(&said), "{}", run.out);
        assert!(!dir.0.join("o/four-bar-sweep.png").exists());
    }
    let run = dir.run(&arguments("10000", &["--out", "o"]));
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("(200000 already stored)"), "{}", run.out);
}

#[test]
fn a_point_that_comes_apart_has_a_message_and_no_numbers() {
    let dir = test_dir();
    let vary = ["--vary", "coupler.points.C[0]=0.35,0.05,0.36"];
    let start = ["sweep", "four-bar.toml", "--out", "o", "--store", "parquet"];
    let run = dir.run(&[&start[..], &vary[..]].concat());
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let said = "1 of 3 could not be computed completely";
    assert!(run.out.contains(said), "{}", run.out);
    let rows = rows(
        &dir.0
            .join("o/four-bar-sweep/part-0000000000-0000000002.parquet"),
    );
    let failed: Vec<bool> = rows
        .iter()
        .map(|row| row.last().unwrap() != "null")
        .collect();
    assert_eq!(failed, [false, true, false]);
    assert!(
        rows[1][2..rows[1].len() - 1]
            .iter()
            .all(|cell| cell == "null")
    );
}

#[test]
fn another_study_and_the_other_kind_of_file_are_refused() {
    let dir = test_dir();
    let study = arguments("10", &["--out", "o", "--store", "parquet"]);
    assert_eq!(dir.run(&study).status, Some(0));
    let refused = |arguments: &[&str], words: &str| {
        let run = dir.run(arguments);
        assert_eq!(run.status, Some(2), "{}", run.out);
        let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            said.replace(" │ ", " ").contains(words),
            "{words} not in {}",
            run.err
        );
    };
    let other = arguments("11", &["--out", "o", "--store", "parquet"]);
    refused(&other, "its samples: `10`, not `11`");
    refused(&arguments("10", &["--out", "o"]), "--store parquet");
    // A part of another study under the name of one of this.
    assert_eq!(
        dir.run(&arguments(
            "10",
            &["--out", "p", "--store", "parquet", "--result", "m"]
        ))
        .status,
        Some(0)
    );
    let part = "four-bar-sweep/part-0000000000-0000000199.parquet";
    fs::copy(dir.0.join("p").join(part), dir.0.join("o").join(part)).unwrap();
    refused(&study, "the part is of another study");
    fs::remove_file(dir.0.join("o").join(part)).unwrap();
    assert_eq!(dir.run(&study).status, Some(0));
}

#[test]
fn a_damaged_part_is_refused_or_gives_the_same_rows() {
    let dir = test_dir();
    let export = arguments(
        "10",
        &["--out", "o", "--store", "parquet", "--export", "csv"],
    );
    assert_eq!(
        dir.run(&arguments("10", &["--out", "o", "--store", "parquet"]))
            .status,
        Some(0)
    );
    assert_eq!(dir.run(&export).status, Some(0));
    let table = dir.0.join("o/four-bar-sweep.csv");
    let part = dir
        .0
        .join("o/four-bar-sweep/part-0000000000-0000000199.parquet");
    let [intact, bytes] = [&table, &part].map(|path| fs::read(path).unwrap());
    // A multiplicative congruential sequence: places that follow no pattern of the file.
    let mut state = 20_251_124_u64;
    let mut next = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    let mut refused = 0;
    for k in 0..200 {
        let mut damaged = bytes.clone();
        let place = next(bytes.len());
        let what = match k % 4 {
            0 => {
                damaged.truncate(place);
                format!("the first {place} bytes")
            }
            _ => {
                let bit = next(8);
                damaged[place] ^= 1 << bit;
                format!("bit {bit} of byte {place}")
            }
        };
        fs::write(&part, damaged).unwrap();
        fs::remove_file(&table).ok();
        let run = dir.run(&export);
        if run.status == Some(0) {
            assert!(fs::read(&table).unwrap() == intact, "{what}: other rows");
            continue;
        }
        assert_eq!(run.status, Some(2), "{what}: {}", run.err);
        assert!(!table.exists(), "{what}: refused, and a table is written");
        assert!(run.err.contains("part-0000000000"), "{what}: {}", run.err);
        refused += 1;
    }
    // All but statistics that nobody reads.
    assert!(refused > 150, "{refused} of 200 refused");
}
