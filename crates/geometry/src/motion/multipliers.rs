//! The multipliers of the loops and couplings that balance given moments and forces.

use crate::plan::{AssurGroup, FactoredGroup, GroupKind, KnownTerms, Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::structure::groups::Unknown;
use dwell_numerics::{Constant, Scalar, map_array};

/// Moments and forces that the loops must balance, and the multipliers that do, for `N` load cases side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceBalance<T, const N: usize> {
    /// By frame: the moment on everything that turns with it, N·m. Before [`Plan::multipliers`]: the moment of the
    /// inertia forces and loads. After it: the moment that an actuator must supply.
    pub moment: Vec<[T; N]>,
    /// By slide: the force along it, N.
    pub slide_force: Vec<[T; N]>,
    /// By closure: the force of the first body on the second, N, as (x, y) for a revolute
    /// loop joint and as (normal, 0) for a prismatic one.
    pub loop_multiplier: Vec<[Vec2<T>; N]>,
    /// By coupling: its multiplier, N, or N·m for a coupling of angles.
    pub coupling_multiplier: Vec<[T; N]>,
    workspace: Vec<T>,
}

impl<C: Constant> Plan<C> {
    /// A balance with the right sizes.
    pub fn force_balance<T: Scalar, const N: usize>(&self) -> ForceBalance<T, N> {
        let zero = [T::from_f64(0.0); N];
        ForceBalance {
            moment: vec![zero; self.frames.frames.len()],
            slide_force: vec![zero; self.tree.slide_pairs.len()],
            loop_multiplier: vec![[Vec2::zero(); N]; self.loop_closures.len()],
            coupling_multiplier: vec![zero; self.couplings.len()],
            workspace: self.workspace(),
        }
    }

    /// The loops' multipliers for given moments on the frames and forces along the slides, by
    /// groups in reverse order, and what then remains on the actuated frames.
    #[inline(always)]
    pub fn multipliers<T: Scalar, const N: usize>(
        &self,
        pose: &Pose<T>,
        balance: &mut ForceBalance<T, N>,
    ) {
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse_determinant).rev() {
            if assur.pruned {
                // Nothing acts on it.
                continue;
            }
            match &assur.kind {
                GroupKind::RrrDyad(dyad) => {
                    let one = class_moment(assur, dyad.frames[0], &balance.moment);
                    let two = class_moment(assur, dyad.frames[1], &balance.moment);
                    let [r1, r2] = map_array(dyad.vectors, |a| pose.vector[a] * inverse);
                    let multiplier = &mut balance.loop_multiplier[dyad.closure];
                    for ((value, one), two) in multiplier.iter_mut().zip(one).zip(two) {
                        *value = r2 * one - r1 * two;
                    }
                }
                GroupKind::GuidedPoint(guided) => {
                    let moment = class_moment(assur, guided.frame, &balance.moment);
                    balance.loop_multiplier[guided.closure] =
                        map_array(moment, |moment| vec2(moment * inverse, T::from_f64(0.0)));
                }
                GroupKind::Factored(factored_group) => {
                    self.factored_multipliers(assur, factored_group, pose, balance);
                }
            }
            for known_terms in &assur.known_terms {
                apply_multiplier(known_terms, pose, balance);
            }
            for &r in &assur.group.couplings {
                self.apply_coupling_multiplier(assur, r, pose, balance);
            }
        }
    }

    #[inline(never)]
    fn factored_multipliers<T: Scalar, const N: usize>(
        &self,
        assur: &AssurGroup<C>,
        factored_group: &FactoredGroup,
        pose: &Pose<T>,
        balance: &mut ForceBalance<T, N>,
    ) {
        for n in 0..N {
            for (value, &unknown) in balance.workspace.iter_mut().zip(&assur.group.unknowns) {
                *value = match unknown {
                    Unknown::ClassAngle(c) => {
                        class_moment(assur, self.class_frame(c), &balance.moment)[n]
                    }
                    Unknown::SlideTravel(s) => balance.slide_force[s][n] * T::from_f64(assur.scale),
                };
            }
            factored_group.solve_transposed(pose, &mut balance.workspace[..factored_group.rows]);
            let mut row = 0;
            for &l in &assur.group.loops {
                let first = balance.workspace[row];
                row += 1;
                let mut second = T::from_f64(0.0);
                if self.loop_closures[l].axis.is_none() {
                    second = balance.workspace[row];
                    row += 1;
                }
                balance.loop_multiplier[l][n] = vec2(first, second);
            }
            for &r in &assur.group.couplings {
                balance.coupling_multiplier[r][n] =
                    balance.workspace[row] * assur.coupling_weight::<T>(&self.couplings[r]);
                row += 1;
            }
        }
    }

    /// Subtracts a coupling's multiplier from the frames and slides that its group does not determine.
    #[inline(never)]
    fn apply_coupling_multiplier<T: Scalar, const N: usize>(
        &self,
        assur: &AssurGroup<C>,
        coupling: usize,
        pose: &Pose<T>,
        balance: &mut ForceBalance<T, N>,
    ) {
        let ForceBalance {
            moment,
            slide_force,
            coupling_multiplier: multipliers,
            ..
        } = balance;
        let multiplier = multipliers[coupling];
        let in_group = |frame: usize| {
            let mut classes = assur.group.classes();
            classes.any(|class| self.class_frame(class) == frame)
        };
        self.couplings[coupling].for_each_derivative(
            &pose.angle,
            &pose.slide_travel,
            |frame, by| {
                if !in_group(frame) {
                    for (moment, m) in moment[frame].iter_mut().zip(multiplier) {
                        *moment -= by * m;
                    }
                }
            },
            |slide, by| {
                for (slide_force, m) in slide_force[slide].iter_mut().zip(multiplier) {
                    *slide_force -= by * m;
                }
            },
        );
    }
}

