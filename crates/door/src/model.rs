//! A mechanism between a file and a scene: every reader makes one, and the writer of scenes reads it.

use crate::finding::{Effect, Findings, Place};
use crate::pose::{Matrix, Pose, Vector, add, dot, scaled, sub};

/// The index of the ground among the bodies.
pub(crate) const GROUND: usize = 0;

#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) place: Place,
    /// Where its frame is as drawn.
    pub(crate) pose: Pose,
    pub(crate) mass: f64,
    /// In its frame, as all that follows; the tensor is about the centre of mass.
    pub(crate) center: Vector,
    pub(crate) inertia: Matrix,
    pub(crate) points: Vec<(String, Vector)>,
}

impl Body {
    pub(crate) fn new(name: &str, place: Place, pose: Pose) -> Self {
        Self {
            name: name.to_owned(),
            place,
            pose,
            mass: 0.0,
            center: [0.0; 3],
            inertia: Matrix::ZERO,
            points: Vec::new(),
        }
    }

    /// Adds a part, given in the body's frame.
    pub(crate) fn add_mass(&mut self, mass: f64, center: Vector, inertia: Matrix) {
        if mass == 0.0 {
            self.inertia = self.inertia.plus(inertia);
            return;
        }
        let total = self.mass + mass;
        let weighted = add(scaled(self.center, self.mass), scaled(center, mass));
        let common = scaled(weighted, 1.0 / total);
        let old = steiner(self.mass, sub(self.center, common));
        let new = steiner(mass, sub(center, common));
        let both = self.inertia.plus(inertia).plus(old).plus(new);
        (self.mass, self.center, self.inertia) = (total, common, both);
    }
}

/// The tensor of a mass at an offset.
pub(crate) fn steiner(mass: f64, offset: Vector) -> Matrix {
    let isotropic = Matrix::IDENTITY.scaled(dot(offset, offset));
    let along = Matrix::outer(offset, offset).scaled(-1.0);
    isotropic.plus(along).scaled(mass)
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

/// A side of a joint, in the frame of its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    pub(crate) body: usize,
    /// Its origin is the joint's point, its z the axis.
    pub(crate) frame: Pose,
}

impl End {
    pub(crate) fn new(body: usize, frame: Pose) -> Self {
        Self { body, frame }
    }
}

/// What acts along the coordinate of a joint, and its limits, in the file's own coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Along {
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    pub(crate) stiffness: f64,
    pub(crate) spring_reference: f64,
    pub(crate) armature: f64,
    pub(crate) limits: Option<[f64; 2]>,
}

#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) place: Place,
    pub(crate) kind: Kind,
    pub(crate) first: End,
    pub(crate) second: End,
    /// Whether the second body hangs on the first; other joints close loops.
    pub(crate) in_tree: bool,
    /// The file's coordinate as drawn.
    pub(crate) drawn: f64,
    pub(crate) along: Along,
}

impl Joint {
    /// A joint that is not in the tree, drawn where its coordinate is zero.
    pub(crate) fn new(name: impl Into<String>, place: Place, kind: Kind, ends: [End; 2]) -> Self {
        let [first, second] = ends;
        Self {
            name: name.into(),
            place,
            kind,
            first,
            second,
            in_tree: false,
            drawn: 0.0,
            along: Along::default(),
        }
    }

    pub(crate) fn ends(&self) -> [&End; 2] {
        [&self.first, &self.second]
    }

    pub(crate) fn touches(&self, body: usize) -> bool {
        self.first.body == body || self.second.body == body
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
    /// The polynomial with its slope.
    pub(crate) fn at(&self, independent: f64) -> [f64; 2] {
        let x = independent - self.references[1];
        let step = |[value, slope]: [f64; 2], c: &f64| [value * x + c, slope * x + value];
        let [value, slope] = self.polynomial.iter().rev().fold([0.0; 2], step);
        [value + self.references[0], slope]
    }
}

/// A load with places of its own.
#[derive(Debug, Clone)]
pub(crate) enum Load {
    /// A spring with a damper between two points, each of a body and in its frame.
    Spring {
        name: String,
        ends: [(usize, Vector); 2],
        stiffness: f64,
        damping: f64,
        free_length: f64,
    },
    /// A force at a point of a body; its direction is that of the ground, or turns with the body.
    Force {
        name: String,
        at: (usize, Vector),
        force: Vector,
        turns: bool,
    },
}

impl Load {
    pub(crate) fn bodies(&self) -> Vec<usize> {
        match self {
            Self::Spring { ends, .. } => ends.iter().map(|(body, _)| *body).collect(),
            Self::Force { at, .. } => vec![at.0],
        }
    }
}

/// A joint that drives.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) joint: usize,
    pub(crate) motion: Motion,
    /// Gains kp and kv of a servo that holds the file's coordinate at zero.
    pub(crate) servo: Option<[f64; 2]>,
}

