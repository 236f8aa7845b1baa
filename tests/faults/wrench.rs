//! What a wrong inertia force does: the answer of the mechanism to forces on its bodies, which is linear.

use dwell_geometry::{BodyId, JointId, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{Actions, Load, LoadKind, Magnitude, Model};
use dwell_scene::Scene;
use dwell_verify::SubjectError;

/// A body in motion, in ground axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moving {
    pub(crate) mass: f64,
    pub(crate) inertia: f64,
    /// From its frame's origin to its centre of mass, m.
    pub(crate) arm: Vec2,
    /// Accelerations of the origin and of the centre, m/s².
    pub(crate) root: Vec2,
    pub(crate) center: Vec2,
    pub(crate) spin: f64,
    pub(crate) spin_rate: f64,
    /// Where it slides on another body: that one's angular velocity, and its speed along it, m/s.
    pub(crate) carrier: f64,
    pub(crate) slip: Vec2,
    /// Whether it is the heaviest.
    pub(crate) heaviest: bool,
}

/// A mechanism with a force and a couple on every body.
pub(crate) struct Wrenches {
    mechanism: Mechanism,
    model: Model,
    masses: Vec<dwell_kinetostatics::Mass>,
}

impl Wrenches {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mechanism = scene.mechanism.clone();
        let ground = BodyId(mechanism.ground);
        let given = || Magnitude::Given(Vec::new());
        let load = |kind| Load {
            name: String::new(),
            kind,
            magnitude: given(),
        };
        let on = |b: usize| {
            let force = |direction| LoadKind::Force {
                body: BodyId(b),
                point: scene.masses[b].center,
                direction,
                follows: false,
            };
            let couple = LoadKind::Torque {
                bodies: [ground, BodyId(b)],
            };
            [force(vec2(1.0, 0.0)), force(vec2(0.0, 1.0)), couple].map(load)
        };
        let loads = (0..mechanism.bodies.len()).flat_map(on).collect();
        let start = scene.assembly.to_start();
        let model = Model::new(&mechanism, &scene.masses, &start, &mechanism.reactions())
            .expect("a model")
            .with_loads(&mechanism, loads)
            .expect("loads");
        let mut masses = scene.masses.clone();
        masses[mechanism.ground] = dwell_kinetostatics::Mass::default();
        Self {
            masses,
            model,
            mechanism,
        }
    }

    /// What the inertia forces that are missing contribute to the actions in run 1 (q̇ = 1) and in run 2
    /// (q̈ = 1); nothing where there are none.
    pub(crate) fn answer(
        &self,
        q: f64,
        missing: impl Fn(&Moving) -> Option<(Vec2, f64)>,
    ) -> Result<Option<[Actions<f64>; 2]>, SubjectError> {
        let refused = |e: dwell_kinetostatics::KinetostaticsError| SubjectError {
            q,
            message: e.to_string(),
        };
        let mut answers = [self.model.actions(), self.model.actions()];
        for (out, [q_dot, q_ddot]) in answers.iter_mut().zip([[1.0, 0.0], [0.0, 1.0]]) {
            let mut work = self.model.workspace();
            self.model
                .enter(0.0, &[q], &[q_dot], &mut work)
                .map_err(refused)?;
            self.model.accelerate(&[q_ddot], &mut work);
            let mut magnitudes = Vec::new();
            for b in 0..self.masses.len() {
                let Some((force, couple)) = missing(&self.moving(b, work.states())) else {
                    return Ok(None);
                };
                magnitudes.extend([force.x, force.y, couple]);
            }
            for (load, magnitude) in magnitudes.into_iter().enumerate() {
                work.give(load, -magnitude);
            }
            self.model
                .statics(0.0, &[q], &mut work, out)
                .map_err(refused)?;
        }
        Ok(Some(answers))
    }

    fn moving(&self, b: usize, states: &dwell_geometry::measure::BodyStates) -> Moving {
        let (id, mass) = (BodyId(b), self.masses[b]);
        let [root, center] = [Vec2::ZERO, mass.center].map(|p| states.point(id, p));
        let heaviest = self.masses.iter().all(|m| m.mass <= mass.mass);
        let mut moving = Moving {
            mass: mass.mass,
            inertia: mass.inertia,
            arm: center.position - root.position,
            root: root.acceleration,
            center: center.acceleration,
            spin: states.body(id).spin,
            spin_rate: states.body(id).spin_rate,
            carrier: 0.0,
            slip: Vec2::ZERO,
            heaviest,
        };
        for joint in &self.mechanism.joints {
            let Some(own) = joint.bodies.iter().position(|&body| body == id) else {
                continue;
            };
            let carrier = joint.bodies[1 - own];
            let slides = matches!(joint.kind, JointKind::Prismatic { .. });
            if slides && states.body(carrier).spin != 0.0 {
                let [on, off] =
                    [own, 1 - own].map(|i| states.point(joint.bodies[i], joint.points[i]));
                let spin = states.body(carrier).spin;
                moving.carrier = spin;
                moving.slip =
                    on.velocity - off.velocity - (on.position - off.position).perp() * spin;
            }
        }
        moving
    }

    /// The travel of a slide, m.
    pub(crate) fn travel(&self, q: f64, joint: JointId) -> Result<f64, SubjectError> {
        let mut work = self.model.workspace::<f64>();
        let entered = self.model.enter(0.0, &[q], &[0.0], &mut work);
        entered.map_err(|e| SubjectError {
            q,
            message: e.to_string(),
        })?;
        let coordinate = dwell_geometry::Coordinate::Travel(joint);
        let measured = dwell_geometry::measure::Measured::find(&self.mechanism, coordinate);
        Ok(measured.map_or(0.0, |m| work.states().measure(m)[0]))
    }
}
