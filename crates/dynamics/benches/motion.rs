//! What a motion costs whose coordinate is within a given error at its end: by method, on the exact model
//! and on a table that is built in the same time, and by quadrature.
//!
//! Two free motions of ten periods, whose end is known: the crank has turned ten times. One machine under loads
//! with a motor, whose end is that of the finest run. Of each way the loosest tolerance of a ladder is taken from
//! which on all finer ones reach the error, so that none is met by luck. As in `reduced`, the subjects take turns
//! within one process; times are the least, as ratios to one exact evaluation and to DOP853 on the exact model.

#[path = "../../kinetostatics/benches/bench/mod.rs"]
mod bench;

use bench::{Case, Subject, TURN, stop};
use dwell_dynamics::{
    Dense, Equation, Guidance, Machine, Method, Moving, Next, Options, Orbit, Point, State,
    Statistics, System, Tabled, integrate,
};
use dwell_kinetostatics::{Exact, Extent, Model, Table};
use dwell_scene::Length;
use std::f64::consts::TAU;
use std::fmt::Display;
use std::hint::black_box;
use std::time::Instant;

/// Errors of the coordinate that are asked for, rad.
const WANTED: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Tolerances that are tried, the finest first: tenfold looser each.
const FINEST: f64 = 1e-13;
const RUNGS: i32 = 12;
const METHODS: [Method; 3] = [Method::Bdf, Method::Tsit45, Method::Dop853];
/// Times each motion is run.
const TURNS: usize = 60;
/// Periods of a free motion.
const PERIODS: f64 = 10.0;
/// A table is built to this part of the tolerance, but to no better than rounding lets it be.
const PART: f64 = 0.1;
/// Times at which a rule of quadrature is compared with that of all digits: at whole periods it is at its best.
const COMPARED: u32 = 23;
/// What two methods may differ by where the finest run is the truth, rad: a tenth of the least error.
const AGREED: f64 = 1e-10;

/// What moves.
#[allow(clippy::large_enum_variant, reason = "there are three")]
enum Plant {
    Free(Exact),
    Loaded(Machine),
}

/// A motion, and where its coordinate is at the end.
struct Motion {
    case: &'static str,
    plant: Plant,
    start: Point,
    end: f64,
    truth: f64,
}

/// How it is computed.
#[derive(Debug, Clone, Copy)]
enum Way {
    Exact(Method),
    Tabled(Method),
    Quadrature,
}

/// Where a computation came to, and by what work.
struct Done {
    q: f64,
    work: Statistics,
}

impl Motion {
    fn free(case: &'static str) -> Self {
        let read = Case::read(case);
        let exact = read.model(&[]);
        let Some(motion) = &read.scene.motion else {
            stop(case, "no motion")
        };
        let (q, q_dot) = (motion.start[0], motion.speed[0]);
        let orbit = Orbit::new(&exact, State { t: 0.0, q, q_dot });
        let orbit = orbit.unwrap_or_else(|e| stop(case, &e.to_string()));
        Self {
            case,
            plant: Plant::Free(exact),
            start: Point {
                t: 0.0,
                y: vec![q, q_dot],
            },
            end: PERIODS * orbit.period,
            truth: q + PERIODS * TAU,
        }
    }

    fn loaded(case: &'static str) -> Self {
        let scene = Case::read(case).scene;
        let shape = &scene.mechanism;
        let start = scene.assembly.to_start();
        let model = or_stop(case, Model::new(shape, &scene.masses, &start, &[]));
        let free = vec![Guidance::Free];
        let machine = Machine::new(shape, model, &scene.loads, free, &scene.drives);
        let machine = or_stop(case, machine);
        let Some(motion) = &scene.motion else {
            stop(case, "no motion")
        };
        let Length::Duration(end) = motion.length else {
            stop(case, "its motion has no duration")
        };
        let y = machine.start(&motion.start, &motion.speed);
        let mut loaded = Self {
            case,
            plant: Plant::Loaded(machine),
            start: Point { t: 0.0, y },
            end,
            truth: f64::NAN,
        };
        let [truth, beside] = [(Method::Dop853, 0.1), (Method::Tsit45, 1.0)].map(|(by, finer)| {
            let done = or_stop(case, loaded.run(Way::Exact(by), finer * FINEST));
            done.q
        });
        assert!((truth - beside).abs() < AGREED, "{truth} {beside}");
        loaded.truth = truth;
        loaded
    }

