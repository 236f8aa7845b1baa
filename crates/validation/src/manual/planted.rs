//! Faults planted in the value of a key: the claimed results are computed from a scene with another value, and the checks get
//! the original scene.
//!
//! ```text
//! text ──────────────── scene ──── checks ──┐
//!   └─ one value altered ── scene ── claims ┴─→ findings: which checks detect it
//! ```

use super::motion_claims::{MotionClaims, differ};
use crate::cases::model_states::{ModelStates, StateRequest};
use crate::cases::reference::Reference;
use crate::checked::known_reactions::known_reaction_findings;
use crate::checked::states::{assembled, motions};
use dwell_findings::{Check, Finding};
use dwell_scene::PlaneScene;
use dwell_study::StudyError;
use dwell_verify::{ClaimedState, Pose, Twist, check_states};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::OnceLock;

/// Number of states along each motion: enough to show every term, and few enough for hundreds of faults.
const STATES: usize = 7;
/// Number of states checked by energies, which are more expensive.
const ENERGY_STATES: usize = 2;

/// A scene in which faults are planted.
pub struct PlantedScene {
    pub(super) scene: PlaneScene,
    text: String,
    reference: Reference,
    /// Its claimed states, and its claimed free motion if it has one.
    states: OnceLock<Option<StateClaims>>,
    motion: OnceLock<Option<MotionClaims>>,
    /// Findings that fail without a fault, because the states are few.
    ignored: OnceLock<BTreeSet<String>>,
}

/// The claims about a scene.
#[derive(Debug, Clone, PartialEq)]
struct StateClaims {
    assembly_poses: Vec<Pose>,
    states: Vec<ClaimedState>,
}

/// The result of a planted fault.
#[derive(Debug, Clone, PartialEq)]
pub enum PlantedResult {
    /// The program rejects the altered scene, or its joints and bodies differ.
    Refused,
    /// No result changes.
    Unchanged,
    /// Results change, and these checks detect it.
    Detected(BTreeSet<Check>),
}

impl PlantedScene {
    /// A scene, with the folder of its reference; `None` if its text is not TOML.
    ///
    /// Altered texts have their keys in alphabetical order, and so does this one, so that bodies and joints have equal indices in both.
    pub(super) fn new(written: &PlaneScene, folder: &Path) -> Option<Self> {
        let text = written.source.inner().trim_start_matches('\u{feff}');
        let root: toml::Table = toml::from_str(text).ok()?;
        let text = toml::to_string(&root).ok()?;
        let scene = PlaneScene::parse(&format!("{}.toml", written.name), &text).ok()?;
        Some(Self {
            reference: Reference::read(folder, &scene).unwrap_or_default(),
            scene,
            text,
            states: OnceLock::new(),
            motion: OnceLock::new(),
            ignored: OnceLock::new(),
        })
    }

    /// The scene read from its [text](Self::text).
    pub fn scene(&self) -> &PlaneScene {
        &self.scene
    }

    /// Its text, the keys in alphabetical order.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The approximate cost of a fault: the cube of the number of dense rows, and a motion.
    pub fn cost(&self) -> usize {
        let bodies = self.scene.mechanism.bodies.len();
        bodies.pow(3) + 1000 * usize::from(self.scene.motion.is_some())
    }

    /// The findings without a fault.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let states = self.own_states().map(|own| self.check_states(own));
        let motion = self.own_motion().map(|own| own.check(&self.scene, own));
        let known = known_reaction_findings(&self.scene, &self.scene, &self.reference);
        let found = states.into_iter().chain(motion).flatten();
        found.chain(known).collect()
    }

    /// The checks that detect results of another scene.
    pub fn check_altered(&self, altered: &PlaneScene) -> PlantedResult {
        let (mut changed, mut failed, mut seen) = (false, BTreeSet::new(), false);
        if let (Some(own), Some(claims)) = (self.own_states(), self.claims(altered)) {
            let claims = claims.with_requests_of(own);
            if !claims.is_alike(own) {
                return PlantedResult::Refused;
            }
            seen = true;
            if claims.differs_from(own) {
                changed = true;
                failed.extend(self.detecting(&self.check_states(&claims)));
            }
        }
        // Motions are more expensive: they are checked only if fewer than two checks of states detect the fault.
        if failed.len() < 2
            && let (Some(own), Some(claims)) = (self.own_motion(), MotionClaims::new(altered))
        {
            seen = true;
            if claims.differ_from(own) {
                changed = true;
                failed.extend(self.detecting(&claims.check(&self.scene, own)));
            }
        }
        let known =
            |scene: &PlaneScene| known_reaction_findings(&self.scene, scene, &self.reference);
        if !self.scene.varying_inertias.is_empty()
            && altered.varying_inertias != self.scene.varying_inertias
        {
            (seen, changed) = (true, true);
            failed.extend(self.detecting(&known(altered)));
        }
        match (seen, changed) {
            (false, _) => PlantedResult::Refused,
            (true, false) => PlantedResult::Unchanged,
            (true, true) => PlantedResult::Detected(failed),
        }
    }

    /// The checks with failed findings that pass without a fault.
    fn detecting(&self, findings: &[Finding]) -> BTreeSet<Check> {
        let ignored = self.ignored.get_or_init(|| {
            let failed = self.findings().into_iter().filter(|f| !f.pass);
            failed.map(|f| f.key).collect()
        });
        let failed = findings.iter().filter(|f| !f.pass);
        failed
            .filter(|f| !ignored.contains(&f.key))
            .map(|f| f.check)
            .collect()
    }

    fn own_states(&self) -> Option<&StateClaims> {
        self.states
            .get_or_init(|| self.claims(&self.scene))
            .as_ref()
    }

    fn own_motion(&self) -> Option<&MotionClaims> {
        self.motion
            .get_or_init(|| MotionClaims::new(&self.scene))
            .as_ref()
    }

    /// The states that a scene claims along its motion or sweep.
    fn claims(&self, scene: &PlaneScene) -> Option<StateClaims> {
        let claims = || -> Result<StateClaims, StudyError> {
            let mut model = ModelStates::new(scene)?;
            let requests = motions(scene, &model, &self.reference, STATES).flatten();
            let requests: Vec<StateRequest> = requests.collect();
            let mut states = Vec::new();
            for request in &requests {
                let state = model.state(request)?;
                let inertias = model.mass_matrix();
                states.push(ClaimedState { inertias, ..state });
            }
            Ok(StateClaims {
                assembly_poses: model.assembly_poses,
                states,
            })
        };
        claims().ok().filter(|claims| !claims.states.is_empty())
    }

    fn check_states(&self, claims: &StateClaims) -> Vec<Finding> {
        let own = self.own_states().map_or(&[][..], |own| &own.assembly_poses);
        check_states(&assembled(&self.scene, own), &claims.states, ENERGY_STATES)
    }
}

