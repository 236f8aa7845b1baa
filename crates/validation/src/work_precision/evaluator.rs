//! Evaluators of the equation of motion and of the reactions.

use super::combination::Evaluation;
use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_dynamics::{
    DynamicsError, EvaluatedIn, Machine, MachineOde, MachineWorkspace, MovingModel, OdeState,
    OdeSystem, Orbit, ReducedOde, ReducedOutputs, ReducedState, TabulatedMachine,
};
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::{Coefficients, ExactModel, Inertia, ReducedModel, ReducibleModel};
use dwell_numerics::Scalar;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Computes the reactions at a state, N or N·m.
pub type ReactionFn<'e> = Box<dyn FnMut(&OdeState, &mut [f64]) -> Result<(), DynamicsError> + 'e>;

/// An evaluator. Another kind of table or of number is studied by implementing this.
pub trait Evaluator {
    /// Its name and data.
    fn evaluation(&self) -> Evaluation;

    /// The equation of motion with its workspace.
    ///
    /// # Errors
    /// [`DynamicsError`] if the start cannot be evaluated.
    fn system(&self) -> Result<Box<dyn OdeSystem + '_>, DynamicsError>;

    /// The reactions, in its own arithmetic, with their workspace.
    fn reactions(&self) -> ReactionFn<'_>;

    /// The number of evaluations that one Jacobian counts as: a dual number counts as two.
    fn jacobian_weight(&self) -> usize;

    /// The time of building it, s.
    fn build_time(&self) -> f64;

    /// The motion by quadrature with its number of evaluations; `None` if the energy does not determine it.
    fn orbit(&self, start: ReducedState) -> Option<(Orbit, usize)>;
}

/// A reduced model of one degree of freedom without loads.
#[derive(Debug)]
pub struct ModelEvaluator<R: ReducedModel> {
    /// The model, with the reactions that are compared.
    pub model: R,
    /// Its name and data.
    pub evaluation: Evaluation,
    /// The time of building it, s.
    pub build_time: f64,
}

impl<R: ReducedModel> Evaluator for ModelEvaluator<R> {
    fn evaluation(&self) -> Evaluation {
        self.evaluation
    }

    fn system(&self) -> Result<Box<dyn OdeSystem + '_>, DynamicsError> {
        Ok(Box::new(ReducedOde::new(&self.model)))
    }

    fn reactions(&self) -> ReactionFn<'_> {
        let mut outputs = ReducedOutputs::new(&self.model);
        Box::new(move |point, out| {
            outputs.evaluate(point.y[0], point.y[1])?;
            out.copy_from_slice(&outputs.reactions);
            Ok(())
        })
    }

    fn jacobian_weight(&self) -> usize {
        2
    }

    fn build_time(&self) -> f64 {
        self.build_time
    }

    fn orbit(&self, start: ReducedState) -> Option<(Orbit, usize)> {
        let counted = CountingModel {
            model: &self.model,
            count: AtomicUsize::new(0),
        };
        let orbit = Orbit::new(&counted, start).ok()?;
        Some((orbit, counted.count.into_inner()))
    }
}

/// A model that counts its evaluations.
struct CountingModel<'a, R> {
    model: &'a R,
    count: AtomicUsize,
}

impl<R: ReducedModel> ReducedModel for CountingModel<'_, R> {
    type Workspace = R::Workspace;

    fn workspace(&self) -> R::Workspace {
        self.model.workspace()
    }

    fn reactions(&self) -> usize {
        self.model.reactions()
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn inertia(&self, q: f64, workspace: &mut R::Workspace) -> Result<(f64, f64), PositionError> {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.model.inertia(q, workspace)
    }

    fn inertia_derivatives(&self, q: f64, at: &mut R::Workspace) -> Result<Inertia, PositionError> {
        self.count.fetch_add(2, Ordering::Relaxed);
        self.model.inertia_derivatives(q, at)
    }

    fn coefficients(
        &self,
        q: f64,
        workspace: &mut R::Workspace,
        out: &mut Coefficients,
    ) -> Result<(), PositionError> {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.model.coefficients(q, workspace, out)
    }
}

/// The reduced model in single precision. Its derivative has double precision, because only Newton's
/// method uses it.
pub(super) struct SinglePrecisionModel<M> {
    exact: ExactModel<M>,
    /// The model without the groups that the inertia does not need.
    inertia_model: M,
}

impl<M: ReducibleModel + Clone> SinglePrecisionModel<M> {
    pub(super) fn new(exact: &ExactModel<M>) -> Self {
        Self {
            inertia_model: exact.model().for_inertia(),
            exact: exact.clone(),
        }
    }
}

impl<M: ReducibleModel> ReducedModel for SinglePrecisionModel<M> {
    /// Workspaces of the inertia and of the coefficients in single precision, then in double precision.
    type Workspace = (
        [M::Workspace<f32>; 2],
        <ExactModel<M> as ReducedModel>::Workspace,
    );

    fn workspace(&self) -> Self::Workspace {
        let models = [&self.inertia_model, self.exact.model()];
        (
            models.map(ReducibleModel::pass_workspace),
            self.exact.workspace(),
        )
    }

