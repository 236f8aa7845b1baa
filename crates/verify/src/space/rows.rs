//! The rows of joints and actuators, and how far joints are from closed.

use dwell_geometry::space::{BodyMotion, Joint, JointKind, Mechanism, Placement, Vec3, Wrench};
use std::f64::consts::TAU;

/// The gradient of a row by one body: a force at its frame's origin, and a couple.
pub(super) type Gradient = Wrench;

/// A row of the constraints: on which bodies, with which gradients, and J̇ẋ.
pub(super) struct Row {
    pub(super) bodies: [usize; 2],
    pub(super) gradients: [Gradient; 2],
    pub(super) bias: f64,
}

/// The gradient of a couple.
pub(super) fn couple(moment: Vec3) -> Gradient {
    Gradient {
        force: Vec3::ZERO,
        moment,
    }
}

/// The gradient of a force at a point, with the arm from the frame's origin.
fn force_at(arm: Vec3, force: Vec3) -> Gradient {
    Gradient {
        force,
        moment: arm.cross(force),
    }
}

/// The sides of a joint: axes u, w and normals n, p of both bodies, and d from the first point to the second.
pub(super) struct Sides {
    pub(super) u: Vec3,
    w: Vec3,
    n: Vec3,
    p: Vec3,
    pub(super) d: Vec3,
}

impl Sides {
    pub(super) fn of(joint: &Joint, placements: &[Placement]) -> Self {
        let of = |k: usize| (&placements[joint.bodies[k].0], &joint.sides[k]);
        let [a, b] = [0, 1].map(|k| {
            let (Placement { position, rotation }, side) = of(k);
            *position + rotation.apply(side.point)
        });
        let [u, w] = [0, 1].map(|k| of(k).0.rotation.apply(of(k).1.axis));
        let [n, p] = [0, 1].map(|k| of(k).0.rotation.apply(of(k).1.normal));
        Self {
            u,
            w,
            n,
            p,
            d: b - a,
        }
    }

    /// The angle from normal to normal about the first axis, without whole revolutions.
    pub(super) fn angle(&self) -> f64 {
        self.n.cross(self.p).dot(self.u).atan2(self.n.dot(self.p))
    }

    /// How far a screw's travel is from that of its angle, which may have whole turns, each of 2π pitch.
    fn screw_error(&self, pitch: f64) -> f64 {
        let turns = (self.d.dot(self.u) / pitch - self.angle()) / TAU;
        (turns - turns.round()) * TAU * pitch
    }
}

/// The bodies in a pass.
pub(super) struct Bodies<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) placements: &'a [Placement],
    pub(super) motions: Vec<BodyMotion>,
}

impl<'a> Bodies<'a> {
    /// Without motion.
    pub(super) fn at_rest(mechanism: &'a Mechanism, placements: &'a [Placement]) -> Self {
        Self {
            mechanism,
            placements,
            motions: vec![BodyMotion::default(); placements.len()],
        }
    }
}

