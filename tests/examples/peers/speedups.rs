//! How many times faster, at equal error: what the comparison has to prove or refute.

use super::motion::{EXACT, FROM_TEXT, QUADRATURE, TABLE};
use super::{Run, SPACE_CASES, fastest_runs};

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
    /// Of integration, and of quadrature.
    factors: [f64; 2],
}

/// The factors wanted in space, and the errors at which Exudyn is compared.
const IN_SPACE: [f64; 2] = [100.0, 1000.0];
const SPACE_ERRORS: [f64; 6] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];

/// One line for each claim.
pub(crate) fn speedup_lines(runs: &[Run]) -> Vec<String> {
    let mut targets = Vec::new();
    let mut target = |case, within, peer, peer_error, factors| {
        targets.push(SpeedupTarget {
            case,
            error: within,
            peer,
            peer_error,
            factors,
        });
    };
    target("crank-rocker", 1e-9, "Exudyn", 8e-9, [1e4; 2]);
    target("crank-rocker", 1e-9, "Pinocchio", 2e-10, [1e3; 2]);
    target("crank-rocker", 2e-10, "Pinocchio", 2e-10, [1e3; 2]);
    for error in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 3e-9] {
        target("single-dwell", error, "Exudyn", error, [1e3; 2]);
    }
    for (case, ..) in SPACE_CASES {
        for error in SPACE_ERRORS {
            target(case, error, "Exudyn", error, IN_SPACE);
        }
        // No factor is asked for.
        for peer in ["Pinocchio", "MuJoCo"] {
            for error in SPACE_ERRORS {
                target(case, error, peer, error, [0.0; 2]);
            }
        }
    }
    // Where a peer of a case in space has no run on either side of an error there is nothing to compare.
    let is_wanted = |target: &&SpeedupTarget| {
        let is_in_space = SPACE_CASES.iter().any(|(case, ..)| *case == target.case);
        let curve = fastest_runs(runs, target.case, target.peer);
        !is_in_space || time_at(&curve, target.peer_error).is_some()
    };
    let wanted = targets.iter().filter(is_wanted);
    wanted.map(|target| line(runs, target)).collect()
}

fn line(runs: &[Run], target: &SpeedupTarget) -> String {
    let &SpeedupTarget {
        case,
        error: max_error,
        peer,
        peer_error: at,
        factors,
    } = target;
    let Some(theirs) = time_at(&fastest_runs(runs, case, peer), at) else {
        return format!("{case}: {peer} was not measured at {at:.0e} rad");
    };
    let measured = VARIANTS.into_iter().filter_map(|(variant, name)| {
        let curve = fastest_runs(runs, case, variant);
        (!curve.is_empty()).then_some((variant, name, curve))
    });
    let variants = measured.map(|(variant, name, curve)| {
        let Some(ours) = curve.iter().find(|r| r.error <= max_error) else {
            return format!("{name} not within it");
        };
        let ratio = theirs / ours.wall_time;
        let required = match variant {
            EXACT | TABLE => factors[0],
            // In space the building of the model is not asked about.
            FROM_TEXT if factors == IN_SPACE => 0.0,
            _ => factors[1],
        };
        let remark = if ratio < required { " NOT REACHED" } else { "" };
        let (setting, time) = (&ours.setting, seconds(ours.wall_time));
        format!("{name} {}{remark} ({setting}: {time})", rounded(ratio))
    });
    let wanted = match factors {
        [0.0, _] => String::new(),
        [integration, quadrature] if integration == quadrature => format!(", wanted {quadrature}"),
        [integration, quadrature] => {
            format!(", wanted {integration} by integration and {quadrature} by quadrature")
        }
    };
    format!(
        "{case} within {max_error:.0e} rad, times as fast as {peer} at {at:.0e} rad ({}){wanted}: {}",
        seconds(theirs),
        variants.collect::<Vec<_>>().join("; "),
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
