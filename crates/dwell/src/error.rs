//! Why a call fails.

use dwell_scene::SceneError;
use dwell_study::StudyError;
use std::fmt;
use thiserror::Error;

/// Why a call of this crate fails. Its text names the bodies, joints and coordinates; [`Error::scene_error`] has the
/// places in the scene's text.
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
    /// The scene cannot be read or evaluated, or a sweep cannot be made.
    #[error("{}", all_messages(.0))]
    Study(StudyError),
    /// The mechanism has nothing of that name.
    #[error("there is no {what} `{name}`: {help}")]
    Unknown {
        /// What was looked for: a body, a point, a reaction, an actuator, a coordinate, or a column.
        what: &'static str,
        /// The name that was given.
        name: String,
        /// The nearest name, or all of them.
        help: String,
    },
    /// A vector that is taken as another number of components than it has.
    #[error("a vector was taken as {asked} components, but it has {components}")]
    Components {
        /// As how many it was taken.
        asked: usize,
        /// How many it has.
        components: &'static str,
    },
    /// A quantity that only planar mechanisms have.
    #[error("this mechanism is in space, where there is no {what}: {instead}")]
    InSpace {
        /// The quantity.
        what: &'static str,
        /// What there is instead.
        instead: &'static str,
    },
    /// A list of coordinates, velocities or accelerations that does not have one number for each actuator.
    #[error("{given} numbers given as {what}, where {actuators} are needed: one for each actuator")]
    Count {
        /// Which list.
        what: &'static str,
        /// How many numbers it has.
        given: usize,
        /// How many it needs.
        actuators: usize,
    },
    /// A state that does not have one number for each state of the equation of motion.
    #[error("{given} numbers given as a state, where the equation of motion has {states}")]
    State {
        /// How many numbers it has.
        given: usize,
        /// How many it needs.
        states: usize,
    },
    /// Two parts of one name in a section of a builder.
    #[error("`{name}` is given twice among the {section}")]
    GivenTwice {
        /// The section: joints, loads, drives …
        section: &'static str,
        /// The name.
        name: String,
    },
    /// A table that cannot be made or written.
    #[error("{0}")]
    Table(String),
    /// Closed forms that do not agree with the reduced model, with the largest difference relative to the largest value.
    #[error("the closed forms differ from the reduced model by {difference:.1e}")]
    ClosedForm {
        /// The difference.
        difference: f64,
    },
    /// A coordinate beyond a table's domain.
    #[error("{q} is not in the table, which reaches from {from} to {to}")]
    OutOfTable {
        /// The coordinate, rad or m.
        q: f64,
        /// Where the table begins.
        from: f64,
        /// Where it ends.
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
            | Self::OutOfTable { .. } => None,
        }
    }

    /// Whether coordinates, velocities and accelerations are one for each actuator.
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

    /// A reaction that redundant constraints leave open.
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

/// Its text, because that is what a program shows whose `main` returns this error.
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

impl From<StudyError> for Error {
    fn from(error: StudyError) -> Self {
        Self::Study(error)
    }
}
