//! Positions as functions of the coordinate: the groups in their order, each in a few named steps, then
//! the joint origins of the bodies and their centres of mass.

use crate::algebra::{Term, cos, is_zero, number, plus, scale, sin, square, symbol, times, zero};
use crate::error::SymbolicError;
use crate::loops::{
    LinkVector, LoopEquation, forward, pair_name, rotated_constant, vector_between,
    without_rounding,
};
use crate::symbol_table::{SymbolTable, is_greek};
use dwell_geometry::frames::RotationSource;
use dwell_geometry::groups::Unknown;
use dwell_geometry::tree::TreeJoint;
use dwell_geometry::{BodyId, Mechanism, Plan, Vec2};
use dwell_kinetostatics::Mass;
use std::collections::HashMap;

/// A vector in the plane.
pub(crate) type Vector = [Term; 2];

/// The positions of a mechanism.
#[derive(Debug, Clone)]
pub(crate) struct PositionFormulas<'a> {
    pub(crate) mechanism: &'a Mechanism,
    pub(crate) plan: &'a Plan,
    pub(crate) symbols: SymbolTable,
    /// The coordinate.
    pub(crate) q: Term,
    pub(crate) loops: Vec<LoopEquation>,
    /// By coupling: the step that it determines, and the derivative of the coupling by it.
    pub(crate) solved_couplings: Vec<Option<(Term, Term)>>,
    /// Coefficients of couplings: value, owner, name.
    pub(crate) coefficients: Vec<(f64, String, Term)>,
    /// By body: the steps of its joint origin; `None` for the ground.
    pub(crate) joint_origins: Vec<Option<Vector>>,
    /// By body with mass: the steps of its centre of mass.
    pub(crate) mass_centres: Vec<Option<Vector>>,
    /// The known angles by frame, and travels by slide.
    pub(crate) angles: Vec<Option<Term>>,
    pub(crate) travels: Vec<Option<Term>>,
    vectors: HashMap<(usize, u64, u64), Vector>,
    constant_count: usize,
    /// The start in numbers, which selects the branch.
    pub(crate) rotation: Vec<Vec2>,
    pub(crate) slide_travel: Vec<f64>,
}

impl<'a> PositionFormulas<'a> {
    pub(crate) fn new(
        mechanism: &'a Mechanism,
        masses: &[Mass],
        plan: &'a Plan,
    ) -> Result<Self, SymbolicError> {
        let [actuator] = mechanism.actuators.as_slice() else {
            return Err(SymbolicError::ActuatorCount(mechanism.actuators.len()));
        };
        let mut pose = plan.pose::<f64>();
        plan.positions(plan.assembly_coordinates(), &mut pose)?;
        let mut symbols = SymbolTable::default();
        let name = actuator.name.as_str();
        let q = if is_greek(name) {
            symbols.new_name(name, &[])
        } else {
            symbols.new_name("q", &[name])
        };
        let bodies = plan.frames().orientations.len();
        let mut positions = Self {
            mechanism,
            plan,
            symbols,
            q: symbol(&q),
            loops: (0..plan.loop_closures.len())
                .map(|c| LoopEquation::of(mechanism, plan, c))
                .collect(),
            solved_couplings: vec![None; plan.couplings.len()],
            joint_origins: vec![None; bodies],
            mass_centres: vec![None; bodies],
            angles: vec![None; plan.frames().frames.len()],
            travels: vec![None; plan.tree().slide_pairs.len()],
            coefficients: Vec::new(),
            vectors: HashMap::new(),
            constant_count: 0,
            rotation: pose.rotation,
            slide_travel: pose.slide_travel,
        };
        for (slide, actuator_index) in plan.actuated_slides.iter().enumerate() {
            if actuator_index.is_some() {
                positions.travels[slide] = Some(positions.q.clone());
            }
        }
        for group in 0..plan.group_methods().len() {
            positions.solve_group(group)?;
        }
        positions.body_positions(masses);
        Ok(positions)
    }

