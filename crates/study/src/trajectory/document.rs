//! The text of a trajectory analysis: the printed summary, and the Markdown page with extrema, column meanings and figures.

use crate::explain::CoupledMechanism;
use crate::number_format::{count, number};
use crate::output::{indeterminate_note, provenance_line};
use crate::ranges::extent;
use crate::trajectory::column_extrema::{ColumnExtrema, searched_in_rows, sorted_extrema};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, Extremum, Quantity, SectionedLink, Trajectory, TrajectoryResults,
};
use crate::trajectory::highlights::Movement;
use dwell_findings::{Column, Record, RecordedExtrema};
use dwell_kinetostatics::{Distribution, Section};
use dwell_laws::Law;
use dwell_report::{Block, Document as Page, Figure};
use dwell_scene::{PlaneScene, SceneFile};

/// Relative error up to which a value is printed with all six digits.
const ALL_DIGITS: f64 = 1e-7;

/// Extrema of one unit that the summary lists.
const MAX_LISTED: usize = 3;
/// Extrema that differ relatively by less than this are listed once.
const SAME_WITHIN: f64 = 1e-9;
/// Largest relative residual of the power balance that is not commented on.
const MAX_BALANCE_RESIDUAL: f64 = 1e-9;

/// Values in a table from which on fewer columns save a noticeable time.
const MUCH: usize = 50_000;

/// The note for extrema that were not searched for between the rows.
const LARGEST_OF_ROWS: &str =
    "these are the largest values of the rows: the motion has too many steps to look between them";

/// The reactions of joints that couple two coordinates by a curve: not by a ratio, as teeth do, which push on either side.
pub(crate) fn contacts(mechanism: &impl CoupledMechanism) -> Vec<String> {
    let is_line = |law: &Law| matches!(law, Law::Polynomial(p) if p.coefficients.len() <= 2);
    let all = mechanism.coupling_laws().into_iter();
    let curves = all.filter(|of| !is_line(of.law));
    let names = curves.map(|of| mechanism.joint_name(of.joint).to_owned());
    names
        .flat_map(|name| ["force", "moment"].map(|component| format!("{name}.{component}")))
        .collect()
}

/// The results of a trajectory analysis as text.
pub(crate) struct Document<'a> {
    scene: &'a SceneFile,
    /// The highlights of the movement.
    movement: Movement<'a>,
    /// The bodies that are not modelled.
    unmodelled: Vec<String>,
    /// The reactions of cams and other couplings by a curve.
    pub(crate) contacts: Vec<String>,
    results: &'a TrajectoryResults,
    trajectory: &'a Trajectory<'a>,
    extrema: Vec<ColumnExtrema>,
    /// Name and unit of the abscissa: time, or the swept coordinate.
    abscissa: (&'a str, &'static str),
    /// `at` the abscissa, with its unit, as the heading of a column.
    at: String,
    abscissa_column: usize,
}

impl<'a> Document<'a> {
    /// The document for a scene in the plane.
    pub(crate) fn new(scene: &'a PlaneScene, computed: &'a ComputedTrajectory<'a>) -> Self {
        let mut document = Self::of_file(&scene.file, scene.mechanism.size(), computed);
        document.movement.scene = Some(scene);
        document.unmodelled = computed.results.unmodelled_bodies(scene);
        document.contacts = contacts(&scene.mechanism);
        document
    }

