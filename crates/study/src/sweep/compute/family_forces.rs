//! The largest actuator force and reactions of the variants of a family, along the scene's trajectory.

use crate::explain::table_of;
use crate::sweep::compute::point::{RequestedQuantities, ResultKind, SweepQuantity};
use crate::trajectory::compute::{
    Analysis, Quantity, Signal, Statistic, analysis_along, statistics_along,
};
use dwell_geometry::{Coordinate, Reaction};
use dwell_kinetostatics::variants::{Turn, TurningVariant, VariantModel};
use dwell_kinetostatics::{Load, Signal as LoadSignal};
use dwell_laws::Law;
use dwell_scene::PlaneScene;
use std::collections::BTreeSet;
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
    /// The wanted statistics of actuator forces and of these reactions, in the order of the quantities.
    wanted: Vec<(Signal, Statistic)>,
    revolution: Option<Revolution>,
    /// Whether they are those of the inertia alone: ½m′ω², without loads.
    are_inertial: bool,
}

/// A trajectory that covers a revolution at constant velocity.
#[derive(Debug, Clone, Copy)]
struct Revolution {
    /// rad/s; zero for statics.
    velocity: f64,
    /// From its first to its last position, rad.
    angle: f64,
}

impl Revolution {
    /// Whether means over the trajectory are those over a revolution.
    fn is_whole(self) -> bool {
        let revolutions = self.angle.abs() / TAU;
        (revolutions - revolutions.round()).abs() <= WHOLE_REVOLUTION * revolutions
    }
}

impl FamilyForces {
    /// The forces among the requested quantities, of variants of which `typical` is one; `None` if a table depends on
    /// points.
    pub(crate) fn new(typical: &PlaneScene, requested: &RequestedQuantities) -> Option<Self> {
        if typical.loads.iter().any(has_table_of_points) {
            return None;
        }
        let analysis = analysis_along(typical)?;
        let of_reaction = |q: &SweepQuantity| matches!(q.kind, ResultKind::Reaction(_));
        let reactions = requested.along().filter(|(q, _)| of_reaction(q));
        let reactions: BTreeSet<usize> = reactions.map(|(q, _)| q.index).collect();
        let reactions: Vec<usize> = reactions.into_iter().collect();
        let wanted = requested.along().map(|(quantity, statistic)| {
            let of = match reactions.binary_search(&quantity.index) {
                Ok(k) if of_reaction(quantity) => Quantity::Reaction(k),
                _ => Quantity::ActuatorForce(quantity.index),
            };
            (Signal::of(of), statistic)
        });
        let wanted: Vec<(Signal, Statistic)> = wanted.collect();
        let revolution = revolution(typical, analysis);
        let revolution = revolution.filter(|of| of.is_whole() || !wanted.iter().any(is_mean));
        let are_all = typical.loads.is_empty() && reactions.is_empty() && revolution.is_some();
        Some(Self {
            scene: typical.clone(),
            analysis,
            revolution,
            are_inertial: are_all && !wanted.iter().all(is_peak),
            wanted,
            reactions,
        })
    }

    /// The variants with the forces of these reactions.
    pub(crate) fn add_to(
        &self,
        model: &VariantModel,
        reactions: &[Reaction],
    ) -> Option<VariantModel> {
        if self.are_inertial {
            return Some(model.clone().with_means());
        }
        let add = |velocity: Option<f64>| {
            let model = model.clone();
            model.with_loads(self.scene.loads.clone(), reactions, velocity)
        };
        // Forces by laws may jump: they need the trajectory's own positions.
        let model = add(self.revolution.map(|of| of.velocity)).or_else(|| add(None))?;
        let has_means = !self.wanted.iter().all(is_peak);
        Some(if has_means { model.with_means() } else { model })
    }

    /// The wanted statistics of a variant, in their order; `None` if it must be compiled, so that errors are explained.
    pub(crate) fn values(&self, variant: TurningVariant<'_>) -> Option<Vec<f64>> {
        let turn = variant.turn;
        let is_over_turn = self.are_inertial || !turn.loaded_forces.is_empty();
        let Some(revolution) = self.revolution.filter(|_| is_over_turn) else {
            let loaded = variant.loaded?;
            return statistics_along(&self.scene, loaded, self.analysis, &self.wanted).ok();
        };
        let value = |(signal, statistic): &(Signal, Statistic)| {
            let force = match signal.quantity()? {
                _ if self.are_inertial => inertial_force(turn, revolution.velocity),
                Quantity::Reaction(k) => force_under_loads(turn, 1 + k)?,
                _ => force_under_loads(turn, 0)?,
            };
            Some(force.statistic(*statistic, revolution))
        };
        self.wanted.iter().map(value).collect()
    }
}

