//! The loads on the mechanism: where they act, and their magnitudes.

use crate::bodies::{Bodies, TWO_POINTS};
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::joints::Joints;
use crate::kind::kind;
use crate::magnitude::{MagnitudeRule, Magnitudes};
use crate::names::check;
use crate::table_reader::{
    Entry, POINT, SignRule, TableReader, angle, pair, quantity, quantity_with_sign, string,
    unit_vector,
};
use crate::units::{Unit, Units};
use crate::wording::shorten;
use dwell_geometry::{BodyId, Vec2, vec2};
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
    bodies: &'r Bodies<'r>,
    joints: &'r Joints<'r>,
    units: &'r Units,
    magnitudes: &'r Magnitudes<'r>,
}

impl<'r> LoadReader<'r> {
    pub(crate) fn new(
        bodies: &'r Bodies<'r>,
        joints: &'r Joints<'r>,
        units: &'r Units,
        magnitudes: &'r Magnitudes<'r>,
    ) -> Self {
        Self {
            bodies,
            joints,
            units,
            magnitudes,
        }
    }

    /// Every load of the section.
    pub(crate) fn read(
        &self,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Vec<ParsedLoad> {
        let mut gravity: Option<Span> = None;
        let one = |entry: &Entry<'_>| {
            check("a load", entry.name, &entry.key, diagnostics);
            let load = self.load(entry, diagnostics);
            if let Some(Load {
                kind: LoadKind::Gravity { .. },
                ..
            }) = load.load
                && let Some(other) = gravity.replace(entry.key.clone())
            {
                diagnostics.push(
                    Diagnostic::new("gravity is given twice")
                        .label(other, "here")
                        .label(entry.key.clone(), "and here again")
                        .help("keep one of them: both would add up"),
                );
            }
            load
        };
        fields.entries.iter().map(one).collect()
    }

    fn load(&self, entry: &Entry<'_>, diagnostics: &mut Diagnostics) -> ParsedLoad {
        let mut parsed = ParsedLoad {
            key: entry.key.clone(),
            magnitude: None,
            load: None,
        };
        let what = format!("load `{}`", shorten(entry.name));
        let Some(fields) = TableReader::open(entry, what, diagnostics) else {
            return parsed;
        };
        let Some((kind_name, kind_entry)) = kind(&fields, &entry.key, "load", diagnostics) else {
            return parsed;
        };
        let (size, unit, sign) = match kind_name {
            "gravity" => ("gravity", "m/s2", SignRule::Any),
            "force" | "point-to-point-force" | "slide-force" => ("magnitude", "N", SignRule::Any),
            "torque" => ("magnitude", "N m", SignRule::Any),
            "spring" => ("stiffness", "N/m", SignRule::NotNegative),
            "torsion-spring" => ("stiffness", "N m/rad", SignRule::NotNegative),
            "damper" => ("damping", "N s/m", SignRule::NotNegative),
            _ => ("damping", "N m s/rad", SignRule::NotNegative),
        };
        if kind_name == "gravity" {
            parsed.magnitude = Some(kind_entry.value.span());
            let read = gravity(kind_entry, &fields, diagnostics);
            parsed.load = read.map(|(kind, magnitude)| named(entry, kind, magnitude));
            return parsed;
        }
        let kind = self.load_kind(kind_name, kind_entry, entry, &fields, diagnostics);
        let help = format!("add for instance `{size} = 10`, in {unit}");
        let magnitude = fields.require(size, &entry.key, &help, diagnostics);
        parsed.magnitude = magnitude.map(|e| e.value.span());
        let magnitude = magnitude.and_then(|e| {
            let why = match size {
                "stiffness" => "a negative stiffness would push away from the free position",
                _ => "negative damping would accelerate the motion",
            };
            let si = Unit::si_unit();
            let size = MagnitudeRule {
                unit: &si,
                sign,
                why,
            };
            self.magnitudes.read(e, &fields.what, &size, diagnostics)
        });
        parsed.load = kind
            .zip(magnitude)
            .map(|(kind, magnitude)| named(entry, kind, magnitude));
        parsed
    }

    fn load_kind(
        &self,
        kind_name: &str,
        kind_entry: &Entry<'_>,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<LoadKind> {
        match kind_name {
            "force" => self.force(kind_entry, entry, fields, diagnostics),
            "torque" => {
                let bodies = self.torque(kind_entry, fields, diagnostics)?;
                Some(LoadKind::Torque { bodies })
            }
            "spring" => {
                let both = self.two_points(kind_entry, fields, diagnostics);
                let unit = &self.units.length;
                let help = "add `free-length = 0.1`, its length without force";
                let free = fields
                    .require("free-length", &entry.key, help, diagnostics)
                    .and_then(|e| {
                        let what = format_args!("the free length of {}", fields.what);
                        quantity_with_sign(
                            e.value,
                            unit,
                            SignRule::NotNegative,
                            what,
                            "",
                            diagnostics,
                        )
                    });
                let (bodies, points) = both?;
                Some(LoadKind::Spring {
                    bodies,
                    points,
                    free_length: free?,
                })
            }
            "damper" => {
                let (bodies, points) = self.two_points(kind_entry, fields, diagnostics)?;
                Some(LoadKind::Damper { bodies, points })
            }
            "point-to-point-force" => {
                let (bodies, points) = self.two_points(kind_entry, fields, diagnostics)?;
                Some(LoadKind::PointToPointForce { bodies, points })
            }
            "slide-force" => {
                let name = string(
                    kind_entry.value,
                    format_args!("slide-force of {}", fields.what),
                    diagnostics,
                )?;
                let joint = self
                    .joints
                    .sliding(name, &kind_entry.value.span(), diagnostics)?;
                self.joints.guide(joint).map(LoadKind::SlideForce)
            }
            "torsion-spring" => {
                let bodies = self.two_bodies(kind_entry, fields, diagnostics);
                let help = "add `free-angle = 0.0`, the angle at which its torque is zero";
                let free = fields
                    .require("free-angle", &entry.key, help, diagnostics)
                    .and_then(|e| {
                        let what = format_args!("the free angle of {}", fields.what);
                        angle(e.value, &self.units.angle, what, diagnostics)
                    });
                Some(LoadKind::TorsionSpring {
                    bodies: bodies?,
                    free_angle: free?,
                })
            }
            _ => {
                let bodies = self.two_bodies(kind_entry, fields, diagnostics)?;
                Some(LoadKind::RotationalDamper { bodies })
            }
        }
    }