/// The moment on a whole class of a group: on its first frame and those driven from it.
#[inline(always)]
fn class_moment<C, T: Scalar, const N: usize>(
    assur: &AssurGroup<C>,
    class_frame: usize,
    moment: &[[T; N]],
) -> [T; N] {
    let mut sum = moment[class_frame];
    for one in assur
        .actuated_frames
        .iter()
        .filter(|d| d.class_frame == class_frame)
    {
        for (sum, m) in sum.iter_mut().zip(moment[one.frame]) {
            *sum += m;
        }
    }
    sum
}

/// Subtracts a loop's multiplier from the frames and slides that its group does not determine.
#[inline(always)]
fn apply_multiplier<T: Scalar, const N: usize>(
    known_terms: &KnownTerms,
    pose: &Pose<T>,
    balance: &mut ForceBalance<T, N>,
) {
    let multiplier = balance.loop_multiplier[known_terms.closure];
    let force = match known_terms.axis {
        None => multiplier,
        Some(axis) => {
            let normal = pose.vector[axis].perp();
            map_array(multiplier, |m| normal * m.x)
        }
    };
    for &(vector, frame) in &known_terms.vectors {
        let vector = pose.vector[vector];
        for (moment, f) in balance.moment[frame].iter_mut().zip(force) {
            *moment -= vector.cross(f);
        }
    }
    if let Some(frame) = known_terms.axis_frame {
        let travel = pose.closure_travel[known_terms.closure];
        for (moment, m) in balance.moment[frame].iter_mut().zip(multiplier) {
            *moment += travel * m.x;
        }
    }
    for &(slide, vector, frame) in &known_terms.slides {
        let along = pose.vector[vector];
        let travel_vector = along * pose.slide_travel[slide];
        for (moment, f) in balance.moment[frame].iter_mut().zip(force) {
            *moment -= travel_vector.cross(f);
        }
        for (slide_force, f) in balance.slide_force[slide].iter_mut().zip(force) {
            *slide_force -= along.dot(f);
        }
    }
}
