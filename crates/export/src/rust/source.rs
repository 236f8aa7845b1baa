//! Types, constants and coefficients.

use super::RustWriter;
use crate::identifiers::comment;
use crate::machine::{LoadDescription, PartKind};
use crate::part::{CURVE, Column, HEAD, Part, Precision, TERMS, Wrapping};
use std::fmt::Write as _;

const TYPES: &str = "\
/// Why there is no value. A state stays as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// q is outside the range.
    OutOfRange,
    /// A number that is not finite came in or out.
    NotFinite,
    /// m with everything added is not above zero.
    NoInertia,
}

/// A place in a cell: the powers of the position in it.
#[derive(Clone, Copy)]
struct Place {
    x: Real,
    x2: Real,
    x4: Real,
}

fn polynomial(c: &[Real; 8], at: Place) -> Real {
    let Place { x, x2, x4 } = at;
    ((c[0] + c[1] * x) + (c[2] + c[3] * x) * x2) + ((c[4] + c[5] * x) + (c[6] + c[7] * x) * x2) * x4
}

fn is_finite(x: Real) -> bool {
    x - x >= 0.0
}

";

impl RustWriter<'_> {
    pub(super) fn source(&self) -> String {
        let mut text = self.banner();
        let real = match self.export.request.precision {
            Precision::Double => "f64",
            Precision::Float => "f32",
        };
        _ = write!(
            text,
            "#![no_std]\n#![forbid(unsafe_code)]\n#![allow(non_snake_case, non_upper_case_globals, clippy::all)]\n\n/// The numbers.\npub type Real = {real};\n\n"
        );
        self.counts(&mut text);
        text += TYPES;
        self.structures(&mut text);
        self.wrap(&mut text);
        self.integral(&mut text);
        for kind in PartKind::ALL {
            self.cells(kind, &mut text);
        }
        self.motion_terms(&mut text);
        if self.has_reactions() {
            self.reaction_terms(&mut text);
        }
        if self.has_points() {
            self.positions(&mut text);
        }
        self.results(&mut text);
        self.self_test(&mut text);
        text
    }

    fn counts(&self, text: &mut String) {
        for (what, list) in self.lists() {
            for (k, [name, meaning]) in list.iter().enumerate() {
                _ = writeln!(
                    text,
                    "/// {meaning}.\npub const {what}_{name}: usize = {k};"
                );
            }
            let count = list.len();
            _ = writeln!(
                text,
                "/// How many.\npub const {what}_COUNT: usize = {count};"
            );
        }
        text.push('\n');
    }

    fn structures(&self, text: &mut String) {
        let derive = "#[derive(Clone, Copy, Debug, PartialEq)]\n";
        let member = |text: &mut String, name: &str, meaning: &str| {
            _ = writeln!(text, "    /// {}.\n    pub {name}: Real,", comment(meaning));
        };
        _ = write!(
            text,
            "/// Constants of the machine that may be changed.\n{derive}pub struct Parameters {{\n"
        );
        for (name, _, meaning) in self.parameters() {
            member(text, &name, &meaning);
        }
        _ = write!(
            text,
            "}}\n\n/// What acts on it from outside; constant during a step.\n{derive}pub struct Inputs {{\n"
        );
        for (name, _, meaning) in self.inputs() {
            member(text, &name, &meaning);
        }
        _ = write!(
            text,
            "}}\n\n/// A state; set `carry` and `periods` to zero when you set the others.\n{derive}pub struct State {{\n"
        );
        let unit = self.export.machine.unit();
        for name in self.state_members() {
            let meaning = match name.as_str() {
                "q" => format!("Coordinate, {unit}"),
                "q_dot" => format!("Its speed, {unit}/s"),
                _ => "Current of a motor, A".to_owned(),
            };
            member(text, &name, &meaning);
        }
        _ = write!(
            text,
            "    /// What the sums have lost by rounding.\n    pub carry: [Real; {}],\n    /// Whole periods subtracted from q.\n    pub periods: i32,\n}}\n\n",
            self.order()
        );
        _ = write!(
            text,
            "/// m q'' + half_dm q'^2 = sum of w F over the loads.\n{derive}pub struct MotionTerms {{\n"
        );
        member(text, "m", "Of the bodies");
        member(text, "half_dm", "Half its derivative");
        *text += "    /// Generalised force of one unit of each load.\n    pub w: [Real; LOAD_COUNT],\n    /// Derivative of w of motors; 0 of others.\n    pub dw: [Real; LOAD_COUNT],\n    /// Potential of one unit of each conservative load; 0 of others.\n    pub v: [Real; LOAD_COUNT],\n}\n\n";
        if self.has_reactions() {
            _ = write!(
                text,
                "/// reaction k = a\\[k\\] q'' + b\\[k\\] q'^2 + sum of c\\[load\\]\\[k\\] F over the loads.\n{derive}pub struct ReactionTerms {{\n    /// Of q''.\n    pub a: [Real; REACTION_COUNT],\n    /// Of q'^2.\n    pub b: [Real; REACTION_COUNT],\n    /// Reactions to one unit of each load.\n    pub c: [[Real; REACTION_COUNT]; LOAD_COUNT],\n}}\n\n"
            );
        }
    }

    /// Brings q into the domain.
    fn wrap(&self, text: &mut String) {
        let domain = self.export.machine.domain;
        let (from, to) = (self.number(domain.from), self.number(domain.to));
        let outside =
            "return Err(if is_finite(q) { Fault::OutOfRange } else { Fault::NotFinite });";
        _ = match Wrapping::new(domain, self.export.request.precision) {
            None => write!(
                text,
                "fn wrap(q: Real) -> Result<Real, Fault> {{\n    if !(q >= {from} && q <= {to}) {{\n        {outside}\n    }}\n    Ok(q)\n}}\n\n"
            ),
            Some(w) => {
                let [per_period, coarse, fine, limit] =
                    [w.per_period, w.coarse, w.fine, w.limit].map(|n| self.number(n));
                write!(
                    text,
                    "/// The period in two parts: products of the first with counts of periods are exact.\nconst PERIOD_COARSE: Real = {coarse};\nconst PERIOD_FINE: Real = {fine};\nconst PERIOD: Real = {to};\n\nfn wrap(q: Real) -> Result<Real, Fault> {{\n    if !(q >= -{limit} && q <= {limit}) {{\n        {outside}\n    }}\n    let periods = (q * {per_period}) as i32 as Real;\n    let rest = (q - periods * PERIOD_COARSE) - periods * PERIOD_FINE;\n    Ok(if rest < 0.0 {{ rest + PERIOD }} else {{ rest }})\n}}\n\n"
                )
            }
        };
    }

    fn integral(&self, text: &mut String) {
        let part = |j: usize| format!("c[{j}] * {}", self.number(1.0 / (j + 1) as f64));
        let [b, c, d, e, f, g, h] = [1, 2, 3, 4, 5, 6, 7].map(part);
        _ = write!(
            text,
            "/// The integral of the same from the middle.\nfn integral(c: &[Real; 8], at: Place) -> Real {{\n    let Place {{ x, x2, x4 }} = at;\n    x * (((c[0] + {b} * x) + ({c} + {d} * x) * x2) + (({e} + {f} * x) + ({g} + {h} * x) * x2) * x4)\n}}\n\n"
        );
        let times = |j: usize| format!("c[{j}] * {}", self.number(j as f64));
        let [b, c, d, e, f, g] = [2, 3, 4, 5, 6, 7].map(times);
        _ = write!(
            text,
            "/// Its derivative.\n#[allow(dead_code)]\nfn slope(c: &[Real; 8], at: Place) -> Real {{\n    let Place {{ x, x2, x4 }} = at;\n    ((c[1] + {b} * x) + ({c} + {d} * x) * x2) + (({e} + {f} * x) + {g} * x2) * x4\n}}\n\n"
        );
    }

    /// The constants of a part, and the function that finds a place in it.
    fn cells(&self, kind: PartKind, text: &mut String) {
        let part = self.part(kind);
        if part.index.is_empty() {
            return;
        }
        let (upper, lower) = (TYPE_NAMES[kind as usize], NAMES[kind as usize]);
        let (curves, columns) = (part.curves.len(), part.tabulated());
        let index = if part.index_bytes() == 1 { "u8" } else { "u16" };
        _ = writeln!(
            text,
            "/// Middle, 2/width and width; by curve its value at the middle and the coefficients of half its slope; by column\n/// its coefficients. All by rising powers.\n#[allow(dead_code)]\nstruct {upper}Cell {{\n    head: [Real; 3],\n    values: [Real; {curves}],\n    curves: [[Real; 8]; {curves}],\n    columns: [[Real; 8]; {columns}],\n}}\n\nstatic {}_CELLS: [{upper}Cell; {}] = [",
            upper.to_uppercase(),
            part.cell_count()
        );
        for cell in part.cells.chunks_exact(part.stride()) {
            *text += &self.cell(part, upper, cell);
        }
        let cells: Vec<String> = part.index.iter().map(u16::to_string).collect();
        _ = write!(
            text,
            "];\n\n/// By bin: its cell.\nstatic {}_INDEX: [{index}; {}] = [{}];\n\nfn place_in_{lower}(q: Real) -> (&'static {upper}Cell, Place) {{\n    let bin = ((q - {}) * {}) as usize;\n    let last = {};\n    let cell = {c}_INDEX.get(bin).copied().unwrap_or(last) as usize;\n    // The index names cells that are there.\n    let cell = match {c}_CELLS.get(cell) {{\n        Some(cell) => cell,\n        None => &{c}_CELLS[0],\n    }};\n    let x = (q - cell.head[0]) * cell.head[1];\n    let x2 = x * x;\n    (cell, Place {{ x, x2, x4: x2 * x2 }})\n}}\n\n",
            upper.to_uppercase(),
            part.index.len(),
            cells.join(", "),
            self.number(self.export.machine.domain.from),
            self.number(part.bins_per_unit),
            part.cell_count() - 1,
            c = upper.to_uppercase(),
        );
    }

    fn cell(&self, part: &Part, name: &str, cell: &[f64]) -> String {
        let (head, rest) = cell.split_at(HEAD);
        let (curves, columns) = rest.split_at(CURVE * part.curves.len());
        let curves: Vec<&[f64]> = curves.chunks_exact(CURVE).collect();
        let values: Vec<f64> = curves.iter().map(|curve| curve[0]).collect();
        let lists = |rows: &mut dyn Iterator<Item = &[f64]>| -> String {
            let rows: Vec<String> = rows.map(|row| format!("[{}]", self.list(row))).collect();
            rows.join(", ")
        };
        format!(
            "    {name}Cell {{ head: [{}], values: [{}], curves: [{}], columns: [{}] }},\n",
            self.list(head),
            self.list(&values),
            lists(&mut curves.iter().map(|curve| &curve[1..])),
            lists(&mut columns.chunks_exact(TERMS)),
        )
    }

    fn motion_terms(&self, text: &mut String) {
        *text += "fn motion_at(q: Real) -> MotionTerms {\n    let (cell, at) = place_in_motion(q);\n    let value = |k: usize| cell.values[k] + cell.head[2] * integral(&cell.curves[k], at);\n    let half_slope = |k: usize| polynomial(&cell.curves[k], at);\n    MotionTerms {\n        m: value(0),\n        half_dm: half_slope(0),\n";
        let columns = self.column_values(PartKind::Motion);
        let one = |(k, load): (usize, &LoadDescription)| -> [String; 3] {
            let (place, zero) = (self.export.machine.place(k), "0.0".to_owned());
            if load.effect.is_conservative() {
                let w = format!("-2.0 * half_slope({place})");
                return [w, zero, format!("value({place})")];
            }
            let dw = match self.part(PartKind::Motion).columns[place].1 {
                Column::Tabulated(j) if load.effect.has_rotor() => {
                    format!("cell.head[1] * slope(&cell.columns[{j}], at)")
                }
                _ => zero.clone(),
            };
            [columns[place].clone(), dw, zero]
        };
        let terms: Vec<[String; 3]> = self.loads.iter().enumerate().map(one).collect();
        for (array, name) in ["w", "dw", "v"].iter().enumerate() {
            let values: Vec<&str> = terms.iter().map(|of| of[array].as_str()).collect();
            _ = writeln!(text, "        {name}: [{}],", values.join(", "));
        }
        *text += "    }\n}\n\n/// The terms of motion at q.\npub fn motion_terms(q: Real) -> Result<MotionTerms, Fault> {\n    wrap(q).map(motion_at)\n}\n\n";
    }

    fn reaction_terms(&self, text: &mut String) {
        let n = self.export.machine.reactions.len();
        let values = self.column_values(PartKind::Reactions);
        let mut rows = values.chunks(n).map(|row| row.join(", "));
        let (a, b) = (
            rows.next().unwrap_or_default(),
            rows.next().unwrap_or_default(),
        );
        let c: Vec<String> = rows.map(|row| format!("[{row}]")).collect();
        let place = self.place(PartKind::Reactions);
        _ = write!(
            text,
            "fn reactions_at(q: Real) -> ReactionTerms {{\n{place}    ReactionTerms {{\n        a: [{a}],\n        b: [{b}],\n        c: [{}],\n    }}\n}}\n\n/// The terms of the reactions at q.\npub fn reaction_terms(q: Real) -> Result<ReactionTerms, Fault> {{\n    wrap(q).map(reactions_at)\n}}\n\n",
            c.join(", ")
        );
    }

    fn positions(&self, text: &mut String) {
        let values = self.column_values(PartKind::Positions).join(", ");
        let place = self.place(PartKind::Positions);
        _ = write!(
            text,
            "/// x and y of every point at q, m.\npub fn positions(q: Real) -> Result<[Real; 2 * POINT_COUNT], Fault> {{\n    let q = wrap(q)?;\n{place}    Ok([{values}])\n}}\n\n"
        );
    }

    fn place(&self, kind: PartKind) -> String {
        if self.part(kind).index.is_empty() {
            "    let _ = q;\n".to_owned()
        } else {
            format!(
                "    let (cell, at) = place_in_{}(q);\n",
                NAMES[kind as usize]
            )
        }
    }

    fn column_values(&self, kind: PartKind) -> Vec<String> {
        let columns = self.part(kind).columns.iter();
        let value = |(_, column): &(_, Column)| match column {
            Column::Constant(value) => self.number(*value),
            Column::Tabulated(j) => format!("polynomial(&cell.columns[{j}], at)"),
        };
        columns.map(value).collect()
    }

    fn part(&self, kind: PartKind) -> &Part {
        &self.export.parts[kind as usize]
    }
}

/// The names of the parts, of their functions and of their types.
const NAMES: [&str; 3] = ["motion", "reaction", "position"];
const TYPE_NAMES: [&str; 3] = ["Motion", "Reaction", "Position"];
