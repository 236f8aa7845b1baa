//! The reduced model of a mechanism of one degree of freedom.

use crate::error::Error;
use dwell_geometry::Range;
use dwell_kinetostatics::table::{Labels, TableDomain, TabulatedModel};
use dwell_kinetostatics::{
    Batch, ExactModel, InverseDynamics, KinematicState, MachineModel as _, ReducedModel as _,
    ReducibleModel,
};
use dwell_study::StudyScene;
use dwell_study::assembled::UnitModels;
use std::f64::consts::TAU;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The exact reduced model: constant, and shared between threads.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let reduced = slider.reduced(["guide.normal"])?;
/// let at = reduced.at(60f64.to_radians())?;
/// // The torque of the crank at 150 rad/s and 20 rad/s², without loads.
/// let torque = at.m * 20.0 + at.half_dm * 150.0 * 150.0;
/// let normal = at.a[0] * 20.0 + at.b[0] * 150.0 * 150.0;
/// # assert!(torque.is_finite() && normal.is_finite());
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ReducedModel {
    pub(crate) source: Arc<dyn CoefficientSource>,
    reactions: Vec<String>,
    loads: Vec<String>,
    idle: IdleWorkspaces,
}

/// Unused evaluators, kept because allocating their memory takes longer than evaluating a position. Copies of a model share them.
#[derive(Debug, Clone, Default)]
struct IdleWorkspaces(Arc<Mutex<Vec<Box<dyn CoefficientEvaluator>>>>);

impl IdleWorkspaces {
    /// A thread that panicked while holding the lock left intact memory.
    fn all(&self) -> MutexGuard<'_, Vec<Box<dyn CoefficientEvaluator>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The coefficients at one coordinate; those of the reactions are in the order of [`ReducedModel::reactions`], those of the
/// loads in the order of [`ReducedModel::loads`].
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let at = slider.reduced(["guide.normal"])?.at(0.5)?;
/// println!("m = {} kg m2, half its derivative {} kg m2", at.m, at.half_dm);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coefficients {
    /// Generalised inertia m, kg m² (kg if the coordinate is a length).
    pub m: f64,
    /// Half its derivative by the coordinate, ½m′.
    pub half_dm: f64,
    /// By reaction: its coefficient of q̈.
    pub a: Vec<f64>,
    /// By reaction: its coefficient of q̇².
    pub b: Vec<f64>,
    /// By load: its generalised force per unit of its magnitude F.
    pub w: Vec<f64>,
    /// By load, then by reaction: its contribution to the reaction per unit of F.
    pub c: Vec<Vec<f64>>,
}

impl ReducedModel {
    pub(crate) fn new(
        source: Arc<dyn CoefficientSource>,
        reactions: Vec<String>,
        loads: Vec<String>,
    ) -> Self {
        Self {
            source,
            reactions,
            loads,
            idle: IdleWorkspaces::default(),
        }
    }

    /// Names of the reactions.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.reduced(["guide"])?.reactions(), ["guide.normal", "guide.moment"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reactions(&self) -> Vec<String> {
        self.reactions.clone()
    }

    /// Names of the loads.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.reduced(["guide"])?.loads(), ["weight", "gas"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn loads(&self) -> Vec<&str> {
        self.loads.iter().map(String::as_str).collect()
    }

    /// The coefficients at `q`, rad or m. For many positions, an [`evaluator`](Self::evaluator) avoids all allocations.
    ///
    /// # Errors
    /// [`Error::Study`] if the mechanism cannot reach `q`.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let reduced = slider.reduced([])?;
    /// assert!(reduced.at(0.5)?.m > 0.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn at(&self, q: f64) -> Result<Coefficients, Error> {
        let mut evaluator = self.evaluator();
        let found = evaluator.at(q).cloned();
        evaluator.release();
        found
    }

    /// Working memory for many evaluations in one thread.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let reduced = slider.reduced([])?;
    /// let mut evaluator = reduced.evaluator();
    /// let mut largest = 0.0_f64;
    /// for degree in 0..360 {
    ///     largest = largest.max(evaluator.at(f64::from(degree).to_radians())?.m);
    /// }
    /// # assert!(largest > 0.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn evaluator(&self) -> Evaluator<'_> {
        let idle = self.idle.all().pop();
        Evaluator {
            reduced: self,
            own: idle.unwrap_or_else(|| Arc::clone(&self.source).evaluator()),
        }
    }
}

/// The reduced model of a scene with some reactions.
pub(crate) trait CoefficientSource: fmt::Debug + Send + Sync {
    /// Memory for evaluations in one thread.
    fn evaluator(self: Arc<Self>) -> Box<dyn CoefficientEvaluator>;

    /// m, ½m′, a and b at many coordinates.
    fn inertial_batch(&self, q: &[f64]) -> Result<Batch, Error>;

    /// The model as a table. Reactions that friction needs follow the requested ones.
    fn table(&self, accuracy: f64) -> Result<(TabulatedModel, Labels), Error>;
}

/// Evaluates coefficients.
pub(crate) trait CoefficientEvaluator: fmt::Debug + Send {
    fn at(&mut self, q: f64) -> Result<&Coefficients, Error>;
}

pub(crate) struct SceneCoefficients<S: StudyScene> {
    scene: Arc<S>,
    models: UnitModels<S::Model>,
    /// Number of requested reactions; in the model with loads, reactions that friction needs may follow.
    reactions: usize,
}

impl<S: StudyScene> fmt::Debug for SceneCoefficients<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, reactions) = (&self.scene.name, self.reactions);
        write!(f, "SceneCoefficients({name}, {reactions} reactions)")
    }
}

