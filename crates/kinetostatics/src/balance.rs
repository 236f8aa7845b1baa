//! Two balances of a whole mechanism at one state of motion: of power, and of what it does to its frame.

use crate::acts::{Act, By};
use crate::ledger::Ledger;
use crate::model::{Actions, Model, Workspace};
use dwell_geometry::{BodyId, Vec2};

/// The power balance at one state: actuators + loads = dE_c/dt, W.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PowerBalance {
    /// Of the actuators, Σ τ q̇.
    pub actuators: f64,
    /// Of all loads.
    pub loads: f64,
    /// dE_c/dt = Σ m v·a + I ω α.
    pub kinetic: f64,
    /// Kinetic energy Σ ½ m v² + ½ I ω², J.
    pub energy: f64,
    /// Sum of the absolute terms, against which the residual is small.
    pub scale: f64,
}

impl PowerBalance {
    /// What is left: actuators + loads − dE_c/dt, W.
    pub fn residual(&self) -> f64 {
        self.actuators + self.loads - self.kinetic
    }
}

/// A force, and its moment about the ground's origin.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// N.
    pub force: Vec2,
    /// N·m.
    pub moment: f64,
}

impl Wrench {
    fn add(&mut self, force: Vec2, point: Vec2, couple: f64) {
        self.force += force;
        self.moment += point.cross(force) + couple;
    }
}

/// What the mechanism does to its frame: the shaking force and the shaking moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shaking {
    /// By momentum: the loads on the moving bodies less the rate of their momentum.
    pub by_momentum: Wrench,
    /// The same by reactions: all that joints and actuators do to the ground.
    pub by_reactions: Wrench,
    /// What loads do to the ground directly (the end of a spring that is fixed there), which is
    /// in neither of the two.
    pub loads_on_ground: Wrench,
}

impl Model {
    /// The power balance at the state that [`Model::kinetostatics`] evaluated last.
    pub fn power(&self, work: &Workspace<f64>, actions: &Actions<f64>) -> PowerBalance {
        let states = work.states();
        let mut sum = PowerBalance::default();
        for (tau, q_dot) in actions.tau.iter().zip(&work.loaded.q_dot) {
            sum.actuators += tau * q_dot;
            sum.scale += (tau * q_dot).abs();
        }
        for act in &work.loads().acts {
            let power = act.power(states);
            sum.loads += power;
            sum.scale += power.abs();
        }
        for body in &self.massive {
            let id = BodyId(body.body);
            let center = states.point(id, self.masses[id.0].center);
            let (w, a) = (states.body(id).spin, states.body(id).spin_rate);
            let [v, v_dot] = [center.velocity, center.acceleration];
            let terms = [body.mass * v.dot(v_dot), body.inertia * w * a];
            sum.energy += 0.5 * (body.mass * v.dot(v) + body.inertia * w * w);
            for term in terms {
                sum.kinetic += term;
                sum.scale += term.abs();
            }
        }
        sum
    }

    /// The power of each load at the state that [`Model::kinetostatics`] evaluated last, W, into
    /// `powers`, one for each load.
    pub fn load_powers(&self, work: &Workspace<f64>, powers: &mut [f64]) {
        powers.fill(0.0);
        for act in &work.loads().acts {
            if let By::Load(load) = act.by {
                powers[load] += act.power(work.states());
            }
        }
    }
}

impl Ledger {
    /// The shaking force and moment, both ways, from everything that [`Ledger::acts`] found.
    pub fn shaking(&self, model: &Model, work: &Workspace<f64>, acts: &[Act]) -> Shaking {
        let states = work.states();
        let mut shaking = Shaking::default();
        for act in acts {
            let wrench = match (act.body == self.ground, act.by) {
                (true, By::Load(_)) => &mut shaking.loads_on_ground,
                (true, _) => &mut shaking.by_reactions,
                (false, By::Load(_)) => &mut shaking.by_momentum,
                (false, _) => continue,
            };
            wrench.add(act.force, act.point(states), act.couple);
        }
        for body in &model.massive {
            let id = BodyId(body.body);
            let center = states.point(id, model.masses[id.0].center);
            let couple = body.inertia * states.body(id).spin_rate;
            let force = center.acceleration * body.mass;
            shaking.by_momentum.add(-force, center.position, -couple);
        }
        shaking
    }
}
