//! Rows that do not fit into memory: the same files, from a temporary file.

use crate::test_dir::TestDir;
use std::fs;

/// A tenth of the rows fits into memory and all of them do not.
#[test]
fn rows_of_a_long_run_are_those_of_a_short_one() {
    let dir = TestDir::new();
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/jansen/scene.toml"
    );
    let run = |points: &str, out: &str| {
        let run = dir.run(&[
            "kinetostatics",
            scene,
            "--points",
            points,
            "--out",
            out,
            "--pictures",
            "main",
        ]);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let csv = fs::read_to_string(dir.0.join(out).join("jansen-kinetostatics.csv")).unwrap();
        csv.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (short, long) = (run("3001", "short"), run("30001", "long"));
    assert_eq!((short.len(), long.len()), (3002, 30_002));
    assert_eq!(short[0], long[0]);
    assert!(short[1..].iter().eq(long[1..].iter().step_by(10)));
    // The archive holds the bits of the text.
    let archive = fs::read(dir.0.join("long/jansen-kinetostatics.npz")).unwrap();
    let last: Vec<f64> = long[30_001]
        .split(',')
        .map(|v| v.parse().unwrap())
        .collect();
    let name = b"phi.npy";
    let at = archive.windows(name.len()).position(|w| w == name).unwrap();
    let data = archive[at..]
        .windows(6)
        .position(|w| w == b"\x93NUMPY")
        .unwrap()
        + at;
    let header = 10 + usize::from(u16::from_le_bytes([archive[data + 8], archive[data + 9]]));
    let value = |row: usize| {
        let start = data + header + 8 * row;
        f64::from_le_bytes(archive[start..start + 8].try_into().unwrap())
    };
    assert_eq!(value(30_000).to_bits(), last[1].to_bits());
    let extrema = |out: &str| {
        let path = dir.0.join(out).join("jansen-kinetostatics-extrema.csv");
        fs::read_to_string(path).unwrap().lines().count()
    };
    assert_eq!(extrema("short"), extrema("long"));
}
