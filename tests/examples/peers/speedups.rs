//! How many times faster, at equal error: what the comparison has to prove or refute.

use super::dwell_runs::{EXACT, FROM_TEXT, QUADRATURE, TABLE};
use super::{Run, fastest_runs};

/// A curve is followed beyond its last run by this factor of error at the most.
const EXTRAPOLATION_LIMIT: f64 = 1.2;

/// The ways of Dwell, by their short names.
const VARIANTS: [(&str, &str); 4] = [
    (EXACT, "exact"),
    (TABLE, "table"),
    (QUADRATURE, "quadrature"),
    (FROM_TEXT, "from text"),
];

/// A claim: Dwell within an error of a case is so many times as fast as a peer at its error.
struct SpeedupTarget {
    case: &'static str,
    error: f64,
    peer: &'static str,
    peer_error: f64,
    factor: f64,
}

/// One line for each claim.
pub(crate) fn speedup_lines(runs: &[Run]) -> Vec<String> {
    let mut targets = Vec::new();
    let mut target = |case, within, peer, peer_error, factor| {
        targets.push(SpeedupTarget {
            case,
            error: within,
            peer,
            peer_error,
            factor,
        });
    };
    target("crank-rocker", 1e-9, "Exudyn", 8e-9, 1e4);
    target("crank-rocker", 1e-9, "Pinocchio", 2e-10, 1e3);
    target("crank-rocker", 2e-10, "Pinocchio", 2e-10, 1e3);
    for error in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 3e-9] {
        target("single-dwell", error, "Exudyn", error, 1e3);
    }
    targets.iter().map(|target| line(runs, target)).collect()
}

fn line(runs: &[Run], target: &SpeedupTarget) -> String {
    let &SpeedupTarget {
        case,
        error: max_error,
        peer,
        peer_error: at,
        factor: required,
    } = target;
    let Some(theirs) = time_at(&fastest_runs(runs, case, peer), at) else {
        return format!("{case}: {peer} was not measured at {at:.0e} rad");
    };
    let variants = VARIANTS.map(|(variant, name)| {
        let curve = fastest_runs(runs, case, variant);
        let Some(ours) = curve.iter().find(|r| r.error <= max_error) else {
            return format!("{name} not within it");
        };
        let ratio = theirs / ours.wall_time;
        let remark = if ratio < required { " NOT REACHED" } else { "" };
        let (setting, time) = (&ours.setting, seconds(ours.wall_time));
        format!("{name} {}{remark} ({setting}: {time})", rounded(ratio))
    });
    format!(
        "{case} within {max_error:.0e} rad, times as fast as {peer} at {at:.0e} rad ({}), wanted {required}: {}",
        seconds(theirs),
        variants.join("; "),
    )
}

/// The time a curve takes to an error, by powers between its runs.
fn time_at(curve: &[Run], error: f64) -> Option<f64> {
    let last = curve.len().checked_sub(2)?;
    if curve[0].error < error || curve[last + 1].error > EXTRAPOLATION_LIMIT * error {
        return None;
    }
    let k = (0..=last)
        .find(|&k| curve[k + 1].error <= error)
        .unwrap_or(last);
    let [from, to] = [&curve[k], &curve[k + 1]];
    let fraction = (error / from.error).ln() / (to.error / from.error).ln();
    Some(from.wall_time * (to.wall_time / from.wall_time).powf(fraction))
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
