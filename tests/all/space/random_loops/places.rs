//! A mechanism in space has one set of coefficients, wherever it stands, however it is oriented, whatever its size, and wherever the frames of its bodies
//! are; the number type decides how many digits they have, and nothing else.

use super::assembled::{Assembled, DrivenBy, Random};
use dwell_geometry::space::{
    Assembly, Coordinate, JointKind, Mechanism, Placement, Rotation, Side, Vec3, vec3,
};
use dwell_geometry::{JointId, Range};
use dwell_kinetostatics::Coefficients;
use dwell_kinetostatics::space::{Axes, Component, Mass, Model, ModelError, Reaction};
use dwell_scene::SpaceScene;

/// A mechanism with what a model needs.
#[derive(Clone)]
struct Setup {
    mechanism: Mechanism,
    masses: Vec<Mass>,
    assembly: Assembly,
}

impl Setup {
    fn of_scene(name: &str, text: &str) -> Self {
        let scene = SpaceScene::parse(name, text).unwrap_or_else(|e| panic!("{name}: {e}"));
        Self {
            mechanism: scene.mechanism.clone(),
            masses: scene.masses.clone(),
            assembly: scene.assembly,
        }
    }

    /// Its coordinates are multiples of 2⁻³⁰ m, so that a sum with a multiple of it up to 2²¹ m is exact.
    fn random(number: u64) -> Self {
        let made = Assembled::new(
            &mut Random(0x51ac_e000 + number),
            1 + usize::from(number % 5 == 4),
            DrivenBy::Joint,
        );
        let mut setup = Self {
            assembly: Assembly {
                q: vec![made.q],
                placements: made.placements.clone(),
            },
            mechanism: made.mechanism,
            masses: made.masses,
        };
        setup.each_point(|_, point| {
            let rounded = |x: f64| (x * 2_f64.powi(30)).round() * 2_f64.powi(-30);
            vec3(rounded(point.x), rounded(point.y), rounded(point.z))
        });
        setup
    }

    /// Changes every point of a body, its centre of mass among them.
    fn each_point(&mut self, change: impl Fn(usize, Vec3) -> Vec3) {
        for joint in &mut self.mechanism.joints {
            for side in [0, 1] {
                let body = joint.side_body(side).0;
                joint.sides[side].point = change(body, joint.sides[side].point);
            }
        }
        self.each_coupled_point(&change);
        for (body, mass) in self.masses.iter_mut().enumerate() {
            mass.center = change(body, mass.center);
        }
    }

    /// Changes the points of coupled distances.
    fn each_coupled_point(&mut self, change: impl Fn(usize, Vec3) -> Vec3) {
        for coupling in &mut self.mechanism.couplings {
            for coordinate in [&mut coupling.dependent, &mut coupling.independent] {
                if let Coordinate::Distance { bodies, points } = coordinate {
                    for (body, point) in bodies.iter().zip(points) {
                        *point = change(body.0, *point);
                    }
                }
            }
        }
    }

    /// With another place on the ground.
    fn moved(mut self, to: Placement) -> Self {
        let ground = self.mechanism.ground;
        for joint in &mut self.mechanism.joints {
            for k in [0, 1] {
                if joint.side_body(k).0 == ground {
                    let Side {
                        point,
                        axis,
                        normal,
                    } = joint.sides[k];
                    joint.sides[k] = Side {
                        point: to.point(point),
                        axis: to.rotation.apply(axis),
                        normal: to.rotation.apply(normal),
                    };
                }
            }
        }
        self.each_coupled_point(|body, point| {
            if body == ground {
                to.point(point)
            } else {
                point
            }
        });
        let bodies = self.mechanism.bodies.len();
        self.assembly
            .placements
            .resize(bodies, Placement::default());
        for (body, placement) in self.assembly.placements.iter_mut().enumerate() {
            if body != ground {
                placement.position = to.point(placement.position);
                placement.rotation = to.rotation.after(&placement.rotation);
            }
        }
        self
    }

    /// With the origins of the bodies' frames elsewhere.
    fn with_frames_at(mut self, shift: impl Fn(usize) -> Vec3) -> Self {
        let ground = self.mechanism.ground;
        let shift = |body: usize| {
            if body == ground {
                Vec3::ZERO
            } else {
                shift(body)
            }
        };
        self.each_point(|body, point| point - shift(body));
        let bodies = self.mechanism.bodies.len();
        self.assembly
            .placements
            .resize(bodies, Placement::default());
        for (body, placement) in self.assembly.placements.iter_mut().enumerate() {
            placement.position = placement.point(shift(body));
        }
        self
    }

