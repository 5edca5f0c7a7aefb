#!/usr/bin/env bash
# Compiled scenes under AddressSanitizer: batches and lanes of the runtime, libraries in C behind the program's own loader, and the modules in C themselves.
# What the machine's compilers cannot do is told as SKIPPED, by name. Takes a minute or two.
set -euo pipefail
cd "$(dirname "$0")/../.."

target=$PWD/target/sanitizers
mkdir -p "$target"
cargo build --locked --package hamel-cli

# Modules of two scenes, and their sizes. Constraints that couple joints are in one of them.
functions=(forward-dynamics forward-dynamics-derivatives momenta speeds-from-momenta momentum-rates hamiltonian mass-matrix)
compiler=${CC:-cc}
if ! "$compiler" --version > /dev/null 2>&1; then
    echo "SKIPPED: libraries in C and modules in C: no C compiler"
    libraries=
else
    libraries=$target/libraries
    for name in one other; do
        case $name in one) scene=plate_cart_arm ;; *) scene=snakeboard ;; esac
        mkdir -p "$libraries/$name"
        target/debug/hamel compile "scenes/$scene.toml" "${functions[@]/#/--function=}" -o "$libraries/$name/scene.c"
        "$compiler" -std=c99 -O1 -ffp-contract=off -fPIC -shared "$libraries/$name/scene.c" -o "$libraries/$name.so" -lm
        sanitize=(-fsanitize=address,undefined -fno-sanitize-recover=all)
        program=$libraries/$name/check
        if ! echo 'int main(void) { return 0; }' | "$compiler" "${sanitize[@]}" -x c - -o "$program" 2> /dev/null; then
            echo "SKIPPED: AddressSanitizer of modules in C: $compiler has none"
            sanitize=()
        fi
        "$compiler" -std=c99 -g -O1 "${sanitize[@]}" -I "$libraries/$name" tests/sanitizers/check.c "$libraries/$name/scene.c" -o "$program" -lm
        "$program" > "$libraries/$name.sizes"
        echo "ok: $scene in C"
    done
    echo 'int nothing;' | "$compiler" -fPIC -shared -x c - -o "$libraries/empty.so"
fi

# The Rust toolchain has the sanitizer's library where it supports it; the flag that asks for it is one of nightly's.
host=$(rustc -vV | sed -n 's/^host: //p')
if ! compgen -G "$(rustc --print sysroot)/lib/rustlib/$host/lib/*asan*" > /dev/null; then
    echo "SKIPPED: AddressSanitizer of the runtime and of the loader: the Rust toolchain has none for $host"
    exit
fi
skip=()
if [[ -z $libraries ]]; then
    skip=(--skip libraries::)
fi
export RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Zsanitizer=address" HAMEL_LIBRARIES=$libraries
# Leaks are not what is looked for, and containers may not let the check of them run.
export ASAN_OPTIONS=detect_leaks=0
cargo test --locked --manifest-path tests/sanitizers/Cargo.toml --target "$host" --target-dir "$target" -- --nocapture "${skip[@]}"
cargo test --locked --package hamel-compiled --lib --features levels --target "$host" --target-dir "$target"
