//! The highlights of a movement: ranges of bodies, transmission angles, and the dwell of a body.

use crate::number_format::digits;
use crate::trajectory::compute::{Column, Quantity, TrajectoryResults};
use dwell_findings::Record;
use dwell_scene::{PlaneScene, SceneFile};
use std::collections::VecDeque;

/// Lines of each kind.
const MAX_LISTED: usize = 3;
/// Digits of angles and lengths.
const DIGITS: usize = 6;
/// A body that turns or slides by less than this, rad or m, is at rest within rounding.
const ROUNDING: f64 = 1e-9;

/// A movement along a trajectory: its scene, its results and their abscissa.
pub(crate) struct Movement<'a> {
    pub(crate) file: &'a SceneFile,
    /// In the plane.
    pub(crate) scene: Option<&'a PlaneScene>,
    pub(crate) results: &'a TrajectoryResults,
    /// The column of time, or of the swept coordinate.
    pub(crate) abscissa: usize,
}

impl Movement<'_> {
    /// The lines about swings, transmission angles and the dwell; the numbers go into the record.
    pub(crate) fn describe(&self, record: &mut Record) -> String {
        self.swings(record) + &self.transmission_angles(record) + &self.dwell(record)
    }

    /// A column with its smallest and largest value and its extent.
    fn extents<'r>(
        &'r self,
        of: impl Fn(&Column) -> bool + 'r,
    ) -> impl Iterator<Item = (&'r Column, [f64; 2])> + 'r {
        let columns = self.results.columns.iter();
        let columns = columns.zip(&self.results.extrema.of_columns);
        columns.filter_map(move |(column, ends)| {
            let ends = ends.filter(|_| of(column))?.map(|end| end.value);
            Some((column, ends))
        })
    }

    /// A number in the scene's unit of angles or lengths.
    fn text(&self, value: f64, is_angle: bool) -> String {
        let (value, unit) = self.file.to_scene_unit(value, is_angle);
        format!("{} {unit}", digits(value, DIGITS))
    }

    /// By how much the bodies that move most swing, and the joints that slide most travel.
    fn swings(&self, record: &mut Record) -> String {
        let is_of_kind = |c: &Column, is_angle: bool| match c.quantity {
            Quantity::Rotation(_, 0, _) => is_angle && c.unwraps,
            // In the plane bodies have their angles.
            Quantity::Measured(_, 0) => (c.unit == "rad") == is_angle && !c.unwraps,
            _ => false,
        };
        let mut text = String::new();
        for (is_angle, verb) in [(true, "turns"), (false, "travels")] {
            let mut all: Vec<_> = self.extents(move |c| is_of_kind(c, is_angle)).collect();
            let range = |[low, high]: [f64; 2]| high - low;
            all.retain(|(_, ends)| range(*ends) > ROUNDING);
            all.sort_by(|(_, a), (_, b)| range(*b).total_cmp(&range(*a)));
            // What turns exactly as another is named once.
            all.dedup_by(|(_, a), (_, b)| (range(*a) - range(*b)).abs() < ROUNDING);
            for (column, ends) in all.into_iter().take(MAX_LISTED) {
                let name = &column.name;
                let by = range(ends);
                // An end that is but rounding is zero.
                let [from, to] = ends.map(|end| if end.abs() < 1e-12 * by { 0.0 } else { end });
                record.add(format!("{name}.range"), column.unit, by);
                record.add(format!("{name}.range.from"), column.unit, from);
                record.add(format!("{name}.range.to"), column.unit, to);
                let [by, from, to] = [by, from, to].map(|value| self.text(value, is_angle));
                let ending = if is_angle { ".angle" } else { ".travel" };
                let name = name.strip_suffix(ending).unwrap_or(name);
                text += &format!("  {name} {verb} by {by}, from {from} to {to}\n");
            }
        }
        text
    }

    /// The extremes of the transmission angles that are farthest from a right angle.
    fn transmission_angles(&self, record: &mut Record) -> String {
        let is_transmission = |c: &Column| matches!(c.quantity, Quantity::TransmissionAngle(_));
        let mut all: Vec<_> = self.extents(is_transmission).collect();
        let deviation = |ends: [f64; 2]| {
            let from_right = ends.map(|angle| (angle - std::f64::consts::FRAC_PI_2).abs());
            from_right[0].max(from_right[1])
        };
        all.sort_by(|(_, a), (_, b)| deviation(*b).total_cmp(&deviation(*a)));
        let lines = all.into_iter().take(MAX_LISTED).map(|(column, ends)| {
            let name = column.name.strip_suffix(".transmission_angle");
            let name = name.unwrap_or(&column.name);
            for (end, value) in ["min", "max"].into_iter().zip(ends) {
                record.add(format!("{name}.transmission_angle.{end}"), "rad", value);
            }
            let [from, to] = ends.map(|value| self.text(value, true));
            format!("  transmission angle at {name} from {from} to {to}\n")
        });
        lines.collect()
    }

    /// The dwell of the requested body: the longest part of the trajectory over which its angle stays within the band.
    fn dwell(&self, record: &mut Record) -> String {
        let Some((scene, request)) =
            (self.scene).and_then(|s| Some((s, s.requests.dwell.as_ref()?)))
        else {
            return String::new();
        };
        let column = Quantity::Rotation(request.body, 0, 2);
        let Some(angle) = self.results.column_index(column) else {
            return String::new();
        };
        let rows = &self.results.rows;
        let angles: Vec<f64> = rows.iter().map(|row| row[angle]).collect();
        let [low, high] = crate::ranges::extent(angles.iter().copied());
        let band = request.relative_band * (high - low);
        let name = scene.mechanism.body_name(request.body);
        let Some([first, last]) = max_window(&angles, band).filter(|[a, b]| b > a) else {
            return String::new();
        };
        let percent = digits(100.0 * request.relative_band, DIGITS);
        record.add("dwell.relative_band", "", request.relative_band);
        let within = crate::ranges::extent(angles[first..=last].iter().copied());
        let middle = 0.5 * (within[0] + within[1]);
        record.add("dwell.angle", "rad", middle);
        let middle = self.text(middle, true);
        let mut places = Vec::new();
        let is_coordinate = |c: &Column| {
            matches!(
                c.quantity,
                Quantity::Time | Quantity::ActuatorCoordinate(_, 0)
            )
        };
        let columns = self.results.columns.iter().enumerate();
        for (k, column) in columns.filter(|(k, c)| *k == self.abscissa || is_coordinate(c)) {
            let [from, to] = [first, last].map(|row| rows[row][k]);
            record.add(format!("dwell.{}.from", column.name), column.unit, from);
            record.add(format!("dwell.{}.to", column.name), column.unit, to);
            let [from, to] = [from, to].map(|value| match column.unit {
                "s" => format!("{} s", digits(value, DIGITS)),
                unit => self.text(value, unit == "rad"),
            });
            places.push(format!("{} from {from} to {to}", column.name));
        }
        let places = places.join(", ");
        format!(
            "  {name} rests at {middle} within {percent} % of its range: {places}, of the rows\n"
        )
    }
}

