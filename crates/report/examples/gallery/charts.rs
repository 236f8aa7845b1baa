//! Charts: curves over a revolution, work and precision, time with two axes, errors over a step.

use dwell_report::{Axis, Chart, Figure, Mark, Panel, Scale, Series, Stroke};

pub(crate) fn sampled(n: u32, from: f64, to: f64, f: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    (0..=n)
        .map(|i| from + (to - from) * f64::from(i) / f64::from(n))
        .map(|x| [x, f(x)])
        .collect()
}

fn inertia(deg: f64) -> f64 {
    let phi = deg.to_radians();
    0.626 + 0.11 * (1.0 - (phi - 0.3).cos()).powi(3) / 8.0 + 0.02 * (2.0 * phi).sin()
}

fn inertia_rate(deg: f64) -> f64 {
    0.5 * (inertia(deg + 1e-3) - inertia(deg - 1e-3)) / 2e-3_f64.to_radians()
}

// Long: one picture, written out as data.
pub(crate) fn curves() -> Figure {
    let reaction = |k: f64, d: f64| {
        40.0 * k * inertia_rate(d * k) + 3.0 * k + 4.0 * (d.to_radians() * k).cos()
    };
    let m = Chart {
        title: "Generalised inertia".to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis::new("m", "kg m²"),
        series: vec![
            Series::line("reduced model", sampled(2000, 0.0, 360.0, inertia)),
            Series::line("2E at φ̇ = 1", sampled(24, 0.0, 360.0, inertia)).stroke(Stroke::Points),
        ],
        marks: vec![Mark::Band {
            from: 112.0,
            to: 248.0,
            label: "dwell".to_owned(),
        }],
        ..Chart::default()
    };
    let rate = Chart {
        title: "Half its derivative".to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis::new("½ m′", "kg m²/rad"),
        series: vec![Series::line("", sampled(2000, 0.0, 360.0, inertia_rate))],
        marks: vec![
            Mark::Horizontal {
                at: 0.0,
                label: String::new(),
            },
            Mark::Point {
                at: [130.0, inertia_rate(130.0)],
                label: "worst place".to_owned(),
            },
        ],
        ..Chart::default()
    };
    let three = ["x", "y", "slide"].into_iter().zip([1.0, 2.0, 3.0]);
    let three =
        three.map(|(name, k)| Series::line(name, sampled(2000, 0.0, 360.0, |d| reaction(k, d))));
    let reactions = Chart {
        title: "Reactions".to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis::new("reaction", "N"),
        series: three.collect(),
        ..Chart::default()
    };
    let busy = (0..5).map(|i| {
        let k = f64::from(i) + 1.0;
        Series::line(
            format!("joint {i}, normal"),
            sampled(2000, 0.0, 360.0, |d| {
                (d.to_radians() * k).sin() * 1e-5 * (6.0 - k)
            }),
        )
        .stroke(if i % 2 == 0 {
            Stroke::Solid
        } else {
            Stroke::Dashed
        })
    });
    let coefficients = Chart {
        title: "Coefficients that fill the panel".to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis::new("coefficient a", "N s²"),
        series: busy.collect(),
        ..Chart::default()
    };
    Figure {
        name: "curves".to_owned(),
        title: "Reduced model over a revolution".to_owned(),
        caption: "Lines: reduced model. Points: kinetic energy at unit speed.".to_owned(),
        columns: 2,
        panels: vec![m.into(), rate.into(), reactions.into(), coefficients.into()],
        ..Figure::default()
    }
}

pub(crate) fn precision() -> Figure {
    let series = |name: &str, k: f64, order: f64| {
        let point = |i: i32| {
            let steps = 40.0 * 2f64.powf(f64::from(i) * 0.75) * k;
            [
                steps,
                (3.0 * (steps / (20.0 * k)).powf(-order))
                    .max(3e-15 * (1.0 + 0.3 * f64::from(i % 3))),
            ]
        };
        Series::line(name, (0..12).map(point).collect()).stroke(Stroke::LineAndPoints)
    };
    let chart = Chart {
        title: "Error of the period".to_owned(),
        x: Axis::log("evaluations of the reduced model per revolution", ""),
        y: Axis::log("relative error of T", ""),
        series: vec![
            series("Tsit45", 1.0, 5.0),
            series("BDF", 1.6, 3.4),
            series("ESDIRK34", 5.0, 4.0),
            series("TR-BDF2", 2.5, 2.0),
        ],
        marks: vec![
            Mark::Slope {
                order: -4.0,
                through: [1000.0, 3e-8],
                label: "order 4".to_owned(),
            },
            Mark::Horizontal {
                at: 2.2e-16,
                label: "rounding".to_owned(),
            },
        ],
        ..Chart::default()
    };
    Figure {
        name: "precision".to_owned(),
        title: "Work and precision of the integrators".to_owned(),
        caption: "Each marker is one tolerance from 10⁻³ to 10⁻¹³.".to_owned(),
        columns: 1,
        panels: vec![chart.into()],
        ..Figure::default()
    }
}

