//! The exact functions of a scene's machine at a coordinate.

use super::description::ExportedScene;
use dwell_dynamics::DynamicsError;
use dwell_export::{Function, FunctionSampler, PartKind};
use dwell_kinetostatics::{Coefficients, InverseDynamics, Workspace};

/// A model with the working memory to evaluate it.
pub(crate) struct SceneSampler<'a> {
    exported: &'a ExportedScene<'a>,
    workspace: Workspace<f64>,
    coefficients: Coefficients,
    response: InverseDynamics<f64>,
    curves: [Vec<Function>; 3],
    columns: [Vec<Function>; 3],
}

impl<'a> SceneSampler<'a> {
    pub(crate) fn new(exported: &'a ExportedScene<'a>) -> Self {
        let (model, description) = (&exported.model, &exported.description);
        Self {
            workspace: model.workspace(),
            coefficients: model.coefficient_buffer(),
            response: model.result_buffer(),
            curves: PartKind::ALL.map(|kind| description.curves(kind)),
            columns: PartKind::ALL.map(|kind| description.columns(kind)),
            exported,
        }
    }
}

impl FunctionSampler for SceneSampler<'_> {
    type Error = DynamicsError;

    fn sample(
        &mut self,
        part: PartKind,
        q: f64,
        curves: &mut [[f64; 2]],
        columns: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let Self {
            exported,
            workspace,
            coefficients,
            response,
            curves: of_curves,
            columns: of_columns,
        } = self;
        let model = &exported.model;
        if part != PartKind::Positions {
            model.reduce(q, workspace, coefficients)?;
        }
        let mut state = model.kinematic_state(&[q], &[1.0], workspace)?;
        for (out, function) in curves.iter_mut().zip(&of_curves[part as usize]) {
            *out = match *function {
                Function::Potential(load) => {
                    state.unit_load_response(load, response)?;
                    let potential = state.potential_energy(load).unwrap_or(f64::NAN);
                    [potential, 0.5 * response.tau[0]]
                }
                // The others are columns.
                _ => [coefficients.m, coefficients.half_dm],
            };
        }
        let mut evaluated = None;
        for (out, function) in columns.iter_mut().zip(&of_columns[part as usize]) {
            if let Function::W(load) | Function::C(load, _) = *function
                && evaluated != Some(load)
            {
                state.unit_load_response(load, response)?;
                evaluated = Some(load);
            }
            *out = match *function {
                Function::W(_) => -response.tau[0],
                Function::A(k) => coefficients.a[k],
                Function::B(k) => coefficients.b[k],
                Function::C(_, k) => response.reactions[k],
                Function::Position(k, axis) => {
                    let point = &exported.scene.requests.paths[k];
                    let at = state.bodies_at(&[0.0]).point(point.body, point.at).position;
                    if axis == 0 { at.x } else { at.y }
                }
                // They are curves.
                Function::Inertia | Function::Potential(_) => f64::NAN,
            };
        }
        Ok(())
    }
}
