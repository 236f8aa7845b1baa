//! A mechanism followed along its way: the table, and what sections and drawings need of each position.

use crate::error::{StudyError, explain_model};
use crate::figures::{Frame, size};
use crate::run::Command;
use crate::run::columns::{Column, Columns, Quantity, Term};
use crate::run::doubt::Doubt;
use crate::run::leverage::Pace;
use crate::run::link::Link;
use crate::run::need::lean;
use crate::run::select::is_named;
use crate::run::stop::{End, Stop, is_cut_off};
use crate::run::watch::Watch;
use crate::run::way::{Sample, Way};
use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::{BodyId, Motion, Plan, Pose, Vec2};
use dwell_kinetostatics::{
    Act, Actions, By, Ledger, LoadKind, Model, PowerBalance, Workspace, Wrench,
};
use dwell_scene::{Place, Scene};
use std::f64::consts::TAU;

/// What a command found along the way.
pub(crate) struct Record {
    /// All columns of the command.
    pub(crate) columns: Vec<Column>,
    /// By position: a value for each column.
    pub(crate) rows: Vec<Vec<f64>>,
    /// By position and body.
    pub(crate) frames: Vec<Vec<Frame>>,
    /// The links whose inner forces were asked for.
    pub(crate) links: Vec<Link>,
    /// The largest residual of the power balance, as a part of its absolute terms.
    pub(crate) residual: f64,
    /// The estimated rounding error of actions and reactions, as a part of the largest of their unit.
    pub(crate) rounding: Option<f64>,
    /// The reactions that the loads do not determine.
    pub(crate) shared: Vec<String>,
    /// By body: whether it is modelled.
    pub(crate) placed: Vec<bool>,
    /// Where and why the way ended early.
    pub(crate) stop: Option<Stop>,
}

impl Record {
    /// The bodies that are not modelled, because nothing needs them.
    pub(crate) fn absent(&self, scene: &Scene) -> Vec<String> {
        let bodies = scene.mechanism.bodies.iter().zip(&self.placed);
        let absent = bodies.filter(|(_, placed)| !**placed);
        absent.map(|(body, _)| body.name.clone()).collect()
    }
}

/// The model of a scene under its loads, with every reaction.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be put together or a load does not fit it.
pub(crate) fn model(scene: &Scene) -> Result<Model, StudyError> {
    let start = scene.assembly.to_start();
    let reactions = scene.mechanism.reactions();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &reactions)
        .map_err(|e| explain_model(scene, &e))?;
    with_loads(scene, model)
}

/// A model under the loads of its scene.
///
/// # Errors
/// [`StudyError::Scene`] where a load does not fit it.
pub(crate) fn with_loads(scene: &Scene, model: Model) -> Result<Model, StudyError> {
    let loads = scene.loads.clone();
    model.with_loads(&scene.mechanism, loads).map_err(|e| {
        let labels = [(Place::Load(e.load), "this load".to_owned())];
        scene.error(e.to_string(), None, &labels).into()
    })
}

/// One evaluation after another.
struct Probe<'a> {
    scene: &'a Scene,
    model: &'a Model,
    ledger: Ledger,
    command: Command,
    /// With several actuators, the whole mechanism: it ends the way where any of its groups does.
    whole: Option<(&'a Plan, Pose<f64>)>,
    work: Workspace<f64>,
    actions: Actions<f64>,
    acts: Vec<Act>,
    motion: Motion<f64>,
    /// The bodies at the speeds of the way, whatever the command.
    moving: BodyStates,
    /// The bodies at unit speed of a single actuator.
    unit: BodyStates,
    /// Of a body, m, and how fast the bodies are: at unit speed of a single actuator, and on the way.
    size: f64,
    pace: [Pace; 2],
    powers: Vec<f64>,
    /// By joint: the force on its second body, N.
    forces: Vec<Vec2>,
    shaking: Wrench,
    power: PowerBalance,
    watch: Watch<'a>,
}

