//! What a run says in words: its summary, and the page that gathers peaks, meanings and pictures.

use crate::prepare::not_in_a_table;
use crate::provenance::origin;
use crate::run::Command;
use crate::run::columns::Quantity;
use crate::run::peaks::{self, Peak};
use crate::run::record::Record;
use crate::run::way::Way;
use crate::words::{count, digits, number};
use dwell_kinetostatics::Distribution;
use dwell_report::{Block, Document as Page, Figure};
use dwell_scene::Scene;
use std::fmt::Write as _;

/// Peaks of a unit that are told in the summary.
const TOLD: usize = 3;
/// Two peaks that differ by less are told once.
const SAME: f64 = 1e-9;
/// Largest residual of the power balance that is not remarked on.
const BALANCED: f64 = 1e-9;

/// A run in words.
pub(crate) struct Document<'a> {
    scene: &'a Scene,
    record: &'a Record,
    way: &'a Way<'a>,
    command: Command,
    chosen: &'a [usize],
    peaks: Vec<Peak>,
    /// The column that says where something is, with its unit and values.
    over: (String, &'static str),
    at: Vec<f64>,
}

impl<'a> Document<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        record: &'a Record,
        way: &'a Way<'a>,
        command: Command,
        chosen: &'a [usize],
    ) -> Self {
        let over = record.columns.iter().position(|c| match way.swept() {
            None => c.quantity == Quantity::Time,
            Some(actuator) => c.quantity == Quantity::Drive(actuator, 0),
        });
        let over = over.unwrap_or(0);
        // Where is no quantity of its own.
        let told: Vec<usize> = chosen.iter().copied().filter(|&k| k != over).collect();
        let told: Vec<usize> = told
            .into_iter()
            .filter(|&k| record.columns[k].quantity != Quantity::Time)
            .collect();
        Self {
            scene,
            record,
            way,
            command,
            chosen,
            peaks: peaks::peaks(&record.columns, &told, &record.rows),
            over: (record.columns[over].name.clone(), record.columns[over].unit),
            at: record.rows.iter().map(|row| row[over]).collect(),
        }
    }

    fn over(&self) -> (&str, &str) {
        (&self.over.0, self.over.1)
    }

    pub(crate) fn peaks_csv(&self) -> String {
        peaks::csv(&self.peaks, self.over(), &self.at)
    }

    fn first_line(&self) -> String {
        let reached = self.record.rows.len();
        let all = if reached == self.way.points {
            count(reached, "position")
        } else {
            format!("{reached} of {}", count(self.way.points, "position"))
        };
        format!(
            "{}: {}, {all} over {}",
            self.scene.title,
            self.command.name(),
            self.way.words
        )
    }

    /// What is printed.
    pub(crate) fn summary(&self) -> String {
        let mut text = format!("{}\n", self.first_line());
        let interesting = |unit: &str| match self.command {
            Command::Kinematics => matches!(unit, "rad/s" | "m/s" | "rad/s2" | "m/s2"),
            _ => matches!(unit, "N" | "N m" | "W"),
        };
        let mut told: Vec<(&str, f64)> = Vec::new();
        let (over, over_unit) = self.over();
        for peak in self.peaks.iter().filter(|p| interesting(p.unit)) {
            let (value, row) = if peak.low.0.abs() > peak.high.0.abs() {
                peak.low
            } else {
                peak.high
            };
            let enough = told.iter().filter(|t| t.0 == peak.unit).count() == TOLD;
            // The same under another name: a pin belongs to two bodies.
            let again = told
                .iter()
                .any(|t| t.0 == peak.unit && (t.1.abs() - value.abs()).abs() <= SAME * value.abs());
            let most = told.iter().find(|t| t.0 == peak.unit);
            let nothing = value.abs() <= SAME * most.map_or(0.0, |t| t.1.abs());
            if enough || again || nothing || peak.name.contains('@') {
                continue;
            }
            told.push((peak.unit, value));
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "  {} reaches {} {} at {over} = {} {over_unit}",
                peak.name,
                number(value),
                peak.unit,
                number(self.at[row]),
            );
        }
        for link in &self.record.links {
            if let (Some(peak), Some((row, _))) = (link.peak(), &link.worst) {
                let body = self.scene.mechanism.body_name(link.request.body);
                let [from, to] = &link.request.names;
                let _ = writeln!(
                    text,
                    "  bending moment of {body} from {from} to {to}: {} N m, {} m from {from}, at {over} = {} {over_unit}",
                    number(peak.bending),
                    number(peak.station),
                    number(self.at[*row]),
                );
            }
        }
        text += &self.balance();
        text += &self.shared();
        text += &self.absent();
        text
    }

    /// The reactions that are in no table, because the loads do not determine them.
    fn shared(&self) -> String {
        if self.command == Command::Kinematics {
            return String::new();
        }
        not_in_a_table(self.record.shared.iter().cloned())
    }

    /// The bodies that are not modelled.
    fn absent(&self) -> String {
        match self.record.absent(self.scene) {
            none if none.is_empty() => String::new(),
            bodies => format!(
                "  not modelled, because no inertia, load or request needs them: {}\n",
                bodies.join(", ")
            ),
        }
    }

    fn balance(&self) -> String {
        if !matches!(self.command, Command::Kinetostatics | Command::Simulate) {
            return String::new();
        }
        let residual = self.record.residual;
        let mut text = format!("  power balance kept to {residual:.1e} of its absolute terms\n");
        if residual > BALANCED {
            text += "  that is more than rounding: a limit position may be near\n";
        }
        text
    }

    /// The page that gathers everything.
    pub(crate) fn markdown(&self, figures: &[Figure], file: &dyn Fn(&Figure) -> String) -> String {
        let mut blocks = vec![Block::Text(format!("{}.", self.first_line()))];
        if let Some(note) = &self.scene.note {
            blocks.push(Block::Text(note.clone()));
        }
        if !self.balance().is_empty() {
            blocks.push(Block::Text(format!("{}.", self.balance().trim())));
        }
        for told in [self.shared(), self.absent()] {
            if !told.is_empty() {
                let told = told.trim();
                let (first, rest) = told.split_at(1);
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
        let (header, rows) = peaks::cells(&self.peaks, self.over(), &self.at);
        blocks.push(Block::Table { header, rows });
        blocks.extend(self.sections());
        blocks.push(Block::Heading("Columns".to_owned()));
        blocks.push(Block::Text(
            "Reactions are the action of the joint's first body on its second. Names with `@body` are the \
             same force in the axes of that body. Speeds and accelerations are derivatives by time."
                .to_owned(),
        ));
        let row = |&k: &usize| {
            let column = &self.record.columns[k];
            let cells = [&column.name, column.unit, &column.meaning];
            cells.map(str::to_owned).to_vec()
        };
        blocks.push(Block::Table {
            header: ["column", "unit", "meaning"].map(str::to_owned).to_vec(),
            rows: self.chosen.iter().map(row).collect(),
        });
        blocks.push(Block::Text(format!(
            "{} · {}",
            origin(self.scene),
            self.way.how
        )));
        Page {
            title: format!("{}: {}", self.scene.title, self.command.name()),
            blocks,
        }
        .markdown()
    }

    fn sections(&self) -> Vec<Block> {
        if self.record.links.is_empty() {
            return Vec::new();
        }
        let (over, unit) = self.over();
        let row = |link: &crate::run::Link| {
            let (row, _) = link.worst.as_ref()?;
            let peak = link.peak()?;
            let [from, to] = &link.request.names;
            let body = self.scene.mechanism.body_name(link.request.body);
            Some(vec![
                format!("{body} from {from} to {to}"),
                number(peak.bending),
                number(peak.station),
                digits(self.at[*row], 6),
                match link.distribution {
                    Distribution::UniformBar => "a uniform bar".to_owned(),
                    Distribution::Lumped => "at its centre".to_owned(),
                },
            ])
        };
        let header = [
            "link",
            "bending moment [N m]",
            "station [m]",
            &format!("at {over} [{unit}]"),
            "its mass is taken as",
        ];
        vec![
            Block::Heading("Inner forces".to_owned()),
            Block::Text(
                "What the part towards the second point does to the part towards the first: the axial force \
                 (positive pulls), the shear force at +90° to it, and the couple."
                    .to_owned(),
            ),
            Block::Table {
                header: header.map(str::to_owned).to_vec(),
                rows: self.record.links.iter().filter_map(row).collect(),
            },
        ]
    }
}
