//! What is known roughly of the start: where Newton's method begins, and which of several ways is meant.

use crate::frames::{Attitude, Turning};
use crate::groups::Unknown;
use crate::lower::{Lowered, Measure};
use crate::mechanism::{JointId, Mechanism, Told};
use crate::plan::{Branches, Plan, Pose, Start};
use crate::plane::Vec2;
use crate::ways::{SAME, Way};

/// The rough angles and travels of a start, on the lowered mechanism.
#[derive(Debug)]
pub(crate) struct Rough {
    /// By body, the added ones among them, rad.
    pub(crate) angles: Vec<Option<f64>>,
    /// By bond, m.
    pub(crate) travels: Vec<Option<f64>>,
    /// The joints of which something can be told, and what that is here.
    joints: Vec<(JointId, Measure)>,
}

impl Rough {
    pub(crate) fn new(mechanism: &Mechanism, lowered: &Lowered, start: &Start) -> Self {
        let mut angles = start.rough.clone();
        angles.resize(lowered.bodies, None);
        let mut rough = Self {
            angles,
            travels: vec![None; lowered.bonds.len()],
            joints: Vec::new(),
        };
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let (Some(told), Some(bond)) = (joint.kind.told(), lowered.of_joint[j].0) else {
                continue;
            };
            let value = start.joints.get(j).copied().flatten();
            let measure = match told {
                Told::Travel => {
                    rough.travels[bond] = value;
                    Measure::Travel(bond)
                }
                Told::Direction => {
                    // The first bond of a distance pins its line to the first body.
                    let line = lowered.bonds[bond].bodies[1];
                    rough.angles[line] = value;
                    Measure::Angle(line)
                }
            };
            rough.joints.push((JointId(j), measure));
        }
        rough
    }
}

impl Plan {
    /// The rough angles of an unknown, from all the bodies that turn with it.
    pub(crate) fn hints(&self, unknown: Unknown, rough: &Rough) -> Vec<f64> {
        let Unknown::Class(class) = unknown else {
            return Vec::new();
        };
        let of_body = |(b, (attitude, angle)): (usize, (&Attitude, &Option<f64>))| {
            let frame = &self.frames.frames[attitude.frame];
            let angle = (*angle)? - self.turns.get(b).copied().unwrap_or(0.0);
            (frame.class == class)
                .then(|| angle - attitude.offset.angle() - self.driven_angle(attitude.frame))
        };
        let bodies = self.frames.attitudes.iter().zip(&rough.angles);
        bodies.enumerate().filter_map(of_body).collect()
    }

    /// The rough value of an unknown: a joint's travel, a body's angle, or for a line of centres its
    /// carrier's and the lead.
    pub(crate) fn hint(&self, unknown: Unknown, rough: &Rough) -> Option<f64> {
        if let Some(&hint) = self.hints(unknown, rough).first() {
            return Some(hint);
        }
        let class = match unknown {
            Unknown::Class(class) => class,
            Unknown::Slide(slide) => return rough.travels[self.tree.slides[slide]],
        };
        let &(carrier, lead) = self.beside.get(&self.root_of(class))?;
        let beside = match self.frames.frames[carrier].class {
            0 => 0.0,
            of => *self.hints(Unknown::Class(of), rough).first()?,
        };
        Some(beside + self.driven_angle(carrier) + lead)
    }

    /// The angle of a frame from the first frame of its class, at the start.
    pub(crate) fn driven_angle(&self, mut frame: usize) -> f64 {
        let mut angle = 0.0;
        while let Turning::Driven {
            parent,
            actuator,
            sign,
        } = self.frames.frames[frame].turning
        {
            angle += sign * self.start[actuator];
            frame = parent;
        }
        angle
    }

