//! A case with its model, evaluated with or without a slip, and judged by the truths.

use super::plain::{accelerations, plain_actions, plain_pose};
use super::standing::{POSITIONS, positions, walked};
use super::verdict::{ENOUGH, Verdict};
use super::watched::{Place, Slip, Watched, noting, slipping};
use dwell_findings::Finding;
use dwell_geometry::{BodyId, Vec2};
use dwell_kinetostatics::{Actions as Kinetostatic, Model, Workspace};
use dwell_scene::Scene;
use dwell_verify::{
    Actions, Case, Coefficients, State, Subject, SubjectError, judge_energies, judge_states,
    load_acts, verify_all,
};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Speeds and accelerations of the states, by state and actuator.
const SPEEDS: [[f64; 3]; POSITIONS] = [[1.0, -0.6, 0.4], [-0.8, 0.9, -0.5], [0.6, 0.7, 1.1]];
const RATES: [[f64; 3]; POSITIONS] = [[0.7, 0.5, -0.9], [0.5, -1.1, 0.6], [-1.2, 0.8, 0.7]];

/// A fault in one operation of the product.
pub(crate) type Fault = Option<(Place, Slip)>;

/// How a mechanism is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum By {
    /// Its reduced model, of one coordinate and no load.
    Reduced,
    /// Its states under loads, of any number of coordinates.
    States,
}

/// A mechanism to be judged.
pub(crate) struct Machine {
    pub(crate) name: String,
    pub(crate) by: By,
    scene: Scene,
    model: Model,
    positions: Vec<Vec<f64>>,
    /// By position, the frames of all bodies, turns counted from the start.
    frames: Vec<Vec<[f64; 3]>>,
    start: Vec<[f64; 3]>,
    /// What is answered without a fault.
    clean: Answers,
    clean_states: Vec<State>,
    /// The keys of findings that fail without a fault: too few positions for them, or constraints
    /// that repeat each other. They judge nothing here.
    pub(crate) blind: Vec<String>,
}

/// Everything that is judged, by kind.
pub(crate) type Answers = Vec<Vec<f64>>;
/// States, and by state the generalised inertias, row by row.
pub(crate) type Claims = (Vec<State>, Vec<Vec<f64>>);

/// An answer that moves by less than this, relative to the largest of its kind, is the same answer:
/// three digits above what the truths tell from rounding.
pub(crate) const SAME: f64 = 1e-9;

impl Machine {
    /// A machine whose answers are known.
    pub(crate) fn new(scene: Scene, by: By) -> Self {
        let name = scene.name.clone();
        let mut machine = Self::described(scene, by).unwrap_or_else(|| panic!("{name} is none"));
        if by == By::States {
            machine.clean_states = machine.states(None).expect("states").0;
        }
        machine.clean = machine.answers(None).expect("answers");
        let findings = machine.findings(None, usize::MAX);
        let failed = findings.into_iter().filter(|f| !f.pass);
        machine.blind = failed.map(|f| f.key).collect();
        machine
    }

    /// A machine as described; none if it cannot be put together.
    pub(crate) fn described(scene: Scene, by: By) -> Option<Self> {
        let mechanism = &scene.mechanism;
        let start = scene.assembly.to_start();
        let mut model =
            Model::new(mechanism, &scene.masses, &start, &mechanism.reactions()).ok()?;
        if by == By::States {
            model = model.with_loads(mechanism, scene.loads.clone()).ok()?;
        }
        let mut positions = positions(&scene, model.plan());
        if by == By::Reduced {
            // Judging costs more there.
            positions.truncate(2);
        }
        let (at_start, frames) = walked(&scene, model.plan(), &positions);
        Some(Self {
            name: scene.name.clone(),
            by,
            scene,
            model,
            positions,
            frames,
            start: at_start,
            clean: Vec::new(),
            clean_states: Vec::new(),
            blind: Vec::new(),
        })
    }

    /// What it costs to judge, roughly: dense rows, cubed.
    pub(crate) fn size(&self) -> usize {
        self.scene.mechanism.bodies.len()
    }

    /// Every place that an evaluation meets.
    pub(crate) fn places(&self) -> BTreeSet<Place> {
        noting(|| self.answers(None)).1
    }

    /// How far a fault moves the answers, relative to the largest of each kind; none where there is
    /// no answer at all.
    pub(crate) fn moved(&self, fault: Fault) -> Option<f64> {
        Some(apart(&self.clean, &self.answers(fault)?))
    }

