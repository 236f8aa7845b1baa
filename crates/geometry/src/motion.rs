//! Velocities and accelerations, and the multipliers of the loops: three uses of the same factors.
//!
//! With J the Jacobian of the loops, velocities solve J u̇ = −(what the known frames carry along),
//! accelerations the same with the centripetal terms, multipliers Jᵀλ = (what the unknowns must
//! balance), group by group; the last in the reverse order.

use crate::frames::Turning;
use crate::groups::Unknown;
use crate::plan::{Behind, Closure, Kind, Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::scalar::Scalar;
use crate::small;

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
    work: Vec<T>,
}

impl Plan {
    /// A motion with the right sizes.
    pub fn motion<T: Scalar>(&self) -> Motion<T> {
        let zero = T::lift(0.0);
        Motion {
            turn: vec![zero; self.frames.frames.len()],
            slide: vec![zero; self.tree.slides],
            turn_rate: vec![zero; self.frames.frames.len()],
            slide_rate: vec![zero; self.tree.slides],
            work: self.work(),
        }
    }

    /// A balance with the right sizes.
    pub fn balance<T: Scalar, const N: usize>(&self) -> Balance<T, N> {
        let zero = [T::lift(0.0); N];
        Balance {
            moment: vec![zero; self.frames.frames.len()],
            push: vec![zero; self.tree.slides],
            multiplier: vec![[Vec2::zero(); N]; self.closures.len()],
            work: self.work(),
        }
    }

    fn work<T: Scalar>(&self) -> Vec<T> {
        let most = self.groups.iter().map(|g| g.group.unknowns.len()).max();
        vec![T::lift(0.0); most.unwrap_or(0)]
    }

    /// Velocities for the actuators' speeds `q_dot` (rad/s).
    pub fn speeds<T: Scalar>(&self, pose: &Pose<T>, q_dot: &[T], motion: &mut Motion<T>) {
        let Motion {
            turn, slide, work, ..
        } = motion;
        self.propagate(0, q_dot, turn);
        for (g, assur) in self.groups.iter().enumerate() {
            match &assur.kind {
                Kind::Pin(pin) => {
                    let mut rhs = Vec2::zero();
                    for &(arm, frame) in &pin.known {
                        rhs -= pose.arm[arm].perp() * turn[frame];
                    }
                    let [r1, r2] = pin.arms.map(|a| pose.arm[a]);
                    turn[pin.frames[0]] = rhs.dot(r2) * pose.inverse[g];
                    turn[pin.frames[1]] = -(rhs.dot(r1) * pose.inverse[g]);
                    self.carry_on(assur, q_dot, turn);
                }
                Kind::Aim(aim) => {
                    turn[aim.frame] = T::lift(0.0);
                    let closure = &self.closures[aim.closure];
                    let rate = self.row_rate(closure, aim.closure, pose, turn, slide);
                    turn[aim.frame] = -(rate * pose.inverse[g]);
                    self.carry_on(assur, q_dot, turn);
                }
                Kind::Newton(newton) => {
                    self.clear(assur, q_dot, turn, slide);
                    let mut row = 0;
                    for &l in &assur.group.loops {
                        let closure = &self.closures[l];
                        if closure.axis.is_some() {
                            work[row] = -self.row_rate(closure, l, pose, turn, slide);
                            row += 1;
                        } else {
                            let rate = gap_rate(closure, pose, turn, slide);
                            work[row] = -rate.x;
                            work[row + 1] = -rate.y;
                            row += 2;
                        }
                    }
                    let (lu, pivots) = newton.factors(pose, row);
                    small::solve(lu, pivots, &mut work[..row]);
                    self.take(assur, q_dot, &work[..row], turn, slide);
                }
            }
        }
    }

