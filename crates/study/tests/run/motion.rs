//! Positions, speeds and accelerations.

use crate::table::{Table, WEIGHTS, case, derivative_error, largest, scene, table};
use dwell_study::Analysis;
use std::f64::consts::TAU;

/// Every column with the one that is its derivative by time.
fn derivatives(table: &Table) -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    for name in &table.names {
        let others = if let Some(stem) = name.strip_suffix(".angle") {
            vec![format!("{stem}.angular_velocity")]
        } else if let Some(stem) = name.strip_suffix(".angular_velocity") {
            vec![format!("{stem}.angular_acceleration")]
        } else if let Some(stem) = name.strip_suffix(".velocity") {
            vec![format!("{stem}.acceleration")]
        } else if let Some((stem, part)) = name.rsplit_once('.') {
            match part {
                "x" | "y" => vec![format!("{stem}.v{part}")],
                "vx" | "vy" => vec![format!("{stem}.{}", part.replace('v', "a"))],
                _ => vec![format!("{name}.velocity")],
            }
        } else {
            vec![format!("{name}.velocity")]
        };
        pairs.extend(
            others
                .into_iter()
                .filter(|o| table.has(o))
                .map(|o| (name.clone(), o)),
        );
    }
    pairs
}

/// Scenes of every kind of joint and drive, whose motion is smooth.
#[test]
fn speeds_and_accelerations_are_derivatives_by_time() {
    let cases = [
        "cam",
        "ellipse-trammel",
        "five-bar",
        "four-bar",
        "jansen",
        "rolling-wheel",
        "scotch-yoke",
        "slider-crank",
        "stephenson-six-bar",
        "watt-six-bar",
        "whitworth",
    ];
    for name in cases {
        let mut scene = case(name);
        scene.requests.variables = None;
        let table = table(&scene, Analysis::Kinematics, 4001);
        let t = table.column("t");
        let step = t[1] - t[0];
        let pairs = derivatives(&table);
        assert!(pairs.len() >= 6, "{name}: {pairs:?}");
        for (of, by_time) in pairs {
            let (values, derivative) = (table.column(&of), table.column(&by_time));
            let difference = derivative_error(&values, &derivative, step);
            // Rounding of the values over a step. In ten revolutions of 400 positions each, harmonics up
            // to the tenth: (2π·10/400)⁸/630 = 6e-10 of the largest.
            let allowed = 1e-9 * largest(&derivative) + 5e-15 * (1.0 + largest(&values)) / step;
            assert!(
                difference <= allowed,
                "{name}: {by_time} is off by {difference:e}, allowed {allowed:e}"
            );
        }
    }
}

/// Ten revolutions in eleven positions: only the velocities show how often the bodies rotated in between.
#[test]
fn whole_turns_are_counted_between_far_positions() {
    let scene = case("slider-crank");
    for command in [Analysis::Kinematics, Analysis::Statics] {
        let table = table(&scene, command, 12);
        let (angle, phi) = (table.column("crank.angle"), table.column("phi"));
        assert!(angle.last().unwrap() - angle[0] > 9.0 * TAU);
        for (angle, phi) in angle.iter().zip(phi) {
            // A sum of ten revolutions.
            assert!((angle - phi).abs() < 1e-12, "{angle} {phi}");
        }
    }
}

#[test]
fn the_velocity_ratio_is_what_the_speeds_have() {
    let table = table(&scene(WEIGHTS), Analysis::Kinematics, 50);
    let phi = table.column("phi.velocity");
    for body in ["crank", "coupler", "rocker"] {
        let ratio = table.column(&format!("{body}.velocity_ratio"));
        let speed = table.column(&format!("{body}.angular_velocity"));
        for ((ratio, speed), phi) in ratio.iter().zip(&speed).zip(&phi) {
            // One product; the speeds are a few rad/s.
            assert!((ratio * phi - speed).abs() < 1e-13);
        }
    }
}

/// By the law of cosines in the triangle of the coupler, the rocker and the distance from B to D.
#[test]
fn the_transmission_angle_closes_a_triangle() {
    let table = table(&scene(WEIGHTS), Analysis::Kinematics, 100);
    let [x, y, angle] =
        ["coupler.B.x", "coupler.B.y", "C.transmission_angle"].map(|name| table.column(name));
    for i in 0..angle.len() {
        let square = (x[i] - 0.5).powi(2) + (y[i] + 0.2).powi(2);
        let expected = (0.35_f64.powi(2) + 0.3_f64.powi(2) - square) / (2.0 * 0.35 * 0.3);
        // Squares of lengths below half a metre, over twice a tenth.
        assert!((angle[i].cos() - expected).abs() < 1e-14);
    }
    // Of a slider-crank: the rod's angle from the normal of the slide, which lies along x.
    let table = crate::table::table(&case("slider-crank"), Analysis::Kinematics, 50);
    let both = table
        .column("C.transmission_angle")
        .into_iter()
        .zip(table.column("rod.angle"));
    for (transmission, rod) in both {
        // The sine of the one is the cosine of the other, whichever normal was taken.
        assert!((transmission.sin() - rod.cos().abs()).abs() < 1e-14);
    }
}

/// The angle of a body is that of the coordinate that drives it, with its whole revolutions.
#[test]
fn a_driven_body_counts_as_its_coordinate_does() {
    let mut scene = case("rolling-wheel");
    scene.requests.variables = None;
    let table = table(&scene, Analysis::Kinetostatics, 7);
    let (phi, wheel) = (table.column("phi"), table.column("wheel.angle"));
    assert!(phi[0] == -6.0 && phi == wheel, "{phi:?} {wheel:?}");
}