    /// The angle of a frame from the ground.
    pub(crate) fn angle(&self, frame: usize) -> Term {
        self.angle_from(frame, false)
    }

    /// The angle of a frame from the class frame.
    pub(crate) fn relative_angle(&self, frame: usize) -> Term {
        self.angle_from(frame, true)
    }

    fn angle_from(&self, frame: usize, to_class_root: bool) -> Term {
        let mut sum = zero();
        let mut at = frame;
        loop {
            match self.plan.frames().frames[at].rotation_source {
                RotationSource::Ground => return sum,
                RotationSource::Unknown if to_class_root => return sum,
                RotationSource::Unknown => {
                    let class_angle = self.angles[at].clone().unwrap_or_else(zero);
                    return plus(&class_angle, &sum);
                }
                RotationSource::Actuated { parent, sign, .. } => {
                    sum = plus(&scale(&self.q, sign), &sum);
                    at = parent;
                }
            }
        }
    }

    pub(crate) fn orientation_class(&self, frame: usize) -> usize {
        self.plan.frames().frames[frame].orientation_class
    }

    /// The name of a frame: that of the first body that rotates with it, or of the joint that added it.
    pub(crate) fn frame_name(&self, frame: usize) -> String {
        let attitudes = &self.plan.frames().orientations;
        let named = self.mechanism.bodies.len();
        let level = (0..named)
            .find(|&b| attitudes[b].frame == frame && attitudes[b].offset == Vec2::IDENTITY);
        let any = level.or_else(|| (0..attitudes.len()).find(|&b| attitudes[b].frame == frame));
        any.map_or_else(String::new, |body| self.body_or_joint_name(body))
    }

    /// The name of a body, or of the joint that added it.
    pub(crate) fn body_or_joint_name(&self, body: usize) -> String {
        if body < self.mechanism.bodies.len() {
            return self.mechanism.body_name(BodyId(body)).to_owned();
        }
        let tree_position = self.plan.tree().joint_of_body[body];
        let pair = tree_position.map(|p| self.plan.tree().joints[p].pair);
        pair.map_or_else(String::new, |b| pair_name(self.mechanism, self.plan, b))
    }

    /// The meaning of a link vector, in words.
    pub(crate) fn meaning(&self, link_vector: &LinkVector) -> String {
        let [from, to] = &link_vector.joints;
        format!(
            "{}: from {from} to {to}",
            self.body_or_joint_name(link_vector.body)
        )
    }

    /// The next number for a constant.
    fn next_number(&mut self) -> String {
        self.constant_count += 1;
        self.constant_count.to_string()
    }

    /// A constant by a letter and the next number.
    pub(crate) fn numbered_constant(
        &mut self,
        letter: &str,
        value: f64,
        unit: &'static str,
        meaning: String,
    ) -> Term {
        let k = self.next_number();
        let symbols = &mut self.symbols;
        symbols.add_constant(letter, &[&k], value, unit, meaning)
    }

    /// The vector of a key, created once.
    fn cached_vector(
        &mut self,
        key: (usize, u64, u64),
        make: impl FnOnce(&mut Self) -> Vector,
    ) -> Vector {
        if let Some(found) = self.vectors.get(&key) {
            return found.clone();
        }
        let made = make(self);
        self.vectors.insert(key, made.clone());
        made
    }

    /// A constant vector in its frame, by the names of its components, m.
    pub(crate) fn frame_vector(&mut self, frame: usize, local: Vec2, meaning: &str) -> Vector {
        let (forth, sign) = forward(local);
        let key = (frame, forth.x.to_bits(), forth.y.to_bits());
        let found = self.cached_vector(key, |own| own.constant_vector(forth, meaning));
        found.map(|c| if is_zero(&c) { c } else { scale(&c, sign) })
    }

