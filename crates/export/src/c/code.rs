//! Operations as statements in C, and common parts of headers and sources of one and of several degrees of freedom.

use super::{ACCESS, CWriter};
use crate::identifiers::comment;
use crate::part::Precision;
use dwell_numerics::{Operand, Operation, OperationKind, StraightLine};
use std::fmt::Write as _;

/// The note on calls and memory of the operations of a model.
pub(crate) const CALLED: &str = "No function allocates, recurses or keeps anything between calls. Of the library they call sqrt, sin, cos and atan2 of math.h, each only if it is needed.";
/// The note on compiler options.
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

    /// The operations of a code, and the assignments of its outputs.
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

    /// Assigns the values of the scene to parameters and inputs.
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

    /// A line for each current: `@c@` is its member, `@k@` its place.
    pub(crate) fn each_current(&self, line: &str) -> String {
        let lines = self.currents().into_iter().map(|(_, member, place)| {
            let line = line.replace("@c@", &member);
            line.replace("@k@", &place.to_string())
        });
        lines.collect()
    }

    /// The rates of currents; `velocity` is that of a load.
    pub(crate) fn current_rates(&self, velocity: impl Fn(usize) -> String) -> String {
        let lines = self.currents().into_iter().map(|(load, _, place)| {
            let rate = ACCESS.current_rate(&self.names.loads[load], &velocity(load));
            format!("    rates[{place}] = {rate};\n")
        });
        lines.collect()
    }

    /// The classical Runge–Kutta method of fourth order; `rates` is how many rates there are.
    pub(crate) fn step(&self, rates: &str) -> String {
        let move_current = "    to->@c@ = from->@c@ + h * rates[@k@];\n";
        let add_current = "    add(&s.@c@, &s.carry[@k@], k1[@k@]);\n";
        let own = [
            ("rates", rates.to_owned()),
            ("move_currents", self.each_current(move_current)),
            ("add_currents", self.each_current(add_current)),
        ];
        self.fill(include_str!("step.c"), &own)
    }

    /// Says to compilers which arguments of [`ACCESS`](super::ACCESS) lines do not use.
    pub(crate) fn unused_arguments(&self, lines: &str) -> String {
        let unused = ["in", "s"].into_iter();
        let unused = unused.filter(|name| !lines.contains(&format!("{name}->")));
        unused.map(|name| format!("    (void){name};\n")).collect()
    }
}
