//! Positions: from the actuators' coordinates to the orientation of every body, group by group.

use crate::error::PlaceError;
use crate::groups::{Group, Unknown};
use crate::plan::{Aim, Closure, Driven, Kind, Newton, Pin, Plan, Pose, Step};
use crate::plane::{Vec2, vec2};
use crate::range::Range;
use crate::scalar::Scalar;
use crate::small;
use crate::tree::Arm;

/// Below this determinant, relative to the lengths that make it, nothing is left of the digits.
const SINGULAR: f64 = 1e-14;
/// Newton's correction (rad, or relative to the group's size) after which its square is rounding.
const CONVERGED: f64 = 1e-9;
/// Newton's method doubles its digits in each step: 30 steps are far more than it needs.
const MOST_STEPS: usize = 30;

/// Where Newton's method starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Guess {
    /// From the nearest stored seed, so that the pose depends on the coordinate alone.
    Seed,
    /// From what the pose holds (while the branch is being followed).
    Pose,
}

impl Plan {
    /// Places the mechanism at the coordinates `q` (rad). The pose depends on `q` alone.
    ///
    /// # Errors
    /// [`PlaceError`] when a group cannot close there, is singular, or `q` is out of range.
    pub fn place<T: Scalar>(&self, q: &[T], pose: &mut Pose<T>) -> Result<(), PlaceError> {
        // Outside its range a closed form may close again, but on a branch that cannot be reached.
        if self.range != Range::Full && q[0].value().is_finite() {
            self.range.fold(q[0].value())?;
        }
        self.place_from(q, pose, Guess::Seed)
    }

