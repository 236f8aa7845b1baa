//! What the loads do at one state of motion: their magnitudes, and the forces and couples that
//! they put on the bodies.

use crate::kinetostatics::KinetostaticsError;
use crate::ledger::meeting;
use crate::load::{Load, LoadKind, Magnitude, Signal};
use crate::mass::Mass;
use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::{ActuatorId, BodyId, JointId, Mechanism, Plan, Scalar, Vec2};
use thiserror::Error;

/// Who acts on a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// A load, by its index in the model.
    Load(usize),
    /// A joint.
    Joint(JointId),
    /// An actuator.
    Actuator(ActuatorId),
}

/// A force and a couple on one body, in ground axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Act<T = f64> {
    /// Who acts.
    pub by: By,
    /// The body it acts on; the ground may be one.
    pub body: BodyId,
    /// The force, N.
    pub force: Vec2<T>,
    /// From the body's root to the point where the force acts, m.
    pub arm: Vec2<T>,
    /// The couple beside it, N·m.
    pub couple: T,
}

impl<T: Scalar> Act<T> {
    /// The point where the force acts, in the ground's frame, m.
    pub fn point(&self, states: &BodyStates<T>) -> Vec2<T> {
        states.origin().lift() + states.body(self.body).root + self.arm
    }

    /// What it works at, W.
    pub fn power(&self, states: &BodyStates<T>) -> T {
        let body = states.body(self.body);
        self.force.dot(body.velocity_at(self.arm)) + self.couple * body.spin
    }

    /// Its moment about the body's root, N·m.
    pub fn moment(&self) -> T {
        self.arm.cross(self.force) + self.couple
    }
}

/// A load that cannot be taken into a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("load {load}: {what}")]
pub struct LoadError {
    /// Index of the load.
    pub load: usize,
    /// What is wrong with it.
    pub what: &'static str,
}

/// What a magnitude depends on, ready to be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sense {
    Time,
    Value(Measured),
    Speed(Measured),
}

/// The loads of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Loads {
    pub(crate) loads: Vec<Load>,
    /// By load: what its magnitude depends on.
    senses: Vec<Vec<Sense>>,
    /// By load: where a couple between two bodies stands on each.
    stands: Vec<[Vec2; 2]>,
    /// The bodies that have weight, with mass and centre.
    weights: Vec<(BodyId, Mass)>,
}

/// The loads at one state of motion: working memory, and what it holds afterwards.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadState<T = f64> {
    /// By load: its magnitude F, in the unit of its kind.
    pub magnitude: Vec<T>,
    /// What the loads do to the bodies, in the order of the loads.
    pub acts: Vec<Act<T>>,
    /// The acceleration of gravity of all such loads together, m/s².
    pub gravity: Vec2<T>,
    /// By body: the sum of the forces on it, N, and their moment about its root, N·m.
    pub(crate) force: Vec<Vec2<T>>,
    pub(crate) moment: Vec<T>,
    /// By carried body: the forces on it and on all that it carries, N.
    pub(crate) borne: Vec<Vec2<T>>,
    values: Vec<f64>,
}

impl Loads {
    pub(crate) fn find(
        mechanism: &Mechanism,
        plan: &Plan,
        masses: &[Mass],
        loads: Vec<Load>,
    ) -> Result<Self, LoadError> {
        let mut senses = Vec::with_capacity(loads.len());
        for (i, load) in loads.iter().enumerate() {
            let wrong = |what| LoadError { load: i, what };
            check(mechanism, load).map_err(wrong)?;
            senses.push(sense(mechanism, load).map_err(wrong)?);
        }
        let stands = loads.iter().map(|load| match load.kind {
            LoadKind::Torque { bodies }
            | LoadKind::TorsionSpring { bodies, .. }
            | LoadKind::TorsionDamper { bodies } => meeting(mechanism, plan, bodies),
            _ => [Vec2::ZERO; 2],
        });
        let stands = stands.collect();
        let weight = |body: BodyId| {
            let mass = masses.get(body.0).copied()?;
            (mass.mass > 0.0).then_some((body, mass))
        };
        let weights = plan.carried().iter().filter_map(|c| weight(BodyId(c.body)));
        Ok(Self {
            loads,
            senses,
            stands,
            weights: weights.collect(),
        })
    }

