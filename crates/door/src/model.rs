//! A mechanism between a file and a scene: every reader makes one, and the writer of scenes reads it. All is given in the frame of the
//! ground, as drawn.

use crate::finding::Place;
use crate::pose::{Matrix, Pose, Vector, add, dot, scaled, sub};

/// The index of the ground among the bodies.
pub(crate) const GROUND: usize = 0;

#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) place: Place,
    /// Its frame in the file.
    pub(crate) pose: Pose,
    pub(crate) mass: f64,
    pub(crate) center: Vector,
    /// About the centre of mass.
    pub(crate) inertia: Matrix,
    pub(crate) points: Vec<(String, Vector)>,
}

impl Body {
    /// Adds a part: its mass and its tensor, with the frame at its centre of mass.
    pub(crate) fn add_mass(&mut self, mass: f64, frame: Pose, tensor: Matrix) {
        self.inertia = self.inertia.plus(tensor.turned(frame.turn));
        if mass == 0.0 {
            return;
        }
        // The tensor of two masses about their common centre.
        let apart = sub(frame.origin, self.center);
        let total = self.mass + mass;
        let isotropic = Matrix::IDENTITY.scaled(dot(apart, apart));
        let across = isotropic.plus(Matrix::outer(apart, apart).scaled(-1.0));
        self.inertia = self.inertia.plus(across.scaled(self.mass * mass / total));
        self.center = add(self.center, scaled(apart, mass / total));
        self.mass = total;
    }

    /// Moves the body from the drawn pose.
    pub(crate) fn move_by(&mut self, motion: Pose) {
        self.pose = motion.then(self.pose);
        self.center = motion.point(self.center);
        self.inertia = self.inertia.turned(motion.turn);
        for (_, point) in &mut self.points {
            *point = motion.point(*point);
        }
    }
}

/// A kind of joint. Axes are those of its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    Fixed,
    Hinge,
    Slide,
    Cylinder,
    /// With the travel along the axis for one revolution.
    Screw(f64),
    /// A Hooke joint; each end has its own axis of the cross.
    Universal,
    Ball,
    /// The second point stays in the plane across the axis, the axes stay parallel.
    Planar,
    /// With the distance of the points.
    Distance(f64),
}

/// A frame of a body. As a side of a joint its origin is the joint's point, and its z the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    pub(crate) body: usize,
    pub(crate) frame: Pose,
}

impl End {
    pub(crate) fn new(body: usize, frame: Pose) -> Self {
        Self { body, frame }
    }
}

/// The same frame of two bodies.
pub(crate) fn both(bodies: [usize; 2], frame: Pose) -> [End; 2] {
    bodies.map(|body| End::new(body, frame))
}

/// What acts along the coordinate of a joint, and its limits, in the file's own coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Along {
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) stiffness: f64,
    pub(crate) spring_reference: f64,
    pub(crate) armature: f64,
    /// Of a one-sided limit the other number is infinite.
    pub(crate) limits: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) name: String,
    /// The name of its coordinate in the scene.
    pub(crate) coordinate: String,
    pub(crate) place: Place,
    pub(crate) kind: Kind,
    pub(crate) ends: [End; 2],
    /// Whether the second body hangs on the first; other joints close loops.
    pub(crate) in_tree: bool,
    /// The file's coordinate as drawn.
    pub(crate) drawn: f64,
    pub(crate) along: Along,
}

impl Joint {
    /// A joint that is not in the tree, drawn where its coordinate is zero.
    pub(crate) fn new(name: impl Into<String>, place: Place, kind: Kind, ends: [End; 2]) -> Self {
        Self {
            name: name.into(),
            coordinate: String::new(),
            place,
            kind,
            ends,
            in_tree: false,
            drawn: 0.0,
            along: Along::default(),
        }
    }

    pub(crate) fn axis(&self) -> Vector {
        self.ends[1].frame.turn.column(2)
    }

    pub(crate) fn origin(&self) -> Vector {
        self.ends[1].frame.origin
    }

