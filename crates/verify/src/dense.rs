//! The mechanism in dense rows: the independent side.
//!
//! No structure is analysed and nothing is compiled: all coordinates of all bodies, all rows, one square matrix. Only
//! the origins of the frames are changed. Each frame, the ground's too, is moved to the mean of its body's attachments,
//! which the subtraction of nearby numbers does exactly; otherwise a mechanism a kilometre from the origin would be
//! checked by differences of rounded large numbers.

use crate::description::action::Action;
use crate::description::{
    DescribedBody, DescribedJoint, DescribedReaction, DescribedRow, Description,
};
use crate::error::{DenseError, Result};
use crate::inertias::{Inertias, at_angle};
use crate::pose::{Columns, Pose, Twist, centripetal};
use crate::rows::Rows;
use dwell_geometry::Mechanism;
use dwell_geometry::space::{IdleBody, Mechanism as SpaceMechanism, Vec3, vec3};
use dwell_kinetostatics::space::Mass as SpaceMass;
use dwell_numerics::PiecewiseQuintic;
use std::sync::Arc;

/// A body in its moved frame.
#[derive(Debug, Clone)]
pub(crate) struct DenseBody {
    pub(crate) name: String,
    pub(crate) columns: Columns,
    /// Mass properties about the moved frame.
    pub(crate) mass: SpaceMass,
    /// An additional moment of inertia about z as a function of the body's angle.
    varying: Option<PiecewiseQuintic>,
    /// The moved origin in the body's own frame.
    pub(crate) shift: Vec3,
}

impl DenseBody {
    /// I ω of its tensor and of the varying moment of inertia, kg m²/s.
    pub(crate) fn angular_momentum(&self, pose: &Pose, omega: Vec3) -> Vec3 {
        let mut momentum = self.constant_momentum(pose, omega);
        if self.varying.is_some() {
            momentum.z += at_angle(self.varying.as_ref(), pose.angle)[0] * omega.z;
        }
        momentum
    }

    /// I ω of its tensor alone.
    pub(crate) fn constant_momentum(&self, pose: &Pose, omega: Vec3) -> Vec3 {
        let rotation = &pose.rotation;
        rotation.apply(self.mass.angular_momentum(rotation.apply_inverse(omega)))
    }

    /// I α + ω × I ω, N·m, and I α + ½ I′ ω² of the varying moment of inertia.
    pub(crate) fn inertia_moment(&self, pose: &Pose, omega: Vec3, alpha: Vec3) -> Vec3 {
        self.constant_momentum(pose, alpha)
            + omega.cross(self.constant_momentum(pose, omega))
            + self.varying_moment(pose.angle, omega.z, alpha.z)
    }

    /// I α + ½ I′ ω² of the varying moment of inertia alone, N·m: the rate of no momentum of the body's own.
    pub(crate) fn varying_moment(&self, angle: f64, omega: f64, alpha: f64) -> Vec3 {
        match &self.varying {
            None => Vec3::ZERO,
            varying => {
                let [inertia, half_slope] = at_angle(varying.as_ref(), angle);
                vec3(0.0, 0.0, inertia * alpha + half_slope * omega * omega)
            }
        }
    }

    /// The varying moment of inertia at an angle, kg m².
    pub(crate) fn varying_inertia(&self, angle: f64) -> f64 {
        at_angle(self.varying.as_ref(), angle)[0]
    }
}

/// The mechanism, its masses and its rows, all dense, in moved frames.
///
/// Where a method takes a row or a body it is an index into the rows of the joints, followed by
/// the actuators', or into its bodies; speeds have as many numbers as there are coordinates.
#[derive(Debug, Clone)]
pub struct DenseMechanism {
    pub(crate) ground: usize,
    pub(crate) rows: Rows,
    pub(crate) bodies: Vec<DenseBody>,
    pub(crate) joints: Vec<DescribedJoint>,
    pub(crate) reactions: Vec<DescribedReaction>,
    pub(crate) actuators: Vec<Action>,
    /// By row: its name, and whether it is an angle.
    pub(crate) row_names: Vec<String>,
    pub(crate) angular: Vec<bool>,
    pub(crate) counts_revolutions: bool,
    /// Bodies with an idle rotation about a line, with the line in the moved frame.
    pub(crate) idle: Vec<IdleBody>,
    pub(crate) row_scale: Vec<f64>,
    pub(crate) column_scales: Vec<f64>,
    pub(crate) size: f64,
    /// The rows that are solved where the mechanism is assembled.
    pub(crate) assembly_rows: Arc<[usize]>,
    /// By row: whether only one multiplier of it balances the forces.
    pub(crate) determinate: Vec<bool>,
}

