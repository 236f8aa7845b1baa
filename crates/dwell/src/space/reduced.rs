//! The reduced model of a mechanism in space of one degree of freedom.

use crate::batch::CoefficientBatch;
use crate::error::Error;
use crate::reduced::Coefficients;
use crate::space::mechanism::Mechanism;
use crate::space::scene::Scene;
use dwell_dynamics::DynamicsError;
use dwell_kinetostatics::space::{Model, Reaction};
use dwell_kinetostatics::{ExactModel, ReducedModel as _};
use dwell_study::loaded_model_in_space;
use dwell_study::machines::MachineScene as _;
use rayon::prelude::*;

/// Coordinates from which on they are evaluated by several threads.
const MANY: usize = 64;

impl Mechanism {
    /// The reduced model with some reactions: joints (`A` for all its components) or components (`A.x`).
    ///
    /// # Errors
    /// [`Error::Unknown`] for a reaction that the scene does not request or that redundant constraints leave open; [`Error::Study`]
    /// unless there is exactly one actuator.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let reduced = rssr.reduced(["B", "D.z"])?;
    /// assert_eq!(reduced.reactions(), ["B.x", "B.y", "B.z", "D.z"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reduced<'r>(
        &self,
        reactions: impl IntoIterator<Item = &'r str>,
    ) -> Result<ReducedModel, Error> {
        let scene = self.scene.inner();
        let mut wanted: Vec<Reaction> = Vec::new();
        for name in reactions {
            let is_meant = |r: &Reaction| {
                scene.mechanism.joints[r.joint.0].name == name || scene.reaction_name(*r) == name
            };
            let before = wanted.len();
            wanted.extend(self.determined.iter().copied().filter(is_meant));
            if wanted.len() == before {
                let determined = self.determined.iter();
                let names: Vec<String> = determined.map(|r| scene.reaction_name(*r)).collect();
                let joints = scene.mechanism.joints.iter().map(|j| &j.name);
                let names = names.iter().chain(joints).map(String::as_str);
                let what = "statically determinate reaction";
                return Err(Error::unknown(what, "reactions", name, names));
            }
        }
        let model = loaded_model_in_space(scene, &wanted)?.for_unit_loads();
        let Some(exact) = ExactModel::new(model) else {
            // Its error names the actuators.
            return match dwell_study::PreparedSpaceScene::new(scene) {
                Err(error) => Err(error.into()),
                Ok(_) => Err(scene
                    .error("the reduced model needs one actuator".to_owned(), None, &[])
                    .into()),
            };
        };
        Ok(ReducedModel {
            scene: self.scene.clone(),
            exact,
            reactions: wanted,
        })
    }
}

/// m q̈ + ½m′ q̇² = Σ w F and R = a q̈ + b q̇² + Σ c F of a mechanism in space, evaluated exactly.
///
/// ```
/// # let bricard = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
/// let m = bricard.reduced([])?.at(0.4)?.m;
/// assert!(m > 0.0);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ReducedModel {
    pub(crate) scene: Scene,
    pub(crate) exact: ExactModel<Model>,
    reactions: Vec<Reaction>,
}

impl ReducedModel {
    /// The names of its reactions, in the order of a, b and c.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.reduced(["B.x"])?.reactions(), ["B.x"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reactions(&self) -> Vec<String> {
        let scene = self.scene.inner();
        let reactions = self.reactions.iter();
        reactions.map(|r| scene.reaction_name(*r)).collect()
    }

    /// The names of the loads, in the order of w and c.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.reduced([])?.loads(), ["weight"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn loads(&self) -> Vec<&str> {
        let loads = self.scene.inner().loads.iter();
        loads.map(|load| load.name.as_str()).collect()
    }

    /// The coefficients at a coordinate, rad or m.
    ///
    /// # Errors
    /// [`Error::Study`] where the mechanism cannot reach it.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let at = rssr.reduced(["B.x"])?.at(0.3)?;
    /// assert!(at.m > 0.0 && at.a.len() == 1 && at.w.len() == 1 && at.c[0].len() == 1);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn at(&self, q: f64) -> Result<Coefficients, Error> {
        let model = self.exact.model();
        let explain = |error: DynamicsError| {
            let scene = self.scene.inner();
            Error::from(scene.explain(model, &error))
        };
        let mut exact = self.exact.coefficient_buffer();
        let mut workspace = self.exact.workspace();
        let found = self.exact.coefficients(q, &mut workspace, &mut exact);
        found.map_err(|e| explain(e.into()))?;
        let mut found = Coefficients {
            m: exact.m,
            half_dm: exact.half_dm,
            a: exact.a,
            b: exact.b,
            w: Vec::new(),
            c: Vec::new(),
        };
        let (mut workspace, mut response) = (model.workspace(), model.result_buffer());
        // At unit speed, so that a damper has a direction.
        let state = model.kinematic_state(&[q], &[1.0], &mut workspace);
        let mut state = state.map_err(|e| explain(e.into()))?;
        for load in 0..self.scene.inner().loads.len() {
            let done = state.unit_load_response(load, &mut response);
            done.map_err(|e| explain(e.into()))?;
            found.w.push(-response.tau[0]);
            found.c.push(response.reactions.clone());
        }
        Ok(found)
    }

    /// The coefficients at many coordinates, on all cores.
    ///
    /// # Errors
    /// [`Error::Study`] at the first that the mechanism cannot reach.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let q: Vec<f64> = (0..360).map(|k| f64::from(k).to_radians()).collect();
    /// let batch = rssr.reduced(["B.x"])?.batch(&q)?;
    /// assert!(batch.m.len() == 360 && batch.a.len() == 360 && batch.c.len() == 360);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn batch(&self, q: &[f64]) -> Result<CoefficientBatch, Error> {
        let blocks = q.par_chunks(MANY).map(|q| {
            let all = q.iter().map(|&q| self.at(q));
            all.collect::<Result<Vec<_>, _>>()
        });
        let mut batch = CoefficientBatch::default();
        for block in blocks.collect::<Vec<_>>() {
            for at in block? {
                batch.m.push(at.m);
                batch.half_dm.push(at.half_dm);
                batch.a.extend(at.a);
                batch.b.extend(at.b);
                batch.w.extend(at.w);
                batch.c.extend(at.c.into_iter().flatten());
            }
        }
        Ok(batch)
    }
}
