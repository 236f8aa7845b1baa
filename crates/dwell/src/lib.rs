//! Kinematics, forces, the reduced model and the motion of mechanisms, in the plane and in space.
//!
//! A mechanism is built in a program, or read from a scene file; it is assembled, and then its results are computed.
//!
//! ```
//! use dwell::{Actuator, Mechanism};
//!
//! // A four-bar: the ground, a crank of 0.1 m, a coupler and a rocker; mass, centre of mass and inertia of each.
//! let mut m = Mechanism::builder("Four-bar");
//! m.ground().point("A", [0.0, 0.0]).point("D", [0.3, 0.0]);
//! m.body("crank").bar("A", "B", 0.1).mass(1.0, [0.05, 0.0], 8e-4);
//! m.body("coupler").bar("B", "C", 0.25).mass(1.5, [0.125, 0.0], 8e-3);
//! m.body("rocker").bar("D", "C", 0.2).mass(1.2, [0.1, 0.0], 4e-3);
//! m.pin("A", "ground", "crank").pin("B", "crank", "coupler");
//! m.pin("C", "coupler", "rocker").pin("D", "ground", "rocker");
//! m.actuator("phi", Actuator::angle("ground", "crank"));
//! m.assembly("phi", 1.0).assembly("rocker", 1.8); // the rocker's angle is an initial guess: it selects the branch
//! let four_bar = m.assemble()?;
//!
//! // The forces of a motion: crank at 60°, 20 rad/s, constant speed.
//! let q = 60f64.to_radians();
//! let forces = four_bar.inverse_dynamics(0.0, &[q], &[20.0], &[0.0])?;
//! let torque = forces.actuator_force("phi")?; // N·m
//! let [x, y] = [forces.reaction("B.x")?, forces.reaction("B.y")?]; // N, of the crank on the coupler
//!
//! // The same from the reduced model, m q̈ + ½m′ q̇² = Q and R = a q̈ + b q̇².
//! let reduced = four_bar.reduced(["B.x", "B.y"])?;
//! let at = reduced.at(q)?;
//! assert!((at.half_dm * 20.0 * 20.0 - torque).abs() < 1e-12);
//! assert!((at.b[0] * 20.0 * 20.0 - x).abs() < 1e-11 && (at.b[1] * 20.0 * 20.0 - y).abs() < 1e-11);
//! # Ok::<(), dwell::Error>(())
//! ```
//!
//! # What can be computed
//!
//! | question | call |
//! |---|---|
//! | where are the bodies? | [`Mechanism::positions`], [`Mechanism::kinematics`] |
//! | which forces does a motion need? | [`Mechanism::inverse_dynamics`] at one instant, [`Mechanism::kinetostatics`] along the prescribed motion |
//! | … without forces, or at rest | [`Mechanism::kinematics_along_motion`], [`Mechanism::statics_along_motion`] |
//! | the equation of motion | [`Mechanism::reduced`]: m, ½m′, w, and a, b, c of each reaction; [`ReducedModel::table`] |
//! | how does it move under its loads and drives? | [`Mechanism::simulate`], [`Mechanism::period`] |
//! | … with your own integrator | [`Mechanism::equation_of_motion`] |
//! | where does it rest, how does it vibrate? | [`Mechanism::equilibria`], [`Mechanism::linearise`] |
//! | how steadily does it run, which flywheel does it need? | [`Mechanism::cycle`] |
//! | what if its dimensions vary? | [`Sweep`] |
//! | on which numbers does a result depend, and how much? | [`Mechanism::gradient`] |
//! | models of MuJoCo, ROS, Gazebo, FreeCAD, PMKS+ | [`import`] |
//! | code for a controller, or formulas | [`Scene::export`], [`Scene::closed_form`] |
//!
//! # Your own loads
//!
//! The magnitude of a load may be a function of your program, [`Magnitude::function`], of time, coordinates and velocities. Unlike an expression, a function
//! cannot be searched for switches. Between its [breakpoints](Magnitude::breakpoints) it must be smooth in its signals and
//! depend on nothing else. A breakpoint is a value of one signal at which the function jumps or has a kink. The integration of a motion stops there and restarts on
//! the other side, or slides along the breakpoint if both sides lead back to it; the motion is that of the equivalent expression. Near a breakpoint the
//! function is called on one side of it only; beyond the breakpoint its value there is used.
//!
//! An unnamed jump makes the steps of every method too short to continue; [`MotionResults::early_stop`] then names the load. An unnamed kink costs accuracy and
//! steps, and a pulse shorter than a step may be missed. A switch that depends on several signals at once (`x > y`) needs a named coordinate,
//! or an expression.
//!
//! # Conventions
//!
//! SI units: m, rad, kg, s, N. Right-handed plane, angles counter-clockwise. A mechanism whose points have three numbers is in space;
//! the type to which a vector is assigned determines [its number of components](Kinematics). A reaction is the force or moment of the
//! joint's first-named body on the second. Points are written `body.point`, reactions `joint.component`. Coordinates are those of
//! the actuators, in their order. A [`Mechanism`] and a [`ReducedModel`] are constant and shared between threads.
//!
//! A mechanism built in a program is a scene: [`MechanismBuilder::to_toml`] writes it for the `dwell` command. Keys of joints, loads, laws,
//! drives and friction without a function of their own are set by `with`. Sections without a function, such as `[coordinate-sweep]`, are given as text
//! to [`MechanismBuilder::toml`].
//!
//! More programs are in the folder `examples`: reactions of a four-bar, the single-dwell study, the flywheel of a press,
//! equilibrium and natural frequencies, a tolerance study, and your own loads.

