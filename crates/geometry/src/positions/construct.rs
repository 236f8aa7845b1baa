//! Groups whose positions are constructions: the triangle of a dyad, a line that meets a circle, gears
//! on their carriers. Velocities, accelerations and multipliers come from the factors of their Jacobian.

use super::closed_forms::checked_sqrt;
use crate::error::PositionError;
use crate::plan::{FactoredGroup, LoopClosure, PlacementMethod, Plan, Pose};
use crate::plane::Vec2;
use crate::structure::groups::{Group, Unknown};
use dwell_numerics::{Constant, FactorOutcome, Lift, Scalar};

impl<C: Constant> Plan<C> {
    /// The positions of a dyad of one loop in closed form.
    //
    // Long: one construction for each placement method, all from the same known part of the loop.
    pub(crate) fn construct<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let closure = &self.loop_closures[self.groups[group].group.loops[0]];
        // With its classes at angle zero, the vectors of each are in that class's own frame.
        for &unknown in &self.groups[group].group.unknowns {
            match unknown {
                Unknown::ClassAngle(class) => {
                    pose.rotation[self.class_frame(class)] = Vec2::IDENTITY.cast();
                }
                Unknown::SlideTravel(slide) => pose.slide_travel[slide] = T::from_f64(0.0),
            }
        }
        self.rotate_group(group, pose);
        let class_of = |frame: usize| self.frames.frames[frame].orientation_class;
        let branch = T::from_f64(factored_group.root_sign);
        match factored_group.method {
            PlacementMethod::Triangle(one, two) => {
                let w1 = partial_gap(closure, pose, |f| class_of(f) == one);
                let w2 = partial_gap(closure, pose, |f| class_of(f) == two);
                let known = closure.fixed.cast()
                    + partial_gap(closure, pose, |f| class_of(f) != one && class_of(f) != two);
                let [first, second] = triangle(known, w1, w2, branch, group, pose)?;
                pose.rotation[self.class_frame(one)] = rotation_between(w1, first);
                pose.rotation[self.class_frame(two)] = rotation_between(w2, second);
            }
            PlacementMethod::LineCircle(class, slide) => {
                let class_part = partial_gap(closure, pose, |f| class_of(f) == class);
                let known =
                    closure.fixed.cast() + partial_gap(closure, pose, |f| class_of(f) != class);
                let Some(&(_, along, frame)) = closure.slides.iter().find(|s| s.0 == slide) else {
                    return Ok(());
                };
                let along = pose.vector[along];
                // |R w| = |D + s u|, or |D| = |w + s u|: where a line meets a circle.
                let direction_rotates = class_of(frame) == class;
                let (from, radius) = if direction_rotates {
                    (class_part, known)
                } else {
                    (known, class_part)
                };
                let offset = from.cross(along);
                let square = radius.dot(radius);
                let missing = || offset.value().abs() - square.value().sqrt();
                let q = pose.first_coordinate();
                let size = |l| square.lane(l).max(offset.lane(l) * offset.lane(l));
                // The sum of both is no smaller, and at most twice as large.
                let sizes = || square + offset * offset;
                let half_chord = branch
                    * checked_sqrt(square - offset * offset, size, sizes, group, q, missing)?;
                let travel = half_chord - from.dot(along);
                pose.slide_travel[slide] = travel;
                let reached = from + along * travel;
                pose.rotation[self.class_frame(class)] = if direction_rotates {
                    rotation_between(reached, -known)
                } else {
                    rotation_between(class_part, -reached)
                };
            }
            PlacementMethod::PointOnLine(class) => {
                let class_part = partial_gap(closure, pose, |f| class_of(f) == class);
                let known =
                    closure.fixed.cast() + partial_gap(closure, pose, |f| class_of(f) != class);
                let Some((axis, frame)) = closure.axis else {
                    return Ok(());
                };
                let along = pose.vector[axis];
                let normal = along.perp();
                // The vector that turns against one that is known, and where it must get to along
                // the normal.
                let line_rotates = class_of(frame) == class;
                let (kappa, square) = if line_rotates {
                    (-normal.dot(class_part), known.dot(known))
                } else {
                    (-normal.dot(known), class_part.dot(class_part))
                };
                let missing = || kappa.value().abs() - square.value().sqrt();
                let q = pose.first_coordinate();
                let size = |l| square.lane(l).max(kappa.lane(l) * kappa.lane(l));
                let sizes = || square + kappa * kappa;
                let half_chord =
                    branch * checked_sqrt(square - kappa * kappa, size, sizes, group, q, missing)?;
                pose.rotation[self.class_frame(class)] = if line_rotates {
                    rotation_between(normal, known * kappa + known.perp() * half_chord)
                } else {
                    rotation_between(class_part, normal * kappa - along * half_chord)
                };
            }
            PlacementMethod::Newton | PlacementMethod::Linear | PlacementMethod::GearTrain => {}
        }
        Ok(())
    }

    /// The positions of gears, from equations in which each line of centres turns with its carrier; leaves
    /// the factors of the real Jacobian in the pose.
    pub(crate) fn gear_train_positions<T: Lift<C>>(
        &self,
        group: usize,
        factored_group: &FactoredGroup,
        pose: &mut Pose<T>,
    ) -> Result<FactorOutcome, PositionError> {
        let Group {
            unknowns, loops, ..
        } = &self.groups[group].group;
        for class in self.groups[group].group.classes() {
            self.set_class_angle(class, T::from_f64(0.0), pose);
        }
        self.rotate_group(group, pose);
        self.residual(group, pose);
        self.assemble_jacobian(group, factored_group, pose);
        let n = factored_group.columns;
        let mut next_row = 0;
        for &l in loops {
            let row = next_row;
            let Some((_, line_frame)) = self.loop_closures[l].axis else {
                // No unknown can open it.
                next_row += 2;
                continue;
            };
            next_row += 1;
            let Some(&(carrier, phase)) = self.carrier_phases.get(&line_frame) else {
                continue;
            };
            pose.workspace[row] = pose.angle[line_frame] - pose.angle[carrier] - T::from_f64(phase);
            for (column, &unknown) in unknowns.iter().enumerate() {
                let of = |frame: usize| {
                    let class = self.frames.frames[frame].orientation_class;
                    f64::from(u8::from(unknown == Unknown::ClassAngle(class)))
                };
                let entry = &mut pose.lu[factored_group.lu_offset + row * n + column];
                *entry = T::from_f64(of(line_frame) - of(carrier));
            }
        }
        factored_group.factor(group, pose)?;
        self.apply_newton_step(group, factored_group, pose);
        self.rotate_group(group, pose);
        self.check_redundant(group, factored_group, pose)?;
        self.factor_jacobian(group, factored_group, pose)
    }
}

