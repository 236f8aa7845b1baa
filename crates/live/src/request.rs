//! What a page asks.

use serde::Deserialize;

/// What a page asks.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case")]
pub enum Request {
    /// The JSON schema of scenes, for completion.
    Schema,
    /// Reads a scene and runs a command on it.
    Run {
        /// The command.
        command: Command,
        /// The scene.
        text: String,
    },
    /// The machine of a scene in C, as `dwell export --to c` writes it.
    C {
        /// The scene.
        text: String,
    },
}

/// A command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Command {
    /// Forces of the motion that the scene prescribes or sweeps; where it does neither, positions and velocities over the range.
    Motion,
    /// Positions, velocities and accelerations along the motion or the range.
    Kinematics,
    /// Forces at rest.
    Statics,
    /// Forces of the motion.
    Kinetostatics,
    /// The reduced model over the range.
    Reduce,
    /// The free motion.
    Simulate,
    /// The steady cycle.
    Cycle,
    /// The equilibria.
    Equilibria,
}
