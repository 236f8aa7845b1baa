//! The loads.

use super::actuators::joint_with_freedom;
use super::joints::Joints;
use super::values::{direction, numbers};
use crate::bodies::Bodies;
use crate::dimensions::Space;
use crate::keys::kinds;
use crate::kind::kind_among;
use crate::loads::{LoadReader, read_loads};
use crate::magnitude::Magnitudes;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Coordinate, Vec3};
use dwell_kinetostatics::Magnitude;
use dwell_kinetostatics::space::{DirectedCouple, Direction, Load, LoadKind};
use toml::de::DeValue;

/// Reads loads.
pub(super) struct SpaceLoads<'r> {
    pub(super) bodies: &'r Bodies<'r, Space>,
    pub(super) joints: &'r Joints<'r>,
    pub(super) magnitudes: &'r Magnitudes<Coordinate>,
}

impl SpaceLoads<'_> {
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
            let direction = gravity.unit().unwrap_or(Vec3::ZERO);
            let magnitude = Magnitude::Constant(gravity.norm());
            return Some((LoadKind::Gravity { direction }, magnitude));
        }
        self.kind_and_size(kind, entry, fields, k)
    }
}

impl LoadReader for SpaceLoads<'_> {
    type Dimensions = Space;
    type Along = Coordinate;
    type Special = DirectedCouple;
    type Coordinate = Coordinate;

    fn bodies(&self) -> &Bodies<'_, Space> {
        self.bodies
    }

    fn magnitudes(&self) -> &Magnitudes<Coordinate> {
        self.magnitudes
    }

    fn force(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<LoadKind> {
        force(entry, fields, self.bodies)
    }

    fn torque(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<LoadKind> {
        torque(entry, fields, self.bodies)
    }

    fn turn(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<Coordinate> {
        joint_with_freedom(true, entry, fields, self.joints).map(Coordinate::Angle)
    }

    fn slide(&self, entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<Coordinate> {
        joint_with_freedom(false, entry, fields, self.joints).map(Coordinate::Travel)
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
    let direction = if in_body {
        Direction::Body(direction?)
    } else {
        Direction::Ground(direction?)
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
    Some(LoadKind::torque(pair, direction))
}
