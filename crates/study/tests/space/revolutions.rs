//! Motions over many revolutions and through changes of the coordinate: geared wheels as in the plane, a linkage driven at either end.

use super::as_in_the_plane::{analysed, by_dop853, column, difference, simulated};
use super::trajectories::written;
use dwell_findings::Table;
use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::{
    Analysis, MotionSolver, SolverSettings, analyse_trajectory, no_progress, simulate_with,
};

/// Two gears, of which the second is wound up by a torsion spring: over many revolutions, forwards and back beyond the start, its angle,
/// the moment of the spring and the motion are those of the plane, with an implicit method, too. Largest differences seen: 2.7e-15 where
/// the motion is prescribed, 2.4e-10 by DOP853, 8.4e-8 by BDF.
#[test]
fn geared_wheels_count_all_revolutions() {
    let text = |space: bool| {
        let point = |p: &str| {
            if space {
                format!("[{p}, 0]")
            } else {
                format!("[{p}]")
            }
        };
        let [o, c, far, center] = ["0, 0", "0.05, 0", "0.03, 0", "0.003, 0.001"].map(point);
        let inertia = |of: &str| {
            if space {
                format!("[{of}, {of}, {of}]")
            } else {
                of.to_owned()
            }
        };
        let axis = if space { ", axis = [0, 0, 1]" } else { "" };
        let (mesh, angle, other) = if space {
            (
                "{ gear = [\"one\", \"two\"], pitch-point = \"ground.P\", normal = [0, 1, 0] }",
                "\"A\"",
                "\"C\"",
            )
        } else {
            (
                "{ gear = [\"one.A\", \"two.C\"], radii = [0.03, 0.02] }",
                "[\"ground\", \"one\"]",
                "[\"ground\", \"two\"]",
            )
        };
        let gravity = point("0, -9.81");
        let place = if space {
            "two = { at = [0.05, 0, 0] }"
        } else {
            ""
        };
        format!(
            "bodies.ground.points = {{ A = {o}, C = {c}, P = {far} }}\n\
             bodies.one = {{ points = {{ A = {o} }}, mass = 1, center = {center}, inertia = {} }}\n\
             bodies.two = {{ points = {{ C = {o} }}, mass = 0.6, center = {center}, inertia = {} }}\n\
             joints.A = {{ revolute = [\"ground.A\", \"one.A\"]{axis} }}\n\
             joints.C = {{ revolute = [\"ground.C\", \"two.C\"]{axis} }}\n\
             joints.mesh = {mesh}\n\
             actuators.phi = {{ angle = {angle} }}\n\
             coordinates.psi = {{ angle = {other} }}\n\
             loads.weight = {{ gravity = {gravity} }}\n\
             loads.coil = {{ torsion-spring = {other}, stiffness = 0.02, free-angle = -60 }}\n\
             motion = {{ duration = 2, initial-velocity = -40 }}\n\
             [assembly]\nphi = 0\n{place}\n\
             [prescribed]\nduration = 1\npoints = 41\nphi = {{ expression = \"-30 + 75*t\" }}\n",
            inertia("5e-4"),
            inertia("2e-4"),
        )
    };
    let plane = PlaneScene::parse("plane", &text(false)).unwrap_or_else(|e| panic!("{e}"));
    let space = SpaceScene::parse("space", &text(true)).unwrap_or_else(|e| panic!("{e}"));
    let names = ["psi", "coil.load_moment", "coil.power", "A.x", "C.y"];
    let mut largest = 0.0_f64;
    let mut compare = |plane: &Table, space: &Table, allowed: f64| {
        for name in names {
            let off = difference(&column(plane, name), &column(space, name));
            assert!(off < allowed, "{name}: {off:.1e}");
            largest = largest.max(off);
        }
    };
    let done = analyse_trajectory(&plane, Analysis::Kinetostatics, None, &no_progress);
    let prescribed = written(&done.unwrap_or_else(|e| panic!("{e:?}")));
    let found = written(&analysed(&space, Analysis::Kinetostatics));
    compare(&prescribed, &found, 2e-13);
    let (phi, psi) = (column(&found, "phi"), column(&found, "psi"));
    assert!(
        phi.iter()
            .zip(&psi)
            .all(|(phi, psi)| (psi + 1.5 * phi).abs() < 1e-12)
    );
    for (method, allowed) in [
        (dwell_dynamics::Method::Dop853, 2e-8),
        (dwell_dynamics::Method::Bdf, 2e-6),
    ] {
        let solver = MotionSolver::Settings(SolverSettings {
            method,
            ..SolverSettings::default()
        });
        let plane = simulate_with(&plane, &solver, None, &no_progress);
        let plane = written(&plane.unwrap_or_else(|e| panic!("{e:?}")));
        let found = simulated(&space, &solver, None);
        assert!(found.early_stop.is_none(), "{:?}", found.early_stop);
        compare(&plane, &written(&found), allowed);
    }
    println!("geared wheels: {largest:.1e}");
}

/// The spatial crank-rocker driven at its rocker, which starts next to its dead point, moves as driven at its crank. Largest difference
/// seen 6e-13.
#[test]
fn a_linkage_in_space_moves_alike_whichever_joint_is_driven() {
    let path = "../../validation/spatial/rssr.toml";
    let path = format!("{}/{path}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("a scene");
    let motion = |speed: f64| format!("[motion]\nduration = 2\ninitial-velocity = {speed:?}\n");
    let parse = |text: &str| SpaceScene::parse("rssr", text).unwrap_or_else(|e| panic!("{e}"));
    let named = "[coordinates]\npsi = { angle = \"D\" }\n[loads]";
    let by_crank = parse(&(text.replace("[loads]", named) + &motion(8.0)));
    let by_crank = written(&simulated(&by_crank, &by_dop853(), None));
    let [psi, speed] = ["psi", "psi.velocity"].map(|name| column(&by_crank, name)[0]);
    let driver = "psi = { angle = \"D\" }";
    let by_rocker = text
        .replace("q = { angle = \"A\" }", driver)
        .replace("\nq = 0\n", &format!("\npsi = {psi:?}\n"));
    let found = simulated(&parse(&(by_rocker + &motion(speed))), &by_dop853(), None);
    assert!(found.early_stop.is_none(), "{:?}", found.early_stop);
    let changed = "coordinate changed from psi (next to its dead point) to angle of A";
    assert!(found.outcome.summary.contains(changed));
    let by_rocker = written(&found);
    for name in [
        "psi",
        "crank.B.x",
        "rocker.C.vx",
        "coupler.C.az",
        "A.x",
        "D.moment-x",
    ] {
        let off = difference(&column(&by_crank, name), &column(&by_rocker, name));
        assert!(off < 5e-11, "{name}: {off:.1e}");
    }
}
