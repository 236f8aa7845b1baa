//! Drives in the equation of motion: their checked and compiled form, and their evaluation by the equations
//! of [`dwell_kinetostatics::drive`].

use dwell_kinetostatics::{Drive, DriveKind, MachineModel, Magnitude, Model};
use dwell_laws::SwitchKind;
use dwell_numerics::Scalar;

/// A drive that does not fit a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("drive {drive}: {what}")]
pub struct DriveError {
    /// Index of the drive.
    pub drive: usize,
    /// The fault.
    pub what: &'static str,
}

/// A drive ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CompiledDrive<M: MachineModel = Model> {
    /// Its load in the model.
    pub(crate) load: usize,
    pub(crate) measured: M::CoordinateFunction,
    /// Its state (current in A, or integral in rad or m), by its index among the drives' states.
    pub(crate) state: Option<usize>,
    /// N² J, kg m² or kg.
    pub(crate) reflected_inertia: f64,
    /// Its input: a force, a voltage or a reference speed.
    pub(crate) input: Magnitude<M::Coordinate>,
    law: DriveLaw,
}

/// The pieces on which a drive's two switching functions are held; none: as its input and speed say.
pub(crate) type HeldDrive = [Option<f64>; 2];

#[derive(Debug, Clone, Copy, PartialEq)]
enum DriveLaw {
    AppliedForce,
    /// k N, R and L.
    Motor([f64; 3]),
    /// P, I and the limit.
    SpeedController([f64; 3]),
}

impl<M: MachineModel> CompiledDrive<M> {
    /// Checks and compiles drives.
    ///
    /// # Errors
    /// The first [`DriveError`].
    pub(crate) fn compile_all(
        model: &M,
        drives: &[Drive<M::Coordinate>],
        first_load: usize,
    ) -> Result<Vec<Self>, DriveError> {
        let mut states = 0;
        let compiled = drives.iter().enumerate().map(|(i, drive)| {
            let wrong = |what| DriveError { drive: i, what };
            Self::new(model, drive, first_load + i, &mut states).map_err(wrong)
        });
        compiled.collect()
    }

    fn new(
        model: &M,
        drive: &Drive<M::Coordinate>,
        load: usize,
        states: &mut usize,
    ) -> Result<Self, &'static str> {
        let measured = model.coordinate_function(drive.coordinate)?;
        let mut state = |wanted: bool| {
            let index = *states;
            *states += usize::from(wanted);
            wanted.then_some(index)
        };
        let not_negative = |numbers: &[f64]| numbers.iter().all(|n| n.is_finite() && *n >= 0.0);
        let (law, reflected_inertia, state) = match &drive.kind {
            DriveKind::AppliedForce(_) => (DriveLaw::AppliedForce, 0.0, None),
            DriveKind::Motor(m) => {
                let finite = m.torque_constant.is_finite() && m.gear_ratio.is_finite();
                let positive = not_negative(&[m.inductance, m.rotor_inertia, m.resistance]);
                if !(finite && positive) || m.resistance == 0.0 {
                    return Err("a motor needs a resistance above zero, no number below zero");
                }
                let constant = m.torque_constant * m.gear_ratio;
                let law = DriveLaw::Motor([constant, m.resistance, m.inductance]);
                let reflected_inertia = m.gear_ratio * m.gear_ratio * m.rotor_inertia;
                (law, reflected_inertia, state(m.inductance > 0.0))
            }
            DriveKind::SpeedController(r) => {
                let [proportional, integral] = [r.proportional_gain, r.integral_gain];
                if !(not_negative(&[proportional, integral]) && r.limit > 0.0) {
                    return Err(
                        "a speed controller needs gains of zero or more and a limit above zero",
                    );
                }
                let law = DriveLaw::SpeedController([proportional, integral, r.limit]);
                (law, 0.0, state(integral > 0.0))
            }
        };
        let input = drive.kind.input().clone();
        match input {
            Magnitude::Friction(_) | Magnitude::Separating(_) | Magnitude::External(_) => {
                return Err(
                    "the input of a drive is neither friction, a separating force nor the force of another drive",
                );
            }
            Magnitude::Constant(_)
            | Magnitude::Law(..)
            | Magnitude::Expression(..)
            | Magnitude::Function(..) => {}
        }
        Ok(Self {
            load,
            measured,
            state,
            reflected_inertia,
            input,
            law,
        })
    }

    /// The values of its two [switching functions](Self::switch_values) at which the drive switches.
    pub(crate) fn switch_kinds(&self) -> Vec<SwitchKind> {
        match self.law {
            DriveLaw::AppliedForce | DriveLaw::Motor(_) => Vec::new(),
            DriveLaw::SpeedController([_, _, limit]) if limit.is_finite() => {
                vec![SwitchKind::Knots(vec![-limit, limit]), SwitchKind::Zero]
            }
            DriveLaw::SpeedController(_) => Vec::new(),
        }
    }

    /// For a speed controller: the torque or force without its limit, and the error of the speed. Both are linear, so that the rates
    /// of the arguments give their rates.
    pub(crate) fn switch_values(&self, input: f64, speed: f64, state: Option<f64>) -> [f64; 2] {
        match self.law {
            DriveLaw::AppliedForce | DriveLaw::Motor(_) => [f64::NAN; 2],
            DriveLaw::SpeedController([proportional, integral, _]) => {
                let error = input - speed;
                [
                    state.unwrap_or(0.0) * integral + error * proportional,
                    error,
                ]
            }
        }
    }

    /// The force on the coordinate (without the rotor's inertia) and the rate of the drive's state, for
    /// an input and the coordinate's speed, on the pieces that are held.
    #[inline]
    pub(crate) fn eval<T: Scalar>(
        &self,
        input: T,
        speed: T,
        state: Option<T>,
        [within, sign]: HeldDrive,
    ) -> (T, T) {
        let zero = T::from_f64(0.0);
        match self.law {
            DriveLaw::AppliedForce => (input, zero),
            DriveLaw::Motor([constant, resistance, inductance]) => {
                let constant = T::from_f64(constant);
                let net_voltage = input - constant * speed;
                match state {
                    None => (constant * net_voltage / T::from_f64(resistance), zero),
                    Some(current) => {
                        let rate = net_voltage - current * T::from_f64(resistance);
                        (constant * current, rate / T::from_f64(inductance))
                    }
                }
            }
            DriveLaw::SpeedController([proportional, integral, limit]) => {
                let error = input - speed;
                let sum = state.unwrap_or(zero) * T::from_f64(integral)
                    + error * T::from_f64(proportional);
                // Below, between or above its limits.
                let natural = match sum.value() {
                    sum if sum.abs() <= limit => 1.0,
                    sum => 1.0 + sum.signum(),
                };
                let beyond = within.unwrap_or(natural) - 1.0;
                if beyond == 0.0 {
                    return (sum, error);
                }
                let saturated = sign.unwrap_or(error.value()) * beyond > 0.0;
                let rate = if saturated { zero } else { error };
                (T::from_f64(limit * beyond), rate)
            }
        }
    }
}
