//! End stops of free coordinates, and the side on which each limits its coordinate.

use dwell_numerics::Scalar;

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
    /// For a compliant stop: its spring and its damper, which replace impacts.
    pub yielding: Option<YieldingStop>,
}

/// The spring and the damper of an end stop that yields: its force k δ + c δ̇ at a penetration δ, while that pushes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YieldingStop {
    /// Stiffness k above zero, N·m/rad or N/m.
    pub stiffness: f64,
    /// Damping c, 0 or more, N·m·s/rad or N·s/m.
    pub damping: f64,
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
    /// Its position, rad or m.
    pub(crate) at: f64,
    /// 1 of a lower limit, −1 of an upper one: the direction in which it pushes.
    pub(crate) side: f64,
    pub(crate) restitution: f64,
    pub(crate) yielding: Option<YieldingStop>,
}

impl Stop {
    /// The force of a compliant stop in contact, along its coordinate, N·m or N; negative where it would pull.
    pub(crate) fn push<T: Scalar>(&self, q: T, speed: T) -> Option<T> {
        let YieldingStop { stiffness, damping } = self.yielding?;
        let side = T::from_f64(self.side);
        let depth = side * (T::from_f64(self.at) - q);
        Some(depth * T::from_f64(stiffness) - side * speed * T::from_f64(damping))
    }

    /// The margin of the coordinate to a change: to leaving the stop while it is touched, to touching it otherwise. Because of
    /// the damper, contact ends before the spring has its free length; the coordinate is then beyond the limit, but does not
    /// touch the stop.
    pub(crate) fn yielding_margin(&self, is_touched: bool, q: f64, speed: f64) -> Option<f64> {
        let push = self.push(q, speed)? / self.yielding?.stiffness;
        let distance = self.side * (q - self.at);
        Some(if is_touched {
            push
        } else {
            distance.max(-push)
        })
    }
}

/// The sides of all end stops; `None` if a coordinate is not free.
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
                yielding: one.yielding,
            })
        }));
    }
    Some(all)
}
