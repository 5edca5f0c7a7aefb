//! Measured errors of emitted kernels, from a table that the sweeps of the test suite write.
//!
//! The columns are `joint,kernel,type,worst ulp,points`: the worst error met, in units in the last place of the scalar type, of
//! the largest summand in the expanded definition of an entry, and the number of points evaluated.

use std::fmt::{Display, Formatter};

const HEADER: &str = "joint,kernel,type,worst ulp,points";

/// One measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyRow {
    /// The joint.
    pub joint: String,
    /// Name of the method.
    pub kernel: String,
    /// The scalar type: `f64`.
    pub scalar: String,
    /// The worst error met, in units in the last place.
    pub worst_ulp: f64,
    /// Points evaluated.
    pub points: u64,
}

/// All measurements; none where none were given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accuracy {
    rows: Vec<AccuracyRow>,
}

/// A line of the table that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AccuracyError {
    line: usize,
    text: String,
    expected: &'static str,
}

impl Accuracy {
    /// Reads the table.
    ///
    /// # Errors
    /// A header other than the one above, or a line that is not a measurement.
    pub fn parse(text: &str) -> Result<Self, AccuracyError> {
        let mut lines = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty());
        let error = |(line, text): (usize, &str), expected| AccuracyError {
            line: line + 1,
            text: text.to_owned(),
            expected,
        };
        match lines.next() {
            None => return Ok(Self::default()),
            Some((_, header)) if header.trim() == HEADER => {}
            Some(first) => return Err(error(first, HEADER)),
        }
        let expected = "joint, kernel, type, a number of ulp and a number of points";
        let row = |line: (usize, &str)| row(line.1).ok_or_else(|| error(line, expected));
        Ok(Self {
            rows: lines.map(row).collect::<Result<_, _>>()?,
        })
    }

    /// The measurements of one joint, in the order of the table.
    pub fn of_joint(&self, joint: &str) -> Vec<AccuracyRow> {
        let rows = self.rows.iter();
        rows.filter(|row| row.joint == joint).cloned().collect()
    }
}

fn row(line: &str) -> Option<AccuracyRow> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let [joint, kernel, scalar, worst, points] = fields.as_slice() else {
        return None;
    };
    let worst_ulp: f64 = worst.parse().ok()?;
    (worst_ulp >= 0.0).then_some(AccuracyRow {
        joint: (*joint).to_owned(),
        kernel: (*kernel).to_owned(),
        scalar: (*scalar).to_owned(),
        worst_ulp,
        points: points.parse().ok()?,
    })
}

impl Display for AccuracyError {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "line {} is `{}`: expected {}",
            self.line, self.text, self.expected
        )
    }
}

impl std::error::Error for AccuracyError {}

#[cfg(test)]
mod tests {
    use super::{Accuracy, HEADER};

    #[test]
    fn measurements_are_read_by_joint() {
        let text = format!("{HEADER}\nball,retract,f64,3.25,100000\nfree,local,f32,0,10\n");
        let ball = Accuracy::parse(&text).expect("a table").of_joint("ball");
        assert_eq!(ball.len(), 1);
        assert_eq!((ball[0].worst_ulp, ball[0].points), (3.25, 100_000));
        assert!(
            Accuracy::parse("")
                .expect("no table")
                .of_joint("ball")
                .is_empty()
        );
    }

    #[test]
    fn a_wrong_line_is_named() {
        let text = format!("{HEADER}\nball,retract,f64,3.25,1\nball,retract,f64,-1,1\n");
        let error = Accuracy::parse(&text)
            .expect_err("errors are not negative")
            .to_string();
        assert!(
            error.starts_with("line 3 is `ball,retract,f64,-1,1`: expected "),
            "{error}"
        );
        let error = Accuracy::parse("joint,kernel\n")
            .expect_err("columns are missing")
            .to_string();
        assert!(error.starts_with("line 1 is `joint,kernel`"), "{error}");
    }
}
