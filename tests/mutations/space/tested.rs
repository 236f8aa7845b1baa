//! A mechanism in space with its states, evaluated with or without a mutation, and checked.

use crate::fixtures::repository_root;
use crate::mutations::detection::{Detection, REQUIRED_CHECKS};
use crate::mutations::mutating_scalar::{
    MutatingScalar, SourceOperation, recording_operations, with_mutation,
};
use crate::mutations::operations::MutatedSubject;
use crate::mutations::tested_mechanism::{
    CheckMode, ComparedValues, OperationMutation, max_difference,
};
use dwell_findings::Finding;
use dwell_geometry::space::Vec3;
use dwell_kinetostatics::space::Axes;
use dwell_scene::SpaceScene;
use dwell_validation::{ClaimedAt, SpaceClaims, SpaceReference};
use dwell_verify::{ClaimedState, SubjectError, check_branch, check_states};
use std::collections::BTreeSet;

/// Speeds and accelerations of the states, by state and actuator.
const VELOCITIES: [[f64; 3]; 2] = [[1.0, -0.6, 0.4], [-0.8, 0.9, -0.5]];
const ACCELERATIONS: [[f64; 3]; 2] = [[0.7, 0.5, -0.9], [0.5, -1.1, 0.6]];

/// A mechanism to be checked.
pub struct TestedSpace<'a> {
    scene: &'a SpaceScene,
    claims: SpaceClaims<'a>,
    /// Values of 25 digits, of a case that has them.
    reference: Option<SpaceReference>,
    /// Of the states.
    positions: [Vec<f64>; 2],
    /// By component of all reactions in the axes of the ground: whether the loads determine it in all states.
    determined: Vec<bool>,
    /// The results without a mutation.
    clean: ComparedValues,
    /// The keys of findings that fail without a mutation. They are ignored here.
    pub ignored_findings: Vec<String>,
}

/// So many states are checked by kinetic energy alone.
const BY_ENERGIES: usize = 1;

/// Some positions inside the range, or near the start where there are several actuators.
pub(super) fn positions(claims: &SpaceClaims<'_>, scene: &SpaceScene) -> [Vec<f64>; 2] {
    let plan = claims.model().plan();
    let unit = |k: usize| {
        if plan.is_angle(k) {
            1.0
        } else {
            0.2 * plan.size()
        }
    };
    let start = &scene.assembly.q;
    if let ([q], limits) = (&start[..], plan.range().limits()) {
        return match limits {
            Some((from, to)) => [0.31, 0.62].map(|part| vec![from + part * (to - from)]),
            None => [0.7, -1.1].map(|steps| vec![q + steps * unit(0)]),
        };
    }
    [1.0, 2.0].map(|steps| {
        let shifted = |(k, q): (usize, &f64)| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            q + 0.1 * steps * sign * unit(k)
        };
        start.iter().enumerate().map(shifted).collect()
    })
}

/// The reference of a case, if it has one.
fn reference(scene: &SpaceScene) -> Option<SpaceReference> {
    let file = format!("validation/spatial/{}.json", scene.name);
    let path = repository_root().join(file);
    let read = path.is_file().then(|| SpaceReference::read(&path));
    read.map(|read| read.unwrap_or_else(|e| panic!("{}: {e}", scene.name)))
}

impl<'a> TestedSpace<'a> {
    /// A mechanism with its results.
    pub fn new(scene: &'a SpaceScene) -> Self {
        let claims = SpaceClaims::new(scene).unwrap_or_else(|e| panic!("{}: {e:?}", scene.name));
        let positions = positions(&claims, scene);
        let of = |q: &Vec<f64>| claims.determined(q).expect("a pose");
        let [mut determined, other] = positions.each_ref().map(of);
        (determined.iter_mut().zip(other)).for_each(|(all, there)| *all &= there);
        let mut tested = Self {
            reference: reference(scene),
            scene,
            claims,
            positions,
            determined,
            clean: Vec::new(),
            ignored_findings: Vec::new(),
        };
        let states = tested.states(None);
        let states = states.unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        tested.clean = tested.values_of(&states);
        let failed = tested
            .findings(None, &states)
            .into_iter()
            .filter(|f| !f.pass);
        tested.ignored_findings = failed.map(|f| f.key).collect();
        tested
    }

