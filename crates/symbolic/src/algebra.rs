//! Terms. Only this module depends on the crate arael-sym.

use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Terms and their kinds, named quantities, numbers, functions, and common subexpressions: each with a new
/// name, and the terms that remain.
pub(crate) use arael_sym::{
    E as Term, Expr as Node, atan2, constant as number, cse as common_subexpressions, sqrt, symbol,
};

/// The term 0.
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

/// A product; factors of one and zero are simplified.
pub(crate) fn times(a: &Term, b: &Term) -> Term {
    (a.clone() * b.clone()).simplify()
}

/// A sum without its zero terms.
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

/// Whether a term is so short that it needs no name.
pub(crate) fn is_atomic(term: &Term) -> bool {
    match term.as_ref() {
        Node::Sym(_) | Node::Const(_) => true,
        Node::Neg(inner) => matches!(inner.as_ref(), Node::Sym(_) | Node::Const(_)),
        _ => false,
    }
}

/// Numerator and denominator, if a term is a quotient.
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

/// A term with names replaced by terms; squares lose the signs of their bases.
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

/// The derivative of a term by the chain rule: Σ ∂term/∂x · derivative of x, over all x with a derivative.
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

/// The value of a term; NaN if a name in it has no value.
pub(crate) fn value(term: &Term, values: &HashMap<&str, f64>) -> f64 {
    term.eval(values).unwrap_or(f64::NAN)
}
