//! Positions: from the actuators' coordinates to the orientation of every body, group by group.

use crate::error::PlaceError;
use crate::groups::Unknown;
use crate::large::LARGE;
use crate::plan::{Aim, Closure, Driven, How, Kind, Pin, Plan, Pose, Step};
use crate::plane::{Vec2, vec2};
use crate::scalar::{Scalar, agreed, each};
use crate::tree::Arm;
use std::f64::consts::TAU;

/// Below this determinant, relative to the lengths that make it, nothing is left of the digits.
const SINGULAR: f64 = 1e-14;

/// The same for a kind of number. Wider ones refuse where plain ones do: they are there to judge them.
pub(crate) const fn singular<T: Scalar>() -> f64 {
    SINGULAR.max(32.0 * T::EPSILON)
}

/// Whether such numbers see the rounding of constants that are derived from a scene's lengths: they
/// derive them anew.
pub(crate) const fn finer<T: Scalar>() -> bool {
    T::EPSILON < f64::EPSILON
}
/// Steps to a turn of an actuator where a pose is followed. A group's pose changes little over 3°,
/// so that Newton's method needs two or three steps; what changes faster is followed in finer steps.
pub(crate) const PER_TURN: usize = 120;

/// Steps after which a way from the start is given up: no mechanism is driven a thousand turns away
/// from where it was assembled, but a careless number may say so.
const MOST_WAY: f64 = 120_000.0;

/// Where Newton's method starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Guess {
    /// From the nearest stored seed, so that the pose depends on the coordinate alone.
    Seed,
    /// From what the pose holds (while the branch is being followed).
    Pose,
}

impl Plan {
    /// Places the mechanism at the coordinates `q` (rad or m). The pose depends on `q` alone.
    ///
    /// # Errors
    /// [`PlaceError`] when a group cannot close there, is singular, or `q` is out of range.
    #[inline(always)]
    pub fn place<T: Scalar>(&self, q: &[T], pose: &mut Pose<T>) -> Result<(), PlaceError> {
        if T::LANES > 1 && !self.placed_in_lanes() {
            return Err(PlaceError::Apart { q: q[0].value() });
        }
        // Outside its range a closed form may close again, but on a branch that cannot be reached.
        if self.range.limits().is_some() {
            let lanes = (0..T::LANES).map(|lane| q[0].lane(lane));
            for q in lanes.filter(|q| q.is_finite()) {
                self.range.fold(q)?;
            }
        }
        if self.actuators() > 1 && self.groups.iter().any(|g| g.remembers && !g.skipped) {
            return self.place_along(q, pose);
        }
        self.place_from(q, pose, Guess::Seed)
    }

    /// Whether every group is placed by a closed form whose decisions can be asked of every lane: no steps
    /// until something has converged, no counted turns, no law of a value.
    pub fn placed_in_lanes(&self) -> bool {
        self.groups.iter().filter(|g| !g.skipped).all(|assur| {
            let straight = match &assur.kind {
                Kind::Pin(_) | Kind::Aim(_) => true,
                Kind::Solved(solved) => {
                    solved.how != How::Newton && !solved.tall() && solved.columns < LARGE
                }
            };
            let of = &assur.group.relations;
            straight && !assur.counts && of.iter().all(|&r| self.relations[r].law.is_none())
        })
    }

    /// Whether every group is a dyad or a guided body, whose closed forms are inlined into an evaluation. The
    /// others have functions of their own.
    pub fn placed_by_dyads(&self) -> bool {
        let mut groups = self.groups.iter().filter(|g| !g.skipped);
        groups.all(|g| matches!(g.kind, Kind::Pin(_) | Kind::Aim(_)))
    }

