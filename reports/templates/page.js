"use strict";
/* Draws the charts of this page from its own data. No network. */
const rockcheck = { charts: {}, whenReady: [], time: 0 };
window.rockcheck = rockcheck;

/* Two letters of 91 hold 13 bits; the number of bytes stands first (pages/assets.py). */
rockcheck.bytes = (text) => {
  const [size, letters] = text.split(" "), bytes = new Uint8Array(Number(size)), values = new Uint8Array(127);
  for (let code = 33, value = 0; code < 127; code += 1) if (!"<&>".includes(String.fromCharCode(code))) values[code] = value++;
  for (let k = 0, at = 0, bits = 0, held = 0; at < bytes.length; k += 2) {
    held |= (values[letters.charCodeAt(k)] + 91 * values[letters.charCodeAt(k + 1)]) << bits;
    for (bits += 13; bits >= 8 && at < bytes.length; bits -= 8, held >>>= 8) bytes[at++] = held & 255;
  }
  return bytes;
};
rockcheck.unpack = async (holder) => {
  const packed = rockcheck.bytes(holder.textContent);
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
};

/* Arrays come as differences of whole multiples of a step (charts/samples.py); columns of one table come one after another. */
const summed = ({ step, order, deltas }) => {
  const values = Float64Array.from(deltas);
  for (let k = 0; k < order; k += 1) for (let n = 1; n < values.length; n += 1) values[n] += values[n - 1];
  return values.map((value) => value * step);
};
rockcheck.data = async (holder, coloured = (text) => text) => JSON.parse(
  coloured(await rockcheck.unpack(holder)), (key, value) => (value && value.deltas ? summed(value) : value));
rockcheck.interleaved = (columns, kind) => {
  const table = new kind(columns.length * columns[0].length);
  columns.forEach((column, letter) => column.forEach((value, row) => { table[row * columns.length + letter] = value; }));
  return table;
};

rockcheck.run = async (id) => {
  const script = document.createElement("script");
  script.textContent = await rockcheck.unpack(document.getElementById(id));
  document.head.append(script);
};

const isNarrow = () => window.innerWidth < 760;