    pub(crate) fn bodies(&self) -> [usize; 2] {
        self.ends.map(|end| end.body)
    }

    /// Whether it has one coordinate.
    pub(crate) fn is_driveable(&self) -> bool {
        use Kind::{Cylinder, Hinge, Screw, Slide};
        matches!(self.kind, Hinge | Slide | Cylinder | Screw(_))
    }

    /// Whether this coordinate is an angle.
    pub(crate) fn is_angle(&self) -> bool {
        self.kind != Kind::Slide
    }
}

/// q₁ − a = Σ cᵢ (q₂ − b)ⁱ of the coordinates of two joints: a pair of moments, or of forces along the slides.
#[derive(Debug, Clone)]
pub(crate) struct Coupling {
    pub(crate) name: String,
    pub(crate) place: Place,
    pub(crate) dependent: usize,
    pub(crate) independent: usize,
    /// a and b.
    pub(crate) references: [f64; 2],
    pub(crate) polynomial: Vec<f64>,
}

impl Coupling {
    /// The dependent coordinate with its slope.
    pub(crate) fn at(&self, independent: f64) -> [f64; 2] {
        let x = independent - self.references[1];
        let step = |[value, slope]: [f64; 2], c: &f64| [value * x + c, slope * x + value];
        let [value, slope] = self.polynomial.iter().rev().fold([0.0; 2], step);
        [value + self.references[0], slope]
    }
}

/// A load with places of its own: each with its body.
#[derive(Debug, Clone)]
pub(crate) struct Load {
    pub(crate) name: String,
    pub(crate) at: Vec<(usize, Vector)>,
    pub(crate) action: Action,
}

#[derive(Debug, Clone)]
pub(crate) enum Action {
    /// A spring with a damper between two places.
    Spring {
        stiffness: f64,
        damping: f64,
        free_length: f64,
    },
    /// A force at a place; its direction stays, or turns with the body.
    Force { force: Vector, turns: bool },
}

/// A joint that drives.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) joint: usize,
    /// The file's coordinate as an expression in t, and its duration.
    pub(crate) law: Option<(String, f64)>,
    /// Gains kp and kv of a servo that holds the file's coordinate at zero.
    pub(crate) servo: Option<[f64; 2]>,
}

/// A move to a value of the file's coordinate, or a turn of the second body in that body's axes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Move {
    To(f64),
    Turn(Matrix),
}

#[derive(Debug, Clone)]
pub(crate) struct Model {
    pub(crate) title: String,
    pub(crate) gravity: Vector,
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) couplings: Vec<Coupling>,
    pub(crate) loads: Vec<Load>,
    pub(crate) drives: Vec<Drive>,
    /// Named frames, besides those of bodies, which `--close` may name.
    pub(crate) frames: Vec<(String, End)>,
    /// How joints are moved before they are drawn.
    pub(crate) moves: Vec<(usize, Move)>,
    /// The file's words for friction and limits of a joint.
    pub(crate) terms: [&'static str; 2],
}

impl Model {
    pub(crate) fn new(title: &str, file: Place) -> Self {
        let mut model = Self {
            title: title.to_owned(),
            gravity: [0.0, 0.0, -9.81],
            bodies: Vec::new(),
            joints: Vec::new(),
            couplings: Vec::new(),
            loads: Vec::new(),
            drives: Vec::new(),
            frames: Vec::new(),
            moves: Vec::new(),
            terms: ["friction", "limit"],
        };
        model.push_body("ground", file, Pose::IDENTITY);
        model
    }

    /// A new body without mass, and its number.
    pub(crate) fn push_body(&mut self, name: &str, place: Place, pose: Pose) -> usize {
        self.bodies.push(Body {
            name: name.to_owned(),
            place,
            pose,
            mass: 0.0,
            center: [0.0; 3],
            inertia: Matrix::ZERO,
            points: Vec::new(),
        });
        self.bodies.len() - 1
    }