// Long: one picture, written out as data.
pub(crate) fn time() -> Figure {
    let chart = Chart {
        title: "Motion".to_owned(),
        x: Axis::new("time t", "s"),
        y: Axis {
            scale: Scale::Degrees,
            ..Axis::new("crank angle φ", "°")
        },
        y2: Some(Axis::new("crank speed φ̇", "rad/s")),
        series: vec![
            Series::line(
                "angle",
                sampled(2000, 0.0, 10.84, |t| 66.4 * t + 9.0 * (1.16 * t).sin()),
            ),
            Series::line(
                "speed",
                sampled(2000, 0.0, 10.84, |t| {
                    1.16 + 0.157 * (1.16 * t).cos() + 0.03 * (2.3 * t).sin()
                }),
            )
            .right(),
        ],
        marks: vec![Mark::Vertical {
            at: 5.42,
            label: "T = 5.42 s".to_owned(),
        }],
    };
    let energy = Chart {
        title: "Energy".to_owned(),
        x: Axis::new("time t", "s"),
        y: Axis::new("E", "J"),
        series: vec![Series::line(
            "",
            sampled(2000, 0.0, 10.84, |t| {
                0.313 + 2e-9 * t + 1e-9 * (9.0 * t).sin()
            }),
        )],
        ..Chart::default()
    };
    let drift = Chart {
        title: "Energy error".to_owned(),
        x: Axis::new("time t", "s"),
        y: Axis::log("|E − E₀| / E₀", ""),
        series: vec![
            Series::line(
                "BDF",
                sampled(2000, 0.0, 10.84, |t| 1e-9 * t * (2.0 + (5.0 * t).sin())),
            ),
            Series::line(
                "Tsit45",
                sampled(2000, 0.0, 10.84, |t| 3e-12 * t * (1.2 + (7.0 * t).cos())),
            ),
        ],
        ..Chart::default()
    };
    Figure {
        name: "time".to_owned(),
        title: "Free motion over two periods".to_owned(),
        caption: String::new(),
        columns: 2,
        panels: vec![chart.into(), energy.into(), drift.into()],
        ..Figure::default()
    }
}

// Long: one picture, written out as data.
pub(crate) fn errors() -> Figure {
    let shape = |name: &str, order: f64, scale: f64| {
        let error =
            |h: f64| scale * h.powf(order) + 1.1e-16 / h * (1.0 + 0.5 * (40.0 * h.ln()).sin());
        let points = (0..=80)
            .map(|i| 10f64.powf(-9.0 + 0.1 * f64::from(i)))
            .map(|h| [h, error(h)])
            .collect();
        Series::line(name, points)
    };
    let chart = |title: &str, stroke: Stroke| Chart {
        title: title.to_owned(),
        x: Axis::log("step h", "rad"),
        y: Axis::log("|difference| / largest |½ m′|", ""),
        series: vec![
            shape("central", 2.0, 0.3).stroke(stroke),
            shape("Richardson, once", 4.0, 0.05).stroke(stroke),
            shape("Richardson, twice", 6.0, 0.01).stroke(stroke),
        ],
        marks: vec![Mark::Horizontal {
            at: 1e-11,
            label: "tolerance".to_owned(),
        }],
        ..Chart::default()
    };
    let empty = Chart {
        title: "A check that could not be made".to_owned(),
        x: Axis::log("step h", "rad"),
        y: Axis::log("|difference|", ""),
        series: vec![Series::line("central", vec![[1.0, 0.0], [f64::NAN, 1.0]])],
        ..Chart::default()
    };
    let exact = Chart {
        title: "One of two exact".to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis::log("|difference|", "N m"),
        series: vec![
            Series::line(
                "driven",
                sampled(2000, 0.0, 360.0, |d| 1e-15 * (1.0 + (d * 7.3).sin()).abs()),
            ),
            Series::line("balance", sampled(2000, 0.0, 360.0, |_| 0.0)),
        ],
        ..Chart::default()
    };
    let panels: Vec<Panel> = vec![
        chart("½ m′ by differences", Stroke::Solid).into(),
        chart("The same with markers", Stroke::LineAndPoints).into(),
        empty.into(),
        exact.into(),
    ];
    Figure {
        name: "errors".to_owned(),
        title: "Difference quotients against the unit run".to_owned(),
        caption: "Truncation falls with the step on the right branch, rounding grows on the left one: the V has its foot where \
                  both are equal.\nA second paragraph says what is judged: the least error over all steps."
            .to_owned(),
        columns: 2,
        panels,
..Figure::default()
}
}
