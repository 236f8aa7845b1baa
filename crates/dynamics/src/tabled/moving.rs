//! A machine's table as a system to be integrated, with its exact Jacobian: dual numbers through the pieces.

use super::{Actor, Felt, How, Signal, Tabled};
use crate::equation::positive;
use crate::error::DynamicsError;
use crate::system::System;
use dwell_geometry::{Dual, Scalar};
use dwell_kinetostatics::KinetostaticsError;

/// A table with the working memory to integrate it, for one thread. Its states are those of
/// [`Moving`](crate::Moving).
#[derive(Debug, Clone)]
pub struct OnTable<'t> {
    tabled: &'t Tabled,
    plain: Room<f64>,
    dual: Room<Dual>,
    y: Vec<Dual>,
    out: Vec<Dual>,
    /// What works are measured by.
    scale: f64,
}

/// Working memory in one kind of number.
#[derive(Debug, Clone)]
struct Room<T> {
    columns: Vec<T>,
    numbers: Vec<T>,
    values: Vec<f64>,
}

impl<T: Scalar> Room<T> {
    fn new(tabled: &Tabled) -> Self {
        let counts = tabled.actors.iter().map(|actor| actor.signals.len());
        let most = counts.max().unwrap_or(0);
        Self {
            columns: vec![T::lift(0.0); tabled.width],
            numbers: vec![T::lift(0.0); most],
            values: vec![0.0; most],
        }
    }
}

/// What a load or drive does at one state.
struct Done<T> {
    /// F of a load, the action of a drive.
    force: T,
    /// What that gives the coordinate.
    given: T,
    /// Of a drive with a state of its own: its place among such states, and its rate.
    memory: Option<(usize, T)>,
}

impl Tabled {
    /// Number of states: q, q̇, those of the drives, the works.
    pub fn states(&self) -> usize {
        2 + self.memory + self.actors.len()
    }

    /// The machine about to move on its table, from a state whose energies give the works their scale.
    ///
    /// # Errors
    /// [`DynamicsError`] where the start cannot be evaluated.
    pub fn moving(&self, t: f64, y: &[f64]) -> Result<OnTable<'_>, DynamicsError> {
        let mut plain = Room::new(self);
        let [q, q_dot] = [y[0], y[1]];
        let [kinetic, _] = self.energy(q, q_dot)?;
        self.columns.at(q, &mut plain.columns, &mut [])?;
        let mut scale = kinetic;
        for (k, actor) in self.actors.iter().enumerate() {
            let done = self.act(k, t, y, &mut plain)?;
            if matches!(actor.how, How::Drives(_)) {
                scale += done.force.abs();
            }
        }
        let zero = vec![Dual::lift(0.0); self.states()];
        Ok(OnTable {
            tabled: self,
            plain,
            dual: Room::new(self),
            y: zero.clone(),
            out: zero,
            scale: if scale.is_normal() { scale } else { 1.0 },
        })
    }

    /// ẏ at time `t` and state `y`.
    fn rates<T: Scalar>(
        &self,
        t: f64,
        y: &[T],
        room: &mut Room<T>,
        out: &mut [T],
    ) -> Result<(), DynamicsError> {
        let (q, q_dot) = (y[0], y[1]);
        let [m, half_dm] = self.inertia.at(q)?;
        let mut force = -(half_dm * q_dot * q_dot);
        if let Some(potential) = &self.potential {
            let [_, half_dv] = potential.at(q)?;
            force += half_dv * T::lift(-2.0);
        }
        self.columns.at(q, &mut room.columns, &mut [])?;
        for k in 0..self.actors.len() {
            let done = self.act(k, t, y, room)?;
            force += done.given;
            out[2 + self.memory + k] = done.given * q_dot;
            if let Some((place, rate)) = done.memory {
                out[2 + place] = rate;
            }
        }
        positive(m.value(), q.value())?;
        out[0] = q_dot;
        out[1] = force / m;
        Ok(())
    }

    /// What a load or drive does at a state of which the columns are known.
    fn act<T: Scalar>(
        &self,
        k: usize,
        t: f64,
        y: &[T],
        room: &mut Room<T>,
    ) -> Result<Done<T>, DynamicsError> {
        let Actor {
            load,
            magnitude,
            signals,
            how,
        } = &self.actors[k];
        let Room {
            columns,
            numbers,
            values,
        } = room;
        let (q_dot, w) = (y[1], columns[k]);
        let sensed = numbers.iter_mut().zip(values.iter_mut()).zip(signals);
        for ((number, value), signal) in sensed {
            *number = signal.of(t, y, columns);
            *value = number.value();
        }
        let count = signals.len();
        let magnitude = magnitude.of(&numbers[..count], &values[..count]);
        if !magnitude.value().is_finite() {
            let error = KinetostaticsError::MagnitudeNotFinite { load: *load };
            return Err(DynamicsError::Load(error));
        }
        let plain = |force: T| Done {
            force,
            given: force * w,
            memory: None,
        };
        Ok(match how {
            How::Acts => plain(magnitude),
            // w is that of one unit of resistance, −ds/dq.
            How::Damps => plain(-(magnitude * w * q_dot)),
            How::Drives(drive) => {
                let state = drive.state.map(|place| y[2 + place]);
                let (action, rate) = drive.act(magnitude, w * q_dot, state);
                Done {
                    memory: drive.state.map(|place| (place, rate)),
                    ..plain(action)
                }
            }
        })
    }
}

impl Signal {
    fn of<T: Scalar>(self, t: f64, y: &[T], columns: &[T]) -> T {
        match self {
            Self::Time => T::lift(t),
            Self::Value(felt) => felt.of(y[0], columns),
            Self::Speed(felt) => felt.of(y[0], columns) * y[1],
        }
    }
}

impl Felt {
    fn of<T: Scalar>(self, q: T, columns: &[T]) -> T {
        let line = T::lift(self.slope) * q + T::lift(self.offset);
        self.column.map_or(line, |column| line + columns[column])
    }
}

impl System for OnTable<'_> {
    fn size(&self) -> usize {
        self.tabled.states()
    }

    fn rates(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.tabled.rates(t, y, &mut self.plain, out)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        let n = self.size();
        out.fill(0.0);
        // No rate depends on the works.
        for j in 0..2 + self.tabled.memory {
            for (i, (dual, &value)) in self.y.iter_mut().zip(y).enumerate() {
                *dual = if i == j {
                    Dual::variable(value)
                } else {
                    Dual::lift(value)
                };
            }
            self.tabled
                .rates(t, &self.y, &mut self.dual, &mut self.out)?;
            for (i, rate) in self.out.iter().enumerate() {
                out[i * n + j] = rate.d;
            }
        }
        Ok(())
    }

    fn weight(&self, state: usize) -> f64 {
        if state < 2 + self.tabled.memory {
            1.0
        } else {
            self.scale
        }
    }
}
