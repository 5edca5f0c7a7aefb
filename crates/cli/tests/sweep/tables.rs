//! Tables and results as Parquet.

use super::{pendulums, place::Place, rows};
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RowAccessor;
use parquet::schema::parser::parse_message_type;
use std::fs::File;
use std::sync::Arc;

/// Writes a table with a mass, a speed that may be missing and a whole number, in groups of rows, compressed as data frames are.
fn write(place: &Place, name: &str, groups: &[&[(f64, Option<f32>, i32)]]) {
    let schema = "message table { required double body.arm.mass; optional float speed; required int32 t_end; }";
    let schema = schema
        .replace("speed", "body.arm.initial.speeds.1")
        .replace("t_end", "simulation.t_end");
    let schema = parse_message_type(&schema).expect("a schema");
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY);
    let file = File::create(place.path(name)).expect("a file");
    let mut writer =
        SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties.build()))
            .expect("a writer");
    for rows in groups {
        let mut group = writer.next_row_group().expect("a group");
        let masses: Vec<f64> = rows.iter().map(|row| row.0).collect();
        let mut column = group.next_column().expect("a column").expect("the first");
        column
            .typed::<DoubleType>()
            .write_batch(&masses, None, None)
            .expect("masses");
        column.close().expect("a column");
        let speeds: Vec<f32> = rows.iter().filter_map(|row| row.1).collect();
        let levels: Vec<i16> = rows.iter().map(|row| i16::from(row.1.is_some())).collect();
        let mut column = group.next_column().expect("a column").expect("the second");
        column
            .typed::<FloatType>()
            .write_batch(&speeds, Some(&levels), None)
            .expect("speeds");
        column.close().expect("a column");
        let ends: Vec<i32> = rows.iter().map(|row| row.2).collect();
        let mut column = group.next_column().expect("a column").expect("the third");
        column
            .typed::<Int32Type>()
            .write_batch(&ends, None, None)
            .expect("ends");
        column.close().expect("a column");
        group.close().expect("a group");
    }
    writer.close().expect("a file");
}

#[test]
fn parquet_gives_what_csv_gives() {
    let place = pendulums(0);
    let first = [(1.0, Some(0.5), 1), (1.5, None, 1), (2.0, Some(-0.25), 0)];
    let second = [(0.75, Some(2.0), 1)];
    write(&place, "table.parquet", &[&first, &[], &second]);
    place.write(
        "table.csv",
        "body.arm.mass,body.arm.initial.speeds.1,simulation.t_end\n1,0.5,1\n1.5,,1\n2,-0.25,0\n0.75,2,1\n",
    );
    place.done("sweep pendulum.toml --over table.csv -o text --quiet --block 4");
    place.done("sweep pendulum.toml --over table.parquet -o binary --quiet --block 4");
    place.done("sweep pendulum.toml --over table.parquet -o mixed --quiet --format csv --block 2");
    assert_eq!(rows(&place, "text"), rows(&place, "mixed"));
    let file = File::open(place.path("binary/part-000001.parquet")).expect("a part");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    let columns = reader
        .metadata()
        .file_metadata()
        .schema_descr()
        .num_columns();
    let told = reader.get_row_iter(None).expect("rows").map(|row| {
        let row = row.expect("a row");
        let fixed = [
            row.get_long(0).expect("a number").to_string(),
            row.get_string(1).expect("an outcome").clone(),
        ];
        let numbers =
            (2..columns).map(|column| format!("{:?}", row.get_double(column).expect("a number")));
        fixed
            .into_iter()
            .chain(numbers)
            .collect::<Vec<_>>()
            .join(",")
    });
    assert_eq!(told.collect::<Vec<_>>(), rows(&place, "text"));
    for name in ["summary", "failures"] {
        assert!(place.path(&format!("binary/{name}.parquet")).exists());
    }
    // Called again, it knows its own files.
    place.done("sweep pendulum.toml --over table.parquet -o binary --quiet");
}

#[test]
fn columns_without_numbers_are_refused() {
    let place = pendulums(0);
    let schema =
        "message table { required binary name; required group pose { required double x; } }";
    let schema = Arc::new(parse_message_type(schema).expect("a schema"));
    let file = File::create(place.path("table.parquet")).expect("a file");
    let mut writer = SerializedFileWriter::new(file, schema, Arc::default()).expect("a writer");
    let mut group = writer.next_row_group().expect("a group");
    let mut column = group.next_column().expect("a column").expect("the first");
    column
        .typed::<ByteArrayType>()
        .write_batch(&[ByteArray::from("a")], None, None)
        .expect("a text");
    column.close().expect("a column");
    let mut column = group.next_column().expect("a column").expect("the second");
    column
        .typed::<DoubleType>()
        .write_batch(&[1.0], None, None)
        .expect("a number");
    column.close().expect("a column");
    group.close().expect("a group");
    writer.close().expect("a file");
    let said = place.refused("sweep pendulum.toml --over table.parquet -o out", 2);
    assert_eq!(
        said,
        "error: column `name` holds BYTE_ARRAY, and must hold numbers\n\
         error: column `pose.x` is a list or a record, and must hold numbers\n"
    );
    place.write("table.parquet", "no table");
    let said = place.refused("sweep pendulum.toml --over table.parquet -o out", 1);
    assert!(
        said.starts_with("error: cannot read table.parquet: "),
        "{said}"
    );
}

/// Decimals are stored without their point, dates as days: such columns are refused. Unsigned numbers are stored as signed ones, and read as they are meant.
#[test]
fn stored_numbers_are_read_as_they_are_meant() {
    let place = pendulums(0);
    let write = |kind: &str, value: i32| {
        let schema = format!("message table {{ required int32 body.arm.mass ({kind}); }}");
        let schema = Arc::new(parse_message_type(&schema).expect("a schema"));
        let file = File::create(place.path("table.parquet")).expect("a file");
        let mut writer = SerializedFileWriter::new(file, schema, Arc::default()).expect("a writer");
        let mut group = writer.next_row_group().expect("a group");
        let mut column = group.next_column().expect("a column").expect("the first");
        column
            .typed::<Int32Type>()
            .write_batch(&[value], None, None)
            .expect("a number");
        column.close().expect("a column");
        group.close().expect("a group");
        writer.close().expect("a file");
    };
    for (kind, meaning) in [
        ("DECIMAL(9,2)", "decimals"),
        ("DATE", "dates"),
        ("TIME(MILLIS,true)", "times"),
    ] {
        write(kind, 100);
        let said = place.refused("sweep pendulum.toml --over table.parquet -o out", 2);
        assert_eq!(
            said,
            format!(
                "error: column `body.arm.mass` holds {meaning}, stored as INT32, and must hold numbers: make them floating-point numbers in its unit\n"
            )
        );
    }
    write("INTEGER(32,false)", -1);
    let scene = || {
        let output = place.run("sweep pendulum.toml --over table.parquet --scene-of 1");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    assert!(scene().contains("mass = 4294967295"), "{}", scene());
    write("INTEGER(16,true)", 2);
    assert!(scene().contains("mass = 2"), "{}", scene());
}
