//! Groups without a closed form for everything: placed by Newton's method, by linear equations or by
//! the triangle of a dyad; what follows from the position comes from the factors of their Jacobian.

use crate::error::PlaceError;
use crate::groups::{Group, Unknown};
use crate::place::{Guess, gap, singular, turn, unit};
use crate::plan::{Closure, How, Kind, Plan, Pose, Solved};
use crate::plane::{Vec2, vec2};
use crate::scalar::Scalar;
use crate::small::{self, Factored};
use crate::tall;

/// Newton's correction (rad, or relative to the group's size) after which its square is rounding.
const CONVERGED: f64 = 1e-9;
/// Newton's method doubles its digits in each step: 30 steps are far more than it needs.
const MOST_STEPS: usize = 30;
/// A group whose equations repeat each other is closed when no more than this is left of them,
/// relative to its size: what the lengths in a scene are rounded to.
const REPEATED: f64 = 1e-9;

impl Solved {
    /// Whether some equations only repeat what others say.
    pub(crate) fn tall(&self) -> bool {
        self.rows > self.columns
    }

    /// The determinant, up to its sign where the group is tall.
    pub(crate) fn determinant<T: Scalar>(&self, pose: &Pose<T>) -> T {
        let n = self.columns;
        (0..n).fold(T::lift(1.0), |product, i| {
            product * pose.lu[self.lu + i * n + i]
        })
    }

    /// Solves J x = b in place: x is in the first entries (least squares for a tall group).
    pub(crate) fn solve<T: Scalar>(&self, pose: &Pose<T>, b: &mut [T]) {
        let (m, n) = (self.rows, self.columns);
        if self.tall() {
            let (a, beside) = pose.lu[self.lu..self.lu + m * n + n].split_at(m * n);
            tall::solve(a, beside, m, b);
        } else {
            let pivots = &pose.pivots[self.pivots..self.pivots + n];
            small::solve(&pose.lu[self.lu..self.lu + n * n], pivots, &mut b[..n]);
        }
    }

    /// Solves Jᵀ x = b in place (the smallest x for a tall group).
    pub(crate) fn solve_transposed<T: Scalar>(&self, pose: &Pose<T>, b: &mut [T]) {
        let (m, n) = (self.rows, self.columns);
        if self.tall() {
            let (a, beside) = pose.lu[self.lu..self.lu + m * n + n].split_at(m * n);
            tall::solve_transposed(a, beside, m, b);
        } else {
            let pivots = &pose.pivots[self.pivots..self.pivots + n];
            small::solve_transposed(&pose.lu[self.lu..self.lu + n * n], pivots, &mut b[..n]);
        }
    }
}

