//! Has the linker keep one copy of functions that are compiled to the same instructions: a twelfth of the extension module.

use std::env::var_os;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // This target's linker is LLVM's unless another is named; others may not know the option.
    let target = var_os("TARGET");
    if target.is_some_and(|own| own == "x86_64-unknown-linux-gnu")
        && var_os("RUSTC_LINKER").is_none()
    {
        println!("cargo::rustc-link-arg-cdylib=-Wl,--icf=all");
    }
}
