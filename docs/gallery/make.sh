#!/usr/bin/env bash
# Draws the pictures of docs/gallery.md again. With a folder, writes into it the pages that play the same motions instead.
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo build --release --locked --package hamel-cli --features predictive
[ $# = 0 ] || mkdir -p "$1"
for picture in docs/gallery/*.svg; do
    name=$(basename "$picture" .svg)
    if [ $# = 0 ]; then output=(--picture "$picture" --instants 4); else output=(--html "$1/$name.html"); fi
    cargo run --quiet --release --locked --package hamel-cli --features predictive -- \
        simulate "scenes/$name.toml" --quiet --force "${output[@]}"
done
