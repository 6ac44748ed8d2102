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
