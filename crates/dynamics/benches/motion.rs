//! Time of a motion whose coordinate has a given error at its end: by method, on the exact model and on a table
//! (including its construction), and by quadrature.
//!
//! Two free motions of ten periods, whose end is known: the crank has turned ten times. One machine under loads with a
//! motor, whose end is that of the finest run. For each way, the loosest tolerance is chosen for which it and all finer
//! ones reach the error, so that none succeeds by chance. As in `reduced`, the subjects take turns within one process;
//! times are the least, as ratios to one exact evaluation and to DOP853 on the exact model.

#[path = "../../kinetostatics/benches/bench/mod.rs"]
mod bench;

use bench::{Case, FULL_REVOLUTION, Subject, stop};
use dwell_dynamics::{
    CoordinateMode, DenseOutput, Machine, MachineOde, Method, OdeState, OdeSystem, Options, Orbit,
    ReducedOde, ReducedState, Statistics, StepControl, TabulatedMachine, integrate,
};
use dwell_kinetostatics::{ExactModel, Model, TableDomain, TabulatedModel};
use dwell_scene::MotionDuration;
use std::f64::consts::TAU;
use std::fmt::Display;
use std::hint::black_box;
use std::time::Instant;

/// Required errors of the coordinate, rad.
const REQUIRED_ERRORS: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Tolerances that are tried, the finest first: tenfold looser each.
const MIN_TOLERANCE: f64 = 1e-13;
const TOLERANCE_COUNT: i32 = 12;
const METHODS: [Method; 3] = [Method::Bdf, Method::Tsit45, Method::Dop853];
/// Times each motion is run.
const REPETITIONS: usize = 60;
/// Periods of a free motion.
const PERIODS: f64 = 10.0;
/// A table is built to this part of the tolerance, but to no better than rounding lets it be.
const TABLE_TOLERANCE_FACTOR: f64 = 0.1;
/// Number of times at which a quadrature is compared with the converged one, because its error is smallest at whole
/// periods.
const COMPARED_TIMES: u32 = 23;
/// Allowed difference of two methods if the finest run is the reference, rad: a tenth of the least error.
const AGREEMENT: f64 = 1e-10;

/// The moving system.
#[allow(clippy::large_enum_variant, reason = "there are three")]
enum Plant {
    Free(ExactModel),
    Loaded(Machine),
}

/// A motion, and where its coordinate is at the end.
struct MotionCase {
    case: &'static str,
    plant: Plant,
    initial_state: OdeState,
    end: f64,
    reference: f64,
}

/// How it is computed.
#[derive(Debug, Clone, Copy)]
enum Computation {
    Exact(Method),
    Tabulated(Method),
    Quadrature,
}

/// The end of a computation, and its work.
struct RunResult {
    q: f64,
    statistics: Statistics,
}

impl MotionCase {
    fn free(case: &'static str) -> Self {
        let read = Case::read(case);
        let exact = read.model(&[]);
        let Some(motion) = &read.scene.motion else {
            stop(case, "no motion")
        };
        let (q, q_dot) = (motion.initial_coordinates[0], motion.initial_velocities[0]);
        let orbit = Orbit::new(&exact, ReducedState { t: 0.0, q, q_dot })
            .unwrap_or_else(|e| stop(case, &e.to_string()));
        Self {
            case,
            plant: Plant::Free(exact),
            initial_state: OdeState {
                t: 0.0,
                y: vec![q, q_dot],
            },
            end: PERIODS * orbit.period,
            reference: q + PERIODS * TAU,
        }
    }

    fn loaded(case: &'static str) -> Self {
        let scene = Case::read(case).scene;
        let shape = &scene.mechanism;
        let start = scene.assembly.to_configuration();
        let model = or_stop(case, Model::new(shape, &scene.masses, &start, &[]));
        let free = vec![CoordinateMode::Free];
        let machine = Machine::new(model, &scene.loads, free, &scene.drives);
        let machine = or_stop(case, machine);
        let Some(motion) = &scene.motion else {
            stop(case, "no motion")
        };
        let MotionDuration::Seconds(end) = motion.duration else {
            stop(case, "its motion has no duration")
        };
        let y = machine.initial_state(&motion.initial_coordinates, &motion.initial_velocities);
        let mut loaded = Self {
            case,
            plant: Plant::Loaded(machine),
            initial_state: OdeState { t: 0.0, y },
            end,
            reference: f64::NAN,
        };
        let [reference, check] =
            [(Method::Dop853, 0.1), (Method::Tsit45, 1.0)].map(|(by, finer)| {
                let done = or_stop(
                    case,
                    loaded.run(Computation::Exact(by), finer * MIN_TOLERANCE),
                );
                done.q
            });
        assert!((reference - check).abs() < AGREEMENT, "{reference} {check}");
        loaded.reference = reference;
        loaded
    }

