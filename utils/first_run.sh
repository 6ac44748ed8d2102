#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From a clone to the first result: installs what is missing, builds, runs the bending test with and without the limit
# on the contact forces, draws its curve, the sheet, and the size of the increments of both runs.
#
#   utils/first_run.sh          no arguments but --help
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
  sed -n '2,/^set/{/SPDX/d;/^#/s/^# \{0,1\}//p}' utils/first_run.sh
  [ "$1" = --help ] || [ "$1" = -h ] && exit
  echo "error: unknown argument $1" >&2
  exit 2
fi

utils/install_needed.sh
echo "== building"
cmake --preset release >build-release.log 2>&1 || { cat build-release.log; exit 1; }
cmake --build --preset release --target dd3imp dd3laws dd3imp_modules >>build-release.log 2>&1 ||
  { tail -n 60 build-release.log; exit 1; }
mkdir -p build && mv build-release.log build/release/build.log

echo "== running input_files/bending/bending.dat, and beside it without the limit on the contact forces"
result=$PWD/bending.out
without=$PWD/bending_without.out
# A thread each: the mesh is too small for more.
build/release/dd3imp --quiet --threads 1 --set force=off --output "$without" input_files/bending/bending.dat &
second=$!
trap 'kill "$second" 2>/dev/null || true' EXIT
code=0
build/release/dd3imp --threads 1 --output "$result" input_files/bending/bending.dat || code=$?
# 3: stopped before its end; the results up to there are complete.
[ "$code" -eq 0 ] || [ "$code" -eq 3 ] || exit "$code"
other=0
wait "$second" || other=$?
trap - EXIT
[ "$other" -eq 0 ] || [ "$other" -eq 3 ] || exit "$other"

echo "== drawing"
.venv/bin/dd3 plot force --output "$result/force.png" "$result"
.venv/bin/dd3 plot sheet --output "$result/sheet.png" "$result"
.venv/bin/dd3 plot increments --output "$result/increments.png" \
  --label "limit on the contact forces, c = d = e = 1" --label "without this limit" "$result" "$without"
echo
echo "punch force against displacement: $result/force.png"
echo "deformed sheet and tools:         $result/sheet.png (coarse mesh; the fine one is fine.dat, 20 s)"
echo "increments and their limiters:    $result/increments.png"
echo "for ParaView:                     $result/fields.vtkhdf"
exit "$code"
