//! States of a motion within its steps.
//!
//! Within a step the motion is integrated once more from its beginning. A search for extrema asks for many times of the
//! same step, and many columns have one in it: that integration is kept, as polynomials of at most degree 7 through its dense
//! output. An exact state within it is integrated from the last of its own steps.

use dwell_dynamics::{
    DenseOutput, MachineOde, Method, MovingModel, OdeState, Options, StepControl, StepObserver,
    integrate,
};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::PI;

/// Highest number of steps that are evaluated like samples.
pub(crate) const MAX_STEPS: usize = 50_000;
/// Points of a polynomial through a dense output.
const NODES: usize = 8;
/// Numbers that the polynomials of all steps may have, 32 MB; then they are forgotten.
const MAX_STORED: usize = 1 << 22;
/// A coefficient of this part of the largest value is rounding: with a quarter of it 186 of the 195 exact states of the single-dwell
/// were integrated again, with it 4 are.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Method, tolerance and highest number of steps from the beginning of a step to a time within it; the second where a
/// stiff motion needs too many of the first.
const METHODS: [(Method, f64, usize); 2] =
    [(Method::Dop853, 1e-12, 32), (Method::Bdf, 1e-10, 20_000)];

/// The steps that were interpolated in, by a key of the step.
#[derive(Debug)]
pub(crate) struct StatesWithinSteps<K> {
    interpolated: BTreeMap<K, Vec<Polynomials>>,
    /// How many numbers their polynomials have.
    stored: usize,
}

impl<K> Default for StatesWithinSteps<K> {
    fn default() -> Self {
        Self {
            interpolated: BTreeMap::new(),
            stored: 0,
        }
    }
}

impl<K: Ord> StatesWithinSteps<K> {
    /// The last known state of a step up to a time, s.
    pub(crate) fn before(&self, key: &K, t: f64) -> Option<OdeState> {
        let parts = self.interpolated.get(key)?.iter();
        let part = parts.rev().find(|part| part.start.t <= t);
        part.map(|part| part.start.clone())
    }

    /// The state at a time (s) by interpolation, where that is exact but for rounding.
    pub(crate) fn resolved(&self, key: &K, t: f64) -> Option<OdeState> {
        let mut parts = self.interpolated.get(key)?.iter();
        let part = parts.find(|part| part.start.t <= t && t <= part.end)?;
        part.is_resolved.then(|| OdeState { t, y: part.at(t) })
    }

    /// The state at a time (s) between two states of a step, but for the error of interpolation.
    pub(crate) fn interpolated<M: MovingModel>(
        &mut self,
        ode: &mut MachineOde<'_, M>,
        key: K,
        [before, after]: [&OdeState; 2],
        t: f64,
    ) -> Option<OdeState> {
        if !self.interpolated.contains_key(&key) && self.stored > MAX_STORED {
            self.interpolated.clear();
            self.stored = 0;
        }
        let polynomials = match self.interpolated.entry(key) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let mut by_each = METHODS.iter();
                let found =
                    by_each.find_map(|options| polynomials_of(ode, before, after.t, options))?;
                self.stored += found.len() * (NODES + 1) * before.y.len();
                new.insert(found)
            }
        };
        let part = polynomials.iter().find(|part| t <= part.end)?;
        Some(OdeState { t, y: part.at(t) })
    }
}

/// The state at a time (s), integrated from an earlier state of the same step.
pub(crate) fn exact_state<M: MovingModel>(
    ode: &mut MachineOde<'_, M>,
    before: &OdeState,
    t: f64,
) -> Option<OdeState> {
    let mut observer = |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
    let mut by_each = METHODS.iter();
    by_each.find_map(|options| state_after(ode, before, t, options, &mut observer))
}

