//! The mechanism in dense rows: the independent side.
//!
//! No structure is looked for and nothing is compiled: all coordinates of all bodies, all rows,
//! one square matrix. Only where the origins are is changed. Each frame, the ground's too, is
//! moved to the mean of its body's attachments, which the subtraction of nearby numbers does
//! exactly; otherwise a mechanism a kilometre from the origin would be checked by
//! differences of rounded large numbers.

use crate::error::{DenseError, Result};
use crate::inertias::{Inertias, at_angle};
use dwell_geometry::constraint_rows::ConstraintRows;
use dwell_geometry::{ActuatorKind, BodyId, Coordinate, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::Mass;
use dwell_numerics::PiecewiseQuintic;

/// A body in its moved frame.
#[derive(Debug, Clone)]
pub(crate) struct DenseBody {
    /// First of its three columns; `None` for the ground.
    pub(crate) column: Option<usize>,
    /// Mass properties about the moved frame.
    pub(crate) mass: Mass,
    /// A moment of inertia over the body's angle besides.
    pub(crate) varying: Option<PiecewiseQuintic>,
    /// The moved origin in the body's own frame.
    pub(crate) shift: Vec2,
}

impl DenseBody {
    /// Its moment of inertia about its centre of mass at an angle, kg m².
    pub(crate) fn angular_inertia(&self, angle: f64) -> f64 {
        self.mass.inertia + at_angle(self.varying.as_ref(), angle)[0]
    }

    /// I α of its constant moment of inertia and I α + ½ I′ ω² of the varying one, N·m.
    pub(crate) fn inertia_moment(&self, angle: f64, omega: f64, alpha: f64) -> f64 {
        self.mass.inertia * alpha + self.varying_moment(angle, omega, alpha)
    }

    /// I α + ½ I′ ω² of the varying moment of inertia alone, N·m: the rate of no momentum of the body's own.
    pub(crate) fn varying_moment(&self, angle: f64, omega: f64, alpha: f64) -> f64 {
        let [inertia, half_slope] = at_angle(self.varying.as_ref(), angle);
        inertia * alpha + half_slope * omega * omega
    }
}

/// The mechanism, its masses and its rows, all dense, in moved frames.
///
/// Where a method takes a row or a body it is an index into the mechanism's reactions, followed by
/// the actuators, or into its bodies; speeds have as many numbers as there are coordinates.
#[derive(Debug, Clone)]
pub struct DenseMechanism {
    pub(crate) mechanism: Mechanism,
    pub(crate) rows: ConstraintRows,
    pub(crate) bodies: Vec<DenseBody>,
    pub(crate) row_scale: Vec<f64>,
    pub(crate) size: f64,
    /// The rows that are solved: as many as coordinates. What the others say follows from them.
    pub(crate) independent_rows: Vec<usize>,
    /// By row: whether only one multiplier of it balances the forces.
    pub(crate) determinate: Vec<bool>,
}

impl DenseMechanism {
    /// Moves the frames and writes the rows, as many as there are coordinates.
    pub fn new<'m>(mechanism: &Mechanism, inertias: impl Into<Inertias<'m>>) -> Result<Self> {
        let dense = Self::without_rank_check(mechanism, inertias)?;
        let (rows, columns) = (dense.rows.len(), dense.rows.columns());
        if rows == columns {
            Ok(dense)
        } else {
            Err(DenseError::NotSquare { rows, columns })
        }
    }

    /// The same whatever the number of rows: it can be measured, but not closed.
    pub(crate) fn without_rank_check<'m>(
        mechanism: &Mechanism,
        inertias: impl Into<Inertias<'m>>,
    ) -> Result<Self> {
        Self::with_origins(mechanism, inertias.into(), |_, mean| mean)
    }

    /// The same with the origin of each body at another point of it than the mean of its attachments.
    pub(crate) fn with_origins(
        mechanism: &Mechanism,
        inertias: Inertias<'_>,
        origin: impl Fn(usize, Vec2) -> Vec2,
    ) -> Result<Self> {
        let (size, masses) = (mechanism.size(), inertias.masses);
        let mut mechanism = mechanism.clone();
        // References first: what follows indexes by them.
        let columns = ConstraintRows::new(&mechanism)?;
        if masses.len() != mechanism.bodies.len() {
            return Err(DenseError::Masses {
                masses: masses.len(),
                bodies: mechanism.bodies.len(),
            });
        }
        check_axes(&mechanism)?;
        let means = attachment_means(&mut mechanism).into_iter().enumerate();
        let shifts: Vec<Vec2> = means.map(|(b, mean)| origin(b, mean)).collect();
        for_each_attachment(&mut mechanism, |body, point| *point -= shifts[body]);
        let body = |(b, (mass, shift)): (usize, (&Mass, Vec2))| {
            let mut mass = *mass;
            // The centre of nothing does not matter; far away it would cost digits.
            mass.center = match mass.mass {
                0.0 => Vec2::ZERO,
                _ => mass.center - shift,
            };
            let column = columns.column(BodyId(b));
            DenseBody {
                column,
                mass,
                varying: inertias.varying_of(b).filter(|_| column.is_some()),
                shift,
            }
        };
        let bodies = masses.iter().zip(shifts).enumerate().map(body).collect();
        let rows = ConstraintRows::new(&mechanism)?;
        let scale = |&angular: &bool| if angular { size } else { 1.0 };
        Ok(Self {
            mechanism,
            bodies,
            row_scale: rows.angular().iter().map(scale).collect(),
            size,
            independent_rows: (0..rows.len()).collect(),
            determinate: vec![true; rows.len()],
            rows,
        })
    }

    /// The size of the mechanism, m: what a radian is compared with.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Index of the first actuator's row; the rows before it are the reactions.
    pub fn actuator_row(&self) -> usize {
        self.rows.len() - self.mechanism.actuators.len()
    }

    /// The bodies that move, each with its index and the first of its columns.
    pub(crate) fn moving_bodies(&self) -> impl Iterator<Item = (usize, &DenseBody, usize)> {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter_map(|(b, body)| Some((b, body, body.column?)))
    }

    /// The coordinate of the only actuator.
    pub(crate) fn actuator_coordinate(&self) -> Coordinate {
        self.mechanism.actuators[0].coordinate()
    }

    /// Dense coordinates out of the frames of all bodies.
    pub fn coordinates(&self, poses: &[[f64; 3]]) -> Result<Vec<f64>> {
        if poses.len() != self.bodies.len() || poses.iter().flatten().any(|v| !v.is_finite()) {
            return Err(DenseError::InvalidPoses);
        }
        let ground = self.bodies[self.mechanism.ground].shift;
        let mut x = vec![0.0; self.rows.columns()];
        for (b, body, c) in self.moving_bodies() {
            let [at_x, at_y, angle] = poses[b];
            let arm = body.shift.rotate(Vec2::from_angle(angle));
            x[c] = (at_x - ground.x) + arm.x;
            x[c + 1] = (at_y - ground.y) + arm.y;
            x[c + 2] = angle;
        }
        Ok(x)
    }

    /// Dense velocities out of the frames of all bodies and their rates.
    pub(crate) fn velocities(&self, poses: &[[f64; 3]], rates: &[[f64; 3]]) -> Vec<f64> {
        let mut x_dot = vec![0.0; self.rows.columns()];
        for (b, body, c) in self.moving_bodies() {
            let arm = body.shift.rotate(Vec2::from_angle(poses[b][2]));
            let [vx, vy, omega] = rates[b];
            let v = vec2(vx, vy) + arm.perp() * omega;
            x_dot[c..c + 3].copy_from_slice(&[v.x, v.y, omega]);
        }
        x_dot
    }

    /// Largest over smallest singular value of the scaled rows at the coordinates `x`; 1 where there is none.
    pub(crate) fn condition_number(&self, x: &[f64]) -> f64 {
        let values = self.scaled_jacobian(x).singular_values();
        match values.unwrap_or_default()[..] {
            [largest, .., smallest] if smallest > 0.0 => largest / smallest,
            _ => 1.0,
        }
    }

    /// Where a point of the moved frame is, from the ground's moved origin.
    pub(crate) fn frame_point(&self, body: &DenseBody, x: &[f64], point: Vec2) -> Vec2 {
        body.column.map_or(point, |c| {
            vec2(x[c], x[c + 1]) + point.rotate(Vec2::from_angle(x[c + 2]))
        })
    }
}

