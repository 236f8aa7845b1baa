//! The results of a sweep in an SQLite file, which survive an interruption.
//!
//! Two tables: `study` holds the definition of the sweep by key and value, `points` one row per finished point, keyed
//! by its index, with a checksum. Whatever is in an existing file is checked when it is opened, because a damaged file
//! that SQLite can read would hand over wrong numbers. SQLite uses a rollback journal and an exclusive lock while the file is open: both work on network
//! file systems, where the write-ahead log does not.

use crate::explain::SweepError;
use crate::sweep::compute::{PointResult, Row};
use crate::sweep::store_check::{ExpectedPoints, check_file, checksum, damage};
use rusqlite::types::Value;
use rusqlite::{Connection, ErrorCode, params_from_iter};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// SQLite application id of Dwell (`Dwel`), and the version of the tables.
const APPLICATION: i32 = 0x4477_656c;
const VERSION: i32 = 3;
/// Longest time until a finished point is on disk.
const BATCH: Duration = Duration::from_millis(200);
/// How long to wait for another process that has the file open.
const BUSY_TIMEOUT: Duration = Duration::from_millis(500);
/// Key of the shard that a file holds: the only key in which files of one study may differ.
pub(crate) const SHARD: &str = "shard";
/// Key of the scene's text; its hash is compared instead.
pub(crate) const SCENE_TEXT: &str = "scene_text";

/// The identity of a study, by key, in the order in which differences are reported.
pub(crate) type StudyIdentity = Vec<(&'static str, String)>;

/// An open file.
pub(crate) struct Store<'a> {
    path: PathBuf,
    connection: Connection,
    points: ExpectedPoints<'a>,
    inputs: usize,
    results: usize,
}

/// A name within SQL.
fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

impl<'a> Store<'a> {
    /// Opens the file of a study, or creates it. `headings` are those of the inputs and of the results.
    ///
    /// # Errors
    /// [`StoreFault::Differs`] if it holds another study; [`StoreFault::Reason`] if it is not a sweep store, is damaged,
    /// cannot be read or written, or another process has it open.
    pub(crate) fn open(
        path: &Path,
        study: &StudyIdentity,
        headings: [&[String]; 2],
        points: ExpectedPoints<'a>,
    ) -> Result<Self, StoreFault> {
        let mut connection = Connection::open(path)?;
        connection.busy_timeout(BUSY_TIMEOUT)?;
        connection.pragma_update(None, "locking_mode", "EXCLUSIVE")?;
        let number = |name: &str| connection.pragma_query_value(None, name, |row| row.get(0));
        let (application, version): (i32, i32) =
            (number("application_id")?, number("user_version")?);
        let tables: i64 =
            connection.query_row("SELECT count(*) FROM sqlite_schema", (), |row| row.get(0))?;
        if tables == 0 && application == 0 {
            create(&mut connection, study, headings)?;
        } else if application != APPLICATION {
            return Err(StoreFault::Reason("it is not a sweep store".to_owned()));
        } else if version != VERSION {
            return Err(StoreFault::Reason(format!(
                "its format is version {version}, and this version of Dwell reads only version {VERSION}; \
                 export it with the version of Dwell that wrote it (`dwell sweep … --export csv`)"
            )));
        }
        compare(&connection, study)?;
        check_file(&connection, &definitions(headings))?;
        let [inputs, results] = headings.map(<[String]>::len);
        Ok(Self {
            path: path.to_owned(),
            connection,
            points,
            inputs,
            results,
        })
    }

    /// The indices of the stored points, each of which is checked.
    pub(crate) fn indices(&self) -> Result<Vec<u64>, SweepError> {
        self.read(|row| row.index)
    }

    /// All finished points, by index.
    pub(crate) fn rows(&self) -> Result<Vec<Row>, SweepError> {
        self.read(|row| row)
    }

    /// Reads and checks all rows, by index, and keeps a part of each.
    fn read<T>(&self, part: impl Fn(Row) -> T) -> Result<Vec<T>, SweepError> {
        let read = || -> Result<Vec<T>, StoreFault> {
            let mut statement = self
                .connection
                .prepare("SELECT * FROM points ORDER BY \"index\"")?;
            let mut rows = statement.query(())?;
            let mut parts = Vec::new();
            while let Some(row) = rows.next()? {
                parts.push(part(self.row(row)?));
            }
            Ok(parts)
        };
        read().map_err(|e| e.with_path(&self.path))
    }

    fn row(&self, row: &rusqlite::Row<'_>) -> Result<Row, StoreFault> {
        let numbers = |from: usize, count: usize| {
            let cells = (from..from + count).map(|k| row.get::<_, Option<f64>>(k));
            let numbers = cells.map(|cell| Ok(cell?.unwrap_or(f64::NAN)));
            numbers.collect::<rusqlite::Result<Vec<f64>>>()
        };
        let end = 1 + self.inputs + self.results;
        let found = Row {
            index: row.get::<_, i64>(0)? as u64,
            inputs: numbers(1, self.inputs)?,
            result: PointResult {
                values: numbers(1 + self.inputs, self.results)?,
                message: row.get(end)?,
            },
        };
        self.points.check(&found, row.get(end + 1)?)?;
        Ok(found)
    }

    /// Writes rows as they arrive, until the channel closes; each is on disk after at most 0.2 s.
    pub(crate) fn write_rows(&mut self, rows: &Receiver<Row>) -> Result<(), SweepError> {
        let path = self.path.clone();
        self.write(rows).map_err(|e| e.with_path(&path))
    }

