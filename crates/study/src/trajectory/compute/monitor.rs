//! Faults that end a trajectory although the mechanism can be assembled: a load's table is exceeded, or a
//! coupling function is discontinuous between two positions.

use crate::explain::{couplings, covers, table_of};
use crate::trajectory::compute::StopCause;
use dwell_geometry::JointId;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Law, Spline};
use dwell_scene::Scene;

/// The table of a load and its argument.
#[derive(Clone)]
struct MonitoredTable<'a> {
    load: usize,
    spline: &'a Spline,
    /// `None`: time. Otherwise the coordinate, and 0 for its value or 1 for its speed.
    argument: Option<(CoordinateFunction, usize)>,
}

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
pub(crate) struct TrajectoryMonitor<'a> {
    tables: Vec<MonitoredTable<'a>>,
    couplings: Vec<MonitoredCoupling<'a>>,
}

impl<'a> TrajectoryMonitor<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let mechanism = &scene.mechanism;
        let table = |(load, magnitude): (usize, &'a Magnitude)| {
            let (signal, spline) = table_of(magnitude)?;
            let argument = match signal {
                Signal::Time => None,
                Signal::Value(c) => Some((CoordinateFunction::find(mechanism, c)?, 0)),
                Signal::Velocity(c) => Some((CoordinateFunction::find(mechanism, c)?, 1)),
            };
            Some(MonitoredTable {
                load,
                spline,
                argument,
            })
        };
        let magnitudes = scene.loads.iter().map(|l| &l.magnitude).enumerate();
        let coupling = |(joint, law, variable)| {
            Some(MonitoredCoupling {
                joint,
                law,
                variable: CoordinateFunction::find(mechanism, variable)?,
                previous: None,
            })
        };
        Self {
            tables: magnitudes.filter_map(table).collect(),
            couplings: couplings(mechanism).filter_map(coupling).collect(),
        }
    }

    /// Fails at the first load whose table does not cover the state of the bodies at time `t` (s).
    pub(crate) fn check_tables(&self, t: f64, states: &BodyStates) -> Result<(), StopCause> {
        for table in &self.tables {
            let load = table.load;
            let value = match table.argument {
                None => t,
                Some((measured, order)) => states.coordinate(measured)[order],
            };
            if !covers(table.spline, value) {
                return Err(StopCause::OffTable { load, value });
            }
        }
        Ok(())
    }

    /// Fails at the first coupling whose function is discontinuous since the position before.
    pub(crate) fn check_couplings(&mut self, states: &BodyStates) -> Result<(), StopCause> {
        for coupling in &mut self.couplings {
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
