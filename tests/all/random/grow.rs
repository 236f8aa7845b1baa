//! Growth: actuated bodies first, then Assur groups, each where it is well conditioned by itself.
//!
//! A group holds its bodies by as many rows as they have coordinates. It is singular where the
//! normals of these rows meet in a point or are parallel, which the angles drawn here stay clear
//! of; what remains is how groups hang on each other.

use super::placed_mechanism::{PlacedActuator, PlacedJoint, PlacedJointKind, PlacedMechanism};
use dwell_geometry::Vec2;
use dwell_kinetostatics::Mass;
use proptest::prelude::*;
use proptest::sample::Index;

/// One thing to add, by numbers.
#[derive(Debug, Clone)]
pub(super) struct GrowthStep {
    kind: u8,
    on: [Index; 3],
    numbers: [f64; 20],
}

/// Any step.
pub(super) fn step() -> impl Strategy<Value = GrowthStep> {
    let on = prop::array::uniform3(any::<Index>());
    let numbers = prop::array::uniform20(0.0..1.0);
    (any::<u8>(), on, numbers).prop_map(|(kind, on, numbers)| GrowthStep { kind, on, numbers })
}

/// The numbers of a step one after the other.
struct Draw<'a>(std::iter::Cycle<std::slice::Iter<'a, f64>>);

impl Draw<'_> {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        let part = self.0.next().copied().unwrap_or_default();
        from + part * (to - from)
    }

    fn boolean(&mut self) -> bool {
        self.between(0.0, 1.0) < 0.5
    }

    fn angle(&mut self) -> f64 {
        self.between(-3.1, 3.1)
    }

    /// An angle between the two, of either sign.
    fn separated(&mut self, from: f64, to: f64) -> f64 {
        let angle = self.between(-1.0, 1.0);
        (from + angle.abs() * (to - from)).copysign(angle)
    }

    fn direction(&mut self) -> Vec2 {
        Vec2::from_angle(self.angle())
    }

    fn point_near(&mut self, point: Vec2, max_distance: f64) -> Vec2 {
        point + self.direction() * self.between(0.1 * max_distance, max_distance)
    }

    fn length(&mut self) -> f64 {
        self.between(0.5, 1.2)
    }
}

/// A slide's axis makes less than this with the direction in which it holds least, rad.
const TILT: f64 = 1.0;
/// Two directions that must differ are this far from being parallel, rad.
const SEPARATION: [f64; 2] = [0.6, 2.5];

impl PlacedMechanism {
    /// The ground alone.
    pub(super) fn ground() -> Self {
        Self {
            bodies: vec![Mass::default()],
            ..Self::default()
        }
    }

    fn add_body(&mut self, near: Vec2, draw: &mut Draw<'_>) -> usize {
        let mass = if draw.between(0.0, 1.0) < 0.2 {
            0.0
        } else {
            draw.between(0.2, 4.0)
        };
        self.bodies.push(Mass {
            mass,
            center: draw.point_near(near, 0.3),
            inertia: mass * draw.between(0.05, 0.3),
        });
        self.bodies.len() - 1
    }

    fn add_joint(&mut self, bodies: [usize; 2], points: [Vec2; 2], kind: PlacedJointKind) -> usize {
        self.joints.push(PlacedJoint {
            bodies,
            points,
            kind,
        });
        self.joints.len() - 1
    }

    fn add_pin(&mut self, one: usize, two: usize, at: Vec2) {
        self.add_joint([one, two], [at; 2], PlacedJointKind::Revolute);
    }

    /// A slide, or a slot if only its normal holds, that passes near `by`.
    fn add_slide(
        &mut self,
        bodies: [usize; 2],
        point: Vec2,
        axis: Vec2,
        draw: &mut Draw<'_>,
    ) -> usize {
        let second = draw.point_near(point, 0.3);
        let first = second - axis * draw.between(-0.6, 0.6);
        self.add_joint(bodies, [first, second], PlacedJointKind::Prismatic(axis))
    }

