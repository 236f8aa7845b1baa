//! Velocities and accelerations, and the multipliers of the loops: three uses of the same factors.
//!
//! With J the Jacobian of the loops, velocities solve J u̇ = −(what the known frames carry along),
//! accelerations the same with the centripetal terms, multipliers Jᵀλ = (what the unknowns must
//! balance), group by group; the last in the reverse order.

use crate::groups::Unknown;
use crate::plan::{Assur, Behind, Closure, Driven, Kind, Plan, Pose, Solved};
use crate::plane::{Vec2, vec2};
use crate::scalar::{Scalar, each};

/// Rates of every frame and slide at a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion<T> {
    /// By frame: angular velocity, rad/s.
    pub turn: Vec<T>,
    /// By slide: its speed, m/s.
    pub slide: Vec<T>,
    /// By frame: angular acceleration, rad/s².
    pub turn_rate: Vec<T>,
    /// By slide: its acceleration, m/s².
    pub slide_rate: Vec<T>,
    work: Vec<T>,
}

/// What the loops must balance and how they do, for `N` runs side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Balance<T, const N: usize> {
    /// By frame: the moment of everything that turns with it, N·m. Given: that of the inertia
    /// forces and loads; left: what an actuator must supply.
    pub moment: Vec<[T; N]>,
    /// By slide: the force along it, N.
    pub push: Vec<[T; N]>,
    /// By closure: the force of the first body on the second, N, as (x, y) for a revolute
    /// chord and as (normal, 0) for a prismatic one.
    pub multiplier: Vec<[Vec2<T>; N]>,
    /// By relation: its multiplier, N, or N·m where it is between angles.
    pub relation: Vec<[T; N]>,
    work: Vec<T>,
}

impl Plan {
    /// A motion with the right sizes.
    pub fn motion<T: Scalar>(&self) -> Motion<T> {
        let zero = T::lift(0.0);
        Motion {
            turn: vec![zero; self.frames.frames.len()],
            slide: vec![zero; self.tree.slides.len()],
            turn_rate: vec![zero; self.frames.frames.len()],
            slide_rate: vec![zero; self.tree.slides.len()],
            work: self.work(),
        }
    }

    /// A balance with the right sizes.
    pub fn balance<T: Scalar, const N: usize>(&self) -> Balance<T, N> {
        let zero = [T::lift(0.0); N];
        Balance {
            moment: vec![zero; self.frames.frames.len()],
            push: vec![zero; self.tree.slides.len()],
            multiplier: vec![[Vec2::zero(); N]; self.closures.len()],
            relation: vec![zero; self.relations.len()],
            work: self.work(),
        }
    }

    fn work<T: Scalar>(&self) -> Vec<T> {
        let most = self.groups.iter().map(|g| g.group.rows).max();
        vec![T::lift(0.0); most.unwrap_or(0)]
    }

