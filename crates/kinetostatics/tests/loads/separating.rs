//! Gears and racks with a pressure angle, by hand: a tooth force T has a separating force S = |T| tan α, so that the
//! teeth act on each other with |T|/cos α, and the bearings carry it.

use crate::scenes::Case;
use dwell_geometry::{JointId, Vec2, vec2};
use dwell_kinetostatics::{
    FreeBodyForces, InverseDynamics, Load, LoadKind, MachineModel as _, Magnitude, Model,
};
use dwell_scene::PlaneScene;

/// rad, about 20°.
const ALPHA: f64 = 0.35;

fn tangent() -> f64 {
    ALPHA.tan()
}

/// Tolerance in N for forces of a hundred newtons: a few units in the last place of each step.
const ROUNDING: f64 = 1e-12;

fn close(found: Vec2, expected: Vec2) {
    assert!(
        (found - expected).norm() < ROUNDING,
        "{found:?} {expected:?}"
    );
}

/// A scene's mechanism under its own loads.
fn case(text: &str) -> Case {
    let scene = PlaneScene::parse("test.toml", text).expect("a scene");
    Case::of(&scene, |_| scene.loads.clone())
}

/// A case in a state of motion.
struct Evaluated<'a> {
    case: &'a Case,
    result: InverseDynamics<f64>,
    magnitudes: Vec<f64>,
}

/// The case at q, q̇ of its one actuator and t = 0, without acceleration.
fn at(case: &Case, q: f64, q_dot: f64) -> Evaluated<'_> {
    let mut memory = case.memory();
    let state = case.evaluate(&mut memory, 0.0, &[q], &[q_dot], &[0.0]);
    let magnitudes = state.loads().magnitude.clone();
    Evaluated {
        case,
        result: memory.1,
        magnitudes,
    }
}

impl Evaluated<'_> {
    fn reaction(&self, name: &str) -> f64 {
        self.case.reaction(&self.result, name)
    }

    fn pin(&self, name: &str) -> Vec2 {
        let component = |axis| self.reaction(&format!("{name}.{axis}"));
        vec2(component("x"), component("y"))
    }

    fn magnitude(&self, name: &str) -> f64 {
        let mut loads = self.case.model.loads().iter();
        let load = loads.position(|load| load.name == name);
        self.magnitudes[load.expect("a load of that name")]
    }
}

/// Two gears whose centres are `distance` apart in the direction `psi`, the first driven, a torque on the second.
fn gears(radii: [f64; 2], internal: bool, psi: f64, torque: f64, more: &str) -> String {
    let distance = if internal {
        (radii[0] - radii[1]).abs()
    } else {
        radii[0] + radii[1]
    };
    let (y, x) = psi.sin_cos();
    format!(
        r#"
        [bodies]
        ground.points = {{ A = [0.4, -0.3], B = [{}, {}] }}
        one.points = {{ A = [0, 0] }}
        two.points = {{ B = [0, 0] }}
        [joints]
        A = {{ revolute = ["ground.A", "one.A"] }}
        B = {{ revolute = ["ground.B", "two.B"] }}
        mesh = {{ gear = ["one.A", "two.B"], radii = [{}, {}], internal = {internal}{more} }}
        [actuators]
        phi = {{ angle = ["ground", "one"] }}
        [assembly]
        phi = 0.3
        [loads]
        brake = {{ torque = "two", magnitude = {torque} }}
        "#,
        0.4 + distance * x,
        -0.3 + distance * y,
        radii[0],
        radii[1],
    )
}

const WITH_ANGLE: &str = ", pressure-angle = 0.35";

/// The tooth force turns the second gear against the brake: r₂ T = −M. It is tangential at the pitch point; S pushes the
/// wheels apart, whichever way T acts.
#[test]
fn two_spur_gears_are_pushed_apart_by_both_senses_of_the_torque() {
    for psi in [0.0, 0.9, 2.4, -1.3] {
        for torque in [3.0, -3.0] {
            let case = case(&gears([0.03, 0.02], false, psi, torque, WITH_ANGLE));
            let case = at(&case, 0.3, 0.0);
            let tooth = -torque / 0.02;
            let separating = tooth.abs() * tangent();
            assert!((case.reaction("mesh.tooth") - tooth).abs() < ROUNDING);
            assert!((case.magnitude("mesh.separating") - separating).abs() < ROUNDING);
            let u = Vec2::from_angle(psi);
            // Counter-clockwise at the second gear's pitch point is −u turned by +90°.
            let on_second = u.perp() * -tooth + u * separating;
            close(case.pin("B"), -on_second);
            close(case.pin("A"), on_second);
            let size = tooth.abs() / ALPHA.cos();
            assert!((case.pin("B").norm() - size).abs() < ROUNDING);
        }
    }
}

