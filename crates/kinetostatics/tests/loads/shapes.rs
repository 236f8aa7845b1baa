//! The effect of each kind of load on the bodies.

use crate::scenes::{Case, all, body, case, load};
use crate::statics::SLIDER_CRANK;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{Mechanism, Vec2, vec2};
use dwell_kinetostatics::{Direction, ForceSource, LoadKind, LoadShape as _, Magnitude, Strength};

/// Over any motion a spring's power is −k (length − free) times the length's own speed, a
/// damper's −c times its square, and that of drag −c times its cube; the same with angles.
#[test]
fn springs_give_back_and_dampers_dissipate() {
    for case in all() {
        let mut memory = case.memory();
        for (t, q, q_dot, q_ddot) in case.states() {
            let state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
            let mut powers = vec![0.0; case.model.loads().len()];
            state.load_powers(&mut powers);
            let states = state.bodies();
            let wrenches_of = |i| {
                let wrenches = state.loads().wrenches.iter();
                wrenches.filter(move |a| a.source == ForceSource::Load(i))
            };
            for (i, load) in case.model.loads().iter().enumerate() {
                let f = state.loads().magnitude[i];
                let (value, free, velocity) = match load.kind {
                    LoadKind::Along(along, law) if law != Strength::Direct => {
                        let [value, velocity, _] = states.coordinate(along);
                        (value, law.free(), velocity)
                    }
                    LoadKind::Drag { body, point } => {
                        (0.0, None, states.point(body, point).velocity.norm())
                    }
                    _ => continue,
                };
                let is_quadratic = load.kind.strength() == Strength::Quadratic;
                let expected = match free {
                    Some(free) => -f * (value - free) * velocity,
                    None if is_quadratic => -f * velocity.abs().powi(3),
                    None => -f * velocity * velocity,
                };
                // Against the two parts of a stretch, each times the speed of both ends: the parts
                // may nearly cancel, and so may the ends.
                let quadratic = if is_quadratic {
                    velocity * velocity
                } else {
                    0.0
                };
                let size = f.abs() * (value.abs() + free.unwrap_or(velocity).abs() + quadratic);
                let terms = wrenches_of(i).map(|wrench| {
                    let body = states.body(wrench.body);
                    size * (body.velocity_at(wrench.moment_arm).norm()
                        + body.angular_velocity.abs())
                });
                let scale: f64 = terms.sum();
                let difference = (powers[i] - expected).abs();
                assert!(
                    difference <= 1e-13 * scale.max(expected.abs()),
                    "{} {}: {difference}",
                    case.name,
                    load.name
                );
                assert!(free.is_some() || f < 0.0 || powers[i] <= 0.0);
            }
        }
    }
}

/// τ of a loaded mechanism is that of its inertia less the loads' generalised forces.
#[test]
fn virtual_work_gives_what_the_actuators_feel() {
    for case in all() {
        let (mut memory, mut unloaded) = (case.memory(), case.memory());
        for (t, q, q_dot, q_ddot) in case.states() {
            let mut state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
            case.model
                .inverse_dynamics(&q, &q_dot, &q_ddot, &mut unloaded.0, &mut unloaded.1)
                .expect("a pose");
            let (n, loads) = (q.len(), case.model.loads().len());
            let mut forces = vec![0.0; n * loads];
            state.generalised_forces(&mut forces);
            for i in 0..n {
                let of_loads = (0..loads).map(|l| forces[l * n + i]);
                let scale: f64 = of_loads.clone().map(f64::abs).sum();
                let expected = unloaded.1.tau[i] - of_loads.sum::<f64>();
                let difference = (state.inverse_dynamics().tau[i] - expected).abs();
                let scale = scale + unloaded.1.tau[i].abs();
                // Rounding of some 50 loads through groups of up to four unknowns.
                assert!(
                    difference < 1e-12 * scale,
                    "{} {i}: {difference} of {scale}",
                    case.name
                );
            }
        }
    }
}

fn force(body: &'static str, direction: Vec2, body_fixed: bool) -> impl Fn(&Mechanism) -> LoadKind {
    move |mechanism| LoadKind::Force {
        body: crate::scenes::body(mechanism, body),
        point: vec2(0.2, 0.05),
        direction: if body_fixed {
            Direction::Body(direction)
        } else {
            Direction::Ground(direction)
        },
    }
}

