//! Features of loads between the evaluated points of a step: conditions that change in a window, and pulses.

use super::{Crossing, SwitchMonitor};
use crate::crossings::{are_together, passed_soon};
use crate::error::Result;
use crate::ode::{OdeState, OdeSystem, Step};
use crate::state_switches::Hidden;
use dwell_numerics::root;

/// Points of a step through which the variables of the loads are polynomials.
const POINTS: usize = 5;
/// Number of refinements of the step around a window that a polynomial is not exact enough to show.
const LEVELS: usize = 8;
/// Half of that part.
const ZOOM: f64 = 1.0 / 16.0;
/// Steps over the rise of a pulse.
const STEPS_OF_A_RISE: f64 = 4.0;

/// Slopes of two steps that differ by less than this part leave the variable one direction in both.
const STRAIGHT: f64 = 0.25;

/// The check between the points of a step.
#[derive(Default)]
pub(super) struct Between {
    /// The variables of the loads at equally spaced points.
    samples: [Vec<f64>; POINTS],
    /// The variables that must reverse for a feature between the points, if no others count.
    followed: Option<Vec<usize>>,
    /// The ends of the last steps, the latest first, with the variables; the time is NaN without an earlier step.
    ends: [(OdeState, Vec<f64>); 3],
    /// The longest step (s) until a time (s) up to which a pulse rises.
    pub(super) fine: Option<(f64, f64)>,
}

impl Between {
    /// The check for a system whose loads may vary between the points; otherwise `None`.
    pub(super) fn of(system: &dyn OdeSystem) -> Option<Self> {
        system.may_hide().then(|| Self {
            followed: system.followed_signals(),
            ..Self::default()
        })
    }
}

impl SwitchMonitor {
    /// The longest step while a pulse rises, s.
    pub(crate) fn max_step(&self) -> Option<f64> {
        let fine = self.between.as_ref().and_then(|between| between.fine);
        fine.map(|(step, _)| step)
    }

    /// Takes the variables of the loads, which have been evaluated at a point of the step.
    pub(super) fn sample(&mut self, point: usize, system: &dyn OdeSystem) {
        if let Some(between) = &mut self.between {
            system.read_signals(&mut between.samples[point]);
        }
    }

    /// The last sample of a step is the first of the next.
    pub(super) fn repeat_last_sample(&mut self) {
        if let Some(between) = &mut self.between {
            between.samples.swap(0, POINTS - 1);
        }
    }

    /// Whether there is no feature between the points of a step because the variables continue as in the step before, which its
    /// end shows.
    pub(super) fn goes_straight_on(
        &mut self,
        system: &mut dyn OdeSystem,
        step: &Step<'_>,
    ) -> Result<bool> {
        let Some(between) = &mut self.between else {
            return Ok(false);
        };
        let Some(followed) = &between.followed else {
            return Ok(false);
        };
        system.switch_values(step.now.t, &step.now.y, &mut self.values)?;
        between.ends.rotate_right(1);
        let [(end, now), (start, before), (first, earlier)] = &mut between.ends;
        end.t = step.now.t;
        end.y.clone_from(&step.now.y);
        system.read_signals(now);
        if start != step.before {
            // Nothing is known of the way to where the integration has begun.
            start.t = f64::NAN;
        }
        let times = [end.t - start.t, start.t - first.t];
        if times.iter().any(|t| t.is_nan()) || between.fine.is_some() {
            return Ok(false);
        }
        let mut slopes = followed.iter().map(|&i| {
            let last = (before[i] - earlier[i]) / times[1];
            (last, (now[i] - before[i]) / times[0])
        });
        Ok(slopes.all(|(last, slope)| (slope - last).abs() <= STRAIGHT * slope.abs()))
    }

