// SPDX-License-Identifier: GPL-3.0-or-later
// Colours, ranges and legend of fields; controls of the page give the map, bands and range.
"use strict";

const BEYOND = [213, 94, 0]; // of values beyond a limit, as in dd3.plot.scale

const labelOf = (field) => (field.percent ? `${field.label} (%)` : field.label);
const valueText = (field, value) =>
  field.names
    ? field.names[Math.round(value)]
    : field.percent
      ? `${round(100 * value)} %`
      : `${round(value)} ${/\(([^()]*)\)$/.exec(field.label)?.[1] ?? ""}`.trim();

// Return the distance of ticks between two ends, as dd3.plot.scale, which finds the scales of the steps.
function stepOf(low, high) {
  const least = (high - low) / 8,
    power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].find((factor) => factor * power >= 0.999 * least) * power;
}

// Return a range with its ticks, the multiples of a step; `limit`: that of the field, null without one.
function withTicks([low, high, step, limit]) {
  const first = Math.ceil(low / step - 1e-6),
    last = Math.floor(high / step + 1e-6);
  return { low, high, step, limit, ticks: Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step) };
}

// Return a tick with the digits that the step from tick to tick needs.
const tickText = (tick, step) => tick.toFixed(Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9))));

// Return the range of the colours: its ends, its ticks and their distance; `step`: the number of the step shown.
function rangeOf(field, step) {
  if (field.names) return { low: -0.5, high: field.names.length - 0.5, ticks: field.names.map((_, i) => i), step: 1 };
  if (element("range").value === "own") {
    const [low, high] = ["low", "high"].map((name) => parseFloat(element(name).value));
    if (high > low) return withTicks([low, high, stepOf(low, high), field.scale[3]]);
  }
  return withTicks((element("range").value === "step" && field.scales[step]) || field.scale);
}

// Whether a range has values of both signs, which have diverging colours.
const isSigned = ({ low, high }) => low < 0 && high > 0;

// Return the colour at a part of the range, red, green and blue from 0 to 255; `maps`: those of the scene.
function colourOf(maps, field, shown, part) {
  if (field.names) {
    const number = Math.min(field.names.length - 1, Math.floor(part * field.names.length));
    return [1, 3, 5].map((i) => parseInt(field.colours[number].slice(i, i + 2), 16));
  }
  const { low, high, limit } = shown;
  let value = low + part * (high - low);
  if (limit !== null && value >= limit) return BEYOND;
  if (element("bands").checked) value = Math.min((Math.floor(value / shown.step) + 0.5) * shown.step, high);
  const signed = isSigned(shown),
    largest = Math.max(-low, high),
    top = limit === null ? high : Math.min(high, limit);
  const map = maps[signed ? "diverging" : element("map").value];
  const at = (signed ? 0.5 + (0.5 * value) / largest : (value - low) / (top - low)) * (map.length - 1);
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
  context.fillStyle = "#ffffff";
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
