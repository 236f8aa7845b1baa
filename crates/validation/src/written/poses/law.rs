//! The laws of a scene, read from its text once more: motions of actuators in time, couplings over a coordinate, and
//! tables of magnitudes.

use super::expression::Expression;
use super::jet::Jet;
use super::table_curve::TableCurve;
use toml::{Table, Value};

/// A function of one variable.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Law {
    Speed {
        start: f64,
        speed: f64,
    },
    Sinusoid {
        start: f64,
        amplitude: f64,
        period: f64,
        phase: f64,
    },
    Rise {
        shape: Shape,
        start: f64,
        rise: f64,
        duration: f64,
        delay: f64,
    },
    Curve(TableCurve),
    Expression(Expression),
}

/// The shape of a rise over its relative duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    Polynomial345,
    Polynomial4567,
    Cycloidal,
    /// With the relative duration of a ramp.
    Trapezoidal(f64),
}

/// The units of a law's value, of its variable, and of the phase of a sinusoid, in SI units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LawUnits {
    pub(crate) value: f64,
    pub(crate) variable: f64,
    pub(crate) angle: f64,
}

pub(crate) fn number(value: Option<&Value>) -> Option<f64> {
    match value? {
        Value::Float(x) => Some(*x),
        Value::Integer(n) => Some(*n as f64),
        _ => None,
    }
}

impl Law {
    /// The law of a table of the scene; `start` in SI units is where speeds, sinusoids and rises begin.
    pub(crate) fn read(table: &Table, start: f64, units: LawUnits) -> Option<Self> {
        let factor = units.value;
        if let Some(speed) = number(table.get("speed")) {
            return Some(Self::Speed {
                start,
                speed: speed * factor,
            });
        }
        if let Some(Value::Table(of)) = table.get("sinusoid") {
            return Some(Self::Sinusoid {
                start,
                amplitude: number(of.get("amplitude"))? * factor,
                period: number(of.get("period"))? * units.variable,
                phase: number(of.get("phase")).unwrap_or(0.0) * units.angle,
            });
        }
        if let Some(Value::String(text)) = table.get("expression") {
            return Expression::read(text).map(Self::Expression);
        }
        if table.contains_key("table") {
            let curve = TableCurve::read(table, "spline", [units.variable, factor])?;
            return Some(Self::Curve(curve));
        }
        let shapes = [
            "polynomial345",
            "polynomial4567",
            "cycloidal",
            "trapezoidal",
        ];
        let name = shapes.into_iter().find(|name| table.contains_key(*name))?;
        let of = table.get(name)?.as_table()?;
        let duration = number(of.get("duration"))?;
        let shape = match name {
            "polynomial345" => Shape::Polynomial345,
            "polynomial4567" => Shape::Polynomial4567,
            "cycloidal" => Shape::Cycloidal,
            _ => Shape::Trapezoidal(number(of.get("ramp"))? / duration),
        };
        Some(Self::Rise {
            shape,
            start,
            rise: number(of.get("rise"))? * factor,
            duration: duration * units.variable,
            delay: number(of.get("delay")).unwrap_or(0.0) * units.variable,
        })
    }

    /// The value with its derivatives in time, of a variable with its own.
    pub(crate) fn at(&self, x: Jet, names: &dyn Fn(&str) -> Option<Jet>) -> Option<Jet> {
        let of = Jet::constant;
        Some(match self {
            Self::Speed { start, speed } => of(*start) + of(*speed) * x,
            Self::Sinusoid {
                start,
                amplitude,
                period,
                phase,
            } => {
                let argument = x * of(std::f64::consts::TAU / period) + of(*phase);
                of(*start) + of(*amplitude) * (argument.sin() - of(phase.sin()))
            }
            Self::Rise {
                shape,
                start,
                rise,
                duration,
                delay,
            } => {
                let u = (x - of(*delay)) / of(*duration);
                of(*start) + of(*rise) * shape.at(u)
            }
            Self::Curve(curve) => curve.at(x)?,
            Self::Expression(expression) => {
                expression.at(&|name| if name == "x" { Some(x) } else { names(name) })?
            }
        })
    }

    /// Where a derivative up to the third jumps.
    pub(crate) fn corners(&self) -> Vec<f64> {
        match self {
            Self::Rise {
                shape: Shape::Trapezoidal(ramp),
                duration,
                delay,
                ..
            } => [0.0, *ramp, 1.0 - ramp, 1.0]
                .map(|u| delay + u * duration)
                .to_vec(),
            Self::Rise {
                duration, delay, ..
            } => vec![*delay, delay + duration],
            Self::Curve(curve) => curve.knots(),
            Self::Speed { .. } | Self::Sinusoid { .. } | Self::Expression(_) => Vec::new(),
        }
    }
}

impl Shape {
    /// The relative rise at a relative time.
    fn at(self, u: Jet) -> Jet {
        let of = Jet::constant;
        if u.value() <= 0.0 {
            return of(0.0);
        }
        if u.value() >= 1.0 {
            return of(1.0);
        }
        match self {
            Self::Polynomial345 => {
                let cube = u * u * u;
                cube * (of(10.0) - of(15.0) * u + of(6.0) * u * u)
            }
            Self::Polynomial4567 => {
                let fourth = u * u * u * u;
                fourth * (of(35.0) - of(84.0) * u + of(70.0) * u * u - of(20.0) * u * u * u)
            }
            Self::Cycloidal => {
                let tau = std::f64::consts::TAU;
                u - (u * of(tau)).sin() * of(1.0 / tau)
            }
            // The area under the trapezium of the speed, whose height is 1/(1 − ramp).
            Self::Trapezoidal(ramp) => {
                let height = of(1.0 / (1.0 - ramp));
                let half = of(0.5 / ramp);
                let rest = of(1.0) - u;
                if u.value() < ramp {
                    height * u * u * half
                } else if u.value() > 1.0 - ramp {
                    of(1.0) - height * rest * rest * half
                } else {
                    height * (u - of(0.5 * ramp))
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Norton's peaks of the speed over the mean speed: 15/8, 35/16, 2 and 1/(1 − r), in the middle.
    #[test]
    fn rises_have_the_peaks_of_the_literature() {
        for (shape, peak) in [
            (Shape::Polynomial345, 1.875),
            (Shape::Polynomial4567, 2.1875),
            (Shape::Cycloidal, 2.0),
            (Shape::Trapezoidal(0.2), 1.25),
        ] {
            let middle = shape.at(Jet([0.5, 1.0, 0.0]));
            assert!((middle.value() - 0.5).abs() < 1e-15 && (middle.0[1] - peak).abs() < 1e-14);
            for (u, end) in [(1e-9, 0.0), (1.0 - 1e-9, 1.0)] {
                let near = shape.at(Jet([u, 1.0, 0.0]));
                assert!(
                    (near.value() - end).abs() < 1e-8 && near.0[1].abs() < 1e-7,
                    "{shape:?}"
                );
            }
        }
    }
}
