//! What becomes of a conservative motion of one freedom: its kinetic energy is what its start had, less
//! what the potential has grown since,
//!
//! ```text
//! E_c(q) = ½ m₀ q̇₀² + V(q₀) − V(q)                               (1)
//! ```
//!
//! It turns back where that falls to zero, creeps where it only just reaches zero at a summit of V, and
//! turns over where it never does. Steps of (1) are looked at with its derivative −V′, so that a summit
//! between two of them is seen.

use crate::conservative::{Conservative, Held, Loaded, limits};
use crate::error::DynamicsError;
use crate::free::State;
use crate::machine::Machine;
use crate::root;
use std::f64::consts::TAU;

/// Steps of a turn or of a limited range.
const STEPS: usize = 512;
/// Turns that are looked through where the mechanism never comes back.
const MOST_TURNS: usize = 64;
/// First step along a length that has no ends, m for each metre from its zero, and what the next grow by.
const FIRST_STEP: f64 = 1e-4;
const GROWTH: f64 = 1.02;
/// Steps along it.
const MOST_STEPS: usize = 2048;
/// Energies nearer than so many roundings are the same.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// So near a limit position, rad or m, it is reached: the inertia is infinite there.
const AT_LIMIT: f64 = 1e-9;

/// What becomes of a conservative motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// It passes the highest potential, and turns over.
    Turns {
        /// Where the potential is highest, rad.
        top: f64,
        /// Kinetic energy there, J.
        spare: f64,
        /// After which everything is as it was, rad.
        period: f64,
    },
    /// It swings between two turning points, rad or m.
    Swings {
        /// The lower and the upper one.
        between: [f64; 2],
    },
    /// It nears an unstable equilibrium, which it never reaches.
    Creeps {
        /// The equilibrium, rad or m.
        to: f64,
    },
    /// It is at rest in an equilibrium.
    Rests,
    /// It reaches an end of its range.
    Ends {
        /// The end, rad or m.
        at: f64,
    },
    /// It turned neither back nor over as far as it was followed.
    GoesOn {
        /// How far that was, rad or m.
        to: f64,
    },
}

/// What becomes of a machine of one freedom whose loads all have a potential.
///
/// # Errors
/// [`DynamicsError::NotConservative`], or what stands in the way of an evaluation.
pub fn fate(machine: &Machine, start: State) -> Result<Fate, DynamicsError> {
    Ok(Flight::new(&mut Loaded::new(machine)?, start)?.1)
}

/// What a motion meets on one side.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Met {
    Turn(f64),
    Summit(f64),
    End(f64),
    /// Nothing over a whole period; highest potential, and kinetic energy there.
    Nothing {
        top: f64,
        spare: f64,
    },
    Far(f64),
}

/// A motion by its start.
pub(crate) struct Flight<'a> {
    field: &'a mut dyn Conservative,
    pub(crate) q: f64,
    pub(crate) start: Held,
    /// Kinetic energy at the start, J.
    pub(crate) kinetic: f64,
    /// The largest energy met so far: what roundings are measured by.
    size: f64,
}

impl<'a> Flight<'a> {
    /// The motion from a start, and what becomes of it.
    pub(crate) fn new(
        field: &'a mut dyn Conservative,
        at: State,
    ) -> Result<(Self, Fate), DynamicsError> {
        let start = field.held(at.q)?;
        let kinetic = 0.5 * start.m * at.q_dot * at.q_dot;
        if at.q_dot != 0.0 && !kinetic.is_normal() {
            return Err(DynamicsError::BadEnergy {
                q_dot: at.q_dot,
                energy: kinetic,
            });
        }
        let mut flight = Self {
            field,
            q: at.q,
            start,
            kinetic,
            size: kinetic.max(start.potential.abs()),
        };
        let fate = flight.fate(at.q_dot)?;
        Ok((flight, fate))
    }

    fn fate(&mut self, q_dot: f64) -> Result<Fate, DynamicsError> {
        let ends = limits(self.field.range(), self.q)?;
        let period = self.field.repeats(self.q)?;
        if self.kinetic == 0.0 && self.in_equilibrium(ends, period)? {
            return Ok(Fate::Rests);
        }
        if let (true, None, Some(period)) = (self.field.level(), ends, period)
            && self.kinetic > 0.0
        {
            return Ok(Fate::Turns {
                top: self.q,
                spare: self.kinetic,
                period,
            });
        }
        let ahead = if q_dot == 0.0 {
            self.start.force.signum()
        } else {
            q_dot.signum()
        };
        let first = self.walk(ahead, ends, period)?;
        let back = match first {
            Met::Turn(_) if self.kinetic == 0.0 => Met::Turn(self.q),
            Met::Turn(_) => self.walk(-ahead, ends, period)?,
            other => other,
        };
        Ok(match (first, back) {
            (Met::Turn(one), Met::Turn(other)) => Fate::Swings {
                between: [one.min(other), one.max(other)],
            },
            (_, Met::Summit(to)) => Fate::Creeps { to },
            (_, Met::End(at)) => Fate::Ends { at },
            (_, Met::Nothing { top, spare }) => Fate::Turns {
                top,
                spare,
                period: period.unwrap_or(TAU),
            },
            (_, Met::Far(to) | Met::Turn(to)) => Fate::GoesOn { to },
        })
    }