    /// What the truths say.
    pub(crate) fn judge(&self, fault: Fault) -> Verdict {
        self.verdict(&self.findings(fault, ENOUGH))
    }

    /// Of findings that can judge here.
    fn verdict(&self, findings: &[Finding]) -> Verdict {
        let seeing = findings.iter().filter(|f| !self.blind.contains(&f.key));
        Verdict::of(seeing)
    }

    /// What the truths say of states that are claimed of this machine; nothing where they are its own.
    pub(crate) fn judge_claims(&self, mut claims: Claims) -> Option<Verdict> {
        for (claim, own) in claims.0.iter_mut().zip(&self.clean_states) {
            claim.loads.clone_from(&own.loads);
        }
        if apart(&self.clean, &self.told(&claims)) <= SAME {
            return None;
        }
        let findings = self.judged(&claims, usize::MAX);
        Some(self.verdict(&findings))
    }

    /// The states that this machine claims.
    pub(crate) fn claims(&self) -> Option<Claims> {
        self.states(None)
    }

    /// The accelerations of its states, without all that comes of speeds.
    pub(crate) fn straight(&self, claims: &Claims) -> Vec<Vec<[f64; 3]>> {
        let mut work = self.model.workspace::<Watched>();
        let still = vec![Watched::default(); self.model.plan().actuators()];
        let lifted = |values: &[f64]| values.iter().map(|&v| Watched::new(v)).collect::<Vec<_>>();
        let of = |state: &State| {
            let entered = self
                .model
                .enter(state.t, &lifted(&state.q), &still, &mut work);
            entered.expect("a pose");
            self.model.accelerate(&lifted(&state.q_ddot), &mut work);
            accelerations(&work, state.bodies.len())
        };
        claims.0.iter().map(of).collect()
    }

    /// Where it is judged: to be the same for claims of a wrong description.
    pub(crate) fn stand(&mut self, positions: &[Vec<f64>]) {
        self.positions = positions.to_vec();
        self.clean_states.clear();
        (_, self.frames) = walked(&self.scene, self.model.plan(), &self.positions);
    }

    pub(crate) fn positions(&self) -> &[Vec<f64>] {
        &self.positions
    }

    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What the truths find; the costly ones only where fewer than `enough` others catch it.
    fn findings(&self, fault: Fault, enough: usize) -> Vec<Finding> {
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        if self.by == By::Reduced {
            let case = Case {
                mechanism,
                masses,
                range: self.model.plan().range(),
                positions: self.positions.iter().map(|q| q[0]).collect(),
            };
            let subject = Slipping {
                machine: self,
                fault,
            };
            return verify_all(&case, &subject, &[]);
        }
        match self.states(fault) {
            None => Vec::new(),
            Some(claims) => self.judged(&claims, enough),
        }
    }

    fn judged(&self, (states, inertias): &Claims, enough: usize) -> Vec<Finding> {
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        let mut findings = judge_states(mechanism, masses, &self.start, states);
        if self.verdict(&findings).count() < enough {
            findings.extend(judge_energies(
                mechanism,
                masses,
                &self.start,
                states,
                inertias,
            ));
        }
        findings
    }

    fn answers(&self, fault: Fault) -> Option<Answers> {
        match self.by {
            By::Reduced => {
                let subject = Slipping {
                    machine: self,
                    fault,
                };
                let (mut poses, mut inertia, mut acts) = (Vec::new(), Vec::new(), Vec::new());
                for (q, k) in self.positions.iter().zip(0..) {
                    let [v, r] = [SPEEDS[k][0], RATES[k][0]];
                    poses.extend(subject.poses(q[0]).ok()?.into_iter().flatten());
                    let at = subject.coefficients(q[0]).ok()?;
                    inertia.extend([at.m, at.half_dm]);
                    acts.extend(self.determined(at.a));
                    acts.extend(self.determined(at.b));
                    let done = subject.actions(q[0], v, r).ok()?;
                    acts.extend(self.determined(done.reactions));
                    acts.push(done.tau);
                }
                // What is zero throughout has the scale of its like.
                Some(vec![poses, inertia, acts])
            }
            By::States => Some(self.told(&self.states(fault)?)),
        }
    }

