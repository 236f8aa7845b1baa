//! The closed forms of a mechanism: positions, m, ½m′, and a and b of a reaction, as named steps.

use crate::algebra::{self, Term, number, plus, rate, square, symbol, times, zero};
use crate::chains::bond_name;
use crate::error::SymbolicError;
use crate::positions::Positions;
use crate::sheet::{Constant, Rate, Sheet, Step, needed};
use dwell_geometry::{BodyId, Mechanism, Plan, Reaction};
use dwell_kinetostatics::Mass;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A quantity that the forms give.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its name in code.
    pub code: String,
    /// Its name in LaTeX.
    pub latex: String,
    /// Its unit.
    pub unit: &'static str,
    /// What it is.
    pub meaning: String,
    /// What it is of, in terms of the plan.
    pub of: Of,
}

/// What a quantity is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// The angle of a frame.
    Frame(usize),
    /// The travel of a slide.
    Slide(usize),
    /// The travel of a loop that closes along its normal only.
    Closure(usize),
    /// The point that carries a body: x or y, 0 or 1.
    Root(usize, usize),
    /// The centre of mass of a body: x or y, 0 or 1.
    Centre(usize, usize),
    /// The coordinate.
    Coordinate,
    /// The inertia, or the reaction.
    Result,
}

/// What a part of the steps is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Angles, travels and points.
    Positions,
    /// Their first derivatives by the coordinate.
    First,
    /// Their second ones.
    Second,
    /// Virtual displacements: their derivatives by the released coordinate.
    Virtual,
    /// The results.
    Results,
}

/// The closed forms of a mechanism of one coordinate.
#[derive(Debug, Clone)]
pub struct Form {
    /// The coordinate: rad or m.
    pub coordinate: Quantity,
    /// The numbers of the scene that occur in it.
    pub constants: Vec<Constant>,
    /// What it gives: positions, then m and ½m′, then a and b of the reaction.
    pub quantities: Vec<Quantity>,
    /// The name of the reaction, if there is one.
    pub reaction: Option<String>,
    pub(crate) parts: Vec<(Part, Vec<Step>)>,
    pub(crate) sheet: Sheet,
}

/// A mechanism made of dyads, as symbols.
#[derive(Debug, Clone)]
pub struct Symbolic<'a> {
    positions: Positions<'a>,
    masses: Vec<Moving>,
}

/// A body with inertia, by the names of its constants.
#[derive(Debug, Clone)]
struct Moving {
    body: usize,
    mass: Option<Term>,
    inertia: Option<Term>,
}

impl<'a> Symbolic<'a> {
    /// Closed forms of the positions of a mechanism, one mass for each body.
    ///
    /// # Errors
    /// [`SymbolicError`] where it does not have one actuator, or a group is no dyad.
    pub fn new(
        mechanism: &'a Mechanism,
        masses: &[Mass],
        plan: &'a Plan,
    ) -> Result<Self, SymbolicError> {
        let mut positions = Positions::new(mechanism, masses, plan)?;
        let mut moving = Vec::new();
        for carry in &plan.tree().carries {
            let Some(mass) = masses.get(carry.body) else {
                continue;
            };
            let name = mechanism.body_name(BodyId(carry.body));
            let sheet = &mut positions.sheet;
            let mut named = |letter, value: f64, unit, what: &str| {
                let meaning = format!("{name}: {what}");
                (value > 0.0).then(|| sheet.constant((letter, &[name]), value, unit, meaning))
            };
            moving.push(Moving {
                body: carry.body,
                mass: named("m", mass.mass, "kg", "mass"),
                inertia: named(
                    "I",
                    mass.inertia,
                    "kg m²",
                    "moment of inertia about its centre of mass",
                ),
            });
        }
        moving.retain(|one| one.mass.is_some() || one.inertia.is_some());
        Ok(Self {
            positions,
            masses: moving,
        })
    }