    fn state(&self) -> ReducedState {
        ReducedState {
            t: self.initial_state.t,
            q: self.initial_state.y[0],
            q_dot: self.initial_state.y[1],
        }
    }

    fn computations(&self) -> Vec<Computation> {
        let mut computations: Vec<Computation> = METHODS
            .iter()
            .flat_map(|&method| [Computation::Exact(method), Computation::Tabulated(method)])
            .collect();
        if matches!(self.plant, Plant::Free(_)) {
            computations.push(Computation::Quadrature);
        }
        computations
    }

    /// The whole computation, the making of a table or rule included.
    fn run(&self, computation: Computation, tolerance: f64) -> Result<RunResult, String> {
        let message = |e: &dyn Display| e.to_string();
        let (t, y, speed) = (
            self.initial_state.t,
            &self.initial_state.y,
            self.initial_state.y[1],
        );
        let table = (TABLE_TOLERANCE_FACTOR * tolerance).max(MIN_TOLERANCE);
        match (computation, &self.plant) {
            (Computation::Exact(by), Plant::Free(exact)) => {
                let mut equation = ReducedOde::new(exact).with_speed_scale(speed);
                self.integrate(&mut equation, by, tolerance)
            }
            (Computation::Tabulated(by), Plant::Free(exact)) => {
                let table = TabulatedModel::new(exact, table, TableDomain::Full)
                    .map_err(|e| message(&e))?;
                let mut equation = ReducedOde::new(&table).with_speed_scale(speed);
                self.integrate(&mut equation, by, tolerance)
            }
            (Computation::Exact(by), Plant::Loaded(machine)) => {
                let mut ode = MachineOde::new(machine, t, y).map_err(|e| message(&e))?;
                self.integrate(&mut ode, by, tolerance)
            }
            (Computation::Tabulated(by), Plant::Loaded(machine)) => {
                let table = TabulatedMachine::new(machine, table, TableDomain::Full)
                    .map_err(|e| message(&e))?;
                let mut ode = table.ode(t, y, 0.0).map_err(|e| message(&e))?;
                self.integrate(&mut ode, by, tolerance)
            }
            (Computation::Quadrature, Plant::Free(exact)) => {
                let orbit =
                    Orbit::to_accuracy(exact, self.state(), tolerance).map_err(|e| message(&e))?;
                let statistics = Statistics {
                    evaluations: orbit.points,
                    ..Statistics::default()
                };
                let q = orbit.state_at(self.end).q;
                Ok(RunResult { q, statistics })
            }
            (Computation::Quadrature, Plant::Loaded(_)) => Err("it does not come back".to_owned()),
        }
    }

    fn integrate(
        &self,
        system: &mut dyn OdeSystem,
        method: Method,
        tolerance: f64,
    ) -> Result<RunResult, String> {
        let options = Options::new(method, tolerance);
        let mut observer =
            |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
        let termination = integrate(
            system,
            &self.initial_state,
            Some(self.end),
            &options,
            &mut observer,
        )
        .map_err(|e| e.to_string())?;
        match termination.error {
            Some(error) => Err(error.to_string()),
            None => Ok(RunResult {
                q: termination.state.y[0],
                statistics: termination.statistics,
            }),
        }
    }

    /// The error of a computation at the end; for a quadrature, also at some times before it.
    fn tolerance_run(&self, computation: Computation, tolerance: f64) -> ToleranceRun {
        let RunResult { q, statistics } = or_stop(self.case, self.run(computation, tolerance));
        let mut error = (q - self.reference).abs();
        if let (Computation::Quadrature, Plant::Free(exact)) = (computation, &self.plant) {
            let [rule, all] = [tolerance, 0.0].map(|accuracy| {
                or_stop(self.case, Orbit::to_accuracy(exact, self.state(), accuracy))
            });
            for k in 0..COMPARED_TIMES {
                let t = self.end * (f64::from(k) + 0.37) / f64::from(COMPARED_TIMES);
                error = error.max((rule.state_at(t).q - all.state_at(t).q).abs());
            }
        }
        ToleranceRun {
            tolerance,
            error,
            statistics,
        }
    }

