//! The planar slider-crank with friction, and the same in an oblique plane.

use dwell_geometry::space::{Placement, Rotation, Vec3, vec3};
use dwell_scene::{PlaneScene, SpaceScene};

/// Gravity, m/s².
pub(super) const G: f64 = 9.81;

/// The frame of a plane in space.
pub(super) fn tilt() -> Placement {
    Placement {
        position: vec3(0.7, -0.3, 1.1),
        rotation: Rotation::of_vector(vec3(0.9, -1.3, 0.4)),
    }
}

/// A vector as it is written in a scene.
pub(super) fn written(v: Vec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

pub(super) fn scene(text: &str) -> SpaceScene {
    SpaceScene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{text}\n{e:?}"))
}

/// The slider-crank of the planar case with friction, without that of one pin, which is a ball in space.
pub(super) fn planar_slider_crank() -> PlaneScene {
    let path = format!(
        "{}/../validation/slider-crank-friction/scene.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("the file");
    let ball = "C = { coefficient = 0.08, radius = 8, regularization-speed = 0.5 }\n";
    assert!(text.contains(ball));
    let text = text.replace(ball, "");
    PlaneScene::parse("slider-crank.toml", &text).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The same in an oblique plane, without redundant constraints: B cylindrical, C a ball; the motion as given.
pub(super) fn oblique_slider_crank(friction: &str, rest: &str) -> SpaceScene {
    let frame = tilt();
    let turn = |x: f64, y: f64, z: f64| written(frame.rotation.apply(vec3(x, y, z)));
    let point = |x: f64, y: f64| {
        let at = frame.position.scaled(1e3) + frame.rotation.apply(vec3(x, y, 0.0));
        written(at)
    };
    let turned = |angle: f64| {
        let own = Rotation::of_vector(vec3(0.0, 0.0, angle));
        written(frame.rotation.after(&own).vector())
    };
    let (sin, cos) = 0.5_f64.sin_cos();
    let text = format!(
        "[units]\nlength = \"mm\"\ninertia = \"kg m2\"\n\
         [bodies.ground]\npoints = {{ A = {a}, G = {g} }}\n\
         [bodies.crank]\npoints = {{ A = [0, 0, 0], B = [80, 0, 0] }}\nmass = 2.0\ncenter = [15, 2, 0]\ninertia = [0, 0.004, 0.004]\n\
         [bodies.rod]\npoints = {{ B = [0, 0, 0], C = [280, 0, 0] }}\nmass = 1.2\ncenter = [95, 3, 0]\ninertia = [0, 0.0085, 0.0085]\n\
         [bodies.piston]\npoints = {{ C = [0, 0, 0] }}\nmass = 0.9\ncenter = [12, 4, 0]\ninertia = [0.0001, 0.0006, 0.0006]\n\
         [joints]\n\
         A = {{ revolute = [\"ground.A\", \"crank.A\"], axes = [{z}, [0, 0, 1]], normals = [{x}, [1, 0, 0]] }}\n\
         B = {{ cylindrical = [\"crank.B\", \"rod.B\"], axis = [0, 0, 1] }}\n\
         C = {{ spherical = [\"rod.C\", \"piston.C\"] }}\n\
         guide = {{ prismatic = [\"ground.G\", \"piston.C\"], axes = [{x}, [1, 0, 0]], normals = [{z}, [0, 0, 1]] }}\n\
         [actuators]\nphi = {{ angle = \"A\" }}\n\
         [assembly]\nphi = 0.5\ncrank = {{ at = {a}, turn = {crank} }}\nrod = {{ at = {b}, turn = {rod} }}\npiston = {{ at = {c}, turn = {piston} }}\n\
         [loads]\nweight = {{ gravity = {weight} }}\n\
         gas = {{ force = \"piston.C\", direction = {back}, magnitude = \"400*(1 + cos(phi))\" }}\n\
         [friction]\n{friction}\n{rest}\n",
        a = point(0.0, 0.0),
        g = point(0.0, 25.0),
        b = point(80.0 * cos, 80.0 * sin),
        c = point(349.9, 25.0),
        x = turn(1.0, 0.0, 0.0),
        z = turn(0.0, 0.0, 1.0),
        back = turn(-1.0, 0.0, 0.0),
        weight = turn(0.0, -G, 0.0),
        crank = turned(0.5),
        rod = turned(-0.048),
        piston = turned(0.0),
    );
    scene(&text)
}

/// The friction of the planar case: in the cylindrical joint the speed of the surface is r ω.
pub(super) const SMOOTH: &str = "A = { coefficient = 0.08, radius = 12, regularization-speed = 0.5, viscous = 0.002 }\n\
     B = { coefficient = 0.08, radius = 10, regularization-speed = 5 }\n\
     guide = { coefficient = 0.1, guide-length = 60, regularization-speed = 5, viscous = 2 }\n";
