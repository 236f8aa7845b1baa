//! The inner forces of a link along the way: where they are largest, and between what they stay.

use dwell_kinetostatics::{Act, Distribution, Ledger, Model, Section, Workspace};
use dwell_report::{Column, Table};
use dwell_scene::Section as Request;

/// Intervals along a link.
const INTERVALS: usize = 100;

/// A link with what was found of it.
pub(crate) struct Link {
    pub(crate) request: Request,
    pub(crate) distribution: Distribution,
    /// The position of the largest bending moment, and the sections there.
    pub(crate) worst: Option<(usize, Vec<Section>)>,
    largest: f64,
    /// By station: smallest and largest axial force, shear and bending moment.
    pub(crate) envelope: Vec<(f64, [[f64; 2]; 3])>,
}

impl Link {
    pub(crate) fn new(request: &Request) -> Self {
        Self {
            request: request.clone(),
            distribution: Distribution::Lumped,
            worst: None,
            largest: f64::NEG_INFINITY,
            envelope: Vec::new(),
        }
    }

    /// Takes the link's forces at the `k`th position.
    pub(crate) fn take(
        &mut self,
        k: usize,
        ledger: &Ledger,
        model: &Model,
        work: &Workspace<f64>,
        acts: &[Act],
    ) {
        let Request { body, points, .. } = self.request;
        let Some(forces) = ledger.link_forces(model, body, points, work, acts) else {
            return;
        };
        self.distribution = forces.distribution;
        if self.envelope.is_empty() {
            let none = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            let station = |i: usize| forces.length * (i as f64 / INTERVALS as f64);
            self.envelope = (0..=INTERVALS).map(|i| (station(i), none)).collect();
        }
        for (station, extremes) in &mut self.envelope {
            // On both sides of what acts there.
            for section in [forces.before(*station), forces.at(*station)] {
                let values = [section.axial, section.shear, section.bending];
                for ([low, high], value) in extremes.iter_mut().zip(values) {
                    *low = low.min(value);
                    *high = high.max(value);
                }
            }
        }
        let sections = forces.sections(INTERVALS);
        let bending = sections.iter().map(|s| s.bending.abs()).fold(0.0, f64::max);
        if bending > self.largest {
            self.largest = bending;
            self.worst = Some((k, sections));
        }
    }

    /// The largest bending moment, N·m, with its sign and its station.
    pub(crate) fn peak(&self) -> Option<Section> {
        let (_, sections) = self.worst.as_ref()?;
        let size = |s: &&Section| s.bending.abs();
        sections
            .iter()
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .copied()
    }

    /// `body from … to …`, as part of a file's name.
    pub(crate) fn name(&self, body: &str) -> String {
        let [from, to] = &self.request.names;
        format!("{body}-{from}-{to}")
    }

    /// The sections where the bending moment is largest.
    pub(crate) fn table(&self) -> Table {
        let rows = self.worst.iter().flat_map(|(_, sections)| sections);
        Table {
            columns: vec![
                Column::new("station", "m"),
                Column::new("axial", "N"),
                Column::new("shear", "N"),
                Column::new("bending", "N m"),
            ],
            rows: rows
                .map(|s| vec![s.station, s.axial, s.shear, s.bending])
                .collect(),
        }
    }

    /// The envelope over the whole way.
    pub(crate) fn envelope_table(&self) -> Table {
        let mut columns = vec![Column::new("station", "m")];
        for (name, unit) in [("axial", "N"), ("shear", "N"), ("bending", "N m")] {
            columns.push(Column::new(format!("{name} min"), unit));
            columns.push(Column::new(format!("{name} max"), unit));
        }
        let row = |(station, extremes): &(f64, [[f64; 2]; 3])| {
            let mut row = vec![*station];
            row.extend(extremes.iter().flatten());
            row
        };
        Table {
            columns,
            rows: self.envelope.iter().map(row).collect(),
        }
    }
}
