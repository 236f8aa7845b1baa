//! Where m is largest between the positions of the rows: near a limit position or a change point it rises and falls within a step.

use crate::models::PreparedScene;
use crate::reduce::compute::ReducedCurves;
use dwell_kinetostatics::ReducedModel as _;

/// Part of m that the rows may miss without a word.
const MIN_EXCESS: f64 = 1e-3;
/// Halvings of a step between rows: down to rounding.
const HALVINGS: usize = 60;

/// The coordinate (rad or m) between two rows where m is largest, and that m; none where a row shows it to a thousandth.
pub(crate) fn peak_between_rows(
    prepared: &PreparedScene<'_>,
    curves: &ReducedCurves,
) -> Option<[f64; 2]> {
    let all = &curves.coefficients;
    let largest = (0..all.len()).max_by(|&i, &j| all[i].m.total_cmp(&all[j].m))?;
    // m rises where ½m′ is above zero: towards one of the neighbours.
    let other = match all[largest].half_dm > 0.0 {
        true => largest + 1,
        false => largest.checked_sub(1)?,
    };
    let (mut inside, mut outside) = (curves.q[largest], *curves.q.get(other)?);
    let rises = all[largest].half_dm > 0.0;
    let mut workspace = prepared.model.workspace();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        let (_, half_dm) = prepared.model.inertia(middle, &mut workspace).ok()?;
        match (half_dm > 0.0) == rises {
            true => inside = middle,
            false => outside = middle,
        }
    }
    let (m, _) = prepared.model.inertia(inside, &mut workspace).ok()?;
    (m > all[largest].m * (1.0 + MIN_EXCESS)).then_some([inside, m])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;
    use dwell_scene::Scene;

    /// A crank's pin in the slot of a rocker, whose pivot is outside the pin's circle by a part `gap` of the crank: where they
    /// are nearest, the rocker turns 1/gap times as fast as the crank.
    fn slotted_rocker(gap: f64) -> String {
        let (y, x) = 0.3137_f64.sin_cos();
        let pivot = [x, y].map(|v| v * (1.0 + gap));
        format!(
            "[bodies.ground]\npoints = {{ A = [0, 0], D = {pivot:?} }}\n[bodies.crank]\npoints = {{ A = [0, 0], B = [1, 0] }}\nmass = 1\ncenter = [0.5, 0]\ninertia = 0.1\n\
             [bodies.rocker]\npoints = {{ D = [0, 0] }}\nmass = 1\ncenter = [0.2, 0]\ninertia = 0.1\n\
             [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nD = {{ revolute = [\"ground.D\", \"rocker.D\"] }}\nB = {{ slot = [\"rocker.D\", \"crank.B\"], axis = [1, 0] }}\n\
             [actuators.phi]\nangle = [\"ground\", \"crank\"]\n[assembly]\nphi = 1.0\nrocker = 2.2\n"
        )
    }

    #[test]
    fn a_peak_narrower_than_a_step_is_found() {
        let text = slotted_rocker(1e-3);
        let scene = Scene::parse("near.toml", &text).unwrap();
        let prepared = PreparedScene::without_loads(&scene).unwrap();
        let curves = ReducedCurves::new(&prepared, None).unwrap();
        let [q, m] = peak_between_rows(&prepared, &curves).unwrap();
        let rows = curves
            .coefficients
            .iter()
            .fold(0.0_f64, |max, at| max.max(at.m));
        assert!(m > 1.4 * rows, "{m} against {rows}");
        // In closed form: 0.35 + 0.14 / gap².
        assert!(
            (q - 0.3137).abs() < 1e-9 && (m / 140_000.35 - 1.0).abs() < 1e-9,
            "{q} {m}"
        );
        // Evaluated at many positions around it, m is nowhere larger.
        let near = (-2000..=2000).map(|k| q + 1e-6 * f64::from(k));
        let dense = ReducedCurves::at(&prepared, near.collect()).unwrap();
        let largest = dense
            .coefficients
            .iter()
            .fold(0.0_f64, |max, at| max.max(at.m));
        assert!(
            largest <= m * (1.0 + 1e-9) && largest > 0.999 * m,
            "{largest} {m}"
        );
    }

    #[test]
    fn a_peak_that_rows_show_is_not_mentioned() {
        let text = slotted_rocker(0.5);
        let scene = Scene::parse("far.toml", &text).unwrap();
        let prepared = PreparedScene::without_loads(&scene).unwrap();
        let curves = ReducedCurves::new(&prepared, None).unwrap();
        assert_eq!(peak_between_rows(&prepared, &curves), None);
    }
}
