//! A plan whose dimensions are numbers of another type, so that an evaluation depends on them, and positions from known solutions.

use super::closure::{Closure, RowKind, rows_of};
use super::coordinate::Coordinate;
use super::frames::Frame;
use super::joint_kinds::JointKind;
use super::mechanism::{JointNumbers, Mechanism};
use super::plan::{Plan, Pose};
use super::planes::rows_along;
use super::tree::{Driver, FreedomKind, Link, Tree};
use super::vector::{Rotation, vec3};
use crate::error::PositionError;
use dwell_numerics::{Constant, Lift};

impl Link {
    fn lifted<C: Constant>(&self) -> Link<C> {
        Link {
            body: self.body,
            parent: self.parent,
            joint: self.joint,
            sign: self.sign,
            on_parent: Frame::default(),
            steps: self.steps.clone(),
            freedoms: self.freedoms.clone(),
        }
    }
}

impl Tree {
    fn with_numbers<C: Constant>(&self, joints: &[JointNumbers<C>]) -> Tree<C> {
        let freedom = |kind: &FreedomKind| match *kind {
            FreedomKind::Turn => FreedomKind::Turn,
            FreedomKind::Slide => FreedomKind::Slide,
            FreedomKind::Screw(pitch) => FreedomKind::Screw(C::from_f64(pitch)),
            FreedomKind::BallTurn => FreedomKind::BallTurn,
            FreedomKind::Length => FreedomKind::Length,
        };
        let mut tree = Tree {
            links: self.links.iter().map(Link::lifted).collect(),
            link_of: self.link_of.clone(),
            internal: vec![Frame::default(); self.internal.len()],
            placed_at: self.placed_at.clone(),
            freedoms: self.freedoms.iter().map(freedom).collect(),
            balls: self.balls,
            closures: self.closures.clone(),
            driven_lengths: self.driven_lengths.clone(),
        };
        tree.set_numbers(joints);
        tree
    }
}

impl Closure {
    /// The closure with the numbers of its joint, which has this kind, in the frames of a tree. The ratios of teeth are still those of
    /// this closure.
    fn with_numbers<C: Constant>(
        &self,
        tree: &Tree<C>,
        joint: Option<(JointKind, JointNumbers<C>)>,
    ) -> Option<Closure<C>> {
        let sides = joint.map(|(_, numbers)| {
            [0, 1].map(|k| numbers.sides[k].in_frame(&tree.internal[self.on[k]]))
        });
        let kinds = match (&self.kinds[..], joint, sides) {
            (&[RowKind::Driven(freedom)], ..) => vec![RowKind::Driven(freedom)],
            (&[RowKind::NoSpin(axis)], ..) => vec![RowKind::NoSpin(axis.cast())],
            (_, Some((kind, numbers)), Some(sides)) => match self.plane {
                Some(normals) => rows_along(kind, numbers.number, sides, normals)?,
                None => rows_of(kind, numbers.number, &sides)?,
            },
            _ => return None,
        };
        Some(Closure {
            joint: self.joint,
            bodies: self.bodies,
            on: self.on,
            points: sides.map_or_else(
                || self.points.map(|point| point.cast()),
                |sides| sides.map(|side| side.point),
            ),
            ratios: self.ratios.iter().map(|&r| C::from_f64(r)).collect(),
            kinds,
            coupled: self
                .coupled
                .as_ref()
                .map(|of| Box::new(of.with_numbers(tree))),
            plane: self.plane,
            rows: self.rows.clone(),
            links: self.links.clone(),
            path: self.path.clone(),
            unmoved: self.unmoved.clone(),
            entries: self.entries,
        })
    }
}

impl Plan {
    /// The numbers of the joints of a mechanism and of those that were added to it, with their kinds.
    fn joints_with_added<C: Constant>(
        &self,
        mechanism: &Mechanism,
        joints: &[JointNumbers<C>],
    ) -> Option<(Vec<JointNumbers<C>>, Vec<JointKind>)> {
        let mut joints = joints.to_vec();
        let mut kinds: Vec<JointKind> = mechanism.joints.iter().map(|joint| joint.kind).collect();
        // The points of coupled distances are no numbers of joints.
        if joints.len() != kinds.len() || self.measured.iter().any(Option::is_some) {
            return None;
        }
        // A coupling acts along the axis of its dependent coordinate.
        for (j, joint) in mechanism.joints.iter().enumerate() {
            if let JointKind::Coupling { index, .. } = joint.kind
                && let Coordinate::Angle(of) | Coordinate::Travel(of) =
                    mechanism.couplings.get(index)?.dependent
            {
                joints[j].sides = joints.get(of.0)?.sides;
            }
        }
        for joint in &self.split {
            let sides = [joints[joint.0].sides[1]; 2];
            joints.push(JointNumbers {
                sides,
                number: C::from_f64(0.0),
            });
            kinds.push(JointKind::Weld);
        }
        Some((joints, kinds))
    }

