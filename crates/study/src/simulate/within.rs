//! A motion to a wanted accuracy: the cheapest computation that meets it, by its own estimate.
//!
//! 1. What loses nothing and comes back is known at every time by quadrature, whatever its length.
//! 2. What is smooth goes by the eighth order, what is stiff by BDF. Which it is, a rough run tells: how many of its
//!    steps stability kept from being longer, and what BDF takes for the same.
//! 3. What takes so many evaluations that making a table of the machine is less, goes on a table.
//! 4. The tolerance is found by trying: each run is compared with the one before, ten times as rough or more,
//!    over the whole motion, in coordinates, energy and reactions. That difference is the estimate, although the
//!    finer of both is what is kept.

use super::apart::Apart;
use super::{Computed, Free, Moved};
use crate::error::StudyError;
use crate::estimate;
use crate::motion_error::explain_motion;
use dwell_dynamics::{
    DynamicsError, Method, Options, Orbit, Point, Shown, State, Statistics, Tabled, Trace,
    follow_by, follow_orbit,
};
use dwell_kinetostatics::Extent;
use dwell_scene::Scene;

/// Tolerance of the rough run.
const ROUGH: f64 = 1e-4;
/// The finest tolerances: below them rounding is all that changes, and Newton's method cannot keep them.
const FINEST: f64 = 1e-14;
const FINEST_IMPLICIT: f64 = 1e-13;
/// Times the error of the eighth order that BDF's is at the same tolerance: measured 7 to 75 in ten turns.
const ROUGHER: f64 = 50.0;
/// Part of the wanted accuracy that the first tolerance is: an integrator errs by tens of its tolerance.
const FIRST: f64 = 1e-2;
/// What an error that was too large is to become, as a part of what is wanted.
const AIMED: f64 = 0.2;
/// A tolerance is never refined by less or more at once.
const REFINED: [f64; 2] = [1e-4, 0.1];
/// What is kept errs by a tenth to a half of the difference from the run before; steps that fall unluckily made it
/// 2.2 times as much at worst (nine cases, eleven accuracies each).
const SAFETY: f64 = 2.5;
/// Part of the steps above which stability, not accuracy, is what costs.
const STIFF: f64 = 0.05;
/// Evaluations from which on a table pays: making two takes 2 to 10 ms under loads, which is some 20 000 evaluations of
/// the machine, and saves nine tenths of each.
const PAYS: f64 = 30_000.0;
/// How much finer than the tolerance a table is, and how fine at most.
const FINER: f64 = 0.1;
const FINEST_TABLE: f64 = 1e-13;
/// How far beyond the rough run a table of a limited range reaches, as a part of what that run passed.
const ROOM: f64 = 0.05;
/// Steps of a rough run before it is given up.
const ROUGH_STEPS: usize = 100_000;
/// Runs before the wanted accuracy is given up.
const MOST_RUNS: usize = 6;

