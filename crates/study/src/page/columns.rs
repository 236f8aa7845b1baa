//! The rows of a page, and the groups of columns in charts.

use crate::number_format::count;
use crate::trajectory::compute::{Quantity, TrajectoryResults};
use dwell_page::PageColumn;

/// Numbers of a page at most, so that it can be opened: about 10 MB.
const MAX_VALUES: usize = 1_200_000;

/// Which of the rows in memory a page shows.
pub(crate) struct RowChoice {
    rows: Vec<usize>,
}

impl RowChoice {
    /// All rows, or every n-th row and the last one.
    pub(crate) fn new(results: &TrajectoryResults) -> Self {
        let columns = results.written.len().max(1);
        Self::of(results.rows.len(), columns)
    }

    /// All rows.
    pub(crate) fn all(rows: usize) -> Self {
        Self {
            rows: (0..rows).collect(),
        }
    }

    /// The rows to show for given numbers of rows and columns.
    pub(crate) fn of(rows: usize, columns: usize) -> Self {
        let stride = (rows * columns).div_ceil(MAX_VALUES).max(1);
        let last = rows.saturating_sub(1);
        let mut chosen: Vec<usize> = (0..rows).step_by(stride).collect();
        if chosen.last().is_some_and(|k| *k != last) {
            chosen.push(last);
        }
        Self { rows: chosen }
    }

    /// The rows in memory that are shown.
    pub(crate) fn rows(&self) -> impl Iterator<Item = usize> {
        self.rows.iter().copied()
    }

    /// Something of each row that is shown.
    pub(crate) fn map<'a, T, R>(&self, all: &'a [T], of: impl Fn(&'a T) -> R) -> Vec<R> {
        let mut chosen = Vec::with_capacity(self.rows.len());
        for &k in &self.rows {
            if let Some(row) = all.get(k) {
                chosen.push(of(row));
            }
        }
        chosen
    }

    /// A note if only some of all rows are shown.
    pub(crate) fn note(&self, all: usize) -> Option<String> {
        let shown = self.rows.len();
        (shown < all).then(|| {
            let all = count(all, "row");
            format!("the page has {shown} of {all}; the table of the command has all of them")
        })
    }
}

/// The columns of the tables.
pub(crate) fn page_columns(results: &TrajectoryResults, choice: &RowChoice) -> Vec<PageColumn> {
    let column = |&k: &usize| {
        let of = &results.columns[k];
        PageColumn {
            group: group(of.quantity).to_owned(),
            description: of.meaning.clone(),
            ..PageColumn::new(
                &of.name,
                of.unit,
                choice.map(&results.rows, |row: &Vec<f64>| row[k]),
            )
        }
    };
    results.written.iter().map(column).collect()
}

/// The chart group of a quantity; columns of a group with the same unit share a chart.
fn group(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "Time",
        Quantity::ActuatorCoordinate(..) | Quantity::Measured(..) => "Coordinates",
        Quantity::ActuatorForce(_) => "Actuator forces",
        Quantity::Rotation(..) => "Bodies",
        Quantity::VelocityRatio(_) => "Velocity ratios",
        Quantity::MechanicalAdvantage(..) => "Mechanical advantages",
        Quantity::Pole(..) => "Poles",
        Quantity::Point(..) => "Points",
        Quantity::TransmissionAngle(_) | Quantity::LeastDeterminant => "Transmission angles",
        Quantity::ForceMagnitude(_) | Quantity::MomentMagnitude(_) => "Reactions, magnitudes",
        Quantity::ForceDirection(_) => "Reactions, directions",
        Quantity::Reaction(_) | Quantity::KnownReaction(..) => "Reactions, components",
        Quantity::BodyFrameForce(..) => "Reactions in frames of bodies",
        Quantity::ShakingForce(_) => "Shaking force",
        Quantity::Power(_) | Quantity::LoadPower(_) => "Power and energy",
        Quantity::LoadForce(_) => "Loads",
        Quantity::Extra(_) => "Energies and states",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rows_are_all_shown_and_of_many_the_first_and_the_last() {
        let few = RowChoice::of(1001, 139);
        assert_eq!((few.rows.len(), few.note(1001)), (1001, None));
        let many = RowChoice::of(100_000, 139);
        assert_eq!((many.rows[0], many.rows.last()), (0, Some(&99_999)));
        assert!(many.rows.len() * 139 <= MAX_VALUES + 139);
        assert!(many.note(100_000).is_some());
        assert!(RowChoice::of(0, 0).rows.is_empty());
    }
}
