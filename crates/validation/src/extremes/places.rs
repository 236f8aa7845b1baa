//! Positions in space: an RSSR linkage far from the origin, in double and in single precision.

use super::series::{
    ALLOWED_ROUNDINGS, DYAD_CONDITION, ParameterSeries, Requirement, RunResult, cell, decades,
};
use dwell_geometry::JointId;
use dwell_kinetostatics::Coefficients;
use dwell_kinetostatics::space::{Axes, Component, Model, Reaction};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::SpaceScene;
use dwell_study::estimate;

/// A generic crank angle, rad.
const CRANK_ANGLE: f64 = 1.125;
/// The quantities, in the order of the results.
const QUANTITIES: [&str; 4] = ["m", "½m′", "a of C.x", "b of C.x"];

pub(super) fn series() -> Vec<ParameterSeries> {
    vec![
        places::<f64>("place-in-space", "RSSR: its position"),
        places::<f32>(
            "place-in-space-single",
            "RSSR in single precision: its position",
        ),
    ]
}

/// The linkage at a distance from the origin. Its points are exact at every distance, so the mechanism is unchanged.
fn rssr(distance: f64) -> Result<Model, String> {
    let at = |offset: [f64; 3]| {
        let place = [1.0, 2.0, -1.0].map(|part| part * distance);
        [0, 1, 2].map(|k| place[k] + offset[k])
    };
    let (a, d) = (at([0.0; 3]), at([2.5, 0.625, -0.375]));
    let text = format!(
        "[bodies.ground]\npoints = {{ A = {a:?}, D = {d:?} }}\n\
         [bodies.crank]\npoints = {{ A = [0, 0, 0], B = [1, 0, 0] }}\n\
         mass = 0.75\ncenter = [0.375, 0.125, 0.0625]\ninertia = [0.0625, 0.125, 0.15625]\n\
         [bodies.coupler]\npoints = {{ B = [0, 0, 0], C = [3, 0, 0] }}\n\
         mass = 0.5\ncenter = [1.375, 0, 0]\ninertia = [0.03125, 0.5, 0.5]\n\
         [bodies.rocker]\npoints = {{ C = [2.5, 0, 0], D = [0, 0, 0] }}\n\
         mass = 1\ncenter = [1.25, 0.25, -0.125]\ninertia = [0.0625, 0.5, 0.53125]\n\
         [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"], axis = [0, 0, 1] }}\n\
         B = {{ spherical = [\"crank.B\", \"coupler.B\"] }}\nC = {{ spherical = [\"coupler.C\", \"rocker.C\"] }}\n\
         D = {{ revolute = [\"ground.D\", \"rocker.D\"], axis = [0, 1, 0] }}\n\
         [actuators]\nq = {{ angle = \"A\" }}\n[assembly]\nq = 0\n\
         coupler = {{ at = {a:?}, turn = [0.2476, -0.7121, 0.3176] }}\nrocker = {{ at = {d:?}, turn = [0, -1.3127, 0] }}\n"
    );
    let scene = SpaceScene::parse("scene.toml", &text).map_err(|e| e.to_string())?;
    let reaction = Reaction {
        joint: JointId(2),
        component: Component::Force(Axes::Ground, 0),
    };
    let (mechanism, masses) = (&scene.mechanism, &scene.masses);
    let model = Model::new(mechanism, masses, &scene.assembly, &[reaction]);
    model.map_err(|e| e.to_string())
}

/// The coefficients in a number type.
fn values<T: Scalar>(model: &Model) -> Result<[T; 4], Box<dyn std::error::Error>> {
    let (mut workspace, mut out) = (model.workspace::<T>(), model.coefficient_buffer::<T>());
    model.reduce(T::from_f64(CRANK_ANGLE), &mut workspace, &mut out)?;
    let Coefficients {
        m, half_dm, a, b, ..
    } = out;
    Ok([m, half_dm, a[0], b[0]])
}

/// The linkage at each distance in a number type, against the linkage at the origin in 32 digits.
fn places<T: Scalar>(key: &str, what: &str) -> ParameterSeries {
    let run = |distance: f64| -> RunResult {
        let far = rssr(distance)?;
        let found = values::<T>(&far)?.map(T::value);
        let finer = values::<DoubleDouble>(&far)?;
        let at_origin = values::<DoubleDouble>(&rssr(0.0)?)?;
        let cells = (0..4).map(|k| {
            let error = estimate::of_value(found[k], finer[k], 0.0);
            cell((found[k], error), at_origin[k])
        });
        Ok(cells.collect())
    };
    ParameterSeries {
        figure: ("space", "Places in space"),
        key: key.into(),
        description: what.into(),
        parameter: ("distance from the origin", "crank lengths"),
        values: decades(0, 9),
        quantities: &QUANTITIES,
        reference: "the same mechanism at the origin in 32 digits",
        reason: "points on the ground are subtracted before anything is evaluated: as if it were at the origin; a dyad's 8, 16 roundings",
        requirement: Box::new(|_, _| {
            let rounding = ALLOWED_ROUNDINGS * T::EPSILON * DYAD_CONDITION;
            Requirement::from_error(rounding, DYAD_CONDITION)
        }),
        run: Box::new(run),
    }
}
