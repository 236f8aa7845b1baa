//! Switches of functions of coordinates and speeds, and evaluation on held pieces.
//!
//! A switch in time is known before a motion ([`Features`](crate::Features)). A switch of coordinates and speeds occurs
//! during the motion: until then an integrator must evaluate one smooth piece, also in a trial step that leads beyond. Therefore the
//! pieces are held, and the functions whose zeros separate them are monitored. When one passes a bound, the next piece
//! is held.
//!
//! ```
//! use dwell_laws::{Expression, HeldPieces, Switches};
//!
//! // A spring that only pushes.
//! let stop = Expression::parse("if(x > 0.1, 4e3*(0.1 - x), 0)", &["x"])?;
//! let switches = Switches::of_expression(&stop, None);
//! let kind = &switches.kinds()[0];
//! let mut value = [0.0];
//! switches.values(&[0.2], &HeldPieces::default(), &mut value);
//! let pushes = kind.piece_at(value[0]);
//!
//! let mut held = HeldPieces::default();
//! switches.hold(&[pushes], &mut held);
//! assert_eq!(stop.eval_held(&[0.0], &held), 4e2); // the same piece, continued
//! assert_eq!(stop.eval(&[0.0]), 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::expression::{
    Expression, HeldPieces, Jet, Op, Rounded, Sides, TapeScalar, run_held_parts,
};
use crate::features::switching::{Operands, Switch, switches_of};
use crate::law::Law;
use crate::windows::{Course, NarrowTerm, Pulse, Traced, UNDERFLOW, first_outside, may_hide};

/// A function is beyond a bound if it exceeds it by more than this fraction of its values.
const ROUNDING: f64 = 1e-12;

/// The functions of a magnitude whose values separate its pieces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Switches {
    kinds: Vec<SwitchKind>,
    /// By function: whether it may exceed a bound between points at which it does not.
    may_hide: Vec<bool>,
    /// The terms that may have narrow pulses.
    terms: Vec<NarrowTerm>,
    source: Source,
}

/// The values at which a function switches.
#[derive(Debug, Clone, PartialEq)]
pub enum SwitchKind {
    /// At zero.
    Zero,
    /// At every integer.
    Integers,
    /// At these values, in order.
    Knots(Vec<f64>),
}

#[derive(Debug, Clone, PartialEq)]
enum Source {
    /// Variables themselves, by index; for a law its only variable.
    Variables(Vec<usize>),
    Expression {
        ops: Vec<Op>,
        /// By switch: where its operands begin.
        switches: Vec<(Switch, [usize; 2])>,
    },
}

impl Default for Source {
    fn default() -> Self {
        Self::Variables(Vec::new())
    }
}

impl SwitchKind {
    /// The piece at a value of the function: the sign, or the number of the interval. `None` if it is undecided: at
    /// zero, or for NaN. (A function that rests on zero is held on a third piece, 0, with the value of the
    /// operation there: `sign` 0, `step` 1, `if` by its comparison.)
    pub fn piece_at(&self, value: f64) -> Option<f64> {
        match self {
            _ if value.is_nan() => None,
            Self::Zero => (value != 0.0).then_some(value.signum()),
            Self::Integers => Some(value.floor()),
            Self::Knots(knots) => Some(knots.partition_point(|&knot| knot <= value) as f64),
        }
    }

    /// The bounds of a piece.
    pub fn bounds(&self, piece: f64) -> [f64; 2] {
        match self {
            Self::Zero if piece == 0.0 => [0.0; 2],
            Self::Zero if piece > 0.0 => [0.0, f64::INFINITY],
            Self::Zero => [f64::NEG_INFINITY, 0.0],
            Self::Integers => [piece, piece + 1.0],
            Self::Knots(knots) => {
                let knot = |i: f64| knots.get(i as usize).copied();
                let below = (piece >= 1.0).then(|| knot(piece - 1.0)).flatten();
                let above = knot(piece).unwrap_or(f64::INFINITY);
                [below.unwrap_or(f64::NEG_INFINITY), above]
            }
        }
    }

