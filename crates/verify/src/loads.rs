//! Loads as forces at points and couples, from the words of [`LoadKind`] and the frames of the
//! bodies: what a producer's generalised forces are held against.

use crate::state::BodyAct;
use dwell_geometry::{BodyId, Vec2, vec2};
use dwell_kinetostatics::{Guide, LoadKind, Mass};

/// Where the bodies are and how they move, in the plane.
struct Frames<'a> {
    bodies: &'a [[f64; 3]],
    velocity: &'a [[f64; 3]],
}

impl Frames<'_> {
    fn turned(&self, body: BodyId) -> Option<Vec2> {
        Some(Vec2::from_angle(self.bodies.get(body.0)?[2]))
    }

    fn angle(&self, body: BodyId) -> Option<f64> {
        Some(self.bodies.get(body.0)?[2])
    }

    fn omega(&self, body: BodyId) -> Option<f64> {
        Some(self.velocity.get(body.0)?[2])
    }

    fn point(&self, body: BodyId, point: Vec2) -> Option<Vec2> {
        let [x, y, _] = *self.bodies.get(body.0)?;
        Some(vec2(x, y) + point.turn(self.turned(body)?))
    }

    fn speed(&self, body: BodyId, point: Vec2) -> Option<Vec2> {
        let [x, y, omega] = *self.velocity.get(body.0)?;
        Some(vec2(x, y) + point.turn(self.turned(body)?).perp() * omega)
    }
}

/// What a load of the given magnitude does, with the bodies' frames and their velocities
/// [x, y, θ] in m, rad and per s; a massless body feels no weight, the ground's is left out.
/// `None` if it names a body that is not there.
///
/// Two points in one place have no line between them: then a spring or damper between them gives
/// forces that are not numbers, unless it is a spring of no free length.
pub fn load_acts(
    kind: &LoadKind,
    magnitude: f64,
    ground: usize,
    masses: &[Mass],
    bodies: &[[f64; 3]],
    velocity: &[[f64; 3]],
) -> Option<Vec<BodyAct>> {
    let frames = Frames { bodies, velocity };
    let couple = |[first, second]: [BodyId; 2], couple: f64| {
        let there = first.0.max(second.0) < bodies.len();
        let acts = [(first, -couple), (second, couple)].map(|(body, couple)| BodyAct {
            body,
            force: Vec2::ZERO,
            at: Vec2::ZERO,
            couple,
        });
        there.then(|| acts.into())
    };
    // Both bodies at their own points: the force is along the line between these.
    let pull = |bodies: [BodyId; 2], points: [Vec2; 2], on_second: Vec2| {
        let of = |i: usize, force: Vec2| {
            Some(BodyAct {
                body: bodies[i],
                force,
                at: frames.point(bodies[i], points[i])?,
                couple: 0.0,
            })
        };
        Some(vec![of(0, -on_second)?, of(1, on_second)?])
    };
    let gap = |bodies: [BodyId; 2], points: [Vec2; 2]| {
        Some(frames.point(bodies[1], points[1])? - frames.point(bodies[0], points[0])?)
    };
    match *kind {
        LoadKind::Gravity { direction } => {
            let heavy = masses.iter().enumerate();
            heavy
                .filter(|&(b, mass)| b != ground && mass.mass != 0.0)
                .map(|(b, mass)| {
                    Some(BodyAct {
                        body: BodyId(b),
                        force: direction * (mass.mass * magnitude),
                        at: frames.point(BodyId(b), mass.center)?,
                        couple: 0.0,
                    })
                })
                .collect()
        }
        LoadKind::Force {
            body,
            point,
            direction,
            follows,
        } => {
            let turned = frames.turned(body)?;
            let direction = if follows {
                direction.turn(turned)
            } else {
                direction
            };
            Some(vec![BodyAct {
                body,
                force: direction * magnitude,
                at: frames.point(body, point)?,
                couple: 0.0,
            }])
        }
        LoadKind::Torque { bodies } => couple(bodies, magnitude),
        LoadKind::Spring {
            bodies,
            points,
            free,
        } => {
            let d = gap(bodies, points)?;
            let stretch = if free == 0.0 {
                1.0
            } else {
                1.0 - free / d.norm()
            };
            pull(bodies, points, d * (-magnitude * stretch))
        }
        LoadKind::TorsionSpring { bodies, free } => {
            let angle = frames.angle(bodies[1])? - frames.angle(bodies[0])?;
            couple(bodies, -magnitude * (angle - free))
        }
        LoadKind::Damper { bodies, points } => {
            let d = gap(bodies, points)?;
            let line = d * (1.0 / d.norm());
            let apart = frames.speed(bodies[1], points[1])? - frames.speed(bodies[0], points[0])?;
            pull(bodies, points, line * (-magnitude * apart.dot(line)))
        }
        LoadKind::TorsionDamper { bodies } => {
            let rate = frames.omega(bodies[1])? - frames.omega(bodies[0])?;
            couple(bodies, -magnitude * rate)
        }
        LoadKind::Push { bodies, points } => {
            let d = gap(bodies, points)?;
            pull(bodies, points, d * (magnitude / d.norm()))
        }
        LoadKind::Slide(guide) => along(guide, magnitude, &frames),
        LoadKind::SlideDamper(guide) => {
            let [first, _] = guide.bodies;
            let [p1, p2] = [0, 1].map(|i| frames.point(guide.bodies[i], guide.points[i]));
            let [v1, v2] = [0, 1].map(|i| frames.speed(guide.bodies[i], guide.points[i]));
            let axis = guide.axis.turn(frames.turned(first)?);
            // d/dt of t·(P₂ − P₁), where the axis turns with its body.
            let turning = axis.perp() * frames.omega(first)?;
            let rate = axis.dot(v2? - v1?) + turning.dot(p2? - p1?);
            along(guide, -magnitude * rate, &frames)
        }
    }
}

