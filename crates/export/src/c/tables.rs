//! The constants of the cells, and the places where functions are found in them.

use super::CWriter;
use crate::export::Export;
use crate::machine::PartKind;
use crate::part::{CURVE, Column, HEAD, Part, TERMS};
use std::fmt::Write as _;

/// The names of the parts in the code.
pub(super) const NAMES: [&str; 3] = ["motion", "reaction", "position"];

impl CWriter<'_, Export> {
    pub(super) fn part(&self, kind: PartKind) -> &Part {
        &self.export.parts[kind as usize]
    }

    /// Whether anything of a part is in cells.
    pub(super) fn has_cells(&self, kind: PartKind) -> bool {
        !self.part(kind).index.is_empty()
    }

    /// The constants of a part, and the function that finds a place in it.
    pub(super) fn tables(&self, kind: PartKind, text: &mut String) {
        if !self.has_cells(kind) {
            return;
        }
        let (part, name) = (self.part(kind), NAMES[kind as usize]);
        let (cells, stride, bins) = (part.cell_count(), part.stride(), part.index.len());
        let index = match part.index_bytes() {
            1 => "uint8_t",
            _ => "uint16_t",
        };
        _ = write!(
            text,
            "/* {cells} cells of {stride} numbers: middle, 2/width, width, then coefficients by rising powers. */\nstatic const @p@_real {name}_cells[{}] = {{",
            part.cells.len()
        );
        for (k, &number) in part.cells.iter().enumerate() {
            let separator = match k % stride {
                0 => "\n    ",
                k if k % 6 == 3 => "\n        ",
                _ => " ",
            };
            _ = write!(text, "{separator}{},", self.number(number));
        }
        _ = write!(
            text,
            "\n}};\n\n/* By bin: its cell. */\nstatic const {index} {name}_index[{bins}] = {{"
        );
        for (k, cell) in part.index.iter().enumerate() {
            let separator = if k % 24 == 0 { "\n    " } else { " " };
            _ = write!(text, "{separator}{cell},");
        }
        let (from, per_unit, last) = (
            self.number(self.export.machine.domain.from),
            self.number(part.bins_per_unit),
            bins - 1,
        );
        _ = write!(
            text,
            "\n}};\n\nstatic place place_in_{name}(@p@_real q)\n{{\n    place at;\n    int32_t bin = (int32_t)((q - {from}) * {per_unit});\n    bin = bin < 0 ? 0 : bin > {last} ? {last} : bin;\n    at.n = {name}_cells + {stride} * (int32_t){name}_index[bin];\n    at.x = (q - at.n[0]) * at.n[1];\n    at.x2 = at.x * at.x;\n    at.x4 = at.x2 * at.x2;\n    return at;\n}}\n\n"
        );
    }

    /// Start of the numbers of a column in a cell.
    pub(super) fn offset(&self, kind: PartKind, tabulated: usize) -> usize {
        HEAD + CURVE * self.part(kind).curves.len() + TERMS * tabulated
    }

    /// Assigns columns to arrays, runs of neighbours in loops. `targets` are array and index of each column.
    pub(super) fn assign_columns(
        &self,
        kind: PartKind,
        targets: &[(String, usize)],
        text: &mut String,
    ) {
        let columns = self.part(kind).columns.iter().map(|(_, column)| *column);
        let all: Vec<(Column, &(String, usize))> = columns.zip(targets).collect();
        let runs = all.chunk_by(|(one, (array, place)), (next, (other, at))| {
            let follows = match (one, next) {
                (Column::Constant(one), Column::Constant(next)) => one == next,
                (Column::Tabulated(one), Column::Tabulated(next)) => *next == one + 1,
                (Column::Constant(_), Column::Tabulated(_))
                | (Column::Tabulated(_), Column::Constant(_)) => false,
            };
            follows && other == array && *at == place + 1
        });
        for run in runs {
            let (column, (array, place)) = run[0];
            let value = |index: &str| match column {
                Column::Constant(value) => self.number(value),
                Column::Tabulated(j) => {
                    let step = match index {
                        "" => String::new(),
                        index => format!(" + {TERMS} * {index}"),
                    };
                    format!("polynomial(at.n + {}{step}, &at)", self.offset(kind, j))
                }
            };
            _ = match run.len() {
                1 => writeln!(text, "    {array}[{place}] = {};", value("")),
                run => {
                    let place = match place {
                        0 => String::new(),
                        place => format!("{place} + "),
                    };
                    writeln!(
                        text,
                        "    for (k = 0; k < {run}; k++) {{\n        {array}[{place}k] = {};\n    }}",
                        value("k")
                    )
                }
            };
        }
    }
}
