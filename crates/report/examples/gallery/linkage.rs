//! Drawings: a dwell mechanism in ghosted positions, a slider–crank with its guide and load.

use dwell_report::{Animation, Axis, Drawing, Figure, Paint, Pen, Shape, TextPlacement};
use std::f64::consts::{PI, TAU};

/// A Hoeken linkage whose point P drives a rocker with a dwell.
struct Pose {
    b: [f64; 2],
    c: [f64; 2],
    p: [f64; 2],
    rocker_end: [f64; 2],
}

const A: [f64; 2] = [0.0, 0.0];
const O: [f64; 2] = [0.2, 0.0];
const Q: [f64; 2] = [-0.2, 0.4];

fn pose(phi: f64) -> Pose {
    let b = [0.1 * phi.cos(), 0.1 * phi.sin()];
    let (dx, dy) = (O[0] - b[0], O[1] - b[1]);
    let d = dx.hypot(dy);
    let h = (0.25_f64.powi(2) - 0.25 * d * d).sqrt();
    let c = [b[0] + 0.5 * dx - h * dy / d, b[1] + 0.5 * dy + h * dx / d];
    let p = [2.0 * c[0] - b[0], 2.0 * c[1] - b[1]];
    let (ex, ey) = (p[0] - Q[0], p[1] - Q[1]);
    let e = ex.hypot(ey);
    Pose {
        b,
        c,
        p,
        rocker_end: [Q[0] + 0.7 * ex / e, Q[1] + 0.7 * ey / e],
    }
}

pub(crate) fn block(at: [f64; 2], angle: f64, half: [f64; 2]) -> Vec<[f64; 2]> {
    let (s, c) = angle.sin_cos();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    corners
        .map(|[u, v]| [u * half[0], v * half[1]])
        .map(|[u, v]| [at[0] + c * u - s * v, at[1] + s * u + c * v])
        .to_vec()
}

