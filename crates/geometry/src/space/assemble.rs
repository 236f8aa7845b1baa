//! Closing all loops at the assembly, from approximate placements: damped steps of least squares over everything at once.

use super::closure::{Closure, closures};
use super::follow::Node;
use super::groups::Group;
use super::lower::Lowered;
use super::mechanism::{Assembly, Mechanism};
use super::plan::{JointPlace, Plan, Pose};
use super::positions::OPEN;
use super::prediction::Predictions;
use super::rank::Mobility;
use super::stations::Revolutions;
use super::tree::Tree;
use super::vector::vec3;
use crate::error::{AssemblyError, StructureError};
use crate::mechanism::{BodyId, JointId};
use crate::plan::range::Range;
use dwell_numerics::dense::Matrix;

/// Steps at most.
const MAX_STEPS: usize = 300;
/// The largest step, rad or parts of the size.
const MAX_STEP_SIZE: f64 = 0.3;
/// Closed, relative to the size.
const CLOSED: f64 = 1e-13;
/// Singular values this small against the largest are zero.
pub(super) const RANK_TOLERANCE: f64 = 1e-9;
/// Loops that nearly close, relative to the size: their dimensions contradict each other where joints are redundant.
const NEARLY_CLOSED: f64 = 0.05;

impl Plan {
    /// The mechanism with everything in one group, not yet assembled.
    pub(super) fn whole(lowered: &Lowered) -> Result<Self, StructureError> {
        let (mechanism, measured) = (&lowered.mechanism, &lowered.measured);
        let tree = Tree::find(mechanism, &lowered.in_tree, measured)?;
        let mut closures = closures(mechanism, &tree, measured)?;
        let drivers = mechanism.actuators.iter().map(|a| tree.driven(a.kind));
        let Some(drivers) = drivers.collect::<Option<Vec<_>>>() else {
            let reason = "a driven joint is not in the tree";
            return Err(StructureError::Malformed { reason });
        };
        let joint_places = joint_places(mechanism.joints.len(), &tree, &closures);
        for closure in &mut closures {
            closure.joint = closure.joint.map(|joint| lowered.described_joint(joint));
        }
        let mut plan = Self {
            ground: mechanism.ground,
            size: mechanism.size(),
            has_planes: false,
            tree,
            closures,
            joint_places,
            groups: Vec::new(),
            first_links: Vec::new(),
            last_links: Vec::new(),
            drivers,
            split: lowered.split.clone(),
            measured: measured.to_vec(),
            has_tables: mechanism.has_tables(),
            start: Node::default(),
            predictions: Predictions::default(),
            revolutions: Revolutions::default(),
            range: Range::Unbounded,
            repetition: None,
            range_ends: [false; 2],
            assembly_q: Vec::new(),
            closure_angles: Vec::new(),
            freedom_gains: Vec::new(),
            geared: Vec::new(),
            change_points: Vec::new(),
            mobility: Mobility::default(),
        };
        plan.schedule_whole();
        Ok(plan)
    }

    /// One group of all unknowns and rows.
    pub(super) fn schedule_whole(&mut self) {
        let group = self.group(self.unknowns(), self.all_rows());
        self.schedule(vec![group]);
    }

    /// The whole group's Jacobian, scaled.
    pub(super) fn dense(&self, group: &Group, pose: &Pose) -> Matrix {
        let n = group.unknowns.len();
        let mut matrix = Matrix::zeros(group.rows.len(), n);
        for inner in &group.inner {
            matrix[(inner.at / n, inner.at % n)] = pose.entries[inner.entry] * inner.scale;
        }
        matrix
    }

    /// Moves everything to the coordinates in the pose, with the rows of the whole.
    pub(super) fn evaluate_whole(&self, pose: &mut Pose) {
        self.place(&self.first_links, pose);
        self.place(&self.groups[0].links, pose);
        self.place(&self.last_links, pose);
        self.fill_rows(&self.groups[0], pose);
    }

