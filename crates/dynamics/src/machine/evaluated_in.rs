//! Machines are evaluated in four kinds of number: in `f64` as they move, in [`Dual`] for Jacobians, in [`DoubleDouble`] where
//! rounding decides, in `f32` to measure its cost. Each of the two models has a function of its own for each kind, compiled
//! here. A generic function would be compiled again, with all that it calls down to Newton's method, in every crate that
//! evaluates a machine.

use super::{Machine, MachineState, MachineWorkspace, MovingModel};
use crate::error::Result;
use dwell_kinetostatics::{Model, space};
use dwell_numerics::{DoubleDouble, Dual, Scalar};

/// A model whose machines are evaluated in a kind of number; [`MovingModel`] names them.
pub trait EvaluatedIn<T: Scalar>: Sized {
    /// As [`Machine::evaluate`].
    ///
    /// # Errors
    /// As of [`Machine::evaluate`].
    #[doc(hidden)]
    fn evaluate_machine<'a>(
        machine: &'a Machine<Self>,
        t: f64,
        y: &[T],
        workspace: &'a mut MachineWorkspace<T, Self>,
    ) -> Result<MachineState<'a, T, Self>>
    where
        Self: MovingModel;

    /// As [`Machine::unloaded_derivative`].
    ///
    /// # Errors
    /// As of [`Machine::unloaded_derivative`].
    #[doc(hidden)]
    fn unloaded_derivative(
        machine: &Machine<Self>,
        y: &[T],
        workspace: &mut MachineWorkspace<T, Self>,
        out: &mut [T],
    ) -> Result<bool>
    where
        Self: MovingModel;

    /// As [`Machine::workspace`].
    #[doc(hidden)]
    fn machine_workspace(machine: &Machine<Self>) -> MachineWorkspace<T, Self>
    where
        Self: MovingModel;
}

/// The functions of each model for each kind of number.
macro_rules! evaluated_in {
    ($($model:ty: $number:ty;)*) => {$(
        impl EvaluatedIn<$number> for $model {
            fn evaluate_machine<'a>(
                machine: &'a Machine<Self>,
                t: f64,
                y: &[$number],
                workspace: &'a mut MachineWorkspace<$number, Self>,
            ) -> Result<MachineState<'a, $number, Self>> {
                machine.evaluate_in(t, y, workspace)
            }

            fn unloaded_derivative(
                machine: &Machine<Self>,
                y: &[$number],
                workspace: &mut MachineWorkspace<$number, Self>,
                out: &mut [$number],
            ) -> Result<bool> {
                machine.unloaded_derivative_in(y, workspace, out)
            }

            fn machine_workspace(machine: &Machine<Self>) -> MachineWorkspace<$number, Self> {
                machine.workspace_in()
            }
        }
    )*};
}

evaluated_in! {
    Model: f64;
    Model: Dual;
    Model: DoubleDouble;
    Model: f32;
    space::Model: f64;
    space::Model: Dual;
    space::Model: DoubleDouble;
    space::Model: f32;
}
