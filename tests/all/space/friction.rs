//! Dry friction in space at prescribed states: closed forms of blocks and tubes, the dense equations, and a planar mechanism
//! placed obliquely.

use super::oblique::{G, SMOOTH, oblique_slider_crank, planar_slider_crank, scene, written};
use dwell_geometry::JointId;
use dwell_geometry::space::{Joint, JointKind, Placement, Vec3, Wrench, vec3};
use dwell_kinetostatics::space::{Axes, Component, LoadKind, Model, Reaction};
use dwell_kinetostatics::{
    Friction, FrictionContact, LoadShape as _, MachineModel as _, Magnitude,
};
use dwell_scene::SpaceScene;
use dwell_study::model_with_loads;
use dwell_verify::space::DenseSpace;

fn model(scene: &SpaceScene) -> Model {
    model_with_loads(scene, &scene.requests.reactions).unwrap_or_else(|e| panic!("{e}"))
}

/// Part of a vector across a unit vector.
fn across(v: Vec3, u: Vec3) -> Vec3 {
    v - u.scaled(u.dot(v))
}

/// The sum of the forces in two bearings at distance `l`, by the forces themselves.
fn press(force: Vec3, moment: Vec3, u: Vec3, l: f64) -> f64 {
    let force = across(force, u);
    if l == 0.0 {
        return force.norm();
    }
    // f₁ + f₂ = F,  l/2 u × (f₁ − f₂) = M across u
    let difference = across(moment, u).cross(u).scaled(2.0 / l);
    let [one, two] = [1.0, -1.0].map(|side| (force + difference.scaled(side)).scaled(0.5));
    one.norm() + two.norm()
}

const MASS: f64 = 2.3;

/// A block on a guide in any direction, its centre off the guide: gravity, keys of its friction, and further sections.
pub(super) fn block(axis: Vec3, center: Vec3, keys: &str, rest: &str) -> String {
    format!(
        "bodies.ground.points = {{ A = [0.1, 0.2, 0.3] }}\n\
         bodies.block = {{ points = {{ A = [0, 0, 0] }}, mass = {MASS}, center = {}, inertia = [0.01, 0.02, 0.015] }}\n\
         joints.guide = {{ prismatic = [\"ground.A\", \"block.A\"], axis = {} }}\n\
         actuators.x = {{ travel = \"guide\" }}\nassembly.x = 0.0\n\
         loads.weight = {{ gravity = [0, 0, -{G}] }}\nfriction.guide = {{ {keys} }}\n{rest}\n",
        written(center),
        written(axis)
    )
}

/// The actuator's force on a block in motion: what its inertia and the weight leave, and µ N tanh(v/v₀) against the velocity, with N
/// from the balance of forces and moments.
#[test]
fn a_block_on_an_oblique_guide_rubs_with_its_normal_forces() {
    let (mu, slow) = (0.31, 0.02);
    let gravity = vec3(0.0, 0.0, -G);
    let mut largest = 0.0_f64;
    for (axis, center, length) in [
        (vec3(0.6, 0.48, 0.64), vec3(0.0, 0.0, 0.0), 0.0),
        (vec3(0.6, 0.48, 0.64), vec3(0.04, -0.07, 0.02), 0.0),
        (vec3(0.6, 0.48, 0.64), vec3(0.04, -0.07, 0.02), 0.09),
        (vec3(-0.28, 0.0, 0.96), vec3(0.01, 0.05, -0.3), 0.4),
        (vec3(0.0, 1.0, 0.0), vec3(0.2, 0.0, 0.1), 0.05),
    ] {
        let keys =
            format!("coefficient = {mu}, guide-length = {length:?}, regularization-speed = {slow}");
        let scene = scene(&block(axis, center, &keys, ""));
        let model = model(&scene);
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        for [v, a] in [[0.5, -2.0], [-0.4, 3.0], [0.01, 1.0], [0.0, -4.0]] {
            let at = [&[0.3][..], &[v][..], &[a][..]];
            let state = model.kinetostatics(0.0, at, &mut workspace, &mut result);
            let state = state.expect("a state");
            // What the guide does to the block, about the block's point.
            let needed = (axis.scaled(a) - gravity).scaled(MASS);
            let n = press(needed, center.cross(needed), axis, length);
            let factor: f64 = mu * (v / slow).tanh();
            let friction = -factor * n;
            let force = axis.dot(needed) - friction;
            let [found, power] = [state.magnitudes()[1], state.load_power(1)];
            let tau = state.inverse_dynamics().tau[0];
            for (found, wanted) in [(found, friction), (tau, force), (power, friction * v)] {
                let off = (found - wanted).abs() / (MASS * G);
                largest = largest.max(off);
                assert!(off < 1e-14, "{axis:?}, {v}: {found} for {wanted}");
            }
        }
    }
    // Seen: 2e-16.
    println!("a block on a guide: {largest:.1e}");
}

