"use strict";

// Tables: a click on a heading sorts by its column, a second one turns the order round.
function sortValue(cell) {
  const text = (cell.dataset.value ?? cell.textContent).trim().replaceAll("\u2212", "-");
  const number = parseFloat(text);
  if (Number.isNaN(number)) return text;
  return /^[+-]/.test(text) ? Math.abs(number) : number; // differences with a sign: by their size
}

function inOrder(first, second) {
  const numbers = [first, second].filter((value) => typeof value === "number").length;
  if (numbers === 2) return first - second;
  if (numbers === 1) return typeof first === "number" ? -1 : 1;
  return first.localeCompare(second);
}

function sortBy(heading) {
  const table = heading.closest("table");
  const column = [...heading.parentNode.children].indexOf(heading);
  const descending = heading.ariaSort === "ascending";
  for (const other of heading.parentNode.children) other.ariaSort = null;
  heading.ariaSort = descending ? "descending" : "ascending";
  const body = table.tBodies[0];
  const rows = [...body.rows].map((row) => [sortValue(row.cells[column]), row]);
  rows.sort(([first], [second]) => (descending ? -1 : 1) * inOrder(first, second));
  body.append(...rows.map(([, row]) => row));
  table.classList.add("sorted");
}

for (const heading of document.querySelectorAll("table.sortable thead th")) {
  heading.tabIndex = 0;
  heading.title = "sort";
  heading.addEventListener("click", () => sortBy(heading));
  heading.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    sortBy(heading);
  });
}

// Also of a folded table, of which the browser knows no lines.
function headingText(cell) {
  const copy = cell.cloneNode(true);
  copy.querySelectorAll("br, .unit").forEach((part) => part.before(" "));
  return copy.textContent.replace(/\s+/g, " ").trim();
}

// On a telephone a row becomes a card: every number stands beside the heading of its column.
function asCards(table) {
  const names = [...table.tHead.rows[0].cells].map(headingText);
  for (const row of table.tBodies[0].rows) {
    [...row.cells].forEach((cell, column) => {
      if (cell.colSpan === 1) cell.dataset.label = names[column];
    });
  }
  table.classList.add("cards");
}

document.querySelectorAll("main table").forEach(asCards);

// On paper nothing is folded.
const folds = () => document.querySelectorAll("details:not([open])");
addEventListener("beforeprint", () => folds().forEach((fold) => { fold.open = fold.dataset.printed = true; }));
addEventListener("afterprint", () => document.querySelectorAll("details[data-printed]").forEach((fold) => {
  fold.open = false;
  delete fold.dataset.printed;
}));

// One of several figures at a time.
for (const choice of document.querySelectorAll(".choice")) {
  const figures = [...document.getElementById(choice.dataset.of).querySelectorAll("figure")];
  const show = (number) => figures.forEach((figure, k) => { figure.hidden = k !== number; });
  const [list, engines] = choice.querySelectorAll("select");
  list.addEventListener("change", () => {
    show(list.selectedIndex);
    drawAll();
  });
  engines?.addEventListener("change", () => {
    figures.forEach((figure) => { figure.dataset.engine = engines.value; });
    figures.map((figure) => figure.querySelector('.plot[data-drawn="done"]')).filter(Boolean).forEach(plotted);
  });
  choice.hidden = false;
  show(0);
}

// Plots: the still image of each is replaced when it comes into view. Without the browser's own decompression,
// or on paper, still images stay.
let plots = {};
const NARROW = 600; // pixels
const TOOLBAR = 30; // pixels above the legend for plotly's buttons
const SCALE = 66; // pixels of a scale of colours below panels

