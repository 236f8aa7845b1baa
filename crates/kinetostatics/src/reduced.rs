//! The reduced model of a mechanism of one degree of freedom, from two unit passes:
//!
//! ```text
//! m q̈ + ½ m′ q̇² = Q                                            (1)
//! R_k = a_k q̈ + b_k q̇²                                         (2)
//! pass 1 (q̇ = 1, q̈ = 0):  τ = ½ m′,  reaction k = b_k            (3)
//! pass 2 (q̇ = 0, q̈ = 1):  τ = m,     reaction k = a_k            (4)
//! ```
//!
//! (Jordi, Zayas and Cardona 2008, eq. 3, in the consistent form of docs/theory.md.)

mod batch;
mod lane_work;
#[cfg(target_arch = "x86_64")]
mod registers;

pub use batch::Batch;
pub(crate) use batch::{LANES, LaneScalar, MAX_LANES};
pub(crate) use lane_work::{LaneWork, in_lanes};

use crate::error::PositionResult;
use crate::model::{Model, Workspace};
use crate::pass::{PassModel, RecursivePass, UnitMotions};
pub use crate::reducible_model::{Coefficients, ReducibleModel};
use dwell_geometry::{Motion, Pose, Range};
use dwell_numerics::{Constant, Dual, Lift, Scalar};

/// The generalised inertia and its derivatives at one coordinate, for the equation of motion and its Jacobian.
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
pub trait ReducedModel: Sync {
    /// Working memory of one thread.
    type Workspace: Send;

    /// Working memory for one thread.
    fn workspace(&self) -> Self::Workspace;

    /// Number of reactions.
    fn reactions(&self) -> usize;

    /// The range of the coordinate.
    fn range(&self) -> Range;

    /// m and ½m′ at `q` (rad).
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    fn inertia(&self, q: f64, work: &mut Self::Workspace) -> PositionResult<(f64, f64)>;

    /// The turns of the mechanism after [`ReducedModel::inertia`], as in [`ReducibleModel::unit_turns`]; empty for a table, which has
    /// no positions.
    fn unit_turns(&self, _work: &Self::Workspace) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// m, ½m′ and ½m″ at `q` (rad).
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    fn inertia_derivatives(&self, q: f64, work: &mut Self::Workspace) -> PositionResult<Inertia>;

    /// All coefficients at `q` (rad).
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    fn coefficients(
        &self,
        q: f64,
        work: &mut Self::Workspace,
        out: &mut Coefficients,
    ) -> PositionResult;
}

/// Working memory of the exact reduced model: for coefficients, for inertia alone, and for derivatives.
#[derive(Debug, Clone)]
pub struct ExactWorkspace<R = Workspace<f64>, D = Workspace<Dual>> {
    real: R,
    inertia: R,
    dual: D,
}

/// The reduced model evaluated from the mechanism itself. The model must have one actuator.
#[derive(Debug, Clone)]
pub struct ExactModel<M = Model> {
    model: M,
    /// The model without reactions, sufficient for the equation of motion.
    inertia_model: M,
}

impl<M: ReducibleModel> ExactModel<M> {
    /// The reduced model of a mechanism; none unless it has exactly one actuator.
    pub fn new(model: M) -> Option<Self> {
        let inertia_model = model.for_inertia();
        (model.actuators() == 1).then(|| Self {
            model: model.for_coefficients(),
            inertia_model,
        })
    }

    /// The mechanism it is evaluated from.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// A buffer for its coefficients.
    pub fn coefficient_buffer(&self) -> Coefficients {
        Coefficients::buffer(self.model.reaction_count())
    }
}

impl ReducibleModel for Model {
    type Workspace<T: Scalar> = Workspace<T>;

    fn pass_workspace<T: Scalar>(&self) -> Workspace<T> {
        self.workspace()
    }

    fn actuators(&self) -> usize {
        self.plan().actuators()
    }

