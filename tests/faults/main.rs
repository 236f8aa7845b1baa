//! Deliberate faults.
#![allow(clippy::expect_used, clippy::panic, clippy::print_stdout, reason = "a study")]

mod machine;
mod operations;
mod published;
mod reduced;
mod wrench;
mod source;
mod verdict;
mod watched;

use machine::{By, Machine};
use dwell_scene::Scene;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

fn main() {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let clock = Instant::now();
    named(&home);
    println!("named {:?}", clock.elapsed());
    let mut names: Vec<String> = std::fs::read_dir(home.join("validation")).expect("x").map(|e| e.expect("e").file_name().into_string().expect("s")).collect();
    names.sort();
    let mut paths: Vec<std::path::PathBuf> = names.iter().map(|n| home.join("validation").join(n).join("scene.toml")).collect();
    for e in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("faults/scenes")).expect("x") { paths.push(e.expect("e").path()); }
    let machines: Vec<Machine> = paths.par_iter().flat_map_iter(|path| {
        let scene = Scene::read(path).expect("scene");
        let n = scene.mechanism.actuators.len();
        let mut all = Vec::new();
        if n == 1 { all.push(Machine::new(scene.clone(), By::Reduced)); }
        if n > 1 || !scene.loads.is_empty() { all.push(Machine::new(scene, By::States)); }
        all
    }).collect();
    println!("built {:?}", clock.elapsed());
    let mut cost: Vec<(f64, Machine)> = machines.into_iter().map(|m| {
        let t = Instant::now();
        let v = m.judge(None);
        assert_eq!(v.count(), 0, "{}", m.name);
        if !m.blind.is_empty() { println!("{} {:?} blind {:?}", m.name, m.by, m.blind); }
        (t.elapsed().as_secs_f64(), m)
    }).collect();
    cost.sort_by(|a, b| a.0.total_cmp(&b.0));
    let machines: Vec<Machine> = cost.into_iter().map(|c| c.1).collect();
    println!("ordered {:?}", clock.elapsed());
    let all = operations::study(&machines);
    println!("studied {:?}", clock.elapsed());
    let source = source::Source::read(&home, all.iter().map(|s| s.place));
    let mut steps: BTreeMap<String, [usize; 5]> = BTreeMap::new();
    for s in &all {
        let e = steps.entry(source.step(s.place)).or_default();
        e[0] += 1;
        match &s.outcome {
            operations::Outcome::Same => e[1] += 1,
            operations::Outcome::Refused => e[2] += 1,
            operations::Outcome::Judged(v, _) if v.count() < 2 => e[3] += 1,
            operations::Outcome::Judged(..) => e[4] += 1,
        }
    }
    for (k, v) in &steps { println!("{k:<40} all {:>4} same {:>4} refused {:>4} MISSED {:>4} caught {:>4}", v[0], v[1], v[2], v[3], v[4]); }
    for s in all.iter().filter(|s| s.missed()) {
        if let operations::Outcome::Judged(v, on) = &s.outcome {
            println!("MISSED {} :{} `{}` {} {} {:?} {:?}", source.step(s.place), s.place.line, source.line(s.place), s.place.operation.words(), s.slip.words(), v.digits.iter().enumerate().filter_map(|(i, d)| d.map(|d| (i, d))).collect::<Vec<_>>(), on);
        }
    }
    for s in all.iter().filter(|s| s.outcome == operations::Outcome::Same) {
        println!("SAME {} :{} `{}` {} {}", source.step(s.place), s.place.line, source.line(s.place), s.place.operation.words(), s.slip.words());
    }
}

fn named(home: &Path) {
    let read = |p: std::path::PathBuf| Scene::read(p).expect("scene");
    let case = |n: &str| read(home.join("validation").join(n).join("scene.toml"));
    let own = |n: &str| read(Path::new(env!("CARGO_MANIFEST_DIR")).join("faults/scenes").join(format!("{n}.toml")));
    let single = case("single-dwell");
    let mut other = single.clone();
    for rough in &mut other.assembly.rough { *rough = rough.map(|r| -r); }
    println!("{:?}", single.assembly);
    let samples = published::samples(&home.join("validation/single-dwell"), &single);
    let models = vec![
        reduced::Model::new(single, Some(&other), samples),
        reduced::Model::new(case("crank-rocker"), None, vec![]),
        reduced::Model::new(own("cross-slide"), None, vec![]),
        reduced::Model::new(own("turning-rail"), None, vec![]),
        reduced::Model::new(case("slotted-rocker"), None, vec![]),
    ];
    for fault in std::iter::once(None).chain(reduced::Fault::ALL.map(Some)) {
        for m in &models {
            let v = m.judge(fault);
            println!("{:<60} {:<14} {:?}", fault.map_or("none", |f| f.words()), m.scene.name, v.map(|v| v.digits.map(|d| d.map_or(-1, |d| d as i32))));
        }
    }
}
