//! How many times faster, at equal error: what the comparison has to prove or refute.

use super::ours::{EXACT, FROM_TEXT, QUADRATURE, TABLE};
use super::{Run, front};

/// A curve is followed beyond its last run by this factor of error at the most.
const BEYOND: f64 = 1.2;

/// The ways of Dwell, by their short names.
const WAYS: [(&str, &str); 4] = [
    (EXACT, "exact"),
    (TABLE, "table"),
    (QUADRATURE, "quadrature"),
    (FROM_TEXT, "from text"),
];

/// A claim: Dwell within an error of a case is so many times as fast as a peer at its error.
struct Claim {
    case: &'static str,
    within: f64,
    peer: &'static str,
    at: f64,
    wanted: f64,
}

/// One line for each claim.
pub(crate) fn all(runs: &[Run]) -> Vec<String> {
    let mut claims = Vec::new();
    let mut claim = |case, within, peer, at, wanted| {
        claims.push(Claim {
            case,
            within,
            peer,
            at,
            wanted,
        });
    };
    claim("crank-rocker", 1e-9, "Exudyn", 8e-9, 1e4);
    claim("crank-rocker", 1e-9, "Pinocchio", 2e-10, 1e3);
    claim("crank-rocker", 2e-10, "Pinocchio", 2e-10, 1e3);
    for error in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 3e-9] {
        claim("single-dwell", error, "Exudyn", error, 1e3);
    }
    claims.iter().map(|claim| line(runs, claim)).collect()
}

fn line(runs: &[Run], claim: &Claim) -> String {
    let &Claim {
        case,
        within,
        peer,
        at,
        wanted,
    } = claim;
    let Some(theirs) = time_at(&front(runs, case, peer), at) else {
        return format!("{case}: {peer} was not measured at {at:.0e} rad");
    };
    let ways = WAYS.map(|(way, name)| {
        let curve = front(runs, case, way);
        let Some(ours) = curve.iter().find(|r| r.error <= within) else {
            return format!("{name} not within it");
        };
        let ratio = theirs / ours.wall;
        let verdict = if ratio < wanted { " NOT REACHED" } else { "" };
        let (setting, time) = (&ours.setting, seconds(ours.wall));
        format!("{name} {}{verdict} ({setting}: {time})", rounded(ratio))
    });
    format!(
        "{case} within {within:.0e} rad, times as fast as {peer} at {at:.0e} rad ({}), wanted {wanted}: {}",
        seconds(theirs),
        ways.join("; "),
    )
}

/// The time a curve takes to an error, by powers between its runs.
fn time_at(curve: &[Run], error: f64) -> Option<f64> {
    let last = curve.len().checked_sub(2)?;
    if curve[0].error < error || curve[last + 1].error > BEYOND * error {
        return None;
    }
    let k = (0..=last)
        .find(|&k| curve[k + 1].error <= error)
        .unwrap_or(last);
    let [from, to] = [&curve[k], &curve[k + 1]];
    let part = (error / from.error).ln() / (to.error / from.error).ln();
    Some(from.wall * (to.wall / from.wall).powf(part))
}

/// A time with a unit that suits it.
pub(crate) fn seconds(time: f64) -> String {
    let (value, unit) = match time {
        t if t < 1e-3 => (t * 1e6, "µs"),
        t if t < 1.0 => (t * 1e3, "ms"),
        t => (t, "s"),
    };
    format!("{} {unit}", rounded(value))
}

/// Two digits, or all before the point.
fn rounded(value: f64) -> String {
    let unit = 10_f64.powf(value.abs().log10().floor() - 1.0);
    let decimals = if unit < 0.5 { 1 } else { 0 };
    format!("{:.decimals$}", (value / unit).round() * unit)
}
