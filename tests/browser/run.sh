#!/usr/bin/env bash
# Simulates scenes, opens their pages in a headless Chromium without network, and checks what is on them.
set -euo pipefail
cd "$(dirname "$0")"

browser=${CHROMIUM:-/usr/bin/chromium}
[ -x "$browser" ] || { echo "no browser at $browser: install Chromium, or set CHROMIUM" >&2; exit 1; }
[ -d node_modules/playwright-core ] || npm install --no-audit --no-fund --silent

cargo build --package hamel-cli --manifest-path ../../Cargo.toml
hamel=${CARGO_TARGET_DIR:-../../target}/debug/hamel
mkdir -p out
simulate() { "$hamel" simulate "$1" --quiet --html "out/$2.html" --csv "out/$2.csv" "${@:3}"; }
simulate ../data/urdf/g1.urdf g1 --t-end 10 --tol 1e-6
simulate ../../scenes/plate_cart_arm.toml plate_cart_arm
simulate ../../scenes/snakeboard.toml snakeboard
CHROMIUM=$browser node page.js
