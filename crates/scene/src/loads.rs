//! The loads on the mechanism: where they act, and their magnitudes.

use crate::bodies::TWO_POINTS;
use crate::coordinates::AnyCoordinate;
use crate::diagnostics::Span;
use crate::joints::Joints;
use crate::kind::{kind, reject_unread_kind};
use crate::magnitude::{Magnitudes, Names};
use crate::names::read_each;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, POINT, SignRule, Value};
use crate::wording::shorten;
use dwell_geometry::{BodyId, JointId, Vec2, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude};
use toml::de::DeValue;

impl Names<'_> {
    /// Every load of the section that was read well.
    pub(crate) fn loads(&self, fields: &TableReader<'_>) -> Vec<Load> {
        let mut gravity: Option<Span> = None;
        read_loads(fields, |entry, fields, k| {
            let found = self.kind_and_magnitude(fields, k)?;
            if let LoadKind::Gravity { .. } = found.0
                && let Some(other) = gravity.replace(entry.key.clone())
            {
                let labels = [(&other, "here"), (&entry.key, "and here again")];
                let help = "keep one of them: both would add up";
                let log = entry.log();
                log.report("gravity is given twice", &labels, help);
            }
            Some(found)
        })
    }

    /// The k-th load without its name.
    fn kind_and_magnitude(
        &self,
        fields: &TableReader<'_>,
        k: usize,
    ) -> Option<(LoadKind, Magnitude)> {
        let (kind, entry) = kind(fields, "load")?;
        if kind == "gravity" {
            fields.place(kind, SceneLocation::Magnitude(k));
            return gravity(entry.value, &fields.name_of(entry));
        }
        let load_kind = || self.load_kind(kind, entry, fields);
        kind_and_size((kind, entry), (fields, k), self.magnitudes, load_kind)
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
                let ((bodies, points), free_length) = (both?, free_length?);
                Some(LoadKind::Spring {
                    bodies,
                    points,
                    free_length,
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
                let (bodies, free_angle) = (bodies?, free_angle?);
                Some(LoadKind::TorsionSpring { bodies, free_angle })
            }
            "rotational-damper" => {
                let bodies = self.two_bodies(entry, fields)?;
                Some(LoadKind::RotationalDamper { bodies })
            }
            _ => reject_unread_kind(entry),
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
        let message = format!("{what} acts on the ground");
        let help = "let it act on a moving body, or leave it out";
        value.reject(message, "it does not move", help)
    }

    fn two_points(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<([BodyId; 2], [Vec2; 2])> {
        let what = fields.name_of(entry);
        let [a, b] = self.bodies.find_two_points(entry.value, TWO_POINTS, what)?;
        let points = [self.bodies.at(&a), self.bodies.at(&b)];
        let bodies = self.require_different_bodies([(a.0, &a.2), (b.0, &b.2)], fields)?;
        Some((bodies, points))
    }

    fn two_bodies(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<[BodyId; 2]> {
        let [a, b] = &self.bodies.find_two(entry.value, fields.name_of(entry))?;
        self.require_different_bodies([(a.0, &a.1), (b.0, &b.1)], fields)
    }

    fn require_different_bodies(
        &self,
        both: [(BodyId, &Span); 2],
        fields: &TableReader<'_>,
    ) -> Option<[BodyId; 2]> {
        let message = |name: &str| format!("{} acts between body `{name}` and itself", fields.what);
        let help = "a load within one rigid body has no effect";
        self.bodies.require_different(both, message, help)
    }
}

/// Every load of a section that was read well; `read` makes kind and magnitude of the fields of the k-th.
pub(crate) fn read_loads<K, C>(
    fields: &TableReader<'_>,
    mut read: impl FnMut(&Entry<'_>, &TableReader<'_>, usize) -> Option<(K, Magnitude<C>)>,
) -> Vec<Load<K, C>> {
    read_each(fields, "a load", SceneLocation::Load, |k, entry| {
        let fields = TableReader::open(entry, format!("load `{}`", shorten(entry.name)))?;
        let (kind, magnitude) = read(entry, &fields, k)?;
        let name = entry.name.to_owned();
        Some(Load {
            name,
            kind,
            magnitude,
        })
    })
}

/// The k-th load without its name, in the plane or in space, of a kind other than gravity, which `load_kind` reads.
pub(crate) fn kind_and_size<K, C: AnyCoordinate>(
    (kind, entry): (&str, &Entry<'_>),
    (fields, k): (&TableReader<'_>, usize),
    magnitudes: &Magnitudes<C>,
    load_kind: impl FnOnce() -> Option<K>,
) -> Option<(K, Magnitude<C>)> {
    let stiffness = "a negative stiffness would push away from the free position";
    let damping = "negative damping would accelerate the motion";
    let (size, unit, sign, why) = match kind {
        "force" | "point-to-point-force" | "slide-force" => ("magnitude", "N", SignRule::Any, ""),
        "torque" | "joint-torque" => ("magnitude", "N m", SignRule::Any, ""),
        "spring" => ("stiffness", "N/m", SignRule::NotNegative, stiffness),
        "torsion-spring" => ("stiffness", "N m/rad", SignRule::NotNegative, stiffness),
        "damper" | "slide-damper" => ("damping", "N s/m", SignRule::NotNegative, damping),
        "rotational-damper" => ("damping", "N m s/rad", SignRule::NotNegative, damping),
        _ => return reject_unread_kind(entry),
    };
    let kind = load_kind();
    let magnitude = fields.require(size, &format!("add for instance `{size} = 10`, in {unit}"));
    fields.place(size, SceneLocation::Magnitude(k));
    let rule = NumberRule::new(&SI, sign).because(why);
    let magnitude = magnitude.and_then(|e| magnitudes.read(e, fields, &rule));
    kind.zip(magnitude)
}

/// Appends the separating forces of the teeth that have a pressure angle, in the order of the file.
pub(crate) fn add_separating_forces(joints: &Joints<'_>, loads: &mut Vec<Load>) {
    for (k, parsed) in joints.list.iter().enumerate() {
        if let (Some((angle, at)), Some(joint)) = (&parsed.pressure_angle, &parsed.joint)
            && let Some(load) = Load::separating(joint, JointId(k), *angle)
        {
            let log = joints.log;
            log.place(SceneLocation::Load(loads.len()), &parsed.key);
            log.place(SceneLocation::Magnitude(loads.len()), at);
            loads.push(load);
        }
    }
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
            value.reject(message, "unknown frame", help)
        }
    }
}