    fn reactions(&self) -> usize {
        self.exact.reactions()
    }

    fn range(&self) -> Range {
        self.exact.range()
    }

    fn inertia(
        &self,
        q: f64,
        ([at, _], _): &mut Self::Workspace,
    ) -> Result<(f64, f64), PositionError> {
        let mut out = Coefficients::default();
        self.inertia_model.reduce_at(q as f32, at, &mut out)?;
        Ok((f64::from(out.m), f64::from(out.half_dm)))
    }

    fn inertia_derivatives(
        &self,
        q: f64,
        (_, workspace): &mut Self::Workspace,
    ) -> Result<Inertia, PositionError> {
        self.exact.inertia_derivatives(q, workspace)
    }

    fn coefficients(
        &self,
        q: f64,
        ([_, workspace], _): &mut Self::Workspace,
        out: &mut Coefficients,
    ) -> Result<(), PositionError> {
        let model = self.exact.model();
        let zeros = vec![0.0_f32; model.reaction_count()];
        let mut single = Coefficients {
            a: zeros.clone(),
            b: zeros,
            ..Coefficients::default()
        };
        model.reduce_at(q as f32, workspace, &mut single)?;
        (out.m, out.half_dm) = (f64::from(single.m), f64::from(single.half_dm));
        let doubled = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect();
        (out.a, out.b) = (doubled(&single.a), doubled(&single.b));
        Ok(())
    }
}

/// A machine with any number of degrees of freedom, loads and drives: evaluated exactly, in single precision or on a table.
pub(super) struct MachineEvaluator<'s, S: StudiedScene> {
    pub(super) subject: &'s Subject<S>,
    pub(super) evaluation: Evaluation,
    /// Its table. It contains no reactions; those of the machine at the table's states are used.
    pub(super) table: Option<TabulatedMachine>,
    /// The time of building it, s.
    pub(super) build_time: f64,
}

impl<S: StudiedScene> Evaluator for MachineEvaluator<'_, S> {
    fn evaluation(&self) -> Evaluation {
        self.evaluation
    }

    fn system(&self) -> Result<Box<dyn OdeSystem + '_>, DynamicsError> {
        let machine = &self.subject.machine;
        let OdeState { t, y } = &self.subject.initial_state;
        if let Some(table) = &self.table {
            return Ok(Box::new(table.ode(*t, y, 0.0)?));
        }
        let exact = MachineOde::new(machine, *t, y)?;
        if self.evaluation != Evaluation::SinglePrecision {
            return Ok(Box::new(exact));
        }
        Ok(Box::new(SinglePrecisionOde {
            machine,
            workspace: machine.workspace(),
            y: vec![0.0; machine.state_count()],
            out: vec![0.0; machine.state_count()],
            exact,
        }))
    }

    fn reactions(&self) -> ReactionFn<'_> {
        let machine = &self.subject.output_machine;
        match self.evaluation {
            Evaluation::SinglePrecision => reactions_in::<f32, S::Model>(machine),
            _ => reactions_in::<f64, S::Model>(machine),
        }
    }

    fn jacobian_weight(&self) -> usize {
        2 * self.subject.machine.work_offset()
    }

    fn build_time(&self) -> f64 {
        self.build_time
    }

    fn orbit(&self, start: ReducedState) -> Option<(Orbit, usize)> {
        if self.evaluation != Evaluation::Exact {
            return None;
        }
        let orbit = Orbit::loaded(&self.subject.machine, start).ok()?;
        let points = orbit.points;
        Some((orbit, points))
    }
}

/// The reactions of a machine, evaluated in a precision.
fn reactions_in<T: Scalar, M: MovingModel + EvaluatedIn<T>>(
    machine: &Machine<M>,
) -> ReactionFn<'_> {
    let mut workspace = machine.workspace::<T>();
    Box::new(move |point, out| {
        let y: Vec<T> = point.y.iter().map(|&v| T::from_f64(v)).collect();
        let state = machine.evaluate(point.t, &y, &mut workspace)?;
        for (out, value) in out.iter_mut().zip(&state.inverse_dynamics().reactions) {
            *out = value.value();
        }
        Ok(())
    })
}

/// A machine from an initial state, evaluated in single precision; its Jacobian has double precision.
struct SinglePrecisionOde<'m, M: MovingModel> {
    machine: &'m Machine<M>,
    workspace: MachineWorkspace<f32, M>,
    y: Vec<f32>,
    out: Vec<f32>,
    exact: MachineOde<'m, M>,
}

impl<M: MovingModel> OdeSystem for SinglePrecisionOde<'_, M> {
    fn size(&self) -> usize {
        self.machine.state_count()
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        for (single, &value) in self.y.iter_mut().zip(y) {
            *single = value as f32;
        }
        let state = self.machine.evaluate(t, &self.y, &mut self.workspace)?;
        state.derivative(&mut self.out);
        for (out, &value) in out.iter_mut().zip(&self.out) {
            *out = f64::from(value);
        }
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.exact.jacobian(t, y, out)
    }

    fn error_weight(&self, state: usize) -> f64 {
        self.exact.error_weight(state)
    }
}