    /// The pin of `two` at a point, in a slot of `one`.
    fn add_slot(
        &mut self,
        one: usize,
        two: usize,
        at: Vec2,
        axis: Vec2,
        draw: &mut Draw<'_>,
    ) -> usize {
        let first = at - axis * draw.between(-0.6, 0.6);
        self.add_joint([one, two], [first, at], PlacedJointKind::Slot(axis))
    }

    fn add_distance(&mut self, one: usize, two: usize, points: [Vec2; 2]) {
        self.add_joint([one, two], points, PlacedJointKind::Distance);
    }

    /// Where a group goes that hangs on these bodies.
    fn random_middle(&self, on: &[usize], draw: &mut Draw<'_>) -> Vec2 {
        let sum = on
            .iter()
            .fold(Vec2::ZERO, |sum, &b| sum + self.bodies[b].center);
        draw.point_near(sum * (1.0 / on.len() as f64), 0.8)
    }

    /// A new body, or three, that an actuator moves.
    pub(super) fn add_actuator(&mut self, step: &GrowthStep) {
        let draw = &mut Draw(step.numbers.iter().cycle());
        let on = step.on[0].index(self.bodies.len());
        let a = self.random_middle(&[on], draw);
        let new = self.add_body(a, draw);
        // Where nothing that moves had mass, all would be rounding.
        self.bodies[new].mass += 0.5;
        match step.kind % 5 {
            0 => {
                self.add_pin(on, new, a);
                self.driven.push(PlacedActuator::Angle([on, new]));
            }
            1 => {
                self.add_pin(on, new, a);
                self.driven.push(PlacedActuator::Angle([0, new]));
            }
            2 => {
                let axis = draw.direction();
                let slide = self.add_slide([on, new], a, axis, draw);
                self.driven.push(PlacedActuator::Travel(slide));
            }
            kind => {
                self.add_pin(on, new, a);
                let along = draw.angle();
                let c = a + Vec2::from_angle(along) * draw.length();
                let across = along + draw.separated(SEPARATION[0], SEPARATION[1]);
                let b = c + Vec2::from_angle(across) * draw.length();
                if kind == 3 {
                    self.driven.push(PlacedActuator::Length([on, new], [b, c]));
                } else {
                    let [barrel, rod] = [b, c].map(|p| self.add_body(p, draw));
                    self.add_pin(on, barrel, b);
                    self.add_pin(new, rod, c);
                    let axis = Vec2::from_angle(across + draw.separated(0.0, TILT));
                    let slide = self.add_slide([barrel, rod], b, axis, draw);
                    self.driven.push(PlacedActuator::Travel(slide));
                }
            }
        }
    }

    /// An Assur group on bodies that are there.
    pub(super) fn add_group(&mut self, step: &GrowthStep) {
        let draw = &mut Draw(step.numbers.iter().cycle());
        let on = step.on.map(|index| index.index(self.bodies.len()));
        match step.kind % 20 {
            0..=6 => self.add_dyad(step.kind % 20, [on[0], on[1]], draw),
            7..=11 => self.add_single(step.kind % 20, [on[0], on[1]], draw),
            12 => self.add_weld(on[0], draw),
            13 | 14 => self.add_gear(on[0], draw),
            15 | 16 => self.add_rolling(step.kind.is_multiple_of(2), [on[0], on[1]], draw),
            17 => self.add_three_body_group(on, draw),
            _ => self.add_ternary(on, draw),
        }
    }

