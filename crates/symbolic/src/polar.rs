//! Vectors that rotate with an orientation class, in polar form: squared length and angle.

use crate::algebra::{Node, Term, atan2, is_zero, number, plus, scale, square};
use crate::loops::forward;
use crate::positions::{PositionFormulas, Vector, square_norm};
use crate::symbol_table::PartialDerivatives;

/// A vector that rotates with a class: its squared length, and the angle of `sign` times it in the class,
/// rad.
pub(crate) struct Polar {
    pub(crate) square: Term,
    pub(crate) angle: Term,
    /// The step of the angle, if it changes.
    pub(crate) angle_symbol: Option<String>,
    pub(crate) sign: f64,
}

impl PositionFormulas<'_> {
    /// The part of a loop that rotates with a class.
    pub(crate) fn polar(&mut self, closure: usize, class: usize, but: &[usize]) -> Polar {
        let class_root = self.plan.class_frame(class);
        let part = self.class_part(closure, class, but);
        let Some(local) = self.constant_loop_part(closure, class, but) else {
            return self.varying_polar(closure, class_root, &part);
        };
        let (forth, sign) = forward(local);
        let square = plus(&square_of(&part[0]), &square_of(&part[1]));
        let mut angle = number(forth.angle());
        if !is_zero(&angle) {
            let (name, joint) = (self.frame_name(class_root), self.loop_joint_name(closure));
            let meaning = format!("{name}: direction of its vector at {joint}, from its x axis");
            angle = self.numbered_constant("alpha", forth.angle(), "rad", meaning);
        }
        Polar {
            square,
            angle,
            angle_symbol: None,
            sign,
        }
    }

    /// A vector that changes in its class.
    pub(crate) fn varying_polar(
        &mut self,
        closure: usize,
        class_root: usize,
        part: &Vector,
    ) -> Polar {
        let (joint, name) = (self.loop_joint_name(closure), self.frame_name(class_root));
        let below = [joint.as_str(), &name];
        let vector = self.symbols.assign_vector("w", &below, part);
        let square = self.symbols.assign("w", &below, &square_norm(&vector));
        let code = self.symbols.new_name("epsilon", &below);
        let partials = angle_partials(&vector, &square);
        let [x, y] = vector;
        let angle = atan2(y, x);
        let angle = self
            .symbols
            .assign_with_partials(code.clone(), angle, partials);
        Polar {
            square,
            angle,
            angle_symbol: Some(code),
            sign: 1.0,
        }
    }

    /// Determines the angle of a class from the vector `to`, which its vector must equal.
    pub(crate) fn orient_class(&mut self, class: usize, to: &Vector, polar: &Polar) {
        let class_root = self.plan.class_frame(class);
        let name = self.frame_name(class_root);
        let code = self.symbols.new_name("theta", &[&name]);
        let mut partials = angle_partials(to, &polar.square);
        if let Some(varies) = &polar.angle_symbol {
            partials.extra_partials.push((varies.clone(), number(-1.0)));
        }
        let [x, y] = [0, 1].map(|i| scale(&to[i], polar.sign));
        let mut angle = atan2(y, x);
        if !is_zero(&polar.angle) {
            angle = angle - polar.angle.clone();
        }
        let angle = self.symbols.assign_with_partials(code, angle, partials);
        self.angles[class_root] = Some(angle);
    }
}

/// The partial derivatives of an angle by the components of its direction, which are steps.
pub(crate) fn angle_partials(to: &Vector, square: &Term) -> PartialDerivatives {
    PartialDerivatives {
        denominator: square.clone(),
        quotient_partials: vec![
            (to[1].to_string(), to[0].clone()),
            (to[0].to_string(), -to[1].clone()),
        ],
        extra_partials: Vec::new(),
    }
}

pub(crate) fn square_of(term: &Term) -> Term {
    match term.as_ref() {
        Node::Neg(inner) => square(inner),
        _ => square(term),
    }
}
