//! States of prescribed motion recorded as operations of the motion, the magnitudes of the loads and all numbers of a machine, against
//! models that are compiled for other numbers, and their gradients against differences of such models. In the plane and in space.

use super::variants::{random, variant_in};
use dwell_kinetostatics::{
    MachineModel, Magnitude, RecordableModel, RecordedState, ReducibleModel, WantedMotion, space,
};
use dwell_numerics::ReverseSweep;
use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::assembled::AskedScene;
use dwell_study::gradient::GradientScene;
use dwell_study::machines::{CoordinateOf, MachineScene};
use dwell_tests::fixtures;

/// Cases of one and of several actuators: of dyads, guided points, constructions and groups solved by iterations, with their loads.
const PLANE: [&str; 11] = [
    "crank-rocker",
    "single-dwell",
    "slider-crank",
    "watt-six-bar",
    "whitworth",
    "slotted-rocker",
    "jansen",
    "scotch-yoke",
    "class-three-six-bar",
    "double-pendulum",
    "five-bar",
];
/// Rods, groups solved by iterations, gears, a screw, several actuators.
const SPACE: [&str; 8] = [
    "rssr-haug",
    "rsur-haug",
    "slider-crank-haug",
    "wobble-plate",
    "governor",
    "bevel-differential",
    "screw-jack",
    "gyroscope",
];
/// Largest relative change of the numbers from one machine to the next.
const DEVIATION: f64 = 0.02;

/// A scene of a machine whose states are recorded.
trait Recorded: GradientScene {
    /// With these numbers, and magnitudes of its loads that are given from outside.
    fn changed(&self, values: &[(&str, f64)]) -> Self;
    /// With all determined reactions.
    /// None where it cannot be assembled, or its numbers have to keep a relation, as the centre of mass of an idle rod.
    fn compiled(&self) -> Option<Self::Model>;
    fn start(&self) -> Vec<f64>;

    /// All coordinates and points that have a name.
    fn wanted(&self) -> WantedOf<Self> {
        let bodies = self.named_points().into_iter().enumerate();
        let points = bodies.flat_map(|(b, (_, of))| {
            of.into_iter()
                .map(move |(_, at)| (b.into(), Self::point(at)))
        });
        WantedMotion {
            points: points.collect(),
            coordinates: self
                .named_coordinates()
                .iter()
                .map(|c| c.coordinate)
                .collect(),
        }
    }
}

/// Position, velocity and acceleration of its points, by its bodies.
fn points_of_bodies<S: AskedScene>(scene: &S, model: &S::Model, motion: [&[f64]; 3]) -> Vec<f64> {
    let (bodies, _) = scene.body_states(model, motion).expect("a pose");
    let mut found = Vec::new();
    for (body, (_, points)) in scene.named_points().into_iter().enumerate() {
        for (_, at) in points {
            let vectors = bodies.point(body, at);
            found.extend(vectors.iter().flat_map(|v| &v[..S::DIMENSION]));
        }
    }
    found
}

type WantedOf<S> =
    WantedMotion<CoordinateOf<S>, <<S as MachineScene>::Model as RecordableModel>::Point>;

/// Loads whose magnitudes are given from outside; those that depend on reactions are left out.
fn given<K: Clone, C>(
    loads: &[dwell_kinetostatics::Load<K, C>],
) -> Vec<dwell_kinetostatics::Load<K, C>> {
    let free = |m: &Magnitude<C>| !matches!(m, Magnitude::Friction(_) | Magnitude::Separating(_));
    let kept = loads.iter().filter(|load| free(&load.magnitude));
    let external = kept.map(|load| dwell_kinetostatics::Load {
        name: load.name.clone(),
        kind: load.kind.clone(),
        magnitude: Magnitude::External(Vec::new()),
    });
    external.collect()
}

impl Recorded for PlaneScene {
    fn changed(&self, values: &[(&str, f64)]) -> Self {
        let mut scene = self.with_values(values).expect("a scene");
        scene.loads = given(&scene.loads);
        scene
    }

    fn compiled(&self) -> Option<Self::Model> {
        let start = self.assembly.to_configuration();
        let all = self.mechanism.reactions();
        let model = dwell_kinetostatics::Model::new(&self.mechanism, &self.masses, &start, &all);
        model.ok()?.with_loads(self.loads.clone()).ok()
    }

    fn start(&self) -> Vec<f64> {
        self.assembly.to_configuration().q
    }
}

impl Recorded for SpaceScene {
    fn changed(&self, values: &[(&str, f64)]) -> Self {
        let mut scene = self.with_values(values).expect("a scene");
        scene.loads = given(&scene.loads);
        scene
    }

