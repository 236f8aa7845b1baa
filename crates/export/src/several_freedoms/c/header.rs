//! The header: what the code is worth, its types and its functions.

use crate::c::{CALLED, COMPILE, CWriter, POTENTIALS, member};
use crate::identifiers::distinct;
use crate::several_freedoms::export::SeveralFreedomsExport;
use crate::writer::list;
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
@p@_status @p@_acceleration(@arguments@, @p@_real q_ddot[@U@_COORDINATE_COUNT]);

/* Kinetic energy and potential, J. */
@p@_status @p@_energies(@arguments@, @p@_real energies[2]);

/* Inverse dynamics: what must act on each coordinate besides the loads, N m or N, for wanted accelerations. */
@p@_status @p@_required_forces(@arguments@, const @p@_real q_ddot[@U@_COORDINATE_COUNT], @p@_real required[@U@_COORDINATE_COUNT]);

/* One step of h seconds by the classical Runge-Kutta method of fourth order. */
@p@_status @p@_step(const @p@_parameters *parameters, const @p@_inputs *inputs, @p@_real h, @p@_state *state);

";

const REACTIONS: &str = "\
/* The terms of the reactions at q. */
@p@_status @p@_reaction_terms_at(const @p@_real q[@U@_COORDINATE_COUNT], @p@_reaction_terms *terms);

/* Every reaction of a state with its accelerations: the action of the joint's first body on its second. */
@p@_status @p@_reactions(@arguments@, const @p@_real q_ddot[@U@_COORDINATE_COUNT], @p@_real reactions[@U@_REACTION_COUNT]);

";

const MOTION_TERMS: &str = "\
/* M q'' + sum of h q_dot[i] q_dot[j] = sum of w F over the loads */
typedef struct {
    @p@_real m[@U@_COORDINATE_COUNT * @U@_COORDINATE_COUNT]; /* mass matrix of the bodies, row by row */
    @p@_real h[@U@_PAIR_COUNT * @U@_COORDINATE_COUNT]; /* Christoffel terms: by pair, then coordinate; those of both orders of a pair */
";

const REACTION_TERMS: &str = "\
/* Reactions: sum of a q_ddot[i] + sum of b q_dot[i] q_dot[j] + sum of c F over the loads; each by reaction last */
typedef struct {
    @p@_real a[@U@_COORDINATE_COUNT * @U@_REACTION_COUNT]; /* by coordinate */
    @p@_real b[@U@_PAIR_COUNT * @U@_REACTION_COUNT]; /* by pair */
";

impl CWriter<'_, SeveralFreedomsExport> {
    pub(super) fn header(&self) -> String {
        let mut text = self.banner(&self.description());
        _ = write!(
            text,
            "#ifndef @U@_H\n#define @U@_H\n\ntypedef {} @p@_real;\n\n{STATUS}",
            self.real()
        );
        let machine = &self.export.machine;
        let coordinates: Vec<_> = machine.coordinates.iter().map(|c| &c.name).collect();
        let names = list(&distinct(&coordinates), coordinates);
        self.count("COORDINATE", &names, &mut text);
        for (what, list) in self.lists() {
            self.count(what, &list, &mut text);
        }
        _ = writeln!(
            text,
            "#define @U@_PAIR_COUNT {} /* products of velocities: i <= j, in the order (0,0), (0,1), ..., (1,1), ... */\n",
            machine.pairs().len()
        );
        self.types(&mut text);
        text += MOTION;
        if self.has_reactions() {
            text += REACTIONS;
        }
        if self.has_points() {
            text += "/* x and y of every point at q, m. */\n@p@_status @p@_positions(const @p@_real q[@U@_COORDINATE_COUNT], @p@_real xy[2 * @U@_POINT_COUNT]);\n\n";
        }
        text += "#ifdef @U@_SELF_TEST\n/* 0, or the number of the first check that failed. */\nint @p@_self_test(void);\n#endif\n\n#endif\n";
        text
    }

    /// What the code is, and what it is worth.
    fn description(&self) -> Vec<String> {
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
        lines.push(format!(
            "accuracy: the operations of the model itself, in the assembly mode of the scene; largest errors measured around the initial position in {}, relative to the largest value of each kind: mass matrix {:.1e}, velocity terms {:.1e}, loads {:.1e}, reactions {:.1e}, positions {:.1e}",
            self.precision.measured_in(),
            errors.mass_matrix,
            errors.velocity_terms,
            errors.loads,
            errors.reactions,
            errors.positions
        ));
        let codes = self.export.code.each_ref();
        let [motion, reactions, positions] = codes.map(|code| code.operations.len());
        let functions = codes.map(|code| code.functions().to_string());
        lines.push(format!(
            "operations: {motion} of the terms of motion, {reactions} of those of the reactions, {positions} of the positions; of them square roots, sines, cosines and angles: {}",
            functions.join(", ")
        ));
        lines.extend([CALLED, COMPILE].map(str::to_owned));
        let left_out = machine.left_out.iter();
        lines.extend(left_out.map(|words| format!("left out: {words}")));
        lines
    }

    fn types(&self, text: &mut String) {
        let meaning = "kg m2 or kg: added along each coordinate, such as a flywheel";
        let added = ("added_inertia[@U@_COORDINATE_COUNT]", meaning);
        self.constant_types(Some(added), text);
        *text += "/* A state; set `carry` to zero when you set the others. */\ntypedef struct {\n";
        member(text, "q[@U@_COORDINATE_COUNT]", "rad or m");
        member(text, "q_dot[@U@_COORDINATE_COUNT]", "rad/s or m/s");
        self.state_end(text);
        *text += "} @p@_state;\n\n";
        *text += MOTION_TERMS;
        if self.has_loads() {
            *text += "    @p@_real w[@U@_LOAD_COUNT * @U@_COORDINATE_COUNT]; /* generalised forces of one unit of each load */\n";
            *text += POTENTIALS;
        }
        *text += "} @p@_motion_terms;\n\n";
        if self.has_reactions() {
            *text += REACTION_TERMS;
            if self.has_loads() {
                member(text, "c[@U@_LOAD_COUNT * @U@_REACTION_COUNT]", "by load");
            }
            *text += "} @p@_reaction_terms;\n\n";
        }
    }
}
