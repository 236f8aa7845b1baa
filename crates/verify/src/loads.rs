//! Loads as forces at points and couples, from the definitions of [`LoadKind`] and the frames of the
//! bodies: the reference for generalised forces.

use crate::body_motion::BodyMotion;
use crate::wrenches::BodyWrench;
use dwell_geometry::{BodyId, Component, JointId, Mechanism, Reaction, Vec2};
use dwell_kinetostatics::{Guide, Load, LoadKind, Magnitude, Mass, Mesh, PitchLines};

/// The forces of a load of the given magnitude, with the bodies' frames and their velocities
/// [x, y, θ] in m, rad and per s; a massless body has no weight, the ground's is left out.
/// `None` if it names a body that is not there.
///
/// Coincident points have no line between them: then a spring or damper between them gives
/// forces that are not numbers, unless it is a spring of no free length.
// Long: an arm for each kind of load.
pub fn load_wrenches(
    kind: &LoadKind,
    magnitude: f64,
    ground: usize,
    masses: &[Mass],
    bodies: &[[f64; 3]],
    velocities: &[[f64; 3]],
) -> Option<Vec<BodyWrench>> {
    let motion = BodyMotion {
        poses: bodies,
        velocities,
    };
    let couple = |on: [BodyId; 2], couple: f64| {
        let exist = on.iter().all(|body| body.0 < bodies.len());
        exist.then(|| pair(on, Vec2::ZERO, Vec2::ZERO, couple))
    };
    let force_at = |body: BodyId, point: Vec2, force: Vec2| {
        let point = motion.point(body, point)?;
        Some(BodyWrench::in_plane(body, force, point, 0.0))
    };
    // Both bodies at their own points: the force is along the line between these.
    let pull = |bodies: [BodyId; 2], points: [Vec2; 2], on_second: Vec2| {
        let on_first = force_at(bodies[0], points[0], -on_second)?;
        Some(vec![on_first, force_at(bodies[1], points[1], on_second)?])
    };
    match *kind {
        LoadKind::Gravity { direction } => {
            let all = masses.iter().enumerate();
            let heavy = all.filter(|&(b, mass)| b != ground && mass.mass != 0.0);
            let weight = |(b, mass): (usize, &Mass)| {
                force_at(BodyId(b), mass.center, direction * (mass.mass * magnitude))
            };
            heavy.map(weight).collect()
        }
        LoadKind::Force {
            body,
            point,
            direction,
            body_fixed,
        } => {
            let follower = motion.direction(body, direction)?;
            let direction = if body_fixed { follower } else { direction };
            Some(vec![force_at(body, point, direction * magnitude)?])
        }
        LoadKind::Torque { bodies } => couple(bodies, magnitude),
        LoadKind::Spring {
            bodies,
            points,
            free_length: free,
        } => {
            let [d, _] = motion.gap(bodies, points)?;
            let stretch = match free {
                0.0 => 1.0,
                _ => 1.0 - free / d.norm(),
            };
            pull(bodies, points, d * (-magnitude * stretch))
        }
        LoadKind::TorsionSpring { bodies, free_angle } => {
            let [angle, _] = motion.angle(bodies)?;
            couple(bodies, -magnitude * (angle - free_angle))
        }
        LoadKind::Damper { bodies, points } => {
            let [d, rate] = motion.gap(bodies, points)?;
            let line = d * (1.0 / d.norm());
            pull(bodies, points, line * (-magnitude * rate.dot(line)))
        }
        LoadKind::RotationalDamper { bodies } => {
            let [_, rate] = motion.angle(bodies)?;
            couple(bodies, -magnitude * rate)
        }
        LoadKind::PointToPointForce { bodies, points } => {
            let [d, _] = motion.gap(bodies, points)?;
            pull(bodies, points, d * (magnitude / d.norm()))
        }
        LoadKind::SlideForce(guide) => guide_wrenches(guide, magnitude, &motion),
        LoadKind::SlideDamper(guide) => {
            let [_, rate] = motion.travel(guide.bodies, guide.points, guide.axis)?;
            guide_wrenches(guide, -magnitude * rate, &motion)
        }
        LoadKind::SeparatingForce(mesh) => separating_wrenches(mesh, magnitude, &motion),
    }
}