    /// The feature between the points of a step, or the rise of a pulse, at which the integration restarts; `crossing` is the
    /// one found at the points.
    pub(super) fn earlier_between(
        &mut self,
        crossing: Option<Crossing>,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<Option<Crossing>> {
        let Some(mut between) = self.between.take() else {
            return Ok(crossing);
        };
        if crossing.is_some() {
            self.sample_all(
                &mut between.samples,
                [step.before.t, step.now.t],
                system,
                step,
            )?;
        }
        let (from, length) = (step.before.t, step.duration());
        let pieces = self.pieces();
        let hidden = system.hidden_in(&between.samples, &pieces);
        let found = match hidden {
            Some(Hidden::Passage { switch, at }) => {
                self.passage(switch, from + at * length, system, step)?
            }
            // Stages of the step may have met the pulse, and those of its dense output: it is taken again.
            Some(Hidden::Pulse(_)) => Some(Crossing::begin_anew(step.before.clone())),
            None if between.fine.is_some_and(|(_, risen)| step.now.t >= risen) => {
                Some(Crossing::begin_anew(step.now.clone()))
            }
            None => None,
        };
        let until = crossing.as_ref().map_or(f64::INFINITY, |c| c.state.t);
        let is_earlier =
            |found: &Crossing| found.state.t < until && !are_together(found.state.t, until);
        let found = found.filter(is_earlier);
        if found.as_ref().is_some_and(|found| found.passed.is_empty()) {
            between.fine = match hidden {
                Some(Hidden::Pulse(pulse)) => {
                    let (rise, flat) = (pulse.width * length, (pulse.at - pulse.width) * length);
                    Some(if flat > rise {
                        // Up to where it begins, to within rounding.
                        (flat, from + flat - 0.5 * rise)
                    } else {
                        (rise / STEPS_OF_A_RISE, from + flat.max(0.0) + 2.0 * rise)
                    })
                }
                _ => None,
            };
        }
        self.between = Some(between);
        Ok(found.or(crossing))
    }

    /// Where a switch is passed at about a time in a step, if it is.
    fn passage(
        &mut self,
        mut k: usize,
        mut t: f64,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<Option<Crossing>> {
        let pieces = self.pieces();
        let (start, mut length) = (step.before.t, step.duration());
        let mut samples = Default::default();
        for _ in 0..LEVELS {
            let mut values = vec![0.0; self.switches.len()];
            let mut value_at = |t: f64| -> Result<f64> {
                let state = step.state_from_start(t)?;
                system.switch_values(t, &state.y, &mut values)?;
                Ok(values[k])
            };
            let value = value_at(t)?;
            let switch = &self.switches[k];
            if switch.margin(value).is_some_and(|margin| margin < 0.0) {
                let mut margin_at =
                    |t: f64| -> Result<f64> { Ok(switch.margin(value_at(t)?).unwrap_or(f64::NAN)) };
                let upward = switch.is_above(value);
                let found = if margin_at(start)? > 0.0 {
                    root::find(margin_at, start, t)?
                } else {
                    passed_soon([start, t], &mut margin_at)?
                };
                let at = found.unwrap_or(t);
                return Ok(Some(Crossing {
                    state: step.state_from_start(at)?,
                    passed: vec![(k, upward)],
                    slide: None,
                }));
            }
            let from = (t - ZOOM * length).max(step.before.t);
            let to = (t + ZOOM * length).min(step.now.t);
            length = to - from;
            self.sample_all(&mut samples, [from, to], system, step)?;
            let Some(Hidden::Passage { switch, at }) = system.hidden_in(&samples, &pieces) else {
                break;
            };
            (k, t) = (switch, from + at * length);
        }
        Ok(None)
    }

    /// The variables of the loads at equally spaced points from one time to another.
    fn sample_all(
        &mut self,
        samples: &mut [Vec<f64>; POINTS],
        [from, to]: [f64; 2],
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<()> {
        let mut values = vec![0.0; self.switches.len()];
        for (point, sample) in samples.iter_mut().enumerate() {
            let t = from + (to - from) * point as f64 / (POINTS - 1) as f64;
            let state = step.state_from_start(t)?;
            system.switch_values(t, &state.y, &mut values)?;
            system.read_signals(sample);
        }
        Ok(())
    }
}

impl Crossing {
    /// A restart of the integration without a passage.
    pub(super) fn begin_anew(state: OdeState) -> Self {
        let (passed, slide) = (Vec::new(), None);
        Self {
            state,
            passed,
            slide,
        }
    }
}
