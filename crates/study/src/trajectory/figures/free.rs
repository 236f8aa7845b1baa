//! Figures of a free motion: energies, phase portraits, coordinates in time.

use crate::output::{chart, coordinate_axis, symbol};
use crate::trajectory::compute::{Analysis, BALANCE, Column, KINETIC, POTENTIAL, Quantity};
use crate::trajectory::figures::{ChartContext, FigureContext, MAX_CURVES};
use dwell_kinetostatics::Drive;
use dwell_report::{Axis, Figure, Panel, Series};

/// Coordinates that are drawn over time.
const DRAWN: usize = 3;

impl ChartContext<'_> {
    /// The first coordinates and their speeds over time.
    pub(crate) fn coordinates(&self) -> Option<Figure> {
        if self.analysis != Analysis::FreeMotion {
            return None;
        }
        let mut panels: Vec<Panel> = Vec::new();
        for i in 0..DRAWN {
            let column = |order| self.coordinate(i, order);
            let Some(any) = column(0).or_else(|| column(1)) else {
                continue;
            };
            let name = &self.results.columns[any].name;
            let name = symbol(name.strip_suffix(".velocity").unwrap_or(name));
            let curves = [(0, name.clone()), (1, format!("d{name}/dt"))];
            for (order, label) in curves {
                let curve = column(order).map(|k| [(label.clone(), k)]);
                panels.extend(curve.map(|curve| self.chart("", &label, &curve).into()));
            }
        }
        let title = "Coordinates and their speeds";
        let text = match self.coordinate(DRAWN, 0) {
            None => "Over time.",
            Some(_) => "The first three, over time.",
        };
        (!panels.is_empty()).then(|| self.figure("coordinates", title, text, panels))
    }

    /// The column of an actuator's coordinate, or of a derivative.
    fn coordinate(&self, actuator: usize, order: usize) -> Option<usize> {
        let quantity = Quantity::ActuatorCoordinate(actuator, order);
        self.results.column_index(quantity)
    }

    /// Kinetic and potential energy, work of nonconservative loads, and the error of the balance.
    pub(crate) fn energies(&self) -> Option<Figure> {
        let named = |name: &str| self.results.columns.iter().position(|c| c.name == name);
        let (kinetic, balance) = (named(KINETIC)?, named(BALANCE)?);
        let mut stored = vec![("kinetic".to_owned(), kinetic)];
        let potential = named(POTENTIAL).filter(|&k| !self.is_zero(k));
        stored.extend(potential.map(|k| ("potential".to_owned(), k)));
        let is_extra = |c: &Column| matches!(c.quantity, Quantity::Extra(_));
        let mut works = self.columns_where(|c| is_extra(c) && c.name.ends_with(".work"));
        works.retain(|&k| !self.is_zero(k));
        let works = self.labelled(&works, ".work");
        let mut charts = vec![self.chart("Kinetic and potential energy", "energy", &stored)];
        let works = works.chunks(MAX_CURVES);
        charts.extend(works.map(|some| self.chart("Work done", "work", some)));
        let balance = [("balance".to_owned(), balance)];
        let error = self.chart_of_some("Kinetic + potential − work", "change", &balance);
        let text = match error {
            Some(_) => {
                "Work: that of nonconservative loads and drives. The last panel is the error of the integration."
            }
            None => {
                "Work: that of nonconservative loads and drives. Their balance is met to rounding."
            }
        };
        charts.extend(error);
        let panels = charts.into_iter().map(Panel::from).collect();
        Some(self.figure("energies", "Energies", text, panels))
    }

    /// Currents of motors, electrical and mechanical power of drives, and efficiencies.
    pub(crate) fn drives<C>(&self, drives: &[Drive<C>]) -> Option<Figure> {
        let is_drive = |name: &str| drives.iter().any(|drive| drive.name == name);
        let of_drives = |ending: &str| {
            let columns = self.columns_where(|c| c.name.strip_suffix(ending).is_some_and(is_drive));
            let mut curves = self.labelled(&columns, ending);
            curves.retain(|(_, k)| !self.is_zero(*k));
            curves
        };
        let mut powers = of_drives(".power");
        let electrical = of_drives(".electrical_power").into_iter();
        powers.extend(electrical.map(|(name, k)| (format!("{name}, electrical"), k)));
        let mut panels: Vec<Panel> = Vec::new();
        for (title, label, curves) in [
            ("Currents", "current", of_drives(".current")),
            ("Power", "power", powers),
            ("Efficiency", "efficiency", of_drives(".efficiency")),
        ] {
            let charts = curves.chunks(MAX_CURVES);
            panels.extend(charts.map(|some| self.chart(title, label, some).into()));
        }
        let text = "Power that drives deliver to the mechanism. Of a motor with a circuit also the power that it takes from the supply, and its efficiency: \
                    delivered power over its sum with the loss in the resistance, 0 where it brakes.";
        (!panels.is_empty()).then(|| self.figure("drives", "Drives", text, panels))
    }
}

impl FigureContext<'_> {
    /// Speed over coordinate.
    pub(crate) fn phase_portraits(&self) -> Option<Figure> {
        if self.analysis != Analysis::FreeMotion {
            return None;
        }
        let actuators = self.scene.mechanism.actuators.iter().enumerate();
        let folds = self.last_revolution.is_some();
        let period = [f64::INFINITY, 360.0][usize::from(folds)];
        let within = |degrees: f64| degrees - 360.0 * (degrees / period).floor();
        let panel = |(i, actuator): (usize, &dwell_geometry::Actuator)| {
            let (q, speed) = (self.coordinate(i, 0)?, self.coordinate(i, 1)?);
            let name = symbol(&actuator.name);
            let angle = actuator.coordinate().is_angle();
            let at = |row: &Vec<f64>| {
                if angle {
                    [within(row[q].to_degrees()), row[speed]]
                } else {
                    [row[q], row[speed]]
                }
            };
            let y = Axis::new(format!("d{name}/dt"), if angle { "rad/s" } else { "m/s" });
            let points: Vec<[f64; 2]> = self.drawn_rows().map(at).collect();
            // A line ends with a revolution.
            let parts = points.chunk_by(|a, b| !folds || (b[0] - a[0]).abs() < 180.0);
            let parts = parts.map(|part| [part, &[[f64::NAN; 2]]].concat());
            let line = Series::line("", parts.flatten().collect());
            Some(chart("", coordinate_axis(&name, angle), y, vec![line]).into())
        };
        let panels: Vec<Panel> = actuators.take(4).filter_map(panel).collect();
        let angles = ["", ", angles within a revolution"][usize::from(folds)];
        let (title, text) = ("Phase portrait", format!("Speed over coordinate{angles}."));
        (!panels.is_empty()).then(|| self.figure("phase-portrait", title, &text, panels))
    }
}
