//! What only a free motion has: its energies, its phase portrait, the coordinates in time.

use super::{Sheet, TOGETHER};
use crate::figures::symbol;
use crate::run::{Command, Quantity};
use crate::simulate::{BALANCE, KINETIC, POTENTIAL};
use dwell_report::{Axis, Chart, Figure, Panel, Series};

impl Sheet<'_> {
    /// Every coordinate and its speed in time.
    pub(super) fn coordinates(&self) -> Option<Figure> {
        if self.command != Command::Simulate {
            return None;
        }
        let mut panels: Vec<Panel> = Vec::new();
        for (i, actuator) in self.scene.mechanism.actuators.iter().enumerate().take(3) {
            let name = symbol(&actuator.name);
            for (order, label) in [(0, name.clone()), (1, format!("d{name}/dt"))] {
                let place = self.places(|c| c.quantity == Quantity::Drive(i, order));
                let curves: Vec<_> = place.iter().map(|&k| (label.clone(), k)).collect();
                if !curves.is_empty() {
                    panels.push(self.chart("", &label, &curves).into());
                }
            }
        }
        let title = "Coordinates and their speeds".to_owned();
        (!panels.is_empty())
            .then(|| self.figure("d-coordinates".to_owned(), title, "In time.", panels))
    }

    /// Kinetic and potential energy, the work of everything else, and what is left of their balance.
    pub(super) fn energies(&self) -> Option<Figure> {
        let named = |name: &str| self.record.columns.iter().position(|c| c.name == name);
        let [kinetic, potential] = [KINETIC, POTENTIAL].map(named);
        let balance = named(BALANCE)?;
        let mut stored = vec![("kinetic".to_owned(), kinetic?)];
        stored.extend(
            potential
                .filter(|&k| !self.is_still(k, 0.0))
                .map(|k| ("potential".to_owned(), k)),
        );
        let works =
            self.places(|c| matches!(c.quantity, Quantity::Told(_)) && c.name.ends_with(".work"));
        let works: Vec<_> = works
            .into_iter()
            .filter(|&k| !self.is_still(k, 0.0))
            .collect();
        let works = self.named(&works, ".work");
        let mut panels: Vec<Panel> = vec![self.chart("Energy stored", "energy", &stored).into()];
        for some in works.chunks(TOGETHER) {
            panels.push(self.chart("Work done", "work", some).into());
        }
        let left = [("balance".to_owned(), balance)];
        panels.push(
            self.chart("Kinetic + potential − work", "change", &left)
                .into(),
        );
        let words = "Work is that of loads and drives without a potential; the last panel is the error of the \
                     integration.";
        Some(self.figure("j-energy".to_owned(), "Energies".to_owned(), words, panels))
    }

    /// Speed over coordinate.
    pub(super) fn phases(&self) -> Option<Figure> {
        if self.command != Command::Simulate {
            return None;
        }
        let actuators = self.scene.mechanism.actuators.iter().enumerate();
        let panel = |(i, actuator): (usize, &dwell_geometry::Actuator)| {
            let place = |order| {
                let wanted = Quantity::Drive(i, order);
                self.record
                    .columns
                    .iter()
                    .position(|c| c.quantity == wanted)
            };
            let (q, speed) = (place(0)?, place(1)?);
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
                series: vec![Series::line("", self.record.rows.iter().map(at).collect())],
                ..Chart::default()
            }))
        };
        let panels: Vec<Panel> = actuators.take(4).filter_map(panel).collect();
        let title = "Phase portrait".to_owned();
        let words = "Speed over coordinate.";
        (!panels.is_empty()).then(|| self.figure("k-phase".to_owned(), title, words, panels))
    }
}
