//! How loads travel to the ground: beside the inertia forces, in stages of their own, so that an
//! evaluation without loads does not meet them.

use crate::acts::LoadState;
use crate::model::Model;
use crate::runs::{Rates, Runs};
use dwell_geometry::{Pose, Scalar};

impl<T: Scalar> Runs<T, 1> {
    /// As [`Runs::evaluate`], with the loads' forces and moments on every body.
    #[inline(never)]
    pub(crate) fn evaluate_loaded(
        &mut self,
        model: &Model,
        pose: &Pose<T>,
        rates: impl Rates<T, 1>,
        loads: &mut LoadState<T>,
    ) {
        self.accelerate(model, pose, rates);
        if model.sources.tree_forces {
            self.note(model, pose, rates);
        }
        self.collect(model, pose);
        self.bear(model, pose, loads);
        model.plan.multipliers(pose, &mut self.balance);
        if model.sources.tree_forces {
            self.hold(model, pose);
        }
        if model.sources.moments {
            self.twist(model, pose, rates);
            for (couple, &moment) in self.couple.iter_mut().zip(&loads.moment) {
                couple[0] -= moment;
            }
            self.along_holds(model);
        }
    }

    /// Takes the loads off what the mechanism must balance, from the outermost body inwards:
    /// moments off the frames, forces off the slides, and (where asked for) each body's own off what
    /// its joint must exert on it. All bodies bear, the massless ones and those at rest too.
    #[inline(never)]
    fn bear(&mut self, model: &Model, pose: &Pose<T>, loads: &mut LoadState<T>) {
        let carried = model.plan.carried();
        for (i, body) in carried.iter().enumerate() {
            let force = loads.force[body.body];
            loads.borne[i] = force;
            self.balance.moment[body.frame][0] -= loads.moment[body.body];
            if model.sources.tree_forces {
                self.held[i][0] -= force;
            }
        }
        for (i, body) in carried.iter().enumerate().rev() {
            let force = loads.borne[i];
            if let Some(parent) = body.parent {
                loads.borne[parent] += force;
            }
            if let Some(arm) = body.arm {
                self.balance.moment[body.parent_frame][0] -= pose.arm[arm].cross(force);
            }
            if let Some((slide, direction)) = body.slide {
                let along = pose.arm[direction];
                self.balance.push[slide][0] -= along.dot(force);
                let reach = along * pose.slide[slide];
                self.balance.moment[body.frame][0] -= reach.cross(force);
            }
        }
    }
}
