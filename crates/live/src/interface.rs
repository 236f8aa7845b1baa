//! The module as a browser calls it: five functions over plain memory.
//!
//! A caller asks for [`room`] for its request, writes it there, calls [`respond`], and copies the answer out before its next call: text
//! of [`text_bytes`] bytes at the address that `respond` returns, and [`number_count`] numbers at [`numbers`].
//!
//! This is unsafe code: symbols of fixed names. Without them a generator of bindings would write the same, as a program to be
//! installed in exactly one version, with generated JavaScript beside it. Memory is handed over by addresses alone: nothing here
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

/// Makes room for a request of so many bytes, and returns its address.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn room(bytes: usize) -> *mut u8 {
    BUFFERS.with_borrow_mut(|buffers| {
        buffers.request.clear();
        buffers.request.resize(bytes, 0);
        buffers.request.as_mut_ptr()
    })
}

/// Answers the request that was written, and returns the address of the answer's text.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn respond() -> *const u8 {
    BUFFERS.with_borrow_mut(|buffers| {
        buffers.answer = answer(&String::from_utf8_lossy(&buffers.request));
        buffers.answer.text.as_ptr()
    })
}

/// Bytes of the answer's text.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn text_bytes() -> usize {
    BUFFERS.with_borrow(|buffers| buffers.answer.text.len())
}

/// The address of the answer's numbers.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn numbers() -> *const f64 {
    BUFFERS.with_borrow(|buffers| buffers.answer.numbers.as_ptr())
}

/// How many numbers the answer has.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn number_count() -> usize {
    BUFFERS.with_borrow(|buffers| buffers.answer.numbers.len())
}
