//! A coupling between angles and travels: Φ = Σ dependent − law(Σ independent) − constant. Its angles are counted
//! over whole revolutions, so the frames it names carry a number beside their direction.

use crate::rates::Rates;
use crate::structure::frames::Frames;
use crate::structure::lower::{LinearTerms, Lowered, LoweredCoordinate, LoweredCoupling, Owner};
use crate::structure::tree::Tree;
use dwell_laws::Law;
use dwell_numerics::Scalar;
use std::collections::BTreeSet;

/// A sum of frames' angles and slides' travels with factors, and a constant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinearForm {
    /// Frames, with the factor of each angle.
    pub angles: Vec<(usize, f64)>,
    /// Slides, with the factor of each travel.
    pub slides: Vec<(usize, f64)>,
    /// The constant of the coupling, rad or m.
    pub constant: f64,
}

/// A coupling in terms of frames and slides.
#[derive(Debug, Clone, PartialEq)]
pub struct CouplingEquation {
    /// Its owner: a joint, or an actuator that drives a length.
    pub owner: Owner,
    /// The sum on its left, less its constant.
    pub dependent: LinearForm,
    /// The law and its argument, if there is a law.
    pub law: Option<(Law, LinearForm)>,
    /// Whether it is in rad rather than in m.
    pub angular: bool,
}

impl LinearForm {
    fn new(sum: &LinearTerms, frames: &Frames, tree: &Tree) -> Self {
        let mut form = Self::default();
        for &(coordinate, factor) in sum {
            match coordinate {
                LoweredCoordinate::Angle(body) => {
                    let orientation = frames.orientations[body];
                    form.constant += factor * orientation.offset_angle;
                    if orientation.frame != 0 {
                        add(&mut form.angles, orientation.frame, factor);
                    }
                }
                LoweredCoordinate::Travel(pair) => {
                    if let Some(slide) = tree.slide_of_pair(pair) {
                        add(&mut form.slides, slide, factor);
                    }
                }
            }
        }
        form.angles.retain(|t| t.1 != 0.0);
        form.slides.retain(|t| t.1 != 0.0);
        form
    }

    fn value<T: Scalar>(&self, angle: &[T], slide: &[T]) -> T {
        self.add_terms(self.constant, angle, slide)
    }

    /// Its rate, from the velocities or accelerations of frames and slides.
    fn rate<T: Scalar>(&self, rates: &Rates<T>) -> T {
        self.add_terms(0.0, &rates.angular, &rates.slide)
    }

    fn add_terms<T: Scalar>(&self, to: f64, angle: &[T], slide: &[T]) -> T {
        let mut sum = T::from_f64(to);
        for &(f, factor) in &self.angles {
            sum += T::from_f64(factor) * angle[f];
        }
        for &(s, factor) in &self.slides {
            sum += T::from_f64(factor) * slide[s];
        }
        sum
    }

    /// The sum of the factors of a class's frames.
    pub(crate) fn class_factor(&self, frames: &Frames, class: usize) -> f64 {
        factor_of(&self.angles, |f| {
            frames.frames[f].orientation_class == class
        })
    }

    /// The factor of a slide.
    pub(crate) fn slide_factor(&self, slide: usize) -> f64 {
        factor_of(&self.slides, |s| s == slide)
    }
}

fn factor_of(terms: &[(usize, f64)], picks: impl Fn(usize) -> bool) -> f64 {
    let picked = terms.iter().filter(|(i, _)| picks(*i));
    picked.map(|(_, factor)| factor).sum()
}

fn add(list: &mut Vec<(usize, f64)>, index: usize, factor: f64) {
    match list.iter_mut().find(|(i, _)| *i == index) {
        Some((_, sum)) => *sum += factor,
        None => list.push((index, factor)),
    }
}

impl CouplingEquation {
    pub(crate) fn all(lowered: &Lowered, frames: &Frames, tree: &Tree) -> Vec<Self> {
        let compile = |lowered_coupling: &LoweredCoupling| Self {
            owner: lowered_coupling.owner,
            dependent: LinearForm::new(&lowered_coupling.dependent, frames, tree),
            law: lowered_coupling.law.as_ref().map(|(law, independent)| {
                (law.clone(), LinearForm::new(independent, frames, tree))
            }),
            angular: lowered_coupling.angular,
        };
        lowered.couplings.iter().map(compile).collect()
    }

    /// Both sums.
    fn forms(&self) -> impl Iterator<Item = &LinearForm> {
        std::iter::once(&self.dependent).chain(self.law.iter().map(|(_, independent)| independent))
    }

    /// The classes whose turning changes it, without the ground's.
    pub(crate) fn classes(&self, frames: &Frames) -> BTreeSet<usize> {
        let of_form = |form: &LinearForm| {
            let class = |&(f, _): &(usize, f64)| frames.frames[f].orientation_class;
            let named = form.angles.iter().map(class);
            let turns = |c: &usize| *c > 0 && form.class_factor(frames, *c) != 0.0;
            named.filter(turns).collect::<Vec<_>>()
        };
        self.forms().flat_map(of_form).collect()
    }

