//! The scene and its places, of parts in which nothing was found wrong.

use super::{ParsedScene, given_value};
use crate::bodies::ParsedBody;
use crate::diagnostics::Span;
use crate::drives::ParsedDrive;
use crate::error::Source;
use crate::joints::ParsedJoint;
use crate::loads::ParsedLoad;
use crate::motion::ParsedMotion;
use crate::scene::{Assembly, FreeMotionSpec, NamedCoordinate, Requests, Scene};
use crate::spans::{BodySpans, JointSpans, LoadSpans, SceneSpans};
use crate::table_reader::Entry;
use dwell_geometry::{Body, Mechanism, Vec2};

impl ParsedScene<'_> {
    /// The scene of parts in which nothing was found wrong.
    pub(super) fn into_scene(self, name: String, source: Source) -> Scene {
        let spans = self.spans();
        let mechanism = Mechanism {
            bodies: self.bodies.list.iter().map(body).collect(),
            ground: self.bodies.ground.unwrap_or(0),
            joints: self
                .joints
                .list
                .iter()
                .filter_map(|j| j.joint.clone())
                .collect(),
            actuators: self
                .actuators
                .iter()
                .filter_map(|a| a.actuator.clone())
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
        let coordinates = coordinates.collect();
        let assembly = Assembly {
            coordinates: self.assembly_coordinates,
            initial_guess: values(&self.assembly.initial_guess),
            branch_hints: values(&self.assembly.branch_hints),
        };
        let motion = self
            .motion
            .and_then(|m| motion_of(m, &assembly.coordinates));
        let requests = Requests {
            reactions: match self.requests.reactions {
                Some(requested) => requested.into_iter().map(|(r, _)| r).collect(),
                None => mechanism.reactions(),
            },
            paths: self.requests.paths.into_iter().map(|(p, _)| p).collect(),
            dwell: self.requests.dwell.map(|(d, _)| d),
            variables: self
                .requests
                .variables
                .map(|all| all.into_iter().map(|(name, _)| name).collect()),
            sections: self.requests.sections.into_iter().map(|(s, _)| s).collect(),
        };
        Scene {
            title: self.title.map_or_else(|| name.clone(), one_line),
            name,
            note: self.note.map(printable),
            mechanism,
            masses: self.bodies.list.iter().map(|b| b.mass).collect(),
            points: self.bodies.list.iter().map(points).collect(),
            coordinates,
            assembly,
            prescribed: self.prescribed.and_then(|p| p.prescribed),
            sweep: self.sweep.and_then(|s| s.sweep),
            loads: self.loads.into_iter().filter_map(|l| l.load).collect(),
            drives: self.drives.into_iter().filter_map(|d| d.drive).collect(),
            requests,
            motion,
            calibration: self.calibration.map(|(c, _)| c),
            source,
            warnings: Vec::new(),
            units: self.units,
            spans,
            body_numbers: self.bodies.numbers,
            section_numbers: Vec::new(),
        }
    }

    fn spans(&self) -> SceneSpans {
        let spans = |given: &[Option<(f64, Span)>]| -> Vec<Option<Span>> {
            given
                .iter()
                .map(|s| s.as_ref().map(|s| s.1.clone()))
                .collect()
        };
        let body = |b: &ParsedBody<'_>| BodySpans {
            key: b.key.clone(),
            points: b.points.iter().map(|p| p.span.clone()).collect(),
            mass: b.mass_at.clone(),
            inertia: b.inertia_at.clone(),
            center: b.center_at.clone(),
        };
        let joint = |j: &ParsedJoint| JointSpans {
            key: j.key.clone(),
            points: j.points.clone(),
            axis: j.axis.clone(),
            law: j.law.clone(),
        };
        let load = |l: &ParsedLoad| LoadSpans {
            key: l.key.clone(),
            magnitude: l.magnitude.clone(),
        };
        let drive = |d: &ParsedDrive| LoadSpans {
            key: d.key.clone(),
            magnitude: d.magnitude.clone(),
        };
        let law_span = |law: &Option<Entry<'_>>| law.as_ref().map(|e| e.key.clone());
        let named = self
            .named_coordinates
            .list
            .iter()
            .skip(self.named_coordinates.actuators);
        let prescribed = self.prescribed.as_ref();
        let swept = self.sweep.as_ref();
        let variables = self.requests.variables.as_deref().unwrap_or(&[]);
        let motion = self.motion.as_ref();
        let events = motion.map_or(&[][..], |m| &m.events);
        let reactions = self.requests.reactions.as_deref().unwrap_or(&[]);
        SceneSpans {
            units: self.sections.units.clone(),
            bodies: self.bodies.list.iter().map(body).collect(),
            joints: self.joints.list.iter().map(joint).collect(),
            actuators: self.actuators.iter().map(|a| a.key.clone()).collect(),
            coordinates: named.map(|m| m.key.clone()).collect(),
            assembly: self.sections.assembly.clone(),
            assembly_coordinates: spans(&self.assembly.coordinates),
            initial_guess: spans(&self.assembly.initial_guess),
            prescribed: self.sections.prescribed.clone(),
            prescribed_laws: prescribed.map_or_else(Vec::new, |p| p.laws.clone()),
            sweep: self.sections.sweep.clone(),
            swept: swept.map_or_else(Vec::new, |s| s.actuators.clone()),
            loads: self.loads.iter().map(load).collect(),
            drives: self.drives.iter().map(drive).collect(),
            requests: self.sections.requests.clone(),
            reactions: reactions.iter().map(|r| Some(r.1.clone())).collect(),
            paths: self.requests.paths.iter().map(|p| p.1.clone()).collect(),
            dwell: self.requests.dwell.as_ref().map(|d| d.1.clone()),
            variables: variables.iter().map(|v| v.1.clone()).collect(),
            sections: self.requests.sections.iter().map(|s| s.1.clone()).collect(),
            motion: self.sections.motion.clone(),
            initial_coordinates: motion.map_or_else(Vec::new, |m| spans(&m.initial_coordinates)),
            initial_velocities: motion.map_or_else(Vec::new, |m| spans(&m.initial_velocities)),
            motion_laws: motion
                .map_or_else(Vec::new, |m| m.prescribed.iter().map(law_span).collect()),
            events: events.iter().map(|e| e.1.clone()).collect(),
            duration: motion
                .and_then(|m| m.duration.as_ref())
                .map(|l| l.1.clone()),
            calibration: self.calibration.as_ref().map(|c| c.1.clone()),
        }
    }
}

/// A free motion; the coordinates are at `assembly` where it does not say otherwise.
fn motion_of(parsed: ParsedMotion<'_>, assembly: &[f64]) -> Option<FreeMotionSpec> {
    let duration = parsed.duration.as_ref()?.0;
    let (mut initial_coordinates, mut initial_velocities) = (Vec::new(), Vec::new());
    for (k, &at) in assembly.iter().enumerate() {
        let prescribed = parsed.laws[k].as_ref().map(|law| law.eval(0.0));
        // A law that has no value at 0 is found out by whoever follows it.
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

fn body(b: &ParsedBody<'_>) -> Body {
    Body {
        name: b.name.to_owned(),
    }
}

fn points(b: &ParsedBody<'_>) -> Vec<(String, Vec2)> {
    b.points.iter().map(|p| (p.name.to_owned(), p.at)).collect()
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

/// What is said, without where.
fn values(given: &[Option<(f64, Span)>]) -> Vec<Option<f64>> {
    given.iter().map(|s| s.as_ref().map(|s| s.0)).collect()
}
