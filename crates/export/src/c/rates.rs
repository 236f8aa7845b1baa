//! Rates of a state.

use super::CWriter;
use crate::export::Export;
use std::fmt::Write as _;

impl CWriter<'_, Export> {
    /// The counter of a sum of w F over the loads, and the sum, each with its initial text.
    pub(super) fn sum_over_loads(&self, sum: &str) -> (&'static str, String) {
        if self.has_loads() {
            (
                "    int k;\n",
                format!(
                    "    for (k = 0; k < @U@_LOAD_COUNT; k++) {{\n        {sum} f.f[k] * terms.w[k];\n    }}\n"
                ),
            )
        } else {
            ("", String::new())
        }
    }

    /// q̇, q̈ and the rates of currents.
    pub(super) fn rates(&self, text: &mut String) {
        let order = self.order();
        let (counter, sum) = self.sum_over_loads("force = force +");
        _ = write!(
            text,
            "static @p@_status rates_of(const @p@_parameters *p, const @p@_inputs *in, const @p@_state *s, @p@_real rates[{order}])\n{{\n    @p@_motion_terms terms;\n    forces f;\n    @p@_real force;\n{counter}    const @p@_status status = @p@_motion_terms_at(s->q, &terms);\n    if (status != @U@_OK) {{\n        return status;\n    }}\n    forces_of(p, in, &terms, s, &f);\n    force = ZERO - f.half_dm * s->q_dot * s->q_dot;\n{sum}    if (!(f.m > ZERO)) {{\n        return is_finite(f.m) ? @U@_NO_INERTIA : @U@_NOT_FINITE;\n    }}\n    rates[0] = s->q_dot;\n    rates[1] = force / f.m;\n"
        );
        let mut finite = "is_finite(rates[0]) && is_finite(rates[1])".to_owned();
        *text += &self.current_rates(|load| format!("terms.w[{load}] * s->q_dot"));
        finite += &self.each_current(" && is_finite(rates[@k@])");
        _ = write!(
            text,
            "    return {finite} ? @U@_OK : @U@_NOT_FINITE;\n}}\n\n@p@_status @p@_acceleration(@arguments@, @p@_real *q_ddot)\n{{\n    @p@_real rates[{order}];\n    const @p@_status status = rates_of(parameters, inputs, state, rates);\n    *q_ddot = status == @U@_OK ? rates[1] : ZERO;\n    return status;\n}}\n\n"
        );
    }
}