impl Free<'_> {
    /// The motion within `wanted`: rad (of lengths: of the largest change), and parts of the largest kinetic energy
    /// and of the largest reaction.
    pub(super) fn within(
        &self,
        scene: &Scene,
        wanted: f64,
        duration: f64,
        every: f64,
    ) -> Result<Computed, StudyError> {
        if let Some(found) = self.by_quadrature(wanted, duration, every) {
            return Ok(found);
        }
        let sampled = |method: Method, tolerance: f64| Options {
            every: Some(every),
            ..Options::new(method, tolerance)
        };
        let rough = |method: Method| {
            let options = Options {
                budget: ROUGH_STEPS,
                ..sampled(method, ROUGH)
            };
            self.follow(scene, duration, &options)
        };
        let explicit = rough(Method::Dop853)?;
        let (methods, expected, why) = self.methods(&explicit, || rough(Method::Bdf), wanted)?;
        let mut ways: Vec<(Method, bool)> = methods.map(|method| (method, false)).to_vec();
        if expected > PAYS && self.stays(&explicit) {
            ways.insert(0, (methods[0], true));
        }
        let around = extent(&explicit);
        // Where the first cannot reach it, the next may.
        let mut best: Option<(Tried, Method, bool)> = None;
        let mut last = (ways[0] == (Method::Dop853, false) && complete(&explicit))
            .then_some((ROUGH, explicit));
        for (method, tabled) in ways {
            let run = |tolerance: f64| {
                let options = sampled(method, tolerance);
                if tabled {
                    self.on_table(around, duration, &options)
                } else {
                    self.follow(scene, duration, &options).map(Some)
                }
            };
            let Some(tried) = self.refine(wanted, method, last.take(), &run)? else {
                continue;
            };
            let worst = tried.apart.worst();
            let better = |(best, ..): &(Tried, Method, bool)| worst < best.apart.worst();
            if best.as_ref().is_none_or(better) {
                best = Some((tried, method, tabled));
            }
            if worst <= wanted {
                break;
            }
        }
        let Some((tried, method, tabled)) = best else {
            let error = DynamicsError::TooShort;
            return Err(explain_motion(self.scene, self.shown.plan(), &error));
        };
        let on = if tabled { " on a table" } else { "" };
        let how = format!(
            "{}{on}, tolerance {}",
            method.name(),
            power(tried.tolerance)
        );
        let told = format!(
            "  accuracy {}: by {how}, {why}; {} runs\n{}",
            power(wanted),
            tried.runs,
            words(&tried.apart)
        );
        Ok(Computed {
            moved: tried.moved,
            how,
            told,
            accuracy: Some([wanted, tried.apart.worst()]),
        })
    }

    /// The methods to try, the cheaper first, the evaluations that it is expected to take, and why that one.
    fn methods(
        &self,
        explicit: &Moved,
        implicit: impl FnOnce() -> Result<Moved, StudyError>,
        wanted: f64,
    ) -> Result<([Method; 2], f64, String), StudyError> {
        let work = explicit.statistics;
        let share = work.stiff as f64 / (work.steps.max(1)) as f64;
        // What accuracy costs grows as the root of a method's order; what stability costs does not grow.
        let finer = ROUGH / (FIRST * wanted).clamp(FINEST, ROUGH);
        let by_explicit = work.evaluations as f64 * (share + (1.0 - share) * finer.powf(1.0 / 8.0));
        let smooth = [Method::Dop853, Method::Bdf];
        if complete(explicit) && share <= STIFF {
            return Ok((smooth, by_explicit, "for it is smooth".to_owned()));
        }
        let implicit = implicit()?;
        let by_implicit = self.cost(&implicit.statistics) * (ROUGHER * finer).powf(1.0 / 6.0);
        let told = format!(
            "for {:.0} % of a rough run's steps are stiff",
            100.0 * share
        );
        Ok(if complete(explicit) && by_explicit <= by_implicit {
            (smooth, by_explicit, told)
        } else {
            ([Method::Bdf, Method::Dop853], by_implicit, told)
        })
    }

    /// What BDF's work is worth in evaluations: a column of a Jacobian is one in dual numbers, a step costs two
    /// beside its own.
    fn cost(&self, work: &Statistics) -> f64 {
        let columns = 4 * self.machine.free().len();
        (work.evaluations + columns * work.jacobians + 2 * work.steps) as f64
    }

    /// Whether a motion stays in its own coordinate and on its branch, where a table holds.
    fn stays(&self, rough: &Moved) -> bool {
        let one = rough.legs.len() == 1 && rough.charts.len() <= 1;
        one && complete(rough) && self.machine.free() == [0]
    }

    /// The motion on a table that is finer by as much as the tolerance is: what two runs differ by is then the
    /// error of both. None where there is no such table, or the motion leaves it.
    fn on_table(
        &self,
        around: [f64; 2],
        duration: f64,
        options: &Options,
    ) -> Result<Option<Moved>, StudyError> {
        let extent = match self.machine.model().plan().range().limits() {
            None => Extent::Whole,
            Some((from, to)) => {
                let room = ROOM * (around[1] - around[0]);
                Extent::Between((around[0] - room).max(from), (around[1] + room).min(to))
            }
        };
        let accuracy = (FINER * options.relative).max(FINEST_TABLE);
        let Ok(table) = Tabled::new(&self.machine, accuracy, extent) else {
            return Ok(None);
        };
        let start = self.start();
        let explain = |e: &DynamicsError| explain_motion(self.scene, self.shown.plan(), e);
        let mut moving = table.moving(start.t, &start.y).map_err(|e| explain(&e))?;
        let of = Shown {
            machine: &self.machine,
            shown: &self.shown,
        };
        let events = self.events();
        let trace = follow_by(&mut moving, of, &start, duration, options, &events);
        let trace = trace.map_err(|e| explain(&e))?;
        Ok(trace.failed.is_none().then(|| Moved::in_one(trace)))
    }

    /// Runs by finer and finer tolerances until two agree, the last of which is kept. None where one cannot be
    /// made.
    fn refine(
        &self,
        wanted: f64,
        method: Method,
        last: Option<(f64, Moved)>,
        run: &dyn Fn(f64) -> Result<Option<Moved>, StudyError>,
    ) -> Result<Option<Tried>, StudyError> {
        let explain = |e: &DynamicsError| explain_motion(self.scene, self.shown.plan(), e);
        let finest = if method.implicit() {
            FINEST_IMPLICIT
        } else {
            FINEST
        };
        let first = (FIRST * wanted).clamp(10.0 * finest, ROUGH);
        // A rough run that is there is good for a first comparison.
        let (mut tolerance, mut kept) = match last {
            Some((tolerance, moved)) if 0.1 * tolerance <= first => (tolerance, moved),
            _ => match run(first)? {
                Some(moved) => (first, moved),
                None => return Ok(None),
            },
        };
        let mut next = (0.1 * tolerance).min(first).max(finest);
        let mut runs = 1;
        loop {
            let Some(moved) = run(next)? else {
                return Ok(None);
            };
            let apart = self.apart(&kept, &moved).map_err(|e| explain(&e))?;
            let apart = apart.times(SAFETY);
            (tolerance, kept) = (next, moved);
            runs += 1;
            let worst = apart.worst();
            if worst <= wanted || next <= 1.01 * finest || runs >= MOST_RUNS {
                return Ok(Some(Tried {
                    tolerance,
                    moved: kept,
                    apart,
                    runs,
                }));
            }
            let [most, least] = REFINED;
            let factor = if worst.is_finite() {
                AIMED * wanted / worst
            } else {
                least
            };
            next = (tolerance * factor.clamp(most, least)).max(finest);
        }
    }

    /// The motion by quadrature, if it loses nothing and comes back.
    fn by_quadrature(&self, wanted: f64, duration: f64, every: f64) -> Option<Computed> {
        if self.motion.laws.iter().any(Option::is_some) {
            return None;
        }
        let start = self.state();
        let orbit = Orbit::loaded(&self.machine, start).ok()?;
        let of = Shown {
            machine: &self.machine,
            shown: &self.shown,
        };
        let options = Options {
            every: Some(every),
            ..Options::new(Method::Dop853, FINEST)
        };
        let trace = follow_orbit(&orbit, of, duration, &options, &self.events()).ok()?;
        let beside = |times: f64| {
            let q_dot = start.q_dot * times;
            Orbit::loaded(&self.machine, State { q_dot, ..start })
        };
        // What the start's rounding does, and what the rule itself is off by: all comes so much later.
        let late = estimate::of_period(&orbit, beside).ok()? / orbit.period;
        let found = Moved::in_one(trace);
        let apart = self.apart(&found, &later(&orbit, &found, late)).ok()?;
        let how = "quadrature".to_owned();
        let told = format!(
            "  accuracy {}: by {how}, for it loses nothing and comes back; {} points of the rule\n{}",
            power(wanted),
            orbit.points,
            words(&apart)
        );
        Some(Computed {
            moved: found,
            how,
            told,
            accuracy: Some([wanted, apart.worst()]),
        })
    }
}

