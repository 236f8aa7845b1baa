//! The smooth pieces of an interval, found from left to right by halving.

use super::Features;
use super::deciding::{Decision, ROUNDINGS, bracket, decide, side_within};
use super::interval::Interval;
use super::switching::{NOTHING, Pieces, Switch};
use crate::expression::Sides;

/// A piece is smooth if its terms differ from parabolas by at most this fraction of their largest values.
const SMOOTHNESS: f64 = 1e-3;
/// Shortest piece, relative to the ends of the whole interval.
const MIN_WIDTH: f64 = 64.0 * f64::EPSILON;
/// Number of parts of the interval in which the largest values of the terms are searched.
const SCALE_PARTS: usize = 128;
/// Maximum number of cells that are tried for one piece.
const MAX_TRIALS: usize = 100_000;

/// A part of the interval in which everything is smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Its beginning: after a switch, the first instant at which it has switched.
    pub from: f64,
    /// Its end: before a switch, the last instant at which it has not switched.
    pub to: f64,
    /// The length over which all functions in it are smooth.
    pub width: f64,
    /// Whether a function switches, jumps or has a kink at its end.
    pub restart: bool,
    /// The source that limits its width, if any.
    pub source: Option<usize>,
}

/// An interval in which the switches of a source cannot be separated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("source {source_index} switches too often near {at}")]
pub struct Unresolved {
    /// The source.
    pub source_index: usize,
    /// Where.
    pub at: f64,
}

/// The smooth pieces of an interval, in order.
#[derive(Debug, Clone)]
pub struct Scan<'f> {
    features: &'f Features,
    /// The cells not yet examined, in reverse order.
    open: Vec<Cell>,
    /// The next knot, and the end.
    next_knot: usize,
    from: f64,
    to: f64,
    /// Start of the whole interval.
    start: f64,
    min_width: f64,
    /// By expression and term: its largest value.
    scales: Vec<Vec<f64>>,
    /// The last piece, whose end depends on the next one.
    held: Option<DecidedPiece>,
    failed: bool,
}

#[derive(Debug, Clone)]
struct Cell {
    from: f64,
    to: f64,
    /// By expression and operation: the decided sides.
    sides: Vec<Vec<Sides>>,
    restart: bool,
    /// The source that limits it, if any.
    source: Option<usize>,
}

/// A piece, with the decided sides by expression and operation.
type DecidedPiece = (Piece, Vec<Vec<Sides>>);

/// The result of examining a cell.
enum Examined {
    /// The source that limits its width, if any.
    Smooth(Option<usize>),
    Halve(usize),
    /// A switch of an expression between two instants, with its sides before and after.
    SwitchAt {
        expression: usize,
        switch: Switch,
        between: [f64; 2],
        sides: [f64; 2],
    },
}

impl<'f> Scan<'f> {
    /// The pieces between switches; with `smooth` they are divided until all functions are smooth.
    pub(super) fn new(features: &'f Features, from: f64, to: f64, smooth: bool) -> Self {
        let scales = features.expressions.iter().map(|(_, pieces)| {
            if smooth {
                term_scales(pieces, from, to)
            } else {
                Vec::new()
            }
        });
        Self {
            scales: scales.collect(),
            features,
            open: Vec::new(),
            next_knot: features.knots.partition_point(|knot| knot.x <= from),
            from,
            to,
            start: from,
            min_width: MIN_WIDTH * from.abs().max(to.abs()),
            held: None,
            failed: false,
        }
    }

    /// Whether the last piece has been returned.
    pub fn is_exhausted(&self) -> bool {
        self.held.is_none() && self.open.is_empty() && self.from >= self.to
    }

    /// The interval from the last knot to the next.
    fn next_cell(&mut self) -> Option<Cell> {
        if self.from >= self.to {
            return None;
        }
        let knots = &self.features.knots;
        let knot = knots.get(self.next_knot).filter(|knot| knot.x < self.to);
        let from = self.from;
        let margin = |x: f64| 2.0 * ROUNDINGS * f64::EPSILON * x.abs();
        let (to, restart) = match knot {
            Some(knot) => {
                self.next_knot += 1;
                self.from = knot.x + margin(knot.x);
                (knot.x - margin(knot.x), knot.restart)
            }
            None => {
                self.from = self.to;
                (self.to, false)
            }
        };
        let undecided = |(_, pieces): &(usize, Pieces)| vec![[None; 2]; pieces.len()];
        Some(Cell {
            from,
            to,
            sides: self.features.expressions.iter().map(undecided).collect(),
            restart,
            source: None,
        })
    }

