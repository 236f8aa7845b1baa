//! The header: what the code is worth, its types and its functions.

use super::Writer;
use crate::identifiers::comment;
use crate::part::Precision;
use std::fmt::Write as _;

const STATUS: &str = "\
typedef enum {
    @U@_OK = 0,
    @U@_OUT_OF_RANGE = 1, /* the mechanism cannot be assembled at q: outputs are zero, a state stays as it was */
    @U@_NOT_FINITE = 2,   /* a number that is not finite came in or out: the same */
    @U@_NO_INERTIA = 3    /* the mass matrix with everything added is not positive definite: the same */
} @p@_status;

";

const MOTION: &str = "\
/* Parameters, inputs and initial state of the scene. */
void @p@_scene(@p@_parameters *parameters, @p@_inputs *inputs, @p@_state *state);

/* The terms of the equations of motion at q. */
@p@_status @p@_motion_terms_at(const @p@_real q[@U@_COORDINATE_COUNT], @p@_motion_terms *terms);

/* Accelerations of a state. */
@p@_status @p@_acceleration(const @p@_parameters *parameters, const @p@_inputs *inputs, const @p@_state *state, @p@_real q_ddot[@U@_COORDINATE_COUNT]);

/* Kinetic energy and potential, J. */
@p@_status @p@_energies(const @p@_parameters *parameters, const @p@_inputs *inputs, const @p@_state *state, @p@_real energies[2]);

/* Inverse dynamics: what must act on each coordinate besides the loads, N m or N, for wanted accelerations. */
@p@_status @p@_required_forces(const @p@_parameters *parameters, const @p@_inputs *inputs, const @p@_state *state, const @p@_real q_ddot[@U@_COORDINATE_COUNT], @p@_real required[@U@_COORDINATE_COUNT]);

/* One step of h seconds by the classical Runge-Kutta method of fourth order. */
@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state);

";

const REACTIONS: &str = "\
/* The terms of the reactions at q. */
@p@_status @p@_reaction_terms_at(const @p@_real q[@U@_COORDINATE_COUNT], @p@_reaction_terms *terms);

/* Every reaction of a state with its accelerations: the action of the joint's first body on its second. */
@p@_status @p@_reactions(const @p@_parameters *parameters, const @p@_inputs *inputs, const @p@_state *state, const @p@_real q_ddot[@U@_COORDINATE_COUNT], @p@_real reactions[@U@_REACTION_COUNT]);

";

