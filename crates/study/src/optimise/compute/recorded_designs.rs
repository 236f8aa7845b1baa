//! Designs of one structure, by a recorded state: the numbers of each are filled in, and all results have exact derivatives.
//!
//! It serves mechanisms whose positions have a closed form, under constant loads, along a trajectory that no number changes. The branch of a
//! recording is that of the design at which it was made. A design that has no position somewhere has no results.

use super::curves::alternating;
use crate::gradient::{
    GradientScene, RecordedMachine, RecordedOutputs, StateOfMotion, recorded_signal,
};
use crate::sweep::compute::{AffineNumbers, Design, RequestedQuantities, ResultKind, signal_along};
use crate::trajectory::compute::{
    Analysis, Distance, Quantity, Signal, Statistic, Trajectory, TrajectorySample, analysis_along,
};
use dwell_kinetostatics::{Magnitude, RecordedState};
use dwell_numerics::root;
use std::f64::consts::TAU;

/// Positions of a turn, doubled until the curves are resolved.
const FIRST_POSITIONS: usize = 32;
const LEVELS: usize = 6;
const NEAREST_LEVEL: usize = 2;
/// Velocities and whole revolutions that differ by this part are equal.
const SAME: f64 = 1e-12;
/// Displacements of the numbers, in parts of their ranges, by which it is found what they change.
const DISPLACED: [f64; 2] = [0.13, -0.11];
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A curve along the trajectory.
pub(super) struct Channel {
    pub(super) signal: Signal,
    /// The recording of this curve alone.
    pub(super) code: RecordedState,
    pub(super) unwraps: bool,
}

/// What is wanted of the curves.
pub(super) enum Wanted {
    /// A statistic of a curve.
    Statistic(usize, Statistic),
    /// Distances of curves from the rows of a table.
    Distance {
        channels: Vec<usize>,
        /// The recording of these curves alone.
        code: Box<RecordedState>,
        /// By row: the wanted values.
        rows: Vec<Vec<f64>>,
        /// By row: the place at which it counts; otherwise the nearest.
        places: Option<Vec<f64>>,
        are_angles: bool,
        statistic: Statistic,
    },
}

/// The positions at which curves are sampled.
pub(super) struct Level {
    pub(super) samples: Vec<TrajectorySample>,
    pub(super) alternating: Vec<[f64; 3]>,
}

/// Designs of one structure.
pub(super) struct RecordedDesigns<'a> {
    pub(super) outputs: RecordedOutputs,
    /// The recording of all curves.
    pub(super) code: RecordedState,
    pub(super) channels: Vec<Channel>,
    pub(super) wanted: Vec<Wanted>,
    pub(super) numbers: AffineNumbers,
    pub(super) number_count: usize,
    /// The inputs of a recording, without the numbers of a design.
    pub(super) inputs: Vec<f64>,
    pub(super) design: &'a Design,
    trajectory: Trajectory<'a>,
    analysis: Analysis,
    pub(super) is_turn: bool,
    pub(super) levels: Vec<Level>,
    /// The level with which designs begin: nearest positions need more, lest another branch of a curve is taken for the nearest.
    pub(super) least_level: usize,
    pub(super) duration: f64,
}

