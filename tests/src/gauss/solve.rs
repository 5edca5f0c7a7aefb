//! Linear systems in extended precision, some rows of which may follow from others.

use hamel_codegen::precise::Precise;

/// Rows, each with its right side last.
pub(super) type Rows = Vec<Vec<Precise>>;

/// A pivot below this part of the first one belongs to a row that follows from others.
const SMALLEST_PIVOT: f64 = 1e-30;

/// A solution of consistent equations, by elimination with complete pivoting; what they leave open is 0.
pub(super) fn solve(mut rows: Rows) -> Vec<Precise> {
    let unknowns = rows.first().map_or(0, |row| row.len() - 1);
    let mut used: Vec<(usize, usize)> = vec![];
    let mut largest = 0.0;
    while let Some((row, column, size)) = pivot(&rows, &used, unknowns) {
        largest = f64::max(largest, size);
        if size <= SMALLEST_PIVOT * largest {
            break;
        }
        let of_pivot = rows[row].clone();
        for (other, entries) in rows.iter_mut().enumerate() {
            if other == row || entries[column].is_zero() {
                continue;
            }
            let part = &entries[column] / &of_pivot[column];
            for (entry, own) in entries.iter_mut().zip(&of_pivot) {
                *entry = &*entry - &(&part * own);
            }
        }
        used.push((row, column));
    }
    let zero = rows.first().map(|row| row[unknowns].same(0));
    let mut solution = vec![zero.expect("there are equations"); unknowns];
    for (row, column) in used {
        solution[column] = &rows[row][unknowns] / &rows[row][column];
    }
    solution
}

/// The largest entry of rows and columns that are not used, and its size.
fn pivot(rows: &Rows, used: &[(usize, usize)], unknowns: usize) -> Option<(usize, usize, f64)> {
    let free_rows = (0..rows.len()).filter(|row| used.iter().all(|(own, _)| own != row));
    let places = free_rows.flat_map(|row| (0..unknowns).map(move |column| (row, column)));
    let free = places.filter(|(_, column)| used.iter().all(|(_, own)| own != column));
    let sized = free.map(|(row, column)| (row, column, rows[row][column].to_f64().abs()));
    sized.max_by(|a, b| a.2.total_cmp(&b.2))
}
