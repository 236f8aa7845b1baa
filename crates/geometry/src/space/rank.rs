//! Mobility by rank: degrees of freedom, redundant constraints, bodies that turn idly between two balls, and the forces that the
//! redundant constraints leave open.

use super::assemble::RANK_TOLERANCE;
use super::closure::{Closure, RowKind};
use super::follow::nearly_parallel;
use super::groups::Group;
use super::mechanism::Mechanism;
use super::plan::{Plan, Pose};
use super::vector::Vec3;
use crate::error::{AssemblyError, StructureError};
use crate::mechanism::{ActuatorId, BodyId, JointId};
use dwell_numerics::dense::Svd;

/// A twist or a force is none below this.
const PART: f64 = 1e-6;

/// Degrees of freedom and redundant constraints of a mechanism in space.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mobility {
    /// Degrees of freedom, idle ones not counted.
    pub degrees_of_freedom: usize,
    /// Constraints that are too many.
    pub redundant_count: usize,
    /// Bodies that turn idly.
    pub idle: Vec<IdleBody>,
}

/// A body that can turn about the line of its two balls while nothing else moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IdleBody {
    /// The body.
    pub body: BodyId,
    /// A point of the line, m in the body's frame.
    pub point: Vec3,
    /// Its direction, a unit vector in the body's frame.
    pub axis: Vec3,
}

/// The results of the rank of all rows.
pub(super) struct Analysed {
    pub(super) mobility: Mobility,
    pub(super) pose: Pose,
    /// Rows that determine all unknowns, of [`Plan::all_rows`].
    pub(super) independent: Vec<usize>,
}

/// Whether each joint of a body holds it at a point alone, as a ball does.
fn hangs_between_balls(mechanism: &Mechanism, body: usize) -> bool {
    let mut sides = mechanism.joints.iter().flat_map(|joint| {
        let of_body = (0..2).filter(|side| joint.bodies[*side] == BodyId(body));
        of_body.map(|side| (joint.kind, side))
    });
    sides.all(|(kind, side)| kind.is_point_on(side))
}

impl Plan {
    /// Analyses the assembled mechanism, with a row added for each idle freedom.
    pub(super) fn analyse(
        &mut self,
        mechanism: &Mechanism,
        mut pose: Pose,
    ) -> Result<Analysed, AssemblyError> {
        let group = &self.groups[0];
        let (rows, n) = (group.rows.len(), group.unknowns.len());
        let svd = self.svd(group, &pose);
        let rank = svd.as_ref().map_or(0, |svd| svd.rank(RANK_TOLERANCE));
        let mut idle = Vec::new();
        if rank < n {
            idle = self.idle_bodies(mechanism, svd.as_ref(), rank, &mut pose)?;
            self.hold(&idle);
            let (coordinates, balls) = (pose.coordinates, pose.balls);
            pose = self.pose();
            (pose.coordinates, pose.balls) = (coordinates, balls);
            self.evaluate_whole(&mut pose);
        }
        self.require_independent_actuators(mechanism, &pose)?;
        if self.has_planes {
            self.find_planes(mechanism, &pose);
            self.schedule_whole();
            self.evaluate_whole(&mut pose);
        }
        let independent = self.independent_rows(&pose);
        if independent.len() < n {
            return Err(self.under_actuated(mechanism, n - independent.len(), Vec::new()));
        }
        let mobility = Mobility {
            degrees_of_freedom: self.actuators(),
            redundant_count: rows - rank,
            idle,
        };
        Ok(Analysed {
            mobility,
            pose,
            independent,
        })
    }

    /// The singular values of a group's Jacobian, scaled; none without an entry.
    fn svd(&self, group: &Group, pose: &Pose) -> Option<Svd> {
        let is_empty = group.rows.is_empty() || group.unknowns.is_empty();
        (!is_empty).then(|| self.dense(group, pose).svd()).flatten()
    }

    /// Refuses actuators that drive the same freedom: with every coordinate free, the rows must leave one freedom for each of them.
    fn require_independent_actuators(
        &self,
        mechanism: &Mechanism,
        pose: &Pose,
    ) -> Result<(), AssemblyError> {
        let freedoms = self.tree.freedoms.len();
        let everything = self.group((0..freedoms).collect(), self.all_rows());
        let left = freedoms
            - self
                .svd(&everything, pose)
                .map_or(0, |svd| svd.rank(RANK_TOLERANCE));
        // The rows that hold idle bodies are among all rows.
        let redundant_count = self.actuators().saturating_sub(left);
        if redundant_count == 0 {
            return Ok(());
        }
        let rotation = |body| self.placement(pose, body).rotation;
        let all: Vec<JointId> = (0..mechanism.joints.len()).map(JointId).collect();
        if let Some((joints, angle)) = nearly_parallel(mechanism, &all, rotation) {
            return Err(AssemblyError::NearlyParallel {
                joints,
                angle,
                degrees_of_freedom: left,
            });
        }
        let error = StructureError::OverConstrained {
            redundant_count,
            joints: mechanism.actuators.iter().map(|a| a.kind.joint()).collect(),
            actuators: (0..self.actuators()).map(ActuatorId).collect(),
        };
        Err(error.into())
    }

    fn under_actuated(
        &self,
        mechanism: &Mechanism,
        missing: usize,
        bodies: Vec<BodyId>,
    ) -> AssemblyError {
        let all = (0..mechanism.bodies.len())
            .filter(|b| *b != self.ground)
            .map(BodyId);
        StructureError::UnderActuated {
            degrees_of_freedom: self.actuators() + missing,
            actuators: self.actuators(),
            bodies: if bodies.is_empty() {
                all.collect()
            } else {
                bodies
            },
            redundant_joints: Vec::new(),
        }
        .into()
    }

