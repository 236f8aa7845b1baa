//! Whether a variant is assembled on the branch of the plan, and whether its actuator turns fully on it, judged by its
//! own poses.

use crate::assembly::initial_guess::InitialGuess;
use crate::assembly::modes::SAME_MODE;
use crate::error::PositionError;
use crate::mechanism::{ActuatorKind, Mechanism};
use crate::motion::Motion;
use crate::plan::range::Range;
use crate::plan::{AssemblyConfiguration, AssurGroup, GroupKind, Plan, Pose};
use crate::plane::Vec2;
use crate::structure::groups::Unknown;
use dwell_numerics::Scalar;

/// By group, the frames whose approximate angle selects the assembly mode, each with that direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeGuess(Vec<Vec<(usize, Vec2)>>);

impl Plan {
    /// Whether variants of this mechanism can be followed by their own poses alone: one actuator that turns fully, every
    /// group a closed form, no coupling and no counted revolution.
    pub fn supports_variants(&self, mechanism: &Mechanism) -> bool {
        let mut actuators = mechanism.actuators.iter();
        self.range == Range::Full
            && self.is_dyadic()
            && self.actuators() == 1
            && actuators.all(|a| a.kind == ActuatorKind::Angle)
            && self.couplings.is_empty()
            && self.frames.redundant_pairs.is_empty()
            && !self.revolution_counted.contains(&true)
            && !self.groups.iter().any(|g| g.pruned)
            // Of two modes the one of positive length is taken before the nearer one.
            && !self.lowered.pairs.iter().any(|pair| pair.kind.is_length())
    }

    /// The directions that select the assembly mode of each group; `None` if travels do.
    pub fn mode_guess(
        &self,
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
    ) -> Option<ModeGuess> {
        let guess = InitialGuess::new(mechanism, &self.lowered, configuration);
        if guess.travels.iter().any(Option::is_some) {
            return None;
        }
        let directions = |assur: &AssurGroup| -> Vec<(usize, Vec2)> {
            let unknowns = assur.group.unknowns.iter();
            let each = unknowns.flat_map(|&unknown| {
                let frame = match unknown {
                    Unknown::ClassAngle(class) => self.class_frame(class),
                    Unknown::SlideTravel(_) => 0,
                };
                let hints = self.hints(unknown, &guess).into_iter();
                hints.map(move |angle| (frame, Vec2::from_angle(angle)))
            });
            each.collect()
        };
        Some(ModeGuess(self.groups.iter().map(directions).collect()))
    }

    /// Whether a compilation of these dimensions would select the assembly mode of this plan in every group, as
    /// [`Plan::compile`] does: the mode that is nearer to the guess, and clearly so.
    ///
    /// # Errors
    /// [`PositionError`] where a group cannot be assembled.
    pub fn keeps_assembly_modes(
        &mut self,
        guess: &ModeGuess,
        pose: &mut Pose<f64>,
    ) -> Result<bool, PositionError> {
        pose.q.copy_from_slice(&self.assembly_coordinates);
        for (g, directions) in guess.0.iter().enumerate() {
            let branch = match &self.groups[g].kind {
                GroupKind::RrrDyad(dyad) => dyad.branch,
                GroupKind::GuidedPoint(guided) => guided.branch,
                GroupKind::Factored(_) => return Ok(false),
            };
            self.positions_before(g, pose)?;
            let mut distance_with = |root_sign: f64| -> Result<f64, PositionError> {
                self.groups[g].kind.set_root_sign(root_sign);
                self.group_positions(g, pose)?;
                let squares = directions.iter().map(|&(frame, guess)| {
                    let deviation = pose.rotation[frame] - guess;
                    deviation.dot(deviation)
                });
                Ok(squares.sum::<f64>().sqrt())
            };
            let other = distance_with(-branch);
            // The plan's own mode last: the groups after it start from there.
            let own = distance_with(branch)?;
            // As at assembly, both have to be found, and to differ.
            if other? - own < SAME_MODE {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The determinant of a closed-form group, m or m², and its derivative by the coordinate, at a pose and at its motion
    /// with unit velocity. Where the determinant vanishes, two branches meet.
    #[inline(always)]
    pub fn determinant_and_slope<T: Scalar>(
        &self,
        group: usize,
        pose: &Pose<T>,
        motion: &Motion<T>,
    ) -> [T; 2] {
        let rate = |frame: usize| motion.velocity.angular[frame];
        match &self.groups[group].kind {
            GroupKind::RrrDyad(dyad) => {
                // w₁ × w₂, whose vectors turn with their frames.
                let [one, two] = dyad.vectors.map(|vector| pose.vector[vector]);
                let relative_rate = rate(dyad.frames[1]) - rate(dyad.frames[0]);
                [one.cross(two), relative_rate * one.dot(two)]
            }
            GroupKind::GuidedPoint(guided) if guided.line_rotates => {
                // The travel along the line, D × n with the line's normal n.
                let normal = pose.vector[guided.found_vector].perp();
                let mut known = guided.fixed.cast();
                let mut velocity = Vec2::zero();
                for &(vector, frame) in &guided.known {
                    known += pose.vector[vector];
                    velocity += pose.vector[vector].perp() * rate(frame);
                }
                let slope = velocity.cross(normal) + rate(guided.frame) * known.dot(normal);
                [known.cross(normal), slope]
            }
            GroupKind::GuidedPoint(guided) => {
                // −w·e with the line's direction e.
                let vector = pose.vector[guided.found_vector];
                let along = pose.vector[guided.axis.0];
                let relative_rate = rate(guided.frame) - rate(guided.axis.1);
                [-vector.dot(along), -(relative_rate * vector.cross(along))]
            }
            // Not a closed form: its margin is unknown here.
            GroupKind::Factored(_) => [T::from_f64(0.0); 2],
        }
    }

    /// Number of groups.
    pub fn group_count(&self) -> usize {
        self.groups.len()
    }
}