/// The magnitude of a load that answers to claimed reactions (in the order of [`Mechanism::reactions`]); of every
/// other load, what is claimed of it. Where the teeth of gears have a pressure angle α, the force between them is
/// inclined by α to the tooth force, so that its other part is tan α times that.
pub fn magnitude_by_reactions(
    load: &Load,
    claimed: f64,
    mechanism: &Mechanism,
    reactions: &[f64],
) -> f64 {
    match &load.magnitude {
        Magnitude::Separating(teeth) => {
            let row = reaction_row(mechanism, teeth.joint, Component::Tooth);
            let tooth = row.and_then(|row| reactions.get(row));
            tooth.map_or(f64::NAN, |force| force.abs() * teeth.angle.tan())
        }
        Magnitude::Constant(_)
        | Magnitude::Law(..)
        | Magnitude::Expression(..)
        | Magnitude::Function(..)
        | Magnitude::Friction(_)
        | Magnitude::External(_) => claimed,
    }
}

/// The row of a joint's reaction.
pub(crate) fn reaction_row(
    mechanism: &Mechanism,
    joint: JointId,
    component: Component,
) -> Option<usize> {
    let wanted = Reaction { joint, component };
    mechanism.reactions().iter().position(|r| *r == wanted)
}

/// The forces on two bodies whose teeth push each other apart: of gears along the line of centres, away from where the
/// pitch circles touch; of a rack along the perpendicular from its pitch line to the pinion's centre.
fn separating_wrenches(mesh: Mesh, force: f64, motion: &BodyMotion<'_>) -> Option<Vec<BodyWrench>> {
    let [first_center, center] = motion.points(mesh.bodies, mesh.points)?;
    let gap = center - first_center;
    let (at, away) = match mesh.pitch {
        PitchLines::Circles { radii, internal } => {
            let line = gap * (1.0 / gap.norm());
            // Seen from the first gear, the circles touch beyond the second only if the second is in its ring.
            let in_ring = internal && radii[0] < radii[1];
            let touch = if in_ring { -radii[0] } else { radii[0] };
            let away = if internal { -line } else { line };
            (first_center + line * touch, away)
        }
        PitchLines::Line { axis, .. } => {
            let t = motion.direction(mesh.bodies[0], axis)?;
            let from_line = gap - t * t.dot(gap);
            (center - from_line, from_line * (1.0 / from_line.norm()))
        }
    };
    Some(pair(mesh.bodies, away * force, at, 0.0))
}

/// A force along a guide: it acts on both bodies at the second's point.
fn guide_wrenches(guide: Guide, force: f64, motion: &BodyMotion<'_>) -> Option<Vec<BodyWrench>> {
    let on_second = motion.direction(guide.bodies[0], guide.axis)? * force;
    let at = motion.point(guide.bodies[1], guide.points[1])?;
    Some(pair(guide.bodies, on_second, at, 0.0))
}