    fn force(
        &self,
        kind_entry: &Entry<'_>,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<LoadKind> {
        let what = &fields.what;
        let name = string(
            kind_entry.value,
            format_args!("force of {what}"),
            diagnostics,
        );
        let at = name.and_then(|name| {
            let span = kind_entry.value.span();
            let (body, k) = self.bodies.find_point(name, &span, diagnostics)?;
            self.require_moving_body(body, &span, what, diagnostics)?;
            Some((body, self.bodies.at(&(body, k, span))))
        });
        let help = "add `direction = [1, 0]`";
        let direction = fields.require("direction", &entry.key, help, diagnostics);
        let direction = direction
            .and_then(|e| unit_vector(e.value, &format!("the direction of {what}"), diagnostics));
        let body_fixed = match fields.get("frame") {
            None => Some(false),
            Some(e) => frame(e, what, diagnostics),
        };
        let (body, point) = at?;
        Some(LoadKind::Force {
            body,
            point,
            direction: direction?,
            body_fixed: body_fixed?,
        })
    }

    fn torque(
        &self,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<[BodyId; 2]> {
        let DeValue::String(name) = kind_entry.value.get_ref() else {
            return self.two_bodies(kind_entry, fields, diagnostics);
        };
        let at = kind_entry.value.span();
        let body = self.bodies.find(name, &at, diagnostics)?;
        self.require_moving_body(body, &at, &fields.what, diagnostics)?;
        Some([BodyId(self.bodies.ground?), body])
    }

    /// A load that acts on the ground alone has no effect, so it is taken for a mistake.
    fn require_moving_body(
        &self,
        body: BodyId,
        at: &Span,
        what: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<()> {
        if self.bodies.ground != Some(body.0) {
            return Some(());
        }
        diagnostics.push(
            Diagnostic::new(format!("{what} acts on the ground"))
                .label(at.clone(), "it does not move")
                .help("let it act on a moving body, or leave it out"),
        );
        None
    }

    fn two_points(
        &self,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<([BodyId; 2], [Vec2; 2])> {
        let what = format_args!("{} of {}", kind_entry.name, fields.what);
        let both = self
            .bodies
            .find_two_points(kind_entry.value, TWO_POINTS, what, diagnostics)?;
        let points = [&both[0], &both[1]].map(|point| self.bodies.at(point));
        let bodies = self.require_different_bodies(
            both.map(|(body, _, at)| (body, at)),
            fields,
            diagnostics,
        )?;
        Some((bodies, points))
    }

    fn two_bodies(
        &self,
        kind_entry: &Entry<'_>,
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<[BodyId; 2]> {
        let what = format_args!("{} of {}", kind_entry.name, fields.what);
        let both = self.bodies.find_two(kind_entry.value, what, diagnostics)?;
        self.require_different_bodies(both, fields, diagnostics)
    }

    fn require_different_bodies(
        &self,
        [(a, at_a), (b, at_b)]: [(BodyId, Span); 2],
        fields: &TableReader<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<[BodyId; 2]> {
        if a != b {
            return Some([a, b]);
        }
        let name = &self.bodies.list[a.0].name;
        diagnostics.push(
            Diagnostic::new(format!(
                "{} acts between body `{name}` and itself",
                fields.what
            ))
            .label(at_a, "this body")
            .label(at_b, "and the same again")
            .help("a load within one rigid body has no effect"),
        );
        None
    }
}

fn named(entry: &Entry<'_>, kind: LoadKind, magnitude: Magnitude) -> Load {
    Load {
        name: entry.name.to_owned(),
        kind,
        magnitude,
    }
}

/// An acceleration as a direction and a magnitude.
fn gravity(
    kind_entry: &Entry<'_>,
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<(LoadKind, Magnitude)> {
    let what = format!("gravity of {}", fields.what);
    let direction = unit_vector(kind_entry.value, &what, diagnostics)?;
    let [x, y] = pair(kind_entry.value, POINT, format_args!("{what}"), diagnostics)?;
    let si = Unit::si_unit();
    let mut one = |value| quantity(value, &si, format_args!("{what}"), diagnostics);
    let (x, y) = (one(x), one(y));
    let acceleration = vec2(x?.1, y?.1);
    let size = acceleration.x.hypot(acceleration.y);
    Some((LoadKind::Gravity { direction }, Magnitude::Constant(size)))
}

/// Whether the direction of the force rotates with its body.
fn frame(entry: &Entry<'_>, what: &str, diagnostics: &mut Diagnostics) -> Option<bool> {
    let name = string(
        entry.value,
        format_args!("the frame of {what}"),
        diagnostics,
    )?;
    match name {
        "ground" => Some(false),
        "body" => Some(true),
        _ => {
            diagnostics.push(
                Diagnostic::new(format!("unknown frame `{}` of {what}", shorten(name)))
                    .label(entry.value.span(), "unknown frame")
                    .help("`\"ground\"` keeps the direction constant, `\"body\"` rotates it with the body"),
            );
            None
        }
    }
}