    fn write(&mut self, rows: &Receiver<Row>) -> Result<(), StoreFault> {
        let marks = vec!["?"; 3 + self.inputs + self.results].join(", ");
        let insert = format!("INSERT INTO points VALUES ({marks})");
        while let Ok(first) = rows.recv() {
            let until = Instant::now() + BATCH;
            let transaction = self.connection.transaction()?;
            let mut statement = transaction.prepare(&insert)?;
            let mut next = Some(first);
            while let Some(row) = next {
                statement.execute(params_from_iter(cells(row)))?;
                let remaining = until.saturating_duration_since(Instant::now());
                // Every row taken from the channel is written.
                next = match remaining.is_zero() {
                    true => None,
                    false => rows.recv_timeout(remaining).ok(),
                };
            }
            drop(statement);
            transaction.commit()?;
        }
        Ok(())
    }
}

fn cells(row: Row) -> Vec<Value> {
    // SQLite has no NaN: it is stored as NULL.
    let real = |v: f64| match v.is_nan() {
        true => Value::Null,
        false => Value::Real(v),
    };
    let checksum = checksum(&row);
    // An index is far below SQLite's largest integer.
    let mut cells = vec![Value::Integer(row.index as i64)];
    cells.extend(row.inputs.into_iter().map(real));
    cells.extend(row.result.values.into_iter().map(real));
    cells.push(row.result.message.map_or(Value::Null, Value::Text));
    cells.push(Value::Integer(checksum));
    cells
}

/// The definitions of the tables, by name.
fn definitions(headings: [&[String]; 2]) -> [(&'static str, String); 2] {
    let study = "CREATE TABLE study (\"key\" TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID";
    let column = |name: &String| format!("{} REAL, ", quoted(name));
    let columns: String = headings.concat().iter().map(column).collect();
    let points = format!(
        "CREATE TABLE points (\"index\" INTEGER PRIMARY KEY, {columns}\"message\" TEXT, \"checksum\" INTEGER NOT NULL)"
    );
    [("study", study.to_owned()), ("points", points)]
}

/// Creates the tables in one transaction.
fn create(
    connection: &mut Connection,
    study: &StudyIdentity,
    headings: [&[String]; 2],
) -> Result<(), StoreFault> {
    let transaction = connection.transaction()?;
    for (_, definition) in definitions(headings) {
        transaction.execute(&definition, ())?;
    }
    for (key, value) in study {
        transaction.execute("INSERT INTO study VALUES (?, ?)", (key, value))?;
    }
    transaction.pragma_update(None, "application_id", APPLICATION)?;
    transaction.pragma_update(None, "user_version", VERSION)?;
    Ok(transaction.commit()?)
}

/// Checks that the file holds this study.
fn compare(connection: &Connection, study: &StudyIdentity) -> Result<(), StoreFault> {
    let mut statement = connection.prepare("SELECT \"key\", value FROM study")?;
    let rows = statement.query_map((), |row| Ok((row.get(0)?, row.get(1)?)))?;
    let stored: HashMap<String, String> = rows.collect::<Result<_, _>>()?;
    study_difference(&stored, study).map_or(Ok(()), Err)
}

/// In what a stored study differs from this one.
pub(crate) fn study_difference(
    stored: &HashMap<String, String>,
    study: &StudyIdentity,
) -> Option<StoreFault> {
    for (key, expected) in study {
        let found = stored.get(*key).map_or("", String::as_str);
        // The scene's hash is independent of line ends and a byte order mark, its text is not.
        let text = |text: &str| text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
        if *key == SCENE_TEXT && text(found) != text(expected) {
            return Some(damage("the scene's text is not that of its hash"));
        }
        if *key != SCENE_TEXT && found != expected {
            return Some(StoreFault::Differs(match *key {
                "scene_sha256" => "the scene has changed since".to_owned(),
                key => {
                    let [found, expected] = [found, expected].map(shortened);
                    format!("its {key}: {found}, not {expected}")
                }
            }));
        }
    }
    None
}

/// A value in a message, shortened if it is long.
fn shortened(value: &str) -> String {
    const MAX_LENGTH: usize = 70;
    if value.chars().count() <= MAX_LENGTH {
        return format!("`{value}`");
    }
    let start: String = value.chars().take(MAX_LENGTH).collect();
    format!("`{start}…`")
}

/// An error of the store, to which the caller adds the path.
pub(crate) enum StoreFault {
    Reason(String),
    Differs(String),
}

impl StoreFault {
    pub(crate) fn with_path(self, path: &Path) -> SweepError {
        let path = path.to_owned();
        match self {
            Self::Reason(reason) => SweepError::Store { path, reason },
            Self::Differs(difference) => SweepError::DifferentStudy { path, difference },
        }
    }
}

impl From<rusqlite::Error> for StoreFault {
    fn from(error: rusqlite::Error) -> Self {
        Self::Reason(match error.sqlite_error_code() {
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
                "another process has it open: wait for it, or give each process its own --shard"
                    .to_owned()
            }
            Some(ErrorCode::NotADatabase) => "it is not an SQLite file".to_owned(),
            Some(ErrorCode::DatabaseCorrupt) => {
                "the file is damaged: move it, and its points are computed again".to_owned()
            }
            Some(ErrorCode::DiskFull) => "the disk is full".to_owned(),
            Some(ErrorCode::CannotOpen) => "cannot be opened".to_owned(),
            Some(ErrorCode::ReadOnly) => "cannot be written".to_owned(),
            _ => error.to_string(),
        })
    }
}
