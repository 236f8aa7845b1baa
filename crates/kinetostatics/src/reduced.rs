//! The reduced model of a mechanism of one degree of freedom, from two unit kinetostatic runs:
//!
//! ```text
//! m q̈ + ½ m′ q̇² = Q                                            (1)
//! R_k = a_k q̈ + b_k q̇²                                         (2)
//! run 1 (q̇ = 1, q̈ = 0):  τ = ½ m′,  reaction k = b_k            (3)
//! run 2 (q̇ = 0, q̈ = 1):  τ = m,     reaction k = a_k            (4)
//! ```
//!
//! (Jordi, Zayas and Cardona 2008, eq. 3, in the consistent form of docs/theory.md.)

use crate::model::{Model, Workspace};
use crate::runs::Unit;
use dwell_geometry::{Dual, PlaceError, Range, Scalar};

/// The coefficients of the reduced model at one coordinate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coefficients<T = f64> {
    /// Generalised inertia m, kg m².
    pub m: T,
    /// Half its derivative, ½m′, kg m².
    pub half_dm: T,
    /// By requested reaction: what multiplies q̈, kg m or kg m².
    pub a: Vec<T>,
    /// By requested reaction: what multiplies q̇², kg m or kg m².
    pub b: Vec<T>,
}

/// What the equation of motion and its Jacobian need at one coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia {
    /// m, kg m².
    pub m: f64,
    /// ½m′, kg m².
    pub half_dm: f64,
    /// ½m″, kg m².
    pub half_ddm: f64,
}

/// A reduced model of one degree of freedom, exact or tabulated. Constant and shared; an
/// evaluation writes into the caller's working memory.
pub trait Reduced: Sync {
    /// Working memory of one thread.
    type Work: Send;

    /// Working memory for one thread.
    fn work(&self) -> Self::Work;

    /// Number of reactions.
    fn reactions(&self) -> usize;

    /// How far the coordinate reaches.
    fn range(&self) -> Range;

    /// m and ½m′ at `q` (rad).
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    fn inertia(&self, q: f64, work: &mut Self::Work) -> Result<(f64, f64), PlaceError>;

    /// m, ½m′ and ½m″ at `q` (rad).
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    fn curvature(&self, q: f64, work: &mut Self::Work) -> Result<Inertia, PlaceError>;

    /// All coefficients at `q` (rad).
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    fn coefficients(
        &self,
        q: f64,
        work: &mut Self::Work,
        out: &mut Coefficients,
    ) -> Result<(), PlaceError>;
}

/// Working memory of the exact reduced model: one for values, one for derivatives.
#[derive(Debug, Clone)]
pub struct ExactWork {
    plain: Workspace<f64>,
    dual: Workspace<Dual>,
}

/// The reduced model evaluated from the mechanism itself. The model must have one actuator.
#[derive(Debug, Clone)]
pub struct Exact {
    model: Model,
    /// The same mechanism with no reaction asked for: what the equation of motion needs.
    bare: Model,
}

impl Exact {
    /// The reduced model of a mechanism; none unless it has exactly one actuator.
    pub fn new(model: Model) -> Option<Self> {
        let bare = model.inertia_alone();
        (model.plan().actuators() == 1).then_some(Self { model, bare })
    }

    /// The mechanism it is evaluated from.
    pub fn model(&self) -> &Model {
        &self.model
    }

    pub(crate) fn bare(&self) -> &Model {
        &self.bare
    }
}

impl Model {
    /// The reduced coefficients at `q` (rad) in any kind of number, for one actuator.
    ///
    /// With q̇ = 0 the acceleration equations are those of the velocities, so run 2's accelerations
    /// are run 1's velocities: both runs cost one pose, one velocity and one acceleration stage.
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    // All that it passes through is inlined: one pose is evaluated in a tenth less, and a batch is in one function
    // compiled for the processor's registers.
    #[inline(always)]
    pub fn reduce<T: Scalar>(
        &self,
        q: T,
        work: &mut Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> Result<(), PlaceError> {
        let Workspace {
            pose, motion, unit, ..
        } = work;
        let (zero, one) = (T::lift(0.0), T::lift(1.0));
        self.plan().place(&[q], pose)?;
        self.plan().speeds(pose, &[one], motion);
        self.plan().accelerations(pose, &[zero], motion);
        unit.evaluate(self, pose, Unit(motion));
        [out.half_dm, out.m] = unit.tau(self, 0);
        for (k, (a, b)) in out.a.iter_mut().zip(&mut out.b).enumerate() {
            [*b, *a] = unit.reaction(self, pose, k);
        }
        Ok(())
    }

    /// Room for the coefficients of this model.
    pub fn coefficients<T: Scalar>(&self) -> Coefficients<T> {
        Coefficients {
            m: T::lift(0.0),
            half_dm: T::lift(0.0),
            a: vec![T::lift(0.0); self.reactions().len()],
            b: vec![T::lift(0.0); self.reactions().len()],
        }
    }
}

impl Reduced for Exact {
    type Work = ExactWork;

    fn work(&self) -> ExactWork {
        ExactWork {
            plain: self.model.workspace(),
            dual: self.bare.workspace(),
        }
    }

    fn reactions(&self) -> usize {
        self.model.reactions().len()
    }

    fn range(&self) -> Range {
        self.model.plan().range()
    }

    fn inertia(&self, q: f64, work: &mut ExactWork) -> Result<(f64, f64), PlaceError> {
        let mut out = Coefficients::default();
        self.bare.reduce(q, &mut work.plain, &mut out)?;
        Ok((out.m, out.half_dm))
    }

    fn curvature(&self, q: f64, work: &mut ExactWork) -> Result<Inertia, PlaceError> {
        let mut out = Coefficients::default();
        self.bare
            .reduce(Dual::variable(q), &mut work.dual, &mut out)?;
        Ok(Inertia {
            m: out.m.v,
            half_dm: out.half_dm.v,
            half_ddm: out.half_dm.d,
        })
    }

    fn coefficients(
        &self,
        q: f64,
        work: &mut ExactWork,
        out: &mut Coefficients,
    ) -> Result<(), PlaceError> {
        self.model.reduce(q, &mut work.plain, out)
    }
}
