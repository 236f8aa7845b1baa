//! A motion that slides along a switch: the pieces of a load on both sides of it.

/// The pieces on both sides of a switch along which a motion slides.
#[derive(Debug, Clone, PartialEq)]
pub struct Sliding {
    /// Below the switch and above it: the piece of every switch of the system.
    pub(crate) sides: [Vec<Option<f64>>; 2],
    /// The switches that the motion slides along; the first decides, the others switch where it does.
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
    /// Of the lower side and of the upper one: value and rate.
    pub(crate) sides: [[f64; 2]; 2],
}

impl SideRates {
    /// The part α of the upper side that keeps the function where it is (Filippov 1988, §4): in a sliding motion between 0
    /// and 1.
    pub(crate) fn upper_part(&self) -> f64 {
        let [[_, lower], [_, upper]] = self.sides;
        lower / (lower - upper)
    }

    /// The same, with a distance from the switch that decays.
    pub(crate) fn returning_part(&self, sliding: &Sliding) -> f64 {
        let [[value, lower], [_, upper]] = self.sides;
        (lower + sliding.decay * (value - sliding.value)) / (lower - upper)
    }

    /// How far the motion is from leaving the switch, as a part; negative where one side leads away.
    pub(crate) fn margin(&self) -> f64 {
        let [[_, lower], [_, upper]] = self.sides;
        if lower - upper > 0.0 {
            let part = self.upper_part();
            part.min(1.0 - part)
        } else {
            f64::NEG_INFINITY
        }
    }

    /// Whether a motion that leaves the switch does so upwards: where the rates of both sides lead there, or one does and the other is next
    /// to zero. Where a side has changed, the part α says nothing: it is negative where both lead upwards and the upper one does so faster.
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
