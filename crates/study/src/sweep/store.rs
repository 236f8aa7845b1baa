//! The results of a study in an SQLite file: what is computed once stays, whatever ends the run.
//!
//! Two tables: `study` tells by key and value what is computed, `points` has a row for each finished point, whose
//! index is its key. A rollback journal, and an exclusive lock as long as the file is open: that also holds on the
//! network file systems of clusters, where SQLite's write-ahead log does not.

use super::error::SweepError;
use super::point::Found;
use rusqlite::{Connection, ErrorCode, params_from_iter, types::Value};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Marks the file as ours (`Dwel`), and the version of its tables.
const APPLICATION: i32 = 0x4477_656c;
const VERSION: i32 = 1;
/// Longest that a finished point is not yet on the disk.
const BATCH: Duration = Duration::from_millis(200);
/// How long another run may hold the file before we give up.
const PATIENCE: Duration = Duration::from_millis(500);
/// The part of the study that a file holds: the one key that a file may differ in.
pub(crate) const SHARD: &str = "shard";
/// The text of the scene, whose hash is compared in its place.
pub(crate) const TEXT: &str = "scene_text";

/// What a file is about, by key, in the order in which differences are told.
pub(crate) type Study = Vec<(&'static str, String)>;

/// A finished point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) index: u64,
    pub(crate) inputs: Vec<f64>,
    pub(crate) found: Found,
}

/// An open file.
#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    connection: Connection,
    inputs: usize,
    results: usize,
}

/// A name within SQL.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

impl Store {
    /// Opens the file of a study, or makes it. `headings` are those of the inputs and of the results.
    ///
    /// # Errors
    /// [`SweepError::Other`] if it holds another study, [`SweepError::Store`] if it is none, cannot be read or
    /// written, or another run has it open.
    pub(crate) fn open(
        path: &Path,
        study: &Study,
        headings: [&[String]; 2],
    ) -> Result<Self, SweepError> {
        Self::within(path, study, headings).map_err(|e| e.at(path))
    }

    fn within(path: &Path, study: &Study, headings: [&[String]; 2]) -> Result<Self, Fault> {
        let mut connection = Connection::open(path)?;
        connection.busy_timeout(PATIENCE)?;
        connection.pragma_update(None, "locking_mode", "EXCLUSIVE")?;
        let number = |name: &str| connection.pragma_query_value(None, name, |row| row.get(0));
        let (application, version): (i32, i32) =
            (number("application_id")?, number("user_version")?);
        let tables: i64 =
            connection.query_row("SELECT count(*) FROM sqlite_schema", (), |row| row.get(0))?;
        if tables == 0 && application == 0 {
            create(&mut connection, study, headings)?;
        } else if application != APPLICATION {
            return Err(Fault::Reason("it is no store of a sweep".to_owned()));
        } else if version != VERSION {
            return Err(Fault::Reason(format!(
                "its tables are of version {version}, and this Dwell knows version {VERSION}"
            )));
        }
        compare(&connection, study)?;
        let [inputs, results] = headings.map(<[String]>::len);
        Ok(Self {
            path: path.to_owned(),
            connection,
            inputs,
            results,
        })
    }

    /// The points that are there.
    pub(crate) fn indices(&self) -> Result<Vec<u64>, SweepError> {
        let read = || -> Result<Vec<u64>, Fault> {
            let mut statement = self
                .connection
                .prepare("SELECT \"index\" FROM points ORDER BY 1")?;
            let rows = statement.query_map((), |row| row.get::<_, i64>(0))?;
            Ok(rows
                .map(|row| row.map(|k| k as u64))
                .collect::<Result<_, _>>()?)
        };
        read().map_err(|e| e.at(&self.path))
    }

    /// All finished points, by index.
    pub(crate) fn rows(&self) -> Result<Vec<Row>, SweepError> {
        let real = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let read = || -> Result<Vec<Row>, Fault> {
            let mut statement = self
                .connection
                .prepare("SELECT * FROM points ORDER BY \"index\"")?;
            let rows = statement.query_map((), |row| {
                let some = |from: usize, count: usize| {
                    let cells = (from..from + count).map(|k| row.get(k).map(real));
                    cells.collect::<Result<Vec<f64>, _>>()
                };
                Ok(Row {
                    index: row.get::<_, i64>(0)? as u64,
                    inputs: some(1, self.inputs)?,
                    found: Found {
                        values: some(1 + self.inputs, self.results)?,
                        message: row.get(1 + self.inputs + self.results)?,
                    },
                })
            })?;
            Ok(rows.collect::<Result<_, _>>()?)
        };
        read().map_err(|e| e.at(&self.path))
    }

