//! Functions of a phase that are smooth but sharp, such as the slowness of a motion that nearly stops on a
//! summit: Chebyshev series on panels, each halved until its series is resolved. A peak of width w takes some
//! log₂ 1/w panels, where equally spaced points would have to be 1/w in number.

use crate::error::DynamicsError;
use crate::fourier::Series;
use std::f64::consts::{PI, TAU};

/// Points of a panel.
const POINTS: usize = 24;
/// Most panels, and how often one is halved at most.
const MOST: usize = 2048;
const MOST_HALVINGS: u32 = 50;
/// Coefficients below this part of the panel's largest value are rounding.
const NEGLIGIBLE: f64 = 2e-15;
/// Coefficients below this part, of which the last third is not below a quarter of the third before, are
/// rounding too, of values that carry more of it.
const SMALL: f64 = 1e-4;
const FLAT: f64 = 0.25;

/// The time that a motion takes for its phase, dt/ds, s/rad.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Slowness {
    /// By equally spaced points.
    Even(Series),
    /// By points where they are needed.
    Sharp(Panels),
}

impl Slowness {
    /// Its mean over a period.
    pub(crate) fn mean(&self) -> f64 {
        match self {
            Self::Even(series) => series.mean,
            Self::Sharp(panels) => panels.mean,
        }
    }

    /// What its last coefficients leave, as a part of the mean.
    pub(crate) fn left(&self) -> f64 {
        match self {
            Self::Even(series) => series.left,
            Self::Sharp(panels) => panels.left,
        }
    }

    /// Its value and its integral from zero at a phase.
    pub(crate) fn at(&self, phase: f64) -> [f64; 2] {
        match self {
            Self::Even(series) => series.at(phase),
            Self::Sharp(panels) => panels.at(phase),
        }
    }
}

/// A function from phase 0 to 2π.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Panels {
    panels: Vec<Panel>,
    /// Its integral over a period, over 2π.
    pub(crate) mean: f64,
    /// What is left of its integral in the last coefficients of the panels, as a part of it.
    pub(crate) left: f64,
    /// Points at which it was evaluated.
    pub(crate) points: usize,
}

#[derive(Debug, Clone, PartialEq)]
struct Panel {
    from: f64,
    to: f64,
    /// The integral up to `from`.
    before: f64,
    /// Of the function on −1 … 1.
    series: Vec<f64>,
    /// Of its integral there, from `from`.
    integral: Vec<f64>,
    left: f64,
}

impl Panels {
    /// The panels of a function.
    ///
    /// # Errors
    /// [`DynamicsError::NotResolved`], and what the function's evaluation says.
    pub(crate) fn new(
        mut of: impl FnMut(f64) -> Result<f64, DynamicsError>,
    ) -> Result<Self, DynamicsError> {
        let mut found = Self::default();
        // The last is next: the panels come in order.
        let mut open = vec![(0.5 * TAU, TAU, 1), (0.0, 0.5 * TAU, 1)];
        let mut sum = 0.0;
        let mut left = 0.0;
        while let Some((from, to, halvings)) = open.pop() {
            let panel = Panel::new(from, to, sum, &mut of)?;
            found.points += POINTS;
            let done = panel.resolved();
            if !done && (halvings >= MOST_HALVINGS || found.panels.len() + open.len() >= MOST) {
                return Err(DynamicsError::NotResolved {
                    points: found.points,
                    left: panel.left * (to - from) / (sum + panel.whole()),
                });
            }
            if done {
                sum += panel.whole();
                left += panel.left * (to - from);
                found.panels.push(panel);
            } else {
                let middle = 0.5 * (from + to);
                open.push((middle, to, halvings + 1));
                open.push((from, middle, halvings + 1));
            }
        }
        found.mean = sum / TAU;
        found.left = left / sum;
        Ok(found)
    }

    /// Its value and its integral from zero at a phase.
    pub(crate) fn at(&self, phase: f64) -> [f64; 2] {
        let turns = (phase / TAU).floor();
        let within = phase - TAU * turns;
        let k = self.panels.partition_point(|p| p.to <= within);
        let Some(panel) = self.panels.get(k).or(self.panels.last()) else {
            return [f64::NAN; 2];
        };
        let [value, integral] = panel.at(within);
        [value, TAU * self.mean * turns + integral]
    }
}

