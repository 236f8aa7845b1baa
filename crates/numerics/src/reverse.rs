//! The reverse sweep of straight-line code: the derivatives of a weighted sum of its outputs by all its inputs, for a few times
//! the cost of the outputs themselves (A. Griewank and A. Walther, Evaluating Derivatives, 2nd ed. 2008, section 3.2).

use crate::real::Real;
use crate::straight_line::{Operand, Operation, OperationKind, StraightLine};

/// Memory of reverse sweeps; it keeps its size from one sweep to the next.
#[derive(Debug, Clone, Default)]
pub struct ReverseSweep<R> {
    /// By operation: its result.
    results: Vec<R>,
    /// By operation: the derivative of the weighted sum by its result.
    adjoints: Vec<R>,
    /// By output: its value.
    outputs: Vec<R>,
    /// By input: the derivative of the weighted sum.
    gradient: Vec<R>,
}

impl<R: Real> ReverseSweep<R> {
    /// The outputs of the last evaluation.
    pub fn outputs(&self) -> &[R] {
        &self.outputs
    }

    /// Evaluates the outputs of some code at its inputs, as [`StraightLine::evaluate`] does, and keeps all results on the way.
    pub fn evaluate(&mut self, code: &StraightLine, inputs: &[R]) -> &[R] {
        code.evaluate_operations(inputs, &mut self.results);
        self.outputs.clear();
        let outputs = code.outputs.iter();
        let outputs = outputs.map(|output| output.value(inputs, &self.results));
        self.outputs.extend(outputs);
        &self.outputs
    }

    /// The derivatives of Σ weight · output by each input, after [`evaluate`](Self::evaluate) of the same code at the same inputs.
    pub fn gradient(&mut self, code: &StraightLine, inputs: &[R], weights: &[R]) -> &[R] {
        let zero = R::of(0.0);
        self.adjoints.clear();
        self.adjoints.resize(code.operations.len(), zero);
        self.gradient.clear();
        self.gradient.resize(inputs.len(), zero);
        for (&output, &weight) in code.outputs.iter().zip(weights) {
            self.add(output, weight);
        }
        for (k, operation) in code.operations.iter().enumerate().rev() {
            self.pull_back(k, operation, inputs);
        }
        &self.gradient
    }

    /// Adds to the derivatives by the operands of an operation, from that by its result r.
    #[inline]
    fn pull_back(&mut self, k: usize, operation: &Operation, inputs: &[R]) {
        let [a, b] = operation.operands;
        let value = |operand: Operand| operand.value(inputs, &self.results);
        let (zero, r, of_r) = (R::of(0.0), self.results[k], self.adjoints[k]);
        match operation.kind {
            OperationKind::Add => {
                self.add(a, of_r);
                self.add(b, of_r);
            }
            OperationKind::Subtract => {
                self.add(a, of_r);
                self.add(b, zero - of_r);
            }
            OperationKind::Multiply => {
                let (of_a, of_b) = (of_r * value(b), of_r * value(a));
                self.add(a, of_a);
                self.add(b, of_b);
            }
            OperationKind::Divide => {
                let of_a = of_r / value(b);
                self.add(a, of_a);
                self.add(b, zero - of_a * r);
            }
            OperationKind::Negate => self.add(a, zero - of_r),
            OperationKind::SquareRoot => self.add(a, of_r * R::of(0.5) / r),
            OperationKind::Sine => self.add(a, of_r * value(a).cos()),
            OperationKind::Cosine => self.add(a, zero - of_r * value(a).sin()),
            OperationKind::Angle => {
                let (y, x) = (value(a), value(b));
                let of_angle = of_r / (x * x + y * y);
                self.add(a, of_angle * x);
                self.add(b, zero - of_angle * y);
            }
        }
    }

    /// Adds to the derivative by an operand.
    fn add(&mut self, operand: Operand, more: R) {
        match operand {
            Operand::Coordinate(k) => self.gradient[k] = self.gradient[k] + more,
            Operand::Result(k) => self.adjoints[k] = self.adjoints[k] + more,
            Operand::Constant(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dual, RecordedNumber, Scalar, record_at};
    use std::convert::Infallible;

    /// Every operation of two inputs.
    fn function<T: Scalar>(x: T, y: T) -> [T; 2] {
        let (sin, cos) = x.sin_cos();
        let root = (x * x + y * y).sqrt();
        [
            sin * y - cos / root + T::from_f64(2.0) * x,
            (y - x).atan2(root) - -(y * y) / (x + root),
        ]
    }

    #[test]
    fn the_sweep_has_the_derivatives_of_dual_numbers() {
        let inputs = [0.7, 1.3];
        let code = record_at(&[inputs.to_vec()], |at: &[RecordedNumber]| {
            Ok::<_, Infallible>(function(at[0], at[1]).to_vec())
        });
        let (code, mut sweep) = (code.expect("code"), ReverseSweep::default());
        let weights = [0.3, -1.7];
        let outputs = sweep.evaluate(&code, &inputs).to_vec();
        assert_eq!(outputs, function(inputs[0], inputs[1]));
        let gradient = sweep.gradient(&code, &inputs, &weights).to_vec();
        for (k, found) in gradient.iter().enumerate() {
            let [x, y] = [0, 1].map(|i| Dual {
                v: inputs[i],
                d: f64::from(u8::from(i == k)),
            });
            let by_duals = function(x, y).into_iter().zip(weights);
            let by_duals = by_duals.map(|(f, w)| w * f.d);
            // Seen: 8.9e-16.
            assert!((by_duals.sum::<f64>() - found).abs() < 1e-14);
        }
    }
}
