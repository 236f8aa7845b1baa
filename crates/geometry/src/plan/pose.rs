//! Where everything is at given coordinates.

use crate::plan::{FactoredGroup, GroupKind, Plan};
use crate::plane::Vec2;
use dwell_numerics::{Constant, Lift, Scalar};

/// The result of the computation of positions: the orientation of every frame and every rotated vector.
#[derive(Debug, Clone, PartialEq)]
pub struct Pose<T> {
    /// The actuators' coordinates, rad or m.
    pub q: Vec<T>,
    /// By frame: (cos, sin).
    pub rotation: Vec<Vec2<T>>,
    /// By frame: its angle with whole revolutions counted, rad; only where a coupling or a load needs it.
    pub angle: Vec<T>,
    /// By vector: its components in ground axes, m.
    pub vector: Vec<Vec2<T>>,
    /// By slide of the tree: its travel, m.
    pub slide_travel: Vec<T>,
    /// By closure: along a prismatic loop joint's axis, the travel P₂ − P₁, m.
    pub closure_travel: Vec<T>,
    /// By closed-form group: one over the determinant of its Jacobian.
    pub(crate) inverse_determinant: Vec<T>,
    pub(crate) lu: Vec<T>,
    pub(crate) pivots: Vec<usize>,
    pub(crate) workspace: Vec<T>,
    pub(crate) path_coordinates: Vec<T>,
}

impl<T: Scalar> Pose<T> {
    /// The coordinate of the first actuator, rad or m; 0 of a structure, which has none.
    pub(crate) fn first_coordinate(&self) -> f64 {
        self.q.first().map_or(0.0, |q| q.value())
    }

    /// Takes the unknowns of another pose, from which Newton's method can start.
    pub(crate) fn start_from(&mut self, other: &Pose<f64>) {
        for (value, rotation) in self.rotation.iter_mut().zip(&other.rotation) {
            *value = rotation.cast();
        }
        let angles = self.angle.iter_mut().zip(&other.angle);
        let travels = self.slide_travel.iter_mut().zip(&other.slide_travel);
        for (value, &other) in angles.chain(travels) {
            *value = T::from_f64(other);
        }
    }
}

impl<C: Constant> Plan<C> {
    /// A pose with the right sizes, to be filled by [`Plan::positions`].
    pub fn pose<T: Lift<C>>(&self) -> Pose<T> {
        let factored_group = || {
            self.groups.iter().filter_map(|g| match &g.kind {
                GroupKind::Factored(factored_group) => Some(factored_group),
                _ => None,
            })
        };
        let zero = T::from_f64(0.0);
        Pose {
            q: vec![zero; self.actuators()],
            rotation: vec![Vec2::IDENTITY.cast(); self.frames.frames.len()],
            angle: vec![zero; self.frames.frames.len()],
            vector: self.frame_vectors.iter().map(|a| a.local.cast()).collect(),
            slide_travel: vec![zero; self.tree.slide_pairs.len()],
            closure_travel: vec![zero; self.loop_closures.len()],
            inverse_determinant: vec![zero; self.groups.len()],
            lu: vec![zero; factored_group().map(FactoredGroup::factor_len).sum()],
            pivots: vec![0; factored_group().map(|s| s.columns).sum()],
            workspace: vec![zero; factored_group().map(|s| s.rows).max().unwrap_or(0)],
            path_coordinates: vec![zero; self.actuators()],
        }
    }
}
