//! The moment of inertia of a body over its angle: `[bodies.<body>.varying-inertia]`.

use crate::keys::table;
use crate::names::check_dotted;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::units::{SI, Unit};
use crate::value::Value;
use crate::wording::shorten;
use dwell_geometry::BodyId;
use dwell_kinetostatics::{KnownReaction, VaryingInertia};
use dwell_numerics::{Checked, PiecewiseQuintic, SamplePositions, SampledCurve};
use std::f64::consts::TAU;

/// Angles are at equal distances over a revolution if they differ from these by less than this part of a distance.
const EQUAL: f64 = 1e-6;
/// Inertia and half its slope may differ by this part of the largest inertia in an interval, of few angles.
const CONTRADICTION: f64 = 0.05;

/// The table of a body, as read.
pub(crate) fn varying_inertia<'a>(
    fields: &TableReader<'a>,
    id: BodyId,
    name: &str,
) -> Option<VaryingInertia> {
    let entry = fields.get("varying-inertia")?;
    entry.place(SceneLocation::VaryingInertia(id));
    let what = format!("the varying inertia of `{}`", shorten(name));
    let fields = TableReader::open(entry, what)?;
    fields.reject_unknown_keys(table("varying-inertia"));
    let units = fields.units();
    let angles = increasing_angles(&fields, &units.angle)?;
    let count = angles.len();
    let inertia = column(&fields, "inertia", &units.inertia, count)?;
    let half_slope = match fields.get("half-slope") {
        Some(_) => Some(column(&fields, "half-slope", &units.inertia, count)?),
        None => None,
    };
    let curves = Curves::over(angles, &fields)?;
    let inertia_curve = curves.inertia(&inertia, half_slope.as_deref());
    curves.check(
        &fields,
        entry,
        &inertia,
        half_slope.as_deref(),
        &inertia_curve,
    )?;
    let reactions = match fields.get("reactions") {
        Some(entry) => reactions(entry, &curves, count)?,
        None => Vec::new(),
    };
    let polynomials = PiecewiseQuintic::through(&curves.positions, &inertia_curve, Checked::Slope);
    Some(VaryingInertia {
        body: id,
        inertia: polynomials,
        reactions,
    })
}

/// The reactions of the mechanism that the body represents.
fn reactions(entry: &Entry<'_>, curves: &Curves, count: usize) -> Option<Vec<KnownReaction>> {
    let fields = TableReader::open(entry, "the reactions of a varying inertia")?;
    let one = |entry: &Entry<'_>| {
        check_dotted("a reaction", entry);
        let fields = TableReader::open(entry, format!("reaction `{}`", shorten(entry.name)))?;
        fields.reject_unknown_keys(table("known-reaction"));
        let unit = fields.require("unit", "add `unit = \"N\"`, or \"N m\" of a moment")?;
        let is_moment = match unit.value.string(fields.name_of(unit))? {
            "N" => false,
            "N m" => true,
            other => {
                let message = format!("unknown unit `{}` of a reaction", shorten(other));
                let help = "a force is in \"N\", a moment in \"N m\"";
                return unit.value.reject(message, "unknown unit", help);
            }
        };
        let curve = |key| {
            let values = column(&fields, key, &SI, count)?;
            Some(PiecewiseQuintic::through(
                &curves.positions,
                &curves.plain(&values),
                Checked::Value,
            ))
        };
        let (a, b) = (curve("a"), curve("b"));
        Some(KnownReaction {
            name: entry.name.to_owned(),
            is_moment,
            a: a?,
            b: b?,
        })
    };
    let read: Vec<_> = fields.entries.iter().map(one).collect();
    read.into_iter().collect()
}

/// How functions go between the angles.
struct Curves {
    positions: SamplePositions,
    by_series: bool,
    /// How many angles count: the end of a revolution is its beginning.
    rows: usize,
}

impl Curves {
    /// Positions of a whole revolution are set at exactly equal distances.
    fn over(angles: Vec<f64>, fields: &TableReader<'_>) -> Option<Self> {
        let whole = whole_revolution(&angles);
        let rows = whole.unwrap_or(angles.len());
        let first = angles[0];
        let equal = |k: usize| first + TAU * k as f64 / rows as f64;
        let x = match whole {
            Some(_) => (0..rows).map(equal).collect(),
            None => angles,
        };
        Some(Self {
            by_series: is_series(fields, whole)?,
            rows,
            positions: SamplePositions::new(x, whole.map(|_| TAU)),
        })
    }

    fn plain(&self, values: &[f64]) -> SampledCurve {
        if self.by_series {
            SampledCurve::series(&values[..self.rows])
        } else {
            self.positions.cubic(values[..self.rows].to_vec())
        }
    }

    /// The inertia: with half its slope, the integral of that.
    fn inertia(&self, inertia: &[f64], half_slope: Option<&[f64]>) -> SampledCurve {
        let Some(half_slope) = half_slope else {
            return self.plain(inertia);
        };
        let (inertia, half_slope) = (&inertia[..self.rows], &half_slope[..self.rows]);
        if self.by_series {
            return SampledCurve::integral_of_twice(&SampledCurve::series(half_slope), inertia);
        }
        let both = inertia.iter().zip(half_slope);
        SampledCurve::Cubic(both.map(|(i, half)| [*i, 2.0 * half]).collect())
    }

