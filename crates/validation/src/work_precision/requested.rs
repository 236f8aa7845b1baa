//! What an evaluation costs against what is requested of it: no reaction, one, half of them, all. What nothing requests is not evaluated.

use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_dynamics::DynamicsError;
use dwell_study::StudyError;
use std::time::Instant;

/// Passes over the states, of which the least time counts.
const PASSES: usize = 20;

/// By number of requested reactions: the time of an evaluation with them, in units of one without.
pub(super) fn requested_costs<S: StudiedScene>(
    subject: &Subject<S>,
    states: &[Vec<f64>],
) -> Result<Vec<[f64; 2]>, StudyError> {
    let all = subject.scene.compared_reactions(subject.machine.model())?;
    let mut counts = vec![0, 1, all.len() / 2, all.len()];
    counts.retain(|count| *count <= all.len());
    counts.sort_unstable();
    counts.dedup();
    let one = |count: usize| {
        let machine = subject.scene.machine(&all[..count])?;
        let mut workspace = machine.workspace::<f64>();
        let mut rates = vec![0.0; machine.state_count()];
        let mut pass = || -> Result<f64, DynamicsError> {
            let started = Instant::now();
            for (y, &t) in states.iter().zip(&subject.times) {
                let state = machine.evaluate(t, y, &mut workspace)?;
                state.derivative(&mut rates);
                if count > 0 {
                    std::hint::black_box(state.inverse_dynamics().reactions[0]);
                }
            }
            Ok(started.elapsed().as_secs_f64() / states.len().max(1) as f64)
        };
        let mut least = f64::INFINITY;
        for _ in 0..PASSES {
            least = least.min(pass().map_err(|e| subject.explain(&e))?);
        }
        Ok([count as f64, least])
    };
    let times: Result<Vec<_>, StudyError> = counts.into_iter().map(one).collect();
    let mut times = times?;
    let without = times.first().map_or(f64::NAN, |first| first[1]);
    times.iter_mut().for_each(|time| time[1] /= without);
    Ok(times)
}
