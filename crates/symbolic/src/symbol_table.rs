//! Constants and named assignments (steps), in the order of computation.

use crate::algebra::{self, Term, chain_rule, derivative, plus, symbol, times, zero};
use std::collections::{BTreeMap, HashMap};

/// A number of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// Its name in code.
    pub code: String,
    /// Its name in LaTeX.
    pub latex: String,
    /// Its value, SI.
    pub value: f64,
    /// Its unit; empty for a sign or a ratio.
    pub unit: &'static str,
    /// Its meaning, in words.
    pub meaning: String,
}

/// A named term of earlier names.
#[derive(Debug, Clone)]
pub(crate) struct Assignment {
    pub(crate) code: String,
    pub(crate) value: Term,
    /// Its partial derivatives, if known in a shorter form than differentiation gives.
    pub(crate) partials: Option<PartialDerivatives>,
}

impl Assignment {
    pub(crate) fn new(code: String, value: Term) -> Self {
        let partials = None;
        Self {
            code,
            value,
            partials,
        }
    }
}

/// The partial derivatives of a step by the names in it: of a root by its radicand, of an angle
/// by the components of its direction.
#[derive(Debug, Clone)]
pub(crate) struct PartialDerivatives {
    /// The common denominator of these.
    pub(crate) denominator: Term,
    pub(crate) quotient_partials: Vec<(String, Term)>,
    /// Further partial derivatives without denominator.
    pub(crate) extra_partials: Vec<(String, Term)>,
}

impl PartialDerivatives {
    fn derivative(&self, derivatives: &BTreeMap<String, Term>) -> Term {
        let quotient = chain_rule(self.quotient_partials.clone(), derivatives);
        let extra = chain_rule(self.extra_partials.clone(), derivatives);
        if algebra::is_zero(&quotient) {
            return extra;
        }
        plus(&(quotient / self.denominator.clone()).simplify(), &extra).simplify()
    }
}

/// Kinds of derivatives of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DerivativeKind {
    /// By the coordinate.
    First,
    /// Second derivative by the coordinate: the derivative of a first derivative.
    Second,
    /// By the released coordinate at its value zero: a virtual displacement.
    Virtual,
}

/// Constants and steps, with the LaTeX of their names.
#[derive(Debug, Clone, Default)]
pub(crate) struct SymbolTable {
    pub(crate) constants: Vec<Constant>,
    pub(crate) assignments: Vec<Assignment>,
    /// By name in code: letter and indices in LaTeX.
    latex_names: HashMap<String, (String, String)>,
}

impl SymbolTable {
    /// A unique name from a letter and its indices.
    pub(crate) fn new_name(&mut self, letter: &str, below: &[&str]) -> String {
        // A name in code contains letters and digits only.
        let base = [&[letter], below]
            .concat()
            .join("_")
            .replace(|c: char| !c.is_ascii_alphanumeric(), "_");
        let mut below: Vec<String> = below.iter().map(|part| upright(part)).collect();
        let mut code = base.clone();
        let mut suffix = 1;
        while self.latex_names.contains_key(&code) {
            suffix += 1;
            code = format!("{base}_{suffix}");
        }
        if suffix > 1 {
            below.push(suffix.to_string());
        }
        self.latex_names
            .insert(code.clone(), (greek(letter), below.join(",")));
        code
    }

    /// The name of a result.
    pub(crate) fn result_name(&mut self, code: &str, latex: &str) -> String {
        let name = (latex.to_owned(), String::new());
        self.latex_names.insert(code.to_owned(), name);
        code.to_owned()
    }

    /// A name in LaTeX.
    pub(crate) fn latex_names(&self, code: &str) -> String {
        match self.latex_names.get(code) {
            Some((letter, below)) if below.is_empty() => letter.clone(),
            Some((letter, below)) => format!("{letter}_{{{below}}}"),
            None => upright(code),
        }
    }

    /// The name of a name's derivative.
    pub(crate) fn derivative_name(&mut self, of: &str, kind: DerivativeKind) -> String {
        let (letter, below) = self
            .latex_names
            .get(of)
            .cloned()
            .unwrap_or_else(|| (upright(of), String::new()));
        let (mut code, letter) = match kind {
            DerivativeKind::First => (format!("{of}_d"), format!("{letter}'")),
            // Of a name that is a first derivative.
            DerivativeKind::Second => (format!("{of}d"), format!("{letter}'")),
            DerivativeKind::Virtual => (format!("{of}_v"), format!("\\delta {letter}")),
        };
        // The name of a body may equal that of another one's derivative.
        while self.latex_names.contains_key(&code) {
            code.push('_');
        }
        self.latex_names.insert(code.clone(), (letter, below));
        code
    }