    /// Reports an inertia of zero or less, and one whose change contradicts its half slope.
    fn check(
        &self,
        fields: &TableReader<'_>,
        entry: &Entry<'_>,
        inertia: &[f64],
        half_slope: Option<&[f64]>,
        curve: &SampledCurve,
    ) -> Option<()> {
        if let Some(k) = inertia.iter().position(|&i| i <= 0.0) {
            let message = format!(
                "inertia {} of {} must be greater than zero",
                k + 1,
                fields.what
            );
            return entry.reject(message, "expected numbers greater than 0", "");
        }
        let Some(half_slope) = half_slope else {
            return Some(());
        };
        let largest = inertia.iter().copied().fold(0.0, f64::max);
        let x = self.positions.positions();
        let by_trapezoids = |k: usize| {
            let change = (half_slope[k] + half_slope[k - 1]) * (x[k] - x[k - 1]);
            (inertia[k] - inertia[k - 1] - change).abs()
        };
        let by_series = |k: usize| (self.positions.eval(curve, x[k])[0] - inertia[k]).abs();
        let found = (1..self.rows).find(|&k| {
            let difference = if self.by_series {
                by_series(k)
            } else {
                by_trapezoids(k)
            };
            difference > CONTRADICTION * largest
        });
        let Some(k) = found else { return Some(()) };
        let message = format!(
            "inertia and half-slope of {} are inconsistent near {:.4} rad",
            fields.what, x[k]
        );
        let help = "half-slope is ½ dI/dθ, per rad: is its sign or its unit another one? Or are the angles too few?";
        entry.reject(message, "these do not fit", help)
    }
}

/// Whether the interpolation is a trigonometric series: requested, or the best for these angles.
fn is_series(fields: &TableReader<'_>, whole: Option<usize>) -> Option<bool> {
    let Some(entry) = fields.get("interpolation") else {
        return Some(whole.is_some());
    };
    match entry.value.string(fields.name_of(entry))? {
        "cubic" => Some(false),
        "trigonometric" if whole.is_some() => Some(true),
        "trigonometric" => entry.value.reject(
            format!(
                "the angles of {} are no whole revolution at equal distances",
                fields.what
            ),
            "no trigonometric series",
            "take \"cubic\", or give angles at equal distances over 360°",
        ),
        other => entry.value.reject(
            format!("unknown interpolation `{}`", shorten(other)),
            "unknown interpolation",
            "known are \"trigonometric\" and \"cubic\"",
        ),
    }
}

/// How many angles at equal distances make one revolution; the end of the revolution may be given too.
fn whole_revolution(angles: &[f64]) -> Option<usize> {
    let equal = |rows: usize| {
        let step = TAU / rows as f64;
        let mut all = angles.iter().enumerate();
        all.all(|(k, angle)| (angle - angles[0] - step * k as f64).abs() < EQUAL * step)
    };
    let count = angles.len();
    [count, count - 1]
        .into_iter()
        .find(|&rows| rows >= 3 && equal(rows))
}

/// The numbers of a key in SI, two or more, with their places.
fn numbers<'a>(fields: &TableReader<'a>, key: &str, unit: &Unit) -> Option<(Vec<f64>, Value<'a>)> {
    let entry = fields.require(
        key,
        &format!("add `{key} = [...]`, as many numbers as angles"),
    )?;
    let what = fields.name_of(entry);
    let values = entry.value.array("numbers [x, x, ...]", &what)?;
    let one = |(k, value): (usize, &Value<'_>)| {
        value.quantity(unit, format_args!("number {} of {what}", k + 1))
    };
    let read: Vec<Option<f64>> = values.iter().enumerate().map(one).collect();
    let read: Vec<f64> = read.into_iter().collect::<Option<_>>()?;
    if read.len() < 4 {
        let message = format!("{what} has {} numbers", read.len());
        return entry.value.reject(message, "too few", "give four or more");
    }
    Some((read, entry.value))
}

/// The angles in rad, which must increase within one revolution.
fn increasing_angles(fields: &TableReader<'_>, unit: &Unit) -> Option<Vec<f64>> {
    let (angles, at) = numbers(fields, "angle", unit)?;
    let count = angles.len();
    if let Some(k) = (1..count).find(|&k| angles[k] <= angles[k - 1]) {
        let message = format!(
            "angle {} of {} is not above the one before",
            k + 1,
            fields.what
        );
        let help = "sort the columns by the angle, each angle once";
        return at.reject(message, "out of order", help);
    }
    if angles[count - 1] - angles[0] > TAU * (1.0 + EQUAL) {
        let message = format!("the angles of {} cover more than a revolution", fields.what);
        let help = "give the angles of one revolution";
        return at.reject(message, "more than 360°", help);
    }
    Some(angles)
}

/// The numbers of a key, as many as there are angles.
fn column(fields: &TableReader<'_>, key: &str, unit: &Unit, count: usize) -> Option<Vec<f64>> {
    let (values, at) = numbers(fields, key, unit)?;
    if values.len() == count {
        return Some(values);
    }
    let message = format!(
        "{key} of {} has {} numbers, angle has {count}",
        fields.what,
        values.len()
    );
    at.reject(
        message,
        "another number of values",
        "give one for each angle",
    )
}