/// In a ring the pinion is pushed towards the ring's centre, away from the ring's teeth, whichever of the two is named
/// first.
#[test]
fn a_ring_pushes_its_pinion_towards_its_own_centre() {
    for torque in [3.0, -3.0] {
        for (radii, pinion) in [([0.07, 0.02], 1), ([0.02, 0.07], 0)] {
            let case = case(&gears(radii, true, 0.7, torque, WITH_ANGLE));
            let case = at(&case, 0.3, 0.0);
            let tooth = -torque / radii[1];
            assert!((case.reaction("mesh.tooth") - tooth).abs() < ROUNDING);
            // From the ring's centre to the pinion's, and on to the pitch point.
            let u = Vec2::from_angle(0.7) * if pinion == 1 { 1.0 } else { -1.0 };
            // The pitch point lies along u from both centres, so the tangent of both is u turned by +90°.
            let on_second = u.perp() * tooth;
            let tangential = if pinion == 1 { on_second } else { -on_second };
            let on_pinion = tangential - u * (tooth.abs() * tangent());
            let pins = ["A", "B"];
            close(case.pin(pins[pinion]), -on_pinion);
            close(case.pin(pins[1 - pinion]), on_pinion);
        }
    }
}

/// A rack in a guide along x, and a pinion above (+1) or below (−1) it.
fn rack(side: f64, force: f64) -> String {
    format!(
        r#"
        [bodies]
        ground.points = {{ C = [0.1, {}], G = [0, 0] }}
        pinion.points = {{ C = [0, 0] }}
        rack.points = {{ P = [0, 0] }}
        [joints]
        C = {{ revolute = ["ground.C", "pinion.C"] }}
        guide = {{ prismatic = ["ground.G", "rack.P"], axis = [1, 0] }}
        mesh = {{ rack = ["rack.P", "pinion.C"], axis = [1, 0], radius = {}, pressure-angle = 0.35 }}
        [actuators]
        phi = {{ angle = ["ground", "pinion"] }}
        [loads]
        push = {{ force = "rack.P", direction = [1, 0], magnitude = {force} }}
        "#,
        0.02 * side,
        0.02 * side,
    )
}

#[test]
fn a_rack_pushes_its_pinion_off_normal_to_the_pitch_line() {
    for side in [1.0, -1.0] {
        for force in [80.0, -80.0] {
            let case = case(&rack(side, force));
            let case = at(&case, 1.0, 0.0);
            // The teeth hold the rack: T acts on the pinion, −T on the rack.
            assert!((case.reaction("mesh.tooth") - force).abs() < ROUNDING);
            let separating = force.abs() * tangent() * side;
            close(case.pin("C"), vec2(-force, -separating));
            // The rack is pushed the other way, and its guide holds it. It has gone r φ on from where its point was at
            // the pitch point.
            assert!((case.reaction("guide.normal") - separating).abs() < ROUNDING);
            let moment = case.reaction("guide.moment");
            let expected = -0.02 * separating.abs();
            assert!((moment - expected).abs() < ROUNDING, "{moment} {expected}");
        }
    }
}

const PLANETARY: &str = r#"
    [bodies]
    ground.points = { O = [0, 0] }
    sun.points = { O = [0, 0] }
    arm.points = { O = [0, 0], C = [0.05, 0] }
    planet.points = { C = [0, 0] }
    [joints]
    O = { revolute = ["ground.O", "sun.O"] }
    arm-pin = { revolute = ["ground.O", "arm.O"] }
    C = { revolute = ["arm.C", "planet.C"] }
    inner = { gear = ["sun.O", "planet.C"], radii = [0.03, 0.02], pressure-angle = 0.35 }
    outer = { gear = ["ground.O", "planet.C"], radii = [0.07, 0.02], internal = true, pressure-angle = 0.44 }
    [actuators]
    phi = { angle = ["ground", "sun"] }
    [assembly]
    phi = 0.4
    arm = 0.0
    planet = 0.0
    [loads]
    load = { torque = "arm", magnitude = -12.0 }
