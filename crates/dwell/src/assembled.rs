//! The computations of an assembled mechanism, in the plane or in space.

use crate::equation::{EquationSource, SceneEquation};
use crate::error::Error;
use crate::machine::{Cycle, Equilibrium, StateSpace, cycle_of, equilibria_of, linearisation_of};
use crate::motion::{MotionResults, Period, Solver};
use crate::reduced::{CoefficientSource, SceneCoefficients};
use dwell_dynamics::DynamicsError;
use dwell_kinetostatics::{InverseDynamics, ReducibleModel as _};
use dwell_study::assembled::{AssembledModel, FoundStates};
use dwell_study::gradient::{Gradient, compute_gradient};
use dwell_study::optimise::{Optimised, job_number, optimise};
use dwell_study::{
    Analysis, SceneTask, StudyError, StudyScene, compute_free_motion, compute_period,
    compute_trajectory, no_progress,
};
use std::fmt;
use std::sync::Arc;

/// The named parts of a mechanism, in the order of the scene.
#[derive(Debug)]
pub(crate) struct Names {
    /// 2 in the plane, 3 in space.
    pub(crate) dimension: usize,
    pub(crate) actuators: Vec<String>,
    /// Names of the coordinates, those of the actuators first.
    pub(crate) coordinates: Vec<String>,
    pub(crate) bodies: Vec<NamedBody>,
    pub(crate) reactions: Vec<NamedReaction>,
    pub(crate) loads: Vec<String>,
    /// By actuator: its coordinate at assembly, rad or m.
    pub(crate) start: Vec<f64>,
    /// The limits of the only coordinate, rad or m.
    pub(crate) limits: Option<(f64, f64)>,
}

#[derive(Debug)]
pub(crate) struct NamedBody {
    pub(crate) name: String,
    /// In the frame of the body, m.
    pub(crate) points: Vec<(String, [f64; 3])>,
}

#[derive(Debug)]
pub(crate) struct NamedReaction {
    /// `joint.component`.
    pub(crate) name: String,
    pub(crate) joint: String,
    /// Its index among those of the model; `None` if redundant constraints leave it undetermined.
    pub(crate) place: Option<usize>,
}

impl Names {
    /// The index of a body.
    pub(crate) fn body(&self, name: &str) -> Result<usize, Error> {
        let found = self.bodies.iter().position(|body| body.name == name);
        let names = self.bodies.iter().map(|body| body.name.as_str());
        found.ok_or_else(|| Error::unknown("body", "bodies", name, names))
    }

    /// A point `body.point`: the index of its body, and its position in that body's frame, m.
    pub(crate) fn point(&self, name: &str) -> Result<(usize, [f64; 3]), Error> {
        let (body, point) = name.split_once('.').unwrap_or((name, ""));
        let index = self.body(body)?;
        let points = &self.bodies[index].points;
        let found = points.iter().find(|(known, _)| known == point);
        let all: Vec<String> = points.iter().map(|(p, _)| format!("{body}.{p}")).collect();
        let names = all.iter().map(String::as_str);
        let (_, at) = found.ok_or_else(|| Error::unknown("point", "points", name, names))?;
        Ok((index, *at))
    }
}

/// The computations of an assembled mechanism.
pub(crate) trait Assembled: fmt::Debug + Send + Sync {
    /// The states of all bodies at coordinates, velocities and accelerations.
    fn states(&self, motion: [&[f64]; 3]) -> Result<FoundStates, Error>;

    /// The states and the forces at time `t`, s.
    fn forces(
        &self,
        t: f64,
        motion: [&[f64]; 3],
    ) -> Result<(FoundStates, InverseDynamics<f64>), Error>;

    /// Positions of points of bodies at many coordinates: by position, then by point.
    fn paths(&self, points: &[(usize, [f64; 3])], q: &[f64]) -> Result<Vec<[f64; 3]>, Error>;

    /// The reduced model with some reactions, by index.
    fn reduced(&self, reactions: &[usize]) -> Result<Arc<dyn CoefficientSource>, Error>;

    fn equation(&self) -> Result<Box<dyn EquationSource>, Error>;

    /// The mechanism at given coordinates as SVG, with travels, cams and paths between the limits of the only coordinate.
    #[cfg(feature = "pictures")]
    fn svg(&self, q: &[f64], limits: Option<(f64, f64)>) -> Result<String, Error>;

    fn along_motion(&self, analysis: Analysis) -> Result<MotionResults, Error>;

    fn simulate(&self, solver: &Solver) -> Result<MotionResults, Error>;

    fn period(&self) -> Result<Period, Error>;

    fn equilibria(&self) -> Result<Vec<Equilibrium>, Error>;

    fn linearise(&self) -> Result<StateSpace, Error>;

    fn gradient(&self, results: &[String]) -> Result<Gradient, Error>;

    fn optimise(&self, job: Option<&str>, seed: u64) -> Result<Optimised, Error>;

    fn cycle(&self, solver: &Solver, fluctuation: Option<f64>) -> Result<Cycle, Error>;
}

/// Assembles the mechanism of a scene.
pub(crate) struct Assemble;

impl SceneTask for Assemble {
    type Output = Result<(Names, Arc<dyn Assembled>), Error>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        let assembled = scene.assembled()?;
        let names = names(scene, &assembled);
        let scene = Arc::new(scene.clone());
        let mechanism = AssembledScene { scene, assembled };
        Ok((names, Arc::new(mechanism)))
    }
}

