//! Laws of every kind and expressions of every function: scenes in which the mechanism of a case is driven by them, and
//! what the program writes of these.

use super::program::Program;
use super::reading::Reading;
use super::rows::Rows;
use super::scene_text::{Draws, table_of, text_of, value_of};
use toml::{Table, Value};

/// Functions of the time t whose values are compared, with room for two drawn numbers.
const MAGNITUDES: [&str; 26] = [
    "sin(A*t + B)",
    "cos(A*t + B)",
    "tan(sin(A*t + B))",
    "asin(0.9*sin(A*t + B))",
    "acos(0.9*sin(A*t + B))",
    "atan(A*t - B)",
    "atan2(sin(A*t), cos(A*t) + 0.1*B)",
    "sinh(A*t - B)",
    "cosh(A*t - B)",
    "tanh(A*t - B)",
    "exp(-A*t) + B",
    "ln(1 + A*t + B)",
    "log10(1 + A*t + B)",
    "sqrt(A*t + B)",
    "abs(A*t - B)",
    "sign(A*t - B)",
    "floor(A*t + B)",
    "step(A*t - B)",
    "min(A*t, B)",
    "max(A*t, B)",
    "hypot(A*t, B)",
    "clamp(A*t, 0.3*B, B)",
    "if(A*t < B, A, B*t)",
    "if(A*t >= B, A/(1 + t), -B^2)",
    "(1 + A*t)^1.7 - (A*t)^2 + B^3",
    "A*t - B/(1 + t)*tau + pi",
];
/// A motion of the coordinate: a smooth mixture of functions that stays between −1 and 1.
const MIXTURE: &str = "0.2*sin(A*t + B) + 0.15*cos(A*t)*exp(-t) + 0.1*tanh(A*t - B) + 0.1*atan2(sin(A*t), 2 + B) \
    + 0.1*sqrt(1 + A*t)/(2 + A*t) + 0.05*ln(1 + t) + 0.05*hypot(sin(t), 1)*abs(t + 1)/(1 + t)^2 + 0.05*asin(0.5*sin(A*t)) \
    + 0.05*min(t, 5)*max(-5, -t)*sign(t + 1) + 0.02*(cosh(0.3*t) - sinh(0.3*t)) + 0.02*tan(0.3*t) + 0.02*log10(2 + t) \
    + 0.02*acos(0.4*cos(A*t)) + 0.02*atan(t - 1) + if(t < 9, 0.02*step(t + 1), 1) + floor(0.1*t)*clamp(t, -9, 9)";
/// Kinds of laws that a coordinate is driven by.
const KINDS: [&str; 8] = [
    "polynomial345",
    "polynomial4567",
    "cycloidal",
    "trapezoidal",
    "sinusoid",
    "spline",
    "monotone",
    "expression",
];
/// Duration of the drawn motions, s.
const DURATION: f64 = 1.5;
/// Rows of each.
const POINTS: &str = "73";

/// A drawn motion: its scene as read, its rows, and a name for messages.
pub(crate) struct DrawnMotion {
    pub(crate) reading: Reading,
    pub(crate) rows: Rows,
    pub(crate) name: String,
    pub(super) text: String,
}

/// The motions of a case with a single actuator: one for each kind of law, of which that by an expression also has loads
/// of every function. `range` is the range of the coordinate, in SI units.
pub(crate) fn drawn_motions(
    program: &Program,
    scene: &str,
    reading: &Reading,
    range: [f64; 2],
    draws: &mut Draws,
) -> Result<Vec<DrawnMotion>, String> {
    let mut all = Vec::new();
    for kind in KINDS {
        let mut table = table_of(scene)?;
        for section in [
            "prescribed",
            "coordinate-sweep",
            "motion",
            "drives",
            "stops",
            "requests",
            "calibration",
        ] {
            table.remove(section);
        }
        let with_loads = kind == "expression";
        prescribe(&mut table, reading, kind, range, draws)
            .ok_or("the scene has no assembly of its actuator")?;
        if with_loads {
            table.remove("friction");
            table.insert("loads".to_owned(), Value::Table(loads(reading, draws)?));
        }
        let text = text_of(&table)?;
        let command = if with_loads {
            "kinetostatics"
        } else {
            "kinematics"
        };
        let name = format!("law-{kind}");
        let run = program.run(&name, &text, &[command, "--points", POINTS])?;
        let rows = run.csv(&format!("-{command}.csv"))?;
        all.push(DrawnMotion {
            reading: Reading::new(&text)?,
            rows,
            name,
            text,
        });
    }
    Ok(all)
}