    fn constant_vector(&mut self, local: Vec2, meaning: &str) -> Vector {
        if local == Vec2::ZERO {
            return [zero(), zero()];
        }
        let k = self.next_number();
        let mut named = |letter, value, what| {
            let meaning = format!("{meaning}{what}");
            let symbols = &mut self.symbols;
            symbols.add_constant(letter, &[&k], value, "m", meaning)
        };
        match (local.x == 0.0, local.y == 0.0) {
            (_, true) => [named("l", local.x, ""), zero()],
            (true, false) => [zero(), named("l", local.y, ", across")],
            (false, false) => [
                named("u", local.x, ", along its x axis"),
                named("v", local.y, ", along its y axis"),
            ],
        }
    }

    /// A constant direction in its frame.
    pub(crate) fn direction(&mut self, frame: usize, local: Vec2, meaning: &str) -> Vector {
        if local.y == 0.0 || local.x == 0.0 {
            return [number(local.x), number(local.y)];
        }
        let (forth, sign) = forward(local);
        // The sign bit distinguishes directions from vectors of one metre.
        let key = (frame, forth.x.to_bits(), !forth.y.to_bits());
        let found = self.cached_vector(key, |own| {
            let meaning = format!("{}: {meaning}, from its x axis", own.frame_name(frame));
            let angle = own.numbered_constant("alpha", forth.angle(), "rad", meaning);
            [cos(&angle), sin(&angle)]
        });
        found.map(|c| scale(&c, sign))
    }

    /// The direction of a slide's travel, from the ground.
    pub(crate) fn travel_direction(&mut self, frame: usize, local: Vec2) -> Vector {
        let along = self.direction(frame, local, "direction of travel");
        rotate(&along, &self.angle(frame))
    }

    /// The known travel of a slide.
    pub(crate) fn travel(&self, slide: usize) -> Term {
        self.travels[slide].clone().unwrap_or_else(zero)
    }

    /// Adds a step for the travel of a slide.
    pub(crate) fn assign_travel(&mut self, slide: usize, value: &Term) -> Term {
        let pair = self.plan.tree().slide_pairs[slide];
        let name = pair_name(self.mechanism, self.plan, pair);
        let travel = self.symbols.assign("s", &[&name], value);
        self.travels[slide] = Some(travel.clone());
        travel
    }

    /// The part of a loop that rotates with a class, in the class frame, without the travel of the slides `but`.
    pub(crate) fn class_part(&mut self, closure: usize, class: usize, but: &[usize]) -> Vector {
        let pick = |own: &Self, frame| own.orientation_class(frame) == class;
        self.loop_part(closure, pick, Self::relative_angle, but)
    }

    /// The numerical value of this part at the start.
    pub(crate) fn class_part_at_assembly(
        &self,
        closure: usize,
        class: usize,
        but: &[usize],
    ) -> Vec2 {
        let pick = |own: &Self, frame| own.orientation_class(frame) == class;
        self.loop_part_at_assembly(closure, pick, but)
    }

    /// The part of a loop on selected frames, rotated by `angle`, without the travel of the slides
    /// `but`.
    pub(crate) fn loop_part(
        &mut self,
        closure: usize,
        pick: impl Fn(&Self, usize) -> bool,
        angle: impl Fn(&Self, usize) -> Term,
        but: &[usize],
    ) -> Vector {
        let loop_equation = self.loops[closure].clone();
        let mut frames: Vec<(usize, Vec2, String)> = Vec::new();
        for link_vector in &loop_equation.link_vectors {
            let meaning = self.meaning(link_vector);
            match frames.iter_mut().find(|f| f.0 == link_vector.frame) {
                Some((_, sum, meaning_text)) => {
                    let terms = sum.norm() + link_vector.local.norm();
                    *sum = without_rounding(*sum + link_vector.local, terms);
                    let name = pair_name(self.mechanism, self.plan, loop_equation.loop_joint);
                    *meaning_text = format!(
                        "{}: in the loop of {name}",
                        self.frame_name(link_vector.frame)
                    );
                }
                None => frames.push((link_vector.frame, link_vector.local, meaning)),
            }
        }
        let mut sum = [zero(), zero()];
        for (frame, local, meaning) in frames {
            if pick(self, frame) {
                let vector = self.frame_vector(frame, local, &meaning);
                sum = add(&sum, &rotate(&vector, &angle(self, frame)));
            }
        }
        for slide_term in &loop_equation.slide_terms {
            if pick(self, slide_term.frame) && !but.contains(&slide_term.slide) {
                let along =
                    self.direction(slide_term.frame, slide_term.local, "direction of travel");
                let along = rotate(&along, &angle(self, slide_term.frame));
                let travel = self.travel(slide_term.slide);
                sum = add(&sum, &along.map(|c| times(&c, &travel)));
            }
        }
        sum
    }

