//! What a study of motions needs: many curves, a path with its velocities, motion in three panels, cost over size, and
//! the forces along a link.

use crate::charts::sampled;
use dwell_report::{
    Axis, Chart, Drawing, Figure, Mark, Paint, Panel, Pen, Scale, Series, Shape, Stroke,
    TextPlacement,
};
use std::f64::consts::TAU;

/// Coupler point of a crank-rocker, m: crank 0.1, coupler 0.25, rocker 0.25, ground 0.2; the point is at the coupler's end.
fn coupler_point(phi: f64) -> [f64; 2] {
    let b = [0.1 * phi.cos(), 0.1 * phi.sin()];
    let (dx, dy) = (0.2 - b[0], -b[1]);
    let d = dx.hypot(dy);
    let h = (0.25_f64.powi(2) - 0.25 * d * d).sqrt();
    let c = [b[0] + 0.5 * dx - h * dy / d, b[1] + 0.5 * dy + h * dx / d];
    [2.0 * c[0] - b[0], 2.0 * c[1] - b[1]]
}

pub(crate) fn ratios() -> Figure {
    let names = [
        "crank", "coupler", "rocker", "slider", "arm", "link 6", "link 7", "link 8",
    ];
    let series = |spread: f64| {
        move |(i, name): (usize, &&str)| {
            let k = i as f64;
            let f = move |d: f64| {
                let a = d.to_radians();
                spread * k + (0.9 - 0.07 * k) * (a * (1.0 + 0.5 * (k % 3.0)) + 0.8 * k).sin()
            };
            let line = Series::line(*name, sampled(720, 0.0, 360.0, f));
            line.stroke(if i < 6 { Stroke::Solid } else { Stroke::Dashed })
        }
    };
    let chart = |title: &str, spread: f64| Chart {
        title: title.to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis::new("velocity ratio", "rad/rad"),
        series: names.iter().enumerate().map(series(spread)).collect(),
        ..Chart::default()
    };
    Figure {
        name: "ratios".to_owned(),
        title: "Eight curves over a turn".to_owned(),
        caption: "Names stand at the ends of the curves.".to_owned(),
        columns: 1,
        panels: vec![
            chart("Bodies that move alike", 0.0).into(),
            chart("Bodies that move apart", 0.7).into(),
        ],
        ..Figure::default()
    }
}

