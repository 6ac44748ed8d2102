#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing to build and run dd3imp: compiler, libraries, and the Python environment .venv with
# the utilities. Needs root only if a package is missing. Not installed: libmumps-seq-dev, the optional linear solver.
#
#   utils/install_needed.sh              all of it
#   utils/install_needed.sh --no-python  without .venv
#   utils/install_needed.sh --browser    also what the tests use beside it: chromium, ruff, mypy, fortitude, codespell
#   utils/install_needed.sh --help       this text; nothing is installed
set -euo pipefail
cd -P "$(dirname "$0")/.."
usage() { sed -n '2,/^set/{/SPDX/d;/^#/s/^# \{0,1\}//p}' utils/install_needed.sh; }
case "$*" in
  "" | --no-python | --browser) ;;
  --help | -h) usage; exit ;;
  *)
    usage >&2
    echo "error: unknown argument $*" >&2
    exit 2 ;;
esac

packages=(gfortran gcc libc6-dev cmake ninja-build pkg-config libopenblas-dev libsuitesparse-dev libmetis-dev
  libhdf5-dev python3 python3-venv python3-pip libegl1 libgl1 libgl1-mesa-dri libglu1-mesa libgomp1 libxcursor1 libxft2
  libxinerama1 libxrender1)

[ "${1:-}" != --browser ] || packages+=(chromium)

install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    echo "This is not Debian or Ubuntu: install the equivalents of these packages: ${packages[*]}"
    return
  fi
  local missing=() package
  for package in "${packages[@]}"; do
    dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null | grep -q '^ii' || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "== installing ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "error: root is needed for: apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -q >/dev/null
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
    "${missing[@]}" >/dev/null
}

# What the package needs is installed, with its commands, and the sources are put on the path of Python: their changes
# need no further installation. The environment is created again if the requirements have changed.
install_python() {
  local python=/usr/bin/python3 extras=test wanted found
  [ -x "$python" ] || python=python3
  [ "${1:-}" != --browser ] || extras=test,dev
  wanted=$(cksum <pyproject.toml)
  found=$(cat .venv/pyproject.cksum 2>/dev/null) || found=
  [ "$found" = "$wanted $extras" ] || [ "$found" = "$wanted test,dev" ] && return 0
  echo "== installing what the Python package utils/dd3 needs into .venv"
  if [ "$found" != "$wanted test" ]; then
    rm -rf .venv
    "$python" -m venv .venv
  fi
  DD3_CLONE=1 .venv/bin/pip install -q --disable-pip-version-check ".[$extras]"
  echo "$PWD/utils" >"$(.venv/bin/python3 -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/dd3.pth"
  echo "$wanted $extras" >.venv/pyproject.cksum
}

install_packages
[ "${1:-}" = --no-python ] || install_python "$@"
