#!/bin/bash
# Builds generalized_rbda with its URDF+ parser, and bench_rbda, into $PEERS_WORK; what is newer than its sources is kept. `../install.sh base rbda` brings the sources.
set -u
HERE=$(cd "$(dirname "$0")" && pwd); W=${PEERS_WORK:-$HOME/.cache/peers}; S=$W/rbda; B=$W/build/rbda
mkdir -p "$B"
CASADI=$(echo "$W"/venv/lib/python3*/site-packages/casadi); PFX=$(echo "$W"/venv/lib/python3*/site-packages/cmeel.prefix)
CXX=$(command -v clang++-19 || command -v clang++ || echo g++)
OPTIMISED="-O3 -march=native -DNDEBUG"
export COMPILE="$CXX -std=c++17 $OPTIMISED -w -Wno-missing-template-arg-list-after-template-kw -I$S/generalized_rbda/include -I$S/urdfdom/urdf_parser/include -I$S/urdfdom_headers/include -I$CASADI/include -I$PFX/include -I/usr/include/eigen3"
export B
one() { # one source to one object
  object=$B/$(basename "$1" .cpp).o
  [ "$object" -nt "$1" ] || $COMPILE -c "$1" -o "$object.tmp" && { [ ! -e "$object.tmp" ] || mv "$object.tmp" "$object"; }
}
export -f one
{ find "$S/generalized_rbda/src/Dynamics" "$S/generalized_rbda/src/Utils" -name '*.cpp' ! -name 'ReflectedInertia*' ! -name 'RigidBodyTree*'; for name in model link joint pose constraint twist; do echo "$S/urdfdom/urdf_parser/src/$name.cpp"; done; } |
  xargs -P "$(nproc)" -I{} bash -c 'one "{}"' || exit 1
COMMIT=$(git -C "$S/generalized_rbda" rev-parse --short=8 HEAD)
FLAGS="$($CXX --version | head -1 | sed 's/ (.*//; s/Debian //') $OPTIMISED"
$COMPILE "-DLIBRARY=\"generalized_rbda, commit $COMMIT, casadi $(ls -d "$CASADI"-*.dist-info | sed 's/.*-\(.*\).dist-info/\1/')\"" "-DFLAGS=\"$FLAGS\"" \
  "-DURDFS=\"$S/generalized_rbda/Benchmarking/urdfs\"" "$HERE/bench_rbda.cpp" "$B"/*.o -o "$W/build/bench_rbda" \
  -L"$CASADI" -lcasadi -ltinyxml2 -lconsole_bridge -Wl,-rpath,"$CASADI"
