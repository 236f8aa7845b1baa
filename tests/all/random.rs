//! A thousand random mechanisms, which close because they are built around a pose: each is solved
//! there and nearby, and held against the dense equations; or refused, and singular.

mod grow;
mod standing;

use dwell_geometry::{AssemblyError, BodyId, JointKind, StructureError, Vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Model, ModelError};
use dwell_verify::{Finding, State, judge_states, load_acts, rank};
use grow::{Step, step};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, TestRunner};
use standing::{Described, Standing, View};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Mechanisms of one run.
const COUNT: u32 = 1000;
/// Bodies of the largest, the ground among them.
const MOST: usize = 30;
/// Acceleration of gravity, m/s².
const GRAVITY: f64 = 9.81;

/// What a mechanism is grown from.
#[derive(Debug, Clone)]
struct Seed {
    drives: Vec<Step>,
    steps: Vec<Step>,
    /// Whether it ends in two bars in one line, which nothing can solve.
    flat: Option<Step>,
    views: [u64; 2],
}

fn seed() -> impl Strategy<Value = Seed> {
    // Few are large: what a body costs the dense side grows with the cube of their number.
    let size = prop_oneof![6 => 0..5_usize, 3 => 5..10_usize, 1 => 10..25_usize];
    let steps = size.prop_flat_map(|n| prop::collection::vec(step(), n));
    let drives = prop_oneof![4 => 1..=1_usize, 2 => 2..=2_usize, 1 => 3..=3_usize];
    let drives = drives.prop_flat_map(|n| prop::collection::vec(step(), n));
    let flat = prop::option::weighted(0.02, step());
    (drives, steps, flat, any::<[u64; 2]>()).prop_map(|(drives, steps, flat, views)| Seed {
        drives,
        steps,
        flat,
        views,
    })
}

impl Seed {
    fn grown(&self) -> Standing {
        let mut standing = Standing::ground();
        for step in &self.drives {
            standing.drive(step);
        }
        for step in &self.steps {
            // A class III group brings four bodies.
            if standing.bodies.len() + 4 <= MOST {
                standing.grow(step);
            }
        }
        if let Some(step) = &self.flat {
            standing.flat(step);
        }
        standing
    }
}

/// What a run has met.
#[derive(Debug, Default)]
struct Tally {
    solved: u32,
    refused: BTreeMap<&'static str, u32>,
    bodies: usize,
    worst: BTreeMap<String, f64>,
}

impl Tally {
    fn worst(&mut self, what: &str, value: f64) {
        let worst = self.worst.entry(what.to_owned()).or_default();
        *worst = worst.max(value);
    }
}

/// A description made into a model, with gravity.
struct Made {
    described: Described,
    model: Model,
}

/// What a model says of a state.
struct Said {
    state: State,
    bits: Vec<u64>,
    /// By joint: its travel, where it has one.
    travels: Vec<f64>,
}

impl Made {
    fn new(standing: &Standing, view: &View) -> Result<Self, ModelError> {
        let described = standing.described(view);
        let Described {
            mechanism,
            masses,
            start,
            down,
            ..
        } = &described;
        let model = Model::new(mechanism, masses, start, &mechanism.reactions())?;
        let gravity = Load {
            name: "gravity".into(),
            kind: LoadKind::Gravity { direction: *down },
            magnitude: Magnitude::Constant(GRAVITY),
        };
        let model = model.with_loads(mechanism, vec![gravity]).expect("a load");
        Ok(Self { described, model })
    }

    /// The states at these steps from the start, each in the same memory.
    fn say(&self, standing: &Standing, view: &View, steps: &[Vec<f64>]) -> Result<Vec<Said>, String> {
        let Described {
            mechanism,
            masses,
            start,
            down,
            ..
        } = &self.described;
        let mut work = self.model.workspace::<f64>();
        let mut actions = self.model.actions();
        let senses: Vec<f64> = (0..start.q.len()).map(|i| view.sense(standing, i)).collect();
        let mut all = Vec::new();
        for step in steps {
            let rated = |rate: &dyn Fn(usize) -> f64| -> Vec<f64> {
                let both = senses.iter().enumerate();
                both.map(|(i, sense)| sense * rate(i)).collect()
            };
            let mut q = rated(&|i| step[i]);
            for (q, start) in q.iter_mut().zip(&start.q) {
                *q += start;
            }
            let q_dot = rated(&|i| 0.9 - 0.5 * i as f64);
            let q_ddot = rated(&|i| -0.6 + 0.8 * i as f64);
            self.model
                .kinetostatics(0.0, &q, &q_dot, &q_ddot, &mut work, &mut actions)
                .map_err(|e| format!("{e} at {step:?}"))?;
            let bodies = self.model.plan().body_frames(mechanism, &work.pose);
            let states = work.states();
            let rates = |b: usize| {
                let origin = states.point(BodyId(b), Vec2::ZERO);
                let body = states.body(BodyId(b));
                let (v, a) = (origin.velocity, origin.acceleration);
                ([v.x, v.y, body.spin], [a.x, a.y, body.spin_rate])
            };
            let (velocity, acceleration): (Vec<_>, Vec<_>) = (0..bodies.len()).map(rates).unzip();
            let gravity = LoadKind::Gravity { direction: *down };
            let loads = load_acts(
                &gravity,
                GRAVITY,
                mechanism.ground,
                masses,
                &bodies,
                &velocity,
            );
            let numbers = [&q, &actions.tau, &actions.reactions];
            let numbers = numbers.into_iter().flatten();
            let moves = bodies.iter().chain(&velocity).chain(&acceleration);
            let numbers: Vec<f64> = numbers.chain(moves.flatten()).copied().collect();
            if !numbers.iter().all(|v| v.is_finite()) {
                return Err(format!("not a number at {step:?}"));
            }
            all.push(Said {
                travels: self.travels(&bodies),
                bits: numbers.into_iter().map(f64::to_bits).collect(),
                state: State {
                    t: all.len() as f64,
                    q,
                    q_dot,
                    q_ddot,
                    bodies,
                    velocity,
                    acceleration,
                    reactions: actions.reactions.clone(),
                    tau: actions.tau.clone(),
                    loads: loads.expect("bodies"),
                },
            });
        }
        Ok(all)
    }

