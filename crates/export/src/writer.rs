//! What the texts of all targets share: names, members and what there is.

use crate::evaluator::has_rotor;
use crate::export::Export;
use crate::identifiers::Identifiers;
use crate::machine::{LoadDescription, LoadEffect, PartKind};
use crate::part::Part;

/// An export with the names of its functions and members.
pub(crate) struct Writer<'a> {
    pub(crate) export: &'a Export,
    pub(crate) names: Identifiers,
}

impl<'a> Writer<'a> {
    pub(crate) fn new(export: &'a Export) -> Self {
        Self {
            export,
            names: Identifiers::new(&export.machine),
        }
    }

    pub(crate) fn part(&self, kind: PartKind) -> &Part {
        &self.export.parts[kind as usize]
    }

    pub(crate) fn has_reactions(&self) -> bool {
        !self.export.machine.reactions.is_empty()
    }

    pub(crate) fn has_points(&self) -> bool {
        !self.export.machine.points.is_empty()
    }

    pub(crate) fn has_loads(&self) -> bool {
        !self.export.machine.loads.is_empty()
    }

    pub(crate) fn has_rotors(&self) -> bool {
        let mut loads = self.export.machine.loads.iter();
        loads.any(|load| has_rotor(&load.effect))
    }

    pub(crate) fn has_potentials(&self) -> bool {
        let mut loads = self.export.machine.loads.iter();
        loads.any(|load| load.effect.is_conservative())
    }

    /// The loads with a current: their index, and the place of the current in the state.
    pub(crate) fn currents(&self) -> Vec<(usize, usize)> {
        let has_current = |effect: &LoadEffect| effect.motor().is_some_and(|m| m.inductance > 0.0);
        let loads = self.export.machine.loads_where(has_current);
        loads.zip(2..).collect()
    }

    /// The members of the parameters: name, value and meaning.
    pub(crate) fn parameters(&self) -> Vec<(String, f64, String)> {
        let machine = &self.export.machine;
        let inertia = if machine.is_angle { "kg m2" } else { "kg" };
        let added = format!("{inertia}: added along the coordinate, such as a flywheel");
        let mut all = vec![("added_inertia".to_owned(), 0.0, added)];
        all.extend(load_parameters(&machine.loads, &self.names.loads));
        all
    }

    /// The members of the inputs: load, name, value at the start and meaning.
    pub(crate) fn inputs(&self) -> Vec<(usize, String, f64, String)> {
        load_inputs(&self.export.machine.loads, &self.names.loads)
    }
}

/// The parameters of loads: name, value and meaning.
pub(crate) fn load_parameters(
    loads: &[LoadDescription],
    names: &[String],
) -> Vec<(String, f64, String)> {
    let mut all = Vec::new();
    for (load, name) in loads.iter().zip(names) {
        let unit = load.unit;
        let mut one = |what: &str, value, text: &str| {
            all.push((format!("{what}_{name}"), value, text.to_owned()));
        };
        match load.effect {
            LoadEffect::Conservative { magnitude } | LoadEffect::Constant { magnitude } => {
                one("magnitude", magnitude, &format!("{unit}: magnitude"));
            }
            LoadEffect::Damper { damping } => {
                one("damping", damping, &format!("{unit}: constant"));
            }
            LoadEffect::Motor(motor) => {
                let torque = motor.torque_constant;
                one("torque_constant", torque, "N m/A: torque constant");
                one("resistance", motor.resistance, "Ohm: not zero");
                if motor.inductance > 0.0 {
                    one("inductance", motor.inductance, "H: not zero");
                }
                one("gear_ratio", motor.gear_ratio, "1: gear ratio");
                if motor.rotor_inertia != 0.0 {
                    let inertia = motor.rotor_inertia;
                    one("rotor_inertia", inertia, "kg m2: inertia of the rotor");
                }
            }
            LoadEffect::VariableDamper { .. } | LoadEffect::Input { .. } => {}
        }
    }
    all
}

/// The inputs of loads: load, name, value at the start and meaning.
pub(crate) fn load_inputs(
    loads: &[LoadDescription],
    names: &[String],
) -> Vec<(usize, String, f64, String)> {
    let input = |(k, (load, name)): (usize, (&LoadDescription, &String))| {
        let unit = load.unit;
        match load.effect {
            LoadEffect::Input { initial } => {
                let text = format!("{unit}: force or couple");
                Some((k, format!("load_{name}"), initial, text))
            }
            LoadEffect::VariableDamper { initial } => {
                let text = format!("{unit}: constant of the damper");
                Some((k, format!("damping_{name}"), initial, text))
            }
            LoadEffect::Motor(motor) => {
                let (name, text) = (format!("voltage_{name}"), "V: voltage".to_owned());
                Some((k, name, motor.initial_voltage, text))
            }
            LoadEffect::Conservative { .. }
            | LoadEffect::Constant { .. }
            | LoadEffect::Damper { .. } => None,
        }
    };
    let loads = loads.iter().zip(names).enumerate();
    loads.filter_map(input).collect()
}