impl<'a> Probe<'a> {
    fn new(
        scene: &'a Scene,
        whole: &'a Plan,
        model: &'a Model,
        command: Command,
    ) -> Result<Self, StudyError> {
        let some = model.plan().skipped().contains(&true);
        let followed = some && whole.actuators() > 1;
        let ledger = Ledger::new(&scene.mechanism, model).map_err(|e| explain_model(scene, &e))?;
        Ok(Self {
            ledger,
            scene,
            model,
            command,
            whole: followed.then(|| (whole, whole.pose())),
            size: size(scene),
            pace: [Pace::default(); 2],
            work: model.workspace(),
            actions: model.actions(),
            acts: Vec::new(),
            motion: model.plan().motion(),
            moving: BodyStates::new(model.plan()),
            unit: BodyStates::new(model.plan()),
            powers: vec![0.0; scene.loads.len()],
            forces: vec![Vec2::ZERO; scene.mechanism.joints.len()],
            shaking: Wrench::default(),
            power: PowerBalance::default(),
            watch: Watch::new(scene),
        })
    }

    fn evaluate(&mut self, sample: &Sample, timed: bool) -> Result<(), End> {
        let plan = self.model.plan();
        let Sample {
            t,
            q,
            q_dot,
            q_ddot,
            given,
            ..
        } = sample;
        if let Some((whole, pose)) = &mut self.whole {
            whole.place(q, pose)?;
        }
        let (work, actions) = (&mut self.work, &mut self.actions);
        // Without a time loads stand at their beginning.
        let t = if timed { *t } else { 0.0 };
        match self.command {
            Command::Kinematics => plan.place(q, &mut work.pose)?,
            Command::Statics => self.model.statics(t, q, work, actions)?,
            Command::Kinetostatics | Command::Simulate => {
                for &(load, magnitude) in given {
                    work.give(load, magnitude);
                }
                self.model
                    .kinetostatics(t, q, q_dot, q_ddot, work, actions)?;
            }
        }
        if self.command != Command::Kinematics
            && let Some(fault) = self.watch.off_table(t, work.states())
        {
            return Err(End::Fault(fault));
        }
        if plan.actuators() == 1 {
            plan.speeds(&work.pose, &[1.0], &mut self.motion);
            self.unit.fill(plan, &work.pose, &self.motion);
        }
        plan.speeds(&work.pose, q_dot, &mut self.motion);
        plan.accelerations(&work.pose, q_ddot, &mut self.motion);
        self.moving.fill(plan, &work.pose, &self.motion);
        self.pace = [&self.unit, &self.moving].map(|states| Pace::of(states, self.size));
        if let Some(fault) = self.watch.jump(&self.moving) {
            return Err(End::Fault(fault));
        }
        if self.command != Command::Kinematics {
            self.account();
        }
        Ok(())
    }

    /// Forces of the joints, on the frame, and the power balance.
    fn account(&mut self) {
        let (model, work, actions) = (self.model, &self.work, &self.actions);
        self.ledger.acts(model, work, actions, &mut self.acts);
        self.forces.fill(Vec2::ZERO);
        for act in &self.acts {
            if let By::Joint(j) = act.by
                && act.body == self.scene.mechanism.joints[j.0].bodies[1]
            {
                self.forces[j.0] += act.force;
            }
        }
        let shaking = self.ledger.shaking(model, work, &self.acts);
        let [by_reactions, by_loads] = [shaking.by_reactions, shaking.loads_on_ground];
        self.shaking = Wrench {
            force: by_reactions.force + by_loads.force,
            moment: by_reactions.moment + by_loads.moment,
        };
        self.power = model.power(work, actions);
        model.load_powers(work, &mut self.powers);
    }

