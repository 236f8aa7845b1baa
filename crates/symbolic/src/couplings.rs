//! Relations that determine one angle or travel: gears on fixed centres, racks, rolling discs.

use crate::algebra::{Term, names, number, plus, scale, times, zero};
use crate::error::SymbolicError;
use crate::positions::PositionFormulas;
use dwell_geometry::groups::Unknown;
use dwell_geometry::lower::Owner;

impl PositionFormulas<'_> {
    /// A relation that determines one angle or travel.
    pub(crate) fn solve_coupling(
        &mut self,
        group: usize,
        unknown: Unknown,
        coupling: usize,
    ) -> Result<(), SymbolicError> {
        let row = self.plan.coupling(coupling).clone();
        if row.law.is_some() {
            return Err(self.unsupported(group, "a coupling is given by a law"));
        }
        let angular = row.angular;
        let (mut known_terms, mut unknown_coefficient) = (zero(), zero());
        for &(frame, by) in &row.dependent.angles {
            let coefficient = self.coefficient(&row.owner, by, if angular { "" } else { "m" });
            if unknown == Unknown::ClassAngle(self.orientation_class(frame)) {
                unknown_coefficient = plus(&unknown_coefficient, &coefficient);
                known_terms = plus(
                    &known_terms,
                    &times(&coefficient, &self.relative_angle(frame)),
                );
            } else {
                if !self.counts_revolutions(frame) {
                    return Err(
                        self.unsupported(group, "a coupling counts the revolutions of a dyad")
                    );
                }
                known_terms = plus(&known_terms, &times(&coefficient, &self.angle(frame)));
            }
        }
        for &(slide, by) in &row.dependent.slides {
            let coefficient = self.coefficient(&row.owner, by, if angular { "rad/m" } else { "" });
            if unknown == Unknown::SlideTravel(slide) {
                unknown_coefficient = plus(&unknown_coefficient, &coefficient);
            } else {
                let travel = self.travels[slide].clone().unwrap_or_else(zero);
                known_terms = plus(&known_terms, &times(&coefficient, &travel));
            }
        }
        let constant = row.dependent.constant;
        let constant = self.coefficient(&row.owner, constant, if angular { "rad" } else { "m" });
        let value = (-(plus(&known_terms, &constant)) / unknown_coefficient.clone()).simplify();
        let code = match unknown {
            Unknown::ClassAngle(class) => {
                let reference_frame = self.plan.class_frame(class);
                let name = self.frame_name(reference_frame);
                let code = self.symbols.new_name("theta", &[&name]);
                self.angles[reference_frame] = Some(self.symbols.assign(&code, &value));
                code
            }
            Unknown::SlideTravel(slide) => {
                let code = self.travel_name(slide);
                self.travels[slide] = Some(self.symbols.assign(&code, &value));
                code
            }
        };
        self.solved_couplings[coupling] = Some((code, unknown_coefficient.simplify()));
        Ok(())
    }

    /// A number of a relation as a constant; nothing and one need no name.
    fn coefficient(&mut self, owner: &Owner, value: f64, unit: &'static str) -> Term {
        if value == 0.0 || value.abs() == 1.0 {
            return number(value);
        }
        let name = match *owner {
            Owner::Joint(joint) => self.mechanism.joints[joint.0].name.clone(),
            Owner::Actuator(actuator) => self.mechanism.actuators[actuator.0].name.clone(),
        };
        let known = self
            .coefficients
            .iter()
            .find(|w| w.0 == value.abs() && w.1 == name);
        let term = match known {
            Some((.., term)) => term.clone(),
            None => {
                let k = self.next_number();
                let meaning = format!("number of {name}");
                let term = self
                    .symbols
                    .add_constant(("c", &[&k]), value.abs(), unit, meaning);
                self.coefficients.push((value.abs(), name, term.clone()));
                term
            }
        };
        scale(&term, value.signum())
    }

    /// Whether an angle is a linear function of the coordinate and of travels: no turn is lost.
    fn counts_revolutions(&self, frame: usize) -> bool {
        let mut wanted = names(&self.angle(frame));
        for step in self.symbols.assignments.iter().rev() {
            if wanted.remove(&step.code) {
                if step.partials.is_some() && step.code.starts_with("theta") {
                    return false;
                }
                wanted.extend(names(&step.value));
            }
        }
        true
    }
}
