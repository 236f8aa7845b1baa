//! End stops of free coordinates, and the side on which each limits its coordinate.

/// An end stop of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStop {
    /// The actuator of the coordinate, which must be free.
    pub actuator: usize,
    /// Lower limit, rad or m, if there is one.
    pub min: Option<f64>,
    /// Upper limit, rad or m, if there is one.
    pub max: Option<f64>,
    /// Coefficient of restitution e, from 0 to 1.
    pub restitution: f64,
}

/// One side of an end stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stop {
    /// Index among the end stops.
    pub(crate) stop: usize,
    /// Index among the free coordinates.
    pub(crate) free: usize,
    /// The actuator of the coordinate.
    pub(crate) actuator: usize,
    /// Where it is, rad or m.
    pub(crate) at: f64,
    /// 1 of a lower limit, −1 of an upper one: the direction in which it pushes.
    pub(crate) side: f64,
    pub(crate) restitution: f64,
}

/// The sides of all end stops; none where a coordinate is not free.
pub(crate) fn one_sided(stops: &[EndStop], free: &[usize]) -> Option<Vec<Stop>> {
    let mut all = Vec::new();
    for (stop, one) in stops.iter().enumerate() {
        let index = free.iter().position(|&i| i == one.actuator)?;
        let limits = [(one.min, 1.0), (one.max, -1.0)].into_iter();
        all.extend(limits.filter_map(|(at, side)| {
            Some(Stop {
                stop,
                free: index,
                actuator: one.actuator,
                at: at?,
                side,
                restitution: one.restitution,
            })
        }));
    }
    Some(all)
}
