//! What a wrong inertia force does: the answer of the mechanism to forces on its bodies, which is linear.

use dwell_geometry::{BodyId, JointId, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{
    Direction, InverseDynamics, KinetostaticsError, Load, LoadKind, Magnitude, Model,
};
use dwell_scene::PlaneScene;
use dwell_verify::SubjectError;

/// A body in motion, in ground axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyMotion {
    pub(super) mass: f64,
    pub(super) inertia: f64,
    /// From its frame's origin to its centre of mass, m.
    pub(super) center_offset: Vec2,
    /// Accelerations of the origin and of the centre, m/s².
    pub(super) origin_acceleration: Vec2,
    pub(super) center_acceleration: Vec2,
    pub(super) angular_velocity: f64,
    pub(super) angular_acceleration: f64,
    /// Where it slides on another body: that one's angular velocity, and its speed along it, m/s.
    pub(super) carrier_angular_velocity: f64,
    pub(super) sliding_velocity: Vec2,
    /// Whether it is the heaviest.
    pub(super) heaviest: bool,
}

/// A mechanism with a force and a couple on every body.
pub(super) struct UnitWrenches {
    mechanism: Mechanism,
    model: Model,
    masses: Vec<dwell_kinetostatics::Mass>,
}

impl UnitWrenches {
    pub(super) fn new(scene: &PlaneScene) -> Self {
        let mechanism = scene.mechanism.clone();
        let ground = BodyId(mechanism.ground);
        let given = || Magnitude::External(Vec::new());
        let load = |kind| Load {
            name: String::new(),
            kind,
            magnitude: given(),
        };
        let on = |b: usize| {
            let force = |direction| LoadKind::Force {
                body: BodyId(b),
                point: scene.masses[b].center,
                direction: Direction::Ground(direction),
            };
            let couple = LoadKind::couple([ground, BodyId(b)]);
            [force(vec2(1.0, 0.0)), force(vec2(0.0, 1.0)), couple].map(load)
        };
        let loads = (0..mechanism.bodies.len()).flat_map(on).collect();
        let start = scene.assembly.to_configuration();
        let model = Model::new(&mechanism, &scene.masses, &start, &mechanism.reactions())
            .expect("a model")
            .with_loads(loads)
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
    pub(super) fn response(
        &self,
        q: f64,
        missing: impl Fn(&BodyMotion) -> Option<(Vec2, f64)>,
    ) -> Result<Option<[InverseDynamics<f64>; 2]>, SubjectError> {
        let to_subject_error = |e: KinetostaticsError| SubjectError {
            q,
            message: e.to_string(),
        };
        let mut results = [self.model.result_buffer(), self.model.result_buffer()];
        for (out, [q_dot, q_ddot]) in results.iter_mut().zip([[1.0, 0.0], [0.0, 1.0]]) {
            let mut workspace = self.model.workspace();
            let state = self.model.kinematic_state(&[q], &[q_dot], &mut workspace);
            let mut state = state.map_err(|e| to_subject_error(e.into()))?;
            let bodies = state.bodies_at(&[q_ddot]);
            let mut magnitudes = Vec::new();
            for b in 0..self.masses.len() {
                let Some((force, couple)) = missing(&self.body_motion(b, bodies)) else {
                    return Ok(None);
                };
                magnitudes.extend([force.x, force.y, couple]);
            }
            let at_rest = self.model.kinematic_state(&[q], &[0.0], &mut workspace);
            let at_rest = at_rest.map_err(KinetostaticsError::from);
            let loaded = at_rest.and_then(|state| state.apply_loads(0.0));
            let mut loaded = loaded.map_err(to_subject_error)?;
            for (load, magnitude) in magnitudes.into_iter().enumerate() {
                loaded.set_magnitude(load, -magnitude);
            }
            loaded.evaluate(&[0.0], out).map_err(to_subject_error)?;
        }
        Ok(Some(results))
    }

    fn body_motion(
        &self,
        b: usize,
        states: &dwell_geometry::body_states::BodyStates,
    ) -> BodyMotion {
        let (id, mass) = (BodyId(b), self.masses[b]);
        let [root, center] = [Vec2::ZERO, mass.center].map(|p| states.point(id, p));
        let heaviest = self.masses.iter().all(|m| m.mass <= mass.mass);
        let mut motion = BodyMotion {
            mass: mass.mass,
            inertia: mass.inertia,
            center_offset: center.position - root.position,
            origin_acceleration: root.acceleration,
            center_acceleration: center.acceleration,
            angular_velocity: states.body(id).angular_velocity,
            angular_acceleration: states.body(id).angular_acceleration,
            carrier_angular_velocity: 0.0,
            sliding_velocity: Vec2::ZERO,
            heaviest,
        };
        for joint in &self.mechanism.joints {
            let Some(side) = joint.bodies.iter().position(|&body| body == id) else {
                continue;
            };
            let carrier = joint.bodies[1 - side];
            let slides = matches!(joint.kind, JointKind::Prismatic { .. });
            if slides && states.body(carrier).angular_velocity != 0.0 {
                let [on, guide] =
                    [side, 1 - side].map(|i| states.point(joint.bodies[i], joint.points[i]));
                let angular_velocity = states.body(carrier).angular_velocity;
                motion.carrier_angular_velocity = angular_velocity;
                motion.sliding_velocity = on.velocity
                    - guide.velocity
                    - (on.position - guide.position).perp() * angular_velocity;
            }
        }
        motion
    }

    /// The travel of a slide, m.
    pub(super) fn travel(&self, q: f64, joint: JointId) -> Result<f64, SubjectError> {
        let mut workspace = self.model.workspace::<f64>();
        let state = self.model.kinematic_state(&[q], &[0.0], &mut workspace);
        let state = state.map_err(|e| SubjectError {
            q,
            message: e.to_string(),
        })?;
        let coordinate = dwell_geometry::Coordinate::Travel(joint);
        let function =
            dwell_geometry::body_states::CoordinateFunction::find(&self.mechanism, coordinate);
        Ok(function.map_or(0.0, |m| state.coordinate(m)[0]))
    }
}
