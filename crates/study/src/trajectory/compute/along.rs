//! Statistics of quantities along a trajectory, without other results, for parameter sweeps with thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::extrema::is_continuous;
use crate::trajectory::compute::results::unwrap_angle;
use crate::trajectory::compute::{
    Analysis, Point, RowEvaluator, RowScene, Signal, Statistic, Trajectory, TrajectorySample,
    high_points,
};
use std::f64::consts::TAU;

/// The analysis for statistics: along the scene's motion or sweep, or statics over its range.
pub(crate) fn analysis_along(scene: &impl RowScene) -> Option<Analysis> {
    if let (Some(_), _) | (_, Some(_)) = scene.prescribed() {
        return Some(Analysis::Kinetostatics);
    }
    (scene.assembly_coordinates().len() == 1).then_some(Analysis::Statics)
}

/// The analysis for the largest forces, which are computed by default: statics only under loads.
pub(crate) fn peak_analysis(scene: &impl RowScene) -> Option<Analysis> {
    let has_forces =
        |analysis: &Analysis| *analysis != Analysis::Statics || !scene.load_names().is_empty();
    analysis_along(scene).filter(has_forces)
}

/// Some statistics of signals along the scene's trajectory, in their order. Extremes are searched for at its positions and between them;
/// means are trapezoids between its positions.
///
/// # Errors
/// [`StudyError::Scene`] where the scene defines no trajectory, or it ends early.
pub(crate) fn statistics_along<S: RowScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    wanted: &[(Signal, Statistic)],
) -> Result<Vec<f64>, StudyError> {
    search_along(
        scene,
        rows,
        analysis,
        wanted,
        |search, curves, all, duration| {
            let values = all.iter().map(|(signal, statistic)| match signal {
                Signal::Distance(distance) => {
                    let distances = search.distances(distance, curves).unwrap_or_default();
                    of_distances(&distances, *statistic)
                }
                own => {
                    let curve = curves.iter().find(|curve| curve.signal == *own);
                    curve.map_or(f64::NAN, |curve| search.value(curve, *statistic, duration))
                }
            });
            values.collect()
        },
    )
}

/// The values of a signal at the positions of the scene's trajectory.
///
/// # Errors
/// As of [`statistics_along`].
#[cfg(feature = "output")]
pub(crate) fn curve_along<S: RowScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    signal: &Signal,
) -> Result<Vec<Point>, StudyError> {
    let wanted = [(signal.clone(), Statistic::Max)];
    search_along(scene, rows, analysis, &wanted, |_, curves, _, _| {
        let first = curves.first();
        first.map_or_else(Vec::new, |curve| curve.points.clone())
    })
}

/// What a search finds among the curves of some signals along the scene's trajectory. It takes the curves, the wanted statistics with the
/// signals that they sum up, and the duration, s.
pub(super) fn search_along<S: RowScene, R>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    wanted: &[(Signal, Statistic)],
    search: impl for<'c, 't, 'e> FnOnce(
        &mut CurveSearch<'t, S::Evaluator<'e>>,
        &'c [Curve],
        &'c [(Signal, Statistic)],
        f64,
    ) -> Vec<R>,
) -> Result<Vec<R>, StudyError> {
    let model = S::model_of(rows);
    let followed = scene.followed(model);
    let trajectory = Trajectory::new(&followed, analysis, None)?;
    trajectory.check_laws(&followed)?;
    let wanted: Vec<(Signal, Statistic)> = wanted
        .iter()
        .map(|(signal, statistic)| (signal.summed_by(*statistic), *statistic))
        .collect();
    let mut curves: Vec<Curve> = Vec::new();
    for signal in wanted.iter().flat_map(|(signal, _)| signal.parts()) {
        if !curves.iter().any(|curve| curve.signal == *signal) {
            curves.push(Curve::new(signal.clone()));
        }
    }
    // Without columns also of a model that computes the wanted reactions alone.
    let mut evaluator = scene.evaluator(rows, rows, analysis, &[])?;
    evaluator.limit_to(curves.iter().flat_map(|curve| curve.signal.quantities()));
    let mut times = Vec::with_capacity(trajectory.points);
    let early_stop = trajectory.follow::<S>(model, |k, sample| {
        evaluator.evaluate(sample, trajectory.load_time(sample))?;
        let u = trajectory.fraction_at(k);
        times.push(sample.t);
        for curve in &mut curves {
            curve.add(u, &evaluator, sample);
        }
        Ok(())
    });
    if let Some(stop) = early_stop {
        return Err(scene.explain_stop(model, stop));
    }
    let duration = times.last().zip(times.first()).map_or(0.0, |(b, a)| b - a);
    let mut of_curves = CurveSearch {
        trajectory: &trajectory,
        evaluator,
    };
    Ok(search(&mut of_curves, &curves, &wanted, duration))
}

/// A statistic of distances from the rows of a table; NaN if there are none.
fn of_distances(distances: &[f64], statistic: Statistic) -> f64 {
    let mean_of =
        |of: fn(f64) -> f64| distances.iter().map(|d| of(*d)).sum::<f64>() / distances.len() as f64;
    match statistic {
        Statistic::Mean => mean_of(|d| d),
        Statistic::Rms => mean_of(|d| d * d).sqrt(),
        _ => distances.iter().copied().fold(f64::NAN, f64::max),
    }
}

