//! The mode of a motion from one event to the next: the pieces of its loads and drives, the switch along which it slides, and the state
//! with which the mode starts.
//!
//! At an event a switching function is zero within rounding, and its sign is meaningless. Therefore a row after the event is evaluated on
//! the pieces after it, and a row before the event on the pieces before it.

use crate::crossings::are_together;
use crate::ode::OdeState;
use crate::sliding::Sliding;
use std::borrow::Cow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The modes of a motion, in order of time; empty if nothing switches and no surfaces or end stops are in contact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionModes {
    /// The state with which each begins, and along which switch it slides.
    begins: Vec<(OdeState, Option<Sliding>)>,
    /// By switch: the numbers of the modes from which on it has another piece, and that piece.
    pieces: Vec<Vec<(usize, Option<f64>)>>,
}

/// A mode of a motion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mode<'m> {
    /// By switch: the piece that is held, if one is.
    pub(crate) pieces: Vec<Option<f64>>,
    /// The switch along which the motion slides.
    pub(crate) sliding: Option<&'m Sliding>,
}

/// The side of an event to which a state at its time belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventSide {
    /// The end of the motion before the event.
    Before,
    /// The start of the motion after the event.
    After,
}

impl MotionModes {
    /// Adds a mode that begins at a state.
    pub(crate) fn add(
        &mut self,
        state: &OdeState,
        pieces: &[Option<f64>],
        sliding: Option<&Sliding>,
    ) {
        self.pieces.resize(pieces.len(), Vec::new());
        for (changes, &piece) in self.pieces.iter_mut().zip(pieces) {
            if changes.last().is_none_or(|(_, last)| *last != piece) {
                changes.push((self.begins.len(), piece));
            }
        }
        self.begins.push((state.clone(), sliding.cloned()));
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.begins.is_empty()
    }

    /// Whether a mode begins at a time, s.
    pub fn begin_at(&self, t: f64) -> bool {
        let found = self.begins.binary_search_by(|(b, _)| b.t.total_cmp(&t));
        found.is_ok()
    }

    /// The number of the mode at a time (s) on a side of an event; `None` if there are no modes.
    fn number_at(&self, t: f64, side: EventSide) -> Option<usize> {
        let has_begun = |at: f64| match side {
            EventSide::Before => at < t,
            EventSide::After => at <= t || are_together(at, t),
        };
        let begun = self.begins.partition_point(|(begin, _)| has_begun(begin.t));
        let last = self.begins.len().checked_sub(1)?;
        Some(begun.saturating_sub(1).min(last))
    }

    /// A state of the motion with the speeds and the contacts of its side of an event.
    pub fn state_at<'s>(&self, state: &'s OdeState, side: EventSide) -> Cow<'s, OdeState> {
        let begin = self.number_at(state.t, side).map(|k| &self.begins[k].0);
        match begin {
            Some(begin) if side == EventSide::After && are_together(begin.t, state.t) => {
                Cow::Owned(OdeState {
                    t: state.t,
                    y: begin.y.clone(),
                })
            }
            _ => Cow::Borrowed(state),
        }
    }

    /// The mode at a time (s) on a side of an event; `None` if there are no modes.
    pub(crate) fn mode_at(&self, t: f64, side: EventSide) -> Option<Mode<'_>> {
        let number = self.number_at(t, side)?;
        let pieces = self.pieces.iter().map(|changes| {
            let count = changes.partition_point(|(first, _)| *first <= number);
            changes[..count].last().and_then(|(_, piece)| *piece)
        });
        Some(Mode {
            pieces: pieces.collect(),
            sliding: self.begins[number].1.as_ref(),
        })
    }
}

/// The modes of a motion during its integration, shared with its observers.
#[derive(Debug, Clone, Default)]
pub struct SharedModes(Arc<Mutex<MotionModes>>);

impl SharedModes {
    pub(crate) fn get(&self) -> MutexGuard<'_, MotionModes> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All of them; they are taken.
    pub fn take(&self) -> MotionModes {
        std::mem::take(&mut self.get())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 7 switches that change at random, one or more at a time, each mode has the pieces it was given, from its own side of each event.
    #[test]
    fn every_mode_has_its_pieces_from_either_side() {
        let (mut random, mut modes) = (17_u64, MotionModes::default());
        let mut next = |count: u64| {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (random >> 33) % count
        };
        let (mut pieces, mut all) = (vec![None; 7], Vec::new());
        for k in 0..200_u32 {
            for _ in 0..next(3) {
                pieces[next(7) as usize] = [None, Some(-1.0), Some(1.0)][next(3) as usize];
            }
            let state = OdeState {
                t: f64::from(k),
                y: vec![f64::from(k)],
            };
            modes.add(&state, &pieces, None);
            all.push(pieces.clone());
        }
        for k in 0..200 {
            let state = OdeState {
                t: k as f64,
                y: vec![-1.0],
            };
            let pieces_at = |t: f64, side| modes.mode_at(t, side).expect("a mode").pieces;
            assert_eq!(modes.state_at(&state, EventSide::After).y, [k as f64]);
            assert_eq!(modes.state_at(&state, EventSide::Before).y, [-1.0]);
            assert_eq!(pieces_at(state.t, EventSide::After), all[k]);
            assert_eq!(pieces_at(state.t, EventSide::Before), all[k.max(1) - 1]);
            assert_eq!(pieces_at(state.t + 0.5, EventSide::After), all[k]);
        }
    }
}