impl Panel {
    fn new(
        from: f64,
        to: f64,
        before: f64,
        of: &mut impl FnMut(f64) -> Result<f64, DynamicsError>,
    ) -> Result<Self, DynamicsError> {
        let n = POINTS as f64;
        let node = |j: usize| PI * (j as f64 + 0.5) / n;
        let half = 0.5 * (to - from);
        let mut values = [0.0; POINTS];
        for (j, value) in values.iter_mut().enumerate() {
            *value = of(from + half * (1.0 + node(j).cos()))?;
        }
        let coefficient = |k: usize| {
            let terms = values.iter().enumerate();
            let sum: f64 = terms.map(|(j, v)| v * (k as f64 * node(j)).cos()).sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / n
        };
        let series: Vec<f64> = (0..POINTS).map(coefficient).collect();
        let last = series[POINTS - 3..].iter();
        let left = last.fold(0.0_f64, |most, c| most.max(c.abs()));
        // ∫ T_k = (T_{k+1}/(k+1) − T_{k−1}/(k−1))/2, and T₀ counts twice in the sum below it.
        let get = |k: usize| series.get(k).copied().unwrap_or(0.0);
        let mut integral: Vec<f64> = (0..=POINTS)
            .map(|k| match k {
                0 => 0.0,
                1 => half * (get(0) - 0.5 * get(2)),
                k => half * (get(k - 1) - get(k + 1)) / (2.0 * k as f64),
            })
            .collect();
        let at_start: f64 = integral
            .iter()
            .enumerate()
            .map(|(k, c)| if k % 2 == 0 { *c } else { -c })
            .sum();
        integral[0] = -at_start;
        Ok(Self {
            from,
            to,
            before,
            series,
            integral,
            left,
        })
    }

    /// The integral over all of it.
    fn whole(&self) -> f64 {
        self.integral.iter().sum()
    }

    fn resolved(&self) -> bool {
        if !self.series.iter().all(|c| c.is_finite()) {
            return false;
        }
        let largest = self.series.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let sum = |of: &[f64]| of.iter().map(|c| c.abs()).sum::<f64>();
        let third = POINTS / 3;
        let [middle, last] = [third..2 * third, 2 * third..POINTS];
        let flat = sum(&self.series[last]) > FLAT * sum(&self.series[middle]);
        self.left <= NEGLIGIBLE * largest || (self.left < SMALL * largest && flat)
    }

    fn at(&self, phase: f64) -> [f64; 2] {
        let x = (2.0 * phase - self.from - self.to) / (self.to - self.from);
        [
            chebyshev(&self.series, x),
            self.before + chebyshev(&self.integral, x),
        ]
    }
}

/// Σ c_k T_k(x), by Clenshaw's recurrence.
fn chebyshev(coefficients: &[f64], x: f64) -> f64 {
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
            // 1 − c cos s without the difference of equals.
            let of = |s: f64| {
                let sine = (0.5 * s).sin();
                Ok(1.0 / (gap + 2.0 * c * sine * sine))
            };
            let panels = Panels::new(of).expect("resolved");
            let root = (gap * (2.0 - gap)).sqrt();
            // The cosines at the nodes are known to their rounding, at a peak of a width of √gap.
            let tolerance = 1e-15 + 4e-16 / gap.sqrt();
            assert!((panels.mean * root - 1.0).abs() < tolerance, "{gap:e}");
            assert!(panels.points < 10_000, "{gap:e}: {}", panels.points);
            for s in [1e-3_f64, 0.4, 3.0] {
                let want = 2.0 / root * (((2.0 - gap) / gap).sqrt() * (0.5 * s).tan()).atan();
                let [value, integral] = panels.at(s);
                let off = (integral - want).abs();
                assert!(off < 4.0 * tolerance * TAU * panels.mean, "{gap:e} {s}");
                let exact = of(s).expect("a value");
                assert!((value / exact - 1.0).abs() < 1e-11, "{gap:e} {s}");
                let [_, turned] = panels.at(s + TAU);
                // Whole turns round the phase.
                let off = (turned - integral - TAU * panels.mean).abs();
                assert!(off < 1e-14 * turned + 1e-15 * value, "{gap:e} {s}");
            }
        }
    }

    #[test]
    fn what_is_no_function_is_not_resolved() {
        let jumps = |s: f64| Ok(if s < 1.0 { 1.0 } else { f64::NAN });
        let error = Panels::new(jumps);
        assert!(matches!(error, Err(DynamicsError::NotResolved { .. })));
    }
}
