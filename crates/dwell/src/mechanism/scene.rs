//! Scenes.

use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::mechanism::parts::{LoadFunction, Magnitude};
use dwell_study::{SceneTask, StudyError, StudyScene, describe_scene, with_dimension};
use std::path::Path;
use std::sync::Arc;

/// A scene: the checked description of a mechanism with its masses, loads, drives and motions, in the format of
/// `docs/scene-format.md`. Its points have two numbers in the plane, and three in space.
///
/// ```
/// let scene = dwell::Scene::read("../../docs/slider.toml")?;
/// assert_eq!(scene.title(), "Offset slider-crank");
/// let in_space = dwell::Scene::read("../../validation/spatial/rssr.toml")?;
/// assert_eq!(in_space.title(), "Spatial crank-rocker with two balls");
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene(Arc<dwell_scene::Scene>);

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`Error::Study`] with all errors in the file, each with its place.
    ///
    /// ```
    /// let error = dwell::Scene::read("slidr.toml").unwrap_err();
    /// assert_eq!(error.to_string(), "there is no file `slidr.toml`");
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self(Arc::new(dwell_scene::Scene::read(path)?)))
    }

    /// Reads the text of a scene.
    ///
    /// # Errors
    /// As [`Scene::read`].
    ///
    /// ```
    /// let scene = dwell::Scene::parse(
    ///     r#"
    ///     bodies.ground.points = { O = [0, 0] }
    ///     bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0] }
    ///     joints.O = { revolute = ["ground.O", "bob.O"] }
    ///     actuators.phi = { angle = ["ground", "bob"] }
    ///     "#,
    /// )?;
    /// assert_eq!(scene.value("bob.mass")?, 2.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, Error> {
        Ok(Self(Arc::new(dwell_scene::Scene::parse(
            "scene.toml",
            text,
        )?)))
    }

    /// Its title.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// assert_eq!(scene.title(), "Offset slider-crank");
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn title(&self) -> &str {
        &self.0.title
    }

    /// Its text, with the changes of [`with_value`](Self::with_value).
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// assert!(scene.text().contains("[bodies.crank]"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn text(&self) -> &str {
        self.0.source.inner()
    }

    /// Warnings: numbers that may be unintended.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// assert_eq!(scene.warnings().count(), 0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn warnings(&self) -> impl Iterator<Item = &str> {
        self.0.warnings.iter().map(|w| w.message.as_str())
    }

    /// A number of the scene by its path, in the scene's own unit: `crank.mass`, `rod.points.C[0]`,
    /// `loads.brake.damping`.
    ///
    /// # Errors
    /// [`Error::Study`] if there is no number with this path.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// assert_eq!(scene.value("rod.points.C[0]")?, 280.0); // mm
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn value(&self, path: &str) -> Result<f64, Error> {
        Ok(self.0.value(path)?)
    }

    /// A copy of the scene with a number replaced.
    ///
    /// # Errors
    /// [`Error::Study`] if there is no number with this path, or the scene is invalid with the new value.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let heavier = scene.with_value("piston.mass", 1.4)?;
    /// assert_eq!(heavier.value("piston.mass")?, 1.4);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn with_value(&self, path: &str, value: f64) -> Result<Self, Error> {
        Ok(Self(Arc::new(self.0.with_values(&[(path, value)])?)))
    }

    /// The output of `dwell check`: degrees of freedom, range, groups, assembly modes, loads and requests.
    ///
    /// # Errors
    /// [`Error::Study`] if the mechanism cannot be assembled.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// assert!(scene.describe()?.contains("phi rotates fully"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn describe(&self) -> Result<String, Error> {
        Ok(with_dimension(&self.0, Describe)?)
    }

    /// A copy of the scene whose load has a magnitude given by a function of signals: `t` (s), coordinates (rad or m) and
    /// velocities such as `phi.velocity`, in the given order.
    ///
    /// # Errors
    /// [`Error::Study`] if there is no such load or signal.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let scene = scene.with_function("gas", &["phi"], |s| 400.0 * (1.0 + s[0].cos()))?;
    /// # assert!(scene.assemble().is_ok());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn with_function(
        &self,
        load: &str,
        signals: &[&str],
        function: impl Fn(&[f64]) -> f64 + Send + Sync + 'static,
    ) -> Result<Self, Error> {
        let magnitude = Magnitude::function(signals, function);
        self.with_magnitude(load, &magnitude)
    }

    /// A copy of the scene whose load has a [function](Magnitude::function) with
    /// [breakpoints](Magnitude::breakpoints) as its magnitude.
    ///
    /// # Errors
    /// [`Error::Study`] if there is no such load or signal. Other kinds of magnitudes have no effect.
    ///
    /// ```
    /// # let scene = dwell::Scene::read("../../docs/slider.toml")?;
    /// let gas = dwell::Magnitude::function(&["t", "phi"], |s| if s[0] < 0.1 { 0.0 } else { 400.0 * s[1].cos() });
    /// let scene = scene.with_magnitude("gas", &gas.breakpoints("t", &[0.1]))?;
    /// # assert!(scene.assemble().is_ok());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn with_magnitude(&self, load: &str, magnitude: &Magnitude) -> Result<Self, Error> {
        let function = magnitude.load_function();
        function.map_or_else(|| Ok(self.clone()), |of| self.with_load_function(load, of))
    }

    /// Assembles its mechanism.
    ///
    /// # Errors
    /// [`Error::Study`] if the mechanism cannot be assembled, does not move, or a load does not fit it.
    ///
    /// ```
    /// let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.actuators(), ["phi"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn assemble(&self) -> Result<Mechanism, Error> {
        Mechanism::new(self.clone())
    }

    pub(crate) fn inner(&self) -> &dwell_scene::Scene {
        &self.0
    }

    /// A copy of the scene whose load has a magnitude given by a function.
    pub(crate) fn with_load_function(&self, load: &str, of: &LoadFunction) -> Result<Self, Error> {
        let signals: Vec<&str> = of.signals.iter().map(String::as_str).collect();
        let breakpoints: Vec<_> = of
            .breakpoints
            .iter()
            .map(|(s, v)| (&s[..], &v[..]))
            .collect();
        let scene = (*self.0).clone().with_load_function(
            load,
            &signals,
            of.function.clone(),
            &breakpoints,
        )?;
        Ok(Self(Arc::new(scene)))
    }
}

struct Describe;

impl SceneTask for Describe {
    type Output = Result<String, StudyError>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        describe_scene(scene)
    }
}
