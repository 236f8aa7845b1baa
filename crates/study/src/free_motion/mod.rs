//! `dwell simulate`: the free motion of a machine in time, under its loads and drives.

pub mod compute;