    /// The piece beyond the upper or the lower bound of `piece`.
    pub fn next(&self, piece: f64, upward: bool) -> f64 {
        let step = if upward { 1.0 } else { -1.0 };
        match self {
            Self::Zero => step,
            Self::Integers | Self::Knots(_) => piece + step,
        }
    }
}

impl Switches {
    /// The switches of an expression that depend on more than its variable `time`.
    pub fn of_expression(expression: &Expression, time: Option<usize>) -> Self {
        let ops = expression.ops().to_vec();
        let tree = Operands::of(&ops, time);
        let mut switches = Vec::new();
        for (i, operands) in tree.operands.iter().enumerate() {
            for switch in switches_of(ops[i], i, operands) {
                let moves = |last: usize| tree.depends[last][1];
                let is_state = moves(switch.left) || switch.right.is_some_and(moves);
                let same = |right| tree.is_same(&ops, switch.left, right);
                if is_state && !switch.right.is_some_and(same) {
                    let right = switch.right.map_or(0, |right| tree.starts[right]);
                    switches.push((switch, [tree.starts[switch.left], right]));
                }
            }
        }
        let hides = |(switch, _): &(Switch, _)| {
            let is_one = |last: usize| may_hide(&ops, &tree, last);
            is_one(switch.left) || switch.right.is_some_and(is_one)
        };
        let kind = |(switch, _): &(Switch, _)| {
            if switch.at_integers {
                SwitchKind::Integers
            } else {
                SwitchKind::Zero
            }
        };
        Self {
            kinds: switches.iter().map(kind).collect(),
            may_hide: switches.iter().map(hides).collect(),
            terms: NarrowTerm::all(&ops, &tree),
            source: Source::Expression { ops, switches },
        }
    }

