#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds and runs all tests except those labelled slow; the last line is `N passed, N failed`.
#
#   utils/run_tests.sh          the optimised build, the debug build (bounds checks, floating-point traps) and, where
#                               PETSc is installed, the build for several processes
#   utils/run_tests.sh --slow   also the slow cases
#
# JOBS=<n> sets the number of parallel tests and compilers (default: the number of cores).
set -uo pipefail
cd "$(dirname "$0")/.."
case ${1:-} in
  "" | --slow) ;;
  *)
    sed -n '2,/^set/{/SPDX/d;/^#/s/^# \{0,1\}//p}' utils/run_tests.sh
    [ "$1" = --help ] || [ "$1" = -h ] && exit
    echo "error: unknown argument $1" >&2
    exit 2 ;;
esac
jobs=${JOBS:-$(nproc)}
passed=0
failed=0

# Counts the results of ctest: "98% tests passed, 1 tests failed out of 50".
run_tests() {
  local log=build/$1/tests.log run good=0 bad=1
  mkdir -p "build/$1"
  echo "== testing: $1"
  ctest --preset "$1" -j "$jobs" --no-tests=error >"$log" 2>&1
  sed -n '/tests passed/,$p' "$log"
  run=$(sed -n 's/.* tests failed out of \([0-9]*\)$/\1/p' "$log")
  if [ -n "$run" ]; then
    bad=$(sed -n 's/.* \([0-9]*\) tests failed out of .*/\1/p' "$log")
    good=$((run - bad))
  fi
  awk '/ Start +[0-9]+:| Passed /{show=0} /\*\*\*/{show=1} /tests passed/{exit} show' "$log"
  passed=$((passed + good))
  failed=$((failed + bad))
}

# Configures (with the options after the preset) and builds; a failed build counts as a failed test.
build() {
  echo "== building: $1"
  mkdir -p "build/$1"
  if ! { cmake --preset "$@" && cmake --build --preset "$1" -j "$jobs"; } >"build/$1/build.log" 2>&1; then
    tail -n 60 "build/$1/build.log"
    failed=$((failed + 1))
    return 1
  fi
}

finish() {
  echo "$passed passed, $failed failed"
  [ "$failed" -eq 0 ]
  exit
}

utils/install_needed.sh || { failed=1; finish; }
build release && run_tests release
build debug -DDD3_WARNINGS_ARE_ERRORS=ON && run_tests debug
if pkg-config --exists PETSc; then
  build petsc && run_tests petsc
fi
if [ "${1:-}" = --slow ]; then
  run_tests slow
fi
finish
