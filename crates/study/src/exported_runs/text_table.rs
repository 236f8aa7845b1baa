//! Tables as mechanism programs export them: a header, a separator and a decimal mark of their choice, lines of comment.

use dwell_scene::SceneError;
use std::collections::HashMap;
use std::ops::Range;

/// Marks with which programs begin a line of comment.
const COMMENT_MARKS: [&str; 5] = ["#", "%", "//", "*", "!"];

/// A column of an exported table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExportedColumn {
    /// Its name, without a unit in brackets.
    pub name: String,
    /// The unit in brackets after the name.
    pub unit: Option<String>,
    /// Its values, as in the file.
    pub values: Vec<f64>,
    /// Half a unit of the last printed digit, of the value where that is largest.
    pub rounding: f64,
    /// Its error by interpolation at other positions.
    pub resampling: f64,
}

/// An exported table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ExportedTable {
    /// The file.
    pub file: String,
    /// Its columns, all of one length.
    pub columns: Vec<ExportedColumn>,
}

/// A line of the text, and its offset.
#[derive(Clone, Copy)]
struct Line<'t> {
    at: usize,
    text: &'t str,
}

/// The separator of fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    Character(char),
    Blanks,
}

/// A field, and its offset in the text.
struct Field<'t> {
    span: Range<usize>,
    text: &'t str,
}

impl ExportedTable {
    /// Reads the text of a file. The header is the last line before the numbers, also in a comment. Fields are separated by
    /// tabs, semicolons, commas or blanks; with any but commas a comma is a decimal mark.
    ///
    /// # Errors
    /// [`SceneError`] with the place in the text: no numbers, no header, a row of another length, or a value that is not
    /// finite.
    pub fn read(file: &str, text: &str) -> Result<Self, SceneError> {
        let lines = lines_of(text);
        let is_data = |line: &Line<'_>| !is_comment(line) && Separator::of_numbers(line).is_some();
        let Some(first) = lines.iter().position(is_data) else {
            let message = format!("`{file}` has no row of numbers");
            let help = "a table has a header and rows of numbers, separated by commas, semicolons, tabs or blanks";
            return Err(SceneError::without_labels(message, Some(help.to_owned())));
        };
        let separator = Separator::of_numbers(&lines[first]).unwrap_or(Separator::Blanks);
        let error = |span: Range<usize>, message: String, help: &str, label: &str| {
            let help = Some(help.to_owned());
            SceneError::in_text(file, text, message, help, span, label.to_owned())
        };
        let Some(header) = first.checked_sub(1).map(|k| lines[k]) else {
            let line = lines[0];
            let help = "the line before the numbers names the columns: `t,phi [rad],torque [N m]`";
            let span = line.at..line.at + line.text.len();
            return Err(error(
                span,
                format!("`{file}` has no header"),
                help,
                "numbers at once",
            ));
        };
        let heads = separator.header(&header);
        let mut columns: Vec<ExportedColumn> = heads.iter().map(|head| column(head)).collect();
        let mut digits = vec![0; columns.len()];
        for line in lines[first..].iter().filter(|line| !is_comment(line)) {
            let added = separator.add_row(line, &mut columns, &mut digits);
            added.map_err(|(span, message, help)| error(span, message, help, "here"))?;
        }
        for (column, digits) in columns.iter_mut().zip(digits) {
            column.rounding = half_unit(&column.values, digits);
        }
        Ok(Self {
            file: file.to_owned(),
            columns,
        })
    }

    /// A table of exact columns, such as those of a NumPy archive.
    pub fn of_columns(file: &str, columns: Vec<(String, Vec<f64>)>) -> Self {
        let of = |(name, values): (String, Vec<f64>)| {
            let largest = values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
            ExportedColumn {
                values,
                rounding: 0.5 * f64::EPSILON * largest,
                ..column(&name)
            }
        };
        Self {
            file: file.to_owned(),
            columns: columns.into_iter().map(of).collect(),
        }
    }

    /// The column of a name.
    pub fn column(&self, name: &str) -> Option<&ExportedColumn> {
        self.columns.iter().find(|column| column.name == name)
    }
}

/// The first column of each name: tables may have very many.
pub(super) fn by_name(columns: &[ExportedColumn]) -> HashMap<&str, &ExportedColumn> {
    let columns = columns.iter().rev();
    columns.map(|column| (&column.name[..], column)).collect()
}

/// The lines of a text that are not empty.
fn lines_of(text: &str) -> Vec<Line<'_>> {
    let mut at = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let here = Line {
            at,
            text: line.trim_end(),
        };
        at += line.len();
        here
    });
    lines.filter(|line| !line.text.trim().is_empty()).collect()
}

fn is_comment(line: &Line<'_>) -> bool {
    let text = line.text.trim_start_matches('\u{feff}').trim_start();
    COMMENT_MARKS.iter().any(|mark| text.starts_with(mark))
}

/// A column from its head: `phi [deg]`, `phi (deg)` or `phi`.
fn column(head: &str) -> ExportedColumn {
    let head = head.trim();
    let (name, unit) = [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| {
            let (name, unit) = head.strip_suffix(close)?.rsplit_once(open)?;
            Some((name.trim(), Some(unit.trim().to_owned())))
        })
        .unwrap_or((head, None));
    ExportedColumn {
        name: name.to_owned(),
        unit: unit.filter(|unit| !unit.is_empty()),
        ..ExportedColumn::default()
    }
}

