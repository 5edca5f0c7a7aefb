//! Kernels in CUDA, built by the C++ compiler of the machine for its processor: blocks and threads one after the other.

use super::{Entry, KERNEL, Module, compile_by, write};
use hamel_compiler::emit::c99;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Unrolling is asked for in the words of CUDA.
const OPTIONS: [&str; 9] = [
    "-x",
    "c++",
    "-std=c++14",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-Wno-unknown-pragmas",
    "-ffp-contract=off",
    "-c",
];

/// Kernels fuse multiply–adds always. With this C does so too, and both have the same bits.
pub const FUSED: &str = "-DFP_FAST_FMA=1";

/// Writes the module's kernels and what calls them, and compiles both; nothing where there is no compiler.
pub fn built(folder: &Path, module: &Module<'_>) -> Option<PathBuf> {
    let text = c99::cuda(module.model, module.kernels, "a test", &module.name);
    let text = text.unwrap_or_else(|error| panic!("{error}"));
    write(folder, &format!("{}.cu", module.name), &text);
    let host = write(folder, &format!("{}_host.cpp", module.name), &host(module));
    let object = host.with_extension("o");
    let options = [&OPTIONS[..], &[module.optimisation]].concat();
    compile_by(("CXX", "c++"), &options, &[host], &object)?;
    Some(object)
}

/// What calls a kernel, as the program declares it.
pub fn prototype(entry: &Entry) -> String {
    let arguments = "const double *, ".repeat(entry.arguments.len());
    format!(
        "void {}_{}(long, {arguments}double *)",
        entry.module, entry.name
    )
}

/// The kernels as functions of the processor. There are more threads than states.
fn host(module: &Module<'_>) -> String {
    let name = &module.name;
    let mut text = format!(
        "#define __device__\n#define __global__\n#include <math.h>\n\nstruct Index {{ long x; }};\n\
         static Index blockIdx, threadIdx;\nstatic const Index blockDim = {{4}};\n\n#include \"{name}.cu\"\n\nextern \"C\" {{\n"
    );
    let entries = Entry::all(module);
    for entry in entries.iter().filter(|entry| entry.ending == KERNEL) {
        let kernel = entry.name.replace(KERNEL, "_states");
        let places = 0..entry.arguments.len();
        let (declared, given): (String, String) = places
            .map(|i| (format!("const double *x{i}, "), format!("x{i}, ")))
            .unzip();
        let _ = write!(
            text,
            "void {name}_{}(long count, {declared}double *y)\n{{\n    for (blockIdx.x = 0; blockIdx.x < count / blockDim.x + 2; blockIdx.x++)\n        \
             for (threadIdx.x = 0; threadIdx.x < blockDim.x; threadIdx.x++)\n            {name}_{kernel}(count, {given}y);\n}}\n",
            entry.name
        );
    }
    text + "}\n"
}
