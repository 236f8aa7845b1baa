//! Positions as functions of the coordinate: the groups in their order, each a few named steps, then
//! the points that carry the bodies and their centres of mass.

use crate::algebra::{Term, cos, is_zero, number, plus, scaled, sin, symbol, times, zero};
use crate::chains::{Chain, Piece, between, bond_name, turned};
use crate::error::SymbolicError;
use crate::sheet::{Sheet, is_greek};
use dwell_geometry::frames::Turning;
use dwell_geometry::groups::Unknown;
use dwell_geometry::{BodyId, Mechanism, Plan, Vec2};
use dwell_kinetostatics::Mass;
use std::collections::HashMap;

/// A vector in the plane.
pub(crate) type Pair = [Term; 2];

/// Where a loop feels what shifts it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Closed {
    /// The steps of the known part of the loop.
    pub(crate) gap: Option<[String; 2]>,
    /// Where it closes along a normal only: the step of the normal distance that is left for what turns or
    /// travels, and the travel along the axis.
    pub(crate) normal: Option<(String, Term)>,
}

/// The positions of a mechanism.
#[derive(Debug, Clone)]
pub(crate) struct Positions<'a> {
    pub(crate) mechanism: &'a Mechanism,
    pub(crate) plan: &'a Plan,
    pub(crate) sheet: Sheet,
    /// The coordinate.
    pub(crate) q: Term,
    pub(crate) chains: Vec<Chain>,
    pub(crate) closed: Vec<Closed>,
    /// By relation: the step that solves it, and by what the relation grows with it.
    pub(crate) related: Vec<Option<(String, Term)>>,
    /// Numbers of relations: their size, whose they are, their names.
    pub(crate) weights: Vec<(f64, String, Term)>,
    /// By body: the steps of its root; none for the ground.
    pub(crate) roots: Vec<Option<[String; 2]>>,
    /// By body with mass: the steps of its centre.
    pub(crate) centres: Vec<Option<[String; 2]>>,
    /// What was found of angles and travels: by frame, and by slide.
    pub(crate) angles: Vec<Option<Term>>,
    pub(crate) travels: Vec<Option<Term>>,
    vectors: HashMap<(usize, u64, u64), Pair>,
    numbered: usize,
    /// The start, in numbers: which branch it is.
    pub(crate) turn: Vec<Vec2>,
    pub(crate) slide: Vec<f64>,
}

impl<'a> Positions<'a> {
    pub(crate) fn new(
        mechanism: &'a Mechanism,
        masses: &[Mass],
        plan: &'a Plan,
    ) -> Result<Self, SymbolicError> {
        let [actuator] = mechanism.actuators.as_slice() else {
            return Err(SymbolicError::Actuators(mechanism.actuators.len()));
        };
        let mut pose = plan.pose::<f64>();
        plan.place(plan.start(), &mut pose)?;
        let mut sheet = Sheet::default();
        let q = if is_greek(&actuator.name) {
            sheet.name(&actuator.name, &[])
        } else {
            sheet.name("q", &[&actuator.name])
        };
        let bodies = plan.frames().attitudes.len();
        let mut positions = Self {
            mechanism,
            plan,
            sheet,
            q: symbol(&q),
            chains: (0..plan.closures().len())
                .map(|c| Chain::of(mechanism, plan, c))
                .collect(),
            closed: vec![Closed::default(); plan.closures().len()],
            related: vec![None; plan.relations()],
            roots: vec![None; bodies],
            centres: vec![None; bodies],
            angles: vec![None; plan.frames().frames.len()],
            travels: vec![None; plan.tree().slides.len()],
            weights: Vec::new(),
            vectors: HashMap::new(),
            numbered: 0,
            turn: pose.turn,
            slide: pose.slide,
        };
        for (slide, driven) in plan.driven_slides().iter().enumerate() {
            if driven.is_some() {
                positions.travels[slide] = Some(positions.q.clone());
            }
        }
        for group in 0..plan.group_kinds().len() {
            positions.solve(group)?;
        }
        positions.carry(masses);
        Ok(positions)
    }

    /// The angle of a frame from the ground.
    pub(crate) fn angle(&self, frame: usize) -> Term {
        self.angle_from(frame, false)
    }

    /// The angle of a frame from the root of its class.
    pub(crate) fn relative(&self, frame: usize) -> Term {
        self.angle_from(frame, true)
    }

