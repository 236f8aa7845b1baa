//! Cross-crate tests, in one binary.

mod motion;
mod published;
mod slides;
mod world;