    /// The document for any scene, with a mechanism of this size, m.
    pub(crate) fn of_file(
        scene: &'a SceneFile,
        size: f64,
        computed: &'a ComputedTrajectory<'a>,
    ) -> Self {
        let (trajectory, results) = (&computed.trajectory, &computed.results);
        let columns = &results.columns;
        let abscissa = results.abscissa(trajectory);
        let (name, unit) = (&columns[abscissa].name, columns[abscissa].unit);
        // The abscissa itself is not a result, nor is the time.
        let is_result = |&k: &usize| k != abscissa && columns[k].quantity != Quantity::Time;
        let listed: Vec<usize> = results.written.iter().copied().filter(is_result).collect();
        Self {
            scene,
            movement: Movement {
                file: scene,
                scene: None,
                results,
                abscissa,
            },
            unmodelled: Vec::new(),
            contacts: Vec::new(),
            results,
            trajectory,
            extrema: sorted_extrema(results, &listed, abscissa, size),
            abscissa: (name, unit),
            at: format!("at {name} [{unit}]"),
            abscissa_column: abscissa,
        }
    }

    /// The extrema as CSV, each with the value of the abscissa where it occurs.
    pub(crate) fn extrema_csv(&self) -> String {
        let at = &self.at;
        let mut text = format!("quantity,unit,min,min {at},max,max {at}\n");
        for of in &self.extrema {
            // Names of a scene hold neither commas nor quotes.
            text += &format!("{},{}", of.name, of.unit);
            for Extremum { value, at } in of.ends {
                text += &format!(",{value:?},{at:?}");
            }
            text.push('\n');
        }
        text
    }

    /// The numbers of the summary, and all extrema.
    pub(crate) fn record(&self) -> Record {
        let mut record = Record::default();
        record.add_count("positions", self.results.len());
        record.add_count("wanted_positions", self.trajectory.points);
        record.add_count("columns", self.results.written.len());
        let (name, unit) = self.abscissa;
        record.abscissa = Some(Column::new(name, unit));
        let last = self.results.len().saturating_sub(1);
        let [from, to] = extent([0, last].map(|row| self.abscissa_at(row)));
        record.add("from", unit, from);
        record.add("to", unit, to);
        let [from, to] = self.trajectory.wanted_extent();
        record.add("wanted_from", unit, from);
        record.add("wanted_to", unit, to);
        record.extrema = self
            .extrema
            .iter()
            .map(|of| RecordedExtrema {
                column: Column::new(&of.name, of.unit),
                ends: of.ends.map(|end| [end.value, end.at]),
                error: (of.error > 0.0).then_some(of.error),
            })
            .collect();
        for (link, row, section) in self.bending_moments() {
            let of = |what: &str| format!("{}.{what}", link.name);
            record.add(of("bending_moment"), "N m", section.bending);
            record.add(of("bending_moment.station"), "m", section.station);
            let at = self.abscissa_at(row);
            record.add(of("bending_moment.at"), unit, at);
        }
        use Analysis::{FreeMotion, Kinetostatics};
        if matches!(self.trajectory.analysis, Kinetostatics | FreeMotion) {
            let residual = self.results.power_residual;
            record.add("power_balance_residual", "", residual);
        }
        if let Some(error) = self.results.rounding_error.filter(|error| *error > 0.0) {
            record.add("rounding_error", "", error);
        }
        record
    }

    /// The extrema as a text table.
    fn extrema_table(&self) -> Block {
        let at = &self.at;
        let header = ["quantity", "unit", "min", at, "max", at];
        let row = |of: &ColumnExtrema| {
            let cells = of.ends.map(|end| of.texts(end));
            let mut row = vec![of.name.clone(), of.unit.to_owned()];
            row.extend(cells.into_iter().flatten());
            row
        };
        Block::Table {
            header: header.map(str::to_owned).into(),
            rows: self.extrema.iter().map(row).collect(),
        }
    }

    fn title(&self) -> String {
        let analysis = self.trajectory.analysis.name();
        format!("{}: {analysis}", self.scene.title)
    }

    fn first_line(&self) -> String {
        let (reached, points) = (self.results.len(), self.trajectory.points);
        let mut all = count(points, "position");
        if reached != points {
            all = format!("{reached} of {all}");
        }
        let over = &self.trajectory.description;
        format!("{}, {all} over {over}", self.title())
    }

