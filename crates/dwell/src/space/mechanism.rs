//! An assembled mechanism in space, and what can be asked of it.

use crate::error::Error;
use crate::machine::{Cycle, Equilibrium, StateSpace, cycle_of, equilibria_of, linearisation_of};
use crate::motion::{MotionResults, Period, Solver};
use crate::space::scene::Scene;
use crate::space::state::{InverseDynamics, Kinematics};
use dwell_dynamics::DynamicsError;
use dwell_kinetostatics::space::{Model, Reaction};
use dwell_study::machines::MachineScene as _;
use dwell_study::{
    Analysis, compute_free_motion_in_space, compute_period_in_space, compute_trajectory_in_space,
    loaded_model_in_space, no_progress,
};
use std::sync::Arc;

/// An assembled mechanism in space: constant, shared between threads.
///
/// ```
/// let bricard = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
/// assert_eq!(bricard.actuators(), ["q"]);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mechanism {
    pub(super) scene: Scene,
    /// With all loads, and the reactions that these determine.
    model: Arc<Model>,
    pub(super) determined: Arc<[Reaction]>,
}

impl Mechanism {
    pub(super) fn new(scene: Scene) -> Result<Self, Error> {
        let inner = scene.inner();
        let all = loaded_model_in_space(inner, &inner.reactions)?;
        let [determined, _] = inner.sorted_reactions(&all)?;
        let model = loaded_model_in_space(inner, &determined)?;
        Ok(Self {
            scene,
            model: Arc::new(model),
            determined: determined.into(),
        })
    }

