//! Assembly at the given coordinates, in the assembly mode that the initial guess selects.

pub(crate) mod initial_guess;
pub(crate) mod modes;

use crate::assembly::initial_guess::InitialGuess;
use crate::assembly::modes::{AssemblyMode, SAME_MODE};
use crate::error::{AssemblyError, PositionError};
use crate::plan::{GroupKind, PlacementMethod, Plan, Pose};
use crate::positions::{InitialIterate, rotate_frame};
use crate::structure::groups::Unknown;
use crate::structure::lower::LoweredCoordinate;
use std::f64::consts::TAU;

impl Plan {
    /// Assembles the mechanism group by group, and fixes the branch of every group.
    pub(crate) fn assemble(
        &mut self,
        initial_guess: &InitialGuess,
    ) -> Result<Pose<f64>, AssemblyError> {
        let mut pose = self.pose();
        let q = self.assembly_coordinates.clone();
        pose.q.clone_from(&q);
        self.count_body_revolutions(initial_guess);
        for g in 0..self.groups.len() {
            // A coupling may count revolutions from a frame that an actuator turns from one solved before.
            self.positions_before(g, &mut pose)
                .map_err(|e| self.assembly_error(g, e))?;
            self.start_group(g, initial_guess, &mut pose);
            let modes = match self.groups[g].kind.placement_method() {
                Some(PlacementMethod::Newton) => {
                    self.modes_by_newton(g, initial_guess, &mut pose)?
                }
                Some(PlacementMethod::Linear | PlacementMethod::GearTrain) => {
                    vec![self.closed_form_mode(g, 1.0, &mut pose)?]
                }
                _ => vec![
                    self.closed_form_mode(g, 1.0, &mut pose)?,
                    self.closed_form_mode(g, -1.0, &mut pose)?,
                ],
            };
            let mode = self.select_mode(g, modes, initial_guess)?;
            self.groups[g].kind.set_root_sign(mode.root_sign);
            if let GroupKind::Factored(factored_group) = &mut self.groups[g].kind {
                factored_group.branch = mode.branch;
            }
            self.set_unknowns(g, &mode.values, &mut pose);
            self.group_positions(g, &mut pose)
                .map_err(|e| self.assembly_error(g, e))?;
        }
        self.positions_from(&q, &mut pose, InitialIterate::CurrentPose)
            .map_err(|e| self.assembly_error(self.groups.len(), e))?;
        Ok(pose)
    }

    /// Counts the revolutions of bodies in one orientation class. They may be whole revolutions apart, because each
    /// counts from its own approximate angle.
    fn count_body_revolutions(&mut self, initial_guess: &InitialGuess) {
        let mut revolution_offsets = vec![0.0; self.lowered.bodies];
        for class in 0..self.frames.orientation_classes {
            if !self.revolution_counted[self.class_frames[class]] {
                continue;
            }
            let class_angle = |b: usize| {
                let orientation = self.frames.orientations[b];
                let angle = initial_guess.angles[b]?;
                Some(angle - orientation.offset_angle - self.assembly_angle(orientation.frame))
            };
            let members = &self.frames.class_bodies[class];
            let first = match class {
                0 => Some(0.0),
                _ => members.iter().find_map(|&b| class_angle(b)),
            };
            for &b in members {
                if let (Some(first), Some(class_angle_of_body)) = (first, class_angle(b)) {
                    revolution_offsets[b] = TAU * ((class_angle_of_body - first) / TAU).round();
                }
            }
        }
        for (coupling, lowered_coupling) in self.couplings.iter_mut().zip(&self.lowered.couplings) {
            let whole = |sum: &[(LoweredCoordinate, f64)]| -> f64 {
                let each = sum.iter().map(|&(coordinate, factor)| match coordinate {
                    LoweredCoordinate::Angle(b) => factor * revolution_offsets[b],
                    LoweredCoordinate::Travel(_) => 0.0,
                });
                each.sum()
            };
            coupling.dependent.constant += whole(&lowered_coupling.dependent);
            if let (Some((_, independent)), Some((_, sum))) =
                (&mut coupling.law, &lowered_coupling.law)
            {
                independent.constant += whole(sum);
            }
        }
        self.revolution_offsets = revolution_offsets;
    }

