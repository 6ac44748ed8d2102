// SPDX-License-Identifier: GPL-3.0-or-later
// The bodies of the 3D view: meshes of the sheet, and tools.
"use strict";

const TOOL_COLOURS = [0x8d99a6, 0xa69b8d, 0x93a68d, 0xa08da6];
const RIM = 2; // sides of a skin
const UPPER = 1;

const numbers = (values, size) => new library.BufferAttribute(new Float32Array(values), size);
const indices = (values) => new library.BufferAttribute(new Uint32Array(values), 1);
const geometryOf = (position, index) => new library.BufferGeometry().setAttribute("position", position).setIndex(index);

// Return the places of vertices, of which each is a place in arrays of x, y and z.
function positions(arrays, places) {
  const out = new Float32Array(3 * places.length);
  for (let i = 0; i < places.length; i++) for (let k = 0; k < 3; k++) out[3 * i + k] = arrays[k][places[i]];
  return out;
}

// Read a mesh of the scene: its arrays, and geometries with the normals of its nodes (smooth), with three vertices of its
// own for each triangle, which has one colour (split), and of its lines.
async function openMesh(described) {
  const names = ["nodes", "places", "triangles", "elements", "owners", "sides", "edges"];
  const arrays = await readAll(names.map((name) => described[name]));
  const mesh = Object.fromEntries(names.map((name, i) => [name, arrays[i]]));
  const position = numbers(3 * mesh.places.length, 3);
  mesh.smooth = geometryOf(position, indices(mesh.triangles)).setAttribute("uv", numbers(2 * mesh.places.length, 2));
  mesh.lines = geometryOf(position, indices(mesh.edges));
  mesh.split = new library.BufferGeometry();
  for (const [name, size] of Object.entries({ position: 3, normal: 3, uv: 2 })) {
    mesh.split.setAttribute(name, numbers(size * mesh.triangles.length, size));
  }
  return mesh;
}

// Move the nodes of a mesh.
function moveMesh(mesh, points) {
  const position = mesh.smooth.getAttribute("position");
  position.array.set(positions(points, mesh.places));
  position.needsUpdate = true;
  mesh.smooth.computeVertexNormals();
  mesh.smooth.computeBoundingSphere();
  mesh.lines.boundingSphere = mesh.smooth.boundingSphere;
}

// Set the colours of a mesh, and return its geometry with one for each vertex or for each triangle.
function paint(mesh, field, values, shown) {
  const factor = field.percent ? 100 : 1;
  const place = (value) => (factor * value - shown.low) / (shown.high - shown.low);
  if (!field.elements && !field.names) {
    const uv = mesh.smooth.getAttribute("uv");
    for (let i = 0; i < mesh.places.length; i++) uv.array[2 * i] = place(values[mesh.places[i]]);
    uv.needsUpdate = true;
    return mesh.smooth;
  }
  const { position, normal, uv } = mesh.split.attributes;
  const from = mesh.smooth.attributes;
  for (let i = 0; i < mesh.triangles.length; i++) {
    for (let k = 0; k < 3; k++) {
      position.array[3 * i + k] = from.position.array[3 * mesh.triangles[i] + k];
      normal.array[3 * i + k] = from.normal.array[3 * mesh.triangles[i] + k];
    }
    if (i % 3 === 0) uv.array[2 * i] = place(valueOfTriangle(mesh, field, values, i / 3));
    else uv.array[2 * i] = uv.array[2 * (i - 1)];
  }
  for (const attribute of [position, normal, uv]) attribute.needsUpdate = true;
  mesh.split.computeBoundingSphere();
  return mesh.split;
}

// Return the sign of a field in an image with the signs of its axes.
const signOf = (field, sign) => (field.odd ?? []).reduce((product, axis) => product * sign["xyz".indexOf(axis)], 1);

