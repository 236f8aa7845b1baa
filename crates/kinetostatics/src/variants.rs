//! Variants of a model: other dimensions and mass properties in a structure that is compiled once.
//!
//! The numbers of a variant are filled into the model, and its turn is evaluated several poses side by side. Whether the
//! variant is on the assembly branch of the model, and whether its actuator turns fully on it, is checked on its own
//! poses; what these checks cannot decide has no turn here, and is to be compiled.

mod search;
mod turn;

pub use search::{Extremum, Turn};

use crate::mass::Mass;
use crate::model::Model;
use crate::reduced::in_lanes;
use dwell_geometry::{Mechanism, ModeGuess, vec2};
use turn::Turns;

/// Numbers of the mass properties of a body: mass, centre (x, y) and moment of inertia.
const PER_BODY: usize = 4;

/// A model of one structure, for many variants of its numbers.
#[derive(Debug, Clone)]
pub struct VariantModel {
    model: Model,
    guess: ModeGuess,
}

impl VariantModel {
    /// The variants of a model that was compiled for numbers that do not coincide by chance: whatever vector or first
    /// moment is zero in it has to be zero in all. None where they need a compilation each: loads, varying inertias,
    /// couplings, groups without a closed form, an actuator that does not turn fully, approximate travels.
    pub fn new(model: Model) -> Option<Self> {
        let supported = model.plan().supports_variants(model.mechanism())
            && model.loads().is_empty()
            && model.pass_model.varying_inertias.is_empty();
        let guess = supported.then(|| model.plan().mode_guess(model.mechanism(), model.assembly()));
        Some(Self {
            guess: guess.flatten()?,
            model,
        })
    }

    /// The numbers of a mechanism with these masses, in SI: its dimensions, then mass, centre and moment of inertia of
    /// each body. None where it has another structure.
    pub fn numbers(&self, mechanism: &Mechanism, masses: &[Mass]) -> Option<Vec<f64>> {
        let mut numbers = self.model.plan().dimensions(mechanism)?;
        numbers.extend((masses.iter()).flat_map(|m| [m.mass, m.center.x, m.center.y, m.inertia]));
        Some(numbers)
    }

    /// Evaluates the turns of some variants in one thread. `fill` writes the numbers of a variant, as [`numbers`](Self::numbers)
    /// gives them, and returns the coordinate (rad) at which m is wanted besides; `done` takes the turn, or none where the
    /// variant has to be compiled.
    pub fn turns(
        &self,
        variants: std::ops::Range<usize>,
        fill: &mut dyn FnMut(usize, &mut [f64]) -> f64,
        done: &mut dyn FnMut(usize, Option<&Turn>),
    ) {
        in_lanes(
            &self.model,
            Turns {
                of: self,
                variants,
                fill,
                done,
            },
        );
    }
}

impl Model {
    /// Takes the numbers of a variant; false where they do not fit the structure or are no mass properties.
    fn set_numbers(&mut self, numbers: &[f64]) -> bool {
        let at = numbers.len() - PER_BODY * self.masses.len();
        let (dimensions, masses) = numbers.split_at(at);
        self.pass_model.plan.set_dimensions(dimensions);
        for (mass, of) in self.masses.iter_mut().zip(masses.chunks_exact(PER_BODY)) {
            *mass = Mass {
                mass: of[0],
                center: vec2(of[1], of[2]),
                inertia: of[3],
            };
        }
        let not_negative = |value: f64| value >= 0.0 && value.is_finite();
        let mut masses = self.masses.iter();
        masses.all(|m| not_negative(m.mass) && not_negative(m.inertia) && m.center.is_finite())
            && self.pass_model.set_masses(&self.masses)
            && self
                .pass_model
                .reaction_sources
                .replace_points(&self.pass_model.plan)
    }
}
