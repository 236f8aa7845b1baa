//! Problems with known optima and multipliers.

use super::*;
use crate::Dual;

/// Goal, inequalities and equalities at a point.
type Values = (Dual, Vec<Dual>, Vec<Dual>);

/// A problem of W. Hock and K. Schittkowski, *Test Examples for Nonlinear Programming Codes* (1981): goal, inequalities, equalities.
type Functions = fn(&[Dual]) -> Values;

struct Known {
    number: usize,
    functions: Functions,
    start: &'static [f64],
    bounds: &'static [[f64; 2]],
    goal: f64,
}

fn evaluated(functions: Functions, x: &[f64]) -> Evaluation {
    let by = |k: usize| {
        let each = x.iter().enumerate();
        let at = each.map(|(i, v)| Dual {
            v: *v,
            d: f64::from(u8::from(i == k)),
        });
        functions(&at.collect::<Vec<_>>())
    };
    let all: Vec<_> = (0..x.len()).map(by).collect();
    let row = |of: &dyn Fn(&Values) -> Dual, family, is_equality| Constraint {
        value: of(&all[0]).v,
        slope: all.iter().map(|a| of(a).d).collect(),
        is_equality,
        family,
        place: 0.0,
    };
    let inequalities = all[0].1.len();
    let mut constraints: Vec<Constraint> = (0..inequalities)
        .map(|k| row(&|a| a.1[k], k, false))
        .collect();
    let equalities = 0..all[0].2.len();
    constraints.extend(equalities.map(|k| row(&|a| a.2[k], inequalities + k, true)));
    Evaluation {
        goal: all[0].0.v,
        slope: all.iter().map(|a| a.0.d).collect(),
        constraints,
    }
}

fn number(value: f64) -> Dual {
    Dual { v: value, d: 0.0 }
}

const WIDE: [f64; 2] = [-1e3, 1e3];

const KNOWN: &[Known] = &[
    Known {
        number: 6,
        functions: |x| {
            let e = x[0] - number(1.0);
            (e * e, vec![], vec![number(10.0) * (x[1] - x[0] * x[0])])
        },
        start: &[-1.2, 1.0],
        bounds: &[WIDE; 2],
        goal: 0.0,
    },
    Known {
        number: 35,
        functions: |x| {
            let [a, b, c] = [x[0], x[1], x[2]];
            let n = number;
            let goal = n(9.0) - n(8.0) * a - n(6.0) * b - n(4.0) * c
                + n(2.0) * a * a
                + n(2.0) * b * b
                + c * c
                + n(2.0) * a * b
                + n(2.0) * a * c;
            (goal, vec![n(3.0) - a - b - n(2.0) * c], vec![])
        },
        start: &[0.5; 3],
        bounds: &[[0.0, 1e3]; 3],
        goal: 1.0 / 9.0,
    },
    Known {
        number: 43,
        functions: |x| {
            let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
            let n = number;
            let goal =
                a * a + b * b + n(2.0) * c * c + d * d - n(5.0) * a - n(5.0) * b - n(21.0) * c
                    + n(7.0) * d;
            let one = n(8.0) - a * a - b * b - c * c - d * d - a + b - c + d;
            let two = n(10.0) - a * a - n(2.0) * b * b - c * c - n(2.0) * d * d + a + d;
            let three = n(5.0) - n(2.0) * a * a - b * b - c * c - n(2.0) * a + b + d;
            (goal, vec![one, two, three], vec![])
        },
        start: &[0.0; 4],
        bounds: &[WIDE; 4],
        goal: -44.0,
    },
    Known {
        number: 71,
        functions: |x| {
            let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
            let squares = a * a + b * b + c * c + d * d;
            let product = a * b * c * d - number(25.0);
            (
                a * d * (a + b + c) + c,
                vec![product],
                vec![squares - number(40.0)],
            )
        },
        start: &[1.0, 5.0, 5.0, 1.0],
        bounds: &[[1.0, 5.0]; 4],
        goal: 17.014_017_289_134_8,
    },
];

#[test]
fn problems_of_hock_and_schittkowski_have_their_optima() {
    for known in KNOWN {
        let settings = SequentialSettings {
            tolerance: 1e-8,
            iterations: 100,
            families: 4,
        };
        let mut problem = |x: &[f64]| Some(evaluated(known.functions, x));
        let found = minimise(
            &mut problem,
            known.start,
            known.bounds,
            settings,
            &mut |_, _| true,
        );
        let found = found.expect("a start");
        let error = (found.evaluation.goal - known.goal).abs() / (1.0 + known.goal.abs());
        // Seen: 1.2e-12 (71, the digits of the source).
        assert!(
            found.is_converged && error < 1e-10,
            "{}: {error:e} {found:?}",
            known.number
        );
        assert!(
            found.evaluations < 30,
            "{}: {}",
            known.number,
            found.evaluations
        );
    }
}