    /// Two bodies held by three joints, turning (R) or sliding (P).
    fn add_dyad(&mut self, kind: u8, [e1, e2]: [usize; 2], draw: &mut Draw<'_>) {
        let c = self.random_middle(&[e1, e2], draw);
        let along = draw.angle();
        let a = c + Vec2::from_angle(along) * draw.length();
        let one = self.add_body((a + c) * 0.5, draw);
        let two = self.add_body(c, draw);
        let tilted = Vec2::from_angle(along + draw.separated(0.0, TILT));
        let across = Vec2::from_angle(along + draw.separated(SEPARATION[0], SEPARATION[1]));
        match kind {
            // RRR, twice as often as the others
            0 | 1 => {
                self.add_pin(e1, one, a);
                self.add_pin(one, two, c);
                self.add_pin(e2, two, c + across * draw.length());
            }
            // RRP
            2 => {
                self.add_pin(e1, one, a);
                self.add_pin(one, two, c);
                self.add_slide([e2, two], c, tilted, draw);
            }
            // RPR
            3 => {
                self.add_pin(e1, one, a);
                self.add_slide([one, two], c, tilted, draw);
                self.add_pin(e2, two, c);
            }
            // PRP
            4 => {
                self.add_slide([e1, one], c, Vec2::from_angle(along), draw);
                self.add_pin(one, two, c);
                self.add_slide([e2, two], c, across, draw);
            }
            // RPP and PPR
            5 => {
                self.add_pin(e1, one, a);
                self.add_slide([one, two], c, Vec2::from_angle(along), draw);
                self.add_slide([e2, two], c, across, draw);
            }
            _ => {
                self.add_slide([e1, one], c, Vec2::from_angle(along), draw);
                self.add_slide([one, two], c, across, draw);
                self.add_pin(e2, two, c);
            }
        }
    }

    /// One body by two rows and one.
    fn add_single(&mut self, kind: u8, [e1, e2]: [usize; 2], draw: &mut Draw<'_>) {
        let c = self.random_middle(&[e1, e2], draw);
        let along = draw.angle();
        let a = c + Vec2::from_angle(along) * draw.length();
        let new = self.add_body((a + c) * 0.5, draw);
        let tilted = Vec2::from_angle(along + draw.separated(0.0, TILT));
        let across = Vec2::from_angle(along + draw.separated(SEPARATION[0], SEPARATION[1]));
        match kind {
            7 => {
                self.add_pin(e1, new, a);
                self.add_slot(e2, new, c, tilted, draw);
            }
            8 => {
                self.add_pin(e1, new, a);
                self.add_slot(new, e2, c, tilted, draw);
            }
            9 => {
                self.add_pin(e1, new, a);
                self.add_distance(e2, new, [c + across * draw.length(), c]);
            }
            10 => {
                self.add_slide([e1, new], a, Vec2::from_angle(along), draw);
                self.add_slot(e2, new, c, across, draw);
            }
            _ => {
                self.add_slide([new, e1], a, Vec2::from_angle(along), draw);
                self.add_slot(new, e2, c, across, draw);
            }
        }
    }

    fn add_weld(&mut self, on: usize, draw: &mut Draw<'_>) {
        let at = self.random_middle(&[on], draw);
        let new = self.add_body(at, draw);
        self.add_joint([on, new], [at; 2], PlacedJointKind::Weld);
    }

    /// A gear on the carrier of another pinned body, which it meshes with. Where nothing is pinned
    /// to the body, a weld.
    fn add_gear(&mut self, carrier: usize, draw: &mut Draw<'_>) {
        let wheel = self.joints.iter().find_map(|joint| match joint.kind {
            PlacedJointKind::Revolute if joint.bodies[0] == carrier => {
                Some((joint.bodies[1], joint.points[0]))
            }
            _ => None,
        });
        let Some((wheel, hub)) = wheel else {
            return self.add_weld(carrier, draw);
        };
        let d = draw.length();
        let at = hub + draw.direction() * d;
        let new = self.add_body(at, draw);
        self.add_pin(carrier, new, at);
        let internal = draw.boolean();
        let first = d * draw.between(0.3, 0.7);
        let radii = if !internal {
            [first, d - first]
        } else if draw.boolean() {
            [first, d + first]
        } else {
            [d + first, first]
        };
        let kind = PlacedJointKind::Gear { radii, internal };
        self.add_joint([wheel, new], [hub, at], kind);
    }

