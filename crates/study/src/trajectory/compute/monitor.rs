//! A fault that ends a trajectory although the mechanism can be assembled: a coupling function is discontinuous between two positions.

use crate::explain::{CoupledMechanism, CouplingLaw};
use crate::trajectory::compute::StopCause;
use dwell_geometry::JointId;
use dwell_laws::Law;

/// A coupling function, with its variable at the position before.
#[derive(Clone)]
struct MonitoredCoupling<'a, F> {
    joint: JointId,
    law: &'a Law,
    variable: F,
    previous: Option<f64>,
}

/// Checks one position after another; `F` is a coordinate of a compiled mechanism.
#[derive(Clone)]
pub(crate) struct CouplingMonitor<'a, F>(Vec<MonitoredCoupling<'a, F>>);

impl<'a, F: Copy> CouplingMonitor<'a, F> {
    /// Of a mechanism whose coordinates a function compiles.
    pub(crate) fn new<M: CoupledMechanism>(
        mechanism: &'a M,
        compile: impl Fn(M::Coordinate) -> Option<F>,
    ) -> Self {
        let coupling = |of: CouplingLaw<'a, M::Coordinate>| {
            Some(MonitoredCoupling {
                joint: of.joint,
                law: of.law,
                variable: compile(of.variable)?,
                previous: None,
            })
        };
        let laws = mechanism.coupling_laws().into_iter();
        Self(laws.filter_map(coupling).collect())
    }

    /// Fails at the first coupling whose function is discontinuous since the position before; `value` is that of a coordinate now.
    pub(crate) fn check(&mut self, value: impl Fn(F) -> f64) -> Result<(), StopCause> {
        for coupling in &mut self.0 {
            let now = value(coupling.variable);
            let previous = coupling.previous.replace(now);
            let jump = previous.and_then(|previous| coupling.law.discontinuity(previous, now));
            if let Some(between) = jump {
                let joint = coupling.joint;
                return Err(StopCause::Discontinuity { joint, between });
            }
        }
        Ok(())
    }
}