    fn angle_from(&self, frame: usize, root: bool) -> Term {
        let mut sum = zero();
        let mut at = frame;
        loop {
            match self.plan.frames().frames[at].turning {
                Turning::Ground => return sum,
                Turning::Unknown if root => return sum,
                Turning::Unknown => {
                    let own = self.angles[at].clone().unwrap_or_else(zero);
                    return plus(&own, &sum);
                }
                Turning::Driven { parent, sign, .. } => {
                    sum = plus(&scaled(&self.q, sign), &sum);
                    at = parent;
                }
            }
        }
    }

    pub(crate) fn class(&self, frame: usize) -> usize {
        self.plan.frames().frames[frame].class
    }

    /// What a frame is called: by the first body that turns with it, or the joint that added it.
    pub(crate) fn frame_name(&self, frame: usize) -> String {
        let attitudes = &self.plan.frames().attitudes;
        let named = self.mechanism.bodies.len();
        let level = (0..named)
            .find(|&b| attitudes[b].frame == frame && attitudes[b].offset == Vec2::IDENTITY);
        let any = level.or_else(|| (0..attitudes.len()).find(|&b| attitudes[b].frame == frame));
        any.map_or_else(String::new, |body| self.part_name(body))
    }

    /// The name of a body, or of the joint that added it.
    pub(crate) fn part_name(&self, body: usize) -> String {
        if body < self.mechanism.bodies.len() {
            return self.mechanism.body_name(BodyId(body)).to_owned();
        }
        let place = self.plan.tree().place[body];
        let bond = place.map(|p| self.plan.tree().carries[p].bond);
        bond.map_or_else(String::new, |b| bond_name(self.mechanism, self.plan, b))
    }

    /// What a piece of a loop is.
    pub(crate) fn meaning(&self, piece: &Piece) -> String {
        let [from, to] = &piece.between;
        format!("{}: from {from} to {to}", self.part_name(piece.body))
    }

    /// The next number for a constant.
    pub(crate) fn number(&mut self) -> String {
        self.numbered += 1;
        self.numbered.to_string()
    }

    /// A constant vector in its frame, by the names of its components, m.
    pub(crate) fn local(&mut self, frame: usize, local: Vec2, meaning: &str) -> Pair {
        // The same vector the other way round is no other constant.
        let back = local.x < 0.0 || (local.x == 0.0 && local.y < 0.0);
        let sign = if back { -1.0 } else { 1.0 };
        let forth = local * sign + Vec2::ZERO;
        let key = (frame, forth.x.to_bits(), forth.y.to_bits());
        let found = match self.vectors.get(&key) {
            Some(found) => found.clone(),
            None => {
                let found = self.constant_pair(forth, meaning);
                self.vectors.insert(key, found.clone());
                found
            }
        };
        found.map(|c| if is_zero(&c) { c } else { scaled(&c, sign) })
    }

    fn constant_pair(&mut self, local: Vec2, meaning: &str) -> Pair {
        if local == Vec2::ZERO {
            return [zero(), zero()];
        }
        let k = self.number();
        let meaning = meaning.to_owned();
        if local.y == 0.0 {
            let l = self.sheet.constant(("l", &[&k]), local.x, "m", meaning);
            return [l, zero()];
        }
        if local.x == 0.0 {
            let l = self
                .sheet
                .constant(("l", &[&k]), local.y, "m", meaning + ", across");
            return [zero(), l];
        }
        let along = format!("{meaning}, along its x axis");
        let across = format!("{meaning}, along its y axis");
        let u = self.sheet.constant(("u", &[&k]), local.x, "m", along);
        let v = self.sheet.constant(("v", &[&k]), local.y, "m", across);
        [u, v]
    }

    /// A constant direction in its frame.
    pub(crate) fn direction(&mut self, frame: usize, local: Vec2, meaning: &str) -> Pair {
        if local.y == 0.0 || local.x == 0.0 {
            return [number(local.x), number(local.y)];
        }
        let back = local.x < 0.0;
        let sign = if back { -1.0 } else { 1.0 };
        let forth = local * sign;
        // Directions and vectors of one metre are different things: the sign bit keeps them apart.
        let key = (frame, forth.x.to_bits(), !forth.y.to_bits());
        let found = match self.vectors.get(&key) {
            Some(found) => found.clone(),
            None => {
                let k = self.number();
                let angle = self.sheet.constant(
                    ("alpha", &[&k]),
                    forth.angle(),
                    "rad",
                    format!("{}: {meaning}, from its x axis", self.frame_name(frame)),
                );
                let found = [cos(&angle), sin(&angle)];
                self.vectors.insert(key, found.clone());
                found
            }
        };
        found.map(|c| scaled(&c, sign))
    }

