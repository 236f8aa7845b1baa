//! The reduced model of a mechanism of one degree of freedom.

use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::mechanism::scene::Scene;
use dwell_geometry::Reaction;
use dwell_kinetostatics::{
    ExactModel, ExactWorkspace, InverseDynamics, Model, ReducedModel as _, Workspace,
};
use dwell_study::explain::{explain_motion, explain_position};
use dwell_study::models::{compile_model, reduced_model};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

impl Mechanism {
    /// The reduced model with some reactions: joints (`A` for all its components) or components (`guide.normal`).
    ///
    /// ```text
    /// m q̈ + ½m′ q̇² = Σ w F,    R = a q̈ + b q̇² + Σ c F
    /// ```
    ///
    /// # Errors
    /// [`Error::Unknown`] for a reaction that the mechanism does not have; [`Error::Study`] unless it has exactly one
    /// actuator.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let reduced = slider.reduced(["A", "guide.normal"])?;
    /// assert_eq!(reduced.reactions(), ["A.x", "A.y", "guide.normal"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reduced<'r>(
        &self,
        reactions: impl IntoIterator<Item = &'r str>,
    ) -> Result<ReducedModel, Error> {
        let mechanism = &self.scene.inner().mechanism;
        let all = mechanism.reactions();
        let mut wanted: Vec<Reaction> = Vec::new();
        for name in reactions {
            let is_meant = |r: &Reaction| {
                mechanism.joints[r.joint.0].name == name || mechanism.reaction_name(*r) == name
            };
            let meant = all.iter().copied().filter(is_meant);
            let before = wanted.len();
            wanted.extend(meant);
            if wanted.len() == before {
                let names = self.reactions();
                let joints = mechanism.joints.iter().map(|j| &j.name);
                let names = names.iter().chain(joints).map(String::as_str);
                return Err(Error::unknown("reaction", "reactions", name, names));
            }
        }
        ReducedModel::new(self.scene.clone(), wanted)
    }
}

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
    pub(crate) scene: Scene,
    pub(crate) exact: ExactModel,
    /// With the loads, if there are any; its reactions may be followed by those that friction needs.
    pub(crate) loaded: Option<Model>,
    pub(crate) reactions: Vec<Reaction>,
    idle: IdleWorkspaces,
}

/// Working memory that no evaluator has at present: to allocate it takes longer than to evaluate a position. Copies of a model share it.
#[derive(Debug, Clone, Default)]
struct IdleWorkspaces(Arc<Mutex<Vec<EvaluatorWorkspace>>>);

impl IdleWorkspaces {
    /// A thread that panicked with the lock left whole memory.
    fn all(&self) -> MutexGuard<'_, Vec<EvaluatorWorkspace>> {
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
    /// By load, then by reaction: its share in the reaction per unit of F.
    pub c: Vec<Vec<f64>>,
}

impl ReducedModel {
    fn new(scene: Scene, reactions: Vec<Reaction>) -> Result<Self, Error> {
        let inner = scene.inner();
        let exact = reduced_model(inner, &reactions)?;
        let loaded = match inner.loads.is_empty() {
            true => None,
            false => {
                let model = compile_model(inner, &reactions)?;
                let loaded = model.with_loads(inner.loads.clone());
                Some(loaded.map_err(|e| inner.error(e.to_string(), None, &[]))?)
            }
        };
        Ok(Self {
            scene,
            exact,
            loaded,
            reactions,
            idle: IdleWorkspaces::default(),
        })
    }

    /// Names of the reactions.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.reduced(["guide"])?.reactions(), ["guide.normal", "guide.moment"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reactions(&self) -> Vec<String> {
        let mechanism = &self.scene.inner().mechanism;
        self.reactions
            .iter()
            .map(|r| mechanism.reaction_name(*r))
            .collect()
    }

    /// Names of the loads.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.reduced(["guide"])?.loads(), ["weight", "gas"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn loads(&self) -> Vec<&str> {
        let loads = self.scene.inner().loads.iter();
        loads.map(|load| load.name.as_str()).collect()
    }

    /// The coefficients at `q`, rad or m. For many positions an [`evaluator`](Self::evaluator) allocates nothing at all.
    ///
    /// # Errors
    /// [`Error::Study`] where the mechanism cannot reach `q`.
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
            own: idle.unwrap_or_else(|| EvaluatorWorkspace::new(self)),
        }
    }
}

/// What an evaluation works in.
#[derive(Debug)]
struct EvaluatorWorkspace {
    workspace: ExactWorkspace,
    exact: dwell_kinetostatics::Coefficients,
    loaded: Option<(Workspace<f64>, InverseDynamics<f64>)>,
    found: Coefficients,
}

impl EvaluatorWorkspace {
    fn new(of: &ReducedModel) -> Self {
        let loaded = of.loaded.as_ref();
        Self {
            workspace: of.exact.workspace(),
            exact: of.exact.model().coefficient_buffer(),
            loaded: loaded.map(|m| (m.workspace(), m.result_buffer())),
            found: Coefficients::default(),
        }
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
    own: EvaluatorWorkspace,
}

impl Evaluator<'_> {
    /// Leaves its memory to the next.
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
        let reduced = self.reduced;
        let EvaluatorWorkspace {
            workspace,
            exact,
            loaded,
            found,
        } = &mut self.own;
        let scene = reduced.scene.inner();
        let evaluated = reduced.exact.coefficients(q, workspace, exact);
        evaluated.map_err(|e| explain_position(scene, reduced.exact.model().plan(), &e))?;
        let reactions = reduced.reactions.len();
        (found.m, found.half_dm) = (exact.m, exact.half_dm);
        found.a.clone_from(&exact.a);
        found.b.clone_from(&exact.b);
        let (Some(model), Some((workspace, response))) = (&reduced.loaded, loaded) else {
            return Ok(found);
        };
        let explain = |e| Error::from(explain_motion(scene, model.plan(), &e));
        // At unit speed, so that a damper has a direction.
        let state = model.kinematic_state(&[q], &[1.0], workspace);
        let mut state = state.map_err(|e| explain(e.into()))?;
        found.w.resize(model.loads().len(), 0.0);
        found.c.resize(model.loads().len(), Vec::new());
        for load in 0..model.loads().len() {
            let done = state.unit_load_response(load, response);
            done.map_err(|e| explain(e.into()))?;
            found.w[load] = -response.tau[0];
            found.c[load].clear();
            found.c[load].extend_from_slice(&response.reactions[..reactions]);
        }
        Ok(found)
    }
}