    /// A similar mechanism of the same masses.
    fn larger(mut self, factor: f64) -> Self {
        self.each_point(|_, point| point.scaled(factor));
        for joint in &mut self.mechanism.joints {
            match &mut joint.kind {
                JointKind::Helical { pitch } => *pitch *= factor,
                JointKind::Distance { length } => *length *= factor,
                _ => {}
            }
        }
        for mass in &mut self.masses {
            mass.inertia = mass.inertia.map(|i| i * factor * factor);
        }
        for placement in &mut self.assembly.placements {
            placement.position = placement.position.scaled(factor);
        }
        if !self.is_angle() {
            self.assembly.q[0] *= factor;
        }
        self
    }

    fn is_angle(&self) -> bool {
        use dwell_geometry::space::ActuatorKind;
        matches!(self.mechanism.actuators[0].kind, ActuatorKind::Angle(_))
    }

    /// Every component of every joint in the axes of the joint.
    fn reactions(&self) -> Vec<Reaction> {
        let component = |k: usize| match k {
            0..3 => Component::Force(Axes::Joint, k),
            _ => Component::Moment(Axes::Joint, k - 3),
        };
        let joints = 0..self.mechanism.joints.len();
        let of = |j: usize| {
            (0..6).map(move |k| Reaction {
                joint: JointId(j),
                component: component(k),
            })
        };
        joints.flat_map(of).collect()
    }

    fn model(&self) -> Result<Model, ModelError> {
        Model::new(
            &self.mechanism,
            &self.masses,
            &self.assembly,
            &self.reactions(),
        )
    }
}

/// m, ½m′ and the reactions of a model at a coordinate.
fn coefficients(model: &Model, q: f64) -> Option<Coefficients> {
    let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
    model.reduce(q, &mut workspace, &mut out).ok()?;
    Some(out)
}

/// The largest difference of two models from one of them at some coordinates, relative to the largest of its kind; `factor` is how much larger the
/// second is. None where one has no position and the other has.
fn difference(setup: &Setup, [one, other]: [&Model; 2], factor: f64) -> Option<f64> {
    let start = setup.assembly.q[0];
    let (unit, power) = match setup.is_angle() {
        true => (1.0, 2),
        false => (factor, 0),
    };
    let determined = one.determined(&[start], &mut one.workspace()).ok()?;
    let mut worst = 0.0_f64;
    for ahead in [-0.05, -0.02, 0.0, 0.03, 0.04] {
        let there = [(one, start + ahead), (other, (start + ahead) * unit)];
        let [first, second] = match there.map(|(model, q)| coefficients(model, q)) {
            [Some(first), Some(second)] => [first, second],
            [None, None] => continue,
            _ => return None,
        };
        let scaled = |power: i32| factor.powi(-power);
        let half = if setup.is_angle() { 2 } else { -1 };
        let mut pairs = vec![
            (0, first.m, second.m * scaled(power)),
            (0, first.half_dm, second.half_dm * scaled(half)),
        ];
        // How a body that turns idly stands about its line, and with it the axes of its joints, nothing determines.
        let idle = &one.plan().mobility().idle;
        let is_idle = |body: usize| idle.iter().any(|idle| idle.body.0 == body);
        let axes_of = |k: usize| setup.mechanism.joints[k / 6].side_body(0).0;
        let known = determined.iter().enumerate().filter(|(_, known)| **known);
        for (k, _) in known.filter(|(k, _)| !is_idle(axes_of(*k))) {
            let moment = i32::from(k % 6 >= 3);
            let by = if setup.is_angle() { [1, 1] } else { [0, -1] };
            let [a, b] = by.map(|p| scaled(p + moment));
            pairs.push((1 + moment, first.a[k], second.a[k] * a));
            pairs.push((1 + moment, first.b[k], second.b[k] * b));
        }
        for kind in 0..3 {
            let of_kind = || pairs.iter().filter(|p| p.0 == kind);
            let size = of_kind().fold(first.m * 1e-3, |s, p| s.max(p.1.abs()));
            worst = of_kind().fold(worst, |w, p| w.max((p.1 - p.2).abs() / size));
        }
    }
    Some(worst)
}

/// The changes of place, orientation and size, each with the factor of the size and whether it is exact.
fn changes(setup: &Setup) -> Vec<(&'static str, Setup, f64, bool)> {
    let at = |x: f64, y: f64, z: f64| Placement {
        position: vec3(x, y, z),
        rotation: Rotation::IDENTITY,
    };
    let turned = Placement {
        position: Vec3::ZERO,
        rotation: Rotation::of_vector(vec3(0.9, -1.3, 0.4)),
    };
    let million = 2_f64.powi(20);
    let far = at(million, -2.0 * million, 0.5 * million);
    let frames = |body: usize| vec3(-million, 3.0 + body as f64, 0.25 * million);
    let mut all = vec![
        ("far away", setup.clone().moved(far), 1.0, true),
        (
            "frames far away",
            setup.clone().with_frames_at(frames),
            1.0,
            true,
        ),
        ("turned", setup.clone().moved(turned), 1.0, false),
        (
            "small",
            setup.clone().larger(2_f64.powi(-10)),
            2_f64.powi(-10),
            true,
        ),
        (
            "large",
            setup.clone().larger(2_f64.powi(10)),
            2_f64.powi(10),
            true,
        ),
    ];
    // A law between two lengths is that of one size.
    all.retain(|(.., factor, _)| *factor == 1.0 || setup.mechanism.couplings.is_empty());
    all
}