    /// Follows the straight way from the start to `q`: with several actuators there is no row of
    /// poses to start from.
    #[inline(never)]
    fn place_along<T: Scalar>(&self, q: &[T], pose: &mut Pose<T>) -> Result<(), PlaceError> {
        let Some(home) = &self.home else {
            return self.place_from(q, pose, Guess::Pose);
        };
        for (own, turn) in pose.turn.iter_mut().zip(&home.turn) {
            *own = turn.lift();
        }
        for (own, &angle) in pose.angle.iter_mut().zip(&home.angle) {
            *own = T::lift(angle);
        }
        for (own, &travel) in pose.slide.iter_mut().zip(&home.slide) {
            *own = T::lift(travel);
        }
        let mut steps = 1.0_f64;
        for (i, (to, from)) in q.iter().zip(&self.start).enumerate() {
            steps = steps.max(((to.value() - from) / self.step(i)).abs().ceil());
        }
        let mut way = std::mem::take(&mut pose.path);
        let mut result = Ok(());
        for k in 1..=steps.min(MOST_WAY) as usize {
            let part = k as f64 / steps;
            for ((on, &to), &from) in way.iter_mut().zip(q).zip(&self.start) {
                *on = if part < 1.0 {
                    T::lift(from + (to.value() - from) * part)
                } else {
                    to
                };
            }
            result = self.place_from(&way, pose, Guess::Pose);
            if result.is_err() {
                break;
            }
        }
        pose.path = way;
        result?;
        self.same_branch(pose)
    }

    /// A step of an actuator over which a pose changes little, rad or m.
    pub(crate) fn step(&self, actuator: usize) -> f64 {
        if self.angular[actuator] {
            TAU / PER_TURN as f64
        } else if self.reach > 0.0 {
            self.reach * TAU / PER_TURN as f64
        } else {
            1.0
        }
    }

    #[inline(always)]
    pub(crate) fn place_from<T: Scalar>(
        &self,
        q: &[T],
        pose: &mut Pose<T>,
        guess: Guess,
    ) -> Result<(), PlaceError> {
        for (own, &value) in pose.q.iter_mut().zip(q) {
            for q in (0..T::LANES).map(|lane| value.lane(lane)) {
                if !q.is_finite() {
                    return Err(PlaceError::NotFinite { q });
                }
            }
            *own = value;
        }
        self.place_from_here(&self.steps, pose, guess)
    }

    /// Places one group at the start, with what follows the one before it: while a branch is still
    /// to be picked, and all groups before it are placed.
    pub(crate) fn place_group(&self, group: usize, pose: &mut Pose<f64>) -> Result<(), PlaceError> {
        let steps = &self.steps[self.first_step(group)..=self.solve_steps[group]];
        self.place_from_here(steps, pose, Guess::Pose)
    }

    /// Turns and rotates what comes between the group before and this one.
    pub(crate) fn place_before(
        &self,
        group: usize,
        pose: &mut Pose<f64>,
    ) -> Result<(), PlaceError> {
        let steps = &self.steps[self.first_step(group)..self.solve_steps[group]];
        self.place_from_here(steps, pose, Guess::Pose)
    }

    /// The step after the group before.
    fn first_step(&self, group: usize) -> usize {
        let before = group.checked_sub(1);
        before.map_or(0, |before| self.solve_steps[before] + 1)
    }

