//! `hypot` by the version that every glibc has.
//!
//! Of all functions that this module takes from glibc only `hypot` has a version of 2.35, whose one difference is that it does not set
//! `errno`. The linker would take that one, and the package would not load where glibc is older. So it is told (`--wrap`, in build.rs) to send
//! every call here, and here the first version is called: the same values to the last bit.
//!
//! This is unsafe code: a function of the C library, of two numbers, under another name.
#![allow(unsafe_code, reason = "a function of the C library by its version")]

std::arch::global_asm!(".symver dwell_oldest_hypot, hypot@GLIBC_2.2.5");

unsafe extern "C" {
    fn dwell_oldest_hypot(x: f64, y: f64) -> f64;
}

/// What the linker calls in place of `hypot`.
#[unsafe(no_mangle)]
extern "C" fn __wrap_hypot(x: f64, y: f64) -> f64 {
    // SAFETY: a pure function of two numbers.
    unsafe { dwell_oldest_hypot(x, y) }
}
