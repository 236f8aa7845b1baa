//! Smooth functions of a phase with sharp peaks: Chebyshev series on panels, which are halved
//! until the series are resolved. A peak of width w takes about log₂ 1/w panels, compared with 1/w equally spaced points.

use std::f64::consts::{PI, TAU};

/// Number of points of a panel.
const PANEL_POINTS: usize = 24;
/// Maximum number of panels.
const MAX_PANELS: usize = 2048;
const MAX_HALVINGS: u32 = 50;
/// Coefficients below this fraction of the panel's largest value are rounding errors.
const COEFFICIENT_ROUNDING: f64 = 2e-15;
/// Below this fraction, coefficients whose last third is not below a quarter of the third before are also
/// rounding errors, of less accurate values.
const NOISY_TAIL: f64 = 1e-4;
const FLATNESS: f64 = 0.25;

/// At its ends, the series of a panel may differ from the function by this many times its last coefficients,
const END_TAILS: f64 = 100.0;
/// or by this fraction of its largest value.
const END_ERROR: f64 = 1e-6;
/// Last coefficients below this fraction of the largest value are accepted as rounding errors without further test.
const SURELY_NOISE: f64 = 1e-12;
/// So are those of narrower panels, where rounding errors of positions are equal at neighbouring points.
const PROVEN_WIDTH: f64 = 1e-4;
/// Otherwise the largest difference between neighbours is measured at this many points,
const NOISE_POINTS: usize = 8;
/// of neighbours at this fraction of the panel's width,
const NEIGHBOUR: f64 = 1e-9;
/// and must be at least this fraction of the last coefficients.
const NOISE_PART: f64 = 0.1;

/// A function that the maximum number of panels does not resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NotResolved {
    /// Number of points at which it was evaluated.
    pub points: usize,
    /// Truncation error of its integral by the last coefficients of a panel, relative to the integral.
    pub tail: f64,
}

/// A function of a phase from 0 to 2π on panels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Panels {
    panels: Vec<Panel>,
    /// Its mean: the integral over a period divided by 2π.
    pub mean: f64,
    /// Truncation error of its integral by the last coefficients of the panels, relative to the integral.
    pub tail: f64,
    /// Number of points at which it was evaluated.
    pub points: usize,
}

#[derive(Debug, Clone, PartialEq)]
struct Panel {
    from: f64,
    to: f64,
    /// The integral up to `from`.
    integral_before: f64,
    /// Chebyshev coefficients of the function on −1 … 1.
    coefficients: Vec<f64>,
    /// Chebyshev coefficients of its integral from `from`.
    integral_coefficients: Vec<f64>,
    tail: f64,
}

impl Panels {
    /// Approximates a function of the phase.
    ///
    /// # Errors
    /// [`NotResolved`], or the first error of the function.
    pub fn new<E: From<NotResolved>>(of: impl FnMut(f64) -> Result<f64, E>) -> Result<Self, E> {
        Self::build(of, None)
    }

    /// Approximates a function that is smooth except for rounding, with additional checks. A panel whose series is resolved is nevertheless
    /// halved if the series differs from the function at its ends, if apparent rounding errors are equal at neighbouring points, or if `check`,
    /// called after the points of each panel, rejects it.
    ///
    /// # Errors
    /// As [`Panels::new`].
    pub fn checked<E: From<NotResolved>>(
        of: impl FnMut(f64) -> Result<f64, E>,
        mut check: impl FnMut() -> bool,
    ) -> Result<Self, E> {
        Self::build(of, Some(&mut check))
    }

