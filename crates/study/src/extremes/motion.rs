//! Motions: speeds, tolerances, revolutions.

use super::grid::{Reading, Row, Stated, Told, decades, refused};
use super::moving::{free, kinetic, wrapped};
use super::shapes::CRANK_ROCKER;
use super::truth::{four_bar, root_of_inertia, wide};
use dwell_dynamics::{DynamicsError, Method, Options, State};
use dwell_geometry::{Scalar, Wide};
use dwell_kinetostatics::Exact;
use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock};

/// The crank where the motions start, rad.
const FROM: f64 = 1.125;
/// Points of the rule for the period; half of them differ by 1e-28.
const POINTS: usize = 256;
/// Tolerances that a step errs by in energy at most.
const OF_A_STEP: f64 = 4.0;
/// Steps of a turn at a tolerance of one.
const OF_A_TURN: f64 = 8.0;

/// Turns after which the angle is wrapped: its rounding is then that of a hundred turns.
const WRAPPED: f64 = 100.0;

/// What is reported of a motion at its end.
const ENDS: [&str; 2] = ["angle", "energy"];

/// m at the start, and the period at 1 rad/s there, of the crank-rocker's free motion: E_c is constant.
static TURN: LazyLock<[Wide; 2]> = LazyLock::new(|| {
    let m = four_bar(&CRANK_ROCKER, 1.0, wide(FROM)).m;
    [m, root_of_inertia(&CRANK_ROCKER, 1.0, POINTS) / m.sqrt()]
});

/// Page of these rows, and its title.
const FAMILY: (&str, &str) = ("motions", "Speeds and revolutions");
/// The same of the rows of tolerances.
const TOLERANCES: (&str, &str) = ("tolerances", "Tolerances");

pub(super) fn rows(long: bool) -> Vec<Row> {
    let mut rows = vec![speeds(), revolutions(long)];
    rows.extend(Method::ALL.map(tolerances));
    rows
}

/// Order of the error that a method's step control sees.
fn order(method: Method) -> f64 {
    match method {
        Method::Bdf => 5.0,
        Method::Esdirk34 => 3.0,
        Method::TrBdf2 => 2.0,
        Method::Tsit45 => 4.0,
        Method::Dop853 => 7.0,
    }
}

/// A turn takes 8 tol^(−1/(p + 1)) steps, each of which errs by some tolerances in energy, always the same
/// way; the phase follows the energy's half, summed over the turns.
fn stated(method: Method, tolerance: f64, turns: f64, quantity: usize) -> Stated {
    let steps = OF_A_TURN * tolerance.powf(-1.0 / (order(method) + 1.0));
    let energy = OF_A_STEP * steps * (tolerance + f64::EPSILON) * turns;
    let phase = 0.5 * energy * turns.max(1.0);
    Stated::error(if quantity == 0 { phase } else { energy }, turns)
}

/// So many turns at a speed of the start, to the same position again.
fn turned(
    model: &Exact,
    speed: f64,
    turns: f64,
    options: &Options,
) -> Result<Vec<Told>, DynamicsError> {
    let [m, period] = *TURN;
    let parts = (turns / WRAPPED).max(1.0);
    let way = Wide::turns(turns / parts);
    let whole = period * wide(turns / parts) / wide(speed);
    let duration = whole.value();
    let start = State {
        t: 0.0,
        q: FROM,
        q_dot: speed,
    };
    let (twice, angle) = if parts > 1.0 {
        let parts = (parts as usize, duration);
        (wrapped(model, start, parts, way, options)?, wide(FROM))
    } else {
        (free(model, start, duration, options)?, wide(FROM) + way)
    };
    // The plain end is not quite the whole of the turns.
    let late = (wide(duration) - whole) * wide(speed) * wide(parts);
    let angle = angle + late;
    // A last place of the angle is lost in each part, and of the time.
    let rounding = 2.0 * f64::EPSILON * (way.value() + angle.value()) * parts.sqrt();
    let (q, q_error) = twice.last(|y| y[0], rounding);
    let energy = wide(0.5) * m * wide(speed) * wide(speed);
    let rounding = 4.0 * f64::EPSILON * energy.value();
    let (e, e_error) = twice.last(|y| kinetic(model, y), rounding);
    Ok(vec![
        Ok(Reading::new(q, angle, q_error).of(TAU)),
        Ok(Reading::new(e, energy, e_error)),
    ])
}

/// A row of motions of the crank-rocker: speed, turns and options by value.
fn row(
    values: Vec<f64>,
    motion: impl Fn(f64) -> (f64, f64, Options) + Send + Sync + Clone + 'static,
) -> Row {
    let model = Arc::new(CRANK_ROCKER.shape().exact(&[]));
    let by = motion.clone();
    Row {
        family: FAMILY,
        key: String::new(),
        what: String::new(),
        parameter: ("", ""),
        values,
        quantities: &ENDS,
        truth: "the period by quadrature of a closed form in 32 digits: the crank is where it was, at the same energy",
        why: "",
        stated: Box::new(move |at, quantity| {
            let (_, turns, options) = by(at);
            stated(options.method, options.relative, turns, quantity)
        }),
        run: Box::new(move |at| {
            let (speed, turns, options) = motion(at);
            let told = match &*model {
                Ok(model) => turned(model, speed, turns, &options).map_err(|e| e.to_string()),
                Err(error) => Err(error.clone()),
            };
            told.unwrap_or_else(|error| refused(&error, ENDS.len()))
        }),
    }
}

fn speeds() -> Row {
    let options = Options::new(Method::Bdf, 1e-10);
    Row {
        family: FAMILY,
        key: "speed".into(),
        what: "Free motion of a four-bar over one turn: its speed".into(),
        parameter: ("speed at the start", "rad/s"),
        why: "without loads a speed only scales time: one turn at 1e-10, whatever the speed; a turn's steps, \
              4 tolerances each",
        ..row(decades(-9, 9), move |speed| (speed, 1.0, options))
    }
}

fn tolerances(method: Method) -> Row {
    let name = method.name();
    Row {
        family: TOLERANCES,
        key: format!("tolerance-{}", name.to_lowercase()),
        what: format!("Free motion of a four-bar over one turn by {name}: tolerance"),
        parameter: ("tolerance", ""),
        why: "a turn takes 8 tol^(−1/(p + 1)) steps of the order p that step control sees, each errs by 4 tolerances \
              and a rounding at most",
        ..row(decades(-2, -14), move |tolerance| {
            (1.0, 1.0, Options::new(method, tolerance))
        })
    }
}

fn revolutions(long: bool) -> Row {
    let options = Options::new(Method::Tsit45, 1e-12);
    let most = if long { 5 } else { 3 };
    Row {
        family: FAMILY,
        key: "revolutions".into(),
        what: "Free motion of a four-bar at 1e-12 by Tsit45: revolutions".into(),
        parameter: ("revolutions n", ""),
        why: "the energy errs the same way in each of the n turns, and the angle by half of that, summed over them: \
              n²/2 times the error of a turn's energy",
        ..row(decades(0, most), move |turns| (1.0, turns, options))
    }
}