// Return a painted geometry with the colours of its values with the other sign.
function oppositeOf(geometry, { low, high }) {
  const { array } = geometry.getAttribute("uv");
  geometry.opposite ??= new library.BufferGeometry().setAttribute("uv", numbers(array.length, 2));
  const { opposite } = geometry;
  for (const name of ["position", "normal"]) opposite.setAttribute(name, geometry.getAttribute(name));
  opposite.setIndex(geometry.getIndex());
  const uv = opposite.getAttribute("uv");
  for (let i = 0; i < array.length; i += 2) uv.array[i] = -array[i] - (2 * low) / (high - low);
  uv.needsUpdate = true;
  opposite.boundingSphere = geometry.boundingSphere;
  return opposite;
}

// A triangle has the value of its element, or of names at the nodes the largest of its nodes.
function valueOfTriangle(mesh, field, values, triangle) {
  if (field.elements) return values[mesh.owners[triangle]];
  return Math.max(...[0, 1, 2].map((k) => values[mesh.places[mesh.triangles[3 * triangle + k]]]));
}

// Read a tool of the scene and add it to the stage; `bar`: texture of the colours.
async function openTool(tool, number, stage, bar, show) {
  const [triangles, edges, ...points] = await readAll([
    tool.triangles,
    tool.edges,
    ...tool.points,
    ...tool.edge_points,
  ]);
  const all = (arrays) =>
    numbers(
      positions(
        arrays,
        arrays[0].map((_, i) => i),
      ),
      3,
    );
  const skin = geometryOf(all(points.slice(0, 3)), indices(triangles));
  const net = geometryOf(all(points.slice(3)), indices(edges));
  skin.computeVertexNormals();
  const { Mesh, LineSegments, MeshLambertMaterial, DoubleSide } = library;
  const colour = TOOL_COLOURS[number % TOOL_COLOURS.length];
  const glass = { color: colour, transparent: true, opacity: 0.35, side: DoubleSide, depthWrite: false };
  const surface = stage.cut(new MeshLambertMaterial(glass));
  const edge = stage.cut(new library.LineBasicMaterial({ color: 0x555555, transparent: true, opacity: 0.5 }));
  const touched = stage.cut(new MeshLambertMaterial({ map: bar, side: DoubleSide }));
  const objects = [
    ...stage.inImages(() => new Mesh(skin, surface)),
    ...stage.inImages(() => new LineSegments(net, edge)),
  ];
  for (const object of objects) object.matrixAutoUpdate = false;
  const prints = stage.inImages(() => new Mesh(new library.BufferGeometry(), touched));
  const box = addBox(`tool_${tool.name}`, tool.name.replaceAll("_", " "), show);
  return { ...tool, colour, objects, prints, box, skin, matrix: new library.Matrix4() };
}

// Add a check box for a tool, which is hidden at first: it covers the part.
function addBox(name, text, show) {
  const label = document.createElement("label");
  const box = document.createElement("input");
  Object.assign(box, { type: "checkbox", id: name, onchange: show });
  label.append(box, ` ${text}`);
  element("tools").append(label);
  return box;
}

// Move a tool to its place at a step. The pressure on it is that of the faces of the sheet that touch it, in the colours
// of the field; `touching`: the tool that each node touches, null where the pressure is not shown.
function placeTool(tool, step, mesh, touching) {
  const acts = step.active.includes(tool.name) || element("released").checked;
  tool.visible = tool.box.checked && !!step.placed[tool.name] && acts;
  if (step.placed[tool.name]) tool.matrix.fromArray(step.placed[tool.name]);
  for (const object of tool.objects) {
    object.visible = tool.visible;
    object.matrix.copy(tool.matrix);
  }
  for (const object of tool.prints) object.visible = !!touching && tool.visible;
  if (!touching || !tool.visible) return;
  const index = [];
  for (let t = 0; t < mesh.triangles.length; t += 3) {
    const corners = mesh.triangles.slice(t, t + 3);
    const touches = corners.some((vertex) => touching[mesh.places[vertex]] === tool.number);
    if (mesh.sides[t / 3] !== RIM && touches) index.push(...corners);
  }
  const geometry = new library.BufferGeometry().setIndex(index);
  for (const name of ["position", "normal", "uv"]) geometry.setAttribute(name, mesh.smooth.getAttribute(name));
  for (const object of tool.prints) object.geometry = geometry;
}
