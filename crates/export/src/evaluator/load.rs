//! The effect of a load at a state, with the value of its parameter or input in the scene.

use crate::machine::{LoadDescription, LoadEffect, Resistance};
use dwell_numerics::Real;

/// A load in one kind of number.
#[derive(Debug, Clone)]
pub(crate) struct Load<R> {
    pub(crate) effect: LoadEffect,
    /// The value of its parameter or input in the scene.
    pub(crate) value: R,
    /// For a motor: N k, R, L, N² J.
    motor: [R; 4],
    /// The index of its current in the state.
    current: Option<usize>,
}

impl<R: Real> Load<R> {
    /// The loads of a machine, and the numbers of its state: coordinates, velocities, currents.
    pub(crate) fn all(loads: &[LoadDescription], freedoms: usize) -> (Vec<Self>, usize) {
        let mut order = 2 * freedoms;
        let load = |LoadDescription { effect, .. }: &LoadDescription| {
            let motor = effect.motor().map_or([R::of(0.0); 4], |m| {
                let [ratio, torque, resistance, inductance, inertia] =
                    m.constants().map(|value| R::of(value));
                [
                    ratio * torque,
                    resistance,
                    inductance,
                    ratio * ratio * inertia,
                ]
            });
            let current = effect.has_current().then_some(order);
            order += usize::from(current.is_some());
            Self {
                effect: *effect,
                value: R::of(effect.scene_value()),
                motor,
                current,
            }
        };
        (loads.iter().map(load).collect(), order)
    }

    /// F at a state, without the force that accelerates a rotor. `along` multiplies by the velocity of the load, w q̇.
    pub(crate) fn force(&self, y: &[R], along: impl Fn(R) -> R) -> R {
        let [constant, resistance, ..] = self.motor;
        match (&self.effect, self.current) {
            (LoadEffect::Damper { law, .. } | LoadEffect::VariableDamper { law, .. }, _) => {
                match law {
                    Resistance::Linear => R::of(0.0) - along(self.value),
                    Resistance::Quadratic => self.value * (y[1] * y[1]).sqrt() * y[1],
                }
            }
            (LoadEffect::Motor(_), Some(place)) => constant * y[place],
            (LoadEffect::Motor(_), None) => constant * (self.value - along(constant)) / resistance,
            _ => self.value,
        }
    }

    /// The index of its current in the state, and the rate of the current.
    pub(crate) fn current_rate(&self, y: &[R], along: impl Fn(R) -> R) -> Option<(usize, R)> {
        let place = self.current?;
        let [constant, resistance, inductance, _] = self.motor;
        let net = self.value - resistance * y[place] - along(constant);
        Some((place, net / inductance))
    }

    /// The inertia of its rotor along the load, N² J.
    pub(crate) fn rotor(&self) -> Option<R> {
        self.effect.has_rotor().then_some(self.motor[3])
    }

    /// The potential of loads with the potentials of one unit of each, J.
    pub(crate) fn potential<'a>(loads: impl Iterator<Item = (&'a Self, &'a R)>) -> R
    where
        R: 'a,
    {
        let conservative = loads.filter(|(load, _)| load.effect.is_conservative());
        conservative.fold(R::of(0.0), |sum, (load, v)| sum + load.value * *v)
    }
}
