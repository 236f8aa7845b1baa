//! The modes of the surfaces of a contact.

use crate::sliding::Sliding;

/// The mode of the surfaces of a friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactMode {
    /// Undecided: their speed decides, or, at a speed of zero, the forces.
    #[default]
    Undecided,
    /// They are at rest, and their mode is to be found; at their limit, if so, they do not hold.
    AtRest {
        /// Whether the force has just reached its limit.
        at_limit: bool,
    },
    /// They slide, to the side on which the speed has this sign.
    Slides {
        /// Whether the speed is positive.
        forward: bool,
    },
    /// They hold, by whatever force that takes.
    Holds,
    /// Their force is at its limit, but others hold them: they would move to the side on which the speed has this sign.
    AtLimit {
        /// Whether the speed would be positive.
        forward: bool,
    },
}

impl ContactMode {
    /// The number by which it is written among the states of a machine.
    pub(crate) fn code(self) -> f64 {
        match self {
            Self::Undecided => 0.0,
            Self::Slides { forward } => sign(forward),
            Self::Holds => 2.0,
            Self::AtLimit { forward } => 3.0 * sign(forward),
            Self::AtRest { at_limit: false } => 4.0,
            Self::AtRest { at_limit: true } => 5.0,
        }
    }

    /// The mode of a number among the states; between two states of an interpolation lies a rounding.
    pub(crate) fn of_code(code: f64) -> Self {
        let forward = code > 0.0;
        match code.abs().round() {
            1.0 => Self::Slides { forward },
            2.0 => Self::Holds,
            3.0 => Self::AtLimit { forward },
            4.0 => Self::AtRest { at_limit: false },
            5.0 => Self::AtRest { at_limit: true },
            _ => Self::Undecided,
        }
    }

    /// Whether it is to be found yet.
    pub(crate) fn is_open(self) -> bool {
        matches!(self, Self::Undecided | Self::AtRest { .. })
    }

    /// Whether it is a mode of surfaces without speed.
    pub fn is_at_rest(self) -> bool {
        matches!(
            self,
            Self::Holds | Self::AtLimit { .. } | Self::AtRest { .. }
        )
    }
}

/// 1 or −1.
pub(super) fn sign(forward: bool) -> f64 {
    if forward { 1.0 } else { -1.0 }
}

/// The state of the contacts in the previous step.
#[derive(Debug, Clone, Copy)]
pub struct ContactStep<'s> {
    /// By contact: the largest speed of its surfaces.
    pub largest_speeds: &'s [f64],
    /// By contact, and after the contacts by end stop: whether its surfaces come to rest, or its force to its limit.
    pub touched: &'s [bool],
    /// The length of the motion, s.
    pub span: f64,
    /// Whether another event was at the same time.
    pub repeated: bool,
}

/// A change of a contact in a motion.
#[derive(Debug, Clone, PartialEq)]
pub enum ContactEvent {
    /// The surfaces of a friction change their mode.
    Friction {
        /// Time, s.
        t: f64,
        /// The state of the machine after the event.
        y: Vec<f64>,
        /// The load whose surfaces they are, by its index.
        load: usize,
        /// The mode before the event.
        from: ContactMode,
        /// To which mode.
        to: ContactMode,
    },
    /// The motion begins to slide along the switch of a load or drive that drives it back from both sides, or leaves it.
    Switch {
        /// Time, s.
        t: f64,
        /// The state of the machine after the event.
        y: Vec<f64>,
        /// The load that switches, by its index; those of the drives are the last.
        load: usize,
        /// The pieces on both sides; `None` if the motion leaves the switch.
        sliding: Option<Sliding>,
    },
    /// A coordinate meets its end stop, rests on it or leaves it.
    Stop {
        /// Time, s.
        t: f64,
        /// The state of the machine after the event.
        y: Vec<f64>,
        /// Which of the machine's end stops, by its index.
        stop: usize,
        /// The change.
        change: StopChange,
    },
}

/// A change at an end stop.
#[derive(Debug, Clone, PartialEq)]
pub enum StopChange {
    /// The coordinate strikes it.
    Impact {
        /// The impulse along the coordinate, N·m·s or N·s.
        impulse: f64,
        /// By free coordinate: the change of its speed.
        changes: Vec<f64>,
    },
    /// The coordinate touches a compliant stop.
    Touches,
    /// The coordinate comes to rest on the stop.
    Rests,
    /// The coordinate leaves the stop.
    Leaves,
}

impl ContactEvent {
    /// Time, s.
    pub fn t(&self) -> f64 {
        match self {
            Self::Friction { t, .. } | Self::Switch { t, .. } | Self::Stop { t, .. } => *t,
        }
    }

    /// The state of the machine after the event.
    pub fn y(&self) -> &[f64] {
        match self {
            Self::Friction { y, .. } | Self::Switch { y, .. } | Self::Stop { y, .. } => y,
        }
    }
}
