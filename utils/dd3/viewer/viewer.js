// SPDX-License-Identifier: GPL-3.0-or-later
// The 3D view of a page: the scene of scene.py at a step, with the controls of viewer.html.
"use strict";

const REDRAWN = [
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
];

class Viewer {
  constructor(scene) {
    this.scene = scene;
    this.stage = new Stage(scene);
    this.section = new Section(this.stage);
    this.diagram = new LimitDiagram(this);
    this.state = { step: scene.steps.findLastIndex((step) => !step.free), field: 0 };
    this.meshes = new Map();
    this.tools = [];
    this.turns = 0; // calls of show
    this.addSheet();
    this.addBeads();
  }

  addSheet() {
    const { stage } = this;
    const { BufferGeometry, DoubleSide, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial } = library;
    this.bar = new library.DataTexture(new Uint8Array(4 * 256), 256, 1); // the colours of the range
    this.bar.colorSpace = library.SRGBColorSpace;
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }; // the mesh lines
    this.coloured = stage.cut(new MeshLambertMaterial({ map: this.bar, side: DoubleSide, ...behind }));
    const dark = stage.cut(new LineBasicMaterial({ color: 0x333333, transparent: true, opacity: 0.55 }));
    const blue = stage.cut(new LineBasicMaterial({ color: 0x0072b2, transparent: true, opacity: 0.6 }));
    const empty = new BufferGeometry();
    this.sheets = stage.inImages(() => new Mesh(empty, this.coloured));
    this.lines = stage.inImages(() => new LineSegments(empty, dark));
    this.drawnLines = stage.inImages(() => new LineSegments(empty, blue));
  }

  addBeads() {
    const red = new library.LineBasicMaterial({ color: 0xc0392b, depthTest: false, transparent: true });
    for (const points of this.scene.beads) {
      const ends = points.slice(1).flatMap((point, i) => [...points[i], ...point]);
      const geometry = new library.BufferGeometry().setAttribute("position", numbers(ends, 3));
      this.stage.inImages(() => new library.LineSegments(geometry, red));
    }
  }

  async open() {
    for (const [i, tool] of this.scene.tools.entries()) {
      this.tools.push(await openTool(tool, i, this.stage, this.bar, () => this.show()));
    }
    this.addFields();
    this.addControls();
    this.addPlaces();
    this.addHover();
    this.select("thinning");
    this.stage.look("iso");
    await this.show();
    return this;
  }

  field() {
    return this.scene.fields[this.state.field];
  }

  async meshOf(number) {
    if (!this.meshes.has(number)) this.meshes.set(number, await openMesh(this.scene.meshes[number]));
    return this.meshes.get(number);
  }

  // ---- a step ----

  // Show the step and the field of the state, as the controls say. Of several calls that wait for data the last one draws.
  async show() {
    const turn = ++this.turns;
    const { scene, state } = this;
    const step = scene.steps[state.step];
    const field = this.field();
    const touched = scene.fields.find((one) => one.name === "contact_tool" && !one.elements);
    const mesh = await this.meshOf(step.mesh);
    const points = await readAll(step.points);
    const values = field.values[state.step] ? await read(field.values[state.step]) : null;
    const touching = element("pressure").checked && touched ? await read(touched.values[state.step]) : null;
    const drawn = step.free && element("drawn").checked ? positions(await readAll(scene.drawn), mesh.places) : null;
    if (turn !== this.turns) return;
    Object.assign(state, { mesh, points, values, shown: rangeOf(field, state.step) });
    moveMesh(mesh, points);
    this.colour(field);
    this.place(drawn);
    for (const tool of this.tools) placeTool(tool, step, mesh, touching);
    element("step").value = state.step;
    element("step_name").textContent = step.name + (values ? "" : "; the field is not known at this step");
    element("field_help").textContent = field.help;
    this.updateSection = () => this.section.update({ mesh, values, field, drawn, tools: this.tools });
    this.updateSection();
    await this.diagram.update();
    this.stage.render();
  }

  // Set the colours of the range, and the legend.
  colour(field) {
    const { shown, values } = this.state;
    for (let i = 0; i < 256; i++) {
      this.bar.image.data.set([...colourOf(this.scene.maps, field, shown, (i + 0.5) / 256), 255], 4 * i);
    }
    this.bar.needsUpdate = true;
    this.coloured.color.set(values ? 0xffffff : 0xc8ccd0);
    if (!!this.coloured.map !== !!values)
      Object.assign(this.coloured, { map: values ? this.bar : null, needsUpdate: true });
    element("map_label").hidden = !!field.names || isSigned(shown);
    drawLegend(this.scene.maps, field, shown);
  }

  // Put the sheet, its lines and the drawn shape into the images.
  place(drawn) {
    const { mesh, values, shown } = this.state;
    const field = this.field();
    const painted = values ? paint(mesh, field, values, shown) : mesh.smooth;
    const opposite = values && field.odd?.length ? oppositeOf(painted, shown) : painted;
    const visible = element("sheet").checked;
    const before = drawn && geometryOf(numbers(drawn, 3), mesh.lines.getIndex());
    this.stage.images.forEach((group, i) => {
      group.visible = i < this.stage.shown();
      const geometry = signOf(field, this.stage.signs[i]) < 0 ? opposite : painted;
      Object.assign(this.sheets[i], { geometry, visible });
      Object.assign(this.lines[i], { geometry: mesh.lines, visible: visible && element("lines").checked });
      this.drawnLines[i].visible = !!drawn;
      if (before) this.drawnLines[i].geometry = before;
    });
  }

  // ---- hover ----

  // Return what is at a place of the window: node and element with their numbers and places in the arrays, position of the
  // node, value of the field; null where there is no sheet.
  pick(clientX, clientY) {
    const shown = this.sheets.slice(0, this.stage.shown()).filter((object) => object.visible);
    const hit = this.stage.hit(clientX, clientY, shown);
    if (!hit) return null;
    const { mesh, points, values } = this.state;
    const sign = this.stage.signs[this.sheets.indexOf(hit.object)];
    const position = (i) => [0, 1, 2].map((k) => sign[k] * points[k][i]);
    const far = (i) => new Vector3(...position(i)).distanceTo(hit.point);
    const corners = [0, 1, 2].map((k) => mesh.places[mesh.triangles[3 * hit.faceIndex + k]]);
    const place = corners.reduce((best, i) => (far(i) < far(best) ? i : best));
    const owner = mesh.owners[hit.faceIndex];
    const field = this.field();
    const value = values ? signOf(field, sign) * values[field.elements ? owner : place] : null;
    return { place, owner, node: mesh.nodes[place], element: mesh.elements[owner], position: position(place), value };
  }

  // Tell what is under the mouse.
  tell(event) {
    const found = event.buttons ? null : this.pick(event.clientX, event.clientY);
    const told = element("told");
    told.style.display = found ? "block" : "none";
    if (found) {
      const field = this.field();
      const value = found.value === null ? "not known" : valueText(field, found.value);
      const place = found.position.map((x) => x.toFixed(2)).join(", ");
      const label = field.label.replace(/ \([^()]*\)$/, "");
      told.textContent = `${label}: ${value}\nnode ${found.node} at (${place}) mm\nelement ${found.element}`;
      const frame = this.stage.view.getBoundingClientRect();
      told.style.left = `${Math.min(event.clientX - frame.left + 14, frame.width - told.offsetWidth - 4)}px`;
      told.style.top = `${Math.min(event.clientY - frame.top + 14, frame.height - told.offsetHeight - 4)}px`;
    }
    this.diagram.markNode(found && found.place);
    this.stage.markAt(found && found.position);
  }

  addHover() {
    const { domElement } = this.stage.renderer;
    let waiting = null; // for the next picture
    domElement.onpointermove = (event) => {
      if (!waiting)
        requestAnimationFrame(() => {
          this.tell(waiting);
          waiting = null;
        });
      waiting = event;
    };
    domElement.onpointerleave = () => {
      element("told").style.display = "none";
    };
  }

  // Return the place that is marked, null if none is.
  marked() {
    return this.stage.mark.visible ? this.stage.mark.position.toArray() : null;
  }

  // Return the place of a point in the window.
  project(point) {
    return this.stage.project(point);
  }

  look(name) {
    this.stage.look(name);
  }

  // ---- controls ----

  // Choose a field by its name.
  select(name, elements = false) {
    const found = this.scene.fields.findIndex((field) => field.name === name && field.elements === elements);
    if (found < 0) return;
    this.state.field = found;
    element("field").value = found;
  }

  addFields() {
    for (const [name, elements] of Object.entries({ "At the nodes": false, "At the elements": true })) {
      const group = document.createElement("optgroup");
      group.label = name;
      this.scene.fields.forEach((field, i) => field.elements === elements && group.append(new Option(field.label, i)));
      element("field").append(group);
    }
    element("field").onchange = () => {
      this.state.field = +element("field").value;
      element("pressure").checked = false;
      return this.show();
    };
    element("pressure").onchange = () => {
      if (element("pressure").checked) {
        this.select("contact_pressure");
        if (!this.tools.some((tool) => tool.box.checked)) for (const tool of this.tools) tool.box.checked = true;
      }
      return this.show();
    };
  }

  addControls() {
    const { scene, state } = this;
    for (const name of REDRAWN) element(name).onchange = () => this.show();
    for (const name of ["low", "high"])
      element(name).oninput = () => {
        element("range").value = "own";
      };
    element("step").max = scene.steps.length - 1;
    element("step").oninput = () => {
      state.step = +element("step").value;
      return this.show();
    };
    element("offset").oninput = () => {
      element("cut").checked = true;
      this.updateSection();
      this.stage.render();
    };
    for (const name of Object.keys(DIRECTIONS)) {
      const button = document.createElement("button");
      Object.assign(button, { textContent: name, onclick: () => this.look(name) });
      element("directions").append(button, " ");
    }
    element("save").onclick = () => this.stage.save();
    element("play").onclick = () => this.play();
    element("mirror_label").hidden = !scene.mirror.length;
    element("drawn_label").hidden = !scene.drawn;
    element("released_label").hidden = !this.tools.length;
    element("pressure_label").hidden =
      !this.tools.length || !scene.fields.some((field) => field.name === "contact_tool");
  }

  addPlaces() {
    const { places } = this.scene;
    element("places_label").hidden = !places.length;
    element("places").append(new Option("choose", -1), ...places.map((one, i) => new Option(one.text, i)));
    element("places").onchange = async () => {
      const chosen = places[+element("places").value];
      if (chosen) {
        this.state.step = chosen.step;
        await this.show();
      }
      this.stage.markAt(chosen && chosen.position);
    };
  }

  // Show the steps one after the other, or stop.
  play() {
    const { state } = this;
    const last = this.scene.steps.length - 1;
    const stop = () => {
      this.player = clearInterval(this.player);
      element("play").textContent = "▶";
    };
    if (this.player) return stop();
    if (state.step === last) state.step = -1;
    element("play").textContent = "❚❚";
    this.player = setInterval(() => {
      state.step++;
      this.show();
      if (state.step >= last) stop();
    }, 500);
    return null;
  }
}

async function openViewer() {
  try {
    window.viewer = await new Viewer(JSON.parse(element("scene").textContent)).open();
  } catch (error) {
    element("view").textContent =
      `The part in 3D cannot be shown by this browser: ${error.message}. The pictures below can.`;
  }
}

if (element("scene")) openViewer();
