//! Kinetic energy and virtual work of the cases with several freedoms or loads: deliberate faults in what the
//! product says of its states must be seen.

use dwell_findings::Finding;
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{repository_root, scene};
use dwell_validation::{CheckedStates, check_case};
use dwell_verify::{ClaimedState, check_energies};

/// Two freedoms, massless and heavy links, springs and a motor's moment, a guide.
const CASES: [&str; 4] = ["five-bar", "boom", "andrews", "slider-crank"];
/// States that are judged, and the one with the fault.
const STATES: usize = 6;
const MUTATED_STATE: usize = 2;

struct ClaimedStates {
    scene: PlaneScene,
    start: Vec<[f64; 3]>,
    states: Vec<ClaimedState>,
    mass_matrices: Vec<Vec<f64>>,
}

impl ClaimedStates {
    fn new(case: &str) -> Self {
        let scene = scene(case);
        let folder = repository_root().join("validation").join(case);
        let checked: CheckedStates =
            check_case(&scene, &folder).unwrap_or_else(|e| panic!("{case}: {e}"));
        let some = || (0..STATES).map(|k| (2 * k + 1) * checked.drawn_count / (2 * STATES));
        Self {
            states: some().map(|k| checked.states[k].clone()).collect(),
            mass_matrices: some().map(|k| checked.mass_matrices[k].clone()).collect(),
            start: checked.assembly_poses,
            scene,
        }
    }

    fn findings(&self) -> Vec<Finding> {
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        check_energies(
            mechanism,
            masses,
            &self.start,
            &self.states,
            &self.mass_matrices,
        )
    }

    fn failed(&self) -> Vec<String> {
        let failed = self.findings().into_iter().filter(|f| !f.pass);
        failed.map(|f| f.key).collect()
    }
}

/// A fault, and the finding that must see it.
type Mutation = (&'static str, fn(&mut ClaimedStates), &'static str);

const MUTATIONS: [Mutation; 8] = [
    (
        "the sign of an actuator force",
        |c| c.states[MUTATED_STATE].tau[0] *= -1.0,
        "state-lagrange",
    ),
    (
        "a billionth of an actuator force",
        |c| c.states[MUTATED_STATE].tau[0] *= 1.0 + 1e-9,
        "state-lagrange",
    ),
    (
        "the sign of a reaction",
        |c| c.states[MUTATED_STATE].reactions[0] *= -1.0,
        "state-released",
    ),
    (
        "no terms of speed in the equation",
        |c| c.states[MUTATED_STATE].q_dot.fill(0.0),
        "state-released",
    ),
    (
        "no terms of acceleration in the equation",
        |c| c.states[MUTATED_STATE].q_ddot.fill(0.0),
        "state-released",
    ),
    (
        "a load of the other sign",
        |c| {
            for load in &mut c.states[MUTATED_STATE].load_wrenches {
                load.force = -load.force;
                load.couple = -load.couple;
            }
        },
        "state-released",
    ),
    (
        "a billionth of an inertia",
        |c| c.mass_matrices[MUTATED_STATE][0] *= 1.0 + 1e-9,
        "state-mass-matrix",
    ),
    (
        "a body's velocity",
        |c| {
            let last = c.states[MUTATED_STATE].velocities.len() - 1;
            c.states[MUTATED_STATE].velocities[last] = [0.0; 3];
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
                start: sound.start.clone(),
                states: sound.states.clone(),
                mass_matrices: sound.mass_matrices.clone(),
            };
            mutate(&mut wrong);
            // The slider-crank turns evenly.
            if case == "slider-crank"
                && wrong.states == sound.states
                && wrong.mass_matrices == sound.mass_matrices
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
        let mut claimed = ClaimedStates::new(case);
        claimed.mass_matrices[MUTATED_STATE][1] *= -1.0;
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
