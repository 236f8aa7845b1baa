//! The rank of the dense rows: degrees of freedom and redundant constraints.
//!
//! With the rows scaled to order one, A = U Σ Vᵀ, and r singular values above zero:
//!
//! ```text
//! A v = 0     the last n − r columns of V: motions that every row allows     (1)
//! uᵀ A = 0    the last m − r columns of U: dependent rows                    (2)
//! ```
//!
//! A body that no motion of (1) moves is held; a row with no part in any of (2) has a determinate
//! multiplier. Both follow from the whole null space, so that they do not depend on which vectors
//! span it.

use crate::dense::DenseMechanism;
use crate::error::{DenseError, Result};
use crate::pose::Pose;
use dwell_geometry::{BodyId, Mechanism};
use dwell_kinetostatics::Mass;
use faer::MatRef;

/// A singular value this small against the largest is zero. A configuration is given, or closed,
/// to 1e-13 and better; a small angle of 1e-8 rad is a rank loss to every purpose.
const ZERO_SINGULAR_VALUE: f64 = 1e-9;
/// A body or row has a part in a null space of orthonormal vectors from here on.
const NULL_SPACE_PART: f64 = 1e-6;

/// The degrees of freedom that the rows of one kind leave, and the redundant rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Rank {
    /// Number of rows.
    pub rows: usize,
    /// Number of coordinates: three per moving body.
    pub columns: usize,
    /// Number of independent rows.
    pub rank: usize,
    /// The singular values of the dimensionless rows, falling.
    pub singular_values: Vec<f64>,
    /// Bodies that still move when every row is held.
    pub movable_bodies: Vec<BodyId>,
    /// Rows that depend on others: indices into [`Mechanism::reactions`], followed by the actuators.
    pub dependent_rows: Vec<usize>,
}

impl Rank {
    /// Independent motions left.
    pub fn degrees_of_freedom(&self) -> usize {
        self.columns - self.rank
    }

    /// Rows too many.
    pub fn redundant_count(&self) -> usize {
        self.rows - self.rank
    }
}

/// The ranks of the joints' rows alone, and of these with the actuators'.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranks {
    /// The joints.
    pub joints: Rank,
    /// The joints and the actuators.
    pub with_actuators: Rank,
}

/// The ranks in the configuration with the frames `poses` of all bodies, in m and rad.
///
/// A rank is that of this configuration. A rank that is also lost in a second, generic configuration is lost
/// everywhere, because of the joints or the dimensions of the mechanism.
///
/// # Errors
/// [`DenseError`] when the mechanism refers to something that is not there, or the poses are
/// incomplete or not finite. The poses are not corrected: joints that do not close there are not an error.
pub fn rank(mechanism: &Mechanism, poses: &[[f64; 3]]) -> Result<Ranks> {
    let masses = vec![Mass::default(); mechanism.bodies.len()];
    let dense = DenseMechanism::without_rank_check(mechanism, &masses)?;
    let all = dense.scaled_jacobian(&dense.frames(poses)?);
    if !all.is_all_finite() {
        // Two points in one place have no direction.
        return Err(DenseError::Singular(f64::NAN));
    }
    let joints = all.subrows(0, dense.actuator_row());
    Ok(Ranks {
        joints: rank_of(&dense, joints)?,
        with_actuators: rank_of(&dense, all.as_ref())?,
    })
}

impl DenseMechanism {
    /// The rows of joints and actuators that depend on others at these poses of the moved frames.
    pub(crate) fn dependent_rows(&self, frames: &[Pose]) -> Result<Vec<usize>> {
        let all = self.scaled_jacobian(frames);
        Ok(rank_of(self, all.as_ref())?.dependent_rows)
    }
}

