//! Integration across the switches and narrow features of functions of time.
//!
//! A step evaluates the loads at a few instants only. Therefore the integration ends before each switch and restarts
//! after it, and no step is much longer than the time over which a function varies ([`Features`]). Longer steps are
//! taken only if the user sets the longest step.

use crate::error::{DynamicsError, Result};
use crate::options::Options;
use dwell_laws::{Features, Piece, Scan, Unresolved};
use std::collections::VecDeque;

/// Longest step, in lengths over which everything is smooth: of a sinusoid 1.75 rad, in which each method evaluates it.
const WIDTHS_PER_STEP: f64 = 7.0;
/// Steps that an integration needs to start again.
const STEPS_PER_RESTART: f64 = 4.0;
/// Pieces by which the number of steps is predicted.
const PREDICTED_FROM: usize = 10_000;
/// The horizon for motions without an end, s.
const HORIZON: f64 = 1e6;

/// The limits of the steps of an integration in time.
pub(crate) struct TimePieces<'f> {
    switches: Scan<'f>,
    /// `None` if the user sets the longest step.
    smooth: Option<Scan<'f>>,
    /// The pieces from the present time on.
    ahead: VecDeque<Piece>,
    max_steps: usize,
}

impl<'f> TimePieces<'f> {
    /// Prepares an integration.
    ///
    /// # Errors
    /// [`DynamicsError::VariesTooFast`] where more steps are needed than allowed.
    pub(crate) fn new(
        features: &'f Features,
        from: f64,
        end: Option<f64>,
        options: &Options,
    ) -> Result<Self> {
        let to = end.unwrap_or(from + HORIZON);
        let switches = features.scan_switches(from, to);
        let is_free = options.max_step.is_none();
        let smooth = is_free.then(|| features.scan(from, to));
        if let Some(smooth) = &smooth {
            for (scan, steps) in [
                (&switches, STEPS_PER_RESTART),
                (smooth, 1.0 / WIDTHS_PER_STEP),
            ] {
                check_step_count(scan.clone(), [from, to], steps, options.max_steps)?;
            }
        }
        Ok(Self {
            switches,
            smooth,
            ahead: VecDeque::new(),
            max_steps: options.max_steps,
        })
    }

    /// The next part without a switch; none at the end.
    pub(crate) fn next_segment(&mut self) -> Result<Option<Piece>> {
        let mut from = None;
        loop {
            let Some(piece) = self.switches.next() else {
                return Ok(None);
            };
            let piece = piece.map_err(|e| unresolved(e, self.max_steps))?;
            let from = *from.get_or_insert(piece.from);
            // Pieces that are not separated by a switch belong together; an integration knows no shorter end.
            if piece.restart || self.switches.is_exhausted() {
                return Ok(Some(Piece { from, ..piece }));
            }
        }
    }

    /// The latest time at which a step that begins at `t` may end.
    pub(crate) fn latest_end(&mut self, t: f64) -> Result<f64> {
        let max_steps = self.max_steps;
        let Some(smooth) = &mut self.smooth else {
            return Ok(f64::INFINITY);
        };
        // An integrator stops within a rounding of where it is to stop.
        let reached = t + 8.0 * f64::EPSILON * t.abs();
        let mut latest = f64::INFINITY;
        let mut k = 0;
        loop {
            if k == self.ahead.len() {
                match smooth.next() {
                    Some(piece) => self
                        .ahead
                        .push_back(piece.map_err(|e| unresolved(e, max_steps))?),
                    None => return Ok(latest),
                }
            }
            let piece = self.ahead[k];
            if piece.from >= latest {
                return Ok(latest);
            }
            if piece.to <= reached {
                self.ahead.remove(k);
                continue;
            }
            let reach = t + WIDTHS_PER_STEP * piece.width;
            latest = latest.min(if k == 0 { reach } else { reach.max(piece.from) });
            k += 1;
        }
    }
}

/// Rejects functions that need more than the allowed steps, judged by their first pieces.
fn check_step_count(
    scan: Scan<'_>,
    [from, to]: [f64; 2],
    steps_per_piece: f64,
    max_steps: usize,
) -> Result<()> {
    let mut narrowest: Option<Piece> = None;
    let mut count = 0;
    let mut reached = from;
    for piece in scan.take(PREDICTED_FROM) {
        let piece = piece.map_err(|e| unresolved(e, max_steps))?;
        (count, reached) = (count + 1, piece.to);
        if narrowest.is_none_or(|n| piece.width < n.width) {
            narrowest = Some(piece);
        }
    }
    let predicted = steps_per_piece * count as f64 * (to - from) / (reached - from);
    match narrowest {
        Some(piece) if count == PREDICTED_FROM && predicted > max_steps as f64 => {
            Err(DynamicsError::VariesTooFast {
                source_index: piece.source.unwrap_or_default(),
                width: piece.width,
                t: piece.from,
                max_steps,
            })
        }
        _ => Ok(()),
    }
}

fn unresolved(Unresolved { source_index, at }: Unresolved, max_steps: usize) -> DynamicsError {
    DynamicsError::VariesTooFast {
        source_index,
        width: 0.0,
        t: at,
        max_steps,
    }
}
