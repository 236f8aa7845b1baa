//! A scene with its model of every reaction, at a number of positions: what was found there, and the dense equations' answer.

use super::claims::{all_reactions, constant};
use crate::error::ValidationError;
use dwell_geometry::PositionError;
use dwell_geometry::space::{Placement, Pose};
use dwell_kinetostatics::InverseDynamics;
use dwell_kinetostatics::space::{Axes, LoadKind, Model, Workspace};
use dwell_scene::SpaceScene;
use dwell_study::{PreparedSpaceScene, StudyError};
use dwell_verify::space::DenseSpace;

/// Positions at which everything is compared.
pub(super) const POSITIONS: usize = 12;

/// A case with the memory of its evaluations.
pub(super) struct Samples<'a> {
    pub(super) scene: &'a SpaceScene,
    pub(super) prepared: &'a PreparedSpaceScene<'a>,
    /// The model with all components of all joints in the axes of the ground.
    pub(super) model: Model,
    pub(super) workspace: Workspace,
    pub(super) pose: Pose,
    /// The positions, rad or m.
    pub(super) q: Vec<f64>,
}

/// A pass: speed and acceleration of the coordinate, and whether the weight acts.
#[derive(Clone, Copy)]
pub(super) struct Pass {
    pub(super) q_dot: f64,
    pub(super) q_ddot: f64,
    pub(super) is_loaded: bool,
}

/// Unit speed, unit acceleration from rest, and the loads at rest.
pub(super) const PASSES: [Pass; 3] = [
    Pass {
        q_dot: 1.0,
        q_ddot: 0.0,
        is_loaded: false,
    },
    Pass {
        q_dot: 0.0,
        q_ddot: 1.0,
        is_loaded: false,
    },
    Pass {
        q_dot: 0.0,
        q_ddot: 0.0,
        is_loaded: true,
    },
];

impl<'a> Samples<'a> {
    pub(super) fn new(prepared: &'a PreparedSpaceScene<'a>) -> Result<Self, ValidationError> {
        let scene = prepared.scene;
        let model = prepared.model_for(&all_reactions(scene, &[Axes::Ground]))?;
        // Between the ends of the range, and at no special place of it.
        let ends = prepared.drawn_range();
        let at = |k: usize| ends[0] + (ends[1] - ends[0]) * (k as f64 + 0.43) / POSITIONS as f64;
        Ok(Self {
            scene,
            prepared,
            workspace: model.workspace(),
            pose: model.plan().pose(),
            q: (0..POSITIONS).map(at).collect(),
            model,
        })
    }

    pub(super) fn explain(&self, error: &PositionError) -> StudyError {
        self.prepared.explain(error)
    }

    /// The placements of all bodies at a coordinate.
    pub(super) fn placements(&mut self, q: f64) -> Result<Vec<Placement>, StudyError> {
        let plan = self.model.plan();
        plan.positions(&[q], &mut self.pose)
            .map_err(|e| self.prepared.explain(&e))?;
        let bodies = 0..self.scene.mechanism.bodies.len();
        Ok(bodies.map(|b| plan.placement(&self.pose, b)).collect())
    }

    /// A thousandth of the force that a pass gives the whole mass at the size of the mechanism, N or kg m.
    pub(super) fn floor(&self, pass: Pass) -> f64 {
        let mass: f64 = self.scene.masses.iter().map(|mass| mass.mass).sum();
        let acceleration = match pass.is_loaded {
            true => self.prepared.weight().unwrap_or(1.0),
            false if self.model.plan().is_angle(0) => self.model.plan().size(),
            false => 1.0,
        };
        1e-3 * mass * acceleration
    }

    /// The loads of constant magnitude.
    pub(super) fn loads(&self) -> Vec<(LoadKind, f64)> {
        self.scene.loads.iter().filter_map(constant).collect()
    }

    /// Actuator's action and reactions in a pass, of the model.
    pub(super) fn found(&mut self, q: f64, pass: Pass) -> Result<InverseDynamics<f64>, StudyError> {
        let mut found = self.model.result_buffer();
        if !pass.is_loaded {
            let [q_dot, q_ddot] = &[[pass.q_dot], [pass.q_ddot]];
            let workspace = &mut self.workspace;
            let done = (self.model).inverse_dynamics(&[q], q_dot, q_ddot, workspace, &mut found);
            done.map_err(|e| self.prepared.explain(&e))?;
            return Ok(found);
        }
        let mut of_load = self.model.result_buffer();
        for (kind, magnitude) in self.loads() {
            let workspace = &mut self.workspace;
            let done = (self.model).unit_load_response(&[q], &kind, workspace, &mut of_load);
            done.map_err(|e| self.prepared.explain(&e))?;
            let sums = found.tau.iter_mut().chain(&mut found.reactions);
            for (sum, part) in sums.zip(of_load.tau.iter().chain(&of_load.reactions)) {
                *sum += magnitude * part;
            }
        }
        Ok(found)
    }

    /// The dense equations in a pass.
    pub(super) fn dense(&self, placements: &[Placement], pass: Pass) -> Option<DenseSpace> {
        let loads = match pass.is_loaded {
            true => self.loads(),
            false => Vec::new(),
        };
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        let rates: [&[f64]; 2] = [&[pass.q_dot], &[pass.q_ddot]];
        DenseSpace::new(mechanism, masses, placements, rates, &loads).ok()
    }
}
