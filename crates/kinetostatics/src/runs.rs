//! Kinetostatic runs, `N` side by side at one pose: from the rates of every frame to inertia
//! forces, multipliers, actuator actions and reactions. All runs share the pose and its factors.

use crate::model::Model;
use dwell_geometry::scalar::each;
use dwell_geometry::{Balance, Motion, Plan, Pose, Scalar, Vec2};

/// The rates of `N` runs: what they make of the inertia of a frame and of its constant vectors.
pub(crate) trait Rates<T, const N: usize>: Copy {
    /// Angular acceleration of a frame, rad/s².
    fn turning(self, frame: usize) -> [T; N];
    /// What a vector that turns with a frame adds to a point's acceleration: α ẑ×r − ω² r.
    fn arm(self, frame: usize, arm: Vec2<T>) -> [Vec2<T>; N];
    /// The acceleration along a slide, and across it Coriolis's.
    fn slide(self, slide: usize, frame: usize, along: Vec2<T>) -> [Vec2<T>; N];
}

/// One run at the speeds and accelerations of a motion.
#[derive(Clone, Copy)]
pub(crate) struct Prescribed<'a, T>(pub(crate) &'a Motion<T>);

/// The two unit runs of a mechanism with one actuator, from its motion at q̇ = 1, q̈ = 0: that
/// motion itself, and the one with q̇ = 0, q̈ = 1, whose accelerations are the first one's velocities.
#[derive(Clone, Copy)]
pub(crate) struct Unit<'a, T>(pub(crate) &'a Motion<T>);

/// One run at rest, with the velocities of a motion for accelerations.
#[derive(Clone, Copy)]
pub(crate) struct Pushed<'a, T>(pub(crate) &'a Motion<T>);

/// One run in which nothing moves.
#[derive(Clone, Copy)]
pub(crate) struct Still;

impl<T: Scalar> Rates<T, 1> for Pushed<'_, T> {
    #[inline(always)]
    fn turning(self, frame: usize) -> [T; 1] {
        [self.0.turn[frame]]
    }

    #[inline(always)]
    fn arm(self, frame: usize, arm: Vec2<T>) -> [Vec2<T>; 1] {
        [arm.perp() * self.0.turn[frame]]
    }

    #[inline(always)]
    fn slide(self, slide: usize, _: usize, along: Vec2<T>) -> [Vec2<T>; 1] {
        [along * self.0.slide[slide]]
    }
}

impl<T: Scalar> Rates<T, 1> for Still {
    #[inline(always)]
    fn turning(self, _: usize) -> [T; 1] {
        [T::lift(0.0)]
    }

    #[inline(always)]
    fn arm(self, _: usize, _: Vec2<T>) -> [Vec2<T>; 1] {
        [Vec2::zero()]
    }

    #[inline(always)]
    fn slide(self, _: usize, _: usize, _: Vec2<T>) -> [Vec2<T>; 1] {
        [Vec2::zero()]
    }
}

impl<T: Scalar> Rates<T, 1> for Prescribed<'_, T> {
    #[inline(always)]
    fn turning(self, frame: usize) -> [T; 1] {
        [self.0.turn_rate[frame]]
    }

    #[inline(always)]
    fn arm(self, frame: usize, arm: Vec2<T>) -> [Vec2<T>; 1] {
        let speed = self.0.turn[frame];
        [arm.perp() * self.0.turn_rate[frame] - arm * (speed * speed)]
    }

    #[inline(always)]
    fn slide(self, slide: usize, frame: usize, along: Vec2<T>) -> [Vec2<T>; 1] {
        let across = T::lift(2.0) * self.0.turn[frame] * self.0.slide[slide];
        [along * self.0.slide_rate[slide] + along.perp() * across]
    }
}

impl<T: Scalar> Rates<T, 2> for Unit<'_, T> {
    #[inline(always)]
    fn turning(self, frame: usize) -> [T; 2] {
        [self.0.turn_rate[frame], self.0.turn[frame]]
    }

    #[inline(always)]
    fn arm(self, frame: usize, arm: Vec2<T>) -> [Vec2<T>; 2] {
        let [first] = Prescribed(self.0).arm(frame, arm);
        [first, arm.perp() * self.0.turn[frame]]
    }

    #[inline(always)]
    fn slide(self, slide: usize, frame: usize, along: Vec2<T>) -> [Vec2<T>; 2] {
        let [first] = Prescribed(self.0).slide(slide, frame, along);
        [first, along * self.0.slide[slide]]
    }
}

