//! Results that people optimise: those of sweeps against rows of `kinetostatics`, momenta, published optima and scenes that hold the values.

use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::sweep::compute::ComputedSweep;
use dwell_study::{
    Analysis, StudyScene, SweepRequest, compute_request, compute_trajectory, no_progress,
};
use dwell_tests::fixtures;
use std::f64::consts::{PI, TAU};

/// A four-bar under its weight at 10 rad/s: lengths of crank, coupler, rocker and ground; mass, centre and inertia of crank, coupler and
/// rocker; guesses of the angles of coupler and rocker.
struct FourBar(&'static str);

/// The least RMS torque by the places of counterweights of 1 and 2 kg on crank and rocker (two programs agree on 0.48173767288411).
const LEAST_RMS: FourBar = FourBar(
    "0.1 0.35 0.25 0.4  1.8 -0.06377952799103893 -0.037617196120067 0.022679601584670847  1.2 0.175 0.01 0.013 \
     2.9 0.02410244456851523 0.03262440132365514 0.020674292071178272  0.7751933733103613 1.7721542475852277",
);
/// The least peak torque by these places: three peaks of 0.785117118851 tie.
const LEAST_PEAK: FourBar = FourBar(
    "0.1 0.35 0.25 0.4  1.8 -0.04437724247630449 -0.03306324792325428 0.016400348855358685  1.2 0.175 0.01 0.013 \
     2.9 0.024562623963630972 0.030273648337575787 0.020360429176803353  0.7751933733103613 1.7721542475852277",
);
/// The least RMS torque of rods of 2 kg/m by three lengths at a swing of 60° and transmission angles up to 140°: 1.21989222249.
const LEAST_BY_LENGTHS: FourBar = FourBar(
    "0.1232367500062821 0.31538694830703096 0.25 0.40852366291841813  0.2464735000125642 0.06161837500314105 0 0.0003119388447439596 \
     0.6307738966140619 0.15769347415351548 0 0.005228533564855093  0.5 0.125 0 0.05260416666666667  0.8530097092913627 1.8874661155934713",
);

impl FourBar {
    fn numbers(&self) -> Vec<f64> {
        let words = self.0.split_whitespace();
        words.map(|word| word.parse().expect("a number")).collect()
    }

    fn text(&self, points: usize) -> String {
        let n = self.numbers();
        let body = |(k, name, one, two): (usize, &str, &str, &str)| {
            let (length, of) = (n[k], &n[4 + 4 * k..]);
            let (m, x, y, i) = (of[0], of[1], of[2], of[3]);
            format!(
                "bodies.{name} = {{ points = {{ {one} = [0, 0], {two} = [{length:?}, 0], G = [{x:?}, {y:?}] }}, mass = {m:?}, \
                 center = [{x:?}, {y:?}], inertia = {i:?} }}\n"
            )
        };
        let bodies = [
            (0, "crank", "A", "B"),
            (1, "coupler", "B", "C"),
            (2, "rocker", "D", "C"),
        ];
        let joints = [
            ("A", "ground", "crank"),
            ("B", "crank", "coupler"),
            ("C", "coupler", "rocker"),
            ("D", "ground", "rocker"),
        ];
        let joint = |(at, one, two)| {
            format!("joints.{at} = {{ revolute = [\"{one}.{at}\", \"{two}.{at}\"] }}\n")
        };
        let (d, coupler, rocker, duration) = (n[3], n[16], n[17], TAU / 10.0);
        format!(
            "bodies.ground.points = {{ A = [0, 0], D = [{d:?}, 0] }}\n{}{}\
             actuators.phi = {{ angle = [\"ground\", \"crank\"] }}\nassembly = {{ coupler = {coupler:?}, rocker = {rocker:?} }}\n\
             loads.weight = {{ gravity = [0, -9.81] }}\n\
             prescribed = {{ duration = {duration:?}, points = {points}, phi = {{ speed = 10.0 }} }}\n",
            bodies.map(body).concat(),
            joints.map(joint).concat(),
        )
    }

    fn scene(&self, points: usize) -> PlaneScene {
        let text = self.text(points);
        PlaneScene::parse("four-bar.toml", &text).unwrap_or_else(|e| panic!("{e:?}"))
    }
}

fn texts(all: &[&str]) -> Vec<String> {
    all.iter().map(|&text| text.to_owned()).collect()
}

/// A sweep, or its error.
fn tried(
    scene: &impl StudyScene,
    vary: &str,
    tied: &[&str],
    results: &[&str],
) -> Result<ComputedSweep, String> {
    let [vary, tied, requests] = [&[vary], tied, results].map(texts);
    let request = SweepRequest {
        vary: &vary,
        tied: &tied,
        requests: &requests,
        ..SweepRequest::default()
    };
    compute_request(scene, &request, &no_progress).map_err(|error| error.to_string())
}

fn swept(scene: &impl StudyScene, vary: &str, tied: &[&str], results: &[&str]) -> ComputedSweep {
    let swept = tried(scene, vary, tied, results).expect("a sweep");
    assert!(
        swept.messages.iter().all(Option::is_none),
        "{:?}",
        swept.messages
    );
    swept
}

fn column(swept: &ComputedSweep, name: &str) -> Vec<f64> {
    let k = swept.table.columns.iter().position(|c| c.name == name);
    let k = k.unwrap_or_else(|| panic!("no column {name}"));
    swept.table.rows.iter().map(|row| row[k]).collect()
}

fn value(scene: &impl StudyScene, vary: &str, result: &str) -> f64 {
    column(&swept(scene, vary, &[], &[result]), result)[0]
}

/// The rows of `kinetostatics`, by column.
struct Rows(Vec<(String, Vec<f64>)>);

impl Rows {
    fn new(scene: &impl StudyScene, points: Option<usize>) -> Self {
        let run = compute_trajectory(scene, Analysis::Kinetostatics, points, &no_progress);
        let table = run.unwrap_or_else(|e| panic!("{e}")).table;
        let values = |k: usize| table.rows.iter().map(|row| row[k]).collect();
        let columns = table.columns.iter().enumerate();
        Self(columns.map(|(k, c)| (c.name.clone(), values(k))).collect())
    }

    fn of(&self, name: &str) -> &[f64] {
        let found = self.0.iter().find(|(n, _)| n == name);
        &found.unwrap_or_else(|| panic!("no column {name}")).1
    }

    fn at(&self, k: usize, name: &str) -> f64 {
        self.of(name)[k]
    }

    /// The root mean square over time of a function of the row, by trapezoids.
    fn rms(&self, of: impl Fn(usize) -> f64) -> f64 {
        let squares: Vec<f64> = (0..self.0[0].1.len()).map(|k| of(k).powi(2)).collect();
        mean(&squares).sqrt()
    }
}

/// The mean of values at equal times, by trapezoids.
fn mean(all: &[f64]) -> f64 {
    let ends = 0.5 * (all[0] + all[all.len() - 1]);
    (all.iter().sum::<f64>() - ends) / (all.len() - 1) as f64
}

type Value = fn(f64) -> f64;

fn largest(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    values
        .iter()
        .map(|v| of(*v))
        .fold(f64::NEG_INFINITY, f64::max)
}

fn assert_near(found: f64, wanted: f64, tolerance: f64, what: &str) {
    let off = (found - wanted).abs();
    assert!(
        off <= tolerance,
        "{what}: {found:?} instead of {wanted:?}, {off:.1e}"
    );
}

/// Every statistic of every column, from rows; extremes from rows sixteen times as dense.
fn check_statistics(scene: &impl StudyScene, vary: &str) {
    let coarse = Rows::new(scene, None);
    let dense = Rows::new(scene, Some(16 * (coarse.0[0].1.len() - 1) + 1));
    let names: Vec<&str> = coarse.0[1..]
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    let ends = ["max", "min", "max_abs", "mean", "rms", "stroke"];
    let results = names
        .iter()
        .flat_map(|n| ends.map(|end| format!("{n}.{end}")));
    let results: Vec<String> = results.collect();
    let results: Vec<&str> = results.iter().map(String::as_str).collect();
    let swept = swept(scene, vary, &[], &results);
    for name in names {
        let (values, dense) = (coarse.of(name), dense.of(name));
        let result = |end: &str| column(&swept, &format!("{name}.{end}"))[0];
        let size = largest(dense, f64::abs).max(1e-2);
        let rounding = 1e-13 * size;
        let is_smooth = ![".direction", "magnitude", ".residual", ".rotation."]
            .iter()
            .any(|end| name.contains(end));
        assert_near(result("mean"), mean(values), rounding, name);
        assert_near(result("rms"), coarse.rms(|k| values[k]), rounding, name);
        let stroke = result("max") - result("min");
        assert_near(result("stroke"), stroke, rounding, name);
        // Between the dense rows a peak is higher by 1e-5 of the size; a direction may jump, a magnitude has corners, a residual is rounding, and rotations in
        // space are those of rows.
        let signed: [(&str, f64, Value); 3] = [
            ("max", 1.0, |v| v),
            ("min", -1.0, |v| -v),
            ("max_abs", 1.0, f64::abs),
        ];
        for (end, sign, by) in signed.into_iter().filter(|_| is_smooth) {
            let over = sign * result(end) - largest(values, by).max(largest(dense, by));
            assert!(
                over > -rounding && over < 2e-5 * size,
                "{name}.{end}: {over}"
            );
        }
    }
    let (power, force) = (
        coarse.of("power.actuators"),
        format!("{}.actuator_force", coarse.0[1].0),
    );
    let (duration, size) = (largest(coarse.of("t"), |t| t), largest(power, f64::abs));
    let work = value(scene, vary, &format!("{force}.work"));
    assert_near(
        work,
        duration * mean(power),
        1e-13 * duration * size,
        "work",
    );
    let over = value(scene, vary, &format!("{force}.peak_power")) / size - 1.0;
    assert!(over > -1e-13 && over < 1e-2, "{over}");
}

fn driven_rssr() -> SpaceScene {
    let text = fixtures::space_scene("rssr").source.inner().clone();
    let motion = "[prescribed]\nduration = 0.9\npoints = 241\nq = { speed = 7 }\n";
    SpaceScene::parse("rssr.toml", &format!("{text}\n{motion}")).expect("a scene")
}

#[test]
fn statistics_are_those_of_the_rows_in_plane_and_space() {
    check_statistics(&LEAST_RMS.scene(241), "crank.mass=1.8");
    check_statistics(&driven_rssr(), "crank.mass=0.8");
}

#[test]
fn optima_have_their_published_values() {
    // By the structure of the family, and by rows of a compiled scene: no family has the second result.
    let (force, swing) = ("phi.actuator_force.rms", "rocker.angle.stroke");
    for (bar, rms) in [
        (LEAST_RMS, 0.481_737_672_884_11),
        (LEAST_BY_LENGTHS, 1.219_892_222_49),
    ] {
        let vary = format!("crank.mass={:?}", bar.numbers()[4]);
        for results in [&[force][..], &[force, swing]] {
            let swept = swept(&bar.scene(1025), &vary, &[], results);
            assert_near(column(&swept, force)[0], rms, 1e-11, "RMS");
        }
    }
    for points in [65, 361] {
        let results = ["phi.actuator_force.max_abs", swing];
        let swept = swept(&LEAST_PEAK.scene(points), "crank.mass=1.8", &[], &results);
        assert_near(
            column(&swept, results[0])[0],
            0.785_117_118_851,
            1e-11,
            "peak",
        );
    }
    let of = |result: &str| value(&LEAST_BY_LENGTHS.scene(361), "rocker.mass=0.5", result);
    assert_near(of(swing), PI / 3.0, 1e-9, "swing");
    let angle = of("C.transmission_angle.max");
    assert_near(angle, 140.0 * PI / 180.0, 1e-8, "transmission angle");
    assert_near(
        of("closure.determinant.min"),
        angle.sin(),
        1e-12,
        "determinant",
    );
}

/// The rates of the momenta of the bodies, and their weights, are the shaking force and moment in the plane, which come from reactions; in
/// space the reactions are those that come from momenta.
#[test]
fn the_shaking_force_balances_momenta_and_reactions() {
    let (scene, numbers) = (LEAST_RMS.scene(241), LEAST_RMS.numbers());
    let rows = Rows::new(&scene, None);
    let sums = |k: usize| {
        let [mut fx, mut fy, mut moment] = [0.0; 3];
        for (name, of) in ["crank", "coupler", "rocker"]
            .iter()
            .zip(numbers[4..].chunks(4))
        {
            let at = |what: &str| rows.at(k, &format!("{name}.{what}"));
            let (x, y) = (-of[0] * at("G.ax"), -of[0] * (at("G.ay") + 9.81));
            (fx, fy) = (fx + x, fy + y);
            moment += at("G.x") * y - at("G.y") * x - of[3] * at("angular_acceleration");
        }
        [f64::hypot(fx, fy), moment]
    };
    let check = |scene: &dyn Fn(&str) -> f64, [force, moment]: [f64; 2]| {
        assert_near(scene("shaking.force.rms"), force, 1e-12 * force, "force");
        assert_near(
            scene("shaking.moment.rms"),
            moment,
            1e-12 * moment,
            "moment",
        );
    };
    let wanted = [0, 1].map(|i| rows.rms(|k| sums(k)[i]));
    check(&|result| value(&scene, "crank.mass=1.8", result), wanted);

    let scene = driven_rssr();
    let rows = Rows::new(&scene, None);
    let norm = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let on_ground = |k: usize| {
        let force = |joint: &str| ["x", "y", "z"].map(|c| rows.at(k, &format!("{joint}.{c}")));
        let (at, [a, d]) = ([0.25, 0.06, -0.04], ["A", "D"].map(force));
        let arm = |i: usize, j: usize| at[i] * d[j] - at[j] * d[i];
        let moment = [
            arm(1, 2) + rows.at(k, "A.moment-x") + rows.at(k, "D.moment-x"),
            arm(2, 0) + rows.at(k, "A.moment-y"),
            arm(0, 1) + rows.at(k, "D.moment-z") + rows.at(k, "q.actuator_force"),
        ];
        [norm([0, 1, 2].map(|i| a[i] + d[i])), norm(moment)]
    };
    let wanted = [0, 1].map(|i| rows.rms(|k| on_ground(k)[i]));
    check(&|result| value(&scene, "crank.mass=0.8", result), wanted);
}

/// Variants with tied numbers are the scenes that hold the values, filled into a structure and compiled, in plane and space.
#[test]
fn tied_variants_are_the_scenes_that_hold_the_values() {
    let ties = [
        "crank.mass = 18 * `crank.points.B[0]`",
        "crank.center[0] = -0.6 * `crank.points.B[0]`",
        "crank.inertia = `crank.mass` * `crank.points.B[0]`^2 / 3",
    ];
    let forces = [
        "phi.actuator_force.rms",
        "B.x.max",
        "phi.actuator_force.mean",
    ];
    let scene = LEAST_RMS.scene(241);
    for results in [&forces[..], &[forces[0], "crank.B.x.rms"]] {
        let sweep = swept(&scene, "crank.points.B[0]=0.08:0.12:5", &ties, results);
        for (k, r) in column(&sweep, "crank.points.B[0]").into_iter().enumerate() {
            let mass = ("crank.mass", 18.0 * r);
            let others = [
                ("crank.center[0]", -0.6 * r),
                ("crank.inertia", 6.0 * r * r * r),
            ];
            let values = [&[("crank.points.B[0]", r), mass][..], &others].concat();
            let alone = scene.with_values(&values).expect("a scene");
            for result in results {
                let wanted = value(&alone, &format!("crank.mass={:?}", mass.1), result);
                assert_near(column(&sweep, result)[k], wanted, 1e-11, result);
            }
        }
    }
    let (scene, rms) = (driven_rssr(), "q.actuator_force.rms");
    let sweep = swept(
        &scene,
        "crank.mass=0.5,1",
        &["rocker.mass = 2 * `crank.mass`"],
        &[rms],
    );
    let alone = scene.with_value("rocker.mass", 2.0).expect("a scene");
    let wanted = value(&alone, "crank.mass=1", rms);
    assert_near(column(&sweep, rms)[1], wanted, 1e-12, "in space");
}

#[test]
fn parameters_limits_and_their_faults() {
    let section = "[sweep]\nparameters = { r = 0.1 }\nsubject-to = [\"phi.actuator_force.rms <= 0.5\"]\n\
                   tied = { \"crank.points.B[0]\" = \"r\", \"crank.center[0]\" = \"-0.6 * `crank.points.B[0]`\" }\n";
    let text = LEAST_RMS.text(241) + section;
    let scene = PlaneScene::parse("four-bar.toml", &text).expect("a scene");
    let (result, vary) = ("phi.actuator_force.rms", "r=0.1,0.11");
    let sweep = tried(&scene, vary, &[], &["m.max"]).expect("a sweep");
    let rms = [0.1, 0.11].map(|r| {
        let values = [("crank.points.B[0]", r), ("crank.center[0]", -0.6 * r)];
        let alone = LEAST_RMS.scene(241).with_values(&values).expect("a scene");
        value(&alone, "crank.mass=1.8", result)
    });
    assert!(rms[0] < 0.5 && rms[1] > 0.5, "{rms:?}");
    let found = column(&sweep, result);
    assert_near(found[0], rms[0], 1e-11, result);
    assert!(found[1].is_nan() && column(&sweep, "m.max")[1].is_nan());
    let messages = sweep
        .messages
        .iter()
        .map(|m| m.as_deref().unwrap_or_default());
    let messages: Vec<&str> = messages.collect();
    assert!(
        messages[0].is_empty() && messages[1].starts_with("left out: "),
        "{messages:?}"
    );
    for (vary, tied, message) in [
        (
            "crank.points.B[0]=0.1,0.2",
            "crank.mass=r",
            "both varied and tied",
        ),
        (vary, "crank.mas=r", "no number `crank.mas`"),
        (vary, "crank.mass=q", "unknown name `q`"),
        (
            vary,
            "crank.inertia=1+`crank.inertia`",
            "not tied before it",
        ),
    ] {
        let error = tried(&scene, vary, &[tied], &[]).expect_err("a fault");
        assert!(error.contains(message), "{error}");
    }
}

/// Distances from tables: at the same instants, at the same angles, and where the curve is nearest.
#[test]
fn distances_are_those_of_the_rows() {
    let folder = std::env::temp_dir().join(format!("dwell-targets-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let (bar, at_48) = (LEAST_RMS.scene(49), 0..48);
    let run = Rows::new(&bar, None);
    let write = |file: &str, head: &str, line: &dyn Fn(usize) -> Vec<f64>, count: usize| {
        let line = |k| {
            line(k)
                .iter()
                .map(|v| format!("{v:?}"))
                .collect::<Vec<_>>()
                .join(",")
        };
        let lines: Vec<String> = (0..count).map(line).collect();
        let text = format!("{head}\n{}\n", lines.join("\n"));
        std::fs::write(folder.join(file), text).expect("a file");
    };
    for (file, head) in [
        ("path.csv", "t,coupler.G.x,coupler.G.y,coupler.angle"),
        ("function.csv", "phi,rocker.angle"),
    ] {
        let line = |k| head.split(',').map(|name| run.at(k, name)).collect();
        write(file, head, &line, 48);
    }
    // About the circle of the crank's pin, of radius 0.1 m.
    let circle = |k: usize| {
        let angle = TAU * k as f64 / 12.0;
        vec![120.0 * angle.cos(), 120.0 * angle.sin()]
    };
    write("circle.csv", "crank.B.x [mm],crank.B.y [mm]", &circle, 12);
    let section = "[sweep.targets]\npath = { table = \"path.csv\", at = \"t\" }\ncircle = { table = \"circle.csv\" }\n\
                   function = { table = \"function.csv\", at = \"phi\" }\n";
    let file = folder.join("scene.toml");
    std::fs::write(&file, LEAST_RMS.text(145) + section).expect("a file");
    let scene = PlaneScene::read(&file).expect("a scene");
    let other = bar
        .with_value("rocker.points.C[0]", 0.252)
        .expect("a scene");
    let other = Rows::new(&other, None);
    let off = |name: &str, k: usize| other.at(k, name) - run.at(k, name);
    let rms = |of: &dyn Fn(usize) -> f64| {
        (at_48.clone().map(|k| of(k).powi(2)).sum::<f64>() / 48.0).sqrt()
    };
    let distance = rms(&|k| off("coupler.G.x", k).hypot(off("coupler.G.y", k)));
    let turned: Vec<f64> = at_48.clone().map(|k| off("coupler.angle", k)).collect();
    let wanted = [
        ("path.distance.rms", 0.0, distance),
        ("path.angle.max_abs", 0.0, largest(&turned, f64::abs)),
        ("function.angle.rms", 0.0, rms(&|k| off("rocker.angle", k))),
        ("circle.distance.max_abs", 0.02, 0.02),
        ("circle.distance.mean", 0.02, 0.02),
    ];
    let results = wanted.map(|(result, ..)| result);
    let sweep = swept(&scene, "rocker.points.C[0]=0.25,0.252", &[], &results);
    for (result, own, of_other) in wanted {
        let found = column(&sweep, result);
        assert_near(found[0], own, 1e-12, result);
        assert_near(found[1], of_other, 1e-12, result);
        assert!(of_other > 1e-4, "{result}: {of_other}");
    }
    std::fs::remove_dir_all(folder).expect("removed");
}

/// Near a singular position the least determinant vanishes; in space, too.
#[test]
fn the_least_determinant_vanishes_at_a_singular_position() {
    let result = "closure.determinant.min";
    // A crank of length a rotates up to a + d = b + c.
    let n = LEAST_BY_LENGTHS.numbers();
    let near = format!("crank.points.B[0]={:?}", n[1] + n[2] - n[3] - 1e-8);
    let near = value(&LEAST_BY_LENGTHS.scene(361), &near, result);
    assert!(near > 0.0 && near < 1e-3, "{near}");
    // The sine of the transmission angle, at the pin of rod and piston.
    let crank = fixtures::scene("slider-crank");
    let angles = Rows::new(&crank, Some(36_001));
    let least = -largest(angles.of("C.transmission_angle"), |angle| -angle.sin());
    assert_near(
        value(&crank, "piston.mass=0.7", result),
        least,
        1e-7,
        "slider-crank",
    );
    let rssr =
        [0.25, 0.15].map(|x| value(&driven_rssr(), &format!("ground.points.D[0]={x:?}"), result));
    assert!(rssr[0] > 0.3 && rssr[1] < 0.4 * rssr[0], "{rssr:?}");
}
