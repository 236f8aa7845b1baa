//! A polynomial of time.

/// c₀ + c₁ t + c₂ t² + …, with `coefficients` from the constant upwards: SI units of the quantity
/// divided by s, s², … An empty list is the constant zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polynomial {
    /// The coefficients c₀, c₁, c₂ …
    pub coefficients: Vec<f64>,
}

impl Polynomial {
    /// The constant polynomial.
    pub fn constant(value: f64) -> Self {
        Self {
            coefficients: vec![value],
        }
    }

    /// The motion with the value `q` and the velocity `q_dot` at t = 0 and the constant acceleration
    /// `q_ddot`: q + q̇ t + ½ q̈ t².
    pub fn motion(q: f64, q_dot: f64, q_ddot: f64) -> Self {
        Self {
            coefficients: vec![q, q_dot, 0.5 * q_ddot],
        }
    }

    /// The value and its first three derivatives at time `t`.
    ///
    /// Horner's rule on all sums at once: with p ← p t + c for the value, the k-th derivative
    /// divided by k!, s, obeys s ← s t + (the one before it), each with the old terms.
    pub fn eval(&self, t: f64) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for &c in self.coefficients.iter().rev() {
            for k in (1..4).rev() {
                sums[k] = sums[k] * t + sums[k - 1];
            }
            sums[0] = sums[0] * t + c;
        }
        let mut factorial = 1.0;
        for (k, sum) in (0_u32..).zip(&mut sums) {
            factorial *= f64::from(k.max(1));
            *sum *= factorial;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_starts_with_the_given_values() {
        assert_eq!(
            Polynomial::motion(0.5, -2.0, 3.0).eval(0.0),
            [0.5, -2.0, 3.0, 0.0]
        );
    }

    /// t⁴ − 2 t³ + 5 at t = 3: 81 − 54 + 5, 4·27 − 6·9, 12·9 − 12·3.
    #[test]
    fn derivatives_by_hand() {
        let law = Polynomial {
            coefficients: vec![5.0, 0.0, 0.0, -2.0, 1.0],
        };
        // The third derivative: 24·3 − 12.
        assert_eq!(law.eval(3.0), [32.0, 54.0, 72.0, 60.0]);
    }

    #[test]
    fn constants_and_nothing_at_all() {
        assert_eq!(Polynomial::constant(4.0).eval(-7.0), [4.0, 0.0, 0.0, 0.0]);
        assert_eq!(Polynomial::default().eval(1.0), [0.0; 4]);
    }

    /// An infinite or NaN time is not hidden.
    #[test]
    fn not_a_number_stays_visible() {
        assert!(Polynomial::motion(0.0, 1.0, 0.0).eval(f64::NAN)[0].is_nan());
    }
}