    /// A number of the scene, by name.
    pub(crate) fn add_constant(
        &mut self,
        letter: &str,
        below: &[&str],
        value: f64,
        unit: &'static str,
        meaning: String,
    ) -> Term {
        let code = self.new_name(letter, below);
        self.constants.push(Constant {
            latex: self.latex_names(&code),
            code: code.clone(),
            value,
            unit,
            meaning,
        });
        symbol(&code)
    }

    /// Adds a step under a new name.
    pub(crate) fn assign(&mut self, letter: &str, below: &[&str], value: &Term) -> Term {
        let code = self.new_name(letter, below);
        let step = symbol(&code);
        self.assignments
            .push(Assignment::new(code, value.simplify()));
        step
    }

    /// Two steps for a vector.
    pub(crate) fn assign_vector(
        &mut self,
        letter: &str,
        below: &[&str],
        vector: &[Term; 2],
    ) -> [Term; 2] {
        let components = [("x", &vector[0]), ("y", &vector[1])];
        components.map(|(axis, value)| self.assign(letter, &[below, &[axis]].concat(), value))
    }

    /// Adds a step with known partial derivatives.
    pub(crate) fn assign_with_partials(
        &mut self,
        code: String,
        value: Term,
        partials: PartialDerivatives,
    ) -> Term {
        let step = symbol(&code);
        let partials = Some(partials);
        self.assignments.push(Assignment {
            code,
            value,
            partials,
        });
        step
    }

    /// Adds the derivatives of all steps as further steps, from the derivatives of the names in `rates`, which it extends,
    /// and the shifts of steps in `shifts`.
    pub(crate) fn differentiate(
        &mut self,
        of: &[Assignment],
        kind: DerivativeKind,
        derivatives: &mut BTreeMap<String, Term>,
        shifts: &BTreeMap<String, Term>,
    ) -> Vec<Assignment> {
        let mut found = Vec::new();
        for assignment in of {
            let mut value = match &assignment.partials {
                Some(partials) => partials.derivative(derivatives),
                None => quotient_derivative(assignment, derivatives)
                    .unwrap_or_else(|| derivative(&assignment.value, derivatives)),
            };
            if let Some(shift) = shifts.get(&assignment.code) {
                value = plus(&value, shift).simplify();
            }
            if algebra::is_zero(&value) {
                continue;
            }
            let code = self.derivative_name(&assignment.code, kind);
            let symbol_or_value = if algebra::is_atomic(&value) {
                value
            } else {
                found.push(Assignment::new(code.clone(), value));
                symbol(&code)
            };
            derivatives.insert(assignment.code.clone(), symbol_or_value);
        }
        found
    }
}

/// The derivative of y = N/D in terms of y: (N′ − y D′)/D, the shortest form.
fn quotient_derivative(
    assignment: &Assignment,
    derivatives: &BTreeMap<String, Term>,
) -> Option<Term> {
    let (above, below) = algebra::quotient(&assignment.value)?;
    let by_below = times(&symbol(&assignment.code), &derivative(&below, derivatives));
    let above = plus(&derivative(&above, derivatives), &-by_below).simplify();
    if algebra::is_zero(&above) {
        return Some(zero());
    }
    Some((above / below).simplify())
}

/// The letters that LaTeX knows by name.
const GREEK: [&str; 22] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "mu",
    "nu", "xi", "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega", "Delta",
];

/// Whether a word is the name of a Greek letter.
pub(crate) fn is_greek(word: &str) -> bool {
    GREEK.contains(&word)
}

fn greek(letter: &str) -> String {
    if letter == "phi" {
        "\\varphi".to_owned()
    } else if is_greek(letter) {
        format!("\\{letter}")
    } else {
        letter.to_owned()
    }
}

/// A word as an index: single letters and numbers as they are, words upright.
fn upright(word: &str) -> String {
    let is_word = word.chars().all(|c| c.is_ascii_alphanumeric());
    if word.chars().all(|c| c.is_ascii_digit()) || is_word && word.len() == 1 {
        return word.to_owned();
    }
    let style = if is_word { "mathrm" } else { "text" };
    format!("\\{style}{{{}}}", word.replace('_', "\\_"))
}
