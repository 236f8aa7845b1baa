//! A mechanism along its way: motion, actions, reactions, power, inner forces, and the film.

mod forces;
mod free;
mod motion;

use super::skeleton::{Frame, Skeleton, place};
use super::{foot, symbol};
use crate::run::{Column, Command, Quantity, Record, Way, is_named};
use crate::words::digits;
use dwell_report::{
    Animation, Axis, Chart, Drawing, Figure, Paint, Panel, Pen, Scale, Series, Shape, Stroke,
};
use dwell_scene::Scene;

/// Most curves of a chart.
const TOGETHER: usize = 8;
/// Most bodies whose angles are drawn where none was asked for.
const BODIES: usize = 6;
/// Positions in which the mechanism is drawn, the first in full.
const DRAWN: usize = 6;
/// Frames of the film, and how long each is shown.
const FRAMES: usize = 60;
const DELAY_MS: u32 = 60;
const WIDTH_PX: u32 = 640;
/// Beyond so many times what the inner part of a way shows, a curve may leave its chart next to a
/// limit position.
const RUNAWAY: f64 = 3.0;

/// What all the pictures of a run share.
struct Sheet<'a> {
    scene: &'a Scene,
    record: &'a Record,
    command: Command,
    /// How the positions were come by.
    how: String,
    x: Axis,
    at: Vec<f64>,
    /// Whether the way begins and ends next to a limit position.
    limits: [bool; 2],
}

/// The pictures of a run but for the film, and what has to be said if some are left out.
pub(crate) fn run(
    scene: &Scene,
    record: &Record,
    way: &Way<'_>,
    command: Command,
) -> (Vec<Figure>, Option<String>) {
    let sheet = Sheet::new(scene, record, way, command);
    let mut figures = vec![sheet.mechanism(last_drawn(record, way.period))];
    figures.extend(sheet.angles());
    figures.extend(sheet.paths());
    figures.extend(sheet.lengths());
    figures.extend(sheet.transmission());
    figures.extend(sheet.coordinates());
    figures.extend(sheet.actions());
    let (reactions, note) = sheet.reactions();
    figures.extend(reactions);
    figures.extend(sheet.frame());
    figures.extend(sheet.power());
    figures.extend(sheet.energies());
    figures.extend(sheet.phases());
    figures.extend(record.links.iter().filter_map(|link| sheet.link(link)));
    (figures, note)
}

/// The mechanism in motion, with the paths that were asked for.
pub(crate) fn film(scene: &Scene, record: &Record, way: &Way<'_>) -> Animation {
    let sheet = Sheet::new(scene, record, way, Command::Kinematics);
    let skeleton = Skeleton::new(scene, &record.frames).showing(&record.placed);
    let last = last_drawn(record, way.period);
    let count = FRAMES.min(last + 1);
    // Over a whole turn the last position is the first again.
    let closed = closes(&record.frames[..=last]);
    let steps = if closed {
        count
    } else {
        count.saturating_sub(1)
    };
    let frame = |i: usize| {
        let k = (i * last) / steps.max(1);
        let mut shapes = sheet.path_lines();
        skeleton.draw(&record.frames[k], 0.0, &mut shapes);
        // Names would dance.
        shapes.retain(|s| !matches!(s, Shape::Text { .. }));
        Drawing {
            title: sheet.told(k),
            x: Axis::new("x", "m"),
            y: Axis::new("y", "m"),
            shapes,
        }
    };
    Animation {
        name: "mechanism".to_owned(),
        frames: (0..count).map(frame).collect(),
        delay_ms: DELAY_MS,
        width_px: WIDTH_PX,
        provenance: way.how.clone(),
    }
}

/// The last position that is drawn: the end of the way, or of the first whole turn of the only actuator.
fn last_drawn(record: &Record, period: Option<f64>) -> usize {
    let last = record.frames.len().saturating_sub(1);
    let Some(period) = period else { return last };
    let drive = |c: &Column| c.quantity == Quantity::Drive(0, 0);
    let Some(k) = record.columns.iter().position(drive) else {
        return last;
    };
    let rows = record.rows.iter();
    let mut turned = rows.map(|row| (row[k] - record.rows[0][k]).abs());
    // Some rounding short of it is a whole turn too.
    turned
        .position(|q| q >= period * (1.0 - 1e-9))
        .unwrap_or(last)
}