    pub(crate) fn place_from<T: Scalar>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
        guess: Guess,
    ) -> Result<(), PlaceError> {
        self.place_groups(q, pose, guess, self.groups.len())
    }

    /// Places the first `count` groups only (while a branch is still to be picked).
    pub(crate) fn place_groups<T: Scalar>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
        guess: Guess,
        count: usize,
    ) -> Result<(), PlaceError> {
        for (own, &value) in pose.q.iter_mut().zip(q) {
            if !value.value().is_finite() {
                return Err(PlaceError::NotFinite { q: value.value() });
            }
            *own = value;
        }
        for step in &self.steps {
            match step {
                Step::Turn(driven) => turn(driven, pose),
                Step::Rotate(arm, Arm { frame, local }) => {
                    pose.arm[*arm] = local.lift::<T>().turn(pose.turn[*frame]);
                }
                Step::Solve(g) if *g >= count => return Ok(()),
                Step::Solve(g) => match &self.groups[*g].kind {
                    Kind::Pin(pin) => place_pin(pin, *g, pose)?,
                    Kind::Aim(aim) => place_aim(aim, *g, pose)?,
                    Kind::Newton(newton) => self.place_by_newton(*g, newton, pose, guess)?,
                },
            }
        }
        Ok(())
    }

    /// Apart from the closed forms, which need little of what this keeps at hand.
    #[inline(never)]
    fn place_by_newton<T: Scalar>(
        &self,
        group: usize,
        newton: &Newton,
        pose: &mut Pose<T>,
        guess: Guess,
    ) -> Result<(), PlaceError> {
        if guess == Guess::Seed {
            self.sow(group, newton, pose)?;
        }
        let factored = self.close(group, newton, pose)?;
        // A pose on the other side of a singular position is another branch.
        if guess == Guess::Seed && factored.sign * newton.branch <= 0.0 {
            let q = pose.q[0].value();
            return Err(PlaceError::OtherBranch { group, q });
        }
        for &l in &self.groups[group].group.loops {
            let closure = &self.closures[l];
            if let Some((axis, _)) = closure.axis {
                pose.travel[l] = pose.arm[axis].dot(gap(closure, &pose.arm, &pose.slide));
            }
        }
        Ok(())
    }

    /// Sets a Newton group's unknowns to the first-order prediction from its nearest seed.
    fn sow<T: Scalar>(
        &self,
        group: usize,
        newton: &Newton,
        pose: &mut Pose<T>,
    ) -> Result<(), PlaceError> {
        let q = pose.q[0];
        let (seed, away) = newton.seeds.nearest(q.value(), self.range)?;
        // The derivative of the prediction does not matter: Newton's last step replaces it.
        for (i, &unknown) in self.groups[group].group.unknowns.iter().enumerate() {
            let (value, slope) = (seed.values[i], seed.slopes[i]);
            match unknown {
                Unknown::Class(class) => {
                    let turn = value.turn(Vec2::from_angle(slope * away));
                    pose.turn[self.root_of(class)] = turn.lift();
                }
                Unknown::Slide(slide) => pose.slide[slide] = T::lift(value.x + slope * away),
            }
        }
        Ok(())
    }

    /// Newton's method; leaves the factors of the Jacobian where it ends.
    fn close<T: Scalar>(
        &self,
        group: usize,
        newton: &Newton,
        pose: &mut Pose<T>,
    ) -> Result<small::Factored, PlaceError> {
        let q = pose.q[0].value();
        let size = self.groups[group].size;
        let n = self.groups[group].group.unknowns.len();
        let mut residual = f64::INFINITY;
        let mut once_more = true;
        for _ in 0..MOST_STEPS {
            self.turn_group(group, pose);
            residual = self.residual(group, pose);
            self.factor(group, newton, pose)?;
            let mut work = std::mem::take(&mut pose.work);
            small::solve(
                &pose.lu[newton.lu..newton.lu + n * n],
                &pose.pivots[newton.pivots..newton.pivots + n],
                &mut work[..n],
            );
            let mut largest = 0.0_f64;
            let unknowns = &self.groups[group].group.unknowns;
            for (&unknown, &step) in unknowns.iter().zip(&work) {
                let change = match unknown {
                    Unknown::Class(class) => {
                        let frame = self.root_of(class);
                        let (sin, cos) = step.sin_cos();
                        pose.turn[frame] = pose.turn[frame].turn(vec2(cos, -sin));
                        step.value().abs()
                    }
                    Unknown::Slide(slide) => {
                        pose.slide[slide] -= step;
                        step.value().abs() / size
                    }
                };
                largest = if change.is_nan() {
                    f64::INFINITY
                } else {
                    largest.max(change)
                };
            }
            pose.work = work;
            if !largest.is_finite() {
                break;
            }
            // One step past convergence: it makes the derivative of a dual number exact.
            if largest < CONVERGED && !std::mem::replace(&mut once_more, false) {
                self.turn_group(group, pose);
                return self.factor(group, newton, pose);
            }
        }
        Err(PlaceError::NotClosed { group, q, residual })
    }

    /// Turns a group's driven frames and rotates the arms of its loops, after its unknowns changed.
    fn turn_group<T: Scalar>(&self, group: usize, pose: &mut Pose<T>) {
        let assur = &self.groups[group];
        for driven in &assur.driven {
            turn(driven, pose);
        }
        for &l in &assur.group.loops {
            let Closure {
                arms, slides, axis, ..
            } = &self.closures[l];
            let slid = slides.iter().map(|&(_, a, _)| a);
            for arm in arms.iter().chain(axis).map(|&(a, _)| a).chain(slid) {
                let Arm { frame, local } = self.arms[arm];
                pose.arm[arm] = local.lift::<T>().turn(pose.turn[frame]);
            }
        }
    }

    /// Writes a Newton group's residual into the work space; its largest component, m.
    fn residual<T: Scalar>(&self, group: usize, pose: &mut Pose<T>) -> f64 {
        let mut row = 0;
        let mut largest = 0.0_f64;
        for &l in &self.groups[group].group.loops {
            let closure = &self.closures[l];
            let open = gap(closure, &pose.arm, &pose.slide);
            if let Some((axis, _)) = closure.axis {
                pose.work[row] = pose.arm[axis].perp().dot(open);
                row += 1;
            } else {
                pose.work[row] = open.x;
                pose.work[row + 1] = open.y;
                row += 2;
            }
        }
        for value in &pose.work[..row] {
            largest = largest.max(value.value().abs());
        }
        largest
    }

    /// Assembles and factors a Newton group's Jacobian at the pose.
    pub(crate) fn factor<T: Scalar>(
        &self,
        group: usize,
        newton: &Newton,
        pose: &mut Pose<T>,
    ) -> Result<small::Factored, PlaceError> {
        let Group { unknowns, loops } = &self.groups[group].group;
        let n = unknowns.len();
        let mut row = newton.lu;
        for &l in loops {
            let closure = &self.closures[l];
            let open = gap(closure, &pose.arm, &pose.slide);
            for (column, &unknown) in unknowns.iter().enumerate() {
                let change = self.change(closure, unknown, pose);
                if let Some((axis, frame)) = closure.axis {
                    let along = pose.arm[axis];
                    let mut entry = along.perp().dot(change);
                    if unknown == Unknown::Class(self.frames.frames[frame].class) {
                        entry -= along.dot(open);
                    }
                    pose.lu[row + column] = entry;
                } else {
                    pose.lu[row + column] = change.x;
                    pose.lu[row + n + column] = change.y;
                }
            }
            row += if closure.axis.is_some() { n } else { 2 * n };
        }
        let factored = small::factor(
            &mut pose.lu[newton.lu..newton.lu + n * n],
            &mut pose.pivots[newton.pivots..newton.pivots + n],
        );
        if factored.measure > SINGULAR {
            Ok(factored)
        } else {
            Err(PlaceError::Singular {
                group,
                q: pose.q[0].value(),
                measure: factored.measure,
            })
        }
    }

    /// ∂L/∂unknown of a loop L = P₂ − P₁.
    fn change<T: Scalar>(&self, closure: &Closure, unknown: Unknown, pose: &Pose<T>) -> Vec2<T> {
        let mut sum = Vec2::zero();
        match unknown {
            Unknown::Class(class) => {
                let of_class = |frame: usize| self.frames.frames[frame].class == class;
                for &(arm, frame) in &closure.arms {
                    if of_class(frame) {
                        sum += pose.arm[arm].perp();
                    }
                }
                for &(slide, arm, frame) in &closure.slides {
                    if of_class(frame) {
                        sum += pose.arm[arm].perp() * pose.slide[slide];
                    }
                }
            }
            Unknown::Slide(slide) => {
                for &(s, arm, _) in &closure.slides {
                    if s == slide {
                        sum += pose.arm[arm];
                    }
                }
            }
        }
        sum
    }

    /// The frame whose angle is a class's unknown.
    pub(crate) fn root_of(&self, class: usize) -> usize {
        self.class_roots[class]
    }

    /// The root of each carried body in ground axes, in their order, m.
    pub fn roots<T: Scalar>(&self, pose: &Pose<T>, roots: &mut Vec<Vec2<T>>) {
        roots.clear();
        for (carried, carry) in self.carried.iter().zip(&self.tree.carries) {
            let mut root = match carried.parent {
                Some(parent) => roots[parent],
                None => self.ground_root().lift(),
            };
            root += match carried.arm {
                Some(arm) => pose.arm[arm],
                None => carry.arm.local.lift(),
            };
            if let Some((slide, direction)) = carried.slide {
                root += pose.arm[direction] * pose.slide[slide];
            }
            roots.push(root);
        }
    }

    fn ground_root(&self) -> Vec2 {
        self.tree.roots[self.ground]
    }
}

