#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes utils/dd3/viewer/library.min.js, the parts of three.js and Chart.js that the pages of `dd3 report` use, in one
# file. Needs npm:
#
#   utils/dev/viewer_library.sh
#
# After a change of the versions below, change those in
# utils/dd3/viewer/library.LICENSES.txt, and run the test utils_viewer.
#
# The file is kept in the repository: users install the package by pip, without npm, and no package of PyPI has a current
# three.js that a page can use (pythreejs: that of 2018; k3d: inside a library of 2.6 MB). Sheets of 1000, 20000 and
# 100000 elements at 10 steps with one field, in a browser without a graphics card, on 2026-11-28:
#
#   library                file, MB           to load, s         next step, ms
#   three.js 0.187         0.6, 1.5, 6.4      1.2, 0.9, 3.0      53, 215, 816
#   k3d 3.2                1.4, 6.0, 26.6     5.7, 7.8, 9.9      123, 178, 980
#   plotly                 5.2, 11.3, 36.9    4.7, 4.7, 9.7      625, 1232, 4383
#
# pyvista writes pages of vtk.js with one step (1.1, 2.3, 7.3 MB), to which no controls can be added.
set -euo pipefail
cd -P "$(dirname "$0")/../.."
case "$*" in
  "") ;;
  *)
    sed -n '2,/^set/{/SPDX/d;/^#/s/^# \{0,1\}//p}' utils/dev/viewer_library.sh
    [ "$*" = --help ] && exit
    echo "error: unknown argument $*" >&2
    exit 2 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$work" && npm init -y >/dev/null && npm install --silent three@0.187.0 chart.js@4.6.1 esbuild@0.28.2)
cat >"$work/library.js" <<'END'
export {
  BufferAttribute, BufferGeometry, Color, DataTexture, DirectionalLight, DoubleSide, Group, HemisphereLight,
  LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, OrthographicCamera, Plane,
  Raycaster, Scene, SphereGeometry, SRGBColorSpace, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
export { Chart, Legend, LinearScale, LineElement, PointElement, ScatterController, Tooltip } from "chart.js";
END
"$work/node_modules/.bin/esbuild" "$work/library.js" --bundle --minify --format=iife --global-name=library \
  --target=es2020 --legal-comments=inline --outfile=utils/dd3/viewer/library.min.js