    /// Whether nothing moves it from where it rests: its force is no more than the rounding of what is
    /// met nearby.
    fn in_equilibrium(
        &mut self,
        ends: Option<(f64, f64)>,
        period: Option<f64>,
    ) -> Result<bool, DynamicsError> {
        let (from, to) = ends.unwrap_or((self.q, self.q + period.unwrap_or(TAU)));
        let mut most = 0.0_f64;
        for k in 1..8 {
            let q = from + (to - from) * f64::from(k) / 8.0;
            most = most.max(self.field.held(q)?.force.abs());
        }
        Ok(self.start.force.abs() <= ROUNDING * most)
    }

    /// Kinetic energy, by (1), and the force.
    fn at(&mut self, q: f64) -> Result<(f64, f64), DynamicsError> {
        let held = self.field.held(q)?;
        self.size = self.size.max(held.potential.abs());
        let gained = self.start.potential - held.potential;
        Ok((self.kinetic + gained, held.force))
    }

    /// The first step, what the next grow by, and how many there are.
    fn stride(&self, ends: Option<(f64, f64)>, period: Option<f64>) -> (f64, f64, usize) {
        match (ends, period) {
            (Some((from, to)), _) => ((to - from) / STEPS as f64, 1.0, STEPS),
            (None, Some(period)) => (period / STEPS as f64, 1.0, STEPS),
            (None, None) if self.field.turns() => (TAU / STEPS as f64, 1.0, MOST_TURNS * STEPS),
            (None, None) => (FIRST_STEP * (1.0 + self.q.abs()), GROWTH, MOST_STEPS),
        }
    }

    /// Walks to one side until something is met.
    fn walk(
        &mut self,
        way: f64,
        ends: Option<(f64, f64)>,
        period: Option<f64>,
    ) -> Result<Met, DynamicsError> {
        let end = ends.map(|(from, to)| if way > 0.0 { to } else { from });
        let (mut step, growth, most) = self.stride(ends, period);
        let mut before = (self.q, self.kinetic, self.start.force * way);
        let (mut top, mut spare) = (self.q, self.kinetic);
        for k in 1..=most {
            let mut q = before.0 + way * step;
            if let Some(period) = period {
                // No rounding adds up on the way round.
                q = self.q + way * period * k as f64 / STEPS as f64;
            }
            let at_end = end.filter(|end| (q - end) * way >= -AT_LIMIT);
            if let Some(end) = at_end {
                q = end - way * AT_LIMIT;
                if (q - before.0) * way <= 0.0 {
                    return Ok(Met::End(end));
                }
            }
            let (kinetic, force) = match (self.at(q), at_end) {
                (Err(_), Some(end)) => return Ok(Met::End(end)),
                (found, _) => found?,
            };
            let now = (q, kinetic, force * way);
            if let Some(summit) = self.summit(before, now)? {
                let (left, _) = self.at(summit)?;
                if left.abs() <= ROUNDING * self.size {
                    return Ok(Met::Summit(summit));
                }
                if left < 0.0 {
                    return self.turn(before, summit).map(Met::Turn);
                }
                if left < spare {
                    (top, spare) = (summit, left);
                }
            } else if kinetic < -ROUNDING * self.size || (kinetic < 0.0 && at_end.is_some()) {
                // Less could be the rounding of a summit that comes next.
                return self.turn(before, q).map(Met::Turn);
            }
            if let Some(end) = at_end {
                return Ok(Met::End(end));
            }
            before = now;
            step *= growth;
        }
        Ok(match period {
            Some(_) => Met::Nothing { top, spare },
            None => Met::Far(before.0),
        })
    }

    /// A summit of the potential between two steps (coordinate, kinetic energy, force along the way).
    fn summit(
        &mut self,
        before: (f64, f64, f64),
        now: (f64, f64, f64),
    ) -> Result<Option<f64>, DynamicsError> {
        if !(before.2 < 0.0 && now.2 >= 0.0) {
            return Ok(None);
        }
        root::zero(|q| Ok(self.field.held(q)?.force), before.0, now.0)
    }

    /// The turning point between a step and a coordinate where no kinetic energy would be left.
    fn turn(&mut self, before: (f64, f64, f64), beyond: f64) -> Result<f64, DynamicsError> {
        let from = before.0;
        if self.kinetic == 0.0 && from == self.q {
            // From rest, the kinetic energy over the way has the force for its limit, and no zero at
            // the start.
            let mut found = |q: f64| {
                if q == from {
                    return Ok(self.start.force);
                }
                Ok::<_, DynamicsError>(self.at(q)?.0 / (q - from))
            };
            return Ok(root::zero(&mut found, from, beyond)?.unwrap_or(beyond));
        }
        let turned = root::zero(|q| Ok::<_, DynamicsError>(self.at(q)?.0), from, beyond)?;
        Ok(turned.unwrap_or(from))
    }
}
