//! C compilers that do other than they should, and what the program does then. They are shell scripts.

use super::common::interruptible;
use super::has_compiler;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A folder with a compiler in it, and one for temporary files.
struct Bench {
    folder: TempDir,
}

impl Bench {
    /// The compiler does what the script says: `$@` are its arguments, `$BENCH` is the folder, `real` is a compiler as it should be.
    fn new(script: &str) -> Self {
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
        let bench = Self { folder };
        fs::create_dir(bench.path("tmp")).expect("a folder");
        let real = "real() { cc \"$@\" || gcc \"$@\" || clang \"$@\"; }\n";
        // Asked for its version it answers.
        let asked = "case \"$1\" in --version) exit 0;; esac\n";
        // After the last `-o`.
        let out = "out=; for word; do [ \"$last\" = -o ] && out=$word; last=$word; done\n";
        fs::write(bench.path("cc.sh"), format!("{real}{asked}{out}{script}\n")).expect("a file");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }

    /// A simulation with that compiler.
    fn command(&self) -> Command {
        let script = self.path("cc.sh");
        let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
        // Whatever the umask, the folder is private.
        let program = interruptible();
        let mut command = Command::new("sh");
        command.args(["-c", "umask 0; exec \"$@\"", "sh"]);
        command.arg(program.get_program()).args(program.get_args());
        command.args(["simulate", "scenes/heavy_top.toml", "--compiled"]);
        command
            .args(["--json", "--t-end", "0.01"])
            .current_dir(root);
        command.env("CC", format!("sh {}", script.display()));
        command.env("TMPDIR", self.path("tmp"));
        command.env("BENCH", self.folder.path());
        command.env_remove("HAMEL_CC_SECONDS");
        command
    }

    fn run(&self) -> Output {
        let output = self.command().output().expect("it starts");
        self.check_folder();
        output
    }

    /// What it says where it refuses.
    fn refused(&self) -> String {
        let output = self.run();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert_eq!(said.matches("error").count(), 1, "{said}");
        said
    }

    /// Nothing is left of the folder in which it was built.
    fn check_folder(&self) {
        let left = fs::read_dir(self.path("tmp")).expect("a folder").count();
        assert_eq!(left, 0, "the build folder is left");
    }

    /// Whether the process whose number is in a file has ended.
    fn is_gone(&self, file: &str) -> bool {
        let number: i32 = self.read(file).trim().parse().expect("a number");
        let start = Instant::now();
        // What was killed is gone when it has been waited for.
        while start.elapsed() < Duration::from_secs(10) {
            let state = fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
            if kill(Pid::from_raw(number), None).is_err() || state.contains(") Z ") {
                return true;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        false
    }
}

#[test]
fn the_build_folder_is_private_whatever_the_umask() {
    if !has_compiler() {
        return;
    }
    let bench = Bench::new("ls -ld \"$(dirname \"$out\")\" > \"$BENCH/mode\"; real \"$@\"");
    let output = bench.run();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let mode = bench.read("mode");
    assert!(mode.starts_with("drwx------"), "{mode}");
}

#[test]
fn a_compiler_that_does_not_end_is_ended_with_all_that_it_started() {
    let bench = Bench::new("sleep 1000 & echo $! > \"$BENCH/child\"; wait");
    let mut command = bench.command();
    let start = Instant::now();
    let output = command.env("HAMEL_CC_SECONDS", "0.5").output();
    let output = output.expect("it starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("it took more than 0.5 s"), "{said}");
    assert!(start.elapsed() < Duration::from_secs(60));
    assert!(bench.is_gone("child"));
    bench.check_folder();
}

#[test]
fn a_limit_that_is_none_is_refused() {
    let bench = Bench::new("exit 1");
    for limit in ["soon", "0", "-1", "nan", "1e300"] {
        let mut command = bench.command();
        let output = command.env("HAMEL_CC_SECONDS", limit).output();
        let output = output.expect("it starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("HAMEL_CC_SECONDS"), "{said}");
    }
}

#[test]
fn an_interrupt_ends_the_compiler_and_leaves_nothing() {
    let bench = Bench::new("sleep 1000 & echo $! > \"$BENCH/child\"; wait");
    let mut command = bench.command();
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().expect("it starts");
    let start = Instant::now();
    while bench.read("child").trim().is_empty() {
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "it does not begin"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
    let process = Pid::from_raw(i32::try_from(child.id()).expect("a number"));
    kill(process, Signal::SIGINT).expect("it runs");
    let output = child.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("the C compiler was ended"), "{said}");
    assert!(bench.is_gone("child"));
    bench.check_folder();
}

#[test]
fn what_the_compiler_says_is_told() {
    let bench = Bench::new("echo 'out of paper' >&2; exit 3");
    let said = bench.refused();
    assert!(said.contains("failed:\nout of paper"), "{said}");
}

#[test]
fn a_library_that_cannot_be_loaded_is_told_with_its_cause() {
    let bench = Bench::new("echo 'no library' > \"$out\"");
    let said = bench.refused();
    assert!(said.contains("cannot be loaded"), "{said}");
    // What the dynamic linker of the system says.
    let causes = [
        "file too short",
        "invalid ELF header",
        "not a mach-o",
        "Exec format",
    ];
    assert!(causes.iter().any(|cause| said.contains(cause)), "{said}");
}

#[test]
fn a_library_without_the_functions_or_of_other_sizes_is_refused() {
    if !has_compiler() {
        return;
    }
    let changed = |change: &str| {
        let edited = format!(
            "for word; do case \"$word\" in *.c) sed -i.bak '{change}' \"$word\" \"${{word%.c}}.h\";; esac; done; real \"$@\""
        );
        Bench::new(&edited).refused()
    };
    let said = changed("s/scene_sizes/other_sizes/");
    assert!(said.contains("it has no `scene_sizes`"), "{said}");
    let said = changed("s/scene_forward_dynamics(/other(/");
    assert!(
        said.contains("it has no `scene_forward_dynamics`"),
        "{said}"
    );
    let said = changed("s/define SCENE_SPEEDS 3/define SCENE_SPEEDS 300/");
    assert!(said.contains("`scene_sizes` is [1, 9, 3, 300]"), "{said}");
    assert!(said.contains("of the mechanism is [1, 9, 3, 3]"), "{said}");
    let said = changed("s/_results = 3/_results = 4/");
    assert!(
        said.contains("`scene_forward_dynamics_results` is 4"),
        "{said}"
    );
}
