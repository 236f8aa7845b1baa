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

/// All variables of an export.
pub(super) fn variables(export: &Export) -> Vec<Variable> {
    let writer = Writer::new(export);
    let machine = &export.machine;
    let mut all = Vec::new();
    let mut add = |name: String, role, unit: &str, start, meaning: &str, code: String| {
        all.push(Variable {
            name,
            role,
            unit: unit.to_owned(),
            start,
            meaning: meaning.to_owned(),
            code,
        });
    };
    let q = machine.coordinate.as_str();
    let unit = if machine.is_angle { "rad" } else { "m" };
    let (rate, second) = (format!("{unit}/s"), format!("{unit}/s2"));
    let [start, speed] = machine.initial;
    add(
        "time".to_owned(),
        Role::Time,
        "s",
        0.0,
        "time",
        "m->time".to_owned(),
    );
    add(
        q.to_owned(),
        Role::State(0),
        unit,
        start,
        "coordinate",
        "m->state.q".to_owned(),
    );
    add(
        format!("der({q})"),
        Role::Rate(0),
        &rate,
        0.0,
        "its rate",
        "rates[0]".to_owned(),
    );
    let name = format!("{q}.velocity");
    add(
        name.clone(),
        Role::State(1),
        &rate,
        speed,
        "speed",
        "m->state.q_dot".to_owned(),
    );
    let acceleration = format!("der({name})");
    add(
        acceleration,
        Role::Rate(1),
        &second,
        0.0,
        "acceleration",
        "rates[1]".to_owned(),
    );
    for (load, place) in writer.currents() {
        let name = format!("{}.current", machine.loads[load].name);
        let code = format!("m->state.current_{}", writer.names.loads[load]);
        add(name.clone(), Role::State(place), "A", 0.0, "current", code);
        let code = format!("rates[{place}]");
        add(
            format!("der({name})"),
            Role::Rate(place),
            "A/s",
            0.0,
            "its rate",
            code,
        );
    }
    for (k, (name, meaning)) in [
        ("energy.kinetic", "kinetic energy"),
        ("energy.potential", "potential energy"),
    ]
    .into_iter()
    .enumerate()
    {
        add(
            name.to_owned(),
            Role::Output,
            "J",
            0.0,
            meaning,
            format!("energies[{k}]"),
        );
    }
    for (k, (name, unit)) in machine.reactions.iter().enumerate() {
        let unit = if *unit == "N" { "N" } else { "N.m" };
        let code = format!("reactions[{k}]");
        add(
            name.clone(),
            Role::Output,
            unit,
            0.0,
            "action of the joint's first body on its second",
            code,
        );
    }
    for (k, name) in machine.points.iter().enumerate() {
        for (axis, letter) in ["x", "y"].iter().enumerate() {
            let code = format!("xy[{}]", 2 * k + axis);
            add(
                format!("{name}.{letter}"),
                Role::Output,
                "m",
                0.0,
                "position",
                code,
            );
        }
    }
    for (name, value, meaning) in writer.parameters() {
        let (unit, meaning) = meaning.split_once(": ").unwrap_or(("1", &meaning));
        let code = format!("m->parameters.{name}");
        add(
            format!("parameters.{name}"),
            Role::Parameter,
            &fmi_unit(unit),
            value,
            meaning,
            code,
        );
    }
    let meaning = "largest step of the co-simulation's integrator";
    add(
        "parameters.max_step".to_owned(),
        Role::Parameter,
        "s",
        1e-3,
        meaning,
        "m->max_step".to_owned(),
    );
    for (_, name, value, meaning) in writer.inputs() {
        let (unit, meaning) = meaning.split_once(": ").unwrap_or(("1", &meaning));
        let code = format!("m->inputs.{name}");
        add(
            format!("inputs.{name}"),
            Role::Input,
            &fmi_unit(unit),
            value,
            meaning,
            code,
        );
    }
    if machine.domain.revolutions > 0 {
        for (k, name) in ["upper", "lower"].iter().enumerate() {
            let name = format!("next_period.{name}");
            let code = format!("indicators[{k}]");
            add(
                name,
                Role::Indicator,
                unit,
                0.0,
                "distance from the end of the period",
                code,
            );
        }
        add(
            "periods".to_owned(),
            Role::Periods,
            "",
            0.0,
            "whole periods of the coordinate",
            String::new(),
        );
    }
    all
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
