//! Mechanisms and what the tests ask of a journey.
#![allow(dead_code, reason = "each test binary takes what it needs")]
#![allow(clippy::expect_used, reason = "tests")]

use dwell_dynamics::{
    Atlas, Drive, DriveKind, Event, Journey, Method, Motor, Options, Point, Site,
};
use dwell_geometry::{
    Actuator, Body, BodyId, Drive as Drives, Joint, JointKind, Mechanism, Start, Vec2, vec2,
};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass};

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
        drive: Drives::Angle,
    }
}

pub(crate) fn length(bodies: [usize; 2], points: [Vec2; 2]) -> Actuator {
    Actuator {
        name: "length".into(),
        bodies: bodies.map(BodyId),
        drive: Drives::Length(points),
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
            free: 0.3,
        },
        magnitude: Magnitude::Constant(0.4),
    }
}

pub(crate) fn torsion_damper(bodies: [usize; 2]) -> Load {
    Load {
        name: "damper".into(),
        kind: LoadKind::TorsionDamper {
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
            constant: 0.1,
            resistance: 2.0,
            inductance: 0.05,
            ratio: 3.0,
            inertia: 0.001,
        }),
    }
}

/// An atlas of a mechanism in the coordinate of an actuator.
pub(crate) struct Setup {
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) start: Start,
    pub(crate) loads: Vec<Load>,
    pub(crate) drives: Vec<Drive>,
}

impl Setup {
    pub(crate) fn new(
        mechanism: &Mechanism,
        actuator: Actuator,
        masses: &[Mass],
        q: f64,
        rough: &[f64],
    ) -> Self {
        Self {
            mechanism: Mechanism {
                actuators: vec![actuator],
                ..mechanism.clone()
            },
            masses: masses.to_vec(),
            start: Start {
                q: vec![q],
                rough: rough.iter().map(|&angle| Some(angle)).collect(),
                joints: Vec::new(),
            },
            loads: Vec::new(),
            drives: Vec::new(),
        }
    }

    pub(crate) fn under(mut self, loads: &[Load], drives: &[Drive]) -> Self {
        self.loads = loads.to_vec();
        self.drives = drives.to_vec();
        self
    }

    pub(crate) fn atlas(&self) -> Atlas<'_> {
        let site = Site {
            mechanism: &self.mechanism,
            masses: &self.masses,
            start: &self.start,
            loads: &self.loads,
            drives: &self.drives,
            reactions: &[],
        };
        Atlas::new(site).expect("an atlas")
    }

    /// The start at a speed.
    pub(crate) fn at(&self, atlas: &Atlas<'_>, q_dot: f64) -> Point {
        let machine = &atlas.charts()[0].machine;
        Point {
            t: 0.0,
            y: machine.start(&self.start.q, &[q_dot]),
        }
    }
}

/// Follows to an end, which must be reached.
pub(crate) fn run(
    atlas: &mut Atlas<'_>,
    start: &Point,
    [end, every]: [f64; 2],
    method: Method,
    events: &[Event],
) -> Journey {
    let options = Options {
        every: Some(every),
        ..Options::new(method, 1e-12)
    };
    let journey = atlas.follow(start, end, &options, events).expect("a run");
    assert_eq!(journey.failed, None, "{:?}", atlas.refused());
    assert_eq!(journey.changes.len() + 1, journey.legs.len());
    journey
}

/// All samples, from all legs.
pub(crate) fn samples(journey: &Journey) -> Vec<Point> {
    let legs = journey.legs.iter();
    legs.flat_map(|leg| leg.trace.samples.clone()).collect()
}

/// How far kinetic and potential energy together vary, over the largest kinetic energy.
pub(crate) fn energy_lost(atlas: &Atlas<'_>, journey: &Journey) -> f64 {
    let (mut low, mut high, mut most) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for leg in &journey.legs {
        let machine = &atlas.charts()[leg.chart].machine;
        let mut work = machine.work();
        for point in &leg.trace.steps {
            machine
                .evaluate(point.t, &point.y, &mut work)
                .expect("a state");
            let [kinetic, potential] = machine.energy(&work);
            most = most.max(kinetic);
            low = low.min(kinetic + potential);
            high = high.max(kinetic + potential);
        }
    }
    (high - low) / most
}
