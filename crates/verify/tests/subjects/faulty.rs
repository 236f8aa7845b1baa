//! Deliberate faults, wrapped around a correct subject.

use dwell_verify::{Actions, Coefficients, Subject, SubjectError};

type Poses<'a> = dyn Fn(f64, &mut [[f64; 3]]) + Sync + 'a;
type Alter<'a> = dyn Fn(&mut Coefficients) + Sync + 'a;
type Act<'a> = dyn Fn(&mut Actions, &Coefficients, [f64; 2]) + Sync + 'a;

/// A subject whose answers are altered on the way out.
pub(crate) struct Faulty<'a> {
    of: &'a dyn Subject,
    poses: Box<Poses<'a>>,
    coefficients: Box<Alter<'a>>,
    /// With the coefficients at hand, and q̇ and q̈.
    actions: Box<Act<'a>>,
}

impl<'a> Faulty<'a> {
    pub(crate) fn of(of: &'a dyn Subject) -> Self {
        Self {
            of,
            poses: Box::new(|_, _| ()),
            coefficients: Box::new(|_| ()),
            actions: Box::new(|_, _, _| ()),
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

    pub(crate) fn actions(
        mut self,
        f: impl Fn(&mut Actions, &Coefficients, [f64; 2]) + Sync + 'a,
    ) -> Self {
        self.actions = Box::new(f);
        self
    }
}

impl Subject for Faulty<'_> {
    fn poses(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError> {
        let mut poses = self.of.poses(q)?;
        (self.poses)(q, &mut poses);
        Ok(poses)
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let mut coefficients = self.of.coefficients(q)?;
        (self.coefficients)(&mut coefficients);
        Ok(coefficients)
    }

    fn actions(&self, q: f64, q_dot: f64, q_ddot: f64) -> Result<Actions, SubjectError> {
        let mut actions = self.of.actions(q, q_dot, q_ddot)?;
        (self.actions)(&mut actions, &self.of.coefficients(q)?, [q_dot, q_ddot]);
        Ok(actions)
    }
}
