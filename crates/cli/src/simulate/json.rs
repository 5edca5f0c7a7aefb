//! The samples as JSON. Names and meaning of all keys are stable.

use super::accuracy::Accuracy;
use super::columns::{Column, JsonSample};
use super::control::Outcome;
use super::request::Request;
use hamel::integrate::{Crossing, RoundingLimit};
use hamel_console::output::Failure;
use hamel_console::terminal::fragment_of_json;
use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::Formatter;
use std::io::{self, Write};

/// What `--json` prints.
#[derive(Serialize)]
pub struct Report<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// Form of the equations of motion.
    pub form: &'a str,
    /// Name of the integration method.
    pub method: &'a str,
    /// Why the method was chosen; absent where it was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<&'a str>,
    /// What the equations of motion were solved in: `doubles` or `refined`.
    pub arithmetic: &'a str,
    /// Why, where that was left open; absent where it was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arithmetic_reason: Option<&'a str>,
    /// The methods that took over on the way, where the choice was left open; absent where none did.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub method_changes: &'a [MethodChange<'a>],
    /// What came of the accuracy that was asked for; absent where a tolerance or a step was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<&'a Request>,
    /// When the user ended the motion, s; absent where it was not interrupted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interrupted_at: Option<f64>,
    /// What the steps passed over; absent where they followed everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unresolved: Option<String>,
    /// What the numbers of a sample are.
    pub columns: &'a [Column],
    /// The states asked for.
    pub samples: &'a [JsonSample<'a>],
    /// What the scene's events came to, in the order of time; absent where there is none.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pub events: &'a [Event<'a>],
    /// What the controller did, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<&'a Outcome>,
    /// How far the states are from the exact motion, where that was estimated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<&'a Accuracy>,
    /// Where rounding decided how long steps are; absent where the tolerance did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounding: Option<Rounding<'a>>,
    /// What the simulation took.
    pub statistics: Statistics,
}

/// Steps whose length rounding decided, and not the tolerance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Rounding<'a> {
    /// How many.
    pub steps: usize,
    /// The joint with the largest estimated error.
    pub joint: &'a str,
    /// That error: smaller tolerances buy nothing.
    pub error: f64,
}

impl<'a> Rounding<'a> {
    /// What is reported of it.
    pub fn of(limit: &'a RoundingLimit) -> Self {
        Self {
            steps: limit.steps,
            joint: &limit.joint,
            error: limit.error,
        }
    }
}

/// A method that took over.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MethodChange<'a> {
    /// When, s.
    pub t: f64,
    /// Its name.
    pub method: &'static str,
    /// Why.
    pub reason: &'a str,
}

impl<'a> MethodChange<'a> {
    /// What is reported of it.
    pub fn of(change: &'a hamel::integrate::MethodChange) -> Self {
        Self {
            t: change.time,
            method: change.scheme.name(),
            reason: &change.reason,
        }
    }
}

/// One crossing of an event of the scene.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Event<'a> {
    /// Its name.
    pub name: &'a str,
    /// When, s.
    pub t: f64,
    /// Whether the quantity rises there.
    pub rising: bool,
}

impl<'a> Event<'a> {
    /// What is reported of a crossing.
    pub fn of(crossing: &'a Crossing) -> Self {
        Self {
            name: &crossing.name,
            t: crossing.state.time,
            rising: crossing.rising,
        }
    }
}

/// What the simulation took.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: usize,
    /// Rejected steps.
    pub rejected: usize,
    /// Evaluations of the equations of motion.
    pub evaluations: usize,
    /// Wall-clock time of the integration, s; writing the trajectory on the way is part of it.
    pub run_time_s: f64,
}

/// Prints the report on stdout, one line.
///
/// # Errors
/// A stdout that cannot be written.
pub fn print(report: &Report<'_>) -> Result<(), Failure> {
    let mut stdout = io::BufWriter::new(io::stdout().lock());
    write(report, &mut stdout).map_err(Failure::stdout)
}

fn write(report: &Report<'_>, out: &mut impl Write) -> io::Result<()> {
    report.serialize(&mut Serializer::with_formatter(&mut *out, Digits17))?;
    out.write_all(b"\n")?;
    out.flush()
}

/// Writes every float with 17 significant digits, which decide an f64, and texts so that all is seen.
struct Digits17;

impl Formatter for Digits17 {
    fn write_f64<W: ?Sized + Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        write!(writer, "{value:.16e}")
    }

    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        fragment_of_json(writer, fragment)
    }
}

#[cfg(test)]
mod tests {
    use super::{Digits17, Report, Statistics, write};
    use serde::Serialize;
    use serde_json::Serializer;

    #[test]
    fn numbers_have_17_digits_and_read_back() {
        let statistics = Statistics {
            steps: 3,
            rejected: 0,
            evaluations: 18,
            run_time_s: 0.1,
        };
        let report = Report {
            scene: "a \"scene\"",
            form: "lagrangian",
            method: "rk4",
            reason: None,
            arithmetic: "doubles",
            arithmetic_reason: None,
            accuracy: None,
            interrupted_at: None,
            method_changes: &[],
            unresolved: None,
            columns: &[],
            samples: &[],
            events: &[],
            control: None,
            error: None,
            rounding: None,
            statistics,
        };
        let mut bytes = Vec::new();
        write(&report, &mut bytes).expect("memory takes it");
        let text = String::from_utf8(bytes).expect("JSON is UTF-8");
        assert!(
            text.contains(r#""run_time_s":1.0000000000000001e-1"#),
            "{text}"
        );
        let value: serde_json::Value = serde_json::from_str(&text).expect("valid JSON");
        assert_eq!(value["scene"].as_str(), Some("a \"scene\""));
        assert_eq!(value["statistics"]["evaluations"].as_u64(), Some(18));
        let mut third = Vec::new();
        let written =
            (-1.0_f64 / 3.0).serialize(&mut Serializer::with_formatter(&mut third, Digits17));
        written.expect("memory takes it");
        assert_eq!(third, b"-3.3333333333333331e-1");
    }
}
