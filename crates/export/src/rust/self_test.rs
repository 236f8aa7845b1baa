//! The self-test: exact values, which the cells were not fitted at, and a motion.

use super::RustWriter;
use std::fmt::Write as _;

impl RustWriter<'_> {
    pub(super) fn self_test(&self, text: &mut String) {
        let (machine, measured) = (&self.export.machine, &self.export.measured);
        let (values, rows) = (measured.tolerances.len(), measured.rows.len());
        _ = write!(
            text,
            "#[cfg(any(test, feature = \"self-test\"))]\n/// q, then m, half_dm, w, a, b, c and positions of the mechanism itself.\nstatic EXACT: [(Real, [Real; {values}]); {rows}] = [\n"
        );
        for row in &measured.rows {
            _ = writeln!(
                text,
                "    ({}, [{}]),",
                self.number(row.q),
                self.list(&row.values)
            );
        }
        _ = write!(
            text,
            "];\n\n#[cfg(any(test, feature = \"self-test\"))]\nstatic TOLERANCE: [Real; {values}] = [{}];\n\n#[cfg(any(test, feature = \"self-test\"))]\nfn differs(value: Real, expected: Real, allowed: Real) -> bool {{\n    let difference = if value > expected {{ value - expected }} else {{ expected - value }};\n    !(difference <= allowed)\n}}\n\n/// Compares the code with exact values; else the number of the first check that failed.\n#[cfg(any(test, feature = \"self-test\"))]\npub fn self_test() -> Result<(), u32> {{\n    for (q, expected) in &EXACT {{\n        let terms = motion_terms(*q).map_err(|_| 1u32)?;\n        let inertia = [terms.m, terms.half_dm];\n        let values = inertia.iter().chain(&terms.w);\n",
            self.list(&measured.tolerances)
        );
        if self.has_reactions() {
            *text += "        let of = reaction_terms(*q).map_err(|_| 1u32)?;\n        let values = values.chain(&of.a).chain(&of.b).chain(of.c.iter().flatten());\n";
        }
        if self.has_points() {
            *text += "        let points = positions(*q).map_err(|_| 2u32)?;\n        let values = values.chain(&points);\n";
        }
        _ = write!(
            text,
            "        for (k, (found, (expected, allowed))) in values.zip(expected.iter().zip(&TOLERANCE)).enumerate() {{\n            if differs(*found, *expected, *allowed) {{\n                return Err(10 + k as u32);\n            }}\n        }}\n    }}\n    if motion_terms({}) != Err(Fault::OutOfRange) {{\n        return Err(3);\n    }}\n    let (mut parameters, inputs, state) = scene();\n    parameters.added_inertia = {};\n    if acceleration(&parameters, &inputs, &state) != Err(Fault::NoInertia) {{\n        return Err(4);\n    }}\n",
            self.number(machine.domain.outside()),
            self.number(-1e30)
        );
        let motion = &measured.motion;
        if let Some([end, tolerance]) = motion.end {
            let [from, speed] = motion.from.map(|n| self.number(n));
            let [q, q_dot] = end.map(|n| self.number(n));
            let [q_off, q_dot_off] = tolerance.map(|n| self.number(n));
            _ = write!(
                text,
                "    let (parameters, inputs, mut state) = scene();\n    state.q = {from};\n    state.q_dot = {speed};\n    for _ in 0..{} {{\n        step(&parameters, &inputs, {}, &mut state).map_err(|_| 5u32)?;\n    }}\n    if differs(whole_coordinate(&state), {q}, {q_off}) || differs(state.q_dot, {q_dot}, {q_dot_off}) {{\n        return Err(6);\n    }}\n",
                motion.steps,
                self.number(motion.step)
            );
        }
        *text += "    Ok(())\n}\n\n#[cfg(test)]\n#[test]\nfn exact_values_come_back() {\n    assert_eq!(self_test(), Ok(()));\n}\n";
    }
}
