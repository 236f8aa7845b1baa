//! Tables of the reduced model: their bounds, that m and ½m′ belong together, and their files.

use dwell_dynamics::{
    Event, EventKind, EventOccurrence, Method, Options, Orbit, ReducedCoordinate, ReducedOde,
    ReducedState, solve_reduced,
};
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::table::{FileError, Labels};
use dwell_kinetostatics::{
    Coefficients, ExactModel, Model, ReducedModel, TableDomain, TableError, TableQuantity,
    TabulatedModel,
};
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{self, scene};
use std::f64::consts::TAU;
use std::num::NonZeroUsize;

/// The golden section: steps of it fall on no grid.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A scene's model with every reaction and all loads; none of several actuators.
fn loaded(scene: &PlaneScene) -> Option<ExactModel> {
    let start = scene.assembly.to_configuration();
    let all = scene.mechanism.reactions();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &all).expect("a model");
    let model = model.with_loads(scene.loads.clone());
    ExactModel::new(model.expect("loads"))
}

fn case(name: &str) -> ExactModel {
    loaded(&scene(name)).expect("one actuator")
}

/// All cases of one actuator.
fn cases() -> Vec<(String, ExactModel)> {
    let names = fixtures::case_names().into_iter();
    names
        .filter_map(|name| Some((name.clone(), loaded(&scene(&name))?)))
        .collect()
}

/// Points of a table's extent that fall on none of its cells.
fn points(table: &TabulatedModel, count: usize) -> impl Iterator<Item = f64> {
    let [from, to] = table.domain();
    (0..count).map(move |i| from + (to - from) * (0.123_456_7 + GOLDEN * i as f64).fract())
}

/// The coefficients of a table in the order of its bounds.
fn of_table(table: &TabulatedModel, exact: &ExactModel, q: f64) -> Vec<f64> {
    let (mut at, mut loads) = (exact.model().coefficient_buffer(), table.response_buffer());
    table.coefficients(q, &mut (), &mut at).expect("within");
    table.unit_load_responses(q, &mut loads).expect("within");
    let Coefficients { m, half_dm, a, b } = at;
    [vec![m, half_dm], a, b, loads.w, loads.c].concat()
}

/// The same of the exact model.
fn of_model(exact: &ExactModel, q: f64) -> Vec<f64> {
    let model = exact.model();
    let (mut workspace, mut result, mut at) = (
        model.workspace(),
        model.result_buffer(),
        model.coefficient_buffer(),
    );
    model.reduce(q, &mut workspace, &mut at).expect("a pose");
    let (mut w, mut c) = (Vec::new(), Vec::new());
    let mut state = model
        .kinematic_state(&[q], &[1.0], &mut workspace)
        .expect("a pose");
    for load in 0..model.loads().len() {
        state.unit_load_response(load, &mut result).expect("a run");
        w.push(-result.tau[0]);
        c.extend(&result.reactions);
    }
    let Coefficients { m, half_dm, a, b } = at;
    [vec![m, half_dm], a, b, w, c].concat()
}

/// What a case's table is asked for: where the exact ½m′ is known to fewer digits, next to change points,
/// no table can have more. Of a mechanism without ends, as far as it goes in four turns of something.
fn requested(name: &str, exact: &ExactModel) -> (f64, TableDomain) {
    let accuracy = match name {
        "n-four-bar-a02" => 1e-8,
        "parallelogram-three-cranks" => 2e-8,
        _ => 1e-12,
    };
    match exact.range() {
        Range::Unbounded => (accuracy, TableDomain::Between(-1.0, 3.0)),
        _ => (accuracy, TableDomain::Full),
    }
}

