//! Eigenvalues of a real matrix: Householder reflections reduce it to Hessenberg form, then double-shift QR steps split off one or two
//! eigenvalues at a time.
//!
//! Source: R. S. Martin, G. Peters, J. H. Wilkinson, *The QR algorithm for real Hessenberg matrices*, Numer. Math. 14 (1970).

use super::Matrix;

/// Maximum number of steps for one or two eigenvalues; two or three are usual.
const MAX_STEPS: usize = 90;
/// Number of steps without convergence after which exceptional shifts are used.
const STEPS_IN_VAIN: usize = 10;

pub(super) fn eigenvalues(matrix: &Matrix) -> Option<Vec<[f64; 2]>> {
    let mut a = matrix.clone();
    reduce(&mut a);
    let mut found = Vec::with_capacity(a.rows);
    let mut shifted = 0.0;
    // The remaining active block ends before this row.
    let mut end = a.rows;
    let mut steps = 0;
    while end > 0 {
        let last = end - 1;
        let first = split(&a, last);
        if first == last {
            found.push([a[(last, last)] + shifted, 0.0]);
            (end, steps) = (last, 0);
        } else if first + 1 == last {
            found.extend(of_two(&a, last).map(|[re, im]| [re + shifted, im]));
            (end, steps) = (first, 0);
        } else {
            steps += 1;
            if steps > MAX_STEPS {
                return None;
            }
            let mut shifts = Shifts::of_corner(&a, last);
            if steps % STEPS_IN_VAIN == 0 {
                shifts = Shifts::others(&mut a, last, &mut shifted);
            }
            step(&mut a, first, last, &shifts);
        }
    }
    Some(found)
}

/// Reflections make all entries below the first subdiagonal zero.
fn reduce(a: &mut Matrix) {
    let n = a.rows;
    for k in 1..n.saturating_sub(1) {
        let length = (k..n).map(|i| a[(i, k - 1)].powi(2)).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        let head = a[(k, k - 1)];
        // The sign that avoids cancellation.
        let alpha = -length.copysign(head);
        let mut v: Vec<f64> = (k..n).map(|i| a[(i, k - 1)]).collect();
        v[0] -= alpha;
        let square: f64 = v.iter().map(|x| x * x).sum();
        for j in 0..n {
            let part = v.iter().enumerate().map(|(i, x)| x * a[(k + i, j)]);
            let part = 2.0 * part.sum::<f64>() / square;
            (0..v.len()).for_each(|i| a[(k + i, j)] -= part * v[i]);
        }
        for i in 0..n {
            let part = v.iter().enumerate().map(|(j, x)| x * a[(i, k + j)]);
            let part = 2.0 * part.sum::<f64>() / square;
            (0..v.len()).for_each(|j| a[(i, k + j)] -= part * v[j]);
        }
        (k + 1..n).for_each(|i| a[(i, k - 1)] = 0.0);
    }
}

/// The first row of the last block that is decoupled from the rows before it.
fn split(a: &Matrix, last: usize) -> usize {
    let is_zero = |k: &usize| {
        let beside = a[(*k - 1, *k - 1)].abs() + a[(*k, *k)].abs();
        let beside = if beside == 0.0 { 1.0 } else { beside };
        a[(*k, *k - 1)].abs() <= f64::EPSILON * beside
    };
    (1..=last).rev().find(is_zero).unwrap_or(0)
}

/// The eigenvalues of the 2 × 2 block that ends with row `last`.
fn of_two(a: &Matrix, last: usize) -> [[f64; 2]; 2] {
    let (x, y) = (a[(last, last)], a[(last - 1, last - 1)]);
    let product = a[(last, last - 1)] * a[(last - 1, last)];
    let half = 0.5 * (y - x);
    let square = half * half + product;
    let root = square.abs().sqrt();
    if square < 0.0 {
        return [[x + half, root], [x + half, -root]];
    }
    let far = half + root.copysign(half);
    let near = if far == 0.0 { far } else { -product / far };
    [[x + far, 0.0], [x + near, 0.0]]
}

/// Two shifts, the eigenvalues of the last 2 × 2 block, given by its diagonal and the product of its other entries.
struct Shifts {
    x: f64,
    y: f64,
    product: f64,
}