impl Drive {
    pub(crate) fn new(joint: usize) -> Self {
        let (motion, servo) = (Motion::Unknown, None);
        Self {
            joint,
            motion,
            servo,
        }
    }
}

/// How the file moves a drive.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Motion {
    Unknown,
    Speed(f64),
    /// The file's coordinate as a function of t, over a duration.
    Expression(String, f64),
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
    /// Named frames of bodies, which `--close` may name.
    pub(crate) frames: Vec<(String, usize, Pose)>,
    /// Bodies that are left out, and named.
    pub(crate) left_out: Vec<usize>,
    /// The file's words for friction and limits of a joint.
    pub(crate) terms: [&'static str; 2],
    pub(crate) findings: Findings,
}

impl Model {
    pub(crate) fn new(title: &str, file: &Place, findings: Findings) -> Self {
        let ground = Body::new("ground", file.clone(), Pose::IDENTITY);
        Self {
            title: title.to_owned(),
            gravity: [0.0, 0.0, -9.81],
            bodies: vec![ground],
            joints: Vec::new(),
            couplings: Vec::new(),
            loads: Vec::new(),
            drives: Vec::new(),
            frames: Vec::new(),
            left_out: Vec::new(),
            terms: ["friction", "limit"],
            findings,
        }
    }

    /// Where an end is as drawn.
    pub(crate) fn drawn(&self, end: &End) -> Pose {
        self.bodies[end.body].pose.then(end.frame)
    }

    /// The end on a body that is drawn at a place of the world.
    pub(crate) fn end_at(&self, body: usize, world: Pose) -> End {
        End::new(body, self.bodies[body].pose.inverse().then(world))
    }

    /// The same place as seen from another body, as drawn.
    pub(crate) fn seen_from(&self, body: usize, end: &End) -> End {
        self.end_at(body, self.drawn(end))
    }

    /// Fixes a body to the ground where it is.
    pub(crate) fn hold(&mut self, body: usize) {
        let second = End::new(body, Pose::IDENTITY);
        let ends = [self.seen_from(GROUND, &second), second];
        let (name, place) = (&self.bodies[body].name, self.bodies[body].place.clone());
        let mut joint = Joint::new(format!("{name}_ground"), place, Kind::Fixed, ends);
        joint.in_tree = true;
        self.joints.push(joint);
    }

    pub(crate) fn note(&self, place: &Place, effect: Effect, text: impl Into<String>) {
        self.findings.add(place, effect, text);
    }

    /// A name for the next joint that closes a loop.
    pub(crate) fn loop_name(&self, given: Option<&str>) -> String {
        let loops = self.joints.iter().filter(|joint| !joint.in_tree);
        let count = 1 + loops.count() + self.couplings.len();
        given.map_or_else(|| format!("loop{count}"), str::to_owned)
    }

    /// A new body without mass, and its number.
    pub(crate) fn push_body(&mut self, name: &str, place: Place, pose: Pose) -> usize {
        self.bodies.push(Body::new(name, place, pose));
        self.bodies.len() - 1
    }

    pub(crate) fn push_frame(&mut self, name: &str, body: usize, pose: Pose) {
        self.frames.push((name.to_owned(), body, pose));
    }

    /// A joint with one coordinate.
    pub(crate) fn driveable(&self, name: &str) -> Option<usize> {
        self.joint_named(name)
            .filter(|joint| self.joints[*joint].is_driveable())
    }

    pub(crate) fn joint_named(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The drive of a joint, a new one if it has none.
    pub(crate) fn drive(&mut self, joint: usize) -> &mut Drive {
        let known = self.drives.iter().position(|drive| drive.joint == joint);
        let at = known.unwrap_or(self.drives.len());
        if known.is_none() {
            self.drives.push(Drive::new(joint));
        }
        &mut self.drives[at]
    }
}
