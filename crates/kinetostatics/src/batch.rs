//! The reduced model at many coordinates: several poses side by side in each thread, blocks of them on all
//! threads. Every value is that of a single evaluation, to the last bit.

use crate::model::{Model, Workspace};
use crate::reduced::{Coefficients, Exact};
use dwell_geometry::{Lanes, PlaceError, Scalar};
use std::ops::Range;

/// Poses side by side: two registers of the plainest x86-64, one where there is AVX2.
pub(crate) const LANES: usize = 4;
/// Fewest coordinates that one thread does at a time: the working memory it takes is small beside them.
const BLOCK: usize = 1024;
/// Blocks for each thread, so that none waits long for the last one.
const SHARES: usize = 4;

/// The coefficients at many coordinates, each kind in one piece.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// By coordinate: m, kg m².
    pub m: Vec<f64>,
    /// By coordinate: ½m′, kg m².
    pub half_dm: Vec<f64>,
    /// Those of all reactions at the first coordinate, then at the second: a, kg m or kg m².
    pub a: Vec<f64>,
    /// In the same order: b, kg m or kg m².
    pub b: Vec<f64>,
    /// Where there is no pose: the place of the coordinate, and why. The values there are no numbers.
    pub errors: Vec<(usize, PlaceError)>,
}

impl Batch {
    /// The coefficients at the `i`th coordinate; no numbers where there is none.
    pub fn at(&self, i: usize) -> Coefficients {
        let reactions = self.a.len() / self.m.len().max(1);
        let one = |of: &[f64]| of.get(i).copied().unwrap_or(f64::NAN);
        let all = |of: &[f64]| {
            of.iter()
                .skip(i * reactions)
                .take(reactions)
                .copied()
                .collect()
        };
        Coefficients {
            m: one(&self.m),
            half_dm: one(&self.half_dm),
            a: all(&self.a),
            b: all(&self.b),
        }
    }
}

/// A part of a batch to be filled; the place of its first coordinate.
pub(crate) struct Part<'a> {
    first: usize,
    q: &'a [f64],
    m: &'a mut [f64],
    half_dm: &'a mut [f64],
    a: &'a mut [f64],
    b: &'a mut [f64],
}

impl<'a> Part<'a> {
    fn split(self, at: usize, reactions: usize) -> [Self; 2] {
        let (q0, q1) = self.q.split_at(at);
        let (m0, m1) = self.m.split_at_mut(at);
        let (half_dm0, half_dm1) = self.half_dm.split_at_mut(at);
        let (a0, a1) = self.a.split_at_mut(at * reactions);
        let (b0, b1) = self.b.split_at_mut(at * reactions);
        let part = |first, q, m, half_dm, a, b| Self {
            first,
            q,
            m,
            half_dm,
            a,
            b,
        };
        [
            part(self.first, q0, m0, half_dm0, a0, b0),
            part(self.first + at, q1, m1, half_dm1, a1, b1),
        ]
    }
}

/// [`LANES`] plain numbers side by side.
pub(crate) trait Side: Scalar {
    fn join(numbers: [f64; LANES]) -> Self;
    fn split(self) -> [f64; LANES];
}

impl Side for Lanes<LANES> {
    #[inline(always)]
    fn join(numbers: [f64; LANES]) -> Self {
        Self(numbers)
    }

    #[inline(always)]
    fn split(self) -> [f64; LANES] {
        self.0
    }
}

/// Working memory with room for its results.
struct Room<T>(Workspace<T>, Coefficients<T>);

impl<T: Scalar> Room<T> {
    fn new(model: &Model) -> Self {
        Self(model.workspace(), model.coefficients())
    }
}

impl Exact {
    /// All coefficients at many coordinates `q` (rad or m), on all threads; `out` is made to fit, and keeps
    /// its storage from one batch to the next. Where there is no pose, [`Batch::errors`] says so.
    pub fn reduce_all(&self, q: &[f64], out: &mut Batch) {
        self.model().reduce_all(q, out);
    }

    /// m and ½m′ alone at many coordinates, as [`Exact::reduce_all`] does.
    pub fn inertia_all(&self, q: &[f64], out: &mut Batch) {
        self.bare().reduce_all(q, out);
    }
}

