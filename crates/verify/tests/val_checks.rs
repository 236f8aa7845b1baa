//! Every check passes for a correct subject, on mechanisms of every kind that is described so far,
//! with the tolerances that it states. `--nocapture` prints the table of measured differences.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test")]

mod subjects;

use dwell_geometry::{Vec2, vec2};
use dwell_verify::{Finding, Subject, verify_all};
use std::f64::consts::TAU;
use subjects::mechanisms::{
    Setup, crank_rocker, crank_rocker_of, flywheel, inverted_slider_crank, pendulum,
    relative_drive, single_dwell,
};

fn check(title: &str, setup: &Setup) -> Vec<Finding> {
    check_with(title, setup, 24, &setup.subject())
}

fn check_with(title: &str, setup: &Setup, count: usize, subject: &dyn Subject) -> Vec<Finding> {
    let findings = verify_all(&setup.case(count), subject, &[]);
    println!("\n{title}");
    for f in &findings {
        let verdict = if f.pass { "" } else { "FAIL " };
        println!(
            "  {:<20} {:8.1e} of {:7.0e}  {verdict}{}",
            f.key, f.relative_difference, f.tolerance, f.worst_at
        );
    }
    for f in &findings {
        assert!(f.pass, "{title}: {f:#?}");
        assert!(f.relative_difference.is_finite() && f.absolute_difference.is_finite());
    }
    findings
}

/// The findings of which the tolerance is the usual one, by key.
fn assert_at_most(findings: &[Finding], bounds: &[(&str, f64)]) {
    for &(key, bound) in bounds {
        let f = findings.iter().find(|f| f.key == key).expect(key);
        assert!(f.tolerance <= bound, "{key}: tolerance {:e}", f.tolerance);
    }
}

/// The tolerances on an ordinary mechanism.
const USUAL: [(&str, f64); 12] = [
    ("closure", 1e-13),
    ("m-energy", 1e-14),
    // Ten times its rounding, which is proportional to the size of the mechanism.
    ("m-energy-varying", 3e-14),
    ("half-dm-differences", 1e-11),
    ("half-dm-power", 1e-13),
    ("a-released", 1e-13),
    // Its rounding is proportional to the size of the mechanism too: 1.07e-11 of the single-dwell mechanism.
    ("b-released", 1.1e-11),
    ("b-virtual-power", 1e-13),
    ("power", 1e-11),
    ("momentum-force", 1e-11),
    ("newton-force", 5e-11),
    ("euler-moment", 5e-11),
];

#[test]
fn val_crank_rocker() {
    let findings = check("crank-rocker", &crank_rocker());
    assert_at_most(&findings, &USUAL);
    assert_at_most(&findings, &[("half-dm-spectral", 1e-12)]);
}

#[test]
fn val_single_dwell() {
    let findings = check("single-dwell", &single_dwell());
    assert_at_most(&findings, &USUAL);
    assert_at_most(&findings, &[("half-dm-spectral", 1e-12)]);
}

#[test]
fn val_inverted_slider_crank() {
    let findings = check("inverted slider-crank", &inverted_slider_crank());
    assert_at_most(&findings, &USUAL);
    assert_at_most(&findings, &[("half-dm-spectral", 1e-12)]);
}

/// An actuator between two moving bodies, and part of a revolution.
#[test]
fn val_relative_drive() {
    let findings = check("relative drive", &relative_drive());
    assert_at_most(&findings, &USUAL);
    assert!(findings.iter().all(|f| f.key != "half-dm-spectral"));
}

/// The results depend neither on frames nor on the place in the plane.
#[test]
fn val_reframed() {
    let by = (vec2(3.0, -2.0), vec2(-0.4, 0.3), 0.7);
    check(
        "single-dwell, reframed",
        &single_dwell().reframed(by.0, by.1, by.2),
    );
    check(
        "inverted slider-crank, reframed",
        &inverted_slider_crank().reframed(by.0, by.1, by.2),
    );
}

