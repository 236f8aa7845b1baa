//! The numbers of a machine as functions of those of its scene.

use crate::machines::{CoordinateOf, MachineScene};
use crate::models::compile_model;
use crate::sweep::compute::SweptScene;
use crate::trajectory::compute::{Dyad, Quantity, dyads};
use dwell_geometry::{Component, JointId, Vec2, space};
use dwell_kinetostatics::space::{Axes, Component as InSpace};
use dwell_kinetostatics::{
    Described, Load, Magnitude, Model, ModelLoad, RecordableModel, WantedMotion,
};
use dwell_scene::{Dimensions, PlaneScene, SceneIn, SceneLocation, SpaceScene};

/// What is wanted of the states of a scene's machine.
pub(super) type WantedOf<S> =
    WantedMotion<CoordinateOf<S>, <<S as MachineScene>::Model as RecordableModel>::Point>;

/// A scene in the plane or in space whose results have gradients.
pub trait GradientScene: SweptScene<Model: RecordableModel> {
    /// Its machine.
    fn described<'a>(
        &'a self,
        wanted: &'a WantedMotion<CoordinateOf<Self>, <Self::Model as RecordableModel>::Point>,
    ) -> Described<'a, Self::Model>;

    /// A model of the same machine, with the reactions of a model, that has a place for numbers which are zero in the scene: of a
    /// structure where they are not, if it has one.
    fn with_all_places(&self, model: &Self::Model) -> Self::Model;

    /// A point of a body, m in its frame.
    fn point(at: [f64; 3]) -> <Self::Model as RecordableModel>::Point;

    /// Whether another scene differs in numbers of its machine alone: in dimensions, masses, and constant numbers of loads.
    fn differs_in_numbers_only(&self, other: &Self, model: &Self::Model) -> bool;

    /// Whether a model has redundant constraints or rods that turn idly, which may not allow other numbers.
    fn may_refuse_numbers(model: &Self::Model) -> bool;

    /// The reactions that are the components of the force of a joint, or of its moment; `None` if some are not among those of the model.
    fn components(model: &Self::Model, joint: JointId, is_moment: bool) -> Option<Vec<Quantity>>;

    /// The dyads that have a transmission angle, of a model of the structure of this scene.
    fn dyads(&self, _: &Self::Model) -> Vec<Dyad> {
        Vec::new()
    }

    /// The loads.
    fn loads(&self) -> &[ModelLoad<Self::Model>];
}

/// The numbers of a machine in the order of a recording: those of its description, then by load its constant magnitude, or zero.
pub(super) fn machine_numbers<S: GradientScene>(
    scene: &S,
    model: &S::Model,
    wanted: &WantedOf<S>,
) -> Option<Vec<f64>> {
    let mut numbers = model.numbers(scene.described(wanted))?;
    numbers.extend(scene.loads().iter().map(|load| match load.magnitude {
        Magnitude::Constant(value) => value,
        _ => 0.0,
    }));
    Some(numbers)
}

/// Whether two scenes of a kind differ in the numbers of their machines alone.
fn differ_in_numbers_only<D: Dimensions>(one: &SceneIn<D>, other: &SceneIn<D>) -> bool {
    type LoadOf<D> = Load<<D as Dimensions>::LoadKind, <D as Dimensions>::Coordinate>;
    let same_law = |(a, b): (&LoadOf<D>, &LoadOf<D>)| {
        let constant = |load: &LoadOf<D>| matches!(load.magnitude, Magnitude::Constant(_));
        constant(a) && constant(b) || a.magnitude == b.magnitude
    };
    one.prescribed == other.prescribed
        && one.sweep == other.sweep
        && one.drives == other.drives
        && one.motion == other.motion
        && one.stops == other.stops
        && one.varying_inertias == other.varying_inertias
        && one.loads.len() == other.loads.len()
        && one.loads.iter().zip(&other.loads).all(same_law)
}

