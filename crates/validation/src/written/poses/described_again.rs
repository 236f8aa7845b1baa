//! The motions of drawn laws once more, described in another way: rises and sinusoids as expressions, tables turned by half a
//! turn about their middle, which cubic splines and monotone curves commute with.

use super::difference::Differences;
use super::drawn_laws::DrawnMotion;
use super::law::{Law, Shape};
use super::program::Program;
use super::rows::{Rows, largest};
use super::scene_text::{table_of, text_of, value_of};
use toml::{Table, Value};

/// Rows this near to a corner are not compared, part of the duration: its derivatives are those of either side.
const NEAR: f64 = 1e-9;

/// How the rows of the other description follow from those of the first.
enum Description {
    Same,
    /// Backwards in time, and mirrored about the sum of the first and the last value.
    Turned(f64),
}

/// Runs the other description of a motion and compares the rows of its coordinate; nothing where it has none.
pub(crate) fn described_again_differences(
    program: &Program,
    motion: &DrawnMotion,
) -> Result<Differences, String> {
    let mut scene = table_of(&motion.text)?;
    let Some((coordinate, law)) = prescribed(motion) else {
        return Ok(Differences::default());
    };
    let unit = motion.reading.unit_of(coordinate.1);
    let Some(prescribed) = scene.get_mut("prescribed").and_then(Value::as_table_mut) else {
        return Ok(Differences::default());
    };
    let description = match law {
        Law::Curve(_) => {
            let Some(sum) = turn(prescribed, coordinate.0) else {
                return Ok(Differences::default());
            };
            Description::Turned(sum * unit)
        }
        law => {
            let Some(text) = expression(law) else {
                return Ok(Differences::default());
            };
            let entry = value_of([("expression", text.into())]);
            prescribed.insert(coordinate.0.to_owned(), entry);
            Description::Same
        }
    };
    let count = motion.rows.count.to_string();
    let name = format!("{}-again", motion.name);
    let arguments = ["kinematics", "--points", &count];
    let run = program.run(&name, &text_of(&scene)?, &arguments)?;
    let rows = run.csv("-kinematics.csv")?;
    Ok(compare(motion, &rows, coordinate.0, law, &description))
}

/// The coordinate that is prescribed, with what it measures, and its law.
fn prescribed(motion: &DrawnMotion) -> Option<((&str, super::reading::Measure), &Law)> {
    let reading = &motion.reading;
    let coordinate = reading.coordinates.first()?;
    let law = reading.laws.first()?.as_ref()?;
    Some(((&coordinate.name, coordinate.measure), law))
}

/// Turns the table of a law by half a turn; returns the sum of its first and last value, in the scene's unit.
fn turn(prescribed: &mut Table, coordinate: &str) -> Option<f64> {
    let rows = prescribed
        .get_mut(coordinate)?
        .get_mut("table")?
        .as_array_mut()?;
    let of = |row: &Value| Some([row.get(0)?.as_float()?, row.get(1)?.as_float()?]);
    let points: Vec<[f64; 2]> = rows.iter().map(of).collect::<Option<_>>()?;
    let ([first, last], [begin, end]) = (
        [points.first()?[1], points.last()?[1]],
        [points.first()?[0], points.last()?[0]],
    );
    let turned = points.iter().rev();
    let turned = turned.map(|[x, y]| vec![begin + end - x, first + last - y].into());
    *rows = turned.collect();
    Some(first + last)
}

/// The law as an expression of the time, in SI units.
fn expression(law: &Law) -> Option<String> {
    Some(match law {
        Law::Sinusoid {
            start,
            amplitude,
            period,
            phase,
        } => format!(
            "({start:?}) + ({amplitude:?})*(sin(2*pi/({period:?})*t + ({phase:?})) - sin({phase:?}))"
        ),
        Law::Rise {
            shape,
            start,
            rise,
            duration,
            delay,
        } => {
            let u = format!("((t - ({delay:?}))/({duration:?}))");
            let moved = match shape {
                Shape::Polynomial345 => format!("{u}^3*(10 - 15*{u} + 6*{u}^2)"),
                Shape::Polynomial4567 => format!("{u}^4*(35 - 84*{u} + 70*{u}^2 - 20*{u}^3)"),
                Shape::Cycloidal => format!("({u} - sin(2*pi*{u})/(2*pi))"),
                Shape::Trapezoidal(ramp) => {
                    let [height, half, rest] = [1.0 / (1.0 - ramp), 0.5 * ramp, 1.0 - ramp];
                    let ends = format!("{height:?}/(2*({ramp:?}))");
                    format!(
                        "if({u} < {ramp:?}, {ends}*{u}^2, if({u} < {rest:?}, {height:?}*({u} - {half:?}), 1 - {ends}*(1 - {u})^2))"
                    )
                }
            };
            let end = delay + duration;
            format!(
                "if(t < {delay:?}, {start:?}, if(t < {end:?}, ({start:?}) + ({rise:?})*{moved}, {:?}))",
                start + rise
            )
        }
        Law::Speed { .. } | Law::Curve(_) | Law::Expression(_) => return None,
    })
}

/// The coordinate, its velocity and acceleration in both files, relative to the largest of each.
fn compare(
    motion: &DrawnMotion,
    again: &Rows,
    coordinate: &str,
    law: &Law,
    how: &Description,
) -> Differences {
    let mut all = Differences::default();
    let rows = &motion.rows;
    if again.count != rows.count {
        all.fail(format!(
            "{}: {} rows, described otherwise {}",
            motion.name, rows.count, again.count
        ));
        return all;
    }
    let last = rows.count - 1;
    let duration = rows.time(last);
    // At its points a spline's derivatives up to the second are the same from both sides.
    let corners = match law {
        Law::Curve(curve) if curve.is_spline() => Vec::new(),
        law => law.corners(),
    };
    let is_corner = |row: usize| {
        let near = |at: &f64| (rows.time(row) - at).abs() <= NEAR * duration;
        corners.iter().any(near)
    };
    for (order, end) in ["", ".velocity", ".acceleration"].into_iter().enumerate() {
        let column = format!("{coordinate}{end}");
        let (Some(first), Some(second)) = (rows.columns.get(&column), again.columns.get(&column))
        else {
            all.fail(format!("{}: no column {column}", motion.name));
            continue;
        };
        let scale = largest(first);
        for row in (0..rows.count).filter(|&row| order == 0 || !is_corner(row)) {
            let other = match how {
                Description::Same => second[row],
                Description::Turned(sum) => match order {
                    0 => sum - second[last - row],
                    1 => second[last - row],
                    _ => -second[last - row],
                },
            };
            all.add(first[row] - other, scale, "", || {
                format!("{}, row {row}, {column}", motion.name)
            });
        }
    }
    all
}
