//! Mechanisms in space: bodies, joints and actuators; their structure; positions, velocities and accelerations.
//!
//! A spanning tree of joints carries every body from the ground. The motions of its joints are the unknowns; each joint outside the
//! tree closes a loop, with one equation for each freedom that it takes away. A row of such an equation is a wrench, and a
//! freedom of a joint is a screw; their product is the entry of the Jacobian. One factorisation of each group of equations
//! serves positions, velocities, accelerations and, transposed, the reactions. Rank, not counting, decides mobility: a
//! linkage with redundant constraints moves, and its group has more rows than unknowns.
//!
//! ```
//! use dwell_geometry::Body;
//! use dwell_geometry::space::{Actuator, Assembly, Joint, JointKind, Mechanism, Plan, Side, vec3};
//!
//! // A shaft along z drives another, inclined by 30° in the plane x–z, through a Hooke joint at the origin.
//! let (sin, cos) = 30_f64.to_radians().sin_cos();
//! let joint = |name: &str, bodies: [usize; 2], kind, sides| Joint::new(name, bodies, kind, sides);
//! let side = |axis, normal| Side { axis, normal, ..Side::default() };
//! let (x, y, z) = (vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
//! let inclined = vec3(sin, 0.0, cos);
//! let mechanism = Mechanism {
//!     bodies: ["ground", "input", "output"].map(Body::named).into(),
//!     ground: 0,
//!     joints: vec![
//!         joint("A", [0, 1], JointKind::Revolute, [side(z, x), side(z, x)]),
//!         joint("cross", [1, 2], JointKind::Universal, [side(x, z), side(y, z)]),
//!         joint("B", [0, 2], JointKind::Cylindrical, [side(inclined, y), side(z, y)]),
//!     ],
//!     actuators: vec![Actuator::angle("q", 0)],
//!     couplings: Vec::new(),
//! };
//! let plan = Plan::compile(&mechanism, &Assembly::at(&[0.0]))?;
//! let mut pose = plan.pose::<f64>();
//! plan.positions(&[1.0], &mut pose)?;
//! plan.velocities(&[1.0], &mut pose);
//! // The output turns by the textbook's ratio cos β / (1 − sin²β cos²q), where q = 0 has the input's yoke in the plane of the shafts.
//! let speed = plan.body_motion(&pose, 2).angular_velocity.norm();
//! assert!((speed - cos / (1.0 - (sin * 1_f64.cos()).powi(2))).abs() < 1e-13);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assemble;
mod branch_fit;
mod change_points;
mod closure;
mod coordinate;
mod coupling;
mod factors;
mod follow;
mod frames;
mod gears;
mod groups;
mod joint_kinds;
mod lower;
mod mechanism;
mod motion;
mod multipliers;
mod numbers;
mod plan;
mod planar_equivalent;
mod planes;
mod positions;
mod prediction;
mod rank;
mod rod;
mod stations;
mod tree;
mod vector;
mod wrench;

pub use branch_fit::{BranchFit, BranchFitWorkspace};
pub use change_points::ChangePoint;
pub use coordinate::{Coordinate, CoordinateFunction, CountedRevolutions, Counting};
pub use coupling::CouplingEnd;
pub use frames::{BodyMotion, Frame};
pub use joint_kinds::{Condition, CouplingAction, JointKind};
pub use mechanism::{
    Actuator, ActuatorKind, Assembly, Joint, JointNumbers, Mechanism, Placement, Side,
};
pub use multipliers::Forces;
pub use plan::{GroupDescription, Plan, Pose, PoseMotion};
pub use planar_equivalent::PlanarEquivalent;
pub use rank::{IdleBody, Mobility};
pub use vector::{Rotation, Vec3, vec3};
pub use wrench::Wrench;
