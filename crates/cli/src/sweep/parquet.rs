//! Tables and results as Parquet.

use super::table::{Part, unreadable};
use hamel_console::files::Draft;
use hamel_console::output::Failure;
use hamel_sweep::Cells;
use parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as Done};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnDescriptor, Type};
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// Name of the schema of results.
const RESULTS: &str = "sweep";

/// A table being read, by groups of rows.
pub struct Table {
    reader: SerializedFileReader<File>,
    names: Vec<String>,
    /// Whether the numbers of a column are unsigned.
    unsigned: Vec<bool>,
    /// The next group.
    group: usize,
    columns: Vec<ColumnReader>,
    /// Rows of the group that are left.
    left: usize,
}

impl Table {
    /// Opens a table.
    ///
    /// # Errors
    /// A file that cannot be read; columns that hold no numbers, all of them.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let file = File::open(path).map_err(|error| unreadable(path, &error))?;
        let reader = SerializedFileReader::new(file).map_err(|error| unreadable(path, &error))?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let refused: Vec<String> = schema
            .columns()
            .iter()
            .filter_map(|own| refusal(own))
            .collect();
        if !refused.is_empty() {
            return Err(Failure::Options(refused.join("\nerror: ")));
        }
        let names = schema.columns().iter().map(|own| own.name().to_owned());
        let unsigned = schema.columns().iter().map(|own| is_unsigned(own));
        Ok(Self {
            names: names.collect(),
            unsigned: unsigned.collect(),
            reader,
            group: 0,
            columns: Vec::new(),
            left: 0,
        })
    }

    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// How many rows there are.
    pub fn count(&self) -> u64 {
        let count = self.reader.metadata().file_metadata().num_rows();
        u64::try_from(count).unwrap_or(0)
    }

    /// The next rows, as many as there are.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn rows(&mut self, count: usize, path: &Path) -> Result<Vec<Cells>, Failure> {
        let mut rows = Vec::new();
        while rows.len() < count {
            let read = self.some(count - rows.len());
            let more = read.map_err(|error| unreadable(path, &error))?;
            if more.is_empty() {
                break;
            }
            rows.extend(more);
        }
        Ok(rows)
    }

    /// Rows of one group; none at the end of the last.
    fn some(&mut self, count: usize) -> Done<Vec<Cells>> {
        while self.left == 0 {
            if self.group == self.reader.num_row_groups() {
                return Ok(Vec::new());
            }
            let group = self.reader.get_row_group(self.group)?;
            self.group += 1;
            self.left = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            let columns = (0..self.names.len()).map(|column| group.get_column_reader(column));
            self.columns = columns.collect::<Done<_>>()?;
        }
        let count = count.min(self.left);
        self.left -= count;
        let mut rows = vec![Cells::default(); count];
        let named = self.names.iter().zip(&self.unsigned);
        for (column, (name, unsigned)) in self.columns.iter_mut().zip(named) {
            for (row, number) in rows.iter_mut().zip(numbers(column, *unsigned, count)?) {
                match number {
                    Some(number) => row.numbers.push(number),
                    None => {
                        let why = || format!("column `{name}`: the cell is empty");
                        row.fault.get_or_insert_with(why);
                    }
                }
            }
        }
        Ok(rows)
    }
}

/// Why a column is none of numbers.
fn refusal(column: &ColumnDescriptor) -> Option<String> {
    let kind = column.physical_type();
    let is_number = matches!(
        kind,
        Physical::DOUBLE | Physical::FLOAT | Physical::INT32 | Physical::INT64
    );
    let meaning = other_meaning(column);
    let is_flat = column.path().parts().len() == 1 && column.max_rep_level() == 0;
    let name = hamel_scene::text::visible_line(&column.path().string());
    match (is_flat, is_number, meaning) {
        (true, true, None) => None,
        (false, ..) => Some(format!(
            "column `{name}` is a list or a record, and must hold numbers"
        )),
        (true, true, Some(meaning)) => Some(format!(
            "column `{name}` holds {meaning}, stored as {kind}, and must hold numbers: make them floating-point numbers in its unit"
        )),
        (true, false, _) => Some(format!(
            "column `{name}` holds {kind}, and must hold numbers"
        )),
    }
}

/// Whether whole numbers of a column are unsigned; they are stored as signed ones.
fn is_unsigned(column: &ColumnDescriptor) -> bool {
    use ConvertedType as Converted;
    matches!(
        column.converted_type(),
        Converted::UINT_8 | Converted::UINT_16 | Converted::UINT_32 | Converted::UINT_64
    )
}

