//! The faults of single operations, put together by the step of the plan that they are in.

use super::operations::{Outcome, Slipped};
use super::source::Source;
use super::verdict::TRUTHS;
use std::collections::BTreeMap;

/// What the faults of one function, or of one step, came to.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Tally {
    /// Signs, terms and factors that went wrong.
    pub(crate) faults: usize,
    /// Of them: no answer moved, and no answer was given.
    pub(crate) same: usize,
    pub(crate) refused: usize,
    /// Of the others, how many each truth caught, and how many it was asked about.
    pub(crate) caught: [usize; TRUTHS.len()],
    pub(crate) asked: [usize; TRUTHS.len()],
    /// The fewest truths that caught one.
    pub(crate) fewest: Option<usize>,
}

impl Tally {
    fn meet(&mut self, slipped: &Slipped) {
        self.faults += 1;
        match &slipped.outcome {
            Outcome::Same => self.same += 1,
            Outcome::Refused => self.refused += 1,
            Outcome::Judged(verdict, _) => {
                for number in 0..TRUTHS.len() {
                    self.caught[number] += usize::from(verdict.caught(number));
                    self.asked[number] += usize::from(verdict.digits[number].is_some());
                }
                let count = verdict.count();
                self.fewest = Some(self.fewest.map_or(count, |fewest| fewest.min(count)));
            }
        }
    }

    /// Faults that changed an answer.
    pub(crate) fn felt(&self) -> usize {
        self.faults - self.same - self.refused
    }
}

/// By the function they are in.
pub(crate) fn by_function(slips: &[Slipped], source: &Source) -> BTreeMap<String, Tally> {
    let mut tallies: BTreeMap<String, Tally> = BTreeMap::new();
    for slipped in slips {
        let tally = tallies
            .entry(source.function_of(slipped.place))
            .or_default();
        tally.meet(slipped);
    }
    tallies
}

/// By the step of a plan, in the order of evaluation.
pub(crate) fn by_step(slips: &[Slipped], source: &Source) -> Vec<(&'static str, Tally)> {
    let mut tallies: BTreeMap<(usize, &'static str), Tally> = BTreeMap::new();
    for slipped in slips {
        let file = slipped.place.file.rsplit('/').next().unwrap_or_default();
        let step = step(file, source.function(slipped.place));
        tallies.entry(step).or_default().meet(slipped);
    }
    tallies
        .into_iter()
        .map(|((_, step), tally)| (step, tally))
        .collect()
}

/// The step that a function belongs to, with its place in the order. What is new is shown as such, not left out.
fn step(file: &str, function: &str) -> (usize, &'static str) {
    match (file, function) {
        ("place.rs", "place_pin") => (0, "places: pin dyad"),
        ("place.rs", "place_aim") => (1, "places: guided point"),
        ("place.rs" | "plan.rs", "relation_couples") => (17, "couples of relations"),
        ("place.rs" | "plan.rs" | "locate.rs", _) => (2, "places: arms, loops, turns"),
        ("construct.rs", _) => (3, "places: triangle, circle, line"),
        ("solve.rs", _) => (4, "places: Newton and Jacobian"),
        ("small.rs", _) => (5, "groups: elimination"),
        ("tall.rs", _) => (6, "groups: least squares"),
        ("relation.rs", _) => (7, "gears, cams and other relations"),
        ("motion.rs", "speeds" | "arms_rate" | "gap_rate" | "row_rate" | "solved_speeds") => {
            (8, "speeds")
        }
        (
            "motion.rs",
            "accelerations"
            | "arms_rates"
            | "gap_rates"
            | "row_acceleration"
            | "solved_accelerations",
        ) => (9, "accelerations"),
        (
            "motion.rs",
            "multipliers" | "press" | "solved_multipliers" | "press_relation" | "class_moment",
        ) => (13, "multipliers, group by group"),
        ("motion.rs", _) => (10, "rates of driven frames and slides"),
        ("runs.rs", "accelerate" | "arm" | "slide" | "turning") => (11, "inertia forces"),
        ("runs.rs", "collect") => (12, "forces down the tree"),
        ("runs.rs", "note" | "hold" | "chord_force") => (14, "forces in the tree's joints"),
        ("runs.rs", "twist" | "along_holds") => (15, "couples, along the holds"),
        ("runs.rs", "tau") => (16, "actuator's action"),
        ("reactions.rs", _) => (18, "reactions"),
        ("reduced.rs" | "channels.rs", _) => (19, "unit runs"),
        ("measure.rs", _) => (20, "states of bodies, measures"),
        ("acts.rs" | "magnitudes.rs", _) => (21, "loads"),
        ("bearing.rs", _) => (22, "loads down the tree"),
        ("friction.rs", _) => (23, "friction"),
        _ => (24, "other steps"),
    }
}
