//! Numbers side by side in registers, where the processor has AVX2 or AVX-512.
//!
//! Measured beside [`Lanes`](dwell_numerics::Lanes), which the compiler puts into registers of two (ns a pose of a batch, single-dwell,
//! four-bar and slider-crank): 59, 41 and 44 with those, 31, 19 and 21 in one register of AVX2, 17, 13 and 14 in two of
//! AVX-512 (the last two in one session, the first in an earlier one). Two registers also share the time to read the plan.
//! Compiling `Lanes` for AVX2 gains half of its gain at best: it splits sums over several steps into pieces of 8, 16 and 8 bytes.
//!
//! Unsafe code is in this file and in the symbols of `dwell-live` only. It is sound because such numbers exist only on processors with
//! these registers: the types are private, and [`run`] checks the processor first. No operation is fused with another, so each number
//! has the bits of a scalar evaluation.
#![allow(unsafe_code, reason = "the gain measured above")]

use super::LaneWork;
use super::batch::LaneScalar;
use crate::model::Model;
use dwell_numerics::sin_cos::{LanesInRegisters, sin_cos_by_lane, sin_cos_in_registers};
use dwell_numerics::{Lanes, Scalar};
use std::arch::x86_64::*;
use std::array;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Does work on a model in such registers; returns it where the processor has none, or the plan has groups whose
/// functions are not inlined.
pub(crate) fn run<W: LaneWork>(model: &Model, work: W) -> Result<W::Output, W> {
    if !model.plan().is_dyadic() {
        return Err(work);
    }
    let is_short = model.plan().group_count() <= MAX_GROUPS;
    // Sound: what each is compiled for has just been detected.
    if is_short && is_x86_feature_detected!("avx512f") {
        Ok(unsafe { run_with_avx512(work) })
    } else if is_x86_feature_detected!("avx2") {
        Ok(unsafe { run_with_avx2(work, is_short) })
    } else {
        Err(work)
    }
}

/// Of longer plans more than four poses no longer fit the caches: 16 poses of a chain of 100 four-bars take 69 ns a group and
/// pose, four take 15; of 30 they take 13 and 18.
const MAX_GROUPS: usize = 50;

// What is inlined here is compiled for these registers, and nothing else is: so the whole evaluation is.

#[target_feature(enable = "avx2")]
fn run_with_avx2<W: LaneWork>(work: W, is_short: bool) -> W::Output {
    if is_short {
        work.run::<Avx2Pair>()
    } else {
        work.run::<Avx2Lanes>()
    }
}

#[target_feature(enable = "avx512f")]
fn run_with_avx512<W: LaneWork>(work: W) -> W::Output {
    work.run::<Avx512Pair>()
}