/// A thousand kilometres away the subject's poses are rounded to 1e-10 m, but coefficients computed
/// from differences of attachments are as good as ever, and so must be the dense side.
#[test]
fn val_far_away() {
    struct Far<'a>(&'a dyn Subject, Vec2);
    impl Subject for Far<'_> {
        fn poses(&self, q: f64) -> Result<Vec<dwell_verify::Pose>, dwell_verify::SubjectError> {
            let mut poses = self.0.frames(q)?;
            for pose in poses.iter_mut().skip(1) {
                pose[0] += self.1.x;
                pose[1] += self.1.y;
            }
            Ok(dwell_verify::Pose::all_in_plane(&poses))
        }
        fn coefficients(
            &self,
            q: f64,
        ) -> Result<dwell_verify::Coefficients, dwell_verify::SubjectError> {
            self.0.coefficients(q)
        }
        fn inverse_dynamics(
            &self,
            q: f64,
            q_dot: f64,
            q_ddot: f64,
        ) -> Result<dwell_verify::InverseDynamics, dwell_verify::SubjectError> {
            self.0.inverse_dynamics(q, q_dot, q_ddot)
        }
    }
    // Multiples of a power of two, so that the attachments themselves are moved without rounding.
    let mut near = crank_rocker();
    near.mechanism.joints[0].points[0] = vec2(0.0, 0.0);
    let at = vec2(1_048_576.0, -524_288.0);
    let subject = near.subject();
    let far = crank_rocker().reframed(at, Vec2::ZERO, 0.0);
    let findings = check_with("crank-rocker, far away", &far, 24, &Far(&subject, at));
    assert_at_most(&findings, &USUAL);
}

/// m is constant, and half dm/dq is zero: nothing may be divided by nothing.
#[test]
fn val_pendulum_and_flywheel() {
    for (title, setup) in [("pendulum", pendulum()), ("flywheel", flywheel())] {
        let findings = check(title, &setup);
        assert!(findings.iter().all(|f| f.key != "m-energy-varying"));
    }
}

/// All masses are zero: all coefficients are zero, and zero agrees with zero.
#[test]
fn val_massless() {
    let mut setup = crank_rocker();
    setup.masses.fill(dwell_kinetostatics::Mass::default());
    check("massless", &setup);
}

/// Close to a change point the branches nearly cross. The checks stay on their branch, and widen their tolerances by
/// the errors of their references.
#[test]
fn val_near_a_change_point() {
    for rocker in [1.6, 1.51, 1.501] {
        let findings = check(&format!("rocker of {rocker} m"), &crank_rocker_of(rocker));
        if rocker > 1.505 {
            assert!(findings.iter().all(|f| f.tolerance <= 1e-9));
        }
    }
}

/// Cranks from a tenth of a millimetre to ten metres: lengths and angles are never compared bare.
#[test]
fn val_sizes() {
    for size in [1e-4, 1e-2, 10.0] {
        let mut setup = single_dwell();
        for joint in &mut setup.mechanism.joints {
            joint.points = joint.points.map(|p| p * size);
        }
        for mass in &mut setup.masses {
            mass.center = mass.center * size;
            mass.inertia *= size * size;
        }
        for pose in &mut setup.initial_guess {
            pose[0] *= size;
            pose[1] *= size;
        }
        let findings = check(&format!("single-dwell times {size}"), &setup);
        assert_at_most(&findings, &USUAL);
    }
}

/// Crank-rockers at random, all of Grashof's kind by construction.
#[test]
fn val_random_crank_rockers() {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = |low: f64, high: f64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for trial in 0..20 {
        // Crank the shortest, ground the longest: 1 + ground < coupler + rocker.
        let (coupler, rocker) = (random(2.0, 5.0), random(2.0, 5.0));
        let longest = coupler.max(rocker);
        let ground = random(longest, coupler + rocker - 1.2).max(longest);
        let mut setup = crank_rocker();
        setup.mechanism.joints[2].points = [vec2(coupler, 0.0), vec2(rocker, 0.0)];
        setup.mechanism.joints[3].points[0] = vec2(ground, 0.0);
        for mass in setup.masses.iter_mut().skip(1) {
            mass.mass = random(0.1, 5.0);
            mass.center = vec2(random(-1.0, 3.0), random(-1.0, 1.0));
            mass.inertia = random(0.0, 4.0);
        }
        let angle = |a: f64, b: f64, c: f64| ((a * a + b * b - c * c) / (2.0 * a * b)).acos();
        let side = ground - 1.0;
        setup.initial_guess[2][2] = angle(side, coupler, rocker);
        setup.initial_guess[3] = [ground, 0.0, TAU / 2.0 - angle(side, rocker, coupler)];
        let setup = setup.reframed(
            vec2(0.5, 2.0),
            vec2(random(-1.0, 1.0), 0.2),
            random(0.0, 3.0),
        );
        check(&format!("random crank-rocker {trial}"), &setup);
    }
}
