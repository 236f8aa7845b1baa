//! Kinetostatic runs, `N` side by side at one pose: from the rates of every frame to inertia
//! forces, multipliers, actuator actions and reactions. All runs share the pose and its factors.

use crate::model::Model;
use dwell_geometry::frames::Turning;
use dwell_geometry::{Balance, Plan, Pose, Scalar, Vec2};

/// The state of `N` runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Runs<T, const N: usize> {
    /// By frame and run: ω², α.
    rates: Vec<[[T; 2]; N]>,
    /// By slide and run: Coriolis acceleration across the slide, acceleration along it.
    slide_rates: Vec<[[T; 2]; N]>,
    /// The frame of each slide.
    slide_frames: Vec<usize>,
    /// By carried body: acceleration of its root, m/s².
    acceleration: Vec<[Vec2<T>; N]>,
    /// By carried body: m a of its own centre of mass, N.
    pub(crate) own: Vec<[Vec2<T>; N]>,
    /// By carried body: m a of everything it carries, N.
    carried: Vec<[Vec2<T>; N]>,
    pub(crate) balance: Balance<T, N>,
    /// By carried body: what the joint that carries it exerts on it, N.
    pub(crate) held: Vec<[Vec2<T>; N]>,
    /// By body: the couple that prismatic joints and actuators must exert on it, N·m.
    pub(crate) couple: Vec<[T; N]>,
}

impl<T: Scalar, const N: usize> Runs<T, N> {
    pub(crate) fn new(plan: &Plan) -> Self {
        let bodies = plan.carried().len();
        let vector = [Vec2::zero(); N];
        let mut slide_frames = vec![0; plan.tree().slides];
        for body in plan.carried() {
            if let Some((slide, _)) = body.slide {
                slide_frames[slide] = body.frame;
            }
        }
        Self {
            rates: vec![[[T::lift(0.0); 2]; N]; plan.frames().frames.len()],
            slide_rates: vec![[[T::lift(0.0); 2]; N]; plan.tree().slides],
            slide_frames,
            acceleration: vec![vector; bodies],
            own: vec![vector; bodies],
            carried: vec![vector; bodies],
            balance: plan.balance(),
            held: vec![vector; bodies],
            couple: vec![[T::lift(0.0); N]; bodies + 1],
        }
    }

    /// Sets ω² and α of every frame.
    pub(crate) fn set_rates(&mut self, rate: impl Fn(usize) -> [[T; 2]; N]) {
        for (frame, rates) in self.rates.iter_mut().enumerate() {
            *rates = rate(frame);
        }
    }

    /// Sets the rates of every slide, given its index and its frame.
    pub(crate) fn set_slide_rates(&mut self, rate: impl Fn(usize, usize) -> [[T; 2]; N]) {
        let frames = self.slide_frames.iter();
        for ((slide, rates), &frame) in self.slide_rates.iter_mut().enumerate().zip(frames) {
            *rates = rate(slide, frame);
        }
    }

    /// Inertia forces, then multipliers, then (where asked for) what the tree's joints bear.
    pub(crate) fn evaluate(&mut self, model: &Model, pose: &Pose<T>) {
        self.accelerate(model, pose);
        self.collect(model, pose);
        model.plan.multipliers(pose, &mut self.balance);
        if model.sources.tree_forces {
            self.hold(model, pose);
        }
        if model.sources.moments {
            self.twist(model, pose);
        }
    }

    /// What an arm adds to a point's acceleration: α ẑ×r − ω² r.
    #[inline]
    fn of_arm(&self, frame: usize, arm: Vec2<T>, n: usize) -> Vec2<T> {
        let [square, rate] = self.rates[frame][n];
        arm.perp() * rate - arm * square
    }

    /// Accelerations of the roots, and each body's own inertia force and moment.
    fn accelerate(&mut self, model: &Model, pose: &Pose<T>) {
        for (i, body) in model.plan.carried().iter().enumerate() {
            let mut sum = match body.parent {
                Some(parent) => self.acceleration[parent],
                None => [Vec2::zero(); N],
            };
            if let Some(arm) = body.arm {
                for (n, value) in sum.iter_mut().enumerate() {
                    *value += self.of_arm(body.parent_frame, pose.arm[arm], n);
                }
            }
            if let Some((slide, direction)) = body.slide {
                let along = pose.arm[direction];
                for (n, value) in sum.iter_mut().enumerate() {
                    let [across, rate] = self.slide_rates[slide][n];
                    *value += self.of_arm(body.frame, along * pose.slide[slide], n);
                    *value += along * rate + along.perp() * across;
                }
            }
            self.acceleration[i] = sum;
            self.own[i] = [Vec2::zero(); N];
        }
        for moment in &mut self.balance.moment {
            *moment = [T::lift(0.0); N];
        }
        for body in &model.massive {
            let arm = body.arm.map(|a| a.lift().turn(pose.turn[body.frame]));
            for n in 0..N {
                let mut force = self.acceleration[body.carried][n];
                let mut moment = T::lift(body.inertia) * self.rates[body.frame][n][1];
                if let Some(arm) = arm {
                    force += self.of_arm(body.frame, arm, n);
                    moment += arm.cross(force) * T::lift(body.mass);
                }
                self.own[body.carried][n] = force * T::lift(body.mass);
                self.balance.moment[body.frame][n] += moment;
            }
        }
    }