"#;

/// The moments about the planet's centre: sun and ring push it with the same tangential force T, and the arm holds it with
/// 2 T, so T = M/(2 · 50 mm). The sun pushes the planet outwards, the ring inwards.
#[test]
fn the_pin_of_a_planet_carries_the_difference_of_two_separating_forces() {
    let planetary = case(PLANETARY);
    for q in [0.4, 1.7, -2.2] {
        let case = at(&planetary, q, 0.0);
        let tooth = 12.0 / 0.1;
        let [sun, ring] = [ALPHA, 0.44].map(|angle| tooth * angle.tan());
        let u = Vec2::from_angle(0.3 * q + ARM_OFFSET);
        close(case.pin("C"), u.perp() * (-2.0 * tooth) + u * (ring - sun));
        // The ground holds the sun alone.
        assert!((case.pin("O").norm() - tooth / ALPHA.cos()).abs() < ROUNDING);
    }
}

/// The arm turns by 0.3 of the sun: from where it is at assembly, at 0.
const ARM_OFFSET: f64 = -0.3 * 0.4;

/// The friction of a pin answers to |T|/cos α: r₂ T = −M + µ r |T|/cos α tanh(ω/ω₀), with T against M.
#[test]
fn friction_sees_the_separating_force() {
    let friction = "\n[friction]\nB = { coefficient = 0.15, radius = 0.008 }\n";
    let text = gears([0.03, 0.02], false, 0.9, 3.0, WITH_ANGLE) + friction;
    let case = case(&text);
    let case = at(&case, 0.3, -2.0);
    // The second gear turns with +3 rad/s, and friction brakes it.
    let lever = 0.15 * 0.008 * (3.0_f64 / 0.01).tanh();
    let cosine = ALPHA.cos();
    let tooth = -3.0 / (0.02 + lever / cosine);
    assert!((case.reaction("mesh.tooth") - tooth).abs() < ROUNDING);
    let couple = case.magnitude("B.friction");
    assert!(
        (couple + lever * tooth.abs() / cosine).abs() < ROUNDING,
        "{couple}"
    );
    let separating = case.magnitude("mesh.separating");
    assert!((separating - tooth.abs() * tangent()).abs() < ROUNDING);
}

const MOVING: &str = include_str!("separating.toml");

fn without_angle(text: &str) -> String {
    let plain = text.replace(", pressure-angle = 0.35", "");
    assert_ne!(plain, text);
    plain
}

/// Whatever moves and is loaded: the actuator and the tooth force do not know the separating force, every other reaction
/// has its unit response times it, and it takes no power.
#[test]
fn a_separating_force_does_no_work_and_adds_its_unit_response() {
    let (with, without) = (case(MOVING), case(&without_angle(MOVING)));
    let body_forces = FreeBodyForces::new(&with.model).expect("every reaction");
    let separating = with.model.loads().len() - 1;
    assert_eq!(with.model.loads()[separating].name, "mesh.separating");
    let mut unit = with.model.result_buffer();
    let mut largest_share = 0.0_f64;
    let (mut memory, mut other) = (with.memory(), with.memory());
    for (t, q, q_dot, q_ddot) in with.states() {
        let state = with.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
        let plain = without.result(t, &q, &q_dot, &q_ddot);
        let result = state.inverse_dynamics();
        let force = state.loads().magnitude[separating];
        let tooth = with.reaction(result, "mesh.tooth");
        with.evaluate(&mut other, t, &q, &q_dot, &q_ddot)
            .into_kinematic_state()
            .unit_load_response(separating, &mut unit)
            .expect("gears apart");
        let reactions = result.reactions.iter();
        let size = reactions.fold(1.0_f64, |s, r| s.max(r.abs()));
        assert!((force - tooth.abs() * tangent()).abs() < 1e-14 * size);
        assert!((result.tau[0] - plain.tau[0]).abs() < 1e-13 * size);
        let all = result.reactions.iter().zip(&plain.reactions);
        for ((found, plain), response) in all.zip(&unit.reactions) {
            assert!((found - (plain + response * force)).abs() < 1e-13 * size);
            largest_share = largest_share.max((found - plain).abs() / size);
        }
        let power = state.power_balance();
        assert!(power.residual().abs() < 1e-13 * power.scale);
        let mut powers = vec![0.0; separating + 1];
        state.load_powers(&mut powers);
        assert!(powers[separating].abs() < 1e-13 * power.scale);
        let mut wrenches = Vec::new();
        body_forces.wrenches(&state, &mut wrenches);
        let shaking = body_forces.shaking_force(&state, &wrenches);
        let difference = shaking.from_momentum.force - shaking.from_reactions.force;
        assert!(difference.norm() < 1e-12 * size);
    }
    assert!(largest_share > 0.1, "{largest_share}");
}