/// Parts of the size of a mechanism, and kg or kg m², by which a number that is zero is displaced to find its place.
const DISPLACED: f64 = 1e-3;
/// Multiples of the golden ratio keep displacements apart.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl GradientScene for PlaneScene {
    fn described<'a>(
        &'a self,
        wanted: &'a WantedMotion<dwell_geometry::Coordinate, Vec2>,
    ) -> Described<'a, Model> {
        Described {
            mechanism: &self.mechanism,
            masses: &self.masses,
            loads: &self.loads,
            wanted,
        }
    }

    fn with_all_places(&self, model: &Model) -> Model {
        let is_zero = |path: &String| self.value(path).is_ok_and(|value| value == 0.0);
        let zeros: Vec<String> = self.number_paths().into_iter().filter(is_zero).collect();
        let is_of_mass = |path: &&String| {
            use SceneLocation::{Center, Inertia, Mass};
            matches!(self.location_of(path), Mass(_) | Inertia(_) | Center(_))
        };
        let of_masses: Vec<&String> = zeros.iter().filter(is_of_mass).collect();
        // Redundant constraints may not allow other points.
        let mut attempts = [zeros.iter().collect(), of_masses].into_iter();
        let found = attempts.find_map(|paths: Vec<&String>| self.typical(model, &paths));
        found.unwrap_or_else(|| model.clone())
    }

    fn point([x, y, _]: [f64; 3]) -> Vec2 {
        Vec2 { x, y }
    }

    fn differs_in_numbers_only(&self, other: &Self, _: &Model) -> bool {
        differ_in_numbers_only(self, other)
    }

    fn may_refuse_numbers(model: &Model) -> bool {
        let mut reactions = 0..model.mechanism().reactions().len();
        !reactions.all(|k| model.plan().is_determinate(k))
    }

    fn components(model: &Model, joint: JointId, is_moment: bool) -> Option<Vec<Quantity>> {
        use Component::{Axial, Moment, Normal, X, Y};
        let all = model.mechanism().components(joint);
        let is_wanted = |c: &Component| match is_moment {
            true => *c == Moment,
            false => matches!(c, X | Y | Normal | Axial),
        };
        // A tooth or a rolling wheel has forces in other directions.
        if !is_moment && !all.iter().all(|c| is_wanted(c) || *c == Moment) {
            return None;
        }
        let place = |component: &Component| {
            let mut all = model.reactions().iter();
            all.position(|r| r.joint == joint && r.component == *component)
        };
        let places = all.iter().filter(|c| is_wanted(c)).map(place);
        places.map(|k| k.map(Quantity::Reaction)).collect()
    }

    fn dyads(&self, model: &Model) -> Vec<Dyad> {
        let all = dyads(&self.mechanism, model.plan()).into_iter();
        all.map(|(_, dyad)| dyad).collect()
    }

    fn loads(&self) -> &[ModelLoad<Model>] {
        &self.loads
    }
}

/// The model at the numbers of the scene, with the structure of one where these numbers are not zero.
trait Typical: GradientScene {
    fn typical(&self, model: &Self::Model, zeros: &[&String]) -> Option<Self::Model>;
}

impl Typical for PlaneScene {
    fn typical(&self, model: &Model, zeros: &[&String]) -> Option<Model> {
        let (length, _) = self.to_scene_unit(self.mechanism.size(), false);
        let displaced = |(k, path): (usize, &&String)| {
            let size = match self.location_of(path) {
                SceneLocation::Mass(_) | SceneLocation::Inertia(_) => 1.0,
                _ => length,
            };
            let part = ((k + 1) as f64 * GOLDEN).fract() + 0.5;
            (path.as_str().to_owned(), DISPLACED * size * part)
        };
        let values: Vec<(String, f64)> = zeros.iter().enumerate().map(displaced).collect();
        let values: Vec<(&str, f64)> = values.iter().map(|(p, v)| (p.as_str(), *v)).collect();
        let typical = self.with_values(&values).ok()?;
        let found = compile_model(&typical, model.reactions()).ok()?;
        found.at_numbers(self.described(&WantedMotion::default()))
    }
}

impl GradientScene for SpaceScene {
    fn described<'a>(
        &'a self,
        wanted: &'a WantedMotion<space::Coordinate, space::Vec3>,
    ) -> Described<'a, dwell_kinetostatics::space::Model> {
        Described {
            mechanism: &self.mechanism,
            masses: &self.masses,
            loads: &self.loads,
            wanted,
        }
    }

    fn with_all_places(
        &self,
        model: &dwell_kinetostatics::space::Model,
    ) -> dwell_kinetostatics::space::Model {
        model.clone()
    }

    fn point([x, y, z]: [f64; 3]) -> space::Vec3 {
        space::Vec3 { x, y, z }
    }

    fn differs_in_numbers_only(
        &self,
        other: &Self,
        model: &dwell_kinetostatics::space::Model,
    ) -> bool {
        let joints = self.mechanism.joints.iter().zip(&other.mechanism.joints);
        let mut sides = joints.flat_map(|(a, b)| a.sides.iter().zip(&b.sides));
        let turned = sides.any(|(a, b)| (a.axis, a.normal) != (b.axis, b.normal));
        // A loop in a plane has another structure where an axis leaves it.
        differ_in_numbers_only(self, other) && !(turned && model.plan().keeps_to_planes())
    }

    fn may_refuse_numbers(model: &dwell_kinetostatics::space::Model) -> bool {
        let mobility = model.plan().mobility();
        mobility.redundant_count > 0 || !mobility.idle.is_empty()
    }

    fn components(
        model: &dwell_kinetostatics::space::Model,
        joint: JointId,
        is_moment: bool,
    ) -> Option<Vec<Quantity>> {
        let wanted = |k: usize| match is_moment {
            true => InSpace::Moment(Axes::Ground, k),
            false => InSpace::Force(Axes::Ground, k),
        };
        let place = |k: usize| {
            let mut all = model.reactions();
            all.position(|r| r.joint == joint && r.component == wanted(k))
        };
        (0..3).map(|k| place(k).map(Quantity::Reaction)).collect()
    }

    fn loads(&self) -> &[ModelLoad<dwell_kinetostatics::space::Model>] {
        &self.loads
    }
}
