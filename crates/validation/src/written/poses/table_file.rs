//! The file of tables of `reduce --table-accuracy`, read as docs/table-format.md describes it and evaluated at the rows.

use super::difference::Differences;
use super::rows::Rows;
use super::scene_text::hash;
use std::collections::BTreeMap;

/// A table file: its lines by keyword.
struct TableFile<'a> {
    reactions: Vec<&'a str>,
    loads: Vec<&'a str>,
    numbers: BTreeMap<&'a str, Vec<f64>>,
    cells: [Vec<Vec<f64>>; 3],
}

impl<'a> TableFile<'a> {
    fn read(text: &'a str) -> Option<Self> {
        let mut file = Self {
            reactions: Vec::new(),
            loads: Vec::new(),
            numbers: BTreeMap::new(),
            cells: Default::default(),
        };
        for line in text.lines() {
            let (key, rest) = line.split_once(' ')?;
            let numbers = || {
                rest.split(' ')
                    .map(str::parse)
                    .collect::<Result<Vec<f64>, _>>()
                    .ok()
            };
            match key {
                "reaction" => file.reactions.push(rest),
                "load" => file.loads.push(rest),
                "m" => file.cells[0].push(numbers()?),
                "ab" => file.cells[1].push(numbers()?),
                "wc" => file.cells[2].push(numbers()?),
                "accuracy" | "extent" | "turns" | "scales" | "errors" | "cells" => {
                    file.numbers.insert(key, numbers()?);
                }
                _ => {}
            }
        }
        Some(file)
    }

    /// The columns in the order of scales and errors: m, ½m′, all a, all b, all w, then all c, load by load.
    fn columns(&self) -> Vec<String> {
        let of = |end: &'static str| {
            self.reactions
                .iter()
                .map(move |name| format!("{name}.{end}"))
        };
        let w = self.loads.iter().map(|name| format!("{name}.w"));
        let c = self.loads.iter().flat_map(|load| {
            self.reactions
                .iter()
                .map(move |name| format!("{name}.c.{load}"))
        });
        ["m".to_owned(), "half_dm".to_owned()]
            .into_iter()
            .chain(of("a"))
            .chain(of("b"))
            .chain(w)
            .chain(c)
            .collect()
    }

    /// All columns at a coordinate; none outside the table.
    fn at(&self, q: f64) -> Option<Vec<f64>> {
        let [from, length] = *self.numbers.get("extent")?.first_chunk()?;
        let turns = *self.numbers.get("turns")?.first()?;
        let q = if turns > 0.0 {
            (q - from).rem_euclid(length)
        } else {
            q - from
        };
        if !(0.0..=length).contains(&q) {
            return None;
        }
        let cell = |cells: &'_ [Vec<f64>]| {
            let width = length / cells.len() as f64;
            let i = ((q / width).floor() as usize).min(cells.len().checked_sub(1)?);
            Some((i, 2.0 * q / width - 2.0 * i as f64 - 1.0, width))
        };
        let (i, x, h) = cell(&self.cells[0])?;
        let (middle, slopes) = self.cells[0][i].split_first()?;
        let (mut half_dm, mut m, mut power) = (0.0, *middle, 1.0);
        for (j, slope) in slopes.iter().enumerate() {
            half_dm += slope * power;
            power *= x;
            m += h * slope * power / (j as f64 + 1.0);
        }
        let mut all = vec![m, half_dm];
        for cells in &self.cells[1..] {
            let Some((i, x, _)) = cell(cells) else {
                continue;
            };
            let values = &cells[i];
            let width = values.len() / 8;
            let horner =
                |k: usize| (0..8).fold(0.0, |sum, power| sum * x + values[power * width + k]);
            all.extend((0..width).map(horner));
        }
        Some(all)
    }
}

/// The rows of `reduce` with the values of its table in place of their own.
pub(crate) fn table_rows(text: &str, rows: &Rows, coordinate: &str) -> Option<Rows> {
    let file = TableFile::read(text)?;
    let names = file.columns();
    let mut of_table = rows.clone();
    for row in 0..rows.count {
        let Some(values) = rows.get(row, coordinate).and_then(|q| file.at(q)) else {
            continue;
        };
        for (name, value) in names.iter().zip(values) {
            *of_table.columns.get_mut(name)?.get_mut(row)? = value;
        }
    }
    Some(of_table)
}

/// The rows of `reduce` against its table: what is beyond the errors that the file states, relative to its scales. Of the
/// text the checksum, too.
pub(crate) fn table_differences(text: &str, rows: &Rows, coordinate: &str) -> Differences {
    let mut all = Differences::default();
    let Some(file) = TableFile::read(text) else {
        all.fail("the table is not as its format says");
        return all;
    };
    let checksum = text.rfind("check ").and_then(|at| {
        let written = u64::from_str_radix(text[at..].trim().strip_prefix("check ")?, 16).ok()?;
        Some(written == hash(&text[..at]))
    });
    if checksum != Some(true) {
        all.fail("the checksum of the table is another");
    }
    let columns = file.columns();
    let of = |key: &str| file.numbers.get(key).cloned().unwrap_or_default();
    let (scales, errors, accuracy) = (of("scales"), of("errors"), of("accuracy"));
    for row in 0..rows.count {
        let Some(values) = rows.get(row, coordinate).and_then(|q| file.at(q)) else {
            continue;
        };
        for (k, (name, value)) in columns.iter().zip(&values).enumerate() {
            let (Some(written), Some(scale), Some(error)) =
                (rows.get(row, name), scales.get(k), errors.get(k))
            else {
                all.fail(format!("the table has {name}, the rows have not"));
                continue;
            };
            let allowed = error.min(accuracy.first().copied().unwrap_or(0.0));
            let beyond = ((written - value).abs() - allowed * scale).max(0.0);
            all.add(beyond, *scale, "", || format!("table, row {row}, {name}"));
        }
        if values.len() != columns.len() {
            all.fail(format!(
                "the table has {} columns, its head {}",
                values.len(),
                columns.len()
            ));
        }
    }
    all
}
