//! Scene files: TOML text to mechanism, masses, loads, assembly, motions and requests, with every message pointing into the file.
//!
//! [`PlaneScene::read`] turns a file into plain data, in SI. There is no mechanics here. The crates above find out whether the
//! mechanism closes, moves or balances, and report it with [`PlaneScene::error`] at a [`SceneLocation`] of the file.
//!
//! All the errors of a file come in one report, in the order of the file. No input panics.
//!
//! ```
//! let scene = dwell_scene::PlaneScene::parse(
//!     "pendulum.toml",
//!     r#"
//!     bodies.ground.points = { O = [0, 0] }
//!     bodies.bob = { points = { O = [0, 0], G = [0.5, 0] }, mass = 2.0, center = "G" }
//!     joints.O = { revolute = ["ground.O", "bob.O"] }
//!     actuators.phi = { angle = ["ground", "bob"] }
//!     "#,
//! )?;
//! assert_eq!(scene.name, "pendulum");
//! assert_eq!(scene.masses[1].center.x, 0.5);
//! # Ok::<(), dwell_scene::SceneError>(())
//! ```
//!
//! # The language
//!
//! `docs/scene-format.md` describes all of it, table by table. That page, [`schema`] and the lists of
//! keys in messages are made from one description, `keys`. What is optional, with its default:
//!
//! - `title`: the scene's name. `note`: none.
//! - `[units]`: SI. A length unit other than m, or a mass unit other than kg, requires an inertia
//!   unit as soon as a body has an inertia. Time is always in s.
//! - a body's `mass` and `inertia`: 0; `center`: needed only by a mass. Those of the ground are
//!   read and checked, then dropped: the ground does not move, so they have no effect.
//! - `fixed`: the body named `ground` is the ground. Another can be, with `fixed = true`; a body
//!   named `ground` then has to say `fixed = false`.
//! - an actuator's coordinate in `[assembly]`: where the motion starts, or else 0; the distance of
//!   two points has to be given. A body's initial guess: none.
//! - `[coordinates]`, `[loads]`: none. `[prescribed]`: none; its `points`: 361.
//! - `[coordinate-sweep]`: none, and the range is the study's choice. With one, an actuator that it does not
//!   name is fixed as in `[assembly]`; the only one is swept over its range. Its `points`: 361; its
//!   `speed`: 1 rad/s or 1 m/s.
//! - `[requests]`, or its `reactions`: every reaction. `reactions = []` asks for none. Its
//!   `variables`: every column; `sections`: none.
//! - `[friction]`: none; without a `regularization-speed` it holds at rest. `[stops]`: none; their `restitution`: 0. `[drives]`: none.
//! - `[motion]`: none; its `initial-coordinate`: that at assembly; its `initial-velocity`: 0 where loads,
//!   drives or motion laws can move the mechanism; its `prescribed` and `events`: none.
//!
//! [`PlaneScene::warnings`] names numbers that look like slips of units.
//!
//! Names are made of letters and digits of any script, `_`, `-`, primes and inner spaces. They
//! hold no dot, so that `body.point` and `joint.component` are unambiguous. Bodies,
//! actuators and coordinates do not share names: the first two are keys of `[assembly]`, the last
//! two are names in expressions, where `t` is the time. A pin of three bodies or more makes a joint
//! of the first with each of the others, named `pin-body`; `pin` in `[requests]` means them all.
//!
//! Lengths, angles, their speeds, masses and inertias are in the scene's units, in tables of laws too.
//! Forces, couples, stiffness, damping, gravity, what is electric and time are in SI, and so is all
//! that an expression sees and gives.
//!
//! A number, once in SI, is at most 1e60 in magnitude: squares and products of what a scene holds
//! then stay finite.

mod assembly;
mod bodies;
mod build;
mod coordinates;
mod diagnostics;
mod dimensions;
mod drives;
mod error;
mod events;
mod expression;
mod file;
mod friction;
mod joints;
mod key_uses;
mod keys;
mod kind;
mod law;
mod load_functions;
mod loads;
mod magnitude;
mod motion;
mod names;
mod number_paths;
mod numbers;
mod optimise;
mod plane;
mod points;
mod prescribed;
mod read;
mod requests;
mod scene;
mod scene_data;
mod schema;
mod sections;
mod space;
mod spans;
mod stops;
mod suspicious_numbers;
mod swept;
mod table_reader;
mod unit_reader;
mod units;
mod value;
mod varying_inertia;
mod wording;

#[cfg(test)]
mod tests;

pub use dimensions::{Dimensions, Plane, Space};
pub use error::{SceneError, SceneWarning};
pub use file::SceneFile;
pub use key_uses::{KeyUse, PathStep, SceneKey, WrittenAs, key_uses, scene_keys};
pub use optimise::{Choice, OptimiseJob, VariedNumber};
pub use scene::Scene;
pub use scene_data::{
    Assembly, Calibration, CoordinateSweep, DwellRequest, EventTrigger, FreeMotionSpec,
    MotionDuration, NamedCoordinate, NamedEvent, NamedStop, PathPoint, PlaneScene,
    PrescribedMotion, Requests, SceneIn, SectionRequest, SpacePathPoint, SpaceScene,
};
pub use schema::schema;
pub use spans::{JobPart, SceneLocation};
pub use swept::{ResultLimit, SweepSection, SweepTarget, TiedNumber};
pub use value::MAX_ANGLE;
pub use wording::choices;
