//! The parts of the exported C for an FMI interface: variables by number, states, rates, indicators and steps.

use super::variables::{Role, Variable};
use crate::export::Export;
use crate::writer::{Access, Members};
use std::fmt::Write as _;

/// The text that does not depend on the machine.
const GENERAL: &str = r"
/* The sensitivity of unknowns to a direction of knowns, by central differences. */
static int model_directional(const model *m, const unsigned *unknowns, size_t n, const unsigned *knowns, size_t n_knowns,
                             const double *seed, double *sensitivity)
{
    const double h = 1e-5;
    model forward = *m, backward = *m;
    size_t i;
    for (i = 0; i < n_knowns; i++) {
        double *slots[2] = {model_slot(&forward, knowns[i]), model_slot(&backward, knowns[i])};
        if (slots[0] == 0) {
            return 0;
        }
        *slots[0] += h * seed[i];
        *slots[1] -= h * seed[i];
    }
    for (i = 0; i < n; i++) {
        double one, other;
        if (!model_get(&forward, unknowns[i], &one) || !model_get(&backward, unknowns[i], &other)) {
            return 0;
        }
        sensitivity[i] = (one - other) / (2 * h);
    }
    return 1;
}

/* Steps of at most max_step over a communication step. */
static int model_advance(model *m, double time, double step)
{
    double parts = step / m->max_step;
    long i, count;
    if (!(parts >= 0 && parts < 1e9)) {
        return 0;
    }
    count = (long)parts;
    if ((double)count < parts * (1 - 1e-12)) {
        count++;
    }
    for (i = 0; i < count; i++) {
        if (@p@_step(&m->parameters, &m->inputs, step / (double)count, &m->state) != @U@_OK) {
            return 0;
        }
    }
    m->time = time + step;
    model_count_periods(m);
    return 1;
}

#endif
";

/// The header `model.h`.
pub(super) fn model(export: &Export, variables: &[Variable]) -> String {
    let members = Members::new(export);
    let states = members.order();
    let machine = &export.machine;
    let periodic = machine.domain.revolutions > 0;
    let indicators = if periodic { 2 } else { 0 };
    let references = variables.iter().enumerate();
    let periods = variables.iter().position(|v| v.role == Role::Periods);
    let mut text = format!(
        "/* The exported model as an interface sees it. */\n#ifndef MODEL_H\n#define MODEL_H\n\n#include \"@p@.h\"\n\n#include <stddef.h>\n\n#define MODEL_TOKEN \"{}\"\n#define MODEL_STATES {states}\n#define MODEL_INDICATORS {indicators}\n#define MODEL_PERIODS_REFERENCE {}u\n\ntypedef struct {{\n    @p@_parameters parameters;\n    @p@_inputs inputs;\n    @p@_state state;\n    double time, max_step;\n    int periods;\n}} model;\n\n",
        token(export),
        periods.unwrap_or(variables.len())
    );
    text += "static void model_reset(model *m)\n{\n    @p@_scene(&m->parameters, &m->inputs, &m->state);\n    m->time = 0;\n    m->max_step = 1e-3;\n    m->periods = 0;\n}\n\n";
    // Where a variable that may be set is.
    text +=
        "static double *model_slot(model *m, unsigned reference)\n{\n    switch (reference) {\n";
    for (k, variable) in references.clone() {
        if matches!(
            variable.role,
            Role::State(_) | Role::Parameter | Role::Input
        ) {
            _ = writeln!(text, "    case {k}: return &{};", variable.code);
        }
    }
    text += "    default: return 0;\n    }\n}\n\n";
    text += "/* A state that is set begins its own sums. */\nstatic int model_set(model *m, unsigned reference, double value)\n{\n    double *slot = model_slot(m, reference);\n    int k;\n    if (slot == 0) {\n        return 0;\n    }\n    *slot = value;\n    if (slot == &m->state.q) {\n        m->state.periods = 0;\n    }\n    for (k = 0; reference <= 2 * MODEL_STATES && k < MODEL_STATES; k++) {\n        m->state.carry[k] = 0;\n    }\n    return 1;\n}\n\n";
    states_functions(&members, &mut text);
    rates(&members, &mut text);
    indicator_functions(export, &mut text);
    get(&members, periodic, variables, &mut text);
    text += GENERAL;
    text.replace("@p@", &members.names.prefix)
        .replace("@U@", &members.names.capitals)
}

/// The token that ties a description to its library: the scene, the exporter and the request.
pub(super) fn token(export: &Export) -> String {
    let safe = |text: &str| -> String {
        let plain = |c: &char| c.is_ascii_alphanumeric() || "-.".contains(*c);
        text.chars().filter(plain).collect()
    };
    format!(
        "dwell-{}-{}-{:e}",
        safe(&export.machine.version),
        safe(&export.machine.scene_hash),
        export.request.accuracy
    )
}

