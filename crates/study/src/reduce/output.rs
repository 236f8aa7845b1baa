//! Writes the reduced parameters: table, figures, summary and interpolation table.

use super::figures;
use super::page::page_of;
use crate::explain::StudyError;
use crate::number_format::{coordinate_unit, digits, digits_within};
use crate::output::{Outcome, Picture};
use crate::ranges::extent;
use crate::reduce::compute::{
    Peak, ReducedScene, Reduction, RoundingErrors, TableRequest, TabulatedScene, inertia_units,
    peak_between_rows, tabulate,
};
use dwell_findings::Record;
use dwell_kinetostatics::Coefficients;
use dwell_report::{Figure, Files, TableFormat};

/// The figures that are drawn unless others are wanted: m, ½m′, and the first reactions.
const MAIN_FIGURES: [&str; 2] = ["reduced", "reaction"];

/// Adds an interpolation table to the results.
pub(crate) fn add_table(
    prepared: &dyn TabulatedScene,
    request: &TableRequest,
    outcome: &mut Outcome,
) -> Result<(), StudyError> {
    let tabulation = tabulate(prepared, request)?;
    outcome.summary += &tabulation.summary;
    outcome.record.extend(tabulation.record);
    if let Some(text) = tabulation.text {
        let name = format!("{}.table", prepared.file().name);
        outcome.files.add(name, text);
    }
    Ok(())
}

/// The table, the figures and the summary of a reduction.
pub(crate) fn reduction_outcome<P: ReducedScene>(
    reduction: &Reduction<P>,
) -> Result<Outcome, StudyError> {
    let scene = reduction.prepared.file();
    let (prepared, curves) = (&reduction.prepared, &reduction.curves);
    let is_rounding = &reduction.errors.is_rounding;
    let mut figures: Vec<Figure> = vec![figures::reduced(prepared, curves, is_rounding)];
    let (coefficients, note) = figures::coefficients(prepared, curves, is_rounding);
    figures.extend(coefficients);
    if let Some(unit_loads) = &reduction.unit_loads
        && unit_loads.working().next().is_some()
    {
        figures.push(figures::unit_loads(unit_loads, prepared, &curves.q));
    }
    let mut files = Files::new();
    let stem = format!("{}-reduced", scene.name);
    let table = reduction.table();
    files.add_table(&stem, &table, &TableFormat::ALL)?;
    let picture = |figure: Figure| {
        let path = format!("{}-{}.png", scene.name, figure.name);
        let is_main = MAIN_FIGURES.contains(&figure.name.as_str());
        Picture::figure(scene, path, is_main, figure)
    };
    let pictures = figures.into_iter().map(picture).collect();
    let peak = peak_between_rows(prepared, curves);
    Ok(Outcome {
        summary: summary(reduction, peak, note.as_deref()),
        record: record(reduction, peak),
        run: Some(Box::new(page_of(reduction, &table, peak))),
        files,
        pictures,
        ..Outcome::default()
    })
}

/// The rounding errors, rounded up to powers of ten.
fn describe_rounding(errors: &RoundingErrors, has_reactions: bool) -> String {
    let [m, half_dm, rest] = errors.max_errors.map(|error| match error {
        0.0 => "0".to_owned(),
        error => format!("{:.0e}", 10_f64.powf(error.log10().ceil())),
    });
    let rest = if has_reactions {
        format!(", {rest} of any a or b")
    } else {
        String::new()
    };
    format!(
        "  estimated rounding errors, compared with 32-digit arithmetic: below {m} of the largest m, {half_dm} of ½m′{rest}\n"
    )
}

impl<P: ReducedScene> Reduction<P> {
    /// The first and the last coordinate; `None` over a whole revolution.
    fn ends(&self) -> Option<[f64; 2]> {
        self.prepared.range().limits()?;
        let q = &self.curves.q;
        (q.len() > 1).then(|| [q[0], q[q.len() - 1]])
    }
}

