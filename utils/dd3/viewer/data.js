// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays of a page as arrays.py writes them; sections of triangles.
"use strict";

const SIZES = { uint8: 1, uint16: 2, uint32: 4, float32: 4 };
const KINDS = { uint8: Uint8Array, uint16: Uint16Array, uint32: Uint32Array, float32: Float32Array };
const known = new Map();

// Return an array of the page by its description.
async function decode({ number, kind, low, scale }) {
  const bytes = Uint8Array.from(atob(element("array" + number).textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const sorted = new Uint8Array(await new Response(stream).arrayBuffer());
  const size = SIZES[kind],
    count = sorted.length / size,
    together = new Uint8Array(sorted.length);
  for (let part = 0; part < size; part++) {
    for (let i = 0; i < count; i++) together[i * size + part] = sorted[part * count + i];
  }
  const values = new KINDS[kind](together.buffer);
  return kind === "uint16" ? Float32Array.from(values, (value) => low + scale * value) : values;
}

function read(array) {
  if (!known.has(array.number)) known.set(array.number, decode(array));
  return known.get(array.number);
}

const readAll = (arrays) => Promise.all(arrays.map(read));

// Return the lines in which a plane cuts triangles with corners `at`, of an image with the signs of its axes: each with
// its ends, their points, the corners p, q between which they are, and the signs. `size`: extent of the sheet.
function cutOf(triangles, at, sign, { normal, distance }, size, keep = () => true) {
  const height = new Float64Array(at.length / 3),
    found = [];
  for (let i = 0; i < height.length; i++) {
    height[i] = normal.reduce((sum, n, k) => sum + n * sign[k] * at[3 * i + k], -distance - 1.234e-7 * size);
  }
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t], triangles[t + 1], triangles[t + 2]];
    const above = (height[a] > 0) + (height[b] > 0) + (height[c] > 0);
    if (above === 0 || above === 3 || !keep(t / 3)) continue;
    const ends = [
      [a, b],
      [b, c],
      [c, a],
    ]
      .filter(([p, q]) => height[p] > 0 !== height[q] > 0)
      .map(([p, q]) => {
        const part = height[p] / (height[p] - height[q]);
        return {
          p,
          q,
          part,
          point: [0, 1, 2].map((k) => sign[k] * ((1 - part) * at[3 * p + k] + part * at[3 * q + k])),
        };
      });
    found.push({ ends, triangle: t / 3, sign });
  }
  return found;
}

// Join the lines of a section to chains, with the length along each.
function chained(segments, size) {
  const key = ({ point }) => point.map((value) => Math.round((value / size) * 2e5)).join(),
    at = new Map(),
    chains = [];
  for (const segment of segments) {
    for (const end of segment.ends) at.set(key(end), [...(at.get(key(end)) ?? []), segment]);
  }
  const left = new Set(segments),
    ends = segments.filter((one) => one.ends.some((end) => at.get(key(end)).length === 1));
  for (const start of [...ends, ...segments]) {
    if (!left.has(start)) continue;
    const chain = [],
      open = start.ends.findIndex((end) => at.get(key(end)).length === 1);
    let segment = start,
      end = start.ends[Math.max(open, 0)],
      length = 0;
    while (segment) {
      left.delete(segment);
      const [a, b] = key(segment.ends[0]) === key(end) ? segment.ends : [...segment.ends].reverse();
      chain.push({ length, end: a, segment });
      length += Math.hypot(...a.point.map((value, k) => b.point[k] - value));
      chain.push({ length, end: b, segment });
      end = b;
      segment = at.get(key(b)).find((one) => left.has(one));
    }
    chains.push(chain);
  }
  return chains.sort((one, other) => other.at(-1).length - one.at(-1).length);
}
