//! Laws of one variable: expressions, tables, and the motions known by a name.

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::expression::expression;
use crate::keys;
use crate::table_reader::{Entry, SignRule, TableReader, quantity, quantity_with_sign, rows};
use crate::units::{Unit, Units};
use dwell_laws::{Law, LawError, Polynomial, Profile, Rise, Shape, Sinusoid, Spline};

/// What a law is a function of, and of which quantity.
pub(crate) struct LawDomain<'r> {
    /// The variable's name in an expression.
    pub(crate) variable: &'static str,
    /// Its unit in tables and lengths of motions.
    pub(crate) x_unit: &'r Unit,
    /// Unit of the law's value.
    pub(crate) y_unit: &'r Unit,
    /// The value a motion starts from, SI.
    pub(crate) start_value: f64,
    /// The variable is a time that runs from 0 to this, s.
    pub(crate) end_time: Option<f64>,
}

/// The law of `entry`, whose key says of which kind it is; `owner` is what has the law.
pub(crate) fn law(
    entry: &Entry<'_>,
    owner: &str,
    domain: &LawDomain<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<Law> {
    let what = format!("{} of {owner}", entry.name);
    match entry.name {
        "expression" => {
            expression(entry.value, &[domain.variable], &what, diagnostics).map(Law::Expression)
        }
        "table" => table(entry, &what, domain, diagnostics),
        "speed" => {
            let (_, speed) = quantity(
                entry.value,
                domain.y_unit,
                format_args!("{what}"),
                diagnostics,
            )?;
            Some(Law::Polynomial(Polynomial::motion(
                domain.start_value,
                speed,
                0.0,
            )))
        }
        "sinusoid" => sinusoid(entry, &what, domain, units, diagnostics),
        _ => profile(entry, &what, domain, diagnostics),
    }
}

/// What the numbers of a table cannot tell one by one: points too close for a curve.
pub(crate) fn spline(
    entry: &Entry<'_>,
    what: &str,
    rows: &[[f64; 2]],
    diagnostics: &mut Diagnostics,
) -> Option<Spline> {
    built(Spline::through(rows), entry, what, diagnostics)
}

fn built<T>(
    result: Result<T, LawError>,
    entry: &Entry<'_>,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<T> {
    result
        .map_err(|e| {
            diagnostics.push(
                Diagnostic::new(format!("{what}: {e}"))
                    .label(entry.value.span(), "no smooth function"),
            );
        })
        .ok()
}

fn table(
    entry: &Entry<'_>,
    what: &str,
    domain: &LawDomain<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Law> {
    let rows = rows(
        entry.value,
        [domain.x_unit, domain.y_unit],
        what,
        diagnostics,
    )?;
    let law = spline(entry, what, &rows, diagnostics)?;
    if let Some(end) = domain.end_time {
        let [first, last] = law.range();
        if first > 0.0 || last < end {
            diagnostics.push(
                Diagnostic::new(format!("{what} does not last as long as the motion"))
                    .label(entry.value.span(), format!("from {first} s to {last} s"))
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
    domain: &LawDomain<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<Law> {
    let fields = TableReader::open(entry, what, diagnostics)?;
    fields.reject_unknown_keys(keys::table("sinusoid"), diagnostics);
    let help = "write it as `{ amplitude = 0.3, period = 2.0 }`";
    let numbers = Numbers {
        fields: &fields,
        help,
    };
    let amplitude = numbers.required("amplitude", domain.y_unit, SignRule::Any, diagnostics);
    let period = numbers.required("period", domain.x_unit, SignRule::Positive, diagnostics);
    let phase = numbers.or_zero("phase", &units.angle, SignRule::Any, diagnostics);
    let law = Sinusoid::starting_at(domain.start_value, amplitude?, period?, phase?);
    built(law, entry, what, diagnostics).map(Law::Sinusoid)
}

fn profile(
    entry: &Entry<'_>,
    what: &str,
    domain: &LawDomain<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Law> {
    let fields = TableReader::open(entry, what, diagnostics)?;
    let is_trapezoidal = entry.name == "trapezoidal";
    let (table, help) = match is_trapezoidal {
        true => (
            keys::table("trapezoidal"),
            "write it as `{ rise = 1.0, duration = 0.5, ramp = 0.1 }`",
        ),
        false => (
            keys::table("profile"),
            "write it as `{ rise = 1.0, duration = 0.5 }`",
        ),
    };
    fields.reject_unknown_keys(table, diagnostics);
    let numbers = Numbers {
        fields: &fields,
        help,
    };
    // A motion in time begins at its assembly: it cannot have risen before.
    let delay_sign = match domain.end_time {
        Some(_) => SignRule::NotNegative,
        None => SignRule::Any,
    };
    let rise = numbers.required("rise", domain.y_unit, SignRule::Any, diagnostics);
    let duration = numbers.required("duration", domain.x_unit, SignRule::Positive, diagnostics);
    let delay = numbers.or_zero("delay", domain.x_unit, delay_sign, diagnostics);
    let shape = match entry.name {
        "polynomial345" => Some(Shape::Polynomial345),
        "polynomial4567" => Some(Shape::Polynomial4567),
        "cycloidal" => Some(Shape::Cycloidal),
        _ => {
            let ramp = numbers.required("ramp", domain.x_unit, SignRule::Positive, diagnostics);
            ramp.map(|ramp| Shape::Trapezoidal { ramp })
        }
    };
    let (rise, duration, delay, shape) = (rise?, duration?, delay?, shape?);
    if let (Shape::Trapezoidal { ramp }, Some(e)) = (shape, fields.get("ramp"))
        && 2.0 * ramp > duration
    {
        diagnostics.push(
            Diagnostic::new(format!(
                "the two ramps of {what} are longer than its duration"
            ))
            .label(e.value.span(), "at most half of the duration")
            .help("the speed rises for one ramp and falls for another"),
        );
        return None;
    }
    let motion = Rise {
        start: domain.start_value,
        rise,
        duration,
        delay,
    };
    built(Profile::new(shape, motion), entry, what, diagnostics).map(Law::Profile)
}

/// The numbers of a table, each named as one of it.
struct Numbers<'n, 'a> {
    fields: &'n TableReader<'a>,
    help: &'static str,
}

impl Numbers<'_, '_> {
    fn required(
        &self,
        key: &str,
        unit: &Unit,
        sign: SignRule,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let fields = self.fields;
        let entry = fields.require(key, &fields.span, self.help, diagnostics)?;
        let what = format_args!("{key} in {}", fields.what);
        quantity_with_sign(entry.value, unit, sign, what, "", diagnostics)
    }

    fn or_zero(
        &self,
        key: &str,
        unit: &Unit,
        sign: SignRule,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let Some(entry) = self.fields.get(key) else {
            return Some(0.0);
        };
        let what = format_args!("{key} in {}", self.fields.what);
        quantity_with_sign(entry.value, unit, sign, what, "", diagnostics)
    }
}
