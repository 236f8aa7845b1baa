//! The version of `hypot` that every glibc has.
//!
//! Of all functions that this module uses from glibc, only `hypot` has a version of 2.35; its only difference is that it does not set
//! `errno`. The linker would take this version, and the package would not load with an older glibc. Therefore the linker redirects
//! every call to this file (`--wrap`, in build.rs), which calls the first version, with the same values bit for bit.
//!
//! This is unsafe code: it calls a function of the C library with two numbers.
#![allow(unsafe_code, reason = "a function of the C library by its version")]

std::arch::global_asm!(".symver dwell_oldest_hypot, hypot@GLIBC_2.2.5");

unsafe extern "C" {
    fn dwell_oldest_hypot(x: f64, y: f64) -> f64;
}

/// The replacement of `hypot`.
#[unsafe(no_mangle)]
extern "C" fn __wrap_hypot(x: f64, y: f64) -> f64 {
    // SAFETY: a pure function of two numbers.
    unsafe { dwell_oldest_hypot(x, y) }
}