    fn build<E: From<NotResolved>>(
        mut of: impl FnMut(f64) -> Result<f64, E>,
        mut check: Option<&mut dyn FnMut() -> bool>,
    ) -> Result<Self, E> {
        let mut found = Self::default();
        // The last panel is processed next, so panels are completed in order.
        let mut open = vec![(0.5 * TAU, TAU, 1), (0.0, 0.5 * TAU, 1)];
        let mut sum = 0.0;
        let mut tail = 0.0;
        while let Some((from, to, halvings)) = open.pop() {
            let panel = Panel::new(from, to, sum, &mut of)?;
            found.points += PANEL_POINTS;
            let mut done = panel.is_resolved();
            if let Some(check) = &mut check {
                let holds = done && panel.holds_at_ends(&mut of)?;
                done = check() && holds && panel.is_noise(&mut of)?;
                // The points of the noise test belong to no panel.
                check();
            }
            if !done && (halvings >= MAX_HALVINGS || found.panels.len() + open.len() >= MAX_PANELS)
            {
                return Err(E::from(NotResolved {
                    points: found.points,
                    tail: panel.tail * (to - from) / (sum + panel.total_integral()),
                }));
            }
            if done {
                sum += panel.total_integral();
                tail += panel.tail * (to - from);
                found.panels.push(panel);
            } else {
                let middle = 0.5 * (from + to);
                open.push((middle, to, halvings + 1));
                open.push((from, middle, halvings + 1));
            }
        }
        found.mean = sum / TAU;
        found.tail = tail / sum;
        Ok(found)
    }

    /// Its value and its integral from zero at a phase.
    pub fn eval(&self, phase: f64) -> [f64; 2] {
        let revolutions = (phase / TAU).floor();
        let phase_in_period = phase - TAU * revolutions;
        let k = self.panels.partition_point(|p| p.to <= phase_in_period);
        let Some(panel) = self.panels.get(k).or(self.panels.last()) else {
            return [f64::NAN; 2];
        };
        let [value, integral] = panel.eval(phase_in_period);
        [value, TAU * self.mean * revolutions + integral]
    }
}