/// Whether it is a mean over the trajectory.
fn is_mean((_, statistic): &(Signal, Statistic)) -> bool {
    matches!(
        statistic,
        Statistic::Mean | Statistic::Rms | Statistic::Work
    )
}

/// Whether it is the largest magnitude, for which means are not needed.
fn is_peak((_, statistic): &(Signal, Statistic)) -> bool {
    matches!(statistic, Statistic::MaxAbs | Statistic::PeakPower)
}

/// A force over a turn.
struct TurnForce {
    max_abs: f64,
    /// The smallest and the largest value, if they are known.
    ends: [f64; 2],
    mean: f64,
    mean_square: f64,
}

/// The actuator force of the inertia alone at constant velocity, ½m′ω².
fn inertial_force(turn: &Turn, velocity: f64) -> TurnForce {
    let square = velocity * velocity;
    let ends = turn.half_dm.map(|end| end.value * square);
    let [mean, mean_square] = turn.half_dm_means;
    TurnForce {
        max_abs: ends[0].abs().max(ends[1].abs()),
        ends,
        mean: mean * square,
        mean_square: mean_square * square * square,
    }
}

/// A force of the model under loads.
fn force_under_loads(turn: &Turn, k: usize) -> Option<TurnForce> {
    let ends = turn.force_ends.get(k).map(|ends| ends.map(|end| end.value));
    let means = turn.force_means.get(k).copied();
    let [mean, mean_square] = means.unwrap_or([f64::NAN; 2]);
    Some(TurnForce {
        max_abs: turn.loaded_forces.get(k)?.value.abs(),
        ends: ends.unwrap_or([f64::NAN; 2]),
        mean,
        mean_square,
    })
}

impl TurnForce {
    fn statistic(&self, statistic: Statistic, along: Revolution) -> f64 {
        let [low, high] = self.ends;
        match statistic {
            Statistic::MaxAbs => self.max_abs,
            Statistic::PeakPower => self.max_abs * along.velocity.abs(),
            Statistic::Min => low,
            Statistic::Max => high,
            Statistic::Stroke => high - low,
            Statistic::Mean => self.mean,
            Statistic::Rms => self.mean_square.sqrt(),
            Statistic::Work => self.mean * along.angle,
        }
    }
}

/// Whether the magnitude is a table of a coordinate that depends on points: its limits are checked by the scene's own.
fn has_table_of_points(load: &Load) -> bool {
    let signal = table_of(&load.magnitude).map(|(signal, _)| signal);
    signal.is_some_and(|signal| match signal {
        LoadSignal::Time => false,
        LoadSignal::Value(coordinate) | LoadSignal::Velocity(coordinate) => {
            !matches!(coordinate, Coordinate::Angle(_))
        }
    })
}

/// The scene's trajectory if it covers a revolution of an actuator that turns fully, at constant velocity.
fn revolution(scene: &PlaneScene, analysis: Analysis) -> Option<Revolution> {
    let covers_all = |of: &Revolution| of.angle.abs() / TAU > 1.0 - WHOLE_REVOLUTION;
    if let Some(prescribed) = &scene.prescribed {
        let [Law::Polynomial(law)] = &prescribed.laws[..] else {
            return None;
        };
        let [_, velocity, acceleration, jerk] = law.eval(0.0);
        let is_uniform = acceleration == 0.0 && jerk == 0.0;
        let angle = velocity * prescribed.duration;
        let found = is_uniform.then_some(Revolution { velocity, angle });
        return found.filter(covers_all);
    }
    let [from, to] = match &scene.sweep {
        None if analysis != Analysis::Statics => return None,
        sweep => sweep.as_ref().and_then(|s| s.range).unwrap_or([0.0, TAU]),
    };
    let angle = to - from;
    let velocity = match (&scene.sweep, analysis) {
        (None, _) | (_, Analysis::Statics) => 0.0,
        (Some(sweep), _) => sweep.speed.copysign(angle),
    };
    Some(Revolution { velocity, angle }).filter(covers_all)
}
