//! Cross-crate tests, in one binary.

mod published;
mod world;
