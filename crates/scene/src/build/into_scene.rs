//! The scene and its places, of parts in which nothing was found wrong.

use super::ParsedScene;
use crate::assembly::given_value;
use crate::diagnostics::Span;
use crate::error::Source;
use crate::motion::ParsedMotion;
use crate::scene::{Assembly, FreeMotionSpec, NamedCoordinate, Requests, Scene};
use crate::spans::{SceneLocation as At, SceneSpans};
use dwell_geometry::{ActuatorId, Body, BodyId, JointId, Mechanism};

impl ParsedScene<'_, '_> {
    /// The scene of parts in which nothing was found wrong.
    //
    // Long: it fills the fields of a scene one after another.
    pub(super) fn into_scene(self, name: String, source: Source) -> Scene {
        let spans = self.spans();
        let bodies = self.bodies.list;
        let mechanism = Mechanism {
            bodies: bodies
                .iter()
                .map(|b| Body {
                    name: b.name.to_owned(),
                })
                .collect(),
            ground: self.bodies.ground.unwrap_or(0),
            joints: self
                .joints
                .list
                .into_iter()
                .filter_map(|j| j.joint)
                .collect(),
            actuators: self
                .actuators
                .into_iter()
                .filter_map(|a| a.actuator)
                .collect(),
            couplings: self.joints.couplings,
        };
        let named = self
            .named_coordinates
            .list
            .iter()
            .skip(self.named_coordinates.actuators);
        let coordinates = named.filter_map(|m| {
            Some(NamedCoordinate {
                name: m.name.to_owned(),
                coordinate: m.coordinate?,
            })
        });
        let values = |given: &[Option<(f64, Span)>]| -> Vec<Option<f64>> {
            (0..given.len()).map(|k| given_value(given, k)).collect()
        };
        let assembly = Assembly {
            coordinates: self.assembly_coordinates,
            initial_guess: values(&self.assembly.initial_guess),
            branch_hints: values(&self.assembly.branch_hints),
        };
        let requested = self.requests;
        let requests = Requests {
            reactions: match requested.reactions {
                Some(requested) => without_spans(requested),
                None => mechanism.reactions(),
            },
            paths: without_spans(requested.paths),
            dwell: requested.dwell.map(|(d, _)| d),
            variables: requested.variables.map(without_spans),
            sections: without_spans(requested.sections),
        };
        let points = bodies
            .iter()
            .map(|b| b.points.iter().map(|p| (p.name.to_owned(), p.at)));
        Scene {
            title: self.title.map_or_else(|| name.clone(), one_line),
            name,
            note: self.note.map(printable),
            mechanism,
            masses: bodies.iter().map(|b| b.mass).collect(),
            points: points.map(Iterator::collect).collect(),
            coordinates: coordinates.collect(),
            motion: self
                .motion
                .and_then(|m| motion_of(m, &assembly.coordinates)),
            assembly,
            prescribed: self.prescribed.and_then(|p| p.prescribed),
            sweep: self.sweep.and_then(|s| s.sweep),
            loads: self.loads.into_iter().filter_map(|l| l.load).collect(),
            drives: self.drives.into_iter().filter_map(|d| d.drive).collect(),
            requests,
            calibration: self.calibration.map(|(c, _)| c),
            source,
            warnings: Vec::new(),
            units: self.fields.units().clone(),
            spans,
            body_numbers: self.bodies.numbers,
            section_numbers: Vec::new(),
        }
    }

