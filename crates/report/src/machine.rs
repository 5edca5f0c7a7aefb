//! What ran, and on what.

use serde::Serialize;
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

const GIBIBYTE: f64 = (1_u64 << 30) as f64;

/// The machine, the compiler and its flags, and the version of this program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Name of the processor, how many of it the system shows, and its memory.
    pub processor: String,
    /// Operating system, its kernel, and what the program was built for.
    pub system: String,
    /// The compiler that built the program.
    pub compiler: String,
    /// Optimisation level, target features and flags of the compiler.
    pub flags: String,
    /// Version of this program, and the commit that it was built from.
    pub version: String,
}

impl Machine {
    /// This one.
    pub fn this() -> Self {
        let kind = RefreshKind::nothing()
            .with_cpu(CpuRefreshKind::nothing())
            .with_memory(MemoryRefreshKind::nothing().with_ram());
        let system = System::new_with_specifics(kind);
        // A system that cannot be asked tells nothing.
        let system = system.ok();
        let processors = system.as_ref().map_or(&[][..], System::cpus);
        let name = processors.first().map_or("", |cpu| cpu.brand().trim());
        let memory = system.as_ref().map_or(0, System::total_memory) as f64 / GIBIBYTE;
        let parts = Self {
            processor: format!(
                "{}, {} visible, {memory:.0} GiB",
                known(name),
                processors.len()
            ),
            system: format!(
                "{}, kernel {}, {}",
                known(&System::long_os_version().unwrap_or_default()),
                known(&System::kernel_version().unwrap_or_default()),
                env!("HAMEL_TARGET")
            ),
            compiler: env!("HAMEL_COMPILER").into(),
            flags: format!(
                "opt-level {}, target features {}, flags {}",
                env!("HAMEL_OPTIMISATION"),
                env!("HAMEL_FEATURES"),
                match env!("HAMEL_FLAGS") {
                    "" => "none",
                    flags => flags,
                }
            ),
            version: format!(
                "{}, commit {}",
                env!("CARGO_PKG_VERSION"),
                known(env!("HAMEL_COMMIT"))
            ),
        };
        parts.separable()
    }

    /// Without the mark that stands between parts, which systems and flags may have in their names.
    fn separable(self) -> Self {
        let plain = |part: String| part.replace("; ", ", ");
        Self {
            processor: plain(self.processor),
            system: plain(self.system),
            compiler: plain(self.compiler),
            flags: plain(self.flags),
            version: plain(self.version),
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

/// A name, or that there is none.
fn known(name: &str) -> &str {
    if name.is_empty() { "unknown" } else { name }
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

    /// What tells machines and builds apart; of none of it is the place empty.
    #[test]
    fn lines_tell_of_all_that_differs() {
        let line = Machine::this().line();
        for part in [
            " visible, ",
            " GiB; ",
            ", kernel ",
            "; rustc ",
            "; opt-level ",
            ", flags ",
            ", commit ",
        ] {
            let rest = line.split_once(part).map(|(_, rest)| rest);
            assert!(
                rest.is_some_and(|rest| !rest.starts_with([',', ';', ' '])),
                "{part}: {line}"
            );
        }
    }
}
