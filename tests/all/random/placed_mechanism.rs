//! A mechanism as it stands in the plane, and its description in frames, an order and names of
//! one's choice. It closes by construction: every joint is where its two bodies already are.

use dwell_geometry::{
    Actuator, ActuatorKind, AssemblyConfiguration, Body, BodyId, Joint, JointId, JointKind,
    Mechanism, Vec2, vec2,
};
use dwell_kinetostatics::Mass;
use dwell_tests::changes::Rng;

/// Bodies, joints and drives, all in the axes of the plane.
#[derive(Debug, Clone, Default)]
pub(super) struct PlacedMechanism {
    /// The masses, with their centres in the plane; the first body is the ground.
    pub(super) bodies: Vec<Mass>,
    pub(super) joints: Vec<PlacedJoint>,
    pub(super) driven: Vec<PlacedActuator>,
}

/// A joint where it stands.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedJoint {
    pub(super) bodies: [usize; 2],
    /// In the plane, on each body.
    pub(super) points: [Vec2; 2],
    pub(super) kind: PlacedJointKind,
}

/// The kinds of joint, with their axes in the plane.
#[derive(Debug, Clone, Copy)]
pub(super) enum PlacedJointKind {
    Revolute,
    Prismatic(Vec2),
    Slot(Vec2),
    Weld,
    Gear { radii: [f64; 2], internal: bool },
    Rolling { axis: Vec2, radius: f64 },
    Distance,
}

/// What an actuator drives.
#[derive(Debug, Clone, Copy)]
pub(super) enum PlacedActuator {
    Angle([usize; 2]),
    /// The travel of this joint.
    Travel(usize),
    Length([usize; 2], [Vec2; 2]),
}

/// Free choices in a description.
#[derive(Debug, Clone)]
pub(super) struct Description {
    /// By body: where its frame is in the plane.
    body_frames: Vec<[f64; 3]>,
    /// The whole mechanism is turned by this angle, then moved.
    rotation: f64,
    shift: Vec2,
    /// By joint and by drive: whether its bodies are named the other way round.
    swapped: Vec<bool>,
    reversed: Vec<bool>,
    /// By body and by joint: its place in the description.
    bodies: Vec<usize>,
    pub(super) joints: Vec<usize>,
    names: u64,
}

impl Description {
    /// Some view.
    pub(super) fn of(placed: &PlacedMechanism, seed: u64) -> Self {
        let mut rng = Rng(seed);
        let (bodies, joints) = (placed.bodies.len(), placed.joints.len());
        let mut coins =
            |n: usize| -> Vec<bool> { (0..n).map(|_| rng.between(0.0, 1.0) < 0.5).collect() };
        let (swapped, reversed) = (coins(joints), coins(placed.driven.len()));
        let body_frame = |mass: &Mass| {
            let [x, y] = [mass.center.x, mass.center.y].map(|c| c + rng.between(-1.0, 1.0));
            [x, y, rng.between(-3.0, 3.0)]
        };
        let body_frames = placed.bodies.iter().map(body_frame).collect();
        Self {
            body_frames,
            rotation: rng.between(-3.0, 3.0),
            shift: vec2(rng.between(-2.0, 2.0), rng.between(-2.0, 2.0)),
            swapped,
            reversed,
            bodies: rng.order(bodies),
            joints: rng.order(joints),
            names: seed,
        }
    }

    /// −1 where the sense of a drive's coordinate and of its action is the other one.
    pub(super) fn coordinate_sign(&self, placed: &PlacedMechanism, drive: usize) -> f64 {
        let is_reversed = match placed.driven[drive] {
            PlacedActuator::Angle(_) => self.reversed[drive],
            PlacedActuator::Travel(joint) => self.is_swapped(placed, joint),
            PlacedActuator::Length(..) => false,
        };
        if is_reversed { -1.0 } else { 1.0 }
    }

    /// Whether a joint's bodies are named the other way round; a slot's and a track's cannot be.
    fn is_swapped(&self, placed: &PlacedMechanism, joint: usize) -> bool {
        let one_way = matches!(
            placed.joints[joint].kind,
            PlacedJointKind::Slot(_) | PlacedJointKind::Rolling { .. }
        );
        self.swapped[joint] && !one_way
    }

    /// A joint's reaction in the plane's own axes and in the original order of its bodies.
    /// `travel` is that of the description.
    pub(super) fn reaction(
        &self,
        placed: &PlacedMechanism,
        joint: usize,
        reaction: &[f64],
        travel: f64,
    ) -> Vec<f64> {
        let mut all = reaction.to_vec();
        let kind = placed.joints[joint].kind;
        if self.is_swapped(placed, joint) {
            match kind {
                // The force on the other body, and its couple about the other body's point.
                PlacedJointKind::Prismatic(_) => {
                    all[1] = -all[1] - travel * all[0];
                    all[0] = -all[0];
                }
                PlacedJointKind::Gear { internal: true, .. } => all[0] = -all[0],
                PlacedJointKind::Revolute | PlacedJointKind::Weld => {
                    all.iter_mut().for_each(|v| *v = -*v);
                }
                // A push apart stays one, and two outer gears turn each other alike.
                _ => {}
            }
        }
        if matches!(kind, PlacedJointKind::Revolute | PlacedJointKind::Weld) {
            let force = vec2(all[0], all[1]).rotate_inverse(Vec2::from_angle(self.rotation));
            (all[0], all[1]) = (force.x, force.y);
        }
        all
    }
}

/// A description, and where its bodies are.
#[derive(Debug, Clone)]
pub(super) struct DescribedMechanism {
    pub(super) mechanism: Mechanism,
    pub(super) masses: Vec<Mass>,
    pub(super) assembly: AssemblyConfiguration,
    /// By body of the description: its frame at the start.
    pub(super) start_poses: Vec<[f64; 3]>,
    /// What was straight down in the plane.
    pub(super) down: Vec2,
}

