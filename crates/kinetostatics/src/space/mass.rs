//! Mass and inertia of a body in space.

use dwell_geometry::space::{BodyMotion, Frame, Rotation, Vec3, Wrench, vec3};
use dwell_numerics::dense::Matrix;
use dwell_numerics::{Constant, Lift, map_array};

/// Mass, centre of mass and moments of inertia of a body, in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mass<C = f64> {
    /// Mass, kg.
    pub mass: C,
    /// Centre of mass, m.
    pub center: Vec3<C>,
    /// Elements of the inertia tensor about the centre of mass, kg m²: I_xx, I_yy, I_zz, I_xy, I_xz, I_yz, where
    /// I_xy = −∫ x y dm.
    pub inertia: [C; 6],
}

/// The rows of a tensor by its elements.
#[inline(always)]
fn rows<C: Copy>([xx, yy, zz, xy, xz, yz]: [C; 6]) -> [Vec3<C>; 3] {
    [vec3(xx, xy, xz), vec3(xy, yy, yz), vec3(xz, yz, zz)]
}

impl Mass {
    /// Whether it is a mass: not negative, with a tensor that is positive semidefinite within rounding. A principal moment may exceed the
    /// sum of the two others, because equations of motion do not need this condition ([`Mass::excess_moment`]).
    pub fn is_valid(&self) -> bool {
        let [xx, yy, zz, xy, xz, yz] = self.inertia;
        let finite = self.mass.is_finite()
            && self.center.is_finite()
            && self.inertia.iter().all(|i| i.is_finite());
        let slack = 1e-9 * (xx + yy + zz).abs();
        let minors = [xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz];
        let determinant =
            xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        finite
            && self.mass >= 0.0
            && [xx, yy, zz].iter().all(|i| *i >= -slack)
            && minors
                .iter()
                .all(|m| *m >= -slack * slack.max(xx + yy + zz))
            && determinant >= -slack * (xx + yy + zz).powi(2)
    }

    /// The principal moments of inertia about the centre of mass, kg m², the smallest first; not numbers where an element is none.
    ///
    /// ```
    /// use dwell_kinetostatics::space::Mass;
    ///
    /// let cuboid = Mass { inertia: [2.0, 2.0, 3.0, 1.0, 0.0, 0.0], ..Mass::default() };
    /// let moments = cuboid.principal_moments();
    /// assert!(moments.iter().zip([1.0, 3.0, 3.0]).all(|(a, b)| (a - b).abs() < 1e-14));
    /// ```
    pub fn principal_moments(&self) -> [f64; 3] {
        let rows = rows(self.inertia).map(|row| [row.x, row.y, row.z]);
        let values = Matrix::from_fn(3, 3, |i, j| rows[i][j]).eigenvalues();
        let mut moments = [f64::NAN; 3];
        for (moment, [value, _]) in moments.iter_mut().zip(values.into_iter().flatten()) {
            *moment = value;
        }
        moments.sort_by(f64::total_cmp);
        moments
    }

    /// The excess of the largest principal moment over the sum of the others, kg m². For a distribution of mass it is not
    /// positive, except for rounding, because I_1 + I_2 − I_3 = 2 ∫ x_3² dm.
    pub fn excess_moment(&self) -> f64 {
        let [one, two, largest] = self.principal_moments();
        largest - one - two
    }

    /// Whether a body's inertia couples its rotation about a line with the motion: the centre is off it, or the inertia is not that of a body of revolution.
    pub(super) fn is_unbalanced_about(&self, point: Vec3, axis: Vec3) -> bool {
        let off = (self.center - point).cross(axis);
        let x = axis.any_normal();
        let y = axis.cross(x);
        let [z, along_x, along_y] = [axis, x, y].map(|v| self.angular_momentum(v));
        let scale = self.inertia[..3].iter().sum::<f64>() + self.mass * off.dot(off);
        let products = [
            z.dot(x),
            z.dot(y),
            along_x.dot(y),
            along_x.dot(x) - along_y.dot(y),
        ];
        // Coordinates of the body's frame are rounded where its origin is far away.
        let is_off = off.norm() > 8.0 * f64::EPSILON * self.center.norm();
        is_off && self.mass * off.norm() * (off.norm() + self.center.norm()) > 1e-12 * scale
            || products.iter().any(|p| p.abs() > 1e-9 * scale)
    }

