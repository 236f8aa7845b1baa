//! What a scene's model says of states of motion, under its loads: claims for the judge of states.

use crate::error::{StudyError, explain_model};
use crate::motion_error::explain_place;
use dwell_geometry::{ActuatorId, BodyId, Vec2};
use dwell_kinetostatics::{Actions, KinetostaticsError, Model, Workspace};
use dwell_scene::{Place, Scene};
use dwell_verify::{State, condition, load_acts};
use std::f64::consts::TAU;

/// Between two states no coordinate goes farther at once than this, rad, or this part of the size:
/// then no body turns by half a turn, and whole turns are counted.
const STRIDE: f64 = 0.1;

/// A state of motion that is asked about: time (s), coordinates, speeds and accelerations (rad or
/// m, per s, per s²). Without accelerations it is that of free motion: the actuators do nothing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ask {
    pub(crate) t: f64,
    pub(crate) q: Vec<f64>,
    pub(crate) q_dot: Vec<f64>,
    pub(crate) q_ddot: Option<Vec<f64>>,
}

/// A scene's model with every reaction, under its loads, walking from state to state.
#[derive(Debug)]
pub(crate) struct Claims<'a> {
    scene: &'a Scene,
    model: Model,
    work: Workspace<f64>,
    actions: Actions<f64>,
    /// By body: its angle, rad, whole turns counted on the way from the start.
    angles: Vec<f64>,
    /// Where that is, rad or m, and how far each coordinate goes at once.
    at: Vec<f64>,
    strides: Vec<f64>,
    start: Vec<[f64; 3]>,
}

/// A state of motion that was evaluated.
#[derive(Debug)]
pub(crate) struct Moment<'m> {
    pub(crate) scene: &'m Scene,
    pub(crate) work: &'m Workspace<f64>,
    pub(crate) actions: &'m Actions<f64>,
    pub(crate) angles: &'m [f64],
}

impl<'a> Claims<'a> {
    /// Compiles a scene for all reactions, and stands at the start.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together or a load does not fit.
    pub(crate) fn new(scene: &'a Scene) -> Result<Self, StudyError> {
        let start = scene.assembly.to_start();
        let mechanism = &scene.mechanism;
        let model = Model::new(mechanism, &scene.masses, &start, &mechanism.reactions())
            .map_err(|e| explain_model(scene, &e))?
            .with_loads(mechanism, scene.loads.clone())
            .map_err(|e| {
                let at = [(Place::Load(e.load), "this load".to_owned())];
                scene.error(e.what.to_owned(), None, &at)
            })?;
        let (work, actions) = (model.workspace(), model.actions());
        let points = scene.points.iter().flatten();
        let size = points.fold(0.0_f64, |m, (_, at)| m.max(at.norm()));
        let stride = |a: usize| match model.plan().is_angle(a) {
            true => STRIDE,
            false => STRIDE * if size > 0.0 { size } else { 1.0 },
        };
        let mut claims = Self {
            scene,
            work,
            actions,
            angles: Vec::new(),
            at: start.q,
            strides: (0..model.plan().actuators()).map(stride).collect(),
            start: Vec::new(),
            model,
        };
        claims.place(&claims.at.clone())?;
        claims.start = claims.frames();
        claims.angles = claims.start.iter().map(|frame| frame[2]).collect();
        Ok(claims)
    }

    pub(crate) fn model(&self) -> &Model {
        &self.model
    }

    /// The frames of all bodies as assembled.
    pub(crate) fn start(&self) -> &[[f64; 3]] {
        &self.start
    }

    /// The state's own account, for the judge.
    ///
    /// # Errors
    /// As [`Claims::go`].
    pub(crate) fn state(&mut self, ask: &Ask) -> Result<State, StudyError> {
        let q_ddot = self.go(ask)?;
        let (scene, states) = (self.scene, self.work.states());
        let mut bodies = self.frames();
        for (frame, angle) in bodies.iter_mut().zip(&self.angles) {
            frame[2] = *angle;
        }
        let of = |b: usize| (states.body(BodyId(b)), states.point(BodyId(b), Vec2::ZERO));
        let velocity: Vec<_> = (0..bodies.len())
            .map(|b| {
                let (body, origin) = of(b);
                [origin.velocity.x, origin.velocity.y, body.spin]
            })
            .collect();
        let acceleration = |b: usize| {
            let (body, origin) = of(b);
            [origin.acceleration.x, origin.acceleration.y, body.spin_rate]
        };
        let loads = scene.loads.iter().zip(&self.work.loads().magnitude);
        let ground = scene.mechanism.ground;
        let loads = loads.filter_map(|(load, &magnitude)| {
            load_acts(
                &load.kind,
                magnitude,
                ground,
                &scene.masses,
                &bodies,
                &velocity,
            )
        });
        Ok(State {
            t: ask.t,
            q: ask.q.clone(),
            q_dot: ask.q_dot.clone(),
            q_ddot,
            loads: loads.flatten().collect(),
            acceleration: (0..bodies.len()).map(acceleration).collect(),
            velocity,
            reactions: self.actions.reactions.clone(),
            tau: self.actions.tau.clone(),
            bodies,
        })
    }

