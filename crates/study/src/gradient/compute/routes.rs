//! The exact routes to gradients: a weighted sum of a signal at states of motion.

use super::machine_numbers::GradientScene;
use super::outputs::is_recorded;
use super::recorded_machine::{RecordedMachine, StateOfMotion};
use crate::explain::StudyError;
use crate::sweep::compute::{RequestedQuantities, ResultKind, signal_of};
use crate::trajectory::compute::{
    Analysis, Point, Quantity, Signal, Statistic, Trajectory, Weighted, analysis_along,
    extremum_with_ties, high_points, stationary_near, weighted_along,
};
use dwell_kinetostatics::{ReducedModel as _, ReducibleModel as _};

/// The exact route to the gradient of a result: weights of a signal at states.
pub(super) struct Route {
    signal: Signal,
    /// Positions with weights.
    states: Vec<(WeightedState, f64)>,
    pub(super) ties: Vec<f64>,
}

/// A state of motion that is kept.
struct WeightedState {
    load_time: Option<f64>,
    q: Vec<f64>,
    q_dot: Vec<f64>,
    q_ddot: Vec<f64>,
}

impl Route {
    /// Its signal.
    pub(super) fn signal(&self) -> &Signal {
        &self.signal
    }

    /// The gradient of a result by the numbers of the machine; `None` if a state cannot be recorded.
    pub(super) fn gradient<S: GradientScene>(
        &self,
        machine: &mut RecordedMachine<'_, S>,
    ) -> Option<Vec<f64>> {
        let mut gradient = vec![0.0; machine.numbers().len()];
        let states = self.states.iter().map(|(state, weight)| {
            let at = StateOfMotion {
                load_time: state.load_time,
                q: &state.q,
                q_dot: &state.q_dot,
                q_ddot: &state.q_ddot,
            };
            (at, *weight)
        });
        let states: Vec<(StateOfMotion<'_>, f64)> = states.collect();
        machine.add_gradients(&states, &self.signal, &mut gradient)?;
        Some(gradient)
    }
}

/// The exact route of each requested result that has one.
pub(super) fn routes<S: GradientScene>(
    scene: &S,
    rows: &S::Rows,
    requested: &RequestedQuantities,
    values: &[f64],
) -> Result<Vec<Option<Route>>, StudyError> {
    let mut routes: Vec<Option<Route>> = Vec::new();
    for (quantity, value) in requested.quantities.iter().zip(values) {
        let route = match quantity.kind {
            ResultKind::Inertia => extreme_inertia(scene, rows, quantity.index),
            ResultKind::Orbit => orbit_route(scene, rows, quantity.index == 0, *value),
            kind => match kind.statistic() {
                Some(statistic) => statistic_route(scene, rows, &quantity.name, statistic)?,
                None => None,
            },
        };
        routes.push(route);
    }
    Ok(routes)
}

/// A state without loads at a coordinate: at unit acceleration from rest the actuator force is m, at unit velocity ½m′.
fn unit_state(q: f64, is_half_dm: bool) -> WeightedState {
    let [q_dot, q_ddot] = if is_half_dm { [1.0, 0.0] } else { [0.0, 1.0] };
    WeightedState {
        load_time: None,
        q: vec![q],
        q_dot: vec![q_dot],
        q_ddot: vec![q_ddot],
    }
}

/// Positions of a range among which its extremes are, as of a reduction.
const INTERVALS: usize = 720;

/// An extremum of m or ½m′ over the range, with those that tie; `None` at an end of the range, which moves with the numbers.
fn extreme_inertia<S: GradientScene>(scene: &S, rows: &S::Rows, index: usize) -> Option<Route> {
    let (is_half_dm, sign) = (index >= 2, if index.is_multiple_of(2) { -1.0 } else { 1.0 });
    let exact = scene.unit_models(&[]).ok()?.exact;
    let mut workspace = exact.workspace();
    let mut value = |q: f64| {
        let (m, half_dm) = exact.inertia(q, &mut workspace).ok()?;
        Some(sign * if is_half_dm { half_dm } else { m })
    };
    let ([from, to], ..) = scene.default_limits(S::model_of(rows));
    let spacing = (to - from) / INTERVALS as f64;
    let places = (0..=INTERVALS).map(|k| from + spacing * k as f64);
    let points: Option<Vec<Point>> = places.map(|q| Some([q, value(q)?])).collect();
    let found = extremum_with_ties(&high_points(&points?, &mut value), [from, to], spacing)?;
    let at = stationary_near(&mut value, found.at, [from, to], spacing);
    let is_turn = S::model_of(rows).range().period().is_some();
    let is_inside = at > from + spacing && at < to - spacing;
    (is_turn || is_inside).then(|| Route {
        signal: Signal::of(Quantity::ActuatorForce(0)),
        states: vec![(unit_state(at, is_half_dm), 1.0)],
        ties: found.ties,
    })
}

/// Positions of a turn by which its period is summed at least and at most, and the part to which the sum has to be the result.
const POSITIONS: [usize; 2] = [64, 4096];
const SAME_PERIOD: f64 = 1e-11;

/// Period or energy of a free rotation without loads from its start: E = ½ m₀ q̇₀², T = ∮ √(m / 2E) dq, by trapezoids, whose error vanishes
/// with every power of the spacing.
fn orbit_route<S: GradientScene>(
    scene: &S,
    rows: &S::Rows,
    is_period: bool,
    value: f64,
) -> Option<Route> {
    let start = scene.motion_start();
    let (q, q_dot) = (*start.coordinates.first()?, *start.velocities.first()?);
    let turn = S::model_of(rows).range().period()?;
    let is_free = scene.loads().is_empty() && scene.drives().is_empty() && scene.stops().is_empty();
    if !is_free || q_dot == 0.0 || start.coordinates.len() != 1 {
        return None;
    }
    let exact = scene.unit_models(&[]).ok()?.exact;
    let mut workspace = exact.workspace();
    let mut m = |q: f64| Some(exact.inertia(q, &mut workspace).ok()?.0);
    let at_start = m(q)?;
    let energy = 0.5 * at_start * q_dot * q_dot;
    let mut route = Route {
        signal: Signal::of(Quantity::ActuatorForce(0)),
        states: vec![(unit_state(q, false), 0.5 * q_dot * q_dot)],
        ties: Vec::new(),
    };
    if !is_period {
        return Some(route);
    }
    let mut count = POSITIONS[0];
    while count <= POSITIONS[1] {
        let step = turn / count as f64;
        let places: Vec<f64> = (0..count).map(|k| q + step * k as f64).collect();
        let values: Option<Vec<f64>> = places.iter().map(|q| m(*q)).collect();
        let roots: Vec<f64> = values?.iter().map(|m| (m * 2.0 * energy).sqrt()).collect();
        let period = step * roots.iter().sum::<f64>() / (2.0 * energy);
        if (period - value).abs() <= SAME_PERIOD * value {
            // ∂T/∂m₀ by the energy, then ∂T/∂m at each position.
            route.states = vec![(unit_state(q, false), -0.5 * period / at_start)];
            let each = places.iter().zip(&roots);
            let each = each.map(|(q, root)| (unit_state(*q, false), 0.5 * step / root));
            route.states.extend(each);
            return Some(route);
        }
        count *= 2;
    }
    None
}

/// A signal of what is recorded: a magnitude by its components. `None` if it is of something else.
pub(crate) fn recorded_signal<S: GradientScene>(
    model: &S::Model,
    signal: &Signal,
) -> Option<Signal> {
    let own = match signal.quantity() {
        Some(Quantity::ForceMagnitude(joint)) => Signal::Norm(S::components(model, joint, false)?),
        Some(Quantity::MomentMagnitude(joint)) => Signal::Norm(S::components(model, joint, true)?),
        _ => signal.clone(),
    };
    let is_distance = matches!(own, Signal::Distance(_));
    let is_recorded = own.quantities().iter().all(|q| is_recorded::<S>(*q));
    (is_recorded && !is_distance).then_some(own)
}

/// A part of a trajectory that belongs to its end.
const END: f64 = 3e-3;

/// The positions and weights of a statistic along the trajectory of the scene; `None` if its positions move with the numbers.
fn statistic_route<S: GradientScene>(
    scene: &S,
    rows: &S::Rows,
    name: &str,
    statistic: Statistic,
) -> Result<Option<Route>, StudyError> {
    let Some(analysis) = analysis_along(scene) else {
        return Ok(None);
    };
    let model = S::model_of(rows);
    let Some(signal) = signal_of(scene, rows, analysis, name) else {
        return Ok(None);
    };
    let found = weighted_along(scene, rows, analysis, &[(signal, statistic)])?;
    let Some(Some(weighted)) = found.into_iter().next() else {
        return Ok(None);
    };
    // Without a prescribed motion or sweep the trajectory is the range, whose ends move; an extremum inside does not.
    let moves = scene.prescribed() == (None, None) && model.range().period().is_none();
    let is_inside = |u: f64| u > END && u < 1.0 - END;
    if moves && !weighted.weights.iter().all(|[u, _]| is_inside(*u)) {
        return Ok(None);
    }
    let Some(signal) = recorded_signal::<S>(model, &weighted.signal) else {
        return Ok(None);
    };
    let weighted = Weighted { signal, ..weighted };
    let followed = scene.followed(model);
    let trajectory = Trajectory::new(&followed, analysis, None)?;
    Ok(Some(route_of(&trajectory, analysis, weighted)))
}

/// The states of a statistic along a trajectory.
fn route_of(trajectory: &Trajectory<'_>, analysis: Analysis, weighted: Weighted) -> Route {
    let state = |u: f64| {
        let sample = trajectory.sample_at(u);
        let rest = vec![0.0; sample.q.len()];
        let [q, q_dot, q_ddot] = sample.state(analysis, &rest).map(<[f64]>::to_vec);
        WeightedState {
            load_time: Some(trajectory.load_time(&sample)),
            q,
            q_dot,
            q_ddot,
        }
    };
    let weights = weighted
        .weights
        .into_iter()
        .filter(|[_, weight]| *weight != 0.0);
    let ties = weighted.ties.into_iter();
    Route {
        signal: weighted.signal,
        states: weights.map(|[u, weight]| (state(u), weight)).collect(),
        ties: ties
            .map(|u| trajectory.sample_at(u).coordinate(0))
            .collect(),
    }
}
