//! Variants of a scene that share one structure: it is compiled once, and the numbers of each variant are filled in.
//!
//! Points, centres, masses, moments of inertia, the numbers of loads and the start of the motion are affine functions of the varied numbers
//! as long as no direction varies. The function is determined from differences of variants that are read as scenes, and verified with
//! another variant. The structure is that of a variant whose numbers coincide by identity only, not by chance.

use crate::models::{compile_model, initial_reduced_state};
use crate::sweep::compute::family_forces::FamilyForces;
use crate::sweep::compute::point::{RequestedQuantities, ResultKind, SweepQuantity};
use crate::sweep::compute::{Axis, Design};
use dwell_geometry::Reaction;
use dwell_kinetostatics::variants::{Extremum, Turn, TurningVariant, VariantModel};
use dwell_scene::PlaneScene;
use std::cell::Cell;

/// Displacements in the range of an axis: of the typical variant, to find slopes, and to verify them. Multiples of the
/// golden ratio by the axis keep the places of several axes apart.
const PLACES: [f64; 3] = [0.0, 0.29, -0.23];
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Positions of typical variants, as fractions of the way from the scene's own numbers; farther away they may not
/// rotate.
const PARTS: [f64; 5] = [1.0, 1.0, 0.3, 0.1, 0.03];
/// Rounding of an affine function, in roundings of its largest terms.
const ROUNDINGS: f64 = 32.0;
/// Numbers of the start of the motion: coordinate and velocity.
const OF_START: usize = 2;

/// The variants of a sweep that share one structure.
#[derive(Debug)]
pub struct VariantFamily {
    model: VariantModel,
    numbers: AffineNumbers,
    /// The reactions of the free rotation, by their index among those of the mechanism.
    reactions: Vec<usize>,
    /// The forces along the scene's trajectory, if they are requested.
    forces: Option<FamilyForces>,
}

/// Numbers that are affine functions of the varied ones.
#[derive(Debug)]
pub(crate) struct AffineNumbers {
    /// The varied numbers at which the others are `constant`.
    reference: Vec<f64>,
    constant: Vec<f64>,
    /// By axis: which numbers change, and how fast.
    pub(crate) slopes: Vec<Vec<(usize, f64)>>,
}

impl AffineNumbers {
    /// The affine function through the values at the reference and at displacements of each varied number; `None` if its
    /// value `elsewhere` is wrong.
    pub(crate) fn find(
        reference: Vec<f64>,
        displaced: &[f64],
        elsewhere: &[f64],
        numbers_at: &dyn Fn(&[f64]) -> Option<Vec<f64>>,
    ) -> Option<Self> {
        let constant = numbers_at(&reference)?;
        let mut slopes = Vec::with_capacity(displaced.len());
        for (k, &value) in displaced.iter().enumerate() {
            let mut values = reference.clone();
            values[k] = value;
            let change = value - reference[k];
            let numbers = numbers_at(&values)?;
            let each = constant.iter().zip(numbers).enumerate();
            let changed = each.filter(|(_, (before, after))| *before != after);
            slopes.push(
                changed
                    .map(|(i, (before, after))| (i, (after - before) / change))
                    .collect(),
            );
        }
        let numbers = Self {
            reference,
            constant,
            slopes,
        };
        let expected = numbers_at(elsewhere)?;
        numbers.agree(elsewhere, &expected).then_some(numbers)
    }

    /// Writes the numbers at some values of the varied ones.
    pub(crate) fn fill(&self, values: &[f64], numbers: &mut [f64]) {
        numbers.copy_from_slice(&self.constant);
        for ((value, reference), slopes) in values.iter().zip(&self.reference).zip(&self.slopes) {
            let change = value - reference;
            for &(number, slope) in slopes {
                numbers[number] += slope * change;
            }
        }
    }

