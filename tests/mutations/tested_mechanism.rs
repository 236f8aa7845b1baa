//! A case with its model, evaluated with or without a mutation, and checked.

use super::detection::{Detection, REQUIRED_CHECKS};
use super::mutated_model::MutatedModel;
use super::mutating_scalar::{
    MutatingScalar, MutationKind, SourceOperation, recording_operations, with_mutation,
};
use super::positions::{POSITIONS, poses_along, positions};
use super::to_f64::{pose_to_f64, result_to_f64};
use dwell_findings::Finding;
use dwell_kinetostatics::{
    EvaluatedState, InverseDynamics as Kinetostatic, KinematicState, MachineModel as _, Model,
};
use dwell_scene::PlaneScene;
use dwell_validation::{claimed_motion, solved};
use dwell_verify::{
    AssembledMechanism, Case, CheckedMechanism, ClaimedState, Pose, Subject, Twist, check_energies,
    check_states, load_wrenches, verify_all,
};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Speeds and accelerations of the states, by state and actuator.
const VELOCITIES: [[f64; 3]; POSITIONS] = [[1.0, -0.6, 0.4], [-0.8, 0.9, -0.5], [0.6, 0.7, 1.1]];
const ACCELERATIONS: [[f64; 3]; POSITIONS] = [[0.7, 0.5, -0.9], [0.5, -1.1, 0.6], [-1.2, 0.8, 0.7]];

/// The first numbers of a row, which begins anew where a mechanism has more freedoms.
fn first(count: usize, row: &[f64; 3]) -> Vec<f64> {
    row.iter().copied().cycle().take(count).collect()
}

/// A mutation of one operation of the code.
pub type OperationMutation = Option<(SourceOperation, MutationKind)>;

/// How a mechanism is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckMode {
    /// Its reduced model, of one coordinate and no load.
    Reduced,
    /// Its states under loads, of any number of coordinates.
    States,
}

/// A mechanism to be checked.
pub struct TestedMechanism {
    pub name: String,
    pub mode: CheckMode,
    scene: PlaneScene,
    model: Model,
    positions: Vec<Vec<f64>>,
    /// By position, the frames of all bodies, revolutions counted from the start.
    body_poses: Vec<Vec<[f64; 3]>>,
    start_poses: Vec<Pose>,
    /// The results without a mutation.
    clean: ComparedValues,
    clean_states: Vec<ClaimedState>,
    /// The keys of findings that fail without a mutation: too few positions for them, or redundant
    /// constraints. They are ignored here.
    pub ignored_findings: Vec<String>,
}

/// Everything that is checked, by kind.
pub type ComparedValues = Vec<Vec<f64>>;

/// A result that changes by less than this, relative to the largest of its kind, is the same result:
/// three digits above what the checks distinguish from rounding.
pub const UNCHANGED_TOLERANCE: f64 = 1e-9;

impl TestedMechanism {
    /// A mechanism with its results.
    pub fn new(scene: PlaneScene, mode: CheckMode) -> Self {
        let name = scene.name.clone();
        let mut tested = Self::from_scene(scene, mode).unwrap_or_else(|| panic!("{name} is none"));
        if mode == CheckMode::States {
            tested.clean_states = tested.states(None).expect("states");
        }
        tested.clean = tested.compared_values(None).expect("answers");
        let findings = tested.findings(None, usize::MAX);
        let failed = findings.into_iter().filter(|f| !f.pass);
        tested.ignored_findings = failed.map(|f| f.key).collect();
        tested
    }

    /// A mechanism as described; none if it cannot be assembled.
    pub fn from_scene(scene: PlaneScene, mode: CheckMode) -> Option<Self> {
        let mechanism = &scene.mechanism;
        let start = scene.assembly.to_configuration();
        let mut model =
            Model::new(mechanism, &scene.masses, &start, &mechanism.reactions()).ok()?;
        if mode == CheckMode::States {
            model = model.with_loads(scene.loads.clone()).ok()?;
        }
        let mut positions = positions(&scene, model.plan());
        if mode == CheckMode::Reduced {
            // Checking costs more there.
            positions.truncate(2);
        }
        let (at_start, body_poses) = poses_along(&scene, model.plan(), &positions);
        Some(Self {
            name: scene.name.clone(),
            mode,
            scene,
            model,
            positions,
            body_poses,
            start_poses: Pose::all_in_plane(&at_start),
            clean: Vec::new(),
            clean_states: Vec::new(),
            ignored_findings: Vec::new(),
        })
    }

