//! The forces of a machine whose motion slides along the switch of a load: those of both sides, by the part of each.

use super::{Machine, MachineWorkspace, MovingModel};
use crate::error::Result;
use crate::ode::OdeState;
use crate::sliding::{SideRates, Sliding};

/// What acts and what it causes in a motion that slides along a switch.
#[derive(Debug, Clone, PartialEq)]
pub struct SlidingForces {
    /// By actuator: its acceleration, per s².
    pub q_ddot: Vec<f64>,
    /// By load, those of the drives last: its magnitude.
    pub magnitudes: Vec<f64>,
}

impl<M: MovingModel> Machine<M> {
    /// The accelerations and the magnitudes of loads that keep a motion on its switch, at a state.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where the state cannot be evaluated.
    pub fn sliding_forces(
        &self,
        sliding: &Sliding,
        at: &OdeState,
        workspace: &mut MachineWorkspace<f64, M>,
    ) -> Result<SlidingForces> {
        let mut held = Vec::new();
        let mut sides = Vec::with_capacity(2);
        let mut functions = vec![[0.0; 2]; self.state_switches.kinds().len()];
        let mut first = [[0.0; 2]; 2];
        let mut rates = vec![0.0; self.state_count()];
        for (pieces, first) in sliding.sides.iter().zip(&mut first) {
            let set = |load: usize, held: &_| self.hold_source(load, held, workspace);
            self.state_switches.hold(pieces, &mut held, set);
            let state = self.evaluate(at.t, &at.y, workspace)?;
            state.derivative(&mut rates);
            sides.push((state.q_ddot().to_vec(), state.magnitudes().to_vec()));
            self.switch_rates((at.t, &at.y), &rates, workspace, &held, &mut functions)?;
            *first = functions[sliding.switches[0]];
        }
        let set = |load: usize, held: &_| self.hold_source(load, held, workspace);
        let none = vec![None; functions.len()];
        self.state_switches.hold(&none, &mut held, set);
        let part = SideRates { sides: first }.upper_part();
        let mix = |lower: &[f64], upper: &[f64]| -> Vec<f64> {
            let both = lower.iter().zip(upper);
            both.map(|(l, u)| l + part * (u - l)).collect()
        };
        Ok(SlidingForces {
            q_ddot: mix(&sides[0].0, &sides[1].0),
            magnitudes: mix(&sides[0].1, &sides[1].1),
        })
    }
}
