//! Vectors that turn with an orientation class, by squared length and angle.

use crate::algebra::{Node, Term, atan2, is_zero, number, plus, scale, square, zero};
use crate::positions::{PositionFormulas, Vector};
use crate::symbol_table::PartialDerivatives;

/// A vector that turns with a class: its squared length, and its angle in the class, rad, less that of
/// `sign` times it.
pub(crate) struct Polar {
    pub(crate) square: Term,
    pub(crate) angle: Term,
    /// The step of the angle, if it changes.
    pub(crate) angle_symbol: Option<String>,
    pub(crate) sign: f64,
}

impl PositionFormulas<'_> {
    /// What a class has of a loop.
    pub(crate) fn polar(&mut self, closure: usize, class: usize, but: &[usize]) -> Polar {
        let class_root = self.plan.class_frame(class);
        if let Some(local) = self.constant_loop_part(closure, class, but) {
            let sign = if local.x < 0.0 || (local.x == 0.0 && local.y < 0.0) {
                -1.0
            } else {
                1.0
            };
            let vector = self.loop_part(
                closure,
                |formulas, f| formulas.orientation_class(f) == class,
                |formulas, f| formulas.relative_angle(f),
                but,
            );
            let square = plus(&square_of(&vector[0]), &square_of(&vector[1]));
            let name = self.frame_name(class_root);
            let angle = (local * sign).angle();
            let angle = if angle == 0.0 {
                zero()
            } else {
                let k = self.next_number();
                let meaning = format!(
                    "{name}: direction of its vector at {}, from its x axis",
                    self.loop_joint_name(closure)
                );
                self.symbols
                    .add_constant(("alpha", &[&k]), angle, "rad", meaning)
            };
            return Polar {
                square,
                angle,
                angle_symbol: None,
                sign,
            };
        }
        let part = self.loop_part(
            closure,
            |formulas, f| formulas.orientation_class(f) == class,
            |formulas, f| formulas.relative_angle(f),
            but,
        );
        self.varying_polar(closure, class_root, &part)
    }

    /// A vector that changes in its class.
    pub(crate) fn varying_polar(
        &mut self,
        closure: usize,
        class_root: usize,
        part: &Vector,
    ) -> Polar {
        let (joint, name) = (self.loop_joint_name(closure), self.frame_name(class_root));
        let codes = ["x", "y"].map(|axis| self.symbols.new_name("w", &[&joint, &name, axis]));
        let vector = [0, 1].map(|i| self.symbols.assign(&codes[i], &part[i]));
        let code = self.symbols.new_name("w", &[&joint, &name]);
        let square = self
            .symbols
            .assign(&code, &plus(&square(&vector[0]), &square(&vector[1])));
        let code = self.symbols.new_name("epsilon", &[&joint, &name]);
        let partials = angle_partials(&codes, &vector, &square);
        let angle = atan2(vector[1].clone(), vector[0].clone());
        let angle = self.symbols.assign_with_partials(&code, angle, partials);
        Polar {
            square,
            angle,
            angle_symbol: Some(code),
            sign: 1.0,
        }
    }

    /// Turns a class until its vector is the one in the steps `to`.
    pub(crate) fn orient_class(&mut self, class: usize, to: &Vector, polar: &Polar) {
        let class_root = self.plan.class_frame(class);
        let name = self.frame_name(class_root);
        let code = self.symbols.new_name("theta", &[&name]);
        let codes = [0, 1].map(|i| to[i].to_string());
        let mut partials = angle_partials(&codes, to, &polar.square);
        if let Some(varies) = &polar.angle_symbol {
            partials.extra_partials.push((varies.clone(), number(-1.0)));
        }
        let [x, y] = [0, 1].map(|i| scale(&to[i], polar.sign));
        let mut angle = atan2(y, x);
        if !is_zero(&polar.angle) {
            angle = angle - polar.angle.clone();
        }
        let angle = self.symbols.assign_with_partials(&code, angle, partials);
        self.angles[class_root] = Some(angle);
    }
}

/// The slopes of an angle by the coordinates of what it points along.
pub(crate) fn angle_partials(
    codes: &[String; 2],
    to: &Vector,
    square: &Term,
) -> PartialDerivatives {
    PartialDerivatives {
        denominator: square.clone(),
        quotient_partials: vec![
            (codes[1].clone(), to[0].clone()),
            (codes[0].clone(), -to[1].clone()),
        ],
        extra_partials: Vec::new(),
    }
}

pub(crate) fn square_of(term: &Term) -> Term {
    match term.as_ref() {
        _ if is_zero(term) => zero(),
        Node::Neg(inner) => square(inner).simplify(),
        _ => square(term).simplify(),
    }
}