impl Separator {
    /// The separator with which a line consists of at least two numbers and nothing else.
    fn of_numbers(line: &Line<'_>) -> Option<Self> {
        let all = ['\t', ';', ','].map(Self::Character);
        let all = all.into_iter().chain([Self::Blanks]);
        let mut fitting = all.filter(|separator| {
            let fields = separator.fields(line);
            // A value that is missing is an error of its row, not another kind of table.
            let known = fields
                .iter()
                .filter(|f| separator.number(f.text).is_some())
                .count();
            fields.len() > 1
                && 2 * known > fields.len()
                && fields.iter().all(|f| could_be_number(f.text))
        });
        fitting.next()
    }

    /// The fields of a line of numbers.
    fn fields<'t>(self, line: &Line<'t>) -> Vec<Field<'t>> {
        let separates = |c: char| match self {
            Self::Character(separator) => c == separator,
            Self::Blanks => c.is_whitespace(),
        };
        let mut fields = Vec::new();
        let mut at = line.at;
        for part in line.text.split(separates) {
            let text = part.trim_matches(['\u{feff}', ' ', '"']);
            if !(self == Self::Blanks && text.is_empty()) {
                fields.push(Field {
                    span: at..at + part.len(),
                    text,
                });
            }
            at += part.len() + 1;
        }
        // Some programs end each row with a separator.
        if fields.len() > 1 && fields.last().is_some_and(|last| last.text.is_empty()) {
            fields.pop();
        }
        fields
    }

    /// Adds a row to the columns; the error has the place, the fault and a suggestion.
    fn add_row(
        self,
        line: &Line<'_>,
        columns: &mut [ExportedColumn],
        digits: &mut [usize],
    ) -> Result<(), (Range<usize>, String, &'static str)> {
        let fields = self.fields(line);
        if fields.len() != columns.len() {
            let (found, wanted) = (fields.len(), columns.len());
            let message = format!("a row of {found} fields, where the header has {wanted}");
            let help = "each row has a number for each column of the header";
            return Err((line.at..line.at + line.text.len(), message, help));
        }
        for ((column, digits), field) in columns.iter_mut().zip(digits).zip(fields) {
            let Some((value, printed)) = self.number(field.text) else {
                let (text, name) = (field.text, &column.name);
                let message = format!("`{text}` is no finite number, in column `{name}`");
                let help = "leave out rows without a value, such as those of a failed position";
                return Err((field.span, message, help));
            };
            column.values.push(value);
            *digits = printed.max(*digits);
        }
        Ok(())
    }

    /// The heads of the columns: in quotes a head may hold the separator, in brackets blanks.
    fn header(self, line: &Line<'_>) -> Vec<String> {
        let mut text = line.text.trim_start_matches('\u{feff}').trim_start();
        for mark in COMMENT_MARKS {
            text = text.strip_prefix(mark).unwrap_or(text).trim_start();
        }
        let text = text.strip_prefix("columns:").unwrap_or(text);
        let mut heads = vec![String::new()];
        let (mut in_quotes, mut brackets) = (false, 0_i32);
        for c in text.trim().chars() {
            let separates = match self {
                Self::Character(separator) => c == separator,
                Self::Blanks => c.is_whitespace() && brackets == 0,
            };
            match c {
                '"' => in_quotes = !in_quotes,
                _ if separates && !in_quotes => heads.push(String::new()),
                c => {
                    brackets += i32::from("[(".contains(c)) - i32::from("])".contains(c));
                    heads.last_mut().into_iter().for_each(|head| head.push(c));
                }
            }
        }
        if self == Self::Blanks {
            heads.retain(|head| !head.trim().is_empty());
            // `phi [rad]`: the unit belongs to the name before it.
            let mut joined: Vec<String> = Vec::new();
            for head in heads {
                match joined.last_mut().filter(|_| head.starts_with(['[', '('])) {
                    Some(name) => *name = format!("{name} {head}"),
                    None => joined.push(head),
                }
            }
            heads = joined;
        } else if heads.len() > 1 && heads.last().is_some_and(|head| head.trim().is_empty()) {
            heads.pop();
        }
        heads
    }

    /// A finite number with how many significant digits it is printed.
    fn number(self, text: &str) -> Option<(f64, usize)> {
        let text = match self {
            Self::Character(',') => text.to_owned(),
            Self::Character(_) | Self::Blanks => text.replace(',', "."),
        };
        // Fortran writes `1.5D-03`.
        let text = text.replace(['d', 'D'], "e");
        let value: f64 = text.parse().ok().filter(|value: &f64| value.is_finite())?;
        let mantissa = text.split(['e', 'E']).next().unwrap_or_default();
        let digits = mantissa.chars().filter(char::is_ascii_digit);
        Some((value, digits.skip_while(|digit| *digit == '0').count()))
    }
}

/// Half a unit of the last digit of the largest value; `digits` is the number of significant digits of the longest number,
/// because shorter ones end by chance. A column of integers is exact.
fn half_unit(values: &[f64], digits: usize) -> f64 {
    let largest = values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
    let bits = 0.5 * f64::EPSILON * largest;
    if largest == 0.0 || values.iter().all(|value| value.fract() == 0.0) {
        return bits;
    }
    let exponent = largest.log10().floor() + 1.0 - digits as f64;
    (0.5 * 10_f64.powf(exponent)).max(bits)
}

/// Whether a field is a number, or represents a missing one.
fn could_be_number(text: &str) -> bool {
    let missing = ["", "nan", "-nan", "inf", "-inf", "na", "n/a", "null", "-"];
    missing.contains(&text.to_lowercase().as_str())
        || text
            .chars()
            .all(|c| c.is_ascii_digit() || "+-.,eEdD".contains(c))
}
