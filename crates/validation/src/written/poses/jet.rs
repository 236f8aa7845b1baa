//! A number with its first and second derivative in time, written here once more so that nothing of the program's own
//! differentiation judges itself.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Value, first and second derivative in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jet(pub(crate) [f64; 3]);

/// A vector of the plane with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JetVector {
    pub(crate) x: Jet,
    pub(crate) y: Jet,
}

impl Jet {
    /// A number that does not change.
    pub(crate) fn constant(value: f64) -> Self {
        Self([value, 0.0, 0.0])
    }

    /// The value.
    pub(crate) fn value(self) -> f64 {
        self.0[0]
    }

    /// f(u) with the derivatives of f by u: f, f′, f″.
    pub(crate) fn chain(self, [f, f1, f2]: [f64; 3]) -> Self {
        let [_, v, a] = self.0;
        Self([f, f1 * v, f1 * a + f2 * v * v])
    }

    pub(crate) fn sin(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain([s, c, -s])
    }

    pub(crate) fn cos(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain([c, -s, -c])
    }

    pub(crate) fn exp(self) -> Self {
        self.chain([self.value().exp(); 3])
    }

    pub(crate) fn ln(self) -> Self {
        let u = self.value();
        self.chain([u.ln(), 1.0 / u, -1.0 / (u * u)])
    }

    pub(crate) fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain([root, 0.5 / root, -0.25 / (root * root * root)])
    }

    pub(crate) fn atan(self) -> Self {
        let u = self.value();
        let slope = 1.0 / (1.0 + u * u);
        self.chain([u.atan(), slope, -2.0 * u * slope * slope])
    }

    /// The angle of the vector (x, y) with `self` as y.
    pub(crate) fn atan2(self, x: Self) -> Self {
        let square = x * x + self * self;
        // d(angle) = (x dy − y dx)/r², whose numerator and denominator are products of jets up to the first derivative.
        let value = self.value().atan2(x.value());
        let first = (x.0[0] * self.0[1] - self.0[0] * x.0[1]) / square.value();
        let numerator_rate = x.0[0] * self.0[2] - self.0[0] * x.0[2];
        let second = (numerator_rate - first * square.0[1]) / square.value();
        Self([value, first, second])
    }

    /// uᵖ with a constant p.
    pub(crate) fn power(self, p: f64) -> Self {
        let u = self.value();
        let first = if p == 0.0 { 0.0 } else { p * u.powf(p - 1.0) };
        let second = match p {
            0.0 | 1.0 => 0.0,
            _ => p * (p - 1.0) * u.powf(p - 2.0),
        };
        self.chain([u.powf(p), first, second])
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let ([a, a1, a2], [b, b1, b2]) = (self.0, other.0);
        Self([a * b, a1 * b + a * b1, a2 * b + 2.0 * a1 * b1 + a * b2])
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let ([a, a1, a2], [b, b1, b2]) = (self.0, other.0);
        let value = a / b;
        let first = (a1 - value * b1) / b;
        Self([value, first, (a2 - 2.0 * first * b1 - value * b2) / b])
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|d| -d))
    }
}

impl JetVector {
    pub(crate) fn new(x: Jet, y: Jet) -> Self {
        Self { x, y }
    }

    /// A vector that does not change.
    pub(crate) fn constant([x, y]: [f64; 2]) -> Self {
        Self::new(Jet::constant(x), Jet::constant(y))
    }

    /// A vector of a frame, in the plane: rotated by the frame's angle.
    pub(crate) fn rotated([x, y]: [f64; 2], angle: Jet) -> Self {
        let (s, c) = (angle.sin(), angle.cos());
        let [x, y] = [x, y].map(Jet::constant);
        Self::new(c * x - s * y, s * x + c * y)
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }

    pub(crate) fn minus(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }

    pub(crate) fn dot(self, other: Self) -> Jet {
        self.x * other.x + self.y * other.y
    }

    pub(crate) fn cross(self, other: Self) -> Jet {
        self.x * other.y - self.y * other.x
    }

    /// Turned by +90°.
    pub(crate) fn normal(self) -> Self {
        Self::new(-self.y, self.x)
    }

    pub(crate) fn length(self) -> Jet {
        self.dot(self).sqrt()
    }

    /// Position, velocity or acceleration, by the order of the derivative.
    pub(crate) fn order(self, k: usize) -> [f64; 2] {
        [self.x.0[k], self.y.0[k]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against central differences along u = 0.7 + 0.3 t + 0.2 t²: the error of a step of 1e-4 is some 1e-7.
    #[test]
    fn derivatives_agree_with_differences() {
        let at = |t: f64| Jet([0.7 + 0.3 * t + 0.2 * t * t, 0.3 + 0.4 * t, 0.4]);
        let functions: [fn(Jet) -> Jet; 8] = [
            Jet::sin,
            Jet::cos,
            Jet::exp,
            Jet::ln,
            Jet::sqrt,
            Jet::atan,
            |u| u.atan2(u * u + Jet::constant(0.2)),
            |u| u.power(2.5) / (u + Jet::constant(1.0)),
        ];
        for f in functions {
            let h = 1e-4;
            let [low, here, high] = [-h, 0.0, h].map(|t| f(at(t)));
            let first = (high.value() - low.value()) / (2.0 * h);
            let second = (high.value() - 2.0 * here.value() + low.value()) / (h * h);
            assert!((here.0[1] - first).abs() < 1e-7, "{here:?} {first}");
            assert!((here.0[2] - second).abs() < 1e-6, "{here:?} {second}");
        }
    }
}