impl Shifts {
    fn of_corner(a: &Matrix, last: usize) -> Self {
        Self {
            x: a[(last, last)],
            y: a[(last - 1, last - 1)],
            product: a[(last, last - 1)] * a[(last - 1, last)],
        }
    }

    /// The exceptional shifts of the source, which end cycles; the diagonal is shifted, too.
    fn others(a: &mut Matrix, last: usize, shifted: &mut f64) -> Self {
        let by = a[(last, last)];
        *shifted += by;
        (0..=last).for_each(|i| a[(i, i)] -= by);
        let size = a[(last, last - 1)].abs() + a[(last - 1, last - 2)].abs();
        Self {
            x: 0.75 * size,
            y: 0.75 * size,
            product: -0.4375 * size * size,
        }
    }

    /// The first column of the shifted square from row `m` on.
    fn column(&self, a: &Matrix, m: usize) -> [f64; 3] {
        let z = a[(m, m)];
        let (r, s) = (self.x - z, self.y - z);
        let column = [
            (r * s - self.product) / a[(m + 1, m)] + a[(m, m + 1)],
            a[(m + 1, m + 1)] - z - r - s,
            a[(m + 2, m + 1)],
        ];
        let size = column.iter().map(|c| c.abs()).sum::<f64>();
        column.map(|c| if size > 0.0 { c / size } else { c })
    }
}

/// A step with two shifts on the rows from `first` to `last`.
fn step(a: &mut Matrix, first: usize, last: usize, shifts: &Shifts) {
    // The step may start at a row that two small entries decouple from the rows before it.
    let mut begin = last - 2;
    let mut column = shifts.column(a, begin);
    while begin > first {
        let [p, q, r] = column.map(f64::abs);
        let above = a[(begin - 1, begin - 1)].abs() + a[(begin, begin)].abs();
        let size = p * (above + a[(begin + 1, begin + 1)].abs());
        if a[(begin, begin - 1)].abs() * (q + r) <= f64::EPSILON * size {
            break;
        }
        begin -= 1;
        column = shifts.column(a, begin);
    }
    for i in begin + 2..=last {
        a[(i, i - 2)] = 0.0;
        if i > begin + 2 {
            a[(i, i - 3)] = 0.0;
        }
    }
    for k in begin..last {
        let rows = (last + 1 - k).min(3);
        let mut size = 1.0;
        if k > begin {
            column = [0.0; 3];
            (0..rows).for_each(|i| column[i] = a[(k + i, k - 1)]);
            size = column.iter().map(|c| c.abs()).sum();
            if size == 0.0 {
                continue;
            }
            column = column.map(|c| c / size);
        }
        let norm = column.iter().map(|c| c * c).sum::<f64>().sqrt();
        let length = norm.copysign(column[0]);
        if length == 0.0 {
            continue;
        }
        if k > begin {
            a[(k, k - 1)] = -length * size;
        } else if first < begin {
            a[(k, k - 1)] = -a[(k, k - 1)];
        }
        let reflection = Reflection {
            k,
            rows,
            column,
            length,
        };
        reflection.apply(a, first, last);
    }
}

/// The reflection that makes all entries but the first of a column of two or three `rows` from row `k` on zero.
struct Reflection {
    k: usize,
    rows: usize,
    column: [f64; 3],
    /// Length of the column, with the sign of its first entry.
    length: f64,
}

impl Reflection {
    /// Applies it to the active rows and columns from `first` to `last`.
    fn apply(&self, a: &mut Matrix, first: usize, last: usize) {
        let Self {
            k,
            rows,
            column,
            length,
        } = *self;
        let head = column[0] + length;
        let of_rows = [head / length, column[1] / length, column[2] / length];
        let others = [1.0, column[1] / head, column[2] / head];
        for j in k..=last {
            let part: f64 = (0..rows).map(|i| others[i] * a[(k + i, j)]).sum();
            (0..rows).for_each(|i| a[(k + i, j)] -= part * of_rows[i]);
        }
        for i in first..=(k + 3).min(last) {
            let part: f64 = (0..rows).map(|j| of_rows[j] * a[(i, k + j)]).sum();
            (0..rows).for_each(|j| a[(i, k + j)] -= part * others[j]);
        }
    }
}
