//! Kinetic energy and virtual work of the cases with several freedoms or loads: deliberate faults in what the
//! product says of its states must be seen.

use dwell_findings::Finding;
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{repository_root, scene};
use dwell_validation::{CheckedStates, check_case};
use dwell_verify::{ClaimedState, Twist, check_energies};

/// Two freedoms, massless and heavy links, springs and a motor's moment, a guide.
const CASES: [&str; 4] = ["five-bar", "boom", "andrews", "slider-crank"];
/// States that are judged, and the one with the fault.
const STATES: usize = 6;
const MUTATED_STATE: usize = 2;

struct ClaimedStates {
    scene: PlaneScene,
    checked: CheckedStates,
}

impl ClaimedStates {
    fn new(case: &str) -> Self {
        let scene = scene(case);
        let folder = repository_root().join("validation").join(case);
        let mut checked = check_case(&scene, &folder).unwrap_or_else(|e| panic!("{case}: {e}"));
        let some = (0..STATES).map(|k| (2 * k + 1) * checked.drawn_count / (2 * STATES));
        checked.states = some.map(|k| checked.states[k].clone()).collect();
        Self { scene, checked }
    }

    fn mutated(&mut self) -> &mut ClaimedState {
        &mut self.checked.states[MUTATED_STATE]
    }

    fn findings(&self) -> Vec<Finding> {
        check_energies(&self.checked.assembled(&self.scene), &self.checked.states)
    }

    fn failed(&self) -> Vec<String> {
        let failed = self.findings().into_iter().filter(|f| !f.pass);
        failed.map(|f| f.key).collect()
    }
}

/// A fault, and the finding that must see it.
type Mutation = (&'static str, fn(&mut ClaimedState), &'static str);

const MUTATIONS: [Mutation; 8] = [
    (
        "the sign of an actuator force",
        |c| c.tau[0] *= -1.0,
        "state-lagrange",
    ),
    (
        "a billionth of an actuator force",
        |c| c.tau[0] *= 1.0 + 1e-9,
        "state-lagrange",
    ),
    (
        "the sign of a reaction",
        |c| c.reactions[0] *= -1.0,
        "state-released",
    ),
    (
        "no terms of speed in the equation",
        |c| c.q_dot.fill(0.0),
        "state-released",
    ),
    (
        "no terms of acceleration in the equation",
        |c| c.q_ddot.fill(0.0),
        "state-released",
    ),
    (
        "a load of the other sign",
        |c| {
            for load in &mut c.load_wrenches {
                load.force = -load.force;
                load.couple = -load.couple;
            }
        },
        "state-released",
    ),
    (
        "a billionth of an inertia",
        |c| c.inertias[0] *= 1.0 + 1e-9,
        "state-mass-matrix",
    ),
    (
        "a body's velocity",
        |c| {
            let last = c.velocities.len() - 1;
            c.velocities[last] = Twist::default();
        },
        "state-kinetic-energy",
    ),
];

#[test]
fn faults_in_states_are_seen_by_their_energies() {
    for case in CASES {
        let sound = ClaimedStates::new(case);
        assert_eq!(sound.failed(), [""; 0], "{case}");
        for (name, mutate, key) in MUTATIONS {
            let mut wrong = ClaimedStates {
                scene: sound.scene.clone(),
                checked: sound.checked.clone(),
            };
            mutate(wrong.mutated());
            // The slider-crank turns evenly.
            if case == "slider-crank" && wrong.checked == sound.checked {
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
        let mut claimed = ClaimedStates::new(case);
        claimed.mutated().inertias[1] *= -1.0;
        assert!(
            claimed.failed().contains(&"state-mass-matrix".to_owned()),
            "{case}"
        );
    }
}

/// Where joints share the reactions there is none to be released, and the rest is judged.
#[test]
fn shared_reactions_are_left_out() {
    let claimed = ClaimedStates::new("parallelogram-three-cranks");
    let findings = claimed.findings();
    let keys: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
    assert_eq!(
        keys,
        [
            "state-mass-matrix",
            "state-kinetic-energy",
            "state-lagrange"
        ]
    );
    assert!(findings.iter().all(|f| f.pass), "{findings:?}");
}