    /// The scene it is assembled from.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert!(rssr.scene().title().contains("crank-rocker"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Names of the actuators, whose coordinates are those of the mechanism.
    ///
    /// ```
    /// # let governor = dwell::space::Scene::read("../../validation/spatial/governor.toml")?.assemble()?;
    /// assert_eq!(governor.actuators(), ["q", "s"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn actuators(&self) -> Vec<&str> {
        let actuators = &self.scene.inner().mechanism.actuators;
        actuators.iter().map(|a| a.name.as_str()).collect()
    }

    /// Names of the reactions that the scene requests, also of those that redundant constraints leave open.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert!(rssr.reactions().contains(&"D.moment-x".to_owned()));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reactions(&self) -> Vec<String> {
        let scene = self.scene.inner();
        let all = scene.reactions.iter();
        all.map(|r| scene.reaction_name(*r)).collect()
    }

    /// Those of them that redundant constraints do not leave open.
    ///
    /// ```
    /// # let bricard = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
    /// assert!(bricard.determined_reactions().len() < bricard.reactions().len());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn determined_reactions(&self) -> Vec<String> {
        let scene = self.scene.inner();
        let all = self.determined.iter();
        all.map(|r| scene.reaction_name(*r)).collect()
    }

    /// Names of the bodies, each with those of its points.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.points()[1], ("crank", vec!["A", "B"]));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn points(&self) -> Vec<(&str, Vec<&str>)> {
        let scene = self.scene.inner();
        let bodies = scene.mechanism.bodies.iter().zip(&scene.points);
        let named = bodies.map(|(body, points)| {
            let points = points.iter().map(|(point, _)| point.as_str());
            (body.name.as_str(), points.collect())
        });
        named.collect()
    }

    /// The coordinates at assembly, rad or m.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.start(), [0.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn start(&self) -> Vec<f64> {
        self.scene.inner().assembly.q.clone()
    }

    /// The limits of the only coordinate, rad or m, if it has any.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.limits(), None); // the crank turns
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn limits(&self) -> Option<(f64, f64)> {
        self.model.plan().range().limits()
    }

    /// The positions of all bodies at coordinates, rad or m.
    ///
    /// # Errors
    /// [`Error::Count`]; [`Error::Study`] where the mechanism cannot reach them.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.positions(&[0.0])?.position("crank.B")?, [0.1, 0.0, 0.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn positions(&self, q: &[f64]) -> Result<Kinematics, Error> {
        let rest = vec![0.0; q.len()];
        self.kinematics(q, &rest, &rest)
    }

    /// Positions, velocities and accelerations of all bodies.
    ///
    /// # Errors
    /// As [`positions`](Self::positions).
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let at = rssr.kinematics(&[0.3], &[10.0], &[0.0])?;
    /// assert!(at.velocity("rocker.C")?.iter().any(|v| v.abs() > 0.1));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinematics(
        &self,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
    ) -> Result<Kinematics, Error> {
        self.check_counts([q, q_dot, q_ddot])?;
        let plan = self.model.plan();
        let mut pose = plan.pose();
        let reached = plan.positions(q, &mut pose);
        reached.map_err(|e| self.explain(&e.into()))?;
        plan.velocities(q_dot, &mut pose);
        plan.accelerations(q_ddot, &mut pose);
        let bodies = 0..self.scene.inner().mechanism.bodies.len();
        let bodies = bodies.map(|b| (plan.placement(&pose, b), plan.body_motion(&pose, b)));
        Ok(Kinematics::new(self.scene.clone(), bodies.collect()))
    }

    /// The actuator forces and reactions that a motion needs under inertia and all loads at time t, s: the inverse dynamics.
    ///
    /// # Errors
    /// As [`positions`](Self::positions), and where a load has no direction or no finite magnitude.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let forces = rssr.inverse_dynamics(0.0, &[0.3], &[10.0], &[0.0])?;
    /// assert!(forces.reaction("B.x")?.abs() > 0.1);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn inverse_dynamics(
        &self,
        t: f64,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
    ) -> Result<InverseDynamics, Error> {
        let kinematics = self.kinematics(q, q_dot, q_ddot)?;
        let (mut workspace, mut result) = (self.model.workspace(), self.model.result_buffer());
        let done = self
            .model
            .kinetostatics(t, [q, q_dot, q_ddot], &mut workspace, &mut result);
        done.map_err(|e| self.explain(&e.into()))?;
        Ok(InverseDynamics::new(self.clone(), kinematics, result))
    }

    /// Positions, velocities and accelerations along the scene's prescribed motion, coordinate sweep, or range: the columns of
    /// `dwell kinematics`.
    ///
    /// # Errors
    /// [`Error::Study`] when the scene gives no coordinates, or the first position cannot be reached.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert!(rssr.kinematics_along_motion()?.column("rocker.C.x").is_ok());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinematics_along_motion(&self) -> Result<MotionResults, Error> {
        self.along_motion(Analysis::Kinematics)
    }

    /// Actuator forces and reactions at rest in every position.
    ///
    /// # Errors
    /// As [`kinematics_along_motion`](Self::kinematics_along_motion).
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let [a, d] = ["A.z", "D.z"].map(|name| rssr.statics_along_motion().and_then(|s| s.column(name)));
    /// assert!((a?[0] + d?[0] - 2.3 * 9.81).abs() < 1e-11);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn statics_along_motion(&self) -> Result<MotionResults, Error> {
        self.along_motion(Analysis::Statics)
    }

    /// Everything of [`kinematics_along_motion`](Self::kinematics_along_motion), and the forces that the motion needs.
    ///
    /// # Errors
    /// As [`kinematics_along_motion`](Self::kinematics_along_motion).
    ///
    /// ```
    /// # let text = std::fs::read_to_string("../../validation/spatial/rssr.toml").unwrap_or_default();
    /// let text = text + "[prescribed]\nduration = 1.0\nq = { speed = 6.0 }\n";
    /// let rssr = dwell::space::Scene::parse(&text)?.assemble()?;
    /// assert!(rssr.kinetostatics()?.column("q.actuator_force").is_ok());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinetostatics(&self) -> Result<MotionResults, Error> {
        self.along_motion(Analysis::Kinetostatics)
    }

    fn along_motion(&self, analysis: Analysis) -> Result<MotionResults, Error> {
        let computed = compute_trajectory_in_space(self.scene.inner(), analysis, &no_progress)?;
        Ok(MotionResults::new(computed))
    }

    /// The free motion under loads and drives: the columns of `dwell simulate`.
    ///
    /// # Errors
    /// [`Error::Study`] when the scene has no motion, or its start cannot be evaluated; what ends it later is in
    /// [`MotionResults::early_stop`].
    ///
    /// ```
    /// # let text = std::fs::read_to_string("../../validation/spatial/bricard-a04.toml").unwrap_or_default();
    /// let text = text + "[motion]\nduration = 1.0\n";
    /// let bricard = dwell::space::Scene::parse(&text)?.assemble()?;
    /// let motion = bricard.simulate(&dwell::Solver::accuracy(1e-8))?;
    /// assert!(motion.estimated_error.is_some_and(|error| error <= 1e-8));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn simulate(&self, solver: &Solver) -> Result<MotionResults, Error> {
        let motion = compute_free_motion_in_space(self.scene.inner(), &solver.0, &no_progress)?;
        let mut results = MotionResults::new(motion.computed);
        results.events = motion.events;
        results.estimated_error = motion.estimated_error;
        Ok(results)
    }

    /// Period and energy of the free motion of one coordinate under loads that have a potential, by quadrature.
    ///
    /// # Errors
    /// [`Error::Study`] when the scene has no motion, or it is not conservative.
    ///
    /// ```
    /// # let text = std::fs::read_to_string("../../validation/spatial/bricard-a04.toml").unwrap_or_default();
    /// let bricard = dwell::space::Scene::parse(&(text + "[motion]\nduration = 1.0\n"))?.assemble()?;
    /// assert!((bricard.period()?.period - 4.991711513688724).abs() < 1e-11);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn period(&self) -> Result<Period, Error> {
        let orbit = compute_period_in_space(self.scene.inner())?;
        Ok(Period {
            period: orbit.period,
            energy: orbit.energy,
        })
    }

    /// The equilibria under the loads, with stability and modes.
    ///
    /// # Errors
    /// [`Error::Study`] when a load depends on time.
    ///
    /// ```
    /// # let bricard = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
    /// let [only] = &bricard.equilibria()?[..] else { panic!("one equilibrium") };
    /// assert!((only.coordinates[0].to_degrees() - 90.0).abs() < 1e-6);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn equilibria(&self) -> Result<Vec<Equilibrium>, Error> {
        equilibria_of(self.scene.inner())
    }

    /// Small motions about the equilibrium nearest to the initial state.
    ///
    /// # Errors
    /// [`Error::Study`] when there is none.
    ///
    /// ```
    /// # let bricard = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
    /// assert_eq!(bricard.linearise()?.a.len(), 2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn linearise(&self) -> Result<StateSpace, Error> {
        linearisation_of(self.scene.inner())
    }

    /// The steady cycle of a rotating machine, and the flywheel that keeps its coefficient of fluctuation to `fluctuation`.
    ///
    /// # Errors
    /// [`Error::Study`] where there is no steady cycle.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert!(rssr.cycle(&dwell::Solver::accuracy(1e-8), None).is_err()); // nothing drives it
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn cycle(&self, solver: &Solver, fluctuation: Option<f64>) -> Result<Cycle, Error> {
        cycle_of(self.scene.inner(), solver, fluctuation)
    }

    fn explain(&self, error: &DynamicsError) -> Error {
        self.scene.inner().explain(&self.model, error).into()
    }

    fn check_counts(&self, lists: [&[f64]; 3]) -> Result<(), Error> {
        let actuators = self.model.plan().actuators();
        Error::check_counts(lists, actuators)
    }
}
