//! The two kinetostatic runs by which Jordi, Zayas and Cardona (2008) find the reduced parameters with a program that
//! analyses prescribed motions only, and their combination:
//!
//! ```text
//! run i    q̇ = 1, q̈ = 0                       ½∂m₁/∂q₁ = T / q̇²            m_e2 = F / q̇²
//! run ii   q̈ = 1 from rest, so that q̇² = 2 q    m₁ = (T − ½∂m₁/∂q₁ q̇²) / q̈   m_e1 = (F − m_e2 q̇²) / q̈
//! ```
//!
//! T is the actuator's moment, F a reaction, q the coordinate from the beginning of the range. Both runs pass the same
//! positions, run ii at unequal times. `dwell reduce` finds the same numbers with one evaluation for each position.

use crate::estimate::relative;
use crate::explain::StudyError;
use crate::models::PreparedScene;
use crate::progress::Progress;
use crate::reduce::compute::{
    ReducedCurves, ReducedScene, RoundingErrors, TabulatedScene, coefficient_units, flat,
    inertia_units,
};
use crate::trajectory::compute::{Analysis, RowScene, RowSource, Spacing, Trajectory};
use dwell_findings::{Column, Table};
use dwell_kinetostatics::{Coefficients, ReducibleModel as _};
use dwell_laws::{Law, Polynomial};
use dwell_scene::{PlaneScene, PrescribedMotion, Requests};

/// Positions of each run if their number is not given: a degree apart over a revolution.
const DEFAULT_POINTS: usize = 361;
/// Largest admissible difference from the reduced model, relative to the subtracted force: 1.3e-14 or less is measured on
/// 19 cases without a dead point near, 8e-14 on the slotted rocker.
const TOLERANCE: f64 = 1e-12;
/// Next to a dead point the difference is up to this number of rounding errors of the reduced model: the positions of both
/// runs differ in the last digit.
const ROUNDINGS: f64 = 100.0;

/// The runs, the parameters from them, and the reduced model at the same positions.
pub struct UnitRuns<P> {
    /// The scene and its model without loads.
    pub prepared: P,
    /// All columns of run i (unit speed) and of run ii (unit acceleration).
    pub runs: [Table; 2],
    /// The parameters from the runs: half_dm and b are ½∂m₁/∂q₁ and m_e2, m and a are m₁ and m_e1.
    pub combined: ReducedCurves,
    /// The exact reduced model at the same positions.
    pub reduced: ReducedCurves,
    /// Estimated rounding errors of the reduced model.
    pub rounding: RoundingErrors,
}

/// Computes both runs over the range of the only actuator, at `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, has several actuators, or a position cannot be reached.
pub fn compute_unit_runs<'a, S: UnitRunScene>(
    scene: &'a S,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<UnitRuns<S::Prepared<'a>>, StudyError> {
    scene.reject_unknown_columns()?;
    let prepared = scene.prepared_without_loads()?;
    let points = points.unwrap_or(DEFAULT_POINTS).max(2);
    let runs = [UnitRun::Speed, UnitRun::Acceleration];
    let alone = scene.with_masses_alone();
    let [one, two] = runs.map(|run| run.table(&alone, points, progress));
    let runs = [one?, two?];
    let combined = combine(&prepared, &runs);
    let reduced = ReducedCurves::at(&prepared, combined.q.clone())?;
    let rounding = RoundingErrors::new(&prepared, &reduced)?;
    Ok(UnitRuns {
        rounding,
        prepared,
        runs,
        combined,
        reduced,
    })
}

/// One of the two runs.
#[derive(Debug, Clone, Copy)]
pub enum UnitRun {
    /// Run i, with unit speed.
    Speed,
    /// Run ii, with unit acceleration from rest.
    Acceleration,
}