    /// A loop's part on the frames that are picked, turned by `angle`, without the travel of the slides
    /// `but`.
    pub(crate) fn part(
        &mut self,
        closure: usize,
        pick: impl Fn(&Self, usize) -> bool,
        angle: impl Fn(&Self, usize) -> Term,
        but: &[usize],
    ) -> Pair {
        let chain = self.chains[closure].clone();
        let mut frames: Vec<(usize, Vec2, String)> = Vec::new();
        for piece in &chain.pieces {
            let meaning = self.meaning(piece);
            match frames.iter_mut().find(|f| f.0 == piece.frame) {
                Some((_, sum, words)) => {
                    let joined = *sum + piece.local;
                    let rounding = 4.0 * f64::EPSILON * (sum.norm() + piece.local.norm());
                    let clean = |d: f64| if d.abs() <= rounding { 0.0 } else { d };
                    *sum = dwell_geometry::vec2(clean(joined.x), clean(joined.y));
                    let name = bond_name(self.mechanism, self.plan, chain.bond);
                    *words = format!("{}: in the loop of {name}", self.frame_name(piece.frame));
                }
                None => frames.push((piece.frame, piece.local, meaning)),
            }
        }
        let mut sum = [zero(), zero()];
        for (frame, local, meaning) in frames {
            if pick(self, frame) {
                let pair = self.local(frame, local, &meaning);
                sum = add(&sum, &rotated(&pair, &angle(self, frame)));
            }
        }
        for passage in &chain.passages {
            if pick(self, passage.frame) && !but.contains(&passage.slide) {
                let along = self.direction(passage.frame, passage.local, "direction of travel");
                let along = rotated(&along, &angle(self, passage.frame));
                let travel = self.travels[passage.slide].clone().unwrap_or_else(zero);
                sum = add(&sum, &along.map(|c| times(&c, &travel)));
            }
        }
        sum
    }

    /// The same in numbers, at the start.
    pub(crate) fn part_at_start(
        &self,
        closure: usize,
        pick: impl Fn(&Self, usize) -> bool,
        but: &[usize],
    ) -> Vec2 {
        let chain = &self.chains[closure];
        let mut sum = Vec2::ZERO;
        for piece in chain.pieces.iter().filter(|p| pick(self, p.frame)) {
            sum += piece.local.turn(self.turn[piece.frame]);
        }
        let passages = chain.passages.iter();
        for passage in passages.filter(|p| pick(self, p.frame) && !but.contains(&p.slide)) {
            let along = passage.local.turn(self.turn[passage.frame]);
            sum += along * self.slide[passage.slide];
        }
        sum
    }

    /// The constant vector of a loop on the first frame of a class, where that is all it has of it.
    pub(crate) fn constant_part(
        &self,
        closure: usize,
        class: usize,
        but: &[usize],
    ) -> Option<Vec2> {
        let chain = &self.chains[closure];
        let root = self.plan.root_of(class);
        let mut own = chain.pieces.iter().filter(|p| self.class(p.frame) == class);
        let mut slides = chain.passages.iter();
        if slides.any(|p| self.class(p.frame) == class && !but.contains(&p.slide)) {
            return None;
        }
        own.try_fold(Vec2::ZERO, |sum, p| {
            (p.frame == root).then_some(sum + p.local)
        })
    }

