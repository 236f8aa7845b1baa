//! Every change point that `check` names and a motion comes to is one that `simulate` crosses.

use crate::written::poses::difference::Differences;
use crate::written::poses::rows::{Rows, extent};
use std::f64::consts::TAU;

/// Checks that `simulate` reports every change point that `check` prints and the rows reach as crossed, or states a reason. A poor fit
/// across it is no reason.
pub(super) fn change_points(checked: &str, simulated: &str, rows: &Rows) -> Differences {
    let mut found = Differences::default();
    let named = checked.lines().filter_map(|line| {
        let (place, rest) = line
            .trim()
            .strip_prefix("change point of ")?
            .split_once(" = ")?;
        let (_, coordinate) = place.rsplit_once(' ')?;
        let [from, to] = extent(rows.column(coordinate));
        let point = rest.split([' ', ',']).next()?.parse::<f64>().ok()?;
        // The next one of an angle that is not below the rows.
        let is_angle = rest.contains(" rad");
        let turns = if is_angle {
            ((from - point) / TAU).ceil()
        } else {
            0.0
        };
        (from..=to)
            .contains(&(point + TAU * turns))
            .then_some(point)
    });
    let said: Vec<(f64, &str)> = simulated
        .lines()
        .filter_map(|line| {
            let line = line
                .trim()
                .trim_start_matches("the ")
                .strip_prefix("change point at ")?;
            let (at, rest) = line.split_once([':', ' '])?;
            Some((at.parse().ok()?, rest))
        })
        .collect();
    for point in named {
        // Angles count on.
        let off = |at: f64| {
            let turns = ((at - point) / TAU).round();
            (at - point - TAU * turns).abs()
        };
        let nearest = said.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
        match nearest {
            Some((at, rest)) if !rest.contains("cannot be crossed: the branch") => {
                // As many digits as are printed.
                found.add((off(*at) - 1e-5).max(0.0), 1.0, "rad", || {
                    format!("change point at {point}")
                });
            }
            other => found.fail(format!(
                "change point at {point}: `simulate` says {other:?}"
            )),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_point_that_is_not_crossed_is_found() {
        let turning = |phi: [f64; 2]| Rows {
            columns: [("phi".to_owned(), phi.to_vec())].into(),
            count: 2,
        };
        let checked = "change point of `a`, `b` at phi = 3.141592654 rad (180°), where another assembly mode begins";
        let fails = |simulated: &str| {
            let found = change_points(checked, simulated, &turning([6.0, 12.0]));
            found.failure().is_some() || found.largest() > 0.0
        };
        assert!(!fails(
            "  change point at 3.14159: crossed by a polynomial fit within ±0.01"
        ));
        assert!(fails(
            "  change point at -1.7e-19: crossed by a polynomial fit within ±0.01"
        ));
        assert!(fails(
            "  the change point at 3.14159 cannot be crossed: the branch is not smooth there"
        ));
        assert!(!fails(
            "  the change point at 3.14159 cannot be crossed: couplings"
        ));
        assert!(fails(""));
        // A motion that does not come to it says nothing of it.
        let found = change_points(checked, "", &turning([0.0, 3.0]));
        assert!(found.failure().is_none());
    }
}
