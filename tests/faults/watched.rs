//! A number that knows which line of the product computes with it, and can be told to slip there.
//!
//! The steps of a plan are generic over their numbers. Evaluated in [`Watched`] they are the very lines
//! that are shipped, with one operation of one line gone wrong: a sign, a term left out, a factor.
//! Every operation that is met is a [`Place`], so none can be forgotten.

use dwell_geometry::Scalar;
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use std::panic::Location;

/// What is done to numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Operation {
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

/// How an operation goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Slip {
    /// The other sign: of the second term, or of the whole.
    Sign,
    /// The first term is forgotten.
    First,
    /// The second term, or the operation, is forgotten.
    Second,
    /// Nothing comes out.
    Nothing,
    Twice,
    Half,
    /// Sine for cosine; a product for a quotient.
    Swapped,
}

impl Operation {
    /// Everything that can go wrong with it.
    pub(crate) fn slips(self) -> &'static [Slip] {
        use Slip::{First, Half, Nothing, Second, Sign, Swapped, Twice};
        match self {
            Self::Sum | Self::Difference => &[Sign, First, Second],
            Self::Sign => &[Sign, Nothing],
            Self::Product | Self::Constant => &[Sign, Nothing, Twice, Half],
            Self::Quotient => &[Sign, Nothing, Twice, Swapped],
            Self::Root => &[Sign, Twice, Second],
            Self::Direction => &[Sign, Swapped],
            Self::Angle => &[Sign, Twice],
            Self::Law => &[Sign, Nothing, Twice],
        }
    }

    pub(crate) fn words(self) -> &'static str {
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

impl Slip {
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Sign => "other sign",
            Self::First => "first term forgotten",
            Self::Second => "second term forgotten",
            Self::Nothing => "forgotten",
            Self::Twice => "twice",
            Self::Half => "half",
            Self::Swapped => "swapped",
        }
    }
}

/// One kind of operation at one place of the product's source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Place {
    pub(crate) file: &'static str,
    pub(crate) line: u32,
    pub(crate) column: u32,
    pub(crate) operation: Operation,
    /// Which one of a chain, such as the second difference of a − b − c: they begin in one place.
    pub(crate) link: u8,
}

/// Links of a chain that are told apart; loops go on and on.
const MOST_LINKS: u8 = 3;

thread_local! {
    /// The place that slips in this thread, and how.
    static SLIPPING: Cell<Option<(Place, Slip)>> = const { Cell::new(None) };
    /// The places met, where they are noted.
    static MET: RefCell<Option<BTreeSet<Place>>> = const { RefCell::new(None) };
}

/// Does something while one place slips.
pub(crate) fn slipping<R>(fault: Option<(Place, Slip)>, act: impl FnOnce() -> R) -> R {
    let before = SLIPPING.replace(fault);
    let done = act();
    SLIPPING.set(before);
    done
}

/// Does something, and notes every place that it meets.
pub(crate) fn noting<R>(act: impl FnOnce() -> R) -> (R, BTreeSet<Place>) {
    MET.replace(Some(BTreeSet::new()));
    let done = act();
    (done, MET.take().unwrap_or_default())
}

/// How an operation called from here on this first term slips, if it does, and where it comes from.
#[track_caller]
fn slip(operation: Operation, first: Origin) -> (Option<Slip>, Origin) {
    let at = Location::caller();
    let mut origin = Origin {
        line: at.line(),
        column: at.column(),
        operation: Some(operation),
        link: 0,
    };
    if (first.line, first.column, first.operation) == (origin.line, origin.column, origin.operation)
    {
        origin.link = (first.link + 1).min(MOST_LINKS);
    }
    let here = || Place {
        file: at.file(),
        line: at.line(),
        column: at.column(),
        operation,
        link: origin.link,
    };
    let slip = match SLIPPING.get() {
        Some((place, slip)) => {
            let same = place.line == at.line() && place.operation == operation;
            (same && place == here()).then_some(slip)
        }
        None => {
            MET.with_borrow_mut(|met| met.as_mut().map(|met| met.insert(here())));
            None
        }
    };
    (slip, origin)
}

