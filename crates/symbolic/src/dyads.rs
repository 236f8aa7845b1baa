//! The closed forms of the groups.

use crate::algebra::{
    Term, atan2, is_zero, names, number, plus, scale, sqrt, square, symbol, times, zero,
};
use crate::error::SymbolicError;
use crate::loops::{SlideTerm, pair_name};
use crate::polar::{Polar, angle_partials, square_of};
use crate::positions::{PositionFormulas, Vector, cross, dot, perp, rotate, square_norm};
use crate::symbol_table::PartialDerivatives;
use dwell_geometry::Vec2;
use dwell_geometry::groups::Unknown;

impl PositionFormulas<'_> {
    /// Writes the steps of one group.
    pub(crate) fn solve_group(&mut self, group: usize) -> Result<(), SymbolicError> {
        let plan = self.plan;
        let parts = plan.group(group);
        if parts.rows != parts.unknowns.len() {
            return Err(self.unsupported(group, "constraints repeat each other"));
        }
        let single = |closure: usize, slide: usize, formulas: &Self| {
            let slide_terms = formulas.loops[closure].slide_terms.iter();
            slide_terms.filter(|p| p.slide == slide).count() == 1
        };
        match (
            parts.unknowns.as_slice(),
            parts.loops.as_slice(),
            parts.couplings.as_slice(),
        ) {
            (&[unknown], &[], &[relation]) => self.solve_coupling(group, unknown, relation)?,
            (&[Unknown::ClassAngle(one), Unknown::ClassAngle(two)], &[c], &[])
                if self.loops[c].axis.is_none() =>
            {
                self.triangle(group, [one, two], c);
            }
            (&[Unknown::ClassAngle(class), Unknown::SlideTravel(slide)], &[c], &[])
                if self.loops[c].axis.is_none() && single(c, slide, self) =>
            {
                self.line_circle(group, class, slide, c);
            }
            (&[Unknown::ClassAngle(class)], &[c], &[]) if self.loops[c].axis.is_some() => {
                self.point_on_line(group, class, c);
            }
            (&[Unknown::SlideTravel(slide)], &[c], &[]) if self.loops[c].axis.is_some() => {
                self.slide_to_line(group, slide, c);
            }
            (&[Unknown::SlideTravel(one), Unknown::SlideTravel(two)], &[c], &[])
                if single(c, one, self) && single(c, two, self) =>
            {
                self.two_slides(group, [one, two], c);
            }
            (.., []) => return Err(self.unsupported(group, "they are no dyad")),
            _ => return Err(self.unsupported(group, "loops and couplings are solved together")),
        }
        Ok(())
    }

    pub(crate) fn loop_joint_name(&self, closure: usize) -> String {
        pair_name(self.mechanism, self.plan, self.loops[closure].loop_joint)
    }

    /// The steps of the part of a loop that earlier groups determine.
    fn known_part(&mut self, group: usize, closure: usize, but: &[usize]) -> Vector {
        let pick = |own: &Self, frame| !own.in_group(group, frame);
        let known = self.loop_part(closure, pick, Self::angle, but);
        let joint = self.loop_joint_name(closure);
        let known = self.symbols.assign_vector("d", &[&joint], &known);
        self.loops[closure].known_part = Some(known.clone());
        known
    }

    fn known_part_at_assembly(&self, group: usize, closure: usize, but: &[usize]) -> Vec2 {
        self.loop_part_at_assembly(closure, |formulas, f| !formulas.in_group(group, f), but)
    }

    /// ±√ of a term, with the branch of the group as a constant sign.
    fn signed_root(&mut self, letter: &str, joint: &str, radicand: &Term, branch: f64) -> Term {
        let sign = if branch < 0.0 { -1.0 } else { 1.0 };
        let meaning = format!("branch of the dyad that {joint} closes");
        let symbols = &mut self.symbols;
        let sign = symbols.add_constant("sigma", &[joint], sign, "", meaning);
        let code = symbols.new_name(letter, &[joint]);
        let radicand = radicand.simplify();
        // From h² = R: h′ = R′/2h.
        let half = |name: &String| {
            let partial = radicand.diff(name.as_str()) / number(2.0);
            (name.clone(), partial.simplify())
        };
        let partials = PartialDerivatives {
            quotient_partials: names(&radicand).iter().map(half).collect(),
            denominator: symbol(&code),
            extra_partials: Vec::new(),
        };
        symbols.assign_with_partials(code, sign * sqrt(radicand.clone()), partials)
    }

    /// Closes a triangle of the vectors of two classes and the known part of the loop.
    fn triangle(&mut self, group: usize, classes: [usize; 2], closure: usize) {
        let joint = self.loop_joint_name(closure);
        let d = self.known_part(group, closure, &[]);
        let [one, two] = classes.map(|class| self.polar(closure, class, &[]));
        let distance = self.symbols.assign("D", &[&joint], &square_norm(&d));
        let square_difference = two.square.clone() - one.square.clone();
        let along = square_difference / (number(2.0) * distance.clone()) - number(0.5);
        let along = self.symbols.assign("f", &[&joint], &along);
        let first = self.class_part_at_assembly(closure, classes[0], &[]);
        let known = self.known_part_at_assembly(group, closure, &[]);
        let radicand = one.square.clone() / distance - square(&along);
        let across = self.signed_root("h", &joint, &radicand, known.cross(first));
        let r = [
            times(&along, &d[0]) - times(&across, &d[1]),
            times(&along, &d[1]) + times(&across, &d[0]),
        ];
        let r = self.symbols.assign_vector("r", &[&joint, "1"], &r);
        self.orient_class(classes[0], &r, &one);
        let rest = [0, 1].map(|i| -(d[i].clone()) - r[i].clone());
        let rest = self.symbols.assign_vector("r", &[&joint, "2"], &rest);
        self.orient_class(classes[1], &rest, &two);
    }

    /// Closes a loop by the rotation of a class and the travel of a slide.
    //
    // Long, because the slide may or may not rotate with the class, and both cases start with the same known part.
    fn line_circle(&mut self, group: usize, class: usize, slide: usize, closure: usize) {
        let joint = self.loop_joint_name(closure);
        let but = [slide];
        let Some(slide_term) = self.slide_term(closure, slide) else {
            return;
        };
        let d = self.known_part(group, closure, &but);
        let u = self.direction(slide_term.frame, slide_term.local, "direction of travel");
        let along = slide_term.local.rotate(self.rotation[slide_term.frame]);
        let rotates_with_class = self.orientation_class(slide_term.frame) == class;
        let at_start = self.slide_travel[slide];
        if rotates_with_class {
            let w = self.class_part(closure, class, &but);
            let u = rotate(&u, &self.relative_angle(slide_term.frame));
            let distance = self.symbols.assign("D", &[&joint], &square_norm(&d));
            let offset = cross(&w, &u);
            let own = self.class_part_at_assembly(closure, class, &but);
            let radicand = plus(&distance, &-square_of(&offset));
            let branch = at_start + own.dot(along);
            let signed_root = self.signed_root("g", &joint, &radicand, branch);
            let travel = self.assign_travel(slide, &(signed_root - dot(&w, &u)));
            let reached = [0, 1].map(|i| plus(&w[i], &times(&u[i], &travel)));
            let mut polar = if w.iter().all(is_zero) && is_zero(&u[1]) {
                // The vector is the slide itself: the sign of its travel is the branch.
                Polar {
                    square: distance,
                    angle: zero(),
                    angle_symbol: None,
                    sign: (slide_term.local.x * at_start).signum(),
                }
            } else {
                self.varying_polar(closure, self.plan.class_frame(class), &reached)
            };
            // Its target is the reversed known part.
            polar.sign = -polar.sign;
            self.orient_class(class, &d, &polar);
        } else {
            let u = rotate(&u, &self.angle(slide_term.frame));
            let polar = self.polar(closure, class, &but);
            let offset = self.symbols.assign("k", &[&joint], &cross(&d, &u));
            let known = self.known_part_at_assembly(group, closure, &but);
            let radicand = polar.square.clone() - square(&offset);
            let branch = at_start + known.dot(along);
            let signed_root = self.signed_root("g", &joint, &radicand, branch);
            let travel = self.assign_travel(slide, &(signed_root - dot(&d, &u)));
            let r = [0, 1].map(|i| -(d[i].clone()) - times(&u[i], &travel));
            let r = self.symbols.assign_vector("r", &[&joint], &r);
            self.orient_class(class, &r, &polar);
        }
    }

    /// Stores the normal distance and the travel of a loop that closes along its normal only.
    fn close_along_normal(&mut self, closure: usize, normal: Term, travel: &Term) {
        let joint = self.loop_joint_name(closure);
        let travel = self.symbols.assign("s", &[&joint], travel);
        self.loops[closure].normal_distance = Some((normal, travel));
    }

    /// The axis of a loop that closes along its normal only: its angle's frame and its direction.
    fn line_direction(
        &mut self,
        closure: usize,
        angle: impl Fn(&Self, usize) -> Term,
    ) -> (Vector, Vec2) {
        let (_, frame, local) = self.loops[closure].axis.unwrap_or((0, 0, Vec2::IDENTITY));
        let vector = self.direction(frame, local, "direction of the guide");
        let vector = rotate(&vector, &angle(self, frame));
        (vector, local.rotate(self.rotation[frame]))
    }

    /// Closes a loop by a rotation that brings a point onto a line.
    fn point_on_line(&mut self, group: usize, class: usize, closure: usize) {
        let joint = self.loop_joint_name(closure);
        let (_, frame, _) = self.loops[closure].axis.unwrap_or((0, 0, Vec2::IDENTITY));
        let d = self.known_part(group, closure, &[]);
        if self.orientation_class(frame) == class {
            self.guided_point(group, class, closure, &d);
            return;
        }
        let (axis, at_start) = self.line_direction(closure, Self::angle);
        let normal = perp(&axis);
        let polar = self.polar(closure, class, &[]);
        let kappa = -dot(&normal, &d);
        let offset = self.symbols.assign("kappa", &[&joint], &kappa);
        let own = self.class_part_at_assembly(closure, class, &[]);
        let radicand = polar.square.clone() - square(&offset);
        let signed_root = self.signed_root("g", &joint, &radicand, own.dot(at_start));
        let travel = plus(&dot(&axis, &d), &signed_root);
        self.close_along_normal(closure, offset.clone(), &travel);
        let level = axis == [number(1.0), number(0.0)];
        let r = if level {
            [signed_root, offset]
        } else {
            let r =
                [0, 1].map(|i| plus(&times(&axis[i], &signed_root), &times(&normal[i], &offset)));
            self.symbols.assign_vector("r", &[&joint], &r)
        };
        self.orient_class(class, &r, &polar);
    }

    /// Closes a loop by a rotation of a line until it passes through a point.
    fn guided_point(&mut self, group: usize, class: usize, closure: usize, d: &Vector) {
        let joint = self.loop_joint_name(closure);
        let class_root = self.plan.class_frame(class);
        let w = self.class_part(closure, class, &[]);
        let (axis, at_start) = self.line_direction(closure, Self::relative_angle);
        let kappa = -dot(&perp(&axis), &w);
        let offset = self.symbols.assign("kappa", &[&joint], &kappa);
        let passes = w.iter().all(is_zero);
        let known = self.known_part_at_assembly(group, closure, &[]);
        let branch = known.dot(at_start);
        let distance = self.symbols.assign("D", &[&joint], &square_norm(d));
        let mut radicand = distance.clone();
        if !passes {
            radicand = radicand - square(&offset);
        }
        let along = self.signed_root("g", &joint, &radicand, branch);
        let travel = plus(&along, &dot(&axis, &w));
        self.close_along_normal(closure, offset.clone(), &travel);
        let mut partials = angle_partials(d, &distance);
        let quotient_partials = &mut partials.quotient_partials;
        quotient_partials.push((offset.to_string(), -along.clone()));
        let name = self.frame_name(class_root);
        let mut angle = if passes {
            // ρ is √D here.
            let [x, y] = [0, 1].map(|i| scale(&d[i], if branch < 0.0 { -1.0 } else { 1.0 }));
            atan2(y, x)
        } else {
            quotient_partials.push((along.to_string(), offset.clone()));
            atan2(d[1].clone(), d[0].clone()) - atan2(offset, along)
        };
        if let Some(line_angle) = self.line_angle(closure) {
            angle = angle - line_angle.0;
            partials.extra_partials.extend(line_angle.1);
        }
        let code = self.symbols.new_name("theta", &[&name]);
        let angle = self.symbols.assign_with_partials(code, angle, partials);
        self.angles[class_root] = Some(angle);
    }

    /// The angle of a line in its class with its derivatives; `None` if it is the x axis of the class.
    fn line_angle(&mut self, closure: usize) -> Option<(Term, Vec<(String, Term)>)> {
        let (_, frame, local) = self.loops[closure].axis?;
        let relative_angle = self.relative_angle(frame);
        let partials = names(&relative_angle)
            .iter()
            .map(|name| (name.clone(), -relative_angle.diff(name.as_str())))
            .collect();
        let constant_angle = local.angle();
        if constant_angle == 0.0 {
            return (!is_zero(&relative_angle)).then_some((relative_angle, partials));
        }
        let name = self.frame_name(frame);
        let meaning = format!("{name}: direction of the guide, from its x axis");
        let constant_angle = self.numbered_constant("alpha", constant_angle, "rad", meaning);
        Some((plus(&constant_angle, &relative_angle), partials))
    }

    /// Closes a loop by a travel that brings a point onto a line.
    fn slide_to_line(&mut self, group: usize, slide: usize, closure: usize) {
        let joint = self.loop_joint_name(closure);
        let d = self.known_part(group, closure, &[slide]);
        let (axis, _) = self.line_direction(closure, Self::angle);
        let normal = perp(&axis);
        let u = self.slide_direction(closure, slide);
        let kappa = -dot(&normal, &d);
        let offset = self.symbols.assign("kappa", &[&joint], &kappa);
        let travel = self.assign_travel(slide, &(offset.clone() / dot(&normal, &u)));
        let line_travel = plus(&dot(&axis, &d), &times(&dot(&axis, &u), &travel));
        self.close_along_normal(closure, offset, &line_travel);
    }

    /// Closes a loop by the travels of two slides.
    fn two_slides(&mut self, group: usize, slides: [usize; 2], closure: usize) {
        let d = self.known_part(group, closure, &slides);
        let [one, two] = slides.map(|s| self.slide_direction(closure, s));
        let area = cross(&one, &two);
        let values = [-(cross(&d, &two) / area.clone()), -(cross(&one, &d) / area)];
        for (slide, value) in slides.into_iter().zip(values) {
            self.assign_travel(slide, &value);
        }
    }

    /// The direction in which a loop passes a slide.
    fn slide_direction(&mut self, closure: usize, slide: usize) -> Vector {
        match self.slide_term(closure, slide) {
            Some(slide_term) => self.travel_direction(slide_term.frame, slide_term.local),
            None => [zero(), zero()],
        }
    }

    fn slide_term(&self, closure: usize, slide: usize) -> Option<SlideTerm> {
        let mut slide_terms = self.loops[closure].slide_terms.iter();
        slide_terms.find(|p| p.slide == slide).cloned()
    }
}
