//! Which entries of rows the products of two joints are, beside each other as far as their columns are: tables of [`hamel_compiled::Pairs`].

use crate::pairs::{Product, Tables};
use hamel_compiled::{Carrying, Meeting, Pairing};

/// The meetings of joints with those that carry them, where the numbers of both have their places.
pub(super) fn find(tables: &mut Tables) {
    let has_masses = !matches!(tables.product, Product::Inverse | Product::SecondInverse);
    let (mut slopes, mut moved) = (vec![], vec![]);
    for joint in &tables.joints {
        let mut carrier = joint.parent;
        while let Some(body) = carrier {
            let body = &tables.bodies[body];
            if tables.product.has_slopes() {
                slopes.extend(raised_by(tables, joint, body));
                slopes.extend(varied_with(tables, joint, body));
            }
            if has_masses {
                moved.extend(moved_with(tables, joint, body));
            }
            carrier = body.parent;
        }
    }
    tables.slopes = joined(slopes);
    tables.moved = joined(moved);
}

/// What the units of a joint raise, in the rows of a joint that carries it.
fn raised_by(tables: &Tables, joint: &Pairing, body: &Carrying) -> Vec<Meeting> {
    let places = &tables.places;
    let rows = range(tables.joints[body.joint].speeds);
    let meeting = |row: usize, columns: [usize; 2]| Meeting {
        row,
        columns,
        own: places.columns + body.layer * places.sizes[1] + row,
        others: places.raised + columns[0],
        is_momentum: false,
    };
    let rows = rows.flat_map(|row| columns(tables, joint).map(|columns| meeting(row, columns)));
    rows.collect()
}

/// What the units of a joint change in those that it carries, in the rows of one of these.
fn varied_with(tables: &Tables, joint: &Pairing, body: &Carrying) -> Vec<Meeting> {
    let places = &tables.places;
    let above = &tables.joints[body.joint];
    let meeting = |row: usize, columns: [usize; 2]| Meeting {
        row,
        columns,
        own: places.momenta + places.momentum * row,
        others: places.variations + body.layer * places.width() + columns[0],
        is_momentum: true,
    };
    let rows = range(joint.speeds);
    let rows = rows.flat_map(|row| columns(tables, above).map(|columns| meeting(row, columns)));
    rows.collect()
}

/// Entries of M̄ between a joint and one that carries it.
fn moved_with(tables: &Tables, joint: &Pairing, body: &Carrying) -> Vec<Meeting> {
    let places = &tables.places;
    let [first, count] = tables.joints[body.joint].speeds;
    let meeting = |row: usize| Meeting {
        row,
        columns: [first, first + count],
        own: places.momenta + places.momentum * row,
        others: places.columns + body.layer * places.sizes[1] + first,
        is_momentum: true,
    };
    range(joint.speeds).map(meeting).collect()
}

/// The columns of a joint: degrees of freedom, and speeds.
fn columns(tables: &Tables, joint: &Pairing) -> [[usize; 2]; 2] {
    let freedoms = tables.places.sizes[0];
    let ([a, b], [c, d]) = (joint.freedoms, joint.speeds);
    [[a, a + b], [freedoms + c, freedoms + c + d]]
}

fn range([first, count]: [usize; 2]) -> std::ops::Range<usize> {
    first..first + count
}

/// Row by row, in the order of their columns; those whose columns and numbers follow each other are one.
fn joined(mut all: Vec<Meeting>) -> Vec<Meeting> {
    all.retain(|meeting| meeting.columns[0] < meeting.columns[1]);
    all.sort_unstable_by_key(|meeting| (meeting.row, meeting.columns));
    let mut found: Vec<Meeting> = vec![];
    for next in all {
        match found.last_mut() {
            Some(last) if follows(last, &next) => last.columns[1] = next.columns[1],
            _ => found.push(next),
        }
    }
    found
}

fn follows(last: &Meeting, next: &Meeting) -> bool {
    let count = last.columns[1] - last.columns[0];
    (last.row, last.own, last.columns[1], last.others + count)
        == (next.row, next.own, next.columns[0], next.others)
}
