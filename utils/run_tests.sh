#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds and runs the tests; the last line is `N passed, N failed`.
#
#   utils/run_tests.sh          the optimised build, the debug build (bounds checks, floating-point traps) and, where
#                               PETSc is installed, the build for several processes; of the slow tests a part that takes
#                               five minutes at most, chosen by the hash of the commit
#   utils/run_tests.sh --slow   all slow tests
#
# A run that leaves files which git shows, or files fort.* anywhere, has a failed test `files_left`.
#
# JOBS=<n> sets the number of parallel tests and compilers (default: the number of cores). Unless OMP_NUM_THREADS is set,
# they share the cores: more threads of the optimised program than cores wait for one another.
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
threads=${OMP_NUM_THREADS:-$((jobs < $(nproc) ? $(nproc) / jobs : 1))}
passed=0
failed=0

# Counts the results of ctest: "98% tests passed, 1 tests failed out of 50".
run_tests() {
  local log=build/$1/tests.log run good=0 bad=1
  mkdir -p "build/$1"
  echo "== testing: $*"
  ctest --preset "$@" -j "$jobs" --no-tests=error >"$log" 2>&1
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

# Whether the folder is the top of a git checkout, not one inside another.
is_checkout() {
  [ -e .git ] && git rev-parse --git-dir >/dev/null 2>&1
}

# Prints a pattern of the parts of the slow tests that are left out: all but the one that the hash of the commit chooses,
# part_0 without git. case_file.py makes the parts.
parts_left_out() {
  local parts commit chosen i left=()
  parts=$(ctest --preset slow --print-labels | grep -c '^  part_')
  commit=$(is_checkout && git rev-parse HEAD) || commit=0
  chosen=$((16#${commit:0:8} % (parts > 0 ? parts : 1)))
  for ((i = 0; i < parts; i++)); do
    [ "$i" -eq "$chosen" ] || left+=("part_$i")
  done
  (IFS='|'; echo "^(${left[*]:-none})\$")
}

# Runs the tests of the optimised build with a part of the slow ones.
run_part() {
  local left
  left=$(parts_left_out)
  echo "== slow tests that do not run"
  ctest --preset slow -N -L "$left" | grep ' Test '
  run_tests all -LE "$left"
}

# Prints what git shows as changed or new, and the files fort.*, to which Fortran writes a unit without a name and which
# git ignores.
list_files() {
  if is_checkout; then
    git status --porcelain --untracked-files=all
  fi
  find . \( -path ./build -o -path ./.git -o -path ./.venv \) -prune -o -name 'fort.*' -exec cksum {} +
}

# Counts one test: the list of files has no line that it had not before.
check_files() {
  local left
  left=$(comm -13 <(sort <<<"$files_before") <(list_files | sort))
  if [ -z "$left" ]; then
    passed=$((passed + 1))
    return
  fi
  failed=$((failed + 1))
  echo "== failed: files_left, the run left or changed these files"
  echo "$left"
}

finish() {
  echo "$passed passed, $failed failed"
  [ "$failed" -eq 0 ]
  exit
}

files_before=$(list_files)
utils/install_needed.sh --browser || { failed=1; finish; }
if [ "${1:-}" = --slow ]; then
  build release && OMP_NUM_THREADS=$threads run_tests all
else
  build release && OMP_NUM_THREADS=$threads run_part
fi
build debug -DDD3_WARNINGS_ARE_ERRORS=ON && run_tests debug
if pkg-config --exists PETSc; then
  if [ "${1:-}" = --slow ]; then
    build petsc && run_tests petsc
  else
    build petsc && run_tests petsc -LE slow
  fi
fi
check_files
finish
