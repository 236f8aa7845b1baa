//! A conservative system of one degree of freedom: its inertia, its potential V and the force −V′ as functions of
//! its coordinate.

use crate::error::{DynamicsError, Result, positive_inertia};
use crate::machine::{Machine, MovingModel};
use crate::repetition::{PERIODICITY_TOLERANCE, repetition_angle};
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::{InverseDynamics, KinematicState, ReducedModel};
use std::f64::consts::TAU;

/// Phases, as parts of a revolution, at which the mechanism is compared with itself some revolutions on.
const PHASE_FRACTIONS: [f64; 7] = [0.0, 0.131, 0.292, 0.417, 0.583, 0.719, 0.877];
/// Inertia, potential and force at a coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EnergyTerms {
    /// m, kg m² or kg.
    pub(crate) m: f64,
    /// V, J.
    pub(crate) potential: f64,
    /// −V′, N·m or N.
    pub(crate) force: f64,
}

/// A system of one coordinate whose energy is constant.
pub(crate) trait ConservativeSystem {
    /// Its inertia, potential and force at `q` (rad or m).
    fn energy_terms(&mut self, q: f64) -> Result<EnergyTerms>;

    /// For each frame or hinge at the last `q`: its angle (rad, except for whole revolutions) and the derivative of this angle with respect
    /// to the coordinate; empty if positions are unknown.
    fn turns(&self) -> Vec<[f64; 2]>;

    /// The range of the coordinate.
    fn range(&self) -> Range;

    /// Whether the coordinate is an angle.
    fn is_angle(&self) -> bool;

    /// Whether there is no potential, so that its direction of motion never changes.
    fn is_potential_free(&self) -> bool {
        false
    }

    /// Whether a position follows a function of the scene, such as that of a cam, whose potential may change within a small part of the
    /// range.
    fn follows_functions(&self) -> bool {
        false
    }

    /// The angle after which everything repeats itself, rad; none if it never does.
    fn period(&mut self, q: f64) -> Result<Option<f64>> {
        if !self.is_angle() || self.range().limits().is_some() {
            return Ok(None);
        }
        if self.is_potential_free() && self.range() == Range::Full {
            return Ok(Some(TAU));
        }
        let close = |a: f64, b: f64, size: f64| (a - b).abs() <= PERIODICITY_TOLERANCE * size;
        let same = |all: &[EnergyTerms], here: &EnergyTerms, there: &EnergyTerms| {
            let size =
                |of: fn(&EnergyTerms) -> f64| all.iter().fold(0.0_f64, |s, h| s.max(of(h).abs()));
            close(there.m, here.m, here.m)
                && close(there.potential, here.potential, size(|h| h.potential))
                && close(there.force, here.force, size(|h| h.force))
        };
        repetition_angle(q, &PHASE_FRACTIONS, |q| self.energy_terms(q), same)
    }
}

/// A mechanism without loads.
pub(crate) struct UnloadedSystem<'a, R: ReducedModel> {
    pub(crate) model: &'a R,
    pub(crate) workspace: R::Workspace,
}

impl<R: ReducedModel> ConservativeSystem for UnloadedSystem<'_, R> {
    fn energy_terms(&mut self, q: f64) -> Result<EnergyTerms> {
        let (m, _) = self.model.inertia(q, &mut self.workspace)?;
        Ok(EnergyTerms {
            m: positive_inertia(m, q)?,
            potential: 0.0,
            force: 0.0,
        })
    }

    fn turns(&self) -> Vec<[f64; 2]> {
        self.model.unit_turns(&self.workspace)
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn is_angle(&self) -> bool {
        !matches!(self.model.range(), Range::Stroke(..))
    }

    fn is_potential_free(&self) -> bool {
        true
    }
}

/// A machine of one freedom whose loads all have a potential.
pub(crate) struct LoadedSystem<M: MovingModel> {
    model: M,
    flywheel: f64,
    workspace: M::Workspace<f64>,
    inverse_dynamics: InverseDynamics<f64>,
}

impl<M: MovingModel> LoadedSystem<M> {
    pub(crate) fn new(machine: &Machine<M>) -> Result<Self> {
        if machine.model().actuators() != 1 || machine.free() != [0] {
            return Err(DynamicsError::NotConservative {
                what: "it has not one coordinate, which is free",
            });
        }
        if !machine.nonconservative_sources().is_empty() {
            return Err(DynamicsError::NotConservative {
                what: "a drive, or a load without a potential, does work on it",
            });
        }
        let model = machine.model().without_reactions();
        Ok(Self {
            workspace: model.pass_workspace(),
            inverse_dynamics: model.result_buffer(),
            flywheel: machine.flywheel(0),
            model,
        })
    }
}

impl<M: MovingModel> ConservativeSystem for LoadedSystem<M> {
    fn energy_terms(&mut self, q: f64) -> Result<EnergyTerms> {
        let Self {
            model,
            workspace,
            inverse_dynamics: result,
            ..
        } = self;
        let state = KinematicState::new(model, [&[q], &[0.0]], workspace)?.apply_loads(0.0)?;
        let loads = 0..model.loads().len();
        let potential = loads.filter_map(|load| state.potential_energy(load)).sum();
        let mut state = state.inverse_dynamics(&[0.0], result)?;
        let force = -result.tau[0];
        state.mass_matrix_column(0, result);
        Ok(EnergyTerms {
            m: positive_inertia(result.tau[0] + self.flywheel, q)?,
            potential,
            force,
        })
    }

    fn turns(&self) -> Vec<[f64; 2]> {
        self.model.column_turns(&self.workspace)
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn is_angle(&self) -> bool {
        self.model.is_angle(0)
    }

    fn is_potential_free(&self) -> bool {
        self.model.loads().is_empty()
    }

    fn follows_functions(&self) -> bool {
        self.model.follows_functions()
    }
}

/// The ends of the range in the revolution in which `q` lies, rad or m; none if there are no limits.
///
/// # Errors
/// [`PositionError::OutOfRange`] if `q` lies outside.
pub(crate) fn limits(range: Range, q: f64) -> Result<Option<(f64, f64)>> {
    let Some((from, to)) = range.limits() else {
        return Ok(None);
    };
    let shift = match range {
        Range::Limited(..) => TAU * ((q - from) / TAU).floor(),
        Range::Full
        | Range::Revolutions(_)
        | Range::Stroke(..)
        | Range::Unbounded
        | Range::Unresolved(..) => 0.0,
    };
    if q > to + shift || q < from + shift {
        return Err(PositionError::OutOfRange { q, from, to }.into());
    }
    Ok(Some((from + shift, to + shift)))
}
