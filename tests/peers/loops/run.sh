#!/bin/bash
# Installs peers where they are missing, writes mechanisms with loops and their exact accelerations, builds, and measures forward dynamics; prints one markdown report.
#   ./run.sh                                              every mechanism
#   EXTRA='label=command' ./run.sh                        more programs of the protocol in program/src/main.rs
#   ARGS='--models humanoid --reps 31' ./run.sh           arguments of compare.py
#   SKIP_INSTALL=1      leave out the installs;   PEERS_WORK=$HOME/.cache/peers   scratch directory
set -u
HERE=$(cd "$(dirname "$0")" && pwd); W=${PEERS_WORK:-$HOME/.cache/peers}; export PEERS_WORK=$W
export PEERS_LOOPS=$W/loops
mkdir -p "$W"/{build,results,loops}
log() { echo "[peers] $*" >&2; }
[ -z "${SKIP_INSTALL:-}" ] && "$HERE/../install.sh" base rbda
[ "$(ls "$PEERS_LOOPS"/*.json 2>/dev/null | wc -l)" -gt 0 ] && [ -z "$(find "$HERE" -name '*.py' -newer "$PEERS_LOOPS/written")" ] || {
  log "mechanisms, and their exact accelerations"
  "$W/venv/bin/python" "$HERE/models.py" "$PEERS_LOOPS" >&2 && touch "$PEERS_LOOPS/written" || exit 1
}
log "our program, which compiles the scenes, for this machine's instructions"
RUSTFLAGS="-C target-cpu=native" cargo build --quiet --release --manifest-path "$HERE/program/Cargo.toml" --target-dir "$W/target" || exit 1
PFX=$(echo "$W"/venv/lib/python3*/site-packages/cmeel.prefix)
CXX=$(command -v clang++-19 || command -v clang++ || echo g++)
if [ ! -e "$W/build/bench_loops" ] || [ "$HERE/bench_loops.cpp" -nt "$W/build/bench_loops" ]; then
  log "build bench_loops"
  FLAGS="$($CXX --version | head -1 | sed 's/ (.*//; s/Debian //') -O3 -march=native -DNDEBUG"
  $CXX -std=c++20 -O3 -march=native -DNDEBUG -w "-DFLAGS=\"$FLAGS\"" -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 \
    -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS -DBOOST_FUSION_INVOKE_MAX_ARITY=12 -I"$PFX/include" -I/usr/include/eigen3 \
    "$HERE/bench_loops.cpp" -o "$W/build/bench_loops" -L"$PFX/lib" -lboost_serialization -Wl,-rpath,"$PFX/lib" || log "the build failed"
fi
[ -d "$W/rbda/generalized_rbda" ] && { log "build bench_rbda"; "$HERE/build_rbda.sh" || log "the build failed"; }
programs=("hamel compiled=$W/target/release/peer-loops --compiled" "hamel tree=$W/target/release/peer-loops")
[ -x "$W/build/bench_loops" ] && programs+=("pinocchio=$W/build/bench_loops")
[ -x "$W/build/bench_rbda" ] && programs+=("generalized_rbda=$W/build/bench_rbda")
IFS=';' read -ra extra <<<"${EXTRA:-}"
{
  echo "# Mechanisms with loops, $(date -u +%F), $(lscpu | sed -n 's/^Model name: *//p'), $(nproc) cpus, load $(cut -d' ' -f1 /proc/loadavg)"
  echo
  "$W/venv/bin/python" "$HERE/compare.py" "$PEERS_LOOPS" "${programs[@]}" "${extra[@]}" ${ARGS:-}
} | tee "$W/results/loops.md"