    /// The bodies that turn idly, if that is all that moves while the actuators are locked.
    fn idle_bodies(
        &self,
        mechanism: &Mechanism,
        svd: Option<&Svd>,
        rank: usize,
        pose: &mut Pose,
    ) -> Result<Vec<IdleBody>, AssemblyError> {
        let group = &self.groups[0];
        let n = group.unknowns.len();
        let mut found: Vec<Option<IdleBody>> = vec![None; mechanism.bodies.len()];
        let mut moves = vec![false; mechanism.bodies.len()];
        let mut is_spin = true;
        for k in rank..n {
            pose.motion.rates.fill(0.0);
            for (j, (freedom, unit)) in group.unknowns.iter().zip(&group.column_scales).enumerate()
            {
                pose.motion.rates[*freedom] =
                    svd.map_or(f64::from(j == k), |svd| svd.v[(j, k)]) * unit;
            }
            self.fill_states(pose);
            for body in 0..mechanism.bodies.len() {
                let motion = self.state(pose, body);
                let (w, v) = (motion.angular_velocity, motion.velocity);
                if w.norm().max(v.norm() / self.size) < PART {
                    continue;
                }
                moves[body] = true;
                // A rotation about a line: v·ω = 0, and the line's nearest point is ω × v / ω².
                let along = if w.norm() > PART {
                    v.dot(w).abs() / w.norm() / self.size
                } else {
                    1.0
                };
                let rotation = self.placement(pose, body).rotation;
                let axis = rotation.apply_inverse(w).unit().unwrap_or(Vec3::ZERO);
                let nearest = w.cross(v).scaled(1.0 / w.dot(w).max(f64::MIN_POSITIVE));
                let in_body = pose.frames[body].rotation.apply_inverse(nearest);
                let point = self.tree.internal[body].point(in_body);
                is_spin &= along < PART && hangs_between_balls(mechanism, body);
                let here = IdleBody {
                    body: BodyId(body),
                    point,
                    axis,
                };
                let other = found[body].replace(here);
                is_spin &= other.is_none_or(|o| {
                    o.axis.cross(axis).norm() < PART
                        && (o.point - point).cross(axis).norm() < PART * self.size
                });
            }
        }
        let idle: Vec<IdleBody> = found.into_iter().flatten().collect();
        if is_spin && idle.len() == n - rank {
            return Ok(idle);
        }
        let bodies = (0..moves.len()).filter(|b| moves[*b]).map(BodyId).collect();
        Err(self.under_actuated(mechanism, n - rank, bodies))
    }

    /// Adds a row for each idle body: it does not turn about its line.
    fn hold(&mut self, idle: &[IdleBody]) {
        for one in idle {
            let body = one.body.0;
            let axis = self.tree.internal[body].rotation.apply_inverse(one.axis);
            let bodies = [self.ground, body];
            let kinds = vec![RowKind::NoSpin(axis)];
            let begin = self.row_and_entry_counts();
            let closure = Closure::new(&self.tree, None, bodies, [Vec3::ZERO; 2], kinds, begin);
            self.closures.push(closure);
        }
        self.schedule_whole();
    }

    /// Rows that determine all unknowns: in the order of how few unknowns they have, each that is independent of those before.
    fn independent_rows(&self, pose: &Pose) -> Vec<usize> {
        let group = &self.groups[0];
        let matrix = self.dense(group, pose);
        let n = group.unknowns.len();
        let mut order: Vec<usize> = (0..group.rows.len()).collect();
        let moving = |r: &usize| {
            let (c, k) = group.rows[*r];
            let closure = &self.closures[c];
            (0..closure.path.len())
                .filter(|p| closure.is_moved(k, *p))
                .count()
        };
        order.sort_by_key(moving);
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let row = |r: usize| -> Vec<f64> { (0..n).map(|j| matrix[(r, j)]).collect() };
        let largest = (0..group.rows.len())
            .map(|r| norm(&row(r)))
            .fold(0.0, f64::max);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut chosen = Vec::new();
        for r in order {
            let mut row = row(r);
            let before = norm(&row);
            for _ in 0..2 {
                for b in &basis {
                    let part: f64 = row.iter().zip(b).map(|(x, y)| x * y).sum();
                    row.iter_mut().zip(b).for_each(|(x, y)| *x -= part * y);
                }
            }
            let after = norm(&row);
            // A row that no unknown changes, such as one across the plane of a planar mechanism, is not zero but rounding.
            if after > 1e-7 * before && before > RANK_TOLERANCE * largest {
                row.iter_mut().for_each(|x| *x /= after);
                basis.push(row);
                chosen.push(r);
            }
        }
        chosen.sort_unstable();
        chosen
    }

    /// Multipliers of all rows, N or N·m, that no load makes: Jᵀ λ = 0 at the pose. A reaction that one of them changes is not
    /// determined. The pose then has the wrenches of all rows.
    pub fn self_stresses(&self, pose: &mut Pose) -> Vec<Vec<f64>> {
        let group = self.group(self.unknowns(), self.all_rows());
        // Rows that nothing moves, too.
        self.fill_rows(&group, pose);
        let Some(svd) = self.dense(&group, pose).svd() else {
            return Vec::new();
        };
        let rank = svd.rank(RANK_TOLERANCE);
        let of = |k: usize| {
            (0..group.rows.len())
                .map(|i| svd.u[(i, k)] * group.row_scales[i])
                .collect()
        };
        (rank..group.rows.len()).map(of).collect()
    }
}