fn table(name: &str, exact: &ExactModel) -> TabulatedModel {
    let (accuracy, extent) = requested(name, exact);
    TabulatedModel::new(exact, accuracy, extent).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Every coefficient of every case at 10 000 points that no part of the table was made or judged at.
#[test]
fn val_tables_keep_their_bounds() {
    let mut compared = 0;
    for (name, exact) in cases() {
        let table = table(&name, &exact);
        assert!(table.max_bound() <= table.accuracy(), "{name}");
        let mut largest = vec![0.0_f64; table.bounds().len()];
        for q in points(&table, 10_000) {
            let (tabulated, expected) = (of_table(&table, &exact, q), of_model(&exact, q));
            assert_eq!(tabulated.len(), table.bounds().len());
            for (k, bound) in table.bounds().iter().enumerate() {
                let (difference, bound_value) = (
                    (tabulated[k] - expected[k]).abs(),
                    bound.error * bound.scale,
                );
                assert!(
                    difference <= bound_value,
                    "{name}, {} at {q}: {difference:e} > {bound_value:e}",
                    bound.quantity
                );
                largest[k] = largest[k].max(expected[k].abs());
            }
        }
        // The scale is the largest value, but for a coefficient that nearly vanishes.
        for (bound, largest) in table.bounds().iter().zip(largest) {
            assert!(largest <= 1.05 * bound.scale, "{name}, {}", bound.quantity);
        }
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}

/// Gauss's rule of four points, exact for a piece of ½m′, gives the difference of m within half a cell, and
/// m has no steps where cells meet.
#[test]
fn half_the_slope_of_a_tables_m_is_its_other_column() {
    for (name, exact) in cases() {
        let table = table(&name, &exact);
        let at = |q: f64| table.inertia(q, &mut ()).expect("within").into();
        check_integral(&IntegratedFunction {
            name: &name,
            at: &at,
            extent: table.domain(),
            cells: table.cells()[0],
            scale: table.bounds()[0].scale,
            is_periodic: table.revolutions().is_some(),
        });
    }
}

/// A function of a table and half its slope.
pub(crate) struct IntegratedFunction<'a> {
    pub(crate) name: &'a str,
    pub(crate) at: &'a dyn Fn(f64) -> [f64; 2],
    pub(crate) extent: [f64; 2],
    pub(crate) cells: usize,
    /// Largest value.
    pub(crate) scale: f64,
    pub(crate) is_periodic: bool,
}

/// Holds a function against the sum of its slope, cell by cell.
pub(crate) fn check_integral(function: &IntegratedFunction<'_>) {
    let &IntegratedFunction {
        name,
        at,
        extent: [from, to],
        cells,
        scale,
        is_periodic: comes_back,
    } = function;
    let (inner, outer) = (0.339_981_043_584_856_26, 0.861_136_311_594_052_6);
    let (heavy, light) = (0.652_145_154_862_546_1, 0.347_854_845_137_453_9);
    let rule = [
        (-outer, light),
        (-inner, heavy),
        (inner, heavy),
        (outer, light),
    ];
    let half = 0.5 * (to - from) / cells as f64;
    let (mut whole, mut size) = (0.0, 0.0);
    for cell in 0..cells {
        let start = from + 2.0 * half * cell as f64;
        // Away from the ends, where a rounding of q may fall into the next cell.
        let (left, right) = (start + 0.01 * half, start + 1.99 * half);
        let (middle, half_width) = (0.5 * (left + right), 0.5 * (right - left));
        let sum = rule.map(|(x, weight)| weight * at(middle + half_width * x)[1]);
        let climb = 2.0 * half_width * sum.iter().sum::<f64>();
        let steep = 2.0 * half * sum.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
        // Some roundings of m, and of q where m is steep.
        let rounding = 4e-15 * scale + 1e-15 * steep * cells as f64;
        let difference = (at(right)[0] - at(left)[0] - climb).abs();
        assert!(
            difference <= rounding,
            "{name}, cell {cell}: {difference:e} > {rounding:e}"
        );
        if cell > 0 {
            let across = at(start + 1e-9 * half)[0] - at(start - 1e-9 * half)[0];
            let climb = 4e-9 * half * at(start)[1];
            let difference = (across - climb).abs();
            assert!(
                difference <= rounding,
                "{name}, at the start of {cell}: {difference:e}"
            );
        }
        let all = rule.map(|(x, weight)| weight * half * at(start + half + half * x)[1]);
        whole += 2.0 * all.iter().sum::<f64>();
        size += steep;
    }
    // A turn gains nothing: the rounding of a mean, and of each cell's part in it.
    if comes_back {
        assert!(
            whole.abs() <= 1e-15 * (scale + size),
            "{name}: a turn gains {whole:e}"
        );
    }
}

/// Of a free motion ½ m q̇² drifts on the table as it does on the exact model, by what the integrator does:
/// with equal steps over 1000 turns by the same to within roundings, however coarse the table.
#[test]
fn val_equal_steps_gain_the_same_energy_on_a_table() {
    for name in ["single-dwell", "crank-rocker"] {
        let exact = case(name);
        let start = ReducedState {
            t: 0.0,
            q: 0.0,
            q_dot: 1.0,
        };
        let period = Orbit::new(&exact, start).expect("a period").period;
        let expected = energies_per_revolution(&exact, period);
        assert!(
            expected[999].abs() > 1e-9,
            "{name}: nothing to compare: {:e}",
            expected[999]
        );
        for accuracy in [1e-4, 1e-12] {
            let table = TabulatedModel::new(&exact, accuracy, TableDomain::Full).expect("a table");
            let tabulated = energies_per_revolution(&table, period);
            for (revolution, (tabulated, expected)) in tabulated.iter().zip(&expected).enumerate() {
                // Truncation differs as higher derivatives do: 0.01 of the bound is met on the coarse table. The
                // places at which m is rounded are the same in every turn, so that some 1e-16 of it come back
                // each time. Interpolating m on its own gained 2 and 60 bounds, keeping what a turn gains 20
                // and 70.
                let max = 0.02 * table.max_bound() + 2e-15 * (revolution + 2) as f64;
                let difference = (tabulated - expected).abs();
                assert!(
                    difference < max,
                    "{name}, {accuracy:e}, turn {revolution}: {difference:e} apart"
                );
            }
        }
    }
}

/// What the energy has gained after each of 1000 turns, as a part of it, by Runge and Kutta's rule of 4 in
/// 400 steps a turn.
fn energies_per_revolution<R: ReducedModel>(model: &R, period: f64) -> Vec<f64> {
    let mut equation = ReducedOde::new(model);
    let first = equation.kinetic_energy(0.0, 1.0).expect("an energy");
    let (h, mut y) = (period / 400.0, [0.0, 1.0]);
    let mut gains = Vec::new();
    for _ in 0..1000 {
        for _ in 0..400 {
            let mut slope = [0.0; 2];
            let mut sum = [0.0; 2];
            for (ahead, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                let [q, q_dot] = [0, 1].map(|i: usize| y[i] + ahead * h * slope[i]);
                slope = [q_dot, equation.acceleration(q, q_dot).expect("within")];
                sum = [0, 1].map(|i: usize| sum[i] + weight * slope[i] / 6.0);
            }
            y = [0, 1].map(|i: usize| y[i] + h * sum[i]);
        }
        // With the turns it has made, q would be rounded to 1e-12: by 1000 turns 1e-10 of energy.
        y[0] -= TAU;
        gains.push(equation.kinetic_energy(y[0], y[1]).expect("within") / first - 1.0);
    }
    gains
}

/// An integrator that chooses its steps drifts alike on both. Its tolerance is a hundred times the table's
/// error: else that would have a say in the choice.
#[test]
fn val_energy_drifts_on_a_table_as_on_the_exact_model() {
    let start = ReducedState {
        t: 0.0,
        q: 0.0,
        q_dot: 1.0,
    };
    let options = Options::new(Method::Tsit45, 1e-10);
    for name in ["single-dwell", "crank-rocker"] {
        let exact = case(name);
        let table = table(name, &exact);
        let [tabulated, expected] = [
            drift(&table, start, &options),
            drift(&exact, start, &options),
        ];
        let differences: Vec<f64> = tabulated
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b).abs())
            .collect();
        // The steps are not the same: the errors they are chosen by are of the size of the table's.
        assert!(
            differences[999] < 0.1 * expected[999].abs(),
            "{name}: {:e} apart",
            differences[999]
        );
        let orbits = [Orbit::new(&table, start), Orbit::new(&exact, start)];
        let [tabulated, expected] = orbits.map(|orbits| orbits.expect("a period").period);
        assert!(
            (tabulated - expected).abs() < 1e-12 * expected,
            "{name}: {tabulated} {expected}"
        );
    }
}

