//! Checks of what leaves the program: it runs as a process, and its files are read back and judged.

pub(crate) mod poses;
