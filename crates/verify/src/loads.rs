//! Loads in the plane as forces at points and couples, from the definitions of [`LoadKind`] and the frames of the
//! bodies: the reference for generalised forces.

use crate::body_motion::BodyMotion;
use crate::placed_load::{Line, LineKind, PlacedLoad};
use crate::pose::lifted;
use crate::wrenches::BodyWrench;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::space::{Vec3, vec3};
use dwell_geometry::{BodyId, Component, JointId, Mechanism, Reaction};
use dwell_kinetostatics::{Direction, Guide, Load, LoadKind, Magnitude, Mass, Mesh, PitchLines};

/// The forces of a load of the given magnitude, with the bodies' frames and their velocities
/// [x, y, θ] in m, rad and per s; a massless body has no weight, the ground's is left out.
/// `None` if it names a body that is not there.
///
/// Coincident points have no line between them: then a spring or damper between them gives
/// forces that are not numbers, unless it is a spring of no free length.
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
    Some(placed(kind, ground, masses, motion)?.wrenches(magnitude))
}

/// A load where the bodies are; none if it names a body that is not there.
pub(crate) fn placed(
    kind: &LoadKind,
    ground: usize,
    masses: &[Mass],
    motion: BodyMotion<'_>,
) -> Option<PlacedLoad> {
    Some(match *kind {
        LoadKind::Gravity { direction } => {
            let all = masses.iter().enumerate();
            let heavy = all.filter(|&(b, mass)| b != ground && mass.mass != 0.0);
            let placed = |(b, mass): (usize, &Mass)| {
                let center = motion.point(BodyId(b), mass.center)?;
                Some((BodyId(b), mass.mass, lifted(center)))
            };
            PlacedLoad::Weight(lifted(direction), heavy.map(placed).collect::<Option<_>>()?)
        }
        LoadKind::Force {
            body,
            point,
            direction,
        } => PlacedLoad::Force {
            body,
            point: lifted(motion.point(body, point)?),
            direction: lifted(match direction {
                Direction::Ground(vector) => vector,
                Direction::Body(vector) => motion.direction(body, vector)?,
            }),
            turns: matches!(direction, Direction::Body(_)),
        },
        LoadKind::Drag { body, point } => PlacedLoad::Drag {
            body,
            point: lifted(motion.point(body, point)?),
            velocity: lifted(motion.point_velocity(body, point)?),
        },
        LoadKind::Along(along, law) => PlacedLoad::Along(line(along, motion)?, law),
        LoadKind::Special(mesh) => PlacedLoad::Given(separating_wrenches(mesh, &motion)?),
    })
}

fn line(along: CoordinateFunction, motion: BodyMotion<'_>) -> Option<Line> {
    let ([value, rate], bodies, points, along, kind) = match along {
        CoordinateFunction::Angle(bodies) => {
            let (axis, kind) = (vec3(0.0, 0.0, 1.0), LineKind::Angle { counts_turns: true });
            (motion.angle(bodies)?, bodies, [Vec3::ZERO; 2], axis, kind)
        }
        // It acts on both bodies at the second's point.
        CoordinateFunction::Travel(Guide {
            bodies,
            points,
            axis,
        }) => {
            let at = lifted(motion.point(bodies[1], points[1])?);
            let along = lifted(motion.direction(bodies[0], axis)?);
            let travel = motion.travel(bodies, points, axis)?;
            (travel, bodies, [at; 2], along, LineKind::Travel)
        }
        CoordinateFunction::Length { bodies, points } => {
            let [from, to] = motion.points(bodies, points)?.map(lifted);
            let along = (to - from).scaled(1.0 / (to - from).norm());
            let length = motion.length(bodies, points)?;
            (length, bodies, [from, to], along, LineKind::Distance)
        }
    };
    Some(Line {
        bodies,
        points,
        along,
        kind,
        value,
        rate,
    })
}

/// The magnitude of a load that depends on claimed reactions (in the order of [`Mechanism::reactions`]), or, for every
/// other load, the claimed magnitude. If the teeth of gears have a pressure angle α, the force between them is inclined
/// by α to the tooth force, so that its other part is tan α times the tooth force.
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

/// The forces of 1 N on two bodies whose teeth push each other apart: of gears along the line of centres, away from where the
/// pitch circles touch; of a rack along the perpendicular from its pitch line to the pinion's centre.
fn separating_wrenches(mesh: Mesh, motion: &BodyMotion<'_>) -> Option<Vec<BodyWrench>> {
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
    let (force, at) = (lifted(away), lifted(at));
    Some(BodyWrench::pair(mesh.bodies, force, at, Vec3::ZERO).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::{Pose, Twist};
    use crate::wrenches::NetWrench;
    use dwell_geometry::space::Wrench;
    use dwell_geometry::{Vec2, vec2};

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
            let spring = LoadKind::spring(ON, POINTS, free);
            close(
                power(&wrenches(spring, &BODIES)),
                fall(|x| {
                    let l = (at(x, 2, POINTS[1]) - at(x, 1, POINTS[0])).norm();
                    1.5 * (l - free) * (l - free)
                }),
            );
        }
        let spring = LoadKind::torsion_spring(ON, 0.4);
        close(
            power(&wrenches(spring, &BODIES)),
            fall(|x| 1.5 * (x[2][2] - x[1][2] - 0.4).powi(2)),
        );
        let force = LoadKind::Force {
            body: BodyId(2),
            point: POINTS[1],
            direction: Direction::Ground(down),
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
        let damper = LoadKind::damper(ON, POINTS);
        close(power(&wrenches(damper, &BODIES)), -3.0 * rate * rate);
        let damper = LoadKind::rotational_damper(ON);
        close(power(&wrenches(damper, &BODIES)), -3.0 * 1.7 * 1.7);
        let torque = LoadKind::couple(ON);
        close(power(&wrenches(torque, &BODIES)), 3.0 * -1.7);
        let force = LoadKind::Force {
            body: BodyId(1),
            point: POINTS[0],
            direction: Direction::Body(vec2(0.0, 1.0)),
        };
        let got = wrenches(force, &BODIES)[0].force;
        let want = lifted(Vec2::from_angle(0.5).perp() * 3.0);
        assert!((got - want).norm() < 1e-15);
    }

    fn mesh(pitch: PitchLines) -> LoadKind {
        LoadKind::Special(Mesh {
            bodies: ON,
            points: POINTS,
            pitch,
        })
    }

    /// Actions between two bodies are zero in sum.
    #[test]
    fn inner_loads_balance() {
        for kind in [
            LoadKind::spring(ON, POINTS, 0.7),
            LoadKind::damper(ON, POINTS),
            LoadKind::couple(ON),
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
        let far = LoadKind::couple([BodyId(0), BodyId(3)]);
        assert!(load_wrenches(&far, 1.0, 0, &[], &BODIES, &VELOCITIES).is_none());
    }
}
