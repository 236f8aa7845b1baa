//! Files of sweeps that are damaged, or of another study: refused by name.

use crate::sweep::{SMALL_PART, arguments, succeed, test_dir};
use crate::test_dir::TestDir;
use std::fs;

/// Runs a command that must be refused with some words, on one line.
fn refused(dir: &TestDir, arguments: &[&str], words: &[&str]) {
    let run = dir.run(arguments);
    assert_eq!(run.status, Some(2), "{}", run.out);
    let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = said.replace(" │ ", " ");
    let named = words.iter().all(|words| said.contains(words));
    assert!(named, "{words:?} not in {said}");
}

#[test]
fn another_study_and_its_files_are_refused() {
    let dir = test_dir();
    let study = arguments("10", &["--out", "o"]);
    succeed(&dir, &study);
    let other = arguments("11", &["--out", "o"]);
    let words = [
        "o/four-bar-sweep holds another study",
        "samples `10` instead of `11`",
    ];
    refused(&dir, &other, &words);
    // A part of another study under the name of one of this.
    succeed(&dir, &arguments("10", &["--out", "p", "--result", "m"]));
    let [own, other] = ["o", "p"].map(|folder| dir.0.join(folder).join(SMALL_PART));
    fs::copy(&other, &own).unwrap();
    refused(
        &dir,
        &study,
        &["part-0000000000", "the part is of another study"],
    );
    fs::remove_file(&own).unwrap();
    succeed(&dir, &study);
    // Readers of the folder would take it for rows of the study.
    for name in [
        "best.parquet",
        "part-0000000000-0000000100.parquet",
        "part-0000000000-0000000199.x.parquet",
    ] {
        let foreign = own.with_file_name(name);
        fs::copy(&other, &foreign).unwrap();
        refused(&dir, &study, &[name, "is no part of this study"]);
        fs::remove_file(foreign).unwrap();
    }
    dir.put("o/four-bar-sweep/_study.toml", "my own notes");
    refused(&dir, &study, &["_study.toml", "does not define a study"]);
}

/// Damages a file of a study in many ways: a run must refuse it by name, or write the same table.
fn damage(dir: &TestDir, file: &str, run: &[&str], seed: u64) {
    let table = dir.0.join("o/four-bar-sweep.csv");
    let intact = fs::read(dir.0.join("whole/four-bar-sweep.csv")).unwrap();
    let folder = dir.0.join("o/four-bar-sweep");
    let kept: Vec<_> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    let kept: Vec<_> = kept
        .into_iter()
        .map(|path| (fs::read(&path).unwrap(), path))
        .collect();
    let path = folder.join(file);
    let bytes = fs::read(&path).unwrap();
    // A multiplicative congruential sequence: places that follow no pattern of the file.
    let mut state = seed;
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
        fs::remove_dir_all(&folder).unwrap();
        fs::create_dir(&folder).unwrap();
        kept.iter()
            .for_each(|(bytes, path)| fs::write(path, bytes).unwrap());
        fs::write(&path, damaged).unwrap();
        fs::remove_file(&table).ok();
        let run = dir.run(run);
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

#[test]
fn a_damaged_file_is_refused_or_gives_the_same_rows() {
    let dir = test_dir();
    let study = |out| arguments("10", &["--out", out, "--export", "csv"]);
    succeed(&dir, &study("whole"));
    succeed(&dir, &study("o"));
    let name = SMALL_PART.rsplit('/').next().unwrap();
    damage(&dir, name, &study("o"), 20_251_124);
}

#[test]
fn a_damaged_unfinished_file_is_refused_or_gives_the_same_rows() {
    let dir = test_dir();
    let study = |out| arguments("10", &["--out", out, "--export", "csv"]);
    succeed(&dir, &study("whole"));
    succeed(&dir, &arguments("10", &["--out", "o", "--shard", "1/3"]));
    let name = "part-0000000000-0000000199.1-of-3.parquet";
    damage(&dir, name, &study("o"), 20_261_129);
}