/// By revolution of 1000, the gain of energy since the first, as a part of it.
fn drift<R: ReducedModel>(model: &R, start: ReducedState, options: &Options) -> Vec<f64> {
    let thousand = Event {
        kind: EventKind::Revolution(ReducedCoordinate),
        terminal: NonZeroUsize::new(1000),
    };
    let run = solve_reduced(model, start, None, options, &[thousand]).expect("a run");
    let revolutions = run.event_occurrences;
    let mut equation = ReducedOde::new(model);
    let mut energy = |o: &EventOccurrence| {
        let y = &o.state.y;
        equation.kinetic_energy(y[0], y[1]).expect("an energy")
    };
    let first = energy(&revolutions[0]);
    revolutions
        .iter()
        .map(|s| energy(s) / first - 1.0)
        .collect()
}

fn labels(exact: &ExactModel, scene: &PlaneScene) -> Labels {
    let reactions = exact.model().reactions().iter();
    Labels {
        scene: scene.hash(),
        coordinate: scene.mechanism.actuators[0].name.clone(),
        reactions: reactions
            .map(|&r| scene.mechanism.reaction_name(r))
            .collect(),
        loads: scene.loads.iter().map(|l| l.name.clone()).collect(),
    }
}

/// A table that is read again is the same to the last bit, and so is what it gives.
#[test]
fn a_table_is_read_as_it_was_written() {
    for (name, exact) in cases() {
        let table = table(&name, &exact);
        let labels = labels(&exact, &scene(&name));
        let text = table.to_text(&labels).expect("a text");
        let (read, known) = TabulatedModel::from_text(&text).expect("a table");
        assert_eq!((&read, &known), (&table, &labels), "{name}");
        for q in points(&table, 50) {
            let [written, read_back] = [&table, &read].map(|t| of_table(t, &exact, q));
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&written), bits(&read_back), "{name} at {q}");
        }
        assert_eq!(read.to_text(&known).expect("a text"), text, "{name}");
    }
}

