//! Reads `[units]`.

use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::keys::table;
use crate::table_reader::{Entry, TableReader, string};
use crate::units::{ANGLES, KnownUnit, LENGTHS, MASSES, Unit, Units};
use crate::wording::shorten;

impl Units {
    /// Says so where an inertia is given, at `at`, and its unit has been left open.
    pub(crate) fn require_inertia_unit(&self, at: &Span, diagnostics: &mut Diagnostics) {
        if let Some(span) = &self.missing_inertia_unit {
            diagnostics.push(
                Diagnostic::new("[units] does not give the unit of inertia")
                    .label(span.clone(), "not an SI unit")
                    .label(at.clone(), "inertia without a unit")
                    .help("add for instance `inertia = \"kg m2\"` to [units]"),
            );
        }
    }

    /// The units of the scene's `[units]`, SI where it says nothing.
    pub(crate) fn read(section: Option<&Entry<'_>>, diagnostics: &mut Diagnostics) -> Self {
        let mut units = Self::default();
        let Some(entry) = section else { return units };
        let Some(fields) = TableReader::open(entry, "[units]", diagnostics) else {
            return units;
        };
        fields.reject_unknown_keys(table("units"), diagnostics);
        let mut one = |key, find: &dyn Fn(&str) -> Option<Unit>, names: &dyn Fn() -> String| {
            let entry = fields.get(key)?;
            let name = string(
                entry.value,
                format_args!("the unit of {key} in [units]"),
                diagnostics,
            )?;
            let unit = find(name);
            if unit.is_none() {
                let name = shorten(name);
                diagnostics.push(
                    Diagnostic::new(format!("unknown unit of {key} `{name}`"))
                        .label(entry.value.span(), format!("unknown unit of {key}"))
                        .help(names()),
                );
            }
            unit
        };
        let simple = |known: &'static [KnownUnit]| {
            (
                move |name: &str| find(known, name),
                move || format!("known are {}", names(known)),
            )
        };
        let (find, names) = simple(&LENGTHS);
        units.length = one("length", &find, &names).unwrap_or(units.length);
        let (find, names) = simple(&MASSES);
        units.mass = one("mass", &find, &names).unwrap_or(units.mass);
        let (find, names) = simple(&ANGLES);
        units.angle = one("angle", &find, &names).unwrap_or(units.angle);
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
    let length = squared
        .strip_suffix("^2")
        .or_else(|| squared.strip_suffix(['2', '²']))?;
    let length = find(&LENGTHS, length)?;
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
