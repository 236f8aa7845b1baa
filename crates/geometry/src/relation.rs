//! A relation between angles and travels: Φ = Σ of − law(Σ by) − constant. Its angles are counted
//! over whole turns, so the frames it names carry a number beside their direction.

use crate::frames::Frames;
use crate::lower::{Lowered, Measure, Owner, Ratio, Sum};
use crate::scalar::Scalar;
use crate::tree::Tree;
use dwell_laws::Law;

/// A sum of frames' angles and slides' travels with factors, and a constant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Terms {
    /// Frames, with the factor of each angle.
    pub turns: Vec<(usize, f64)>,
    /// Slides, with the factor of each travel.
    pub slides: Vec<(usize, f64)>,
    /// What is added, rad or m.
    pub constant: f64,
}

/// A relation in terms of frames and slides.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What it comes from.
    pub owner: Owner,
    /// The sum on its left, less its constant.
    pub of: Terms,
    /// The law and its argument, where there is one.
    pub law: Option<(Law, Terms)>,
    /// Whether its constant is what makes it hold at the start.
    pub as_assembled: bool,
    /// Whether it is in rad rather than in m.
    pub angular: bool,
}

impl Terms {
    fn new(sum: &Sum, frames: &Frames, tree: &Tree) -> Self {
        let mut terms = Self::default();
        for &(measure, factor) in sum {
            match measure {
                Measure::Angle(body) => {
                    let attitude = frames.attitudes[body];
                    terms.constant += factor * attitude.offset.angle();
                    if attitude.frame != 0 {
                        add(&mut terms.turns, attitude.frame, factor);
                    }
                }
                Measure::Travel(bond) => {
                    if let Some(slide) = tree.slide_of(bond) {
                        add(&mut terms.slides, slide, factor);
                    }
                }
            }
        }
        terms.turns.retain(|t| t.1 != 0.0);
        terms.slides.retain(|t| t.1 != 0.0);
        terms
    }

    fn value<T: Scalar>(&self, angle: &[T], slide: &[T]) -> T {
        let mut sum = T::lift(self.constant);
        for &(f, factor) in &self.turns {
            sum += T::lift(factor) * angle[f];
        }
        for &(s, factor) in &self.slides {
            sum += T::lift(factor) * slide[s];
        }
        sum
    }

    /// Its rate, from the rates of frames and slides (velocities or accelerations).
    fn rate<T: Scalar>(&self, turn: &[T], slide: &[T]) -> T {
        let mut sum = T::lift(0.0);
        for &(f, factor) in &self.turns {
            sum += T::lift(factor) * turn[f];
        }
        for &(s, factor) in &self.slides {
            sum += T::lift(factor) * slide[s];
        }
        sum
    }

    fn of_class(&self, frames: &Frames, class: usize) -> f64 {
        let turns = self.turns.iter();
        turns
            .filter(|(f, _)| frames.frames[*f].class == class)
            .map(|(_, factor)| factor)
            .sum()
    }

    fn of_slide(&self, slide: usize) -> f64 {
        let slides = self.slides.iter();
        slides
            .filter(|(s, _)| *s == slide)
            .map(|(_, factor)| factor)
            .sum()
    }
}

fn add(list: &mut Vec<(usize, f64)>, index: usize, factor: f64) {
    match list.iter_mut().find(|(i, _)| *i == index) {
        Some((_, sum)) => *sum += factor,
        None => list.push((index, factor)),
    }
}

impl Row {
    pub(crate) fn all(lowered: &Lowered, frames: &Frames, tree: &Tree) -> Vec<Self> {
        let row = |ratio: &Ratio| Self {
            owner: ratio.owner,
            of: Terms::new(&ratio.of, frames, tree),
            law: ratio
                .law
                .as_ref()
                .map(|(law, by)| (law.clone(), Terms::new(by, frames, tree))),
            as_assembled: ratio.as_assembled,
            angular: ratio.angular,
        };
        lowered.ratios.iter().map(row).collect()
    }

    /// Both sums.
    fn terms(&self) -> impl Iterator<Item = &Terms> {
        std::iter::once(&self.of).chain(self.law.iter().map(|(_, by)| by))
    }

    /// The classes whose turning changes it, without the ground's.
    pub(crate) fn classes(&self, frames: &Frames) -> Vec<usize> {
        let mut classes: Vec<usize> = self
            .terms()
            .flat_map(|terms| {
                let class = |&(f, _): &(usize, f64)| frames.frames[f].class;
                let of: Vec<usize> = terms.turns.iter().map(class).collect();
                of.into_iter()
                    .filter(|&c| c > 0 && terms.of_class(frames, c) != 0.0)
            })
            .collect();
        classes.sort_unstable();
        classes.dedup();
        classes
    }