/// The operation that a number comes from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Origin {
    line: u32,
    column: u32,
    operation: Option<Operation>,
    link: u8,
}

/// A plain number whose operations are watched.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Watched(pub(crate) f64, Origin);

impl Watched {
    pub(crate) fn new(value: f64) -> Self {
        Self(value, Origin::default())
    }
}

/// A result that may lose its sign, its size or itself.
fn spoilt(value: f64, (slip, origin): (Option<Slip>, Origin)) -> Watched {
    let value = match slip {
        Some(Slip::Sign) => -value,
        Some(Slip::Nothing) => 0.0,
        Some(Slip::Twice) => 2.0 * value,
        Some(Slip::Half) => 0.5 * value,
        _ => value,
    };
    Watched(value, origin)
}

/// A sum of two terms, one of which may lose its sign or itself.
fn summed(first: f64, second: f64, (slip, origin): (Option<Slip>, Origin)) -> Watched {
    let value = match slip {
        Some(Slip::Sign) => first - second,
        Some(Slip::First) => second,
        Some(Slip::Second) => first,
        _ => first + second,
    };
    Watched(value, origin)
}

impl Scalar for Watched {
    const DERIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    #[track_caller]
    fn lift(value: f64) -> Self {
        // Nothing can go wrong with nothing.
        if value == 0.0 {
            return Self::new(0.0);
        }
        spoilt(value, slip(Operation::Constant, Origin::default()))
    }
    fn value(self) -> f64 {
        self.0
    }
    #[track_caller]
    fn sqrt(self) -> Self {
        match slip(Operation::Root, Origin::default()) {
            (Some(Slip::Second), origin) => Self(self.0, origin),
            slip => spoilt(self.0.sqrt(), slip),
        }
    }
    #[track_caller]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        match slip(Operation::Direction, Origin::default()) {
            (Some(Slip::Swapped), origin) => (Self(cos, origin), Self(sin, origin)),
            slip => (spoilt(sin, slip), Self(cos, slip.1)),
        }
    }
    #[track_caller]
    fn atan2(self, other: Self) -> Self {
        let angle = self.0.atan2(other.0);
        spoilt(angle, slip(Operation::Angle, Origin::default()))
    }
    #[track_caller]
    fn through(self, derivatives: &[f64; 4]) -> Self {
        spoilt(derivatives[0], slip(Operation::Law, Origin::default()))
    }
}

impl Add for Watched {
    type Output = Self;
    #[track_caller]
    fn add(self, other: Self) -> Self {
        summed(self.0, other.0, slip(Operation::Sum, self.1))
    }
}

impl Sub for Watched {
    type Output = Self;
    #[track_caller]
    fn sub(self, other: Self) -> Self {
        summed(self.0, -other.0, slip(Operation::Difference, self.1))
    }
}

impl Mul for Watched {
    type Output = Self;
    #[track_caller]
    fn mul(self, other: Self) -> Self {
        spoilt(self.0 * other.0, slip(Operation::Product, self.1))
    }
}

impl Div for Watched {
    type Output = Self;
    #[track_caller]
    fn div(self, other: Self) -> Self {
        match slip(Operation::Quotient, self.1) {
            (Some(Slip::Swapped), origin) => Self(self.0 * other.0, origin),
            slip => spoilt(self.0 / other.0, slip),
        }
    }
}

impl Neg for Watched {
    type Output = Self;
    #[track_caller]
    fn neg(self) -> Self {
        spoilt(-self.0, slip(Operation::Sign, Origin::default()))
    }
}

// What adds to itself in a loop is one term, however often it goes round: no chain.

impl AddAssign for Watched {
    #[track_caller]
    fn add_assign(&mut self, other: Self) {
        *self = summed(self.0, other.0, slip(Operation::Sum, Origin::default()));
    }
}

impl SubAssign for Watched {
    #[track_caller]
    fn sub_assign(&mut self, other: Self) {
        *self = summed(
            self.0,
            -other.0,
            slip(Operation::Difference, Origin::default()),
        );
    }
}