    /// The pose of the assembly.
    ///
    /// # Errors
    /// [`AssemblyError::NoAssembly`] and [`AssemblyError::Inconsistent`] with the constraints that stay open.
    pub(super) fn assemble(
        &self,
        mechanism: &Mechanism,
        assembly: &Assembly,
    ) -> Result<Pose, AssemblyError> {
        if assembly.q.len() != self.drivers.len() || !assembly.q.iter().all(|q| q.is_finite()) {
            let reason = "the assembly does not give one finite coordinate for each actuator";
            return Err(StructureError::Malformed { reason }.into());
        }
        let mut pose = self.pose::<f64>();
        let (coordinates, balls) = self.tree.approximate_coordinates(assembly);
        pose.coordinates = coordinates;
        pose.balls = balls;
        for (driver, q) in self.drivers.iter().zip(&assembly.q) {
            pose.coordinates[driver.freedom] = driver.factor * q;
        }
        self.evaluate_whole(&mut pose);
        let mut damping = 1e-3;
        let mut residual = self.residual_norm(&pose);
        for _ in 0..MAX_STEPS {
            if residual < CLOSED || damping > 1e12 {
                break;
            }
            let before = pose.clone();
            self.damped_step(damping, &mut pose);
            self.evaluate_whole(&mut pose);
            let new = self.residual_norm(&pose);
            if new < residual {
                residual = new;
                damping = (damping * 0.1).max(1e-18);
            } else {
                pose = before;
                damping = (damping * 10.0).max(1e-15);
            }
        }
        let flipped = self
            .closures
            .iter()
            .filter(|c| c.is_flipped(&pose.frames, mechanism, &self.tree));
        let flipped: Vec<JointId> = flipped.filter_map(|c| c.joint).collect();
        if residual < OPEN && flipped.is_empty() {
            return Ok(pose);
        }
        Err(self.open_loops(mechanism, &pose, flipped))
    }

    /// The error of loops that stay open.
    fn open_loops(
        &self,
        mechanism: &Mechanism,
        pose: &Pose,
        flipped: Vec<JointId>,
    ) -> AssemblyError {
        let open = |c: &&super::closure::Closure| {
            let unit = |length| if length { self.size } else { 1.0 };
            let mut rows = c.kinds.iter().zip(c.rows.clone());
            rows.any(|(kind, r)| pose.residuals[r].abs() > OPEN * unit(kind.is_length()))
        };
        let mut joints: Vec<JointId> = self
            .closures
            .iter()
            .filter(open)
            .filter_map(|c| c.joint)
            .collect();
        let mut largest = self.largest_residual(&self.groups[0], pose);
        // Axes of opposite sense: their unit vectors differ by two.
        if !flipped.is_empty() {
            largest = largest.max(2.0);
        }
        joints.extend(flipped);
        let gap = largest * self.size;
        let svd = self.dense(&self.groups[0], pose).svd();
        let rank = svd.map_or(0, |svd| svd.rank(RANK_TOLERANCE));
        let redundant_count = self.groups[0].rows.len().saturating_sub(rank);
        if redundant_count > 0 && largest < NEARLY_CLOSED {
            return AssemblyError::Inconsistent {
                joints,
                redundant_count,
                gap,
            };
        }
        let of = |joint: &JointId| mechanism.joints[joint.0].bodies;
        let mut bodies: Vec<BodyId> = joints.iter().flat_map(of).collect();
        bodies.sort_unstable();
        bodies.dedup();
        AssemblyError::NoAssembly {
            bodies,
            joints,
            gap,
        }
    }

    fn residual_norm(&self, pose: &Pose) -> f64 {
        let group = &self.groups[0];
        let rows = group.residuals.iter().zip(&group.row_scales);
        let squares = rows.map(|(row, scale)| (scale * pose.residuals[*row]).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// One damped step, δ = V σ/(σ² + µ) Uᵀ (−φ).
    fn damped_step(&self, damping: f64, pose: &mut Pose) {
        let group = &self.groups[0];
        let Some(svd) = self.dense(group, pose).svd() else {
            return;
        };
        let mut step = vec![0.0; group.unknowns.len()];
        for (k, &sigma) in svd.values[..svd.rank(RANK_TOLERANCE)].iter().enumerate() {
            let rows = group.residuals.iter().zip(&group.row_scales).enumerate();
            let parts = rows.map(|(i, (row, scale))| svd.u[(i, k)] * -scale * pose.residuals[*row]);
            let factor = parts.sum::<f64>() * sigma / (sigma * sigma + damping);
            for (j, step) in step.iter_mut().enumerate() {
                *step += factor * svd.v[(j, k)];
            }
        }
        let size = step.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let shorten = if size > MAX_STEP_SIZE {
            MAX_STEP_SIZE / size
        } else {
            1.0
        };
        for ((value, freedom), unit) in step
            .iter_mut()
            .zip(&group.unknowns)
            .zip(&group.column_scales)
        {
            *value *= shorten * unit;
            pose.coordinates[*freedom] += *value;
        }
        for &(link, first) in &group.balls {
            self.turn_ball(
                link,
                vec3(step[first], step[first + 1], step[first + 2]),
                pose,
            );
        }
    }
}

/// By joint: the link or the closure that it is.
fn joint_places(joints: usize, tree: &Tree, closures: &[Closure]) -> Vec<JointPlace> {
    let mut places = vec![JointPlace::Link(0); joints];
    for (l, link) in tree.links.iter().enumerate() {
        if let Some(joint) = link.joint {
            places[joint.0] = JointPlace::Link(l);
        }
    }
    for (c, closure) in closures.iter().enumerate() {
        if let Some(joint) = closure.joint {
            places[joint.0] = JointPlace::Closure(c);
        }
    }
    places
}
