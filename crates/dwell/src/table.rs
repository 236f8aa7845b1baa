//! The reduced model as a table.

use crate::error::Error;
use crate::reduced::{Coefficients, ReducedModel};
use dwell_kinetostatics::table::Labels;
use dwell_kinetostatics::{ReducedModel as _, TabulatedModel};

impl ReducedModel {
    /// The reduced model as a table over the range or one revolution, with the error of every coefficient relative to its
    /// largest value bounded by `accuracy`.
    ///
    /// # Errors
    /// [`Error::Table`] if no table reaches this accuracy.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let reduced = slider.reduced(["guide.normal"])?;
    /// let table = reduced.table(1e-9)?;
    /// let (m, exact) = (table.at(0.5)?.m, reduced.at(0.5)?.m);
    /// assert!((m - exact).abs() < 1e-9 * exact);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn table(&self, accuracy: f64) -> Result<Table, Error> {
        let (tabulated, labels) = self.source.table(accuracy)?;
        let reactions = self.reactions().len();
        Ok(Table {
            tabulated,
            labels,
            reactions,
        })
    }
}

/// A reduced model as piecewise polynomials, independent of the mechanism.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let table = slider.reduced([])?.table(1e-6)?;
/// let at = table.at(0.5)?;
/// println!("m = {} kg m2, half its derivative {} kg m2", at.m, at.half_dm);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Table {
    tabulated: TabulatedModel,
    labels: Labels,
    /// Number of requested reactions.
    reactions: usize,
}

impl Table {
    /// The coefficients at `q`, rad or m.
    ///
    /// # Errors
    /// [`Error::OutOfTable`] outside the table's domain.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// # let table = slider.reduced(["guide"])?.table(1e-6)?;
    /// let at = table.at(0.5)?;
    /// assert_eq!([at.a.len(), at.w.len()], [2, 2]); // normal and moment; weight and gas
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn at(&self, q: f64) -> Result<Coefficients, Error> {
        let [from, to] = self.tabulated.domain();
        let outside = |_| Error::OutOfTable { q, from, to };
        let all = self.labels.reactions.len();
        let mut inertial = dwell_kinetostatics::Coefficients {
            a: vec![0.0; all],
            b: vec![0.0; all],
            ..Default::default()
        };
        self.tabulated
            .coefficients(q, &mut (), &mut inertial)
            .map_err(outside)?;
        let mut responses = self.tabulated.response_buffer();
        self.tabulated
            .unit_load_responses(q, &mut responses)
            .map_err(outside)?;
        inertial.a.truncate(self.reactions);
        inertial.b.truncate(self.reactions);
        let by_load = |load: usize| responses.c[load * all..load * all + self.reactions].to_vec();
        Ok(Coefficients {
            m: inertial.m,
            half_dm: inertial.half_dm,
            a: inertial.a,
            b: inertial.b,
            c: (0..responses.w.len()).map(by_load).collect(),
            w: responses.w,
        })
    }

    /// An upper bound of the error of a coefficient, relative to its largest value.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// # let table = slider.reduced([])?.table(1e-6)?;
    /// assert!(table.error_bound() <= 1e-6);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn error_bound(&self) -> f64 {
        self.tabulated.max_bound()
    }

    /// The table as the text that `docs/table-format.md` describes, for other programs.
    ///
    /// # Errors
    /// [`Error::Table`] if a name cannot be written.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// # let table = slider.reduced([])?.table(1e-6)?;
    /// assert!(table.to_text()?.contains("phi"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn to_text(&self) -> Result<String, Error> {
        let text = self.tabulated.to_text(&self.labels);
        text.map_err(|e| Error::Table(e.to_string()))
    }
}
