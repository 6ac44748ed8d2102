#!/usr/bin/env bash
# The bending study of docs/reports/bending_study.md: installs what is missing, builds, runs every case of
# input_files/bending_study/cases.csv on all cores, gathers bending_study.out/results.csv and draws the figures. After
# an interruption the same command continues; finished cases are not repeated.
#
#   utils/study.sh                       all cases
#   utils/study.sh --quick               the four cases of quick.csv, to 5 mm, into bending_study_quick.out
#   utils/study.sh --sets "fig3 fig6"    selected sets of cases
#
#   --cores N       runs at a time (default: the number of cores)
#   --work DIR      folder of the results
#   --program FILE  an existing program; nothing is built
#   -- ...          further options of snakemake, such as --dry-run or --profile utils/study_slurm
set -euo pipefail
from=$PWD
cd "$(dirname "$0")/.."
self=utils/$(basename "$0")
cores=$(nproc) sets="" work="" program="" quick=no
usage() { sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$self"; }
fail() { echo "error: $*" >&2; exit 2; }
while [ $# -gt 0 ]; do
  case $1 in
    --cores | --sets | --work | --program) [ $# -gt 1 ] || fail "$1 needs a value" ;;
  esac
  case $1 in
    --cores) cores=$2; shift 2 ;;
    --sets) sets=$2; shift 2 ;;
    --work) work=$2; shift 2 ;;
    --program)
      program=$(cd "$from" && command -v "$2") || fail "$2: no such program"
      program=$(cd "$from" && realpath "$program")
      shift 2 ;;
    --quick) quick=yes; shift ;;
    --) shift; break ;;
    -h | --help) usage; exit ;;
    *) usage >&2; fail "unknown argument $1" ;;
  esac
done
[[ $cores =~ ^([1-9][0-9]*|all)$ ]] || fail "--cores takes a number, not $cores"

python=${PYTHON:-.venv/bin/python}
if ! "$python" -c "import snakemake, matplotlib" 2>/dev/null; then
  utils/install_needed.sh
  "$python" -c "import snakemake" 2>/dev/null || {
    echo "== installing the workflow engine of utils/requirements-study.txt into .venv"
    "$python" -m pip install -q --disable-pip-version-check -r utils/requirements-study.txt
  }
fi
if [ -z "$program" ]; then
  echo "== building"
  mkdir -p build/release
  { cmake --preset release && cmake --build --preset release --target dd3imp; } >build/release/build.log 2>&1 ||
    { tail -n 60 build/release/build.log; exit 1; }
  program=$PWD/build/release/dd3imp
fi

settings="python=$(realpath -s "$python") program=$program"
if [ $quick = yes ]; then
  work=${work:-bending_study_quick.out}
  set -- --config $settings "cases=$PWD/input_files/bending_study/quick.csv" figures=no "$@"
else
  work=${work:-bending_study.out}
  set -- --config $settings "sets=$sets" "$@"
fi
mkdir -p "$work"
# Unlike snakemake's lock this one is released when the process is killed.
exec 9>"$work/.lock"
flock --nonblock 9 || { echo "error: another study.sh is running in $work" >&2; exit 1; }
found=("$work"/*/done.json)
[ -e "${found[0]}" ] || found=()
echo "== ${#found[@]} cases are done in $work; running the others"
exec "$python" -m snakemake --snakefile utils/study.smk --directory "$work" --cores "$cores" --keep-going --nolock \
  --rerun-incomplete --rerun-triggers mtime params input --quiet all "$@"
