//! An evaluation at a new coordinate allocates nothing: all memory is the caller's.
#![allow(clippy::expect_used, reason = "a test")]

use allocation_counter::measure;
use dwell_geometry::{BodyId, Coordinate, vec2};
use dwell_kinetostatics::{
    ExactModel, FreeBodyForces, Load, LoadKind, MachineModel as _, Magnitude, Model, ReducedModel,
    ReducibleModel as _, ShakingForce, Signal, space,
};
use dwell_laws::{Expression, Law, Polynomial};
use dwell_scene::{PlaneScene, SpaceScene};
use std::path::Path;

/// The one scene here in which a prismatic joint carries a body.
const YOKE: &str = include_str!("loads/yoke.toml");

fn case(name: &str) -> PlaneScene {
    let validation = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(validation.join(name).join("scene.toml")).expect("a scene")
}

/// A scene's model with every reaction.
fn model(scene: &PlaneScene) -> ExactModel {
    let assembly = scene.assembly.to_configuration();
    let reactions = scene.mechanism.reactions();
    let model = Model::new(&scene.mechanism, &scene.masses, &assembly, &reactions);
    ExactModel::new(model.expect("it assembles")).expect("one actuator")
}

/// Number of allocations of an evaluation that succeeds or fails as expected.
fn allocations(name: &str, succeeds: bool, mut evaluate: impl FnMut() -> bool) -> u64 {
    let mut done = !succeeds;
    let spent = measure(|| done = evaluate());
    assert_eq!(done, succeeds, "{name}");
    spent.count_total
}

#[test]
fn an_evaluation_allocates_nothing() {
    for (scene, largest) in [
        (case("single-dwell"), 2),
        (case("crank-rocker"), 2),
        (case("slotted-rocker"), 1),
        (case("class-three-six-bar"), 4),
        (PlaneScene::parse("yoke.toml", YOKE).expect("a scene"), 1),
    ] {
        let name = &scene.name;
        let model = model(&scene);
        let groups = model.model().plan().group_methods();
        let sizes = groups.iter().map(|(n, _)| *n);
        assert_eq!(sizes.max(), Some(largest), "{name}");
        assert!(model.reactions() > 0);

        let mut workspace = model.workspace();
        let mut out = model.model().coefficient_buffer();
        let assembled = model.model().plan().assembly_coordinates()[0];
        let beyond = match model.range().limits() {
            None => f64::NAN,
            Some((_, to)) => to + 0.3,
        };
        for k in 0..20 {
            let q = assembled + 0.05 * f64::from(k);
            let counts = [
                allocations(name, true, || {
                    model.coefficients(q, &mut workspace, &mut out).is_ok()
                }),
                allocations(name, true, || model.inertia(q, &mut workspace).is_ok()),
                allocations(name, true, || {
                    model.inertia_derivatives(q, &mut workspace).is_ok()
                }),
                allocations(name, false, || {
                    model.inertia(beyond, &mut workspace).is_ok()
                }),
            ];
            assert_eq!(counts, [0; 4], "{name} at {q}");
        }
    }
}

/// Without a plane, in one, and with a planar equivalent.
#[test]
fn an_evaluation_in_space_allocates_nothing() {
    for name in ["rssr", "planar-oblique-rcsr", "planar-oblique-4r"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/spatial");
        let scene = SpaceScene::read(folder.join(format!("{name}.toml"))).expect("a scene");
        let (mechanism, all) = (&scene.mechanism, &scene.requests.reactions);
        let model = space::Model::new(mechanism, &scene.masses, &scene.assembly, all);
        let model = ExactModel::new(model.expect("it assembles")).expect("one actuator");
        assert!(model.reactions() > 0);
        let is_in_plane = model.model().for_inertia().is_in_plane();
        assert_eq!(is_in_plane, name != "rssr");
        // Its reactions, too: all of them, those that nothing determines among them.
        assert_eq!(model.model().is_in_plane(), name != "rssr");
        let mut workspace = model.workspace();
        let mut out = model.model().coefficient_buffer();
        for k in 0..20 {
            let q = 0.3 * f64::from(k);
            let counts = [
                allocations(name, true, || {
                    model.coefficients(q, &mut workspace, &mut out).is_ok()
                }),
                allocations(name, true, || model.inertia(q, &mut workspace).is_ok()),
                allocations(name, true, || {
                    model.inertia_derivatives(q, &mut workspace).is_ok()
                }),
                allocations(name, false, || {
                    model.inertia(f64::NAN, &mut workspace).is_ok()
                }),
            ];
            assert_eq!(counts, [0; 4], "{name} at {q}");
        }
    }
}

/// Loads of every cost: weight, a spring, a magnitude that has to be measured, a torque.
fn loads(model: &Model) -> Vec<Load> {
    let ground = model.plan().tree().joints[0].parent;
    let bodies = [ground, model.plan().moving_bodies()[0].body].map(BodyId);
    let points = [vec2(0.3, 0.2), vec2(-0.1, 0.4)];
    let spring = LoadKind::spring(bodies, points, 0.02);
    let length = Coordinate::Length { bodies, points };
    let law = Law::Polynomial(Polynomial::motion(1.0, 2.0, 3.0));
    let direction = vec2(0.0, -1.0);
    let formula = Expression::parse("t + sin(l)", &["t", "l"]).expect("an expression");
    let by_formula = Magnitude::Expression(formula, vec![Signal::Time, Signal::Value(length)]);
    [
        (LoadKind::Gravity { direction }, Magnitude::Constant(9.81)),
        (spring, Magnitude::Law(Signal::Velocity(length), law)),
        (LoadKind::couple(bodies), by_formula),
    ]
    .map(|(kind, magnitude)| Load {
        name: "load".into(),
        kind,
        magnitude,
    })
    .into()
}

