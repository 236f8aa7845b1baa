//! Points of a mechanism at many positions.

use super::Mechanism;
use super::kinematics::components;
use crate::error::Error;

impl Mechanism {
    /// Positions of points `body.point`, m, as `[x, y]` in the plane or `[x, y, z]`: by position of the mechanism, then by
    /// point. `q` has the coordinates of all actuators, rad or m,
    /// for one position after another. Only positions are computed, with one working memory.
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Components`]; [`Error::Count`] if a position lacks a coordinate; [`Error::Study`] for the first position that the
    /// mechanism cannot reach.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let path: Vec<[f64; 2]> = slider.paths(["crank.B", "piston.C"], &[0.0, 0.5, 1.0])?;
    /// assert_eq!(path.len(), 3 * 2);
    /// assert_eq!(path[3], slider.positions(&[0.5])?.position("piston.C")?);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn paths<'p, const N: usize>(
        &self,
        points: impl IntoIterator<Item = &'p str>,
        q: &[f64],
    ) -> Result<Vec<[f64; N]>, Error> {
        let actuators = self.names.actuators.len();
        if actuators == 0 || !q.len().is_multiple_of(actuators) {
            return Err(Error::Count {
                what: "coordinates",
                given: q.len(),
                actuators,
            });
        }
        let points = points
            .into_iter()
            .map(|name| self.names.point(name))
            .collect::<Result<Vec<_>, _>>()?;
        let dimension = self.names.dimension;
        // A wrong number of components is reported before the computation.
        components::<N>([0.0; 3], dimension)?;
        let paths = self.assembled.paths(&points, q)?.into_iter();
        paths.map(|at| components(at, dimension)).collect()
    }
}
