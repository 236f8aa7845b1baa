//! Motions of mechanisms in space under loads that do not vary: by integration with any number of coordinates, and by
//! quadrature with one.
//!
//! ```
//! use dwell_dynamics::{ReducedState, SpaceMachine};
//! use dwell_geometry::Body;
//! use dwell_geometry::space::{Actuator, Assembly, Joint, JointKind, Mechanism, Side, vec3};
//! use dwell_kinetostatics::space::{LoadKind, Mass, Model};
//! use std::f64::consts::{PI, TAU};
//!
//! // Mach's pendulum: 1 kg at 1 m from an axis that is inclined by 60°, so that it swings as under g cos 60°.
//! let (sin, cos) = (PI / 3.0).sin_cos();
//! let lowest = vec3(sin, 0.0, -cos);
//! let side = Side { axis: vec3(cos, 0.0, sin), normal: lowest, ..Side::default() };
//! let mechanism = Mechanism {
//!     bodies: ["ground", "pendulum"].map(Body::named).into(),
//!     ground: 0,
//!     joints: vec![Joint::new("A", [0, 1], JointKind::Revolute, [side; 2])],
//!     actuators: vec![Actuator::angle("q", 0)],
//! };
//! let masses = [Mass::default(), Mass { mass: 1.0, center: lowest, inertia: [0.0; 6] }];
//! let model = Model::new(&mechanism, &masses, &Assembly::at(&[0.0]), &[])?;
//! let machine = SpaceMachine::new(&model, vec![(LoadKind::Gravity(vec3(0.0, 0.0, -1.0)), 9.81)]);
//!
//! let orbit = machine.orbit(ReducedState { t: 0.0, q: 0.01, q_dot: 0.0 })?;
//! // T = 2π √(l / g cos α) (1 + q₀²/16 + …)
//! let period = TAU / (9.81 * cos).sqrt() * (1.0 + 0.01 * 0.01 / 16.0);
//! assert!((orbit.period / period - 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::conservative::{ConservativeSystem, EnergyTerms};
use crate::error::{DynamicsError, Result, positive_inertia};
use crate::ode::{DualWorkspace, OdeSystem, ReducedState};
use crate::orbit::Orbit;
use dwell_geometry::Range;
use dwell_kinetostatics::space::{LoadKind, Model, Workspace};
use dwell_numerics::{Dual, Scalar, lu};

/// A mechanism in space, free in all its coordinates, under loads with their magnitudes: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceMachine {
    model: Model,
    loads: Vec<(LoadKind, f64)>,
}

impl SpaceMachine {
    /// A model under loads. Its reactions are left out: motions do not depend on them.
    pub fn new(model: &Model, loads: Vec<(LoadKind, f64)>) -> Self {
        let model = model.without_reactions();
        Self { model, loads }
    }

    /// The model that moves.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The motion of one coordinate under loads that all have a potential, by quadrature.
    ///
    /// # Errors
    /// [`DynamicsError::NotConservative`] with another number of coordinates, or a load without a potential; else as
    /// [`Orbit::loaded`].
    pub fn orbit(&self, start: ReducedState) -> Result<Orbit> {
        if self.model.plan().actuators() != 1 {
            let what = "it has not one coordinate, which is free";
            return Err(DynamicsError::NotConservative { what });
        }
        if !self.loads.iter().all(|(kind, _)| kind.is_conservative()) {
            let what = "a load without a potential does work on it";
            return Err(DynamicsError::NotConservative { what });
        }
        Orbit::of(&mut SpaceSystem::new(self), start)
    }

    /// Kinetic and potential energy at a state [q, q̇], J; loads without a potential have none.
    ///
    /// # Errors
    /// [`DynamicsError::Position`] where there is no pose.
    pub fn energy(&self, y: &[f64]) -> Result<[f64; 2]> {
        let mut workspace = EquationWorkspace::new(self);
        let n = self.model.plan().actuators();
        let (q, q_dot) = y.split_at(n);
        workspace.evaluate(self, q, q_dot)?;
        let rows = workspace.mass_matrix.chunks(n.max(1));
        let momenta = rows.map(|row| row.iter().zip(q_dot).map(|(m, v)| m * v).sum::<f64>());
        let kinetic = 0.5 * momenta.zip(q_dot).map(|(p, v)| p * v).sum::<f64>();
        Ok([kinetic, self.potential(&workspace.inner)])
    }

