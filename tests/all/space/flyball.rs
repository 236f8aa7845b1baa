//! The governor A05 by Lagrange's equations in its two arm angles and the height of its sleeve, at a constant angular momentum about
//! its shaft: classical Runge–Kutta steps that are short beside its fastest decay, 1/27 000 s. Nothing is shared with Dwell.

/// Arms with their end masses: mass, kg; distance of the centre of mass from the pivot, m; moments of inertia along and across, kg m².
const ARM: [f64; 4] = [5.3, 0.971_698_113_207_547_3, 5e-6, 0.095_757_216_981_132_07];
/// Moment of inertia of shaft and sleeve about the shaft, kg m².
const SHAFT: f64 = 5e-6 + 0.005;
const SLEEVE_MASS: f64 = 3.0;
const GRAVITY: f64 = 9.81;
/// Distance of the pivots from the axis, their height, and where a spring-damper holds an arm, m.
const PIVOT: [f64; 2] = [0.05, 1.0];
const HELD_AT: f64 = 0.5;
/// The spring-dampers, N/m, N s/m, m.
const STIFFNESS: f64 = 8e5;
const DAMPING: f64 = 4e4;
const FREE_LENGTH: f64 = 0.5;

/// Spin angle, the arms' angles below the horizontal, the sleeve's height; then the velocities of the last three.
pub(super) type State = [f64; 7];

/// Moment of inertia of an arm about the shaft at its angle, and its derivative.
fn about_shaft(angle: f64) -> [f64; 2] {
    let [mass, center, along, across] = ARM;
    let (sin, cos) = angle.sin_cos();
    let radius = PIVOT[0] + center * cos;
    [
        mass * radius * radius + along * sin * sin + across * cos * cos,
        -2.0 * mass * radius * center * sin + 2.0 * (along - across) * sin * cos,
    ]
}

fn rate(state: &State, momentum: f64) -> State {
    let [mass, center, _, across] = ARM;
    let [_, first, second, height, first_rate, second_rate, rise] = *state;
    let [one, two] = [first, second].map(about_shaft);
    let spin = momentum / (SHAFT + one[0] + two[0]);
    let mut on_sleeve = -SLEEVE_MASS * GRAVITY;
    let mut arm = |angle: f64, angle_rate: f64, slope: f64| {
        let (sin, cos) = angle.sin_cos();
        // From the sleeve's lug to the arm.
        let gap = [HELD_AT * cos, PIVOT[1] - HELD_AT * sin - height];
        let per_angle = [-HELD_AT * sin, -HELD_AT * cos];
        let length = gap[0].hypot(gap[1]);
        let change = [0, 1].map(|k| gap[k] * per_angle[k] / length);
        let by_angle = change[0] + change[1];
        let by_height = -gap[1] / length;
        let lengthening = by_angle * angle_rate + by_height * rise;
        let pull = STIFFNESS * (length - FREE_LENGTH) + DAMPING * lengthening;
        on_sleeve -= pull * by_height;
        let moment = 0.5 * slope * spin * spin + mass * GRAVITY * center * cos - pull * by_angle;
        moment / (mass * center * center + across)
    };
    let accelerations = [
        arm(first, first_rate, one[1]),
        arm(second, second_rate, two[1]),
    ];
    [
        spin,
        first_rate,
        second_rate,
        rise,
        accelerations[0],
        accelerations[1],
        on_sleeve / SLEEVE_MASS,
    ]
}

/// States after each of `times` equal intervals, s, from rest at 30° but for a spin, rad/s.
pub(super) fn states(
    spin: f64,
    interval: f64,
    times: usize,
    steps_per_interval: usize,
) -> Vec<State> {
    let angle = 30_f64.to_radians();
    let momentum = (SHAFT + 2.0 * about_shaft(angle)[0]) * spin;
    let h = interval / steps_per_interval as f64;
    let mut state = [0.0, angle, angle, 0.5, 0.0, 0.0, 0.0];
    let moved = |from: &State, by: &State, part: f64| -> State {
        std::array::from_fn(|k| from[k] + part * by[k])
    };
    let mut all = Vec::new();
    for _ in 0..times {
        for _ in 0..steps_per_interval {
            let k1 = rate(&state, momentum);
            let k2 = rate(&moved(&state, &k1, 0.5 * h), momentum);
            let k3 = rate(&moved(&state, &k2, 0.5 * h), momentum);
            let k4 = rate(&moved(&state, &k3, h), momentum);
            for k in 0..state.len() {
                state[k] += h / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]);
            }
        }
        all.push(state);
    }
    all
}
