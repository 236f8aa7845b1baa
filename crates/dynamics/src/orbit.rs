//! The conservative motion of a mechanism of one freedom, by quadrature: no integrator.
//!
//! Its kinetic energy E_c(q) follows from its coordinate. Of a phase s that grows by 2π in a period,
//!
//! ```text
//! turning    q = q₀ + P s/2π             dt/ds = (P/2π) √(m / 2E_c)        (1)
//! swinging   q = (a + b)/2 − h cos s     dt/ds = √(m / 2g)                 (2)
//!            g = E_c / ((q − a)(b − q)),   h = (b − a)/2
//! t(s) = c₀ s + Σ (c_k sin ks + s_k (1 − cos ks)) / k                     (3)
//! T = ∮ dt/ds ds = 2π c₀                                                  (4)
//! ```
//!
//! with P what everything repeats itself after, a and b the turning points, and c_k, s_k the Fourier
//! coefficients of dt/ds. Both kinds of dt/ds are smooth and periodic, so that the trapezoid rule has all
//! digits of (4) and (3) all of the time history. Where dt/ds is too sharp for equal steps, next to a summit
//! or where next to nothing resists, it is summed by panels.

use crate::conservative::{Conservative, Held, Loaded, Unloaded};
use crate::error::DynamicsError;
use crate::fate::{Fate, Flight};
use crate::fourier::{MANY, Series, refine};
use crate::free::State;
use crate::machine::Machine;
use crate::panels::{Panels, Slowness};
use crate::swing::Swing;
use dwell_kinetostatics::Reduced;
use std::f64::consts::TAU;

/// Steps of Newton's method, halvings among them, to a phase.
const MOST_STEPS: usize = 100;

/// A conservative motion that repeats itself, known at every time.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    start: State,
    /// Time of one period, s.
    pub period: f64,
    /// Kinetic and potential energy, J.
    pub energy: f64,
    /// The largest kinetic energy at the points of the rule, J.
    pub kinetic: f64,
    /// Points of the rule that resolved it.
    pub points: usize,
    /// The last Fourier coefficients as a part of the mean: what rounding leaves in a point.
    pub rounding: f64,
    /// Whether it turns or swings, and where.
    pub fate: Fate,
    way: Way,
    /// Phase of the start, and the time (s) from phase zero to it.
    phase: f64,
    lead: f64,
    /// dt/ds, s/rad.
    slowness: Slowness,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// Growth of the coordinate in a period, rad.
    Turning(f64),
    /// The turning points.
    Swinging([f64; 2]),
}

impl Orbit {
    /// The motion of a model without loads.
    ///
    /// # Errors
    /// [`DynamicsError::NoFullTurn`], [`DynamicsError::AtRest`], [`DynamicsError::BadEnergy`],
    /// [`DynamicsError::NoInertia`], or [`DynamicsError::NotResolved`] when the inertia varies too
    /// sharply.
    pub fn new<R: Reduced>(model: &R, start: State) -> Result<Self, DynamicsError> {
        Self::within(model, start, 0.0)
    }

    /// The same with a rule of only so many points that what it leaves is below this part of the mean: the time
    /// then errs by about this part of a period.
    ///
    /// # Errors
    /// As [`Orbit::new`].
    pub fn within<R: Reduced>(
        model: &R,
        start: State,
        accuracy: f64,
    ) -> Result<Self, DynamicsError> {
        let work = model.work();
        Self::of(&mut Unloaded { model, work }, start, accuracy)
    }

    /// The motion of a machine of one freedom whose loads all have a potential.
    ///
    /// # Errors
    /// As [`Orbit::new`]; [`DynamicsError::NotConservative`], [`DynamicsError::Creeps`],
    /// [`DynamicsError::GoesOn`].
    pub fn loaded(machine: &Machine, start: State) -> Result<Self, DynamicsError> {
        Self::of(&mut Loaded::new(machine)?, start, 0.0)
    }

    fn of(
        field: &mut dyn Conservative,
        start: State,
        accuracy: f64,
    ) -> Result<Self, DynamicsError> {
        let range = field.range();
        let (flight, fate) = Flight::new(&mut *field, start)?;
        let (held, kinetic) = (flight.start, flight.kinetic);
        match fate {
            Fate::Turns { period, .. } => {
                let along = period * start.q_dot.signum();
                Self::turning(field, (start, held, kinetic), (along, fate), accuracy)
            }
            Fate::Swings { between } => Self::swinging(field, start, (held, kinetic), between),
            Fate::Creeps { to: q } => Err(DynamicsError::Creeps { q }),
            Fate::Rests => Err(DynamicsError::AtRest),
            Fate::GoesOn { to: q } => Err(DynamicsError::GoesOn { q }),
            Fate::Ends { at } => {
                let (from, to) = range.limits().unwrap_or((at, at));
                Err(DynamicsError::NoFullTurn { from, to })
            }
        }
    }