    /// Positions, m and ½m′, and with a reaction its a and b: what q̈ and q̇² contribute to it
    /// (Jordi, Zayas and Cardona 2008; a = m₁₂, b = ∂m₁₂/∂q − ½ ∂m₁₁/∂q₂, the second coordinate q₂ being
    /// that of the released joint).
    ///
    /// # Errors
    /// [`SymbolicError::Reaction`] where the loads do not determine the reaction.
    pub fn form(&self, reaction: Option<Reaction>) -> Result<Form, SymbolicError> {
        let mut positions = self.positions.clone();
        let release = match reaction {
            Some(reaction) => {
                let all = positions.mechanism.reactions();
                let at = all.iter().position(|&r| r == reaction);
                if !at.is_some_and(|k| positions.plan.is_unique(k)) {
                    return Err(SymbolicError::Reaction(reaction));
                }
                Some(positions.release(reaction)?)
            }
            None => None,
        };
        let mut sheet = std::mem::take(&mut positions.sheet);
        let base = std::mem::take(&mut sheet.steps);
        let none = BTreeMap::new();
        let q = positions.q.to_string();
        let mut rates = BTreeMap::from([(q.clone(), number(1.0))]);
        let first = sheet.differentiate(&base, Rate::First, &mut rates, &none);
        let second = sheet.differentiate(&first, Rate::Second, &mut rates, &none);
        let mut virtuals = BTreeMap::new();
        let mut moved = Vec::new();
        if let Some(release) = &release {
            moved = sheet.differentiate(&base, Rate::Virtual, &mut virtuals, &release.shifts);
        }
        let derivatives = Rates {
            positions: &positions,
            by_q: &rates,
            moved: &virtuals,
            turned: release.as_ref().map(|r| r.turned.as_slice()),
        };
        let results = self.results(&mut sheet, &derivatives);
        let mut form = Form {
            coordinate: positions.coordinate(&sheet, &q),
            constants: Vec::new(),
            quantities: positions.quantities(&sheet, &rates),
            reaction: reaction.map(|r| positions.mechanism.reaction_name(r)),
            parts: vec![
                (Part::Positions, base),
                (Part::First, first),
                (Part::Second, second),
                (Part::Virtual, moved),
                (Part::Results, results.clone()),
            ],
            sheet,
        };
        let angle = positions.plan.is_angle(0);
        form.quantities
            .extend(inertial(&form.sheet, &results, reaction, angle));
        form.inline();
        form.prune();
        Ok(form)
    }

    /// m, ½m′, a and b as sums over the bodies.
    fn results(&self, sheet: &mut Sheet, rates: &Rates<'_>) -> Vec<Step> {
        let mut sums: [Term; 4] = std::array::from_fn(|_| zero());
        for one in &self.masses {
            let mut ways: Vec<(&Term, Vec<[Term; 3]>)> = Vec::new();
            if let Some(inertia) = &one.inertia {
                ways.push((inertia, vec![rates.of_angle(one.body)]));
            }
            if let (Some(mass), Some(centre)) = (&one.mass, &rates.positions.centres[one.body]) {
                let both = centre.iter().map(|code| rates.of(&symbol(code)));
                ways.push((mass, both.collect()));
            }
            for (weight, ways) in ways {
                let mut each: [Term; 4] = std::array::from_fn(|_| zero());
                for [first, second, moved] in &ways {
                    let products = [
                        times_square(first),
                        times(first, second),
                        times(first, moved),
                        times(second, moved),
                    ];
                    for (sum, product) in each.iter_mut().zip(products) {
                        *sum = plus(sum, &product);
                    }
                }
                for (sum, each) in sums.iter_mut().zip(each) {
                    *sum = plus(sum, &times(weight, &each));
                }
            }
        }
        let wanted = if rates.turned.is_some() { 4 } else { 2 };
        let names = [
            ("m", "m"),
            ("half_dm", "\\tfrac{1}{2} m'"),
            ("a", "a"),
            ("b", "b"),
        ];
        let mut steps = Vec::new();
        for ((code, latex), sum) in names.into_iter().zip(sums).take(wanted) {
            steps.push(Step {
                code: sheet.result(code, latex),
                value: sum.simplify(),
                slopes: None,
            });
        }
        steps
    }
}

/// The name that a plain derivative is.
fn own_name(term: &Term) -> Option<String> {
    match term.as_ref() {
        algebra::Node::Sym(name) => Some(name.clone()),
        _ => None,
    }
}

