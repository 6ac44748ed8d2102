#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the site of the documents into build/site/html, with search, formulas and the interface of the sources, in a
# Python environment of its own, build/site/venv. Warnings are errors, such as a link that leads nowhere. The pages load
# nothing from other hosts.
#
#   utils/dev/site.sh           no arguments but --help
set -euo pipefail
cd -P "$(dirname "$0")/../.."
if [ $# -gt 0 ]; then
  sed -n '2,/^set/{/SPDX/d;/^#/s/^# \{0,1\}//p}' utils/dev/site.sh
  [ "$1" = --help ] || [ "$1" = -h ] && exit
  echo "error: unknown argument $1" >&2
  exit 2
fi

work=build/site
wanted=$(cksum <utils/dev/site/requirements.txt)
if [ "$(cat $work/venv/requirements.cksum 2>/dev/null)" != "$wanted" ]; then
  rm -rf $work/venv
  mkdir -p $work
  python3 -m venv $work/venv
  $work/venv/bin/pip install -q --disable-pip-version-check --requirement utils/dev/site/requirements.txt
  echo "$wanted" >$work/venv/requirements.cksum
fi
$work/venv/bin/python3 utils/dev/site/site.py --work $work
