// SPDX-License-Identifier: GPL-3.0-or-later
// Charts of a page, by Chart.js: elements with the attribute data-curves become charts.
"use strict";
const { Chart } = library;
Chart.register(
  library.LinearScale,
  library.LineElement,
  library.PointElement,
  library.ScatterController,
  library.Legend,
  library.Tooltip,
);
Chart.defaults.animation = false;
Chart.defaults.maintainAspectRatio = false;
const element = (name) => document.getElementById(name);
const named = ({ label }) => (label.startsWith("_") ? "" : `${label}: `);
const round = (value) => String(Number(value.toPrecision(4)));

// Equal scales on both axes: the shorter range is widened, about the middle.
const equalScales = {
  id: "equalScales",
  afterLayout(chart, _, options) {
    if (!options.on || !chart.chartArea) return;
    const { x, y } = chart.options.scales,
      { width, height } = chart.chartArea,
      points = chart.data.datasets.flatMap((set) => set.data).filter((point) => point && Number.isFinite(point.x));
    if (!points.length || !width) return;
    const ends = (key) =>
      points.reduce(([a, b], p) => [Math.min(a, p[key]), Math.max(b, p[key])], [Infinity, -Infinity]);
    const [left, right] = ends("x"),
      [below, above] = ends("y");
    const scale = 1.06 * Math.max((right - left) / width, (above - below) / height, 1e-9);
    for (const [axis, low, high, size] of [
      [x, left, right, width],
      [y, below, above, height],
    ]) {
      const from = (low + high) / 2 - (scale * size) / 2,
        to = from + scale * size;
      if (Math.abs(axis.min - from) + Math.abs(axis.max - to) > 1e-3 * scale * size || axis.min === undefined) {
        [axis.min, axis.max] = [from, to];
        chart.again = true;
      }
    }
    if (chart.again) {
      chart.again = false;
      setTimeout(() => chart.update());
    }
  },
};
Chart.register(equalScales);

// A chart of sets of points {x, y}; `tell` gives the lines of the hover text of a point.
function newChart(canvas, x, y, { equal = false, tell = null, hover = null, legend = true } = {}) {
  const axis = (text) => ({
    type: "linear",
    title: { display: true, text },
    ticks: { includeBounds: false },
    grid: { color: "#e4e6ea" },
  });
  return new Chart(canvas, {
    type: "scatter",
    data: { datasets: [] },
    options: {
      scales: { x: axis(x), y: axis(y) },
      interaction: { mode: "nearest", intersect: false },
      onHover: (_, found) => hover && hover(found[0]),
      plugins: {
        equalScales: { on: equal },
        legend: {
          display: legend,
          labels: {
            usePointStyle: true,
            pointStyleWidth: 13,
            boxHeight: 9,
            filter: (item) => !item.text.startsWith("_"),
          },
        },
        tooltip: {
          callbacks: {
            label: (item) =>
              tell ? tell(item) : `${named(item.dataset)}${round(item.parsed.x)}, ${round(item.parsed.y)}`,
          },
        },
      },
    },
  });
}

// A set of points that are joined; those with x = NaN are gaps.
const lineSet = (label, colour, data, width) => ({
  label,
  data,
  borderColor: colour,
  backgroundColor: colour,
  borderWidth: width,
  showLine: true,
  spanGaps: false,
  pointStyle: "line",
  pointRadius: 0,
  pointHitRadius: 6,
});

// Pictures of curves become charts.
for (const box of document.querySelectorAll("[data-curves]")) {
  const figure = JSON.parse(element(box.dataset.curves).textContent),
    row = document.createElement("div");
  row.className = "curves";
  box.replaceWith(row);
  for (const axes of figure) {
    const place = document.createElement("div"),
      canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${axes.y} over ${axes.x}`);
    place.append(canvas);
    row.append(place);
    const chart = newChart(canvas, axes.x, axes.y, { equal: axes.equal });
    chart.data.datasets = axes.lines.map((line) => ({
      label: line.label,
      data: line.x.map((x, i) => ({ x, y: line.y[i] })),
      borderColor: line.colour,
      backgroundColor: line.colour,
      showLine: line.line,
      borderDash: line.dashed ? [6, 4] : [],
      borderWidth: line.width,
      pointRadius: line.points ? 2 : 0,
      pointHitRadius: 8,
    }));
    chart.update();
  }
}
