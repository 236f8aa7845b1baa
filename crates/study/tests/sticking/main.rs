//! Dry friction that holds, against closed forms, by all integrators.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

mod blocks;
mod costs;
mod equilibria;
mod impacts;
mod refusals;
mod several;
mod stops;
mod switches;
mod yielding;

use dwell_dynamics::{
    ContactEvent, ContactMode, DynamicsError, Machine, Method, OdeState, Options, StopChange,
};
use dwell_scene::PlaneScene;
use dwell_study::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
use dwell_study::models::with_drive_loads;

/// A motion: its steps, the changes of its contacts, and the evaluations it took.
struct Run {
    steps: Vec<OdeState>,
    events: Vec<ContactEvent>,
    machine: Machine,
    evaluations: usize,
    /// Those of the monitors of events.
    event_evaluations: usize,
}

/// Integrates a scene until its end by a method, to a tolerance.
fn run(text: &str, method: Method, rtol: f64) -> Run {
    let (run, failure) = integrate(text, method, rtol);
    let end = run.steps.last();
    assert_eq!(failure, None, "{method:?} {end:?}");
    run
}

/// The error that ends the motion of a scene, if one does.
fn attempt(text: &str, method: Method, rtol: f64) -> Option<DynamicsError> {
    integrate(text, method, rtol).1
}

/// A motion as far as it comes, with the error that ends it.
fn integrate(text: &str, method: Method, rtol: f64) -> (Run, Option<DynamicsError>) {
    let scene = PlaneScene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e:?}"));
    let loaded = with_drive_loads(&scene).unwrap_or_else(|e| panic!("{e}"));
    let spec = scene.motion.as_ref().expect("a motion");
    let problem = FreeMotionProblem::new(&scene, &loaded, spec).unwrap_or_else(|e| panic!("{e}"));
    let duration = problem.duration().unwrap_or_else(|e| panic!("{e}"));
    let options = Options::new(method, rtol);
    let motion = problem
        .solve(duration, &options)
        .unwrap_or_else(|e| panic!("{e}"));
    let solutions = || motion.segments.iter().map(|(_, solution)| solution);
    let run = Run {
        steps: solutions().flat_map(|s| s.steps.clone()).collect(),
        events: solutions().flat_map(|s| s.contact_events.clone()).collect(),
        evaluations: solutions().map(|s| s.statistics.evaluations).sum(),
        event_evaluations: solutions().map(|s| s.statistics.event_evaluations).sum(),
        machine: problem.machine,
    };
    (run, motion.failure)
}

impl Run {
    /// Coordinate and speed of the only free coordinate at the end.
    fn end(&self) -> [f64; 2] {
        let last = self.steps.last().expect("steps");
        [last.y[0], last.y[1]]
    }

    /// The times at which surfaces take a mode of a kind.
    fn times(&self, is: impl Fn(ContactMode) -> bool) -> Vec<f64> {
        let of_kind = |event: &ContactEvent| match event {
            ContactEvent::Friction { t, to, .. } => is(*to).then_some(*t),
            ContactEvent::Stop { .. } | ContactEvent::Switch { .. } => None,
        };
        self.events.iter().filter_map(of_kind).collect()
    }

    /// The times at which stops change so.
    fn stops(&self, is: impl Fn(&StopChange) -> bool) -> Vec<f64> {
        let of_kind = |event: &ContactEvent| match event {
            ContactEvent::Stop { t, change, .. } => is(change).then_some(*t),
            ContactEvent::Friction { .. } | ContactEvent::Switch { .. } => None,
        };
        self.events.iter().filter_map(of_kind).collect()
    }

    /// How far kinetic and potential energy less all works vary, over the largest of them.
    fn energy_error(&self) -> f64 {
        let mut workspace = self.machine.workspace();
        let (mut low, mut high, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
        for step in &self.steps {
            let state = self.machine.evaluate(step.t, &step.y, &mut workspace);
            let [kinetic, potential] = state.expect("a state").energy();
            let works = &step.y[self.machine.work_offset()..];
            largest = works.iter().fold(largest, |max, work| max.max(work.abs()));
            let works: f64 = works.iter().sum();
            low = low.min(kinetic + potential - works);
            high = high.max(kinetic + potential - works);
            largest = largest.max(kinetic);
        }
        (high - low) / largest
    }
}

fn holds(mode: ContactMode) -> bool {
    mode == ContactMode::Holds
}

fn slides(mode: ContactMode) -> bool {
    matches!(mode, ContactMode::Slides { .. })
}

/// A tight tolerance of a method, and the error of a motion in it.
fn tolerance(method: Method) -> [f64; 2] {
    match method {
        Method::TrBdf2 => [1e-12, 1e-8],
        Method::Esdirk34 | Method::Bdf => [1e-13, 1e-9],
        Method::Tsit45 | Method::Dop853 => [1e-13, 1e-10],
    }
}
