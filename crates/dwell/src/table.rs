//! The reduced model as a table.

use crate::error::Error;
use crate::reduced::{Coefficients, ReducedModel};
use crate::space;
use dwell_geometry::Range;
use dwell_kinetostatics::table::Labels;
use dwell_kinetostatics::{ExactModel, ReducedModel as _, TableDomain, TabulatedModel};
use std::f64::consts::TAU;

impl ReducedModel {
    /// The reduced model as a table, over the range or one revolution: every coefficient to an accuracy relative to its
    /// largest value.
    ///
    /// # Errors
    /// [`Error::Table`] where no table reaches that accuracy.
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
        let scene = self.scene.inner();
        let model = self.loaded.as_ref().unwrap_or(self.exact.model());
        let domain = domain(model.plan().range());
        let names = model.reactions().iter();
        let labels = Labels {
            scene: scene.hash(),
            coordinate: scene
                .mechanism
                .actuators
                .first()
                .map(|a| a.name.clone())
                .unwrap_or_default(),
            reactions: names.map(|r| scene.mechanism.reaction_name(*r)).collect(),
            loads: model.loads().iter().map(|load| load.name.clone()).collect(),
        };
        // Friction's own reactions come after those that were asked for.
        let tabulated = match ExactModel::new(model.clone()) {
            Some(exact) => TabulatedModel::new(&exact, accuracy, domain),
            None => TabulatedModel::new(&self.exact, accuracy, domain),
        };
        let tabulated = tabulated.map_err(|e| Error::Table(e.to_string()))?;
        let reactions = self.reactions.len();
        Ok(Table {
            tabulated,
            labels,
            reactions,
        })
    }
}

impl space::ReducedModel {
    /// As [`ReducedModel::table`](crate::ReducedModel::table) of a mechanism in the plane.
    ///
    /// # Errors
    /// [`Error::Table`] where no table reaches that accuracy.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let reduced = rssr.reduced(["B.x"])?;
    /// let table = reduced.table(1e-9)?;
    /// let (m, exact) = (table.at(0.5)?.m, reduced.at(0.5)?.m);
    /// assert!((m - exact).abs() < 1e-9 * exact);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn table(&self, accuracy: f64) -> Result<Table, Error> {
        let domain = domain(self.exact.model().plan().range());
        let tabulated = TabulatedModel::new(&self.exact, accuracy, domain);
        let scene = self.scene.inner();
        let coordinate = scene.mechanism.actuators.first().map(|a| a.name.clone());
        let labels = Labels {
            scene: scene.hash(),
            coordinate: coordinate.unwrap_or_default(),
            reactions: self.reactions(),
            loads: self.loads().into_iter().map(str::to_owned).collect(),
        };
        Ok(Table {
            tabulated: tabulated.map_err(|e| Error::Table(e.to_string()))?,
            reactions: labels.reactions.len(),
            labels,
        })
    }
}

/// A full period; without one a revolution.
fn domain(range: Range) -> TableDomain {
    match range {
        Range::Unbounded => TableDomain::Between(0.0, TAU),
        Range::Full
        | Range::Revolutions(_)
        | Range::Limited(..)
        | Range::Stroke(..)
        | Range::Unresolved(..) => TableDomain::Full,
    }
}

/// A reduced model as piecewise polynomials: it does not need the mechanism any more.
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
    /// How many of the reactions were asked for.
    reactions: usize,
}

impl Table {
    /// The coefficients at `q`, rad or m.
    ///
    /// # Errors
    /// [`Error::OutOfTable`] beyond the table's domain.
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

    /// The largest error of a coefficient, relative to its largest value: a bound.
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
    /// [`Error::Table`] where a name cannot be written.
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