    /// The generalised inertias at the last state that was gone to, by unit runs, row by row.
    pub(crate) fn inertias(&mut self) -> Vec<f64> {
        let n = self.strides.len();
        let mut run = self.model.actions();
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                self.model.inertial(i, &mut self.work, &mut run);
                run.tau.clone()
            })
            .collect();
        let at = |k: usize| columns[k % n][k / n];
        (0..n * n).map(at).collect()
    }

    /// The frames of all bodies at a position.
    ///
    /// # Errors
    /// As [`Claims::go`].
    pub(crate) fn frames_at(&mut self, q: &[f64]) -> Result<Vec<[f64; 3]>, StudyError> {
        self.walk(q)?;
        Ok(self.frames())
    }

    /// Condition number of the dense rows at the last state that was gone to.
    pub(crate) fn condition(&self) -> f64 {
        condition(&self.scene.mechanism, &self.frames())
    }

    /// The last state that was gone to.
    pub(crate) fn moment(&self) -> Moment<'_> {
        Moment {
            scene: self.scene,
            work: &self.work,
            actions: &self.actions,
            angles: &self.angles,
        }
    }

    /// Goes to a state and evaluates it; yields its accelerations.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when it cannot be reached, or a load has no magnitude or direction
    /// there.
    pub(crate) fn go(&mut self, ask: &Ask) -> Result<Vec<f64>, StudyError> {
        self.walk(&ask.q)?;
        let q_ddot = match &ask.q_ddot {
            Some(given) => given.clone(),
            None => self.free(ask)?,
        };
        self.evaluate(ask, &q_ddot)?;
        Ok(q_ddot)
    }

    /// In straight steps, counting the whole turns of every body.
    fn walk(&mut self, to: &[f64]) -> Result<(), StudyError> {
        let from = self.at.clone();
        let far = from.iter().zip(to).zip(&self.strides);
        let steps = far
            .map(|((a, b), stride)| ((b - a) / stride).abs().ceil())
            .fold(1.0, f64::max);
        for k in 1..=steps as usize {
            let part = k as f64 / steps;
            let there = |(a, b): (&f64, &f64)| if part == 1.0 { *b } else { a + part * (b - a) };
            let q: Vec<f64> = from.iter().zip(to).map(there).collect();
            self.place(&q)?;
            let frames = self.frames();
            for (angle, frame) in self.angles.iter_mut().zip(frames) {
                *angle = frame[2] + ((*angle - frame[2]) / TAU).round() * TAU;
            }
        }
        self.at = to.to_vec();
        Ok(())
    }

    fn place(&mut self, q: &[f64]) -> Result<(), StudyError> {
        let plan = self.model.plan();
        plan.place(q, &mut self.work.pose)
            .map_err(|e| explain_place(self.scene, plan, &e))
    }

    fn frames(&self) -> Vec<[f64; 3]> {
        let plan = self.model.plan();
        plan.body_frames(&self.scene.mechanism, &self.work.pose)
    }

    fn evaluate(&mut self, ask: &Ask, q_ddot: &[f64]) -> Result<(), StudyError> {
        let (work, actions) = (&mut self.work, &mut self.actions);
        let done = self
            .model
            .kinetostatics(ask.t, &ask.q, &ask.q_dot, q_ddot, work, actions);
        done.map_err(|e| self.explain(&e))
    }

    /// The acceleration at which the actuator does nothing. What it does is linear in it.
    fn free(&mut self, ask: &Ask) -> Result<Vec<f64>, StudyError> {
        if self.strides.len() != 1 {
            let place = (Place::Actuator(ActuatorId(0)), "one of several".to_owned());
            let message = "a free motion is only that of one actuator".to_owned();
            return Err(self.scene.error(message, None, &[place]).into());
        }
        self.evaluate(ask, &[0.0])?;
        let at_rest = self.actions.tau[0];
        self.evaluate(ask, &[1.0])?;
        let mut found = -at_rest / (self.actions.tau[0] - at_rest);
        // Once more from there: the difference above is rounded relative to the loads.
        self.evaluate(ask, &[found])?;
        if at_rest != 0.0 {
            found += self.actions.tau[0] * found / at_rest;
        }
        Ok(vec![found])
    }

    fn explain(&self, error: &KinetostaticsError) -> StudyError {
        match error {
            KinetostaticsError::Place(place) => explain_place(self.scene, self.model.plan(), place),
            other => {
                let name = other.load().and_then(|l| self.scene.loads.get(l));
                let name = name.map_or("", |load| &load.name);
                let at = other.load().map_or(Place::Whole, Place::Load);
                let message = match other {
                    KinetostaticsError::NoDirection { .. } => {
                        format!("`{name}` has no direction: its two points coincide")
                    }
                    _ => format!("the magnitude of `{name}` is not a finite number"),
                };
                let at = [(at, "in a state that is checked".to_owned())];
                self.scene.error(message, None, &at).into()
            }
        }
    }
}