/// What a refinement came to.
struct Tried {
    tolerance: f64,
    moved: Moved,
    apart: Apart,
    runs: usize,
}

/// Between which coordinates a motion of one freedom stays.
fn extent(moved: &Moved) -> [f64; 2] {
    let steps = moved.steps().filter_map(|(_, point)| point.y.first());
    steps.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &q| {
        [a.min(q), b.max(q)]
    })
}

/// Whether a motion came to its end.
fn complete(moved: &Moved) -> bool {
    moved.failed.is_none()
}

/// The same motion with everything later by a part of the time.
fn later(orbit: &Orbit, moved: &Moved, part: f64) -> Moved {
    let shifted = |point: &Point| {
        let State { q, q_dot, .. } = orbit.at(point.t * (1.0 + part));
        Point {
            t: point.t,
            y: vec![q, q_dot],
        }
    };
    let traces = moved.legs.iter().map(|(_, trace)| trace);
    Moved::in_one(Trace {
        steps: traces
            .clone()
            .flat_map(|t| t.steps.last().cloned())
            .collect(),
        samples: traces.flat_map(|t| t.samples.iter().map(shifted)).collect(),
        ..Trace::default()
    })
}

fn words(apart: &Apart) -> String {
    let Apart {
        coordinate,
        energy,
        reactions,
        ..
    } = apart;
    format!(
        "  estimated errors over the whole motion: {coordinate:.1e} in the coordinates, {energy:.1e} of the largest \
         kinetic energy, {reactions:.1e} of the largest reaction\n"
    )
}