/// In a cylindrical joint the friction is against the velocity of the pin's surface: its force and couple are as v to r²ω, its power
/// is −µ tanh(s/v₀) N s.
#[test]
fn a_tube_rubs_against_the_velocity_of_its_surface() {
    let (mu, radius, slow) = (0.17, 0.03, 0.01);
    let axis = vec3(0.36, -0.48, 0.8);
    let gravity = vec3(0.0, 0.0, -G);
    let mut largest = 0.0_f64;
    for (offset, distance) in [(0.0, 0.0), (0.11, 0.0), (0.11, 0.08)] {
        // The centre on the axis: no inertia force across it, wherever the body turns.
        let center = axis.scaled(offset);
        let text = format!(
            "bodies.ground.points = {{ A = [0.1, 0.2, 0.3] }}\n\
             bodies.rod = {{ points = {{ A = [0, 0, 0] }}, mass = {MASS}, center = {}, inertia = [0.02, 0.02, 0.02] }}\n\
             joints.tube = {{ cylindrical = [\"ground.A\", \"rod.A\"], axis = {} }}\n\
             actuators.x = {{ travel = \"tube\" }}\nactuators.phi = {{ angle = \"tube\" }}\n\
             loads.weight = {{ gravity = [0, 0, -{G}] }}\n\
             friction.tube = {{ coefficient = {mu}, radius = {radius}, bearing-distance = {distance:?}, regularization-speed = {slow} }}\n",
            written(center),
            written(axis)
        );
        let scene = scene(&text);
        let model = model(&scene);
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        let needed = gravity.scaled(-MASS);
        let n = press(needed, center.cross(needed), axis, distance);
        for [v, w] in [
            [0.5, 0.0],
            [0.0, -20.0],
            [0.3, 7.0],
            [-0.2, 11.0],
            [0.002, 0.05],
            [1e-9, 2e-8],
        ] {
            let at = [&[0.1, 0.7][..], &[v, w][..], &[0.0, 0.0][..]];
            let state = model.kinetostatics(0.0, at, &mut workspace, &mut result);
            let state = state.expect("a state");
            let s = f64::hypot(v, radius * w);
            let drag: f64 = mu * n * (s / slow).tanh();
            let [force, couple] = [state.magnitudes()[1], state.magnitudes()[2]];
            let power = state.load_power(1) + state.load_power(2);
            let tau = &state.inverse_dynamics().tau;
            for (found, wanted, unit) in [
                (force, -drag * v / s, 1.0),
                (couple, -drag * radius * radius * w / s, radius),
                (power, -drag * s, s),
                (tau[0], drag * v / s + axis.dot(needed), 1.0),
                (tau[1], drag * radius * radius * w / s, radius),
            ] {
                let off = (found - wanted).abs() / (MASS * G * unit);
                largest = largest.max(off);
                assert!(off < 1e-14, "{v}, {w}: {found} for {wanted}");
            }
        }
    }
    // Seen: 3e-16.
    println!("a tube: {largest:.1e}");
}

