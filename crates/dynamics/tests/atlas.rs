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
    compare_under(mechanism, masses, crank, rocking, q0, rough, speed, end, &[gravity()], &[], 1);
}

fn compare_under(mechanism: Mechanism, masses: Vec<Mass>, crank: Actuator, rocking: Actuator, q0: f64, rough: Vec<Option<f64>>, speed: f64, end: f64, loads: &[Load], drives: &[Drive], least: usize) {
    let options = Options { every: Some(end / 500.0), ..Options::new(Method::Tsit45, 1e-12) };
    let by_crank = Mechanism { actuators: vec![crank.clone()], ..mechanism.clone() };
    let start = Start { q: vec![q0], rough };
    let site = Site { mechanism: &by_crank, masses: &masses, start: &start, loads, drives, reactions: &[] };
    let mut one = Atlas::new(site).expect("an atlas");
    let p = Point { t: 0.0, y: one.charts()[0].machine.start(&[q0], &[speed]) };
    let turns = Event { trigger: Trigger::WholeTurn(one.own()), stop: false };
    let direct = one.follow(&p, end, &options, &[turns]).expect("a run");
    assert_eq!(direct.failed, None);
    if least > 0 {
        assert_eq!(direct.legs.len(), 1);
        let plain = follow(&one.charts()[0].machine, &one.charts()[0].shown, &p, end, &options, &[turns]).expect("a run");
        assert_eq!(plain, direct.legs[0].trace);
    }
    let wanted_samples: Vec<Point> = direct.legs.iter().flat_map(|l| l.trace.samples.clone()).collect();
    // The same in the other coordinate.
    let machine = &one.charts()[0].machine;
    let mut work = machine.work();
    machine.evaluate(0.0, &p.y, &mut work).expect("a state");
    let other = Mechanism { actuators: vec![rocking.clone()], ..mechanism.clone() };
    let measured = Measured::find(&other, rocking.coordinate()).expect("a coordinate");
    let [s, s_dot, _] = work.inner.states().measure(measured);
    let rough = (0..4).map(|b| Some(work.inner.states().body(BodyId(b)).turn.angle())).collect();
    let start = Start { q: vec![s], rough };
    let site = Site { mechanism: &other, masses: &masses, start: &start, loads, drives, reactions: &[] };
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
    assert_eq!(samples.len(), wanted_samples.len());
    let from = samples[0][0] - q0;
    let mut worst = 0.0_f64;
    for (a, b) in samples.iter().zip(&wanted_samples) {
        worst = worst.max((a[0] - from - b.y[0]).abs());
        if least == 0 { assert!((a[0] - from - b.y[0]).abs() < 1e-8, "{a:?} {b:?}"); }
    }
    let passed: Vec<f64> = journey.occurrences().filter(|o| o.1.event == 0).map(|o| o.1.at.t).collect();
    let wanted: Vec<f64> = direct.occurrences().map(|o| o.1.at.t).collect();
    println!("worst {worst:e}, turns {}, direct {}", passed.len(), wanted.len());
    println!("turned {}", journey.occurrences().filter(|o| o.1.event == 1).count());
    assert!(wanted.len() >= 10 || least == 0 || !drives.is_empty());
    assert_eq!(passed.len(), wanted.len());
    assert!(passed.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-9));
    let (lost, most) = energies(&two, &journey);
    println!("energy {lost:e} of {most}");
    assert!(worst < 1e-8);
    assert!(lost < 1e-9 * most || !drives.is_empty());
    // The own coordinate has no seam: it is what its measurement says, within its range.
    let own = two.track(&journey, two.own()).expect("a track");
    let own: Vec<[f64; 3]> = own.samples.concat();
    let every = end / 500.0;
    let mut seam = 0.0_f64;
    for w in own.windows(2) {
        let predicted = 0.5 * (w[0][1] + w[1][1]) * every - (w[1][2] - w[0][2]) * every * every / 12.0;
        seam = seam.max((w[1][0] - w[0][0] - predicted).abs());
    }
    println!("seam {seam:e}");
    assert!(seam < 1e-5);
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