    /// What it costs to check, roughly: dense rows, cubed.
    pub fn size(&self) -> usize {
        self.scene.mechanism.bodies.len()
    }

    /// Every operation of an evaluation.
    pub fn operations(&self) -> BTreeSet<SourceOperation> {
        recording_operations(|| self.compared_values(None)).1
    }

    /// How far a mutation changes the results, relative to the largest of each kind; none where there is
    /// no result at all.
    pub fn change(&self, mutation: OperationMutation) -> Option<f64> {
        Some(max_difference(
            &self.clean,
            &self.compared_values(mutation)?,
        ))
    }

    /// What the checks detect.
    pub fn check(&self, mutation: OperationMutation) -> Detection {
        self.detection(&self.findings(mutation, REQUIRED_CHECKS))
    }

    /// Of findings that are not ignored.
    fn detection(&self, findings: &[Finding]) -> Detection {
        let applicable = findings
            .iter()
            .filter(|f| !self.ignored_findings.contains(&f.key));
        Detection::from_findings(applicable)
    }

    /// What the checks detect in states that are claimed of this mechanism; nothing where they are its own.
    pub fn check_claims(&self, mut claimed_states: Vec<ClaimedState>) -> Option<Detection> {
        for (claimed, actual) in claimed_states.iter_mut().zip(&self.clean_states) {
            claimed.load_wrenches.clone_from(&actual.load_wrenches);
        }
        if max_difference(&self.clean, &self.values_of(&claimed_states)) <= UNCHANGED_TOLERANCE {
            return None;
        }
        let findings = self.check_states(&claimed_states, usize::MAX);
        Some(self.detection(&findings))
    }

    /// The states that this mechanism claims.
    pub fn claims(&self) -> Option<Vec<ClaimedState>> {
        self.states(None)
    }

    /// The accelerations of its states, without their velocity-product terms.
    pub fn accelerations_without_velocity(&self, claimed: &[ClaimedState]) -> Vec<Vec<Twist>> {
        let mut workspace = self.model.workspace::<MutatingScalar>();
        let zero_velocities = vec![MutatingScalar::default(); self.model.plan().actuators()];
        let lifted = |values: &[f64]| {
            values
                .iter()
                .map(|&v| MutatingScalar::new(v))
                .collect::<Vec<_>>()
        };
        let of = |state: &ClaimedState| {
            let q = lifted(&state.q);
            let entered = self
                .model
                .kinematic_state(&q, &zero_velocities, &mut workspace);
            let mut entered = entered.expect("a pose");
            let states = entered.bodies_at(&lifted(&state.q_ddot));
            claimed_motion(&vec![[0.0; 3]; state.poses.len()], states).accelerations
        };
        claimed.iter().map(of).collect()
    }

    /// Where it is checked: to be the same for claims of a wrong description.
    pub fn set_positions(&mut self, positions: &[Vec<f64>]) {
        self.positions = positions.to_vec();
        self.clean_states.clear();
        (_, self.body_poses) = poses_along(&self.scene, self.model.plan(), &self.positions);
    }

    pub fn positions(&self) -> &[Vec<f64>] {
        &self.positions
    }

    pub fn scene(&self) -> &PlaneScene {
        &self.scene
    }

    /// The findings; the costly ones only where fewer than `enough` checks catch it.
    fn findings(&self, mutation: OperationMutation, enough: usize) -> Vec<Finding> {
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        if self.mode == CheckMode::Reduced {
            let case = Case {
                mechanism: CheckedMechanism::Plane(mechanism, masses.into()),
                range: self.model.plan().range(),
                positions: self.positions.iter().map(|q| q[0]).collect(),
            };
            return verify_all(&case, &self.mutated(mutation), &[]);
        }
        match self.states(mutation) {
            None => Vec::new(),
            Some(claimed) => self.check_states(&claimed, enough),
        }
    }

    fn check_states(&self, states: &[ClaimedState], enough: usize) -> Vec<Finding> {
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        let assembled = AssembledMechanism {
            mechanism: CheckedMechanism::Plane(mechanism, masses.into()),
            q: &self.scene.assembly.coordinates,
            poses: &self.start_poses,
        };
        let mut findings = check_states(&assembled, states, 0);
        if self.detection(&findings).check_count() < enough {
            findings.extend(check_energies(&assembled, states));
        }
        findings
    }

