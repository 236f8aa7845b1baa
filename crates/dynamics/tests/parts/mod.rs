//! Mechanisms and what the tests ask of a journey.
#![allow(dead_code, reason = "each test binary takes what it needs")]
#![allow(clippy::expect_used, reason = "tests")]

pub(crate) mod watched;

use dwell_dynamics::{
    Atlas, ContinuedMotion, Event, MachineDescription, Method, OdeState, Options,
};
use dwell_geometry::{
    Actuator, ActuatorKind, AssemblyConfiguration, Body, BodyId, Joint, JointKind, Mechanism, Vec2,
    vec2,
};
use dwell_kinetostatics::{Drive, DriveKind, Load, LoadKind, Magnitude, Mass, Motor};

pub(crate) fn body(name: &str) -> Body {
    Body { name: name.into() }
}

pub(crate) fn pin(name: &str, bodies: [usize; 2], points: [Vec2; 2]) -> Joint {
    Joint {
        name: name.into(),
        bodies: bodies.map(BodyId),
        points,
        kind: JointKind::Revolute,
    }
}

pub(crate) fn angle(bodies: [usize; 2]) -> Actuator {
    Actuator {
        name: "angle".into(),
        bodies: bodies.map(BodyId),
        kind: ActuatorKind::Angle,
    }
}

pub(crate) fn length(bodies: [usize; 2], points: [Vec2; 2]) -> Actuator {
    Actuator {
        name: "length".into(),
        bodies: bodies.map(BodyId),
        kind: ActuatorKind::Length(points),
    }
}

/// A uniform bar from its frame's origin along x.
pub(crate) fn bar(mass: f64, length: f64) -> Mass {
    Mass {
        mass,
        center: vec2(0.5 * length, 0.0),
        inertia: mass * length * length / 12.0,
    }
}

pub(crate) fn mechanism(bodies: &[&str], joints: Vec<Joint>) -> Mechanism {
    Mechanism {
        bodies: bodies.iter().map(|name| body(name)).collect(),
        joints,
        ..Mechanism::default()
    }
}

/// Ground, crank, coupler and rocker of these lengths, with pins A, B, C, D.
pub(crate) fn four_bar([ground, crank, coupler, rocker]: [f64; 4]) -> Mechanism {
    mechanism(
        &["ground", "crank", "coupler", "rocker"],
        vec![
            pin("A", [0, 1], [Vec2::ZERO; 2]),
            pin("B", [1, 2], [vec2(crank, 0.0), Vec2::ZERO]),
            pin("C", [2, 3], [vec2(coupler, 0.0), vec2(rocker, 0.0)]),
            pin("D", [0, 3], [vec2(ground, 0.0), Vec2::ZERO]),
        ],
    )
}

/// Ground, crank, rod and piston, with a guide beside the crank's pivot.
pub(crate) fn slider_crank(crank: f64, rod: f64, offset: f64) -> Mechanism {
    let guide = Joint {
        name: "D".into(),
        bodies: [BodyId(0), BodyId(3)],
        points: [vec2(0.0, offset), Vec2::ZERO],
        kind: JointKind::Prismatic {
            axes: [Vec2::IDENTITY; 2],
        },
    };
    mechanism(
        &["ground", "crank", "rod", "piston"],
        vec![
            pin("A", [0, 1], [Vec2::ZERO; 2]),
            pin("B", [1, 2], [vec2(crank, 0.0), Vec2::ZERO]),
            pin("C", [2, 3], [vec2(rod, 0.0), Vec2::ZERO]),
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
        kind: LoadKind::TorsionSpring {
            bodies: bodies.map(BodyId),
            free_angle: 0.3,
        },
        magnitude: Magnitude::Constant(0.4),
    }
}

pub(crate) fn torsion_damper(bodies: [usize; 2]) -> Load {
    Load {
        name: "damper".into(),
        kind: LoadKind::RotationalDamper {
            bodies: bodies.map(BodyId),
        },
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