    /// The printed text; its numbers are recorded.
    pub(crate) fn summary(&self, record: &mut Record) -> String {
        let mut text = format!("{}\n", self.first_line());
        if self.trajectory.analysis == Analysis::Kinematics {
            text += &self.movement.describe(record);
        }
        text += &self.largest_values(record);
        let (abscissa, _) = self.abscissa;
        for (link, row, section) in self.bending_moments() {
            let (link, from) = (&link.name, &link.request.names[0]);
            let bending = number(section.bending);
            let [(station, station_unit), (at, unit)] = [
                self.in_scene_unit(section.station, "m"),
                self.in_scene_unit(self.abscissa_at(row), self.abscissa.1),
            ];
            let [station, at] = [station, at].map(number);
            text += &format!(
                "  bending moment of {link}: {bending} N m, {station} {station_unit} from {from}, at {abscissa} = {at} {unit}, the largest of the rows\n"
            );
        }
        text += &self.power_balance_text();
        text += &self.remarks().concat();
        text += &self.less_note();
        text
    }

    /// How to ask for less, where everything is much.
    fn less_note(&self) -> String {
        let values = self.results.written.len() * self.results.len();
        if self.results.is_limited || values < MUCH {
            return String::new();
        }
        let lists = match self.trajectory.analysis {
            Analysis::Kinematics => "`variables`",
            _ => "`reactions` or `variables`",
        };
        format!(
            "  all {} columns are computed: {lists} in [requests] of the scene selects fewer\n",
            self.results.written.len()
        )
    }

    /// The line about the largest value of a column.
    fn largest_value(&self, of: &ColumnExtrema) -> String {
        let (name, unit) = (&of.name, of.unit);
        let is_known = of.error < of.largest().value.abs();
        if !is_known {
            return format!(
                "  {name}: its largest value is not known, as its estimated error is {:.1e} {unit}\n",
                of.error
            );
        }
        let (abscissa, abscissa_unit) = self.abscissa;
        let (at_factor, abscissa_unit) = self.in_scene_unit(1.0, abscissa_unit);
        let (factor, shown_unit) = self.in_scene_unit(1.0, unit);
        let shown = of.scaled(factor, at_factor);
        let [value, at] = shown.texts(shown.largest());
        let of_rows = if of.of_rows && self.results.extrema.are_between_rows() {
            ", of the rows only"
        } else {
            ""
        };
        format!(
            "  {name} reaches {value} {shown_unit} at {abscissa} = {at} {abscissa_unit}{of_rows}\n"
        )
    }

    /// The lines about the largest values of each unit.
    fn largest_values(&self, record: &mut Record) -> String {
        let mut text = String::new();
        let is_interesting = |unit: &str| match self.trajectory.analysis {
            Analysis::Kinematics => matches!(unit, "rad/s" | "m/s" | "rad/s2" | "m/s2"),
            _ => matches!(unit, "N" | "N m" | "W"),
        };
        let mut listed: Vec<(&str, f64)> = Vec::new();
        let mut largest_error = 0.0_f64;
        for of in &self.extrema {
            let (name, unit) = (&of.name, of.unit);
            let value = of.largest().value;
            let size = value.abs();
            let of_unit = listed.iter().filter(|(u, _)| *u == unit);
            let mut of_unit = of_unit.map(|(_, v)| v.abs());
            let is_enough = of_unit.clone().count() == MAX_LISTED;
            let largest = of_unit.clone().next().unwrap_or(0.0);
            // The same under another name: a pin belongs to two bodies.
            let is_repeated = of_unit.any(|v| (v - size).abs() <= SAME_WITHIN * size);
            let is_negligible = size <= SAME_WITHIN * largest || size == 0.0;
            if !is_interesting(unit)
                || is_enough
                || is_repeated
                || is_negligible
                || name.contains('@')
            {
                continue;
            }
            listed.push((unit, value));
            if of.error < size {
                largest_error = largest_error.max(of.error / size);
            }
            text += &self.largest_value(of);
        }
        // Along a prescribed motion it is that of rounding, which seldom takes a digit.
        let is_free = self.trajectory.analysis == Analysis::FreeMotion;
        if largest_error > if is_free { 0.0 } else { ALL_DIGITS } {
            record.add("error.printed_extrema", "", largest_error);
            text += &format!(
                "  estimated error of these values: at most {largest_error:.1e} of each\n"
            );
        }
        if !text.is_empty() && !self.results.extrema.are_between_rows() {
            text += &format!("  {LARGEST_OF_ROWS}\n");
        }
        text
    }

