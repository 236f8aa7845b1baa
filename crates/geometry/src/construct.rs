//! Groups whose position is a construction: the triangle of a dyad, a line that meets a circle, gears
//! on their carriers. What follows from the position comes from the factors of their Jacobian.

use crate::error::PlaceError;
use crate::groups::{Group, Unknown};
use crate::place::{root, singular};
use crate::plan::{Closure, How, Plan, Pose, Solved};
use crate::plane::Vec2;
use crate::scalar::Scalar;
use crate::small::{self, Factored};

impl Plan {
    /// Places a dyad of one loop in closed form.
    pub(crate) fn construct<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) -> Result<(), PlaceError> {
        let closure = &self.closures[self.groups[group].group.loops[0]];
        // With its classes unturned, what hangs on each is in that class's own frame.
        for &unknown in &self.groups[group].group.unknowns {
            match unknown {
                Unknown::Class(class) => pose.turn[self.root_of(class)] = Vec2::IDENTITY.lift(),
                Unknown::Slide(slide) => pose.slide[slide] = T::lift(0.0),
            }
        }
        self.turn_group(group, pose);
        let class_of = |frame: usize| self.frames.frames[frame].class;
        let branch = T::lift(solved.side);
        match solved.how {
            How::Triangle(one, two) => {
                let w1 = part(closure, pose, |f| class_of(f) == one);
                let w2 = part(closure, pose, |f| class_of(f) == two);
                let known = closure.fixed.lift()
                    + part(closure, pose, |f| class_of(f) != one && class_of(f) != two);
                let [first, second] = triangle(known, w1, w2, branch, (group, pose))?;
                pose.turn[self.root_of(one)] = turned(w1, first);
                pose.turn[self.root_of(two)] = turned(w2, second);
            }
            How::Reach(class, slide) => {
                let own = part(closure, pose, |f| class_of(f) == class);
                let known = closure.fixed.lift() + part(closure, pose, |f| class_of(f) != class);
                let Some(&(_, along, frame)) = closure.slides.iter().find(|s| s.0 == slide) else {
                    return Ok(());
                };
                let along = pose.arm[along];
                // |R w| = |D + s u|, or |D| = |w + s u|: where a line meets a circle.
                let turns_too = class_of(frame) == class;
                let (from, radius) = if turns_too {
                    (own, known)
                } else {
                    (known, own)
                };
                let off = from.cross(along);
                let square = radius.dot(radius);
                let missing = || off.value().abs() - square.value().sqrt();
                let q = pose.q[0].value();
                let size = |l| square.lane(l).max(off.lane(l) * off.lane(l));
                let reach = branch * root(square - off * off, size, group, q, missing)?;
                let travel = reach - from.dot(along);
                pose.slide[slide] = travel;
                let reached = from + along * travel;
                pose.turn[self.root_of(class)] = if turns_too {
                    turned(reached, -known)
                } else {
                    turned(own, -reached)
                };
            }
            How::Guide(class) => {
                let own = part(closure, pose, |f| class_of(f) == class);
                let known = closure.fixed.lift() + part(closure, pose, |f| class_of(f) != class);
                let Some((axis, frame)) = closure.axis else {
                    return Ok(());
                };
                let along = pose.arm[axis];
                let normal = along.perp();
                // The vector that turns against one that is known, and where it must get to along
                // the normal.
                let line_turns = class_of(frame) == class;
                let (kappa, square) = if line_turns {
                    (-normal.dot(own), known.dot(known))
                } else {
                    (-normal.dot(known), own.dot(own))
                };
                let missing = || kappa.value().abs() - square.value().sqrt();
                let q = pose.q[0].value();
                let size = |l| square.lane(l).max(kappa.lane(l) * kappa.lane(l));
                let reach = branch * root(square - kappa * kappa, size, group, q, missing)?;
                pose.turn[self.root_of(class)] = if line_turns {
                    turned(normal, known * kappa + known.perp() * reach)
                } else {
                    turned(own, normal * kappa - along * reach)
                };
            }
            How::Newton | How::Linear | How::Geared => {}
        }
        Ok(())
    }

    /// Places gears by equations in which each line of centres turns with its carrier, and leaves
    /// the factors of the real Jacobian.
    pub(crate) fn mesh<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) -> Result<Factored, PlaceError> {
        let Group {
            unknowns, loops, ..
        } = &self.groups[group].group;
        for &unknown in unknowns {
            if let Unknown::Class(class) = unknown {
                self.set_angle(class, T::lift(0.0), pose);
            }
        }
        self.turn_group(group, pose);
        self.residual(group, pose);
        self.assemble_jacobian(group, solved, pose);
        let n = solved.columns;
        for (row, &l) in loops.iter().enumerate() {
            let Some((_, line)) = self.closures[l].axis else {
                continue;
            };
            let Some(&(carrier, lead)) = self.beside.get(&line) else {
                continue;
            };
            pose.work[row] = pose.angle[line] - pose.angle[carrier] - T::lift(lead);
            for (column, &unknown) in unknowns.iter().enumerate() {
                let of = |frame: usize| {
                    let class = self.frames.frames[frame].class;
                    f64::from(u8::from(unknown == Unknown::Class(class)))
                };
                let entry = &mut pose.lu[solved.lu + row * n + column];
                *entry = T::lift(of(line) - of(carrier));
            }
        }
        let factored = small::factor(
            &mut pose.lu[solved.lu..solved.lu + n * n],
            &mut pose.pivots[solved.pivots..solved.pivots + n],
        );
        if factored.measure <= singular::<T>() {
            return Err(PlaceError::Singular {
                group,
                q: pose.q.first().map_or(0.0, |q| q.value()),
                measure: factored.measure,
            });
        }
        self.correct(group, solved, pose);
        self.turn_group(group, pose);
        self.factor(group, solved, pose)
    }
}