    /// The numerical value of this part at the start.
    pub(crate) fn loop_part_at_assembly(
        &self,
        closure: usize,
        pick: impl Fn(&Self, usize) -> bool,
        but: &[usize],
    ) -> Vec2 {
        let loop_equation = &self.loops[closure];
        let mut sum = Vec2::ZERO;
        let link_vectors = loop_equation.link_vectors.iter();
        for link_vector in link_vectors.filter(|p| pick(self, p.frame)) {
            sum += link_vector.local.rotate(self.rotation[link_vector.frame]);
        }
        let slide_terms = loop_equation.slide_terms.iter();
        for slide_term in slide_terms.filter(|p| pick(self, p.frame) && !but.contains(&p.slide)) {
            let along = slide_term.local.rotate(self.rotation[slide_term.frame]);
            sum += along * self.slide_travel[slide_term.slide];
        }
        sum
    }

    /// The constant vector of a loop on the first frame of a class, if the class has no other part of the loop.
    pub(crate) fn constant_loop_part(
        &self,
        closure: usize,
        class: usize,
        but: &[usize],
    ) -> Option<Vec2> {
        let loop_equation = &self.loops[closure];
        let class_root = self.plan.class_frame(class);
        let in_class = |frame| self.orientation_class(frame) == class;
        let mut slide_terms = loop_equation.slide_terms.iter();
        if slide_terms.any(|p| in_class(p.frame) && !but.contains(&p.slide)) {
            return None;
        }
        let link_vectors = loop_equation.link_vectors.iter();
        let mut link_vectors = link_vectors.filter(|p| in_class(p.frame));
        link_vectors.try_fold(Vec2::ZERO, |sum, p| {
            (p.frame == class_root).then_some(sum + p.local)
        })
    }

    /// The bodies' joint origins and their centres of mass.
    fn body_positions(&mut self, masses: &[Mass]) {
        let tree = self.plan.tree();
        let frames = self.plan.frames();
        for tree_joint in &tree.joints {
            let joint = pair_name(self.mechanism, self.plan, tree_joint.pair);
            let pair = &self.plan.pairs()[tree_joint.pair];
            let point = pair.points[usize::from(pair.bodies[0] != tree_joint.parent)];
            let parent = tree_joint.parent;
            let frame = frames.orientations[parent].frame;
            let from = match self.joint_origins[parent] {
                Some(_) => tree.joint_origins[parent],
                // The points of the ground are given by its own coordinates.
                None => Vec2::ZERO,
            };
            let local = vector_between(frames, parent, from, point);
            let reached = tree.joint_of_body[parent].map(|p| tree.joints[p].pair);
            let start = reached
                .map(|b| pair_name(self.mechanism, self.plan, b))
                .unwrap_or_else(|| "the origin".to_owned());
            let name = self.body_or_joint_name(parent);
            let arm = self.frame_vector(frame, local, &format!("{name}: from {start} to {joint}"));
            let mut joint_origin = rotate(&arm, &self.angle(frame));
            if let Some(parent_origin) = &self.joint_origins[parent] {
                joint_origin = add(parent_origin, &joint_origin);
            }
            let travel = self.joint_travel(tree_joint);
            let joint_origin = add(&joint_origin, &travel);
            self.joint_origins[tree_joint.body] = Some(self.assign_point(&[&joint], &joint_origin));
        }
        for tree_joint in &tree.joints {
            let Some(mass) = masses.get(tree_joint.body).filter(|m| m.mass > 0.0) else {
                continue;
            };
            let (body, frame) = (tree_joint.body, frames.orientations[tree_joint.body].frame);
            let local = vector_between(frames, body, tree.joint_origins[body], mass.center);
            let Some(joint_origin) = self.joint_origins[body].clone() else {
                continue;
            };
            if local == Vec2::ZERO {
                self.mass_centres[body] = Some(joint_origin);
                continue;
            }
            let joint = pair_name(self.mechanism, self.plan, tree_joint.pair);
            let name = self.body_or_joint_name(body);
            let meaning = format!("{name}: from {joint} to the centre of mass");
            let arm = self.frame_vector(frame, local, &meaning);
            let arm = rotate(&arm, &self.angle(frame));
            let centre = add(&joint_origin, &arm);
            self.mass_centres[body] = Some(self.assign_point(&["G", &name], &centre));
        }
    }

