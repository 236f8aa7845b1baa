//! A pulse: a magnitude as a function of time, as a scene writes it, and as someone writes it piece by piece who restarts
//! an integration wherever it switches.

use crate::draws::Draws;
use std::f64::consts::{PI, TAU};

/// The shape of a pulse of unit area.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PulseShape {
    /// A Gaussian bell.
    Bell,
    /// A triangle.
    Triangle,
    /// sin² over half a period.
    SineSquared,
    /// A rectangle by a condition.
    Rectangle,
    /// A rectangle as the difference of two steps.
    StepPair,
    /// A rectangle by a condition within another.
    Nested,
    /// Rectangles by a condition of a periodic function.
    Periodic,
}

impl PulseShape {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Bell,
        Self::Triangle,
        Self::SineSquared,
        Self::Rectangle,
        Self::StepPair,
        Self::Nested,
        Self::Periodic,
    ];

    /// Whether it has switches at which an integration can be restarted: a bell is smooth everywhere.
    pub(super) fn has_switches(self) -> bool {
        self != Self::Bell
    }

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bell => "bell",
            Self::Triangle => "triangle",
            Self::SineSquared => "sin²",
            Self::Rectangle => "rectangle",
            Self::StepPair => "pair of steps",
            Self::Nested => "nested conditions",
            Self::Periodic => "periodic condition",
        }
    }
}

/// Half the width of a bell in standard deviations times √2: beyond it its area is 1e-16.
const BELL_REACH: f64 = 6.0;
/// Where a periodic condition holds: sin x > 1/2, a third of each period.
const PERIODIC_LEVEL: f64 = 0.5;

/// A pulse about a time, of a width in s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pulse {
    pub(super) shape: PulseShape,
    pub(super) at: f64,
    pub(super) width: f64,
    pub(super) span: f64,
}

/// A magnitude as an expression, until a time, s.
pub(super) type Piece = (String, f64);

impl Pulse {
    /// A pulse within a motion of `span` seconds: its width is from 1e-6 to 1 of it, its place anywhere that holds it.
    pub(super) fn draw(draws: &mut Draws, span: f64) -> Self {
        let shape = draws.choose(&PulseShape::ALL);
        let finest = match shape {
            // A hundred pulses at most, each followed by hand.
            PulseShape::Periodic => -2.0,
            _ => -6.0,
        };
        let width = span * draws.power_of_ten(finest, 0.0);
        let at = draws.between(0.5 * width, span - 0.5 * width);
        Self {
            shape,
            at,
            width,
            span,
        }
    }

    /// The ends of the pulse.
    fn ends(&self) -> [f64; 2] {
        [self.at - 0.5 * self.width, self.at + 0.5 * self.width]
    }

    /// The magnitude as a scene has it, of unit area (of unit mean size where it is periodic).
    pub(super) fn expression(&self) -> String {
        let Self { at, width, .. } = *self;
        let (half, height) = (0.5 * width, self.height());
        let [from, to] = self.ends();
        match self.shape {
            PulseShape::Bell => self.smooth(),
            PulseShape::Triangle => format!("{height}*max(0, 1 - abs(t - {at})/{half})"),
            PulseShape::SineSquared => {
                format!("if(abs(t - {at}) < {half}, {}, 0)", self.smooth())
            }
            PulseShape::Rectangle => format!("if(abs(t - {at}) < {half}, {height}, 0)"),
            PulseShape::StepPair => format!("{height}*(step(t - {from}) - step(t - {to}))"),
            PulseShape::Nested => format!("if(t > {from}, if(t < {to}, {height}, 0), 0)"),
            PulseShape::Periodic => {
                format!("if(sin({}*t) > {PERIODIC_LEVEL}, {height}, 0)", TAU / width)
            }
        }
    }

    /// The largest magnitude.
    fn height(&self) -> f64 {
        match self.shape {
            PulseShape::Bell => 2.0 * BELL_REACH / (self.width * PI.sqrt()),
            PulseShape::Triangle | PulseShape::SineSquared => 2.0 / self.width,
            PulseShape::Rectangle | PulseShape::StepPair | PulseShape::Nested => 1.0 / self.width,
            // All together of unit area, but for what the span cuts off.
            PulseShape::Periodic => 3.0 / self.span,
        }
    }

    /// A smooth pulse where it is not zero.
    fn smooth(&self) -> String {
        let Self { at, width, .. } = *self;
        let height = self.height();
        match self.shape {
            PulseShape::Bell => {
                format!("{height}*exp(-((t - {at})/{})^2)", 0.5 * width / BELL_REACH)
            }
            _ => format!("{height}*cos({}*(t - {at}))^2", PI / width),
        }
    }

    /// The magnitude piece by piece, each of them smooth: in the order of their ends, the last at the end of the motion.
    pub(super) fn pieces(&self) -> Vec<Piece> {
        let [from, to] = self.ends();
        let height = self.height();
        let around = |pulse: Vec<Piece>| {
            let zero = |until: f64| vec![("0".to_owned(), until)];
            [zero(from), pulse, zero(self.span)].concat()
        };
        let pieces = match self.shape {
            PulseShape::Bell | PulseShape::SineSquared => around(vec![(self.smooth(), to)]),
            PulseShape::Triangle => {
                let Self { at, width, .. } = *self;
                let side = |sign: char| format!("{height}*(1 {sign} (t - {at})/{})", 0.5 * width);
                around(vec![(side('+'), at), (side('-'), to)])
            }
            PulseShape::Rectangle | PulseShape::StepPair | PulseShape::Nested => {
                around(vec![(height.to_string(), to)])
            }
            PulseShape::Periodic => self.periodic_pieces(),
        };
        let within = |(text, end): (String, f64)| (text, end.min(self.span));
        let mut begin = 0.0;
        let pieces = pieces.into_iter().map(within).filter(|&(_, end)| {
            // A pulse may begin with the motion, and end with it.
            let holds_time = end > begin;
            begin = end.max(begin);
            holds_time
        });
        pieces.collect()
    }

    fn periodic_pieces(&self) -> Vec<Piece> {
        let period = self.width;
        let [on, off] =
            [PERIODIC_LEVEL.asin(), PI - PERIODIC_LEVEL.asin()].map(|x| x / TAU * period);
        let mut pieces = Vec::new();
        let mut begin = 0.0;
        while begin < self.span {
            pieces.push(("0".to_owned(), begin + on));
            pieces.push((self.height().to_string(), begin + off));
            begin += period;
        }
        pieces.push(("0".to_owned(), self.span.max(begin)));
        pieces
    }

    /// The area of the pulse within the motion, and the time of its centroid, s.
    pub(super) fn impulse(&self) -> [f64; 2] {
        if self.shape != PulseShape::Periodic {
            return [1.0, self.at];
        }
        let (mut area, mut moment, mut begin) = (0.0, 0.0, 0.0);
        for (text, end) in self.pieces() {
            if text != "0" {
                let part = self.height() * (end - begin);
                area += part;
                moment += part * 0.5 * (begin + end);
            }
            begin = end;
        }
        match area > 0.0 {
            true => [area, moment / area],
            false => [0.0, 0.0],
        }
    }
}
