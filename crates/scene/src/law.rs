//! Laws of one variable: expressions, tables, and named motion laws.

use crate::expression::expression;
use crate::keys;
use crate::table_reader::{Entry, TableReader};
use crate::units::Unit;
use crate::value::{NumberRule, SignRule, Value};
use crate::wording::{list, short, shorten};
use dwell_laws::{
    Interpolation, Law, LawError, Polynomial, Profile, Rise, Shape, Sinusoid, Spline,
};

/// The variable and the quantity of a law.
pub(crate) struct LawDomain<'r> {
    /// The variable's name in an expression.
    pub(crate) variable: &'static str,
    /// Its unit in tables and lengths of motions.
    pub(crate) x_unit: &'r Unit,
    /// Unit of the law's value.
    pub(crate) y_unit: &'r Unit,
    /// The value a motion starts from, SI.
    pub(crate) start_value: f64,
    /// How the curve goes between the points of a table.
    pub(crate) interpolation: Interpolation,
    /// The variable is a time that runs from 0 to this, s.
    pub(crate) end_time: Option<f64>,
}

/// The law of `entry`, whose key is its kind; `owner` names the owner of the law.
pub(crate) fn law(entry: &Entry<'_>, owner: &str, domain: &LawDomain<'_>) -> Option<Law> {
    let what = format!("{} of {owner}", entry.name);
    match entry.name {
        "expression" => expression(entry.value, &[domain.variable], &what).map(Law::Expression),
        "table" => table(entry.value, &what, domain),
        "speed" => {
            let speed = entry.value.quantity(domain.y_unit, what)?;
            let law = Polynomial::motion(domain.start_value, speed, 0.0);
            Some(Law::Polynomial(law))
        }
        "sinusoid" => sinusoid(entry, &what, domain),
        _ => profile(entry, &what, domain),
    }
}

/// The curve through the rows of a table. Points that are too close for a curve are found only here. A spline that goes far
/// beyond its points is warned of: between data that change abruptly it swings.
pub(crate) fn curve(
    value: Value<'_>,
    what: &str,
    rows: &[[f64; 2]],
    interpolation: Interpolation,
) -> Option<Spline> {
    let curve = built(Spline::interpolating(rows, interpolation), value, what)?;
    if let Some([x, y, beyond]) = curve.overshoot().filter(|[_, _, b]| *b > MAX_OVERSHOOT) {
        let message = format!(
            "the spline of {what} goes beyond its points by {:.0} % of their range: {} at {} (SI units)",
            100.0 * beyond,
            short(y),
            short(x),
        );
        let help = "`interpolation = \"monotone\"` never goes beyond neighbouring points";
        value
            .log()
            .warn(format!("{message}; {help}"), "these points", value.span());
    }
    Some(curve)
}

/// How far a spline may go beyond the range of its points without a warning, as a part of that range.
const MAX_OVERSHOOT: f64 = 0.05;

/// The interpolation that a table asks for; `None` if it names no such one.
pub(crate) fn interpolation(
    fields: &TableReader<'_>,
    absent: Interpolation,
) -> Option<Interpolation> {
    let Some(entry) = fields.get("interpolation") else {
        return Some(absent);
    };
    let what = &fields.what;
    let word = entry
        .value
        .string(format_args!("the interpolation of {what}"))?;
    let found = Interpolation::ALL.iter().find(|(name, _)| *name == word);
    if found.is_none() {
        let names = list(Interpolation::ALL.iter().map(|(name, _)| *name)).unwrap_or_default();
        let message = format!(
            "there is no interpolation `{}`, which {what} asks for",
            shorten(word)
        );
        return entry
            .value
            .reject(message, "unknown", format!("there are {names}"));
    }
    if fields.get("table").is_none() {
        let message = format!("{what} has an `interpolation` but no table");
        return entry
            .value
            .reject(message, "of what?", "leave it out, or give a `table`");
    }
    found.map(|(_, interpolation)| *interpolation)
}

fn built<T>(result: Result<T, LawError>, value: Value<'_>, what: &str) -> Option<T> {
    match result {
        Ok(law) => Some(law),
        Err(e) => value.reject(format!("{what}: {e}"), "no smooth function", ""),
    }
}

fn table(value: Value<'_>, what: &str, domain: &LawDomain<'_>) -> Option<Law> {
    let rows = value.rows([domain.x_unit, domain.y_unit], what)?;
    let law = curve(value, what, &rows, domain.interpolation)?;
    if let Some(end) = domain.end_time {
        let [first, last] = law.range();
        if first > 0.0 || last < end {
            let message = format!("{what} does not last as long as the motion");
            let label = format!("from {first} s to {last} s");
            let help = format!("its rows have to reach from 0 s to {end} s");
            return value.reject(message, &label, help);
        }
    }
    Some(Law::Spline(law))
}

fn sinusoid(entry: &Entry<'_>, what: &str, domain: &LawDomain<'_>) -> Option<Law> {
    let fields = TableReader::open(entry, what)?;
    fields.reject_unknown_keys(keys::table("sinusoid"));
    let help = "write it as `{ amplitude = 0.3, period = 2.0 }`";
    let any = |unit| NumberRule::new(unit, SignRule::Any);
    let amplitude = fields.number("amplitude", help, &any(domain.y_unit));
    let positive = NumberRule::new(domain.x_unit, SignRule::Positive);
    let period = fields.number("period", help, &positive);
    let phase = fields.number_or(0.0, "phase", &any(&fields.units().angle));
    let law = Sinusoid::starting_at(domain.start_value, amplitude?, period?, phase?);
    built(law, entry.value, what).map(Law::Sinusoid)
}

fn profile(entry: &Entry<'_>, what: &str, domain: &LawDomain<'_>) -> Option<Law> {
    let fields = TableReader::open(entry, what)?;
    let (table, help) = match entry.name {
        "trapezoidal" => (
            "trapezoidal",
            "write it as `{ rise = 1.0, duration = 0.5, ramp = 0.1 }`",
        ),
        _ => ("profile", "write it as `{ rise = 1.0, duration = 0.5 }`"),
    };
    fields.reject_unknown_keys(keys::table(table));
    // A motion in time begins at its assembly: it cannot have risen before.
    let delay_sign = match domain.end_time {
        Some(_) => SignRule::NotNegative,
        None => SignRule::Any,
    };
    let positive = NumberRule::new(domain.x_unit, SignRule::Positive);
    let rise = fields.number("rise", help, &NumberRule::new(domain.y_unit, SignRule::Any));
    let duration = fields.number("duration", help, &positive);
    let delay = fields.number_or(0.0, "delay", &NumberRule::new(domain.x_unit, delay_sign));
    let shape = match entry.name {
        "polynomial345" => Some(Shape::Polynomial345),
        "polynomial4567" => Some(Shape::Polynomial4567),
        "cycloidal" => Some(Shape::Cycloidal),
        _ => fields
            .number("ramp", help, &positive)
            .map(|ramp| Shape::Trapezoidal { ramp }),
    };
    let (rise, duration, delay, shape) = (rise?, duration?, delay?, shape?);
    if let (Shape::Trapezoidal { ramp }, Some(e)) = (shape, fields.get("ramp"))
        && 2.0 * ramp > duration
    {
        let message = format!("the two ramps of {what} are longer than its duration");
        let help = "the speed rises for one ramp and falls for another";
        return e
            .value
            .reject(message, "at most half of the duration", help);
    }
    let start = domain.start_value;
    let motion = Rise {
        start,
        rise,
        duration,
        delay,
    };
    built(Profile::new(shape, motion), entry.value, what).map(Law::Profile)
}