impl<'a> RecordedDesigns<'a> {
    /// The designs of a scene about a `reference`, a variant of it that moves along the whole trajectory, whose numbers are these. `None`
    /// if a result has no exact derivative, or a number changes more than dimensions, masses and loads.
    // Long because what is recorded and what is wanted are found together.
    pub(super) fn new<S: GradientScene>(
        scene: &S,
        reference: (&'a S, &S::Rows, &[f64]),
        design: &'a Design,
        requested: &RequestedQuantities,
    ) -> Option<Self> {
        let (at, rows, values) = reference;
        let is_constant = |load: &dwell_kinetostatics::ModelLoad<S::Model>| {
            matches!(load.magnitude, Magnitude::Constant(_))
        };
        let model = S::model_of(rows);
        let moves = at.prescribed() == (None, None) && model_has_ends::<S>(model);
        if moves || !at.loads().iter().all(is_constant) {
            return None;
        }
        let analysis = analysis_along(at)?;
        let mut curves = Curves::default();
        let parts = requested.quantities.iter().map(|quantity| {
            let statistic = quantity.kind.statistic()?;
            let signal = signal_along(at, rows, analysis, &quantity.name, requested)?;
            Some((signal, statistic, quantity.kind))
        });
        let parts: Vec<(Signal, Statistic, ResultKind)> = parts.collect::<Option<_>>()?;
        let trajectory = Trajectory::new(&at.followed(model), analysis, None).ok()?;
        let wanted: Option<Vec<Wanted>> = (parts.iter())
            .map(|(signal, statistic, _)| {
                curves.wanted::<S>(model, &trajectory, signal, *statistic)
            })
            .collect();
        let wanted = wanted?;
        let mut machine = RecordedMachine::new(at, model, &curves.signals)?;
        let first = trajectory.sample_at(0.25 * GOLDEN);
        let rest = vec![0.0; first.q.len()];
        let [q, q_dot, q_ddot] = first.state(analysis, &rest);
        let state = StateOfMotion {
            load_time: Some(trajectory.load_time(&first)),
            q,
            q_dot,
            q_ddot,
        };
        let (code, inputs) = machine.recorded(state)?;
        let outputs = machine.outputs().clone();
        let limited = |signals: &[Signal]| {
            let places: Vec<usize> = signals.iter().flat_map(|s| outputs.places(s)).collect();
            code.limited_to(|k| places.contains(&k))
        };
        let channels = curves.signals.iter().map(|signal| Channel {
            signal: signal.clone(),
            code: limited(std::slice::from_ref(signal)),
            unwraps: matches!(signal, Signal::Column(column) if column.unwraps),
        });
        let channels: Vec<Channel> = channels.collect();
        let numbers_at = |numbers: &[f64]| {
            let variant = scene.varied(&design.assigned(numbers)).ok()?;
            let fits = at.differs_in_numbers_only(&variant, machine.structure());
            fits.then(|| machine.numbers_of(&variant)).flatten()
        };
        let elsewhere = |displaced: f64| -> Vec<f64> {
            let each = design.axes.iter().zip(values).enumerate();
            let displaced = each.map(|(k, (axis, value))| {
                let [from, to] = axis.span();
                let part = displaced * (0.7 + 0.6 * ((k + 1) as f64 * GOLDEN).fract());
                let away = value + part * (to - from);
                if away > to || away < from {
                    value - part * (to - from)
                } else {
                    away
                }
            });
            design.numbers(&displaced.collect::<Vec<_>>())
        };
        let [displaced, other] = DISPLACED.map(elsewhere);
        let numbers = AffineNumbers::find(design.numbers(values), &displaced, &other, &numbers_at)?;
        let mut wanted = wanted;
        for of in &mut wanted {
            if let Wanted::Distance { channels, code, .. } = of {
                let signals = channels.iter().map(|k| curves.signals[*k].clone());
                **code = limited(&signals.collect::<Vec<_>>());
            }
        }
        let code = limited(&curves.signals);
        let mut found = Self {
            number_count: machine.numbers().len(),
            outputs,
            code,
            channels,
            wanted,
            numbers,
            inputs,
            design,
            analysis,
            is_turn: false,
            levels: Vec::new(),
            least_level: 0,
            duration: trajectory.sample_at(1.0).t - trajectory.sample_at(0.0).t,
            trajectory,
        };
        found.is_turn = found.covers_revolutions();
        found.levels = found.levels();
        let is_nearest = |of: &Wanted| matches!(of, Wanted::Distance { places: None, .. });
        if found.is_turn && found.wanted.iter().any(is_nearest) {
            found.least_level = NEAREST_LEVEL;
        }
        Some(found)
    }

    /// The coordinates at a place of the trajectory, as the analysis evaluates them.
    pub(super) fn sample(&self, u: f64) -> TrajectorySample {
        let mut sample = self.trajectory.sample_at(u);
        if self.analysis == Analysis::Statics {
            sample.q_dot.fill(0.0);
            sample.q_ddot.fill(0.0);
        }
        sample
    }

    /// Whether the trajectory covers whole revolutions of a mechanism that turns, at constant velocity.
    fn covers_revolutions(&self) -> bool {
        let Some(period) = self.trajectory.period else {
            return false;
        };
        let [first, middle, last] = [0.0, 0.5 * GOLDEN, 1.0].map(|u| self.sample(u));
        let revolutions = (last.q[0] - first.q[0]) / period;
        let is_steady = |sample: &TrajectorySample| {
            let off = (sample.q_dot[0] - first.q_dot[0]).abs();
            off <= SAME * first.q_dot[0].abs() && sample.q_ddot[0] == 0.0
        };
        let is_uniform = (middle.q[0] - first.q[0] - 0.5 * GOLDEN * (last.q[0] - first.q[0])).abs();
        first.q.len() == 1
            && is_steady(&middle)
            && is_steady(&last)
            && is_uniform <= SAME * TAU
            && revolutions != 0.0
            && (revolutions - revolutions.round()).abs() <= SAME * revolutions.abs()
    }

    fn levels(&self) -> Vec<Level> {
        if !self.is_turn {
            let places = (0..self.trajectory.points).map(|k| self.trajectory.fraction_at(k));
            return vec![Level {
                samples: places.map(|u| self.sample(u)).collect(),
                alternating: Vec::new(),
            }];
        }
        let level = |k: usize| {
            let count = FIRST_POSITIONS << k;
            let places = (0..count).map(|k| k as f64 / count as f64);
            Level {
                samples: places.map(|u| self.sample(u)).collect(),
                alternating: alternating(count),
            }
        };
        (0..LEVELS).map(level).collect()
    }
}

/// Whether a mechanism has ends of its range, which move with its numbers.
fn model_has_ends<S: GradientScene>(model: &S::Model) -> bool {
    use dwell_kinetostatics::ReducibleModel as _;
    model.range().period().is_none()
}

/// The curves that are wanted, each once.
#[derive(Default)]
struct Curves {
    signals: Vec<Signal>,
}

impl Curves {
    fn channel<S: GradientScene>(&mut self, model: &S::Model, signal: &Signal) -> Option<usize> {
        let own = recorded_signal::<S>(model, signal)?;
        let known = self.signals.iter().position(|known| *known == own);
        Some(known.unwrap_or_else(|| {
            self.signals.push(own);
            self.signals.len() - 1
        }))
    }

