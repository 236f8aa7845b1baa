//! Numbers with three derivatives, which a tape propagates exactly.

use super::function::{Binary, Unary, power, sign};

/// A number type in which a tape can be evaluated.
pub(crate) trait TapeScalar: Copy {
    fn constant(value: f64) -> Self;
    fn value(self) -> f64;
    fn negate(self) -> Self;
    fn unary(self, function: Unary) -> Self;
    fn binary(self, operation: Binary, other: Self) -> Self;
}

impl TapeScalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn negate(self) -> Self {
        -self
    }

    fn unary(self, function: Unary) -> Self {
        function.value(self)
    }

    fn binary(self, operation: Binary, other: Self) -> Self {
        operation.value(self, other)
    }
}

/// A value and its first three derivatives with respect to one variable. The value has the bits of an
/// evaluation in `f64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jet {
    entries: [f64; 4],
    /// Whether it depends on the variable. Zero derivatives do not decide this:
    /// those of x⁴ at 0 are zero, those of its root are not.
    is_active: bool,
}

impl Jet {
    /// The variable itself.
    pub(super) fn variable(value: f64) -> Self {
        Self::active([value, 1.0, 0.0, 0.0])
    }

    /// A variable with its value and rate; without a rate it is constant.
    pub(crate) fn moving(variable: Option<[f64; 2]>) -> Self {
        match variable {
            Some([value, 0.0]) => Self::constant(value),
            Some([value, rate]) => Self::active([value, rate, 0.0, 0.0]),
            None => Self::constant(f64::NAN),
        }
    }

    fn active(entries: [f64; 4]) -> Self {
        Self {
            entries,
            is_active: true,
        }
    }

    /// The value and its derivatives; all NaN if the value is.
    pub(crate) fn derivatives(self) -> [f64; 4] {
        if self.entries[0].is_nan() {
            [f64::NAN; 4]
        } else {
            self.entries
        }
    }

    /// f(self) by the chain rule, from f and its first three derivatives there.
    fn chain(self, f: [f64; 4]) -> Self {
        let [_, u1, u2, u3] = self.entries;
        Self::active([
            f[0],
            f[1] * u1,
            f[2] * u1 * u1 + f[1] * u2,
            f[3] * u1 * u1 * u1 + 3.0 * f[2] * u1 * u2 + f[1] * u3,
        ])
    }

    /// Its derivative as a jet, with its last entry unknown.
    fn derivative(self) -> Self {
        let [_, a1, a2, a3] = self.entries;
        Self {
            entries: [a1, a2, a3, f64::NAN],
            ..self
        }
    }

    /// |self|. Where the value is zero, the first non-zero derivative decides: an odd one changes the
    /// sign, and the derivatives are the mean of both sides, 0; an even one does not.
    fn abs(self) -> Self {
        let leading = self.entries.iter().position(|&d| d != 0.0);
        let sign = match leading {
            Some(k) if k % 2 == 0 => sign(self.entries[k]),
            _ => 0.0,
        };
        let mut entries = self.entries.map(|d| sign * d);
        entries[0] = self.entries[0].abs();
        Self { entries, ..self }
    }

