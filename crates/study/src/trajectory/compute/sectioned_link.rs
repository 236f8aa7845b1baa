//! Internal forces of a link along the trajectory: the sections at the largest bending moment, and the envelope.

use dwell_findings::{Column, Table};
use dwell_kinetostatics::{Distribution, LinkForces, Section};
use dwell_scene::{PlaneScene, SectionRequest as Request};

/// Intervals along a link.
const INTERVALS: usize = 100;
/// The internal forces and their units.
const COMPONENTS: [(&str, &str); 3] = [("axial", "N"), ("shear", "N"), ("bending", "N m")];

/// A link and its internal forces.
pub struct SectionedLink {
    /// The body and the two points.
    pub request: Request,
    /// `body from … to …`.
    pub name: String,
    /// How its mass is distributed.
    pub distribution: Distribution,
    /// The position of the largest bending moment, and the sections there.
    pub max_bending_sections: Option<(usize, Vec<Section>)>,
    max_bending: f64,
    /// By station: smallest and largest axial force, shear and bending moment.
    pub envelope: Vec<(f64, [[f64; 2]; 3])>,
}

impl SectionedLink {
    pub(crate) fn new(scene: &PlaneScene, request: &Request) -> Self {
        let (body, [from, to]) = (scene.mechanism.body_name(request.body), &request.names);
        Self {
            name: format!("{body} from {from} to {to}"),
            request: request.clone(),
            distribution: Distribution::Lumped,
            max_bending_sections: None,
            max_bending: f64::NEG_INFINITY,
            envelope: Vec::new(),
        }
    }

    /// Adds the internal forces at the `k`th position.
    pub(crate) fn add_position(&mut self, k: usize, forces: Option<&LinkForces>) {
        let Some(forces) = forces else {
            return;
        };
        self.distribution = forces.distribution;
        if self.envelope.is_empty() {
            let none = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
            let station = |i: usize| forces.length * (i as f64 / INTERVALS as f64);
            self.envelope = (0..=INTERVALS).map(|i| (station(i), none)).collect();
        }
        for (station, extremes) in &mut self.envelope {
            // On both sides of a concentrated load.
            let at = *station;
            for section in [forces.section_before(at), forces.section_after(at)] {
                let values = [section.axial, section.shear, section.bending];
                for ([min, max], value) in extremes.iter_mut().zip(values) {
                    *min = min.min(value);
                    *max = max.max(value);
                }
            }
        }
        let sections = forces.sections(INTERVALS);
        let bending = sections.iter().map(|s| s.bending.abs()).fold(0.0, f64::max);
        if bending > self.max_bending {
            self.max_bending = bending;
            self.max_bending_sections = Some((k, sections));
        }
    }

    /// The largest bending moment, N·m, with its sign and its station.
    pub fn max_bending_section(&self) -> Option<Section> {
        let (_, sections) = self.max_bending_sections.as_ref()?;
        let size = |s: &&Section| s.bending.abs();
        let largest = sections.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        largest.copied()
    }

    /// `body.from.to`, as part of a file's name: no name has a dot, so no two links share one.
    pub fn file_name(&self, body: &str) -> String {
        let [from, to] = &self.request.names;
        format!("{body}.{from}.{to}")
    }

    /// The sections where the bending moment is largest.
    pub fn table(&self) -> Table {
        let mut columns = vec![Column::new("station", "m")];
        columns.extend(COMPONENTS.map(|(name, unit)| Column::new(name, unit)));
        let sections = self.max_bending_sections.iter().flat_map(|(_, s)| s);
        let rows = sections.map(|s| vec![s.station, s.axial, s.shear, s.bending]);
        Table {
            columns,
            rows: rows.collect(),
        }
    }

    /// The envelope over the whole trajectory, by station.
    pub fn envelope_table(&self) -> Table {
        let mut columns = vec![Column::new("station", "m")];
        for (name, unit) in COMPONENTS {
            columns.push(Column::new(format!("{name}.min"), unit));
            columns.push(Column::new(format!("{name}.max"), unit));
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