/// Every byte that is altered and every end that is missing is noticed, and nothing panics.
#[test]
fn a_damaged_table_is_refused() {
    let exact = case("slider-crank");
    let table = TabulatedModel::new(&exact, 1e-3, TableDomain::Full).expect("a table");
    let labels = labels(&exact, &scene("slider-crank"));
    let text = table.to_text(&labels).expect("a text");
    let refused = |text: &str| TabulatedModel::from_text(text).expect_err("a damaged table");
    for end in 0..text.len() {
        assert!(text.is_ascii());
        refused(&text[..end]);
        let mut altered = text.clone().into_bytes();
        altered[end] ^= 1;
        refused(std::str::from_utf8(&altered).expect("ascii"));
    }
    assert_eq!(refused(""), FileError::NotATable);
    assert_eq!(refused("table = 1\n"), FileError::NotATable);
    let later = text.replacen("dwell-table 1", "dwell-table 2", 1);
    assert_eq!(
        refused(&later),
        FileError::Version {
            found: "2".to_owned()
        }
    );
    let cut = &text[..text.len() / 2];
    assert_eq!(refused(cut), FileError::Truncated);
    assert_eq!(
        refused(&text.replacen("rad", "raD", 1)),
        FileError::ChecksumMismatch
    );
    let mut odd = labels;
    odd.reactions[0] = "two\nlines".to_owned();
    assert!(matches!(table.to_text(&odd), Err(FileError::Labels { .. })));
    odd.reactions.clear();
    assert!(matches!(table.to_text(&odd), Err(FileError::Labels { .. })));
}

