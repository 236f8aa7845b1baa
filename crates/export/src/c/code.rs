//! Operations as statements in C.

use super::CWriter;
use crate::machine::PartKind;
use crate::part::Precision;
use crate::straight_line::{Operand, Operation, StraightLine};
use std::fmt::Write as _;

impl CWriter<'_> {
    /// The operations of a part, of an exact export.
    pub(super) fn code(&self, kind: PartKind) -> Option<&StraightLine> {
        Some(&self.export.code.as_ref()?[kind as usize])
    }

    /// One statement for each operation.
    pub(super) fn operations(&self, code: &StraightLine, text: &mut String) {
        self.statements().operations(code, text);
    }

    /// An operand, or an output.
    pub(super) fn operand(&self, operand: Operand) -> String {
        self.statements().operand(operand)
    }

    pub(super) fn statements(&self) -> Statements {
        Statements {
            precision: self.export.request.precision,
            coordinate: |_| "q".to_owned(),
        }
    }
}

/// How numbers and coordinates are written.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Statements {
    pub(crate) precision: Precision,
    /// A coordinate by its place.
    pub(crate) coordinate: fn(usize) -> String,
}

impl Statements {
    /// A number of the exported kind.
    pub(crate) fn number(&self, value: f64) -> String {
        match self.precision {
            Precision::Double => format!("{value:e}"),
            Precision::Float => format!("{:e}f", value as f32),
        }
    }

    /// One statement for each operation.
    pub(crate) fn operations(&self, code: &StraightLine, text: &mut String) {
        for (k, operation) in code.operations.iter().enumerate() {
            let value = self.operation(operation);
            _ = writeln!(text, "    const @p@_real v{k} = {value};");
        }
        let uses = |operand: &Operand| matches!(operand, Operand::Coordinate(_));
        let mut operands = code.operations.iter().flat_map(Operation::operands);
        if !operands.any(|o| uses(&o)) && !code.outputs.iter().any(uses) {
            *text += "    (void)q;\n";
        }
    }

    /// An operand, or an output.
    pub(crate) fn operand(&self, operand: Operand) -> String {
        match operand {
            Operand::Coordinate(k) => (self.coordinate)(k),
            // In brackets: the second of a difference may be negative.
            Operand::Constant(value) if value < 0.0 => format!("({})", self.number(value)),
            Operand::Constant(value) => self.number(value),
            Operand::Result(k) => format!("v{k}"),
        }
    }

    fn operation(&self, operation: &Operation) -> String {
        let [a, b] = operation.operands().map(|o| self.operand(o));
        let float = match self.precision {
            Precision::Double => "",
            Precision::Float => "f",
        };
        match operation {
            Operation::Add(..) => format!("{a} + {b}"),
            Operation::Subtract(..) => format!("{a} - {b}"),
            Operation::Multiply(..) => format!("{a} * {b}"),
            Operation::Divide(..) => format!("{a} / {b}"),
            Operation::Negate(_) => format!("-{a}"),
            Operation::SquareRoot(_) => format!("sqrt{float}({a})"),
            Operation::Sine(_) => format!("sin{float}({a})"),
            Operation::Cosine(_) => format!("cos{float}({a})"),
            Operation::Angle(..) => format!("atan2{float}({a}, {b})"),
        }
    }
}