/// Whether the last position is the first again.
fn closes(frames: &[Vec<Frame>]) -> bool {
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else {
        return false;
    };
    let size = first.iter().map(|(p, _)| p.norm()).fold(0.0, f64::max);
    let same =
        |(a, b): (&Frame, &Frame)| (a.0 - b.0).norm() <= 1e-6 * size && (a.1 - b.1).norm() <= 1e-6;
    frames.len() > 2 && first.iter().zip(last).all(same)
}

impl<'a> Sheet<'a> {
    fn new(scene: &'a Scene, record: &'a Record, way: &Way<'_>, command: Command) -> Self {
        let place = |quantity: Quantity| record.columns.iter().position(|c| c.quantity == quantity);
        let values = |k: Option<usize>| -> Vec<f64> {
            let k = k.unwrap_or(0);
            record.rows.iter().map(|row| row[k]).collect()
        };
        let (x, at) = match way.swept() {
            None => (Axis::new("time", "s"), values(place(Quantity::Time))),
            Some(actuator) => {
                let at = values(place(Quantity::Drive(actuator, 0)));
                let driven = &scene.mechanism.actuators[actuator];
                let name = symbol(&driven.name);
                if driven.coordinate().is_angle() {
                    let degrees = at.iter().map(|q| q.to_degrees()).collect();
                    (Axis::degrees(name), degrees)
                } else {
                    (Axis::new(name, "m"), at)
                }
            }
        };
        let [start, end] = way.at_limits;
        Self {
            scene,
            record,
            command,
            how: way.how.clone(),
            x,
            at,
            limits: [start, end || record.stop.is_some()],
        }
    }

    fn foot(&self, words: &str) -> String {
        foot(self.scene, words)
    }

    /// Where the `k`th position is: `time = 0.25 s`, `φ = −12.5°`.
    fn told(&self, k: usize) -> String {
        let (label, at) = (&self.x.label, self.at.get(k).copied().unwrap_or(0.0));
        let text = match self.x.scale {
            Scale::Degrees => format!("{label} = {at:.1}°"),
            _ => format!("{label} = {} {}", digits(at, 4), self.x.unit),
        };
        text.replace('-', "−")
    }

    fn figure(&self, name: String, title: String, words: &str, panels: Vec<Panel>) -> Figure {
        let limits = if self.limits[0] || self.limits[1] {
            " Towards a limit position everything may grow without bound."
        } else {
            ""
        };
        Figure {
            name,
            title,
            caption: self.foot(&format!("{words}{limits}")),
            columns: 1,
            panels,
            provenance: self.how.clone(),
        }
    }

    /// A curve over the way; angles in degrees.
    fn curve(&self, name: &str, k: usize) -> Series {
        let degrees = self.record.columns[k].unit == "rad";
        let value = |row: &Vec<f64>| if degrees { row[k].to_degrees() } else { row[k] };
        let values = self.record.rows.iter().map(value);
        let points = self.at.iter().zip(values).map(|(x, y)| [*x, y]);
        Series::line(name, points.collect())
    }

    /// A chart of some columns of one unit, each with its name in the legend.
    fn chart(&self, title: &str, label: &str, curves: &[(String, usize)]) -> Chart {
        let series: Vec<Series> = curves
            .iter()
            .enumerate()
            .map(|(i, (name, k))| {
                let name = if curves.len() > 1 { name.as_str() } else { "" };
                let curve = self.curve(name, *k);
                // From the seventh on colours alone would not do.
                if i < 6 {
                    curve
                } else {
                    curve.stroke(Stroke::Dashed)
                }
            })
            .collect();
        let unit = curves
            .first()
            .map_or("", |(_, k)| self.record.columns[*k].unit);
        let y = match unit {
            "rad" => Axis::degrees(label),
            unit => Axis::new(label, pretty(unit)),
        };
        let title = match curves {
            [(name, _)] if !title.is_empty() => format!("{title}: {name}"),
            _ => title.to_owned(),
        };
        Chart {
            title,
            x: self.x.clone(),
            y: Axis {
                range: self.extent(&series),
                ..y
            },
            series,
            ..Chart::default()
        }
    }