    fn value(&self, quantity: Quantity, sample: &Sample) -> f64 {
        let states = &self.moving;
        match quantity {
            Quantity::Time => sample.t,
            Quantity::Drive(i, order) => match sample.own {
                Some(own) => own[order],
                None => [&sample.q, &sample.q_dot, &sample.q_ddot][order][i],
            },
            Quantity::Action(i) => self.actions.tau[i],
            Quantity::Measured(measured, order) => states.measure(measured)[order],
            // As relations and loads count it, so that columns of one angle agree.
            Quantity::Angle(body, 0) => {
                let ground = BodyId(self.scene.mechanism.ground);
                states.angle([ground, body])[0]
            }
            Quantity::Angle(body, 1) => states.body(body).spin,
            Quantity::Angle(body, _) => states.body(body).spin_rate,
            Quantity::Ratio(body) => self.unit.body(body).spin,
            Quantity::Advantage(body, point) => self.pace[0].advantage(&self.unit, body, point),
            Quantity::Pole(body, order, axis) => {
                let pole = match order {
                    // Where a single actuator rests, the body still has its pole.
                    1 if self.model.plan().actuators() == 1 => self.pace[0].pole(&self.unit, body),
                    1 => self.pace[1].pole(states, body),
                    _ => self.pace[1].acceleration_pole(states, body),
                };
                if axis == 0 { pole.x } else { pole.y }
            }
            Quantity::Point(body, at, k) => {
                let point = states.point(body, at);
                let vector = [point.position, point.velocity, point.acceleration][k / 2];
                if k % 2 == 0 { vector.x } else { vector.y }
            }
            Quantity::Transmission(dyad) => dyad.angle(states),
            Quantity::Reaction(k) => self.actions.reactions[k],
            Quantity::ForceIn(joint, body, axis) => {
                let local = self.forces[joint.0].turn_back(states.body(body).turn);
                if axis == 0 { local.x } else { local.y }
            }
            Quantity::Magnitude(joint) => self.forces[joint.0].norm(),
            Quantity::Direction(joint) => self.forces[joint.0].angle(),
            Quantity::Frame(0) => self.shaking.force.x,
            Quantity::Frame(1) => self.shaking.force.y,
            Quantity::Frame(_) => self.shaking.moment,
            Quantity::Balance(Term::Actuators) => self.power.actuators,
            Quantity::Balance(Term::Loads) => self.power.loads,
            Quantity::Balance(Term::Kinetic) => self.power.kinetic,
            Quantity::Balance(Term::Residual) => self.power.residual(),
            Quantity::Balance(Term::Energy) => self.power.energy,
            Quantity::Load(k) => self.load(k),
            Quantity::LoadPower(k) => self.powers[k],
            Quantity::Told(k) => sample.told[k],
        }
    }

    /// What a load does: its force along its direction or line, or its couple on its second body.
    fn load(&self, k: usize) -> f64 {
        let by_it = || self.acts.iter().filter(|act| act.by == By::Load(k));
        match self.scene.loads[k].kind {
            LoadKind::Gravity { .. }
            | LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Push { .. } => self.work.loads().magnitude[k],
            LoadKind::Spring { bodies, points, .. } | LoadKind::Damper { bodies, points } => {
                let line = self.work.states().separation(bodies, points).direction;
                let on_second = by_it().find(|act| act.body == bodies[1]);
                match (line, on_second) {
                    (Some(line), Some(act)) => act.force.dot(line),
                    _ => 0.0,
                }
            }
            LoadKind::TorsionSpring { bodies, .. } | LoadKind::TorsionDamper { bodies } => by_it()
                .find(|act| act.body == bodies[1])
                .map_or(0.0, |act| act.couple),
            LoadKind::Slide(guide) | LoadKind::SlideDamper(guide) => {
                let [first, second] = guide.bodies;
                let axis = guide.axis.turn(self.work.states().body(first).turn);
                let on_second = by_it().find(|act| act.body == second);
                on_second.map_or(0.0, |act| act.force.dot(axis))
            }
        }
    }

    fn frames(&self) -> Vec<Frame> {
        let bodies = (0..self.scene.mechanism.bodies.len()).map(BodyId);
        let frame = |b| {
            let origin = self.moving.point(b, Vec2::ZERO).position;
            (origin, self.moving.body(b).turn)
        };
        bodies.map(frame).collect()
    }
}

/// Angles counted over whole turns: nearest to what the last value and the speeds foretell.
struct Turns {
    last: Vec<Option<(f64, f64, f64)>>,
}

impl Turns {
    fn follow(&mut self, k: usize, value: f64, speed: f64, t: f64) -> f64 {
        let counted = self.last[k].map_or(value, |(before, was, then)| {
            let expected = before + 0.5 * (was + speed) * (t - then);
            value + TAU * ((expected - value) / TAU).round()
        });
        self.last[k] = Some((counted, speed, t));
        counted
    }
}

