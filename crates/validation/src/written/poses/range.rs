//! Where the rows of `reduce` begin and end: between two limit positions that `check` names, a thousandth of the range from each.

use super::difference::Differences;
use super::rows::Rows;
use super::stated::result;
use serde_json::Value;

/// The part of the range that is left out at each limit position.
const MARGIN: f64 = 1e-3;

/// The first and the last row with the range of the summary of `check`; nothing of a mechanism that has no limit position at both ends.
pub(crate) fn range_differences(
    (contents, said): (&Value, &str),
    rows: &Rows,
    coordinate: &str,
) -> Differences {
    let mut to = Differences::default();
    let limit = |end: &str| result(contents, &format!("range.{end}"));
    // Elsewhere the range is how far was searched.
    let is_limited = said.contains("limit positions at both ends")
        || said.matches("limit position of ").count() >= 2;
    let (Some(lower), Some(upper), true) = (limit("lower"), limit("upper"), is_limited) else {
        return to;
    };
    let column = rows.column(coordinate);
    let (Some(first), Some(last)) = (column.first(), column.last()) else {
        to.fail(format!("`reduce` has no row of {coordinate}"));
        return to;
    };
    let span = upper - lower;
    for (at, expected) in [
        (first, lower + MARGIN * span),
        (last, upper - MARGIN * span),
    ] {
        to.add(at - expected, span, "", || {
            format!("an end of the rows at {at}, in the range from {lower} to {upper}")
        });
    }
    to
}
