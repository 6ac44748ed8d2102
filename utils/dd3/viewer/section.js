// SPDX-License-Identifier: GPL-3.0-or-later
// The section of the 3D view: its plane, the profile of sheet, tools and drawn shape, and the field along the upper face.
"use strict";

const AXES_OF = { x: ["y", "z"], y: ["x", "z"], z: ["x", "y"], turned: ["in the plane", "z"] };

class Section {
  constructor(stage) {
    this.stage = stage;
    const line = new library.LineBasicMaterial({ color: 0xd55e00, depthTest: false, transparent: true });
    this.line = new library.LineSegments(new library.BufferGeometry(), line);
    this.line.renderOrder = 3;
    stage.world.add(this.line);
    const tell = ({ raw, dataset }) => `${named(dataset)}${round(raw.x)}, ${round(raw.y)}`;
    const hover = (chart) => (found) =>
      stage.markAt(found && this[chart].data.datasets[found.datasetIndex].data[found.index]?.at);
    this.profile = newChart(element("profile_chart"), "", "", { equal: true, tell, hover: hover("profile") });
    this.along = newChart(element("along_chart"), "length along the upper face (mm)", "", {
      tell,
      legend: false,
      hover: hover("along"),
    });
  }

  // Return the plane that the controls give: normal . x = distance.
  place() {
    const choice = element("normal").value;
    const angle = (Math.PI / 180) * parseFloat(element("angle").value || 0);
    const turned = [-Math.sin(angle), Math.cos(angle), 0];
    const normal = choice === "turned" ? turned : ["x", "y", "z"].map((axis) => +(axis === choice));
    const { min, max } = this.stage.box;
    const ends = [min.toArray(), max.toArray()];
    const reach = [Math.min, Math.max].map((best) =>
      normal.reduce((sum, n, k) => sum + best(n * ends[0][k], n * ends[1][k]), 0),
    );
    // A little beside the place, so that no nodes lie in the plane: in one of symmetry two images would be cut.
    const part = element("offset").value / 1000,
      beside = (part < 1 ? 1e-5 : -1e-5) * this.stage.size;
    return { choice, normal, distance: reach[0] + (reach[1] - reach[0]) * part + beside };
  }

  // Cut the bodies where the controls say so, and draw the profile and the field.
  update({ mesh, values, field, tools, drawn }) {
    const on = element("cut").checked;
    const cut = this.place();
    const name = cut.choice === "turned" ? "distance" : cut.choice;
    element("offset_value").textContent = `${name} = ${cut.distance.toFixed(2)} mm`;
    element("angle_label").hidden = cut.choice !== "turned";
    this.clip(on, cut);
    for (const box of ["profile_box", "along_box"]) element(box).hidden = !on;
    this.line.visible = on;
    if (!on) return;
    const at = mesh.smooth.getAttribute("position").array;
    this.own = this.cutImages(mesh.triangles, at, cut);
    this.line.geometry.dispose();
    const points = this.own.flatMap(({ ends }) => ends.flatMap((end) => end.point));
    this.line.geometry = new library.BufferGeometry().setAttribute("position", numbers(points, 3));
    this.drawProfile(cut, mesh, tools, drawn);
    const upper = values ? this.cutImages(mesh.triangles, at, cut, (t) => mesh.sides[t] === UPPER) : [];
    this.drawField(upper, mesh, values, field);
  }

  // Let the plane cut the bodies; the half that stays is the one before it, or the other.
  clip(on, { normal, distance }) {
    const half = element("other").checked ? 1 : -1;
    this.stage.plane.normal.set(...normal).multiplyScalar(half);
    this.stage.plane.constant = -half * distance;
    for (const material of this.stage.materials) {
      if (!!material.clippingPlanes?.length !== on) material.needsUpdate = true;
      material.clippingPlanes = on ? [this.stage.plane] : [];
    }
  }

  cutImages(triangles, at, cut, keep) {
    const signs = this.stage.signs.slice(0, this.stage.shown());
    return signs.flatMap((sign) => cutOf(triangles, at, sign, cut, this.stage.size, keep));
  }

  drawProfile(cut, mesh, tools, drawn) {
    const [a, b] = { x: [1, 2], y: [0, 2], z: [0, 1] }[cut.choice] ?? [];
    const across = ([x, y]) => cut.normal[1] * x - cut.normal[0] * y;
    const flat = (point) =>
      cut.choice === "turned" ? { x: across(point), y: point[2] } : { x: point[a], y: point[b] };
    const inPlane = (lines) =>
      lines.flatMap(({ ends }) => [...ends.map(({ point }) => ({ ...flat(point), at: point })), { x: NaN, y: NaN }]);
    const sets = [lineSet("sheet", "#0072b2", inPlane(this.own), 1.6)];
    if (drawn) sets.push(lineSet("drawn shape", "#d55e00", inPlane(this.cutImages(mesh.triangles, drawn, cut)), 1));
    for (const tool of tools.filter(({ visible }) => visible)) {
      const at = tool.skin.getAttribute("position").clone().applyMatrix4(tool.matrix).array;
      const lines = this.cutImages(tool.skin.getIndex().array, at, cut);
      sets.push(lineSet(tool.name, `#${tool.colour.toString(16)}`, inPlane(lines), 1));
    }
    const { x, y } = this.profile.options.scales;
    [x.title.text, y.title.text] = AXES_OF[cut.choice].map((axis) => `${axis} (mm)`);
    this.profile.data.datasets = sets;
    this.profile.update();
  }

  drawField(upper, mesh, values, field) {
    const factor = field.percent ? 100 : 1;
    const ofTriangle = field.elements || field.names;
    const value = ({ p, q, part }, triangle) =>
      ofTriangle
        ? valueOfTriangle(mesh, field, values, triangle)
        : (1 - part) * values[mesh.places[p]] + part * values[mesh.places[q]];
    this.along.options.scales.y.title.text = labelOf(field);
    this.along.data.datasets = chained(upper, this.stage.size).map((chain, i) => {
      const points = chain.map(({ length, end, segment }) => ({
        x: length,
        y: factor * signOf(field, segment.sign) * value(end, segment.triangle),
        at: end.point,
      }));
      return lineSet(i ? `_${i}` : field.label, "#0072b2", points, 1.6);
    });
    this.along.update();
  }
}