/// What the stored numbers of a column stand for, if for no numbers: a decimal is stored without its point, a date as days.
fn other_meaning(column: &ColumnDescriptor) -> Option<&'static str> {
    use ConvertedType as Converted;
    match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Decimal { .. }), _) | (_, Converted::DECIMAL) => Some("decimals"),
        (Some(LogicalType::Date), _) | (_, Converted::DATE) => Some("dates"),
        (Some(LogicalType::Time { .. } | LogicalType::Timestamp { .. }), _)
        | (
            _,
            Converted::TIME_MILLIS
            | Converted::TIME_MICROS
            | Converted::TIMESTAMP_MILLIS
            | Converted::TIMESTAMP_MICROS,
        ) => Some("times"),
        (Some(LogicalType::Integer(_)) | None, _) => None,
        (Some(_), _) => Some("what is no number"),
    }
}

/// The next numbers of a column.
fn numbers(column: &mut ColumnReader, unsigned: bool, count: usize) -> Done<Vec<Option<f64>>> {
    match column {
        ColumnReader::Int32ColumnReader(own) if unsigned => {
            values(own, count, |value| f64::from(value.cast_unsigned()))
        }
        ColumnReader::Int64ColumnReader(own) if unsigned => {
            values(own, count, |value| value.cast_unsigned() as f64)
        }
        ColumnReader::DoubleColumnReader(own) => values(own, count, |value| *value),
        ColumnReader::FloatColumnReader(own) => values(own, count, |value| f64::from(*value)),
        ColumnReader::Int32ColumnReader(own) => values(own, count, |value| f64::from(*value)),
        ColumnReader::Int64ColumnReader(own) => values(own, count, |value| *value as f64),
        _ => Err(ParquetError::General("a column of numbers has none".into())),
    }
}

fn values<T: DataType, V>(
    column: &mut ColumnReaderImpl<T>,
    count: usize,
    read: impl Fn(&T::T) -> V,
) -> Done<Vec<Option<V>>> {
    let (mut found, mut levels) = (Vec::new(), Vec::new());
    let mut records = 0;
    while records < count {
        let (more, ..) =
            column.read_records(count - records, Some(&mut levels), None, &mut found)?;
        if more == 0 {
            let why = "a column is shorter than its group of rows";
            return Err(ParquetError::General(why.into()));
        }
        records += more;
    }
    let mut found = found.iter();
    if levels.is_empty() {
        return Ok(found.map(|value| Some(read(value))).collect());
    }
    // Values that are not there have no place among those found.
    let all = levels.iter().map(|level| match *level > 0 {
        true => found.next().map(&read),
        false => None,
    });
    Ok(all.collect())
}

/// Writes a part of the results.
///
/// # Errors
/// A file that cannot be written.
pub fn write_part(draft: Draft, names: &[String], part: &Part<'_>) -> io::Result<Draft> {
    part_of(draft, names, part).map_err(io::Error::other)
}

fn part_of(draft: Draft, names: &[String], part: &Part<'_>) -> Done<Draft> {
    let mut fields = vec![field("row", Physical::INT64)?, text("outcome")?];
    for name in names {
        fields.push(field(name, Physical::DOUBLE)?);
    }
    let mut writer = writer(draft, fields)?;
    let mut group = writer.next_row_group()?;
    let rows: Vec<i64> = (1..)
        .map(|n: i64| n + part.first.cast_signed())
        .take(part.rows.len())
        .collect();
    put::<Int64Type>(&mut group, &rows)?;
    let outcomes = part
        .rows
        .iter()
        .map(|row| ByteArray::from(&*row.outcome.to_string()));
    put::<ByteArrayType>(&mut group, &outcomes.collect::<Vec<_>>())?;
    for column in 0..names.len() {
        let numbers: Vec<f64> = part.rows.iter().map(|row| row.numbers[column]).collect();
        put::<DoubleType>(&mut group, &numbers)?;
    }
    group.close()?;
    writer.into_inner()
}

/// Shows rows of a part: number, outcome and results.
///
/// # Errors
/// A file that cannot be read, or is no part of results with so many columns.
pub fn read_part(
    path: &Path,
    columns: usize,
    see: &mut dyn FnMut(u64, &str, &[f64]),
) -> Result<(), Failure> {
    let file = File::open(path).map_err(|error| unreadable(path, &error))?;
    let shown = show(file, columns, see);
    shown.map_err(|error| unreadable(path, &error))
}