    /// Every frame it names.
    pub(crate) fn frames(&self) -> impl Iterator<Item = usize> {
        self.terms()
            .flat_map(|terms| terms.turns.iter().map(|t| t.0))
    }

    /// The slides it names.
    pub(crate) fn slides(&self) -> Vec<usize> {
        let mut slides: Vec<usize> = self
            .terms()
            .flat_map(|terms| terms.slides.iter().map(|t| t.0))
            .collect();
        slides.sort_unstable();
        slides.dedup();
        slides
    }

    /// Whether the law, if any, is of nothing that depends on these classes and slides.
    pub(crate) fn linear_in(
        &self,
        frames: &Frames,
        class: impl Fn(usize) -> bool,
        slide: impl Fn(usize) -> bool,
    ) -> bool {
        self.law.as_ref().is_none_or(|(_, by)| {
            !by.turns.iter().any(|&(f, _)| class(frames.frames[f].class))
                && !by.slides.iter().any(|&(s, _)| slide(s))
        })
    }

    /// Φ at counted angles and travels.
    pub(crate) fn value<T: Scalar>(&self, angle: &[T], slide: &[T]) -> T {
        let mut value = self.of.value(angle, slide);
        if let Some((law, by)) = &self.law {
            value -= by
                .value(angle, slide)
                .through(&law_at(law, by, angle, slide));
        }
        value
    }

    /// The slope of the law, and its own derivative: 0 where there is no law.
    fn slopes<T: Scalar>(&self, angle: &[T], slide: &[T]) -> (T, T) {
        let Some((law, by)) = &self.law else {
            return (T::lift(0.0), T::lift(0.0));
        };
        let x = by.value(angle, slide);
        let [_, d, dd, ddd] = law_at(law, by, angle, slide);
        (
            x.through(&[d, dd, ddd, 0.0]),
            x.through(&[dd, ddd, 0.0, 0.0]),
        )
    }

    /// The slope of the law: 0 where there is none.
    pub(crate) fn slope<T: Scalar>(&self, angle: &[T], slide: &[T]) -> T {
        self.slopes(angle, slide).0
    }

    /// Φ̇.
    pub(crate) fn rate<T: Scalar>(&self, angle: &[T], slide: &[T], turn: &[T], speed: &[T]) -> T {
        let mut rate = self.of.rate(turn, speed);
        if let Some((_, by)) = &self.law {
            rate -= self.slopes(angle, slide).0 * by.rate(turn, speed);
        }
        rate
    }

    /// Φ̈ from velocities and accelerations of frames and slides.
    pub(crate) fn acceleration<T: Scalar>(
        &self,
        angle: &[T],
        slide: &[T],
        velocity: (&[T], &[T]),
        acceleration: (&[T], &[T]),
    ) -> T {
        let mut value = self.of.rate(acceleration.0, acceleration.1);
        if let Some((_, by)) = &self.law {
            let (slope, bend) = self.slopes(angle, slide);
            let rate = by.rate(velocity.0, velocity.1);
            value -= slope * by.rate(acceleration.0, acceleration.1) + bend * rate * rate;
        }
        value
    }

    /// ∂Φ/∂ of each frame's angle and each slide's travel it names, to `turn` and `slide`.
    pub(crate) fn press<T: Scalar>(
        &self,
        angle: &[T],
        travel: &[T],
        mut turn: impl FnMut(usize, T),
        mut slide: impl FnMut(usize, T),
    ) {
        let minus_slope = -self.slopes(angle, travel).0;
        for (terms, by) in self.terms().zip([T::lift(1.0), minus_slope]) {
            for &(f, factor) in &terms.turns {
                turn(f, by * T::lift(factor));
            }
            for &(s, factor) in &terms.slides {
                slide(s, by * T::lift(factor));
            }
        }
    }

    /// ∂Φ/∂ of a class's angle.
    pub(crate) fn by_class<T: Scalar>(
        &self,
        frames: &Frames,
        class: usize,
        angle: &[T],
        slide: &[T],
    ) -> T {
        let mut value = T::lift(self.of.of_class(frames, class));
        if let Some((_, by)) = &self.law {
            value -= self.slopes(angle, slide).0 * T::lift(by.of_class(frames, class));
        }
        value
    }

    /// ∂Φ/∂ of a slide's travel.
    pub(crate) fn by_slide<T: Scalar>(&self, one: usize, angle: &[T], slide: &[T]) -> T {
        let mut value = T::lift(self.of.of_slide(one));
        if let Some((_, by)) = &self.law {
            value -= self.slopes(angle, slide).0 * T::lift(by.of_slide(one));
        }
        value
    }
}

/// The law and its derivatives at the value of its argument.
fn law_at<T: Scalar>(law: &Law, by: &Terms, angle: &[T], slide: &[T]) -> [f64; 4] {
    law.at(by.value(angle, slide).value())
}