pub(crate) fn path() -> Figure {
    let at = |i: i32, of: i32| coupler_point(TAU * f64::from(i) / f64::from(of));
    let mut shapes = vec![
        Shape::line(
            (0..=720).map(|i| at(i, 720)).collect(),
            Pen::new(Paint::Palette(0), 4.5),
        )
        .named("path of P"),
    ];
    for i in 0..24 {
        let (here, next, before) = (at(i, 24), at(i * 100 + 1, 2400), at(i * 100 - 1, 2400));
        // Metres per radian, drawn at a tenth.
        let scale = 0.1 * 2400.0 / (2.0 * TAU);
        let tip = [0, 1].map(|k| here[k] + scale * (next[k] - before[k]));
        shapes.push(Shape::Arrow {
            from: here,
            to: tip,
            pen: Pen::new(Paint::Palette(1), 2.6),
            name: Some("velocity, 10 mm for 0.1 m/rad".to_owned()),
        });
        shapes.push(Shape::Disc {
            at: here,
            radius_px: 4.5,
            pen: Pen::new(Paint::Ink, 1.0),
            filled: true,
            name: Some("every 15° of the crank".to_owned()),
        });
    }
    shapes.push(Shape::text(at(0, 1), "φ = 0", TextPlacement::Below));
    let drawing = Drawing {
        title: "Path of the coupler point".to_owned(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
        ..Drawing::default()
    };
    Figure {
        name: "path".to_owned(),
        title: "A path with equal scales".to_owned(),
        caption: String::new(),
        columns: 1,
        panels: vec![drawing.into()],
        ..Figure::default()
    }
}

// Long: one picture, written out as data.
pub(crate) fn motion() -> Figure {
    // A slider-crank at constant speed: crank 0.05 m, rod 0.2 m, 10 rad/s.
    let (r, l, w) = (0.05, 0.2, 10.0);
    let position = move |t: f64| {
        let (s, c) = (w * t).sin_cos();
        r * c + (l * l - r * r * s * s).sqrt()
    };
    let speed = move |t: f64| (position(t + 1e-5) - position(t - 1e-5)) / 2e-5;
    let acceleration =
        move |t: f64| (position(t + 1e-4) - 2.0 * position(t) + position(t - 1e-4)) / 1e-8;
    let period = TAU / w;
    let panel = |title: &str, label: &str, unit: &str, f: &dyn Fn(f64) -> f64| Chart {
        title: title.to_owned(),
        x: Axis::new("time t", "s"),
        y: Axis::new(label, unit),
        series: vec![Series::line("", sampled(720, 0.0, period, f))],
        marks: vec![Mark::Vertical {
            at: 0.5 * period,
            label: if title.is_empty() { "" } else { "half a turn" }.to_owned(),
        }],
        ..Chart::default()
    };
    let slider = vec![
        panel("Slider", "x", "m", &position),
        panel("", "ẋ", "m/s", &speed),
        panel("", "ẍ", "m/s²", &acceleration),
    ];
    let angles = |title: &str, label: &str, unit: &str, k: i32| Chart {
        title: title.to_owned(),
        x: Axis::degrees("crank angle φ"),
        y: Axis {
            scale: if k == 0 {
                Scale::Degrees
            } else {
                Scale::Linear
            },
            ..Axis::new(label, unit)
        },
        series: [("rod", 0.25), ("rocker", 0.6)]
            .into_iter()
            .map(|(name, a)| {
                let f = |d: f64| {
                    let s = d.to_radians() + f64::from(k) * 0.25 * TAU;
                    a * (s.sin() + 0.2 * 2.0_f64.powi(k) * (2.0 * s).sin())
                        * if k == 0 { 57.3 } else { 1.0 }
                };
                Series::line(name, sampled(720, 0.0, 360.0, f))
            })
            .collect(),
        ..Chart::default()
    };
    let rods = vec![
        angles("Bodies", "angle", "°", 0),
        angles("", "ratio θ′", "", 1),
        angles("", "θ″", "1/rad", 2),
    ];
    Figure {
        name: "motion".to_owned(),
        title: "Position, speed and acceleration".to_owned(),
        caption: "Panels of a stack share the horizontal axis.".to_owned(),
        columns: 2,
        panels: vec![slider.into(), rods.into()],
        ..Figure::default()
    }
}

pub(crate) fn cost() -> Figure {
    let series = |name: &str, first: f64, order: f64, from: i32| {
        let points = (from..14).map(|i| {
            let n = 2f64.powi(i);
            let wobble = 1.0 + 0.06 * f64::from(i % 3);
            [n, 1e-6 * (0.15 + first * n.powf(order)) * wobble]
        });
        Series::line(name, points.collect()).stroke(Stroke::LineAndPoints)
    };
    let chart = Chart {
        title: "Time of one evaluation".to_owned(),
        x: Axis::log("loops N", ""),
        y: Axis::log("time", "s"),
        series: vec![
            series("plan", 0.08, 1.0, 0),
            series("banded", 0.5, 1.0, 0),
            series("dense", 0.02, 2.9, 0),
        ],
        marks: vec![Mark::Slope {
            order: 1.0,
            through: [1000.0, 3e-5],
            label: "in proportion to N".to_owned(),
        }],
        ..Chart::default()
    };
    Figure {
        name: "cost-of-size".to_owned(),
        title: "Cost over the size of the mechanism".to_owned(),
        caption: "Lines that run parallel to the dashed one are linear.".to_owned(),
        columns: 1,
        panels: vec![chart.into()],
        ..Figure::default()
    }
}

pub(crate) fn profile() -> Figure {
    // A bar on two pins under its own inertia (uniform load) and a force at 0.3 m of 0.5 m.
    let (length, load, at, force) = (0.5, 120.0, 0.3, 40.0);
    let first = 0.5 * load * length + force * (length - at) / length;
    let shear = |s: f64, beyond: bool| first - load * s - if beyond { force } else { 0.0 };
    let moment = |s: f64| first * s - 0.5 * load * s * s - force * (s - at).max(0.0);
    let zero_shear = (first - force) / load;
    let peak = if zero_shear > at { zero_shear } else { at };
    let chart = |title: &str, label: &str, unit: &str, color: usize, points: Vec<[f64; 2]>| Chart {
        title: title.to_owned(),
        x: Axis::new("place s along the coupler, from B to C", "m"),
        y: Axis::new(label, unit),
        series: vec![
            Series::line("", points)
                .stroke(Stroke::Filled)
                .color(Paint::Palette(color)),
        ],
        ..Chart::default()
    };
    let axial = vec![[0.0, -85.0], [at, -62.0], [at, -20.0], [length, -8.0]];
    let jump = vec![
        [0.0, shear(0.0, false)],
        [at, shear(at, false)],
        [at, shear(at, true)],
        [length, shear(length, true)],
    ];
    let mut bending = chart("", "moment M", "N m", 2, sampled(200, 0.0, length, moment));
    bending.marks = vec![Mark::Point {
        at: [peak, moment(peak)],
        label: format!("{:.2} N m at {peak:.2} m", moment(peak)),
    }];
    let stack: Panel = vec![
        chart("Coupler BC at φ = 78°", "axial N", "N", 0, axial),
        chart("", "shear V", "N", 1, jump),
        bending,
    ]
    .into();
    Figure {
        name: "profile".to_owned(),
        title: "Forces along a link".to_owned(),
        caption: "N: tension is positive. V and M: the action of the part beyond s on the part before it."
            .to_owned(),
        columns: 1,
        panels: vec![stack],
..Figure::default()
}
}
