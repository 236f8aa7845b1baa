//! A motion that slides along a switch: the pieces of a load on both sides of it.

/// The pieces on both sides of a switch along which a motion slides.
#[derive(Debug, Clone, PartialEq)]
pub struct Sliding {
    /// Below the switch and above it: the piece of every switch of the system.
    pub(crate) sides: [Vec<Option<f64>>; 2],
    /// The switches along which the motion slides. The first decides; the others switch with it.
    pub(crate) switches: Vec<usize>,
    /// The value at which the first one switches.
    pub(crate) value: f64,
    /// The rate at which a distance from the switch, by rounding, decays, per s.
    pub(crate) decay: f64,
}

impl Sliding {
    /// Whether the side of the motion decides the piece of a switch.
    pub(crate) fn decides(&self, switch: usize) -> bool {
        self.sides[0][switch] != self.sides[1][switch]
    }
}

/// The value and the rate of a switching function on both sides of its switch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SideRates {
    /// Value and rate on the lower side, and on the upper side.
    pub(crate) sides: [[f64; 2]; 2],
}

impl SideRates {
    /// The weight α of the upper side that keeps the function constant (Filippov 1988, §4), between 0 and 1 in a sliding
    /// motion.
    pub(crate) fn upper_part(&self) -> f64 {
        let [[_, lower], [_, upper]] = self.sides;
        lower / (lower - upper)
    }

    /// The weight with which a distance from the switch decays.
    pub(crate) fn returning_part(&self, sliding: &Sliding) -> f64 {
        let [[value, lower], [_, upper]] = self.sides;
        (lower + sliding.decay * (value - sliding.value)) / (lower - upper)
    }

    /// The margin of the motion to leaving the switch, as a fraction; negative if one side leads away.
    pub(crate) fn margin(&self) -> f64 {
        let [[_, lower], [_, upper]] = self.sides;
        if lower - upper > 0.0 {
            let part = self.upper_part();
            part.min(1.0 - part)
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Whether a motion that leaves the switch does so upwards: the rates of both sides lead upwards, or one does and the other is nearly
    /// zero. After a change of a side, α does not decide: it is negative if both lead upwards and the upper one is faster.
    pub(crate) fn leaves_upward(&self) -> bool {
        let [[_, lower], [_, upper]] = self.sides;
        lower + upper > 0.0
    }

    /// Whether both sides lead back to the switch.
    pub(crate) fn both_return(&self) -> bool {
        let [[_, lower], [_, upper]] = self.sides;
        lower > 0.0 && upper < 0.0
    }
}