    pub(crate) fn state<T: Scalar>(&self, plan: &Plan) -> LoadState<T> {
        let bodies = plan.frames().attitudes.len();
        let acts = self.loads.iter().map(|load| match load.kind {
            LoadKind::Gravity { .. } => self.weights.len(),
            LoadKind::Force { .. } => 1,
            _ => 2,
        });
        LoadState {
            magnitude: vec![T::lift(0.0); self.loads.len()],
            acts: Vec::with_capacity(acts.sum()),
            gravity: Vec2::zero(),
            force: vec![Vec2::zero(); bodies],
            moment: vec![T::lift(0.0); bodies],
            borne: vec![Vec2::zero(); plan.carried().len()],
            values: vec![0.0; self.senses.iter().map(Vec::len).max().unwrap_or(0)],
        }
    }

    /// The magnitudes at time `t` (s).
    pub(crate) fn magnitudes(
        &self,
        t: f64,
        states: &BodyStates,
        out: &mut LoadState,
    ) -> Result<(), KinetostaticsError> {
        for (i, (load, senses)) in self.loads.iter().zip(&self.senses).enumerate() {
            for (value, &sense) in out.values.iter_mut().zip(senses) {
                *value = match sense {
                    Sense::Time => t,
                    Sense::Value(measured) => states.measure(measured)[0],
                    Sense::Speed(measured) => states.measure(measured)[1],
                };
            }
            let values = &out.values[..senses.len()];
            let magnitude = match (&load.magnitude, values) {
                (Magnitude::Constant(value), _) => *value,
                (Magnitude::Law(_, law), &[x, ..]) => law.at(x)[0],
                (Magnitude::Law(..), []) => f64::NAN,
                (Magnitude::Expression(expression, _), values) => expression.at(values),
            };
            if !magnitude.is_finite() {
                return Err(KinetostaticsError::MagnitudeNotFinite { load: i });
            }
            out.magnitude[i] = magnitude;
        }
        Ok(())
    }

    /// What the loads do to the bodies at the magnitudes in `out`.
    pub(crate) fn act<T: Scalar>(
        &self,
        states: &BodyStates<T>,
        out: &mut LoadState<T>,
    ) -> Result<(), KinetostaticsError> {
        out.acts.clear();
        out.gravity = Vec2::zero();
        for (i, load) in self.loads.iter().enumerate() {
            let f = out.magnitude[i];
            if let LoadKind::Gravity { direction } = load.kind {
                let pull = direction.lift() * f;
                out.gravity += pull;
                for &(body, Mass { mass, center, .. }) in &self.weights {
                    out.acts.push(Act {
                        by: By::Load(i),
                        body,
                        force: pull * T::lift(mass),
                        arm: states.body(body).arm(center),
                        couple: T::lift(0.0),
                    });
                }
                continue;
            }
            let [first, second] = ends(load.kind, f, states, self.stands[i])
                .ok_or(KinetostaticsError::NoDirection { load: i })?
                .map(|end| {
                    end.map(|(body, force, arm, couple)| Act {
                        by: By::Load(i),
                        body,
                        force,
                        arm,
                        couple,
                    })
                });
            out.acts.extend(first.into_iter().chain(second));
        }
        out.force.fill(Vec2::zero());
        out.moment.fill(T::lift(0.0));
        for act in &out.acts {
            out.force[act.body.0] += act.force;
            out.moment[act.body.0] += act.moment();
        }
        Ok(())
    }

    /// The potential energy of a load, J, where it has one.
    pub(crate) fn potential(&self, load: usize, states: &BodyStates) -> Option<f64> {
        let Load {
            kind,
            magnitude: Magnitude::Constant(f),
            ..
        } = self.loads.get(load)?
        else {
            return None;
        };
        match *kind {
            LoadKind::Gravity { direction } => {
                let heights = self.weights.iter().map(|&(body, mass)| {
                    mass.mass * states.point(body, mass.center).position.dot(direction)
                });
                Some(-f * heights.sum::<f64>())
            }
            LoadKind::Force {
                body,
                point,
                direction,
                follows: false,
            } => Some(-f * states.point(body, point).position.dot(direction)),
            LoadKind::Spring {
                bodies,
                points,
                free,
            } => {
                let stretch = states.separation(bodies, points).length - free;
                Some(0.5 * f * stretch * stretch)
            }
            LoadKind::TorsionSpring { bodies, free } => {
                let wound = states.angle(bodies)[0] - free;
                Some(0.5 * f * wound * wound)
            }
            _ => None,
        }
    }
}

type End<T> = Option<(BodyId, Vec2<T>, Vec2<T>, T)>;

