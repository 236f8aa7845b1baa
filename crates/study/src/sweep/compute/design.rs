//! The design of a sweep: the input values of each point. They depend on the design and on the index
//! alone, so that any thread, shard or run may compute any point.

use crate::explain::{StudyError, SweepError};
use crate::sweep::compute::Axis;
use crate::sweep::compute::tied::Tie;
use dwell_scene::SceneFile;

/// Maximum number of points: a result of all of them, 8 bytes each, is in memory for its mean and quantiles.
const MAX_POINTS: u64 = 1_000_000_000;

/// The points of a sweep: every combination of listed values, the first axis varying slowest, and for each the
/// same random samples, so that combinations compare without noise.
#[derive(Debug)]
pub struct Design {
    pub(crate) axes: Vec<Axis>,
    /// The numbers that follow from these.
    pub(crate) ties: Vec<Tie>,
    /// Number of random samples; 1 without random axes.
    pub(crate) samples: u64,
    pub(crate) seed: u64,
    pub(crate) points: u64,
}

impl Design {
    /// # Errors
    /// [`SweepError::Axis`] or [`SweepError::Design`].
    pub(crate) fn new(
        scene: &SceneFile,
        vary: &[String],
        samples: Option<u64>,
        seed: u64,
    ) -> Result<Self, SweepError> {
        let design = |message: &str| Err(SweepError::Design(message.to_owned()));
        let axes = vary.iter().map(|given| Axis::parse(scene, given));
        let axes: Vec<Axis> = axes.collect::<Result<_, _>>()?;
        if axes.is_empty() {
            return design("no axis: give one or more --vary PATH=FROM:TO:COUNT");
        }
        for (k, axis) in axes.iter().enumerate() {
            if axes[..k].iter().any(|before| before.path == axis.path) {
                return design(&format!("`{}` is varied twice", axis.path));
            }
        }
        let mut found = Self {
            axes,
            ties: Vec::new(),
            samples: samples.unwrap_or(1),
            seed,
            points: 0,
        };
        match (found.is_random(), samples) {
            (true, None) => return design("random axes need a number of samples: give --samples"),
            (true, Some(0)) => return design("--samples must be at least 1"),
            (false, Some(_)) => return design("--samples needs a random axis"),
            _ => {}
        }
        let mut counts = found.axes.iter().map(Axis::count);
        let points = counts.try_fold(found.samples, u64::checked_mul);
        let Some(points) = points.filter(|points| *points <= MAX_POINTS) else {
            let fault = "use fewer values or samples, or several studies";
            return design(&format!("more than {MAX_POINTS} points: {fault}"));
        };
        found.points = points;
        Ok(found)
    }

    /// The points with the tied numbers of the scene, and those that are `given`.
    ///
    /// # Errors
    /// [`StudyError`] as of [`Tie::all`].
    pub(crate) fn tied(mut self, scene: &SceneFile, given: &[String]) -> Result<Self, StudyError> {
        self.ties = Tie::all(scene, &self.axes, given)?;
        Ok(self)
    }

    /// Whether an axis is random.
    pub(crate) fn is_random(&self) -> bool {
        self.axes.iter().any(Axis::is_random)
    }

    /// The numbers of the variant at some values of the axes: these, then those that follow from them.
    pub(crate) fn numbers(&self, values: &[f64]) -> Vec<f64> {
        let mut numbers = values.to_vec();
        for tie in &self.ties {
            numbers.push(tie.value(&numbers));
        }
        numbers
    }

    /// The derivatives of these numbers by the value of an axis.
    pub(crate) fn slopes(&self, numbers: &[f64], axis: usize) -> Vec<f64> {
        let mut slopes = vec![0.0; self.axes.len()];
        slopes[axis] = 1.0;
        for tie in &self.ties {
            slopes.push(tie.slope(numbers, &slopes));
        }
        slopes
    }

    /// The paths of these numbers.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &str> {
        let axes = self.axes.iter().map(|axis| axis.path.as_str());
        axes.chain(self.ties.iter().map(|tie| tie.number.path.as_str()))
    }

    /// Numbers of a variant with their paths.
    pub(crate) fn assigned(&self, numbers: &[f64]) -> Vec<(&str, f64)> {
        self.paths().zip(numbers.iter().copied()).collect()
    }

    /// The values of point `k`, by axis, in the scene's units.
    pub(crate) fn values(&self, k: u64) -> Vec<f64> {
        let sample = k % self.samples;
        let mut rest = k / self.samples;
        let mut values = vec![0.0; self.axes.len()];
        for (number, (axis, value)) in self.axes.iter().zip(&mut values).enumerate().rev() {
            *value = axis.value(rest % axis.count(), self.seed, number as u32, sample);
            rest /= axis.count();
        }
        values
    }
}

/// A part of a study: every n-th block of its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub part: u64,
    /// Number of parts.
    pub of: u64,
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
