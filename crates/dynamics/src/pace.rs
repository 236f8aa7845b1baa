//! The pace of an integration: whether it reaches its end within the allowed steps.
//!
//! Steps are counted in windows. If a window advances so little that the rest would take many times the allowed steps, the integration ends
//! at once instead of after the last allowed step. A long window shows a motion that is too slow. A short window shows a motion that makes
//! no progress: at an unnamed jump, as of a load given as a function of a program, the error control of every method makes the accepted
//! steps so short that the end is never reached.

use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;

/// Number of long windows in the allowed steps.
const WINDOWS: usize = 40;
/// Least number of steps of a window.
const MIN_WINDOW: usize = 5;
/// A pace at which the rest takes this multiple of the allowed steps is too slow: a motion that only starts slowly accelerates
/// by less.
const TOO_MANY: f64 = 20.0;
/// Steps of a short window, without a load that a program computes and with one: that is expected to jump.
const STEPS: [usize; 2] = [10_000, 1000];
/// The multiple for short windows; a motion that is stiff or fast for a while stays below it.
const HOPELESS: f64 = 1000.0;
/// Switches of a window where switches are counted instead of steps: next to where they accumulate there is one in each step.
const SWITCHES: usize = 2000;
/// As `TOO_MANY`, for switches, each of which costs more than a step; and for switches that come more and more often, as where they
/// accumulate.
const TOO_MANY_SWITCHES: [f64; 2] = [1.0, 0.05];
const MORE_OFTEN: f64 = 3.0;

/// Steps between two evaluations of the energy balance.
const LOOKED_AT: usize = 1000;
/// A balance that changes between two checks by more than this fraction of the largest kinetic energy is lost: beyond singular positions,
/// changes by 0.3 to 10 times that energy were observed.
const BROKEN: f64 = 0.1;
/// A change below this fraction of the balance itself is ignored, because a small oscillation may have a large
/// potential energy.
const ENERGY_ROUNDING: f64 = 1e-9;

/// The steps of an integration, and how far the last of them have led.
#[derive(Debug, Clone)]
pub(crate) struct Pace {
    end: f64,
    max_steps: usize,
    steps: usize,
    /// The first load given as a function of a program; if switches are counted, the load of the last switch.
    function: Option<usize>,
    /// Steps of a short and of a long window; `None` if the window is not checked.
    windows: [Option<usize>; 2],
    /// When the windows began, s.
    from: [f64; 2],
    start: f64,
    /// As `TOO_MANY`, for the counted quantity: at a pace that may become faster, and at one that becomes slower and
    /// slower.
    too_many: [f64; 2],
    /// The largest kinetic energy and the balance at the last check, J.
    looked_at: Option<[f64; 2]>,
    /// Whether the balance was lost at the last look.
    seems_lost: bool,
    /// The error of energies that the tolerance allows between two looks, as a part of the largest kinetic energy.
    truncation: f64,
}

impl Pace {
    /// The pace at the start of an integration; `function` is the first load given as a function of a program.
    pub(crate) fn new(of: &Part, function: Option<usize>) -> Self {
        let max_steps = of.options.max_steps;
        // Where the user has set the longest step, that says how many there are.
        let short = of.options.max_step.is_none();
        let long = Some(max_steps / WINDOWS).filter(|window| *window >= MIN_WINDOW);
        Self {
            // Without an end nothing is left that could take too long.
            end: of
                .end
                .filter(|end| end.is_finite())
                .unwrap_or(f64::NEG_INFINITY),
            max_steps,
            steps: 0,
            function,
            windows: [
                short.then_some(STEPS[usize::from(function.is_some())]),
                long,
            ],
            from: [of.start.t; 2],
            start: of.start.t,
            too_many: [TOO_MANY; 2],
            looked_at: None,
            seems_lost: false,
            truncation: 10.0 * LOOKED_AT as f64 * of.options.rtol,
        }
    }

    /// The pace of the switches of an integration: each counts as a step.
    pub(crate) fn of_switches(of: &Part) -> Self {
        Self {
            windows: [None, Some(SWITCHES)],
            too_many: TOO_MANY_SWITCHES,
            ..Self::new(of, None)
        }
    }

    /// The steps so far.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Whether the rest, from a time (s), takes more than so many times the steps allowed if some steps lead on by `advance`, s.
    pub(crate) fn is_too_slow(&self, t: f64, times: f64, steps: usize, advance: f64) -> bool {
        (self.end - t) * steps as f64 > advance * times * self.max_steps as f64
    }