/// The first and the last index of the longest run of values whose extent is within a band; the first of several.
fn max_window(values: &[f64], band: f64) -> Option<[usize; 2]> {
    // The indices of candidates for the smallest and the largest value of the window, in order.
    let mut ends: [VecDeque<usize>; 2] = [VecDeque::new(), VecDeque::new()];
    let mut first = 0;
    let mut longest: Option<[usize; 2]> = None;
    for (k, value) in values.iter().enumerate() {
        for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
            while end
                .back()
                .is_some_and(|&j| sign * values[j] >= sign * value)
            {
                end.pop_back();
            }
            end.push_back(k);
        }
        let extent = |ends: &[VecDeque<usize>; 2]| {
            let [low, high] = [&ends[0], &ends[1]].map(|end| end.front().map(|&j| values[j]));
            high.zip(low).map_or(0.0, |(high, low)| high - low)
        };
        while first < k && extent(&ends) > band {
            first += 1;
            for end in &mut ends {
                while end.front().is_some_and(|&j| j < first) {
                    end.pop_front();
                }
            }
        }
        if longest.is_none_or(|[a, b]| k - first > b - a) {
            longest = Some([first, k]);
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_largest_extent_is_found() {
        let values = [0.0, 1.0, 1.05, 1.02, 1.06, 2.0, 2.01, 3.0];
        assert_eq!(max_window(&values, 0.1), Some([1, 4]));
        assert_eq!(max_window(&values, 0.02), Some([5, 6]));
        assert_eq!(max_window(&values, 10.0), Some([0, 7]));
        assert_eq!(max_window(&[], 1.0), None);
        // Against all windows, of a curve whose rest is known: sin stays within 1 − cos w about its crest.
        let curve: Vec<f64> = (0..=1000)
            .map(|k| (f64::from(k) * 0.002 * std::f64::consts::PI).sin())
            .collect();
        let band = 0.01;
        let [a, b] = max_window(&curve, band).expect("a window");
        let half_width = (1.0_f64 - band).acos() / (0.002 * std::f64::consts::PI);
        assert!(
            (((b - a) as f64) - 2.0 * half_width).abs() <= 2.0,
            "{a} {b}"
        );
    }
}
