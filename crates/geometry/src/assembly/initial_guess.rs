//! The initial guess: the start values of Newton's method, which also select one of several assembly modes.

use crate::assembly::modes::{AssemblyMode, SAME_MODE};
use crate::mechanism::{BranchHint, JointId, Mechanism};
use crate::plan::{AssemblyConfiguration, GroupModes, Plan, Pose};
use crate::plane::Vec2;
use crate::structure::groups::Unknown;
use crate::structure::lower::{Lowered, LoweredCoordinate};

/// The approximate angles and travels at assembly, on the lowered mechanism.
#[derive(Debug)]
pub(crate) struct InitialGuess {
    /// By body, including added massless bodies, rad.
    pub(crate) angles: Vec<Option<f64>>,
    /// By pair, m.
    pub(crate) travels: Vec<Option<f64>>,
    /// The joints that can have a branch hint, each with the lowered coordinate it is about.
    hinted_joints: Vec<(JointId, LoweredCoordinate)>,
}

impl InitialGuess {
    pub(crate) fn new(
        mechanism: &Mechanism,
        lowered: &Lowered,
        configuration: &AssemblyConfiguration,
    ) -> Self {
        let mut angles = configuration.initial_guess.clone();
        angles.resize(lowered.bodies, None);
        let mut initial_guess = Self {
            angles,
            travels: vec![None; lowered.pairs.len()],
            hinted_joints: Vec::new(),
        };
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let (Some(branch_hint), Some(pair)) =
                (joint.kind.branch_hint(), lowered.joint_parts[j].0)
            else {
                continue;
            };
            let value = configuration.branch_hints.get(j).copied().flatten();
            let coordinate = match branch_hint {
                BranchHint::Travel => {
                    initial_guess.travels[pair] = value;
                    LoweredCoordinate::Travel(pair)
                }
                BranchHint::Direction => {
                    // The first pair of a distance pins its line to the first body.
                    let line = lowered.pairs[pair].bodies[1];
                    initial_guess.angles[line] = value;
                    LoweredCoordinate::Angle(line)
                }
            };
            initial_guess.hinted_joints.push((JointId(j), coordinate));
        }
        initial_guess
    }
}

impl Plan {
    /// The approximate angles of an unknown, from all bodies of its class.
    pub(crate) fn hints(&self, unknown: Unknown, initial_guess: &InitialGuess) -> Vec<f64> {
        let Unknown::ClassAngle(class) = unknown else {
            return Vec::new();
        };
        let of_body = |&b: &usize| {
            let orientation = self.frames.orientations[b];
            let revolutions = self.revolution_offsets.get(b).copied().unwrap_or(0.0);
            let angle = initial_guess.angles[b]? - revolutions;
            Some(angle - orientation.offset_angle - self.assembly_angle(orientation.frame))
        };
        let bodies = self.frames.class_bodies[class].iter();
        bodies.filter_map(of_body).collect()
    }

    /// The approximate value of an unknown: a joint's travel, a body's angle, or for a line of centres its
    /// carrier's angle plus its phase.
    pub(crate) fn hint(&self, unknown: Unknown, initial_guess: &InitialGuess) -> Option<f64> {
        if let Some(&hint) = self.hints(unknown, initial_guess).first() {
            return Some(hint);
        }
        let class = match unknown {
            Unknown::ClassAngle(class) => class,
            Unknown::SlideTravel(slide) => {
                return initial_guess.travels[self.tree.slide_pairs[slide]];
            }
        };
        let &(carrier, phase) = self.carrier_phases.get(&self.class_frame(class))?;
        let carrier_angle = match self.frames.frames[carrier].orientation_class {
            0 => 0.0,
            of => *self.hints(Unknown::ClassAngle(of), initial_guess).first()?,
        };
        Some(carrier_angle + self.assembly_angle(carrier) + phase)
    }

    /// The angle of a frame from the first frame of its class at assembly, rad.
    pub(crate) fn assembly_angle(&self, frame: usize) -> f64 {
        let turned_by = self.frames.turned_by(frame);
        turned_by.fold(0.0, |angle, (actuator, sign)| {
            angle + sign * self.assembly_coordinates[actuator]
        })
    }

