#!/bin/bash
# Installs peers where they are missing, builds, measures, prints one markdown report.
#   ./run.sh                                    everything (first time: ~35 min of installs and compiles on 2 cores)
#   OURS='path/to/our_bench' ./run.sh           a program of ours built elsewhere (protocol: README.md)
#   COMPILED='panda7 anymal g1:aba,rnea' ./run.sh    compiled scenes of these models as well (README.md)
#   EXTRA='rbdl=/some/bench;x=cmd' ./run.sh     further programs
#   ARGS='--robots g1,ball32 --algos aba,rnea --libs pinocchio,casadi_clang_fast --reps 15' ./run.sh
#   SKIP_INSTALL=1, SKIP_CG=1     leave out steps;   PEERS_WORK=$HOME/.cache/peers   scratch directory
set -u
HERE=$(cd "$(dirname "$0")" && pwd); W=${PEERS_WORK:-$HOME/.cache/peers}; export PEERS_WORK=$W
mkdir -p "$W"/{build,cg,models,results}
log() { echo "[peers] $*" >&2; }
if [ -z "${OURS:-}" ]; then
  log "peer_bench of this repository, for this machine's instructions"
  RUSTFLAGS="-C target-cpu=native" cargo build --quiet --release --manifest-path "$HERE/../Cargo.toml" --example peer_bench --target-dir "$W/target" || exit 1
  OURS="$W/target/release/examples/peer_bench"
fi
export OURS
[ -z "${SKIP_INSTALL:-}" ] && "$HERE/install.sh" base cppad
CPP=$(echo "$W"/venv_cppad/lib/python3*/site-packages/cmeel.prefix)
SP=$(echo "$W"/venv/lib/python3*/site-packages); PFX=$SP/cmeel.prefix
export CLANG_C=$(command -v clang-19 || command -v clang || echo gcc); CLANGXX=$(command -v clang++-19 || command -v clang++ || echo g++)

# Header overlay: Data's four nv^3 tensors (only used by second-order derivatives) are allocated empty, otherwise
# nv = 1536 needs 116 GB. Nothing that is timed touches them.
if [ ! -e "$W/ov/pinocchio/src/multibody/data.hxx" ]; then
  mkdir -p "$W/ov"; cp -rs "$PFX/include/pinocchio" "$W/ov/pinocchio"; rm "$W/ov/pinocchio/src/multibody/data.hxx"
  sed 's/(model\.nv, model\.nv, model\.nv)/(0, 0, 0)/' "$PFX/include/pinocchio/src/multibody/data.hxx" >"$W/ov/pinocchio/src/multibody/data.hxx"
fi
if [ ! -e "$W/models/index.json" ]; then
  log "models"; "$W/venv/bin/python" "$HERE/gen_models.py" "$W" >"$W/models.log" 2>&1 || log "gen_models failed, see $W/models.log"
fi
if [ -n "${COMPILED:-}" ]; then # after the models are there
  log "compiled scenes of $COMPILED, for this machine's instructions"
  models=(); for m in $COMPILED; do a=""; [[ $m == *:* ]] && a=":${m#*:}"; models+=("$W/models/${m%%:*}.txt$a"); done
  OURS_COMPILED=$(cargo run --quiet --manifest-path "$HERE/../Cargo.toml" --example peer_compiled -- --build "$W/compiled" "${models[@]}") || exit 1
  export OURS_COMPILED
fi

DEF="-DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS -DBOOST_FUSION_INVOKE_MAX_ARITY=12"
PIN="$DEF -I$W/ov -I$PFX/include -I/usr/include/eigen3 -I$HERE/src"
PINL="-L$PFX/lib -lboost_serialization -Wl,-rpath,$PFX/lib"
CAS=$(ls "$SP"/casadi/libcasadi.so.3.* 2>/dev/null | head -1)
MUJ=$(ls "$SP"/mujoco/libmujoco.so.* 2>/dev/null | head -1)
newer() { [ ! -e "$1" ] || [ "$2" -nt "$1" ] || [ "$HERE/src/common.hpp" -nt "$1" ]; }
[ -n "${FORCE:-}" ] && newer() { true; }
linkb() { # as build, but libraries after the source: out src libs -- command...
  out=$1; src=$2; libs=$3; shift 3
  newer "$W/build/$out" "$HERE/src/$src" || return 0
  log "build $out"; "$@" "$HERE/src/$src" -o "$W/build/$out.tmp" $libs >"$W/build/$out.log" 2>&1 && mv "$W/build/$out.tmp" "$W/build/$out" || log "build of $out failed, see $W/build/$out.log"
}
CXXV=$($CLANGXX --version | head -1 | sed 's/ (.*//; s/Debian //'); GV=$(g++ --version | head -1 | awk '{print $NF}')
( linkb bench_pin_clang bench_pin.cpp "$PINL" $CLANGXX -std=c++20 -O3 -march=native -DNDEBUG "-DFLAGS=\"$CXXV -O3 -march=native -DNDEBUG\"" $PIN
  [ -n "$MUJ" ] && linkb bench_mujoco bench_mujoco.cpp "$MUJ -Wl,-rpath,$SP/mujoco" $CLANGXX -std=c++20 -O3 -march=native -I"$HERE/src" -I"$SP/mujoco/include"
  linkb bench_cg bench_cg.cpp "-ldl" $CLANGXX -std=c++20 -O3 -march=native -I"$HERE/src"
  linkb fma_peak fma_peak.c "" $CLANG_C -O3 -march=native ) &