    fn state(&self) -> State {
        State {
            t: self.start.t,
            q: self.start.y[0],
            q_dot: self.start.y[1],
        }
    }

    fn ways(&self) -> Vec<Way> {
        let mut ways: Vec<Way> = METHODS
            .iter()
            .flat_map(|&method| [Way::Exact(method), Way::Tabled(method)])
            .collect();
        if matches!(self.plant, Plant::Free(_)) {
            ways.push(Way::Quadrature);
        }
        ways
    }

    /// The whole computation, the making of a table or rule included.
    fn run(&self, way: Way, tolerance: f64) -> Result<Done, String> {
        let told = |e: &dyn Display| e.to_string();
        let (t, y, speed) = (self.start.t, &self.start.y, self.start.y[1]);
        let table = (PART * tolerance).max(FINEST);
        match (way, &self.plant) {
            (Way::Exact(by), Plant::Free(exact)) => {
                let mut equation = Equation::new(exact).at_speed(speed);
                self.integrate(&mut equation, by, tolerance)
            }
            (Way::Tabled(by), Plant::Free(exact)) => {
                let table = Table::new(exact, table, Extent::Whole).map_err(|e| told(&e))?;
                let mut equation = Equation::new(&table).at_speed(speed);
                self.integrate(&mut equation, by, tolerance)
            }
            (Way::Exact(by), Plant::Loaded(machine)) => {
                let mut moving = Moving::new(machine, t, y).map_err(|e| told(&e))?;
                self.integrate(&mut moving, by, tolerance)
            }
            (Way::Tabled(by), Plant::Loaded(machine)) => {
                let table = Tabled::new(machine, table, Extent::Whole).map_err(|e| told(&e))?;
                let mut moving = table.moving(t, y).map_err(|e| told(&e))?;
                self.integrate(&mut moving, by, tolerance)
            }
            (Way::Quadrature, Plant::Free(exact)) => {
                let orbit = Orbit::within(exact, self.state(), tolerance);
                let orbit = orbit.map_err(|e| told(&e))?;
                let work = Statistics {
                    evaluations: orbit.points,
                    ..Statistics::default()
                };
                let q = orbit.at(self.end).q;
                Ok(Done { q, work })
            }
            (Way::Quadrature, Plant::Loaded(_)) => Err("it does not come back".to_owned()),
        }
    }

    fn integrate(
        &self,
        system: &mut dyn System,
        method: Method,
        tolerance: f64,
    ) -> Result<Done, String> {
        let options = Options::new(method, tolerance);
        let mut watch = |_: &Point, _: &Point, _: Dense<'_>| Ok(Next::GoOn);
        let ended = integrate(system, &self.start, Some(self.end), &options, &mut watch);
        let ended = ended.map_err(|e| e.to_string())?;
        match ended.failed {
            Some(error) => Err(error.to_string()),
            None => Ok(Done {
                q: ended.at.y[0],
                work: ended.statistics,
            }),
        }
    }

    /// What a computation is off by at the end; a rule of quadrature at some times before it, too.
    fn rung(&self, way: Way, tolerance: f64) -> Rung {
        let Done { q, work } = or_stop(self.case, self.run(way, tolerance));
        let mut error = (q - self.truth).abs();
        if let (Way::Quadrature, Plant::Free(exact)) = (way, &self.plant) {
            let [rule, all] = [tolerance, 0.0]
                .map(|accuracy| or_stop(self.case, Orbit::within(exact, self.state(), accuracy)));
            for k in 0..COMPARED {
                let t = self.end * (f64::from(k) + 0.37) / f64::from(COMPARED);
                error = error.max((rule.at(t).q - all.at(t).q).abs());
            }
        }
        Rung {
            tolerance,
            error,
            work,
        }
    }

