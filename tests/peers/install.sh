#!/bin/bash
# Installs peers where they are missing: base (compilers; Pinocchio, MuJoCo, CasADi, SciPy), cppad, drake, rbda (sources of generalized_rbda).
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
apt_install() {
  need=""; for p in "$@"; do dpkg -s "$p" >/dev/null 2>&1 || need="$need $p"; done
  [ -z "$need" ] || { log "apt-get install$need"; apt-get update -q >"$W/apt.log" 2>&1; apt-get install -y -q $need >>"$W/apt.log" 2>&1 || log "apt failed, see $W/apt.log"; }
}
checkout() { # repository commit
  folder=$W/rbda/${1##*/}
  [ -d "$folder" ] || { log "clone $1"; git clone -q "https://github.com/$1" "$folder" || { log "it cannot be cloned"; return; }; }
  git -C "$folder" checkout -q "$2" || log "$folder has no commit $2"
}
for part in "$@"; do
  case $part in
  base)
    apt_install clang-19 libeigen3-dev g++
    pip_into venv pin==4.1.0 example-robot-data==6.0.0 casadi==3.8.2 mujoco==4.0.0 numpy scipy gmpy2 ;;
  cppad) pip_into venv_cppad cmeel-cppad==20230000.0 cmeel-cppadcodegen==2.4.3 ;;
  drake) pip_into venv_drake drake==1.51.1 numpy ;; # its own environment: its versions need not be those of the others
  rbda) # as its scripts/install_dependencies.sh says, the parser of URDF+ is a fork of urdfdom
    apt_install libtinyxml2-dev libconsole-bridge-dev
    checkout ROAM-Lab-ND/generalized_rbda 45fa7c460fad8d35c4e419831a18e9aef5c85b6e
    checkout mit-biomimetics/urdfdom 0425417a68c331ae308a86fc752474ee55d7b041
    checkout mit-biomimetics/urdfdom_headers 632d1c7d13080b57c39f71bf4be4bbcaa337ec7c ;;
  *) log "nothing is called $part"; exit 2 ;;
  esac
done
