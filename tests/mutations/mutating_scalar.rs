//! A number that knows which source line computes with it, and can be set to compute wrongly there.
//!
//! The steps of a plan are generic over their numbers. Evaluated in [`MutatingScalar`] they are the very lines
//! that are shipped, with one operation of one line gone wrong: a sign, a term left out, a factor.
//! Every operation that is met is a [`SourceOperation`], so none can be forgotten.

use dwell_numerics::Scalar;
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use std::panic::Location;

/// What is done to numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operation {
    Sum,
    Difference,
    Sign,
    Product,
    Quotient,
    Root,
    Direction,
    Angle,
    Law,
    Constant,
}

/// How an operation is mutated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MutationKind {
    /// The other sign: of the second term, or of the whole.
    Sign,
    /// The first term is forgotten.
    FirstTermOmitted,
    /// The second term, or the operation, is forgotten.
    SecondTermOmitted,
    /// Nothing comes out.
    Omitted,
    Doubled,
    Halved,
    /// Sine for cosine; a product for a quotient.
    Swapped,
}

impl Operation {
    /// Everything that can go wrong with it.
    pub fn mutations(self) -> &'static [MutationKind] {
        use MutationKind::{
            Doubled, FirstTermOmitted, Halved, Omitted, SecondTermOmitted, Sign, Swapped,
        };
        match self {
            Self::Sum | Self::Difference => &[Sign, FirstTermOmitted, SecondTermOmitted],
            Self::Sign => &[Sign, Omitted],
            Self::Product | Self::Constant => &[Sign, Omitted, Doubled, Halved],
            Self::Quotient => &[Sign, Omitted, Doubled, Swapped],
            Self::Root => &[Sign, Doubled, SecondTermOmitted],
            Self::Direction => &[Sign, Swapped],
            Self::Angle => &[Sign, Doubled],
            Self::Law => &[Sign, Omitted, Doubled],
        }
    }

    pub fn description(self) -> &'static str {
        match self {
            Self::Sum => "sum",
            Self::Difference => "difference",
            Self::Sign => "sign",
            Self::Product => "product",
            Self::Quotient => "quotient",
            Self::Root => "root",
            Self::Direction => "sine and cosine",
            Self::Angle => "angle",
            Self::Law => "law",
            Self::Constant => "constant",
        }
    }
}

impl MutationKind {
    pub fn description(self) -> &'static str {
        match self {
            Self::Sign => "other sign",
            Self::FirstTermOmitted => "first term forgotten",
            Self::SecondTermOmitted => "second term forgotten",
            Self::Omitted => "forgotten",
            Self::Doubled => "twice",
            Self::Halved => "half",
            Self::Swapped => "swapped",
        }
    }
}

/// One kind of operation at one place of the product's source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceOperation {
    pub file: &'static str,
    pub line: u32,
    pub column: u32,
    pub operation: Operation,
    /// Which one of a chain, such as the second difference of a − b − c: they begin in one place.
    pub link: u8,
}

/// Links of a chain that are distinguished; loops have any number.
const MAX_CHAIN_LINKS: u8 = 3;

thread_local! {
    /// The operation that is mutated in this thread, and how.
    static ACTIVE_MUTATION: Cell<Option<(SourceOperation, MutationKind)>> = const { Cell::new(None) };
    /// The places met, where they are noted.
    static RECORDED_OPERATIONS: RefCell<Option<BTreeSet<SourceOperation>>> = const { RefCell::new(None) };
}

/// Does something while one operation is mutated.
pub fn with_mutation<R>(
    mutation: Option<(SourceOperation, MutationKind)>,
    run: impl FnOnce() -> R,
) -> R {
    let before = ACTIVE_MUTATION.replace(mutation);
    let result = run();
    ACTIVE_MUTATION.set(before);
    result
}

/// Does something, and notes every place that it meets.
pub fn recording_operations<R>(run: impl FnOnce() -> R) -> (R, BTreeSet<SourceOperation>) {
    RECORDED_OPERATIONS.replace(Some(BTreeSet::new()));
    let result = run();
    (result, RECORDED_OPERATIONS.take().unwrap_or_default())
}

/// How an operation called from here on this first term is mutated, if it is, and where it comes from.
#[track_caller]
fn mutation_here(operation: Operation, first: Origin) -> (Option<MutationKind>, Origin) {
    let at = Location::caller();
    let mut origin = Origin {
        line: at.line(),
        column: at.column(),
        operation: Some(operation),
        link: 0,
    };
    if (first.line, first.column, first.operation) == (origin.line, origin.column, origin.operation)
    {
        origin.link = (first.link + 1).min(MAX_CHAIN_LINKS);
    }
    let here = || SourceOperation {
        file: at.file(),
        line: at.line(),
        column: at.column(),
        operation,
        link: origin.link,
    };
    let kind = match ACTIVE_MUTATION.get() {
        Some((place, kind)) => {
            let same = place.line == at.line() && place.operation == operation;
            (same && place == here()).then_some(kind)
        }
        None => {
            RECORDED_OPERATIONS.with_borrow_mut(|recorded| {
                recorded.as_mut().map(|recorded| recorded.insert(here()))
            });
            None
        }
    };
    (kind, origin)
}

