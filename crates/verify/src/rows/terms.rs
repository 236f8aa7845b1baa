//! The terms of rows: quantities of two bodies, each with its derivative by a small motion of these, and its second derivative
//! along a motion.

use crate::pose::{Pose, Twist, centripetal};
use dwell_geometry::space::{Vec3, Wrench, vec3};

/// The derivative of a quantity by the motion of a body: a force at the origin of its frame, and a couple.
pub(crate) type Gradient = Wrench;

/// A point of each of two bodies, in their frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    pub(crate) bodies: [usize; 2],
    pub(crate) points: [Vec3; 2],
}

/// A direction of each of two bodies, in their frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Directions {
    pub(crate) bodies: [usize; 2],
    pub(crate) vectors: [Vec3; 2],
}

/// A quantity of two bodies, with d the vector from the point of the first to that of the second.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Term {
    /// θ₂ − θ₁ of bodies that move in the plane, rad, as counted.
    CountedAngle([usize; 2]),
    /// e·d, m, with e fixed in the ground.
    AlongGround(Ends, Vec3),
    /// u·d, m, with u fixed in the first body.
    AlongFirst(Ends, Vec3),
    /// |d|, m. It has no derivative at zero, and gives numbers that are not finite there.
    Distance(Ends),
    /// The direction of d in the plane, rad, in (−π, π]. It does not exist where d is zero.
    LineDirection(Ends),
    /// u·w of a direction in each body.
    Product(Directions),
    /// atan2 of the second product over the first, rad: an angle about an axis.
    Angle([Directions; 2]),
}

/// d with the vectors from the bodies' origins to their points.
struct Gap {
    arms: [Vec3; 2],
    d: Vec3,
}

impl Ends {
    fn gap(&self, poses: &[Pose]) -> Gap {
        let [a, b] = self.bodies.map(|body| &poses[body]);
        let arms = [
            a.rotation.apply(self.points[0]),
            b.rotation.apply(self.points[1]),
        ];
        Gap {
            arms,
            // Origins first: two frames may stand far away, and close to each other.
            d: (b.position - a.position) + (arms[1] - arms[0]),
        }
    }

    /// d, ḋ, and the part of d̈ that comes from the bodies' angular velocities alone.
    fn moving(&self, poses: &[Pose], twists: &[Twist]) -> [Vec3; 3] {
        let Gap { arms, d } = self.gap(poses);
        let [(v1, a1), (v2, a2)] = [0, 1].map(|k| {
            let twist = &twists[self.bodies[k]];
            let turned = twist.angular.cross(arms[k]);
            (twist.linear + turned, centripetal(twist.angular, arms[k]))
        });
        [d, v2 - v1, a2 - a1]
    }

    /// The gradients of a quantity whose variation is w·δP₂ − w·δP₁.
    fn pair(&self, arms: [Vec3; 2], w: Vec3) -> [Gradient; 2] {
        [force_at(arms[0], -w), force_at(arms[1], w)]
    }
}

impl Directions {
    fn turned(&self, poses: &[Pose]) -> [Vec3; 2] {
        [0, 1].map(|k| poses[self.bodies[k]].rotation.apply(self.vectors[k]))
    }

    fn value(&self, poses: &[Pose]) -> f64 {
        let [u, w] = self.turned(poses);
        u.dot(w)
    }

    fn gradients(&self, poses: &[Pose]) -> [Gradient; 2] {
        let [u, w] = self.turned(poses);
        let turning = u.cross(w);
        [couple(turning), couple(-turning)]
    }

    fn second_rate(&self, poses: &[Pose], twists: &[Twist]) -> f64 {
        let [u, w] = self.turned(poses);
        let [wa, wb] = self.bodies.map(|body| twists[body].angular);
        let (u1, w1) = (wa.cross(u), wb.cross(w));
        centripetal(wa, u).dot(w) + 2.0 * u1.dot(w1) + u.dot(centripetal(wb, w))
    }
}

pub(crate) fn couple(moment: Vec3) -> Gradient {
    Gradient {
        force: Vec3::ZERO,
        moment,
    }
}

pub(crate) fn force_at(arm: Vec3, force: Vec3) -> Gradient {
    Gradient {
        force,
        moment: arm.cross(force),
    }
}

/// A vector of the plane turned by a quarter about z.
pub(crate) fn perpendicular(v: Vec3) -> Vec3 {
    vec3(-v.y, v.x, v.z)
}

/// The rate of two gradients in a motion.
pub(crate) fn rate_of(bodies: [usize; 2], gradients: [Gradient; 2], twists: &[Twist]) -> f64 {
    let parts = [0, 1].map(|k| twists[bodies[k]].power(&gradients[k]));
    parts[0] + parts[1]
}

impl Term {
    pub(crate) fn bodies(&self) -> [usize; 2] {
        match self {
            Self::CountedAngle(bodies) => *bodies,
            Self::AlongGround(ends, _)
            | Self::AlongFirst(ends, _)
            | Self::Distance(ends)
            | Self::LineDirection(ends) => ends.bodies,
            Self::Product(of) | Self::Angle([of, _]) => of.bodies,
        }
    }

