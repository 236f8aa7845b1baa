use dwell_dynamics::*;
use dwell_geometry::measure::Measured;
use dwell_geometry::{Actuator, Body, BodyId, Drive as Drives, Joint, JointKind, Mechanism, Start, Vec2, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass};
use std::f64::consts::{FRAC_PI_2, TAU};

fn bar(mass: f64, length: f64) -> Mass {
    Mass { mass, center: vec2(0.5 * length, 0.0), inertia: mass * length * length / 12.0 }
}
fn gravity() -> Load {
    Load { name: "gravity".into(), kind: LoadKind::Gravity { direction: vec2(0.0, -1.0) }, magnitude: Magnitude::Constant(9.81) }
}
fn body(name: &str) -> Body { Body { name: name.into() } }
fn pin(name: &str, bodies: [usize; 2], points: [Vec2; 2]) -> Joint {
    Joint { name: name.into(), bodies: bodies.map(BodyId), points, kind: JointKind::Revolute }
}
fn angle(name: &str, bodies: [usize; 2]) -> Actuator {
    Actuator { name: name.into(), bodies: bodies.map(BodyId), drive: Drives::Angle }
}

/// ground 0, crank 1, rod 2, piston 3.
fn slider_crank() -> (Mechanism, Vec<Mass>) {
    let m = Mechanism {
        bodies: ["ground", "crank", "rod", "piston"].map(body).to_vec(),
        ground: 0,
        joints: vec![
            pin("A", [0, 1], [Vec2::ZERO; 2]),
            pin("B", [1, 2], [vec2(0.1, 0.0), Vec2::ZERO]),
            pin("C", [2, 3], [vec2(0.35, 0.0), Vec2::ZERO]),
            Joint { name: "D".into(), bodies: [BodyId(0), BodyId(3)], points: [vec2(0.0, 0.02), Vec2::ZERO], kind: JointKind::Prismatic { axes: [vec2(1.0, 0.0); 2] } },
        ],
        actuators: vec![],
        relations: vec![],
    };
    let mut masses = vec![Mass::default(), bar(1.0, 0.1), bar(0.8, 0.35), Mass { mass: 0.6, center: Vec2::ZERO, inertia: 1e-3 }];
    masses[1].inertia = 0.2;
    (m, masses)
}

fn energies(atlas: &Atlas<'_>, journey: &Journey) -> (f64, f64) {
    let (mut low, mut high, mut most) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for leg in &journey.legs {
        let machine = &atlas.charts()[leg.chart].machine;
        let mut work = machine.work();
        for p in &leg.trace.steps {
            machine.evaluate(p.t, &p.y, &mut work).expect("a state");
            let [k, v] = machine.energy(&work);
            most = most.max(k);
            low = low.min(k + v);
            high = high.max(k + v);
        }
    }
    (high - low, most)
}

fn compare(mechanism: Mechanism, masses: Vec<Mass>, crank: Actuator, rocking: Actuator, q0: f64, rough: Vec<Option<f64>>, speed: f64, end: f64) {
    let loads = [gravity()];
    let options = Options { every: Some(end / 500.0), ..Options::new(Method::Tsit45, 1e-12) };
    let by_crank = Mechanism { actuators: vec![crank.clone()], ..mechanism.clone() };
    let start = Start { q: vec![q0], rough };
    let site = Site { mechanism: &by_crank, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &[] };
    let mut one = Atlas::new(site).expect("an atlas");
    let p = Point { t: 0.0, y: one.charts()[0].machine.start(&[q0], &[speed]) };
    let turns = Event { trigger: Trigger::WholeTurn(one.own()), stop: false };
    let direct = one.follow(&p, end, &options, &[turns]).expect("a run");
    assert_eq!(direct.failed, None);
    assert_eq!(direct.legs.len(), 1);
    let plain = follow(&one.charts()[0].machine, &one.charts()[0].shown, &p, end, &options, &[turns]).expect("a run");
    assert_eq!(plain, direct.legs[0].trace);
    // The same in the other coordinate.
    let machine = &one.charts()[0].machine;
    let mut work = machine.work();
    machine.evaluate(0.0, &p.y, &mut work).expect("a state");
    let other = Mechanism { actuators: vec![rocking.clone()], ..mechanism.clone() };
    let measured = Measured::find(&other, rocking.coordinate()).expect("a coordinate");
    let [s, s_dot, _] = work.inner.states().measure(measured);
    let rough = (0..4).map(|b| Some(work.inner.states().body(BodyId(b)).turn.angle())).collect();
    let start = Start { q: vec![s], rough };
    let site = Site { mechanism: &other, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &[] };
    let mut two = Atlas::new(site).expect("an atlas");
    let p = Point { t: 0.0, y: two.charts()[0].machine.start(&[s], &[s_dot]) };
    let crank = one.own();
    let turns = [Event { trigger: Trigger::WholeTurn(crank), stop: false }, Event { trigger: Trigger::Turns(two.own()), stop: false }];
    let journey = two.follow(&p, end, &options, &turns).expect("a run");
    println!("{:?} {:?} failed {:?}", journey.changes, two.charts().iter().map(|c| &c.name).collect::<Vec<_>>(), journey.failed);
    assert_eq!(journey.failed, None);
    assert!(!journey.changes.is_empty());
    let track = two.track(&journey, crank).expect("a track");
    let samples: Vec<[f64; 3]> = track.samples.concat();
    assert_eq!(samples.len(), direct.legs[0].trace.samples.len());
    let from = samples[0][0] - q0;
    let mut worst = 0.0_f64;
    for (a, b) in samples.iter().zip(&direct.legs[0].trace.samples) {
        worst = worst.max((a[0] - from - b.y[0]).abs());
    }
    let passed: Vec<f64> = journey.occurrences().filter(|o| o.1.event == 0).map(|o| o.1.at.t).collect();
    let wanted: Vec<f64> = direct.occurrences().map(|o| o.1.at.t).collect();
    println!("worst {worst:e}, turns {}, direct {}", passed.len(), wanted.len());
    println!("turned {}", journey.occurrences().filter(|o| o.1.event == 1).count());
    assert!(wanted.len() >= 10);
    assert_eq!(passed.len(), wanted.len());
    assert!(passed.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-9));
    let (lost, most) = energies(&two, &journey);
    println!("energy {lost:e} of {most}");
    assert!(worst < 1e-8);
    assert!(lost < 1e-9 * most);
    // The own coordinate has no seam: it is what its measurement says, within its range.
    let own = two.track(&journey, two.own()).expect("a track");
    let own: Vec<[f64; 3]> = own.samples.concat();
    let every = end / 500.0;
    for w in own.windows(2) {
        let predicted = 0.5 * (w[0][1] + w[1][1]) * every - (w[1][2] - w[0][2]) * every * every / 12.0;
        assert!((w[1][0] - w[0][0] - predicted).abs() < 1e-3, "{w:?}");
    }
}

