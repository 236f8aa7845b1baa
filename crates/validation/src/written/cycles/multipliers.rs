//! The largest Floquet multiplier of a cycle, from the revolutions of a settling motion: the remaining fraction of a deviation after
//! a cycle.

use crate::written::poses::difference::Differences;

/// Deviations of the speed, relative to it, between which the ratio of two successive ones is that of small deviations, and not yet
/// the error of the integration.
const DEVIATIONS: [f64; 2] = [1e-8, 1e-4];

/// A multiplier, real and imaginary part.
pub(super) type Multiplier = [f64; 2];

/// Speeds at successive revolutions against the multipliers of the summary; empty if the largest is not real, or if no two
/// deviations can be compared.
pub(super) fn multiplier_differences(speeds: &[f64], multipliers: &[Multiplier]) -> Differences {
    let mut all = Differences::default();
    let size = |[re, im]: &Multiplier| re.hypot(*im);
    let largest = multipliers
        .iter()
        .max_by(|a, b| size(a).total_cmp(&size(b)));
    let (Some([expected, 0.0]), Some(settled)) = (largest, speeds.last()) else {
        return all;
    };
    let deviations: Vec<f64> = speeds.iter().map(|speed| speed / settled - 1.0).collect();
    let [least, most] = DEVIATIONS;
    let is_between = |d: f64| (least..=most).contains(&d.abs());
    let mut pairs = deviations
        .windows(2)
        .filter(|d| is_between(d[0]) && is_between(d[1]));
    if let Some(pair) = pairs.next_back() {
        let ratio = pair[1] / pair[0];
        // Of the deviation that is left, the integration's error of about 1e-11 is a part.
        all.add(ratio - expected, *expected, "", || {
            format!("deviation {:.1e} after a cycle of {:.1e}", pair[1], pair[0])
        });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Deviations that become a fifth in each cycle.
    #[test]
    fn a_deviation_decays_by_its_multiplier() {
        let speeds: Vec<f64> = (0..20)
            .map(|k| 3.0 * (1.0 + 0.01 * 0.2_f64.powi(k)))
            .collect();
        assert!(multiplier_differences(&speeds, &[[0.01, 0.0], [0.2, 0.0]]).largest() < 1e-4);
        assert!(multiplier_differences(&speeds, &[[0.21, 0.0]]).largest() > 0.04);
        assert_eq!(multiplier_differences(&speeds, &[[0.2, 0.1]]).count(), 0);
    }
}