/// A signal at the positions of a trajectory.
pub(super) struct Curve {
    pub(super) signal: Signal,
    pub(super) points: Vec<Point>,
    /// Of an angle that unwraps: the last value, its rate and its time.
    last: Option<[f64; 3]>,
}

impl Curve {
    fn new(signal: Signal) -> Self {
        Self {
            signal,
            points: Vec::new(),
            last: None,
        }
    }

    fn unwraps(&self) -> bool {
        matches!(&self.signal, Signal::Column(column) if column.unwraps)
    }

    fn add(&mut self, u: f64, evaluator: &impl RowEvaluator, sample: &TrajectorySample) {
        let mut value = value_of(&self.signal, evaluator, sample);
        if let (true, Some(quantity)) = (self.unwraps(), self.signal.quantity()) {
            let speed = evaluator.angular_velocity(quantity);
            value = unwrap_angle(&mut self.last, value, speed, sample.t);
        }
        self.points.push([u, value]);
    }

    /// The value at the position nearest to a fraction.
    pub(super) fn near(&self, u: f64) -> f64 {
        let last = self.points.len().saturating_sub(1);
        let k = (u * last as f64).round() as usize;
        self.points.get(k).map_or(f64::NAN, |[_, value]| *value)
    }

    /// The mean of a function of the values over time, by trapezoids between the positions, which are at equal times.
    fn mean_of(&self, of: fn(f64) -> f64) -> f64 {
        let pairs = self.points.windows(2);
        let sum: f64 = pairs.map(|p| 0.5 * (of(p[0][1]) + of(p[1][1]))).sum();
        sum / (self.points.len() - 1) as f64
    }
}

/// A signal at the position that was evaluated last.
fn value_of(signal: &Signal, evaluator: &impl RowEvaluator, sample: &TrajectorySample) -> f64 {
    match signal {
        Signal::Column(column) => evaluator.value(column.quantity, sample),
        Signal::Norm(components) => {
            let squares = components
                .iter()
                .map(|c| evaluator.value(*c, sample).powi(2));
            squares.sum::<f64>().sqrt()
        }
        Signal::Power(i) => evaluator.forces().tau[*i] * sample.q_dot[*i],
        Signal::Distance(_) => f64::NAN,
    }
}

/// The search for extremes between the positions.
pub(super) struct CurveSearch<'a, E> {
    trajectory: &'a Trajectory<'a>,
    pub(super) evaluator: E,
}

impl<E: RowEvaluator> CurveSearch<'_, E> {
    pub(super) fn value(&mut self, curve: &Curve, statistic: Statistic, duration: f64) -> f64 {
        match statistic {
            Statistic::Max => self.highest(curve, |v| v),
            Statistic::Min => -self.highest(curve, |v| -v),
            Statistic::MaxAbs | Statistic::PeakPower => self.highest(curve, f64::abs),
            Statistic::Stroke => self.highest(curve, |v| v) + self.highest(curve, |v| -v),
            Statistic::Mean => curve.mean_of(|v| v),
            Statistic::Rms => curve.mean_of(|v| v * v).sqrt(),
            Statistic::Work => duration * curve.mean_of(|v| v),
        }
    }

    /// The largest value of a function of a signal.
    fn highest(&mut self, curve: &Curve, of: fn(f64) -> f64) -> f64 {
        let values = self.high_points(curve, of).into_iter();
        values
            .map(|[_, value]| value)
            .reduce(f64::max)
            .unwrap_or(f64::NAN)
    }

    /// The highest position of a function of a signal, and those that are nearly as high.
    pub(super) fn high_points(&mut self, curve: &Curve, of: fn(f64) -> f64) -> Vec<Point> {
        let points: Vec<Point> = curve.points.iter().map(|[u, v]| [*u, of(*v)]).collect();
        let is_searched = match &curve.signal {
            Signal::Column(column) => is_continuous(column),
            Signal::Norm(_) | Signal::Power(_) | Signal::Distance(_) => true,
        };
        self.evaluator
            .limit_to(curve.signal.quantities().into_iter());
        let mut value = |u: f64| {
            let found = self.values(u, &[curve]).filter(|_| is_searched)?;
            Some(of(found[0])).filter(|value| value.is_finite())
        };
        high_points(&points, &mut value)
    }

    /// The values of signals at a completed fraction; the revolutions of an angle are those of the nearest position.
    pub(super) fn values(&mut self, u: f64, curves: &[&Curve]) -> Option<Vec<f64>> {
        let sample = self.trajectory.sample_at(u);
        let t = self.trajectory.load_time(&sample);
        self.evaluator.evaluate(&sample, t).ok()?;
        let values = curves.iter().map(|curve| {
            let value = value_of(&curve.signal, &self.evaluator, &sample);
            let revolutions = match curve.unwraps() {
                true => ((curve.near(u) - value) / TAU).round(),
                false => 0.0,
            };
            value + TAU * revolutions
        });
        Some(values.collect())
    }
}