    fn compiled(&self) -> Option<Self::Model> {
        let compile = |reactions: &[space::Reaction]| {
            space::Model::new(&self.mechanism, &self.masses, &self.assembly, reactions).ok()
        };
        let all = compile(&self.requests.reactions)?;
        let determined = all.determined_throughout().ok()?;
        let kept = self.requests.reactions.iter().zip(determined);
        let kept: Vec<_> = kept.filter(|(_, d)| *d).map(|(r, _)| *r).collect();
        compile(&kept)?.with_loads(self.loads.clone()).ok()
    }

    fn start(&self) -> Vec<f64> {
        self.assembly.q.clone()
    }
}

/// A state of motion: q, q̇, q̈ and the magnitudes of the loads.
struct Motion {
    q: Vec<f64>,
    q_dot: Vec<f64>,
    q_ddot: Vec<f64>,
    magnitudes: Vec<f64>,
}

impl Motion {
    /// One of any numbers, near the assembly.
    fn new<S: Recorded>(scene: &S, model: &S::Model, number: u64) -> Self {
        let any = |k: usize| random(7000 * number + k as u64);
        let unit = |i: usize| if model.is_angle(i) { 1.0 } else { model.size() };
        let start = scene.start();
        let range = 0..start.len();
        Self {
            q: range
                .clone()
                .map(|i| start[i] + (0.1 + 0.1 * any(i)) * unit(i))
                .collect(),
            q_dot: range
                .clone()
                .map(|i| (1.0 + any(10 + i)) * unit(i))
                .collect(),
            q_ddot: range.map(|i| any(20 + i) * unit(i)).collect(),
            magnitudes: (0..scene.loads().len())
                .map(|i| 1.5 + any(30 + i))
                .collect(),
        }
    }

    /// The inputs of a recording of a scene.
    fn inputs<S: Recorded>(&self, scene: &S, model: &S::Model, numbers: &[f64]) -> Vec<f64> {
        let solution = model.solution(&self.q, &mut model.pass_workspace());
        let solution = solution.unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let motion = [&self.q, &self.q_dot, &self.q_ddot, &self.magnitudes];
        let mut inputs = motion.map(Vec::as_slice).concat();
        inputs.extend(numbers);
        inputs.extend(solution);
        inputs
    }

    /// The outputs of a compiled model: forces of the actuators, reactions, wanted coordinates.
    fn compiled<S: Recorded>(&self, scene: &S, model: &S::Model) -> Vec<f64> {
        let mut workspace = model.pass_workspace();
        let mut result = Default::default();
        let set = |workspace: &mut _| {
            model
                .update_kinematics(&self.q, &self.q_dot, workspace)
                .expect("a pose");
            model.update_accelerations(&self.q_ddot, workspace);
            S::Model::magnitudes_mut(workspace).copy_from_slice(&self.magnitudes);
            model.update_wrenches(workspace)
        };
        set(&mut workspace).expect("directions");
        resize::<S>(model, &mut result);
        model.loaded_balance(&mut workspace, &mut result);
        let mut outputs = [result.tau, result.reactions].concat();
        for coordinate in scene.wanted().coordinates {
            let function = model.coordinate_function(coordinate).expect("a coordinate");
            outputs.extend(model.coordinate_motion(function, &workspace));
        }
        outputs.extend(points_of_bodies(
            scene,
            model,
            [&self.q, &self.q_dot, &self.q_ddot],
        ));
        outputs
    }
}

/// Room for the results of a model.
fn resize<S: Recorded>(model: &S::Model, result: &mut dwell_kinetostatics::InverseDynamics<f64>) {
    result.tau.resize(model.actuators(), 0.0);
    result.reactions.resize(model.reaction_count(), 0.0);
}

/// The model of a scene.
fn model<S: Recorded>(scene: &S) -> S::Model {
    let name = &scene.name;
    scene
        .compiled()
        .unwrap_or_else(|| panic!("{name}: no model"))
}

/// The paths of the numbers of the bodies that can be changed one by one.
fn free_numbers<S: Recorded>(scene: &S) -> Vec<String> {
    let mut paths = scene.number_paths();
    paths.retain(|path| {
        let one = std::slice::from_ref(path);
        let changed = variant_in(scene, one, length_of(scene), DEVIATION, 1);
        scene.changed(&changed).compiled().is_some()
    });
    paths
}

/// The machine with these numbers changed.
fn variant<S: Recorded>(scene: &S, paths: &[String], number: u64) -> S {
    let file = scene;
    scene.changed(&variant_in(
        file,
        paths,
        length_of(scene),
        DEVIATION,
        number,
    ))
}

/// A recording of a scene at a motion.
fn recorded<S: Recorded>(
    scene: &S,
    model: &S::Model,
    motion: &Motion,
) -> (RecordedState, Vec<f64>) {
    let wanted = scene.wanted();
    let described = scene.described(&wanted);
    let numbers = model.numbers(described).expect("numbers");
    let inputs = motion.inputs(scene, model, &numbers);
    let recorded = RecordedState::record(model, described, std::slice::from_ref(&inputs));
    let recorded = recorded.unwrap_or_else(|e| panic!("{}: {e:?}", scene.name));
    (recorded, inputs)
}

