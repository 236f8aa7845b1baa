//! The loads of a model in space, checked and compiled.

use super::action::CompiledKind;
use super::load::{Load, LoadKind};
use super::model::{Model, Workspace};
use crate::error::{LoadError, PositionResult};
use crate::load::{Magnitude, Signal, compile_signals_by};
use crate::pass::InverseDynamics;
use dwell_geometry::space::{CoordinateFunction, Mechanism, Plan};
use dwell_numerics::Scalar;

/// The loads of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct CompiledLoads {
    pub(super) loads: Vec<Load>,
    pub(super) kinds: Vec<CompiledKind>,
    /// By load: what its magnitude depends on.
    pub(super) signals: Vec<Vec<Signal<CoordinateFunction>>>,
}

impl CompiledLoads {
    pub(super) fn compile(
        mechanism: &Mechanism,
        plan: &Plan,
        loads: Vec<Load>,
    ) -> Result<Self, LoadError> {
        let (mut kinds, mut signals) = (Vec::new(), Vec::new());
        for (load, one) in loads.iter().enumerate() {
            let wrong = |what| LoadError { load, what };
            match &one.magnitude {
                Magnitude::Constant(value) if !value.is_finite() => {
                    return Err(wrong("its magnitude is not a finite number"));
                }
                Magnitude::Separating(_) => {
                    return Err(wrong(
                        "separating forces of teeth are not computed in space",
                    ));
                }
                // They are compiled with the reactions that they depend on.
                Magnitude::Friction(_)
                | Magnitude::Constant(_)
                | Magnitude::Law(..)
                | Magnitude::Expression(..)
                | Magnitude::Function(..)
                | Magnitude::External(_) => {}
            }
            kinds.push(CompiledKind::new(&one.kind, mechanism, plan).map_err(wrong)?);
            let find = |coordinate| plan.coordinate_function(mechanism, coordinate);
            signals.push(compile_signals_by(&one.magnitude, find).map_err(wrong)?);
        }
        Ok(Self {
            loads,
            kinds,
            signals,
        })
    }

    /// The largest number of signals of one load.
    pub(super) fn max_signals(&self) -> usize {
        self.signals.iter().map(Vec::len).max().unwrap_or(0)
    }
}

impl Model {
    /// The potential energy of a unit of a load at the last pose, J; none of one that has no potential.
    pub fn potential_energy(&self, load: &LoadKind, workspace: &Workspace) -> Option<f64> {
        let kind = CompiledKind::new(load, self.mechanism(), self.plan()).ok()?;
        kind.potential(self.plan(), &workspace.pose, self.inner_masses())
    }

    /// The response to a load of magnitude 1 at `q` (rad or m), at rest: τ = −w and the reactions c; of a damper, to a unit of its
    /// resistance. No numbers where the load has no direction or does not fit the mechanism.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    pub fn unit_load_response<T: Scalar>(
        &self,
        q: &[T],
        load: &LoadKind,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> PositionResult {
        self.plan().positions(q, &mut workspace.pose)?;
        let kind = CompiledKind::new(load, self.mechanism(), self.plan()).ok();
        let responded = kind.and_then(|kind| self.respond(&kind, workspace, result));
        if responded.is_none() {
            result.tau.fill(T::from_f64(f64::NAN));
            result.reactions.fill(T::from_f64(f64::NAN));
        }
        Ok(())
    }
}