/// Turns a frame by its actuator's coordinate.
fn turn<T: Scalar>(driven: &Driven, pose: &mut Pose<T>) {
    let (sin, cos) = pose.q[driven.actuator].sin_cos();
    let by = vec2(cos, if driven.sign < 0.0 { -sin } else { sin });
    pose.turn[driven.frame] = if driven.parent == 0 {
        by
    } else {
        pose.turn[driven.parent].turn(by)
    };
}

/// A constant vector and some rotated arms, summed.
#[inline]
fn sum<T: Scalar>(fixed: Vec2, arms: &[(usize, usize)], arm: &[Vec2<T>]) -> Vec2<T> {
    let mut sum = fixed.lift();
    for &(a, _) in arms {
        sum += arm[a];
    }
    sum
}

/// L = P₂ − P₁ as its arms and slides have it.
#[inline]
fn gap<T: Scalar>(closure: &Closure, arm: &[Vec2<T>], slide: &[T]) -> Vec2<T> {
    let mut sum = sum(closure.fixed, &closure.arms, arm);
    for &(s, a, _) in &closure.slides {
        sum += arm[a] * slide[s];
    }
    sum
}

/// Two arms of known length that close a triangle with the known part D of the loop.
fn place_pin<T: Scalar>(pin: &Pin, group: usize, pose: &mut Pose<T>) -> Result<(), PlaceError> {
    let known = sum(pin.fixed, &pin.known, &pose.arm);
    let square = known.dot(known);
    // (2 × area)² by factors that keep their digits near a stretched or folded triangle.
    let rest = (T::lift(pin.sum2) - square) * (square - T::lift(pin.gap2));
    let size = square.value() * square.value();
    let q = pose.q[0].value();
    let missing = || {
        let distance = square.value().sqrt();
        (distance - pin.sum2.sqrt()).max(pin.gap2.sqrt() - distance)
    };
    let reach = root(rest, size, group, q, missing)? * T::lift(0.5 * pin.branch);
    let half = T::lift(0.5);
    let excess = T::lift(pin.excess);
    let inverse = T::lift(1.0) / square;
    let across = known.perp() * reach;
    let first = (known * (half * (excess - square)) + across) * inverse;
    let second = (known * (half * (-excess - square)) - across) * inverse;
    pose.arm[pin.arms[0]] = first;
    pose.arm[pin.arms[1]] = second;
    pose.turn[pin.frames[0]] = first.turn_back(pin.per_square[0].lift());
    pose.turn[pin.frames[1]] = second.turn_back(pin.per_square[1].lift());
    // arm₁ × arm₂ = the signed double area.
    pose.inverse[group] = T::lift(1.0) / reach;
    Ok(())
}