impl Bodies<'_> {
    /// From a body's origin to a point of it.
    pub(super) fn arm(&self, body: usize, point: Vec3) -> Vec3 {
        self.placements[body].rotation.apply(point)
    }

    pub(super) fn point(&self, body: usize, point: Vec3) -> Vec3 {
        self.placements[body].position + self.arm(body, point)
    }

    /// ω × (ω × u).
    fn turned_twice(&self, body: usize, u: Vec3) -> Vec3 {
        let w = self.motions[body].angular_velocity;
        w.cross(w.cross(u))
    }

    /// u·w of directions in the first and the second body.
    fn right_angle(&self, [a, b]: [usize; 2], u: Vec3, w: Vec3) -> Row {
        let turning = u.cross(w);
        let [wa, wb] = [a, b].map(|body| self.motions[body].angular_velocity);
        let (u1, w1) = (wa.cross(u), wb.cross(w));
        let bias =
            self.turned_twice(a, u).dot(w) + 2.0 * u1.dot(w1) + u.dot(self.turned_twice(b, w));
        Row {
            bodies: [a, b],
            gradients: [couple(turning), couple(-turning)],
            bias,
        }
    }

    /// u·d of a direction in the first body.
    pub(super) fn in_plane(&self, joint: &Joint, u: Vec3) -> Row {
        let ([a, _], _, d) = self.ends(joint);
        let u1 = self.motions[a].angular_velocity.cross(u);
        let mut row = self.along(joint, u, |d1| {
            self.turned_twice(a, u).dot(d) + 2.0 * u1.dot(d1)
        });
        row.gradients[0].moment += u.cross(d);
        row
    }

    /// e·d of a direction of the ground, or d·d of a distance.
    fn along(&self, joint: &Joint, e: Vec3, of_velocity: impl Fn(Vec3) -> f64) -> Row {
        let (bodies, arms, _) = self.ends(joint);
        let [a, b] = bodies;
        let d1 = self.velocity(b, arms[1]) - self.velocity(a, arms[0]);
        let d2 = self.turned_twice(b, arms[1]) - self.turned_twice(a, arms[0]);
        Row {
            bodies,
            gradients: [force_at(arms[0], -e), force_at(arms[1], e)],
            bias: e.dot(d2) + of_velocity(d1),
        }
    }

    fn velocity(&self, body: usize, arm: Vec3) -> Vec3 {
        let motion = &self.motions[body];
        motion.velocity + motion.angular_velocity.cross(arm)
    }

    fn ends(&self, joint: &Joint) -> ([usize; 2], [Vec3; 2], Vec3) {
        let bodies = joint.bodies.map(|b| b.0);
        let arms = [0, 1].map(|k| self.arm(bodies[k], joint.sides[k].point));
        let [a, b] = [0, 1].map(|k| self.point(bodies[k], joint.sides[k].point));
        (bodies, arms, b - a)
    }

    /// The distance of a joint's points: its row has the unit vector from one to the other.
    pub(super) fn distance(&self, joint: &Joint) -> Row {
        let (_, _, d) = self.ends(joint);
        let length = d.norm();
        let along = d.scaled(1.0 / length);
        self.along(joint, along, |d1| {
            (d1.dot(d1) - d1.dot(along).powi(2)) / length
        })
    }

    /// The velocity of the second wheel less that of the first, at the pitch point P and along the normal n of the teeth, both fixed in
    /// the carrier c:
    ///
    /// ```text
    /// n·(ẋ₂ − ẋ₁) = 0,     ẋ_k = v_k + ω_k×(P − r_k),     J̇ẋ = (ω_c×n)·(ẋ₂ − ẋ₁) + n·Σ ± ω_k×(ẋ_c − v_k)
    /// ```
    fn mesh(&self, joint: &Joint, carrier: usize) -> Row {
        let bodies = joint.bodies.map(|b| b.0);
        let n = self.arm(carrier, joint.sides[0].axis);
        let p = self.point(carrier, joint.sides[0].point);
        let arm = |body: usize| p - self.placements[body].position;
        let at = |body: usize| self.velocity(body, arm(body));
        let turned = |body: usize| {
            let motion = &self.motions[body];
            motion.angular_velocity.cross(at(carrier) - motion.velocity)
        };
        let [a, b] = bodies;
        let n1 = self.motions[carrier].angular_velocity.cross(n);
        Row {
            bodies,
            gradients: [force_at(arm(a), -n), force_at(arm(b), n)],
            bias: n1.dot(at(b) - at(a)) + n.dot(turned(b) - turned(a)),
        }
    }

    /// The angle of a joint about the axis u of the first body.
    pub(super) fn angle(&self, joint: &Joint, u: Vec3) -> Row {
        let bodies = joint.bodies.map(|b| b.0);
        let [wa, wb] = bodies.map(|body| self.motions[body].angular_velocity);
        Row {
            bodies,
            gradients: [couple(-u), couple(u)],
            bias: wa.cross(u).dot(wb - wa),
        }
    }

    /// The rows (2) of a joint.
    pub(super) fn rows(&self, joint: &Joint) -> Vec<Row> {
        let bodies = joint.bodies.map(|b| b.0);
        let Sides { u, w, n, p, d } = Sides::of(joint, self.placements);
        let across = [n, u.cross(n)];
        let meets = || {
            Vec3::AXES
                .map(|e| self.along(joint, e, |_| 0.0))
                .into_iter()
        };
        let parallel = || across.map(|v| self.right_angle(bodies, v, w)).into_iter();
        let on_line = || across.map(|v| self.in_plane(joint, v)).into_iter();
        let no_turn = || [self.right_angle(bodies, n, w.cross(p))];
        match joint.kind {
            JointKind::Weld => meets().chain(parallel()).chain(no_turn()).collect(),
            JointKind::Revolute => meets().chain(parallel()).collect(),
            JointKind::Prismatic => on_line().chain(parallel()).chain(no_turn()).collect(),
            JointKind::Cylindrical => on_line().chain(parallel()).collect(),
            JointKind::Helical { pitch } => {
                let (mut travel, turn) = (self.in_plane(joint, u), self.angle(joint, u));
                for (row, turn) in travel.gradients.iter_mut().zip(turn.gradients) {
                    row.moment += turn.moment.scaled(-pitch);
                }
                travel.bias -= pitch * turn.bias;
                on_line().chain(parallel()).chain([travel]).collect()
            }
            JointKind::Universal => meets().chain([self.right_angle(bodies, u, w)]).collect(),
            JointKind::Spherical => meets().collect(),
            JointKind::Planar => {
                let in_plane = [self.in_plane(joint, u)].into_iter();
                in_plane.chain(parallel()).collect()
            }
            JointKind::Distance { length } => {
                vec![self.along(joint, d.scaled(1.0 / length), |d1| d1.dot(d1) / length)]
            }
            JointKind::Gear { carrier } => vec![self.mesh(joint, carrier.0)],
        }
    }

    /// The residuals of the rows (2) of a joint, in their order. That of a gear pair is one of velocities: it has none here.
    pub(super) fn residuals(&self, joint: &Joint) -> Vec<f64> {
        let sides = Sides::of(joint, self.placements);
        let Sides { u, w, n, p, d } = sides;
        let across = u.cross(n);
        let (meets, parallel) = ([d.x, d.y, d.z], [n.dot(w), across.dot(w)]);
        let (on_line, no_turn) = ([n.dot(d), across.dot(d)], n.dot(w.cross(p)));
        let all: &[&[f64]] = match joint.kind {
            JointKind::Weld => &[&meets, &parallel, &[no_turn]],
            JointKind::Revolute => &[&meets, &parallel],
            JointKind::Prismatic => &[&on_line, &parallel, &[no_turn]],
            JointKind::Cylindrical => &[&on_line, &parallel],
            JointKind::Helical { pitch } => &[&on_line, &parallel, &[sides.screw_error(pitch)]],
            JointKind::Universal => &[&meets, &[u.dot(w)]],
            JointKind::Spherical => &[&meets],
            JointKind::Planar => &[&[u.dot(d)], &parallel],
            JointKind::Distance { length } => &[&[(d.dot(d) - length * length) / (2.0 * length)]],
            JointKind::Gear { .. } => &[&[0.0]],
        };
        all.concat()
    }
}