    /// Every frame it names.
    pub(crate) fn frames(&self) -> impl Iterator<Item = usize> {
        let angles = self.forms().flat_map(|form| &form.angles);
        angles.map(|(frame, _)| *frame)
    }

    /// The slides it names.
    pub(crate) fn slides(&self) -> BTreeSet<usize> {
        let slides = self.forms().flat_map(|form| &form.slides);
        slides.map(|(slide, _)| *slide).collect()
    }

    /// Whether the law, if any, is of nothing that depends on these classes and slides.
    pub(crate) fn linear_in(
        &self,
        frames: &Frames,
        class: impl Fn(usize) -> bool,
        slide: impl Fn(usize) -> bool,
    ) -> bool {
        self.law.as_ref().is_none_or(|(_, independent)| {
            let (mut angles, mut slides) = (independent.angles.iter(), independent.slides.iter());
            !angles.any(|&(f, _)| class(frames.frames[f].orientation_class))
                && !slides.any(|&(s, _)| slide(s))
        })
    }

    /// Φ at counted angles and travels.
    pub(crate) fn value<T: Scalar>(&self, angle: &[T], slide: &[T]) -> T {
        let mut value = self.dependent.value(angle, slide);
        if let Some((law, independent)) = &self.law {
            let x = independent.value(angle, slide);
            value -= x.compose(&law.eval(x.value()));
        }
        value
    }

    /// The variable of its law, and the end of the law's table that the variable exceeds, if it does.
    pub(crate) fn off_table<T: Scalar>(&self, angle: &[T], slide: &[T]) -> Option<[f64; 2]> {
        let (law, independent) = self.law.as_ref()?;
        let x = independent.value(angle, slide).value();
        Some([x, law.end_passed(x)?])
    }

    /// Whether its law is a table.
    pub(crate) fn has_table(&self) -> bool {
        matches!(self.law, Some((Law::Spline(_), _)))
    }

    /// The slope of the law, and its own derivative: 0 without a law.
    fn slopes<T: Scalar>(&self, angle: &[T], slide: &[T]) -> (T, T) {
        let Some((law, independent)) = &self.law else {
            return (T::from_f64(0.0), T::from_f64(0.0));
        };
        let x = independent.value(angle, slide);
        let [_, d, dd, ddd] = law.eval(x.value());
        (
            x.compose(&[d, dd, ddd, 0.0]),
            x.compose(&[dd, ddd, 0.0, 0.0]),
        )
    }

    /// The slope of the law: 0 without a law.
    pub(crate) fn slope<T: Scalar>(&self, angle: &[T], slide: &[T]) -> T {
        self.slopes(angle, slide).0
    }

    /// Φ̇.
    pub(crate) fn rate<T: Scalar>(&self, angle: &[T], slide: &[T], velocity: &Rates<T>) -> T {
        let mut rate = self.dependent.rate(velocity);
        if let Some((_, independent)) = &self.law {
            rate -= self.slope(angle, slide) * independent.rate(velocity);
        }
        rate
    }

    /// Φ̈ from velocities and accelerations of frames and slides.
    pub(crate) fn acceleration<T: Scalar>(
        &self,
        angle: &[T],
        slide: &[T],
        velocity: &Rates<T>,
        acceleration: &Rates<T>,
    ) -> T {
        let mut value = self.dependent.rate(acceleration);
        if let Some((_, independent)) = &self.law {
            let (slope, bend) = self.slopes(angle, slide);
            let rate = independent.rate(velocity);
            value -= slope * independent.rate(acceleration) + bend * rate * rate;
        }
        value
    }

    /// ∂Φ/∂ of each frame's angle and each slide's travel it names, to `add_angle` and `add_travel`.
    pub(crate) fn for_each_derivative<T: Scalar>(
        &self,
        angle: &[T],
        travel: &[T],
        mut add_angle: impl FnMut(usize, T),
        mut add_travel: impl FnMut(usize, T),
    ) {
        let minus_slope = -self.slope(angle, travel);
        for (form, factor_of_form) in self.forms().zip([T::from_f64(1.0), minus_slope]) {
            for &(f, factor) in &form.angles {
                add_angle(f, factor_of_form * T::from_f64(factor));
            }
            for &(s, factor) in &form.slides {
                add_travel(s, factor_of_form * T::from_f64(factor));
            }
        }
    }

    /// ∂Φ/∂ of an unknown, by its factor in each of the sums.
    pub(crate) fn derivative<T: Scalar>(
        &self,
        factor: impl Fn(&LinearForm) -> f64,
        angle: &[T],
        slide: &[T],
    ) -> T {
        let mut value = T::from_f64(factor(&self.dependent));
        if let Some((_, independent)) = &self.law {
            value -= self.slope(angle, slide) * T::from_f64(factor(independent));
        }
        value
    }
}