fn times_square(term: &Term) -> Term {
    if algebra::is_zero(term) {
        zero()
    } else {
        square(term).simplify()
    }
}

/// The derivatives of all steps.
struct Rates<'a> {
    positions: &'a Positions<'a>,
    /// Of steps and of their first derivatives.
    by_q: &'a BTreeMap<String, Term>,
    moved: &'a BTreeMap<String, Term>,
    turned: Option<&'a [f64]>,
}

impl Rates<'_> {
    /// First, second and virtual derivative of a term.
    fn of(&self, term: &Term) -> [Term; 3] {
        let first = rate(term, self.by_q);
        let second = rate(&first, self.by_q);
        [first, second, rate(term, self.moved)]
    }

    /// The same of a body's angle, which a released couple turns beside its frame.
    fn of_angle(&self, body: usize) -> [Term; 3] {
        let frame = self.positions.plan.frames().attitudes[body].frame;
        let [first, second, moved] = self.of(&self.positions.angle(frame));
        let beside = self.turned.map_or(0.0, |turned| turned[body]);
        [first, second, plus(&moved, &number(beside)).simplify()]
    }
}

impl Positions<'_> {
    fn coordinate(&self, sheet: &Sheet, code: &str) -> Quantity {
        let angle = self.plan.is_angle(0);
        Quantity {
            code: code.to_owned(),
            latex: sheet.latex(code),
            unit: if angle { "rad" } else { "m" },
            meaning: format!("coordinate {}", self.mechanism.actuators[0].name),
            of: Of::Coordinate,
        }
    }

    /// Angles and travels, and the points of the bodies.
    fn quantities(&self, sheet: &Sheet, moves: &BTreeMap<String, Term>) -> Vec<Quantity> {
        let quantity = |code: String, unit, meaning, of| Quantity {
            latex: sheet.latex(&code),
            code,
            unit,
            meaning,
            of,
        };
        let mut found = Vec::new();
        for (frame, angle) in self.angles.iter().enumerate() {
            if let Some(code) = angle.as_ref().and_then(own_name) {
                let meaning = format!("angle of {}", self.frame_name(frame));
                found.push(quantity(code, "rad", meaning, Of::Frame(frame)));
            }
        }
        for (slide, travel) in self.travels.iter().enumerate() {
            if let (Some(code), None) = (
                travel.as_ref().and_then(own_name),
                self.plan.driven_slides()[slide],
            ) {
                let bond = self.plan.tree().slides[slide];
                let name = bond_name(self.mechanism, self.plan, bond);
                let meaning = format!("travel of {name}");
                found.push(quantity(code, "m", meaning, Of::Slide(slide)));
            }
        }
        for (c, (closed, chain)) in self.closed.iter().zip(&self.chains).enumerate() {
            if let Some(code) = closed.normal.as_ref().and_then(|n| own_name(&n.1)) {
                let name = bond_name(self.mechanism, self.plan, chain.bond);
                let meaning = format!("travel of {name}");
                found.push(quantity(code, "m", meaning, Of::Closure(c)));
            }
        }
        let root: fn(usize, usize) -> Of = Of::Root;
        let points = [
            (&self.roots, "the point that carries", root),
            (&self.centres, "the centre of mass of", Of::Centre),
        ];
        for (points, what, of) in points {
            for (body, point) in points.iter().enumerate() {
                let (Some(point), true) = (point, body < self.mechanism.bodies.len()) else {
                    continue;
                };
                let known = |code: &String| found.iter().any(|q: &Quantity| q.code == *code);
                if !point.iter().any(|code| moves.contains_key(code)) || known(&point[0]) {
                    continue;
                }
                for (k, (code, axis)) in point.iter().zip(["x", "y"]).enumerate() {
                    let name = self.mechanism.body_name(BodyId(body));
                    let meaning = format!("{axis} of {what} {name}");
                    found.push(quantity(code.clone(), "m", meaning, of(body, k)));
                }
            }
        }
        found
    }
}