/// Adds a multiple of a vector to another.
pub(crate) fn add_scaled(to: &mut [f64], factor: f64, more: &[f64]) {
    let both = to.iter_mut().zip(more);
    both.for_each(|(to, more)| *to += factor * more);
}

/// The condition number of the dense scaled rows of a mechanism, those of its joints and actuators, in the
/// configuration with the frames `poses` of all bodies, m and rad: largest over smallest singular value. It
/// says how many roundings a result may be off by. 1 where there is none.
pub fn condition_number(mechanism: &Mechanism, poses: &[[f64; 3]]) -> f64 {
    let masses = vec![Mass::default(); mechanism.bodies.len()];
    let dense = DenseMechanism::without_rank_check(mechanism, &masses);
    let at = |dense: DenseMechanism| Ok(dense.condition_number(&dense.coordinates(poses)?));
    dense.and_then(at).unwrap_or(1.0)
}

/// Any other length than one would scale a reaction silently.
fn check_axes(mechanism: &Mechanism) -> Result<()> {
    for (joint, described) in mechanism.joints.iter().enumerate() {
        let axes = match described.kind {
            JointKind::Prismatic { axes } => axes,
            JointKind::Slot { axis }
            | JointKind::Rack { axis, .. }
            | JointKind::Rolling { axis, .. } => [axis; 2],
            JointKind::Revolute
            | JointKind::Weld { .. }
            | JointKind::Gear { .. }
            | JointKind::Distance { .. }
            | JointKind::Coupling(_) => continue,
        };
        for length in axes.map(Vec2::norm) {
            if length.is_nan() || (length - 1.0).abs() > 1e-12 {
                return Err(DenseError::AxisNotUnit { joint, length });
            }
        }
    }
    Ok(())
}

