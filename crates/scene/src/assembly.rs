//! The coordinates at assembly, and the initial guesses that select the assembly mode.

use crate::coordinates::{CoordinateNotation, ParsedActuator, Parts};
use crate::diagnostics::Span;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::{ActuatorId, BodyId};
use std::fmt::Debug;

/// How `[assembly]` is written in the plane or in space.
pub(crate) trait AssemblyNotation: CoordinateNotation {
    /// Approximately where a body is.
    type Guess: Clone + Debug;
    /// Words for messages about an unknown name: the expected kind, and the known ones.
    const NAMED: [&'static str; 2];

    /// Approximately where a body is; `what` is the entry in messages.
    fn guess(entry: &Entry<'_>, what: String, is_ground: bool) -> Option<Self::Guess>;

    /// The joints that take an initial guess.
    fn hintable_joints<'j>(_: &'j Self::Joints<'_>) -> Vec<&'j str> {
        Vec::new()
    }

    /// The joint that an entry is named by, if there is one, and its approximate travel, m, or direction, rad.
    fn branch_hint(_: &Entry<'_>, _: &str, _: &Self::Joints<'_>) -> Option<(usize, Option<f64>)> {
        None
    }

    /// The lengths, m, of the actuators `missing` at the guessed positions of the bodies; `None` for lengths that the
    /// guesses do not determine.
    fn guessed_lengths(
        _: &ParsedAssembly<Self>,
        _missing: &[usize],
        _coordinates: &[f64],
        _: &Parts<'_, '_, Self>,
        _: &[ParsedActuator<'_, Self>],
    ) -> Vec<(usize, Option<f64>)> {
        Vec::new()
    }
}

/// `[assembly]` as read: the coordinate of each actuator, rad or m, approximately where each body is, and the travel or
/// direction of joints, m or rad.
#[derive(Debug)]
pub(crate) struct ParsedAssembly<D: AssemblyNotation> {
    pub(crate) coordinates: Vec<Option<f64>>,
    pub(crate) guesses: Vec<Option<D::Guess>>,
    pub(crate) branch_hints: Vec<(usize, Option<f64>)>,
    /// The actuators it names, with a valid value or not.
    mentioned: Vec<usize>,
}

impl<D: AssemblyNotation> ParsedAssembly<D> {
    pub(crate) fn read(
        fields: Option<&TableReader<'_>>,
        parts: &Parts<'_, '_, D>,
        actuators: &[ParsedActuator<'_, D>],
    ) -> Self {
        let Parts { bodies, joints } = *parts;
        let mut parsed = Self {
            coordinates: vec![None; actuators.len()],
            guesses: vec![None; bodies.list.len()],
            branch_hints: Vec::new(),
            mentioned: Vec::new(),
        };
        for entry in fields.iter().flat_map(|f| &f.entries) {
            let name = entry.name;
            let what = format!("`{}` in [assembly]", shorten(name));
            let place = |location| entry.log().place(location, &entry.span());
            if let Some(k) = actuators.iter().position(|a| a.name == name) {
                parsed.mentioned.push(k);
                parsed.coordinates[k] = actuators[k].coordinate_value(entry.value, what);
                place(SceneLocation::AssemblyCoordinate(ActuatorId(k)));
            } else if let Some(k) = bodies.position(name) {
                parsed.guesses[k] = D::guess(entry, what, bodies.ground == Some(k));
                place(SceneLocation::InitialGuess(BodyId(k)));
            } else if let Some(hint) = D::branch_hint(entry, &what, joints) {
                parsed.branch_hints.push(hint);
            } else {
                let bodies = bodies.list.iter().map(|b| b.name);
                let names = actuators.iter().map(|a| a.name).chain(bodies);
                let names = names.chain(D::hintable_joints(joints));
                let [unknown, kind] = D::NAMED;
                let help = entry.log().choices(name, kind, names);
                entry.reject::<()>(format!("{what} is {unknown}"), "unknown name", help);
            }
        }
        parsed
    }

    /// Coordinate of each actuator at assembly: the given value, or the value of `initial` at the start of the motion, or
    /// 0. A distance of two points is not 0 by default: it follows from the approximate angles, or is reported as
    /// missing, in the section or else at the actuator.
    pub(crate) fn coordinates_or(
        &self,
        initial: &[Option<f64>],
        parts: &Parts<'_, '_, D>,
        actuators: &[ParsedActuator<'_, D>],
        section: Option<&TableReader<'_>>,
    ) -> Vec<f64> {
        let coordinate = |k: usize| self.coordinates[k].or(initial.get(k).copied().flatten());
        let given = (0..actuators.len()).map(coordinate);
        let mut coordinates: Vec<f64> = given.clone().map(Option::unwrap_or_default).collect();
        let is_missing = |(k, a): &(usize, &ParsedActuator<'_, D>)| {
            a.is_distance() && !self.mentioned.contains(k)
        };
        let missing = actuators.iter().enumerate().zip(given);
        let missing = missing.filter(|(actuator, given)| given.is_none() && is_missing(actuator));
        let missing: Vec<usize> = missing.map(|((k, _), _)| k).collect();
        let lengths = D::guessed_lengths(self, &missing, &coordinates, parts, actuators);
        for (k, length) in lengths {
            coordinates[k] = length.unwrap_or_default();
            if length.is_none() {
                let a = &actuators[k];
                let name = shorten(a.name);
                let message = format!("the length of `{name}` at the start is not given");
                let at: &Span = section.map_or(&a.key, |fields| &fields.span);
                let help = format!(
                    "add it to [assembly], such as `{name} = 0.5`, or the approximate angles of the bodies from the ground to its two points"
                );
                let labels = [(at, "no length at assembly")];
                parts.bodies.log.report(message, &labels, help);
            }
        }
        coordinates
    }
}
