//! The cost of an evaluation by the requested results: no reaction, one, half of them, all; and without idle groups.

use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_dynamics::{DynamicsError, Machine};
use dwell_study::StudyError;
use dwell_study::number_format::digits;
use std::time::Instant;

/// Number of passes over the states; the minimum time counts.
const PASSES: usize = 20;

/// Times of evaluations, in units of one without reactions.
#[derive(Debug, Clone, PartialEq)]
pub struct RequestedCosts {
    /// Number of requested reactions, and time.
    pub by_reactions: Vec<[f64; 2]>,
    /// Number of idle groups, and the time without them.
    pub without_idle: (usize, f64),
}

impl RequestedCosts {
    /// The idle groups in a sentence; empty if there are none.
    pub(super) fn idle_text(&self) -> String {
        match self.without_idle {
            (0, _) => String::new(),
            (count, time) => format!(
                "Groups of bodies with neither an inertia nor a load: {count}; without them an evaluation takes {} of the time.",
                digits(time, 2)
            ),
        }
    }
}

/// The costs of evaluations at the states of a motion.
pub(super) fn requested_costs<S: StudiedScene>(
    subject: &Subject<S>,
    states: &[Vec<f64>],
) -> Result<RequestedCosts, StudyError> {
    let all = subject.scene.compared_reactions(subject.machine.model())?;
    let mut counts = vec![0, 1, all.len() / 2, all.len()];
    counts.retain(|count| *count <= all.len());
    counts.sort_unstable();
    counts.dedup();
    let time = |machine: &Machine<S::Model>, count: usize| {
        evaluation_time_of(subject, states, machine, count > 0)
    };
    let one = |count: usize| {
        let machine = subject.scene.machine(&all[..count])?;
        Ok([count as f64, time(&machine, count)?])
    };
    let times: Result<Vec<_>, StudyError> = counts.into_iter().map(one).collect();
    let mut by_reactions = times?;
    let without = by_reactions.first().map_or(f64::NAN, |first| first[1]);
    by_reactions.iter_mut().for_each(|time| time[1] /= without);
    let (pruned, idle) = subject.scene.pruned_machine()?;
    Ok(RequestedCosts {
        by_reactions,
        without_idle: (idle, time(&pruned, 0)? / without),
    })
}

/// The minimum time of an evaluation, s, with or without reactions.
fn evaluation_time_of<S: StudiedScene>(
    subject: &Subject<S>,
    states: &[Vec<f64>],
    machine: &Machine<S::Model>,
    has_reactions: bool,
) -> Result<f64, StudyError> {
    let mut workspace = machine.workspace::<f64>();
    let mut rates = vec![0.0; machine.state_count()];
    let mut pass = || -> Result<f64, DynamicsError> {
        let started = Instant::now();
        for (y, &t) in states.iter().zip(&subject.times) {
            let state = machine.evaluate(t, y, &mut workspace)?;
            state.derivative(&mut rates);
            if has_reactions {
                std::hint::black_box(state.inverse_dynamics().reactions[0]);
            }
        }
        Ok(started.elapsed().as_secs_f64() / states.len().max(1) as f64)
    };
    let mut least = f64::INFINITY;
    for _ in 0..PASSES {
        least = least.min(pass().map_err(|e| subject.explain(&e))?);
    }
    Ok(least)
}
