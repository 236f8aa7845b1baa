//! The reduced model at many coordinates: several poses side by side in each thread, blocks of them on all
//! threads. Every value is that of a single evaluation, to the last bit.

use super::{Coefficients, ExactModel, LaneWork, in_lanes};
use crate::model::{Model, Workspace};
use dwell_geometry::PositionError;
use dwell_numerics::{Lanes, Scalar};
use std::ops::Range;

/// Poses side by side: two registers of any x86-64, one with AVX2.
pub(crate) const LANES: usize = 4;
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
    /// Where there is no pose: the index of the coordinate, and the reason. The values there are NaN.
    pub errors: Vec<(usize, PositionError)>,
}

/// The coordinates without a pose, by index, each with the reason.
type BatchErrors = Vec<(usize, PositionError)>;

impl Batch {
    /// The coefficients at the `i`th coordinate; NaN where there is no pose.
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
    m: &'a mut [f64],
    half_dm: &'a mut [f64],
    a: &'a mut [f64],
    b: &'a mut [f64],
}

impl<'a> BatchSlice<'a> {
    /// Takes off what follows the first `at` coordinates.
    fn split_off(&mut self, at: usize, reactions: usize) -> Self {
        let after = |values: &mut &'a mut [f64], at| -> &'a mut [f64] {
            values.split_off_mut(at..).unwrap_or_default()
        };
        Self {
            first: self.first + at,
            q: self.q.split_off(at..).unwrap_or_default(),
            m: after(&mut self.m, at),
            half_dm: after(&mut self.half_dm, at),
            a: after(&mut self.a, at * reactions),
            b: after(&mut self.b, at * reactions),
        }
    }
}

/// [`LANES`] plain numbers side by side.
pub(crate) trait LaneScalar: Scalar {
    fn from_array(numbers: [f64; LANES]) -> Self;
    fn to_array(self) -> [f64; LANES];
}

impl LaneScalar for Lanes<LANES> {
    #[inline(always)]
    fn from_array(numbers: [f64; LANES]) -> Self {
        Self(numbers)
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        self.0
    }
}

/// Working memory with a buffer for the results.
type ReductionWorkspace<T> = (Workspace<T>, Coefficients<T>);

impl ExactModel {
    /// All coefficients at many coordinates `q` (rad or m), on all threads; `out` is resized, and keeps
    /// its storage from one batch to the next. Where there is no pose, [`Batch::errors`] says so.
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
        let each = self.reactions().len();
        let columns = [
            (&mut out.m, 1),
            (&mut out.half_dm, 1),
            (&mut out.a, each),
            (&mut out.b, each),
        ];
        for (values, width) in columns {
            values.clear();
            values.resize(width * q.len(), f64::NAN);
        }
        let slice = BatchSlice {
            first: 0,
            q,
            m: &mut out.m,
            half_dm: &mut out.half_dm,
            a: &mut out.a,
            b: &mut out.b,
        };
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

    /// Four poses at a time; singly those that remain or whose computations diverge.
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
            let together = in_lanes && {
                let workspace = lanes.get_or_insert_with(|| self.reduction_workspace());
                self.reduce_lanes(&mut slice, at, workspace)
            };
            let next = slice.q.len().min(at + LANES);
            if !together {
                let workspace = scalar.get_or_insert_with(|| self.reduction_workspace());
                self.reduce_scalar(&mut slice, at..next, workspace, &mut errors);
            }
            at = next;
        }
        errors
    }

    /// As many poses as there are lanes from the `at`th on; false if their computations diverge.
    #[inline(always)]
    fn reduce_lanes<S: LaneScalar>(
        &self,
        slice: &mut BatchSlice<'_>,
        at: usize,
        workspace: &mut ReductionWorkspace<S>,
    ) -> bool {
        let Some(&q) = slice.q[at..].first_chunk() else {
            return false;
        };
        let (model_workspace, out) = workspace;
        if self.reduce(S::from_array(q), model_workspace, out).is_err() {
            return false;
        }
        slice.m[at..at + LANES].copy_from_slice(&out.m.to_array());
        slice.half_dm[at..at + LANES].copy_from_slice(&out.half_dm.to_array());
        let reactions = out.a.len();
        for (values, to) in [(&out.a, &mut *slice.a), (&out.b, &mut *slice.b)] {
            for (k, value) in values.iter().enumerate() {
                for (lane, value) in value.to_array().into_iter().enumerate() {
                    to[(at + lane) * reactions + k] = value;
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
        for i in indices {
            match self.reduce(slice.q[i], model_workspace, out) {
                Ok(()) => {
                    (slice.m[i], slice.half_dm[i]) = (out.m, out.half_dm);
                    slice.a[i * reactions..][..reactions].copy_from_slice(&out.a);
                    slice.b[i * reactions..][..reactions].copy_from_slice(&out.b);
                }
                Err(error) => errors.push((slice.first + i, error)),
            }
        }
    }
}
