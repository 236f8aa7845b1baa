//! Relations that determine one angle or travel: gears on fixed centres, racks, rolling discs.

use crate::algebra::{Term, names, number, plus, scaled, times, zero};
use crate::error::SymbolicError;
use crate::positions::Positions;
use dwell_geometry::groups::Unknown;
use dwell_geometry::lower::Owner;

impl Positions<'_> {
    /// A relation that determines one angle or travel.
    pub(crate) fn relate(
        &mut self,
        group: usize,
        unknown: Unknown,
        relation: usize,
    ) -> Result<(), SymbolicError> {
        let row = self.plan.relation(relation).clone();
        if row.law.is_some() {
            return Err(self.none(group, "a relation has a law"));
        }
        let angular = row.angular;
        let (mut rest, mut own) = (zero(), zero());
        for &(frame, by) in &row.of.turns {
            let weight = self.weight(&row.owner, by, if angular { "" } else { "m" });
            if unknown == Unknown::Class(self.class(frame)) {
                own = plus(&own, &weight);
                rest = plus(&rest, &times(&weight, &self.relative(frame)));
            } else {
                if !self.counts(frame) {
                    return Err(self.none(group, "a relation counts the turns of a dyad"));
                }
                rest = plus(&rest, &times(&weight, &self.angle(frame)));
            }
        }
        for &(slide, by) in &row.of.slides {
            let weight = self.weight(&row.owner, by, if angular { "rad/m" } else { "" });
            if unknown == Unknown::Slide(slide) {
                own = plus(&own, &weight);
            } else {
                let travel = self.travels[slide].clone().unwrap_or_else(zero);
                rest = plus(&rest, &times(&weight, &travel));
            }
        }
        let constant = row.of.constant;
        let constant = self.weight(&row.owner, constant, if angular { "rad" } else { "m" });
        let value = (-(plus(&rest, &constant)) / own.clone()).simplify();
        let code = match unknown {
            Unknown::Class(class) => {
                let root = self.plan.root_of(class);
                let name = self.frame_name(root);
                let code = self.sheet.name("theta", &[&name]);
                self.angles[root] = Some(self.sheet.step(&code, &value));
                code
            }
            Unknown::Slide(slide) => {
                let code = self.travel_name(slide);
                self.travels[slide] = Some(self.sheet.step(&code, &value));
                code
            }
        };
        self.related[relation] = Some((code, own.simplify()));
        Ok(())
    }

    /// A number of a relation as a constant; nothing and one need no name.
    fn weight(&mut self, owner: &Owner, value: f64, unit: &'static str) -> Term {
        if value == 0.0 || value.abs() == 1.0 {
            return number(value);
        }
        let name = match *owner {
            Owner::Joint(joint) => self.mechanism.joints[joint.0].name.clone(),
            Owner::Actuator(actuator) => self.mechanism.actuators[actuator.0].name.clone(),
        };
        let known = self
            .weights
            .iter()
            .find(|w| w.0 == value.abs() && w.1 == name);
        let term = match known {
            Some((.., term)) => term.clone(),
            None => {
                let k = self.number();
                let meaning = format!("number of {name}");
                let term = self
                    .sheet
                    .constant(("c", &[&k]), value.abs(), unit, meaning);
                self.weights.push((value.abs(), name, term.clone()));
                term
            }
        };
        scaled(&term, value.signum())
    }

    /// Whether an angle is a linear function of the coordinate and of travels: no turn is lost.
    fn counts(&self, frame: usize) -> bool {
        let mut wanted = names(&self.angle(frame));
        for step in self.sheet.steps.iter().rev() {
            if wanted.remove(&step.code) {
                if step.slopes.is_some() && step.code.starts_with("theta") {
                    return false;
                }
                wanted.extend(names(&step.value));
            }
        }
        true
    }
}