fn rank_of(dense: &DenseMechanism, matrix: MatRef<'_, f64>) -> Result<Rank> {
    let (rows, columns) = matrix.shape();
    let svd = matrix.svd().map_err(|_| DenseError::Singular(f64::NAN))?;
    let singular_values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let largest = singular_values.first().copied().unwrap_or(0.0);
    let is_zero = |&&s: &&f64| s <= ZERO_SINGULAR_VALUE * largest;
    let rank = singular_values.len() - singular_values.iter().filter(is_zero).count();
    // What some rows have in the null space: the square sum of their entries in the columns from `rank` on.
    let in_null_space = |vectors: MatRef<'_, f64>, rows: std::ops::Range<usize>| {
        let square = |i: usize, j: usize| vectors[(i, j)] * vectors[(i, j)];
        let row = |i| (rank..vectors.ncols()).map(|j| square(i, j)).sum::<f64>();
        rows.map(row).sum::<f64>() > NULL_SPACE_PART * NULL_SPACE_PART
    };
    let movable = |&b: &usize| in_null_space(svd.V(), dense.bodies[b].columns.range());
    let dependent = |&k: &usize| in_null_space(svd.U(), k..k + 1);
    let bodies = 0..dense.bodies.len();
    Ok(Rank {
        rows,
        columns,
        rank,
        movable_bodies: bodies.filter(movable).map(BodyId).collect(),
        dependent_rows: (0..rows).filter(dependent).collect(),
        singular_values,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_geometry::{Actuator, Body, Joint, Vec2, vec2};

    fn pin(bodies: [usize; 2], points: [Vec2; 2]) -> Joint {
        Joint::revolute("pin", bodies, points)
    }

    fn bars(count: usize, joints: Vec<Joint>) -> Mechanism {
        Mechanism {
            bodies: (0..=count).map(|b| Body::named(b.to_string())).collect(),
            joints,
            ..Mechanism::default()
        }
    }

    /// A table on three parallel legs of equal length still moves, with one row too many; body 5
    /// hangs on it by a pin and swings.
    fn table() -> (Mechanism, Vec<[f64; 3]>) {
        let mut joints = vec![];
        for (leg, x) in [(1, 1.0), (2, 2.0), (3, 3.0)] {
            joints.push(pin([0, leg], [vec2(x, 0.0), Vec2::ZERO]));
            joints.push(pin([leg, 4], [vec2(0.0, 2.0), vec2(x, 0.0)]));
        }
        joints.push(pin([4, 5], [vec2(0.5, 0.5), vec2(0.1, -0.4)]));
        let tilt: f64 = -0.3;
        let up = vec2(0.0, 2.0).rotate(Vec2::from_angle(tilt));
        let mut poses = vec![[0.0; 3]];
        poses.extend([1.0, 2.0, 3.0].map(|x| [x, 0.0, tilt]));
        poses.push([up.x, up.y, 0.0]);
        poses.push([up.x + 0.4, up.y + 0.9, 0.0]);
        (bars(5, joints), poses)
    }

    #[test]
    fn a_third_leg_is_one_row_too_many() {
        let (mechanism, poses) = table();
        let Ranks {
            joints,
            with_actuators,
        } = rank(&mechanism, &poses).unwrap();
        assert_eq!(joints, with_actuators);
        assert_eq!((joints.rows, joints.columns), (14, 15));
        assert_eq!(
            (joints.degrees_of_freedom(), joints.redundant_count()),
            (2, 1)
        );
        assert_eq!(joints.movable_bodies, [1, 2, 3, 4, 5].map(BodyId));
        // All forces of the legs are in doubt, those of the hanging body (rows 12 and 13) are not.
        assert_eq!(joints.dependent_rows, (0..12).collect::<Vec<_>>());
    }

    #[test]
    fn a_drive_holds_what_it_reaches() {
        let (mut mechanism, poses) = table();
        mechanism.actuators.push(Actuator::angle("lean", [0, 1]));
        let Ranks {
            joints,
            with_actuators,
        } = rank(&mechanism, &poses).unwrap();
        assert_eq!(
            (
                joints.degrees_of_freedom(),
                with_actuators.degrees_of_freedom()
            ),
            (2, 1)
        );
        assert_eq!(with_actuators.movable_bodies, [BodyId(5)]);
        // A drive between parallel legs drives nothing, and says what they say already.
        mechanism.actuators[0].bodies[0] = BodyId(2);
        let Ranks {
            with_actuators: driven,
            ..
        } = rank(&mechanism, &poses).unwrap();
        assert_eq!(
            (driven.degrees_of_freedom(), driven.redundant_count()),
            (2, 2)
        );
        assert!(driven.dependent_rows.contains(&14));
    }

    #[test]
    fn what_has_no_rows_is_free() {
        let Ranks { joints, .. } = rank(&bars(2, vec![]), &[[0.0; 3]; 3]).unwrap();
        assert_eq!((joints.rank, joints.degrees_of_freedom()), (0, 6));
        assert_eq!(joints.movable_bodies, [BodyId(1), BodyId(2)]);
        let Ranks { joints, .. } = rank(&bars(0, vec![]), &[[0.0; 3]]).unwrap();
        assert_eq!((joints.rank, joints.degrees_of_freedom()), (0, 0));
        assert!(rank(&bars(1, vec![]), &[[0.0; 3]]).is_err());
    }
}