    /// Velocities for the actuators' speeds `q_dot` (rad/s).
    #[inline(always)]
    pub fn speeds<T: Scalar>(&self, pose: &Pose<T>, q_dot: &[T], motion: &mut Motion<T>) {
        propagate(&self.driven, q_dot, &mut motion.turn);
        self.drive_slides(q_dot, &mut motion.slide);
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse) {
            if assur.skipped {
                continue;
            }
            match &assur.kind {
                Kind::Pin(pin) => {
                    let rate = arms_rate(&pin.known, pose, motion);
                    let [r1, r2] = pin.arms.map(|a| pose.arm[a]);
                    motion.turn[pin.frames[0]] = -(rate.dot(r2) * inverse);
                    motion.turn[pin.frames[1]] = rate.dot(r1) * inverse;
                }
                Kind::Aim(aim) => {
                    motion.turn[aim.frame] = T::lift(0.0);
                    let rate = arms_rate(&aim.arms, pose, motion);
                    let rate = row_rate(rate, aim.axis, pose.travel[aim.closure], pose, motion);
                    motion.turn[aim.frame] = -(rate * inverse);
                }
                Kind::Solved(solved) => self.solved_speeds(assur, solved, pose, q_dot, motion),
            }
            propagate(&assur.driven, q_dot, &mut motion.turn);
        }
    }

    /// Accelerations for the actuators' accelerations `q_ddot` (rad/s²), at the velocities that
    /// [`Plan::speeds`] left in `motion`.
    #[inline(always)]
    pub fn accelerations<T: Scalar>(&self, pose: &Pose<T>, q_ddot: &[T], motion: &mut Motion<T>) {
        propagate(&self.driven, q_ddot, &mut motion.turn_rate);
        self.drive_slides(q_ddot, &mut motion.slide_rate);
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse) {
            if assur.skipped {
                continue;
            }
            match &assur.kind {
                Kind::Pin(pin) => {
                    let (_, known) = arms_rates(&pin.known, pose, motion);
                    let [r1, r2] = pin.arms.map(|a| pose.arm[a]);
                    let [w1, w2] = pin.frames.map(|f| motion.turn[f]);
                    let rest = known - (r1 * (w1 * w1) + r2 * (w2 * w2));
                    motion.turn_rate[pin.frames[0]] = -(rest.dot(r2) * inverse);
                    motion.turn_rate[pin.frames[1]] = rest.dot(r1) * inverse;
                }
                Kind::Aim(aim) => {
                    motion.turn_rate[aim.frame] = T::lift(0.0);
                    let rates = arms_rates(&aim.arms, pose, motion);
                    let travel = pose.travel[aim.closure];
                    let rate = row_acceleration(rates, aim.axis, travel, pose, motion);
                    motion.turn_rate[aim.frame] = -(rate * inverse);
                }
                Kind::Solved(solved) => {
                    self.solved_accelerations(assur, solved, pose, q_ddot, motion);
                }
            }
            propagate(&assur.driven, q_ddot, &mut motion.turn_rate);
        }
    }

    /// The loops' multipliers for given moments on the frames and forces along the slides, by
    /// groups in reverse order, and what then remains on the driven frames.
    #[inline(always)]
    pub fn multipliers<T: Scalar, const N: usize>(
        &self,
        pose: &Pose<T>,
        balance: &mut Balance<T, N>,
    ) {
        for (assur, &inverse) in self.groups.iter().zip(&pose.inverse).rev() {
            if assur.skipped {
                // Nothing acts on it.
                continue;
            }
            match &assur.kind {
                Kind::Pin(pin) => {
                    let one = class_moment(assur, pin.frames[0], &balance.moment);
                    let two = class_moment(assur, pin.frames[1], &balance.moment);
                    let [r1, r2] = each(pin.arms, |a| pose.arm[a] * inverse);
                    let multiplier = &mut balance.multiplier[pin.closure];
                    for ((own, one), two) in multiplier.iter_mut().zip(one).zip(two) {
                        *own = r2 * one - r1 * two;
                    }
                }
                Kind::Aim(aim) => {
                    let moment = class_moment(assur, aim.frame, &balance.moment);
                    balance.multiplier[aim.closure] =
                        each(moment, |moment| vec2(moment * inverse, T::lift(0.0)));
                }
                Kind::Solved(solved) => {
                    self.solved_multipliers(assur, solved, pose, balance);
                }
            }
            for behind in &assur.behind {
                press(behind, pose, balance);
            }
            for &r in &assur.group.relations {
                self.press_relation(assur, r, pose, balance);
            }
        }
    }

    // The stages of a group solved by its factors, apart from the others: in one function the
    // compiler would keep everything they need at hand for groups that need none of it.

    #[inline(never)]
    fn solved_speeds<T: Scalar>(
        &self,
        assur: &Assur,
        solved: &Solved,
        pose: &Pose<T>,
        q_dot: &[T],
        motion: &mut Motion<T>,
    ) {
        self.clear(assur, &mut motion.turn, &mut motion.slide);
        propagate(&assur.driven, q_dot, &mut motion.turn);
        let mut work = std::mem::take(&mut motion.work);
        let mut row = 0;
        for &l in &assur.group.loops {
            let rate = gap_rate(&self.closures[l], pose, motion);
            if let Some(axis) = self.closures[l].axis {
                work[row] = -row_rate(rate, axis, pose.travel[l], pose, motion);
                row += 1;
            } else {
                work[row] = -rate.x;
                work[row + 1] = -rate.y;
                row += 2;
            }
        }
        for &r in &assur.group.relations {
            let rate = self
                .relation(r)
                .rate(&pose.angle, &pose.slide, &motion.turn, &motion.slide);
            work[row] = -rate * self.relation_weight(assur, r);
            row += 1;
        }
        solved.solve(pose, &mut work[..row]);
        self.take(assur, &work, &mut motion.turn, &mut motion.slide);
        motion.work = work;
    }

    #[inline(never)]
    fn solved_accelerations<T: Scalar>(
        &self,
        assur: &Assur,
        solved: &Solved,
        pose: &Pose<T>,
        q_ddot: &[T],
        motion: &mut Motion<T>,
    ) {
        self.clear(assur, &mut motion.turn_rate, &mut motion.slide_rate);
        propagate(&assur.driven, q_ddot, &mut motion.turn_rate);
        let mut work = std::mem::take(&mut motion.work);
        let mut row = 0;
        for &l in &assur.group.loops {
            let rates = gap_rates(&self.closures[l], pose, motion);
            if let Some(axis) = self.closures[l].axis {
                work[row] = -row_acceleration(rates, axis, pose.travel[l], pose, motion);
                row += 1;
            } else {
                work[row] = -rates.1.x;
                work[row + 1] = -rates.1.y;
                row += 2;
            }
        }
        for &r in &assur.group.relations {
            let value = self.relation(r).acceleration(
                &pose.angle,
                &pose.slide,
                (&motion.turn, &motion.slide),
                (&motion.turn_rate, &motion.slide_rate),
            );
            work[row] = -value * self.relation_weight(assur, r);
            row += 1;
        }
        solved.solve(pose, &mut work[..row]);
        self.take(assur, &work, &mut motion.turn_rate, &mut motion.slide_rate);
        motion.work = work;
    }

    #[inline(never)]
    fn solved_multipliers<T: Scalar, const N: usize>(
        &self,
        assur: &Assur,
        solved: &Solved,
        pose: &Pose<T>,
        balance: &mut Balance<T, N>,
    ) {
        for n in 0..N {
            for (value, &unknown) in balance.work.iter_mut().zip(&assur.group.unknowns) {
                *value = match unknown {
                    Unknown::Class(c) => class_moment(assur, self.root_of(c), &balance.moment)[n],
                    Unknown::Slide(s) => balance.push[s][n] * T::lift(assur.scale),
                };
            }
            solved.solve_transposed(pose, &mut balance.work[..solved.rows]);
            let mut row = 0;
            for &l in &assur.group.loops {
                let first = balance.work[row];
                row += 1;
                let mut second = T::lift(0.0);
                if self.closures[l].axis.is_none() {
                    second = balance.work[row];
                    row += 1;
                }
                balance.multiplier[l][n] = vec2(first, second);
            }
            for &r in &assur.group.relations {
                balance.relation[r][n] = balance.work[row] * self.relation_weight(assur, r);
                row += 1;
            }
        }
    }

    /// Takes a relation's multiplier off the frames and slides that its group does not place.
    #[inline(never)]
    fn press_relation<T: Scalar, const N: usize>(
        &self,
        assur: &Assur,
        relation: usize,
        pose: &Pose<T>,
        balance: &mut Balance<T, N>,
    ) {
        let Balance {
            moment,
            push,
            relation: multipliers,
            ..
        } = balance;
        let multiplier = multipliers[relation];
        let own = |frame: usize| {
            assur.group.unknowns.iter().any(|u| match *u {
                Unknown::Class(c) => self.root_of(c) == frame,
                Unknown::Slide(_) => false,
            })
        };
        self.relation(relation).press(
            &pose.angle,
            &pose.slide,
            |frame, by| {
                if !own(frame) {
                    for (moment, m) in moment[frame].iter_mut().zip(multiplier) {
                        *moment -= by * m;
                    }
                }
            },
            |slide, by| {
                for (push, m) in push[slide].iter_mut().zip(multiplier) {
                    *push -= by * m;
                }
            },
        );
    }

    fn relation_weight<T: Scalar>(&self, assur: &Assur, relation: usize) -> T {
        T::lift(if self.relation(relation).angular {
            assur.scale
        } else {
            1.0
        })
    }

    /// Sets the rates of the slides that actuators drive.
    #[inline(always)]
    fn drive_slides<T: Scalar>(&self, rate: &[T], slide: &mut [T]) {
        for (own, driven) in slide.iter_mut().zip(&self.driven_slides) {
            if let Some(actuator) = *driven {
                *own = rate[actuator];
            }
        }
    }

    /// Puts a group's unknowns at rest: what the known ones carry along remains.
    fn clear<T: Scalar>(&self, assur: &Assur, turn: &mut [T], slide: &mut [T]) {
        for &unknown in &assur.group.unknowns {
            match unknown {
                Unknown::Class(c) => turn[self.root_of(c)] = T::lift(0.0),
                Unknown::Slide(s) => slide[s] = T::lift(0.0),
            }
        }
    }

    fn take<T: Scalar>(&self, assur: &Assur, solution: &[T], turn: &mut [T], slide: &mut [T]) {
        for (&unknown, &value) in assur.group.unknowns.iter().zip(solution) {
            match unknown {
                Unknown::Class(c) => turn[self.root_of(c)] = value,
                Unknown::Slide(s) => slide[s] = value * T::lift(assur.scale),
            }
        }
    }
}

