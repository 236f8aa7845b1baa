//! Forces of the loads, reactions, energies and inverse dynamics.

use super::{ACCESS, CWriter};
use crate::export::Export;
use crate::writer::reflected;
use std::fmt::Write as _;

impl CWriter<'_, Export> {
    /// F of every load, and m and ½m′ with the added inertia.
    pub(super) fn forces(&self, text: &mut String) {
        *text += "typedef struct {\n    @p@_real m, half_dm;\n";
        if self.has_loads() {
            *text += "    @p@_real f[@U@_LOAD_COUNT];\n";
        }
        *text += "} forces;\n\nstatic void forces_of(const @p@_parameters *p, const @p@_inputs *in, const @p@_motion_terms *t, const @p@_state *s, forces *out)\n{\n";
        let mut lines = String::new();
        for (k, load) in self.loads.iter().enumerate() {
            let name = &self.names.loads[k];
            let value = ACCESS.force(&load.effect, name, &format!("t->w[{k}] * s->q_dot"));
            _ = writeln!(lines, "    out->f[{k}] = {value};");
            if load.effect.has_rotor() {
                let reflected = reflected("p->", name);
                _ = writeln!(
                    lines,
                    "    out->m = out->m + {reflected} * t->w[{k}] * t->w[{k}];\n    out->half_dm = out->half_dm + {reflected} * t->w[{k}] * t->dw[{k}];"
                );
            }
        }
        *text += "    out->m = t->m + p->added_inertia;\n    out->half_dm = t->half_dm;\n";
        *text += &self.unused_arguments(&lines);
        *text += &lines;
        *text += "}\n\n";
    }

    /// Reactions, energies and inverse dynamics.
    pub(super) fn results(&self, text: &mut String) {
        let begin = "    @p@_motion_terms terms;\n    forces f;\n";
        let evaluate = "    forces_of(parameters, inputs, &terms, state, &f);\n";
        if self.has_reactions() {
            _ = write!(
                text,
                "@p@_status @p@_reactions(@arguments@, @p@_real q_ddot, @p@_real reactions[@U@_REACTION_COUNT])\n{{\n{begin}    @p@_reaction_terms of;\n    const @p@_real speed2 = state->q_dot * state->q_dot;\n    int k;\n    @p@_status status = @p@_coefficients(state->q, &terms, &of);\n{evaluate}"
            );
            for (k, load) in self.loads.iter().enumerate() {
                if load.effect.has_rotor() {
                    let reflected = reflected("parameters->", &self.names.loads[k]);
                    _ = writeln!(
                        text,
                        "    f.f[{k}] = f.f[{k}] - {reflected} * (terms.w[{k}] * q_ddot + terms.dw[{k}] * speed2);"
                    );
                }
            }
            let loads = if self.has_loads() {
                "        int l;\n        @p@_real sum = of.a[k] * q_ddot + of.b[k] * speed2;\n        for (l = 0; l < @U@_LOAD_COUNT; l++) {\n            sum = sum + of.c[l * @U@_REACTION_COUNT + k] * f.f[l];\n        }\n"
            } else {
                *text += "    (void)f;\n";
                "        const @p@_real sum = of.a[k] * q_ddot + of.b[k] * speed2;\n"
            };
            _ = write!(
                text,
                "    for (k = 0; k < @U@_REACTION_COUNT; k++) {{\n{loads}        if (status == @U@_OK && !is_finite(sum)) {{\n            status = @U@_NOT_FINITE;\n        }}\n        reactions[k] = sum;\n    }}\n    for (k = 0; status != @U@_OK && k < @U@_REACTION_COUNT; k++) {{\n        reactions[k] = ZERO;\n    }}\n    return status;\n}}\n\n"
            );
        }
        _ = write!(
            text,
            "@p@_status @p@_energies(@arguments@, @p@_real energies[2])\n{{\n{begin}    @p@_status status = @p@_motion_terms_at(state->q, &terms);\n{evaluate}    energies[0] = {} * f.m * state->q_dot * state->q_dot;\n    energies[1] = ZERO;\n{}    if (status == @U@_OK && !(is_finite(energies[0]) && is_finite(energies[1]))) {{\n        status = @U@_NOT_FINITE;\n    }}\n    if (status != @U@_OK) {{\n        energies[0] = ZERO;\n        energies[1] = ZERO;\n    }}\n    return status;\n}}\n\n",
            self.number(0.5),
            self.potentials()
        );
        let (counter, sum) = self.sum_over_loads("*force = *force -");
        _ = write!(
            text,
            "@p@_status @p@_required_force(@arguments@, @p@_real q_ddot, @p@_real *force)\n{{\n{begin}{counter}    @p@_status status = @p@_motion_terms_at(state->q, &terms);\n{evaluate}    *force = f.m * q_ddot + f.half_dm * state->q_dot * state->q_dot;\n{sum}    if (status == @U@_OK && !is_finite(*force)) {{\n        status = @U@_NOT_FINITE;\n    }}\n    if (status != @U@_OK) {{\n        *force = ZERO;\n    }}\n    return status;\n}}\n\n"
        );
    }
}
