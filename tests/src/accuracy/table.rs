//! The table of worst errors, kept as a file that pages show.

use super::Worst;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Joint, kernel and type of numbers.
type Key = (String, String, String);
/// Worst error in ulp, and number of points.
type Entry = (f64, usize);

/// Rows by joint, kernel and type of numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: BTreeMap<Key, Entry>,
}

const HEADER: &str = "joint,kernel,type,worst ulp,points";

impl Table {
    /// The table in a file; empty where there is none.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        Self {
            rows: text.lines().skip(1).filter_map(row).collect(),
        }
    }

    /// Takes the errors of a joint in place of those it held, except for the `known` ones.
    pub fn insert(
        &mut self,
        joint: &str,
        number: &str,
        worst: &Worst,
        points: usize,
        known: &BTreeSet<String>,
    ) {
        self.rows
            .retain(|(j, kernel, n), _| j != joint || n != number || known.contains(kernel));
        for (kernel, (error, _)) in &worst.errors {
            let key = (joint.to_owned(), (*kernel).to_owned(), number.to_owned());
            self.rows.insert(key, (*error, points));
        }
    }

    /// The kernels of the joint whose errors at so many points are there.
    pub fn known(&self, joint: &str, number: &str, points: usize) -> BTreeSet<String> {
        let rows = self.rows.iter();
        let found = rows.filter(|((j, _, n), (_, count))| {
            (j.as_str(), n.as_str(), *count) == (joint, number, points)
        });
        found.map(|((_, kernel, _), _)| kernel.clone()).collect()
    }

    /// Writes the file.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, path: &Path) -> std::io::Result<()> {
        let mut text = format!("{HEADER}\n");
        for ((joint, kernel, number), (error, points)) in &self.rows {
            text += &format!("{joint},{kernel},{number},{error:.2},{points}\n");
        }
        std::fs::write(path, text)
    }
}

fn row(line: &str) -> Option<(Key, Entry)> {
    let fields: Vec<&str> = line.split(',').collect();
    let [joint, kernel, number, error, points] = fields.as_slice() else {
        return None;
    };
    let key = (
        (*joint).to_owned(),
        (*kernel).to_owned(),
        (*number).to_owned(),
    );
    Some((key, (error.parse().ok()?, points.parse().ok()?)))
}
