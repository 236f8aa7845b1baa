//! The reduced model at many coordinates: several poses side by side in each thread, blocks of them on all
//! threads. Every value is that of a single evaluation, to the last bit.

use super::{Coefficients, ExactModel, LaneWork, in_lanes};
use crate::model::{Model, Workspace};
use dwell_geometry::PositionError;
use dwell_numerics::{Lanes, Scalar};
use std::ops::Range;

/// Poses side by side without wide registers: two registers of any x86-64.
pub(crate) const LANES: usize = 4;
/// Most poses side by side.
pub(crate) const MAX_LANES: usize = 16;
/// Least number of remaining poses of a block that are evaluated side by side.
const MIN_POSES: usize = 3;
/// Smallest block of one thread: its working memory is small in comparison.
const MIN_BLOCK: usize = 1024;
/// Blocks for each thread, so that all end at about the same time.
const BLOCKS_PER_THREAD: usize = 4;

/// The coefficients at many coordinates, each kind in one piece.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Batch {
    /// By coordinate: m, kg m².
    pub m: Vec<f64>,
    /// By coordinate: ½m′, kg m².
    pub half_dm: Vec<f64>,
    /// a of all reactions at the first coordinate, then at the second, kg m or kg m².
    pub a: Vec<f64>,
    /// b in the same order, kg m or kg m².
    pub b: Vec<f64>,
    /// Coordinates without a pose: the index of the coordinate, and the reason. Their values are NaN.
    pub errors: Vec<(usize, PositionError)>,
}

/// The coordinates without a pose, by index, each with the reason.
type BatchErrors = Vec<(usize, PositionError)>;

impl Batch {
    /// The coefficients at the `i`th coordinate; NaN if there is no pose.
    pub fn coefficients(&self, i: usize) -> Coefficients {
        let reactions = self.a.len() / self.m.len().max(1);
        let one = |of: &[f64]| of.get(i).copied().unwrap_or(f64::NAN);
        let all = |of: &[f64]| {
            let here = of.iter().skip(i * reactions).take(reactions);
            here.copied().collect()
        };
        Coefficients {
            m: one(&self.m),
            half_dm: one(&self.half_dm),
            a: all(&self.a),
            b: all(&self.b),
        }
    }
}

/// A part of a batch to be filled, with the index of its first coordinate.
struct BatchSlice<'a> {
    first: usize,
    q: &'a [f64],
    /// m, ½m′, a and b.
    columns: [&'a mut [f64]; 4],
}

/// How many numbers of each column a coordinate has.
fn column_widths(reactions: usize) -> [usize; 4] {
    [1, 1, reactions, reactions]
}

impl<'a> BatchSlice<'a> {
    /// Splits off the results after the first `at` coordinates.
    fn split_off(&mut self, at: usize, reactions: usize) -> Self {
        let widths = column_widths(reactions);
        let after = |k: usize| self.columns[k].split_off_mut(at * widths[k]..);
        Self {
            first: self.first + at,
            q: self.q.split_off(at..).unwrap_or_default(),
            columns: [0, 1, 2, 3].map(after).map(Option::unwrap_or_default),
        }
    }
}

/// At most [`MAX_LANES`] plain numbers side by side.
pub(crate) trait LaneScalar: Scalar {
    /// The first of some numbers, at least as many as there are lanes.
    fn load(numbers: &[f64]) -> Self;
    /// Puts them into the first of some places, at least as many as there are lanes.
    fn store(self, to: &mut [f64]);
    /// The larger number in each lane; if one of them is NaN, either of the two.
    fn maximum(self, other: Self) -> Self;
    /// By bit, whether the number in the lane exceeds that of another.
    fn lanes_above(self, other: Self) -> u64;
}

impl LaneScalar for Lanes<LANES> {
    #[inline(always)]
    fn load(numbers: &[f64]) -> Self {
        let mut loaded = [0.0; LANES];
        loaded.copy_from_slice(&numbers[..LANES]);
        Self(loaded)
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..LANES].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn maximum(self, other: Self) -> Self {
        let mut larger = self;
        for (larger, other) in larger.0.iter_mut().zip(other.0) {
            *larger = larger.max(other);
        }
        larger
    }

    #[inline(always)]
    fn lanes_above(self, other: Self) -> u64 {
        let above = |lane: usize| u64::from(self.0[lane] > other.0[lane]) << lane;
        (0..LANES).map(above).sum()
    }
}

/// Working memory with a buffer for the results.
type ReductionWorkspace<T> = (Workspace<T>, Coefficients<T>);

impl ExactModel {
    /// All coefficients at many coordinates `q` (rad or m), on all threads; `out` is resized, and keeps
    /// its storage from one batch to the next. [`Batch::errors`] lists the coordinates without a pose.
    pub fn reduce_batch(&self, q: &[f64], out: &mut Batch) {
        self.model.reduce_batch(q, out);
    }

    /// m and ½m′ alone at many coordinates, as [`ExactModel::reduce_batch`] does.
    pub fn inertia_batch(&self, q: &[f64], out: &mut Batch) {
        self.inertia_model.reduce_batch(q, out);
    }
}

/// A part of a batch, evaluated in one thread.
struct Block<'a> {
    model: &'a Model,
    slice: BatchSlice<'a>,
}

