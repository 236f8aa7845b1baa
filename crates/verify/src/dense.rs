//! The mechanism in dense rows: the independent side.
//!
//! No structure is looked for and nothing is compiled: all coordinates of all bodies, all rows,
//! one square matrix. Only where the origins are is changed. Each frame, the ground's too, is
//! moved to the mean of its body's attachments, which the subtraction of nearby numbers does
//! exactly; otherwise a mechanism that stands a kilometre from the origin would be judged by
//! differences of rounded large numbers.

use crate::closing::Closed;
use crate::rank::rank;
use dwell_geometry::rows::{Rows, RowsError};
use dwell_geometry::{BodyId, Coordinate, Drive, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::Mass;

/// A row with less than this beside the others depends on them: as for singular values.
const DEPENDENT: f64 = 1e-9;

/// Why the dense side cannot answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DenseError {
    /// The mechanism refers to something that is not there.
    #[error(transparent)]
    Rows(#[from] RowsError),
    /// As many rows as coordinates are needed.
    #[error(
        "{rows} constraint and actuator rows for {columns} coordinates: the mechanism is not determinate"
    )]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of coordinates.
        columns: usize,
    },
    /// One mass per body is needed.
    #[error("{masses} masses for {bodies} bodies")]
    Masses {
        /// Number of masses.
        masses: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// An axis is not a unit vector.
    #[error("an axis of joint {joint} has length {length}, not 1")]
    Axis {
        /// Index of the joint.
        joint: usize,
        /// Its length.
        length: f64,
    },
    /// The truths of the reduced model are those of one degree of freedom.
    #[error("{actuators} actuators: the reduced model is that of one")]
    Actuators {
        /// Number of actuators.
        actuators: usize,
    },
    /// A given number is not finite, or there are too few of them.
    #[error("the poses to start from are incomplete or not finite")]
    Start,
    /// The rows could not be met.
    #[error(
        "the rows do not close: after {steps} Newton steps the last one moved by {moved:.1e} of the size"
    )]
    NotClosed {
        /// Newton steps done.
        steps: usize,
        /// Size of the last one, relative to the mechanism's size.
        moved: f64,
    },
    /// Rows that repeat others are not met where these are.
    #[error("rows that repeat others stay open by {open:.1e} of the size")]
    Open {
        /// The largest residual, relative to the mechanism's size.
        open: f64,
    },
    /// They were met on the other side of a dead point.
    #[error("the rows close on another assembly branch")]
    OtherBranch,
    /// The rows depend on each other in this configuration.
    #[error("the rows are dependent here: smallest pivot {pivot:.1e} of the largest")]
    Singular {
        /// Smallest pivot relative to the largest.
        pivot: f64,
    },
}

/// A body in its moved frame.
#[derive(Debug, Clone)]
pub(crate) struct DenseBody {
    /// First of its three columns; `None` for the ground.
    pub(crate) column: Option<usize>,
    /// Mass properties about the moved frame.
    pub(crate) mass: Mass,
    /// The moved origin in the body's own frame.
    pub(crate) shift: Vec2,
}

/// The mechanism, its masses and its rows, all dense, in moved frames.
///
/// Where a method takes a row or a body it is an index into the mechanism's reactions, followed by
/// the actuators, or into its bodies; speeds have as many numbers as there are coordinates.
#[derive(Debug, Clone)]
pub struct Dense {
    pub(crate) mechanism: Mechanism,
    pub(crate) rows: Rows,
    pub(crate) bodies: Vec<DenseBody>,
    pub(crate) row_scale: Vec<f64>,
    pub(crate) size: f64,
    /// The rows that are solved: as many as coordinates. What the others say follows from them.
    pub(crate) kept: Vec<usize>,
    /// By row: whether only one multiplier of it balances the forces.
    pub(crate) unique: Vec<bool>,
}

impl Dense {
    /// Moves the frames and writes the rows, as many as there are coordinates.
    pub fn new(mechanism: &Mechanism, masses: &[Mass]) -> Result<Self, DenseError> {
        let dense = Self::of_any_shape(mechanism, masses)?;
        let (rows, columns) = (dense.rows.len(), dense.rows.columns());
        if rows == columns {
            Ok(dense)
        } else {
            Err(DenseError::NotSquare { rows, columns })
        }
    }

    /// The same where joints repeat each other: a largest set of independent rows is solved, found
    /// in the configuration with the frames `poses` of all bodies.
    pub(crate) fn repeated(
        mechanism: &Mechanism,
        masses: &[Mass],
        poses: &[[f64; 3]],
    ) -> Result<Self, DenseError> {
        let mut dense = Self::of_any_shape(mechanism, masses)?;
        let (rows, columns) = (dense.rows.len(), dense.rows.columns());
        if rows == columns {
            return Ok(dense);
        }
        let kept = dense.independent(poses)?;
        if kept.len() != columns {
            return Err(DenseError::NotSquare { rows, columns });
        }
        dense.kept = kept;
        for row in rank(mechanism, poses)?.driven.dependent {
            dense.unique[row] = false;
        }
        Ok(dense)
    }

