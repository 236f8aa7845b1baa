//! Constants and named steps, one below the other, as on a sheet of paper.

use crate::algebra::{self, Term, plus, rate, symbol, times, zero};
use std::collections::{BTreeMap, BTreeSet, HashMap};

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
    /// What it is.
    pub meaning: String,
}

/// A named quantity: a term of what stands above it.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub(crate) code: String,
    pub(crate) value: Term,
    /// Its derivatives, where they are known in a shorter form than differentiation gives.
    pub(crate) slopes: Option<Slopes>,
}

/// The derivatives of a step by the names it is made of: that of a root by what is under it, of an angle
/// by the coordinates of what it points along.
#[derive(Debug, Clone)]
pub(crate) struct Slopes {
    /// What these are divided by.
    pub(crate) over: Term,
    pub(crate) divided: Vec<(String, Term)>,
    /// Those that nothing divides.
    pub(crate) beside: Vec<(String, Term)>,
}

impl Slopes {
    fn rate(&self, rates: &BTreeMap<String, Term>) -> Term {
        let divided = chain(&self.divided, rates);
        let beside = chain(&self.beside, rates);
        if algebra::is_zero(&divided) {
            return beside;
        }
        plus(&(divided / self.over.clone()).simplify(), &beside).simplify()
    }
}

/// What a name's derivative is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rate {
    /// By the coordinate.
    First,
    /// By the coordinate, of what is a derivative already.
    Second,
    /// By the released coordinate, at zero of it: a virtual displacement.
    Virtual,
}

/// Constants, steps and how their names are written.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sheet {
    pub(crate) constants: Vec<Constant>,
    pub(crate) steps: Vec<Step>,
    /// By name in code: letter and indices in LaTeX.
    latex: HashMap<String, (String, String)>,
}

impl Sheet {
    /// A name that nothing else has: a letter and what stands below it.
    pub(crate) fn name(&mut self, letter: &str, below: &[&str]) -> String {
        let mut code = letter.to_owned();
        for part in below {
            code.push('_');
            code.extend(part.chars().map(plain));
        }
        let mut below: Vec<String> = below.iter().map(|part| upright(part)).collect();
        let bare = code.clone();
        let mut times = 1;
        while self.latex.contains_key(&code) {
            times += 1;
            code = format!("{bare}_{times}");
        }
        if times > 1 {
            below.push(times.to_string());
        }
        self.latex
            .insert(code.clone(), (greek(letter), below.join(",")));
        code
    }

    /// The name of a result.
    pub(crate) fn result(&mut self, code: &str, latex: &str) -> String {
        let name = (latex.to_owned(), String::new());
        self.latex.insert(code.to_owned(), name);
        code.to_owned()
    }

    /// A name in LaTeX.
    pub(crate) fn latex(&self, code: &str) -> String {
        match self.latex.get(code) {
            Some((letter, below)) if below.is_empty() => letter.clone(),
            Some((letter, below)) => format!("{letter}_{{{below}}}"),
            None => upright(code),
        }
    }

    /// The name of a name's derivative.
    pub(crate) fn rate_name(&mut self, of: &str, rate: Rate) -> String {
        let (letter, below) = self
            .latex
            .get(of)
            .cloned()
            .unwrap_or_else(|| (upright(of), String::new()));
        let (mut code, letter) = match rate {
            Rate::First => (format!("{of}_d"), format!("{letter}'")),
            // Of a name that is a first derivative.
            Rate::Second => (format!("{of}d"), format!("{letter}'")),
            Rate::Virtual => (format!("{of}_v"), format!("\\delta {letter}")),
        };
        // A body may be called like another one's derivative.
        while self.latex.contains_key(&code) {
            code.push('_');
        }
        self.latex.insert(code.clone(), (letter, below));
        code
    }

