// SPDX-License-Identifier: GPL-3.0-or-later
// The 3D view of a page: the scene of scene.py, drawn by three.js, with its controls and its charts.
"use strict";
const { Vector3 } = library;

const TOOL_COLOURS = [0x8d99a6, 0xa69b8d, 0x93a68d, 0xa08da6];
const DIRECTIONS = {
  iso: [-0.9, -1.6, 0.9],
  front: [0, -1, 0],
  side: [-1, 0, 0],
  top: [0, -1e-4, 1],
  below: [-0.9, -1.6, -0.9],
};
const RIM = 2,
  UPPER = 1; // sides of a skin

async function openViewer(scene) {
  const { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial } =
    library;
  const view = element("view"),
    renderer = new library.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  renderer.localClippingEnabled = true;
  view.prepend(renderer.domElement);
  const world = new library.Scene(),
    camera = new library.OrthographicCamera(-1, 1, 1, -1, -1e4, 1e4);
  world.background = new library.Color("white");
  camera.up.set(0, 0, 1);
  const lamp = new library.DirectionalLight(0xffffff, 1.6);
  camera.add(lamp);
  lamp.position.set(0.3, 0.5, 1);
  world.add(camera, new library.HemisphereLight(0xffffff, 0xd8dce0, 2.0));
  const orbit = new library.OrbitControls(camera, renderer.domElement);
  const plane = new library.Plane(new Vector3(0, 1, 0), 0);
  const state = { step: scene.steps.findLastIndex((step) => !step.free), field: 0, values: null, mesh: null };

  // Groups of the images of the model: one for each product of reflections.
  const signs = scene.mirror.reduce(
    (all, axis) => all.concat(all.map((sign) => sign.map((value, i) => ("xyz"[i] === axis ? -value : value)))),
    [[1, 1, 1]],
  );
  const images = signs.map((sign) => {
    const group = new Group();
    group.scale.set(...sign);
    world.add(group);
    return group;
  });
  const shownImages = () => (element("mirror").checked ? images : images.slice(0, 1));

  // Objects that all images show share geometry and material.
  function inImages(make) {
    return images.map((group) => {
      const object = make();
      group.add(object);
      return object;
    });
  }
  const clipped = (material) => {
    materials.push(material);
    return material;
  };
  const materials = [];
  const bar = new library.DataTexture(new Uint8Array(4 * 256), 256, 1);
  bar.colorSpace = library.SRGBColorSpace;
  const pushed = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
  const coloured = clipped(new MeshLambertMaterial({ map: bar, side: library.DoubleSide, ...pushed }));
  const dark = clipped(new LineBasicMaterial({ color: 0x333333, transparent: true, opacity: 0.55 }));
  const empty = new BufferGeometry();
  const sheets = inImages(() => new Mesh(empty, coloured)),
    lines = inImages(() => new LineSegments(empty, dark));
  const ghostly = clipped(new LineBasicMaterial({ color: 0x0072b2, transparent: true, opacity: 0.6 }));
  const ghosts = inImages(() => new LineSegments(empty, ghostly));
  const onTop = (color) => new LineBasicMaterial({ color, depthTest: false, transparent: true });
  const sectionLine = new LineSegments(new BufferGeometry(), onTop(0xd55e00));
  sectionLine.renderOrder = 3;
  world.add(sectionLine);
  const beadLine = onTop(0xc0392b);
  for (const points of scene.beads) {
    const parts = points.slice(1).flatMap((point, i) => [...points[i], ...point]);
    const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(parts), 3));
    inImages(() => new LineSegments(geometry, beadLine));
  }
  const mark = new Mesh(
    new library.SphereGeometry(1, 16, 12),
    new library.MeshBasicMaterial({ color: 0xcc0066, depthTest: false, transparent: true }),
  );
  mark.renderOrder = 4;
  mark.visible = false;
  world.add(mark);

  const positions = (arrays, places) => {
    const out = new Float32Array(3 * places.length);
    for (let i = 0; i < places.length; i++) for (let k = 0; k < 3; k++) out[3 * i + k] = arrays[k][places[i]];
    return out;
  };

  // ---- meshes and tools ----
  const meshes = new Map();
  async function openMesh(number) {
    if (!meshes.has(number)) {
      const names = ["nodes", "places", "triangles", "elements", "owners", "sides", "edges"];
      const parts = await readAll(names.map((name) => scene.meshes[number][name]));
      const mesh = Object.fromEntries(names.map((name, i) => [name, parts[i]]));
      const attribute = (count, size) => new BufferAttribute(new Float32Array(count * size), size);
      mesh.smooth = new BufferGeometry()
        .setIndex(new BufferAttribute(new Uint32Array(mesh.triangles), 1))
        .setAttribute("position", attribute(mesh.places.length, 3))
        .setAttribute("uv", attribute(mesh.places.length, 2));
      mesh.split = new BufferGeometry(); // three vertices of its own for each triangle, for one colour each
      for (const [name, size] of [
        ["position", 3],
        ["normal", 3],
        ["uv", 2],
      ]) {
        mesh.split.setAttribute(name, attribute(mesh.triangles.length, size));
      }
      mesh.lines = new BufferGeometry()
        .setIndex(new BufferAttribute(new Uint32Array(mesh.edges), 1))
        .setAttribute("position", mesh.smooth.getAttribute("position"));
      meshes.set(number, mesh);
    }
    return meshes.get(number);
  }
  const tools = [];
  for (const [i, tool] of scene.tools.entries()) {
    const [triangles, edges, ...points] = await readAll([
      tool.triangles,
      tool.edges,
      ...tool.points,
      ...tool.edge_points,
    ]);
    const all = (arrays) =>
      positions(
        arrays,
        Array.from({ length: arrays[0].length }, (_, k) => k),
      );
    const skin = new BufferGeometry()
      .setIndex(new BufferAttribute(new Uint32Array(triangles), 1))
      .setAttribute("position", new BufferAttribute(all(points.slice(0, 3)), 3));
    const net = new BufferGeometry()
      .setIndex(new BufferAttribute(new Uint32Array(edges), 1))
      .setAttribute("position", new BufferAttribute(all(points.slice(3)), 3));
    skin.computeVertexNormals();
    const material = clipped(
      new MeshLambertMaterial({
        color: TOOL_COLOURS[i % TOOL_COLOURS.length],
        transparent: true,
        opacity: 0.35,
        side: library.DoubleSide,
        depthWrite: false,
      }),
    );
    const edge = clipped(new LineBasicMaterial({ color: 0x555555, transparent: true, opacity: 0.5 }));
    const label = document.createElement("label"),
      box = document.createElement("input");
    box.type = "checkbox";
    box.checked = true;
    box.id = `tool_${tool.name}`;
    box.onchange = show;
    label.append(box, ` ${tool.name.replaceAll("_", " ")}`);
    element("tools").append(label);
    const objects = [...inImages(() => new Mesh(skin, material)), ...inImages(() => new LineSegments(net, edge))];
    const touched = clipped(new MeshLambertMaterial({ map: bar, side: library.DoubleSide }));
    tools.push({
      ...tool,
      objects,
      box,
      skin,
      prints: inImages(() => new Mesh(empty, touched)),
      matrix: new library.Matrix4(),
    });
  }

  // Set the colours of the vertices, of a geometry with one value for each vertex or for each triangle.
  function paint(mesh, field, values, shown) {
    const factor = field.percent ? 100 : 1,
      place = (value) => (factor * value - shown.low) / (shown.high - shown.low);
    if (!field.elements && !field.names) {
      const uv = mesh.smooth.getAttribute("uv");
      for (let i = 0; i < mesh.places.length; i++) uv.array[2 * i] = place(values[mesh.places[i]]);
      uv.needsUpdate = true;
      return mesh.smooth;
    }
    const { position, normal, uv } = mesh.split.attributes,
      from = mesh.smooth.attributes;
    for (let i = 0; i < mesh.triangles.length; i++) {
      const vertex = mesh.triangles[i];
      for (let k = 0; k < 3; k++) {
        position.array[3 * i + k] = from.position.array[3 * vertex + k];
        normal.array[3 * i + k] = from.normal.array[3 * vertex + k];
      }
    }
    for (let t = 0; t < mesh.triangles.length / 3; t++) {
      const value = place(valueOfTriangle(mesh, field, values, t));
      for (let k = 0; k < 3; k++) uv.array[2 * (3 * t + k)] = value;
    }
    for (const attribute of [position, normal, uv]) attribute.needsUpdate = true;
    mesh.split.computeBoundingSphere();
    return mesh.split;
  }

  // A triangle has the value of its element, or of names at the nodes the largest of its nodes.
  function valueOfTriangle(mesh, field, values, triangle) {
    if (field.elements) return values[mesh.owners[triangle]];
    return Math.max(...[0, 1, 2].map((k) => values[mesh.places[mesh.triangles[3 * triangle + k]]]));
  }

  // ---- a step ----
  let wanted = 0;
  async function show() {
    const turn = ++wanted,
      step = scene.steps[state.step],
      field = scene.fields[state.field];
    const mesh = await openMesh(step.mesh),
      points = await readAll(step.points),
      array = field.values[state.step];
    const values = array ? await read(array) : null;
    const toolField = scene.fields.find((one) => one.name === "contact_tool" && !one.elements);
    const prints = element("pressure").checked && toolField ? await read(toolField.values[state.step]) : null;
    const drawn = step.free && scene.drawn ? await readAll(scene.drawn) : null;
    if (turn !== wanted) return;
    Object.assign(state, { mesh, points, values });
    const position = mesh.smooth.getAttribute("position");
    position.array.set(positions(points, mesh.places));
    position.needsUpdate = true;
    mesh.smooth.computeVertexNormals();
    mesh.smooth.computeBoundingSphere();
    mesh.lines.boundingSphere = mesh.smooth.boundingSphere;
    const shown = rangeOf(field, values);
    state.shown = shown;
    for (let i = 0; i < 256; i++)
      bar.image.data.set([...colourOf(scene.maps, field, shown, (i + 0.5) / 256), 255], 4 * i);
    bar.needsUpdate = true;
    coloured.color.set(values ? 0xffffff : 0xc8ccd0);
    if (!!coloured.map !== !!values) [coloured.map, coloured.needsUpdate] = [values ? bar : null, true];
    const geometry = values ? paint(mesh, field, values, shown) : mesh.smooth;
    for (const [i, object] of sheets.entries()) {
      Object.assign(object, { geometry, visible: element("sheet").checked });
      Object.assign(lines[i], { geometry: mesh.lines, visible: element("lines").checked && element("sheet").checked });
      ghosts[i].visible = !!drawn && element("drawn").checked;
    }
    if (drawn) {
      ghosts[0].geometry = new BufferGeometry()
        .setIndex(mesh.lines.getIndex())
        .setAttribute("position", new BufferAttribute(positions(drawn, mesh.places), 3));
      for (const ghost of ghosts) ghost.geometry = ghosts[0].geometry;
    }
    for (const tool of tools) placeTool(tool, step, mesh, prints);
    images.forEach((group, i) => {
      group.visible = i === 0 || element("mirror").checked;
    });
    drawLegend(scene.maps, field, shown);
    element("step").value = state.step;
    element("step_name").textContent = step.name + (values ? "" : "; the field is not known at this step");
    element("field_help").textContent = field.help;
    section();
    await limitDiagram();
    render();
  }

  function placeTool(tool, step, mesh, prints) {
    const acts = step.active.includes(tool.name) || element("released").checked;
    tool.visible = tool.box.checked && !!step.placed[tool.name] && acts;
    if (step.placed[tool.name]) tool.matrix.fromArray(step.placed[tool.name]);
    for (const object of tool.objects) {
      object.visible = tool.visible;
      object.matrixAutoUpdate = false;
      object.matrix.copy(tool.matrix);
    }
    // The pressure on a tool is that of the faces of the sheet which touch it, in the colours of the field.
    tool.prints.forEach((object) => {
      object.visible = !!prints && tool.visible;
    });
    if (!prints || !tool.visible) return;
    const index = [];
    for (let t = 0; t < mesh.triangles.length; t += 3) {
      const corners = [mesh.triangles[t], mesh.triangles[t + 1], mesh.triangles[t + 2]];
      if (mesh.sides[t / 3] !== RIM && corners.some((vertex) => prints[mesh.places[vertex]] === tool.number))
        index.push(...corners);
    }
    const geometry = new BufferGeometry()
      .setIndex(index)
      .setAttribute("position", mesh.smooth.getAttribute("position"))
      .setAttribute("normal", mesh.smooth.getAttribute("normal"))
      .setAttribute("uv", mesh.smooth.getAttribute("uv"));
    for (const object of tool.prints) object.geometry = geometry;
  }

  // ---- section ----
  function place() {
    const choice = element("normal").value,
      angle = choice === "turned" ? (Math.PI / 180) * parseFloat(element("angle").value || 0) : 0;
    const normal =
      choice === "turned" ? [-Math.sin(angle), Math.cos(angle), 0] : ["x", "y", "z"].map((axis) => +(axis === choice));
    const [low, high] = [box.min, box.max].map((corner) => corner.toArray());
    const reach = normal.reduce(
      ([a, b], n, i) => [a + Math.min(n * low[i], n * high[i]), b + Math.max(n * low[i], n * high[i])],
      [0, 0],
    );
    return { normal, distance: reach[0] + ((reach[1] - reach[0]) * element("offset").value) / 1000, choice };
  }

  function section() {
    const on = element("cut").checked,
      cut = place(),
      { mesh, values } = state;
    element("offset_value").textContent =
      `${{ turned: "distance" }[cut.choice] ?? cut.choice} = ${cut.distance.toFixed(2)} mm`;
    element("angle_label").hidden = cut.choice !== "turned";
    const half = element("other").checked ? 1 : -1; // the half that stays
    plane.normal.set(...cut.normal).multiplyScalar(half);
    plane.constant = -half * cut.distance;
    for (const material of materials) {
      if (!!material.clippingPlanes?.length !== on) material.needsUpdate = true;
      material.clippingPlanes = on ? [plane] : [];
    }
    for (const name of ["profile_box", "along_box"]) element(name).hidden = !on;
    sectionLine.visible = on;
    if (!on) return;
    const flat = ([x, y, z]) =>
      cut.choice === "z"
        ? { x, y }
        : cut.choice === "x"
          ? { x: y, y: z }
          : cut.choice === "y"
            ? { x, y: z }
            : { x: cut.normal[1] * x - cut.normal[0] * y, y: z };
    const gapped = (segments) =>
      segments.flatMap(({ ends }) => [
        ...ends.map((end) => ({ ...flat(end.point), at: end.point })),
        { x: NaN, y: NaN },
      ]);
    const own = [],
      upper = [],
      sets = [],
      at = mesh.smooth.getAttribute("position").array;
    const used = signs.slice(0, shownImages().length);
    for (const sign of used) {
      own.push(...cutOf(mesh.triangles, at, sign, cut, size));
      upper.push(...cutOf(mesh.triangles, at, sign, cut, size, (t) => mesh.sides[t] === UPPER));
    }
    sets.push(lineSet("sheet", "#0072b2", gapped(own), 1.6));
    if (ghosts[0].visible) {
      const drawnAt = ghosts[0].geometry.getAttribute("position").array;
      sets.push(
        lineSet(
          "drawn shape",
          "#d55e00",
          used.flatMap((sign) => gapped(cutOf(mesh.triangles, drawnAt, sign, cut, size))),
          1,
        ),
      );
    }
    for (const [i, tool] of tools.entries()) {
      if (!tool.visible) continue;
      const points = tool.skin.getAttribute("position").clone().applyMatrix4(tool.matrix).array;
      const colour = "#" + TOOL_COLOURS[i % TOOL_COLOURS.length].toString(16);
      sets.push(
        lineSet(
          tool.name,
          colour,
          used.flatMap((sign) => gapped(cutOf(tool.skin.getIndex().array, points, sign, cut, size))),
          1,
        ),
      );
    }
    const names = {
      x: ["y (mm)", "z (mm)"],
      y: ["x (mm)", "z (mm)"],
      z: ["x (mm)", "y (mm)"],
      turned: ["in the plane (mm)", "z (mm)"],
    }[cut.choice];
    [profile.options.scales.x.title.text, profile.options.scales.y.title.text] = names;
    profile.data.datasets = sets;
    profile.update();
    sectionLine.geometry.dispose();
    sectionLine.geometry = new BufferGeometry().setAttribute(
      "position",
      new BufferAttribute(new Float32Array(own.flatMap(({ ends }) => ends.flatMap((end) => end.point))), 3),
    );
    state.section = { own, upper };
    const field = scene.fields[state.field];
    along.options.scales.x.title.text = "length along the upper face (mm)";
    along.options.scales.y.title.text = labelOf(field);
    along.data.datasets = values
      ? chained(upper, size).map((chain, i) =>
          lineSet(
            i ? `_${i}` : field.label,
            "#0072b2",
            chain.map(({ length, end, triangle }) => ({
              x: length,
              y: (field.percent ? 100 : 1) * valueAt(field, end, triangle),
              at: end.point,
            })),
            1.6,
          ),
        )
      : [];
    along.update();
  }

  function valueAt(field, end, triangle) {
    const { mesh, values } = state;
    if (field.elements || field.names) return valueOfTriangle(mesh, field, values, triangle);
    return (1 - end.part) * values[mesh.places[end.p]] + end.part * values[mesh.places[end.q]];
  }

  // ---- forming limit diagram ----
  async function limitDiagram() {
    const { sets, thinned } = await limitSets(scene, state);
    sets.unshift({
      label: "_marked",
      data: [],
      pointRadius: 7,
      pointStyle: "circle",
      borderColor: "#cc0066",
      backgroundColor: "transparent",
      borderWidth: 2,
    });
    limitChart.data.datasets = sets;
    limitChart.update();
    element("limit_help").textContent =
      `Dots: nodes; diamonds: elements${thinned ? ", a part of them" : ""}; logarithmic strains at the middle of the sheet.${
        scene.limit.minor.length ? "" : ` No curve: ${scene.limit.label}.`
      } A point under the mouse is marked on the sheet, and the other way round.`;
  }
  const limitChart = newChart(element("limit_chart"), "minor strain (logarithmic)", "major strain (logarithmic)", {
    tell: ({ raw, dataset }) =>
      "i" in raw
        ? `${raw.elements ? "element" : "node"} ${numberOf(raw)}: ${round(raw.x)}, ${round(raw.y)}`
        : `${named(dataset)}${round(raw.x)}, ${round(raw.y)}`,
    hover: (found) => {
      const raw = found && limitChart.data.datasets[found.datasetIndex].data[found.index];
      markAt(
        raw && "i" in raw ? (raw.elements ? centreOf(raw.i) : [0, 1, 2].map((k) => state.points[k][raw.i])) : null,
      );
    },
  });
  const markHovered = (chart) => (found) =>
    markAt(found && chart().data.datasets[found.datasetIndex].data[found.index]?.at);
  const tellSection = ({ raw, dataset }) => `${named(dataset)}${round(raw.x)}, ${round(raw.y)}`;
  const profile = newChart(element("profile_chart"), "", "", {
    equal: true,
    tell: tellSection,
    hover: markHovered(() => profile),
  });
  const along = newChart(element("along_chart"), "", "", { tell: tellSection, hover: markHovered(() => along) });
  const numberOf = ({ i, elements }) => (elements ? state.mesh.elements : state.mesh.nodes)[i];
  function centreOf(owner) {
    const { mesh, points } = state,
      sum = [0, 0, 0];
    let count = 0;
    for (let t = 0; t < mesh.owners.length; t++) {
      if (mesh.owners[t] !== owner) continue;
      for (let k = 0; k < 3; k++) {
        count++;
        for (let axis = 0; axis < 3; axis++) sum[axis] += points[axis][mesh.places[mesh.triangles[3 * t + k]]];
      }
    }
    return sum.map((value) => value / count);
  }
  function markAt(point) {
    mark.visible = !!point;
    if (point) mark.position.set(...point);
    render();
  }

  // ---- hover ----
  const ray = new library.Raycaster();
  // Return what is at a place of the window: node, element, their values, the point; null where there is no sheet.
  function pick(clientX, clientY) {
    const frame = renderer.domElement.getBoundingClientRect();
    ray.setFromCamera(
      new library.Vector2(
        (2 * (clientX - frame.left)) / frame.width - 1,
        1 - (2 * (clientY - frame.top)) / frame.height,
      ),
      camera,
    );
    const shown = sheets.slice(0, shownImages().length).filter((object) => object.visible);
    const hit = ray
      .intersectObjects(shown, false)
      .find(({ point }) => !element("cut").checked || plane.distanceToPoint(point) >= 0);
    if (!hit) return null;
    const { mesh, points, values } = state,
      field = scene.fields[state.field],
      sign = signs[sheets.indexOf(hit.object)];
    const corners = [0, 1, 2].map((k) => mesh.places[mesh.triangles[3 * hit.faceIndex + k]]);
    const position = (i) => [0, 1, 2].map((k) => sign[k] * points[k][i]);
    const far = (i) => Math.hypot(...position(i).map((value, k) => value - hit.point.toArray()[k]));
    const place = corners.reduce((best, i) => (far(i) < far(best) ? i : best)),
      owner = mesh.owners[hit.faceIndex];
    return {
      place,
      owner,
      node: mesh.nodes[place],
      element: mesh.elements[owner],
      position: position(place),
      value: values ? values[field.elements ? owner : place] : null,
    };
  }
  function tell(event) {
    const found = event.buttons ? null : pick(event.clientX, event.clientY),
      told = element("told"),
      frame = view.getBoundingClientRect();
    told.style.display = found ? "block" : "none";
    let limitMark = null;
    if (found) {
      const field = scene.fields[state.field];
      told.textContent = `${field.label.replace(/ \([^()]*\)$/, "")}: ${found.value === null ? "not known" : valueText(field, found.value)}
node ${found.node} at (${found.position.map((value) => value.toFixed(2)).join(", ")}) mm
element ${found.element}`;
      told.style.left = `${Math.min(event.clientX - frame.left + 14, frame.width - told.offsetWidth - 4)}px`;
      told.style.top = `${Math.min(event.clientY - frame.top + 14, frame.height - told.offsetHeight - 4)}px`;
      limitMark = state.strains && { x: state.strains[0][found.place], y: state.strains[1][found.place] };
    }
    limitChart.data.datasets[0].data = limitMark ? [limitMark] : [];
    limitChart.update("none");
    markAt(found ? found.position : null);
  }
  let waiting = null;
  renderer.domElement.onpointermove = (event) => {
    if (!waiting)
      requestAnimationFrame(() => {
        tell(waiting);
        waiting = null;
      });
    waiting = event;
  };
  renderer.domElement.onpointerleave = () => {
    element("told").style.display = "none";
  };

  // ---- camera ----
  const box = { min: new Vector3(Infinity, Infinity, Infinity), max: new Vector3(-Infinity, -Infinity, -Infinity) };
  for (const step of scene.steps) {
    for (const [k, array] of step.points.entries()) {
      const axis = "xyz"[k],
        ends = [array.low, array.low + 65535 * array.scale];
      const both = scene.mirror.includes(axis) ? [...ends, -ends[0], -ends[1]] : ends;
      box.min[axis] = Math.min(box.min[axis], ...both);
      box.max[axis] = Math.max(box.max[axis], ...both);
    }
  }
  const size = box.max.distanceTo(box.min),
    centre = box.min.clone().add(box.max).multiplyScalar(0.5);
  mark.scale.setScalar(0.006 * size);
  function look(name) {
    const direction = new Vector3(...DIRECTIONS[name]).normalize();
    camera.position.copy(centre).addScaledVector(direction, size);
    orbit.target.copy(centre);
    camera.zoom = 1;
    camera.lookAt(centre);
    camera.updateMatrixWorld();
    let [wide, high] = [0, 0];
    for (let i = 0; i < 8; i++) {
      const corner = new Vector3(...["x", "y", "z"].map((axis, k) => ((i >> k) & 1 ? box.max : box.min)[axis]))
        .sub(centre)
        .applyQuaternion(camera.quaternion.clone().invert());
      wide = Math.max(wide, Math.abs(corner.x));
      high = Math.max(high, Math.abs(corner.y));
    }
    state.half = { wide: 1.25 * wide, high: 1.08 * high };
    fit();
  }
  function fit() {
    const { clientWidth: width, clientHeight: height } = view;
    if (!width || !state.half) return;
    renderer.setSize(width, height);
    const half = Math.max(state.half.high, (state.half.wide * height) / width, 1e-3);
    const aside = (half * element("legend").width) / height; // the legend stands at the right of the sheet
    Object.assign(camera, {
      left: aside - (half * width) / height,
      right: aside + (half * width) / height,
      top: half,
      bottom: -half,
    });
    camera.updateProjectionMatrix();
    orbit.update();
    render();
  }
  const render = () => renderer.render(world, camera);
  orbit.addEventListener("change", render);
  new ResizeObserver(fit).observe(view);
  window.addEventListener("beforeprint", render);

  // ---- controls ----
  const choice = element("field");
  for (const [name, elements] of [
    ["At the nodes", false],
    ["At the elements", true],
  ]) {
    const group = document.createElement("optgroup");
    group.label = name;
    scene.fields.forEach((field, i) => {
      if (field.elements === elements) group.append(new Option(field.label, i));
    });
    choice.append(group);
  }
  const select = (name, elements = false) => {
    const found = scene.fields.findIndex((field) => field.name === name && field.elements === elements);
    if (found < 0) return;
    state.field = found;
    choice.value = found;
  };
  select("thinning");
  choice.onchange = () => {
    state.field = +choice.value;
    element("pressure").checked = false;
    return show();
  };
  element("pressure").onchange = () => {
    if (element("pressure").checked) select("contact_pressure");
    return show();
  };
  element("step").max = scene.steps.length - 1;
  element("step").oninput = () => {
    state.step = +element("step").value;
    return show();
  };
  for (const name of [
    "map",
    "bands",
    "range",
    "low",
    "high",
    "sheet",
    "lines",
    "mirror",
    "drawn",
    "released",
    "cut",
    "normal",
    "angle",
    "other",
  ]) {
    element(name).onchange = () => show();
  }
  for (const name of ["low", "high"])
    element(name).oninput = () => {
      element("range").value = "own";
    };
  element("offset").oninput = () => {
    element("cut").checked = true;
    section();
    render();
  };
  for (const name of Object.keys(DIRECTIONS)) {
    const button = document.createElement("button");
    button.textContent = name;
    button.onclick = () => look(name);
    element("directions").append(button, " ");
  }
  element("places").append(new Option("choose", -1), ...scene.places.map((one, i) => new Option(one.text, i)));
  element("places").onchange = async () => {
    const chosen = scene.places[+element("places").value];
    if (!chosen) return markAt(null);
    state.step = chosen.step;
    await show();
    return markAt(chosen.position);
  };
  element("places_label").hidden = !scene.places.length;
  element("mirror_label").hidden = !scene.mirror.length;
  element("drawn_label").hidden = !scene.drawn;
  element("released_label").hidden = !tools.length;
  element("pressure_label").hidden = !tools.length || !scene.fields.some((field) => field.name === "contact_tool");
  element("save").onclick = () => {
    const both = document.createElement("canvas"),
      context = both.getContext("2d"),
      { width, height } = renderer.domElement;
    Object.assign(both, { width, height });
    context.drawImage(renderer.domElement, 0, 0);
    const ratio = width / view.clientWidth,
      legend = element("legend");
    context.drawImage(
      legend,
      width - (legend.width + 4) * ratio,
      10 * ratio,
      legend.width * ratio,
      legend.height * ratio,
    );
    const link = document.createElement("a");
    link.download = "part.png";
    link.setAttribute("href", both.toDataURL());
    link.click();
  };
  let player = null;
  element("play").onclick = () => {
    const stop = () => {
      clearInterval(player);
      player = null;
      element("play").textContent = "▶";
    };
    if (player) return stop();
    if (state.step === scene.steps.length - 1) state.step = -1;
    element("play").textContent = "❚❚";
    player = setInterval(() => {
      state.step++;
      show();
      if (state.step >= scene.steps.length - 1) stop();
    }, 500);
    return null;
  };
  look("iso");
  await show();
  // What a console or a test can call.
  return {
    scene,
    state,
    show,
    select,
    look,
    pick,
    marked: () => (mark.visible ? mark.position.toArray() : null),
    project: (point) => {
      const at = new Vector3(...point).project(camera),
        frame = renderer.domElement.getBoundingClientRect();
      return [frame.left + ((at.x + 1) / 2) * frame.width, frame.top + ((1 - at.y) / 2) * frame.height];
    },
  };
}

if (element("scene")) {
  openViewer(JSON.parse(element("scene").textContent)).then(
    (viewer) => {
      window.viewer = viewer;
    },
    (error) => {
      element("view").textContent =
        `The part in 3D cannot be shown by this browser: ${error.message}. The pictures below can.`;
    },
  );
}
