//! Many variants of one scene.

use crate::column_table::ColumnTable;
use crate::error::Error;
use crate::mechanism::scene::Scene;
use dwell_study::{Progress, SceneTask, Step, StudyScene, with_dimension};
use dwell_study::{SweepRequest, compute_request};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A parameter sweep: numbers of a scene over grids, lists or random samples, and the results of every combination, computed on all
/// cores. The results are those of `dwell sweep`: `m.min`, `m.max`, `period`, `phi.actuator_force.max_abs`,
/// `guide.normal.max_abs` …
///
/// ```
/// let scene = dwell::Scene::read("../../docs/slider.toml")?;
/// let table = dwell::Sweep::new(&scene)
///     .vary("rod.mass", "=0.8:1.6:5")
///     .result("A.x.max_abs")
///     .run()?;
/// assert_eq!(table.column("rod.mass")?.len(), 5);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sweep {
    scene: Scene,
    vary: Vec<String>,
    tied: Vec<String>,
    samples: Option<u64>,
    seed: u64,
    results: Vec<String>,
    limits: Vec<String>,
}

impl Sweep {
    /// A sweep of a scene.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn new(scene: &Scene) -> Self {
        Self {
            scene: scene.clone(),
            vary: Vec::new(),
            tied: Vec::new(),
            samples: None,
            seed: 0,
            results: Vec::new(),
            limits: Vec::new(),
        }
    }

    /// Varies a number, in the scene's unit: `=FROM:TO:COUNT`, `=A,B,C`, `~normal(MEAN,SD)`,
    /// `~uniform(FROM,TO)`, `±TOLERANCE` or `±PERCENT%`.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene).vary("rod.points.C[0]", "±0.2").samples(1000, 1);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    #[must_use]
    pub fn vary(mut self, path: &str, variation: &str) -> Self {
        self.vary.push(format!("{path}{variation}"));
        self
    }

    /// Ties a number to others: it is the value of an expression of parameters, and of paths between backticks.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene).vary("rod.mass", "=0.8:1.6:5");
    /// let table = sweep.tied("rod.inertia", "`rod.mass` * 7e-3").result("m.max").run()?;
    /// # Ok::<(), dwell::Error>(())
    /// ```
    #[must_use]
    pub fn tied(mut self, path: &str, expression: &str) -> Self {
        self.tied.push(format!("{path}={expression}"));
        self
    }

    /// Leaves out the variants beyond a limit, `RESULT <= LIMIT` or `RESULT >= LIMIT`: they have a message instead of results.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene).vary("rod.mass", "=0.8:1.6:5");
    /// let table = sweep.subject_to("m.max <= 1e-3").run()?;
    /// # Ok::<(), dwell::Error>(())
    /// ```
    #[must_use]
    pub fn subject_to(mut self, limit: &str) -> Self {
        self.limits.push(limit.to_owned());
        self
    }

    /// Sets the number of random samples and the seed.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene).vary("rod.mass", "±5%").samples(1000, 1);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    #[must_use]
    pub fn samples(mut self, samples: u64, seed: u64) -> Self {
        self.samples = Some(samples);
        self.seed = seed;
        self
    }

    /// Adds a result to compute; by default all results that the scene has are computed.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene).result("m.max");
    /// # Ok::<(), dwell::Error>(())
    /// ```
    #[must_use]
    pub fn result(mut self, name: &str) -> Self {
        self.results.push(name.to_owned());
        self
    }

    /// Computes all combinations.
    ///
    /// # Errors
    /// [`Error::Study`] if the sweep is invalid, or the unchanged scene cannot be assembled.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let table = dwell::Sweep::new(&scene).vary("rod.mass", "=1,1.2").result("m.max").run()?;
    /// assert_eq!(table.column("m.max")?.len(), 2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn run(&self) -> Result<SweepResults, Error> {
        self.run_with_progress(&|_, _| {})
    }

    /// Computes all combinations, and calls `progress` after each block, from any thread, with the number of completed blocks and of
    /// all blocks.
    ///
    /// # Errors
    /// As of [`run`](Self::run).
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene).vary("rod.mass", "=1,1.2").result("m.max");
    /// sweep.run_with_progress(&|done, all| eprintln!("{done} of {all}"))?;
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn run_with_progress(
        &self,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<SweepResults, Error> {
        let done = AtomicUsize::new(0);
        let step = |step: Step<'_>| progress(done.fetch_add(1, Ordering::Relaxed) + 1, step.total);
        let task = ComputeSweep {
            sweep: self,
            progress: &step,
        };
        with_dimension(self.scene.inner(), task)
    }
}

/// The computation of a sweep.
struct ComputeSweep<'a> {
    sweep: &'a Sweep,
    progress: Progress<'a>,
}

impl SceneTask for ComputeSweep<'_> {
    type Output = Result<SweepResults, Error>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        let (sweep, progress) = (self.sweep, self.progress);
        let request = SweepRequest {
            vary: &sweep.vary,
            tied: &sweep.tied,
            samples: sweep.samples,
            seed: sweep.seed,
            requests: &sweep.results,
            limits: &sweep.limits,
        };
        let swept = compute_request(scene, &request, progress)?;
        Ok(SweepResults {
            table: ColumnTable {
                columns: swept.table.columns,
                rows: swept.table.rows,
            },
            messages: swept.messages,
        })
    }
}

/// The results of a sweep: a row for each combination, NaN where a variant has no such result.
///
/// ```
/// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
/// let table = dwell::Sweep::new(&scene).vary("rod.mass", "=1,1.2").result("m").run()?;
/// let names: Vec<&str> = table.columns().map(|(name, _)| name).collect();
/// assert_eq!(names, ["rod.mass", "m.min", "m.max"]);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SweepResults {
    table: ColumnTable,
    /// By row: the reason if results are missing.
    pub messages: Vec<Option<String>>,
}

impl SweepResults {
    /// Names and units of the columns: the varied numbers, then the results.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let table = dwell::Sweep::new(&scene).vary("rod.mass", "=1,1.2").result("m.max").run()?;
    /// assert_eq!(table.columns().last(), Some(("m.max", "kg m2")));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn columns(&self) -> impl Iterator<Item = (&str, &str)> + Clone {
        self.table.columns()
    }

    /// A column.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// # let table = dwell::Sweep::new(&scene).vary("rod.mass", "=1,1.2").result("m.max").run()?;
    /// assert_eq!(table.column("rod.mass")?, [1.0, 1.2]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn column(&self, name: &str) -> Result<Vec<f64>, Error> {
        self.table.column(name)
    }
}
