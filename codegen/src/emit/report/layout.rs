//! Matrices of texts, aligned, in tall brackets.

/// Number of columns that a text takes: combining marks take none.
pub fn width(text: &str) -> usize {
    text.chars()
        .filter(|c| !('\u{300}'..='\u{36f}').contains(c))
        .count()
}

/// `text` padded on the left to `size` columns.
pub fn right_aligned(text: &str, size: usize) -> String {
    format!("{}{text}", " ".repeat(size.saturating_sub(width(text))))
}

/// `text` padded on the right to `size` columns.
pub fn left_aligned(text: &str, size: usize) -> String {
    format!("{text}{}", " ".repeat(size.saturating_sub(width(text))))
}

/// The lines of a matrix whose entries are given row by row.
pub fn matrix(entries: &[String], columns: usize) -> Vec<String> {
    let columns = columns.max(1);
    let rows = entries.chunks(columns);
    let count = rows.len();
    let widest = |j: usize| {
        entries
            .iter()
            .skip(j)
            .step_by(columns)
            .map(|entry| width(entry))
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(widest).collect();
    let line = |(i, row): (usize, &[String])| {
        let cells: Vec<String> = row
            .iter()
            .zip(&widths)
            .map(|(entry, size)| right_aligned(entry, *size))
            .collect();
        let (open, close) = brackets(i, count);
        format!("{open}{}{close}", cells.join("  "))
    };
    rows.enumerate().map(line).collect()
}

fn brackets(row: usize, rows: usize) -> (char, char) {
    match (row, rows) {
        (_, 1) => ('[', ']'),
        (0, _) => ('⎡', '⎤'),
        (row, rows) if row + 1 == rows => ('⎣', '⎦'),
        _ => ('⎢', '⎥'),
    }
}

/// `name = ` before the middle line of a block.
pub fn equation(name: &str, lines: &[String]) -> String {
    let middle = lines.len().saturating_sub(1) / 2;
    let start = format!("{name} = ");
    let indent = " ".repeat(width(&start));
    let shown = lines.iter().enumerate().map(|(i, line)| {
        let before = if i == middle { &start } else { &indent };
        format!("{before}{line}")
    });
    shown.collect::<Vec<_>>().join("\n")
}
