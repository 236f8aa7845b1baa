//! Many variants of one scene.

use crate::column_table::ColumnTable;
use crate::error::Error;
use crate::mechanism::scene::Scene;
use crate::space;
use dwell_study::Step;
use dwell_study::sweep::compute_sweep;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A parameter sweep: numbers of a scene over grids, lists or at random, and results of every combination, computed on all
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
    scene: VariedScene,
    vary: Vec<String>,
    samples: Option<u64>,
    seed: u64,
    results: Vec<String>,
}

impl Sweep {
    /// A sweep of a scene.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let sweep = dwell::Sweep::new(&scene);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn new(scene: impl Into<VariedScene>) -> Self {
        Self {
            scene: scene.into(),
            vary: Vec::new(),
            samples: None,
            seed: 0,
            results: Vec::new(),
        }
    }

    /// The same with a number that varies, in the scene's unit: `=FROM:TO:COUNT`, `=A,B,C`, `~normal(MEAN,SD)`,
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

    /// The same with a number of random samples and the seed of the random numbers.
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

    /// The same with a result to compute; without any, all that the scene has are computed.
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
    /// [`Error::Study`] where the sweep is not valid, or the unchanged scene cannot be assembled.
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

    /// The same, calling `progress` after each block of combinations, from any thread, with the number of blocks that are done and that of
    /// all.
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
        let (vary, results) = (&self.vary, &self.results);
        let (samples, seed) = (self.samples, self.seed);
        let done = AtomicUsize::new(0);
        let step = |step: Step<'_>| progress(done.fetch_add(1, Ordering::Relaxed) + 1, step.total);
        let swept = match &self.scene {
            VariedScene::Plane(scene) => {
                compute_sweep(scene.inner(), vary, samples, seed, results, &step)
            }
            VariedScene::Space(scene) => {
                compute_sweep(scene.inner(), vary, samples, seed, results, &step)
            }
        }?;
        Ok(SweepResults {
            table: ColumnTable {
                columns: swept.table.columns,
                rows: swept.table.rows,
            },
            messages: swept.messages,
        })
    }
}

/// A scene whose numbers vary: in the plane or in space.
///
/// ```
/// let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
/// let table = dwell::Sweep::new(&scene).vary("crank.mass", "=0.8,0.9").result("m.max").run()?;
/// let largest = table.column("m.max")?;
/// assert!(largest[1] > largest[0]);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub enum VariedScene {
    /// In the plane.
    Plane(Scene),
    /// In space.
    Space(space::Scene),
}

impl From<&Scene> for VariedScene {
    fn from(scene: &Scene) -> Self {
        Self::Plane(scene.clone())
    }
}

impl From<&space::Scene> for VariedScene {
    fn from(scene: &space::Scene) -> Self {
        Self::Space(scene.clone())
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
    /// By row: why results are missing.
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