/// N equal four-bars from the state given.
fn along_a_chain(n: usize, [q, q_dot]: [f64; 2], end: f64, every: f64, method: Method, check: impl Fn(&Atlas<'_>, &Journey)) {
    let m = chain(n);
    let mut masses = vec![bar(1.0, 1.0); m.bodies.len()];
    masses[0] = Mass::default();
    let start = Start { q: vec![q], rough: (0..m.bodies.len()).map(|b| Some(if b % 2 == 1 { q } else { 0.0 })).collect() };
    let loads = [gravity()];
    let reactions = m.reactions();
    let site = Site { mechanism: &m, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &reactions };
    let mut atlas = Atlas::new(site).expect("an atlas");
    let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[q], &[q_dot]) };
    let options = Options { every: Some(every), ..Options::new(method, 1e-12) };
    let journey = atlas.follow(&p, end, &options, &[]).expect("a run");
    println!("n {n} failed {:?} refused {:?} changes {} charts {}", journey.failed, atlas.refused(), journey.changes.len(), atlas.charts().len());
    for b in atlas.bridges() {
        println!("center {} half {} reach {} gap {:e} mobility {} not unique {}", b.center, b.half, b.reach, b.gap, b.mobility, b.not_unique.len());
    }
    assert_eq!(journey.failed, None);
    let (lost, most) = energies(&atlas, &journey);
    println!("{method:?} energy {lost:e} of {most} {:?}", journey.statistics());
    assert!(lost < 1e-9 * most);
    check(&atlas, &journey);
}

#[test]
fn chains() {
    for (n, q) in [(1, -63.11884409590109_f64), (2, -62.25787306635122), (40, -61.68449904139603)] {
        for (method, within) in [(Method::Tsit45, 1e-8), (Method::Bdf, 1e-6)] {
            along_a_chain(n, [FRAC_PI_2, -1.0], 20.0, 0.5, method, |_, journey| {
                let (_, last) = journey.last().expect("a state");
                println!("{:e}", last.y[0] - q);
                assert!((last.y[0] - q).abs() < within);
            });
        }
    }
}

/// It swings between two flat positions, turning within the windows, against the pendulum that it is.
#[test]
fn swings() {
    for q0 in [0.05, 0.5] {
        let (n, end, every) = (5_usize, 8.0, 0.05);
        let m = Mechanism { bodies: vec![body("ground"), body("link")], joints: vec![pin("A", [0, 1], [Vec2::ZERO; 2])], actuators: vec![angle("q", [0, 1])], ..Mechanism::default() };
        let links = n as f64;
        // m = (4N + 1)/3 and V = (3N + 1)/2 g sin q.
        let mass = Mass { mass: 1.0, center: vec2(0.5 * (3.0 * links + 1.0), 0.0), inertia: 0.0 };
        let rest = (4.0 * links + 1.0) / 3.0;
        let arm = 0.5 * (3.0 * links + 1.0);
        // Ten times the mass at a tenth of the arm: the same moment, less inertia.
        let mass = Mass { mass: 10.0 * mass.mass, center: vec2(arm / 10.0, 0.0), inertia: rest - arm * arm / 10.0 };
        assert!(mass.inertia > 0.0 || n > 3, "{mass:?}");
        let mass = Mass { mass: 100.0, center: vec2(arm / 100.0, 0.0), inertia: rest - arm * arm / 100.0 };
        let start = Start { q: vec![q0], rough: vec![None; 2] };
        let loads = [gravity()];
        let masses = [Mass::default(), mass];
        let site = Site { mechanism: &m, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &[] };
        let mut one = Atlas::new(site).expect("an atlas");
        let p = Point { t: 0.0, y: one.charts()[0].machine.start(&[q0], &[0.0]) };
        let options = Options { every: Some(every), ..Options::new(Method::Tsit45, 1e-12) };
        let pendulum = one.follow(&p, end, &options, &[]).expect("a run");
        along_a_chain(n, [q0, 0.0], end, every, Method::Tsit45, |atlas, journey| {
            let track = atlas.track(journey, atlas.own()).expect("a track").samples.concat();
            let wanted = &pendulum.legs[0].trace.samples;
            assert_eq!(track.len(), wanted.len());
            let worst = track.iter().zip(wanted).fold(0.0_f64, |w, (a, b)| w.max((a[0] - b.y[0]).abs()));
            println!("worst {worst:e}");
            assert!(worst < 1e-9);
        });
    }
}

