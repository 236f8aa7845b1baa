//! A machine whose functions are closed forms, with a load of every effect.

use dwell_export::{
    Domain, Export, FitError, Function, FunctionSampler, LoadDescription, LoadEffect,
    MachineDescription, Motor, PartKind, Precision, ReferenceSizes, Request, Resistance,
};
use std::convert::Infallible;
use std::f64::consts::TAU;

/// The closed forms.
pub(crate) struct ClosedForms(pub(crate) MachineDescription);

/// m and ½m′: with a narrow peak, so that cells differ in width.
pub(crate) fn inertia(q: f64) -> [f64; 2] {
    let (bottom, slope) = (1.3 - q.cos(), q.sin());
    let m = 0.7 + 0.2 / bottom + 0.1 * (2.0 * q).sin();
    let dm = -0.2 * slope / (bottom * bottom) + 0.2 * (2.0 * q).cos();
    [m, 0.5 * dm]
}

/// The potential of one unit of the weight, and half its slope.
pub(crate) fn potential(q: f64) -> [f64; 2] {
    [
        0.4 * q.sin() + 0.05 * (3.0 * q).cos(),
        0.2 * q.cos() - 0.075 * (3.0 * q).sin(),
    ]
}

/// w of the loads that have no potential: constant force, damper, input, motor.
pub(crate) fn w(load: usize, q: f64) -> f64 {
    match load {
        1 => 0.3 * q.sin(),
        2 => 0.7 + 0.2 * q.cos(),
        3 => 1.0,
        _ => 1.0 + 0.3 * q.sin(),
    }
}

/// a, b and c of the reactions.
pub(crate) fn a(k: usize, q: f64) -> f64 {
    (q + k as f64).cos()
}

pub(crate) fn b(k: usize, q: f64) -> f64 {
    (q - k as f64).sin() / (1.5 + q.cos())
}

pub(crate) fn c(load: usize, k: usize, q: f64) -> f64 {
    if load == 3 {
        0.0
    } else {
        0.1 * (q * (1 + k) as f64 + load as f64).cos()
    }
}

pub(crate) fn position(axis: usize, q: f64) -> f64 {
    if axis == 0 {
        0.1 * q.cos()
    } else {
        0.1 * q.sin()
    }
}

impl FunctionSampler for ClosedForms {
    type Error = Infallible;

    fn sample(
        &mut self,
        part: PartKind,
        q: f64,
        curves: &mut [[f64; 2]],
        columns: &mut [f64],
    ) -> Result<(), Infallible> {
        for (out, function) in curves.iter_mut().zip(self.0.curves(part)) {
            *out = match function {
                Function::Inertia => inertia(q),
                _ => potential(q),
            };
        }
        for (out, function) in columns.iter_mut().zip(self.0.columns(part)) {
            *out = match function {
                Function::W(load) => w(load, q),
                Function::A(k) => a(k, q),
                Function::B(k) => b(k, q),
                Function::C(load, k) => c(load, k, q),
                Function::Position(_, axis) => position(axis, q),
                Function::Inertia | Function::Potential(_) => unreachable!("curves"),
            };
        }
        Ok(())
    }
}

/// A machine with every kind of load; `inductance` above zero gives its motor a current.
pub(crate) fn machine(inductance: f64) -> MachineDescription {
    let load = |name: &str, effect, unit| LoadDescription {
        name: name.to_owned(),
        effect,
        unit,
    };
    MachineDescription {
        name: "test-machine".to_owned(),
        title: "A machine of closed forms".to_owned(),
        scene_hash: "0".to_owned(),
        version: "0.1.0".to_owned(),
        coordinate: "phi".to_owned(),
        is_angle: true,
        domain: Domain {
            from: 0.0,
            to: TAU,
            revolutions: 1,
        },
        initial: [0.3, 1.0],
        loads: vec![
            load(
                "weight",
                LoadEffect::Conservative { magnitude: 2.0 },
                "m/s2",
            ),
            load("push", LoadEffect::Constant { magnitude: 0.5 }, "N"),
            load(
                "oil",
                LoadEffect::Damper {
                    damping: 0.05,
                    law: Resistance::Linear,
                },
                "N m s/rad",
            ),
            load("brake", LoadEffect::Input { initial: -0.1 }, "N m"),
            load(
                "motor",
                LoadEffect::Motor(Motor {
                    torque_constant: 0.2,
                    resistance: 1.5,
                    inductance,
                    gear_ratio: 3.0,
                    rotor_inertia: 0.01,
                    initial_voltage: 4.0,
                }),
                "V",
            ),
        ],
        reactions: vec![
            ("A.x".to_owned(), "N"),
            ("A.y".to_owned(), "N"),
            ("A.moment".to_owned(), "N m"),
        ],
        points: vec!["crank.P".to_owned()],
        sizes: ReferenceSizes {
            inertia: 1.0,
            length: 1.0,
            unit_loads: vec![1.0; 5],
        },
        left_out: vec![],
    }
}

/// The same without loads, reactions and points.
pub(crate) fn bare() -> MachineDescription {
    MachineDescription {
        loads: vec![],
        reactions: vec![],
        points: vec![],
        sizes: ReferenceSizes {
            inertia: 1.0,
            length: 1.0,
            unit_loads: vec![],
        },
        initial: [0.0, 1.0],
        ..machine(0.0)
    }
}

pub(crate) fn export(machine: MachineDescription, accuracy: f64, precision: Precision) -> Export {
    let request = Request {
        accuracy,
        precision,
    };
    let mut sampler = ClosedForms(machine.clone());
    Export::new(machine, request, &mut sampler).unwrap_or_else(|e: FitError<_>| panic!("{e}"))
}
