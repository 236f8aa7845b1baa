//! The analyses along a trajectory.

/// The analysis along a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Analysis {
    /// Positions, speeds and accelerations.
    Kinematics,
    /// Actuator forces and reactions under the loads, at rest in every position.
    Statics,
    /// Actuator forces and reactions under the loads and the inertia of the motion.
    Kinetostatics,
    /// The free motion, with all its forces.
    FreeMotion,
}

impl Analysis {
    /// The name of the command.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kinematics => "kinematics",
            Self::Statics => "statics",
            Self::Kinetostatics => "kinetostatics",
            Self::FreeMotion => "motion",
        }
    }

    /// The command that runs it.
    pub(crate) fn command(self) -> &'static str {
        match self {
            Self::FreeMotion => "simulate",
            Self::Kinematics | Self::Statics | Self::Kinetostatics => self.name(),
        }
    }
}