    /// The switches of an unknown function that is smooth between given values of its variables (index and values).
    pub fn at_values<'v>(values: impl IntoIterator<Item = (usize, &'v [f64])>) -> Self {
        let all = values
            .into_iter()
            .map(|(variable, values)| (variable, SwitchKind::Knots(values.to_vec())));
        let (variables, kinds): (Vec<usize>, Vec<SwitchKind>) = all.unzip();
        Self {
            may_hide: vec![false; kinds.len()],
            kinds,
            source: Source::Variables(variables),
            ..Self::default()
        }
    }

    /// The switches of a law of a coordinate or speed.
    pub fn of_law(law: &Law) -> Self {
        let knots = match law {
            Law::Expression(expression) => return Self::of_expression(expression, None),
            Law::Spline(spline) if spline.has_kinks() => spline.knots().to_vec(),
            Law::Profile(profile) => profile.corners().to_vec(),
            Law::Spline(_) | Law::Polynomial(_) | Law::Sinusoid(_) => return Self::default(),
        };
        Self::at_values([(0, &knots[..])])
    }

    /// At which values each function switches.
    pub fn kinds(&self) -> &[SwitchKind] {
        &self.kinds
    }

    /// Whether the value of a function depends on the piece of another one, whose operation is among its operands.
    pub fn depends(&self, function: usize, on: usize) -> bool {
        match &self.source {
            Source::Variables(_) => false,
            Source::Expression { switches, .. } => {
                let (switch, [left, right]) = &switches[function];
                let op = switches[on].0.op;
                let in_right = |last: usize| (*right..=last).contains(&op);
                (*left..=switch.left).contains(&op) || switch.right.is_some_and(in_right)
            }
        }
    }

    /// Whether a switch or a pulse may be hidden between points of evaluation.
    pub fn may_hide(&self) -> bool {
        !self.terms.is_empty() || self.may_hide.contains(&true)
    }

    /// The variables of which one must reverse for such an event; `None` if other causes exist.
    pub fn followed(&self) -> Option<Vec<usize>> {
        let all = self.terms.iter().map(|term| term.follows);
        let own = (!self.may_hide.contains(&true)).then_some(all)?;
        own.collect()
    }

    /// The first function that exceeds a bound of its held piece over a course of the variables, and the fraction of the time at
    /// which it does.
    pub fn hidden_passage(
        &self,
        course: &Course,
        held: &HeldPieces,
        pieces: &[Option<f64>],
    ) -> Option<(usize, f64)> {
        let Source::Expression { ops, switches } = &self.source else {
            return None;
        };
        let each = (0..pieces.len()).filter(|&k| self.may_hide[k]);
        let passages = each.filter_map(|k| {
            let piece = pieces[k]?;
            let [low, high] = self.kinds[k].bounds(piece);
            let (switch, [left, right]) = &switches[k];
            let minuend = Traced::part(ops, [*left, switch.left], held, course);
            let subtrahend = switch
                .right
                .map(|last| Traced::part(ops, [*right, last], held, course));
            let value =
                |at: f64| minuend.value(at) - subtrahend.as_ref().map_or(0.0, |s| s.value(at));
            let enclose = |over: [f64; 2]| match &subtrahend {
                Some(subtrahend) => minuend.enclose(over).minus(subtrahend.enclose(over)),
                None => minuend.enclose(over),
            };
            let size = |at: f64| {
                let right = subtrahend.as_ref().map_or(0.0, |s| s.value(at));
                minuend.value(at).abs() + right.abs()
            };
            let sizes = [0.0, 0.5, 1.0].map(size);
            let rounding = (ROUNDING * sizes.into_iter().fold(0.0, f64::max)).max(UNDERFLOW);
            let start = value(0.0);
            // At a restart the function exceeds its bound by rounding.
            let bounds = [low.min(start) - rounding, high.max(start) + rounding];
            let at = (low < high).then(|| first_outside(bounds, value, enclose))?;
            at.map(|at| (k, at))
        });
        passages.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The first narrow pulse over a course of the variables, on the held pieces, that the ends do not show.
    pub fn hidden_pulse(&self, course: &Course, held: &HeldPieces) -> Option<Pulse> {
        let Source::Expression { ops, .. } = &self.source else {
            return None;
        };
        let all = self
            .terms
            .iter()
            .filter_map(|term| term.hidden(ops, held, course));
        all.min_by(|a, b| a.at.total_cmp(&b.at))
    }

    /// The value of each function at these variables, on the held pieces.
    pub fn values(&self, variables: &[f64], held: &HeldPieces, out: &mut [f64]) {
        match &self.source {
            Source::Variables(which) => {
                for (out, &i) in out.iter_mut().zip(which) {
                    *out = variables.get(i).copied().unwrap_or(f64::NAN);
                }
            }
            Source::Expression { ops, switches } => {
                let variable = |i: usize| variables.get(i).copied().unwrap_or(f64::NAN);
                let part = |start: usize, last: usize| {
                    let sides = held.sides.get(start..=last).unwrap_or_default();
                    run_held_parts(&ops[start..=last], variable, sides)
                };
                for (out, of) in out.iter_mut().zip(switches) {
                    let (switch, [left, right]) = of;
                    let minuend = part(*left, switch.left);
                    let subtrahend = switch.right.map_or(0.0, |last| part(*right, last));
                    *out = unrounded([minuend, subtrahend], (ops, of), variable, held);
                }
            }
        }
    }

    /// The value and the rate of each function, from values and rates of the variables.
    pub fn rates(&self, variables: &[[f64; 2]], held: &HeldPieces, out: &mut [[f64; 2]]) {
        match &self.source {
            Source::Variables(which) => {
                for (out, &i) in out.iter_mut().zip(which) {
                    *out = variables.get(i).copied().unwrap_or([f64::NAN; 2]);
                }
            }
            Source::Expression { ops, switches } => {
                let variable = |i: usize| Jet::moving(variables.get(i).copied());
                let part = |start: usize, last: usize| -> [f64; 2] {
                    let sides = held.sides.get(start..=last).unwrap_or_default();
                    let found: Jet = run_held_parts(&ops[start..=last], variable, sides);
                    let [value, rate, ..] = found.derivatives();
                    [value, rate]
                };
                for (out, of) in out.iter_mut().zip(switches) {
                    let (switch, [left, right]) = of;
                    let [minuend, rate] = part(*left, switch.left);
                    let [subtrahend, other] =
                        switch.right.map_or([0.0; 2], |last| part(*right, last));
                    let plain = |i: usize| variable(i).value();
                    let value = unrounded([minuend, subtrahend], (ops, of), plain, held);
                    *out = [value, rate - other];
                }
            }
        }
    }

    /// Holds these pieces, one for each function; functions with `None` are not held.
    pub fn hold(&self, pieces: &[Option<f64>], held: &mut HeldPieces) {
        held.sides.clear();
        if pieces.iter().all(Option::is_none) {
            return;
        }
        match &self.source {
            Source::Variables(_) => held.sides.extend(pieces.iter().map(|&piece| [piece, None])),
            Source::Expression { ops, switches } => {
                held.sides.resize(ops.len(), Sides::default());
                for ((switch, _), &piece) in switches.iter().zip(pieces) {
                    held.sides[switch.op][switch.function] = piece;
                }
            }
        }
    }
}

