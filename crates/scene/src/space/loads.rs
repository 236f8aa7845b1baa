//! The loads.

use super::bodies::Space;
use super::scene::NamedLoad;
use super::values::{direction, numbers};
use crate::bodies::{Bodies, TWO_POINTS};
use crate::keys::kinds;
use crate::kind::{kind_among, reject_unread_kind};
use crate::names::check;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::SI;
use crate::value::{NumberRule, SignRule};
use crate::wording::shorten;
use dwell_geometry::BodyId;
use dwell_geometry::space::Vec3;
use dwell_kinetostatics::space::{Direction, LoadKind};
use toml::de::DeValue;

pub(super) fn loads(fields: &TableReader<'_>, bodies: &Bodies<'_, Space>) -> Vec<NamedLoad> {
    let mut found = Vec::new();
    for entry in &fields.entries {
        check("a load", entry);
        if let Some((kind, magnitude)) = read_load(entry, bodies) {
            entry
                .log()
                .place(SceneLocation::Load(found.len()), &entry.key);
            found.push(NamedLoad {
                name: entry.name.to_owned(),
                kind,
                magnitude,
            });
        }
    }
    found
}

/// How a unit of a load acts, and its magnitude.
fn read_load(entry: &Entry<'_>, bodies: &Bodies<'_, Space>) -> Option<(LoadKind, f64)> {
    let fields = &TableReader::open(entry, format!("load `{}`", shorten(entry.name)))?;
    let (kind, entry) = kind_among(fields, "load", &kinds("loads-in-space"))?;
    if kind == "gravity" {
        let gravity = numbers(entry.value, &fields.name_of(entry))?;
        // Without gravity there is no direction, and no weight either.
        let along = gravity.unit().unwrap_or(Vec3::ZERO);
        return Some((LoadKind::Gravity(along), gravity.norm()));
    }
    let help = "add `magnitude = 10`";
    let magnitude = fields.number("magnitude", help, &NumberRule::new(&SI, SignRule::Any));
    let kind = match kind {
        "force" => force(entry, fields, bodies),
        "torque" => torque(entry, fields, bodies),
        "point-to-point-force" => {
            let what = fields.name_of(entry);
            let points = bodies.find_two_points(entry.value, TWO_POINTS, what)?;
            let message =
                |name: &str| format!("{} acts between two points of body `{name}`", fields.what);
            let ends = [0, 1].map(|k| (points[k].0, &points[k].2));
            let bodies_of = bodies.require_different(ends, message, "name points of two bodies")?;
            Some(LoadKind::PointToPointForce {
                bodies: bodies_of,
                points: [0, 1].map(|k| bodies.at(&points[k])),
            })
        }
        _ => reject_unread_kind(entry),
    };
    Some((kind?, magnitude?))
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
