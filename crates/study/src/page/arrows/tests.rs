//! The pitch point of gears, by their circles.

use super::contacts::axes_of;
use dwell_geometry::{BodyId, Joint, JointKind, vec2};
use dwell_kinetostatics::Mesh;
use dwell_page::Direction;

/// The pitch point is on both pitch circles, and a positive tooth force turns the second gear counter-clockwise by its
/// pitch radius, whichever gear is the ring.
#[test]
fn a_tooth_force_acts_at_the_pitch_point_and_turns_the_second_gear() {
    let along = vec2(0.6, 0.8);
    for (radii, internal) in [
        ([0.3, 0.2], false),
        ([0.2, 0.5], false),
        ([0.5, 0.2], true),
        ([0.2, 0.5], true),
    ] {
        let [r1, r2] = radii;
        let distance: f64 = if internal { r1 - r2 } else { r1 + r2 };
        let centers = [vec2(1.0, -2.0), vec2(1.0, -2.0) + along * distance.abs()];
        let joint = Joint {
            name: "gears".to_owned(),
            bodies: [BodyId(1), BodyId(2)],
            points: centers,
            kind: JointKind::Gear { radii, internal },
        };
        let (place, axes) = axes_of(Mesh::of(&joint).unwrap());
        let Direction::Line { ends, place, .. } = place else {
            panic!("a line");
        };
        let [from, to] = ends.map(|end| vec2(end.point[0], end.point[1]));
        let pitch = from + (to - from) * place;
        let line = (to - from) * (1.0 / (to - from).norm());
        let [tangent, away] = axes.map(|axis| line * axis.x + line.perp() * axis.y);
        for (center, radius) in centers.into_iter().zip(radii) {
            assert!(((pitch - center).norm() - radius).abs() < 1e-12);
        }
        assert!(((pitch - centers[1]).cross(tangent) - r2).abs() < 1e-12);
        // Teeth push apart; those of a ring push to its centre.
        let outwards = if internal { -along } else { along };
        assert!((away - outwards).norm() < 1e-12);
    }
}