    /// How far a way is from what is known roughly: the root of a sum of squared chords, and of squared
    /// lengths over the size of the group.
    pub(crate) fn astray(&self, g: usize, way: &Way, rough: &Rough) -> f64 {
        let group = &self.groups[g];
        let turned = |(&u, &(value, angle)): (&Unknown, &(Vec2, f64))| -> f64 {
            let counted = matches!(u, Unknown::Class(c) if self.counted[self.root_of(c)]);
            let hints = self.hints(u, rough).into_iter();
            let each = hints.map(|hint| {
                // Where turns count, the rough angle says which one is meant.
                let apart = value - Vec2::from_angle(hint);
                let turned = angle - hint;
                if counted {
                    turned * turned
                } else {
                    apart.dot(apart)
                }
            });
            each.sum()
        };
        let angles = group.group.unknowns.iter().zip(&way.values).map(turned);
        let slid = way.travels.iter().filter_map(|&(bond, travel)| {
            let away = (travel - rough.travels[bond]?) / group.size;
            Some(away * away)
        });
        angles.chain(slid).sum::<f64>().sqrt()
    }

    /// The travels of a group's slides, by bond: its unknowns, and those along which its loops close.
    pub(crate) fn travels(&self, g: usize, pose: &Pose<f64>) -> Vec<(usize, f64)> {
        let group = &self.groups[g].group;
        let unknown = group.unknowns.iter().filter_map(|u| match *u {
            Unknown::Slide(s) => Some((self.tree.slides[s], pose.slide[s])),
            Unknown::Class(_) => None,
        });
        let closing = group.loops.iter().filter_map(|&l| {
            let closure = &self.closures[l];
            closure.axis.map(|_| (closure.bond, pose.travel[l]))
        });
        unknown.chain(closing).collect()
    }

    /// What tells some ways apart: the angles of bodies, and where these do not, those of distances
    /// and the travels of joints.
    pub(crate) fn told_apart(&self, g: usize, ways: &[&Way], rough: &Rough) -> Branches {
        let size = self.groups[g].size;
        let value = |way: &Way, measure: Measure| match measure {
            Measure::Angle(body) => self.angle_in(g, way, body),
            Measure::Travel(bond) => {
                let mut travels = way.travels.iter();
                travels.find(|t| t.0 == bond).map(|t| t.1)
            }
        };
        let differ = |one: &Way, other: &Way, measure: Measure| {
            let both = value(one, measure).zip(value(other, measure));
            both.is_some_and(|(a, b)| match measure {
                Measure::Angle(_) => (Vec2::from_angle(a) - Vec2::from_angle(b)).norm() > SAME,
                Measure::Travel(_) => (a - b).abs() > SAME * size,
            })
        };
        let varies = |measure: Measure| {
            let mut others = ways.iter().skip(1);
            others.any(|way| differ(ways[0], way, measure))
        };
        let mut bodies = self.group_bodies(g);
        bodies.retain(|b| varies(Measure::Angle(b.0)));
        let alike = |one: &Way, other: &Way| {
            let mut bodies = bodies.iter();
            !bodies.any(|b| differ(one, other, Measure::Angle(b.0)))
        };
        let mut pairs = (0..ways.len()).flat_map(|k| (0..k).map(move |i| (i, k)));
        let mut joints = rough.joints.clone();
        if pairs.any(|(i, k)| alike(ways[i], ways[k])) {
            joints.retain(|&(_, measure)| varies(measure));
        } else {
            joints.clear();
        }
        let measures = bodies.iter().map(|b| Measure::Angle(b.0));
        let measures: Vec<Measure> = measures.chain(joints.iter().map(|j| j.1)).collect();
        let told = |way: &&Way| {
            let each = measures.iter();
            each.map(|&m| value(way, m).unwrap_or(f64::NAN)).collect()
        };
        Branches {
            ways: ways.iter().map(told).collect(),
            joints: joints.into_iter().map(|j| j.0).collect(),
            bodies,
        }
    }

    /// The angle of a body in a way of its group, if it turns with an unknown of that.
    fn angle_in(&self, g: usize, way: &Way, body: usize) -> Option<f64> {
        let attitude = self.frames.attitudes[body];
        let mut unknowns = self.groups[g].group.unknowns.iter().zip(&way.values);
        unknowns.find_map(|(&u, (value, _))| match u {
            Unknown::Class(c) if self.root_of(c) == attitude.frame => {
                Some(value.turn(attitude.offset).angle())
            }
            _ => None,
        })
    }
}