#[test]
fn the_multiplier_is_the_price_of_a_constraint() {
    // Problem 43: at the optimum (0, 1, 2, −1) the multipliers are 1, 0 and 2.
    let known = &KNOWN[2];
    let settings = SequentialSettings {
        tolerance: 1e-9,
        iterations: 100,
        families: 3,
    };
    let mut problem = |x: &[f64]| Some(evaluated(known.functions, x));
    let found = minimise(
        &mut problem,
        known.start,
        known.bounds,
        settings,
        &mut |_, _| true,
    );
    for (found, expected) in found
        .expect("a start")
        .multipliers
        .iter()
        .zip([1.0, 0.0, 2.0])
    {
        // Seen: 2e-9.
        assert!((found - expected).abs() < 1e-7, "{found}");
    }
}

#[test]
fn a_least_peak_has_several_active_members_of_one_family() {
    // The least level above x², (x − 2)² and 1 − x: two are active at x = 1.
    let mut problem = |at: &[f64]| {
        let (x, level) = (at[0], at[1]);
        let all = [
            (x * x, 2.0 * x),
            ((x - 2.0).powi(2), 2.0 * (x - 2.0)),
            (1.0 - x, -1.0),
        ];
        let member = |(k, (value, slope)): (usize, &(f64, f64))| Constraint {
            value: level - value,
            slope: vec![-slope, 1.0],
            is_equality: false,
            family: 0,
            place: 0.3 * k as f64,
        };
        Some(Evaluation {
            goal: level,
            slope: vec![0.0, 1.0],
            constraints: all.iter().enumerate().map(member).collect(),
        })
    };
    let settings = SequentialSettings {
        tolerance: 1e-10,
        iterations: 50,
        families: 1,
    };
    let found = minimise(
        &mut problem,
        &[5.0, 0.0],
        &[WIDE; 2],
        settings,
        &mut |_, _| true,
    );
    let found = found.expect("a start");
    assert!((found.evaluation.goal - 1.0).abs() < 1e-10 && found.is_converged);
    for (found, expected) in found.multipliers.iter().zip([0.5, 0.5, 0.0]) {
        assert!((found - expected).abs() < 1e-8);
    }
}

#[test]
fn constraints_without_a_common_point_are_not_called_optimal() {
    let mut problem = |x: &[f64]| {
        let side = |sign: f64, family| Constraint {
            value: sign * x[0] - 1.0,
            slope: vec![sign],
            is_equality: false,
            family,
            place: 0.0,
        };
        Some(Evaluation {
            goal: x[0] * x[0],
            slope: vec![2.0 * x[0]],
            constraints: vec![side(1.0, 0), side(-1.0, 1)],
        })
    };
    let settings = SequentialSettings {
        tolerance: 1e-8,
        iterations: 50,
        families: 2,
    };
    let found = minimise(&mut problem, &[0.3], &[WIDE], settings, &mut |_, _| true);
    let found = found.expect("a start");
    assert!(!found.is_converged && found.evaluation.violation() >= 1.0);
}

#[test]
fn a_constant_constraint_has_no_multiplier() {
    // (x − 1)², where something that no variable changes is off its limit by a rounding error, and by more.
    let search = |off: f64| {
        let mut problem = |x: &[f64]| {
            Some(Evaluation {
                goal: (x[0] - 1.0).powi(2),
                slope: vec![2.0 * (x[0] - 1.0)],
                constraints: vec![Constraint {
                    value: off,
                    slope: vec![0.0],
                    is_equality: true,
                    family: 0,
                    place: 0.0,
                }],
            })
        };
        let settings = SequentialSettings {
            tolerance: 1e-8,
            iterations: 50,
            families: 1,
        };
        let found = minimise(&mut problem, &[0.3], &[WIDE], settings, &mut |_, _| true);
        found.expect("a start")
    };
    let [near, far] = [1e-9, 1e-3].map(search);
    for found in [&near, &far] {
        // Seen: 0.
        assert!((found.x[0] - 1.0).abs() < 1e-12 && found.multipliers == [0.0]);
    }
    assert!(near.is_converged && !far.is_converged);
}