    /// The ground, the bodies' roots and their centres of mass.
    fn carry(&mut self, masses: &[Mass]) {
        let tree = self.plan.tree();
        let frames = self.plan.frames();
        for carry in &tree.carries {
            let joint = bond_name(self.mechanism, self.plan, carry.bond);
            let bond = &self.plan.bonds()[carry.bond];
            let point = bond.points[usize::from(bond.bodies[0] != carry.parent)];
            let parent = carry.parent;
            let frame = frames.attitudes[parent].frame;
            let from = match self.roots[parent] {
                Some(_) => tree.roots[parent],
                // The ground's own coordinates tell where its points are.
                None => Vec2::ZERO,
            };
            let local = between(frames, parent, from, point);
            let reached = tree.place[parent].map(|p| tree.carries[p].bond);
            let start = reached.map(|b| bond_name(self.mechanism, self.plan, b));
            let start = start.unwrap_or_else(|| "the origin".to_owned());
            let arm = self.local(
                frame,
                local,
                &format!("{}: from {start} to {joint}", self.part_name(parent)),
            );
            let mut root = rotated(&arm, &self.angle(frame));
            if let Some(codes) = &self.roots[parent] {
                root = add(&[symbol(&codes[0]), symbol(&codes[1])], &root);
            }
            if let Some((slide, away)) = carry.slide {
                let own = frames.attitudes[carry.body].frame;
                let along = self.direction(own, away, "direction of travel");
                let along = rotated(&along, &self.angle(own));
                let travel = self.travels[slide].clone().unwrap_or_else(zero);
                root = add(&root, &along.map(|c| times(&c, &travel)));
            }
            self.roots[carry.body] = Some(self.point(&[&joint], &root));
        }
        for carry in &tree.carries {
            let Some(mass) = masses.get(carry.body).filter(|m| m.mass > 0.0) else {
                continue;
            };
            let (body, frame) = (carry.body, frames.attitudes[carry.body].frame);
            let local = between(frames, body, tree.roots[body], mass.center);
            let Some(root) = self.roots[body].clone() else {
                continue;
            };
            if local == Vec2::ZERO {
                self.centres[body] = Some(root);
                continue;
            }
            let joint = bond_name(self.mechanism, self.plan, carry.bond);
            let name = self.part_name(body);
            let meaning = format!("{name}: from {joint} to the centre of mass");
            let arm = self.local(frame, local, &meaning);
            let arm = rotated(&arm, &self.angle(frame));
            let centre = add(&[symbol(&root[0]), symbol(&root[1])], &arm);
            self.centres[body] = Some(self.point(&["G", &name], &centre));
        }
    }

    /// The two steps of a point.
    fn point(&mut self, below: &[&str], at: &Pair) -> [String; 2] {
        ["x", "y"].map(|letter| {
            let code = self.sheet.name(letter, below);
            self.sheet.step(&code, &at[usize::from(letter == "y")]);
            code
        })
    }

    /// The bodies and joints of a group that has no closed form.
    pub(crate) fn none(&self, group: usize, what: &'static str) -> SymbolicError {
        SymbolicError::Group {
            group,
            bodies: self.plan.group_bodies(group),
            joints: self.plan.group_joints(group),
            what,
        }
    }

    /// Names the travel of a slide that has been found.
    pub(crate) fn travel_name(&mut self, slide: usize) -> String {
        let bond = self.plan.tree().slides[slide];
        let name = bond_name(self.mechanism, self.plan, bond);
        self.sheet.name("s", &[&name])
    }

    /// Whether a frame turns with one of a group's unknowns.
    pub(crate) fn in_group(&self, group: usize, frame: usize) -> bool {
        let class = self.class(frame);
        let unknowns = &self.plan.group(group).unknowns;
        class > 0 && unknowns.contains(&Unknown::Class(class))
    }

    /// A constant direction of a bond's axis in its body, in its frame.
    pub(crate) fn in_frame(&self, body: usize, local: Vec2) -> (usize, Vec2) {
        let attitude = self.plan.frames().attitudes[body];
        (attitude.frame, turned(local, attitude.offset))
    }
}

pub(crate) fn add(a: &Pair, b: &Pair) -> Pair {
    [plus(&a[0], &b[0]), plus(&a[1], &b[1])]
}

/// A vector by a rotation.
pub(crate) fn rotated([x, y]: &Pair, angle: &Term) -> Pair {
    if is_zero(angle) {
        return [x.clone(), y.clone()];
    }
    let (c, s) = (cos(angle), sin(angle));
    [
        plus(&times(x, &c), &-times(y, &s)).simplify(),
        plus(&times(x, &s), &times(y, &c)).simplify(),
    ]
}

/// A vector turned by +90°.
pub(crate) fn perp([x, y]: &Pair) -> Pair {
    [(-y.clone()).simplify(), x.clone()]
}

pub(crate) fn dot(a: &Pair, b: &Pair) -> Term {
    plus(&times(&a[0], &b[0]), &times(&a[1], &b[1])).simplify()
}

pub(crate) fn cross(a: &Pair, b: &Pair) -> Term {
    plus(&times(&a[0], &b[1]), &-times(&a[1], &b[0])).simplify()
}