impl UnitRun {
    /// The table of a scene along the motion from the lower to the upper end of the range of its coordinate.
    ///
    /// # Errors
    /// [`StudyError`] where a position cannot be reached.
    fn table<S: RowScene>(
        self,
        scene: &S,
        points: usize,
        progress: Progress<'_>,
    ) -> Result<Table, StudyError> {
        let rows = scene.rows()?;
        let model = S::model_of(&rows);
        let ([from, to], ..) = scene.default_limits(model);
        let (law, duration, spacing) = match self {
            Self::Speed => (
                Polynomial::motion(from, 1.0, 0.0),
                to - from,
                Spacing::EqualTimes,
            ),
            Self::Acceleration => (
                Polynomial::motion(from, 0.0, 1.0),
                (2.0 * (to - from)).sqrt(),
                Spacing::FromRest,
            ),
        };
        let motion = PrescribedMotion {
            duration,
            points,
            laws: vec![Law::Polynomial(law)],
        };
        let (period, analysis) = (model.range().period(), Analysis::Kinetostatics);
        let along = Trajectory::prescribed(&motion, spacing, period, analysis, points);
        let computed = RowSource::new(scene, &rows).along(along, None, progress)?;
        match computed.early_stop {
            Some(error) => Err(error),
            None => Ok(computed.table),
        }
    }
}

/// A scene whose unit runs can be computed.
pub trait UnitRunScene: RowScene {
    /// The scene with its model.
    type Prepared<'a>: TabulatedScene
    where
        Self: 'a;

    /// The scene with its model without loads.
    ///
    /// # Errors
    /// [`StudyError`] when the mechanism cannot be assembled or has several actuators.
    fn prepared_without_loads(&self) -> Result<Self::Prepared<'_>, StudyError>;

    /// The mechanism with its masses alone, because loads are not part of the coefficients.
    fn with_masses_alone(&self) -> Self;
}

impl UnitRunScene for PlaneScene {
    type Prepared<'a> = PreparedScene<'a>;

    fn prepared_without_loads(&self) -> Result<PreparedScene<'_>, StudyError> {
        PreparedScene::without_loads(self)
    }

    fn with_masses_alone(&self) -> Self {
        let mut scene = self.clone();
        scene.loads.clear();
        scene.drives.clear();
        scene.stops.clear();
        scene.motion = None;
        scene.sweep = None;
        scene.requests = Requests {
            reactions: scene.requests.reactions.clone(),
            ..Requests::default()
        };
        scene
    }
}

/// The values of a column, by its name.
pub(crate) fn values(table: &Table, name: &str) -> Vec<f64> {
    let index = table.columns.iter().position(|column| column.name == name);
    // A column that a run does not have, such as the force of a joint without mass behind it, is zero.
    let value = |row: &Vec<f64>| index.map_or(0.0, |k| row[k]);
    table.rows.iter().map(value).collect()
}

/// The coefficients from the exported columns of both runs alone.
fn combine(prepared: &impl ReducedScene, runs: &[Table; 2]) -> ReducedCurves {
    let coordinate = prepared.coordinate_name();
    let [q, speed, acceleration] =
        ["", ".velocity", ".acceleration"].map(|rest| format!("{coordinate}{rest}"));
    let [speed_i, speed_ii] = [0, 1].map(|run| values(&runs[run], &speed));
    let acceleration = values(&runs[1], &acceleration);
    // The coefficients of q̈ and of q̇² of a force, by position.
    let of_force = |name: &str| -> Vec<[f64; 2]> {
        let [one, two] = [0, 1].map(|run| values(&runs[run], name));
        let at = |k: usize| {
            let of_square = one[k] / (speed_i[k] * speed_i[k]);
            let of_acceleration =
                (two[k] - of_square * speed_ii[k] * speed_ii[k]) / acceleration[k];
            [of_acceleration, of_square]
        };
        (0..one.len()).map(at).collect()
    };
    let inertia = of_force(&format!("{coordinate}.actuator_force"));
    let names = prepared.reaction_units();
    let reactions: Vec<_> = names.iter().map(|(name, _)| of_force(name)).collect();
    let part = |k: usize, part: usize| reactions.iter().map(|of| of[k][part]).collect();
    let inertia = inertia.into_iter().enumerate();
    let coefficients = inertia.map(|(k, [m, half_dm])| Coefficients {
        m,
        half_dm,
        a: part(k, 0),
        b: part(k, 1),
    });
    ReducedCurves {
        q: values(&runs[0], &q),
        coefficients: coefficients.collect(),
    }
}

/// A coefficient of the combined runs, compared with the reduced model.
pub struct ComparedCoefficient {
    /// The paper's symbol.
    pub symbol: String,
    /// Its unit.
    pub unit: &'static str,
    /// The largest absolute value over the range, of the reduced model.
    pub largest: f64,
    /// The largest difference over the range, relative to the largest value; or, if the coefficient is zero within
    /// rounding, relative to the size expected from m and the other reactions.
    pub relative_difference: f64,
    /// The largest admissible difference.
    pub tolerance: f64,
}