/// A length of the order of the mechanism, in the unit of the scene.
fn length_of<S: Recorded>(scene: &S) -> f64 {
    let size = model(&scene.changed(&[])).size();
    scene.to_scene_unit(size, false).0
}

/// The largest difference of outputs from those of a compiled model, over the largest of their kind.
fn largest_difference(found: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / largest
}

fn evaluated_at_other_numbers<S: Recorded>(scene: &S) -> f64 {
    let paths = free_numbers(scene);
    let [one, other] = [1, 2].map(|k| variant(scene, &paths, k));
    let mut worst = 0.0_f64;
    for number in 1..4 {
        let fresh = model(&other);
        let motion = Motion::new(&other, &fresh, number);
        let (of_one, _) = recorded(&one, &model(&one), &motion);
        let (_, inputs) = recorded(&other, &fresh, &motion);
        let expected = motion.compiled(&other, &fresh);
        let found = of_one.code.evaluate(&inputs);
        worst = worst.max(largest_difference(&found[..expected.len()], &expected));
    }
    worst
}

#[test]
fn a_recording_at_other_numbers_is_the_model_compiled_for_them() {
    for case in PLANE {
        let difference = evaluated_at_other_numbers(&fixtures::scene(case));
        assert!(
            // Seen: 4.2e-15 (rsur-haug).
            difference < 1e-13,
            "{case}: an output differs by {difference:e}"
        );
    }
    for case in SPACE {
        let difference = evaluated_at_other_numbers(&fixtures::space_scene(case));
        assert!(
            // Seen: 4.2e-15 (rsur-haug).
            difference < 1e-13,
            "{case}: an output differs by {difference:e}"
        );
    }
}

/// The largest difference of a derivative by a number of the bodies from that of compiled models, over the largest contribution.
fn gradient_error<S: Recorded>(scene: &S) -> f64 {
    /// Relative change of a number, of which the difference has an error of second order.
    const STEP: f64 = 1e-4;
    let paths = free_numbers(scene);
    let base = variant(scene, &paths, 1);
    let model_of_base = model(&base);
    let motion = Motion::new(&base, &model_of_base, 1);
    let (recording, at) = recorded(&base, &model_of_base, &motion);
    let count = motion.compiled(&base, &model_of_base).len();
    let mut sweep = ReverseSweep::default();
    let outputs = sweep.evaluate(&recording.code, &at).len();
    // One weight for each output that is compared, so that all take part.
    let weight = |k: usize| {
        if k < count {
            1.0 / (1.0 + k as f64)
        } else {
            0.0
        }
    };
    let weights: Vec<f64> = (0..outputs).map(weight).collect();
    let gradient = sweep.gradient(&recording.code, &at, &weights).to_vec();
    let (first, end) = (recording.layout.first_number(), recording.layout.solution());
    // Nothing is added for the solution, on which the outputs do not depend along the mechanisms that close.
    let each = gradient[first..end].iter().zip(&at[first..end]);
    let scale = each.map(|(g, n)| (g * n).abs()).fold(0.0, f64::max);
    let mut worst = 0.0_f64;
    for path in paths {
        let value = base.value(&path).expect("a number");
        let [less, more] = [-STEP, STEP].map(|step| {
            let changed = base.changed(&[(&path, value * (1.0 + step))]);
            let model = model(&changed);
            let outputs = motion.compiled(&changed, &model);
            let sum: f64 = outputs.iter().zip(&weights).map(|(f, w)| f * w).sum();
            let wanted = changed.wanted();
            (
                sum,
                model.numbers(changed.described(&wanted)).expect("numbers"),
            )
        });
        let changes = less.1.iter().zip(&more.1).map(|(a, b)| b - a);
        let by_gradient: f64 = gradient[first..end]
            .iter()
            .zip(changes)
            .map(|(g, c)| g * c)
            .sum();
        let difference = more.0 - less.0;
        // The error of the difference: the third derivative times the step cubed, and rounding.
        let error = (by_gradient - difference).abs() / (2.0 * STEP * scale);
        assert!(error.is_finite(), "{}: {path} has no derivative", base.name);
        worst = worst.max(error);
    }
    worst
}

#[test]
fn the_gradient_of_a_recording_is_the_difference_of_compiled_models() {
    for case in PLANE {
        let error = gradient_error(&fixtures::scene(case));
        // Seen: 2.8e-7 (jansen).
        assert!(error < 1e-5, "{case}: a derivative differs by {error:e}");
    }
    for case in SPACE {
        let error = gradient_error(&fixtures::space_scene(case));
        // Seen: 2.8e-7 (jansen).
        assert!(error < 1e-5, "{case}: a derivative differs by {error:e}");
    }
}
