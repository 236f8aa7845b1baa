//! A mechanism as it stands in the plane, and its description in frames, an order and names of
//! one's choice. It closes by construction: every joint is where its two bodies already are.

use crate::changes::Rng;
use dwell_geometry::{
    Actuator, Body, BodyId, Drive, Joint, JointId, JointKind, Mechanism, Start, Vec2, vec2,
};
use dwell_kinetostatics::Mass;

/// Bodies, joints and drives, all in the axes of the plane.
#[derive(Debug, Clone, Default)]
pub(super) struct Standing {
    /// The masses, with their centres in the plane; the first body is the ground.
    pub(super) bodies: Vec<Mass>,
    pub(super) joints: Vec<Held>,
    pub(super) drives: Vec<Driven>,
}

/// A joint where it stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    pub(super) bodies: [usize; 2],
    /// In the plane, on each body.
    pub(super) points: [Vec2; 2],
    pub(super) kind: Kind,
}

/// The kinds of joint, with their axes in the plane.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    Pin,
    Slide(Vec2),
    Slot(Vec2),
    Weld,
    Gear { radii: [f64; 2], internal: bool },
    Roll { axis: Vec2, radius: f64 },
    Link,
}

/// What an actuator drives.
#[derive(Debug, Clone, Copy)]
pub(super) enum Driven {
    Angle([usize; 2]),
    /// The travel of this joint.
    Travel(usize),
    Length([usize; 2], [Vec2; 2]),
}

/// Free choices in a description.
#[derive(Debug, Clone)]
pub(super) struct View {
    /// By body: where its frame is in the plane.
    frames: Vec<[f64; 3]>,
    /// The whole mechanism is turned by this angle, then moved.
    turn: f64,
    shift: Vec2,
    /// By joint and by drive: whether its bodies are named the other way round.
    swapped: Vec<bool>,
    turned_round: Vec<bool>,
    /// By body and by joint: its place in the description.
    bodies: Vec<usize>,
    pub(super) joints: Vec<usize>,
    names: u64,
}

impl View {
    /// Some view.
    pub(super) fn of(standing: &Standing, seed: u64) -> Self {
        let mut rng = Rng(seed);
        let (bodies, joints) = (standing.bodies.len(), standing.joints.len());
        let mut coins =
            |n: usize| -> Vec<bool> { (0..n).map(|_| rng.between(0.0, 1.0) < 0.5).collect() };
        let (swapped, turned_round) = (coins(joints), coins(standing.drives.len()));
        let frame = |mass: &Mass| {
            let [x, y] = [mass.center.x, mass.center.y].map(|c| c + rng.between(-1.0, 1.0));
            [x, y, rng.between(-3.0, 3.0)]
        };
        let frames = standing.bodies.iter().map(frame).collect();
        Self {
            frames,
            turn: rng.between(-3.0, 3.0),
            shift: vec2(rng.between(-2.0, 2.0), rng.between(-2.0, 2.0)),
            swapped,
            turned_round,
            bodies: rng.order(bodies),
            joints: rng.order(joints),
            names: seed,
        }
    }

    /// −1 where the sense of a drive's coordinate and of its action is the other one.
    pub(super) fn sense(&self, standing: &Standing, drive: usize) -> f64 {
        let round = match standing.drives[drive] {
            Driven::Angle(_) => self.turned_round[drive],
            Driven::Travel(joint) => self.swaps(standing, joint),
            Driven::Length(..) => false,
        };
        if round { -1.0 } else { 1.0 }
    }

    /// Whether a joint's bodies are named the other way round; a slot's and a track's cannot be.
    fn swaps(&self, standing: &Standing, joint: usize) -> bool {
        let one_way = matches!(
            standing.joints[joint].kind,
            Kind::Slot(_) | Kind::Roll { .. }
        );
        self.swapped[joint] && !one_way
    }

    /// A joint's reaction in the plane's own axes and in the original order of its bodies.
    /// `travel` is that of the description.
    pub(super) fn reaction(
        &self,
        standing: &Standing,
        joint: usize,
        reaction: &[f64],
        travel: f64,
    ) -> Vec<f64> {
        let mut all = reaction.to_vec();
        let kind = standing.joints[joint].kind;
        if self.swaps(standing, joint) {
            match kind {
                // The force on the other body, and its couple about the other body's point.
                Kind::Slide(_) => {
                    all[1] = -all[1] - travel * all[0];
                    all[0] = -all[0];
                }
                Kind::Gear { internal: true, .. } => all[0] = -all[0],
                Kind::Pin | Kind::Weld => all.iter_mut().for_each(|v| *v = -*v),
                // A push apart stays one, and two outer gears turn each other alike.
                _ => {}
            }
        }
        if matches!(kind, Kind::Pin | Kind::Weld) {
            let force = vec2(all[0], all[1]).turn_back(Vec2::from_angle(self.turn));
            (all[0], all[1]) = (force.x, force.y);
        }
        all
    }
}

/// A description, and where its bodies are.
#[derive(Debug, Clone)]
pub(super) struct Described {
    pub(super) mechanism: Mechanism,
    pub(super) masses: Vec<Mass>,
    pub(super) start: Start,
    /// By body of the description: its frame at the start.
    pub(super) frames: Vec<[f64; 3]>,
    /// What was straight down in the plane.
    pub(super) down: Vec2,
}

/// Rough angles are this wrong, rad: two ways to assemble are now and then not farther apart than
/// a hundredth.
const ROUGH: f64 = 0.002;

