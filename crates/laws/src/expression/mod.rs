//! Expressions of named variables.
//!
//! # Language
//! - Numbers: `2`, `0.5`, `.5`, `1e-3`, `1.5E+2`. There are no units: everything is SI.
//! - Operators, by increasing precedence: `+ -`, `* /`, the sign `-x`, `^`. Operators of equal precedence associate to the
//!   left, powers to the right: `2^3^2` is 2⁹, `-x^2` is −(x²), `2^-x` is 2⁻ˣ.
//! - Names: letters, digits, `_` and `.`, not beginning with a digit or a point: `phi.velocity`. Any
//!   other name stands between backticks: `` `my-body.angle` ``, since `my-body` is a difference.
//! - Constants: `pi`, and `tau` = 2π; a variable of the same name takes precedence. Euler's number is
//!   `exp(1)`, because `e` is a likely name of a variable.
//! - Functions: `sin cos tan asin acos atan sinh cosh tanh exp ln log10 sqrt abs sign floor step`
//!   of x; `atan2(y, x)`, `hypot(x, y)`, `min(a, b)`, `max(a, b)`; `clamp(x, low, high)`, which is
//!   `min(max(x, low), high)`; `if(a < b, x, y)`, also with `<=`, `>`, `>=`. `sign(0)` is 0;
//!   `step(x)` is 0 for x < 0 and else 1.
//!
//! # Derivatives
//! Derivatives are exact (Taylor arithmetic; A. Griewank, A. Walther, *Evaluating Derivatives*, chapter
//! 13), up to the third. Where a function is not differentiable, they are defined as follows. Those of `sign`, `floor`
//! and `step` are 0 everywhere. Those of `abs` at a change of sign are the mean of both sides, 0.
//! `min` and `max` follow the selected argument, on a tie the first. `if` follows the
//! selected branch. Otherwise derivatives are NaN or infinite: of `sqrt(x)` at 0, of `hypot` and `atan2` at the
//! origin, of a power with a variable exponent and a base that is not positive. `min`, `max`, `clamp`, `step` and
//! comparisons never hide a NaN.

mod error;
mod function;
mod jet;
mod parse;
mod rounded;
mod tape;
mod token;

pub use error::{ExpressionError, nearest};
pub(crate) use function::{Binary, Unary, sign};
pub(crate) use jet::{Jet, TapeScalar};
pub(crate) use rounded::Rounded;
pub use tape::HeldPieces;
use tape::Tape;
pub(crate) use tape::{Op, Sides, run_held_parts, run_parts};

/// A parsed expression of named variables. The [module](crate::expression) describes
/// the language.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    tape: Tape,
    /// The variables that occur, in order of first use, and their indices among the given ones.
    names: Vec<String>,
    variable_indices: Vec<usize>,
}

impl Expression {
    /// Parses `text`, in which the names of `variables` may occur.
    ///
    /// # Errors
    /// One error, the first from the left: an unknown name or function, a wrong number of
    /// arguments, a missing operand or operator, an unbalanced parenthesis, an unexpected
    /// character, an empty text, a part without variables that is not finite (`1/0`), too deep a
    /// nesting (about 60 parentheses, or 32 intermediate results at once).
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        let tape = parse::parse(text, variables)?;
        let mut variable_indices = Vec::new();
        let mut seen = vec![false; variables.len()];
        for op in &tape.ops {
            if let Op::Variable(index) = *op
                && !std::mem::replace(&mut seen[index], true)
            {
                variable_indices.push(index);
            }
        }
        let names = variable_indices
            .iter()
            .map(|&i| variables[i].to_owned())
            .collect();
        Ok(Self {
            tape,
            names,
            variable_indices,
        })
    }

    /// The variables that occur, in order of first use.
    pub fn variables(&self) -> &[String] {
        &self.names
    }

    /// The expression as a function of the variables that occur: its values are then those of
    /// [`variables`](Self::variables), in their order.
    pub fn retain_used(mut self) -> Self {
        for op in &mut self.tape.ops {
            if let Op::Variable(index) = op {
                let position = self.variable_indices.iter().position(|i| i == index);
                *index = position.unwrap_or_default();
            }
        }
        self.variable_indices = (0..self.names.len()).collect();
        self
    }

    /// Its operations, operands first.
    pub(crate) fn ops(&self) -> &[Op] {
        &self.tape.ops
    }

    /// The value for `values` of all variables given to [`parse`](Self::parse), in their order. A
    /// variable without a value is NaN.
    pub fn eval(&self, values: &[f64]) -> f64 {
        self.tape.run(|i| value(values, i))
    }

    /// The value, with some operations held on one of their pieces ([`Switches::hold`](crate::Switches::hold)).
    pub fn eval_held(&self, values: &[f64], held: &HeldPieces) -> f64 {
        self.tape.run_held(|i| value(values, i), &held.sides)
    }

    /// [`derivatives_wrt`](Self::derivatives_wrt), with some operations held on one of their pieces.
    pub fn derivatives_held(&self, values: &[f64], variable: usize, held: &HeldPieces) -> [f64; 4] {
        let jet = |i| jet(values, variable, i);
        self.tape.run_held(jet, &held.sides).derivatives()
    }

    /// The value and its first three partial derivatives with respect to the variable with this index in
    /// the list given to [`parse`](Self::parse).
    pub fn derivatives_wrt(&self, values: &[f64], variable: usize) -> [f64; 4] {
        self.tape.run(|i| jet(values, variable, i)).derivatives()
    }
}

fn jet(values: &[f64], variable: usize, i: usize) -> Jet {
    let value = value(values, i);
    if i == variable {
        Jet::variable(value)
    } else {
        Jet::constant(value)
    }
}

fn value(values: &[f64], index: usize) -> f64 {
    values.get(index).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
