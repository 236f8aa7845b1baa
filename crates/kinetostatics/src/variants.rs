//! Variants of a model: other dimensions and mass properties in a structure that is compiled once.
//!
//! The numbers of a variant are filled into the model, and its turn is evaluated several poses side by side. Whether the
//! variant is on the assembly branch of the model, and whether its actuator turns fully on it, is checked on its own
//! poses; if these checks cannot decide, the variant has no turn here, and the caller must compile it.

mod loads;
mod search;
mod turn;

pub use search::{Extremum, Turn};

use crate::load::Load;
use crate::mass::Mass;
use crate::model::{MachineModel as _, Model};
use crate::pass::PassModel;
use crate::reduced::in_lanes;
use dwell_geometry::{Mechanism, ModeGuess, Reaction, vec2};
use dwell_numerics::Constant;
use turn::Turns;

/// Numbers of the mass properties of a body: mass, centre (x, y) and moment of inertia.
pub(crate) const PER_BODY: usize = 4;

/// A model of one structure, for many variants of its numbers.
#[derive(Debug, Clone)]
pub struct VariantModel {
    model: Model,
    guess: ModeGuess,
    loaded: Option<LoadedModel>,
    /// Whether the means of curves, and both ends of forces under loads, are wanted.
    has_means: bool,
}

/// The model under loads.
#[derive(Debug, Clone)]
struct LoadedModel {
    model: Model,
    /// The constant velocity at which the forces over the turn are wanted, rad/s; `None` if they are not.
    velocity: Option<f64>,
}

/// A variant that is on the assembly branch of its model and turns fully.
#[derive(Debug, Clone, Copy)]
pub struct TurningVariant<'a> {
    /// The results over its turn.
    pub turn: &'a Turn,
    /// The model under loads with the numbers of this variant, if the variants have loads.
    pub loaded: Option<&'a Model>,
}

impl VariantModel {
    /// The variants of a model that was compiled for numbers that do not coincide by chance: whatever vector or first
    /// moment is zero in it has to be zero in all. `None` if they need a compilation each: loads, varying inertias,
    /// couplings, groups without a closed form, an actuator that does not turn fully, approximate travels.
    pub fn new(model: Model) -> Option<Self> {
        let supported = model.plan().supports_variants(model.mechanism())
            && model.loads().is_empty()
            && model.pass_model.varying_inertias.is_empty();
        let guess = supported.then(|| model.plan().mode_guess(model.mechanism(), model.assembly()));
        Some(Self {
            guess: guess.flatten()?,
            model,
            loaded: None,
            has_means: false,
        })
    }

    /// These variants with forces under loads: the actuator force and these reactions over a turn at a constant `velocity`
    /// (rad/s, zero for statics) become a part of [`Turn`]; without one the variants' [loaded models](TurningVariant::loaded)
    /// alone are filled in. `None` if each variant must be compiled, as for friction, teeth with a pressure angle, drives,
    /// loads that count the revolutions of an angle; and over the turn, magnitudes that are not constant.
    #[must_use]
    pub fn with_loads(
        mut self,
        loads: Vec<Load>,
        reactions: &[Reaction],
        velocity: Option<f64>,
    ) -> Option<Self> {
        if !loads.iter().all(loads::is_supported) {
            return None;
        }
        let model = self.model.clone().with_reactions(reactions).ok()?;
        let model = model.with_loads(loads).ok()?;
        let supported = model.plan().supports_variants(model.mechanism())
            && model.frictions().len() == 0
            && (velocity.is_none() || model.loads.are_constant());
        self.loaded = supported.then_some(LoadedModel { model, velocity });
        self.loaded.is_some().then_some(self)
    }

    /// These variants with the means of ½m′ and of the forces under loads, and both ends of these.
    #[must_use]
    pub fn with_means(mut self) -> Self {
        self.has_means = true;
        self
    }

    /// Whether [`Turn`] has forces under loads.
    pub fn has_loaded_turn(&self) -> bool {
        let loaded = self.loaded.as_ref();
        loaded.is_some_and(|loaded| loaded.velocity.is_some())
    }

    /// The numbers of a mechanism with these masses and loads, in SI: its dimensions, then mass, centre and moment of
    /// inertia of each body, then those of the loads, if the variants have any. `None` if it has another structure.
    pub fn numbers(
        &self,
        mechanism: &Mechanism,
        masses: &[Mass],
        loads: &[Load],
    ) -> Option<Vec<f64>> {
        let mut numbers = self.model.plan().dimensions(mechanism)?;
        numbers.extend((masses.iter()).flat_map(|m| [m.mass, m.center.x, m.center.y, m.inertia]));
        if let Some(loaded) = &self.loaded {
            numbers.extend(loaded.model.loads.numbers_of(mechanism, loads)?);
        }
        Some(numbers)
    }

    /// How many numbers there are of the mechanism and the masses.
    fn inertial_numbers(&self) -> usize {
        self.model.plan().dimension_count() + PER_BODY * self.model.masses().len()
    }

    /// How many numbers [`numbers`](Self::numbers) gives.
    pub fn number_count(&self) -> usize {
        let of_loads = self.loaded.as_ref();
        let of_loads = of_loads.map_or(0, |loaded| loaded.model.loads.number_count());
        self.inertial_numbers() + of_loads
    }

    /// Evaluates the turns of some variants in one thread. `fill` writes the numbers of a variant, in the order of
    /// [`numbers`](Self::numbers), and returns an additional coordinate (rad) at which m is evaluated; `done` takes the variant,
    /// or `None` if it must be compiled.
    pub fn turns(
        &self,
        variants: std::ops::Range<usize>,
        fill: &mut dyn FnMut(usize, &mut [f64]) -> f64,
        done: &mut dyn FnMut(usize, Option<TurningVariant<'_>>),
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
    /// Sets the numbers of a variant; returns false if they do not fit the structure or are not valid mass properties.
    fn set_numbers(&mut self, numbers: &[f64]) -> bool {
        let (dimensions, masses) = numbers.split_at(self.plan().dimension_count());
        for (mass, of) in self.masses.iter_mut().zip(masses.chunks_exact(PER_BODY)) {
            *mass = mass_of(of);
        }
        self.masses.iter().all(Mass::is_valid)
            && self.pass_model.set_numbers(dimensions, &self.masses)
    }
}

/// The mass properties of a body from its numbers.
pub(crate) fn mass_of<C: Constant>(numbers: &[C]) -> Mass<C> {
    Mass {
        mass: numbers[0],
        center: vec2(numbers[1], numbers[2]),
        inertia: numbers[3],
    }
}

impl<C: Constant> PassModel<C> {
    /// Sets the dimensions, in the order of [`Plan::dimensions`], and the mass properties by body; returns false if they do not
    /// fit the structure.
    ///
    /// [`Plan::dimensions`]: dwell_geometry::Plan::dimensions
    pub(crate) fn set_numbers(&mut self, dimensions: &[C], masses: &[Mass<C>]) -> bool {
        self.plan.set_dimensions(dimensions);
        self.set_masses(masses) && self.reaction_sources.replace_points(&self.plan)
    }
}
