//! Compiled modules in C as a program that is asked for values: written into a folder, built by the C compiler of the machine, and run.
//!
//! The program reads the number of a function and its arguments as doubles from its input, and answers with the results; so values cross
//! bit by bit.

mod agree;

pub use agree::{agree, functions, same};

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
    /// The compiler's option for optimisation.
    pub optimisation: &'static str,
}

/// The program, running.
pub struct Program {
    child: Child,
    /// Closed before the program is waited for.
    requests: Option<ChildStdin>,
    results: BufReader<ChildStdout>,
    /// Of each function of each module its number and how many results it has.
    functions: Vec<(String, &'static str, usize)>,
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
            let texts = c99::module(module.model, module.functions, "a test", &module.name);
            let texts = texts.unwrap_or_else(|error| panic!("{error}"));
            write(folder, &format!("{}.h", module.name), &texts.header);
            let source = write(folder, &format!("{}.c", module.name), &texts.source);
            let object = source.with_extension("o");
            compile(&[module.optimisation, "-c"], &[source], &object)?;
            objects.push(object);
        }
        objects.push(write(folder, "main.c", &main(modules)));
        let program = folder.join("program");
        compile(&[], &objects, &program)?;
        let child = Command::new(&program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let mut child = child.expect("what was built runs");
        let functions = modules.iter().flat_map(|module| {
            let functions = module.functions.iter();
            functions.map(|one| (module.name.clone(), one.name, one.results()))
        });
        Some(Self {
            requests: child.stdin.take(),
            results: BufReader::new(child.stdout.take().expect("a pipe")),
            functions: functions.collect(),
            child,
        })
    }

    /// The results of a function of a module; `arguments` one after the other.
    ///
    /// # Panics
    /// Where the program does not have it, or has stopped.
    pub fn call(&mut self, module: &str, function: &str, arguments: &[&[f64]]) -> Vec<f64> {
        let mut functions = self.functions.iter();
        let found = functions.position(|(of, name, _)| of == module && *name == function);
        let number = found.unwrap_or_else(|| panic!("no {function} of {module}"));
        let numbers = std::iter::once(number as f64).chain(arguments.concat());
        let request: Vec<u8> = numbers.flat_map(f64::to_ne_bytes).collect();
        let requests = self.requests.as_mut().expect("it is open");
        requests.write_all(&request).expect("the program reads");
        let mut bytes = vec![0; 8 * self.functions[number].2];
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

/// Compiles or links; nothing where there is no compiler.
fn compile(options: &[&str], sources: &[PathBuf], target: &Path) -> Option<()> {
    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let output = Command::new(&compiler)
        .args(OPTIONS)
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
                "SKIPPED: no C compiler: {} is not found; name one in CC",
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
fn main(modules: &[Module<'_>]) -> String {
    let all = || {
        modules.iter().flat_map(|module| {
            let functions = module.functions.iter();
            functions.map(move |function| (&module.name, function))
        })
    };
    let most = |size: fn(&Function) -> usize| all().map(|(_, one)| size(one)).max().unwrap_or(0);
    let (inputs, outputs) = (most(arguments), most(|one| one.results()));
    let mut text = String::from("#include <stdio.h>\n");
    for module in modules {
        let _ = writeln!(text, "#include \"{}.h\"", module.name);
    }
    let _ = write!(
        text,
        "\nstatic int take(double *x, size_t count) {{ return fread(x, sizeof *x, count, stdin) == count; }}\n\n\
         int main(void)\n{{\n    static double number, x[{inputs} + 1], y[{outputs} + 1];\n    while (take(&number, 1)) {{\n        \
         size_t count = 0;\n        switch ((int)number) {{\n"
    );
    for (number, (module, function)) in all().enumerate() {
        let mut end = 0;
        let starts = function.arguments.iter().map(|&(_, size)| {
            end += size;
            format!("x + {}, ", end - size)
        });
        let starts: String = starts.collect();
        let _ = write!(
            text,
            "        case {number}:\n            if (!take(x, {})) return 1;\n            {module}_{}({starts}y);\n            \
             count = {};\n            break;\n",
            arguments(function),
            function.name,
            function.results()
        );
    }
    text + "        }\n        if (fwrite(y, sizeof *y, count, stdout) != count || fflush(stdout)) return 1;\n    }\n    return 0;\n}\n"
}

/// Entries of all arguments of a function.
fn arguments(function: &Function) -> usize {
    function.arguments.iter().map(|(_, size)| size).sum()
}
