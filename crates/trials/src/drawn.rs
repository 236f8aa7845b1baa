//! Findings on what is drawn at random: subjects with their runs, of which some may be refused.

use dwell_findings::{Check, Finding};

/// A subject with its runs.
pub(super) trait Drawn {
    /// A run.
    type Run;
    /// What its like are called.
    const NAME: &'static str;

    /// Its runs.
    fn runs(&self) -> &[Self::Run];

    /// A run of it in words.
    fn location(&self, run: &Self::Run) -> String;

    /// Why a run is refused or ended early, if it is.
    fn refusal(run: &Self::Run) -> Option<&str>;
}

/// All runs, each with its subject.
pub(super) fn runs<D: Drawn>(results: &[D]) -> impl Iterator<Item = (&D, &D::Run)> {
    let subjects = results.iter();
    subjects.flat_map(|subject| subject.runs().iter().map(move |run| (subject, run)))
}

/// Those that are not refused.
pub(super) fn completed<D: Drawn>(results: &[D]) -> impl Iterator<Item = (&D, &D::Run)> {
    runs(results).filter(|(_, run)| D::refusal(run).is_none())
}

/// A number, and where it is.
type Located = (f64, String);

/// The largest of something of the runs that are not refused.
pub(super) fn largest<D: Drawn>(results: &[D], of: impl Fn(&D::Run) -> Option<f64>) -> Located {
    let sizes = completed(results).filter_map(|(subject, run)| {
        // What is no number is as bad as can be.
        let size = of(run)?;
        let size = if size.is_nan() { f64::INFINITY } else { size };
        Some((size, subject, run))
    });
    let largest = sizes.max_by(|a, b| a.0.total_cmp(&b.0));
    largest.map_or_else(Located::default, |(size, subject, run)| {
        (size, subject.location(run))
    })
}

/// The part of the runs that is refused, with the first of them.
pub(super) fn refused<D: Drawn>(results: &[D]) -> Located {
    let refused = runs(results).filter_map(|(subject, run)| {
        let reason = D::refusal(run)?;
        Some(format!("{}: {reason}", subject.location(run)))
    });
    let refused: Vec<String> = refused.collect();
    let part = refused.len() as f64 / runs(results).count().max(1) as f64;
    (part, refused.into_iter().next().unwrap_or_default())
}

/// A finding on a number with what is allowed of it: what is compared, what the number is a part of, and why so much is allowed.
pub(super) fn finding<D: Drawn>(
    results: &[D],
    key: &str,
    [comparison, scale, reason]: [&str; 3],
    (value, worst_at): Located,
    allowed: f64,
) -> Finding {
    let (count, runs) = (results.len(), runs(results).count());
    Finding {
        comparison: comparison.to_owned(),
        domain: format!("{count} {} with {runs} runs", D::NAME),
        scale: scale.to_owned(),
        tolerance_reason: reason.to_owned(),
        worst_at,
        pass: value <= allowed && !results.is_empty(),
        ..Finding::new(key, Check::ClosedForms, [value; 2], allowed)
    }
}