/* On a dark screen figures take the dark colours of the palette; printed pages show the stills, which stay light. */
rockcheck.isDark = window.matchMedia("(prefers-color-scheme: dark)");
const darkColours = JSON.parse(document.getElementById("dark-colours").textContent);
const parts = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
rockcheck.coloured = (text) => (!rockcheck.isDark.matches ? text : text
  .replace(/#[0-9a-f]{6}/gi, (colour) => darkColours[colour.toLowerCase()] || colour)
  .replace(/rgba\((\d+),(\d+),(\d+),/g, (all, ...rgb) => {
    const dark = darkColours[`#${rgb.slice(0, 3).map((part) => Number(part).toString(16).padStart(2, "0")).join("")}`];
    return dark ? `rgba(${parts(dark)},` : all;
  }));
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const fitted = (layout) => {
  const narrow = isNarrow();
  return {
    ...layout,
    font: { family: "system-ui, -apple-system, 'Segoe UI', Roboto, 'Liberation Sans', sans-serif", size: narrow ? 11 : 13, color: style("--ink") },
    margin: { l: narrow ? 46 : 66, r: narrow ? 10 : 22, t: layout.margin_top || 40, b: layout.margin_bottom || (narrow ? 42 : 48) },
    paper_bgcolor: style("--card"), plot_bgcolor: style("--card"), dragmode: narrow ? false : "zoom",
    hoverlabel: { font: { size: 12, color: style("--ink") }, bgcolor: style("--card") },
  };
};

/* The live chart stands beside its still, which is printed in its place. A chart that answers is no picture any more. */
rockcheck.live = (chart) => {
  let box = chart.querySelector(".live");
  if (!box) {
    chart.querySelector(".wait")?.remove();
    box = document.createElement("div");
    box.className = "live";
    chart.append(box);
    chart.classList.add("drawn");
    chart.setAttribute("role", "group");
  }
  return box;
};

const config = { responsive: true, displaylogo: false, scrollZoom: false, doubleClick: "reset",
  modeBarButtonsToRemove: ["lasso2d", "select2d", "autoScale2d", "zoomIn2d", "zoomOut2d"],
  toImageButtonOptions: { format: "svg" },
  /* Without a pointer that hovers the bar would lie over the legend for ever. */
  ...(matchMedia("(hover: none)").matches && { displayModeBar: false }) };

/* What is in sight comes first; the browser may answer the reader between two charts. */
const breath = () => new Promise((done) => setTimeout(done, 0));
rockcheck.draw = async () => {
  const away = (holder) => Math.max(0, holder.parentElement.getBoundingClientRect().top - window.innerHeight);
  const holders = [...document.querySelectorAll("script.chart-data")].map((holder) => [away(holder), holder]);
  for (const [, holder] of holders.sort((a, b) => a[0] - b[0])) {
    const name = holder.dataset.chart;
    const box = rockcheck.live(document.getElementById(`chart-${name}`));
    const figure = await rockcheck.data(holder, rockcheck.coloured);
    /* Curves over the same times share one array of them. */
    for (const trace of figure.data) for (const letter of ["x", "y"]) {
      if (trace[letter] && trace[letter].same) trace[letter] = figure.data[trace[letter].same[0]][trace[letter].same[1]];
    }
    await Plotly.react(box, figure.data, fitted(figure.layout), config);
    rockcheck.charts[name] = { box, views: figure.views || null };
    await breath();
  }
};

/* Buttons do what the mouse does, for keyboards and fingers. */
const clampRange = (low, high, end) => {
  const width = Math.min(high - low, end);
  const start = Math.max(0, Math.min(low, end - width));
  return [start, start + width];
};
const zoom = { in: [0.25, 0.75], out: [-0.5, 1.5], earlier: [-0.5, 0.5], later: [0.5, 1.5] };
document.addEventListener("click", (event) => {
  const button = event.target.closest("button[data-for]");
  const chart = button && rockcheck.charts[button.dataset.for];
  if (!chart) return;
  const { box, views } = chart;
  const action = button.dataset.do;
  if (action === "all") {
    Plotly.relayout(box, views ? { "xaxis.range": [0, views.duration_s], "yaxis.range": views.near } : { "xaxis.autorange": true, "yaxis.autorange": true });
  } else if (action === "event") {
    Plotly.relayout(box, { "xaxis.range": views.event_s, "yaxis.range": views.near });
  } else if (action === "height") {
    const whole = button.getAttribute("aria-pressed") !== "true";
    button.setAttribute("aria-pressed", String(whole));
    Plotly.relayout(box, { "yaxis.range": whole ? views.whole : views.near });
  } else {
    const [low, high] = box.layout.xaxis.range.map(Number);
    const [a, b] = zoom[action];
    const wanted = [low + a * (high - low), low + b * (high - low)];
    Plotly.relayout(box, { "xaxis.range": views ? clampRange(wanted[0], wanted[1], views.duration_s) : wanted });
  }
});

/* A cursor over the histories, kept outside the chart so that moving it draws nothing anew. */
rockcheck.addCursor = (name) => {
  const { box } = rockcheck.charts[name];
  const line = document.createElement("div");
  line.className = "cursor";
  box.append(line);
  const place = () => {
    const axis = box._fullLayout.xaxis, size = box._fullLayout._size;
    const [low, high] = axis.range.map(Number);
    const share = (rockcheck.time - low) / (high - low);
    line.style.display = share >= 0 && share <= 1 ? "block" : "none";
    line.style.transform = `translateX(${size.l + share * size.w}px)`;
    line.style.top = `${size.t}px`;
    line.style.height = `${size.h}px`;
  };
  box.on("plotly_relayout", place);
  box.on("plotly_afterplot", place);
  return place;
};

/* On a telephone long tables are folded away; a link to one, and printing, open it. At a desk all lie open. */
const telephone = window.matchMedia("(max-width: 599px)");
const folds = (within) => within.querySelectorAll("details.fold");
const foldAway = () => { for (const item of folds(document)) item.open = !telephone.matches; };
telephone.addEventListener("change", foldAway);
window.addEventListener("beforeprint", () => { for (const item of folds(document)) item.open = true; });
window.addEventListener("afterprint", foldAway);
document.addEventListener("click", (event) => {
  const link = event.target.closest("a[href^='#']");
  const target = link && document.getElementById(link.hash.slice(1));
  if (target) for (const item of folds(target)) item.open = true;
});

const start = async () => {
  foldAway();
  if (!("DecompressionStream" in window)) {
    for (const note of document.querySelectorAll(".wait")) note.textContent = "This browser is too old to draw charts; every number stands in the tables.";
    return;
  }
  await breath();
  rockcheck.marks = { begun: performance.now() };
  await rockcheck.run("chart-library");
  rockcheck.marks.library = performance.now();
  await rockcheck.draw();
  rockcheck.marks.charts = performance.now();
  for (const next of rockcheck.whenReady) await next();
  rockcheck.readyMs = performance.now();
  document.documentElement.dataset.ready = "yes";
  rockcheck.isDark.addEventListener("change", rockcheck.draw);
};
document.addEventListener("DOMContentLoaded", start);