impl Standing {
    /// The mechanism as it is described in a view.
    pub(super) fn described(&self, view: &View) -> Described {
        let whole = Vec2::from_angle(view.turn);
        let moved = |p: Vec2| p.turn(whole) + view.shift;
        let frame = |b: usize| {
            let [x, y, angle] = view.frames[b];
            let at = moved(vec2(x, y));
            if b == 0 {
                [0.0; 3]
            } else {
                [at.x, at.y, angle]
            }
        };
        let axis_in =
            |b: usize, axis: Vec2| axis.turn(whole).turn_back(Vec2::from_angle(frame(b)[2]));
        let point_in = |b: usize, point: Vec2| {
            let [x, y, angle] = frame(b);
            (moved(point) - vec2(x, y)).turn_back(Vec2::from_angle(angle))
        };
        let ids = |bodies: [usize; 2]| bodies.map(|b| BodyId(view.bodies[b]));

        let mut joints = vec![None; self.joints.len()];
        for (j, held) in self.joints.iter().enumerate() {
            let Held {
                mut bodies,
                mut points,
                mut kind,
            } = *held;
            if view.swaps(self, j) {
                bodies.reverse();
                points.reverse();
                if let Kind::Gear { radii, .. } = &mut kind {
                    radii.reverse();
                }
            }
            let [one, two] = bodies;
            let between = frame(two)[2] - frame(one)[2];
            if let Kind::Roll { axis, radius } = kind {
                // The track's point is where no turn of the disc would have begun.
                points[0] = points[1] - axis.perp() * radius + axis * (radius * between);
            }
            let kind = match kind {
                Kind::Pin => JointKind::Revolute,
                Kind::Slide(axis) => JointKind::Prismatic {
                    axes: bodies.map(|b| axis_in(b, axis)),
                },
                Kind::Slot(axis) => JointKind::Slot {
                    axis: axis_in(one, axis),
                },
                Kind::Weld => JointKind::Weld { angle: between },
                Kind::Gear { radii, internal } => JointKind::Gear { radii, internal },
                Kind::Roll { axis, radius } => JointKind::Rolling {
                    axis: axis_in(one, axis),
                    radius,
                },
                Kind::Link => JointKind::Distance {
                    length: (points[1] - points[0]).norm(),
                },
            };
            joints[view.joints[j]] = Some(Joint {
                name: format!(
                    "j{:x}",
                    (view.names ^ 0x5a5a).wrapping_mul(j as u64 * 2 + 1)
                ),
                bodies: ids(bodies),
                points: [point_in(one, points[0]), point_in(two, points[1])],
                kind,
            });
        }
        let (actuators, q) = self.actuators(view, &ids, &frame, &point_in);

        let n = self.bodies.len();
        let mut described = Described {
            mechanism: Mechanism {
                bodies: vec![
                    Body {
                        name: String::new()
                    };
                    n
                ],
                ground: view.bodies[0],
                joints: joints.into_iter().flatten().collect(),
                actuators,
                relations: Vec::new(),
            },
            masses: vec![Mass::default(); n],
            start: Start {
                q,
                rough: vec![None; n],
                ..Start::default()
            },
            frames: vec![[0.0; 3]; n],
            down: vec2(0.0, -1.0).turn(whole),
        };
        // Gears mesh as the rough angles have them, which are then no rough ones.
        let geared = |held: &Held| matches!(held.kind, Kind::Gear { .. });
        let rough = if self.joints.iter().any(geared) {
            0.0
        } else {
            ROUGH
        };
        let mut rng = Rng(view.names);
        for (b, mass) in self.bodies.iter().enumerate() {
            let to = view.bodies[b];
            described.mechanism.bodies[to].name = format!(
                "b{:x}",
                (view.names ^ 0xa5a5).wrapping_mul(b as u64 * 2 + 1)
            );
            described.masses[to] = Mass {
                center: point_in(b, mass.center),
                ..*mass
            };
            described.frames[to] = frame(b);
            described.start.rough[to] =
                (b > 0).then(|| frame(b)[2] + rough * rng.between(-1.0, 1.0));
        }
        described
    }

    fn actuators(
        &self,
        view: &View,
        ids: &impl Fn([usize; 2]) -> [BodyId; 2],
        frame: &impl Fn(usize) -> [f64; 3],
        point_in: &impl Fn(usize, Vec2) -> Vec2,
    ) -> (Vec<Actuator>, Vec<f64>) {
        let described = |(i, &driven): (usize, &Driven)| {
            let (bodies, drive, q) = match driven {
                Driven::Angle(mut bodies) => {
                    if view.turned_round[i] {
                        bodies.reverse();
                    }
                    let [one, two] = bodies.map(|b| frame(b)[2]);
                    (bodies, Drive::Angle, two - one)
                }
                Driven::Travel(joint) => {
                    let Held {
                        mut bodies,
                        points,
                        kind,
                    } = self.joints[joint];
                    let (Kind::Slide(axis) | Kind::Slot(axis)) = kind else {
                        panic!("no travel");
                    };
                    if view.swaps(self, joint) {
                        bodies.reverse();
                    }
                    let u = axis.dot(points[1] - points[0]) * view.sense(self, i);
                    (bodies, Drive::Travel(JointId(view.joints[joint])), u)
                }
                Driven::Length(bodies, points) => {
                    let local = [0, 1].map(|k| point_in(bodies[k], points[k]));
                    (bodies, Drive::Length(local), (points[1] - points[0]).norm())
                }
            };
            let actuator = Actuator {
                name: format!("q{i}"),
                bodies: ids(bodies),
                drive,
            };
            (actuator, q)
        };
        self.drives.iter().enumerate().map(described).unzip()
    }
}
