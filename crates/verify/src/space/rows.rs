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
        let couple = u.cross(w);
        let [wa, wb] = [a, b].map(|body| self.motions[body].angular_velocity);
        let (u1, w1) = (wa.cross(u), wb.cross(w));
        let bias =
            self.turned_twice(a, u).dot(w) + 2.0 * u1.dot(w1) + u.dot(self.turned_twice(b, w));
        let on = |moment| Gradient {
            force: Vec3::ZERO,
            moment,
        };
        Row {
            bodies: [a, b],
            gradients: [on(couple), on(-couple)],
            bias,
        }
    }

    /// u·d of a direction in the first body.
    pub(super) fn in_plane(&self, joint: &Joint, u: Vec3) -> Row {
        let (bodies, arms, d) = self.ends(joint);
        let [a, b] = bodies;
        let wa = self.motions[a].angular_velocity;
        let d1 = self.velocity(b, arms[1]) - self.velocity(a, arms[0]);
        let d2 = self.turned_twice(b, arms[1]) - self.turned_twice(a, arms[0]);
        let bias = self.turned_twice(a, u).dot(d) + 2.0 * wa.cross(u).dot(d1) + u.dot(d2);
        Row {
            bodies,
            gradients: [
                Gradient {
                    force: -u,
                    moment: u.cross(d) - arms[0].cross(u),
                },
                Gradient {
                    force: u,
                    moment: arms[1].cross(u),
                },
            ],
            bias,
        }
    }

    /// e·d of a direction of the ground, or d·d of a distance.
    fn along(&self, joint: &Joint, e: Vec3, of_velocity: impl Fn(Vec3) -> f64) -> Row {
        let (bodies, arms, _) = self.ends(joint);
        let [a, b] = bodies;
        let d1 = self.velocity(b, arms[1]) - self.velocity(a, arms[0]);
        let d2 = self.turned_twice(b, arms[1]) - self.turned_twice(a, arms[0]);
        Row {
            bodies,
            gradients: [
                Gradient {
                    force: -e,
                    moment: -arms[0].cross(e),
                },
                Gradient {
                    force: e,
                    moment: arms[1].cross(e),
                },
            ],
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
        let on = |body: usize, force: Vec3| Gradient {
            force,
            moment: arm(body).cross(force),
        };
        let turned = |body: usize| {
            let motion = &self.motions[body];
            motion.angular_velocity.cross(at(carrier) - motion.velocity)
        };
        let [a, b] = bodies;
        let n1 = self.motions[carrier].angular_velocity.cross(n);
        Row {
            bodies,
            gradients: [on(a, -n), on(b, n)],
            bias: n1.dot(at(b) - at(a)) + n.dot(turned(b) - turned(a)),
        }
    }

    /// The angle of a joint about the axis u of the first body.
    pub(super) fn angle(&self, joint: &Joint, u: Vec3) -> Row {
        let bodies = joint.bodies.map(|b| b.0);
        let [wa, wb] = bodies.map(|body| self.motions[body].angular_velocity);
        let on = |moment| Gradient {
            force: Vec3::ZERO,
            moment,
        };
        Row {
            bodies,
            gradients: [on(-u), on(u)],
            bias: wa.cross(u).dot(wb - wa),
        }
    }

    /// The rows (2) of a joint.
    pub(super) fn rows(&self, joint: &Joint) -> Vec<Row> {
        let bodies = joint.bodies.map(|b| b.0);
        let [u, w] = [0, 1].map(|k| self.arm(bodies[k], joint.sides[k].axis));
        let [n, p] = [0, 1].map(|k| self.arm(bodies[k], joint.sides[k].normal));
        let across = u.cross(n);
        let mut rows = Vec::new();
        let meets = |rows: &mut Vec<Row>| {
            rows.extend(Vec3::AXES.map(|e| self.along(joint, e, |_| 0.0)));
        };
        let parallel = |rows: &mut Vec<Row>| {
            rows.extend([n, across].map(|v| self.right_angle(bodies, v, w)));
        };
        let on_line =
            |rows: &mut Vec<Row>| rows.extend([n, across].map(|v| self.in_plane(joint, v)));
        let no_turn = |rows: &mut Vec<Row>| rows.push(self.right_angle(bodies, n, w.cross(p)));
        match joint.kind {
            JointKind::Weld => (meets(&mut rows), parallel(&mut rows), no_turn(&mut rows)).2,
            JointKind::Revolute => (meets(&mut rows), parallel(&mut rows)).1,
            JointKind::Prismatic => (on_line(&mut rows), parallel(&mut rows), no_turn(&mut rows)).2,
            JointKind::Cylindrical => (on_line(&mut rows), parallel(&mut rows)).1,
            JointKind::Helical { pitch } => {
                on_line(&mut rows);
                parallel(&mut rows);
                let (mut travel, turn) = (self.in_plane(joint, u), self.angle(joint, u));
                for (row, turn) in travel.gradients.iter_mut().zip(turn.gradients) {
                    row.moment += turn.moment.scaled(-pitch);
                }
                travel.bias -= pitch * turn.bias;
                rows.push(travel);
            }
            JointKind::Universal => {
                meets(&mut rows);
                rows.push(self.right_angle(bodies, u, w));
            }
            JointKind::Spherical => meets(&mut rows),
            JointKind::Planar => {
                rows.push(self.in_plane(joint, u));
                parallel(&mut rows);
            }
            JointKind::Distance { length } => {
                let (_, _, d) = self.ends(joint);
                rows.push(self.along(joint, d.scaled(1.0 / length), |d1| d1.dot(d1) / length));
            }
            JointKind::Gear { carrier } => rows.push(self.mesh(joint, carrier.0)),
        }
        rows
    }
}