    // Long: one entry after another for all that a message can point at.
    fn spans(&self) -> SceneSpans {
        let mut spans = SceneSpans::default();
        for (location, key) in [
            (At::Units, "units"),
            (At::Assembly, "assembly"),
            (At::Prescribed, "prescribed"),
            (At::CoordinateSweep, "coordinate-sweep"),
            (At::Requests, "requests"),
            (At::Motion, "motion"),
        ] {
            spans.put(location, self.fields.get(key).map(|e| e.value.span()));
        }
        for (k, b) in self.bodies.list.iter().enumerate() {
            let id = BodyId(k);
            spans.put(At::Body(id), b.key.clone());
            spans.put_all(
                |k| At::Point(id, k),
                b.points.iter().map(|p| p.span.clone()),
            );
            spans.put(At::Mass(id), b.mass_at.clone());
            spans.put(At::Inertia(id), b.inertia_at.clone());
            spans.put(At::Center(id), b.center_at.clone());
        }
        for (k, j) in self.joints.list.iter().enumerate() {
            let id = JointId(k);
            spans.put(At::Joint(id), j.key.clone());
            spans.put_all(|k| At::JointPoint(id, k), j.points.iter().cloned());
            spans.put(At::Axis(id), j.axis.clone());
            spans.put(At::CouplingLaw(id), j.law.clone());
        }
        let at_actuator = |at: fn(ActuatorId) -> At| move |k| at(ActuatorId(k));
        let (keys, coordinates) = self.named_coordinates.list.split_at(self.actuators.len());
        spans.put_all(
            at_actuator(At::Actuator),
            keys.iter().map(|a| a.key.clone()),
        );
        spans.put_all(At::Coordinate, coordinates.iter().map(|m| m.key.clone()));
        let given = |given: &[Option<(f64, Span)>]| -> Vec<Option<Span>> {
            let span = |s: &Option<(f64, Span)>| s.as_ref().map(|s| s.1.clone());
            given.iter().map(span).collect()
        };
        let assembly = given(&self.assembly.coordinates);
        spans.put_all(at_actuator(At::AssemblyCoordinate), assembly);
        spans.put_all(
            |k| At::InitialGuess(BodyId(k)),
            given(&self.assembly.initial_guess),
        );
        if let Some(prescribed) = &self.prescribed {
            spans.put_all(
                at_actuator(At::PrescribedLaw),
                prescribed.laws.iter().cloned(),
            );
        }
        if let Some(sweep) = &self.sweep {
            spans.put_all(at_actuator(At::Swept), sweep.actuators.iter().cloned());
        }
        // The drives follow the loads, as in a model that has them as its last loads.
        let loads = self.loads.iter().map(|l| (&l.key, &l.magnitude));
        let drives = self.drives.iter().map(|d| (&d.key, &d.magnitude));
        for (k, (key, magnitude)) in loads.chain(drives).enumerate() {
            spans.put(At::Load(k), key.clone());
            spans.put(At::Magnitude(k), magnitude.clone());
        }
        spans.put_all(At::Drive, self.drives.iter().map(|d| d.key.clone()));
        let requests = &self.requests;
        let reactions = requests.reactions.iter().flatten();
        spans.put_all(At::Reaction, reactions.map(|r| r.1.clone()));
        spans.put_all(At::Path, requests.paths.iter().map(|p| p.1.clone()));
        spans.put(At::Dwell, requests.dwell.as_ref().map(|d| d.1.clone()));
        let variables = requests.variables.iter().flatten();
        spans.put_all(At::Variable, variables.map(|v| v.1.clone()));
        spans.put_all(At::Section, requests.sections.iter().map(|s| s.1.clone()));
        if let Some(motion) = &self.motion {
            let coordinates = given(&motion.initial_coordinates);
            spans.put_all(at_actuator(At::InitialCoordinate), coordinates);
            let velocities = given(&motion.initial_velocities);
            spans.put_all(at_actuator(At::InitialVelocity), velocities);
            let laws = motion
                .prescribed
                .iter()
                .map(|law| law.as_ref().map(|e| e.key.clone()));
            spans.put_all(at_actuator(At::MotionLaw), laws);
            spans.put_all(At::Event, motion.events.iter().map(|e| e.1.clone()));
            spans.put(At::Duration, motion.duration.as_ref().map(|l| l.1.clone()));
        }
        spans.put(
            At::Calibration,
            self.calibration.as_ref().map(|c| c.1.clone()),
        );
        spans
    }
}

fn without_spans<T>(requested: Vec<(T, Span)>) -> Vec<T> {
    requested.into_iter().map(|(one, _)| one).collect()
}

/// A free motion; the coordinates are at `assembly` where it does not say otherwise.
fn motion_of(parsed: ParsedMotion<'_>, assembly: &[f64]) -> Option<FreeMotionSpec> {
    let duration = parsed.duration.as_ref()?.0;
    let (mut initial_coordinates, mut initial_velocities) = (Vec::new(), Vec::new());
    for (k, &at) in assembly.iter().enumerate() {
        let prescribed = parsed.laws[k].as_ref().map(|law| law.eval(0.0));
        // A law that has no value at 0 is reported by the analysis that follows it.
        let prescribed = prescribed.filter(|values| values[..2].iter().all(|v| v.is_finite()));
        let free = [
            given_value(&parsed.initial_coordinates, k).unwrap_or(at),
            given_value(&parsed.initial_velocities, k).unwrap_or(0.0),
        ];
        let [q, v] = prescribed.map_or(free, |[q, v, ..]| [q, v]);
        initial_coordinates.push(q);
        initial_velocities.push(v);
    }
    Some(FreeMotionSpec {
        initial_coordinates,
        initial_velocities,
        laws: parsed.laws,
        duration,
        events: parsed.events.into_iter().map(|(event, _)| event).collect(),
    })
}

/// A title heads a page: whatever white space it is written with becomes single spaces.
fn one_line(text: &str) -> String {
    let text = printable(text);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Control characters other than line breaks would reach the reader's terminal: they become spaces.
fn printable(text: &str) -> String {
    let visible = |c: char| if c.is_control() && c != '\n' { ' ' } else { c };
    text.chars().map(visible).collect()
}