    /// A force against a share of the weight of a body.
    pub(crate) fn lighten(&mut self, body: usize, share: f64) {
        let Body {
            name, mass, center, ..
        } = &self.bodies[body];
        let force = scaled(self.gravity, -share * mass);
        self.loads.push(Load {
            name: format!("no_weight_{name}"),
            at: vec![(body, *center)],
            action: Action::Force {
                force,
                turns: false,
            },
        });
    }

    /// Fixes a body to the ground where it is.
    pub(crate) fn hold(&mut self, body: usize) {
        let Body {
            name, place, pose, ..
        } = &self.bodies[body];
        let ends = both([GROUND, body], *pose);
        let name = format!("{name}_ground");
        self.push_tree_joint(Joint::new(name, place.clone(), Kind::Fixed, ends));
    }

    /// A joint of the tree, and its number.
    pub(crate) fn push_tree_joint(&mut self, joint: Joint) -> usize {
        let in_tree = true;
        self.joints.push(Joint { in_tree, ..joint });
        self.joints.len() - 1
    }

    /// A name for the next joint that closes a loop.
    pub(crate) fn loop_name(&self, given: Option<&str>) -> String {
        let loops = self.joints.iter().filter(|joint| !joint.in_tree);
        let count = 1 + loops.count() + self.couplings.len();
        given.map_or_else(|| format!("loop{count}"), str::to_owned)
    }

    pub(crate) fn joint_named(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// A joint with one coordinate.
    pub(crate) fn driveable(&self, name: &str) -> Option<usize> {
        let joint = self.joint_named(name);
        joint.filter(|joint| self.joints[*joint].is_driveable())
    }

    /// The drive of a joint, a new one if it has none.
    pub(crate) fn drive(&mut self, joint: usize) -> &mut Drive {
        let known = self.drives.iter().position(|drive| drive.joint == joint);
        if known.is_none() {
            self.drives.push(Drive {
                joint,
                law: None,
                servo: None,
            });
        }
        let last = self.drives.len() - 1;
        &mut self.drives[known.unwrap_or(last)]
    }

    /// Whether a joint or a load touches the body.
    pub(crate) fn is_used(&self, body: usize) -> bool {
        let loaded = |load: &Load| load.at.iter().any(|(of, _)| *of == body);
        self.loads.iter().any(loaded) || self.has(body)
    }

    /// Whether the body is the ground, or in a joint: others are not in the scene.
    pub(crate) fn has(&self, body: usize) -> bool {
        let touches = |joint: &Joint| joint.bodies().contains(&body);
        body == GROUND || self.joints.iter().any(touches)
    }

    /// For each body the first of those that some of the joints connect with it.
    pub(crate) fn components(&self, some: impl Fn(usize, &Joint) -> bool) -> Vec<usize> {
        let mut first: Vec<usize> = (0..self.bodies.len()).collect();
        for (k, joint) in self.joints.iter().enumerate() {
            if some(k, joint) {
                connect(&mut first, joint.bodies());
            }
        }
        first
    }

    /// Selects the joints of the tree: those that are in it, then those that fix, then those with a coordinate. The others close loops.
    pub(crate) fn span(&mut self) {
        let rank = |joint: &Joint| {
            (
                !joint.in_tree,
                joint.kind != Kind::Fixed,
                !joint.is_driveable(),
            )
        };
        let mut order: Vec<usize> = (0..self.joints.len()).collect();
        order.sort_by_key(|joint| rank(&self.joints[*joint]));
        let mut first: Vec<usize> = (0..self.bodies.len()).collect();
        for joint in order {
            let joint = &mut self.joints[joint];
            joint.in_tree = connect(&mut first, joint.bodies());
        }
    }
}

/// Connects the components of two bodies, unless they are one.
fn connect(first: &mut [usize], bodies: [usize; 2]) -> bool {
    let [a, b] = bodies.map(|body| first[body]);
    let (least, other) = (a.min(b), a.max(b));
    for one in first.iter_mut().filter(|one| **one == other) {
        *one = least;
    }
    a != b
}