async function unpacked(name) {
  const bytes = Uint8Array.from(atob(document.getElementById(name).textContent), (letter) => letter.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
}

async function load() {
  const [library, data] = await Promise.all([unpacked("plotly"), unpacked("plots")]);
  const script = document.createElement("script");
  script.textContent = library;
  document.head.append(script);
  plots = JSON.parse(data);
}

// The legend stands above the panels, in as many rows as its entries need at this width.
function legendRows(plot, width) {
  const entries = plot.data.filter((trace) => trace.name && trace.showlegend !== false);
  if (entries.length < 2) return 0;
  const room = width - 20 - 7.2 * (plot.layout.legend.title?.text.replace(/<[^>]*>/g, "").length ?? 0);
  let [rows, taken] = [1, 0];
  for (const { name } of entries) {
    const needed = 52 + 7.2 * name.length;
    if (taken && taken + needed > room) [rows, taken] = [rows + 1, 0];
    taken += needed;
  }
  return rows;
}

// Panels that stand side by side on a wide screen stand below each other on a telephone's.
function arranged(plot, width) {
  const layout = structuredClone(plot.layout);
  const rows = legendRows(plot, width);
  layout.margin.t = TOOLBAR + 21 * rows;
  if (layout.grid && width < NARROW) {
    const panels = Object.keys(layout).filter((name) => name.startsWith("xaxis")).length;
    const columns = layout.grid.columns > 2 ? 2 : 1;
    const height = layout.height / layout.grid.rows;
    layout.grid = { ...layout.grid, columns, rows: Math.ceil(panels / columns), xgap: 0.28 };
    layout.height = height * layout.grid.rows;
    const label = layout.yaxis.title.text;
    for (const name of Object.keys(layout).filter((name) => name.startsWith("yaxis"))) {
      const number = parseInt(name.slice(5) || "1") - 1;
      layout[name].showticklabels = true;
      layout[name].title = { ...layout[name].title, text: number % columns ? "" : label };
    }
  }
  if (width < NARROW && layout.annotations) Object.assign(layout, { annotations: [], margin: { ...layout.margin, r: 16 } });
  if (width < NARROW && layout.xaxis.ticktext) layout.xaxis.tickangle = -60;
  for (const [name, axis] of Object.entries(width < NARROW ? layout : {})) {
    if (/^xaxis/.test(name) && layout.grid) axis.title = { ...axis.title, font: { size: 10 } };
    if (/^yaxis/.test(name) && axis.ticktext) axis.tickfont = { size: 10 };
  }
  const scale = width < NARROW && isMap(plot) ? SCALE : 0;
  layout.margin.b += scale;
  layout.height += layout.margin.t + scale;
  layout.legend.y = 1 - TOOLBAR / layout.height;
  if (matchMedia("(pointer: coarse)").matches) layout.dragmode = false;
  if (DARK.matches) darken(layout, isMap(plot) ? "#4a535e" : "#14181d");
  return layout;
}

const DARK = matchMedia("(prefers-color-scheme: dark)");
const LIGHTER = { "#000000": "#f0f3f6", "#2b2b2b": "#8b949e", "#0072B2": "#4aa8e0" };

const isMap = (plot) => plot.data.some((trace) => trace.type === "heatmap");

// What a map leaves blank is lighter than its darkest colour.
function darken(layout, blank) {
  Object.assign(layout, { paper_bgcolor: "#14181d", plot_bgcolor: blank });
  layout.font = { ...layout.font, color: "#e6e9ed" };
  layout.hoverlabel = { ...layout.hoverlabel, bgcolor: "#1e242b", font: { color: "#e6e9ed" } };
  for (const [name, axis] of Object.entries(layout)) {
    if (/^[xy]axis/.test(name)) Object.assign(axis, { gridcolor: "#2b333c", linecolor: "#a3adb8", tickcolor: "#a3adb8" });
  }
}

// On a telephone the scale of colours lies below the panels.
function flat(trace) {
  if (!trace.colorbar) return trace;
  const title = { ...trace.colorbar.title, side: "bottom" };
  const place = { orientation: "h", yref: "container", y: 0, yanchor: "bottom", x: 0.5, xanchor: "center" };
  return { ...trace, colorbar: { ...trace.colorbar, ...place, title } };
}

// The reference stands beside every engine.
const ENGINES = [...document.querySelectorAll("select.engines option")].map(({ text }) => text);
const names = (name, engine) => name === engine || name.startsWith(`${engine}, `);
const isOf = (name, engine) => !name || names(name, engine) || !ENGINES.some((other) => names(name, other));

// Black lines would not be seen on a dark page; on a map they lie on its colours, and stay.
function traces(plot, width, engine) {
  if (engine) return traces({ data: plot.data.filter(({ name }) => isOf(name, engine)) }, width);
  if (isMap(plot)) return width < NARROW ? plot.data.map(flat) : plot.data;
  if (!DARK.matches) return plot.data;
  return JSON.parse(JSON.stringify(plot.data).replace(/#[0-9A-Fa-f]{6}/g, (colour) => LIGHTER[colour] ?? colour));
}

// Every button by its name: what plotly adds of its own accord, such as an upload, has no place here.
const CONFIG = {
  responsive: true, displaylogo: false, plotlyServerURL: "", showSendToCloud: false, showEditInChartStudio: false,
  modeBarButtons: [["toImage", "zoom2d", "pan2d", "resetScale2d"]],
};
let library = null;

// Anew, also where it was drawn: plotly does not move a scale of colours from the side to the foot of panels.
function plotted(place) {
  const plot = plots[place.dataset.plot];
  const drawn = traces(plot, place.clientWidth, place.closest("figure").dataset.engine);
  return Plotly.newPlot(place, drawn, arranged(plot, place.clientWidth), CONFIG);
}

async function draw(place) {
  if (place.dataset.drawn || place.closest("[hidden]")) return;
  place.dataset.drawn = "begun";
  library ??= load();
  await library;
  place.closest("figure").classList.add("plotted");
  await plotted(place);
  place.dataset.drawn = "done";
  place.dataset.width = place.clientWidth;
}

function drawAll() {
  return Promise.all([...document.querySelectorAll(".plot")].map(draw));
}

if ("DecompressionStream" in window) {
  // figures, not plots: an empty plot has no height, and would never be seen
  document.querySelectorAll("figure.chart").forEach((figure) => {
    const place = figure.querySelector(".plot");
    new IntersectionObserver((entries, self) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      self.disconnect();
      draw(place);
    }, { rootMargin: "600px" }).observe(figure);
  });
  let waiting = 0;
  addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      for (const place of document.querySelectorAll('.plot[data-drawn="done"]')) {
        if (!place.clientWidth || place.dataset.width === String(place.clientWidth)) continue;
        place.dataset.width = place.clientWidth;
        plotted(place);
      }
    }, 200);
  });
  DARK.addEventListener("change", () => {
    for (const place of document.querySelectorAll('.plot[data-drawn="done"]')) {
      plotted(place);
    }
  });
}