    fn reaction_count(&self) -> usize {
        self.reactions().len()
    }

    fn range(&self) -> Range {
        self.plan().range()
    }

    fn for_coefficients(self) -> Self {
        self
    }

    fn for_inertia(&self) -> Self {
        self.inertia_only()
    }

    #[inline(always)]
    fn reduce_at<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> PositionResult {
        self.reduce(q, workspace, out)
    }

    fn unit_turns(&self, workspace: &Workspace<f64>) -> Vec<[f64; 2]> {
        workspace.motion.turns(&workspace.pose)
    }
}

impl Model {
    /// The reduced coefficients at `q` (rad) in any kind of number, for one actuator.
    ///
    /// With q̇ = 0 the acceleration equations are those of the velocities, so pass 2's accelerations
    /// are pass 1's velocities: both passes cost one pose, one velocity and one acceleration stage.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    // The whole evaluation is inlined: one pose takes a tenth less time, and a batch becomes one function that is
    // compiled for the processor's registers.
    #[inline(always)]
    pub fn reduce<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> PositionResult {
        let Workspace {
            pose,
            motion,
            unit_passes: unit,
            ..
        } = workspace;
        self.plan().positions(&[q], pose)?;
        self.pass_model.reduce_at_pose(pose, motion, unit, out);
        Ok(())
    }

    /// A buffer for the coefficients of this model.
    pub fn coefficient_buffer<T: Scalar>(&self) -> Coefficients<T> {
        Coefficients::buffer(self.reactions().len())
    }
}

impl<C: Constant> PassModel<C> {
    /// The reduced coefficients at a pose, by (3) and (4).
    #[inline(always)]
    pub(crate) fn reduce_at_pose<T: Lift<C>>(
        &self,
        pose: &Pose<T>,
        motion: &mut Motion<T>,
        passes: &mut RecursivePass<T, 2>,
        out: &mut Coefficients<T>,
    ) {
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        self.plan.velocities(pose, &[one], motion);
        self.plan.accelerations(pose, &[zero], motion);
        passes.evaluate(self, pose, UnitMotions(motion), None);
        [out.half_dm, out.m] = passes.tau(self, 0);
        for (k, (a, b)) in out.a.iter_mut().zip(&mut out.b).enumerate() {
            [*b, *a] = passes.reaction(self, pose, k);
        }
    }
}

impl<M: ReducibleModel> ReducedModel for ExactModel<M> {
    type Workspace = ExactWorkspace<M::Workspace<f64>, M::Workspace<Dual>>;

    fn workspace(&self) -> Self::Workspace {
        ExactWorkspace {
            real: self.model.pass_workspace(),
            inertia: self.inertia_model.pass_workspace(),
            dual: self.inertia_model.pass_workspace(),
        }
    }

    fn reactions(&self) -> usize {
        self.model.reaction_count()
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn inertia(&self, q: f64, workspace: &mut Self::Workspace) -> PositionResult<(f64, f64)> {
        let inertia = self
            .inertia_model
            .reduced_inertia(q, &mut workspace.inertia);
        inertia.map(<(f64, f64)>::from)
    }

    fn unit_turns(&self, workspace: &Self::Workspace) -> Vec<[f64; 2]> {
        self.inertia_model.unit_turns(&workspace.inertia)
    }

    fn inertia_derivatives(
        &self,
        q: f64,
        workspace: &mut Self::Workspace,
    ) -> PositionResult<Inertia> {
        let model = &self.inertia_model;
        let [m, half_dm] = model.reduced_inertia(Dual::variable(q), &mut workspace.dual)?;
        Ok(Inertia {
            m: m.v,
            half_dm: half_dm.v,
            half_ddm: half_dm.d,
        })
    }

    fn coefficients(
        &self,
        q: f64,
        workspace: &mut Self::Workspace,
        out: &mut Coefficients,
    ) -> PositionResult {
        self.model.reduce_at(q, &mut workspace.real, out)
    }
}
