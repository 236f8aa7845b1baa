//! A dense LU factorisation that refuses singular matrices: faer's does not report
//! them, it divides by the zero pivot.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{Conj, Mat, Par};

/// The smallest pivot that still counts, relative to the largest. The matrices here are scaled to
/// entries of order one, so a pivot at 1e-12 leaves four digits.
const SMALLEST_PIVOT: f64 = 1e-12;

/// P A = L U.
#[derive(Debug, Clone)]
pub(crate) struct Lu {
    factors: Mat<f64>,
    order: Vec<usize>,
    order_inverse: Vec<usize>,
    /// Whether the determinant is positive.
    positive: bool,
}

impl Lu {
    /// Factors a square matrix; `Err` is the smallest pivot relative to the largest (NaN if the
    /// matrix is not finite).
    ///
    /// Sequential by its arguments, not by faer's global setting: another crate of the program
    /// enables faer's threads, and these matrices are too small for them.
    pub(crate) fn new(mut factors: Mat<f64>) -> Result<Self, f64> {
        let n = factors.nrows();
        if !factors.is_all_finite() {
            return Err(f64::NAN);
        }
        let (mut order, mut order_inverse) = (vec![0; n], vec![0; n]);
        let scratch = factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default());
        let (info, _) = factor::lu_in_place(
            factors.as_mut(),
            &mut order,
            &mut order_inverse,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        );
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        let mut positive = info.transposition_count.is_multiple_of(2);
        for i in 0..n {
            let pivot = factors[(i, i)].abs();
            // A column of zeros was divided by its zero pivot.
            if !pivot.is_finite() {
                return Err(0.0);
            }
            positive ^= factors[(i, i)] < 0.0;
            smallest = smallest.min(pivot);
            largest = largest.max(pivot);
        }
        if n > 0 && smallest <= SMALLEST_PIVOT * largest {
            return Err(smallest / largest.max(f64::MIN_POSITIVE));
        }
        Ok(Self {
            factors,
            order,
            order_inverse,
            positive,
        })
    }

    /// Whether the determinant is positive. It cannot change sign without passing zero, so two
    /// configurations of different sign are on different assembly branches.
    pub(crate) fn positive(&self) -> bool {
        self.positive
    }

    /// Solves for every column of `right`, in place.
    pub(crate) fn solve(&self, right: &mut Mat<f64>) {
        let n = self.factors.nrows();
        let scratch = solve::solve_in_place_scratch::<usize, f64>(n, right.ncols(), Par::Seq);
        solve::solve_in_place_with_conj(
            self.factors.as_ref(),
            self.factors.as_ref(),
            PermRef::new_checked(&self.order, &self.order_inverse, n),
            Conj::No,
            right.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_with_a_zero_in_the_corner() {
        let matrix = Mat::from_fn(2, 2, |i, j| [[0.0, 2.0], [1.0, 3.0]][i][j]);
        let lu = Lu::new(matrix).unwrap();
        assert!(!lu.positive());
        let mut right = Mat::from_fn(2, 1, |i, _| [4.0, 7.0][i]);
        lu.solve(&mut right);
        assert_eq!([right[(0, 0)], right[(1, 0)]], [1.0, 2.0]);
    }

    #[test]
    fn what_cannot_be_solved_is_refused() {
        let tilted = Mat::from_fn(2, 2, |i, j| [[1.0, 2.0], [2.0, 4.0]][i][j]);
        assert!(Lu::new(tilted).unwrap_err() < 1e-15);
        assert_eq!(Lu::new(Mat::zeros(3, 3)).unwrap_err(), 0.0);
        let nan = Mat::from_fn(2, 2, |i, _| if i == 0 { f64::NAN } else { 1.0 });
        assert!(Lu::new(nan).unwrap_err().is_nan());
    }
}
