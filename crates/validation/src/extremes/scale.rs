//! Extreme scales: masses, lengths, and the distance of a mechanism from the origin.

use super::closed_forms::dd;
use super::forms::{Form, FormModel};
use super::limit_positions::{QUANTITIES, compare_four_bar};
use super::mechanisms::{CRANK_ROCKER, FourBar};
use super::series::{
    ALLOWED_ROUNDINGS, DYAD_CONDITION, ParameterSeries, Requirement, cell, decades,
};
use dwell_geometry::vec2;
use dwell_kinetostatics::Coefficients;

/// A generic crank angle, rad.
const CRANK_ANGLE: f64 = 1.125;

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = ("scales", "Masses, lengths and places");

pub(super) fn series(form: Form) -> Vec<ParameterSeries> {
    vec![
        mass_ratio(form),
        lengths(form),
        powers_of_two(form),
        placement(form),
    ]
}

fn required(_: f64, _: usize) -> Requirement {
    Requirement::from_rounding(ALLOWED_ROUNDINGS, DYAD_CONDITION)
}

/// A row that evaluates a four-bar for each value.
fn base_series(
    form: Form,
    key: &str,
    what: &str,
    values: Vec<f64>,
    of: fn(f64) -> FourBar,
) -> ParameterSeries {
    ParameterSeries {
        figure: FIGURE,
        key: key.into(),
        description: what.into(),
        parameter: ("", ""),
        values,
        quantities: &QUANTITIES,
        reference: "circle and circle in 32 digits",
        reason: "",
        requirement: Box::new(required),
        run: Box::new(move |at| {
            let four_bar = of(at);
            let model = FormModel::of(form, &four_bar.text(), "C", None)?;
            compare_four_bar(&four_bar, &model, CRANK_ANGLE)
        }),
    }
}

fn mass_ratio(form: Form) -> ParameterSeries {
    let make = |ratio: f64| {
        let mut four_bar = CRANK_ROCKER;
        four_bar.masses[1].mass *= ratio;
        four_bar.masses[1].inertia *= ratio;
        four_bar
    };
    let what = "Four-bar: the coupler's mass and inertia";
    ParameterSeries {
        parameter: ("mass of the coupler over its initial mass", ""),
        reason: "the parameters are sums over the bodies, each of which a well-shaped dyad magnifies by 8; 16 roundings",
        ..base_series(form, "mass-ratio", what, decades(-12, 12), make)
    }
}

fn lengths(form: Form) -> ParameterSeries {
    ParameterSeries {
        parameter: ("crank's length", "m"),
        reason: "nothing but the unit of length changes; a dyad's 8, 16 roundings",
        ..base_series(
            form,
            "length",
            "Four-bar: all lengths",
            decades(-9, 9),
            |by| CRANK_ROCKER.scaled(by),
        )
    }
}

fn placement(form: Form) -> ParameterSeries {
    let make = |distance: f64| {
        let mut four_bar = CRANK_ROCKER;
        let offset = vec2(distance, -0.75 * distance);
        four_bar.base = four_bar.base.map(|p| p + offset);
        four_bar
    };
    ParameterSeries {
        parameter: ("distance from the origin", "crank lengths"),
        reason: "attachments on the ground are subtracted before anything is evaluated: as if it were at the origin; \
              a dyad's 8, 16 roundings",
        reference: "circle and circle in 32 digits, at the same double-precision coordinates of the ground's points",
        ..base_series(
            form,
            "placement",
            "Four-bar: its position",
            decades(0, 9),
            make,
        )
    }
}

/// Lengths scaled by a power of two change the exponents of all numbers and no other bit.
fn powers_of_two(form: Form) -> ParameterSeries {
    type Reduced = Result<Coefficients, Box<dyn std::error::Error>>;
    let reduced_at_scale = move |by: f64| -> Reduced {
        let model = FormModel::of(form, &CRANK_ROCKER.scaled(by).text(), "C", None)?;
        Ok(model.coefficients_with_errors(CRANK_ANGLE)?.0)
    };
    ParameterSeries {
        parameter: ("crank's length", "m"),
        reference: "the same bits as at 1 m, with another exponent",
        reason: "a power of two is exact in every sum, product and root: not one last place may differ",
        // Half a unit in the last place of 53 bits, which represents no difference.
        requirement: Box::new(|_, _| {
            Requirement::from_error(0.5 * f64::EPSILON * (1.0 + 1e-6), 1.0)
        }),
        run: Box::new(move |by| {
            let (got, base) = (reduced_at_scale(by)?, reduced_at_scale(1.0)?);
            // Only the last place may differ.
            let compared = |got: f64, base: f64, power: i32| {
                cell((got, f64::EPSILON * got.abs()), dd(base * by.powi(power)))
            };
            Ok(vec![
                compared(got.m, base.m, 2),
                compared(got.half_dm, base.half_dm, 2),
                compared(got.a[0], base.a[0], 1),
                compared(got.b[0], base.b[0], 1),
            ])
        }),
        ..base_series(
            form,
            "power-of-two",
            "Four-bar: all lengths times a power of two",
            (-10..=10).map(|k| 8.0_f64.powi(k)).collect(),
            |by| CRANK_ROCKER.scaled(by),
        )
    }
}