    /// Whether these are the numbers at some values, to rounding.
    fn agree(&self, values: &[f64], expected: &[f64]) -> bool {
        let mut numbers = self.constant.clone();
        self.fill(values, &mut numbers);
        let mut sizes: Vec<f64> = self.constant.iter().map(|v| v.abs()).collect();
        for ((value, reference), slopes) in values.iter().zip(&self.reference).zip(&self.slopes) {
            for &(number, slope) in slopes {
                sizes[number] += (slope * (value - reference)).abs();
            }
        }
        let mut each = numbers.iter().zip(expected).zip(sizes);
        each.all(|((found, expected), size)| {
            (found - expected).abs() <= ROUNDINGS * f64::EPSILON * size
        })
    }
}

/// A place in the range of an axis and of the scene's own number, by the number of the axis and of the attempt.
fn place(axis: &Axis, nominal: f64, number: usize, attempt: usize, displacement: f64) -> f64 {
    let [from, to] = axis.span();
    let (from, to) = (from.min(nominal), to.max(nominal));
    let typical = ((number + 1) as f64 * GOLDEN + attempt as f64 * GOLDEN * GOLDEN).fract();
    // Within the middle half, and displaced within the whole.
    let wide = from + (0.25 + 0.5 * typical + displacement) * (to - from);
    nominal + PARTS[attempt] * (wide - nominal)
}

/// A variant as a scene is read.
fn scene_at(scene: &PlaneScene, design: &Design, values: &[f64]) -> Option<PlaneScene> {
    scene.with_values(&design.assigned(values)).ok()
}

/// Whether two variants differ in numbers of the mechanism, of the masses and of the start alone, and, if the model
/// [has](VariantModel::numbers) loads, in the numbers of their loads.
fn differ_in_numbers_only(one: &PlaneScene, other: &PlaneScene, has_loads: bool) -> bool {
    one.assembly == other.assembly
        && one.varying_inertias == other.varying_inertias
        && (has_loads || one.loads == other.loads)
        && one.drives == other.drives
        && one.prescribed == other.prescribed
        && one.sweep == other.sweep
        && one.requests.reactions == other.requests.reactions
        && one.motion.is_some() == other.motion.is_some()
}

impl VariantFamily {
    /// The family of a sweep; `None` if its variants need a compilation each: for motions, cycles and periods under
    /// loads, under friction, or where a varied number is a direction, say.
    pub(crate) fn new(
        scene: &PlaneScene,
        design: &Design,
        requested: &RequestedQuantities,
    ) -> Option<Self> {
        let is_known = |q: &SweepQuantity| match q.kind {
            ResultKind::Inertia
            | ResultKind::InertiaPlace
            | ResultKind::Range
            | ResultKind::Reaction(_)
            | ResultKind::ActuatorForce(_) => true,
            ResultKind::Orbit | ResultKind::FreeReaction | ResultKind::FreeReactionPlace => {
                scene.loads.is_empty()
            }
            ResultKind::Motion | ResultKind::Cycle | ResultKind::Along(_) => false,
        };
        if !requested.quantities.iter().all(is_known) {
            return None;
        }
        (0..PARTS.len()).find_map(|attempt| Self::about(scene, design, requested, attempt))
    }

    /// The family whose structure is that of a typical variant.
    fn about(
        scene: &PlaneScene,
        design: &Design,
        requested: &RequestedQuantities,
        attempt: usize,
    ) -> Option<Self> {
        let at = |number: usize, axis: &Axis, which: usize| {
            let nominal = scene.value(&axis.path).unwrap_or_default();
            place(axis, nominal, number, attempt, PLACES[which])
        };
        let all_at = |which: usize| -> Vec<f64> {
            let axes = design.axes.iter().enumerate();
            let values: Vec<f64> = axes.map(|(k, axis)| at(k, axis, which)).collect();
            design.numbers(&values)
        };
        let reference = all_at(0);
        let typical = scene_at(scene, design, &reference)?;
        let all = typical.mechanism.reactions();
        let wanted = |reactions: &[usize]| -> Vec<Reaction> {
            let each = reactions.iter().filter_map(|&k| all.get(k).copied());
            each.collect()
        };
        let free_kinds = [ResultKind::FreeReaction, ResultKind::FreeReactionPlace];
        let reactions = requested.indices(&free_kinds);
        let model = VariantModel::new(compile_model(&typical, &wanted(&reactions)).ok()?)?;
        let (mut model, mut forces) = (model, None);
        if requested.along().next().is_some() {
            let of_family = FamilyForces::new(&typical, requested)?;
            model = of_family.add_to(&model, &wanted(&of_family.reactions))?;
            forces = Some(of_family);
        }
        let numbers_at = |values: &[f64]| -> Option<Vec<f64>> {
            let variant = scene_at(scene, design, values)?;
            if !differ_in_numbers_only(&typical, &variant, forces.is_some()) {
                return None;
            }
            let mut numbers = model.numbers(&variant.mechanism, &variant.masses, &variant.loads)?;
            let start = initial_reduced_state(&variant);
            numbers.extend(start.map_or([0.0; OF_START], |start| [start.q, start.q_dot]));
            Some(numbers)
        };
        let (displaced, elsewhere) = (all_at(1), all_at(2));
        let numbers = AffineNumbers::find(reference, &displaced, &elsewhere, &numbers_at)?;
        Some(Self {
            model,
            numbers,
            reactions,
            forces,
        })
    }

