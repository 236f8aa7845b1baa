//! Internal forces of links against closed forms.

use crate::scenes::{Case, all, case, load};
use dwell_geometry::{BodyId, Vec2, vec2};
use dwell_kinetostatics::{Distribution, EvaluatedState, FreeBodyForces, LinkForces, LoadKind};

const G: f64 = 9.81;

fn gravity() -> LoadKind {
    LoadKind::Gravity {
        direction: vec2(0.0, -1.0),
    }
}

/// 3 kg, 0.8 m, its frame's origin 0.1 m beside its first point.
const BAR: &str = r#"
    [bodies]
    ground.points = { A = [0.3, 0.1] }
    bar = { points = { A = [0.1, 0], B = [0.9, 0] }, mass = 3.0, center = [0.5, 0], inertia = 0.16 }
    [joints]
    A = { revolute = ["ground.A", "bar.A"] }
    [actuators]
    phi = { angle = ["ground", "bar"] }
"#;

fn link(state: &EvaluatedState<'_>, body: BodyId, points: [Vec2; 2]) -> LinkForces {
    let free_body_forces = FreeBodyForces::new(state.model()).expect("every reaction");
    let mut wrenches = Vec::new();
    free_body_forces.wrenches(state, &mut wrenches);
    let found = free_body_forces.link_forces(state, body, points, &wrenches);
    found.expect("a link with a length")
}

/// The cut of a turning bar carries the part beyond it: ∫ μ (ω² σ + g·u) dσ of pull, and
/// −∫ μ (σ − s)(α σ − g·n) dσ of bending.
#[test]
fn a_bar_turned_at_its_end_is_a_cantilever() {
    let case = Case::parse(BAR, |_| vec![load("weight", gravity(), G)]);
    let (l, density) = (0.8, 3.0 / 0.8);
    let (q, w, a) = (0.7, 5.0, -30.0);
    let mut memory = case.memory();
    let state = case.evaluate(&mut memory, 0.0, &[q], &[w], &[a]);
    let ends = [vec2(0.1, 0.0), vec2(0.9, 0.0)];
    let link = link(&state, case.body("bar"), ends);
    assert_eq!(link.distribution, Distribution::UniformBar);
    assert_eq!(link.length, l);
    let along = Vec2::from_angle(q);
    let (gu, gn) = (-G * along.y, -G * along.x);
    for section in link.sections(16) {
        let s = section.station;
        let rest = l - s;
        let (first, second) = ((l * l - s * s) / 2.0, rest * rest / 2.0);
        let product = rest * rest * (2.0 * l + s) / 6.0;
        let axial = density * (w * w * first + gu * rest);
        let shear = -density * (a * first - gn * rest);
        let bending = -density * (a * product - gn * second);
        // Sums of terms of the size of those at the fixed end, 40 N and 20 N·m.
        assert!((section.axial - axial).abs() < 1e-13 * 40.0);
        assert!((section.shear - shear).abs() < 1e-13 * 40.0);
        assert!(
            (section.bending - bending).abs() < 1e-13 * 20.0,
            "{section:?} {bending}"
        );
    }
    // The whole couple of the actuator enters at the fixed end.
    assert!(
        (link.section_after(0.0).bending + state.inverse_dynamics().tau[0]).abs() < 1e-13 * 20.0
    );
}