/// 1 + 3 = 2 + 2: one flat position a turn, where the angles are curved.
#[test]
fn galloway_like() {
    let m = Mechanism {
        bodies: ["ground", "crank", "coupler", "rocker"].map(body).to_vec(),
        joints: vec![
            pin("A", [0, 1], [Vec2::ZERO; 2]),
            pin("B", [1, 2], [vec2(0.1, 0.0), Vec2::ZERO]),
            pin("C", [2, 3], [vec2(0.22, 0.0), vec2(0.18, 0.0)]),
            pin("D", [0, 3], [vec2(0.3, 0.0), Vec2::ZERO]),
        ],
        actuators: vec![angle("phi", [0, 1])],
        ..Mechanism::default()
    };
    let masses = vec![Mass::default(), Mass { inertia: 0.1, ..bar(1.0, 0.1) }, bar(0.8, 0.22), bar(0.5, 0.18)];
    let start = Start { q: vec![1.0], rough: vec![None, None, Some(0.5), Some(1.5)] };
    let loads = [gravity()];
    let reactions = m.reactions();
    let site = Site { mechanism: &m, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &reactions };
    let mut atlas = Atlas::new(site).expect("an atlas");
    println!("{:?} {:?}", atlas.charts()[0].machine.model().plan().range(), atlas.charts()[0].machine.model().plan().ends());
    for speed in [9.0, -9.0] {
        let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[1.0], &[speed]) };
        let options = Options { every: Some(0.01), ..Options::new(Method::Tsit45, 1e-12) };
        let journey = atlas.follow(&p, 6.0, &options, &[]).expect("a run");
        for b in atlas.bridges() {
            println!("center {} half {} reach {} gap {:e} mobility {} not unique {}", b.center, b.half, b.reach, b.gap, b.mobility, b.not_unique.len());
        }
        println!("{:?} {:?} {}", journey.failed, atlas.refused(), journey.changes.len());
        assert_eq!(journey.failed, None);
        let (lost, most) = energies(&atlas, &journey);
        println!("energy {lost:e} of {most} {:?}", journey.statistics());
        let rocker = atlas.track(&journey, Measured::Angle([BodyId(0), BodyId(3)])).expect("a track").samples.concat();
        let end = rocker.last().expect("a sample");
        println!("rocker {end:?}");
        assert!(lost < 1e-9 * most);
    }
    let _ = TAU;
}

fn torsion(name: &str, bodies: [usize; 2]) -> Load {
    Load { name: name.into(), kind: LoadKind::TorsionSpring { bodies: bodies.map(BodyId), free: 0.3 }, magnitude: Magnitude::Constant(0.4) }
}
fn motor(m: &Mechanism, bodies: [usize; 2]) -> Drive {
    let _ = m;
    Drive { name: "motor".into(), coordinate: angle("x", bodies).coordinate(), kind: DriveKind::Motor(Motor { voltage: Magnitude::Constant(12.0), constant: 0.1, resistance: 2.0, inductance: 0.05, ratio: 3.0, inertia: 0.001 }) }
}
fn crank_rocker() -> (Mechanism, Vec<Mass>) {
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
    (m, masses)
}

#[test]
fn rocker_with_torsion() {
    let (m, masses) = crank_rocker();
    let loads = [gravity(), torsion("t", [0, 3])];
    compare_under(m, masses, angle("phi", [0, 1]), angle("psi", [0, 3]), 1.0, vec![None, None, Some(0.2), Some(1.5)], 7.0, 10.5, &loads, &[], 1);
}

#[test]
fn rocker_with_wound_crank_and_motor() {
    let (m, masses) = crank_rocker();
    let loads = [gravity(), torsion("t", [0, 1])];
    let drives = [motor(&m, [0, 1])];
    compare_under(m, masses, angle("phi", [0, 1]), angle("psi", [0, 3]), 1.0, vec![None, None, Some(0.2), Some(1.5)], -7.0, 5.5, &loads, &drives, 1);
}

#[test]
fn diagonal() {
    let m = Mechanism {
        bodies: ["ground", "crank", "coupler", "rocker"].map(body).to_vec(),
        joints: vec![
            pin("A", [0, 1], [Vec2::ZERO; 2]),
            pin("B", [1, 2], [vec2(0.2, 0.0), Vec2::ZERO]),
            pin("C", [2, 3], [vec2(0.4, 0.0), vec2(0.2, 0.0)]),
            pin("D", [0, 3], [vec2(0.4, 0.0), Vec2::ZERO]),
        ],
        ..Mechanism::default()
    };
    let masses = vec![Mass::default(), bar(1.0, 0.2), bar(0.8, 0.4), bar(0.5, 0.2)];
    let length = Actuator { name: "s".into(), bodies: [BodyId(0), BodyId(2)], drive: Drives::Length([Vec2::ZERO, vec2(0.4, 0.0)]) };
    compare_under(m, masses, angle("phi", [0, 1]), length, 1.0, vec![None, None, Some(0.0), Some(1.0)], 14.0, 5.0, &[gravity()], &[], 0);
}

