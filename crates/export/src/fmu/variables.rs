//! The variables of an FMU: names, units and where each is found in the C.

use crate::export::Export;
use crate::writer::Members;

/// The role of a variable.
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
    fn add(
        &mut self,
        name: &str,
        role: Role,
        unit: &str,
        meaning: &str,
        code: &str,
    ) -> &mut Variable {
        // Names of a scene may be those of FMI or of other parts.
        let numbered = (2_usize..).map(|k| format!("{name}_{k}"));
        let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
        let free = candidates.find(|one| self.0.iter().all(|other| other.name != *one));
        let place = self.0.len();
        self.0.push(Variable {
            name: free.unwrap_or_default(),
            role,
            unit: unit.to_owned(),
            start: 0.0,
            meaning: meaning.to_owned(),
            code: code.to_owned(),
        });
        &mut self.0[place]
    }

    /// Adds a state by its index, name, member of the state and start value, followed by its derivative, with unit and
    /// meaning of both.
    fn add_state(
        &mut self,
        k: usize,
        name: &str,
        member: &str,
        start: f64,
        [own, rate]: [(&str, &str); 2],
    ) {
        let code = format!("m->state.{member}");
        self.add(name, Role::State(k), own.0, own.1, &code).start = start;
        let (name, code) = (format!("der({name})"), format!("rates[{k}]"));
        self.add(&name, Role::Rate(k), rate.0, rate.1, &code);
    }

    /// Members of the parameters or of the inputs.
    fn add_members(&mut self, of: &str, role: Role, members: Vec<(String, f64, String)>) {
        for (name, value, meaning) in members {
            let (unit, meaning) = meaning.split_once(": ").unwrap_or(("1", &meaning));
            let (path, unit) = (format!("{of}.{name}"), fmi_unit(unit));
            let code = format!("m->{path}");
            self.add(&path, role, &unit, meaning, &code).start = value;
        }
    }
}

/// All variables of an export.
pub(super) fn variables(export: &Export) -> Vec<Variable> {
    let members = Members::new(export);
    let mut list = List::default();
    list.add("time", Role::Time, "s", "time", "m->time");
    states(export, &members, &mut list);
    outputs(&members, &mut list);
    list.add_members("parameters", Role::Parameter, members.parameters());
    let (name, code) = ("parameters.max_step", "m->max_step");
    let meaning = "largest step of the co-simulation's integrator";
    list.add(name, Role::Parameter, "s", meaning, code).start = 1e-3;
    list.add_members("inputs", Role::Input, members.inputs());
    if export.machine.domain.revolutions > 0 {
        let unit = export.machine.unit();
        for (k, end) in ["upper", "lower"].iter().enumerate() {
            let (name, code) = (format!("next_period.{end}"), format!("indicators[{k}]"));
            let meaning = "distance from the end of the period";
            list.add(&name, Role::Indicator, unit, meaning, &code);
        }
        let meaning = "whole periods of the coordinate";
        list.add("periods", Role::Periods, "", meaning, "");
    }
    list.0
}

/// Adds the states, each followed by its derivative.
fn states(export: &Export, members: &Members<'_>, list: &mut List) {
    let machine = &export.machine;
    let unit = machine.unit();
    let (rate, second) = (format!("{unit}/s"), format!("{unit}/s2"));
    let [start, speed] = machine.initial;
    let (q, velocity) = (
        &machine.coordinate,
        format!("{}.velocity", machine.coordinate),
    );
    let meanings = [(unit, "coordinate"), (&rate, "its rate")];
    list.add_state(0, q, "q", start, meanings);
    let meanings = [(rate.as_str(), "speed"), (&second, "acceleration")];
    list.add_state(1, &velocity, "q_dot", speed, meanings);
    for (load, member, place) in members.currents() {
        let name = format!("{}.current", machine.loads[load].name);
        let meanings = [("A", "current"), ("A/s", "its rate")];
        list.add_state(place, &name, &member, 0.0, meanings);
    }
}

/// Adds the outputs, which follow from states, parameters and inputs.
fn outputs(members: &Members<'_>, list: &mut List) {
    for (k, kind) in ["kinetic", "potential"].iter().enumerate() {
        let (name, meaning) = (format!("energy.{kind}"), format!("{kind} energy"));
        let code = format!("energies[{k}]");
        list.add(&name, Role::Output, "J", &meaning, &code);
    }
    for (k, (name, unit)) in members.reactions.iter().enumerate() {
        let unit = if *unit == "N" { "N" } else { "N.m" };
        let meaning = "action of the joint's first body on its second";
        let code = format!("reactions[{k}]");
        list.add(name, Role::Output, unit, meaning, &code);
    }
    for (k, point) in members.points.iter().enumerate() {
        for (axis, letter) in ["x", "y"].iter().enumerate() {
            let (name, code) = (format!("{point}.{letter}"), format!("xy[{}]", 2 * k + axis));
            list.add(&name, Role::Output, "m", "position", &code);
        }
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
