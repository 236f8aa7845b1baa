//! Rates of a state, and the step.

use super::{ACCESS, CWriter};
use crate::export::Export;
use std::fmt::Write as _;

impl CWriter<'_, Export> {
    /// The counter of a sum of w F over the loads, and the sum, each with what it is added to.
    pub(super) fn sum_over_loads(&self, sum: &str) -> (&'static str, String) {
        match self.has_loads() {
            true => (
                "    int k;\n",
                format!(
                    "    for (k = 0; k < @U@_LOAD_COUNT; k++) {{\n        {sum} f.f[k] * terms.w[k];\n    }}\n"
                ),
            ),
            false => ("", String::new()),
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
        for (load, _, place) in self.currents() {
            let velocity = format!("terms.w[{load}] * s->q_dot");
            let rate = ACCESS.current_rate(&self.names.loads[load], &velocity);
            _ = writeln!(text, "    rates[{place}] = {rate};");
            finite += &format!(" && is_finite(rates[{place}])");
        }
        _ = write!(
            text,
            "    return {finite} ? @U@_OK : @U@_NOT_FINITE;\n}}\n\n@p@_status @p@_acceleration(@arguments@, @p@_real *q_ddot)\n{{\n    @p@_real rates[{order}];\n    const @p@_status status = rates_of(parameters, inputs, state, rates);\n    *q_ddot = status == @U@_OK ? rates[1] : ZERO;\n    return status;\n}}\n\n"
        );
    }

    pub(super) fn step(&self, text: &mut String) {
        let members = self.state_members();
        let order = members.len();
        *text += "static void move_state(const @p@_state *from, @p@_real h, const @p@_real *rates, @p@_state *to)\n{\n";
        for (k, member) in members.iter().enumerate() {
            _ = writeln!(text, "    to->{member} = from->{member} + h * rates[{k}];");
        }
        let [half, two, sixth] = [0.5, 2.0, 6.0].map(|n| self.number(n));
        _ = write!(
            text,
            "}}\n\n/* Adds to a sum and to what it has lost by rounding. */\nstatic void add(@p@_real *sum, @p@_real *carry, @p@_real change)\n{{\n    const @p@_real corrected = change - *carry;\n    const @p@_real next = *sum + corrected;\n    *carry = (next - *sum) - corrected;\n    *sum = next;\n}}\n\n@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state)\n{{\n    @p@_real k1[{order}], k2[{order}], k3[{order}], k4[{order}];\n    const @p@_real half = {half} * h, sixth = h / {sixth};\n    @p@_state s = *state;\n    int k;\n    @p@_status status = is_finite(h) ? rates_of(parameters, inputs, state, k1) : @U@_NOT_FINITE;\n    if (status == @U@_OK) {{\n        move_state(state, half, k1, &s);\n        status = rates_of(parameters, inputs, &s, k2);\n    }}\n    if (status == @U@_OK) {{\n        move_state(state, half, k2, &s);\n        status = rates_of(parameters, inputs, &s, k3);\n    }}\n    if (status == @U@_OK) {{\n        move_state(state, h, k3, &s);\n        status = rates_of(parameters, inputs, &s, k4);\n    }}\n    if (status != @U@_OK) {{\n        return status;\n    }}\n    for (k = 0; k < {order}; k++) {{\n        k1[k] = sixth * (k1[k] + {two} * (k2[k] + k3[k]) + k4[k]);\n    }}\n    s = *state;\n"
        );
        for (k, member) in members.iter().enumerate() {
            _ = writeln!(text, "    add(&s.{member}, &s.carry[{k}], k1[{k}]);");
        }
        if self.export.machine.domain.revolutions > 0 {
            *text += "    if (s.q >= PERIOD || s.q < ZERO) {\n        @p@_real next, carry = s.carry[0];\n        if (s.q >= PERIOD) {\n            s.periods++;\n            next = s.q - PERIOD_COARSE;\n            carry = carry + PERIOD_FINE;\n        } else {\n            s.periods--;\n            next = s.q + PERIOD_COARSE;\n            carry = (carry - PERIOD_FINE) + ((next - PERIOD_COARSE) - s.q);\n        }\n        /* The rest of the period is too much for a carry: the next step begins at q itself. */\n        s.q = next - carry;\n        s.carry[0] = (s.q - next) + carry;\n    }\n";
        } else {
            *text += "    status = wrap(&s.q);\n    if (status != @U@_OK) {\n        return status;\n    }\n";
        }
        *text += "    *state = s;\n    return @U@_OK;\n}\n\n";
    }
}