/// The body, force, arm and couple at each end of a load of magnitude `f`; none where it has no
/// direction.
fn ends<T: Scalar>(
    kind: LoadKind,
    f: T,
    states: &BodyStates<T>,
    stands: [Vec2; 2],
) -> Option<[End<T>; 2]> {
    let zero = T::lift(0.0);
    let couples = |bodies: [BodyId; 2], couple: T| {
        let end = |i: usize, couple| {
            let arm = states.body(bodies[i]).arm(stands[i]);
            Some((bodies[i], Vec2::zero(), arm, couple))
        };
        Some([end(0, -couple), end(1, couple)])
    };
    // Between two points: what pulls the first along the line is the opposite of the second's.
    let along = |bodies: [BodyId; 2], points: [Vec2; 2], force: Vec2<T>| {
        let end = |i: usize, force| {
            let arm = states.body(bodies[i]).arm(points[i]);
            Some((bodies[i], force, arm, zero))
        };
        Some([end(0, -force), end(1, force)])
    };
    match kind {
        LoadKind::Gravity { .. } => Some([None, None]),
        LoadKind::Force {
            body,
            point,
            direction,
            follows,
        } => {
            let state = states.body(body);
            let mut unit = direction.lift();
            if follows {
                unit = unit.turn(state.turn);
            }
            Some([Some((body, unit * f, state.arm(point), zero)), None])
        }
        LoadKind::Torque { bodies } => couples(bodies, f),
        LoadKind::Spring {
            bodies,
            points,
            free,
        } => {
            let between = states.separation(bodies, points);
            // −k (P₂ − P₁) + k free e: the first part is smooth where the points meet.
            let mut force = -(between.gap * f);
            if free != 0.0 && f.value() != 0.0 {
                force += between.direction? * (f * T::lift(free));
            }
            along(bodies, points, force)
        }
        LoadKind::TorsionSpring { bodies, free } => {
            couples(bodies, -(f * (states.angle(bodies)[0] - T::lift(free))))
        }
        LoadKind::Damper { bodies, points } => {
            let between = states.separation(bodies, points);
            let rate = between.rate;
            let still = f.value() == 0.0 || (rate.x.value() == 0.0 && rate.y.value() == 0.0);
            let force = if still {
                Vec2::zero()
            } else {
                let e = between.direction?;
                -(e * (e.dot(rate) * f))
            };
            along(bodies, points, force)
        }
        LoadKind::TorsionDamper { bodies } => couples(bodies, -(f * states.angle(bodies)[1])),
    }
}

fn sense(mechanism: &Mechanism, load: &Load) -> Result<Vec<Sense>, &'static str> {
    let signals = load.magnitude.signals();
    if let Magnitude::Expression(expression, _) = &load.magnitude
        && expression.variables().len() > signals.len()
    {
        return Err("its expression has more variables than signals");
    }
    let unknown = "its magnitude depends on a coordinate that the mechanism does not have";
    let find = |coordinate| Measured::find(mechanism, coordinate).ok_or(unknown);
    let sense = |signal: &Signal| match *signal {
        Signal::Time => Ok(Sense::Time),
        Signal::Value(coordinate) => find(coordinate).map(Sense::Value),
        Signal::Speed(coordinate) => find(coordinate).map(Sense::Speed),
    };
    signals.iter().map(sense).collect()
}

/// Refuses a load that does not fit the mechanism.
fn check(mechanism: &Mechanism, load: &Load) -> Result<(), &'static str> {
    let there = |bodies: &[BodyId]| bodies.iter().all(|b| b.0 < mechanism.bodies.len());
    // A unit vector to rounding, from any way of normalising it.
    let unit = |v: Vec2| (v.norm() - 1.0).abs() < 1e-9;
    let finite = |points: &[Vec2]| points.iter().all(|p| p.is_finite());
    let (bodies, sound): (&[BodyId], bool) = match &load.kind {
        LoadKind::Gravity { direction } => (&[], unit(*direction)),
        LoadKind::Force {
            body,
            point,
            direction,
            ..
        } => (
            std::slice::from_ref(body),
            unit(*direction) && point.is_finite(),
        ),
        LoadKind::Torque { bodies } | LoadKind::TorsionDamper { bodies } => (bodies, true),
        LoadKind::Spring {
            bodies,
            points,
            free,
        } => (bodies, finite(points) && free.is_finite() && *free >= 0.0),
        LoadKind::TorsionSpring { bodies, free } => (bodies, free.is_finite()),
        LoadKind::Damper { bodies, points } => (bodies, finite(points)),
    };
    if !there(bodies) {
        return Err("it acts on a body that is not there");
    }
    if !sound {
        return Err("a point, direction or free length that makes no sense");
    }
    match load.magnitude {
        Magnitude::Constant(value) if !value.is_finite() => {
            Err("its magnitude is not a finite number")
        }
        _ => Ok(()),
    }
}
