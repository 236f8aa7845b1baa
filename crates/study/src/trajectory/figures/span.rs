//! Which part of a trajectory the curves show: the beginning of a motion may be so much larger that it hides the rest.

use crate::explain::{StudyError, scene_error};
use crate::number_format::digits;
use dwell_scene::SceneFile;
use std::ops::Range;

/// The interval in which curves are drawn: times in s, or the swept coordinate in the scene's unit. Files keep all
/// rows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PictureSpan {
    /// Start of the curves; the start of the trajectory if absent.
    pub from: Option<f64>,
    /// End of the curves; the end of the trajectory if absent.
    pub to: Option<f64>,
}

/// The part of the rows that is shown, and its ends on the axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DrawnRows {
    pub(super) rows: Range<usize>,
    /// The ends of the interval; `None` if all rows are shown.
    pub(super) ends: Option<[f64; 2]>,
}

impl DrawnRows {
    /// The rows within a span, with one more at either side; `values` are the abscissae of all rows in the unit of the span.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the span is reversed, empty, NaN, or outside the trajectory.
    pub(super) fn new(
        scene: &SceneFile,
        span: PictureSpan,
        values: &[f64],
        unit: &str,
    ) -> Result<Self, StudyError> {
        let all = Self {
            rows: 0..values.len(),
            ends: None,
        };
        let (Some(first), Some(last)) = (values.first(), values.last()) else {
            return Ok(all);
        };
        if span == PictureSpan::default() {
            return Ok(all);
        }
        let (low, high) = (first.min(*last), first.max(*last));
        let (from, to) = (span.from.unwrap_or(low), span.to.unwrap_or(high));
        let text = |value: f64| format!("{} {unit}", digits(value, 6)).trim_end().to_owned();
        let whole = format!("the rows go from {} to {}", text(low), text(high));
        let refuse =
            |message: String, help: String| Err(scene_error::<String>(scene, message, help, []));
        // Not a number is neither below nor above.
        if !(from.is_finite() && to.is_finite() && from < to) {
            let message = format!("the curves cannot go from {} to {}", text(from), text(to));
            return refuse(message, format!("give --from below --to; {whole}"));
        }
        // An end that is read off a table may be beyond the last row by its rounding.
        let rounding = 1e-6 * (high - low);
        if from >= high || to <= low || from < low - rounding || to > high + rounding {
            let message = format!(
                "the curves are to go from {} to {}, which is not within the motion",
                text(from),
                text(to)
            );
            return refuse(
                message,
                format!("{whole}: choose --from and --to among them"),
            );
        }
        let inside = |v: &f64| (from..=to).contains(v);
        let begin = values.iter().position(inside);
        let end = values.iter().rposition(inside);
        // Between two rows there is none, but a line.
        let next = || {
            values
                .windows(2)
                .position(|w| (w[0] < from) != (w[1] < from))
        };
        let begin = begin.or_else(next).unwrap_or(0);
        let end = end.unwrap_or(begin);
        Ok(Self {
            rows: begin.saturating_sub(1)..(end + 2).min(values.len()),
            ends: Some([from, to]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_scene::PlaneScene;

    fn scene() -> PlaneScene {
        let text = "[bodies.ground]\npoints = { A = [0, 0] }\n[bodies.crank]\npoints = { A = [0, 0] }\n\
                    [joints]\nA = { revolute = [\"ground.A\", \"crank.A\"] }\n[actuators]\n\
                    phi = { angle = [\"ground\", \"crank\"] }\n";
        PlaneScene::parse("crank.toml", text).expect("a scene")
    }

    fn drawn_rows(from: f64, to: f64, values: &[f64]) -> Result<DrawnRows, String> {
        let span = PictureSpan {
            from: Some(from),
            to: Some(to),
        };
        DrawnRows::new(&scene(), span, values, "s").map_err(|e| e.to_string())
    }

    #[test]
    fn rows_within_the_span_and_their_neighbours_are_drawn() {
        let rising: Vec<f64> = (0..=10).map(f64::from).collect();
        let falling: Vec<f64> = rising.iter().rev().copied().collect();
        assert_eq!(drawn_rows(2.5, 6.0, &rising).expect("rows").rows, 2..8);
        assert_eq!(drawn_rows(2.5, 6.0, &falling).expect("rows").rows, 3..9);
        assert_eq!(drawn_rows(0.0, 10.0, &rising).expect("rows").rows, 0..11);
        // Between two rows.
        assert_eq!(drawn_rows(4.2, 4.8, &rising).expect("rows").rows, 3..6);
        let all = DrawnRows::new(&scene(), PictureSpan::default(), &rising, "s").expect("rows");
        assert_eq!((all.rows, all.ends), (0..11, None));
    }

    #[test]
    fn spans_that_show_nothing_are_refused() {
        let values = [0.0, 1.0, 2.0];
        for (from, to) in [
            (1.0, 1.0),
            (1.5, 0.5),
            (f64::NAN, 1.0),
            (0.0, f64::INFINITY),
        ] {
            let error = drawn_rows(from, to, &values).expect_err("a reversed span");
            assert!(error.contains("cannot go from"), "{error}");
        }
        for (from, to) in [(-1.0, 1.0), (1.0, 3.0), (2.0, 2.5), (5.0, 6.0)] {
            let error = drawn_rows(from, to, &values).expect_err("a span outside");
            assert!(error.contains("not within the motion"), "{error}");
        }
    }
}
