//! The summary of the reduced parameters and of the table.

use crate::models::separating_note;
use crate::number_format::digits;
use crate::reduce::compute::{Reduction, RoundingErrors};
use dwell_kinetostatics::Coefficients;

/// The rounding errors, rounded up to powers of ten.
pub(crate) fn describe_rounding(errors: &RoundingErrors) -> String {
    let [m, half_dm, rest] = errors.max_errors.map(|error| match error {
        0.0 => "0".to_owned(),
        error => format!("{:.0e}", 10_f64.powf(error.log10().ceil())),
    });
    format!(
        "  estimated rounding errors, compared with 32-digit arithmetic: below {m} of the largest m, {half_dm} of ½m′, {rest} of any a or b\n"
    )
}

/// The printed summary.
pub(crate) fn summary(reduction: &Reduction<'_>, note: Option<&str>) -> String {
    let Reduction {
        prepared, curves, ..
    } = reduction;
    let extent_of = |pick: fn(&Coefficients) -> f64| {
        let values = curves.coefficients.iter().map(pick);
        values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)))
    };
    let ((m0, m1), (h0, h1)) = (extent_of(|c| c.m), extent_of(|c| c.half_dm));
    let mut summary = format!(
        "{}: {} positions of {}\n  m    from {} to {} kg m²\n  ½m′  from {} to {} kg m²/rad\n",
        prepared.scene.title,
        curves.q.len(),
        prepared.coordinate_name(),
        digits(m0, 9),
        digits(m1, 9),
        digits(h0, 9),
        digits(h1, 9),
    );
    summary += &describe_rounding(&reduction.errors);
    if let Some(note) = note {
        summary += &format!("  {note}\n");
    }
    if m1 == 0.0 {
        summary += "  no body with mass moves: there is no equation of motion, and every inertial reaction is zero\n";
    }
    summary += &separating_note(prepared.scene);
    summary + &prepared.indeterminate_text()
}