/// The part of a loop whose frames are picked: its vectors and its slides.
fn partial_gap<C, T: Scalar>(
    closure: &LoopClosure<C>,
    pose: &Pose<T>,
    pick: impl Fn(usize) -> bool,
) -> Vec2<T> {
    let mut sum = Vec2::zero();
    for &(vector, frame) in &closure.vectors {
        if pick(frame) {
            sum += pose.vector[vector];
        }
    }
    for &(slide, vector, frame) in &closure.slides {
        if pick(frame) {
            sum += pose.vector[vector] * pose.slide_travel[slide];
        }
    }
    sum
}

/// The rotation that takes the direction of one vector to that of another.
fn rotation_between<T: Scalar>(from: Vec2<T>, to: Vec2<T>) -> Vec2<T> {
    let by = to.rotate_inverse(from);
    by * (T::from_f64(1.0) / by.dot(by).sqrt())
}

/// Two vectors of the lengths of `w1` and `w2` that close a triangle with `known`.
fn triangle<T: Scalar>(
    known: Vec2<T>,
    w1: Vec2<T>,
    w2: Vec2<T>,
    branch: T,
    group: usize,
    pose: &Pose<T>,
) -> Result<[Vec2<T>; 2], PositionError> {
    let (half, square) = (T::from_f64(0.5), known.dot(known));
    let [one, two] = [w1.dot(w1).sqrt(), w2.dot(w2).sqrt()];
    let (sum, gap) = (one + two, one - two);
    let rest = (sum * sum - square) * (square - gap * gap);
    let missing = || {
        let distance = square.value().sqrt();
        (distance - sum.value()).max(gap.value().abs() - distance)
    };
    let q = pose.first_coordinate();
    let size = |lane| square.lane(lane) * square.lane(lane);
    let double_area =
        checked_sqrt(rest, size, || square * square, group, q, missing)? * half * branch;
    let across = known.perp() * double_area;
    let square_difference = -(gap * sum);
    let inverse = T::from_f64(1.0) / square;
    Ok([
        (known * (half * (square_difference - square)) + across) * inverse,
        (known * (half * (-square_difference - square)) - across) * inverse,
    ])
}
