//! The closed forms of the groups.

use crate::algebra::{
    Term, atan2, is_zero, names, number, plus, scale, sqrt, square, symbol, times, zero,
};
use crate::error::SymbolicError;
use crate::loops::pair_name;
use crate::polar::{Polar, angle_partials, square_of};
use crate::positions::{PositionFormulas, Vector, cross, dot, perp, rotate};
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
            (&[unknown], &[], &[relation]) => self.solve_coupling(group, unknown, relation),
            (&[Unknown::ClassAngle(one), Unknown::ClassAngle(two)], &[c], &[])
                if self.loops[c].axis.is_none() =>
            {
                self.triangle(group, [one, two], c);
                Ok(())
            }
            (&[Unknown::ClassAngle(class), Unknown::SlideTravel(slide)], &[c], &[])
                if self.loops[c].axis.is_none() && single(c, slide, self) =>
            {
                self.line_circle(group, class, slide, c);
                Ok(())
            }
            (&[Unknown::ClassAngle(class)], &[c], &[]) if self.loops[c].axis.is_some() => {
                self.point_on_line(group, class, c);
                Ok(())
            }
            (&[Unknown::SlideTravel(slide)], &[c], &[]) if self.loops[c].axis.is_some() => {
                self.slide_to_line(group, slide, c);
                Ok(())
            }
            (&[Unknown::SlideTravel(one), Unknown::SlideTravel(two)], &[c], &[])
                if single(c, one, self) && single(c, two, self) =>
            {
                self.two_slides(group, [one, two], c);
                Ok(())
            }
            (.., []) => Err(self.unsupported(group, "they are no dyad")),
            _ => Err(self.unsupported(group, "loops and couplings are solved together")),
        }
    }

    pub(crate) fn loop_joint_name(&self, closure: usize) -> String {
        pair_name(self.mechanism, self.plan, self.loops[closure].loop_joint)
    }

    /// The steps of the part of a loop that is known before its group.
    fn known_part(&mut self, group: usize, closure: usize, but: &[usize]) -> Vector {
        let known = self.loop_part(
            closure,
            |formulas, f| !formulas.in_group(group, f),
            |formulas, f| formulas.angle(f),
            but,
        );
        let joint = self.loop_joint_name(closure);
        let codes = ["x", "y"].map(|axis| self.symbols.new_name("d", &[&joint, axis]));
        let pair = [0, 1].map(|i| self.symbols.assign(&codes[i], &known[i]));
        self.loop_symbols[closure].known_part = Some(codes);
        pair
    }

    fn known_part_at_assembly(&self, group: usize, closure: usize, but: &[usize]) -> Vec2 {
        self.loop_part_at_assembly(closure, |formulas, f| !formulas.in_group(group, f), but)
    }

    /// ±√ of a term, the branch of the group as a constant.
    fn signed_root(
        &mut self,
        (letter, below): (&str, &[&str]),
        radicand: &Term,
        branch: f64,
    ) -> Term {
        let joint = below.first().copied().unwrap_or_default().to_owned();
        let sign = self.symbols.add_constant(
            ("sigma", &[&joint]),
            if branch < 0.0 { -1.0 } else { 1.0 },
            "",
            format!("branch of the dyad that {joint} closes"),
        );
        let code = self.symbols.new_name(letter, below);
        let root_symbol = symbol(&code);
        let radicand = radicand.simplify();
        // Of h² = R the derivative is R′/2h.
        let half = |name: &String| {
            let partial = radicand.diff(name.as_str()) / number(2.0);
            (name.clone(), partial.simplify())
        };
        let partials = PartialDerivatives {
            quotient_partials: names(&radicand).iter().map(half).collect(),
            denominator: root_symbol,
            extra_partials: Vec::new(),
        };
        self.symbols
            .assign_with_partials(&code, sign * sqrt(radicand.clone()), partials)
    }

    /// Two classes whose vectors close a triangle with the known part of the loop.
    fn triangle(&mut self, group: usize, classes: [usize; 2], closure: usize) {
        let joint = self.loop_joint_name(closure);
        let d = self.known_part(group, closure, &[]);
        let [one, two] = classes.map(|class| self.polar(closure, class, &[]));
        let code = self.symbols.new_name("D", &[&joint]);
        let distance = self
            .symbols
            .assign(&code, &plus(&square(&d[0]), &square(&d[1])));
        let code = self.symbols.new_name("f", &[&joint]);
        let square_difference = two.square.clone() - one.square.clone();
        let along = square_difference / (number(2.0) * distance.clone()) - number(0.5);
        let along = self.symbols.assign(&code, &along);
        let (first, known) = (
            self.loop_part_at_assembly(
                closure,
                |formulas, f| formulas.orientation_class(f) == classes[0],
                &[],
            ),
            self.known_part_at_assembly(group, closure, &[]),
        );
        let radicand = one.square.clone() / distance - square(&along);
        let across = self.signed_root(("h", &[&joint]), &radicand, known.cross(first));
        let r = [
            times(&along, &d[0]) - times(&across, &d[1]),
            times(&along, &d[1]) + times(&across, &d[0]),
        ];
        let r = self.assign_vector("r", &[&joint, "1"], &r);
        self.orient_class(classes[0], &r, &one);
        let rest = [0, 1].map(|i| -(d[i].clone()) - r[i].clone());
        let rest = self.assign_vector("r", &[&joint, "2"], &rest);
        self.orient_class(classes[1], &rest, &two);
    }

    /// Two steps for a vector.
    fn assign_vector(&mut self, letter: &str, below: &[&str], value: &Vector) -> Vector {
        ["x", "y"].map(|axis| {
            let mut names = below.to_vec();
            names.push(axis);
            let code = self.symbols.new_name(letter, &names);
            self.symbols.assign(&code, &value[usize::from(axis == "y")])
        })
    }

    /// A class turns and a slide travels until a loop closes.
    //
    // Long: the slide may turn with the class or not; both cases begin with the same known part.
    fn line_circle(&mut self, group: usize, class: usize, slide: usize, closure: usize) {
        let joint = self.loop_joint_name(closure);
        let but = [slide];
        let mut slide_terms = self.loops[closure].slide_terms.iter();
        let Some(slide_term) = slide_terms.find(|p| p.slide == slide).cloned() else {
            return;
        };
        let d = self.known_part(group, closure, &but);
        let u = self.direction(slide_term.frame, slide_term.local, "direction of travel");
        let along = slide_term.local.rotate(self.rotation[slide_term.frame]);
        let rotates_with_class = self.orientation_class(slide_term.frame) == class;
        let at_start = self.slide_travel[slide];
        let class_part_at_start = self.loop_part_at_assembly(
            closure,
            |formulas, f| formulas.orientation_class(f) == class,
            &but,
        );
        let known_at_start = self.known_part_at_assembly(group, closure, &but);
        if rotates_with_class {
            let w = self.loop_part(
                closure,
                |formulas, f| formulas.orientation_class(f) == class,
                |formulas, f| formulas.relative_angle(f),
                &but,
            );
            let u = rotate(&u, &self.relative_angle(slide_term.frame));
            let code = self.symbols.new_name("D", &[&joint]);
            let distance = self
                .symbols
                .assign(&code, &plus(&square(&d[0]), &square(&d[1])));
            let offset = cross(&w, &u);
            let branch = at_start + class_part_at_start.dot(along);
            let radicand = plus(&distance, &-square_of(&offset));
            let signed_root = self.signed_root(("g", &[&joint]), &radicand, branch);
            let code = self.travel_name(slide);
            let travel = self.symbols.assign(&code, &(signed_root - dot(&w, &u)));
            self.travels[slide] = Some(travel.clone());
            let reached = [0, 1].map(|i| plus(&w[i], &times(&u[i], &travel)));
            let mut polar = if w.iter().all(is_zero) && is_zero(&u[1]) {
                // The slide is the whole vector: its travel's sign is the branch.
                Polar {
                    square: distance,
                    angle: zero(),
                    angle_symbol: None,
                    sign: (slide_term.local.x * at_start).signum(),
                }
            } else {
                self.varying_polar(closure, self.plan.class_frame(class), &reached)
            };
            // What it reaches is the known part, reversed.
            polar.sign = -polar.sign;
            self.orient_class(class, &d, &polar);
        } else {
            let u = rotate(&u, &self.angle(slide_term.frame));
            let polar = self.polar(closure, class, &but);
            let offset = self.symbols.new_name("k", &[&joint]);
            let offset = self.symbols.assign(&offset, &cross(&d, &u));
            let branch = at_start + known_at_start.dot(along);
            let radicand = polar.square.clone() - square(&offset);
            let signed_root = self.signed_root(("g", &[&joint]), &radicand, branch);
            let code = self.travel_name(slide);
            let travel = self.symbols.assign(&code, &(signed_root - dot(&d, &u)));
            self.travels[slide] = Some(travel.clone());
            let r = [0, 1].map(|i| -(d[i].clone()) - times(&u[i], &travel));
            let r = self.assign_vector("r", &[&joint], &r);
            self.orient_class(class, &r, &polar);
        }
    }

    /// Notes the normal distance and the travel of a loop that closes along its normal only.
    fn close_along_normal(&mut self, closure: usize, normal: String, travel: &Term) {
        let joint = self.loop_joint_name(closure);
        let code = self.symbols.new_name("s", &[&joint]);
        let travel = self.symbols.assign(&code, travel);
        self.loop_symbols[closure].normal_distance = Some((normal, travel));
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

    /// A class turns until a point of its loop lies on a line.
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
        let code = self.symbols.new_name("kappa", &[&joint]);
        let offset = self.symbols.assign(&code, &-dot(&normal, &d));
        let own =
            self.loop_part_at_assembly(closure, |own, f| own.orientation_class(f) == class, &[]);
        let radicand = polar.square.clone() - square(&offset);
        let signed_root = self.signed_root(("g", &[&joint]), &radicand, own.dot(at_start));
        let travel = plus(&dot(&axis, &d), &signed_root);
        self.close_along_normal(closure, code, &travel);
        let level = axis == [number(1.0), number(0.0)];
        let r = if level {
            [signed_root, offset]
        } else {
            let r =
                [0, 1].map(|i| plus(&times(&axis[i], &signed_root), &times(&normal[i], &offset)));
            self.assign_vector("r", &[&joint], &r)
        };
        self.orient_class(class, &r, &polar);
    }

    /// A line turns with its class until it passes through a point.
    fn guided_point(&mut self, group: usize, class: usize, closure: usize, d: &Vector) {
        let joint = self.loop_joint_name(closure);
        let class_root = self.plan.class_frame(class);
        let w = self.loop_part(
            closure,
            |formulas, f| formulas.orientation_class(f) == class,
            |formulas, f| formulas.relative_angle(f),
            &[],
        );
        let (axis, at_start) = self.line_direction(closure, Self::relative_angle);
        let normal = perp(&axis);
        let kappa = self.symbols.new_name("kappa", &[&joint]);
        let offset = self.symbols.assign(&kappa, &-dot(&normal, &w));
        let passes = w.iter().all(is_zero);
        let branch = self
            .known_part_at_assembly(group, closure, &[])
            .dot(at_start);
        let code = self.symbols.new_name("D", &[&joint]);
        let distance = self
            .symbols
            .assign(&code, &plus(&square(&d[0]), &square(&d[1])));
        let radicand = if passes {
            distance.clone()
        } else {
            distance.clone() - square(&offset)
        };
        let along = self.signed_root(("g", &[&joint]), &radicand, branch);
        let travel = plus(&along, &dot(&axis, &w));
        self.close_along_normal(closure, kappa.clone(), &travel);
        let codes = [0, 1].map(|i| d[i].to_string());
        let mut partials = angle_partials(&codes, d, &distance);
        let name = self.frame_name(class_root);
        let mut angle = if passes {
            // ρ is √D here.
            partials.quotient_partials.push((kappa, -along));
            let [x, y] = [0, 1].map(|i| scale(&d[i], if branch < 0.0 { -1.0 } else { 1.0 }));
            atan2(y, x)
        } else {
            partials.quotient_partials.push((kappa, -along.clone()));
            partials
                .quotient_partials
                .push((along.to_string(), offset.clone()));
            atan2(d[1].clone(), d[0].clone()) - atan2(offset, along)
        };
        if let Some(line_angle) = self.line_angle(closure) {
            angle = angle - line_angle.0;
            partials.extra_partials.extend(line_angle.1);
        }
        let code = self.symbols.new_name("theta", &[&name]);
        let angle = self.symbols.assign_with_partials(&code, angle, partials);
        self.angles[class_root] = Some(angle);
    }

    /// The angle of a line in its class, with its slopes; none where it is the class's x axis.
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
        let k = self.next_number();
        let meaning = format!(
            "{}: direction of the guide, from its x axis",
            self.frame_name(frame)
        );
        let constant_angle =
            self.symbols
                .add_constant(("alpha", &[&k]), constant_angle, "rad", meaning);
        Some((plus(&constant_angle, &relative_angle), partials))
    }

    /// A slide travels until a point lies on a line.
    fn slide_to_line(&mut self, group: usize, slide: usize, closure: usize) {
        let joint = self.loop_joint_name(closure);
        let d = self.known_part(group, closure, &[slide]);
        let (axis, _) = self.line_direction(closure, Self::angle);
        let normal = perp(&axis);
        let u = self.slide_direction(closure, slide);
        let code = self.symbols.new_name("kappa", &[&joint]);
        let offset = self.symbols.assign(&code, &-dot(&normal, &d));
        let name = self.travel_name(slide);
        let travel = (offset / dot(&normal, &u)).simplify();
        let travel = self.symbols.assign(&name, &travel);
        self.travels[slide] = Some(travel.clone());
        let line_travel = plus(&dot(&axis, &d), &times(&dot(&axis, &u), &travel));
        self.close_along_normal(closure, code, &line_travel);
    }

    /// Two slides travel until a loop closes.
    fn two_slides(&mut self, group: usize, slides: [usize; 2], closure: usize) {
        let d = self.known_part(group, closure, &slides);
        let [one, two] = slides.map(|s| self.slide_direction(closure, s));
        let area = cross(&one, &two);
        let values = [-(cross(&d, &two) / area.clone()), -(cross(&one, &d) / area)];
        for (slide, value) in slides.into_iter().zip(values) {
            let name = self.travel_name(slide);
            self.travels[slide] = Some(self.symbols.assign(&name, &value));
        }
    }

    /// The direction in which a loop passes a slide.
    fn slide_direction(&mut self, closure: usize, slide: usize) -> Vector {
        let slide_terms = self.loops[closure].slide_terms.iter();
        let Some(slide_term) = slide_terms.clone().find(|p| p.slide == slide).cloned() else {
            return [zero(), zero()];
        };
        let u = self.direction(slide_term.frame, slide_term.local, "direction of travel");
        rotate(&u, &self.angle(slide_term.frame))
    }
}
