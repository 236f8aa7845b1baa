//! The source: constants, coefficients, and derived functions.

use super::{CWriter, tables};
use crate::export::Export;
use crate::machine::PartKind;
use crate::part::{CURVE, Column, HEAD, Wrapping};
use dwell_numerics::StraightLine;
use std::fmt::Write as _;

const PLACE: &str = "\
typedef struct {
    const @p@_real *n;
    @p@_real x, x2, x4;
} place;

";

const POLYNOMIAL: &str = "\
static @p@_real polynomial(const @p@_real *c, const place *at)
{
    const @p@_real x = at->x, x2 = at->x2, x4 = at->x4;
    return ((c[0] + c[1] * x) + (c[2] + c[3] * x) * x2) + ((c[4] + c[5] * x) + (c[6] + c[7] * x) * x2) * x4;
}

";

const SCENE_END: &str = "\
static int is_finite(@p@_real x)
{
    return x - x >= ZERO;
}

";

impl CWriter<'_, Export> {
    pub(super) fn source(&self) -> String {
        let library = match self.export.code {
            None => "",
            Some(_) => "\n#include <math.h>\n",
        };
        let mut text = format!(
            "#include \"@p@.h\"\n{library}\n#ifdef __FAST_MATH__\n#error \"-ffast-math drops the sums that carry their rounding\"\n#endif\n\n#define ZERO {}\n\n",
            self.number(0.0)
        );
        if self.export.code.is_none() {
            text += PLACE;
        }
        self.wrap(&mut text);
        if self.export.code.is_none() {
            text += POLYNOMIAL;
            self.integral(&mut text);
        }
        text += SCENE_END;
        for kind in PartKind::ALL {
            self.tables(kind, &mut text);
        }
        self.motion_terms(&mut text);
        if self.has_reactions() {
            self.reaction_terms(&mut text);
        }
        if self.has_points() {
            self.positions(&mut text);
        }
        self.scene(&mut text);
        self.forces(&mut text);
        self.results(&mut text);
        self.rates(&mut text);
        text += &self.step(&self.order().to_string());
        self.self_test(&mut text);
        text
    }

    /// The operations of a part, of an exact export.
    fn code(&self, kind: PartKind) -> Option<&StraightLine> {
        Some(&self.export.code.as_ref()?[kind as usize])
    }

    /// Brings q into the domain.
    pub(super) fn wrap(&self, text: &mut String) {
        let domain = self.export.machine.domain;
        let (from, to) = (self.number(domain.from), self.number(domain.to));
        let outside = "return *q - *q >= ZERO ? @U@_OUT_OF_RANGE : @U@_NOT_FINITE;";
        _ = match Wrapping::new(domain, self.export.request.precision) {
            None => write!(
                text,
                "static @p@_status wrap(@p@_real *q)\n{{\n    if (!(*q >= {from} && *q <= {to})) {{\n        {outside}\n    }}\n    return @U@_OK;\n}}\n\n"
            ),
            Some(w) => {
                let [per_period, coarse, fine, limit] =
                    [w.per_period, w.coarse, w.fine, w.limit].map(|n| self.number(n));
                write!(
                    text,
                    "/* The period in two parts: products of the first with counts of periods are exact. */\n#define PERIOD_COARSE {coarse}\n#define PERIOD_FINE {fine}\n#define PERIOD {to}\n\nstatic @p@_status wrap(@p@_real *q)\n{{\n    @p@_real periods;\n    if (!(*q >= -{limit} && *q <= {limit})) {{\n        {outside}\n    }}\n    periods = (@p@_real)(int32_t)(*q * {per_period});\n    *q = (*q - periods * PERIOD_COARSE) - periods * PERIOD_FINE;\n    if (*q < ZERO) {{\n        *q += PERIOD;\n    }}\n    return @U@_OK;\n}}\n\n"
                )
            }
        };
    }

    pub(super) fn integral(&self, text: &mut String) {
        let part = |j: usize| format!("c[{j}] * {}", self.number(1.0 / (j + 1) as f64));
        let [b, c, d, e, f, g, h] = [1, 2, 3, 4, 5, 6, 7].map(part);
        _ = write!(
            text,
            "/* The integral of the same from the middle. */\nstatic @p@_real integral(const @p@_real *c, const place *at)\n{{\n    const @p@_real x = at->x, x2 = at->x2, x4 = at->x4;\n    return x * (((c[0] + {b} * x) + ({c} + {d} * x) * x2) + (({e} + {f} * x) + ({g} + {h} * x) * x2) * x4);\n}}\n\n"
        );
        if self.tabulated_rotors() {
            let times = |j: usize| format!("c[{j}] * {}", self.number(j as f64));
            let [b, c, d, e, f, g] = [2, 3, 4, 5, 6, 7].map(times);
            _ = write!(
                text,
                "/* Its derivative. */\nstatic @p@_real slope(const @p@_real *c, const place *at)\n{{\n    const @p@_real x = at->x, x2 = at->x2, x4 = at->x4;\n    return at->n[1] * (((c[1] + {b} * x) + ({c} + {d} * x) * x2) + (({e} + {f} * x) + {g} * x2) * x4);\n}}\n\n"
            );
        }
    }

    /// Whether the w of a motor with a rotor is in cells, so that its derivative is needed.
    fn tabulated_rotors(&self) -> bool {
        let columns = self.part(PartKind::Motion).columns.iter();
        let mut rotors = columns.zip(self.export.machine.rotor_columns());
        rotors.any(|((_, column), rotor)| rotor && matches!(column, Column::Tabulated(_)))
    }

    /// Each member of the terms of motion, at a place.
    pub(super) fn motion_terms(&self, text: &mut String) {
        *text += "static void motion_at(@p@_real q, @p@_motion_terms *terms)\n{\n";
        match self.code(PartKind::Motion) {
            Some(code) => self.operations(code, text),
            None => *text += "    const place at = place_in_motion(q);\n",
        }
        let [m, half_dm] = self.curve(0);
        _ = writeln!(text, "    terms->m = {m};\n    terms->half_dm = {half_dm};");
        for (k, load) in self.loads.iter().enumerate() {
            let place = self.export.machine.place(k);
            let zero = "ZERO".to_owned();
            let (w, v, dw) = if load.effect.is_conservative() {
                let [value, half_slope] = self.curve(place);
                let w = format!("{} * {half_slope}", self.number(-2.0));
                (w, value, zero)
            } else {
                let (w, slope) = self.motion_column(place);
                let slope = slope.filter(|_| load.effect.has_rotor());
                (w, zero.clone(), slope.unwrap_or(zero))
            };
            _ = writeln!(text, "    terms->w[{k}] = {w};");
            if self.has_potentials() {
                _ = writeln!(text, "    terms->v[{k}] = {v};");
            }
            if self.has_rotors() {
                _ = writeln!(text, "    terms->dw[{k}] = {dw};");
            }
        }
        *text += "}\n\n";
        *text += "@p@_status @p@_motion_terms_at(@p@_real q, @p@_motion_terms *terms)\n{\n    const @p@_status status = wrap(&q);\n    if (status == @U@_OK) {\n        motion_at(q, terms);\n    } else {\n";
        self.clear_motion("terms", text);
        *text += "    }\n    return status;\n}\n\n";
    }

    /// A curve of motion, and half its slope.
    fn curve(&self, k: usize) -> [String; 2] {
        if let Some(code) = self.code(PartKind::Motion) {
            return [2 * k, 2 * k + 1].map(|k| self.operand(code.outputs[k]));
        }
        let first = HEAD + CURVE * k;
        let of = first + 1;
        [
            format!("at.n[{first}] + at.n[2] * integral(at.n + {of}, &at)"),
            format!("polynomial(at.n + {of}, &at)"),
        ]
    }

    /// A column of motion, and its slope if it is no constant.
    fn motion_column(&self, k: usize) -> (String, Option<String>) {
        let part = self.part(PartKind::Motion);
        if let Some(code) = self.code(PartKind::Motion) {
            let first = 2 * part.curves.len() + k;
            let output = |k: usize| self.operand(code.outputs[k]);
            return (output(first), Some(output(first + part.columns.len())));
        }
        match part.columns[k].1 {
            Column::Tabulated(j) => {
                let offset = self.offset(PartKind::Motion, j);
                let of = |function: &str| format!("{function}(at.n + {offset}, &at)");
                (of("polynomial"), Some(of("slope")))
            }
            Column::Constant(value) => (self.number(value), None),
        }
    }

    fn clear_motion(&self, terms: &str, text: &mut String) {
        _ = writeln!(
            text,
            "        {terms}->m = ZERO;\n        {terms}->half_dm = ZERO;"
        );
        let arrays = [
            ("w", self.has_loads()),
            ("v", self.has_potentials()),
            ("dw", self.has_rotors()),
        ];
        let there = arrays.into_iter().filter(|(_, there)| *there);
        let clear = |(array, _)| format!("                {terms}->{array}[k] = ZERO;\n");
        let lines: String = there.map(clear).collect();
        if self.has_loads() {
            _ = writeln!(
                text,
                "        {{\n            int k;\n            for (k = 0; k < @U@_LOAD_COUNT; k++) {{\n{lines}            }}\n        }}"
            );
        }
    }

    pub(super) fn reaction_terms(&self, text: &mut String) {
        let machine = &self.export.machine;
        let (n, loads) = (machine.reactions.len(), machine.loads.len());
        let array = |array: &'static str, count: usize| {
            (0..count).map(move |k| (format!("terms->{array}"), k))
        };
        let targets: Vec<_> = array("a", n)
            .chain(array("b", n))
            .chain(array("c", n * loads))
            .collect();
        *text += "static void reactions_at(@p@_real q, @p@_reaction_terms *terms)\n{\n";
        self.columns_body(PartKind::Reactions, &targets, text);
        *text += "}\n\n@p@_status @p@_reaction_terms_at(@p@_real q, @p@_reaction_terms *terms)\n{\n    const @p@_status status = wrap(&q);\n    if (status == @U@_OK) {\n        reactions_at(q, terms);\n    } else {\n";
        self.clear_reactions("terms", text);
        *text += "    }\n    return status;\n}\n\n";
        *text += "@p@_status @p@_coefficients(@p@_real q, @p@_motion_terms *motion, @p@_reaction_terms *reactions)\n{\n    const @p@_status status = wrap(&q);\n    if (status == @U@_OK) {\n        motion_at(q, motion);\n        reactions_at(q, reactions);\n    } else {\n";
        self.clear_motion("motion", text);
        self.clear_reactions("reactions", text);
        *text += "    }\n    return status;\n}\n\n";
    }

    fn clear_reactions(&self, terms: &str, text: &mut String) {
        _ = writeln!(
            text,
            "        {{\n            int k;\n            for (k = 0; k < @U@_REACTION_COUNT; k++) {{\n                {terms}->a[k] = ZERO;\n                {terms}->b[k] = ZERO;\n            }}"
        );
        if self.has_loads() {
            _ = writeln!(
                text,
                "            for (k = 0; k < @U@_LOAD_COUNT * @U@_REACTION_COUNT; k++) {{\n                {terms}->c[k] = ZERO;\n            }}"
            );
        }
        *text += "        }\n";
    }

    /// The inside of a function that fills arrays with the columns of a part.
    fn columns_body(&self, kind: PartKind, targets: &[(String, usize)], text: &mut String) {
        if let Some(code) = self.code(kind) {
            let targets = targets.iter();
            let targets = targets.map(|(array, place)| format!("{array}[{place}]"));
            *text += &self.assignments(code, targets);
            return;
        }
        let mut assignments = String::new();
        self.assign_columns(kind, targets, &mut assignments);
        if assignments.contains("for (k = 0;") {
            *text += "    int k;\n";
        }
        if self.has_cells(kind) {
            let name = tables::NAMES[kind as usize];
            _ = writeln!(text, "    const place at = place_in_{name}(q);");
        } else {
            *text += "    (void)q;\n";
        }
        *text += &assignments;
    }

    pub(super) fn positions(&self, text: &mut String) {
        let count = 2 * self.export.machine.points.len();
        let targets: Vec<_> = (0..count).map(|k| ("xy".to_owned(), k)).collect();
        *text += "static void positions_at(@p@_real q, @p@_real *xy)\n{\n";
        self.columns_body(PartKind::Positions, &targets, text);
        *text += "}\n\n@p@_status @p@_positions(@p@_real q, @p@_real xy[2 * @U@_POINT_COUNT])\n{\n    int k;\n    const @p@_status status = wrap(&q);\n    if (status == @U@_OK) {\n        positions_at(q, xy);\n        return status;\n    }\n    for (k = 0; k < 2 * @U@_POINT_COUNT; k++) {\n        xy[k] = ZERO;\n    }\n    return status;\n}\n\n";
    }

    pub(super) fn scene(&self, text: &mut String) {
        *text += "void @p@_scene(@p@_parameters *parameters, @p@_inputs *inputs, @p@_state *state)\n{\n    int k;\n";
        self.assign_constants(text);
        let [q, q_dot] = self.export.machine.initial.map(|x| self.number(x));
        _ = writeln!(text, "    state->q = {q};\n    state->q_dot = {q_dot};");
        for (_, current, _) in self.currents() {
            _ = writeln!(text, "    state->{current} = ZERO;");
        }
        _ = write!(
            text,
            "    for (k = 0; k < {}; k++) {{\n        state->carry[k] = ZERO;\n    }}\n    state->periods = 0;\n}}\n\n@p@_real @p@_whole_coordinate(const @p@_state *state)\n{{\n",
            self.order()
        );
        *text += match self.export.machine.domain.revolutions {
            0 => "    return state->q;\n}\n\n",
            _ => {
                "    const @p@_real periods = (@p@_real)state->periods;\n    return periods * PERIOD_COARSE + (state->q + periods * PERIOD_FINE);\n}\n\n"
            }
        };
    }
}