/// The scenes of `validation/spatial` with one coordinate.
fn scenes() -> Vec<(String, Setup)> {
    let folder = format!("{}/../validation/spatial", env!("CARGO_MANIFEST_DIR"));
    let files = std::fs::read_dir(folder).expect("the scenes");
    let mut paths: Vec<_> = files.flatten().map(|file| file.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let all = paths.iter().map(|path| {
        let name = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let text = std::fs::read_to_string(path).expect("a scene");
        (name.clone(), Setup::of_scene(&name, &text))
    });
    let all: Vec<_> = all.collect();
    let one = |(_, setup): &(String, Setup)| setup.mechanism.actuators.len() == 1;
    all.into_iter().filter(one).collect()
}

/// 1e6 m away a coordinate is rounded by 1e-10 m, which is a few 1e-9 of the shortest link, and reactions feel some times that.
const FAR_AWAY: f64 = 1e-6;

#[test]
fn the_place_the_orientation_and_the_size_of_a_scene_do_not_matter() {
    let scenes = scenes();
    assert!(scenes.len() > 12, "{}", scenes.len());
    for (name, setup) in scenes {
        let model = setup.model().unwrap_or_else(|e| panic!("{name}: {e}"));
        for (what, changed, factor, _) in changes(&setup) {
            let other = changed.model();
            let other = other.unwrap_or_else(|e| panic!("{name}, {what}: {e}"));
            let [one, two] = [&model, &other].map(|m| m.plan().range());
            assert_eq!(one.period(), two.period(), "{name}, {what}");
            assert_eq!(
                one.limits().is_some(),
                two.limits().is_some(),
                "{name}, {what}"
            );
            let found = difference(&setup, [&model, &other], factor);
            let found = found.unwrap_or_else(|| panic!("{name}, {what}: no position"));
            println!("{name:24} {what:16} {found:.1e}");
            let bound = if what.contains("far") {
                FAR_AWAY
            } else {
                1e-11
            };
            assert!(found < bound, "{name}, {what}: {found:.1e}");
        }
    }
}

/// Where coordinates are exact, far away too, so are their differences: nothing is lost.
#[test]
fn random_loops_do_not_depend_on_their_place_orientation_and_size() {
    let (mut compared, mut largest) = (0, 0.0_f64);
    for number in 0..60 {
        let setup = Setup::random(number);
        let Ok(model) = setup.model() else { continue };
        for (what, changed, factor, is_exact) in changes(&setup) {
            let other = changed.model();
            let other = other.unwrap_or_else(|e| panic!("{number}, {what}: {e}"));
            // Near a limit position or a singular one, one may have a position and the other none.
            let Some(found) = difference(&setup, [&model, &other], factor) else {
                continue;
            };
            let bound = if is_exact { 1e-9 } else { 1e-7 };
            assert!(found < bound, "{number}, {what}: {found:.1e}");
            compared += 1;
            largest = largest.max(if is_exact { found } else { 0.0 });
        }
    }
    println!("{compared} compared, exact ones to {largest:.1e}");
    assert!(compared > 100, "{compared}");
}

/// In single precision every scene closes, and loses no more than its condition: ten roundings at most, in the RSUR of Haug.
#[test]
fn single_precision_closes_in_space() {
    for (name, setup) in scenes() {
        let model = setup.model().unwrap_or_else(|e| panic!("{name}: {e}"));
        let (low, high) = match model.plan().range().limits() {
            Some((low, high)) => (low.max(-3.0), high.min(3.0)),
            None => (0.0, 6.0),
        };
        let (mut short, mut plain) = (model.workspace::<f32>(), model.workspace::<f64>());
        let (mut s, mut p) = (model.coefficient_buffer(), model.coefficient_buffer());
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for k in 0..40 {
            let q = (low + (high - low) * (f64::from(k) + 0.5) / 40.0) as f32;
            let found = model.reduce(q, &mut short, &mut s);
            found.unwrap_or_else(|e| panic!("{name} at {q}: {e}"));
            model
                .reduce(f64::from(q), &mut plain, &mut p)
                .expect("a pose");
            worst = worst.max((f64::from(s.m) - p.m).abs());
            largest = largest.max(p.m.abs());
        }
        let places = worst / largest / f64::from(f32::EPSILON);
        println!("{name:24} loses {places:.1} places of single precision");
        assert!(places < 40.0, "{name}: {places:.0}");
    }
}

/// Four hinges with parallel axes, one of them tilted about any direction by 10⁻ᵏ: a loop that is accepted closes over its whole range.
#[test]
fn nearly_parallel_axes_close_over_the_whole_range_or_are_refused() {
    let mut refused = 0;
    for (k, tilt) in (3..28).map(|k| (k, 10_f64.powf(-0.5 * f64::from(k)))) {
        let direction = 1.7 * f64::from(k);
        let (x, y) = (tilt * direction.cos(), tilt * direction.sin());
        let text = format!(
            r#"
            [bodies.ground]
            points = {{ A = [0, 0, 0], D = [0.3, 0, 0] }}
            [bodies.crank]
            points = {{ A = [0, 0, 0], B = [0.08, 0.06, 0] }}
            mass = 1
            center = [0.05, 0.04, 0.01]
            inertia = [0.002, 0.003, 0.004]
            [bodies.rod]
            points = {{ B = [0.08, 0.06, 0], C = [0.35, 0.25, 0] }}
            [bodies.rocker]
            points = {{ C = [0.35, 0.25, 0], D = [0.3, 0, 0] }}
            [joints]
            A = {{ revolute = ["ground.A", "crank.A"], axis = [0, 0, 1] }}
            B = {{ revolute = ["crank.B", "rod.B"], axis = [0, 0, 1] }}
            C = {{ revolute = ["rod.C", "rocker.C"], axis = [0, 0, 1] }}
            D = {{ revolute = ["ground.D", "rocker.D"], axis = [{x:?}, {y:?}, 1.0] }}
            [actuators]
            phi = {{ angle = "A" }}
            "#
        );
        match Setup::of_scene("four hinges", &text).model() {
            Ok(model) => assert_eq!(model.plan().range(), Range::Full, "{tilt:.1e}"),
            Err(error) => {
                refused += 1;
                assert!(tilt > 1e-10, "{tilt:.1e}: {error}");
                if let ModelError::Assembly(dwell_geometry::AssemblyError::NotThroughout {
                    nearly_parallel,
                    ..
                }) = error
                {
                    let (_, angle) = nearly_parallel.expect("two joints");
                    assert!((angle - tilt).abs() < 1e-3 * tilt, "{angle:e} for {tilt:e}");
                }
            }
        }
    }
    assert!(refused > 8, "{refused}");
}

/// A screw jack, driven at its spindle or by its travel, and a block on a slide have no end; their coordinates are counted.
#[test]
fn screws_and_slides_have_no_end() {
    let jack = |drive: &str| {
        format!(
            r#"
            [bodies.ground]
            points = {{ S = [0, 0, 0], G = [0, 0, 0.1] }}
            [bodies.spindle]
            points = {{ S = [0, 0, 0], N = [0, 0, 0.1] }}
            mass = 1
            center = [0, 0, 0]
            inertia = [1e-4, 1e-4, 1e-4]
            [bodies.nut]
            points = {{ N = [0, 0, 0] }}
            [joints]
            bearing = {{ revolute = ["ground.S", "spindle.S"], axis = [0, 0, 1] }}
            thread = {{ helical = ["nut.N", "spindle.N"], axis = [0, 0, 1], pitch = -0.006 }}
            guide = {{ prismatic = ["ground.G", "nut.N"], axis = [0, 0, 1] }}
            [actuators]
            q = {{ {drive} }}
            [assembly]
            nut = {{ at = [0, 0, 0.1] }}
            "#
        )
    };
    let per_turn = 0.006 / std::f64::consts::TAU;
    for (drive, travel) in [
        ("angle = \"bearing\"", per_turn),
        ("travel = \"guide\"", 1.0),
    ] {
        let setup = Setup::of_scene("jack", &jack(drive));
        let model = setup.model().unwrap_or_else(|e| panic!("{drive}: {e}"));
        assert_eq!(model.plan().range(), Range::Unbounded, "{drive}");
        let mut pose = model.plan().pose();
        for q in [-1e4, -60.0, -1.0, 0.0, 7.0, 51.0, 1e4] {
            model.plan().positions(&[q], &mut pose).expect("a pose");
            let nut = model.plan().placement(&pose, 2).position.z - 0.1;
            let wanted = q * travel;
            assert!(
                (nut - wanted).abs() < 1e-12 * (1.0 + wanted.abs()),
                "{drive} {q}: {nut} for {wanted}"
            );
        }
    }
}
