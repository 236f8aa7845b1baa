//! What a conservative mechanism of one freedom has at a coordinate: inertia, potential, and the force
//! −V′ that the potential makes.

use crate::equation::positive;
use crate::error::DynamicsError;
use crate::machine::Machine;
use dwell_geometry::{PlaceError, Range};
use dwell_kinetostatics::{Actions, Model, Reduced, Workspace};
use std::f64::consts::TAU;

/// Turns after which a mechanism that has not come back is taken to go on for ever.
const MOST_TURNS: u32 = 8;
/// Where the mechanism is compared with itself some turns on, in parts of a turn.
const COMPARED: [f64; 7] = [0.0, 0.131, 0.292, 0.417, 0.583, 0.719, 0.877];
/// Two numbers nearer than this, relatively, are one: solutions of large groups differ by some rounding.
const SAME: f64 = 1e-9;

/// Inertia, potential and force at a coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Held {
    /// m, kg m² or kg.
    pub(crate) m: f64,
    /// V, J.
    pub(crate) potential: f64,
    /// −V′, N·m or N.
    pub(crate) force: f64,
}

/// Something that moves in one coordinate and loses nothing.
pub(crate) trait Conservative {
    /// What it has at `q`.
    fn held(&mut self, q: f64) -> Result<Held, DynamicsError>;

    /// How far the coordinate reaches.
    fn range(&self) -> Range;

    /// Whether the coordinate is an angle.
    fn turns(&self) -> bool;

    /// Whether there is no potential, so that it goes on as it began.
    fn level(&self) -> bool {
        false
    }

    /// After how many radians everything is as it was; none if that never happens.
    fn repeats(&mut self, q: f64) -> Result<Option<f64>, DynamicsError> {
        if !self.turns() || self.range().limits().is_some() {
            return Ok(None);
        }
        if self.level() && self.range() == Range::Full {
            return Ok(Some(TAU));
        }
        let mut here = Vec::with_capacity(COMPARED.len());
        for part in COMPARED {
            here.push(self.held(q + TAU * part)?);
        }
        let size = |of: fn(&Held) -> f64| here.iter().fold(0.0_f64, |s, h| s.max(of(h).abs()));
        let (potential, force) = (size(|h| h.potential), size(|h| h.force));
        for turns in 1..=MOST_TURNS {
            let period = TAU * f64::from(turns);
            let mut same = true;
            for (part, h) in COMPARED.iter().zip(&here) {
                // Beyond what is known of it, it does not come back.
                let Ok(there) = self.held(q + TAU * part + period) else {
                    return Ok(None);
                };
                same &= (there.m - h.m).abs() <= SAME * h.m
                    && (there.potential - h.potential).abs() <= SAME * potential
                    && (there.force - h.force).abs() <= SAME * force;
            }
            if same {
                return Ok(Some(period));
            }
        }
        Ok(None)
    }
}

/// A mechanism without loads.
pub(crate) struct Unloaded<'a, R: Reduced> {
    pub(crate) model: &'a R,
    pub(crate) work: R::Work,
}

impl<R: Reduced> Conservative for Unloaded<'_, R> {
    fn held(&mut self, q: f64) -> Result<Held, DynamicsError> {
        let (m, _) = self.model.inertia(q, &mut self.work)?;
        Ok(Held {
            m: positive(m, q)?,
            potential: 0.0,
            force: 0.0,
        })
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn turns(&self) -> bool {
        !matches!(self.model.range(), Range::Stroke(..))
    }

    fn level(&self) -> bool {
        true
    }
}

/// A machine of one freedom whose loads all have a potential.
pub(crate) struct Loaded {
    model: Model,
    flywheel: f64,
    work: Workspace<f64>,
    actions: Actions<f64>,
}

impl Loaded {
    pub(crate) fn new(machine: &Machine) -> Result<Self, DynamicsError> {
        if machine.model().plan().actuators() != 1 || machine.free() != [0] {
            return Err(DynamicsError::NotConservative {
                what: "it has not one coordinate, which is free",
            });
        }
        if !machine.workers().is_empty() {
            return Err(DynamicsError::NotConservative {
                what: "a drive, or a load without a potential, does work on it",
            });
        }
        let model = machine.model().without_reactions();
        Ok(Self {
            work: model.workspace(),
            actions: model.actions(),
            flywheel: machine.flywheel(0),
            model,
        })
    }
}

impl Conservative for Loaded {
    fn held(&mut self, q: f64) -> Result<Held, DynamicsError> {
        let Self {
            model,
            work,
            actions,
            ..
        } = self;
        model.enter(0.0, &[q], &[0.0], work)?;
        let loads = 0..model.loads().len();
        let potential = loads.filter_map(|load| model.potential(load, work)).sum();
        model.loaded(&[0.0], work, actions)?;
        let force = -actions.tau[0];
        model.inertial(0, work, actions);
        Ok(Held {
            m: positive(actions.tau[0] + self.flywheel, q)?,
            potential,
            force,
        })
    }

    fn range(&self) -> Range {
        self.model.plan().range()
    }

    fn turns(&self) -> bool {
        self.model.plan().is_angle(0)
    }
}

/// The ends of the range, in the turn in which the motion starts; none if the coordinate turns
/// fully.
pub(crate) fn limits(range: Range, q: f64) -> Result<Option<(f64, f64)>, DynamicsError> {
    let Some((from, to)) = range.limits() else {
        return Ok(None);
    };
    let turns = match range {
        Range::Between(..) => TAU * ((q - from) / TAU).floor(),
        _ => 0.0,
    };
    if q > to + turns || q < from + turns {
        return Err(PlaceError::OutOfRange { q, from, to }.into());
    }
    Ok(Some((from + turns, to + turns)))
}
