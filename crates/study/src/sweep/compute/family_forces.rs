//! The largest actuator force and reactions of the variants of a family, along the scene's trajectory.

use crate::explain::table_of;
use crate::sweep::compute::point::{RequestedQuantities, ResultKind};
use crate::trajectory::compute::{Analysis, WantedForces, peak_analysis, peak_forces};
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::variants::{TurningVariant, VariantModel};
use dwell_kinetostatics::{InverseDynamics, Load, Signal};
use dwell_laws::Law;
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// A trajectory that misses a revolution by less than this part of it covers it.
const WHOLE_REVOLUTION: f64 = 1e-12;

/// Which forces are wanted of every variant.
#[derive(Debug)]
pub(crate) struct FamilyForces {
    /// A variant, for the data that all share.
    scene: PlaneScene,
    analysis: Analysis,
    /// By index among the reactions of the mechanism, in ascending order.
    pub(crate) reactions: Vec<usize>,
    /// By index.
    actuators: Vec<usize>,
    /// If the trajectory covers a revolution at constant velocity: this velocity, rad/s; zero for statics.
    revolution: Option<f64>,
}

impl FamilyForces {
    /// The forces among the requested quantities, of variants of which `typical` is one; `None` if a table depends on
    /// points.
    pub(crate) fn new(typical: &PlaneScene, requested: &RequestedQuantities) -> Option<Self> {
        if typical.loads.iter().any(has_table_of_points) {
            return None;
        }
        let analysis = peak_analysis(typical)?;
        Some(Self {
            scene: typical.clone(),
            analysis,
            reactions: requested.indices(&[ResultKind::Reaction]),
            actuators: requested.indices(&[ResultKind::ActuatorForce]),
            revolution: revolution_velocity(typical, analysis),
        })
    }

    /// The variants with the forces of these reactions.
    pub(crate) fn add_to(
        &self,
        model: &VariantModel,
        reactions: &[Reaction],
    ) -> Option<VariantModel> {
        let add = |velocity: Option<f64>| {
            let model = model.clone();
            model.with_loads(self.scene.loads.clone(), reactions, velocity)
        };
        // Forces by laws may jump: they need the trajectory's own positions.
        add(self.revolution).or_else(|| add(None))
    }

    /// The largest magnitudes of a variant; `None` if it must be compiled, so that errors are explained.
    pub(crate) fn peaks(&self, variant: TurningVariant<'_>) -> Option<InverseDynamics<f64>> {
        let loaded = variant.loaded?;
        if let [tau, reactions @ ..] = &variant.turn.loaded_forces[..] {
            return Some(InverseDynamics {
                tau: vec![tau.value.abs()],
                reactions: reactions.iter().map(|r| r.value.abs()).collect(),
            });
        }
        let wanted = WantedForces {
            reactions: (0..self.reactions.len()).collect(),
            actuators: self.actuators.clone(),
        };
        peak_forces(&self.scene, loaded, self.analysis, &wanted).ok()
    }
}

/// Whether the magnitude is a table of a coordinate that depends on points: its limits are checked by the scene's own.
fn has_table_of_points(load: &Load) -> bool {
    let signal = table_of(&load.magnitude).map(|(signal, _)| signal);
    signal.is_some_and(|signal| match signal {
        Signal::Time => false,
        Signal::Value(coordinate) | Signal::Velocity(coordinate) => {
            !matches!(coordinate, Coordinate::Angle(_))
        }
    })
}

/// The constant velocity of the scene's trajectory, rad/s, if it covers a revolution of an actuator that turns fully.
fn revolution_velocity(scene: &PlaneScene, analysis: Analysis) -> Option<f64> {
    if let Some(prescribed) = &scene.prescribed {
        let [Law::Polynomial(law)] = &prescribed.laws[..] else {
            return None;
        };
        let [_, velocity, acceleration, jerk] = law.eval(0.0);
        let revolutions = velocity.abs() * prescribed.duration / TAU;
        let is_uniform = acceleration == 0.0 && jerk == 0.0;
        let covers_all = is_uniform && revolutions > 1.0 - WHOLE_REVOLUTION;
        return covers_all.then_some(velocity);
    }
    let Some(sweep) = &scene.sweep else {
        return (analysis == Analysis::Statics).then_some(0.0);
    };
    let [from, to] = sweep.range.unwrap_or([0.0, TAU]);
    let covers_all = (to - from).abs() / TAU > 1.0 - WHOLE_REVOLUTION;
    let velocity = match analysis {
        Analysis::Statics => 0.0,
        _ => sweep.speed.copysign(to - from),
    };
    covers_all.then_some(velocity)
}
