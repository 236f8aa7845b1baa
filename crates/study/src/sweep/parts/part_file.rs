//! One file of a study: a Parquet file with rows in the order of their points.
//!
//! Doubles are stored split by bytes and compressed: sign and exponent are nearly constant along a column, the mantissa is not.
//! Each column has a checksum in the file's metadata, because a reader accepts many damaged files.

use crate::explain::SweepError;
use crate::sweep::compute::Row;
use crate::sweep::identity::StoreFault;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesPtr};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::ops::RangeInclusive;
use std::path::Path;
use std::sync::Arc;

/// The hash of the study's definition, and the checksums of the columns, in the metadata of a file.
const STUDY: &str = "dwell.study";
const CHECKSUMS: &str = "dwell.checksums";
const INDEX: &str = "index";
const MESSAGE: &str = "message";

/// The columns of every file of a study: the index, inputs, results (null where there is none) and the message.
pub(super) struct PartFormat {
    schema: TypePtr,
    properties: WriterPropertiesPtr,
    inputs: usize,
    results: usize,
    study_hash: String,
}

/// A column's cells, as hashed and written.
type Cells = Vec<Option<f64>>;

impl PartFormat {
    /// `headings` are those of the inputs and of the results.
    pub(super) fn new(headings: [&[String]; 2], study_hash: String) -> Result<Self, ParquetError> {
        let index = Type::primitive_type_builder(INDEX, Physical::INT64)
            .with_repetition(Repetition::REQUIRED);
        let mut columns = vec![Arc::new(index.build()?)];
        let [inputs, results] = headings;
        for (names, repetition) in [
            (inputs, Repetition::REQUIRED),
            (results, Repetition::OPTIONAL),
        ] {
            for name in names {
                let double = Type::primitive_type_builder(name, Physical::DOUBLE);
                columns.push(Arc::new(double.with_repetition(repetition).build()?));
            }
        }
        let message = Type::primitive_type_builder(MESSAGE, Physical::BYTE_ARRAY)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(Some(LogicalType::String));
        columns.push(Arc::new(message.build()?));
        let schema = Type::group_type_builder("points").with_fields(columns);
        let single = |name: &str| ColumnPath::new(vec![name.to_owned()]);
        let properties = WriterProperties::builder()
            .set_created_by(format!("dwell {}", env!("CARGO_PKG_VERSION")))
            .set_dictionary_enabled(false)
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_encoding(Encoding::BYTE_STREAM_SPLIT)
            .set_column_encoding(single(INDEX), Encoding::DELTA_BINARY_PACKED)
            .set_column_encoding(single(MESSAGE), Encoding::PLAIN);
        Ok(Self {
            schema: Arc::new(schema.build()?),
            properties: Arc::new(properties.build()),
            inputs: inputs.len(),
            results: results.len(),
            study_hash,
        })
    }

    /// Writes the rows of a file, on the disk when it returns.
    pub(super) fn write(&self, path: &Path, rows: &[Row]) -> Result<(), ParquetError> {
        let file = BufWriter::new(File::create(path)?);
        let (schema, properties) = (Arc::clone(&self.schema), Arc::clone(&self.properties));
        let mut writer = SerializedFileWriter::new(file, schema, properties)?;
        let mut group = writer.next_row_group()?;
        let indices: Vec<i64> = rows.iter().map(|row| row.index as i64).collect();
        let mut checksums = vec![of_indices(&indices)];
        write_column::<Int64Type>(&mut group, &indices, None)?;
        for k in 0..self.inputs {
            let cells: Vec<f64> = rows.iter().map(|row| unsigned(row.inputs[k])).collect();
            write_column::<DoubleType>(&mut group, &cells, None)?;
            checksums.push(of_numbers(&cells.into_iter().map(Some).collect::<Cells>()));
        }
        for k in 0..self.results {
            let cell = |row: &Row| Some(unsigned(row.result.values[k])).filter(|v| !v.is_nan());
            let cells: Cells = rows.iter().map(cell).collect();
            let values: Vec<f64> = cells.iter().copied().flatten().collect();
            let levels: Vec<i16> = cells.iter().map(|v| i16::from(v.is_some())).collect();
            write_column::<DoubleType>(&mut group, &values, Some(&levels))?;
            checksums.push(of_numbers(&cells));
        }
        let messages: Vec<Option<&str>> = rows
            .iter()
            .map(|row| row.result.message.as_deref())
            .collect();
        let values: Vec<ByteArray> = messages.iter().flatten().map(|&m| m.into()).collect();
        let levels: Vec<i16> = messages.iter().map(|v| i16::from(v.is_some())).collect();
        write_column::<ByteArrayType>(&mut group, &values, Some(&levels))?;
        checksums.push(of_messages(messages.into_iter()));
        group.close()?;
        let entry = |key: &str, value| KeyValue::new(key.to_owned(), Some(value));
        writer.append_key_value_metadata(entry(STUDY, self.study_hash.clone()));
        writer.append_key_value_metadata(entry(CHECKSUMS, checksums.join(" ")));
        let mut file = writer.into_inner()?;
        file.flush()?;
        file.get_ref().sync_all()?;
        Ok(())
    }