    fn turning(
        field: &mut dyn Conservative,
        (start, held, kinetic): (State, Held, f64),
        (along, fate): (f64, Fate),
        accuracy: f64,
    ) -> Result<Self, DynamicsError> {
        // The same position without its whole turns, which would cost it digits.
        let first = start.q % along;
        let mut known: Vec<Held> = Vec::new();
        loop {
            known = refine(known, |part| field.held(first + along * part))?;
            let mut values = Vec::with_capacity(known.len());
            let mut most = 0.0_f64;
            for at in &known {
                let left = kinetic + (held.potential - at.potential);
                most = most.max(left);
                values.push(along.abs() / TAU * (at.m / (2.0 * left)).sqrt());
            }
            let points = known.len();
            let size = values.iter().sum::<f64>() / points as f64;
            let series = Series::new(&values, size);
            let (slowness, points) = if series.resolved || series.left < accuracy {
                (Slowness::Even(series), points)
            } else if points >= MANY {
                let panels = Panels::new(|phase| {
                    let at = field.held(first + along * (phase / TAU))?;
                    let left = kinetic + (held.potential - at.potential);
                    Ok(along.abs() / TAU * (at.m / (2.0 * left)).sqrt())
                })?;
                let taken = points + panels.points;
                (Slowness::Sharp(panels), taken)
            } else {
                continue;
            };
            return Ok(Self {
                start,
                period: TAU * slowness.mean(),
                energy: kinetic + held.potential,
                kinetic: most,
                points,
                rounding: slowness.left(),
                fate,
                way: Way::Turning(along),
                phase: 0.0,
                lead: 0.0,
                slowness,
            });
        }
    }

    fn swinging(
        field: &mut dyn Conservative,
        start: State,
        (held, kinetic): (Held, f64),
        between: [f64; 2],
    ) -> Result<Self, DynamicsError> {
        let swing = Swing::new(field, start.q, kinetic, between)?;
        let up = swing.phase(start.q);
        let phase = if start.q_dot < 0.0 { TAU - up } else { up };
        let [_, lead] = swing.slowness.at(phase);
        Ok(Self {
            start,
            period: TAU * swing.slowness.mean(),
            energy: kinetic + held.potential,
            kinetic: swing.most,
            points: swing.points,
            rounding: swing.slowness.left(),
            fate: Fate::Swings {
                between: swing.ends,
            },
            way: Way::Swinging(swing.ends),
            phase,
            lead,
            slowness: swing.slowness,
        })
    }

    /// Where it starts.
    pub fn start(&self) -> State {
        self.start
    }

    /// The first time (s), not before the start, at which the coordinate is `q` (rad or m), by (3); of a
    /// turning motion also the time before. None where a swing never comes.
    pub fn time_at(&self, q: f64) -> Option<f64> {
        match self.way {
            Way::Turning(along) => {
                let way = (q - self.start.q) / along;
                let turns = way.floor();
                let [_, within] = self.slowness.at(TAU * (way - turns));
                Some(self.start.t + self.period * turns + within)
            }
            Way::Swinging(ends) => {
                let up = phase_of(q, ends)?;
                let first = [up, TAU - up, TAU + up]
                    .into_iter()
                    .find(|&phase| phase >= self.phase);
                let [_, time] = self.slowness.at(first.unwrap_or(2.0 * TAU - up));
                Some(self.start.t + time - self.lead)
            }
        }
    }

    /// The state at time `t` (s), by Newton's method on (3).
    pub fn at(&self, t: f64) -> State {
        let periods = ((t - self.start.t) / self.period).floor();
        let wanted = t - self.start.t - periods * self.period + self.lead;
        let (mut low, mut high) = (self.phase, self.phase + TAU);
        let mut phase = low + (wanted - self.lead) / self.period * TAU;
        for _ in 0..MOST_STEPS {
            let [slowness, time] = self.slowness.at(phase);
            let off = wanted - time;
            if off > 0.0 {
                low = phase;
            } else {
                high = phase;
            }
            let mut next = phase + off / slowness;
            if !(low..=high).contains(&next) {
                next = 0.5 * (low + high);
            }
            let step = (next - phase).abs();
            phase = next;
            if step <= 4.0 * f64::EPSILON * (1.0 + phase) {
                break;
            }
        }
        let [slowness, _] = self.slowness.at(phase);
        let (q, by_phase) = match self.way {
            Way::Turning(along) => (self.start.q + along * (periods + phase / TAU), along / TAU),
            Way::Swinging([a, b]) => {
                let (sin, cos) = phase.sin_cos();
                let half = 0.5 * (b - a);
                (a + half * (1.0 - cos), half * sin)
            }
        };
        State {
            t,
            q,
            q_dot: by_phase / slowness,
        }
    }
}

/// The phase of the way up at which a swing passes `q`; none if it does not.
pub(crate) fn phase_of(q: f64, [a, b]: [f64; 2]) -> Option<f64> {
    let [from, to] = [q - a, b - q];
    (from >= 0.0 && to >= 0.0).then(|| 2.0 * from.sqrt().atan2(to.sqrt()))
}