    #[inline(always)]
    fn place_from_here<T: Scalar>(
        &self,
        steps: &[Step],
        pose: &mut Pose<T>,
        guess: Guess,
    ) -> Result<(), PlaceError> {
        for step in steps {
            match step {
                Step::Slide(slide, actuator) => pose.slide[*slide] = pose.q[*actuator],
                Step::Turn(driven) => turn(driven, pose),
                Step::Rotate(arm, Arm { frame, local }) => {
                    pose.arm[*arm] = local.lift::<T>().turn(pose.turn[*frame]);
                }
                Step::Solve(g) => {
                    match &self.groups[*g].kind {
                        Kind::Pin(pin) => place_pin(pin, &self.arms, *g, pose)?,
                        Kind::Aim(aim) => place_aim(aim, *g, pose)?,
                        Kind::Solved(solved) => self.place_solved(*g, solved, pose, guess)?,
                    }
                    if self.groups[*g].counts {
                        self.count(*g, pose, guess)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Counts the whole turns of a group's classes where a relation or a load needs them: the number that is
    /// nearest to the stored angle, or while a branch is followed to the last one.
    #[inline(never)]
    fn count<T: Scalar>(
        &self,
        group: usize,
        pose: &mut Pose<T>,
        guess: Guess,
    ) -> Result<(), PlaceError> {
        let assur = &self.groups[group];
        if matches!(&assur.kind, Kind::Solved(s) if matches!(s.how, How::Newton | How::Geared)) {
            return Ok(());
        }
        let near = match guess {
            Guess::Seed if assur.remembers => {
                Some(assur.seeds.nearest(pose.q[0].value(), self.range)?)
            }
            _ => None,
        };
        for (i, &unknown) in assur.group.unknowns.iter().enumerate() {
            let Unknown::Class(class) = unknown else {
                continue;
            };
            let root = self.root_of(class);
            if !self.counted[root] {
                continue;
            }
            let expected = match (self.beside.get(&root), near) {
                (Some(&(carrier, lead)), _) => pose.angle[carrier].value() + lead,
                (None, Some(near)) => assur.seeds.predict(near, i),
                (None, None) => pose.angle[root].value(),
            };
            let angle = pose.turn[root].y.atan2(pose.turn[root].x);
            let turns = ((expected - angle.value()) / TAU).round();
            pose.angle[root] = angle + T::turns(turns);
        }
        Ok(())
    }

    /// Sets a pose from the coordinates, the angles of all frames (rad) and the travels of all slides
    /// (m), wherever they come from. It holds no factors: there are states of bodies in it, but no speeds
    /// or multipliers.
    pub fn impose<T: Scalar>(&self, q: &[T], angles: &[T], slides: &[T], pose: &mut Pose<T>) {
        pose.q.copy_from_slice(q);
        pose.angle.copy_from_slice(angles);
        pose.slide.copy_from_slice(slides);
        for (turn, angle) in pose.turn.iter_mut().zip(angles) {
            let (sin, cos) = angle.sin_cos();
            *turn = vec2(cos, sin);
        }
        for (own, Arm { frame, local }) in pose.arm.iter_mut().zip(&self.arms) {
            *own = local.lift::<T>().turn(pose.turn[*frame]);
        }
    }

    /// The frame whose angle is a class's unknown.
    pub fn root_of(&self, class: usize) -> usize {
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
        self.tree.roots[self.lowered.ground]
    }
}

/// Turns a frame by its actuator's coordinate.
#[inline(always)]
pub(crate) fn turn<T: Scalar>(driven: &Driven, pose: &mut Pose<T>) {
    let (sin, cos) = pose.q[driven.actuator].sin_cos();
    let by = vec2(cos, if driven.sign < 0.0 { -sin } else { sin });
    pose.turn[driven.frame] = if driven.parent == 0 {
        by
    } else {
        pose.turn[driven.parent].turn(by)
    };
    if driven.counted {
        pose.angle[driven.frame] =
            pose.angle[driven.parent] + T::lift(driven.sign) * pose.q[driven.actuator];
    }
}

/// A constant vector and some rotated arms, summed.
#[inline(always)]
fn sum<T: Scalar>(fixed: Vec2, arms: &[(usize, usize)], arm: &[Vec2<T>]) -> Vec2<T> {
    let mut sum = fixed.lift();
    for &(a, _) in arms {
        sum += arm[a];
    }
    sum
}

/// L = P₂ − P₁ as its arms and slides have it.
#[inline]
pub(crate) fn gap<T: Scalar>(closure: &Closure, arm: &[Vec2<T>], slide: &[T]) -> Vec2<T> {
    let mut sum = sum(closure.fixed, &closure.arms, arm);
    for &(s, a, _) in &closure.slides {
        sum += arm[a] * slide[s];
    }
    sum
}

/// Two arms of known length that close a triangle with the known part D of the loop.
#[inline(always)]
fn place_pin<T: Scalar>(
    pin: &Pin,
    arms: &[Arm],
    group: usize,
    pose: &mut Pose<T>,
) -> Result<(), PlaceError> {
    let (per_square, [sum2, gap2, excess]) = triangle_of(pin, arms);
    let known = sum(pin.fixed, &pin.known, &pose.arm);
    let square = known.dot(known);
    // (2 × area)² by factors that keep their digits near a stretched or folded triangle.
    let rest = (sum2 - square) * (square - gap2);
    let size = |lane| square.lane(lane) * square.lane(lane);
    let q = pose.q[0].value();
    let missing = || {
        let distance = square.value().sqrt();
        (distance - pin.sum2.sqrt()).max(pin.gap2.sqrt() - distance)
    };
    let reach = root(rest, size, group, q, missing)? * T::lift(0.5 * pin.branch);
    let half = T::lift(0.5);
    let inverse = T::lift(1.0) / square;
    let across = known.perp() * reach;
    let first = (known * (half * (excess - square)) + across) * inverse;
    let second = (known * (half * (-excess - square)) - across) * inverse;
    pose.arm[pin.arms[0]] = first;
    pose.arm[pin.arms[1]] = second;
    pose.turn[pin.frames[0]] = first.turn_back(per_square[0]);
    pose.turn[pin.frames[1]] = second.turn_back(per_square[1]);
    // arm₁ × arm₂ = the signed double area.
    pose.inverse[group] = T::lift(1.0) / reach;
    Ok(())
}

/// The arms over their squares, and (l₁ + l₂)², (l₁ − l₂)², l₂² − l₁² of their lengths.
#[inline(always)]
fn triangle_of<T: Scalar>(pin: &Pin, arms: &[Arm]) -> ([Vec2<T>; 2], [T; 3]) {
    if !finer::<T>() {
        let lengths = [pin.sum2, pin.gap2, pin.excess];
        return (each(pin.per_square, Vec2::lift), each(lengths, T::lift));
    }
    let local = pin.arms.map(|a| arms[a].local.lift::<T>());
    let squares = local.map(|arm| arm.dot(arm));
    let [one, two] = squares.map(T::sqrt);
    let (sum, gap) = (one + two, one - two);
    let per_square = [0, 1].map(|k| local[k] * (T::lift(1.0) / squares[k]));
    (per_square, [sum * sum, gap * gap, squares[1] - squares[0]])
}

/// A vector of length one, to the last digit of finer numbers too.
#[inline(always)]
pub(crate) fn unit<T: Scalar>(vector: Vec2<T>) -> Vec2<T> {
    if finer::<T>() {
        vector * (T::lift(1.0) / vector.dot(vector).sqrt())
    } else {
        vector
    }
}

/// A unit vector e that turns — the line's normal, or the arm's direction — so that n·L = 0.
#[inline(always)]
fn place_aim<T: Scalar>(aim: &Aim, group: usize, pose: &mut Pose<T>) -> Result<(), PlaceError> {
    let known = sum(aim.fixed, &aim.known, &pose.arm);
    let branch = T::lift(aim.branch);
    let q = pose.q[0].value();
    let (still, local) = (unit(aim.unit.lift::<T>()), aim.local.lift::<T>());
    let (turned, slope) = if aim.line_turns {
        // n·D = −n₀·w with n₀, w constant in the turning frame.
        let kappa = -still.dot(local);
        let square = known.dot(known);
        let missing = || kappa.value().abs() - square.value().sqrt();
        let reach = branch
            * root(
                square - kappa * kappa,
                |l| square.lane(l),
                group,
                q,
                missing,
            )?;
        let turned = (known * kappa + known.perp() * reach) * (T::lift(1.0) / square);
        // axis·D = reach.
        pose.travel[aim.closure] = reach + local.cross(still);
        pose.arm[aim.found] = -turned.perp();
        (turned, reach)
    } else {
        // n·(e |w|) = −n·D with n known.
        let along = pose.arm[aim.axis.0];
        let normal = along.perp();
        let length = if finer::<T>() {
            local.dot(local).sqrt()
        } else {
            T::lift(aim.local.norm())
        };
        let kappa = -normal.dot(known);
        let square = length * length;
        let missing = || kappa.value().abs() - length.value();
        let reach = branch
            * root(
                square - kappa * kappa,
                |l| square.lane(l),
                group,
                q,
                missing,
            )?;
        let arm = normal * kappa - along * reach;
        pose.travel[aim.closure] = along.dot(known) - reach;
        pose.arm[aim.found] = arm;
        (arm * (T::lift(1.0) / length), reach)
    };
    pose.turn[aim.frame] = turned.turn_back(still);
    pose.inverse[group] = -T::lift(1.0) / slope;
    Ok(())
}

/// Square root of what is left of a length, or the error that says how much is missing, m. The `size` it is
/// small against is asked lane by lane.
#[inline(always)]
pub(crate) fn root<T: Scalar>(
    rest: T,
    size: impl Fn(usize) -> f64,
    group: usize,
    q: f64,
    missing: impl Fn() -> f64,
) -> Result<T, PlaceError> {
    let least = singular::<T>();
    if agreed::<T>(|lane| rest.lane(lane) > least * least * size(lane)) == Some(true) {
        return Ok(rest.sqrt());
    }
    no_root(rest.value(), size(0), group, q, missing)
}

#[cold]
fn no_root<T>(
    value: f64,
    size: f64,
    group: usize,
    q: f64,
    missing: impl Fn() -> f64,
) -> Result<T, PlaceError> {
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
