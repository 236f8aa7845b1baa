//! Points on lines and in planes: the joints do what massless blocks with balls do.

use super::oblique::scene;
use dwell_scene::SpaceScene;
use dwell_study::PreparedSpaceScene;
use dwell_study::reduce::compute::ReducedScene as _;

/// A feeler on an inclined plane, a point of which is on a line of the ground, with these bodies and joints beside; its guide is driven or not.
fn feeler(bodies: &str, joints: &str, guide: &str, is_driven: bool) -> SpaceScene {
    let (actuator, assembly) = match is_driven {
        true => (
            format!("s = {{ travel = \"{guide}\" }}"),
            "s = 0.003\ncrank = { turn = [0, 0, 0.3] }",
        ),
        false => ("phi = { angle = \"A\" }".to_owned(), "phi = 0.3"),
    };
    // What acts along the guide acts on the block, and goes through its ball.
    let (of_guide, resistance) = match is_driven {
        true => (
            "",
            format!("resistance = {{ slide-damper = \"{guide}\", damping = 3 }}"),
        ),
        false => (", \"Q.x\", \"Q.y\", \"Q.z\"", String::new()),
    };
    scene(&format!(
        "[bodies.ground]\npoints = {{ A = [0, 0, 0], S = [0.25, 0.05, 0.1], T = [0.4, 0, 0.12] }}\n\
         [bodies.crank]\npoints = {{ A = [0, 0, 0], B = [0.1, 0.03, 0.02] }}\nmass = 0.4\ncenter = [0.05, 0.01, 0]\ninertia = [0.001, 0.002, 0.002]\n\
         [bodies.feeler]\npoints = {{ B = [0, 0, 0], P = [0.3, 0, 0], Q = [0.18, 0.04, 0.01] }}\nmass = 0.8\ncenter = [0.14, 0.01, 0.02]\n\
         inertia = [0.002, 0.009, 0.008, 0.0003, -0.0002, 0.0001]\n{bodies}\n\
         [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"], axis = [0, 0, 1] }}\nB = {{ spherical = [\"crank.B\", \"feeler.B\"] }}\n{joints}\n\
         [actuators]\n{actuator}\n[coordinates]\nalong = {{ travel = \"{guide}\" }}\n\
         [assembly]\n{assembly}\nfeeler = {{ at = [0.087, 0.058, 0.02], turn = [0.062, -0.392, -0.255] }}\n\
         [loads]\nweight = {{ gravity = [0, 0, -9.81] }}\n{resistance}\n\
         [requests]\nreactions = [\"A\", \"B.x\", \"B.y\", \"B.z\", \"P.x\", \"P.y\", \"P.z\"{of_guide}]\n"
    ))
}

/// What `reduce` computes of a scene at these coordinates: m, ½m′, and a, b, c of the named reactions.
fn reduced(scene: &SpaceScene, q: &[f64]) -> Vec<Vec<f64>> {
    let prepared = PreparedSpaceScene::new(scene).unwrap_or_else(|e| panic!("{e}"));
    let coefficients = prepared.coefficients(q).expect("poses");
    let loads = prepared.unit_loads(q).expect("poses").expect("loads");
    let columns = loads.columns(&prepared);
    let rows = coefficients.iter().enumerate().map(|(i, at)| {
        let own = [at.m, at.half_dm].into_iter();
        let reactions = at.a.iter().chain(&at.b).copied();
        own.chain(reactions)
            .chain(columns.iter().map(|(_, values)| values[i]))
            .collect()
    });
    rows.collect()
}

/// In the place of a point in a plane, two massless slides with a ball, and of a point on a line one slide with a ball, transmit the same forces: all coefficients agree,
/// driven by the crank or by the travel of the point.
#[test]
fn points_on_lines_and_in_planes_do_what_blocks_with_balls_do() {
    let points = "P = { point-in-plane = [\"ground.T\", \"feeler.P\"], axis = [0.2, 0.1, 1] }\n\
                  Q = { point-on-line = [\"ground.S\", \"feeler.Q\"], axis = [1, 0.1, 0.05] }";
    let bodies = "[bodies.across]\npoints = { T = [0, 0, 0] }\n[bodies.disc]\npoints = { T = [0, 0, 0] }\n[bodies.block]\npoints = { Q = [0, 0, 0] }\n\
                  [assembly.across]\nat = [0.36, 0, 0.13]\n[assembly.disc]\nat = [0.36, -0.02, 0.13]\n[assembly.block]\nat = [0.253, 0.05, 0.1]";
    let blocks = "first = { prismatic = [\"ground.T\", \"across.T\"], axis = [1, 0, -0.2] }\n\
                  second = { prismatic = [\"across.T\", \"disc.T\"], axis = [-0.02, 1.04, -0.1] }\n\
                  guide = { prismatic = [\"ground.S\", \"block.Q\"], axis = [1, 0.1, 0.05] }\n\
                  P = { spherical = [\"disc.T\", \"feeler.P\"] }\nQ = { spherical = [\"block.Q\", \"feeler.Q\"] }";
    let mut largest = 0.0_f64;
    for is_driven in [false, true] {
        let q: &[f64] = if is_driven {
            &[-0.02, 0.003, 0.009]
        } else {
            &[-0.2, 0.3, 0.6]
        };
        let found = reduced(&feeler("", points, "Q", is_driven), q);
        let wanted = reduced(&feeler(bodies, blocks, "guide", is_driven), q);
        for (found, wanted) in found.iter().zip(&wanted) {
            assert_eq!(found.len(), wanted.len());
            let scale = wanted.iter().fold(0.0_f64, |all, x| all.max(x.abs()));
            for (x, y) in found.iter().zip(wanted) {
                largest = largest.max((x - y).abs() / scale);
            }
        }
    }
    // Seen: 5.1e-14.
    println!("points: {largest:.1e}");
    assert!(largest < 1e-12, "{largest:.1e}");
}
