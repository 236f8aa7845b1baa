//! The extrema of the columns of a trajectory, with their errors, for listings.

#[cfg(feature = "output")]
use crate::number_format::{digits_within, number};
use crate::ranges::extent;
use crate::trajectory::compute::{Extremum, TrajectoryResults};

/// Largest number of columns that are named one by one.
const MAX_NAMED: usize = 40;

/// The minimum and maximum of a column, and where they occur.
pub(crate) struct ColumnExtrema {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    /// The smallest and the largest value.
    pub(crate) ends: [Extremum; 2],
    /// The estimated error of its values, in its unit.
    pub(crate) error: f64,
    /// Whether they are the extrema of the rows only; larger ones may lie between the rows.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for texts"))]
    pub(crate) of_rows: bool,
    /// Extent of the abscissa.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for texts"))]
    span: f64,
}

/// An extremum is found to this part of the abscissa: there, a rounding of its value is the change of a parabola.
#[cfg(feature = "output")]
const FOUND_WITHIN: f64 = 1e-6;

#[cfg(feature = "output")]
impl ColumnExtrema {
    /// An extremum and where it occurs, to the digits that their errors leave.
    pub(crate) fn texts(&self, Extremum { value, at }: Extremum) -> [String; 2] {
        let size = self
            .ends
            .iter()
            .map(|end| end.value.abs())
            .fold(0.0, f64::max);
        let relative = if self.error > 0.0 {
            self.error / size
        } else {
            0.0
        };
        let error_at = self.span * (FOUND_WITHIN + relative).min(1.0);
        let value = if self.error.is_finite() {
            digits_within(value, self.error, 6)
        } else {
            number(value)
        };
        [value, digits_within(at, error_at, 6)]
    }

    /// The extrema in other units: values and abscissa times these factors.
    pub(crate) fn scaled(&self, factor: f64, at_factor: f64) -> Self {
        Self {
            name: self.name.clone(),
            ends: self.ends.map(|end| Extremum {
                value: end.value * factor,
                at: end.at * at_factor,
            }),
            error: self.error * factor,
            of_rows: self.of_rows,
            span: self.span * at_factor,
            unit: self.unit,
        }
    }
}

impl ColumnExtrema {
    /// The extremum of larger magnitude.
    pub(crate) fn largest(&self) -> Extremum {
        let [min, max] = self.ends;
        if min.value.abs() > max.value.abs() {
            min
        } else {
            max
        }
    }
}

/// The sentence about columns in the tables whose extrema are those of the rows, while those of other columns are searched for between
/// the rows. It names the first of them.
pub(crate) fn searched_in_rows(results: &TrajectoryResults) -> Option<String> {
    let of_rows = results.written.iter();
    let of_rows = of_rows.filter(|&&k| results.extrema.of_rows[k]);
    let mut names = of_rows.map(|&k| results.columns[k].name.as_str());
    let first: Vec<&str> = names.by_ref().take(MAX_NAMED).collect();
    let (first, others) = (first.join(", "), names.count());
    let others = match others {
        0 => String::new(),
        others => format!(" and {others} others"),
    };
    (!first.is_empty()).then(|| format!("Of the rows only: {first}{others}."))
}

/// The extrema of some columns, grouped by unit, largest absolute value first.
pub(crate) fn sorted_extrema(
    results: &TrajectoryResults,
    listed: &[usize],
    abscissa: usize,
    size: f64,
) -> Vec<ColumnExtrema> {
    let [from, to] = extent(results.rows.iter().map(|row| row[abscissa]));
    // Of the forces along a prescribed motion the rounding is known, relative to the largest of their unit.
    let largest_of = |unit: &str| {
        let columns = results.columns.iter().zip(&results.extrema.of_columns);
        let alike =
            columns.filter(|(column, _)| column.unit == unit && matches!(unit, "N" | "N m"));
        let ends = alike.flat_map(|(_, ends)| ends.iter().flatten());
        let sizes = ends.map(|end| end.value.abs());
        let largest = results.references.largest_of(unit, size);
        sizes.chain([largest]).fold(0.0, f64::max)
    };
    let mut largest: Vec<(&str, f64)> = Vec::new();
    for column in listed.iter().map(|&k| &results.columns[k]) {
        if largest.iter().all(|(unit, _)| *unit != column.unit) {
            largest.push((column.unit, largest_of(column.unit)));
        }
    }
    let rounding = |unit: &str| {
        let of_unit = largest.iter().find(|(known, _)| *known == unit);
        results.rounding_error.unwrap_or(0.0) * of_unit.map_or(0.0, |(_, largest)| *largest)
    };
    let entry = |&k: &usize| {
        let (unit, error) = (results.columns[k].unit, results.errors.get(k).copied());
        Some(ColumnExtrema {
            name: results.columns[k].name.clone(),
            unit,
            ends: results.extrema.of_columns[k]?,
            error: error.unwrap_or_else(|| rounding(unit)),
            of_rows: results.extrema.of_rows[k],
            span: to - from,
        })
    };
    let mut all: Vec<ColumnExtrema> = listed.iter().filter_map(entry).collect();
    let units: Vec<&str> = all.iter().map(|entry| entry.unit).collect();
    let unit_order = |p: &ColumnExtrema| units.iter().position(|u| *u == p.unit);
    // One quantity under two names differs by rounding, about 1e-16; so the last bits do not order them.
    let size = |p: &ColumnExtrema| p.largest().value.abs().to_bits() >> 20;
    all.sort_by_key(|of| (unit_order(of), std::cmp::Reverse(size(of))));
    all
}