/// How far a joint is from closed, m and rad: the residual of its rows (2) at placements of all bodies. The row of a gear pair is one of
/// velocities: what its wheels have travelled is seen by comparing two poses, not here.
pub fn closure_error(joint: &Joint, placements: &[Placement]) -> f64 {
    let sides = Sides::of(joint, placements);
    let Sides { u, w, n, p, d } = sides;
    let (apart, tilt) = (d.norm(), (u - w).norm());
    let (off_line, turn) = (d.cross(u).norm(), (n - p).norm());
    let found: &[f64] = match joint.kind {
        JointKind::Weld => &[apart, tilt, turn],
        JointKind::Revolute => &[apart, tilt],
        JointKind::Prismatic => &[off_line, tilt, turn],
        JointKind::Cylindrical => &[off_line, tilt],
        JointKind::Helical { pitch } => &[off_line, tilt, sides.screw_error(pitch)],
        JointKind::Universal => &[apart, u.dot(w)],
        JointKind::Spherical => &[apart],
        JointKind::Planar => &[d.dot(u), tilt],
        JointKind::Distance { length } => &[apart - length],
        JointKind::Gear { .. } => &[],
    };
    found.iter().fold(0.0, |all, part| all.max(part.abs()))
}

/// How far the teeth of a gear pair are off after moving from one pose to another, m: what they travel on the second wheel less on the first, each
/// relative to the carrier by the screw that leads from one pose to the other (its angle below half a revolution). None of other joints.
pub fn mesh_error(joint: &Joint, poses: [&[Placement]; 2]) -> Option<f64> {
    let JointKind::Gear { carrier } = joint.kind else {
        return None;
    };
    let travel = |wheel: usize| {
        let [before, after] = poses.map(|at| in_frame(&at[carrier.0], &at[wheel]));
        let turned = after.rotation.after(&before.rotation.inverse());
        let w = turned.vector();
        // Of the point of the carrier where the teeth are.
        let p = joint.sides[0].point;
        let moved = after.position + turned.apply(p - before.position) - p;
        joint.sides[0].axis.dot(along_screw(w, moved))
    };
    let [first, second] = joint.bodies.map(|b| travel(b.0));
    Some(second - first)
}

/// A placement in the frame of another.
fn in_frame(frame: &Placement, body: &Placement) -> Placement {
    Placement {
        position: frame.rotation.apply_inverse(body.position - frame.position),
        rotation: frame.rotation.inverse().after(&body.rotation),
    }
}

/// The velocity of a point that a constant twist with this rotation vector w moves by d in unit time: the logarithm of a displacement
/// (Murray, Li and Sastry 1994, eq. 2.36),
///
/// ```text
/// v = d − ½ w×d + (1/θ² − (1 + cos θ)/(2 θ sin θ)) w×(w×d),     θ = |w|
/// ```
fn along_screw(w: Vec3, d: Vec3) -> Vec3 {
    let angle = w.norm();
    let factor = if angle < 1e-3 {
        1.0 / 12.0
    } else {
        1.0 / angle.powi(2) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin())
    };
    let across = w.cross(d);
    d - across.scaled(0.5) + w.cross(across).scaled(factor)
}
