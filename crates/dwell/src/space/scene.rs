//! A mechanism in space as a scene file describes it.

use crate::error::Error;
use crate::space::mechanism::Mechanism;
use dwell_geometry::BodyId;
use dwell_geometry::space::Vec3;
use std::path::Path;
use std::sync::Arc;

/// The description of a mechanism in space, read and checked.
///
/// ```
/// let scene = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?;
/// assert_eq!(scene.title(), "Bricard linkage");
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene(Arc<dwell_scene::SpaceScene>);

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`Error::Study`] with all that is wrong, and where.
    ///
    /// ```
    /// assert!(dwell::space::Scene::read("nowhere.toml").is_err());
    /// ```
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self(Arc::new(dwell_scene::SpaceScene::read(path)?)))
    }

    /// Reads a scene from its text.
    ///
    /// # Errors
    /// [`Error::Study`] with all that is wrong, and where.
    ///
    /// ```
    /// let scene = dwell::space::Scene::parse(r#"
    ///     bodies.ground.points = { O = [0, 0, 0] }
    ///     bodies.bob = { points = { O = [0, 0, 0] }, mass = 2.0, center = [0.5, 0, 0] }
    ///     joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 1, 0] }
    ///     actuators.phi = { angle = "O" }
    ///     assembly.phi = 0.0
    /// "#)?;
    /// assert_eq!(scene.value("bob.mass")?, 2.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, Error> {
        let scene = dwell_scene::SpaceScene::parse("scene.toml", text)?;
        Ok(Self(Arc::new(scene)))
    }

    /// Its title.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
    /// assert_eq!(scene.title(), "Spatial crank-rocker with two balls");
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn title(&self) -> &str {
        &self.0.title
    }

    /// Its text, with what [`with_value`](Self::with_value) changed.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
    /// assert!(scene.text().contains("spherical"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn text(&self) -> &str {
        self.0.source.inner()
    }

    /// Warnings of its reader, such as numbers that may not be meant.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
    /// assert_eq!(scene.warnings().count(), 0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn warnings(&self) -> impl Iterator<Item = &str> {
        self.0.warnings.iter().map(|w| w.message.as_str())
    }

    /// A number by its path, in the scene's own unit: `crank.mass`, `crank.inertia[2]`, `joints.A.axis[0]`.
    ///
    /// # Errors
    /// [`Error::Study`] where there is no such number.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
    /// assert_eq!(scene.value("crank.points.B[0]")?, 0.1);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn value(&self, path: &str) -> Result<f64, Error> {
        Ok(self.0.value(path)?)
    }

    /// The same scene with a number replaced, in its own unit.
    ///
    /// # Errors
    /// [`Error::Study`] where there is no such number, or the scene makes no sense with it.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
    /// assert_eq!(scene.with_value("crank.mass", 0.9)?.value("crank.mass")?, 0.9);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn with_value(&self, path: &str, value: f64) -> Result<Self, Error> {
        let scene = self.0.with_values(&[(path, value)])?;
        Ok(Self(Arc::new(scene)))
    }

    /// What `dwell check` prints of it.
    ///
    /// # Errors
    /// [`Error::Study`] where it cannot be assembled.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?;
    /// assert!(scene.describe()?.contains("redundant"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn describe(&self) -> Result<String, Error> {
        Ok(dwell_study::describe_scene_in_space(&self.0)?)
    }

    /// Assembles its mechanism.
    ///
    /// # Errors
    /// [`Error::Study`] where it cannot be assembled, or a load does not fit it.
    ///
    /// ```
    /// # let scene = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?;
    /// assert_eq!(scene.assemble()?.actuators(), ["q"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn assemble(&self) -> Result<Mechanism, Error> {
        Mechanism::new(self.clone())
    }

    pub(crate) fn inner(&self) -> &dwell_scene::SpaceScene {
        &self.0
    }

    pub(super) fn body(&self, name: &str) -> Result<BodyId, Error> {
        let bodies = &self.0.mechanism.bodies;
        let found = bodies.iter().position(|b| b.name == name).map(BodyId);
        let names = bodies.iter().map(|b| b.name.as_str());
        found.ok_or_else(|| Error::unknown("body", "bodies", name, names))
    }

    pub(super) fn point(&self, name: &str) -> Result<(BodyId, Vec3), Error> {
        let (body, point) = name.split_once('.').unwrap_or((name, ""));
        let id = self.body(body)?;
        let points = &self.0.points[id.0];
        let found = points.iter().find(|(known, _)| known == point);
        let all: Vec<String> = points.iter().map(|(p, _)| format!("{body}.{p}")).collect();
        let names = all.iter().map(String::as_str);
        let (_, at) = found.ok_or_else(|| Error::unknown("point", "points", name, names))?;
        Ok((id, *at))
    }
}
