//! Reference sizes from all columns of an analysis, requested or not. Relative to them, columns of a unit are zero
//! within rounding, independent of the other requested columns.

use crate::trajectory::compute::{Column, Quantity, UnitScales};

/// Above this part of the largest number of a table a number does not look like rounding.
const CONSPICUOUS: f64 = 1e-11;

/// The columns of an analysis with the largest magnitude that each has had so far.
#[derive(Default)]
pub(crate) struct UnitReferences {
    columns: Vec<Reference>,
}

struct Reference {
    column: Column,
    /// Its index among the requested columns.
    kept: Option<usize>,
    /// The largest of its finite values.
    largest: f64,
}

impl UnitReferences {
    /// The references of all columns of an analysis, of which the `kept` ones are in the rows.
    pub(crate) fn new(all: Vec<Column>, kept: &[Column]) -> Self {
        let reference = |column: Column| Reference {
            kept: kept
                .iter()
                .position(|c| c.quantity == column.quantity && c.name == column.name),
            column,
            largest: 0.0,
        };
        let mut columns: Vec<Reference> = all.into_iter().map(reference).collect();
        // Of the others only those that are a measure for some unit.
        columns.retain(|of| of.kept.is_some() || UnitScales::depend_on(of.column.unit));
        Self { columns }
    }

    /// Adds a row: the values of the requested columns, and those of the others.
    pub(crate) fn add_row(&mut self, row: &[f64], value: &dyn Fn(Quantity) -> f64) {
        for of in &mut self.columns {
            let value = match of.kept {
                Some(k) => row[k],
                None => value(of.column.quantity),
            };
            // What is no number is not larger.
            if value.abs() > of.largest && value.is_finite() {
                of.largest = value.abs();
            }
        }
    }

    /// The reference size of each unit, in a mechanism of this size (m).
    pub(crate) fn scales(&self, size: f64) -> UnitScales {
        let columns = self.columns.iter();
        let largest: Vec<(&Column, f64)> = columns.map(|of| (&of.column, of.largest)).collect();
        UnitScales::new(&largest, size)
    }

    /// By requested column: whether it is zero in every row within rounding.
    pub(crate) fn is_rounding(&self, scales: &UnitScales, requested: usize) -> Vec<bool> {
        let is_small = |of: &Reference| scales.is_rounding(of.column.unit, of.largest);
        let mut is_rounding = vec![false; requested];
        for of in &self.columns {
            let Some(k) = of.kept else { continue };
            is_rounding[k] = is_small(of)
                || match of.column.quantity {
                    // A force that is only rounding has no direction.
                    Quantity::ForceDirection(joint) => {
                        let magnitude = Quantity::ForceMagnitude(joint);
                        let mut columns = self.columns.iter();
                        let magnitude = columns.find(|of| of.column.quantity == magnitude);
                        magnitude.is_some_and(is_small)
                    }
                    _ => false,
                };
        }
        is_rounding
    }

    /// The requested columns that count as zero although their rows do not look like rounding, each with its largest
    /// magnitude and that of its unit: the column of the largest magnitude need not be requested.
    pub(crate) fn noted_zeros(&self, scales: &UnitScales, is_rounding: &[bool]) -> Vec<String> {
        let requested = || self.columns.iter().filter(|of| of.kept.is_some());
        let largest = requested().fold(1.0, |largest: f64, of| largest.max(of.largest));
        let conspicuous = requested().filter(|of| {
            of.kept.is_some_and(|k| is_rounding[k]) && of.largest > CONSPICUOUS * largest
        });
        let note = |of: &Reference| {
            let (Column { name, unit, .. }, scale) = (&of.column, scales.of(of.column.unit));
            format!(
                "{name}, at most {:.1e} {unit}, compared with {scale:.1e} {unit}",
                of.largest
            )
        };
        conspicuous.map(note).collect()
    }

    /// The largest magnitude of a unit, apart from rounding.
    pub(crate) fn largest_of(&self, unit: &str, size: f64) -> f64 {
        let scales = self.scales(size);
        let alike = self.columns.iter().filter(|of| of.column.unit == unit);
        let more = alike.filter(|of| !scales.is_rounding(unit, of.largest));
        more.map(|of| of.largest).fold(0.0, f64::max)
    }
}