    /// One exact evaluation of the equation of motion.
    fn evaluation(&self) -> Subject<'_> {
        let mut system: Box<dyn OdeSystem + '_> = match &self.plant {
            Plant::Free(exact) => Box::new(ReducedOde::new(exact)),
            Plant::Loaded(machine) => {
                let ode = MachineOde::new(machine, self.initial_state.t, &self.initial_state.y);
                Box::new(or_stop(self.case, ode))
            }
        };
        let (case, mut y) = (self.case, self.initial_state.y.clone());
        let mut out = vec![0.0; y.len()];
        Subject::new("one exact evaluation", FULL_REVOLUTION, move |q| {
            y[0] = q;
            or_stop(case, system.rhs(0.0, &y, &mut out));
            black_box(&out);
        })
    }
}

/// A tolerance that was tried.
#[derive(Debug, Clone, Copy)]
struct ToleranceRun {
    tolerance: f64,
    error: f64,
    statistics: Statistics,
}

/// One line of a table.
struct Row {
    required_error: f64,
    computation: Computation,
    run: ToleranceRun,
    /// Least time of all turns, s.
    min_time: f64,
}

impl Row {
    fn run_once(&mut self, motion: &MotionCase) {
        let start = Instant::now();
        let result = black_box(motion.run(self.computation, black_box(self.run.tolerance)));
        self.min_time = self.min_time.min(start.elapsed().as_secs_f64());
        let error = (or_stop(motion.case, result).q - motion.reference).abs();
        assert!(error <= self.run.error, "{:?}: {error:e}", self.computation);
    }

    fn name(&self) -> String {
        match self.computation {
            Computation::Exact(method) => format!("{}, exact", method.name()),
            Computation::Tabulated(method) => format!("{}, its table", method.name()),
            Computation::Quadrature => "quadrature".to_owned(),
        }
    }
}

fn main() {
    measure(&MotionCase::free("crank-rocker"));
    measure(&MotionCase::free("single-dwell"));
    measure(&MotionCase::loaded("four-bar"));
}

/// The rows of a motion by wanted error, each with its tolerance.
fn rows(motion: &MotionCase) -> Vec<Row> {
    let mut rows = Vec::new();
    for computation in motion.computations() {
        let series: Vec<ToleranceRun> = (0..TOLERANCE_COUNT)
            .map(|run| motion.tolerance_run(computation, MIN_TOLERANCE * 10_f64.powi(run)))
            .collect();
        for required_error in REQUIRED_ERRORS {
            let reached = series.iter().take_while(|run| run.error <= required_error);
            // BDF may end above the least error in ten free periods; its finest is then shown.
            let run = match (computation, reached.last()) {
                (_, Some(run)) => *run,
                (Computation::Exact(Method::Bdf) | Computation::Tabulated(Method::Bdf), None) => {
                    series[0]
                }
                _ => stop(
                    motion.case,
                    &format!("{computation:?}: not within {required_error:e}"),
                ),
            };
            rows.push(Row {
                required_error,
                computation,
                run,
                min_time: f64::INFINITY,
            });
        }
    }
    // Stable: by error, and within it as the ways come.
    rows.sort_by(|a, b| b.required_error.total_cmp(&a.required_error));
    rows
}

fn measure(motion: &MotionCase) {
    let mut rows = rows(motion);
    let mut one = motion.evaluation();
    for _ in 0..REPETITIONS {
        one.run_round();
        for row in &mut rows {
            row.run_once(motion);
        }
    }
    let evaluation = one.times.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    println!("\n{}: {} {evaluation:.0} ns", motion.case, one.name);
    println!(
        "error  way                tolerance  reached  evaluations  Jacobians      us  / evaluation  / DOP853"
    );
    for row in &rows {
        let is_baseline = |other: &&Row| {
            other.required_error == row.required_error
                && matches!(other.computation, Computation::Exact(Method::Dop853))
        };
        let dop853_time = rows
            .iter()
            .find(is_baseline)
            .map_or(f64::NAN, |row| row.min_time);
        let ToleranceRun {
            tolerance,
            error,
            statistics,
        } = row.run;
        println!(
            "{:5.0e}  {:18} {tolerance:9.0e}  {error:7.1e}  {:11}  {:9}  {:6.0}  {:12.0}  {:8.2}",
            row.required_error,
            row.name(),
            statistics.evaluations,
            statistics.jacobians,
            row.min_time * 1e6,
            row.min_time * 1e9 / evaluation,
            row.min_time / dop853_time
        );
    }
}

fn or_stop<T, E: Display>(case: &str, result: Result<T, E>) -> T {
    result.unwrap_or_else(|e| stop(case, &e.to_string()))
}
