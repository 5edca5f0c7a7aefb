//! The summary for people: final state, energy, and what the simulation took.

use super::accuracy::Accuracy;
use super::columns::BODY;
use super::control::Outcome;
use super::json::Statistics;
use super::plan::Plan;
use comfy_table::{Cell, CellAlignment, Table, presets};
use hamel::integrate::{Approach, Crossing, MethodChange, RoundingLimit};
use hamel::mechanism::{BodyState, Kinematics, Mechanism};
use hamel_console::files::Output;
use hamel_scene::Arithmetic;
use std::fmt;

/// Numbers from here on are written with an exponent.
const LARGEST_DECIMAL: f64 = 1e6;

/// As many events are reported.
const MOST_EVENTS: usize = 12;

/// What a simulation came to.
#[derive(Debug)]
pub struct Summary<'a> {
    /// What was asked.
    pub plan: &'a Plan,
    /// How the equations were compiled, where they were.
    pub equations: Option<&'a str>,
    /// Energy at time 0, J.
    pub start_energy: f64,
    /// The bodies at the end.
    pub end: &'a Kinematics,
    /// When that is, s.
    pub time: f64,
    /// Kinetic energy at time 0, J.
    pub most_kinetic_energy: f64,
    /// Samples of the trajectory.
    pub samples: usize,
    /// What the controller did, where there is one.
    pub outcome: Option<&'a Outcome>,
    /// Its error, where that was estimated.
    pub accuracy: Option<&'a Accuracy>,
    /// What the simulation took.
    pub statistics: Statistics,
    /// What the steps passed over.
    pub unresolved: Option<&'a str>,
    /// What the scene's events came to.
    pub events: &'a [Crossing],
    /// The methods that took over on the way.
    pub method_changes: &'a [MethodChange],
    /// Where rounding decided how long steps are.
    pub rounding: Option<&'a RoundingLimit>,
    /// How near joints came to singular sets.
    pub approaches: &'a [Approach],
    /// What was found out about the forces within joints.
    pub forces: &'a [String],
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.scene(f)?;
        let table = bodies(&self.plan.scene.mechanism, self.end);
        writeln!(f, "{}", table.trim_fmt())?;
        self.energy(f)?;
        if let Some(accuracy) = self.accuracy {
            write!(f, "{accuracy}")?;
        }
        if let Some(request) = &self.plan.request {
            writeln!(f, "            {request}")?;
        }
        self.crossings(f)?;
        if let Some(outcome) = self.outcome {
            write!(f, "{outcome}")?;
        }
        let Statistics {
            steps,
            rejected,
            evaluations,
            run_time_s,
        } = self.statistics;
        writeln!(
            f,
            "work        {}, {rejected} rejected, {}, {run_time_s:.3} s",
            counted(steps, "step", "steps"),
            counted(evaluations, "evaluation", "evaluations"),
        )?;
        if let Some(unresolved) = self.unresolved {
            writeln!(f, "unresolved  {unresolved}")?;
        }
        if let Some(RoundingLimit {
            steps,
            joint,
            error,
        }) = self.rounding
        {
            // Refined arithmetic rounds coordinates as doubles do.
            let advice = match self.plan.settings.arithmetic {
                Arithmetic::Doubles => " in doubles; see `--arithmetic auto`",
                _ => "",
            };
            writeln!(
                f,
                "rounding    decided the length of {}, not the tolerance: at joint `{joint}` the error of a step is not below {error:.1e}{advice}",
                counted(*steps, "step", "steps"),
            )?;
        }
        for note in self.forces {
            writeln!(f, "forces      {note}")?;
        }
        for approach in self.approaches {
            writeln!(f, "singular    {approach}")?;
        }
        // Without a sample no file was written.
        if self.samples > 0 {
            self.files(f)?;
        }
        Ok(())
    }
}