    /// The abscissa at a row.
    fn abscissa_at(&self, row: usize) -> f64 {
        self.results.value_at(row, self.abscissa_column)
    }

    /// A number of this unit in the scene's unit of angles and lengths, and that unit; forces stay in SI units.
    fn in_scene_unit(&self, value: f64, unit: &str) -> (f64, String) {
        for (si, is_angle) in [("rad", true), ("m", false)] {
            let Some(rest) = unit.strip_prefix(si) else {
                continue;
            };
            if rest.is_empty() || rest.starts_with("/s") {
                let (value, unit) = self.scene.to_scene_unit(value, is_angle);
                return (value, format!("{unit}{rest}"));
            }
        }
        (value, unit.to_owned())
    }

    /// The links whose internal forces are computed, with the position and the section of the largest bending moment.
    fn bending_moments(&self) -> impl Iterator<Item = (&SectionedLink, usize, Section)> {
        let links = self.results.sectioned_links.iter();
        links.filter_map(|link| {
            let (row, _) = link.max_bending_sections.as_ref()?;
            Some((link, *row, link.max_bending_section()?))
        })
    }

    /// A line for each cam whose contact would have to pull: which of the two signs of its force pushes is not known, but one that only pushes
    /// has one sign.
    fn pulling_contacts(&self) -> String {
        let contacts = self.extrema.iter();
        let contacts = contacts.filter(|of| self.contacts.contains(&of.name));
        let changes = contacts.filter(|of| {
            let [low, high] = of.ends.map(|end| end.value);
            let rounding = of.error.max(SAME_WITHIN * high.max(-low));
            low < -rounding && high > rounding
        });
        let line = |of: &ColumnExtrema| {
            let [[low, _], [high, _]] = of.ends.map(|end| of.texts(end));
            format!(
                "  {} changes its sign, from {low} to {high} {}: a cam that touches on one side only would have to pull there, and lifts off\n",
                of.name, of.unit
            )
        };
        changes.map(line).collect()
    }

    /// Remarks on the rounding error, the columns shown as zero, the omitted reactions, the bodies that are not modelled, and the contacts
    /// that would have to pull; each may be empty.
    fn remarks(&self) -> [String; 5] {
        // Rounded up to a power of ten.
        let rounding = match self.results.rounding_error {
            Some(error) if error > 0.0 => format!(
                "  estimated rounding error below {:.0e} of the largest value of each unit, compared with 32-digit \
                 arithmetic\n",
                10_f64.powf(error.log10().ceil())
            ),
            _ => String::new(),
        };
        let zero = match self.results.noted_zeros.as_slice() {
            [] => String::new(),
            columns => format!("  zero but for rounding: {}\n", columns.join("; ")),
        };
        let indeterminate = match self.trajectory.analysis {
            Analysis::Kinematics => String::new(),
            _ => indeterminate_note(self.results.indeterminate.iter().cloned()),
        };
        let unmodelled = match &self.unmodelled {
            none if none.is_empty() => String::new(),
            bodies => format!(
                "  not modelled, because they affect no inertia, load or requested result: {}\n",
                bodies.join(", ")
            ),
        };
        let contacts = self.pulling_contacts();
        [rounding, zero, indeterminate, unmodelled, contacts]
    }