    fn examine(&self, cell: &mut Cell) -> Examined {
        let over = Interval::checked(cell.from, cell.to);
        let is_short = over.width() <= self.min_width;
        for (e, (source, pieces)) in self.features.expressions.iter().enumerate() {
            let sides = &mut cell.sides[e];
            for switch in &pieces.switches {
                let is_decided = sides[switch.op][switch.function].is_some();
                if is_decided || pieces.is_unused(switch.op, sides) {
                    continue;
                }
                match decide(pieces, switch, over, self.start, sides) {
                    Decision::Side(side) => sides[switch.op][switch.function] = Some(side),
                    Decision::Unknown if is_short => {
                        let side = side_within(pieces, switch, over, self.start);
                        sides[switch.op][switch.function] = Some(side);
                    }
                    Decision::Unknown => return Examined::Halve(*source),
                    Decision::Root { level, values } => {
                        let between = bracket(pieces, switch, level, over, values);
                        let sides = match switch.at_integers {
                            true if values[0] < values[1] => [level - 1.0, level],
                            true => [level, level - 1.0],
                            false => values.map(f64::signum),
                        };
                        return Examined::SwitchAt {
                            expression: e,
                            switch: *switch,
                            between,
                            sides,
                        };
                    }
                }
            }
        }
        let mut narrowest = None;
        for (e, (source, pieces)) in self.features.expressions.iter().enumerate() {
            for (&term, &scale) in pieces.terms.iter().zip(&self.scales[e]) {
                let [value, slope, second] = pieces.enclose(term, over, &cell.sides[e]).0;
                // Difference from a parabola, a line or a constant: if an exponential overflows, only the value is bounded.
                let w = over.width();
                let deviations = [
                    second.width() * w * w / 16.0,
                    slope.width() * w / 4.0,
                    value.width(),
                ];
                let deviation = deviations.into_iter().fold(f64::INFINITY, f64::min);
                if !(deviation <= SMOOTHNESS * scale + NOTHING || is_short) {
                    return Examined::Halve(*source);
                }
                if deviation > 0.02 * SMOOTHNESS * scale {
                    narrowest = Some(*source);
                }
            }
        }
        Examined::Smooth(narrowest)
    }

    /// The first instant of the first cell at which its switches are on their sides: a switch may lie exactly at the start.
    fn first_instant(&self, cell: &Cell) -> f64 {
        const GROWTH: f64 = 16.0;
        let rounding = (f64::EPSILON * cell.from.abs()).max(NOTHING);
        let shifts = std::iter::successors(Some(rounding), |shift| Some(GROWTH * shift))
            .take_while(|&shift| shift < self.min_width);
        let instants = || std::iter::once(cell.from).chain(shifts.clone().map(|s| cell.from + s));
        let mut first = cell.from;
        for ((_, pieces), sides) in self.features.expressions.iter().zip(&cell.sides) {
            for switch in &pieces.switches {
                let Some(side) = sides[switch.op][switch.function] else {
                    continue;
                };
                let is_there = |x: &f64| switch.side(pieces.switch_value(switch, *x)) == side;
                first = instants().find(is_there).unwrap_or(first).max(first);
            }
        }
        first.min(cell.to)
    }

    /// The piece of a smooth cell, shortened by laws that are smooth over shorter lengths.
    fn piece(&self, cell: &Cell, source: Option<usize>) -> Piece {
        let middle = 0.5 * (cell.from + cell.to);
        let (mut width, mut source) = (cell.to - cell.from, source.or(cell.source));
        for bands in &self.features.bands {
            let k = bands.partition_point(|band| band.to < middle);
            if let Some(band) = bands.get(k).filter(|band| band.from <= middle)
                && band.width < width
            {
                (width, source) = (band.width, Some(band.source));
            }
        }
        Piece {
            from: cell.from,
            to: cell.to,
            width,
            restart: cell.restart,
            source,
        }
    }
}

