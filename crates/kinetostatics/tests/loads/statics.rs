//! Statics by hand formulas, and against the potential.

use crate::scenes::{Case, all, body, load, varied};
use dwell_geometry::{Coordinate, JointId, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{
    Direction, Friction, FrictionContact, KinetostaticsError, Load, LoadKind, Magnitude, Model,
    Signal,
};

const GRAVITY: LoadKind = LoadKind::Gravity {
    direction: vec2(0.0, -1.0),
};

const PENDULUM: &str = r#"
    [bodies]
    ground.points = { A = [3, -2] }
    bar = { points = { A = [1, 1] }, mass = 2.0, center = [1.4, 1.3], inertia = 0.1 }
    [joints]
    A = { revolute = ["ground.A", "bar.A"] }
    [actuators]
    phi = { angle = ["ground", "bar"] }
"#;

/// Crank 0.1 m, rod 0.35 m, no mass anywhere.
pub(crate) const SLIDER_CRANK: &str = r#"
    [bodies]
    ground.points = { O = [0, 0] }
    crank.points = { O = [0, 0], A = [0.1, 0] }
    rod.points = { A = [0, 0], B = [0.35, 0] }
    piston.points = { B = [0, 0] }
    [joints]
    O = { revolute = ["ground.O", "crank.O"] }
    A = { revolute = ["crank.A", "rod.A"] }
    B = { revolute = ["rod.B", "piston.B"] }
    guide = { prismatic = ["ground.O", "piston.B"], axis = [1, 0] }
    [actuators]
    phi = { angle = ["ground", "crank"] }
    [assembly]
    phi = 0.5
    rod = -0.15
    piston = 0.0
"#;

/// The weight of a pendulum: m g times the horizontal distance of its centre.
#[test]
fn a_pendulum_is_held_by_its_weight_times_its_lever() {
    let case = Case::parse(PENDULUM, |_| vec![load("weight", GRAVITY, 9.81)]);
    for k in 0..8 {
        let q = 0.8 * f64::from(k);
        let result = case.result(0.0, &[q], &[0.0], &[0.0]);
        let lever = vec2(0.4, 0.3).rotate(Vec2::from_angle(q)).x;
        // 20 N·m: a few units in the last place.
        assert!((result.tau[0] - 2.0 * 9.81 * lever).abs() < 1e-14 * 20.0);
        assert!(case.reaction(&result, "A.x").abs() < 1e-14 * 20.0);
        assert!((case.reaction(&result, "A.y") - 2.0 * 9.81).abs() < 1e-14 * 20.0);
    }
}

/// Force −F on the piston: the rod carries F/cos β, the guide F tan β, the crank F r sin(φ+β)/cos β.
#[test]
fn a_massless_slider_crank_carries_the_piston_force() {
    let force = 700.0;
    let loads = |mechanism: &Mechanism| {
        let kind = LoadKind::Force {
            body: body(mechanism, "piston"),
            point: Vec2::ZERO,
            direction: Direction::Ground(vec2(-1.0, 0.0)),
        };
        vec![load("gas", kind, force)]
    };
    let case = Case::parse(SLIDER_CRANK, loads);
    for k in 0..9 {
        let q = 0.3 + 0.65 * f64::from(k);
        // At any speed: there is no mass.
        let result = case.result(0.0, &[q], &[3.0], &[-5.0]);
        let (r, l) = (0.1, 0.35);
        let sin = r * q.sin() / l;
        let cos = (1.0 - sin * sin).sqrt();
        let tangential = q.sin() * cos + q.cos() * sin;
        let found = [
            result.tau[0],
            case.reaction(&result, "guide.normal"),
            case.reaction(&result, "guide.moment"),
            case.reaction(&result, "B.x"),
            case.reaction(&result, "B.y"),
            case.reaction(&result, "A.x"),
            case.reaction(&result, "O.x"),
        ];
        let (x, y) = (force, -force * sin / cos);
        // Pushed by the gas, the crank must be held back: τ counter-clockwise where it would turn
        // clockwise.
        let tau = -force * r * tangential / cos;
        let expected = [tau, -y, 0.0, x, y, x, x];
        for (found, expected) in found.iter().zip(expected) {
            // Rounding in β, times a few operations.
            assert!(
                (found - expected).abs() < 3e-14 * force,
                "{found} {expected} at {q}"
            );
        }
    }
}

/// By a fifth-order difference of the potential along q.
fn potential_slope(case: &Case, q: f64) -> f64 {
    let h = 2e-3 * case.reach;
    let at = |k: f64| {
        let mut memory = case.memory();
        let state = case.evaluate(&mut memory, 0.0, &[q + k * h], &[0.0], &[0.0]);
        let loads = 0..case.model.loads().len();
        loads.filter_map(|i| state.potential_energy(i)).sum::<f64>()
    };
    let d = |k: f64| at(k) - at(-k);
    (45.0 * d(1.0) - 9.0 * d(2.0) + d(3.0)) / (60.0 * h)
}

#[test]
fn conservative_loads_are_held_by_the_slope_of_their_potential() {
    for mut case in all()
        .into_iter()
        .filter(|c| c.model.plan().actuators() == 1)
    {
        let loads = case.model.loads().to_vec();
        for single in loads {
            let one = vec![single.clone()];
            case.model = case.model.with_loads(one).expect("it fits");
            let mut memory = case.memory();
            for (_, q, ..) in case.states().into_iter().take(3) {
                let state = case.evaluate(&mut memory, 0.0, &q, &[0.0], &[0.0]);
                let Some(energy) = state.potential_energy(0).map(f64::abs) else {
                    continue;
                };
                let tau = state.inverse_dynamics().tau[0];
                let slope = potential_slope(&case, q[0]);
                // Rounding of V over the step, 1e-16/2e-3, and h⁶ of the difference.
                let tolerance = 1e-12 * energy + 2e-10 * (tau.abs() + energy);
                let (name, load) = (&case.name, &single.name);
                assert!(
                    (tau - slope).abs() < tolerance,
                    "{name} {load}: {tau} {slope}"
                );
            }
        }
    }
}

/// Two points that meet when the crank lies at angle zero: a spring from (0.1, 0) to its end.
fn meeting_spring(free: f64) -> impl FnOnce(&Mechanism) -> Vec<Load> {
    move |mechanism| {
        let kind = LoadKind::spring(
            ["ground", "crank"].map(|name| body(mechanism, name)),
            [vec2(0.1, 0.0); 2],
            free,
        );
        vec![load("weight", GRAVITY, 9.81), load("spring", kind, 50.0)]
    }
}

#[test]
fn a_spring_of_no_length_pulls_smoothly_or_says_that_it_has_no_direction() {
    let case = Case::parse(SLIDER_CRANK, meeting_spring(0.0));
    let moving = case.result(0.0, &[0.0], &[1.0], &[0.0]);
    assert_eq!(moving.tau[0], 0.0);
    let tau_at = |q: f64| case.result(0.0, &[q], &[0.0], &[0.0]).tau[0];
    // V = k r² (1 − cos q): τ = k r² sin q, to rounding of a length of 1e-9 m.
    assert!((tau_at(1e-8) - 50.0 * 0.01 * 1e-8).abs() < 1e-16);

    let case = Case::parse(SLIDER_CRANK, meeting_spring(0.02));
    let (model, (workspace, result)) = (&case.model, &mut case.memory());
    let error = model.statics(0.0, &[0.0], workspace, result).err();
    assert_eq!(error, Some(KinetostaticsError::NoDirection { load: 1 }));
    let load = error
        .and_then(|e| e.load())
        .map(|l| model.loads()[l].name.as_str());
    assert_eq!(load, Some("spring"));
    assert!(model.statics(0.0, &[0.1], workspace, result).is_ok());
}

#[test]
fn a_damper_at_rest_needs_no_direction() {
    let damper = |mechanism: &Mechanism| {
        let kind = LoadKind::damper(
            ["ground", "crank"].map(|name| body(mechanism, name)),
            [vec2(0.1, 0.0); 2],
        );
        vec![load("damper", kind, 50.0)]
    };
    let case = Case::parse(SLIDER_CRANK, damper);
    let (mut workspace, mut result) = case.memory();
    let still = case.model.statics(0.0, &[0.0], &mut workspace, &mut result);
    assert_eq!(still.expect("a direction").inverse_dynamics().tau, [0.0]);
    let state = case.model.kinematic_state(&[0.0], &[1.0], &mut workspace);
    let loaded = state.expect("a pose").apply_loads(0.0);
    let moving = loaded.and_then(|state| state.evaluate(&[0.0], &mut result));
    assert_eq!(
        moving.err(),
        Some(KinetostaticsError::NoDirection { load: 0 })
    );
}

#[test]
fn a_magnitude_without_a_value_is_refused() {
    let endless = |_: &Mechanism| vec![varied("endless", GRAVITY, Signal::Time, &[0.0, 1e308])];
    let case = Case::parse(PENDULUM, endless);
    let (mut workspace, mut result) = case.memory();
    let error = case
        .model
        .statics(1e10, &[0.0], &mut workspace, &mut result)
        .err();
    assert_eq!(
        error,
        Some(KinetostaticsError::MagnitudeNotFinite { load: 0 })
    );
}

#[test]
fn loads_that_do_not_fit_are_refused() {
    let case = Case::parse(PENDULUM, |_| Vec::new());
    let refused = |load: Load| {
        let found = case.model.clone().with_loads(vec![load]);
        found.err().map(|e| e.to_string())
    };
    let bodies = [dwell_geometry::BodyId(0), dwell_geometry::BodyId(9)];
    let torque = LoadKind::couple(bodies);
    let at = |what| Some(format!("load 0: {what}"));
    assert_eq!(
        refused(load("torque", torque, 1.0)),
        at("it acts on a body that does not exist")
    );
    let long = LoadKind::Gravity {
        direction: vec2(0.0, 2.0),
    };
    let senseless = at(
        "its points and free value must be finite, its direction a unit vector, its free length not negative",
    );
    assert_eq!(refused(load("gravity", long, 1.0)), senseless);
    let not = at("its magnitude is not a finite number");
    assert_eq!(refused(load("gravity", GRAVITY, f64::NAN)), not);
    let travel = Coordinate::Travel(dwell_geometry::JointId(0));
    let unknown = at("its magnitude depends on a coordinate that the mechanism does not have");
    let varied = varied("gravity", GRAVITY, Signal::Value(travel), &[1.0]);
    assert!(matches!(varied.magnitude, Magnitude::Law(..)));
    assert_eq!(refused(varied), unknown);
}

/// The friction of a joint depends on all of its reactions, whichever of them are requested.
#[test]
fn friction_has_its_reactions_whichever_are_requested() {
    let case = Case::parse(PENDULUM, |mechanism| {
        let joint = JointId(0);
        let friction = Friction {
            joint,
            coefficient: 0.3,
            static_coefficient: 0.3,
            contact: FrictionContact::Pin { radius: 0.05 },
            regularization_speed: Some(0.1),
        };
        let bodies = mechanism.joints[joint.0].bodies;
        vec![
            load("weight", GRAVITY, 9.81),
            Load {
                name: "friction".into(),
                kind: LoadKind::couple(bodies),
                magnitude: Magnitude::Friction(friction),
            },
        ]
    });
    let evaluate = |model: &Model| {
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        let state = model
            .kinetostatics(0.0, &[0.4], &[2.0], &[3.0], &mut workspace, &mut result)
            .expect("a pose");
        assert!(state.loads().magnitude[1] < -0.1, "it rubs");
        result
    };
    let all = evaluate(&case.model);
    let y_only = [case.model.reactions()[1]];
    let y_only = case.model.clone().with_reactions(&y_only).expect("A.y");
    let found = evaluate(&y_only);
    assert_eq!(
        (&found.tau, found.reactions[0]),
        (&all.tau, all.reactions[1])
    );
    assert_eq!(evaluate(&case.model.without_reactions()).tau, all.tau);
}
