//! Exported code, compiled by the compilers of this machine and compared with closed forms. Without a C compiler the tests of
//! C say so and pass.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod c;
mod energy;
mod fmu;
mod hostile;
mod machine;
mod matlab;
mod rust;
mod toolchain;
