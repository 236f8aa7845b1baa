//! The mechanisms of the tests.

use super::dense::DenseSubject;
use dwell_geometry::{Actuator, Body, Joint, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::Mass;
use dwell_verify::{Case, CheckedMechanism, Range, spread};
use std::f64::consts::PI;

/// A mechanism with everything a case and a subject need.
pub(crate) struct Setup {
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) range: Range,
    pub(crate) q0: f64,
    pub(crate) initial_guess: Vec<[f64; 3]>,
}

impl Setup {
    pub(crate) fn case(&self, positions: usize) -> Case<'_> {
        Case {
            mechanism: CheckedMechanism::Plane(&self.mechanism, (&self.masses).into()),
            range: self.range,
            positions: spread(self.range, positions),
        }
    }

    pub(crate) fn subject(&self) -> DenseSubject {
        self.subject_with(&self.masses)
    }

    pub(crate) fn subject_with(&self, masses: &[Mass]) -> DenseSubject {
        DenseSubject::new(
            &self.mechanism,
            masses,
            self.range,
            self.q0,
            &self.initial_guess,
        )
    }

    /// The mechanism at another position in the plane, with every moving body's frame shifted and turned.
    pub(crate) fn reframed(mut self, ground: Vec2, shift: Vec2, angle: f64) -> Self {
        let by = Vec2::from_angle(angle);
        let fixed = self.mechanism.ground;
        let reframe_point = |body: usize, p: Vec2| {
            if body == fixed {
                p + ground
            } else {
                p.rotate_inverse(by) + shift
            }
        };
        for joint in &mut self.mechanism.joints {
            for i in 0..2 {
                let body = joint.bodies[i].0;
                joint.points[i] = reframe_point(body, joint.points[i]);
                if let JointKind::Prismatic { axes } = &mut joint.kind
                    && body != fixed
                {
                    axes[i] = axes[i].rotate_inverse(by);
                }
            }
        }
        for (body, mass) in self.masses.iter_mut().enumerate() {
            mass.center = reframe_point(body, mass.center);
        }
        for (body, pose) in self.initial_guess.iter_mut().enumerate() {
            if body != fixed {
                pose[2] += angle;
                let arm = shift.rotate(Vec2::from_angle(pose[2]));
                pose[0] += ground.x - arm.x;
                pose[1] += ground.y - arm.y;
            }
        }
        for actuator in &self.mechanism.actuators {
            let angles = actuator
                .bodies
                .map(|b| if b.0 == fixed { 0.0 } else { angle });
            self.q0 += angles[1] - angles[0];
        }
        self
    }
}

/// Crank 1, coupler 3.5, rocker 3, ground 4 m; uniform bars of 1, 2 and 2 kg.
pub(crate) fn crank_rocker() -> Setup {
    Setup {
        mechanism: Mechanism {
            bodies: ["ground", "crank", "coupler", "rocker"]
                .map(Body::named)
                .into(),
            ground: 0,
            joints: vec![
                Joint::revolute("A", [0, 1], [Vec2::ZERO; 2]),
                Joint::revolute("B", [1, 2], [vec2(1.0, 0.0), Vec2::ZERO]),
                Joint::revolute("C", [2, 3], [vec2(3.5, 0.0), vec2(3.0, 0.0)]),
                Joint::revolute("D", [0, 3], [vec2(4.0, 0.0), Vec2::ZERO]),
            ],
            actuators: vec![Actuator::angle("phi", [0, 1])],
            couplings: vec![],
        },
        masses: vec![
            Mass::default(),
            Mass::uniform_bar(1.0, 1.0),
            Mass::uniform_bar(2.0, 3.5),
            Mass::uniform_bar(2.0, 3.0),
        ],
        range: Range::Full,
        q0: 0.0,
        initial_guess: vec![[0.0; 3], [0.0; 3], [1.0, 0.0, 0.9], [4.0, 0.0, 1.9]],
    }
}

/// The single-dwell reconstruction: Hoeken proportions, a guide pinned at Q, a slider on it.
pub(crate) fn single_dwell() -> Setup {
    Setup {
        mechanism: Mechanism {
            bodies: ["ground", "crank", "coupler", "rocker", "guide", "slider"]
                .map(Body::named)
                .into(),
            ground: 0,
            joints: vec![
                Joint::revolute("A", [0, 1], [Vec2::ZERO; 2]),
                Joint::revolute("B", [1, 2], [vec2(0.1, 0.0), Vec2::ZERO]),
                Joint::revolute("C", [2, 3], [vec2(0.25, 0.0); 2]),
                Joint::revolute("O", [0, 3], [vec2(0.2, 0.0), Vec2::ZERO]),
                Joint::revolute("Q", [0, 4], [vec2(-0.2, 0.4), Vec2::ZERO]),
                Joint::prismatic("slide", [4, 5], [Vec2::ZERO; 2], [0.0, 0.0]),
                Joint::revolute("P", [2, 5], [vec2(0.5, 0.0), Vec2::ZERO]),
            ],
            actuators: vec![Actuator::angle("phi", [0, 1])],
            couplings: vec![],
        },
        masses: vec![
            Mass::default(),
            Mass {
                mass: 20.0,
                center: Vec2::ZERO,
                inertia: 0.626,
            },
            Mass {
                mass: 1.5,
                center: vec2(0.25, 0.0),
                inertia: 1.5 * 0.25 / 12.0,
            },
            Mass::uniform_bar(0.75, 0.25),
            Mass::uniform_bar(2.1, 0.7),
            Mass {
                mass: 0.5,
                ..Mass::default()
            },
        ],
        range: Range::Full,
        q0: 0.0,
        initial_guess: vec![
            [0.0; 3],
            [0.0; 3],
            [0.1, 0.0, 1.37],
            [0.2, 0.0, 1.77],
            [-0.2, 0.4, 0.22],
            [0.2, 0.49, 0.22],
        ],
    }
}