    /// What is worth showing where curves run away towards a limit position.
    fn extent(&self, curves: &[Series]) -> Option<[f64; 2]> {
        let span = |points: &[[f64; 2]]| {
            let start = [f64::MAX, f64::MIN];
            points
                .iter()
                .fold(start, |[a, b], [_, v]| [a.min(*v), b.max(*v)])
        };
        let joined = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let none = [f64::MAX, f64::MIN];
        let inner = |c: &Series| {
            let n = c.points.len();
            let [from, to] = self.limits.map(|limit| if limit { n / 20 } else { 0 });
            span(&c.points[from..n - to])
        };
        let all = curves.iter().map(|c| span(&c.points)).fold(none, joined);
        let inner = curves.iter().map(inner).fold(none, joined);
        let [whole, part] = [all, inner].map(|[low, high]| high - low);
        let margin = 0.08 * part;
        (part > 0.0 && whole > RUNAWAY * part).then(|| [inner[0] - margin, inner[1] + margin])
    }

    /// Whether a column was asked for by name.
    fn is_wanted(&self, column: &Column) -> bool {
        is_named(self.scene, column)
    }

    /// Columns in their order, by what they hold.
    fn places(&self, holds: impl Fn(&Column) -> bool) -> Vec<usize> {
        let columns = self.record.columns.iter().enumerate();
        columns.filter(|(_, c)| holds(c)).map(|(k, _)| k).collect()
    }

    /// Whether a column never leaves zero but for rounding of `size`.
    fn is_still(&self, k: usize, size: f64) -> bool {
        self.record.rows.iter().all(|row| row[k].abs() <= size)
    }

    fn named(&self, places: &[usize], cut: &str) -> Vec<(String, usize)> {
        let name = |&k: &usize| {
            let full = &self.record.columns[k].name;
            (full.strip_suffix(cut).unwrap_or(full).to_owned(), k)
        };
        places.iter().map(name).collect()
    }

    /// The lines of the paths that were asked for.
    fn path_lines(&self) -> Vec<Shape> {
        let path = |path: &dwell_scene::PathPoint| {
            let frames = self.record.frames.iter();
            let points = frames.map(|f| place(f, path.body.0, path.at)).collect();
            Shape::line(points, Pen::new(Paint::Ink, 2.0).lightness(0.55)).named("paths")
        };
        self.scene.requests.paths.iter().map(path).collect()
    }

    /// The mechanism in several positions up to the `last`th.
    fn mechanism(&self, last: usize) -> Figure {
        let skeleton = Skeleton::new(self.scene, &self.record.frames).showing(&self.record.placed);
        let frames = &self.record.frames[..=last];
        let mut shapes = Vec::new();
        let drawn = if closes(frames) { DRAWN } else { DRAWN - 1 };
        for k in (1..DRAWN.min(frames.len())).rev() {
            skeleton.draw(
                &frames[k * last / drawn],
                0.62 + 0.04 * k as f64,
                &mut shapes,
            );
        }
        // Slots would hide what is under them.
        shapes.extend(self.path_lines());
        if let Some(first) = frames.first() {
            skeleton.draw(first, 0.0, &mut shapes);
        }
        let absent = self.record.absent(self.scene);
        let absent = match absent.is_empty() {
            true => String::new(),
            false => format!(
                " Not modelled, as nothing needs them: {}.",
                absent.join(", ")
            ),
        };
        let words = format!(
            "Drawn in full at {}, lighter further on.{absent}",
            self.told(0)
        );
        Figure {
            name: "a-mechanism".to_owned(),
            title: self.scene.title.clone(),
            caption: self.foot(&words),
            columns: 1,
            panels: vec![Panel::from(Drawing {
                title: String::new(),
                x: Axis::new("x", "m"),
                y: Axis::new("y", "m"),
                shapes,
            })],
            provenance: self.how.clone(),
        }
    }
}

/// A unit as a chart writes it.
fn pretty(unit: &str) -> String {
    unit.replace("s2", "s²")
}
