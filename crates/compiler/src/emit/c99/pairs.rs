//! Loops over pairs of joints in C: tables of numbers, and a call of a helper of the module.

use crate::pairs::{Product, Tables};
use hamel_compiled::Places;
use serde::Serialize;

/// As the templates see them. Numbers that are not there are −1.
#[derive(Serialize)]
pub struct Written {
    /// The helper that is called.
    helper: &'static str,
    /// Numbers of the bodies.
    work: usize,
    /// Whether there are none: an array without entries is no C, and one that nothing assigns is refused by compilers.
    is_empty: bool,
    /// Speeds, and columns of the results.
    size: usize,
    width: usize,
    /// Room that it needs for M̄ and more, and whether its helper is told the columns.
    room: usize,
    is_wide: bool,
    mirrored: String,
    /// Where numbers stand.
    places: Vec<usize>,
    tables: Vec<Table>,
}

/// A table, not empty.
#[derive(Serialize)]
struct Table {
    name: &'static str,
    count: usize,
    width: usize,
    rows: Vec<String>,
}

impl Written {
    /// Of a function whose lines assign so many numbers.
    pub fn new(tables: &Tables, work: usize) -> Self {
        let joints = tables.joints.iter().map(|joint| {
            let [a, b] = joint.speeds;
            let [c, d] = joint.freedoms;
            let parent = optional(joint.parent);
            vec![number(a), number(b), number(c), number(d), parent]
        });
        let bodies = tables.bodies.iter();
        let bodies = bodies.map(|body| {
            vec![
                number(body.joint),
                optional(body.parent),
                number(body.layer),
            ]
        });
        let above = tables.above.iter().map(|&above| vec![optional(above)]);
        let plain = |rows: &[[usize; 3]]| rows.iter().map(|row| row.map(number).to_vec()).collect();
        let held = tables.held.iter().map(|row| row.map(number).to_vec());
        let columns = tables.columns.iter().map(|row| row.map(number).to_vec());
        let all: [(&'static str, usize, Vec<Vec<i64>>); 9] = [
            ("joints", 5, joints.collect()),
            ("bodies", 3, bodies.collect()),
            ("above", 1, above.collect()),
            ("entries", 3, plain(&tables.entries)),
            ("masses", 3, plain(&tables.masses)),
            ("bends", 3, plain(&tables.bends)),
            ("held", 2, held.collect()),
            ("columns", 2, columns.collect()),
            ("followed", 3, plain(&tables.followed)),
        ];
        Self {
            helper: tables.product.name(),
            work: work.max(1),
            is_empty: work == 0,
            size: tables.above.len(),
            width: tables.size[1],
            places: places(&tables.places),
            room: room(tables),
            is_wide: !matches!(tables.product, Product::Mass | Product::InverseMass),
            mirrored: optional(tables.mirrored).to_string(),
            tables: all.into_iter().map(Table::new).collect(),
        }
    }
}

/// Numbers that loops need room for: M̄, and what is solved where this is no part of the results.
fn room(tables: &Tables) -> usize {
    let size = tables.above.len();
    let solution = |columns| match tables.product {
        Product::SecondForward => size * (size + columns),
        _ => size * size,
    };
    tables.solved_columns().map_or(0, solution) + tables.room_besides()
}

impl Table {
    fn new((name, width, rows): (&'static str, usize, Vec<Vec<i64>>)) -> Self {
        let text = |row: &Vec<i64>| {
            let numbers: Vec<String> = row.iter().map(i64::to_string).collect();
            numbers.join(", ")
        };
        let count = rows.len();
        let mut rows: Vec<String> = rows.iter().map(text).collect();
        if rows.is_empty() {
            // An array without entries is no C.
            rows.push("0".to_owned());
        }
        Self {
            name,
            count,
            width,
            rows,
        }
    }
}

/// As the structure of the template has them.
fn places(places: &Places) -> Vec<usize> {
    vec![
        places.sizes[0],
        places.column_stride(),
        places.variation_stride(),
        places.width(),
        places.columns,
        places.variations,
        places.raised,
        places.momenta,
        places.momentum,
        places.drifts,
        places.by_rate,
        places.by_drift,
    ]
}

fn number(number: usize) -> i64 {
    // Places in memory fit.
    number as i64
}

fn optional(place: Option<usize>) -> i64 {
    place.map_or(-1, number)
}
