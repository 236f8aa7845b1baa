//! Planar parts of mechanisms in space, with planes and without; and what a planar mechanism's joints bear across its plane.

use dwell_geometry::space::{
    Actuator, Assembly, Joint, JointKind, Mechanism, Placement, Rotation, Side, Vec3, vec3,
};
use dwell_geometry::{Body, BodyId, Vec2};
use dwell_kinetostatics::space::{Axes, Mass, Model};
use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel, ReducibleModel};
use dwell_tests::fixtures;
use dwell_tests::lifted::{Lifted, crank_rocker_and_rod, lifted_scene, tilt, wrenches};

/// The same model with planes and without.
fn both(mechanism: &Mechanism, masses: &[Mass], assembly: &Assembly) -> [Model; 2] {
    let all = wrenches(mechanism.joints.len(), Axes::Ground);
    [Model::new, Model::without_planes].map(|new| {
        let model = new(mechanism, masses, assembly, &all);
        model.unwrap_or_else(|e| panic!("{e}"))
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// The largest difference over the largest value, of those that are determined.
fn relative(found: &[f64], wanted: &[f64], determined: &[bool]) -> f64 {
    let pairs = found.iter().zip(wanted).zip(determined);
    let differences = pairs.filter(|(_, determined)| **determined);
    let difference = differences.map(|((f, w), _)| (f - w).abs());
    let difference = difference.fold(0.0_f64, |a, b| if b > a || b.is_nan() { b } else { a });
    let largest = largest(wanted);
    assert!(
        largest > 0.0 && difference.is_finite(),
        "{found:?}, {wanted:?}"
    );
    difference / largest
}

/// The crank-rocker that drives a rod in space: two equations where there were five, and the same numbers.
#[test]
fn a_planar_part_of_a_mechanism_in_space_is_solved_in_its_plane() {
    let Lifted {
        mechanism,
        masses,
        assembly,
    } = crank_rocker_and_rod();
    let [with, without] = both(&mechanism, &masses, &assembly);
    let equations = |model: &Model| {
        let groups = model.plan().described_groups();
        groups.iter().map(|g| g.equations).collect::<Vec<_>>()
    };
    assert_eq!(equations(&with), [2, 4]);
    assert_eq!(equations(&without), [5, 4]);
    let [Some((from, to)), Some(limits)] =
        [&with, &without].map(|model| model.plan().range().limits())
    else {
        panic!("the rod limits the range");
    };
    assert!((from - limits.0).abs() + (to - limits.1).abs() < 1e-8);
    assert_eq!(with.plan().mobility(), without.plan().mobility());
    assert!(with.plan().planar_equivalent(&mechanism).is_none());
    let [mut one, mut other] = [&with, &without].map(Model::workspace::<f64>);
    let [mut found, mut wanted]: [Coefficients; 2] =
        [&with, &without].map(Model::coefficient_buffer);
    let determined = with.determined(&[1.0], &mut one).expect("a pose");
    assert_eq!(
        determined,
        without.determined(&[1.0], &mut other).expect("a pose")
    );
    assert!(determined.contains(&true) && determined.contains(&false));
    let mut worst = [0.0_f64; 4];
    for k in 0..24 {
        let q = from + (to - from) * (0.05 + 0.9 * f64::from(k) / 23.0);
        with.reduce(q, &mut one, &mut found).expect("a pose");
        without.reduce(q, &mut other, &mut wanted).expect("a pose");
        let here = [
            (found.m / wanted.m - 1.0).abs(),
            (found.half_dm - wanted.half_dm).abs() / wanted.m,
            relative(&found.a, &wanted.a, &determined),
            relative(&found.b, &wanted.b, &determined),
        ];
        worst
            .iter_mut()
            .zip(here)
            .for_each(|(worst, here)| *worst = worst.max(here));
    }
    println!("{worst:?}");
    assert!(worst.iter().all(|part| *part < 1e-12), "{worst:?}");
}

/// A crank-rocker on a turntable: its plane moves, in two coordinates.
#[test]
fn a_plane_may_move() {
    let scene = fixtures::scene("crank-rocker");
    let (_, lifted) = lifted_scene(&scene).expect("four revolute joints");
    let Lifted {
        mut mechanism,
        mut masses,
        mut assembly,
    } = lifted;
    // What was the ground is a table, which turns about an oblique axis of a new ground.
    let table = mechanism.ground;
    mechanism.ground = mechanism.bodies.len();
    mechanism.bodies.push(Body::named("new ground"));
    let side = Side {
        axis: vec3(0.2, 0.3, 1.0),
        ..Side::default()
    };
    let bodies = [mechanism.ground, table];
    let bearing = Joint::new("turntable", bodies, JointKind::Revolute, [side; 2]);
    mechanism
        .actuators
        .push(Actuator::angle("turn", mechanism.joints.len()));
    mechanism.joints.push(bearing);
    masses[table] = Mass {
        mass: 2.0,
        center: vec3(0.1, 0.2, 0.3),
        inertia: [0.3, 0.4, 0.5, 0.0, 0.0, 0.0],
    };
    masses.push(Mass::default());
    assembly.placements.push(Placement::default());
    assembly.q.push(0.0);
    let [with, without] = both(&mechanism, &masses, &assembly);
    let groups = with.plan().described_groups();
    assert_eq!((groups.len(), groups[0].equations), (1, 2));
    let [mut one, mut other] = [&with, &without].map(Model::workspace::<f64>);
    let [mut found, mut wanted] = [&with, &without].map(Model::result_buffer::<f64>);
    let start = assembly.q[0];
    let mut worst = [0.0_f64; 2];
    for step in [-0.9, 0.2, 0.8] {
        let q = [start + step, 2.0 * step];
        let (rates, accelerations) = ([1.3, -0.8], [0.4, 0.9]);
        let determined = with.determined(&q, &mut one).expect("a pose");
        for (model, work, found) in [
            (&with, &mut one, &mut found),
            (&without, &mut other, &mut wanted),
        ] {
            let done = model.inverse_dynamics(&q, &rates, &accelerations, work, found);
            done.expect("a pose");
        }
        worst[0] = worst[0].max(relative(&found.tau, &wanted.tau, &[true; 2]));
        let here = relative(&found.reactions, &wanted.reactions, &determined);
        worst[1] = worst[1].max(here);
    }
    println!("{worst:?}");
    // Seen: 1.4e-15.
    assert!(worst.iter().all(|part| *part < 1e-13), "{worst:?}");
}

/// The crank-rocker with a cylindrical joint at B and a ball at C, so that nothing is redundant, and bodies whose centres are off the plane
/// with products of inertia. With the height z of a centre above the joints, and the axes x and y of a body in the plane with normal n,
/// a body requires across the plane
///
/// ```text
/// N = z n × m a + α (I_xz x + I_yz y) + ω² (I_xz y − I_yz x)
/// ```
///
/// and no force along n. The ball bears no moment, the cylindrical joint no force along n; so D bears the rocker's N, B the coupler's, and A the
/// coupler's and the crank's.
#[test]
fn moments_across_the_plane_are_those_derived_by_hand() {
    let scene = fixtures::scene("crank-rocker");
    let (planar, mut lifted) = lifted_scene(&scene).expect("four revolute joints");
    let z = [0.0, 0.11, -0.07, 0.05];
    let products = [[0.0; 2], [0.03, -0.02], [0.21, 0.13], [-0.17, 0.08]];
    let ground = tilt();
    for (j, joint) in lifted.mechanism.joints.iter_mut().enumerate() {
        joint.kind = [
            JointKind::Revolute,
            JointKind::Cylindrical,
            JointKind::Spherical,
            JointKind::Revolute,
        ][j];
        for (side, body) in joint.sides.iter_mut().zip(joint.bodies) {
            // All joints in the plane.
            let height = 0.04 * j as f64;
            let normal = match body.0 {
                0 => ground.rotation.columns[2],
                _ => vec3(0.0, 0.0, 1.0),
            };
            side.point -= normal.scaled(height);
        }
    }
    for (b, mass) in lifted.masses.iter_mut().enumerate().skip(1) {
        mass.center.z = z[b];
        let i = mass.inertia[2];
        mass.inertia = [i, i, i, 0.0, products[b][0], products[b][1]];
    }
    let Lifted {
        mechanism,
        masses,
        assembly,
    } = lifted;
    let [with, without] = both(&mechanism, &masses, &assembly);
    let mut planar_work = planar.workspace();
    let mut worst = 0.0_f64;
    let planar_reactions = with.clone().for_coefficients();
    assert!(planar_reactions.is_in_plane() && !with.is_in_plane());
    for model in [&with, &without, &planar_reactions] {
        let mut work = model.workspace::<f64>();
        let mut found: Coefficients = model.coefficient_buffer();
        let determined = model.determined(&[0.7], &mut work).expect("a pose");
        assert!(determined.iter().all(|d| *d));
        for q in [0.7, 2.9, 5.0] {
            model.reduce(q, &mut work, &mut found).expect("a pose");
            let state = planar.kinematic_state(&[q], &[1.0], &mut planar_work);
            let mut state = state.expect("a pose");
            let states = state.bodies_at(&[0.0]);
            // By body: what it requires at unit acceleration from rest, and at unit speed.
            let required = |b: usize| {
                let body = states.body(BodyId(b));
                let center = masses[b].center;
                let at = states.point(
                    BodyId(b),
                    Vec2 {
                        x: center.x,
                        y: center.y,
                    },
                );
                let flat = |v: Vec2| vec3(v.x, v.y, 0.0);
                let (x, y) = (flat(body.rotation), flat(body.rotation.perp()));
                let [xz, yz] = products[b];
                let of = |a: Vec2, alpha: f64, square: f64| {
                    let force = flat(a).scaled(masses[b].mass * z[b]);
                    vec3(0.0, 0.0, 1.0).cross(force)
                        + (x.scaled(xz) + y.scaled(yz)).scaled(alpha)
                        + (y.scaled(xz) - x.scaled(yz)).scaled(square)
                };
                let w = body.angular_velocity;
                [
                    of(at.velocity, w, 0.0),
                    of(at.acceleration, body.angular_acceleration, w * w),
                ]
            };
            let [crank, coupler, rocker] = [1, 2, 3].map(required);
            for (k, values) in [&found.a, &found.b].into_iter().enumerate() {
                let part = |joint: usize, first: usize| {
                    let at = &values[6 * joint + first..];
                    ground.rotation.apply_inverse(vec3(at[0], at[1], at[2]))
                };
                let zero = Vec3::ZERO;
                let wanted = [crank[k] + coupler[k], coupler[k], zero, rocker[k]];
                for (joint, wanted) in wanted.into_iter().enumerate() {
                    let moment = part(joint, 3);
                    let across = vec3(moment.x, moment.y, 0.0) - wanted;
                    worst = worst.max(across.norm()).max(part(joint, 0).z.abs());
                }
            }
        }
    }
    // Of moments of some newton metres. Seen: 4e-15.
    println!("{worst:.1e}");
    assert!(worst < 4e-13, "{worst:e}");
}

/// An axis that is oblique by a thousandth is not that of the plane: the loop is solved as one in space, and does not close otherwise.
#[test]
fn nearly_parallel_axes_make_no_plane() {
    let scene = fixtures::scene("crank-rocker");
    let (_, lifted) = lifted_scene(&scene).expect("four revolute joints");
    let Lifted {
        mut mechanism,
        masses,
        assembly,
    } = lifted;
    // B may be oblique where C is a ball and D a tube's axis.
    let kinds = [
        JointKind::Revolute,
        JointKind::Revolute,
        JointKind::Spherical,
        JointKind::Cylindrical,
    ];
    for (joint, kind) in mechanism.joints.iter_mut().zip(kinds) {
        joint.kind = kind;
    }
    let straight = Model::new(&mechanism, &masses, &assembly, &[]).expect("a model");
    let turn = Rotation::of_vector(vec3(1e-3, 0.0, 0.0));
    let straight = (straight, mechanism.clone());
    for side in &mut mechanism.joints[1].sides {
        (side.axis, side.normal) = (turn.apply(side.axis), turn.apply(side.normal));
    }
    let oblique = Model::new(&mechanism, &masses, &assembly, &[]).expect("a model");
    let plane = |(model, of): &(Model, Mechanism)| model.plan().planar_equivalent(of).is_some();
    assert!(plane(&straight) && !plane(&(oblique, mechanism)));
}

/// A crank and a rocker in an oblique plane that a rod between two balls connects, whose second ball is higher by so much.
fn crank_rod_and_rocker(rise: f64) -> Lifted {
    let frame = tilt();
    let z = vec3(0.0, 0.0, 1.0);
    let on_ground = |point: Vec3| Side {
        point: frame.position + frame.rotation.apply(point),
        axis: frame.rotation.columns[2],
        normal: frame.rotation.columns[0],
    };
    let on_body = |point: Vec3| Side {
        point,
        axis: z,
        normal: vec3(1.0, 0.0, 0.0),
    };
    let hinge = |name: &str, body: usize, at: Vec3, height: f64| {
        let sides = [on_ground(at), on_body(vec3(0.0, 0.0, height))];
        Joint::new(name, [0, body], JointKind::Revolute, sides)
    };
    let length = 2.0_f64.hypot(rise);
    let ends = [vec3(0.5, 0.0, 0.1), vec3(1.5, 0.0, 0.1 + rise)].map(on_body);
    let rod = JointKind::Distance { length };
    let body = |center: Vec3| Mass {
        mass: 1.2,
        center,
        inertia: [0.2, 0.25, 0.3, 0.01, 0.04, -0.03],
    };
    let place = |x: f64, angle: f64| Placement {
        position: frame.position + frame.rotation.apply(vec3(x, 0.0, 0.0)),
        rotation: frame.rotation.after(&Rotation::of_vector(z.scaled(angle))),
    };
    Lifted {
        mechanism: Mechanism {
            bodies: ["ground", "crank", "rocker"].map(Body::named).into(),
            ground: 0,
            joints: vec![
                hinge("A", 1, Vec3::ZERO, 0.0),
                hinge("D", 2, vec3(2.0, 0.0, 0.2), 0.2),
                Joint::new("rod", [1, 2], rod, ends),
            ],
            actuators: vec![Actuator::angle("q", 0)],
            couplings: Vec::new(),
        },
        masses: vec![
            Mass::default(),
            body(vec3(0.2, 0.05, -0.1)),
            body(vec3(0.7, -0.1, 0.3)),
        ],
        assembly: Assembly {
            q: vec![0.7],
            placements: vec![Placement::default(), place(0.0, 0.7), place(2.0, 1.6)],
        },
    }
}

/// A rod that rises from the plane has a force along the normal: m is that of a planar mechanism with its projection as the rod, and the reactions
/// are those of space.
#[test]
fn a_rod_may_rise_from_the_plane() {
    for rise in [0.0, 0.3] {
        let Lifted {
            mechanism,
            masses,
            assembly,
        } = crank_rod_and_rocker(rise);
        let [with, without] = both(&mechanism, &masses, &assembly);
        assert!(with.for_inertia().is_in_plane(), "{rise}");
        let reduced = ExactModel::new(with).expect("one actuator");
        assert_eq!(reduced.model().is_in_plane(), rise == 0.0);
        let (mut work, mut other) = (reduced.workspace(), without.workspace::<f64>());
        let mut found = reduced.coefficient_buffer();
        let mut wanted: Coefficients = without.coefficient_buffer();
        let mut worst = [0.0_f64; 4];
        for k in 0..12 {
            let q = 0.5 * f64::from(k);
            reduced
                .coefficients(q, &mut work, &mut found)
                .expect("a pose");
            without.reduce(q, &mut other, &mut wanted).expect("a pose");
            let (m, half_dm) = reduced.inertia(q, &mut work).expect("a pose");
            let all = vec![true; wanted.a.len()];
            let here = [
                (m / wanted.m - 1.0).abs(),
                (half_dm - wanted.half_dm).abs() / wanted.m,
                relative(&found.a, &wanted.a, &all),
                relative(&found.b, &wanted.b, &all),
            ];
            let pairs = worst.iter_mut().zip(here);
            pairs.for_each(|(worst, here)| *worst = worst.max(here));
        }
        println!("{rise}: {worst:?}");
        assert!(worst.iter().all(|part| *part < 1e-13), "{rise}: {worst:?}");
    }
}
