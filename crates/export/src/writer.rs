//! Common parts of the texts of all targets: names, members, lists, and the effects of loads.

use crate::export::Export;
use crate::identifiers::{Identifiers, comment};
use crate::machine::{LoadDescription, LoadEffect, Resistance};

/// The names of the functions and members of an export of one or several degrees of freedom.
pub(crate) struct Members<'a> {
    pub(crate) names: Identifiers,
    pub(crate) loads: &'a [LoadDescription],
    pub(crate) reactions: &'a [(String, &'static str)],
    pub(crate) points: &'a [String],
    pub(crate) freedoms: usize,
    /// The unit of the inertia that may be added along the coordinate; `None` if there are several.
    pub(crate) inertia_unit: Option<&'static str>,
}

impl<'a> Members<'a> {
    /// The members of a machine of one degree of freedom.
    pub(crate) fn new(export: &'a Export) -> Self {
        let machine = &export.machine;
        Self {
            names: Identifiers::new(machine),
            loads: &machine.loads,
            reactions: &machine.reactions,
            points: &machine.points,
            freedoms: 1,
            inertia_unit: Some(machine.inertia_unit()),
        }
    }

    pub(crate) fn has_reactions(&self) -> bool {
        !self.reactions.is_empty()
    }

    pub(crate) fn has_points(&self) -> bool {
        !self.points.is_empty()
    }

    pub(crate) fn has_loads(&self) -> bool {
        !self.loads.is_empty()
    }

    pub(crate) fn has_rotors(&self) -> bool {
        self.loads.iter().any(|load| load.effect.has_rotor())
    }

    pub(crate) fn has_potentials(&self) -> bool {
        self.conservative().next().is_some()
    }

    /// The conservative loads.
    pub(crate) fn conservative(&self) -> impl Iterator<Item = usize> {
        let loads = self.loads.iter().enumerate();
        let some = loads.filter(|(_, load)| load.effect.is_conservative());
        some.map(|(k, _)| k)
    }

    /// The loads with a current: their index, the name of the current, and its place in the state.
    pub(crate) fn currents(&self) -> Vec<(usize, String, usize)> {
        let loads = self.loads.iter().zip(&self.names.loads).enumerate();
        let some = loads.filter(|(_, (load, _))| load.effect.has_current());
        let places = some.zip(2 * self.freedoms..);
        places
            .map(|((k, (_, name)), place)| (k, format!("current_{name}"), place))
            .collect()
    }

    /// The numbers of a state: coordinates, velocities, currents.
    pub(crate) fn order(&self) -> usize {
        2 * self.freedoms + self.currents().len()
    }

    /// The members of a state of one degree of freedom that have rates.
    pub(crate) fn state_members(&self) -> Vec<String> {
        let currents = self.currents().into_iter().map(|(_, name, _)| name);
        let first = ["q", "q_dot"].map(str::to_owned);
        first.into_iter().chain(currents).collect()
    }