/// A force that follows a body is the force with the body's angle added, in the ground's axes.
#[test]
fn a_force_follows_its_body() {
    let direction = Vec2::from_angle(0.4);
    let follower = force("rod", direction, true);
    let following = Case::parse(SLIDER_CRANK, |m| vec![load("f", follower(m), 30.0)]);
    let rod = following.body("rod");
    let mut memory = following.memory();
    for k in 0..5 {
        let q = 0.4 + 0.5 * f64::from(k);
        let state = following.evaluate(&mut memory, 0.0, &[q], &[0.0], &[0.0]);
        let rotation = state.bodies().body(rod).rotation;
        let rotated = force("rod", direction.rotate(rotation), false);
        let fixed = Case::parse(SLIDER_CRANK, |m| vec![load("f", rotated(m), 30.0)]);
        let result = |case: &Case| case.result(0.0, &[q], &[0.0], &[0.0]);
        assert_eq!(result(&fixed), *state.inverse_dynamics());
        let unrotated = force("rod", direction, false);
        let other = Case::parse(SLIDER_CRANK, |m| vec![load("f", unrotated(m), 30.0)]);
        assert!((result(&other).tau[0] - state.inverse_dynamics().tau[0]).abs() > 1e-3);
    }
}

/// The block slides in the rocker and turns with it: a torque between the two is carried by the slide
/// alone.
#[test]
fn a_torque_between_bodies_that_turn_together_is_felt_by_their_slide_alone() {
    let scene = case("slotted-rocker");
    let unloaded = Case::of(&scene, |_| Vec::new());
    let case = Case::of(&scene, |mechanism| {
        let bodies = ["rocker", "block"].map(|name| body(mechanism, name));
        vec![load("torque", LoadKind::couple(bodies), 5.0)]
    });
    let mut memory = case.memory();
    for (t, q, q_dot, q_ddot) in case.states() {
        let unloaded = unloaded.result(t, &q, &q_dot, &q_ddot);
        let state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
        let result = state.inverse_dynamics();
        let reactions = unloaded.reactions.iter();
        let largest = reactions.fold(5.0, |m: f64, r| m.max(r.abs()));
        // Five is added to and taken off the same frame: rounding of the largest.
        let same = |a: f64, b: f64| (a - b).abs() < 1e-13 * largest;
        assert!(same(result.tau[0], unloaded.tau[0]));
        for (k, &reaction) in case.model.reactions().iter().enumerate() {
            let name = case.mechanism.reaction_name(reaction);
            let of_torque = if name == "slot.moment" { -5.0 } else { 0.0 };
            let [with, without] = [result, &unloaded].map(|r| r.reactions[k]);
            assert!(same(with - without, of_torque), "{name}: {with} {without}");
        }
        let mut power = [0.0];
        state.load_powers(&mut power);
        assert_eq!(power, [0.0]);
    }
}

/// A magnitude is the value of its law or expression at its signals.
#[test]
fn magnitudes_follow_their_signals() {
    for case in all() {
        let mut memory = case.memory();
        for (t, q, q_dot, q_ddot) in case.states() {
            let state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
            for (load, &f) in case.model.loads().iter().zip(&state.loads().magnitude) {
                let LoadKind::Along(CoordinateFunction::Angle(bodies), Strength::Direct) =
                    load.kind
                else {
                    continue;
                };
                let [angle, velocity, _] = state.bodies().angle(bodies);
                let expected = match load.name.as_str() {
                    "fan" => -0.1 * velocity * velocity.abs() * (2.0 + (t + angle).sin()),
                    "torque" => 0.4 - 0.2 * velocity,
                    _ => 0.7,
                };
                // Another order of the same few operations.
                assert!(
                    (f - expected).abs() <= 1e-15 * f.abs().max(1.0),
                    "{}",
                    load.name
                );
            }
        }
    }
}

/// Rest is statics, whatever the loads.
#[test]
fn statics_is_kinetostatics_at_rest() {
    for case in all() {
        let (mut workspace, mut result) = case.memory();
        for (t, q, ..) in case.states() {
            let rest = vec![0.0; q.len()];
            let moving = case.result(t, &q, &rest, &rest);
            let still = case.model.statics(t, &q, &mut workspace, &mut result);
            assert_eq!(still.expect("a pose").inverse_dynamics(), &moving);
        }
        let constant = |m: &Magnitude| matches!(m, Magnitude::Constant(_));
        assert!(case.model.loads().iter().any(|l| !constant(&l.magnitude)));
    }
}
