//! The class of a conservative motion of one degree of freedom (rotation, libration, asymptotic …), from its kinetic
//! energy,
//!
//! ```text
//! E_c(q) = ½ m₀ q̇₀² + V(q₀) − V(q)                               (1)
//! ```
//!
//! It has a turning point where (1) falls to zero, is asymptotic where (1) just reaches zero at a maximum of V, and a
//! rotation where (1) stays positive over a period. The coordinate is scanned in steps; the derivative −V′ at their
//! ends shows a maximum of V within a step. Several steps are joined if E_c follows the cubic through its values and slopes at
//! the ends so closely that neither it nor its slope can have a zero between them: the error of the cubic is known at the middle.

use crate::conservative::{ConservativeSystem, EnergyTerms, LoadedSystem, limits};
use crate::error::{DynamicsError, Result};
use crate::machine::{Machine, MovingModel};
use crate::ode::ReducedState;
use dwell_numerics::root;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Steps of a period or of a limited range.
const SCAN_STEPS: usize = 512;
/// Numbers of steps that may be joined if they contain no event.
const STEPS_AT_ONCE: [usize; 4] = [16, 8, 4, 2];
/// How many times the error of the cubic at the middle the energy and its slope must be from zero.
const CUBIC_ERRORS: f64 = 16.0;
/// Revolutions that are scanned where the mechanism is not periodic.
const MAX_REVOLUTIONS: usize = 64;
/// First step along a length without limits, relative to 1 m + |q|, and the ratio of successive steps.
const FIRST_STEP: f64 = 1e-4;
const STEP_GROWTH: f64 = 1.02;
/// Steps along it.
const MAX_LENGTH_STEPS: usize = 2048;
/// Energies that differ by less, relatively, count as equal.
const ENERGY_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Distance, rad or m, at which a limit position counts as reached: the inertia is infinite there.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// The class of a conservative motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionClass {
    /// The coordinate passes the highest potential and grows by a period each time.
    Rotation {
        /// The coordinate at which the potential is highest, rad.
        potential_maximum_at: f64,
        /// Kinetic energy there, J.
        kinetic_at_maximum: f64,
        /// The angle after which everything repeats itself, rad.
        period: f64,
    },
    /// The coordinate oscillates between two turning points, rad or m.
    Libration {
        /// The lower and the upper one.
        turning_points: [f64; 2],
    },
    /// The motion approaches an unstable equilibrium, which it never reaches.
    Asymptotic {
        /// The equilibrium, rad or m.
        to: f64,
    },
    /// The motion is at rest in an equilibrium.
    Equilibrium,
    /// The coordinate reaches a limit of its range.
    ReachesLimit {
        /// The limit, rad or m.
        at: f64,
    },
    /// Neither a turning point nor a full period was found as far as the coordinate was scanned.
    Undecided {
        /// The coordinate at which the scan ended, rad or m.
        to: f64,
    },
}

/// The class of the motion of a machine of one degree of freedom whose loads all have a potential.
///
/// # Errors
/// [`DynamicsError::NotConservative`], or the error of an evaluation.
pub fn motion_class<M: MovingModel>(
    machine: &Machine<M>,
    start: ReducedState,
) -> Result<MotionClass> {
    Ok(EnergyScan::new(&mut LoadedSystem::new(machine)?, start)?.1)
}

/// The first result of a scan to one side.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ScanResult {
    TurningPoint(f64),
    /// The class of the motion is decided.
    Class(MotionClass),
}

/// A point of a scan: coordinate (rad or m), kinetic energy (J), and force in the direction of the scan.
type ScanPoint = (f64, f64, f64);

/// The points of a scan to one side by equal steps. The coordinates do not depend on earlier points.
struct EqualSteps {
    from: f64,
    /// Length of a step, rad or m, with the sign of the direction.
    step: f64,
    known: BTreeMap<usize, ScanPoint>,
    count: usize,
}

