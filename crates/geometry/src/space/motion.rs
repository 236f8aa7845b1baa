//! Velocities and accelerations, from the factors of each group with other right-hand sides.

use super::frames::BodyMotion;
use super::groups::Group;
use super::plan::{Plan, Pose, PoseMotion};
use super::vector::Vec3;
use dwell_numerics::{Constant, Lift, Scalar};

impl<C: Constant> Plan<C> {
    /// Computes the velocities of all freedoms and bodies from those of the actuators, rad/s or m/s. Sets the accelerations of
    /// the bodies to those at zero accelerations of the freedoms.
    pub fn velocities<T: Lift<C>>(&self, q_dot: &[T], pose: &mut Pose<T>) {
        for (driver, &rate) in self.drivers.iter().zip(q_dot) {
            pose.motion.rates[driver.freedom] = rate * T::lift(driver.factor);
        }
        for group in &self.groups {
            self.carry_known(
                group,
                pose,
                |pose, freedom| pose.motion.rates[freedom],
                |_, _, _| T::from_f64(0.0),
            );
            for (j, freedom) in group.unknowns.iter().enumerate() {
                pose.motion.rates[*freedom] = pose.scratch[j];
            }
        }
        self.fill_states(pose);
    }

    /// Computes the accelerations of all freedoms and bodies from those of the actuators, rad/s² or m/s². Call it after
    /// `velocities`.
    pub fn accelerations<T: Lift<C>>(&self, q_ddot: &[T], pose: &mut Pose<T>) {
        if !std::mem::take(&mut pose.motion.has_no_acceleration) {
            self.fill_states(pose);
            pose.motion.has_no_acceleration = false;
        }
        for (driver, &acceleration) in self.drivers.iter().zip(q_ddot) {
            pose.motion.accelerations[driver.freedom] = acceleration * T::lift(driver.factor);
        }
        for group in &self.groups {
            let (mut last, mut points) = (usize::MAX, [Vec3::zero(); 3]);
            let row = |pose: &Pose<T>, c: usize, k: usize| {
                let closure = &self.closures[c];
                if c != last {
                    points = closure.point_motion(&pose.frames, &pose.motion.states);
                    last = c;
                }
                closure.row_acceleration(closure.kinds[k], pose, points)
            };
            self.carry_known(
                group,
                pose,
                |pose, freedom| pose.motion.accelerations[freedom],
                row,
            );
            for (j, freedom) in group.unknowns.iter().enumerate() {
                pose.motion.accelerations[*freedom] = pose.scratch[j];
            }
        }
        self.add_accelerations(pose);
    }

    /// Solves a group with the known rates of the freedoms outside it and of its own rows.
    #[inline(always)]
    fn carry_known<T: Lift<C>>(
        &self,
        group: &Group,
        pose: &mut Pose<T>,
        known: impl Fn(&Pose<T>, usize) -> T,
        mut row: impl FnMut(&Pose<T>, usize, usize) -> T,
    ) {
        for (i, &(c, k)) in group.rows.iter().enumerate() {
            pose.scratch[i] = -row(pose, c, k);
        }
        for outer in &group.outer {
            let change = pose.entries[outer.entry] * known(pose, outer.freedom);
            pose.scratch[outer.row] -= change;
        }
        self.solve(group, pose);
    }

    /// The states of the bodies from the rates of the freedoms, without their accelerations.
    #[inline(always)]
    pub(super) fn fill_states<T: Lift<C>>(&self, pose: &mut Pose<T>) {
        let freedoms = &self.tree.freedoms;
        let Pose { frames, screws, .. } = pose;
        let PoseMotion { rates, states, .. } = &mut pose.motion;
        for link in &self.tree.links {
            let of_parent = &states[link.parent];
            let carried = if link.parent == self.ground {
                BodyMotion::default()
            } else {
                of_parent.carried(frames[link.body].position - frames[link.parent].position)
            };
            states[link.body] = link.motion(carried, of_parent, rates, freedoms, screws);
        }
        pose.motion.has_no_acceleration = true;
    }

    /// Adds the accelerations of the freedoms to the states of the bodies.
    #[inline(always)]
    pub(super) fn add_accelerations<T: Lift<C>>(&self, pose: &mut Pose<T>) {
        let freedoms = &self.tree.freedoms;
        let Pose {
            frames,
            screws,
            motion,
            added,
            ..
        } = pose;
        let PoseMotion {
            accelerations,
            states,
            ..
        } = motion;
        for link in &self.tree.links {
            let arm = frames[link.body].position - frames[link.parent].position;
            let [origin, turn] =
                link.added(arm, added[link.parent], accelerations, freedoms, screws);
            added[link.body] = [origin, turn];
            states[link.body].acceleration += origin;
            states[link.body].angular_acceleration += turn;
        }
    }

    /// The motion of a body, with velocity and acceleration of its [evaluation frame](Plan::frame)'s origin.
    #[inline(always)]
    pub fn state<'a, T: Scalar>(&self, pose: &'a Pose<T>, body: usize) -> &'a BodyMotion<T> {
        &pose.motion.states[body]
    }

    /// The motion of a body, with velocity and acceleration of its own frame's origin.
    pub fn body_motion<T: Lift<C>>(&self, pose: &Pose<T>, body: usize) -> BodyMotion<T> {
        let state = &pose.motion.states[body];
        let frame = &pose.frames[body];
        // From the internal origin to that of the body's frame.
        let origin = self.tree.internal[body].inverse().position;
        let arm = frame.rotation.apply(origin.cast());
        BodyMotion {
            velocity: state.point_velocity(arm),
            angular_velocity: state.angular_velocity,
            acceleration: state.point_acceleration(arm),
            angular_acceleration: state.angular_acceleration,
        }
    }
}
