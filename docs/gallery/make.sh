#!/usr/bin/env bash
# Draws the pictures of docs/gallery.md again.
set -euo pipefail
cd "$(dirname "$0")/../.."
for picture in docs/gallery/*.svg; do
    scene=scenes/$(basename "$picture" .svg).toml
    cargo run --quiet --release --locked --package hamel-cli --features predictive -- \
        simulate "$scene" --quiet --force --picture "$picture" --instants 4
done
