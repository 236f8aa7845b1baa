//! Convex quadratic programs by the dual active set method of D. Goldfarb and A. Idnani (Mathematical Programming 27, 1983), in the
//! coordinates y = Lᵀ x in which the Hessian L Lᵀ is the identity.

use super::{backward, cholesky, dot, forward};

/// A violation below this part of a limit is rounding.
const ROUNDING: f64 = 1e-12;
/// A normal whose part off the active ones is below this part of it depends on them.
const DEPENDENT: f64 = 1e-10;

/// The program: the least ½ xᵀ H x + gᵀ x with nᵢ·x ≥ bᵢ, or nᵢ·x = bᵢ.
#[derive(Debug, Clone, Copy)]
pub struct QuadraticProgram<'a> {
    /// H, symmetric and positive definite, by row.
    pub hessian: &'a [Vec<f64>],
    /// g.
    pub slope: &'a [f64],
    /// The normals n of the constraints.
    pub normals: &'a [Vec<f64>],
    /// Their limits b.
    pub limits: &'a [f64],
    /// Which of them are equalities.
    pub are_equalities: &'a [bool],
}

/// Its solution.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadraticSolution {
    /// x.
    pub x: Vec<f64>,
    /// The multipliers λ of the constraints: H x + g = Σ λᵢ nᵢ; those of inequalities are not negative, and zero unless nᵢ·x = bᵢ.
    pub multipliers: Vec<f64>,
}

/// The active constraints with the QR factors of their normals.
#[derive(Default)]
struct ActiveSet {
    /// Their numbers, signs and multipliers.
    numbers: Vec<usize>,
    signs: Vec<f64>,
    multipliers: Vec<f64>,
    /// Orthonormal directions.
    basis: Vec<Vec<f64>>,
    /// By active constraint: the components of its normal along these directions.
    triangle: Vec<Vec<f64>>,
}

impl ActiveSet {
    /// The components of a vector along the basis, and the rest.
    fn split(&self, vector: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut rest, mut along) = (vector.to_vec(), vec![0.0; self.basis.len()]);
        // Twice is enough for orthogonality.
        for _ in 0..2 {
            for (sum, direction) in along.iter_mut().zip(&self.basis) {
                let part = dot(direction, &rest);
                *sum += part;
                rest.iter_mut()
                    .zip(direction)
                    .for_each(|(r, d)| *r -= part * d);
            }
        }
        (along, rest)
    }

    /// Solves R r = c: by how much each multiplier falls.
    fn falls(&self, along: &[f64]) -> Vec<f64> {
        let mut r = along.to_vec();
        for k in (0..r.len()).rev() {
            r[k] /= self.triangle[k][k];
            let solved = r[k];
            for (entry, factor) in r[..k].iter_mut().zip(&self.triangle[k]) {
                *entry -= factor * solved;
            }
        }
        r
    }

    fn add(&mut self, number: usize, sign: f64, multiplier: f64, normal: &[f64]) {
        let (mut along, rest) = self.split(normal);
        let length = dot(&rest, &rest).sqrt();
        along.push(length);
        self.basis.push(rest.iter().map(|r| r / length).collect());
        self.triangle.push(along);
        self.numbers.push(number);
        self.signs.push(sign);
        self.multipliers.push(multiplier);
    }

    /// Removes the `k`th constraint, and factors those after it again.
    fn remove(&mut self, k: usize, normals: &[Vec<f64>]) {
        let numbers = self.numbers.split_off(k);
        let (signs, multipliers) = (self.signs.split_off(k), self.multipliers.split_off(k));
        self.basis.truncate(k);
        self.triangle.truncate(k);
        for (i, number) in numbers.into_iter().enumerate().skip(1) {
            let signed: Vec<f64> = normals[number].iter().map(|n| n * signs[i]).collect();
            self.add(number, signs[i], multipliers[i], &signed);
        }
    }
}