#[test]
fn motor_on_a_parallelogram() {
    let damper = |bodies: [usize; 2]| Load { name: "d".into(), kind: LoadKind::TorsionDamper { bodies: bodies.map(BodyId) }, magnitude: Magnitude::Constant(0.5) };
    let run = |m: Mechanism, masses: Vec<Mass>, rough: Vec<Option<f64>>, on: [[usize; 2]; 2]| {
        let start = Start { q: vec![1.0], rough };
        let loads = [gravity(), damper(on[0])];
        let drives = [motor(&m, on[1])];
        let site = Site { mechanism: &m, masses: &masses, start: &start, loads: &loads, drives: &drives, reactions: &[] };
        let mut atlas = Atlas::new(site).expect("an atlas");
        let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[1.0], &[-6.0]) };
        let options = Options { every: Some(0.02), ..Options::new(Method::Tsit45, 1e-12) };
        let journey = atlas.follow(&p, 4.0, &options, &[]).expect("a run");
        assert_eq!(journey.failed, None, "{:?}", atlas.refused());
        println!("{}", journey.changes.len());
        journey.legs.iter().flat_map(|l| l.trace.samples.clone()).collect::<Vec<_>>()
    };
    let m = chain(1);
    let one = run(m, vec![Mass::default(), bar(1.0, 1.0), bar(1.0, 1.0), bar(1.0, 1.0)], vec![None, Some(1.0), Some(0.0), Some(1.0)], [[0, 3], [0, 1]]);
    let m = Mechanism { bodies: vec![body("ground"), body("link")], joints: vec![pin("A", [0, 1], [Vec2::ZERO; 2])], actuators: vec![angle("q", [0, 1])], ..Mechanism::default() };
    let link = Mass { mass: 20.0, center: vec2(0.1, 0.0), inertia: 5.0 / 3.0 - 0.2 };
    let two = run(m, vec![Mass::default(), link], vec![None; 2], [[0, 1], [0, 1]]);
    let mut worst = 0.0_f64;
    for (a, b) in one.iter().zip(&two) {
        worst = a.y.iter().zip(&b.y).fold(worst, |w, (a, b)| w.max((a - b).abs()));
    }
    println!("{} {} {worst:e} {:?}", one.len(), two.len(), one.last());
    assert_eq!(one.len(), two.len());
    assert!(worst < 1e-9);
}

#[test]
fn loose() {
    let (m, masses) = slider_crank();
    for (method, tolerance) in [(Method::Tsit45, 1e-2), (Method::Tsit45, 1e-3), (Method::Tsit45, 1e-5), (Method::Bdf, 1e-3), (Method::TrBdf2, 1e-2), (Method::Esdirk34, 1e-2)] {
        let length = Actuator { name: "s".into(), bodies: [BodyId(0), BodyId(3)], drive: Drives::Length([vec2(-0.1, 0.02), Vec2::ZERO]) };
        let mechanism = Mechanism { actuators: vec![length], ..m.clone() };
        let s = 0.1 + 0.35;
        let start = Start { q: vec![s], rough: vec![None, Some(1.0), Some(-0.2), None] };
        let site = Site { mechanism: &mechanism, masses: &masses, start: &start, loads: &[], drives: &[], reactions: &[] };
        let mut atlas = Atlas::new(site).expect("an atlas");
        let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[s], &[-0.4]) };
        let crank = Measured::Angle([BodyId(0), BodyId(1)]);
        let journey = atlas.follow(&p, 20.0, &Options::new(method, tolerance), &[]).expect("a run");
        println!("{method:?} {tolerance} {:?} {:?} steps {:?}", journey.failed, journey.changes, journey.legs.iter().map(|l| l.trace.steps.len()).collect::<Vec<_>>());
        assert_eq!(journey.failed, None);
        let track = atlas.track(&journey, crank).expect("a track").steps.concat();
        println!("{:?} {:?} {:?}", track.last(), &track[..6], journey.legs[0].trace.steps);
        assert!(track.windows(2).all(|w| w[1][0] >= w[0][0]));
    }
}

/// The forces of all pins by statics from the free end: A0, then B, C, A of every four-bar.
fn by_hand(n: usize, [theta, omega, alpha]: [f64; 3]) -> Vec<Vec2> {
    let e = Vec2::from_angle(theta);
    let g = vec2(0.0, -9.81);
    let tip = e.perp() * alpha - e * (omega * omega);
    let pull = 0.5 * (g.y - tip.y);
    let (mut next, mut forces) = (Vec2::ZERO, Vec::new());
    for _ in 0..n {
        let turning = e.x * (pull - next.y) + 0.5 * e.cross(g) - alpha / 3.0;
        let c = vec2(next.x + turning / e.y, pull);
        let b = c + tip - g;
        forces.extend([tip * 0.5 - g - c + next, c, b]);
        next = b;
    }
    forces.push(tip * 0.5 - g + next);
    forces.reverse();
    forces
}