    /// Its points, to be given in other frames.
    pub(crate) fn ends_mut(&mut self) -> Option<&mut Ends> {
        match self {
            Self::AlongGround(ends, _)
            | Self::AlongFirst(ends, _)
            | Self::Distance(ends)
            | Self::LineDirection(ends) => Some(ends),
            Self::CountedAngle(_) | Self::Product(_) | Self::Angle(_) => None,
        }
    }

    /// The value.
    pub(crate) fn value(&self, poses: &[Pose]) -> f64 {
        match self {
            Self::CountedAngle([a, b]) => poses[*b].angle - poses[*a].angle,
            Self::AlongGround(ends, e) => e.dot(ends.gap(poses).d),
            Self::AlongFirst(ends, u) => {
                let u = poses[ends.bodies[0]].rotation.apply(*u);
                u.dot(ends.gap(poses).d)
            }
            Self::Distance(ends) => ends.gap(poses).d.norm(),
            Self::LineDirection(ends) => {
                let d = ends.gap(poses).d;
                d.y.atan2(d.x)
            }
            Self::Product(of) => of.value(poses),
            Self::Angle([cos, sin]) => sin.value(poses).atan2(cos.value(poses)),
        }
    }

    /// The derivatives by the motions of both bodies.
    pub(crate) fn gradients(&self, poses: &[Pose]) -> [Gradient; 2] {
        match self {
            Self::CountedAngle(_) => [-1.0, 1.0].map(|sign| couple(vec3(0.0, 0.0, sign))),
            Self::AlongGround(ends, e) => ends.pair(ends.gap(poses).arms, *e),
            Self::AlongFirst(ends, u) => {
                let Gap { arms, d } = ends.gap(poses);
                let u = poses[ends.bodies[0]].rotation.apply(*u);
                // The first body's arm reaches to the second point, not to its own, because u turns with it.
                ends.pair([arms[0] + d, arms[1]], u)
            }
            Self::Distance(ends) => {
                let Gap { arms, d } = ends.gap(poses);
                ends.pair(arms, d.scaled(1.0 / d.norm()))
            }
            Self::LineDirection(ends) => {
                let Gap { arms, d } = ends.gap(poses);
                ends.pair(arms, perpendicular(d).scaled(1.0 / d.dot(d)))
            }
            Self::Product(of) => of.gradients(poses),
            Self::Angle([cos, sin]) => {
                let (c, s) = (cos.value(poses), sin.value(poses));
                let square = c * c + s * s;
                let (of_cos, of_sin) = (cos.gradients(poses), sin.gradients(poses));
                [0, 1].map(|k| {
                    couple(
                        (of_sin[k].moment.scaled(c) - of_cos[k].moment.scaled(s))
                            .scaled(1.0 / square),
                    )
                })
            }
        }
    }

    /// The rate in a motion.
    pub(crate) fn rate(&self, poses: &[Pose], twists: &[Twist]) -> f64 {
        rate_of(self.bodies(), self.gradients(poses), twists)
    }

    /// The second derivative along a motion of constant rates.
    pub(crate) fn second_rate(&self, poses: &[Pose], twists: &[Twist]) -> f64 {
        match self {
            Self::CountedAngle(_) => 0.0,
            Self::AlongGround(ends, e) => e.dot(ends.moving(poses, twists)[2]),
            Self::AlongFirst(ends, u) => {
                // d²(u·d) = ü·d + 2 u̇·ḋ + u·d̈.
                let [d, velocity, second_of_d] = ends.moving(poses, twists);
                let a = ends.bodies[0];
                let u = poses[a].rotation.apply(*u);
                let rate = twists[a].angular.cross(u);
                let second = centripetal(twists[a].angular, u);
                u.dot(second_of_d) + 2.0 * rate.dot(velocity) + second.dot(d)
            }
            Self::Distance(ends) => {
                // l l̇ = d·ḋ, so l l̈ = d·d̈ + ḋ·ḋ − l̇², of which the last two are the square of the speed across d.
                let [d, velocity, centripetal] = ends.moving(poses, twists);
                let l = d.norm();
                let e = d.scaled(1.0 / l);
                let across = e.cross(velocity);
                e.dot(centripetal) + across.dot(across) / l
            }
            Self::LineDirection(ends) => {
                // l² ψ̇ = d × ḋ, so l² ψ̈ = d × d̈ − 2 (d·ḋ) ψ̇.
                let [d, velocity, centripetal] = ends.moving(poses, twists);
                let square = d.dot(d);
                let line_rate = d.cross(velocity).z / square;
                (d.cross(centripetal).z - 2.0 * d.dot(velocity) * line_rate) / square
            }
            Self::Product(of) => of.second_rate(poses, twists),
            Self::Angle([cos, sin]) => {
                // r² θ̇ = c ṡ − s ċ, so r² θ̈ = c s̈ − s c̈ − 2 (c ċ + s ṡ) θ̇.
                let rate = |of: &Directions| rate_of(of.bodies, of.gradients(poses), twists);
                let (c, s) = (cos.value(poses), sin.value(poses));
                let (c1, s1) = (rate(cos), rate(sin));
                let (c2, s2) = (
                    cos.second_rate(poses, twists),
                    sin.second_rate(poses, twists),
                );
                let square = c * c + s * s;
                let turning = (c * s1 - s * c1) / square;
                (c * s2 - s * c2 - 2.0 * (c * c1 + s * s1) * turning) / square
            }
        }
    }
}