fn show(file: File, columns: usize, see: &mut dyn FnMut(u64, &str, &[f64])) -> Done<()> {
    let reader = SerializedFileReader::new(file)?;
    let foreign = || ParquetError::General("it is no part of these results".into());
    let told = reader.metadata().file_metadata();
    if told.schema().name() != RESULTS || told.schema_descr().num_columns() != columns + 2 {
        return Err(foreign());
    }
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group)?;
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let (
            ColumnReader::Int64ColumnReader(mut rows),
            ColumnReader::ByteArrayColumnReader(mut texts),
        ) = (group.get_column_reader(0)?, group.get_column_reader(1)?)
        else {
            return Err(foreign());
        };
        let rows = values(&mut rows, count, |row| row.cast_unsigned())?;
        let texts = values(&mut texts, count, |text| {
            String::from_utf8_lossy(text.data()).into_owned()
        })?;
        let mut all = Vec::with_capacity(columns);
        for column in 0..columns {
            all.push(numbers(
                &mut group.get_column_reader(column + 2)?,
                false,
                count,
            )?);
        }
        for (place, (row, outcome)) in rows.into_iter().zip(texts).enumerate() {
            let numbers = all.iter().map(|column| column[place].unwrap_or(f64::NAN));
            let numbers: Vec<f64> = numbers.collect();
            see(row.unwrap_or(0), &outcome.unwrap_or_default(), &numbers);
        }
    }
    Ok(())
}

/// Writes a small table: a column of texts, and columns of numbers.
///
/// # Errors
/// A file that cannot be written.
pub fn write_small(
    draft: Draft,
    (name, texts): (&str, &[String]),
    numbers: &[(&str, Vec<f64>)],
) -> io::Result<Draft> {
    let write = || -> Done<Draft> {
        let mut fields = vec![text(name)?];
        for (name, _) in numbers {
            fields.push(field(name, Physical::DOUBLE)?);
        }
        let mut writer = writer(draft, fields)?;
        let mut group = writer.next_row_group()?;
        let texts: Vec<_> = texts.iter().map(|text| ByteArray::from(&**text)).collect();
        put::<ByteArrayType>(&mut group, &texts)?;
        for (_, numbers) in numbers {
            put::<DoubleType>(&mut group, numbers)?;
        }
        group.close()?;
        writer.into_inner()
    };
    write().map_err(io::Error::other)
}

fn writer(draft: Draft, fields: Vec<Arc<Type>>) -> Done<SerializedFileWriter<Draft>> {
    let schema = Type::group_type_builder(RESULTS)
        .with_fields(fields)
        .build()?;
    // Results hardly repeat, except for outcomes.
    let properties = WriterProperties::builder()
        .set_dictionary_enabled(false)
        .set_column_dictionary_enabled("outcome".into(), true)
        .build();
    SerializedFileWriter::new(draft, Arc::new(schema), Arc::new(properties))
}

fn put<T: DataType>(group: &mut SerializedRowGroupWriter<'_, Draft>, values: &[T::T]) -> Done<()> {
    let Some(mut column) = group.next_column()? else {
        return Ok(());
    };
    column.typed::<T>().write_batch(values, None, None)?;
    column.close()
}

fn field(name: &str, kind: Physical) -> Done<Arc<Type>> {
    let field = Type::primitive_type_builder(name, kind);
    Ok(Arc::new(
        field.with_repetition(Repetition::REQUIRED).build()?,
    ))
}

fn text(name: &str) -> Done<Arc<Type>> {
    let field = Type::primitive_type_builder(name, Physical::BYTE_ARRAY);
    let field = field.with_converted_type(ConvertedType::UTF8);
    Ok(Arc::new(
        field.with_repetition(Repetition::REQUIRED).build()?,
    ))
}

/// Whether a file is one of those that a sweep writes.
pub fn is_own(file: &File) -> bool {
    let reader = file.try_clone().ok().map(SerializedFileReader::new);
    let reader = reader.and_then(Result::ok);
    reader.is_some_and(|reader| reader.metadata().file_metadata().schema().name() == RESULTS)
}

/// Nothing stands against Parquet in this program.
///
/// # Errors
/// None.
#[expect(
    clippy::unnecessary_wraps,
    reason = "a program without Parquet refuses"
)]
pub fn check() -> Result<(), Failure> {
    Ok(())
}