    /// Writes what arrives, until no one sends any more: on the disk at the latest after a fifth of a second.
    pub(crate) fn take(&mut self, rows: &Receiver<Row>) -> Result<(), SweepError> {
        let path = self.path.clone();
        self.write(rows).map_err(|e| e.at(&path))
    }

    fn write(&mut self, rows: &Receiver<Row>) -> Result<(), Fault> {
        let marks = vec!["?"; 2 + self.inputs + self.results].join(", ");
        let insert = format!("INSERT INTO points VALUES ({marks})");
        while let Ok(first) = rows.recv() {
            let until = Instant::now() + BATCH;
            let transaction = self.connection.transaction()?;
            let mut statement = transaction.prepare(&insert)?;
            let mut next = Some(first);
            while let Some(row) = next {
                statement.execute(params_from_iter(cells(row)))?;
                let left = until.saturating_duration_since(Instant::now());
                // Nothing is taken from the channel that is not written.
                next = if left.is_zero() {
                    None
                } else {
                    rows.recv_timeout(left).ok()
                };
            }
            drop(statement);
            transaction.commit()?;
        }
        Ok(())
    }
}

fn cells(row: Row) -> Vec<Value> {
    // SQLite has no NaN: an absent value is NULL.
    let real = |v: f64| {
        if v.is_nan() {
            Value::Null
        } else {
            Value::Real(v)
        }
    };
    // An index is far below the largest whole number of SQLite.
    let mut cells = vec![Value::Integer(row.index as i64)];
    cells.extend(row.inputs.into_iter().map(real));
    cells.extend(row.found.values.into_iter().map(real));
    cells.push(row.found.message.map_or(Value::Null, Value::Text));
    cells
}

/// The tables, all at once or not at all.
fn create(
    connection: &mut Connection,
    study: &Study,
    headings: [&[String]; 2],
) -> Result<(), Fault> {
    let transaction = connection.transaction()?;
    transaction.execute_batch(
        "CREATE TABLE study (\"key\" TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;",
    )?;
    for (key, value) in study {
        transaction.execute("INSERT INTO study VALUES (?, ?)", (key, value))?;
    }
    let columns: Vec<String> = headings
        .concat()
        .iter()
        .map(|name| format!("{} REAL", quoted(name)))
        .collect();
    transaction.execute_batch(&format!(
        "CREATE TABLE points (\"index\" INTEGER PRIMARY KEY, {}, \"message\" TEXT);",
        columns.join(", ")
    ))?;
    transaction.pragma_update(None, "application_id", APPLICATION)?;
    transaction.pragma_update(None, "user_version", VERSION)?;
    Ok(transaction.commit()?)
}

/// Whether the file is about this study.
fn compare(connection: &Connection, study: &Study) -> Result<(), Fault> {
    let mut statement = connection.prepare("SELECT \"key\", value FROM study")?;
    let rows = statement.query_map((), |row| Ok((row.get(0)?, row.get(1)?)))?;
    let there: HashMap<String, String> = rows.collect::<Result<_, _>>()?;
    for (key, here) in study {
        let found = there.get(*key).map_or("", String::as_str);
        // The hash tells whether the text is the same, whatever ends its lines.
        if *key != TEXT && found != here {
            return Err(Fault::Differs(match *key {
                "scene_sha256" => "the scene was changed since".to_owned(),
                key => format!("its {key}: {}, not {}", shown(found), shown(here)),
            }));
        }
    }
    Ok(())
}

/// A value in a message, cut where it is long.
fn shown(value: &str) -> String {
    const LONGEST: usize = 70;
    if value.chars().count() <= LONGEST {
        return format!("`{value}`");
    }
    let start: String = value.chars().take(LONGEST).collect();
    format!("`{start}…`")
}

/// What went wrong within a file that its caller names.
#[derive(Debug)]
enum Fault {
    Reason(String),
    Differs(String),
}

impl Fault {
    fn at(self, path: &Path) -> SweepError {
        let path = path.to_owned();
        match self {
            Self::Reason(reason) => SweepError::Store { path, reason },
            Self::Differs(difference) => SweepError::Other { path, difference },
        }
    }
}

impl From<rusqlite::Error> for Fault {
    fn from(error: rusqlite::Error) -> Self {
        Self::Reason(match error.sqlite_error_code() {
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
                "another run has it open: wait for it, or give each run a --shard of its own"
                    .to_owned()
            }
            Some(ErrorCode::NotADatabase) => "it is no SQLite file".to_owned(),
            Some(ErrorCode::DatabaseCorrupt) => "the file is damaged: move it away".to_owned(),
            Some(ErrorCode::DiskFull) => "the disk is full".to_owned(),
            Some(ErrorCode::CannotOpen) => "cannot be opened".to_owned(),
            Some(ErrorCode::ReadOnly) => "cannot be written".to_owned(),
            _ => error.to_string(),
        })
    }
}