impl Model {
    fn reduce_all(&self, q: &[f64], out: &mut Batch) {
        let each = q.len() * self.reactions().len();
        for (values, count) in [
            (&mut out.m, q.len()),
            (&mut out.half_dm, q.len()),
            (&mut out.a, each),
            (&mut out.b, each),
        ] {
            values.clear();
            values.resize(count, f64::NAN);
        }
        let part = Part {
            first: 0,
            q,
            m: &mut out.m,
            half_dm: &mut out.half_dm,
            a: &mut out.a,
            b: &mut out.b,
        };
        let shares = match rayon::current_num_threads() {
            1 => 1,
            threads => SHARES * threads,
        };
        out.errors = self.reduce_part(part, BLOCK.max(q.len().div_ceil(shares)));
    }

    /// Halves it among the threads down to a block.
    fn reduce_part(&self, part: Part<'_>, block: usize) -> Vec<(usize, PlaceError)> {
        let blocks = part.q.len().div_ceil(block);
        if blocks < 2 {
            return self.reduce_widest(part);
        }
        let [one, two] = part.split(blocks / 2 * block, self.reactions().len());
        let (mut errors, more) = rayon::join(
            || self.reduce_part(one, block),
            || self.reduce_part(two, block),
        );
        errors.extend(more);
        errors
    }

    /// In the widest registers that the processor has.
    fn reduce_widest(&self, part: Part<'_>) -> Vec<(usize, PlaceError)> {
        #[cfg(target_arch = "x86_64")]
        let part = match crate::four::reduce(self, part) {
            Ok(errors) => return errors,
            Err(part) => part,
        };
        self.reduce_block::<Lanes<LANES>>(part)
    }

    /// Four by four, and alone what is left over or goes different ways.
    #[inline(always)]
    pub(crate) fn reduce_block<S: Side>(&self, mut part: Part<'_>) -> Vec<(usize, PlaceError)> {
        // For several poses at once, and for one where they part; few blocks need both.
        let mut lanes: Option<Room<S>> = None;
        let in_lanes = self.plan().placed_in_lanes();
        let mut plain = None;
        let mut errors = Vec::new();
        let mut at = 0;
        while at < part.q.len() {
            let together = in_lanes && {
                let room = lanes.get_or_insert_with(|| Room::new(self));
                self.reduce_lanes(&mut part, at, room)
            };
            let next = part.q.len().min(at + LANES);
            if !together {
                let room = plain.get_or_insert_with(|| Room::new(self));
                self.reduce_singly(&mut part, at..next, room, &mut errors);
            }
            at = next;
        }
        errors
    }

    /// As many poses as there are lanes from the `at`th on, if all of them go the same way.
    #[inline(always)]
    fn reduce_lanes<S: Side>(&self, part: &mut Part<'_>, at: usize, room: &mut Room<S>) -> bool {
        let Some(&q) = part.q[at..].first_chunk() else {
            return false;
        };
        let Room(work, out) = room;
        if self.reduce(S::join(q), work, out).is_err() {
            return false;
        }
        part.m[at..at + LANES].copy_from_slice(&out.m.split());
        part.half_dm[at..at + LANES].copy_from_slice(&out.half_dm.split());
        let reactions = out.a.len();
        for (values, to) in [(&out.a, &mut *part.a), (&out.b, &mut *part.b)] {
            for (k, value) in values.iter().enumerate() {
                for (lane, value) in value.split().into_iter().enumerate() {
                    to[(at + lane) * reactions + k] = value;
                }
            }
        }
        true
    }

    // Not for wider registers: alone, a pose has no use for them.
    #[inline(never)]
    fn reduce_singly(
        &self,
        part: &mut Part<'_>,
        which: Range<usize>,
        room: &mut Room<f64>,
        errors: &mut Vec<(usize, PlaceError)>,
    ) {
        let Room(work, out) = room;
        let reactions = out.a.len();
        for i in which {
            match self.reduce(part.q[i], work, out) {
                Ok(()) => {
                    (part.m[i], part.half_dm[i]) = (out.m, out.half_dm);
                    part.a[i * reactions..][..reactions].copy_from_slice(&out.a);
                    part.b[i * reactions..][..reactions].copy_from_slice(&out.b);
                }
                Err(error) => errors.push((part.first + i, error)),
            }
        }
    }
}
