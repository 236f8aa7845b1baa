//! The closed forms of a mechanism: positions, m, ½m′, and a and b of a reaction, as named steps.

use crate::algebra::{self, Term, derivative, number, plus, square, times, zero};
use crate::error::SymbolicError;
use crate::positions::PositionFormulas;
use crate::quantities::{Quantity, result_quantities};
use crate::symbol_table::{Assignment, Constant, DerivativeKind, SymbolTable};
use dwell_geometry::{BodyId, Mechanism, Plan, Reaction};
use dwell_kinetostatics::Mass;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The sections of a closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormulaSection {
    /// Angles, travels and points.
    Positions,
    /// Their first derivatives by the coordinate.
    FirstDerivatives,
    /// Their second derivatives by the coordinate.
    SecondDerivatives,
    /// Virtual displacements: the derivatives of the positions by the released coordinate.
    VirtualDisplacements,
    /// The results.
    Results,
}

/// The closed forms of a mechanism of one coordinate.
#[derive(Debug, Clone)]
pub struct ClosedForm {
    /// The coordinate: rad or m.
    pub coordinate: Quantity,
    /// The numbers of the scene that occur in it.
    pub constants: Vec<Constant>,
    /// Its results: positions, then m and ½m′, then a and b of the reaction.
    pub quantities: Vec<Quantity>,
    /// The name of the reaction, if there is one.
    pub reaction: Option<String>,
    pub(crate) sections: Vec<(FormulaSection, Vec<Assignment>)>,
    pub(crate) symbols: SymbolTable,
}

/// A mechanism made of dyads, as symbols.
#[derive(Debug, Clone)]
pub struct Symbolic<'a> {
    positions: PositionFormulas<'a>,
    masses: Vec<SymbolicMass>,
}

/// A body with inertia, with the names of its constants.
#[derive(Debug, Clone)]
struct SymbolicMass {
    body: usize,
    mass: Option<Term>,
    inertia: Option<Term>,
}

impl<'a> Symbolic<'a> {
    /// Closed forms of the positions of a mechanism, one mass for each body.
    ///
    /// # Errors
    /// [`SymbolicError`] if it does not have exactly one actuator, or a group is no dyad.
    pub fn new(
        mechanism: &'a Mechanism,
        masses: &[Mass],
        plan: &'a Plan,
    ) -> Result<Self, SymbolicError> {
        let mut positions = PositionFormulas::new(mechanism, masses, plan)?;
        let moment_of_inertia = "moment of inertia about its centre of mass";
        let mut inertial_bodies = Vec::new();
        for tree_joint in &plan.tree().joints {
            let Some(mass) = masses.get(tree_joint.body) else {
                continue;
            };
            let name = mechanism.body_name(BodyId(tree_joint.body));
            let symbols = &mut positions.symbols;
            let mut named = |letter, value: f64, unit, what: &str| {
                let meaning = format!("{name}: {what}");
                (value > 0.0).then(|| symbols.add_constant(letter, &[name], value, unit, meaning))
            };
            inertial_bodies.push(SymbolicMass {
                body: tree_joint.body,
                mass: named("m", mass.mass, "kg", "mass"),
                inertia: named("I", mass.inertia, "kg m²", moment_of_inertia),
            });
        }
        inertial_bodies.retain(|one| one.mass.is_some() || one.inertia.is_some());
        Ok(Self {
            positions,
            masses: inertial_bodies,
        })
    }

