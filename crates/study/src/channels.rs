//! The load channels over the range: what one unit of each load gives the coordinate and each reaction.
//!
//! ```text
//! m q̈ + ½m′ q̇² = Σ w_ℓ F_ℓ,    R_k = a_k q̈ + b_k q̇² + Σ c_kℓ F_ℓ
//! ```
//!
//! F is the magnitude that the scene gives; of a damper or friction, the force or couple itself.

use crate::error::StudyError;
use crate::figures::{extent, range_caption, reduced_at};
use crate::motion_error::explain_motion;
use crate::prepare::{Prepared, determined};
use crate::run::with_loads;
use dwell_kinetostatics::{KinetostaticsError, Load, LoadKind, Model};
use dwell_report::{Axis, Chart, Column, Figure, Panel, Series};
use dwell_scene::Scene;

/// Most curves of a chart.
const TOGETHER: usize = 6;

/// The channels of every load over the range.
pub(crate) struct Channels {
    loads: Vec<Load>,
    /// By position and load: w, then c of each reaction.
    rows: Vec<Vec<Vec<f64>>>,
    /// By position: the potential of all conservative loads, J.
    potential: Vec<f64>,
    conservative: bool,
}

/// Unit of w and of c (of a force and of a moment) for a load.
fn units(kind: LoadKind) -> [&'static str; 3] {
    match kind {
        LoadKind::Gravity { .. } => ["kg m", "kg", "kg m"],
        LoadKind::Spring { .. } => ["m2", "m", "m2"],
        LoadKind::TorsionSpring { .. } => ["rad", "rad/m", "rad"],
        LoadKind::Torque { .. } | LoadKind::TorsionDamper { .. } => ["", "1/m", ""],
        LoadKind::Force { .. }
        | LoadKind::Damper { .. }
        | LoadKind::Push { .. }
        | LoadKind::Slide(_)
        | LoadKind::SlideDamper(_) => ["m", "", "m"],
    }
}

/// The model of what a scene requests, under its loads: they may act on what the inertia alone does not
/// need.
pub(crate) fn loaded(scene: &Scene) -> Result<Model, StudyError> {
    with_loads(scene, determined(scene)?)
}

impl Channels {
    /// The channels of a prepared scene's loads at the coordinates `q`, rad; none without loads.
    pub(crate) fn new(prepared: &Prepared<'_>, q: &[f64]) -> Result<Option<Self>, StudyError> {
        let scene = prepared.scene;
        if scene.loads.is_empty() {
            return Ok(None);
        }
        let model = loaded(scene)?;
        let explain = |e: KinetostaticsError| explain_motion(scene, model.plan(), &e.into());
        let mut work = model.workspace();
        let mut actions = model.actions();
        let mut found = Self {
            loads: scene.loads.clone(),
            rows: Vec::with_capacity(q.len()),
            potential: Vec::with_capacity(q.len()),
            conservative: (0..scene.loads.len()).any(|l| model.conservative(l)),
        };
        for &q in q {
            model.enter(0.0, &[q], &[1.0], &mut work).map_err(explain)?;
            let mut row = Vec::with_capacity(found.loads.len());
            for load in 0..found.loads.len() {
                let run = model.channel(load, &mut work, &mut actions);
                run.map_err(explain)?;
                let mut values = vec![-actions.tau[0]];
                values.extend(&actions.reactions);
                row.push(values);
            }
            found.rows.push(row);
            let potentials = (0..found.loads.len()).filter_map(|l| model.potential(l, &work));
            found.potential.push(potentials.sum());
        }
        Ok(Some(found))
    }

    /// The columns and their values: V, w of each load, c of each reaction and load.
    pub(crate) fn columns(&self, prepared: &Prepared<'_>) -> Vec<(Column, Vec<f64>)> {
        let mut all = Vec::new();
        if self.conservative {
            all.push((Column::new("V", "J"), self.potential.clone()));
        }
        let value = |load: usize, k: usize| self.rows.iter().map(|row| row[load][k]).collect();
        for (l, load) in self.loads.iter().enumerate() {
            let [unit, ..] = units(load.kind);
            all.push((Column::new(format!("{} w", load.name), unit), value(l, 0)));
        }
        for (k, (name, of)) in prepared.reactions().into_iter().enumerate() {
            for (l, load) in self.loads.iter().enumerate() {
                let [_, force, moment] = units(load.kind);
                let unit = if of == "N" { force } else { moment };
                let name = format!("{name} c {}", load.name);
                all.push((Column::new(name, unit), value(l, k + 1)));
            }
        }
        all
    }

    /// w of the loads by their units, and V.
    pub(crate) fn figure(&self, prepared: &Prepared<'_>, q: &[f64], x: &Axis) -> Figure {
        let line = |name: &str, values: &[f64]| {
            let points = q.iter().zip(values).map(|(q, v)| [q.to_degrees(), *v]);
            Series::line(name, points.collect())
        };
        let panel = |title: &str, label: &str, unit: &str, series: Vec<Series>| {
            Panel::from(Chart {
                title: title.to_owned(),
                x: x.clone(),
                y: Axis {
                    range: extent(prepared, &series),
                    ..Axis::new(label, unit)
                },
                series,
                ..Chart::default()
            })
        };
        let mut panels = Vec::new();
        let mut known: Vec<&str> = self.loads.iter().map(|load| units(load.kind)[0]).collect();
        known.sort_unstable();
        known.dedup();
        for unit in known {
            let of_unit: Vec<usize> = (0..self.loads.len())
                .filter(|&l| units(self.loads[l].kind)[0] == unit)
                .collect();
            for some in of_unit.chunks(TOGETHER) {
                let curve = |&l: &usize| {
                    let values: Vec<f64> = self.rows.iter().map(|row| row[l][0]).collect();
                    line(&self.loads[l].name, &values)
                };
                let title = "w: what one unit of each load gives the coordinate";
                let shown = if unit.is_empty() { "1" } else { unit };
                panels.push(panel(title, "w", shown, some.iter().map(curve).collect()));
            }
        }
        if self.conservative {
            let series = vec![line("", &self.potential)];
            panels.push(panel("V: potential energy", "V", "J", series));
        }
        Figure {
            name: "d-loads".to_owned(),
            title: "Reduced loads".to_owned(),
            caption: range_caption(
                prepared,
                "m q̈ + ½m′ q̇² = Σ w F, F the magnitude of each load; of a damper, its force or couple.",
            ),
            columns: 1,
            panels,
            provenance: reduced_at(q.len()),
        }
    }
}