/// The coupler is a beam on two pins under its own inertia, which grows evenly along it from w₀ by w₁:
/// bending w₀ s (l − s)/2 + w₁ s (l² − s²)/6.
#[test]
fn a_coupler_is_a_beam_on_two_pins() {
    let case = Case::of(&case("crank-rocker"), |_| {
        vec![load("weight", gravity(), G)]
    });
    let coupler = case.body("coupler");
    let ends = [vec2(0.0, 0.0), vec2(3.5, 0.0)];
    let (l, density) = (3.5, 2.0 / 3.5);
    let mut memory = case.memory();
    for (t, q, q_dot, q_ddot) in case.states() {
        let state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
        let link = link(&state, coupler, ends);
        assert_eq!(link.distribution, Distribution::UniformBar);
        let states = state.bodies();
        let normal = states.body(coupler).rotation.perp();
        let load = ends.map(|p| {
            let apparent = states.point(coupler, p).acceleration + vec2(0.0, G);
            density * apparent.dot(normal)
        });
        let (w0, w1) = (load[0], (load[1] - load[0]) / l);
        let largest = (w0.abs() + load[1].abs()) * l * l;
        for section in link.sections(10) {
            let s = section.station;
            let bending = w0 * s * (l - s) / 2.0 + w1 * s * (l * l - s * s) / 6.0;
            let shear = -(w0 * (l / 2.0 - s) + w1 * (l * l / 6.0 - s * s / 2.0));
            // The pins' forces come from the whole mechanism's balance.
            assert!(
                (section.bending - bending).abs() < 2e-13 * largest,
                "{section:?} {bending}"
            );
            assert!((section.shear - shear).abs() < 2e-13 * largest);
        }
        // The first pin pulls the coupler with the axial force just behind it.
        let along = states.body(coupler).rotation;
        let [x, y] = ["B.x", "B.y"].map(|name| case.reaction(state.inverse_dynamics(), name));
        let pin = vec2(x, y);
        assert!((link.section_after(0.0).axial + pin.dot(along)).abs() < 1e-12 * pin.norm());
    }
}

/// At its second end, the internal forces of a link are exactly the actions there, independent of actions along and off
/// the link.
#[test]
fn sections_close_at_the_second_end() {
    for case in all() {
        let mut memory = case.memory();
        let free_body_forces = FreeBodyForces::new(&case.model).expect("every reaction");
        for (t, q, q_dot, q_ddot) in case.states().into_iter().take(4) {
            let state = case.evaluate(&mut memory, t, &q, &q_dot, &q_ddot);
            let mut wrenches = Vec::new();
            free_body_forces.wrenches(&state, &mut wrenches);
            for b in (0..case.mechanism.bodies.len()).filter(|&b| b != case.mechanism.ground) {
                let body = BodyId(b);
                // A line across the body with all that acts within its length.
                let points = [vec2(-9.0, 0.2), vec2(9.0, -0.1)];
                let link = free_body_forces
                    .link_forces(&state, body, points, &wrenches)
                    .expect("a link with a length");
                assert_eq!(link.distribution, Distribution::Lumped);
                let scale: f64 = 1.0 + wrenches.iter().map(|a| a.force.norm()).sum::<f64>();
                for end in [link.section_after(0.0), link.section_after(link.length)] {
                    let largest = end.axial.abs().max(end.shear.abs()).max(end.bending.abs());
                    // Everything stands between the ends: nothing is left at either. 18 m of lever.
                    assert!(largest < 1e-12 * 18.0 * scale, "{} {b}: {end:?}", case.name);
                }
                let sections = link.sections(4);
                assert!(sections.is_sorted_by(|a, b| a.station <= b.station));
                assert!(sections.iter().any(|s| s.shear.abs() > 1e-3 * scale / 1e3));
            }
        }
    }
}

#[test]
fn what_has_no_line_has_no_sections() {
    let case = Case::parse(BAR, |_| Vec::new());
    let mut memory = case.memory();
    let state = case.evaluate(&mut memory, 0.0, &[0.0], &[0.0], &[0.0]);
    let free_body_forces = FreeBodyForces::new(&case.model).expect("every reaction");
    let of = |body, points| free_body_forces.link_forces(&state, body, points, &[]);
    let points = [Vec2::ZERO, vec2(1.0, 0.0)];
    assert_eq!(of(case.body("ground"), points), None);
    assert_eq!(of(case.body("bar"), [Vec2::ZERO; 2]), None);
}