// Long: one picture, written out as data.
pub(crate) fn linkage() -> Figure {
    let path = |from: f64, to: f64| {
        (0..=720)
            .map(move |i| pose(from + (to - from) * f64::from(i) / 720.0).p)
            .collect()
    };
    let mut shapes = vec![
        Shape::line(path(0.0, TAU), Pen::new(Paint::Grey, 3.0).dashed()).named("path of P"),
        Shape::line(
            path(0.62 * PI, 1.38 * PI),
            Pen::new(Paint::Palette(4), 26.0).lightness(0.45),
        )
        .named("dwell"),
    ];
    for (i, lightness) in [0.82, 0.74, 0.66, 0.58, 0.0].into_iter().enumerate() {
        let Pose {
            b,
            c,
            p,
            rocker_end: end,
        } = pose(2.0 + 1.2 * (4 - i) as f64);
        let link = |points: Vec<[f64; 2]>, color: usize, name: &str| {
            let line = Shape::line(
                points,
                Pen::new(Paint::Palette(color), 9.0).lightness(lightness),
            );
            if lightness == 0.0 {
                line.named(name)
            } else {
                line
            }
        };
        shapes.push(link(vec![Q, end], 2, "rocker QP"));
        shapes.push(link(vec![O, c], 1, "rocker OC"));
        shapes.push(link(vec![b, p], 0, "coupler BCP"));
        shapes.push(link(vec![A, b], 3, "crank AB"));
        let angle = (end[1] - Q[1]).atan2(end[0] - Q[0]);
        let slider = Pen::new(Paint::Ink, 2.5).lightness(lightness);
        shapes.push(Shape::area(block(p, angle, [0.03, 0.015]), slider, 0.15));
        shapes.extend([b, c, p].map(|at| Shape::pin(at, Paint::Ink, lightness)));
        if lightness == 0.0 {
            shapes.push(Shape::text(b, "B", TextPlacement::BelowLeft));
            shapes.push(Shape::text(c, "C", TextPlacement::AboveLeft));
            shapes.push(Shape::text(p, "P", TextPlacement::Above));
        }
    }
    shapes.extend([A, O, Q].map(|at| Shape::GroundPin { at }));
    for (at, name, side) in [
        (A, "A", TextPlacement::Left),
        (O, "O", TextPlacement::Right),
        (Q, "Q", TextPlacement::Left),
    ] {
        shapes.push(Shape::text(at, name, side));
    }
    let drawing = Drawing {
        title: "Linkage".to_owned(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
        ..Drawing::default()
    };
    let slide = Drawing {
        title: "Slider–crank with loads".to_owned(),
        x: Axis::new("x", "mm"),
        y: Axis::new("y", "mm"),
        shapes: vec![
            Shape::GroundLine {
                from: [180.0, -15.0],
                to: [420.0, -15.0],
            },
            Shape::GroundLine {
                from: [420.0, 15.0],
                to: [180.0, 15.0],
            },
            Shape::line(
                vec![[0.0, 0.0], [60.0, 80.0]],
                Pen::new(Paint::Palette(0), 10.0),
            )
            .named("crank"),
            Shape::line(
                vec![[60.0, 80.0], [300.0, 0.0]],
                Pen::new(Paint::Palette(1), 10.0),
            )
            .named("coupler"),
            Shape::area(
                block([300.0, 0.0], 0.0, [28.0, 14.0]),
                Pen::new(Paint::Ink, 3.0),
                0.15,
            ),
            Shape::GroundPin { at: [0.0, 0.0] },
            Shape::pin([60.0, 80.0], Paint::Ink, 0.0),
            Shape::pin([300.0, 0.0], Paint::Ink, 0.0),
            Shape::Arrow {
                from: [400.0, 0.0],
                to: [332.0, 0.0],
                pen: Pen::new(Paint::Palette(1), 5.0),
                name: Some("force".to_owned()),
            },
            Shape::text([60.0, 80.0], "B", TextPlacement::Above),
            Shape::text([0.0, 0.0], "A", TextPlacement::AboveLeft),
        ],
        ..Drawing::default()
    };
    Figure {
        name: "linkage".to_owned(),
        title: "Single-dwell mechanism in five positions".to_owned(),
        caption: "Reconstruction with Hoeken proportions. The bold position is φ = 115°, the ghosts follow in steps of 69°. \
                  The highlighted part of the path is the near-straight one, which holds the rocker QP."
            .to_owned(),
        columns: 2,
        panels: vec![drawing.into(), slide.into()],
..Figure::default()
}
}

/// The dwell mechanism over a turn.
pub(crate) fn animation() -> Animation {
    const FRAMES: i32 = 60;
    let path: Vec<[f64; 2]> = (0..=720)
        .map(|i| pose(TAU * f64::from(i) / 720.0).p)
        .collect();
    let frame = |i: i32| {
        let phi = TAU * f64::from(i) / f64::from(FRAMES);
        let Pose {
            b,
            c,
            p,
            rocker_end: end,
        } = pose(phi);
        let bar = |points: Vec<[f64; 2]>, color: usize, name: &str| {
            Shape::line(points, Pen::new(Paint::Palette(color), 9.0)).named(name)
        };
        let angle = (end[1] - Q[1]).atan2(end[0] - Q[0]);
        let mut shapes = vec![
            Shape::line(path.clone(), Pen::new(Paint::Grey, 3.0).dashed()).named("path of P"),
            bar(vec![Q, end], 2, "rocker QP"),
            bar(vec![O, c], 1, "rocker OC"),
            bar(vec![b, p], 0, "coupler BCP"),
            bar(vec![A, b], 3, "crank AB"),
            Shape::area(
                block(p, angle, [0.03, 0.015]),
                Pen::new(Paint::Ink, 2.5),
                0.15,
            ),
        ];
        shapes.extend([b, c, p].map(|at| Shape::pin(at, Paint::Ink, 0.0)));
        shapes.extend([A, O, Q].map(|at| Shape::GroundPin { at }));
        Drawing {
            title: format!("Crank angle φ = {:.0}°", phi.to_degrees()),
            x: Axis::new("x", "m"),
            y: Axis::new("y", "m"),
            shapes,
            ..Drawing::default()
        }
    };
    Animation {
        name: "film".to_owned(),
        frames: (0..FRAMES).map(frame).collect(),
        delay_ms: 50,
        width_px: 480,
        provenance: "Dwell 0.1.0 · gallery · sampled at 60 positions".to_owned(),
    }
}