impl EqualSteps {
    fn at(&self, k: usize) -> f64 {
        self.from + self.step * k as f64
    }
}

/// Whether energy and force keep their signs between two points, by the point in their middle.
fn is_uneventful(before: ScanPoint, middle: ScanPoint, end: ScanPoint) -> bool {
    let width = (end.0 - before.0).abs();
    let cubic = 0.5 * (before.1 + end.1) + 0.125 * width * (before.2 - end.2);
    let slope = 1.5 * (end.1 - before.1) / width - 0.25 * (before.2 + end.2);
    let error = (middle.1 - cubic).abs();
    // Where the next term of E_c is c s²(w − s)², the slope errs by no more than 3.1 times the error at the middle over w.
    let slope_error = (middle.2 - slope).abs() + 4.0 * error / width;
    let points = [before, middle, end];
    let keeps = |force: f64| force > CUBIC_ERRORS * slope_error;
    (points.iter().all(|of| keeps(of.2)) || points.iter().all(|of| keeps(-of.2)))
        && points.iter().all(|of| of.1 > CUBIC_ERRORS * error)
}

/// The scan of the kinetic energy along the coordinate, from the start of a motion.
pub(crate) struct EnergyScan<'a> {
    system: &'a mut dyn ConservativeSystem,
    pub(crate) q: f64,
    pub(crate) initial_terms: EnergyTerms,
    /// Kinetic energy at the start, J.
    pub(crate) kinetic: f64,
    /// The largest energy so far, J: the scale of roundings.
    energy_scale: f64,
    range_limits: Option<(f64, f64)>,
    period: Option<f64>,
}

impl<'a> EnergyScan<'a> {
    /// The scan from a start, and the class of the motion.
    pub(crate) fn new(
        system: &'a mut dyn ConservativeSystem,
        at: ReducedState,
    ) -> Result<(Self, MotionClass)> {
        let initial_terms = system.energy_terms(at.q)?;
        let kinetic = 0.5 * initial_terms.m * at.q_dot * at.q_dot;
        if at.q_dot != 0.0 && !kinetic.is_normal() {
            return Err(DynamicsError::EnergyOutOfRange {
                q_dot: at.q_dot,
                energy: kinetic,
            });
        }
        let mut scan = Self {
            range_limits: limits(system.range(), at.q)?,
            period: system.period(at.q)?,
            system,
            q: at.q,
            initial_terms,
            kinetic,
            energy_scale: kinetic.max(initial_terms.potential.abs()),
        };
        let class = scan.motion_class(at.q_dot)?;
        Ok((scan, class))
    }

    fn motion_class(&mut self, q_dot: f64) -> Result<MotionClass> {
        if self.kinetic == 0.0 && self.in_equilibrium()? {
            return Ok(MotionClass::Equilibrium);
        }
        if let (None, Some(period)) = (self.range_limits, self.period)
            && self.system.is_potential_free()
            && self.kinetic > 0.0
        {
            return Ok(MotionClass::Rotation {
                potential_maximum_at: self.q,
                kinetic_at_maximum: self.kinetic,
                period,
            });
        }
        let direction = if q_dot == 0.0 {
            self.initial_terms.force.signum()
        } else {
            q_dot.signum()
        };
        let first = self.scan(direction)?;
        let back = match first {
            ScanResult::TurningPoint(_) if self.kinetic == 0.0 => ScanResult::TurningPoint(self.q),
            ScanResult::TurningPoint(_) => self.scan(-direction)?,
            other => other,
        };
        Ok(match (first, back) {
            (ScanResult::TurningPoint(one), ScanResult::TurningPoint(other)) => {
                MotionClass::Libration {
                    turning_points: [one.min(other), one.max(other)],
                }
            }
            (_, ScanResult::Class(class)) => class,
            (_, ScanResult::TurningPoint(to)) => MotionClass::Undecided { to },
        })
    }