#[test]
fn loads_and_balances_allocate_nothing() {
    for scene in [
        case("single-dwell"),
        case("class-three-six-bar"),
        PlaneScene::parse("yoke.toml", YOKE).expect("a scene"),
    ] {
        let name = &scene.name;
        let model = model(&scene).model().clone();
        let loads = loads(&model);
        let model = model.with_loads(loads).expect("they fit");
        let free_body_forces = FreeBodyForces::new(&model).expect("every reaction");
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        let mut wrenches = Vec::with_capacity(100);
        let mut powers = [0.0; 3];
        let q = [model.plan().assembly_coordinates()[0] + 0.1];
        let spent = allocations(name, true, || {
            let (work, found) = (&mut workspace, &mut result);
            let Ok(mut state) = model.kinetostatics(0.5, &q, &[2.0], &[-3.0], work, found) else {
                return false;
            };
            state.generalised_forces(&mut powers);
            state.load_powers(&mut powers);
            free_body_forces.wrenches(&state, &mut wrenches);
            let shaking = free_body_forces.shaking_force(&state, &wrenches);
            let power = state.power_balance();
            let rest = model.statics(0.5, &q, &mut workspace, &mut result);
            rest.is_ok() && power.scale > 0.0 && shaking != ShakingForce::default()
        });
        assert_eq!(spent, 0, "{name}");
    }
}

/// Friction in the bearings of gears that push each other apart.
#[test]
fn dependent_loads_allocate_nothing() {
    let friction = "\n[friction]\nA = { coefficient = 0.1, radius = 0.01 }\n";
    let text = include_str!("loads/separating.toml").to_owned() + friction;
    let scene = PlaneScene::parse("test.toml", &text).expect("a scene");
    let model = model(&scene).model().clone();
    let model = model.with_loads(scene.loads).expect("they fit");
    assert_eq!(model.frictions().len(), 2);
    let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
    let spent = allocations("contact forces", true, || {
        let done = model.kinetostatics(0.5, &[0.6], &[2.0], &[-3.0], &mut workspace, &mut result);
        done.is_ok_and(|state| state.loads().magnitude.iter().all(|m| *m != 0.0))
    });
    assert_eq!(spent, 0);
}

#[test]
fn an_allocation_would_be_counted() {
    let scene = case("crank-rocker");
    let model = model(&scene);
    let count = allocations("work", true, || {
        let mut workspace = model.workspace();
        model.inertia(0.0, &mut workspace).is_ok()
    });
    assert!(count > 0);
}

/// Friction in space, solved together with the reactions it depends on.
#[test]
fn friction_in_space_allocates_nothing() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/spatial/planar-oblique-rcsr.toml"
    );
    let friction = r#"
[loads]
weight = { gravity = [1, 2, -9] }
[friction]
A = { coefficient = 0.1, radius = 0.1, bearing-distance = 0.5 }
B = { coefficient = 0.2, radius = 0.1, regularization-speed = 0.02 }
D = { coefficient = 0.1, radius = 0.1 }
"#;
    let text = std::fs::read_to_string(path).expect("the file") + friction;
    let scene = SpaceScene::parse("test.toml", &text).expect("a scene");
    let model = space::Model::new(&scene.mechanism, &scene.masses, &scene.assembly, &[]);
    let model = model
        .expect("a model")
        .with_loads(scene.loads)
        .expect("they fit");
    assert_eq!(model.frictions().len(), 4);
    let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
    let at = [&[1.2][..], &[2.0][..], &[-3.0][..]];
    let spent = allocations("friction in space", true, || {
        let done = model.kinetostatics(0.5, at, &mut workspace, &mut result);
        done.is_ok_and(|state| state.magnitudes()[1] != 0.0)
    });
    assert_eq!(spent, 0);
}

/// Loads in space at a state of motion, with a column of the mass matrix and the response to each load alone: as a machine needs
/// them.
#[test]
fn machines_in_space_allocate_nothing() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/spatial/slider-crank-haug.toml"
    );
    let loads = r#"
spring = { spring = ["ground.A", "slider.C"], stiffness = 31.0, free-length = 0.15 }
coil = { torsion-spring = "A", stiffness = 0.7, free-angle = 0.4 }
rub = { slide-damper = "D", damping = 1.5 }
wind = { drag = "slider.C", coefficient = 0.4 }
fan = { rotational-drag = "A", coefficient = 0.02 }
push = { slide-force = "D", magnitude = "3*sin(2*t) - 4*s" }
[coordinates]
s = { travel = "D" }
"#;
    let text = std::fs::read_to_string(path).expect("the file") + loads;
    let scene = SpaceScene::parse("test.toml", &text).expect("a scene");
    let model = space::Model::new(&scene.mechanism, &scene.masses, &scene.assembly, &[]);
    let model = model
        .expect("a model")
        .with_loads(scene.loads)
        .expect("they fit");
    let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
    let mut other = model.result_buffer();
    let spent = allocations("space", true, || {
        let Ok(state) = model.kinematic_state(&[0.4], &[2.0], &mut workspace) else {
            return false;
        };
        let state = state.apply_loads(0.5);
        let state = state.and_then(|state| state.inverse_dynamics(&[1.0], &mut result));
        let Ok(mut state) = state else { return false };
        state.mass_matrix_column(0, &mut other);
        let loads = 0..model.loads().len();
        let responds = loads
            .clone()
            .all(|load| state.unit_load_response(load, &mut other).is_ok());
        let power: f64 = loads.map(|load| state.load_power(load)).sum();
        responds && power.is_finite() && state.kinetic_energy() > 0.0
    });
    assert_eq!(spent, 0);
}