/// Numbers instead of A and B.
fn drawn(text: &str, draws: &mut Draws) -> String {
    let [a, b] = [0, 1].map(|_| 0.5 + draws.share());
    let number = |x: f64| format!("{x:.3}");
    let replaced = text.split_inclusive(|c: char| !c.is_alphanumeric());
    let word = |part: &str| match part.trim_end_matches(|c: char| !c.is_alphanumeric()) {
        "A" => part.replacen('A', &number(a), 1),
        "B" => part.replacen('B', &number(b), 1),
        _ => part.to_owned(),
    };
    replaced.map(word).collect()
}

/// One torque on the first moving body for each function.
fn loads(reading: &Reading, draws: &mut Draws) -> Result<Table, String> {
    let body = reading
        .bodies
        .iter()
        .find(|body| !body.is_ground)
        .ok_or("no body moves")?;
    let load = |(k, text): (usize, &&str)| {
        let magnitude = Value::String(drawn(text, draws));
        let torque = Value::String(body.name.clone());
        let entry = value_of([("torque", torque), ("magnitude", magnitude)]);
        (format!("function{k}"), entry)
    };
    Ok(MAGNITUDES.iter().enumerate().map(load).collect())
}

/// Prescribes the actuator by a law of a kind, within the range around its assembly.
// Long: an arm for each kind of law.
fn prescribe(
    table: &mut Table,
    reading: &Reading,
    kind: &str,
    range: [f64; 2],
    draws: &mut Draws,
) -> Option<()> {
    let coordinate = reading.coordinates.first()?;
    let unit = reading.unit_of(coordinate.measure);
    let assembly = table.get("assembly").and_then(|a| a.get(&coordinate.name));
    let start = super::law::number(assembly).unwrap_or(0.0) * unit;
    let turn = std::f64::consts::TAU;
    let is_whole = (range[1] - range[0] - turn).abs() < 1e-9;
    let room = if is_whole {
        [1.5, 1.5]
    } else {
        [start - range[0], range[1] - start]
    };
    let direction = if room[1] > room[0] { 1.0 } else { -1.0 };
    let amplitude = direction * 0.4 * room[0].max(room[1]).min(1.5) * (0.5 + 0.5 * draws.share());
    let delay = 0.1 + 0.1 * draws.share();
    let rise = |with_ramp: bool| {
        let mut entries = vec![
            ("rise", (amplitude / unit).into()),
            ("duration", (DURATION - 2.0 * delay).into()),
            ("delay", delay.into()),
        ];
        if with_ramp {
            entries.push(("ramp", 0.3_f64.into()));
        }
        value_of(entries)
    };
    let law = match kind {
        "sinusoid" => {
            // The largest excursion of a sinusoid with a phase is twice its amplitude.
            let size = 0.25 * amplitude.abs().min(room[0]).min(room[1]);
            let size = if size > 0.0 {
                size
            } else {
                0.25 * amplitude.abs()
            };
            let phase = draws.share() / reading.units.angle;
            let sinusoid = value_of([
                ("amplitude", (size / unit).into()),
                ("period", 0.9_f64.into()),
                ("phase", phase.into()),
            ]);
            value_of([("sinusoid", sinusoid)])
        }
        "spline" | "monotone" => {
            let points = (0..7).map(|k| {
                let share = if k == 0 {
                    0.0
                } else {
                    (f64::from(k) + 0.6 * draws.share()) / 7.0
                };
                let time = DURATION * f64::from(k) / 6.0;
                vec![time, (start + amplitude * share) / unit].into()
            });
            let points = Value::Array(points.collect());
            value_of([("table", points), ("interpolation", kind.into())])
        }
        "expression" => {
            let mixture = drawn(MIXTURE, draws);
            let text = format!("{start:?} + {:?}*({mixture})", 0.8 * amplitude);
            value_of([("expression", text.replace("+ -", "- ").into())])
        }
        _ => value_of([(kind, rise(kind == "trapezoidal"))]),
    };
    let prescribed = value_of([("duration", DURATION.into()), (&coordinate.name, law)]);
    table.insert("prescribed".to_owned(), prescribed);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::written::poses::expression::Expression;
    use crate::written::poses::jet::Jet;

    /// Every function and operator of a scene's expressions stands in a drawn one, and both readers know them.
    #[test]
    fn every_function_is_drawn() {
        let all = MAGNITUDES.join(" ") + MIXTURE;
        for name in [
            "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp",
            "ln", "log10", "sqrt", "abs", "sign", "floor", "step", "min", "max", "hypot", "clamp",
            "if",
        ] {
            assert!(all.contains(&format!("{name}(")), "{name}");
        }
        let mut draws = Draws::of("a scene");
        for text in MAGNITUDES.iter().chain([&MIXTURE]) {
            let text = drawn(text, &mut draws);
            let names = |name: &str| (name == "t").then_some(Jet([0.7, 1.0, 0.0]));
            let value = Expression::read(&text).and_then(|e| e.at(&names));
            assert!(
                value.is_some_and(|v| v.0.iter().all(|d| d.is_finite())),
                "{text}"
            );
        }
    }
}