/// The state of `N` runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Runs<T, const N: usize> {
    /// By link: acceleration of its root, m/s².
    acceleration: Vec<[Vec2<T>; N]>,
    /// By link: m a of its body and of everything that it carries, N.
    force: Vec<[Vec2<T>; N]>,
    pub(crate) balance: Balance<T, N>,
    /// By carried body: what the joint that carries it exerts on it, N.
    pub(crate) held: Vec<[Vec2<T>; N]>,
    /// By body: the couple that prismatic joints and actuators must exert on it, N·m.
    pub(crate) couple: Vec<[T; N]>,
}

#[inline(always)]
#[track_caller]
fn add<V: std::ops::AddAssign, const N: usize>(sum: &mut [V; N], more: [V; N]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}

impl<T: Scalar, const N: usize> Runs<T, N> {
    pub(crate) fn new(plan: &Plan, links: usize) -> Self {
        let bodies = plan.carried().len();
        let vector = [Vec2::zero(); N];
        Self {
            acceleration: vec![vector; links],
            force: vec![vector; links],
            balance: plan.balance(),
            held: vec![vector; bodies],
            couple: vec![[T::lift(0.0); N]; bodies + 1],
        }
    }

    /// Inertia forces, then multipliers, then (where asked for) what the tree's joints bear.
    #[inline(always)]
    pub(crate) fn evaluate(&mut self, model: &Model, pose: &Pose<T>, rates: impl Rates<T, N>) {
        self.accelerate(model, pose, rates);
        if model.sources.tree_forces {
            self.note(model, pose, rates);
        }
        self.collect(model, pose);
        model.plan.multipliers(pose, &mut self.balance);
        if model.sources.tree_forces {
            self.hold(model, pose);
        }
        if model.sources.moments {
            self.twist(model, pose, rates);
            self.along_holds(model);
        }
    }

    /// Accelerations of the roots, and each body's own inertia force and its moment about its
    /// root: Σ m r×a = I α + (Σ m r)×(the root's acceleration).
    #[inline(always)]
    pub(crate) fn accelerate(&mut self, model: &Model, pose: &Pose<T>, rates: impl Rates<T, N>) {
        let moments = self.balance.moment.iter_mut().zip(&model.inertia);
        for (frame, (moment, &inertia)) in moments.enumerate() {
            *moment = each(rates.turning(frame), |rate| rate * T::lift(inertia));
        }
        for (i, link) in model.links.iter().enumerate() {
            let mut root = match link.parent {
                Some(parent) => self.acceleration[parent],
                None => [Vec2::zero(); N],
            };
            if let Some((arm, frame)) = link.arm {
                add(&mut root, rates.arm(frame, pose.arm[arm]));
            }
            if let Some((slide, direction)) = link.slide {
                let along = pose.arm[direction];
                add(&mut root, rates.slide(slide, link.frame, along));
                add(&mut root, rates.arm(link.frame, along * pose.slide[slide]));
            }
            let mut force = each(root, |a| a * T::lift(link.mass));
            if let Some(first) = link.first {
                let first = first.lift().turn(pose.turn[link.frame]);
                add(&mut force, rates.arm(link.frame, first));
                add(
                    &mut self.balance.moment[link.frame],
                    each(root, |a| first.cross(a)),
                );
            }
            self.acceleration[i] = root;
            self.force[i] = force;
        }
    }

    /// Carries the inertia forces down the tree: moments on the frames, pushes on the slides.
    #[inline(always)]
    pub(crate) fn collect(&mut self, model: &Model, pose: &Pose<T>) {
        let Balance { moment, push, .. } = &mut self.balance;
        push.fill([T::lift(0.0); N]);
        for (i, link) in model.links.iter().enumerate().rev() {
            let force = self.force[i];
            if let Some(parent) = link.parent {
                add(&mut self.force[parent], force);
            }
            if let Some((arm, frame)) = link.arm {
                let arm = pose.arm[arm];
                add(&mut moment[frame], each(force, |f| arm.cross(f)));
            }
            if let Some((slide, direction)) = link.slide {
                let along = pose.arm[direction];
                let reach = along * pose.slide[slide];
                push[slide] = each(force, |f| along.dot(f));
                add(&mut moment[link.frame], each(force, |f| reach.cross(f)));
            }
        }
    }

    // The rest is for reactions in the tree's joints, of the bodies alone that the requested ones need.

    /// Notes each body's own inertia force: the first part of what its joint must exert on it.
    #[inline(always)]
    pub(crate) fn note(&mut self, model: &Model, pose: &Pose<T>, rates: impl Rates<T, N>) {
        let needed = &model.sources.held;
        self.held.fill([Vec2::zero(); N]);
        for (link, force) in model.links.iter().zip(&self.force) {
            self.held[link.carried] = *force;
        }
        for body in &model.massive {
            if let (true, true, Some(first)) = (body.at_rest, needed[body.carried], body.first) {
                let first = first.lift().turn(pose.turn[body.frame]);
                self.held[body.carried] = rates.arm(body.frame, first);
            }
        }
    }

