//! The loads on the mechanism: where they act, and their magnitudes.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::diagnostics::Span;
use crate::joints::{Joints, ParsedJoint};
use crate::kind::kind;
use crate::magnitude::Magnitudes;
use crate::names::check;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, POINT, SignRule, Value};
use crate::wording::shorten;
use dwell_geometry::{BodyId, JointId, Vec2, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude};
use toml::de::DeValue;

/// A load as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct ParsedLoad {
    pub(crate) key: Span,
    /// Where its magnitude is, or that of gravity.
    pub(crate) magnitude: Option<Span>,
    pub(crate) load: Option<Load>,
}

/// Reads the loads.
pub(crate) struct LoadReader<'r> {
    pub(crate) bodies: &'r Bodies<'r>,
    pub(crate) joints: &'r Joints<'r>,
    pub(crate) magnitudes: &'r Magnitudes,
}

impl LoadReader<'_> {
    /// Every load of the section.
    pub(crate) fn read(&self, fields: &TableReader<'_>) -> Vec<ParsedLoad> {
        let mut gravity: Option<Span> = None;
        let one = |entry: &Entry<'_>| {
            check("a load", entry);
            let parsed = self.load(entry);
            let kind = parsed.load.as_ref().map(|load| load.kind);
            if let Some(LoadKind::Gravity { .. }) = kind
                && let Some(other) = gravity.replace(entry.key.clone())
            {
                entry
                    .error("gravity is given twice")
                    .label(&other, "here")
                    .label(&entry.key, "and here again")
                    .help("keep one of them: both would add up")
                    .report();
            }
            parsed
        };
        fields.entries.iter().map(one).collect()
    }

    fn load(&self, entry: &Entry<'_>) -> ParsedLoad {
        let fields = TableReader::open(entry, format!("load `{}`", shorten(entry.name)));
        let (magnitude, load) = match fields {
            Some(fields) => self.kind_and_magnitude(&fields),
            None => (None, None),
        };
        let load = load.map(|(kind, magnitude)| Load {
            name: entry.name.to_owned(),
            kind,
            magnitude,
        });
        ParsedLoad {
            key: entry.key.clone(),
            magnitude,
            load,
        }
    }

    /// Where the magnitude is, and the load without its name.
    fn kind_and_magnitude(
        &self,
        fields: &TableReader<'_>,
    ) -> (Option<Span>, Option<(LoadKind, Magnitude)>) {
        let Some((kind, entry)) = kind(fields, "load") else {
            return (None, None);
        };
        if kind == "gravity" {
            return (
                Some(entry.value.span()),
                gravity(entry.value, &fields.name_of(entry)),
            );
        }
        let stiffness = "a negative stiffness would push away from the free position";
        let damping = "negative damping would accelerate the motion";
        let (size, unit, sign, why) = match kind {
            "force" | "point-to-point-force" | "slide-force" => {
                ("magnitude", "N", SignRule::Any, "")
            }
            "torque" => ("magnitude", "N m", SignRule::Any, ""),
            "spring" => ("stiffness", "N/m", SignRule::NotNegative, stiffness),
            "torsion-spring" => ("stiffness", "N m/rad", SignRule::NotNegative, stiffness),
            "damper" => ("damping", "N s/m", SignRule::NotNegative, damping),
            _ => ("damping", "N m s/rad", SignRule::NotNegative, damping),
        };
        let kind = self.load_kind(kind, entry, fields);
        let magnitude = fields.require(size, &format!("add for instance `{size} = 10`, in {unit}"));
        let span = magnitude.map(|e| e.value.span());
        let rule = NumberRule {
            unit: &SI,
            sign,
            why,
        };
        let magnitude = magnitude.and_then(|e| self.magnitudes.read(e, fields, &rule));
        (span, kind.zip(magnitude))
    }

    fn load_kind(
        &self,
        kind: &str,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<LoadKind> {
        match kind {
            "force" => self.force(entry, fields),
            "torque" => {
                let bodies = self.torque(entry, fields)?;
                Some(LoadKind::Torque { bodies })
            }
            "spring" => {
                let both = self.two_points(entry, fields);
                let rule = NumberRule::new(&fields.units().length, SignRule::NotNegative);
                let help = "add `free-length = 0.1`, its length without force";
                let free_length = fields.number("free-length", help, &rule);
                let (bodies, points) = both?;
                Some(LoadKind::Spring {
                    bodies,
                    points,
                    free_length: free_length?,
                })
            }
            "damper" => {
                let (bodies, points) = self.two_points(entry, fields)?;
                Some(LoadKind::Damper { bodies, points })
            }
            "point-to-point-force" => {
                let (bodies, points) = self.two_points(entry, fields)?;
                Some(LoadKind::PointToPointForce { bodies, points })
            }
            "slide-force" => {
                let name = entry.value.string(fields.name_of(entry))?;
                let joint = self.joints.sliding(name, &entry.value.span())?;
                self.joints.guide(joint).map(LoadKind::SlideForce)
            }
            "torsion-spring" => {
                let bodies = self.two_bodies(entry, fields);
                let help = "add `free-angle = 0.0`, the angle at which its torque is zero";
                let free = fields.require("free-angle", help);
                let free_angle = free.and_then(|e| e.value.angle(fields.name_of(e)));
                Some(LoadKind::TorsionSpring {
                    bodies: bodies?,
                    free_angle: free_angle?,
                })
            }
            _ => {
                let bodies = self.two_bodies(entry, fields)?;
                Some(LoadKind::RotationalDamper { bodies })
            }
        }
    }

    fn force(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<LoadKind> {
        let what = &fields.what;
        let at = entry.value.string(fields.name_of(entry)).and_then(|name| {
            let span = entry.value.span();
            let (body, k) = self.bodies.find_point(name, &span)?;
            self.require_moving_body(body, entry.value, what)?;
            Some((body, self.bodies.at(&(body, k, span))))
        });
        let direction = fields.require("direction", "add `direction = [1, 0]`");
        let direction =
            direction.and_then(|e| e.value.unit_vector(format_args!("the direction of {what}")));
        let body_fixed = match fields.get("frame") {
            None => Some(false),
            Some(e) => frame(e.value, what),
        };
        let (body, point) = at?;
        let (direction, body_fixed) = (direction?, body_fixed?);
        Some(LoadKind::Force {
            body,
            point,
            direction,
            body_fixed,
        })
    }

    fn torque(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<[BodyId; 2]> {
        let DeValue::String(name) = entry.value.get() else {
            return self.two_bodies(entry, fields);
        };
        let body = self.bodies.find(name, &entry.value.span())?;
        self.require_moving_body(body, entry.value, &fields.what)?;
        Some([BodyId(self.bodies.ground?), body])
    }

    /// A load that acts on the ground alone has no effect, so it is taken for a mistake.
    fn require_moving_body(&self, body: BodyId, value: Value<'_>, what: &str) -> Option<()> {
        if self.bodies.ground != Some(body.0) {
            return Some(());
        }
        let diagnostic = value.wrong(format!("{what} acts on the ground"), "it does not move");
        diagnostic
            .help("let it act on a moving body, or leave it out")
            .reject()
    }

    fn two_points(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<([BodyId; 2], [Vec2; 2])> {
        let what = fields.name_of(entry);
        let [a, b] = self.bodies.find_two_points(entry.value, TWO_POINTS, what)?;
        let points = [self.bodies.at(&a), self.bodies.at(&b)];
        let bodies = self.require_different_bodies([(a.0, a.2), (b.0, b.2)], fields)?;
        Some((bodies, points))
    }

    fn two_bodies(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<[BodyId; 2]> {
        let both = self.bodies.find_two(entry.value, fields.name_of(entry))?;
        self.require_different_bodies(both, fields)
    }

    fn require_different_bodies(
        &self,
        [(a, at_a), (b, at_b)]: [(BodyId, Span); 2],
        fields: &TableReader<'_>,
    ) -> Option<[BodyId; 2]> {
        if a != b {
            return Some([a, b]);
        }
        let message = |name: &str| format!("{} acts between body `{name}` and itself", fields.what);
        let labels = [(&at_a, "this body"), (&at_b, "and the same again")];
        let help = "a load within one rigid body has no effect";
        self.bodies.reject_same_body(a, message, labels, help)
    }
}

/// The separating forces of the teeth that have a pressure angle, in the order of the file.
pub(crate) fn separating_forces(joints: &Joints<'_>) -> Vec<ParsedLoad> {
    let separating = |(k, parsed): (usize, &ParsedJoint)| {
        let (angle, at) = parsed.pressure_angle.as_ref()?;
        let load = Load::separating(parsed.joint.as_ref()?, JointId(k), *angle)?;
        Some(ParsedLoad {
            key: parsed.key.clone(),
            magnitude: Some(at.clone()),
            load: Some(load),
        })
    };
    joints
        .list
        .iter()
        .enumerate()
        .filter_map(separating)
        .collect()
}

/// An acceleration as a direction and a magnitude.
fn gravity(value: Value<'_>, what: &str) -> Option<(LoadKind, Magnitude)> {
    let direction = value.unit_vector(what)?;
    let [x, y] = value.pair(POINT, what)?;
    let [x, y] = [x, y].map(|component| component.quantity(&SI, what));
    let acceleration = vec2(x?, y?);
    let size = acceleration.x.hypot(acceleration.y);
    Some((LoadKind::Gravity { direction }, Magnitude::Constant(size)))
}

/// Whether the direction of the force rotates with its body.
fn frame(value: Value<'_>, what: &str) -> Option<bool> {
    match value.string(format_args!("the frame of {what}"))? {
        "ground" => Some(false),
        "body" => Some(true),
        name => {
            let message = format!("unknown frame `{}` of {what}", shorten(name));
            let help =
                "`\"ground\"` keeps the direction constant, `\"body\"` rotates it with the body";
            value.wrong(message, "unknown frame").help(help).reject()
        }
    }
}
