//! Four numbers in one register, where the processor has AVX2.
//!
//! Measured beside [`Lanes`], which the compiler puts into registers half as wide (ns a pose of a batch):
//! single-dwell 37 for 59, four-bar 24 for 41, slider-crank 28 for 44. Compiling [`Lanes`] for AVX2 gains half of
//! that at best: sums over several steps it takes apart into pieces of 8, 16 and 8 bytes.
//!
//! This is the only unsafe code of the project. It is sound as long as there are such numbers only on
//! processors with AVX2: the type is private, and [`reduce`] asks the processor first. No operation is fused
//! with another, so each number has the bits of a plain evaluation.
#![allow(unsafe_code, reason = "the gain measured above")]

use crate::batch::{LANES, Part, Side};
use crate::model::Model;
use dwell_geometry::{Lanes, PlaceError, Scalar, circle};
use std::arch::x86_64::{
    __m256d, _mm256_add_pd, _mm256_div_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_set1_pd,
    _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm256_xor_pd,
};
use std::array;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A part of a batch in such registers; it comes back where the processor has none, or the plan has
/// groups with functions of their own.
pub(crate) fn reduce<'a>(
    model: &Model,
    part: Part<'a>,
) -> Result<Vec<(usize, PlaceError)>, Part<'a>> {
    if model.plan().placed_by_dyads() && is_x86_feature_detected!("avx2") {
        // Sound: it has just been asked for.
        Ok(unsafe { reduce_with_avx2(model, part) })
    } else {
        Err(part)
    }
}

/// What is inlined here is compiled for AVX2, and nothing else is: so the whole evaluation is.
#[target_feature(enable = "avx2")]
fn reduce_with_avx2(model: &Model, part: Part<'_>) -> Vec<(usize, PlaceError)> {
    model.reduce_block::<Four>(part)
}

/// Four plain numbers in a register.
#[derive(Debug, Clone, Copy)]
struct Four(__m256d);

impl Side for Four {
    #[inline(always)]
    fn join(numbers: [f64; LANES]) -> Self {
        Self(unsafe { _mm256_loadu_pd(numbers.as_ptr()) })
    }

    #[inline(always)]
    fn split(self) -> [f64; LANES] {
        let mut numbers = [0.0; LANES];
        unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) };
        numbers
    }
}

impl Default for Four {
    #[inline(always)]
    fn default() -> Self {
        Self::lift(0.0)
    }
}

impl Scalar for Four {
    const DERIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    const LANES: usize = LANES;

    #[inline(always)]
    fn lift(value: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(value) })
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.split()[0]
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.split()[lane]
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        circle::sin_cos(self, Self::split, Self::join)
    }

    // The rest is for counted turns and laws, which are evaluated one by one.

    fn atan2(self, other: Self) -> Self {
        let (y, x) = (self.split(), other.split());
        Self::join(array::from_fn(|lane| y[lane].atan2(x[lane])))
    }

    fn through(self, derivatives: &[f64; 4]) -> Self {
        Self::join(Lanes(self.split()).through(derivatives).0)
    }
}

impl Neg for Four {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $instruction:ident) => {
        impl $trait for Four {
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

impl AddAssign for Four {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Four {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