/// A unit vector e that turns — the line's normal, or the arm's direction — so that n·L = 0.
fn place_aim<T: Scalar>(aim: &Aim, group: usize, pose: &mut Pose<T>) -> Result<(), PlaceError> {
    let known = sum(aim.fixed, &aim.known, &pose.arm);
    let branch = T::lift(aim.branch);
    let q = pose.q[0].value();
    let (unit, slope) = if aim.line_turns {
        // n·D = −n₀·w with n₀, w constant in the turning frame.
        let kappa = T::lift(-aim.unit.dot(aim.local));
        let square = known.dot(known);
        let missing = || kappa.value().abs() - square.value().sqrt();
        let reach = branch * root(square - kappa * kappa, square.value(), group, q, missing)?;
        let unit = (known * kappa + known.perp() * reach) * (T::lift(1.0) / square);
        // axis·D = reach.
        pose.travel[aim.closure] = reach + T::lift(aim.local.cross(aim.unit));
        pose.arm[aim.found] = -unit.perp();
        (unit, reach)
    } else {
        // n·(e |w|) = −n·D with n known.
        let along = pose.arm[aim.axis.0];
        let normal = along.perp();
        let length = aim.local.norm();
        let kappa = -normal.dot(known);
        let square = T::lift(length * length);
        let missing = || kappa.value().abs() - length;
        let reach = branch * root(square - kappa * kappa, square.value(), group, q, missing)?;
        let arm = normal * kappa - along * reach;
        pose.travel[aim.closure] = along.dot(known) - reach;
        pose.arm[aim.found] = arm;
        (arm * T::lift(1.0 / length), reach)
    };
    pose.turn[aim.frame] = unit.turn_back(aim.unit.lift());
    pose.inverse[group] = -T::lift(1.0) / slope;
    Ok(())
}

/// Square root of what is left of a length, or the error that says how much is missing, m.
fn root<T: Scalar>(
    rest: T,
    size: f64,
    group: usize,
    q: f64,
    missing: impl Fn() -> f64,
) -> Result<T, PlaceError> {
    let value = rest.value();
    if value > SINGULAR * SINGULAR * size {
        return Ok(rest.sqrt());
    }
    if value.is_nan() {
        return Err(PlaceError::NotFinite { q });
    }
    if value < 0.0 {
        return Err(PlaceError::Unreachable {
            group,
            q,
            gap: missing(),
        });
    }
    Err(PlaceError::Singular {
        group,
        q,
        measure: (value / size).sqrt(),
    })
}
