//! The numbers that a scene gives outside its bodies, by the keys that lead to them: `loads.brake.damping`,
//! `motion.initial-velocity.phi`, `joints.guide.axis[0]`. A changed number changes the text, which is read again, so nothing here
//! depends on what the numbers mean.

use crate::former_keys::schemas_of;
use crate::keys::{KeySchema, ValueShape, table};
use crate::number_paths::SectionNumber;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Sections whose numbers can be varied: all that describe the mechanism and its motion.
const SECTIONS: [&str; 8] = [
    "joints",
    "loads",
    "friction",
    "drives",
    "assembly",
    "motion",
    "prescribed",
    "coordinate-sweep",
];

/// All of them, section by section. The keys of `root` have their current names.
pub(crate) fn section_numbers(text: &str, root: &DeTable<'_>) -> Vec<SectionNumber> {
    let mut found = Vec::new();
    for section in SECTIONS {
        if let (Some(value), Some(key)) = (root.get(section), table("scene").key(section)) {
            let paths = [section, key.former_name()].map(str::to_owned);
            gather(text, paths, value, Some(&key.shape), &mut found);
        }
    }
    found
}

/// Appends the numbers below `value`, whose paths by current and former names are `paths`.
fn gather(
    text: &str,
    paths: [String; 2],
    value: &Spanned<DeValue<'_>>,
    shape: Option<&'static ValueShape>,
    found: &mut Vec<SectionNumber>,
) {
    match value.get_ref() {
        DeValue::Table(table) => {
            let schemas = shape.map_or_else(Vec::new, |shape| schemas_of(table, shape));
            for (key, value) in table {
                let name = key.get_ref().as_ref();
                let schema = schemas.iter().find_map(|schema| schema.key(name));
                // A name of the scene's own has no former one.
                let described = schema.filter(|s| s.name == name);
                let former = described.map_or(name, KeySchema::former_name);
                let [path, former_path] = &paths;
                let paths = [format!("{path}.{name}"), format!("{former_path}.{former}")];
                gather(text, paths, value, schema.map(|s| &s.shape), found);
            }
        }
        DeValue::Array(array) => {
            for (i, value) in array.iter().enumerate() {
                let paths = paths.each_ref().map(|path| format!("{path}[{i}]"));
                gather(text, paths, value, None, found);
            }
        }
        DeValue::Integer(_) | DeValue::Float(_) => {
            let span = value.span();
            let written = text.get(span.clone()).map(|t| t.replace('_', ""));
            let number = written.and_then(|t| t.parse::<f64>().ok());
            if let Some(value) = number.filter(|n| n.is_finite()) {
                let [path, former_path] = paths;
                found.push(SectionNumber {
                    path,
                    former_path,
                    value,
                    span,
                });
            }
        }
        _ => {}
    }
}