fn names<S: StudyScene>(scene: &S, assembled: &AssembledModel<S>) -> Names {
    let actuators = (0..).map_while(|k| scene.actuator(k));
    let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
    let bodies = scene.named_points().into_iter().map(|(name, points)| {
        let points = points.into_iter().map(|(point, at)| (point.to_owned(), at));
        NamedBody {
            name: name.to_owned(),
            points: points.collect(),
        }
    });
    let reactions = assembled
        .reactions
        .iter()
        .map(|&(reaction, place)| NamedReaction {
            name: scene.name_of_reaction(reaction),
            joint: scene.joint_of(reaction).to_owned(),
            place,
        });
    Names {
        dimension: S::DIMENSION,
        actuators: actuators.map(|(name, _)| name.to_owned()).collect(),
        coordinates: owned(scene.coordinate_names()),
        bodies: bodies.collect(),
        reactions: reactions.collect(),
        loads: owned(scene.load_names()),
        start: scene.assembly_coordinates().to_vec(),
        limits: assembled.model.range().limits(),
    }
}

struct AssembledScene<S: StudyScene> {
    scene: Arc<S>,
    assembled: AssembledModel<S>,
}

impl<S: StudyScene> fmt::Debug for AssembledScene<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("AssembledScene")
            .field(&self.scene.name)
            .finish()
    }
}

impl<S: StudyScene> AssembledScene<S> {
    fn explain(&self, error: &DynamicsError) -> StudyError {
        self.scene.explain(&self.assembled.model, error)
    }
}

impl<S: StudyScene> Assembled for AssembledScene<S> {
    fn states(&self, motion: [&[f64]; 3]) -> Result<FoundStates, Error> {
        let found = self.scene.body_states(&self.assembled.model, motion);
        Ok(found.map_err(|error| self.explain(&error))?)
    }

    fn forces(
        &self,
        t: f64,
        motion: [&[f64]; 3],
    ) -> Result<(FoundStates, InverseDynamics<f64>), Error> {
        let model = &self.assembled.model;
        let mut forces = model.result_buffer();
        let found = self
            .scene
            .loaded_states(model, t, motion, &mut forces)
            .map_err(|error| self.explain(&error))?;
        Ok((found, forces))
    }

    fn paths(&self, points: &[(usize, [f64; 3])], q: &[f64]) -> Result<Vec<[f64; 3]>, Error> {
        let found = self.scene.paths(&self.assembled.model, points, q);
        Ok(found.map_err(|error| self.explain(&error.into()))?)
    }

    fn reduced(&self, reactions: &[usize]) -> Result<Arc<dyn CoefficientSource>, Error> {
        let all = &self.assembled.reactions;
        let wanted: Vec<S::Reaction> = reactions.iter().map(|&k| all[k].0).collect();
        let models = self.scene.unit_models(&wanted)?;
        let scene = Arc::clone(&self.scene);
        Ok(Arc::new(SceneCoefficients::new(
            scene,
            models,
            wanted.len(),
        )))
    }

    fn equation(&self) -> Result<Box<dyn EquationSource>, Error> {
        let (machine, start) = self.scene.motion_machine()?;
        let scene = Arc::clone(&self.scene);
        Ok(Box::new(SceneEquation::new(scene, machine, start)))
    }

    #[cfg(feature = "pictures")]
    fn svg(&self, q: &[f64], limits: Option<(f64, f64)>) -> Result<String, Error> {
        const INTERVALS: usize = 72;
        let rest = vec![0.0; q.len()];
        let at = |q: &[f64]| Ok::<_, Error>(self.states([q, &rest, &rest])?.0);
        let drawn = at(q)?;
        let others = match q {
            [first] => {
                let (low, high) = limits.unwrap_or((*first, first + std::f64::consts::TAU));
                let place = |k| low + (high - low) * k as f64 / INTERVALS as f64;
                // Positions that cannot be reached are skipped; the limits themselves are singular.
                (0..=INTERVALS)
                    .filter_map(|k| at(&[place(k)]).ok())
                    .collect()
            }
            _ => vec![at(q)?],
        };
        Ok(self.scene.svg(&*drawn, &others)?)
    }

    fn along_motion(&self, analysis: Analysis) -> Result<MotionResults, Error> {
        let computed = compute_trajectory(&*self.scene, analysis, None, &no_progress)?;
        Ok(MotionResults::new(computed))
    }

    fn simulate(&self, solver: &Solver) -> Result<MotionResults, Error> {
        let motion = compute_free_motion(&*self.scene, &solver.0, &no_progress)?;
        let mut results = MotionResults::new(motion.computed);
        results.events = motion.events;
        results.estimated_error = motion.estimated_error;
        Ok(results)
    }

    fn period(&self) -> Result<Period, Error> {
        let orbit = compute_period(&*self.scene)?;
        Ok(Period {
            period: orbit.period,
            energy: orbit.energy,
        })
    }

    fn equilibria(&self) -> Result<Vec<Equilibrium>, Error> {
        equilibria_of(&*self.scene)
    }

    fn linearise(&self) -> Result<StateSpace, Error> {
        linearisation_of(&*self.scene)
    }

    fn optimise(&self, job: Option<&str>, seed: u64) -> Result<Optimised, Error> {
        let job = job_number(&self.scene, job)?;
        Ok(optimise(&*self.scene, job, seed, &no_progress)?)
    }

    fn gradient(&self, results: &[String]) -> Result<Gradient, Error> {
        Ok(compute_gradient(
            &*self.scene,
            results,
            false,
            &no_progress,
        )?)
    }

    fn cycle(&self, solver: &Solver, fluctuation: Option<f64>) -> Result<Cycle, Error> {
        cycle_of(&*self.scene, solver, fluctuation)
    }
}