    /// Accelerations for the actuators' accelerations `q_ddot` (rad/s²), at the velocities that
    /// [`Plan::speeds`] left in `motion`.
    pub fn accelerations<T: Scalar>(&self, pose: &Pose<T>, q_ddot: &[T], motion: &mut Motion<T>) {
        let Motion {
            turn,
            slide,
            turn_rate,
            slide_rate,
            work,
        } = motion;
        self.propagate(0, q_ddot, turn_rate);
        for (g, assur) in self.groups.iter().enumerate() {
            match &assur.kind {
                Kind::Pin(pin) => {
                    let mut rhs = Vec2::zero();
                    for &(arm, frame) in &pin.known {
                        let (r, w) = (pose.arm[arm], turn[frame]);
                        rhs += r * (w * w) - r.perp() * turn_rate[frame];
                    }
                    let [r1, r2] = pin.arms.map(|a| pose.arm[a]);
                    let [w1, w2] = pin.frames.map(|f| turn[f]);
                    rhs += r1 * (w1 * w1) + r2 * (w2 * w2);
                    turn_rate[pin.frames[0]] = rhs.dot(r2) * pose.inverse[g];
                    turn_rate[pin.frames[1]] = -(rhs.dot(r1) * pose.inverse[g]);
                    self.carry_on(assur, q_ddot, turn_rate);
                }
                Kind::Aim(aim) => {
                    turn_rate[aim.frame] = T::lift(0.0);
                    let rates = (&turn[..], &slide[..], &turn_rate[..], &slide_rate[..]);
                    let rate = self.row_acceleration(aim.closure, pose, rates);
                    turn_rate[aim.frame] = -(rate * pose.inverse[g]);
                    self.carry_on(assur, q_ddot, turn_rate);
                }
                Kind::Newton(newton) => {
                    self.clear(assur, q_ddot, turn_rate, slide_rate);
                    let rates = (&turn[..], &slide[..], &turn_rate[..], &slide_rate[..]);
                    let mut row = 0;
                    for &l in &assur.group.loops {
                        let closure = &self.closures[l];
                        if closure.axis.is_some() {
                            work[row] = -self.row_acceleration(l, pose, rates);
                            row += 1;
                        } else {
                            let rate = gap_acceleration(closure, pose, rates);
                            work[row] = -rate.x;
                            work[row + 1] = -rate.y;
                            row += 2;
                        }
                    }
                    let (lu, pivots) = newton.factors(pose, row);
                    small::solve(lu, pivots, &mut work[..row]);
                    self.take(assur, q_ddot, &work[..row], turn_rate, slide_rate);
                }
            }
        }
    }

    /// The loops' multipliers for given moments on the frames and forces along the slides, by
    /// groups in reverse order, and what then remains on the driven frames.
    pub fn multipliers<T: Scalar, const N: usize>(
        &self,
        pose: &Pose<T>,
        balance: &mut Balance<T, N>,
    ) {
        for (g, assur) in self.groups.iter().enumerate().rev() {
            match &assur.kind {
                Kind::Pin(pin) => {
                    let one = self.class_moment(pin.frames[0], &balance.moment);
                    let two = self.class_moment(pin.frames[1], &balance.moment);
                    let [r1, r2] = pin.arms.map(|a| pose.arm[a] * pose.inverse[g]);
                    balance.multiplier[pin.closure] =
                        std::array::from_fn(|n| r2 * one[n] - r1 * two[n]);
                }
                Kind::Aim(aim) => {
                    let moment = self.class_moment(aim.frame, &balance.moment);
                    balance.multiplier[aim.closure] =
                        std::array::from_fn(|n| vec2(moment[n] * pose.inverse[g], T::lift(0.0)));
                }
                Kind::Newton(newton) => {
                    let size = assur.group.unknowns.len();
                    for n in 0..N {
                        for (i, &unknown) in assur.group.unknowns.iter().enumerate() {
                            balance.work[i] = match unknown {
                                Unknown::Class(c) => {
                                    self.class_moment(self.root_of(c), &balance.moment)[n]
                                }
                                Unknown::Slide(s) => balance.push[s][n],
                            };
                        }
                        let (lu, pivots) = newton.factors(pose, size);
                        small::solve_transposed(lu, pivots, &mut balance.work[..size]);
                        let mut row = 0;
                        for &l in &assur.group.loops {
                            let two = self.closures[l].axis.is_none();
                            let second = if two {
                                balance.work[row + 1]
                            } else {
                                T::lift(0.0)
                            };
                            balance.multiplier[l][n] = vec2(balance.work[row], second);
                            row += if two { 2 } else { 1 };
                        }
                    }
                }
            }
            for behind in &assur.behind {
                self.press(behind, pose, balance);
            }
        }
    }

    /// Takes a closure's multiplier off what lies behind it.
    fn press<T: Scalar, const N: usize>(
        &self,
        behind: &Behind,
        pose: &Pose<T>,
        balance: &mut Balance<T, N>,
    ) {
        let closure = &self.closures[behind.closure];
        let force: [Vec2<T>; N] = match closure.axis {
            None => balance.multiplier[behind.closure],
            Some((axis, _)) => {
                let normal = pose.arm[axis].perp();
                balance.multiplier[behind.closure].map(|m| normal * m.x)
            }
        };
        for &(arm, frame) in &behind.arms {
            for n in 0..N {
                balance.moment[frame][n] -= pose.arm[arm].cross(force[n]);
            }
        }
        if let Some(frame) = behind.axis {
            for n in 0..N {
                let travel = pose.travel[behind.closure];
                balance.moment[frame][n] += travel * balance.multiplier[behind.closure][n].x;
            }
        }
        for &(slide, arm, frame) in &closure.slides {
            for n in 0..N {
                let reach = pose.arm[arm] * pose.slide[slide];
                balance.moment[frame][n] -= reach.cross(force[n]);
                balance.push[slide][n] -= pose.arm[arm].dot(force[n]);
            }
        }
    }

    /// The moment on a whole class: on its first frame and those driven from it.
    fn class_moment<T: Scalar, const N: usize>(&self, root: usize, moment: &[[T; N]]) -> [T; N] {
        let mut sum = moment[root];
        for &frame in &self.driven_of[self.frames.frames[root].class] {
            for n in 0..N {
                sum[n] += moment[frame][n];
            }
        }
        sum
    }

