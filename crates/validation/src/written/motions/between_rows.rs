//! Between the rows of a motion: what a column changes by is the integral of its rate, by Simpson's rule, whose error is
//! estimated from twice the interval.

use super::row_forces::{ComparedRows, MotionReading};
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::{Rows, largest};

/// An estimated error of the rule counts this many times: the next order of it is unknown.
const ERROR_FACTOR: f64 = 4.0;

/// Energies between rows.
#[derive(Debug, Default)]
pub(super) struct EnergyDifferences {
    /// Kinetic energy of the second reading with the power of all its forces; currents with their circuits.
    pub(super) balance: Differences,
    /// The columns of energies and works.
    pub(super) columns: Differences,
}

/// Compares energies and currents between the rows of a file.
pub(super) fn between_rows(
    motion: &MotionReading,
    of_rows: &ComparedRows,
    rows: &Rows,
    file: &str,
) -> EnergyDifferences {
    let mut found = EnergyDifferences::default();
    let Some(time) = rows.columns.get("t") else {
        found.balance.fail(format!("{file} has no time"));
        return found;
    };
    let (kinetic, power): (Vec<f64>, Vec<f64>) =
        of_rows.energies.iter().map(|[t, p]| (*t, *p)).unzip();
    let potential = rows.column("energy.potential");
    let works = rows.ending(".work").flat_map(|(_, work)| work);
    let scale = largest(kinetic.iter().chain(potential).chain(works));
    let at = |what: &str| format!("{file}, {what}");
    let (values, place) = ([&kinetic[..], &power], at("kinetic energy"));
    simpson(&mut found.balance, time, values, scale, &place);
    for (drive, rates) in motion.drives.iter().zip(&of_rows.current_rates) {
        let name = format!("{}.current", drive.name);
        if let (Some(current), false) = (rows.columns.get(&name), rates.is_empty()) {
            let (values, scale) = ([&current[..], rates], largest(current));
            simpson(&mut found.balance, time, values, scale, &at(&name));
        }
    }
    add_columns(&mut found.columns, (motion, of_rows), rows, (scale, file));
    found
}

/// The columns of energies and works against powers and energies of the second reading.
fn add_columns(
    to: &mut Differences,
    (motion, of_rows): (&MotionReading, &ComparedRows),
    rows: &Rows,
    (scale, file): (f64, &str),
) {
    let (time, potential) = (rows.column("t"), "energy.potential");
    let at = |what: &str| format!("{file}, {what}");
    let lost: Vec<f64> = of_rows.conservative_power.iter().map(|p| -p).collect();
    let values = [rows.column(potential), &lost];
    simpson(to, time, values, scale, &at(potential));
    let written = rows.column("energy.kinetic").iter();
    for (row, (written, [kinetic, _])) in written.zip(&of_rows.energies).enumerate() {
        to.add(written - kinetic, scale, "J", || {
            format!("{file}, row {row}, energy.kinetic")
        });
    }
    for (name, work) in rows.ending(".work") {
        let mut drives = motion.drives.iter();
        let of_drive = drives.position(|d| format!("{}.work", d.name) == *name);
        let power = match of_drive {
            Some(k) => of_rows.drive_power.get(k),
            None => rows.columns.get(&name.replace(".work", ".power")),
        };
        if let Some(power) = power {
            simpson(to, time, [work, power], scale, &at(name));
        }
    }
}

/// y(+1) − y(−1) = h/3 (y′₋ + 4 y′ + y′₊), at every row of an even grid.
pub(crate) fn simpson(
    to: &mut Differences,
    time: &[f64],
    [y, rate]: [&[f64]; 2],
    scale: f64,
    what: &str,
) {
    let rows = time.len();
    if y.len() != rows || rate.len() != rows {
        to.fail(format!("{what} has not as many values as there are rows"));
        return;
    }
    let inner = 2..rows.saturating_sub(2);
    let change = |i: usize, k: usize| {
        let sum = rate[i - k] + 4.0 * rate[i] + rate[i + k];
        y[i + k] - y[i - k] - (time[i + 1] - time[i]) * k as f64 / 3.0 * sum
    };
    for i in inner.clone() {
        let h = time[i + 1] - time[i];
        let is_even = (i - 2..i + 2).all(|k| (time[k + 1] - time[k] - h).abs() < 1e-6 * h);
        if !is_even {
            continue;
        }
        // Twice the interval has 2⁵ times the error; that of the next rows counts, too, for it may pass through zero.
        let near_rows = (i - 2..=i + 2).filter(|k| inner.contains(k));
        let far = near_rows.fold(0.0, |max: f64, k| max.max(change(k, 2).abs()));
        let difference = (change(i, 1).abs() - ERROR_FACTOR * far / 32.0).max(0.0);
        // What is not a number is the worst there is.
        let difference = if change(i, 1).is_nan() {
            f64::NAN
        } else {
            difference
        };
        to.add(difference, scale, "", || format!("{what}, row {i}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_that_is_not_the_integral_of_its_rate_is_found() {
        let time: Vec<f64> = (0..40).map(|k| 0.05 * f64::from(k)).collect();
        let sine: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        let cosine: Vec<f64> = time.iter().map(|t| t.cos()).collect();
        let largest = |y: &[f64], rate: &[f64]| {
            let mut all = Differences::default();
            simpson(&mut all, &time, [y, rate], 1.0, "sine");
            all.largest()
        };
        assert!(largest(&sine, &cosine) < 1e-12);
        let halved: Vec<f64> = cosine.iter().map(|c| 0.5 * c).collect();
        assert!(largest(&sine, &halved) > 1e-2);
    }
}