/// Sets the rates of driven frames from the frame each is turned from.
#[inline(always)]
fn propagate<T: Scalar>(driven: &[Driven], rate: &[T], turn: &mut [T]) {
    for one in driven {
        turn[one.frame] = turn[one.parent] + T::lift(one.sign) * rate[one.actuator];
    }
}

/// The moment on a whole class of a group: on its first frame and those driven from it.
#[inline(always)]
fn class_moment<T: Scalar, const N: usize>(
    assur: &Assur,
    root: usize,
    moment: &[[T; N]],
) -> [T; N] {
    let mut sum = moment[root];
    for one in assur.driven.iter().filter(|d| d.root == root) {
        for (sum, m) in sum.iter_mut().zip(moment[one.frame]) {
            *sum += m;
        }
    }
    sum
}

/// Takes a closure's multiplier off what lies behind it.
#[inline(always)]
fn press<T: Scalar, const N: usize>(behind: &Behind, pose: &Pose<T>, balance: &mut Balance<T, N>) {
    let multiplier = balance.multiplier[behind.closure];
    let force = match behind.axis {
        None => multiplier,
        Some(axis) => {
            let normal = pose.arm[axis].perp();
            each(multiplier, |m| normal * m.x)
        }
    };
    for &(arm, frame) in &behind.arms {
        let arm = pose.arm[arm];
        for (moment, f) in balance.moment[frame].iter_mut().zip(force) {
            *moment -= arm.cross(f);
        }
    }
    if let Some(frame) = behind.turning {
        let travel = pose.travel[behind.closure];
        for (moment, m) in balance.moment[frame].iter_mut().zip(multiplier) {
            *moment += travel * m.x;
        }
    }
    for &(slide, arm, frame) in &behind.slides {
        let along = pose.arm[arm];
        let reach = along * pose.slide[slide];
        for (moment, f) in balance.moment[frame].iter_mut().zip(force) {
            *moment -= reach.cross(f);
        }
        for (push, f) in balance.push[slide].iter_mut().zip(force) {
            *push -= along.dot(f);
        }
    }
}

