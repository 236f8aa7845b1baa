//! On what a motion is from one event to the next: the pieces of its loads and drives, the switch that it slides along, and the state with
//! which it begins there.
//!
//! At an event a switching function is zero but for rounding, and the sign of that rounding says nothing. So a row there is evaluated on the
//! pieces that the motion takes from there on, and the end of what leads up to it on those before.

use crate::crossings::are_together;
use crate::ode::OdeState;
use crate::sliding::Sliding;
use std::borrow::Cow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The modes of a motion, in order of time: none where nothing switches and no surfaces or end stops touch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionModes {
    begins: Vec<ModeBegin>,
    /// The pieces of the last one.
    last: Vec<Option<f64>>,
    /// All pieces behind so many modes: there, as many have changed since the last time as there are.
    snapshots: Vec<(usize, Vec<Option<f64>>)>,
    changed: usize,
}

/// Where a mode begins.
#[derive(Debug, Clone, PartialEq)]
struct ModeBegin {
    state: OdeState,
    /// By switch whose piece changes: its piece from there on.
    pieces: Vec<(usize, Option<f64>)>,
    sliding: Option<Sliding>,
}

/// A mode of a motion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mode<'m> {
    /// By switch: the piece that is held, if one is.
    pub(crate) pieces: Vec<Option<f64>>,
    /// The switch along which the motion slides.
    pub(crate) sliding: Option<&'m Sliding>,
}

/// On which side of an event a state at its time is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventSide {
    /// As the end of what leads up to it.
    Before,
    /// As the beginning of what follows.
    Behind,
}

impl MotionModes {
    /// Adds a mode that begins at a state.
    pub(crate) fn add(
        &mut self,
        state: &OdeState,
        pieces: &[Option<f64>],
        sliding: Option<&Sliding>,
    ) {
        self.last.resize(pieces.len(), None);
        let both = pieces.iter().zip(&mut self.last).enumerate();
        let changed = both.filter(|(_, (now, last))| *now != *last);
        let changed = changed.map(|(k, (now, last))| {
            *last = *now;
            (k, *now)
        });
        let pieces: Vec<_> = changed.collect();
        self.changed += pieces.len() + 1;
        self.begins.push(ModeBegin {
            state: state.clone(),
            pieces,
            sliding: sliding.cloned(),
        });
        if self.changed >= self.last.len() {
            self.snapshots.push((self.begins.len(), self.last.clone()));
            self.changed = 0;
        }
    }

    /// Whether a mode begins at a time, s.
    pub fn begin_at(&self, t: f64) -> bool {
        let found = self.begins.binary_search_by(|b| b.state.t.total_cmp(&t));
        found.is_ok()
    }

    /// How many modes have begun at a time, s; at least the first.
    fn count_at(&self, t: f64, side: EventSide) -> usize {
        let is_behind = |at: f64| match side {
            EventSide::Before => at < t,
            EventSide::Behind => at <= t || are_together(at, t),
        };
        let count = self.begins.partition_point(|b| is_behind(b.state.t));
        count.max(1).min(self.begins.len())
    }

    /// A state of the motion with the speeds and the contacts of its side of an event.
    pub fn state_at<'s>(&self, state: &'s OdeState, side: EventSide) -> Cow<'s, OdeState> {
        let count = self.count_at(state.t, side);
        let begin = self.begins[..count].last().map(|begin| &begin.state);
        let begins_there =
            |begin: &&OdeState| side == EventSide::Behind && are_together(begin.t, state.t);
        let owned = |begin: &OdeState| {
            Cow::Owned(OdeState {
                t: state.t,
                y: begin.y.clone(),
            })
        };
        begin
            .filter(begins_there)
            .map_or(Cow::Borrowed(state), owned)
    }

    /// The mode at a time (s) on a side of an event; none where there are no modes.
    pub(crate) fn mode_at(&self, t: f64, side: EventSide) -> Option<Mode<'_>> {
        let count = self.count_at(t, side);
        let begin = self.begins[..count].last()?;
        Some(Mode {
            pieces: self.pieces_behind(count),
            sliding: begin.sliding.as_ref(),
        })
    }

    /// The pieces behind so many changes.
    fn pieces_behind(&self, count: usize) -> Vec<Option<f64>> {
        let earlier = self
            .snapshots
            .partition_point(|(behind, _)| *behind <= count);
        let snapshot = earlier.checked_sub(1).and_then(|k| self.snapshots.get(k));
        let (from, mut pieces) = snapshot
            .cloned()
            .unwrap_or_else(|| (0, vec![None; self.last.len()]));
        for begin in &self.begins[from..count] {
            for &(k, piece) in &begin.pieces {
                pieces[k] = piece;
            }
        }
        pieces
    }
}

/// The modes of a motion while it is integrated: what observes it sees them, too.
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
            assert_eq!(modes.state_at(&state, EventSide::Behind).y, [k as f64]);
            assert_eq!(modes.state_at(&state, EventSide::Before).y, [-1.0]);
            assert_eq!(pieces_at(state.t, EventSide::Behind), all[k]);
            assert_eq!(pieces_at(state.t, EventSide::Before), all[k.max(1) - 1]);
            assert_eq!(pieces_at(state.t + 0.5, EventSide::Behind), all[k]);
        }
    }
}