impl Panel {
    fn new<E>(
        from: f64,
        to: f64,
        integral_before: f64,
        of: &mut impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<Self, E> {
        let n = PANEL_POINTS as f64;
        let node = |j: usize| PI * (j as f64 + 0.5) / n;
        let half = 0.5 * (to - from);
        let mut values = [0.0; PANEL_POINTS];
        for (j, value) in values.iter_mut().enumerate() {
            *value = of(from + half * (1.0 + node(j).cos()))?;
        }
        let coefficient = |k: usize| {
            let terms = values.iter().enumerate();
            let sum: f64 = terms.map(|(j, v)| v * (k as f64 * node(j)).cos()).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / n
        };
        let coefficients: Vec<f64> = (0..PANEL_POINTS).map(coefficient).collect();
        let last = coefficients[PANEL_POINTS - 3..].iter();
        let tail = last.fold(0.0_f64, |max, c| max.max(c.abs()));
        // ∫ T_k = (T_{k+1}/(k+1) − T_{k−1}/(k−1))/2, and T₀ counts twice in the sum.
        let get = |k: usize| coefficients.get(k).copied().unwrap_or(0.0);
        let mut integral_coefficients: Vec<f64> = (0..=PANEL_POINTS)
            .map(|k| match k {
                0 => 0.0,
                1 => half * (get(0) - 0.5 * get(2)),
                k => half * (get(k - 1) - get(k + 1)) / (2.0 * k as f64),
            })
            .collect();
        let at_start: f64 = integral_coefficients
            .iter()
            .enumerate()
            .map(|(k, c)| if k % 2 == 0 { *c } else { -c })
            .sum();
        integral_coefficients[0] = -at_start;
        Ok(Self {
            from,
            to,
            integral_before,
            coefficients,
            integral_coefficients,
            tail,
        })
    }

    /// The integral over the panel.
    fn total_integral(&self) -> f64 {
        self.integral_coefficients.iter().sum()
    }

    fn is_resolved(&self) -> bool {
        if !self.coefficients.iter().all(|c| c.is_finite()) {
            return false;
        }
        let largest = self
            .coefficients
            .iter()
            .fold(0.0_f64, |m, c| m.max(c.abs()));
        let sum = |of: &[f64]| of.iter().map(|c| c.abs()).sum::<f64>();
        let third = PANEL_POINTS / 3;
        let [middle, last] = [third..2 * third, 2 * third..PANEL_POINTS];
        let is_flat = sum(&self.coefficients[last]) > FLATNESS * sum(&self.coefficients[middle]);
        self.tail <= COEFFICIENT_ROUNDING * largest || (self.tail < NOISY_TAIL * largest && is_flat)
    }

    /// Whether the series agrees with the function at the ends: a peak there is beyond the outermost points.
    fn holds_at_ends<E>(&self, of: &mut impl FnMut(f64) -> Result<f64, E>) -> Result<bool, E> {
        let largest = self.coefficients.iter().map(|c| c.abs()).sum::<f64>();
        let allowed = (END_TAILS * self.tail).max(END_ERROR * largest);
        for end in [self.from, self.to] {
            let error = (of(end)? - self.eval(end)[0]).abs();
            if error > allowed || error.is_nan() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether its last coefficients are rounding errors: then differences between neighbouring points have their size. The tails of a peak
    /// between the points are smooth instead.
    fn is_noise<E>(&self, of: &mut impl FnMut(f64) -> Result<f64, E>) -> Result<bool, E> {
        let largest = self.coefficients.iter().map(|c| c.abs()).sum::<f64>();
        let width = self.to - self.from;
        if self.tail <= SURELY_NOISE * largest || width < PROVEN_WIDTH {
            return Ok(true);
        }
        let mut left_out = |phase| of(phase).map(|value| value - self.eval(phase)[0]);
        let (mut noise, mut missed) = (0.0_f64, 0.0_f64);
        for k in 1..NOISE_POINTS {
            let phase = self.from + width * k as f64 / NOISE_POINTS as f64;
            let [here, there] = [left_out(phase)?, left_out(phase + NEIGHBOUR * width)?];
            noise = noise.max((there - here).abs());
            missed = missed.max(here.abs());
        }
        Ok(noise >= NOISE_PART * self.tail && missed <= END_TAILS * self.tail)
    }

    fn eval(&self, phase: f64) -> [f64; 2] {
        let x = (2.0 * phase - self.from - self.to) / (self.to - self.from);
        [
            eval_chebyshev(&self.coefficients, x),
            self.integral_before + eval_chebyshev(&self.integral_coefficients, x),
        ]
    }
}

/// Σ c_k T_k(x), by Clenshaw's recurrence.
fn eval_chebyshev(coefficients: &[f64], x: f64) -> f64 {
    let (mut b, mut below) = (0.0, 0.0);
    for &c in coefficients.iter().skip(1).rev() {
        (b, below) = (2.0 * x * b - below + c, b);
    }
    x * b - below + coefficients.first().copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ ds / (1 − c cos s) = 2π/√(1 − c²), a peak of width √(1 − c) at s = 0; its integral is
    /// 2/√(1 − c²) atan(√((1 + c)/(1 − c)) tan s/2).
    #[test]
    fn val_peaks_of_any_width() {
        for power in 1..=12 {
            let gap = 10.0_f64.powi(-power);
            let c = 1.0 - gap;
            // 1 − c cos s without cancellation.
            let of = |s: f64| {
                let sine = (0.5 * s).sin();
                Ok::<f64, NotResolved>(1.0 / (gap + 2.0 * c * sine * sine))
            };
            let panels = Panels::new(of).expect("resolved");
            let root = (gap * (2.0 - gap)).sqrt();
            // The cosines at the nodes have rounding errors, and the peak has the width √gap.
            let tolerance = 1e-15 + 4e-16 / gap.sqrt();
            assert!((panels.mean * root - 1.0).abs() < tolerance, "{gap:e}");
            assert!(panels.points < 10_000, "{gap:e}: {}", panels.points);
            for s in [1e-3_f64, 0.4, 3.0] {
                let want = 2.0 / root * (((2.0 - gap) / gap).sqrt() * (0.5 * s).tan()).atan();
                let [value, integral] = panels.eval(s);
                let difference = (integral - want).abs();
                assert!(
                    difference < 4.0 * tolerance * TAU * panels.mean,
                    "{gap:e} {s}"
                );
                let exact = of(s).expect("a value");
                assert!((value / exact - 1.0).abs() < 1e-11, "{gap:e} {s}");
                let [_, shifted] = panels.eval(s + TAU);
                // Whole revolutions do not change the phase.
                let difference = (shifted - integral - TAU * panels.mean).abs();
                assert!(difference < 1e-14 * shifted + 1e-15 * value, "{gap:e} {s}");
            }
        }
    }

    #[test]
    fn what_is_no_function_is_not_resolved() {
        let jumps = |s: f64| Ok::<_, NotResolved>(if s < 1.0 { 1.0 } else { f64::NAN });
        assert!(Panels::new(jumps).is_err());
    }
}
