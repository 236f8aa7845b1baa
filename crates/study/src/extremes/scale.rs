//! Scales: masses, lengths, and the place where a mechanism stands.

use super::grid::{Reading, Row, Stated, decades, refused};
use super::limit::{REDUCED, ROUNDINGS, judged};
use super::shapes::{CRANK_ROCKER, FourBar};
use super::truth::wide;
use crate::estimate;
use dwell_geometry::vec2;
use dwell_kinetostatics::Coefficients;

/// A crank angle in no special place, rad.
const HERE: f64 = 1.125;
/// Condition of a well-shaped dyad's accelerations: the sines of its angles there are about a half, and they
/// enter three times.
const WELL_SHAPED: f64 = 8.0;

/// Page of these rows, and its title.
const FAMILY: (&str, &str) = ("scales", "Masses, lengths and places");

pub(super) fn rows() -> Vec<Row> {
    vec![mass_ratio(), lengths(), powers_of_two(), placement()]
}

fn stated(_: f64, _: usize) -> Stated {
    Stated::rounding(ROUNDINGS, WELL_SHAPED)
}

/// A row that evaluates a four-bar for each value.
fn row(key: &str, what: &str, values: Vec<f64>, make: fn(f64) -> FourBar) -> Row {
    Row {
        family: FAMILY,
        key: key.into(),
        what: what.into(),
        parameter: ("", ""),
        values,
        quantities: &REDUCED,
        truth: "circle and circle in 32 digits",
        why: "",
        stated: Box::new(stated),
        run: Box::new(move |at| {
            let bars = make(at);
            let shape = bars.shape();
            match shape.exact(&shape.reactions("C")) {
                Ok(model) => judged(&bars, &model, 1.0, HERE),
                Err(error) => refused(&error, REDUCED.len()),
            }
        }),
    }
}

fn mass_ratio() -> Row {
    let make = |ratio: f64| {
        let mut bars = CRANK_ROCKER;
        bars.masses[1].mass *= ratio;
        bars.masses[1].inertia *= ratio;
        bars
    };
    Row {
        parameter: ("mass of the coupler, in parts of that at first", ""),
        why: "the parameters are sums over the bodies, each of which a well-shaped dyad magnifies by 8; 16 roundings",
        ..row(
            "mass-ratio",
            "Four-bar: the coupler's mass and inertia",
            decades(-12, 12),
            make,
        )
    }
}

fn lengths() -> Row {
    Row {
        parameter: ("crank's length", "m"),
        why: "nothing but the unit of length changes; a dyad's 8, 16 roundings",
        ..row("length", "Four-bar: all lengths", decades(-9, 9), |by| {
            CRANK_ROCKER.scaled(by)
        })
    }
}

fn placement() -> Row {
    let make = |far: f64| {
        let mut bars = CRANK_ROCKER;
        let place = vec2(far, -0.75 * far);
        bars.base = bars.base.map(|p| p + place);
        bars
    };
    Row {
        parameter: ("distance from the origin", "crank lengths"),
        why: "attachments on the ground are subtracted before anything is evaluated: as if it stood at the origin; \
              a dyad's 8, 16 roundings",
        truth: "circle and circle in 32 digits, at the same plain coordinates of the ground's points",
        ..row(
            "placement",
            "Four-bar: where it stands",
            decades(0, 9),
            make,
        )
    }
}

/// Lengths scaled by a power of two change the exponents of all numbers and no other bit.
fn powers_of_two() -> Row {
    fn at(by: f64) -> Result<Coefficients, String> {
        let shape = CRANK_ROCKER.scaled(by).shape();
        let model = shape.exact(&shape.reactions("C"))?;
        let got = estimate::reduced(model.model(), HERE);
        got.map(|(got, _)| got).map_err(|e| e.to_string())
    }
    Row {
        family: FAMILY,
        key: "power-of-two".into(),
        what: "Four-bar: all lengths times a power of two".into(),
        parameter: ("crank's length", "m"),
        values: (-10..=10).map(|k| 8.0_f64.powi(k)).collect(),
        quantities: &REDUCED,
        truth: "the same bits as at 1 m, with another exponent",
        why: "a power of two is exact in every sum, product and root: not one last place may differ",
        // Half a last place of a number of 53 bits, which stands for no difference.
        stated: Box::new(|_, _| Stated::error(0.5 * f64::EPSILON * (1.0 + 1e-6), 1.0)),
        run: Box::new(move |by| {
            let both = at(by).and_then(|got| Ok((got, at(1.0)?)));
            let (got, base) = match both {
                Ok(both) => both,
                Err(error) => return refused(&error, REDUCED.len()),
            };
            // What may differ is the last place.
            let reading = |got: f64, base: f64, power: i32| {
                let truth = wide(base * by.powi(power));
                Ok(Reading::new(got, truth, f64::EPSILON * got.abs()))
            };
            vec![
                reading(got.m, base.m, 2),
                reading(got.half_dm, base.half_dm, 2),
                reading(got.a[0], base.a[0], 1),
                reading(got.b[0], base.b[0], 1),
            ]
        }),
    }
}