    /// Loads, reactions and points: the title of each list, and the name in capitals and the meaning of each entry.
    pub(crate) fn lists(&self) -> [(&'static str, Vec<[String; 2]>); 3] {
        let loads = self.loads.iter().map(|load| &load.name);
        let reactions = self.reactions.iter().map(|(name, _)| name);
        [
            ("LOAD", list(&self.names.loads, loads)),
            ("REACTION", list(&self.names.reactions, reactions)),
            ("POINT", list(&self.names.points, self.points)),
        ]
    }

    /// The members of the parameters: name, value and meaning.
    pub(crate) fn parameters(&self) -> Vec<(String, f64, String)> {
        let added = self.inertia_unit.map(|unit| {
            let meaning = format!("{unit}: added along the coordinate, such as a flywheel");
            ("added_inertia".to_owned(), 0.0, meaning)
        });
        let mut all = Vec::from_iter(added);
        for (load, name) in self.loads.iter().zip(&self.names.loads) {
            let unit = load.unit;
            let mut one = |what: &str, value, text: &str| {
                all.push((format!("{what}_{name}"), value, text.to_owned()));
            };
            match load.effect {
                LoadEffect::Conservative { magnitude } | LoadEffect::Constant { magnitude } => {
                    one("magnitude", magnitude, &format!("{unit}: magnitude"));
                }
                LoadEffect::Damper { damping, .. } => {
                    one("damping", damping, &format!("{unit}: constant"));
                }
                LoadEffect::Motor(motor) => {
                    let torque = motor.torque_constant;
                    one("torque_constant", torque, "N m/A: torque constant");
                    one("resistance", motor.resistance, "Ohm: not zero");
                    if load.effect.has_current() {
                        one("inductance", motor.inductance, "H: not zero");
                    }
                    one("gear_ratio", motor.gear_ratio, "1: gear ratio");
                    if load.effect.has_rotor() {
                        let inertia = motor.rotor_inertia;
                        one("rotor_inertia", inertia, "kg m2: inertia of the rotor");
                    }
                }
                LoadEffect::VariableDamper { .. } | LoadEffect::Input { .. } => {}
            }
        }
        all
    }

    /// The members of the inputs: name, value at the start and meaning.
    pub(crate) fn inputs(&self) -> Vec<(String, f64, String)> {
        let input = |(load, name): (&LoadDescription, &String)| {
            let (what, meaning) = match load.effect {
                LoadEffect::Input { .. } => ("load", format!("{}: force or couple", load.unit)),
                LoadEffect::VariableDamper { .. } => {
                    ("damping", format!("{}: constant of the damper", load.unit))
                }
                LoadEffect::Motor(_) => ("voltage", "V: voltage".to_owned()),
                LoadEffect::Conservative { .. }
                | LoadEffect::Constant { .. }
                | LoadEffect::Damper { .. } => return None,
            };
            Some((format!("{what}_{name}"), load.effect.scene_value(), meaning))
        };
        let loads = self.loads.iter().zip(&self.names.loads);
        loads.filter_map(input).collect()
    }
}

/// Names in capitals, with their meanings.
pub(crate) fn list<'a>(
    names: &[String],
    meanings: impl IntoIterator<Item = &'a String>,
) -> Vec<[String; 2]> {
    let both = names.iter().zip(meanings);
    both.map(|(name, meaning)| [name.to_ascii_uppercase(), comment(meaning)])
        .collect()
}

/// How code reaches the members of parameters, inputs and state, and writes zero.
pub(crate) struct Access {
    pub(crate) parameters: &'static str,
    pub(crate) inputs: &'static str,
    pub(crate) state: &'static str,
    pub(crate) zero: &'static str,
    /// The text before, between and after a condition and its two values.
    pub(crate) choice: [&'static str; 4],
}

impl Access {
    /// F of a load with this velocity, without the force that accelerates a rotor.
    pub(crate) fn force(&self, effect: &LoadEffect, name: &str, velocity: &str) -> String {
        let Self {
            parameters: p,
            inputs,
            state,
            ..
        } = self;
        match effect {
            LoadEffect::Conservative { .. } | LoadEffect::Constant { .. } => {
                format!("{p}magnitude_{name}")
            }
            LoadEffect::Input { .. } => format!("{inputs}load_{name}"),
            LoadEffect::Damper { law, .. } => self.resistance(*law, p, name, velocity),
            LoadEffect::VariableDamper { law, .. } => self.resistance(*law, inputs, name, velocity),
            LoadEffect::Motor(_) => {
                let constant = format!("({p}gear_ratio_{name} * {p}torque_constant_{name})");
                if effect.has_current() {
                    format!("{constant} * {state}current_{name}")
                } else {
                    format!(
                        "{constant} * ({inputs}voltage_{name} - {constant} * {velocity}) / {p}resistance_{name}"
                    )
                }
            }
        }
    }

    /// F of a resistance, whose damping is a member of `from`.
    fn resistance(&self, law: Resistance, from: &str, name: &str, velocity: &str) -> String {
        let (zero, q_dot) = (self.zero, format!("{}q_dot", self.state));
        match law {
            Resistance::Linear => format!("{zero} - {from}damping_{name} * {velocity}"),
            Resistance::Quadratic => {
                let [when, then, otherwise, end] = self.choice;
                let speed =
                    format!("{when}{q_dot} < {zero}{then}{zero} - {q_dot}{otherwise}{q_dot}{end}");
                format!("{from}damping_{name} * {speed} * {q_dot}")
            }
        }
    }

    /// The rate of the current of a motor with this velocity.
    pub(crate) fn current_rate(&self, name: &str, velocity: &str) -> String {
        let (p, inputs, state) = (self.parameters, self.inputs, self.state);
        format!(
            "({inputs}voltage_{name} - {p}resistance_{name} * {state}current_{name} - ({p}gear_ratio_{name} * {p}torque_constant_{name}) * {velocity}) / {p}inductance_{name}"
        )
    }
}

/// The inertia of a rotor along its load, N² J, from members of the parameters `p`.
pub(crate) fn reflected(p: &str, name: &str) -> String {
    format!("({p}gear_ratio_{name} * {p}gear_ratio_{name} * {p}rotor_inertia_{name})")
}
