//! The numbers of a scene, by their paths. A changed number changes the text, which is read again, so nothing here depends on the
//! meaning of numbers.

use crate::bodies::Bodies;
use crate::diagnostics::Span;
use crate::dimensions::Dimensions;
use crate::keys::{KeySchema, schemas_of, table};
use crate::spans::SceneLocation;
use crate::table_reader::TableReader;
use crate::value::written_number;
use crate::wording::{choices, shorten};
use dwell_geometry::BodyId;
use toml::Spanned;
use toml::de::DeValue;

/// A number of the scene that may be changed, and its place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SceneNumber {
    /// The keys that lead to it.
    pub(crate) path: String,
    /// As written, in the scene's unit.
    pub(crate) value: f64,
    pub(crate) span: Span,
    /// The part of a body to which it belongs; outside the bodies, the whole scene.
    pub(crate) location: SceneLocation,
    /// Its unit as the key is described, such as `length/s`; of a body that of its location.
    pub(crate) unit: &'static str,
}

/// Sections whose numbers can be varied: all that describe the mechanism and its motion, and the parameters.
const SECTIONS: [&str; 10] = [
    "joints",
    "loads",
    "friction",
    "drives",
    "stops",
    "assembly",
    "motion",
    "prescribed",
    "coordinate-sweep",
    "sweep",
];

/// The numbers outside the bodies, section by section: `loads.brake.damping`, `motion.initial-velocity.phi`,
/// `joints.guide.axis[0]`.
pub(crate) fn section_numbers(root: &TableReader<'_>) -> Vec<SceneNumber> {
    let mut found = Vec::new();
    for section in SECTIONS {
        if let (Some(entry), Some(key)) = (root.get(section), table("scene").key(section)) {
            let (location, path) = (SceneLocation::Whole, section.to_owned());
            gather(location, path, entry.value.tree, Some(key), &mut found);
        }
    }
    found
}

/// The numbers of the bodies; the ground has its points alone, since its mass has no effect.
pub(crate) fn body_numbers<D: Dimensions>(
    bodies: &Bodies<'_, D>,
    fields: &TableReader<'_>,
) -> Vec<SceneNumber> {
    let mut found = Vec::new();
    for (k, (body, entry)) in bodies.list.iter().zip(&fields.entries).enumerate() {
        let (id, body_table) = (BodyId(k), entry.value.get());
        let mut add = |location, keys: String, value: Option<&Spanned<DeValue<'_>>>| {
            let path = format!("{}.{keys}", body.name);
            if let Some(value) = value {
                gather(location, path, value, None, &mut found);
            }
        };
        for (k, (name, _)) in body.points.iter().enumerate() {
            let value = body_table
                .get("points")
                .and_then(|p| p.get_ref().get(*name));
            add(SceneLocation::Point(id, k), format!("points.{name}"), value);
        }
        let of_mass = [
            ("mass", SceneLocation::Mass(id)),
            ("inertia", SceneLocation::Inertia(id)),
            ("center", SceneLocation::Center(id)),
        ];
        for (key, location) in of_mass.into_iter().filter(|_| bodies.ground != Some(k)) {
            add(location, key.to_owned(), body_table.get(key));
        }
    }
    found
}

/// Appends the numbers below `value`, which is at `path`.
fn gather(
    location: SceneLocation,
    path: String,
    value: &Spanned<DeValue<'_>>,
    key: Option<&'static KeySchema>,
    found: &mut Vec<SceneNumber>,
) {
    match value.get_ref() {
        DeValue::Table(table) => {
            let schemas = key.map_or_else(Vec::new, |key| schemas_of(table, &key.shape));
            for (key, value) in table {
                let name = key.get_ref().as_ref();
                let schema = schemas.iter().find_map(|schema| schema.key(name));
                let path = format!("{path}.{name}");
                gather(location, path, value, schema, found);
            }
        }
        DeValue::Array(array) => {
            for (i, value) in array.iter().enumerate() {
                gather(location, format!("{path}[{i}]"), value, key, found);
            }
        }
        number => {
            let span = value.span();
            if let Some(value) = written_number(number).filter(|n| n.is_finite()) {
                found.push(SceneNumber {
                    path,
                    value,
                    span,
                    location,
                    unit: key.map_or("", |key| key.unit.as_str()),
                });
            }
        }
    }
}

/// Message and help for a path without a number: the numbers of that body, or all.
pub(crate) fn no_number<'n>(
    path: &str,
    all: impl Iterator<Item = &'n SceneNumber> + Clone,
) -> (String, String) {
    let body = path.split('.').next().unwrap_or_default();
    let all = all.map(|n| n.path.as_str());
    let of_body = all.clone().filter(|p| p.split('.').next() == Some(body));
    let help = match of_body.clone().next() {
        None => choices(path, "numbers written in the scene", all),
        Some(_) => choices(path, &format!("numbers written in `{body}`"), of_body),
    };
    (format!("the scene has no number `{}`", shorten(path)), help)
}
