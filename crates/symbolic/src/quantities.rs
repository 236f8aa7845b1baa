//! The results of closed forms, with their names, units and meanings.

use crate::algebra::{self, Term};
use crate::loops::pair_name;
use crate::positions::PositionFormulas;
use crate::symbol_table::{Assignment, SymbolTable};
use dwell_geometry::{BodyId, Reaction};
use std::collections::BTreeMap;

/// A result of a closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its name in code.
    pub code: String,
    /// Its name in LaTeX.
    pub latex: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its meaning, in words.
    pub meaning: String,
    /// Its origin in the plan.
    pub origin: QuantityOrigin,
}

/// The origin of a quantity in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuantityOrigin {
    /// The angle of a frame.
    Frame(usize),
    /// The travel of a slide.
    Slide(usize),
    /// The travel of a loop that closes along its normal only.
    Closure(usize),
    /// The joint origin of a body: its index, and 0 for x or 1 for y.
    JointOrigin(usize, usize),
    /// The centre of mass of a body: its index, and 0 for x or 1 for y.
    MassCentre(usize, usize),
    /// The coordinate.
    Coordinate,
    /// m, ½m′, a or b.
    Result,
}

impl PositionFormulas<'_> {
    pub(crate) fn coordinate(&self, symbols: &SymbolTable, code: &str) -> Quantity {
        let unit = if self.plan.is_angle(0) { "rad" } else { "m" };
        let meaning = format!("coordinate {}", self.mechanism.actuators[0].name);
        symbols.quantity(code.to_owned(), unit, meaning, QuantityOrigin::Coordinate)
    }

    /// Angles and travels, and the points of the bodies.
    pub(crate) fn quantities(
        &self,
        symbols: &SymbolTable,
        derivatives: &BTreeMap<String, Term>,
    ) -> Vec<Quantity> {
        let mut found = Vec::new();
        let mut add = |code, unit, meaning, of| {
            found.push(symbols.quantity(code, unit, meaning, of));
        };
        for (frame, angle) in self.angles.iter().enumerate() {
            if let Some(code) = angle.as_ref().and_then(symbol_name) {
                let meaning = format!("angle of {}", self.frame_name(frame));
                add(code, "rad", meaning, QuantityOrigin::Frame(frame));
            }
        }
        let travel = |pair| format!("travel of {}", pair_name(self.mechanism, self.plan, pair));
        for (slide, variable) in self.travels.iter().enumerate() {
            let actuator = self.plan.actuated_slides[slide];
            if let (Some(code), None) = (variable.as_ref().and_then(symbol_name), actuator) {
                let meaning = travel(self.plan.tree().slide_pairs[slide]);
                add(code, "m", meaning, QuantityOrigin::Slide(slide));
            }
        }
        for (c, loop_equation) in self.loops.iter().enumerate() {
            let distance = loop_equation.normal_distance.as_ref();
            if let Some(code) = distance.and_then(|n| symbol_name(&n.1)) {
                let meaning = travel(loop_equation.loop_joint);
                add(code, "m", meaning, QuantityOrigin::Closure(c));
            }
        }
        let joint_origin: fn(usize, usize) -> QuantityOrigin = QuantityOrigin::JointOrigin;
        let mass_centre = QuantityOrigin::MassCentre;
        let points = [
            (&self.joint_origins, "the point that carries", joint_origin),
            (&self.mass_centres, "the centre of mass of", mass_centre),
        ];
        for (points, what, of) in points {
            let named = points.iter().take(self.mechanism.bodies.len()).enumerate();
            for (body, point) in named.filter_map(|(body, point)| Some((body, point.as_ref()?))) {
                let codes = [0, 1].map(|k| point[k].to_string());
                let moves = codes.iter().any(|code| derivatives.contains_key(code));
                if !moves || found.iter().any(|q: &Quantity| q.code == codes[0]) {
                    continue;
                }
                for (k, (code, axis)) in codes.into_iter().zip(["x", "y"]).enumerate() {
                    let name = self.mechanism.body_name(BodyId(body));
                    let meaning = format!("{axis} of {what} {name}");
                    found.push(symbols.quantity(code, "m", meaning, of(body, k)));
                }
            }
        }
        found
    }
}

/// m, ½m′, a and b.
pub(crate) fn result_quantities(
    symbols: &SymbolTable,
    results: &[Assignment],
    reaction: Option<Reaction>,
    angle: bool,
) -> Vec<Quantity> {
    let moment = reaction.is_some_and(|r| r.component.unit() == "N m");
    let what = [
        "generalised inertia",
        "half its derivative",
        "what q̈ contributes to the reaction",
        "what q̇² contributes to the reaction",
    ];
    let units = match (angle, moment) {
        (true, true) => ["kg m²"; 4],
        (true, false) => ["kg m²", "kg m²", "kg m", "kg m"],
        (false, true) => ["kg", "kg/m", "kg m", "kg"],
        (false, false) => ["kg", "kg/m", "kg", "kg/m"],
    };
    let quantities = results.iter().zip(what).zip(units);
    quantities
        .map(|((assignment, what), unit)| {
            let code = assignment.code.clone();
            symbols.quantity(code, unit, what.to_owned(), QuantityOrigin::Result)
        })
        .collect()
}

impl SymbolTable {
    fn quantity(
        &self,
        code: String,
        unit: &'static str,
        meaning: String,
        origin: QuantityOrigin,
    ) -> Quantity {
        Quantity {
            latex: self.latex_names(&code),
            code,
            unit,
            meaning,
            origin,
        }
    }
}

/// The name of a term that is only a name.
fn symbol_name(term: &Term) -> Option<String> {
    match term.as_ref() {
        algebra::Node::Sym(name) => Some(name.clone()),
        _ => None,
    }
}