    /// Opens a file that declares to belong to this study; `expected` is its largest number of rows.
    pub(super) fn open(
        &self,
        path: &Path,
        expected: RangeInclusive<usize>,
    ) -> Result<PartFile, PartFault> {
        let reader = SerializedFileReader::new(File::open(path)?)?;
        let metadata = reader.metadata().file_metadata();
        let entry = |name: &str| {
            let mut all = metadata.key_value_metadata().into_iter().flatten();
            all.find(|entry| entry.key == name)
                .and_then(|entry| entry.value.clone())
        };
        if entry(STUDY).is_none_or(|study| study != self.study_hash) {
            return Err(PartFault::OtherStudy);
        }
        let checksums = entry(CHECKSUMS).unwrap_or_default();
        let checksums: Vec<String> = checksums.split(' ').map(str::to_owned).collect();
        let rows = match reader.metadata().row_groups() {
            [group] => usize::try_from(group.num_rows()).ok(),
            _ => None,
        };
        let rows = rows.filter(|rows| expected.contains(rows));
        let columns = 2 + self.inputs + self.results;
        let has_columns = metadata.schema() == &*self.schema && checksums.len() == columns;
        let (Some(rows), true) = (rows, has_columns) else {
            return Err(PartFault::Damaged(
                "it has not the rows and columns of its part",
            ));
        };
        Ok(PartFile {
            reader,
            rows,
            checksums,
            columns: [self.inputs, self.results],
        })
    }
}

/// A file that is open for reading.
pub(super) struct PartFile {
    reader: SerializedFileReader<File>,
    rows: usize,
    checksums: Vec<String>,
    /// Numbers of inputs and of results.
    columns: [usize; 2],
}

const OTHER_TYPE: PartFault = PartFault::Damaged("a column has another type");

impl PartFile {
    pub(super) fn indices(&self) -> Result<Vec<i64>, PartFault> {
        let ColumnReader::Int64ColumnReader(column) = self.column(0)? else {
            return Err(OTHER_TYPE);
        };
        let indices: Vec<i64> = self.cells(column)?.into_iter().flatten().collect();
        self.check(0, &of_indices(&indices))?;
        Ok(indices)
    }

    pub(super) fn input(&self, input: usize) -> Result<Vec<f64>, PartFault> {
        self.numbers(1 + input)
    }

    /// A result, NaN where there is none.
    pub(super) fn result(&self, result: usize) -> Result<Vec<f64>, PartFault> {
        self.numbers(1 + self.columns[0] + result)
    }

    fn numbers(&self, column: usize) -> Result<Vec<f64>, PartFault> {
        let ColumnReader::DoubleColumnReader(reader) = self.column(column)? else {
            return Err(OTHER_TYPE);
        };
        let cells = self.cells(reader)?;
        self.check(column, &of_numbers(&cells))?;
        Ok(cells.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect())
    }