/// The operation that a number comes from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Origin {
    line: u32,
    column: u32,
    operation: Option<Operation>,
    link: u8,
}

/// A number whose operations are recorded and mutated.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MutatingScalar(pub f64, Origin);

impl MutatingScalar {
    pub fn new(value: f64) -> Self {
        Self(value, Origin::default())
    }
}

/// A result that may lose its sign, its size or itself.
fn mutated(value: f64, (kind, origin): (Option<MutationKind>, Origin)) -> MutatingScalar {
    let value = match kind {
        Some(MutationKind::Sign) => -value,
        Some(MutationKind::Omitted) => 0.0,
        Some(MutationKind::Doubled) => 2.0 * value,
        Some(MutationKind::Halved) => 0.5 * value,
        _ => value,
    };
    MutatingScalar(value, origin)
}

/// A sum of two terms, one of which may lose its sign or itself.
fn mutated_sum(
    first: f64,
    second: f64,
    (kind, origin): (Option<MutationKind>, Origin),
) -> MutatingScalar {
    let value = match kind {
        Some(MutationKind::Sign) => first - second,
        Some(MutationKind::FirstTermOmitted) => second,
        Some(MutationKind::SecondTermOmitted) => first,
        _ => first + second,
    };
    MutatingScalar(value, origin)
}

impl Scalar for MutatingScalar {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    #[track_caller]
    fn from_f64(value: f64) -> Self {
        // Nothing can go wrong with nothing.
        if value == 0.0 {
            return Self::new(0.0);
        }
        mutated(value, mutation_here(Operation::Constant, Origin::default()))
    }
    fn value(self) -> f64 {
        self.0
    }
    #[track_caller]
    fn sqrt(self) -> Self {
        match mutation_here(Operation::Root, Origin::default()) {
            (Some(MutationKind::SecondTermOmitted), origin) => Self(self.0, origin),
            mutation => mutated(self.0.sqrt(), mutation),
        }
    }
    #[track_caller]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        match mutation_here(Operation::Direction, Origin::default()) {
            (Some(MutationKind::Swapped), origin) => (Self(cos, origin), Self(sin, origin)),
            mutation => (mutated(sin, mutation), Self(cos, mutation.1)),
        }
    }
    #[track_caller]
    fn atan2(self, other: Self) -> Self {
        let angle = self.0.atan2(other.0);
        mutated(angle, mutation_here(Operation::Angle, Origin::default()))
    }
    #[track_caller]
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        mutated(
            derivatives[0],
            mutation_here(Operation::Law, Origin::default()),
        )
    }
}

impl Add for MutatingScalar {
    type Output = Self;
    #[track_caller]
    fn add(self, other: Self) -> Self {
        mutated_sum(self.0, other.0, mutation_here(Operation::Sum, self.1))
    }
}

impl Sub for MutatingScalar {
    type Output = Self;
    #[track_caller]
    fn sub(self, other: Self) -> Self {
        mutated_sum(
            self.0,
            -other.0,
            mutation_here(Operation::Difference, self.1),
        )
    }
}

impl Mul for MutatingScalar {
    type Output = Self;
    #[track_caller]
    fn mul(self, other: Self) -> Self {
        mutated(self.0 * other.0, mutation_here(Operation::Product, self.1))
    }
}

impl Div for MutatingScalar {
    type Output = Self;
    #[track_caller]
    fn div(self, other: Self) -> Self {
        match mutation_here(Operation::Quotient, self.1) {
            (Some(MutationKind::Swapped), origin) => Self(self.0 * other.0, origin),
            mutation => mutated(self.0 / other.0, mutation),
        }
    }
}

impl Neg for MutatingScalar {
    type Output = Self;
    #[track_caller]
    fn neg(self) -> Self {
        mutated(-self.0, mutation_here(Operation::Sign, Origin::default()))
    }
}

// What adds to itself in a loop is one term, however often it goes round: no chain.

impl AddAssign for MutatingScalar {
    #[track_caller]
    fn add_assign(&mut self, other: Self) {
        *self = mutated_sum(
            self.0,
            other.0,
            mutation_here(Operation::Sum, Origin::default()),
        );
    }
}

impl SubAssign for MutatingScalar {
    #[track_caller]
    fn sub_assign(&mut self, other: Self) {
        *self = mutated_sum(
            self.0,
            -other.0,
            mutation_here(Operation::Difference, Origin::default()),
        );
    }
}
