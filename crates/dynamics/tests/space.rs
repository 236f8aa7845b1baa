//! The thirteen spatial references of `validation/spatial`: made by an independent program with 40 digits.
#![allow(clippy::expect_used, clippy::unwrap_used, clippy::panic, reason = "tests")]

mod space_reference;

use dwell_kinetostatics::space::LoadKind;
use space_reference::{Reference, number};

const ONE_COORDINATE: [&str; 12] = [
    "bennett",
    "bricard-a04",
    "double-hooke",
    "planar-oblique-4r",
    "planar-oblique-rcsr",
    "rssr-haug",
    "rssr",
    "rsur-haug",
    "rsur",
    "schatz",
    "slider-crank-haug",
    "wobble-plate",
];

/// The largest differences of one mechanism, relative to the largest of its kind.
#[derive(Default)]
struct Differences {
    position: f64,
    velocity: f64,
    acceleration: f64,
    m: f64,
    half_dm: f64,
    w: f64,
    reactions: f64,
    compared: usize,
}

#[test]
fn agrees_with_the_references() {
    for name in ONE_COORDINATE {
        let reference = Reference::read(name);
        let found = differences(&reference);
        let all = [found.position, found.velocity, found.acceleration, found.m, found.half_dm, found.w, found.reactions];
        let largest = all.into_iter().fold(0.0, f64::max);
        let compared = found.compared;
        println!("{name}: {} ({compared} reactions)", all.map(|d| format!("{d:.0e}")).join(" "));
        assert!(largest < 1e-12, "{name}: {largest:.1e}");
    }
}

fn differences(reference: &Reference) -> Differences {
    let (model, names) = reference.model();
    let mut found = Differences::default();
    let mut work = model.workspace::<f64>();
    let mut pose = model.plan().pose::<f64>();
    let mut out = model.coefficient_buffer::<f64>();
    let gravity = reference.gravity().map(LoadKind::Gravity);
    let mut scale = [0.0_f64; 3];
    let mut wrong = [0.0_f64; 3];
    let samples = reference.samples();
    for sample in samples {
        let q = number(&sample["q"]);
        model.reduce(q, &mut work, &mut out).unwrap_or_else(|e| panic!("{} at {q}: {e}", reference.name));
        let (mut w, mut c) = ([0.0], vec![0.0; names.len()]);
        if let Some(gravity) = &gravity {
            model.unit_load_response(&[q], gravity, &mut work, &mut w, &mut c).expect("a pose");
            let want = number(&sample["w"]["gravity"]);
            found.w = found.w.max((w[0] - want).abs() / reference.scale_of("w"));
        }
        found.m = found.m.max((out.m / number(&sample["m"]) - 1.0).abs());
        let half_dm = number(&sample["half_dm"]);
        found.half_dm = found.half_dm.max((out.half_dm - half_dm).abs() / number(&sample["m"]));
        for (k, (name, _)) in names.iter().enumerate() {
            let Some(reaction) = sample["reactions"].get(name) else { continue };
            let got = [out.a[k], out.b[k], c[k]];
            let want = [&reaction["a"], &reaction["b"], &reaction["c"]["gravity"]];
            for i in 0..3 {
                if want[i].is_null() {
                    continue;
                }
                let want = number(want[i]);
                scale[i] = scale[i].max(want.abs());
                if (got[i] - want).abs() > wrong[i] {
                    wrong[i] = (got[i] - want).abs();
                    if wrong[i] > 1e-9 { println!("  {name} {i} at q = {q}: {} for {want}", got[i]); }
                }
                found.compared += 1;
            }
        }
        model.plan().positions(&[q], &mut pose).expect("a pose");
        model.plan().velocities(&[1.0], &mut pose);
        model.plan().accelerations(&[0.0], &mut pose);
        let [p, v, a] = reference.motion_differences(model.plan(), &pose, sample);
        found.position = found.position.max(p);
        found.velocity = found.velocity.max(v);
        found.acceleration = found.acceleration.max(a);
    }
    for i in 0..3 {
        found.reactions = found.reactions.max(wrong[i] / scale[i].max(f64::MIN_POSITIVE));
    }
    let determined = model.determined(&[number(&samples[0]["q"])], &mut work).expect("a pose");
    for (k, (name, _)) in names.iter().enumerate() {
        let open = samples[0]["undetermined"].as_array().expect("a list").iter().any(|u| u == name.as_str());
        assert_eq!(determined[k], !open, "{}: {name}", reference.name);
    }
    found
}