#[test]
fn slider() {
    let (m, masses) = slider_crank();
    let length = Actuator { name: "s".into(), bodies: [BodyId(0), BodyId(3)], drive: Drives::Length([vec2(-0.1, 0.02), Vec2::ZERO]) };
    compare(m, masses, angle("phi", [0, 1]), length, 1.0, vec![None, None, Some(-0.2), None], 7.0, 10.5);
}

#[test]
fn rocker() {
    let m = Mechanism {
        bodies: ["ground", "crank", "coupler", "rocker"].map(body).to_vec(),
        joints: vec![
            pin("A", [0, 1], [Vec2::ZERO; 2]),
            pin("B", [1, 2], [vec2(0.1, 0.0), Vec2::ZERO]),
            pin("C", [2, 3], [vec2(0.35, 0.0), vec2(0.25, 0.0)]),
            pin("D", [0, 3], [vec2(0.4, 0.0), Vec2::ZERO]),
        ],
        ..Mechanism::default()
    };
    let mut masses = vec![Mass::default(), bar(1.0, 0.1), bar(0.8, 0.35), bar(0.5, 0.25)];
    masses[1].inertia = 0.2;
    compare(m, masses, angle("phi", [0, 1]), angle("psi", [0, 3]), 1.0, vec![None, None, Some(0.2), Some(1.5)], 7.0, 10.5);
}

fn chain(n: usize) -> Mechanism {
    let tip = vec2(1.0, 0.0);
    let mut chain = Mechanism {
        bodies: vec![body("ground"), body("link0")],
        joints: vec![pin("A0", [0, 1], [Vec2::ZERO; 2])],
        actuators: vec![angle("theta", [0, 1])],
        ..Mechanism::default()
    };
    for i in 1..=n {
        let [before, coupler, link] = [2 * i - 1, 2 * i, 2 * i + 1];
        chain.bodies.extend([body(&format!("coupler{i}")), body(&format!("link{i}"))]);
        chain.joints.extend([
            pin(&format!("B{i}"), [before, coupler], [tip, Vec2::ZERO]),
            pin(&format!("C{i}"), [coupler, link], [tip, tip]),
            pin(&format!("A{i}"), [0, link], [vec2(i as f64, 0.0), Vec2::ZERO]),
        ]);
    }
    chain
}

#[test]
fn chains() {
    for n in [1, 2, 40] {
        let m = chain(n);
        let mut masses = vec![bar(1.0, 1.0); m.bodies.len()];
        masses[0] = Mass::default();
        let start = Start { q: vec![FRAC_PI_2], rough: (0..m.bodies.len()).map(|b| Some(if b % 2 == 1 { FRAC_PI_2 } else { 0.0 })).collect() };
        let loads = [gravity()];
        let reactions = m.reactions();
        let site = Site { mechanism: &m, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &reactions };
        let mut atlas = Atlas::new(site).expect("an atlas");
        for (method, tolerance) in [(Method::Tsit45, 1e-12), (Method::Bdf, 1e-12)] {
            let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[FRAC_PI_2], &[-1.0]) };
            let options = Options { every: Some(0.5), ..Options::new(method, tolerance) };
            let journey = atlas.follow(&p, 20.0, &options, &[]).expect("a run");
            println!("n {n} failed {:?} refused {:?} changes {} charts {}", journey.failed, atlas.refused(), journey.changes.len(), atlas.charts().len());
            for b in atlas.bridges() {
                println!("center {} half {} reach {} gap {:e} mobility {} not unique {}", b.center, b.half, b.reach, b.gap, b.mobility, b.not_unique.len());
            }
            assert_eq!(journey.failed, None);
            let (lost, most) = energies(&atlas, &journey);
            let (_, last) = journey.last().expect("a state");
            println!("{:?} energy {lost:e} of {most}; end {:?} {:?}", method, last, journey.statistics());
            let track = atlas.track(&journey, atlas.own()).expect("a track");
            for row in track.samples.concat().iter().take(3) { println!("{row:?}"); }
            assert!(lost < 1e-9 * most);
        }
    }
    let _ = TAU;
}