    /// One exact evaluation of the equation of motion.
    fn evaluation(&self) -> Subject<'_> {
        let mut system: Box<dyn System + '_> = match &self.plant {
            Plant::Free(exact) => Box::new(Equation::new(exact)),
            Plant::Loaded(machine) => {
                let moving = Moving::new(machine, self.start.t, &self.start.y);
                Box::new(or_stop(self.case, moving))
            }
        };
        let (case, mut y) = (self.case, self.start.y.clone());
        let mut out = vec![0.0; y.len()];
        Subject::new("one exact evaluation", TURN, move |q| {
            y[0] = q;
            or_stop(case, system.rates(0.0, &y, &mut out));
            black_box(&out);
        })
    }
}

/// A tolerance that was tried.
#[derive(Debug, Clone, Copy)]
struct Rung {
    tolerance: f64,
    error: f64,
    work: Statistics,
}

/// One line of a table.
struct Row {
    wanted: f64,
    way: Way,
    rung: Rung,
    /// Of all turns, s.
    least: f64,
}

impl Row {
    fn take_turn(&mut self, motion: &Motion) {
        let start = Instant::now();
        let done = black_box(motion.run(self.way, black_box(self.rung.tolerance)));
        self.least = self.least.min(start.elapsed().as_secs_f64());
        let off = (or_stop(motion.case, done).q - motion.truth).abs();
        assert!(off <= self.rung.error, "{:?}: {off:e}", self.way);
    }

    fn name(&self) -> String {
        match self.way {
            Way::Exact(method) => format!("{}, exact", method.name()),
            Way::Tabled(method) => format!("{}, its table", method.name()),
            Way::Quadrature => "quadrature".to_owned(),
        }
    }
}

fn main() {
    measure(&Motion::free("crank-rocker"));
    measure(&Motion::free("single-dwell"));
    measure(&Motion::loaded("four-bar"));
}

/// The rows of a motion by wanted error, each with its tolerance.
fn rows(motion: &Motion) -> Vec<Row> {
    let mut rows = Vec::new();
    for way in motion.ways() {
        let ladder: Vec<Rung> = (0..RUNGS)
            .map(|rung| motion.rung(way, FINEST * 10_f64.powi(rung)))
            .collect();
        for wanted in WANTED {
            let reached = ladder.iter().take_while(|rung| rung.error <= wanted);
            // BDF may end above the least error in ten free periods; its finest is then shown.
            let rung = match (way, reached.last()) {
                (_, Some(rung)) => *rung,
                (Way::Exact(Method::Bdf) | Way::Tabled(Method::Bdf), None) => ladder[0],
                _ => stop(motion.case, &format!("{way:?}: not within {wanted:e}")),
            };
            rows.push(Row {
                wanted,
                way,
                rung,
                least: f64::INFINITY,
            });
        }
    }
    // Stable: by error, and within it as the ways come.
    rows.sort_by(|a, b| b.wanted.total_cmp(&a.wanted));
    rows
}

fn measure(motion: &Motion) {
    let mut rows = rows(motion);
    let mut one = motion.evaluation();
    for _ in 0..TURNS {
        one.take_turn();
        for row in &mut rows {
            row.take_turn(motion);
        }
    }
    let evaluation = one.turns.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    println!("\n{}: {} {evaluation:.0} ns", motion.case, one.name);
    println!(
        "error  way                tolerance  reached  evaluations  Jacobians      us  / evaluation  / DOP853"
    );
    for row in &rows {
        let beside = |other: &&Row| {
            other.wanted == row.wanted && matches!(other.way, Way::Exact(Method::Dop853))
        };
        let eighth = rows.iter().find(beside).map_or(f64::NAN, |row| row.least);
        let Rung {
            tolerance,
            error,
            work,
        } = row.rung;
        println!(
            "{:5.0e}  {:18} {tolerance:9.0e}  {error:7.1e}  {:11}  {:9}  {:6.0}  {:12.0}  {:8.2}",
            row.wanted,
            row.name(),
            work.evaluations,
            work.jacobians,
            row.least * 1e6,
            row.least * 1e9 / evaluation,
            row.least / eighth
        );
    }
}

fn or_stop<T, E: Display>(case: &str, result: Result<T, E>) -> T {
    result.unwrap_or_else(|e| stop(case, &e.to_string()))
}