    /// What each joint of the tree exerts on the body it carries, where that is needed: the inertia forces
    /// of all that hangs on it, less what the chords exert there.
    #[inline(always)]
    pub(crate) fn hold(&mut self, model: &Model, pose: &Pose<T>) {
        let sources = &model.sources;
        for (c, ends) in sources.chords.iter().enumerate() {
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                if let (true, Some(body)) = (sources.end_is_held(end), end.carried) {
                    let force = self.chord_force(model, pose, c);
                    add(&mut self.held[body], each(force, |f| f * T::lift(sign)));
                }
            }
        }
        for (i, body) in model.plan.carried().iter().enumerate().rev() {
            if let Some(parent) = body.parent
                && sources.held[parent]
            {
                let force = self.held[i];
                add(&mut self.held[parent], force);
            }
        }
    }

    /// The force of a chord's first body on its second, in ground axes.
    #[inline(always)]
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
                each(multiplier, |m| normal * m.x)
            }
        }
    }

    /// The couples that prismatic joints and actuators exert: each body's moment balance about
    /// its root, still to be handed on along the holds. Where they are needed.
    #[inline(always)]
    pub(crate) fn twist(&mut self, model: &Model, pose: &Pose<T>, rates: impl Rates<T, N>) {
        self.couple.fill([T::lift(0.0); N]);
        let sources = &model.sources;
        let carried = model.plan.carried();
        for body in model.massive.iter().filter(|m| sources.twisted[m.body]) {
            let turning = rates.turning(body.frame);
            self.couple[body.body] = each(turning, |a| a * T::lift(body.about_root));
        }
        for (link, &root) in model.links.iter().zip(&self.acceleration) {
            let body = carried[link.carried].body;
            if let (true, Some(first)) = (sources.twisted[body], link.first) {
                let first = first.lift().turn(pose.turn[link.frame]);
                add(&mut self.couple[body], each(root, |a| first.cross(a)));
            }
        }
        for (c, ends) in sources.chords.iter().enumerate() {
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                if !sources.twisted[end.body] {
                    continue;
                }
                let mut arm = match end.arm {
                    Some(arm) => arm.lift().turn(pose.turn[end.frame]),
                    None => Vec2::zero(),
                };
                if let (true, Some((axis, _))) = (sign > 0.0, model.plan.closures()[c].axis) {
                    // The force acts at the second body's point on both.
                    arm += pose.arm[axis] * pose.travel[c];
                }
                let force = self.chord_force(model, pose, c);
                let moment = each(force, |f| arm.cross(f) * T::lift(sign));
                add(&mut self.couple[end.body], moment);
            }
        }
        for r in 0..model.plan.relations() {
            let multiplier = self.balance.relation[r];
            model.plan.relation_couples(r, pose, |body, by| {
                add(&mut self.couple[body], each(multiplier, |m| -(by * m)));
            });
        }
        for (i, body) in carried.iter().enumerate() {
            let force = self.held[i];
            let parent = sources.parent_body[i];
            if let (true, Some(arm)) = (sources.twisted[parent], body.arm) {
                let arm = pose.arm[arm];
                add(&mut self.couple[parent], each(force, |f| arm.cross(f)));
            }
            if let Some((slide, direction)) = body.slide {
                // The force acts at the second body's point: the root of the body itself, or
                // the joint's point on the one that carries it.
                let on = if sources.carried_is_second[i] {
                    parent
                } else {
                    body.body
                };
                if sources.twisted[on] {
                    let reach = pose.arm[direction] * pose.slide[slide];
                    add(&mut self.couple[on], each(force, |f| reach.cross(f)));
                }
            }
        }
    }

    /// Hands the couples on to the bodies that those they act on are held against.
    #[inline(always)]
    pub(crate) fn along_holds(&mut self, model: &Model) {
        for hold in model.plan.frames().holds.iter().rev() {
            let couple = self.couple[hold.body];
            add(&mut self.couple[hold.against], couple);
        }
    }

    /// An actuator's action on its second body, from what remains on the frames it turns.
    #[inline(always)]
    pub(crate) fn tau(&self, model: &Model, actuator: usize) -> [T; N] {
        if let Some(slide) = model.sources.slides[actuator] {
            return self.balance.push[slide];
        }
        let mut sum = [T::lift(0.0); N];
        for &(frame, sign) in &model.sources.driven[actuator] {
            add(
                &mut sum,
                each(self.balance.moment[frame], |m| m * T::lift(sign)),
            );
        }
        sum
    }
}
