//! Long tables as files, written part by part with the bytes of a table in memory.

use crate::error::ReportError;
use crate::npz::table_archive;
use crate::table::{TableFormat, csv_header, csv_lines};
use dwell_findings::{Column, LongTable};
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::sync::Arc;

/// Some columns of a long table, as a file of some format.
#[derive(Debug, Clone)]
pub(crate) struct LongExport {
    table: Arc<LongTable>,
    columns: Vec<usize>,
    format: TableFormat,
}

impl PartialEq for LongExport {
    fn eq(&self, other: &Self) -> bool {
        let same = Arc::ptr_eq(&self.table, &other.table);
        same && self.columns == other.columns && self.format == other.format
    }
}

impl Eq for LongExport {}

impl LongExport {
    pub(crate) fn new(table: &Arc<LongTable>, columns: &[usize], format: TableFormat) -> Self {
        Self {
            table: Arc::clone(table),
            columns: columns.to_vec(),
            format,
        }
    }

    /// Writes the file.
    pub(crate) fn write(&self, file: &mut File) -> Result<(), ReportError> {
        let mut out = BufWriter::new(file);
        let described: Vec<Column> = self
            .columns
            .iter()
            .map(|&k| self.table.columns()[k].clone())
            .collect();
        match self.format {
            TableFormat::Csv => {
                out.write_all(csv_header(&described)?.as_bytes())
                    .map_err(csv::Error::from)?;
                for part in 0..self.table.parts() {
                    let rows = self.table.rows_of_part(part, &self.columns);
                    for lines in csv_lines(&rows.map_err(csv::Error::from)?) {
                        out.write_all(lines.as_bytes()).map_err(csv::Error::from)?;
                    }
                }
            }
            TableFormat::Npz => {
                let values = |i: usize| self.table.column(self.columns[i]);
                out = table_archive(out, &described, self.table.len(), &values)?;
            }
        }
        out.flush().map_err(csv::Error::from)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Files;
    use crate::output_folder::OutputFolder;
    use dwell_findings::Table;
    use std::fs;

    #[test]
    fn a_long_table_makes_the_files_of_the_same_table_in_memory() {
        let columns = ["t", "a/b", "a b"].map(|name| Column::new(name, "m"));
        let mut long = LongTable::new(columns.to_vec()).unwrap();
        let mut table = Table {
            columns: vec![columns[0].clone(), columns[1].clone()],
            rows: Vec::new(),
        };
        for k in 0..10_000 {
            let t = f64::from(k) * 0.1;
            let row = [t, if k % 7 == 0 { f64::NAN } else { t.sin() }, -t];
            long.push(&row).unwrap();
            table.rows.push(row[..2].to_vec());
        }
        let mut files = Files::new();
        files
            .add_table("memory", &table, &TableFormat::ALL)
            .unwrap();
        files.add_long_table("long", &Arc::new(long), &[0, 1], &TableFormat::ALL);
        let folder = std::env::temp_dir().join(format!("dwell-long-{}", std::process::id()));
        OutputFolder::open(&folder).unwrap().write(&files).unwrap();
        for extension in ["csv", "npz"] {
            let [one, other] = ["memory", "long"]
                .map(|stem| fs::read(folder.join(format!("{stem}.{extension}"))).unwrap());
            assert!(
                one == other,
                "{extension}: {} and {} bytes",
                one.len(),
                other.len()
            );
        }
        fs::remove_dir_all(folder).unwrap();
    }
}
