//! Texts in cells of CSV files: what a spreadsheet would take for a formula begins with an apostrophe, which makes it text.

/// How formulas begin, in one spreadsheet or another.
const FORMULAS: [char; 10] = ['=', '+', '-', '@', '＝', '＋', '－', '＠', '\t', '\r'];

/// The text as a cell, which no spreadsheet runs. A text that begins so already gets one more apostrophe, so that [`rows`] gives it back.
pub fn cell(text: &str) -> String {
    match is_run(text.trim_start_matches('\'')) {
        true => format!("'{text}"),
        false => text.to_owned(),
    }
}

/// Whether a spreadsheet may take the text for a formula: some leave out blanks before it. A number is none.
fn is_run(text: &str) -> bool {
    let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
    !is_number && (text.starts_with(FORMULAS) || text.trim_start().starts_with(FORMULAS))
}

/// The text of a cell.
fn text(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(rest) if is_run(rest.trim_start_matches('\'')) => rest,
        _ => cell,
    }
}

/// Texts of rows, for `serde(with)`.
pub mod rows {
    use serde::{Deserialize, Deserializer, Serializer};

    /// Writes the text as a cell.
    pub fn serialize<S: Serializer>(text: &str, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&super::cell(text))
    }

    /// Reads the text of a cell.
    pub fn deserialize<'a, D: Deserializer<'a>>(deserializer: D) -> Result<String, D::Error> {
        Ok(super::text(&String::deserialize(deserializer)?).to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::{cell, text};

    #[test]
    fn no_cell_is_a_formula_and_every_text_comes_back() {
        for formula in [
            "=1+1", "+x", "-1+1", "-inf", "@f()", "\t=1", "\r=1", "'=1", "''=1", "＝1", "＋1",
            " =1",
        ] {
            let cell = cell(formula);
            assert!(cell.starts_with('\''), "{formula}");
            assert_eq!(text(&cell), formula);
        }
        for plain in ["arm.x_m", "'quoted'", "", "a=b", "-1", "-0.25e-3"] {
            assert_eq!((cell(plain).as_str(), text(plain)), (plain, plain));
        }
    }
}