impl QuadraticProgram<'_> {
    /// Solves it; `None` if no point satisfies the constraints, or the Hessian is not positive definite.
    // Long because the dual method is one loop in another.
    pub fn solve(&self) -> Option<QuadraticSolution> {
        let l = cholesky(self.hessian)?;
        let transformed = |vector: &Vec<f64>| {
            let mut vector = vector.clone();
            forward(&l, &mut vector);
            vector
        };
        let normals: Vec<Vec<f64>> = self.normals.iter().map(transformed).collect();
        let lengths: Vec<f64> = normals.iter().map(|n| dot(n, n).sqrt()).collect();
        let mut y: Vec<f64> = self.slope.iter().map(|g| -g).collect();
        forward(&l, &mut y);
        let mut active = ActiveSet::default();
        // Equalities that follow from others.
        let mut redundant = Vec::new();
        for _ in 0..20 * (normals.len() + 5) {
            let is_open = |i: usize| !active.numbers.contains(&i) && !redundant.contains(&i);
            let Some((number, sign)) = self.most_violated(&y, &normals, &lengths, &is_open) else {
                backward(&l, &mut y);
                let mut multipliers = vec![0.0; normals.len()];
                for (k, number) in active.numbers.iter().enumerate() {
                    multipliers[*number] = active.multipliers[k] * active.signs[k];
                }
                return Some(QuadraticSolution { x: y, multipliers });
            };
            let normal: Vec<f64> = normals[number].iter().map(|n| n * sign).collect();
            let mut multiplier = 0.0;
            loop {
                let (along, across) = active.split(&normal);
                let falls = active.falls(&along);
                let (open, drop) = self.first_to_vanish(&active, &falls);
                let square = dot(&across, &across);
                let missing = sign * self.limits[number] - dot(&normal, &y);
                let is_free = square.sqrt() > DEPENDENT * lengths[number];
                let full = if is_free {
                    missing / square
                } else {
                    f64::INFINITY
                };
                if !is_free && missing.abs() <= DEPENDENT * (1.0 + self.limits[number].abs()) {
                    redundant.push(number);
                    break;
                }
                let step = open.min(full);
                if !step.is_finite() {
                    return None;
                }
                if is_free {
                    y.iter_mut().zip(&across).for_each(|(y, z)| *y += step * z);
                }
                let each = active.multipliers.iter_mut().zip(&falls);
                each.for_each(|(multiplier, fall)| *multiplier -= step * fall);
                multiplier += step;
                if full <= open {
                    active.add(number, sign, multiplier, &normal);
                    break;
                }
                active.remove(drop, &normals);
            }
        }
        None
    }

    /// An equality that is not active yet, or the inequality that is violated most, with the sign of its normal.
    fn most_violated(
        &self,
        y: &[f64],
        normals: &[Vec<f64>],
        lengths: &[f64],
        is_open: &dyn Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let mut worst = (0.0, None);
        for (i, normal) in normals.iter().enumerate() {
            if !is_open(i) || lengths[i] == 0.0 && self.limits[i] <= 0.0 {
                continue;
            }
            let over = dot(normal, y) - self.limits[i];
            if self.are_equalities[i] {
                return Some((i, if over > 0.0 { -1.0 } else { 1.0 }));
            }
            let violation = -over / lengths[i];
            let rounding = ROUNDING * (1.0 + self.limits[i].abs()) / lengths[i];
            if violation > rounding.max(worst.0) {
                worst = (violation, Some((i, 1.0)));
            }
        }
        worst.1
    }

    /// The step after which the multiplier of an active inequality vanishes, and which.
    fn first_to_vanish(&self, active: &ActiveSet, falls: &[f64]) -> (f64, usize) {
        let mut first = (f64::INFINITY, 0);
        for (k, fall) in falls.iter().enumerate() {
            let step = active.multipliers[k] / fall;
            if !self.are_equalities[active.numbers[k]] && *fall > 0.0 && step < first.0 {
                first = (step, k);
            }
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_active_constraint_has_its_multiplier() {
        // By hand, with x + y = 2 active: 4 x − 2 y + 6 = λ and 4 y − 2 x = λ.
        let program = QuadraticProgram {
            hessian: &[vec![4.0, -2.0], vec![-2.0, 4.0]],
            slope: &[6.0, 0.0],
            normals: &[vec![1.0, 0.0], vec![0.0, 1.0], vec![1.0, 1.0]],
            limits: &[0.0, 0.0, 2.0],
            are_equalities: &[false; 3],
        };
        let found = program.solve().expect("a solution");
        for (found, expected) in found.x.iter().zip([0.5, 1.5]) {
            // Seen: 4e-16.
            assert!((found - expected).abs() < 1e-14);
        }
        for (found, expected) in found.multipliers.iter().zip([0.0, 0.0, 5.0]) {
            // Seen: 2e-15.
            assert!((found - expected).abs() < 1e-13);
        }
    }

    #[test]
    fn contradictory_constraints_have_no_solution() {
        let program = QuadraticProgram {
            hessian: &[vec![1.0]],
            slope: &[0.0],
            normals: &[vec![1.0], vec![-1.0]],
            limits: &[1.0, 0.0],
            are_equalities: &[false; 2],
        };
        assert!(program.solve().is_none());
    }
}
