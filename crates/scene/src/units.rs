//! Units of a scene. They are converted once, here, and everything after is SI.

use crate::fields::{Entry, Fields, string};
use crate::keys;
use crate::names::shorten;
use crate::problem::{Problem, Problems, Span};
use std::f64::consts::PI;

/// A unit as a ratio to SI. Two numbers rather than one: 200 mm is then 200 / 1000, the very
/// number that 0.2 m is, while 200 × 0.001 is not.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    pub(crate) name: String,
    times: f64,
    over: f64,
}

impl Unit {
    fn new(name: &str, times: f64, over: f64) -> Self {
        Self {
            name: name.to_owned(),
            times,
            over,
        }
    }

    /// A unit of SI, whatever its name.
    pub(crate) fn of_si() -> Self {
        Self::new("", 1.0, 1.0)
    }

    /// `value` of this unit, in SI.
    pub(crate) fn si(&self, value: f64) -> f64 {
        value * self.times / self.over
    }

    /// A number in SI as one of this unit.
    pub(crate) fn written(&self, si: f64) -> f64 {
        si * self.over / self.times
    }
}

/// (name, times, over). All the factors are exact: the inch is 25.4 mm (1959), the pound
/// 0.453 592 37 kg, the ounce a sixteenth of it.
type Known = (&'static str, f64, f64);
const LENGTHS: [Known; 7] = [
    ("m", 1.0, 1.0),
    ("mm", 1.0, 1e3),
    ("cm", 1.0, 1e2),
    ("um", 1.0, 1e6),
    ("km", 1e3, 1.0),
    ("in", 254.0, 1e4),
    ("ft", 3048.0, 1e4),
];
const MASSES: [Known; 5] = [
    ("kg", 1.0, 1.0),
    ("g", 1.0, 1e3),
    ("t", 1e3, 1.0),
    ("lb", 45_359_237.0, 1e8),
    ("oz", 45_359_237.0, 16e8),
];
const ANGLES: [Known; 2] = [("rad", 1.0, 1.0), ("deg", PI, 180.0)];

const fn names_of<const N: usize>(known: &[Known; N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut k = 0;
    while k < N {
        names[k] = known[k].0;
        k += 1;
    }
    names
}
pub(crate) static LENGTH_NAMES: [&str; 7] = names_of(&LENGTHS);
pub(crate) static MASS_NAMES: [&str; 5] = names_of(&MASSES);
pub(crate) static ANGLE_NAMES: [&str; 2] = names_of(&ANGLES);

/// The units of one scene.
#[derive(Debug, Clone)]
pub(crate) struct Units {
    pub(crate) length: Unit,
    pub(crate) mass: Unit,
    pub(crate) inertia: Unit,
    pub(crate) angle: Unit,
    /// Where a unit other than SI's was taken that calls for an inertia unit, if there is none.
    pub(crate) open: Option<Span>,
}

impl Default for Units {
    fn default() -> Self {
        Self {
            length: Unit::new("m", 1.0, 1.0),
            mass: Unit::new("kg", 1.0, 1.0),
            inertia: Unit::new("kg m2", 1.0, 1.0),
            angle: Unit::new("rad", 1.0, 1.0),
            open: None,
        }
    }
}

impl Units {
    /// The unit of an angle, or of a length.
    pub(crate) fn of(&self, is_angle: bool) -> &Unit {
        match is_angle {
            true => &self.angle,
            false => &self.length,
        }
    }

    /// Says so where an inertia is given, at `at`, and its unit has been left open.
    pub(crate) fn ask_inertia(&self, at: &Span, problems: &mut Problems) {
        if let Some(span) = &self.open {
            problems.push(
                Problem::new("[units] leaves the unit of inertia open")
                    .at(span.clone(), "not an SI unit")
                    .at(at.clone(), "in which unit?")
                    .help("add for instance `inertia = \"kg m2\"` to [units]"),
            );
        }
    }

    /// The units of the scene's `[units]`, SI where it says nothing.
    pub(crate) fn read(section: Option<&Entry<'_>>, problems: &mut Problems) -> Self {
        let mut units = Self::default();
        let Some(entry) = section else { return units };
        let Some(fields) = Fields::open(entry, "[units]", problems) else {
            return units;
        };
        fields.allow(&keys::UNITS, problems);
        let mut one = |key, find: &dyn Fn(&str) -> Option<Unit>, names: &dyn Fn() -> String| {
            let entry = fields.get(key)?;
            let name = string(
                entry.value,
                format_args!("the unit of {key} in [units]"),
                problems,
            )?;
            let unit = find(name);
            if unit.is_none() {
                let name = shorten(name);
                problems.push(
                    Problem::new(format!("unknown unit of {key} `{name}`"))
                        .at(entry.value.span(), format!("unknown unit of {key}"))
                        .help(names()),
                );
            }
            unit
        };
        let simple = |known: &'static [Known]| {
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
            units.open = other("length", &units.length, "m").or(other("mass", &units.mass, "kg"));
        }
        units
    }
}

fn find(known: &[Known], name: &str) -> Option<Unit> {
    let (name, times, over) = known.iter().find(|k| k.0 == name)?;
    Some(Unit::new(name, *times, *over))
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
        times: mass.times * (length.times * length.times),
        over: mass.over * (length.over * length.over),
    })
}

fn names(known: &[Known]) -> String {
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
