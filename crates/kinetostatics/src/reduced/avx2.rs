//! Four numbers in one register, where the processor has AVX2.
//!
//! Measured beside [`Lanes`], which the compiler puts into registers half as wide (ns a pose of a batch):
//! single-dwell 37 for 59, four-bar 24 for 41, slider-crank 28 for 44. Compiling [`Lanes`] for AVX2 gains half of
//! that at best: sums over several steps it takes apart into pieces of 8, 16 and 8 bytes.
//!
//! Unsafe code is in this file and in the symbols of `dwell-live` only. It is sound as long as such numbers exist only on
//! processors with AVX2: the type is private, and [`run`] checks the processor first. No operation is fused
//! with another, so each number has the bits of a scalar evaluation.
#![allow(unsafe_code, reason = "the gain measured above")]

use super::LaneWork;
use super::batch::{LANES, LaneScalar};
use crate::model::Model;
use dwell_numerics::{Lanes, Scalar, sin_cos};
use std::arch::x86_64::{
    __m256d, _mm256_add_pd, _mm256_div_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_set1_pd,
    _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd,
};
use std::array;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Does work on a model in such registers; returns it where the processor has none, or the plan has groups whose
/// functions are not inlined.
pub(crate) fn run<W: LaneWork>(model: &Model, work: W) -> Result<W::Output, W> {
    if model.plan().is_dyadic() && is_x86_feature_detected!("avx2") {
        // Sound: AVX2 has just been detected.
        Ok(unsafe { run_with_avx2(work) })
    } else {
        Err(work)
    }
}

/// What is inlined here is compiled for AVX2, and nothing else is: so the whole evaluation is.
#[target_feature(enable = "avx2")]
fn run_with_avx2<W: LaneWork>(work: W) -> W::Output {
    work.run::<Avx2Lanes>()
}

/// Four plain numbers in a register.
#[derive(Debug, Clone, Copy)]
struct Avx2Lanes(__m256d);

impl LaneScalar for Avx2Lanes {
    #[inline(always)]
    fn from_array(numbers: [f64; LANES]) -> Self {
        Self(unsafe { _mm256_loadu_pd(numbers.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut numbers = [0.0; LANES];
        unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) };
        numbers
    }
}

impl Default for Avx2Lanes {
    #[inline(always)]
    fn default() -> Self {
        Self::from_f64(0.0)
    }
}

impl Scalar for Avx2Lanes {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    const LANES: usize = LANES;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(value) })
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.to_array()[0]
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.to_array()[lane]
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos::sin_cos(self, Self::to_array, Self::from_array)
    }

    // The rest is for counted revolutions and laws, which are evaluated one by one.

    fn atan2(self, other: Self) -> Self {
        let (y, x) = (self.to_array(), other.to_array());
        Self::from_array(array::from_fn(|lane| y[lane].atan2(x[lane])))
    }

    fn compose(self, derivatives: &[f64; 4]) -> Self {
        Self::from_array(Lanes(self.to_array()).compose(derivatives).0)
    }
}

impl Neg for Avx2Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $instruction:ident) => {
        impl $trait for Avx2Lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

operator!(Add, add, _mm256_add_pd);
operator!(Sub, sub, _mm256_sub_pd);
operator!(Mul, mul, _mm256_mul_pd);
operator!(Div, div, _mm256_div_pd);

impl AddAssign for Avx2Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Avx2Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