impl<S: StudyScene> SceneCoefficients<S> {
    pub(crate) fn new(scene: Arc<S>, models: UnitModels<S::Model>, reactions: usize) -> Self {
        Self {
            scene,
            models,
            reactions,
        }
    }
}

impl<S: StudyScene> CoefficientSource for SceneCoefficients<S> {
    fn evaluator(self: Arc<Self>) -> Box<dyn CoefficientEvaluator> {
        let UnitModels { exact, loaded } = &self.models;
        let loaded = loaded.as_ref();
        Box::new(SceneEvaluator {
            workspace: exact.workspace(),
            exact: exact.coefficient_buffer(),
            loaded: loaded.map(|m| (m.pass_workspace(), m.result_buffer())),
            found: Coefficients::default(),
            of: self,
        })
    }

    fn inertial_batch(&self, q: &[f64]) -> Result<Batch, Error> {
        let (mut batch, exact) = (Batch::default(), &self.models.exact);
        S::inertial_batch(exact, q, &mut batch);
        let first = batch.errors.iter().min_by_key(|(index, _)| *index);
        match first {
            Some((_, error)) => Err(self.scene.explain(exact.model(), &(*error).into()).into()),
            None => Ok(batch),
        }
    }

    fn table(&self, accuracy: f64) -> Result<(TabulatedModel, Labels), Error> {
        let UnitModels { exact, loaded } = &self.models;
        let model = loaded.as_ref().unwrap_or(exact.model());
        let names = self.scene.reaction_units(model).into_iter();
        let coordinate = self.scene.actuator(0).unwrap_or_default().0;
        let labels = Labels {
            scene: self.scene.hash(),
            coordinate: coordinate.to_owned(),
            reactions: names.map(|(name, _)| name).collect(),
            loads: model.loads().iter().map(|load| load.name.clone()).collect(),
        };
        let domain = domain(model.range());
        let tabulated = match ExactModel::new(model.clone()) {
            Some(exact) => TabulatedModel::new(&exact, accuracy, domain),
            None => TabulatedModel::new(exact, accuracy, domain),
        };
        let tabulated = tabulated.map_err(|e| Error::Table(e.to_string()))?;
        Ok((tabulated, labels))
    }
}

/// Working memory of one kind of model.
type Memory<S> =
    <<S as dwell_study::machines::MachineScene>::Model as ReducibleModel>::Workspace<f64>;

/// A period of the range, or else one revolution.
fn domain(range: Range) -> TableDomain {
    match range {
        Range::Unbounded => TableDomain::Between(0.0, TAU),
        Range::Full
        | Range::Revolutions(_)
        | Range::Limited(..)
        | Range::Stroke(..)
        | Range::Unresolved(..) => TableDomain::Full,
    }
}

struct SceneEvaluator<S: StudyScene> {
    of: Arc<SceneCoefficients<S>>,
    workspace: <ExactModel<S::Model> as dwell_kinetostatics::ReducedModel>::Workspace,
    exact: dwell_kinetostatics::Coefficients,
    loaded: Option<(Memory<S>, InverseDynamics<f64>)>,
    found: Coefficients,
}

impl<S: StudyScene> fmt::Debug for SceneEvaluator<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SceneEvaluator").field(&self.of).finish()
    }
}

impl<S: StudyScene> CoefficientEvaluator for SceneEvaluator<S> {
    fn at(&mut self, q: f64) -> Result<&Coefficients, Error> {
        let SceneCoefficients {
            scene,
            models,
            reactions,
        } = &*self.of;
        let (exact, found) = (&mut self.exact, &mut self.found);
        let evaluated = models.exact.coefficients(q, &mut self.workspace, exact);
        evaluated.map_err(|e| scene.explain(models.exact.model(), &e.into()))?;
        (found.m, found.half_dm) = (exact.m, exact.half_dm);
        found.a.clone_from(&exact.a);
        found.b.clone_from(&exact.b);
        let (Some(model), Some((workspace, response))) = (&models.loaded, &mut self.loaded) else {
            return Ok(found);
        };
        // At unit velocity, so that a damper has a direction.
        let mut state = KinematicState::new(model, [&[q], &[1.0]], workspace)
            .map_err(|e| scene.explain(model, &e.into()))?;
        found.w.resize(model.loads().len(), 0.0);
        found.c.resize(model.loads().len(), Vec::new());
        for load in 0..model.loads().len() {
            let done = state.unit_load_response(load, response);
            done.map_err(|e| scene.explain(model, &e.into()))?;
            found.w[load] = -response.tau[0];
            found.c[load].clear();
            found.c[load].extend_from_slice(&response.reactions[..*reactions]);
        }
        Ok(found)
    }
}

/// Evaluates a reduced model at one position after another, without allocation.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let reduced = slider.reduced([])?;
/// let mut evaluator = reduced.evaluator();
/// let m = evaluator.at(0.5)?.m;
/// # assert!(m > 0.0);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug)]
pub struct Evaluator<'m> {
    reduced: &'m ReducedModel,
    own: Box<dyn CoefficientEvaluator>,
}

impl Evaluator<'_> {
    /// Returns its memory to the model.
    pub(crate) fn release(self) {
        self.reduced.idle.all().push(self.own);
    }

    /// The coefficients at `q`, rad or m.
    ///
    /// # Errors
    /// As [`ReducedModel::at`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// # let reduced = slider.reduced([])?;
    /// let mut evaluator = reduced.evaluator();
    /// assert_eq!(evaluator.at(0.5)?, &reduced.at(0.5)?);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn at(&mut self, q: f64) -> Result<&Coefficients, Error> {
        self.own.at(q)
    }
}