/// A force at a point and a couple on the second body, and their opposites on the first.
fn pair(bodies: [BodyId; 2], force: Vec2, point: Vec2, couple: f64) -> Vec<BodyWrench> {
    let signed = [-1.0, 1.0].into_iter().zip(bodies);
    signed
        .map(|(sign, body)| BodyWrench::in_plane(body, force * sign, point, couple * sign))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::{Pose, Twist, lifted};
    use crate::wrenches::NetWrench;
    use dwell_geometry::space::{Vec3, Wrench};
    use dwell_geometry::vec2;

    const BODIES: [[f64; 3]; 3] = [[0.0; 3], [1.0, 2.0, 0.5], [-0.5, 0.3, 4.0]];
    const VELOCITIES: [[f64; 3]; 3] = [[0.0; 3], [0.4, -0.7, 1.1], [0.2, 0.9, -0.6]];
    const ON: [BodyId; 2] = [BodyId(1), BodyId(2)];
    const POINTS: [Vec2; 2] = [vec2(0.3, -0.2), vec2(0.1, 0.6)];

    fn wrenches(kind: LoadKind, bodies: &[[f64; 3]]) -> Vec<BodyWrench> {
        let mass = Mass {
            mass: 2.0,
            center: vec2(0.2, 0.1),
            inertia: 0.3,
        };
        load_wrenches(&kind, 3.0, 0, &[mass; 3], bodies, &VELOCITIES).unwrap()
    }

    /// Power of the acts with the speeds.
    fn power(wrenches: &[BodyWrench]) -> f64 {
        let of = |wrench: &BodyWrench| {
            let origin = Pose::from(BODIES[wrench.body.0]).position;
            Twist::from(VELOCITIES[wrench.body.0]).power(&wrench.about(origin))
        };
        wrenches.iter().map(of).sum()
    }

    /// −dV/dt of a potential, by a fourth-order difference along the speeds.
    fn fall(potential: impl Fn(&[[f64; 3]]) -> f64) -> f64 {
        let at = |t: f64| {
            let mut bodies = BODIES;
            for (body, speed) in bodies.iter_mut().zip(VELOCITIES) {
                for (x, v) in body.iter_mut().zip(speed) {
                    *x += v * t;
                }
            }
            potential(&bodies)
        };
        let h = 1e-3;
        (8.0 * (at(-h) - at(h)) - (at(-2.0 * h) - at(2.0 * h))) / (12.0 * h)
    }

    fn close(a: f64, b: f64) {
        // Rounding of a potential of order ten over h, and h⁴ times a fifth derivative.
        assert!((a - b).abs() < 3e-11, "{a} {b}");
    }

    #[test]
    fn conservative_loads_do_the_work_of_their_potential() {
        let at = |bodies: &[[f64; 3]], b: usize, p: Vec2| {
            vec2(bodies[b][0], bodies[b][1]) + p.rotate(Vec2::from_angle(bodies[b][2]))
        };
        let down = Vec2::from_angle(-1.4);
        let weight = wrenches(LoadKind::Gravity { direction: down }, &BODIES);
        close(
            power(&weight),
            fall(|x| {
                let center = vec2(0.2, 0.1);
                -6.0 * (down.dot(at(x, 1, center)) + down.dot(at(x, 2, center)))
            }),
        );
        for free in [0.0, 0.7] {
            let spring = LoadKind::Spring {
                bodies: ON,
                points: POINTS,
                free_length: free,
            };
            close(
                power(&wrenches(spring, &BODIES)),
                fall(|x| {
                    let l = (at(x, 2, POINTS[1]) - at(x, 1, POINTS[0])).norm();
                    1.5 * (l - free) * (l - free)
                }),
            );
        }
        let spring = LoadKind::TorsionSpring {
            bodies: ON,
            free_angle: 0.4,
        };
        close(
            power(&wrenches(spring, &BODIES)),
            fall(|x| 1.5 * (x[2][2] - x[1][2] - 0.4).powi(2)),
        );
        let force = LoadKind::Force {
            body: BodyId(2),
            point: POINTS[1],
            direction: down,
            body_fixed: false,
        };
        close(
            power(&wrenches(force, &BODIES)),
            fall(|x| -3.0 * down.dot(at(x, 2, POINTS[1]))),
        );
    }

    #[test]
    fn dampers_take_power_and_followers_turn() {
        let rate = -fall(|x| {
            let at =
                |b: usize, p: Vec2| vec2(x[b][0], x[b][1]) + p.rotate(Vec2::from_angle(x[b][2]));
            -(at(2, POINTS[1]) - at(1, POINTS[0])).norm()
        });
        let damper = LoadKind::Damper {
            bodies: ON,
            points: POINTS,
        };
        close(power(&wrenches(damper, &BODIES)), -3.0 * rate * rate);
        let damper = LoadKind::RotationalDamper { bodies: ON };
        close(power(&wrenches(damper, &BODIES)), -3.0 * 1.7 * 1.7);
        let torque = LoadKind::Torque { bodies: ON };
        close(power(&wrenches(torque, &BODIES)), 3.0 * -1.7);
        let force = LoadKind::Force {
            body: BodyId(1),
            point: POINTS[0],
            direction: vec2(0.0, 1.0),
            body_fixed: true,
        };
        let got = wrenches(force, &BODIES)[0].force;
        let want = lifted(Vec2::from_angle(0.5).perp() * 3.0);
        assert!((got - want).norm() < 1e-15);
    }

    fn mesh(pitch: PitchLines) -> LoadKind {
        LoadKind::SeparatingForce(Mesh {
            bodies: ON,
            points: POINTS,
            pitch,
        })
    }

    /// What acts between two bodies is nothing on the whole.
    #[test]
    fn inner_loads_balance() {
        for kind in [
            LoadKind::Spring {
                bodies: ON,
                points: POINTS,
                free_length: 0.7,
            },
            LoadKind::Damper {
                bodies: ON,
                points: POINTS,
            },
            LoadKind::Torque { bodies: ON },
            mesh(PitchLines::Circles {
                radii: [0.4, 0.9],
                internal: true,
            }),
            mesh(PitchLines::Line {
                axis: vec2(0.6, 0.8),
                radius: 0.3,
            }),
        ] {
            let wrenches = wrenches(kind, &BODIES);
            let Wrench { force, moment } = NetWrench::of(wrenches.iter(), Vec3::ZERO).sum;
            assert!(force.norm() < 1e-14 && moment.norm() < 1e-14, "{kind:?}");
        }
        let far = LoadKind::Torque {
            bodies: [BodyId(0), BodyId(3)],
        };
        assert!(load_wrenches(&far, 1.0, 0, &[], &BODIES, &VELOCITIES).is_none());
    }
}
