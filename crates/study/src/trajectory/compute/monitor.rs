//! A fault that ends a trajectory although the mechanism can be assembled: a coupling function is discontinuous between two positions.

use crate::explain::couplings;
use crate::trajectory::compute::StopCause;
use dwell_geometry::JointId;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_laws::Law;
use dwell_scene::PlaneScene;

/// A coupling function, with its variable at the position before.
#[derive(Clone)]
struct MonitoredCoupling<'a> {
    joint: JointId,
    law: &'a Law,
    variable: CoordinateFunction,
    previous: Option<f64>,
}

/// Checks one position after another.
#[derive(Clone)]
pub(crate) struct CouplingMonitor<'a>(Vec<MonitoredCoupling<'a>>);

impl<'a> CouplingMonitor<'a> {
    pub(crate) fn new(scene: &'a PlaneScene) -> Self {
        let mechanism = &scene.mechanism;
        let coupling = |(joint, law, variable)| {
            Some(MonitoredCoupling {
                joint,
                law,
                variable: CoordinateFunction::find(mechanism, variable)?,
                previous: None,
            })
        };
        Self(couplings(mechanism).filter_map(coupling).collect())
    }

    /// Fails at the first coupling whose function is discontinuous since the position before.
    pub(crate) fn check(&mut self, states: &BodyStates) -> Result<(), StopCause> {
        for coupling in &mut self.0 {
            let now = states.coordinate(coupling.variable)[0];
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
