// SPDX-License-Identifier: GPL-3.0-or-later
// Colours, ranges and legend of fields; controls of the page give the map, bands and range.
"use strict";

const labelOf = (field) => (field.percent ? `${field.label} (%)` : field.label);
const valueText = (field, value) =>
  field.names
    ? field.names[Math.round(value)]
    : field.percent
      ? `${round(100 * value)} %`
      : `${round(value)} ${/\(([^()]*)\)$/.exec(field.label)?.[1] ?? ""}`.trim();

// Round numbers between two ends: about `count` ticks, the ends among them.
function roundRange(low, high, count = 8) {
  if (!(high > low))
    [low, high] = [low - Math.max(1e-6, 1e-3 * Math.abs(low)), low + Math.max(1e-6, 1e-3 * Math.abs(low))];
  const rough = (high - low) / count,
    power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].find((factor) => factor * power >= 0.999 * rough) * power;
  const first = Math.floor(low / step + 1e-6),
    last = Math.ceil(high / step - 1e-6);
  const ticks = Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
  return { low: ticks[0], high: ticks[ticks.length - 1], ticks, step };
}

// Return a tick with the digits that the step from tick to tick needs: one more for 2.5 than for 1, 2 and 5.
function tickText(tick, step) {
  const power = Math.floor(Math.log10(step) + 1e-9),
    quarter = Math.abs(step / 10 ** power - 2.5) < 1e-6;
  return tick.toFixed(Math.max(0, Math.min(9, quarter - power)));
}

// Return the range of the colours: its ends, its ticks and their distance; `values`: those of the step.
function rangeOf(field, values) {
  const factor = field.percent ? 100 : 1;
  if (field.names) return { low: -0.5, high: field.names.length - 0.5, ticks: field.names.map((_, i) => i), step: 1 };
  let [low, high] = [field.low, field.high];
  if (element("range").value === "step" && values) {
    [low, high] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
  }
  if (element("range").value === "own") {
    const [a, b] = ["low", "high"].map((name) => parseFloat(element(name).value));
    if (b > a) return { ...roundRange(a, b), low: a, high: b };
  }
  return roundRange(factor * low, factor * high);
}

// Return the colour at a part of the range, red, green and blue from 0 to 255; `maps`: those of the scene.
function colourOf(maps, field, shown, part) {
  if (field.names) {
    const number = Math.min(field.names.length - 1, Math.floor(part * field.names.length));
    return [1, 3, 5].map((i) => parseInt(field.colours[number].slice(i, i + 2), 16));
  }
  let value = shown.low + part * (shown.high - shown.low);
  if (element("bands").checked) value = Math.min((Math.floor(value / shown.step) + 0.5) * shown.step, shown.high);
  const signed = shown.low < -1e-9 * shown.high && shown.high > 0,
    largest = Math.max(-shown.low, shown.high);
  const map = maps[signed ? "diverging" : element("map").value];
  const at =
    (signed ? 0.5 + (0.5 * value) / largest : (value - shown.low) / (shown.high - shown.low)) * (map.length - 1);
  const i = Math.max(0, Math.min(map.length - 2, Math.floor(at))),
    rest = Math.max(0, Math.min(1, at - i));
  return [0, 1, 2].map((k) => Math.round(255 * ((1 - rest) * map[i][k] + rest * map[i + 1][k])));
}

function drawLegend(maps, field, shown) {
  const canvas = element("legend"),
    context = canvas.getContext("2d"),
    top = 62,
    height = canvas.height - top - 10;
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = "#ffffffcc";
  context.fillRect(0, 0, canvas.width, canvas.height);
  for (let i = 0; i < height; i++) {
    context.fillStyle = `rgb(${colourOf(maps, field, shown, 1 - (i + 0.5) / height)})`;
    context.fillRect(2, top + i, 18, 1.5);
  }
  context.fillStyle = "#222";
  context.font = "13px system-ui,sans-serif";
  const words = labelOf(field).split(" "),
    rows = [""];
  for (const word of words) {
    if (context.measureText(rows.at(-1) + word).width > canvas.width - 6) rows.push("");
    rows[rows.length - 1] += word + " ";
  }
  rows.slice(0, 4).forEach((row, i) => context.fillText(row, 2, 12 + 14 * i));
  for (const tick of shown.ticks) {
    const y = top + height * (1 - (tick - shown.low) / (shown.high - shown.low));
    if (y < top - 1 || y > top + height + 1) continue;
    context.fillRect(20, y, 4, 1);
    context.fillText(field.names ? field.names[tick] : tickText(tick, shown.step), 27, y + 4, canvas.width - 28);
  }
}
