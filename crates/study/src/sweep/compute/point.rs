//! One point of a sweep: the scene with its input values, and the results.

use crate::explain::{StudyError, SweepError};
use crate::number_format::digits;
use crate::sweep::compute::SweptScene;
use crate::sweep::compute::available::Available;
use crate::sweep::compute::extremes::ExtremeValues;
use crate::sweep::compute::scene_results::{available_quantities, compute_results};
use crate::sweep::compute::targets::Target;
use crate::trajectory::compute::{STATISTICS, Statistic, is_prefix_of};
use dwell_laws::expression::nearest;
use dwell_scene::{ResultLimit, SceneFile, SceneLocation};
use std::collections::BTreeSet;

/// The computation that yields a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ResultKind {
    /// Smallest and largest m, smallest and largest ½m′.
    Inertia,
    /// The coordinates at which they occur: only on request.
    InertiaPlace,
    /// Lower and upper end of the range.
    Range,
    /// Period and energy of the free motion.
    Orbit,
    /// A statistic along the trajectory, by reaction of the mechanism.
    Reaction(Statistic),
    /// Largest absolute values in the free rotation without loads, by reaction of the mechanism.
    FreeReaction,
    /// The coordinates at which they occur: only on request.
    FreeReactionPlace,
    /// A statistic along the trajectory, by actuator.
    ActuatorForce(Statistic),
    /// A statistic along the trajectory of any other quantity.
    Along(Statistic),
    /// Results of the free motion: computed only on request, as they take an integration.
    Motion,
    /// Results of the steady cycle: computed only on request.
    Cycle,
}

/// A result by its name and unit.
#[derive(Debug)]
pub(crate) struct SweepQuantity {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) kind: ResultKind,
    /// Its index among the results of its kind.
    pub(crate) index: usize,
}

impl ResultKind {
    /// Its statistic, if it is one along the trajectory.
    pub(crate) fn statistic(self) -> Option<Statistic> {
        match self {
            Self::Reaction(of) | Self::ActuatorForce(of) | Self::Along(of) => Some(of),
            _ => None,
        }
    }

    /// Whether it is computed only if a request names it as a whole.
    fn is_by_whole_name(self) -> bool {
        let is_peak = matches!(
            self,
            Self::Reaction(Statistic::MaxAbs) | Self::ActuatorForce(Statistic::MaxAbs)
        );
        self.statistic().is_some() && !is_peak
    }

    /// The word by which a request may name all results of a kind that is not computed by default.
    fn word(self) -> Option<&'static str> {
        match self {
            Self::Motion => Some("motion"),
            Self::Cycle => Some("cycle"),
            Self::InertiaPlace | Self::FreeReactionPlace => Some("place"),
            _ => None,
        }
    }

    pub(super) fn is_by_default(self) -> bool {
        self.word().is_none() && !self.is_by_whole_name()
    }
}

impl SweepQuantity {
    /// Whether it is the smallest or largest value along a motion or a range.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for the summary"))]
    pub(crate) fn is_extremum(&self) -> bool {
        use Statistic::{Max, MaxAbs, Min, PeakPower, Stroke};
        match self.kind {
            ResultKind::Inertia | ResultKind::FreeReaction => true,
            kind => matches!(
                kind.statistic(),
                Some(Max | MaxAbs | Min | PeakPower | Stroke)
            ),
        }
    }

    /// Whether a request names it: its whole name, or the part before one of its dots.
    fn matches(&self, request: &str) -> bool {
        is_prefix_of(request, &self.name) && !(self.kind.is_by_whole_name() && request != self.name)
    }
}

/// The results to compute at every point.
#[derive(Debug)]
pub struct RequestedQuantities {
    pub(crate) quantities: Vec<SweepQuantity>,
    /// A line for each body far from its approximate angle.
    pub(crate) notes: String,
    /// The limits, each of the quantity at this index.
    pub(crate) limits: Vec<(usize, ResultLimit)>,
    /// The tables of wanted values.
    pub(super) targets: Vec<Target>,
}

/// The beginning of the message of a point beyond a limit.
pub(crate) const LEFT_OUT: &str = "left out: ";

/// The results of a point: a value for each quantity, NaN where there is none, and the reason.
#[derive(Clone)]
pub(crate) struct PointResult {
    pub(crate) values: Vec<f64>,
    pub(crate) message: Option<String>,
}

/// A finished point.
#[derive(Clone)]
pub(crate) struct Row {
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for the store"))]
    pub(crate) index: u64,
    pub(crate) inputs: Vec<f64>,
    pub(crate) result: PointResult,
}