    /// Evaluates variants with these inputs. `done` takes the values of the quantities, or `None` if the variant must
    /// be compiled, for example because it does not rotate.
    pub(crate) fn evaluate(
        &self,
        inputs: &[Vec<f64>],
        quantities: &[SweepQuantity],
        done: &mut dyn FnMut(usize, Option<Vec<f64>>),
    ) {
        let mut numbers = self.numbers.constant.clone();
        let start_velocity = Cell::new(0.0);
        let mut fill = |k: usize, to: &mut [f64]| {
            self.numbers.fill(&inputs[k], &mut numbers);
            let (of_model, start) = numbers.split_at(to.len());
            to.copy_from_slice(of_model);
            start_velocity.set(start[1]);
            start[0]
        };
        let mut take = |k: usize, variant: Option<TurningVariant<'_>>| {
            let velocity = start_velocity.get();
            let values = variant.and_then(|variant| {
                let forces = match &self.forces {
                    Some(forces) => forces.values(variant)?,
                    None => Vec::new(),
                };
                Some(self.values(variant.turn, &forces, velocity, quantities))
            });
            // Of a start from rest the old way knows what to say.
            let finite = |values: &Vec<f64>| {
                let mut each = quantities.iter().zip(values);
                each.all(|(q, value)| q.kind == ResultKind::Range || value.is_finite())
            };
            done(k, values.filter(finite));
        };
        self.model.turns(0..inputs.len(), &mut fill, &mut take);
    }

    /// The values of the quantities, for a start with this velocity, rad/s; those along the trajectory are known.
    fn values(
        &self,
        turn: &Turn,
        along: &[f64],
        velocity: f64,
        quantities: &[SweepQuantity],
    ) -> Vec<f64> {
        let energy = 0.5 * turn.m_at_start * velocity * velocity;
        let period = std::f64::consts::TAU * turn.mean_root_m / (2.0 * energy).sqrt();
        let inertia = |index: usize| match index {
            0 | 1 => turn.m[index],
            _ => turn.half_dm[index - 2],
        };
        let free = |index: usize| -> Option<Extremum> {
            let k = self.reactions.binary_search(&index).ok()?;
            turn.free_reactions.get(k).copied()
        };
        let mut along = along.iter().copied();
        let mut value = |quantity: &SweepQuantity| match quantity.kind {
            ResultKind::Reaction(_) | ResultKind::ActuatorForce(_) => {
                along.next().unwrap_or(f64::NAN)
            }
            ResultKind::Inertia => inertia(quantity.index).value,
            ResultKind::InertiaPlace => inertia(quantity.index).q,
            ResultKind::Orbit => [period, energy][quantity.index],
            ResultKind::FreeReaction => {
                free(quantity.index).map_or(f64::NAN, |r| 2.0 * energy * r.value.abs())
            }
            ResultKind::FreeReactionPlace => free(quantity.index).map_or(f64::NAN, |r| r.q),
            // A full rotation has no ends.
            _ => f64::NAN,
        };
        quantities.iter().map(&mut value).collect()
    }
}