/// An inverted slider-crank (quick return): a block on the crank pin slides in an offset slot of a
/// rocker. Off-centre frames; the ground is the second body of O, and the prismatic joint is
/// between two moving bodies with distinct axes and an offset.
pub(crate) fn inverted_slider_crank() -> Setup {
    Setup {
        mechanism: Mechanism {
            bodies: ["rocker", "crank", "ground", "block"]
                .map(Body::named)
                .into(),
            ground: 2,
            joints: vec![
                Joint::revolute("O", [0, 2], [vec2(-0.1, 0.05), vec2(0.0, -0.4)]),
                Joint::prismatic(
                    "slot",
                    [0, 3],
                    [vec2(0.1, 0.08), vec2(0.02, -0.01)],
                    [1.3, 1.3],
                ),
                Joint::revolute("A", [2, 1], [Vec2::ZERO, vec2(0.04, 0.03)]),
                Joint::revolute("B", [1, 3], [vec2(0.16, 0.12), vec2(-0.03, 0.02)]),
            ],
            actuators: vec![Actuator::angle("drive", [2, 1])],
            couplings: vec![],
        },
        masses: vec![
            Mass {
                mass: 3.0,
                center: vec2(0.02, 0.21),
                inertia: 0.05,
            },
            Mass {
                mass: 2.0,
                center: vec2(0.09, 0.05),
                inertia: 0.004,
            },
            Mass::default(),
            Mass {
                mass: 0.8,
                center: vec2(0.01, 0.03),
                inertia: 0.0007,
            },
        ],
        range: Range::Full,
        q0: 0.3,
        initial_guess: vec![[0.1, -0.4, 0.2], [0.0, 0.0, 0.3], [0.0; 3], [0.1, 0.1, 0.2]],
    }
}

/// The crank-rocker with a shorter rocker. At 1.5 m it is a change point mechanism: coupler and
/// rocker are stretched out when the crank points away from D.
pub(crate) fn crank_rocker_of(rocker: f64) -> Setup {
    let mut setup = crank_rocker();
    setup.mechanism.joints[2].points[1] = vec2(rocker, 0.0);
    setup.masses[3] = Mass::uniform_bar(2.0, rocker);
    // The triangle of 3, 3.5 and the rocker, by the law of cosines.
    let angle = |a: f64, b: f64, c: f64| ((a * a + b * b - c * c) / (2.0 * a * b)).acos();
    setup.initial_guess[2][2] = angle(3.0, 3.5, rocker);
    setup.initial_guess[3][2] = PI - angle(3.0, rocker, 3.5);
    setup
}

/// A bar on a pin: m is constant, and b is its centrifugal force alone.
pub(crate) fn pendulum() -> Setup {
    Setup {
        mechanism: Mechanism {
            bodies: ["bar", "ground"].map(Body::named).into(),
            ground: 1,
            joints: vec![Joint::revolute("A", [0, 1], [Vec2::ZERO, vec2(2.0, 1.0)])],
            actuators: vec![Actuator::angle("phi", [1, 0])],
            couplings: vec![],
        },
        masses: vec![Mass::uniform_bar(3.0, 0.8), Mass::default()],
        range: Range::Full,
        q0: 0.0,
        initial_guess: vec![[2.0, 1.0, 0.0], [0.0; 3]],
    }
}

/// A balanced disc: every force is zero throughout, and so is half dm/dq.
pub(crate) fn flywheel() -> Setup {
    let mut setup = pendulum();
    setup.masses[0] = Mass {
        mass: 20.0,
        center: Vec2::ZERO,
        inertia: 0.626,
    };
    setup
}

/// The crank-rocker driven between crank and coupler, over part of a turn: an actuator between two
/// moving bodies, which exerts nothing on the ground. The coupler is named first.
pub(crate) fn relative_drive() -> Setup {
    let mut setup = crank_rocker();
    setup.mechanism.actuators = vec![Actuator::angle("beta", [2, 1])];
    setup.range = Range::Limited(-2.2, -1.0);
    setup.q0 = -1.5;
    // Crank at an angle φ with β = φ − θ of the coupler.
    setup.initial_guess = vec![
        [0.0; 3],
        [0.0, 0.0, -0.9],
        [0.6, -0.8, 0.8],
        [4.0, 0.0, 1.9],
    ];
    setup
}