/// A number by its two leading digits.
fn power(value: f64) -> String {
    let short = format!("{value:.1e}");
    short.replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

    use super::*;
    use dwell_dynamics::all_loads;

    fn text(case: &str) -> String {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        std::fs::read_to_string(format!("{cases}/{case}/scene.toml")).unwrap()
    }

    /// With the loads through which the drives act.
    fn driven(scene: &Scene) -> Scene {
        let mut driven = scene.clone();
        driven.loads = all_loads(&scene.mechanism, &scene.loads, &scene.drives).unwrap();
        driven
    }

    /// What is promised is kept, for every case that moves under loads and for free ones, against a method
    /// that was not picked. The truth's own error is that of a tenth of its tolerance.
    #[test]
    fn val_what_is_promised_is_kept() {
        for case in CASES {
            let scene = Scene::parse(case, &text(case)).unwrap();
            let driven = driven(&scene);
            let run = Free::new(&scene, &driven, scene.motion.as_ref().unwrap()).unwrap();
            let duration = run.duration().unwrap();
            let every = duration / 200.0;
            let by = |tolerance: f64| {
                let options = Options {
                    every: Some(every),
                    ..Options::new(Method::Tsit45, tolerance)
                };
                run.follow(&scene, duration, &options).unwrap()
            };
            let truth = by(1e-13);
            let floor = 0.2 * run.apart(&truth, &by(1e-12)).unwrap().worst();
            for power in 2..13 {
                let wanted = 10_f64.powi(-power);
                let found = run.within(&scene, wanted, duration, every).unwrap();
                let off = run.apart(&truth, &found.moved).unwrap().worst();
                let [_, estimate] = found.accuracy.unwrap();
                println!("{case} {wanted:e}: {off:.1e} of {estimate:.1e}, floor {floor:.1e}");
                assert!(
                    off <= estimate.max(floor),
                    "{case} {wanted:e}: {off:e} {estimate:e} {floor:e}"
                );
                // What cannot be promised is beyond the digits of a motion that multiplies every rounding.
                assert!(estimate <= wanted || wanted < 1e-9, "{case}: {estimate:e}");
            }
        }
    }

    /// A thousand turns under weight and a motor's characteristic go on a table, and are as near as promised to
    /// what the machine itself does.
    #[test]
    fn a_long_motion_goes_on_a_table() {
        let text = text("four-bar");
        let text = text.replace("duration = 0.6", "duration = 40");
        let scene = Scene::parse("four-bar", &text).unwrap();
        let driven = driven(&scene);
        let run = Free::new(&scene, &driven, scene.motion.as_ref().unwrap()).unwrap();
        let found = run.within(&scene, 1e-8, 40.0, 0.2).unwrap();
        assert!(found.how.contains("on a table"), "{}", found.told);
        let options = Options {
            every: Some(0.2),
            ..Options::new(Method::Tsit45, 1e-12)
        };
        let truth = run.follow(&scene, 40.0, &options).unwrap();
        let off = run.apart(&truth, &found.moved).unwrap().worst();
        let [wanted, estimate] = found.accuracy.unwrap();
        println!("{off:e} {estimate:e} {}", found.told);
        assert!(
            off <= estimate && estimate <= wanted,
            "{off:e} {estimate:e}"
        );
    }

    /// A crank in thick oil: its speed settles within a millisecond of each change of the couple. BDF is picked, and
    /// what it promises is kept.
    #[test]
    fn what_is_stiff_goes_by_bdf() {
        let text = text("crank-rocker");
        let text = text.replace("periods = 10", "duration = 2")
            + "\n[loads]\npush = { torque = [\"ground\", \"crank\"], magnitude = \"2000*sin(3*t)\" }\n\
               brake = { torsion-damper = [\"ground\", \"crank\"], constant = 2000 }\n";
        let scene = Scene::parse("oil", &text).unwrap();
        let driven = driven(&scene);
        let run = Free::new(&scene, &driven, scene.motion.as_ref().unwrap()).unwrap();
        let found = run.within(&scene, 1e-6, 2.0, 0.01).unwrap();
        assert!(found.how.starts_with("BDF"), "{}", found.told);
        let options = Options {
            every: Some(0.01),
            ..Options::new(Method::Esdirk34, 1e-11)
        };
        let truth = run.follow(&scene, 2.0, &options).unwrap();
        let off = run.apart(&truth, &found.moved).unwrap().worst();
        let [wanted, estimate] = found.accuracy.unwrap();
        println!("{off:e} {estimate:e} {}", found.told);
        assert!(
            off <= estimate && estimate <= wanted,
            "{off:e} {estimate:e}"
        );
    }

    const CASES: [&str; 9] = [
        "andrews",
        "slider-crank-friction",
        "double-pendulum",
        "five-bar",
        "boom",
        "n-four-bar-a02",
        "crank-rocker",
        "pendulum-a01",
        "single-dwell",
    ];
}