/// The state at a time (s), integrated from an earlier state.
fn state_after<M: MovingModel>(
    ode: &mut MachineOde<'_, M>,
    before: &OdeState,
    t: f64,
    &(method, tolerance, max_steps): &(Method, f64, usize),
    observer: StepObserver<'_>,
) -> Option<OdeState> {
    // Within a step nothing switches, and nothing varies faster than it: it need not be searched again, which would take
    // most of the time.
    let options = Options {
        max_steps,
        max_step: Some(t - before.t),
        ..Options::new(method, tolerance)
    };
    let part = integrate(ode, before, Some(t), &options, observer).ok()?;
    part.error.is_none().then_some(part.state)
}

/// A motion within a part of a step: a polynomial of each state through values at Chebyshev points.
#[derive(Debug)]
struct Polynomials {
    /// The state at its beginning, and its end, s.
    start: OdeState,
    end: f64,
    /// The points, s, each with the states there.
    nodes: Vec<(f64, Vec<f64>)>,
    /// Whether the last coefficients of the polynomials are rounding.
    is_resolved: bool,
}

/// The motion from a state until a time (s), integrated once more.
fn polynomials_of<M: MovingModel>(
    ode: &mut MachineOde<'_, M>,
    before: &OdeState,
    end: f64,
    options: &(Method, f64, usize),
) -> Option<Vec<Polynomials>> {
    let mut parts = Vec::new();
    let mut observer = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        let mut node = |k: usize| {
            let angle = PI * (k as f64 + 0.5) / NODES as f64;
            let t = 0.5 * (before.t + now.t) - 0.5 * (now.t - before.t) * angle.cos();
            let mut y = now.y.clone();
            dense(t, &mut y).map(|()| (t, y))
        };
        let nodes = (0..NODES).map(&mut node).collect::<Result<Vec<_>, _>>()?;
        parts.push(Polynomials {
            start: before.clone(),
            end: now.t,
            is_resolved: is_resolved(&nodes),
            nodes,
        });
        Ok(StepControl::Continue)
    };
    state_after(ode, before, end, options, &mut observer)?;
    Some(parts)
}

/// Whether each state's polynomial through values at Chebyshev points ends in two coefficients that are rounding: the next ones
/// would be smaller yet.
fn is_resolved(nodes: &[(f64, Vec<f64>)]) -> bool {
    let states = nodes.first().map_or(0, |(_, y)| y.len());
    let coefficient = |state: usize, degree: usize| {
        let terms = nodes.iter().enumerate().map(|(k, (_, y))| {
            let angle = PI * (k as f64 + 0.5) / nodes.len() as f64;
            y[state] * (degree as f64 * angle).cos()
        });
        2.0 / nodes.len() as f64 * terms.sum::<f64>().abs()
    };
    (0..states).all(|state| {
        let largest = nodes.iter().map(|(_, y)| y[state].abs());
        let rounding = ROUNDING * largest.fold(0.0, f64::max);
        (nodes.len() - 2..nodes.len()).all(|degree| coefficient(state, degree) <= rounding)
    })
}

impl Polynomials {
    /// The states at a time (s), by the barycentric formula at Chebyshev points of the first kind.
    fn at(&self, t: f64) -> Vec<f64> {
        let weight = |k: usize| {
            let angle = PI * (k as f64 + 0.5) / NODES as f64;
            if k.is_multiple_of(2) {
                angle.sin()
            } else {
                -angle.sin()
            }
        };
        if let Some((_, y)) = self.nodes.iter().find(|(node, _)| *node == t) {
            return y.clone();
        }
        let weights = self.nodes.iter().enumerate();
        let weights: Vec<f64> = weights
            .map(|(k, (node, _))| weight(k) / (t - node))
            .collect();
        let sum: f64 = weights.iter().sum();
        let state = |i: usize| {
            let terms = weights.iter().zip(&self.nodes).map(|(w, (_, y))| w * y[i]);
            terms.sum::<f64>() / sum
        };
        let states = self.nodes.first().map_or(0, |(_, y)| y.len());
        (0..states).map(state).collect()
    }
}
