//! What evaluates designs: a recorded state if all results have exact derivatives from one, otherwise the gradients of each variant.

use super::design_worker::DesignWorker;
use super::measured::Measured;
use super::recorded_designs::RecordedDesigns;
use crate::gradient::{DesignSlopes, GradientScene};
use crate::sweep::compute::RequestedQuantities;

/// The evaluation of designs.
pub(super) enum Engine<'a> {
    Recorded(Box<RecordedDesigns<'a>>),
    General(Box<dyn GeneralDesigns + 'a>),
}

/// Designs that are evaluated as variants of a scene.
pub(super) trait GeneralDesigns: Sync {
    fn evaluate(&self, values: &[f64], has_slopes: bool) -> Option<Vec<Measured>>;
}

/// The memory of one thread.
pub(super) enum Worker<'e, 'a> {
    Recorded(Box<DesignWorker<'e, 'a>>),
    General(&'e (dyn GeneralDesigns + 'a)),
}

impl<'a> Engine<'a> {
    pub(super) fn worker(&self) -> Worker<'_, 'a> {
        match self {
            Self::Recorded(of) => Worker::Recorded(Box::new(DesignWorker::new(of))),
            Self::General(of) => Worker::General(of.as_ref()),
        }
    }

    pub(super) fn is_recorded(&self) -> bool {
        matches!(self, Self::Recorded(_))
    }
}

impl Worker<'_, '_> {
    /// The values of the results of a design to a few digits; `None` if one of them has none.
    pub(super) fn evaluate_roughly(&mut self, values: &[f64]) -> Option<Vec<Measured>> {
        let found = match self {
            Self::Recorded(of) => of.evaluate_roughly(values),
            Self::General(of) => of.evaluate(values, false),
        };
        found.filter(|all| all.iter().all(|of| of.value.is_finite()))
    }

    /// The results of a design; `None` if one of them has no value.
    pub(super) fn evaluate(&mut self, values: &[f64], has_slopes: bool) -> Option<Vec<Measured>> {
        let found = match self {
            Self::Recorded(of) => of.evaluate(values, has_slopes),
            Self::General(of) => of.evaluate(values, has_slopes),
        };
        found.filter(|all| all.iter().all(|of| of.value.is_finite()))
    }
}

impl<S: GradientScene> GeneralDesigns for DesignSlopes<'_, S> {
    fn evaluate(&self, values: &[f64], has_slopes: bool) -> Option<Vec<Measured>> {
        if !has_slopes {
            return values_at(
                self.scene,
                &self.design.assigned(&self.design.numbers(values)),
                self.requested,
            );
        }
        let (gradient, slopes) = self.slopes(values).ok()?;
        let each = gradient.results.iter().zip(slopes);
        let measured = each.map(|(result, slope)| {
            let (value, is_root) = (result.value, result.name.ends_with(".rms"));
            Measured {
                square: is_root.then(|| {
                    let square = slope.iter().map(|s| 2.0 * value * s);
                    (value * value, square.collect())
                }),
                value,
                slope,
                ..Measured::default()
            }
        });
        Some(measured.collect())
    }
}

/// The results of a variant by the sweep.
pub(super) fn values_at<S: GradientScene>(
    scene: &S,
    assigned: &[(&str, f64)],
    requested: &RequestedQuantities,
) -> Option<Vec<Measured>> {
    let found = requested.evaluate(scene, assigned);
    let measured = found.values.into_iter().map(|value| Measured {
        value,
        ..Measured::default()
    });
    found.message.is_none().then(|| measured.collect())
}