    /// Positions, m and ½m′, and for a reaction its coefficients a and b of q̈ and q̇²
    /// (Jordi, Zayas and Cardona 2008; a = m₁₂, b = ∂m₁₂/∂q − ½ ∂m₁₁/∂q₂, with the coordinate q₂
    /// of the released joint).
    ///
    /// # Errors
    /// [`SymbolicError::Reaction`] if equilibrium does not determine the reaction.
    pub fn closed_form(&self, reaction: Option<Reaction>) -> Result<ClosedForm, SymbolicError> {
        let mut positions = self.positions.clone();
        let release = reaction.map(|r| positions.release(r)).transpose()?;
        let mut symbols = std::mem::take(&mut positions.symbols);
        let base = std::mem::take(&mut symbols.assignments);
        let none = BTreeMap::new();
        let q = positions.q.to_string();
        let mut by_coordinate = BTreeMap::from([(q.clone(), number(1.0))]);
        let first = symbols.differentiate(&base, DerivativeKind::First, &mut by_coordinate, &none);
        let second =
            symbols.differentiate(&first, DerivativeKind::Second, &mut by_coordinate, &none);
        let mut by_release = BTreeMap::new();
        let shifts = release.as_ref().map(|release| &release.shifts);
        let virtual_assignments = shifts.map_or_else(Vec::new, |shifts| {
            symbols.differentiate(&base, DerivativeKind::Virtual, &mut by_release, shifts)
        });
        let derivatives = Derivatives {
            positions: &positions,
            by_q: &by_coordinate,
            virtual_displacements: &by_release,
            extra_rotation: release.as_ref().map(|r| r.extra_rotation.as_slice()),
        };
        let results = self.results(&mut symbols, &derivatives);
        let mut closed_form = ClosedForm {
            coordinate: positions.coordinate(&symbols, &q),
            constants: Vec::new(),
            quantities: positions.quantities(&symbols, &by_coordinate),
            reaction: reaction.map(|r| positions.mechanism.reaction_name(r)),
            sections: vec![
                (FormulaSection::Positions, base),
                (FormulaSection::FirstDerivatives, first),
                (FormulaSection::SecondDerivatives, second),
                (FormulaSection::VirtualDisplacements, virtual_assignments),
                (FormulaSection::Results, results.clone()),
            ],
            symbols,
        };
        let angle = positions.plan.is_angle(0);
        let found = result_quantities(&closed_form.symbols, &results, reaction, angle);
        closed_form.quantities.extend(found);
        closed_form.inline();
        closed_form.prune();
        Ok(closed_form)
    }

    /// m, ½m′, a and b as sums over the bodies.
    fn results(&self, symbols: &mut SymbolTable, derivatives: &Derivatives<'_>) -> Vec<Assignment> {
        let mut sums: [Term; 4] = std::array::from_fn(|_| zero());
        for one in &self.masses {
            let mut displacements: Vec<(&Term, Vec<[Term; 3]>)> = Vec::new();
            if let Some(inertia) = &one.inertia {
                displacements.push((inertia, vec![derivatives.of_angle(one.body)]));
            }
            if let (Some(mass), Some(centre)) =
                (&one.mass, &derivatives.positions.mass_centres[one.body])
            {
                let both = centre.iter().map(|step| derivatives.of_term(step));
                displacements.push((mass, both.collect()));
            }
            for (weight, displacements) in displacements {
                let mut body_sums: [Term; 4] = std::array::from_fn(|_| zero());
                for [first, second, virtual_displacement] in &displacements {
                    let products = [
                        square(first),
                        times(first, second),
                        times(first, virtual_displacement),
                        times(second, virtual_displacement),
                    ];
                    for (sum, product) in body_sums.iter_mut().zip(products) {
                        *sum = plus(sum, &product);
                    }
                }
                for (sum, body_sums) in sums.iter_mut().zip(body_sums) {
                    *sum = plus(sum, &times(weight, &body_sums));
                }
            }
        }
        let released = derivatives.extra_rotation.is_some();
        let names = ["m", "half_dm", "a", "b"];
        let latex = ["m", "\\tfrac{1}{2} m'", "a", "b"];
        let results = names.into_iter().zip(latex).zip(sums);
        results
            .take(if released { 4 } else { 2 })
            .map(|((code, latex), sum)| {
                Assignment::new(symbols.result_name(code, latex), sum.simplify())
            })
            .collect()
    }
}

/// The derivatives of all steps.
struct Derivatives<'a> {
    positions: &'a PositionFormulas<'a>,
    /// By name: first derivatives of steps, and second ones of first derivatives.
    by_q: &'a BTreeMap<String, Term>,
    virtual_displacements: &'a BTreeMap<String, Term>,
    extra_rotation: Option<&'a [f64]>,
}

