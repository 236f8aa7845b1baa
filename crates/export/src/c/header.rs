//! The header: what the code is worth, its types and its functions.

use super::CWriter;
use crate::describe::describe;
use crate::identifiers::comment;
use crate::part::Precision;
use std::fmt::Write as _;

impl CWriter<'_> {
    pub(super) fn header(&self) -> String {
        let mut text = self.banner();
        text += "#ifndef @U@_H\n#define @U@_H\n\n#include <stdint.h>\n\n";
        let real = match self.export.request.precision {
            Precision::Double => "double",
            Precision::Float => "float",
        };
        _ = writeln!(text, "typedef {real} @p@_real;\n");
        text += "typedef enum {\n    @U@_OK = 0,\n    @U@_OUT_OF_RANGE = 1, /* q is outside the range: outputs are zero, a state stays as it was */\n    @U@_NOT_FINITE = 2,   /* a number that is not finite came in or out: the same */\n    @U@_NO_INERTIA = 3    /* m with everything added is not above zero: the same */\n} @p@_status;\n\n";
        self.counts(&mut text);
        self.types(&mut text);
        self.functions(&mut text);
        text += "#endif\n";
        text
    }

    /// What the code is, and what it is worth.
    fn banner(&self) -> String {
        let (machine, measured) = (&self.export.machine, &self.export.measured);
        let mut text = String::from("/*\n");
        let mut line = |words: &str| {
            _ = writeln!(text, " * {}", comment(words).trim_end());
        };
        for words in describe(self.export) {
            line(&words);
        }
        let [motion, all, step] = measured.operations;
        let operations = format!(
            "Additions, multiplications and divisions, the worst case at any q: {motion} of the terms of motion, {all} with those of the reactions, {step} of a step"
        );
        match self.export.code {
            None => {
                let bytes = self.export.constant_bytes();
                line(&format!("constants: {bytes} bytes. {operations}"));
                line(
                    "No function allocates, recurses, keeps anything between calls or calls a library.",
                );
            }
            Some(_) => {
                let [motion, all] = self.export.functions();
                line(&operations);
                line(&format!(
                    "Square roots, sines, cosines and angles: {motion} of the terms of motion, {all} with those of the reactions, {} of a step",
                    4 * motion
                ));
                line(
                    "No function allocates, recurses or keeps anything between calls. Of the library they call sqrt, sin, cos and atan2 of math.h, each only if it is needed.",
                );
            }
        }
        line(
            "Compile without -ffast-math and with doubles that stay doubles: the sums of a step carry their rounding.",
        );
        if machine.domain.revolutions > 0 {
            line(
                "q may be any number of revolutions within the limit; a state keeps q in one period and counts the others.",
            );
        }
        text += " */\n";
        text
    }

    fn counts(&self, text: &mut String) {
        let machine = &self.export.machine;
        let mut count = |what: &str, names: &[String], meanings: Vec<&str>| {
            for (k, (name, meaning)) in names.iter().zip(meanings).enumerate() {
                let name = name.to_ascii_uppercase();
                _ = writeln!(
                    text,
                    "#define @U@_{what}_{name} {k} /* {} */",
                    comment(meaning)
                );
            }
            _ = writeln!(text, "#define @U@_{what}_COUNT {}", names.len());
        };
        let loads = machine.loads.iter().map(|load| load.name.as_str());
        count("LOAD", &self.names.loads, loads.collect());
        let reactions = machine.reactions.iter().map(|(name, _)| name.as_str());
        count("REACTION", &self.names.reactions, reactions.collect());
        let points = machine.points.iter().map(String::as_str);
        count("POINT", &self.names.points, points.collect());
        text.push('\n');
    }

    fn types(&self, text: &mut String) {
        let machine = &self.export.machine;
        *text += "/* Constants of the machine that may be changed. */\ntypedef struct {\n";
        for (name, _, meaning) in self.parameters() {
            member(text, &name, &meaning);
        }
        *text += "} @p@_parameters;\n\n/* What acts on it from outside; constant during a step. */\ntypedef struct {\n";
        let inputs = self.inputs();
        for (_, name, _, meaning) in &inputs {
            member(text, name, meaning);
        }
        if inputs.is_empty() {
            member(text, "none", "there is no input");
        }
        let (q, speed) = match machine.is_angle {
            true => ("rad", "rad/s"),
            false => ("m", "m/s"),
        };
        *text += "} @p@_inputs;\n\n/* A state; set `carry` and `periods` to zero when you set the others. */\ntypedef struct {\n";
        member(text, "q", &format!("{q}: {}", machine.coordinate));
        member(text, "q_dot", &format!("{speed}: its speed"));
        let currents = self.currents();
        for &(load, _) in &currents {
            let name = &self.names.loads[load];
            member(text, &format!("current_{name}"), "A: current of the motor");
        }
        _ = writeln!(
            text,
            "    @p@_real carry[{}]; /* what the sums have lost by rounding */",
            2 + currents.len()
        );
        *text += "    int32_t periods; /* whole periods subtracted from q */\n} @p@_state;\n\n";
        self.term_types(text);
    }

    /// The coefficients at a coordinate.
    fn term_types(&self, text: &mut String) {
        let machine = &self.export.machine;
        let [m, half_dm] = match machine.is_angle {
            true => ["kg m2", "kg m2/rad"],
            false => ["kg", "kg/m"],
        };
        *text += "/* m q'' + half_dm q'^2 = sum of w F over the loads */\ntypedef struct {\n";
        member(text, "m", &format!("{m}: of the bodies"));
        member(text, "half_dm", half_dm);
        if self.has_loads() {
            member(
                text,
                "w[@U@_LOAD_COUNT]",
                "generalised force of one unit of each load",
            );
        }
        if self.has_rotors() {
            member(
                text,
                "dw[@U@_LOAD_COUNT]",
                "derivative of w of motors; 0 of others",
            );
        }
        if self.has_potentials() {
            let meaning = "potential of one unit of each conservative load; 0 of others";
            member(text, "v[@U@_LOAD_COUNT]", meaning);
        }
        *text += "} @p@_motion_terms;\n\n";
        if self.has_reactions() {
            *text += "/* reaction k = a[k] q'' + b[k] q'^2 + sum of c[load * @U@_REACTION_COUNT + k] F over the loads */\ntypedef struct {\n";
            member(text, "a[@U@_REACTION_COUNT]", "of q''");
            member(text, "b[@U@_REACTION_COUNT]", "of q'^2");
            if self.has_loads() {
                let all = "c[@U@_LOAD_COUNT * @U@_REACTION_COUNT]";
                member(text, all, "reactions to one unit of each load");
            }
            *text += "} @p@_reaction_terms;\n\n";
        }
    }

    fn functions(&self, text: &mut String) {
        let force = if self.export.machine.is_angle {
            "N m"
        } else {
            "N"
        };
        let arguments =
            "const @p@_parameters *parameters, const @p@_inputs *inputs, const @p@_state *state";
        *text += "/* Parameters, inputs and initial state of the scene. */\nvoid @p@_scene(@p@_parameters *parameters, @p@_inputs *inputs, @p@_state *state);\n\n";
        *text += "/* q with all revolutions. */\n@p@_real @p@_whole_coordinate(const @p@_state *state);\n\n";
        *text += "/* The coefficients at q. */\n@p@_status @p@_motion_terms_at(@p@_real q, @p@_motion_terms *terms);\n";
        if self.has_reactions() {
            *text += "@p@_status @p@_reaction_terms_at(@p@_real q, @p@_reaction_terms *terms);\n";
            *text += "/* Both at once. */\n@p@_status @p@_coefficients(@p@_real q, @p@_motion_terms *motion, @p@_reaction_terms *reactions);\n";
        }
        text.push('\n');
        if self.has_points() {
            *text += "/* x and y of every point at q, m. */\n@p@_status @p@_positions(@p@_real q, @p@_real xy[2 * @U@_POINT_COUNT]);\n\n";
        }
        _ = writeln!(
            text,
            "/* q'' of a state. */\n@p@_status @p@_acceleration({arguments}, @p@_real *q_ddot);\n"
        );
        if self.has_reactions() {
            _ = writeln!(
                text,
                "/* Every reaction of a state with its acceleration: the action of the joint's first body on its second. */\n@p@_status @p@_reactions({arguments}, @p@_real q_ddot, @p@_real reactions[@U@_REACTION_COUNT]);\n"
            );
        }
        _ = writeln!(
            text,
            "/* Kinetic energy and potential, J. */\n@p@_status @p@_energies({arguments}, @p@_real energies[2]);\n"
        );
        _ = writeln!(
            text,
            "/* Inverse dynamics: what must act on the coordinate besides the loads, {force}, for a wanted q''. */\n@p@_status @p@_required_force({arguments}, @p@_real q_ddot, @p@_real *force);\n"
        );
        *text += "/* One step of h seconds by the classical Runge-Kutta method of fourth order. */\n@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state);\n\n";
        *text += "#ifdef @U@_SELF_TEST\n/* 0, or the number of the first check that failed. */\nint @p@_self_test(void);\n#endif\n\n";
    }
}

/// A member of a structure.
fn member(text: &mut String, name: &str, meaning: &str) {
    _ = writeln!(text, "    @p@_real {name}; /* {} */", comment(meaning));
}
