//! Forces, accelerations, reactions, energies, inverse dynamics and the step.

use super::RustWriter;
use crate::writer::{Access, reflected};
use std::fmt::Write as _;

/// How Rust reaches members.
const ACCESS: Access = Access {
    parameters: "p.",
    inputs: "inputs.",
    state: "s.",
    zero: "0.0",
    choice: ["(if ", " { ", " } else { ", " })"],
};

impl RustWriter<'_> {
    pub(super) fn results(&self, text: &mut String) {
        self.scene(text);
        self.forces(text);
        if self.has_reactions() {
            self.reactions(text);
        }
        self.energies(text);
        self.rates(text);
        self.step(text);
    }

    fn scene(&self, text: &mut String) {
        *text += "/// Parameters, inputs and initial state of the scene.\npub fn scene() -> (Parameters, Inputs, State) {\n    let parameters = Parameters {\n";
        for (name, value, _) in self.parameters() {
            _ = writeln!(text, "        {name}: {},", self.number(value));
        }
        *text += "    };\n    let inputs = Inputs {\n";
        for (name, value, _) in self.inputs() {
            _ = writeln!(text, "        {name}: {},", self.number(value));
        }
        let [q, q_dot] = self.export.machine.initial.map(|n| self.number(n));
        _ = write!(
            text,
            "    }};\n    let state = State {{\n        q: {q},\n        q_dot: {q_dot},\n"
        );
        for member in self.state_members().iter().skip(2) {
            _ = writeln!(text, "        {member}: 0.0,");
        }
        let whole = match self.export.machine.domain.revolutions {
            0 => "state.q".to_owned(),
            _ => "{\n        let periods = state.periods as Real;\n        periods * PERIOD_COARSE + (state.q + periods * PERIOD_FINE)\n    }".to_owned(),
        };
        _ = write!(
            text,
            "        carry: [0.0; {}],\n        periods: 0,\n    }};\n    (parameters, inputs, state)\n}}\n\n/// q with all revolutions.\npub fn whole_coordinate(state: &State) -> Real {{\n    {whole}\n}}\n\n",
            self.order()
        );
    }

    /// F of every load, and m and ½m′ with the added inertia.
    fn forces(&self, text: &mut String) {
        *text += "/// F of every load, and m and half_dm with what is added.\n#[allow(unused_variables, unused_mut)]\nfn forces(p: &Parameters, inputs: &Inputs, t: &MotionTerms, s: &State) -> ([Real; LOAD_COUNT], Real, Real) {\n    let (mut m, mut half_dm) = (t.m + p.added_inertia, t.half_dm);\n";
        let mut forces = Vec::new();
        for (k, load) in self.loads.iter().enumerate() {
            let name = &self.names.loads[k];
            forces.push(ACCESS.force(&load.effect, name, &format!("t.w[{k}] * s.q_dot")));
            if load.effect.has_rotor() {
                let reflected = reflected("p.", name);
                _ = writeln!(
                    text,
                    "    m = m + {reflected} * t.w[{k}] * t.w[{k}];\n    half_dm = half_dm + {reflected} * t.w[{k}] * t.dw[{k}];"
                );
            }
        }
        _ = write!(text, "    ([{}], m, half_dm)\n}}\n\n", forces.join(", "));
    }

    fn reactions(&self, text: &mut String) {
        *text += "/// Every reaction of a state with its acceleration: the action of the joint's first body on its second.\n#[allow(unused_mut)]\npub fn reactions(parameters: &Parameters, inputs: &Inputs, state: &State, q_ddot: Real) -> Result<[Real; REACTION_COUNT], Fault> {\n    let q = wrap(state.q)?;\n    let (terms, of) = (motion_at(q), reactions_at(q));\n    let speed2 = state.q_dot * state.q_dot;\n    let (mut f, _, _) = forces(parameters, inputs, &terms, state);\n";
        for (k, load) in self.loads.iter().enumerate() {
            if load.effect.has_rotor() {
                let reflected = reflected("parameters.", &self.names.loads[k]);
                _ = writeln!(
                    text,
                    "    f[{k}] = f[{k}] - {reflected} * (terms.w[{k}] * q_ddot + terms.dw[{k}] * speed2);"
                );
            }
        }
        *text += "    let mut reactions = [0.0; REACTION_COUNT];\n    for (reaction, (a, b)) in reactions.iter_mut().zip(of.a.iter().zip(&of.b)) {\n        *reaction = a * q_ddot + b * speed2;\n    }\n    for (c, f) in of.c.iter().zip(&f) {\n        for (reaction, c) in reactions.iter_mut().zip(c) {\n            *reaction = *reaction + c * f;\n        }\n    }\n    match reactions.iter().all(|&reaction| is_finite(reaction)) {\n        true => Ok(reactions),\n        false => Err(Fault::NotFinite),\n    }\n}\n\n";
    }

    fn energies(&self, text: &mut String) {
        *text += "/// Kinetic energy and potential, J.\n#[allow(unused_variables, unused_mut)]\npub fn energies(parameters: &Parameters, inputs: &Inputs, state: &State) -> Result<[Real; 2], Fault> {\n    let terms = motion_terms(state.q)?;\n    let (f, m, _) = forces(parameters, inputs, &terms, state);\n    let mut potential = 0.0;\n";
        for k in self.conservative() {
            _ = writeln!(text, "    potential = potential + f[{k}] * terms.v[{k}];");
        }
        *text += "    let kinetic = 0.5 * m * state.q_dot * state.q_dot;\n    match is_finite(kinetic) && is_finite(potential) {\n        true => Ok([kinetic, potential]),\n        false => Err(Fault::NotFinite),\n    }\n}\n\n/// Inverse dynamics: what must act on the coordinate besides the loads for a wanted q''.\npub fn required_force(parameters: &Parameters, inputs: &Inputs, state: &State, q_ddot: Real) -> Result<Real, Fault> {\n    let terms = motion_terms(state.q)?;\n    let (f, m, half_dm) = forces(parameters, inputs, &terms, state);\n    let mut force = m * q_ddot + half_dm * state.q_dot * state.q_dot;\n    for (f, w) in f.iter().zip(&terms.w) {\n        force = force - f * w;\n    }\n    match is_finite(force) {\n        true => Ok(force),\n        false => Err(Fault::NotFinite),\n    }\n}\n\n";
    }

    /// q̇, q̈ and the rates of currents.
    fn rates(&self, text: &mut String) {
        let mut rates = vec!["s.q_dot".to_owned(), "force / m".to_owned()];
        for (load, ..) in self.currents() {
            let velocity = format!("terms.w[{load}] * s.q_dot");
            rates.push(ACCESS.current_rate(&self.names.loads[load], &velocity));
        }
        _ = write!(
            text,
            "fn rates(p: &Parameters, inputs: &Inputs, s: &State) -> Result<[Real; {}], Fault> {{\n    let terms = motion_terms(s.q)?;\n    let (f, m, half_dm) = forces(p, inputs, &terms, s);\n    let mut force = 0.0 - half_dm * s.q_dot * s.q_dot;\n    for (f, w) in f.iter().zip(&terms.w) {{\n        force = force + f * w;\n    }}\n    if !(m > 0.0) {{\n        return Err(if is_finite(m) {{ Fault::NoInertia }} else {{ Fault::NotFinite }});\n    }}\n    let rates = [{}];\n    match rates.iter().all(|&rate| is_finite(rate)) {{\n        true => Ok(rates),\n        false => Err(Fault::NotFinite),\n    }}\n}}\n\n/// q'' of a state.\npub fn acceleration(parameters: &Parameters, inputs: &Inputs, state: &State) -> Result<Real, Fault> {{\n    rates(parameters, inputs, state).map(|rates| rates[1])\n}}\n\n",
            rates.len(),
            rates.join(", ")
        );
    }

    fn step(&self, text: &mut String) {
        let members = self.state_members();
        let order = members.len();
        _ = write!(
            text,
            "fn moved(from: &State, h: Real, rates: &[Real; {order}]) -> State {{\n    let mut to = *from;\n"
        );
        for (k, member) in members.iter().enumerate() {
            _ = writeln!(text, "    to.{member} = from.{member} + h * rates[{k}];");
        }
        _ = write!(
            text,
            "    to\n}}\n\n/// Adds to a sum and to what it has lost by rounding.\nfn add(sum: &mut Real, carry: &mut Real, change: Real) {{\n    let corrected = change - *carry;\n    let next = *sum + corrected;\n    *carry = (next - *sum) - corrected;\n    *sum = next;\n}}\n\n/// One step of h seconds by the classical Runge-Kutta method of fourth order.\npub fn step(parameters: &Parameters, inputs: &Inputs, h: Real, state: &mut State) -> Result<(), Fault> {{\n    if !is_finite(h) {{\n        return Err(Fault::NotFinite);\n    }}\n    let (half, sixth) = (0.5 * h, h / 6.0);\n    let k1 = rates(parameters, inputs, state)?;\n    let k2 = rates(parameters, inputs, &moved(state, half, &k1))?;\n    let k3 = rates(parameters, inputs, &moved(state, half, &k2))?;\n    let k4 = rates(parameters, inputs, &moved(state, h, &k3))?;\n    let mut s = *state;\n"
        );
        for (k, member) in members.iter().enumerate() {
            _ = writeln!(
                text,
                "    add(&mut s.{member}, &mut s.carry[{k}], sixth * (k1[{k}] + 2.0 * (k2[{k}] + k3[{k}]) + k4[{k}]));"
            );
        }
        *text += match self.export.machine.domain.revolutions {
            0 => "    wrap(s.q)?;\n",
            _ => {
                "    if s.q >= PERIOD || s.q < 0.0 {\n        let (next, carry) = if s.q >= PERIOD {\n            s.periods = s.periods.wrapping_add(1);\n            (s.q - PERIOD_COARSE, s.carry[0] + PERIOD_FINE)\n        } else {\n            s.periods = s.periods.wrapping_sub(1);\n            let next = s.q + PERIOD_COARSE;\n            (next, (s.carry[0] - PERIOD_FINE) + ((next - PERIOD_COARSE) - s.q))\n        };\n        // The rest of the period is too much for a carry: the next step begins at q itself.\n        s.q = next - carry;\n        s.carry[0] = (s.q - next) + carry;\n    }\n"
            }
        };
        *text += "    *state = s;\n    Ok(())\n}\n\n";
    }
}
