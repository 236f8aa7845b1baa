//! Reads `[units]`.

use crate::diagnostics::{Diagnostics, Span};
use crate::keys::table;
use crate::table_reader::{Entry, TableReader};
use crate::units::{ANGLES, KnownUnit, LENGTHS, MASSES, Unit, Units};
use crate::wording::shorten;

impl Units {
    /// Reports an inertia, given at `at`, whose unit is not given.
    pub(crate) fn require_inertia_unit(&self, at: &Span, log: &Diagnostics) {
        if let Some(span) = &self.missing_inertia_unit {
            let message = "[units] does not give the unit of inertia";
            let labels = [(span, "not an SI unit"), (at, "inertia without a unit")];
            let help = "add for instance `inertia = \"kg m2\"` to [units]";
            log.report(message, &labels, help);
        }
    }

    /// The units of the scene's `[units]`, SI units by default.
    pub(crate) fn read(section: Option<&Entry<'_>>) -> Self {
        let mut units = Self::default();
        let Some(fields) = section.and_then(|entry| TableReader::open(entry, "[units]")) else {
            return units;
        };
        fields.reject_unknown_keys(table("units"));
        let one = |key, find: &dyn Fn(&str) -> Option<Unit>, names: &dyn Fn() -> String| {
            let value = fields.get(key)?.value;
            let name = value.string(format_args!("the unit of {key} in [units]"))?;
            find(name).or_else(|| {
                let message = format!("unknown unit of {key} `{}`", shorten(name));
                let label = format!("unknown unit of {key}");
                value.reject(message, &label, names())
            })
        };
        let simple = |key, known: &[KnownUnit]| {
            one(key, &|name| find(known, name), &|| {
                format!("known are {}", names(known))
            })
        };
        units.length = simple("length", &LENGTHS).unwrap_or(units.length);
        units.mass = simple("mass", &MASSES).unwrap_or(units.mass);
        units.angle = simple("angle", &ANGLES).unwrap_or(units.angle);
        units.inertia = one("inertia", &find_inertia, &inertia_names).unwrap_or(units.inertia);
        if fields.get("inertia").is_none() {
            let other = |key: &str, unit: &Unit, si| {
                let entry = fields.get(key)?;
                (unit.name != si).then(|| entry.value.span())
            };
            units.missing_inertia_unit =
                other("length", &units.length, "m").or(other("mass", &units.mass, "kg"));
        }
        units
    }
}

fn find(known: &[KnownUnit], name: &str) -> Option<Unit> {
    let (name, factor, divisor) = known.iter().find(|k| k.0 == name)?;
    Some(Unit::new(name, *factor, *divisor))
}

/// A mass unit times a squared length unit: `kg m2`, and as much as `kg·m²` or `kg*m^2`.
fn find_inertia(name: &str) -> Option<Unit> {
    let mut parts = name.split([' ', '·', '*']).filter(|part| !part.is_empty());
    let mass = find(&MASSES, parts.next()?)?;
    let squared = parts.next()?;
    let length_name = squared
        .strip_suffix("^2")
        .or_else(|| squared.strip_suffix(['2', '²']))?;
    let length = find(&LENGTHS, length_name)?;
    if parts.next().is_some() {
        return None;
    }
    Some(Unit {
        name: format!("{} {}2", mass.name, length.name),
        factor: mass.factor * (length.factor * length.factor),
        divisor: mass.divisor * (length.divisor * length.divisor),
    })
}

fn names(known: &[KnownUnit]) -> String {
    let names: Vec<_> = known.iter().map(|k| k.0).collect();
    names.join(", ")
}

fn inertia_names() -> String {
    format!(
        "a mass unit ({}), a space, and a length unit ({}) with a 2: `kg m2`, `g mm2`",
        names(&MASSES),
        names(&LENGTHS)
    )
}
