//! The header: what the code is worth, its types and its functions.

use super::{CALLED, COMPILE, CWriter, POTENTIALS, member};
use crate::describe::describe;
use crate::export::Export;
use crate::part::Wrapping;
use std::fmt::Write as _;

impl CWriter<'_, Export> {
    pub(super) fn header(&self) -> String {
        let mut text = self.banner(&self.description());
        _ = writeln!(
            text,
            "#ifndef @U@_H\n#define @U@_H\n\n#include <stdint.h>\n\ntypedef {} @p@_real;\n",
            self.real()
        );
        text += "typedef enum {\n    @U@_OK = 0,\n    @U@_OUT_OF_RANGE = 1, /* q is outside the range: outputs are zero, a state stays as it was */\n    @U@_NOT_FINITE = 2,   /* a number that is not finite came in or out: the same */\n    @U@_NO_INERTIA = 3    /* m with everything added is not above zero: the same */\n} @p@_status;\n\n";
        for (what, list) in self.lists() {
            self.count(what, &list, &mut text);
        }
        text.push('\n');
        self.types(&mut text);
        self.functions(&mut text);
        text += "#endif\n";
        text
    }

    /// What the code is, and what it is worth.
    fn description(&self) -> Vec<String> {
        let export = self.export;
        let mut lines = describe(export);
        let [motion, all, step] = export.measured.operations;
        let operations = format!(
            "Additions, multiplications and divisions, the worst case at any q: {motion} of the terms of motion, {all} with those of the reactions, {step} of a step"
        );
        match export.code {
            None => {
                let bytes = export.constant_bytes();
                lines.push(format!("constants: {bytes} bytes. {operations}"));
                lines.push("No function allocates, recurses, keeps anything between calls or calls a library.".to_owned());
            }
            Some(_) => {
                let [motion, all] = export.functions();
                lines.push(operations);
                lines.push(format!(
                    "Square roots, sines, cosines and angles: {motion} of the terms of motion, {all} with those of the reactions, {} of a step",
                    4 * motion
                ));
                lines.push(CALLED.to_owned());
            }
        }
        lines.push(COMPILE.to_owned());
        let wrapping = Wrapping::new(export.machine.domain, export.request.precision);
        if let Some(limit) = wrapping.map(|w| w.limit.floor()) {
            lines.push(format!("q may be any number of revolutions from {} to {limit} rad; a state keeps q in one period and counts the others.", -limit));
        }
        lines
    }

    fn types(&self, text: &mut String) {
        let machine = &self.export.machine;
        self.constant_types(None, text);
        let unit = machine.unit();
        *text += "/* A state; set `carry` and `periods` to zero when you set the others. */\ntypedef struct {\n";
        member(text, "q", &format!("{unit}: {}", machine.coordinate));
        member(text, "q_dot", &format!("{unit}/s: its speed"));
        self.state_end(text);
        *text += "    int32_t periods; /* whole periods subtracted from q */\n} @p@_state;\n\n";
        self.term_types(text);
    }

    /// The coefficients at a coordinate.
    fn term_types(&self, text: &mut String) {
        let machine = &self.export.machine;
        let (m, unit) = (machine.inertia_unit(), machine.unit());
        *text += "/* m q'' + half_dm q'^2 = sum of w F over the loads */\ntypedef struct {\n";
        member(text, "m", &format!("{m}: of the bodies"));
        member(text, "half_dm", &format!("{m}/{unit}"));
        if self.has_loads() {
            *text += "    @p@_real w[@U@_LOAD_COUNT]; /* generalised force of one unit of each load */\n";
        }
        if self.has_rotors() {
            *text +=
                "    @p@_real dw[@U@_LOAD_COUNT]; /* derivative of w of motors; 0 of others */\n";
        }
        if self.has_potentials() {
            *text += POTENTIALS;
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
        let force = match self.export.machine.is_angle {
            true => "N m",
            false => "N",
        };
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
        *text += "/* q'' of a state. */\n@p@_status @p@_acceleration(@arguments@, @p@_real *q_ddot);\n\n";
        if self.has_reactions() {
            *text += "/* Every reaction of a state with its acceleration: the action of the joint's first body on its second. */\n@p@_status @p@_reactions(@arguments@, @p@_real q_ddot, @p@_real reactions[@U@_REACTION_COUNT]);\n\n";
        }
        *text += "/* Kinetic energy and potential, J. */\n@p@_status @p@_energies(@arguments@, @p@_real energies[2]);\n\n";
        _ = writeln!(
            text,
            "/* Inverse dynamics: what must act on the coordinate besides the loads, {force}, for a wanted q''. */\n@p@_status @p@_required_force(@arguments@, @p@_real q_ddot, @p@_real *force);\n"
        );
        *text += "/* One step of h seconds by the classical Runge-Kutta method of fourth order. */\n@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state);\n\n";
        *text += "#ifdef @U@_SELF_TEST\n/* 0, or the number of the first check that failed. */\nint @p@_self_test(void);\n#endif\n\n";
    }
}
