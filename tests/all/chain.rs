//! IFToMM's A02: a chain of N equal four-bars, which its parallel links make a pendulum. What a pose
//! costs is counted in operations and grows as N.

use crate::changes::Setup;
use crate::sketch::Sketch;
use dwell_geometry::{BodyId, vec2};
use dwell_kinetostatics::{Mass, Model};

/// The chain as its definition has it: links 1 m and 1 kg, ground pivots 1 m apart, θ = q.
pub(crate) fn chain(n: usize) -> Setup {
    let mut s = Sketch::new();
    let bar = Mass {
        mass: 1.0,
        center: vec2(0.5, 0.0),
        inertia: 1.0 / 12.0,
    };
    let up = std::f64::consts::FRAC_PI_2;
    let mut last: Option<BodyId> = None;
    for i in 0..=n {
        let link = s.mass(&format!("link{i}"), bar, Some(up));
        let pivot = [i as f64, 0.0];
        s.revolute(
            &format!("A{i}"),
            (Sketch::GROUND, pivot),
            (link, [0.0, 0.0]),
        );
        if let Some(before) = last {
            let coupler = s.mass(&format!("coupler{i}"), bar, Some(0.0));
            s.revolute(
                &format!("B{i}"),
                (before, [1.0, 0.0]),
                (coupler, [0.0, 0.0]),
            );
            s.revolute(&format!("C{i}"), (coupler, [1.0, 0.0]), (link, [1.0, 0.0]));
        } else {
            s.drive("theta", [Sketch::GROUND, link]);
        }
        last = Some(link);
    }
    s.setup(&[up])
}

#[test]
fn time() {
    for n in [1, 10, 100, 1000, 10000] {
        let t0 = std::time::Instant::now();
        let setup = chain(n);
        let model = Model::new(
            &setup.mechanism,
            &setup.masses,
            &setup.start,
            &setup.mechanism.reactions(),
        )
        .unwrap();
        let t1 = std::time::Instant::now();
        let mut work = model.workspace::<f64>();
        let mut actions = model.actions();
        let times = 20;
        for k in 0..times {
            let q = 1.0 + 0.01 * f64::from(k);
            model
                .act(&[q], &[1.0], &[0.5], &mut work, &mut actions)
                .unwrap();
        }
        println!(
            "{n}: build {:?}, pose {:?}",
            t1 - t0,
            t1.elapsed() / times as u32
        );
    }
}