impl Summary<'_> {
    fn files(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let samples = counted(self.samples, "sample", "samples");
        for path in self.plan.trajectories() {
            writeln!(f, "trajectory  {samples} in {}", path.display())?;
        }
        for path in self.plan.pictures.files().map(Output::path) {
            writeln!(f, "picture     {}", path.display())?;
        }
        Ok(())
    }

    fn scene(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Plan {
            scene, settings, ..
        } = self.plan;
        let layout = scene.mechanism.layout();
        match scene.description.as_str() {
            "" => writeln!(f, "{}", scene.name)?,
            description => writeln!(f, "{}: {description}", scene.name)?,
        }
        let bodies = counted(scene.mechanism.bodies().len(), "body", "bodies");
        let freedoms = counted(layout.freedoms, "degree of freedom", "degrees of freedom");
        let speeds = counted(layout.speeds, "speed", "speeds");
        let form = settings.form_name();
        let method = self.plan.method();
        writeln!(f, "{bodies}, {freedoms}, {speeds}; {form} form; {method}")?;
        if let Some(reason) = &self.plan.reason {
            writeln!(f, "method      {reason}")?;
        }
        for change in self.method_changes {
            let (time, name, reason) = (change.time, change.scheme.name(), &change.reason);
            writeln!(f, "            from {time:.6} s on {name}: {reason}")?;
        }
        if let Some(reason) = &self.plan.arithmetic_reason {
            writeln!(f, "arithmetic  {}: {reason}", settings.arithmetic.name())?;
        }
        if let Some(equations) = self.equations {
            writeln!(f, "equations   {equations}")?;
        }
        writeln!(f, "state at {} s:", self.time)
    }

    /// The first events, and how many follow.
    fn crossings(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for crossing in self.events.iter().take(MOST_EVENTS) {
            let direction = match (crossing.joint, crossing.rising) {
                // The name of what a joint does tells it all.
                (Some(_), _) => "",
                (None, true) => ", rising",
                (None, false) => ", falling",
            };
            let (name, time) = (&crossing.name, crossing.state.time);
            writeln!(f, "event       {name} at {time:.9} s{direction}")?;
        }
        let more = self.events.get(MOST_EVENTS..).unwrap_or_default();
        if more.is_empty() {
            return Ok(());
        }
        writeln!(f, "            and {} more; --json lists all", more.len())?;
        for (name, count, last) in by_name(more).into_iter().take(MOST_EVENTS) {
            let times = counted(count, "time", "times");
            writeln!(f, "            {name} {times}, the last at {last:.9} s")?;
        }
        Ok(())
    }

    fn energy(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (start, end) = (self.start_energy, self.end.energy());
        let scale = start.abs().max(self.most_kinetic_energy);
        let change = end - start;
        // With nothing at work it is the integrator's alone.
        let word = if self.plan.does_work() {
            "change"
        } else {
            "drift"
        };
        write!(
            f,
            "energy      {} J at the start, {} J at the end: {word} {change:.2e} J",
            decimal(start),
            decimal(end)
        )?;
        match scale > 0.0 {
            true => writeln!(f, ", relative {:.2e}", change / scale),
            false => writeln!(f),
        }
    }
}

/// How often each name stands among these events, and when last.
fn by_name(events: &[Crossing]) -> Vec<(&str, usize, f64)> {
    let mut names: Vec<(&str, usize, f64)> = Vec::new();
    for event in events {
        let time = event.state.time;
        match names.iter_mut().find(|(name, ..)| *name == event.name) {
            Some((_, count, last)) => (*count, *last) = (*count + 1, time),
            None => names.push((&event.name, 1, time)),
        }
    }
    names
}

/// One line a body and axis, and one for the scalar of its quaternion.
fn bodies(mechanism: &Mechanism, end: &Kinematics) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY);
    // In the order of `BODY`.
    table.set_header([
        "body",
        "axis",
        "position\nof com, m",
        "attitude\n(quaternion,\nbody to world)",
        "velocity\nof com, m/s",
        "angular velocity\n(body axes), rad/s",
    ]);
    for (body, state) in mechanism.bodies().iter().zip(&end.bodies) {
        table.add_row(row(body.name(), state));
    }
    table
}

fn row(name: &str, state: &BodyState) -> Vec<Cell> {
    let names = [name.to_owned(), "x\ny\nz\nw".to_owned()];
    let names = names.into_iter().map(Cell::new);
    let numbers = BODY.iter().map(|part| {
        let mut numbers = Vec::new();
        (part.read)(state, &mut numbers);
        let lines: Vec<String> = numbers.into_iter().map(decimal).collect();
        Cell::new(lines.join("\n")).set_alignment(CellAlignment::Right)
    });
    names.chain(numbers).collect()
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Nine decimals, or an exponent where these would not fit; what rounds to zero has no sign.
fn decimal(number: f64) -> String {
    if number.abs() >= LARGEST_DECIMAL {
        return format!("{number:.9e}");
    }
    let text = format!("{number:.9}");
    match text.strip_prefix('-') {
        Some(rest) if !rest.contains(|digit: char| ('1'..='9').contains(&digit)) => rest.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::decimal;

    #[test]
    fn numbers_are_short_and_zero_has_no_sign() {
        assert_eq!(decimal(-1e-12), "0.000000000");
        assert_eq!(decimal(-0.0), "0.000000000");
        assert_eq!(decimal(-1.5), "-1.500000000");
        assert_eq!(decimal(-2.5e30), "-2.500000000e30");
    }
}
