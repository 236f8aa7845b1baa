//! Checks of what leaves the program: it runs as a process, and its files are read back and compared with a second reading of
//! the scene.

pub(crate) mod cycles;
pub(crate) mod motions;
pub(crate) mod operating_points;
pub(crate) mod poses;
pub(crate) mod sweeps;
