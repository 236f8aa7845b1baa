//! Requests of the page.

use serde::Deserialize;

/// A request of the page.
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
    /// Forces along the prescribed motion or the coordinate sweep of the scene; if it has neither, positions and velocities over the range.
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
