// SPDX-License-Identifier: GPL-3.0-or-later
// The forming limit diagram of a step: its points, and the curve.
"use strict";

const MOST_POINTS = 5000; // of nodes and of elements, above the curve and below it

// Return the sets of a chart, and whether a part of the points was left out; keeps the strains of the nodes in `state`.
async function limitSets(scene, state) {
  const roleField = (role, elements) =>
    scene.fields.find((field) => field.role === role && field.elements === elements);
  const curve = scene.limit,
    sets = [],
    zones = roleField("zone", false),
    groups = new Map();
  let thinned = false;
  for (const elements of [false, true]) {
    const fields = ["minor", "major", "zone"].map((role) => roleField(role, elements));
    const arrays = fields.map((field) => field?.values[state.step]);
    if (!arrays[0]) continue;
    const [minor, major, zone] = await Promise.all(arrays.map((array) => array && read(array)));
    if (!elements) state.strains = [minor, major];
    // Of many points each k-th is drawn, apart for those above the curve.
    const above = (i) => zone && zones.names[zone[i]] === "critical",
      counts = [0, 0],
      seen = [0, 0];
    for (let i = 0; i < minor.length; i++) counts[+above(i)]++;
    const skip = counts.map((count) => Math.max(1, Math.ceil(count / MOST_POINTS)));
    thinned ||= Math.max(...skip) > 1;
    for (let i = 0; i < minor.length; i++) {
      const kind = +above(i),
        of = zone ? zone[i] : 0,
        name = `${elements} ${of}`;
      if (seen[kind]++ % skip[kind]) continue;
      if (!groups.has(name)) groups.set(name, { elements, of, data: [] });
      groups.get(name).data.push({ x: minor[i], y: major[i], i, elements });
    }
  }
  for (const { elements, of, data } of [...groups.values()].sort((one, other) => one.of - other.of)) {
    const colour = zones ? zones.colours[of] : "#666666",
      name = zones ? zones.names[of] : elements ? "elements" : "nodes";
    sets.push({
      label: (zones && elements ? "_" : "") + name,
      data,
      borderColor: colour,
      backgroundColor: colour,
      pointStyle: elements ? "rectRot" : "circle",
      pointRadius: 2,
      pointBorderWidth: 0,
      pointHitRadius: 4,
    });
  }
  if (curve.minor.length) {
    const low = Math.min(-0.3, ...sets.map((set) => set.data.reduce((a, p) => Math.min(a, p.x), 0)));
    const high = Math.max(0.3, ...sets.map((set) => set.data.reduce((a, p) => Math.max(a, p.x), 0)));
    const points = (shift) =>
      curve.minor.map((x, i) => ({ x, y: curve.major[i] - shift })).filter(({ x }) => x >= low && x <= high);
    sets.unshift(lineSet(curve.label, "#222222", points(0), 1.6), {
      ...lineSet("marginal", "#222222", points(curve.margin), 1),
      borderDash: [5, 4],
    });
  }
  return { sets, thinned };
}

class LimitDiagram {
  constructor(viewer) {
    this.viewer = viewer;
    const titles = ["minor strain (logarithmic)", "major strain (logarithmic)"];
    const hover = (found) => this.markPoint(found && this.chart.data.datasets[found.datasetIndex].data[found.index]);
    this.chart = newChart(element("limit_chart"), ...titles, { tell: (item) => this.tell(item), hover });
  }

  async update() {
    const { scene, state } = this.viewer;
    const { sets, thinned } = await limitSets(scene, state);
    const ring = { pointRadius: 7, pointStyle: "circle", borderColor: "#cc0066", borderWidth: 2 };
    this.chart.data.datasets = [{ label: "_marked", data: [], backgroundColor: "transparent", ...ring }, ...sets];
    this.chart.update();
    const part = thinned ? ", a part of them" : "";
    const none = scene.limit.minor.length ? "" : ` No curve: ${scene.limit.label}.`;
    element("limit_help").textContent =
      `Dots: nodes; diamonds: elements${part}; logarithmic strains at the middle of the sheet.${none} ` +
      "A point under the mouse is marked on the sheet, and the other way round.";
  }

  tell({ raw, dataset }) {
    const { mesh } = this.viewer.state;
    const name = raw.elements ? "element" : "node";
    const point = "i" in raw ? `${name} ${(raw.elements ? mesh.elements : mesh.nodes)[raw.i]}: ` : named(dataset);
    return `${point}${round(raw.x)}, ${round(raw.y)}`;
  }

  // Mark a node in the diagram, by its place in the arrays.
  markNode(place) {
    const { strains } = this.viewer.state;
    const known = place !== null && strains;
    this.chart.data.datasets[0].data = known ? [{ x: strains[0][place], y: strains[1][place] }] : [];
    this.chart.update("none");
  }

  // Mark the node or the element of a point of the diagram on the sheet.
  markPoint(point) {
    const { points } = this.viewer.state;
    const node = (i) => [0, 1, 2].map((k) => points[k][i]);
    const known = point && "i" in point;
    this.viewer.stage.markAt(known ? (point.elements ? this.centreOf(point.i) : node(point.i)) : null);
  }

  // Return the mean place of the corners of the outer triangles of an element.
  centreOf(owner) {
    const { mesh, points } = this.viewer.state;
    const places = [];
    mesh.owners.forEach((one, t) => {
      if (one === owner) places.push(...mesh.triangles.slice(3 * t, 3 * t + 3));
    });
    return points.map((axis) => places.reduce((sum, vertex) => sum + axis[mesh.places[vertex]], 0) / places.length);
  }
}