impl RequestedQuantities {
    /// The requested quantities, or all that the scene has.
    ///
    /// # Errors
    /// [`StudyError`] where the unchanged scene cannot be assembled; [`SweepError::Result`].
    #[cfg(test)]
    pub(crate) fn new(scene: &impl SweptScene, requests: &[String]) -> Result<Self, StudyError> {
        Self::within(scene, requests, &[])
    }

    /// The requested quantities, or all that the scene has, and those of its limits and of the `given` ones.
    ///
    /// # Errors
    /// [`StudyError`] where the unchanged scene cannot be assembled; [`SweepError`].
    pub(crate) fn within(
        scene: &impl SweptScene,
        requests: &[String],
        given: &[String],
    ) -> Result<Self, StudyError> {
        let Available {
            mut quantities,
            notes,
            targets,
        } = available_quantities(scene)?;
        let is_known = |request: &&String| quantities.iter().any(|q| q.matches(request));
        if let Some(request) = requests.iter().find(|request| !is_known(request)) {
            return Err(unknown_result(request, &quantities).into());
        }
        if quantities.is_empty() {
            let message = "this scene has no results to sweep: add a [prescribed] motion or a [coordinate-sweep]";
            return Err(SweepError::Design(message.to_owned()).into());
        }
        let limits = limits(scene, given, &quantities)?;
        quantities.retain(|q| {
            let is_requested = match requests {
                [] => q.kind.is_by_default(),
                requests => requests.iter().any(|request| q.matches(request)),
            };
            is_requested || limits.iter().any(|limit| limit.result == q.name)
        });
        if quantities.is_empty() {
            let message = "no result is computed unless it is requested: name some with --result, as in --result motion or --result cycle";
            return Err(SweepError::Design(message.to_owned()).into());
        }
        let of_quantity = |limit: ResultLimit| {
            let found = quantities.iter().position(|q| q.name == limit.result);
            found.map(|k| (k, limit))
        };
        Ok(Self {
            limits: limits.into_iter().filter_map(of_quantity).collect(),
            quantities,
            notes,
            targets,
        })
    }

    /// Computes the results with some numbers of the scene replaced. A result that fails has a message instead of a
    /// value.
    pub(crate) fn evaluate(&self, scene: &impl SweptScene, values: &[(&str, f64)]) -> PointResult {
        let mut result = PointResult {
            values: vec![f64::NAN; self.quantities.len()],
            message: None,
        };
        let mut results = Results {
            quantities: &self.quantities,
            cells: &mut result.values,
            failed: None,
        };
        let varied = scene.varied(values).map_err(StudyError::from);
        let done = varied.and_then(|scene| compute_results(&scene, self, &mut results));
        let done = done.and_then(|()| results.failed.map_or(Ok(()), Err));
        result.message = done.err().map(|error| first_message(&error));
        result
    }

    /// The limits as text.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for the store"))]
    pub(crate) fn limit_texts(&self) -> impl Iterator<Item = String> {
        self.limits.iter().map(|(_, limit)| limit.to_string())
    }

    /// A point without its values if it is beyond a limit.
    pub(crate) fn limited(&self, mut result: PointResult) -> PointResult {
        let is_beyond = |&&(k, ref limit): &&(usize, ResultLimit)| {
            let over = result.values[k] - limit.limit;
            over != 0.0 && (over > 0.0) == limit.is_upper
        };
        if let Some((k, limit)) = self.limits.iter().find(is_beyond) {
            let value = digits(result.values[*k], 6);
            result.message = Some(format!("{LEFT_OUT}{value}, but {limit}"));
            result.values.fill(f64::NAN);
        }
        result
    }

    /// The requested statistics along the trajectory.
    pub(super) fn along(&self) -> impl Iterator<Item = (&SweepQuantity, Statistic)> + Clone {
        let quantities = self.quantities.iter();
        quantities.filter_map(|q| Some((q, q.kind.statistic()?)))
    }

    /// Whether a quantity of some kinds is requested.
    pub(super) fn includes(&self, kinds: &[ResultKind]) -> bool {
        self.quantities.iter().any(|q| kinds.contains(&q.kind))
    }

    /// The indices of the requested quantities of some kinds.
    pub(crate) fn indices(&self, kinds: &[ResultKind]) -> Vec<usize> {
        let quantities = self.quantities.iter().filter(|q| kinds.contains(&q.kind));
        let indices: BTreeSet<usize> = quantities.map(|q| q.index).collect();
        indices.into_iter().collect()
    }
}