    fn mutated(&self, mutation: OperationMutation) -> MutatedModel<'_> {
        MutatedModel {
            model: &self.model,
            scene: &self.scene,
            mutation,
        }
    }

    fn compared_values(&self, mutation: OperationMutation) -> Option<ComparedValues> {
        match self.mode {
            CheckMode::Reduced => {
                let subject = self.mutated(mutation);
                let (mut poses, mut inertia, mut forces) = (Vec::new(), Vec::new(), Vec::new());
                for (q, k) in self.positions.iter().zip(0..) {
                    let [v, r] = [VELOCITIES[k][0], ACCELERATIONS[k][0]];
                    poses.extend(subject.frames(q[0]).ok()?.into_iter().flatten());
                    let at = subject.coefficients(q[0]).ok()?;
                    inertia.extend([at.m, at.half_dm]);
                    forces.extend(self.determinate(at.a));
                    forces.extend(self.determinate(at.b));
                    let result = subject.inverse_dynamics(q[0], v, r).ok()?;
                    forces.extend(self.determinate(result.reactions));
                    forces.push(result.tau);
                }
                // Values that are all zero have the scale of their kind.
                Some(vec![poses, inertia, forces])
            }
            CheckMode::States => Some(self.values_of(&self.states(mutation)?)),
        }
    }

    fn values_of(&self, states: &[ClaimedState]) -> ComparedValues {
        let twists = |of: fn(&ClaimedState) -> &Vec<Twist>| {
            let all = states.iter().flat_map(of);
            all.flat_map(Twist::in_plane).collect()
        };
        let poses = states.iter().flat_map(|s| &s.poses);
        let forces = states.iter().flat_map(|s| {
            let reactions = self.determinate(s.reactions.clone());
            reactions.into_iter().chain(s.tau.clone())
        });
        vec![
            poses.flat_map(Pose::in_plane).collect(),
            twists(|s| &s.velocities),
            twists(|s| &s.accelerations),
            forces.collect(),
            states.iter().flat_map(|s| s.inertias.clone()).collect(),
        ]
    }

    /// The reactions that the loads determine; the others may be split in any way that balances.
    fn determinate(&self, reactions: Vec<f64>) -> Vec<f64> {
        let value_if_determinate =
            |(k, value): (usize, f64)| self.model.plan().is_determinate(k).then_some(value);
        reactions
            .into_iter()
            .enumerate()
            .filter_map(value_if_determinate)
            .collect()
    }

    /// The states under the loads. The forces of the loads follow from the unmutated poses and magnitudes.
    fn states(&self, mutation: OperationMutation) -> Option<Vec<ClaimedState>> {
        let mut workspace = self.model.workspace::<MutatingScalar>();
        let (mut result, mut unit) = (self.model.result_buffer(), self.model.result_buffer());
        let n = self.model.plan().actuators();
        let mut states = Vec::<ClaimedState>::new();
        for (k, q) in self.positions.iter().enumerate() {
            let t = 0.3 + 0.4 * k as f64;
            let [q_dot, q_ddot] = [first(n, &VELOCITIES[k]), first(n, &ACCELERATIONS[k])];
            let done = with_mutation(mutation, || {
                let lifted = |values: &[f64]| {
                    values
                        .iter()
                        .map(|&v| MutatingScalar::new(v))
                        .collect::<Vec<_>>()
                };
                let (q, v, a) = (lifted(q), lifted(&q_dot), lifted(&q_ddot));
                self.model
                    .kinetostatics(t, &q, &v, &a, &mut workspace, &mut result)
            });
            let evaluated = done.ok()?;
            let mut state = with_mutation(mutation, || self.state(t, k, &evaluated));
            let mut evaluated = evaluated.into_kinematic_state();
            let mut runs = Vec::new();
            for i in 0..n {
                with_mutation(mutation, || evaluated.mass_matrix_column(i, &mut unit));
                runs.push(result_to_f64(&unit));
            }
            // M_ij is the actuator force i at q̈ⱼ = 1 alone.
            let at = |i: usize, j: usize| runs[j].tau[i];
            state.inertias = (0..n * n).map(|k| at(k / n, k % n)).collect();
            states.push(state);
            if k + 1 == self.positions.len() && self.model.frictions().len() == 0 {
                states.push(self.free_state(mutation, states.last()?, &runs, evaluated)?);
            }
        }
        Some(states)
    }

    /// The same state in free motion: its accelerations from the inertias, and every reaction as a
    /// sum of the unit accelerations' ones.
    fn free_state(
        &self,
        mutation: OperationMutation,
        state: &ClaimedState,
        runs: &[Kinetostatic<f64>],
        evaluated: KinematicState<'_, MutatingScalar>,
    ) -> Option<ClaimedState> {
        let n = runs.len();
        let zero_accelerations = vec![MutatingScalar::default(); n];
        let mut without = self.model.result_buffer();
        let mut free_forces = with_mutation(mutation, || {
            let loaded = evaluated.apply_loads(state.t)?;
            loaded.inverse_dynamics(&zero_accelerations, &mut without)
        })
        .ok()?;
        let without = result_to_f64(&without);
        let columns: Vec<Vec<f64>> = runs.iter().map(|run| run.tau.clone()).collect();
        let right: Vec<f64> = without.tau.iter().map(|tau| -tau).collect();
        // Without inertia no number is right.
        let q_ddot = solved(&columns, &right).unwrap_or_else(|| vec![f64::NAN; n]);
        let lifted: Vec<_> = q_ddot.iter().map(|&a| MutatingScalar::new(a)).collect();
        let bodies = with_mutation(mutation, || free_forces.bodies_at(&lifted));
        let mut free = state.clone();
        free.reactions = without.reactions;
        for (run, a) in runs.iter().zip(&q_ddot) {
            for (sum, one) in free.reactions.iter_mut().zip(&run.reactions) {
                *sum += one * a;
            }
        }
        let frames = vec![[0.0; 3]; free.poses.len()];
        free.accelerations =
            with_mutation(mutation, || claimed_motion(&frames, bodies).accelerations);
        free.tau = vec![0.0; n];
        free.q_ddot = q_ddot;
        Some(free)
    }

    fn state(
        &self,
        t: f64,
        k: usize,
        evaluated: &EvaluatedState<'_, MutatingScalar>,
    ) -> ClaimedState {
        let (mechanism, n) = (&self.scene.mechanism, self.model.plan().actuators());
        let (states, result) = (evaluated.bodies(), evaluated.inverse_dynamics());
        let plan = self.model.plan();
        let mut bodies = plan.body_frames(mechanism, &pose_to_f64(plan, evaluated.pose()));
        for (pose, right) in bodies.iter_mut().zip(&self.body_poses[k]) {
            pose[2] += ((right[2] - pose[2]) / TAU).round() * TAU;
        }
        let motion = claimed_motion(&bodies, states);
        let loads = match self.clean_states.get(k) {
            Some(clean) => clean.load_wrenches.clone(),
            None => {
                let velocities: Vec<_> = motion.velocities.iter().map(Twist::in_plane).collect();
                let loads = self.scene.loads.iter().zip(&evaluated.loads().magnitude);
                let wrenches = loads.filter_map(|(load, magnitude)| {
                    let masses = &self.scene.masses;
                    load_wrenches(
                        &load.kind,
                        magnitude.0,
                        mechanism.ground,
                        masses,
                        &bodies,
                        &velocities,
                    )
                });
                wrenches.flatten().collect()
            }
        };
        ClaimedState {
            t,
            q: self.positions[k].clone(),
            q_dot: first(n, &VELOCITIES[k]),
            q_ddot: first(n, &ACCELERATIONS[k]),
            reactions: result.reactions.iter().map(|r| r.0).collect(),
            tau: result.tau.iter().map(|r| r.0).collect(),
            load_wrenches: loads,
            ..motion
        }
    }
}

/// The difference of results, relative to the largest of each kind; infinite where one is not a number.
pub fn max_difference(clean: &ComparedValues, found: &ComparedValues) -> f64 {
    let mut max = 0.0_f64;
    for (clean, found) in clean.iter().zip(found) {
        let largest = clean.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
        for (c, f) in clean.iter().zip(found).filter(|(c, f)| c != f) {
            let difference = (f - c).abs() / largest;
            max = max.max(if difference.is_nan() {
                f64::INFINITY
            } else {
                difference
            });
        }
    }
    max
}
