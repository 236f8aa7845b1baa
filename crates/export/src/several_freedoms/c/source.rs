//! The source: a template for any machine, filled with the operations, the loads and the self-test.

use crate::c::{ACCESS, CWriter};
use crate::part::Precision;
use crate::several_freedoms::export::SeveralFreedomsExport;
use crate::several_freedoms::measure::{MOTION, SampledState};
use crate::writer::reflected;
use std::fmt::Write as _;

const SOURCE: &str = include_str!("../template.c");
const REACTION_TERMS: &str = include_str!("../reactions.c");
const SELF_TEST: &str = include_str!("../self_test.c");

impl CWriter<'_, SeveralFreedomsExport> {
    pub(super) fn source(&self) -> String {
        let own = [
            ("motion", self.motion()),
            ("reactions_at", self.reaction_terms()),
            ("positions_at", self.positions()),
            ("scene", self.scene()),
            ("forces", self.forces()),
            (
                "current_rates",
                self.current_rates(|k| self.velocity(k, "terms.", "s->q_dot")),
            ),
            ("reactions", self.reactions()),
            ("potentials", self.potentials()),
        ];
        self.fill(SOURCE, &own) + &self.step("ORDER") + &self.self_test()
    }

    fn motion(&self) -> String {
        let machine = &self.export.machine;
        let (n, pairs) = (machine.freedoms(), machine.pairs());
        let upper = pairs.iter().map(|[i, j]| {
            if i == j {
                format!("terms->m[{}]", i * n + j)
            } else {
                format!("terms->m[{}] = terms->m[{}]", j * n + i, i * n + j)
            }
        });
        let h = (0..pairs.len() * n).map(|k| format!("terms->h[{k}]"));
        let w = (0..machine.loads.len() * n).map(|k| format!("terms->w[{k}]"));
        let v = (0..machine.loads.len()).map(|k| format!("terms->v[{k}]"));
        self.assignments(&self.export.code[0], upper.chain(h).chain(w).chain(v))
    }

    fn reaction_terms(&self) -> String {
        if !self.has_reactions() {
            return String::new();
        }
        let machine = &self.export.machine;
        let r = machine.reactions.len();
        let array = |name: &'static str, count: usize| {
            (0..count * r).map(move |k| format!("terms->{name}[{k}]"))
        };
        let (a, b) = (array("a", self.freedoms), array("b", machine.pairs().len()));
        let targets = a.chain(b).chain(array("c", machine.loads.len()));
        let terms = self.assignments(&self.export.code[1], targets);
        self.fill(REACTION_TERMS, &[("reaction_terms", terms)])
    }

    fn positions(&self) -> String {
        let count = 2 * self.export.machine.points.len();
        if count == 0 {
            return String::new();
        }
        let targets = (0..count).map(|k| format!("xy[{k}]"));
        let body = self.assignments(&self.export.code[2], targets);
        format!(
            "@p@_status @p@_positions(const @p@_real q[@U@_COORDINATE_COUNT], @p@_real xy[2 * @U@_POINT_COUNT])\n{{\n{body}    if (!all_finite(xy, 2 * @U@_POINT_COUNT)) {{\n        clear(xy, 2 * @U@_POINT_COUNT);\n        return all_finite(q, N) ? @U@_OUT_OF_RANGE : @U@_NOT_FINITE;\n    }}\n    return @U@_OK;\n}}\n\n"
        )
    }

    fn scene(&self) -> String {
        let machine = &self.export.machine;
        let mut text = String::from(
            "void @p@_scene(@p@_parameters *parameters, @p@_inputs *inputs, @p@_state *state)\n{\n    clear(parameters->added_inertia, N);\n",
        );
        self.assign_constants(&mut text);
        for (k, coordinate) in machine.coordinates.iter().enumerate() {
            let [q, q_dot] = coordinate.initial.map(|x| self.number(x));
            _ = writeln!(
                text,
                "    state->q[{k}] = {q};\n    state->q_dot[{k}] = {q_dot};"
            );
        }
        text += &self.each_current("    state->@c@ = ZERO;\n");
        text + "    clear(state->carry, ORDER);\n}\n"
    }

    /// w q̇ of a load.
    fn velocity(&self, load: usize, terms: &str, state: &str) -> String {
        let n = self.export.machine.freedoms();
        let each = (0..n).map(|i| format!("{terms}w[{}] * {state}[{i}]", load * n + i));
        format!("({})", each.collect::<Vec<_>>().join(" + "))
    }

    fn forces(&self) -> String {
        let mut text = String::new();
        for (k, load) in self.loads.iter().enumerate() {
            let name = &self.names.loads[k];
            let velocity = self.velocity(k, "t->", "s->q_dot");
            let value = ACCESS.force(&load.effect, name, &velocity);
            _ = writeln!(text, "    out->f[{k}] = {value};");
            if load.effect.has_rotor() {
                let (first, reflected) = (k * self.freedoms, reflected("p->", name));
                _ = writeln!(
                    text,
                    "    for (i = 0; i < N * N; i++) {{\n        out->m[i] = out->m[i] + {reflected} * t->w[{first} + i / N] * t->w[{first} + i % N];\n    }}"
                );
            }
        }
        let unused = self.unused_arguments(&text);
        text + &unused
    }

    fn reactions(&self) -> String {
        if !self.has_reactions() {
            return String::new();
        }
        let mut rotors = String::new();
        for (k, load) in self.loads.iter().enumerate() {
            if load.effect.has_rotor() {
                let acceleration = self.velocity(k, "terms.", "q_ddot");
                let reflected = reflected("parameters->", &self.names.loads[k]);
                _ = writeln!(
                    rotors,
                    "    f.f[{k}] = f.f[{k}] - {reflected} * {acceleration};"
                );
            }
        }
        let loads = if self.has_loads() {
            "        for (i = 0; i < @U@_LOAD_COUNT; i++) {\n            sum = sum + of.c[i * @U@_REACTION_COUNT + k] * f.f[i];\n        }\n"
        } else {
            ""
        };
        format!(
            "@p@_status @p@_reactions(@arguments@, const @p@_real q_ddot[@U@_COORDINATE_COUNT], @p@_real reactions[@U@_REACTION_COUNT])\n{{\n    @p@_motion_terms terms;\n    @p@_reaction_terms of;\n    forces f;\n    int i, j, k;\n    @p@_status status = @p@_motion_terms_at(state->q, &terms);\n    if (status == @U@_OK) {{\n        status = @p@_reaction_terms_at(state->q, &of);\n    }}\n    if (status != @U@_OK) {{\n        clear(reactions, @U@_REACTION_COUNT);\n        return status;\n    }}\n    forces_of(parameters, inputs, &terms, state, &f);\n{rotors}    for (k = 0; k < @U@_REACTION_COUNT; k++) {{\n        @p@_real sum = ZERO;\n        int pair = 0;\n        for (i = 0; i < N; i++) {{\n            sum = sum + of.a[i * @U@_REACTION_COUNT + k] * q_ddot[i];\n            for (j = i; j < N; j++) {{\n                sum = sum + of.b[pair * @U@_REACTION_COUNT + k] * (state->q_dot[i] * state->q_dot[j]);\n                pair++;\n            }}\n        }}\n{loads}        reactions[k] = sum;\n    }}\n    if (!all_finite(reactions, @U@_REACTION_COUNT)) {{\n        clear(reactions, @U@_REACTION_COUNT);\n        return @U@_NOT_FINITE;\n    }}\n    return @U@_OK;\n}}\n\n"
        )
    }

    fn self_test(&self) -> String {
        let machine = &self.export.machine;
        let n = machine.freedoms();
        let most = machine.reactions.len().max(2 * n).max(2);
        let mut checks = String::new();
        for (s, state) in self.export.states.iter().enumerate() {
            let code = 10 * (s + 1);
            checks += "    @p@_scene(&parameters, &inputs, &state);\n";
            for k in 0..n {
                let [q, q_dot] = [state.y[k], state.y[n + k]].map(|x| self.number(x));
                _ = writeln!(
                    checks,
                    "    state.q[{k}] = {q};\n    state.q_dot[{k}] = {q_dot};"
                );
            }
            for (_, member, place) in self.currents() {
                let current = self.number(state.y[place]);
                _ = writeln!(checks, "    state.{member} = {current};");
            }
            self.check_values(&mut checks, state, code);
            if let Some(end) = &state.end {
                let (steps, step) = (MOTION.0, self.number(MOTION.1));
                _ = writeln!(
                    checks,
                    "    for (k = 0; k < {steps}; k++) {{\n        if (@p@_step(&parameters, &inputs, {step}, &state) != @U@_OK) {{\n            return {};\n        }}\n    }}\n    for (k = 0; k < N; k++) {{\n        found[k] = state.q[k];\n        found[N + k] = state.q_dot[k];\n    }}",
                    code + 8
                );
                let (end, tolerance) = (&end[..2 * n], state.tolerances[4]);
                self.check(&mut checks, "@U@_OK", end, tolerance, code + 9);
            }
        }
        // Its square is no number.
        let huge = match self.export.precision {
            Precision::Double => 1e300,
            Precision::Float => 1e30,
        };
        let own = [
            ("most", most.to_string()),
            ("no_inertia", self.number(-1e30)),
            ("huge", self.number(huge)),
            ("checks", checks),
        ];
        self.fill(SELF_TEST, &own)
    }

    /// Accelerations, reactions, energies and required forces at a state.
    fn check_values(&self, checks: &mut String, state: &SampledState, code: usize) {
        let Some(values) = &state.values else {
            return;
        };
        let calls = [
            "@p@_acceleration(&parameters, &inputs, &state, found)",
            "@p@_reactions(&parameters, &inputs, &state, q_ddot, found)",
            "@p@_energies(&parameters, &inputs, &state, found)",
            "@p@_required_forces(&parameters, &inputs, &state, q_ddot, found)",
        ];
        for (k, (values, call)) in values.iter().zip(calls).enumerate() {
            if !values.is_empty() {
                self.check(checks, call, values, state.tolerances[k], code + k);
            }
            *checks += match k {
                0 => "    for (k = 0; k < N; k++) {\n        q_ddot[k] = found[k];\n    }\n",
                2 => "    clear(q_ddot, N);\n",
                _ => "",
            };
        }
    }

    /// A call whose results in `found` must be these.
    fn check(&self, text: &mut String, call: &str, values: &[f64], tolerance: f64, code: usize) {
        let list: Vec<String> = values.iter().map(|&x| self.number(x)).collect();
        let (count, list, tolerance) = (values.len(), list.join(", "), self.number(tolerance));
        _ = writeln!(
            text,
            "    {{\n        static const @p@_real expected[{count}] = {{{list}}};\n        if ({call} != @U@_OK || differs(found, expected, {count}, {tolerance})) {{\n            return {code};\n        }}\n    }}"
        );
    }
}
