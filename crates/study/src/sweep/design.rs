//! The whole study: which values each of its points has. The values of point k depend on the study
//! and on k alone, so that any thread, shard or run may compute any of them.

use super::axes::Axis;
use super::error::SweepError;
use dwell_scene::Scene;

/// Most points of a study, all of which are held at once when it is written out.
const MOST_POINTS: u64 = 20_000_000;

/// The points of a study: every combination of what is listed, the first axis the slowest; for each of them
/// all samples, which are the same ones, so that combinations compare without noise.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Design {
    pub(crate) axes: Vec<Axis>,
    /// One where nothing is random.
    pub(crate) samples: u64,
    pub(crate) seed: u64,
    pub(crate) points: u64,
}

impl Design {
    /// # Errors
    /// [`SweepError::Axis`] or [`SweepError::Design`].
    pub(crate) fn new(
        scene: &Scene,
        vary: &[String],
        samples: Option<u64>,
        seed: u64,
    ) -> Result<Self, SweepError> {
        let design = |message: &str| Err(SweepError::Design(message.to_owned()));
        let axes: Vec<Axis> = vary
            .iter()
            .map(|given| Axis::parse(scene, given))
            .collect::<Result<_, _>>()?;
        if axes.is_empty() {
            return design("nothing is varied: give --vary PATH=FROM:TO:COUNT, or several");
        }
        for (k, axis) in axes.iter().enumerate() {
            if axes[..k].iter().any(|before| before.path == axis.path) {
                return design(&format!("`{}` is varied twice", axis.path));
            }
        }
        let random = axes.iter().any(Axis::is_random);
        let samples = match (random, samples) {
            (true, None) => {
                return design("something is drawn at random: say how often with --samples");
            }
            (true, Some(0)) => return design("no samples: --samples is 1 or more"),
            (false, Some(_)) => {
                return design("nothing is drawn at random, so --samples has no meaning");
            }
            (_, samples) => samples.unwrap_or(1),
        };
        let mut counts = axes.iter().map(Axis::count);
        let points = counts.try_fold(samples, u64::checked_mul);
        match points {
            Some(points) if points <= MOST_POINTS => Ok(Self {
                axes,
                samples,
                seed,
                points,
            }),
            _ => design(&format!(
                "more than {MOST_POINTS} points: take fewer values or samples, or several studies"
            )),
        }
    }

    /// Whether something is drawn at random.
    pub(crate) fn is_random(&self) -> bool {
        self.axes.iter().any(Axis::is_random)
    }

    /// The values of point `k`, by axis, in the scene's units.
    pub(crate) fn values(&self, k: u64) -> Vec<f64> {
        let sample = k % self.samples;
        let mut rest = k / self.samples;
        let mut values = vec![0.0; self.axes.len()];
        for (number, (axis, value)) in self.axes.iter().zip(&mut values).enumerate().rev() {
            *value = axis.value(rest % axis.count(), (self.seed, number as u32, sample));
            rest /= axis.count();
        }
        values
    }
}

/// A part of a study: of every so many points the one whose turn it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which, from 1 on.
    pub part: u64,
    /// Of how many.
    pub of: u64,
}

impl Shard {
    /// Whether a point is its own.
    pub(crate) fn has(self, k: u64) -> bool {
        k % self.of == self.part - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = SweepError;

    fn from_str(text: &str) -> Result<Self, SweepError> {
        let read = || {
            let (part, of) = text.split_once('/')?;
            let (part, of) = (part.trim().parse().ok()?, of.trim().parse().ok()?);
            (1..=of).contains(&part).then_some(Self { part, of })
        };
        read().ok_or_else(|| SweepError::Shard(text.to_owned()))
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}
