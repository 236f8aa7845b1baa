//! The loads.

use super::actuators::joint_with_freedom;
use super::joints::Joints;
use super::values::{direction, numbers};
use crate::bodies::{Bodies, TWO_POINTS};
use crate::dimensions::Space;
use crate::keys::kinds;
use crate::kind::{kind_among, reject_unread_kind};
use crate::loads::{kind_and_size, read_loads};
use crate::magnitude::Magnitudes;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Coordinate, Vec3};
use dwell_kinetostatics::Magnitude;
use dwell_kinetostatics::space::{Direction, Load, LoadKind};
use toml::de::DeValue;

/// Reads loads.
pub(super) struct LoadReader<'r> {
    pub(super) bodies: &'r Bodies<'r, Space>,
    pub(super) joints: &'r Joints<'r>,
    pub(super) magnitudes: &'r Magnitudes<Coordinate>,
}

impl LoadReader<'_> {
    /// Every load of the section that was read well.
    pub(super) fn loads(&self, fields: &TableReader<'_>) -> Vec<Load> {
        read_loads(fields, |_, fields, k| self.kind_and_magnitude(fields, k))
    }

    /// The k-th load without its name.
    fn kind_and_magnitude(
        &self,
        fields: &TableReader<'_>,
        k: usize,
    ) -> Option<(LoadKind, Magnitude<Coordinate>)> {
        let (kind, entry) = kind_among(fields, "load", &kinds("loads-in-space"))?;
        if kind == "gravity" {
            fields.place(kind, SceneLocation::Magnitude(k));
            let gravity = numbers(entry.value, fields.name_of(entry))?;
            // Without gravity there is no direction, and no weight either.
            let along = gravity.unit().unwrap_or(Vec3::ZERO);
            let magnitude = Magnitude::Constant(gravity.norm());
            return Some((LoadKind::Gravity(along), magnitude));
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
        let joint = |is_angle| joint_with_freedom(is_angle, entry, fields, self.joints);
        match kind {
            "force" => force(entry, fields, self.bodies),
            "torque" => torque(entry, fields, self.bodies),
            "joint-torque" => joint(true).map(LoadKind::JointTorque),
            "point-to-point-force" => {
                let (bodies, points) = self.two_points(entry, fields)?;
                Some(LoadKind::PointToPointForce { bodies, points })
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
            "torsion-spring" => {
                let joint = joint(true);
                let help = "add `free-angle = 0.0`, the angle at which its torque is zero";
                let free = fields.require("free-angle", help);
                let free_angle = free.and_then(|e| e.value.angle(fields.name_of(e)));
                let (joint, free_angle) = (joint?, free_angle?);
                Some(LoadKind::TorsionSpring { joint, free_angle })
            }
            "rotational-damper" => joint(true).map(LoadKind::RotationalDamper),
            "slide-force" => joint(false).map(LoadKind::SlideForce),
            "slide-damper" => joint(false).map(LoadKind::SlideDamper),
            _ => reject_unread_kind(entry),
        }
    }

    /// Points of two different bodies.
    fn two_points(
        &self,
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
    ) -> Option<([BodyId; 2], [Vec3; 2])> {
        let what = fields.name_of(entry);
        let [a, b] = self.bodies.find_two_points(entry.value, TWO_POINTS, what)?;
        let points = [self.bodies.at(&a), self.bodies.at(&b)];
        let message =
            |name: &str| format!("{} acts between two points of body `{name}`", fields.what);
        let ends = [(a.0, &a.2), (b.0, &b.2)];
        let bodies = (self.bodies).require_different(ends, message, "name points of two bodies")?;
        Some((bodies, points))
    }
}

fn force(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_, Space>,
) -> Option<LoadKind> {
    let at = entry.value.span();
    let name = entry.value.string(fields.name_of(entry))?;
    let point = bodies.find_point(name, &at);
    let given = fields.require("direction", "add `direction = [1, 0, 0]`")?;
    let direction = direction(given.value, fields.name_of(given));
    let in_body = match fields.get("frame") {
        None => false,
        Some(frame) => match frame.value.string(fields.name_of(frame))? {
            "ground" => false,
            "body" => true,
            other => {
                let message = format!("`{}` is no frame of a direction", shorten(other));
                return frame
                    .value
                    .reject(message, "unknown frame", "it is `ground` or `body`");
            }
        },
    };
    let (body, index) = point?;
    let direction = match in_body {
        true => Direction::Body(direction?),
        false => Direction::Ground(direction?),
    };
    let point = bodies.at(&(body, index, at));
    Some(LoadKind::Force {
        body,
        point,
        direction,
    })
}

fn torque(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    bodies: &Bodies<'_, Space>,
) -> Option<LoadKind> {
    let axis = fields.require(
        "axis",
        "add `axis = [0, 0, 1]`: the direction of the torque",
    )?;
    let axis = direction(axis.value, fields.name_of(axis));
    let what = fields.name_of(entry);
    let (pair, direction) = match entry.value.get() {
        DeValue::String(name) => {
            let body = bodies.find(name, &entry.value.span())?;
            let ground = BodyId(bodies.ground?);
            ([ground, body], Direction::Ground(axis?))
        }
        _ => {
            let [a, b] = bodies.find_two(entry.value, &what)?;
            let message = |name: &str| format!("{what} acts from body `{name}` on itself");
            let pair =
                bodies.require_different([(a.0, &a.1), (b.0, &b.1)], message, "name two bodies")?;
            (pair, Direction::Body(axis?))
        }
    };
    Some(LoadKind::Torque {
        bodies: pair,
        direction,
    })
}
