//! Figures of a free motion: energies, phase portraits, coordinates in time.

use crate::output::symbol;
use crate::trajectory::compute::{Analysis, BALANCE, ColumnQuantity, KINETIC, POTENTIAL};
use crate::trajectory::figures::{FigureContext, MAX_CURVES};
use dwell_report::{Axis, Chart, Figure, Panel, Series};

impl FigureContext<'_> {
    /// Every coordinate and its speed over time.
    pub(crate) fn coordinates(&self) -> Option<Figure> {
        if self.analysis != Analysis::FreeMotion {
            return None;
        }
        let mut panels: Vec<Panel> = Vec::new();
        for (i, actuator) in self.scene.mechanism.actuators.iter().enumerate().take(3) {
            let name = symbol(&actuator.name);
            for (order, label) in [(0, name.clone()), (1, format!("d{name}/dt"))] {
                let columns = self
                    .columns_where(|c| c.quantity == ColumnQuantity::ActuatorCoordinate(i, order));
                let curves: Vec<_> = columns.iter().map(|&k| (label.clone(), k)).collect();
                if !curves.is_empty() {
                    panels.push(self.chart("", &label, &curves).into());
                }
            }
        }
        let title = "Coordinates and their speeds".to_owned();
        (!panels.is_empty())
            .then(|| self.figure("coordinates".to_owned(), title, "Over time.", panels))
    }

    /// Kinetic and potential energy, work of nonconservative loads, and the error of the balance.
    pub(crate) fn energies(&self) -> Option<Figure> {
        let named = |name: &str| self.results.columns.iter().position(|c| c.name == name);
        let [kinetic, potential] = [KINETIC, POTENTIAL].map(named);
        let balance = named(BALANCE)?;
        let mut stored = vec![("kinetic".to_owned(), kinetic?)];
        stored.extend(
            potential
                .filter(|&k| !self.is_zero(k, 0.0))
                .map(|k| ("potential".to_owned(), k)),
        );
        let works = self.columns_where(|c| {
            matches!(c.quantity, ColumnQuantity::Extra(_)) && c.name.ends_with(".work")
        });
        let works: Vec<_> = works
            .into_iter()
            .filter(|&k| !self.is_zero(k, 0.0))
            .collect();
        let works = self.labelled(&works, ".work");
        let mut panels: Vec<Panel> = vec![
            self.chart("Kinetic and potential energy", "energy", &stored)
                .into(),
        ];
        for some in works.chunks(MAX_CURVES) {
            panels.push(self.chart("Work done", "work", some).into());
        }
        let balance_curve = [("balance".to_owned(), balance)];
        panels.push(
            self.chart("Kinetic + potential − work", "change", &balance_curve)
                .into(),
        );
        let text = "Work: that of nonconservative loads and drives. The last panel is the error of the \
                     integration.";
        Some(self.figure("energies".to_owned(), "Energies".to_owned(), text, panels))
    }

    /// Speed over coordinate.
    pub(crate) fn phase_portraits(&self) -> Option<Figure> {
        if self.analysis != Analysis::FreeMotion {
            return None;
        }
        let actuators = self.scene.mechanism.actuators.iter().enumerate();
        let panel = |(i, actuator): (usize, &dwell_geometry::Actuator)| {
            let column = |order| {
                let quantity = ColumnQuantity::ActuatorCoordinate(i, order);
                self.results
                    .columns
                    .iter()
                    .position(|c| c.quantity == quantity)
            };
            let (q, speed) = (column(0)?, column(1)?);
            let name = symbol(&actuator.name);
            let angle = actuator.coordinate().is_angle();
            let at = |row: &Vec<f64>| {
                let x = if angle { row[q].to_degrees() } else { row[q] };
                [x, row[speed]]
            };
            let unit = if angle { "rad/s" } else { "m/s" };
            Some(Panel::from(Chart {
                x: if angle {
                    Axis::degrees(name.clone())
                } else {
                    Axis::new(name.clone(), "m")
                },
                y: Axis::new(format!("d{name}/dt"), unit),
                series: vec![Series::line("", self.results.rows.iter().map(at).collect())],
                ..Chart::default()
            }))
        };
        let panels: Vec<Panel> = actuators.take(4).filter_map(panel).collect();
        let title = "Phase portrait".to_owned();
        let text = "Speed over coordinate.";
        (!panels.is_empty()).then(|| self.figure("phase-portrait".to_owned(), title, text, panels))
    }
}