    /// The plan of a mechanism, from which this one was compiled, with these numbers of its joints in another type. Its structure, its
    /// groups, the directions of its planes, and its stored poses stay.
    pub fn with_numbers<C: Constant + Lift<C>>(
        &self,
        mechanism: &Mechanism,
        joints: &[JointNumbers<C>],
    ) -> Option<Plan<C>> {
        let (joints, kinds) = self.joints_with_added(mechanism, joints)?;
        let tree = self.tree.with_numbers(&joints);
        let closure = |closure: &Closure| {
            let of_joint = closure.joint.map(|joint| (kinds[joint.0], joints[joint.0]));
            closure.with_numbers(&tree, of_joint)
        };
        let closures: Option<Vec<Closure<C>>> = self.closures.iter().map(closure).collect();
        let actuators = mechanism.actuators.iter();
        let drivers: Option<Vec<Driver<C>>> = actuators.map(|a| tree.driven(a.kind)).collect();
        let mut plan = Plan {
            ground: self.ground,
            size: self.size,
            has_planes: self.has_planes,
            drivers: drivers?,
            closures: closures?,
            tree,
            joint_places: self.joint_places.clone(),
            groups: self.groups.clone(),
            first_links: self.first_links.clone(),
            last_links: self.last_links.clone(),
            split: self.split.clone(),
            measured: self.measured.clone(),
            has_tables: self.has_tables,
            start: self.start.clone(),
            predictions: self.predictions.clone(),
            range: self.range,
            repetition: self.repetition,
            range_ends: self.range_ends,
            assembly_q: self.assembly_q.clone(),
            mobility: self.mobility.clone(),
            closure_angles: self.closure_angles.clone(),
            freedom_gains: self.freedom_gains.clone(),
            revolutions: self.revolutions.clone(),
            geared: self.geared.clone(),
            change_points: self.change_points.clone(),
        };
        plan.align_rods();
        plan.measure_teeth();
        Some(plan)
    }

    /// The unknowns in a pose: by freedom its coordinate, rad or m, then by ball the columns of its rotation.
    pub fn solution(&self, pose: &Pose) -> Vec<f64> {
        let balls = pose.balls.iter().flat_map(|ball| ball.columns);
        let balls = balls.flat_map(|column| [column.x, column.y, column.z]);
        pose.coordinates.iter().copied().chain(balls).collect()
    }
}

impl<C: Constant> Plan<C> {
    /// Sets the axis of the row that holds the spin of each rod to the line of its balls.
    fn align_rods(&mut self) {
        for rod in self.groups.iter().filter_map(|group| group.rod.as_ref()) {
            let (spin, arm) = rod.spin_and_arm(&self.closures);
            if let RowKind::NoSpin(axis) = &mut self.closures[spin].kinds[0] {
                let sense = axis.values().dot(arm.values()).signum();
                *axis = arm.normalised().scaled(C::from_f64(sense));
            }
        }
    }

    /// Sets the travels of teeth for a unit of each freedom, which no coordinate changes.
    fn measure_teeth(&mut self)
    where
        C: Lift<C>,
    {
        let is_gear = |closure: &Closure<C>| matches!(closure.kinds[..], [RowKind::Mesh(_)]);
        if !self.closures.iter().any(is_gear) {
            return;
        }
        let mut pose = self.pose::<C>();
        let links: Vec<usize> = (0..self.tree.links.len()).collect();
        self.place(&links, &mut pose);
        for group in &self.groups {
            self.fill_rows(group, &mut pose);
        }
        for closure in self.closures.iter_mut().filter(|closure| is_gear(closure)) {
            let entries = &pose.entries[closure.entries..][..closure.path.len()];
            closure.ratios.copy_from_slice(entries);
        }
    }

    /// The pose at these coordinates, rad or m, at which the unknowns have the values of [`Plan::solution`]: no decision depends on
    /// iterations, and one step of Newton's method, u − J⁻¹ f(u), has the derivatives of the solution.
    ///
    /// # Errors
    /// [`PositionError`] where a group is singular.
    pub fn positions_at_solution<T: Lift<C>>(
        &self,
        q: &[T],
        solution: &[T],
        pose: &mut Pose<T>,
    ) -> Result<(), PositionError> {
        let (coordinates, balls) = solution.split_at(pose.coordinates.len());
        pose.coordinates.copy_from_slice(coordinates);
        for (ball, numbers) in pose.balls.iter_mut().zip(balls.chunks_exact(9)) {
            let column = |k: usize| vec3(numbers[k], numbers[k + 1], numbers[k + 2]);
            *ball = Rotation {
                columns: [column(0), column(3), column(6)],
            };
        }
        for (driver, &q) in self.drivers.iter().zip(q) {
            pose.coordinates[driver.freedom] = q * T::lift(driver.factor);
        }
        self.place(&self.first_links, pose);
        for (g, group) in self.groups.iter().enumerate() {
            let singular = |relative_determinant: f64| PositionError::Singular {
                group: g,
                q: q.first().map_or(0.0, |q| q.value()),
                relative_determinant,
            };
            self.place(&group.links, pose);
            self.fill_rows(group, pose);
            let outcome = self.factor(group, pose);
            if outcome.pivot_ratio.is_nan() || outcome.pivot_ratio == 0.0 {
                return Err(singular(0.0));
            }
            self.newton_step(group, pose);
            self.place(&group.links, pose);
            if !self.factor_closed(group, pose) {
                return Err(singular(outcome.pivot_ratio));
            }
        }
        self.place(&self.last_links, pose);
        Ok(())
    }
}