    /// This mass, whose tensor refers to these axes of the body, with the tensor in the axes of the body's frame.
    #[must_use]
    pub fn turned(&self, axes: &Rotation) -> Self {
        let image = |k: usize| {
            let along = axes.apply_inverse(Vec3::AXES[k]);
            axes.apply(self.angular_momentum(along))
        };
        let [x, y, z] = [image(0), image(1), image(2)];
        let inertia = [x.x, y.y, z.z, x.y, x.z, y.z];
        Self { inertia, ..*self }
    }
}

impl<C: Constant> Mass<C> {
    /// The tensor times a vector of the body's frame.
    pub fn angular_momentum(&self, w: Vec3<C>) -> Vec3<C> {
        let [x, y, z] = rows(self.inertia);
        vec3(x.dot(w), y.dot(w), z.dot(w))
    }

    /// This mass in another frame of the body.
    pub(super) fn in_frame(&self, frame: &Frame<C>) -> Self {
        let to = |v: Vec3<C>| frame.rotation.apply_inverse(v);
        let image = |k: usize| to(self.angular_momentum(frame.rotation.columns[k]));
        let [x, y, z] = [image(0), image(1), image(2)];
        Self {
            mass: self.mass,
            center: to(self.center - frame.position),
            inertia: [x.x, y.y, z.z, x.y, x.z, y.z],
        }
    }

    /// The force and the moment about the origin of the frame that move it so, by (1) of the [module](super).
    #[inline(always)]
    pub(super) fn required<T: Lift<C>>(
        &self,
        frame: &Frame<T>,
        motion: &BodyMotion<T>,
    ) -> Wrench<T> {
        let (arm, tensor) = (frame.rotation.apply(self.center.cast()), self.tensor(frame));
        let force = motion.point_acceleration(arm).scaled(T::lift(self.mass));
        let w = motion.angular_velocity;
        let couple = tensor(motion.angular_acceleration) + w.cross(tensor(w));
        let mut wrench = Wrench::default();
        wrench.add_at(arm, force, couple);
        wrench
    }

    /// The required wrenches in both unit passes: at unit acceleration from rest, with accelerations equal to these velocities, and in
    /// this motion.
    #[inline(always)]
    pub(super) fn required_in_unit_passes<T: Lift<C>>(
        &self,
        frame: &Frame<T>,
        motion: &BodyMotion<T>,
    ) -> [Wrench<T>; 2] {
        let (arm, tensor) = (frame.rotation.apply(self.center.cast()), self.tensor(frame));
        let (mass, w) = (T::lift(self.mass), motion.angular_velocity);
        let momentum = tensor(w);
        let couple = tensor(motion.angular_acceleration) + w.cross(momentum);
        let mut wrenches = [Wrench::default(); 2];
        wrenches[0].add_at(arm, motion.point_velocity(arm).scaled(mass), momentum);
        wrenches[1].add_at(arm, motion.point_acceleration(arm).scaled(mass), couple);
        wrenches
    }

    /// The tensor of inertia in the axes of the ground, times a vector.
    #[inline(always)]
    fn tensor<T: Lift<C>>(&self, frame: &Frame<T>) -> impl Fn(Vec3<T>) -> Vec3<T> {
        let [x, y, z] = map_array(rows(self.inertia), Vec3::cast);
        let rotation = frame.rotation;
        move |v: Vec3<T>| {
            let v = rotation.apply_inverse(v);
            rotation.apply(vec3(x.dot(v), y.dot(v), z.dot(v)))
        }
    }
}