impl Plan {
    /// Apart from the closed forms, which need little of what this keeps at hand.
    #[inline(never)]
    pub(crate) fn place_solved<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
        guess: Guess,
    ) -> Result<(), PlaceError> {
        let factored = match solved.how {
            How::Newton => {
                if guess == Guess::Seed {
                    self.sow(group, pose)?;
                }
                self.close(group, solved, pose)?
            }
            How::Linear => self.step_once(group, solved, pose)?,
            How::Geared => self.mesh(group, solved, pose)?,
            How::Triangle(..) | How::Reach(..) | How::Guide(_) => {
                self.construct(group, solved, pose)?;
                self.turn_group(group, pose);
                self.factor(group, solved, pose)?
            }
        };
        // A pose on the other side of a singular position is another branch.
        if guess == Guess::Seed && factored.sign * solved.branch <= 0.0 {
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

    /// That every group's determinant has the sign of the assembly.
    pub(crate) fn same_branch<T: Scalar>(&self, pose: &Pose<T>) -> Result<(), PlaceError> {
        for (group, assur) in self.groups.iter().enumerate() {
            if let Kind::Solved(solved) = &assur.kind
                && !assur.skipped
                && !solved.tall()
                && self.sign(solved, pose) * solved.branch <= 0.0
            {
                let q = pose.q[0].value();
                return Err(PlaceError::OtherBranch { group, q });
            }
        }
        Ok(())
    }

    /// Sign of the determinant, from its factors.
    pub(crate) fn sign<T: Scalar>(&self, solved: &Solved, pose: &Pose<T>) -> f64 {
        let pivots = &pose.pivots[solved.pivots..solved.pivots + solved.columns];
        let swaps = pivots.iter().enumerate().filter(|(k, p)| k != *p).count();
        let sign = if swaps % 2 == 0 { 1.0 } else { -1.0 };
        let n = solved.columns;
        (0..n).fold(sign, |sign, i| {
            sign * pose.lu[solved.lu + i * n + i].value().signum()
        })
    }

    /// Sets a group's unknowns to the first-order prediction from its nearest seed.
    fn sow<T: Scalar>(&self, group: usize, pose: &mut Pose<T>) -> Result<(), PlaceError> {
        let seeds = &self.groups[group].seeds;
        let near = seeds.nearest(pose.q[0].value(), self.range)?;
        // The derivative of the prediction does not matter: Newton's last step replaces it.
        for (i, &unknown) in self.groups[group].group.unknowns.iter().enumerate() {
            match unknown {
                Unknown::Class(class) if self.counted[self.root_of(class)] => {
                    let angle = T::lift(seeds.predict(near, i));
                    self.set_angle(class, angle, pose);
                }
                Unknown::Class(class) => {
                    let by = Vec2::from_angle(near.seed.slopes[i] * near.away);
                    pose.turn[self.root_of(class)] = near.seed.values[i].turn(by).lift();
                }
                Unknown::Slide(slide) => pose.slide[slide] = T::lift(seeds.predict(near, i)),
            }
        }
        Ok(())
    }

    /// Sets a class to a counted angle.
    pub(crate) fn set_angle<T: Scalar>(&self, class: usize, angle: T, pose: &mut Pose<T>) {
        let root = self.root_of(class);
        let (sin, cos) = angle.sin_cos();
        pose.angle[root] = angle;
        pose.turn[root] = vec2(cos, sin);
    }

    /// Newton's method; leaves the factors of the Jacobian where it ends.
    fn close<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) -> Result<Factored, PlaceError> {
        let mut residual = f64::INFINITY;
        let mut once_more = true;
        let converged = CONVERGED.max(0.05 * T::EPSILON.sqrt());
        let repeated = REPEATED.max(64.0 * T::EPSILON);
        for _ in 0..MOST_STEPS {
            self.turn_group(group, pose);
            residual = self.residual(group, pose);
            self.factor(group, solved, pose)?;
            let largest = self.correct(group, solved, pose);
            if !largest.is_finite() {
                break;
            }
            // One step past convergence: it makes the derivative of a dual number exact.
            if largest < converged && !std::mem::replace(&mut once_more, false) {
                self.turn_group(group, pose);
                if solved.tall() {
                    residual = self.residual(group, pose);
                    if residual > repeated * self.groups[group].size {
                        break;
                    }
                }
                return self.factor(group, solved, pose);
            }
        }
        let q = pose.q[0].value();
        Err(PlaceError::NotClosed { group, q, residual })
    }

    /// One step from nothing, for equations that are linear in the unknowns.
    fn step_once<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) -> Result<Factored, PlaceError> {
        for &unknown in &self.groups[group].group.unknowns {
            match unknown {
                Unknown::Class(class) => self.set_angle(class, T::lift(0.0), pose),
                Unknown::Slide(slide) => pose.slide[slide] = T::lift(0.0),
            }
        }
        self.turn_group(group, pose);
        self.residual(group, pose);
        let factored = self.factor(group, solved, pose)?;
        if !self.correct(group, solved, pose).is_finite() {
            let q = pose.q[0].value();
            return Err(PlaceError::NotFinite { q });
        }
        self.turn_group(group, pose);
        Ok(factored)
    }

    /// Newton's correction from the residual in the work space: the largest change, rad or relative.
    pub(crate) fn correct<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) -> f64 {
        let scale = self.groups[group].scale;
        let mut work = std::mem::take(&mut pose.work);
        solved.solve(pose, &mut work[..solved.rows]);
        let mut largest = 0.0_f64;
        for (&unknown, &step) in self.groups[group].group.unknowns.iter().zip(&work) {
            match unknown {
                Unknown::Class(class) => {
                    let frame = self.root_of(class);
                    if self.counted[frame] {
                        self.set_angle(class, pose.angle[frame] - step, pose);
                    } else {
                        let (sin, cos) = step.sin_cos();
                        pose.turn[frame] = unit(pose.turn[frame].turn(vec2(cos, -sin)));
                    }
                }
                Unknown::Slide(slide) => pose.slide[slide] -= step * T::lift(scale),
            }
            let change = step.value().abs();
            largest = if change.is_nan() {
                f64::INFINITY
            } else {
                largest.max(change)
            };
        }
        pose.work = work;
        largest
    }

    /// Turns a group's driven frames and rotates the arms of its loops, after its unknowns changed.
    pub(crate) fn turn_group<T: Scalar>(&self, group: usize, pose: &mut Pose<T>) {
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
                let crate::tree::Arm { frame, local } = self.arms[arm];
                pose.arm[arm] = local.lift::<T>().turn(pose.turn[frame]);
            }
        }
    }

    /// Writes a group's residual into the work space; its largest component, m.
    pub(crate) fn residual<T: Scalar>(&self, group: usize, pose: &mut Pose<T>) -> f64 {
        let mut row = 0;
        let Group {
            loops, relations, ..
        } = &self.groups[group].group;
        for &l in loops {
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
        for &r in relations {
            let value = self.relations[r].value(&pose.angle, &pose.slide);
            pose.work[row] = value * T::lift(self.weight(group, r));
            row += 1;
        }
        let values = pose.work[..row].iter().map(|value| value.value().abs());
        values.fold(0.0, f64::max)
    }

    /// A relation between angles is compared with loops by the size of its group.
    pub(crate) fn weight(&self, group: usize, relation: usize) -> f64 {
        if self.relations[relation].angular {
            self.groups[group].scale
        } else {
            1.0
        }
    }

    /// Assembles and factors a group's Jacobian at the pose.
    pub(crate) fn factor<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) -> Result<Factored, PlaceError> {
        self.assemble_jacobian(group, solved, pose);
        let (m, n) = (solved.rows, solved.columns);
        let factored = if solved.tall() {
            let (a, beside) = pose.lu[solved.lu..solved.lu + m * n + n].split_at_mut(m * n);
            tall::factor(a, beside, m)
        } else {
            small::factor(
                &mut pose.lu[solved.lu..solved.lu + n * n],
                &mut pose.pivots[solved.pivots..solved.pivots + n],
            )
        };
        if factored.measure > singular::<T>() {
            Ok(factored)
        } else {
            Err(PlaceError::Singular {
                group,
                q: pose.q.first().map_or(0.0, |q| q.value()),
                measure: factored.measure,
            })
        }
    }

    pub(crate) fn assemble_jacobian<T: Scalar>(
        &self,
        group: usize,
        solved: &Solved,
        pose: &mut Pose<T>,
    ) {
        let assur = &self.groups[group];
        let Group {
            unknowns,
            loops,
            relations,
            ..
        } = &assur.group;
        let n = unknowns.len();
        let mut row = solved.lu;
        let counted_in = |unknown: Unknown| match unknown {
            Unknown::Class(_) => T::lift(1.0),
            Unknown::Slide(_) => T::lift(assur.scale),
        };
        for &l in loops {
            let closure = &self.closures[l];
            let open = gap(closure, &pose.arm, &pose.slide);
            for (column, &unknown) in unknowns.iter().enumerate() {
                let change = self.change(closure, unknown, pose) * counted_in(unknown);
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
        for &r in relations {
            let weight = T::lift(self.weight(group, r));
            let relation = &self.relations[r];
            for (column, &unknown) in unknowns.iter().enumerate() {
                let entry = match unknown {
                    Unknown::Class(class) => {
                        relation.by_class(&self.frames, class, &pose.angle, &pose.slide)
                    }
                    Unknown::Slide(slide) => relation.by_slide(slide, &pose.angle, &pose.slide),
                };
                pose.lu[row + column] = entry * weight * counted_in(unknown);
            }
            row += n;
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
}