    /// Prepares a group that is solved for the first time: revolutions are counted from the approximate angles, and
    /// gears mesh as they are given.
    fn start_group(&mut self, g: usize, initial_guess: &InitialGuess, pose: &mut Pose<f64>) {
        for unknown in self.groups[g].group.unknowns.clone() {
            if let Unknown::ClassAngle(class) = unknown
                && self.revolution_counted[self.class_frame(class)]
            {
                let hint = self.hint(unknown, initial_guess);
                self.set_class_angle(class, hint.unwrap_or(0.0), pose);
            }
        }
        for actuated in &self.groups[g].actuated_frames {
            rotate_frame(actuated, pose);
        }
        for r in self.groups[g].group.couplings.clone() {
            if self.lowered.couplings[r].constant_from_assembly {
                let residual = self.couplings[r].value(&pose.angle, &pose.slide_travel);
                self.couplings[r].dependent.constant -= residual;
            }
        }
    }

    /// The assembly mode that a closed form gives with one sign of its root.
    fn closed_form_mode(
        &mut self,
        g: usize,
        root_sign: f64,
        pose: &mut Pose<f64>,
    ) -> Result<AssemblyMode, AssemblyError> {
        self.groups[g].kind.set_root_sign(root_sign);
        self.group_positions(g, pose)
            .map_err(|e| self.assembly_error(g, e))?;
        Ok(self.found_mode(g, root_sign, pose))
    }

    /// The assembly mode nearest to the initial guess.
    fn select_mode(
        &mut self,
        g: usize,
        mut modes: Vec<AssemblyMode>,
        initial_guess: &InitialGuess,
    ) -> Result<AssemblyMode, AssemblyError> {
        // A length is positive, unless nothing else is possible.
        if modes.iter().any(|mode| !mode.has_negative_length) {
            modes.retain(|mode| !mode.has_negative_length);
        }
        let distance = |mode: &AssemblyMode| self.distance_to_guess(g, mode, initial_guess);
        let distances: Vec<f64> = modes.iter().map(distance).collect();
        let min_distance = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let mut order: Vec<usize> = (0..modes.len()).collect();
        order.sort_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        let in_order = |picked: &[usize]| -> Vec<&AssemblyMode> {
            picked.iter().map(|&k| &modes[k]).collect()
        };
        let nearest = order.partition_point(|&k| distances[k] - min_distance < SAME_MODE);
        if nearest > 1 {
            let ambiguous = self.distinguish_modes(g, &in_order(&order[..nearest]), initial_guess);
            return Err(AssemblyError::Ambiguous {
                bodies: ambiguous.bodies,
                joints: ambiguous.joints,
                modes: ambiguous.modes,
            });
        }
        let group_modes = self.distinguish_modes(g, &in_order(&order), initial_guess);
        self.group_modes.push(group_modes);
        match order.first() {
            Some(&first) => Ok(modes.swap_remove(first)),
            None => Err(AssemblyError::NoAssembly {
                bodies: self.group_bodies(g),
                joints: self.group_joints(g),
                gap: f64::NAN,
            }),
        }
    }

    pub(crate) fn assembly_error(&self, g: usize, error: PositionError) -> AssemblyError {
        let g = error.group().unwrap_or(g);
        let (bodies, joints) = if g < self.groups.len() {
            (self.group_bodies(g), self.group_joints(g))
        } else {
            (Vec::new(), Vec::new())
        };
        let gap = match error {
            PositionError::Singular { .. } => {
                return AssemblyError::SingularAssembly { bodies, joints };
            }
            PositionError::OffTable {
                coupling, x, end, ..
            } => return AssemblyError::OffTable { coupling, x, end },
            PositionError::NoAssembly { gap, .. } => gap,
            PositionError::NotConverged { residual, .. } => residual,
            PositionError::OtherBranch { .. }
            | PositionError::OutOfRange { .. }
            | PositionError::NotFinite
            | PositionError::LanesDiverge { .. } => f64::NAN,
        };
        AssemblyError::NoAssembly {
            bodies,
            joints,
            gap,
        }
    }
}