A=$!
( [ -n "$CAS" ] && linkb gen_casadi gen_casadi.cpp "-L$SP/casadi -l:$(basename "$CAS") $PINL -Wl,-rpath,$SP/casadi" g++ -std=c++20 -O1 -DNDEBUG $PIN -I"$SP/casadi/include"
  [ -d "$CPP" ] && linkb gen_cppadcg gen_cppadcg.cpp "$PINL -L$CPP/lib -lcppad_lib -Wl,-rpath,$CPP/lib" $CLANGXX -std=c++17 -O1 -DNDEBUG $DEF -I"$W/ov" -I"$CPP/include" -I"$PFX/include" -I/usr/include/eigen3 -I"$HERE/src"
  true ) &
B=$!
wait $A $B
if [ -z "${SKIP_CG:-}" ] && [ -x "$W/build/gen_casadi" ]; then
  cd "$W/cg" && for m in pendulum panda7 anymal g1 rev8 rev32 ball8 ball32; do
    [ -s $m.ops ] || { log "casadi code for $m"; timeout 600 "$W/build/gen_casadi" "$W/models/$m.txt" $m rnea aba aba_world crba nle >$m.ops 2>$m.err; }
  done; cd - >/dev/null
  log "compiling generated code (first time: long)"; "$HERE/build_cg.sh" "$W/cg" >&2
fi
if [ -z "${SKIP_CG:-}" ] && [ -x "$W/build/gen_cppadcg" ]; then
  mkdir -p "$W/cgcp"
  for m in pendulum panda7 anymal g1 rev8 rev32 ball8; do
    [ -s "$W/cgcp/$m.ops" ] || timeout 200 "$W/build/gen_cppadcg" "$W/models/$m.txt" "$W/cgcp/$m" aba rnea >"$W/cgcp/$m.ops" 2>"$W/cgcp/$m.err"
  done
  for f in $(ls -Sr "$W"/cgcp/*.c); do b=$(basename "$f" .c)
    [ -e "$W/cg/$b.cppadcg_gcc_O3.so" ] || timeout 200 gcc -O3 -march=native -fPIC -shared -w "$f" -o "$W/cg/$b.cppadcg_gcc_O3.so" -lm
    [ -e "$W/cg/$b.cppadcg_clang_O3.so" ] || timeout 200 $CLANG_C -O3 -march=native -fPIC -shared -w "$f" -o "$W/cg/$b.cppadcg_clang_O3.so" -lm
  done
fi
{
  echo "# Peers, $(date -u +%FT%TZ), $(lscpu | sed -n 's/^Model name: *//p') family/model $(lscpu | awk -F: '/CPU family/{f=$2}/^Model:/{m=$2}END{gsub(/ /,"",f);gsub(/ /,"",m);print f"/"m}'), $(nproc) cpus, load $(cut -d' ' -f1 /proc/loadavg)"
  echo; "$W/build/fma_peak"; echo
  echo "## Operations of the generated code (CasADi SX after CSE; straight-line, one state)"; echo
  echo "| robot | function | instructions | add/sub/neg | mul | div | sqrt | sin+cos | flops (add+mul+div+sqrt) |"; echo "|---|---|---|---|---|---|---|---|---|"
  for m in pendulum panda7 anymal g1 rev8 rev32 ball8 ball32; do [ -e "$W/cg/$m.ops" ] && awk '{print "| "$1" | "$2" | "$4" | "$8" | "$10" | "$12" | "$14" | "$16" | "$8+$10+$12+$14" |"}' "$W/cg/$m.ops"; done
  echo; echo "Same through CppADCodeGen (operators counted in the generated text):"; echo; echo '```'; cat "$W"/cgcp/*.ops 2>/dev/null; echo '```'; echo
  "$W/venv/bin/python" "$HERE/compare.py" "$W" --out "$W/results" ${ARGS:-}
} | tee "$W/results/report.md"