    /// After a step that has ended at a time, s. The first long window does not count: a method begins with short steps.
    ///
    /// # Errors
    /// [`DynamicsError::NoProgress`], [`DynamicsError::TooSlow`].
    #[inline]
    pub(crate) fn step_taken(&mut self, t: f64) -> Result<()> {
        self.steps += 1;
        let (steps, max_steps) = (self.steps, self.max_steps);
        if let Some((window, advance)) = self.full(1, t)
            && steps > window
            && self.is_too_slow(t, self.times(advance / window as f64, t), window, advance)
        {
            let needed = (self.end - t) / advance * window as f64;
            return Err(DynamicsError::TooSlow {
                t,
                steps,
                needed,
                max_steps,
                switching: None,
            });
        }
        if let Some((window, advance)) = self.full(0, t)
            && self.is_too_slow(t, HOPELESS, window, advance)
        {
            let (function, step) = (self.function, advance / window as f64);
            return Err(DynamicsError::NoProgress { function, t, step });
        }
        Ok(())
    }

    /// Checks after a step to a time, s, whether the kinetic energy, and the energies minus the works (`balance`, J), are still those of
    /// the mechanism. They are evaluated once in many steps. If they seem to be lost, they are evaluated at each step up to the next check,
    /// because the largest kinetic energy may have been between the checks.
    ///
    /// # Errors
    /// [`DynamicsError::LostBalance`].
    #[inline]
    pub(crate) fn look_at_balance(
        &mut self,
        t: f64,
        balance: impl FnOnce() -> Option<[f64; 2]>,
    ) -> Result<()> {
        let is_due = self.steps.is_multiple_of(LOOKED_AT);
        if !(is_due || self.seems_lost) {
            return Ok(());
        }
        let Some([kinetic, now]) = balance() else {
            return Ok(());
        };
        let [largest, before] = self.looked_at.get_or_insert([kinetic, now]);
        *largest = largest.max(kinetic);
        if is_due {
            let rounding = ENERGY_ROUNDING * (now.abs() + before.abs());
            let allowed = BROKEN.max(self.truncation) * *largest + rounding;
            let is_lost = (now - *before).abs() > allowed;
            if is_lost && self.seems_lost {
                return Err(DynamicsError::LostBalance { t });
            }
            if !is_lost {
                *before = now;
            }
            self.seems_lost = is_lost;
        }
        Ok(())
    }

    /// How many times the steps allowed are too many where the last ones have led on by so much each, s, up to a time, s.
    fn times(&self, advance: f64, t: f64) -> f64 {
        let is_slower = MORE_OFTEN * advance * (self.steps as f64) < t - self.start;
        self.too_many[usize::from(is_slower)]
    }

    /// After a switch of a load at a time, s.
    ///
    /// # Errors
    /// [`DynamicsError::TooSlow`].
    pub(crate) fn switched(&mut self, load: Option<usize>, t: f64) -> Result<()> {
        self.function = load.or(self.function);
        let last = self.function;
        self.step_taken(t).map_err(|mut error| {
            if let DynamicsError::TooSlow { switching, .. } = &mut error {
                *switching = last;
            }
            error
        })
    }

    /// The steps of a window that ends with a step to a time (s), and the time that they have covered, s.
    fn full(&mut self, which: usize, t: f64) -> Option<(usize, f64)> {
        let window = self.windows[which].filter(|window| self.steps.is_multiple_of(*window))?;
        let advance = t - std::mem::replace(&mut self.from[which], t);
        Some((window, advance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Method, OdeState, Options};

    /// Whether the check accepts these energies, at a tolerance.
    fn are_kept(rtol: f64, energies: impl Fn(usize) -> [f64; 2]) -> bool {
        let part = Part {
            start: OdeState {
                t: 0.0,
                y: Vec::new(),
            },
            end: Some(1.0),
            options: Options::new(Method::Bdf, rtol),
            first_step: None,
        };
        let mut pace = Pace::new(&part, None);
        (1..=5 * LOOKED_AT).all(|step| {
            pace.steps = step;
            pace.look_at_balance(1e-9, || Some(energies(step))).is_ok()
        })
    }

    #[test]
    fn energies_that_miss_their_works_end_a_motion_and_truncation_and_rounding_do_not() {
        // A position beyond a singular one: of 28 J kinetic energy 26 J are gone.
        let jump = |step: usize| [[28.0, 13.3], [2.0, -12.8]][usize::from(step > 1500)];
        assert!(!are_kept(1e-10, jump));
        assert!(are_kept(1e-10, |step| [28.0, 13.3 + 1e-6 * step as f64]));
        assert!(are_kept(1e-4, |step| [28.0, 13.3 + 5e-3 * step as f64]));
        // An oscillation that is slow whenever it is looked at.
        let kinetic = |step: usize| if step.is_multiple_of(500) { 1e-9 } else { 1e-3 };
        assert!(are_kept(1e-6, |step| [kinetic(step), 1e-8 * step as f64]));
        // A small oscillation with a large potential energy.
        assert!(are_kept(1e-10, |step| [
            1e-9,
            10.0 + [1e-9, -1e-9][step / 1000 % 2]
        ]));
    }
}
