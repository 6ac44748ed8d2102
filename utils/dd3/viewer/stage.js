// SPDX-License-Identifier: GPL-3.0-or-later
// The stage of the 3D view, by three.js: camera, light, the images of the model at its planes of symmetry, the plane of the
// section, the mark of a place.
"use strict";
const { Vector3 } = library;

const DIRECTIONS = {
  iso: [-0.9, -1.6, 0.9],
  front: [0, -1, 0],
  side: [-1, 0, 0],
  top: [0, -1e-4, 1],
  below: [-0.9, -1.6, -0.9],
};
const LARGEST = 65535; // of 16 bits

class Stage {
  constructor(scene) {
    this.view = element("view");
    this.renderer = new library.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.localClippingEnabled = true;
    this.renderer.domElement.setAttribute("role", "img");
    this.renderer.domElement.setAttribute("aria-label", "the sheet and its tools");
    this.view.prepend(this.renderer.domElement);
    this.world = new library.Scene();
    this.world.background = new library.Color("white");
    this.camera = new library.OrthographicCamera(-1, 1, 1, -1, -1e4, 1e4);
    this.camera.up.set(0, 0, 1);
    const lamp = new library.DirectionalLight(0xffffff, 1.6);
    lamp.position.set(0.3, 0.5, 1);
    this.camera.add(lamp);
    this.world.add(this.camera, new library.HemisphereLight(0xffffff, 0xd8dce0, 2.0));
    this.orbit = new library.OrbitControls(this.camera, this.renderer.domElement);
    this.plane = new library.Plane(new Vector3(0, 1, 0), 0);
    this.materials = []; // those that the section cuts
    this.measure(scene);
    this.addImages(scene.mirror);
    this.addMark();
    this.orbit.addEventListener("change", () => this.render());
    new ResizeObserver(() => this.fit()).observe(this.view);
    window.addEventListener("beforeprint", () => this.render());
  }

  // Find the box that holds the sheet at all steps, with its images.
  measure(scene) {
    this.box = { min: new Vector3(Infinity, Infinity, Infinity), max: new Vector3(-Infinity, -Infinity, -Infinity) };
    for (const step of scene.steps) {
      for (const [k, array] of step.points.entries()) {
        const axis = "xyz"[k];
        const ends = [array.low, array.low + LARGEST * array.scale];
        const both = scene.mirror.includes(axis) ? [...ends, -ends[0], -ends[1]] : ends;
        this.box.min[axis] = Math.min(this.box.min[axis], ...both);
        this.box.max[axis] = Math.max(this.box.max[axis], ...both);
      }
    }
    this.size = this.box.max.distanceTo(this.box.min);
    this.centre = this.box.min.clone().add(this.box.max).multiplyScalar(0.5);
  }

  // Add a group for each product of reflections; `signs` are those of its axes.
  addImages(mirror) {
    const reflected = (all, axis) =>
      all.concat(all.map((sign) => sign.map((value, i) => ("xyz"[i] === axis ? -value : value))));
    this.signs = mirror.reduce(reflected, [[1, 1, 1]]);
    this.images = this.signs.map((sign) => {
      const group = new library.Group();
      group.scale.set(...sign);
      this.world.add(group);
      return group;
    });
  }

  // Return the number of images that are shown.
  shown() {
    return element("mirror").checked ? this.images.length : 1;
  }

  // Add an object to each image; they share geometry and material.
  inImages(make) {
    return this.images.map((group) => {
      const object = make();
      group.add(object);
      return object;
    });
  }

  // Return a material that the section cuts.
  cut(material) {
    this.materials.push(material);
    return material;
  }

  addMark() {
    const material = new library.MeshBasicMaterial({ color: 0xcc0066, depthTest: false, transparent: true });
    this.mark = new library.Mesh(new library.SphereGeometry(0.006 * this.size, 16, 12), material);
    Object.assign(this.mark, { renderOrder: 4, visible: false });
    this.world.add(this.mark);
  }

  markAt(point) {
    this.mark.visible = !!point;
    if (point) this.mark.position.set(...point);
    this.render();
  }

  // Point the camera at the whole sheet.
  look(name) {
    const { camera, centre, box } = this;
    camera.position.copy(centre).addScaledVector(new Vector3(...DIRECTIONS[name]).normalize(), this.size);
    this.orbit.target.copy(centre);
    camera.zoom = 1;
    camera.lookAt(centre);
    camera.updateMatrixWorld();
    const back = camera.quaternion.clone().invert();
    const corners = Array.from({ length: 8 }, (_, i) =>
      new Vector3(...["x", "y", "z"].map((axis, k) => ((i >> k) & 1 ? box.max : box.min)[axis]))
        .sub(centre)
        .applyQuaternion(back),
    );
    const half = (axis) => Math.max(...corners.map((corner) => Math.abs(corner[axis])));
    this.half = { wide: 1.25 * half("x"), high: 1.08 * half("y") };
    this.fit();
  }

  // Fit the picture to its element.
  fit() {
    const { clientWidth: width, clientHeight: height } = this.view;
    if (!width || !this.half) return;
    this.renderer.setSize(width, height);
    const half = Math.max(this.half.high, (this.half.wide * height) / width, 1e-3);
    const aside = (half * element("legend").width) / height; // the legend stands at the right of the sheet
    const wide = (half * width) / height;
    Object.assign(this.camera, { left: aside - wide, right: aside + wide, top: half, bottom: -half });
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.render();
  }

  render() {
    this.renderer.render(this.world, this.camera);
  }

  // Return the place of a point in the window.
  project(point) {
    const at = new Vector3(...point).project(this.camera);
    const frame = this.renderer.domElement.getBoundingClientRect();
    return [frame.left + ((at.x + 1) / 2) * frame.width, frame.top + ((1 - at.y) / 2) * frame.height];
  }

  // Return the first place under a place of the window where some objects are, and the section leaves them.
  hit(clientX, clientY, objects) {
    const frame = this.renderer.domElement.getBoundingClientRect();
    const x = (2 * (clientX - frame.left)) / frame.width - 1;
    const y = 1 - (2 * (clientY - frame.top)) / frame.height;
    const ray = new library.Raycaster();
    ray.setFromCamera(new library.Vector2(x, y), this.camera);
    const left = ({ point }) => !element("cut").checked || this.plane.distanceToPoint(point) >= 0;
    return ray.intersectObjects(objects, false).find(left);
  }

  // Save the picture with its legend.
  save() {
    const both = document.createElement("canvas");
    const { width, height } = this.renderer.domElement;
    Object.assign(both, { width, height });
    const context = both.getContext("2d");
    context.drawImage(this.renderer.domElement, 0, 0);
    const ratio = width / this.view.clientWidth;
    const legend = element("legend");
    const place = [width - legend.width * ratio, 10 * ratio, legend.width * ratio, legend.height * ratio];
    context.drawImage(legend, ...place);
    const link = document.createElement("a");
    link.download = "part.png";
    link.setAttribute("href", both.toDataURL());
    link.click();
  }
}