/// Friction in several joints of loops, which depend on each other.
const RUBBING: [(&str, [&str; 2], usize); 4] = [
    (
        "rssr",
        [
            "friction.A = { coefficient = 0.2, radius = 0.02, bearing-distance = 0.05, regularization-speed = 0.3 }\n\
         friction.D = { coefficient = 0.15, radius = 0.015, regularization-speed = 0.2, viscous = 0.01 }\n",
            "",
        ],
        2,
    ),
    (
        "slider-crank-haug",
        [
            "friction.A = { coefficient = 0.1, radius = 0.01, regularization-speed = 0.3 }\n\
         friction.D = { coefficient = 0.12, guide-length = 0.06, regularization-speed = 0.01 }\n",
            "",
        ],
        2,
    ),
    (
        "planar-oblique-rcsr",
        [
            "friction.A = { coefficient = 0.1, radius = 0.1, bearing-distance = 0.5, regularization-speed = 0.3 }\n\
         friction.B = { coefficient = 0.2, radius = 0.1, regularization-speed = 0.02 }\n\
         friction.D = { coefficient = 0.1, radius = 0.1 }\n",
            "[loads]\nweight = { gravity = [1, 2, -9] }\nside = { force = \"coupler.C\", direction = [1, -2, 2], magnitude = 20 }\n",
        ],
        4,
    ),
    // Redundant, but what the radial forces need is determined.
    (
        "planar-oblique-4r",
        [
            "friction.A = { coefficient = 0.1, radius = 0.1, regularization-speed = 0.3 }\n\
         friction.B = { coefficient = 0.2, radius = 0.1, regularization-speed = 0.2 }\n\
         friction.C = { coefficient = 0.2, radius = 0.08 }\n\
         friction.D = { coefficient = 0.1, radius = 0.1 }\n",
            "",
        ],
        4,
    ),
];