#[test]
fn reactions_across() {
    let n = 5;
    let m = chain(n);
    let mut masses = vec![bar(1.0, 1.0); m.bodies.len()];
    masses[0] = Mass::default();
    let start = Start { q: vec![FRAC_PI_2], rough: (0..m.bodies.len()).map(|b| Some(if b % 2 == 1 { FRAC_PI_2 } else { 0.0 })).collect() };
    let loads = [gravity()];
    let reactions = m.reactions();
    let site = Site { mechanism: &m, masses: &masses, start: &start, loads: &loads, drives: &[], reactions: &reactions };
    let mut atlas = Atlas::new(site).expect("an atlas");
    let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[FRAC_PI_2], &[-1.0]) };
    let journey = atlas.follow(&p, 1.5, &Options::new(Method::Tsit45, 1e-12), &[]).expect("a run");
    assert_eq!(journey.failed, None);
    let chart = &atlas.charts()[0];
    let (machine, shown) = (&chart.machine, &chart.shown);
    let (mut work, mut all, mut actions) = (machine.work(), shown.workspace(), shown.actions());
    let half = atlas.bridges().next().expect("a bridge").half;
    for (part, inside) in [(-0.9, true), (-0.3, true), (0.0, true), (0.5, true), (0.99, true), (1.01, false)] {
        let y = [part * half, -5.0];
        machine.evaluate(0.0, &y, &mut work).expect("a state");
        machine.show(shown, 0.0, &work, &mut all, &mut actions).expect("reactions");
        let forces = by_hand(n, [y[0], y[1], work.q_ddot[0]]);
        let mut worst = [0.0_f64; 2];
        for (got, force) in actions.reactions.chunks_exact(2).zip(&forces) {
            assert_eq!(got[0].is_nan(), inside);
            if !inside { worst[0] = worst[0].max((got[0] - force.x).abs()); }
            worst[1] = worst[1].max((got[1] - force.y).abs());
        }
        println!("{part} {worst:?} q_ddot {}", work.q_ddot[0]);
        assert!(worst[1] < 1e-9 && worst[0] < 1e-8);
        // Of a pendulum (4N + 1)/3 q'' = -(3N + 1)/2 g cos q.
        let expected = -8.0 * 9.81 * y[0].cos() / 7.0;
        assert!((work.q_ddot[0] - expected).abs() < 1e-9);
    }
}

/// A lever on a cylinder passes its dead point so fast that a step leads right over it.
#[test]
fn a_fold_in_one_step() {
    let mechanism = Mechanism {
        bodies: ["ground", "lever"].map(body).to_vec(),
        joints: vec![pin("A", [0, 1], [Vec2::ZERO; 2])],
        actuators: vec![Actuator { name: "s".into(), bodies: [BodyId(0), BodyId(1)], drive: Drives::Length([vec2(0.9, 0.0), vec2(1.0, 0.0)]) }],
        ..Mechanism::default()
    };
    let masses = vec![Mass::default(), Mass { mass: 1.0, center: Vec2::ZERO, inertia: 0.3 }];
    for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        for method in Method::ALL {
            let s = 1.81_f64 - 1.8 * 1.0_f64.cos();
            let s = s.sqrt();
            let start = Start { q: vec![s], rough: vec![None, Some(1.0)] };
            let site = Site { mechanism: &mechanism, masses: &masses, start: &start, loads: &[], drives: &[], reactions: &[] };
            let mut atlas = Atlas::new(site).expect("an atlas");
            let speed = -0.9 * 1.0_f64.sin() / s;
            let p = Point { t: 0.0, y: atlas.charts()[0].machine.start(&[s], &[speed]) };
            let journey = atlas.follow(&p, 6.0, &Options::new(method, tolerance), &[]).expect("a run");
            let track = atlas.track(&journey, Measured::Angle([BodyId(0), BodyId(1)])).expect("a track").steps.concat();
            let end = track.last().expect("a step");
            println!("{method:?} {tolerance} {:?} {:?} steps {:?} end {:?}", journey.failed, journey.changes, journey.legs.iter().map(|l| l.trace.steps.len()).collect::<Vec<_>>(), end);
            assert_eq!(journey.failed, None);
            assert!(end[1] < -0.1 && end[0] < -1.0, "{end:?}");
        }
    }
}