/// The difference of two values, or the bound if the difference equals it within rounding: rounding does not switch.
fn unrounded(
    [minuend, subtrahend]: [f64; 2],
    (ops, (switch, [left, right])): (&[Op], &(Switch, [usize; 2])),
    variable: impl Fn(usize) -> f64,
    held: &HeldPieces,
) -> f64 {
    /// Differences above this fraction of a value are no rounding errors.
    const NEAR: f64 = 1e-10;
    let value = minuend - subtrahend;
    let bound = if switch.at_integers {
        value.round()
    } else {
        0.0
    };
    let distance = (value - bound).abs();
    if distance == 0.0 || distance > NEAR * (1.0 + minuend.abs()) {
        return value;
    }
    let error = |start: usize, last: usize| {
        let sides = held.sides.get(start..=last).unwrap_or_default();
        run_held_parts(
            &ops[start..=last],
            |i| Rounded::variable(variable(i)),
            sides,
        )
        .error
    };
    let subtracted = switch.right.map_or(0.0, |last| error(*right, last));
    if distance <= error(*left, switch.left) + subtracted {
        bound
    } else {
        value
    }
}

impl Law {
    /// The value and its first three derivatives at `x` on a held piece ([`Switches::hold`]).
    pub fn eval_held(&self, x: f64, held: &HeldPieces) -> [f64; 4] {
        match (self, held.sides.first()) {
            (Self::Expression(expression), Some(_)) => expression.derivatives_held(&[x], 0, held),
            (Self::Spline(spline), Some(&[Some(piece), _])) => spline.eval_piece(piece, x),
            _ => self.eval(x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Interpolation, Spline};
    use proptest::prelude::*;

    const TEXTS: [&str; 10] = [
        "if(x > y, x^2, 3 - y)",
        "abs(x*y - 1) + sign(x)",
        "floor(3*x) + step(y - x)",
        "clamp(x + y, -1, 0.5)",
        "min(x, max(y, x*x - 1))",
        "atan2(y, x)",
        "if(abs(x) < 0.3, floor(y/0.2), sign(y)*x)",
        "if(x <= 0, if(y >= 0, 1, 2), abs(y))",
        "max(0, 1 - abs(x - y)/0.1)",
        "clamp(t*x, y, 1)",
    ];

    fn hold_at(switches: &Switches, at: &[f64]) -> HeldPieces {
        let mut values = vec![0.0; switches.kinds().len()];
        switches.values(at, &HeldPieces::NONE, &mut values);
        let kinds = switches.kinds().iter().zip(&values);
        let pieces: Vec<_> = kinds.map(|(kind, &value)| kind.piece_at(value)).collect();
        let mut held = HeldPieces::NONE;
        switches.hold(&pieces, &mut held);
        held
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.max(1000), failure_persistence: None, ..ProptestConfig::default() })]

