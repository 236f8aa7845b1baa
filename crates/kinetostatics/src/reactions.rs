//! Where each requested reaction comes from: the force in a bond (a chord's multiplier, or what a
//! joint of the tree bears), the couple that holds two bodies at an angle, or a relation's multiplier.

use crate::model::Model;
use crate::runs::Runs;
use dwell_geometry::frames::{Coupler, Turning};
use dwell_geometry::lower::Tie;
use dwell_geometry::plan::BondPlace;
use dwell_geometry::scalar::each;
use dwell_geometry::{Component, JointKind, Mechanism, Plan, Pose, Reaction, Scalar, Vec2, vec2};

/// One end of a chord.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    pub(crate) body: usize,
    /// Its place among the carried bodies; none for the ground.
    pub(crate) carried: Option<usize>,
    pub(crate) frame: usize,
    /// From the body's root to the bond's point, in its frame, m; none where they coincide.
    pub(crate) arm: Option<Vec2>,
}

/// A direction along which a force is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Along {
    /// The ground's x or y axis, times a sign.
    X(f64),
    Y(f64),
    /// A constant vector in a frame.
    Frame(usize, Vec2),
}

impl Along {
    /// The component of some forces.
    #[inline(always)]
    fn component<T: Scalar, const N: usize>(self, forces: &[Vec2<T>; N], pose: &Pose<T>) -> [T; N] {
        let along = match self {
            Self::X(sign) => vec2(T::lift(sign), T::lift(0.0)),
            Self::Y(sign) => vec2(T::lift(0.0), T::lift(sign)),
            Self::Frame(frame, local) => local.lift().turn(pose.turn[frame]),
        };
        each(*forces, |force| force.dot(along))
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    /// The multiplier of a chord that closes along its normal only.
    Normal(usize),
    /// A component of the force in a chord, by closure.
    Chord(usize, Along),
    /// A component of the force on a carried body.
    Carry(usize, Along),
    /// The couple on a held body, times a sign.
    Hold { body: usize, sign: f64 },
    /// The multiplier of a relation.
    Relation(usize),
    /// Held by others already: nothing is left for this one.
    Spare,
}

/// The sources of the requested reactions, and what they need.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sources {
    sources: Vec<Source>,
    pub(crate) tree_forces: bool,
    pub(crate) moments: bool,
    /// By carried body: whether what its joint exerts on it is needed. By body: whether its couple is.
    pub(crate) held: Vec<bool>,
    pub(crate) twisted: Vec<bool>,
    /// By closure: its two ends.
    pub(crate) chords: Vec<[End; 2]>,
    /// By carried body: the body that carries it.
    pub(crate) parent_body: Vec<usize>,
    /// By carried body: whether it is the second of the joint that carries it.
    pub(crate) carried_is_second: Vec<bool>,
    /// By actuator: the frames that its coordinate turns, with the sign.
    pub(crate) driven: Vec<Vec<(usize, f64)>>,
    /// By actuator: the slide it drives.
    pub(crate) slides: Vec<Option<usize>>,
}

impl Sources {
    pub(crate) fn find(mechanism: &Mechanism, plan: &Plan, reactions: &[Reaction]) -> Self {
        let tree = plan.tree();
        let chords = plan.closures().iter().map(|closure| {
            let bond = &plan.bonds()[closure.bond];
            [0, 1].map(|i| {
                let body = bond.bodies[i];
                let arm = tree.arm(plan.frames(), body, bond.points[i]);
                End {
                    body,
                    carried: tree.place[body],
                    frame: arm.frame,
                    arm: (arm.local != Vec2::ZERO).then_some(arm.local),
                }
            })
        });
        let second = |c: &dwell_geometry::tree::Carry| plan.bonds()[c.bond].bodies[1] == c.body;
        let mut found = Self {
            chords: chords.collect(),
            parent_body: tree.carries.iter().map(|c| c.parent).collect(),
            carried_is_second: tree.carries.iter().map(second).collect(),
            driven: driven(plan),
            slides: (0..plan.actuators()).map(|a| plan.slide_of(a)).collect(),
            ..Self::default()
        };
        for &reaction in reactions {
            let source = found.source(mechanism, plan, reaction);
            found.sources.push(source);
        }
        found.walk(plan);
        found
    }

    /// Finds the bodies from whose forces and couples the requested ones are summed.
    fn walk(&mut self, plan: &Plan) {
        let carried = plan.carried();
        let mut held = vec![false; carried.len()];
        let mut twisted = vec![false; carried.len() + 1];
        for source in &self.sources {
            match *source {
                Source::Carry(carried, _) => held[carried] = true,
                Source::Hold { body, .. } => twisted[body] = true,
                _ => {}
            }
        }
        // A couple is handed on to the body that is held against, and each is outwards of that.
        for hold in &plan.frames().holds {
            twisted[hold.body] |= twisted[hold.against];
        }
        // A couple needs the forces of the joints at its body; a force those of all that hangs on its body.
        for (i, body) in carried.iter().enumerate() {
            let joint = [body.body, self.parent_body[i]];
            held[i] |= joint.iter().any(|&body| twisted[body]);
            held[i] |= body.parent.is_some_and(|parent| held[parent]);
        }
        self.tree_forces = held.contains(&true);
        self.moments = twisted.contains(&true);
        (self.held, self.twisted) = (held, twisted);
    }

