//! Deliberate faults, wrapped around a correct subject.

use dwell_verify::{Coefficients, InverseDynamics, Pose, Subject, SubjectError};

type AlterPoses<'a> = dyn Fn(f64, &mut [[f64; 3]]) + Sync + 'a;
type AlterCoefficients<'a> = dyn Fn(&mut Coefficients) + Sync + 'a;
type AlterForces<'a> = dyn Fn(&mut InverseDynamics, &Coefficients, [f64; 2]) + Sync + 'a;

/// A subject whose results are altered.
pub(crate) struct MutatedSubject<'a> {
    subject: &'a dyn Subject,
    poses: Box<AlterPoses<'a>>,
    coefficients: Box<AlterCoefficients<'a>>,
    /// With the coefficients at hand, and q̇ and q̈.
    inverse_dynamics: Box<AlterForces<'a>>,
}

impl<'a> MutatedSubject<'a> {
    pub(crate) fn new(of: &'a dyn Subject) -> Self {
        Self {
            subject: of,
            poses: Box::new(|_, _| ()),
            coefficients: Box::new(|_| ()),
            inverse_dynamics: Box::new(|_, _, _| ()),
        }
    }

    pub(crate) fn poses(mut self, f: impl Fn(f64, &mut [[f64; 3]]) + Sync + 'a) -> Self {
        self.poses = Box::new(f);
        self
    }

    pub(crate) fn coefficients(mut self, f: impl Fn(&mut Coefficients) + Sync + 'a) -> Self {
        self.coefficients = Box::new(f);
        self
    }

    pub(crate) fn inverse_dynamics(
        mut self,
        f: impl Fn(&mut InverseDynamics, &Coefficients, [f64; 2]) + Sync + 'a,
    ) -> Self {
        self.inverse_dynamics = Box::new(f);
        self
    }
}

impl Subject for MutatedSubject<'_> {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let mut poses = self.subject.frames(q)?;
        (self.poses)(q, &mut poses);
        Ok(Pose::all_in_plane(&poses))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let mut coefficients = self.subject.coefficients(q)?;
        (self.coefficients)(&mut coefficients);
        Ok(coefficients)
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let mut actions = self.subject.inverse_dynamics(q, q_dot, q_ddot)?;
        (self.inverse_dynamics)(
            &mut actions,
            &self.subject.coefficients(q)?,
            [q_dot, q_ddot],
        );
        Ok(actions)
    }
}