    fn told(&self, (states, inertias): &Claims) -> Answers {
        let all = |of: fn(&State) -> &Vec<[f64; 3]>| {
            let each = states.iter().flat_map(|s| of(s).iter().flatten().copied());
            each.collect()
        };
        let acts = states.iter().flat_map(|s| {
            let reactions = self.determined(s.reactions.clone());
            reactions.into_iter().chain(s.tau.clone())
        });
        vec![
            all(|s| &s.bodies),
            all(|s| &s.velocity),
            all(|s| &s.acceleration),
            acts.collect(),
            inertias.concat(),
        ]
    }

    /// The reactions that the loads determine; the others may be split in any way that balances.
    fn determined(&self, reactions: Vec<f64>) -> Vec<f64> {
        let own = |(k, value): (usize, f64)| self.model.plan().is_unique(k).then_some(value);
        reactions.into_iter().enumerate().filter_map(own).collect()
    }

    /// The states under the loads. What the loads do is told from the right poses and magnitudes.
    fn states(&self, fault: Fault) -> Option<Claims> {
        let mut work = self.model.workspace::<Watched>();
        let (mut actions, mut unit) = (self.model.actions(), self.model.actions());
        let n = self.model.plan().actuators();
        let (mut states, mut inertias) = (Vec::new(), Vec::<Vec<f64>>::new());
        for (k, q) in self.positions.iter().enumerate() {
            let t = 0.3 + 0.4 * k as f64;
            let [q_dot, q_ddot] = [&SPEEDS[k][..n], &RATES[k][..n]];
            let done = slipping(fault, || {
                let lifted =
                    |values: &[f64]| values.iter().map(|&v| Watched::new(v)).collect::<Vec<_>>();
                let (q, v, a) = (lifted(q), lifted(q_dot), lifted(q_ddot));
                self.model
                    .kinetostatics(t, &q, &v, &a, &mut work, &mut actions)
            });
            done.ok()?;
            let state = slipping(fault, || self.state(t, k, &work, &actions));
            let mut runs = Vec::new();
            for i in 0..n {
                slipping(fault, || self.model.inertial(i, &mut work, &mut unit));
                runs.push(plain_actions(&unit));
            }
            // M_ij is the action i at q̈ⱼ = 1 alone.
            let at = |i: usize, j: usize| runs[j].tau[i];
            inertias.push((0..n * n).map(|k| at(k / n, k % n)).collect());
            states.push(state);
            if k + 1 == self.positions.len() && self.model.frictions().len() == 0 {
                let mut free = self.free(fault, states.last()?, &runs, &mut work)?;
                free.t += 1e-3;
                inertias.push(inertias.last()?.clone());
                states.push(free);
            }
        }
        Some((states, inertias))
    }

    /// The same state, moving freely: its accelerations from the inertias, and every reaction as one
    /// line of what the unit runs yield.
    fn free(
        &self,
        fault: Fault,
        state: &State,
        runs: &[Kinetostatic<f64>],
        work: &mut Workspace<Watched>,
    ) -> Option<State> {
        let n = runs.len();
        let still = vec![Watched::default(); n];
        let mut without = self.model.actions();
        slipping(fault, || self.model.loaded(&still, work, &mut without)).ok()?;
        let without = plain_actions(&without);
        let q_ddot = solved(runs, &without.tau)?;
        let lifted: Vec<_> = q_ddot.iter().map(|&a| Watched::new(a)).collect();
        slipping(fault, || self.model.accelerate(&lifted, work));
        let mut free = state.clone();
        free.reactions = without.reactions;
        for (run, a) in runs.iter().zip(&q_ddot) {
            for (sum, one) in free.reactions.iter_mut().zip(&run.reactions) {
                *sum += one * a;
            }
        }
        free.acceleration = slipping(fault, || accelerations(work, free.bodies.len()));
        free.tau = vec![0.0; n];
        free.q_ddot = q_ddot;
        Some(free)
    }