fn states_functions(members: &Members<'_>, text: &mut String) {
    *text += "static void model_states(const model *m, double *x)\n{\n    x[0] = @p@_whole_coordinate(&m->state);\n    x[1] = m->state.q_dot;\n";
    for (_, member, place) in members.currents() {
        _ = writeln!(text, "    x[{place}] = m->state.{member};");
    }
    *text += "}\n\nstatic void model_set_states(model *m, const double *x)\n{\n    int k;\n    m->state.q = x[0];\n    m->state.q_dot = x[1];\n";
    for (_, member, place) in members.currents() {
        _ = writeln!(text, "    m->state.{member} = x[{place}];");
    }
    *text += "    m->state.periods = 0;\n    for (k = 0; k < MODEL_STATES; k++) {\n        m->state.carry[k] = 0;\n    }\n}\n\n";
}

fn rates(members: &Members<'_>, text: &mut String) {
    /// How the model reaches members.
    const ACCESS: Access = Access {
        parameters: "p->",
        inputs: "m->inputs.",
        state: "m->state.",
        zero: "0",
        choice: crate::c::CHOICE,
    };
    *text += "static int model_rates(const model *m, double *rates)\n{\n    rates[0] = m->state.q_dot;\n";
    for (load, _, place) in members.currents() {
        let velocity = format!("terms.w[{load}] * m->state.q_dot");
        let rate = ACCESS.current_rate(&members.names.loads[load], &velocity);
        _ = writeln!(
            text,
            "    {{\n        @p@_motion_terms terms;\n        const @p@_parameters *p = &m->parameters;\n        if (@p@_motion_terms_at(m->state.q, &terms) != @U@_OK) {{\n            return 0;\n        }}\n        rates[{place}] = {rate};\n    }}"
        );
    }
    *text += "    return @p@_acceleration(&m->parameters, &m->inputs, &m->state, &rates[1]) == @U@_OK;\n}\n\n";
}

fn indicator_functions(export: &Export, text: &mut String) {
    if export.machine.domain.revolutions == 0 {
        *text += "static void model_indicators(const model *m, double *indicators)\n{\n    (void)m;\n    (void)indicators;\n}\n\nstatic void model_count_periods(model *m)\n{\n    (void)m;\n}\n\n";
        return;
    }
    let period = export.machine.domain.length();
    _ = write!(
        text,
        "#define PERIOD {period:e}\n\n/* q less the end and the beginning of its period. */\nstatic void model_indicators(const model *m, double *indicators)\n{{\n    const double q = @p@_whole_coordinate(&m->state);\n    indicators[0] = q - PERIOD * (m->periods + 1);\n    indicators[1] = q - PERIOD * m->periods;\n}}\n\n/* At an event, which is located within the importer's tolerance. */\nstatic void model_count_periods(model *m)\n{{\n    const double q = @p@_whole_coordinate(&m->state), margin = 1e-9;\n    if (!(q > -1e9 && q < 1e9)) {{\n        return;\n    }}\n    while (q >= PERIOD * (m->periods + 1) - margin) {{\n        m->periods++;\n    }}\n    while (q < PERIOD * m->periods - margin) {{\n        m->periods--;\n    }}\n}}\n\n"
    );
}

/// The value of any variable.
fn get(members: &Members<'_>, periodic: bool, variables: &[Variable], text: &mut String) {
    *text += "static int model_get(model *m, unsigned reference, double *value)\n{\n    const double *slot = model_slot(m, reference);\n";
    *text += if periodic {
        "    double rates[MODEL_STATES], energies[2], indicators[2];\n    int ok = 1;\n"
    } else {
        "    double rates[MODEL_STATES], energies[2];\n    int ok = 1;\n"
    };
    if members.has_reactions() {
        *text += "    double reactions[@U@_REACTION_COUNT];\n";
    }
    if members.has_points() {
        *text += "    double xy[2 * @U@_POINT_COUNT];\n";
    }
    *text += "    switch (reference) {\n";
    for (k, variable) in variables.iter().enumerate() {
        let code = &variable.code;
        let evaluation = match variable.role {
            Role::Time => format!("*value = {code}; return 1;"),
            Role::State(0) => "*value = @p@_whole_coordinate(&m->state); return 1;".to_owned(),
            Role::Rate(_) => format!("ok = model_rates(m, rates); *value = {code}; return ok;"),
            Role::Indicator => {
                format!("model_indicators(m, indicators); *value = {code}; return 1;")
            }
            Role::Output if code.starts_with("energies") => format!(
                "ok = @p@_energies(&m->parameters, &m->inputs, &m->state, energies) == @U@_OK; *value = {code}; return ok;"
            ),
            Role::Output if code.starts_with("reactions") => format!(
                "ok = model_rates(m, rates) && @p@_reactions(&m->parameters, &m->inputs, &m->state, rates[1], reactions) == @U@_OK; *value = {code}; return ok;"
            ),
            Role::Output => {
                format!("ok = @p@_positions(m->state.q, xy) == @U@_OK; *value = {code}; return ok;")
            }
            Role::State(_) | Role::Parameter | Role::Input | Role::Periods => continue,
        };
        _ = writeln!(text, "    case {k}: {evaluation}");
    }
    *text += "    default: break;\n    }\n    if (slot == 0) {\n        return 0;\n    }\n    *value = *slot;\n    return ok;\n}\n";
}
