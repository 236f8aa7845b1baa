//! The text of a trajectory analysis: the printed summary, and the Markdown page with extrema, column meanings and figures.

use crate::models::indeterminate_note;
use crate::number_format::{count, digits, number};
use crate::output::provenance_line;
use crate::trajectory::compute::{
    Analysis, ColumnExtrema, ColumnQuantity, Trajectory, TrajectoryResults, extrema,
};
use dwell_kinetostatics::Distribution;
use dwell_report::{Block, Document as Page, Figure};
use dwell_scene::Scene;
use std::fmt::Write as _;

/// The extrema as CSV, each with the value of the abscissa (name, unit) where it occurs.
fn extrema_table_csv(
    extrema: &[ColumnExtrema],
    (abscissa, unit): (&str, &str),
    abscissa_values: &[f64],
) -> String {
    let mut text =
        format!("quantity,unit,min,min at {abscissa} [{unit}],max,max at {abscissa} [{unit}]\n");
    for entry in extrema {
        let ColumnExtrema { name, unit, .. } = entry;
        let [(min, l), (max, h)] = [entry.min, entry.max];
        // Names of a scene hold neither commas nor quotes.
        text += &format!(
            "{name},{unit},{min:?},{:?},{max:?},{:?}\n",
            abscissa_values[l], abscissa_values[h]
        );
    }
    text
}

/// Header and cells of the extrema as a text table.
fn extrema_cells(
    extrema: &[ColumnExtrema],
    (abscissa, unit): (&str, &str),
    abscissa_values: &[f64],
) -> (Vec<String>, Vec<Vec<String>>) {
    let header = [
        "quantity",
        "unit",
        "min",
        &format!("at {abscissa} [{unit}]"),
        "max",
        &format!("at {abscissa} [{unit}]"),
    ];
    let row = |entry: &ColumnExtrema| {
        vec![
            entry.name.clone(),
            entry.unit.to_owned(),
            number(entry.min.0),
            number(abscissa_values[entry.min.1]),
            number(entry.max.0),
            number(abscissa_values[entry.max.1]),
        ]
    };
    (
        header.map(str::to_owned).to_vec(),
        extrema.iter().map(row).collect(),
    )
}

/// Extrema of one unit that the summary lists.
const MAX_LISTED: usize = 3;
/// Extrema that differ relatively by less than this are listed once.
const SAME_WITHIN: f64 = 1e-9;
/// Largest relative residual of the power balance that is not commented on.
const MAX_BALANCE_RESIDUAL: f64 = 1e-9;

/// The results of a trajectory analysis as text.
pub(crate) struct Document<'a> {
    scene: &'a Scene,
    results: &'a TrajectoryResults,
    trajectory: &'a Trajectory<'a>,
    analysis: Analysis,
    selected: &'a [usize],
    extrema: Vec<ColumnExtrema>,
    /// Name and unit of the abscissa: time, or the swept coordinate.
    abscissa: (String, &'static str),
    abscissa_values: Vec<f64>,
}

