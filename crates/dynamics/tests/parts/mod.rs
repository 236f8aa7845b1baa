//! Mechanisms, and the assertions on a journey.
#![allow(dead_code, reason = "each test binary takes what it needs")]
#![allow(clippy::expect_used, reason = "tests")]

pub(crate) mod watched;

use dwell_dynamics::{
    Atlas, ContinuedMotion, CoordinateMode, Event, Machine, MachineDescription, Method, OdeState,
    Options, Solution,
};
use dwell_geometry::{
    Actuator, ActuatorKind, AssemblyConfiguration, Body, BodyId, Joint, Mechanism, Vec2, vec2,
};
use dwell_kinetostatics::{Drive, DriveKind, Load, LoadKind, Magnitude, Mass, Model, Motor};

pub(crate) fn angle(bodies: [usize; 2]) -> Actuator {
    Actuator::angle("angle", bodies)
}

pub(crate) fn length(bodies: [usize; 2], points: [Vec2; 2]) -> Actuator {
    Actuator::new("length", bodies, ActuatorKind::Length(points))
}

pub(crate) fn mechanism(bodies: &[&str], joints: Vec<Joint>) -> Mechanism {
    Mechanism {
        bodies: bodies.iter().copied().map(Body::named).collect(),
        joints,
        ..Mechanism::default()
    }
}

/// Ground, crank, coupler and rocker of these lengths, with pins A, B, C, D.
pub(crate) fn four_bar([ground, crank, coupler, rocker]: [f64; 4]) -> Mechanism {
    mechanism(
        &["ground", "crank", "coupler", "rocker"],
        vec![
            Joint::revolute("A", [0, 1], [Vec2::ZERO; 2]),
            Joint::revolute("B", [1, 2], [vec2(crank, 0.0), Vec2::ZERO]),
            Joint::revolute("C", [2, 3], [vec2(coupler, 0.0), vec2(rocker, 0.0)]),
            Joint::revolute("D", [0, 3], [vec2(ground, 0.0), Vec2::ZERO]),
        ],
    )
}

/// Ground, crank, rod and piston, with a guide beside the crank's pivot.
pub(crate) fn slider_crank(crank: f64, rod: f64, offset: f64) -> Mechanism {
    let points = [vec2(0.0, offset), Vec2::ZERO];
    let guide = Joint::prismatic("D", [0, 3], points, [0.0; 2]);
    mechanism(
        &["ground", "crank", "rod", "piston"],
        vec![
            Joint::revolute("A", [0, 1], [Vec2::ZERO; 2]),
            Joint::revolute("B", [1, 2], [vec2(crank, 0.0), Vec2::ZERO]),
            Joint::revolute("C", [2, 3], [vec2(rod, 0.0), Vec2::ZERO]),
            guide,
        ],
    )
}

pub(crate) fn gravity() -> Load {
    Load {
        name: "gravity".into(),
        kind: LoadKind::Gravity {
            direction: vec2(0.0, -1.0),
        },
        magnitude: Magnitude::Constant(9.81),
    }
}

pub(crate) fn torsion_spring(bodies: [usize; 2]) -> Load {
    Load {
        name: "spring".into(),
        kind: LoadKind::torsion_spring(bodies.map(BodyId), 0.3),
        magnitude: Magnitude::Constant(0.4),
    }
}

pub(crate) fn torsion_damper(bodies: [usize; 2]) -> Load {
    Load {
        name: "damper".into(),
        kind: LoadKind::rotational_damper(bodies.map(BodyId)),
        magnitude: Magnitude::Constant(0.5),
    }
}

/// A motor with a rotor and a current that takes its time.
pub(crate) fn motor(bodies: [usize; 2]) -> Drive {
    Drive {
        name: "motor".into(),
        coordinate: angle(bodies).coordinate(),
        kind: DriveKind::Motor(Motor {
            voltage: Magnitude::Constant(12.0),
            torque_constant: 0.1,
            resistance: 2.0,
            inductance: 0.05,
            gear_ratio: 3.0,
            rotor_inertia: 0.001,
            is_torque_speed_line: false,
        }),
    }
}

/// An atlas of a mechanism in the coordinate of an actuator.
pub(crate) struct Setup {
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) assembly: AssemblyConfiguration,
    pub(crate) loads: Vec<Load>,
    pub(crate) drives: Vec<Drive>,
}