    /// Whether what the joint that carries a chord's end exerts is needed.
    pub(crate) fn end_is_held(&self, end: &End) -> bool {
        end.carried.is_some_and(|carried| self.held[carried])
    }

    /// Asks for nothing.
    pub(crate) fn clear(&mut self) {
        self.sources.clear();
        self.tree_forces = false;
        self.moments = false;
        self.held.fill(false);
        self.twisted.fill(false);
    }

    fn source(&self, mechanism: &Mechanism, plan: &Plan, reaction: Reaction) -> Source {
        let Reaction { joint, component } = reaction;
        let (bond, relation) = plan.parts(joint);
        let kind = mechanism.joints[joint.0].kind;
        match (component, bond, relation) {
            (Component::Tooth | Component::Tangent | Component::Force, _, Some(relation)) => {
                Source::Relation(relation)
            }
            (Component::Moment, _, Some(relation)) if matches!(kind, JointKind::Relation(_)) => {
                Source::Relation(relation)
            }
            (Component::Moment, Some(bond), _) => held(plan, bond),
            (_, Some(bond), _) => self.force(plan, bond, component),
            _ => Source::Spare,
        }
    }

    /// A component of the force in a bond.
    fn force(&self, plan: &Plan, bond: usize, component: Component) -> Source {
        let described = &plan.bonds()[bond];
        let in_frame = |body: usize, local: Vec2| {
            let attitude = plan.frames().attitudes[body];
            Along::Frame(attitude.frame, local.turn(attitude.offset))
        };
        let along = match (component, described.tie) {
            (Component::Y, _) => Along::Y(1.0),
            (Component::Normal, Tie::Slide { axes, .. }) => {
                in_frame(described.bodies[0], axes[0].perp())
            }
            // The line of a distance is the x axis of its second body.
            (Component::Axial, _) => in_frame(described.bodies[1], Vec2::IDENTITY),
            _ => Along::X(1.0),
        };
        let closure = match plan.bond_place(bond) {
            BondPlace::Closes(closure) => closure,
            BondPlace::Carries(carried) => return self.carry(carried, along),
        };
        if plan.closures()[closure].axis.is_some() {
            Source::Normal(closure)
        } else {
            Source::Chord(closure, along)
        }
    }

    /// A component of the force on a carried body, as the action of its bond's first body.
    fn carry(&self, carried: usize, along: Along) -> Source {
        let sign = if self.carried_is_second[carried] {
            1.0
        } else {
            -1.0
        };
        let signed = match along {
            Along::X(_) => Along::X(sign),
            Along::Y(_) => Along::Y(sign),
            Along::Frame(frame, local) => Along::Frame(frame, local * sign),
        };
        Source::Carry(carried, signed)
    }
}

/// The couple in a bond that holds an angle.
fn held(plan: &Plan, bond: usize) -> Source {
    let by = Coupler::Bond(bond);
    let hold = plan.frames().holds.iter().find(|h| h.by == by);
    hold.map_or(Source::Spare, |hold| Source::Hold {
        body: hold.body,
        sign: if hold.body_is_first { -1.0 } else { 1.0 },
    })
}

/// By actuator, the frames it turns, directly or through others.
fn driven(plan: &Plan) -> Vec<Vec<(usize, f64)>> {
    let frames = &plan.frames().frames;
    let mut driven = vec![Vec::new(); plan.actuators()];
    for f in 0..frames.len() {
        let mut at = f;
        while let Turning::Driven {
            parent,
            actuator,
            sign,
        } = frames[at].turning
        {
            driven[actuator].push((f, sign));
            at = parent;
        }
    }
    driven
}

impl<T: Scalar, const N: usize> Runs<T, N> {
    /// The `k`th requested reaction in each run, N or N·m.
    #[inline(always)]
    pub(crate) fn reaction(&self, model: &Model, pose: &Pose<T>, k: usize) -> [T; N] {
        match model.sources.sources[k] {
            Source::Normal(closure) => each(self.balance.multiplier[closure], |m| m.x),
            Source::Chord(closure, along) => {
                along.component(&self.balance.multiplier[closure], pose)
            }
            Source::Carry(carried, along) => along.component(&self.held[carried], pose),
            Source::Hold { body, sign } => each(self.couple[body], |c| c * T::lift(sign)),
            Source::Relation(relation) => self.balance.relation[relation],
            Source::Spare => [T::lift(0.0); N],
        }
    }
}
