//! Compiled modules in C as a program that is asked for values: written into a folder, built by the C compiler of the machine, and run.
//!
//! The program reads the number of a function and its arguments as doubles from its input, and answers with the results; so values cross
//! bit by bit.

mod agree;
mod kernels;

pub use agree::{Extent, agree, functions, same};

use hamel_compiler::emit::{Function, c99};
use hamel_compiler::model::Model;
use std::fmt::Write as _;
use std::io::{BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Options under which modules are promised to compile without a warning, and to do one operation after the other.
const OPTIONS: [&str; 6] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Werror",
    "-ffp-contract=off",
];

/// What the C compiler is told of fused multiply–adds, so that they are fused where those of this program are.
const FUSED: &[&str] = if cfg!(target_feature = "fma") {
    &["-mfma"]
} else {
    &["-U__FP_FAST_FMA"]
};

/// A module to be built.
pub struct Module<'a> {
    /// Its name, an identifier.
    pub name: String,
    /// What it is of.
    pub model: &'a Model,
    /// Its functions.
    pub functions: &'a [Function],
    /// Those of them that take many states at a time.
    pub lanes: &'a [Function],
    /// Those of them of which the kernels in CUDA are built as well, for the processor.
    pub kernels: &'a [Function],
    /// The compiler's option for optimisation.
    pub optimisation: &'static str,
}

/// The program, running.
pub struct Program {
    child: Child,
    /// Closed before the program is waited for.
    requests: Option<ChildStdin>,
    results: BufReader<ChildStdout>,
    entries: Vec<Entry>,
}

/// States that functions of many states are given: a whole group, and one that is not.
pub const STATES: usize = 11;

/// How names of functions of many states end: those of states in rows, and what calls a kernel.
const ROWS: &str = "_rows";
const KERNEL: &str = "_grid";

/// A function of the program.
struct Entry {
    module: String,
    /// In the module, with the ending.
    name: String,
    /// Empty for a function of one state: others are given how many there are.
    ending: &'static str,
    /// Entries of each argument.
    arguments: Vec<usize>,
    results: usize,
}

impl Entry {
    fn all(module: &Module<'_>) -> Vec<Self> {
        let entry = |function: &Function, ending: &'static str| {
            let states = if ending.is_empty() { 1 } else { STATES };
            let arguments = function.arguments.iter().map(|(_, size)| states * size);
            Self {
                module: module.name.clone(),
                name: format!("{}{ending}", function.name),
                ending,
                arguments: arguments.collect(),
                results: states * function.results(),
            }
        };
        let single = module.functions.iter().map(|one| entry(one, ""));
        let many = module.lanes.iter().map(|one| entry(one, ROWS));
        let kernels = module.kernels.iter().map(|one| entry(one, KERNEL));
        single.chain(many).chain(kernels).collect()
    }

    fn arguments(&self) -> usize {
        self.arguments.iter().sum()
    }

    /// The call of the function, at arguments that lie in `x` one after the other.
    fn call(&self) -> String {
        let count = (!self.ending.is_empty()).then(|| format!("{STATES}, "));
        let mut end = 0;
        let starts = self.arguments.iter().map(|size| {
            end += size;
            format!("x + {}, ", end - size)
        });
        let starts: String = count.into_iter().chain(starts).collect();
        format!("{}_{}({starts}y)", self.module, self.name)
    }
}

