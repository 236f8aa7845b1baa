//! Positions from known solutions of the groups that iterations solve: no decision depends on the iterations, and one step of
//! Newton's method, u − J⁻¹ f(u), has the derivatives of the solution.

use super::InitialIterate;
use crate::error::PositionError;
use crate::plan::{FactoredGroup, PlacementMethod, Plan, Pose};
use crate::structure::groups::Unknown;
use dwell_numerics::{Constant, FactorOutcome, Lift};

impl<C: Constant> Plan<C> {
    /// The unknowns of the groups that iterations solve, pruned groups left out.
    fn iterated_unknowns(&self) -> impl Iterator<Item = Unknown> {
        let is_iterated = |method| method == Some(PlacementMethod::Newton);
        let groups = self.groups.iter().filter(|g| !g.pruned);
        let groups = groups.filter(move |g| is_iterated(g.kind.placement_method()));
        groups.flat_map(|g| g.group.unknowns.iter().copied())
    }

    /// The values of the unknowns of these groups in a pose, rad or m.
    pub fn iterated_values(&self, pose: &Pose<f64>) -> Vec<f64> {
        let value = |unknown| match unknown {
            Unknown::ClassAngle(class) => {
                let frame = self.class_frame(class);
                if self.revolution_counted[frame] {
                    pose.angle[frame]
                } else {
                    pose.rotation[frame].angle()
                }
            }
            Unknown::SlideTravel(slide) => pose.slide_travel[slide],
        };
        self.iterated_unknowns().map(value).collect()
    }

    /// Computes the positions at the coordinates `q` (rad or m), at which the unknowns of the groups that iterations solve have the
    /// `values` of [`iterated_values`](Self::iterated_values).
    ///
    /// # Errors
    /// [`PositionError`] when a group cannot close or is singular.
    pub fn positions_at_solution<T: Lift<C>>(
        &self,
        q: &[T],
        values: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        for (unknown, &value) in self.iterated_unknowns().zip(values) {
            match unknown {
                Unknown::ClassAngle(class) => self.set_class_angle(class, value, pose),
                Unknown::SlideTravel(slide) => pose.slide_travel[slide] = value,
            }
        }
        self.positions_from(q, pose, InitialIterate::Solution)
    }

    /// The positions of a group by Newton's method, from where it starts; leaves the factors of the Jacobian where it ends.
    pub(super) fn iterated_positions<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
        initial_iterate: InitialIterate,
    ) -> Result<FactorOutcome, PositionError> {
        match initial_iterate {
            InitialIterate::StoredPose => self.set_predicted_pose(group, pose)?,
            InitialIterate::CurrentPose => {}
            InitialIterate::Solution => return self.step_at_solution(group, factored_group, pose),
        }
        self.solve_by_newton(group, factored_group, pose)
    }

    /// One step of Newton's method at a solution; leaves the factors of the Jacobian after it.
    fn step_at_solution<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<FactorOutcome, PositionError> {
        self.rotate_group(group, pose);
        self.residual(group, pose);
        self.factor_jacobian(group, factored_group, pose)?;
        self.apply_newton_step(group, factored_group, pose);
        self.rotate_group(group, pose);
        self.factor_jacobian(group, factored_group, pose)
    }
}
