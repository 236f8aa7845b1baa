//! What a result of a sweep says about a quantity along a trajectory: the one table of its names, units and meanings.

use crate::trajectory::compute::{Analysis, Column, Distance, Quantity};

/// A number that sums up a quantity along a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Statistic {
    Max,
    Min,
    MaxAbs,
    Mean,
    Rms,
    Stroke,
    Work,
    PeakPower,
}

/// A statistic with the end of its results' names, and its meaning. The table of docs/sweep.md is this one.
pub(crate) const STATISTICS: [(Statistic, &str, &str); 8] = [
    (Statistic::Max, "max", "the largest value"),
    (Statistic::Min, "min", "the smallest value"),
    (Statistic::MaxAbs, "max_abs", "the largest magnitude"),
    (Statistic::Mean, "mean", "the mean over time"),
    (Statistic::Rms, "rms", "the root mean square over time"),
    (
        Statistic::Stroke,
        "stroke",
        "the largest less the smallest value",
    ),
    (
        Statistic::Work,
        "work",
        "of an actuator force or a power: its work, J",
    ),
    (
        Statistic::PeakPower,
        "peak_power",
        "of an actuator force: the largest magnitude of its power, W",
    ),
];

/// A function of the position along a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Signal {
    /// A column.
    Column(Column),
    /// The magnitude of the vector of some quantities.
    Norm(Vec<Quantity>),
    /// The power of an actuator.
    Power(usize),
    /// The distance from the rows of a table.
    Distance(Box<Distance>),
}

impl Statistic {
    /// The quantity and the statistic of a result's name.
    pub(crate) fn of_name(name: &str) -> Option<(&str, Self)> {
        let (quantity, end) = name.rsplit_once('.')?;
        let mut all = STATISTICS.iter();
        let found = all.find(|row| row.1 == end)?;
        Some((quantity, found.0))
    }

    /// The unit of this statistic of a signal with a unit; `None` if an analysis has no such statistic.
    pub(crate) fn unit<'u>(
        self,
        signal: &Signal,
        unit: &'u str,
        analysis: Analysis,
    ) -> Option<&'u str> {
        let quantity = signal.quantity();
        let is_distance = matches!(signal, Signal::Distance(_));
        let is_force = matches!(quantity, Some(Quantity::ActuatorForce(_)));
        match self {
            Self::Work => (is_force || unit == "W").then_some("J"),
            Self::PeakPower => (is_force && analysis != Analysis::Statics).then_some("W"),
            Self::MaxAbs | Self::Mean | Self::Rms => Some(unit),
            Self::Max | Self::Min | Self::Stroke => (!is_distance).then_some(unit),
        }
    }
}

impl Signal {
    /// Its quantity, if it is a column.
    pub(crate) fn quantity(&self) -> Option<Quantity> {
        match self {
            Self::Column(column) => Some(column.quantity),
            Self::Norm(_) | Self::Power(_) | Self::Distance(_) => None,
        }
    }

    /// A quantity that has no name of its own.
    pub(crate) fn of(quantity: Quantity) -> Self {
        Self::Column(Column {
            name: String::new(),
            unit: "",
            quantity,
            meaning: String::new(),
            unwraps: false,
        })
    }

    /// The signal whose values a statistic sums up: of the work of an actuator force its power.
    pub(crate) fn summed_by(&self, statistic: Statistic) -> Self {
        match (self.quantity(), statistic) {
            (Some(Quantity::ActuatorForce(i)), Statistic::Work | Statistic::PeakPower) => {
                Self::Power(i)
            }
            _ => self.clone(),
        }
    }

    /// The signals whose values along the trajectory it needs.
    pub(super) fn parts(&self) -> Vec<&Self> {
        match self {
            Self::Distance(distance) => {
                let all = distance.at.iter().chain(&distance.of);
                all.map(|(signal, _)| signal).collect()
            }
            own => vec![own],
        }
    }

    /// The quantities from which it follows.
    pub(crate) fn quantities(&self) -> Vec<Quantity> {
        match self {
            Self::Distance(_) => self.parts().iter().flat_map(|of| of.quantities()).collect(),
            Self::Column(column) => vec![column.quantity],
            Self::Norm(components) => components.clone(),
            Self::Power(i) => vec![Quantity::ActuatorForce(*i)],
        }
    }
}