/// Every point of the mechanism that is given in a body's frame, with the body.
pub(crate) fn for_each_attachment(mechanism: &mut Mechanism, mut f: impl FnMut(usize, &mut Vec2)) {
    let mut pair = |bodies: [BodyId; 2], points: &mut [Vec2; 2]| {
        for (body, point) in bodies.into_iter().zip(points) {
            f(body.0, point);
        }
    };
    for joint in &mut mechanism.joints {
        match joint.kind {
            // A coupling is between coordinates: the points of its joint have no meaning.
            JointKind::Coupling(_) => {}
            JointKind::Revolute
            | JointKind::Prismatic { .. }
            | JointKind::Slot { .. }
            | JointKind::Weld { .. }
            | JointKind::Gear { .. }
            | JointKind::Rack { .. }
            | JointKind::Rolling { .. }
            | JointKind::Distance { .. } => pair(joint.bodies, &mut joint.points),
        }
    }
    for relation in &mut mechanism.couplings {
        for coordinate in [&mut relation.dependent, &mut relation.independent] {
            if let Coordinate::Length { bodies, points } = coordinate
                && bodies.iter().all(|b| b.0 < mechanism.bodies.len())
            {
                pair(*bodies, points);
            }
        }
    }
    for actuator in &mut mechanism.actuators {
        if let ActuatorKind::Length(points) = &mut actuator.kind {
            pair(actuator.bodies, points);
        }
    }
}

/// The mean of each body's attachments in its own frame.
fn attachment_means(mechanism: &mut Mechanism) -> Vec<Vec2> {
    let mut sums = vec![(Vec2::ZERO, 0_u32); mechanism.bodies.len()];
    for_each_attachment(mechanism, |body, point| {
        sums[body].0 += *point;
        sums[body].1 += 1;
    });
    let mean = |(sum, count)| sum * (1.0 / f64::from(u32::max(count, 1)));
    sums.into_iter().map(mean).collect()
}