    /// The distance of an assembly mode from the initial guess: the root of the sum of squared chords on the unit circle
    /// and of squared lengths over the size of the group.
    pub(crate) fn distance_to_guess(
        &self,
        g: usize,
        mode: &AssemblyMode,
        initial_guess: &InitialGuess,
    ) -> f64 {
        let group = &self.groups[g];
        let angle_deviation = |(&u, &(value, angle)): (&Unknown, &(Vec2, f64))| -> f64 {
            let counted =
                matches!(u, Unknown::ClassAngle(c) if self.revolution_counted[self.class_frame(c)]);
            let hints = self.hints(u, initial_guess).into_iter();
            let each = hints.map(|hint| {
                // Where revolutions are counted, the approximate angle selects one.
                let deviation = value - Vec2::from_angle(hint);
                let angle_deviation = angle - hint;
                if counted {
                    angle_deviation * angle_deviation
                } else {
                    deviation.dot(deviation)
                }
            });
            each.sum()
        };
        let values = group.group.unknowns.iter().zip(&mode.values);
        let angles = values.map(angle_deviation);
        let travel_deviations = mode.travels.iter().filter_map(|&(pair, travel)| {
            let deviation = (travel - initial_guess.travels[pair]?) / group.size;
            Some(deviation * deviation)
        });
        angles.chain(travel_deviations).sum::<f64>().sqrt()
    }

    /// The travels of a group's slides, by pair: its unknowns, and those along which its loops close.
    pub(crate) fn slide_travels(&self, g: usize, pose: &Pose<f64>) -> Vec<(usize, f64)> {
        let group = &self.groups[g].group;
        let unknown = group.unknowns.iter().filter_map(|u| match *u {
            Unknown::SlideTravel(s) => Some((self.tree.slide_pairs[s], pose.slide_travel[s])),
            Unknown::ClassAngle(_) => None,
        });
        let closing = group.loops.iter().filter_map(|&l| {
            let closure = &self.loop_closures[l];
            closure.axis.map(|_| (closure.pair, pose.closure_travel[l]))
        });
        unknown.chain(closing).collect()
    }

    /// The coordinates in which some assembly modes differ: angles of bodies, and where these do not suffice, directions
    /// and travels of joints.
    pub(crate) fn distinguish_modes(
        &self,
        g: usize,
        modes: &[&AssemblyMode],
        initial_guess: &InitialGuess,
    ) -> GroupModes {
        let size = self.groups[g].size;
        let value = |mode: &AssemblyMode, coordinate: LoweredCoordinate| match coordinate {
            LoweredCoordinate::Angle(body) => self.body_angle_in_mode(g, mode, body),
            LoweredCoordinate::Travel(pair) => {
                let mut travels = mode.travels.iter();
                travels.find(|t| t.0 == pair).map(|t| t.1)
            }
        };
        let differ = |one: &AssemblyMode, other: &AssemblyMode, coordinate: LoweredCoordinate| {
            let both = value(one, coordinate).zip(value(other, coordinate));
            both.is_some_and(|(a, b)| match coordinate {
                LoweredCoordinate::Angle(_) => {
                    (Vec2::from_angle(a) - Vec2::from_angle(b)).norm() > SAME_MODE
                }
                LoweredCoordinate::Travel(_) => (a - b).abs() > SAME_MODE * size,
            })
        };
        let varies = |coordinate: LoweredCoordinate| {
            let mut others = modes.iter().skip(1);
            others.any(|mode| differ(modes[0], mode, coordinate))
        };
        let mut bodies = self.group_bodies(g);
        bodies.retain(|b| varies(LoweredCoordinate::Angle(b.0)));
        let alike = |one: &AssemblyMode, other: &AssemblyMode| {
            let mut bodies = bodies.iter();
            !bodies.any(|b| differ(one, other, LoweredCoordinate::Angle(b.0)))
        };
        let mut pairs = (0..modes.len()).flat_map(|k| (0..k).map(move |i| (i, k)));
        let mut joints = initial_guess.hinted_joints.clone();
        if pairs.any(|(i, k)| alike(modes[i], modes[k])) {
            joints.retain(|&(_, coordinate)| varies(coordinate));
        } else {
            joints.clear();
        }
        let coordinates = bodies.iter().map(|b| LoweredCoordinate::Angle(b.0));
        let coordinates: Vec<LoweredCoordinate> =
            coordinates.chain(joints.iter().map(|j| j.1)).collect();
        let describe = |mode: &&AssemblyMode| {
            let each = coordinates.iter();
            each.map(|&m| value(mode, m).unwrap_or(f64::NAN)).collect()
        };
        GroupModes {
            modes: modes.iter().map(describe).collect(),
            joints: joints.into_iter().map(|j| j.0).collect(),
            bodies,
        }
    }

    /// The angle of a body in an assembly mode of its group, if it belongs to the class of one of its unknowns.
    fn body_angle_in_mode(&self, g: usize, mode: &AssemblyMode, body: usize) -> Option<f64> {
        let orientation = self.frames.orientations[body];
        let mut unknowns = self.groups[g].group.unknowns.iter().zip(&mode.values);
        unknowns.find_map(|(&u, (value, _))| match u {
            Unknown::ClassAngle(c) if self.class_frame(c) == orientation.frame => {
                Some(value.rotate(orientation.offset).angle())
            }
            _ => None,
        })
    }
}
