//! Derivatives of results from results of varied scenes, extrapolated to vanishing steps by Neville's rule, from steps that are halved as
//! long as the estimated error falls (C. J. F. Ridders, Advances in Engineering Software 4, 1982, 75).

/// The largest step, as a part of the number's scale, and how often it is halved at most.
pub(super) const STEP: f64 = 4e-3;
const HALVINGS: usize = 10;
/// Halving ends where the error of every result is this many times its least.
const WORSE: f64 = 8.0;

/// A derivative with its estimated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Difference {
    pub(super) slope: f64,
    pub(super) error: f64,
}

/// The extrapolation of one result.
struct Tableau {
    last: Vec<f64>,
    best: Difference,
    is_done: bool,
}

impl Tableau {
    /// Adds the difference with half the last step.
    fn add(&mut self, difference: f64) {
        let mut row = vec![difference];
        let mut factor = 4.0;
        let mut least = f64::INFINITY;
        for k in 0..self.last.len() {
            let next = (factor * row[k] - self.last[k]) / (factor - 1.0);
            factor *= 4.0;
            let error = (next - row[k]).abs().max((next - self.last[k]).abs());
            least = least.min(error);
            if error <= self.best.error {
                self.best = Difference { slope: next, error };
            }
            row.push(next);
        }
        self.is_done |= !self.last.is_empty() && least > WORSE * self.best.error;
        self.last = row;
    }
}

/// The derivative of each of the results by a number, which has a value and a scale; not a number where a result has none.
pub(super) fn difference(
    at: &dyn Fn(f64) -> Vec<f64>,
    results: usize,
    value: f64,
    scale: f64,
) -> Vec<Difference> {
    let open = || Tableau {
        last: Vec::new(),
        best: Difference {
            slope: f64::NAN,
            error: f64::INFINITY,
        },
        is_done: false,
    };
    let mut tableaus: Vec<Tableau> = (0..results).map(|_| open()).collect();
    let mut step = STEP * scale;
    for _ in 0..=HALVINGS {
        let (after, before) = (at(value + step), at(value - step));
        let pairs = after.iter().zip(&before);
        for (tableau, (a, b)) in tableaus.iter_mut().zip(pairs) {
            let difference = (a - b) / (2.0 * step);
            // A wide step may leave the range of a result.
            match difference.is_nan() {
                true => tableau.last.clear(),
                false if !tableau.is_done => tableau.add(difference),
                false => {}
            }
        }
        if tableaus.iter().all(|tableau| tableau.is_done) {
            break;
        }
        step *= 0.5;
    }
    tableaus.into_iter().map(|tableau| tableau.best).collect()
}