/// Follows a scene along a way.
///
/// # Errors
/// [`StudyError::Scene`] when not even the first position can be reached.
pub(crate) fn follow(
    scene: &Scene,
    whole: &Model,
    way: &Way<'_>,
    command: Command,
    heard: &dyn Fn(usize),
) -> Result<Record, StudyError> {
    // The way and its end are those of the whole mechanism, whatever of it is modelled.
    let plan: &Plan = whole.plan();
    let model = &lean(scene, whole);
    let placed = model.plan().placed();
    let is_placed = |column: &Column| {
        let bodies = column.quantity.bodies(scene, model.reactions());
        bodies.iter().all(|b| placed[b.0])
    };
    // A sweep of statics has no time.
    let timed = way.swept().is_none() || command != Command::Statics;
    let told = way.told().iter().enumerate().map(|(k, told)| Column {
        name: told.name.clone(),
        unit: told.unit,
        quantity: Quantity::Told(k),
        meaning: told.meaning.clone(),
    });
    let columns: Vec<Column> = Columns::all(scene, model, timed)
        .into_iter()
        .chain(told)
        .filter(|c| c.is_of(command) && is_placed(c))
        .filter(|c| !matches!(c.quantity, Quantity::Action(i) if !way.acts(i)))
        .filter(|c| !c.is_optional() || is_named(scene, c))
        .collect();
    way.check(scene)?;
    let charts = match way.charts() {
        [] => std::slice::from_ref(model),
        charts => charts,
    };
    let mut probes = charts
        .iter()
        .map(|chart| Probe::new(scene, plan, chart, command))
        .collect::<Result<Vec<_>, _>>()?;
    let mut turns = Turns {
        last: vec![None; columns.len()],
    };
    let sections = match command {
        Command::Kinematics => &[],
        _ => scene.requests.sections.as_slice(),
    };
    let mut record = Record {
        columns,
        rows: Vec::with_capacity(way.points),
        frames: Vec::with_capacity(way.points),
        links: sections.iter().map(Link::new).collect(),
        residual: 0.0,
        rounding: None,
        shared: (0..model.reactions().len())
            .filter(|&k| !model.plan().is_unique(k))
            .map(|k| scene.mechanism.reaction_name(model.reactions()[k]))
            .collect(),
        placed,
        stop: None,
    };
    let doubted = matches!(command, Command::Statics | Command::Kinetostatics);
    let mut doubt = doubted.then(|| Doubt::new(scene, model, way.points));
    let mut before: Option<f64> = None;
    for k in 0..way.points {
        let part = way.part(k);
        let sample = way.at(part);
        let probe = &mut probes[sample.chart];
        let cut = before
            .filter(|_| plan.actuators() == 1 && way.charts().is_empty())
            .and_then(|q| is_cut_off(plan, q, sample.q[0]));
        let done = match cut {
            Some(error) => Err(error.into()),
            None => probe.evaluate(&sample, timed),
        };
        if let Err(error) = done {
            let reached = if k > 0 { way.part(k - 1) } else { part };
            let stop = Stop::find(plan, way, [reached, part], error);
            if k == 0 {
                return Err(stop.explain(scene, plan, way));
            }
            record.stop = Some(stop);
            break;
        }
        before = sample.q.first().copied();
        let value = |(i, column): (usize, &Column)| {
            let value = probe.value(column.quantity, &sample);
            if !column.unwraps() {
                return value;
            }
            let speed = match column.quantity {
                Quantity::Measured(measured @ Measured::Angle(_), _) => {
                    probe.moving.measure(measured)[1]
                }
                Quantity::Angle(body, _) => probe.moving.body(body).spin,
                _ => 0.0,
            };
            turns.follow(i, value, speed, sample.t)
        };
        let row = record.columns.iter().enumerate().map(value).collect();
        record.rows.push(row);
        record.frames.push(probe.frames());
        for link in &mut record.links {
            link.take(k, &probe.ledger, probe.model, &probe.work, &probe.acts);
        }
        if matches!(command, Command::Kinetostatics | Command::Simulate) && probe.power.scale > 0.0
        {
            let residual = probe.power.residual().abs() / probe.power.scale;
            record.residual = record.residual.max(residual);
        }
        if let Some(doubt) = &mut doubt {
            let t = if timed { sample.t } else { 0.0 };
            let rest = vec![0.0; sample.q.len()];
            let at = match command {
                Command::Statics => [sample.q.as_slice(), &rest, &rest],
                _ => [&sample.q, &sample.q_dot, &sample.q_ddot].map(Vec::as_slice),
            };
            doubt.take(k, model, t, at, &probe.actions);
        }
        heard(k);
    }
    record.rounding = doubt.map(|doubt| doubt.largest());
    Ok(record)
}
