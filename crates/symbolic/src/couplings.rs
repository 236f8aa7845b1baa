//! Couplings that determine one angle or travel: gears on fixed centres, racks, rolling discs.

use crate::algebra::{Term, names, number, plus, scale, times, zero};
use crate::error::SymbolicError;
use crate::loops::owner_name;
use crate::positions::PositionFormulas;
use dwell_geometry::groups::Unknown;
use dwell_geometry::lower::Owner;

impl PositionFormulas<'_> {
    /// Solves a coupling for one angle or travel.
    pub(crate) fn solve_coupling(
        &mut self,
        group: usize,
        unknown: Unknown,
        coupling: usize,
    ) -> Result<(), SymbolicError> {
        let row = self.plan.couplings[coupling].clone();
        if row.law.is_some() {
            return Err(self.unsupported(group, "a coupling is given by a law"));
        }
        let unit = |angular, length| if row.angular { angular } else { length };
        let (mut known_terms, mut unknown_coefficient) = (zero(), zero());
        for &(frame, by) in &row.dependent.angles {
            let coefficient = self.coefficient(row.owner, by, unit("", "m"));
            let known_angle = if unknown == Unknown::ClassAngle(self.orientation_class(frame)) {
                unknown_coefficient = plus(&unknown_coefficient, &coefficient);
                self.relative_angle(frame)
            } else if self.counts_revolutions(frame) {
                self.angle(frame)
            } else {
                return Err(self.unsupported(group, "a coupling counts the revolutions of a dyad"));
            };
            known_terms = plus(&known_terms, &times(&coefficient, &known_angle));
        }
        for &(slide, by) in &row.dependent.slides {
            let coefficient = self.coefficient(row.owner, by, unit("rad/m", ""));
            if unknown == Unknown::SlideTravel(slide) {
                unknown_coefficient = plus(&unknown_coefficient, &coefficient);
            } else {
                known_terms = plus(&known_terms, &times(&coefficient, &self.travel(slide)));
            }
        }
        let constant = row.dependent.constant;
        let constant = self.coefficient(row.owner, constant, unit("rad", "m"));
        let value = (-(plus(&known_terms, &constant)) / unknown_coefficient.clone()).simplify();
        let step = match unknown {
            Unknown::ClassAngle(class) => {
                let reference_frame = self.plan.class_frame(class);
                let name = self.frame_name(reference_frame);
                let angle = self.symbols.assign("theta", &[&name], &value);
                self.angles[reference_frame] = Some(angle.clone());
                angle
            }
            Unknown::SlideTravel(slide) => self.assign_travel(slide, &value),
        };
        self.solved_couplings[coupling] = Some((step, unknown_coefficient.simplify()));
        Ok(())
    }

    /// A coefficient of a coupling as a constant; zero and one need no name.
    fn coefficient(&mut self, owner: Owner, value: f64, unit: &'static str) -> Term {
        if value == 0.0 || value.abs() == 1.0 {
            return number(value);
        }
        let name = owner_name(self.mechanism, owner);
        let mut known = self.coefficients.iter();
        let term = match known.find(|w| w.0 == value.abs() && w.1 == name) {
            Some((.., term)) => term.clone(),
            None => {
                let meaning = format!("number of {name}");
                let term = self.numbered_constant("c", value.abs(), unit, meaning);
                self.coefficients.push((value.abs(), name, term.clone()));
                term
            }
        };
        scale(&term, value.signum())
    }

    /// Whether an angle is a linear function of the coordinate and of travels, so that it counts revolutions.
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