    /// A number of the scene, by name.
    pub(crate) fn constant(
        &mut self,
        (letter, below): (&str, &[&str]),
        value: f64,
        unit: &'static str,
        meaning: String,
    ) -> Term {
        let code = self.name(letter, below);
        self.constants.push(Constant {
            latex: self.latex(&code),
            code: code.clone(),
            value,
            unit,
            meaning,
        });
        symbol(&code)
    }

    /// Writes a step down.
    pub(crate) fn step(&mut self, code: &str, value: &Term) -> Term {
        self.steps.push(Step {
            code: code.to_owned(),
            value: value.simplify(),
            slopes: None,
        });
        symbol(code)
    }

    /// Writes a step down whose derivatives are known.
    pub(crate) fn step_with(&mut self, code: &str, value: Term, slopes: Slopes) -> Term {
        self.steps.push(Step {
            code: code.to_owned(),
            value,
            slopes: Some(slopes),
        });
        symbol(code)
    }

    /// The derivative of every step so far that has one, as further steps: by the names in `rates`,
    /// to which it adds, and by what `shifts` adds to a step itself.
    pub(crate) fn differentiate(
        &mut self,
        of: &[Step],
        kind: Rate,
        rates: &mut BTreeMap<String, Term>,
        shifts: &BTreeMap<String, Term>,
    ) -> Vec<Step> {
        let mut found = Vec::new();
        for step in of {
            let mut value = match &step.slopes {
                Some(slopes) => slopes.rate(rates),
                None => quotient(step, rates).unwrap_or_else(|| rate(&step.value, rates)),
            };
            if let Some(shift) = shifts.get(&step.code) {
                value = plus(&value, shift).simplify();
            }
            if algebra::is_zero(&value) {
                continue;
            }
            let code = self.rate_name(&step.code, kind);
            let own = if algebra::is_plain(&value) {
                value
            } else {
                found.push(Step {
                    code: code.clone(),
                    value,
                    slopes: None,
                });
                symbol(&code)
            };
            rates.insert(step.code.clone(), own);
        }
        found
    }
}

/// The derivative of y = N/D by its own name: (N′ − y D′)/D, which stays as short as it can.
fn quotient(step: &Step, rates: &BTreeMap<String, Term>) -> Option<Term> {
    let (above, below) = algebra::quotient(&step.value)?;
    let by_below = times(&symbol(&step.code), &rate(&below, rates));
    let above = plus(&rate(&above, rates), &-by_below).simplify();
    if algebra::is_zero(&above) {
        return Some(zero());
    }
    Some((above / below).simplify())
}

fn chain(slopes: &[(String, Term)], rates: &BTreeMap<String, Term>) -> Term {
    let mut sum = zero();
    for (name, slope) in slopes {
        if let Some(rate) = rates.get(name) {
            sum = plus(&sum, &times(slope, rate));
        }
    }
    sum.simplify()
}

/// The steps that the terms named need, in their order.
pub(crate) fn needed(steps: &[Step], wanted: impl IntoIterator<Item = String>) -> Vec<Step> {
    let mut wanted: BTreeSet<String> = wanted.into_iter().collect();
    let mut kept: Vec<Step> = Vec::new();
    for step in steps.iter().rev() {
        if wanted.contains(&step.code) {
            wanted.extend(algebra::names(&step.value));
            kept.push(step.clone());
        }
    }
    kept.reverse();
    kept
}

/// A character that a name in code may hold.
fn plain(c: char) -> char {
    if c.is_ascii_alphanumeric() { c } else { '_' }
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
    let mut chars = word.chars();
    if let (Some(c), None) = (chars.next(), chars.next())
        && c.is_ascii_alphanumeric()
    {
        return word.to_owned();
    }
    if word.chars().all(|c| c.is_ascii_digit()) {
        return word.to_owned();
    }
    let style = if word.chars().all(|c| c.is_ascii_alphanumeric()) {
        "mathrm"
    } else {
        "text"
    };
    format!("\\{style}{{{}}}", word.replace('_', "\\_"))
}