impl LaneWork for Block<'_> {
    type Output = BatchErrors;

    #[inline(always)]
    fn run<S: LaneScalar>(self) -> BatchErrors {
        self.model.reduce_block::<S>(self.slice)
    }
}

impl Model {
    fn reduce_batch(&self, q: &[f64], out: &mut Batch) {
        let mut columns = [&mut out.m, &mut out.half_dm, &mut out.a, &mut out.b];
        let widths = column_widths(self.reactions().len());
        for (values, width) in columns.iter_mut().zip(widths) {
            values.clear();
            values.resize(width * q.len(), f64::NAN);
        }
        let columns = columns.map(Vec::as_mut_slice);
        let first = 0;
        let slice = BatchSlice { first, q, columns };
        let blocks = match rayon::current_num_threads() {
            1 => 1,
            threads => BLOCKS_PER_THREAD * threads,
        };
        out.errors = self.reduce_in_parallel(slice, MIN_BLOCK.max(q.len().div_ceil(blocks)));
    }

    fn reduction_workspace<T: Scalar>(&self) -> ReductionWorkspace<T> {
        (self.workspace(), self.coefficient_buffer())
    }

    /// Divides the batch in halves among the threads, down to a block.
    fn reduce_in_parallel(&self, mut slice: BatchSlice<'_>, block: usize) -> BatchErrors {
        let blocks = slice.q.len().div_ceil(block);
        if blocks < 2 {
            return in_lanes(self, Block { model: self, slice });
        }
        let rest = slice.split_off(blocks / 2 * block, self.reactions().len());
        let (mut errors, more) = rayon::join(
            || self.reduce_in_parallel(slice, block),
            || self.reduce_in_parallel(rest, block),
        );
        errors.extend(more);
        errors
    }

    /// Several poses at a time; singly the last few, or those whose computations diverge.
    #[inline(always)]
    fn reduce_block<S: LaneScalar>(&self, mut slice: BatchSlice<'_>) -> BatchErrors {
        // For several poses at once, and for single ones where they diverge; few blocks need both.
        let mut lanes: Option<ReductionWorkspace<S>> = None;
        // An inertia over an angle is looked up, one pose at a time. In WebAssembly four poses take longer than one by one.
        let in_lanes = cfg!(not(target_family = "wasm"))
            && self.plan().supports_lanes()
            && self.pass_model.varying_inertias.is_empty();
        let mut scalar = None;
        let mut errors = Vec::new();
        let mut at = 0;
        while at < slice.q.len() {
            let next = slice.q.len().min(at + S::LANES);
            let together = in_lanes && next - at >= MIN_POSES && {
                let workspace = lanes.get_or_insert_with(|| self.reduction_workspace());
                self.reduce_lanes(&mut slice, at..next, workspace)
            };
            if !together {
                let workspace = scalar.get_or_insert_with(|| self.reduction_workspace());
                self.reduce_scalar(&mut slice, at..next, workspace, &mut errors);
            }
            at = next;
        }
        errors
    }

    /// Evaluates at most as many poses as there are lanes; the last pose fills unused lanes. Returns false if the
    /// computations of the lanes diverge.
    #[inline(always)]
    fn reduce_lanes<S: LaneScalar>(
        &self,
        slice: &mut BatchSlice<'_>,
        indices: Range<usize>,
        workspace: &mut ReductionWorkspace<S>,
    ) -> bool {
        let count = indices.len();
        let mut numbers = [0.0; MAX_LANES];
        numbers[..count].copy_from_slice(&slice.q[indices.clone()]);
        let last = numbers[count - 1];
        numbers[count..].fill(last);
        let (model_workspace, out) = workspace;
        let reduced = self.reduce(S::load(&numbers), model_workspace, out);
        if reduced.is_err() {
            return false;
        }
        let [m, half_dm, a, b] = &mut slice.columns;
        for (value, to) in [(out.m, m), (out.half_dm, half_dm)] {
            value.store(&mut numbers);
            to[indices.clone()].copy_from_slice(&numbers[..count]);
        }
        let reactions = out.a.len();
        for (values, to) in [(&out.a, a), (&out.b, b)] {
            let to = &mut to[indices.start * reactions..indices.end * reactions];
            for (k, value) in values.iter().enumerate() {
                value.store(&mut numbers);
                for (to, value) in to.chunks_exact_mut(reactions).zip(numbers) {
                    to[k] = value;
                }
            }
        }
        true
    }

    // Not compiled for wider registers: a single pose does not use them.
    #[inline(never)]
    fn reduce_scalar(
        &self,
        slice: &mut BatchSlice<'_>,
        indices: Range<usize>,
        workspace: &mut ReductionWorkspace<f64>,
        errors: &mut BatchErrors,
    ) {
        let (model_workspace, out) = workspace;
        let reactions = out.a.len();
        let [m, half_dm, a, b] = &mut slice.columns;
        for i in indices {
            match self.reduce(slice.q[i], model_workspace, out) {
                Ok(()) => {
                    (m[i], half_dm[i]) = (out.m, out.half_dm);
                    a[i * reactions..][..reactions].copy_from_slice(&out.a);
                    b[i * reactions..][..reactions].copy_from_slice(&out.b);
                }
                Err(error) => errors.push((slice.first + i, error)),
            }
        }
    }
}