/// A force along a guide: both bodies feel it at the second's point.
fn along(guide: Guide, force: f64, frames: &Frames<'_>) -> Option<Vec<BodyAct>> {
    let [first, second] = guide.bodies;
    let on_second = guide.axis.turn(frames.turned(first)?) * force;
    let at = frames.point(second, guide.points[1])?;
    let act = |body, force| BodyAct {
        body,
        force,
        at,
        couple: 0.0,
    };
    Some(vec![act(first, -on_second), act(second, on_second)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODIES: [[f64; 3]; 3] = [[0.0; 3], [1.0, 2.0, 0.5], [-0.5, 0.3, 4.0]];
    const SPEEDS: [[f64; 3]; 3] = [[0.0; 3], [0.4, -0.7, 1.1], [0.2, 0.9, -0.6]];
    const ON: [BodyId; 2] = [BodyId(1), BodyId(2)];
    const POINTS: [Vec2; 2] = [vec2(0.3, -0.2), vec2(0.1, 0.6)];

    fn acts(kind: LoadKind, bodies: &[[f64; 3]]) -> Vec<BodyAct> {
        let mass = Mass {
            mass: 2.0,
            center: vec2(0.2, 0.1),
            inertia: 0.3,
        };
        load_acts(&kind, 3.0, 0, &[mass; 3], bodies, &SPEEDS).unwrap()
    }

    /// Power of the acts with the speeds.
    fn power(acts: &[BodyAct]) -> f64 {
        let of = |act: &BodyAct| {
            let [x, y, _] = BODIES[act.body.0];
            let [vx, vy, omega] = SPEEDS[act.body.0];
            let v = vec2(vx, vy) + (act.at - vec2(x, y)).perp() * omega;
            act.force.dot(v) + act.couple * omega
        };
        acts.iter().map(of).sum()
    }

    /// −dV/dt of a potential, by a fourth-order difference along the speeds.
    fn fall(potential: impl Fn(&[[f64; 3]]) -> f64) -> f64 {
        let at = |t: f64| {
            let mut bodies = BODIES;
            for (body, speed) in bodies.iter_mut().zip(SPEEDS) {
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
            vec2(bodies[b][0], bodies[b][1]) + p.turn(Vec2::from_angle(bodies[b][2]))
        };
        let down = Vec2::from_angle(-1.4);
        let weight = acts(LoadKind::Gravity { direction: down }, &BODIES);
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
                free,
            };
            close(
                power(&acts(spring, &BODIES)),
                fall(|x| {
                    let l = (at(x, 2, POINTS[1]) - at(x, 1, POINTS[0])).norm();
                    1.5 * (l - free) * (l - free)
                }),
            );
        }
        let spring = LoadKind::TorsionSpring {
            bodies: ON,
            free: 0.4,
        };
        close(
            power(&acts(spring, &BODIES)),
            fall(|x| 1.5 * (x[2][2] - x[1][2] - 0.4).powi(2)),
        );
        let force = LoadKind::Force {
            body: BodyId(2),
            point: POINTS[1],
            direction: down,
            follows: false,
        };
        close(
            power(&acts(force, &BODIES)),
            fall(|x| -3.0 * down.dot(at(x, 2, POINTS[1]))),
        );
    }

    #[test]
    fn dampers_take_power_and_followers_turn() {
        let rate = -fall(|x| {
            let at = |b: usize, p: Vec2| vec2(x[b][0], x[b][1]) + p.turn(Vec2::from_angle(x[b][2]));
            -(at(2, POINTS[1]) - at(1, POINTS[0])).norm()
        });
        let damper = LoadKind::Damper {
            bodies: ON,
            points: POINTS,
        };
        close(power(&acts(damper, &BODIES)), -3.0 * rate * rate);
        let damper = LoadKind::TorsionDamper { bodies: ON };
        close(power(&acts(damper, &BODIES)), -3.0 * 1.7 * 1.7);
        let torque = LoadKind::Torque { bodies: ON };
        close(power(&acts(torque, &BODIES)), 3.0 * -1.7);
        let force = LoadKind::Force {
            body: BodyId(1),
            point: POINTS[0],
            direction: vec2(0.0, 1.0),
            follows: true,
        };
        let got = acts(force, &BODIES)[0].force;
        let want = Vec2::from_angle(0.5).perp() * 3.0;
        assert!((got - want).norm() < 1e-15);
    }

    /// What acts between two bodies is nothing on the whole.
    #[test]
    fn inner_loads_balance() {
        for kind in [
            LoadKind::Spring {
                bodies: ON,
                points: POINTS,
                free: 0.7,
            },
            LoadKind::Damper {
                bodies: ON,
                points: POINTS,
            },
            LoadKind::Torque { bodies: ON },
        ] {
            let acts = acts(kind, &BODIES);
            let force = acts.iter().fold(Vec2::ZERO, |sum, a| sum + a.force);
            let moment: f64 = acts.iter().map(|a| a.at.cross(a.force) + a.couple).sum();
            assert!(force.norm() < 1e-14 && moment.abs() < 1e-14, "{kind:?}");
        }
        let far = LoadKind::Torque {
            bodies: [BodyId(0), BodyId(3)],
        };
        assert!(load_acts(&far, 1.0, 0, &[], &BODIES, &SPEEDS).is_none());
    }
}
