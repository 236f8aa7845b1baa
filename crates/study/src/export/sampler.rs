//! The exact functions of a scene's machine at a coordinate, in any kind of number: as values, and as the operations that
//! compute them.

use super::description::ExportedScene;
use dwell_dynamics::DynamicsError;
use dwell_export::{Function, FunctionSampler, PartKind};
use dwell_kinetostatics::{Coefficients, InverseDynamics, Workspace};
use dwell_numerics::{RecordedNumber, RecordingError, Scalar, StraightLine, record};

/// Parts of the domain at which the operations are recorded: they must be the same.
const RECORDED_AT: [f64; 4] = [0.137, 0.412, 0.659, 0.921];

/// A model with the working memory to evaluate it.
pub(crate) struct SceneSampler<'a, T: Scalar = f64> {
    exported: &'a ExportedScene<'a>,
    workspace: Workspace<T>,
    coefficients: Coefficients<T>,
    response: InverseDynamics<T>,
    curves: [Vec<Function>; 3],
    columns: [Vec<Function>; 3],
}

impl<'a, T: Scalar> SceneSampler<'a, T> {
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

    /// All functions of a part, as [`FunctionSampler::sample`].
    fn evaluate(
        &mut self,
        part: PartKind,
        q: T,
        curves: &mut [[T; 2]],
        columns: &mut [T],
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
        let constant = T::from_f64;
        if part != PartKind::Positions {
            model.reduce(q, workspace, coefficients)?;
        }
        let mut state = model.kinematic_state(&[q], &[constant(1.0)], workspace)?;
        for (out, function) in curves.iter_mut().zip(&of_curves[part as usize]) {
            *out = match *function {
                Function::Potential(load) => {
                    state.unit_load_response(load, response)?;
                    let potential = state.potential(load).unwrap_or(constant(f64::NAN));
                    [potential, constant(0.5) * response.tau[0]]
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
                    let bodies = state.bodies_at(&[constant(0.0)]);
                    let at = bodies.point(point.body, point.at).position;
                    if axis == 0 { at.x } else { at.y }
                }
                // They are curves.
                Function::Inertia | Function::Potential(_) => constant(f64::NAN),
            };
        }
        Ok(())
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
        self.evaluate(part, q, curves, columns)
    }
}

/// The operations of all functions, by part.
///
/// # Errors
/// [`RecordingError`] if they differ over the domain.
pub(crate) fn recorded(
    exported: &ExportedScene<'_>,
) -> Result<[StraightLine; 3], RecordingError<DynamicsError>> {
    let description = &exported.description;
    let domain = description.domain;
    let coordinates = RECORDED_AT.map(|part| domain.from + part * domain.length());
    let one = |part: PartKind| {
        record(&coordinates, |q| {
            let mut sampler = SceneSampler::<RecordedNumber>::new(exported);
            let zero = RecordedNumber::default();
            let mut curves = vec![[zero; 2]; description.curves(part).len()];
            let mut columns = vec![zero; description.columns(part).len()];
            sampler.evaluate(part, q, &mut curves, &mut columns)?;
            Ok(curves.into_iter().flatten().chain(columns).collect())
        })
    };
    Ok([
        one(PartKind::Motion)?,
        one(PartKind::Reactions)?,
        one(PartKind::Positions)?,
    ])
}