/// A scene of `validation/spatial` with dotted keys before its tables, and with more tables behind them.
pub(super) fn rubbing(name: &str, keys: &str, tables: &str) -> SpaceScene {
    let path = format!(
        "{}/../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let file = std::fs::read_to_string(path).expect("the file");
    scene(&format!("{keys}{file}\n{tables}"))
}

/// The friction of a joint at a force and a moment, by the formulas of the documents.
fn friction_of(
    friction: Friction,
    (joint, kind): (JointKind, LoadKind),
    wrench: Wrench,
    axis: Vec3,
    [v, w]: [f64; 2],
) -> f64 {
    let mu = friction.coefficient;
    let smooth = |speed: f64| match friction.regularization_speed {
        Some(slow) => (speed / slow).tanh(),
        None => speed.signum(),
    };
    let (radius, distance) = match friction.contact {
        FrictionContact::Guide { length } => (f64::NAN, length),
        FrictionContact::Bearing { radius, distance } => (radius, distance),
        FrictionContact::Pin { .. } => (f64::NAN, f64::NAN),
    };
    let limit = -mu * press(wrench.force, wrench.moment, axis, distance);
    let s = f64::hypot(v, radius * w);
    match (joint, kind) {
        (JointKind::Prismatic, _) => limit * smooth(v),
        (JointKind::Revolute, _) => limit * radius * smooth(w),
        (_, kind) if !kind.is_couple() => limit * smooth(s) * v / s,
        _ => limit * radius * smooth(s) * radius * w / s,
    }
}

/// With the friction that is found the dense equations in body coordinates have these reactions and actions, and from their reactions
/// follows this friction; the powers balance.
#[test]
fn friction_agrees_with_the_dense_equations() {
    let mut largest = [0.0_f64; 3];
    for (name, [keys, tables], count) in RUBBING {
        let scene = rubbing(name, keys, tables);
        let model = model(&scene);
        assert_eq!(model.frictions().len(), count, "{name}");
        let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
        for [q, q_dot, q_ddot] in [
            [0.3, 2.0, -3.0],
            [-0.4, -1.1, 4.0],
            [0.9, 0.1, 0.0],
            [0.05, 5.0, 1.0],
        ] {
            let q = scene.assembly.q[0] + q;
            let at = [&[q][..], &[q_dot][..], &[q_ddot][..]];
            let state = model.kinetostatics(0.0, at, &mut workspace, &mut result);
            let state = state.unwrap_or_else(|e| panic!("{name}: {e}"));
            let magnitudes = state.magnitudes().to_vec();
            let mut pose = model.plan().pose();
            model.plan().positions(&[q], &mut pose).expect("a pose");
            let bodies = 0..scene.mechanism.bodies.len();
            let placements: Vec<Placement> =
                bodies.map(|b| model.plan().placement(&pose, b)).collect();
            let kinds = scene.loads.iter().map(|load| load.kind);
            let loads: Vec<_> = kinds.zip(magnitudes.iter().copied()).collect();
            let rates = [&[q_dot][..], &[q_ddot][..]];
            let (mechanism, masses) = (&scene.mechanism, &scene.masses);
            let dense = DenseSpace::new(mechanism, masses, &placements, rates, &loads);
            let dense = dense.expect("equations");
            let scale = state.inverse_dynamics().reactions.iter();
            let scale = scale.fold(1.0_f64, |s, r| s.max(r.abs()));
            let tau = state.inverse_dynamics().tau[0];
            largest[0] = largest[0].max((tau - dense.actuator_actions[0]).abs() / scale);
            for (k, load) in scene.loads.iter().enumerate() {
                let Magnitude::Friction(friction) = load.magnitude else {
                    continue;
                };
                let joint = &mechanism.joints[friction.joint.0];
                let (axis, rates) = sliding(joint, &placements, &dense);
                let wrench = dense.reactions[friction.joint.0];
                let kinds = (joint.kind, load.kind);
                let wanted = friction_of(friction, kinds, wrench, axis, rates);
                largest[1] = largest[1].max((magnitudes[k] - wanted).abs() / scale);
                // Along B of the planar loop the speed is rounding.
                let loss = -state.load_power(k) / scale;
                assert!(
                    loss > if wanted.abs() > 1e-9 { 0.0 } else { -1e-12 },
                    "{name}: {loss}"
                );
            }
            // The rate of the kinetic energy, from the accelerations of the dense equations.
            let loads: f64 = (0..scene.loads.len()).map(|k| state.load_power(k)).sum();
            let rate = energy_rate(&scene, &placements, &dense);
            let powers = tau * q_dot + loads - rate;
            largest[2] = largest[2].max(powers.abs() / (scale * q_dot.abs()));
        }
        println!("{name}: {largest:?}");
    }
    // Seen: 2e-15, 7e-15 and 2e-15.
    assert!(largest.iter().all(|part| *part < 3e-13), "{largest:?}");
}

/// The axis of a joint, and the speeds along it and about it, from the motions of its bodies.
fn sliding(joint: &Joint, placements: &[Placement], dense: &DenseSpace) -> (Vec3, [f64; 2]) {
    let [a, b] = joint.bodies.map(|b| b.0);
    let axis = placements[a].rotation.apply(joint.sides[0].axis);
    let arm = placements[b].rotation.apply(joint.sides[1].point);
    let at = placements[b].position + arm;
    let (one, two) = (&dense.motions[a], &dense.motions[b]);
    let seen = two.point_velocity(arm) - one.point_velocity(at - placements[a].position);
    let turning = two.angular_velocity - one.angular_velocity;
    (axis, [axis.dot(seen), axis.dot(turning)])
}

/// Σ m v·a + ω·(Iω̇).
fn energy_rate(scene: &SpaceScene, placements: &[Placement], dense: &DenseSpace) -> f64 {
    let bodies = scene.masses.iter().zip(placements).zip(&dense.motions);
    let of = bodies.map(|((mass, placement), motion)| {
        let rotation = &placement.rotation;
        let arm = rotation.apply(mass.center);
        let tensor = |v: Vec3| rotation.apply(mass.angular_momentum(rotation.apply_inverse(v)));
        let of_mass = motion
            .point_velocity(arm)
            .dot(motion.point_acceleration(arm));
        mass.mass * of_mass
            + motion
                .angular_velocity
                .dot(tensor(motion.angular_acceleration))
    });
    of.sum()
}

/// A planar mechanism placed obliquely has the same action, friction and powers.
#[test]
fn a_planar_mechanism_with_friction_is_the_same_in_an_oblique_plane() {
    let plane = planar_slider_crank();
    let planar = dwell_study::models::loaded_model(&plane).expect("a model");
    let space = oblique_slider_crank(SMOOTH, "");
    let model = model(&space);
    let (mut one, mut wanted) = (planar.workspace(), planar.result_buffer());
    let (mut other, mut found) = (model.workspace(), model.result_buffer());
    let of = |name: &str| {
        let in_plane = plane.loads.iter().position(|l| l.name == name);
        // One load more: the friction of B along its axis.
        let about = space
            .loads
            .iter()
            .position(|l| l.name == name.replace("B.friction", "B.friction-moment"));
        in_plane.zip(about).unwrap_or_else(|| panic!("{name}"))
    };
    let mut largest = 0.0_f64;
    for k in 0..40 {
        let q = 0.17 + 0.157 * f64::from(k);
        let [q_dot, q_ddot] =
            [[150.0, 0.0], [-3.0, 400.0], [0.2, -20.0], [0.0, 10.0]][k as usize % 4];
        let state = planar.kinetostatics(0.0, &[q], &[q_dot], &[q_ddot], &mut one, &mut wanted);
        let state = state.expect("a state");
        let at = [&[q][..], &[q_dot][..], &[q_ddot][..]];
        let oblique = model.kinetostatics(0.0, at, &mut other, &mut found);
        let oblique = oblique.expect("a state");
        let reactions = state.inverse_dynamics().reactions.iter();
        let scale = reactions.fold(1.0_f64, |s, r| s.max(r.abs()));
        let tau = [
            state.inverse_dynamics().tau[0],
            oblique.inverse_dynamics().tau[0],
        ];
        let mut compare = |what: &str, [wanted, found]: [f64; 2]| {
            let off = (found - wanted).abs() / scale;
            largest = largest.max(off);
            assert!(
                off < 1e-14,
                "{what} at {q}: {found} for {wanted} of {scale}"
            );
        };
        compare("action", tau);
        for name in [
            "A.friction",
            "A.viscous",
            "B.friction",
            "guide.friction",
            "guide.viscous",
        ] {
            let (a, b) = of(name);
            compare(name, [state.magnitudes()[a], oblique.magnitudes()[b]]);
            let power = [state.load_power(a), oblique.load_power(b)];
            compare(name, power.map(|p| p / q_dot.abs().max(1.0)));
        }
    }
    // Seen: 1.4e-16 of the largest reaction.
    println!("oblique slider-crank: {largest:.1e}");
}

fn refusal(scene: &SpaceScene) -> String {
    let error = model_with_loads(scene, &scene.requests.reactions).expect_err("a refusal");
    let dwell_study::StudyError::Scene(error) = error else {
        panic!("{error}")
    };
    format!("{error:?}")
}

/// Where redundant constraints share what friction needs it is refused by the name of the joint.
#[test]
fn friction_of_an_open_reaction_is_refused() {
    let hinge = "friction.X = { coefficient = 0.1, radius = 0.01 }\n";
    for (name, joint) in [("bennett", "B"), ("bricard-a04", "P3")] {
        let text = refusal(&rubbing(name, &hinge.replace('X', joint), ""));
        let wanted = format!(
            "the friction of joint `{joint}` depends on a reaction that is not determined: redundant constraints share the load"
        );
        assert!(text.contains(&wanted), "{text}");
        assert!(text.contains("dwell check"), "{text}");
    }
    // The radial force of a planar loop is determined, the moment that tilts the pin is not.
    let radial = "friction.B = { coefficient = 0.1, radius = 0.01 }\n";
    let _ = model(&rubbing("planar-oblique-4r", radial, ""));
    let tilting = radial.replace(" }", ", bearing-distance = 0.1 }");
    let text = refusal(&rubbing("planar-oblique-4r", &tilting, ""));
    assert!(text.contains("joint `B` depends on a reaction"), "{text}");
}

/// Requested reactions are the same, whatever friction needs besides.
#[test]
fn friction_adds_its_reactions_behind_the_requested_ones() {
    let scene = rubbing("rssr", RUBBING[0].1[0], "");
    let wanted = |component| Reaction {
        joint: JointId(0),
        component,
    };
    let requested = [
        wanted(Component::Force(Axes::Joint, 1)),
        wanted(Component::Force(Axes::Ground, 2)),
    ];
    let model = model_with_loads(&scene, &requested).expect("a model");
    let all: Vec<Reaction> = model.reactions().collect();
    // Of A four, of which one is requested; of D two.
    assert_eq!((&all[..2], all.len()), (&requested[..], 7));
    assert_eq!(model.without_reactions().reactions().len(), 6);
    let rest = model.without_reactions();
    let (mut one, mut with) = (model.workspace(), model.result_buffer());
    let (mut two, mut without) = (rest.workspace(), rest.result_buffer());
    let at = [&[0.4][..], &[3.0][..], &[-5.0][..]];
    model
        .kinetostatics(0.0, at, &mut one, &mut with)
        .expect("a state");
    rest.kinetostatics(0.0, at, &mut two, &mut without)
        .expect("a state");
    assert_eq!(with.tau, without.tau);
}
