//! The self-test: exact values, which the cells were not fitted at, and a motion.

use super::CWriter;
use crate::export::Export;
use std::fmt::Write as _;

impl CWriter<'_, Export> {
    pub(super) fn self_test(&self, text: &mut String) {
        let (machine, measured) = (&self.export.machine, &self.export.measured);
        let values = measured.tolerances.len();
        let rows = measured.rows.len();
        let list = |numbers: &[f64]| -> String {
            let lines = numbers.chunks(6).map(|line| {
                let line: Vec<String> = line.iter().map(|&n| self.number(n)).collect();
                line.join(", ")
            });
            lines.collect::<Vec<_>>().join(",\n        ")
        };
        _ = write!(
            text,
            "#ifdef @U@_SELF_TEST\n/* q, then m, half_dm, w, a, b, c and positions of the mechanism itself. */\nstatic const @p@_real exact[{rows}][{}] = {{\n",
            values + 1
        );
        for row in &measured.rows {
            let all: Vec<f64> = std::iter::once(row.q)
                .chain(row.values.iter().copied())
                .collect();
            _ = writeln!(text, "    {{{}}},", list(&all));
        }
        _ = write!(
            text,
            "}};\n\nstatic const @p@_real tolerance[{values}] = {{\n        {}\n}};\n\n",
            list(&measured.tolerances)
        );
        *text += "static int differs(@p@_real value, @p@_real expected, @p@_real allowed)\n{\n    const @p@_real difference = value > expected ? value - expected : expected - value;\n    return !(difference <= allowed);\n}\n\nint @p@_self_test(void)\n{\n    @p@_parameters parameters;\n    @p@_inputs inputs;\n    @p@_state state;\n    @p@_motion_terms terms;\n    @p@_real q_ddot;\n    int row, k;\n";
        if self.has_reactions() {
            *text += "    @p@_reaction_terms reactions;\n";
        }
        if self.has_points() {
            *text += "    @p@_real xy[2 * @U@_POINT_COUNT];\n";
        }
        self.rows_check(text);
        _ = write!(
            text,
            "        for (k = 0; k < n; k++) {{\n            if (differs(found[k], expected[k], tolerance[k])) {{\n                return 10 + k;\n            }}\n        }}\n    }}\n    if (@p@_motion_terms_at({}, &terms) != @U@_OUT_OF_RANGE) {{\n        return 3;\n    }}\n    @p@_scene(&parameters, &inputs, &state);\n    parameters.added_inertia = {};\n    if (@p@_acceleration(&parameters, &inputs, &state, &q_ddot) != @U@_NO_INERTIA) {{\n        return 4;\n    }}\n",
            self.number(machine.domain.outside()),
            self.number(-1e30)
        );
        self.motion_check(text);
        *text += "    return 0;\n}\n\nint main(void)\n{\n    return @p@_self_test();\n}\n#endif\n";
    }

    /// The values at the rows' coordinates.
    fn rows_check(&self, text: &mut String) {
        let measured = &self.export.measured;
        let (rows, values) = (measured.rows.len(), measured.tolerances.len());
        _ = write!(
            text,
            "    for (row = 0; row < {rows}; row++) {{\n        const @p@_real *expected = exact[row] + 1;\n        @p@_real found[{values}];\n        int n = 0;\n"
        );
        *text += if self.has_reactions() {
            "        if (@p@_coefficients(exact[row][0], &terms, &reactions) != @U@_OK) {\n            return 1;\n        }\n"
        } else {
            "        if (@p@_motion_terms_at(exact[row][0], &terms) != @U@_OK) {\n            return 1;\n        }\n"
        };
        *text += "        found[n++] = terms.m;\n        found[n++] = terms.half_dm;\n";
        let mut copy = |array: &str, count: &str| {
            _ = write!(
                text,
                "        for (k = 0; k < {count}; k++) {{\n            found[n++] = {array}[k];\n        }}\n"
            );
        };
        if self.has_loads() {
            copy("terms.w", "@U@_LOAD_COUNT");
        }
        if self.has_reactions() {
            copy("reactions.a", "@U@_REACTION_COUNT");
            copy("reactions.b", "@U@_REACTION_COUNT");
            if self.has_loads() {
                copy("reactions.c", "@U@_LOAD_COUNT * @U@_REACTION_COUNT");
            }
        }
        if self.has_points() {
            *text += "        if (@p@_positions(exact[row][0], xy) != @U@_OK) {\n            return 2;\n        }\n";
            _ = write!(
                text,
                "        for (k = 0; k < 2 * @U@_POINT_COUNT; k++) {{\n            found[n++] = xy[k];\n        }}\n"
            );
        }
    }

    /// The motion.
    fn motion_check(&self, text: &mut String) {
        let measured = &self.export.measured;
        let motion = &measured.motion;
        if let Some([end, tolerance]) = motion.end {
            let [from, speed] = motion.from.map(|n| self.number(n));
            let [q, q_dot, q_off, q_dot_off] =
                [end[0], end[1], tolerance[0], tolerance[1]].map(|n| self.number(n));
            _ = write!(
                text,
                "    @p@_scene(&parameters, &inputs, &state);\n    state.q = {from};\n    state.q_dot = {speed};\n    for (k = 0; k < {}; k++) {{\n        if (@p@_step(&parameters, &inputs, {}, &state) != @U@_OK) {{\n            return 5;\n        }}\n    }}\n    if (differs(@p@_whole_coordinate(&state), {q}, {q_off}) || differs(state.q_dot, {q_dot}, {q_dot_off})) {{\n        return 6;\n    }}\n",
                motion.steps,
                self.number(motion.step)
            );
        }
    }
}
