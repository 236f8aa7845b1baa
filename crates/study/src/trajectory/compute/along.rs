//! Statistics of quantities along a trajectory, without other results, for parameter sweeps with thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::extrema::is_continuous;
use crate::trajectory::compute::results::unwrap_angle;
use crate::trajectory::compute::{
    Analysis, Point, RowEvaluator, RowScene, Signal, Statistic, Trajectory, TrajectorySample,
    high_points,
};
use std::f64::consts::TAU;

/// Extremes that differ by less, as a part of the larger, tie.
const TIE: f64 = 1e-6;

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
    search_along(scene, rows, analysis, wanted, |search, curves, duration| {
        let each = curves.into_iter();
        let values = each.map(|(curve, statistic)| search.value(curve, statistic, duration));
        values.collect()
    })
}

/// A statistic and the positions on whose signal it depends: its derivative by a number of the scene is the sum of the weights times
/// those of the signal there, at positions that stay where they are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Weighted {
    pub(crate) value: f64,
    /// The summed signal.
    pub(crate) signal: Signal,
    /// Fractions of the trajectory, with their weights.
    pub(crate) weights: Vec<Point>,
    /// Other fractions at which an extremum is as large: the statistic has a kink there.
    pub(crate) ties: Vec<f64>,
}

/// As [`statistics_along`], with their weights.
///
/// # Errors
/// As of that.
pub(crate) fn weighted_along<S: RowScene>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    wanted: &[(Signal, Statistic)],
) -> Result<Vec<Weighted>, StudyError> {
    search_along(scene, rows, analysis, wanted, |search, curves, duration| {
        let each = curves.into_iter();
        let all = each.map(|(curve, statistic)| search.weighted(curve, statistic, duration));
        all.collect()
    })
}

/// What a search among the curves of some signals along the scene's trajectory finds; each curve comes with the statistic that is wanted of it,
/// and with the duration, s.
fn search_along<S: RowScene, R>(
    scene: &S,
    rows: &S::Rows,
    analysis: Analysis,
    wanted: &[(Signal, Statistic)],
    search: impl for<'c, 't, 'e> FnOnce(
        &mut CurveSearch<'t, S::Evaluator<'e>>,
        Vec<(&'c Curve, Statistic)>,
        f64,
    ) -> Vec<R>,
) -> Result<Vec<R>, StudyError> {
    let model = S::model_of(rows);
    let followed = scene.followed(model);
    let trajectory = Trajectory::new(&followed, analysis, None)?;
    trajectory.check_laws(&followed)?;
    let mut curves: Vec<Curve> = Vec::new();
    let mut order = Vec::with_capacity(wanted.len());
    for (signal, statistic) in wanted {
        let signal = signal.summed_by(*statistic);
        let known = curves.iter().position(|curve| curve.signal == signal);
        order.push(known.unwrap_or(curves.len()));
        if known.is_none() {
            curves.push(Curve::new(signal));
        }
    }
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
    let each = wanted.iter().zip(order);
    let each = each.map(|(&(_, statistic), k)| (&curves[k], statistic));
    Ok(search(&mut of_curves, each.collect(), duration))
}

/// A signal at the positions of a trajectory.
struct Curve {
    signal: Signal,
    points: Vec<Point>,
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
    fn near(&self, u: f64) -> f64 {
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
    }
}

/// The search for extremes between the positions.
struct CurveSearch<'a, E> {
    trajectory: &'a Trajectory<'a>,
    evaluator: E,
}

impl<E: RowEvaluator> CurveSearch<'_, E> {
    fn value(&mut self, curve: &Curve, statistic: Statistic, duration: f64) -> f64 {
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

    /// The value of a statistic with its weights.
    fn weighted(&mut self, curve: &Curve, statistic: Statistic, duration: f64) -> Weighted {
        let value = self.value(curve, statistic, duration);
        let mut found = Weighted {
            value,
            signal: curve.signal.clone(),
            weights: Vec::new(),
            ties: Vec::new(),
        };
        // Those of a mean by trapezoids, each times the derivative of its summand.
        let last = (curve.points.len() - 1) as f64;
        let mean = |slope: &dyn Fn(f64) -> f64| -> Vec<Point> {
            let each = curve.points.iter().enumerate();
            let weights = each.map(|(k, &[u, v])| {
                let is_end = k == 0 || k + 1 == curve.points.len();
                [u, slope(v) * if is_end { 0.5 } else { 1.0 } / last]
            });
            weights.collect()
        };
        match statistic {
            Statistic::Mean => found.weights = mean(&|_| 1.0),
            Statistic::Rms => found.weights = mean(&|v| v / value),
            Statistic::Work => found.weights = mean(&|_| duration),
            Statistic::Max => self.add_highest(curve, |v| v, 1.0, &mut found),
            Statistic::Min => self.add_highest(curve, |v| -v, 1.0, &mut found),
            Statistic::Stroke => {
                self.add_highest(curve, |v| v, 1.0, &mut found);
                self.add_highest(curve, |v| -v, -1.0, &mut found);
            }
            Statistic::MaxAbs | Statistic::PeakPower => {
                self.add_highest(curve, f64::abs, 1.0, &mut found);
                let at = found.weights.last().map_or(0.0, |[u, _]| *u);
                let sign = curve.near(at).signum();
                found.weights.iter_mut().for_each(|[_, w]| *w = sign);
            }
        }
        found
    }

    /// Adds the position of the highest value of a function of a signal, with a weight, and those that tie with it.
    fn add_highest(
        &mut self,
        curve: &Curve,
        of: fn(f64) -> f64,
        weight: f64,
        found: &mut Weighted,
    ) {
        let all = self.high_points(curve, of);
        let higher = |a: Point, b: Point| if b[1] > a[1] { b } else { a };
        let Some([at, highest]) = all.iter().copied().reduce(higher) else {
            return;
        };
        found.weights.push([at, weight]);
        let apart = 1.0 / (curve.points.len() - 1) as f64;
        for [u, value] in all {
            // The two ends of a turn are one position.
            let distance = (u - at).abs();
            let is_other = distance.min((1.0 - distance).abs()) > apart;
            let is_known = found.ties.iter().any(|tie| (tie - u).abs() <= apart);
            if is_other && !is_known && highest - value <= TIE * highest.abs() {
                found.ties.push(u);
            }
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
    fn high_points(&mut self, curve: &Curve, of: fn(f64) -> f64) -> Vec<Point> {
        let points: Vec<Point> = curve.points.iter().map(|[u, v]| [*u, of(*v)]).collect();
        let is_searched = match &curve.signal {
            Signal::Column(column) => is_continuous(column),
            Signal::Norm(_) | Signal::Power(_) => true,
        };
        self.evaluator
            .limit_to(curve.signal.quantities().into_iter());
        let (trajectory, evaluator) = (self.trajectory, &mut self.evaluator);
        let mut value = |u: f64| {
            let sample = trajectory.sample_at(u);
            let t = trajectory.load_time(&sample);
            evaluator
                .evaluate(&sample, t)
                .ok()
                .filter(|()| is_searched)?;
            let mut value = value_of(&curve.signal, &*evaluator, &sample);
            if curve.unwraps() {
                value += TAU * ((curve.near(u) - value) / TAU).round();
            }
            Some(of(value)).filter(|value| value.is_finite())
        };
        high_points(&points, &mut value)
    }
}