    /// Whether the start is an equilibrium: the force there is below the rounding of the forces nearby.
    fn in_equilibrium(&mut self) -> Result<bool> {
        let one_period = (self.q, self.q + self.period.unwrap_or(TAU));
        let (from, to) = self.range_limits.unwrap_or(one_period);
        let mut max_force = 0.0_f64;
        for k in 1..8 {
            let q = from + (to - from) * f64::from(k) / 8.0;
            max_force = max_force.max(self.system.energy_terms(q)?.force.abs());
        }
        Ok(self.initial_terms.force.abs() <= ENERGY_ROUNDING * max_force)
    }

    /// Kinetic energy, by (1), and the force.
    fn kinetic_and_force(&mut self, q: f64) -> Result<(f64, f64)> {
        let terms = self.system.energy_terms(q)?;
        self.energy_scale = self.energy_scale.max(terms.potential.abs());
        let gained = self.initial_terms.potential - terms.potential;
        Ok((self.kinetic + gained, terms.force))
    }

    /// The first step, the ratio of successive steps, and their highest number.
    fn scan_steps(&self) -> (f64, f64, usize) {
        match (self.range_limits, self.period) {
            (Some((from, to)), _) => ((to - from) / SCAN_STEPS as f64, 1.0, SCAN_STEPS),
            (None, Some(period)) => (period / SCAN_STEPS as f64, 1.0, SCAN_STEPS),
            (None, None) if self.system.is_angle() => {
                (TAU / SCAN_STEPS as f64, 1.0, MAX_REVOLUTIONS * SCAN_STEPS)
            }
            (None, None) => (
                FIRST_STEP * (1.0 + self.q.abs()),
                STEP_GROWTH,
                MAX_LENGTH_STEPS,
            ),
        }
    }

    /// Scans to one side until a turning point, a potential maximum that cannot be passed, or a limit.
    // Long because it is one scan: what is found first decides.
    fn scan(&mut self, direction: f64) -> Result<ScanResult> {
        let period = self.period;
        let limits = self.range_limits;
        let end = limits.map(|(from, to)| if direction > 0.0 { to } else { from });
        let at_limit = |at| ScanResult::Class(MotionClass::ReachesLimit { at });
        let (mut step, growth, max_steps) = self.scan_steps();
        let mut equal_steps = EqualSteps {
            from: self.q,
            step: direction * step,
            known: BTreeMap::new(),
            count: if growth == 1.0 && !self.system.follows_functions() {
                max_steps
            } else {
                0
            },
        };
        let mut before = (self.q, self.kinetic, self.initial_terms.force * direction);
        let (mut potential_maximum_at, mut kinetic_at_maximum) = (self.q, self.kinetic);
        let mut k = 0;
        while k < max_steps {
            if let Some((steps, end)) = self.uneventful_steps(&mut equal_steps, k, before, end) {
                k += steps;
                before = end;
                continue;
            }
            k += 1;
            let mut q = if growth == 1.0 {
                // Roundings of steps do not add up.
                equal_steps.at(k)
            } else {
                before.0 + direction * step
            };
            let at_end = end.filter(|end| (q - end) * direction >= -LIMIT_TOLERANCE);
            if let Some(end) = at_end {
                q = end - direction * LIMIT_TOLERANCE;
                if (q - before.0) * direction <= 0.0 {
                    return Ok(at_limit(end));
                }
            }
            let known = equal_steps.known.remove(&k).filter(|known| known.0 == q);
            let now = match (known, at_end) {
                (Some(known), _) => known,
                (None, Some(end)) => match self.scan_point(q, direction) {
                    Ok(found) => found,
                    Err(_) => return Ok(at_limit(end)),
                },
                (None, None) => self.scan_point(q, direction)?,
            };
            let kinetic = now.1;
            if let Some(maximum) = self.potential_maximum(before, now)? {
                let (kinetic_left, _) = self.kinetic_and_force(maximum)?;
                if kinetic_left.abs() <= ENERGY_ROUNDING * self.energy_scale {
                    return Ok(ScanResult::Class(MotionClass::Asymptotic { to: maximum }));
                }
                if kinetic_left < 0.0 {
                    return self
                        .turning_point(before, maximum)
                        .map(ScanResult::TurningPoint);
                }
                if kinetic_left < kinetic_at_maximum {
                    (potential_maximum_at, kinetic_at_maximum) = (maximum, kinetic_left);
                }
            } else if kinetic < -ENERGY_ROUNDING * self.energy_scale
                || (kinetic < 0.0 && at_end.is_some())
            {
                // A smaller deficit could be the rounding of a maximum that comes next.
                return self.turning_point(before, q).map(ScanResult::TurningPoint);
            }
            if let Some(end) = at_end {
                return Ok(at_limit(end));
            }
            before = now;
            step *= growth;
        }
        Ok(ScanResult::Class(match period {
            Some(period) => MotionClass::Rotation {
                potential_maximum_at,
                kinetic_at_maximum,
                period,
            },
            None => MotionClass::Undecided { to: before.0 },
        }))
    }

