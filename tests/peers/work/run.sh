#!/bin/bash
# Installs peers where they are missing, builds, and measures error against run time of whole motions; prints one markdown report.
#   ./run.sh                                       every scene that others can express (first time: minutes of installs)
#   ARGS='--scenes chain_8,mixed_tree --libs mujoco,drake' ./run.sh
#   OURS='path/to/peer-work' ./run.sh              a program of ours that is built already
#   SKIP_INSTALL=1                                 leave out the installs;   PEERS_WORK=$HOME/.cache/peers   scratch directory
set -u
HERE=$(cd "$(dirname "$0")" && pwd); W=${PEERS_WORK:-$HOME/.cache/peers}; export PEERS_WORK=$W
mkdir -p "$W"/{build,results}
log() { echo "[peers] $*" >&2; }
[ -z "${SKIP_INSTALL:-}" ] && "$HERE/../install.sh" base drake
if [ -z "${OURS:-}" ]; then
  log "our program, which compiles the scenes, for this machine's instructions"
  RUSTFLAGS="-C target-cpu=native" cargo build --quiet --release --manifest-path "$HERE/program/Cargo.toml" --target-dir "$W/target" || exit 1
  OURS="$W/target/release/peer-work"
fi
export OURS
MUJOCO=$(echo "$W"/venv/lib/python3*/site-packages/mujoco)
LIBRARY=$(ls "$MUJOCO"/libmujoco.so.* 2>/dev/null | head -1)
CXX=$(command -v clang++-19 || command -v clang++ || echo g++)
if [ -n "$LIBRARY" ] && [ "$HERE/work_mujoco.cpp" -nt "$W/build/work_mujoco" ]; then
  log "build work_mujoco"
  $CXX -std=c++20 -O3 -march=native -I"$MUJOCO/include" "$HERE/work_mujoco.cpp" -o "$W/build/work_mujoco" "$LIBRARY" -Wl,-rpath,"$MUJOCO" || log "the build failed"
fi
{
  echo "# Error against run time, $(date -u +%F), $(lscpu | sed -n 's/^Model name: *//p'), $(nproc) cpus, load $(cut -d' ' -f1 /proc/loadavg)"
  echo
  "$W/venv/bin/python" "$HERE/work.py" "$W" ${ARGS:-}
} | tee "$W/results/work.md"