impl StateClaims {
    /// The claims for the states that another scene requests, under the loads there.
    fn with_requests_of(mut self, own: &Self) -> Self {
        for (claim, own) in self.states.iter_mut().zip(&own.states) {
            (claim.t, claim.name) = (own.t, own.name.clone());
            claim.q.clone_from(&own.q);
            claim.q_dot.clone_from(&own.q_dot);
            claim.q_ddot.clone_from(&own.q_ddot);
            claim.load_wrenches.clone_from(&own.load_wrenches);
        }
        self
    }

    /// Whether the numbers of all parts are equal.
    fn is_alike(&self, own: &Self) -> bool {
        let counts = |s: &ClaimedState| [s.poses.len(), s.reactions.len(), s.tau.len(), s.q.len()];
        let both = self.states.iter().zip(&own.states);
        self.states.len() == own.states.len()
            && both.into_iter().all(|(a, b)| counts(a) == counts(b))
    }

    fn differs_from(&self, own: &Self) -> bool {
        let kinds: [fn(&ClaimedState) -> Vec<f64>; 5] = [
            |s| s.inertias.clone(),
            |s| s.poses.iter().flat_map(Pose::in_plane).collect(),
            |s| s.velocities.iter().flat_map(Twist::in_plane).collect(),
            |s| s.accelerations.iter().flat_map(Twist::in_plane).collect(),
            |s| [&s.reactions[..], &s.tau].concat(),
        ];
        let differs = |kind: fn(&ClaimedState) -> Vec<f64>| {
            let [one, other] = [self, own]
                .map(|claims| -> Vec<f64> { claims.states.iter().flat_map(kind).collect() });
            differ(&one, &other)
        };
        kinds.into_iter().any(differs)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]
    use super::*;

    /// Names that are not in alphabetical order, so that bodies have other indices in an altered text.
    const ARM: &str = "[bodies.ground]\npoints = { O = [0, 0] }\n[bodies.arm]\npoints = { O = [0, 0] }\nmass = 1\ncenter = [0.3, 0.1]\ninertia = 0.2\n\
                       [joints]\nO = { revolute = [\"ground.O\", \"arm.O\"] }\n[actuators.phi]\nangle = [\"ground\", \"arm\"]\n\
                       [loads]\nweight = { gravity = [0, -9.81] }\n";

    #[test]
    fn a_scene_that_is_not_altered_has_the_same_results_and_one_that_is_fails_checks() {
        let scene = PlaneScene::parse("arm.toml", ARM).unwrap();
        let planted = PlantedScene::new(&scene, Path::new("")).unwrap();
        let same = PlaneScene::parse("arm.toml", &planted.text).unwrap();
        assert_eq!(planted.check_altered(&same), PlantedResult::Unchanged);
        let text = planted.text.replace("inertia = 0.2", "inertia = 0.202");
        assert_ne!(text, planted.text);
        let altered = PlaneScene::parse("arm.toml", &text).unwrap();
        let PlantedResult::Detected(checks) = planted.check_altered(&altered) else {
            panic!("not detected");
        };
        assert!(
            checks.contains(&Check::NewtonEuler) && checks.len() >= 2,
            "{checks:?}"
        );
        assert!(planted.findings().iter().all(|f| f.pass));
    }
}
