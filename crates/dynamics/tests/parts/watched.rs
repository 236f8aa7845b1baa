//! Machines whose events are watched, by integrators and by quadrature.

use super::{angle, four_bar, gravity, mechanism, slider_crank};
use dwell_dynamics::{
    CoordinateMode, Event, EventKind, Machine, Method, ObservedMachine, OdeState, Options, Orbit,
    ReducedState, Solution, solve, solve_orbit,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{AssemblyConfiguration, BodyId, Coordinate, Joint, JointId, Mechanism, Vec2};
use dwell_kinetostatics::{Load, Mass, Model};
use std::num::NonZeroUsize;

/// A machine of one freedom at its start.
pub(crate) struct Watched {
    pub(crate) name: &'static str,
    mechanism: Mechanism,
    machine: Machine,
    output_model: Model,
    pub(crate) start: ReducedState,
}

impl Watched {
    fn new(
        name: &'static str,
        mut shape: Mechanism,
        guess: &[f64],
        masses: &[Mass],
        loads: &[Load],
        [q, q_dot]: [f64; 2],
    ) -> Self {
        shape.actuators = vec![angle([0, 1])];
        let assembly = AssemblyConfiguration {
            q: vec![q],
            initial_guess: guess.iter().map(|&angle| Some(angle)).collect(),
            ..AssemblyConfiguration::default()
        };
        let model = |reactions| Model::new(&shape, masses, &assembly, reactions).expect("a model");
        let reactions = shape.reactions();
        let output_model = model(&reactions).with_loads(loads.to_vec()).expect("loads");
        let free = vec![CoordinateMode::Free];
        Self {
            name,
            machine: Machine::new(model(&[]), loads, free, &[]).expect("a machine"),
            output_model,
            mechanism: shape,
            start: ReducedState { t: 0.0, q, q_dot },
        }
    }

    /// A uniform bar of 1 m and 2 kg, at an angle from the bottom, with a speed.
    pub(crate) fn pendulum([from_bottom, q_dot]: [f64; 2]) -> Self {
        let shape = mechanism(
            &["ground", "bar"],
            vec![Joint::revolute("A", [0, 1], [Vec2::ZERO; 2])],
        );
        let q = from_bottom - std::f64::consts::FRAC_PI_2;
        let masses = [Mass::default(), Mass::uniform_bar(2.0, 1.0)];
        Self::new(
            "pendulum",
            shape,
            &[0.0, q],
            &masses,
            &[gravity()],
            [q, q_dot],
        )
    }

    /// A crank-rocker with gravity, or without loads.
    pub(crate) fn crank_rocker(loads: &[Load], start: [f64; 2]) -> Self {
        let masses = [
            Mass::default(),
            Mass::uniform_bar(1.0, 1.0),
            Mass::uniform_bar(2.0, 3.5),
            Mass::uniform_bar(2.0, 3.0),
        ];
        let shape = four_bar([4.0, 1.0, 3.5, 3.0]);
        Self::new(
            "crank-rocker",
            shape,
            &[0.0, start[0], 0.6, 1.8],
            &masses,
            loads,
            start,
        )
    }

    /// A slider-crank with gravity.
    pub(crate) fn slider_crank(start: [f64; 2]) -> Self {
        let masses = [
            Mass::default(),
            Mass::uniform_bar(1.0, 0.3),
            Mass::uniform_bar(1.0, 1.0),
            Mass::uniform_bar(0.5, 0.1),
        ];
        let shape = slider_crank(0.3, 1.0, 0.0);
        let guess = [0.0, start[0], -0.3 * start[0].sin(), 0.0];
        Self::new("slider-crank", shape, &guess, &masses, &[gravity()], start)
    }

    /// The angle of a body from the ground.
    pub(crate) fn angle(&self, body: usize) -> CoordinateFunction {
        let coordinate = Coordinate::Angle([BodyId(0), BodyId(body)]);
        CoordinateFunction::find(&self.mechanism, coordinate).expect("an angle")
    }

    /// The travel of a joint.
    pub(crate) fn travel(&self, joint: usize) -> CoordinateFunction {
        let coordinate = Coordinate::Travel(JointId(joint));
        CoordinateFunction::find(&self.mechanism, coordinate).expect("a travel")
    }

    pub(crate) fn orbit(&self) -> Orbit {
        Orbit::loaded(&self.machine, self.start).expect("an orbit")
    }

    /// A coordinate and a reaction at a state.
    pub(crate) fn values(
        &self,
        c: CoordinateFunction,
        reaction: usize,
        at: ReducedState,
    ) -> [f64; 2] {
        use dwell_dynamics::Observed as _;
        let mut observed = ObservedMachine::new(&self.machine, &self.output_model);
        let at = OdeState {
            t: at.t,
            y: vec![at.q, at.q_dot],
        };
        let coordinate = observed.coordinate(c, &at).expect("a coordinate").value;
        [
            coordinate,
            observed.reaction(reaction, &at).expect("a reaction"),
        ]
    }

    pub(crate) fn by_integration(
        &self,
        method: Method,
        tolerance: f64,
        end: f64,
        events: &[Event],
    ) -> Solution {
        let start = OdeState {
            t: 0.0,
            y: self
                .machine
                .initial_state(&[self.start.q], &[self.start.q_dot]),
        };
        let options = Options::new(method, tolerance);
        let solution = solve(
            &self.machine,
            &self.output_model,
            &start,
            end,
            &options,
            events,
        );
        solution.expect("a run")
    }

    pub(crate) fn by_quadrature(&self, accuracy: f64, end: f64, events: &[Event]) -> Solution {
        let observed = ObservedMachine::new(&self.machine, &self.output_model);
        let options = Options::new(Method::Dop853, accuracy);
        solve_orbit(&self.orbit(), observed, end, &options, events).expect("an orbit's events")
    }
}

/// Events that do not end the motion.
pub(crate) fn watch(kinds: &[EventKind]) -> Vec<Event> {
    kinds
        .iter()
        .map(|&kind| Event {
            kind,
            terminal: None,
        })
        .collect()
}

/// An event that ends the motion with one of its occurrences.
pub(crate) fn stop_at(kind: EventKind, occurrence: usize) -> Event {
    Event {
        kind,
        terminal: NonZeroUsize::new(occurrence),
    }
}

/// How often each event happens.
pub(crate) fn counts(solution: &Solution, events: usize) -> Vec<usize> {
    let of = |e: usize| {
        solution
            .event_occurrences
            .iter()
            .filter(|o| o.event == e)
            .count()
    };
    (0..events).map(of).collect()
}
