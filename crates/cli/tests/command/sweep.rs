//! Sweeps: a run that is killed loses nothing and doubles nothing, shards make the whole, and the rows are
//! those of the other commands.

use crate::test_dir::{FOUR_BAR, TestDir};
use rusqlite::Connection;
use rusqlite::types::Value;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// What is varied where it does not matter: a grid, and two tolerances.
const STUDY: [&str; 9] = [
    "--vary",
    "crank.inertia=0.01:0.02:20",
    "--vary",
    "coupler.mass±5%",
    "--vary",
    "rocker.mass~normal(0.6,0.01)",
    "--seed",
    "12",
    "--samples",
];

fn arguments<'a>(samples: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec!["sweep", "four-bar.toml"];
    all.extend(STUDY);
    all.push(samples);
    all.extend(more);
    all
}

/// Every row of a file to the last bit, by index.
fn rows(path: &Path) -> Vec<Vec<Value>> {
    let connection = Connection::open(path).unwrap();
    let mut statement = connection
        .prepare("SELECT * FROM points ORDER BY \"index\"")
        .unwrap();
    let columns = statement.column_count();
    let rows = statement.query_map((), |row| (0..columns).map(|k| row.get(k)).collect());
    rows.unwrap().map(Result::unwrap).collect()
}

fn test_dir() -> TestDir {
    let dir = TestDir::new();
    dir.put("four-bar.toml", FOUR_BAR);
    dir
}

/// Starts a run, and kills it (SIGKILL) some time after it began to write more. Whether it came to its end before.
fn kill_while_writing(dir: &TestDir, arguments: &[&str], file: &Path, later: u64) -> bool {
    let size = |path: &Path| fs::metadata(path).map_or(0, |m| m.len());
    // The empty tables are below this, and a batch of rows is above it.
    let before = size(file).max(16 * 1024);
    // One thread, so that a large machine is not done before it is killed.
    let mut command = dir.command(arguments);
    let mut run = command.env("RAYON_NUM_THREADS", "1").spawn().unwrap();
    let begun = Instant::now();
    loop {
        if run.try_wait().unwrap().is_some() {
            return true;
        }
        if size(file) > before {
            std::thread::sleep(Duration::from_millis(later));
            run.kill().unwrap();
            run.wait().unwrap();
            return false;
        }
        assert!(
            begun.elapsed() < Duration::from_secs(120),
            "no row in two minutes"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_killed_run_goes_on_and_its_rows_are_those_of_an_unbroken_one() {
    let dir = test_dir();
    let points = 20 * 6000;
    let broken = arguments("6000", &["--out", "broken", "--store", "sqlite"]);
    let file = dir.0.join("broken/four-bar-sweep.sqlite");
    let mut kept: Vec<Vec<Value>> = Vec::new();
    let mut killed = 0;
    // At once is in the midst of a commit, later between two. Where the disk is slow a commit takes longer than all
    // of these, and nothing is kept yet: then ever later.
    for later in [0, 30, 3, 60, 10, 200, 400, 800, 1600] {
        if killed >= 5 && !kept.is_empty() {
            break;
        }
        if kill_while_writing(&dir, &broken, &file, later) {
            break;
        }
        killed += 1;
        let now = rows(&file);
        // Both are in the order of their indices.
        let mut all = now.iter();
        let lost = kept.iter().find(|row| !all.any(|of| of == *row));
        assert_eq!(lost, None, "what was there stays");
        kept = now;
    }
    assert!(killed >= 2, "killed but {killed} times: too few points");
    assert!((1..points).contains(&kept.len()), "{} kept", kept.len());
    assert!(!dir.0.join("broken/four-bar-sweep.csv").exists());
    let run = dir.run(&broken);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let counts = format!(
        "({} already stored, {} computed)",
        kept.len(),
        points - kept.len()
    );
    assert!(run.out.contains(&counts), "{} not in {}", counts, run.out);

    let run = dir.run(&arguments("6000", &["--out", "whole", "--store", "sqlite"]));
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let complete = rows(&dir.0.join("whole/four-bar-sweep.sqlite"));
    assert_eq!(complete.len(), points);
    assert!(rows(&file) == complete, "the same rows to the last bit");
    for kind in ["csv", "npz", "png"] {
        let read = |folder: &str| fs::read(dir.0.join(format!("{folder}/four-bar-sweep.{kind}")));
        assert!(read("broken").unwrap() == read("whole").unwrap(), "{kind}");
    }
}

#[test]
fn shards_make_the_whole() {
    let dir = test_dir();
    let run = dir.run(&arguments("10", &["--out", "whole"]));
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let complete = rows(&dir.0.join("whole/four-bar-sweep.sqlite"));
    assert_eq!(complete.len(), 200);
    let mut gathered = Vec::new();
    for part in 1..=3 {
        let shard = format!("{part}/3");
        let run = dir.run(&arguments("10", &["--out", "parts", "--shard", &shard]));
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let file = format!("parts/four-bar-sweep-{part}-of-3.sqlite");
        gathered.extend(rows(&dir.0.join(file)));
    }
    gathered.sort_by_key(|row| match row[0] {
        Value::Integer(index) => index,
        _ => -1,
    });
    assert!(
        gathered == complete,
        "each point in one shard, with the same values"
    );
    let run = dir.run(&arguments("10", &["--out", "parts", "--export", "csv"]));
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out.contains("(200 imported from shards)"),
        "{}",
        run.out
    );
    let csv = |folder: &str| fs::read(dir.0.join(folder).join("four-bar-sweep.csv")).unwrap();
    assert!(csv("parts") == csv("whole"));
    assert!(!dir.0.join("parts/four-bar-sweep.npz").exists());
}

#[test]
fn a_point_that_comes_apart_is_a_row_that_says_so() {
    let dir = test_dir();
    // A coupler of 50 mm cannot reach from the crank to the rocker.
    let vary = ["--vary", "coupler.points.C[0]=0.35,0.05,0.36"];
    let run = dir.run(&[&["sweep", "four-bar.toml", "--out", "o"], &vary[..]].concat());
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out.contains("1 of 3 could not be computed"),
        "{}",
        run.out
    );
    let rows = rows(&dir.0.join("o/four-bar-sweep.sqlite"));
    // The message is before the checksum.
    let message = rows[1].len() - 2;
    let failed: Vec<bool> = rows.iter().map(|row| row[message] != Value::Null).collect();
    assert_eq!(failed, [false, true, false]);
    let empty = |cell: &Value| *cell == Value::Null;
    assert!(rows[1][2..message].iter().all(empty), "{:?}", rows[1]);
    let csv = fs::read_to_string(dir.0.join("o/four-bar-sweep.csv")).unwrap();
    assert_eq!(csv.lines().filter(|line| line.ends_with('"')).count(), 1);
}

#[test]
fn the_file_says_what_it_is() {
    let dir = test_dir();
    let vary = ["--vary", "crank.inertia=0.01,0.02", "--result", "period"];
    let run = dir.run(&[&["sweep", "four-bar.toml", "--out", "o"], &vary[..]].concat());
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let connection = Connection::open(dir.0.join("o/four-bar-sweep.sqlite")).unwrap();
    let version: i64 = connection
        .pragma_query_value(None, "user_version", |row| row.get(0))
        .unwrap();
    assert_eq!(version, 3);
    let value = |key: &str| -> String {
        let query = "SELECT value FROM study WHERE \"key\" = ?";
        connection
            .query_row(query, [key], |row| row.get(0))
            .unwrap()
    };
    assert_eq!(value("axes"), "crank.inertia=0.01,0.02");
    assert_eq!(value("results"), "period [s]");
    assert_eq!(value("scene_text"), FOUR_BAR);
    assert_eq!(value("shard"), "all");
}

/// Runs an export of a damaged copy of a file; whether it was refused. What is accepted must be what the intact file gives.
fn refuses(dir: &TestDir, damaged: &[u8], intact: &[u8], what: &str) -> bool {
    let folder = dir.0.join("damaged");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("four-bar-sweep.sqlite"), damaged).unwrap();
    let run = dir.run(&arguments("10", &["--out", "damaged", "--export", "csv"]));
    let csv = fs::read(folder.join("four-bar-sweep.csv"));
    if run.status == Some(0) {
        assert!(csv.unwrap() == intact, "{what}: other rows are accepted");
        return false;
    }
    assert_eq!(run.status, Some(2), "{what}: {}", run.err);
    assert!(csv.is_err(), "{what}: refused, and a table is written");
    assert!(
        run.err.contains("four-bar-sweep.sqlite"),
        "{what}: {}",
        run.err
    );
    true
}

