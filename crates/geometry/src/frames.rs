//! Which bodies turn together. Bodies joined by a prismatic joint keep their angle to one another;
//! an angular actuator sets it. So orientations need fewer unknowns than there are bodies: one per
//! *class* of bodies whose relative angles are known once the actuators' coordinates are.

use crate::error::StructureError;
use crate::lower::{Bond, Driven, Lowered, Owner, Tie};
use crate::mechanism::ActuatorId;
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
    /// A slide or a weld, by its moment: index of the bond.
    Bond(usize),
    /// An angular actuator, by its action.
    Actuator(ActuatorId),
}

/// A body held at an angle to another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// The body that is held.
    pub body: usize,
    /// The body it is held against, which comes earlier.
    pub against: usize,
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
    /// Bonds that hold an angle which others hold already: what they bear is not determined.
    pub spare: Vec<usize>,
    /// Number of classes, the ground's included.
    pub classes: usize,
    /// The bodies of each class.
    pub members: Vec<Vec<usize>>,
}

/// Two ways to one angle agree to the rounding of the axes they come from, rad.
const SAME_ANGLE: f64 = 1e-9;

impl Frames {
    /// Finds the frames and classes of a mechanism.
    ///
    /// # Errors
    /// [`StructureError::OverConstrained`] when a slide, a weld or an actuator holds an angle
    /// that others hold already, unless it is a slide or a weld that holds the same angle.
    pub(crate) fn find(lowered: &Lowered) -> Result<Self, StructureError> {
        let n = lowered.bodies;
        let mut neighbours: Vec<Vec<(usize, Coupler, bool)>> = vec![Vec::new(); n];
        let mut connect = |bodies: [usize; 2], by: Coupler| {
            neighbours[bodies[0]].push((bodies[1], by, false));
            neighbours[bodies[1]].push((bodies[0], by, true));
        };
        for (i, drive) in lowered.drives.iter().enumerate() {
            if let Driven::Angle(bodies) = *drive {
                connect(bodies, Coupler::Actuator(ActuatorId(i)));
            }
        }
        for (b, bond) in lowered.bonds.iter().enumerate() {
            if bond.tie != Tie::Pin {
                connect(bond.bodies, Coupler::Bond(b));
            }
        }

        let still = Attitude {
            frame: 0,
            offset: Vec2::IDENTITY,
        };
        let mut found = Self {
            frames: vec![Frame {
                turning: Turning::Ground,
                class: 0,
            }],
            attitudes: vec![still; n],
            holds: Vec::new(),
            spare: Vec::new(),
            classes: 1,
            members: Vec::new(),
        };
        let mut seen = vec![false; n];
        let mut met = Met::new(lowered);
        for root in std::iter::once(lowered.ground).chain(0..n) {
            if seen[root] {
                continue;
            }
            seen[root] = true;
            if root != lowered.ground {
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
                    if !met.first(by) {
                        continue;
                    }
                    if seen[other] {
                        found.again(lowered, body, other, by, other_is_first, &mut met);
                        continue;
                    }
                    seen[other] = true;
                    found.attitudes[other] =
                        found.held(lowered, found.attitudes[body], by, other_is_first);
                    found.holds.push(Hold {
                        body: other,
                        against: body,
                        by,
                        body_is_first: other_is_first,
                    });
                    queue.push(other);
                }
            }
        }
        met.finish()?;
        found.members = vec![Vec::new(); found.classes];
        for (body, attitude) in found.attitudes.iter().enumerate() {
            found.members[found.frames[attitude.frame].class].push(body);
        }
        Ok(found)
    }

    /// The attitude of a body held `by` something against a body of attitude `against`.
    fn held(
        &mut self,
        lowered: &Lowered,
        against: Attitude,
        by: Coupler,
        is_first: bool,
    ) -> Attitude {
        match by {
            Coupler::Bond(b) => Attitude {
                frame: against.frame,
                offset: turned(&lowered.bonds[b], against.offset, is_first),
            },
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

    /// A coupler between two bodies whose angle is held already.
    fn again(
        &mut self,
        lowered: &Lowered,
        body: usize,
        other: usize,
        by: Coupler,
        other_is_first: bool,
        met: &mut Met,
    ) {
        let (own, there) = (self.attitudes[body], self.attitudes[other]);
        if let Coupler::Bond(b) = by
            && own.frame == there.frame
        {
            let wanted = turned(&lowered.bonds[b], own.offset, other_is_first);
            if (wanted - there.offset).norm() < SAME_ANGLE {
                self.spare.push(b);
                return;
            }
        }
        met.too_many.push(match by {
            Coupler::Bond(b) => lowered.bonds[b].owner,
            Coupler::Actuator(a) => Owner::Actuator(a),
        });
    }
}

/// The constant rotation of the other body of a bond, from that of one of them.
fn turned(bond: &Bond, offset: Vec2, other_is_first: bool) -> Vec2 {
    match bond.tie {
        Tie::Pin => offset,
        // Both axes point the same way: θ₁ + α₁ = θ₂ + α₂.
        Tie::Slide { axes, .. } => {
            let (other, own) = if other_is_first {
                (axes[0], axes[1])
            } else {
                (axes[1], axes[0])
            };
            offset.turn(own).turn_back(other)
        }
        Tie::Weld(angle) if other_is_first => offset.turn_back(angle),
        Tie::Weld(angle) => offset.turn(angle),
    }
}

/// Keeps count of the couplers met while walking, and of those that cannot be.
struct Met {
    bonds: Vec<bool>,
    actuators: Vec<bool>,
    too_many: Vec<Owner>,
}

impl Met {
    fn new(lowered: &Lowered) -> Self {
        Self {
            bonds: vec![false; lowered.bonds.len()],
            actuators: vec![false; lowered.drives.len()],
            too_many: Vec::new(),
        }
    }

    /// Whether the coupler is met for the first time.
    fn first(&mut self, by: Coupler) -> bool {
        let met = match by {
            Coupler::Bond(b) => &mut self.bonds[b],
            Coupler::Actuator(a) => &mut self.actuators[a.0],
        };
        !std::mem::replace(met, true)
    }

    fn finish(self) -> Result<(), StructureError> {
        if self.too_many.is_empty() {
            return Ok(());
        }
        let excess = self.too_many.len();
        let (joints, actuators) = Lowered::owners(self.too_many);
        Err(StructureError::OverConstrained {
            excess,
            joints,
            actuators,
        })
    }
}
