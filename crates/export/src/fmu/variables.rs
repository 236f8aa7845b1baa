//! The variables of an FMU: names, units and where each is found in the C.

use crate::export::Export;
use crate::writer::Writer;

/// What a variable is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// The independent variable.
    Time,
    /// A state: its number.
    State(usize),
    /// The derivative of a state.
    Rate(usize),
    /// An output that follows from the others.
    Output,
    /// A constant that may be changed.
    Parameter,
    /// An input.
    Input,
    /// An event indicator.
    Indicator,
    /// The number of whole periods.
    Periods,
}

/// A variable. Its value reference is its place in the list.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) role: Role,
    pub(super) unit: String,
    pub(super) start: f64,
    pub(super) meaning: String,
    /// The C expression of its place in a model `m`, or of its value.
    pub(super) code: String,
}

/// Variables in their order.
#[derive(Default)]
struct List(Vec<Variable>);

impl List {
    fn add(&mut self, name: &str, role: Role, unit: &str, meaning: &str, code: String) {
        // Names of a scene may be those of FMI or of other parts.
        let numbered = (2_usize..).map(|k| format!("{name}_{k}"));
        let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
        let free = candidates.find(|one| self.0.iter().all(|other| other.name != *one));
        self.0.push(Variable {
            name: free.unwrap_or_default(),
            role,
            unit: unit.to_owned(),
            start: 0.0,
            meaning: meaning.to_owned(),
            code,
        });
    }

    /// The value at the start of the last one.
    fn starts_at(&mut self, start: f64) {
        if let Some(last) = self.0.last_mut() {
            last.start = start;
        }
    }
}

/// All variables of an export.
pub(super) fn variables(export: &Export) -> Vec<Variable> {
    let writer = Writer::new(export);
    let mut list = List::default();
    list.add("time", Role::Time, "s", "time", "m->time".to_owned());
    states(&writer, &mut list);
    outputs(&writer, &mut list);
    constants(&writer, &mut list);
    if export.machine.domain.revolutions > 0 {
        let unit = if export.machine.is_angle { "rad" } else { "m" };
        for (k, end) in ["upper", "lower"].iter().enumerate() {
            let (name, code) = (format!("next_period.{end}"), format!("indicators[{k}]"));
            let meaning = "distance from the end of the period";
            list.add(&name, Role::Indicator, unit, meaning, code);
        }
        let meaning = "whole periods of the coordinate";
        list.add("periods", Role::Periods, "", meaning, String::new());
    }
    list.0
}

/// States, each with its derivative behind it.
fn states(writer: &Writer<'_>, list: &mut List) {
    let machine = &writer.export.machine;
    let unit = if machine.is_angle { "rad" } else { "m" };
    let (rate, second) = (format!("{unit}/s"), format!("{unit}/s2"));
    let [start, speed] = machine.initial;
    let q = machine.coordinate.as_str();
    let code = |text: &str| text.to_owned();
    list.add(q, Role::State(0), unit, "coordinate", code("m->state.q"));
    list.starts_at(start);
    let name = format!("der({q})");
    list.add(&name, Role::Rate(0), &rate, "its rate", code("rates[0]"));
    let name = format!("{q}.velocity");
    list.add(
        &name,
        Role::State(1),
        &rate,
        "speed",
        code("m->state.q_dot"),
    );
    list.starts_at(speed);
    let name = format!("der({name})");
    list.add(
        &name,
        Role::Rate(1),
        &second,
        "acceleration",
        code("rates[1]"),
    );
    for (load, place) in writer.currents() {
        let name = format!("{}.current", machine.loads[load].name);
        let member = format!("m->state.current_{}", writer.names.loads[load]);
        list.add(&name, Role::State(place), "A", "current", member);
        let (name, rate) = (format!("der({name})"), format!("rates[{place}]"));
        list.add(&name, Role::Rate(place), "A/s", "its rate", rate);
    }
}

