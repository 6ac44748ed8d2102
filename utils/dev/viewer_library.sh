#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes utils/dd3/viewer/library.min.js, the parts of three.js and Chart.js that utils/dd3/viewer/viewer.js uses, in one
# file for the pages of `dd3 report`. Needs npm. After a change of the versions below, change those in
# utils/dd3/viewer/library.LICENSES.txt, and run the test utils_viewer.
#
# The file is kept in the repository: users install the package by pip, without npm, and no package of PyPI has a current
# three.js that a page can use (pythreejs: that of 2018; k3d, plotly: inside a library of 2.6 and 4.8 MB).
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