/// m, ½m′, a and b.
fn inertial(
    sheet: &Sheet,
    results: &[Step],
    reaction: Option<Reaction>,
    angle: bool,
) -> Vec<Quantity> {
    let moment = reaction.is_some_and(|r| r.component.unit() == "N m");
    let of_reaction = match (moment, angle) {
        (true, true) => "kg m²",
        (false, false) => "kg",
        _ => "kg m",
    };
    let what = [
        "generalised inertia",
        "half its derivative",
        "what q̈ contributes to the reaction",
        "what q̇² contributes to the reaction",
    ];
    let inertia = if angle { "kg m²" } else { "kg" };
    let per = if angle { "kg m²" } else { "kg/m" };
    let rate = match (moment, angle) {
        (_, true) => of_reaction,
        (true, false) => "kg",
        (false, false) => "kg/m",
    };
    let units = [inertia, per, of_reaction, rate];
    let quantities = results.iter().zip(what).zip(units);
    quantities
        .map(|((step, what), unit)| Quantity {
            code: step.code.clone(),
            latex: sheet.latex(&step.code),
            unit,
            meaning: what.to_owned(),
            of: Of::Result,
        })
        .collect()
}

impl Form {
    /// Puts what is only a number or another name into the terms that it occurs in.
    fn inline(&mut self) {
        let mut plain: BTreeMap<String, Term> = BTreeMap::new();
        for (_, steps) in &mut self.parts {
            for step in steps.iter_mut() {
                step.value = algebra::replaced(&step.value, &plain);
                if algebra::is_plain(&step.value) {
                    plain.insert(step.code.clone(), step.value.clone());
                }
            }
        }
    }

    /// Leaves out what no quantity needs.
    fn prune(&mut self) {
        let all: Vec<Step> = self.steps().cloned().collect();
        let wanted = self.quantities.iter().map(|q| q.code.clone());
        let kept = needed(&all, wanted);
        let kept: BTreeSet<&str> = kept.iter().map(|s| s.code.as_str()).collect();
        for (_, steps) in &mut self.parts {
            steps.retain(|step| kept.contains(step.code.as_str()));
        }
        self.parts.retain(|(_, steps)| !steps.is_empty());
        let mut used: Vec<String> = Vec::new();
        for step in self.steps() {
            used.extend(algebra::names(&step.value));
        }
        let constants = self.sheet.constants.iter();
        self.constants = constants
            .filter(|c| used.contains(&c.code))
            .cloned()
            .collect();
    }

    /// All steps in their order.
    pub(crate) fn steps(&self) -> impl Iterator<Item = &Step> {
        self.parts.iter().flat_map(|(_, steps)| steps)
    }

    /// The quantities at a coordinate, rad or m, in their order. Where the mechanism cannot be closed
    /// they are not numbers.
    pub fn evaluate(&self, q: f64) -> Vec<f64> {
        self.nudged(q, |_| 1.0)
    }

    /// How far the quantities move when the coordinate and the constants are off by a unit of rounding, each
    /// one way or the other: what no evaluation can know better.
    pub fn rounding(&self, q: f64) -> Vec<f64> {
        let plain = self.evaluate(q);
        let mut most = vec![0.0_f64; plain.len()];
        for pattern in [0b0110_1001_u32, 0b0011_0101, 0b0101_1100] {
            let nudge = |k: usize| {
                let up = pattern >> (k % 8) & 1 == 1;
                1.0 + if up { f64::EPSILON } else { -f64::EPSILON }
            };
            for (most, (value, plain)) in most
                .iter_mut()
                .zip(self.nudged(q, nudge).iter().zip(&plain))
            {
                *most = most.max((value - plain).abs());
            }
        }
        most
    }

    fn nudged(&self, q: f64, nudge: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut values: HashMap<&str, f64> = HashMap::new();
        values.insert(&self.coordinate.code, q * nudge(0));
        for (k, constant) in self.constants.iter().enumerate() {
            let by = if constant.unit.is_empty() {
                1.0
            } else {
                nudge(k + 1)
            };
            values.insert(&constant.code, constant.value * by);
        }
        for step in self.steps() {
            let value = algebra::value(&step.value, &values);
            values.insert(&step.code, value);
        }
        let of = |quantity: &Quantity| values.get(quantity.code.as_str()).copied();
        let quantities = self.quantities.iter();
        quantities.map(|q| of(q).unwrap_or(f64::NAN)).collect()
    }
}
