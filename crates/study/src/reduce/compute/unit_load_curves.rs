//! Unit-load response over the range: generalised force and reactions per unit of each load.
//!
//! ```text
//! m q̈ + ½m′ q̇² = Σ w_ℓ F_ℓ,    R_k = a_k q̈ + b_k q̇² + Σ c_kℓ F_ℓ
//! ```
//!
//! F is the magnitude in the scene, for a drag times |q̇| q̇; for a damper, friction or a separating force, F is the force or moment
//! itself. A separating force is |tooth force| tan α of the whole sum, so that it belongs to one state: its column c is the response to one
//! newton of it. Its w is zero and has no column.

use crate::explain::{StudyError, explain_motion};
use crate::models::{PreparedScene, loaded_determinate_model};
use crate::reduce::compute::ReducedScene;
use dwell_findings::Column;
use dwell_kinetostatics::{KinetostaticsError, Load, LoadShape};

/// The unit-load response of every load over the range.
pub struct UnitLoadCurves {
    pub(crate) loads: Vec<ReducedLoad>,
    /// By position and load: w, then c of each reaction.
    pub(crate) rows: Vec<Vec<Vec<f64>>>,
    /// By position: the potential of all conservative loads, J.
    pub(crate) potential: Vec<f64>,
    pub(crate) conservative: bool,
}

/// A load, with the texts of its columns.
pub(crate) struct ReducedLoad {
    pub(crate) name: String,
    /// Units of w, and of c of a force and of a moment.
    pub(crate) units: [&'static str; 3],
    /// Whether it has a w.
    pub(crate) does_work: bool,
}

/// Loads along an angle or a length.
pub(crate) fn reduced_loads<K: LoadShape, C>(
    loads: &[Load<K, C>],
    is_angle: bool,
) -> Vec<ReducedLoad> {
    let loads = loads.iter().map(|load| ReducedLoad {
        name: load.name.clone(),
        units: load.kind.response_units(is_angle),
        does_work: load.does_work(),
    });
    loads.collect()
}

impl UnitLoadCurves {
    /// The unit of w of a load.
    pub fn unit(&self, load: usize) -> &'static str {
        self.loads[load].units[0]
    }

    /// The indices of the loads that have a w.
    pub(crate) fn working(&self) -> impl Iterator<Item = usize> {
        let all = 0..self.loads.len();
        all.filter(|&l| self.loads[l].does_work)
    }

    /// The unit-load response at the coordinates `q` (rad or m); `None` without loads.
    pub(crate) fn new(prepared: &PreparedScene<'_>, q: &[f64]) -> Result<Option<Self>, StudyError> {
        let scene = prepared.scene;
        if scene.loads.is_empty() {
            return Ok(None);
        }
        let model = loaded_determinate_model(scene)?;
        let explain = |e: KinetostaticsError| explain_motion(scene, model.plan(), &e.into());
        let (mut workspace, mut results) = (model.workspace(), model.result_buffer());
        let loads = 0..scene.loads.len();
        let mut curves = Self {
            loads: reduced_loads(&scene.loads, prepared.is_angle()),
            rows: Vec::with_capacity(q.len()),
            potential: Vec::with_capacity(q.len()),
            conservative: loads.clone().any(|l| {
                let load = &scene.loads[l];
                load.does_work() && load.is_conservative()
            }),
        };
        for &q in q {
            let state = model.kinematic_state(&[q], &[1.0], &mut workspace);
            let loaded = state.map_err(KinetostaticsError::from);
            let loaded = loaded.and_then(|state| state.apply_loads(0.0));
            let mut state = loaded.map_err(explain)?;
            let mut row = Vec::with_capacity(curves.loads.len());
            for load in loads.clone() {
                let response = state.unit_load_response(load, &mut results);
                response.map_err(explain)?;
                let mut values = vec![-results.tau[0]];
                values.extend(&results.reactions);
                row.push(values);
            }
            curves.rows.push(row);
            let all = loads.clone();
            let potentials = all.filter_map(|load| state.potential_energy(load));
            curves.potential.push(potentials.sum());
        }
        Ok(Some(curves))
    }

    /// The columns and their values: V, w of each load, c of each reaction and load.
    pub fn columns(&self, prepared: &dyn ReducedScene) -> Vec<(Column, Vec<f64>)> {
        let mut all = Vec::new();
        if self.conservative {
            all.push((Column::new("V", "J"), self.potential.clone()));
        }
        let value = |load: usize, k: usize| self.rows.iter().map(|row| row[load][k]).collect();
        for (l, load) in self.working().map(|l| (l, &self.loads[l])) {
            let [unit, ..] = load.units;
            all.push((Column::new(format!("{}.w", load.name), unit), value(l, 0)));
        }
        for (k, (name, of)) in prepared.reaction_units().into_iter().enumerate() {
            for (l, load) in self.loads.iter().enumerate() {
                let [_, force, moment] = load.units;
                let unit = if of == "N" { force } else { moment };
                let name = format!("{name}.c.{}", load.name);
                all.push((Column::new(name, unit), value(l, k + 1)));
            }
        }
        all
    }
}