/// The numbers of the summary.
fn record<P: ReducedScene>(reduction: &Reduction<P>, peak: Option<Peak>) -> Record {
    let curves = &reduction.curves;
    let mut record = Record::default();
    record.add_count("positions", curves.q.len());
    let (prepared, is_angle) = (&reduction.prepared, reduction.prepared.is_angle());
    let unit = coordinate_unit(is_angle);
    if let Some([first, last]) = reduction.ends() {
        let name = prepared.coordinate_name();
        record.add(format!("{name}.min"), unit, first);
        record.add(format!("{name}.max"), unit, last);
    }
    let [m_unit, half_dm_unit] = inertia_units(is_angle);
    let [m_error, half_dm_error, rest] = reduction.errors.max_errors;
    let m = extent(curves.coefficients.iter().map(|c| c.m));
    let half_dm = if reduction.errors.is_rounding[1] {
        [0.0; 2]
    } else {
        extent(curves.coefficients.iter().map(|c| c.half_dm))
    };
    for (name, unit, ends, error) in [
        ("m", m_unit, m, m_error),
        ("half_dm", half_dm_unit, half_dm, half_dm_error),
    ] {
        let largest = ends[0].abs().max(ends[1].abs());
        for (end, value) in ["min", "max"].into_iter().zip(ends) {
            record.add_within(format!("{name}.{end}"), unit, value, error * largest);
        }
    }
    if let Some(peak) = peak {
        record.add_within("m.peak", m_unit, peak.m, peak.error);
        record.add("m.peak.coordinate", unit, peak.q);
    }
    record.add("rounding_error.m", "", m_error);
    record.add("rounding_error.half_dm", "", half_dm_error);
    record.add("rounding_error.reactions", "", rest);
    record
}

/// The printed summary.
pub(crate) fn summary<P: ReducedScene>(
    reduction: &Reduction<P>,
    peak: Option<Peak>,
    note: Option<&str>,
) -> String {
    let (prepared, curves) = (&reduction.prepared, &reduction.curves);
    let extent_of = |pick: fn(&Coefficients) -> f64| extent(curves.coefficients.iter().map(pick));
    let m = extent_of(|c| c.m);
    let half_dm = if reduction.errors.is_rounding[1] {
        [0.0; 2]
    } else {
        extent_of(|c| c.half_dm)
    };
    // Errors are relative to the largest value.
    let texts = |values: [f64; 2], error: f64| {
        let largest = values[0].abs().max(values[1].abs());
        values.map(|value| digits_within(value, error * largest, 9))
    };
    let [m_error, half_dm_error, _] = reduction.errors.max_errors;
    let ([m_min, m_max], [h_min, h_max]) = (texts(m, m_error), texts(half_dm, half_dm_error));
    let (title, positions) = (&prepared.file().title, curves.q.len());
    let name = prepared.coordinate_name();
    let [m_unit, half_dm_unit] = inertia_units(prepared.is_angle()).map(|u| u.replace('2', "²"));
    let unit = coordinate_unit(prepared.is_angle());
    let range = reduction.ends().map_or_else(String::new, |ends| {
        let [first, last] = ends.map(|q| digits(q, 6));
        format!(" from {first} to {last} {unit}")
    });
    let mut summary = format!(
        "{title}: {positions} positions of {name}{range}, and there\n  m    from {m_min} to {m_max} {m_unit}\n  ½m′  from {h_min} to \
         {h_max} {half_dm_unit}\n"
    );
    if let Some(peak) = peak {
        let (q, largest) = (digits(peak.q, 9), digits_within(peak.m, peak.error, 9));
        summary += &format!(
            "  between these positions m reaches {largest} {m_unit}, at {name} = {q} {unit}: more rows show it (--points)\n"
        );
    }
    summary += &describe_rounding(
        &reduction.errors,
        !reduction.prepared.reaction_units().is_empty(),
    );
    if let Some(note) = note {
        summary += &format!("  {note}\n");
    }
    if m[1] == 0.0 {
        summary += "  no body with mass moves: there is no equation of motion, and every inertial reaction is zero\n";
    }
    summary + &prepared.notes()
}
