//! What ran, and on what.

use serde::Serialize;

/// The machine, the compiler and its flags, and the version of this program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Name of the processor, and how many of it the system shows.
    pub processor: String,
    /// Operating system and architecture.
    pub system: String,
    /// The compiler that built the program.
    pub compiler: String,
    /// Optimisation level and target features.
    pub flags: String,
    /// Version of this program.
    pub version: String,
}

impl Machine {
    /// This one.
    pub fn this() -> Self {
        let count = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        Self {
            processor: format!("{}, {count} visible", processor()),
            system: env!("HAMEL_TARGET").into(),
            compiler: env!("HAMEL_COMPILER").into(),
            flags: format!(
                "opt-level {}, target features {}",
                env!("HAMEL_OPTIMISATION"),
                env!("HAMEL_FEATURES")
            ),
            version: env!("CARGO_PKG_VERSION").into(),
        }
    }

    /// The machine that a line of a file tells of; parts that it lacks are empty.
    pub fn of(line: &str) -> Self {
        let mut parts = line.splitn(5, "; ").map(str::to_owned);
        let mut next = || parts.next().unwrap_or_default();
        Self {
            processor: next(),
            system: next(),
            compiler: next(),
            flags: next(),
            version: next().trim_start_matches("hamel ").to_owned(),
        }
    }

    /// In one line, as files tell it.
    pub fn line(&self) -> String {
        let Self {
            processor,
            system,
            compiler,
            flags,
            version,
        } = self;
        format!("{processor}; {system}; {compiler}; {flags}; hamel {version}")
    }
}

/// The name of the processor, where the system has a file that tells it.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = text
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let name = line.and_then(|line| line.split_once(':'));
    name.map_or_else(
        || format!("unknown {}", std::env::consts::ARCH),
        |(_, name)| name.trim().to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::Machine;

    #[test]
    fn lines_are_read_as_written() {
        let this = Machine::this();
        assert_eq!(Machine::of(&this.line()), this);
        assert_eq!(Machine::of("elsewhere").processor, "elsewhere");
    }
}