    /// Carries the inertia forces down the tree: moments on the frames, pushes on the slides.
    fn collect(&mut self, model: &Model, pose: &Pose<T>) {
        self.carried.copy_from_slice(&self.own);
        for (i, body) in model.plan.carried().iter().enumerate().rev() {
            let force = self.carried[i];
            if let Some(parent) = body.parent {
                for (sum, f) in self.carried[parent].iter_mut().zip(force) {
                    *sum += f;
                }
            }
            if let Some(arm) = body.arm {
                let moment = &mut self.balance.moment[body.parent_frame];
                for (sum, f) in moment.iter_mut().zip(force) {
                    *sum += pose.arm[arm].cross(f);
                }
            }
            if let Some((slide, direction)) = body.slide {
                let along = pose.arm[direction];
                let reach = along * pose.slide[slide];
                self.balance.push[slide] = force.map(|f| along.dot(f));
                for (sum, f) in self.balance.moment[body.frame].iter_mut().zip(force) {
                    *sum += reach.cross(f);
                }
            }
        }
    }

    /// What each joint of the tree exerts on the body it carries: the inertia forces of all that
    /// hangs on it, less what the chords exert there.
    fn hold(&mut self, model: &Model, pose: &Pose<T>) {
        self.held.copy_from_slice(&self.own);
        for (c, ends) in model.sources.chords.iter().enumerate() {
            let force = self.chord_force(model, pose, c);
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                if let Some(body) = end.carried {
                    for (sum, f) in self.held[body].iter_mut().zip(force) {
                        *sum += f * T::lift(sign);
                    }
                }
            }
        }
        for (i, body) in model.plan.carried().iter().enumerate().rev() {
            if let Some(parent) = body.parent {
                let force = self.held[i];
                for (sum, f) in self.held[parent].iter_mut().zip(force) {
                    *sum += f;
                }
            }
        }
    }

    /// The force of a chord's first body on its second, in ground axes.
    pub(crate) fn chord_force(
        &self,
        model: &Model,
        pose: &Pose<T>,
        closure: usize,
    ) -> [Vec2<T>; N] {
        let multiplier = self.balance.multiplier[closure];
        match model.plan.closures()[closure].axis {
            None => multiplier,
            Some((axis, _)) => {
                let normal = pose.arm[axis].perp();
                multiplier.map(|m| normal * m.x)
            }
        }
    }

    /// The couples that prismatic joints and actuators exert: each body's moment balance about
    /// its root, then along the holds from the outermost body inwards.
    fn twist(&mut self, model: &Model, pose: &Pose<T>) {
        for couple in &mut self.couple {
            *couple = [T::lift(0.0); N];
        }
        let carried = model.plan.carried();
        for body in &model.massive {
            let arm = body.arm.map(|a| a.lift().turn(pose.turn[body.frame]));
            let couple = &mut self.couple[carried[body.carried].body.0];
            for n in 0..N {
                couple[n] += T::lift(body.inertia) * self.rates[body.frame][n][1];
                if let Some(arm) = arm {
                    couple[n] += arm.cross(self.own[body.carried][n]);
                }
            }
        }
        for (c, ends) in model.sources.chords.iter().enumerate() {
            let force = self.chord_force(model, pose, c);
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                let mut arm = end.arm.lift().turn(pose.turn[end.frame]);
                if let (true, Some((axis, _))) = (sign > 0.0, model.plan.closures()[c].axis) {
                    // The force acts at the second body's point on both.
                    arm += pose.arm[axis] * pose.travel[c];
                }
                for (sum, f) in self.couple[end.body].iter_mut().zip(force) {
                    *sum += arm.cross(f) * T::lift(sign);
                }
            }
        }
        for (i, body) in carried.iter().enumerate() {
            let force = self.held[i];
            let parent = model.sources.parent_body[i];
            if let Some(arm) = body.arm {
                for (sum, f) in self.couple[parent].iter_mut().zip(force) {
                    *sum += pose.arm[arm].cross(f);
                }
            }
            if let Some((slide, direction)) = body.slide {
                let reach = pose.arm[direction] * pose.slide[slide];
                // The force acts at the second body's point: the root of the body itself, or
                // the joint's point on the one that carries it.
                let on = if model.sources.carried_is_second[i] {
                    parent
                } else {
                    body.body.0
                };
                for (sum, f) in self.couple[on].iter_mut().zip(force) {
                    *sum += reach.cross(f);
                }
            }
        }
        for hold in model.plan.frames().holds.iter().rev() {
            let couple = self.couple[hold.body.0];
            for (sum, c) in self.couple[hold.against.0].iter_mut().zip(couple) {
                *sum += c;
            }
        }
    }

    /// An actuator's action on its second body, from what remains on the frames it turns.
    pub(crate) fn tau(&self, model: &Model, actuator: usize) -> [T; N] {
        let frames = &model.plan.frames().frames;
        let mut sum = [T::lift(0.0); N];
        for &(frame, sign) in &model.sources.driven[actuator] {
            debug_assert!(matches!(frames[frame].turning, Turning::Driven { .. }));
            for (s, m) in sum.iter_mut().zip(self.balance.moment[frame]) {
                *s += m * T::lift(sign);
            }
        }
        sum
    }
}
