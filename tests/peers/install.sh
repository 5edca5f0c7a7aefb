#!/bin/bash
# Installs peers where they are missing: base (compilers; Pinocchio, MuJoCo, CasADi, SciPy), cppad, drake.
#   ./install.sh base drake      PEERS_WORK=$HOME/.cache/peers   scratch directory
set -u
W=${PEERS_WORK:-$HOME/.cache/peers}
mkdir -p "$W"
log() { echo "[peers] $*" >&2; }
pip_into() { # environment packages...
  env=$W/$1; shift
  [ -x "$env/bin/python" ] || python3 -m venv "$env"
  for p in "$@"; do
    "$env/bin/pip" show -q "${p%%==*}" >/dev/null 2>&1 || { log "pip install $p"; "$env/bin/pip" install -q "$p" >>"$W/pip.log" 2>&1 || log "pip failed for $p, see $W/pip.log"; }
  done
}
for part in "$@"; do
  case $part in
  base)
    need=""; for p in clang-19 libeigen3-dev g++; do dpkg -s $p >/dev/null 2>&1 || need="$need $p"; done
    [ -n "$need" ] && { log "apt-get install$need"; apt-get update -q >"$W/apt.log" 2>&1; apt-get install -y -q $need >>"$W/apt.log" 2>&1 || log "apt failed, see $W/apt.log"; }
    pip_into venv pin==4.1.0 example-robot-data==6.0.0 casadi==3.8.2 mujoco==4.0.0 numpy scipy gmpy2 ;;
  cppad) pip_into venv_cppad cmeel-cppad==20230000.0 cmeel-cppadcodegen==2.4.3 ;;
  drake) pip_into venv_drake drake==1.51.1 numpy ;; # its own environment: its versions need not be those of the others
  *) log "nothing is called $part"; exit 2 ;;
  esac
done