    /// Sets the rates of a class's driven frames from the frame each is turned from.
    fn propagate<T: Scalar>(&self, class: usize, rate: &[T], turn: &mut [T]) {
        for &frame in &self.driven_of[class] {
            if let Turning::Driven {
                parent,
                actuator,
                sign,
            } = self.frames.frames[frame].turning
            {
                turn[frame] = turn[parent] + T::lift(sign) * rate[actuator];
            }
        }
    }

    fn carry_on<T: Scalar>(&self, assur: &crate::plan::Assur, rate: &[T], turn: &mut [T]) {
        for &unknown in &assur.group.unknowns {
            if let Unknown::Class(class) = unknown {
                self.propagate(class, rate, turn);
            }
        }
    }

    /// Rates with the group's unknowns at rest: what the known ones carry along remains.
    fn clear<T: Scalar>(
        &self,
        assur: &crate::plan::Assur,
        rate: &[T],
        turn: &mut [T],
        slide: &mut [T],
    ) {
        for &unknown in &assur.group.unknowns {
            match unknown {
                Unknown::Class(c) => turn[self.root_of(c)] = T::lift(0.0),
                Unknown::Slide(s) => slide[s] = T::lift(0.0),
            }
        }
        self.carry_on(assur, rate, turn);
    }

    fn take<T: Scalar>(
        &self,
        assur: &crate::plan::Assur,
        rate: &[T],
        solution: &[T],
        turn: &mut [T],
        slide: &mut [T],
    ) {
        for (&unknown, &value) in assur.group.unknowns.iter().zip(solution) {
            match unknown {
                Unknown::Class(c) => turn[self.root_of(c)] = value,
                Unknown::Slide(s) => slide[s] = value,
            }
        }
        self.carry_on(assur, rate, turn);
    }

    /// d/dt of n·L, with n the normal of a prismatic chord: n·L̇ − ω_n travel.
    fn row_rate<T: Scalar>(
        &self,
        closure: &Closure,
        index: usize,
        pose: &Pose<T>,
        turn: &[T],
        slide: &[T],
    ) -> T {
        let Some((axis, frame)) = closure.axis else {
            return T::lift(0.0);
        };
        let normal = pose.arm[axis].perp();
        normal.dot(gap_rate(closure, pose, turn, slide)) - turn[frame] * pose.travel[index]
    }

    /// d²/dt² of n·L: n·L̈ − 2 ω_n (axis·L̇) − α_n travel.
    fn row_acceleration<T: Scalar>(&self, index: usize, pose: &Pose<T>, rates: Rates<'_, T>) -> T {
        let closure = &self.closures[index];
        let Some((axis, frame)) = closure.axis else {
            return T::lift(0.0);
        };
        let (turn, slide, turn_rate, _) = rates;
        let along = pose.arm[axis];
        let rate = gap_rate(closure, pose, turn, slide);
        let acceleration = gap_acceleration(closure, pose, rates);
        let coriolis = T::lift(2.0) * turn[frame] * along.dot(rate);
        along.perp().dot(acceleration) - coriolis - turn_rate[frame] * pose.travel[index]
    }
}

/// Angular velocities, slide speeds, angular accelerations, slide accelerations.
type Rates<'a, T> = (&'a [T], &'a [T], &'a [T], &'a [T]);

/// L̇ = Σ ω ẑ×arm + Σ (speed · direction + ω ẑ×travel).
fn gap_rate<T: Scalar>(closure: &Closure, pose: &Pose<T>, turn: &[T], slide: &[T]) -> Vec2<T> {
    let mut sum = Vec2::zero();
    for &(arm, frame) in &closure.arms {
        sum += pose.arm[arm].perp() * turn[frame];
    }
    for &(s, arm, frame) in &closure.slides {
        let along = pose.arm[arm];
        sum += along * slide[s] + along.perp() * (pose.slide[s] * turn[frame]);
    }
    sum
}

/// L̈, with the centripetal and Coriolis terms.
fn gap_acceleration<T: Scalar>(
    closure: &Closure,
    pose: &Pose<T>,
    (turn, slide, turn_rate, slide_rate): Rates<'_, T>,
) -> Vec2<T> {
    let mut sum = Vec2::zero();
    for &(arm, frame) in &closure.arms {
        let (r, w) = (pose.arm[arm], turn[frame]);
        sum += r.perp() * turn_rate[frame] - r * (w * w);
    }
    for &(s, arm, frame) in &closure.slides {
        let (along, w) = (pose.arm[arm], turn[frame]);
        let reach = along * pose.slide[s];
        sum += reach.perp() * turn_rate[frame] - reach * (w * w);
        sum += along * slide_rate[s] + along.perp() * (T::lift(2.0) * w * slide[s]);
    }
    sum
}
