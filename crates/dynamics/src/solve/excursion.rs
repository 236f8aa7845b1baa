//! Where a function, known at points of a step, may have a minimum between two of them: a value may be passed there,
//! and passed again, although both neighbours are on one side.

/// Points of the polynomial.
const POINTS: usize = 5;
/// A minimum within this part of the change over the points may pass the value: the polynomial errs by less.
const NEAR: f64 = 0.1;
/// Derivatives at the equally spaced points of a polynomial of fourth degree, times twelve.
const DERIVATIVES: [[f64; POINTS]; POINTS] = [
    [-25.0, 48.0, -36.0, 16.0, -3.0],
    [-3.0, -10.0, 18.0, -6.0, 1.0],
    [1.0, -8.0, 0.0, 8.0, -1.0],
    [-1.0, 6.0, -18.0, 10.0, 3.0],
    [3.0, -16.0, 36.0, -48.0, 25.0],
];

/// Whether a function, known by its `value` at `count` equally spaced points (five or more), may come to zero from above
/// between point `k` and the next, and rise again.
pub(super) fn may_dip(value: impl Fn(usize) -> f64, count: usize, k: usize) -> bool {
    let Some(last_window) = count.checked_sub(POINTS) else {
        return false;
    };
    let first = k.saturating_sub(1).min(last_window);
    let window: [f64; POINTS] = std::array::from_fn(|i| value(first + i));
    let j = k - first;
    let slope = |at: usize| {
        let terms = DERIVATIVES[at].iter().zip(&window);
        terms.map(|(c, v)| c * v).sum::<f64>() / 12.0
    };
    let [falls, rises] = [slope(j), slope(j + 1)];
    let [low, high] = window
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| {
            [l.min(*v), h.max(*v)]
        });
    let spread = high - low;
    // A minimum at a point itself has a slope of zero there, but for the error of the polynomial.
    let flat = 1e-3 * spread;
    if falls > flat || rises < -flat {
        return false;
    }
    // Between two slopes, a parabola.
    let change = rises - falls;
    let depth = if change > 0.0 {
        0.5 * falls * falls / change
    } else {
        0.0
    };
    window[j].min(window[j + 1]).min(window[j] - depth) <= NEAR * spread
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_comes_near_may_dip() {
        let sampled = |lift: f64, shift: f64| -> Vec<f64> {
            let at = |i: i32| 1.0 + lift + (f64::from(i) * 0.2 + shift).cos();
            (0..9).map(at).collect()
        };
        // The minimum is between the points 3 and 4.
        let near = sampled(-1e-9, std::f64::consts::PI - 0.7);
        let found: Vec<bool> = (0..8).map(|k| may_dip(|i| near[i], 9, k)).collect();
        let only = |wanted: usize| (0..8).map(|k| k == wanted).collect::<Vec<_>>();
        assert_eq!(found, only(3));
        let far = sampled(0.2, std::f64::consts::PI - 0.7);
        assert!((0..8).all(|k| !may_dip(|i| far[i], 9, k)));
        // At a point, it is in one of its neighbours.
        let at_point = sampled(0.0, std::f64::consts::PI - 0.8);
        let dips = |k: usize| may_dip(|i| at_point[i], 9, k);
        assert!(dips(3) || dips(4));
    }
}
