//! The closed forms of the groups.

use crate::algebra::{
    Node, Term, atan2, is_zero, names, number, plus, scaled, sqrt, square, symbol, times, zero,
};
use crate::chains::bond_name;
use crate::error::SymbolicError;
use crate::positions::{Pair, Positions, cross, dot, perp, rotated};
use crate::sheet::Slopes;
use dwell_geometry::Vec2;
use dwell_geometry::groups::Unknown;

/// A vector that turns with a class: its squared length, and its angle in the class, rad, less that of
/// `sign` times it.
struct Polar {
    square: Term,
    angle: Term,
    /// The step of the angle, if it changes.
    varies: Option<String>,
    sign: f64,
}

impl Positions<'_> {
    /// Writes the steps of one group.
    pub(crate) fn solve(&mut self, group: usize) -> Result<(), SymbolicError> {
        let plan = self.plan;
        let parts = plan.group(group);
        if parts.rows != parts.unknowns.len() {
            return Err(self.none(group, "constraints repeat each other"));
        }
        let single = |closure: usize, slide: usize, own: &Self| {
            let passages = own.chains[closure].passages.iter();
            passages.filter(|p| p.slide == slide).count() == 1
        };
        match (
            parts.unknowns.as_slice(),
            parts.loops.as_slice(),
            parts.relations.as_slice(),
        ) {
            (&[unknown], &[], &[relation]) => self.relate(group, unknown, relation),
            (&[Unknown::Class(one), Unknown::Class(two)], &[c], &[])
                if self.chains[c].axis.is_none() =>
            {
                self.triangle(group, [one, two], c);
                Ok(())
            }
            (&[Unknown::Class(class), Unknown::Slide(slide)], &[c], &[])
                if self.chains[c].axis.is_none() && single(c, slide, self) =>
            {
                self.reach(group, class, slide, c);
                Ok(())
            }
            (&[Unknown::Class(class)], &[c], &[]) if self.chains[c].axis.is_some() => {
                self.guide(group, class, c);
                Ok(())
            }
            (&[Unknown::Slide(slide)], &[c], &[]) if self.chains[c].axis.is_some() => {
                self.travel(group, slide, c);
                Ok(())
            }
            (&[Unknown::Slide(one), Unknown::Slide(two)], &[c], &[])
                if single(c, one, self) && single(c, two, self) =>
            {
                self.travels(group, [one, two], c);
                Ok(())
            }
            (.., []) => Err(self.none(group, "they are no dyad")),
            _ => Err(self.none(group, "loops and relations are solved together")),
        }
    }

    fn joint(&self, closure: usize) -> String {
        bond_name(self.mechanism, self.plan, self.chains[closure].bond)
    }

    /// The steps of the part of a loop that is known before its group.
    fn gap(&mut self, group: usize, closure: usize, but: &[usize]) -> Pair {
        let known = self.part(
            closure,
            |own, f| !own.in_group(group, f),
            |own, f| own.angle(f),
            but,
        );
        let joint = self.joint(closure);
        let codes = ["x", "y"].map(|axis| self.sheet.name("d", &[&joint, axis]));
        let pair = [0, 1].map(|i| self.sheet.step(&codes[i], &known[i]));
        self.closed[closure].gap = Some(codes);
        pair
    }

    fn gap_at_start(&self, group: usize, closure: usize, but: &[usize]) -> Vec2 {
        self.part_at_start(closure, |own, f| !own.in_group(group, f), but)
    }

    /// ±√ of a term, the branch of the group as a constant.
    fn root(&mut self, (letter, below): (&str, &[&str]), radicand: &Term, branch: f64) -> Term {
        let joint = below.first().copied().unwrap_or_default().to_owned();
        let sign = self.sheet.constant(
            ("sigma", &[&joint]),
            if branch < 0.0 { -1.0 } else { 1.0 },
            "",
            format!("branch of the dyad that {joint} closes"),
        );
        let code = self.sheet.name(letter, below);
        let own = symbol(&code);
        let radicand = radicand.simplify();
        // Of h² = R the derivative is R′/2h.
        let half = |name: &String| {
            let slope = radicand.diff(name.as_str()) / number(2.0);
            (name.clone(), slope.simplify())
        };
        let slopes = Slopes {
            divided: names(&radicand).iter().map(half).collect(),
            over: own,
            beside: Vec::new(),
        };
        self.sheet
            .step_with(&code, sign * sqrt(radicand.clone()), slopes)
    }

    /// What a class has of a loop.
    fn polar(&mut self, closure: usize, class: usize, but: &[usize]) -> Polar {
        let root = self.plan.root_of(class);
        if let Some(local) = self.constant_part(closure, class, but) {
            let sign = if local.x < 0.0 || (local.x == 0.0 && local.y < 0.0) {
                -1.0
            } else {
                1.0
            };
            let pair = self.part(
                closure,
                |own, f| own.class(f) == class,
                |own, f| own.relative(f),
                but,
            );
            let square = plus(&square_of(&pair[0]), &square_of(&pair[1]));
            let name = self.frame_name(root);
            let angle = (local * sign).angle();
            let angle = if angle == 0.0 {
                zero()
            } else {
                let k = self.number();
                let meaning = format!(
                    "{name}: direction of its arm at {}, from its x axis",
                    self.joint(closure)
                );
                self.sheet.constant(("alpha", &[&k]), angle, "rad", meaning)
            };
            return Polar {
                square,
                angle,
                varies: None,
                sign,
            };
        }
        let part = self.part(
            closure,
            |own, f| own.class(f) == class,
            |own, f| own.relative(f),
            but,
        );
        self.changing(closure, root, &part)
    }

    /// A vector that changes in its class.
    fn changing(&mut self, closure: usize, root: usize, part: &Pair) -> Polar {
        let (joint, name) = (self.joint(closure), self.frame_name(root));
        let codes = ["x", "y"].map(|axis| self.sheet.name("w", &[&joint, &name, axis]));
        let pair = [0, 1].map(|i| self.sheet.step(&codes[i], &part[i]));
        let code = self.sheet.name("w", &[&joint, &name]);
        let square = self
            .sheet
            .step(&code, &plus(&square(&pair[0]), &square(&pair[1])));
        let code = self.sheet.name("epsilon", &[&joint, &name]);
        let slopes = turning(&codes, &pair, &square);
        let angle = atan2(pair[1].clone(), pair[0].clone());
        let angle = self.sheet.step_with(&code, angle, slopes);
        Polar {
            square,
            angle,
            varies: Some(code),
            sign: 1.0,
        }
    }

    /// Turns a class until its vector is the one in the steps `to`.
    fn turn(&mut self, class: usize, to: &Pair, polar: &Polar) {
        let root = self.plan.root_of(class);
        let name = self.frame_name(root);
        let code = self.sheet.name("theta", &[&name]);
        let codes = [0, 1].map(|i| to[i].to_string());
        let mut slopes = turning(&codes, to, &polar.square);
        if let Some(varies) = &polar.varies {
            slopes.beside.push((varies.clone(), number(-1.0)));
        }
        let [x, y] = [0, 1].map(|i| scaled(&to[i], polar.sign));
        let mut angle = atan2(y, x);
        if !is_zero(&polar.angle) {
            angle = angle - polar.angle.clone();
        }
        let angle = self.sheet.step_with(&code, angle, slopes);
        self.angles[root] = Some(angle);
    }

    /// Two classes whose vectors close a triangle with the known part of the loop.
    fn triangle(&mut self, group: usize, classes: [usize; 2], closure: usize) {
        let joint = self.joint(closure);
        let d = self.gap(group, closure, &[]);
        let [one, two] = classes.map(|class| self.polar(closure, class, &[]));
        let code = self.sheet.name("D", &[&joint]);
        let distance = self
            .sheet
            .step(&code, &plus(&square(&d[0]), &square(&d[1])));
        let code = self.sheet.name("f", &[&joint]);
        let excess = two.square.clone() - one.square.clone();
        let along = excess / (number(2.0) * distance.clone()) - number(0.5);
        let along = self.sheet.step(&code, &along);
        let (first, known) = (
            self.part_at_start(closure, |own, f| own.class(f) == classes[0], &[]),
            self.gap_at_start(group, closure, &[]),
        );
        let radicand = one.square.clone() / distance - square(&along);
        let across = self.root(("h", &[&joint]), &radicand, known.cross(first));
        let r = [
            times(&along, &d[0]) - times(&across, &d[1]),
            times(&along, &d[1]) + times(&across, &d[0]),
        ];
        let r = self.pair("r", &[&joint, "1"], &r);
        self.turn(classes[0], &r, &one);
        let rest = [0, 1].map(|i| -(d[i].clone()) - r[i].clone());
        let rest = self.pair("r", &[&joint, "2"], &rest);
        self.turn(classes[1], &rest, &two);
    }

    /// Two steps for a vector.
    fn pair(&mut self, letter: &str, below: &[&str], value: &Pair) -> Pair {
        ["x", "y"].map(|axis| {
            let mut names = below.to_vec();
            names.push(axis);
            let code = self.sheet.name(letter, &names);
            self.sheet.step(&code, &value[usize::from(axis == "y")])
        })
    }

    /// A class turns and a slide travels until a loop closes.
    fn reach(&mut self, group: usize, class: usize, slide: usize, closure: usize) {
        let joint = self.joint(closure);
        let but = [slide];
        let Some(passage) = self.chains[closure]
            .passages
            .iter()
            .find(|p| p.slide == slide)
            .cloned()
        else {
            return;
        };
        let d = self.gap(group, closure, &but);
        let u = self.direction(passage.frame, passage.local, "direction of travel");
        let along = passage.local.turn(self.turn[passage.frame]);
        let turns_too = self.class(passage.frame) == class;
        let at_start = self.slide[slide];
        let own_at_start = self.part_at_start(closure, |own, f| own.class(f) == class, &but);
        let known_at_start = self.gap_at_start(group, closure, &but);
        if turns_too {
            let w = self.part(
                closure,
                |own, f| own.class(f) == class,
                |own, f| own.relative(f),
                &but,
            );
            let u = rotated(&u, &self.relative(passage.frame));
            let code = self.sheet.name("D", &[&joint]);
            let distance = self
                .sheet
                .step(&code, &plus(&square(&d[0]), &square(&d[1])));
            let off = cross(&w, &u);
            let branch = at_start + own_at_start.dot(along);
            let radicand = plus(&distance, &-square_of(&off));
            let root = self.root(("g", &[&joint]), &radicand, branch);
            let code = self.travel_name(slide);
            let travel = self.sheet.step(&code, &(root - dot(&w, &u)));
            self.travels[slide] = Some(travel.clone());
            let reached = [0, 1].map(|i| plus(&w[i], &times(&u[i], &travel)));
            let mut polar = if w.iter().all(is_zero) && is_zero(&u[1]) {
                // The slide is the whole vector: its travel's sign is the branch.
                Polar {
                    square: distance,
                    angle: zero(),
                    varies: None,
                    sign: (passage.local.x * at_start).signum(),
                }
            } else {
                self.changing(closure, self.plan.root_of(class), &reached)
            };
            // What it reaches is what is known, the other way round.
            polar.sign = -polar.sign;
            self.turn(class, &d, &polar);
        } else {
            let u = rotated(&u, &self.angle(passage.frame));
            let polar = self.polar(closure, class, &but);
            let off = self.sheet.name("k", &[&joint]);
            let off = self.sheet.step(&off, &cross(&d, &u));
            let branch = at_start + known_at_start.dot(along);
            let radicand = polar.square.clone() - square(&off);
            let root = self.root(("g", &[&joint]), &radicand, branch);
            let code = self.travel_name(slide);
            let travel = self.sheet.step(&code, &(root - dot(&d, &u)));
            self.travels[slide] = Some(travel.clone());
            let r = [0, 1].map(|i| -(d[i].clone()) - times(&u[i], &travel));
            let r = self.pair("r", &[&joint], &r);
            self.turn(class, &r, &polar);
        }
    }

    /// Notes the normal distance and the travel of a loop that closes along its normal only.
    fn close(&mut self, closure: usize, normal: String, travel: &Term) {
        let joint = self.joint(closure);
        let code = self.sheet.name("s", &[&joint]);
        let travel = self.sheet.step(&code, travel);
        self.closed[closure].normal = Some((normal, travel));
    }

    /// The axis of a loop that closes along its normal only: its angle's frame and its direction.
    fn axis(&mut self, closure: usize, angle: impl Fn(&Self, usize) -> Term) -> (Pair, Vec2) {
        let (_, frame, local) = self.chains[closure].axis.unwrap_or((0, 0, Vec2::IDENTITY));
        let pair = self.direction(frame, local, "direction of the guide");
        let pair = rotated(&pair, &angle(self, frame));
        (pair, local.turn(self.turn[frame]))
    }

    /// A class turns until a point of its loop lies on a line.
    fn guide(&mut self, group: usize, class: usize, closure: usize) {
        let joint = self.joint(closure);
        let (_, frame, _) = self.chains[closure].axis.unwrap_or((0, 0, Vec2::IDENTITY));
        let d = self.gap(group, closure, &[]);
        if self.class(frame) == class {
            self.aim(group, class, closure, &d);
            return;
        }
        let (axis, at_start) = self.axis(closure, Self::angle);
        let normal = perp(&axis);
        let polar = self.polar(closure, class, &[]);
        let code = self.sheet.name("kappa", &[&joint]);
        let off = self.sheet.step(&code, &-dot(&normal, &d));
        let own = self.part_at_start(closure, |own, f| own.class(f) == class, &[]);
        let radicand = polar.square.clone() - square(&off);
        let root = self.root(("g", &[&joint]), &radicand, own.dot(at_start));
        let travel = plus(&dot(&axis, &d), &root);
        self.close(closure, code, &travel);
        let level = axis == [number(1.0), number(0.0)];
        let r = if level {
            [root, off]
        } else {
            let r = [0, 1].map(|i| plus(&times(&axis[i], &root), &times(&normal[i], &off)));
            self.pair("r", &[&joint], &r)
        };
        self.turn(class, &r, &polar);
    }

    /// A line turns with its class until it passes through a point.
    fn aim(&mut self, group: usize, class: usize, closure: usize, d: &Pair) {
        let joint = self.joint(closure);
        let root_frame = self.plan.root_of(class);
        let w = self.part(
            closure,
            |own, f| own.class(f) == class,
            |own, f| own.relative(f),
            &[],
        );
        let (axis, at_start) = self.axis(closure, Self::relative);
        let normal = perp(&axis);
        let kappa = self.sheet.name("kappa", &[&joint]);
        let off = self.sheet.step(&kappa, &-dot(&normal, &w));
        let passes = w.iter().all(is_zero);
        let branch = self.gap_at_start(group, closure, &[]).dot(at_start);
        let code = self.sheet.name("D", &[&joint]);
        let distance = self
            .sheet
            .step(&code, &plus(&square(&d[0]), &square(&d[1])));
        let radicand = if passes {
            distance.clone()
        } else {
            distance.clone() - square(&off)
        };
        let along = self.root(("g", &[&joint]), &radicand, branch);
        let travel = plus(&along, &dot(&axis, &w));
        self.close(closure, kappa.clone(), &travel);
        let codes = [0, 1].map(|i| d[i].to_string());
        let mut slopes = turning(&codes, d, &distance);
        let name = self.frame_name(root_frame);
        let mut angle = if passes {
            // ρ is √D here.
            slopes.divided.push((kappa, -along));
            let [x, y] = [0, 1].map(|i| scaled(&d[i], if branch < 0.0 { -1.0 } else { 1.0 }));
            atan2(y, x)
        } else {
            slopes.divided.push((kappa, -along.clone()));
            slopes.divided.push((along.to_string(), off.clone()));
            atan2(d[1].clone(), d[0].clone()) - atan2(off, along)
        };
        if let Some(turned) = self.axis_angle(closure) {
            angle = angle - turned.0;
            slopes.beside.extend(turned.1);
        }
        let code = self.sheet.name("theta", &[&name]);
        let angle = self.sheet.step_with(&code, angle, slopes);
        self.angles[root_frame] = Some(angle);
    }

    /// The angle of a line in its class, with its slopes; none where it is the class's x axis.
    fn axis_angle(&mut self, closure: usize) -> Option<(Term, Vec<(String, Term)>)> {
        let (_, frame, local) = self.chains[closure].axis?;
        let turned = self.relative(frame);
        let slopes = names(&turned)
            .iter()
            .map(|name| (name.clone(), -turned.diff(name.as_str())))
            .collect();
        let own = local.angle();
        if own == 0.0 {
            return (!is_zero(&turned)).then_some((turned, slopes));
        }
        let k = self.number();
        let meaning = format!(
            "{}: direction of the guide, from its x axis",
            self.frame_name(frame)
        );
        let own = self.sheet.constant(("alpha", &[&k]), own, "rad", meaning);
        Some((plus(&own, &turned), slopes))
    }

    /// A slide travels until a point lies on a line.
    fn travel(&mut self, group: usize, slide: usize, closure: usize) {
        let joint = self.joint(closure);
        let d = self.gap(group, closure, &[slide]);
        let (axis, _) = self.axis(closure, Self::angle);
        let normal = perp(&axis);
        let u = self.along(closure, slide);
        let code = self.sheet.name("kappa", &[&joint]);
        let off = self.sheet.step(&code, &-dot(&normal, &d));
        let name = self.travel_name(slide);
        let travel = (off / dot(&normal, &u)).simplify();
        let travel = self.sheet.step(&name, &travel);
        self.travels[slide] = Some(travel.clone());
        let travelled = plus(&dot(&axis, &d), &times(&dot(&axis, &u), &travel));
        self.close(closure, code, &travelled);
    }

    /// Two slides travel until a loop closes.
    fn travels(&mut self, group: usize, slides: [usize; 2], closure: usize) {
        let d = self.gap(group, closure, &slides);
        let [one, two] = slides.map(|s| self.along(closure, s));
        let area = cross(&one, &two);
        let values = [-(cross(&d, &two) / area.clone()), -(cross(&one, &d) / area)];
        for (slide, value) in slides.into_iter().zip(values) {
            let name = self.travel_name(slide);
            self.travels[slide] = Some(self.sheet.step(&name, &value));
        }
    }

    /// The direction in which a loop passes a slide.
    fn along(&mut self, closure: usize, slide: usize) -> Pair {
        let passages = self.chains[closure].passages.iter();
        let Some(passage) = passages.clone().find(|p| p.slide == slide).cloned() else {
            return [zero(), zero()];
        };
        let u = self.direction(passage.frame, passage.local, "direction of travel");
        rotated(&u, &self.angle(passage.frame))
    }
}

/// The slopes of an angle by the coordinates of what it points along.
fn turning(codes: &[String; 2], to: &Pair, square: &Term) -> Slopes {
    Slopes {
        over: square.clone(),
        divided: vec![
            (codes[1].clone(), to[0].clone()),
            (codes[0].clone(), -to[1].clone()),
        ],
        beside: Vec::new(),
    }
}

fn square_of(term: &Term) -> Term {
    match term.as_ref() {
        _ if is_zero(term) => zero(),
        Node::Neg(inner) => square(inner).simplify(),
        _ => square(term).simplify(),
    }
}