/// A number type of some registers: `$width` numbers in each, `$count` of them.
macro_rules! lanes_in_registers {
    (
        $(#[$doc:meta])* $name:ident: $count:literal of $register:ty, $width:literal numbers each;
        $load:ident, $store:ident, $set:ident, $sqrt:ident, $max:ident, $above:expr;
        $add:ident, $sub:ident, $mul:ident, $div:ident;
        $to_bits:ident, $from_bits:ident, $set_bits:ident, $and:ident, $xor:ident, $plus:ident, $minus:ident, $shift:ident
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        struct $name([$register; $count]);

        impl $name {
            /// Each register by a function of it.
            #[inline(always)]
            fn map(mut self, of: impl Fn($register) -> $register) -> Self {
                for k in 0..$count {
                    self.0[k] = of(self.0[k]);
                }
                self
            }

            #[inline(always)]
            fn zip(mut self, other: Self, of: impl Fn($register, $register) -> $register) -> Self {
                for k in 0..$count {
                    self.0[k] = of(self.0[k], other.0[k]);
                }
                self
            }

            #[inline(always)]
            fn to_array(self) -> [f64; $count * $width] {
                let mut numbers = [0.0; $count * $width];
                self.store(&mut numbers);
                numbers
            }

            #[inline(always)]
            fn by_lane(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
                let (a, b) = (self.to_array(), other.to_array());
                Self::load(&array::from_fn::<f64, { $count * $width }, _>(|lane| of(a[lane], b[lane])))
            }
        }

        impl LanesInRegisters for $name {
            #[inline(always)]
            fn to_quadrants([sin, cos, k]: [Self; 3]) -> (Self, Self) {
                let (mut sin, mut cos) = (sin, cos);
                for i in 0..$count {
                    unsafe {
                        let s = $to_bits(sin.0[i]);
                        let c = $to_bits(cos.0[i]);
                        let k = $to_bits(k.0[i]);
                        let (zero, one, two) = ($set_bits(0), $set_bits(1), $set_bits(2));
                        let other = $and($xor(s, c), $minus(zero, $and(k, one)));
                        let sign_of_sin = $shift::<62>($and(k, two));
                        let sign_of_cos = $shift::<62>($and($plus(k, one), two));
                        sin.0[i] = $from_bits($xor($xor(s, other), sign_of_sin));
                        cos.0[i] = $from_bits($xor($xor(c, other), sign_of_cos));
                    }
                }
                (sin, cos)
            }

            fn sin_cos_by_lane(self) -> (Self, Self) {
                let (sin, cos) = sin_cos_by_lane(self.to_array());
                (Self::load(&sin), Self::load(&cos))
            }
        }

        impl LaneScalar for $name {
            #[inline(always)]
            fn load(numbers: &[f64]) -> Self {
                let numbers = &numbers[..$count * $width];
                let mut loaded = Self::default();
                for (register, numbers) in loaded.0.iter_mut().zip(numbers.chunks_exact($width)) {
                    *register = unsafe { $load(numbers.as_ptr()) };
                }
                loaded
            }

            #[inline(always)]
            fn store(self, to: &mut [f64]) {
                let to = &mut to[..$count * $width];
                for (register, to) in self.0.iter().zip(to.chunks_exact_mut($width)) {
                    unsafe { $store(to.as_mut_ptr(), *register) };
                }
            }

            #[inline(always)]
            fn maximum(self, other: Self) -> Self {
                self.zip(other, |a, b| unsafe { $max(a, b) })
            }

            #[inline(always)]
            fn lanes_above(self, other: Self) -> u64 {
                let mut lanes = 0;
                for k in 0..$count {
                    lanes |= unsafe { u64::from($above(self.0[k], other.0[k])) } << (k * $width);
                }
                lanes
            }
        }

        impl Default for $name {
            #[inline(always)]
            fn default() -> Self {
                Self::from_f64(0.0)
            }
        }

        impl Scalar for $name {
            const HAS_DERIVATIVES: bool = false;
            const EPSILON: f64 = f64::EPSILON;
            const LANES: usize = $count * $width;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                Self([unsafe { $set(value) }; $count])
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
            fn exceeds(self, other: Self) -> bool {
                self.lanes_above(other) == (1 << Self::LANES) - 1
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                self.map(|x| unsafe { $sqrt(x) })
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                sin_cos_in_registers(self)
            }

            // The rest is for counted revolutions and laws, which are evaluated one by one.

            fn atan2(self, other: Self) -> Self {
                self.by_lane(other, f64::atan2)
            }

            fn compose(self, derivatives: &[f64; 4]) -> Self {
                Self::load(&Lanes(self.to_array()).compose(derivatives).0)
            }
        }

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let mut out = self;
                for k in 0..$count {
                    let bits = unsafe { $to_bits(self.0[k]) };
                    out.0[k] = unsafe { $from_bits($xor(bits, $to_bits($set(-0.0)))) };
                }
                out
            }
        }

        lanes_in_registers!($name, Add, add, $add);
        lanes_in_registers!($name, Sub, sub, $sub);
        lanes_in_registers!($name, Mul, mul, $mul);
        lanes_in_registers!($name, Div, div, $div);

        impl AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
    };
    ($name:ident, $trait:ident, $function:ident, $instruction:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                self.zip(other, |a, b| unsafe { $instruction(a, b) })
            }
        }
    };
}

lanes_in_registers! {
    /// Four plain numbers in one register of AVX2.
    Avx2Lanes: 1 of __m256d, 4 numbers each;
    _mm256_loadu_pd, _mm256_storeu_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_max_pd,
    |a, b| _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(a, b)) as u8;
    _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd;
    _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_set1_epi64x, _mm256_and_si256, _mm256_xor_si256,
    _mm256_add_epi64, _mm256_sub_epi64, _mm256_slli_epi64
}

lanes_in_registers! {
    /// Eight plain numbers in two registers of AVX2.
    Avx2Pair: 2 of __m256d, 4 numbers each;
    _mm256_loadu_pd, _mm256_storeu_pd, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_max_pd,
    |a, b| _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(a, b)) as u8;
    _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd;
    _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_set1_epi64x, _mm256_and_si256, _mm256_xor_si256,
    _mm256_add_epi64, _mm256_sub_epi64, _mm256_slli_epi64
}

lanes_in_registers! {
    /// Sixteen plain numbers in two registers of AVX-512.
    Avx512Pair: 2 of __m512d, 8 numbers each;
    _mm512_loadu_pd, _mm512_storeu_pd, _mm512_set1_pd, _mm512_sqrt_pd, _mm512_max_pd,
    |a, b| _mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, b);
    _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd;
    _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_set1_epi64, _mm512_and_si512, _mm512_xor_si512,
    _mm512_add_epi64, _mm512_sub_epi64, _mm512_slli_epi64
}
