#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The command dd3 of the Python environment that install_needed.sh makes beside this folder.
here=$(dirname "$(realpath "$0")")
if [ ! -x "$here/../.venv/bin/dd3" ]; then
  echo "error: there is no Python environment; $here/install_needed.sh makes it" >&2
  exit 2
fi
exec "$here/../.venv/bin/dd3" "$@"