impl Program {
    /// Builds and starts the program in `folder`; nothing where there is no C compiler, which is told on stderr.
    ///
    /// # Panics
    /// Where a module does not compile, or compiles with a warning.
    pub fn new(folder: &Path, modules: &[Module<'_>]) -> Option<Self> {
        std::fs::create_dir_all(folder).expect("the folder can be made");
        let mut objects: Vec<PathBuf> = vec![];
        for module in modules {
            let functions = (module.functions, module.lanes);
            let texts = c99::module(module.model, functions, "a test", &module.name);
            let texts = texts.unwrap_or_else(|error| panic!("{error}"));
            write(folder, &format!("{}.h", module.name), &texts.header);
            let source = write(folder, &format!("{}.c", module.name), &texts.source);
            let object = source.with_extension("o");
            let fused: &[&str] = match module.kernels {
                [] => &[],
                _ => &[kernels::FUSED],
            };
            let options = [&[module.optimisation, "-c"], fused].concat();
            compile(&options, &[source], &object)?;
            objects.push(object);
            if !module.kernels.is_empty() {
                objects.push(kernels::built(folder, module)?);
            }
        }
        let entries: Vec<Entry> = modules.iter().flat_map(Entry::all).collect();
        objects.push(write(folder, "main.c", &main(modules, &entries)));
        let program = folder.join("program");
        compile(&[], &objects, &program)?;
        let child = Command::new(&program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let mut child = child.expect("what was built runs");
        Some(Self {
            requests: child.stdin.take(),
            results: BufReader::new(child.stdout.take().expect("a pipe")),
            entries,
            child,
        })
    }

    /// The results of a function of a module; `arguments` one after the other. With the ending `_rows` those of [`STATES`] states, in rows; with the ending
    /// `_grid` those of the kernel, in a structure of arrays.
    ///
    /// # Panics
    /// Where the program does not have it, or has stopped.
    pub fn call(&mut self, module: &str, function: &str, arguments: &[&[f64]]) -> Vec<f64> {
        let mut entries = self.entries.iter();
        let found = entries.position(|entry| entry.module == module && entry.name == function);
        let number = found.unwrap_or_else(|| panic!("no {function} of {module}"));
        let numbers = std::iter::once(number as f64).chain(arguments.concat());
        let request: Vec<u8> = numbers.flat_map(f64::to_ne_bytes).collect();
        let requests = self.requests.as_mut().expect("it is open");
        requests.write_all(&request).expect("the program reads");
        let mut bytes = vec![0; 8 * self.entries[number].results];
        self.results
            .read_exact(&mut bytes)
            .expect("the program answers");
        let (doubles, _) = bytes.as_chunks();
        doubles.iter().copied().map(f64::from_ne_bytes).collect()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        drop(self.requests.take());
        drop(self.child.wait());
    }
}

/// Compiles C or links; nothing where there is no compiler.
fn compile(options: &[&str], sources: &[PathBuf], target: &Path) -> Option<()> {
    let options = [&OPTIONS, options].concat();
    compile_by(("CC", "cc"), &options, sources, target)
}

/// The same by the compiler that an environment variable names, or else the usual one.
fn compile_by(
    (variable, usual): (&str, &str),
    options: &[&str],
    sources: &[PathBuf],
    target: &Path,
) -> Option<()> {
    let compiler = std::env::var_os(variable).unwrap_or_else(|| usual.into());
    let output = Command::new(&compiler)
        .args(FUSED)
        .args(options)
        .args(sources)
        .arg("-o")
        .arg(target)
        .arg("-lm")
        .output();
    match output {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{said}");
            Some(())
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            // Not by a macro: those are shown only where a test fails.
            let _ = writeln!(
                std::io::stderr(),
                "SKIPPED: no compiler: {} is not found; name one in {variable}",
                Path::new(&compiler).display()
            );
            None
        }
        Err(error) => panic!("{}: {error}", Path::new(&compiler).display()),
    }
}

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("the folder is there");
    path
}

/// The program that answers.
fn main(modules: &[Module<'_>], entries: &[Entry]) -> String {
    let most = |size: fn(&Entry) -> usize| entries.iter().map(size).max().unwrap_or(0);
    let (inputs, outputs) = (most(Entry::arguments), most(|entry| entry.results));
    let mut text = String::from("#include <stdio.h>\n");
    for module in modules {
        let _ = writeln!(text, "#include \"{}.h\"", module.name);
    }
    for entry in entries.iter().filter(|entry| entry.ending == KERNEL) {
        let _ = writeln!(text, "{};", kernels::prototype(entry));
    }
    let _ = write!(
        text,
        "\nstatic int take(double *x, size_t count) {{ return fread(x, sizeof *x, count, stdin) == count; }}\n\n\
         int main(void)\n{{\n    static double number, x[{inputs} + 1], y[{outputs} + 1];\n    while (take(&number, 1)) {{\n        \
         size_t count = 0;\n        switch ((int)number) {{\n"
    );
    for (number, entry) in entries.iter().enumerate() {
        let _ = write!(
            text,
            "        case {number}:\n            if (!take(x, {})) return 1;\n            {};\n            count = {};\n            break;\n",
            entry.arguments(),
            entry.call(),
            entry.results
        );
    }
    text + "        }\n        if (fwrite(y, sizeof *y, count, stdout) != count || fflush(stdout)) return 1;\n    }\n    return 0;\n}\n"
}
