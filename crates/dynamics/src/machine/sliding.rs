//! A machine at a state of a motion: on the held pieces of its loads and drives, or sliding along a switch, with the weighted mean of the
//! forces on both sides.

use super::workspace::EquationWorkspace;
use super::{Machine, MachineState, MachineWorkspace, MovingModel};
use crate::error::Result;
use crate::modes::{EventSide, Mode, MotionModes};
use crate::ode::OdeState;
use crate::sliding::SideRates;
use crate::state_switches::HeldSource;

impl<M: MovingModel> Machine<M> {
    /// Evaluates a state of a motion in its mode on a side of an event. The held pieces stay held in the workspace.
    ///
    /// # Errors
    /// As [`Machine::evaluate`].
    pub fn evaluate_along<'a>(
        &'a self,
        (modes, side): (&MotionModes, EventSide),
        at: &OdeState,
        workspace: &'a mut MachineWorkspace<f64, M>,
    ) -> Result<MachineState<'a, f64, M>> {
        let state = modes.state_at(at, side);
        match modes.mode_at(at.t, side) {
            Some(mode) => self.evaluate_in_mode(&mode, &state, workspace),
            None => self.evaluate(at.t, &at.y, workspace),
        }
    }

    /// Evaluates a state in a given mode.
    fn evaluate_in_mode<'a>(
        &'a self,
        mode: &Mode<'_>,
        at: &OdeState,
        workspace: &'a mut MachineWorkspace<f64, M>,
    ) -> Result<MachineState<'a, f64, M>> {
        let Some(sliding) = mode.sliding else {
            self.hold_pieces(&mode.pieces, workspace);
            return self.evaluate(at.t, &at.y, workspace);
        };
        let mut functions = vec![[0.0; 2]; self.state_switches.kinds().len()];
        let mut rates = vec![0.0; self.state_count()];
        let (mut first, mut lower) = ([[0.0; 2]; 2], None);
        for (pieces, first) in sliding.sides.iter().zip(&mut first) {
            let held = self.hold_pieces(pieces, workspace);
            let state = self.evaluate(at.t, &at.y, workspace)?;
            state.derivative(&mut rates);
            lower.get_or_insert_with(|| (state.equation.clone(), state.magnitudes().to_vec()));
            self.switch_rates(at.t, &at.y, &rates, workspace, &held, &mut functions)?;
            *first = functions[sliding.switches[0]];
        }
        let part = SideRates { sides: first }.upper_part();
        let mut state = self.evaluate(at.t, &at.y, workspace)?;
        if let Some((lower, mut magnitudes)) = lower {
            for (mixed, upper) in magnitudes.iter_mut().zip(state.magnitudes()) {
                *mixed += part * (upper - *mixed);
            }
            let magnitudes = magnitudes.into_iter().enumerate();
            state.forces.set_magnitudes(magnitudes)?;
            state.equation.mix_with(&lower, part);
        }
        Ok(state)
    }

    /// Holds loads and drives on these pieces; returns the held pieces.
    fn hold_pieces(
        &self,
        pieces: &[Option<f64>],
        workspace: &mut MachineWorkspace<f64, M>,
    ) -> Vec<HeldSource> {
        let mut held = Vec::new();
        let set = |load: usize, held: &_| self.hold_source(load, held, workspace);
        self.state_switches.hold(pieces, &mut held, set);
        held
    }
}

impl EquationWorkspace<f64> {
    /// Takes a part of the forces and accelerations, and the rest of those on the lower side of a switch.
    fn mix_with(&mut self, lower: &Self, part: f64) {
        let (result, of_lower) = (&mut self.inverse_dynamics, &lower.inverse_dynamics);
        for (upper, lower) in [
            (&mut self.q_ddot, &lower.q_ddot),
            (&mut self.drive_forces, &lower.drive_forces),
            (&mut result.tau, &of_lower.tau),
            (&mut result.reactions, &of_lower.reactions),
        ] {
            for (upper, lower) in upper.iter_mut().zip(lower) {
                *upper = lower + part * (*upper - lower);
            }
        }
    }
}