/// Rough angles are this wrong, rad: two ways to assemble are now and then not farther apart than
/// a hundredth.
const GUESS_ERROR: f64 = 0.002;

impl PlacedMechanism {
    /// The mechanism as it is described in a view.
    // Long: an arm for each kind of part.
    pub(super) fn describe(&self, view: &Description) -> DescribedMechanism {
        let whole = Vec2::from_angle(view.rotation);
        let transformed = |p: Vec2| p.rotate(whole) + view.shift;
        let frame = |b: usize| {
            let [x, y, angle] = view.body_frames[b];
            let at = transformed(vec2(x, y));
            if b == 0 {
                [0.0; 3]
            } else {
                [at.x, at.y, angle]
            }
        };
        let axis_in = |b: usize, axis: Vec2| {
            axis.rotate(whole)
                .rotate_inverse(Vec2::from_angle(frame(b)[2]))
        };
        let point_in = |b: usize, point: Vec2| {
            let [x, y, angle] = frame(b);
            (transformed(point) - vec2(x, y)).rotate_inverse(Vec2::from_angle(angle))
        };
        let ids = |bodies: [usize; 2]| bodies.map(|b| BodyId(view.bodies[b]));

        let mut joints = vec![None; self.joints.len()];
        for (j, joint) in self.joints.iter().enumerate() {
            let PlacedJoint {
                mut bodies,
                mut points,
                mut kind,
            } = *joint;
            if view.is_swapped(self, j) {
                bodies.reverse();
                points.reverse();
                if let PlacedJointKind::Gear { radii, .. } = &mut kind {
                    radii.reverse();
                }
            }
            let [one, two] = bodies;
            let between = frame(two)[2] - frame(one)[2];
            if let PlacedJointKind::Rolling { axis, radius } = kind {
                // The track's point is where no turn of the disc would have begun.
                points[0] = points[1] - axis.perp() * radius + axis * (radius * between);
            }
            let kind = match kind {
                PlacedJointKind::Revolute => JointKind::Revolute,
                PlacedJointKind::Prismatic(axis) => JointKind::Prismatic {
                    axes: bodies.map(|b| axis_in(b, axis)),
                },
                PlacedJointKind::Slot(axis) => JointKind::Slot {
                    axis: axis_in(one, axis),
                },
                PlacedJointKind::Weld => JointKind::Weld { angle: between },
                PlacedJointKind::Gear { radii, internal } => JointKind::Gear { radii, internal },
                PlacedJointKind::Rolling { axis, radius } => JointKind::Rolling {
                    axis: axis_in(one, axis),
                    radius,
                },
                PlacedJointKind::Distance => JointKind::Distance {
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
        let mut described = DescribedMechanism {
            mechanism: Mechanism {
                bodies: vec![Body::named(""); n],
                ground: view.bodies[0],
                joints: joints.into_iter().flatten().collect(),
                actuators,
                couplings: Vec::new(),
            },
            masses: vec![Mass::default(); n],
            assembly: AssemblyConfiguration {
                q,
                initial_guess: vec![None; n],
                ..AssemblyConfiguration::default()
            },
            start_poses: vec![[0.0; 3]; n],
            down: vec2(0.0, -1.0).rotate(whole),
        };
        // Gears mesh as the rough angles have them, which are then no rough ones.
        let geared = |joint: &PlacedJoint| matches!(joint.kind, PlacedJointKind::Gear { .. });
        let guess = if self.joints.iter().any(geared) {
            0.0
        } else {
            GUESS_ERROR
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
            described.start_poses[to] = frame(b);
            described.assembly.initial_guess[to] =
                (b > 0).then(|| frame(b)[2] + guess * rng.between(-1.0, 1.0));
        }
        described
    }

    fn actuators(
        &self,
        view: &Description,
        ids: &impl Fn([usize; 2]) -> [BodyId; 2],
        frame: &impl Fn(usize) -> [f64; 3],
        point_in: &impl Fn(usize, Vec2) -> Vec2,
    ) -> (Vec<Actuator>, Vec<f64>) {
        let described = |(i, &driven): (usize, &PlacedActuator)| {
            let (bodies, drive, q) = match driven {
                PlacedActuator::Angle(mut bodies) => {
                    if view.reversed[i] {
                        bodies.reverse();
                    }
                    let [one, two] = bodies.map(|b| frame(b)[2]);
                    (bodies, ActuatorKind::Angle, two - one)
                }
                PlacedActuator::Travel(joint) => {
                    let PlacedJoint {
                        mut bodies,
                        points,
                        kind,
                    } = self.joints[joint];
                    let (PlacedJointKind::Prismatic(axis) | PlacedJointKind::Slot(axis)) = kind
                    else {
                        panic!("no travel");
                    };
                    if view.is_swapped(self, joint) {
                        bodies.reverse();
                    }
                    let u = axis.dot(points[1] - points[0]) * view.coordinate_sign(self, i);
                    (bodies, ActuatorKind::Travel(JointId(view.joints[joint])), u)
                }
                PlacedActuator::Length(bodies, points) => {
                    let local = [0, 1].map(|k| point_in(bodies[k], points[k]));
                    (
                        bodies,
                        ActuatorKind::Length(local),
                        (points[1] - points[0]).norm(),
                    )
                }
            };
            let actuator = Actuator {
                name: format!("q{i}"),
                bodies: ids(bodies),
                kind: drive,
            };
            (actuator, q)
        };
        self.driven.iter().enumerate().map(described).unzip()
    }
}