impl DenseMechanism {
    /// Moves the frames of a planar mechanism and writes the rows, as many as there are coordinates.
    ///
    /// # Errors
    /// [`DenseError`] where a reference, an axis or the number of rows or masses is wrong.
    pub fn new<'m>(mechanism: &Mechanism, inertias: impl Into<Inertias<'m>>) -> Result<Self> {
        Self::without_rank_check(mechanism, inertias)?.squared()
    }

    /// This mechanism, if it has as many rows as coordinates; otherwise an error.
    pub(crate) fn squared(self) -> Result<Self> {
        let (rows, columns) = (self.rows.len(), self.rows.columns());
        if rows == columns {
            Ok(self)
        } else {
            Err(DenseError::NotSquare { rows, columns })
        }
    }

    /// A mechanism with any number of rows. It can be measured, but not closed.
    pub(crate) fn without_rank_check<'m>(
        mechanism: &Mechanism,
        inertias: impl Into<Inertias<'m>>,
    ) -> Result<Self> {
        let description = Description::in_plane(mechanism, inertias.into())?;
        Ok(Self::of(description, |_, mean| mean))
    }

    /// A mechanism in space, with the bodies that have an idle rotation about the line through their spherical joints, and any
    /// number of rows.
    ///
    /// # Errors
    /// [`DenseError`] where there is not one mass for each body.
    pub(crate) fn in_space(
        mechanism: &SpaceMechanism,
        masses: &[SpaceMass],
        idle: &[IdleBody],
    ) -> Result<Self> {
        let description = Description::in_space(mechanism, masses, idle)?;
        Ok(Self::of(description, |_, mean| mean))
    }

    /// The rows of a description, with the origin of each body at some point of it, by the mean of its attachments.
    pub(crate) fn of(mut description: Description, origin: impl Fn(usize, Vec3) -> Vec3) -> Self {
        let means = description.attachment_means().into_iter().enumerate();
        let shifts: Vec<Vec3> = means.map(|(b, mean)| origin(b, mean)).collect();
        description.shift(&shifts);
        let Description {
            ground,
            bodies,
            joints,
            rows,
            reactions,
            actuators,
            size,
            counts_revolutions,
            idle,
            ..
        } = description;
        let both = bodies.into_iter().zip(shifts);
        let bodies: Vec<DenseBody> = both.map(|(body, shift)| shifted(body, shift)).collect();
        let angular: Vec<bool> = rows.iter().map(|row| row.is_angle).collect();
        let scale = |&angular: &bool| if angular { size } else { 1.0 };
        let columns: Vec<Columns> = bodies.iter().map(|body| body.columns).collect();
        let of_columns = columns.iter().flat_map(|body| {
            let parts = body.components(Vec3::ZERO, Vec3::ZERO);
            parts.map(|(_, is_angle)| if is_angle { 1.0 / size } else { 1.0 })
        });
        let count = rows.len();
        let unzip = |row: DescribedRow| (row.row, row.name);
        let column_scales = of_columns.collect();
        let (rows, row_names): (Vec<_>, Vec<_>) = rows.into_iter().map(unzip).unzip();
        Self {
            ground,
            rows: Rows::new(rows, columns),
            bodies,
            joints,
            reactions,
            actuators,
            row_names,
            row_scale: angular.iter().map(scale).collect(),
            angular,
            idle,
            counts_revolutions,
            column_scales,
            size,
            assembly_rows: (0..count).collect(),
            determinate: vec![true; count],
        }
    }

    /// The size of the mechanism, m, by which angles are compared with lengths.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Index of the first actuator's row; the rows before it are those of the joints.
    pub fn actuator_row(&self) -> usize {
        self.rows.len() - self.actuators.len()
    }

    /// The factor from a column of the scaled matrix to a velocity: 1 for a length, 1/size for an angle.
    pub(crate) fn column_scale(&self, column: usize) -> f64 {
        self.column_scales[column]
    }

    /// The bodies that move, each with its index.
    pub(crate) fn moving_bodies(&self) -> impl Iterator<Item = (usize, &DenseBody)> {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter(|(_, body)| !body.columns.is_fixed())
    }

    /// The names of the actuators.
    pub(crate) fn actuator_names(&self) -> &[String] {
        &self.row_names[self.actuator_row()..]
    }

    /// Whether the first actuator drives an angle.
    pub(crate) fn is_angle_driven(&self) -> bool {
        self.angular[self.actuator_row()]
    }

    /// The components of forces and moments on the whole mechanism: those in space if any body has coordinates in
    /// space.
    pub(crate) fn whole(&self) -> Columns {
        let in_space = |body: &DenseBody| matches!(body.columns, Columns::Space(_));
        if self.bodies.iter().any(in_space) {
            Columns::Space(0)
        } else {
            Columns::Plane(0)
        }
    }

    /// The poses of the moved frames, from the moved origin of the ground, out of those of all bodies.
    ///
    /// # Errors
    /// [`DenseError::InvalidPoses`] if their number differs from that of the bodies, or they are not finite.
    pub(crate) fn moved_frames(&self, poses: &[Pose]) -> Result<Vec<Pose>> {
        if poses.len() != self.bodies.len() || poses.iter().any(|pose| !pose.is_finite()) {
            return Err(DenseError::InvalidPoses);
        }
        let ground = self.bodies[self.ground].shift;
        let both = self.bodies.iter().zip(poses);
        let moved = both.map(|(body, pose)| match body.columns {
            // The ground stands where it is.
            Columns::Fixed => Pose::default(),
            _ => Pose {
                position: (pose.position - ground) + pose.rotation.apply(body.shift),
                ..*pose
            },
        });
        Ok(moved.collect())
    }

    /// Poses of the moved frames of a planar mechanism out of the frames [x, y, θ] of all bodies.
    ///
    /// # Errors
    /// As of any poses.
    pub fn frames(&self, poses: &[[f64; 3]]) -> Result<Vec<Pose>> {
        let poses: Vec<Pose> = poses.iter().map(|pose| Pose::from(*pose)).collect();
        self.moved_frames(&poses)
    }

    /// Dense velocities out of the poses of all bodies and their rates.
    pub(crate) fn velocities(&self, poses: &[Pose], rates: &[Twist]) -> Vec<f64> {
        let mut x_dot = vec![0.0; self.rows.columns()];
        for (b, body) in self.moving_bodies() {
            let arm = poses[b].rotation.apply(body.shift);
            let linear = rates[b].at(arm);
            set(&mut x_dot, body.columns, linear, rates[b].angular);
        }
        x_dot
    }

    /// Dense accelerations out of the poses of all bodies, their rates and the rates of these.
    pub(crate) fn accelerations(&self, poses: &[Pose], [first, second]: [&[Twist]; 2]) -> Vec<f64> {
        let mut x_ddot = vec![0.0; self.rows.columns()];
        for (b, body) in self.moving_bodies() {
            let arm = poses[b].rotation.apply(body.shift);
            let omega = first[b].angular;
            let linear = second[b].at(arm) + centripetal(omega, arm);
            set(&mut x_ddot, body.columns, linear, second[b].angular);
        }
        x_ddot
    }

    /// Largest over smallest singular value of the scaled rows at these poses; 1 if there is none.
    pub(crate) fn condition_number(&self, poses: &[Pose]) -> f64 {
        let values = self.scaled_jacobian(poses).singular_values();
        match values.unwrap_or_default()[..] {
            [largest, .., smallest] if smallest > 0.0 => largest / smallest,
            _ => 1.0,
        }
    }
}

