//! Which bodies turn together. Bodies joined by a prismatic joint keep their angle to one another;
//! an angular actuator sets it. So orientations need fewer unknowns than there are bodies: one per
//! *class* of bodies whose relative angles are known once the actuators' coordinates are.

use crate::error::StructureError;
use crate::mechanism::{ActuatorId, BodyId, JointId, JointKind, Mechanism};
use crate::plane::Vec2;

/// What turns a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turning {
    /// The ground's frame: it never turns.
    Ground,
    /// The first frame of a class: its angle is an unknown.
    Unknown,
    /// Turned from another frame by an actuator's coordinate, times `sign`.
    Driven {
        /// The frame it is turned from (a smaller index).
        parent: usize,
        /// The actuator whose coordinate turns it.
        actuator: usize,
        /// +1 or −1.
        sign: f64,
    },
}

/// A frame: an orientation that one or more bodies share, up to constant offsets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// What turns it.
    pub turning: Turning,
    /// Its class; class 0 is the ground's, where every angle is known.
    pub class: usize,
}

/// Orientation of a body: its frame's rotation times a constant one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attitude {
    /// Index of the frame.
    pub frame: usize,
    /// Constant rotation (cos, sin) from the frame to the body.
    pub offset: Vec2,
}

/// What holds the angle between two bodies of one class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coupler {
    /// A prismatic joint, by its moment.
    Joint(JointId),
    /// An angular actuator, by its action.
    Actuator(ActuatorId),
}

/// A body held at an angle to another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// The body that is held.
    pub body: BodyId,
    /// The body it is held against, which comes earlier.
    pub against: BodyId,
    /// What holds it.
    pub by: Coupler,
    /// Whether `body` is the first-named of the two.
    pub body_is_first: bool,
}

/// The orientations of all bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// All frames; frame 0 is the ground's, a driven frame comes after the one it is turned from.
    pub frames: Vec<Frame>,
    /// Each body's orientation, by body.
    pub attitudes: Vec<Attitude>,
    /// The holds, outwards from each class's first body.
    pub holds: Vec<Hold>,
    /// Number of classes, the ground's included.
    pub classes: usize,
}

impl Frames {
    /// Finds the frames and classes of a mechanism.
    ///
    /// # Errors
    /// [`StructureError::OverConstrained`] when a prismatic joint or an actuator holds an angle
    /// that others hold already.
    pub fn find(mechanism: &Mechanism) -> Result<Self, StructureError> {
        let n = mechanism.bodies.len();
        let mut neighbours: Vec<Vec<(usize, Coupler, bool)>> = vec![Vec::new(); n];
        let mut connect = |bodies: [BodyId; 2], by: Coupler| {
            neighbours[bodies[0].0].push((bodies[1].0, by, false));
            neighbours[bodies[1].0].push((bodies[0].0, by, true));
        };
        for (i, actuator) in mechanism.actuators.iter().enumerate() {
            connect(actuator.bodies, Coupler::Actuator(ActuatorId(i)));
        }
        for (j, joint) in mechanism.joints.iter().enumerate() {
            if matches!(joint.kind, JointKind::Prismatic { .. }) {
                connect(joint.bodies, Coupler::Joint(JointId(j)));
            }
        }

        let mut found = Self {
            frames: vec![Frame {
                turning: Turning::Ground,
                class: 0,
            }],
            attitudes: vec![
                Attitude {
                    frame: 0,
                    offset: Vec2::IDENTITY
                };
                n
            ],
            holds: Vec::new(),
            classes: 1,
        };
        let mut seen = vec![false; n];
        let mut used = Surplus::new(mechanism);
        for root in std::iter::once(mechanism.ground).chain(0..n) {
            if seen[root] {
                continue;
            }
            seen[root] = true;
            if root != mechanism.ground {
                found.attitudes[root].frame = found.frames.len();
                found.frames.push(Frame {
                    turning: Turning::Unknown,
                    class: found.classes,
                });
                found.classes += 1;
            }
            let mut queue = vec![root];
            while let Some(body) = queue.pop() {
                for &(other, by, other_is_first) in &neighbours[body] {
                    if !used.take(by) {
                        continue;
                    }
                    if seen[other] {
                        used.surplus(by);
                        continue;
                    }
                    seen[other] = true;
                    found.attitudes[other] =
                        found.held(mechanism, found.attitudes[body], by, other_is_first);
                    found.holds.push(Hold {
                        body: BodyId(other),
                        against: BodyId(body),
                        by,
                        body_is_first: other_is_first,
                    });
                    queue.push(other);
                }
            }
        }
        used.finish()?;
        Ok(found)
    }

    /// The attitude of a body held `by` something against a body of attitude `against`.
    fn held(
        &mut self,
        mechanism: &Mechanism,
        against: Attitude,
        by: Coupler,
        is_first: bool,
    ) -> Attitude {
        match by {
            Coupler::Joint(j) => {
                let JointKind::Prismatic { axes } = mechanism.joints[j.0].kind else {
                    return against;
                };
                // Both axes point the same way: θ₁ + α₁ = θ₂ + α₂.
                let (own, other) = if is_first {
                    (axes[0], axes[1])
                } else {
                    (axes[1], axes[0])
                };
                Attitude {
                    frame: against.frame,
                    offset: against.offset.turn(other).turn_back(own),
                }
            }
            Coupler::Actuator(a) => {
                let class = self.frames[against.frame].class;
                self.frames.push(Frame {
                    turning: Turning::Driven {
                        parent: against.frame,
                        actuator: a.0,
                        sign: if is_first { -1.0 } else { 1.0 },
                    },
                    class,
                });
                Attitude {
                    frame: self.frames.len() - 1,
                    offset: against.offset,
                }
            }
        }
    }
}

/// Keeps count of the couplers met while walking, and of those that close a cycle of angles.
struct Surplus {
    joints: Vec<bool>,
    actuators: Vec<bool>,
    too_many: Vec<Coupler>,
}

impl Surplus {
    fn new(mechanism: &Mechanism) -> Self {
        Self {
            joints: vec![false; mechanism.joints.len()],
            actuators: vec![false; mechanism.actuators.len()],
            too_many: Vec::new(),
        }
    }

    /// Whether the coupler is met for the first time.
    fn take(&mut self, by: Coupler) -> bool {
        let met = match by {
            Coupler::Joint(j) => &mut self.joints[j.0],
            Coupler::Actuator(a) => &mut self.actuators[a.0],
        };
        !std::mem::replace(met, true)
    }

    fn surplus(&mut self, by: Coupler) {
        self.too_many.push(by);
    }

    fn finish(self) -> Result<(), StructureError> {
        if self.too_many.is_empty() {
            return Ok(());
        }
        let mut joints = Vec::new();
        let mut actuators = Vec::new();
        for by in &self.too_many {
            match *by {
                Coupler::Joint(j) => joints.push(j),
                Coupler::Actuator(a) => actuators.push(a),
            }
        }
        Err(StructureError::OverConstrained {
            excess: self.too_many.len(),
            joints,
            actuators,
        })
    }
}
