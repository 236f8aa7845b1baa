//! Modes of a summary: eigenvalue, angular frequency, frequency and damping ratio.

use super::characteristic::{Complex, size};
use crate::written::poses::difference::Differences;
use crate::written::poses::stated::result;
use serde_json::Value;
use std::f64::consts::TAU;

/// The eigenvalues under a name, `NAME.eigenvalue.K.re` and `.im`.
pub(super) fn eigenvalues(summary: &Value, name: &str) -> Vec<Complex> {
    let of = |k: usize, part: &str| result(summary, &format!("{name}.eigenvalue.{k}.{part}"));
    (1..)
        .map_while(|k| Some([of(k, "re")?, of(k, "im")?]))
        .collect()
}

/// Of each mode of a name: |λ| = ω = 2π f, and ζ = −Re λ/|λ|.
pub(super) fn add_modes(to: &mut Differences, summary: &Value, name: &str) {
    let all = eigenvalues(summary, name);
    let largest = all.iter().map(|l| size(*l)).fold(0.0, f64::max);
    for (k, lambda) in all.iter().enumerate() {
        let of = |what: &str| result(summary, &format!("{name}.eigenvalue.{}.{what}", k + 1));
        let compared = [
            ("angular_frequency", 1.0, size(*lambda), largest),
            ("frequency", TAU, size(*lambda), largest),
            ("damping_ratio", size(*lambda), -lambda[0], largest),
        ];
        for (what, factor, expected, scale) in compared {
            if let Some(value) = of(what) {
                to.add(factor * value - expected, scale, "1/s", || {
                    format!("{name}, eigenvalue {}, {what}", k + 1)
                });
            }
        }
    }
}