/// A body with its mass about the moved frame.
fn shifted(body: DescribedBody, shift: Vec3) -> DenseBody {
    let mut mass = body.mass;
    // The centre of nothing does not matter; far away it would cost digits.
    mass.center = match mass.mass {
        0.0 => Vec3::ZERO,
        _ => mass.center - shift,
    };
    DenseBody {
        name: body.name,
        columns: body.columns,
        mass,
        varying: body.varying,
        shift,
    }
}

fn set(to: &mut [f64], columns: Columns, linear: Vec3, angular: Vec3) {
    let components = columns.components(linear, angular);
    for (to, (part, _)) in to[columns.range()].iter_mut().zip(components) {
        *to = part;
    }
}

/// Adds a multiple of a vector to another.
pub(crate) fn add_scaled(to: &mut [f64], factor: f64, more: &[f64]) {
    let both = to.iter_mut().zip(more);
    both.for_each(|(to, more)| *to += factor * more);
}

/// The condition number of the dense scaled rows of a mechanism, those of its joints and actuators, in the
/// configuration with the frames `poses` of all bodies, m and rad: largest over smallest singular value. It bounds the
/// error of a result in roundings. 1 if it does not exist.
pub fn condition_number(mechanism: &Mechanism, poses: &[[f64; 3]]) -> f64 {
    let masses = vec![dwell_kinetostatics::Mass::default(); mechanism.bodies.len()];
    let dense = DenseMechanism::without_rank_check(mechanism, &masses);
    let at = |dense: DenseMechanism| Ok(dense.condition_number(&dense.frames(poses)?));
    dense.and_then(at).unwrap_or(1.0)
}