/// Outside there is an error and no value; whole turns are taken off to the last digits of q.
#[test]
fn a_table_reaches_as_far_as_it_says() {
    let exact = case("class-three-six-bar");
    let table = table("class-three-six-bar", &exact);
    let [from, to] = table.domain();
    let (lowest, highest) = exact.range().limits().expect("limits");
    assert!(lowest < from && to < highest && to - from > 0.9 * (highest - lowest));
    assert_eq!(table.range(), Range::Unresolved(from, to));
    for q in [from, to, 0.5 * (from + to)] {
        assert!(table.inertia(q, &mut ()).is_ok(), "{q}");
    }
    for q in [from - 1e-6, to + 1e-6, 100.0, -1e300, f64::INFINITY] {
        let found = table.inertia(q, &mut ());
        assert!(
            matches!(
                found,
                Err(PositionError::OutOfRange { .. } | PositionError::NotFinite)
            ),
            "{q}"
        );
    }
    let inner = TabulatedModel::new(&exact, 1e-9, TableDomain::Between(0.0, 1.0)).expect("a table");
    assert_eq!(inner.domain(), [0.0, 1.0]);
    assert!(inner.cells()[0] < table.cells()[0] / 4);

    let exact = case("crank-rocker");
    let table = self::table("crank-rocker", &exact);
    assert_eq!((table.range(), table.revolutions()), (Range::Full, Some(1)));
    let mut workspace = exact.workspace();
    for q in [-1e-300, -0.1, 6.283_185_307_179_587, -7.0, 1e3, -1e5, 6.5e6] {
        let tabulated = table.inertia(q, &mut ()).expect("a turn");
        let expected = exact.inertia(q, &mut workspace).expect("a pose");
        // The exact model takes sines of q: its turns are exact. Three roundings of the table's part.
        let scale = table.bounds()[1].scale;
        assert!(
            (tabulated.1 - expected.1).abs() < 2e-12 * scale,
            "{q}: {tabulated:?} {expected:?}"
        );
    }
    for q in [f64::NAN, f64::INFINITY, 1e8] {
        assert!(table.inertia(q, &mut ()).is_err(), "{q}");
    }
}

#[test]
fn what_cannot_be_tabulated_says_why() {
    let exact = case("crank-rocker");
    for accuracy in [0.0, -1e-9, f64::NAN, 1e-15, 1.0] {
        let found = TabulatedModel::new(&exact, accuracy, TableDomain::Full);
        assert!(
            matches!(found, Err(TableError::Accuracy { .. })),
            "{accuracy}"
        );
    }
    for (from, to) in [
        (1.0, 1.0),
        (2.0, 1.0),
        (f64::NAN, 1.0),
        (0.0, f64::INFINITY),
    ] {
        let found = TabulatedModel::new(&exact, 1e-6, TableDomain::Between(from, to));
        assert!(
            matches!(found, Err(TableError::Domain { .. })),
            "{from} {to}"
        );
    }
    let exact = case("class-three-six-bar");
    let found = TabulatedModel::new(&exact, 1e-6, TableDomain::Between(0.0, 4.0));
    assert!(matches!(found, Err(TableError::Domain { .. })));
    let found = TabulatedModel::new(&case("planetary"), 1e-6, TableDomain::Full);
    assert_eq!(found, Err(TableError::Unbounded));
    // Next to its change points the exact ½m′ has nine digits.
    let found = TabulatedModel::new(
        &case("parallelogram-three-cranks"),
        1e-10,
        TableDomain::Full,
    );
    assert!(
        matches!(
            found,
            Err(TableError::NotReached {
                what: TableQuantity::HalfDm,
                ..
            })
        ),
        "{found:?}"
    );
}