/// A model that computes no reaction has no separating force either: its motion is the same to the last bit.
#[test]
fn without_reactions_nothing_changes_at_all() {
    let (with, without) = (case(MOVING), case(&without_angle(MOVING)));
    let [with_model, without_model] = [&with, &without].map(|case| case.model.without_reactions());
    assert!(with_model.reactions().is_empty() && with_model.frictions().len() == 0);
    let tau = |model: &Model, q: &[f64], q_dot: &[f64], q_ddot: &[f64]| {
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        model
            .kinetostatics(0.0, q, q_dot, q_ddot, &mut workspace, &mut result)
            .expect("a pose");
        result.tau[0]
    };
    for (_, q, q_dot, q_ddot) in with.states() {
        let [a, b] = [&with_model, &without_model].map(|model| tau(model, &q, &q_dot, &q_ddot));
        assert_eq!(a.to_bits(), b.to_bits());
    }
    assert!(with_model.is_conservative(with_model.loads().len() - 1));
}

#[test]
fn a_separating_force_belongs_to_teeth() {
    let case = case(&without_angle(MOVING));
    let joints = &case.mechanism.joints;
    let id = |name: &str| JointId(joints.iter().position(|j| j.name == name).expect("a joint"));
    let of = |name: &str, angle: f64| Load::separating(&joints[id(name).0], id(name), angle);
    assert_eq!(of("A", 0.3), None);
    let load = of("mesh", 0.3).expect("teeth");
    assert_eq!(load.name, "mesh.separating");
    let message = |load: Load| {
        let error = case.model.clone().with_loads(vec![load]).err();
        error.map_or("", |e| e.what)
    };
    assert_eq!(message(load.clone()), "");
    for angle in [0.0, -0.3, 1.0, f64::NAN] {
        let wrong = of("mesh", angle).expect("teeth");
        let expected = "its pressure angle must be above 0 and at most 45°";
        assert_eq!(message(wrong), expected);
    }
    let LoadKind::Special(mut mesh) = load.kind else {
        panic!("{load:?}");
    };
    mesh.points[0].x += 0.01;
    let elsewhere = Load {
        kind: LoadKind::Special(mesh),
        ..load.clone()
    };
    let expected = "its joint is no gear pair or rack with these teeth";
    assert_eq!(message(elsewhere), expected);
    mesh.points[0].x = f64::NAN;
    let nowhere = Load {
        kind: LoadKind::Special(mesh),
        magnitude: Magnitude::Constant(1.0),
        ..load
    };
    assert!(message(nowhere).contains("must be finite"));
}

/// Two planets share the load in a way that rigid bodies do not determine: their tooth forces have no value.
#[test]
fn an_indeterminate_tooth_force_has_no_separating_force() {
    let second_planet = r#"
        D = { revolute = ["arm.D", "second.D"] }
        inner-two = { gear = ["sun.O", "second.D"], radii = [0.03, 0.02] }
        outer-two = { gear = ["ground.O", "second.D"], radii = [0.07, 0.02], internal = true }
        [actuators]
    "#;
    let two = PLANETARY
        .replace("C = [0.05, 0] }", "C = [0.05, 0], D = [-0.05, 0] }")
        .replace("[joints]", "second.points = { D = [0, 0] }\n[joints]")
        .replace("planet = 0.0", "planet = 0.0\n    second = 0.0")
        .replace("[actuators]", second_planet);
    let scene = PlaneScene::parse("test.toml", &two).expect("a scene");
    let assembly = scene.assembly.to_configuration();
    let model = Model::new(
        &scene.mechanism,
        &scene.masses,
        &assembly,
        &scene.mechanism.reactions(),
    );
    let error = model.expect("it assembles").with_loads(scene.loads.clone());
    let error = error.map(|_| ()).expect_err("no value");
    assert_eq!(scene.loads[error.load].name, "inner.separating");
    assert!(error.what.contains("statically indeterminate"), "{error}");
}
