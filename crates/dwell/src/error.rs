//! The errors of this crate.

use dwell_scene::SceneError;
use dwell_study::StudyError;
use std::fmt;
use thiserror::Error;

/// The error of a call. Its text names bodies, joints and coordinates; [`Error::scene_error`] has the
/// places in the text of the scene.
///
/// ```
/// use dwell::{Joint, Mechanism};
///
/// let mut m = Mechanism::builder("Two bars");
/// m.ground().point("A", [0.0, 0.0]);
/// m.body("crank").point("A", [0.0, 0.0]);
/// m.joint("A", Joint::revolute("ground.A", "crnk.A"));
/// let error = m.assemble().unwrap_err();
/// assert!(error.to_string().contains("crnk"));
/// ```
#[derive(Error)]
pub enum Error {
    /// The scene cannot be read or evaluated, or a sweep is invalid.
    #[error("{}", all_messages(.0))]
    Study(StudyError),
    /// The mechanism has no such body, point, reaction, actuator, coordinate or column.
    #[error("there is no {what} `{name}`: {help}")]
    Unknown {
        /// The kind of the name: a body, a point, a reaction, an actuator, a coordinate, or a column.
        what: &'static str,
        /// The unknown name.
        name: String,
        /// The nearest name, or all names.
        help: String,
    },
    /// A vector is read with a wrong number of components.
    #[error("a vector was taken as {asked} components, but it has {components}")]
    Components {
        /// The requested number of components.
        asked: usize,
        /// Its number of components.
        components: &'static str,
    },
    /// A quantity that only planar mechanisms have.
    #[error("this mechanism is in space, where there is no {what}: {instead}")]
    InSpace {
        /// The quantity.
        what: &'static str,
        /// The alternative in space.
        instead: &'static str,
    },
    /// A list of coordinates, velocities or accelerations does not have one number for each actuator.
    #[error("{given} numbers given as {what}, where {actuators} are needed: one for each actuator")]
    Count {
        /// The list.
        what: &'static str,
        /// How many numbers it has.
        given: usize,
        /// How many it needs.
        actuators: usize,
    },
    /// A state vector does not have one number for each state of the equation of motion.
    #[error("{given} numbers given as a state, where the equation of motion has {states}")]
    State {
        /// How many numbers it has.
        given: usize,
        /// How many it needs.
        states: usize,
    },
    /// Two parts with the same name in a section of a builder.
    #[error("`{name}` is given twice among the {section}")]
    GivenTwice {
        /// The section: joints, loads, drives …
        section: &'static str,
        /// The name.
        name: String,
    },
    /// A table cannot be built or written.
    #[error("{0}")]
    Table(String),
    /// Closed forms disagree with the reduced model; with the largest difference relative to the largest value.
    #[error("the closed forms differ from the reduced model by {difference:.1e}")]
    ClosedForm {
        /// The difference.
        difference: f64,
    },
    /// A model of another program cannot be imported.
    #[error("{}", .0.full_message())]
    Import(dwell_door::DoorError),
    /// A coordinate outside the domain of a table.
    #[error("{q} is not in the table, which reaches from {from} to {to}")]
    OutOfTable {
        /// The coordinate, rad or m.
        q: f64,
        /// Start of the domain.
        from: f64,
        /// End of the domain.
        to: f64,
    },
}

impl Error {
    /// The error of the scene, with its places in the text of the scene and a hint for each.
    ///
    /// ```
    /// let error = dwell::Scene::parse("bodies = 3").unwrap_err();
    /// let place = &error.scene_error().unwrap().errors()[0];
    /// assert_eq!(place.labelled()[0].0, "3");
    /// ```
    pub fn scene_error(&self) -> Option<&SceneError> {
        match self {
            Self::Study(StudyError::Scene(error)) => Some(error),
            Self::Study(_)
            | Self::Unknown { .. }
            | Self::Components { .. }
            | Self::InSpace { .. }
            | Self::Count { .. }
            | Self::State { .. }
            | Self::GivenTwice { .. }
            | Self::Table(_)
            | Self::ClosedForm { .. }
            | Self::Import(_)
            | Self::OutOfTable { .. } => None,
        }
    }

    /// Checks that there is one coordinate, velocity and acceleration for each actuator.
    pub(crate) fn check_counts(lists: [&[f64]; 3], actuators: usize) -> Result<(), Self> {
        let names = ["coordinates", "velocities", "accelerations"];
        match lists
            .iter()
            .zip(names)
            .find(|(list, _)| list.len() != actuators)
        {
            None => Ok(()),
            Some((list, what)) => Err(Self::Count {
                what,
                given: list.len(),
                actuators,
            }),
        }
    }

    /// The error for a reaction that redundant constraints leave undetermined.
    pub(crate) fn shared_load(name: &str) -> Self {
        Self::Unknown {
            what: "statically determinate reaction",
            name: name.to_owned(),
            help: "redundant constraints share the load".to_owned(),
        }
    }

    pub(crate) fn unknown<'n>(
        what: &'static str,
        kind: &str,
        name: &str,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Self {
        Self::Unknown {
            what,
            name: name.to_owned(),
            help: dwell_scene::choices(name, kind, known),
        }
    }
}

/// The message, which is printed if `main` returns this error.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Every message of an error with its hint.
fn all_messages(error: &StudyError) -> String {
    let StudyError::Scene(error) = error else {
        return error.to_string();
    };
    let text = |one: &SceneError| match &one.help {
        Some(help) => format!("{} ({help})", one.message),
        None => one.message.clone(),
    };
    let texts: Vec<String> = error.errors().iter().map(text).collect();
    texts.join("; ")
}

impl From<SceneError> for Error {
    fn from(error: SceneError) -> Self {
        Self::Study(error.into())
    }
}

impl From<dwell_door::DoorError> for Error {
    fn from(error: dwell_door::DoorError) -> Self {
        Self::Import(error)
    }
}

impl From<StudyError> for Error {
    fn from(error: StudyError) -> Self {
        Self::Study(error)
    }
}
