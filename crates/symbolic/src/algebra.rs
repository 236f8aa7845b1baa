//! Terms: the one place that knows the crate they come from.

use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A term and its kinds, a named quantity, a number, functions, and what several terms share: each part with a new
/// name, and what is left of the terms.
pub(crate) use arael_sym::{
    E as Term, Expr as Node, atan2, constant as number, cse as common_subexpressions, sqrt, symbol,
};

/// What is nothing.
pub(crate) fn zero() -> Term {
    number(0.0)
}

pub(crate) fn cos(angle: &Term) -> Term {
    arael_sym::cos(angle.clone())
}

pub(crate) fn sin(angle: &Term) -> Term {
    arael_sym::sin(angle.clone())
}

pub(crate) fn square(term: &Term) -> Term {
    arael_sym::pow(term.clone(), 2.0)
}

/// A product; a factor of one or nothing leaves no trace.
pub(crate) fn times(a: &Term, b: &Term) -> Term {
    (a.clone() * b.clone()).simplify()
}

/// A sum; what is nothing leaves no trace.
pub(crate) fn plus(a: &Term, b: &Term) -> Term {
    if is_zero(a) {
        return b.clone();
    }
    if is_zero(b) {
        return a.clone();
    }
    a.clone() + b.clone()
}

/// A term times ±1 or another number.
pub(crate) fn scale(term: &Term, by: f64) -> Term {
    if by == 1.0 {
        term.clone()
    } else if by == -1.0 {
        -term.clone()
    } else {
        number(by) * term.clone()
    }
}

pub(crate) fn is_zero(term: &Term) -> bool {
    matches!(term.as_ref(), Node::Const(value) if *value == 0.0)
}

/// Whether a term is so short that a name for it would only hide it.
pub(crate) fn is_atomic(term: &Term) -> bool {
    match term.as_ref() {
        Node::Sym(_) | Node::Const(_) => true,
        Node::Neg(inner) => matches!(inner.as_ref(), Node::Sym(_) | Node::Const(_)),
        _ => false,
    }
}

/// What stands above and below, if a term is a quotient.
pub(crate) fn quotient(term: &Term) -> Option<(Term, Term)> {
    match term.as_ref() {
        Node::Div(above, below) => Some((above.clone(), below.clone())),
        Node::Neg(inner) => match inner.as_ref() {
            Node::Div(above, below) => Some((-above.clone(), below.clone())),
            _ => None,
        },
        _ => None,
    }
}

/// A term in which names stand for what they are; squares lose the signs of what they are of.
pub(crate) fn substitute(term: &Term, replacements: &BTreeMap<String, Term>) -> Term {
    let mut value = term.clone();
    for name in names(term) {
        if let Some(replacements) = replacements.get(&name) {
            value = value.subs(name.as_str(), replacements);
        }
    }
    let squares = value.map_nodes(&mut |node| match node.as_ref() {
        Node::Pow(base, exponent) => match (base.as_ref(), exponent.as_ref()) {
            (Node::Neg(inner), Node::Const(n)) if *n == 2.0 => Some(square(inner)),
            _ => None,
        },
        _ => None,
    });
    squares.simplify()
}

/// The names that occur in a term.
pub(crate) fn names(term: &Term) -> BTreeSet<String> {
    term.free_vars()
}

/// The derivative of a term by everything in it that has a rate: Σ ∂term/∂x · rate of x.
pub(crate) fn derivative(term: &Term, derivatives: &BTreeMap<String, Term>) -> Term {
    let all = names(term).into_iter();
    let varying = all.filter(|name| derivatives.contains_key(name));
    let partials = varying.map(|name| {
        let partial = term.diff(name.as_str());
        (name, partial)
    });
    chain_rule(partials, derivatives)
}

/// Σ partial derivative by x · rate of x.
pub(crate) fn chain_rule(
    partials: impl IntoIterator<Item = (String, Term)>,
    derivatives: &BTreeMap<String, Term>,
) -> Term {
    let mut sum = zero();
    for (name, partial) in partials {
        if let Some(rate) = derivatives.get(&name) {
            sum = plus(&sum, &times(&partial, rate));
        }
    }
    sum.simplify()
}

/// A term's value; not a number where a name in it has none.
pub(crate) fn value(term: &Term, values: &HashMap<&str, f64>) -> f64 {
    term.eval(values).unwrap_or(f64::NAN)
}