#[test]
fn a_damaged_file_is_refused_or_gives_the_same_rows() {
    let dir = test_dir();
    let run = dir.run(&arguments("10", &["--out", "whole"]));
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let file = fs::read(dir.0.join("whole/four-bar-sweep.sqlite")).unwrap();
    let csv = fs::read(dir.0.join("whole/four-bar-sweep.csv")).unwrap();
    // A multiplicative congruential sequence: places that follow no pattern of the pages.
    let mut state = 20_251_123_u64;
    let mut next = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    let mut refused = 0;
    for _ in 0..200 {
        let (place, bit) = (next(file.len()), next(8));
        let mut damaged = file.clone();
        damaged[place] ^= 1 << bit;
        refused += usize::from(refuses(
            &dir,
            &damaged,
            &csv,
            &format!("bit {bit} of byte {place}"),
        ));
    }
    // Most of the file is rows.
    assert!(refused > 100, "{refused} of 200 refused");
    // The last page can be one that holds nothing: without its end the rows are the same.
    let mut refused = 0;
    for _ in 0..60 {
        let length = 1 + next(file.len() - 1);
        let what = format!("the first {length} of {} bytes", file.len());
        refused += usize::from(refuses(&dir, &file[..length], &csv, &what));
    }
    assert!(refused > 45, "{refused} of 60 refused");
}

#[test]
fn a_row_of_another_point_is_refused() {
    let dir = test_dir();
    let part = arguments("10", &["--out", "parts", "--shard", "1/2"]);
    let run = dir.run(&part);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let file = dir.0.join("parts/four-bar-sweep-1-of-2.sqlite");
    let connection = Connection::open(&file).unwrap();
    // Point 1 belongs to the other shard; 0 and 2 are in this one.
    connection
        .execute("UPDATE points SET \"index\" = 1 WHERE \"index\" = 0", ())
        .unwrap();
    drop(connection);
    for command in [part, arguments("10", &["--out", "parts"])] {
        let run = dir.run(&command);
        assert_eq!(run.status, Some(2), "{}", run.out);
        assert!(
            run.err.contains("the row of point 1 is damaged"),
            "{}",
            run.err
        );
    }
}
