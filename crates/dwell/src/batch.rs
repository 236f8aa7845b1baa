//! The coefficients of a reduced model at many coordinates.

use crate::error::Error;
use crate::reduced::ReducedModel;
use rayon::prelude::*;

/// Coordinates that one thread evaluates with one working memory.
const BLOCK: usize = 1024;
/// Up to this number, coordinates are evaluated one by one: allocating memory for lanes would take longer.
const FEW: usize = 16;

/// The coefficients at many coordinates, one array for each kind. Reactions are in the order of
/// [`ReducedModel::reactions`], loads in that of [`ReducedModel::loads`].
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let reduced = slider.reduced(["A"])?;
/// let batch = reduced.batch(&[0.0, 0.5, 1.0])?;
/// assert_eq!([batch.m.len(), batch.a.len()], [3, 3 * 2]);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CoefficientBatch {
    /// By coordinate: m, kg m² (kg if the coordinate is a length).
    pub m: Vec<f64>,
    /// By coordinate: ½m′.
    pub half_dm: Vec<f64>,
    /// By coordinate, then by reaction: its coefficient of q̈.
    pub a: Vec<f64>,
    /// By coordinate, then by reaction: its coefficient of q̇².
    pub b: Vec<f64>,
    /// By coordinate, then by load: its generalised force per unit of its magnitude.
    pub w: Vec<f64>,
    /// By coordinate, then by load, then by reaction: the load's contribution to the reaction per unit of its magnitude.
    pub c: Vec<f64>,
}

impl ReducedModel {
    /// The coefficients at many coordinates, rad or m, computed on all threads. Every value equals that of [`ReducedModel::at`] bit for
    /// bit.
    ///
    /// # Errors
    /// [`Error::Study`] for the first coordinate that the mechanism cannot reach.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let reduced = slider.reduced(["guide.normal"])?;
    /// let q: Vec<f64> = (0..360).map(|degree| f64::from(degree).to_radians()).collect();
    /// let batch = reduced.batch(&q)?;
    /// assert_eq!(batch.m[60], reduced.at(q[60])?.m);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn batch(&self, q: &[f64]) -> Result<CoefficientBatch, Error> {
        if q.len() <= FEW {
            return self.one_by_one(q);
        }
        let inertial = self.source.inertial_batch(q)?;
        let (w, c) = self.load_batch(q)?;
        Ok(CoefficientBatch {
            m: inertial.m,
            half_dm: inertial.half_dm,
            a: inertial.a,
            b: inertial.b,
            w,
            c,
        })
    }

    /// The coefficients at few coordinates, with existing working memory.
    fn one_by_one(&self, q: &[f64]) -> Result<CoefficientBatch, Error> {
        let mut batch = CoefficientBatch::default();
        let mut evaluator = self.evaluator();
        for &q in q {
            let at = evaluator.at(q)?;
            batch.m.push(at.m);
            batch.half_dm.push(at.half_dm);
            batch.a.extend(&at.a);
            batch.b.extend(&at.b);
            batch.w.extend(&at.w);
            batch.c.extend(at.c.iter().flatten());
        }
        evaluator.release();
        Ok(batch)
    }

    /// w and c at many coordinates.
    fn load_batch(&self, q: &[f64]) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let loads = self.loads().len();
        if loads == 0 {
            return Ok((Vec::new(), Vec::new()));
        }
        let reactions = self.reactions().len();
        let mut w = vec![0.0; q.len() * loads];
        let mut c = vec![0.0; q.len() * loads * reactions];
        // A model without reactions has an empty c; its blocks are then empty, too.
        let mut c_blocks: Vec<&mut [f64]> = match reactions {
            0 => q.chunks(BLOCK).map(|_| &mut [][..]).collect(),
            _ => c.chunks_mut(BLOCK * loads * reactions).collect(),
        };
        let blocks = q.par_chunks(BLOCK).zip(w.par_chunks_mut(BLOCK * loads));
        let done = blocks.zip(c_blocks.par_iter_mut()).map(|((q, w), c)| {
            let mut evaluator = self.evaluator();
            for (k, &q) in q.iter().enumerate() {
                let at = evaluator.at(q)?;
                w[k * loads..][..loads].copy_from_slice(&at.w);
                for (load, share) in at.c.iter().enumerate() {
                    c[(k * loads + load) * reactions..][..reactions].copy_from_slice(share);
                }
            }
            evaluator.release();
            Ok(())
        });
        done.collect::<Result<(), Error>>()?;
        Ok((w, c))
    }
}