impl Writer<'_> {
    pub(super) fn header(&self) -> String {
        let mut text = self.banner();
        let real = match self.export.precision {
            Precision::Double => "double",
            Precision::Float => "float",
        };
        _ = write!(
            text,
            "#ifndef @U@_H\n#define @U@_H\n\ntypedef {real} @p@_real;\n\n{STATUS}"
        );
        self.counts(&mut text);
        self.types(&mut text);
        text += MOTION;
        if self.has_reactions() {
            text += REACTIONS;
        }
        if !self.export.machine.points.is_empty() {
            text += "/* x and y of every point at q, m. */\n@p@_status @p@_positions(const @p@_real q[@U@_COORDINATE_COUNT], @p@_real xy[2 * @U@_POINT_COUNT]);\n\n";
        }
        text += "#ifdef @U@_SELF_TEST\n/* 0, or the number of the first check that failed. */\nint @p@_self_test(void);\n#endif\n\n#endif\n";
        text
    }

    /// What the code is, and what it is worth.
    fn banner(&self) -> String {
        let (machine, errors) = (&self.export.machine, &self.export.errors);
        let n = machine.freedoms();
        let mut lines = vec![
            machine.title.clone(),
            String::new(),
            format!(
                "Equations of motion of {n} degrees of freedom, written by dwell {} from the scene with the hash {}.",
                machine.version, machine.scene_hash
            ),
            "All quantities are in SI units.".to_owned(),
        ];
        for coordinate in &machine.coordinates {
            let unit = if coordinate.is_angle { "rad" } else { "m" };
            lines.push(format!("coordinate: {}, {unit}", coordinate.name));
        }
        let kind = match self.export.precision {
            Precision::Double => "double precision",
            Precision::Float => "single precision, its rounding included",
        };
        lines.push(format!(
            "accuracy: the operations of the model itself, in the assembly mode of the scene; largest errors measured around the initial position in {kind}, relative to the largest value of each kind: mass matrix {:.1e}, velocity terms {:.1e}, loads {:.1e}, reactions {:.1e}, positions {:.1e}",
            errors.mass_matrix,
            errors.velocity_terms,
            errors.loads,
            errors.reactions,
            errors.positions
        ));
        let [motion, reactions, positions] = &self.export.code;
        let counts =
            [motion, reactions, positions].map(|code| (code.operations.len(), code.functions()));
        lines.push(format!(
            "operations: {} of the terms of motion, {} of those of the reactions, {} of the positions; of them square roots, sines, cosines and angles: {}, {}, {}",
            counts[0].0, counts[1].0, counts[2].0, counts[0].1, counts[1].1, counts[2].1
        ));
        lines.push("No function allocates, recurses or keeps anything between calls. Of the library they call sqrt, sin, cos and atan2 of math.h, each only if it is needed.".to_owned());
        lines.push("Compile without -ffast-math and with doubles that stay doubles: the sums of a step carry their rounding.".to_owned());
        let left_out = machine.left_out.iter();
        lines.extend(left_out.map(|words| format!("left out: {words}")));
        let mut text = String::from("/*\n");
        for line in lines {
            _ = writeln!(text, " * {}", comment(&line).trim_end());
        }
        text + " */\n"
    }

    fn counts(&self, text: &mut String) {
        let machine = &self.export.machine;
        let mut count = |what: &str, names: &[String], meanings: Vec<&str>| {
            for (k, (name, meaning)) in names.iter().zip(meanings).enumerate() {
                let (name, meaning) = (name.to_ascii_uppercase(), comment(meaning));
                _ = writeln!(text, "#define @U@_{what}_{name} {k} /* {meaning} */");
            }
            _ = writeln!(text, "#define @U@_{what}_COUNT {}", names.len());
        };
        let coordinates = machine.coordinates.iter().map(|c| c.name.as_str());
        count("COORDINATE", &self.coordinates, coordinates.collect());
        let loads = machine.loads.iter().map(|load| load.name.as_str());
        count("LOAD", &self.names.loads, loads.collect());
        let reactions = machine.reactions.iter().map(|(name, _)| name.as_str());
        count("REACTION", &self.names.reactions, reactions.collect());
        let points = machine.points.iter().map(String::as_str);
        count("POINT", &self.names.points, points.collect());
        _ = writeln!(
            text,
            "#define @U@_PAIR_COUNT {} /* products of velocities: i <= j, in the order (0,0), (0,1), ..., (1,1), ... */\n",
            machine.pairs().len()
        );
    }

    fn types(&self, text: &mut String) {
        *text += "/* Constants of the machine that may be changed. */\ntypedef struct {\n";
        member(
            text,
            "added_inertia[@U@_COORDINATE_COUNT]",
            "kg m2 or kg: added along each coordinate, such as a flywheel",
        );
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
        *text += "} @p@_inputs;\n\n";
        self.state_type(text);
        *text += "/* M q'' + sum of h q_dot[i] q_dot[j] = sum of w F over the loads */\ntypedef struct {\n";
        let all = "@U@_COORDINATE_COUNT";
        member(
            text,
            &format!("m[{all} * {all}]"),
            "mass matrix of the bodies, row by row",
        );
        member(
            text,
            &format!("h[@U@_PAIR_COUNT * {all}]"),
            "Christoffel terms: by pair, then coordinate; those of both orders of a pair",
        );
        if self.has_loads() {
            member(
                text,
                &format!("w[@U@_LOAD_COUNT * {all}]"),
                "generalised forces of one unit of each load",
            );
            member(
                text,
                "v[@U@_LOAD_COUNT]",
                "potential of one unit of each conservative load; 0 of others",
            );
        }
        *text += "} @p@_motion_terms;\n\n";
        if self.has_reactions() {
            *text += "/* Reactions: sum of a q_ddot[i] + sum of b q_dot[i] q_dot[j] + sum of c F over the loads; each by reaction last */\ntypedef struct {\n";
            let reactions = "@U@_REACTION_COUNT";
            member(text, &format!("a[{all} * {reactions}]"), "by coordinate");
            member(text, &format!("b[@U@_PAIR_COUNT * {reactions}]"), "by pair");
            if self.has_loads() {
                let c = format!("c[@U@_LOAD_COUNT * {reactions}]");
                member(text, &c, "by load");
            }
            *text += "} @p@_reaction_terms;\n\n";
        }
    }

    fn state_type(&self, text: &mut String) {
        *text += "/* A state; set `carry` to zero when you set the others. */\ntypedef struct {\n";
        member(text, "q[@U@_COORDINATE_COUNT]", "rad or m");
        member(text, "q_dot[@U@_COORDINATE_COUNT]", "rad/s or m/s");
        let currents = self.currents();
        for &(load, _) in &currents {
            let name = format!("current_{}", self.names.loads[load]);
            member(text, &name, "A: current of the motor");
        }
        let order = 2 * self.export.machine.freedoms() + currents.len();
        let carry = format!("carry[{order}]");
        member(text, &carry, "what the sums have lost by rounding");
        *text += "} @p@_state;\n\n";
    }
}

/// A member of a structure.
fn member(text: &mut String, name: &str, meaning: &str) {
    _ = writeln!(text, "    @p@_real {name}; /* {} */", comment(meaning));
}
