//! Points of a mechanism at many positions.

use super::Mechanism;
use super::kinematics::pair;
use crate::error::Error;
use dwell_geometry::body_states::BodyStates;
use dwell_study::explain::explain_position;

impl Mechanism {
    /// Where points `body.point` are at many positions, m: by position, then by point. `q` has the coordinates of all actuators of
    /// one position after another, rad or m. Only positions are computed, and all with one working memory.
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Count`] where a position lacks a coordinate; [`Error::Study`] for the first position that the
    /// mechanism cannot reach.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let path = slider.paths(["crank.B", "piston.C"], &[0.0, 0.5, 1.0])?;
    /// assert_eq!(path.len(), 3 * 2);
    /// assert_eq!(path[3], slider.positions(&[0.5])?.position("piston.C")?);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn paths<'p>(
        &self,
        points: impl IntoIterator<Item = &'p str>,
        q: &[f64],
    ) -> Result<Vec<[f64; 2]>, Error> {
        let plan = self.model.plan();
        let actuators = plan.actuators();
        if actuators == 0 || !q.len().is_multiple_of(actuators) {
            return Err(Error::Count {
                what: "coordinates",
                given: q.len(),
                actuators,
            });
        }
        let points = points.into_iter().map(|name| self.scene.point(name));
        let points = points.collect::<Result<Vec<_>, _>>()?;
        let mut paths = Vec::with_capacity(points.len() * q.len() / actuators);
        let (mut pose, at_rest) = (plan.pose(), plan.motion());
        let mut bodies = BodyStates::new(plan);
        for q in q.chunks_exact(actuators) {
            let reached = plan.positions(q, &mut pose);
            reached.map_err(|e| explain_position(self.scene.inner(), plan, &e))?;
            bodies.fill_velocities(plan, &pose, &at_rest);
            paths.extend(
                points
                    .iter()
                    .map(|&(body, at)| pair(bodies.point(body, at).position)),
            );
        }
        Ok(paths)
    }
}