    fn power_balance_text(&self) -> String {
        use Analysis::{FreeMotion, Kinetostatics};
        if !matches!(self.trajectory.analysis, Kinetostatics | FreeMotion) {
            return String::new();
        }
        let residual = self.results.power_residual;
        let mut text = format!(
            "  residual of the power balance: {residual:.1e} of the sum of its absolute terms\n"
        );
        if residual > MAX_BALANCE_RESIDUAL {
            text += "  this is more than rounding error: a limit position may be near\n";
        }
        text
    }

    /// The page, with all figures.
    pub(crate) fn page(&self, figures: &[Figure], file: &dyn Fn(&Figure) -> String) -> Page {
        let mut blocks = vec![Block::Text(format!(
            "{}.",
            dwell_report::markdown_text(&self.first_line())
        ))];
        blocks.extend(self.scene.note.clone().map(Block::Words));
        let balance = self.power_balance_text();
        if !balance.is_empty() {
            blocks.push(Block::Text(format!("{}.", balance.trim())));
        }
        for remark in self.remarks().iter().filter(|remark| !remark.is_empty()) {
            let (first, rest) = remark.trim().split_at(1);
            blocks.push(Block::Text(format!("{}{rest}.", first.to_uppercase())));
        }
        blocks.extend(figures.iter().map(|figure| Block::Figure {
            file: file(figure),
            alt: figure.title.clone(),
            caption: String::new(),
        }));
        blocks.push(Block::Heading("Peaks".to_owned()));
        let where_found = if self.results.extrema.are_between_rows() {
            let in_rows = searched_in_rows(self.results);
            let in_rows = in_rows.map_or_else(String::new, |text| format!(" {text}"));
            format!("Smallest and largest values, also between the rows of the table.{in_rows}")
        } else {
            "Smallest and largest values in the rows of the table: between them there may be larger ones.".to_owned()
        };
        blocks.push(Block::Text(where_found));
        blocks.push(self.extrema_table());
        blocks.extend(self.internal_forces());
        blocks.push(Block::Heading("Columns".to_owned()));
        blocks.push(Block::Text(
            "Reactions are the forces and moments of the joint's first body on its second. Names with `@body` are the \
             same force in the axes of that body. Speeds and accelerations are time derivatives."
                .to_owned(),
        ));
        let row = |&k: &usize| {
            let column = &self.results.columns[k];
            let cells = [&column.name, column.unit, &column.meaning];
            cells.map(str::to_owned).into()
        };
        blocks.push(Block::Table {
            header: ["column", "unit", "meaning"].map(str::to_owned).into(),
            rows: self.results.written.iter().map(row).collect(),
        });
        let provenance = provenance_line(self.scene);
        let method = &self.trajectory.method_text;
        blocks.push(Block::Text(format!("{provenance} · {method}")));
        let title = self.title();
        Page { title, blocks }
    }

    fn internal_forces(&self) -> Vec<Block> {
        if self.results.sectioned_links.is_empty() {
            return Vec::new();
        }
        let row = |(link, row, peak): (&SectionedLink, usize, Section)| {
            let distribution = match link.distribution {
                Distribution::UniformBar => "uniform bar",
                Distribution::Lumped => "lumped at the centre of mass",
            };
            let [bending, station, at] =
                [peak.bending, peak.station, self.abscissa_at(row)].map(number);
            let (link, distribution) = (link.name.clone(), distribution.to_owned());
            vec![link, bending, station, at, distribution]
        };
        let header = [
            "link",
            "bending moment [N m]",
            "station [m]",
            &self.at,
            "mass distribution",
        ];
        vec![
            Block::Heading("Internal forces".to_owned()),
            Block::Text(
                "What the part towards the second point exerts on the part towards the first: axial force \
                 (positive in tension), shear force at +90° to it, and bending moment."
                    .to_owned(),
            ),
            Block::Table {
                header: header.map(str::to_owned).into(),
                rows: self.bending_moments().map(row).collect(),
            },
        ]
    }
}
