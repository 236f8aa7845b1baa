//! The interface of the WebAssembly module: five functions over plain memory.
//!
//! A caller gets memory for its request from [`room`], writes the request there, calls [`respond`], and copies the answer before its next call: text
//! of [`text_bytes`] bytes at the address that `respond` returns, and [`number_count`] numbers at [`numbers`].
//!
//! Exported symbols with fixed names are unsafe code. A generator of bindings (wasm-bindgen) would be a tool to be
//! installed in exactly one version, with generated JavaScript. Memory is passed by addresses only: nothing here
//! dereferences one, and the buffers live until the next call of the same thread.
#![allow(unsafe_code, reason = "symbols that a browser finds by their names")]

use crate::answer::{Answer, answer};
use std::cell::RefCell;

#[derive(Default)]
struct Buffers {
    request: Vec<u8>,
    answer: Answer,
}

thread_local! {
    static BUFFERS: RefCell<Buffers> = RefCell::default();
}

/// Allocates memory for a request of `bytes` bytes, and returns its address.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn room(bytes: usize) -> *mut u8 {
    BUFFERS.with_borrow_mut(|buffers| {
        buffers.request.clear();
        buffers.request.resize(bytes, 0);
        buffers.request.as_mut_ptr()
    })
}

/// Answers the written request, and returns the address of the answer's text.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn respond() -> *const u8 {
    BUFFERS.with_borrow_mut(|buffers| {
        buffers.answer = answer(&String::from_utf8_lossy(&buffers.request));
        buffers.answer.text.as_ptr()
    })
}

/// Length of the answer's text, bytes.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn text_bytes() -> usize {
    BUFFERS.with_borrow(|buffers| buffers.answer.text.len())
}

/// The address of the answer's numbers.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn numbers() -> *const f64 {
    BUFFERS.with_borrow(|buffers| buffers.answer.numbers.as_ptr())
}

/// Number of numbers in the answer.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn number_count() -> usize {
    BUFFERS.with_borrow(|buffers| buffers.answer.numbers.len())
}