/// The part of a loop whose frames are picked: its arms and its slides.
fn part<T: Scalar>(closure: &Closure, pose: &Pose<T>, pick: impl Fn(usize) -> bool) -> Vec2<T> {
    let mut sum = Vec2::zero();
    for &(arm, frame) in &closure.arms {
        if pick(frame) {
            sum += pose.arm[arm];
        }
    }
    for &(slide, arm, frame) in &closure.slides {
        if pick(frame) {
            sum += pose.arm[arm] * pose.slide[slide];
        }
    }
    sum
}

/// The rotation that takes the direction of one vector to that of another.
fn turned<T: Scalar>(from: Vec2<T>, to: Vec2<T>) -> Vec2<T> {
    let by = to.turn_back(from);
    by * (T::lift(1.0) / by.dot(by).sqrt())
}

/// Two vectors of the lengths of `w1` and `w2` that close a triangle with `known`.
fn triangle<T: Scalar>(
    known: Vec2<T>,
    w1: Vec2<T>,
    w2: Vec2<T>,
    branch: T,
    (group, pose): (usize, &Pose<T>),
) -> Result<[Vec2<T>; 2], PlaceError> {
    let (half, square) = (T::lift(0.5), known.dot(known));
    let [one, two] = [w1.dot(w1).sqrt(), w2.dot(w2).sqrt()];
    let (sum, gap) = (one + two, one - two);
    let rest = (sum * sum - square) * (square - gap * gap);
    let missing = || {
        let distance = square.value().sqrt();
        (distance - sum.value()).max(gap.value().abs() - distance)
    };
    let q = pose.q[0].value();
    let size = |lane| square.lane(lane) * square.lane(lane);
    let reach = root(rest, size, group, q, missing)? * half * branch;
    let across = known.perp() * reach;
    let excess = -(gap * sum);
    let inverse = T::lift(1.0) / square;
    Ok([
        (known * (half * (excess - square)) + across) * inverse,
        (known * (half * (-excess - square)) - across) * inverse,
    ])
}