    pub fn scene(&self) -> &'a SpaceScene {
        self.scene
    }

    /// What it costs to check, roughly: the dense equations, cubed.
    pub fn size(&self) -> usize {
        self.scene.mechanism.bodies.len()
    }

    /// The states of the program with a mutation.
    pub(super) fn states(
        &self,
        mutation: OperationMutation,
    ) -> Result<Vec<ClaimedState>, SubjectError> {
        with_mutation(mutation, || {
            states_of::<MutatingScalar>(&self.claims, &self.positions)
        })
    }

    /// The states that another description has at the same positions.
    pub(super) fn states_of_another(&self, other: &SpaceClaims<'_>) -> Option<Vec<ClaimedState>> {
        let mut states = states_of::<f64>(other, &self.positions).ok()?;
        // What acts is what the right description says.
        let own = self.states(None).ok()?;
        for (state, own) in states.iter_mut().zip(own) {
            state.load_wrenches = own.load_wrenches;
        }
        Some(states)
    }

    /// What the checks detect in states that are claimed of this mechanism; nothing where they are its own.
    pub(super) fn check_claims(
        &self,
        claimed: ClaimedAt<'_>,
        states: &[ClaimedState],
    ) -> Option<Detection> {
        let change = max_difference(&self.clean, &self.values_of(states));
        if change <= crate::mutations::tested_mechanism::UNCHANGED_TOLERANCE {
            return None;
        }
        Some(self.detection(&self.findings_of(claimed, states)))
    }

    pub(super) fn claims(&self) -> &SpaceClaims<'a> {
        &self.claims
    }

    fn detection(&self, findings: &[Finding]) -> Detection {
        let applicable = findings
            .iter()
            .filter(|f| !self.ignored_findings.contains(&f.key));
        Detection::from_findings(applicable)
    }

    fn findings(&self, mutation: OperationMutation, states: &[ClaimedState]) -> Vec<Finding> {
        let at_rest =
            |q: &[f64]| with_mutation(mutation, || self.claims.at_rest::<MutatingScalar>(q));
        self.findings_of(&at_rest, states)
    }

    /// The costly finding on the branch only where fewer checks detect a fault than must.
    fn findings_of(&self, claimed: ClaimedAt<'_>, states: &[ClaimedState]) -> Vec<Finding> {
        let assembled = self.claims.assembled();
        let mut findings = check_states(&assembled, states, BY_ENERGIES);
        if let Some(reference) = &self.reference {
            findings.extend(reference.placements(&self.claims, claimed));
            findings.extend(reference.inertias(claimed));
        }
        if self.detection(&findings).check_count() < REQUIRED_CHECKS {
            findings.push(check_branch(&assembled, states));
        }
        findings
    }

    /// All results by kind. What is nobody's is left out: reactions that redundant constraints leave open, and how a body stands about
    /// the line of its two balls.
    fn values_of(&self, states: &[ClaimedState]) -> ComparedValues {
        let mut values: ComparedValues = vec![Vec::new(); 9];
        let parts = |v: Vec3| [v.x, v.y, v.z];
        let idle = &self.claims.model().plan().mobility().idle;
        for state in states {
            for (body, pose) in state.poses.iter().enumerate() {
                values[0].extend(parts(pose.position));
                let line = idle.iter().find(|idle| idle.body.0 == body);
                match line {
                    Some(idle) => values[1].extend(parts(pose.rotation.apply(idle.axis))),
                    None => {
                        values[1].extend(pose.rotation.columns.iter().flat_map(|v| parts(*v)));
                    }
                }
            }
            for (k, twists) in [(2, &state.velocities), (4, &state.accelerations)] {
                for twist in twists {
                    values[k].extend(parts(twist.linear));
                    values[k + 1].extend(parts(twist.angular));
                }
            }
            let reactions = state.reactions.iter().zip(&self.determined);
            values[6].extend(reactions.filter(|(_, is)| **is).map(|(value, _)| value));
            values[6].extend(&state.tau);
            values[7].extend(&state.inertias);
            values[8].extend(state.load_power);
            // Of a size that tells a power from the rounding of none.
            values[8].extend(state.tau.iter().zip(&state.q_dot).map(|(tau, v)| tau * v));
        }
        values
    }
}

/// Under all loads, of one actuator in both unit passes, and under each load alone.
fn states_of<T: dwell_numerics::Scalar>(
    claims: &SpaceClaims<'_>,
    positions: &[Vec<f64>; 2],
) -> Result<Vec<ClaimedState>, SubjectError> {
    let n = positions[0].len();
    let first = |row: &[f64; 3]| -> Vec<f64> { row.iter().copied().cycle().take(n).collect() };
    let mut states = Vec::new();
    for (k, axes) in [Axes::Ground, Axes::Joint].into_iter().enumerate() {
        let (q_dot, q_ddot) = (first(&VELOCITIES[k]), first(&ACCELERATIONS[k]));
        let rates = [&positions[k][..], &q_dot, &q_ddot];
        states.push(claims.state::<T>(0.3 + 0.4 * k as f64, rates, axes)?);
    }
    if let [q] = positions[0][..] {
        states.extend(claims.unit_passes::<T>(q, Axes::Ground)?);
    }
    for load in 0..claims.unit_loads().len() {
        states.push(claims.load_response::<T>(&positions[1], load, Axes::Ground)?);
    }
    Ok(states)
}

impl MutatedSubject for TestedSpace<'_> {
    fn name(&self) -> &str {
        &self.scene.name
    }

    fn mode(&self) -> CheckMode {
        CheckMode::States
    }

    fn operations(&self) -> BTreeSet<SourceOperation> {
        let (_, all) = recording_operations(|| self.states(None));
        // What lifts plain numbers into the others is not the program.
        let is_shipped = |o: &SourceOperation| !o.file.contains("crates/validation/");
        all.into_iter().filter(is_shipped).collect()
    }

    fn change(&self, mutation: OperationMutation) -> Option<f64> {
        let states = self.states(mutation).ok()?;
        Some(max_difference(&self.clean, &self.values_of(&states)))
    }

    fn check(&self, mutation: OperationMutation) -> Detection {
        match self.states(mutation) {
            Ok(states) => self.detection(&self.findings(mutation, &states)),
            Err(_) => Detection::default(),
        }
    }
}
