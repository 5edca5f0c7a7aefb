//! A motion simulated into all formats, and its files read back.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use parquet::column::reader::ColumnReader;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Positions of a page are f32: half a unit in the last place, relative to the largest coordinate.
pub const POSITION: f64 = 6e-8;
/// Attitudes of a page, rad: four entries of a quaternion of half the angle, each off by 3e-8 at most.
pub const ATTITUDE: f64 = 2e-7;

/// The files of one motion.
pub struct Files {
    pub csv: PathBuf,
    pub parquet: PathBuf,
    pub html: PathBuf,
}

/// Simulates a file of this repository into all formats, called after `name`.
pub fn simulate(file: &str, name: &str, options: &[&str]) -> Files {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = |ending: &str| {
        Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join(name)
            .with_extension(ending)
    };
    let files = Files {
        csv: path("csv"),
        parquet: path("parquet"),
        html: path("html"),
    };
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command
        .current_dir(root)
        .args(["simulate", file, "--quiet"]);
    command.arg("--csv").arg(&files.csv);
    command.arg("--parquet").arg(&files.parquet);
    command.arg("--html").arg(&files.html).args(options);
    let output = command.output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    files
}

/// Numbers by the names of their columns.
pub type Columns = BTreeMap<String, Vec<f64>>;

/// Attitude of a body or frame in a row.
pub fn attitude(columns: &Columns, of: &str, row: usize) -> UnitQuaternion<f64> {
    let [x, y, z, w] = ["qx", "qy", "qz", "qw"].map(|end| columns[&format!("{of}.{end}")][row]);
    let found = Quaternion::new(w, x, y, z);
    assert!(
        w >= 0.0 && (found.norm() - 1.0).abs() < 1e-15,
        "{of}: {found}"
    );
    UnitQuaternion::new_unchecked(found)
}

pub fn read_csv(path: &Path) -> Columns {
    let mut reader = csv::Reader::from_path(path).expect("a CSV");
    let names = reader.headers().expect("names").clone();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for record in reader.records() {
        for (column, field) in columns.iter_mut().zip(&record.expect("a row")) {
            column.push(field.parse().expect("a number"));
        }
    }
    names.iter().map(String::from).zip(columns).collect()
}

pub fn read_parquet(path: &Path) -> Columns {
    let reader = SerializedFileReader::new(File::open(path).expect("a file")).expect("a Parquet");
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns = Columns::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).expect("a group of rows");
        for (index, described) in schema.columns().iter().enumerate() {
            let ColumnReader::DoubleColumnReader(mut column) =
                group.get_column_reader(index).expect("a column")
            else {
                panic!("{} is no column of doubles", described.name());
            };
            let rows = group.metadata().num_rows() as usize;
            let values = columns.entry(described.name().to_owned()).or_default();
            column
                .read_records(rows, None, None, values)
                .expect("numbers");
        }
    }
    columns
}

/// A page taken apart.
pub struct Page {
    pub text: String,
    pub header: Value,
    bytes: Vec<u8>,
}

impl Page {
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).expect("a page");
        let element = |id: &str| {
            let (_, rest) = text.split_once(&format!("id=\"{id}\">")).expect(id);
            rest.split_once("</script>").expect("its end").0
        };
        let header = serde_json::from_str(element("header")).expect("JSON");
        let bytes = STANDARD.decode(element("numbers")).expect("base64");
        Self {
            header,
            bytes,
            text,
        }
    }

    pub fn frames(&self) -> usize {
        self.header["frames"].as_u64().expect("a number") as usize
    }

    pub fn names(&self) -> Vec<&str> {
        let bodies = self.header["bodies"].as_array().expect("bodies").iter();
        bodies.filter_map(|body| body["name"].as_str()).collect()
    }

    pub fn time(&self, frame: usize) -> f64 {
        let (numbers, _) = self.bytes.as_chunks();
        f64::from_le_bytes(numbers[frame])
    }

    fn float(&self, place: usize) -> f64 {
        let (numbers, _) = self.bytes[8 * self.frames()..].as_chunks();
        f32::from_le_bytes(numbers[place]).into()
    }

    /// The columns as the header numbers them: chart, variant, column, index.
    pub fn columns(&self) -> Vec<(&str, &str, &str, usize)> {
        let list = |value: &'static str, of: &'_ Value| of[value].as_array().expect(value).len();
        let mut columns = Vec::new();
        for chart in 0..list("charts", &self.header) {
            let chart = &self.header["charts"][chart];
            for variant in 0..list("variants", chart) {
                let variant = &chart["variants"][variant];
                for column in 0..list("columns", variant) {
                    let column = &variant["columns"][column];
                    let text = |value: &'_ Value| value.as_str().map_or(0, str::len);
                    assert!(text(&column["name"]) > 0);
                    columns.push((
                        chart["title"].as_str().expect("a title"),
                        variant["name"].as_str().expect("a name"),
                        column["name"].as_str().expect("a name"),
                        column["index"].as_u64().expect("a number") as usize,
                    ));
                }
            }
        }
        columns
    }

    pub fn column(&self, index: usize, frame: usize) -> f64 {
        self.float(index * self.frames() + frame)
    }

    /// Position of a body's centre of mass, and its attitude.
    pub fn pose(&self, frame: usize, body: usize) -> (Vector3<f64>, UnitQuaternion<f64>) {
        let first = self.columns().len() * self.frames();
        let at = first + 7 * (frame * self.names().len() + body);
        let [x, y, z, i, j, k, w] = std::array::from_fn(|place| self.float(at + place));
        let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let com = &self.header["bodies"][body]["com"];
        let com = [0, 1, 2].map(|axis| com[axis].as_f64().expect("a number"));
        (
            Vector3::new(x, y, z) + attitude * Vector3::from(com),
            attitude,
        )
    }
}
