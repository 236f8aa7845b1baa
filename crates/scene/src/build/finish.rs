//! The scene and its places, of parts in which nothing was found wrong.

use super::{Parts, said};
use crate::bodies::BodyText;
use crate::drives::DriveText;
use crate::error::Source;
use crate::fields::Entry;
use crate::joints::JointText;
use crate::loads::LoadText;
use crate::motion::MotionText;
use crate::place::{BodyPlaces, JointPlaces, LoadPlaces, Places};
use crate::problem::Span;
use crate::scene::{Assembly, Motion, NamedCoordinate, Requests, Scene};
use dwell_geometry::{Body, Mechanism, Vec2};

impl Parts<'_> {
    /// The scene of parts in which nothing was found wrong.
    pub(super) fn finish(self, name: String, source: Source) -> Scene {
        let places = self.places();
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
            relations: self.joints.relations,
        };
        let named = self.measures.list.iter().skip(self.measures.actuators);
        let coordinates = named.filter_map(|m| {
            Some(NamedCoordinate {
                name: m.name.to_owned(),
                coordinate: m.coordinate?,
            })
        });
        let coordinates = coordinates.collect();
        let assembly = Assembly {
            start: self.start,
            rough: values(&self.assembly.rough),
            joints: values(&self.assembly.joints),
        };
        let motion = self.motion.and_then(|m| motion_of(m, &assembly.start));
        let requests = Requests {
            reactions: match self.requests.reactions {
                Some(asked) => asked.into_iter().map(|(r, _)| r).collect(),
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
            units: self.units,
            places,
            numbers: self.bodies.numbers,
            elsewhere: Vec::new(),
        }
    }

    fn places(&self) -> Places {
        let spans = |said: &[Option<(f64, Span)>]| -> Vec<Option<Span>> {
            said.iter()
                .map(|s| s.as_ref().map(|s| s.1.clone()))
                .collect()
        };
        let body = |b: &BodyText<'_>| BodyPlaces {
            key: b.key.clone(),
            points: b.points.iter().map(|p| p.span.clone()).collect(),
            mass: b.mass_at.clone(),
            inertia: b.inertia_at.clone(),
            center: b.center_at.clone(),
        };
        let joint = |j: &JointText| JointPlaces {
            key: j.key.clone(),
            ends: j.ends.clone(),
            axis: j.axis.clone(),
            law: j.law.clone(),
        };
        let load = |l: &LoadText| LoadPlaces {
            key: l.key.clone(),
            magnitude: l.magnitude.clone(),
        };
        let drive = |d: &DriveText| LoadPlaces {
            key: d.key.clone(),
            magnitude: d.given.clone(),
        };
        let led = |law: &Option<Entry<'_>>| law.as_ref().map(|e| e.key.clone());
        let named = self.measures.list.iter().skip(self.measures.actuators);
        let prescribed = self.prescribed.as_ref();
        let swept = self.sweep.as_ref();
        let variables = self.requests.variables.as_deref().unwrap_or(&[]);
        let motion = self.motion.as_ref();
        let events = motion.map_or(&[][..], |m| &m.events);
        let reactions = self.requests.reactions.as_deref().unwrap_or(&[]);
        Places {
            units: self.sections.units.clone(),
            bodies: self.bodies.list.iter().map(body).collect(),
            joints: self.joints.list.iter().map(joint).collect(),
            actuators: self.actuators.iter().map(|a| a.key.clone()).collect(),
            coordinates: named.map(|m| m.key.clone()).collect(),
            assembly: self.sections.assembly.clone(),
            start: spans(&self.assembly.start),
            rough: spans(&self.assembly.rough),
            prescribed: self.sections.prescribed.clone(),
            laws: prescribed.map_or_else(Vec::new, |p| p.laws.clone()),
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
            motion_start: motion.map_or_else(Vec::new, |m| spans(&m.start)),
            speed: motion.map_or_else(Vec::new, |m| spans(&m.speed)),
            led: motion.map_or_else(Vec::new, |m| m.led.iter().map(led).collect()),
            events: events.iter().map(|e| e.1.clone()).collect(),
            length: motion.and_then(|m| m.length.as_ref()).map(|l| l.1.clone()),
            calibration: self.calibration.as_ref().map(|c| c.1.clone()),
        }
    }
}

/// A free motion; the coordinates are at `assembly` where it does not say otherwise.
fn motion_of(text: MotionText<'_>, assembly: &[f64]) -> Option<Motion> {
    let length = text.length.as_ref()?.0;
    let (mut start, mut speed) = (Vec::new(), Vec::new());
    for (k, &at) in assembly.iter().enumerate() {
        let led = text.laws[k].as_ref().map(|law| law.at(0.0));
        // A law that has no value at 0 is found out by whoever follows it.
        let led = led.filter(|values| values[..2].iter().all(|v| v.is_finite()));
        let free = [
            said(&text.start, k).unwrap_or(at),
            said(&text.speed, k).unwrap_or(0.0),
        ];
        let [q, v] = led.map_or(free, |[q, v, ..]| [q, v]);
        start.push(q);
        speed.push(v);
    }
    Some(Motion {
        start,
        speed,
        laws: text.laws,
        length,
        events: text.events.into_iter().map(|(event, _)| event).collect(),
    })
}

fn body(b: &BodyText<'_>) -> Body {
    Body {
        name: b.name.to_owned(),
    }
}

fn points(b: &BodyText<'_>) -> Vec<(String, Vec2)> {
    b.points.iter().map(|p| (p.name.to_owned(), p.at)).collect()
}

/// A title heads a page: whatever white space it is written with becomes single spaces.
fn one_line(text: &str) -> String {
    let text = printable(text);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Control characters other than line breaks would reach the reader's terminal: they become spaces.
fn printable(text: &str) -> String {
    let shown = |c: char| if c.is_control() && c != '\n' { ' ' } else { c };
    text.chars().map(shown).collect()
}

/// What is said, without where.
fn values(said: &[Option<(f64, Span)>]) -> Vec<Option<f64>> {
    said.iter().map(|s| s.as_ref().map(|s| s.0)).collect()
}