mod assembled;
mod batch;
mod column_table;
mod equation;
mod error;
mod export;
mod import;
mod machine;
mod mechanism;
mod motion;
mod reduced;
mod sweep;
mod table;
mod value;

pub use batch::CoefficientBatch;
/// What became of the parts of an imported model, and what it means; see [`import`].
///
/// ```
/// use dwell::{Effect, Finding};
/// fn lost(findings: &[Finding]) -> Vec<String> {
///     let changes = findings.iter().filter(|one| one.effect == Effect::Changes);
///     changes.map(|one| one.to_string()).collect()
/// }
/// # assert!(lost(&[]).is_empty());
/// ```
pub use dwell_door::{Closing, Effect, Finding, Format, Import, ImportOptions};
/// An integration method; see [`Solver::method`].
///
/// ```
/// let solver = dwell::Solver::method(dwell::Method::Bdf, 1e-10);
/// ```
pub use dwell_dynamics::Method;
/// A vibration mode of an [`Equilibrium`].
///
/// ```
/// # fn show(mode: &dwell::Mode) {
/// println!("{:.3} rad/s, damping ratio {:.3}", mode.angular_frequency, mode.damping_ratio);
/// # }
/// ```
pub use dwell_dynamics::Mode;
/// The stability of an [`Equilibrium`].
///
/// ```
/// # fn show(found: &dwell::Equilibrium) {
/// if found.stability == dwell::Stability::Unstable { println!("unstable at {:?}", found.coordinates); }
/// # }
/// ```
pub use dwell_dynamics::Stability;
/// A version of the Functional Mock-up Interface; see [`ExportTarget`].
///
/// ```no_run
/// use dwell::{ExportTarget, FmiVersion};
/// let scene = dwell::Scene::read("../../docs/slider.toml")?;
/// for (path, content) in scene.export(ExportTarget::Fmu(FmiVersion::Three), 1e-9)? {
///     std::fs::write(path, content).expect("slider.fmu can be written");
/// }
/// # Ok::<(), dwell::Error>(())
/// ```
pub use dwell_export::FmiVersion;
/// A language of [`Scene::closed_form`].
///
/// ```
/// let scene = dwell::Scene::read("../../docs/slider.toml")?;
/// assert!(scene.closed_form(dwell::Language::C, Some("B.x"))?.contains("#include <math.h>"));
/// # Ok::<(), dwell::Error>(())
/// ```
pub use dwell_study::Language;
/// Results with their derivatives by all numbers of a scene.
///
/// ```
/// let scene = dwell::Scene::read("../../docs/slider.toml")?;
/// let gradient = scene.assemble()?.gradient(&["m.max"])?;
/// let inertia = &gradient.results[0];
/// // The generalised inertia is a sum of multiples of all masses and moments of inertia.
/// let of_masses = inertia.numbers.iter().filter(|n| n.path.ends_with(".mass") || n.path.ends_with(".inertia"));
/// let sum: f64 = of_masses.map(|n| n.slope * n.value).sum();
/// assert!((sum - inertia.value).abs() < 1e-12 * inertia.value);
/// # Ok::<(), dwell::Error>(())
/// ```
pub use dwell_study::gradient::{Gradient, NumberSlope, ResultGradient, SlopeMethod};
/// The best design of a job with its certificate.
///
/// ```
/// // A spring that carries a lamp in every position: its stiffness is m g r / (h a).
/// let scene = dwell::Scene::read("../../tests/all/optimise/lamp.toml")?;
/// let best: dwell::Optimised = scene.assemble()?.optimise(Some("stiffness"), 1)?;
/// assert_eq!(best.certificate.doubt, None);
/// assert!((best.numbers[0].after - 220.725).abs() < 1e-6);
/// # Ok::<(), dwell::Error>(())
/// ```
pub use dwell_study::optimise::{
    ActivePeak, Certificate, ConditionReport, MetOptimum, Optimised, OptimisedNumber,
};
pub use equation::EquationOfMotion;
pub use error::Error;
pub use export::ExportTarget;
pub use import::import;
pub use machine::{Cycle, Equilibrium, StateSpace};
pub use mechanism::Mechanism;
pub use mechanism::builder::{BodyBuilder, MechanismBuilder};
pub use mechanism::kinematics::{InverseDynamics, Kinematics};
pub use mechanism::parts::{
    Actuator, Coordinate, Drive, Event, Friction, Joint, Law, Load, Magnitude, Motion,
};
pub use mechanism::scene::Scene;
pub use motion::{MotionResults, Period, Solver};
pub use reduced::{Coefficients, Evaluator, ReducedModel};
pub use sweep::{Sweep, SweepResults};
pub use table::Table;
pub use value::Value;

/// Runs the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