/// d/dt of n·L, with n the normal of a prismatic chord: n·L̇ − ω_n travel.
#[inline(always)]
fn row_rate<T: Scalar>(
    rate: Vec2<T>,
    (axis, frame): (usize, usize),
    travel: T,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> T {
    pose.arm[axis].perp().dot(rate) - motion.turn[frame] * travel
}

/// d²/dt² of n·L: n·L̈ − 2 ω_n (axis·L̇) − α_n travel.
#[inline(always)]
fn row_acceleration<T: Scalar>(
    (rate, acceleration): (Vec2<T>, Vec2<T>),
    (axis, frame): (usize, usize),
    travel: T,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> T {
    let along = pose.arm[axis];
    let coriolis = T::lift(2.0) * motion.turn[frame] * along.dot(rate);
    along.perp().dot(acceleration) - coriolis - motion.turn_rate[frame] * travel
}

/// Σ ω ẑ×arm.
#[inline(always)]
fn arms_rate<T: Scalar>(arms: &[(usize, usize)], pose: &Pose<T>, motion: &Motion<T>) -> Vec2<T> {
    let mut sum = Vec2::zero();
    for &(arm, frame) in arms {
        sum += pose.arm[arm].perp() * motion.turn[frame];
    }
    sum
}

/// Σ ω ẑ×arm and its derivative, Σ α ẑ×arm − ω² arm.
#[inline(always)]
fn arms_rates<T: Scalar>(
    arms: &[(usize, usize)],
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> (Vec2<T>, Vec2<T>) {
    let (mut first, mut second) = (Vec2::zero(), Vec2::zero());
    for &(arm, frame) in arms {
        let (r, w) = (pose.arm[arm], motion.turn[frame]);
        first += r.perp() * w;
        second += r.perp() * motion.turn_rate[frame] - r * (w * w);
    }
    (first, second)
}

/// L̇ = Σ ω ẑ×arm + Σ (speed · direction + ω ẑ×travel).
fn gap_rate<T: Scalar>(closure: &Closure, pose: &Pose<T>, motion: &Motion<T>) -> Vec2<T> {
    let mut sum = arms_rate(&closure.arms, pose, motion);
    for &(s, arm, frame) in &closure.slides {
        let along = pose.arm[arm];
        sum += along * motion.slide[s] + along.perp() * (pose.slide[s] * motion.turn[frame]);
    }
    sum
}

/// L̇ and L̈, the latter with the centripetal and Coriolis terms.
fn gap_rates<T: Scalar>(
    closure: &Closure,
    pose: &Pose<T>,
    motion: &Motion<T>,
) -> (Vec2<T>, Vec2<T>) {
    let (mut first, mut second) = arms_rates(&closure.arms, pose, motion);
    for &(s, arm, frame) in &closure.slides {
        let (along, w) = (pose.arm[arm], motion.turn[frame]);
        let reach = along * pose.slide[s];
        first += along * motion.slide[s] + reach.perp() * w;
        second += reach.perp() * motion.turn_rate[frame] - reach * (w * w);
        let coriolis = T::lift(2.0) * w * motion.slide[s];
        second += along * motion.slide_rate[s] + along.perp() * coriolis;
    }
    (first, second)
}
