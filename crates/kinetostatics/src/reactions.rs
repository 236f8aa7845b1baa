//! Where each requested reaction comes from: a chord's multiplier, the force in a joint of the
//! tree, or the couple that holds two bodies at an angle.

use crate::model::Model;
use crate::runs::Runs;
use dwell_geometry::frames::{Coupler, Turning};
use dwell_geometry::{Component, JointKind, Mechanism, Plan, Pose, Reaction, Scalar, Vec2, vec2};
use std::array;

/// One end of a chord.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    pub(crate) body: usize,
    /// Its place among the carried bodies; none for the ground.
    pub(crate) carried: Option<usize>,
    pub(crate) frame: usize,
    /// From the body's root to the joint's point, in its frame, m; none where they coincide.
    pub(crate) arm: Option<Vec2>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    /// A component of a chord's multiplier.
    Chord {
        closure: usize,
        component: Component,
    },
    /// A component of the force on a carried body, times a sign; for a prismatic joint, along the
    /// normal of the axis with these components in this frame.
    Carry {
        carried: usize,
        sign: f64,
        component: Component,
        axis: Option<(usize, Vec2)>,
    },
    /// The couple on a held body, times a sign.
    Hold { body: usize, sign: f64 },
}

/// The sources of the requested reactions, and what they need.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Sources {
    sources: Vec<Source>,
    pub(crate) tree_forces: bool,
    pub(crate) moments: bool,
    /// By closure: its two ends.
    pub(crate) chords: Vec<[End; 2]>,
    /// By carried body: the body that carries it.
    pub(crate) parent_body: Vec<usize>,
    /// By carried body: whether it is the second of the joint that carries it.
    pub(crate) carried_is_second: Vec<bool>,
    /// By actuator: the frames that its coordinate turns, with the sign.
    pub(crate) driven: Vec<Vec<(usize, f64)>>,
}

impl Sources {
    pub(crate) fn find(mechanism: &Mechanism, plan: &Plan, reactions: &[Reaction]) -> Self {
        let tree = plan.tree();
        let chords = plan.closures().iter().map(|closure| {
            let joint = &mechanism.joints[closure.joint.0];
            [0, 1].map(|i| {
                let body = joint.bodies[i].0;
                let arm = tree.arm(plan.frames(), body, joint.points[i]);
                End {
                    body,
                    carried: tree.place[body],
                    frame: arm.frame,
                    arm: (arm.local != Vec2::ZERO).then_some(arm.local),
                }
            })
        });
        let second =
            |c: &dwell_geometry::tree::Carry| mechanism.joints[c.joint.0].bodies[1] == c.body;
        let mut found = Self {
            chords: chords.collect(),
            parent_body: tree.carries.iter().map(|c| c.parent.0).collect(),
            carried_is_second: tree.carries.iter().map(second).collect(),
            driven: driven(plan),
            ..Self::default()
        };
        for &reaction in reactions {
            let source = found.source(mechanism, plan, reaction);
            found.tree_forces |= !matches!(source, Source::Chord { .. });
            found.moments |= matches!(source, Source::Hold { .. });
            found.sources.push(source);
        }
        found
    }

    /// Asks for nothing.
    pub(crate) fn clear(&mut self) {
        self.sources.clear();
        self.tree_forces = false;
        self.moments = false;
    }

    fn source(&self, mechanism: &Mechanism, plan: &Plan, reaction: Reaction) -> Source {
        let Reaction { joint, component } = reaction;
        if component == Component::Moment {
            let by = Coupler::Joint(joint);
            // Every prismatic joint holds a body: a cycle of holds has been refused.
            if let Some(hold) = plan.frames().holds.iter().find(|h| h.by == by) {
                return Source::Hold {
                    body: hold.body.0,
                    sign: if hold.body_is_first { -1.0 } else { 1.0 },
                };
            }
        }
        let at = plan.carried().iter().position(|c| c.joint == joint);
        let Some(carried) = at else {
            // A joint is in the tree or it is a chord.
            let closure = plan.closures().iter().position(|c| c.joint == joint);
            return Source::Chord {
                closure: closure.unwrap_or(0),
                component,
            };
        };
        let axis = match mechanism.joints[joint.0].kind {
            JointKind::Prismatic { axes } => {
                let first = mechanism.joints[joint.0].bodies[0].0;
                let attitude = plan.frames().attitudes[first];
                Some((attitude.frame, axes[0].turn(attitude.offset)))
            }
            _ => None,
        };
        let sign = if self.carried_is_second[carried] {
            1.0
        } else {
            -1.0
        };
        Source::Carry {
            carried,
            sign,
            component,
            axis,
        }
    }
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
    #[inline]
    pub(crate) fn reaction(&self, model: &Model, pose: &Pose<T>, k: usize) -> [T; N] {
        match model.sources.sources[k] {
            Source::Chord { closure, component } => {
                let multiplier = &self.balance.multiplier[closure];
                array::from_fn(|n| match component {
                    Component::Y => multiplier[n].y,
                    _ => multiplier[n].x,
                })
            }
            Source::Carry {
                carried,
                sign,
                component,
                axis,
            } => {
                let force = &self.held[carried];
                let along = match (component, axis) {
                    (Component::Y, _) => vec2(T::lift(0.0), T::lift(sign)),
                    (_, Some((frame, local))) => {
                        (local * sign).lift().turn(pose.turn[frame]).perp()
                    }
                    _ => vec2(T::lift(sign), T::lift(0.0)),
                };
                array::from_fn(|n| force[n].dot(along))
            }
            Source::Hold { body, sign } => self.couple[body].map(|c| c * T::lift(sign)),
        }
    }
}