impl Bodies<'_> {
    /// The residuals of the rows (2) of a joint, in their order. That of a gear pair is one of velocities: it has none here.
    pub(super) fn residuals(&self, joint: &Joint) -> Vec<f64> {
        let bodies = joint.bodies.map(|b| b.0);
        let [u, w] = [0, 1].map(|k| self.arm(bodies[k], joint.sides[k].axis));
        let [n, p] = [0, 1].map(|k| self.arm(bodies[k], joint.sides[k].normal));
        let across = u.cross(n);
        let (_, _, d) = self.ends(joint);
        let (meets, parallel) = ([d.x, d.y, d.z], [n.dot(w), across.dot(w)]);
        let (on_line, no_turn) = ([n.dot(d), across.dot(d)], n.dot(w.cross(p)));
        let all: &[&[f64]] = match joint.kind {
            JointKind::Weld => &[&meets, &parallel, &[no_turn]],
            JointKind::Revolute => &[&meets, &parallel],
            JointKind::Prismatic => &[&on_line, &parallel, &[no_turn]],
            JointKind::Cylindrical => &[&on_line, &parallel],
            JointKind::Helical { pitch } => {
                &[&on_line, &parallel, &[screw_error(pitch, [u, d, n, p])]]
            }
            JointKind::Universal => &[&meets, &[u.dot(w)]],
            JointKind::Spherical => &[&meets],
            JointKind::Planar => &[&[u.dot(d)], &parallel],
            JointKind::Distance { length } => &[&[(d.dot(d) - length * length) / (2.0 * length)]],
            JointKind::Gear { .. } => &[&[0.0]],
        };
        all.concat()
    }
}

/// How far a screw's travel is from that of its angle, which may have whole turns, each of 2π pitch.
fn screw_error(pitch: f64, [u, d, n, p]: [Vec3; 4]) -> f64 {
    let angle = n.cross(p).dot(u).atan2(n.dot(p));
    let turns = (d.dot(u) / pitch - angle) / TAU;
    (turns - turns.round()) * TAU * pitch
}

/// How far a joint is from closed, m and rad: the residual of its rows (2) at placements of all bodies. The row of a gear pair is one of
/// velocities: what its wheels have travelled is seen by comparing two poses, not here.
pub fn closure_error(joint: &Joint, placements: &[Placement]) -> f64 {
    let bodies = joint.bodies.map(|b| b.0);
    let at = |k: usize, v: Vec3| placements[bodies[k]].rotation.apply(v);
    let point = |k: usize| placements[bodies[k]].position + at(k, joint.sides[k].point);
    let d = point(1) - point(0);
    let [u, w] = [0, 1].map(|k| at(k, joint.sides[k].axis));
    let [n, p] = [0, 1].map(|k| at(k, joint.sides[k].normal));
    let (apart, tilt) = (d.norm(), (u - w).norm());
    let (off_line, turn) = (d.cross(u).norm(), (n - p).norm());
    let found: &[f64] = match joint.kind {
        JointKind::Weld => &[apart, tilt, turn],
        JointKind::Revolute => &[apart, tilt],
        JointKind::Prismatic => &[off_line, tilt, turn],
        JointKind::Cylindrical => &[off_line, tilt],
        JointKind::Helical { pitch } => &[off_line, tilt, screw_error(pitch, [u, d, n, p])],
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