    /// The same with its gears meshed as they stand there.
    pub(crate) fn meshed(
        mechanism: &Mechanism,
        masses: &[Mass],
        poses: &[[f64; 3]],
    ) -> Result<Self, DenseError> {
        let mut dense = Self::repeated(mechanism, masses, poses)?;
        dense.mesh(poses)?;
        Ok(dense)
    }

    /// Rows of which none is made up of the others, the actuators' among them; by Gram and Schmidt,
    /// always with the one that is farthest from those before.
    fn independent(&self, poses: &[[f64; 3]]) -> Result<Vec<usize>, DenseError> {
        let matrix = self.scaled_jacobian(&self.start(poses)?);
        let rows = 0..matrix.nrows();
        let mut left: Vec<Vec<f64>> = rows
            .map(|i| (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect())
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut kept: Vec<usize> = Vec::new();
        while kept.len() < matrix.ncols() {
            let driven = (self.actuator_row()..left.len()).find(|row| !kept.contains(row));
            let farthest = || {
                let size = |row: &usize| dot(&left[*row], &left[*row]);
                let others = (0..left.len()).filter(|row| !kept.contains(row));
                others.max_by(|a, b| size(a).total_cmp(&size(b)))
            };
            let Some(next) = driven.or_else(farthest) else {
                break;
            };
            let length = dot(&left[next], &left[next]).sqrt();
            // What is left of a row of order one is rounding.
            if length.is_nan() || length < DEPENDENT {
                break;
            }
            let unit: Vec<f64> = left[next].iter().map(|v| v / length).collect();
            for row in &mut left {
                let part = dot(row, &unit);
                row.iter_mut().zip(&unit).for_each(|(v, u)| *v -= part * u);
            }
            kept.push(next);
        }
        kept.sort_unstable();
        Ok(kept)
    }

    /// The same whatever the number of rows: it can be measured, but not closed.
    pub(crate) fn of_any_shape(mechanism: &Mechanism, masses: &[Mass]) -> Result<Self, DenseError> {
        let mut mechanism = mechanism.clone();
        // References first: what follows indexes by them.
        let columns = Rows::new(&mechanism)?;
        if masses.len() != mechanism.bodies.len() {
            return Err(DenseError::Masses {
                masses: masses.len(),
                bodies: mechanism.bodies.len(),
            });
        }
        check_axes(&mechanism)?;
        let shifts = attachment_means(&mut mechanism);
        each_attachment(&mut mechanism, |body, point| *point -= shifts[body]);
        let bodies: Vec<_> = masses
            .iter()
            .zip(shifts)
            .enumerate()
            .map(|(b, (mass, shift))| DenseBody {
                column: columns.column(BodyId(b)),
                mass: Mass {
                    // Where nothing has no mass does not matter; far away it would cost digits.
                    center: if mass.mass == 0.0 {
                        Vec2::ZERO
                    } else {
                        mass.center - shift
                    },
                    ..*mass
                },
                shift,
            })
            .collect();
        let size = size(&mut mechanism, &bodies);
        let rows = Rows::new(&mechanism)?;
        let (kept, unique) = ((0..rows.len()).collect(), vec![true; rows.len()]);
        let row_scale = rows
            .angular()
            .iter()
            .map(|&angular| if angular { size } else { 1.0 })
            .collect();
        Ok(Self {
            mechanism,
            rows,
            bodies,
            row_scale,
            size,
            kept,
            unique,
        })
    }

    /// Meshes the gears as they stand in the frames of all bodies: there their rows vanish.
    pub fn mesh(&mut self, poses: &[[f64; 3]]) -> Result<(), DenseError> {
        let x = self.start(poses)?;
        self.rows.mesh(&x);
        Ok(())
    }

    /// The largest distance of an attachment from the middle of its body, or the largest radius,
    /// m: what a radian is compared with.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Index of the first actuator's row; the rows before it are the reactions.
    pub fn actuator_row(&self) -> usize {
        self.rows.len() - self.mechanism.actuators.len()
    }

    /// Whether the first actuator's coordinate is an angle.
    pub(crate) fn drives_an_angle(&self) -> bool {
        let first = self.mechanism.actuators.first();
        first.is_none_or(|a| a.coordinate().is_angle())
    }

    /// Dense coordinates out of the frames of all bodies.
    pub fn start(&self, poses: &[[f64; 3]]) -> Result<Vec<f64>, DenseError> {
        if poses.len() != self.bodies.len() || poses.iter().flatten().any(|v| !v.is_finite()) {
            return Err(DenseError::Start);
        }
        let ground = self.bodies[self.mechanism.ground].shift;
        let mut x = vec![0.0; self.rows.columns()];
        for (body, pose) in self.bodies.iter().zip(poses) {
            if let Some(c) = body.column {
                let arm = body.shift.turn(Vec2::from_angle(pose[2]));
                x[c] = (pose[0] - ground.x) + arm.x;
                x[c + 1] = (pose[1] - ground.y) + arm.y;
                x[c + 2] = pose[2];
            }
        }
        Ok(x)
    }

    /// Largest over smallest singular value of the scaled rows at the coordinates `x`; 1 where there is none.
    pub(crate) fn condition(&self, x: &[f64]) -> f64 {
        let values = self.scaled_jacobian(x).singular_values();
        let values = values.unwrap_or_default();
        match (values.first(), values.last()) {
            (Some(largest), Some(smallest)) if *smallest > 0.0 => largest / smallest,
            _ => 1.0,
        }
    }

    /// Where a point given in a body's own frame is in the plane, m.
    pub fn point(&self, closed: &Closed, body: usize, point: Vec2) -> Vec2 {
        let ground = self.bodies[self.mechanism.ground].shift;
        let of = &self.bodies[body];
        ground + self.placed(of, &closed.x, point - of.shift)
    }

    /// Where a point of the moved frame is, from the ground's moved origin.
    pub(crate) fn placed(&self, body: &DenseBody, x: &[f64], point: Vec2) -> Vec2 {
        body.column.map_or(point, |c| {
            vec2(x[c], x[c + 1]) + point.turn(Vec2::from_angle(x[c + 2]))
        })
    }
}

/// The condition number of the dense scaled rows of a mechanism, those of its joints and actuators, in the
/// configuration with the frames `poses` of all bodies, m and rad: largest over smallest singular value. It
/// says how many roundings a result may be off by. 1 where there is none.
pub fn condition(mechanism: &Mechanism, poses: &[[f64; 3]]) -> f64 {
    let masses = vec![Mass::default(); mechanism.bodies.len()];
    let dense = Dense::of_any_shape(mechanism, &masses);
    let at = |dense: Dense| Ok(dense.condition(&dense.start(poses)?));
    dense.and_then(at).unwrap_or(1.0)
}

/// Any other length than one would scale a reaction silently.
fn check_axes(mechanism: &Mechanism) -> Result<(), DenseError> {
    for (joint, described) in mechanism.joints.iter().enumerate() {
        let axes = match described.kind {
            JointKind::Prismatic { axes } => axes,
            JointKind::Slot { axis }
            | JointKind::Rack { axis, .. }
            | JointKind::Rolling { axis, .. } => [axis; 2],
            _ => continue,
        };
        for length in axes.map(Vec2::norm) {
            if length.is_nan() || (length - 1.0).abs() > 1e-12 {
                return Err(DenseError::Axis { joint, length });
            }
        }
    }
    Ok(())
}

/// Every point of the mechanism that is given in a body's frame, with the body.
pub(crate) fn each_attachment(mechanism: &mut Mechanism, mut visit: impl FnMut(usize, &mut Vec2)) {
    let mut pair = |bodies: [BodyId; 2], points: &mut [Vec2; 2]| {
        for (body, point) in bodies.into_iter().zip(points) {
            visit(body.0, point);
        }
    };
    for joint in &mut mechanism.joints {
        // A relation is between coordinates: where its joint's points are means nothing.
        if !matches!(joint.kind, JointKind::Relation(_)) {
            pair(joint.bodies, &mut joint.points);
        }
    }
    for relation in &mut mechanism.relations {
        for coordinate in [&mut relation.of, &mut relation.by] {
            if let Coordinate::Length { bodies, points } = coordinate
                && bodies.iter().all(|b| b.0 < mechanism.bodies.len())
            {
                pair(*bodies, points);
            }
        }
    }
    for actuator in &mut mechanism.actuators {
        if let Drive::Length(points) = &mut actuator.drive {
            pair(actuator.bodies, points);
        }
    }
}

/// The mean of each body's attachments in its own frame.
fn attachment_means(mechanism: &mut Mechanism) -> Vec<Vec2> {
    let mut sums = vec![(Vec2::ZERO, 0_u32); mechanism.bodies.len()];
    each_attachment(mechanism, |body, point| {
        sums[body].0 += *point;
        sums[body].1 += 1;
    });
    sums.into_iter()
        .map(|(sum, count)| sum * (1.0 / f64::from(count.max(1))))
        .collect()
}

fn size(mechanism: &mut Mechanism, bodies: &[DenseBody]) -> f64 {
    let mut arms: f64 = 0.0;
    each_attachment(mechanism, |_, point| arms = arms.max(point.norm()));
    for joint in &mechanism.joints {
        arms = match joint.kind {
            JointKind::Gear { radii, .. } => arms.max(radii[0]).max(radii[1]),
            JointKind::Rack { radius, .. } | JointKind::Rolling { radius, .. } => {
                arms.max(radius.abs())
            }
            JointKind::Distance { length } => arms.max(length),
            _ => arms,
        };
    }
    // A single link on a pin has no arms; then its centre of mass gives the size.
    let centers = bodies.iter().map(|b| b.mass.center.norm());
    [arms, centers.fold(0.0, f64::max)]
        .into_iter()
        .find(|&s| s > 0.0)
        .unwrap_or(1.0)
}
