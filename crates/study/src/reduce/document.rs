//! The summary of the reduced parameters and of the table.

use crate::models::indeterminate_reactions;
use crate::number_format::digits;
use crate::output::indeterminate_note;
use crate::ranges::extent;
use crate::reduce::compute::{Reduction, RoundingErrors};
use dwell_kinetostatics::Coefficients;

/// The rounding errors, rounded up to powers of ten.
fn describe_rounding(errors: &RoundingErrors) -> String {
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
    let extent_of = |pick: fn(&Coefficients) -> f64| extent(curves.coefficients.iter().map(pick));
    let m = extent_of(|c| c.m);
    let [m_min, m_max] = m.map(|m| digits(m, 9));
    let [h_min, h_max] = extent_of(|c| c.half_dm).map(|h| digits(h, 9));
    let (title, count) = (&prepared.scene.title, curves.q.len());
    let name = prepared.coordinate_name();
    let mut summary = format!(
        "{title}: {count} positions of {name}\n  m    from {m_min} to {m_max} kg m²\n  ½m′  from {h_min} to {h_max} \
         kg m²/rad\n"
    );
    summary += &describe_rounding(&reduction.errors);
    if let Some(note) = note {
        summary += &format!("  {note}\n");
    }
    if m[1] == 0.0 {
        summary += "  no body with mass moves: there is no equation of motion, and every inertial reaction is zero\n";
    }
    let scene = prepared.scene;
    let indeterminate = indeterminate_reactions(scene, prepared.model.model().plan());
    let requested = scene.requests.reactions.iter();
    let names = requested.filter(|r| indeterminate.contains(r));
    summary + &indeterminate_note(names.map(|&r| scene.mechanism.reaction_name(r)))
}