    fn wanted<S: GradientScene>(
        &mut self,
        model: &S::Model,
        trajectory: &Trajectory<'_>,
        signal: &Signal,
        statistic: Statistic,
    ) -> Option<Wanted> {
        let Signal::Distance(distance) = signal else {
            let summed = signal.summed_by(statistic);
            return Some(Wanted::Statistic(
                self.channel::<S>(model, &summed)?,
                statistic,
            ));
        };
        let channels = distance
            .of
            .iter()
            .map(|(of, _)| self.channel::<S>(model, of));
        let channels: Vec<usize> = channels.collect::<Option<_>>()?;
        let count = distance.of.first()?.1.len();
        let row = |k: usize| distance.of.iter().map(|(_, values)| values[k]).collect();
        Some(Wanted::Distance {
            channels,
            code: Box::new(RecordedState::default()),
            rows: (0..count).map(row).collect(),
            places: match &distance.at {
                None => None,
                Some(_) => Some(places(trajectory, distance)?),
            },
            are_angles: distance.are_angles,
            statistic,
        })
    }
}

/// The places of the rows of a table along a trajectory, where they count at values of time or of an actuator.
fn places(trajectory: &Trajectory<'_>, distance: &Distance) -> Option<Vec<f64>> {
    let (signal, values) = distance.at.as_ref()?;
    let at = |u: f64| {
        let sample = trajectory.sample_at(u);
        match signal.quantity()? {
            Quantity::Time => Some(sample.t),
            Quantity::ActuatorCoordinate(i, 0) => Some(sample.q[i]),
            _ => None,
        }
    };
    let points = (0..trajectory.points).map(|k| trajectory.fraction_at(k));
    let points: Vec<f64> = points.collect();
    let place = |value: &f64| {
        let mut pairs = points.windows(2);
        let encloses = |pair: &&[f64]| {
            let [a, b] = [at(pair[0]), at(pair[1])];
            a.zip(b)
                .is_some_and(|(a, b)| (a - value) * (b - value) <= 0.0)
        };
        let around = pairs.find(encloses)?;
        let mut off = |u: f64| at(u).map(|found| found - value).ok_or(());
        root::find(&mut off, around[0], around[1]).ok()?
    };
    values.iter().map(place).collect()
}