    /// The vector of a tree joint's travel, from the ground.
    pub(crate) fn joint_travel(&mut self, tree_joint: &TreeJoint) -> Vector {
        let Some((slide, away)) = tree_joint.slide else {
            return [zero(), zero()];
        };
        let frame = self.plan.frames().orientations[tree_joint.body].frame;
        let along = self.travel_direction(frame, away);
        along.map(|c| times(&c, &self.travel(slide)))
    }

    /// The two steps of a point.
    fn assign_point(&mut self, below: &[&str], [x, y]: &Vector) -> Vector {
        [("x", x), ("y", y)].map(|(letter, value)| self.symbols.assign(letter, below, value))
    }

    /// The bodies and joints of a group that has no closed form.
    pub(crate) fn unsupported(&self, group: usize, what: &'static str) -> SymbolicError {
        SymbolicError::Group {
            group,
            bodies: self.plan.group_bodies(group),
            joints: self.plan.group_joints(group),
            what,
        }
    }

    /// Whether a frame rotates with an unknown of a group.
    pub(crate) fn in_group(&self, group: usize, frame: usize) -> bool {
        let class = self.orientation_class(frame);
        let unknowns = &self.plan.group(group).unknowns;
        class > 0 && unknowns.contains(&Unknown::ClassAngle(class))
    }

    /// A constant direction of the axis of a pair in its body, in its frame.
    pub(crate) fn to_frame(&self, body: usize, local: Vec2) -> (usize, Vec2) {
        let orientation = self.plan.frames().orientations[body];
        (
            orientation.frame,
            rotated_constant(local, orientation.offset),
        )
    }
}

pub(crate) fn add(a: &Vector, b: &Vector) -> Vector {
    [plus(&a[0], &b[0]), plus(&a[1], &b[1])]
}

/// A rotated vector.
pub(crate) fn rotate([x, y]: &Vector, angle: &Term) -> Vector {
    if is_zero(angle) {
        return [x.clone(), y.clone()];
    }
    let (c, s) = (cos(angle), sin(angle));
    [
        plus(&times(x, &c), &-times(y, &s)).simplify(),
        plus(&times(x, &s), &times(y, &c)).simplify(),
    ]
}

/// A vector rotated by +90°.
pub(crate) fn perp([x, y]: &Vector) -> Vector {
    [(-y.clone()).simplify(), x.clone()]
}

/// The square of a vector's length.
pub(crate) fn square_norm([x, y]: &Vector) -> Term {
    plus(&square(x), &square(y))
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> Term {
    plus(&times(&a[0], &b[0]), &times(&a[1], &b[1])).simplify()
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Term {
    plus(&times(&a[0], &b[1]), &-times(&a[1], &b[0])).simplify()
}
