//! The loads of a model in space, checked and compiled.

use super::action::CompiledKind;
use super::load::Load;
use crate::error::LoadError;
use crate::load::{Magnitude, Signal, compile_signals_by};
use dwell_geometry::space::{CoordinateFunction, Mechanism, Plan};

/// The loads of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct CompiledLoads {
    pub(super) loads: Vec<Load>,
    pub(super) kinds: Vec<CompiledKind>,
    /// By load: the signals of its magnitude.
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
