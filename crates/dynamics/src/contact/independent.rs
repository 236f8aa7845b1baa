//! Selects independent contacts, whose rows are not sums of the rows of others.

/// Tolerance, relative and squared, within which the row of a dependent contact is a sum of the rows of others.
const INDEPENDENT: f64 = 1e-11;

/// A largest independent set of contacts, by the Cholesky factorisation of D with the largest pivots first; with the working
/// memory to find it.
#[derive(Debug, Clone, Default)]
pub(super) struct IndependentSet {
    /// By contact: √D, and the remainder of its pivot.
    scale: Vec<f64>,
    left: Vec<f64>,
    /// The columns of the factor, one after another.
    columns: Vec<f64>,
    /// The places of the chosen contacts.
    places: Vec<usize>,
}

impl IndependentSet {
    /// Finds such a set among some contacts, of which `compliance` gives D.
    pub(super) fn find<'s>(
        &'s mut self,
        of: &'s [usize],
        compliance: impl Fn(usize, usize) -> f64,
    ) -> impl Iterator<Item = usize> + 's {
        let n = of.len();
        let Self {
            scale,
            left,
            columns,
            places,
        } = self;
        scale.clear();
        scale.extend(of.iter().map(|&i| compliance(i, i).sqrt()));
        left.clear();
        let is_pressed = |s: &f64| f64::from(u8::from(*s > 0.0 && s.is_finite()));
        left.extend(scale.iter().map(is_pressed));
        columns.clear();
        places.clear();
        while places.len() < n {
            let rest = (0..n).filter(|k| !places.contains(k));
            let Some(best) = rest.max_by(|a, b| left[*a].total_cmp(&left[*b])) else {
                break;
            };
            if left[best] <= INDEPENDENT {
                break;
            }
            let root = left[best].sqrt();
            let first = columns.len();
            for (k, &own) in scale.iter().enumerate() {
                let mut entry = 0.0;
                if own > 0.0 {
                    let known = columns[..first].chunks_exact(n).map(|c| c[k] * c[best]);
                    let known: f64 = known.sum();
                    entry = compliance(of[k], of[best]) / (own * scale[best]) - known;
                }
                columns.push(entry / root);
            }
            for (left, entry) in left.iter_mut().zip(&columns[first..]) {
                *left -= entry * entry;
            }
            places.push(best);
        }
        places.iter().map(|&k| of[k])
    }
}

/// The independent contacts, with new working memory.
pub(crate) fn independent(of: &[usize], compliance: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    IndependentSet::default().find(of, compliance).collect()
}