    /// The point of a scan at `q`.
    fn scan_point(&mut self, q: f64, direction: f64) -> Result<ScanPoint> {
        let (kinetic, force) = self.kinetic_and_force(q)?;
        Ok((q, kinetic, force * direction))
    }

    /// The largest number of steps after the `k`-th that may be joined, with the point at their end; `None` if the next two may
    /// contain an event, or lead to the end of the range.
    fn uneventful_steps(
        &mut self,
        steps: &mut EqualSteps,
        k: usize,
        before: ScanPoint,
        end: Option<f64>,
    ) -> Option<(usize, ScanPoint)> {
        let direction = steps.step.signum();
        for count in STEPS_AT_ONCE {
            let to = steps.at(k + count);
            let leaves = end.is_some_and(|end| (to - end) * direction >= -LIMIT_TOLERANCE);
            if !k.is_multiple_of(count) || k + count > steps.count || leaves {
                continue;
            }
            let mut points = [before; 2];
            for (point, k) in points.iter_mut().zip([k + count / 2, k + count]) {
                *point = match steps.known.get(&k) {
                    Some(known) => *known,
                    // Who scans step by step says what is wrong.
                    None => self.scan_point(steps.at(k), direction).ok()?,
                };
                steps.known.insert(k, *point);
            }
            let [middle, last] = points;
            if is_uneventful(before, middle, last) {
                return Some((count, last));
            }
        }
        None
    }

    /// A maximum of the potential between two points.
    fn potential_maximum(&mut self, before: ScanPoint, now: ScanPoint) -> Result<Option<f64>> {
        if !(before.2 < 0.0 && now.2 >= 0.0) {
            return Ok(None);
        }
        root::find(|q| Ok(self.system.energy_terms(q)?.force), before.0, now.0)
    }

    /// The turning point between a point and a coordinate where the kinetic energy is negative.
    fn turning_point(&mut self, before: ScanPoint, beyond: f64) -> Result<f64> {
        let from = before.0;
        if self.kinetic == 0.0 && from == self.q {
            // From rest, the kinetic energy over the distance has the force as its limit, and no zero at the
            // start.
            let mut found = |q: f64| {
                if q == from {
                    return Ok(self.initial_terms.force);
                }
                Ok::<_, DynamicsError>(self.kinetic_and_force(q)?.0 / (q - from))
            };
            return Ok(root::find(&mut found, from, beyond)?.unwrap_or(beyond));
        }
        let kinetic = |q| Ok::<_, DynamicsError>(self.kinetic_and_force(q)?.0);
        Ok(root::find(kinetic, from, beyond)?.unwrap_or(from))
    }
}

#[cfg(test)]
mod tests;