impl Setup {
    pub(crate) fn new(
        mechanism: &Mechanism,
        actuator: Actuator,
        masses: &[Mass],
        q: f64,
        initial_guess: &[f64],
    ) -> Self {
        Self {
            mechanism: Mechanism {
                actuators: vec![actuator],
                ..mechanism.clone()
            },
            masses: masses.to_vec(),
            assembly: AssemblyConfiguration {
                q: vec![q],
                initial_guess: initial_guess.iter().map(|&angle| Some(angle)).collect(),
                branch_hints: Vec::new(),
            },
            loads: Vec::new(),
            drives: Vec::new(),
        }
    }

    pub(crate) fn with_loads(mut self, loads: &[Load], drives: &[Drive]) -> Self {
        self.loads = loads.to_vec();
        self.drives = drives.to_vec();
        self
    }

    pub(crate) fn atlas(&self) -> Atlas<'_> {
        let description = MachineDescription {
            varying_inertias: &[],
            mechanism: &self.mechanism,
            masses: &self.masses,
            assembly: &self.assembly,
            loads: &self.loads,
            drives: &self.drives,
            reactions: &[],
        };
        Atlas::new(description).expect("an atlas")
    }

    /// The start at a speed.
    pub(crate) fn initial_state(&self, atlas: &Atlas<'_>, q_dot: f64) -> OdeState {
        let machine = &atlas.charts()[0].machine;
        OdeState {
            t: 0.0,
            y: machine.initial_state(&self.assembly.q, &[q_dot]),
        }
    }
}

/// Follows to an end, which must be reached.
pub(crate) fn solve_setup(
    atlas: &mut Atlas<'_>,
    start: &OdeState,
    [end, sample_interval]: [f64; 2],
    method: Method,
    events: &[Event],
) -> ContinuedMotion {
    let options = Options {
        sample_interval: Some(sample_interval),
        ..Options::new(method, 1e-12)
    };
    let motion = atlas.solve(start, end, &options, events).expect("a run");
    assert_eq!(motion.error, None, "{:?}", atlas.uncrossable());
    assert_eq!(motion.changes.len() + 1, motion.segments.len());
    motion
}

/// All samples, from all legs.
pub(crate) fn samples(motion: &ContinuedMotion) -> Vec<OdeState> {
    let segments = motion.segments.iter();
    segments
        .flat_map(|segment| segment.solution.samples.clone())
        .collect()
}

/// How far kinetic and potential energy together vary, over the largest kinetic energy.
pub(crate) fn energy_lost(atlas: &Atlas<'_>, motion: &ContinuedMotion) -> f64 {
    let (mut low, mut high, mut max_kinetic) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for segment in &motion.segments {
        let machine = &atlas.charts()[segment.chart].machine;
        let mut workspace = machine.workspace();
        for point in &segment.solution.steps {
            let state = machine.evaluate(point.t, &point.y, &mut workspace);
            let [kinetic, potential] = state.expect("a state").energy();
            max_kinetic = max_kinetic.max(kinetic);
            low = low.min(kinetic + potential);
            high = high.max(kinetic + potential);
        }
    }
    (high - low) / max_kinetic
}

/// Moment of inertia of [`wheel`], kg m².
pub(crate) const INERTIA: f64 = 2.0;

/// A wheel on its axle under a couple, and drives.
pub(crate) fn wheel(magnitude: Magnitude, drives: &[Drive]) -> Machine {
    let axle = Joint::revolute("axle", [0, 1], [Vec2::ZERO; 2]);
    let mut wheel = mechanism(&["ground", "wheel"], vec![axle]);
    wheel.actuators = vec![angle([0, 1])];
    let masses = [
        Mass::default(),
        Mass {
            mass: 1.0,
            center: Vec2::ZERO,
            inertia: INERTIA,
        },
    ];
    let assembly = AssemblyConfiguration {
        q: vec![0.0],
        initial_guess: vec![None; 2],
        ..AssemblyConfiguration::default()
    };
    let model = Model::new(&wheel, &masses, &assembly, &[]).expect("a model");
    let couple = Load {
        name: "couple".into(),
        kind: LoadKind::couple([BodyId(0), BodyId(1)]),
        magnitude,
    };
    Machine::new(model, &[couple], vec![CoordinateMode::Free], drives).expect("a machine")
}

/// Angle and speed at the end.
pub(crate) fn end_state(solution: &Solution) -> [f64; 2] {
    assert_eq!(solution.error, None);
    let last = solution.steps.last().expect("steps");
    [last.y[0], last.y[1]]
}

/// The global error of an integration in tolerances: some tens (BDF: 20), and 300 with order 2.
pub(crate) fn error_ratio(method: Method) -> f64 {
    match method {
        Method::TrBdf2 => 1000.0,
        Method::Bdf | Method::Esdirk34 | Method::Tsit45 | Method::Dop853 => 100.0,
    }
}