/// An upper bound of the absolute value of each term.
pub(super) fn term_scales(pieces: &Pieces, from: f64, to: f64) -> Vec<f64> {
    let part = |k: usize| from + (to - from) * k as f64 / SCALE_PARTS as f64;
    let sides = vec![[None; 2]; pieces.len()];
    let scale = |&term: &usize| {
        let of = |k: usize| {
            let over = Interval::checked(part(k), part(k + 1));
            let bound = pieces.enclose(term, over, &sides).value().magnitude();
            if bound.is_finite() {
                bound
            } else {
                pieces.term_value(term, over.lo).abs()
            }
        };
        let finite = (0..SCALE_PARTS).map(of).filter(|s| s.is_finite());
        finite.fold(0.0, f64::max)
    };
    pieces.terms.iter().map(scale).collect()
}

impl Iterator for Scan<'_> {
    type Item = Result<Piece, Unresolved>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.failed {
            let next = match self.next_piece() {
                Ok(next) => next,
                Err(error) => {
                    self.failed = true;
                    return Some(Err(error));
                }
            };
            let Some((mut piece, sides)) = next else {
                return self.held.take().map(|(piece, _)| Ok(piece));
            };
            if let Some((held, held_sides)) = &mut self.held
                && !held.restart
                && differ(held_sides, &sides)
            {
                // A function switches exactly where two cells meet.
                held.restart = true;
                let rounding = ROUNDINGS * f64::EPSILON * piece.from.abs();
                held.to = (held.to - rounding).max(held.from);
                piece.from = (piece.from + rounding).min(piece.to);
            }
            if let Some((held, _)) = self.held.replace((piece, sides)) {
                return Some(Ok(held));
            }
        }
        None
    }
}

/// Whether a switch is on different sides in two decisions.
fn differ(one: &[Vec<Sides>], other: &[Vec<Sides>]) -> bool {
    let pairs = one.iter().flatten().zip(other.iter().flatten());
    let mut sides = pairs.flat_map(|(a, b)| a.iter().zip(b));
    sides.any(|pair| matches!(pair, (Some(a), Some(b)) if a != b))
}

impl Scan<'_> {
    fn next_piece(&mut self) -> Result<Option<DecidedPiece>, Unresolved> {
        let mut last = 0;
        for _ in 0..MAX_TRIALS {
            let Some(mut cell) = self.open.pop().or_else(|| self.next_cell()) else {
                return Ok(None);
            };
            if cell.to <= cell.from {
                if let Some((held, _)) = &mut self.held {
                    held.restart |= cell.restart;
                }
                continue;
            }
            match self.examine(&mut cell) {
                Examined::Smooth(source) => {
                    if cell.from == self.start {
                        cell.from = self.first_instant(&cell);
                    }
                    let piece = self.piece(&cell, source);
                    return Ok(Some((piece, cell.sides)));
                }
                Examined::Halve(source) => {
                    last = source;
                    cell.source = Some(source);
                    let middle = 0.5 * (cell.from + cell.to);
                    let first = Cell {
                        to: middle,
                        restart: false,
                        ..cell.clone()
                    };
                    cell.from = middle;
                    self.open.extend([cell, first]);
                }
                Examined::SwitchAt {
                    expression,
                    switch,
                    between: [before, behind],
                    sides,
                } => {
                    last = self.features.expressions[expression].0;
                    cell.source = Some(last);
                    let mut first = Cell {
                        to: before,
                        restart: true,
                        ..cell.clone()
                    };
                    cell.from = behind;
                    let decided = [&mut first, &mut cell];
                    for (cell, side) in decided.into_iter().zip(sides) {
                        cell.sides[expression][switch.op][switch.function] = Some(side);
                    }
                    self.open.extend([cell, first]);
                }
            }
        }
        let at = self.open.last().map_or(self.from, |cell| cell.from);
        Err(Unresolved {
            source_index: last,
            at,
        })
    }
}