        /// The held pieces at a point have the value and slope of the function and equal it up to a switch; no monitored
        /// function passes a bound before that.
        #[test]
        fn held_pieces_are_the_function_up_to_its_switches(
            text in prop::sample::select(TEXTS.to_vec()),
            from in prop::array::uniform3(-1.5..1.5_f64),
            to in prop::array::uniform3(-1.5..1.5_f64),
        ) {
            let expression = Expression::parse(text, &["x", "y", "t"]).expect("a formula");
            let switches = Switches::of_expression(&expression, Some(2));
            let mut first = vec![0.0; switches.kinds().len()];
            switches.values(&from, &HeldPieces::NONE, &mut first);
            prop_assume!(first.iter().all(|value| *value != 0.0));
            let held = hold_at(&switches, &from);
            for variable in 0..3 {
                let free = expression.derivatives_wrt(&from, variable);
                prop_assert_eq!(free, expression.derivatives_held(&from, variable, &held));
            }
            let mut values = first.clone();
            for k in 1..=200 {
                let part = f64::from(k) / 200.0;
                let at = [0, 1, 2].map(|i| from[i] + part * (to[i] - from[i]));
                switches.values(&at, &held, &mut values);
                let watched = switches.kinds().iter().zip(values.iter().zip(&first));
                let inside = watched.map(|(kind, (value, first))| {
                    kind.piece_at(*first).is_none_or(|piece| {
                        let [low, high] = kind.bounds(piece);
                        (low..=high).contains(value)
                    })
                });
                if !inside.into_iter().all(|inside| inside) {
                    break;
                }
                let (one, other) = (expression.eval(&at), expression.eval_held(&at, &held));
                prop_assert!((one - other).abs() < 1e-12, "{} {:?}: {} {}", text, at, one, other);
            }
        }
    }

    #[test]
    fn switches_of_time_alone_are_not_among_them() {
        let expression = Expression::parse("if(t > 1, abs(x), x)", &["x", "t"]).expect("a formula");
        assert_eq!(
            Switches::of_expression(&expression, Some(1)).kinds().len(),
            1
        );
        assert_eq!(Switches::of_expression(&expression, None).kinds().len(), 2);
    }

    #[test]
    fn terms_that_rise_or_fall_throughout_follow_their_variable() {
        for (text, followed) in [
            ("900/(1 + exp(-80*v))", Some(vec![1])),
            ("tanh(v/0.01) - 2*exp(3 - x)", Some(vec![1, 0])),
            ("-3*atan(sinh(v) + v)", Some(vec![1])),
            ("exp(-v^2)", None),
            ("3*(exp(v) - v)", None),
            ("1/v", None),
            ("tanh(v)*x", None),
        ] {
            let expression = Expression::parse(text, &["x", "v"]).expect("a formula");
            let mut found = Switches::of_expression(&expression, None).followed();
            found
                .iter_mut()
                .for_each(|all| all.sort_unstable_by_key(|&v| 1 - v));
            assert_eq!(found, followed, "{text}");
        }
    }

    #[test]
    fn the_pieces_of_a_table_go_on_beyond_its_points() {
        let points = [[0.0, 1.0], [1.0, 2.0], [2.0, 0.0]];
        let table = Spline::interpolating(&points, Interpolation::Linear).expect("a table");
        let law = Law::Spline(table);
        let switches = Switches::of_law(&law);
        for (inside, line) in [
            (-1.0, [1.0, 1.0]),
            (0.5, [1.0, 1.0]),
            (1.5, [4.0, -2.0]),
            (3.0, [4.0, -2.0]),
        ] {
            let held = hold_at(&switches, &[inside]);
            for x in [-2.0, 0.3, 1.7, 5.0] {
                let [value, slope, ..] = law.eval_held(x, &held);
                assert!(
                    (value - (line[0] + line[1] * x)).abs() < 1e-15,
                    "{inside} {x}"
                );
                assert_eq!(slope, line[1]);
            }
        }
    }
}