/// What follows from states, parameters and inputs.
fn outputs(writer: &Writer<'_>, list: &mut List) {
    let machine = &writer.export.machine;
    for (k, kind) in ["kinetic", "potential"].iter().enumerate() {
        let (name, meaning) = (format!("energy.{kind}"), format!("{kind} energy"));
        list.add(&name, Role::Output, "J", &meaning, format!("energies[{k}]"));
    }
    for (k, (name, unit)) in machine.reactions.iter().enumerate() {
        let unit = if *unit == "N" { "N" } else { "N.m" };
        let meaning = "action of the joint's first body on its second";
        list.add(name, Role::Output, unit, meaning, format!("reactions[{k}]"));
    }
    for (k, point) in machine.points.iter().enumerate() {
        for (axis, letter) in ["x", "y"].iter().enumerate() {
            let (name, code) = (format!("{point}.{letter}"), format!("xy[{}]", 2 * k + axis));
            list.add(&name, Role::Output, "m", "position", code);
        }
    }
}

/// Parameters and inputs.
fn constants(writer: &Writer<'_>, list: &mut List) {
    for (name, value, meaning) in writer.parameters() {
        let (unit, meaning) = meaning.split_once(": ").unwrap_or(("1", &meaning));
        let (path, code) = (
            format!("parameters.{name}"),
            format!("m->parameters.{name}"),
        );
        list.add(&path, Role::Parameter, &fmi_unit(unit), meaning, code);
        list.starts_at(value);
    }
    let meaning = "largest step of the co-simulation's integrator";
    let code = "m->max_step".to_owned();
    list.add("parameters.max_step", Role::Parameter, "s", meaning, code);
    list.starts_at(1e-3);
    for (_, name, value, meaning) in writer.inputs() {
        let (unit, meaning) = meaning.split_once(": ").unwrap_or(("1", &meaning));
        let (path, code) = (format!("inputs.{name}"), format!("m->inputs.{name}"));
        list.add(&path, Role::Input, &fmi_unit(unit), meaning, code);
        list.starts_at(value);
    }
}

/// A unit in the spelling of FMI: products with points.
fn fmi_unit(unit: &str) -> String {
    unit.replace(' ', ".").replace("Ohm", "ohm")
}

/// The base units of a unit: exponents of kg, m, s, A and rad.
pub(super) fn base_exponents(unit: &str) -> Option<[i32; 5]> {
    let one = |word: &str| -> Option<[i32; 5]> {
        let digits = word.find(|c: char| c.is_ascii_digit());
        let (name, power) = match digits {
            Some(0) | None => (word, 1),
            Some(at) => (&word[..at], word[at..].parse().ok()?),
        };
        let base = match name {
            "1" => [0, 0, 0, 0, 0],
            "kg" => [1, 0, 0, 0, 0],
            "m" => [0, 1, 0, 0, 0],
            "s" => [0, 0, 1, 0, 0],
            "A" => [0, 0, 0, 1, 0],
            "rad" => [0, 0, 0, 0, 1],
            "N" => [1, 1, -2, 0, 0],
            "J" => [1, 2, -2, 0, 0],
            "V" => [1, 2, -3, -1, 0],
            "ohm" => [1, 2, -3, -2, 0],
            "H" => [1, 2, -2, -2, 0],
            _ => return None,
        };
        Some(base.map(|exponent| exponent * power))
    };
    let mut sum = [0; 5];
    for (k, part) in unit.split('/').enumerate() {
        for word in part.split('.') {
            for (sum, exponent) in sum.iter_mut().zip(one(word)?) {
                *sum += if k == 0 { exponent } else { -exponent };
            }
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::base_exponents;

    #[test]
    fn units_have_their_base_units() {
        assert_eq!(base_exponents("N.m.s/rad"), Some([1, 2, -1, 0, -1]));
        assert_eq!(base_exponents("kg.m2"), Some([1, 2, 0, 0, 0]));
        assert_eq!(base_exponents("ohm"), base_exponents("V/A"));
        assert_eq!(base_exponents("furlong"), None);
    }
}