    fn multiply(self, other: Self) -> Self {
        let [a, b] = [self.entries, other.entries];
        Self::active([
            a[0] * b[0],
            a[1] * b[0] + a[0] * b[1],
            a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2],
            a[3] * b[0] + 3.0 * (a[2] * b[1] + a[1] * b[2]) + a[0] * b[3],
        ])
    }

    /// The product rule for (self/other) · other, solved for one derivative after the other.
    fn divide(self, other: Self) -> Self {
        let [a, b] = [self.entries, other.entries];
        let q = a[0] / b[0];
        let q1 = (a[1] - q * b[1]) / b[0];
        let q2 = (a[2] - 2.0 * q1 * b[1] - q * b[2]) / b[0];
        let q3 = (a[3] - 3.0 * (q2 * b[1] + q1 * b[2]) - q * b[3]) / b[0];
        Self::active([q, q1, q2, q3])
    }

    /// A constant exponent needs no logarithm: the base may have any sign, and the derivatives of an integer
    /// power are exact at 0, too.
    fn power(self, exponent: Self) -> Self {
        let [x, n] = [self.entries[0], exponent.entries[0]];
        let value = power(x, n);
        if !exponent.is_active {
            let falling = [n, n * (n - 1.0), n * (n - 1.0) * (n - 2.0)];
            let derivative = |k: usize, less: f64| match falling[k] {
                0.0 => 0.0,
                factor => factor * power(x, n - less),
            };
            let [d1, d2, d3] = [derivative(0, 1.0), derivative(1, 2.0), derivative(2, 3.0)];
            return self.chain([value, d1, d2, d3]);
        }
        if !self.is_active && x == 0.0 && n > 0.0 {
            return exponent.chain([value, 0.0, 0.0, 0.0]);
        }
        // exp(n ln x), whose derivatives are undefined unless x > 0.
        let logarithm = if x > 0.0 {
            self.unary(Unary::Ln)
        } else {
            Self::active([f64::NAN; 4])
        };
        let [_, d1, d2, d3] = exponent.multiply(logarithm).chain([value; 4]).entries;
        Self::active([value, d1, d2, d3])
    }

    /// θ′ = (x y′ − y x′)/(x² + y²), with both arguments divided by their present hypotenuse so
    /// that no square overflows.
    fn atan2(self, other: Self) -> Self {
        let value = Binary::Atan2.value(self.entries[0], other.entries[0]);
        let [y, x] = Self::over_hypotenuse(self, other);
        let numerator = x.multiply(y.derivative()).minus(y.multiply(x.derivative()));
        let [d1, d2, d3, _] = numerator.divide(x.multiply(x).plus(y.multiply(y))).entries;
        Self::active([value, d1, d2, d3])
    }

    /// From h h′ = x x′ + y y′, h² and the derivatives of both sides.
    fn hypot(self, other: Self) -> Self {
        let h = Binary::Hypot.value(self.entries[0], other.entries[0]);
        let [x, y] = Self::over_hypotenuse(self, other);
        let [n, n1, n2, _] = x
            .multiply(x.derivative())
            .plus(y.multiply(y.derivative()))
            .entries;
        // With h scaled to 1.
        let h1 = n;
        let h2 = n1 - h1 * h1;
        let h3 = n2 - 3.0 * h1 * h2;
        Self::active([h, h * h1, h * h2, h * h3])
    }

    fn over_hypotenuse(a: Self, b: Self) -> [Self; 2] {
        let h = a.entries[0].hypot(b.entries[0]);
        [a, b].map(|jet| Self {
            entries: jet.entries.map(|d| d / h),
            ..jet
        })
    }

    fn plus(self, other: Self) -> Self {
        Self::active(std::array::from_fn(|k| self.entries[k] + other.entries[k]))
    }

    fn minus(self, other: Self) -> Self {
        Self::active(std::array::from_fn(|k| self.entries[k] - other.entries[k]))
    }
}

impl TapeScalar for Jet {
    fn constant(value: f64) -> Self {
        Self {
            entries: [value, 0.0, 0.0, 0.0],
            is_active: false,
        }
    }

    fn value(self) -> f64 {
        self.entries[0]
    }

    fn negate(self) -> Self {
        Self {
            entries: self.entries.map(|d| -d),
            ..self
        }
    }

    fn unary(self, function: Unary) -> Self {
        let value = function.value(self.entries[0]);
        if !self.is_active {
            return Self::constant(value);
        }
        match function.derivatives(self.entries[0], value) {
            Some([d1, d2, d3]) => self.chain([value, d1, d2, d3]),
            None if function == Unary::Abs => self.abs(),
            None => Self::constant(value),
        }
    }

    fn binary(self, operation: Binary, other: Self) -> Self {
        if !(self.is_active || other.is_active) {
            return Self::constant(operation.value(self.entries[0], other.entries[0]));
        }
        match operation {
            Binary::Add => self.plus(other),
            Binary::Subtract => self.minus(other),
            Binary::Multiply => self.multiply(other),
            Binary::Divide => self.divide(other),
            Binary::Power => self.power(other),
            Binary::Atan2 => self.atan2(other),
            Binary::Hypot => self.hypot(other),
            Binary::Min | Binary::Max
                if operation.selects_first(self.entries[0], other.entries[0]) =>
            {
                self
            }
            Binary::Min | Binary::Max => other,
        }
    }
}