    /// A disc that rolls on a track, held by a slot or by a link with two pins.
    fn add_rolling(&mut self, by_link: bool, [track, e2]: [usize; 2], draw: &mut Draw<'_>) {
        let contact = self.random_middle(&[track, e2], draw);
        let axis = draw.direction();
        let radius = draw.separated(0.2, 0.6);
        let center = contact + axis.perp() * radius;
        let disc = self.add_body(center, draw);
        self.add_joint(
            [track, disc],
            [contact, center],
            PlacedJointKind::Rolling { axis, radius },
        );
        // A point of the disc moves across its line to the contact.
        let along = draw.angle();
        let c = contact + Vec2::from_angle(along) * draw.length();
        if by_link {
            let across = Vec2::from_angle(along + draw.separated(SEPARATION[0], SEPARATION[1]));
            let b = c + across * draw.length();
            let rod = self.add_body((b + c) * 0.5, draw);
            self.add_pin(disc, rod, c);
            self.add_pin(e2, rod, b);
        } else {
            let tilted = Vec2::from_angle(along + draw.separated(0.0, TILT));
            self.add_slot(e2, disc, c, tilted, draw);
        }
    }

    /// By corner of a triangle about a point: the corner, and a direction that passes the point
    /// on the same side as the others do.
    fn corners(middle: Vec2, draw: &mut Draw<'_>) -> [(Vec2, f64); 3] {
        let first = draw.angle();
        let reach = draw.length();
        [0.0, 1.0, 2.0].map(|k| {
            let at = first + k * std::f64::consts::TAU / 3.0 + draw.between(-0.3, 0.3);
            let along = at + std::f64::consts::FRAC_PI_2 + draw.between(-0.6, 0.6);
            (middle + Vec2::from_angle(at) * reach, along)
        })
    }

    /// One body by three links or slots.
    fn add_three_body_group(&mut self, on: [usize; 3], draw: &mut Draw<'_>) {
        let middle = self.random_middle(&on, draw);
        let new = self.add_body(middle, draw);
        for ((c, along), e) in Self::corners(middle, draw).into_iter().zip(on) {
            let along = Vec2::from_angle(along);
            if draw.boolean() {
                self.add_slot(e, new, c, along.perp(), draw);
            } else {
                self.add_distance(e, new, [c + along * draw.length(), c]);
            }
        }
    }

    /// A ternary body on three legs: class III.
    fn add_ternary(&mut self, on: [usize; 3], draw: &mut Draw<'_>) {
        let middle = self.random_middle(&on, draw);
        let plate = self.add_body(middle, draw);
        for ((c, along), e) in Self::corners(middle, draw).into_iter().zip(on) {
            let along = Vec2::from_angle(along);
            let a = c + along * draw.length();
            let link = self.add_body((a + c) * 0.5, draw);
            match draw.between(0.0, 1.0) {
                kind if kind < 0.6 => {
                    self.add_pin(e, link, a);
                    self.add_pin(link, plate, c);
                }
                kind if kind < 0.8 => {
                    self.add_pin(e, link, a);
                    self.add_slide([link, plate], c, along.perp(), draw);
                }
                _ => {
                    self.add_slide([e, link], a, along.perp(), draw);
                    self.add_pin(link, plate, c);
                }
            }
        }
    }

    /// Two bars in one line.
    pub(super) fn add_flat_dyad(&mut self, step: &GrowthStep) {
        let draw = &mut Draw(step.numbers.iter().cycle());
        let on = step.on.map(|index| index.index(self.bodies.len()));
        let c = self.random_middle(&on[..2], draw);
        let along = draw.direction();
        let [a, b] = [draw.length(), -draw.length()].map(|distance| c + along * distance);
        let [one, two] = [a, b].map(|p| self.add_body((p + c) * 0.5, draw));
        self.add_pin(on[0], one, a);
        self.add_pin(one, two, c);
        self.add_pin(on[1], two, b);
    }
}
