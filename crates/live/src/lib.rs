//! Dwell in a browser.
//!
//! [`answer`] takes a [request](Request) as JSON and returns an [`Answer`]: JSON, and a block of numbers if there are rows.
//! Built for `wasm32-unknown-unknown`, the crate is a module of five functions without imports (`interface`), which the page in
//! `page/` calls from a worker. The same call works in any Rust program:
//!
//! ```
//! let text = r#"
//! bodies.ground.points = { O = [0, 0] }
//! bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0] }
//! joints.O = { revolute = ["ground.O", "bob.O"] }
//! actuators.phi = { angle = ["ground", "bob"] }
//! prescribed = { duration = 1.0, phi = { speed = 1.0 } }
//! "#;
//! let request = serde_json::json!({ "do": "run", "command": "kinetostatics", "text": text });
//! let answer = dwell_live::answer(&request.to_string());
//! assert!(answer.text.contains("phi.actuator_force"));
//! assert!(!answer.numbers.is_empty());
//! // What is wrong comes back with its place: the message of the command line, and where in the text it is.
//! let request = serde_json::json!({ "do": "run", "command": "kinetostatics", "text": text.replace("bob.O", "bib.O") });
//! assert!(dwell_live::answer(&request.to_string()).text.contains("bib"));
//! ```
//!
//! No text should make it panic. If it does, in WebAssembly the instance is lost and the page starts another.

mod answer;
mod diagnostics;
mod export;
#[cfg(target_family = "wasm")]
mod interface;
mod pages;
mod request;
mod runs;

pub use answer::{Answer, answer};
pub use diagnostics::{LabelInText, MessageInText};
pub use request::{Command, Request};
