//! Operations as statements in C, and what headers and sources of one and of several degrees of freedom share.

use super::CWriter;
use crate::identifiers::comment;
use crate::part::Precision;
use crate::straight_line::{Operand, Operation, OperationKind, StraightLine};
use std::fmt::Write as _;

/// What the operations of a model need.
pub(crate) const CALLED: &str = "No function allocates, recurses or keeps anything between calls. Of the library they call sqrt, sin, cos and atan2 of math.h, each only if it is needed.";
/// A member of the terms of motion.
pub(crate) const POTENTIALS: &str = "    @p@_real v[@U@_LOAD_COUNT]; /* potential of one unit of each conservative load; 0 of others */\n";
/// What a compiler must not do.
pub(crate) const COMPILE: &str = "Compile without -ffast-math and with doubles that stay doubles: the sums of a step carry their rounding.";

impl<E> CWriter<'_, E> {
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
        if !code
            .operands()
            .any(|operand| matches!(operand, Operand::Coordinate(_)))
        {
            *text += "    (void)q;\n";
        }
    }

    /// The operations of a code, and what its outputs are assigned to.
    pub(crate) fn assignments(
        &self,
        code: &StraightLine,
        targets: impl Iterator<Item = String>,
    ) -> String {
        let mut text = String::new();
        self.operations(code, &mut text);
        for (target, &output) in targets.zip(&code.outputs) {
            _ = writeln!(text, "    {target} = {};", self.operand(output));
        }
        text
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
        let [a, b] = operation.operands.map(|o| self.operand(o));
        let float = match self.precision {
            Precision::Double => "",
            Precision::Float => "f",
        };
        match operation.kind {
            OperationKind::Add => format!("{a} + {b}"),
            OperationKind::Subtract => format!("{a} - {b}"),
            OperationKind::Multiply => format!("{a} * {b}"),
            OperationKind::Divide => format!("{a} / {b}"),
            OperationKind::Negate => format!("-{a}"),
            OperationKind::SquareRoot => format!("sqrt{float}({a})"),
            OperationKind::Sine => format!("sin{float}({a})"),
            OperationKind::Cosine => format!("cos{float}({a})"),
            OperationKind::Angle => format!("atan2{float}({a}, {b})"),
        }
    }

    /// The numbers that the code computes in.
    pub(crate) fn real(&self) -> &'static str {
        match self.precision {
            Precision::Double => "double",
            Precision::Float => "float",
        }
    }

    /// Lines as a comment.
    pub(crate) fn banner(&self, lines: &[String]) -> String {
        let lines = lines.iter().map(|line| comment(line));
        let lines: String = lines
            .map(|line| format!(" * {}\n", line.trim_end()))
            .collect();
        format!("/*\n{lines} */\n")
    }

    /// The indices of what there are several of, and how many there are.
    pub(crate) fn count(&self, what: &str, list: &[[String; 2]], text: &mut String) {
        for (k, [name, meaning]) in list.iter().enumerate() {
            _ = writeln!(text, "#define @U@_{what}_{name} {k} /* {meaning} */");
        }
        _ = writeln!(text, "#define @U@_{what}_COUNT {}", list.len());
    }

    /// The types of parameters and inputs; `first` is a parameter before the others.
    pub(crate) fn constant_types(&self, first: Option<(&str, &str)>, text: &mut String) {
        *text += "/* Constants of the machine that may be changed. */\ntypedef struct {\n";
        if let Some((name, meaning)) = first {
            member(text, name, meaning);
        }
        for (name, _, meaning) in self.parameters() {
            member(text, &name, &meaning);
        }
        *text += "} @p@_parameters;\n\n/* What acts on it from outside; constant during a step. */\ntypedef struct {\n";
        let inputs = self.inputs();
        for (name, _, meaning) in &inputs {
            member(text, name, meaning);
        }
        if inputs.is_empty() {
            member(text, "none", "there is no input");
        }
        *text += "} @p@_inputs;\n\n";
    }

    /// The last members of a state: currents, and what its sums have lost.
    pub(crate) fn state_end(&self, text: &mut String) {
        for (_, name, _) in self.currents() {
            member(text, &name, "A: current of the motor");
        }
        let carry = format!("carry[{}]", self.order());
        member(text, &carry, "what the sums have lost by rounding");
    }

    /// Assigns what the scene has to parameters and inputs.
    pub(crate) fn assign_constants(&self, text: &mut String) {
        for (name, value, _) in self.parameters() {
            _ = writeln!(text, "    parameters->{name} = {};", self.number(value));
        }
        let inputs = self.inputs();
        for (name, value, _) in &inputs {
            _ = writeln!(text, "    inputs->{name} = {};", self.number(*value));
        }
        if inputs.is_empty() {
            *text += "    inputs->none = ZERO;\n";
        }
    }

    /// Adds the potentials of the loads to the second of the energies.
    pub(crate) fn potentials(&self) -> String {
        let line = |k| format!("    energies[1] = energies[1] + f.f[{k}] * terms.v[{k}];\n");
        self.conservative().map(line).collect()
    }

    /// Says to compilers which arguments of [`ACCESS`](super::ACCESS) lines do not use.
    pub(crate) fn unused_arguments(&self, lines: &str) -> String {
        let unused = ["in", "s"].into_iter();
        let unused = unused.filter(|name| !lines.contains(&format!("{name}->")));
        unused.map(|name| format!("    (void){name};\n")).collect()
    }
}

/// A member of a structure.
pub(crate) fn member(text: &mut String, name: &str, meaning: &str) {
    _ = writeln!(text, "    @p@_real {name}; /* {} */", comment(meaning));
}