impl<P: ReducedScene> UnitRuns<P> {
    /// Each coefficient, compared over the range.
    pub fn comparison(&self) -> Vec<ComparedCoefficient> {
        let rounding = self.rounding.max_errors.iter().copied().fold(0.0, f64::max);
        let lost = self.lost_digits();
        let [sizes, references] = self.reduced.scales(&self.prepared);
        let is_rounding = self.reduced.rounding(&self.prepared);
        let mut differences = vec![0.0_f64; sizes.len()];
        let both = self.combined.coefficients.iter();
        for (one, other) in both.zip(&self.reduced.coefficients) {
            let pairs = flat(one).into_iter().zip(flat(other));
            for (largest, (a, b)) in differences.iter_mut().zip(pairs) {
                let difference = (a - b).abs();
                // A NaN is no agreement.
                if difference.is_nan() || difference > *largest {
                    *largest = difference;
                }
            }
        }
        let symbols = self.symbols().into_iter().enumerate();
        let compared = symbols.map(|(k, (symbol, unit))| {
            let scales = if is_rounding[k] { &references } else { &sizes };
            ComparedCoefficient {
                symbol,
                unit,
                largest: sizes[k],
                relative_difference: relative(differences[k], scales[k]),
                tolerance: (TOLERANCE + ROUNDINGS * rounding) * (lost[k] / scales[k]).max(1.0),
            }
        });
        compared.collect()
    }

    /// By coefficient: the largest force of run ii, from which the part of q̇² is subtracted; zero if nothing is
    /// subtracted.
    fn lost_digits(&self) -> Vec<f64> {
        let largest = |name: &str| {
            let values = values(&self.runs[1], name);
            values.iter().fold(0.0_f64, |max, v| max.max(v.abs()))
        };
        let coordinate = self.prepared.coordinate_name();
        let moment = largest(&format!("{coordinate}.actuator_force"));
        let reactions = self.prepared.reaction_units();
        let forces = reactions.iter().map(|(name, _)| largest(name));
        let of_squares = reactions.iter().map(|_| 0.0);
        let of_inertia = [moment, 0.0].into_iter();
        of_inertia.chain(forces).chain(of_squares).collect()
    }

    /// The paper's symbols and the units of m₁, ½∂m₁/∂q₁, every m_e1, every m_e2.
    fn symbols(&self) -> Vec<(String, &'static str)> {
        let is_angle = self.prepared.is_angle();
        let reactions = self.prepared.reaction_units();
        let [m, half_dm] = inertia_units(is_angle);
        let mut symbols = vec![("m₁".to_owned(), m), ("½∂m₁/∂q₁".to_owned(), half_dm)];
        for (part, symbol) in ["m_e1", "m_e2"].into_iter().enumerate() {
            symbols.extend(reactions.iter().map(|(name, unit)| {
                let unit = coefficient_units(unit, is_angle)[part];
                (format!("{symbol} of {name}"), unit)
            }));
        }
        symbols
    }

    /// The table: coordinate, combined coefficients by the paper's symbols, and the columns of `dwell reduce`.
    pub fn table(&self) -> Table {
        let mut table = self.combined.table(&self.prepared);
        for column in table.columns.iter_mut().skip(1) {
            column.name = paper_name(&column.name);
        }
        let reduced = self.reduced.table(&self.prepared);
        let added: Vec<Column> = reduced.columns.into_iter().skip(1).collect();
        table.columns.extend(added);
        for (row, reduced) in table.rows.iter_mut().zip(reduced.rows) {
            row.extend(&reduced[1..]);
        }
        table
    }
}

/// The name of a coefficient's column in the paper's symbols.
fn paper_name(name: &str) -> String {
    match name {
        "m" => "m_1".to_owned(),
        "half_dm" => "half_m_1q1".to_owned(),
        _ => match (name.strip_suffix(".a"), name.strip_suffix(".b")) {
            (Some(reaction), _) => format!("{reaction}.m_e1"),
            (_, Some(reaction)) => format!("{reaction}.m_e2"),
            _ => name.to_owned(),
        },
    }
}
