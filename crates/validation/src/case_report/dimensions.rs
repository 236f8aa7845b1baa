//! Dimensions, masses and centres of mass of a case as a table.

use crate::report_parts::table;
use dwell_geometry::BodyId;
use dwell_report::Block;
use dwell_scene::PlaneScene;
use dwell_study::number_format::number;

/// Heading and table.
pub(super) fn blocks(scene: &PlaneScene) -> [Block; 3] {
    let bodies = 0..scene.mechanism.bodies.len();
    [
        Block::Heading("Dimensions and masses".to_owned()),
        Block::Text(
            "Points and centres of mass in the frame of their body; inertia about the centre of mass."
                .to_owned(),
        ),
        table(
            &["Body", "Points (m)", "Mass (kg)", "Centre of mass (m)", "Inertia (kg m²)"],
            bodies.map(|body| body_row(scene, body)),
        ),
    ]
}

fn body_row(scene: &PlaneScene, body: usize) -> Vec<String> {
    let pair = |x: f64, y: f64| format!("({}, {})", number(x), number(y));
    let points = scene.points.get(body).into_iter().flatten();
    let points = points.map(|(name, at)| format!("{name} {}", pair(at.x, at.y)));
    let points = points.collect::<Vec<_>>().join(", ");
    let mass = scene
        .masses
        .get(body)
        .filter(|_| body != scene.mechanism.ground);
    let values = match mass {
        Some(mass) => [
            number(mass.mass),
            pair(mass.center.x, mass.center.y),
            number(mass.inertia),
        ],
        None => [(); 3].map(|()| String::new()),
    };
    let name = scene.mechanism.body_name(BodyId(body)).to_owned();
    let [mass, center, inertia] = values;
    vec![name, points, mass, center, inertia]
}
