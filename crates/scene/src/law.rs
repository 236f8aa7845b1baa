//! Laws of one variable: expressions, tables, and the motions known by a name.

use crate::expression::expression;
use crate::fields::{Entry, Fields, Sign, quantity, rows, signed};
use crate::keys;
use crate::problem::{Problem, Problems};
use crate::units::{Unit, Units};
use dwell_laws::{Law, LawError, Polynomial, Profile, Shape, Sinusoid, Spline, Travel};

/// What a law is a function of, and of which quantity.
pub(crate) struct Reach<'r> {
    /// The variable's name in an expression.
    pub(crate) variable: &'static str,
    /// Its unit in tables and lengths of motions.
    pub(crate) x: &'r Unit,
    /// Unit of the law's value.
    pub(crate) y: &'r Unit,
    /// The value a motion starts from, SI.
    pub(crate) start: f64,
    /// The variable is a time that runs from 0 to this, s.
    pub(crate) end: Option<f64>,
}

/// The law of `entry`, whose key says of which kind it is; `owner` is what has the law.
pub(crate) fn law(
    entry: &Entry<'_>,
    owner: &str,
    reach: &Reach<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<Law> {
    let what = format!("{} of {owner}", entry.name);
    match entry.name {
        "expression" => {
            expression(entry.value, &[reach.variable], &what, problems).map(Law::Expression)
        }
        "table" => table(entry, &what, reach, problems),
        "speed" => {
            let (_, speed) = quantity(entry.value, reach.y, format_args!("{what}"), problems)?;
            Some(Law::Polynomial(Polynomial::motion(reach.start, speed, 0.0)))
        }
        "sinusoid" => sinusoid(entry, &what, reach, units, problems),
        _ => profile(entry, &what, reach, problems),
    }
}

/// What the numbers of a table cannot tell one by one: points too close for a curve.
pub(crate) fn spline(
    entry: &Entry<'_>,
    what: &str,
    rows: &[[f64; 2]],
    problems: &mut Problems,
) -> Option<Spline> {
    built(Spline::through(rows), entry, what, problems)
}

fn built<T>(
    result: Result<T, LawError>,
    entry: &Entry<'_>,
    what: &str,
    problems: &mut Problems,
) -> Option<T> {
    result
        .map_err(|e| {
            problems.push(
                Problem::new(format!("{what}: {e}")).at(entry.value.span(), "no smooth function"),
            );
        })
        .ok()
}

fn table(entry: &Entry<'_>, what: &str, reach: &Reach<'_>, problems: &mut Problems) -> Option<Law> {
    let rows = rows(entry.value, [reach.x, reach.y], what, problems)?;
    let law = spline(entry, what, &rows, problems)?;
    if let Some(end) = reach.end {
        let [first, last] = law.range();
        if first > 0.0 || last < end {
            problems.push(
                Problem::new(format!("{what} does not last as long as the motion"))
                    .at(entry.value.span(), format!("from {first} s to {last} s"))
                    .help(format!("its rows have to reach from 0 s to {end} s")),
            );
            return None;
        }
    }
    Some(Law::Spline(law))
}

fn sinusoid(
    entry: &Entry<'_>,
    what: &str,
    reach: &Reach<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<Law> {
    let fields = Fields::open(entry, what, problems)?;
    fields.allow(&keys::SINUSOID, problems);
    let help = "write it as `{ amplitude = 0.3, period = 2.0 }`";
    let numbers = Numbers {
        fields: &fields,
        help,
    };
    let amplitude = numbers.needed("amplitude", reach.y, Sign::Any, problems);
    let period = numbers.needed("period", reach.x, Sign::Positive, problems);
    let phase = numbers.or_zero("phase", &units.angle, Sign::Any, problems);
    let law = Sinusoid::starting_at(reach.start, amplitude?, period?, phase?);
    built(law, entry, what, problems).map(Law::Sinusoid)
}

fn profile(
    entry: &Entry<'_>,
    what: &str,
    reach: &Reach<'_>,
    problems: &mut Problems,
) -> Option<Law> {
    let fields = Fields::open(entry, what, problems)?;
    let is_trapezoidal = entry.name == "trapezoidal";
    let (table, help) = match is_trapezoidal {
        true => (
            &keys::TRAPEZOID,
            "write it as `{ rise = 1.0, duration = 0.5, ramp = 0.1 }`",
        ),
        false => (
            &keys::PROFILE,
            "write it as `{ rise = 1.0, duration = 0.5 }`",
        ),
    };
    fields.allow(table, problems);
    let numbers = Numbers {
        fields: &fields,
        help,
    };
    // A motion in time begins at its assembly: it cannot have risen before.
    let late = match reach.end {
        Some(_) => Sign::NotNegative,
        None => Sign::Any,
    };
    let rise = numbers.needed("rise", reach.y, Sign::Any, problems);
    let duration = numbers.needed("duration", reach.x, Sign::Positive, problems);
    let delay = numbers.or_zero("delay", reach.x, late, problems);
    let shape = match entry.name {
        "polynomial345" => Some(Shape::Polynomial345),
        "polynomial4567" => Some(Shape::Polynomial4567),
        "cycloidal" => Some(Shape::Cycloidal),
        _ => {
            let ramp = numbers.needed("ramp", reach.x, Sign::Positive, problems);
            ramp.map(|ramp| Shape::Trapezoidal { ramp })
        }
    };
    let (rise, duration, delay, shape) = (rise?, duration?, delay?, shape?);
    if let (Shape::Trapezoidal { ramp }, Some(e)) = (shape, fields.get("ramp"))
        && 2.0 * ramp > duration
    {
        problems.push(
            Problem::new(format!(
                "the two ramps of {what} are longer than its duration"
            ))
            .at(e.value.span(), "at most half of the duration")
            .help("the speed rises for one ramp and falls for another"),
        );
        return None;
    }
    let travel = Travel {
        start: reach.start,
        rise,
        duration,
        delay,
    };
    built(Profile::new(shape, travel), entry, what, problems).map(Law::Profile)
}

/// The numbers of a table, each named as one of it.
struct Numbers<'n, 'a> {
    fields: &'n Fields<'a>,
    help: &'static str,
}

impl Numbers<'_, '_> {
    fn needed(&self, key: &str, unit: &Unit, sign: Sign, problems: &mut Problems) -> Option<f64> {
        let fields = self.fields;
        let entry = fields.need(key, &fields.span, self.help, problems)?;
        let what = format_args!("{key} in {}", fields.what);
        signed(entry.value, unit, sign, what, "", problems)
    }

    fn or_zero(&self, key: &str, unit: &Unit, sign: Sign, problems: &mut Problems) -> Option<f64> {
        let Some(entry) = self.fields.get(key) else {
            return Some(0.0);
        };
        let what = format_args!("{key} in {}", self.fields.what);
        signed(entry.value, unit, sign, what, "", problems)
    }
}
