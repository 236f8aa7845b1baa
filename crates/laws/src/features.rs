//! Where functions of time are not smooth, and how fast they vary elsewhere.
//!
//! A step of an integrator evaluates a load at a few instants only. Therefore all instants at which a load, drive or prescribed motion
//! switches, jumps or has a kink are located, and the time between them is divided into pieces on which every function is
//! close to a parabola. Both use interval arithmetic, which
//! bounds a function over a whole interval, so no pulse is missed, however narrow.
//!
//! ```
//! use dwell_laws::{Expression, Features};
//!
//! let pulse = Expression::parse("if(abs(t - 200) < 5e-4, 1000, 0)", &["t"])?;
//! let mut features = Features::default();
//! features.add_expression(0, &pulse, 0);
//! let ends: Vec<f64> = features
//!     .scan(0.0, 300.0)
//!     .map_while(Result::ok)
//!     .filter(|piece| piece.restart)
//!     .map(|piece| piece.to)
//!     .collect();
//! assert!((ends[0] - 199.9995).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod deciding;
pub(crate) mod enclosure;
pub(crate) mod interval;
mod scan;
pub(crate) mod switching;
#[cfg(test)]
mod tests;

pub use scan::{Piece, Scan, Unresolved};

use crate::{Expression, Law, Polynomial, Sinusoid};
use switching::Pieces;

/// The functions of time of a problem; each belongs to a numbered source.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Features {
    expressions: Vec<(usize, Pieces)>,
    /// Instants at which pieces of laws meet, in order.
    knots: Vec<Knot>,
    /// By law: the intervals in which it varies, with the length over which it is smooth, in order.
    bands: Vec<Vec<Band>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    x: f64,
    /// Whether value, slope or curvature may jump there, so that an integration must restart.
    restart: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Band {
    source: usize,
    from: f64,
    to: f64,
    width: f64,
}

/// Number of parts of a rise, or of a piece of a spline, over each of which it is smooth.
const PARTS_OF_A_RISE: f64 = 8.0;
const PARTS_OF_A_PIECE: f64 = 4.0;
/// Phase over which a sinusoid is smooth, rad.
const PART_OF_A_WAVE: f64 = 0.25;

impl Features {
    /// Whether nothing limits the steps.
    pub fn is_empty(&self) -> bool {
        self.expressions.is_empty() && self.knots.is_empty() && self.bands.is_empty()
    }

    /// Adds an expression, in its variable of that index.
    pub fn add_expression(&mut self, source: usize, expression: &Expression, variable: usize) {
        let pieces = Pieces::of(expression, variable);
        if !(pieces.switches.is_empty() && pieces.terms.is_empty()) {
            self.expressions.push((source, pieces));
        }
    }

    /// Adds a law.
    pub fn add_law(&mut self, source: usize, law: &Law) {
        let band = |[from, to]: [f64; 2], width: f64| Band {
            source,
            from,
            to,
            width,
        };
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        match law {
            Law::Polynomial(Polynomial { .. }) => {}
            Law::Expression(expression) => self.add_expression(source, expression, 0),
            Law::Sinusoid(Sinusoid {
                angular_frequency, ..
            }) => {
                let width = PART_OF_A_WAVE / angular_frequency.abs();
                self.bands.push(vec![band(everywhere, width)]);
            }
            Law::Profile(profile) => {
                let corners = profile.corners();
                self.add_knots(&corners, true);
                let [from, to] = [corners[0], corners[corners.len() - 1]];
                let width = (to - from) / PARTS_OF_A_RISE;
                self.bands.push(vec![band([from, to], width)]);
            }
            Law::Spline(spline) => {
                self.add_knots(spline.knots(), spline.has_kinks());
                let pieces = spline.knots().windows(2);
                let bands = pieces.map(|p| band([p[0], p[1]], (p[1] - p[0]) / PARTS_OF_A_PIECE));
                self.bands.push(bands.collect());
            }
        }
    }

    /// Adds the instants (s) at which pieces of an unknown function meet; `restart` states whether an integration must restart there.
    pub fn add_knots(&mut self, at: &[f64], restart: bool) {
        self.knots.extend(at.iter().map(|&x| Knot { x, restart }));
        self.knots.sort_by(|a, b| a.x.total_cmp(&b.x));
        self.knots.dedup_by(|b, a| {
            let same = a.x == b.x;
            a.restart |= same && b.restart;
            same
        });
    }

    /// The smooth pieces from one instant to another, in order.
    pub fn scan(&self, from: f64, to: f64) -> Scan<'_> {
        Scan::new(self, from, to, true)
    }

    /// An upper bound of the absolute values of a source's terms between two instants.
    pub fn largest(&self, source: usize, from: f64, to: f64) -> f64 {
        let of = self.expressions.iter().filter(|(s, _)| *s == source);
        of.map(|(_, pieces)| scan::term_scales(pieces, from, to).iter().sum::<f64>())
            .sum()
    }

    /// The pieces between switches, jumps and kinks only, in order.
    pub fn scan_switches(&self, from: f64, to: f64) -> Scan<'_> {
        Scan::new(self, from, to, false)
    }
}