    fn state(
        &self,
        t: f64,
        k: usize,
        work: &Workspace<Watched>,
        actions: &Kinetostatic<Watched>,
    ) -> State {
        let (mechanism, n) = (&self.scene.mechanism, self.model.plan().actuators());
        let states = work.states();
        let mut bodies = self
            .model
            .plan()
            .body_frames(mechanism, &plain_pose(self.model.plan(), &work.pose));
        for (frame, right) in bodies.iter_mut().zip(&self.frames[k]) {
            frame[2] += ((right[2] - frame[2]) / TAU).round() * TAU;
        }
        let of = |b: usize| (states.body(BodyId(b)), states.point(BodyId(b), Vec2::ZERO));
        let velocity = |b: usize| {
            let (body, origin) = of(b);
            [origin.velocity.x, origin.velocity.y, body.spin].map(|v| v.0)
        };
        let velocity: Vec<[f64; 3]> = (0..bodies.len()).map(velocity).collect();
        let loads = match self.clean_states.get(k) {
            Some(clean) => clean.loads.clone(),
            None => {
                let loads = self.scene.loads.iter().zip(&work.loads().magnitude);
                let acts = loads.filter_map(|(load, magnitude)| {
                    let masses = &self.scene.masses;
                    load_acts(
                        &load.kind,
                        magnitude.0,
                        mechanism.ground,
                        masses,
                        &bodies,
                        &velocity,
                    )
                });
                acts.flatten().collect()
            }
        };
        State {
            t,
            q: self.positions[k].clone(),
            q_dot: SPEEDS[k][..n].to_vec(),
            q_ddot: RATES[k][..n].to_vec(),
            acceleration: accelerations(work, bodies.len()),
            bodies,
            velocity,
            reactions: actions.reactions.iter().map(|r| r.0).collect(),
            tau: actions.tau.iter().map(|r| r.0).collect(),
            loads,
        }
    }
}

/// The reduced model of a machine, evaluated in watched numbers.
struct Slipping<'a> {
    machine: &'a Machine,
    fault: Fault,
}

impl Subject for Slipping<'_> {
    fn poses(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError> {
        let Machine { model, scene, .. } = self.machine;
        let mut pose = model.plan().pose();
        slipping(self.fault, || {
            model.plan().place(&[Watched::new(q)], &mut pose)
        })
        .map_err(refused(q))?;
        Ok(model
            .plan()
            .body_frames(&scene.mechanism, &plain_pose(model.plan(), &pose)))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let model = &self.machine.model;
        let (mut work, mut at) = (model.workspace(), model.coefficients());
        slipping(self.fault, || {
            model.reduce(Watched::new(q), &mut work, &mut at)
        })
        .map_err(refused(q))?;
        Ok(Coefficients {
            m: at.m.0,
            half_dm: at.half_dm.0,
            a: at.a.iter().map(|v| v.0).collect(),
            b: at.b.iter().map(|v| v.0).collect(),
        })
    }

    fn actions(&self, q: f64, q_dot: f64, q_ddot: f64) -> Result<Actions, SubjectError> {
        let model = &self.machine.model;
        let (mut work, mut actions) = (model.workspace(), model.actions());
        let [at, v, a] = [q, q_dot, q_ddot].map(|v| [Watched::new(v)]);
        slipping(self.fault, || {
            model.act(&at, &v, &a, &mut work, &mut actions)
        })
        .map_err(refused(q))?;
        Ok(Actions {
            tau: actions.tau[0].0,
            reactions: actions.reactions.iter().map(|v| v.0).collect(),
        })
    }
}

fn refused<E: std::fmt::Display>(q: f64) -> impl Fn(E) -> SubjectError {
    move |e| SubjectError {
        q,
        message: e.to_string(),
    }
}

/// q̈ of Σ runs q̈ + rest = 0, by elimination with the largest pivot.
fn solved(runs: &[Kinetostatic<f64>], rest: &[f64]) -> Option<Vec<f64>> {
    let n = runs.len();
    let row = |i: usize| {
        runs.iter()
            .map(|run| run.tau[i])
            .chain([-rest[i]])
            .collect()
    };
    let mut rows: Vec<Vec<f64>> = (0..n).map(row).collect();
    for c in 0..n {
        let pivot = (c..n).max_by(|&i, &j| rows[i][c].abs().total_cmp(&rows[j][c].abs()))?;
        rows.swap(c, pivot);
        let own = rows[c].clone();
        for (_, other) in rows.iter_mut().enumerate().filter(|(i, _)| *i != c) {
            let by = other[c] / own[c];
            other.iter_mut().zip(&own).for_each(|(a, b)| *a -= by * b);
        }
    }
    (0..n).map(|i| Some(rows[i][n] / rows[i][i])).collect()
}

/// How far answers are apart, relative to the largest of each kind; infinitely where one is no number.
fn apart(clean: &Answers, found: &Answers) -> f64 {
    let mut worst = 0.0_f64;
    for (clean, found) in clean.iter().zip(found) {
        let largest = clean.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
        for (c, f) in clean.iter().zip(found).filter(|(c, f)| c != f) {
            let by = (f - c).abs() / largest;
            worst = worst.max(if by.is_nan() { f64::INFINITY } else { by });
        }
    }
    worst
}