    fn travels(&self, frames: &[[f64; 3]]) -> Vec<f64> {
        let joints = self.described.mechanism.joints.iter();
        let travel = |joint: &dwell_geometry::Joint| {
            let JointKind::Prismatic { axes } = joint.kind else {
                return 0.0;
            };
            let turn = |i: usize| Vec2::from_angle(frames[joint.bodies[i].0][2]);
            let [one, two] = [0, 1].map(|i| {
                let [x, y, _] = frames[joint.bodies[i].0];
                Vec2 { x, y } + joint.points[i].turn(turn(i))
            });
            (two - one).dot(axes[0].turn(turn(0)))
        };
        joints.map(travel).collect()
    }

    /// What the joints and the actuators do, as `standing` has them.
    fn actions(&self, standing: &Standing, view: &View, said: &Said) -> Vec<f64> {
        let mechanism = &self.described.mechanism;
        let mut offsets = Vec::new();
        let mut at = 0;
        for joint in &mechanism.joints {
            offsets.push(at);
            at += joint.kind.components(&[]).len();
        }
        let mut all = Vec::new();
        for j in 0..standing.joints.len() {
            let to = view.joints[j];
            let rows = mechanism.joints[to].kind.components(&[]).len();
            let reaction = &said.state.reactions[offsets[to]..offsets[to] + rows];
            all.extend(view.reaction(standing, j, reaction, said.travels[to]));
        }
        let tau = said.state.tau.iter().enumerate();
        all.extend(tau.map(|(i, tau)| tau * view.sense(standing, i)));
        all
    }
}

fn name(error: &ModelError) -> &'static str {
    match error {
        ModelError::Assembly(AssemblyError::Structure(error)) => match error {
            StructureError::Detached { .. } => "detached",
            StructureError::UnderDriven { .. } => "under-driven",
            StructureError::OverConstrained { .. } => "over-constrained",
            StructureError::Malformed { .. } => "malformed",
        },
        ModelError::Assembly(AssemblyError::CannotClose { .. }) => "cannot close",
        ModelError::Assembly(AssemblyError::Ambiguous { .. }) => "ambiguous",
        ModelError::Assembly(AssemblyError::Inconsistent { .. }) => "inconsistent",
        ModelError::Assembly(AssemblyError::SingularStart { .. }) => "singular start",
        ModelError::Reaction(_) | ModelError::Masses => "another",
    }
}

/// Holds one mechanism against everything.
fn judge(seed: &Seed, tally: &mut Tally) -> Result<(), String> {
    let standing = seed.grown();
    let views = seed.views.map(|seed| View::of(&standing, seed));
    let [one, two] = views.each_ref().map(|view| Made::new(&standing, view));
    let described = standing.described(&views[0]);
    let ranks = rank(&described.mechanism, &described.frames).map_err(|e| e.to_string())?;
    let values = &ranks.driven.singular_values;
    let [largest, smallest] = [values.first(), values.last()].map(|v| v.copied().unwrap_or(0.0));
    tally.bodies += standing.bodies.len();
    let (one, two) = match (one, two) {
        (Ok(one), Ok(two)) => (one, two),
        (Err(error), _) | (_, Err(error)) => {
            *tally.refused.entry(name(&error)).or_default() += 1;
            if smallest < 1e-7 * largest {
                return Ok(());
            }
            return Err(format!("{error}: {error:?} but {:e}", smallest / largest));
        }
    };
    tally.solved += 1;
    let condition = largest / smallest;
    tally.worst("condition", condition);
    Ok(())
}

#[test]
fn a_thousand_random_mechanisms() {
    let failures = FileFailurePersistence::Direct("proptest-regressions/random.txt");
    let mut runner = TestRunner::new(ProptestConfig {
        cases: COUNT,
        failure_persistence: Some(Box::new(failures)),
        ..ProptestConfig::default()
    });
    let tally = RefCell::new(Tally::default());
    let result = runner.run(&seed(), |seed| {
        judge(&seed, &mut tally.borrow_mut()).map_err(TestCaseError::fail)
    });
    println!("{:?}", tally.borrow());
    if let Err(error) = result {
        panic!("{error}");
    }
}
