//! The XML of an FMU: its model description and its build description.

use super::FmiVersion;
use super::model::token;
use super::variables::{Role, Variable, base_exponents};
use crate::describe::describe;
use crate::export::Export;
use crate::identifiers::comment;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Text in an attribute.
fn attribute(text: &str) -> String {
    let mut safe = String::new();
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            c if c.is_control() => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

/// `modelDescription.xml`.
pub(super) fn model_description(
    export: &Export,
    version: FmiVersion,
    identifier: &str,
    variables: &[Variable],
) -> String {
    let machine = &export.machine;
    let about: Vec<String> = describe(export)
        .iter()
        .skip(2)
        .map(|line| comment(line))
        .collect();
    let (title, token, about) = (
        attribute(&machine.title),
        token(export),
        attribute(&about.join(" ")),
    );
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let tool = format!("dwell {}", attribute(&machine.version));
    let indicators = variables
        .iter()
        .filter(|v| v.role == Role::Indicator)
        .count();
    let common = "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"";
    match version {
        FmiVersion::Three => {
            _ = write!(
                text,
                "<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{title}\" instantiationToken=\"{token}\" description=\"{about}\" generationTool=\"{tool}\" variableNamingConvention=\"flat\">\n  <ModelExchange modelIdentifier=\"{identifier}\" {common} providesDirectionalDerivatives=\"true\"/>\n  <CoSimulation modelIdentifier=\"{identifier}\" {common} canHandleVariableCommunicationStepSize=\"true\" providesDirectionalDerivatives=\"true\"/>\n"
            );
        }
        FmiVersion::Two => {
            let common = common.replace("FMUState", "FMUstate");
            let sources = format!(
                "    <SourceFiles>\n      <File name=\"{identifier}.c\"/>\n      <File name=\"fmi2.c\"/>\n    </SourceFiles>\n"
            );
            _ = write!(
                text,
                "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"{title}\" guid=\"{token}\" description=\"{about}\" generationTool=\"{tool}\" variableNamingConvention=\"flat\" numberOfEventIndicators=\"{indicators}\">\n  <ModelExchange modelIdentifier=\"{identifier}\" {common} providesDirectionalDerivative=\"true\">\n{sources}  </ModelExchange>\n  <CoSimulation modelIdentifier=\"{identifier}\" {common} canHandleVariableCommunicationStepSize=\"true\" providesDirectionalDerivative=\"true\">\n{sources}  </CoSimulation>\n"
            );
        }
    }
    units(variables, &mut text);
    text += "  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"0.01\"/>\n";
    variables_and_structure(version, variables, &mut text);
    text += "</fmiModelDescription>\n";
    text
}

fn units(variables: &[Variable], text: &mut String) {
    let used: BTreeSet<&str> = variables.iter().map(|v| v.unit.as_str()).collect();
    *text += "  <UnitDefinitions>\n";
    for unit in used.into_iter().filter(|unit| !unit.is_empty()) {
        let exponents = base_exponents(unit).unwrap_or_default();
        let named = ["kg", "m", "s", "A", "rad"].iter().zip(exponents);
        let named = named.filter(|(_, exponent)| *exponent != 0);
        let base: String = named.map(|(name, e)| format!(" {name}=\"{e}\"")).collect();
        let shown = match unit {
            "rad" => Some(("deg", 57.295_779_513_082_32)),
            "rad/s" => Some(("rpm", 9.549_296_585_513_72)),
            "m" => Some(("mm", 1000.0)),
            _ => None,
        };
        let display = shown.map_or_else(String::new, |(name, factor)| {
            format!("<DisplayUnit name=\"{name}\" factor=\"{factor}\"/>")
        });
        _ = writeln!(
            text,
            "    <Unit name=\"{}\"><BaseUnit{base}/>{display}</Unit>",
            attribute(unit)
        );
    }
    *text += "  </UnitDefinitions>\n";
}

/// Causality, variability and the other attributes that both versions share, and the start value, if there is one.
fn properties(variable: &Variable) -> (String, String) {
    let (causality, variability, initial) = match variable.role {
        Role::Time => ("independent", "continuous", ""),
        Role::State(_) => ("output", "continuous", "exact"),
        Role::Rate(_) | Role::Indicator => ("local", "continuous", "calculated"),
        Role::Output => ("output", "continuous", "calculated"),
        Role::Parameter => ("parameter", "tunable", "exact"),
        Role::Input => ("input", "continuous", ""),
        Role::Periods => ("output", "discrete", "calculated"),
    };
    let mut all = format!("causality=\"{causality}\" variability=\"{variability}\"");
    if !initial.is_empty() {
        _ = write!(all, " initial=\"{initial}\"");
    }
    let start = match variable.role {
        Role::State(_) | Role::Parameter | Role::Input => {
            format!(" start=\"{:e}\"", variable.start)
        }
        _ => String::new(),
    };
    (all, start)
}

/// The state whose derivative a variable is: its place in the list.
fn state_of(variables: &[Variable], role: Role) -> Option<usize> {
    let Role::Rate(state) = role else { return None };
    variables.iter().position(|v| v.role == Role::State(state))
}

fn is_output(variable: &Variable) -> bool {
    matches!(variable.role, Role::State(_) | Role::Output | Role::Periods)
}

/// Unknown at the start: everything that is calculated and that the structure lists.
fn is_initial_unknown(variable: &Variable) -> bool {
    matches!(variable.role, Role::Rate(_) | Role::Output | Role::Periods)
}

/// The elements of the structure in 3.0 and in 2.0, which has no list of indicators, with the variables in each.
type Listed = (&'static str, &'static str, fn(&Variable) -> bool);
const STRUCTURE: [Listed; 4] = [
    ("Output", "Outputs", is_output),
    ("ContinuousStateDerivative", "Derivatives", |v| {
        matches!(v.role, Role::Rate(_))
    }),
    ("InitialUnknown", "InitialUnknowns", is_initial_unknown),
    ("EventIndicator", "", |v| v.role == Role::Indicator),
];

/// The variables, and how they depend on each other.
fn variables_and_structure(version: FmiVersion, variables: &[Variable], text: &mut String) {
    // Indices count from one in 2.0.
    let first = usize::from(version == FmiVersion::Two);
    *text += "  <ModelVariables>\n";
    for (k, variable) in variables.iter().enumerate() {
        let (properties, start) = properties(variable);
        let [name, meaning, unit] =
            [&variable.name, &variable.meaning, &variable.unit].map(|t| attribute(t));
        let own = format!(
            "name=\"{name}\" valueReference=\"{k}\" description=\"{meaning}\" {properties}"
        );
        let derivative = state_of(variables, variable.role);
        let derivative =
            derivative.map_or_else(String::new, |s| format!(" derivative=\"{}\"", s + first));
        let is_count = variable.role == Role::Periods;
        let unit = if is_count {
            String::new()
        } else {
            format!(" unit=\"{unit}\"")
        };
        _ = match (version, is_count) {
            (FmiVersion::Three, true) => writeln!(text, "    <Int32 {own}/>"),
            (FmiVersion::Three, false) => {
                writeln!(text, "    <Float64 {own}{start}{unit}{derivative}/>")
            }
            // In 2.0 the start belongs to the type.
            (FmiVersion::Two, true) => writeln!(
                text,
                "    <ScalarVariable {own}><Integer/></ScalarVariable>"
            ),
            (FmiVersion::Two, false) => writeln!(
                text,
                "    <ScalarVariable {own}><Real{unit}{derivative}{start}/></ScalarVariable>"
            ),
        };
    }
    *text += "  </ModelVariables>\n  <ModelStructure>\n";
    for (element, list, is) in STRUCTURE {
        let listed = variables.iter().enumerate().filter(|(_, v)| is(v));
        let lines = |open: &str| -> String {
            listed
                .map(|(k, _)| format!("{open}{}\"/>\n", k + first))
                .collect()
        };
        match version {
            FmiVersion::Three => *text += &lines(&format!("    <{element} valueReference=\"")),
            FmiVersion::Two if list.is_empty() => {}
            FmiVersion::Two => {
                let unknowns = lines("      <Unknown index=\"");
                _ = write!(text, "    <{list}>\n{unknowns}    </{list}>\n");
            }
        }
    }
    *text += "  </ModelStructure>\n";
}

/// `sources/buildDescription.xml` of FMI 3.0.
pub(super) fn build_description(identifier: &str, needs_functions: bool) -> String {
    let library = if needs_functions {
        "    <Library name=\"m\" external=\"true\"/>\n"
    } else {
        ""
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration modelIdentifier=\"{identifier}\">\n    <SourceFileSet language=\"C99\">\n      <SourceFile name=\"{identifier}.c\"/>\n      <SourceFile name=\"fmi3.c\"/>\n    </SourceFileSet>\n{library}  </BuildConfiguration>\n</fmiBuildDescription>\n"
    )
}