impl<'a> Document<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        results: &'a TrajectoryResults,
        trajectory: &'a Trajectory<'a>,
        analysis: Analysis,
        selected: &'a [usize],
    ) -> Self {
        let abscissa = results
            .columns
            .iter()
            .position(|c| match trajectory.swept_actuator() {
                None => c.quantity == ColumnQuantity::Time,
                Some(actuator) => c.quantity == ColumnQuantity::ActuatorCoordinate(actuator, 0),
            });
        let abscissa = abscissa.unwrap_or(0);
        // The abscissa itself is not a result.
        let listed: Vec<usize> = selected
            .iter()
            .copied()
            .filter(|&k| k != abscissa)
            .collect();
        let listed: Vec<usize> = listed
            .into_iter()
            .filter(|&k| results.columns[k].quantity != ColumnQuantity::Time)
            .collect();
        Self {
            scene,
            results,
            trajectory,
            analysis,
            selected,
            extrema: extrema(&results.columns, &listed, &results.rows),
            abscissa: (
                results.columns[abscissa].name.clone(),
                results.columns[abscissa].unit,
            ),
            abscissa_values: results.rows.iter().map(|row| row[abscissa]).collect(),
        }
    }

    fn abscissa(&self) -> (&str, &str) {
        (&self.abscissa.0, self.abscissa.1)
    }

    pub(crate) fn extrema_csv(&self) -> String {
        extrema_table_csv(&self.extrema, self.abscissa(), &self.abscissa_values)
    }

    fn first_line(&self) -> String {
        let reached = self.results.rows.len();
        let all = if reached == self.trajectory.points {
            count(reached, "position")
        } else {
            format!("{reached} of {}", count(self.trajectory.points, "position"))
        };
        format!(
            "{}: {}, {all} over {}",
            self.scene.title,
            self.analysis.name(),
            self.trajectory.description
        )
    }

    /// What is printed.
    pub(crate) fn summary(&self) -> String {
        let mut text = format!("{}\n", self.first_line());
        let interesting = |unit: &str| match self.analysis {
            Analysis::Kinematics => matches!(unit, "rad/s" | "m/s" | "rad/s2" | "m/s2"),
            _ => matches!(unit, "N" | "N m" | "W"),
        };
        let mut listed: Vec<(&str, f64)> = Vec::new();
        let (abscissa, abscissa_unit) = self.abscissa();
        for extrema in self.extrema.iter().filter(|p| interesting(p.unit)) {
            let (value, row) = if extrema.min.0.abs() > extrema.max.0.abs() {
                extrema.min
            } else {
                extrema.max
            };
            let enough = listed.iter().filter(|t| t.0 == extrema.unit).count() == MAX_LISTED;
            // The same under another name: a pin belongs to two bodies.
            let repeated = listed.iter().any(|t| {
                t.0 == extrema.unit && (t.1.abs() - value.abs()).abs() <= SAME_WITHIN * value.abs()
            });
            let largest_of_unit = listed.iter().find(|t| t.0 == extrema.unit);
            let negligible =
                value.abs() <= SAME_WITHIN * largest_of_unit.map_or(0.0, |t| t.1.abs());
            if enough || repeated || negligible || extrema.name.contains('@') {
                continue;
            }
            listed.push((extrema.unit, value));
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "  {} reaches {} {} at {abscissa} = {} {abscissa_unit}",
                extrema.name,
                number(value),
                extrema.unit,
                number(self.abscissa_values[row]),
            );
        }
        for link in &self.results.sectioned_links {
            if let (Some(extrema), Some((row, _))) =
                (link.max_bending_section(), &link.max_bending_sections)
            {
                let body = self.scene.mechanism.body_name(link.request.body);
                let [from, to] = &link.request.names;
                let _ = writeln!(
                    text,
                    "  bending moment of {body} from {from} to {to}: {} N m, {} m from {from}, at {abscissa} = {} {abscissa_unit}",
                    number(extrema.bending),
                    number(extrema.station),
                    number(self.abscissa_values[*row]),
                );
            }
        }
        text += &self.power_balance_text();
        text += &self.rounding_text();
        text += &self.indeterminate_text();
        text += &self.unmodelled_text();
        text
    }

    /// The statically indeterminate reactions, which are omitted from the tables.
    fn indeterminate_text(&self) -> String {
        if self.analysis == Analysis::Kinematics {
            return String::new();
        }
        indeterminate_note(self.results.indeterminate.iter().cloned())
    }

    /// The bodies that are not modelled.
    fn unmodelled_text(&self) -> String {
        match self.results.unmodelled_bodies(self.scene) {
            none if none.is_empty() => String::new(),
            bodies => format!(
                "  not modelled, because they affect no inertia, load or requested result: {}\n",
                bodies.join(", ")
            ),
        }
    }

    fn power_balance_text(&self) -> String {
        if !matches!(
            self.analysis,
            Analysis::Kinetostatics | Analysis::FreeMotion
        ) {
            return String::new();
        }
        let residual = self.results.power_residual;
        let mut text =
            format!("  power balance closes to {residual:.1e} of the sum of its absolute terms\n");
        if residual > MAX_BALANCE_RESIDUAL {
            text += "  this is more than rounding error: a limit position may be near\n";
        }
        text
    }

    /// The rounding error, rounded up to a power of ten.
    fn rounding_text(&self) -> String {
        let Some(error) = self.results.rounding_error.filter(|error| *error > 0.0) else {
            return String::new();
        };
        format!(
            "  estimated rounding error below {:.0e} of the largest value of each unit, compared with 32-digit arithmetic\n",
            10_f64.powf(error.log10().ceil())
        )
    }

    /// The Markdown page.
    pub(crate) fn markdown(&self, figures: &[Figure], file: &dyn Fn(&Figure) -> String) -> String {
        let mut blocks = vec![Block::Text(format!("{}.", self.first_line()))];
        if let Some(note) = &self.scene.note {
            blocks.push(Block::Text(note.clone()));
        }
        if !self.power_balance_text().is_empty() {
            blocks.push(Block::Text(format!(
                "{}.",
                self.power_balance_text().trim()
            )));
        }
        for remark in [
            self.rounding_text(),
            self.indeterminate_text(),
            self.unmodelled_text(),
        ] {
            if !remark.is_empty() {
                let remark = remark.trim();
                let (first, rest) = remark.split_at(1);
                blocks.push(Block::Text(format!("{}{rest}.", first.to_uppercase())));
            }
        }
        for figure in figures {
            blocks.push(Block::Figure {
                file: file(figure),
                alt: figure.title.clone(),
                caption: String::new(),
            });
        }
        blocks.push(Block::Heading("Peaks".to_owned()));
        let (header, rows) = extrema_cells(&self.extrema, self.abscissa(), &self.abscissa_values);
        blocks.push(Block::Table { header, rows });
        blocks.extend(self.internal_forces());
        blocks.push(Block::Heading("Columns".to_owned()));
        blocks.push(Block::Text(
            "Reactions are the action of the joint's first body on its second. Names with `@body` are the \
             same force in the axes of that body. Speeds and accelerations are time derivatives."
                .to_owned(),
        ));
        let row = |&k: &usize| {
            let column = &self.results.columns[k];
            let cells = [&column.name, column.unit, &column.meaning];
            cells.map(str::to_owned).to_vec()
        };
        blocks.push(Block::Table {
            header: ["column", "unit", "meaning"].map(str::to_owned).to_vec(),
            rows: self.selected.iter().map(row).collect(),
        });
        blocks.push(Block::Text(format!(
            "{} · {}",
            provenance_line(self.scene),
            self.trajectory.method_text
        )));
        Page {
            title: format!("{}: {}", self.scene.title, self.analysis.name()),
            blocks,
        }
        .markdown()
    }

    fn internal_forces(&self) -> Vec<Block> {
        if self.results.sectioned_links.is_empty() {
            return Vec::new();
        }
        let (abscissa, unit) = self.abscissa();
        let row = |link: &crate::trajectory::compute::SectionedLink| {
            let (row, _) = link.max_bending_sections.as_ref()?;
            let peak = link.max_bending_section()?;
            let [from, to] = &link.request.names;
            let body = self.scene.mechanism.body_name(link.request.body);
            Some(vec![
                format!("{body} from {from} to {to}"),
                number(peak.bending),
                number(peak.station),
                digits(self.abscissa_values[*row], 6),
                match link.distribution {
                    Distribution::UniformBar => "uniform bar".to_owned(),
                    Distribution::Lumped => "lumped at the centre of mass".to_owned(),
                },
            ])
        };
        let header = [
            "link",
            "bending moment [N m]",
            "station [m]",
            &format!("at {abscissa} [{unit}]"),
            "mass distribution",
        ];
        vec![
            Block::Heading("Internal forces".to_owned()),
            Block::Text(
                "The action of the part towards the second point on the part towards the first: axial force \
                 (positive in tension), shear force at +90° to it, and bending moment."
                    .to_owned(),
            ),
            Block::Table {
                header: header.map(str::to_owned).to_vec(),
                rows: self.results.sectioned_links.iter().filter_map(row).collect(),
            },
        ]
    }
}