/// The limits of a scene, and those that are `given`.
fn limits(
    scene: &SceneFile,
    given: &[String],
    quantities: &[SweepQuantity],
) -> Result<Vec<ResultLimit>, StudyError> {
    let is_known = |name: &str| quantities.iter().any(|q| q.name == name);
    let mut all = scene.sweep_section.limits.clone();
    if let Some(k) = all.iter().position(|limit| !is_known(&limit.result)) {
        let error = unknown_result(&all[k].result, quantities);
        let place = (SceneLocation::Limit(k), "no such result".to_owned());
        return Err(scene
            .error(error.to_string(), error.help(), &[place])
            .into());
    }
    for text in given {
        let refuse = |reason, help| SweepError::Axis {
            option: "--subject-to",
            given: text.clone(),
            reason,
            help,
        };
        let form = "write it as `m.max <= 2`, in the unit of the result";
        let limit = ResultLimit::parse(text);
        let limit = limit.map_err(|reason| refuse(reason, form.to_owned()))?;
        if !is_known(&limit.result) {
            let error = unknown_result(&limit.result, quantities);
            return Err(refuse(error.to_string(), error.help().unwrap_or_default()).into());
        }
        all.push(limit);
    }
    Ok(all)
}

/// The error of a request that names no result: of the many that are computed on request, a word or a form is enough.
fn unknown_result(request: &str, quantities: &[SweepQuantity]) -> SweepError {
    let always = quantities.iter().filter(|q| q.kind.is_by_default());
    let mut known: Vec<String> = always.map(|q| q.name.clone()).collect();
    let words: BTreeSet<&str> = quantities.iter().filter_map(|q| q.kind.word()).collect();
    known.extend(words.into_iter().map(str::to_owned));
    if quantities.iter().any(|q| q.kind.is_by_whole_name()) {
        let ends: Vec<&str> = STATISTICS.iter().map(|(_, name, _)| *name).collect();
        known.push(format!("COLUMN.{} of its columns", ends.join("|")));
    }
    let names = quantities.iter().map(|q| q.name.as_str());
    SweepError::Result {
        name: request.to_owned(),
        near: nearest(request, names).map(str::to_owned),
        known,
    }
}

/// The results of a point during the computation, and the first error.
pub struct Results<'a> {
    quantities: &'a [SweepQuantity],
    cells: &'a mut [f64],
    failed: Option<StudyError>,
}

impl Results<'_> {
    /// Fills the cells of a kind of quantities with their values, or records the error.
    fn fill<T>(
        &mut self,
        is_filled: impl Fn(ResultKind) -> bool,
        computed: Result<T, StudyError>,
        of: impl Fn(&T, &SweepQuantity) -> Option<f64>,
    ) {
        match computed {
            Err(error) => {
                self.failed.get_or_insert(error);
            }
            Ok(values) => {
                let cells = self.quantities.iter().zip(&mut *self.cells);
                for (quantity, cell) in cells.filter(|(q, _)| is_filled(q.kind)) {
                    *cell = of(&values, quantity).unwrap_or(f64::NAN);
                }
            }
        }
    }

    pub(crate) fn set(&mut self, kind: ResultKind, computed: Result<Vec<f64>, StudyError>) {
        let is_filled = |of| of == kind;
        self.fill(is_filled, computed, |values, of| {
            values.get(of.index).copied()
        });
    }

    /// Values by the names of their quantities: of a kind whose quantities are not the same in every variant.
    pub(crate) fn set_named(
        &mut self,
        kind: ResultKind,
        computed: Result<Vec<(String, f64)>, StudyError>,
    ) {
        let is_filled = |of| of == kind;
        self.fill(is_filled, computed, |values, of| named(values, of));
    }

    /// The statistics along the trajectory, by the names of their quantities.
    pub(crate) fn set_along(&mut self, computed: Result<Vec<(String, f64)>, StudyError>) {
        let is_filled = |of: ResultKind| of.statistic().is_some();
        self.fill(is_filled, computed, |values, of| named(values, of));
    }

    /// Values with their places.
    pub(crate) fn set_points(
        &mut self,
        [values, places]: [ResultKind; 2],
        computed: Result<ExtremeValues, StudyError>,
    ) {
        if let Ok(points) = &computed {
            self.set(places, Ok(points.iter().map(|[place, _]| *place).collect()));
        }
        let value_of_each =
            |points: ExtremeValues| points.iter().map(|[_, value]| *value).collect();
        self.set(values, computed.map(value_of_each));
    }
}

/// The value of that name.
fn named(values: &[(String, f64)], of: &SweepQuantity) -> Option<f64> {
    let mut values = values.iter();
    values.find(|(name, _)| *name == of.name).map(|of| of.1)
}

/// The first sentence of an error: of several, the first.
fn first_message(error: &StudyError) -> String {
    match error {
        StudyError::Scene(scene) => {
            let first = scene.errors().first();
            first.map_or_else(String::new, |first| first.message.clone())
        }
        other => other.to_string(),
    }
}