    /// The potential energy at the last pose, J.
    fn potential(&self, workspace: &Workspace) -> f64 {
        let all = self.loads.iter().filter_map(|(kind, magnitude)| {
            let unit = self.model.potential_energy(kind, workspace)?;
            Some(magnitude * unit)
        });
        all.sum()
    }
}

/// The memory to evaluate (1) of [`Model::equation_of_motion`].
#[derive(Debug, Clone)]
struct EquationWorkspace<T> {
    inner: Workspace<T>,
    mass_matrix: Vec<T>,
    forces: Vec<T>,
    pivots: Vec<usize>,
}

impl<T: Scalar> EquationWorkspace<T> {
    fn new(machine: &SpaceMachine) -> Self {
        let n = machine.model.plan().actuators();
        let zero = T::from_f64(0.0);
        Self {
            inner: machine.model.workspace(),
            mass_matrix: vec![zero; n * n],
            forces: vec![zero; n],
            pivots: vec![0; n],
        }
    }

    fn evaluate(&mut self, machine: &SpaceMachine, q: &[T], q_dot: &[T]) -> Result<()> {
        machine.model.equation_of_motion(
            [q, q_dot],
            &machine.loads,
            &mut self.inner,
            &mut self.mass_matrix,
            &mut self.forces,
        )?;
        Ok(())
    }

    /// ẏ of y = [q, q̇].
    fn rates(&mut self, machine: &SpaceMachine, y: &[T], out: &mut [T]) -> Result<()> {
        let n = y.len() / 2;
        let (q, q_dot) = y.split_at(n);
        self.evaluate(machine, q, q_dot)?;
        let first = y.first().map_or(0.0, |q| q.value());
        let m = self.mass_matrix.first().map_or(1.0, |m| m.value());
        let factored = lu::factor(&mut self.mass_matrix, &mut self.pivots);
        let resists = factored.determinant_sign > 0.0 && factored.pivot_ratio > 0.0;
        if !(resists && m > 0.0 && m.is_finite()) {
            return Err(DynamicsError::NoInertia { q: first, m });
        }
        lu::solve(&self.mass_matrix, &self.pivots, &mut self.forces);
        out[..n].copy_from_slice(q_dot);
        out[n..].copy_from_slice(&self.forces);
        Ok(())
    }
}

/// The equation of motion with the working memory to evaluate it, for one thread. The states are [q, q̇].
#[derive(Debug)]
pub struct SpaceOde<'m> {
    machine: &'m SpaceMachine,
    workspace: EquationWorkspace<f64>,
    dual_workspace: DualWorkspace<EquationWorkspace<Dual>>,
}

impl<'m> SpaceOde<'m> {
    /// The equation of motion of a machine.
    pub fn new(machine: &'m SpaceMachine) -> Self {
        let states = 2 * machine.model.plan().actuators();
        Self {
            machine,
            workspace: EquationWorkspace::new(machine),
            dual_workspace: DualWorkspace::new(EquationWorkspace::new(machine), states),
        }
    }
}

impl OdeSystem for SpaceOde<'_> {
    fn size(&self) -> usize {
        2 * self.machine.model.plan().actuators()
    }

    fn rhs(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        self.workspace.rates(self.machine, y, out)
    }

    fn jacobian(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let machine = self.machine;
        let rhs = |y: &[Dual], workspace: &mut EquationWorkspace<Dual>, rates: &mut [Dual]| {
            workspace.rates(machine, y, rates)
        };
        self.dual_workspace.jacobian(y.len(), y, out, rhs)
    }
}

/// A machine of one coordinate whose loads all have a potential.
struct SpaceSystem<'m> {
    machine: &'m SpaceMachine,
    workspace: EquationWorkspace<f64>,
}

impl<'m> SpaceSystem<'m> {
    fn new(machine: &'m SpaceMachine) -> Self {
        let workspace = EquationWorkspace::new(machine);
        Self { machine, workspace }
    }
}

impl ConservativeSystem for SpaceSystem<'_> {
    fn energy_terms(&mut self, q: f64) -> Result<EnergyTerms> {
        self.workspace.evaluate(self.machine, &[q], &[0.0])?;
        Ok(EnergyTerms {
            m: positive_inertia(self.workspace.mass_matrix[0], q)?,
            potential: self.machine.potential(&self.workspace.inner),
            force: self.workspace.forces[0],
        })
    }

    fn range(&self) -> Range {
        self.machine.model.plan().range()
    }

    fn is_angle(&self) -> bool {
        self.machine.model.plan().is_angle(0)
    }

    fn is_potential_free(&self) -> bool {
        self.machine.loads.is_empty()
    }
}
