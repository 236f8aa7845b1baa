//! Kinetic energy and virtual work of the cases with several freedoms or loads: deliberate faults in what the
//! product says of its states must be seen.

use crate::world::{home, scene};
use dwell_findings::Finding;
use dwell_scene::Scene;
use dwell_study::{Judged, judge_case};
use dwell_verify::{State, judge_energies};

/// Two freedoms, massless and heavy links, springs and a motor's moment, a guide.
const CASES: [&str; 4] = ["five-bar", "boom", "andrews", "slider-crank"];
/// States that are judged, and the one with the fault.
const STATES: usize = 6;
const FAULTY: usize = 2;

struct Claims {
    scene: Scene,
    start: Vec<[f64; 3]>,
    states: Vec<State>,
    inertias: Vec<Vec<f64>>,
}

impl Claims {
    fn new(case: &str) -> Self {
        let scene = scene(case);
        let folder = home().join("validation").join(case);
        let judged: Judged = judge_case(&scene, &folder).unwrap_or_else(|e| panic!("{case}: {e}"));
        let some = || (0..STATES).map(|k| (2 * k + 1) * judged.drawn / (2 * STATES));
        Self {
            states: some().map(|k| judged.states[k].clone()).collect(),
            inertias: some().map(|k| judged.inertias[k].clone()).collect(),
            start: judged.start,
            scene,
        }
    }

    fn judged(&self) -> Vec<Finding> {
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        judge_energies(mechanism, masses, &self.start, &self.states, &self.inertias)
    }

    fn failed(&self) -> Vec<String> {
        let failed = self.judged().into_iter().filter(|f| !f.pass);
        failed.map(|f| f.key).collect()
    }
}

/// A fault, and the finding that must see it.
type Fault = (&'static str, fn(&mut Claims), &'static str);

const FAULTS: [Fault; 8] = [
    (
        "the sign of an action",
        |c| c.states[FAULTY].tau[0] *= -1.0,
        "state-lagrange",
    ),
    (
        "a billionth of an action",
        |c| c.states[FAULTY].tau[0] *= 1.0 + 1e-9,
        "state-lagrange",
    ),
    (
        "the sign of a reaction",
        |c| c.states[FAULTY].reactions[0] *= -1.0,
        "state-released",
    ),
    (
        "no terms of speed in the equation",
        |c| c.states[FAULTY].q_dot.fill(0.0),
        "state-released",
    ),
    (
        "no terms of acceleration in the equation",
        |c| c.states[FAULTY].q_ddot.fill(0.0),
        "state-released",
    ),
    (
        "a load of the other sign",
        |c| {
            for load in &mut c.states[FAULTY].loads {
                load.force = -load.force;
                load.couple = -load.couple;
            }
        },
        "state-released",
    ),
    (
        "a billionth of an inertia",
        |c| c.inertias[FAULTY][0] *= 1.0 + 1e-9,
        "state-inertia",
    ),
    (
        "a body's velocity",
        |c| {
            let last = c.states[FAULTY].velocity.len() - 1;
            c.states[FAULTY].velocity[last] = [0.0; 3];
        },
        "state-kinetic",
    ),
];

#[test]
fn faults_in_states_are_seen_by_their_energies() {
    for case in CASES {
        let sound = Claims::new(case);
        assert_eq!(sound.failed(), [""; 0], "{case}");
        for (name, fault, key) in FAULTS {
            let mut wrong = Claims {
                scene: sound.scene.clone(),
                start: sound.start.clone(),
                states: sound.states.clone(),
                inertias: sound.inertias.clone(),
            };
            fault(&mut wrong);
            // The slider-crank turns evenly.
            if case == "slider-crank"
                && wrong.states == sound.states
                && wrong.inertias == sound.inertias
            {
                continue;
            }
            let failed = wrong.failed();
            assert!(
                failed.iter().any(|f| f == key),
                "{case}, {name}: {failed:?}"
            );
        }
    }
}

/// The coupling of two freedoms.
#[test]
fn a_coupling_of_the_wrong_sign_is_seen() {
    for case in ["five-bar", "boom", "double-pendulum"] {
        let mut claims = Claims::new(case);
        claims.inertias[FAULTY][1] *= -1.0;
        assert!(
            claims.failed().contains(&"state-inertia".to_owned()),
            "{case}"
        );
    }
}

/// Where joints share the reactions there is none to be released, and the rest is judged.
#[test]
fn shared_reactions_are_left_out() {
    let claims = Claims::new("parallelogram-three-cranks");
    let findings = claims.judged();
    let keys: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
    assert_eq!(keys, ["state-inertia", "state-kinetic", "state-lagrange"]);
    assert!(findings.iter().all(|f| f.pass), "{findings:?}");
}
