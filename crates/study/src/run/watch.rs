//! What ends a way though the mechanism can be placed: a load's table that is left, and a relation
//! whose function jumps from one position to the next.

use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::{JointId, JointKind, Mechanism};
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Law, Spline};
use dwell_scene::Scene;

/// Why a way ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fault {
    /// A load's table does not reach to this value of its signal.
    OffTable { load: usize, value: f64 },
    /// A relation's function jumps between two neighbouring values of its variable.
    Jump { joint: JointId, between: [f64; 2] },
}

/// A load's table, with what it is of.
struct Table<'a> {
    load: usize,
    spline: &'a Spline,
    /// None: the time. Else what is measured, and whether its value or its speed is meant.
    of: Option<(Measured, usize)>,
}

/// A relation's function, with its variable now and at the position before.
struct Related<'a> {
    joint: JointId,
    law: &'a Law,
    by: Measured,
    before: Option<f64>,
}

/// Looks at one position after another.
pub(crate) struct Watch<'a> {
    tables: Vec<Table<'a>>,
    relations: Vec<Related<'a>>,
}

/// The table of a load and what it is of, if it has one.
pub(crate) fn table_of(magnitude: &Magnitude) -> Option<(Signal, &Spline)> {
    match magnitude {
        Magnitude::Law(signal, Law::Spline(spline)) => Some((*signal, spline)),
        _ => None,
    }
}

impl<'a> Watch<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let mechanism = &scene.mechanism;
        let table = |(load, magnitude): (usize, &'a Magnitude)| {
            let (signal, spline) = table_of(magnitude)?;
            let of = match signal {
                Signal::Time => None,
                Signal::Value(c) => Some((Measured::find(mechanism, c)?, 0)),
                Signal::Speed(c) => Some((Measured::find(mechanism, c)?, 1)),
            };
            Some(Table { load, spline, of })
        };
        let magnitudes = scene.loads.iter().map(|l| &l.magnitude).enumerate();
        let related = |(joint, law, by)| {
            Some(Related {
                joint,
                law,
                by: Measured::find(mechanism, by)?,
                before: None,
            })
        };
        Self {
            tables: magnitudes.filter_map(table).collect(),
            relations: relations(mechanism).filter_map(related).collect(),
        }
    }

    /// The first load whose table does not reach to the state of the bodies at time `t`.
    pub(crate) fn off_table(&self, t: f64, states: &BodyStates) -> Option<Fault> {
        self.tables.iter().find_map(|table| {
            let value = match table.of {
                None => t,
                Some((measured, order)) => states.measure(measured)[order],
            };
            let [first, last] = table.spline.range();
            // Measured angles and lengths err by a few roundings.
            let slack = ROUNDING * (last - first);
            let inside = value >= first - slack && value <= last + slack;
            let load = table.load;
            (!inside).then_some(Fault::OffTable { load, value })
        })
    }

    /// The first relation whose function jumps since the position before.
    pub(crate) fn jump(&mut self, states: &BodyStates) -> Option<Fault> {
        self.relations.iter_mut().find_map(|related| {
            let now = states.measure(related.by)[0];
            let before = related.before.replace(now)?;
            let between = related.law.jump(before, now)?;
            let joint = related.joint;
            Some(Fault::Jump { joint, between })
        })
    }
}

/// Part of a table's range by which a measured value may pass its end.
const ROUNDING: f64 = 1e-12;

/// The relations of a mechanism: joint, function, and the coordinate that is its variable.
fn relations(
    mechanism: &Mechanism,
) -> impl Iterator<Item = (JointId, &Law, dwell_geometry::Coordinate)> {
    let joints = mechanism.joints.iter().enumerate();
    joints.filter_map(|(j, joint)| {
        let JointKind::Relation(k) = joint.kind else {
            return None;
        };
        let relation = mechanism.relations.get(k)?;
        Some((JointId(j), &relation.law, relation.by))
    })
}

/// The first relation of an actuator's coordinate whose function has no finite value or derivative
/// at `q`: joint, variable, and what is not finite.
pub(crate) fn broken_relation(
    mechanism: &Mechanism,
    q: &[f64],
) -> Option<(JointId, f64, &'static str)> {
    relations(mechanism).find_map(|(joint, law, by)| {
        let driven = mechanism
            .actuators
            .iter()
            .position(|a| a.coordinate() == by);
        let x = *q.get(driven?)?;
        let wrong = law.at(x)[..3].iter().position(|d| !d.is_finite())?;
        Some((joint, x, ["value", "slope", "curvature"][wrong]))
    })
}