    pub(super) fn messages(&self) -> Result<Vec<Option<String>>, PartFault> {
        let column = 1 + self.columns[0] + self.columns[1];
        let ColumnReader::ByteArrayColumnReader(reader) = self.column(column)? else {
            return Err(OTHER_TYPE);
        };
        let cells = self.cells(reader)?.into_iter();
        let text = |bytes: ByteArray| String::from_utf8_lossy(bytes.data()).into_owned();
        let messages: Vec<Option<String>> = cells.map(|cell| cell.map(text)).collect();
        self.check(column, &of_messages(messages.iter().map(Option::as_deref)))?;
        Ok(messages)
    }

    fn check(&self, column: usize, checksum: &str) -> Result<(), PartFault> {
        if self.checksums[column] == checksum {
            return Ok(());
        }
        Err(PartFault::Damaged("the checksum of a column differs"))
    }

    fn column(&self, column: usize) -> Result<ColumnReader, PartFault> {
        Ok(self.reader.get_row_group(0)?.get_column_reader(column)?)
    }

    /// The cells of a column, `None` for null.
    fn cells<T: DataType>(
        &self,
        mut column: ColumnReaderImpl<T>,
    ) -> Result<Vec<Option<T::T>>, PartFault> {
        let (mut levels, mut values) = (Vec::new(), Vec::with_capacity(self.rows));
        let mut read = 0;
        while read < self.rows {
            let rest = self.rows - read;
            let (records, ..) = column.read_records(rest, Some(&mut levels), None, &mut values)?;
            if records == 0 {
                return Err(PartFault::Damaged("a column is too short"));
            }
            read += records;
        }
        if levels.is_empty() {
            return Ok(values.into_iter().map(Some).collect());
        }
        let mut values = values.into_iter();
        let cell = |level: i16| if level == 0 { None } else { values.next() };
        Ok(levels.into_iter().map(cell).collect())
    }
}

/// A number without the sign of zero, which is meaningless in a result.
pub(super) fn unsigned(value: f64) -> f64 {
    value + 0.0
}

/// Writes the next column; `levels` are 0 for null and 1 for a value.
fn write_column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, BufWriter<File>>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let mut column = group
        .next_column()?
        .ok_or_else(|| ParquetError::General("the schema has fewer columns".to_owned()))?;
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}

fn of_indices(indices: &[i64]) -> String {
    checksum(indices.iter().map(|index| index.to_le_bytes()))
}

fn of_numbers(cells: &[Option<f64>]) -> String {
    let numbers = cells.iter().map(|cell| cell.unwrap_or(f64::NAN));
    checksum(numbers.map(|number| number.to_bits().to_le_bytes()))
}

fn of_messages<'a>(messages: impl Iterator<Item = Option<&'a str>>) -> String {
    checksum(messages.map(|message| {
        let length = message.map_or(u64::MAX, |m| m.len() as u64);
        [
            &length.to_le_bytes()[..],
            message.unwrap_or_default().as_bytes(),
        ]
        .concat()
    }))
}

/// The first 8 bytes of the hash of a column.
fn checksum(cells: impl Iterator<Item = impl AsRef<[u8]>>) -> String {
    let mut digest = Sha256::new();
    cells.for_each(|cell| digest.update(cell));
    let hash = digest.finalize();
    let bytes = hash.iter().take(8);
    bytes.map(|byte| format!("{byte:02x}")).collect()
}

/// Why a file cannot be read.
pub(super) enum PartFault {
    OtherStudy,
    Damaged(&'static str),
    Unreadable(String),
}

impl PartFault {
    /// The error of a file.
    pub(super) fn with_path(self, path: &Path) -> SweepError {
        let remedy = "remove it, and its points are computed again";
        let fault = match self {
            Self::OtherStudy => StoreFault::Differs("the part is of another study".to_owned()),
            Self::Damaged(what) => {
                StoreFault::Reason(format!("the file is damaged ({what}): {remedy}"))
            }
            Self::Unreadable(why) => {
                StoreFault::Reason(format!("the file cannot be read ({why}): {remedy}"))
            }
        };
        fault.with_path(path)
    }
}

impl From<ParquetError> for PartFault {
    fn from(error: ParquetError) -> Self {
        Self::Unreadable(error.to_string())
    }
}

impl From<std::io::Error> for PartFault {
    fn from(error: std::io::Error) -> Self {
        Self::Unreadable(error.to_string())
    }
}
