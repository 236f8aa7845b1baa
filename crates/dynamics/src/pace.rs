//! Whether an integration comes to its end in the steps that are allowed.
//!
//! Steps are counted in windows. Where one window has led so short a way that the rest would take many times the steps allowed, the
//! integration ends at once: it would end there a little later, after the last step allowed. A long window shows a motion that is too slow.
//! A short one shows one that makes no progress: at a jump that nobody has named, as of a load that a program computes, the error control of
//! every method makes its steps so short that the end would never be reached, while each of them is kept.

use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;

/// The steps allowed are so many long windows.
const WINDOWS: usize = 40;
/// The pace of fewer steps shows nothing.
const MIN_WINDOW: usize = 5;
/// A pace at which the rest takes so many times the steps allowed is too slow: what only begins slowly becomes faster by less.
const TOO_MANY: f64 = 20.0;
/// Steps of a short window, without a load that a program computes and with one: that is expected to jump.
const STEPS: [usize; 2] = [10_000, 1000];
/// The same of short windows: what is stiff or moves fast for a while needs less.
const HOPELESS: f64 = 1000.0;
/// Switches of a window where switches are counted instead of steps: next to where they accumulate there is one in each step.
const SWITCHES: usize = 2000;
/// As `TOO_MANY`, of switches, each of which costs more than a step; and where they come so many times as often as on the average before,
/// as where they accumulate.
const TOO_MANY_SWITCHES: [f64; 2] = [1.0, 0.05];
const MORE_OFTEN: f64 = 3.0;

/// Steps between two evaluations of the energy balance.
const LOOKED_AT: usize = 1000;
/// A balance that changes between two looks by more than this part of the largest kinetic energy is lost: beyond singular positions it was
/// seen to change by 0.3 to 10 times that energy.
const BROKEN: f64 = 0.1;
/// A change below this part of the balance itself says nothing: a small oscillation may have a large potential energy.
const ENERGY_ROUNDING: f64 = 1e-9;

/// The steps of an integration, and how far the last of them have led.
#[derive(Debug, Clone)]
pub(crate) struct Pace {
    end: f64,
    max_steps: usize,
    steps: usize,
    /// The first load that a program computes; where switches are counted, that of the last one.
    function: Option<usize>,
    /// Steps of a short and of a long window; none where it is not looked at.
    windows: [Option<usize>; 2],
    /// When the windows began, s.
    from: [f64; 2],
    start: f64,
    /// As `TOO_MANY`, of what is counted: at a pace that may become faster, and where it has become slower and slower.
    too_many: [f64; 2],
    /// The largest kinetic energy and the balance, J, where the energies were looked at last.
    looked_at: Option<[f64; 2]>,
    /// Whether the balance was lost at the last look.
    seems_lost: bool,
    /// The error of energies that the tolerance allows between two looks, as a part of the largest kinetic energy.
    truncation: f64,
}

impl Pace {
    /// Of an integration that begins; `function` is the first load that a program computes.
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

    /// After a step to a time, s: whether the kinetic energy, and the energies less the works (`balance`, J), are still those of the mechanism. They
    /// are evaluated once in many steps; where they seem to be lost, at each step up to the next look, for the largest kinetic energy may have
    /// been between the looks, as of an oscillation that is slow whenever it is looked at.
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

    /// Of a window that ends with a step to a time (s), its steps and how far they have led, s.
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

    /// Whether energies are taken for those of the mechanism over so many looks, at a tolerance.
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
