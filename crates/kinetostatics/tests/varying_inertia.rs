//! A body whose moment of inertia is a function of its angle, against closed forms.
#![allow(clippy::unwrap_used, reason = "a test")]

use dwell_geometry::{Actuator, AssemblyConfiguration, Body, BodyId, Joint, Mechanism, Vec2};
use dwell_kinetostatics::{
    Batch, ExactModel, KnownReaction, Mass, Model, ModelError, ReducedModel, VaryingInertia,
};
use dwell_numerics::{Checked, PiecewiseQuintic, SamplePositions, SampledCurve};
use std::f64::consts::TAU;

const MEAN: f64 = 2.0;
const SWING: f64 = 0.5;

/// I = 2 + 0.5 cos 3θ, kg m², at 24 angles.
fn curve(of: impl Fn(f64) -> f64) -> PiecewiseQuintic {
    let x: Vec<f64> = (0..24).map(|k| TAU * f64::from(k) / 24.0).collect();
    let values: Vec<f64> = x.iter().map(|&x| of(x)).collect();
    let positions = SamplePositions::new(x, Some(TAU));
    PiecewiseQuintic::through(&positions, &SampledCurve::series(&values), Checked::Slope)
}

fn inertia(angle: f64) -> f64 {
    MEAN + SWING * (3.0 * angle).cos()
}

/// A disc of 0.25 kg m² with the varying inertia besides.
fn model(varying: &[VaryingInertia]) -> Result<Model, ModelError> {
    let mechanism = Mechanism {
        bodies: ["ground", "disc"].map(Body::named).into(),
        joints: vec![Joint::revolute("A", [0, 1], [Vec2::ZERO; 2])],
        actuators: vec![Actuator::angle("q", [0, 1])],
        ..Mechanism::default()
    };
    let disc = Mass {
        inertia: 0.25,
        ..Mass::default()
    };
    let start = AssemblyConfiguration {
        q: vec![0.0],
        initial_guess: vec![None; 2],
        ..Default::default()
    };
    Model::new(&mechanism, &[Mass::default(), disc], &start, &[])?.with_varying_inertias(varying)
}

fn varying() -> VaryingInertia {
    let reaction = KnownReaction {
        name: "B.x".to_owned(),
        is_moment: false,
        a: curve(f64::sin),
        b: curve(f64::cos),
    };
    VaryingInertia {
        body: BodyId(1),
        inertia: curve(inertia),
        reactions: vec![reaction],
    }
}

#[test]
fn reduced_parameters_are_those_of_the_kinetic_energy() {
    let exact = ExactModel::new(model(&[varying()]).unwrap()).unwrap();
    let mut workspace = exact.workspace();
    let q: Vec<f64> = (0..37).map(|k| -8.0 + 0.45 * f64::from(k)).collect();
    let mut batch = Batch::default();
    exact.reduce_batch(&q, &mut batch);
    for (k, &q) in q.iter().enumerate() {
        let found = exact.inertia_derivatives(q, &mut workspace).unwrap();
        let slope = -1.5 * SWING * (3.0 * q).sin();
        assert!(
            (found.m - 0.25 - inertia(q)).abs() < 1e-13,
            "{q}: {}",
            found.m
        );
        assert!(
            (found.half_dm - slope).abs() < 1e-12,
            "{q}: {}",
            found.half_dm
        );
        let bend = -4.5 * SWING * (3.0 * q).cos();
        assert!(
            (found.half_ddm - bend).abs() < 1e-9,
            "{q}: {}",
            found.half_ddm
        );
        // A batch holds the values of single evaluations.
        assert_eq!([batch.m[k], batch.half_dm[k]], [found.m, found.half_dm]);
    }
}

/// The power of the actuator is the rate of ½ (0.25 + I) ω².
#[test]
fn power_is_the_rate_of_the_kinetic_energy() {
    let model = model(&[varying()]).unwrap();
    let (mut workspace, mut results) = (model.workspace(), model.result_buffer());
    let (q, speed, acceleration) = (1.1, 3.0, -4.0);
    let state = model
        .kinematic_state(&[q], &[speed], &mut workspace)
        .unwrap();
    let evaluated = state
        .apply_loads(0.0)
        .unwrap()
        .evaluate(&[acceleration], &mut results)
        .unwrap();
    let balance = evaluated.power_balance();
    let energy = 0.5 * (0.25 + inertia(q)) * speed * speed;
    assert!((balance.kinetic_energy - energy).abs() < 1e-12);
    assert!(
        balance.residual().abs() < 1e-12 * balance.scale,
        "{balance:?}"
    );
    let h = 1e-4;
    let at = |t: f64| {
        let (q, v) = (
            q + speed * t + 0.5 * acceleration * t * t,
            speed + acceleration * t,
        );
        0.5 * (0.25 + inertia(q)) * v * v
    };
    let rate = (at(h) - at(-h)) / (2.0 * h);
    assert!((balance.kinetic_energy_rate - rate).abs() < 1e-5, "{rate}");
}

#[test]
fn known_reactions_follow_angle_speed_and_acceleration() {
    let varying = varying();
    let [reaction] = varying.reactions.as_slice() else {
        panic!("one reaction")
    };
    // Also revolutions away.
    for angle in [0.4_f64, 0.4 - 3.0 * TAU] {
        let expected = angle.sin() * 7.0 + angle.cos() * 9.0;
        assert!((reaction.value(angle, 3.0, 7.0) - expected).abs() < 1e-11);
    }
}

/// An inertia over part of a revolution ends the range, and needs the actuator that turns its body.
#[test]
fn part_of_a_revolution_limits_the_range() {
    let positions = SamplePositions::new(vec![-1.0, -0.5, 0.0, 0.5, 1.0], None);
    let cubic = positions.cubic(vec![1.5, 1.2, 1.0, 1.2, 1.5]);
    let part = VaryingInertia {
        inertia: PiecewiseQuintic::through(&positions, &cubic, Checked::Slope),
        reactions: Vec::new(),
        ..varying()
    };
    let limited = ExactModel::new(model(std::slice::from_ref(&part)).unwrap()).unwrap();
    assert_eq!(limited.range().limits(), Some((-1.0, 1.0)));
    assert!(limited.inertia(1.01, &mut limited.workspace()).is_err());
    assert!(limited.inertia(1.0, &mut limited.workspace()).is_ok());
    let on_ground = VaryingInertia {
        body: BodyId(0),
        ..part.clone()
    };
    assert!(matches!(
        model(&[on_ground]),
        Err(ModelError::VaryingInertia { .. })
    ));
    let values = positions.cubic(vec![1.5, 1.2, -1.0, 1.2, 1.5]);
    let negative = VaryingInertia {
        inertia: PiecewiseQuintic::through(&positions, &values, Checked::Slope),
        ..part
    };
    assert!(matches!(
        model(&[negative]),
        Err(ModelError::VaryingInertia { .. })
    ));
}