impl Derivatives<'_> {
    /// First and second derivative and virtual displacement of a term.
    fn of_term(&self, term: &Term) -> [Term; 3] {
        let first = derivative(term, self.by_q);
        let second = derivative(&first, self.by_q);
        [first, second, derivative(term, self.virtual_displacements)]
    }

    /// First and second derivative and virtual displacement of a body's angle; a released couple rotates the body from its frame.
    fn of_angle(&self, body: usize) -> [Term; 3] {
        let frame = self.positions.plan.frames().orientations[body].frame;
        let mut derivatives = self.of_term(&self.positions.angle(frame));
        let extra = self.extra_rotation.map_or(0.0, |turned| turned[body]);
        derivatives[2] = plus(&derivatives[2], &number(extra)).simplify();
        derivatives
    }
}

impl ClosedForm {
    /// Replaces names of numbers and of other names by what they stand for.
    fn inline(&mut self) {
        let mut atomic: BTreeMap<String, Term> = BTreeMap::new();
        for (_, assignments) in &mut self.sections {
            for assignment in assignments.iter_mut() {
                assignment.value = algebra::substitute(&assignment.value, &atomic);
                if algebra::is_atomic(&assignment.value) {
                    atomic.insert(assignment.code.clone(), assignment.value.clone());
                }
            }
        }
    }

    /// Removes steps that no quantity needs.
    fn prune(&mut self) {
        let quantities = self.quantities.iter();
        let mut needed: BTreeSet<String> = quantities.map(|q| q.code.clone()).collect();
        for (_, assignments) in self.sections.iter_mut().rev() {
            for assignment in assignments.iter().rev() {
                if needed.contains(&assignment.code) {
                    needed.extend(algebra::names(&assignment.value));
                }
            }
            assignments.retain(|assignment| needed.contains(&assignment.code));
        }
        self.sections
            .retain(|(_, assignments)| !assignments.is_empty());
        let constants = self.symbols.constants.iter();
        let used = constants.filter(|c| needed.contains(&c.code));
        self.constants = used.cloned().collect();
    }

    /// All steps in their order.
    pub(crate) fn assignments(&self) -> impl Iterator<Item = &Assignment> {
        self.sections.iter().flat_map(|(_, steps)| steps)
    }

    /// The values of the quantities at a coordinate, rad or m, in their order. NaN if the mechanism cannot be
    /// assembled there.
    pub fn evaluate(&self, q: f64) -> Vec<f64> {
        self.perturbed(q, |_| 1.0)
    }

    /// The changes of the quantities when the coordinate and all constants change by one unit in the last place, in
    /// either direction: a bound of the attainable accuracy.
    pub fn rounding_error(&self, q: f64) -> Vec<f64> {
        let value_at = self.evaluate(q);
        let mut largest = vec![0.0_f64; value_at.len()];
        for pattern in [0b0110_1001_u32, 0b0011_0101, 0b0101_1100] {
            let perturb = |k: usize| {
                let up = pattern >> (k % 8) & 1 == 1;
                1.0 + if up { f64::EPSILON } else { -f64::EPSILON }
            };
            let moved = self.perturbed(q, perturb).into_iter().zip(&value_at);
            for (largest, (value, value_at)) in largest.iter_mut().zip(moved) {
                *largest = largest.max((value - value_at).abs());
            }
        }
        largest
    }

    fn perturbed(&self, q: f64, perturb: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut values: HashMap<&str, f64> = HashMap::new();
        values.insert(&self.coordinate.code, q * perturb(0));
        for (k, constant) in self.constants.iter().enumerate() {
            let exact = constant.unit.is_empty();
            let by = if exact { 1.0 } else { perturb(k + 1) };
            values.insert(&constant.code, constant.value * by);
        }
        for assignment in self.assignments() {
            let value = algebra::value(&assignment.value, &values);
            values.insert(&assignment.code, value);
        }
        let of = |quantity: &Quantity| values.get(quantity.code.as_str()).copied();
        let quantities = self.quantities.iter();
        quantities.map(|q| of(q).unwrap_or(f64::NAN)).collect()
    }
}
